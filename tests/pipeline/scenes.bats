#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# The ready pipelines at a small size: a copied folder works under any name, only what changed is made
# again, and the tables and pictures are there.

load common

# copy_scene NAME: that scene with a small grid, plan and models, as scenes/own.
copy_scene() {
    local root=$BATS_TEST_DIRNAME/../..
    mkdir -p "$BATS_TEST_TMPDIR/scenes"
    cd "$BATS_TEST_TMPDIR/scenes" || return
    cp "$root"/scenes/*.* .
    cp -r "$root/scenes/$1" own
    cd own || return
    rm -rf out
    sed -i 's/step: [0-9.]*/step: 0.02/' scene.yml
    sed -i -e 's/^model.*PRESSURE_MODES *=.*/&\nmodel.PRESSURE_MODES = 12\nmodel-fast.PRESSURE_MODES = 10\nmodel-paper.PRESSURE_MODES = 12/' \
        -e 's/^model.*DEFORMATION_MODES *=.*/&\nmodel-paper.DEFORMATION_MODES = 8/' \
        -e 's/^model.*ROWS *=.*/&\nmodel.ROWS = 40\nmodel-fast.ROWS = 40\nmodel-paper.ROWS = 40/' \
        -e 's/^FIGURE3_PRESSURE_MODES.*/FIGURE3_PRESSURE_MODES = 8 12/' \
        -e 's/^FIGURE3_DEFORMATION_MODES.*/FIGURE3_DEFORMATION_MODES = 8/' \
        -e 's/^FIGURE3_FIXED.*/FIGURE3_FIXED = 12 8/' Makefile
}

# One lubricant and a plan that covers its cases.
small_low() {
    copy_scene stationary-line
    sed -i -e 's/moes.M: .*/moes.M: [10, 12, 15, 17, 20]/' -e 's/moes.L: .*/moes.L: [11, 12, 13, 15]/' plan.yml
    sed -i -n '1,3p' cases.csv
    sed -i 's/^PROFILE_CASES.*/PROFILE_CASES = no1-M17-L15-p1.04/' Makefile
}

small_high() {
    copy_scene stationary-line-high
    awk -F, 'NR == 1 || ($1 >= 77 && $1 <= 118 && $2 >= 7 && $2 <= 15)' points.csv >few.csv
    mv few.csv points.csv
    sed -i -n '1,2p' cases.csv
    sed -i -e 's/^PROFILE_CASES.*/PROFILE_CASES = no1-M100-L10-p1.69/' Makefile
}

# The programs as make calls them.
programs='(snapgen|podbuild|deimselect|fullrun|romrun) '

setup() { unset MAKEFLAGS MAKELEVEL MFLAGS V; }

run_make() { run make BIN="$BIN" "$@"; }

# makes PATTERN: what make would run matches; makes_nothing: it would run no program.
makes() {
    run_make -n models demo
    [[ $status == 0 && $output =~ $1 ]] || { echo "expected $1 in: $output"; return 1; }
}
makes_nothing() {
    run_make -n models demo figures "$@"
    [[ $status == 0 && ! $output =~ bin/$programs && ! $output =~ figure3.sh ]] || { echo "expected no program in: $output"; return 1; }
}

@test "the lower loaded region: demo and figures, and then nothing is left to do" {
    small_low
    run_make demo
    [ "$status" -eq 0 ]
    [[ $output == *"301 nodes"*"no1"*"published"*"worst deviation: "* ]]
    [[ ! $output =~ nan|"no result"|"not converged" ]]
    awk -v deviation="$(sed -n 's/^worst deviation: \([0-9.]*\) .*/\1/p' <<<"$output")" \
        'BEGIN { exit !(deviation > 0 && deviation < 20) }'
    [ "$(head -c 4 out/profiles.png | tail -c 3)" = PNG ]
    grep -q '</svg>' out/profiles.svg

    run_make figures
    [ "$status" -eq 0 ]
    for table in 'Table 2' 'Table 3' 'Table 4' model-paper published; do grep -q "$table" out/tables.txt; done
    [ "$(grep -c '^no1 ' out/tables.txt)" -eq 6 ]
    [ "$(head -c 4 out/figure3.png | tail -c 3)" = PNG ]
    [ "$(grep -c '^\(coupled\|independent\) ' out/figure3.dat)" -eq 4 ]
    makes_nothing
}

@test "the higher loaded region: demo, with its points from a file" {
    small_high
    run_make demo
    [ "$status" -eq 0 ]
    [[ $output == *"301 nodes"*"worst deviation: "*" permille"* ]]
    [[ ! $output =~ nan|"no result" ]]
    [ -s out/profiles.png ]
}

@test "only what a change touches is made again" {
    small_low
    run_make models demo figures FIGURE3_CASE=
    [ "$status" -eq 0 ]
    makes_nothing FIGURE3_CASE=

    touch plan.yml
    makes "snapgen plan.yml -o out/snapshots.h5"
    touch -d '1 hour ago' plan.yml

    touch out/basis.h5
    makes "deimselect out/residuals.h5"
    [[ ! $output =~ "bin/fullrun" && ! $output =~ "out/snapshots.h5 --force" && ! $output =~ "bin/podbuild" ]]
    run_make models demo

    touch -d '1 hour' scene.yml
    makes "fullrun scene.yml"
    touch -d '1 hour ago' scene.yml

    run_make -n models demo model.ROWS=38
    [[ $output =~ "deimselect out/residuals.h5" && $output =~ "--rows 38" && ! $output =~ "bin/podbuild" ]]
    run_make models demo model.ROWS=38 SET='--set lubricant.density.law=incompressible'
    [ "$status" -eq 0 ]
    [[ $output =~ "out/snapshots.h5" ]]
}

@test "a case that is not trained is solved and marked; a missing one stops with a word" {
    small_low
    echo "no1,40,18,,,,,,,," >>cases.csv
    run_make demo
    [ "$status" -eq 0 ]
    [[ $output =~ "outside of training"|"not converged" ]]
    head -n 1 cases.csv >none.csv && mv none.csv cases.csv
    run_make demo
    [ "$status" -eq 2 ]
    [[ $output == *"cases.csv: found no cases"* ]]
}
