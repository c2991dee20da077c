#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The points of an adaptive training: M, L, round.
#     points.sh SNAPSHOTS.h5
h5dump -y -A 0 -w 1 -m %.9g -d /moes_M -d /moes_L -d /training_round "$1" | tr -d ', ' | awk '
    /DATASET/ { column++; row = 0 }
    /^[0-9]/ { value[column, ++row] = $1 }
    END { for (i = 1; i <= row; i++) print value[1, i] "," value[2, i] "," value[3, i] }'
