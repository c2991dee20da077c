#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests that the library's memory does not grow with the number of steps, nor that of romrun --cases with the rows.

load common

@test "a million steps of a contact leave the resident memory as it is" {
    cd "$BATS_TEST_TMPDIR"
    small_point_model
    "$BIN/../unit/use_library" memory p.h5 point.yml 0.05 1000000 >told
    cat told
    # allows some pages; if each step kept the smallest block of malloc, this would be 32 MB
    awk '$1 == "first_kB" { first = $2 } $1 == "last_kB" { last = $2 }
         END { exit !(first > 5000 && last > 5000 && last - first < 256) }' told
}

@test "--cases: memory does not grow with 400000 rows" {
    MANY_ROWS=400000 bats "$BATS_TEST_DIRNAME/cases.bats" -f "memory does not grow"
}
