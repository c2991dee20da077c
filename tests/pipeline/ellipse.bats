#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests of elliptical contacts: scenes, results, SI units, reduced models.

load common

root=$BATS_TEST_DIRNAME/../..

# ellipse_scene ELLIPTICITY: writes scene.yml with 37 nodes along X, and point.yml, a point contact with the same
# numbers.
ellipse_scene() {
    point_scene 20 -3
    grep -v '^output' scene.yml >point.yml
    sed -i -e "s/contact: point/contact: ellipse\nellipticity: $1/" scene.yml
}

# Makes e.yml in SI units with R_y/R_x = 2, and e.h5, a model of nine ellipses around it.
setup_file() {
    cd "$BATS_FILE_TMPDIR" || return
    ellipse_scene 1
    sed -e '/ellipticity/d' -e 's/alpha: .*}/alpha: 1.0e-8}/' -e 's/x_min: -3/x_min: -2.5/' \
        -e 's/^moes:.*/physical: {load: 20, radius: 0.01, radius_across: 0.02, speed: 1, modulus: 220e9, viscosity: 0.08}/' \
        scene.yml >e.yml
    cat >plan.yml <<'YAML'
groups:
  - scene: e.yml
    vary: {physical.load: [17, 20, 24], physical.speed: [0.8, 1, 1.25]}
YAML
    snapgen plan.yml -o s.h5 --quiet
    podbuild s.h5 -o b.h5
    snapgen plan.yml --basis b.h5 -o r.h5 --quiet
    deimselect --no-check r.h5 --basis b.h5 -o e.h5 --rows 60 --method sopt
}

setup() {
    cd "$BATS_TEST_TMPDIR" || return
    ellipse_scene 1.5
    cp "$BATS_FILE_TMPDIR"/{e.yml,e.h5,s.h5,b.h5,r.h5,plan.yml} .
}

# bats test_tags=slow
@test "of ellipticity 1 it has the bits of the point contact" {
    for boundary in open zero; do
        fullrun scene.yml --set ellipticity=1 --set boundary=$boundary -o ellipse.h5 --force
        fullrun point.yml --set boundary=$boundary -o point.h5 --force
        /usr/bin/python3 - <<'PYTHON'
import h5py
ellipse, point = h5py.File("ellipse.h5"), h5py.File("point.h5")
for name in "pressure", "film_thickness", "central_film_thickness", "rigid_approach", "exit_position":
    assert ellipse[name][...].tobytes() == point[name][...].tobytes(), name
assert ellipse.attrs["hertz_pressure"] == point.attrs["hertz_pressure"]
assert ellipse.attrs["ellipticity"] == 1 and "ellipticity" not in point.attrs
PYTHON
    done
    fullrun scene.yml -o other.h5 # another shape has another film
    [ "$(number other.h5 central_film_thickness)" != "$(number ellipse.h5 central_film_thickness)" ]
}

# bats test_tags=slow
@test "the far field does what a longer domain does" {
    films() { # RATIO BOUNDARY X_MIN Y_MAX
        fullrun scene.yml --set ellipticity="$1" --set boundary="$2" --set grid.x_min="$3" --set grid.y_max="$4" \
            --set grid.x_max=2.5 --set lubricant.density.law=incompressible -o x.h5 --force >short || [ $? -eq 4 ] # with boundary=zero the inlet is too short
        number x.h5 central_film_thickness
    }
    for ratio in 0.6 2; do
        open=$(films $ratio open -3 2.5)
        zero=$(films $ratio zero -3 2.5)
        expected=$(films $ratio open -10 8)
        # the far field keeps the film within 0.2 %; with zero pressure around the grid, the film is more than 0.5 % too
        # thin
        /usr/bin/python3 -c "
print($open, $zero, $expected)
assert abs($open / $expected - 1) < 2e-3 and $zero < 0.995 * $expected"
    done
}

# bats test_tags=slow
@test "half and whole domain write the same symmetric fields" {
    half_and_whole_are_symmetric --set boundary=zero # with zero pressure around, the grid carries all of the load
    /usr/bin/python3 - <<'PYTHON'
import h5py, numpy
half = h5py.File("half.h5")
pressure, y = half["pressure"][0], half["y"][...]
assert numpy.allclose(numpy.diff(y), 0.125 / 1.5 ** (1 / 3), rtol=1e-12) and 2 <= y[-1] < 2 + y[1] - y[0]
assert abs(pressure.sum() * 0.125 * (y[1] - y[0]) / (2 * numpy.pi / 3) - 1) < 1e-9
PYTHON
}

@test "Y has the half width across in SI units" {
    cat >si.yml <<'YAML'
contact: ellipse
regime: stationary
physical: {load: 20, radius: 0.01, radius_across: 0.02, speed: 1, modulus: 226e9, viscosity: 0.04}
lubricant: {viscosity: {law: barus, alpha: 15e-9}}
grid: {x_min: -3, x_max: 1.5, y_max: 2, step: 0.125}
YAML
    fullrun si.yml -o si.h5 >short
    fullrun --print si.h5 x --si >table
    fullrun --print si.h5 y --si >>table
    fullrun --vtk si.h5 -o si.vti
    /usr/bin/python3 - <<'PYTHON'
import re, h5py, numpy
file = h5py.File("si.h5")
a, b, k = (file.attrs[name] for name in ("half_width", "half_width_across", "ellipticity"))
assert abs(b / a / k - 1) < 1e-14 and 1.4 < k < 1.7
assert abs(1.5 * 20 / (numpy.pi * a * b) / file.attrs["hertz_pressure"] - 1) < 1e-12
text = open("table").read()
first = file["y"][0]
assert f"{first * b:.5g}"[:6] in text and f"{-3 * a:.5g}"[:6] in text, text
origin, spacing = (
    [float(v) for v in re.search(rb'%s="([^"]*)"' % name, open("si.vti", "rb").read(2000))[1].split()]
    for name in (b"Origin", b"Spacing")
)
assert numpy.allclose(origin[:2], [-3 * a, first * b], rtol=1e-12), origin
assert numpy.allclose(spacing[:2], [a / 8, b / 8 / k ** (1 / 3)], rtol=1e-12), spacing
PYTHON
    grep -q 'b/a = 1\.5.* a = .* µm, b = .* µm' short
}

@test "what has no sense together is refused in a line" {
    refused() {
        run -65 fullrun scene.yml "${@:2}" -o x.h5
        echo "$output"
        [[ $output == *"$1"* ]]
        [ ! -e x.h5 ]
    }
    refused "expected ellipticity or physical.radius_across" --set ellipticity=
    refused "found a value with moes, expected ellipticity" --set physical.radius_across=1
    refused "found a value, expected none with the contact point" --set contact=point
    refused "expected a number from 0.05 to 20" --set ellipticity=30
}

@test "formulas of an ellipse stand beside its solution" {
    run -0 fullrun scene.yml --formulas
    echo "$output"
    [ "$(sed -n 's/^formula \([a-z-]*\) .*/\1/p' <<<"$output" | tr '\n' ' ')" = \
        "nijenbanning hamrock-dowson-central hamrock-dowson-minimum chittenden-central chittenden-minimum " ]
    run -0 fullrun scene.yml --formulas --set ellipticity=0.8
    [ "$(grep -c 'b/a from 1.*, here outside: 0.8$' <<<"$output")" -eq 3 ]
}

@test "a start of another ellipse is refused" {
    fullrun scene.yml -o one.h5
    fullrun scene.yml --start one.h5 -o two.h5
    run -65 fullrun scene.yml --set ellipticity=1.4 --start one.h5 -o x.h5
    [[ $output == *"one.h5: ellipticity: found 1.5, expected 1.4"* ]]
    run -65 fullrun point.yml --start one.h5 -o x.h5
}

# bats test_tags=slow
@test "a reduced model follows the full one between its training" {
    for file in s.h5 b.h5 r.h5 e.h5; do
        snapgen --check $file
        [ "$(/usr/bin/python3 -c "import h5py; print(round(h5py.File('$file').attrs['ellipticity'], 3))")" = 1.586 ]
    done
    local between=(--set physical.load=22 --set physical.speed=1.1)
    fullrun e.yml "${between[@]}" -o full.h5
    romrun e.yml "${between[@]}" --model e.h5 --set output.fields=true -o reduced.h5 --against full.h5 --allow-untrusted
    romrun --export e.h5 -o e.ehdrom
    romrun e.yml "${between[@]}" --model e.ehdrom --set output.fields=true -o flat.h5 --allow-untrusted
    /usr/bin/python3 - <<'PYTHON'
import h5py, numpy
full, reduced, flat = (h5py.File(name + ".h5") for name in ("full", "reduced", "flat"))
for name, bound in ("central_film_thickness", 2e-3), ("minimum_film_thickness", 5e-3), ("rigid_approach", 2e-3):
    assert abs(reduced[name][0] / full[name][0] - 1) < bound, (name, reduced[name][0], full[name][0])
    assert flat[name][0] == reduced[name][0], name
assert numpy.abs(reduced["pressure"][...] - full["pressure"][...]).max() < 0.03
assert numpy.array_equal(flat["pressure"][...], reduced["pressure"][...])
assert flat.attrs["half_width_across"] == full.attrs["half_width_across"]
PYTHON
}

@test "models and files of other ellipses are refused in a line" {
    run -65 romrun e.yml --model e.h5 --set physical.radius_across=0.021
    [[ $output == *"ellipticity: found 1.637"*"expected 1.5858"* && ${#lines[@]} -eq 1 ]]
    run -65 romrun point.yml --model e.h5
    [ ${#lines[@]} -eq 1 ]
    sed 's/physical.load: .17, 20, 24./physical.radius_across: [0.02, 0.021]/' plan.yml >mixed.yml
    run -65 snapgen mixed.yml -o x.h5
    [[ $output == *"mixed.yml: ellipticity: found 1.5858"* && ${#lines[@]} -eq 1 ]]
    sed -i 's/radius_across: 0.02,/radius_across: 0.021,/' e.yml
    snapgen plan.yml -o other.h5 --quiet
    for command in "podbuild s.h5 other.h5" "snapgen plan.yml --basis b.h5"; do
        run -65 $command -o x.h5
        [[ $output == *"ellipticity: found 1."*"expected 1."* && ${#lines[@]} -eq 1 ]]
    done
    fullrun e.yml -o start.h5
    run -65 fullrun e.yml --set physical.radius_across=0.02 --grid-of b.h5 --start start.h5 -o x.h5
    [[ $output == *"ellipticity"* ]]
    [ ! -e x.h5 ]
}

@test "the library gives it in SI units, across by b" {
    [ "$VARIANT" = release ] || skip "the Python package is of the release"
    make -C "$root" -s python VARIANT="$VARIANT" DEPS=no
    romrun e.yml --model e.h5 --set output.fields=true -o solved.h5 --allow-untrusted
    PYTHONPATH=$root/build/$VARIANT/python /usr/bin/python3 -B - <<'PYTHON'
import ehdrom, h5py, numpy
file = h5py.File("solved.h5")
model = ehdrom.Model("e.h5")
assert model.info["ellipticity"] == file.attrs["ellipticity"] and model.info["dimensions"] == 2
contact = ehdrom.Contact(model, accuracy=numpy.inf)
for key, value in {"physical.load": 20, "physical.radius": 0.01, "physical.speed": 1, "physical.modulus": 220e9,
                   "physical.viscosity": 0.08, "lubricant.viscosity.law": "barus",
                   "lubricant.viscosity.alpha": 1e-8, "lubricant.density.law": "dowson-higginson"}.items():
    contact[key] = value
result = contact.solve()
assert abs(result.central_film_thickness / (file["central_film_thickness"][0] * file.attrs["film_unit"]) - 1) < 1e-9
assert abs(contact.scales()["half_width_across"] / file.attrs["half_width_across"] - 1) < 1e-12
x, y = contact.fields()[:2]
assert numpy.allclose(y, file["y"][...] * file.attrs["half_width_across"], rtol=1e-6)
assert numpy.allclose(x, file["x"][...] * file.attrs["half_width"], rtol=1e-6)
contact["physical.radius_across"] = 0.02
assert abs(contact.solve().central_film_thickness / result.central_film_thickness - 1) < 1e-9
contact["physical.radius_across"] = 0.03
try:
    contact.solve()
    raise AssertionError("another ellipse was solved")
except ehdrom.Error as error:
    assert "ellipticity: found" in str(error), error
PYTHON
}

# bats test_tags=slow
@test "an FMU has the library's force and films" {
    [ "$(uname -m)" = x86_64 ] || skip "FMUs are made on x86-64"
    make -s -C "$root" DEPS=no VARIANT="$VARIANT" build/fmu/use_fmu
    romrun --fmu e.yml --model e.h5 --fmi 3 -o ellipse.fmu --quiet
    python3 -m zipfile -e ellipse.fmu ellipse
    grep 'elliptical contact' ellipse/modelDescription.xml
    grep '<Float64 name="force"' ellipse/modelDescription.xml | grep 'unit="N"'
    "$root/build/fmu/use_fmu" 3 ellipse run 40 >fmu
    "$root/build/fmu/use_fmu" library ellipse 40 20 1 0.01 >library
    cmp library fmu
    [ "$(grep -c 'force=[-0-9]' fmu)" -eq 41 ]
}

# bats test_tags=slow
@test "in time, the reduced model follows the full one, and of ellipticity 1 the point contact" {
    sed -e 's/stationary/transient/' scene.yml >moving.yml
    echo 'transient: {load: {law: sine, amplitude: 0.1, period: 0.5}, end_time: 0.3, fixed_step: 0.03}' >>moving.yml
    echo 'groups: [{scene: moving.yml}]' >moving-plan.yml
    fullrun moving.yml -o full.h5
    fullrun --check full.h5
    snapgen moving-plan.yml -o ts.h5 --quiet
    podbuild ts.h5 -o tb.h5
    snapgen moving-plan.yml --basis tb.h5 -o tr.h5 --quiet
    deimselect --no-check tr.h5 --basis tb.h5 -o tm.h5 --rows 36
    romrun moving.yml --model tm.h5 --against full.h5 -o reduced.h5 --allow-untrusted
    fullrun moving.yml --set ellipticity=1 -o ellipse.h5
    sed -e 's/contact: ellipse/contact: point/; s/ellipticity: .*//' moving.yml >moving-point.yml
    fullrun moving-point.yml -o moving-point.h5
    /usr/bin/python3 - <<'PYTHON'
import h5py, numpy
full, reduced, ellipse, point = (h5py.File(name + ".h5") for name in ("full", "reduced", "ellipse", "moving-point"))
for name in "central_film_thickness", "minimum_film_thickness", "load":
    assert numpy.abs(reduced[name][...] / full[name][...] - 1).max() < 5e-4, name
for name in "pressure", "film_thickness", "central_film_thickness", "time":
    assert ellipse[name][...].tobytes() == point[name][...].tobytes(), name
assert numpy.abs(ellipse["central_film_thickness"][...] / full["central_film_thickness"][...] - 1).min() > 0.01
PYTHON
}

# bats test_tags=slow
@test "a slender ellipse has the line contact's physical film in the middle" {
    cat >line.yml <<'YAML'
contact: line
regime: stationary
moes: {M: 10, L: 5}
lubricant: {viscosity: {law: barus, alpha: 2.0e-8}, density: {law: dowson-higginson}}
grid: {x_min: -4, x_max: 2, step: 0.0625}
output: {resolution: false}
YAML
    fullrun line.yml -o line.h5 --quiet
    # p_H, R_x, u and the lubricant of line and ellipse are equal; 2/(k A) is the half width of the line over the half
    # width of the ellipse
    /usr/bin/python3 - <<'PYTHON'
import subprocess, h5py, numpy
def solved(name, *settings):
    subprocess.run(["fullrun", "line.yml", "-o", f"{name}.h5", "--quiet", "--force", *(
        part for setting in settings for part in ("--set", setting))], check=True)
    with h5py.File(f"{name}.h5") as file:
        return file["central_film_thickness"][0], file.attrs["hertz_pressure"]
# the inlet of the line is long enough to be as complete as the inlet of the ellipse with the far field
line, line_pressure = solved("line", "grid.x_min=-16")
below = []
for k in 2, 4, 8:
    t = numpy.linspace(0, numpy.pi / 2, 20001)  # the integral A, with t = tan^2
    f = 2 * numpy.cos(t) ** 2 / numpy.sqrt((k * numpy.cos(t)) ** 2 + numpy.sin(t) ** 2)
    A = (f[1:] + f[:-1]).sum() / 2 * t[1]
    ratio = 2 / (k * A)
    speed = 3 * numpy.pi**2 / (8 * 10**2) * ratio**3  # lambda
    # M = W/S^(3/4) with w = (2/3) pi a b p_H and p_H/E' = a/(2 k A R_x)
    S = speed / (12 * k * A)  # R_x/a = 1
    M = numpy.pi / (3 * A) / S**0.75
    film, pressure = solved("ellipse", "contact=ellipse", f"ellipticity={k}", f"moes.M={float(M)!r}", "moes.L=5", "grid.y_max=1.5")
    assert abs(pressure / line_pressure - 1) < 1e-6, (pressure, line_pressure)
    below.append(film / ratio**2 / line - 1)
print(below)
assert all(abs(after) < abs(before) / 2 for before, after in zip(below, below[1:])), below
assert abs(below[2]) < 0.02, below
PYTHON
}
