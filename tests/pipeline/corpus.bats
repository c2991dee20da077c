#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Files of the fuzzers' corpus, a small one for each fault that was found (tests/fuzz/README.md).

bats_require_minimum_version 1.5.0

# bats test_tags=slow
@test "every file of the corpus is refused or accepted as its name says, and does no harm" {
    corpus=$(realpath "$BATS_TEST_DIRNAME/../fuzz/corpus") replay=$(realpath "$BIN/../fuzz/replay")
    export corpus replay
    "$BATS_TEST_DIRNAME/../fuzz/with-bases.sh" bash -c '
        failed=0
        for target in "$corpus"/*; do
            "$replay" "${target##*/}" "$target"/* || failed=1
        done
        exit $failed'
}
