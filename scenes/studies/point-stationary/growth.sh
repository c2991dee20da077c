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
    "$BIN/fullrun" --print "$name-result.h5" newton_iterations solve_seconds | sed -n 2p
done | awk -F, -v sizes="$(../../lib/model.sh "$name-model.h5")" \
    -v lines="$("$BIN/romrun" --print "$name-model.h5" | awk -F, '$1 == "y" { print $3 }')" '
    { iterations += $1; seconds += $2 }
    END {
        split(sizes, size, " ")
        printf "%6d %8d %6d %6d %8d %6.1f %10.3f %10.1f\n", lines, size[1], size[2] + size[3] + 1, size[4], size[5], iterations / NR,
            1e3 * seconds / NR, 1e6 * seconds / iterations
    }'
