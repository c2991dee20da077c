# SPDX-License-Identifier: GPL-3.0-or-later
# Left: deviation over the number of training points; scenes that failed are told by their number. Right: where the
# adaptive training put its points. Variables: data, points, picture (without its ending).
set datafile separator ","

of(training) = sprintf("<awk -F, '$1 == \"%s\"' %s", training, data)

do for [ending in "png svg"] {
    eval page(ending, 1300, 560)
    set multiplot layout 1, 2
    set logscale y
    set format y "10^{%T}"
    set xlabel "training points"
    set ylabel "deviation of the central film"
    set title "All modes that the points support; numbers: scenes that fail"
    set key top right
    plot of("regular") using 2:8 with linespoints pointtype 5 linewidth 2 linecolor rgb red title "regular grid: worst", \
         of("regular") using 2:7 with linespoints pointtype 4 dashtype 2 linecolor rgb red title "95 %", \
         of("adaptive") using 2:8 with linespoints pointtype 7 linewidth 2 linecolor rgb blue title "adaptive: worst", \
         of("adaptive") using 2:7 with linespoints pointtype 6 dashtype 2 linecolor rgb blue title "95 %", \
         of("published") using 2:8 with points pointtype 3 pointsize 1.5 linecolor "black" title "published grid: worst", \
         data using 2:($5 > 0 ? $8 : NaN):(sprintf("%d", $5)) with labels offset 0, 0.8 font "sans,11" notitle
    unset logscale y
    set logscale x
    set format y "%g"
    set xlabel "M"
    set ylabel "L"
    unset key
    set title "Where the adaptive training put its points; colour: round"
    stats points using 1 nooutput
    set xrange [STATS_min / 1.1:STATS_max * 1.1]
    set palette defined (0 "#f0e442", 0.5 "#56b4e9", 1 "#00306b")
    plot points using 1:2:3 with points pointtype 7 pointsize 1.1 linecolor palette
    unset multiplot
    unset logscale x
    set autoscale x
    unset output
}
