#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# All solvers on all published cases of a region, or on steps in time, a line of CSV each.
#     BENCH=PROGRAM sweep.sh REGION SCENE_FOLDER MODEL.h5 "SIZES" "EPS..." MODES_OF_THESE
#     BENCH=PROGRAM sweep.sh time SCENE_FOLDER MODEL.h5 "SIZES" "RATE..."
set -eu
lib=$(dirname "$0")/../../lib
region=$1 folder=$2 model=$3 sizes=$4 values=$5 dependent=${6:-}

# solve CASE MODES ROWS VARIANT: rows 0 stand for all
solve() {
    settings=
    [ "$region" = time ] || settings=$(awk -f "$lib/case.awk" -v want="$1" "$folder/cases.csv" | sed 's/--set//g')
    # shellcheck disable=SC2086
    "$BENCH" "$model" "$folder/scene.yml" "$2" "$3" "$4" $settings | sed "s/^/$region,$1,/"
}

if [ "$region" = time ]; then
    for modes in $sizes; do
        solve scene "$modes" 0 stored
        for rate in $values; do solve scene "$modes" 0 "rate=$rate"; done
    done
    exit
fi
for case in $(awk -f "$lib/case.awk" "$folder/cases.csv"); do
    for modes in $sizes; do
        for variant in stored without-D single; do solve "$case" "$modes" 0 "$variant"; done
        for variant in stored without-D; do
            solve "$case" "$modes" $((modes * 8 / 5)) "$variant"
            solve "$case" "$modes" "$modes" "$variant"
        done
    done
    for apart in $values; do solve "$case" "$dependent" 0 "dependent=$apart"; done
done
