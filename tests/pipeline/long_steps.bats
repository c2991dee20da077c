#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later

@test "steps of any lengths, and a thousand bounces of a mass, along the path and upwind" {
    ANY_STEPS=10000 BOUNCES=1000 "$BIN/../unit/test_online_transient"
}
