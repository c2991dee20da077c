#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests of --plot: pictures of each kind of file, and what is refused.

load common

setup_file() {
    cd "$BATS_FILE_TMPDIR" || return
    small_point_model
    fullrun point.yml -o point.h5 --quiet
    small_model
    fullrun scene.yml -o line.h5 --quiet
    moving_scene "x_min: -4, x_max: 2, step: 0.05" "end_time: 0.3, fixed_step: 0.05"
    fullrun moving.yml -o moving.h5 --quiet --set output.fields=true
    printf 'moes.M,moes.L\n9,3\n12,4\n' >cases.csv
}

setup() {
    cd "$BATS_TEST_TMPDIR" || return
    cp "$BATS_FILE_TMPDIR"/*.{h5,csv,yml} .
    # the folder of matplotlib's caches
    export MPLCONFIGDIR=$BATS_FILE_TMPDIR/matplotlib
}

# is_picture FILE: checks the first bytes of a PNG, SVG or PDF file.
is_picture() {
    case $1 in
    *.png) [ "$(head -c 4 "$1" | tail -c 3)" = PNG ] ;;
    *.svg) grep -q '</svg>' "$1" ;;
    *.pdf) [ "$(head -c 4 "$1")" = %PDF ] ;;
    esac
}

@test "each kind of file becomes a picture" {
    local file
    for file in line point moving s b m c p; do
        fullrun --plot $file.h5 -o $file.png
        is_picture $file.png
    done
    romrun --plot line.h5 -o line.svg
    is_picture line.svg
    grep -q 'spike' line.svg
    podbuild --plot b.h5 -o b.pdf
    is_picture b.pdf
    [ ! -e line.png.partial ]
}

@test "two columns of a table become a picture" {
    romrun cases base.yml cases.csv -m m.h5 -o table.csv --quiet --allow-untrusted
    romrun cases base.yml cases.csv -m m.h5 -o table.h5 --quiet --allow-untrusted
    romrun --plot table.csv moes.M central_film_thickness -o csv.png
    romrun --plot table.h5 moes_M central_film_thickness -o h5.png
    is_picture csv.png
    is_picture h5.png
    refused 65 "table.csv: found no column none, expected one of moes.M, moes.L" romrun --plot table.csv none moes.M -o x.png
    refused 65 "table.h5: found a table of cases, expected also the names of two of its columns" romrun --plot table.h5 -o x.png
    [ ! -e x.png ]
}

@test "what cannot be drawn is refused, and an existing picture stays" {
    echo old >old.png
    refused 73 "old.png: found an existing file" fullrun --plot line.h5 -o old.png
    [ "$(cat old.png)" = old ]
    fullrun --plot line.h5 -o old.png --force
    is_picture old.png
    refused 64 "x.bmp: found another ending, expected .png, .svg or .pdf" fullrun --plot line.h5 -o x.bmp
    refused 64 "--output: found nothing, expected -o FILE" fullrun --plot line.h5
    refused 64 "--vtk: found --plot too" fullrun --plot line.h5 --vtk line.h5 -o x.png
    refused 66 "none.h5: found nothing" fullrun --plot none.h5 -o x.png
    refused 65 "scene.yml: found no HDF5 file" fullrun --plot scene.yml -o x.png
    fullrun scene.yml -o bare.h5 --quiet --set output.fields=false
    refused 65 "bare.h5: found no fields, expected a result with output.fields = true" fullrun --plot bare.h5 -o x.png
    # another Python without the packages, and none at all
    mkdir bin && printf '#!/bin/sh\necho "found no Python package x, expected it" >&2\nexit 69\n' >bin/python3 && chmod +x bin/python3
    PATH=$PWD/bin:$PATH fullrun --plot line.h5 -o other.png
    is_picture other.png
    [ ! -e x.png ] && [ ! -e x.png.partial ]
}
