# SPDX-License-Identifier: GPL-3.0-or-later
# Prints sizes, iterations with times, and film thicknesses of all models beside the published ones.
#     { size MODEL SIZES (model.sh); collect.sh ...; } | awk -f common.awk -f tables.awk -v models="NAME..." - cases.csv

# A column's head, wide enough for its numbers.
function heads(format,    m) {
    for (m = 1; m <= num_models + 1; m++) printf format, name[m]
    print ""
}

BEGIN {
    num_models = split(models, name, " ")
    name[num_models + 1] = "published"
}

$1 == "size" { size[$2] = $0; next }

$1 == "result" {
    status[$2, $3] = $4
    iterations[$2, $3] = $5
    time[$2, $3] = 1000 * $6
    film[$2, $3] = $7
    next
}

FNR == 1 { FS = ","; $0 = $0; read_header(column); next }

NF > 1 {
    key[++num_cases] = $1
    label[num_cases] = sprintf("%-9s %4s %3s %5s", $2, $3, $4, $5 / 1e9)
    for (item in column) if (sub(/^published_/, "", item)) published[num_cases, item] = $column["published_" item]
    if (!(($1, "full") in film)) missing_result = $1 ", full"
    for (m = 1; m <= num_models; m++)
        if (!(($1, name[m]) in film)) missing_result = $1 ", " name[m]
}

function size_table(    m, i, count, value) {
    print "Table 2: sizes\n"
    printf "%-12s %6s %6s %5s %9s %5s %8s %6s %13s\n", "", "n", "2n+1", "m", "unknowns", "n_p", "n_delta", "rows", "needed nodes"
    print_rule(79)
    for (m = 1; m <= num_models + 1; m++) {
        if (split(size[name[m]], value, " ") < 8) continue
        printf "%-12s %6d %6d %5d %9d %5d %8s %6d %13d\n", name[m], value[3], 2 * value[3] + 1, value[8], value[4] + value[5] + 1,
            value[4], value[5] ? value[5] : "-", value[6], value[7]
    }
}

function number(text, format) { return text == "" ? "-" : sprintf(format, text) }

function time_table(    c, m) {
    print "\nTable 3: Newton iterations (* not converged, + outside of the trained range)\n"
    printf "%-24s %10s %10s ", "", "full", "published"
    heads(" %12s")
    print_rule(47 + 13 * (num_models + 1))
    for (c = 1; c <= num_cases; c++) {
        printf "%-24s %10d %10s ", label[c], iterations[key[c], "full"], number(published[c, "iterations_full"], "%d")
        for (m = 1; m <= num_models; m++)
            printf " %12s", iterations[key[c], name[m]] (status[key[c], name[m]] == 1 ? "*" : status[key[c], name[m]] == 4 ? "+" : "")
        printf " %12s\n", number(published[c, "iterations_reduced"], "%d")
    }
    print "\nTable 3: time of the solution in ms; last line: speed-up over the full model, mean of the cases\n"
    printf "%-24s %10s %10s ", "", "full", "published"
    heads(" %12s")
    print_rule(47 + 13 * (num_models + 1))
    for (c = 1; c <= num_cases; c++) {
        printf "%-24s %10.1f %10s ", label[c], time[key[c], "full"], number(1000 * published[c, "seconds_full"], "%.0f")
        for (m = 1; m <= num_models; m++) {
            printf " %12.2f", time[key[c], name[m]]
            speed_up[m] += time[key[c], "full"] / time[key[c], name[m]] / num_cases
        }
        printf " %12s\n", number(1000 * published[c, "seconds_reduced"], "%.0f")
        if (published[c, "seconds_reduced"]) speed_up[num_models + 1] += published[c, "seconds_full"] / published[c, "seconds_reduced"] / num_cases
    }
    print_rule(47 + 13 * (num_models + 1))
    printf "%-47s", "speed-up"
    for (m = 1; m <= num_models + 1; m++) printf " %12.0f", speed_up[m]
    print ""
}

function film_table(    c, m, deviation) {
    print "\nTable 4: central film thickness H_c, and deviations of the reduced models from the full one in permille\n"
    printf "%-24s %11s %11s", "", "H_c full", "published"
    heads(" %12s")
    print_rule(48 + 13 * (num_models + 1))
    for (c = 1; c <= num_cases; c++) {
        printf "%-24s %11.8f %11s", label[c], film[key[c], "full"], published[c, "H_c_full"]
        difference = abs(film[key[c], "full"] - published[c, "H_c_full"])
        if (published[c, "H_c_full"] != "" && difference > worst_full) worst_full = difference
        for (m = 1; m <= num_models; m++) printf " %12.8f", film[key[c], name[m]]
        printf " %12s\n%-48s", published[c, "H_c_reduced"], ""
        for (m = 1; m <= num_models; m++) {
            deviation = 1000 * abs(film[key[c], name[m]] / film[key[c], "full"] - 1)
            if (status[key[c], name[m]] == 1) missing[m]++
            else if (deviation > worst[m]) worst[m] = deviation
            printf " %12s", sprintf("%.4f", deviation) (status[key[c], name[m]] == 1 ? "*" : status[key[c], name[m]] == 4 ? "+" : "")
        }
        printf " %12s\n", published[c, "deviation_permille"]
        if (published[c, "deviation_permille"] + 0 > worst[num_models + 1]) worst[num_models + 1] = published[c, "deviation_permille"] + 0
    }
    print_rule(48 + 13 * (num_models + 1))
    printf "%-24s %22.1e  ", "worst: |full - published|", worst_full
    for (m = 1; m <= num_models + 1; m++) printf " %12s", sprintf("%.4f", worst[m]) (missing[m] ? "*" : "")
    print ""
}

END {
    if (missing_result) {
        print "tables.awk: found no result of " missing_result ", expected one" > "/dev/stderr"
        exit 1
    }
    size_table()
    time_table()
    film_table()
}
