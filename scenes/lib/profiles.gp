# SPDX-License-Identifier: GPL-3.0-or-later
# Pressure above, film below: full model as lines, reduced as marks. Loaded with out (folder of full/CASE.dat and
# MODEL/CASE.dat), cases, model, and where wanted from, to (of X), film_lowest, film_highest, step (nodes between marks).
if (!exists("step")) step = 24
if (!exists("from")) { from = -2; to = 1.5 }
label(case) = system("awk -f ".shared."case.awk -v title=1 -v want=".case." cases.csv")
full(case) = out."/full/".case.".dat"
reduced(case) = out."/".model."/".case.".dat"

do for [ending in "png svg"] {
    eval page(ending, 980, 900)
    set multiplot
    set lmargin at screen 0.10
    set rmargin at screen 0.97
    set xrange [from:to]

    set tmargin at screen 0.97
    set bmargin at screen 0.54
    set format x ""
    unset xlabel
    unset logscale y
    set format y "%g"
    set yrange [0:*]
    set ylabel "pressure p / p_H"
    unset key
    plot for [i = 1:words(cases)] full(word(cases, i)) using 1:2 with lines linewidth 2 linecolor rgb colour(i), \
         for [i = 1:words(cases)] reduced(word(cases, i)) using 1:2 every step::(i * step / 3) with points pointtype mark(i) pointsize 1.1 linewidth 1.6 linecolor rgb colour(i)

    set tmargin at screen 0.50
    set bmargin at screen 0.09
    set format x "%g"
    set xlabel "position X = x / a   (a: half width of the dry contact)"
    set logscale y
    set format y "10^{%L}"
    if (exists("film_lowest")) { set yrange [film_lowest:film_highest] } else { set yrange [*:*] }
    set ylabel "film thickness H = h R / a^2"
    set key top center Left reverse samplen 2.5 spacing 1.2 box linecolor "#bbbbbb" opaque
    plot for [i = 1:words(cases)] full(word(cases, i)) using 1:3 with lines linewidth 2 linecolor rgb colour(i) title label(word(cases, i)), \
         for [i = 1:words(cases)] reduced(word(cases, i)) using 1:3 every step::(i * step / 3) with points pointtype mark(i) pointsize 1.1 linewidth 1.6 linecolor rgb colour(i) notitle, \
         NaN with lines linewidth 2 linecolor "black" title "line: full model", \
         NaN with points pointtype 6 pointsize 1.1 linewidth 1.6 linecolor "black" title "marks: reduced model"
    unset multiplot
    unset output
}
