#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests of files by foreign writers: their contents are checked before they are used.

load common

# Makes a small line model, m.h5, its inputs, and a result of each kind.
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

# stranger KIND PATTERN PYTHON: checks that the file KIND.h5, changed by the code, is refused by its reader and by
# --check with one line that matches PATTERN.
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

# bats test_tags=slow
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
    # the check includes axes
    stranger m "x: found an external link" "del f['x']; f['x'] = h5py.ExternalLink('m.h5', '/x')"
    # a link inside the file is followed, and the compressions that HDF5 itself has are read
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

# bats test_tags=slow
@test "sizes that a file cannot have are refused before they are taken" {
    # these axes have no data; the product with the size of a number overflows, or is more than the file can hold
    local huge="
    def grow(axis, length, **how):
        on = {n: [d[0].name[1:] if len(d) else n for d in f[n].dims] for n in f}
        for n, axes in on.items():
            if axis not in axes: continue
            shape = [length if a == axis else l for a, l in zip(axes, f[n].shape)]
            t = f[n].dtype; del f[n]; f.create_dataset(n, shape, t, **how)
        # deletes the lists of references to deleted datasets, because new datasets may lie at their addresses now
        for n in f:
            if 'REFERENCE_LIST' in f[n].attrs: del f[n].attrs['REFERENCE_LIST']
    "
    for axis in row needed_node pressure_mode state band_node position x; do
        stranger m "$axis.*: found length 2305843009213693952 along $axis, expected at most [0-9]*$" "$huge
    grow('$axis', 2**61, chunks=True)"
    done
    # lengths without written data, and holes of the file system
    stranger m "found numbers that take .* MB in a file with .* MB of data, expected at most 1032 times as much" "$huge
    grow('needed_node', 9 * 10**6)"
    stranger s "state: found length .* expected at most 10000000" "$huge
    grow('state', 2**61, chunks=True)"
    stranger moving "time: found length .* expected at most 100000000" "$huge
    grow('time', 2**61, chunks=True)"
    stranger m "found numbers that take" "$huge
    grow('needed_node', 9 * 10**6)
    f['needed_pressure_basis'][-1, -1] = 1"
    [ "$(stat -c %s bad.h5)" -gt 500000000 ]
    # a chunk is unpacked at once, so its size has a limit too
    stranger m "load_jacobian: found a chunk of 100000000 numbers, expected at most 1048576" "
    d = f['load_jacobian'][...]; del f['load_jacobian']
    f.create_dataset('load_jacobian', data=d, maxshape=(None,), chunks=(10**8,), compression='gzip')"
    # tables of numbers have limits too
    sed -i '/^transient/d' moving.yml
    echo 'transient: {end_time: 0.1, load: {law: table, file: T.h5, column: F}}' >>moving.yml
    /usr/bin/python3 -c "
import h5py
with h5py.File('T.h5', 'w') as f:
    for n in 'time', 'F': f.create_dataset(n, (2**61,), 'f8', chunks=(100,))"
    refuse 65 "time: found 2305843009213693952 numbers, expected at most 100000000" fullrun moving.yml -o x.h5
    /usr/bin/python3 -c "
import h5py
with h5py.File('T.h5', 'w') as f:
    for n in 'time', 'F': f.create_dataset(n, (10**7,), 'f8', chunks=(100,))"
    refuse 65 "T.h5: found numbers that take 80 MB in a file with .* MB of data, expected at most 1032 times as much" fullrun moving.yml -o x.h5
}

# bats test_tags=slow
@test "files that nobody writes on purpose" {
    # harmless oddities are read: a group within itself, a block before the file, bytes behind it, many attributes
    patch m.h5 "
    g = f.create_group('g')
    g['g'] = g
    f['g/root'] = f['/']
    for i in range(100): f.attrs[f'own{i}'] = i"
    romrun --check bad.h5
    romrun scene.yml --model bad.h5 --allow-untrusted
    /usr/bin/python3 -c "
import h5py
with h5py.File('block.h5', 'w', userblock_size=512) as to, h5py.File('m.h5') as f:
    for n in f: f.copy(n, to)
    for n in f.attrs: to.attrs[n] = f.attrs[n]"
    cat m.h5 m.h5 >twice.h5
    for file in block twice; do
        romrun --check $file.h5
        romrun scene.yml --model $file.h5 --allow-untrusted
    done
    /usr/bin/python3 -c "
import h5py, numpy
with h5py.File('T.h5', 'w') as f:
    g = f.create_group('g')
    g['g'] = g
    f['g/F'], f['time'] = numpy.ones(3), numpy.arange(3.)"
    sed -i '/^transient/d' moving.yml
    echo 'transient: {end_time: 0.1, load: {law: table, file: T.h5, column: g/g/g/g/g/g/F}}' >>moving.yml
    fullrun moving.yml --quiet
    sed -i 's,g/g/g/g/g/g/F,../g/F,' moving.yml
    refuse 65 "no dataset ../g/F" fullrun moving.yml -o x.h5
    # an object of another kind under the name of a dataset is refused
    local name=load_jacobian
    stranger m "$name: found a soft link" "del f['$name']; f['$name'] = h5py.SoftLink('/$name')"
    stranger m "$name: found no dataset" "del f['$name']; f.create_group('$name')"
    stranger m "$name: found no dataset" "del f['$name']; f['$name'] = numpy.dtype('f8')"
    stranger m "$name: found 0 axes, expected 1" "del f['$name']; f['$name'] = h5py.Empty('f8')"
    stranger m "$name: found length 0" "del f['$name']; f['$name'] = numpy.zeros(0)"
    for type in bool complex "h5py.string_dtype()" "h5py.ref_dtype" "h5py.vlen_dtype('f8')"; do
        stranger m "$name: found values of another type" "del f['$name']; f.create_dataset('$name', (8,), $type)"
    done
    for value in "numpy.full(3, 0.05)" "f.ref" "h5py.Empty('f8')" "'0.05'" "b'0.05' * 10000"; do
        stranger m "attribute step: found something else" "f.attrs['step'] = $value"
    done
    # texts of the file do not reach a terminal unchanged
    stranger m 'deformation: found cou.pled..2J., expected' "f.attrs['deformation'] = 'cou\\npled\\x1b[2J\\x07'"
    [[ $stderr != *$'\x1b'* ]]
}

# bats test_tags=slow
@test "tables and scenes that nobody writes on purpose" {
    /usr/bin/python3 -c "
text = open('scene.yml').read()
base = '\n'.join(l for l in text.split('\n') if 'moes' not in l)
def put(name, data): open(name, 'wb').write(data if isinstance(data, bytes) else data.encode())
put('wide.csv', ','.join('a%d' % i for i in range(1700000)) + '\n')
put('again.csv', ','.join(['moes.M'] * 2000000) + '\n')
put('commas.csv', 'moes.M' + ',' * 16000000 + '\n')
put('huge.csv', 'moes.M\n' + '1' * 17000000)
put('zero.csv', b'moes.M\n1\x002\n')
put('utf16.csv', 'moes.M\n12\n'.encode('utf-16'))
put('quoted.csv', 'moes.M\n\"12\"3\n')
put('mac.csv', 'moes.M\r12\r')
put('utf16.yml', text.encode('utf-16'))
put('zero.yml', text.replace('12', '1\0002'))
put('bytes.yml', b'# \xe4\n' + text.encode())
put('lists.yml', '[' * 1000000)
put('maps.yml', 'a: ' + '{a: ' * 1000000)
put('keys.yml', '? ' * 100000)
put('laughs.yml', 'a: &a [x, x]\nb: &b [*a, *a]\nc: [*b, *b]\n')
put('mark.yml', b'\xef\xbb\xbf' + text.encode())
many = str([1 + 1e-3 * i for i in range(100000)])
put('product.yml', 'groups:\n- {scene: base.yml, vary: {moes.M: %s, moes.L: %s}}\n' % (many, many))
"
    for table in wide again commas huge zero utf16 quoted mac; do
        refused 65 "$table.csv" romrun scene.yml --cases $table.csv --model m.h5 -o x.csv
    done
    for scene in utf16 zero bytes lists maps keys laughs; do
        refuse 65 "$scene.yml:[0-9]*: found" fullrun $scene.yml -o x.h5
    done
    fullrun mark.yml
    refuse 65 "groups: found more than 1000000 points" snapgen product.yml -o x.h5
}

# Makes bad.h5, residuals of 0.9 GB in 8 MB.
large_residuals() {
    patch r.h5 "
    n = 20000
    rest = numpy.zeros((n, 121))
    rest[::200] = numpy.random.default_rng(1).random((n // 200, 121))
    del f['iteration'], f['iteration_state']
    for name in 'weighted_residual', 'weighted_jacobian_step':
        del f[name]
        d = f.create_dataset(name, (24 * n, 121), 'f8', compression='gzip', chunks=(n, 121))
        d[:n] = rest
        mask, raw = d.id.read_direct_chunk((0, 0))
        for i in range(1, 24): d.id.write_direct_chunk((i * n, 0), raw, mask)"
}

@test "memory is asked for before numbers are taken" {
    [[ ${VARIANT:-} != san ]] || skip "the address sanitizer needs more than the limit"
    large_residuals
    run -71 --separate-stderr bash -c 'ulimit -v 800000; deimselect bad.h5 --basis b.h5 --memory 20G -o x.h5'
    [[ $stderr == "deimselect: residuals: out of memory" ]]
}

# interrupted PATTERN COMMAND...: checks that SIGTERM while bad.h5 is read gives exit code 130 and one line that
# matches.
interrupted() {
    local pattern=$1 process code=0
    shift
    timeout --foreground -s KILL 300 "$@" >out 2>log & # without --foreground the program would receive the signal twice
    process=$!
    until [ -n "$(find /proc/[0-9]*/fd -lname "$PWD/bad.h5" 2>/dev/null)" ]; do
        kill -0 $process
        sleep 0.01
    done
    kill $process
    wait $process || code=$?
    cat log
    [ "$code" -eq 130 ]
    [ ! -s out ]
    [ "$(wc -l <log)" -eq 1 ]
    grep -qx "$pattern" log
}

# bats test_tags=slow
@test "a signal ends a program while it reads" {
    large_residuals
    interrupted "romrun: bad.h5: interrupted while it was read" romrun --check bad.h5
    interrupted "deimselect: bad.h5: interrupted while it was read" deimselect bad.h5 --basis b.h5 -o x.h5 --no-check
    [ ! -e x.h5 ] && [ ! -e x.h5.partial ]
}

# bats test_tags=slow
@test "code that a file asks for is not loaded" {
    cat >filter.c <<'C'
#include <fcntl.h>
__attribute__((constructor)) static void leave_a_trace(void) {
    open("loaded", O_WRONLY | O_CREAT, 0666);
}
const void *H5PLget_plugin_info(void) { return 0; }
int H5PLget_plugin_type(void) { return 0; }
C
    mkdir plugins
    gcc -shared -fPIC -o plugins/libfilter.so filter.c
    export HDF5_PLUGIN_PATH=$PWD/plugins
    local -A dataset=([s]=pressure [m]=load_jacobian)
    for kind in s m; do
        patch $kind.h5 "
    name = '${dataset[$kind]}'
    d = f[name][...]; del f[name]
    new = f.create_dataset(name, d.shape, chunks=d.shape, compression='lzf')
    new.id.write_direct_chunk([0] * d.ndim, b'compressed')"
        # HDF5 itself loads the filter
        h5dump -d "${dataset[$kind]}" bad.h5 >dump 2>&1 || true
        [ -e loaded ]
        rm loaded
        refused 65 "found a filter beside" romrun --check bad.h5
        case $kind in
        s) refuse 65 "found a filter beside" podbuild bad.h5 -o x.h5 ;;
        m) refuse 65 "found a filter beside" romrun scene.yml --model bad.h5 -o x.h5 ;;
        esac
        [ ! -e loaded ]
    done
    # datasets outside of the schema are not read, so they load no filter either
    patch m.h5 "f.create_dataset('own', (10,), chunks=(10,), compression='lzf').id.write_direct_chunk([0], b'compressed')"
    rm -f loaded # Python loaded it
    romrun --check bad.h5
    romrun scene.yml --model bad.h5 --allow-untrusted -o y.h5
    romrun --print bad.h5 >names
    [ ! -e loaded ]
}

# bats test_tags=slow
@test "numbers are what they may be" {
    stranger m "state_moes_M: found 0, expected above 0" "f['state_moes_M'][2] = 0"
    stranger m "state_moes_M: found -1, expected above 0" "f['state_moes_M'][2] = -1"
    stranger m "state_alpha_p_H: found -3, expected at least 0" "f['state_alpha_p_H'][0] = -3"
    stranger m "state_alpha_p_H: found nan, expected at least 0" "f['state_alpha_p_H'][0] = numpy.nan"
    stranger m "row_weight: found inf, expected above 0" "f['row_weight'][0] = numpy.inf"
    stranger m "row_weight: found nan" "f['row_weight'][-1] = numpy.nan"
    stranger m "selected_row: found 99999, expected 0 to 120" "f['selected_row'][1] = 99999"
    stranger m "selected_row: found -1, expected 0 to 120" "f['selected_row'][1] = -1"
    stranger m "selected_row: found .* expected each once" "f['selected_row'][1] = f['selected_row'][0]"
    stranger m "control_row: found 121, expected 0 to 120" "f['control_row'][0] = 121"
    stranger m "needed_node_index: found .* expected them ascending" "
    f['needed_node_index'][3], f['needed_node_index'][4] = f['needed_node_index'][4], f['needed_node_index'][3]"
    stranger m "needed_node_index: found 123, expected 0 to 122" "f['needed_node_index'][-1] = 123"
    stranger m "state_exit_node: found 122, expected 0 to 121" "f['state_exit_node'][0] = 122"
    stranger m "state_stationary: found 2, expected 0 to 1" "f['state_stationary'] = numpy.full(len(f['state']), 2)"
    stranger m "position_rows: found -1, expected" "f['position_rows'][0] = -1"
    stranger m "indicator_factor: found inf, expected at least 0" "f['indicator_factor'][0] = numpy.inf"
    stranger m "step: found 0, expected above 0" "f.attrs['step'] = 0.0"
    stranger m "half: found 7, expected 0 to 1" "f.attrs['half'] = 7"
    stranger m "band_line_begin: found no axis y, expected it" "f['band_line_begin'] = 3"
    stranger b "weight: found -1, expected above 0" "f['weight'][5] = -1"
    stranger r "iteration_state: found 9, expected -1 to 8" "f['iteration_state'][2] = 9"
    stranger s "moes_M: found 0, expected above 0" "f['moes_M'][0] = 0"
    patch s.h5 "f['exit_node'][0] = -1" # podbuild does not read this entry
    refused 65 "exit_node: found -1, expected 0 to 121" podbuild --check bad.h5
    # the square of the number overflows
    patch r.h5 "f['weighted_residual'][1] = 1e308"
    refuse 65 "bad.h5: .*found 1e\+308 in snapshot .*, expected .* at most 1e\+140" deimselect bad.h5 --basis b.h5 -o x.h5 --no-check
    # the numbers of a state that was not solved are not checked
    patch s.h5 "f['status'][0], f['moes_M'][0] = 1, numpy.nan"
    podbuild bad.h5 -o x.h5
    podbuild --check bad.h5
}

@test "a model without a stationary state, and a lubricant that has no viscosity at any state" {
    patch m.h5 "f['state_stationary'] = numpy.zeros(len(f['state']), 'i8')"
    romrun --check bad.h5
    run romrun scene.yml --model bad.h5 --allow-untrusted
    [ "$status" -eq 0 ] || [ "$status" -eq 3 ]
    [[ $output == *"central film thickness"* ]]
    patch m.h5 "
    f['state_alpha_p_H'][...] = 1e9
    f['state_viscosity_rise'][...] = 1.0"
    run romrun scene.yml --model bad.h5 --allow-untrusted
    [ "$status" -eq 0 ] || [ "$status" -eq 3 ]
}

# bats test_tags=slow
@test "--check takes what the readers take, and says why not" {
    for file in *.h5; do
        for name in romrun deimselect fullrun; do $name --check $file; done
    done
    stranger m "found no dataset needed_coupled_basis" "del f['needed_coupled_basis']"
    stranger m "found no dataset band_coupled_basis" "del f['band_coupled_basis']"
    stranger m "needed_node_index: found no node" "
    for n in ('needed_node', 'needed_node_index', 'needed_pressure_basis', 'needed_coupled_basis'):
        d = f[n][:-1]; del f[n]; f[n] = d"
    stranger m "least_exit: found 1, expected 3" "f.attrs['least_exit'] = 1"
    stranger m "found exits from .*, expected them inside the band" "f.attrs['band_begin'] = f.attrs['least_exit']"
    stranger m "deformation: found both, expected" "f.attrs['deformation'] = 'both'"
    stranger m "smoothing: found 7, expected 0 to 1" "f.attrs['transport'] = 'path'; f.attrs['smoothing'] = 7.0"
    stranger m "x: found .* expected the dry contact inside" "f.attrs['x_min'] = 0.5"
    stranger m "rows: found 4 rows, expected at least 8" "
    for n in ('row', 'selected_row', 'row_weight', 'row_factor', 'row_jacobian_modes'):
        d = f[n][:4]; del f[n]; f[n] = d"
    stranger b "found no dataset deformation_basis" "f.attrs['deformation'] = 'independent'"
    stranger s "transport: found nowhere" "f.attrs['transport'] = 'nowhere'"
    patch s.h5 "f.attrs['transport'] = 'nowhere'"
    refused 65 "transport: found nowhere" fullrun --check bad.h5
    patch s.h5 "f['status'][...] = 1"
    refused 65 "found no converged state" podbuild --check bad.h5
    stranger full "found numbers that are not finite" "f['pressure'][0, 3] = numpy.nan"
    stranger moving "time: found .* as entry 2, expected above" "f['time'][2] = 0"
}

@test "a pressure that reaches the last node" {
    # a checkpoint behind the last node must not be read, which sanitizers would report
    patch s.h5 "
    p = f['pressure'][0]
    p[90:] = numpy.linspace(p[90], 0.1, 31)
    f['pressure'][0] = p"
    podbuild --check bad.h5
    podbuild bad.h5 -o x.h5 --weight row-norm --plan plan.yml --pressure-modes 8
    podbuild --check x.h5
}

# changed KIND PYTHON DATASET: checks the same as stranger for a file that keeps its digest
changed() {
    cp "$1.h5" bad.h5
    /usr/bin/python3 -c "
import h5py, numpy
with h5py.File('bad.h5', 'r+') as f:
    $2"
    refused 65 "bad.h5: $3: found a changed content, expected that of content_sha256" romrun --check bad.h5
    case $1 in
    s) refuse 65 "$3: found a changed content" podbuild bad.h5 -o x.h5 ;;
    b) refuse 65 "$3: found a changed content" deimselect r.h5 --basis bad.h5 -o x.h5 ;;
    r) refuse 65 "$3: found a changed content" deimselect bad.h5 --basis b.h5 -o x.h5 --no-check ;;
    m) refuse 65 "$3: found a changed content" romrun scene.yml --model bad.h5 -o x.h5 ;;
    full) refuse 65 "$3: found a changed content" fullrun scene.yml --start bad.h5 -o x.h5 ;;
    moving) refuse 65 "$3: found a changed content" romrun moving.yml --model m.h5 --against bad.h5 -o x.h5 ;;
    esac
}

# bats test_tags=slow
@test "a change of content by accident is noticed" {
    changed s "f['pressure'][4, 30] += 1e-9" pressure
    changed s "f['moes_M'][4] += 1e-9" moes_M
    changed b "f['pressure_basis'][3, 30] += 1e-9" pressure_basis
    changed r "f['weighted_residual'][3, 30] += 1e-9" weighted_residual
    changed m "f['load_jacobian'][3] += 1e-9" load_jacobian
    changed m "f['state_exit_node'][3] += 1" state_exit_node
    changed m "f.attrs['x_min'] = -4.1" attributes
    changed m "f.attrs['stability'] = 1.0" attributes
    changed m "del f['row_factor']" row_factor
    changed full "f['pressure'][0, 30] += 1e-9" pressure
    changed moving "f['central_film_thickness'][3] += 1e-9" central_film_thickness
    changed moving "f['time'][3] += 1e-9" time
    # the digest does not cover additions, nor the way in which data is stored
    cp m.h5 bad.h5
    /usr/bin/python3 -c "
import h5py
with h5py.File('bad.h5', 'r+') as f:
    f['note'], f.attrs['note'], f['load_jacobian'].attrs['note'], f.attrs['history'] = 1, 2, 3, ''
    d = f['pressure_basis'][...]; del f['pressure_basis']
    f.create_dataset('pressure_basis', data=d, chunks=True, compression='gzip', dtype='>f8')"
    romrun --check bad.h5
    romrun scene.yml --model bad.h5 --allow-untrusted -o x.h5
    content() { h5dump -a "$2" "$1" | grep '(0)'; }
    [[ $(content x.h5 input_2_content) == *'"digest checked"' ]]
    # a foreign writer may omit the digest
    patch m.h5 "f['load_jacobian'][3] += 1e-9"
    romrun --check bad.h5
    romrun scene.yml --model bad.h5 --allow-untrusted -o y.h5
    [[ $(content y.h5 input_2_content) == *'"no digest"' ]]
    # one line reports this, also without an output
    run --separate-stderr romrun scene.yml --model bad.h5 --allow-untrusted
    [ "$(grep -c "^romrun: bad.h5: found no digest of its content" <<<"$stderr")" -eq 1 ]
    run --separate-stderr romrun scene.yml --model m.h5 --allow-untrusted
    [[ $stderr != *digest* ]]
    # EHDROM_DIGEST=no skips the check
    cp m.h5 bad.h5
    /usr/bin/python3 -c "
import h5py
with h5py.File('bad.h5', 'r+') as f: f['load_jacobian'][3] += 1e-9"
    EHDROM_DIGEST=no romrun scene.yml --model bad.h5 --allow-untrusted -o z.h5
    [[ $(content z.h5 input_2_content) == *'"digest not checked"' ]]
    run h5dump -a content_sha256 z.h5
    [ "$status" -ne 0 ]
    romrun --check z.h5
}

@test "digests as schemas/README.md says, also of what was written piece by piece" {
    cat >digest.py <<'PYTHON'
import hashlib, sys, h5py, numpy
def text(x): return x if isinstance(x, bytes) else x.encode()
for name in sys.argv[1:]:
    with h5py.File(name) as f:
        lines = [l.split() for l in text(f.attrs["content_sha256"]).decode().splitlines()]
        assert lines[0][1] == "attributes", lines[0]
        assert len(lines) > 1, name
        for digest, n in lines[1:]:
            d = f[n][...]
            axis = f[n].attrs.get("CLASS") == b"DIMENSION_SCALE"
            kind = "real" if axis or d.dtype.kind == "f" else "integer"
            d = d.astype("<f8" if kind == "real" else "<i8")
            h = hashlib.sha256((" ".join([n, kind] + [str(l) for l in d.shape]) + "\n").encode())
            if n in ("pressure", "film_thickness") and f.attrs["schema_name"] in ("ehdrom-result", b"ehdrom-result"):
                for i, e in enumerate(d):
                    if not numpy.isnan(e).all(): h.update(b"%d\n" % i + e.tobytes())
            else:
                h.update(d.tobytes())
            assert h.hexdigest() == digest, (name, n)
PYTHON
    fullrun moving.yml -o every.h5 --quiet --set output.fields_every=3
    # digests of merged shards, and of a run that was killed and resumed
    snapgen plan.yml -o one.h5 --shard 1/2 --quiet
    snapgen plan.yml -o two.h5 --shard 2/2 --quiet
    podbuild one.h5 two.h5 -o x.h5
    stop_when KILL 'states >= 3' t.h5 snapgen plan.yml -o t.h5 --jobs 1
    if [ -e t.h5.partial ]; then
        run h5dump -a content_sha256 t.h5.partial
        [ "$status" -ne 0 ]
        snapgen plan.yml -o t.h5 --resume --quiet
    fi
    /usr/bin/python3 digest.py s.h5 b.h5 r.h5 m.h5 full.h5 moving.h5 every.h5 one.h5 two.h5 x.h5 t.h5
    for file in every one two x t; do fullrun --check $file.h5; done
}

# harmless COMMAND...: checks that the output has no control characters, and that each line of stderr is the program's.
harmless() {
    run --separate-stderr "$@"
    echo "$*: $status: $stderr"
    printf '%s\n%s\n' "$output" "$stderr" | /usr/bin/python3 -c '
import sys
text = sys.stdin.buffer.read().decode()  # all of the text is UTF-8
assert not [c for c in text if (c < " " and c not in "\n\t") or "\x7f" <= c <= "\x9f" or c in "\u2028\u2029\u202e\u2066"], ascii(text)'
    [ -z "$(grep -v "^$(basename "$1"): " <<<"$stderr")" ]
}

# bats test_tags=slow
@test "control characters of files do not reach a terminal" {
    local evil='"\x1b[2J\x7f\u009b31m\u2028\u202eX\r\n\b" + "romrun: all is well"'
    for attribute in schema_name schema_version discretization contact kind; do
        patch m.h5 "f.attrs['$attribute'] = $evil"
        harmless romrun --check bad.h5
        harmless romrun scene.yml --model bad.h5
        harmless deimselect r.h5 --basis bad.h5 -o x.h5
    done
    patch m.h5 "f.attrs['history'] = $evil; f.attrs['settings'] = $evil; f.attrs[$evil] = 1; f.attrs['title'] = b'\x9b31m\xff'"
    harmless romrun --print bad.h5
    harmless romrun --print bad.h5 none
    for attribute in history settings title; do
        harmless romrun --print bad.h5 $attribute
        [ "$status" -eq 0 ]
        grep -F '?' <<<"$output"
    done
    harmless podbuild bad.h5 -o x.h5
    # the text is still one CSV entry
    romrun --print bad.h5 history | /usr/bin/python3 -c 'import csv, sys; assert len(list(csv.reader(sys.stdin))) == 2'
    # YAML and tables, with keys and values
    printf 'contact: "\\e[2J\\x9b\\x7f"\n' >bad.yml
    harmless fullrun bad.yml
    printf '"\\e[2J\\N": 1\n' >bad.yml
    harmless fullrun bad.yml
    printf 'moes.M,moes.L,\033[2J\302\2331m\n10,3,1\n' >bad.csv
    harmless romrun scene.yml --cases bad.csv --model m.h5 -o x.csv
    printf 'moes.M,moes.L\n\033[2J,3\n' >bad.csv
    harmless romrun scene.yml --cases bad.csv --model m.h5 -o x.csv
    printf 'groups:\n- {scene: base.yml, points: bad.csv}\n' >bad-plan.yml
    harmless snapgen bad-plan.yml -o x.h5
    # the name of a file
    cp m.h5 $'m\033[2J.h5'
    harmless romrun --check $'m\033[2J.h5'
    harmless romrun scene.yml --model $'n\033[2J.h5'
    [ "$status" -eq 66 ]
}

@test "the name of an FMU is valid in XML" {
    [ "$(uname -m)" = x86_64 ] && is_installed || skip "no FMU here"
    sed 's/^moes:.*/physical: {load: 60e3, radius: 0.0125, speed: 0.8, modulus: 226e9, viscosity: 0.02}/' scene.yml >si.yml
    local name=$'a\033\001<&">\302\205\377\357\277\277\302\265.fmu'
    romrun -q --fmu si.yml --model m.h5 -o "$name"
    /usr/bin/python3 - "$name" <<'PYTHON'
import sys, xml.etree.ElementTree, zipfile
description = zipfile.ZipFile(sys.argv[1]).read("modelDescription.xml")
assert xml.etree.ElementTree.fromstring(description).get("modelName") == 'a??<&">???\u00b5', description[:300]
PYTHON
}

# bats test_tags=slow
@test "a flat model is one under another rounding of the host too" {
    is_installed || skip "sanitizers have to be loaded first"
    romrun --export m.h5 -o m.ehdrom
    for way in UPWARD DOWNWARD TOWARDZERO; do
        printf '#include <fenv.h>\n__attribute__((constructor)) static void set(void) { fesetround(FE_%s); }\n' $way >round.c
        gcc -shared -fPIC round.c -o round.so -lm
        for model in m.h5 m.ehdrom; do
            LD_PRELOAD=$PWD/round.so romrun scene.yml --model $model --allow-untrusted -o $way-$model.h5 --quiet
        done
        for film in central_film_thickness minimum_film_thickness; do
            close_to "$(number $way-m.h5.h5 $film)" "$(number $way-m.ehdrom.h5 $film)" 1e-7
        done
    done
}
