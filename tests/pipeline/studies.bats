#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests of the studies at a small size: their tables have a line for each requested case.

load common

setup() { unset MAKEFLAGS MAKELEVEL MFLAGS V; }

# bats test_tags=slow
@test "the convergence map: all points of a small one, and it tells those that fail" {
    copy_scene studies/convergence-map
    sed -i -e 's/"low": (".*", 0.005)/"low": ("5, 12", 0.02)/' -e 's/"high": (".*", 0.002)/"high": ("50, 70", 0.01)/' \
        -e 's/^ALL_L = .*/ALL_L = "0, 5, 10"/' study.py
    run_make LEAST_POINTS=72
    [ "$status" -eq 0 ]
    [ "$(grep -c "^72 points, 0 failed" <<<"$output")" -eq 3 ]
    for map in published accurate default; do
        [ "$(head -c 4 out/$map.png | tail -c 3)" = PNG ]
        grep -q '</svg>' out/$map.svg
    done
    run_make -n
    [[ ! $output =~ bin/$programs ]]

    run_make published LEAST_POINTS=73
    [ "$status" -ne 0 ]
    run_make published LEAST_POINTS=72 SET='--set grid.x_max=1.1' # too short for the smallest M
    [ "$status" -ne 0 ]
    echo "$output"
    [[ $output == *"failed: barus,incompressible,5,10,"*"72 points, 9 failed"* ]]
}

# bats test_tags=slow
@test "the convergence map: estimates of inlet and step beside what is measured" {
    copy_scene studies/convergence-map
    run_make estimates ESTIMATE_LOW=5 ESTIMATE_HIGH=60 ESTIMATE_L='5 20'
    [ "$status" -eq 0 ]
    [[ $output == *"inlet  noted and true 2, not noted and true 2, noted though less 0, missed 0;"* ]]
    [[ $output == *"step   noted and true 0, not noted and true 4, noted though less 0, missed 0;"* ]]
    [ "$(wc -l <out/estimates.csv)" -eq 5 ]
    awk -F, 'function near(a, b) { return a / b > 0.7 && a / b < 1.4 }
        NR > 1 && (!near($5, $6) || $1 == 60 && !near($7, $8)) { exit 1 }' out/estimates.csv
    sed -i '2s/^\([^,]*,[^,]*,[^,]*,[^,]*\),[^,]*/\1,0.001/' out/estimates.csv
    [[ $(PYTHONPATH=../../lib /usr/bin/python3 -B study.py compare out/estimates.csv) == *"inlet  "*"missed 1;"* ]]
}

# bats test_tags=slow
@test "discretisations: the accurate rows are nearer to the equations, stationary and in time" {
    copy_scene studies/discretization
    mkdir ../transient-load
    cp "$BATS_TEST_DIRNAME/../../scenes/studies/transient-load/scene.yml" ../transient-load
    small=(LINE_STEPS='0.02 0.01 0.005' POINT_STEPS='0.1875 0.125 0.0625' TIME_STEPS='0.04 0.02 0.01' END=0.3
        ALL_M='10 50' ALL_L=5 INLET_M=5 INLET_L=5 POINT_M=20 POINT_L=5)
    run_make stationary in-time estimates "${small[@]}"
    echo "$output"
    [ "$status" -eq 0 ]
    # compares the discretisations of each pair on the same grid
    awk 'function abs(x) { return x < 0 ? -x : x }
        $1 == "line" || $1 == "point" { key = $1 $2 $3 $7; off[key, $6] = abs($8); seen[key] }
        END { for (key in seen) { n++; if (!(off[key, "accurate"] < off[key, "published"] / 3)) exit 1 } exit n != 9 }' out/stationary.txt
    awk '$1 == "published" && $2 == 0.02 { published = $5 } $1 == "accurate" && $2 == 0.02 { accurate = $5 }
        END { exit !(accurate > 0 && accurate < published / 3) }' out/in-time.txt
    run_make -n stationary in-time estimates "${small[@]}"
    [[ $status == 0 && ! $output =~ study.py ]]
}

# bats test_tags=slow
@test "silent failures: every scene drawn is in the table, the same for a seed" {
    copy_scenes studies/stationary-line studies/silent-failures
    cd studies || return
    sed -i 's/step: [0-9.]*/step: 0.01/' stationary-line/scene.yml # all scenes of the study have this step
    cd silent-failures || return
    small='SEED=3 SCENES=24 CALIBRATION_SCENES=60 PROMISES=1e-2'
    run_make $small
    [ "$status" -eq 0 ]
    [[ $output == *"seed 3, calibrated on seed 1000003"*"promise 0.01"*"silent failures: 0" ]]
    awk '/lubricant/ { total += $(NF - 7) + $(NF - 6) + $(NF - 3) + $(NF - 2) + $(NF - 1) + $NF }
         /outside/ { outside = $(NF - 7) + $(NF - 6) + $(NF - 3) + $(NF - 2) + $(NF - 1) + $NF }
         END { exit !(total == 24 && outside == 12) }' out/table-3-24.txt
    # the same seed draws the same scenes, another seed does not
    study() { PYTHONPATH=../../lib BIN=$BIN /usr/bin/python3 -B study.py "$@"; }
    study draw again 3 24 ../stationary-line/out-accurate/model.h5 ../stationary-line/scene.yml
    cmp <(sed 's/out.test-3-24/again/' out/test-3-24/scenes.json) again/scenes.json
    cmp out/test-3-24/plan.yml again/plan.yml
    study draw again 4 24 ../stationary-line/out-accurate/model.h5 ../stationary-line/scene.yml
    run -1 cmp -s out/test-3-24/plan.yml again/plan.yml
    # loads and speeds lie in the region; they are drawn alternately from a uniform and from a logarithmic distribution
    study training roller roller
    study draw drawn 5 60 none roller/scene.yml region
    grep -q '^physical: {load: .*, speed: ' drawn/scene-1.yml
    /usr/bin/python3 - <<'PYTHON'
import json, numpy
scenes = [scene["settings"] for scene in json.load(open("drawn/scenes.json"))]
load, speed = (numpy.array([float(s[f"physical.{key}"]) for s in scenes]) for key in ("load", "speed"))
assert len(load) == 60 and load.min() > 50e3 and load.max() < 400e3 and speed.min() > 0.2 and speed.max() < 10
assert 4 < numpy.median(speed[::2]) < 6.5 and 0.8 < numpy.median(speed[1::2]) < 2.5
PYTHON
    # every wrong result without a flag is reported, however few there are
    printf '%s\n' \
        "promise,where,whose,code,central,minimum,indicated_central,indicated_minimum,friction_coefficient,rolling_resistance,\
fields,full_central,full_minimum,full_friction_coefficient,full_rolling_resistance" \
        1e-2,inside,own,0,1,2.04,0.1,0.01,0.051,2,0.05,1,2,0.05,2 1e-2,inside,other,4,1.5,1,1,1,,,2,1,1,, \
        1e-2,outside,other,3,,,,,,,,1,1,, 1e-2,inside,own,0,1.001,1,0.004,0.004,,,0.01,1,1,, \
        1e-2,inside,own,4,1.001,1,0.02,0.02,,,0.01,1,1,, none,inside,own,0,1.011,1,,,,,,1,1,, >runs.csv
    run study table runs.csv 1 2
    [[ $output == *"promise 0.01"*"inside, own lubricant         1        1       50.0 %                1        0          0            0"* ]]
    [[ $output == *"no promise asked for"*"inside, own lubricant         0        0        0.0 %                1        0 "* ]]
    [[ $output == *"silent failures: 2, the worst 0.02 off" ]]
    [[ $output == *"fields off by more than 3 times that, not flagged: 1 of 2; the worst 5 times"* ]]
    [[ $output == *"friction coefficient off by more than that, not flagged: 1 of 1; the worst 2 times"* ]]
    [[ $output == *"rolling resistance off by more than that, not flagged: 0 of 1; the worst 0 times"* ]]
    [[ $output == *"inside, central film: 0 of 3 below 1, least 2, median 4, 95 % 18"* ]]
    [[ $output == *"inside, minimum film: 1 of 1 below 1, least 0.5, median 0.5, 95 % 0.5"* ]]
    # a profile shifted by less than a node is accepted as equal, a profile with a spike elsewhere is not
    PYTHONPATH=../../lib:. /usr/bin/python3 -B -c "
import numpy, study
a = numpy.array([0, 1, 5, 2, 1, 0.]); b = numpy.array([0, 0.5, 4, 5, 1, 0.])
assert study.beyond_neighbours(a, b) == 0
b[3], b[4] = 2, 4
assert study.beyond_neighbours(a, b) == 2
assert study.beyond_neighbours(numpy.outer(a, a), numpy.outer(b, b)) > 2"
    run_make $small
    [[ $status == 0 && $output != *"  calibrate "* && $output != *"  romrun "* ]]
    # for another model, scenes are drawn anew, even if this model is older than the scenes of the first model
    cp ../stationary-line/out-accurate/model.h5 older.h5
    touch -d 2000-01-01 older.h5
    run_make -n $small MODEL=older.h5
    [[ $status == 0 && $output == *"study.py draw"*"romrun calibrate"* ]]
}
