#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The numbers of results, a line each: result CASE KIND STATUS ITERATIONS SECONDS H_C H_MIN
#     BIN=... collect.sh FOLDER KIND... -- CASE...        reads FOLDER/KIND/CASE.h5
set -u
folder=$1
shift
kinds=
while [ "$1" != -- ]; do
    kinds="$kinds $1"
    shift
done
shift

for name in "$@"; do
    for kind in $kinds; do
        "$BIN/fullrun" --print "$folder/$kind/$name.h5" status newton_iterations solve_seconds central_film_thickness \
            minimum_film_thickness | sed -n "2 { s/,/ /g; s/^/result $name $kind /p; }"
    done
done
