#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests with all core types of OpenBLAS that this processor can run.

load common

setup() {
    cd "$BATS_TEST_TMPDIR" || return
    [ "$(uname -m)" = x86_64 ] || skip "core types of x86-64"
    unset OPENBLAS_CORETYPE
    list_cores
}

# list_cores: sets cores=(...), the core types by the names that programs print
list_cores() {
    cores=(Prescott Core2 Nehalem)
    if has avx; then cores+=(Sandybridge); fi
    if has avx2; then cores+=(Haswell Zen); fi
    if has avx512vl; then cores+=(SkylakeX); fi
    if has avx512_bf16; then cores+=(Cooperlake); fi
}

has() {
    grep -qw "$1" /proc/cpuinfo
}

@test "OpenBLAS works as the user's core type, else as one that has what the processor has" {
    for core in "${cores[@]}"; do
        OPENBLAS_CORETYPE=$core romrun --version | grep -o " $core "
    done
    if has avx2; then romrun --version | grep -o ' Haswell '; fi
}


# film FOLDER: prints the $film film thickness of a folder
film() {
    awk -v name="$film" '$1 == name && $2 == "film" { print $4 }' "$1/own.txt"
}

# bats test_tags=slow
@test "a model gives the same bits with every core type, and models of every core type agree" {
    common_setup_small
    for core in "${cores[@]}"; do
        export OPENBLAS_CORETYPE=$core
        mkdir "$core"
        snapgen plan.yml -q -o "$core/s.h5"
        podbuild "$core/s.h5" -q -o "$core/b.h5"
        snapgen plan.yml -q --basis "$core/b.h5" -o "$core/r.h5"
        deimselect --no-check "$core/r.h5" -q --basis "$core/b.h5" -o "$core/m.h5"
        romrun scene.yml --model "$core/m.h5" -o "$core/own.h5" --allow-untrusted >"$core/own.txt"
        romrun scene.yml -q --model "${cores[0]}/m.h5" -o "$core/first.h5" --allow-untrusted
        same_data "${cores[0]}/first.h5" "$core/first.h5"
        # the models differ by the round-off of the training only
        for film in central minimum; do
            close_to "$(film "$core")" "$(film "${cores[0]}")" 1e-6
        done
    done
}

# bats test_tags=slow
@test "a program on a processor that it was not built for says what that lacks" {
    command -v qemu-x86_64 || skip "found no qemu-x86_64"
    is_installed || skip "a sanitizer does not run there"
    fullrun --version | grep -q 'march=x86-64-v3' || skip "built for another processor"
    for program in fullrun snapgen podbuild deimselect romrun; do
        for processor in core2duo Nehalem SandyBridge; do
            run -70 --separate-stderr qemu-x86_64 -cpu $processor "$BIN/$program" --version
            stderr=$(grep -v '^qemu-x86_64: warning' <<<"$stderr")
            [ "$stderr" = "$program: processor: found one without AVX2, expected one with it (make MARCH=x86-64 builds for any)" ]
            [ -z "$output" ]
        done
    done
}
