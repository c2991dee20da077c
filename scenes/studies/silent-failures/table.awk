# SPDX-License-Identifier: GPL-3.0-or-later
# Counts what run.sh prints:
#     awk -f common.awk -f table.awk -v seed=N -v calibration=N RUNS.txt
# A scene is good where the central film deviates by no more than promised, and flagged with exit code 4. One
# that does not converge, exit code 3, has no result that could be wrong.

function name_of(where, whose) {
    return where == "outside" ? "outside, any lubricant" : "inside, " whose " lubricant" (whose == "own" ? "" : "s")
}

function count(promise, group, what) { return number[promise, group, what] + 0 }

{
    group = name_of($2, $3)
    if (!($1 in seen)) { seen[$1] = 1; promises[++num_promises] = $1 }
    if ($6 == "-") what = "no reference"
    else if ($4 == 3) what = "not solved"
    else if ($4 != 0 && $4 != 4) what = "error"
    else {
        deviation = abs($5 / $6 - 1)
        good = deviation <= $1
        what = (good ? "good " : "bad ") ($4 == 4 ? "flagged" : "not flagged")
        if (!good && $4 == 0) silent++
        if (!good && $4 == 0 && deviation > worst) worst = deviation
    }
    if (what == "error") errors++
    number[$1, group, what]++
}

END {
    groups[1] = name_of("inside", "own"); groups[2] = name_of("inside", "other"); groups[3] = name_of("outside", "")
    printf "seed %s, calibrated on seed %s\n\n", seed, calibration
    printf "%-24s %8s %8s %12s %16s %8s %10s %12s\n", "", "good,", "good,", "of the good", "bad, not", "bad,", "not", "full model"
    printf "%-24s %8s %8s %12s %16s %8s %10s %12s\n", "", "quiet", "flagged", "flagged", "flagged: silent", "flagged", "solved", "has none"
    for (i = 1; i <= num_promises; i++) {
        promise = promises[i]
        printf "promise %g\n", promise
        for (g = 1; g <= 3; g++) {
            quiet = count(promise, groups[g], "good not flagged")
            loud = count(promise, groups[g], "good flagged")
            printf "  %-22s %8d %8d %10.1f %% %16d %8d %10d %12d\n", groups[g], quiet, loud,
                quiet + loud ? 100 * loud / (quiet + loud) : 0, count(promise, groups[g], "bad not flagged"),
                count(promise, groups[g], "bad flagged"), count(promise, groups[g], "not solved"),
                count(promise, groups[g], "no reference")
        }
    }
    printf "\nsilent failures: %d%s\n", silent, silent ? sprintf(", the worst %.2g off", worst) : ""
    if (errors) { printf "found %d runs that ended otherwise, expected none\n", errors; exit 1 }
}
