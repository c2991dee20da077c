# SPDX-License-Identifier: GPL-3.0-or-later
# Prints sizes, steps with times, and deviations of the models beside the published ones.
#     { size MODEL SIZES (model.sh); snapshots N; trajectories.sh ...; } | awk -f common.awk -f tables-time.awk -v models="NAME..." - cases.csv
# A run that stopped early has *, one that is not to be trusted +.
function mark(code) {
    if (code != 0) marked = 1
    return code == 3 ? "*" : code == 4 ? "+" : " "
}

BEGIN { num_models = split(models, name, " ") }

$1 == "size" { size[$2] = $0; next }
$1 == "snapshots" { snapshots = $2; next }

$1 == "run" {
    code[$2, $3, $4] = $5
    steps[$2, $3, $4] = $6
    seconds[$2, $3, $4] = $9
    next
}

$1 == "deviation" {
    pressure[$2, $3, $4] = $5
    film[$2, $3, $4] = $7
    next
}

FNR == 1 { FS = ","; $0 = $0; next }

NF > 1 {
    period[++num_periods] = $1
    if ($4 != "") published = 1
    published_steps[$1, "full"] = $4
    published_steps[$1, "reduced"] = $5
    published_seconds[$1, "full"] = $6
    published_seconds[$1, "reduced"] = $7
}

function size_row(label, text, states,    value) {
    split(text, value, " ")
    printf "%-12s %6d %7d %9d %5d %8s %6d %13d\n", label, value[3], states, value[4] + value[5] + 1, value[4],
        value[5] ? value[5] : "-", value[6], value[7]
}

function size_table(    m, value) {
    print (published ? "Table 6: sizes" : "Sizes") " (m: steps of the training trajectories)\n"
    printf "%-12s %6s %7s %9s %5s %8s %6s %13s\n", "", "n", "m", "unknowns", "n_p", "n_delta", "rows", "needed nodes"
    print_rule(74)
    for (m = 1; m <= num_models; m++) size_row(name[m], size[name[m]], snapshots)
    if (split(size["published"], value, " ") > 2) size_row("published", size["published"], value[8])
}

function time_row(label, full, reduced, full_seconds, reduced_seconds, note) {
    printf "%-18s %7d %8d%s %10.2f %9.2f %9.1f %9.2f %9.3f\n", label, full, reduced, note, full_seconds, reduced_seconds,
        full_seconds / reduced_seconds, 1000 * full_seconds / full, 1000 * reduced_seconds / reduced
}

function time_table(model,    i, p) {
    print "\n" (published ? "Table 7: adaptive" : "Adaptive") " steps at the default tolerance, " model (published ? "; the second line of a period: as published" : "") "\n"
    printf "%-18s %7s %8s  %10s %9s %9s %19s\n", "T_exc", "steps", "", "seconds", "", "ratio", "ms a step"
    printf "%-18s %7s %8s  %10s %9s %9s %9s %9s\n", "", "full", "reduced", "full", "reduced", "", "full", "reduced"
    print_rule(87)
    for (i = 1; i <= num_periods; i++) {
        p = period[i]
        time_row(p, steps["adaptive", p, "full"], steps["adaptive", p, model], seconds["adaptive", p, "full"],
            seconds["adaptive", p, model], mark(code["adaptive", p, model]))
        if (published_steps[p, "full"] != "")
            time_row("  published", published_steps[p, "full"], published_steps[p, "reduced"],
                published_seconds[p, "full"], published_seconds[p, "reduced"], " ")
    }
}

# One number of deviation (pressure or film), and the largest of its column under `name`.
function column(name, deviation, steps, period, kind) {
    if (!((steps, period, kind) in deviation)) {
        printf " %9s ", "-"
        return
    }
    if (deviation[steps, period, kind] > worst[name]) worst[name] = deviation[steps, period, kind]
    printf " %9.5f%s", deviation[steps, period, kind], mark(code[steps, period, kind])
}

function shown_worst(name) { return name in worst ? sprintf("%.5f", worst[name]) : "-" }

function deviation_table(model,    i, p) {
    split("", worst)
    print "\nLargest deviations over time in per cent, " model
    print "fixed, adaptive: reduced against full model with the same kind of steps; tolerance: full model against"
    print "itself at a tenth of the default tolerance\n"
    printf "%-10s %10s %10s  %10s %10s  %10s %10s  %12s\n", "T_exc", "fixed P_c", "H_c", "adapt. P_c", "H_c", "toler. P_c", "H_c", "fixed ms/step"
    print_rule(91)
    for (i = 1; i <= num_periods; i++) {
        p = period[i]
        printf "%-10s", p
        column("fixed P", pressure, "fixed", p, model)
        column("fixed H", film, "fixed", p, model)
        printf " "
        column("adaptive P", pressure, "adaptive", p, model)
        column("adaptive H", film, "adaptive", p, model)
        printf " "
        column("tolerance P", pressure, "tenth", p, "full")
        column("tolerance H", film, "tenth", p, "full")
        printf " %12.3f\n", 1000 * seconds["fixed", p, model] / steps["fixed", p, model]
    }
    print_rule(91)
    printf "%-10s %9s  %9s   %9s  %9s   %9s  %9s\n", "worst", shown_worst("fixed P"), shown_worst("fixed H"), shown_worst("adaptive P"),
        shown_worst("adaptive H"), shown_worst("tolerance P"), shown_worst("tolerance H")
}

END {
    size_table()
    for (m = 1; m <= num_models; m++)
        if (("adaptive", period[1], name[m]) in code) time_table(name[m])
    for (m = 1; m <= num_models; m++) deviation_table(name[m])
    if (marked) print "\n* stopped early, + not to be trusted"
}
