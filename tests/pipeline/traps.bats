#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests with hosts that trap floating-point exceptions: neither the library nor a solver raises one on ordinary scenes.

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
    model_in_time 8
    si_scene
    printf '  shear: {law: eyring, tau0: 5e6}\nslide_roll: 0.1\n' >>si.yml
    { cat point.yml && printf '%s\n' 'slide_roll: 0.1' 'lubricant.shear: {law: eyring, tau0: 5e6}'; } >sliding.yml
}

setup() {
    case $VARIANT in
    release | debug) ;;
    *) skip "a sanitizer wants to be loaded first" ;;
    esac
    cd "$BATS_TEST_TMPDIR" || return
    cp "$BATS_FILE_TMPDIR"/* .
}

# trapped COMMAND...: checks that the command ends with 0 under the traps.
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

# slides KIND LOAD TEXT...: solves a scene in SI units whose surfaces slide, with TEXT as lines of its lubricant
slides() {
    local kind=$1 load=$2
    shift 2
    printf '%s\n' "$kind" 'regime: stationary' "physical: {load: $load, radius: 0.0125, speed: 0.8, modulus: 226e9}" 'slide_roll: 0.1' \
        'lubricant:' '  density: {law: dowson-higginson}' "$@" >slides.yml
    trapped fullrun slides.yml --formulas --allow-untrusted
}

# bats test_tags=slow
@test "thinned flow, heat and all laws of shear stress raise none" {
    local oil='  viscosity: {law: roelands, eta0: 0.08, alpha: 2.0e-8' shear
    local thins='  shear: {law: eyring, tau0: 5e6, in_film: true}'
    slides 'contact: line' 300e3 "$oil}" "$thins"
    slides 'contact: point' 30 "$oil}" "$thins"
    slides $'contact: ellipse\nellipticity: 3' 30 "$oil}" "$thins"
    for shear in 'limiting, limit: 0.05' 'carreau, G: 5e6, n: 0.5' newtonian; do
        slides 'contact: line' 300e3 "$oil}" "  shear: {law: $shear}"
    done
    slides 'contact: line' 300e3 '  thermal_conductivity: 0.14' '  shear: {law: eyring, tau0: 5e6}' \
        "$oil, reference_temperature: 40, temperature: 60, temperature_coefficient: 0.03}"
    slides 'contact: line' 300e3 '  viscosity: {law: wlf, preset: no1}' '  shear: {law: eyring, tau0: 5e6}'
}

# bats test_tags=slow
@test "a reversal, a surface, a load of 0 and bodies apart raise none" {
    printf '%s\n' time,of 0,1 1,1 2,0 3,0 4,1 5,1 >load.csv
    printf '%s\n' time,of 0,1 1,1 3,-0.3 3.5,-0.3 4.5,1 5,1 >approach.csv
    for line in 'speed: {law: sine, mean: 0, amplitude: 1, phase: 1.57, period: 8}' \
        'load: {law: table, file: load.csv, column: of, interpolation: linear}' \
        'approach: {law: table, file: approach.csv, column: of, interpolation: linear}'; do
        { printf '%s\n' 'contact: line' 'regime: transient' 'moes: {M: 20, L: 5}' \
            'lubricant: {viscosity: {law: barus, alpha: 2e-8}}'
          [[ $line != approach* ]] || echo 'closure: approach'
          printf '%s\n' 'transient:' '  end_time: 5' "  $line"; } >varied.yml
        trapped fullrun varied.yml --allow-untrusted --force -o varied.h5
    done
    sed -e '/load\|approach/d' -e 's/^transient:/surface: {kind: dent, depth: 0.05, radius: 0.3}\n&/' varied.yml >dent.yml
    trapped fullrun dent.yml
}
