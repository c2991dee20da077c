#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Pressure and film of a result, at its last time, as columns: X P H
#     profile.sh RESULT.h5
h5dump -A 0 -y -w 1 -m %.8g -d /x -d /pressure -d /film_thickness "$1" | tr -d ',' | awk '
    /^DATASET/ { item = $2; gsub("[\"/]", "", item) }
    /^ *[-+.0-9a-z]+$/ { value[item, count[item]++] = $1 }
    END {
        num_nodes = count["x"]
        last = count["pressure"] - num_nodes
        for (i = 0; i < num_nodes; i++) print value["x", i], value["pressure", last + i], value["film_thickness", last + i]
    }'
