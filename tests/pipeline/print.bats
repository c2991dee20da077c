#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# --print FILE NAME...: what any of our files holds as CSV, by every program.

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
    # to the last bit
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
    # text of several lines is one field
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
    run bash -c 'fullrun --print r.h5 x >/dev/full'
    [[ $status == 74 && $output == "fullrun: stdout: "* ]]
}

@test "--print: a run that stopped early is printed as far as it came" {
    sed -i -e 's/stationary/transient/' -e '$a transient: {load: {law: ramp, from: 1, to: 200, duration: 1}, end_time: 1}' scene.yml
    run -3 fullrun scene.yml --quiet -o r.h5 --set discretization=published
    fullrun --print r.h5.partial time load status >part.csv
    awk -F, 'NR > 2 && !($1 > last && $2 > load) { exit 1 } { last = $1; load = $2 } END { exit !(NR > 3 && last < 1) }' part.csv
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
# half of the pressure is where the contact ends, on the lines through its middle
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
