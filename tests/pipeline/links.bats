#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests that the targets of links in READMEs exist, and the READMEs and sections that comments name (tests/links.py).
# The layers and names in ARCHITECTURE.md must exist too, and the reasons of constants (tests/constants.py).

bats_require_minimum_version 1.5.0

setup() {
    cd "$BATS_TEST_DIRNAME/../.." || return
    find_dead=(/usr/bin/python3 "$PWD/tests/links.py")
}

@test "no link and no section that a comment names leads nowhere" {
    run "${find_dead[@]}"
    [ -z "$output" ]
    [ "$status" -eq 0 ]
}

@test "a dead link, anchor, README and section are found, with their lines" {
    mkdir "$BATS_TEST_TMPDIR/room"
    cd "$BATS_TEST_TMPDIR"
    printf '# Rows (eq. 3)\n\n**Where it ends.** See [rows](#rows-eq-3),\n[gone](gone.md), [none](room/README.md#none).\n' >README.md
    printf '# Room\n\n    [code](is/passed/over.md)\n' >room/README.md
    printf '/* As in README.md, Room.\n */\n/* README.md, Where\n * it ends, which is the other\n * (README.md) */\n' >room/a.c
    printf '// lost/README.md\n' >room/b.h
    run "${find_dead[@]}"
    [ "$status" -eq 1 ]
    [ "${#lines[@]}" -eq 4 ]
    [ "${lines[0]}" = 'README.md:4: found gone.md, expected a file or folder' ]
    [ "${lines[1]}" = 'README.md:4: found room/README.md#none, expected a heading of that name' ]
    [ "${lines[2]}" = 'room/a.c:3: found README.md, Where it ends, which is the other, expected a section of that name' ]
    [ "${lines[3]}" = 'room/b.h:1: found lost/README.md, expected a file' ]
}

@test "ARCHITECTURE.md has the layers in their order" {
    listed=$(sed -nE 's/^\| `?\[?(common|fullrun|romrun|podbuild|deimselect|snapgen)([a-z/]*).*/\1\2/p' ARCHITECTURE.md)
    checked=$(sed '/names)/q' tests/layers.awk | grep -o '"[a-z/ ]*"' | tr -d '"' | xargs -n1)
    [ "$(wc -l <<<"$listed")" -gt 15 ]
    [ "$listed" = "$checked" ]
}

@test "functions and types that ARCHITECTURE.md and CONTRIBUTING.md name are in the code" {
    names=$(grep -ohE '`[a-z]+(_[a-z]+)+`' ARCHITECTURE.md CONTRIBUTING.md | tr -d '`' |
        sort -u | grep -vx target_clones) # CONTRIBUTING.md excludes it
    [ "$(wc -w <<<"$names")" -gt 40 ]
    cat common/*/*.[ch] {fullrun,podbuild,deimselect,snapgen}/*.[ch] romrun/*/*.[ch] romrun/*.c >"$BATS_TEST_TMPDIR/code"
    for name in $names; do
        grep -qw "$name" "$BATS_TEST_TMPDIR/code" || { echo "found $name, expected it in the code" && false; }
    done
}

@test "docs/constants.md is what make constants prints, and each constant has a reason that exists" {
    /usr/bin/python3 tests/constants.py >"$BATS_TEST_TMPDIR/constants.md"
    diff docs/constants.md "$BATS_TEST_TMPDIR/constants.md" # make constants >docs/constants.md
}

@test "a constant without a reason, and reasons that do not exist, are found" {
    mkdir -p "$BATS_TEST_TMPDIR"/{fullrun,tests/{unit,pipeline}}
    cp tests/constants.py "$BATS_TEST_TMPDIR"
    cd "$BATS_TEST_TMPDIR"
    echo 'static void a_case(void **state) {' >tests/unit/test_gap.c
    echo '@test "a pipeline, from end to end" {' >tests/pipeline/gap.bats
    cat >fullrun/gap.c <<'C'
/* Number of terms. */
enum { TERMS = 4 };

/* Largest gap, m (test_gap.c, a_case). */
static const double LARGEST = 1e-3,
                    SMALLEST = 1e-9; // (gap.bats, "a pipeline")

// Source: a norm
static const double OF_A_NORM = 9.81;

/* Threshold (test_gap.c, no_case). */
static const double THRESHOLD = 1 / 3.;

/* Lengths (gap.bats, "a pipe, cut"). */
enum { LENGTH = 7 };

static double gap(double x) {
    const double none = 0, some = 1e-6, more = 2 * x;
    return x > 0.5 ? none + some : more;
}
C
    run --separate-stderr /usr/bin/python3 constants.py .
    [ "$status" -eq 1 ]
    [ "${#stderr_lines[@]}" -eq 3 ]
    [ "${stderr_lines[0]}" = 'fullrun/gap.c: THRESHOLD: found test_gap.c, no_case, expected a reason that exists' ]
    [ "${stderr_lines[1]}" = 'fullrun/gap.c: LENGTH: found gap.bats, "a pipe, cut", expected a reason that exists' ]
    [ "${stderr_lines[2]}" = 'fullrun/gap.c: some: found no test, benchmark, study or page, expected a reason that exists' ]
    [ "$(grep -c '^| `' <<<"$output")" -eq 5 ]
    grep -qxF '| `SMALLEST` | 1e-9 | `gap.c` | Largest gap, m (test_gap.c, a_case). (gap.bats, "a pipeline") |' <<<"$output"
    [ "${lines[-1]}" = '5 constants.' ]
}
