#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later

@test "files with axes of every other length" {
    EVERY_LENGTH=yes bats "$BATS_TEST_DIRNAME/axes.bats"
}
