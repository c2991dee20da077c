#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later

load common

setup() {
    common_setup
}

# ---- solutions

@test "solves a scene and prints the answer" {
    run --separate-stderr fullrun scene.yml -o result.h5
    [ "$status" -eq 0 ]
    [ -z "$stderr" ]
    [[ $output == *"central film thickness"* ]]
    [[ $output != *"µm"* ]]
    [ ! -e result.h5.partial ]
    close_to "$(number result.h5 load)" 1 1e-9
    close_to "$(number result.h5 moes_M)" 12 0
    [ "$(number result.h5 status)" = 0.0 ]
    fullrun --check result.h5
}

@test "a value of the paper's Table 4 to every digit" {
    cat >paper.yml <<'YAML'
contact: line
regime: stationary
discretization: published
moes: {M: 12, L: 12}
hertz_pressure: 0.70e9
lubricant:
  viscosity: {law: wlf, preset: no1, temperature: 25}
  density: {law: dowson-higginson}
YAML
    run --separate-stderr fullrun paper.yml -o result.h5
    [ "$status" -eq 0 ]
    [[ $output == *"0.17966418"* ]]
}

@test "a physical scene is answered in µm, GPa and N/m too" {
    cat >physical.yml <<'YAML'
contact: line
regime: stationary
physical: {load: 1.0e5, radius: 0.01, speed: 1, modulus: 2.3e11, viscosity: 0.05}
lubricant:
  viscosity: {law: roelands, eta0: 0.05, alpha: 2.0e-8}
grid: {step: 0.02}
YAML
    run --separate-stderr fullrun physical.yml -o result.h5
    [ "$status" -eq 0 ]
    [[ $output =~ "central film thickness"[^$'\n']*" µm" ]]
    [[ $output =~ "central pressure"[^$'\n']*" GPa" ]]
    [[ $output =~ "load"[^$'\n']*"100000 N/m" ]]
    # p_H = 2w/(pi a), a = sqrt(8wR/(pi E'))
    close_to "$(number result.h5 hertz_pressure)" 605026489 1e-6
    # the printed film is H a^2/R
    micrometres=$(sed -n 's/^central film thickness *[^ ]* *\([^ ]*\) µm/\1/p' <<<"$output")
    expected=$(awk -v h="$(number result.h5 central_film_thickness)" \
        'BEGIN { print h * 8e6 * 1e5 * 0.01 / (3.14159265358979 * 2.3e11) / 0.01 }')
    close_to "$micrometres" "$expected" 1e-5
}

@test "traction of a scene with sliding, by numpy from pressure and film too" {
    cat >sliding.yml <<'YAML'
contact: line
regime: stationary
physical: {load: 1.0e5, radius: 0.01, speed_1: 2.25, speed_2: 1.75, modulus: 2.3e11, viscosity: 0.05}
lubricant: {viscosity: {law: barus, alpha: 15e-9}, shear: {law: eyring, tau0: 4e6}}
YAML
    run --separate-stderr fullrun sliding.yml -o sliding.h5
    [ "$status" -eq 0 ]
    [[ $output == *"friction coefficient "* && $output == *"power loss "*" W/m"* ]]
    /usr/bin/python3 -c "
import h5py, numpy
f = h5py.File('sliding.h5')
p = f['pressure'][0] * f.attrs['hertz_pressure']
h = f['film_thickness'][0] * f.attrs['film_unit']
x = f['x'][:] * f.attrs['half_width']
step = x[1] - x[0]
tau = 4e6 * numpy.arcsinh(0.05 * numpy.exp(15e-9 * p) * 0.5 / h / 4e6)
force = numpy.sum(tau[p > 0]) * step
load = f.attrs['line_load']
def near(found, expected, part): assert abs(found / expected - 1) < part, (found, expected)
near(f['friction_force'][0] * load, force, 1e-3)
near(f['friction_coefficient'][0], force / load, 1e-3)
near(f['largest_shear_stress'][0] * f.attrs['hertz_pressure'], tau[p > 0].max(), 1e-9)
at = f['x'][:]
share = numpy.clip(0.5 + (1 - abs(at)) / (at[1] - at[0]), 0, 1)
near(f['mean_shear_stress'][0] * f.attrs['hertz_pressure'], (tau * share).sum() / share.sum(), 1e-9)
# the part of the moment upstream of the grid, from the boundary node on: integrates 12 eta u (h - h_c)/h^2 with the gap
# and the far deflection
far = at[0] - (at[1] - at[0])
y = far * numpy.exp(numpy.linspace(0, 9, 20001))
gap = f['rigid_approach'][0] + y**2 / 2 - numpy.log(-y) / 2
rate = 12 * 0.05 * 2 * (gap - f['central_film_thickness'][0]) / gap**2 / f.attrs['film_unit'] * f.attrs['half_width']
tail = numpy.sum((rate[1:] + rate[:-1]) / 2 * abs(numpy.diff(y)))
assert 0.02 < tail / (-numpy.sum(p * x) * step / 0.01) < 0.2, tail
near(f['rolling_moment'][0] * f.attrs['line_moment'], -numpy.sum(p * x) * step + 0.01 * tail, 1e-4)
rolling = f['rolling_resistance'][0] * load
near(2 * rolling * 0.01, f['rolling_moment'][0] * f.attrs['line_moment'], 1e-6)
near(f['power_loss'][0] * f.attrs['line_power'], 0.5 * f['friction_force'][0] * load + 2 * 2 * rolling, 1e-9)
on = [f['shear_stress_%d' % i][0] * f.attrs['hertz_pressure'] for i in (1, 2)]
near(((on[1] - on[0]) / 2)[p > 0].max(), tau[p > 0].max(), 1e-9)
near(f.attrs['slide_roll'], 0.25, 1e-15)"
    # mean speed and ratio give the same friction; a scene without a shear law has none
    fullrun sliding.yml -o ratio.h5 --quiet --set physical.speed_1= --set physical.speed_2= \
        --set physical.speed=2 --set slide_roll=0.25
    [ "$(fullrun --print ratio.h5 friction_force)" = "$(fullrun --print sliding.h5 friction_force)" ]
    fullrun sliding.yml -o none.h5 --set physical.speed_1= --set physical.speed_2= \
        --set physical.speed=2 --set lubricant.shear.law= --set lubricant.shear.tau0= >none.txt
    shows_no "friction" cat none.txt
    [ "$(fullrun --print none.h5 film_thickness)" = "$(fullrun --print sliding.h5 film_thickness)" ]
}

@test "traction in time: as the stationary contact's while nothing changes, and as what has its load" {
    cat >sliding.yml <<'YAML'
contact: line
regime: transient
physical: {load: 1.0e5, radius: 0.01, speed: 2, modulus: 2.3e11, viscosity: 0.05}
slide_roll: -0.1
lubricant: {viscosity: {law: barus, alpha: 15e-9}, shear: {law: limiting, limit: 0.06}}
grid: {x_min: -4, x_max: 2, step: 0.05}
transient: {end_time: 4, fixed_step: 0.05, load: {law: ramp, to: 1.2, duration: 0.2}}
YAML
    fullrun sliding.yml -o moving.h5 --quiet --set output.fields=true
    sed -e '/^transient/d' -e 's/transient/stationary/' sliding.yml >first.yml
    fullrun first.yml -o first.h5 --quiet
    fullrun --check moving.h5
    /usr/bin/python3 -c "
import h5py
moving, first = h5py.File('moving.h5'), h5py.File('first.h5')
for name in ('friction_force', 'rolling_moment', 'power_loss', 'largest_shear_stress'):
    assert abs(moving[name][0] / first[name][0] - 1) < 1e-5, name
assert moving['friction_coefficient'][0] < 0
assert abs(moving['friction_force'][-1] / moving['load'][-1] / moving['friction_coefficient'][-1] - 1) < 1e-9
assert moving['shear_stress_1'].shape == moving['pressure'].shape"
}

# bats test_tags=slow
@test "its file opens with h5py, xarray and ncdump" {
    fullrun scene.yml -o result.h5
    run "$BATS_TEST_DIRNAME/open_elsewhere.py" result.h5
    echo "$output"
    [ "$status" -ne 2 ] || skip "a reader is not installed"
    [ "$status" -eq 0 ]
}

@test "output.fields false leaves the fields out" {
    fullrun scene.yml -o result.h5 --set output.fields=false
    run h5ls result.h5
    [[ $output == *minimum_film_thickness* ]]
    for name in pressure film_thickness x; do
        [[ $'\n'$output != *$'\n'"$name "* ]]
    done
    fullrun --check result.h5
}

@test "output.resolution false leaves the estimates out, and nothing else" {
    run --separate-stderr fullrun scene.yml -o with.h5 --set grid.step=0.05 --set moes.M=60
    [[ $status == 0 && $stderr == *grid.step:* ]]
    run --separate-stderr fullrun scene.yml -o without.h5 --set grid.step=0.05 --set moes.M=60 --set output.resolution=false
    [[ $status == 0 && $stderr != *grid.step:* ]]
    [ "$(number with.h5 central_film_thickness)" = "$(number without.h5 central_film_thickness)" ]
    h5dump -a /step_effect with.h5
    run h5dump -a /step_effect without.h5
    [ "$status" -ne 0 ]
    fullrun --check without.h5
}

# bats test_tags=slow
@test "--start gives the same answer as a cold start" {
    fullrun scene.yml -o first.h5
    fullrun scene.yml -o cold.h5 --set moes.M=14
    fullrun scene.yml -o warm.h5 --set moes.M=14 --start first.h5
    close_to "$(number warm.h5 central_film_thickness)" \
        "$(number cold.h5 central_film_thickness)" 1e-8
    run ! same_data first.h5 warm.h5
    # the start is an input: the result keeps its history and identity
    [[ $(h5dump -a input_2_path warm.h5) == *first.h5* ]]
}

# bats test_tags=slow
@test "--start tells what it saved: iterations, time, and how far the start was off" {
    fullrun scene.yml -o first.h5
    run fullrun scene.yml -o again.h5 --start first.h5
    [[ $output =~ "started from"\ +"first.h5: "[012]" iterations, "[0-9.]+" ms; its central film lies "[+-][0-9.]+e-([0-9]+)" off" ]]
    ((10#${BASH_REMATCH[1]} >= 10))
    fullrun scene.yml -o rough.h5 --tolerance 0.1
    run fullrun scene.yml -o polished.h5 --start rough.h5
    [[ $output =~ "rough.h5: "[1-9]" iterations, " ]]
    close_to "$(number polished.h5 central_film_thickness)" "$(number first.h5 central_film_thickness)" 1e-9
}

@test "--tolerance ends Newton's iteration where it says" {
    fullrun scene.yml -o fine.h5
    fullrun scene.yml -o rough.h5 --tolerance 1e-2
    /usr/bin/python3 - <<'PYTHON'
import h5py
with h5py.File("fine.h5") as fine, h5py.File("rough.h5") as rough:
    assert fine["residual_norm"][0] < 1e-10 < rough["residual_norm"][0] < 1e-2
    assert rough["newton_iterations"][0] < fine["newton_iterations"][0]
    assert 0 < abs(rough["central_film_thickness"][0] / fine["central_film_thickness"][0] - 1) < 1e-2
PYTHON
    refused 64 "--tolerance: found 2, expected" fullrun scene.yml -o x.h5 --tolerance 2
    refused 64 "--tolerance: found nan, expected" fullrun scene.yml -o x.h5 --tolerance nan
}

# bats test_tags=slow
@test "--repeat changes no number of the solution, whatever the start" {
    fullrun scene.yml -o once.h5
    fullrun scene.yml -o thrice.h5 --repeat 3
    same_data once.h5 thrice.h5
    fullrun scene.yml -o from.h5 --start once.h5 --set moes.M=14
    fullrun scene.yml -o from3.h5 --start once.h5 --set moes.M=14 --repeat 3
    same_data from.h5 from3.h5
    refused 64 "--repeat: found 0, expected" fullrun scene.yml -o x.h5 --repeat 0
}

@test "--formulas prints the published films beside the solution" {
    run fullrun scene.yml -o r.h5 --formulas
    [ "$status" -eq 0 ]
    printf '%s\n' "$output" | sed -n 's/^formula //p' >formulas
    [ "$(wc -l <formulas)" -eq 6 ]
    # each deviation belongs to its film; this contact lies amid the ranges of all formulas, so no formula is far off
    awk -v central="$(number r.h5 central_film_thickness)" -v minimum="$(number r.h5 minimum_film_thickness)" '
        { own = 100 * ($3 / ($2 == "central" ? central : minimum) - 1) - $4 }
        own > 0.002 || own < -0.002 || $4 > 25 || $4 < -25 || $5 != "%" { exit 1 }' formulas
    grep -q '^moes .* central .*Moes, Wear' formulas
}

# The contact slides in SI units with Eyring's law: the curve must go through the scene's own point.
@test "--formulas prints the traction curve of an Eyring fluid" {
    cat >sliding.yml <<'YAML'
contact: line
regime: stationary
physical: {load: 2.0e5, radius: 0.01, speed: 1, modulus: 2.3e11, viscosity: 0.05}
slide_roll: 0.1
lubricant:
  viscosity: {law: barus, alpha: 2.0e-8}
  shear: {law: eyring, tau0: 1.0e6}
YAML
    run -0 fullrun sliding.yml -o r.h5 --formulas
    echo "$output"
    [[ "$output" != *"friction coefficient:"* ]]
    awk -v friction="$(number r.h5 friction_coefficient)" '
        /^traction evans-johnson +friction/ { own = 100 * ($4 / friction - 1) - $5; coefficient = $4; found = $5 }
        /^traction slide-roll: friction/ { sub(".*[, ]0.1: ", ""); sub(",.*", ""); on_curve = $0 }
        END { exit !(own < 0.002 && own > -0.002 && found < 5 && found > -5 &&
                     on_curve / coefficient > 0.999 && on_curve / coefficient < 1.001) }' <<<"$output"
    grep -q '^traction evans-johnson .*viscous stress from 100 Eyring stresses on, here: ' <<<"$output"
    run -0 fullrun sliding.yml --formulas --set lubricant.viscosity.alpha=1.2e-8
    grep -q '^traction evans-johnson .*, here outside: ' <<<"$output"
    run --separate-stderr fullrun sliding.yml --formulas --set lubricant.shear.law=newtonian --set lubricant.shear.tau0=
    [[ "$output" != *evans-johnson* ]]
    # a Newtonian fluid's shear stress is far above what lubricants carry
    [ "$status" = 4 ]
    [[ "$stderr" == *"found a friction above the load (check lubricant.shear.law)"* ]]
}

@test "the same scene gives the same bits" {
    fullrun scene.yml -o a.h5
    fullrun scene.yml -o b.h5
    same_data a.h5 b.h5
}

@test "--quiet, --verbose, --help and --version" {
    run --separate-stderr fullrun scene.yml -o a.h5 --verbose
    [[ $stderr == "fullrun: "*"Newton"* ]]
    run --separate-stderr fullrun --help
    [ "$status" -eq 0 ]
    [[ $output == *"lubricant.viscosity.alpha"* && $output == *"--start"* ]]
    run --separate-stderr fullrun --version
    [ "$status" -eq 0 ]
}

@test "--help shows each heading and each key of a history once" {
    for name in fullrun romrun snapgen; do
        run --separate-stderr $name --help
        [ "$(grep -c 'Settings of a scene' <<<"$output")" -eq 1 ]
        [ "$(grep -c 'transient.<load|speed|radius|modulus|approach>.amplitude:' <<<"$output")" -eq 1 ]
        run -1 grep 'transient.speed.' <<<"$output"
    done
}

@test "--set KEY= unsets a key, so that another law can be chosen" {
    run --separate-stderr fullrun scene.yml --set lubricant.viscosity.law=wlf -o a.h5
    [ "$status" -eq 65 ]
    [[ $stderr == *"alpha: found a value, expected none with the law wlf (--set lubricant.viscosity.alpha= unsets it)" ]]
    fullrun scene.yml --set lubricant.viscosity.law=wlf --set lubricant.viscosity.preset=no1 \
        --set lubricant.viscosity.alpha= -o a.h5
    h5dump -a settings a.h5 | grep -q 'lubricant.viscosity.preset: no1'
    shows_no lubricant.viscosity.alpha h5dump -a settings a.h5
}

# ---- resolution

@test "a domain or step that moves the central film by more than 1 % is noted, not refused" {
    published=(--set discretization=published) # the effect of the step on these grids is known for these rows
    fullrun scene.yml -o good.h5 "${published[@]}" 2>errors
    [ ! -s errors ]
    run --separate-stderr fullrun scene.yml -o r.h5 --set moes.M=5 --set moes.L=12
    [ "$status" -eq 0 ]
    [ "${#stderr_lines[@]}" -eq 1 ]
    [[ $stderr =~ ^"fullrun: scene.yml: grid.x_min: found -4, expected a longer inlet: the error estimate of the central film is 3".*%$ ]]
    run --separate-stderr fullrun scene.yml -o s.h5 --set moes.M=50 "${published[@]}"
    [ "$status" -eq 0 ]
    [[ $stderr =~ ^"fullrun: scene.yml: grid.step: found 0.02, expected a finer one".*%$ ]]
    run --separate-stderr fullrun scene.yml -o t.h5 --set moes.M=5 --set moes.L=12 --quiet
    [ "$status" -eq 0 ]
    [ -z "$stderr" ]
    same_data r.h5 t.h5
    # compares the estimates with solutions on a longer and on a finer grid
    fullrun scene.yml -o wide.h5 --set moes.M=5 --set moes.L=12 --set grid.x_min=-20
    fullrun scene.yml -o fine.h5 --set moes.M=50 --set grid.step=0.0025 "${published[@]}"
    /usr/bin/python3 - <<'PYTHON'
import h5py
film = {name: h5py.File(name + ".h5")["central_film_thickness"][0] for name in ("r", "s", "wide", "fine")}
attributes = {name: h5py.File(name + ".h5").attrs for name in ("good", "r", "s", "t")}
assert 1 < attributes["r"]["inlet_effect"] / (film["wide"] / film["r"] - 1) < 1.4
assert 1 < attributes["s"]["step_effect"] / (film["fine"] / film["s"] - 1) < 1.5
assert attributes["t"]["inlet_effect"] == attributes["r"]["inlet_effect"]
assert 0 < attributes["good"]["inlet_effect"] < 0.01 and 0 < attributes["good"]["step_effect"] < 0.01
assert 1.8 < attributes["good"]["observed_order"] < 2.2
assert 30 < attributes["good"]["inlet_nodes"] < 100 and attributes["good"]["outlet_nodes"] > 3
PYTHON
}

@test "a grid too coarse to estimate its error is exit code 4, and has no step_effect" {
    # with twice the step there is no solution, or a different solution, whose films are 6 and 36 % off
    for place in "0 0.01" "10 0.02"; do
        read -r L step <<<"$place"
        here=(scene.yml --force --set moes.M=1000 --set "moes.L=$L" --set "grid.step=$step" --set grid.x_min=-1.5)
        run --separate-stderr fullrun "${here[@]}" -o r.h5
        [ "$status" -eq 4 ]
        [[ $stderr == "fullrun: scene.yml: found a grid from X = -1.5 on by $step, too coarse to estimate its error, expected a finer one"* ]]
        [[ $output == *"grid too coarse to tell"* ]]
        run h5dump -A -a step_effect r.h5
        [ "$status" -ne 0 ]
        fullrun --check r.h5
        fullrun "${here[@]}" --allow-untrusted -o s.h5
        same_data r.h5 s.h5
    done
}

# ---- existing files

@test "an existing output is kept, and replaced only with --force" {
    echo precious >result.h5
    refused 73 "result.h5: .*existing file" fullrun scene.yml -o result.h5
    [ "$(cat result.h5)" = precious ]
    fullrun scene.yml -o result.h5 --force
    fullrun --check result.h5
}

@test "a refused scene leaves an existing output as it was, also with --force" {
    fullrun scene.yml -o result.h5
    before=$(sha256sum result.h5)
    refused 65 "scene.yml|--set" fullrun scene.yml -o result.h5 --force --set moes.M=-1
    [ "$(sha256sum result.h5)" = "$before" ]
    [ ! -e result.h5.partial ]
}

@test "Ctrl-C leaves no file" {
    stop_when INT exists result.h5 fullrun scene.yml -o result.h5 --set grid.step=0.00002
    [ "$code" -eq 130 ]
    [ ! -e result.h5 ]
    [ ! -e result.h5.partial ]
}

@test "kill -9 leaves no final file, and the next run is not disturbed" {
    stop_when KILL exists result.h5 fullrun scene.yml -o result.h5 --set grid.step=0.00002
    [ ! -e result.h5 ]
    fullrun scene.yml -o result.h5
    [ ! -e result.h5.partial ]
    fullrun --check result.h5
}

# ---- bad settings

# bad_scene PATTERN: checks that fullrun refuses the scene on stdin
bad_scene() {
    cat >bad.yml
    refused 65 "$1" fullrun bad.yml -o result.h5
    [ ! -e result.h5 ]
    [ ! -e result.h5.partial ]
}

# bad_value KEY TEXT PATTERN: checks that fullrun refuses the scene with KEY=TEXT
bad_value() {
    refused 65 "$3" fullrun scene.yml -o result.h5 --set "$1=$2"
    [ ! -e result.h5 ]
    [ ! -e result.h5.partial ]
}

@test "malformed, empty and misplaced YAML is refused" {
    bad_scene "bad.yml:" </dev/null
    bad_scene "bad.yml:.: " <<<'contact: [line'
    bad_scene "bad.yml:.: " <<<'{contact: line'
    bad_scene "bad.yml:" <<<'- contact'
    bad_scene "bad.yml:" <<<'just words'
    printf 'contact: line\n\tregime: stationary\n' | bad_scene "bad.yml:2: "
    printf 'contact: "\xff\xfe"\n' | bad_scene "bad.yml:"
    head -c 1000 /dev/urandom | bad_scene "bad.yml"
}

@test "unknown, duplicate and missing keys are refused" {
    (cat scene.yml && echo 'colour: red') | bad_scene "bad.yml:8: .*colour"
    (cat scene.yml && echo 'grid: {step: 0.02}') | bad_scene "bad.yml:8: .*grid"
    sed 's/step/stepp/' scene.yml | bad_scene "bad.yml:7: .*stepp.*grid.step"
    grep -v contact scene.yml | bad_scene "bad.yml: .*contact"
    grep -v regime scene.yml | bad_scene "bad.yml: .*regime"
    grep -v moes scene.yml | bad_scene "bad.yml: .*moes"
    grep -v viscosity scene.yml | bad_scene "bad.yml: .*lubricant.viscosity"
    sed 's/, L: 8//' scene.yml | bad_scene "bad.yml: .*moes.L"
    (cat scene.yml && echo 'physical: {load: 1e5}') | bad_scene "bad.yml: .*physical"
}

# bats test_tags=slow
@test "an Eyring fluid in the film: thinner the lower its stress, and refused where it is not served" {
    cat >sliding.yml <<'YAML'
contact: line
regime: stationary
physical: {load: 1.0e5, radius: 0.01, speed: 2, modulus: 2.3e11, viscosity: 0.05}
slide_roll: 0.5
lubricant: {viscosity: {law: barus, alpha: 15e-9}, shear: {law: eyring, tau0: 1e12, in_film: true}}
grid: {x_min: -4, x_max: 2, step: 0.05}
YAML
    fullrun sliding.yml -o stiff.h5 --quiet --allow-untrusted
    fullrun sliding.yml -o newton.h5 --quiet --allow-untrusted --set lubricant.shear.in_film=false
    close_to "$(number stiff.h5 central_film_thickness)" "$(number newton.h5 central_film_thickness)" 1e-6
    fullrun sliding.yml -o thin.h5 --quiet --set lubricant.shear.tau0=3e5
    far_from "$(number thin.h5 central_film_thickness)" "$(number newton.h5 central_film_thickness)" 0.1
    # in time the film stays constant
    sed 's/stationary/transient/' sliding.yml >moving.yml
    echo 'transient: {end_time: 0.5, fixed_step: 0.05}' >>moving.yml
    fullrun moving.yml -o moving.h5 --quiet --set lubricant.shear.tau0=3e5
    /usr/bin/python3 -c "
import h5py
moving, thin = (h5py.File(name)['central_film_thickness'][-1] for name in ('moving.h5', 'thin.h5'))
assert abs(moving / thin - 1) < 1e-4, (moving, thin)"
    refused 65 "lubricant.shear.in_film: found true with the discretization published, expected accurate" \
        fullrun sliding.yml --set discretization=published
}

@test "sliding is refused where it says nothing, or twice" {
    local physical='physical: {load: 1e5, radius: 0.01, speed: 1, modulus: 2.3e11, viscosity: 0.05}'
    (cat scene.yml && echo 'slide_roll: 0.1') | bad_scene "bad.yml:[0-9]*: slide_roll: found with moes, expected it with physical"
    sed '/^moes/d' scene.yml >si.yml
    echo "$physical" >>si.yml
    (cat si.yml && echo 'lubricant.shear.law: newtonian') |
        bad_scene "bad.yml:[0-9]*: lubricant.shear.law: found a value, expected slide_roll"
    (cat si.yml && echo 'slide_roll: 0.1' && echo 'lubricant.shear.tau0: 1e6') |
        bad_scene "lubricant.shear.tau0: found a value, expected lubricant.shear.law too"
    (cat si.yml && echo 'physical.speed_1: 1.1') | bad_scene "physical.speed_1: found beside physical.speed, expected only one"
    sed 's/speed: 1/speed_1: 1.1/' si.yml | bad_scene "physical: found 5 of its 6 keys, expected also physical.speed_2"
    sed 's/speed: 1/speed_1: 1, speed_2: -1/' si.yml | bad_scene "physical.speed_1: found 1 with physical.speed_2 of -1 m/s, expected a mean above 0"
    (sed 's/speed: 1/speed_1: 1, speed_2: 2/' si.yml && echo 'slide_roll: 0.1') |
        bad_scene "physical.speed_1: found beside slide_roll, expected only one"
}

@test "bad numbers are refused with key, value and range" {
    for text in 1e-1O nan NaN inf -inf 1e999 1e-999 ' ' 0x10 1,5 '1 2' -3 0 1e300; do
        bad_value moes.M "$text" "--set: moes.M: found "
    done
    sed "s/M: 12/M: ''/" scene.yml | bad_scene "bad.yml:3: moes.M: found nothing, expected"
    sed 's/M: 12/M: 1e-1O/' scene.yml | bad_scene "bad.yml:3: moes.M: found 1e-1O, expected"
    bad_value grid.step 0.007 "grid.step: found 0.007, expected a whole number of steps"
    bad_value grid.step 10 "grid.step"
    bad_value grid.x_min 1 "grid.x_min"
    bad_value grid.x_max 0.5 "grid.x_max"
    bad_value lubricant.viscosity.alpha -1 "lubricant.viscosity.alpha"
    bad_value lubricant.viscosity.alpha 1 "lubricant.viscosity.alpha"
    bad_value output.fields maybe "output.fields"
}

@test "unknown names and settings of another law are refused" {
    bad_value contact sphere "contact: found sphere, expected line"
    bad_value regime moving "regime"
    bad_value closure gap "closure"
    bad_value closure approach "closure: found approach in a stationary scene"
    bad_value lubricant.viscosity.law honey "barus.roelands.wlf"
    bad_value lubricant.density.law lead "incompressible.dowson-higginson"
    bad_value lubricant.viscosity.preset no1 "preset"
    bad_value moes.N 3 "moes.N"
    bad_value physical.velocity 3 "physical.velocity: found an unknown key, expected physical.speed"
    bad_value physical.load 200kN "physical.load: found 200kN, expected .* N/m, or one in N/mm, kN/m"
}

@test "a Hertz pressure beyond the viscosity law's limit is refused" {
    cat >limit.yml <<'YAML'
contact: line
regime: stationary
moes: {M: 12, L: 12}
hertz_pressure: 5.5e9
lubricant:
  viscosity: {law: wlf, preset: no2}
grid: {step: 0.02}
YAML
    refused 65 "limit.yml: Hertz pressure: found 5.5 GPa, expected at most .* GPa, the limit of the law wlf" fullrun limit.yml -o r.h5
}

@test "a physical viscosity that contradicts the law is refused" {
    cat >physical.yml <<'YAML'
contact: line
regime: stationary
physical: {load: 1.0e5, radius: 0.01, speed: 1, modulus: 2.3e11, viscosity: 0.5}
lubricant:
  viscosity: {law: roelands, eta0: 0.05, alpha: 2.0e-8}
YAML
    refused 65 "physical.yml: physical.viscosity: found 0.5, expected 0.05" \
        fullrun physical.yml -o r.h5
}

# The oil's viscosity is given at 40 degC. The film at another temperature must be that of the viscosity there.
# bats test_tags=slow
@test "a temperature stands for the viscosity that it makes" {
    cat >hot.yml <<'YAML'
contact: line
regime: stationary
physical: {load: 1.0e5, radius: 0.01, speed: 1, modulus: 2.3e11}
lubricant:
  viscosity: {law: barus, eta0: 0.05, alpha: 2.0e-8, temperature: 60, reference_temperature: 40, temperature_coefficient: 0.03}
YAML
    fullrun hot.yml -o hot.h5 --quiet
    sed -e 's/eta0: 0.05, alpha.*/alpha: 2.0e-8}/' -e 's/2.3e11/2.3e11, viscosity: 0.02744058180470132/' hot.yml >known.yml
    fullrun known.yml -o known.h5 --quiet
    for name in moes_M moes_L central_film_thickness film_unit; do
        close_to "$(number hot.h5 $name)" "$(number known.h5 $name)" 1e-12
    done
    refused 65 "hot.yml: physical.viscosity: found 0.05, expected 0.0274406 .*temperature of 60 degC" \
        fullrun hot.yml -o r.h5 --set physical.viscosity=0.05
    refused 65 "hot.yml: lubricant.viscosity.reference_temperature: found nothing" \
        fullrun hot.yml -o r.h5 --set lubricant.viscosity.reference_temperature=
}

# bats test_tags=slow
@test "the inlet's heating is a factor beside films that do not change, or unknown" {
    cat >hot.yml <<'YAML'
contact: line
regime: stationary
physical: {load: 1.0e5, radius: 0.01, speed: 2, modulus: 2.3e11, viscosity: 0.05}
lubricant:
  viscosity: {law: barus, alpha: 2.0e-8, temperature_coefficient: 0.03}
YAML
    fullrun hot.yml -o cold.h5 --quiet
    [ -z "$(fullrun --print cold.h5 inlet_heating_factor 2>&1 | grep '^[0-9]')" ]
    run -0 fullrun hot.yml -o hot.h5 --set lubricant.thermal_conductivity=0.14
    grep 'inlet shear heating     0\.9[0-9]* of the films above, which are isothermal (thermal loading 0.0429)' <<<"$output"
    close_to "$(number hot.h5 thermal_loading)" 0.042857142857142858 1e-12
    [ "$(number hot.h5 central_film_thickness)" = "$(number cold.h5 central_film_thickness)" ]
    fullrun --check hot.h5
    run -0 fullrun hot.yml -o far.h5 --set lubricant.thermal_conductivity=0.001 --set physical.speed=20
    grep 'inlet shear heating     not known, outside of the range of its formula (thermal loading 600)' <<<"$output"
    refused 65 "thermal_conductivity: found a value, expected none with the regime transient" \
        fullrun hot.yml -o r.h5 --set lubricant.thermal_conductivity=0.14 --set regime=transient --set transient.end_time=1
    refused 65 "temperature_coefficient: found nothing" \
        fullrun hot.yml -o r.h5 --set lubricant.thermal_conductivity=0.14 --set lubricant.viscosity.temperature_coefficient=
}

# ---- not converged

@test "an exit outside of the domain is reported, written with status 1, and exit 3" {
    refused 3 "scene.yml: not converged: .*exit boundary outside the domain" \
        fullrun scene.yml -o result.h5 --set moes.M=1 --set moes.L=1 --set grid.x_max=1.02
    [ "$(number result.h5 status)" = 1.0 ]
    fullrun --check result.h5
}

# bats test_tags=slow
@test "a pressure spike beyond the law's limit is reported with the limit, and exit 3" {
    cat >spike.yml <<'YAML'
contact: line
regime: stationary
moes: {M: 30, L: 3}
hertz_pressure: 4.99e9
lubricant:
  viscosity: {law: wlf, preset: no2}
grid: {step: 0.02}
YAML
    refused 3 "spike.yml: not converged: .*found a pressure of .* expected at most 5.012 GPa" \
        fullrun spike.yml -o result.h5
    [ "$(number result.h5 status)" = 1.0 ]
    # where Newton's iteration fails, no finer step is tried
    run ! fullrun spike.yml --set contact=point --set moes.M=20 --set grid.step=
    [[ $output != *"going on with"* && $output == *"the limit of the wlf law"* ]]
}

# ---- the command line

@test "without -o it prints the answer and writes nothing" {
    before=$(ls)
    fullrun scene.yml -o result.h5 | grep -v "^solution" >with
    rm result.h5
    fullrun scene.yml | grep -v "^solution" >without
    diff with without
    grep "^central film thickness " without
    rm with without
    [ "$(ls)" = "$before" ] || { ls; echo "expected $before"; return 1; }
}

@test "usage is one line a mode, as help2man takes it" {
    for name in fullrun snapgen podbuild deimselect romrun; do
        $name --help >help
        # reads up to the line that describes the program
        awk '/^(Usage|  or): / { if (length > 79 || NF < 4) exit 1; next } { exit !/^[A-Z].*[.]$/ }' help
    done
    # names in a list need two spaces behind them
    deimselect --help | grep "^  quadrature  "
    podbuild --help | grep "^  row-norm  "
}

@test "misuse is one line and exit 64" {
    refused 64 "SCENE.yml" fullrun -o result.h5
    refused 64 "SCENE.yml" fullrun scene.yml scene.yml -o result.h5
    refused 64 "--resume: found with a stationary scene" fullrun scene.yml --resume
    refused 64 "option" fullrun scene.yml -o result.h5 --nonsense
    refused 64 "KEY=VALUE" fullrun scene.yml -o result.h5 --set nonsense
}

# ---- files

@test "a missing scene is 66" {
    refused 66 "none.yml: found" fullrun none.yml -o result.h5
    refused 66 ": found" fullrun . -o result.h5
}

@test "an output that cannot be created is 73" {
    refused 73 "scene.yml/result.h5" fullrun scene.yml -o scene.yml/result.h5
    refused 73 "none/result.h5" fullrun scene.yml -o none/result.h5
    mkdir folder
    refused 73 "folder" fullrun scene.yml -o folder
}

@test "a full disk is 74, and an existing output stays" {
    fullrun scene.yml -o result.h5
    before=$(sha256sum result.h5)
    limited() {
        (ulimit -f 4 && fullrun "$@")
    }
    run --separate-stderr limited scene.yml -o result.h5 --force
    echo "$status $stderr"
    [ "$status" -eq 74 ]
    [ "${#stderr_lines[@]}" -eq 1 ]
    [[ $stderr == "fullrun: result.h5"* ]]
    [ "$(sha256sum result.h5)" = "$before" ]
    [ ! -e result.h5.partial ]
}

@test "an answer that cannot be printed is 74" {
    run bash -c 'fullrun scene.yml -o result.h5 >/dev/full'
    [ "$status" -eq 74 ]
    [[ $output == "fullrun: stdout: "* ]]
}

@test "--check: 0 and silent, or 65, or 66 where there is no file, and a line" {
    fullrun scene.yml -o good.h5
    size=$(stat -c %s good.h5)
    for part in 0 1 8 100 $((size / 2)) $((size - 1)); do
        head -c "$part" good.h5 >"cut$part.h5"
    done
    head -c 5000 /dev/urandom >noise.h5
    # finds where the pressures are in the file, and flips a bit there; the checksum must show this
    /usr/bin/python3 - <<'PYTHON'
import h5py
with h5py.File("good.h5") as file:
    place = file["pressure"].id.get_chunk_info(0).byte_offset + 800
data = bytearray(open("good.h5", "rb").read())
data[place] ^= 1
open("flipped.h5", "wb").write(data)
PYTHON
    run fullrun --check good.h5
    [ "$status" -eq 0 ]
    [ -z "$output" ]
    mkfifo pipe
    for bad in cut*.h5 noise.h5 flipped.h5 scene.yml none.h5 . pipe; do
        run fullrun --check "$bad"
        echo "$bad: $status $output"
        [ "${#lines[@]}" -eq 1 ]
        # --check has the exit codes of the programs that read files
        case $bad in
        none.h5 | . | pipe) [ "$status" -eq 66 ] ;;
        *) [ "$status" -eq 65 ] ;;
        esac
    done
    run fullrun --check flipped.h5 --verbose
    [[ $output == *flipped.h5*pressure* ]]
}

@test "--start refuses what is no result, has no fields, or another grid" {
    fullrun scene.yml -o good.h5
    fullrun scene.yml -o other.h5 --set grid.step=0.025
    fullrun scene.yml -o bare.h5 --set output.fields=false
    head -c 3000 good.h5 >cut.h5
    refused 66 "none.h5" fullrun scene.yml -o r.h5 --start none.h5
    refused 65 "scene.yml" fullrun scene.yml -o r.h5 --start scene.yml
    refused 65 "cut.h5" fullrun scene.yml -o r.h5 --start cut.h5
    refused 65 "other.h5: x: found 241 nodes.*expected 301" fullrun scene.yml -o r.h5 --start other.h5
    refused 65 "bare.h5: found no dataset pressure, .*output.fields" fullrun scene.yml -o r.h5 --start bare.h5
    [ ! -e r.h5 ]
    [ ! -e r.h5.partial ]
}

@test "--start refuses a file of a newer schema and an unfinished one" {
    fullrun scene.yml -o newer.h5
    cp newer.h5 unfinished.h5
    /usr/bin/python3 - <<'PYTHON'
import h5py
with h5py.File("newer.h5", "r+") as file:
    file.attrs.pop('content_sha256', None)
    file.attrs["schema_version"] = "9.0"
with h5py.File("unfinished.h5", "r+") as file:
    file.attrs.pop('content_sha256', None)
    file.attrs["complete"] = 0
PYTHON
    refused 65 "newer.h5: .*9" fullrun scene.yml -o r.h5 --start newer.h5
    refused 65 "unfinished.h5: .*unfinished" fullrun scene.yml -o r.h5 --start unfinished.h5
}
