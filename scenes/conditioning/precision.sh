#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# What bases in single precision do to the models that scenes have made: all cases or, in time, a trajectory
# of fixed steps; time of an iteration's kernels; size of the file.
#     PRECISION=PROGRAM precision.sh SCENE_FOLDER...
set -eu

# sizes MODEL.h5: bytes of the file, and with four bytes less for each of its reals
sizes() {
    h5ls "$1" | tr -d '{},' | awk -v bytes="$(wc -c <"$1")" '
        $2 == "Dataset" && $1 ~ /basis|jacobian|weight|factor|state_(pressure|deformation)/ {
            entries = 1
            for (i = 3; i <= NF; i++) entries *= $i
            total += entries
        }
        END { printf "model.h5: %d bytes, %d with its reals in single precision\n", bytes, bytes - 4 * total }'
}

for folder; do
    model=$folder/out/model.h5
    printf '\n%s\n' "$(basename "$folder")"
    sizes "$model"
    settings=
    if grep -q '^regime: transient' "$folder/scene.yml"; then
        settings='transient.fixed_step=0.005'
        cases=scene
    else
        cases=$(awk -f "$folder/../case.awk" "$folder/cases.csv")
    fi
    for case in $cases; do
        [ -n "$settings" ] || own=$(awk -f "$folder/../case.awk" -v want="$case" "$folder/cases.csv" | sed 's/--set//g')
        # shellcheck disable=SC2086
        "$PRECISION" results "$model" "$folder/scene.yml" $settings ${own:-}
    done
    # an iteration in time takes other kernels
    # shellcheck disable=SC2086
    [ -n "$settings" ] || "$PRECISION" kernels "$model" "$folder/scene.yml" ${own:-}
    own=
done
