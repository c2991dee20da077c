#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs the trajectories of a folder in one of the ways that users have, and compares them with the reference's:
#     in-time.sh FOLDER full-STRETCH-STEPS REFERENCE       the full model, with STRETCH times the grid's step
#     in-time.sh FOLDER reduced-MODES-MORE-ROWS-STEPS REFERENCE
#                                                           part of the reduced model $MODEL: pressure modes,
#                                                           deformation modes (0: coupled basis), rows
# STEPS is a tolerance, fixedLENGTH, or stillN: everything goes 10^4 times as slowly in N steps, so that the contact is
# stationary at each time (not where a history is a table). A line a trajectory, of the central film relative to the reference's at
# the same time, worst, 95 % and median over time; seconds of the whole trajectory:
#     trajectory SCENE WAY CODE STEPS SECONDS WORST 95_PERCENT MEDIAN
# The reference itself, when REFERENCE is WAY, leaves FOLDER/SCENE-WAY.dat and prints of each scene its FORMULAS:
#     formula SCENE NAME QUANTITY WORST 95_PERCENT MEDIAN SECONDS
# $BIN: folder of the programs.
set -eu
folder=$1 way=$2 reference=$3
shared=$(dirname "$0")/../../lib
work=$folder/work-$way
rm -rf "$work"
mkdir "$work"
trap 'rm -rf "$work"' EXIT

kind=${way%%-*} rest=${way#*-}
first=${rest%%-*} steps=${rest#*-}
if [ "$kind" = reduced ]; then
    more=${steps%%-*} steps=${steps#*-}
    rows=${steps%%-*} steps=${steps#*-}
fi

# Largest deviation, and what it does not exceed for 95 % and for half of the time.
quantiles() {
    awk -f "$shared/common.awk" -f "$shared/deviation.awk" "$1" "$2" | awk "$(cat "$shared/common.awk")"'
        { time[NR] = $1; off[NR] = abs($3) / 100 }
        END {
            for (i = 1; i <= NR; i++)
                print off[i], (time[i < NR ? i + 1 : i] - time[i > 1 ? i - 1 : i]) / 2
        }' | sort -g | awk '
        { off[NR] = $1; sum[NR] = sum[NR - 1] + $2 }
        function part(q,   i) { for (i = 1; i < NR && sum[i] < q * sum[NR]; i++) continue; return off[i] }
        END { if (NR) print off[NR], part(0.95), part(0.5); else print "nan nan nan" }'
}

# The scene with all its times stretched, in N steps.
slow_scene() {
    awk -v steps="$2" '
        $1 ~ /^transient\..*(period|start|duration|at|end_time):$/ { $2 = sprintf("%.17g", 1e4 * $2) }
        $1 == "transient.end_time:" { print "transient.fixed_step: " $2 / steps }
        { print }' "$1"
}

for scene in "$folder"/scene-*.yml; do
    name=$(basename "$scene" .yml)
    run=$work/$name.dat
    case $steps in
    still*)
        slow_scene "$scene" "${steps#still}" >"$work/$name.yml"
        scene=$work/$name.yml
        ;;
    esac
    case $kind in
    full)
        step=$(awk -v stretch="$first" '$1 == "grid.step:" { printf "%.12g", stretch * $2 }' "$scene")
        set -- fullrun "$scene" --set grid.step="$step" --formulas
        ;;
    reduced)
        set -- romrun "$scene" --model "$MODEL" --pressure-modes "$first" --rows "$rows"
        [ "$more" = 0 ] || set -- "$@" --deformation-modes "$more"
        ;;
    esac
    case $steps in
    still*) ;;
    fixed*) set -- "$@" --set transient.fixed_step="${steps#fixed}" ;;
    *) set -- "$@" --set transient.tolerance="$steps" ;;
    esac
    program=$BIN/$1
    shift
    "$shared/trajectory.sh" "$work/run.h5" "$program" "$@" --set output.fields=false >"$run"
    case $steps in
    still*)
        awk '/^#/ { print; next } { $1 = sprintf("%.12g", $1 / 1e4); print }' "$run" >"$work/fast.dat"
        mv "$work/fast.dat" "$run"
        ;;
    esac
    if [ "$way" = "$reference" ]; then
        cp "$run" "$folder/$name-$way.dat"
        count=$(grep -vc '^#' "$run")
        sed -n 's/^# formula //p' "$run" | tr -d '%,' | awk -v name="$name" -v count="$count" \
            '{ printf "formula %s %s %s %g %g %g %.3g\n", name, $1, $2, $4 / 100, $6 / 100, $8 / 100, $9 * 1e-9 * count }'
    fi
    # a line per trajectory also where it ends early
    echo "trajectory $name $way $(awk 'NR == 1 { print $3, $5, $11 }' "$run") $(quantiles "$folder/$name-$reference.dat" "$run")"
done
