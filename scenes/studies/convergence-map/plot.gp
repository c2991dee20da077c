# SPDX-License-Identifier: GPL-3.0-or-later
# The map: Newton iterations of a cold start over M and L, a panel for each lubricant. Variables: data,
# picture (without its ending).
set datafile separator ","

# Points with a status; failed ones begin with a point out of sight, since gnuplot warns of empty data.
points(law, density, status) = sprintf( \
    "<awk -F, 'BEGIN { if (%d) print \"0.1,-9,1\" } $1 == \"%s\" && $2 == \"%s\" && ($8 != 0) == %d { print $3 \",\" $4 \",\" $9 }' %s", \
    status, law, density, status, data)

do for [ending in "png svg"] {
    eval page(ending, 1300, 800)
    set multiplot layout 2, 3 title "Cold starts of the full model: Newton iterations on the finest grid" offset 0, -0.3
    set logscale x
    set logscale cb
    set xrange [0.8:2500]
    set yrange [-1.5:26.5]
    set cbrange [2:320]
    set palette defined (0 "#0072b2", 0.35 "#56b4e9", 0.6 "#f0e442", 0.8 "#e69f00", 1 "#8b1a1a")
    set xlabel "M"
    set ylabel "L"
    unset key
    do for [density in "incompressible dowson-higginson"] {
        do for [law in "barus roelands wlf"] {
            set title law.", ".density
            plot points(law, density, 0) using 1:2:3 with points pointtype 7 pointsize 0.9 linecolor palette, \
                 points(law, density, 1) using 1:2 with points pointtype 2 pointsize 1.5 linewidth 3 linecolor rgb "black"
        }
    }
    unset multiplot
    unset output
}
