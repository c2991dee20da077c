# SPDX-License-Identifier: GPL-3.0-or-later
# The tables of conditioning.csv: what all cases of a region come to, a line for each size or variant.
#     awk -f common.awk -f table.awk conditioning.csv
# "-": no system had a single solution.
function number(x) { return sprintf("%8s", x == "" ? "-" : x == "inf" ? "fails" : sprintf("%.1e", x)) }

# Cases that a solver brought to their ends, of all.
function ends(key, solver) { return sprintf("%8s", (solved[key, solver] + 0) "/" count[key, solver]) }

function median(list,   i, j, n, value, swap) {
    n = split(list, value, " ")
    for (i = 1; i < n; i++)
        for (j = i + 1; j <= n; j++)
            if (value[j] + 0 < value[i] + 0) { swap = value[i]; value[i] = value[j]; value[j] = swap }
    return value[int((n + 1) / 2)]
}

function head(title) {
    printf "\n%s\n", title
    printf "%-7s %5s %4s %9s  %26s  %44s  %35s  %17s\n", "", "modes", "rows", "equations", "condition         ",
        "largest error of a step              ", "solved               ", "H_c off from    "
    printf "%-7s %5s %4s %9s  %8s %8s %8s  %8s %8s %8s %8s %8s  %8s %8s %8s %8s  %8s %8s\n", "", "", "", "", "median", "worst",
        "unscaled", "normal", "refined", "QR", "single", "+refined", "extended", "used", "normal", "single", "extended", "full"
}

function line(key) {
    printf "%-7s %5d %4d %4d-%-4d  %s %s %s  %s %s %s %s %s  %s %s %s %s  %s %s\n", value[key], modes[key], rows[key], fewest[key],
        most[key], number(median(conditions[key])), number(worst[key]), number(unscaled[key]), number(error[key, "normal"]),
        number(error[key, "refined"]), number(error[key, "qr"]), number(error[key, "single"]),
        number(error[key, "single-refined"]), ends(key, "extended"), ends(key, "used"), ends(key, "normal"),
        ends(key, "single"), number(film[key]), number(full[key])
}

function time_table(group,   i, s, key, n, solver) {
    n = split("used normal refined qr single single-refined", solver, " ")
    printf "\n%s: microseconds for a system, median of the cases\n%5s", title[group], "modes"
    for (s = 1; s <= n; s++) printf " %14s", solver[s]
    for (i = 1; i <= num_keys[group]; i++) {
        key = keys[group, i]
        printf "\n%5d", modes[key]
        for (s = 1; s <= n; s++) printf " %14s", times[key, solver[s]] == "" ? "fails" : sprintf("%.1f", median(times[key, solver[s]]))
    }
    print ""
}

# Whose line it is, and a new line where there is none yet.
function find(   kind, rule, group, key) {
    split($column["variant"], kind, "=")
    most_rows[$1] = larger(most_rows[$1], $column["rows"] + 0)
    rule = $column["modes"] == $column["rows"] ? "a row for a mode" : $column["rows"] == most_rows[$1] ? "all rows" : "8 rows for 5 modes"
    group = $1 SUBSEP kind[1] SUBSEP rule
    key = group SUBSEP kind[2] SUBSEP $column["modes"]
    if (!(group in num_keys)) {
        groups[++num_groups] = group
        title[group] = region[$1] ", " text[kind[1]] ", " rule
    }
    if (!(key in modes)) {
        keys[group, ++num_keys[group]] = key
        value[key] = kind[2]
        modes[key] = $column["modes"]
        rows[key] = $column["rows"]
        fewest[key] = $column["equations"]
    }
    return key
}

BEGIN {
    FS = ","
    region["low"] = "Lower loaded region"; region["high"] = "Higher loaded region"; region["time"] = "In time"
    text["stored"] = "as stored"; text["without-D"] = "without D"; text["single"] = "bases rounded to single precision"
    text["dependent"] = "last mode apart from that before it by"; text["rate"] = "steps of rate"
    print "Conditioning of the reduced least squares, over all cases. Condition: of the last iteration's matrix, its columns"
    print "scaled unless said. Error of a step: relative, columns scaled, against QR in extended precision, the largest of all"
    print "iterations and cases; \"fails\": no Cholesky factor. Solved: cases that Newton with this solver brings to an end."
    print "H_c off: the largest relative difference of the solver in use, from Newton in extended precision and the full model."
}

FNR == 1 { read_header(column); next }
{
    key = find()
    solver = $column["solver"]
    if ($column["equations"] + 0 < fewest[key]) fewest[key] = $column["equations"]
    most[key] = larger(most[key], $column["equations"] + 0)
    count[key, solver]++
    converged = $column["status"] == "converged"
    solved[key, solver] += converged
    if (solver == "extended") {
        conditions[key] = conditions[key] " " $column["scaled_condition"]
        worst[key] = larger(worst[key], $column["scaled_condition"] + 0)
        unscaled[key] = larger(unscaled[key], $column["condition"] + 0)
        reference = converged
    }
    if ($column["step_error"] == "inf") error[key, solver] = "inf"
    else if ($column["step_error"] !~ /nan/ && error[key, solver] != "inf")
        error[key, solver] = larger(error[key, solver], $column["step_error"] + 0)
    if (solver == "used" && converged) {
        full[key] = larger(full[key], abs($column["from_full"]))
        if (reference) film[key] = larger(film[key], abs($column["from_extended"]))
    }
    if ($column["microseconds"] !~ /nan/) times[key, solver] = times[key, solver] " " $column["microseconds"]
}

END {
    for (g = 1; g <= num_groups; g++) {
        head(title[groups[g]])
        for (i = 1; i <= num_keys[groups[g]]; i++) line(keys[groups[g], i])
    }
    for (g = 1; g <= num_groups; g++)
        if (groups[g] ~ /stored.all rows$/) time_table(groups[g])
}
