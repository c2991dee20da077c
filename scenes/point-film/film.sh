#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The states of one plan on three grids, coarse to fine, as CSV (Makefile).
#     film.sh COARSE.h5 FINE.h5 FINEST.h5
set -eu
for file; do
    h5dump -A 0 -y -w 1 -m %.10g -d /moes_M -d /moes_L -d /status -d /central_film_thickness \
        -d /central_pressure -d /hertz_pressure -d /complementarity "$file"
done | awk -f film.awk
