#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# make trade at a small size: the picture and the numbers have all alternatives, and these are what the
# programs say.

load common

# Of what the scene asks for published rows.
out=out-accurate

setup() { unset MAKEFLAGS MAKELEVEL MFLAGS V; }

# rows ALTERNATIVE: how many the CSV has, all of them with a deviation and a time.
rows() { awk -F, -v name="$1" 'FNR > 1 && $1 == name && $6 + 0 >= $8 + 0 && $9 > 0 { n++ } END { print n + 0 }' "$out"/trade.csv; }

# value ALTERNATIVE POSITION COLUMN
value() { awk -F, -v name="$1" -v position="$2" -v column="$3" '$1 == name && $2 == position { print $column }' "$out"/trade.csv; }

# sizes: how many of the model were calibrated.
sizes() { romrun --print "$out"/calibrated.h5 position_rows | tail -n +2 | grep -c .; }

# film WAY SCENE: the central film as it was kept, scenes counted from 0.
film() { /usr/bin/python3 -c 'import json, sys; print(json.load(open(sys.argv[1]))[int(sys.argv[2])]["H_c"])' "$out/trade/$1.json" "$2"; }

@test "a stationary scene: sizes, grids, tolerances, starts and formulas in one picture" {
    copy_scene studies/stationary-line
    sed -i -e 's/moes.M: .*/moes.M: [10, 12, 15]/' -e 's/moes.L: .*/moes.L: [9, 11, 13]/' plan.yml
    sed -i -e 's/moes.M: .*/moes.M: [11, 13.5]/' -e 's/moes.L: .*/moes.L: [10, 12]/' check-plan.yml
    small="MODELS=model model.PRESSURE_MODES=9 model.ROWS=30 TRADE_STRETCHES=2 TRADE_TOLERANCES=1e-2 TRADE_REPEAT=1"
    run_make trade $small
    echo "$output"
    [ "$status" -eq 0 ]
    [[ $output == *"4 scenes: median"*"cold start against start from the reduced solution"*"picture: "* ]]
    [ "$(head -c 4 "$out"/trade.png | tail -c 3)" = PNG ]
    grep -q '</svg>' "$out"/trade.svg
    [ "$(head -n 1 "$out"/trade.csv)" = alternative,position,quantity,scenes,failures,worst,deviation_95,median,seconds,true_worst,true_95,true_median ]
    [ "$(rows formula)" -eq 6 ]
    [ "$(rows "full cold")" -eq 3 ]
    [ "$(rows "full from neighbour")" -eq 4 ]
    [ "$(rows "full from reduced")" -eq 1 ]
    [ "$(awk -F, '$1 == "reduced" && $4 == 4' "$out"/trade.csv | wc -l)" -eq "$(sizes)" ]
    [ "$(awk -F, '$6 == "" && $1 != "truth" || NF != 12' "$out"/trade.csv | wc -l)" -eq 0 ]

    # the reference deviates by nothing, what starts elsewhere by rounding
    [ "$(value "full cold" "step 1 times tolerance 1e-10" 6)" = 0 ]
    awk -v a="$(value "full from reduced" "step 1 times tolerance 1e-10" 6)" 'BEGIN { exit !(a < 1e-9) }'
    # from the truth the reference is as far as its inlet makes it, by its own estimate too; a longer one is nearer
    awk -v off="$(value "full cold" "step 1 times tolerance 1e-10" 10)" -v inlet="$(value reference inlet 6)" \
        -v longer="$(value truth "inlet 4 times" 10)" -v finer="$(value truth "step 0.25 times" 10)" \
        'BEGIN { exit !(off > 1e-3 && inlet / off > 0.7 && inlet / off < 1.1 && longer < off / 10 && finer > off / 2) }'
    [ "$(awk -F, '$1 != "reference" && !($10 >= $12 && $12 > 0) && $5 == 0' "$out"/trade.csv | wc -l)" -eq 0 ]
    # by the programs themselves, on one of the scenes
    fullrun "$out"/trade/scene-002.yml -o fine.h5 --quiet >/dev/null
    fullrun "$out"/trade/scene-002.yml -o coarse.h5 --quiet --set grid.step=0.04 >/dev/null
    [ "$(awk '/moes/ { printf "%s ", $2 }' "$out"/trade/scene-002.yml)" = "11 12 " ]
    fullrun "$out"/trade/scene-002.yml -o true.h5 --quiet --set grid.x_min=-24 --set grid.step=0.005 >/dev/null
    awk -v own="$(number fine.h5 central_film_thickness)" -v true="$(number true.h5 central_film_thickness)" \
        -v worst="$(value "full cold" "step 1 times tolerance 1e-10" 10)" \
        'BEGIN { off = 1 - own / true; exit !(off > worst / 3 && off < worst * 1.05) }'
    close_to "$(film cold-2-1e-10 1)" "$(number coarse.h5 central_film_thickness)" 1e-12
    awk -v fine="$(number fine.h5 central_film_thickness)" -v coarse="$(number coarse.h5 central_film_thickness)" \
        -v worst="$(value "full cold" "step 2 times tolerance 1e-10" 6)" \
        'BEGIN { off = coarse / fine - 1; if (off < 0) off = -off; exit !(off <= worst * 1.001) }'
    # each scene polished
    awk -F, 'NR > 1 && !($4 > 0 && $6 > 0 && $9 < 1e-9) { exit 1 } END { exit NR != 5 }' "$out"/polish.csv

    run_make -n trade $small
    [[ $status == 0 && ! $output =~ trade.py && ! $output =~ bin/snapgen && ! $output =~ --calibrate ]]
    # an interrupted measurement goes on with what is missing
    rm "$out"/trade.csv "$out"/trade/cold-2-1e-10.json
    run_make trade $small
    [ "$(grep '^  measure ' <<<"$output" | tail -n +2)" = "  measure    cold-2-1e-10" ]
    # scenes that the calibration left out would be compared with nothing
    sed -i 's/moes.L: .*/moes.L: [10, 40]/' check-plan.yml
    run_make trade $small
    [[ $status == 2 && $output == *"check-plan.yml: found 4 stationary scenes, expected the 2 that"* ]]
}

@test "a point contact: its own formulas, grids that are no whole multiples" {
    copy_scene studies/point-stationary
    sed -i -e 's/step: 0.02/step: 0.125/' scene.yml
    sed -i -e 's/moes.M: .*/moes.M: [15, 17, 19.5, 22.5]/' -e 's/moes.L: .*/moes.L: [4.7, 5.5, 6.3]/' plan.yml
    sed -i -e 's/moes.M: .*/moes.M: [16, 21]/' -e 's/moes.L: .*/moes.L: [5, 6]/' check-plan.yml
    out=out
    run_make trade model.PRESSURE_MODES=9 model.ROWS=60 TRADE_TRUTH="2 0.8 0.5" TRADE_STRETCHES="1.333333333333 2" TRADE_TOLERANCES=1e-2 TRADE_REPEAT=1
    echo "$output"
    [ "$status" -eq 0 ]
    [ "$(head -c 4 out/trade.png | tail -c 3)" = PNG ]
    [ "$(awk -F, '$1 == "formula" { print $2, $3 }' out/trade.csv)" = "nijenbanning central
hamrock-dowson-central central
hamrock-dowson-minimum minimum" ]
    [ "$(rows formula)" -eq 3 ]
    [ "$(rows "full cold")" -eq 4 ]
    [ "$(rows "full from neighbour")" -eq 6 ]
    [ "$(rows "full from reduced")" -eq 1 ]
    [ "$(awk -F, '$1 == "reduced" && $4 == 4' out/trade.csv | wc -l)" -eq "$(sizes)" ]
    [ "$(awk -F, '$1 == "reference" { print $2 }' out/trade.csv)" = "step
inlet" ]
    awk -v a="$(value "full from reduced" "step 1 times tolerance 1e-10" 6)" 'BEGIN { exit !(a < 1e-9) }'
    awk -v a="$(value "full cold" "step 1.33 times tolerance 1e-10" 6)" -v b="$(value "full cold" "step 2 times tolerance 1e-10" 6)" \
        'BEGIN { exit !(0 < a && a < b) }'
}

@test "a transient scene: sizes, steps, grids and formulas at each time" {
    copy_scene studies/transient-load
    sed -i 's/end_time: .*/end_time: 0.2/' scene.yml
    sed -i 's/period: \[.*/period: [0.5, 1]/' plan.yml
    sed -i 's/period: \[.*/period: [0.75]/' check-plan.yml
    small="MODELS=model model.PRESSURE_MODES=32 model.ROWS=50 TRADE_STRETCHES=2"
    out=out # published rows, as the scene asks for
    run_make trade $small TRADE_STEPS='1e-4 1e-3 1e-2 fixed0.01 still40'
    echo "$output"
    [ "$status" -eq 0 ]
    [ "$(head -c 4 out/trade.png | tail -c 3)" = PNG ]
    [ "$(rows formula)" -eq 6 ]
    [ "$(rows full)" -eq 8 ]
    [ "$(awk -F, '$1 == "reduced"' out/trade.csv | wc -l)" -eq "$(($(sizes) + 4))" ]
    [ "$(value full "step 1 times tolerance 1e-4" 6)" = 0 ]
    # longer steps deviate more, and so does a coarser grid; a third of that is the grid's own
    awk -v fine="$(value full "step 1 times tolerance 1e-3" 6)" -v rough="$(value full "step 1 times tolerance 1e-2" 6)" \
        -v coarse="$(value full "step 2 times tolerance 1e-4" 6)" -v grid="$(value reference step 6)" \
        'BEGIN { exit !(0 < fine && fine < rough && coarse > 0 && coarse / grid > 2.99 && coarse / grid < 3.01) }'
    # without its past the contact is another one, and both models say so
    awk -v full="$(value full "step 1 times stationary at 40 times" 6)" -v past="$(value full "step 1 times fixed steps 0.01" 6)" \
        -v reduced="$(awk -F, '$1 == "reduced" && /stationary/ { print $6 }' out/trade.csv)" \
        'BEGIN { exit !(full > 10 * past && reduced / full > 0.9 && reduced / full < 1.1) }'
    # as romrun --against says
    run -0 --separate-stderr romrun out/trade/scene-001.yml --quiet --model out/model.h5 \
        --set transient.fixed_step=0.01 --against "$(fullrun out/trade/scene-001.yml \
        --set transient.tolerance=1e-4 --quiet -o full.h5 >/dev/null && echo full.h5)"
    close_to "$(awk -F, '$1 == "reduced" && $2 ~ /fixed/ { print 100 * $6 }' out/trade.csv)" \
        "$(sed -n 's/.*central film thickness *at most \([^ ]*\) %.*/\1/p' <<<"$output")" 0.01
}
