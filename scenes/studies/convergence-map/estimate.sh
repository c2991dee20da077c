#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Estimated against measured: solves a point on the published grid, with a long inlet and with a half and
# a quarter of the step, and prints a line of estimates.csv. What is not known is left empty.
#     BIN=... estimate.sh M L STEP "MORE SETTINGS"
set -eu
M=$1 L=$2 step=$3 more=$4
case $step in
0.005) inlet=-32 ;;
*) inlet=-16 ;;
esac
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# solve NAME SETTING...: a result that did not converge has a film that says so.
solve() {
    name=$1
    shift
    # shellcheck disable=SC2086 # the settings are several words
    "$BIN/fullrun" scene.yml -q -o "$work/$name.h5" --set moes.M="$M" --set moes.L="$L" $more "$@" >"$work/log" ||
        [ $? -eq 3 ]
}
solve paper --set grid.step="$step"
solve long --set grid.step="$step" --set grid.x_min=$inlet
for part in 2 4; do
    solve fine$part --set grid.step="$(awk "BEGIN { print $step / $part }")"
done

# film NAME: H_c of a result that converged; estimate NAME: what the paper's grid has of it. Else nothing.
film() { "$BIN/fullrun" --print "$work/$1.h5" status central_film_thickness | sed -n 's/^0,//p'; }
estimate() { "$BIN/fullrun" --print "$work/paper.h5" "$1" 2>"$work/missing" | sed -n 2p; }

awk -v paper="$(film paper)" -v long="$(film long)" -v fine2="$(film fine2)" -v fine4="$(film fine4)" -v OFS=, \
    -v start="$M,$L,$step" -v inlet="$(estimate inlet_effect)" -v step="$(estimate step_effect)" \
    -v order="$(estimate observed_order)" -v inlet_nodes="$(estimate inlet_nodes)" \
    -v spike_nodes="$(estimate spike_nodes)" -v outlet_nodes="$(estimate outlet_nodes)" '
    function number(x) { return x == "" ? "" : sprintf("%.6g", x) }
    BEGIN {
        if (paper != "" && long != "") inlet_measured = long / paper - 1
        if (paper != "" && fine2 != "" && fine4 != "") step_measured = (fine4 + (fine4 - fine2) / 3) / paper - 1
        print start, paper == "" ? "" : sprintf("%.10g", paper), number(inlet), number(inlet_measured), number(step), number(step_measured), number(order), inlet_nodes,
            spike_nodes, outlet_nodes
    }'
