#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests faults at all calls of the small runs. A program makes tens of thousands of allocations, and nearly all of them
# are alike, so only a sample of the allocations fails. With EVERY=1 each allocation fails, which takes hours.

load sweeps

@test "every call of a file fails" {
    for name in fullrun romrun podbuild deimselect checked calibrate residuals snapgen flat cases cases-h5 vtk export; do
        for kind in open read write sync close rename; do
            sweep $name $kind fail
        done
        sweep $name write last
        sweep $name write short
    done
}

@test "every third call of a file fails, of runs that can be resumed" {
    for name in trajectories moving reduced adaptive; do
        for kind in open read write sync close rename; do
            sweep $name $kind fail -e 3
        done
        sweep $name write last -e 3
    done
}

@test "every call of a file fails, of an FMU and of what is mapped" {
    # a run takes a second, mostly to pack the FMU, and its writes are alike
    for kind in open sync close rename map; do
        sweep fmu $kind fail
    done
    sweep fmu write fail -e 7
    sweep fmu read fail -e 197
    sweep flat map fail
    sweep flat map short
}

@test "what is no HDF5 file is whole or not there" {
    for name in cases vtk export fmu; do
        for kind in open close sync rename; do
            sweep $name $kind kill
        done
    done
    for name in cases vtk export; do
        sweep $name write kill
        sweep $name write tear
    done
    sweep fmu write kill -e 7
    sweep fmu write tear -e 7
}

@test "allocations fail" {
    for name in fullrun romrun podbuild deimselect residuals snapgen moving flat cases cases-h5 vtk export; do
        sweep $name memory fail -e "${EVERY:-41}"
    done
    # each of these runs makes 30,000 to 70,000 allocations
    for name in checked calibrate trajectories reduced adaptive; do
        sweep $name memory fail -e "${EVERY:-199}"
    done
    sweep fmu memory fail -e 2999
}
