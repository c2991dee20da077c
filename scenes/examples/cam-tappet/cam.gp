# SPDX-License-Identifier: GPL-3.0-or-later
# What varies over the angle of the cam, and the film that follows. Variable: out, the folder of full.csv and reduced.csv.
set datafile separator ","
full = out."/full.csv"
reduced = out."/reduced.csv"
history = "out/history.csv"

# The angle is a linear function of time.
stats full skip 1 using 1 nooutput
angle(T) = -120 + 240 * T / STATS_max
GPa(P, hertz_pressure) = P * hertz_pressure * 1e-9
um(H, film_unit) = H * film_unit * 1e6

do for [ending in "png svg"] {
    eval page(ending, 1000, 1000)
    set multiplot
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
    plot history skip 1 using 6:2 with lines linewidth 2 linecolor rgb blue title "load", \
         history skip 1 using 6:3 with lines linewidth 2 linecolor rgb red title "mean speed", \
         history skip 1 using 6:4 with lines linewidth 2 linecolor rgb green title "radius of curvature", \
         history skip 1 using 6:5 with lines linewidth 2 linecolor rgb pink title "modulus"

    set tmargin at screen 0.66
    set bmargin at screen 0.39
    set yrange [0:0.7]
    set ylabel "central pressure / GPa"
    plot full skip 1 using (angle($1)):(GPa($3, $6)) with lines linewidth 2 linecolor rgb blue title "full model", \
         reduced skip 1 using (angle($1)):(GPa($3, $6)) every 25 with points pointtype 6 linecolor rgb blue title "reduced model"

    set tmargin at screen 0.36
    set bmargin at screen 0.08
    set format x "%g"
    set xlabel "angle of the cam from the nose / degrees"
    set yrange [0:0.45]
    set ylabel "film thickness / {/Symbol m}m"
    plot full skip 1 using (angle($1)):(um($4, $7)) with lines linewidth 2 linecolor rgb blue title "centre, full model", \
         reduced skip 1 using (angle($1)):(um($4, $7)) every 25 with points pointtype 6 linecolor rgb blue title "centre, reduced model", \
         full skip 1 using (angle($1)):(um($5, $7)) with lines linewidth 2 linecolor rgb red title "smallest, full model", \
         reduced skip 1 using (angle($1)):(um($5, $7)) every 25 with points pointtype 4 linecolor rgb red title "smallest, reduced model"
    unset multiplot
    unset output
}
