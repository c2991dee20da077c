#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests that the study of rough surfaces on its own grids prints the numbers of its README.

load common

@test "the film over a dimple, moment by moment" {
    copy_whole_study surfaces
    make dimple >table
    cat table
    # README.md has the worst differences from the published film, and the size of the undisturbed film
    awk 'NR == FNR && /^\| (pure rolling|sliding): worst/ {
             gsub(/[^0-9.|]/, "")
             split($0, cell, "|")
             for (i = 1; i <= 5; i++) said[++count] = cell[i + 2]
         }
         NR > FNR && ($1 == "ssr0" || $1 == "ssr-05") {
             found++
             if (!($5 > 0.96 * said[found] - 0.05 && $5 < 1.04 * said[found] + 0.05)) { print "said " said[found] ", found " $5; bad = 1 }
         }
         END { exit bad || count != 10 || found != 10 }' README.md table
}

@test "what is left of waves" {
    copy_whole_study surfaces
    make out/waviness.txt >/dev/null
    cat out/waviness.txt
    awk 'NR == FNR && /^\| (line|point) \|/ { split($0, cell, "|"); said[++count] = cell[6] }
         NR > FNR && ($1 == "line" || $1 == "point") {
             found++
             if (!($6 > 0.995 * said[found] && $6 < 1.005 * said[found])) { print "said " said[found] ", found " $6; bad = 1 }
         }
         END { exit bad || count != 17 || found != 17 }' README.md out/waviness.txt
}
