#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests of reduced models of flows that sliding thins (lubricant.shear.in_film), from training to solution.

load common

# sliding_scene KIND LOAD-RADIUS-SPEED SLIDE-ROLL GRID: prints a scene.
sliding_scene() {
    cat <<YAML
contact: $1
regime: stationary
physical: {$2, modulus: 2.3e11, viscosity: 0.04}
slide_roll: $3
lubricant:
  viscosity: {law: barus, alpha: 15e-9}
  density: {law: dowson-higginson}
  shear: {law: eyring, tau0: 5e6, in_film: true}
grid: {$4}
YAML
}

# sliding_line GRID: writes line.yml, and plan.yml, in which load, speed, sliding and Eyring's stress vary.
sliding_line() {
    sliding_scene line 'load: 1.0e5, radius: 0.01, speed: 0.7' 0.4 "$1" >line.yml
    cat >plan.yml <<'YAML'
groups:
  - scene: line.yml
    vary:
      physical.load: [6e4, 8.5e4, 1.2e5]
      physical.speed: [0.5, 0.7, 1]
      slide_roll: [0.1, 0.316, 1]
      lubricant.shear.tau0: [3e6, 1e7]
YAML
}

# train NAME [OPTION...]: trains NAME.h5, a checked model, on the plan NAME.yml, with options of podbuild.
train() {
    snapgen "$1.yml" -o "$1-s.h5" --quiet
    podbuild "$1-s.h5" -o "$1-b.h5" "${@:2}"
    snapgen "$1.yml" --basis "$1-b.h5" -o "$1-r.h5" --quiet
    deimselect "$1-r.h5" --basis "$1-b.h5" -o "$1.h5"
}

# Makes plan.h5 with 301 nodes and 54 points, and newton.h5 with 16 points of a Newtonian flow.
setup_file() {
    cd "$BATS_FILE_TMPDIR" || return
    sliding_line "x_min: -4, x_max: 2, step: 0.02"
    train plan
    sed 's/, in_film: true//' line.yml >newton-line.yml
    cat >newton.yml <<'YAML'
groups:
  - scene: newton-line.yml
    vary: {physical.load: [8e4, 9e4, 1e5, 1.1e5], physical.speed: [0.6, 0.65, 0.7, 0.8]}
YAML
    train newton --pressure-modes 14
}

setup() {
    cd "$BATS_TEST_TMPDIR" || return
    cp "$BATS_FILE_TMPDIR"/*.{yml,h5} .
}

unseen="--set physical.load=1.07e5 --set physical.speed=0.6 --set slide_roll=0.8 --set lubricant.shear.tau0=3.4e6"

# bats test_tags=slow
@test "unseen loads, speeds, sliding and stresses, and their friction" {
    # shellcheck disable=SC2086
    fullrun line.yml -o full.h5 --quiet $unseen
    # shellcheck disable=SC2086
    fullrun line.yml -o rolled.h5 --quiet $unseen --set lubricant.shear.in_film=false
    # the result is trusted: the model was checked, and the scene lies in the trained range
    # shellcheck disable=SC2086
    romrun line.yml --model plan.h5 -o red.h5 --quiet $unseen --against full.h5
    close_to "$(number red.h5 central_film_thickness)" "$(number full.h5 central_film_thickness)" 1e-4
    close_to "$(number red.h5 minimum_film_thickness)" "$(number full.h5 minimum_film_thickness)" 3e-4
    close_to "$(number red.h5 friction_coefficient)" "$(number full.h5 friction_coefficient)" 1e-4
    # a Newtonian flow would have another film
    far_from "$(number rolled.h5 minimum_film_thickness)" "$(number full.h5 minimum_film_thickness)" 2e-3
    # shellcheck disable=SC2086
    refuse 65 "rolled.h5: thinning: found 0, expected the scene's 0.0" \
        romrun line.yml --model plan.h5 -o x.h5 --quiet $unseen --against rolled.h5
}

# bats test_tags=slow
@test "what the sliding does and what the pressure gradient does count apart" {
    romrun line.yml --model plan.h5 -o one.h5 --quiet --set slide_roll=0.2 --set lubricant.shear.tau0=4e6
    romrun line.yml --model plan.h5 -o back.h5 --quiet --set slide_roll=-0.2 --set lubricant.shear.tau0=4e6
    romrun line.yml --model plan.h5 -o two.h5 --quiet --set slide_roll=0.4 --set lubricant.shear.tau0=8e6
    for name in central_film_thickness minimum_film_thickness central_pressure thinning; do
        close_to "$(number back.h5 $name)" "$(number one.h5 $name)" 1e-12
    done
    close_to "$(number back.h5 friction_force)" "-$(number one.h5 friction_force)" 1e-12
    close_to "$(number two.h5 thinning)" "$(number one.h5 thinning)" 1e-12
    far_from "$(number two.h5 central_film_thickness)" "$(number one.h5 central_film_thickness)" 3e-4
    # the full model agrees
    fullrun line.yml -o full.h5 --quiet --set slide_roll=0.4 --set lubricant.shear.tau0=8e6
    close_to "$(number two.h5 central_film_thickness)" "$(number full.h5 central_film_thickness)" 2e-5
    # this stress lies beyond the training, the sliding does not
    run --separate-stderr romrun line.yml --model plan.h5 -o fast.h5 --quiet --set slide_roll=2 \
        --set lubricant.shear.tau0=2e7
    [ "$status" -eq 4 ]
    [[ $stderr == *"a flow that the pressure gradient thins less than any in training"* ]]
}

# The films are those of Conry, Wang and Cusano's flow by an independent solver, extrapolated to a step of 0, within
# 2e-4. On this step the films are at most 1.3e-4 off.
# bats test_tags=slow
@test "films of lines are those of the exact flow at any gradient" {
    cat >exact.yml <<'YAML'
contact: line
regime: stationary
physical: {load: 220e3, radius: 0.0165, speed: 1.6, modulus: 219e9, viscosity: 0.024}
slide_roll: 1
lubricant:
  viscosity: {law: roelands, alpha: 1.65e-8, eta0: 0.024}
  density: {law: dowson-higginson}
  shear: {law: eyring, tau0: 1e7, in_film: true}
grid: {x_min: -6, x_max: 2, step: 0.02}
output: {resolution: false}
YAML
    while read -r stress slide film; do
        fullrun exact.yml -o exact.h5 --force --quiet --set lubricant.shear.tau0="$stress" --set slide_roll="$slide"
        close_to "$(number exact.h5 central_film_thickness)" "$film" 2e-4
    done <<'VALUES'
1e7 1 0.116946
3e6 0.05 0.116744
5e5 0.05 0.111489
5e5 2 0.069915
1e5 0.05 0.062594
1e5 1 0.039447
VALUES
    fullrun exact.yml -o exact.h5 --force --quiet --set lubricant.shear.in_film=false
    close_to "$(number exact.h5 central_film_thickness)" 0.116899 2e-4
}

# The rows of point contacts neglect the effect of the gradient across on the flow along, and vice versa.
# bats test_tags=slow
@test "points are told where the gradients affect each other" {
    sliding_scene point 'load: 60, radius: 0.0127, speed: 0.8' 0.3 \
        'x_min: -3, x_max: 1.5, step: 0.125, y_max: 2, half: true' >point.yml
    echo 'output: {resolution: false}' >>point.yml # the grid is coarse
    fullrun point.yml -o mild.h5 --quiet --set lubricant.shear.tau0=5e6
    run --separate-stderr fullrun point.yml -o strong.h5 --quiet --set lubricant.shear.tau0=5e5
    [ "$status" -eq 4 ]
    [[ $stderr == *"pressure gradients along and across affect each other"* ]]
    /usr/bin/python3 -c 'import h5py; assert list(h5py.File("strong.h5")["status"]) == [4]'
    # in time the contact is flagged too
    sed 's/stationary/transient/; /^output/d' point.yml >moving.yml
    echo 'transient: {end_time: 0.04, fixed_step: 0.02, load: {law: sine, amplitude: 0.1, period: 0.8}}' >>moving.yml
    fullrun moving.yml -o moving.h5 --quiet --set lubricant.shear.tau0=5e6
    run --separate-stderr fullrun moving.yml -o moving.h5 --quiet --force --set lubricant.shear.tau0=5e5
    [ "$status" -eq 4 ]
    # the stationary start is flagged already
    [[ $stderr == *"first at T = 0,"* ]]
    /usr/bin/python3 -c 'import h5py; assert h5py.File("moving.h5")["status"][0] == 4'
}

@test "outside of the trained thinning is told" {
    # told REASON MODEL OPTION...: checks that romrun solves the scene and flags it with REASON
    told() {
        run --separate-stderr romrun line.yml --model "$2" -o out.h5 --force --quiet "${@:3}"
        [ "$status" -eq 4 ]
        [[ $stderr == *"$1"* ]]
    }
    told "a flow that is thinned less than any in training" plan.h5 --set lubricant.shear.in_film=false
    told "a flow that is thinned less than any in training" plan.h5 --set slide_roll=0
    told "a flow that is thinned less than any in training" plan.h5 --set slide_roll=0.05 --set lubricant.shear.tau0=1e7
    told "a flow that is thinned more than any in training" plan.h5 --set lubricant.shear.tau0=5e5
    told "a flow that is thinned more than any in training" newton.h5
    # at other loads of the training, the flow is thinned as much as here
    told "outside of the trained range of M, alpha p_H and thinning" plan.h5 --set physical.load=6.1e4 \
        --set physical.speed=0.98 --set slide_roll=0.08 --set lubricant.shear.tau0=3.3e6
    # a model of an earlier version has no thinning in its training
    patch plan.h5 "del f['state_thinning']"
    romrun --check bad.h5
    told "a flow that is thinned more than any in training" bad.h5
}

# bats test_tags=slow
@test "a large stress gives the Newtonian film" {
    romrun line.yml --model newton.h5 -o newton-film.h5 --quiet --set lubricant.shear.in_film=false
    # the result is trusted: so small a thinning changes no film
    romrun line.yml --model newton.h5 -o large.h5 --quiet --set lubricant.shear.tau0=1e12
    romrun line.yml --model plan.h5 -o stiff.h5 --quiet --set lubricant.shear.tau0=1e12 --allow-untrusted
    romrun line.yml --model plan.h5 -o rolled.h5 --quiet --set lubricant.shear.in_film=false --allow-untrusted
    # the tolerance is that of the iteration; test_reduced_solver.c checks more digits
    for name in central_film_thickness minimum_film_thickness; do
        close_to "$(number large.h5 $name)" "$(number newton-film.h5 $name)" 2e-5
        close_to "$(number stiff.h5 $name)" "$(number rolled.h5 $name)" 2e-5
    done
}

@test "flat files, parts and tables of cases have it too" {
    romrun --export plan.h5 -o plan.ehdrom
    # shellcheck disable=SC2086
    romrun line.yml --model plan.h5 -o red.h5 --quiet $unseen
    # shellcheck disable=SC2086
    romrun line.yml --model plan.ehdrom -o flat.h5 --quiet $unseen
    same_data flat.h5 red.h5
    printf 'slide_roll,lubricant.shear.tau0,lubricant.shear.in_film\n0.8,3.4e6,true\n0.8,2e6,true\n0.8,3.4e6,false\n' >cases.csv
    run romrun line.yml --model plan.ehdrom --cases cases.csv -o cases.h5 --quiet --set physical.load=1.07e5 \
        --set physical.speed=0.6
    [ "$status" -eq 4 ]
    /usr/bin/python3 - <<'PYTHON'
import h5py
cases, red = h5py.File("cases.h5"), h5py.File("red.h5")
assert list(cases["status"]) == [0, 4, 4], list(cases["status"])
assert cases["central_film_thickness"][0] == red["central_film_thickness"][0]
PYTHON
}

@test "results are training solutions with their thinning" {
    for stress in 3e6 4e6 6e6; do
        fullrun line.yml -o $stress.h5 --quiet --set lubricant.shear.tau0=$stress
    done
    podbuild 3e6.h5 4e6.h5 6e6.h5 -o few.h5
    /usr/bin/python3 - <<'PYTHON'
import h5py, numpy as np
found = h5py.File("few.h5")["state_thinning"][()]
assert np.allclose(found * [3, 4, 6], found[0] * 3, rtol=1e-12) and found[0] > 0, found
PYTHON
}

# bats test_tags=slow
@test "a region of sliding and stress trains to its corners" {
    cat >region.yml <<'YAML'
groups:
  - scene: line.yml
    region: {physical.load: [7e4, 1.1e5], physical.speed: [0.6, 0.8], slide_roll: [0.2, 0.9], lubricant.shear.tau0: [3e6, 8e6]}
    candidates: 100
YAML
    train region
    printf 'physical.load,physical.speed,slide_roll,lubricant.shear.tau0\n' >corners.csv
    for load in 7e4 1.1e5; do for speed in 0.6 0.8; do for slide in 0.2 0.9; do for stress in 3e6 8e6; do
        echo "$load,$speed,$slide,$stress" >>corners.csv
    done; done; done; done
    romrun line.yml --model region.h5 --cases corners.csv -o corners.csv.h5 --quiet
    echo "6.9e4,0.6,0.2,3e6" >>corners.csv
    run romrun line.yml --model region.h5 --cases corners.csv -o corners.csv.h5 --quiet --force
    [ "$status" -eq 4 ]
}

# bats test_tags=slow
@test "in time" {
    sed -i 's/stationary/transient/; s/tau0: 5e6/tau0: 3.7e6/; s/slide_roll: 0.4/slide_roll: 1/' line.yml
    echo 'transient: {end_time: 1, fixed_step: 0.02, load: {law: sine, amplitude: 0.1, period: 0.8}}' >>line.yml
    cat >moving.yml <<'YAML'
groups:
  - scene: line.yml
    vary: {transient.load.period: [0.7, 1.0], lubricant.shear.tau0: [3e6, 4e6, 5e6]}
YAML
    train moving --energy 1e-12
    fullrun line.yml -o full.h5 --quiet
    romrun line.yml --model moving.h5 -o red.h5 --quiet --against full.h5
    /usr/bin/python3 - <<'PYTHON'
import h5py, numpy as np
red, full = h5py.File("red.h5"), h5py.File("full.h5")
for name, most in (("central_film_thickness", 1e-3), ("minimum_film_thickness", 1e-2), ("friction_force", 1e-3)):
    off = np.abs(red[name][()] / full[name][()] - 1).max()
    assert off < most, (name, off)
PYTHON
    run romrun line.yml --model moving.h5 -o out.h5 --quiet --set lubricant.shear.tau0=2.5e6
    [ "$status" -eq 4 ]
    run romrun line.yml --model moving.h5 -o out.h5 --quiet --force --set lubricant.shear.tau0=8e6
    [ "$status" -eq 4 ]
}

# bats test_tags=slow
@test "point contacts" {
    sliding_scene point 'load: 60, radius: 0.0127, speed: 0.8' 1 \
        'x_min: -3, x_max: 1.5, step: 0.125, y_max: 2, half: true' >point.yml
    echo 'output: {resolution: false}' >>point.yml # the grid is coarse
    cat >points.yml <<'YAML'
groups:
  - scene: point.yml
    vary: {physical.load: [45, 60, 80], physical.speed: [0.6, 0.9], slide_roll: [0.3, 1], lubricant.shear.tau0: [3e6, 1e7]}
YAML
    train points
    options="--set physical.load=70 --set physical.speed=0.7 --set slide_roll=0.9 --set lubricant.shear.tau0=4e6"
    # shellcheck disable=SC2086
    fullrun point.yml -o full.h5 --quiet $options
    # shellcheck disable=SC2086
    romrun point.yml --model points.h5 -o red.h5 --quiet $options
    close_to "$(number red.h5 central_film_thickness)" "$(number full.h5 central_film_thickness)" 5e-4
    close_to "$(number red.h5 friction_coefficient)" "$(number full.h5 friction_coefficient)" 5e-4
    # shellcheck disable=SC2086
    run romrun point.yml --model points.h5 -o red.h5 --quiet --force $options --set lubricant.shear.in_film=false
    [ "$status" -eq 4 ]
}
