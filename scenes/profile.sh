#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Pressure and film of a result, at its last time, as columns: X P H; of a point contact on the line Y = 0
#     profile.sh RESULT.h5
lines=$(h5dump -n "$1" | awk '$2 == "/y" { print "-d /y" }')
# shellcheck disable=SC2086
h5dump -A 0 -y -w 1 -m %.8g -d /x $lines -d /pressure -d /film_thickness "$1" | tr -d ',' | awk '
    /^DATASET/ { item = $2; gsub("[\"/]", "", item) }
    /^ *[-+.0-9a-z]+$/ { value[item, count[item]++] = $1 }
    END {
        num_nodes = count["x"]
        num_lines = count["y"] ? count["y"] : 1
        last = count["pressure"] - num_nodes * (num_lines + 1) / 2
        for (i = 0; i < num_nodes; i++) print value["x", i], value["pressure", last + i], value["film_thickness", last + i]
    }'
