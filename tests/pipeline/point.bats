#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests of point contacts: the files that fullrun and snapgen write.

load common

# Writes a scene with 37 by 33 nodes and a plan of four points around it.
setup() {
    cd "$BATS_TEST_TMPDIR" || return
    point_scene 20 -3
    cat >plan.yml <<'YAML'
groups:
  - scene: scene.yml
    vary: {moes.M: [15, 20], moes.L: [4, 5]}
YAML
}

# bats test_tags=slow
@test "half and whole domain write the same symmetric fields" {
    half_and_whole_are_symmetric
    /usr/bin/python3 - <<'PYTHON'
import h5py, numpy
half, whole = h5py.File("half.h5"), h5py.File("whole.h5")
assert numpy.array_equal(half["y"][...], numpy.linspace(-2, 2, 33))
assert half["y"][...].tobytes() == whole["y"][...].tobytes()
for name in "pressure", "film_thickness", "exit_position":
    shape = half[name].shape
    assert shape == ((1, 33, 37) if name != "exit_position" else (1, 33)), (name, shape)
pressure, exits = half["pressure"][0], half["exit_position"][0]
for line in range(33):
    loaded = numpy.nonzero(pressure[line])[0]
    x = half["x"][loaded[-1]] + 0.125 if len(loaded) else numpy.nan
    assert numpy.array_equal(exits[line], x, equal_nan=True), line
assert abs(half["load"][0] - 1) < 1e-9
assert -0.1 < pressure.sum() * 0.125**2 / (2 * numpy.pi / 3) - 1 < -0.01  # the rest of the load is beyond the grid
assert half["film_thickness"][0, 16, 24] == half["central_film_thickness"][0]
PYTHON
}

# bats test_tags=slow
@test "its files open with h5py, xarray and ncdump" {
    fullrun scene.yml -o result.h5
    snapgen plan.yml -o snapshots.h5
    for file in result.h5 snapshots.h5; do
        run "$BATS_TEST_DIRNAME/open_elsewhere.py" $file
        echo "$output"
        [ "$status" -ne 2 ] || skip "a reader is not installed"
        [ "$status" -eq 0 ]
    done
}

# bats test_tags=slow
@test "starts from the result of either domain" {
    fullrun scene.yml -o half.h5
    fullrun scene.yml --set grid.half=false --start half.h5 -o whole.h5
    fullrun scene.yml --start whole.h5 -o again.h5
    for file in whole.h5 again.h5; do
        # at least one iteration is needed, because the iteration decides on the exit
        [ "$(number $file newton_iterations)" = 1.0 ]
        close_to "$(number $file central_film_thickness)" \
            "$(number half.h5 central_film_thickness)" 1e-9
    done
    refused 65 "x: found 1221 nodes .*, expected 1073" \
        fullrun scene.yml --set grid.y_max=1.75 --start half.h5 -o x.h5
}

@test "needs no fields to tell the exit" {
    fullrun scene.yml --set output.fields=false -o small.h5
    fullrun scene.yml -o result.h5
    /usr/bin/python3 - <<'PYTHON'
import h5py
small, result = h5py.File("small.h5"), h5py.File("result.h5")
assert "pressure" not in small and "film_thickness" not in small
assert small["exit_position"][...].tobytes() == result["exit_position"][...].tobytes()
PYTHON
    refused 65 "small.h5: found no dataset pressure" fullrun scene.yml --start small.h5 -o x.h5
}

@test "snapshots are those of the lines that are solved for" {
    fullrun scene.yml -o result.h5
    snapgen plan.yml -o half.h5
    snapgen plan.yml --set grid.half=false -o whole.h5
    /usr/bin/python3 - <<'PYTHON'
import h5py, numpy
half, whole, result = h5py.File("half.h5"), h5py.File("whole.h5"), h5py.File("result.h5")
assert half.attrs["half"] == 1 and "half" not in whole.attrs
assert numpy.array_equal(half["y"][...], numpy.linspace(0, 2, 17))
for name in "pressure", "film_thickness", "exit_node", "exit_position":
    assert numpy.allclose(half[name], whole[name][:, 16:], rtol=0, atol=1e-9, equal_nan=True), name
assert numpy.allclose(half["pressure"][3], result["pressure"][0, 16:], rtol=0, atol=1e-8)
loaded = half["pressure"][...] != 0
last = numpy.where(loaded.any(axis=2), 37 - loaded[:, :, ::-1].argmax(axis=2), 0)
assert numpy.array_equal(half["exit_node"][...], last)
PYTHON
}

# bats test_tags=slow
@test "an interrupted training goes on to the same bits" {
    snapgen plan.yml -o straight.h5 --jobs 1
    sed -i 's/\[15, 20\]/[12, 13, 14, 15, 16, 17, 18, 19, 20]/' plan.yml
    snapgen plan.yml -o other.h5 --jobs 1
    stop_when INT 'states >= 2' cut.h5 snapgen plan.yml -o cut.h5 --jobs 1
    [ "$code" -eq 130 ]
    snapgen plan.yml -o cut.h5 --jobs 1 --resume
    same_data other.h5 cut.h5
}

# bats test_tags=slow
@test "a point contact in time: results and snapshots of half and whole domain" {
    sed -i 's/regime: stationary/regime: transient/' scene.yml
    cat >>scene.yml <<'YAML'
transient:
  load: {law: sine, amplitude: 0.2, period: 0.5}
  end_time: 0.3
  fixed_step: 0.05
YAML
    fullrun scene.yml -o half.h5
    fullrun scene.yml --set grid.half=false -o whole.h5
    fullrun --check half.h5
    printf 'groups: [{scene: scene.yml, vary: {moes.M: [20, 22]}}]\n' >plan.yml
    snapgen plan.yml -o s.h5
    podbuild s.h5 -o b.h5 --pressure-modes 9
    /usr/bin/python3 - <<'PYTHON'
import h5py, numpy
half, whole = (h5py.File(f"{name}.h5") for name in ("half", "whole"))
assert half["pressure"].shape == (11, 33, len(half["x"]))
for name in "pressure", "film_thickness", "central_film_thickness", "exit_position", "load":
    assert numpy.allclose(half[name], whole[name], rtol=0, atol=1e-9, equal_nan=True), name
assert numpy.ptp(half["central_film_thickness"]) > 1e-3
width = half["contact_half_width"][...]
assert numpy.allclose(width ** 3, 1 + 0.2 * numpy.sin(4 * numpy.pi * half["time"][...]))
loaded = half["pressure"][...] != 0
last = loaded.shape[2] - loaded[:, :, ::-1].argmax(axis=2)
exits = numpy.where(loaded.any(axis=2), half["x"][0] + last * half.attrs["step"], numpy.nan)
assert numpy.allclose(half["exit_position"], exits * width[:, None], equal_nan=True)
snapshots = h5py.File("s.h5")
assert snapshots["pressure"].shape == (142, 17, len(half["x"]))
assert numpy.array_equal(snapshots["trajectory"][...], numpy.repeat([0, 1], 71))
for place in 0, 70:  # the start, and the time at which the contact changes fastest
    entry = numpy.argmin(abs(half["time"][...] - snapshots["trajectory_time"][place]))
    for name in "pressure", "film_thickness":
        assert numpy.allclose(snapshots[name][place], half[name][entry, 16:], rtol=0, atol=1e-8), name
    index = snapshots["exit_node"][place]
    assert numpy.array_equal(index, numpy.where(loaded.any(axis=2), last, 0)[entry, 16:])
rows = snapshots["compressed_pressure"][...]
assert rows.shape[1:] == (17, len(half["x"])) and (abs(rows) > 0).any(axis=(1, 2)).all()
PYTHON
}

@test "a line's model refuses a point contact" {
    cp scene.yml point.yml
    common_setup_small
    snapgen plan.yml -o s.h5
    podbuild s.h5 -o b.h5 --pressure-modes 6
    snapgen plan.yml --basis b.h5 -o r.h5
    deimselect r.h5 --basis b.h5 -o m.h5 --rows 40
    refuse 65 "contact: found point, expected line as in m.h5" romrun point.yml --model m.h5 -o x.h5
    fullrun scene.yml -o line.h5
    refuse 65 "line.h5: contact: found line, expected point" fullrun point.yml --start line.h5 -o x.h5
}

@test "says what the grid does to the film" {
    run --separate-stderr fullrun scene.yml -o result.h5 --set discretization=published
    [ "$status" -eq 0 ]
    [[ $stderr == *"grid.step: found 0.125, expected a finer one"* ]]
    /usr/bin/python3 - <<'PYTHON'
import h5py
result = h5py.File("result.h5")
assert 1e-4 < result.attrs["inlet_effect"] < 0.1 # the effect with the far field
assert abs(result.attrs["step_effect"]) > 0.01 and result.attrs["outlet_nodes"] > 0
PYTHON
}

@test "memory is stated, and refused where there is not enough" {
    run --separate-stderr fullrun scene.yml -o result.h5 --verbose
    [[ $stderr == *"629 nodes take about "*" MB"* ]]
    [[ ${VARIANT:-} != san ]] || skip "the address sanitizer needs more than the limit"
    (
        ulimit -v 600000 # OpenBLAS and libraries take half of it
        refuse 71 "scene.yml: grid: found [0-9]* nodes, which take about [0-9]* MB, expected" \
            fullrun scene.yml --set grid.step=0.0025 -o x.h5
        # the memory is stated for any number of nodes up to fifty million
        refuse 71 "scene.yml: grid: found 5765201 nodes, which take about [0-9]* MB, expected" \
            fullrun scene.yml --set grid.step=0.00125 -o x.h5
    )
    refuse 65 "--set: grid.step: found 0.000125, which makes 576052001 nodes, expected at most 50000000" \
        fullrun scene.yml --set grid.step=0.000125 -o x.h5
}

# megabytes PROGRAM...: prints the memory that the program states for its nodes
megabytes() { "$@" 2>&1 >/dev/null | sed -n 's/.* nodes take about \([0-9]*\) MB.*/\1/p'; }

# bats test_tags=slow
@test "a training states the memory of all jobs together, and refuses what is not there" {
    cat >plan.yml <<'YAML'
groups:
  - {scene: scene.yml, vary: {moes.M: [12, 13, 14], moes.L: [4, 5]}}
YAML
    fine="--set grid.step=0.03125"
    one=$(megabytes fullrun scene.yml $fine -o one.h5 --verbose)
    for jobs in 1 3; do
        all=$(megabytes snapgen plan.yml $fine -o s.h5 --force --verbose --jobs $jobs)
        ((one > 3 && all >= jobs * (one - 1) && all <= jobs * (one + 1) + 3))
    done
    # memory is counted for at most as many jobs as there are points
    [ "$(megabytes snapgen plan.yml $fine -o s.h5 --force --verbose --jobs 6)" -eq \
        "$(megabytes snapgen plan.yml $fine -o s.h5 --force --verbose --jobs 60)" ]
    [[ ${VARIANT:-} != san ]] || skip "the address sanitizer needs more than the limit"
    (
        ulimit -v 600000 # OpenBLAS and libraries take half of it
        refuse 71 "plan.yml: grid: found [0-9]* nodes, which take about [0-9]* MB with --jobs 6, expected" \
            snapgen plan.yml --set grid.step=0.00625 --jobs 6 -o x.h5
    )
}

# threads_of OPTION...: prints how many threads fullrun has after 0.3 s of processor time.
threads_of() {
    fullrun scene.yml --repeat 1000 "$@" --quiet >/dev/null 2>&1 &
    pid=$!
    until awk '{ exit !($14 + $15 >= 30) }' /proc/$pid/stat; do
        kill -0 $pid || return
        sleep 0.1
    done
    awk '/^Threads:/ { print $2 }' /proc/$pid/status
    kill $pid
    wait $pid || true
}

# bats test_tags=slow
@test "--jobs changes no result of a large grid, and shares it in time too" {
    large="--set grid.step=0.025" # 181 by 81 nodes
    fullrun scene.yml $large -o one.h5 --jobs 1
    for jobs in 2 5; do
        fullrun scene.yml $large -o many.h5 --jobs $jobs --force
        same_data one.h5 many.h5
    done
    fullrun scene.yml $large -o many.h5 --force
    same_data one.h5 many.h5
    in_time=(scene.yml $large --set regime=transient --set transient.end_time=0.005 --set transient.fixed_step=0.0025
        --set transient.load.law=sine --set transient.load.amplitude=0.1 --set transient.load.period=0.5)
    fullrun "${in_time[@]}" -o one.h5 --jobs 1 --force
    fullrun "${in_time[@]}" -o many.h5 --jobs 3 --force
    same_data one.h5 many.h5
}

# bats test_tags=slow
@test "--jobs are threads from 10,000 nodes on, and as many as there are processors by default" {
    [[ $VARIANT != tsan ]] || skip "the sanitizer has a thread of its own"
    [ "$(threads_of --set grid.step=0.025 --jobs 3)" -eq 3 ]
    [ "$(threads_of --set grid.step=0.025 --jobs 1)" -eq 1 ]
    [ "$(threads_of --set grid.step=0.025)" -eq "$(nproc)" ]
    [ "$(threads_of --jobs 3)" -eq 1 ]
    for jobs in 0 -1 two 2x 1e9 ""; do
        refused 64 "--jobs: found $jobs.*, expected" fullrun scene.yml --jobs="$jobs" -o x.h5
    done
}

# bats test_tags=slow
@test "shows how far it is, and stops soon when interrupted" {
    fullrun scene.yml --set grid.step=0.0078125 --repeat 100 -o x.h5 2>log & # long enough on any machine
    pid=$!
    until grep -q "nodes, iteration" log; do
        kill -0 $pid
        sleep 0.1
    done
    used=$(awk '{ print ($14 + $15) / 100 }' /proc/$pid/stat) # processor time, s
    kill -INT $pid
    code=0
    wait $pid || code=$?
    [ $code -eq 130 ]
    times >times.txt # processor time of this shell, and of its children that ended
    awk -F '[ms ]+' -v used="$used" 'NR == 2 { exit !($1 * 60 + $2 + $3 * 60 + $4 - used < 10) }' times.txt
    grep -q "/1000 [0-9]* by [0-9]* nodes, iteration [0-9]*, residual" log
    [ ! -e x.h5 ]
    [ ! -e x.h5.partial ]
}
