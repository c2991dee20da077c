#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Solves scenes with a calibrated model and a promise, and prints a line each:
#     PROMISE WHERE WHOSE CODE REDUCED FULL       exit code of romrun; H_c, "-" where there is none
#     run.sh FOLDER MODEL PROMISE...
set -eu
folder=$1 model=$2
shift 2

# A line a scene: H_c of the full model, "-" where it has none.
"$BIN/snapgen" --print "$folder/full.h5" status central_film_thickness |
    awk -F, 'NR > 1 { print $1 == 0 ? $2 : "-" }' >"$folder/full.txt"

for promise in "$@"; do
    paste -d ' ' "$folder/full.txt" "$folder/scenes.txt" | while read -r full where whose scene settings; do
        code=0
        film=$("$BIN"/romrun "$folder/$scene" --model "$model" --accuracy "$promise" --quiet \
            $(printf -- '--set %s ' $settings) 2>/dev/null) || code=$?
        film=$(printf '%s\n' "$film" | sed -n 's/^central film thickness *\([^ ]*\).*/\1/p')
        echo "$promise $where $whose $code ${film:--} $full"
    done
done
