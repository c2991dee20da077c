#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The states of one plan on three grids, coarse to fine, and what the published fit says of each point, as CSV:
#     GRID,M,L,status,H_c,P_c,p_H,complementarity          GRID: 1, 2, 3
#     fit,M,L,H_c
#     BIN=... film.sh COARSE.h5 FINE.h5 FINEST.h5
set -eu
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

cat >"$work/scene.yml" <<YAML
contact: point
regime: stationary
lubricant: {viscosity: {law: roelands, eta0: 0.04, alpha: 20e-9}, density: {law: dowson-higginson}}
grid: {x_min: -4.25, x_max: 1.25, y_max: 2.75}
output: {resolution: false}
YAML

# The fit goes by M and L alone; fullrun prints it beside a solution, so on the coarsest grid that has one.
fit() {
    for step in 0.25 0.125 0.0625 0.03125 0.015625; do
        ! "$BIN/fullrun" "$work/scene.yml" -o "$work/fit.h5" --force --quiet --formulas --set moes.M="$1" \
            --set moes.L="$2" --set grid.step=$step >"$work/answer" 2>"$work/errors" || break
    done
    awk -v point="fit,$1,$2," '/^formula nijenbanning/ { print point $4 }' "$work/answer"
}

grid=0
for file; do
    grid=$((grid + 1))
    "$BIN/snapgen" --print "$file" moes_M moes_L status central_film_thickness central_pressure hertz_pressure \
        complementarity | sed -e 1d -e "s/^/$grid,/"
done >"$work/states"
cat "$work/states"
sed -n 's/^1,\([^,]*\),\([^,]*\),.*/\1 \2/p' "$work/states" | while read -r M L; do fit "$M" "$L"; done
