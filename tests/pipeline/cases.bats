#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# romrun --cases: many scenes in one process.

load common

setup_file() {
    cd "$BATS_FILE_TMPDIR" || return
    small_model
}

setup() {
    cd "$BATS_TEST_TMPDIR" || return
    cp "$BATS_FILE_TMPDIR"/{c.h5,m.h5,base.yml,scene.yml} .
    # of the trained lubricant: M from 9.5 to 13 and L from 2.6 to 5.2
    sed 's/^moes:.*//' scene.yml >si.yml
    echo 'physical: {load: 60e3, radius: 0.01, speed: 0.2, modulus: 226e9, viscosity: 0.02}' >>si.yml
}

# judged CODE PATTERN ARGUMENT...: the exit code, and one line on stderr that matches the pattern
judged() {
    local code=$1 pattern=$2
    shift 2
    run --separate-stderr romrun "$@" --quiet
    echo "exit code $status, expected $code: $stderr"
    ((status == code)) && ((${#stderr_lines[@]} == 1)) && [[ $stderr =~ ^"romrun: ".*$pattern ]]
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
    # sizes by accuracy, and the most accurate ones where these do not serve
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
    # what the inlet's heating does to each, which its result has too
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
    # scenes that name none have no columns of it; a model without nodes for it says so
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
    judged 4 "some.csv:3: found 0 of 3 scenes not converged and 1 not to be trusted" base.yml --cases some.csv --model c.h5 -o t.csv
    [ "$(cut -d, -f3 t.csv | paste -sd' ')" = "status 0 4 0" ]
    grep -q '^40,3,4,.*,outside of the trained range' t.csv
    romrun base.yml --cases some.csv --model c.h5 -o t.csv --quiet --force --allow-untrusted >/dev/null
    # far outside nothing converges: a row of NaN
    printf 'moes.M,moes.L\n40,3\n1000,12\n12,5\n' >bad.csv
    judged 3 "bad.csv:3: found 1 of 3 scenes not converged and 1 not to be trusted" base.yml --cases bad.csv --model c.h5 -o u.csv --allow-untrusted
    grep -q '^1000,12,1,1000,12,.*,nan,nan,nan,nan,nan,nan,' u.csv
    # a model that was never checked: no row is to be trusted
    judged 4 "3 not to be trusted" base.yml --cases some.csv --model m.h5 -o v.csv
    # limits as for one scene
    judged 4 "some.csv:2: found 0 of 3 .* 3 not to be trusted" base.yml --cases some.csv --model c.h5 -o w.csv --accuracy-of pressure=1e-12
}

@test "--cases: refusals, before any work" {
    printf 'moes.M,moes.L\n10,3\n-1,3\n' >range.csv
    refuse 65 "range.csv:3: moes.M: found -1" romrun base.yml --cases range.csv --model c.h5 -o x.h5
    printf 'moes.M,moes.N\n10,3\n' >key.csv
    refuse 65 "key.csv:1: " romrun base.yml --cases key.csv --model c.h5 -o x.h5
    printf 'moes.M\n10\n' >lacking.csv
    refuse 65 "lacking.csv:2: .*moes.L" romrun base.yml --cases lacking.csv --model c.h5 -o x.h5
    printf 'moes.M,moes.L,grid.step\n10,3,0.05\n10,3,0.04\n' >grid.csv
    refuse 65 "grid.csv:3: " romrun base.yml --cases grid.csv --model c.h5 -o x.h5
    printf 'moes.M,moes.L,contact\n10,4,point\n' >kind.csv
    refuse 65 "kind.csv:2: contact: found point, expected line as in c.h5" \
        romrun base.yml --cases kind.csv --model c.h5 -o x.h5
    printf 'moes.M,moes.L\n10,3\n' >good.csv
    refuse 65 "moes.M: found a key that good.csv varies" romrun base.yml --cases good.csv --model c.h5 -o x.h5 --set moes.M=3
    refuse 64 "--output: found x.txt, expected NAME.csv or NAME.h5" romrun base.yml --cases good.csv --model c.h5 -o x.txt
    refuse 64 "--cases: found with --verify" romrun base.yml --cases good.csv --model c.h5 -o x.h5 --verify
    refuse 64 "--cases: found with" romrun base.yml --cases good.csv --model c.h5 -o x.h5 --fallback full
    refuse 66 "none.csv: " romrun base.yml --cases none.csv --model c.h5 -o x.h5
    refuse 65 "good.csv:2: regime: found transient" romrun base.yml --cases good.csv --model c.h5 -o x.h5 --set regime=transient --set transient.end_time=1
    touch there.csv
    refused 73 "there.csv: found an existing file" romrun base.yml --cases good.csv --model c.h5 -o there.csv
    run bash -c 'romrun base.yml --cases good.csv --model c.h5 >/dev/full'
    [[ $status == 74 && $output == *"romrun: stdout: "* ]]
}
