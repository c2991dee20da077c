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

for name in paper long fine2 fine4; do
    echo "$name"
    h5dump -A 0 -y -m %.10g -d /status -d /central_film_thickness "$work/$name.h5"
done >"$work/numbers"
for attribute in inlet_effect step_effect observed_order inlet_nodes spike_nodes outlet_nodes; do
    h5dump -A 0 -y -m %.6g -a /$attribute "$work/paper.h5" 2>"$work/missing" || true
done >>"$work/numbers"
awk -v start="$M,$L,$step" '
    /^[a-z]+[24]?$/ { result = $1 }
    /^(DATASET|ATTRIBUTE)/ { item = $2; gsub("[\"/]", "", item) }
    /^ *[-+.0-9a-z]+$/ && NF == 1 && $1 != result { value[item == "status" || item ~ /film/ ? result item : item] = $1 }
    function film(name) { return value[name "status"] == 0 ? value[name "central_film_thickness"] : "" }
    END {
        at = film("paper")
        if (at != "" && film("long") != "") inlet = sprintf("%.6g", film("long") / at - 1)
        if (at != "" && film("fine2") != "" && film("fine4") != "")
            steps = sprintf("%.6g", (film("fine4") + (film("fine4") - film("fine2")) / 3) / at - 1)
        print start "," at "," value["inlet_effect"] "," inlet "," value["step_effect"] "," steps "," \
            value["observed_order"] "," value["inlet_nodes"] "," value["spike_nodes"] "," value["outlet_nodes"]
    }' "$work/numbers"
