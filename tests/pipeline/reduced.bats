#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests of podbuild, snapgen --basis, deimselect and romrun, from training to solution.

load common

# Makes one chain with 121 nodes for all tests: s.h5, b.h5, r.h5, m.h5 and full.h5.
setup_file() {
    cd "$BATS_FILE_TMPDIR" || return
    common_setup_small
    snapgen plan.yml -o s.h5 --quiet
    podbuild s.h5 -o b.h5
    snapgen plan.yml --basis b.h5 -o r.h5 --quiet
    deimselect --no-check r.h5 --basis b.h5 -o m.h5
    fullrun scene.yml -o full.h5
}

setup() {
    cd "$BATS_TEST_TMPDIR" || return
    cp "$BATS_FILE_TMPDIR"/* .
}

# ---- solutions

# bats test_tags=slow
@test "from training to answer" {
    run --separate-stderr podbuild s.h5 -o x.h5
    [ "$status" -eq 0 ]
    [ -z "$stderr" ]
    [[ $output == "9 states on 121 nodes"* ]]
    run --separate-stderr snapgen plan.yml --basis b.h5 -o y.h5 --quiet
    [ "$status" -eq 0 ]
    [ -z "$stderr" ]
    [[ $output == "9 points with the projected system, 9 converged"* ]]
    run --separate-stderr deimselect --no-check r.h5 --basis b.h5 -o z.h5
    [ "$status" -eq 0 ]
    [ -z "$stderr" ]
    [[ $output =~ "rows of 121 by method joint, 10 unknowns" ]]
    [[ $output =~ "1/sigma_min: residuals "[0-9] ]]
    run --separate-stderr romrun --allow-untrusted --quiet scene.yml --model m.h5 -o red.h5
    [ "$status" -eq 0 ]
    [ -z "$stderr" ]
    [[ $output == *"central film thickness"* ]]
    close_to "$(number red.h5 central_film_thickness)" \
        "$(number full.h5 central_film_thickness)" 0.002
    close_to "$(number red.h5 load)" 1 0.001
    for file in x y z red; do
        fullrun --check $file.h5
        [ ! -e $file.h5.partial ]
    done
    # every stage can check whether a file is complete
    podbuild --check b.h5
    deimselect --check m.h5
    romrun --check red.h5
}

# bats test_tags=slow
@test "with a basis of its own for the deflection, and rows by any method" {
    podbuild s.h5 -o bi.h5 --deformation independent --pressure-modes 8 --deformation-modes 7
    snapgen plan.yml --basis bi.h5 -o ri.h5 --quiet
    for method in joint qr sopt exits; do
        deimselect --no-check ri.h5 --basis bi.h5 -o mi.h5 --method $method --rows 25 --force
        romrun --allow-untrusted scene.yml --model mi.h5 -o red.h5 --force
        close_to "$(number red.h5 central_film_thickness)" \
            "$(number full.h5 central_film_thickness)" 0.01
    done
}

# stability METHOD ROWS: prints the stability that deimselect states for so many rows
stability() {
    deimselect --no-check r.h5 --basis b.h5 -o y.h5 --force --method "$1" --rows "$2" |
        sed -n 's/^stability: \([^ ]*\).*/\1/p'
}

# bats test_tags=slow
@test "as few rows as a wanted stability takes" {
    for method in joint exits; do
        deimselect --no-check r.h5 --basis b.h5 -o x.h5 --method $method --stability 2 --force >log
        rows=$(sed -n 's/ rows of 121 by.*//p' log)
        awk -v of="$(sed -n 's/^stability: \([^ ]*\).*/\1/p' log)" 'BEGIN { exit !(of <= 2) }'
        awk -v of="$(stability $method "$rows")" 'BEGIN { exit !(of <= 2) }'
        awk -v of="$(stability $method $((rows - 1)))" 'BEGIN { exit !(of > 2) }'
        close_to "$(number x.h5 stability)" "$(stability $method "$rows")" 0.005
        romrun --allow-untrusted scene.yml --model x.h5 -o red.h5 --force
        close_to "$(number red.h5 central_film_thickness)" \
            "$(number full.h5 central_film_thickness)" 0.01
    done
    rm x.h5
    refuse 65 "r.h5: --stability: found [0-9.]+ at best, with [0-9]+ rows by method joint, expected at most 1" \
        deimselect r.h5 --basis b.h5 --stability 1 -o x.h5
    refuse 64 "--stability: found --rows 20 too, expected one of the two" \
        deimselect r.h5 --basis b.h5 --stability 2 --rows 20 -o x.h5
    refused 64 "--stability" deimselect r.h5 --basis b.h5 --stability 0.5 -o x.h5
}

# bats test_tags=slow
@test "with other weights of the test basis" {
    for weight in identity "row-norm --plan plan.yml"; do
        podbuild s.h5 -o bw.h5 --weight $weight --force
        snapgen plan.yml --basis bw.h5 -o rw.h5 --quiet --force
        deimselect --no-check rw.h5 --basis bw.h5 -o mw.h5 --force
        romrun --allow-untrusted scene.yml --model mw.h5 -o red.h5 --force
        close_to "$(number red.h5 central_film_thickness)" \
            "$(number full.h5 central_film_thickness)" 0.005
    done
    refuse 64 "--plan: found none with --weight row-norm, expected the plan of the training" \
        podbuild s.h5 -o x.h5 --weight row-norm
    refuse 64 "--plan: found plan.yml with --weight mode, expected none" \
        podbuild s.h5 -o x.h5 --plan plan.yml
    refused 64 "--weight: found sqrt, expected one of --help" podbuild s.h5 -o x.h5 --weight sqrt
    sed 's/8, 11, 15/7, 10/; s/2, 4, 6/3/' plan.yml >other.yml
    refuse 65 "other.yml: --plan: found none of the stationary training points, expected the plan" \
        podbuild s.h5 -o x.h5 --weight row-norm --plan other.yml
    sed 's/step: 0.05/step: 0.1/' base.yml >coarse.yml
    sed 's/base.yml/coarse.yml/' plan.yml >other.yml
    refuse 65 "other.yml: " podbuild s.h5 -o x.h5 --weight row-norm --plan other.yml
}

@test "the same input gives the same bits, whatever --jobs" {
    podbuild s.h5 -o b2.h5
    same_data b.h5 b2.h5
    snapgen plan.yml --basis b.h5 -o r2.h5 --jobs 1
    snapgen plan.yml --basis b.h5 -o r3.h5 --jobs 5
    same_data r2.h5 r3.h5
    deimselect --no-check r.h5 --basis b.h5 -o m2.h5
    same_data m.h5 m2.h5
}

@test "a result of fullrun is a snapshot too" {
    run --separate-stderr podbuild full.h5 s.h5 -o x.h5
    [ "$status" -eq 0 ]
    [[ $output == "10 states on 121 nodes"* ]]
    [[ $(h5dump -d state_moes_M x.h5) == *"(0): 12, 8, 8, 8, 11,"* ]]
    fullrun scene.yml -o bare.h5 --set output.fields=false
    refused 65 "bare.h5: found no dataset pressure" podbuild bare.h5 -o y.h5
    [ ! -e y.h5 ]
}

@test "--against prints the deviations" {
    run --separate-stderr romrun --allow-untrusted scene.yml --model m.h5 --against full.h5
    [ "$status" -eq 0 ]
    [[ $output =~ "against full.h5:" ]]
    [[ $output =~ "central film thickness"[^$'\n']*" against "[^$'\n']*"permille" ]]
    [[ $output != *"largest pressure error"* ]]
    run --separate-stderr romrun --allow-untrusted scene.yml --model m.h5 --against full.h5 --set output.fields=true
    [[ $output =~ "largest pressure error"\ *[0-9.]*e-0[3-9] ]]
    # a result of another scene is refused
    fullrun scene.yml -o other.h5 --set moes.M=13
    refuse 65 "other.h5: found a result of M = 13" \
        romrun scene.yml --model m.h5 --against other.h5 -o x.h5
    refuse 66 "none.h5" romrun scene.yml --model m.h5 --against none.h5 -o x.h5
    refuse 65 "b.h5: " romrun scene.yml --model m.h5 --against b.h5 -o x.h5
}

@test "fields only when asked for, and they fit the scalars" {
    romrun --allow-untrusted scene.yml --model m.h5 -o bare.h5
    romrun --allow-untrusted scene.yml --model m.h5 -o red.h5 --set output.fields=true
    /usr/bin/python3 - <<'PYTHON'
import h5py, numpy
with h5py.File("bare.h5") as bare:
    assert "pressure" not in bare and "film_thickness" not in bare and "x" not in bare
with h5py.File("red.h5") as red, h5py.File("full.h5") as full:
    assert red["pressure"].shape == (1, 121)
    numpy.testing.assert_allclose(red["x"], full["x"], atol=1e-12)
    numpy.testing.assert_allclose(red["film_thickness"][0, 80], red["central_film_thickness"][0], rtol=1e-11)
    least = red["film_thickness"][0].min() # at the nodes; the minimum of the result lies between nodes
    assert 0.98 * least < red["minimum_film_thickness"][0] <= least
    numpy.testing.assert_allclose(red["pressure"][0], full["pressure"][0], atol=5e-3)
    numpy.testing.assert_allclose(red["film_thickness"][0], full["film_thickness"][0], atol=2e-3)
    assert (red["pressure"][0, red["x"][...] >= red["exit_position"][0]] == 0).all()
PYTHON
    # fullrun can start from a reduced result
    fullrun scene.yml -o from.h5 --start red.h5
    close_to "$(number from.h5 central_film_thickness)" \
        "$(number full.h5 central_film_thickness)" 1e-8
}

# without_cubature MODEL: makes bad.h5, the model as an older version wrote it
without_cubature() {
    patch "$1" "[f.__delitem__(k) for k in list(f) if k.startswith('cubature') or k == 'moment_jacobian']"
}

# bats test_tags=slow
@test "traction, from few nodes or from fields" {
    sliding_scene >sliding.yml
    fullrun sliding.yml -o slid.h5 --quiet
    without_cubature m.h5
    mv bad.h5 old.h5
    romrun --check old.h5
    romrun sliding.yml --model m.h5 --allow-untrusted -o red.h5 >red.txt
    romrun sliding.yml --model old.h5 --allow-untrusted -o old-red.h5 --quiet
    grep -q "^friction coefficient  *0.0[0-9]*" red.txt
    [ "$(number red.h5 friction_force)" != "$(number old-red.h5 friction_force)" ]
    for name in friction_force friction_coefficient rolling_moment power_loss mean_shear_stress; do
        close_to "$(number old-red.h5 $name)" "$(number slid.h5 $name)" 5e-3
        close_to "$(number red.h5 $name)" "$(number old-red.h5 $name)" 5e-4
    done
    close_to "$(number red.h5 largest_shear_stress)" "$(number old-red.h5 largest_shear_stress)" 5e-3
    # moments are exact, because they are linear in the pressure and an even kernel does no net work
    for name in rolling_moment rolling_resistance; do
        close_to "$(number red.h5 $name)" "$(number old-red.h5 $name)" 1e-9
    done
    shows_no shear_stress_1 fullrun --print red.h5
    romrun sliding.yml --model m.h5 --allow-untrusted -o fields.h5 --quiet --set output.fields=true
    fullrun --print fields.h5 shear_stress_1 >fields.csv
    [ "$(number fields.h5 friction_force)" = "$(number red.h5 friction_force)" ]
    romrun sliding.yml --model m.h5 --fallback full --quiet -o back.h5
    close_to "$(number back.h5 friction_force)" "$(number slid.h5 friction_force)" 1e-7
    # a flat model gives the same bits
    romrun --export m.h5 -o m.ehdrom
    romrun sliding.yml --model m.ehdrom --allow-untrusted -o flat.h5 --quiet
    for name in friction_force mean_shear_stress largest_shear_stress rolling_moment; do
        [ "$(number flat.h5 $name)" = "$(number red.h5 $name)" ]
    done
    # the few nodes are accurate for every size of the model
    for part in "--rows 14" "--pressure-modes 8 --rows 13"; do
        romrun sliding.yml --model m.h5 --allow-untrusted -o red.h5 --quiet --force $part
        romrun sliding.yml --model old.h5 --allow-untrusted -o old-red.h5 --quiet --force $part
        close_to "$(number red.h5 friction_force)" "$(number old-red.h5 friction_force)" 1e-3
        close_to "$(number red.h5 rolling_moment)" "$(number old-red.h5 rolling_moment)" 1e-9
    done
}

# bats test_tags=slow
@test "traction with a basis of its own for the deflection" {
    sliding_scene >sliding.yml
    podbuild s.h5 -o bi.h5 --deformation independent --pressure-modes 8 --deformation-modes 7
    snapgen plan.yml --basis bi.h5 -o ri.h5 --quiet
    deimselect --no-check ri.h5 --basis bi.h5 -o mi.h5 --rows 25
    without_cubature mi.h5
    romrun sliding.yml --model mi.h5 --allow-untrusted -o red.h5 --quiet
    romrun sliding.yml --model bad.h5 --allow-untrusted -o old-red.h5 --quiet
    close_to "$(number red.h5 rolling_moment)" "$(number old-red.h5 rolling_moment)" 1e-9
    # at nodes the film comes from the deformation modes, in fields from the deflection of the pressures
    close_to "$(number red.h5 friction_force)" "$(number old-red.h5 friction_force)" 5e-3
}

# bats test_tags=slow
@test "traction in time, from few nodes or from fields" {
    sliding_scene | sed 's/stationary/transient/' >moving.yml
    echo 'transport: upwind' >>moving.yml
    echo 'transient: {end_time: 0.2, fixed_step: 0.05, load: {law: sine, amplitude: 0.1, period: 1}}' >>moving.yml
    without_cubature m.h5
    romrun moving.yml --model m.h5 --allow-untrusted -o red.h5 --quiet
    romrun moving.yml --model bad.h5 --allow-untrusted -o old-red.h5 --quiet
    romrun moving.yml --model m.h5 --allow-untrusted -o fields.h5 --quiet --set output.fields=true
    /usr/bin/python3 - <<'PYTHON'
import h5py, numpy
red, old, fields = (h5py.File(name) for name in ("red.h5", "old-red.h5", "fields.h5"))
for name in ("friction_force", "friction_coefficient", "power_loss", "mean_shear_stress"):
    assert (red[name][...] != old[name][...]).any()
    numpy.testing.assert_allclose(red[name], old[name], rtol=1e-3)
    assert (red[name][...] == fields[name][...]).all()
for name in ("rolling_moment", "rolling_resistance"):
    numpy.testing.assert_allclose(red[name], old[name], rtol=1e-9)
for name in ("central_film_thickness", "minimum_film_thickness", "load", "exit_position"):
    assert (red[name][...] == old[name][...]).all() # traction changes no step
PYTHON
}

# bats test_tags=slow
@test "traction of a point contact, from few nodes or from fields" {
    small_point_model
    sed 's/^  density.*/&\n  shear: {law: eyring, tau0: 5e6}/' point.yml >sliding.yml
    echo 'slide_roll: 0.1' >>sliding.yml
    without_cubature p.h5
    here=(--set physical.load=7.3 --set physical.speed=0.9 --allow-untrusted --quiet)
    for law in eyring newtonian; do
        sed -i "s/shear: .*/shear: {law: $law}/; s/law: eyring/&, tau0: 5e6/" sliding.yml
        romrun sliding.yml --model p.h5 "${here[@]}" -o red.h5 --force
        romrun sliding.yml --model bad.h5 "${here[@]}" -o old-red.h5 --force
        [ "$(number red.h5 friction_force)" != "$(number old-red.h5 friction_force)" ]
        for name in friction_force mean_shear_stress; do
            close_to "$(number red.h5 $name)" "$(number old-red.h5 $name)" 3e-4
        done
        close_to "$(number red.h5 rolling_moment)" "$(number old-red.h5 rolling_moment)" 1e-9
        close_to "$(number red.h5 rolling_resistance)" "$(number old-red.h5 rolling_resistance)" 1e-9
    done
}

# bats test_tags=slow
@test "altered weights of the traction are refused" {
    for value in -1.0 "float('nan')" "float('inf')"; do
        for name in cubature_friction cubature_dry; do
            patch m.h5 "f['$name'][3] = $value"
            refuse 65 "bad.h5: $name" romrun --check bad.h5
            refuse 65 "bad.h5: $name" romrun scene.yml --model bad.h5 -o x.h5
        done
    done
    patch m.h5 "f['cubature_node_index'][3] = f['cubature_node_index'][2]"
    refuse 65 "bad.h5: cubature_node_index" romrun --check bad.h5
    patch m.h5 "f.__delitem__('cubature_dry')"
    refuse 65 "bad.h5: found no dataset cubature_dry" romrun --check bad.h5
    # a weight that is valid but changed is found by the digest
    cp m.h5 other.h5
    /usr/bin/python3 -c "
import h5py
with h5py.File('other.h5', 'r+') as f: f['cubature_friction'][3] *= 2"
    refuse 65 "other.h5: " romrun --check other.h5
}

@test "the first modes and rows of a model" {
    run --separate-stderr romrun --allow-untrusted scene.yml --model m.h5 --pressure-modes 8 --rows 13 -o red.h5
    [ "$status" -eq 0 ]
    close_to "$(number red.h5 central_film_thickness)" \
        "$(number full.h5 central_film_thickness)" 0.05
    refuse 65 "--pressure-modes: found 10, expected at most the 9 stored in m.h5" \
        romrun scene.yml --model m.h5 --pressure-modes 10 -o x.h5
    refuse 65 "--rows: found 8 rows, expected at least 9: the model has 10 unknowns, of which the load" \
        romrun scene.yml --model m.h5 --rows 8 -o x.h5
    refuse 65 "--rows: found 1000, expected at most" \
        romrun scene.yml --model m.h5 --rows 1000 -o x.h5
}

# Method joint is greedy: a selection of fewer rows is the beginning of a larger selection, but has weights of its own.
# bats test_tags=slow
@test "the first rows of a model weigh as if selected alone" {
    run --separate-stderr deimselect --no-check r.h5 --basis b.h5 -o few.h5 --rows 14
    [ "$status" -eq 0 ]
    romrun --allow-untrusted scene.yml --model few.h5 -o few-red.h5
    romrun --allow-untrusted scene.yml --model m.h5 --rows 14 -o red.h5
    close_to "$(number red.h5 central_film_thickness)" \
        "$(number few-red.h5 central_film_thickness)" 1e-12
    # the weights of the larger selection differ; a file without row_jacobian_modes has only the weights of the larger
    # selection
    patch m.h5 "del f['row_jacobian_modes']"
    romrun --allow-untrusted scene.yml --model bad.h5 --rows 14 -o old-red.h5
    far_from "$(number old-red.h5 central_film_thickness)" \
        "$(number red.h5 central_film_thickness)" 1e-9
}

# bats test_tags=slow
@test "every kind of file opens with h5py, xarray and ncdump" {
    romrun --allow-untrusted scene.yml --model m.h5 -o red.h5
    podbuild s.h5 -o bi.h5 --deformation independent --pressure-modes 8 --deformation-modes 7
    snapgen plan.yml --basis bi.h5 -o ri.h5 --quiet
    deimselect --no-check ri.h5 --basis bi.h5 -o mi.h5
    for file in b r m red bi ri mi; do
        run "$BATS_TEST_DIRNAME/open_elsewhere.py" $file.h5
        echo "$file: $output"
        [ "$status" -ne 2 ] || skip "a reader is not installed"
        [ "$status" -eq 0 ]
    done
}

@test "each output has the history of all stages before it" {
    romrun --allow-untrusted scene.yml --model m.h5 -o red.h5
    history=$(h5dump -a history red.h5)
    for stage in "snapgen plan.yml -o s.h5" "podbuild s.h5" "--basis b.h5 -o r.h5" "deimselect --no-check r.h5" \
        "romrun --allow-untrusted scene.yml"; do
        [[ $history == *"$stage"* ]] || { echo "no $stage in $history"; return 1; }
    done
}

# ---- the trained range, and points that fail

# bats test_tags=slow
@test "a scene outside of the trained range is solved, flagged, and exit 4" {
    run --separate-stderr romrun scene.yml --model m.h5 -o red.h5 --set moes.M=16
    [ "$status" -eq 4 ]
    [[ $stderr == "romrun: scene.yml: found outside of the trained range"* ]]
    [ "${#stderr_lines[@]}" -eq 1 ]
    [[ $output == *"central film thickness"* ]]
    [ "$(number red.h5 status)" = 4.0 ]
    romrun --check red.h5
    fullrun scene.yml -o far.h5 --set moes.M=16
    close_to "$(number red.h5 central_film_thickness)" \
        "$(number far.h5 central_film_thickness)" 0.05
    run --separate-stderr romrun scene.yml --model m.h5 -o ok.h5 --set moes.M=16 --allow-untrusted --quiet
    [ "$status" -eq 0 ]
    [ -z "$stderr" ]
    [ "$(number ok.h5 status)" = 4.0 ]
    # a flagged result is no training state
    refuse 65 "red.h5: found no" podbuild red.h5 -o x.h5
}

# bats test_tags=slow
@test "a point that does not converge is left out, and the bases are built of the rest" {
    cat >failing.yml <<'YAML'
groups:
  - scene: base.yml
    vary: {moes.M: [1, 8, 10, 12], moes.L: [1, 3]}
YAML
    run --separate-stderr snapgen failing.yml -o f.h5 --set grid.x_max=1.1 --quiet
    [ "$status" -eq 3 ]
    [[ $stderr == *"point M=1 L=1: not converged: "* ]]
    [[ ${stderr_lines[-1]} == *"failing.yml: found 2 of 8 points not converged"* ]]
    run snapgen failing.yml -o f.h5 --set grid.x_max=1.1 --quiet --force --allow-failures 1
    [ "$status" -eq 3 ]
    run snapgen failing.yml -o f.h5 --set grid.x_max=1.1 --quiet --force --allow-failures 2
    [ "$status" -eq 0 ]
    run --separate-stderr podbuild f.h5 -o fb.h5
    [ "$status" -eq 0 ]
    [[ $output == "6 states on 103 nodes, 2 left out that had not converged"* ]]
    run --separate-stderr snapgen failing.yml --basis fb.h5 -o fr.h5 --set grid.x_max=1.1 --quiet
    [ "$status" -eq 0 ]
    [[ $output =~ "8 points with the projected system, "([0-9])" converged" ]]
    lost=$((8 - BASH_REMATCH[1]))
    ((lost > 0))
    # an iterate that diverges would dominate all others, so the iterates of failed points are left out
    /usr/bin/python3 -c "
import h5py
assert len(set(h5py.File('fr.h5')['iteration_state'][...])) == 8 - $lost"
    # --allow-failures of the first stage is accepted here too, and limits the points that may fail
    snapgen failing.yml --basis fb.h5 -o limited.h5 --set grid.x_max=1.1 --quiet --allow-failures $lost
    same_data fr.h5 limited.h5
    run --separate-stderr snapgen failing.yml --basis fb.h5 -o limited.h5 --set grid.x_max=1.1 \
        --quiet --force --allow-failures $((lost - 1))
    [ "$status" -eq 3 ]
    [[ $stderr == *"failing.yml: found $lost of 8 points not converged, expected at most"* ]]
    deimselect --no-check fr.h5 --basis fb.h5 -o fm.h5
    romrun --allow-untrusted scene.yml --model fm.h5 --set grid.x_max=1.1 --set moes.M=9 --set moes.L=2
}

@test "a file without any converged state is refused" {
    patch s.h5 "f['status'][...] = 1"
    refuse 65 "bad.h5: found no converged state" podbuild bad.h5 -o x.h5
}

# ---- files that do not fit

@test "more modes than snapshots, fewer rows than unknowns" {
    refuse 65 "s.h5: .*found 10, expected at most 9" podbuild s.h5 -o x.h5 --pressure-modes 10
    refuse 65 "s.h5: .*found 10, expected at most 9" \
        podbuild s.h5 -o x.h5 --deformation independent --deformation-modes 10
    refuse 65 "--rows: found 8 rows, expected at least 9: the model has 10 unknowns, of which the load" \
        deimselect r.h5 --basis b.h5 -o x.h5 --rows 8
    refuse 65 "--rows: found 122, expected at most the 121" \
        deimselect r.h5 --basis b.h5 -o x.h5 --rows 122
    for method in joint qr; do
        refuse 65 "--rows: found 120, expected at most .*, as many as the snapshots of the" \
            deimselect r.h5 --basis b.h5 -o x.h5 --rows 120 --method $method
    done
}

@test "rows by default: two a mode, or as many as the snapshots tell apart" {
    sed 's/vary:.*/vary: {moes.M: [8, 11, 15], moes.L: [4]}/' plan.yml >one.yml
    snapgen one.yml --basis b.h5 -o one.h5 --quiet
    run --separate-stderr deimselect --no-check one.h5 --basis b.h5 -o x.h5 --rows 120
    most=$(sed 's/.*at most \([0-9]*\),.*/\1/' <<<"$stderr")
    echo "$most"
    ((most < 18))
    [ "$(deimselect --no-check one.h5 --basis b.h5 -o m2.h5 | awk 'NR == 1 { print $1 }')" -eq "$most" ]
    [ "$(deimselect --no-check r.h5 --basis b.h5 -o m3.h5 | awk 'NR == 1 { print $1 }')" -eq 18 ]
    # too few residuals for the modes: the message has the cause and a remedy
    sed 's/vary:.*/vary: {moes.M: [8], moes.L: [4]}/' plan.yml >few.yml
    snapgen few.yml --basis b.h5 -o few.h5 --quiet
    refuse 65 "few.h5: .*: found enough for [0-9] rows, expected 9, one for each pressure mode.*podbuild --energy" \
        deimselect --no-check few.h5 --basis b.h5 -o x.h5
}

@test "files of different grids" {
    fullrun scene.yml -o fine.h5 --set grid.step=0.04
    refuse 65 "fine.h5: x: found 151 nodes .*expected 121 .*as in s.h5" podbuild s.h5 fine.h5 -o x.h5
    podbuild fine.h5 -o fb.h5
    refuse 65 "fb.h5: x: found 151 nodes .*expected 121 .*as in plan.yml" \
        snapgen plan.yml --basis fb.h5 -o x.h5
    refuse 65 "r.h5: x: found 121 nodes .*expected 151 .*as in fb.h5" \
        deimselect r.h5 --basis fb.h5 -o x.h5
    refuse 65 "found a line contact with 151 nodes .*with 121 .*as in m.h5" \
        romrun scene.yml --model m.h5 -o x.h5 --set grid.step=0.04
    # this grid has the same number of nodes, at other places
    refuse 65 "found a line contact with 121 nodes from -3.95 .*as in m.h5" \
        romrun scene.yml --model m.h5 -o x.h5 --set grid.x_min=-3.95 --set grid.x_max=2.05
    # far outside of the training, the message gives this as the reason, not the place where the iteration failed
    run -3 --separate-stderr romrun scene.yml --model m.h5 --set moes.M=300
    [[ $stderr == "romrun: scene.yml: found outside of the trained range of M and alpha p_H: "*", expected convergence" ]]
    # a contact of another kind is refused before its millions of nodes are made
    refuse 65 "scene.yml: contact: found point, expected line as in m.h5" \
        romrun scene.yml --model m.h5 -o x.h5 --set contact=point --set grid.step=0.001
}

# bats test_tags=slow
@test "residuals of another basis, and a model of another contact" {
    podbuild s.h5 -o other.h5 --pressure-modes 8
    refuse 65 "r.h5: basis_sha256: found .*of other.h5: they were made with another basis" \
        deimselect r.h5 --basis other.h5 -o x.h5
    patch m.h5 "f.attrs['contact'] = 'point'"
    refuse 65 "bad.h5: y: found 0 lines, expected several, of a point contact" romrun scene.yml --model bad.h5 -o x.h5
    patch b.h5 "f.attrs['deformation'] = 'both'"
    refuse 65 "bad.h5: deformation: found both, expected independent.coupled" \
        snapgen plan.yml --basis bad.h5 -o x.h5
}

# bats test_tags=slow
@test "a file of another kind or of a newer schema" {
    refuse 65 "b.h5: " podbuild b.h5 -o x.h5
    refuse 65 "s.h5: " snapgen plan.yml --basis s.h5 -o x.h5
    refuse 65 "s.h5: " deimselect s.h5 --basis b.h5 -o x.h5
    refuse 65 "r.h5: " deimselect r.h5 --basis r.h5 -o x.h5
    refuse 65 "b.h5: " romrun scene.yml --model b.h5 -o x.h5
    newer="f.attrs['schema_version'] = '3.0'"
    patch s.h5 "$newer"
    refuse 65 "bad.h5: schema_version: found 3.0, expected at most 2" podbuild bad.h5 -o x.h5
    patch b.h5 "$newer"
    refuse 65 "bad.h5: schema_version: found 3.0, expected at most 2" snapgen plan.yml --basis bad.h5 -o x.h5
    patch r.h5 "$newer"
    refuse 65 "bad.h5: schema_version: found 3.0, expected at most 2" deimselect bad.h5 --basis b.h5 -o x.h5
    patch m.h5 "$newer"
    refuse 65 "bad.h5: schema_version: found 3.0, expected at most 2" romrun scene.yml --model bad.h5 -o x.h5
    # a newer minor version is accepted
    patch m.h5 "f.attrs['schema_version'] = '2.9'"
    romrun --allow-untrusted scene.yml --model bad.h5
}

# damaged FILE DATASET COMMAND...: checks that the command refuses bad.h5: a copy of FILE cut off in several places,
# random bytes, or a copy with one flipped bit of DATASET
damaged() {
    local file=$1 dataset=$2 size part
    shift 2
    size=$(stat -c %s "$file")
    for part in 0 1 8 500 $((size / 2)) $((size - 1)); do
        head -c "$part" "$file" >bad.h5
        refuse 65 "bad.h5: " "$@"
    done
    head -c 5000 /dev/urandom >bad.h5
    refuse 65 "bad.h5: " "$@"
    /usr/bin/python3 - "$file" "$dataset" <<'PYTHON'
import sys, h5py
with h5py.File(sys.argv[1]) as file:
    place = file[sys.argv[2]].id.get_chunk_info(0).byte_offset + 30
data = bytearray(open(sys.argv[1], "rb").read())
data[place] ^= 4
open("bad.h5", "wb").write(data)
PYTHON
    refuse 65 "bad.h5: .*$dataset" "$@"
}

# bats test_tags=slow
@test "truncated, empty, foreign and bit-flipped files" {
    damaged s.h5 pressure podbuild bad.h5 -o x.h5
    damaged b.h5 pressure_basis snapgen plan.yml --basis bad.h5 -o x.h5 --quiet
    damaged r.h5 weighted_residual deimselect bad.h5 --basis b.h5 -o x.h5
    damaged b.h5 weight deimselect r.h5 --basis bad.h5 -o x.h5
    damaged m.h5 needed_pressure_basis romrun scene.yml --model bad.h5 -o x.h5
    refuse 66 "none.h5" podbuild none.h5 -o x.h5
    refuse 66 "none.h5" snapgen plan.yml --basis none.h5 -o x.h5
    refuse 66 "none.h5" deimselect none.h5 --basis b.h5 -o x.h5
    refuse 66 "none.h5" romrun scene.yml --model none.h5 -o x.h5
}

# bats test_tags=slow
@test "values that no solver could have found" {
    patch s.h5 "f['pressure'][2, 60] = numpy.nan"
    refuse 65 "bad.h5: pressure: found nan, expected a number that is finite" podbuild bad.h5 -o x.h5
    patch b.h5 "f['weight'][3] = numpy.nan"
    refuse 65 "bad.h5: weight: found nan, expected above 0" \
        snapgen plan.yml --basis bad.h5 -o x.h5
    patch r.h5 "f['weighted_jacobian_step'][3, 5] = numpy.inf"
    refuse 65 "weighted_jacobian_step: found inf, expected a number that is finite" deimselect bad.h5 --basis b.h5 -o x.h5
    patch m.h5 "f['band_pressure_basis'][3, 5] = numpy.nan"
    refuse 65 "bad.h5: band_pressure_basis" romrun scene.yml --model bad.h5 -o x.h5
    patch m.h5 "f['selected_row'][3] = 5000"
    refuse 65 "bad.h5: selected_row: found 5000, expected 0 to 120" \
        romrun scene.yml --model bad.h5 -o x.h5
    patch m.h5 "del f['load_jacobian']"
    refuse 65 "bad.h5: .*load_jacobian" romrun scene.yml --model bad.h5 -o x.h5
}

# bats test_tags=slow
@test "a basis by somebody else's program, with only what it must have" {
    /usr/bin/python3 - <<'PYTHON'
import h5py, numpy
with h5py.File("s.h5") as s:
    pressure = s["pressure"][...]
    states = {name: s[name][...] for name in ["rigid_approach", "moes_M", "alpha_p_H"]}
    exits, x = s["exit_node"][...], s["x"][...]
modes = numpy.linalg.svd(pressure, full_matrices=False)[2]
with h5py.File("foreign.h5", "w") as f:
    f.attrs["schema_name"] = "ehdrom-basis"
    f.attrs["schema_version"] = "1.0"
    f.attrs["complete"] = 1
    f.attrs["contact"] = "line"
    f.attrs["x_min"], f.attrs["step"] = x[0], 0.05
    f.attrs["deformation"] = "coupled"
    f["pressure_basis"] = modes
    f["weight"] = numpy.maximum(abs(modes[0]), 1e-3 * abs(modes[0]).max())
    f["state_pressure"] = pressure @ modes.T
    f["state_exit_node"] = exits
    for name, values in states.items():
        f["state_" + name] = values
PYTHON
    refuse 65 "foreign.h5: discretization: found published, expected accurate, as in plan.yml" \
        snapgen plan.yml --basis foreign.h5 -o x.h5
    /usr/bin/python3 -c 'import h5py; a = h5py.File("foreign.h5", "r+").attrs; a["discretization"] = "accurate"; a.pop("content_sha256", None)'
    run --separate-stderr snapgen plan.yml --basis foreign.h5 -o fr.h5 --quiet
    echo "$stderr"
    [ "$status" -eq 0 ]
    [[ $output == *"9 converged"* ]]
    deimselect --no-check fr.h5 --basis foreign.h5 -o fm.h5
    romrun --allow-untrusted scene.yml --model fm.h5 -o red.h5
    close_to "$(number red.h5 central_film_thickness)" \
        "$(number full.h5 central_film_thickness)" 0.002
}

# ---- outputs

@test "an existing output is kept, and replaced only with --force" {
    echo precious >x.h5
    for command in "podbuild s.h5" "snapgen plan.yml --basis b.h5 --quiet" \
        "deimselect --no-check r.h5 --basis b.h5" "romrun --allow-untrusted scene.yml --model m.h5"; do
        refused 73 "x.h5: found an existing file" $command -o x.h5
        [ "$(cat x.h5)" = precious ]
        refused 73 "none/x.h5" $command -o none/x.h5
        cp x.h5 y.h5
        $command -o y.h5 --force
        fullrun --check y.h5
    done
}

@test "a refused input leaves an existing output as it was, also with --force" {
    echo precious >x.h5
    refused 65 "rank" podbuild s.h5 -o x.h5 --force --pressure-modes 10
    refused 65 "rows" deimselect r.h5 --basis b.h5 -o x.h5 --force --rows 3
    refused 65 "m.h5" snapgen plan.yml --basis m.h5 -o x.h5 --force
    refused 65 "grid" romrun scene.yml --model m.h5 -o x.h5 --force --set grid.step=0.04
    [ "$(cat x.h5)" = precious ]
    [ ! -e x.h5.partial ]
}

@test "a full disk is 74, and an existing output stays" {
    echo precious >x.h5
    limited() {
        (ulimit -f 4 && "$@")
    }
    for command in "podbuild s.h5" "snapgen plan.yml --basis b.h5 --quiet" \
        "deimselect --no-check r.h5 --basis b.h5" "romrun --allow-untrusted --quiet scene.yml --model m.h5"; do
        run --separate-stderr limited $command -o x.h5 --force
        echo "$command: $status $stderr"
        [ "$status" -eq 74 ]
        [ "${#stderr_lines[@]}" -eq 1 ]
        [[ $stderr == "${command%% *}: x.h5"* ]]
        [ "$(cat x.h5)" = precious ]
    done
}

# bats test_tags=slow
@test "Ctrl-C during snapgen --basis leaves nothing" {
    cat >slow.yml <<'YAML'
groups:
  - scene: base.yml
    vary: {moes.M: [8, 9, 10, 11, 12, 13, 14, 15], moes.L: [2, 2.5, 3, 3.5, 4, 4.5, 5, 5.5, 6]}
YAML
    snapgen plan.yml -o fine.h5 --quiet --set grid.step=0.0005
    podbuild fine.h5 -o fb.h5
    stop_when INT exists x.h5 \
        snapgen slow.yml --basis fb.h5 -o x.h5 --quiet --set grid.step=0.0005 --jobs 1
    [ "$code" -eq 130 ]
    [ ! -e x.h5 ]
    [ ! -e x.h5.partial ]
}

# ---- the command line

# bats test_tags=slow
@test "misuse is one line and exit 64" {
    refuse 64 "--model" romrun scene.yml -o x.h5
    refuse 64 "SCENE.yml" romrun --model m.h5 -o x.h5
    refuse 64 "--basis: found none" deimselect r.h5 -o x.h5
    refuse 64 "--method: found magic" deimselect r.h5 --basis b.h5 -o x.h5 --method magic
    refuse 64 "--deformation: found both" podbuild s.h5 -o x.h5 --deformation both
    refuse 64 "SNAPSHOTS" podbuild -o x.h5
    refuse 64 "output" podbuild s.h5
    refuse 64 "output" deimselect r.h5 --basis b.h5
    refuse 64 "--resume" snapgen plan.yml --basis b.h5 -o x.h5 --resume
    for number in 0 -1 x 1e3 2.5 '' 99999999999999999999; do
        refuse 64 "--pressure-modes: found" podbuild s.h5 -o x.h5 "--pressure-modes=$number"
        refuse 64 "--deformation-modes: found" podbuild s.h5 -o x.h5 "--deformation-modes=$number"
        refuse 64 "--rows: found" deimselect r.h5 --basis b.h5 -o x.h5 "--rows=$number"
        refuse 64 "--rows: found" romrun scene.yml --model m.h5 -o x.h5 "--rows=$number"
        refuse 64 "--repeat: found" romrun scene.yml --model m.h5 -o x.h5 "--repeat=$number"
    done
    for number in -1 1 nan inf x 1e-1O ''; do
        refuse 64 "--energy: found" podbuild s.h5 -o x.h5 "--energy=$number"
    done
}

@test "--help and --version" {
    for name in podbuild deimselect romrun; do
        run --separate-stderr $name --help
        [ "$status" -eq 0 ]
        [ -z "$stderr" ]
        [[ $output == *"--output"* ]]
        run --separate-stderr $name --version
        [ "$status" -eq 0 ]
    done
    run deimselect --help
    [[ $output == *joint* && $output == *qr* ]]
}

# ---- inputs are never replaced

@test "an input is no output, not even with --force" {
    cp scene.yml before.yml
    refuse 73 "scene.yml: found an input as output" fullrun scene.yml -o scene.yml --force
    cmp scene.yml before.yml
    cp m.h5 mine.h5
    refuse 73 "mine.h5: found an input as output" romrun scene.yml --model mine.h5 -o mine.h5 --force
    cmp m.h5 mine.h5
    ln -s before.yml linked.h5.partial
    refuse 73 "linked.h5.partial: found" fullrun scene.yml -o linked.h5
    cmp scene.yml before.yml
}

@test "options that do not go together are refused" {
    refuse 64 "--basis: found with --shard" snapgen plan.yml --basis b.h5 --shard 1/2 -o x.h5
    refuse 64 "--shard: found with --adaptive" snapgen plan.yml --adaptive --shard 1/2 -o x.h5
    refuse 64 "--deformation-modes: found 3 with a coupled basis" \
        podbuild s.h5 --deformation-modes 3 -o x.h5
}

@test "Ctrl-C ends a repeated solution and leaves nothing" {
    stop_when INT exists x.h5 romrun scene.yml --model m.h5 -o x.h5 --repeat 1000000 >log 2>&1
    [ "$code" -eq 130 ]
    [ ! -e x.h5 ]
    [ ! -e x.h5.partial ]
}
