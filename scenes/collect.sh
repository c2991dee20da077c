#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The numbers of results, a line each: result CASE KIND STATUS ITERATIONS SECONDS H_C H_MIN
#     collect.sh FOLDER KIND... -- CASE...        reads FOLDER/case-CASE-KIND.h5
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
        h5dump -A 0 -y -m %.17g -d /status -d /newton_iterations -d /central_film_thickness \
            -d /minimum_film_thickness -a /solve_seconds "$folder/case-$name-$kind.h5" |
            awk -v name="$name" -v kind="$kind" '
                /^(DATASET|ATTRIBUTE)/ { item = $2; gsub("[\"/]", "", item) }
                /^ *[-+.0-9a-z]+$/ { value[item] = $1 }
                END {
                    if ("central_film_thickness" in value) print "result", name, kind, value["status"], value["newton_iterations"],
                        value["solve_seconds"], value["central_film_thickness"], value["minimum_film_thickness"]
                }'
    done
done
