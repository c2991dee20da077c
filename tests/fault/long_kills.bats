#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests kills and power cuts at all calls of the runs that can be resumed.

load sweeps

@test "a kill at every call, and a torn write" {
    for name in snapgen fine trajectories moving reduced adaptive; do
        for kind in open sync close rename; do
            sweep $name $kind kill
        done
        sweep $name write kill -e 2
        sweep $name write tear -e 2
    done
}

@test "a power cut at every write" {
    for name in snapgen fine trajectories moving reduced adaptive; do
        sweep $name write power -e 2
        sweep $name sync power
    done
}

@test "500 kills of each kind of long run, one after the other" {
    for name in snapgen fine trajectories moving reduced adaptive; do
        sweep $name write tear -n 500
    done
}
