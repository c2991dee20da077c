# SPDX-License-Identifier: GPL-3.0-or-later
# Condition of the weighted Jacobian over the number of modes, a mark for each case. Variables: data, picture
# (without its ending).
set datafile separator ","

# Condition, columns scaled, of one variant and list of rows: "all" or "few" (8 for 5 modes).
points(region, variant, rows) = sprintf( \
    "<awk -F, '$1 == \"%s\" && $3 == \"%s\" && $10 == \"extended\" && $4 != $5 && ($5 == 200) == (\"%s\" == \"all\") { print $4 \",\" $8 }' %s", \
    region, variant, rows, data)
limit(epsilon) = 1 / sqrt(epsilon)

do for [ending in "png svg"] {
    if (ending eq "png") {
        set terminal pngcairo size 1300, 560 font "sans,13" background "white"
    } else {
        set terminal svg size 1300, 560 font "sans,13" background "white"
    }
    set output picture.".".ending
    set multiplot layout 1, 2 title "Condition of the reduced Jacobian, columns scaled" offset 0, -0.3
    set logscale y
    set format y "10^{%L}"
    set xrange [5:125]
    set yrange [1:1e12]
    set grid linetype 1 linewidth 0.7 linecolor "#e0e0e0"
    set tics nomirror
    set xlabel "pressure modes"
    set key top left
    do for [region in "low high"] {
        set title region eq "low" ? "Lower loaded region, nine cases" : "Higher loaded region, six cases"
        plot limit(2.2e-16) with lines linecolor "#555555" dashtype 2 title "Gram matrix singular in double precision", \
             limit(1.2e-7) with lines linecolor "#aaaaaa" dashtype 2 title "in single precision", \
             points(region, "without-D", "all") using ($1+0.8):2 with points pointtype 4 linecolor "#d55e00" title "all rows, without D", \
             points(region, "stored", "few") using ($1-0.8):2 with points pointtype 9 linecolor "#56b4e9" title "8 rows for 5 modes, D and row weights", \
             points(region, "stored", "all") using 1:2 with points pointtype 7 linecolor "#0072b2" title "all rows, D and row weights"
    }
    unset multiplot
}
unset output
