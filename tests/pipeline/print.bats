#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests of --print FILE NAME...: every program prints the contents of any artefact as CSV.

load common

setup() { common_setup; }

@test "--print: what there is, entries, and attributes, the same from every program" {
    fullrun scene.yml -o r.h5 >/dev/null
    for name in fullrun snapgen podbuild deimselect romrun; do
        $name --print r.h5 x pressure film_thickness >"$name.csv"
        cmp fullrun.csv "$name.csv"
        $name --help | grep -q -- '--print=FILE NAME'
    done
    [ "$(head -n 1 fullrun.csv)" = x,pressure,film_thickness ]
    [ "$(wc -l <fullrun.csv)" -eq 302 ]
    # the numbers are exact to the last bit
    /usr/bin/python3 - <<'PYTHON'
import csv, h5py
with h5py.File("r.h5") as file, open("fullrun.csv") as table:
    rows = list(csv.reader(table))[1:]
    for column, name in enumerate(["x", "pressure", "film_thickness"]):
        assert [float(row[column]) for row in rows] == list(file[name][...].flat), name
PYTHON
    run fullrun --print r.h5 status moes_M contact
    [ "$output" = "status,moes_M,contact
0,12,line" ]
    fullrun --print r.h5 >names.csv
    grep -q '^pressure,1,1 301,time x,"pressure P, ' names.csv
    # a text of several lines is one field
    fullrun --print r.h5 settings step >settings.csv
    /usr/bin/python3 -c "import csv; rows = list(csv.reader(open('settings.csv'))); assert len(rows) == 2 and 'moes.M: 12' in rows[1][0] and rows[1][1] == '0.02', rows"
}

@test "--print: refusals" {
    fullrun scene.yml -o r.h5 >/dev/null
    refused 65 "r.h5: found no pressur, expected one of: time x pressure film_thickness .* moes_M" fullrun --print r.h5 pressur
    refused 65 "r.h5: found pressure and load of different axes" fullrun --print r.h5 pressure load
    refused 66 "none.h5: " romrun --print none.h5 x
    refused 65 "scene.yml: found no HDF5 file" romrun --print scene.yml x
    head -c 5000 r.h5 >cut.h5
    refused 65 "cut.h5: " romrun --print cut.h5 x
    refused 64 "--print: found --check too" fullrun --check r.h5 --print r.h5
    refused 64 "--print" fullrun --print
    # a reader that has seen enough is no failure
    run -0 bash -o pipefail -c 'fullrun --print r.h5 x pressure film_thickness | head -n 1'
    [ "$output" = x,pressure,film_thickness ]
    run bash -c 'fullrun --print r.h5 x >/dev/full'
    [[ $status == 74 && $output == "fullrun: stdout: "* ]]
}

# bats test_tags=slow
@test "every look at a result that grows prints it" {
    moving_scene 'x_min: -4, x_max: 2, step: 0.05' 'end_time: 1000, fixed_step: 0.01'
    fullrun moving.yml -o grows.h5 --quiet &
    local writer=$!
    until fullrun --print grows.h5.partial time >/dev/null 2>&1; do kill -0 "$writer" && sleep 0.1; done
    for look in {1..60}; do
        fullrun --print grows.h5.partial time load >look.csv || { kill "$writer"; return 1; }
    done
    kill -KILL "$writer"
    ! wait "$writer" # it was still writing
    truncate -s -20000 grows.h5.partial
    refused 65 "grows.h5.partial: found a damaged file \(truncated file" fullrun --print grows.h5.partial time load
}

# bats test_tags=slow
@test "--print: a run that stopped early is printed as far as it came" {
    sed -i -e 's/stationary/transient/' -e '$a transient: {load: {law: ramp, from: 1, to: 200, duration: 1}, end_time: 1}' scene.yml
    run -3 fullrun scene.yml --quiet -o r.h5 --set discretization=published
    fullrun --print r.h5.partial time load status >part.csv
    awk -F, 'NR > 2 && !($1 > last && $2 > load) { bad = 1 } { last = $1; load = $2 } END { exit bad || !(NR > 3 && last < 1) }' part.csv
}

@test "--print: maps of a point contact are blocks a line of the grid, as gnuplot reads them" {
    point_scene 10 -2.5
    fullrun scene.yml -o r.h5 --quiet >/dev/null
    fullrun --print r.h5 x y pressure >map.csv
    /usr/bin/python3 - <<'PYTHON'
import numpy as np
header, *lines = open("map.csv").read().splitlines()
blocks = [block.splitlines() for block in "\n".join(lines).split("\n\n")]
x, y, pressure = np.array([[line.split(",") for line in block] for block in blocks], dtype=float).transpose(2, 0, 1)
assert header == "x,y,pressure" and len(blocks) == 33
assert np.all(x == x[0]) and np.all(np.diff(x) > 0) and np.all(y == y[:, :1]) and np.all(np.diff(y[:, 0]) > 0)
# on the lines through the middle of the contact, the places where P = 0.5 lie within the contact
for least, place, values in (0.5, x[16], pressure[16]), (0.5, y[:, 20], pressure[:, 20]):
    top = np.argmax(values)
    ends = np.interp(0.5, values[:top], place[:top]), np.interp(0.5, values[:top:-1], place[:top:-1])
    assert -1 < ends[0] < -least and least < ends[1] < 1, ends
PYTHON
}

@test "--print: a contact in SI units has its half width and the unit of its film" {
    sed -i -e 's/^moes:.*/physical: {load: 200e3, radius: 0.01, speed: 2, modulus: 226e9, viscosity: 0.04}/' scene.yml
    fullrun scene.yml -o r.h5 --quiet --set lubricant.viscosity.law=barus >answer.txt
    fullrun --print r.h5 central_film_thickness half_width film_unit >units.csv
    # a = sqrt(8 w R / (pi E)), a^2 / R
    awk -F, 'NR == 2 { pi = atan2(0, -1); a2 = 8 * 200e3 * 0.01 / (pi * 226e9); d = $2 ^ 2 / a2 - 1; e = $3 / (a2 / 0.01) - 1
        exit !(d * d < 1e-24 && e * e < 1e-24) }' units.csv
    close_to "$(awk -F, 'NR == 2 { print $1 * $3 * 1e6 }' units.csv)" "$(sed -n 's/^central film thickness *[^ ]* *\([^ ]*\) µm/\1/p' answer.txt)" 1e-5
}

# bats test_tags=slow
@test "--print --si: units behind the names, in time those of the frame" {
    sed -i -e 's/^moes:.*/physical: {load: 200e3, radius: 0.01, speed: 2, modulus: 226e9, viscosity: 0.04}/' scene.yml
    cat >>scene.yml <<'YAML'
transient:
  load: {law: ramp, from: 1, to: 1.5, duration: 0.1}
  radius: {law: ramp, from: 1, to: 0.8, duration: 0.1}
  speed: {law: ramp, from: 1, to: 2, duration: 0.1}
  end_time: 0.1
  fixed_step: 0.02
YAML
    fullrun scene.yml -o t.h5 --quiet --set regime=transient --set output.fields=true >/dev/null
    fullrun --print t.h5 --si time load contact_half_width central_film_thickness central_pressure exit_position >times.csv
    fullrun --print t.h5 --si pressure film_thickness >fields.csv
    fullrun --print t.h5 --si hertz_pressure half_width film_unit time_unit line_load x_min contact moes_M >units.csv
    fullrun --print t.h5 --si >names.csv
    grep -q '^x,m,301,x,' names.csv
    grep -q '^moes_M,1,,,' names.csv
    /usr/bin/python3 - <<'PYTHON'
import csv, math, numpy as np
table = lambda name: list(csv.reader(line for line in open(name) if line.strip()))
names, *rows = table("times.csv")
assert names == ["time [s]", "load [N m-1]", "contact_half_width [m]", "central_film_thickness [m]", "central_pressure [Pa]", "exit_position [m]"]
time, load, width, film, pressure, exit = np.array(rows, float).T
fields, *lines = table("fields.csv")
assert fields == ["time [s]", "x [m]", "pressure [Pa]", "film_thickness [m]"]
lines = np.array(lines, float).reshape(len(time), 301, 4)
a = math.sqrt(8 * 200e3 * 0.01 / (math.pi * 226e9))
part = time / (0.1 * a / 2)
assert part[0] == 0 and abs(part[-1] - 1) < 1e-12 and len(part) > 5
assert np.allclose(load, 200e3 * (1 + 0.5 * part), rtol=1e-9)
assert np.allclose(width, np.sqrt(8 * load * 0.01 * (1 - 0.2 * part) / (math.pi * 226e9)), rtol=1e-9)
assert np.all(lines[:, :, 0] == time[:, None])
assert np.allclose(lines[:, 200, 1], 0, atol=1e-18) and np.allclose(lines[:, 0, 1], -4 * width, rtol=1e-9)
# the fields at x = 0 are the printed central values, and the pressure carries the load
assert np.allclose(lines[:, 200, 3], film, rtol=1e-9) and np.allclose(lines[:, 200, 2], pressure, rtol=1e-9)
assert np.allclose(np.sum(lines[:, :, 2], axis=1) * 0.02 * width, load, rtol=1e-6)
(names, values) = table("units.csv")
assert names == ["hertz_pressure [Pa]", "half_width [m]", "film_unit [m]", "time_unit [s]", "line_load [N m-1]", "x_min [m]", "contact", "moes_M"]
hertz, width, unit, second, load, least = map(float, values[:6])
assert np.allclose([hertz, width, unit, second, load, least],
                   [2 * 200e3 / (math.pi * a), a, a * a / 0.01, a / 2, 200e3, -4 * a], rtol=1e-9)
PYTHON
    refused 65 "t.h5: x: found a unit that varies with time" romrun --print t.h5 --si x
    fullrun base.yml -o m.h5 --set moes.M=12 --set moes.L=8 --quiet >/dev/null
    refused 65 "m.h5: found no attribute film_unit" fullrun --print m.h5 --si central_film_thickness
    snapgen plan.yml -o s.h5 --quiet
    refused 65 "s.h5: found ehdrom-snapshots, expected a kind of file that has SI units" fullrun --print s.h5 --si moes_M
    refused 64 "--si: found without --print" fullrun scene.yml --si
}

# bats test_tags=slow
@test "--print: every dataset, axis and attribute of every kind of file, to the last bit" {
    small_model
    printf 'moes.M,moes.L\n10,3\n12,5\n' >cases.csv
    romrun base.yml --cases cases.csv --model c.h5 -o table.h5 --quiet >/dev/null
    romrun scene.yml --model c.h5 -o red.h5 --set output.fields=true --quiet >/dev/null
    for file in s b r c red table; do
        romrun --print $file.h5 >"$file-names.csv"
        # prints datasets along the same axes together
        /usr/bin/python3 - "$file" >groups <<'PYTHON'
import csv, sys
groups = {}
for row in csv.DictReader(open(sys.argv[1] + "-names.csv")): groups.setdefault(row["axes"], []).append(row["name"])
for names in groups.values(): print(*names)
PYTHON
        mkdir "$file"
        while read -ra names; do
            romrun --print $file.h5 "${names[@]}" >"$file/${names[0]}.csv"
        done <groups
    done
    /usr/bin/python3 - <<'PYTHON'
import csv, glob, h5py, numpy as np
csv.field_size_limit(1 << 30)
for path in "s", "b", "r", "c", "red", "table":
    printed = {}
    for group in glob.glob(path + "/*.csv"):
        header, *rows = (row for row in csv.reader(open(group, newline="")) if row)
        for column, name in enumerate(header): printed.setdefault(name, [row[column] for row in rows])
        assert len(set(header)) == len(header)
    with h5py.File(path + ".h5") as file:
        names = [row["name"] for row in csv.DictReader(open(path + "-names.csv"))]
        assert set(names) == set(file) | set(file.attrs), set(names) ^ (set(file) | set(file.attrs))
        for name in names:
            if name in file.attrs:
                found, value = printed[name][0], file.attrs[name]
                assert found == value.decode() if isinstance(value, bytes) else float(found) == value, name
            elif file[name].attrs.get("CLASS") != b"DIMENSION_SCALE":
                found, value = np.array(printed[name], float), file[name][...].ravel()
                assert found.shape == value.shape and np.array_equal(found, value, equal_nan=True), (path, name)
            else:
                assert sorted(set(map(float, printed[name]))) == list(map(float, file[name][...])), (path, name)
PYTHON
}
