# SPDX-License-Identifier: GPL-3.0-or-later
# Cold starts of the full model against starts from the reduced solution, from what stationary.sh prints:
#     awk -f common.awk -f polish.awk -v csv=POLISH.csv COLD.txt REDUCED.txt
# Writes a line a scene to the CSV and prints what they came to together.
BEGIN { kinds["cold"]; kinds["reduced"]; kinds["polish"] }

$1 != "result" { next }
!($2 in known) { known[$2] = 1; scenes[++num_scenes] = $2 }
{
    kind = $3 == "reduced" ? "reduced" : FILENAME ~ /cold/ ? "cold" : "polish"
    if ($4 != 1) has[$2, kind] = 1
    iterations[$2, kind] = $5
    seconds[$2, kind] = $6
    film[$2, kind] = $7
}

END {
    print "scene,cold_iterations,cold_seconds,reduced_iterations,reduced_seconds,polish_iterations,polish_seconds,reduced_deviation,polish_difference" > csv
    for (i = 1; i <= num_scenes; i++) {
        s = scenes[i]
        if (!has[s, "cold"] || !has[s, "polish"] || !has[s, "reduced"]) { left_out++; continue }
        count++
        off = abs(film[s, "reduced"] / film[s, "cold"] - 1)
        difference = abs(film[s, "polish"] / film[s, "cold"] - 1)
        printf "%s,%d,%.4g,%d,%.4g,%d,%.4g,%.2e,%.2e\n", s, iterations[s, "cold"], seconds[s, "cold"], iterations[s, "reduced"],
            seconds[s, "reduced"], iterations[s, "polish"], seconds[s, "polish"], off, difference > csv

        for (k in kinds) {
            sum_iterations[k] += iterations[s, k]
            sum_seconds[k] += seconds[s, k]
            if (iterations[s, k] > most[k]) most[k] = iterations[s, k]
        }
        if (off > worst_off) worst_off = off
        if (difference > worst) worst = difference
        if (seconds[s, "reduced"] + seconds[s, "polish"] > seconds[s, "cold"]) slower++
    }
    if (!count) {
        print "polish.awk: found no scene that all three solved, expected some" > "/dev/stderr"
        exit 1
    }
    printf "full model, %d scenes%s: cold start against start from the reduced solution\n", count,
        left_out ? sprintf(" (%d more not solved by all)", left_out) : ""
    printf "%-28s %22s %12s\n", "", "iterations: mean, most", "mean time"
    printf "%-28s %15.1f %6d %9.2f ms\n", "cold start", sum_iterations["cold"] / count, most["cold"], 1000 * sum_seconds["cold"] / count
    printf "%-28s %15.1f %6d %9.2f ms\n", "reduced solution", sum_iterations["reduced"] / count, most["reduced"], 1000 * sum_seconds["reduced"] / count
    printf "%-28s %15.1f %6d %9.2f ms\n", "full model from it", sum_iterations["polish"] / count, most["polish"], 1000 * sum_seconds["polish"] / count
    printf "time saved: %.0f %%; slower than a cold start: %d scenes; H_c moves by at most %.1e and ends at most %.1e from the cold start's\n",
        100 * (1 - (sum_seconds["reduced"] + sum_seconds["polish"]) / sum_seconds["cold"]), slower, worst_off, worst
}
