#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The sizes of a model: n, pressure modes, deformation modes, rows, needed nodes, training solutions.
#     BIN=... model.sh MODEL.h5
"$BIN/romrun" --print "$1" | awk -F, '
    $1 == $4 { length_of[$1] = $3 } # an axis
    { there[$1] }
    END {
        print length_of["x"] * ("y" in length_of ? length_of["y"] : 1), length_of["pressure_mode"],
            "elasticity_jacobian" in there ? length_of["deformation_mode"] : 0, length_of["row"],
            length_of["needed_node"], length_of["state"]
    }'
