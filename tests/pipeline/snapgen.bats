#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later

load common

setup() {
    common_setup
}

# Writes a plan that takes about a second, to be stopped on the way.
slow_plan() {
    cat >slow.yml <<'YAML'
groups:
  - scene: base.yml
    vary: {moes.M: [8, 10, 12, 15], moes.L: [1, 2, 3, 4, 5, 6]}
YAML
    slow=(slow.yml --set grid.step=0.0025)
}

# ---- solutions

@test "runs a plan" {
    run --separate-stderr snapgen plan.yml -o s.h5 --quiet
    [ "$status" -eq 0 ]
    [ -z "$stderr" ]
    [[ $output == "6 points, 6 converged, "* ]]
    [ ! -e s.h5.partial ]
    snapgen --check s.h5
    # states follow the order of the plan, the last key varying fastest
    [[ $(h5dump -d moes_M s.h5) == *"8, 8, 12, 12, 20, 20"* ]]
    [[ $(h5dump -d moes_L s.h5) == *"2, 5, 2, 5, 2, 5"* ]]
}

@test "each point is the solution that fullrun finds" {
    snapgen plan.yml -o s.h5
    fullrun scene.yml -o r.h5 --set moes.M=20 --set moes.L=5
    /usr/bin/python3 - <<'PYTHON'
import h5py, numpy
with h5py.File("s.h5") as s, h5py.File("r.h5") as r:
    for name in ["pressure", "film_thickness", "rigid_approach", "central_film_thickness",
                 "minimum_film_thickness", "central_pressure", "exit_position"]:
        numpy.testing.assert_allclose(s[name][5], r[name][0], rtol=1e-7, atol=1e-8, err_msg=name)
    for name in ["moes_M", "moes_L", "alpha_p_H", "hertz_pressure"]:
        assert s[name][5] == r.attrs[name], name
    exit = s["exit_node"][5]
    assert s["x"][exit - 1] <= s["exit_position"][5] <= s["x"][exit]
    assert (s["pressure"][5, exit:] == 0).all() and s["pressure"][5, exit - 1] > 0
PYTHON
}

@test "its file opens with h5py, xarray and ncdump" {
    snapgen plan.yml -o s.h5
    run "$BATS_TEST_DIRNAME/open_elsewhere.py" s.h5
    echo "$output"
    [ "$status" -ne 2 ] || skip "a reader is not installed"
    [ "$status" -eq 0 ]
}

@test "a scene is a plan of one point" {
    run --separate-stderr snapgen scene.yml -o s.h5 --quiet
    [ "$status" -eq 0 ]
    [[ $output == "1 points, 1 converged, "* ]]
}

# bats test_tags=slow
@test "--jobs changes no result" {
    slow_plan
    snapgen "${slow[@]}" -o one.h5 --jobs 1
    snapgen "${slow[@]}" -o two.h5 --jobs 2
    snapgen "${slow[@]}" -o many.h5 --jobs 9
    same_data one.h5 two.h5
    same_data one.h5 many.h5
}

# bats test_tags=slow
@test "shards have the bits of the whole, in the order of the plan, and so has their basis" {
    slow_plan
    snapgen "${slow[@]}" -o all.h5
    snapgen "${slow[@]}" -o cold.h5 --cold
    for total in 3 4 8; do
        for ((k = 1; k <= total; k++)); do
            snapgen "${slow[@]}" -o "shard$k.h5" --force --shard "$k/$total"
        done
        /usr/bin/python3 - "$total" <<'PYTHON'
import sys, h5py, numpy
with h5py.File("all.h5") as whole, h5py.File("cold.h5") as cold:
    parts = [h5py.File(f"shard{k + 1}.h5") for k in range(int(sys.argv[1]))]
    assert min(len(part["status"]) for part in parts) > 0
    for name in whole:
        if name in ("x", "y", "state") or whole[name].shape[:1] != whole["status"].shape: continue
        joined = numpy.concatenate([part[name][...] for part in parts])
        assert joined.tobytes() == whole[name][...].tobytes(), name
    # most points start from a neighbour
    assert (whole["pressure"][...] != cold["pressure"][...]).any(axis=1).sum() > 12
PYTHON
    done
    podbuild all.h5 -o whole-basis.h5
    podbuild shard[1-8].h5 -o basis.h5
    same_data whole-basis.h5 basis.h5
    refused 64 "--shard: found 9 shards, expected at most 8, .* slow.yml" \
        snapgen "${slow[@]}" -o s.h5 --shard 1/9
}

# bats test_tags=slow
@test "--cold: each point depends on itself alone, so shards have the bits of the whole" {
    snapgen plan.yml -o warm.h5
    snapgen plan.yml -o all.h5 --cold --jobs 1
    for k in 1 2 3; do
        snapgen plan.yml -o "shard$k.h5" --cold --shard "$k/3"
    done
    /usr/bin/python3 - <<'PYTHON'
import h5py, numpy
def points(name):
    with h5py.File(name) as file:
        assert (file["complementarity"][...] == 0).all()
        return {(m, l): (i, p) for m, l, i, p in
                zip(file["moes_M"], file["moes_L"], file["newton_iterations"], file["pressure"])}
whole, warm = points("all.h5"), points("warm.h5")
parts = {key: value for k in (1, 2, 3) for key, value in points(f"shard{k}.h5").items()}
assert len(parts) == len(whole) == 6
for key, (iterations, pressure) in whole.items():
    assert parts[key][0] == iterations and (parts[key][1] == pressure).all()
    numpy.testing.assert_allclose(warm[key][1], pressure, rtol=0, atol=1e-8)
assert any(warm[key][0] != whole[key][0] for key in whole)
PYTHON
}

# bats test_tags=slow
@test "--resume tells a cold run from one that starts from neighbours" {
    slow_plan
    stop_when KILL 'states >= 1' s.h5 snapgen "${slow[@]}" -o s.h5 --cold
    refused 65 "s.h5.partial: found other settings" snapgen "${slow[@]}" -o s.h5 --resume
    snapgen "${slow[@]}" -o s.h5 --resume --cold
    snapgen "${slow[@]}" -o whole.h5 --cold
    same_data whole.h5 s.h5
}

@test "points outside of the plan's bounds are left out, even where the law does not hold" {
    cat >where.yml <<'YAML'
groups:
  - scene:
      contact: line
      regime: stationary
      lubricant: {viscosity: {law: wlf, preset: no2}}
      grid: {step: 0.02}
    vary: {moes.M: [10, 1000], moes.L: [3, 20]}
    where: {alpha_p_H: [0, 20]}
YAML
    run --separate-stderr snapgen where.yml -o s.h5
    [ "$status" -eq 0 ]
    [[ $output == "1 points"* ]]
    [[ $stderr == *"3 of 4 points lie outside of the bounds"* ]]
    sed -i 's/\[0, 20\]/[0, 2000]/' where.yml
    refused 65 "where.yml: point M=1000 L=20: Hertz pressure: found .* limit" \
        snapgen where.yml -o t.h5
    sed -i 's/\[0, 2000\]/[0, 0.1]/' where.yml
    refused 65 "where.yml: where: found all 4 points outside" snapgen where.yml -o t.h5
    [ ! -e t.h5 ]
    [ ! -e t.h5.partial ]
    # bounds on M keep M = 10 and leave out M = 1000
    sed -i 's/alpha_p_H: .*/moes_M: [5, 500]}/; s/3, 20/3, 5/' where.yml
    run -0 --separate-stderr snapgen where.yml -o m.h5
    [[ $stderr == *"2 of 4 points lie outside of the bounds"* ]]
    [ "$(romrun --print m.h5 moes_M | tail -n +2 | tr '\n' ' ')" = "10 10 " ]
}

@test "several lubricants and groups make one file" {
    cat >groups.yml <<'YAML'
groups:
  - scene: base.yml
    vary: {moes.M: [10, 12], lubricant.viscosity.alpha: [1.5e-8, 2e-8]}
    combine: grid
  - scene: scene.yml
YAML
    sed -i 's/^groups:/groups:/; s/scene: base.yml/scene: l3.yml/' groups.yml
    (cat base.yml && echo 'moes: {L: 3}') >l3.yml
    run --separate-stderr snapgen groups.yml -o s.h5 --quiet
    [ "$status" -eq 0 ]
    [[ $output == "5 points, 5 converged"* ]]
}

# ---- interruption and resume

# bats test_tags=slow
@test "Ctrl-C leaves no final file, and --resume gives what an uninterrupted run gives" {
    slow_plan
    snapgen "${slow[@]}" -o whole.h5
    stop_when INT 'states >= 3' s.h5 snapgen "${slow[@]}" -o s.h5 --jobs 1
    [ "$code" -eq 130 ]
    [ ! -e s.h5 ]
    [ -e s.h5.partial ]
    # the file is unfinished, so no stage takes it
    run snapgen --check s.h5.partial
    [ "$status" -eq 65 ]

    run --separate-stderr snapgen "${slow[@]}" -o s.h5 --resume
    [ "$status" -eq 0 ]
    [[ $stderr =~ "s.h5.partial: "([0-9]+)" of 24 points are done" ]]
    [ "${BASH_REMATCH[1]}" -ge 3 ]
    [ "${BASH_REMATCH[1]}" -lt 24 ]
    [ ! -e s.h5.partial ]
    snapgen --check s.h5
    same_data whole.h5 s.h5
}

# bats test_tags=slow
@test "kill -9, again and again, loses no finished point" {
    slow_plan
    snapgen "${slow[@]}" -o whole.h5
    for states in 2 8 14; do
        stop_when KILL "states >= $states" s.h5 snapgen "${slow[@]}" -o s.h5 --resume
        [ ! -e s.h5 ]
    done
    run --separate-stderr snapgen "${slow[@]}" -o s.h5 --resume --jobs 1
    [ "$status" -eq 0 ]
    [[ $stderr =~ "s.h5.partial: "([0-9]+)" of 24 points are done" ]]
    [ "${BASH_REMATCH[1]}" -ge 14 ]
    same_data whole.h5 s.h5
}

# partial_of FILE PYTHON: makes s.h5.partial, as left by a run that was killed after it had written all of FILE. The
# code PYTHON changes this file as `f`.
partial_of() {
    patch "$1" "f.attrs['complete'] = numpy.int64(0)
    $2"
    mv bad.h5 s.h5.partial
}

# bats test_tags=slow
@test "--resume solves again what is not as it was solved, or cannot be" {
    snapgen plan.yml -o whole.h5 --quiet
    for change in "f['exit_node'][0] = 10**6" "f['moes_M'][1] = -3" "f['moes_M'][1] *= 1.5" \
        "f['rigid_approach'][2] = numpy.inf" "f['film_thickness'][3, 7] = numpy.nan" "f['moes_L'][4] = -1" \
        "f['hertz_pressure'][4] = numpy.nan" "f['status'][5] = -1; f['pressure'][5] = numpy.nan"; do
        partial_of whole.h5 "$change"
        run --separate-stderr snapgen plan.yml -o s.h5 --resume
        [ "$status" -eq 0 ]
        [[ $stderr == *"s.h5.partial: 5 of 6 points are done"* ]]
        snapgen --check s.h5
        same_data whole.h5 s.h5
        rm s.h5
    done
    partial_of whole.h5 "pass"
    run --separate-stderr snapgen plan.yml -o s.h5 --resume
    [[ $stderr == *"s.h5.partial: 6 of 6 points are done"* ]]
}

@test "--resume refuses another plan, and starts anew where there is nothing" {
    slow_plan
    stop_when KILL 'states >= 1' s.h5 snapgen "${slow[@]}" -o s.h5
    refused 65 "s.h5.partial: found other settings" snapgen plan.yml -o s.h5 --resume
    refused 65 "s.h5.partial: found other settings" \
        snapgen "${slow[@]}" -o s.h5 --resume --shard 1/2
    head -c 1000 /dev/urandom >t.h5.partial
    refused 65 "t.h5.partial: " snapgen plan.yml -o t.h5 --resume
    snapgen plan.yml -o u.h5 --resume
    snapgen --check u.h5
    refused 73 "u.h5: found an existing file" snapgen plan.yml -o u.h5 --resume
}

# bats test_tags=slow
@test "an interrupted run is continued or replaced, never discarded unasked" {
    slow_plan
    for signal in INT KILL; do
        stop_when $signal 'states >= 1' s.h5 snapgen "${slow[@]}" -o s.h5 --jobs 1
        cp s.h5.partial before
        for command in "snapgen ${slow[*]}" "snapgen plan.yml" "fullrun scene.yml"; do
            refused 73 "s.h5.partial: found an interrupted run with solved points, expected --resume .* --force" \
                $command -o s.h5
            cmp s.h5.partial before
        done
        snapgen plan.yml -o s.h5 --force
        [ ! -e s.h5.partial ]
        [ "$(h5dump -d moes_M s.h5 | grep -c 12)" -gt 0 ]
        rm s.h5
    done
    # a file without solved points is replaced
    head -c 1000 /dev/urandom >s.h5.partial
    snapgen plan.yml -o s.h5
}

@test "two runs do not write the same file" {
    slow_plan
    stop_when STOP 'states >= 1' s.h5 snapgen "${slow[@]}" -o s.h5
    run --separate-stderr snapgen plan.yml -o s.h5
    kill -KILL "$pid" # in any case, as bats waits for the program
    [ "$status" -eq 73 ]
    [[ $stderr == *"s.h5.partial: found another process"* ]]
}

# ---- points that fail

# Writes a plan in which two points have an exit beyond the domain, the second below the first; the others converge.
failing_plan() {
    cat >failing.yml <<'YAML'
groups:
  - scene: base.yml
    vary: {moes.M: [1, 2, 12], moes.L: [1, 3]}
YAML
    failing=(failing.yml --set grid.x_max=1.12)
}

@test "a point that does not converge is reported and left out, the rest is kept, exit 3" {
    failing_plan
    run --separate-stderr snapgen "${failing[@]}" -o s.h5 --quiet
    echo "$output $stderr"
    [ "$status" -eq 3 ]
    [[ $stderr == *"snapgen: point M=1 L=1: not converged: found the exit boundary outside"* ]]
    [[ ${stderr_lines[-1]} =~ "failing.yml: found "([0-9])" of 6 points not converged" ]]
    lost=${BASH_REMATCH[1]}
    [ "${#stderr_lines[@]}" -eq $((lost + 1)) ]
    [ ! -e s.h5.partial ]
    snapgen --check s.h5
    /usr/bin/python3 - "$lost" <<'PYTHON'
import sys, h5py, numpy
with h5py.File("s.h5") as file:
    status = file["status"][...]
    assert (status == 1).sum() == int(sys.argv[1]) and (status == 0).sum() > 0, status
    assert numpy.isnan(file["pressure"][...][status == 1]).all()
    assert numpy.isfinite(file["pressure"][...][status == 0]).all()
    assert (file["exit_node"][...][status == 1] == -1).all()
    assert numpy.isfinite(file["moes_M"][...]).all()
PYTHON
    # as many failures as are allowed give exit code 0
    run --separate-stderr snapgen "${failing[@]}" -o t.h5 --quiet --allow-failures "$lost"
    [ "$status" -eq 0 ]
    run snapgen "${failing[@]}" -o t.h5 --quiet --force --allow-failures $((lost - 1))
    [ "$status" -eq 3 ]
    same_data s.h5 t.h5
}

@test "a plan of which no point converges is exit 3, whatever is allowed, and an existing output stays" {
    failing_plan
    sed -i 's/1, 2, 12/1/; s/1, 3/0.5, 1/' failing.yml
    echo precious >s.h5
    for allowed in 0 2 1000; do
        run --separate-stderr snapgen "${failing[@]}" -o s.h5 --force --quiet \
            --allow-failures $allowed
        echo "$status $stderr"
        [ "$status" -eq 3 ]
        [ -z "$output" ]
        [ "${#stderr_lines[@]}" -eq 3 ] # one for each point, and a summary
        [ "${stderr_lines[-1]}" = "snapgen: failing.yml: found none of 2 points converged, expected \
at least one" ]
        [ "$(cat s.h5)" = precious ]
    done
    run --separate-stderr snapgen "${failing[@]}" -o s.h5 --force --quiet --resume
    [ "$status" -eq 3 ]
    [ "$(cat s.h5)" = precious ]
}

# ---- bad plans

# bad_plan PATTERN [CODE]: checks that snapgen refuses the plan on stdin
bad_plan() {
    cat >bad.yml
    refused "${2:-65}" "$1" snapgen bad.yml -o s.h5
    [ ! -e s.h5 ]
    [ ! -e s.h5.partial ]
}

@test "malformed plans are refused" {
    bad_plan "bad.yml" </dev/null
    bad_plan "bad.yml:" <<<'groups: ['
    bad_plan "bad.yml:1: " <<<'groups: []'
    bad_plan "bad.yml:1: " <<<'groups: 5'
    sed 's/vary/varry/' plan.yml | bad_plan "bad.yml:3: varry: found an unknown key"
    (cat plan.yml && echo 'more: 1') | bad_plan "bad.yml:4: "
    sed 's/moes.M/moes.N/' plan.yml | bad_plan "bad.yml:3: .*moes.N"
    sed 's/12,/1e-1O,/' plan.yml | bad_plan "moes.M: found 1e-1O"
    sed 's/12,/nan,/' plan.yml | bad_plan "moes.M: found nan"
    sed 's/12,/-12,/' plan.yml | bad_plan "moes.M: found -12"
    sed 's/\[2, 5\]/[]/' plan.yml | bad_plan "bad.yml:3: .*empty list"
    sed 's/, moes.L: .*/}/' plan.yml | bad_plan "moes.L"
    sed 's/base.yml/none.yml/' plan.yml | bad_plan "none.yml: found" 66
    (cat plan.yml && echo '    where: {alpha_p_H: [5, 1]}') | bad_plan "bad.yml:4: alpha_p_H"
    (cat plan.yml && echo '    points: none.csv') | bad_plan "bad.yml:4: points"
}

@test "bad tables of points are refused" {
    printf 'groups:\n  - scene: base.yml\n    points: points.csv\n' >csv.yml
    try() { # TEXT CODE PATTERN
        printf "$1" >points.csv
        refused "$2" "$3" snapgen csv.yml -o s.h5
    }
    refused 66 "points.csv: found" snapgen csv.yml -o s.h5
    try '' 65 "points.csv"
    try 'M,L\n' 65 "points.csv: found a header only"
    try 'M,L\n1,2,3\n' 65 "points.csv:2: found 3 columns"
    try 'M,L\n10,2\n10\n' 65 "points.csv:3: found 1 column"
    try 'M,N\n10,2\n' 65 "points.csv:1: .*N"
    try 'M,L\n10,x\n' 65 "points.csv:2: moes.L: found x"
    printf 'M,L\n10,2\n12,3\n' >points.csv
    snapgen csv.yml -o s.h5
}

@test "points on different grids are refused, and both are named" {
    sed 's/moes.L: .*/moes.L: [3], grid.step: [0.02, 0.025]}/' plan.yml >grids.yml
    refused 65 "grids.yml: grid: found 241 nodes.*at point M=8 L=3, expected 301.*at point M=8 L=3" \
        snapgen grids.yml -o s.h5
}

# ---- the command line and files

@test "misuse is one line and exit 64" {
    for jobs in 0 -1 x 1e3 2.5 '' 99999999999999999999; do
        refused 64 "--jobs: found" snapgen plan.yml -o s.h5 "--jobs=$jobs"
    done
    for shard in 0/2 3/2 1 1/ /2 a/b 1/0 1/2/3 '' -1/2; do
        refused 64 "--shard: found" snapgen plan.yml -o s.h5 "--shard=$shard"
    done
    refused 64 "--shard: found 5 shards, expected at most 4" snapgen plan.yml -o s.h5 --shard 1/5
    refused 64 "--allow-failures: found" snapgen plan.yml -o s.h5 --allow-failures=-1
    refused 64 "--cold: found with --basis" snapgen plan.yml --cold --basis b.h5 -o s.h5
    refused 64 "PLAN.yml" snapgen -o s.h5
    refused 64 "output" snapgen plan.yml
    [ ! -e s.h5 ]
    [ ! -e s.h5.partial ]
}

@test "an existing output is kept, and replaced only with --force" {
    echo precious >s.h5
    refused 73 "s.h5: found an existing file" snapgen plan.yml -o s.h5
    [ "$(cat s.h5)" = precious ]
    snapgen plan.yml -o s.h5 --force
    snapgen --check s.h5
}

@test "an output that cannot be created is 73" {
    refused 73 "plan.yml/s.h5" snapgen plan.yml -o plan.yml/s.h5
    refused 73 "none/s.h5" snapgen plan.yml -o none/s.h5
}

@test "a full disk is 74, and an existing output stays" {
    echo precious >s.h5
    limited() {
        (ulimit -f 16 && snapgen "$@")
    }
    run --separate-stderr limited plan.yml -o s.h5 --force --quiet
    echo "$status $stderr"
    [ "$status" -eq 74 ]
    [ "${#stderr_lines[@]}" -eq 1 ]
    [[ $stderr == "snapgen: s.h5"* ]]
    [ "$(cat s.h5)" = precious ]
}

@test "--check: silent and 0, or one line and 65" {
    snapgen plan.yml -o good.h5
    head -c $(($(stat -c %s good.h5) / 2)) good.h5 >cut.h5
    /usr/bin/python3 - <<'PYTHON'
import h5py
with h5py.File("good.h5") as file:
    place = file["film_thickness"].id.get_chunk_info(1).byte_offset + 800
data = bytearray(open("good.h5", "rb").read())
data[place] ^= 64
open("flipped.h5", "wb").write(data)
PYTHON
    run snapgen --check good.h5
    [ "$status" -eq 0 ]
    [ -z "$output" ]
    for bad in cut.h5 flipped.h5 plan.yml; do
        refused 65 "$bad: " snapgen --check "$bad"
    done
}
