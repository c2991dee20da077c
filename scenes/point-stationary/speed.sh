#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Time and deviations of the reduced model beside the full one, case by case, on one thread: the least of three cold
# starts of the full model, the median of many online solutions; deviations of central and minimum film; by how many
# nodes the exit lines differ, mean and largest of all lines. The last line: the worst of all cases inside the training.
#     BIN=FOLDER speed.sh FOLDER MODEL 'SETTINGS' 'SIZES'      reads FOLDER/MODEL.h5, writes FOLDER/speed-*.h5
# SETTINGS: options of both programs, as the scene's Makefile has them; SIZES: of romrun alone, such as
# --pressure-modes 50
set -eu
out=$1 model=$2 settings=$3 sizes=$4
export OPENBLAS_NUM_THREADS=1

# Cases beyond the training are shown too (exit code 4).
run() { "$@" >/dev/null || [ $? -eq 4 ]; }
dump() {
    h5dump -A 0 -y -w 1 -m %.12g -d /x -d /status -d /newton_iterations -d /central_film_thickness \
        -d /minimum_film_thickness -d /exit_position -a /solve_seconds "$1" | tr -d ,
}

printf '%-12s %9s %9s %9s %11s %10s %10s %14s\n' '' full reduced full/ iterations H_c H_m 'exit, nodes' \
    case s ms reduced 'full, red.' permille permille 'mean, largest'
for name in $(awk -f ../case.awk cases.csv); do
    # word splitting is wanted: several options
    set -- scene.yml --force $settings $(awk -f ../case.awk -v want="$name" cases.csv)
    for attempt in 1 2 3; do
        run "$BIN/fullrun" "$@" --quiet -o "$out/speed-full-$attempt.h5"
    done
    run "$BIN/romrun" "$@" --quiet --model "$out/$model.h5" $sizes --repeat 201 --set output.fields=true -o "$out/speed-reduced.h5"
    for attempt in 1 2 3; do
        echo "RESULT $attempt"
        dump "$out/speed-full-$attempt.h5"
    done
    echo RESULT 0 # the reduced one
    dump "$out/speed-reduced.h5"
    echo "CASE $name"
done | awk '
    function magnitude(x) { return x < 0 ? -x : x }
    function permille(item) { return 1000 * (value[0, item, 0] / value[1, item, 0] - 1) }
    /^RESULT/ { result = $2; split("", count) }
    /^(DATASET|ATTRIBUTE)/ { item = $2; gsub("[\"/]", "", item) }
    /^ *[-+.0-9a-z]+$/ { value[result, item, count[item]++] = $1 }
    /^CASE/ {
        full = value[1, "solve_seconds", 0]
        for (i = 2; i <= 3; i++) if (value[i, "solve_seconds", 0] < full) full = value[i, "solve_seconds", 0]
        reduced = value[0, "solve_seconds", 0]
        sum = largest = 0
        for (l = 0; l < count["exit_position"]; l++) {
            apart = magnitude(value[0, "exit_position", l] - value[1, "exit_position", l]) / (value[0, "x", 1] - value[0, "x", 0])
            sum += apart
            if (apart > largest) largest = apart
        }
        mean = sum / count["exit_position"]
        central = permille("central_film_thickness")
        minimum = permille("minimum_film_thickness")
        printf "%-12s %9.3f %9.3f %9.0f %6d %4d %10.4f %10.4f %8.2f %5.0f%s\n", $2, full, 1e3 * reduced, full / reduced,
            value[1, "newton_iterations", 0], value[0, "newton_iterations", 0], central, minimum, mean, largest,
            value[0, "status", 0] == 4 ? "  outside of training" : ""
        if (value[0, "status", 0] == 4) next
        if (reduced > slowest) slowest = reduced
        if (!cases++ || full / reduced < ratio) ratio = full / reduced
        if (magnitude(central) > worst_central) worst_central = magnitude(central)
        if (magnitude(minimum) > worst_minimum) worst_minimum = magnitude(minimum)
        if (value[0, "newton_iterations", 0] > iterations) iterations = value[0, "newton_iterations", 0]
        sum_mean += mean
        if (largest > worst_exit) worst_exit = largest
    }
    END {
        if (cases) printf "%-12s %9s %9.3f %9.0f %11d %10.4f %10.4f %8.2f %5.0f\n", "worst", "", 1e3 * slowest, ratio, iterations,
            worst_central, worst_minimum, sum_mean / cases, worst_exit
    }'
