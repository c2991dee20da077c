#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Solves the scenes of a folder with the full model in one of the ways that users have:
#     stationary.sh FOLDER START-STRETCH-TOLERANCE [OPTION...]
# START is cold, neighbour (the result of the scene before) or reduced (a result of the reduced model $MODEL);
# the grid has STRETCH times the scene's step, Newton's iteration ends at TOLERANCE. Prints what collect.sh
# prints, of the reduced model's results too, and of each scene its FORMULAS and what the grid does to H_c:
#     formula SCENE NAME QUANTITY DEVIATION/% SECONDS
#     effect SCENE STEP INLET
# $BIN: folder of the programs, $REPEAT: solutions for a median time.
set -eu
folder=$1 way=$2
shift 2
start=${way%%-*} rest=${way#*-}
stretch=${rest%%-*} tolerance=${rest#*-}
results=$folder/$way
rm -rf "$results"
mkdir -p "$results/$way" "$results/reduced"
trap 'rm -rf "$results"' EXIT

# Not converged (3) and not to be trusted (4) are outcomes.
solve() {
    code=0
    "$@" --force --quiet >"$results/answer.txt" 2>"$results/errors.txt" || code=$?
    case $code in 0 | 3 | 4) return ;; esac
    cat "$results/errors.txt" >&2
    exit $code
}

effect() { "$BIN/fullrun" --print "$result" "$1" 2>/dev/null | grep -v _effect || echo nan; }

before=
for scene in "$folder"/scene-*.yml; do
    name=$(basename "$scene" .yml)
    result=$results/$way/$name.h5
    step=$(awk -v stretch="$stretch" '$1 == "grid.step:" { printf "%.12g", stretch * $2 }' "$scene")
    if [ "$start" = reduced ]; then
        before=$results/reduced/$name.h5
        solve "$BIN/romrun" "$scene" --model "$MODEL" -o "$before" --repeat "$REPEAT" --set output.fields=true "$@"
        [ $code -ne 3 ] || before=
    fi
    solve "$BIN/fullrun" "$scene" -o "$result" --repeat "$REPEAT" --tolerance "$tolerance" --formulas \
        --set grid.step="$step" ${before:+--start "$before"} "$@"
    if [ $code -eq 0 ]; then
        sed -n 's/^formula //p' "$results/answer.txt" | tr -d '%+' |
            awk -v name="$name" '{ printf "formula %s %s %s %s %.3g\n", name, $1, $2, $4, $5 * 1e-9 }'
        # of an effect that is not known there is no attribute
        echo "effect $name $(effect step_effect) $(effect inlet_effect)"
    fi
    [ $code -eq 0 ] && [ "$start" = neighbour ] && before=$result || before=
done

names=$(cd "$results/$way" && ls | sed 's/.h5$//')
collect=$(dirname "$0")/../../lib/collect.sh
# shellcheck disable=SC2086 # a word a case
"$collect" "$results" "$way" -- $names
# shellcheck disable=SC2086
[ "$start" != reduced ] || "$collect" "$results" reduced -- $names
