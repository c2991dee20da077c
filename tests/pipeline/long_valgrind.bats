#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs the small pipeline under valgrind, which must find no read of uninitialised memory, no access beyond an array and
# no leak.

load common

setup() {
    command -v valgrind || skip "valgrind is not installed"
    common_setup
    common_setup_small
    cat >plan.yml <<'YAML'
groups:
  - scene: base.yml
    vary: {moes.M: [8, 11, 15], moes.L: [2, 6]}
YAML
}

# checked CODE COMMAND...: checks the exit code, and that valgrind reports nothing. With exit code 99 valgrind reports
# an error.
checked() {
    local code=$1
    shift
    run --separate-stderr valgrind -q --error-exitcode=99 --leak-check=full \
        --errors-for-leak-kinds=definite,indirect,possible "$@"
    if ((status != code)) || [[ $stderr == *"=="* ]]; then
        printf '%s\n' "command: $*" "exit code: $status, expected $code" "$stderr"
        return 1
    fi
}

# Runs scenes whose exit reaches the ends of the model's tables.
far_outside() {
    local M
    for M in 1 2 4 300; do
        run --separate-stderr valgrind -q --error-exitcode=99 romrun scene.yml --model m.h5 --set moes.M=$M
        echo "M=$M: $status $stderr"
        [[ $status == [34] && $stderr != *"=="* ]] || return
    done
}

@test "tables, images and flat models" {
    snapgen plan.yml -o s.h5 --quiet
    podbuild s.h5 -o b.h5
    snapgen plan.yml --basis b.h5 -o r.h5 --quiet
    deimselect --no-check r.h5 --basis b.h5 -o m.h5
    sed 's/^moes: .*/physical: {load: 60e3, radius: 0.0125, speed: 0.8, modulus: 226e9, viscosity: 0.02}/' scene.yml >si.yml
    printf 'moes.M\n9\n12\n' >cases.csv
    checked 0 fullrun si.yml -o si.h5
    checked 0 fullrun --vtk si.h5 -o si.vti
    checked 0 romrun --export m.h5 -o m.ehdrom
    checked 0 romrun --check m.ehdrom
    checked 0 romrun --allow-untrusted scene.yml --model m.ehdrom -o flat.h5 --set output.fields=true
    checked 0 romrun --allow-untrusted scene.yml --cases cases.csv --model m.ehdrom -o cases.csv.csv
    checked 0 romrun --allow-untrusted scene.yml --cases cases.csv --model m.h5 -o cases.h5
    head -c 5000 m.ehdrom >cut.ehdrom
    checked 65 romrun --check cut.ehdrom
}

@test "all five programs, deflection coupled" {
    checked 0 fullrun scene.yml -o full.h5
    checked 0 snapgen plan.yml -o s.h5 --jobs 2
    checked 0 podbuild s.h5 full.h5 -o b.h5
    checked 0 snapgen plan.yml --basis b.h5 -o r.h5 --jobs 2
    checked 0 deimselect --no-check r.h5 --basis b.h5 -o m.h5
    checked 0 romrun --allow-untrusted scene.yml --model m.h5 -o red.h5 --set output.fields=true --against full.h5
    checked 0 romrun --allow-untrusted scene.yml --model m.h5 --pressure-modes 6 --repeat 3
    checked 0 romrun --check m.h5
    far_outside
}

@test "all programs, deflection with a basis of its own, rows by pivoted QR" {
    checked 0 snapgen plan.yml -o s.h5 --shard 1/1
    checked 0 podbuild s.h5 -o b.h5 --deformation independent --pressure-modes 6 --deformation-modes 4
    checked 0 snapgen plan.yml --basis b.h5 -o r.h5
    checked 0 deimselect --no-check r.h5 --basis b.h5 -o m.h5 --method qr --rows 15
    checked 0 romrun --allow-untrusted scene.yml --model m.h5 -o red.h5 --set output.fields=true
    far_outside
}

@test "bad input and points that fail" {
    checked 3 snapgen plan.yml -o f.h5 --set grid.x_max=1.05
    snapgen plan.yml -o s.h5 --quiet
    podbuild s.h5 -o b.h5
    snapgen plan.yml --basis b.h5 -o r.h5 --quiet
    deimselect --no-check r.h5 --basis b.h5 -o m.h5
    head -c 9000 m.h5 >cut.h5
    echo 'contact: [' >bad.yml
    checked 65 fullrun bad.yml -o x.h5
    checked 65 fullrun scene.yml -o x.h5 --set moes.M=nan
    checked 3 fullrun scene.yml -o x.h5 --set moes.M=1 --set moes.L=1 --set grid.x_max=1.05
    checked 65 snapgen bad.yml -o y.h5
    checked 65 snapgen plan.yml --basis m.h5 -o y.h5
    checked 65 podbuild s.h5 -o y.h5 --pressure-modes 50
    checked 65 podbuild s.h5 cut.h5 -o y.h5
    checked 65 deimselect --no-check r.h5 --basis b.h5 -o y.h5 --rows 3
    checked 65 deimselect --no-check r.h5 --basis cut.h5 -o y.h5
    checked 65 romrun --allow-untrusted scene.yml --model cut.h5 -o y.h5
    checked 65 romrun --allow-untrusted scene.yml --model m.h5 -o y.h5 --set grid.step=0.02
    checked 73 romrun --allow-untrusted scene.yml --model m.h5 -o x.h5
    checked 64 romrun scene.yml -o y.h5
}
