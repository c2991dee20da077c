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
# show KIND RESULT.h5
show() {
    "$BIN/fullrun" --print "$2" status newton_iterations central_film_thickness minimum_film_thickness solve_seconds step |
        sed -n "2s/^/result,$1,/p"
    "$BIN/fullrun" --print "$2" exit_position | sed -e 1d -e "s/^/exit,$1,/"
}

printf '%-12s %9s %9s %9s %11s %10s %10s %14s\n' '' full reduced full/ iterations H_c H_m 'exit, nodes' \
    case s ms reduced 'full, red.' permille permille 'mean, largest'
lib=../../lib
for name in $(awk -f $lib/case.awk cases.csv); do
    # word splitting is wanted: several options
    set -- scene.yml --force $settings $(awk -f $lib/case.awk -v want="$name" cases.csv)
    for attempt in 1 2 3; do
        run "$BIN/fullrun" "$@" --quiet -o "$out/speed-full-$attempt.h5"
        show $attempt "$out/speed-full-$attempt.h5"
    done
    run "$BIN/romrun" "$@" --quiet --model "$out/$model.h5" $sizes --repeat 201 --set output.fields=true -o "$out/speed-reduced.h5"
    show 0 "$out/speed-reduced.h5" # the reduced one
    echo "case,$name"
done | awk -f $lib/common.awk -f speed.awk
