# SPDX-License-Identifier: GPL-3.0-or-later
# Load, central pressure and film over time, full model as lines, reduced model as marks. Variable: out, the folder of
# full.csv and reduced.csv.
set datafile separator ","
full = out."/full.csv"
reduced = out."/reduced.csv"
GPa(P, hertz_pressure) = P * hertz_pressure * 1e-9
um(H, film_unit) = H * film_unit * 1e6

do for [ending in "png svg"] {
    eval page(ending, 1000, 1000)
    set multiplot layout 3, 1 margins 0.11, 0.97, 0.07, 0.97 spacing 0.03
    set xrange [0:*]
    set yrange [*:*]
    set autoscale xfix
    set format x ""
    unset xlabel
    set ylabel "load / reference"
    set key top right horizontal samplen 2.5
    set offsets 0, 0, graph 0.15, graph 0.02 # room for the key
    plot full skip 1 using 1:2 with lines linewidth 2 linecolor rgb blue title "full model", \
         reduced skip 1 using 1:2 every 25 with points pointtype 6 linecolor rgb blue title "reduced model"
    unset key
    set ylabel "central pressure / GPa"
    plot full skip 1 using 1:(GPa($3, $6)) with lines linewidth 2 linecolor rgb blue, \
         reduced skip 1 using 1:(GPa($3, $6)) every 25 with points pointtype 6 linecolor rgb blue
    set format x "%g"
    set xlabel "time  T = u t / a"
    set ylabel "film thickness / {/Symbol m}m"
    set key top right horizontal samplen 2.5
    plot full skip 1 using 1:(um($4, $7)) with lines linewidth 2 linecolor rgb blue title "centre", \
         reduced skip 1 using 1:(um($4, $7)) every 25 with points pointtype 6 linecolor rgb blue notitle, \
         full skip 1 using 1:(um($5, $7)) with lines linewidth 2 linecolor rgb red title "smallest", \
         reduced skip 1 using 1:(um($5, $7)) every 25 with points pointtype 4 linecolor rgb red notitle
    unset multiplot
    unset output
}
