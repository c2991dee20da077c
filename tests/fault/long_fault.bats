#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Faults at all calls of the small runs. A program does tens of thousands of allocations, nearly all of
# them the same: EVERY=1 fails each, in hours.

load sweeps

@test "every call of a file fails" {
    for name in fullrun romrun podbuild deimselect residuals snapgen; do
        for kind in open read write sync close rename; do
            sweep $name $kind fail
        done
        sweep $name write last
        sweep $name write short
    done
    for name in moving reduced adaptive; do
        for kind in open read write sync close rename; do
            sweep $name $kind fail -e 3
        done
        sweep $name write last -e 3
    done
}

@test "allocations fail" {
    for name in fullrun romrun podbuild deimselect residuals snapgen moving; do
        sweep $name memory fail -e "${EVERY:-41}"
    done
}
