#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The states of a piece of the map as CSV, without a header (Makefile).
#     table.sh FOLDER/LAW-DENSITY-REGION.h5
set -eu
name=$(basename "$1" .h5)
law=${name%%-*} density=${name#*-}
density=${density%-*}
fields='moes_M moes_L alpha_p_H hertz_pressure status newton_iterations residual_norm complementarity
        exit_position central_film_thickness minimum_film_thickness'
# shellcheck disable=SC2046 # one option a field
h5dump -A 0 -y -w 1 -m %.10g $(printf -- '-d /%s ' $fields) -a /step "$1" |
    awk -v lubricant="$law,$density" '
        /^(DATASET|ATTRIBUTE)/ { item = $2; gsub("[\"/]", "", item); number = 0 }
        /^ *[-+.0-9a-z]+,?$/ { sub(",", ""); value[item, ++number] = $1; if (number > last) last = number }
        END {
            for (i = 1; i <= last; i++)
                print lubricant "," value["moes_M", i] "," value["moes_L", i] "," value["alpha_p_H", i] "," \
                    value["hertz_pressure", i] / 1e9 "," value["step", 1] "," value["status", i] "," \
                    value["newton_iterations", i] "," value["residual_norm", i] "," value["complementarity", i] "," \
                    value["exit_position", i] "," value["central_film_thickness", i] "," value["minimum_film_thickness", i]
        }'
