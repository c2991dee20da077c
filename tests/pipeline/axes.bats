#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests with files in which one axis has another length than the rest of the file expects, in all data along this axis.
# Each reader accepts or refuses such a file, and none reads beyond its buffers.

load common

# Writes a file of each kind; the tests run the commands that read it.
setup_file() {
    cd "$BATS_FILE_TMPDIR" || return
    small_model
    podbuild s.h5 -o ib.h5 --pressure-modes 5 --deformation independent
    snapgen train.yml --basis ib.h5 -o ir.h5 --quiet
    deimselect ir.h5 --basis ib.h5 -o im.h5 --no-check
    podbuild s.h5 --compress -o part.h5
    fullrun scene.yml -o result.h5 --quiet >/dev/null
    printf 'moes.M,moes.L\n10,3\n11,4\n' >cases.csv
    romrun scene.yml --model c.h5 --cases cases.csv -o cases.h5 --quiet >/dev/null
    mv scene.yml line.yml
    small_point_model
    moving_scene "x_min: -4, x_max: 2, step: 0.05" "end_time: 0.5, fixed_step: 0.05"
    fullrun moving.yml -o times.h5 --quiet >/dev/null
    time_plan train "1, 2" "0.1"
    model_in_time 8 --no-check
    printf 'groups:\n- {scene: line.yml, region: {moes.M: [10, 12]}, candidates: 20}\n' >region.yml
    snapgen region.yml -o as.h5 --quiet >/dev/null
    podbuild as.h5 -o ab.h5 --pressure-modes 6
    snapgen region.yml --basis ab.h5 -o ar.h5 --quiet >/dev/null
    /usr/bin/python3 - <<'PYTHON'
import h5py, numpy
with h5py.File("history.h5", "w") as file:
    time = numpy.linspace(0, 1, 11)
    for name, values in {"time": time, "load": 1 + 0.1 * time}.items():
        file[name] = values
        file[name].make_scale(name)  # each gets a length of its own
PYTHON
    sed 's/^transient:.*/transient: {load: {law: table, file: history.h5, column: load}, end_time: 0.5, fixed_step: 0.1}/' \
        moving.yml >table.yml
}

setup() {
    cd "$BATS_TEST_TMPDIR" || return
    cp "$BATS_FILE_TMPDIR"/* .
}

# sweep FILE COMMAND...: runs the COMMANDs on copies of FILE. In each copy, one axis is shorter or longer. FILE in a
# COMMAND stands for the copy. Along a longer axis, the entries are repeated in turn, or each entry is repeated.
sweep() {
    /usr/bin/python3 -B "$BATS_TEST_DIRNAME/resize_axes.py" "$@"
}

# bats test_tags=slow
@test "axes of snapshots, parts and bases" {
    sweep s.h5 "snapgen --check s.h5" "podbuild --force s.h5 -o x.h5 --pressure-modes 3" "podbuild --print s.h5 pressure"
    sweep part.h5 "podbuild --check part.h5" "podbuild --force part.h5 -o x.h5 --pressure-modes 3"
    sweep b.h5 "podbuild --check b.h5" "snapgen train.yml --basis b.h5 --force -o x.h5 --quiet" \
        "deimselect --no-check r.h5 --basis b.h5 --force -o x.h5"
    sweep ib.h5 "podbuild --check ib.h5" "snapgen train.yml --basis ib.h5 --force -o x.h5 --quiet" \
        "deimselect --no-check ir.h5 --basis ib.h5 --force -o x.h5"
    sweep bp.h5 "podbuild --check bp.h5" "deimselect --no-check rp.h5 --basis bp.h5 --rows 60 --method sopt --force -o x.h5"
}

# bats test_tags=slow
@test "axes of adaptive trainings and of trajectories" {
    sweep as.h5 "snapgen --check as.h5" "podbuild --force as.h5 -o x.h5 --pressure-modes 3"
    sweep ar.h5 "deimselect --check ar.h5" "deimselect --no-check ar.h5 --basis ab.h5 --force -o x.h5"
    sweep ts.h5 "snapgen --check ts.h5" "podbuild --force ts.h5 -o x.h5 --pressure-modes 3"
    sweep tr.h5 "deimselect --check tr.h5" "deimselect --no-check tr.h5 --basis tb.h5 --force -o x.h5"
}

@test "lengths of a table of histories" {
    sed 's/history.h5/copy-history.h5/' table.yml >resized.yml
    fullrun table.yml --quiet
    sweep history.h5 "fullrun resized.yml --quiet"
}

# bats test_tags=slow
@test "axes of residuals" {
    sweep ir.h5 "deimselect --check ir.h5" "deimselect --no-check ir.h5 --basis ib.h5 --force -o x.h5"
    sweep r.h5 "deimselect --check r.h5" "deimselect --no-check r.h5 --basis b.h5 --force -o x.h5" \
        "deimselect --no-check r.h5 --basis b.h5 --memory 1 --force -o x.h5"
    sweep rp.h5 "deimselect --check rp.h5" "deimselect --no-check rp.h5 --basis bp.h5 --rows 60 --method sopt --force -o x.h5"
}

# bats test_tags=slow
@test "axes of models" {
    local scene="--model m.h5 --allow-untrusted --quiet --force -o x.h5"
    sweep c.h5 "romrun --check c.h5" "romrun --export c.h5 --force -o x.rom" "romrun line.yml ${scene/m.h5/c.h5}"
    sweep im.h5 "romrun --check im.h5" "romrun --export im.h5 --force -o x.rom" "romrun line.yml ${scene/m.h5/im.h5}" \
        "deimselect --check im.h5"
    sweep p.h5 "romrun --check p.h5" "romrun --export p.h5 --force -o x.rom" "romrun point.yml ${scene/m.h5/p.h5}"
    sweep tm.h5 "romrun --check tm.h5" "romrun --export tm.h5 --force -o x.rom" "romrun moving.yml ${scene/m.h5/tm.h5}"
}

# bats test_tags=slow
@test "axes of results and of tables of cases" {
    sweep result.h5 "fullrun --check result.h5" "fullrun --print result.h5 pressure --si" \
        "fullrun line.yml --start result.h5 --force -o x.h5 --quiet" "romrun line.yml --model m.h5 --against result.h5 --allow-untrusted --quiet" \
        "fullrun --vtk result.h5 --force -o x.vti" "podbuild --force result.h5 -o x.h5 --pressure-modes 1"
    sweep times.h5 "fullrun --check times.h5" "fullrun --print times.h5 pressure" "romrun moving.yml --model tm.h5 --against times.h5 --allow-untrusted --quiet"
    sweep cases.h5 "romrun --check cases.h5" "romrun --print cases.h5 central_film_thickness"
}
