#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests of repeatability: the same inputs give the same bits, whatever --jobs and the threads that OpenBLAS may use.
# Times of the solution are attributes, and only these may differ.

load common

setup() {
    cd "$BATS_TEST_TMPDIR" || return
    common_setup_small
    cat >time.yml <<'YAML'
contact: line
regime: transient
moes: {M: 11, L: 4}
lubricant:
  viscosity: {law: barus, alpha: 2.0e-8}
  density: {law: dowson-higginson}
grid: {step: 0.05}
transient: {load: {law: sine, amplitude: 0.1, period: 1}, end_time: 0.5}
YAML
    # the plan is large enough for products that OpenBLAS would share among threads
    sed -i -e 's/moes.M: .*\], /moes.M: [8, 9, 10, 11, 12, 13, 14, 15], /' -e 's/moes.L: .*/moes.L: [1, 2, 3, 4, 5, 6, 7, 8]}/' plan.yml
    printf '  - scene: time.yml\n' >>plan.yml
}

# chain FOLDER JOBS THREADS: runs all stages from the plan to full and reduced results, stationary and in time.
chain() {
    mkdir "$1"
    export OPENBLAS_NUM_THREADS=$3
    snapgen plan.yml -q -o "$1/s.h5" --jobs "$2"
    for kind in coupled independent; do
        podbuild "$1/s.h5" -q -o "$1/b-$kind.h5" --deformation "$kind"
        snapgen plan.yml -q --basis "$1/b-$kind.h5" -o "$1/r-$kind.h5" --jobs "$2"
        deimselect --no-check "$1/r-$kind.h5" -q --basis "$1/b-$kind.h5" -o "$1/m-$kind.h5"
        for scene in scene time; do
            romrun $scene.yml -q --model "$1/m-$kind.h5" -o "$1/red-$kind-$scene.h5" --allow-untrusted
        done
    done
    for scene in scene time; do
        fullrun $scene.yml -q -o "$1/full-$scene.h5"
    done
}

# same_attributes A B: checks that attributes of results are equal, except times of the solution.
same_attributes() {
    /usr/bin/python3 - "$1" "$2" <<'PYTHON'
import sys, h5py
with h5py.File(sys.argv[1]) as left, h5py.File(sys.argv[2]) as right:
    for name in left.attrs:
        a, b = left.attrs[name], right.attrs[name]
        # texts hold paths and times of day
        assert isinstance(a, (str, bytes)) or name.startswith("solve_seconds") or a == b, (name, a, b)
PYTHON
}

# bats test_tags=slow
@test "all stages give the same bits again, with other --jobs and other OpenBLAS threads" {
    chain one 1 1
    chain again 1 1
    chain two 2 2
    [ "$(ls one | wc -l)" -eq 13 ]
    for file in one/*.h5; do
        for other in again two; do
            same_data "$file" "$other/${file#one/}" || { echo "$other/${file#one/}"; return 1; }
        done
    done
    for file in one/full-*.h5 one/red-*.h5; do
        for other in again two; do same_attributes "$file" "$other/${file#one/}"; done
    done
}
