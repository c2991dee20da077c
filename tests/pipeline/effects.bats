#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests of the estimated effects of step and inlet on the films, from the training points to the reduced solution.

load common

EFFECTS=(step_effect step_effect_minimum inlet_effect inlet_effect_minimum)

# train NAME OPTION...: makes NAME.h5, the model of plan.yml, and keeps its inputs NAME-s.h5, NAME-b.h5 and NAME-r.h5.
train() {
    local name=$1
    shift
    snapgen plan.yml -o "$name-s.h5" -q "$@" && podbuild "$name-s.h5" -o "$name-b.h5" &&
        snapgen plan.yml --basis "$name-b.h5" -o "$name-r.h5" -q "$@" &&
        deimselect --no-check "$name-r.h5" --basis "$name-b.h5" -o "$name.h5"
}

setup_file() {
    cd "$BATS_FILE_TMPDIR" || return
    base_scene 'x_min: -4, x_max: 2, step: 0.02'
    { cat base.yml && echo 'moes: {M: 20, L: 5}'; } >scene.yml
    cat >plan.yml <<'YAML'
groups:
  - scene: base.yml
    vary: {moes.M: [10, 12, 15, 18, 22, 27, 33, 40], moes.L: [2, 4, 6, 8, 10]}
YAML
    for rows in published accurate; do
        train $rows --set discretization=$rows
    done
    train without --set discretization=published --set output.resolution=false
}

setup() {
    cd "$BATS_TEST_TMPDIR" || return
    cp "$BATS_FILE_TMPDIR"/*.{yml,h5} .
}

# value FILE NAME: prints an attribute.
value() {
    fullrun --print "$1" "$2" | tail -n 1
}

# within FACTOR A B: checks that A and B differ by less than this factor and have the same sign.
within() {
    awk -v f="$1" -v a="$2" -v b="$3" 'BEGIN { exit !(a / b < f && b / a < f && a / b > 0) }'
}

# bats test_tags=slow
@test "each training point has the estimates of fullrun, and the model has them all" {
    for rows in published accurate; do
        fullrun scene.yml -q --set discretization=$rows --set moes.M=27 --set moes.L=8 -o full.h5 --force
        for name in "${EFFECTS[@]}"; do
            # the training has another start and another tolerance than fullrun
            close_to "$(value full.h5 "$name")" "$(snapgen --print $rows-s.h5 "$name" moes_M moes_L |
                awk -F, '$2 == 27 && $3 == 8 { print $1 }')" 1e-4
            for file in $rows-b.h5 $rows.h5; do
                [ "$(snapgen --print $rows-s.h5 "$name" | tail -n +2)" = \
                    "$(romrun --print $file "state_$name" | tail -n +2)" ]
            done
        done
    done
}

# bats test_tags=slow
@test "between training points they are nearly those of the full model" {
    for place in "11 3" "20 5" "30 9" "36 3"; do
        read -r M L <<<"$place"
        for rows in published accurate; do
            options=(scene.yml -q --force --set discretization=$rows --set "moes.M=$M" --set "moes.L=$L")
            fullrun "${options[@]}" -o full.h5
            romrun --allow-untrusted "${options[@]}" -o reduced.h5 --model $rows.h5
            for name in "${EFFECTS[@]}"; do
                # with accurate rows these films converge irregularly, and the effect of the step changes its sign
                [[ $rows == accurate && $name == step* ]] && continue
                within 2 "$(value full.h5 "$name")" "$(value reduced.h5 "$name")"
            done
            within 1.05 "$(value full.h5 inlet_effect)" "$(value reduced.h5 inlet_effect)"
        done
    done
}

@test "romrun prints them below each film" {
    run romrun --allow-untrusted scene.yml --set discretization=published --model published.h5
    [ "$status" -eq 0 ]
    [[ $output =~ "central film thickness"[^$'\n']*$'\n'"  estimated error       grid "[0-9.]*" %, inlet "[0-9.]*" %"$'\n'"minimum film"[^$'\n']*$'\n'"  estimated error       grid "[0-9.]*" %, inlet "[0-9.]*" %"$'\n' ]]
    # the effects are also printed outside of the training; the result is flagged as usual
    run romrun scene.yml --set discretization=published --model published.h5 --set moes.M=45
    [ "$status" -eq 4 ]
    [[ $output == *"estimated error"* ]]
}

# bats test_tags=slow
@test "output.resolution false, or a model without them: no line, no attributes" {
    shows_no effect snapgen --print without-s.h5
    shows_no effect romrun --print without.h5
    options=(scene.yml --set discretization=published)
    romrun --allow-untrusted "${options[@]}" --model without.h5 -o a.h5 >a
    romrun --allow-untrusted "${options[@]}" --model published.h5 --set output.resolution=false -o b.h5 >b
    romrun --allow-untrusted "${options[@]}" --model published.h5 -o c.h5 >c
    for file in a b; do
        run -1 grep "estimated error" $file
        shows_no effect romrun --print $file.h5
        [ "$(number $file.h5 central_film_thickness)" = "$(number c.h5 central_film_thickness)" ]
    done
    [ "$(grep -c "estimated error" c)" -eq 2 ]
}

@test "a grid of which only half would be left says nothing of the films" {
    cat >plan.yml <<'YAML'
groups:
  - scene: base.yml
    vary: {moes.M: [80, 100, 120, 150, 180], moes.L: [2, 3, 4]}
YAML
    train coarse --set discretization=published
    snapgen --print coarse-s.h5 step_effect moes_M | grep "^inf,180"
    options=(scene.yml --set discretization=published --set moes.M=165 --set moes.L=2.5)
    # neither model gives an estimate, and neither result is trusted
    run --separate-stderr fullrun "${options[@]}" -q
    [ "$status" -eq 4 ]
    [[ $stderr == "fullrun: scene.yml: found a grid from X = -4 on by 0.02, too coarse to estimate its error, expected a finer one (--allow-untrusted takes the result all the same)" ]]
    fullrun "${options[@]}" -q --allow-untrusted
    run --separate-stderr romrun "${options[@]}" --model coarse.h5 --fallback full
    [ "$status" -eq 4 ]
    [[ $stderr == *"too coarse to estimate its error"* ]]
    run romrun --allow-untrusted "${options[@]}" --model coarse.h5 -o x.h5
    [ "$status" -eq 0 ]
    [ "$(grep -c "estimated error       grid too coarse to tell, inlet 0.0" <<<"$output")" -eq 2 ]
    shows_no step_effect romrun --print x.h5
    grep -q inlet_effect <(romrun --print x.h5)
}

@test "a note of the minimum film, where the central one gives none" {
    run --separate-stderr fullrun scene.yml --set discretization=accurate --set moes.M=80 --set moes.L=3 -o x.h5
    [ "$status" -eq 0 ]
    [ "${#stderr_lines[@]}" -eq 1 ]
    [[ $stderr =~ ^"fullrun: scene.yml: grid.step: found 0.02, expected a finer one".*"the error estimate of the minimum film is "[0-9.]+" %"$ ]]
    awk -v e="$(value x.h5 step_effect)" 'BEGIN { exit !(e < 0.01 && e >= 0) }'
}

# bats test_tags=slow
@test "of adaptive training and of a result of fullrun too" {
    snapgen plan.yml --adaptive --max-points 12 -o adaptive.h5 -q --set discretization=published || [ $? -eq 3 ]
    [ "$(snapgen --print adaptive.h5 step_effect status | grep -c '^[0-9.e-]*,0$')" -ge 10 ]
    fullrun scene.yml -q --set discretization=published -o full.h5
    podbuild full.h5 -o one.h5
    for name in "${EFFECTS[@]}"; do
        close_to "$(value full.h5 "$name")" "$(romrun --print one.h5 "state_$name" | tail -n 1)" 0
    done
}
