#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Elliptical contacts: scenes, results, SI units, reduced models.

load common

# ellipse_scene ELLIPTICITY: scene.yml, 37 by 33 nodes; the point contact of the same numbers as point.yml.
ellipse_scene() {
    point_scene 20 -3
    sed -e 's/contact: point/contact: point\nboundary: zero/' scene.yml | grep -v '^output' >point.yml
    sed -i -e "s/contact: point/contact: ellipse\nellipticity: $1/" scene.yml
}

setup() {
    cd "$BATS_TEST_TMPDIR" || return
    ellipse_scene 1.5
}

@test "of ellipticity 1 it has the bits of the point contact" {
    fullrun scene.yml --set ellipticity=1 -o ellipse.h5
    fullrun point.yml -o point.h5
    /usr/bin/python3 - <<'PYTHON'
import h5py
ellipse, point = h5py.File("ellipse.h5"), h5py.File("point.h5")
for name in "pressure", "film_thickness", "central_film_thickness", "rigid_approach", "exit_position":
    assert ellipse[name][...].tobytes() == point[name][...].tobytes(), name
assert ellipse.attrs["hertz_pressure"] == point.attrs["hertz_pressure"]
assert ellipse.attrs["ellipticity"] == 1 and "ellipticity" not in point.attrs
PYTHON
    fullrun scene.yml -o other.h5 # which another shape has not
    [ "$(number other.h5 central_film_thickness)" != "$(number ellipse.h5 central_film_thickness)" ]
}

@test "half and whole domain write the same symmetric fields" {
    fullrun scene.yml -o half.h5
    fullrun scene.yml --set grid.half=false -o whole.h5
    fullrun --check half.h5
    /usr/bin/python3 - <<'PYTHON'
import h5py, numpy
half, whole = h5py.File("half.h5"), h5py.File("whole.h5")
for name in "pressure", "film_thickness", "exit_position":
    a, b = half[name][...], whole[name][...]
    assert numpy.array_equal(a, a[:, ::-1], equal_nan=True), name
    assert numpy.allclose(a, b, rtol=0, atol=1e-9, equal_nan=True), name
pressure = half["pressure"][0]
assert abs(pressure.sum() * 0.125**2 / (2 * numpy.pi / 3) - 1) < 1e-9
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
assert f"{-2 * b:.5g}"[:6] in text and f"{-3 * a:.5g}"[:6] in text, text
origin, spacing = (
    [float(v) for v in re.search(rb'%s="([^"]*)"' % name, open("si.vti", "rb").read(2000))[1].split()]
    for name in (b"Origin", b"Spacing")
)
assert numpy.allclose(origin[:2], [-3 * a, -2 * b], rtol=1e-12), origin
assert numpy.allclose(spacing[:2], [a / 8, b / 8], rtol=1e-12), spacing
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
    refused "boundary: found open, expected zero" --set boundary=open
}

@test "formulas of round contacts are not those of an ellipse" {
    run -64 fullrun scene.yml --formulas
    [[ $output == *"--formulas: found with the contact ellipse"* ]]
}

@test "a start of another ellipse is refused" {
    fullrun scene.yml -o one.h5
    fullrun scene.yml --start one.h5 -o two.h5
    run -65 fullrun scene.yml --set ellipticity=1.4 --start one.h5 -o x.h5
    [[ $output == *"one.h5: ellipticity: found 1.5, expected 1.4"* ]]
    run -65 fullrun point.yml --start one.h5 -o x.h5
}
