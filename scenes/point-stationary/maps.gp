# SPDX-License-Identifier: GPL-3.0-or-later
# Pressure on the left and film on the right as contour maps of the contact, full model above, reduced below; white: the
# exit line. Loaded with picture (without its ending), width of the PNG (or not) and case (path without -KIND.map), case_title, model.
if (!exists("width")) width = 1200
do for [ending in "png svg"] {
    if (ending eq "png") {
        set terminal pngcairo size width, width * 0.9 font "sans,".(width / 85) background "white"
    } else {
        set terminal svg size 1200, 1080 font "sans,14" background "white"
    }
    set output picture.".".ending
    set multiplot layout 2, 2 title case_title
    set xrange [-2:1.6]
    set yrange [-1.7:1.7]
    set size ratio -1
    set tics nomirror out
    set palette defined (0 "#440154", 1 "#3b528b", 2 "#21918c", 3 "#5ec962", 4 "#fde725")
    set contour base
    unset key
    do for [kind in "full ".model] {
        map = case."-".kind.".map"
        set xlabel "X = x / a"
        set ylabel (kind eq "full" ? "full model" : "reduced model")."      Y = y / a"
        do for [column in "3 4"] {
            contours = picture.".contour"
            set table contours
            set contour base
            unset surface
            set cntrparam cubicspline
            if (column eq "3") { set cntrparam levels incremental 0.1, 0.1, 1.5 }
            if (column eq "4") { set cntrparam levels incremental 0.2, 0.02, 0.6 }
            splot map index 0 using 1:2:(column(int(column)))
            unset table
            set surface
            unset contour
            if (column eq "3") { set title "pressure p / p_H, lines every 0.1"; set cbrange [0:1.2] }
            if (column eq "4") { set title "film thickness h R / a^2, lines every 0.02"; set cbrange [0.2:0.6] }
            plot map index 0 using 1:2:(column(int(column))) with image, \
                 contours using 1:2 with lines linewidth 0.8 linecolor rgb "#303030", \
                 map index 1 using 1:2 with lines linewidth 2.5 linecolor rgb "white"
        }
    }
    unset multiplot
    unset output
}
