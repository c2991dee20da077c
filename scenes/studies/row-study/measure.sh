#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Lines of the table for a method with a weight and a number of modes: for each kind of factors, and each number of
# rows of the ladder of romrun --calibrate, what it deviates and how well posed the rows are.
#     measure.sh OUT REGION WEIGHT MODES METHOD CHECK_PLAN FACTORS...
set -eu
out=$1 region=$2 weight=$3 modes=$4 method=$5 check=$6
shift 6
base=$out/$region/$weight/$modes
name=$base/$method

choose() { "$BIN"/deimselect "$base-residuals.h5" --basis "$base-basis.h5" --method "$method" --force "$@"; }

# 1/sigma_min of both bases and at the worst exit, and the stability, of so many rows.
posed() {
    choose --rows "$1" -o "$name-posed.h5" | sed -n \
        -e 's/^1\/sigma_min: residuals \(.*\), Jacobian products \(.*\), worst exit of training \(.*\)/\1,\2,\3/p' \
        -e 's/^stability: \([^ ]*\).*/\1/p' | paste -s -d ,
}

for factors in "$@"; do
    choose --rows $((2 * modes)) --weights "$factors" -o "$name-model.h5" >/dev/null
    "$BIN"/romrun --calibrate "$check" --model "$name-model.h5" -o "$name-calibrated.h5" --force --quiet \
        >/dev/null 2>"$name.log" || { cat "$name.log" >&2; exit 1; }
    # of all modes: rows and what follows in romrun --trade, without the marks of the best
    "$BIN"/romrun --trade --model "$name-calibrated.h5" | awk -v modes="$modes" '
        /^indicated/ { done = 1 }
        { sub(/^\*/, " ") }
        !done && $1 == modes { print $3, $4, $5, $6, $16, $17, $18, $19 }' >"$name.txt"
    [ -s "$name-posed.txt" ] || while read -r rows _; do echo "$rows $(posed "$rows")"; done <"$name.txt" >"$name-posed.txt"
    while read -r rows median p95 worst mean most ms failures; do
        echo "$region,$weight,$modes,$method,$factors,$rows,$median,$p95,$worst,$mean,$most,$ms,$failures,$(
            sed -n "s/^$rows //p" "$name-posed.txt")"
    done <"$name.txt"
done
rm -f "$name-model.h5" "$name-calibrated.h5" "$name-posed.h5" "$name-posed.txt" "$name.txt" "$name.log"
