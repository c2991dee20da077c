#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs a transient scene and prints its result as text:
#     trajectory.sh RESULT.h5 PROGRAM SCENE.yml [OPTION...]
# The first line: # code EXIT_CODE steps N rejected N newton N seconds S, - for what is not known
# The second one: # message TEXT: what the program had to say, mostly nothing
# Where the program is told to print film formulas (--formulas), a line each: # formula ...
# Then, a line each time: T load P_c H_c H_min (factors and numbers of the reference frame).
# A run that stops early (exit code 3) and one that is not to be trusted (4) have results too.
set -u
result=$1 program=$2
shift 2

errors=$(mktemp)
answer=$(mktemp)
trap 'rm -f "$errors" "$answer"' EXIT

attributes="-a /rejected_steps -a /total_newton_iterations -a /solve_seconds"
code=0
"$program" "$@" -o "$result" --force --quiet >"$answer" 2>"$errors" || code=$?
case $code in
0 | 4) ;;
3) result=$result.partial attributes= ;; # they are written last
*)
    cat "$errors" >&2
    exit $code
    ;;
esac

# shellcheck disable=SC2086 # the attributes are several words
h5dump -A 0 -y -w 1 -m %.12g -d /time -d /load -d /central_pressure -d /central_film_thickness \
    -d /minimum_film_thickness $attributes "$result" | tr -d ',' | awk -v code=$code -v message="$(cat "$errors")" -v answer="$answer" '
    /^(DATASET|ATTRIBUTE)/ { item = $2; gsub("[\"/]", "", item); count = 0 }
    /^ *[-+.0-9a-z]+$/ { value[item, count++] = $1 }
    function number(item) { return (item, 0) in value ? value[item, 0] : "-" }
    END {
        for (num_times = 0; ("time", num_times) in value; num_times++) continue
        print "# code", code, "steps", num_times - 1, "rejected", number("rejected_steps"),
            "newton", number("total_newton_iterations"), "seconds", number("solve_seconds")
        print "# message", message
        while ((getline line < answer) > 0)
            if (line ~ /^formula /) print "#", line
        for (i = 0; i < num_times; i++)
            print value["time", i], value["load", i], value["central_pressure", i],
                value["central_film_thickness", i], value["minimum_film_thickness", i]
    }'
