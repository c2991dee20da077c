# SPDX-License-Identifier: GPL-3.0-or-later
# Functions that the tests of faults share: small runs of all programs, and the call of `sweep` (sweep.c).

load ../pipeline/common

# Makes the inputs of all programs: a training of 9 points on 121 nodes.
setup() {
    case $VARIANT in
    release | debug) ;;
    *) skip "a sanitizer and coverage have calls of their own" ;;
    esac
    cd "$BATS_TEST_TMPDIR" || return
    export SWEEP=$BIN/../fault/sweep INJECT=$BIN/../fault/inject.so
    common_setup_small
    {
        sed 's/regime: .*/regime: transient/' scene.yml
        echo 'transient: {load: {law: sine, amplitude: 0.02, period: 0.5}, end_time: 0.3, fixed_step: 0.05}'
    } >moving.yml
    cat >region.yml <<'YAML'
groups:
  - scene: base.yml
    region: {moes.M: [8, 15], moes.L: [2, 6]}
YAML
    # stationary points and a transient scene
    cat >trajectories.yml <<'YAML'
groups:
  - scene: base.yml
    vary: {moes.M: [8, 15], moes.L: [3]}
  - scene: moving.yml
YAML
    # fields that take several pages of the file
    sed 's/step: 0.05/step: 0.01/' base.yml >fine-base.yml
    sed 's/base.yml/fine-base.yml/' plan.yml >fine.yml
    snapgen -q -j1 plan.yml -o s.h5
    podbuild -q s.h5 -o b.h5
    snapgen -q -j1 plan.yml --basis b.h5 -o r.h5
    deimselect -q r.h5 --basis b.h5 --no-check -o m.h5
    romrun --export m.h5 -o m.ehdrom
    # these points are so close together that the check of the model prints no warning
    sed 's/vary: .*/vary: {moes.M: [11, 12, 13], moes.L: [3, 4]}/' plan.yml >close.yml
    snapgen -q -j1 close.yml -o close-s.h5
    podbuild -q close-s.h5 -o close-b.h5
    snapgen -q -j1 close.yml --basis close-b.h5 -o close-r.h5
    printf 'moes.M,moes.L\n9.5,3\n13,5\n' >check.csv
    printf 'groups:\n  - {scene: base.yml, points: check.csv}\n' >check.yml
    printf 'moes.M\n9\n12\n' >cases.csv
    sed 's/^moes: .*/physical: {load: 60e3, radius: 0.0125, speed: 0.8, modulus: 226e9, viscosity: 0.02}/' scene.yml >si.yml
    fullrun -q si.yml -o si.h5
    export TMPDIR=$PWD
} >/dev/null

# Sets `run` to the command of a small run, by name.
run_of() {
    case $1 in
    fullrun) run=(fullrun -q scene.yml -o x.h5) ;;
    romrun) run=(romrun -q scene.yml --model m.h5 --allow-untrusted -o x.h5) ;;
    podbuild) run=(podbuild -q s.h5 -o x.h5) ;;
    deimselect) run=(deimselect -q r.h5 --basis b.h5 --no-check -o x.h5) ;;
    checked) run=(deimselect -q -j1 close-r.h5 --basis close-b.h5 -o x.h5) ;;
    calibrate) run=(romrun -q -j1 --calibrate check.yml --model m.h5 -o x.h5) ;;
    residuals) run=(snapgen -q -j1 plan.yml --basis b.h5 -o x.h5) ;;
    vtk) run=(fullrun -q --vtk si.h5 -o x.vti) ;;
    export) run=(romrun --export m.h5 -o x.ehdrom) ;;
    fmu) run=(romrun -q --fmu si.yml --model m.h5 -o x.fmu) ;;
    flat) run=(romrun -q scene.yml --model m.ehdrom --allow-untrusted -o x.h5) ;;
    # the runs from here on can be resumed
    cases) run=(romrun -q scene.yml --cases cases.csv -j1 --model m.h5 --allow-untrusted -o x.csv) ;;
    cases-h5) run=(romrun -q scene.yml --cases cases.csv -j1 --model m.h5 --allow-untrusted -o x.h5) ;;
    snapgen) run=(snapgen -q -j1 plan.yml -o x.h5) ;;
    fine) run=(snapgen -q -j1 fine.yml -o x.h5) ;;
    trajectories) run=(snapgen -q -j1 trajectories.yml -o x.h5) ;;
    adaptive) run=(snapgen -q -j1 region.yml --accuracy 0.02 --start 5 -o x.h5) ;;
    moving) run=(fullrun -q moving.yml -o x.h5) ;;
    reduced) run=(romrun -q moving.yml --set transport=upwind --model m.h5 --allow-untrusted -o x.h5) ;;
    esac
}

# Sweeps a small run: sweep NAME KIND HOW [OPTION...].
sweep() {
    local name=$1 kind=$2 how=$3 run
    shift 3
    run_of "$name"
    case $name in
    snapgen | fine | trajectories | adaptive | moving | reduced | cases | cases-h5) set -- -r "$@" ;;
    esac
    printf '%-12s ' "$name" >>table
    "$SWEEP" "$@" "$kind" "$how" "${run[-1]}" "${run[@]}" >>table
}

# Writes the counts into the log.
teardown() {
    [ ! -e table ] || sed 's/^/# /' table >&3
}
