# SPDX-License-Identifier: GPL-3.0-or-later
# The table of speed.sh, from what it shows: results 1 to 3 of the full and 0 of the reduced model, then the case's name.
function permille(k) { return 1000 * (value[0, k] / value[1, k] - 1) }

BEGIN { FS = ","; status = 3; iterations = 4; central = 5; minimum = 6; seconds = 7; step = 8 }
$1 == "result" { for (k = 3; k <= NF; k++) value[$2, k] = $k; lines[$2] = 0 }
$1 == "exit" { exit_at[$2, ++lines[$2]] = $3 }
$1 == "case" {
    full = value[1, seconds]
    for (i = 2; i <= 3; i++) if (value[i, seconds] < full) full = value[i, seconds]
    reduced = value[0, seconds]
    sum = most = 0
    for (l = 1; l <= lines[0]; l++) {
        apart = abs(exit_at[0, l] - exit_at[1, l]) / value[0, step]
        sum += apart
        most = larger(most, apart)
    }
    mean = sum / lines[0]
    printf "%-12s %9.3f %9.3f %9.0f %6d %4d %10.4f %10.4f %8.2f %5.0f%s\n", $2, full, 1e3 * reduced, full / reduced,
        value[1, iterations], value[0, iterations], permille(central), permille(minimum), mean, most,
        value[0, status] == 4 ? "  outside of training" : ""
    if (value[0, status] == 4) next
    if (!cases++ || full / reduced < ratio) ratio = full / reduced
    slowest = larger(slowest, reduced)
    worst_central = larger(worst_central, abs(permille(central)))
    worst_minimum = larger(worst_minimum, abs(permille(minimum)))
    most_iterations = larger(most_iterations, value[0, iterations] + 0)
    worst_exit = larger(worst_exit, most)
    sum_mean += mean
}
END {
    if (cases) printf "%-12s %9s %9.3f %9.0f %11d %10.4f %10.4f %8.2f %5.0f\n", "worst", "", 1e3 * slowest, ratio, most_iterations,
        worst_central, worst_minimum, sum_mean / cases, worst_exit
}
