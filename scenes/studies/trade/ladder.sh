#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# What a calibration found, a line a size of the model, with deviations of the central film:
#     ladder PRESSURE_MODES DEFORMATION_MODES ROWS SCENES FAILURES WORST 95_PERCENT MEDIAN SECONDS
#     BIN=... ladder.sh CALIBRATED.h5
set -eu
work=$(mktemp)
trap 'rm -f "$work"' EXIT
sizes='position_pressure_modes position_deformation_modes position_rows'
# a calibration on trajectories alone has only the sizes
# shellcheck disable=SC2086 # several words
"$BIN/romrun" --print "$1" $sizes calibration_scenes position_failures position_seconds >"$work" 2>/dev/null ||
    "$BIN/romrun" --print "$1" $sizes >"$work"
"$BIN/romrun" --print "$1" deviation_central_film_thickness |
    awk -F, 'NR == 1 { print; next } NF { printf "%s%s", $NF, ++count % 3 ? "," : "\n" }' | paste -d , "$work" - | awk -F, '
        NR > 1 && NF == 9 { print "ladder", $1, $2, $3, $4, $5, $9, $8, $7, $6 }
        NR > 1 && NF == 6 { print "ladder", $1, $2, $3, "nan", "nan", $6, $5, $4, "nan" }'
