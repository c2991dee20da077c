#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests contacts over all shapes, M and L on the grids that they choose. MAP_K, MAP_M and MAP_L select other values.

load common

# solve_map KIND SHAPES: writes how each contact ends into map.txt, and fails if one is not solved. A contact refused
# for lack of memory (71) is no failure.
solve_map() {
    local kind=$1 shapes=$2 k M L code failed=0 ellipse
    for k in $shapes; do
        for M in ${MAP_M:-0.1 0.3 1 3 10 30 100 300}; do
            for L in ${MAP_L:-0 5 25}; do
                ellipse=()
                [ "$kind" != ellipse ] || ellipse=(--set "ellipticity=$k")
                code=0
                SECONDS=0
                fullrun scene.yml --set "contact=$kind" --set "moes.M=$M" --set "moes.L=$L" "${ellipse[@]}" \
                    --set output.fields=false -q >out.txt 2>err.txt || code=$?
                grep -q "too coarse" out.txt && code=coarse
                echo "$kind b/a = $k, M = $M, L = $L: $code, $SECONDS s; $(tail -n 1 err.txt)" >>map.txt
                case $code in 0 | 71) ;; *) failed=$((failed + 1)) ;; esac
            done
        done
    done
    cat map.txt
    [ "$failed" = 0 ]
}

setup() {
    cd "$BATS_TEST_TMPDIR" || return
    base_scene
    { cat base.yml && echo 'moes: {M: 18, L: 4}'; } >scene.yml
}

@test "lines are solved on the grids that they choose" {
    MAP_M=${MAP_M:-0.1 0.3 1 3 10 30 100 300 1000 2000} solve_map line 0
}

@test "points are solved on the grids that they choose" {
    MAP_M=${MAP_M:-0.1 0.3 1 3 10 30 100 300 2000} solve_map point 1
}

@test "wide ellipses are solved on the grids that they choose" {
    MAP_M=${MAP_M:-0.1 0.3 1 3 10 30 100 300 2000} solve_map ellipse "${MAP_K:-2 5 8 10 20}"
}

@test "ellipses with b/a = 0.5 are solved on the grids that they choose" {
    solve_map ellipse "${MAP_K:-0.5}"
}

# from M = 30 on ellipses with b/a = 0.05 have millions of unknown nodes, those with b/a = 0.1 from M = 100 on
@test "narrow ellipses are solved on the grids that they choose" {
    MAP_M=${MAP_M:-0.1 0.3 1 3 10} solve_map ellipse "${MAP_K:-0.05 0.1 0.2}"
}

# with L = 25 an ellipse of b/a = 0.1 takes more than ten minutes
@test "ellipses with b/a = 0.1 and 0.2 are solved on the grids that they choose at M = 30" {
    MAP_M=${MAP_M:-30} MAP_L=${MAP_L:-0 5} solve_map ellipse "${MAP_K:-0.1 0.2}"
}
