#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Host programs may trap floating-point exceptions: neither the library nor a solver raises one on ordinary scenes.

load common

setup_file() {
    cd "$BATS_FILE_TMPDIR" || return
    cat >trap.c <<'C'
#define _GNU_SOURCE
#include <fenv.h>
__attribute__((constructor)) static void trap(void) {
    feenableexcept(FE_INVALID | FE_DIVBYZERO);
}
C
    gcc -shared -fPIC trap.c -o trap.so -lm
    small_model
    cp scene.yml line.yml
    small_point_model
    moving_scene "x_min: -4, x_max: 2, step: 0.05" "end_time: 0.3, fixed_step: 0.05"
    time_plan train "1, 2" "0.1"
    model_in_time 8 --no-check
    si_scene
    printf '  shear: {law: eyring, tau0: 5e6}\nslide_roll: 0.1\n' >>si.yml
    { cat point.yml && echo "slide_roll: 0.1"; } >sliding.yml
}

setup() {
    case $VARIANT in
    release | debug) ;;
    *) skip "a sanitizer wants to be loaded first" ;;
    esac
    cd "$BATS_TEST_TMPDIR" || return
    cp "$BATS_FILE_TMPDIR"/* .
}

# trapped COMMAND...: it ends with 0.
trapped() {
    echo "$*"
    LD_PRELOAD=$PWD/trap.so "$@" >said 2>&1 || { echo "exit code $?" && cat said && return 1; }
}

@test "the trap is there" {
    printf '#include <stdlib.h>\nint main(void) { return atof("nan") < 1; }\n' >compare.c
    gcc compare.c -o compare
    LD_PRELOAD=$PWD/trap.so run -136 ./compare
}

@test "the library's calls, of lines and points, stationary and in time, raise no exception" {
    local use_library=$BIN/../unit/use_library
    trapped "$use_library" solve m.h5 line.yml
    trapped "$use_library" solve p.h5 point.yml
    trapped "$use_library" units m.h5 si.yml
    trapped "$use_library" units p.h5 point.yml
    trapped "$use_library" derivatives m.h5 si.yml
    trapped "$use_library" march tm.h5 moving.yml 0.01 20
    trapped "$use_library" threads m.h5 line.yml
    printf 'models:\n- tm.h5\n- tm.h5\n' >models.yml
    trapped "$use_library" march models.yml moving.yml 0.01 5
}

@test "fullrun and romrun raise none" {
    for scene in line point moving si sliding; do
        trapped fullrun $scene.yml
    done
    trapped fullrun point.yml --set regime=transient --set transient.end_time=0.05 --set transient.load.law=sine \
        --set transient.load.amplitude=0.05 --set transient.load.period=1
    trapped fullrun line.yml --set discretization=published
    trapped fullrun moving.yml --set transport=upwind
    trapped romrun line.yml --model c.h5
    trapped romrun si.yml --model c.h5 --allow-untrusted
    trapped romrun si.yml --model c.h5 --fallback full
    trapped romrun sliding.yml --model p.h5 --allow-untrusted
    trapped romrun moving.yml --model tm.h5 --allow-untrusted
    trapped romrun --export tm.h5 -o tm.ehdrom
    trapped romrun moving.yml --model tm.ehdrom --allow-untrusted
    trapped romrun --fmu si.yml --model c.h5 -o c.fmu
}
