# SPDX-License-Identifier: GPL-3.0-or-later
# Central pressure and film of the full model over time, and deviations of the reduced one (paper, Fig. 4).
# Variables: out (folder of full/adaptive-PERIOD.dat and deviation-adaptive-PERIOD.txt), periods.
colour(period) = word("#0072b2 #d55e00 #009e73 #cc79a7 #e69f00 #56b4e9", int(system("echo ".periods." | tr ' ' '\\n' | grep -nxF ".period." | cut -d: -f1")))

# Periods far above the time a_ref/u_ref have a column of their own, over parts of the period.
of_column(long) = system(sprintf("echo %s | tr ' ' '\\n' | awk '($1 > 100) == %d' | tr '\\n' ' '", periods, long))
right_end = words(of_column(1)) > 0 ? 0.665 : 0.985 # of the first column
heading(row) = row == 0 ? "P_c, reference frame" : row == 1 ? "H_c, reference frame" : row == 2 ? "P_c, deviation / %" : "H_c, deviation / %"
row_top(row) = 0.945 - 0.22 * row

do for [ending in "png svg"] {
    eval page(ending, 1300, 1200)
    set multiplot
    do for [long = 0:1] {
        shown = of_column(long)
        if (words(shown) == 0) { continue }
        set lmargin at screen (long ? 0.765 : 0.085)
        set rmargin at screen (long ? 0.985 : right_end)
        set xrange [0:*] noextend
        do for [row = 0:3] {
            set tmargin at screen row_top(row)
            set bmargin at screen row_top(row) - 0.2
            set format x (row == 3 ? "%g" : "")
            set xlabel (row < 3 ? "" : long ? "T / T_{exc}" : "time T = t u_{ref} / a_{ref}")
            set ylabel (long ? "" : heading(row)) offset (row == 1 ? 1.5 : 0), 0
            set key at screen (long ? 0.985 : right_end), 0.985 right top horizontal maxrows 1 samplen 2
            if (row == 0) {
                set key
            } else {
                unset key
            }
            plot for [period in shown] out.(row < 2 ? "/full/adaptive-".period.".dat" : "/deviation-adaptive-".period.".txt") \
                     using ($1 / (long ? period + 0.0 : 1.0)):(column(row < 2 ? row + 3 : row)) \
                     with lines linewidth 2 linecolor rgb colour(period) title "T_{exc} = ".period
        }
    }
    unset multiplot
    unset output
}
