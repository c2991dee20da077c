# SPDX-License-Identifier: GPL-3.0-or-later
# Contour maps of a point contact, a row of panels for each kind of result: full model above, reduced below; white: the
# exit line. Loaded with picture (without its ending), width (or not), heading, model; and either case (path
# without -KIND.map: pressure on the left, film on the right), or case and times (files -KIND-TIME.map: the film at these).
if (!exists("width")) width = 1200
if (!exists("times")) times = ""
num_panels = times eq "" ? 2 : words(times)
height = times eq "" ? 0.9 : 0.15 + 1.8 / num_panels
panel_column(i) = times eq "" && i == 1 ? 3 : 4
panel_map(kind, i) = case."-".kind.(times eq "" ? "" : "-".word(times, i)).".map"
panel_title(i) = times ne "" ? "T = ".word(times, i) : i == 1 ? "pressure p / p_H, lines every 0.1" : "film thickness h R / a^2, lines every 0.02"
do for [ending in "png svg"] {
    eval page(ending, width, width * height)
    eval sprintf("set termoption fontscale %g", width / 1200.)
    set multiplot layout 2, num_panels title heading
    set xrange [-2:1.6]
    set yrange [-1.7:1.7]
    set size ratio -1
    set tics out
    if (times ne "") { set tics 1 }
    set palette defined (0 "#440154", 1 "#3b528b", 2 "#21918c", 3 "#5ec962", 4 "#fde725")
    set contour base
    unset key
    do for [kind in "full ".model] {
        set xlabel "X = x / a"
        do for [i = 1:num_panels] {
            set ylabel i > 1 ? "" : (kind eq "full" ? "full model" : "reduced model")."      Y = y / a"
            map = panel_map(kind, i)
            contours = picture.".contour"
            set table contours
            set contour base
            unset surface
            set cntrparam cubicspline
            if (panel_column(i) == 3) { set cntrparam levels incremental 0.1, 0.1, 1.5 }
            if (panel_column(i) == 4) { set cntrparam levels incremental 0.2, 0.02, 0.6 }
            splot map index 0 using 1:2:(column(panel_column(i)))
            unset table
            set surface
            unset contour
            set title panel_title(i)
            if (panel_column(i) == 3) { set cbrange [0:1.2] }
            if (panel_column(i) == 4) { set cbrange [0.2:0.6] }
            if (times ne "") { unset colorbox }
            plot map index 0 using 1:2:(column(panel_column(i))) with image, \
                 contours using 1:2 with lines linewidth 0.8 linecolor rgb "#303030", \
                 map index 1 using 1:2 with lines linewidth 2.5 linecolor rgb "white"
        }
    }
    unset multiplot
    unset output
}
