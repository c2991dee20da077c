#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests of make trade at a small size: the picture and the table have all alternatives, and the numbers agree with the
# programs.

load common

# The scene has published rows, so results with accurate rows are in this folder.
out=out-accurate

setup() { unset MAKEFLAGS MAKELEVEL MFLAGS V; }

# rows ALTERNATIVE: prints the number of its rows in the CSV, provided that they have a deviation and a time.
rows() { awk -F, -v name="$1" 'FNR > 1 && $1 == name && $6 + 0 >= $8 + 0 && $9 > 0 { n++ } END { print n + 0 }' "$out"/trade.csv; }

# value ALTERNATIVE POSITION COLUMN: prints an entry of the CSV
value() { awk -F, -v name="$1" -v position="$2" -v column="$3" '$1 == name && $2 == position { print $column }' "$out"/trade.csv; }

# sizes: prints the number of calibrated sizes of the model.
sizes() { romrun --print "$out"/calibrated.h5 position_rows | tail -n +2 | grep -c .; }

# film WAY SCENE: prints the stored central film, scenes counted from 0.
film() { /usr/bin/python3 -c 'import json, sys; print(json.load(open(sys.argv[1]))[int(sys.argv[2])]["H_c"])' "$out/trade/$1.json" "$2"; }

# bats test_tags=slow
@test "a stationary scene: sizes, grids, tolerances, starts and formulas in one picture" {
    copy_scene studies/stationary-line
    sed -i -e 's/moes.M: .*/moes.M: [10, 12, 15]/' -e 's/moes.L: .*/moes.L: [9, 11, 13]/' plan.yml
    sed -i -e '/^define check-plan/,/^endef/ { s/moes.M: .*/moes.M: [11, 13.5]/; s/moes.L: .*/moes.L: [10, 12]/ }' Makefile
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

    # the deviation of the reference is 0, and the deviation with another start is round-off
    [ "$(value "full cold" "step 1 times tolerance 1e-10" 6)" = 0 ]
    awk -v a="$(value "full from reduced" "step 1 times tolerance 1e-10" 6)" 'BEGIN { exit !(a != "" && a < 1e-9) }'
    # the reference deviates from the truth by the effect of its inlet, which its own estimate shows; a longer inlet is
    # more accurate
    awk -v off="$(value "full cold" "step 1 times tolerance 1e-10" 10)" -v inlet="$(value reference inlet 6)" \
        -v longer="$(value truth "inlet 4 times" 10)" -v finer="$(value truth "step 0.25 times" 10)" \
        'BEGIN { exit !(off > 1e-3 && inlet / off > 1 && inlet / off < 1.4 && longer > 0 && longer < off / 10 && finer > off / 2) }'
    [ "$(awk -F, '$1 != "reference" && !($10 >= $12 && $12 > 0) && $5 == 0' "$out"/trade.csv | wc -l)" -eq 0 ]
    # repeats one of the scenes with the programs themselves
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
        'BEGIN { off = coarse / fine - 1; if (off < 0) off = -off; exit !(off > 0 && off <= worst * 1.001) }'
    # each scene is solved again from the reduced solution
    awk -F, 'NR > 1 && !($4 > 0 && $6 > 0 && $9 < 1e-9) { bad = 1 } END { exit bad || NR != 5 }' "$out"/polish.csv

    run_make -n trade $small
    [[ $status == 0 && ! $output =~ trade.py && ! $output =~ bin/snapgen && ! $output =~ "romrun calibrate" ]]
    # an interrupted measurement repeats only what is missing
    rm "$out"/trade.csv "$out"/trade/cold-2-1e-10.json
    run_make trade $small
    [ "$(grep '^  measure ' <<<"$output" | tail -n +2)" = "  measure    cold-2-1e-10" ]
    # scenes that the calibration left out could not be compared
    sed -i '/^define check-plan/,/^endef/ s/moes.L: .*/moes.L: [10, 40]/' Makefile
    run_make trade $small
    [[ $status == 2 && $output == *"check-plan.yml: found 4 stationary scenes, expected the 2 that"* ]]
}

# bats test_tags=slow
@test "a point contact: its own formulas, grids that are no whole multiples" {
    copy_scene studies/point-stationary
    sed -i -e 's/step: 0.02/step: 0.125/' scene.yml
    sed -i -e '/^define plan.yml/,/^endef/ { s/moes.M: .*/moes.M: [15, 17, 19.5, 22.5]/; s/moes.L: .*/moes.L: [4.7, 5.5, 6.3]/ }' Makefile
    sed -i -e '/^define check-plan/,/^endef/ { s/moes.M: .*/moes.M: [16, 21]/; s/moes.L: .*/moes.L: [5, 6]/ }' Makefile
    out=out
    run_make trade model.PRESSURE_MODES=9 model.ROWS=60 TRADE_TRUTH="2 0.8 0.5" TRADE_STRETCHES="1.333333333333 2" TRADE_TOLERANCES=1e-2 TRADE_REPEAT=1
    echo "$output"
    [ "$status" -eq 0 ]
    [ "$(head -c 4 out/trade.png | tail -c 3)" = PNG ]
    [ "$(awk -F, '$1 == "formula" { print $2, $3 }' out/trade.csv)" = "nijenbanning central
hamrock-dowson-central central
hamrock-dowson-minimum minimum
chittenden-central central
chittenden-minimum minimum" ]
    [ "$(rows formula)" -eq 5 ]
    [ "$(rows "full cold")" -eq 4 ]
    [ "$(rows "full from neighbour")" -eq 6 ]
    [ "$(rows "full from reduced")" -eq 1 ]
    [ "$(awk -F, '$1 == "reduced" && $4 == 4' out/trade.csv | wc -l)" -eq "$(sizes)" ]
    [ "$(awk -F, '$1 == "reference" { print $2 }' out/trade.csv)" = "step
inlet" ]
    awk -v a="$(value "full from reduced" "step 1 times tolerance 1e-10" 6)" 'BEGIN { exit !(a != "" && a < 1e-9) }'
    awk -v a="$(value "full cold" "step 1.33 times tolerance 1e-10" 6)" -v b="$(value "full cold" "step 2 times tolerance 1e-10" 6)" \
        'BEGIN { exit !(0 < a && a < b) }'
}

# bats test_tags=slow
@test "a transient scene: sizes, steps, grids and formulas at each time" {
    copy_scene studies/transient-load
    sed -i 's/end_time: .*/end_time: 1.5/' scene.yml # up to T = 1 the central film does not vary
    sed -i -e '1i TRAINED_PERIODS = 0.5, 1' -e '1i CHECK_PERIODS = 0.75' Makefile
    small="MODELS=model model.PRESSURE_MODES=70 model.ROWS=120 TRADE_STRETCHES=2 TRADE_REPEAT=1"
    run_make trade $small TRADE_TRUTH='0.5 0.0025' TRADE_STEPS='5e-4 1.5e-3 1.5e-2 fixed0.01 still40'
    echo "$output"
    [ "$status" -eq 0 ]
    [ "$(head -c 4 "$out"/trade.png | tail -c 3)" = PNG ]
    [ "$(rows formula)" -eq 6 ]
    [ "$(rows full)" -eq 7 ]
    [ "$(rows "full published")" -eq 2 ]
    [ "$(awk -F, '$1 == "reduced"' "$out"/trade.csv | wc -l)" -eq "$(($(sizes) + 3))" ]
    [ "$(value full "step 1 times tolerance 5e-4" 6)" = 0 ]
    # longer steps deviate more, from the reference and from the truth
    awk -v fine="$(value full "step 1 times tolerance 1.5e-3" 6)" -v rough="$(value full "step 1 times tolerance 1.5e-2" 6)" \
        'BEGIN { exit !(0 < fine && fine < rough) }'
    true_of() { value full "step $1" 10; }
    awk -v fine="$(true_of "1 times tolerance 1.5e-3")" -v rough="$(true_of "1 times tolerance 1.5e-2")" \
        -v coarse="$(true_of "2 times tolerance 1.5e-3")" -v published="$(value "full published" "rows as published tolerance 1e-4" 10)" \
        'BEGIN { exit !(0 < fine && fine < rough && fine < coarse && fine < published) }'
    # solutions with twice the step are near the solution that is called truth, the reference of this column
    [ "$(value truth "step 0.5 times fixed steps 0.0025" 10)" = 0 ]
    awk -v twice="$(value truth "step 1 times fixed steps 0.005" 10)" -v rough="$(true_of "1 times tolerance 1.5e-2")" \
        -v coarse="$(true_of "2 times tolerance 1.5e-3")" 'BEGIN { exit !(0 < twice && twice < rough && twice < coarse / 2) }'
    # repeats the comparison with the full model
    fullrun "$out"/trade/scene-001.yml -o true.h5 --quiet --set transient.smoothing=0 --set transient.fixed_step=0.0025 \
        --set grid.step="$(awk '/^grid.step/ { print $2 / 2 }' "$out"/trade/scene-001.yml)" >/dev/null
    fullrun "$out"/trade/scene-001.yml -o full.h5 --quiet --set transient.fixed_step=0.01 >/dev/null
    run -0 env PYTHONPATH="$BATS_TEST_DIRNAME/../../scenes/lib" /usr/bin/python3 -B -c 'import results, trajectories
print(trajectories.largest(*map(results.read_trajectory, ("true.h5", "full.h5")), "H_c") / 100)'
    close_to "$output" "$(true_of "1 times fixed steps 0.01")" 1e-3
    # the stationary contact at each time is far from the solution with its history
    awk -v full="$(value full "step 1 times stationary at 40 times" 6)" -v past="$(value full "step 1 times fixed steps 0.01" 6)" \
        'BEGIN { exit !(past > 0 && full > 10 * past) }'
    # romrun --against agrees
    run -0 --separate-stderr romrun "$out"/trade/scene-001.yml --quiet --model "$out"/model.h5 \
        --set transient.fixed_step=0.01 --allow-untrusted --against "$(fullrun "$out"/trade/scene-001.yml \
        --set transient.tolerance=5e-4 --force --quiet -o full.h5 >/dev/null && echo full.h5)"
    close_to "$(awk -F, '$1 == "reduced" && $2 ~ /fixed/ { print 100 * $6 }' "$out"/trade.csv)" \
        "$(sed -n 's/.*central film thickness *at most \([^ ]*\) %.*/\1/p' <<<"$output")" 0.01
}
