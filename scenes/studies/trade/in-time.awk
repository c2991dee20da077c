# SPDX-License-Identifier: GPL-3.0-or-later
# Deviation and time of all alternatives in time as CSV, from what in-time.sh prints:
#     awk -f in-time.awk -v coarse=WAY WAY.txt...
# Deviations are relative, the largest of all trajectories; seconds are those of a whole trajectory, their mean. What
# the reference's grid does itself is a third of what twice its step does (`coarse`), as of second order.
function raise(row, k, x) { if (!(value[row, k] >= x) || value[row, k] == "") value[row, k] = x }

function see(row) { if (!(row in seen)) { seen[row] = 1; rows[++num_rows] = row } }

function steps_of(text) {
    if (sub(/^fixed/, "", text)) return "fixed steps " text
    if (sub(/^still/, "", text)) return "stationary at " text " times"
    return "tolerance " text
}

function name_of(way,   part, n, steps) {
    n = split(way, part, "-")
    steps = way
    if (part[1] == "full") {
        sub(/^[^-]*-[^-]*-/, "", steps)
        return "full,step " part[2] " times " steps_of(steps) ",central"
    }
    sub(/^[^-]*-[^-]*-[^-]*-[^-]*-/, "", steps)
    return "reduced," part[2] " modes " (part[3] > 0 ? "and " part[3] " " : "") part[4] " rows " steps_of(steps) ",central"
}

function print_row(row, part, with_time) {
    printf "%s,%d,%d,%s,%s,%s,%s\n", row, count[row], failures[row], number(row, 1, part), number(row, 2, part), number(row, 3, part),
        with_time && done[row] ? sprintf("%.4g", seconds[row] / done[row]) : ""
}

function number(row, k, part) { return (row, k) in value ? sprintf("%.4g", part * value[row, k]) : "nan" }

BEGIN { print "alternative,position,quantity,scenes,failures,worst,deviation_95,median,seconds" }

$1 == "trajectory" || $1 == "formula" {
    at = $1 == "formula" ? 5 : 7
    row = $1 == "formula" ? "formula," $3 "," $4 : name_of($3)
    see(row)
    count[row]++
    if ($1 == "trajectory" && $3 == coarse) coarse_row = row
    if ($1 == "trajectory" && $4 != 0) { failures[row]++; next }
    for (k = 1; k <= 3; k++) raise(row, k, $(at + k - 1) + 0)
    seconds[row] += $1 == "formula" ? $8 : $6
    done[row]++
}

END {
    for (i = 1; i <= num_rows; i++) print_row(rows[i], 1, 1)
    for (k = 1; k <= 3; k++) if ((coarse_row, k) in value) value["reference,step,central", k] = value[coarse_row, k] / 3
    count["reference,step,central"] = done[coarse_row]
    print_row("reference,step,central", 1, 0)
}
