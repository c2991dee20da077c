#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The sizes of a model: n, 2n+1, m, unknowns, pressure modes, deformation modes, rows, needed nodes.
#     sizes.sh MODEL.h5
h5ls "$1" | tr -d '{},' | awk '
    { size[$1] = $3 }
    END {
        deformation = "elasticity_jacobian" in size ? size["deformation_mode"] : 0
        n = size["x"] * ("y" in size ? size["y"] : 1)
        print n, 2 * n + 1, size["state"], size["pressure_mode"] + deformation + 1,
            size["pressure_mode"], deformation, size["row"], size["needed_node"]
    }'
