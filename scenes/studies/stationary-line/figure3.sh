#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# One point of figure 3: builds a model of these sizes, solves the case, and prints
#     KIND PRESSURE_MODES DEFORMATION_MODES ROWS STATUS DEVIATION_IN_PERMILLE
#     BIN=... figure3.sh FOLDER KIND-PRESSURE-DEFORMATION CASE "SETTINGS OF THE CASE" "SETTINGS OF THE PLAN"
# A model that does not converge has status 1.
set -eu
folder=$1 case=$3 case_settings=$4 plan_settings=$5
kind=${2%%-*} sizes=${2#*-}
pressure=${sizes%-*} deformation=${sizes#*-}

work=$(mktemp -d)
mkdir "$work/full" "$work/reduced"
trap 'rm -rf "$work"' EXIT

if [ "$kind" = coupled ]; then
    rows=$((2 * (pressure + 1)))
    modes="--pressure-modes $pressure" weights=quadrature
else
    rows=$((2 * (pressure + deformation + 1)))
    modes="--pressure-modes $pressure --deformation-modes $deformation" weights=plain # as published
fi

status=0
# shellcheck disable=SC2086 # the settings are several words
{
    "$BIN/podbuild" "$folder/snapshots.h5" --quiet --deformation "$kind" $modes -o "$work/basis.h5" &&
        { "$BIN/snapgen" plan.yml --quiet --basis "$work/basis.h5" \
            -o "$work/residuals.h5" $plan_settings; } &&
        "$BIN/deimselect" "$work/residuals.h5" --quiet --basis "$work/basis.h5" --rows $rows \
            --weights $weights \
            -o "$work/model.h5" &&
        "$BIN/romrun" scene.yml --quiet --allow-untrusted --model "$work/model.h5" \
            -o "$work/reduced/$case.h5" $case_settings
} >/dev/null 2>"$work/errors" || status=$?
if [ $status -ne 0 ] && [ $status -ne 3 ]; then
    cat "$work/errors" >&2
    exit $status
fi

cp "$folder/full/$case.h5" "$work/full"
lib=$(dirname "$0")/../../lib
"$lib/collect.sh" "$work" full reduced -- "$case" | awk -v status=$status -v point="$kind $pressure $deformation $rows" "$(cat "$lib/common.awk")"'
    { film[$3] = $7 }
    END { print point, status != 0, 1000 * abs(film["reduced"] / film["full"] - 1) }'
