#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The plan of the film table on one grid: X in -4.5 … 1.5, Y in -3 … 3, with boundary nodes on these ends
# and so many cells along, half of them across.
#     plan.sh CELLS 'M, ...' 'L, ...' ALPHA
set -eu
# fractions of 2 and 3 need all of a double's digits, for a whole number of steps to fit
number() { awk "BEGIN { printf \"%.17g\", $1 }"; }
step=$(number "6 / $1")
cat <<YAML
groups:
  - scene:
      contact: point
      regime: stationary
      lubricant: {viscosity: {law: roelands, eta0: 0.04, alpha: $4}, density: {law: dowson-higginson}}
      grid: {x_min: $(number "-4.5 + $step"), x_max: $(number "1.5 - $step"), y_max: $(number "3 - $step"), step: $step}
    vary:
      moes.M: [$2]
      moes.L: [$3]
YAML
