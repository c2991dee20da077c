#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests of --vtk RESULT.h5 -o NAME.vti or NAME.pvd: fields for ParaView, in metres and pascals.

load common

setup() {
    common_setup
    cat >image.py <<'PYTHON'
# Reads origin, spacing, arrays [z, y, x] and time of an image, in the format of VTK's documentation.
import re, sys, numpy as np, xml.etree.ElementTree as tree
def image(path):
    raw = open(path, "rb").read()
    start, end = raw.index(b"_", raw.index(b"<AppendedData")) + 1, raw.rindex(b"\n</AppendedData>")
    root = tree.fromstring(raw[:start] + raw[end:])
    assert root.attrib["type"] == "ImageData" and root.attrib["header_type"] == "UInt64"
    whole = root.find("ImageData")
    extent = [int(n) for n in whole.attrib["WholeExtent"].split()]
    shape = [extent[2 * d + 1] - extent[2 * d] + 1 for d in (2, 1, 0)]
    piece, arrays, used = whole.find("Piece"), {}, 0
    assert piece.attrib["Extent"] == whole.attrib["WholeExtent"] and extent[::2] == [0, 0, 0]
    for array in piece.find("PointData"):
        at = start + int(array.attrib["offset"])
        size = int(np.frombuffer(raw, "<u8", 1, at)[0])
        assert size == 8 * np.prod(shape)
        arrays[array.attrib["Name"]] = np.frombuffer(raw, "<f8", size // 8, at + 8).reshape(shape)
        used += 8 + size
    assert start + used == end
    numbers = lambda name: np.array(whole.attrib[name].split(), float)
    return numbers("Origin"), numbers("Spacing"), arrays, float(whole.find("FieldData/DataArray").text)
PYTHON
}

@test "--vtk: a point contact as an image of two layers, the same from every program" {
    point_scene 10 -2.5
    sed -i -e 's/^moes:.*/physical: {load: 20, radius: 0.01, speed: 0.5, modulus: 226e9, viscosity: 0.04}/' scene.yml
    fullrun scene.yml -o r.h5 --quiet >/dev/null
    for name in fullrun snapgen podbuild deimselect romrun; do
        $name --vtk r.h5 -o "$name.vti"
        cmp fullrun.vti "$name.vti"
    done
    PYTHONPATH=. /usr/bin/python3 - <<'PYTHON'
import h5py, numpy as np
from image import image
origin, spacing, arrays, time = image("romrun.vti")
with h5py.File("r.h5") as file:
    a, p, h = (file.attrs[name] for name in ("half_width", "hertz_pressure", "film_unit"))
    assert np.allclose(origin, [-2.5 * a, -2 * a, 0], rtol=1e-12) and np.allclose(spacing, 0.125 * a, rtol=1e-12) and time == 0
    for name, unit in ("pressure", p), ("film_thickness", h):
        assert arrays[name].shape == (2, 33, 33) and np.all(arrays[name] == file[name][0] * unit), name
assert set(arrays) == {"pressure", "film_thickness"}
PYTHON
}

@test "--vtk: a time series is a collection of images, each in the frame of its time" {
    sed -i -e 's/^moes:.*/physical: {load: 200e3, radius: 0.01, speed: 2, modulus: 226e9, viscosity: 0.04}/' scene.yml
    cat >>scene.yml <<'YAML'
transient: {load: {law: ramp, from: 1, to: 1.5, duration: 0.1}, end_time: 0.1, fixed_step: 0.02}
YAML
    fullrun scene.yml -o t.h5 --quiet --set regime=transient --set output.fields=true --set output.fields_every=3 >/dev/null
    mkdir 'a&b'
    romrun --vtk t.h5 -o 'a&b/t&.pvd' --quiet
    PYTHONPATH=. /usr/bin/python3 - <<'PYTHON'
import h5py, numpy as np, os, xml.etree.ElementTree as tree
from image import image
entries = tree.parse("a&b/t&.pvd").getroot().find("Collection")
with h5py.File("t.h5") as file:
    a, p, h, second = (file.attrs[name] for name in ("half_width", "hertz_pressure", "film_unit", "time_unit"))
    times = [t for t in range(len(file["time"])) if not np.isnan(file["pressure"][t, 0])]
    assert 3 <= len(times) < len(file["time"]) and len(entries) == len(times)
    for number, (t, entry) in enumerate(zip(times, entries)):
        assert entry.attrib["file"] == "t&_%04d.vti" % number
        origin, spacing, arrays, time = image("a&b/" + entry.attrib["file"])
        width = file["contact_half_width"][t] * a
        assert np.isclose(time, file["time"][t] * second, rtol=1e-15) and float(entry.attrib["timestep"]) == time
        # the image of a line contact is a strip one step wide
        assert np.allclose(origin, [-4 * width, -0.01 * width, 0], rtol=1e-9) and np.allclose(spacing, 0.02 * width, rtol=1e-9)
        assert arrays["pressure"].shape == (2, 2, 301)
        assert np.allclose(arrays["pressure"], file["pressure"][t] * p * file["frame_hertz_pressure"][t], rtol=1e-15)
        assert np.allclose(arrays["film_thickness"], file["film_thickness"][t] * h * file["frame_film_unit"][t], rtol=1e-15)
assert sorted(os.listdir("a&b")) == ["t&.pvd"] + ["t&_%04d.vti" % n for n in range(len(times))]
PYTHON
    refuse 65 "t.h5: found fields of .* times, expected 1 for x.vti" romrun --vtk t.h5 -o x.vti
    # an existing image is found before the collection is written
    rm 'a&b/t&.pvd'
    refused 73 "t&_0000.vti: found an existing file" romrun --quiet --vtk t.h5 -o 'a&b/t&.pvd'
    [ ! -e 'a&b/t&.pvd' ]
    [ ! -e 'a&b/t&.pvd.partial' ]
    romrun --quiet --vtk t.h5 -o 'a&b/t&.pvd' --force
}

# with_vtk: runs the Python script on stdin, in which read(path) reads an image with VTK itself. Tests that call
# with_vtk need Debian's python3-vtk9. Make does not install this package for them, because it is too large (244 MB with
# its dependencies).
with_vtk() {
    cat >vtk_image.py <<'PYTHON'
import h5py, numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkCommand
from vtkmodules.vtkIOXML import vtkXMLImageDataReader
def read(path):
    reader, wrong = vtkXMLImageDataReader(), []
    for event in vtkCommand.ErrorEvent, vtkCommand.WarningEvent:
        reader.AddObserver(event, lambda *_: wrong.append(path))
    assert reader.CanReadFile(path), path
    reader.SetFileName(path)
    reader.Update()
    assert not wrong, wrong
    return reader.GetOutput()
def field(image, name):
    nx, ny, nz = image.GetDimensions()
    return vtk_to_numpy(image.GetPointData().GetArray(name)).reshape(nz, ny, nx)
def time_of(image):
    return image.GetFieldData().GetArray("TimeValue").GetValue(0)
PYTHON
    PYTHONPATH=.:$PYTHONPATH /usr/bin/python3 -B -
}

@test "--vtk: VTK reads the image of a point contact, and cuts it" {
    /usr/bin/python3 -c 'import vtkmodules.vtkIOXML' 2>/dev/null || skip "there is no VTK for Python (python3-vtk9)"
    point_scene 10 -2.5
    sed -i -e 's/^moes:.*/physical: {load: 20, radius: 0.01, speed: 0.5, modulus: 226e9, viscosity: 0.04}/' scene.yml
    fullrun scene.yml -o r.h5 --quiet >/dev/null
    romrun --vtk r.h5 -o r.vti
    with_vtk <<'PYTHON'
from vtk_image import *
from vtkmodules.vtkCommonDataModel import vtkPlane
from vtkmodules.vtkFiltersCore import vtkCutter
image = read("r.vti")
with h5py.File("r.h5") as file:
    a, p, h = (file.attrs[name] for name in ("half_width", "hertz_pressure", "film_unit"))
    assert image.GetDimensions() == (33, 33, 2) and image.GetPointData().GetNumberOfArrays() == 2
    assert np.allclose(image.GetOrigin(), [-2.5 * a, -2 * a, 0]) and np.allclose(image.GetSpacing(), 0.125 * a)
    for name, unit in ("pressure", p), ("film_thickness", h):
        assert np.all(field(image, name) == file[name][0] * unit), name
    # cuts along y = 0, between the layers: VTK 9.1 crashed on an image of one layer
    plane, cutter = vtkPlane(), vtkCutter()
    plane.SetNormal(0, 1, 0)
    cutter.SetCutFunction(plane)
    cutter.SetInputData(image)
    cutter.Update()
    found = vtk_to_numpy(cutter.GetOutput().GetPointData().GetArray("pressure"))
    assert np.isclose(found.max(), (file["pressure"][0] * p)[16].max(), rtol=1e-9), found.max()
PYTHON
}

@test "--vtk: VTK reads the images of a time series" {
    /usr/bin/python3 -c 'import vtkmodules.vtkIOXML' 2>/dev/null || skip "there is no VTK for Python (python3-vtk9)"
    sed -i -e 's/^moes:.*/physical: {load: 200e3, radius: 0.01, speed: 2, modulus: 226e9, viscosity: 0.04}/' scene.yml
    cat >>scene.yml <<'YAML'
transient: {load: {law: ramp, from: 1, to: 1.5, duration: 0.1}, end_time: 0.1, fixed_step: 0.02}
YAML
    fullrun scene.yml -o t.h5 --quiet --set regime=transient --set output.fields=true --set output.fields_every=3 >/dev/null
    romrun --vtk t.h5 -o 't&.pvd' --quiet
    with_vtk <<'PYTHON'
from vtk_image import *
from vtkmodules.vtkIOXMLParser import vtkXMLDataParser
# VTK has no reader of collections (ParaView has one), but a parser of their XML
parser = vtkXMLDataParser()
parser.SetFileName("t&.pvd")
assert parser.Parse() == 1
root = parser.GetRootElement()
assert root.GetName() == "VTKFile" and root.GetAttribute("type") == "Collection"
entries = root.FindNestedElementWithName("Collection")
with h5py.File("t.h5") as file:
    a, p, second = (file.attrs[name] for name in ("half_width", "hertz_pressure", "time_unit"))
    times = [t for t in range(len(file["time"])) if not np.isnan(file["pressure"][t, 0])]
    assert len(times) >= 3 and entries.GetNumberOfNestedElements() == len(times)
    for number, t in enumerate(times):
        entry = entries.GetNestedElement(number)
        image = read(entry.GetAttribute("file"))
        assert np.isclose(time_of(image), file["time"][t] * second, rtol=1e-15)
        assert float(entry.GetAttribute("timestep")) == time_of(image)
        assert image.GetDimensions() == (301, 2, 2)
        assert np.isclose(image.GetOrigin()[0], -4 * file["contact_half_width"][t] * a, rtol=1e-9)
        pressure = file["pressure"][t] * p * file["frame_hertz_pressure"][t]
        assert np.allclose(field(image, "pressure"), pressure, rtol=1e-15)
PYTHON
}

# bats test_tags=slow
@test "--vtk: refusals and failed writes leave no file" {
    fullrun scene.yml -o m.h5 --quiet >/dev/null
    sed -i -e 's/^moes:.*/physical: {load: 200e3, radius: 0.01, speed: 2, modulus: 226e9, viscosity: 0.04}/' scene.yml
    fullrun scene.yml -o r.h5 --quiet >/dev/null
    fullrun scene.yml -o bare.h5 --quiet --set output.fields=false >/dev/null
    snapgen plan.yml -o s.h5 --quiet
    refused 65 "m.h5: found no attribute half_width" romrun --vtk m.h5 -o x.vti
    refused 65 "bare.h5: found no fields" romrun --vtk bare.h5 -o x.vti
    refused 65 "s.h5: found no fields, expected a result" romrun --vtk s.h5 -o x.vti
    refused 64 "--output: found x.vtk, expected NAME.vti" romrun --vtk r.h5 -o x.vtk
    refused 64 "--output: found nothing" romrun --vtk r.h5
    refused 64 "command line: found 1 file, expected none" romrun --vtk r.h5 scene.yml -o x.vti
    refused 64 "--vtk: found --print too" romrun --vtk r.h5 --print r.h5
    refused 66 "none.h5: " romrun --vtk none.h5 -o x.vti
    refused 73 "none/x.vti.*: found No such file" romrun --vtk r.h5 -o none/x.vti
    mkdir folder.vti
    refused 73 "folder.vti: found a folder" romrun --vtk r.h5 -o folder.vti --force
    run bash -c 'ulimit -f 4; romrun --vtk r.h5 -o x.vti'
    [[ $status == 74 && $output == "romrun: x.vti: found a failed write, expected the whole file" ]]
    [ ! -e x.vti ]
    [ ! -e x.vti.partial ]
    romrun --vtk r.h5 -o x.vti
    [ -s x.vti ]
    cp x.vti kept.vti
    refused 73 "x.vti: found an existing file" romrun --vtk r.h5 -o x.vti
    run bash -c 'ulimit -f 4; romrun --vtk r.h5 -o x.vti --force'
    [ "$status" = 74 ]
    cmp x.vti kept.vti
}
