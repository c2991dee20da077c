# SPDX-License-Identifier: GPL-3.0-or-later
# Functions of all pipeline tests. BIN is the folder of the programs (tests/run.sh).

bats_require_minimum_version 1.5.0
PATH=$BIN:$PATH

# is_installed: checks whether this variant has the library for other programs. outside: skips the test if this variant
# does not have it.
is_installed() { [[ $VARIANT == release || $VARIANT == debug ]]; }
outside() { is_installed || skip "the library is not built with sanitizers"; }

# base_scene [GRID]: writes base.yml, a line contact without M and L, in the current folder.
base_scene() {
    cat >base.yml <<'YAML'
contact: line
regime: stationary
lubricant:
  viscosity: {law: barus, alpha: 2.0e-8}
  density: {law: dowson-higginson}
YAML
    [ $# -eq 0 ] || echo "grid: {$1}" >>base.yml
}

# Makes a small scene (301 nodes) and a small plan (6 points) in the test's own folder.
common_setup() {
    cd "$BATS_TEST_TMPDIR" || return
    cat >scene.yml <<'YAML'
contact: line
regime: stationary
moes: {M: 12, L: 8}
lubricant:
  viscosity: {law: barus, alpha: 2.0e-8}
  density: {law: dowson-higginson}
grid: {x_min: -4, x_max: 2, step: 0.02}
YAML
    grep -v moes scene.yml >base.yml
    cat >plan.yml <<'YAML'
groups:
  - scene: base.yml
    vary: {moes.M: [8, 12, 20], moes.L: [2, 5]}
YAML
}

# Writes a scene with 121 nodes and a plan of 9 points around it, in the current folder.
common_setup_small() {
    cat >scene.yml <<'YAML'
contact: line
regime: stationary
moes: {M: 12, L: 4}
lubricant:
  viscosity: {law: barus, alpha: 2.0e-8}
  density: {law: dowson-higginson}
grid: {x_min: -4, x_max: 2, step: 0.05}
YAML
    grep -v moes scene.yml >base.yml
    cat >plan.yml <<'YAML'
groups:
  - scene: base.yml
    vary: {moes.M: [8, 11, 15], moes.L: [2, 4, 6]}
YAML
}

# Makes m.h5 and c.h5 in the current folder. m.h5 is trained on the plan of common_setup_small with two more values of
# M, and is never checked. c.h5 is calibrated on check.yml, which has four scenes between the training points.
small_model() {
    common_setup_small
    sed 's/\[8, 11, 15\]/[8, 9.5, 11, 13, 15]/' plan.yml >train.yml
    cat >check.yml <<'YAML'
groups:
  - scene: base.yml
    vary: {moes.M: [10, 12], moes.L: [3, 5]}
YAML
    snapgen train.yml -o s.h5 --quiet
    podbuild s.h5 -o b.h5 --pressure-modes 12
    snapgen train.yml --basis b.h5 -o r.h5 --quiet
    deimselect r.h5 --basis b.h5 -o m.h5 --no-check
    romrun --calibrate check.yml --model m.h5 -o c.h5 --quiet
}

# moving_scene GRID TIME: writes moving.yml, a line contact under a load that swings by 10 % with period 1.
moving_scene() {
    cat >moving.yml <<YAML
contact: line
regime: transient
moes: {M: 12, L: 4}
lubricant: {viscosity: {law: barus, alpha: 2.0e-8}}
grid: {$1}
transient: {load: {law: sine, amplitude: 0.1, period: 1}, $2}
YAML
}

# time_plan NAME PERIODS AMPLITUDE: writes NAME-time.yml, a plan that varies period and amplitude of the load of
# moving.yml.
time_plan() {
    cat >"$1-time.yml" <<YAML
groups:
  - scene: moving.yml
    vary: {transient.load.period: [$2], transient.load.amplitude: [$3]}
YAML
}

# model_in_time MODES [OPTION...]: trains tm.h5 on train-time.yml, with options of deimselect.
model_in_time() {
    snapgen train-time.yml -o ts.h5 --quiet
    podbuild ts.h5 -o tb.h5 --pressure-modes "$1"
    snapgen train-time.yml --basis tb.h5 -o tr.h5 --quiet
    deimselect tr.h5 --basis tb.h5 -o tm.h5 "${@:2}"
}

# si_scene: writes si.yml, a line contact in SI units with M = 12, L = 4, as in the models of common_setup_small.
si_scene() {
    cat >si.yml <<'YAML'
contact: line
regime: stationary
physical: {load: 20e3, radius: 0.01, speed: 0.0376, modulus: 220e9, viscosity: 0.02}
lubricant:
  viscosity: {law: barus, alpha: 2.0e-8}
  density: {law: dowson-higginson}
YAML
}

# point_scene M X_MIN: writes scene.yml, a point contact with 33 nodes across, in the current folder.
point_scene() {
    cat >scene.yml <<YAML
contact: point
regime: stationary
moes: {M: $1, L: 5}
lubricant:
  viscosity: {law: barus, alpha: 2.0e-8}
  density: {law: dowson-higginson}
grid: {x_min: $2, x_max: 1.5, step: 0.125, y_max: 2}
YAML
}

# small_point_model: writes point.yml, a point contact in SI units of about M = 15 and L = 6, and makes p.h5, a model of
# nine points around it, in the current folder. This takes a second.
small_point_model() {
    point_scene 15 -2.5
    sed -e 's/^moes:.*/physical: {load: 8, radius: 0.01, speed: 1, modulus: 220e9, viscosity: 0.08}/' \
        -e 's/alpha: .*}/alpha: 1.0e-8}/' scene.yml >point.yml
    rm scene.yml
    cat >points.yml <<'YAML'
groups:
  - scene: point.yml
    vary: {physical.load: [6.5, 8, 10], physical.speed: [0.8, 1, 1.25]}
YAML
    snapgen points.yml -o sp.h5 --quiet
    podbuild sp.h5 -o bp.h5
    snapgen points.yml --basis bp.h5 -o rp.h5 --quiet
    deimselect --no-check rp.h5 --basis bp.h5 -o p.h5 --rows 60 --method sopt
}

# half_and_whole_are_symmetric OPTION...: solves scene.yml on half of the domain (half.h5) and on the whole domain
# (whole.h5). Checks that both results have the same symmetric fields.
half_and_whole_are_symmetric() {
    fullrun scene.yml "$@" -o half.h5
    fullrun scene.yml "$@" --set grid.half=false -o whole.h5
    fullrun --check half.h5
    /usr/bin/python3 - <<'PYTHON'
import h5py, numpy
half, whole = h5py.File("half.h5"), h5py.File("whole.h5")
for name in "pressure", "film_thickness", "exit_position":
    a, b = half[name][...], whole[name][...]
    assert numpy.array_equal(a, a[:, ::-1], equal_nan=True), name
    assert numpy.allclose(a, b, rtol=0, atol=1e-9, equal_nan=True), name
PYTHON
}

# refused CODE PATTERN COMMAND...: checks the exit code, and that stderr is one line that starts with the program's name
# and matches the pattern.
refused() {
    local code=$1 pattern=$2
    shift 2
    run --separate-stderr "$@"
    if ((status != code)) || ((${#stderr_lines[@]} != 1)) || [[ ! $stderr =~ $pattern ]] ||
        [[ $stderr != "$1: "* ]] || [[ -n $output ]]; then
        printf '%s\n' "command: $*" "exit code: $status, expected $code" "stdout: $output" \
            "stderr: $stderr" "expected: $1: ... $pattern"
        return 1
    fi
}

# refuse CODE PATTERN COMMAND... -o x.h5: checks that the command is refused and leaves no file
refuse() {
    refused "$@"
    [ ! -e x.h5 ]
    [ ! -e x.h5.partial ]
}

# same_data A B: checks that all datasets are equal to the last bit, where NaN equals NaN. It skips what depends on the
# clock: restart slots, the times of the sizes of a checked model, and the times of training rounds.
same_data() {
    /usr/bin/python3 - "$1" "$2" <<'PYTHON'
import sys, h5py
with h5py.File(sys.argv[1]) as left, h5py.File(sys.argv[2]) as right:
    assert set(left) == set(right), set(left) ^ set(right)
    for name in left:
        if name in ("restart", "restart_entries", "position_seconds", "position_step_seconds", "round_seconds"): continue
        assert left[name][...].tobytes() == right[name][...].tobytes(), name
PYTHON
}

# number FILE NAME: prints the first entry of a dataset, or an attribute of the root. If there is none, it prints a text
# that differs for each file.
number() {
    /usr/bin/python3 - "$1" "$2" <<'PYTHON' || echo "no $2 in $1"
import sys, h5py
with h5py.File(sys.argv[1]) as file:
    name = sys.argv[2]
    print(repr(float(file[name][...].flat[0] if name in file else file.attrs[name])))
PYTHON
}

# are_numbers TEXT...: checks that all texts are finite numbers. This is needed because awk reads other texts as 0, and
# because <= is true for NaN in awk.
are_numbers() {
    local text
    for text; do
        [[ $text =~ ^[-+]?[0-9.]+(e[-+]?[0-9]+)?$ ]] || { echo "found '$text', expected a number"; return 1; }
    done
}

# is_within A B RELATIVE: checks that |A - B| <= RELATIVE |B|
is_within() {
    awk -v a="$1" -v b="$2" -v r="$3" 'BEGIN { d = a - b; if (d < 0) d = -d; s = b < 0 ? -b : b; exit !(d <= r * s) }'
}

# close_to A B RELATIVE: checks that A and B are numbers, and that is_within holds. far_from A B RELATIVE: checks that A
# and B are numbers, and that is_within does not hold.
close_to() {
    are_numbers "$1" "$2" || return
    is_within "$@" || { echo "found $1, expected $2 within $3"; return 1; }
}
far_from() {
    are_numbers "$1" "$2" || return
    ! is_within "$@" || { echo "found $1, expected more than $3 beside $2"; return 1; }
}

# shows_no PATTERN COMMAND...: checks that the command succeeds and prints lines, none of which matches the pattern.
shows_no() {
    local pattern=$1
    shift
    run -0 "$@"
    [ -n "$output" ]
    run -1 grep -e "$pattern" <<<"$output"
}

# stop_when SIGNAL CONDITION OUTPUT COMMAND...: stops a program while it writes (stop_when.py).
# It stores the exit code in `code`. After KILL, this must be the exit code of a killed program. After STOP, the program
# is only halted, and `pid` is its process id.
stop_when() {
    code=0
    if [ "$1" = STOP ]; then
        pid=$("$BATS_TEST_DIRNAME/stop_when.py" "$@")
    else
        "$BATS_TEST_DIRNAME/stop_when.py" "$@" || code=$?
        [ "$1" != KILL ] || [ "$code" -eq 137 ]
    fi
}

# copy_scenes FOLDER...: copies each FOLDER (examples/NAME or studies/NAME) and the shared files to scenes/FOLDER. In
# studies of the paper, runs with accurate rows then also use the grid of scene.yml.
copy_scenes() {
    local root=$BATS_TEST_DIRNAME/../.. folder
    mkdir -p "$BATS_TEST_TMPDIR/scenes"
    cd "$BATS_TEST_TMPDIR/scenes" || return
    cp -r "$root"/scenes/lib .
    for folder in "$@" studies/stationary-line; do
        mkdir -p "$folder"
        find "$root/scenes/$folder" -maxdepth 1 -type f -exec cp {} "$folder" \;
        [ ! -e "$folder/Makefile" ] || sed -i 's/^ACCURATE *=.*/ACCURATE = --set discretization=accurate/' "$folder/Makefile"
    done
}

# copy_scene FOLDER: copies it with a small grid and small models to scenes/studies/own or scenes/examples/own.
copy_scene() {
    copy_scenes "$1"
    cp -r "$1" "${1%/*}/own"
    cd "${1%/*}" || return
    cd own || return
    [ ! -e scene.yml ] || sed -i 's/step: [0-9.]*/step: 0.02/' scene.yml
    [ ! -e scene.yml ] || grep -q '^grid:' scene.yml || echo 'grid: {step: 0.02}' >>scene.yml
    sed -i -e 's/^model.*PRESSURE_MODES *=.*/&\nmodel.PRESSURE_MODES = 12\nmodel-fast.PRESSURE_MODES = 10\nmodel-paper.PRESSURE_MODES = 12/' \
        -e 's/^model.*DEFORMATION_MODES *=.*/&\nmodel-paper.DEFORMATION_MODES = 8/' \
        -e 's/^model.*ROWS *=.*/&\nmodel.ROWS = 40\nmodel-fast.ROWS = 40\nmodel-paper.ROWS = 40/' \
        -e 's/^FIGURE3_PRESSURE_MODES.*/FIGURE3_PRESSURE_MODES = 8 12/' \
        -e 's/^FIGURE3_DEFORMATION_MODES.*/FIGURE3_DEFORMATION_MODES = 8/' \
        -e 's/^FIGURE3_FIXED.*/FIGURE3_FIXED = 12 8/' Makefile
}

run_make() { run make BIN="$BIN" "$@"; }

# pattern of the names of the programs in the commands of make
programs='(snapgen|podbuild|deimselect|fullrun|romrun) '

# patch FILE PYTHON: copies the file to bad.h5, deletes its digest and runs the code on it as `f`
patch() {
    cp "$1" bad.h5
    /usr/bin/python3 -c "
import h5py, numpy
with h5py.File('bad.h5', 'r+') as f:
    f.attrs.pop('content_sha256', None)
    $2"
}

# sliding_scene: prints scene.yml in SI units, with sliding and an Eyring fluid
sliding_scene() {
    sed -e 's/^moes: .*/physical: {load: 4e4, radius: 0.0125, speed: 0.1, modulus: 226e9, viscosity: 0.02}/' \
        -e 's/^  density.*/&\n  shear: {law: eyring, tau0: 5e6}/' scene.yml
    echo 'slide_roll: 0.05'
}

# copy_whole_study NAME: copies a study unchanged, with its reference data and the shared files, and changes to its
# folder.
copy_whole_study() {
    local root=$BATS_TEST_DIRNAME/../..
    mkdir -p "$BATS_TEST_TMPDIR/scenes/studies"
    cp -r "$root/scenes/lib" "$BATS_TEST_TMPDIR/scenes"
    cp -r "$root/scenes/studies/$1" "$BATS_TEST_TMPDIR/scenes/studies"
    cd "$BATS_TEST_TMPDIR/scenes/studies/$1" || return
    rm -rf out
}
