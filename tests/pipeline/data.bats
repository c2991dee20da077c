#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests that pipelines take tables, names of files and folders, and settings as data: no such text becomes a command of
# make or of a shell.

load common

# Checks that no data was executed: executed data would leave a file "ran" in a folder of the test.
harmless() {
    local found
    found=$(find "$BATS_TEST_TMPDIR" -name 'ran*')
    [ -z "$found" ] || { echo "found $found, expected that nothing of the data is run"; return 1; }
}

teardown() { harmless; }

# Makes a small pipeline in a folder whose name has a line break and all characters special to a shell and to make.
setup() {
    unset MAKEFLAGS MAKELEVEL MFLAGS V
    strange="$BATS_TEST_TMPDIR/a b;touch ran1;\$(touch ran2)\`touch ran3\` 'q\"\$x#%&=|é"$'\n'"\$(shell touch ran4)"
    mkdir -p "$strange/scenes/own"
    cp -r "$BATS_TEST_DIRNAME/../../scenes/lib" "$strange/scenes"
    cd "$strange/scenes/own" || return
    common_setup_small
    echo 'include ../lib/pipeline.mk' >Makefile
}

# Prints the names of the results in a folder.
numbers_in() { (cd "$1" && printf '%s ' *.h5); }

@test "names of cases and of the folder are data, whatever they are" {
    cat >cases.csv <<'CSV'
# a table
name,moes.M,moes.L,title
a;touch ran,9,3,
$(shell touch ran),9,4,"$(touch ran) $\frac$ `touch ran`"
"$(touch ran) `touch ran` 'x' ""y""",10,3,
--help,10,4,
../x,11,3,
a b,11,4,
Wälzlager-é-轴承,12,3,
same,12,4,
same,13,3,
,13,4,
"x
.SHELLFLAGS := -c 'touch ran'
# y

all: ; touch ran",14,3,"of
lines"
CSV
    run_make PROFILES='same 3' MAP_CASE=
    echo "$output"
    [ "$status" -eq 0 ]
    [ "$(numbers_in out/full)" = "1.h5 10.h5 11.h5 2.h5 3.h5 4.h5 5.h5 6.h5 7.h5 8.h5 9.h5 " ]
    [ "$(numbers_in out/model)" = "$(numbers_in out/full)" ]
    for name in 'a;touch ran' '$(shell touch ran)' --help ../x 'a b' Wälzlager-é-轴承 M13-L4; do
        grep -qF -- "$name " out/comparison.txt
    done
    [ "$(grep -c '^same ' out/comparison.txt)" -eq 2 ]
    # each case has its own settings
    [ "$(fullrun --print out/full/11.h5 settings | grep -c '^moes.M: 14$')" -eq 1 ]
    [ "$(cat out/cases.mk)" = "CASES := 1 2 3 4 5 6 7 8 9 10 11" ]
    run_make list
    [ "${#lines[@]}" -eq 11 ]
    # a second run has nothing left to do
    run_make -n
    [[ $status == 0 && ! $output =~ bin/$programs ]]
    harmless
    run_make PROFILES=none
    [[ $status == 2 && $output == *"found no case 'none', expected one of: "* ]]
}

# bats test_tags=slow
@test "settings of cases are data" {
    # no field is a valid setting: the program refuses each, and names the key
    for field in 'moes.M;touch ran,9' 'moes.M,$(touch ran)' 'moes.M,9;touch ran' "moes.M,'9;touch ran" \
        $'moes.M,"9\n.SHELLFLAGS := -c \'touch ran\'\nx"' 'moes.M,$(shell touch ran)' '--help,9' '$(shell touch ran),9'; do
        printf '%s\n' "${field/,/,moes.L$'\n'},3" >cases.csv
        sed -i '1s/$/\n/;/^$/d' cases.csv
        run_make
        echo "$output"
        [ "$status" -eq 2 ]
        [[ $output =~ (fullrun|romrun|cases.py):\ .*(found|expected) ]]
        [ "$(cat out/cases.mk)" = "CASES := 1" ]
        harmless
    done
    printf 'moes.M,moes.L\n9,3,4\n' >cases.csv
    run_make
    [[ $status == 2 && $output == *"cases.csv: case 1: found 3 fields, expected the 2 of the header"* ]]
    # a table with semicolons, which romrun --cases accepts
    printf 'name;moes.M;moes.L\n"a;b";9;3\n' >cases.csv
    run_make
    [ "$status" -eq 0 ]
    printf 'moes.M,moes.L\n"9,3\n' >cases.csv
    run_make
    [[ $status == 2 && $output == *"cases.csv: found 'unexpected end of data', expected a table of cases"* ]]
}

@test "files of a plan and of its folder have any names" {
    mv base.yml 'b $(shell touch ran);touch ran "it'\''s".yml'
    cp plan.yml 'p $(shell touch ran);touch ran "it'\''s".yml'
    sed -i 's/scene: .*/scene: "b $(shell touch ran);touch ran \\"it'\''s\\".yml"/' plan.yml
    touch '$(shell touch ran).csv' 'a;touch ran.csv' '`touch ran`.csv' $'a\nb.csv'
    run_make models
    echo "$output"
    [ "$status" -eq 0 ]
    run_make -q out/model.h5
    [ "$status" -eq 0 ]
    for file in b*.yml '$(shell touch ran).csv' $'a\nb.csv'; do
        touch -d "1 minute" "$file"
        run_make -q out/model.h5
        [ "$status" -eq 1 ]
        touch -d "1 minute ago" "$file"
    done
    run_make -q out/model.h5
    [ "$status" -eq 0 ]
    # the plan has a name with special characters too
    sed 's/\[8, 11, 15\]/[8, 9.5, 11, 13, 15]/' plan.yml >'p $(shell touch ran);touch ran "it'\''s".yml'
    run_make models OUT=other PLAN='p $(shell touch ran);touch ran "it'\''s".yml' model.WEIGHT=row-norm
    echo "$output"
    [ "$status" -eq 0 ]
    [ -e other/model.h5 ]
    # the folder of a user's own program has headers with such names
    touch '$(shell touch ran).h' 'a;touch ran.h'
    printf '%s\n' 'include ../lib/common.mk' 'LIBRARY_PROGRAMS = x' 'include ../lib/programs.mk' >own.mk
    run_make -n -f own.mk out/x
    harmless
}

@test "settings, options and names on the command line are words, not text of a shell" {
    # quotes hold a word together, and no other character is special
    run_make -n models SET="--set 'surface.file=a b;touch ran' --set x=\$(shell touch ran)\`touch ran\` \"--set\" y=*"
    [ "$status" -eq 0 ]
    [[ $output == *"'--set' 'surface.file=a b;touch ran' '--set' 'x=\$(shell' 'touch' 'ran)\`touch' 'ran\`' '--set' 'y=*'"* ]]
    run_make models SET='--set lubricant.viscosity.law=$(touch ran);touch ran'
    [[ $status == 2 && $output == *"snapgen: "* ]]
    SET='--set a=$(shell touch ran)' run_make -n models
    [[ $output == *"'a=\$(shell'"* ]]
    run_make models SET="--set 'a=b"
    [[ $status == 2 && ${#lines[@]} == 1 && $output == *"found '--set 'a=b', expected words whose quotes end"* ]]
    run_make models SNAPGEN_OPTIONS='--most 3;touch ran'
    [ "$status" -eq 2 ]
    # settings that cannot work are refused before any work
    for given in OUT='a b' OUT='a;touch ran' OUT='$(shell touch ran)' OUT=a%b OUT=-x "OUT=it's" MODELS='a b%'; do
        run_make models "$given"
        echo "$output"
        [[ $status == 2 && ${#lines[@]} == 1 && $output == *"OUT, MODELS: found '"*", expected names without blanks and any of "* ]] ||
            [[ $status == 2 && ${#lines[@]} == 1 && $output == *"MODELS: found '"* ]]
    done
    for given in ACCURACY='1e-3;touch ran' model.ROWS='`touch ran`' PART='$(shell touch ran)'; do
        run_make models "$given"
        [[ $status == 2 && ${#lines[@]} == 1 && $output == *"${given%%=*}: found '"*"', expected none of "* ]]
    done
    for given in PLAN SET BIN; do
        run_make models "$given=a"$'\n'"b"
        [[ $status == 2 && ${#lines[@]} == 1 && $output == *"$given: found a line break, expected none"* ]]
    done
    run_make models PLAN='none;touch ran.yml'
    [[ $status == 2 && $output == *"PLAN: found no none;touch ran.yml, expected a plan"* ]]
    run make models BIN='/no/$(touch ran);x'
    [[ $status == 2 && $output == *"found none, expected a program"* ]]
    [ ! -e out/model.h5 ]
}

@test "programs are found in a folder of any name, by BIN and on the PATH" {
    ln -s "$BIN" "$strange/p;touch ran"
    run make -n models BIN="$BATS_TEST_TMPDIR/${strange##*/}/p;touch ran"
    [[ $status == 2 && $output == *"BIN: found a line break"* ]]
    run make models BIN='../../p;touch ran'
    echo "$output"
    [ "$status" -eq 0 ]
    rm -r out
    PATH="$PWD/../../p;touch ran:$PATH" run make models
    [ "$status" -eq 0 ]
    # the shared rules may lie elsewhere, in a path without blanks
    cp -r ../lib '../$(touch${IFS}ran);x'
    run_make -f '../$(touch${IFS}ran);x/pipeline.mk' models OUT=other
    echo "$output"
    [ "$status" -eq 0 ]
    cp -r ../lib '../a b'
    run_make -f '../a b/pipeline.mk' models OUT=more
    [[ $status == 2 && ${#lines[@]} == 1 && $output == *"found blanks in its path, expected none"* ]]
}

# bats test_tags=slow
@test "trajectories: periods are data, and the clone's folder has any name" {
    cp "$BATS_TEST_DIRNAME/../../scenes/studies/transient-load/scene.yml" .
    printf '%s\n' 'MODELS = model' 'include ../lib/trajectories.mk' >Makefile
    for period in '0.5;touch ran' '$(shell touch ran)' $'"0.5\nall: ; touch ran"'; do
        printf '%s\n' transient.load.period,transient.end_time,transient.fixed_step "$period,0.2,0.005" >cases.csv
        run_make tables
        [[ $status == 2 && $output == *"cases.csv: found transient.load.period = '"*"', expected a number"* ]]
    done
    # other settings reach the program unchanged
    printf '%s\n' transient.load.period,transient.end_time,transient.fixed_step,grid.step '0.5,0.2,0.005,$(touch ran);touch ran' >cases.csv
    run_make out/full/fixed-1.h5
    echo "$output"
    [[ $status == 2 && $output == *"grid.step: found"* ]]
    harmless
    # the top Makefile runs a demo in such a folder, here without sources to build
    cp "$BATS_TEST_DIRNAME/../../Makefile" "$strange"
    mkdir -p "$strange/build/$VARIANT" "$strange/scenes/studies/stationary-line"
    ln -s "$BIN" "$strange/build/$VARIANT/bin"
    printf 'include ../../lib/common.mk\ndemo: $(BIN)/fullrun\n\t@$< --version\n' >"$strange/scenes/studies/stationary-line/Makefile"
    cd "$strange" || return
    run make demo DEPS=no
    echo "$output"
    [[ $status == 0 && $output == "fullrun "* ]]
}
