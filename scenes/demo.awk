# SPDX-License-Identifier: GPL-3.0-or-later
# Prints the comparison of full and reduced results, and below each the published figures.
#     collect.sh ... | awk -f demo.awk -v model="SIZES" - cases.csv
function magnitude(x) { return x < 0 ? -x : x }

function row(first, film_full, film_reduced, deviation, iterations_full, iterations_reduced, full, reduced, note) {
    printf "%-9s %5s %4s %5s   %11.8f %11.8f %9.3f   %5d %7d   %8.1f %8.2f %8.0f%s\n", first[1], first[2], first[3],
        first[4], film_full, film_reduced, deviation, iterations_full, iterations_reduced, full, reduced, full / reduced, note
}

function head(with_published) {
    split(model, size, " ")
    printf "\nFull model: %d nodes, %d unknowns. Reduced model: %d unknowns, %d Reynolds rows, %d training solutions.\n",
        size[1], size[2], size[4], size[7], size[3]
    printf "H_c: film thickness at the centre.%s\n\n", with_published ? " The second line of a case: as published." : ""
    printf "%-9s %5s %4s %5s   %11s %11s %9s   %13s   %17s %8s\n", "lubricant", "M", "L", "p_H", "H_c", "H_c", "deviation", "iterations", "time / ms", "speed-up"
    printf "%-9s %5s %4s %5s   %11s %11s %9s   %5s %7s   %8s %8s\n", "", "", "", "GPa", "full", "reduced", "permille", "full", "reduced", "full", "reduced"
    rule = sprintf("%104s", "")
    gsub(" ", "-", rule)
    print rule
}

$1 == "result" {
    status[$2, $3 == "full"] = $4
    iterations[$2, $3 == "full"] = $5
    time[$2, $3 == "full"] = 1000 * $6
    film[$2, $3 == "full"] = $7
    next
}

FNR == 1 { FS = ","; $0 = $0; head(NF > 4); next }

NF > 1 {
    name = ($1 == "" ? "" : $1 "-") "M" $2 "-L" $3 ($4 == "" ? "" : "-p" $4)
    if (!((name, 0) in film) || !((name, 1) in film)) {
        printf "%-24s no result\n", name
        missing = 1
        next
    }
    deviation = 1000 * magnitude(film[name, 0] / film[name, 1] - 1)
    note = status[name, 1] == 1 || status[name, 0] == 1 ? "  not converged" : status[name, 0] == 4 ? "  outside of training" : ""
    if (deviation > worst) { worst = deviation; worst_name = name }
    if (time[name, 0] > slowest) slowest = time[name, 0]
    split($0, first, ",")
    row(first, film[name, 1], film[name, 0], deviation, iterations[name, 1], iterations[name, 0], time[name, 1], time[name, 0], note)
    if ($9 != "") {
        published_row[1] = "published"
        row(published_row, $9, $10, $11, $5, $6, 1000 * $7, 1000 * $8, "")
        if ($11 > published) published = $11
    }
}

END {
    print rule
    printf "worst deviation: %.3f permille (%s)%s; slowest reduced solution: %.2f ms\n", worst, worst_name,
        published == "" ? "" : sprintf(", published %.3f", published), slowest
    exit missing
}
