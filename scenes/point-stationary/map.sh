#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Pressure and film of a point contact's result as a map, for gnuplot: blocks of X Y P H, one a line of the
# grid, and behind two empty lines the exit line: X Y
#     map.sh RESULT.h5
h5dump -A 0 -y -w 1 -m %.8g -d /x -d /y -d /pressure -d /film_thickness -d /exit_position "$1" | tr -d ',' | awk '
    /^DATASET/ { item = $2; gsub("[\"/]", "", item) }
    /^ *[-+.0-9a-z]+$/ { value[item, count[item]++] = $1 }
    END {
        for (l = 0; l < count["y"]; l++) {
            for (i = 0; i < count["x"]; i++) {
                k = l * count["x"] + i
                print value["x", i], value["y", l], value["pressure", k], value["film_thickness", k]
            }
            print ""
        }
        print ""
        for (l = 0; l < count["y"]; l++) print value["exit_position", l], value["y", l]
    }'
