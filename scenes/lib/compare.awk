# SPDX-License-Identifier: GPL-3.0-or-later
# Prints full and reduced results of all cases beside each other, and below each the published figures where there are
# some; writes them to a CSV file too. Films in um where a result says what unit they have.
#     { size MODEL SIZES...; unit CASE METRES; grid CASE INLET STEP; collect.sh ...; } | awk -f common.awk -f compare.awk -v cases="NAME..." \
#         -v csv=RESULTS.csv - cases.csv
# Sizes: n, modes, deformation modes, rows, needed nodes, training solutions (model.sh).
function row(label, micrometres, film_full, film_reduced, deviation, iterations_full, iterations_reduced, full, reduced, note) {
    printf "%-*s %s  %11.8f %11.8f %9.3f   %5d %7d   %8.1f %8.2f %8.0f%s\n", width, label, in_micrometres ? micrometres : "", film_full,
        film_reduced, deviation, iterations_full, iterations_reduced, full, reduced, full / reduced, note
}

function head() {
    printf "\nFull model: %d nodes, %d unknowns. Reduced model: %d unknowns, %d Reynolds rows, %d training solutions.\n",
        size[3], 2 * size[3] + 1, size[4] + size[5] + 1, size[6], size[8]
    printf "H_c: film thickness at the centre.%s\n\n", published_columns ? " The second line of a case: as published." : ""
    printf "%-*s %s  %11s %11s %9s   %13s   %17s %8s\n", width, "", in_micrometres ? sprintf("%9s", "film") : "", "H_c", "H_c", "deviation",
        "iterations", "time / ms", "speed-up"
    printf "%-*s %s  %11s %11s %9s   %5s %7s   %8s %8s\n", width, "case", in_micrometres ? sprintf("%9s", "um") : "", "full", "reduced",
        "permille", "full", "reduced", "full", "reduced"
    print_rule(width + (in_micrometres ? 9 : 0) + 81)
}

# What inlet and step do to the full model's own central film, where it is more than 1 %.
function effect(label, part) {
    return part > 0.01 || part < -0.01 ? sprintf("  %s %+.0f %%", label, 100 * part) : ""
}

BEGIN { num_cases = split(cases, names, " "); width = 10 }

$1 == "size" { split($0, size, " "); next }
$1 == "unit" { unit[$2] = $3; in_micrometres = 1; next }
$1 == "grid" { inlet[$2] = $3; step[$2] = $4; next }
$1 == "result" {
    full = $3 == "full"
    status[$2, full] = $4
    iterations[$2, full] = $5
    time[$2, full] = 1000 * $6
    film[$2, full] = $7
    smallest[$2, full] = $8
    next
}

# The published numbers, of cases with a name.
FNR == 1 { FS = ","; $0 = $0; read_header(column); published_columns = /published_H_c_full/; next }
published_columns { for (item in column) published[$column["name"], item] = $column[item] }

END {
    for (i = 1; i <= num_cases; i++) if (length(names[i]) > width) width = length(names[i])
    head()
    if (csv != "") print "case,status,iterations_full,iterations_reduced,milliseconds_full,milliseconds_reduced," \
        "H_c_full,H_c_reduced,H_min_full,H_min_reduced,film_unit,inlet_effect,step_effect" > csv
    for (i = 1; i <= num_cases; i++) {
        name = names[i]
        if (!((name, 0) in film) || !((name, 1) in film)) {
            printf "%-*s no result\n", width, name
            missing = 1
            continue
        }
        deviation = 1000 * abs(film[name, 0] / film[name, 1] - 1)
        note = status[name, 1] == 1 || status[name, 0] == 1 ? "  not converged" : status[name, 0] == 4 ? "  outside of training" : ""
        counts = note == "" # only what converged inside of training
        note = note effect("inlet", inlet[name]) effect("step", step[name])
        if (note ~ /%/) coarse = 1
        if (counts && deviation > worst) { worst = deviation; worst_name = name }
        if (time[name, 0] > slowest) slowest = time[name, 0]
        row(name, sprintf("%9.4f", 1e6 * unit[name] * film[name, 1]), film[name, 1], film[name, 0], deviation, iterations[name, 1],
            iterations[name, 0], time[name, 1], time[name, 0], note)
        if (csv != "") printf "%s,%d,%d,%d,%.4g,%.4g,%s,%s,%s,%s,%s,%s,%s\n", name, status[name, 0], iterations[name, 1],
            iterations[name, 0], time[name, 1], time[name, 0], film[name, 1], film[name, 0], smallest[name, 1], smallest[name, 0],
            unit[name], inlet[name], step[name] > csv
        if (published[name, "published_H_c_full"] == "") continue
        permille = published[name, "published_deviation_permille"]
        row("  published", "", published[name, "published_H_c_full"], published[name, "published_H_c_reduced"], permille,
            published[name, "published_iterations_full"], published[name, "published_iterations_reduced"],
            1000 * published[name, "published_seconds_full"], 1000 * published[name, "published_seconds_reduced"], "")
        if (permille + 0 > worst_published) worst_published = permille + 0
    }
    print_rule(width + (in_micrometres ? 9 : 0) + 81)
    printf "worst deviation: %.3f permille (%s)%s; slowest reduced solution: %.2f ms\n", worst, worst_name,
        worst_published == "" ? "" : sprintf(", published %.3f", worst_published), slowest
    if (coarse) print "inlet, step: what the domain's start and the grid's step do to the full model's own central film"
    exit missing
}
