#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# What a calibration found, a line a size of the model, with deviations of the central film:
#     ladder PRESSURE_MODES DEFORMATION_MODES ROWS SCENES FAILURES WORST 95_PERCENT MEDIAN SECONDS
#     trade-ladder.sh CALIBRATED.h5
set -eu
{
    h5dump -A 0 -a /calibration_scenes "$1"
    h5dump -A 0 -y -w 1 -m %.17g -d /position_pressure_modes -d /position_deformation_modes -d /position_rows \
        -d /deviation_central_film_thickness "$1"
    # a calibration on trajectories alone has none of these
    h5dump -A 0 -y -w 1 -m %.17g -d /position_seconds -d /position_failures "$1" 2>/dev/null || true
} | tr -d ',' | awk '
    /^(DATASET|ATTRIBUTE)/ { item = $2; gsub("[\"/]", "", item); row = 0 }
    item == "calibration_scenes" && $1 == "(0):" { scenes = $2 }
    /^ *[-+.0-9a-z]+$/ { value[item, ++row] = $1; if (item == "position_rows") last = row }
    function at(name, i) { return (name, i) in value ? value[name, i] : "nan" }
    END {
        film = "deviation_central_film_thickness"
        for (i = 1; i <= last; i++)
            print "ladder", at("position_pressure_modes", i), at("position_deformation_modes", i),
                at("position_rows", i), scenes, at("position_failures", i), at(film, 3 * i),
                at(film, 3 * i - 1), at(film, 3 * i - 2), at("position_seconds", i)
    }'
