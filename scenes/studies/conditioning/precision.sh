#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# What bases in single precision do to the models that scenes have made: all cases or, in time, a trajectory
# of fixed steps; time of an iteration's kernels; size of the file.
#     BIN=... PRECISION=PROGRAM precision.sh SCENE_FOLDER...
set -eu
lib=$(dirname "$0")/../../lib

# sizes MODEL.h5: bytes of the file, and with four bytes less for each of its reals
sizes() {
    "$BIN/romrun" --print "$1" | awk -F, -v bytes="$(wc -c <"$1")" '
        $4 != "" && $1 ~ /basis|jacobian|weight|factor|state_(pressure|deformation)/ {
            entries = 1
            for (i = split($3, lengths, " "); i >= 1; i--) entries *= lengths[i]
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
        cases=$(awk -f "$lib/case.awk" "$folder/cases.csv")
    fi
    for case in $cases; do
        [ -n "$settings" ] || own=$(awk -f "$lib/case.awk" -v want="$case" "$folder/cases.csv" | sed 's/--set//g')
        # shellcheck disable=SC2086
        "$PRECISION" results "$model" "$folder/scene.yml" $settings ${own:-}
    done
    # an iteration in time takes other kernels
    # shellcheck disable=SC2086
    [ -n "$settings" ] || "$PRECISION" kernels "$model" "$folder/scene.yml" ${own:-}
    own=
done
