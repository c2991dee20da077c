#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Files of strangers: what they may hold is told before it is used.

load common

# A small line model, m.h5, with what it was made of and a result of each kind.
setup_file() {
    cd "$BATS_FILE_TMPDIR" || return
    common_setup_small
    snapgen plan.yml -o s.h5 --quiet
    podbuild s.h5 -o b.h5 --pressure-modes 8
    snapgen plan.yml --basis b.h5 -o r.h5 --quiet
    deimselect r.h5 --basis b.h5 -o m.h5 --quiet
    fullrun scene.yml -o full.h5 --quiet
    sed 's/stationary/transient/' scene.yml >moving.yml
    echo 'transport: upwind' >>moving.yml
    echo 'transient: {end_time: 0.1, load: {law: sine, amplitude: 0.1, period: 1}}' >>moving.yml
    fullrun moving.yml -o moving.h5 --quiet
}

setup() {
    cd "$BATS_TEST_TMPDIR" || return
    cp "$BATS_FILE_TMPDIR"/* .
}

# stranger KIND PATTERN PYTHON: the file KIND.h5, changed by the code, is refused by its reader and by --check
# with one line that matches.
stranger() {
    local kind=$1 pattern=$2
    patch "$kind.h5" "$3"
    refused 65 "$pattern" romrun --check bad.h5
    case $kind in
    s) refuse 65 "$pattern" podbuild bad.h5 -o x.h5 ;;
    b) refuse 65 "$pattern" deimselect r.h5 --basis bad.h5 -o x.h5 ;;
    r) refuse 65 "$pattern" deimselect bad.h5 --basis b.h5 -o x.h5 --no-check ;;
    m) refuse 65 "$pattern" romrun scene.yml --model bad.h5 -o x.h5 ;;
    full) refuse 65 "$pattern" fullrun scene.yml --start bad.h5 -o x.h5 ;;
    moving) refuse 65 "$pattern" romrun moving.yml --model m.h5 --against bad.h5 -o x.h5 ;;
    esac
}

@test "no data of other files are read" {
    local -A dataset=([s]=pressure [b]=weight [r]=weighted_residual [m]=load_jacobian [full]=central_film_thickness
        [moving]=central_film_thickness)
    for kind in s b r m full moving; do
        name=${dataset[$kind]}
        stranger $kind "$name: found an external link, expected a dataset of the file itself" \
            "del f['$name']; f['$name'] = h5py.ExternalLink('$kind.h5', '/$name')"
    done
    for kind in s m; do
        name=${dataset[$kind]}
        stranger $kind "$name: found a soft link" "f.move('$name', 'a'); f['$name'] = h5py.SoftLink('/a')"
        stranger $kind "$name: found data in another file" "
    d = f['$name'][...]; del f['$name']
    open('raw', 'wb').write(d.tobytes())
    f.create_dataset('$name', d.shape, d.dtype, external=[('raw', 0, h5py.h5f.UNLIMITED)])"
        stranger $kind "$name: found a virtual dataset" "
    d = f['$name'][...]; del f['$name']
    v = h5py.VirtualLayout(d.shape, d.dtype)
    v[...] = h5py.VirtualSource('$kind.h5', '$name', d.shape)
    f.create_virtual_dataset('$name', v)"
        stranger $kind "$name: found a filter beside gzip, shuffle and Fletcher-32" "
    d = f['$name'][...]; del f['$name']
    f.create_dataset('$name', data=d, chunks=d.shape, compression='lzf')"
    done
    # an axis, too
    stranger m "x: found an external link" "del f['x']; f['x'] = h5py.ExternalLink('m.h5', '/x')"
    # and what is linked inside of the file, or compressed by what HDF5 has, is read
    patch m.h5 "
    d = f['load_jacobian'][...]; del f['load_jacobian']
    f.create_dataset('own/a', data=d, chunks=d.shape, compression='gzip', shuffle=True, fletcher32=True)
    f['load_jacobian'] = f['own/a']"
    romrun --check bad.h5
    romrun scene.yml --model bad.h5 --allow-untrusted
}

@test "no data of other files are read as a history or as rows" {
    /usr/bin/python3 -c "
import h5py, numpy
with h5py.File('own.h5', 'w') as f: f['time'], f['g/F'] = numpy.array([0, 0.5, 1]), numpy.array([1, 1.1, 1])
with h5py.File('other.h5', 'w') as f: f['time'], f['g'] = numpy.array([0, 0.5, 1]), h5py.ExternalLink('own.h5', '/g')"
    sed -i '/^transient/d' moving.yml
    echo 'transient: {end_time: 0.1, load: {law: table, file: T.h5, column: g/F}}' >>moving.yml
    cp own.h5 T.h5
    fullrun moving.yml --quiet
    cp other.h5 T.h5
    refuse 65 "g/F: found an external link, expected a dataset of the file itself" fullrun moving.yml -o x.h5
    patch m.h5 "del f['selected_row']; f['selected_row'] = h5py.SoftLink('/x')"
    refuse 65 "selected_row: found a soft link" deimselect r.h5 --basis b.h5 --rows-from bad.h5 -o x.h5
}
