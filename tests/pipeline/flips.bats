#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs tests/fuzz/flip.c: one bit of a file of an interrupted run is flipped.

bats_require_minimum_version 1.5.0

# bats test_tags=slow
@test "a bit flipped anywhere in a partial file is refused or changes nothing, and nothing waits for it" {
    run "$BATS_TEST_DIRNAME/../fuzz/with-bases.sh" "$(realpath "$BIN/../fuzz/flip")" "${FLIP_STEP:-12007}"
    echo "$output"
    [ "$status" -eq 0 ]
}
