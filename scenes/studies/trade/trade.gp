# SPDX-License-Identifier: GPL-3.0-or-later
# Deviation of the central film against time of a solution, from the worst scene (mark) down to the median (end of
# the bar). Variables: data (trade.csv), picture (without its ending), regime, width (pixels).
stationary = regime eq "stationary"
lowest = stationary ? 1e-9 : 1e-5   # where the reference is drawn, and what deviates even less

# Alternatives by name and position: seconds, worst, median, position. Either those without failures or (failing = 1)
# those with; a first point out of sight, since gnuplot warns of empty data.
points(alternative, position, failing) = sprintf( \
    "<awk -F, -v low=%g 'BEGIN { print 1e-30, 1, 1, 0 } FNR > 1 && $9 > 0 && $6 != \"nan\" && $1 ~ /%s/ && $2 ~ /%s/ && ($5 > 0) == %d { gsub(\" \", \"_\", $2); print $9, ($6 < low ? low : $6), ($8 < low ? low : $8), $2 }' %s", \
    lowest, alternative, position, failing, data)
coarser = "step ([02-9]|1[0-9]).* times [tf]"
of_grid(what, column) = 0.0 + system(sprintf( \
    "awk -F, '$1 == \"reference\" && $2 == \"%s\" { x = $%d } END { print (x > 0 ? x : 1e-30) }' %s", what, column, data))

# The formulas and their worst deviation, the worst first, as one label.
formulas = "film formulas, worst:\n" . system("awk -F, '$1 == \"formula\" { printf \"%s %.0f %%%s\\n\", $2, 100 * $6, ($3 == \"minimum\" ? \", minimum\" : \"\") }' ".data." | sed 's/-minimum//; s/-central//' | sort -k 2gr | head -c -1")


do for [ending in "png svg"] {
    eval page(ending, width, 0.8 * width)
    eval sprintf("set termoption fontscale %g", width / 1000.)
    set logscale xy
    set format x "10^{%L}"
    set format y "10^{%L}"
    set xrange [(stationary ? 1e-8 : 1e-5):(stationary ? 1 : 200)]
    set yrange [lowest / 2:2]
    set xlabel stationary ? "time of a solution / s" : "time of a trajectory / s"
    set ylabel "deviation of H_c: worst (mark), median (end of the bar)"
    set key outside bottom center horizontal Left reverse maxcols 2 width -6 samplen 1 spacing 1.2
    set arrow 1 from graph 0, first of_grid("step", 6) to graph 1, first of_grid("step", 6) nohead dashtype 2 linewidth 1.5 linecolor "#666666"
    set arrow 2 from graph 0, first of_grid("step", 8) to graph 1, first of_grid("step", 8) nohead dashtype 3 linewidth 1.5 linecolor "#666666"
    set label 1 "the grid itself, worst" at graph 0.01, first of_grid("step", 6) offset 0, 0.5 textcolor "#444444"
    set label 2 "the grid itself, median" at graph 0.01, first of_grid("step", 8) offset 0, -0.6 textcolor "#444444"
    set label 3 "none (or less): the reference" at graph 0.01, first lowest offset 0, 0.6 textcolor "#444444"
    set label 4 formulas at graph 0.012, graph 0.4 font ",12" textcolor "black"
    bars(alternative, position) = points(alternative, position, 0)
    if (stationary) {
        plot bars("^formula", "") using 1:2:(0):($3 - $2) with vectors nohead linewidth 1.6 linecolor "black" notitle, \
             bars("^formula", "") using 1:2 with points pointtype 7 pointsize 0.9 linecolor "black" title "film formulas", \
             bars("^reduced", "") using 1:2:(0):($3 - $2) with vectors nohead linewidth 1.6 linecolor rgb blue notitle, \
             bars("^reduced", "") using 1:2 with points pointtype 7 pointsize 1.1 linecolor rgb blue title "reduced model, sizes", \
             points("^reduced", "", 1) using 1:2 with points pointtype 2 pointsize 0.8 linecolor rgb sky title "the same, failing on some scenes", \
             bars("^full from neighbour", "") using 1:2:(0):($3 - $2) with vectors nohead linewidth 1.6 linecolor rgb green notitle, \
             bars("^full from neighbour", "1e-10") using 1:2 with points pointtype 9 pointsize 1.3 linecolor rgb green title "full model from a neighbour, grids", \
             bars("^full from neighbour", "1e-[1-9]$") using 1:2 with points pointtype 8 pointsize 1.3 linewidth 1.6 linecolor rgb green title "the same, looser tolerances", \
             bars("^full cold", "") using 1:2:(0):($3 - $2) with vectors nohead linewidth 1.6 linecolor rgb red notitle, \
             bars("^full cold", "1e-10") using 1:2 with points pointtype 5 pointsize 1.1 linecolor rgb red title "full model, cold start, grids", \
             bars("^full cold", "1e-[1-9]$") using 1:2 with points pointtype 4 pointsize 1.1 linewidth 1.6 linecolor rgb red title "the same, looser tolerances", \
             points("^full", "", 1) using 1:2 with points pointtype 2 pointsize 0.8 linecolor rgb orange title "full model, failing on some scenes", \
             bars("^full from reduced", "") using 1:2 with points pointtype 13 pointsize 1.6 linecolor rgb pink title "full model from the reduced solution"
    } else {
        plot bars("^formula", "") using 1:2:(0):($3 - $2) with vectors nohead linewidth 1.6 linecolor "black" notitle, \
             bars("^formula", "") using 1:2 with points pointtype 7 pointsize 0.9 linecolor "black" title "film formulas at each time", \
             bars("^reduced", "") using 1:2:(0):($3 - $2) with vectors nohead linewidth 1.6 linecolor rgb blue notitle, \
             bars("^reduced", "tolerance") using 1:2 with points pointtype 7 pointsize 1.1 linecolor rgb blue title "reduced model, sizes and tolerances", \
             bars("^reduced", "fixed") using 1:2 with points pointtype 6 pointsize 1.1 linewidth 1.6 linecolor rgb blue title "reduced model, fixed steps", \
             points("^(full|reduced)", "", 1) using 1:2 with points pointtype 2 pointsize 0.8 linecolor rgb sky title "either model, some trajectory lost", \
             bars("^full", "step 1 times") using 1:2:(0):($3 - $2) with vectors nohead linewidth 1.6 linecolor rgb red notitle, \
             bars("^full", "step 1 times tolerance") using 1:2 with points pointtype 5 pointsize 1.1 linecolor rgb red title "full model, tolerances", \
             bars("^full", "step 1 times fixed") using 1:2 with points pointtype 4 pointsize 1.1 linewidth 1.6 linecolor rgb red title "full model, fixed steps", \
             bars("^full", coarser) using 1:2:(0):($3 - $2) with vectors nohead linewidth 1.6 linecolor rgb green notitle, \
             bars("^full", coarser) using 1:2 with points pointtype 9 pointsize 1.3 linecolor rgb green title "full model, coarser grids", \
             bars("", "stationary") using 1:2 with points pointtype 13 pointsize 1.6 linecolor rgb pink title "either model, stationary at each time"
    }
    unset output
}
