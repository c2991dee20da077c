#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# What a calibrated model of all modes and rows came to, a line of CSV: training, points, modes, rows, scenes that
# failed, median, 95 % and worst deviation of the central film on the others, milliseconds.
#     row.sh TRAINING CALIBRATED.h5
set -eu
last() {
    h5dump -y -A 0 -w 1 -m %.17g -d "/$1" "$2" | tr -d ', ' | grep '^[-0-9n]' | tail -n "$3" | paste -s -d ' '
}
set -- "$1" "$(last state_moes_M "$2" 1000000 | wc -w)" "$(last position_pressure_modes "$2" 1)" \
    "$(last position_rows "$2" 1)" "$(last position_failures "$2" 1)" \
    "$(last deviation_central_film_thickness "$2" 3)" "$(last position_seconds "$2" 1)"
echo "$1 $2 $3 $4 $5 $6 $7" | awk '{ printf "%s,%d,%d,%d,%d,%.3g,%.3g,%.3g,%.3g\n", $1, $2, $3, $4, $5, $6, $7, $8, $9 * 1e3 }'
