# SPDX-License-Identifier: GPL-3.0-or-later
# Exit lines of some cases, full model as lines, reduced model as marks. Loaded with out (folder of full/CASE.map and
# MODEL/CASE.map), cases and model.
label(case) = system("awk -f ".shared."case.awk -v title=1 -v want=".case." cases.csv")

do for [ending in "png svg"] {
    eval page(ending, 980, 700)
    set yrange [0:*]
    set xlabel "exit X = x / a"
    set ylabel "Y = y / a"
    set key top right
    plot for [i = 1:words(cases)] out."/full/".word(cases, i).".map" index 1 using 1:2 with lines linewidth 2 linecolor rgb colour(i) title label(word(cases, i)), \
         for [i = 1:words(cases)] out."/".model."/".word(cases, i).".map" index 1 using 1:2 with points pointtype mark(i) pointsize 0.9 linewidth 1.4 linecolor rgb colour(i) notitle
    unset output
}
