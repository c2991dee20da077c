# SPDX-License-Identifier: GPL-3.0-or-later
# Deviation of the central film thickness against the sizes of the bases (paper, Fig. 3). Variables:
# data, picture (without its ending), case_title, fixed_pressure, fixed_deformation, and the published
# sizes and deviation of the case (0 and NaN where there are none).

# Sizes and deviations of converged (status 0) or failed (1) models. Failed ones begin with a point that
# lies out of sight, since gnuplot warns of empty data.
points(kind, column, other, value, status) = sprintf( \
    "<awk 'BEGIN { if (%d) print -1, 1 } $1 == \"%s\" && $%d == %d && $5 == %d { print $%d, $6 }' %s | sort -n", \
    status, kind, other, value, status, column, data)

do for [ending in "png svg"] {
    eval page(ending, 1000, 1000)
    set multiplot layout 2, 1 title case_title offset 0, -0.3
    set logscale y
    set format y "10^{%L}"
    set yrange [1e-6:1e4]
    set ylabel "deviation of H_c / permille"
    set lmargin 11
    set rmargin 3
    set key top right Left reverse samplen 2.5 spacing 1.2 box linecolor "#bbbbbb" opaque

    set xrange [0:*]
    set autoscale xfixmax
    set offsets 0, graph 0.04, 0, 0
    set xlabel "number of pressure basis functions n_p"
    plot points("independent", 2, 3, fixed_deformation, 0) using 1:2 with linespoints pointtype 7 linewidth 2 linecolor rgb blue \
             title sprintf("independent basis, n_{/Symbol d} = %d", fixed_deformation), \
         points("coupled", 2, 3, 0, 0) using 1:2 with linespoints pointtype 5 linewidth 2 linecolor rgb red title "coupled basis", \
         points("independent", 2, 3, fixed_deformation, 1) using 1:(4e-6) with points pointtype 2 pointsize 1.4 linewidth 2 linecolor rgb blue title "not converged (at the bottom)", \
         points("coupled", 2, 3, 0, 1) using 1:(2e-6) with points pointtype 2 pointsize 1.4 linewidth 2 linecolor rgb red notitle, \
         "+" using (published_pressure):(published_deviation) every ::0::0 with points pointtype 12 pointsize 2 linewidth 2 linecolor "black" \
             title sprintf("published, %d + %d", published_pressure, published_deformation)

    set xlabel "number of deformation basis functions n_{/Symbol d}"
    plot points("independent", 3, 2, fixed_pressure, 0) using 1:2 with linespoints pointtype 7 linewidth 2 linecolor rgb blue \
             title sprintf("independent basis, n_p = %d", fixed_pressure), \
         points("independent", 3, 2, fixed_pressure, 1) using 1:(4e-6) with points pointtype 2 pointsize 1.4 linewidth 2 linecolor rgb blue title "not converged (at the bottom)", \
         "+" using (published_deformation):(published_deviation) every ::0::0 with points pointtype 12 pointsize 2 linewidth 2 linecolor "black" \
             title sprintf("published, %d + %d", published_pressure, published_deformation)
    unset multiplot
    unset output
}
