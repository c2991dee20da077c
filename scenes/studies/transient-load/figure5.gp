# SPDX-License-Identifier: GPL-3.0-or-later
# Pressure and film at one time, and a zoom of the outlet (paper, Fig. 5); lines: full model, marks:
# reduced model. Variables: picture (without its ending), profiles (path of the files before the kind),
# model, period, time.
full = profiles."full.dat"
reduced = profiles.model.".dat"

do for [ending in "png svg"] {
    eval page(ending, 1200, 620)
    set multiplot
    set title "T_{exc} = ".period.",  T = ".time offset 0, -0.5
    set xtics nomirror
    set ytics nomirror
    set y2tics
    set tmargin at screen 0.84
    set bmargin at screen 0.12
    set xlabel "position X, current frame"
    do for [part = 0:1] {
        set lmargin at screen (part == 0 ? 0.08 : 0.62)
        set rmargin at screen (part == 0 ? 0.51 : 0.90)
        set ylabel (part == 0 ? "pressure P" : "") textcolor rgb blue
        set y2label (part == 1 ? "film thickness H" : "") offset -1, 0 textcolor rgb red
        if (part == 0) {
            set xrange [-1.5:1.5]
            set yrange [0:1.2]
            set y2range [0:0.06]
            set xtics 0.5
            set key at screen 0.5, 0.985 center top horizontal samplen 2
        } else {
            set xrange [0.85:1.05]
            set yrange [0:0.6]
            set y2range [0:0.03]
            set xtics 0.05
            unset key
            set title "outlet"
        }
        marks = part == 0 ? 12 : 1
        plot full using 1:2 with lines linewidth 2 linecolor rgb blue title "P, full model", \
             reduced every marks using 1:2 with points pointtype 6 linecolor rgb blue title "P, reduced model", \
             full using 1:3 axes x1y2 with lines linewidth 2 linecolor rgb red title "H, full model", \
             reduced every marks using 1:3 axes x1y2 with points pointtype 4 linecolor rgb red title "H, reduced model"
    }
    unset multiplot
    unset output
}
