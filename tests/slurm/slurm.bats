#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Training on Slurm: make SLURM=1 (scenes/lib). Inside of with-slurm.sh.

load ../pipeline/common

# A pipeline of its own: 48 points on a coarse grid, about two seconds.
setup() {
    cd "$BATS_TEST_TMPDIR" || return
    common_setup_small
    export OPENBLAS_NUM_THREADS=1
    cp -r "$BATS_TEST_DIRNAME/../../scenes/lib" .
    echo 'include lib/training.mk' >Makefile
    sed -i 's/step: 0.05/step: 0.005/' scene.yml
    cat >plan.yml <<'YAML'
groups:
  - scene: scene.yml
    vary: {moes.M: [8, 9, 10, 11, 12, 13, 14, 15], moes.L: [2, 3, 4, 5, 6, 7]}
YAML
}

teardown() {
    squeue --noheader --format=%A | xargs -r scancel --full --signal=KILL || true
    until_true no_job
}

no_job() { [ -z "$(squeue --noheader)" ]; }

# Half of the points, on a grid that takes ten times as long; the model is not checked, which takes longest there.
slowly() {
    echo 'model.CHECK = no' >>Makefile
    sed -i 's/step: 0.005/step: 0.0005/' scene.yml
    sed -i 's/8, 9, 10, 11, 12, 13, 14, 15/8, 10, 12, 14/' plan.yml
}

on_slurm() { make SLURM=1 "$@"; }

# until_true COMMAND...: waits until the command succeeds, at most five minutes
until_true() {
    local try
    for ((try = 0; try < 3000; try++)); do
        "$@" && return
        sleep 0.1
    done
    echo "found no end of: $*"
    return 1
}

# done_in FILE: prints how many points of FILE are solved
done_in() { snapgen --print "$1" status 2>/dev/null | awk 'NR > 1 && $1 >= 0 { n++ } END { print n + 0 }'; }

# program_of FILE: prints the process that makes this file of this test
program_of() {
    local process
    for process in $(pgrep -x snapgen); do
        [ "$(readlink "/proc/$process/cwd")" = "$PWD" ] &&
            tr '\0' '\n' <"/proc/$process/cmdline" | grep -qxF "$1" && echo "$process"
    done
}

# hold FILE: halts the process that makes it, so that it solves no more points while this test looks; it can still be
# killed
hold() { kill -STOP "$(program_of "$1")"; }

# spent STATE...: prints the processor time of tasks in seconds
spent() { awk '{ s += $3 + $4 } END { print s }' "$@"; }

@test "four tasks give the bits of one run, with as much work" {
    # the work of one run: its iterations, as many at each point
    TIMEFORMAT='%U %S'
    { time snapgen plan.yml -o whole.h5 --jobs 2 >/dev/null 2>&1; } 2>time.txt
    make >/dev/null
    run on_slurm OUT=array
    echo "$output"
    [ "$status" -eq 0 ]
    for file in model-basis model-residuals model; do same_data out/$file.h5 array/$file.h5; done
    same_data whole.h5 out/snapshots.h5
    /usr/bin/python3 - <<'PYTHON'
import h5py, numpy
parts = [h5py.File(f"array/snapshots-{k}-of-4.h5") for k in (1, 2, 3, 4)]
with h5py.File("out/snapshots.h5") as whole:
    assert [len(part["status"]) for part in parts] == [12] * 4
    for name in "pressure", "film_thickness", "newton_iterations":
        assert numpy.concatenate([part[name] for part in parts]).tobytes() == whole[name][...].tobytes(), name
PYTHON
    echo "# seconds of processor: $(spent array/slurm/snapshots-*.state) in four tasks with make, \
$(awk '{ print $1 + $2 }' time.txt) with --jobs 2" >&3

    # nothing is left to do: no job is added, and make without Slurm runs no program
    before=$(cat array/slurm/jobs)
    run on_slurm OUT=array
    [ "$status" -eq 0 ]
    [ "$(cat array/slurm/jobs)" = "$before" ]
    run make OUT=array
    [ "$status" -eq 0 ]
    [[ ! $output =~ (snapgen|podbuild|deimselect) ]]
    run make slurm-status OUT=array
    echo "$output"
    [ "$(grep -c ' done ' <<<"$output")" -eq 6 ]
    [ "$(grep -c '12 of 12' <<<"$output")" -eq 4 ]
}

@test "a requeued task goes on, and solves no point twice" {
    slowly
    on_slurm SBATCH_OPTIONS='--comment=mine --job-name=taken-from-make' >make.txt 2>&1 &
    pid=$!
    some_points() { [ "$(done_in out/snapshots-2-of-4.h5.partial)" -ge 2 ]; }
    until_true some_points
    hold out/snapshots-2-of-4.h5
    job=$(awk '$2 == "snapshots-2" { print $1 }' out/slurm/jobs)
    [[ $(scontrol show job "${job}_2") == *"Comment=mine"* ]]
    run make slurm-status
    echo "$output"
    [[ $output =~ "snapshots-2 "\ *"running "\ *[0-9]+" of 6" ]]
    [[ $output =~ "model "\ *"pending (Dependency)" ]]
    scontrol requeue "${job}_2"
    # the halted task is killed, so nothing is written meanwhile
    pending() { [ "$(squeue --noheader --array --jobs="$job" --format='%K %T' | grep '^2 ')" = "2 PENDING" ]; }
    until_true pending
    before=$(done_in out/snapshots-2-of-4.h5.partial)
    echo "done before: $before"
    ((before >= 2 && before < 6))
    wait $pid
    cat out/slurm/snapshots-2.log
    # the log has the points that were found, and the number of those left to do
    grep -q "snapshots-2-of-4.h5.partial: $before of 6 points are done" out/slurm/snapshots-2.log
    grep -q "^snapgen: $((6 - before))/$((6 - before)) " out/slurm/snapshots-2.log
    [ "$(done_in out/snapshots-2-of-4.h5)" -eq 6 ]
    snapgen plan.yml --shard 2/4 -o once.h5 --quiet
    same_data once.h5 out/snapshots-2-of-4.h5
}

@test "a failed task stops what follows, make says where, and goes on when it is called again" {
    echo 'model.CHECK = no' >>Makefile
    # points without a solution in the last quarter
    sed -i 's/14, 15/14, 0.2/' plan.yml
    run on_slurm SET='--set grid.x_max=1.2'
    echo "$output"
    [ "$status" -ne 0 ]
    [[ $output == *"slurm.sh: out/slurm/snapshots-4.log: found exit code 2, expected 0: snapgen: plan.yml: found "*" of 12 points not converged"* ]]
    [ "$(grep -c '^slurm.sh: out/slurm/' <<<"$output")" -eq 1 ]
    [ ! -e out/model-basis.h5 ]
    [ -e out/snapshots-1-of-4.h5 ]
    no_job
    run make slurm-status
    echo "$output"
    [[ $output =~ "snapshots-4 "\ *"failed, exit code 2" ]]
    [[ $output =~ "model-basis "\ *"not run" ]]

    # a task that is killed
    sed -i 's/14, 0.2/14, 15/' plan.yml
    sed -i 's/step: 0.005/step: 0.001/' scene.yml
    on_slurm >make.txt 2>&1 &
    pid=$!
    some_points() { [ "$(done_in out/snapshots-4-of-4.h5.partial)" -ge 1 ]; }
    until_true some_points
    kill -KILL "$(program_of out/snapshots-4-of-4.h5)"
    ! wait $pid || false
    cat make.txt
    grep -q 'slurm.sh: out/slurm/snapshots-4.log: found exit code' make.txt
    before=$(done_in out/snapshots-4-of-4.h5.partial)
    [ "$before" -ge 1 ]
    run on_slurm
    echo "$output"
    [ "$status" -eq 0 ]
    grep -q "snapshots-4-of-4.h5.partial: $before of 12 points are done" out/slurm/snapshots-4.log
}

@test "an interrupted make leaves its jobs, and the next one waits for them" {
    slowly
    on_slurm SHARDS=2 >make.txt 2>&1 &
    pid=$!
    some_points() { [ "$(done_in out/snapshots-2-of-2.h5.partial)" -ge 1 ]; }
    until_true some_points
    kill -KILL $pid
    jobs=$(cat out/slurm/jobs)
    run on_slurm # in two pieces, as before
    echo "$output"
    [ "$status" -eq 0 ]
    [ "$(cat out/slurm/jobs)" = "$jobs" ]
    [ "$(grep -c 'points are done' out/slurm/snapshots-2.log)" -eq 0 ]
}

# A region in which points are chosen in three rounds, 20 points in the first.
small_region() {
    cat >plan.yml <<'YAML'
groups:
  - scene: scene.yml
    region: {moes.M: [8, 14], moes.L: [2, 5]}
YAML
    echo 'ACCURACY = 1e-2' >>Makefile
}

# same_training A B: like same_data, except for the times at which rounds were judged
same_training() {
    /usr/bin/python3 - "$1" "$2" <<'PYTHON'
import sys, h5py
with h5py.File(sys.argv[1]) as left, h5py.File(sys.argv[2]) as right:
    assert set(left) == set(right), set(left) ^ set(right)
    for name in set(left) - {"round_seconds"}:
        assert left[name][...].tobytes() == right[name][...].tobytes(), name
PYTHON
}

@test "a region is trained in rounds of arrays, with the bits of one run and as much work" {
    small_region
    sed -i 's/step: 0.005/step: 0.001/' scene.yml
    TIMEFORMAT='%U %S'
    { time snapgen plan.yml --accuracy 1e-2 -o whole.h5 --jobs 2 >/dev/null 2>&1; } 2>time.txt
    run on_slurm OUT=array
    echo "$output"
    [ "$status" -eq 0 ]
    same_training whole.h5 array/snapshots.h5
    [ "$(cut -d ' ' -f 2 array/slurm/jobs | tr '\n' ' ')" = "model-basis model " ]
    rounds=$(grep -c '^  slurm      round [0-9]*: [0-9]* points' <<<"$output")
    [ "$rounds" -eq "$(snapgen --print whole.h5 round | sed 1d | wc -l)" ]
    # each piece was solved once, at most four pieces in a round, and no piece is left
    pieces=$(awk '$1 == "slurm" && $3 == "points," { n += $2 < 4 ? $2 : 4 } END { print n }' <<<"$output")
    [ "$(grep -c '^piece-' array/slurm/spent)" -eq "$pieces" ]
    [ "$(grep -c '^choice ' array/slurm/spent)" -eq $((rounds + 1)) ]
    [ -z "$(find array -name 'piece*.h5*')" ]
    echo "# seconds of processor: $(awk '/^(piece|choice)/ { s += $2 + $3 } END { print s }' array/slurm/spent) in \
$rounds rounds of four tasks with make, $(awk '{ print $1 + $2 }' time.txt) with --jobs 2" >&3

    # nothing is left to do: no job is added, and make without Slurm runs no program
    before=$(cat array/slurm/jobs)
    run on_slurm OUT=array
    [ "$status" -eq 0 ]
    [ "$(cat array/slurm/jobs)" = "$before" ]
    run make OUT=array
    [ "$status" -eq 0 ]
    [[ ! $output =~ (snapgen|podbuild|deimselect) ]]

    # another plan begins anew; with SHARDS=1 one task does all the work
    sed -i 's/14/13/' plan.yml
    run on_slurm OUT=array SHARDS=1
    [ "$status" -eq 0 ]
    [ "$(grep -c snapshots array/slurm/jobs)" -eq 1 ]
}

@test "tasks of a round are killed and requeued: nothing is solved twice, the bits are those of one run" {
    small_region
    echo 'model.CHECK = no' >>Makefile
    sed -i 's/step: 0.005/step: 0.0005/' scene.yml
    on_slurm SHARDS=2 >make.txt 2>&1 &
    pid=$!
    some_points() { [ "$(done_in "out/piece-$1-of-2.h5.partial")" -ge 1 ]; }
    until_true some_points 1
    kill -KILL "$(program_of out/piece-1-of-2.h5)"
    until_true some_points 2
    hold out/piece-2-of-2.h5
    run make slurm-status
    echo "$output"
    [[ $output =~ "piece-2 "\ *"running "\ *[0-9]+" of 10 "\ *"out/slurm/piece-2.log  stage 1 of 4" ]]
    job=$(awk '$2 == "piece-2" { print $1 }' out/slurm/jobs)
    scontrol requeue "${job}_2"
    pending() { [ "$(squeue --noheader --array --jobs="$job" --format='%K %T' | grep '^2 ')" = "2 PENDING" ]; }
    until_true pending
    run make slurm-status
    echo "$output"
    [[ $output =~ "piece-2 "\ *"pending ("[A-Za-z]*") "\ *[0-9]+" of 10" ]]
    [[ $output =~ "choice "\ *"not run "\ *"0 of 20" ]] || [[ $output =~ "choice "\ *"pending (Dependency) "\ *"0 of 20" ]]
    killed=$(done_in out/piece-1-of-2.h5.partial)
    before=$(done_in out/piece-2-of-2.h5.partial)
    echo "done before: $killed, $before"
    ((killed >= 1 && killed < 10 && before >= 1 && before < 10))
    ! wait $pid || false
    cat make.txt
    grep -q 'slurm.sh: out/slurm/piece-1.log: found exit code' make.txt
    grep -q "piece-2-of-2.h5.partial: $before of 10 points are done" out/slurm/piece-2.log
    grep -q "^snapgen: $((10 - before))/$((10 - before)) " out/slurm/piece-2.log
    [ ! -e out/snapshots.h5 ]
    run on_slurm SHARDS=2
    echo "$output"
    [ "$status" -eq 0 ]
    # the points of the killed task are among these
    grep -q "^round 1: $((10 - killed)) points are to be solved, after $((10 + killed))" out/slurm/choice.log
    snapgen plan.yml --accuracy 1e-2 -o whole.h5 --jobs 2 --quiet
    same_training whole.h5 out/snapshots.h5
}
