# SPDX-License-Identifier: GPL-3.0-or-later
# What the map says: points that fail, one line each, then a line for each lubricant. A point is good when
# it converged, its scaled residual is below 1e-8, no node has a negative pressure or multiplier, and the
# exit lies inside of the domain. Exit code 1 when one fails or there are fewer than `least` points.
#     awk -v least=1000 -f summary.awk map.csv
BEGIN { FS = "," }
FNR == 1 { next }
{
    lubricant = sprintf("%-9s %-17s", $1, $2)
    if (!(lubricant in points)) order[++kinds] = lubricant
    points[lubricant]++
    all++
    if ($8 != 0 || !($10 < 1e-8) || !($11 <= 0) || !($12 > 0 && $12 < 2)) {
        failed[lubricant]++
        failures++
        print "failed: " $0
        next
    }
    if ($10 > residual[lubricant]) residual[lubricant] = $10
    if ($12 > exit_at[lubricant]) exit_at[lubricant] = $12
    if ($5 > hardest[lubricant]) hardest[lubricant] = $5
    if ($9 > most[lubricant]) most[lubricant] = $9
    sum[lubricant] += $9
}
END {
    printf "%-27s %6s %6s  %9s  %12s %9s  %s\n", "cold starts", "points", "failed", "alpha p_H", "residual", "last exit", "Newton mean, most"
    for (k = 1; k <= kinds; k++) {
        l = order[k]
        printf "%-27s %6d %6d  %9.1f  %12.1e %9.3f  %6.1f %8d\n", l, points[l], failed[l], hardest[l], residual[l],
            exit_at[l], sum[l] / (points[l] - failed[l] + !sum[l]), most[l]
    }
    printf "%d points, %d failed\n", all, failures
    exit failures > 0 || all < least
}
