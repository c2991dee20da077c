# SPDX-License-Identifier: GPL-3.0-or-later
# Exit lines of some cases, full model as lines, reduced model as marks. Loaded with picture (without its ending), cases
# (paths without -KIND.map) and model.
label(path) = system("basename ".path." | sed 's/^case-M/M = /; s/-L/, L = /'")
colour(i) = word("#0072b2 #d55e00 #009e73 #cc79a7 #e69f00 #56b4e9", i)
mark(i) = int(word("6 4 8 12 10 14", i))

do for [ending in "png svg"] {
    if (ending eq "png") {
        set terminal pngcairo size 980, 700 font "sans,14" background "white"
    } else {
        set terminal svg size 980, 700 font "sans,14" background "white"
    }
    set output picture.".".ending
    set grid linetype 1 linewidth 0.7 linecolor "#e0e0e0"
    set tics nomirror
    set yrange [0:*]
    set xlabel "exit X = x / a"
    set ylabel "Y = y / a"
    set key top right
    plot for [i = 1:words(cases)] word(cases, i)."-full.map" index 1 using 1:2 with lines linewidth 2 linecolor rgb colour(i) title label(word(cases, i)), \
         for [i = 1:words(cases)] word(cases, i)."-".model.".map" index 1 using 1:2 with points pointtype mark(i) pointsize 0.9 linewidth 1.4 linecolor rgb colour(i) notitle
    unset output
}
