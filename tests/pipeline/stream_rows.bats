#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests of row selection from residual snapshots that do not fit in memory.

load common

# Makes b.h5 and r.h5, a basis of 16 points of a line contact and their residuals.
# many.h5 has 4000 more iterations, which are mixtures of these with noise, so that each brings new directions.
# model.h5 has the rows that are selected from many.h5 in one piece.
setup_file() {
    cd "$BATS_FILE_TMPDIR" || return
    common_setup_small
    sed -i 's/step: 0.05/step: 0.01/' scene.yml base.yml
    cat >plan.yml <<'YAML'
groups:
  - scene: base.yml
    vary: {moes.M: [8, 10, 12, 15], moes.L: [2, 3, 4, 6]}
YAML
    snapgen -q plan.yml -o s.h5
    podbuild -q s.h5 -o b.h5
    snapgen -q plan.yml --basis b.h5 -o r.h5
    mix many.h5 1e-10
    deimselect -q --no-check many.h5 --basis b.h5 -o model.h5
}

setup() {
    cd "$BATS_TEST_TMPDIR" || return
    cp "$BATS_FILE_TMPDIR"/* .
}

# mix FILE NOISE: writes 4000 mixtures of the iterations of r.h5, and then these iterations. NOISE is the norm of the
# noise in the mixtures, relative to the norm of the mixtures.
mix() {
    /usr/bin/python3 - "$@" <<'PY'
import h5py, numpy, shutil, sys
random = numpy.random.default_rng(1)
shutil.copy("r.h5", sys.argv[1])
with h5py.File(sys.argv[1], "r+") as f:
    del f.attrs["content_sha256"]
    for name in "weighted_residual", "weighted_jacobian_step":
        own = f[name][...]
        more = random.standard_normal((4000, len(own))) @ own / (10 * len(own) ** 0.5)
        noise = random.standard_normal(more.shape)
        more += noise * float(sys.argv[2]) * numpy.linalg.norm(more) / numpy.linalg.norm(noise)
        del f[name]
        f[name] = numpy.concatenate([more, own])
    state = f["iteration_state"][...]
    del f["iteration_state"], f["iteration"]
    f["iteration_state"] = numpy.concatenate([numpy.full(4000, -1), state])
PY
}

# same_rows MODEL MODEL: checks that rows and control rows are equal, and weights up to the error of streamed modes
same_rows() {
    /usr/bin/python3 - "$@" <<'PY'
import h5py, numpy, sys
a, b = (h5py.File(name) for name in sys.argv[1:])
for name in "selected_row", "control_row", "needed_node":
    assert numpy.array_equal(a[name][...], b[name][...]), (name, a[name][...], b[name][...])
for name in "row_weight", "row_jacobian_modes", "sigma_min_by_exit":
    difference = abs(a[name][...] - b[name][...]).max() / abs(a[name][...]).max()
    print(name, "differ by", difference)
    assert 0 < difference < 1e-6
PY
}

# bats test_tags=slow
@test "within a limit that all fits in, at once and with the same bits" {
    deimselect -q --no-check many.h5 --basis b.h5 --memory 100M -o x.h5
    same_data x.h5 model.h5
    deimselect --no-check many.h5 --basis b.h5 --memory 100M --verbose -f -o x.h5 2>log
    grep -q "4[0-9]* iterations at once, at most [0-9.]* MB of 100 MB" log
}

# bats test_tags=slow
@test "a small limit: the rows, their weights and the control rows are those of all at once" {
    deimselect --no-check many.h5 --basis b.h5 --memory 5M -o x.h5 2>log
    cat log
    grep -q "4[0-9]* iterations of 601 nodes one after the other, .*: at most [0-9.]* MB of 5 MB" log
    same_rows x.h5 model.h5
    deimselect -q --no-check many.h5 --basis b.h5 --memory 5M -o y.h5
    same_data x.h5 y.h5
    /usr/bin/python3 -c "
import h5py
print('row', *h5py.File('model.h5')['selected_row'][...][::-1], sep='\n')" >rows.csv
    for option in "--method qr" "--method sopt" "--method exits --stability 6" "--method qr --stability 3.5" \
        "--control 3" "--rows-from rows.csv"; do
        # shellcheck disable=SC2086
        deimselect -q --no-check many.h5 --basis b.h5 -f $option -o x.h5
        # shellcheck disable=SC2086
        deimselect -q --no-check many.h5 --basis b.h5 -f $option --memory 5M -o y.h5
        same_rows x.h5 y.h5
    done
}

# bats test_tags=slow
@test "a model of streamed residuals is checked as every other" {
    deimselect -q many.h5 --basis b.h5 --memory 5M -o x.h5 || [ $? -eq 4 ]
    romrun --trade --model x.h5 | grep -q "32"
}

# bats test_tags=slow
@test "trajectories, of which the iterations are compressed" {
    moving_scene "x_min: -4, x_max: 2, step: 0.02" "end_time: 0.1, fixed_step: 0.01"
    time_plan train 1 "0.1, 0.15, 0.2"
    snapgen -q train-time.yml -o ts.h5
    podbuild -q ts.h5 -o tb.h5
    snapgen -q train-time.yml --basis tb.h5 -o tr.h5
    deimselect -q --no-check tr.h5 --basis tb.h5 -o a.h5
    least=$(deimselect tr.h5 --basis tb.h5 --memory 1K -o x.h5 2>&1 | sed 's/.*at least \([0-9.]*\) MB.*/\1/')
    deimselect --no-check tr.h5 --basis tb.h5 --memory "${least}M" -o x.h5 2>log
    cat log
    /usr/bin/python3 -c "
import h5py, numpy
a, b = (h5py.File(name)['selected_row'][...] for name in ('a.h5', 'x.h5'))
assert numpy.array_equal(a, b), (a, b)"
}

# bats test_tags=slow
@test "a limit that is too small, or no amount, is one line" {
    refuse 71 "--memory: found 0.01 MB, expected at least [0-9.]* MB for 4[0-9]* iterations on 601 nodes and 32 modes" \
        deimselect many.h5 --basis b.h5 --memory 10K -o x.h5
    least=$(deimselect many.h5 --basis b.h5 --memory 10K -o x.h5 2>&1 | sed 's/.*at least \([0-9.]*\) MB.*/\1/')
    deimselect -q --no-check many.h5 --basis b.h5 --memory "${least}M" -o y.h5
    same_rows y.h5 model.h5
    for amount in 2 G 0M -1G 2g 2GB; do
        refuse 64 "--memory: found $amount, expected a number above 0 and K, M, G or T" \
            deimselect many.h5 --basis b.h5 --memory "$amount" -o x.h5
    done
}

# bats test_tags=slow
@test "more directions than there is memory for, and snapshots that are no numbers, are one line" {
    mix noisy.h5 1e-3
    refuse 71 "noisy.h5: snapshots of the residuals: .*more than [0-9]* directions .*give more of it" \
        deimselect -q noisy.h5 --basis b.h5 --memory 5M -o x.h5
    /usr/bin/python3 -c "
import h5py
with h5py.File('many.h5', 'r+') as f: f['weighted_jacobian_step'][7, 3] = float('nan')"
    refuse 65 "snapshots of the Jacobian products: .*weighted_jacobian_step: found nan" \
        deimselect -q many.h5 --basis b.h5 --memory 5M -o x.h5
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
    libraries=$(peak deimselect -q --check b.h5)
    taken=$(peak deimselect -q --no-check many.h5 --basis b.h5 --memory 5M -o x.h5)
    direct=$(peak deimselect -q --no-check many.h5 --basis b.h5 -f -o x.h5)
    echo "libraries $libraries kB, streamed $taken kB, at once $direct kB"
    # data that is read beside the arrays takes less than 8 MB
    ((taken < libraries + 5000 + 8000))
    ((direct > libraries + 40000))
}

# grid_plan FILE N: writes a plan with N values each of M and L
grid_plan() {
    /usr/bin/python3 - "$@" >"$1" <<'PY'
import numpy, sys
M, L = (", ".join(f"{v:.4f}" for v in numpy.linspace(*ends, int(sys.argv[2]))) for ends in ((8, 15), (2, 6)))
print("groups:\n- scene: base.yml\n  vary: {moes.M: [" + M + "], moes.L: [" + L + "]}")
PY
}

# bats test_tags=slow
@test "residuals are written as they come, in the order of the plan" {
    grid_plan few.yml 5
    snapgen -q few.yml --basis b.h5 --jobs 1 -o one.h5
    snapgen -q few.yml --basis b.h5 --jobs 3 -o three.h5
    same_data one.h5 three.h5
    /usr/bin/python3 -c "
import h5py, numpy
f = h5py.File('three.h5')
state, solved = f['iteration_state'][...], f['status'][...] == 0
assert (numpy.diff(state) >= 0).all() and solved.sum() >= 24
assert numpy.array_equal(numpy.bincount(state, minlength=25), f['newton_iterations'][...] * solved)
assert numpy.array_equal(f['iteration'][...], numpy.arange(len(state)))"
    [ "$VARIANT" = release ] || skip "sanitizers take memory of their own"
    # a file is read again for its digest, a million numbers at a time
    grid_plan more.yml 16
    grid_plan many.yml 32
    few=$(peak snapgen -q more.yml --basis b.h5 --jobs 2 -f -o x.h5)
    many=$(peak snapgen -q many.yml --basis b.h5 --jobs 2 -f -o x.h5)
    iterations=$(/usr/bin/python3 -c "import h5py; print(h5py.File('x.h5')['iteration'].size)")
    echo "few points $few kB, many $many kB, with $iterations iterations of 601 nodes"
    ((iterations * 601 * 16 / 1000 > 60000)) # all iterations in kB
    ((many < few + 12000))
}

# bats test_tags=slow
@test "Ctrl-C and SIGTERM while residuals are streamed leave nothing" {
    for signal in INT TERM; do
        stop_when $signal "says /4[0-9]* residuals" x.h5 deimselect many.h5 --basis b.h5 --memory 5M -o x.h5 2>log
        cat log
        [ "$code" -eq 130 ]
        [ ! -e x.h5 ] && [ ! -e x.h5.partial ]
    done
}
