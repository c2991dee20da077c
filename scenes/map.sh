#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Pressure and film of a point contact's result as a map, for gnuplot: blocks of X Y P H, one a line of the
# grid, and behind two empty lines the exit line: X Y; all in the frame of the entry.
#     map.sh RESULT.h5 [ENTRY]      ENTRY: of the axis time, counted from 0
h5dump -A 0 -y -w 1 -m %.8g -d /x -d /y -d /pressure -d /film_thickness -d /exit_position -d /contact_half_width "$1" |
    tr -d ',' | awk -v entry="${2:-0}" '
    /^DATASET/ { item = $2; gsub("[\"/]", "", item) }
    /^ *[-+.0-9a-zA-Z]+$/ { value[item, count[item]++] = $1 }
    END {
        first = entry * count["y"]
        for (l = 0; l < count["y"]; l++) {
            for (i = 0; i < count["x"]; i++) {
                k = (first + l) * count["x"] + i
                print value["x", i], value["y", l], value["pressure", k], value["film_thickness", k]
            }
            print ""
        }
        print ""
        for (l = 0; l < count["y"]; l++)
            print value["exit_position", first + l] / value["contact_half_width", entry], value["y", l]
    }'
