#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests of the boundary around the grid of a point contact: the far field or zero pressure. Files made with one boundary
# are refused in a run with the other boundary.

load common

zero=(--set boundary=zero)

setup() {
    cd "$BATS_TEST_TMPDIR" || return
    point_scene 15 -2.5
    cat >plan.yml <<'YAML'
groups:
  - scene: scene.yml
    vary: {moes.M: [12, 15, 18], moes.L: [4, 5, 6]}
YAML
}

# train NAME OPTION...: trains NAME.h5, and keeps its inputs NAME-s.h5, NAME-b.h5 and NAME-r.h5
train() {
    local name=$1
    shift
    snapgen plan.yml -o "$name-s.h5" --quiet "$@" >/dev/null
    podbuild "$name-s.h5" -o "$name-b.h5" --energy 1e-18 --quiet >/dev/null
    snapgen plan.yml --basis "$name-b.h5" -o "$name-r.h5" --quiet "$@" >/dev/null
    deimselect --no-check "$name-r.h5" --basis "$name-b.h5" -o "$name.h5" --quiet >/dev/null
}

# bats test_tags=slow
@test "with the far field a short domain does, and results say which they have" {
    long=(--set grid.x_min=-12 --set grid.x_max=4 --set grid.y_max=9)
    fullrun scene.yml --set grid.x_min=-4 --set grid.y_max=3 -o open.h5 >open.txt
    fullrun scene.yml "${long[@]}" -o long.h5 --quiet >/dev/null
    fullrun scene.yml --set grid.x_min=-4 --set grid.y_max=3 "${zero[@]}" -o zero.h5 >zero.txt
    close_to "$(number open.h5 central_film_thickness)" "$(number long.h5 central_film_thickness)" 5e-4
    far_from "$(number zero.h5 central_film_thickness)" "$(number long.h5 central_film_thickness)" 2e-3
    close_to "$(number open.h5 load)" 1 1e-9
    [ "$(fullrun --print open.h5 boundary)" = $'boundary\nopen' ]
    [ "$(fullrun --print zero.h5 boundary)" = $'boundary\nzero' ]
    grep -qx "boundary                open, with the far field around the grid" open.txt
    grep -qx "boundary                zero pressure" zero.txt
}

@test "the effect of the domain is found on steps that are fine enough" {
    cat >short.yml <<'YAML'
contact: point
regime: stationary
moes: {M: 2.984, L: 0}
lubricant: {viscosity: {law: barus, alpha: 2.0e-8}}
grid: {x_min: -4.25, x_max: 2, step: 0.25, y_max: 3.25}
output: {fields: false}
YAML
    fullrun short.yml -o short.h5
    fullrun short.yml --set grid.x_min=-17 --set grid.x_max=8 --set grid.y_max=13 -o wide.h5
    /usr/bin/python3 - <<'PYTHON'
import h5py
short, wide = h5py.File("short.h5"), h5py.File("wide.h5")
here, endless = (file["central_film_thickness"][0] for file in (short, wide))
change, effect = abs(endless / here - 1), short.attrs["inlet_effect"]
assert 1 < effect / change < 1.5, (effect, change)
assert effect + short.attrs["step_effect"] > change, (effect, change)
PYTHON
}

@test "lines have none, and the published rows zero pressure" {
    fullrun scene.yml --set discretization=published -o p.h5 --quiet >/dev/null
    [ "$(fullrun --print p.h5 boundary)" = $'boundary\nzero' ]
    sed -i 's/contact: point/contact: line/; s/, y_max: 2//' scene.yml
    fullrun scene.yml --set grid.x_min=-3 --set grid.step=0.05 -o l.h5 >l.txt
    run -1 grep "^boundary" l.txt
    refuse 65 "boundary" fullrun scene.yml -o x.h5 --set boundary=open
    refuse 65 "boundary: found both, expected open.zero" fullrun scene.yml -o x.h5 --set contact=point --set boundary=both
}

# bats test_tags=slow
@test "a reduced model has it from its training, and follows the full model" {
    train open
    train zero "${zero[@]}"
    for name in open zero; do
        for file in $name-s.h5 $name-b.h5 $name-r.h5 $name.h5; do
            [ "$(romrun --print $file boundary)" = $'boundary\n'$name ]
            romrun --check $file
        done
        fullrun scene.yml --set boundary=$name -o f.h5 --force --quiet >/dev/null
        romrun --allow-untrusted scene.yml --set boundary=$name --model $name.h5 -o y.h5 --force --quiet >/dev/null
        close_to "$(number y.h5 central_film_thickness)" "$(number f.h5 central_film_thickness)" 1e-4
        close_to "$(number y.h5 load)" 1 1e-5
    done
    far_from "$(number y.h5 central_film_thickness)" "$(romrun --allow-untrusted scene.yml --model open.h5 |
        awk '/^central film/ { print $NF }')" 5e-3

    refuse 65 "boundary: found open, expected zero as in zero.h5" romrun scene.yml --model zero.h5 -o x.h5
    refuse 65 "boundary: found zero, expected open as in open.h5" romrun scene.yml "${zero[@]}" --model open.h5 -o x.h5
    refuse 65 "zero-s.h5: boundary: found zero, expected open, as in open-s.h5" podbuild open-s.h5 zero-s.h5 -o x.h5
    refuse 65 "boundary: found .*, expected .*, as in" snapgen plan.yml "${zero[@]}" --basis open-b.h5 -o x.h5
    refuse 65 "zero-r.h5: boundary: found zero, expected open" deimselect zero-r.h5 --basis open-b.h5 -o x.h5
    # a file without the attribute has zero pressure; an unknown value is refused
    /usr/bin/python3 - <<'PYTHON'
import h5py
with h5py.File("zero.h5", "r+") as f:
    f.attrs.pop('content_sha256', None)
    del f.attrs["boundary"]
with h5py.File("open.h5", "r+") as f:
    f.attrs.pop('content_sha256', None)
    f.attrs["boundary"] = "shut"
PYTHON
    romrun --allow-untrusted scene.yml "${zero[@]}" --model zero.h5 -o y.h5 --force --quiet >/dev/null
    refuse 65 "open.h5: boundary: found shut, expected open.zero" romrun scene.yml --model open.h5 -o x.h5
}

@test "points of both are not one plan" {
    cat >two.yml <<'YAML'
groups:
  - scene: scene.yml
    vary: {moes.M: [15], moes.L: [5]}
  - scene: scene.yml
    vary: {moes.M: [18], moes.L: [5], boundary: [zero]}
YAML
    refuse 65 "two.yml: boundary: found zero at point M=18 L=5, expected open as at point M=15 L=5" \
        snapgen two.yml -o x.h5
}

# bats test_tags=slow
@test "in time a contact that does not change stays as it is, in both models" {
    train open
    cat >>scene.yml <<'YAML'
transient: {end_time: 0.4, fixed_step: 0.1, load: {law: sine, amplitude: 0, period: 1}}
YAML
    sed -i 's/stationary/transient/' scene.yml
    fullrun scene.yml -o f.h5 --quiet >/dev/null
    romrun scene.yml --set transport=upwind --model open.h5 -o r.h5 --quiet >/dev/null || [ $? -eq 4 ]
    /usr/bin/python3 - <<'PYTHON'
import h5py
for name, limit in ("f", 1e-8), ("r", 1e-5):
    with h5py.File(f"{name}.h5") as f:
        film, load = f["central_film_thickness"][...], f["load"][...]
        assert f.attrs["boundary"] in ("open", b"open")
    assert len(film) > 3
    assert abs(film / film[0] - 1).max() < limit, (name, film)
    assert abs(load - 1).max() < limit, (name, load)
PYTHON
}
