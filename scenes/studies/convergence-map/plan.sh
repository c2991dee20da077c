#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The plan of one piece of the map. M up to 2000 and L up to 25, as far as the viscosity law holds: Barus
# and Roelands do everywhere, WLF no. 1 up to 11.5 GPa, which is alpha p_H = 271.
#     plan.sh barus|roelands|wlf incompressible|dowson-higginson low|high
set -eu
case $1 in
barus) viscosity='law: barus, alpha: 20e-9' ;;
roelands) viscosity='law: roelands, eta0: 0.04, alpha: 20e-9' ;;
wlf) viscosity='law: wlf, preset: no1' ;;
esac
case $1 in
wlf) highest=270 ;;
*) highest=450 ;;
esac
case $3 in
low) M='1, 1.4, 2, 2.8, 4, 5, 7, 10, 14, 20, 28, 40' step=0.005 ;;
high) M='50, 70, 100, 140, 200, 280, 400, 560, 800, 1130, 1600, 2000' step=0.002 ;;
esac
cat <<YAML
groups:
  - scene:
      contact: line
      regime: stationary
      lubricant: {viscosity: {$viscosity}, density: {law: $2}}
      grid: {x_min: -4, x_max: 2, step: $step}
    vary:
      moes.M: [$M]
      moes.L: [0, 0.5, 1, 2.5, 5, 7.5, 10, 12.5, 15, 17.5, 20, 22.5, 25]
    where: {alpha_p_H: [0, $highest]}
YAML
