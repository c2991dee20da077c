#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# What an interrupted run left, with one bit of it another (tests/fuzz/flip.c).

bats_require_minimum_version 1.5.0

@test "a bit flipped anywhere in a partial file is refused or changes nothing, and nothing waits for it" {
    run "$BATS_TEST_DIRNAME/../fuzz/with-bases.sh" "$(realpath "$BIN/../fuzz/flip")" "${FLIP_STEP:-12007}"
    echo "$output"
    [ "$status" -eq 0 ]
}
