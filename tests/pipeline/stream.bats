#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests of bases from snapshots that do not fit in memory, and from parts that were compressed before.

load common

# Solves 48 points of a line contact into one file and into three files, and some trajectories of the contact.
setup_file() {
    cd "$BATS_FILE_TMPDIR" || return
    common_setup_small
    sed -i 's/step: 0.05/step: 0.01/' scene.yml base.yml
    cat >plan.yml <<'YAML'
groups:
  - scene: base.yml
    vary: {moes.M: [8, 9, 10, 11, 12, 13, 14, 15], moes.L: [2, 2.8, 3.6, 4.4, 5.2, 6]}
YAML
    sed 's/stationary/transient/' base.yml >moving.yml
    cat >>moving.yml <<'YAML'
transport: upwind
transient: {end_time: 0.1, load: {law: sine, amplitude: 0.1, period: 1}, fixed_step: 0.01}
YAML
    printf 'groups:\n- {scene: moving.yml, vary: {moes.M: [10, 13], moes.L: [3, 5]}}\n' >moving-plan.yml
    snapgen -q plan.yml -o s.h5
    for k in 1 2 3; do snapgen -q plan.yml --shard $k/3 -o s$k.h5; done
    snapgen -q moving-plan.yml -o t.h5
    podbuild -q s.h5 -o direct.h5
}

setup() {
    cd "$BATS_TEST_TMPDIR" || return
    cp "$BATS_FILE_TMPDIR"/* .
}

# compare BASIS SNAPSHOTS...: checks that the basis leaves out no more energy than it states, and that it states at most
# 1e-13. If all snapshots are in one block, it leaves out as much as it states, up to round-off. The states of the basis
# must be the states of the snapshots, in the same order.
compare() {
    /usr/bin/python3 - "$@" <<'PY'
import h5py, numpy, os, sys
b = h5py.File(sys.argv[1])
files = [h5py.File(name) for name in sys.argv[2:]]
states = numpy.concatenate([f["pressure"][...] for f in files])
rows = [f["pressure"][...][f["trajectory"][...] < 0] if "trajectory" in f else f["pressure"][...] for f in files]
rows = numpy.concatenate(rows + [f["compressed_pressure"][...] for f in files if "compressed_pressure" in f])
v = b["pressure_basis"][...]
assert abs(v @ v.T - numpy.eye(len(v))).max() < 1e-13
left_out = ((rows - rows @ v.T @ v) ** 2).sum() / (rows**2).sum()
said = b.attrs["pressure_energy_discarded"]
print("left out", left_out, "at most", said)
assert 0 < left_out <= said * (1 + 1e-9) and said <= 1e-13
# the coordinates of states in parts are exact, except for the energy that the parts left out
difference = abs(b["state_pressure"][...] - states @ v.T).max()
print("coordinates differ by", difference)
assert difference < float(os.environ.get("WITHIN", 1e-12))
for name in "exit_node", "moes_M", "alpha_p_H", "rigid_approach", "central_film_thickness", "step_effect":
    unknown = lambda f: numpy.full(len(f["pressure"]), numpy.nan)
    expected = numpy.concatenate([f[name][...] if name in f else unknown(f) for f in files])
    assert numpy.array_equal(b["state_" + name][...], expected, equal_nan=True), name
PY
}

# films NAME: prints the central and the minimum film of three scenes by a model of NAME.h5
films() {
    snapgen -q plan.yml --basis "$1.h5" -f -o r.h5 >log
    deimselect -q --no-check r.h5 --basis "$1.h5" -f -o m.h5 >log
    for M in 8.7 11.3 14.2; do
        romrun -q --allow-untrusted scene.yml --set moes.M=$M --model m.h5 -f -o f.h5 >log
        romrun --print f.h5 central_film_thickness minimum_film_thickness | tail -n 1 | tr , '\n'
    done
}

@test "within a limit that all fits in, the direct way with the same bits" {
    podbuild -q s.h5 --memory 1G -o x.h5
    same_data x.h5 direct.h5
    podbuild s.h5 --memory 1G -f -o x.h5 --verbose 2>log
    grep -q "48 snapshots at once, at most [0-9.]* MB of 1000 MB" log
}

# bats test_tags=slow
@test "a small limit: the error within the bound, the states as they are, and the films of the direct way" {
    podbuild s.h5 --memory 650K -o x.h5 2>log
    grep -q "48 snapshots of 603 nodes one after the other, .*: at most 0.[0-9]* MB of 0.65 MB" log
    compare x.h5 s.h5
    podbuild -q s1.h5 s2.h5 s3.h5 --memory 650K -o y.h5
    compare y.h5 s1.h5 s2.h5 s3.h5
    podbuild -q s.h5 --memory 650K -f -o y.h5
    same_data x.h5 y.h5
    films direct >expected
    films x >found
    paste expected found
    [ "$(wc -l <found)" -eq 6 ]
    paste expected found
    paste expected found | awk '{ if (!(($1 - $2)^2 <= (3e-6 * $1)^2)) exit 1 }'
}

@test "a given number of modes are those of the direct way" {
    podbuild -q s.h5 --pressure-modes 20 -o a.h5
    podbuild s.h5 --pressure-modes 20 --memory 650K -o b.h5 2>log
    grep -q "one after the other" log
    /usr/bin/python3 -c "
import h5py, numpy
a, b = h5py.File('a.h5'), h5py.File('b.h5')
p, q = a['pressure_basis'][...], b['pressure_basis'][...]
s = a['pressure_singular_values'][...]
assert numpy.allclose(s[:30], b['pressure_singular_values'][:30], rtol=0, atol=1e-11 * s[0])
sine = numpy.linalg.norm(p - p @ q.T @ q, 2)
print(sine, s[19:21])
assert sine < 1e-10 * s[0] / (s[19] - s[20])"
}

# bats test_tags=slow
@test "modes of their own of the deflections, and trajectories" {
    podbuild -q s.h5 --deformation independent -o a.h5
    podbuild -q s.h5 --deformation independent --memory 1000K -o b.h5
    compare b.h5 s.h5
    /usr/bin/python3 -c "
import h5py, numpy
a, b = h5py.File('a.h5'), h5py.File('b.h5')
# deflections of the states, computed from the coordinates of either basis
d, e = (f['state_deformation'][...] @ f['deformation_basis'][...] for f in (a, b))
assert numpy.linalg.norm(d - e) < 2e-6 * numpy.linalg.norm(d)
assert numpy.linalg.norm(d - e) > 0"
    podbuild t.h5 s.h5 --memory 1500K -f -o b.h5 2>log
    grep -q "one after the other" log
    compare b.h5 t.h5 s.h5
    /usr/bin/python3 -c "
import h5py
assert (h5py.File('b.h5')['state_stationary'][...] == 0).any()"
}

@test "a limit that is too small, or no amount, is one line" {
    refuse 71 "--memory: found 0.01 MB, expected at least 0.[0-9]* MB for 48 states on 603 nodes and 16 modes" \
        podbuild s.h5 --memory 10K -o x.h5
    least=$(podbuild s.h5 --memory 10K -o x.h5 2>&1 | sed 's/.*at least \([0-9.]*\) MB.*/\1/')
    podbuild -q s.h5 --memory "${least}M" --energy 1e-6 -o y.h5
    refuse 71 "more than [0-9]* directions .*give more of it, or leave out a larger part" \
        podbuild -q s.h5 --memory "${least}M" -o x.h5
    for amount in 2 G 0M -1G 1e400G nanG 2g 2GB; do
        refuse 64 "--memory: found $amount, expected a number above 0 and K, M, G or T" \
            podbuild s.h5 --memory "$amount" -o x.h5
    done
}

# ---- parts

# bats test_tags=slow
@test "parts of a training make the basis of all of it" {
    for k in 1 2 3; do
        podbuild --compress s$k.h5 -o p$k.h5 >told
        grep -q "compressed:  [0-9]* modes of [0-9]* snapshots, energy left out at most" told
        podbuild --check p$k.h5
    done
    podbuild p1.h5 p2.h5 p3.h5 -o x.h5
    compare x.h5 s1.h5 s2.h5 s3.h5
    podbuild -q p1.h5 s2.h5 p3.h5 -f -o x.h5
    compare x.h5 s1.h5 s2.h5 s3.h5
    films direct >expected
    films x >found
    paste expected found
    paste expected found | awk '{ if (!(($1 - $2)^2 <= (3e-6 * $1)^2)) exit 1 }'
    podbuild -q --compress t.h5 -o p4.h5
    podbuild -q p4.h5 s.h5 -f -o x.h5
    WITHIN=1e-6 compare x.h5 t.h5 s.h5
    romrun --print x.h5 history | grep -c 'podbuild.*--compress'
}

@test "thinned flow is told of the states, streamed and of parts" {
    /usr/bin/python3 -c "
import h5py, numpy
for k in '12':
    with h5py.File(f's{k}.h5', 'r+') as f:
        del f.attrs['content_sha256']
        f['thinning'] = numpy.arange(len(f['moes_M'])) * 0.5 + int(k)"
    podbuild -q --compress s1.h5 -o p1.h5
    podbuild -q p1.h5 s2.h5 s3.h5 -o x.h5
    podbuild -q s1.h5 s2.h5 s3.h5 -o y.h5
    /usr/bin/python3 -c "
import h5py, numpy
x, y = (h5py.File(name)['state_thinning'][...] for name in ('x.h5', 'y.h5'))
expected = [h5py.File(f's{k}.h5')['thinning'][...] for k in '12']
assert numpy.array_equal(x, y) and numpy.array_equal(x[: sum(map(len, expected))], numpy.concatenate(expected))"
}

@test "a part that left out too much is refused" {
    podbuild -q --compress s.h5 --energy 1e-6 -o p.h5
    refuse 65 "found parts that leave out .* expected at most .*; compress them with --energy 1.0e-13 or less" \
        podbuild -q p.h5 -o x.h5
    # a basis of few modes needs less accurate parts
    podbuild -q p.h5 --energy 1e-6 -o y.h5
    podbuild -q p.h5 --pressure-modes 3 -f -o y.h5
    refuse 65 "compress them with --energy" podbuild -q p.h5 --pressure-modes 21 -o x.h5
}

@test "what does not go with parts is one line" {
    podbuild -q --compress s1.h5 -o p.h5
    refuse 65 "p.h5: found a part, expected snapshots with --compress" podbuild p.h5 --compress -o x.h5
    refuse 65 "p.h5: found a part, expected snapshots with --deformation independent" \
        podbuild p.h5 --deformation independent -o x.h5
    for option in "pressure-modes 5" "weight identity" "deformation coupled"; do
        refuse 64 "--${option% *}: found it with --compress" podbuild s1.h5 --compress --$option -o x.h5
    done
    refuse 65 "schema_name: found ehdrom-part, expected ehdrom-basis" snapgen plan.yml --basis p.h5 -o x.h5
    refuse 73 "p.h5: " podbuild -q s1.h5 --compress -o p.h5
}

# bats test_tags=slow
@test "a stranger's part is read like every other" {
    podbuild -q --compress s1.h5 -o p.h5
    spoilt() {
        /usr/bin/python3 -c "
import h5py, numpy, shutil
shutil.copy('p.h5', 'bad.h5')
with h5py.File('bad.h5', 'r+') as f:
    if 'content_sha256' in f.attrs: del f.attrs['content_sha256']
    $2"
        refuse 65 "$1" podbuild -q bad.h5 -o x.h5
        refuse 65 "$1" podbuild --check bad.h5
    }
    spoilt "pressure_basis: found nan" "f['pressure_basis'][3, 4] = numpy.nan"
    spoilt "pressure_singular_values: found -1" "f['pressure_singular_values'][3] = -1"
    spoilt "state_exit_node: found 5000" "f['state_exit_node'][3] = 5000"
    spoilt "energy_discarded: found 2, expected at most 1" "f.attrs['energy_discarded'] = 2.0"
    spoilt "energy: found" "f.attrs['energy'] = -1.0"
    spoilt "state_pressure" "del f['state_pressure']"
    spoilt "found length 4 along state, expected" "d = f['state_moes_M'][:4]; del f['state_moes_M']; f['state_moes_M'] = d"
    spoilt "at most 100000" "
    del f['pressure_singular_values']
    f.create_dataset('pressure_singular_values', (10**9,), 'f8', chunks=(1000,))"
    # a part with only the required contents is accepted
    /usr/bin/python3 -c "
import h5py
a = h5py.File('p.h5')
with h5py.File('own.h5', 'w') as f:
    f.attrs.update(schema_name='ehdrom-part', schema_version='1.0')
    for name in 'contact', 'x_min', 'step', 'discretization', 'energy', 'energy_discarded': f.attrs[name] = a.attrs[name]
    for name in 'pressure_basis', 'pressure_singular_values', 'state_pressure', 'state_rigid_approach', \
            'state_exit_node', 'state_moes_M', 'state_alpha_p_H': f[name] = a[name][...]"
    podbuild --check own.h5
    podbuild -q own.h5 -o x.h5
    podbuild -q p.h5 -f -o y.h5
    /usr/bin/python3 -c "
import h5py, numpy
assert numpy.array_equal(h5py.File('x.h5')['pressure_basis'][...], h5py.File('y.h5')['pressure_basis'][...])"
}

# ---- memory and interruption

# Writes 3000 foreign snapshots of 2001 nodes, 48 MB, of rank 150.
many() {
    /usr/bin/python3 -c "
import h5py, numpy
r = numpy.random.default_rng(1)
m, n = 3000, 2001
x = numpy.linspace(-4, 2, n)
shapes = numpy.exp(-((x[None] - numpy.linspace(-2, 1, 150)[:, None]) / 0.3) ** 2)
p = abs(r.standard_normal((m, 150))) @ shapes * (x < 0.99)
with h5py.File('many.h5', 'w') as f:
    f.attrs.update(schema_name='ehdrom-snapshots', schema_version='1.0', contact='line', x_min=-4.0, step=0.003,
                   discretization='accurate')
    f['pressure'] = p
    f['rigid_approach'] = numpy.zeros(m)
    f['exit_node'] = numpy.argmax(p == 0, axis=1)
    f['status'] = numpy.zeros(m, 'i8')
    f['moes_M'] = numpy.linspace(8, 15, m)
    f['alpha_p_H'] = numpy.ones(m)"
}

# peak COMMAND...: prints the largest resident memory of the command in kB
peak() {
    /usr/bin/python3 -c "
import resource, subprocess, sys
subprocess.run(sys.argv[1:], check=True, stdout=subprocess.DEVNULL)
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)" "$@"
}

# bats test_tags=slow
@test "the memory stated is kept" {
    [ "$VARIANT" = release ] || skip "sanitizers take memory of their own"
    many
    libraries=$(peak podbuild -q s.h5 -f -o x.h5)
    taken=$(peak podbuild -q many.h5 --memory 30M -o y.h5)
    direct=$(peak podbuild -q many.h5 -f -o y.h5)
    echo "libraries $libraries kB, streamed $taken kB, at once $direct kB"
    # chunks of the file that are read beside the arrays take less than 8 MB
    ((taken < libraries + 30000 + 8000))
    ((direct > libraries + 100000))
}

# bats test_tags=slow
@test "Ctrl-C and SIGTERM while snapshots are streamed leave nothing" {
    many
    for signal in INT TERM; do
        for option in "" --compress; do
            # shellcheck disable=SC2086
            stop_when $signal "says /6000" x.h5 podbuild many.h5 --memory 30M $option -o x.h5 2>log
            cat log
            [ "$code" -eq 130 ]
            [ ! -e x.h5 ] && [ ! -e x.h5.partial ]
        done
    done
}
