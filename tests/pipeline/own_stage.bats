#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests of a user's own stages: rows given to deimselect, and scenes/examples/own-stage.

load common

# Makes one chain with 121 nodes for all tests: s.h5, b.h5, r.h5 and full.h5.
setup_file() {
    cd "$BATS_FILE_TMPDIR" || return
    common_setup_small
    snapgen plan.yml -o s.h5 --quiet
    podbuild s.h5 -o b.h5
    snapgen plan.yml --basis b.h5 -o r.h5 --quiet
    fullrun scene.yml -o full.h5
}

setup() {
    cd "$BATS_TEST_TMPDIR" || return
    cp "$BATS_FILE_TMPDIR"/* .
}

# python CODE: runs the code with h5py, numpy, and the datasets of m.h5 as `m`
python() {
    /usr/bin/python3 -c "
import h5py, numpy
m = {name: data[...] for name, data in h5py.File('m.h5').items()}
$1"
}

# ---- rows of a user's own

# bats test_tags=slow
@test "the rows of a model given back make the same model" {
    for rows in 14 18 25; do
        deimselect --no-check r.h5 --basis b.h5 --method qr --rows $rows -o m.h5 --force
        python "open('rows.csv', 'w').write('row\n' + ''.join(f'{row}\n' for row in m['selected_row']))"
        run --separate-stderr deimselect --no-check r.h5 --basis b.h5 --rows-from rows.csv -o g.h5 --force
        [ "$status" -eq 0 ]
        [ -z "$stderr" ]
        [[ $output == "$rows rows of 121 from rows.csv, 10 unknowns"* ]]
        same_data m.h5 g.h5
        h5dump -a method g.h5 | grep '"given"'
        h5dump -a weights g.h5 | grep '"quadrature"'
        # deimselect also reads the rows from HDF5, from a dataset of either name
        python "h5py.File('rows.h5', 'w')['rows'] = m['selected_row'].astype('i2')"
        deimselect --no-check r.h5 --basis b.h5 --rows-from rows.h5 -o h.h5 --force
        same_data m.h5 h.h5
    done
    deimselect --no-check r.h5 --basis b.h5 --method qr --rows 25 --weights plain -o m.h5 --force
    deimselect --no-check r.h5 --basis b.h5 --rows-from rows.csv --weights plain -o g.h5 --force
    same_data m.h5 g.h5
}

@test "the rows and weights of a model file given back make the same solution" {
    deimselect --no-check r.h5 --basis b.h5 -o m.h5
    deimselect --no-check r.h5 --basis b.h5 --rows-from m.h5 -o g.h5
    python "
with h5py.File('g.h5') as g:
    assert g['row_weight'][...].tobytes() == m['row_weight'].tobytes()
    assert 'weights' not in g.attrs and 'row_jacobian_modes' not in g
    assert g.attrs['input_3_path'] in ('m.h5', b'm.h5')"
    romrun --allow-untrusted scene.yml --model m.h5 -o one.h5
    romrun --allow-untrusted scene.yml --model g.h5 -o two.h5
    same_data one.h5 two.h5
    # a part of the rows keeps the given weights
    romrun --allow-untrusted scene.yml --model g.h5 --rows 14
    python "numpy.savetxt('rows.csv', numpy.c_[m['selected_row'], 2 * m['row_factor']], '%.17g', ',', \
        header='row,weight', comments='')"
    deimselect --no-check r.h5 --basis b.h5 --rows-from rows.csv -o d.h5
    python "
with h5py.File('d.h5') as d:
    assert (d['row_weight'][...] == 2 * m['row_weight']).all()"
}

# bats test_tags=slow
@test "rows from HDF5 that cannot be are refused" {
    deimselect --no-check r.h5 --basis b.h5 -o m.h5
    # bad PATTERN CODE: checks that rows and weights changed by CODE are refused; in CODE they are called `row` and
    # `weight`
    bad() {
        python "
row, weight = m['selected_row'].astype(float), m['row_factor']
$2
with h5py.File('rows.h5', 'w') as f:
    if row is not None: f['rows'] = row
    if weight is not None: f['weights'] = weight"
        refuse 65 "rows.h5: $1" deimselect r.h5 --basis b.h5 --rows-from rows.h5 -o x.h5
    }
    bad "found no dataset selected_row.row.rows among weights, expected one" "row = None"
    bad "rows: found something else, expected numbers along one axis" "row = row.reshape(2, -1)"
    bad "weights: found 17 numbers, expected 18 as of rows" "weight = weight[1:]"
    bad "found 0 rows, expected at least 9: the model has 10 unknowns" "row, weight = row[:0], weight[:0]"
    bad "row: found nan as entry 2, expected a whole number from 0 to 120" "row[1] = numpy.nan"
    bad "row: found 121 as entry 18, expected a whole number" "row[17] = 121"
    bad "row: found [0-9]+ again as entry 2" "row[1] = row[0]"
    bad "weight: found nan as entry 4, expected a positive" "weight[3] = numpy.nan"
    bad "weight: found inf as entry 4, expected a positive" "weight[3] = numpy.inf"
    bad "weight: found -1 as entry 1, expected a positive" "weight[0] = -1"
    echo row >rows.h5
    refuse 65 "rows.h5: found no whole HDF5 file" deimselect r.h5 --basis b.h5 --rows-from rows.h5 -o x.h5
    refuse 66 "none.h5" deimselect r.h5 --basis b.h5 --rows-from none.h5 -o x.h5
    refuse 66 "none.csv" deimselect r.h5 --basis b.h5 --rows-from none.csv -o x.h5
}

@test "--rows-from excludes what would choose other rows or weights" {
    deimselect --no-check r.h5 --basis b.h5 -o m.h5
    for option in "--method qr" "--rows 18" "--stability 2"; do
        refuse 64 "--rows-from: found with ${option% *}, expected one of them" \
            deimselect r.h5 --basis b.h5 --rows-from m.h5 $option -o x.h5
    done
    refuse 64 "--weights: found plain, expected none: m.h5 has weights of its own" \
        deimselect r.h5 --basis b.h5 --rows-from m.h5 --weights plain -o x.h5
    refuse 73 "m.h5: found an input as output" \
        deimselect r.h5 --basis b.h5 --rows-from m.h5 -o m.h5 --force
}

# ---- the example

# The measured deviation is 0.05 per mille; with a wrong basis or wrong rows it is far larger.
# bats test_tags=slow
@test "the example of own stages is as accurate as its README says" {
    cp -r "$BATS_TEST_DIRNAME/../../scenes/examples/own-stage" own
    cd own
    rm -rf out
    run make BIN="$BIN"
    echo "$output"
    [ "$status" -eq 0 ]
    [[ $output == *"48 rows of 401 from out/rows.csv, 25 unknowns"* ]]
    [[ $output != *podbuild\ * && $output == *podbuild.py* ]]
    for quantity in "central film" "minimum film"; do
        deviation=$(sed -n "s/^  $quantity thickness .* \([-+][0-9.]*\) permille/\1/p" out/comparison.txt)
        awk -v deviation="$deviation" 'BEGIN { exit !(deviation != "" && deviation ^ 2 < 0.2 ^ 2) }'
    done
    run make BIN="$BIN"
    [[ $output == *"is up to date"* ]]
}

# ---- a model written from the schema page alone

# same_model A B: checks that all items of a model that romrun needs are equal in A and B, up to round-off
same_model() {
    /usr/bin/python3 - "$1" "$2" <<'PYTHON'
import sys, h5py, numpy
with h5py.File(sys.argv[1]) as own, h5py.File(sys.argv[2]) as other:
    for name in other:
        numpy.testing.assert_allclose(other[name][...], own[name][...], rtol=0, atol=1e-14, err_msg=name)
    if own.attrs["contact"] == b"line":
        names = {"band_begin", "least_exit", "most_exit"}
    elif "half" in own.attrs:
        names = {"first_minimum_line", "last_minimum_line"}
    else:  # round-off decides on which side the minimum is found
        names = set()
        middle = len(own["y"]) / 2 + 0.5  # boundary lines included
        farthest = [max(abs(model.attrs[f"{end}_minimum_line"] - middle) for end in ("first", "last"))
                    for model in (own, other)]
        assert farthest[0] == farthest[1], farthest
    for name in names:
        assert own.attrs[name] == other.attrs[name], name
PYTHON
}

# foreign_model BASIS RESIDUALS OPTIONS...: makes m.h5 by deimselect and w.h5 by write_model.py, with the same rows
foreign_model() {
    deimselect --no-check "$2" --basis "$1" --weights plain -o m.h5 --force "${@:3}"
    python "numpy.savetxt('rows.csv', m['selected_row'], '%d', header='row', comments='')"
    "$BATS_TEST_DIRNAME/write_model.py" "$1" rows.csv w.h5
    same_model m.h5 w.h5
}

# bats test_tags=slow
@test "a model written from the schema page is that of deimselect" {
    podbuild s.h5 -o bi.h5 --deformation independent --pressure-modes 8 --deformation-modes 7
    snapgen plan.yml --basis bi.h5 -o ri.h5 --quiet
    for kind in "" i; do
        foreign_model b$kind.h5 r$kind.h5
        romrun --allow-untrusted scene.yml --model w.h5 -o w-result.h5 --force
        romrun --allow-untrusted scene.yml --model m.h5 -o m-result.h5 --force
        close_to "$(number w-result.h5 central_film_thickness)" \
            "$(number m-result.h5 central_film_thickness)" 1e-9
    done
    # this grid has no node at X = 0
    sed -i 's/grid: {.*/grid: {x_min: -3.96, x_max: 2.04, step: 0.05}/' base.yml
    snapgen plan.yml -o s.h5 --quiet --force
    podbuild s.h5 -o b.h5 --force
    snapgen plan.yml --basis b.h5 -o r.h5 --quiet --force
    foreign_model b.h5 r.h5
    # the published discretisation
    published="--set discretization=published"
    snapgen plan.yml -o s.h5 $published --quiet --force
    podbuild s.h5 -o b.h5 --force
    snapgen plan.yml --basis b.h5 -o r.h5 $published --quiet --force
    foreign_model b.h5 r.h5
}

# bats test_tags=slow
@test "the same of a point contact, half and whole" {
    point_scene 13 -2.5
    cat >plan.yml <<'YAML'
groups:
  - scene: scene.yml
    vary: {moes.M: [8, 11, 15, 20], moes.L: [3, 4.5, 6]}
YAML
    for grid in true false 'true --set discretization=published' 'false --set discretization=published'; do
        grid="--set grid.step=0.25 --set grid.half=$grid"
        snapgen plan.yml -o s.h5 $grid --quiet --force
        podbuild s.h5 -o b.h5 --pressure-modes 8 --force
        snapgen plan.yml --basis b.h5 -o r.h5 $grid --quiet --force
        foreign_model b.h5 r.h5 --rows 40 --method sopt
        romrun scene.yml $grid --model w.h5 -o w-result.h5 --force --allow-untrusted
        romrun scene.yml $grid --model m.h5 -o m-result.h5 --force --allow-untrusted
        close_to "$(number w-result.h5 central_film_thickness)" \
            "$(number m-result.h5 central_film_thickness)" 1e-9
    done
}
