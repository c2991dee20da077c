#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Pressure and film of a point contact's result as a map, for gnuplot: blocks of X Y P H, one a line of the
# grid, and behind two empty lines the exit line: X Y; all in the frame of the entry.
#     BIN=... map.sh RESULT.h5 [ENTRY]      ENTRY: of the axis time, counted from 0
{
    "$BIN/fullrun" --print "$1" contact_half_width
    "$BIN/fullrun" --print "$1" x y pressure film_thickness
    "$BIN/fullrun" --print "$1" exit_position y
} | awk -F, -v entry="${2:-0}" '
    /^(time|x|exit_position|contact_half_width),?/ { # a header: time leads where it has several entries
        part++
        first = $1 == "time" ? 2 : 1
        now = 0
        last = ""
        if (part == 3) print "\n"
        next
    }
    part == 1 { width[count++] = $1; next }
    NF == 0 { if (part == 2 && now == entry) print ""; next }
    first == 2 && $1 != last { if (last != "") now++; last = $1 }
    now != entry { next }
    part == 2 { print $first, $(first + 1), $(first + 2), $(first + 3) }
    part == 3 { print $first / width[entry], $(first + 1) }'
