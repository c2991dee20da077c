#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# What an online solution costs on a grid, with as many modes and rows as on any other. A line: lines of the half
# grid, nodes, unknowns, rows, needed nodes, iterations, milliseconds, microseconds an iteration
#     BIN=FOLDER growth.sh FOLDER STEP MODES ROWS        reads FOLDER/growth-STEP-snapshots.h5
set -eu
out=$1 step=$2 modes=$3 rows=$4
name=$out/growth-$step
set -- --set "grid.step=$step"
# what lies beyond the thin training counts here too
run() { "$BIN/romrun" scene.yml --model "$name-model.h5" --allow-untrusted --force --repeat 201 "$@" >/dev/null; }

{
    "$BIN/podbuild" "$name-snapshots.h5" -o "$name-basis.h5" --force --pressure-modes "$modes" --weight row-norm \
        --plan growth-plan.yml "$@"
    "$BIN/snapgen" growth-plan.yml --basis "$name-basis.h5" -o "$name-residuals.h5" --force --quiet "$@"
    "$BIN/deimselect" "$name-residuals.h5" --basis "$name-basis.h5" -o "$name-model.h5" --force --method exits --rows "$rows"
} >/dev/null
for place in 17-4.5 19.5-5.5 22-6.5 26-5 27-6; do
    run -o "$name-result.h5" "$@" --set "moes.M=${place%-*}" --set "moes.L=${place#*-}"
    h5dump -A 0 -y -m %.9g -d /newton_iterations -a /solve_seconds "$name-result.h5"
done | awk -v sizes="$(../sizes.sh "$name-model.h5")" -v lines="$(h5ls "$name-model.h5" | tr -d '{}' | awk '$1 == "y" { print $3 }')" '
    /^(DATASET|ATTRIBUTE)/ { item = $2 }
    /^ *[-+.0-9e]+$/ { sum[item] += $1; count[item]++ }
    END {
        split(sizes, size, " ")
        for (item in sum) if (item ~ /newton/) iterations = sum[item]; else seconds = sum[item]
        printf "%6d %8d %6d %6d %8d %6.1f %10.3f %10.1f\n", lines, size[1], size[4], size[7], size[8], iterations / 5,
            1e3 * seconds / 5, 1e6 * seconds / iterations
    }'
