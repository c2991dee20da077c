#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests of scenes that leave out their grid or parts of it. The grid of a contact then follows from M and L; a plan has
# one grid for all of its points; snapshots, bases and models pass their grid on.

load common

setup_file() {
    cd "$BATS_FILE_TMPDIR" || return
    base_scene
    { cat base.yml && echo 'moes: {M: 18, L: 4}'; } >scene.yml
    cat >plan.yml <<'YAML'
groups:
  - scene: base.yml
    vary: {moes.M: [8, 10, 12.5, 15, 17, 19, 21], moes.L: [3.2, 3.7, 4.3, 4.8]}
YAML
    cat >time.yml <<'YAML'
contact: line
regime: transient
moes: {M: 18, L: 4}
lubricant:
  viscosity: {law: barus, alpha: 2.0e-8}
  density: {law: dowson-higginson}
transient: {load: {law: sine, amplitude: 0.1, period: 1}, end_time: 0.5, fixed_step: 0.0078125}
YAML
    snapgen plan.yml -q -o s.h5 >s.txt && podbuild s.h5 -q -o b.h5 &&
        snapgen plan.yml -q --basis b.h5 -o r.h5 >r.txt && deimselect --no-check r.h5 -q --basis b.h5 -o m.h5
    fullrun scene.yml -q -o own.h5 >own.txt
    fullrun scene.yml -q -o full.h5 --grid-of m.h5 >full.txt
}

setup() {
    cd "$BATS_TEST_TMPDIR" || return
    cp "$BATS_FILE_TMPDIR"/*.{yml,h5,txt} .
}

# grid_of FILE: prints the number of nodes, the first node and the step of a file.
grid_of() {
    /usr/bin/python3 - "$1" <<'PYTHON'
import sys, h5py
with h5py.File(sys.argv[1]) as file:
    print(len(file["x"]), f"{file.attrs['x_min']:g}", f"{file.attrs['step']:g}")
PYTHON
}

# said FILE: prints the same three numbers from the output of a program, and the words that say what chose the grid
said() {
    sed -nE 's/^grid +([0-9]+).* nodes from ([^ ]+) to [^ ]+ by ([^ ,]+)(, as wide and fine as needed by )?(.*)$/\1 \2 \3 \5/p' "$1"
}

# larger A B: checks that A > B for two numbers
larger() {
    are_numbers "$1" "$2" || return
    awk -v a="$1" -v b="$2" 'BEGIN { exit !(a > b) }' || { echo "found $1, expected more than $2"; return 1; }
}

# deviation NAME: prints a deviation in per mille, from the comparison in out.txt
deviation() {
    sed -n "s/^  $1 .* \([-+][0-9.]*\) permille/\1/p" out.txt
}

# bats test_tags=slow
@test "a scene without grid gets one by its M and L, and fullrun says so" {
    for moes in "2 5" "18 4" "200 5"; do
        read -r M L <<<"$moes"
        fullrun scene.yml -q --set "moes.M=$M" --set "moes.L=$L" -o "$M.h5" >"$M.txt"
        [ "$(said "$M.txt")" = "$(grid_of "$M.h5") this M and L" ]
        # the grid is chosen for small effects of inlet and step; the estimates are 1.25 times as large as the effects
        larger 2.5e-3 "$(fullrun --print "$M.h5" inlet_effect | tail -n 1)"
        larger 1.25e-3 "$(fullrun --print "$M.h5" step_effect | tail -n 1)"
        # the settings in the result contain no grid
        shows_no '^grid' fullrun --print "$M.h5" settings
    done
    read -r _ thick _ <<<"$(grid_of 2.h5)"
    read -r _ middle coarse <<<"$(grid_of 18.h5)"
    read -r _ thin fine <<<"$(grid_of 200.h5)"
    larger "$middle" "$thick"
    larger "$thin" "$middle"
    larger "$coarse" "$fine"
}

# solved KIND M L [B_OVER_A]: checks that a contact is solved on the grid that it chooses, and that the error of the
# step is estimated.
solved() {
    local ellipse=()
    [ -z "${4-}" ] || ellipse=(--set "ellipticity=$4")
    fullrun scene.yml --set "contact=$1" --set "moes.M=$2" --set "moes.L=$3" "${ellipse[@]}" \
        --set output.fields=false -q >out.txt || { echo "found $* not solved"; return 1; }
    ! grep -q "too coarse" out.txt || { echo "found $* on too coarse a grid"; return 1; }
}

# bats test_tags=slow
@test "contacts are solved on the grids that they choose, from rigid to thin films" {
    solved line 0.1 0
    solved line 0.3 25
    solved line 1 60
    solved line 2000 0
    solved point 0.1 0
    solved point 0.3 25
    # the exits of thick films lie beyond X = 2; so do the exits of wide ellipses, beside the contact
    solved ellipse 0.1 10 20
    solved ellipse 3 0 5
    solved ellipse 10 10 10
    solved ellipse 100 10 20
    # a narrow ellipse has its minimum film beside the middle
    solved ellipse 1 0 0.1
    solved ellipse 1 10 0.2
}

# bats test_tags=slow
@test "a coarse grid that needs many iterations still gives an estimate of the step" {
    # on this domain the grid with twice the step needs 22 Newton iterations
    fullrun scene.yml -q --set contact=ellipse --set ellipticity=4.86 --set moes.M=2.139 --set moes.L=20.8 \
        --set grid.x_min=-48 --set grid.x_max=44 --set grid.y_max=35.5695 --set grid.step=0.25 -o wide.h5 >out.txt
    larger 1e-3 "$(fullrun --print wide.h5 step_effect | tail -n 1)"
}

# bats test_tags=slow
@test "a chosen step that proves too coarse is halved" {
    # the minimum film depends on nodes that a coarser grid does not resolve
    incompressible=(--set moes.M=2000 --set moes.L=10 --set lubricant.density.law=incompressible)
    fullrun scene.yml "${incompressible[@]}" -o fine.h5 >out.txt 2>err.txt
    grep -q '^fullrun: scene.yml: grid.step: found that 0.000625 is too coarse, going on with 0.0003125$' err.txt
    [ "$(said out.txt)" = "$(grid_of fine.h5) this M and L" ]
    [ "$(grid_of fine.h5)" = "11201 -1.5 0.0003125" ]
    larger 0.03 "$(fullrun --print fine.h5 step_effect_minimum | tail -n 1)"
    # a step that the scene gives is kept, and so is a chosen step if there are no error estimates
    run --separate-stderr fullrun scene.yml "${incompressible[@]}" --set grid.step=0.000625
    [ "$status" -eq 4 ]
    fullrun scene.yml "${incompressible[@]}" --set output.resolution=false >out.txt
    [[ $(said out.txt) == "5601 -1.5 0.000625 "* ]]
    # a finer step does not help where the scene gives an inlet that is too short
    run --separate-stderr fullrun scene.yml --set moes.M=5 --set moes.L=10 --set grid.x_min=-1.2
    [ "$status" -eq 4 ]
    [ "$stderr" = "fullrun: scene.yml: found a grid from X = -1.2 on by 0.02, too short to estimate its error, expected a longer one (--allow-untrusted takes the result all the same)" ]
    [ "$(grep -c "grid .* %, inlet too short to tell" <<<"$output")" -eq 2 ]
}

# bats test_tags=slow
@test "progress of a long solution ends with the solution" {
    # this solution takes 20 iterations on the finest grid, where eight are usual, and lasts long enough for progress to
    # be shown
    fullrun scene.yml --set contact=point --set moes.M=300 --set moes.L=25 --set output.resolution=false \
        --set lubricant.density.law=incompressible --set grid.step=0.015625 2>err.txt >out.txt
    shows_no '999/1000' cat err.txt
}

# bats test_tags=slow
@test "what a scene gives of its grid stays, and the rest is chosen" {
    read -r nodes start step <<<"$(grid_of own.h5)"
    fullrun scene.yml --set grid.step=0.01 -q -o x.h5 >out.txt
    [ "$(grid_of x.h5)" = "$((2 * nodes - 1)) $start 0.01" ]
    [ "$(said out.txt)" = "$(grid_of x.h5) this M and L" ]
    fullrun scene.yml --set grid.x_min=-5 -q -o x.h5 --force >out.txt
    [ "$(grid_of x.h5)" = "351 -5 $step" ]
    fullrun scene.yml --set grid.x_min=-5 --set grid.x_max=1.5 --set grid.step=0.05 -q -o x.h5 --force >out.txt
    [ "$(said out.txt)" = "131 -5 0.05 " ]
    # with the published discretisation, all contacts have the same grid
    for M in 2 18 200; do
        fullrun scene.yml --set discretization=published --set moes.M=$M -q >out.txt
        [ "$(said out.txt)" = "1201 -4 0.005 " ]
    done
    # for a point contact, the width of the grid (y_max) is chosen too
    fullrun scene.yml --set contact=point --set moes.M=20 -q -o x.h5 --force >out.txt
    [[ $(said out.txt) == *" this M and L" ]]
    /usr/bin/python3 -c "
import h5py
f = h5py.File('x.h5')
assert f['y'][-1] == -f['y'][0] == -0.75 * f['x'][0] and f['x'][1] - f['x'][0] == f['y'][1] - f['y'][0]"
    refused 65 "scene.yml: grid: found [0-9]*01 nodes from .* by 1e-06 for M = 18 and L = 4, expected at most 2000000" \
        fullrun scene.yml --set grid.step=1e-6 -o y.h5
    [ ! -e y.h5 ]
}

# bats test_tags=slow
@test "a plan has one grid that serves all its points, and snapgen says so" {
    first=0 least=1
    for M in 8 10 12.5 15 17 19 21; do
        for L in 3.2 3.7 4.3 4.8; do
            fullrun scene.yml -q --set moes.M=$M --set moes.L=$L -o point.h5 --force >out.txt
            read -r _ x_min step <<<"$(grid_of point.h5)"
            larger "$first" "$x_min" && first=$x_min
            larger "$least" "$step" && least=$step
        done
    done
    [ "$(said s.txt)" = "$(grid_of s.h5) all points" ]
    read -r _ x_min step <<<"$(grid_of s.h5)"
    [ "$x_min $step" = "$first $least" ]
    # the grid of the plan is not the grid of its last point alone
    run ! diff <(grid_of s.h5) <(grid_of point.h5)
    for file in b r m; do [ "$(grid_of $file.h5)" = "$(grid_of s.h5)" ]; done
    # each shard has the grid of the whole plan
    for piece in 1 2 3; do
        snapgen plan.yml -q --shard $piece/3 -o piece-$piece.h5
        [ "$(grid_of piece-$piece.h5)" = "$(grid_of s.h5)" ]
    done
    podbuild piece-*.h5 -q -o merged.h5
}

@test "scenes of a plan that leave the grid out take that of the others" {
    cat >mixed.yml <<'YAML'
groups:
  - scene: base.yml
    vary: {moes.M: [8, 11], moes.L: [3]}
  - scene: scene.yml
    vary: {grid.x_min: [-5], grid.x_max: [2], grid.step: [0.05]}
  - scene: time.yml
YAML
    snapgen mixed.yml -q -o x.h5 >out.txt
    [ "$(grid_of x.h5)" = "141 -5 0.05" ]
    [ "$(said out.txt)" = "141 -5 0.05 " ]
    rm x.h5
    # scenes that give different grids are refused
    echo 'grid: {step: 0.025}' >>base.yml
    refuse 65 "mixed.yml: grid: found 141 nodes from -5 by 0.05 at point M=18 L=4, expected .* by 0.025 as at point M=8 L=3" \
        snapgen mixed.yml -o x.h5
}

# bats test_tags=slow
@test "romrun takes the grid of the model, and fullrun too with --grid-of" {
    [ "$(grid_of own.h5)" != "$(grid_of m.h5)" ]
    romrun --allow-untrusted scene.yml --model m.h5 -q -o rom.h5 --set output.fields=true --against full.h5 >out.txt
    [ "$(grid_of rom.h5)" = "$(grid_of m.h5)" ]
    [ "$(said out.txt)" = "$(grid_of m.h5) " ]
    for file in s b m rom; do
        fullrun scene.yml -q --grid-of $file.h5 -o x.h5 --force >x.txt
        [ "$(said x.txt)" = "$(grid_of m.h5) " ]
        same_data x.h5 full.h5
        [[ $(h5dump -a input_2_path x.h5) == *$file.h5* ]]
    done
    grep -qx "against full.h5:" out.txt
    awk -v off="$(deviation "central film thickness")" 'BEGIN { exit !(off != "" && off ^ 2 < 0.05 ^ 2) }'
    # the result of a point contact has both halves of the domain; fullrun solves one
    sed -e 's/contact: line/contact: point/' -e '/grid:/d' scene.yml >ball.yml
    fullrun ball.yml -q --set grid.x_min=-2.5 --set grid.x_max=1.5 --set grid.step=0.125 --set grid.y_max=2 -o ball.h5 || [ $? -eq 4 ]
    fullrun ball.yml -q --grid-of ball.h5 -o again.h5 || [ $? -eq 4 ]
    same_data ball.h5 again.h5
    # a grid that the scene gives must be that of the model
    read -r _ x_min step <<<"$(grid_of m.h5)"
    fullrun scene.yml -q --grid-of m.h5 --set "grid.x_min=$x_min" --set "grid.step=$step" -o x.h5 --force
    same_data x.h5 full.h5
}

# bats test_tags=slow
@test "a result on another grid is compared by interpolation, and called one" {
    read -r nodes x_min step <<<"$(grid_of own.h5)"
    romrun --allow-untrusted scene.yml --model m.h5 --set output.fields=true --against own.h5 >out.txt
    grep -qx "against own.h5 (another grid, $nodes nodes from $x_min to 2 by $step: what it does is in the deviations):" out.txt
    # the deviation agrees within a fifth with the effect of the shorter inlet that fullrun estimates
    inlet() { fullrun --print "$1" inlet_effect | tail -n 1; }
    awk -v found="$(deviation "central film thickness")" -v own="$(inlet own.h5)" -v full="$(inlet full.h5)" \
        'BEGIN { expected = 1000 * (own - full); exit !(found > 0.8 * expected && found < 1.2 * expected) }'
    # a result with another step is interpolated: this causes small errors of the film, and larger errors of the
    # pressure where the pressure curve bends
    read -r _ x_min _ <<<"$(grid_of m.h5)"
    fullrun scene.yml -q --set grid.step=0.016 --set "grid.x_min=$x_min" --set grid.x_max=2 -o fine.h5
    romrun --allow-untrusted scene.yml --model m.h5 --set output.fields=true --against fine.h5 >out.txt
    grep -qx "against fine.h5 (another grid, .* nodes from $x_min to 2 by 0.016: what it does is in the deviations):" out.txt
    largest() { sed -n "s/^  largest $1 error *\([0-9.e-]*\).*/\1/p" out.txt; }
    larger "$(largest film)" 0
    larger 5e-5 "$(largest film)"
    larger 2e-3 "$(largest pressure)"
    # the output names another discretisation on the same nodes
    fullrun scene.yml -q --set discretization=published --set "grid.x_min=$(grid_of m.h5 | cut -d' ' -f2)" \
        --set grid.step=0.02 -o published.h5
    romrun --allow-untrusted scene.yml --model m.h5 --against published.h5 >out.txt
    grep -qx "against published.h5 (another discretization, published: what it does is in the deviations):" out.txt
}

# bats test_tags=slow
@test "runs in time take the grid too, and go on only on their own" {
    cat >moving.yml <<'YAML'
groups:
  - scene: plan-base.yml
    vary: {moes.M: [8], moes.L: [5]}
  - scene: time.yml
    vary: {transient.load.period: [0.75, 1.5]}
YAML
    cp base.yml plan-base.yml
    snapgen moving.yml -q -o ts.h5
    podbuild ts.h5 -q -o tb.h5 --energy 1e-12
    snapgen moving.yml -q --basis tb.h5 -o tr.h5
    deimselect --no-check tr.h5 -q --basis tb.h5 -o tm.h5
    fullrun time.yml -q -o town.h5 >out.txt
    [[ $(said out.txt) == *" the reference and its histories" ]]
    fullrun time.yml -q -o tfull.h5 --grid-of tm.h5 >out.txt
    [ "$(said out.txt)" = "$(grid_of ts.h5) " ]
    [ "$(grid_of town.h5)" != "$(grid_of tfull.h5)" ]
    romrun time.yml -q --model tm.h5 -o tred.h5 --allow-untrusted --against tfull.h5 >out.txt
    [ "$(said out.txt)" = "$(grid_of ts.h5) " ]
    grep -qx "against tfull.h5:" out.txt
    romrun time.yml -q --model tm.h5 -o tred.h5 --force --allow-untrusted --against town.h5 >out.txt
    grep -q "^against town.h5 (another grid, .* nodes from .* to 2 by 0.02: " out.txt

    # both runs have the same settings, so only the grid differs
    sed -i 's/end_time: 0.5/end_time: 20/' time.yml
    stop_when INT "len(time) > 100" x.h5 fullrun time.yml --grid-of tm.h5 -o x.h5 --quiet
    [ "$code" -eq 130 ]
    refused 65 "x.h5.partial: x: found .* nodes from .* by 0.02, expected .*, as in the scene" \
        fullrun time.yml -o x.h5 --resume
    sed -i 's/, end_time: 20//; s/fixed_step/end_time: 0.5, fixed_step/' time.yml
}

# bats test_tags=slow
@test "in time the inlet suits the lightest load, whose film is that of a stationary contact" {
    sed -e 's/M: 18/M: 20/' -e '$d' time.yml >light.yml
    echo 'transient: {load: {law: ramp, from: 1, to: 0.05, start: 1, duration: 8}, end_time: 12}' >>light.yml
    fullrun light.yml -q -o light.h5 >out.txt
    [ "$(said out.txt | cut -d' ' -f2)" = -12 ] # half of the inlet that M = 1 needs
    run -4 fullrun light.yml --set grid.x_min=-4 -q -o short.h5
    [[ $output == *"light.yml: found an inlet too short for the contact at this time (grid.x_min), first at T = "* ]]
    # 1/20 of the load is a contact with M = 1; both films are compared in units of the reference
    sed 's/transient$/stationary/; s/^transient: .*//; s/M: 20/M: 1/' light.yml >still.yml
    fullrun still.yml -q -o still.h5
    /usr/bin/python3 - <<'PYTHON'
import h5py
last = lambda path: h5py.File(path)["central_film_thickness"][-1]
still = last("still.h5") / 20  # a^2/R of a line is in proportion to the load
light, short = (last(path) / still - 1 for path in ("light.h5", "short.h5"))
assert abs(light) < 0.02 and short < -0.05, (light, short)
PYTHON
}

@test "an approach is measured from far enough on the grid that is taken" {
    snapgen scene.yml --set moes.M=1 --set moes.L=25 -q -o long.h5
    sed -i 's/load: {.*}, end_time/end_time/; s/^regime.*/&\nclosure: approach/' time.yml
    fullrun time.yml -q -o good.h5
    refuse 65 "approach_length: found 10, expected at least .*, half the grid's length" \
        fullrun time.yml --grid-of long.h5 -o x.h5
    cat >far.yml <<'YAML'
groups:
  - scene: base.yml
    vary: {moes.M: [1], moes.L: [25]}
  - scene: time.yml
YAML
    refuse 65 "far.yml: approach_length: found 10, expected at least .*, half the grid's length" \
        snapgen far.yml -o x.h5
}

# bats test_tags=slow
@test "an interrupted training goes on only on its own grid" {
    sed -i 's/moes.M: .*\], /moes.M: [8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 20], /' plan.yml
    stop_when INT 'states >= 3' x.h5 snapgen plan.yml -o x.h5 --quiet --jobs 1
    [ "$code" -eq 130 ]
    cp x.h5.partial kept
    read -r nodes x_min _ <<<"$(grid_of kept)"
    # makes the file look like one of a version that chooses another grid with as many nodes
    patch x.h5.partial "f.attrs['x_min'] = f.attrs['x_min'] + 0.5"
    mv bad.h5 x.h5.partial
    refused 65 "x.h5.partial: x: found $nodes nodes from .*.5 by 0.02, expected $nodes from $x_min by 0.02, as in the plan" \
        snapgen plan.yml -o x.h5 --resume
    mv kept x.h5.partial
    snapgen plan.yml -o x.h5 --resume --quiet
}

# bats test_tags=slow
@test "what a basis or model is used with takes its grid" {
    # without a basis or model each of these plans would have another grid
    cat >check.yml <<'YAML'
groups:
  - scene: base.yml
    vary: {moes.M: [17, 19], moes.L: [3.5, 4.5]}
YAML
    snapgen check.yml -q -o c.h5
    [ "$(grid_of c.h5)" != "$(grid_of m.h5)" ]
    romrun --calibrate check.yml --model m.h5 -o calibrated.h5 -q
    [ "$(grid_of calibrated.h5)" = "$(grid_of m.h5)" ]
    cat >part.yml <<'YAML'
groups:
  - scene: base.yml
    vary: {moes.M: [15, 17, 19], moes.L: [3.7, 4.8]}
YAML
    podbuild s.h5 -o weighted.h5 --weight row-norm --plan part.yml -q
    snapgen part.yml --basis b.h5 -o x.h5 -q
    [ "$(grid_of x.h5)" = "$(grid_of b.h5)" ]
}

@test "a scene that gives another grid is refused in one line" {
    another=(--set grid.step=0.025)
    read -r nodes x_min _ <<<"$(grid_of m.h5)"
    model="$nodes nodes from $x_min by 0.02"
    refuse 65 "grid: found a line contact with .* nodes from .* in steps of 0.025, expected .* in steps of 0.02 as in m.h5" \
        romrun scene.yml --model m.h5 "${another[@]}" -o x.h5
    refuse 65 "m.h5: x: found $model, expected .* by 0.025, as in the scene" \
        fullrun scene.yml --grid-of m.h5 "${another[@]}" -o x.h5
    refuse 65 "m.h5: x: found $model, expected 251 from -3 by 0.02, as in the scene" \
        fullrun scene.yml --grid-of m.h5 --set grid.x_min=-3 -o x.h5
    refuse 65 "b.h5: x: found $model, expected .* by 0.025, as in plan.yml" \
        snapgen plan.yml --basis b.h5 "${another[@]}" -o x.h5
    refuse 65 "plan.yml: x: found .* by 0.025, expected $nodes from $x_min by 0.02, as in m.h5" \
        romrun --calibrate plan.yml --model m.h5 "${another[@]}" -o x.h5
}

# bats test_tags=slow
@test "--grid-of something else is refused in one line" {
    refuse 66 "none.h5: " fullrun scene.yml --grid-of none.h5 -o x.h5
    refuse 65 "plan.yml: " fullrun scene.yml --grid-of plan.yml -o x.h5
    refuse 65 "r.h5: schema_name: found ehdrom-residuals, expected ehdrom-snapshots or ehdrom-basis or ehdrom-model or ehdrom-result" fullrun scene.yml --grid-of r.h5 -o x.h5
    fullrun scene.yml -q --set output.fields=false -o bare.h5
    refuse 65 "bare.h5: x: found none, expected a file with fields" fullrun scene.yml --grid-of bare.h5 -o x.h5
    refuse 65 "m.h5: discretization: found accurate, expected published, as in the scene" \
        fullrun scene.yml --grid-of m.h5 --set discretization=published -o x.h5
    refuse 65 "m.h5: contact: found line, expected point, as in the scene" \
        fullrun scene.yml --grid-of m.h5 --set contact=point -o x.h5
    patch m.h5 "f.attrs['step'] = 0.0"
    refuse 65 "bad.h5: step: found 0, expected above 0" fullrun scene.yml --grid-of bad.h5 -o x.h5
    patch m.h5 "del f.attrs['x_min']"
    refuse 65 "bad.h5: found no .*x_min" fullrun scene.yml --grid-of bad.h5 -o x.h5
    head -c 3000 m.h5 >bad.h5
    refuse 65 "bad.h5: " fullrun scene.yml --grid-of bad.h5 -o x.h5
}

@test "points of several discretisations are not one plan" {
    cat >two.yml <<'YAML'
groups:
  - scene: base.yml
    vary: {moes.M: [18], moes.L: [4], grid.x_min: [-4], grid.x_max: [2], grid.step: [0.02]}
  - scene: base.yml
    vary: {moes.M: [19], moes.L: [4], grid.x_min: [-4], grid.x_max: [2], grid.step: [0.02], discretization: [published]}
YAML
    refuse 65 "two.yml: discretization: found published at point M=19 L=4, expected accurate as at point M=18 L=4" \
        snapgen two.yml -o x.h5
}

@test "lines and points are not one plan" {
    { cat base.yml && echo 'moes: {M: 18, L: 4}'; } | sed 's/line/point/' >point.yml
    printf 'groups:\n  - scene: %s.yml\n' scene >two.yml
    echo '  - scene: point.yml' >>two.yml
    refuse 65 "two.yml: contact: found line and point, expected one of them" \
        snapgen two.yml --set grid.half= -o x.h5
}
