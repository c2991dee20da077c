#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests of the check that deimselect makes of a new model, and of romrun with models that were never checked.

load common

# Makes residuals of 15 points with 121 nodes, their model m.h5, and n.h5 without a check.
setup_file() {
    cd "$BATS_FILE_TMPDIR" || return
    common_setup_small
    sed 's/\[8, 11, 15\]/[8, 9.5, 11, 13, 15]/' plan.yml >train.yml
    snapgen train.yml -o s.h5 --quiet
    podbuild s.h5 -o b.h5 --pressure-modes 12
    snapgen train.yml --basis b.h5 -o r.h5 --quiet
    deimselect r.h5 --basis b.h5 -o m.h5 --quiet >log
    deimselect r.h5 --basis b.h5 -o n.h5 --no-check >no-check.log
}

setup() {
    cd "$BATS_TEST_TMPDIR" || return
    cp "$BATS_FILE_TMPDIR"/* .
}

unchecked="a model never checked at these sizes, which romrun calibrate does, and deimselect without --no-check"
advice="(--fallback full has the full model solve it, --allow-untrusted takes it all the same)"

# bats test_tags=slow
@test "a model is checked on scenes between its training's, as romrun --calibrate does" {
    [[ $(tail -n 1 log) == "checked on 10 scenes between the training points: central film at most "*" % off, minimum film "*" %" ]]
    [ "$(head -n 3 log)" = "$(cat no-check.log)" ]
    [ ! -e m.h5.partial ]
    [ ! -e m.h5.unchecked ]
    deimselect --check m.h5
    # the settings of m.h5 name the scenes; a calibration on these scenes gives the same table
    /usr/bin/python3 - <<'PYTHON'
import h5py, re
with h5py.File("m.h5") as m, h5py.File("b.h5") as b:
    text = m.attrs["settings"].decode().split("# calibrated on\n")[1]
    trained = set(zip(b["state_moes_M"][...].round(6), b["state_alpha_p_H"][...].round(6)))
    points, here = [], {}
    for line in text.splitlines():
        if line.startswith("# point") and here: points.append(dict(here))
        if line.startswith("moes."): here[line[:6]] = line[8:]
    points.append(here)
assert len(points) == 10, points
open("points.csv", "w").write("moes.M,moes.L\n" + "".join("%s,%s\n" % (p["moes.M"], p["moes.L"]) for p in points))
open("again.yml", "w").write("groups:\n  - {scene: base.yml, points: points.csv}\n")
PYTHON
    romrun --calibrate again.yml --model n.h5 -o again.h5 --quiet
    same_data m.h5 again.h5
    # a scene inside the trained range has a result with an indicated deviation
    romrun scene.yml --model m.h5 -o red.h5 --quiet
    [ "$(number red.h5 status)" = 0.0 ]
    fullrun scene.yml -o full.h5
    awk -v i="$(number red.h5 indicated_deviation)" -v f="$(number full.h5 central_film_thickness)" \
        -v r="$(number red.h5 central_film_thickness)" \
        'BEGIN { d = r / f - 1; d = d < 0 ? -d : d; exit !(i > d && i < 0.01) }'
}

# bats test_tags=slow
@test "the check does not depend on --jobs, and a second model has the same bits but for the times" {
    deimselect r.h5 --basis b.h5 -o one.h5 --jobs 1 --quiet
    deimselect r.h5 --basis b.h5 -o two.h5 --jobs 3 --quiet
    same_data m.h5 one.h5
    same_data m.h5 two.h5
}

@test "a model that was never checked says so, with exit code 4" {
    run --separate-stderr romrun scene.yml --model n.h5 -o x.h5
    [ "$status" -eq 4 ]
    [ "$stderr" = "romrun: scene.yml: found $unchecked, expected a result to be trusted $advice" ]
    [[ $output == *"central film thickness"* ]]
    [ "$(number x.h5 status)" = 4.0 ]
    run --separate-stderr romrun scene.yml --model n.h5 -o y.h5 --allow-untrusted
    [ "$status" -eq 0 ]
    [ "$stderr" = "romrun: n.h5: found $unchecked" ]
    # this size of a checked model was not measured
    romrun scene.yml --model m.h5 --pressure-modes 10 --rows 15 --quiet
    run --separate-stderr romrun scene.yml --model m.h5 --rows 23
    [ "$status" -eq 4 ]
    [[ $stderr == *"found $unchecked, "* ]]
    # outside of the trained range the message gives that reason instead
    run --separate-stderr romrun scene.yml --model n.h5 --set moes.M=16
    [ "$status" -eq 4 ]
    [[ $stderr == *"found outside of the trained range"* ]]
}

# bats test_tags=slow
@test "residuals without a plan give a model that is not checked" {
    /usr/bin/python3 -c "
import h5py
with h5py.File('r.h5', 'r+') as f: del f.attrs['settings']"
    run --separate-stderr deimselect r.h5 --basis b.h5 -o x.h5
    [ "$status" -eq 4 ]
    [ "$stderr" = "deimselect: x.h5: written, but not checked: r.h5: found no points, expected those of a plan; romrun calibrate checks it on a plan (--no-check: without a check)" ]
    [ "$output" = "$(cat no-check.log)" ]
    deimselect --check x.h5
    same_data x.h5 n.h5
    run -4 romrun scene.yml --model x.h5
    deimselect r.h5 --basis b.h5 -o y.h5 --no-check
    /usr/bin/python3 -c 'import h5py; assert "null" not in str(h5py.File("x.h5").attrs["settings"])'
    # residuals of another grid or of a single point give a model that is not checked
    cp "$BATS_FILE_TMPDIR"/r.h5 .
    /usr/bin/python3 -c "
import h5py, re
with h5py.File('r.h5', 'r+') as f: f.attrs['settings'] = f.attrs['settings'].decode().replace('grid.step: 0.05', 'grid.step: 0.1')"
    run --separate-stderr deimselect r.h5 --basis b.h5 -o x.h5 --force
    [ "$status" -eq 4 ]
    [[ $stderr == "deimselect: x.h5: written, but not checked: r.h5: "*" found 61 nodes from -4 by 0.1, expected 121 "* ]]
    snapgen scene.yml -o s1.h5 --quiet
    podbuild s1.h5 -o b1.h5
    snapgen scene.yml --basis b1.h5 -o r1.h5 --quiet
    run --separate-stderr deimselect r1.h5 --basis b1.h5 -o x.h5 --force
    [ "$status" -eq 4 ]
    [[ $stderr == *"r1.h5: found no scene of the trained range half-way between two training points"* ]]
    # residuals of trajectories whose table is gone give a model that is not checked
    printf 'T,F\n0,1\n0.5,1.1\n1,1\n' >t.csv
    sed 's/stationary/transient/' scene.yml >moving.yml
    echo 'transient: {end_time: 0.2, load: {law: table, file: t.csv, column: F}}' >>moving.yml
    snapgen moving.yml -o s2.h5 --quiet
    podbuild s2.h5 -o b2.h5
    snapgen moving.yml --basis b2.h5 -o r2.h5 --quiet
    rm t.csv
    run --separate-stderr deimselect r2.h5 --basis b2.h5 -o x.h5 --force
    [ "$status" -eq 4 ]
    [[ $stderr == "deimselect: x.h5: written, but not checked: "*"t.csv"* ]]
    deimselect --check x.h5
}

@test "a training that is too thin is told of, and where" {
    sed 's/\[8, 11, 15\]/[8, 60]/; s/\[2, 4, 6\]/[0.5, 12]/' plan.yml >thin.yml
    snapgen thin.yml -o ts.h5 --quiet
    podbuild ts.h5 -o tb.h5
    snapgen thin.yml --basis tb.h5 -o tr.h5 --quiet
    run --separate-stderr deimselect tr.h5 --basis tb.h5 -o t.h5 --quiet
    [ "$status" -eq 0 ]
    [[ $stderr == "deimselect: t.h5: found films off by more than 1 % or no solution between training points, expected less: the training is too thin, add points around M="*" L="* ]]
}

@test "every lubricant of the training is among the check scenes" {
    cat >two.yml <<'YAML'
groups:
  - scene: base.yml
    vary: {moes.M: [8, 9.5, 11, 13, 15], moes.L: [2, 4, 6]}
  - scene: base.yml
    vary: {lubricant.viscosity.alpha: [1.5e-8], moes.M: [9, 12], moes.L: [3, 5]}
YAML
    snapgen two.yml -o s2.h5 --quiet
    podbuild s2.h5 -o b2.h5
    snapgen two.yml --basis b2.h5 -o r2.h5 --quiet
    deimselect r2.h5 --basis b2.h5 -o x.h5 --quiet
    [ "$(romrun --print x.h5 calibration_scenes | tail -n 1)" -eq 10 ]
    text=$(h5dump -a settings x.h5)
    [[ $text == *"alpha: 1.5e-08"* && $text == *"alpha: 2e-08"* ]]
}

@test "nothing is written before the check is done" {
    deimselect r.h5 --basis b.h5 -o x.h5 --quiet
    refused 73 "x.h5" deimselect r.h5 --basis b.h5 -o x.h5
    rm x.h5
    # the sizes are measured within milliseconds, which a busy machine may miss
    for _ in {1..20}; do
        rm -f x.h5
        stop_when INT exists x.h5 deimselect r.h5 --basis b.h5 -o x.h5 >log 2>&1
        [ "$code" -ne 130 ] || break
    done
    [ "$code" -eq 130 ]
    [ ! -e x.h5 ]
    [ ! -e x.h5.partial ]
    [ ! -e x.h5.unchecked ]
    grep "^deimselect: x.h5.*interrupted" log
}

@test "in time: one trajectory is checked with half its swing, and a model without a check in time is flagged" {
    sed 's/stationary/transient/' scene.yml >moving.yml
    cat >>moving.yml <<'YAML'
transient: {end_time: 1, load: {law: sine, amplitude: 0.1, period: 1}}
YAML
    snapgen moving.yml -o s1.h5 --quiet
    podbuild s1.h5 -o b1.h5
    snapgen moving.yml --basis b1.h5 -o r1.h5 --quiet
    run --separate-stderr deimselect r1.h5 --basis b1.h5 -o x.h5 --quiet
    [ "$status" -eq 0 ]
    [ -z "$stderr" ]
    [[ ${lines[-1]} == "checked on 1 trajectory between those of the training: central film at most "*" % off, minimum film "*" %" ]]
    [[ $(h5dump -a settings x.h5) == *"transient.load.amplitude: 0.05"* ]]
    # the reason is the indicated deviation of the minimum film, 13 %, and not a missing check in time
    run --separate-stderr romrun moving.yml --model x.h5 -o one.h5 --quiet --set transient.load.amplitude=0.07
    [[ $status -eq 4 && $stderr == "romrun: moving.yml: found an indicated deviation of "*" of the minimum film, more than 0.01, "* ]]
    # the model was not checked on stationary scenes
    run -4 --separate-stderr romrun scene.yml --model x.h5
    # the model without a check was not checked in time
    deimselect r1.h5 --basis b1.h5 -o y.h5 --no-check
    run --separate-stderr romrun moving.yml --model y.h5 -o two.h5 --quiet
    [ "$status" -eq 4 ]
    [[ $stderr == "romrun: moving.yml: found a model without a successful check in time at these sizes, which romrun calibrate does with a transient plan, and deimselect of a transient training without --no-check, first at T = 0, expected a result to be trusted $advice" ]]
    /usr/bin/python3 -c "
import h5py
with h5py.File('two.h5') as f: assert (f['status'][...] == 4).all()"
    romrun moving.yml --model y.h5 -o two.h5 --quiet --force --allow-untrusted
}

@test "a model that solves no trajectory of its check is written with exit code 4" {
    # whether two modes solve a fast history depends on rounding, so several are tried
    local unsolved=0
    for amplitude in 0.4 0.45 0.5 0.55 0.6; do
        for period in 0.15 0.2 0.25; do
            moving_scene 'x_min: -4, x_max: 2, step: 0.05' 'end_time: 0.5'
            sed -i "s/amplitude: 0.1, period: 1/amplitude: $amplitude, period: $period/" moving.yml
            snapgen moving.yml -o s1.h5 --quiet --force
            podbuild s1.h5 -o b1.h5 --pressure-modes 2 --force
            snapgen moving.yml --basis b1.h5 -o r1.h5 --quiet --force
            run --separate-stderr deimselect r1.h5 --basis b1.h5 -o x.h5 --quiet --force
            if [ "${lines[-1]}" = "checked on 1 trajectory between those of the training: 1 not solved" ]; then
                [ "$status" -eq 4 ]
                [ "$stderr" = "deimselect: x.h5: written, but the model solved no trajectory of its check: train it with more points or modes" ]
                unsolved=1
                break 2
            fi
            [ "$status" -eq 0 ]
        done
    done
    [ "$unsolved" -eq 1 ]
    run --separate-stderr -4 romrun moving.yml --model x.h5 --quiet
    [[ $stderr == *"a model without a successful check in time"* ]]
}
