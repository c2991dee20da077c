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
    eval page(ending, 1300, 560)
    set multiplot layout 1, 2 title "Condition of the reduced Jacobian, columns scaled" offset 0, -0.3
    set logscale y
    set format y "10^{%L}"
    set xrange [5:125]
    set yrange [1:1e12]
    set xlabel "pressure modes"
    set key top left
    do for [region in "low high"] {
        set title region eq "low" ? "Lower loaded region, nine cases" : "Higher loaded region, six cases"
        plot limit(2.2e-16) with lines linecolor "#555555" dashtype 2 title "Gram matrix singular in double precision", \
             limit(1.2e-7) with lines linecolor "#aaaaaa" dashtype 2 title "in single precision", \
             points(region, "without-D", "all") using ($1+0.8):2 with points pointtype 4 linecolor rgb red title "all rows, without D", \
             points(region, "stored", "few") using ($1-0.8):2 with points pointtype 9 linecolor rgb sky title "8 rows for 5 modes, D and row weights", \
             points(region, "stored", "all") using 1:2 with points pointtype 7 linecolor rgb blue title "all rows, D and row weights"
    }
    unset multiplot
}
unset output
