#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests of romrun cases: many scenes in one process.

load common

setup_file() {
    cd "$BATS_FILE_TMPDIR" || return
    small_model
}

setup() {
    cd "$BATS_TEST_TMPDIR" || return
    cp "$BATS_FILE_TMPDIR"/{c.h5,m.h5,base.yml,scene.yml} .
    # the scenes have the trained lubricant: M from 9.5 to 13 and L from 2.6 to 5.2
    sed 's/^moes:.*//' scene.yml >si.yml
    echo 'physical: {load: 60e3, radius: 0.01, speed: 0.2, modulus: 226e9, viscosity: 0.02}' >>si.yml
}

# judged CODE PATTERN ARGUMENT...: checks the exit code of romrun and that stderr is one line that matches the pattern
judged() {
    local code=$1 pattern=$2
    shift 2
    run --separate-stderr romrun "$@" --quiet
    echo "exit code $status, expected $code: $stderr"
    ((status == code)) && ((${#stderr_lines[@]} == 1)) && [[ $stderr =~ ^"romrun: ".*$pattern ]]
}

@test "an oil that was not trained is not trusted, however small the estimates are" {
    reason='viscosity law roelands with these parameters: not in training'
    oil=(--set moes.M=12 --set moes.L=5 --set lubricant.viscosity.law=roelands --set lubricant.viscosity.eta0=0.04)
    judged 4 "$reason" base.yml --model c.h5 -o x.h5 "${oil[@]}" --accuracy 0.1
    romrun base.yml --model c.h5 -o x.h5 -q -f "${oil[@]}" --accuracy 0.1 --allow-untrusted
    awk -v estimate="$(number x.h5 indicated_deviation)" 'BEGIN { exit !(estimate > 0 && estimate < 0.1) }'
    # the full model solves it
    romrun base.yml --model c.h5 -o x.h5 -q -f "${oil[@]}" --fallback full
    fullrun base.yml --grid-of c.h5 -o f.h5 -q "${oil[@]}" --allow-untrusted
    close_to "$(number x.h5 central_film_thickness)" "$(number f.h5 central_film_thickness)" 1e-6
    printf '%s\n' moes.M,moes.L,lubricant.viscosity.law,lubricant.viscosity.eta0 12,5,roelands,0.04 >cases.csv
    judged 4 "not to be trusted: 1" cases base.yml cases.csv --model c.h5 -o t.csv
    grep -q "$reason" t.csv
}

@test "--cases: rows are what romrun says of each scene alone, in any order of threads" {
    cat >cases.csv <<'CSV'
# a comment
moes.M, L
10, 3
12, 5

12, 5
14.5, 5.5
CSV
    romrun base.yml --cases cases.csv --model c.h5 -o t.csv --quiet --jobs 1 >answer.txt
    grep -q '^cases  *4: 4 good, 0 not to be trusted, 0 not converged$' answer.txt
    romrun base.yml --cases cases.csv --model c.h5 -o t.h5 --quiet --jobs 3 >/dev/null
    romrun base.yml --cases cases.csv --model c.h5 --quiet >stdout.csv
    romrun --check t.h5
    for case in "10 3" "12 5" "14.5 5.5"; do
        romrun base.yml --model c.h5 --set "moes.M=${case% *}" --set "moes.L=${case#* }" -o "${case/ /-}.h5" >/dev/null
    done
    # --accuracy chooses a size of the model for each case; if this size is not accurate enough, the most accurate size
    # is used
    romrun base.yml --cases cases.csv --model c.h5 -o a.csv --quiet --accuracy 1e-2 --allow-untrusted >/dev/null
    romrun base.yml --model c.h5 --set moes.M=12 --set moes.L=5 --accuracy 1e-2 --quiet --allow-untrusted -o a.h5 >/dev/null
    /usr/bin/python3 - <<'PYTHON'
import csv, h5py
with h5py.File("a.h5") as one:
    assert float(list(csv.DictReader(open("a.csv")))[1]["central_film_thickness"]) == one["central_film_thickness"][0]
rows = list(csv.DictReader(open("t.csv")))
assert [(row["moes.M"], row["moes.L"]) for row in rows] == [("10", "3"), ("12", "5"), ("12", "5"), ("14.5", "5.5")]
assert not any("[m]" in name for name in rows[0])
other = list(csv.DictReader(open("stdout.csv")))
for row in rows + other: del row["solve_seconds [s]"]
assert rows == other and rows[1] == rows[2]
with h5py.File("t.h5") as table:
    assert table.attrs["schema_name"] == b"ehdrom-cases" and "half_width" not in table
    for i, name in enumerate(["10-3", "12-5", "12-5", "14.5-5.5"]):
        with h5py.File(name + ".h5") as one:
            for field in ("central_film_thickness", "minimum_film_thickness", "central_pressure", "rigid_approach", "exit_position",
                          "indicated_deviation", "indicated_deviation_minimum", "newton_iterations", "residual_norm", "status"):
                assert table[field][i] == one[field][0] == float(rows[i][field]), (name, field)
            for field in "moes_M", "moes_L", "alpha_p_H":
                assert table[field][i] == one.attrs[field] == float(rows[i][field])
PYTHON
}

@test "--cases: in SI units where the scene is" {
    printf 'physical.load,speed\n60e3,0.2\n62e3,0.21\n' >cases.csv
    romrun si.yml --cases cases.csv --model c.h5 -o t.csv --quiet --allow-untrusted >/dev/null
    romrun si.yml --cases cases.csv --model c.h5 -o t.h5 --quiet --allow-untrusted >/dev/null
    romrun --print t.h5 --si central_film_thickness peak_pressure exit_position line_load speed status >si.csv
    /usr/bin/python3 - <<'PYTHON'
import csv, math
rows, printed = (list(csv.DictReader(open(name))) for name in ("t.csv", "si.csv"))
assert list(printed[0]) == ["central_film_thickness [m]", "peak_pressure [Pa]", "exit_position [m]", "line_load [N m-1]", "speed [m s-1]", "status"]
for row, again, load in zip(rows, printed, (60e3, 62e3)):
    assert all(row[name] == again[name] for name in again)
    a = math.sqrt(8 * load * 0.01 / (math.pi * 226e9))
    close = lambda name, value: math.isclose(float(row[name]), value, rel_tol=1e-9)
    assert close("half_width [m]", a) and close("line_load [N m-1]", load) and close("hertz_pressure [Pa]", 2 * load / (math.pi * a))
    assert close("minimum_film_thickness [m]", float(row["minimum_film_thickness"]) * a * a / 0.01)
    assert close("central_pressure [Pa]", float(row["central_pressure"]) * 2 * load / (math.pi * a))
assert "point_load [N]" not in rows[0] and "inlet_heating_factor" not in rows[0]
PYTHON
    # like a result, the table has the effect of inlet heating on each case
    heated="--set lubricant.thermal_conductivity=0.14 --set lubricant.viscosity.temperature_coefficient=0.03"
    romrun si.yml --cases cases.csv --model c.h5 -o hot.csv --quiet --allow-untrusted $heated >/dev/null
    romrun si.yml --model c.h5 -o one.h5 --quiet --allow-untrusted $heated --set physical.load=62e3 --set physical.speed=0.21
    /usr/bin/python3 - "$(number one.h5 inlet_heating_factor)" "$(number one.h5 thermal_loading)" <<'PYTHON'
import csv, sys
row, cold = (list(csv.DictReader(open(name)))[1] for name in ("hot.csv", "t.csv"))
assert float(row["inlet_heating_factor"]) == float(sys.argv[1]) < 1 and float(row["thermal_loading"]) == float(sys.argv[2])
assert row["minimum_film_thickness"] == cold["minimum_film_thickness"]
PYTHON
}

@test "columns may have units, and a load in the other kind of unit is refused" {
    local load
    printf 'physical.load\n60000\n62500\n' >si.csv
    printf 'load [N/mm];name\n60;a\n62,5;1,5\n' >units.csv
    romrun cases si.yml si.csv -m c.h5 -o si-t.csv --quiet --allow-untrusted
    romrun cases si.yml units.csv -m c.h5 -o units-t.csv --quiet --allow-untrusted
    # the table has SI units, and the names of cases stay
    cut -d, -f1,2 units-t.csv >found
    printf '%s\n' physical.load,name 60000,a '62500,"1' | cmp - found
    for load in 60000 62500; do
        [ "$(grep "^$load," si-t.csv | cut -d, -f2-5)" = "$(grep "^$load," units-t.csv | sed 's/"[^"]*"/x/' | cut -d, -f3-6)" ]
    done
    printf 'physical.load [kN]\n60\n' >force.csv
    refused 65 "force.csv:2: physical.load: found 60 kN, expected a number from .* N/m, or one in N/mm" \
        romrun cases si.yml force.csv -m c.h5 -o x.csv
    # the table may also give the kind of contact
    grep -v ^contact si.yml >open.yml
    printf 'contact,physical.load [kN]\nline,60\n' >force.csv
    refused 65 "force.csv:2: physical.load: found 60 kN, expected" romrun cases open.yml force.csv -m c.h5 -o x.csv
}

# bats test_tags=slow
@test "--cases: friction where scenes slide" {
    sed -i 's/^  density.*/&\n  shear: {law: eyring, tau0: 5e6}/' si.yml
    printf 'slide_roll,physical.load\n0.05,60e3\n0,60e3\n-0.1,62e3\n' >cases.csv
    romrun si.yml --cases cases.csv --model c.h5 -o t.csv --quiet --allow-untrusted
    romrun si.yml --cases cases.csv --model c.h5 -o t.h5 --quiet --allow-untrusted --jobs 2
    romrun --check t.h5
    for case in "0.05 60e3" "0 60e3" "-0.1 62e3"; do
        read -r ratio load <<<"$case"
        romrun si.yml --model c.h5 -o "$ratio.h5" --quiet --allow-untrusted --set slide_roll="$ratio" --set physical.load="$load"
    done
    /usr/bin/python3 - <<'PYTHON'
import csv, h5py
rows = list(csv.DictReader(open("t.csv")))
with h5py.File("t.h5") as table:
    for i, name in enumerate(("0.05", "0", "-0.1")):
        with h5py.File(name + ".h5") as one:
            units = {"friction_coefficient": 1, "line_friction_force": one.attrs["line_load"], "line_power_loss": one.attrs["line_power"],
                     "indicated_deviation_friction": 1, "line_rolling_resistance": one.attrs["line_load"],
                     "line_rolling_moment": one.attrs["line_moment"], "mean_shear_stress": one.attrs["hertz_pressure"],
                     "largest_shear_stress": one.attrs["hertz_pressure"]}
            for column, unit in units.items():
                found = table[column][i]
                expected = one[column.removeprefix("line_")][0] * unit
                assert abs(found - expected) <= 1e-12 * abs(expected), (name, column)
                [named] = [name for name in rows[0] if name.split(" ")[0] == column]
                assert float(rows[i][named]) == found
assert not any(name.startswith("point_") for name in rows[0])
PYTHON
    # scenes that name no sliding have no columns of friction; a model without nodes for friction gives a warning
    printf 'moes.M,moes.L\n10,3\n' >still-cases.csv
    romrun base.yml --cases still-cases.csv --model c.h5 -o still.csv --quiet
    shows_no friction cat still.csv
    patch c.h5 "[f.__delitem__(k) for k in list(f) if k.startswith('cubature') or k == 'moment_jacobian']"
    run --separate-stderr romrun si.yml --cases cases.csv --model bad.h5 -o old.csv --allow-untrusted
    [ "$status" -eq 0 ]
    [[ $stderr == *"bad.h5: found a model without nodes for traction, expected one that deimselect of this version has made: the table has no friction"* ]]
    shows_no friction cat old.csv
}

@test "--cases: the exit code is that of the worst, and every scene is a row" {
    printf 'moes.M,moes.L\n10,3\n40,3\n12,5\n' >some.csv
    judged 4 "some.csv:3: scenes: 3, not converged: 0, not to be trusted: 1" base.yml --cases some.csv --model c.h5 -o t.csv
    [ "$(cut -d, -f3 t.csv | paste -sd' ')" = "status 0 4 0" ]
    grep -q '^40,3,4,.*,outside of the trained range' t.csv
    romrun base.yml --cases some.csv --model c.h5 -o t.csv --quiet --force --allow-untrusted >/dev/null
    # far outside of the training nothing converges: the row has NaN
    printf 'moes.M,moes.L\n40,3\n1000,12\n12,5\n' >bad.csv
    judged 3 "bad.csv:3: scenes: 3, not converged: 1, not to be trusted: 1" base.yml --cases bad.csv --model c.h5 -o u.csv --allow-untrusted
    grep -q '^1000,12,1,1000,12,.*,nan,nan,nan,nan,nan,nan,' u.csv
    # a model that was never checked: each row is flagged
    judged 4 "not to be trusted: 3" base.yml --cases some.csv --model m.h5 -o v.csv
    # the limits are the same as for one scene
    judged 4 "some.csv:2: scenes: 3, not converged: 0, not to be trusted: 3" base.yml --cases some.csv --model c.h5 -o w.csv --accuracy-of pressure=1e-12
}

# bad_table CODE MESSAGE TABLE [OPTION...]: checks that romrun refuses TABLE.csv.
bad_table() { refuse "$1" "$2" romrun base.yml --cases "$3.csv" --model c.h5 -o x.h5 "${@:4}"; }

@test "--cases: refusals, before any work" {
    printf 'moes.M,moes.L\n10,3\n-1,3\n' >range.csv
    bad_table 65 "range.csv:3: moes.M: found -1" range
    printf 'moes.M,moes.N\n10,3\n' >key.csv
    bad_table 65 "key.csv:1: " key
    printf 'moes.M\n10\n' >lacking.csv
    bad_table 65 "lacking.csv:2: .*moes.L" lacking
    printf 'moes.M,moes.L,grid.step\n10,3,0.05\n10,3,0.04\n' >grid.csv
    bad_table 65 "grid.csv:3: " grid
    printf 'moes.M,moes.L,contact\n10,4,point\n' >kind.csv
    bad_table 65 "kind.csv:2: contact: found point, expected line as in c.h5" kind
    printf 'moes.M,moes.L\n10,3\n' >good.csv
    bad_table 65 "moes.M: found a key that good.csv varies" good --set moes.M=3
    refuse 64 "--output: found x.txt, expected NAME.csv or NAME.h5" romrun base.yml --cases good.csv --model c.h5 -o x.txt
    bad_table 64 "--verify: found with romrun cases, expected with" good --verify
    bad_table 64 "--fallback: found with romrun cases, expected with" good \
        --fallback full
    # the output is refused before any work
    refused 73 "none/x.csv: found No such file or directory, expected to create it" romrun base.yml --cases good.csv \
        --model c.h5 -o none/x.csv
    bad_table 66 "none.csv: " none
    bad_table 65 "good.csv:2: regime: found transient" good --set regime=transient --set transient.end_time=1
    touch there.csv
    refused 73 "there.csv: found an existing file" romrun base.yml --cases good.csv --model c.h5 -o there.csv
    run bash -c 'romrun base.yml --cases good.csv --model c.h5 >/dev/full'
    [[ $status == 74 && $output == *"romrun: stdout: "* ]]
}

@test "--cases: tables with quotes over lines, semicolons or tabs, and names of cases" {
    printf '%s\n' 'name,moes.M,moes.L' 'a;b,10,3' '"one
# two
""x""",12,5' '"#3, $(touch ran)",14.5,5.5' ',11,4' 'same,10,3' 'same,10,3' >commas.csv
    sed -e 's/a;b/"a;b"/' -e 's/,10,3/;10;3/; s/,12,5/;12;5/; s/,14.5,5.5/;14.5;5.5/; s/,11,4/;11;4/; s/^name.*/name;moes.M;moes.L/' commas.csv >semicolons.csv
    sed -e 's/,\([0-9.]*\),\([0-9.]*\)$/\t\1\t\2/; s/^name.*/name\tmoes.M\tL/' commas.csv >tabs.csv
    printf 'moes.L,moes.M\r\n3,10\r\n5,12\r\n"5.5","14.5"\r\n4,11\r\n3,10\r\n3,10' >plain.csv
    for table in commas semicolons tabs plain; do
        romrun base.yml --cases $table.csv --model c.h5 -o $table-t.csv --quiet >/dev/null
        romrun base.yml --cases $table.csv --model c.h5 -o $table.h5 --quiet >/dev/null
        romrun --check $table.h5
    done
    [ ! -e ran ]
    /usr/bin/python3 - <<'PYTHON'
import csv
def rows(name):
    found = list(csv.DictReader(open(name + "-t.csv", newline="")))
    return [{key: text for key, text in row.items() if key != "solve_seconds [s]"} for row in found]
expected = rows("commas")
assert [row["name"] for row in expected] == ["a;b", 'one\n# two\n"x"', "#3, $(touch ran)", "", "same", "same"]
assert [row["moes.M"] for row in expected] == ["10", "12", "14.5", "11", "10", "10"]
assert list(expected[0])[:3] == ["name", "moes.M", "moes.L"]
assert rows("semicolons") == expected and rows("tabs") == expected
assert rows("plain") == [{key: text for key, text in row.items() if key != "name"} for row in expected]
PYTHON
    # quoted names may have line breaks; the message counts lines of the table
    printf 'name,moes.M,moes.L\n"a\n\nb",10,3\n,40,3\n' >lines.csv
    judged 4 "lines.csv:5: scenes: 2, not converged: 0, not to be trusted: 1" base.yml --cases lines.csv --model c.h5 -o l.csv
    printf 'moes.M;moes.L\n10,5,2;3\n' >comma.csv
    bad_table 65 "comma.csv:2: moes.M: found 10,5,2, expected a number" comma
    printf 'moes.M,moes.L\n10,3\n"12,5\n13,4\n' >open.csv
    bad_table 65 "open.csv:3: found a quote that does not end" open
    printf 'moes.M,moes.L\n' >header.csv
    bad_table 65 "header.csv: found a header only" header
    printf 'name\na\n' >name.csv
    bad_table 65 "name.csv:2: " name
}

# many_cases COUNT: writes many.csv with COUNT cases
many_cases() {
    awk -v count="$1" 'BEGIN { print "name,moes.M,moes.L"; for (i = 0; i < count; i++)
        printf "\"case\n%d\",%.6g,%.6g\n", i, 9.5 + (i * 7919 % 1000) / 250, 2.6 + (i * 104729 % 1000) / 400 }' >many.csv
}

# rows_of FILE: prints a table without its times, for comparisons
rows_of() {
    /usr/bin/python3 - "$1" <<'PYTHON'
import csv, sys
if sys.argv[1].endswith(".csv"):
    for row in csv.DictReader(open(sys.argv[1], newline="")):
        row.pop("solve_seconds [s]")
        print(row)
else:
    import h5py
    with h5py.File(sys.argv[1]) as file:
        for name in sorted(set(file) - {"solve_seconds"}): print(name, len(file[name]), file[name][...].tobytes().hex())
PYTHON
}

# bats test_tags=slow
@test "--cases: memory does not grow with the rows" {
    is_installed || skip "sanitizers keep freed memory"
    local kilobytes=() rows=${MANY_ROWS:-20000}
    for count in 2000 "$rows"; do
        many_cases $count
        for kind in csv h5; do
            /usr/bin/python3 - "$kind" >kilobytes <<'PYTHON'
import resource, subprocess, sys
subprocess.run(["romrun", "base.yml", "--cases", "many.csv", "--model", "c.h5", "-o", "t." + sys.argv[1], "--quiet", "--jobs", "1", "--force"],
               check=True, stdout=subprocess.DEVNULL)
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)
PYTHON
            kilobytes+=("$(<kilobytes)")
        done
    done
    echo "${kilobytes[@]}"
    # a row in memory would take 600 bytes; the index of HDF5 takes only some bytes for each row
    ((kilobytes[2] - kilobytes[0] < 2000 && kilobytes[3] - kilobytes[1] < 3000 + rows / 60))
}

# bats test_tags=slow
@test "--cases: an interrupted run goes on with --resume, to the rows of one run" {
    many_cases 6000
    romrun base.yml --cases many.csv --model c.h5 -o whole.csv --quiet --jobs 2 >/dev/null
    romrun base.yml --cases many.csv --model c.h5 -o whole.h5 --quiet --jobs 1 >/dev/null
    for kind in csv h5; do
        # the run is killed, then resumed
        stop_when KILL 'bytes 300000' "t.$kind" romrun base.yml --cases many.csv --model c.h5 -o "t.$kind" --quiet --jobs 2
        [ ! -e "t.$kind" ]
        refused 73 "t.$kind.partial: found an interrupted run.*expected --resume to continue it or" \
            romrun base.yml --cases many.csv --model c.h5 -o "t.$kind" --quiet
        # resuming with another model, scene, accuracy or table is refused
        sed 's/^3",/3a",/' many.csv >other.csv
        for changed in "many.csv --model m.h5" "many.csv --model c.h5 --set lubricant.viscosity.alpha=2.1e-8" \
            "many.csv --model c.h5 --accuracy-of pressure=0.5" "other.csv --model c.h5"; do
            # shellcheck disable=SC2086
            refused 65 "t.$kind.partial: found .*, expected what an interrupted run of the same settings" \
                romrun base.yml --cases $changed -o "t.$kind" --quiet --resume
        done
        run romrun base.yml --cases many.csv --model c.h5 -o "t.$kind" --quiet --resume
        [[ $status == 0 && $output == *"cases                   6000: 6000 good"* ]]
        cmp <(rows_of "whole.$kind") <(rows_of "t.$kind")
        [ ! -e "t.$kind.partial" ] && [ ! -e "t.$kind.resume" ]
    done
    romrun --check t.h5
    # a row that was partly written is solved again; the message counts the first bad row from the beginning of the
    # whole table
    printf 'moes.M,moes.L\n10,3\n40,3\n12,5\n40,4\n' >bad.csv
    judged 4 "bad.csv:3: .* not to be trusted: 2" base.yml --cases bad.csv --model c.h5 -o b.csv
    romrun base.yml --cases many.csv --model c.h5 -o x.csv --quiet --force >/dev/null
    stop_when INT 'bytes 400000' t.csv romrun base.yml --cases many.csv --model c.h5 -o t.csv --quiet --jobs 1 --force
    [ "$code" -ne 0 ]
    rows_before=$(grep -c '^"case' t.csv.partial)
    ((rows_before > 0 && rows_before < 6000))
    truncate -s -100 t.csv.partial
    rm t.csv
    romrun base.yml --cases many.csv --model c.h5 -o t.csv --quiet --resume >/dev/null
    cmp <(rows_of whole.csv) <(rows_of t.csv)
    # a changed bit in the unfinished table is found, wherever the bit is
    stop_when KILL 'marks 2' t.csv romrun base.yml --cases many.csv --model c.h5 -o t.csv --quiet --jobs 1 --force
    cp t.csv.partial partial && cp t.csv.resume resume
    last=$(tail -n 1 resume)
    header=$(head -n 1 partial | wc -c)
    for place in 0 $((header + 700)) 100000 $((${last%% *} - 2)); do
        cp resume t.csv.resume
        python3 - "$place" <<'PYTHON'
import sys

data = bytearray(open("partial", "rb").read())
data[int(sys.argv[1])] ^= 1
open("t.csv.partial", "wb").write(data)
PYTHON
        rm -f t.csv
        run romrun base.yml --cases many.csv --model c.h5 -o t.csv --quiet --resume
        [[ $status == 65 && $output == *"t.csv.partial: found damaged rows, expected what an interrupted run"* ]]
        [ ! -e t.csv ]
    done
    # a mark (number of finished bytes and their checksum) that ends within a row is refused too
    bytes=$((header + 100))
    grep -v -E '^[0-9]+ [0-9a-f]{64}$' resume >t.csv.resume
    echo "$bytes $(head -c $bytes partial | sha256sum | cut -d ' ' -f 1)" >>t.csv.resume
    cp partial t.csv.partial
    refused 65 "t.csv.partial: found damaged rows" romrun base.yml --cases many.csv --model c.h5 -o t.csv --quiet --resume
    # a mark with a changed checksum is ignored
    sed -i '$ s/ [0-9a-f]/ x/' resume && cp resume t.csv.resume && cp partial t.csv.partial
    romrun base.yml --cases many.csv --model c.h5 -o t.csv --quiet --resume >/dev/null
    cmp <(rows_of whole.csv) <(rows_of t.csv)
    # without an interrupted run --resume changes nothing
    romrun base.yml --cases bad.csv --model c.h5 -o n.csv --quiet --resume --allow-untrusted >/dev/null
    cmp <(rows_of b.csv) <(rows_of n.csv)
    refuse 64 "--resume: found without --output" romrun base.yml --cases bad.csv --model c.h5 --resume
}
