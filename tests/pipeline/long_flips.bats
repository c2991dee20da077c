#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later

@test "every 101st bit of partial files flipped" {
    FLIP_STEP=101 bats "$BATS_TEST_DIRNAME/flips.bats"
}
