#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests of the discretisations of a scene: their films, and that files made with one discretisation are refused with
# another.

load common

setup() { common_setup; }

published=(--set discretization=published)

# train PLAN OPTION...: trains m.h5 with modes that leave out 1e-18 of the energy
train() {
    local plan=$1
    shift
    snapgen "$plan" -o s.h5 --force --quiet "$@" >/dev/null
    podbuild s.h5 -o b.h5 --force --energy 1e-18 --quiet >/dev/null
    snapgen "$plan" --basis b.h5 -o r.h5 --force --quiet "$@" >/dev/null
    deimselect --no-check r.h5 --basis b.h5 -o m.h5 --force --quiet >/dev/null
}

# bats test_tags=slow
@test "the accurate rows are near the solution of the equations on a coarse grid" {
    sed -i 's/^moes: .*/moes: {M: 20, L: 10}/; s/law: dowson-higginson/law: incompressible/' scene.yml
    fullrun scene.yml -o published.h5 --quiet "${published[@]}" >published.txt
    fullrun scene.yml -o accurate.h5 --quiet >accurate.txt
    # the expected films are grid-converged, extrapolated from steps of 0.005 and 0.0025
    close_to "$(number accurate.h5 central_film_thickness)" 0.103316 1e-4
    close_to "$(number accurate.h5 minimum_film_thickness)" 0.077878 1e-3
    far_from "$(number published.h5 central_film_thickness)" 0.103316 5e-3
    # the accurate rows are the default, and the output names them
    grep -qx "discretization          accurate" accurate.txt
    grep -qx "discretization          published" published.txt
    [ "$(fullrun --print accurate.h5 discretization)" = $'discretization\naccurate' ]
    [ "$(fullrun --print published.h5 discretization)" = $'discretization\npublished' ]

    point_scene 20 -4
    fullrun scene.yml -o point.h5 --quiet >point.txt
    grep -qx "discretization          accurate" point.txt
    fullrun scene.yml -o fine.h5 --quiet --set grid.step=0.03125 >/dev/null
    close_to "$(number point.h5 central_film_thickness)" "$(number fine.h5 central_film_thickness)" 3e-3
}

# bats test_tags=slow
@test "a reduced model follows the accurate full model, line and point, coupled and independent" {
    train plan.yml
    [ "$(romrun --print m.h5 discretization)" = $'discretization\naccurate' ]
    # at a training point the reduced model gives the film of the full model
    for deformation in coupled independent; do
        podbuild s.h5 -o b.h5 --force --deformation $deformation --energy 1e-20 --quiet >/dev/null
        snapgen plan.yml --basis b.h5 -o r.h5 --force --quiet >/dev/null
        deimselect --no-check r.h5 --basis b.h5 -o m.h5 --force --quiet >/dev/null
        fullrun scene.yml -o f.h5 --force --quiet --set moes.M=12 --set moes.L=5 >/dev/null
        romrun --allow-untrusted scene.yml --model m.h5 -o x.h5 --force --quiet --set moes.M=12 --set moes.L=5 >/dev/null
        close_to "$(number x.h5 central_film_thickness)" "$(number f.h5 central_film_thickness)" 1e-4
        close_to "$(number x.h5 exit_position)" "$(number f.h5 exit_position)" 1e-5
    done
    # the exit lies between nodes, and a run that starts from the result finds the same exit
    awk -v x="$(number f.h5 exit_position)" 'BEGIN { node = (x + 4) / 0.02; exit !(node % 1 > 0.01 && node % 1 < 0.99) }'
    fullrun scene.yml --start f.h5 -o again.h5 --quiet --set moes.M=12 --set moes.L=5 >/dev/null
    close_to "$(number again.h5 exit_position)" "$(number f.h5 exit_position)" 1e-9
    [ "$(number again.h5 newton_iterations)" = 1.0 ] || [ "$(number again.h5 newton_iterations)" = 2.0 ]

    point_scene 15 -4
    sed -i 's/step: 0.125/step: 0.25/' scene.yml
    printf 'groups:\n  - scene: scene.yml\n    vary: {moes.M: [10, 14, 20], moes.L: [4, 6]}\n' >point-plan.yml
    train point-plan.yml
    fullrun scene.yml --allow-untrusted -o f.h5 --force --quiet --set moes.M=14 --set moes.L=4 >/dev/null
    romrun scene.yml --allow-untrusted --model m.h5 -o x.h5 --force --quiet --set moes.M=14 --set moes.L=4 >/dev/null
    close_to "$(number x.h5 central_film_thickness)" "$(number f.h5 central_film_thickness)" 1e-3
}

@test "in time too, and the reduced model says which it has" {
    sed -i -e 's/stationary/transient/' -e '$a transient: {load: {law: sine, amplitude: 0.1, period: 1}, end_time: 0.1, fixed_step: 0.02}' scene.yml
    fullrun scene.yml -o t.h5 --quiet >t.txt
    grep -qx "discretization          accurate" t.txt
    [ "$(fullrun --print t.h5 discretization)" = $'discretization\naccurate' ]
    train scene.yml "${published[@]}"
    romrun --allow-untrusted scene.yml --model m.h5 -o x.h5 --quiet "${published[@]}" >x.txt
    grep -qx "discretization          published" x.txt
    [ "$(romrun --print x.h5 discretization)" = $'discretization\npublished' ]
}

# bats test_tags=slow
@test "files of one discretisation are refused with the other" {
    train plan.yml "${published[@]}"
    cp s.h5 published.h5
    refuse 65 "discretization: found accurate, expected published as in m.h5" \
        romrun scene.yml --model m.h5 -o x.h5
    refuse 65 "discretization: found .*, expected .*, as in" snapgen plan.yml --basis b.h5 -o x.h5
    snapgen plan.yml -o s.h5 --force --quiet >/dev/null
    refuse 65 "published.h5: discretization: found published, expected accurate, as in s.h5" podbuild s.h5 published.h5 -o x.h5
    fullrun scene.yml -o start.h5 --quiet "${published[@]}" >/dev/null
    refuse 65 "start.h5: discretization: found published, expected accurate, as in the scene" \
        fullrun scene.yml --start start.h5 -o x.h5
    refuse 65 "discretization: found exact, expected accurate.cross-flux.published" fullrun scene.yml -o x.h5 --set discretization=exact

    # a file without the attribute, such as those of 0.1.0, has the published discretisation
    patch published.h5 "del f.attrs['discretization']"
    podbuild bad.h5 -o old.h5 --energy 1e-18 --quiet >/dev/null
    [ "$(podbuild --print old.h5 discretization)" = $'discretization\npublished' ]
    patch s.h5 "f.attrs['discretization'] = 'exact'"
    refuse 65 "bad.h5: discretization: found exact, expected accurate.cross-flux.published" podbuild bad.h5 -o x.h5
}

# forget FILE: makes a file of a run with published rows look like a file of a version before 0.3.0
forget() {
    /usr/bin/python3 - "$1" <<'PYTHON'
import sys, h5py
with h5py.File(sys.argv[1], "r+") as f:
    f.attrs.pop('content_sha256', None)
    text = f.attrs["settings"]
    text = text.decode() if isinstance(text, bytes) else text
    assert "discretization: published\n" in text
    f.attrs["settings"] = text.replace("discretization: published\n", "")
    del f.attrs["discretization"]
PYTHON
}

# bats test_tags=slow
@test "interrupted runs of versions without the key go on with the published rows alone" {
    slow=(snapgen plan.yml --quiet --set grid.step=0.0025 --jobs 1)
    "${slow[@]}" "${published[@]}" -o whole.h5
    stop_when INT 'states >= 2' s.h5 "${slow[@]}" "${published[@]}" -o s.h5 2>/dev/null
    [ "$code" -eq 130 ]
    forget s.h5.partial
    refused 65 "s.h5.partial: found other settings" "${slow[@]}" -o s.h5 --resume
    "${slow[@]}" "${published[@]}" -o s.h5 --resume
    same_data whole.h5 s.h5
    snapgen --check s.h5
}

# bats test_tags=slow
@test "cross fluxes make point contacts and ellipses more accurate, and the reduced model follows" {
    cp scene.yml line.yml
    point_scene 20 -3
    for contact in "point" "ellipse --set ellipticity=0.6"; do
        set -- --set boundary=open --set contact=$contact --force --quiet
        fullrun scene.yml -o fine.h5 "$@" --set grid.step=0.03125 --set discretization=cross-flux >/dev/null
        fullrun scene.yml -o accurate.h5 "$@" --set grid.step=0.125 >/dev/null
        fullrun scene.yml -o crossed.h5 "$@" --set grid.step=0.125 --set discretization=cross-flux >crossed.txt
        grep -qx "discretization          cross-flux" crossed.txt
        far_from "$(number accurate.h5 central_film_thickness)" "$(number fine.h5 central_film_thickness)" 1.5e-3
        close_to "$(number crossed.h5 central_film_thickness)" "$(number fine.h5 central_film_thickness)" 1e-3
    done
    local crossed=(--set discretization=cross-flux --force --quiet)
    sed -i 's/step: 0.125/step: 0.25/' scene.yml
    printf 'groups:\n  - scene: scene.yml\n    vary: {moes.M: [10, 14, 20], moes.L: [4, 6]}\n' >point-plan.yml
    train point-plan.yml "${crossed[@]}"
    fullrun scene.yml --allow-untrusted -o f.h5 --set moes.M=14 --set moes.L=4 "${crossed[@]}" >/dev/null
    romrun scene.yml --allow-untrusted --model m.h5 -o reduced.h5 --set moes.M=14 --set moes.L=4 "${crossed[@]}" >/dev/null
    close_to "$(number reduced.h5 central_film_thickness)" "$(number f.h5 central_film_thickness)" 1e-3
    # with such a model, the library solves only stationary contacts
    if [ "$VARIANT" = release ]; then
        local root=$BATS_TEST_DIRNAME/../..
        make -C "$root" -s python VARIANT="$VARIANT" DEPS=no
        PYTHONPATH=$root/build/$VARIANT/python /usr/bin/python3 -B - <<'PYTHON'
import ehdrom, h5py, math
model = ehdrom.Model("m.h5")
assert not model.info["in_time"]
contact = ehdrom.Contact(model, "scene.yml", accuracy=math.inf, dimensionless=True)
contact["discretization"], contact["moes.M"], contact["moes.L"] = "cross-flux", 14, 4
assert abs(contact.scales()["moes_M"] - 14) < 1e-12
result = contact.solve()
# the grid is coarse on purpose
assert not result.trusted and "too coarse" in result.reason
assert abs(result.central_film_thickness / h5py.File("reduced.h5")["central_film_thickness"][0] - 1) < 1e-9
PYTHON
    fi
    refuse 65 "m.h5: discretization: found cross-flux in time, expected accurate.published" \
        romrun --fmu scene.yml --model m.h5 -o x.fmu
    # only stationary contacts with a flow across may have cross fluxes
    sed -i -e 's/stationary/transient/' -e '$a transient: {end_time: 0.1, fixed_step: 0.02}' scene.yml
    refuse 65 "discretization: found cross-flux of a contact in time, expected accurate.published" \
        fullrun scene.yml -o x.h5 --set discretization=cross-flux
    refuse 65 "discretization: found cross-flux of a line contact, expected accurate.published" \
        fullrun line.yml -o x.h5 --set discretization=cross-flux
}

@test "cross fluxes fade in at the exit, so that Newton's iteration ends" {
    cat >narrow.yml <<'YAML'
contact: ellipse
ellipticity: 0.5
regime: stationary
discretization: cross-flux
moes: {M: 4.83, L: 10}
lubricant: {viscosity: {law: barus, alpha: 20e-9}, density: {law: dowson-higginson}}
grid: {x_min: -4, x_max: 2, step: 0.06, y_max: 3.553}
YAML
    fullrun narrow.yml -o narrow.h5 --quiet >/dev/null
    number narrow.h5 newton_iterations | awk '{ exit !($1 < 20) }'
}
