#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests which packages make installs on a machine that lacks two, and when it asks before. Stand-ins for sudo, apt-get,
# id and dpkg-query ensure that nothing is installed. Also tests that the version stands in one place.

bats_require_minimum_version 1.5.0

root=$BATS_TEST_DIRNAME/../..

setup() {
    cd "$BATS_TEST_TMPDIR" || return
    mkdir stand-ins
    stand_in sudo 'echo "sudo $*" >>calls'
    stand_in apt-get 'echo "apt-get $*" >>calls'
    stand_in id 'echo ${USER_ID:-1000}'
    # shellcheck disable=SC2016
    stand_in dpkg-query 'shift 3; for p; do case $p in bats | cmake) ;; *) echo "installed/$p" ;; esac; done'
    : >calls
}

stand_in() {
    printf '#!/bin/sh\n%s\n' "$2" | sed "s|>>calls|>>$PWD/calls|" >"stand-ins/$1"
    chmod +x "stand-ins/$1"
}

# make_deps [NAME=VALUE...]: runs make deps with the stand-ins, without the settings of an outer make or of CI.
make_deps() {
    env -u MAKEFLAGS -u MAKELEVEL -u CI "PATH=$PWD/stand-ins:$PATH" "$@" make -C "$root" deps DEPS=yes
}

# answer WORD [NAME=VALUE...]: runs make_deps on a terminal and answers its question with WORD.
answer() {
    local word=$1
    shift
    export -f make_deps
    export root
    printf '%s\n' "$word" | script -qec "make_deps $*" /dev/null
}

installs() {
    [ "$(grep -c 'apt-get' calls)" -eq 2 ]
    grep -q "^$1 .*install .* bats cmake *$" calls
}

@test "on a terminal make lists what is missing and asks once before it calls sudo" {
    export SHELL=/bin/bash
    for word in y Yes ''; do
        : >calls
        run -0 answer "$word"
        [[ $output == *"bats cmake"*"[Y/n]"* ]]
        [ "$(grep -o '\[Y/n\]' <<<"$output" | wc -l)" -eq 1 ]
        installs sudo
    done
    for word in n no q; do
        : >calls
        run ! answer "$word"
        [[ $output == *"nothing was installed"* ]]
        [ ! -s calls ]
    done
}

# bats test_tags=slow
@test "as root, in CI and without a terminal make goes on without a question" {
    export SHELL=/bin/bash
    run -0 answer n USER_ID=0
    [[ $output == *"deps: installing bats cmake"* && $output != *"[Y/n]"* ]]
    installs apt-get
    : >calls
    run -0 answer n CI=true
    [[ $output != *"[Y/n]"* ]]
    installs sudo
    : >calls
    run -0 make_deps </dev/null
    [[ $output == *"deps: installing bats cmake"* && $output != *"[Y/n]"* ]]
    installs sudo
}

@test "the version of the Makefile is that of header, Python package and citation, and make version writes it there" {
    files=(romrun/library/ehdrom.h romrun/python/pyproject.toml CITATION.cff)
    (cd "$root" && cp --parents Makefile "${files[@]}" "$BATS_TEST_TMPDIR")
    env -u MAKEFLAGS -u MAKELEVEL make DEPS=no version
    for file in "${files[@]}"; do cmp "$file" "$root/$file"; done
    env -u MAKEFLAGS -u MAKELEVEL make DEPS=no version VERSION=1.22.3
    grep -qx '#define EHDROM_VERSION_MAJOR 1' "${files[0]}"
    grep -qx '#define EHDROM_VERSION_MINOR 22' "${files[0]}"
    grep -qx '#define EHDROM_VERSION_PATCH 3' "${files[0]}"
    grep -qx '#define EHDROM_VERSION  *"1.22.3"' "${files[0]}"
    grep -qx 'version = "1.22.3"' "${files[1]}"
    grep -qx 'version: 1.22.3' "${files[2]}"
}
