#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# A sample of the sweeps of long_fault.bats: failing calls of files, and programs that end at such a call.

load sweeps

@test "a few kills, power cuts, failing calls and refused allocations" {
    sweep snapgen write kill -e 90
    sweep moving write tear -e 160
    sweep moving write power -e 160
    sweep reduced write kill -n 1
    sweep cases write last -e 2
    sweep fullrun write fail -e 19
    sweep deimselect read fail -e 97
    sweep podbuild sync fail
    sweep export rename fail
    sweep romrun memory fail -e 3701
    sweep checked memory fail -e 29987
}

# bats test_tags=slow
@test "a kill or a torn write anywhere loses nothing that was finished" {
    sweep snapgen write kill -e 25
    sweep fine write tear -e 25
    sweep adaptive write tear -e 60
    sweep trajectories write tear -e 97
    sweep moving write tear -e 40
    sweep moving rename kill
    sweep snapgen sync kill
    sweep reduced write kill -n 5
    sweep cases write tear
    sweep export write tear
    sweep fmu write kill -e 99
}

# After a power cut only synced pages are certain; other pages may have any earlier state.
# bats test_tags=slow
@test "a power cut loses nothing that was finished" {
    sweep snapgen write power -e 25
    sweep adaptive write power -e 97
    sweep trajectories write power -e 131
    sweep moving write power -e 53
    sweep reduced sync power
}

# bats test_tags=slow
@test "a disk that is full, or fails, is said in one line" {
    sweep fullrun write fail -e 9
    sweep snapgen write last -e 29
    sweep adaptive write last -e 45 # HDF5 itself prints nothing
    sweep snapgen read fail -e 29
    sweep moving write short -e 97
    sweep deimselect read fail -e 29
    sweep podbuild sync fail
    sweep checked write fail -e 29
    sweep calibrate read fail -e 59
    sweep trajectories write fail -e 199
    sweep fullrun rename fail
    sweep romrun close fail -e 5
    sweep residuals open fail -e 5
    sweep cases write last
    sweep cases-h5 read fail -e 59
    sweep vtk write fail
    sweep flat open fail
    sweep export read fail -e 9 # including reads that an export can do without
    sweep export sync fail
    sweep fmu rename fail
}

@test "a mapped file that is cut, or cannot be read, ends with a line" {
    sweep flat map fail
    sweep flat map short
}

# bats test_tags=slow
@test "memory that is refused is 71 and a line" {
    sweep fullrun memory fail -e 211
    sweep podbuild memory fail -e 401
    sweep romrun memory fail -e 701
    sweep checked memory fail -e 5987
    sweep calibrate memory fail -e 5003
    sweep trajectories memory fail -e 9001
    sweep adaptive memory fail -e 9001
    sweep export memory fail -e 395 # a refused look-up must not make it omit an optional field
    sweep vtk memory fail -e 397
    sweep cases memory fail -e 997
}

@test "a limit of memory is said before OpenBLAS waits for ever" {
    local code
    # with one thread of OpenBLAS, and with several threads, which are its default
    for threads in 1 8; do
        for megabytes in 100 200; do
            code=0
            (ulimit -v $((1000 * megabytes)) && OPENBLAS_NUM_THREADS=$threads timeout -s KILL 60 fullrun scene.yml) \
                2>log >/dev/null || code=$?
            [ $code = 71 ]
            grep -qx "fullrun: OpenBLAS: found too little memory, expected .* MB" log
        done
    done
}

@test "under a limit of memory there are as many threads as have enough" {
    snapgen -q -j1 fine.yml -o whole.h5
    # the memory of one thread depends on the libraries
    local least=100
    until (ulimit -v $((1000 * least)) && snapgen -q -j1 fine.yml -o x.h5 --force) 2>/dev/null; do
        ((least += 50))
        [ $least -lt 1000 ]
    done
    for megabytes in $least $((least + 300)); do
        (ulimit -v $((1000 * megabytes)) && snapgen -q -j8 fine.yml -o x.h5 --force)
        same_data whole.h5 x.h5
    done
}

@test "a pipe in the place of a file is refused" {
    mkfifo pipe
    ln -s pipe link.h5
    ln pipe pipe.csv
    sed 's/transient: .*/transient: {load: {law: table, file: pipe.csv, column: F}, end_time: 0.3}/' moving.yml >csv.yml
    sed 's/pipe.csv/link.h5/' csv.yml >h5.yml
    printf 'groups:\n  - {scene: base.yml, points: pipe.csv}\n' >points.yml
    for command in "fullrun csv.yml" "fullrun h5.yml" "snapgen points.yml -o x.h5" "fullrun scene.yml --start link.h5" \
        "fullrun scene.yml --grid-of link.h5" "romrun scene.yml --model m.h5 --against link.h5" \
        "deimselect r.h5 --basis b.h5 --rows-from link.h5 -o x.h5" "fullrun pipe" "romrun scene.yml --model link.h5" "podbuild link.h5 -o x.h5" \
        "snapgen pipe -o x.h5" "deimselect link.h5 --basis b.h5 -o x.h5"; do
        run timeout -s KILL 20 $command
        [ "$status" = 66 ]
        [[ $output == *"found no regular file"* ]]
    done
    # a pipe under the provisional name is not written to either
    ln -f pipe x.h5.partial
    run timeout -s KILL 20 fullrun scene.yml -o x.h5
    [ "$status" = 73 ]
    [[ $output == *"found no regular file"* ]]
}
