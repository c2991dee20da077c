#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Fuzzes each target for a minute, where clang and its libFuzzer are installed (make fuzz installs them).

@test "a minute of fuzzing of each target finds nothing" {
    command -v clang >/dev/null || skip "found no clang"
    cd "$BATS_TEST_DIRNAME/../.."
    run make -s fuzz VARIANT=release DEPS=no FUZZ_SECONDS="${FUZZ_SECONDS:-60}"
    echo "$output"
    [ "$status" -eq 0 ]
}
