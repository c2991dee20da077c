# SPDX-License-Identifier: GPL-3.0-or-later
# Pressure above, film below: full model as lines, reduced as marks. Loaded by a scene's plot.gp with
# picture (without its ending), cases (paths without -KIND.dat), model, film_lowest, film_highest, step.
label(path) = system("basename ".path." | sed 's/^case-//; s/^no\\([0-9]\\)/lubricant no. \\1/; s/-M/, M = /; s/^M/M = /; s/-L/, L = /; s/-p\\([0-9.]*\\)/, p_H = \\1 GPa/'")
colour(i) = word("#0072b2 #d55e00 #009e73 #cc79a7 #e69f00 #56b4e9", i)
mark(i) = int(word("6 4 8 12 10 14", i))

do for [ending in "png svg"] {
    if (ending eq "png") {
        set terminal pngcairo size 980, 900 font "sans,14" background "white"
    } else {
        set terminal svg size 980, 900 font "sans,14" background "white"
    }
    set output picture.".".ending
    set multiplot
    set grid linetype 1 linewidth 0.7 linecolor "#e0e0e0"
    set border linewidth 1.2
    set tics nomirror
    set lmargin at screen 0.10
    set rmargin at screen 0.97

    set tmargin at screen 0.97
    set bmargin at screen 0.54
    set format x ""
    unset xlabel
    unset logscale y
    set format y "%g"
    set yrange [0:*]
    set ylabel "pressure p / p_H"
    unset key
    plot for [i = 1:words(cases)] word(cases, i)."-full.dat" using 1:2 with lines linewidth 2 linecolor rgb colour(i), \
         for [i = 1:words(cases)] word(cases, i)."-".model.".dat" using 1:2 every step::(i * step / 3) with points pointtype mark(i) pointsize 1.1 linewidth 1.6 linecolor rgb colour(i)

    set tmargin at screen 0.50
    set bmargin at screen 0.09
    set format x "%g"
    set xlabel "position X = x / a   (a: half width of the dry contact)"
    set logscale y
    set format y "10^{%L}"
    set yrange [film_lowest:film_highest]
    set ylabel "film thickness H = h R / a^2"
    set key top center Left reverse width -6 samplen 2.5 spacing 1.2 box linecolor "#bbbbbb" opaque
    plot for [i = 1:words(cases)] word(cases, i)."-full.dat" using 1:3 with lines linewidth 2 linecolor rgb colour(i) title label(word(cases, i)), \
         for [i = 1:words(cases)] word(cases, i)."-".model.".dat" using 1:3 every step::(i * step / 3) with points pointtype mark(i) pointsize 1.1 linewidth 1.6 linecolor rgb colour(i) notitle, \
         NaN with lines linewidth 2 linecolor "black" title "line: full model", \
         NaN with points pointtype 6 pointsize 1.1 linewidth 1.6 linecolor "black" title "marks: reduced model"
    unset multiplot
    unset output
}
