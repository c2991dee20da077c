#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests that the targets of links in READMEs exist, and the READMEs and sections that comments name (tests/links.py).
# The layers and names in ARCHITECTURE.md must exist too.

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
