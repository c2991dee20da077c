# SPDX-License-Identifier: GPL-3.0-or-later
# Force, approach and central film over time, of the reduced and of the full model. Variable: out, the
# folder of reduced.csv and full.csv and of the picture.
set datafile separator ","
do for [ending in "png svg"] {
    eval page(ending, 1000, 1000)
    set multiplot layout 3, 1 margins 0.11, 0.97, 0.07, 0.95 spacing 0.03
    set xrange [0:*]
    set autoscale xfix
    do for [row = 1:3] {
        if (row == 1) {
            set title "A mass on a lubricated line contact, shaken near its resonance"
            set key top right horizontal samplen 2.5
            set offsets 0, 0, graph 0.12, 0 # room for the key
            set ylabel "force  w / w_{ref}"
            set format x ""
        } else {
            unset title
            unset key
            unset offsets
        }
        if (row == 2) {
            set ylabel "approach  H_0"
        }
        if (row == 3) {
            set ylabel "central film  1000 H_c"
            set format x "%g"
            set xlabel "time  T = u t / a"
        }
        place = row == 1 ? 3 : row == 2 ? 2 : 4
        scale = row == 3 ? 1000 : 1
        plot out."/full.csv" using 1:(scale * column(place)) with lines linewidth 2 linecolor rgb blue title "full model", \
             out."/reduced.csv" using 1:(scale * column(place)) every 6::1 with points pointtype 6 pointsize 0.7 linewidth 1.5 linecolor rgb red title "reduced model"
    }
    unset multiplot
    unset xlabel
    unset output
}
