#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later

load common

# Writes a scene with 121 nodes over one period of the load, and a plan with points and trajectories around it.
setup() {
    cd "$BATS_TEST_TMPDIR" || return
    base_scene 'step: 0.05'
    (sed 's/stationary/transient/' base.yml && cat <<'YAML') >scene.yml
moes: {M: 14, L: 4}
transient:
  load: {law: sine, amplitude: 0.1, period: 1}
  end_time: 1
  fixed_step: 0.02
YAML
    cat >plan.yml <<'YAML'
groups:
  - scene: base.yml
    vary: {moes.M: [11, 14, 17], moes.L: [3, 4, 5]}
  - scene: scene.yml
    vary: {transient.load.period: [0.7, 1.4]}
YAML
}

# ---- solutions

@test "runs a scene in time and prints the answer" {
    run --separate-stderr fullrun scene.yml -o result.h5 --quiet
    [ "$status" -eq 0 ]
    [ -z "$stderr" ]
    [[ $output == *"T = 0 to 1 in 54 steps"* ]]
    [ ! -e result.h5.partial ]
    fullrun --check result.h5
    # the start is the stationary solution, except that the exit of a transient solution is at a node
    (cat base.yml && echo 'moes: {M: 14, L: 4}') >still.yml
    fullrun still.yml -o still.h5
    close_to "$(number result.h5 central_film_thickness)" \
        "$(number still.h5 central_film_thickness)" 1e-5
    /usr/bin/python3 - <<'PYTHON'
import h5py, numpy
with h5py.File("result.h5") as file:
    time, load = file["time"][...], file["load"][...]
    # the first steps grow to the fixed step
    assert numpy.allclose(time[:5], numpy.cumsum([0, 0.0025, 0.005, 0.00625, 0.00625]), rtol=1e-12)
    numpy.testing.assert_allclose(time[7:], 0.02 * numpy.arange(3, 51), rtol=1e-12)
    assert abs(file["time_effect"][...]).max() < 3e-3 and file["time_effect"][0] == 0
    numpy.testing.assert_allclose(load, 1 + 0.1 * numpy.sin(2 * numpy.pi * time), rtol=1e-8)
    numpy.testing.assert_allclose(file["contact_half_width"][...], load ** 0.5, rtol=1e-8)
    # the fields have the units of the current frame, the scalars those of the reference
    numpy.testing.assert_allclose(file["pressure"][...].sum(axis=1) * 0.05, numpy.pi / 2, rtol=1e-8)
    centre = numpy.argmin(abs(file["x"][...]))
    numpy.testing.assert_allclose(file["film_thickness"][:, centre] * load,
                                  file["central_film_thickness"][...], rtol=1e-8)
    assert file.attrs["complete"] == 1 and (file["status"][...] == 0).all()
PYTHON
}

# bats test_tags=slow
@test "its file opens with h5py, xarray and ncdump" {
    fullrun scene.yml -o result.h5 --quiet --set output.fields_every=3
    run "$BATS_TEST_DIRNAME/open_elsewhere.py" result.h5
    echo "$output"
    [ "$status" -ne 2 ] || skip "a reader is not installed"
    [ "$status" -eq 0 ]
}

# scalars_equal A B: checks that times and scalars are the same to the last bit
scalars_equal() {
    /usr/bin/python3 - "$1" "$2" <<'PYTHON'
import sys, h5py
with h5py.File(sys.argv[1]) as left, h5py.File(sys.argv[2]) as right:
    for name in ["time", "central_film_thickness", "minimum_film_thickness", "rigid_approach",
                 "central_pressure", "load", "exit_position", "time_step"]:
        assert left[name][...].tobytes() == right[name][...].tobytes(), name
PYTHON
}

# bats test_tags=slow
@test "what is written changes nothing of the solution" {
    adaptive=(scene.yml --quiet --set transient.tolerance=1e-3)
    sed -i '/fixed_step/d' scene.yml
    fullrun "${adaptive[@]}" -o all.h5
    fullrun "${adaptive[@]}" -o some.h5 --set output.fields_every=7
    fullrun "${adaptive[@]}" -o none.h5 --set output.fields=false
    scalars_equal all.h5 some.h5
    scalars_equal all.h5 none.h5
    /usr/bin/python3 - <<'PYTHON'
import h5py, numpy
with h5py.File("all.h5") as every, h5py.File("some.h5") as some, h5py.File("none.h5") as none:
    assert "pressure" not in none
    kept = numpy.isfinite(some["pressure"][:, 0])
    assert (numpy.flatnonzero(kept) % 7 == 0).all() and kept.sum() == (len(kept) + 6) // 7
    assert (some["pressure"][...][kept] == every["pressure"][...][kept]).all()
    assert numpy.isfinite(every["pressure"][...]).all()
PYTHON
}

# leads_back SCENE PROGRAM...: runs the program under the scene's load, and then under the approach that results. Checks
# that the second run gives the load again.
leads_back() {
    "${@:2}" "$1" -o loaded.h5 --quiet --force --set approach_length=10
    /usr/bin/python3 - <<'PYTHON'
import h5py
with h5py.File("loaded.h5") as file, h5py.File("history.h5", "w") as history:
    history["time"] = file["time"][...]
    history["approach"] = file["rigid_approach"][...] / file["rigid_approach"][0]
PYTHON
    sed -e '/load:/d' -e 's/^transient:/closure: approach\ntransient:\
  approach: {law: table, file: history.h5, column: approach, interpolation: linear}/' \
        "$1" >approach.yml
    "${@:2}" approach.yml -o back.h5 --quiet --force
    /usr/bin/python3 - <<'PYTHON'
import h5py, numpy
with h5py.File("loaded.h5") as loaded, h5py.File("back.h5") as back:
    for name in ["time", "rigid_approach"]:
        numpy.testing.assert_allclose(back[name][...], loaded[name][...], rtol=1e-8)
    for name in ["load", "central_film_thickness"]:
        numpy.testing.assert_allclose(back[name][...], loaded[name][...], rtol=2e-4)
    assert numpy.ptp(loaded["load"][...]) > 0.1
PYTHON
}

@test "the approach that a load led to leads to that load" {
    leads_back scene.yml fullrun
}

# ---- bodies apart

# lose NAME SETTING HISTORY: solves a line contact whose HISTORY is the table NAME.csv into NAME.h5
lose() {
    local name=$1
    shift
    printf '%s\n' 'contact: line' 'regime: transient' 'moes: {M: 20, L: 5}' \
        'lubricant: {viscosity: {law: barus, alpha: 2e-8}}' 'grid: {x_min: -16, x_max: 4}' "$1" 'transient:' '  end_time: 9' \
        "  $2: {law: table, file: $name.csv, column: $2, interpolation: linear}" >"$name.yml"
    fullrun "$name.yml" -o "$name.h5" --quiet --allow-untrusted
    fullrun --check "$name.h5"
}

# bats test_tags=slow
@test "a load that falls to 0 does what one does that falls to 1e-4" {
    printf '%s\n' time,load 0,1 1,1 3,0 5,0 7,1 9,1 >none.csv
    sed 's/,0$/,0.0001/' none.csv >little.csv
    lose none 'closure: load' load
    lose little 'closure: load' load
    # a contact that begins on too short an inlet has too thin a film for some time
    run -4 fullrun none.yml -o short.h5 --quiet --set grid.x_min=-4
    /usr/bin/python3 - <<'PYTHON'
import h5py, numpy
thickness = lambda path: numpy.interp(5.2, *(h5py.File(path)[n] for n in ("time", "central_film_thickness")))
assert 0.4 < thickness("short.h5") / thickness("none.h5") < 0.6
with h5py.File("none.h5") as none, h5py.File("little.h5") as little:
    time, load, film, exits = (none[n][...] for n in
                               ("time", "load", "central_film_thickness", "exit_position"))
    apart = load == 0
    assert time[apart].min() == 3 and 5 <= time[apart].max() < 5.02
    assert numpy.isnan(film[apart]).all() and numpy.isnan(exits[apart]).all()
    assert (none["pressure"][apart] == 0).all()
    given = numpy.interp(time, [1, 3, 5, 7], [1, 0, 0, 1])
    numpy.testing.assert_allclose(load[~apart], given[~apart], rtol=1e-8)
    assert given[apart].max() < 0.01  # contacts with a smaller load are left out
    # soon after the bodies touch again, the entrained film is the same
    after = time > 5.8
    other = numpy.interp(time[after], little["time"], little["central_film_thickness"])
    assert abs(film[after] / other - 1).max() < 0.01
    assert numpy.isfinite(film[~apart]).all()
PYTHON
}

# bats test_tags=slow
@test "a load falls to 0 after long steps, and rises nearly at once" {
    printf '%s\n' time,load 0,1 2,1 3,0 5,0 5.00000001,1 9,1 >jump.csv
    lose jump 'closure: load' load
    /usr/bin/python3 - <<'PYTHON'
import h5py, numpy
with h5py.File("jump.h5") as file:
    time, load = file["time"][...], file["load"][...]
    assert ((time > 2) & (time < 3)).sum() > 20  # the fall is resolved
    assert len(time) < 3000  # steps are not as short as the time between two rows of the table
    assert not load[(time >= 3) & (time < 5)].any() and abs(load[-1] - 1) < 1e-6
PYTHON
}

# bats test_tags=slow
@test "bodies that part lose their load, and get it back where they touch" {
    printf '%s\n' time,approach 0,1 3,-0.3 4,-0.3 7,1 9,1 >apart.csv
    lose apart 'closure: approach' approach
    /usr/bin/python3 - <<'PYTHON'
import h5py, numpy
with h5py.File("apart.h5") as file:
    load, film, approach = (file[n][...] for n in ("load", "central_film_thickness", "rigid_approach"))
    apart = load == 0
    first, last = numpy.flatnonzero(apart)[[0, -1]]
    assert apart[first:last + 1].all()  # the bodies part only once
    assert load.min() == 0 and load[first - 1] < 0.01 and load[last + 1] < 0.05
    numpy.testing.assert_allclose(film[apart], approach[apart], rtol=1e-12)
    assert approach.max() > 0.5
    # in narrow gaps contacts may have more than 1 % of the load; the inlet is too short for loads up to 3 %
    assert (file["status"][((load == 0) & (approach > 0.2)) | (load > 0.03)] == 0).all()
    assert abs(load[-1] - 1) < 0.01 and abs(film[-1] / film[0] - 1) < 0.1
PYTHON
    sed 's/^closure.*/&\napproach: 100/' apart.yml >far.yml # this factor keeps the bodies apart
    fullrun far.yml -o far.h5 --quiet --set transient.end_time=1
    /usr/bin/python3 -c 'import h5py; assert not h5py.File("far.h5")["load"][...].any()'
}

# ---- training

# bats test_tags=slow
@test "points and trajectories of one plan are trained, reduced and run" {
    snapgen plan.yml -o s.h5 --jobs 1 --quiet >log
    grep -q "11 points, 11 converged" log
    snapgen plan.yml -o s2.h5 --jobs 2 --quiet
    same_data s.h5 s2.h5
    fullrun scene.yml -o full.h5 --quiet
    for kind in coupled independent; do
        podbuild s.h5 -o b.h5 --deformation $kind --force
        snapgen plan.yml --basis b.h5 -o r.h5 --jobs 1 --quiet --force
        snapgen plan.yml --basis b.h5 -o r2.h5 --jobs 2 --quiet --force
        same_data r.h5 r2.h5
        deimselect r.h5 --basis b.h5 -o m.h5 --force --quiet >log
        grep -q "^checked on 1 trajectory between those of the training: central film at most .* % off" log
        [ "$(romrun --print m.h5 calibration_trajectories | tail -n 1)" -eq 1 ]
        for file in s b r m; do
            fullrun --check $file.h5
        done
        # this period lies between the two of the training
        romrun scene.yml --model m.h5 -o red.h5 --against full.h5 --quiet --force >log
        grep -q "central film thickness *at most" log
        /usr/bin/python3 - <<'PYTHON'
import h5py, numpy
with h5py.File("red.h5") as reduced, h5py.File("full.h5") as full:
    assert (reduced["status"][...] == 0).all()
    for name, limit in [("time", 1e-12), ("load", 1e-5), ("central_film_thickness", 7e-5),
                        ("minimum_film_thickness", 7e-4), ("central_pressure", 3e-4)]:
        numpy.testing.assert_allclose(reduced[name][...], full[name][...], rtol=limit, err_msg=name)
PYTHON
    done
}

# A trajectory of another lubricant at the same place gives no start. When states had no lubricant, the iteration
# started between both lubricants: 42 iterations in place of 2 in the training of tests/bench/costs.sh.
# bats test_tags=slow
@test "points and trajectories of two lubricants in one training" {
    cat >mixed.yml <<'YAML'
groups:
  - scene: base.yml
    vary: {moes.M: [11, 14, 17], moes.L: [3, 4, 5]}
  - scene: scene.yml
    vary: {lubricant.density.law: [incompressible, dowson-higginson], transient.end_time: [0.1]}
YAML
    snapgen mixed.yml -o s.h5 --quiet
    podbuild s.h5 -o b.h5
    snapgen mixed.yml --basis b.h5 -o r.h5 --quiet
    deimselect --no-check r.h5 --basis b.h5 -o m.h5 --rows 50
    for law in incompressible dowson-higginson; do
        romrun base.yml --model m.h5 --set moes.M=14 --set moes.L=4 --set lubricant.density.law=$law --allow-untrusted \
            --quiet -o still.h5 --force
        iterations=$(number still.h5 newton_iterations)
        [ "${iterations%.0}" -le 3 ]
    done
    /usr/bin/python3 - <<'PYTHON'
import h5py, numpy
with h5py.File("m.h5") as model:
    rise = model["state_density_rise"][...]
    assert numpy.all(rise >= 0) and rise.min() == 0 and rise.max() > 0, rise
PYTHON
}

# bats test_tags=slow
@test "a model of trajectories alone, and outside of what it was made for" {
    cat >only.yml <<'YAML'
groups:
  - scene: scene.yml
    vary: {transient.load.period: [0.7, 1.4]}
YAML
    snapgen only.yml -o s.h5 --quiet
    podbuild s.h5 -o b.h5
    snapgen only.yml --basis b.h5 -o r.h5 --quiet
    deimselect --no-check r.h5 --basis b.h5 -o m.h5 --rows 50
    romrun --allow-untrusted scene.yml --model m.h5 -o good.h5 --quiet
    run --separate-stderr romrun scene.yml --model m.h5 -o far.h5 --quiet \
        --set transient.load.amplitude=0.4
    echo "$stderr"
    [ "$status" -eq 4 ] || [ "$status" -eq 3 ]
    [ "${#stderr_lines[@]}" -eq 1 ]
    [[ $stderr == "romrun: scene.yml: "*"T = "* ]]
    [[ $output == *"not to be trusted       first at T = "* || \
       $output == *"ended early             at T = "* ]]
    [ "$status" -eq 3 ] || /usr/bin/python3 - <<'PYTHON'
import h5py
with h5py.File("far.h5") as file:
    assert (file["status"][...] == 4).any() and file.attrs["complete"] == 1
PYTHON
}

# bats test_tags=slow
@test "steps of load and speed are solved by the projected system, with nearly all modes" {
    cat >steps.yml <<'YAML'
groups:
  - scene:
      contact: line
      regime: transient
      physical: {load: 250e3, radius: 0.0125, speed: 1.5, modulus: 230e9}
      lubricant: {viscosity: {law: roelands, eta0: 0.04, alpha: 1.8e-8}}
      grid: {step: 0.04}
      transient: {end_time: 1}
    histories: {load: [0.8, 1.2], speed: [0.7, 1.3], kinds: [step]}
YAML
    snapgen steps.yml -o s.h5 --quiet
    podbuild s.h5 -o b.h5 --energy 1e-18
    run --separate-stderr snapgen steps.yml --basis b.h5 -o r.h5 --quiet
    [[ $output == "7 points with the projected system, 7 converged"* && -z $stderr ]]
    # selects rows for all modes of the basis
    run --separate-stderr deimselect r.h5 --basis b.h5 -o m.h5 --quiet
    echo "$output"
    [ "$status" -eq 0 ]
    [[ $output =~ "central film at most "([0-9.e-]+)" % off, minimum film "([0-9.e-]+)" %" ]]
    awk -v central="${BASH_REMATCH[1]}" -v minimum="${BASH_REMATCH[2]}" 'BEGIN { exit !(central < 1e-5 && minimum < 1e-3) }'
}

# bats test_tags=slow
@test "shards of a mixed plan have all of it, once" {
    for k in 1 2 3; do
        snapgen plan.yml -o "s$k.h5" --shard "$k/3" --quiet
    done
    podbuild s1.h5 s2.h5 s3.h5 -o b.h5
    /usr/bin/python3 - <<'PYTHON'
import h5py
stationary, moving = 0, 0
for k in 1, 2, 3:
    with h5py.File(f"s{k}.h5") as file:
        of = file["trajectory"][...] if "trajectory" in file else [-1] * len(file["status"])
        stationary += sum(t < 0 for t in of)
        moving += len({t for t in of if t >= 0})
assert (stationary, moving) == (9, 2), (stationary, moving)
PYTHON
}

# bats test_tags=slow
@test "no shard is empty, also where points are fewer than shards" {
    cat >few.yml <<'YAML'
groups:
  - scene: base.yml
    vary: {moes.M: [11, 14], moes.L: [4]}
  - scene: scene.yml
    vary: {transient.end_time: [0.02, 0.04, 0.06]}
YAML
    for shards in 1 2 3 4 5; do
        for ((k = 1; k <= shards; k++)); do
            snapgen few.yml -o "f$k.h5" --shard "$k/$shards" --quiet --force
        done
        /usr/bin/python3 - "$shards" <<'PYTHON'
import sys, h5py
stationary, moving = [], []
for k in range(int(sys.argv[1])):
    with h5py.File(f"f{k + 1}.h5") as file:
        of = list(file["trajectory"][...]) if "trajectory" in file else [-1] * len(file["status"])
        stationary += [m for m, t in zip(file["moes_M"], of) if t < 0]
        times = file["trajectory_time"][...] if max(of) >= 0 else []
        moving += [max(s for s, u in zip(times, of) if u == t) for t in set(of) if t >= 0]
assert sorted(stationary) == [11, 14], stationary
assert [round(t, 10) for t in sorted(moving)] == [0.02, 0.04, 0.06], moving
PYTHON
    done
}

@test "a training of which nothing converges is exit 3, and an existing output stays" {
    cat >lost.yml <<'YAML'
groups:
  - scene: scene.yml
    vary: {moes.M: [5000]}
YAML
    none() { # NAME COMMAND...: checks the last line on stderr, and that the file is unchanged
        echo precious >none.h5
        run --separate-stderr "$@" -o none.h5 --force --quiet
        echo "$status $stderr"
        [ "$status" -eq 3 ]
        [ -z "$output" ]
        [ "${stderr_lines[-1]}" = "snapgen: lost.yml: found none of 1 points converged, expected at \
least one" ]
        [ "$(cat none.h5)" = precious ]
    }
    none snapgen lost.yml
    none snapgen lost.yml --allow-failures 10
    # solves the projected system of a basis of other contacts
    snapgen plan.yml -o s.h5 --quiet
    podbuild s.h5 -o b.h5
    none snapgen lost.yml --basis b.h5
    [ ! -e none.h5.partial ]
    sed -i 's/scene.yml/base.yml/; s/5000]/5000], moes.L: [1]/' lost.yml
    none snapgen lost.yml --basis b.h5
}

# ---- bad histories

# bad_history PATTERN SETTING...: checks that the scene is refused before any work
bad_history() {
    local pattern=$1 arguments=() setting
    shift
    for setting; do
        arguments+=(--set "$setting")
    done
    refused 65 "$pattern" fullrun scene.yml -o r.h5 "${arguments[@]}"
    [ ! -e r.h5 ]
    [ ! -e r.h5.partial ]
}

@test "values that no contact can follow are refused before any work" {
    bad_history "transient.load: found -0.5 at T = 0.25, expected at least 0" \
        transient.load.amplitude=-1.5
    bad_history "transient.radius: found -1 at T = 1, expected more than 0" \
        transient.radius.law=ramp transient.radius.to=-1 transient.radius.duration=1
    bad_history "transient.modulus: found 0 at T" \
        transient.modulus.law=step transient.modulus.to=0 transient.modulus.at=0.5
    bad_history "transient.speed: found -0.5 .*expected at least 0; transport: path can reverse" \
        transport=upwind transient.speed.law=sine transient.speed.amplitude=1.5 transient.speed.period=1
}

@test "missing and misplaced keys are refused" {
    sed '/end_time/d' scene.yml >bad.yml
    refused 65 "bad.yml:.*transient.end_time: found nothing, expected" fullrun bad.yml -o r.h5
    (cat base.yml && echo 'moes: {M: 14, L: 4}' && echo 'transient: {end_time: 1}') >bad.yml
    refused 65 "bad.yml:.*transient.end_time: found a value, expected none with .*stationary" \
        fullrun bad.yml -o r.h5
    (cat base.yml && echo 'moes: {M: 14, L: 4}') | sed 's/regime.*/regime: transient/' >bad.yml
    refused 65 "bad.yml:.*transient.end_time" fullrun bad.yml -o r.h5
    bad_history "transient.load.period" transient.load.period=
    bad_history "transient.load.from: found a value, expected none" transient.load.from=1
    bad_history "transient.approach" transient.approach.law=constant
    bad_history "transient.fixed_step" transient.fixed_step=0
    bad_history "transient.end_time" transient.end_time=nan
}

# bad_table PATTERN: checks that the scene with the table on stdin is refused
bad_table() {
    cat >table.csv
    sed 's/load:.*/load: {law: table, file: table.csv, column: load}/' scene.yml >bad.yml
    refused 65 "$1" fullrun bad.yml -o r.h5
    [ ! -e r.h5 ]
    [ ! -e r.h5.partial ]
}

# bats test_tags=slow
@test "bad tables are refused with file and row" {
    printf 'time,load\n0,1\n0.5,1.1\n2,1\n' >table.csv
    sed 's/load:.*/load: {law: table, file: table.csv, column: load}/' scene.yml >good.yml
    fullrun good.yml -o good.h5 --quiet
    printf 'time,load\n0,1\n0.5,1.1\n0.9,1\n' |
        bad_table "table.csv: found 0.9 as last time, expected transient.end_time = 1 or after"
    printf 'time,load\n0.1,1\n0.5,1.1\n2,1\n' | bad_table "table.csv: found 0.1 as first time"
    printf 'time,load\n0,1\n0.6,1.1\n0.5,1\n2,1\n' |
        bad_table "table.csv: found the time 0.5 in row 3, expected .* after 0.6"
    printf 'time,load\n0,1\n0.5,nan\n2,1\n' | bad_table "table.csv:.*nan"
    printf 'time,load\n0,1\n0.5,1e999\n2,1\n' | bad_table "table.csv:.*1e999"
    printf 'time,load\n0,1\n0.5,x\n2,1\n' | bad_table "table.csv:.*x"
    # columns are found by their names, whatever their order
    printf ',"load",T\r\n0,1,0\r\n1,1.1,0.5\r\n2,1,2\r\n' >table.csv
    fullrun good.yml -o named.h5 --quiet
    scalars_equal good.h5 named.h5
    printf 'time,force\n0,1\n0.5,1.1\n2,1\n' |
        bad_table "table.csv:1: found the columns time, force, expected a column load"
    printf 'time,load,load\n0,1,2\n0.5,1.1,2\n2,1,2\n' |
        bad_table "table.csv:1: load: found again in the columns time, load, load, expected only once"
    printf 'T;load\n0;1\n0,5,1;1,1\n2;1\n' | bad_table "table.csv:3: T: found 0,5,1, expected a number"
    printf 'time,load\n0,1\n0.5\n2,1\n' | bad_table "table.csv:"
    printf 'time,load\n0,1\n0.5,-1\n2,1\n' | bad_table "transient.load: found -1.48.* at T = 0.88"
    printf '' | bad_table "table.csv:"
    rm table.csv
    refused 66 "table.csv: found" fullrun bad.yml -o r.h5
}

# of_formula NAME FIELD: prints a word from the line of a formula in $output.
of_formula() { sed -n "s/^formula $1 //p" <<<"$output" | tr -d '+%,-' | awk -v field="$2" '{ print $field }'; }

# bats test_tags=slow
@test "--formulas in time: of the contact at each time, as if it were stationary" {
    # with the published rows the exit of the stationary contact is at a node too
    (cat base.yml && echo 'moes: {M: 14, L: 4}') >still.yml
    run fullrun still.yml -o still.h5 --set discretization=published --formulas
    local still=$(of_formula dowson-toyoda 3) name
    # under a constant load all times deviate like the stationary contact
    run fullrun scene.yml -o constant.h5 --set discretization=published --formulas --quiet --set transient.load.amplitude=0
    [ "$(grep -c '^formula ' <<<"$output")" -eq 6 ]
    for field in 3 5 7; do close_to "$(of_formula dowson-toyoda $field)" "$still" 1e-3; done
    # a slowly varying contact passes through the stationary contacts of the smallest and the largest load
    run fullrun scene.yml -o slow.h5 --set discretization=published --formulas --quiet --set transient.load.period=1e4 \
        --set transient.end_time=1e4 --set transient.fixed_step=100
    cp /dev/stdin slow <<<"$output"
    run fullrun still.yml -o light.h5 --set discretization=published --formulas --set moes.M=12.6
    local light=$(of_formula ertel-grubin 3) light_minimum=$(of_formula dowson-higginson 3)
    run fullrun still.yml -o heavy.h5 --set discretization=published --formulas --set moes.M=15.4
    local heavy=$(of_formula ertel-grubin 3) heavy_minimum=$(of_formula dowson-higginson 3)
    run cat slow
    close_to "$(of_formula ertel-grubin 3)" "$(printf '%s\n' "$light" "$heavy" | sort -g | tail -n 1)" 2e-3
    close_to "$(of_formula dowson-higginson 3)" \
        "$(printf '%s\n' "$light_minimum" "$heavy_minimum" | sort -g | tail -n 1)" 2e-2
}

# of_traction FIELD: prints a word from the line of the friction formula in $output.
of_traction() { sed -n 's/^traction evans-johnson //p' <<<"$output" | tr -d '+%,-' | awk -v field="$1" '{ print $field }'; }

# bats test_tags=slow
@test "--formulas in time: the friction of the contact at each time, as if it were stationary" {
    cat >rest.yml <<'YAML'
contact: line
physical: {load: 3.0e5, radius: 0.01, speed: 1, modulus: 2.3e11, viscosity: 0.05}
slide_roll: 0.1
discretization: published
grid: {x_min: -4, x_max: 2, step: 0.02}
lubricant: {viscosity: {law: barus, alpha: 2.0e-8}, shear: {law: eyring, tau0: 1.0e6}}
YAML
    (cat rest.yml && echo 'regime: stationary') >still.yml
    (cat rest.yml && printf 'regime: transient\ntransient: {load: {law: sine, amplitude: 0, period: 1e4}, end_time: 1, fixed_step: 0.5}\n') >moving.yml
    run fullrun still.yml --formulas
    local still=$(of_traction 3) curve=$(sed -n 's/^traction slide-roll: //p' <<<"$output") light heavy
    # a constant load changes nothing
    run -0 fullrun moving.yml -o constant.h5 --formulas --quiet
    for field in 3 5 7; do close_to "$(of_traction $field)" "$still" 2e-3; done
    [ -n "$curve" ]
    grep -qx "traction at T = 0, slide-roll: $curve" <<<"$output"
    # a slowly varying contact passes through the stationary contacts of the smallest and the largest load
    run fullrun still.yml --formulas --set physical.load=2.0e5 && light=$(of_traction 3)
    run fullrun still.yml --formulas --set physical.load=4.0e5 && heavy=$(of_traction 3)
    echo "light $light, heavy $heavy"
    run -0 fullrun moving.yml -o slow.h5 --formulas --quiet --set transient.load.amplitude=0.33333 \
        --set transient.end_time=1e4 --set transient.fixed_step=250
    echo "$output"
    close_to "$(of_traction 3)" "$(printf '%s\n' "$light" "$heavy" | sort -g | tail -n 1)" 1e-2
    far_from "$(of_traction 3)" "$still" 0.1
    # the output has the share of the time outside of the formula's range; in pure rolling there is no friction
    run -0 fullrun moving.yml -o slow.h5 --formulas --quiet --force --set lubricant.viscosity.alpha=1.0e-8
    grep -q '^traction evans-johnson .*, outside for 100 % of the time$' <<<"$output"
    run -0 fullrun moving.yml -o rolling.h5 --formulas --quiet --set slide_roll=0
    grep -q '^traction evans-johnson  *friction  0 at all times ' <<<"$output"
    run -0 fullrun moving.yml -o newton.h5 --formulas --quiet --allow-untrusted --set lubricant.shear.law=newtonian --set lubricant.shear.tau0=
    [[ "$output" != *evans-johnson* ]]
}

@test "misuse is one line and exit 64" {
    fullrun scene.yml -o full.h5 --quiet
    refused 64 "--start: found with a transient scene" \
        fullrun scene.yml -o r.h5 --start full.h5
    (cat base.yml && echo 'moes: {M: 14, L: 4}') >still.yml
    refused 64 "--resume: found with a stationary scene" fullrun still.yml -o r.h5 --resume
    refused 64 "--repeat: found with a transient scene" fullrun scene.yml -o r.h5 --repeat 2
    refused 64 "--resume: found without --output, expected" fullrun scene.yml --resume
    refused 64 "--formulas: found with a transient scene without --output" \
        fullrun scene.yml --formulas
    refused 64 "--resume: found without --output, expected" \
        romrun scene.yml --model none.h5 --resume
    refused 65 "full.h5: .*55.*stationary" fullrun still.yml -o r.h5 --start full.h5
}

# ---- runs that end early

@test "a step size that underflows is exit 3, and what was found stays" {
    sed -e '/load:/d' -e '/fixed_step/d' -e 's/^transient:/closure: approach\ntransient:\
  approach: {law: step, to: 100, at: 0.5}/' scene.yml >bad.yml
    run --separate-stderr fullrun bad.yml -o r.h5 --quiet
    echo "$stderr"
    [ "$status" -eq 3 ]
    [ "${#stderr_lines[@]}" -eq 1 ]
    [[ $stderr == "fullrun: bad.yml: not converged: found a step size of "*" at T = 0.5 ("*"), \
expected above "*"; results up to there are in r.h5.partial" ]]
    [[ $output == *"ended early             at T = 0.5 of 1, not converged; results up to there are \
in r.h5.partial"* ]]
    [ ! -e r.h5 ]
    /usr/bin/python3 - <<'PYTHON'
import h5py, numpy
with h5py.File("r.h5.partial") as file:
    assert file.attrs["complete"] == 0
    assert file["time"][-1] == 0.5 and (numpy.diff(file["time"][...]) > 0).all()
    for name in ["central_film_thickness", "load", "rigid_approach"]:
        assert len(file[name]) == len(file["time"]) and numpy.isfinite(file[name][...]).all()
PYTHON
    run fullrun --check r.h5.partial
    [ "$status" -eq 65 ]
}

@test "a start that cannot be solved is exit 3" {
    sed -e '/load:/d' -e 's/^transient:/closure: approach\napproach: -900\ntransient:/' \
        scene.yml >bad.yml
    run --separate-stderr fullrun bad.yml -o r.h5 --quiet
    echo "$stderr"
    [ "$status" -eq 3 ]
    [ -z "$output" ]
    [ "$stderr" = "fullrun: bad.yml: not converged: found no stationary solution to start from \
(approach out of reach), expected one" ]
    [ ! -e r.h5 ]
}

# The load falls to almost nothing, so that the exit leaves a short grid.
# bats test_tags=slow
@test "an exit boundary that leaves the domain is done, flagged, and exit 4" {
    sed -e 's/grid: {/&x_max: 1.2, /' \
        -e 's/load:.*/load: {law: ramp, from: 1, to: 0.02, start: 0, duration: 1}/' scene.yml >out.yml
    run --separate-stderr fullrun out.yml -o out.h5 --quiet
    echo "$stderr"
    [ "$status" -eq 4 ]
    [[ $stderr =~ ^"fullrun: out.yml: found the exit boundary outside the domain (grid.x_max), \
first at T = 0.9"[0-9]*", expected a result to be trusted"$ ]]
    [[ $output == *"not to be trusted       first at T = 0.9"* ]]
    fullrun --check out.h5
    fullrun out.yml -o wide.h5 --quiet --set grid.x_max=2
    /usr/bin/python3 - <<'PYTHON'
import h5py
with h5py.File("out.h5") as short, h5py.File("wide.h5") as wide:
    left = wide["exit_position"][...] / wide["contact_half_width"][...] > 1.2
    flagged = short["status"][...] == 4
    assert flagged.sum() > 2 and (short["status"][...][~flagged] == 0).all()
    assert left[flagged].all() and (wide["status"][...] == 0).all()
PYTHON
    # such a trajectory is no training state
    run --separate-stderr snapgen out.yml -o s.h5 --quiet --allow-failures 1
    [ "$status" -eq 3 ]
    [[ ${stderr_lines[0]} == *"not converged: the exit boundary outside the domain (grid.x_max)" ]]
}

# Writes a scene that takes some seconds.
long_scene() {
    sed -e 's/step: 0.05/step: 0.1/' -e 's/end_time: 1/end_time: 40/' \
        -e 's/fixed_step: 0.02/fixed_step: 0.001/' scene.yml >long.yml
    echo 'output: {fields_every: 500}' >>long.yml
}

# bats test_tags=slow
@test "a run can be followed, killed and resumed: the same numbers" {
    long_scene
    fullrun long.yml -o whole.h5 --quiet >log
    stop_when KILL "checkpoint > 0 and len(time) > checkpoint" r.h5 fullrun long.yml -o r.h5 --quiet
    [ ! -e r.h5 ]
    # results of an interrupted run are not overwritten without --force
    cp r.h5.partial before
    refused 73 "r.h5.partial: found an interrupted run with a restart slot, expected --resume .* --force" \
        fullrun long.yml -o r.h5
    cmp r.h5.partial before
    # a scene with another setting, even if only the end time differs, does not continue the run
    refused 65 "r.h5.partial" fullrun long.yml -o r.h5 --resume --set transient.end_time=41
    run --separate-stderr fullrun long.yml -o r.h5 --resume
    [ "$status" -eq 0 ]
    [[ ${stderr_lines[0]} == "fullrun: r.h5.partial: goes on at T = "* ]]
    diff <(grep -v solution log) <(grep -v solution <<<"$output")
    [ ! -e r.h5.partial ]
    fullrun --check r.h5
    /usr/bin/python3 - <<'PYTHON'
import h5py
with h5py.File("whole.h5") as whole, h5py.File("r.h5") as resumed:
    assert set(whole) == set(resumed)
    for name in whole:
        if not name.startswith("restart"):
            assert whole[name][...].tobytes() == resumed[name][...].tobytes(), name
    for name in "steps", "rejected_steps", "total_newton_iterations":
        assert whole.attrs[name] == resumed.attrs[name], name
PYTHON
}

# interrupt COMMAND...: stops the command after some steps; the output is x.h5
interrupt() {
    stop_when INT "len(time) > 100" x.h5 "$@" -o x.h5 --quiet
    [ "$code" -eq 130 ]
}

# bats test_tags=slow
@test "tables are inputs, and a changed one does not go on" {
    long_scene
    printf 'time,load,speed\n0,1,1\n20,1.1,1\n40,1,1.1\n' >table.csv
    printf 'time,radius\n0,1\n20,1.1\n40,1\n' >radius.csv
    sed -i 's/load:.*/load: {law: table, file: table.csv, column: load}\
  speed: {law: table, file: table.csv, column: speed}\
  radius: {law: table, file: radius.csv, column: radius}/' long.yml
    interrupt fullrun long.yml
    cp radius.csv kept.csv
    sed -i 's/1.1/1.2/' radius.csv
    refused 65 "x.h5.partial: found a run with another table than radius.csv is now, expected" \
        fullrun long.yml -o x.h5 --resume
    mv kept.csv radius.csv
    fullrun long.yml -o x.h5 --resume --quiet
    /usr/bin/python3 - <<'PYTHON'
import h5py, hashlib
with h5py.File("x.h5") as file:
    for n, name in enumerate(["long.yml", "table.csv", "radius.csv"], 1):
        with open(name, "rb") as content:
            expected = hashlib.sha256(content.read()).hexdigest()
        assert file.attrs[f"input_{n}_path"].decode() == name
        assert file.attrs[f"input_{n}_sha256"].decode() == expected
    assert "input_4_path" not in file.attrs
PYTHON
}

# bats test_tags=slow
@test "tables are inputs of a training too" {
    printf 'time,load\n0,1\n0.5,1.1\n1,1\n' >table.csv
    sed -e 's/load:.*/load: {law: table, file: table.csv, column: load}/' \
        -e 's/fixed_step: 0.02/fixed_step: 0.001/' scene.yml >tables.yml
    cat >tables-plan.yml <<'YAML'
groups:
  - scene: base.yml
    vary: {moes.M: [11, 14, 17], moes.L: [3, 4, 5]}
  - scene: tables.yml
    vary: {moes.M: [12, 13, 14, 15]}
YAML
    stop_when INT 'states >= 9' x.h5 snapgen tables-plan.yml -o x.h5 --quiet --jobs 1
    [ "$code" -eq 130 ]
    cp table.csv kept.csv
    sed -i 's/,1[.]1/,1.2/' table.csv
    refused 65 "x.h5.partial: found a run with another table than table.csv is now, expected" \
        snapgen tables-plan.yml -o x.h5 --resume
    mv kept.csv table.csv
    snapgen tables-plan.yml -o x.h5 --resume --quiet
    podbuild x.h5 -o b.h5
    snapgen tables-plan.yml --basis b.h5 -o r.h5 --quiet
    /usr/bin/python3 - <<'PYTHON'
import h5py
for name, expected in ("x.h5", ["tables-plan.yml", "table.csv"]), \
                      ("r.h5", ["tables-plan.yml", "b.h5", "table.csv"]):
    with h5py.File(name) as file:
        found = [file.attrs[f"input_{n}_path"].decode() for n in range(1, len(expected) + 1)]
        assert found == expected and f"input_{len(found) + 1}_path" not in file.attrs, found
PYTHON
}

# bats test_tags=slow
@test "Ctrl-C is 130, and the run can be resumed" {
    long_scene
    stop_when INT "len(time) > 100" r.h5 fullrun long.yml -o r.h5 2>log >out
    [ "$code" -eq 130 ]
    [ ! -s out ]
    grep -qx "fullrun: interrupted at T = .*; --resume goes on" log
    [ ! -e r.h5 ]
    entries=$(/usr/bin/python3 -c "import h5py; print(len(h5py.File('r.h5.partial')['time']))")
    fullrun long.yml -o r.h5 --resume --quiet >out
    grep -q "T = 0 to 40 in 4000[0-9] steps" out
    fullrun long.yml -o whole.h5 --quiet
    scalars_equal r.h5 whole.h5
    [ "$entries" -lt 20001 ]
}

# bats test_tags=slow
@test "the copy of an interrupted run is not deleted, and can be resumed" {
    long_scene
    stop_when INT "len(time) > 100" r.h5 fullrun long.yml -o r.h5 2>log >out
    mv r.h5.partial r.h5.saved
    cp r.h5.saved before.h5
    refused 73 "r.h5.saved: found the copy of an interrupted run with a restart slot: rename it to r.h5.partial and use --resume, or" \
        fullrun long.yml -o r.h5 --resume --quiet
    cmp r.h5.saved before.h5
    [ ! -e r.h5.partial ]
    mv r.h5.saved r.h5.partial
    fullrun long.yml -o r.h5 --resume --quiet >out
    fullrun long.yml -o whole.h5 --quiet
    scalars_equal r.h5 whole.h5
    [ ! -e r.h5.saved ]
    touch other.h5.saved # holds nothing
    fullrun scene.yml -o other.h5 --quiet
}

@test "--resume without an interrupted run starts one" {
    fullrun scene.yml -o a.h5 --quiet
    fullrun scene.yml -o b.h5 --quiet --resume
    scalars_equal a.h5 b.h5
    refused 73 "a.h5: found an existing file" fullrun scene.yml -o a.h5 --resume
}

# bats test_tags=slow
@test "an interrupted romrun goes on" {
    snapgen plan.yml -o s.h5 --quiet
    podbuild s.h5 -o b.h5
    snapgen plan.yml --basis b.h5 -o r.h5 --quiet
    deimselect --no-check r.h5 --basis b.h5 -o m.h5
    long_scene
    # the steps are those of the training: with 0.001, a fiftieth of the grid's, the minimum film is 7 % off (exit code
    # 4)
    sed -i -e 's/step: 0.1}/step: 0.05}/' -e 's/fixed_step: 0.001/fixed_step: 0.02/' \
        -e 's/end_time: 40/end_time: 800/' long.yml
    romrun --allow-untrusted long.yml --model m.h5 -o whole.h5 --quiet >whole.log
    interrupt romrun --allow-untrusted long.yml --model m.h5
    refused 73 "x.h5.partial: found an interrupted run with a restart slot, expected --resume .* --force" \
        romrun long.yml --model m.h5 -o x.h5
    # the run is not continued by another model with the same or another size, nor by another size of this model
    deimselect --no-check r.h5 --basis b.h5 -o other.h5 --rows 50
    refused 65 "x.h5.partial: found a run with another model than other.h5 is now, expected" \
        romrun long.yml --model other.h5 -o x.h5 --resume
    podbuild s.h5 -o b2.h5 --pressure-modes 9
    snapgen plan.yml --basis b2.h5 -o r2.h5 --quiet
    deimselect --no-check r2.h5 --basis b2.h5 -o other.h5 --force
    refused 65 "x.h5.partial: found a run with another model than other.h5 is now, expected" \
        romrun long.yml --model other.h5 -o x.h5 --resume
    refused 65 "x.h5.partial: found other settings" \
        romrun long.yml --model m.h5 -o x.h5 --resume --rows 50
    mv m.h5 moved.h5
    romrun --allow-untrusted long.yml --model moved.h5 -o x.h5 --resume --quiet --against whole.h5 >log
    grep -q "central film thickness *at most 0 % off" log
    diff <(grep -v solution whole.log) <(sed '/^against/,$d' log | grep -v solution)
    scalars_equal x.h5 whole.h5
    mv moved.h5 m.h5
    refused 64 "--repeat: found with a transient scene" \
        romrun scene.yml --model m.h5 --repeat 2
    refused 65 "whole.h5: found a result of M = 14" \
        romrun scene.yml --model m.h5 --set moes.M=15 --against whole.h5
}

@test "a full disk is 74, and an existing output stays" {
    echo precious >r.h5
    limited() {
        (ulimit -f 64 && fullrun "$@")
    }
    run --separate-stderr limited scene.yml -o r.h5 --force --quiet
    echo "$status $stderr"
    [ "$status" -eq 74 ]
    [ "${#stderr_lines[@]}" -eq 1 ]
    [[ $stderr == "fullrun: r.h5"* ]]
    [ "$(cat r.h5)" = precious ]
}

# ---- along the path

# bats test_tags=slow
@test "a model is run as its training carried the films" {
    sed 's/^regime.*/&\ntransport: upwind/' scene.yml >upwind.yml
    sed 's/scene: scene.yml/scene: upwind.yml/' plan.yml >upwind-plan.yml
    snapgen plan.yml -o s.h5 --quiet
    podbuild s.h5 -o b.h5
    refused 65 "upwind-plan.yml: transport: found upwind, expected path, as in b.h5" \
        snapgen upwind-plan.yml --basis b.h5 -o r.h5
    snapgen plan.yml --basis b.h5 -o r.h5 --quiet
    deimselect --no-check r.h5 --basis b.h5 -o m.h5
    deimselect --check m.h5
    refused 65 "transport: found upwind, expected path, as in the model's training" \
        romrun upwind.yml --model m.h5 -o x.h5
    fullrun scene.yml -o f.h5 --quiet
    romrun --allow-untrusted scene.yml --model m.h5 -o x.h5 --quiet --against f.h5 >log
    close_to "$(/usr/bin/python3 -c "import h5py; print(h5py.File('x.h5')['central_film_thickness'][-1])")" \
        "$(/usr/bin/python3 -c "import h5py; print(h5py.File('f.h5')['central_film_thickness'][-1])")" 1e-3
    leads_back scene.yml fullrun
    leads_back scene.yml romrun --allow-untrusted --model m.h5
    # the filter must agree too; a scene that does not give it has the filter of the training
    sed 's/^transient:/&\n  smoothing: 0.05/' scene.yml >smooth.yml
    refused 65 "transient.smoothing: found 0.05, expected 0.0" \
        romrun smooth.yml --model m.h5 -o x.h5
    sed 's/scene: scene.yml/scene: smooth.yml/' plan.yml >smooth-plan.yml
    refused 65 "smooth-plan.yml: transient.smoothing: found 0.05, expected 0.0" \
        snapgen smooth-plan.yml --basis b.h5 -o r2.h5
    snapgen smooth-plan.yml -o s2.h5 --quiet
    refused 65 "s2.h5: transient.smoothing: found 0.05, expected 0.0" podbuild s.h5 s2.h5 -o x2.h5
    podbuild s2.h5 -o b2.h5
    snapgen smooth-plan.yml --basis b2.h5 -o r2.h5 --quiet
    deimselect --no-check r2.h5 --basis b2.h5 -o m2.h5
    romrun --allow-untrusted scene.yml --model m2.h5 -o x.h5 --force --quiet
    romrun --allow-untrusted smooth.yml --model m2.h5 -o y.h5 --quiet
    scalars_equal x.h5 y.h5
    refused 65 "transient.speed: found -1 at T = 0.75, expected at least 0 with a reduced model, which is of one direction" \
        romrun scene.yml --model m.h5 -o z.h5 --set transient.speed.law=sine --set transient.speed.mean=0 \
        --set transient.speed.amplitude=1 --set transient.speed.period=1
    # a basis has one value of `transport`, and so has a plan
    snapgen upwind-plan.yml -o u.h5 --quiet
    refused 65 "u.h5: transport: found upwind, expected path, as in s.h5" podbuild s.h5 u.h5 -o x2.h5
    printf '  - scene: scene.yml\n' >>upwind-plan.yml
    refused 65 "upwind-plan.yml: transport: found upwind and path, expected one of them" \
        snapgen upwind-plan.yml -o z.h5
    printf '  - scene: smooth.yml\n' >>plan.yml
    refused 65 "plan.yml: transient.smoothing: found 0.0" snapgen plan.yml -o z.h5
}

# bats test_tags=slow
@test "a run by the rows can be killed and resumed" {
    long_scene
    sed 's/^regime.*/&\ntransport: upwind/; s/end_time: 40/end_time: 8/' long.yml >rows.yml
    fullrun rows.yml -o whole.h5 --quiet
    stop_when KILL "checkpoint > 0 and len(time) > checkpoint" r.h5 fullrun rows.yml -o r.h5 --quiet
    fullrun rows.yml -o r.h5 --resume --quiet
    scalars_equal r.h5 whole.h5
}

# bats test_tags=slow
@test "an entrainment that reverses: exits on either side, killed and resumed, refused elsewhere" {
    cat >fro.yml <<'YAML'
contact: line
regime: transient
transport: path
lubricant: {viscosity: {law: barus, alpha: 2e-8}}
moes: {M: 20, L: 5}
grid: {x_min: -2.5, step: 0.025}
transient:
  end_time: 6
  speed: {law: sine, mean: 0, amplitude: 1, period: 4, phase: 1.5707963267948966}
YAML
    fullrun fro.yml -o whole.h5 --quiet --formulas >log
    grep -q "201 nodes from -2.5 to 2.5" log # has an inlet on either side
    run -1 grep "nan\|inf" log
    fullrun --check whole.h5
    /usr/bin/python3 - <<'PYTHON'
import h5py, numpy
with h5py.File("whole.h5") as file:
    time, exits = file["time"][...], file["exit_position"][...]
    assert exits.shape == (len(time), 8)
    speed = numpy.cos(2 * numpy.pi * time / 4)
    moving = abs(speed) > 0.3
    assert (exits[moving, 0] * speed[moving] > 0).all() and (abs(exits[moving, 0]) < 1.6).all()
    # exits are ordered, the farthest downstream first; NaN follows the last exit
    for line, direction in zip(exits, numpy.sign(speed)):
        there = ~numpy.isnan(line)
        assert there[0] and (numpy.diff(there.astype(int)) <= 0).all()
        assert (numpy.diff(line[there]) * (direction or 1) < 0).all()
    assert (file["status"][...] == 0).all()
PYTHON
    fullrun --print whole.h5 time exit_position | head -1 | grep -qx "exit,time,exit_position"

    stop_when KILL "checkpoint > 0 and len(time) > checkpoint" r.h5 \
        fullrun fro.yml -o r.h5 --quiet --set transient.fixed_step=0.002
    fullrun fro.yml -o r.h5 --resume --quiet --set transient.fixed_step=0.002
    fullrun fro.yml -o at-once.h5 --quiet --set transient.fixed_step=0.002
    scalars_equal r.h5 at-once.h5

    refused 65 "transient.speed: found -1 at T = 2, expected at least 0; transport: path can reverse" \
        fullrun fro.yml -o x.h5 --set transport=upwind
    refused 65 "transient.speed: found -1 at T = 2, expected at least 0 with a reduced model" snapgen fro.yml -o x.h5
    # a plan is refused before its points are solved
    printf 'groups: [{scene: base.yml, vary: {moes.M: [11, 14], moes.L: [4]}}, {scene: fro.yml}]\n' >fro-plan.yml
    sed -i 's/^grid.*/grid: {x_min: -2.5, x_max: 2.5, step: 0.025}/' base.yml fro.yml
    refused 65 "fro-plan.yml: transient.speed: found -1 at T = 2" snapgen fro-plan.yml -o x.h5
    [ ! -e x.h5 ]
    [ ! -e x.h5.partial ]
    # starts from rest
    rest="--set transient.speed.phase=0 --set transient.speed.mean=0"
    refused 65 "found 0 at the start, expected another one, or transient.start_speed, where the approach is given" \
        fullrun fro.yml -o x.h5 $rest --set closure=approach --set approach_length=10
    fullrun fro.yml -o x.h5 --quiet $rest --set transient.start_speed=-1
    [ "$(fullrun --print x.h5 central_film_thickness | sed -n 2p)" = \
        "$(fullrun --print whole.h5 central_film_thickness | sed -n 2p)" ]
}

# Lift 3.5 mm (1 + cos 2.4 phi) of a flat-faced tappet, base radius 17 mm, -75 to 75 degrees. The radius of curvature is
# base + lift + lift'', and the entrainment is proportional to base + lift + 2 lift''.
@test "a cam from flank to flank: two reversals, and at the nose the film of a stationary contact" {
    awk 'BEGIN {
        print "T,load,speed,radius"
        for (i = 0; i <= 240; i++) {
            phi = (i / 120 - 1) * 75 * atan2(0, -1) / 180
            lift = 3.5 * (1 + cos(2.4 * phi)); bend = -2.4 ^ 2 * 3.5 * cos(2.4 * phi)
            printf "%.9g,%.9g,%.9g,%.9g\n", 4 * i / 3, 1 + lift / 14, (17 + lift + 2 * bend) / 40, (17 + lift + bend) / 10
        }
    }' >cam.csv
    [[ $(sed -n 122p cam.csv) == 160,1.5,-0.408,0.384 ]]
    cat >cam.yml <<'YAML'
contact: line
regime: transient
physical: {load: 6e4, radius: 0.01, speed: 1, modulus: 2.3e11, viscosity: 0.1}
lubricant: {viscosity: {law: barus, alpha: 2e-8}, density: {law: incompressible}}
grid: {x_min: -8, x_max: 8, step: 0.04}
transient:
  end_time: 320
  load: {law: table, file: cam.csv, column: load}
  speed: {law: table, file: cam.csv, column: speed}
  radius: {law: table, file: cam.csv, column: radius}
YAML
    fullrun cam.yml -o cam.h5 --quiet
    sed -n '/^transient:/q; s/transient/stationary/; p' cam.yml >nose.yml
    fullrun nose.yml -o nose.h5 --quiet --set physical.load=9e4 --set physical.speed=0.408 --set physical.radius=0.00384
    /usr/bin/python3 - <<'PYTHON'
import h5py, numpy
with h5py.File("cam.h5") as cam, h5py.File("nose.h5") as nose:
    for film in ("central_film_thickness", "minimum_film_thickness"):
        in_time = numpy.interp(160, cam["time"][...], cam[film][...].ravel()) * cam.attrs["film_unit"]
        numpy.testing.assert_allclose(in_time, nose[film][()] * nose.attrs["film_unit"], rtol=0.02)
PYTHON
}

@test "a point contact that reverses: its exits a line and time, either side" {
    cat >fro.yml <<'YAML'
contact: point
regime: transient
moes: {M: 20, L: 5}
lubricant: {viscosity: {law: barus, alpha: 2e-8}}
grid: {x_min: -2.4, x_max: 2.4, step: 0.15, y_max: 2.4, half: true}
transient:
  end_time: 2.4
  fixed_step: 0.1
  speed: {law: sine, mean: 0, amplitude: 1, period: 4, phase: 1.5707963267948966}
YAML
    fullrun fro.yml -o fro.h5 --quiet
    fullrun --check fro.h5
    /usr/bin/python3 - <<'PYTHON'
import h5py, numpy
with h5py.File("fro.h5") as file:
    time, y, exits = file["time"][...], file["y"][...], file["exit_position"][...]
    assert [dimension[0].name for dimension in file["exit_position"].dims] == ["/time", "/y", "/exit"]
    assert exits.shape == (len(time), len(y), 8)
    speed = numpy.cos(2 * numpy.pi * time / 4)
    inside = exits[:, abs(y) < 0.7]
    before, after = speed > 0.3, speed < -0.3
    assert before.any() and after.any()
    assert (inside[before, :, 0] > 0.5).all() and (inside[after, :, 0] < -0.5).all()
    numpy.testing.assert_array_equal(exits, exits[:, ::-1]) # half of the domain gives both halves
    for line in exits.reshape(-1, 8): # NaN only behind all exits
        assert (numpy.diff((~numpy.isnan(line)).astype(int)) <= 0).all()
    numpy.savetxt("size", [exits.size], "%d")
PYTHON
    fullrun --print fro.h5 exit_position >printed
    [ "$(head -n 1 printed)" = time,y,exit,exit_position ]
    [ "$(grep -c . printed)" -eq $((1 + $(cat size))) ]
}

# A film that almost closes is not resolved between nodes: the interpolated minimum was below zero.
@test "a film that closes is flagged, with exit 4, and ends the march, with exit 3" {
    cat >dry.yml <<'YAML'
contact: line
regime: transient
moes: {M: 12, L: 5}
hertz_pressure: 0.5e9
lubricant: {viscosity: {law: barus, alpha: 2e-8}, density: {law: dowson-higginson}}
grid: {x_min: -3, x_max: 2, step: 0.05}
transient:
  end_time: 0.269
  speed: {law: sine, mean: 0, amplitude: 1, period: 4}
  load: {law: sine, amplitude: 0.2, period: 1}
YAML
    run --separate-stderr fullrun dry.yml -o dry.h5 --quiet
    [ "$status" -eq 4 ]
    [[ $stderr == "fullrun: dry.yml: found a film that closes between nodes (grid.step), first at T = 0.2"* ]]
    /usr/bin/python3 -c 'import h5py; assert (h5py.File("dry.h5")["minimum_film_thickness"][...] > 0).all()'
    run --separate-stderr fullrun dry.yml -o dry.h5 --quiet --force --set transient.end_time=0.28
    [ "$status" -eq 3 ]
    [[ $stderr == "fullrun: dry.yml: not converged: "*" at T = 0.2"*"(film driven to zero, as by too coarse a grid)"* ]]
}

# ---- surfaces that are not smooth

# bats test_tags=slow
@test "a dent, a waviness and a table move through the contact: where they are, resumed, refused elsewhere" {
    cat >dent.yml <<'YAML'
contact: line
regime: transient
physical: {load: 2e5, radius: 0.01, speed: 1, modulus: 2.2e11, viscosity: 0.04}
lubricant: {viscosity: {law: barus, alpha: 2e-8}}
grid: {x_min: -3, x_max: 2, step: 0.05}
transient: {end_time: 4, fixed_step: 0.05}
surface: {kind: dent, units: si, depth: 1e-7, radius: 3e-5, speed: 1.5}
YAML
    fullrun dent.yml -o dent.h5 --quiet
    fullrun --check dent.h5
    /usr/bin/python3 - <<'PYTHON'
import h5py, numpy
with h5py.File("dent.h5") as file:
    time, place, film = (file[name][...] for name in ("time", "surface_position", "film_thickness"))
    unit, half_width, x = file.attrs["film_unit"], file.attrs["half_width"], file["x"][...]
# the dent enters at half its width behind the first boundary node and moves one and a half times as fast
assert abs(place - (-3.05 - 3.6 * 3e-5 / half_width + 1.5 * time)).max() < 1e-9
# far in front of the contact, where the pressure is low, the gap is deeper by the dent
k = abs(place + 2.2).argmin()
deeper = (film[k] - film[0])[abs(x - place[k]) < 0.026].max() * unit
assert 0.85e-7 < deeper < 1.1e-7, deeper
PYTHON
    # heights of zero change nothing
    fullrun dent.yml -o flat.h5 --quiet --set surface.depth=0
    fullrun dent.yml -o smooth.h5 --quiet --set surface.kind= --set surface.units= --set surface.speed= \
        --set surface.depth= --set surface.radius=
    scalars_equal flat.h5 smooth.h5
    run -1 grep surface <(h5ls smooth.h5)

    # a table of the dent's heights gives the same films
    /usr/bin/python3 - <<'PYTHON'
import math
with open("dent.csv", "w") as file:
    print("x,depth", file=file)
    for i in range(-180, 181):
        r = abs(i) / 50 / 1.2
        height = 0 if abs(i) == 180 else 1e-7 * math.cos(math.pi / 2 * r) * math.exp(-2 * r * r)
        print(f"{3e-5 * i / 50:.17g},{height:.17g}", file=file)
PYTHON
    grep -v ^surface dent.yml >table.yml
    echo 'surface: {kind: file, units: si, file: dent.csv, column: depth, speed: 1.5}' >>table.yml
    fullrun table.yml -o table.h5 --quiet
    /usr/bin/python3 - <<'PYTHON'
import h5py
with h5py.File("dent.h5") as dent, h5py.File("table.h5") as table:
    for name in "central_film_thickness", "minimum_film_thickness":
        assert abs(dent[name][...] / table[name][...] - 1).max() < 1e-5
    assert "dent.csv" in str([*table.attrs.values()]) or "dent.csv" in table.attrs["settings"]
PYTHON
    stop_when KILL "checkpoint > 0 and len(time) > checkpoint" r.h5 \
        fullrun table.yml -o r.h5 --quiet --set transient.fixed_step=0.0005
    fullrun table.yml -o r.h5 --resume --quiet --set transient.fixed_step=0.0005
    fullrun table.yml -o at-once.h5 --quiet --set transient.fixed_step=0.0005
    scalars_equal r.h5 at-once.h5
    # a changed table does not continue the run
    stop_when KILL "checkpoint > 0 and len(time) > checkpoint" t.h5 \
        fullrun table.yml -o t.h5 --quiet --set transient.fixed_step=0.0004
    awk -F, -v OFS=, 'NR > 1 { $2 /= 2 } 1' dent.csv >half.csv && mv half.csv dent.csv
    refused 65 "dent.csv" fullrun table.yml -o t.h5 --resume --set transient.fixed_step=0.0004

    refuse 65 "surface.kind: found a value, expected none with the regime stationary" fullrun dent.yml -o x.h5 \
        --set regime=stationary --set transient.end_time= --set transient.fixed_step=
    refuse 65 "surface.position: found -3 half widths, expected at most -3.9" fullrun dent.yml -o x.h5 \
        --set surface.units=contact --set surface.radius=0.25 --set surface.position=-3
    refuse 65 "surface.wavelength: found a value, expected none with the kind dent" fullrun dent.yml -o x.h5 \
        --set surface.wavelength=1
    # lengths in metres without `units: si` are refused, and so is a position behind the grid
    refuse 65 "grid.step: found 0.05 half widths, expected at most" fullrun dent.yml -o x.h5 --set surface.units=
    refuse 65 "surface.position: found 6.57.* half widths, expected a surface that rests on the grid" fullrun dent.yml \
        -o x.h5 --set surface.speed=0 --set surface.position=1e-3
    refuse 66 "none.csv" fullrun table.yml -o x.h5 --set surface.file=none.csv
    refuse 65 "podbuild|dent.h5: time: found" podbuild dent.h5 -o x.h5
    # a scene with a surface is refused before the reduced model is opened
    refuse 65 "surface.kind: found dent, expected none with a reduced model" romrun dent.yml --model none.h5 -o x.h5
    refuse 65 "surface.kind: found dent, expected none with a reduced model" snapgen dent.yml -o x.h5
}

# bats test_tags=slow
@test "long waves are flattened and short ones pass, as published" {
    # C. H. Venner, F. Couhier, A. A. Lubrecht, J. A. Greenwood, Tribology Series 32 (1997) 103-112: amplitudes for M =
    # 100 and L = 11, by wavelength over half width
    cat >wave.yml <<'YAML'
contact: line
regime: transient
moes: {M: 100, L: 11}
lubricant: {viscosity: {law: roelands, eta0: 0.04, alpha: 2.2e-8}, density: {law: dowson-higginson}}
grid: {x_min: -4, x_max: 2, step: 0.01}
transient: {end_time: 8, fixed_step: 0.01}
output: {fields: false}
surface: {kind: sine, amplitude: 0.0014, wavelength: 1}
YAML
    while read -r wavelength published; do
        fullrun wave.yml -o "wave-$wavelength.h5" --quiet --set surface.wavelength="$wavelength"
        /usr/bin/python3 - "$wavelength" "$published" <<'PYTHON'
import sys, h5py, numpy
wavelength, published = map(float, sys.argv[1:])
with h5py.File(f"wave-{wavelength:g}.h5") as file:
    time, film = file["time"][...], file["central_film_thickness"][...]
last = time > time[-1] - 2 - 1e-9 # whole waves
phase = 2 * numpy.pi * time[last] / wavelength
waves = numpy.linalg.lstsq(numpy.stack([numpy.ones_like(phase), numpy.cos(phase), numpy.sin(phase)], 1), film[last],
                           rcond=None)[0]
found = numpy.hypot(*waves[1:]) / 0.0014
assert abs(found / published - 1) < 0.05, (wavelength, found, published)
PYTHON
    done <<'TABLE'
2 0.073
1 0.183
0.5 0.394
0.25 0.660
TABLE
}
