#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests of romrun calibrate and romrun trade: the deviation and the time of each size of a model.

load common

setup_file() {
    cd "$BATS_FILE_TMPDIR" || return
    small_model
}

setup() {
    cd "$BATS_TEST_TMPDIR" || return
    cp "$BATS_FILE_TMPDIR"/* .
}

# entry FILE NAME INDEX...: prints one number of a dataset
entry() {
    /usr/bin/python3 - "$@" <<'PYTHON'
import sys, h5py
with h5py.File(sys.argv[1]) as file:
    print(repr(float(file[sys.argv[2]][tuple(int(index) for index in sys.argv[3:])])))
PYTHON
}

# bats test_tags=slow
@test "the table says what romrun finds" {
    run --separate-stderr romrun --calibrate check.yml --model m.h5 -o x.h5 --quiet
    [ "$status" -eq 0 ]
    [ -z "$stderr" ]
    [[ $output == "4 scenes, 0 trajectories, "*" sizes, "* ]]
    romrun --check x.h5
    [ ! -e x.h5.partial ]
    # computes the worst deviation of the four scenes at the smallest size independently
    modes=$(entry c.h5 position_pressure_modes 0)
    rows=$(entry c.h5 position_rows 0)
    worst=0
    for M in 10 12; do
        for L in 3 5; do
            fullrun scene.yml --set moes.M=$M --set moes.L=$L -o full.h5 --force
            romrun scene.yml --set moes.M=$M --set moes.L=$L -o red.h5 --force --model m.h5 --allow-untrusted \
                --pressure-modes "${modes%.*}" --rows "${rows%.*}"
            worst=$(awk -v w="$worst" -v f="$(number full.h5 central_film_thickness)" \
                -v r="$(number red.h5 central_film_thickness)" \
                'BEGIN { d = r / f - 1; d = d < 0 ? -d : d; printf "%.17g", (d > w ? d : w) }')
        done
    done
    close_to "$(entry c.h5 deviation_central_film_thickness 0 2)" "$worst" 1e-6
    # the size with all modes and rows comes last, and is more accurate
    [ "$(entry c.h5 position_pressure_modes -1)" = 12.0 ]
    awk -v all="$(entry c.h5 deviation_central_film_thickness -1 2)" -v few="$worst" \
        'BEGIN { exit !(all < few / 2) }'
}

# bats test_tags=slow
@test "--jobs and a second calibration change nothing but the times" {
    romrun --calibrate check.yml --model m.h5 -o one.h5 --quiet --jobs 1
    romrun --calibrate check.yml --model c.h5 -o again.h5 --quiet --jobs 3
    /usr/bin/python3 - <<'PYTHON'
import h5py
with h5py.File("c.h5") as c, h5py.File("m.h5") as m:
    assert set(m) < set(c)
    for name in m:
        assert m[name][...].tobytes() == c[name][...].tobytes(), name
    for other in "one.h5", "again.h5":
        with h5py.File(other) as o:
            assert set(o) == set(c), set(o) ^ set(c)
            for name in c:
                if name != "position_seconds":
                    assert c[name][...].tobytes() == o[name][...].tobytes(), name
            assert o.attrs["settings"] == c.attrs["settings"]
    assert c.attrs["calibration_scenes"] == 4
    assert b"rows" in bytes(c.attrs["settings"]) and b"moes.M: 10" in bytes(c.attrs["settings"])
    assert "input_1_sha256" in c.attrs and "input_2_sha256" in c.attrs
    history = bytes(c.attrs["history"]).decode().splitlines()
    assert [line.split()[1] for line in history][-2:] == ["deimselect", "romrun"], history
PYTHON
}

@test "--trade prints a line a size" {
    run --separate-stderr romrun --trade --model c.h5
    [ "$status" -eq 0 ]
    [ -z "$stderr" ]
    [[ ${lines[1]} == "4 scenes: "* ]]
    sizes=$(h5dump -d position_rows c.h5 | sed -n "s/.*SIMPLE { ( \([0-9]*\) ) \/.*/\1/p" | head -n 1)
    [ "${#lines[@]}" -eq $((2 * sizes + 6)) ]
    [ "$(grep -c '^\*  ' <<<"$output")" -ge 1 ]
    refuse 65 "m.h5: found a model that is not calibrated" romrun --trade --model m.h5
    refuse 66 "none.h5" romrun --trade --model none.h5
}

@test "--accuracy takes the fastest size that is good enough" {
    cat >choose.py <<'PYTHON'
import sys, h5py, numpy
with h5py.File("c.h5") as f:
    worst = f["indicated_deviation"][:, 2]
    usable = numpy.isfinite(worst)
    best = worst[usable].min()
    wanted = 2 * best
    good = numpy.where(usable & (worst <= wanted), f["position_seconds"][...], numpy.inf)
    chosen = good.argmin()
    print(wanted, best / 2, f["position_pressure_modes"][chosen], f["position_rows"][chosen])
PYTHON
    read -r wanted too_good modes rows <<<"$(/usr/bin/python3 choose.py)"
    run --separate-stderr romrun scene.yml --model c.h5 --accuracy "$wanted" -o x.h5
    [ "$status" -eq 0 ]
    [[ $stderr == "romrun: --accuracy "*": $modes pressure modes, $rows rows, the fastest of "* ]]
    [ "${#stderr_lines[@]}" -eq 1 ]
    romrun scene.yml --model c.h5 --pressure-modes "$modes" --rows "$rows" -o y.h5 --quiet
    # the fastest size depends on the machine; the films differ a little, because --accuracy also sets where the
    # iteration ends
    close_to "$(number x.h5 central_film_thickness)" "$(number y.h5 central_film_thickness)" \
        "$(awk "BEGIN { print $wanted / 10 }")"
    [[ $(h5dump -a settings x.h5) == *"# $modes pressure modes, 0 deformation modes, $rows rows (0: all), accuracy "* ]]
    rm x.h5 y.h5
    refuse 65 "--accuracy: found .*, expected at least .*, the best that c.h5 was measured to give" \
        romrun scene.yml --model c.h5 --accuracy "$too_good" -o x.h5
    # the accuracy that the message names can be reached
    least=$(sed 's/.*expected at least \([^,]*\),.*/\1/' <<<"$stderr")
    romrun scene.yml --model c.h5 --accuracy "$least" --quiet
    refuse 65 "m.h5: found a model that is not calibrated" \
        romrun scene.yml --model m.h5 --accuracy 0.1 -o x.h5
}

# bats test_tags=slow
@test "--accuracy never takes a size that failed on many scenes, or without an indicator on one" {
    for lost in 'indicated_deviation inf' 'indicator_factor 0'; do
        cp c.h5 x.h5
        /usr/bin/python3 - $lost <<'PYTHON'
import sys, h5py
with h5py.File("x.h5", "r+") as f:
    f.attrs.pop('content_sha256', None)
    f["position_failures"][...] = 1
    f[sys.argv[1]][...] = float(sys.argv[2])
PYTHON
        refused 65 "found no size of x.h5 that solved enough of the 4 scenes" \
            romrun scene.yml --model x.h5 --accuracy 1
        shows_no '^\*  ' romrun --trade --model x.h5
    done
}

# bats test_tags=slow
@test "the indicated deviation bounds the true one, and a broken promise is exit code 4" {
    for M in 10 12; do
        for L in 3 5; do
            fullrun scene.yml --set moes.M=$M --set moes.L=$L -o full.h5 --force
            romrun scene.yml --set moes.M=$M --set moes.L=$L -o red.h5 --force --model c.h5
            awk -v i="$(number red.h5 indicated_deviation)" \
                -v f="$(number full.h5 central_film_thickness)" \
                -v r="$(number red.h5 central_film_thickness)" \
                'BEGIN { d = r / f - 1; d = d < 0 ? -d : d; exit !(i > 1.9 * d && i < 1e6 * d) }'
            awk -v i="$(number red.h5 indicated_deviation_minimum)" \
                -v f="$(number full.h5 minimum_film_thickness)" \
                -v r="$(number red.h5 minimum_film_thickness)" \
                'BEGIN { d = r / f - 1; d = d < 0 ? -d : d; exit !(i > d && i < 1e6 * d) }'
        done
    done
    run romrun scene.yml --model c.h5
    [[ $output == *"indicated deviation     "*" of the central film thickness"* ]]
    [ "$(grep -cE "^  estimated error       model [0-9.e-]+ %, grid [0-9.e-]+ %, inlet [0-9.e-]+ %$" <<<"$output")" -eq 2 ]
    # a size that was not measured and a model without calibration have no indicated deviation
    romrun scene.yml --model c.h5 --rows 23 -o other.h5 --allow-untrusted
    romrun scene.yml --model m.h5 -o plain.h5 --allow-untrusted
    shows_no indicated h5dump -H other.h5
    shows_no indicated h5dump -H plain.h5
    # with indicator factors 1e9 times as large the scene is flagged
    cp c.h5 x.h5
    /usr/bin/python3 -c "
import h5py
with h5py.File('x.h5', 'r+') as f:
    f.attrs.pop('content_sha256', None)
    f['indicator_factor'][...] *= 1e9"
    run --separate-stderr romrun scene.yml --model x.h5 --accuracy 0.1 -o flagged.h5 --quiet
    [ "$status" -eq 4 ]
    [[ $stderr == "romrun: scene.yml: found an indicated deviation of "*", more than the --accuracy of 0.1, expected a result to be trusted"* ]]
    [ "$(number flagged.h5 status)" = 4.0 ]
    romrun scene.yml --model x.h5 --accuracy 0.1 --quiet --allow-untrusted
    # without --accuracy the limit is 1 %, for the minimum film too
    run --separate-stderr romrun scene.yml --model x.h5 --quiet
    [ "$status" -eq 4 ]
    [[ $stderr == "romrun: scene.yml: found an indicated deviation of "*" of the "*" film, more than holds without --accuracy, 0.01, expected a result to be trusted"* ]]
    cp c.h5 x.h5
    /usr/bin/python3 -c "
import h5py
with h5py.File('x.h5', 'r+') as f:
    f.attrs.pop('content_sha256', None)
    f['indicator_factor_minimum'][...] *= 1e-9"
    romrun scene.yml --model x.h5 -o least.h5 --quiet
    [ "$(number least.h5 indicated_deviation_minimum)" = "$(number least.h5 indicated_deviation)" ]
    cp c.h5 x.h5
    /usr/bin/python3 -c "
import h5py
with h5py.File('x.h5', 'r+') as f:
    f.attrs.pop('content_sha256', None)
    f['indicator_factor_minimum'][...] *= 1e9"
    run --separate-stderr romrun scene.yml --model x.h5 --quiet
    [ "$status" -eq 4 ]
    [[ $stderr == *" of the minimum film, more than holds without --accuracy, 0.01, expected"* ]]
    romrun scene.yml --model x.h5 --quiet --allow-untrusted
}

@test "a solution that leaves far more in the rows than the calibration's scenes is not trusted" {
    romrun scene.yml --model c.h5 -o good.h5 --quiet
    cp c.h5 x.h5
    /usr/bin/python3 -c "
import h5py
with h5py.File('x.h5', 'r+') as f, h5py.File('good.h5') as good:
    f.attrs.pop('content_sha256', None)
    f['position_largest_residual'][...] = good['residual_norm'][0] / 99"
    romrun scene.yml --model x.h5 --quiet
    /usr/bin/python3 -c "
import h5py
with h5py.File('x.h5', 'r+') as f:
    f.attrs.pop('content_sha256', None)
    f['position_largest_residual'][...] *= 0.98"
    run --separate-stderr romrun scene.yml --model x.h5 --quiet
    [ "$status" -eq 4 ]
    [[ $stderr == "romrun: scene.yml: found a residual far above those of the calibration, that of a false solution, expected a result to be trusted"* ]]
}

@test "a pressure that cannot be one is exit code 3, whatever is allowed" {
    # the pressure is negative at a node that no row needs, so only a run that writes fields finds it
    cp m.h5 y.h5
    /usr/bin/python3 -c "
import h5py
with h5py.File('y.h5', 'r+') as f:
    f.attrs.pop('content_sha256', None)
    needed = f['needed_node_index'][...] - 1
    node = next(k for k in range(60, 0, -1) if k not in needed)
    f['pressure_basis'][:, node] *= -1"
    romrun scene.yml --model y.h5 --quiet --allow-untrusted
    run --separate-stderr romrun scene.yml --model y.h5 --quiet --set output.fields=true --allow-untrusted
    [ "$status" -eq 3 ]
    [[ $stderr == "romrun: scene.yml: found a pressure below zero by more than a thousandth of the Hertz pressure, expected convergence" ]]
}

@test "a solution that takes far more iterations than the calibration's scenes is not trusted" {
    romrun scene.yml --model c.h5 -o good.h5 --quiet
    cp c.h5 x.h5
    for factor in 5.1 4.9; do
        /usr/bin/python3 -c "
import h5py
with h5py.File('x.h5', 'r+') as f, h5py.File('good.h5') as good:
    f.attrs.pop('content_sha256', None)
    f['position_most_iterations'][...] = good['newton_iterations'][0] / $factor"
        run --separate-stderr romrun scene.yml --model x.h5 --quiet
        [ "$factor" = 4.9 ] || [ "$status" -eq 4 ]
        [ "$factor" = 5.1 ] || [ "$status" -eq 0 ]
        [ "$factor" = 4.9 ] || [[ $stderr == "romrun: scene.yml: found far more iterations than any scene of the calibration took, expected a result to be trusted"* ]]
    done
}

# bats test_tags=slow
@test "other quantities are indicated, and --accuracy-of is about them" {
    cat >deviations.py <<'PYTHON'
import h5py, numpy
with h5py.File("full.h5") as full, h5py.File("red.h5") as red:
    def off(name):
        return numpy.abs(red[name][...] - full[name][...])
    central = full["central_film_thickness"][0]
    inside = full["pressure"][0] > 0
    true = {"central_pressure": off("central_pressure")[0] / full["central_pressure"][0],
            "exit_position": off("exit_position").max(), "load": off("load")[0],
            "pressure": off("pressure").max(), "film": off("film_thickness")[0][inside].max() / central}
    for name, deviation in true.items():
        indicated = red["indicated_deviation_" + name][0]
        # the load is known, so its indicated deviation is the true deviation
        least, rounding = (0.99, 1e-8) if name == "load" else (1.9, 0)
        assert least * deviation - rounding <= indicated < 1e6 * deviation + 1e-9, (name, indicated, deviation)
PYTHON
    for M in 10 12; do
        for L in 3 5; do
            fullrun scene.yml --set moes.M=$M --set moes.L=$L -o full.h5 --force
            romrun scene.yml --set moes.M=$M --set moes.L=$L -o red.h5 --force --model c.h5 --set output.fields=true
            /usr/bin/python3 deviations.py
        done
    done
    run romrun scene.yml --model c.h5
    [ "$(grep -cE "^  of others             central pressure [0-9.e-]+, exit position [0-9.e-]+ half widths, load [0-9.e-]+, pressure [0-9.e-]+ p_H, film [0-9.e-]+ H_c$" <<<"$output")" -eq 1 ]
    romrun scene.yml --model c.h5 --quiet --accuracy-of pressure=0.9 --accuracy-of load=0.9
    for name in central_pressure exit_position load pressure film_thickness; do
        run --separate-stderr romrun scene.yml --model c.h5 --quiet --accuracy-of $name=1e-15 --accuracy-of pressure=0.9 -o low.h5 --force
        if [ "$name" = pressure ]; then # the last limit of a quantity holds
            [ "$status" -eq 0 ]
            continue
        fi
        [ "$status" -eq 4 ]
        [[ $stderr == "romrun: scene.yml: found an indicated deviation of "*", more than the --accuracy-of $name=1e-15, expected a result to be trusted"* ]]
        [ "$(number low.h5 status)" = 4.0 ]
    done
    romrun scene.yml --model c.h5 --quiet --accuracy-of load=1e-15 --allow-untrusted
    refuse 64 "--accuracy-of: found presure=1, expected NAME=X with NAME one of central_pressure, exit_position, load, pressure, film_thickness, friction, rolling_resistance" \
        romrun scene.yml --model c.h5 --accuracy-of presure=1
    refuse 64 "--accuracy-of: found load=2, expected load=X with X above 0, at most 1" \
        romrun scene.yml --model c.h5 --accuracy-of load=2
    refuse 64 "--accuracy-of: found with romrun trade, expected with romrun SCENE.yml" romrun --trade --model c.h5 --accuracy-of load=1
    # a model without the factor cannot guarantee a requested accuracy
    cp c.h5 w.h5
    /usr/bin/python3 -c "
import h5py
with h5py.File('w.h5', 'r+') as f: f.attrs.pop('content_sha256', None); del f['indicator_factor_pressure']"
    run --separate-stderr romrun scene.yml --model w.h5 --quiet --accuracy-of pressure=0.9
    [ "$status" -eq 4 ]
    [[ $stderr == *"found no indicated deviation of the pressure, for which --accuracy-of asks"* ]]
}

# bats test_tags=slow
@test "the friction is indicated where a scene slides, by its own law, and only there" {
    sliding_scene >sliding.yml
    for law in "eyring, tau0: 5e6" newtonian "limiting, limit: 0.05"; do
        sed "s/shear: .*/shear: {law: $law}/" sliding.yml >law.yml
        fullrun law.yml -o full.h5 --force --quiet
        romrun law.yml --model c.h5 -o red.h5 --force >printed
        awk -v full="$(number full.h5 friction_force)" -v red="$(number red.h5 friction_force)" \
            -v indicated="$(number red.h5 indicated_deviation_friction)" \
            'BEGIN { off = red / full - 1; exit !(indicated > (off < 0 ? -off : off) && indicated < 0.05) }'
        grep -qE "^  of others .* H_c, friction [0-9.e-]+$" printed
    done
    # each law has an estimate of its own; with the limiting law, friction depends least on the pressure
    [ "$(number red.h5 indicated_deviation_friction)" != "$(romrun sliding.yml --model c.h5 -o x.h5 --quiet && number x.h5 indicated_deviation_friction)" ]
    romrun sliding.yml --model c.h5 --quiet --accuracy-of friction=0.9
    run --separate-stderr romrun sliding.yml --model c.h5 --quiet --accuracy-of friction=1e-9 -o low.h5
    [ "$status" -eq 4 ]
    [[ $stderr == *"found an indicated deviation of "*" of the friction, more than the --accuracy-of friction=1e-09, expected"* ]]
    [ "$(number low.h5 status)" = 4.0 ]
    # the rolling resistance is judged by the error estimate of the grid
    romrun sliding.yml --model c.h5 --quiet --accuracy-of rolling_resistance=0.5
    run --separate-stderr romrun sliding.yml --model c.h5 --quiet --accuracy-of rolling_resistance=1e-9 -o low.h5 --force
    [ "$status" -eq 4 ]
    [[ $stderr == *"found an error estimate of "*" of the rolling resistance, more than the --accuracy-of rolling_resistance=1e-09, expected"* ]]
    romrun sliding.yml --model c.h5 | grep -qE "^  error of rolling +grid [0-9.e-]+ %, inlet [0-9.e-]+ %$"
    # the limit also holds in a table of cases; a flat model gives the same bits
    printf 'slide_roll\n0.05\n0\n' >two.csv
    run --separate-stderr romrun sliding.yml --cases two.csv --model c.h5 --accuracy-of friction=1e-9 -o two-out.csv --quiet
    [ "$status" -eq 4 ]
    [ "$(grep -c "deviation of .* of the friction" two-out.csv)" -eq 1 ] # without sliding there is no friction
    romrun --export c.h5 -o c.ehdrom
    romrun sliding.yml --model c.ehdrom -o flat.h5 --quiet
    [ "$(number flat.h5 indicated_deviation_friction)" = "$(number x.h5 indicated_deviation_friction)" ]
    # nothing slides in this scene
    romrun scene.yml --model c.h5 -o still.h5 >printed
    shows_no friction cat printed
    shows_no indicated_deviation_friction h5dump -H still.h5
    run --separate-stderr romrun scene.yml --model c.h5 --quiet --accuracy-of friction=0.9
    [ "$status" -eq 4 ]
    [[ $stderr == *"found no indicated deviation of the friction, for which --accuracy-of asks"* ]]
    # a model of an earlier version has no factor for friction; its indicated deviations of the films are unchanged
    patch c.h5 "del f['indicator_factor_friction']
    for name in ('share', 'growth', 'offset', 'offset_share'):
        values = f['indicator_' + name][:, :-1]
        del f['indicator_' + name]
        f['indicator_' + name] = values
    del f['bounded']
    f['bounded'] = numpy.arange(values.shape[1])"
    romrun sliding.yml --model bad.h5 -o before.h5 --quiet >printed
    romrun sliding.yml --model bad.h5 >printed
    grep -q "^  of others .* H_c, friction not known$" printed
    shows_no indicated_deviation_friction h5dump -H before.h5
    for name in indicated_deviation indicated_deviation_minimum indicated_deviation_pressure; do
        [ "$(number before.h5 $name)" = "$(number x.h5 $name)" ]
    done
}

# bats test_tags=slow
@test "a calibration of before has one factor for both films, and no limit to residuals" {
    cp c.h5 x.h5
    /usr/bin/python3 -c "
import h5py
with h5py.File('x.h5', 'r+') as f:
    f.attrs.pop('content_sha256', None)
    del f['indicator_factor_minimum'], f['position_largest_residual']
    for name in 'central_pressure', 'exit_position', 'load', 'pressure', 'film':
        del f['indicator_factor_' + name]"
    romrun --check=x.h5
    romrun scene.yml --model c.h5 -o new.h5 --quiet
    romrun scene.yml --model x.h5 -o old.h5 --quiet
    [ "$(number new.h5 indicated_deviation)" = "$(number old.h5 indicated_deviation)" ]
    h5dump -H new.h5 | grep -q indicated_deviation_pressure
    shows_no indicated_deviation_pressure h5dump -H old.h5
    [ "$(number new.h5 indicated_deviation_minimum)" != "$(number old.h5 indicated_deviation_minimum)" ]
}

# bats test_tags=slow
@test "a calibration of before has factors that hold for all bounds" {
    romrun scene.yml --model c.h5 -o new.h5 --quiet
    patch c.h5 "del f['indicator_growth']"
    romrun --check=bad.h5
    romrun scene.yml --model bad.h5 -o old.h5 --quiet
    awk -v new="$(number new.h5 indicated_deviation)" -v old="$(number old.h5 indicated_deviation)" \
        'BEGIN { exit !(new > 0 && old > 1.01 * new) }'
    patch c.h5 "f['indicator_share'][0, 1] = -1"
    refused 65 "bad.h5: indicator_share: found -1, expected at least 0" \
        romrun scene.yml --model bad.h5
}

# bats test_tags=slow
@test "a scene that the chosen size does not do for is solved with the most accurate one" {
    cp c.h5 x.h5
    cat >spoil.py <<'PYTHON'
import h5py, numpy
with h5py.File("x.h5", "r+") as f:
    f.attrs.pop('content_sha256', None)
    best = numpy.nanargmin(f["indicated_deviation"][:, 2])
    f["indicator_factor"][...] = numpy.where(numpy.arange(f["position"].size) == best, 1, 1e9) * f["indicator_factor"][...]
    print(f["position_pressure_modes"][best], f["position_rows"][best])
PYTHON
    read -r modes rows <<<"$(/usr/bin/python3 spoil.py)"
    run --separate-stderr romrun scene.yml --model x.h5 --accuracy 0.1 -o again.h5
    [ "$status" -eq 0 ]
    [ "${#stderr_lines[@]}" -eq 3 ] # the last line is about the missing digest
    [[ ${stderr_lines[1]} == "romrun: --accuracy 0.1: found an indicated deviation of "*", again with $modes pressure modes, $rows rows" ]]
    [[ $(h5dump -a settings again.h5) == *"# $modes pressure modes, 0 deformation modes, $rows rows (0: all), accuracy "* ]]
    romrun scene.yml --model c.h5 --pressure-modes "$modes" --rows "$rows" -o straight.h5 --quiet
    awk -v a="$(number again.h5 central_film_thickness)" -v b="$(number straight.h5 central_film_thickness)" \
        'BEGIN { d = a / b - 1; exit !(d < 1e-3 && d > -1e-3) }'
}

# bats test_tags=slow
@test "a spike that the chosen size has wrong is solved with the most accurate one, and no reason to flag" {
    cp c.h5 x.h5
    read -r modes rows <<<"$(/usr/bin/python3 - <<'PYTHON'
import h5py, numpy
with h5py.File("x.h5", "r+") as f:
    f.attrs.pop('content_sha256', None)
    best = numpy.nanargmin(f["indicated_deviation"][:, 2])
    f["indicator_factor_pressure"][...] *= 1e9
    print(f["position_pressure_modes"][best], f["position_rows"][best])
PYTHON
)"
    run --separate-stderr romrun scene.yml --model x.h5 --accuracy 0.1 -o again.h5
    [ "$status" -eq 0 ]
    [[ ${stderr_lines[1]} == "romrun: --accuracy 0.1: found an indicated deviation of "*" p_H of the largest pressure, more than 3 times that, again with $modes pressure modes, $rows rows" ]]
    [[ $(h5dump -a settings again.h5) == *"# $modes pressure modes, 0 deformation modes, $rows rows (0: all), accuracy "* ]]
    # a table of cases is solved with the most accurate size too
    echo moes.M >one.csv
    sed -n 's/^moes: {M: \([0-9.]*\),.*/\1/p' scene.yml >>one.csv
    romrun scene.yml --cases one.csv --model x.h5 --accuracy 0.1 -o cases.h5 --quiet
    [ "$(number cases.h5 central_film_thickness)" = "$(number again.h5 central_film_thickness)" ]
    # with the measured factors the chosen size is accurate enough
    run --separate-stderr romrun scene.yml --model c.h5 --accuracy 0.1
    [[ $status == 0 && $stderr != *"again with"* ]]
}

# bats test_tags=slow
@test "--verify tells the deviation to first order, and changes nothing" {
    fullrun scene.yml -o full.h5
    for modes in 8 12; do
        romrun scene.yml --model m.h5 --pressure-modes $modes -o plain.h5 --force --quiet --allow-untrusted
        romrun scene.yml --model m.h5 --pressure-modes $modes -o verified.h5 --force --verify --allow-untrusted >out
        same_data plain.h5 verified.h5
        residual=$(sed -n 's/^full residual *\([^ ]*\) (fullrun: below 1e-10), .* ms$/\1/p' out)
        change=$(sed -n 's/^a full Newton step *\([^ ]*\) of the central film thickness.*/\1/p' out)
        awk -v c="$change" -v r="$residual" -v f="$(number full.h5 central_film_thickness)" \
            -v h="$(number verified.h5 central_film_thickness)" \
            'BEGIN { d = f / h - 1; exit !(r > 1e-9 && c / d > 0.8 && c / d < 1.25) }'
    done
    refused 64 "--verify: found with a transient scene" romrun --verify --model m.h5 \
        scene.yml --set regime=transient --set transient.end_time=1
    refused 64 "--verify: found with romrun trade, expected with romrun SCENE.yml" \
        romrun --verify --trade --model c.h5
}

# bats test_tags=slow
@test "a calibrated model is a model" {
    romrun scene.yml --model m.h5 -o first.h5 --allow-untrusted
    romrun scene.yml --model c.h5 -o second.h5
    [ "$(number first.h5 central_film_thickness)" = "$(number second.h5 central_film_thickness)" ]
    deimselect --check c.h5
    /usr/bin/python3 -c 'import xarray; print(xarray.open_dataset("c.h5"))' | grep -q position
}

@test "training points and points outside" {
    refuse 65 "train.yml: point M=8 L=2: found a training point of m.h5, expected" \
        romrun --calibrate train.yml --model m.h5 -o x.h5
    sed 's/\[10, 12\]/[10, 40]/' check.yml >wide.yml
    run --separate-stderr romrun --calibrate wide.yml --model m.h5 -o x.h5
    [ "$status" -eq 0 ]
    [[ $stderr == *"wide.yml: 2 of 4 points lie outside of the trained range and are left out"* ]]
    [ "$(number x.h5 calibration_scenes)" = 2.0 ]
    rm x.h5
    sed 's/\[10, 12\]/[30, 40]/' check.yml >outside.yml
    refuse 65 "outside.yml: found all 4 points outside of the trained range of m.h5" \
        romrun --calibrate outside.yml --model m.h5 -o x.h5 --quiet
    refuse 65 "check.yml: x: found 301 nodes" \
        romrun --calibrate check.yml --model m.h5 -o x.h5 --set grid.step=0.02
    refuse 66 "none.yml" romrun --calibrate none.yml --model m.h5 -o x.h5
    refuse 66 "none.h5" romrun --calibrate check.yml --model none.h5 -o x.h5
    refuse 65 "b.h5" romrun --calibrate check.yml --model b.h5 -o x.h5
}

@test "an existing output is kept, and replaced only with --force" {
    echo precious >x.h5
    refused 73 "x.h5: " romrun --calibrate check.yml --model m.h5 -o x.h5
    [ "$(cat x.h5)" = precious ]
    romrun --calibrate check.yml --model m.h5 -o x.h5 --force --quiet
    romrun --check x.h5
    refused 73 "found an input as output" romrun --calibrate check.yml --model x.h5 -o x.h5 --force
}

# bats test_tags=slow
@test "trajectories, with the steps of the full model" {
    moving_scene "step: 0.05" "end_time: 0.5, fixed_step: 0.01"
    time_plan train "0.5, 1" 0.1
    time_plan check 0.75 0.1
    time_plan wide 0.75 0.4
    model_in_time 14
    run --separate-stderr romrun --calibrate check-time.yml --model tm.h5 -o tc.h5 --quiet
    [ "$status" -eq 0 ]
    [ -z "$stderr" ]
    [[ $output == "0 scenes, 1 trajectories, "* ]]
    romrun --check tc.h5
    # the worst deviation equals the deviation that --against prints for the whole model, since both runs take the same
    # fixed steps
    fullrun moving.yml --set transient.load.period=0.75 -o full.h5 --quiet
    romrun moving.yml --set transient.load.period=0.75 --model tm.h5 --against full.h5 --quiet --allow-untrusted >red.txt
    worst=$(sed -n 's/.*central film thickness *at most \([^ ]*\) %.*/\1/p' red.txt)
    awk -v a="$worst" -v b="$(entry tc.h5 worst_in_time_central_film_thickness -1)" \
        'BEGIN { exit !(a / (100 * b) > 0.95 && a / (100 * b) < 1.05) }'
    [ "$(entry tc.h5 position_lost_trajectories -1)" = 0.0 ]
    run --separate-stderr romrun --trade --model tc.h5
    [[ ${lines[1]} == "1 trajectories: worst deviation"* ]]
    # The size is chosen by transient measurements, and only for transient scenes. The fastest size depends on the
    # machine, and so does the deviation that it indicates for this history.
    run --separate-stderr romrun moving.yml --model tc.h5 --accuracy 0.5 -o tx.h5 --allow-untrusted
    [ "$status" -eq 0 ]
    [[ $stderr == *"romrun: --accuracy 0.5: "*" on 100 % of 1 trajectories, in "*" ms a step"* ]]
    [[ $(h5dump -a settings tx.h5) == *"rows (0: all), accuracy 0.5"* ]]
    sed -e 's/regime: transient/regime: stationary/' -e /^transient/d moving.yml >still.yml
    refuse 65 "tc.h5: found a calibration without scenes" \
        romrun still.yml --model tc.h5 --accuracy 0.5 -o x.h5
    refuse 65 "c.h5: found a calibration without trajectories" \
        romrun moving.yml --model c.h5 --accuracy 0.5 -o x.h5
    # a trajectory that leaves the trained range is left out
    run --separate-stderr romrun --calibrate wide-time.yml --model tm.h5 -o x.h5
    [ "$status" -eq 65 ]
    [[ $stderr == *"wide-time.yml: 1 of 1 trajectories leave the trained range"*"found nothing inside"* ]]
    [ ! -e x.h5 ]
    [ ! -e x.h5.partial ]
}

# bats test_tags=slow
@test "in time what is indicated decides the exit code, step by step" {
    moving_scene "step: 0.05" "end_time: 2, fixed_step: 0.02"
    time_plan train "0.5, 1.3" 0.1
    time_plan check "0.6, 1.1" 0.095
    model_in_time 40 --no-check
    romrun --calibrate check-time.yml --model tm.h5 -o tc.h5 --quiet
    # this history is nearly as fast as the training; a model that was never checked flags every history
    fast="--set transient.load.period=0.53"
    run --separate-stderr romrun moving.yml --model tm.h5 $fast --quiet
    [ "$status" -eq 4 ]
    [[ $stderr == *"a model without a successful check in time at these sizes"* ]]
    fullrun moving.yml $fast -o full.h5 --quiet
    run --separate-stderr romrun moving.yml --model tc.h5 $fast -o good.h5 --quiet
    [ "$status" -eq 0 ]
    [ -z "$stderr" ]
    [[ $output == *"indicated deviation     central film "*" %, minimum film "*" % at most"* ]]
    # too few modes: the minimum film is 3 % off, and the central film is off later
    run --separate-stderr romrun moving.yml --model tc.h5 $fast --pressure-modes 10 --rows 20 \
        -o bad.h5 --quiet
    [ "$status" -eq 4 ]
    [[ $stderr == "romrun: moving.yml: found an indicated deviation of "*" film, more than 0.01, first at T = "* ]]
    romrun moving.yml --model tc.h5 $fast --pressure-modes 10 --rows 20 --allow-untrusted --quiet
    /usr/bin/python3 - <<'PYTHON'
import h5py, numpy
full = h5py.File("full.h5")
assert numpy.isnan(full["indicated_deviation"][...]).all()
for name, most in [("good", 0.01), ("bad", 1)]:
    with h5py.File(name + ".h5") as file:
        numpy.testing.assert_allclose(file["time"][...], full["time"][...], rtol=1e-12)
        above = numpy.zeros(len(file["time"]), bool)
        for film, indicated in [("central_film_thickness", "indicated_deviation"),
                                ("minimum_film_thickness", "indicated_deviation_minimum")]:
            off = abs(file[film][...] / full[film][...] - 1)
            # the estimate also bounds the deviation of the minimum film, while the exit moves faster than in the
            # training
            assert (file[indicated][...] >= off).all()
            assert file[indicated][...].max() < most
            above |= file[indicated][...] > 0.01
        assert ((file["status"][...] == 4) == above).all() and above.any() == (name == "bad")
PYTHON
    # --accuracy is a limit for each step of both films. For this history each size that may be the fastest here
    # indicates a deviation of 0.0011 of the minimum film.
    run --separate-stderr romrun moving.yml --model tc.h5 --set transient.load.period=0.65 \
        --set transient.fixed_step=0.04 --accuracy 9e-4 --quiet
    [ "$status" -eq 4 ]
    [[ $stderr == *"found an indicated deviation of "*" of the minimum film, more than 0.0009, first at T = "* ]]
    # if the accuracy is better than any measured accuracy, the most accurate size is used, and each step has its own
    # estimate
    run --separate-stderr romrun moving.yml --model tc.h5 $fast --accuracy 1e-12 --quiet
    [ "$status" -eq 4 ]
    [[ $stderr == *"found an indicated deviation of "*" film, more than 1e-12, first at T = "* ]]
    run --separate-stderr romrun moving.yml --model tc.h5 $fast --accuracy 1e-12 --allow-untrusted
    [ "$status" -eq 0 ]
    [[ $stderr == "romrun: --accuracy 1e-12: 40 pressure modes, "*", the most accurate of "*"each step is judged by its own"* ]]
    # the calibration wrongly states that this size is accurate, so the most accurate size repeats the march
    cp tc.h5 ta.h5
    /usr/bin/python3 - <<'PYTHON'
import h5py
with h5py.File("ta.h5", "r+") as f:
    f.attrs.pop("content_sha256", None)
    assert f["position_pressure_modes"][0] == 10 and f["position_rows"][0] == 12
    f["indicated_in_time"][0] = 1e-2
    f["position_step_seconds"][0] = 1e-9
    f["position_lost_trajectories"][0] = 0
PYTHON
    run --separate-stderr romrun moving.yml --model ta.h5 $fast --pressure-modes 10 --rows 12 -o lost.h5
    [ "$status" -eq 4 ]
    run --separate-stderr romrun moving.yml --model ta.h5 $fast --accuracy 0.02 -o again.h5
    [ "$status" -eq 0 ]
    [[ $stderr == *"--accuracy 0.02: 10 pressure modes, 12 rows, the fastest of "* ]]
    [[ $stderr == *"--accuracy 0.02: moving.yml: found an indicated deviation of "*", again with 40 pressure modes, "* ]]
    [[ $stderr != *again.h5.partial* ]]
    [[ $output != *"not to be trusted"* ]]
    romrun moving.yml --model tc.h5 $fast -o good.h5 --force --quiet
    /usr/bin/python3 - <<'PYTHON'
import h5py, numpy
numpy.testing.assert_allclose(h5py.File("again.h5")["central_film_thickness"], h5py.File("good.h5")["central_film_thickness"], rtol=1e-4)
PYTHON
    # the most accurate size is not trusted here either, and the message suggests --fallback
    run --separate-stderr romrun moving.yml --model ta.h5 --set transient.load.period=0.4 --accuracy 0.02 -o x.h5
    [ "$status" -eq 4 ]
    [[ $stderr == *", again with 40 pressure modes, "*"(--fallback full has the full model solve it"* ]]
    # a history faster than the training is outside of the trained range, whatever deviation is indicated, and is no
    # check scene
    run --separate-stderr romrun moving.yml --model tc.h5 --set transient.load.period=0.4 --accuracy 0.5 --quiet
    [ "$status" -eq 4 ]
    [[ $stderr == *"found a contact that changes faster than any in training, first at T = "* ]]
    time_plan faster "0.4, 1" 0.1
    run -0 --separate-stderr romrun --calibrate faster-time.yml --model tm.h5 -o tf.h5
    [[ $stderr == *"faster-time.yml: 1 of 2 trajectories leave the trained range"* ]]
    # a step of the speed, the fastest change there is, does not extend the trained rates of the load
    cat >>train-time.yml <<'YAML'
  - scene: moving.yml
    vary: {transient.speed.law: [step], transient.speed.to: [1.02], transient.speed.at: [0.5], transient.load.amplitude: [0.05]}
YAML
    rm t?.h5
    model_in_time 40 --no-check
    h5dump -d state_rate tm.h5 | tr ', ' '\n' | awk '$1 > most { most = $1 } END { exit !(most > 1) }'
    romrun --calibrate check-time.yml --model tm.h5 -o tc.h5 --quiet
    run --separate-stderr romrun moving.yml --model tc.h5 --set transient.load.period=0.4 --accuracy 0.5 --quiet
    [ "$status" -eq 4 ]
    [[ $stderr == *"found a load that changes faster than any in training, first at T = "* ]]
}

@test "Ctrl-C leaves nothing" {
    cat >slow.yml <<'YAML'
groups:
  - scene: base.yml
    vary: {moes.M: [8.1, 8.6, 9.1, 10.1, 10.6, 11.1, 11.6, 12.1, 12.6, 13.1, 13.6, 14.1, 14.6],
           moes.L: [2.1, 2.5, 2.9, 3.1, 3.5, 3.9, 4.1, 4.5, 4.9, 5.1, 5.5, 5.9]}
YAML
    stop_when INT exists x.h5 romrun --calibrate slow.yml --model m.h5 -o x.h5 --jobs 1 --quiet 2>log
    cat log
    [ "$code" -eq 130 ]
    grep -q "x.h5: interrupted .*nothing written" log
    [ ! -e x.h5 ]
    [ ! -e x.h5.partial ]
}

@test "misuse is one line and exit 64" {
    refuse 64 "found 2 files, expected romrun calibrate PLAN.yml" \
        romrun scene.yml --calibrate check.yml --model m.h5 -o x.h5
    refuse 64 "found with scene.yml, expected one of them" romrun scene.yml --trade --model c.h5
    refuse 64 "found trade and calibrate, expected one mode" romrun --trade --calibrate check.yml --model m.h5 -o x.h5
    refuse 64 "--output: found nothing" romrun --calibrate check.yml --model m.h5
    refuse 64 "--output: found with romrun trade, expected none" romrun --trade --model c.h5 -o x.h5
    refuse 64 "--model: found none" romrun --calibrate check.yml -o x.h5
    refuse 64 "--model: found none" romrun --trade
    refuse 64 "--jobs: found with romrun SCENE.yml, expected with romrun cases" romrun scene.yml --model m.h5 -o x.h5 --jobs 2
    refuse 64 "--jobs: found" romrun --calibrate check.yml --model m.h5 -o x.h5 --jobs 0
    refuse 64 "--rows: found with romrun calibrate, expected with" romrun --calibrate check.yml --model m.h5 -o x.h5 --rows 20
    refuse 64 "--accuracy: found with romrun calibrate, expected with" \
        romrun calibrate check.yml --model m.h5 -o x.h5 --accuracy 0.1
    for option in --rows --pressure-modes --deformation-modes; do
        refuse 64 "--accuracy: found with" romrun scene.yml --model c.h5 -o x.h5 --accuracy 0.1 $option 9
    done
    for number in 0 -1 nan inf 2 x 1e-3x ''; do
        refuse 64 "--accuracy: found" romrun scene.yml --model c.h5 -o x.h5 "--accuracy=$number"
    done
    refuse 64 "--repeat: found with romrun trade, expected with" romrun --trade --model c.h5 --repeat 5
}

# ---- modes of romrun

# shown MODE: prints the names of the options in the help of a mode, without the common ones.
shown() {
    romrun $1 --help | sed '/Common to all programs/,$d' | sed -nE 's/^ +(-[a-z], )?--([a-z-]+).*/\2/p' | sort | xargs
}

@test "each mode has a help of one screen with its own options only" {
    [ "$(shown "")" = "accuracy accuracy-of against allow-untrusted deformation-modes fallback model pressure-modes repeat resume rows verify" ]
    [ "$(shown cases)" = "accuracy accuracy-of allow-untrusted deformation-modes jobs model pressure-modes resume rows" ]
    [ "$(shown calibrate)" = "jobs model" ]
    [ "$(shown trade)" = "model" ]
    [ "$(shown export)" = "deformation-modes model pressure-modes rows" ]
    [ "$(shown fmu)" = "accuracy deformation-modes fmi model pressure-modes rows" ]
    romrun --help >all
    for mode in cases calibrate trade export fmu; do
        romrun $mode --help >one
        [ "$(wc -l <one)" -le 60 ]
        [ "$(grep -cE '^(Usage|  or): ' one)" -eq 1 ]
        grep -q "^Usage: romrun .* $mode " one
        grep -q "^  or: .* $mode " all
        shows_no "Settings of a scene" cat one
        romrun --$mode x --help | cmp - one
    done
    grep -q "^romrun MODE --help shows the options of a mode" all
}

@test "a mode names what is missing, and refuses options of other modes and a second mode" {
    refuse 64 "found no SCENE.yml, expected romrun SCENE.yml -m" romrun --model c.h5
    refuse 64 "found no CASES.csv, expected romrun cases SCENE.yml CASES.csv -m" romrun cases scene.yml --model c.h5
    refuse 64 "found no SCENE.yml, expected romrun cases" romrun --cases cases.csv --model c.h5
    refuse 64 "found no PLAN.yml, expected romrun calibrate PLAN.yml" romrun calibrate --model c.h5 -o x.h5
    refuse 64 "--model: found none, expected romrun trade MODEL.h5" romrun trade
    refuse 64 "--model: found none, expected romrun export MODEL.h5 -o" romrun export -o x.ehdrom
    refuse 64 "found no SCENE.yml, expected romrun fmu SCENE.yml" romrun fmu --model c.h5 -o x.fmu
    refuse 64 "--repeat: found with romrun calibrate, expected with romrun SCENE.yml" \
        romrun calibrate check.yml --model m.h5 -o x.h5 --repeat 3
    refuse 64 "--jobs: found with romrun SCENE.yml, expected with romrun cases, romrun calibrate" \
        romrun scene.yml --model m.h5 --jobs 2
    refuse 64 "--accuracy-of: found with romrun fmu, expected with" romrun fmu scene.yml -m m.h5 -o x.fmu --accuracy-of load=1
    refuse 64 "found calibrate and trade, expected one mode" romrun trade --calibrate check.yml --model m.h5
    refuse 64 "found trade and fmu, expected one mode" romrun --trade --fmu scene.yml --model m.h5
    # an FMU may have a size and an accuracy; the scene is refused
    refuse 65 "moes: found neither" romrun fmu base.yml -m c.h5 -o x.fmu --accuracy 0.01 --rows 20
    [ ! -e x.h5 ] && [ ! -e x.fmu ]
}

@test "the word of a mode and the option of the same name do the same" {
    printf 'moes.M,moes.L\n10,3\n12,5\n' >cases.csv
    romrun cases base.yml cases.csv -m c.h5 -o word.csv -q
    romrun base.yml --cases=cases.csv -m c.h5 -o option.csv -q
    /usr/bin/python3 - <<'PYTHON'
import csv
tables = [list(csv.DictReader(open(name))) for name in ("word.csv", "option.csv")]
for row in tables[0] + tables[1]: del row["solve_seconds [s]"]
assert len(tables[0]) == 2 and tables[0] == tables[1]
PYTHON
    # --resume compares the settings of a table, including the limits
    romrun cases base.yml cases.csv -m c.h5 -o word.h5 -q --accuracy-of load=0.1
    romrun base.yml --cases cases.csv -m c.h5 -o option.h5 -q --accuracy-of load=0.1
    h5dump -a settings word.h5 | tail -n +2 >settings
    grep -q "# accuracy of load 0.1" settings
    h5dump -a settings option.h5 | tail -n +2 | cmp - settings
    romrun trade c.h5 >word
    romrun --trade --model c.h5 | cmp - word
    romrun trade -m c.h5 | cmp - word
    romrun export c.h5 --rows 20 -o word.ehdrom
    romrun --export c.h5 --rows 20 -o option.ehdrom
    cmp word.ehdrom option.ehdrom
    romrun -q calibrate check.yml -m m.h5 -o word-c.h5
    cmp <(romrun --print word-c.h5 position_rows) <(romrun --print c.h5 position_rows)
    # after --print FILE, the word of a mode is the name of an item; a file whose name is such a word is read as a file
    refuse 65 "trade" romrun --print c.h5 trade
    cp c.h5 trade
    romrun trade trade | cmp - word
}
