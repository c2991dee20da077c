# SPDX-License-Identifier: GPL-3.0-or-later
# Estimated against measured changes of H_c, in per cent, and how far a note at `limit` per cent is right.
#     awk -v limit=1 -f common.awk -f estimates.awk estimates.csv
function percent(x) { return x == "" ? "none" : sprintf("%.3g", 100 * x) }
function exceeds(x) { return x == "" || 100 * abs(x) > limit } # no estimate is a note as well

# Ratios are of changes that matter; what cannot be estimated has none.
function count(effect, estimated, measured,    ratio) {
    if (measured == "") return
    said[effect, exceeds(estimated), exceeds(measured)]++
    if (estimated == "" || 100 * abs(measured) < limit / 5) return
    ratio = estimated / measured
    if (!(effect in lowest) || ratio < lowest[effect]) lowest[effect] = ratio
    if (ratio > highest[effect]) highest[effect] = ratio
    number[effect]++
}

function verdict(effect) {
    printf "%-6s noted and true %d, not noted and true %d, noted though less %d, missed %d; estimated/measured %.2f to %.2f at the %d points above %g %%\n",
        effect, said[effect, 1, 1], said[effect, 0, 0], said[effect, 1, 0], said[effect, 0, 1], lowest[effect], highest[effect],
        number[effect], limit / 5
}

BEGIN {
    FS = ","
    printf "%6s %5s %6s %12s  %10s %10s  %10s %10s %6s  %6s %6s %6s\n", "", "", "", "", "inlet", "inlet", "step", "step", "order", "nodes:", "", ""
    printf "%6s %5s %6s %12s  %10s %10s  %10s %10s %6s  %6s %6s %6s\n", "M", "L", "step", "H_c", "estimated", "measured", "estimated", "measured", "", "inlet", "spike", "outlet"
}
FNR == 1 { next }
{
    printf "%6s %5s %6s %12s  %10s %10s  %10s %10s %6s  %6s %6s %6s\n", $1, $2, $3, $4, percent($5), percent($6), percent($7), percent($8),
        $9 == "" ? "none" : sprintf("%.2f", $9), $10, $11, $12
    count("inlet", $5, $6)
    count("step", $7, $8)
}
END {
    print ""
    verdict("inlet")
    verdict("step")
}
