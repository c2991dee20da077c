#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests that no file includes one of a layer above its own (tests/layers.awk).

setup() {
    cd "$BATS_TEST_DIRNAME/../.." || return
    find_upward=(awk -f "$PWD/tests/layers.awk")
}

# Prints all sources of the layers, tracked by git or not.
sources() {
    find common fullrun romrun podbuild deimselect snapgen -name '*.[ch]'
}

@test "no include goes up" {
    run "${find_upward[@]}" $(sources)
    [ -z "$output" ]
    [ "$status" -eq 0 ]
}

@test "an include that goes up is found, with its file and line" {
    cp -r --parents $(sources) "$BATS_TEST_TMPDIR"
    cd "$BATS_TEST_TMPDIR"
    sed -i '2i #include "common/settings/scene.h"' common/physics/contact.h
    run "${find_upward[@]}" $(sources)
    [ "$status" -eq 1 ]
    [ "${#lines[@]}" -eq 1 ]
    [[ ${lines[0]} == 'common/physics/contact.h:2: found "common/settings/scene.h", expected an include of common/physics '* ]]
}

@test "a main is included by nobody, and a folder without a layer is named" {
    mkdir -p "$BATS_TEST_TMPDIR"/{common/physics,common/magic,romrun}
    cd "$BATS_TEST_TMPDIR"
    echo '#include "common/magic/wand.h"' >common/physics/a.c
    echo '#include "romrun/main.h"' >romrun/b.c
    run "${find_upward[@]}" common/physics/a.c romrun/b.c
    [ "$status" -eq 1 ]
    [[ ${lines[0]} == 'common/physics/a.c:1: '*'a folder is missing in tests/layers.awk' ]]
    [[ ${lines[1]} == 'romrun/b.c:1: '* ]]
}

# A GSL function that fails ends the process, unless a handler is set; the handler belongs to the host program.
@test "of GSL only functions that cannot fail are called" {
    run grep -noE 'gsl_[a-z0-9_]+ ?\(' $(sources)
    [ "$status" -eq 0 ]
    for line in "${lines[@]}"; do
        case ${line##*:} in
        'gsl_integration_qk31(' | 'gsl_interp_bsearch(' | 'gsl_poly_solve_quadratic(' | 'gsl_qrng_get(' | 'gsl_sort(') ;;
        *) echo "$line" && false ;;
        esac
    done
}

# In a thread-sanitizer build, a program with functions that are chosen while it is loaded ends before main
# (CONTRIBUTING.md). The shared object of FMUs is no part of a program, and chooses functions in one place.
@test "no function is chosen while a program is loaded" {
    run grep -nE 'target_clones|\<ifunc\>' $(sources | grep -v '^romrun/fmu/processor.c$')
    [ "$status" -eq 1 ]
}
