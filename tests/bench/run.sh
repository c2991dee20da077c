#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs all measurements, one after the other; `make bench` calls it with BIN and BENCH set. The measurements use one
# thread unless stated otherwise. Times are seconds on this machine, so compare only numbers of the same run.
set -eu
: "${BIN:?folder of the programs}" "${BENCH:?folder of the benchmark programs}"
here=$(cd "$(dirname "$0")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0

# seconds COMMAND...: prints "median (least to most) s" of five runs
seconds() {
    for _ in 1 2 3 4 5; do
        local start=$EPOCHREALTIME
        "$@" >/dev/null
        awk -v a="$start" -v b="$EPOCHREALTIME" 'BEGIN { print b - a }'
    done | sort -g | awk '{ t[NR] = $1 } END { printf "%.2f (%.2f to %.2f) s\n", t[3], t[1], t[5] }'
}

section() { printf '\n== %s\n' "$*"; }

# chain PLAN MODES ROWS NAME: computes snapshots, bases, residuals and rows; the model is $work/NAME-model.h5
chain() {
    local plan=$1 modes=$2 rows=$3 name=$work/$4
    "$BIN/snapgen" -q "$plan" -f -o "$name-snapshots.h5"
    "$BIN/podbuild" -q "$name-snapshots.h5" -f -o "$name-basis.h5" --pressure-modes "$modes" >/dev/null
    "$BIN/snapgen" -q "$plan" --basis "$name-basis.h5" -f -o "$name-residuals.h5" >/dev/null
    "$BIN/deimselect" -q --no-check "$name-residuals.h5" --basis "$name-basis.h5" -f -o "$name-model.h5" \
        --rows "$rows" >/dev/null
}

low=$here/scenes/studies/stationary-line
high=$here/scenes/studies/stationary-line-high

section "POD: pod_build against LAPACK dgesdd, 3001 x 1500 to 160 modes (goal: at most 1.3)"
"$BENCH/bench_pod" || failed=1

section "compression: 10000 snapshots of 1201 nodes while they come (goal: 20 s)"
"$BENCH/bench_compress" || failed=1

# BENCH_STREAM="SNAPSHOTS NODES GIGABYTES" makes the test larger; "20000 100000 3.9" needs a file of 16 GB in
# BENCH_FOLDER
section "POD of snapshots one after the other (goal: modes in at most 2.5 times the time of reading and a Gram matrix)"
# shellcheck disable=SC2086
"$BENCH/bench_stream" "${BENCH_FOLDER:-$work}/bench_stream.h5" ${BENCH_STREAM-} || failed=1

section "row selection: 160 of 3001 rows, two bases of 160 (goal: joint at most 0.05 s, sopt about 0.07 s)"
"$BENCH/bench_selection" || failed=1

section "full solve: against the dense Newton (goal: 10 times), growth with n (goal: n^1.3)"
"$BENCH/bench_full" || failed=1

section "full solve of a point contact: in products of 2000 rows (goal: 46 converged, 14.1 to truncation)"
"$BENCH/bench_point" || failed=1

section "full solve of a large point contact (goal: 1025 nodes a side in 60 s and 8 GB)"
"$BENCH/bench_large" 256 1024 || failed=1

section "training: 120 points of the lower loaded region, $(nproc) processors (goal: 20 s)"
chain "$low/plan.yml" 110 176 low
export OPENBLAS_NUM_THREADS=1
echo "full solutions      $(seconds "$BIN/snapgen" -q "$low/plan.yml" -f -o "$work/again.h5")"
echo "bases               $(seconds "$BIN/podbuild" -q "$work/low-snapshots.h5" -f -o "$work/again.h5" --pressure-modes 110)"
echo "residuals           $(seconds "$BIN/snapgen" -q "$low/plan.yml" --basis "$work/low-basis.h5" -f -o "$work/again.h5")"
echo "rows                $(seconds "$BIN/deimselect" -q --no-check "$work/low-residuals.h5" --basis "$work/low-basis.h5" -f -o "$work/again.h5" --rows 176)"

section "opening the model of the demo, median of 31 (goal: a flat one at most 5 ms), load $(cut -d' ' -f1 /proc/loadavg)"
"$BIN/romrun" -q --export "$work/low-model.h5" -o "$work/low-model.ehdrom"
(cd "$work" && "$BENCH/bench_open" low-model.h5 low-model.ehdrom) || failed=1

section "stationary contacts a second by the library: 110 modes on 1201 nodes, 12 modes on 121 nodes"
"$BENCH/bench_solve" "$work/low-model.h5" "$low/scene.yml" 1000 moes.M 10 20
cat >"$work/small.yml" <<'YML'
contact: line
regime: stationary
moes: {M: 12, L: 4}
lubricant: {viscosity: {law: barus, alpha: 2.0e-8}, density: {law: dowson-higginson}}
grid: {x_min: -4, x_max: 2, step: 0.05}
YML
printf 'groups:\n- {scene: small.yml, vary: {moes.M: [8, 9.5, 11, 13, 15], moes.L: [2, 4, 6]}}\n' >"$work/small-plan.yml"
chain "$work/small-plan.yml" 12 24 small
"$BENCH/bench_solve" "$work/small-model.h5" "$work/small.yml" 10000 moes.M 9 14

section "10000 cases in one process: 110 modes on 1201 nodes, 12 modes on 121 nodes"
# grid M0 M1 L0 L1: prints a table of 100 by 100 cases
grid() {
    awk -v m="$1" -v n="$2" -v k="$3" -v l="$4" 'BEGIN {
        print "moes.M,moes.L"
        for (i = 0; i < 100; i++) for (j = 0; j < 100; j++) print m + (n - m) * i / 99 "," k + (l - k) * j / 99 }'
}
# solve_cases NAME SCENE: prints the time of NAME-cases.csv with NAME-model.h5
solve_cases() {
    local TIMEFORMAT="%U s of processor time and %S s of the system's, %R s passed"
    time "$BIN/romrun" -q "$2" --cases "$work/$1-cases.csv" --model "$work/$1-model.h5" --jobs 1 \
        --allow-untrusted -f -o "$work/$1-table.csv"
    [ "$(wc -l <"$work/$1-table.csv")" -eq 10001 ]
}
grid 10 40 5 15 >"$work/low-cases.csv"
solve_cases low "$low/scene.yml" 2>&1 || failed=1
grid 8 15 2 6 >"$work/small-cases.csv"
solve_cases small "$work/small.yml" 2>&1 || failed=1

section "least squares against a product of the same size (goal: a third of its rate)"
for size in "177 111" "161 101" "131 85"; do
    "$BENCH/bench_least_squares" $size || failed=1
done

# cases FOLDER NAME TOLERANCE MODES ROWS: prints one line for each of the published cases
cases() {
    tail -n +2 "$1/cases.csv" | while IFS=, read -r _ lubricant M L p_H _; do
        printf '%s ' "$lubricant"
        "$BENCH/bench_online" "$work/$2-model.h5" "$1/scene.yml" 101 "$3" "$4" "$5" moes.M="$M" moes.L="$L" \
            hertz_pressure="$p_H" lubricant.viscosity.preset="$lubricant"
    done | tee "$work/cases"
    awk -F', ' '{ split($2, word, " "); sum += word[1]; split($0, time, "iterations: "); split(time[2], ms, " ")
                  slowest = ms[1] > slowest ? ms[1] : slowest }
                END { printf "slowest %.3f ms, %.2f iterations in the mean\n", slowest, sum / NR }' "$work/cases"
}

chain "$high/plan.yml" 100 160 high
section "online solve, model open, fully converged (goal: 1 ms for the slowest), 110 modes and 176 rows"
cases "$low" low 1e-8 0 0
section "the same in the higher loaded region, 100 modes and 160 rows"
cases "$high" high 1e-8 0 0
section "as converged as 1 permille asks for (goal: 0.4 ms, 4 iterations in the mean), 93 modes and 160 rows"
cases "$low" low 2e-5 93 160
section "the same in the higher loaded region, 84 modes and 130 rows"
cases "$high" high 2e-5 84 130

section "all online instructions of one scene, n = 4801 against n = 1201 (goal: within 20 %)"
# The training is so dense that both models are accurate. They have the same sizes, start and iterations, and
# their exits are at the same place. Deviations from the full model are printed as evidence.
for step in 0.005 0.00125; do
    name=step-$step
    cat >"$work/$name.yml" <<YML
contact: line
regime: stationary
discretization: published
moes: {M: 18.5, L: 8.2}
lubricant: {viscosity: {law: wlf, preset: no1}, density: {law: dowson-higginson}}
grid: {step: $step}
YML
    cat >"$work/$name-plan.yml" <<YML
groups:
  - scene: $name.yml
    vary: {moes.M: [17, 18, 19, 20, 21, 22, 23, 24], moes.L: [7, 7.5, 8, 8.5, 9, 9.5, 10, 10.5, 11]}
YML
    chain "$work/$name-plan.yml" 60 120 "$name"
    "$BIN/fullrun" -q "$work/$name.yml" -o "$work/$name-full.h5" >"$work/log"
    "$BIN/romrun" -q --allow-untrusted "$work/$name.yml" --model "$work/$name-model.h5" \
        --against "$work/$name-full.h5" >"$work/log"
    grep 'central film.*against' "$work/log"
    valgrind --tool=callgrind --callgrind-out-file="$work/callgrind" \
        --toggle-collect=reduced_solve "$BENCH/bench_online" "$work/$name-model.h5" \
        "$work/$name.yml" 0 1e-8 0 0 2>"$work/$name-valgrind"
    awk '/Collected/ { print $NF }' "$work/$name-valgrind" >>"$work/counts"
done
paste -s "$work/counts" | awk '{
    printf "%d against %d instructions: %+.1f %%\n", $2, $1, ($2 / $1 - 1) * 100
    exit $2 > 1.2 * $1 }' || failed=1

# Transient: a model of one trajectory, which is trained and run with the same fixed steps on both grids.
section "in time: instructions a step at n = 4801 against 1201, same sizes (goal: within 20 %)"
: >"$work/counts"
for step in 0.005 0.00125; do
    name=time-$step
    cat >"$work/$name.yml" <<YML
contact: line
regime: transient
discretization: published
moes: {M: 120, L: 10}
lubricant: {viscosity: {law: barus, alpha: 22e-9}}
grid: {step: $step}
transient: {load: {law: sine, amplitude: 0.1, period: 1}, end_time: 0.5, fixed_step: 0.005}
YML
    chain "$work/$name.yml" 40 65 "$name"
    valgrind --tool=callgrind --callgrind-out-file="$work/callgrind" --toggle-collect=march_run \
        "$BIN/romrun" -q --allow-untrusted "$work/$name.yml" --model "$work/$name-model.h5" >"$work/log" 2>"$work/$name-valgrind"
    # leaves out the writing of results, whose share grows on a slow machine
    callgrind_annotate --inclusive=yes "$work/callgrind" 2>"$work/log" | awk '{ gsub(",", "") } /:march_run \[/ { all = $1 }
        /:store \[/ { written = $1 } END { print all - written }' >>"$work/counts"
done
paste -s "$work/counts" | awk '{
    printf "%d against %d instructions: %+.1f %%\n", $2, $1, ($2 / $1 - 1) * 100
    exit $2 > 1.2 * $1 }' || failed=1

section "contacts in time by the library: two threads of the program against one, on two cores (goal: 1.9 times), load $(cut -d' ' -f1 /proc/loadavg)"
"$BENCH/bench_many" "$work/time-0.005-model.h5" "$work/time-0.005.yml" 100 8 7 || failed=1
exit $failed
