# SPDX-License-Identifier: GPL-3.0-or-later
# The study: deviation over modes for each weight, and stability over rows for each method. Variables: data, picture
# (without its ending), regions, modes (of the second picture).
set datafile separator ","
set datafile missing "inf"

# Points of a variant, column y over column x; those behind the fields named only.
points(region, weight, method, condition, x, y) = sprintf( \
    "<awk -F, '$1 == \"%s\" && $2 == \"%s\" && $4 == \"%s\" && $5 == \"quadrature\" && (%s) { print $%d \",\" $%d }' %s | sort -t, -n", \
    region, weight, method, condition, x, y, data)

colours = "#0072b2 #d55e00 #009e73 #cc79a7"
do for [ending in "png svg"] {
    eval page(ending, 1200, 480 * words(regions))
    set multiplot layout words(regions), 2
    set logscale y
    set format y "10^{%T}"
    do for [region in regions] {
        set key top right
        set title sprintf("%s loaded region: weights, joint, two rows a mode", region eq "low" ? "Lower" : "Higher")
        set xlabel "pressure modes"
        set ylabel "deviation of the central film, 95 %, worst"
        plot for [i = 1:3] points(region, word("mode identity row-norm", i), "joint", "$6 == 2 * $3", 3, 8) \
                 using 1:2 with lines linewidth 2 linecolor rgb word(colours, i) title word("mode identity row-norm", i), \
             for [i = 1:3] points(region, word("mode identity row-norm", i), "joint", "$6 == 2 * $3", 3, 9) \
                 using 1:2 with points pointtype 7 linecolor rgb word(colours, i) notitle
        set title sprintf("%s loaded region: methods, %d modes, weight mode", region eq "low" ? "Lower" : "Higher", modes)
        set xlabel "rows"
        set ylabel "stability at the worst exit (all rows: 1)"
        set format y "%g"
        plot for [i = 1:4] points(region, "mode", word("joint qr sopt exits", i), sprintf("$3 == %d && $17 != \"inf\"", modes), 6, 17) \
                 using 1:2 with linespoints pointtype 7 linewidth 2 linecolor rgb word(colours, i) \
                 title word("joint qr sopt exits", i)
        set format y "10^{%T}"
    }
    unset multiplot
}
