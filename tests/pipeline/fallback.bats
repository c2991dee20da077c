#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests of romrun --fallback full: the full model solves scenes that the reduced model does not solve well enough.

load common

setup_file() {
    cd "$BATS_FILE_TMPDIR" || return
    small_model
    echo "output: {fields: true}" >>scene.yml
    # tm.h5 is trained in time, under loads of +-10 %
    moving_scene "x_min: -4, x_max: 2, step: 0.05" "end_time: 1, fixed_step: 0.01"
    time_plan train "0.5, 1" 0.1
    model_in_time 40
}

setup() {
    cd "$BATS_TEST_TMPDIR" || return
    cp "$BATS_FILE_TMPDIR"/* .
}

# same_contact A B: checks that scalars, pressure and film are equal within Newton's tolerance
same_contact() {
    /usr/bin/python3 - "$1" "$2" <<'PYTHON'
import sys, h5py, numpy
with h5py.File(sys.argv[1]) as a, h5py.File(sys.argv[2]) as b:
    for name in ("central_film_thickness", "minimum_film_thickness", "central_pressure",
                 "rigid_approach", "exit_position", "load", "pressure", "film_thickness"):
        assert numpy.abs(a[name][...] - b[name][...]).max() < 1e-7, name
PYTHON
}

# bats test_tags=slow
@test "a good reduced result stays, and says whose it is" {
    romrun scene.yml --model c.h5 -o plain.h5
    run --separate-stderr romrun scene.yml --model c.h5 --fallback full -o x.h5
    [ "$status" -eq 0 ]
    [ -z "$stderr" ]
    [[ $output != *"solved by"* ]]
    [ "$(number x.h5 by_full_model)" = 0.0 ]
    [ "$(number x.h5 central_film_thickness)" = "$(number plain.h5 central_film_thickness)" ]
    romrun scene.yml --model c.h5 --fallback none -o none.h5
    same_data none.h5 plain.h5
    shows_no by_full_model h5dump -H plain.h5
}

# bats test_tags=slow
@test "outside of the training the full model solves, from the reduced solution" {
    set=(--set moes.M=18 --set moes.L=7)
    fullrun scene.yml "${set[@]}" -o full.h5 --quiet
    run --separate-stderr romrun scene.yml "${set[@]}" --model c.h5 -o flagged.h5
    [ "$status" -eq 4 ]
    run --separate-stderr romrun scene.yml "${set[@]}" --model c.h5 --fallback full -o x.h5 \
        --against full.h5 --verify --repeat 3
    [ "$status" -eq 0 ]
    [[ $stderr =~ ^"romrun: --fallback full: found outside of the trained range of M and alpha p_H: solved by the full model, from the reduced solution, "[0-9]+" iterations, "[0-9.]+" ms"$ ]]
    [ "${#stderr_lines[@]}" -eq 1 ]
    [[ $output =~ "solved by               the full model, from the reduced solution, in "[0-9.]+" ms of these" ]]
    # the error estimates of inlet and step are those of the full model; the deviation of the reduced model is 0
    [ "$(grep -c "^  estimated error       model 0 %, grid " <<<"$output")" -eq 2 ]
    [[ $output =~ "central film thickness "[^$'\n']*" against "[^$'\n']*[+-]"0.0000 permille" ]]
    [[ $output == *"full residual"* ]]
    same_contact x.h5 full.h5
    [ "$(number x.h5 by_full_model)" = 1.0 ]
    [ "$(number x.h5 status)" = 0.0 ]
    [ "$(number x.h5 indicated_deviation)" = 0.0 ]
    [ "$(number x.h5 indicated_deviation_minimum)" = 0.0 ]
    close_to "$(number x.h5 step_effect)" "$(number full.h5 step_effect)" 1e-5
    [[ $(h5dump -a settings x.h5) == *"rows (0: all), fallback full"* ]]
    romrun --check x.h5
    # the stored time is the sum of the times of both models
    awk -v whole="$(number x.h5 solve_seconds)" -v full="$(sed -n 's/^solved by .* in \(.*\) ms of these$/\1/p' <<<"$output")" \
        'BEGIN { exit !(whole > full / 1000 && full > 0) }'
}

@test "where the reduced model does not converge the full one starts cold" {
    /usr/bin/python3 - <<'PYTHON'
import h5py
with h5py.File("m.h5", "r+") as f:
    f.attrs.pop('content_sha256', None)
    f["needed_coupled_basis"][...] *= 100
PYTHON
    run --separate-stderr romrun scene.yml --model m.h5
    [ "$status" -eq 3 ]
    fullrun scene.yml -o full.h5 --quiet
    run --separate-stderr romrun scene.yml --model m.h5 --fallback full -o x.h5
    [ "$status" -eq 0 ]
    [[ $stderr =~ ^"romrun: --fallback full: found ".*": solved by the full model, cold, "[0-9]+" iterations, " ]]
    same_contact x.h5 full.h5
    [ "$(number x.h5 by_full_model)" = 1.0 ]
}

@test "where more is indicated than --accuracy, or than holds without" {
    /usr/bin/python3 - <<'PYTHON'
import h5py
with h5py.File("c.h5", "r+") as f:
    f.attrs.pop('content_sha256', None)
    f["indicator_factor_minimum"][...] *= 1e9
PYTHON
    fullrun scene.yml -o full.h5 --quiet
    run --separate-stderr romrun scene.yml --model c.h5 --fallback full -o x.h5
    [ "$status" -eq 0 ]
    [[ $stderr == "romrun: --fallback full: found an indicated deviation of "*" of the minimum film, more than holds without --accuracy, 0.01: solved by the full model, "* ]]
    same_contact x.h5 full.h5
    run --separate-stderr romrun scene.yml --model c.h5 --fallback full --accuracy 0.1 -o y.h5
    [ "$status" -eq 0 ]
    [[ $stderr == *"more than the --accuracy of 0.1: solved by the full model, "* ]]
    same_contact y.h5 full.h5
}

# bats test_tags=slow
@test "an accuracy that no size has, and a model that was never calibrated" {
    fullrun scene.yml -o full.h5 --quiet
    refuse 65 "--accuracy: found 1e-12, expected at least" romrun scene.yml --model c.h5 --accuracy 1e-12 -o x.h5
    run --separate-stderr romrun scene.yml --model c.h5 --accuracy 1e-12 --fallback full -o x.h5
    [ "$status" -eq 0 ]
    [[ ${stderr_lines[0]} == "romrun: --accuracy: found 1e-12, expected at least "*"; --fallback full goes on" ]]
    [[ ${stderr_lines[1]} == "romrun: --fallback full: found an indicated deviation of "* ]]
    [ "${#stderr_lines[@]}" -eq 2 ]
    same_contact x.h5 full.h5
    run --separate-stderr romrun scene.yml --model m.h5 --accuracy 1e-2 --fallback full -o y.h5
    [ "$status" -eq 0 ]
    [[ ${stderr_lines[1]} == "romrun: --fallback full: found a model never checked at these sizes, "*": solved by the full model, from the reduced solution, "* ]]
    same_contact y.h5 full.h5
    # no size guarantees this accuracy for all scenes, but a size may reach it for one scene
    least=$(awk -v least="$(romrun scene.yml --model c.h5 --accuracy 1e-12 2>&1 | sed 's/.*expected at least \([^,]*\),.*/\1/')" \
        'BEGIN { print least * 0.9 }')
    run --separate-stderr romrun scene.yml --model c.h5 --accuracy "$least" --fallback full -o z.h5
    [ "$status" -eq 0 ]
    [ "$(number z.h5 by_full_model)" = 0.0 ] || [[ $stderr == *"solved by the full model"* ]]
}

@test "a scene that the full model does not solve either exits with 3" {
    run --separate-stderr romrun scene.yml --model c.h5 --fallback full --set moes.M=1e4 --set moes.L=25 -o x.h5
    [ "$status" -eq 3 ]
    [[ ${stderr_lines[-1]} == "romrun: scene.yml: found "*", expected convergence" ]]
    [ "$(number x.h5 by_full_model)" = 1.0 ]
    [ "$(number x.h5 status)" = 1.0 ]
}

@test "in time a good run has no step of the full model" {
    romrun moving.yml --model tm.h5 -o plain.h5 --quiet
    run --separate-stderr romrun moving.yml --model tm.h5 --fallback full -o x.h5 --quiet
    [ "$status" -eq 0 ]
    [ -z "$stderr" ]
    [[ $output =~ "solved by               0 steps by the full model, 0 s; "[0-9]+" by the reduced one, " ]]
    /usr/bin/python3 - <<'PYTHON'
import h5py
with h5py.File("x.h5") as x, h5py.File("plain.h5") as plain:
    assert set(x) == set(plain) | {"by_full_model"}
    assert (x["central_film_thickness"][...] == plain["central_film_thickness"][...]).all()
    assert (x["by_full_model"][...] == 0).all() and x.attrs["full_steps"] == 0
PYTHON
}

@test "in time steps outside of the training are the full model's, and then the reduced one's again" {
    # the load leaves the trained range and returns
    printf 'time,load\n0,1\n0.2,1\n0.5,1.2\n0.8,1\n1.7,1\n' >table.csv
    set=(--set transient.load.law=table --set transient.load.amplitude= --set transient.load.period=
        --set transient.load.file=table.csv --set transient.load.column=load --set transient.load.interpolation=linear
        --set transient.end_time=1.7 --set output.fields=true)
    fullrun moving.yml --grid-of tm.h5 "${set[@]}" -o full.h5 --quiet
    run --separate-stderr romrun moving.yml --model tm.h5 "${set[@]}" -o flagged.h5 --quiet
    [ "$status" -eq 4 ]
    run --separate-stderr romrun moving.yml --model tm.h5 "${set[@]}" --fallback full -o x.h5 --against full.h5
    [ "$status" -eq 0 ]
    [[ ${stderr_lines[-1]} =~ ^"romrun: --fallback full: found outside of the trained range of M and alpha p_H, first at T = 0."[0-9]+": "[0-9]+" of "[0-9]+" steps by the full model, "[0-9.e-]+" s"$ ]]
    [[ $output == *"central film thickness   at most "* ]]
    /usr/bin/python3 - <<'PYTHON'
import h5py, numpy, re
with h5py.File("x.h5") as x, h5py.File("full.h5") as full:
    by, time = x["by_full_model"][...], x["time"][...]
    assert set(by) == {0, 1} and by[0] == 0 and (by[(time > 0.8) & (time < 1.6)] == 0).all()
    assert by[abs(time - 0.5).argmin()] == 1
    assert x.attrs["full_steps"] == by.sum() and x.attrs["full_seconds"] > 0
    assert x.attrs["solve_seconds"] > x.attrs["full_seconds"]
    assert (x["status"][...] == 0).all()
    for name, most in (("central_film_thickness", 2e-3), ("minimum_film_thickness", 5e-3), ("load", 1e-4)):
        there = numpy.interp(time, full["time"][...], full[name][...])
        off = abs(x[name][...] / there - 1).max()
        print(name, off)
        assert off < most, (name, off)
    # fields at a time come from the model that solved it
    k = by.argmax()
    centre = x["film_thickness"][k, 80] * x["contact_half_width"][k] ** 2
    assert abs(centre / x["central_film_thickness"][k] - 1) < 1e-6, centre
PYTHON
    romrun --check x.h5
    [[ $(h5dump -a settings x.h5) == *"rows (0: all), fallback full"* ]]
}

# bats test_tags=slow
@test "in time all steps are the full model's where the reduced one was never checked, or is nowhere as accurate" {
    deimselect tr.h5 --basis tb.h5 -o nm.h5 --no-check
    fullrun moving.yml --grid-of tm.h5 -o full.h5 --quiet
    run --separate-stderr romrun moving.yml --model nm.h5 -o flagged.h5 --quiet
    [ "$status" -eq 4 ]
    run --separate-stderr romrun moving.yml --model nm.h5 --fallback full -o x.h5
    [ "$status" -eq 0 ]
    [[ $stderr == *"--fallback full: found a model without a successful check in time at these sizes, "*", first at T = 0: "* ]]
    run --separate-stderr romrun moving.yml --model tm.h5 --fallback full --accuracy 1e-9 -o y.h5
    [ "$status" -eq 0 ]
    [[ $stderr == *"--fallback full: found a film indicated to deviate by more than a tenth of the accuracy, first at T = 0: "* ]]
    /usr/bin/python3 - <<'PYTHON'
import h5py
with h5py.File("full.h5") as full:
    for name in "x.h5", "y.h5":
        with h5py.File(name) as x:
            assert (x["by_full_model"][...] == 1).all() and (x["status"][...] == 0).all(), name
            assert abs(x["central_film_thickness"][...] / full["central_film_thickness"][...] - 1).max() < 1e-8
PYTHON
}

@test "in time a start outside of the training" {
    run --separate-stderr romrun moving.yml --model tm.h5 --set moes.M=18 -o flagged.h5 --quiet
    [ "$status" -eq 4 ]
    run --separate-stderr romrun moving.yml --model tm.h5 --set moes.M=18 --set transient.end_time=0.2 \
        --fallback full -o x.h5
    [ "$status" -eq 0 ]
    [[ $stderr == *"first at T = 0: "* ]]
    fullrun moving.yml --grid-of tm.h5 --set moes.M=18 --set transient.end_time=0.2 -o full.h5 --quiet
    /usr/bin/python3 - <<'PYTHON'
import h5py
with h5py.File("x.h5") as x, h5py.File("full.h5") as full:
    assert (x["by_full_model"][...] == 1).all()
    off = abs(x["central_film_thickness"][...] / full["central_film_thickness"][...] - 1).max()
    assert off < 1e-8, off
PYTHON
}

# bats test_tags=slow
@test "in time a run can be stopped and resumed: the same numbers" {
    set=(--set transient.load.amplitude=0.2 --set transient.load.period=2 --set transient.end_time=60)
    romrun moving.yml --model tm.h5 "${set[@]}" --fallback full -o whole.h5 --quiet >log
    [ "$(number whole.h5 full_steps)" != 0.0 ]
    stop_when INT "len(time) > 1000" x.h5 romrun moving.yml --model tm.h5 "${set[@]}" --fallback full -o x.h5 --quiet
    [ "$code" -eq 130 ]
    # a run without --fallback does not continue this file
    refused 65 "x.h5.partial" romrun moving.yml --model tm.h5 "${set[@]}" -o x.h5 --resume
    romrun moving.yml --model tm.h5 "${set[@]}" --fallback full -o x.h5 --resume --quiet >resumed.txt
    same_data whole.h5 x.h5
    [ "$(number x.h5 full_steps)" = "$(number whole.h5 full_steps)" ]
    diff <(grep -v "solution\|solved" log) <(grep -v "solution\|solved" resumed.txt)
}

@test "usage" {
    refused 64 "--fallback: found half, expected full or none" romrun scene.yml --model c.h5 --fallback half
    refused 64 "--fallback: found full with --allow-untrusted, expected one of them" \
        romrun scene.yml --model c.h5 --fallback full --allow-untrusted
    refused 64 "--fallback: found with romrun trade, expected with" romrun --trade --model c.h5 --fallback full
}
