# SPDX-License-Identifier: GPL-3.0-or-later
# What varies over the angle of the cam, and the film that follows. Variables: picture (without its ending),
# history (table), films (path of the files before the kind), model.
full = films."full.dat"
reduced = films.model.".dat"

do for [ending in "png svg"] {
    if (ending eq "png") {
        set terminal pngcairo size 1000, 1000 font "sans,14" background "white"
    } else {
        set terminal svg size 1000, 1000 font "sans,14" background "white"
    }
    set output picture.".".ending
    set multiplot
    set grid linetype 1 linewidth 0.7 linecolor "#e0e0e0"
    set border linewidth 1.2
    set tics nomirror
    set lmargin at screen 0.10
    set rmargin at screen 0.97
    set xrange [-120:120]
    set xtics 30
    set key top center horizontal samplen 2 opaque

    set tmargin at screen 0.98
    set bmargin at screen 0.69
    set format x ""
    set yrange [0:2.5]
    set ylabel "factor on the reference"
    set datafile separator ","
    plot history skip 1 using 6:2 with lines linewidth 2 linecolor rgb "#0072b2" title "load", \
         history skip 1 using 6:3 with lines linewidth 2 linecolor rgb "#d55e00" title "mean speed", \
         history skip 1 using 6:4 with lines linewidth 2 linecolor rgb "#009e73" title "radius of curvature", \
         history skip 1 using 6:5 with lines linewidth 2 linecolor rgb "#cc79a7" title "modulus"
    set datafile separator whitespace

    set tmargin at screen 0.66
    set bmargin at screen 0.39
    set yrange [0:0.7]
    set ylabel "central pressure / GPa"
    plot full using 1:2 with lines linewidth 2 linecolor rgb "#0072b2" title "full model", \
         reduced using 1:2 every 25 with points pointtype 6 linecolor rgb "#0072b2" title "reduced model"

    set tmargin at screen 0.36
    set bmargin at screen 0.08
    set format x "%g"
    set xlabel "angle of the cam from the nose / degrees"
    set yrange [0:0.45]
    set ylabel "film thickness / {/Symbol m}m"
    plot full using 1:3 with lines linewidth 2 linecolor rgb "#0072b2" title "centre, full model", \
         reduced using 1:3 every 25 with points pointtype 6 linecolor rgb "#0072b2" title "centre, reduced model", \
         full using 1:4 with lines linewidth 2 linecolor rgb "#d55e00" title "smallest, full model", \
         reduced using 1:4 every 25 with points pointtype 4 linecolor rgb "#d55e00" title "smallest, reduced model"
    unset multiplot
    unset output
}
