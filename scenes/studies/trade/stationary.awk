# SPDX-License-Identifier: GPL-3.0-or-later
# Deviation and time of all alternatives as CSV, from what ladder.sh and stationary.sh print, the reference
# first:
#     awk -f common.awk -f stationary.awk LADDER.txt REFERENCE.txt WAY.txt...
# Deviations are relative and of the central film (of the smallest one where a formula is for that), seconds the
# median of the scenes. What the grid of the reference does itself stands in lines without a time.
# Adds to the ascending values of a row.
function add(row, x,   i) {
    for (i = ++count[row]; i > 1 && value[row, i - 1] > x; i--) value[row, i] = value[row, i - 1]
    value[row, i] = x
}

# What the part q of the values does not exceed (nearest rank).
function quantile(row, q,   rank) {
    if (!count[row]) return "nan"
    rank = int(q * count[row])
    if (rank < q * count[row]) rank++
    return sprintf("%.4g", value[row, rank < 1 ? 1 : rank])
}

function see(row) { if (!(row in seen)) { seen[row] = 1; rows[++num_rows] = row } }

# ROW: alternative,position,quantity
function print_row(row, with_time) {
    printf "%s,%d,%d,%s,%s,%s,%s\n", row, count[row "deviation"] + failures[row], failures[row],
        quantile(row "deviation", 1), quantile(row "deviation", 0.95), quantile(row "deviation", 0.5),
        with_time ? quantile(row "seconds", 0.5) : ""
}

BEGIN { print "alternative,position,quantity,scenes,failures,worst,deviation_95,median,seconds" }

$1 == "ladder" {
    printf "reduced,%d modes %s%d rows,central,%d,%d,%s,%s,%s,%s\n", $2, ($3 > 0 ? "and " $3 " " : ""), $4, $5, $6, $7, $8, $9, $10
    next
}

FNR == 1 { files++ }

$1 == "result" && files == 1 && $4 != 1 { film[$2] = $7 }
$1 == "result" && $3 == "reduced" { extra[$2] = $6; next }
$1 == "result" {
    split($3, way, "-")
    tolerance = substr($3, length(way[1] way[2]) + 3)
    row = "full " (way[1] == "cold" ? "cold" : "from " way[1]) ",step " sprintf("%.3g", way[2]) " times tolerance " tolerance ",central"
    see(row)
    if ($4 == 1) { failures[row]++; next }
    if (way[1] == "reduced") { polish = row; polished[$2] = $6 }
    else add(row "seconds", $6)
    if ($2 in film) add(row "deviation", abs($7 / film[$2] - 1))
}

# Of the reference alone: the formulas are the same whatever solves the scene.
$1 == "formula" && files == 1 {
    row = "formula," $3 "," $4
    see(row)
    add(row "deviation", abs($5) / 100)
    add(row "seconds", $6)
}
$1 == "effect" && files == 1 {
    if ($3 != "nan") add("reference,step,central" "deviation", abs($3))
    if ($4 != "nan") add("reference,inlet,central" "deviation", abs($4)) # known of a line contact
}

END {
    # a start from the reduced model costs its solution too
    for (scene in polished) add(polish "seconds", polished[scene] + extra[scene])
    for (i = 1; i <= num_rows; i++) print_row(rows[i], 1)
    print_row("reference,step,central", 0)
    if (count["reference,inlet,central" "deviation"]) print_row("reference,inlet,central", 0)
}
