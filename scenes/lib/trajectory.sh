#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs a transient scene and prints its result as text:
#     BIN=... trajectory.sh RESULT.h5 PROGRAM SCENE.yml [OPTION...]
# The first line: # code EXIT_CODE steps N rejected N newton N seconds S, - for what is not known
# The second one: # message TEXT: what the program had to say, mostly nothing
# Where the program is told to print film formulas (--formulas), a line each: # formula ...
# Then, a line each time: T load P_c H_c H_min (factors and numbers of the reference frame).
# A run that stops early (exit code 3) and one that is not to be trusted (4) have results too.
set -u
result=$1 program=$2
shift 2

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

code=0
"$program" "$@" -o "$result" --force --quiet >"$work/answer" 2>"$work/errors" || code=$?
case $code in
0 | 4) ;;
3) result=$result.partial ;;
*)
    cat "$work/errors" >&2
    exit $code
    ;;
esac

print() { "$BIN/fullrun" --print "$result" "$@" | sed -e 1d -e 's/,/ /g'; }
print time load central_pressure central_film_thickness minimum_film_thickness >"$work/times"
set -- - - -
# shellcheck disable=SC2046 # three words; they are written last
[ $code -eq 3 ] || set -- $(print rejected_steps total_newton_iterations solve_seconds)
echo "# code $code steps $(($(wc -l <"$work/times") - 1)) rejected $1 newton $2 seconds $3"
echo "# message $(cat "$work/errors")"
sed -n 's/^formula/# &/p' "$work/answer"
cat "$work/times"
