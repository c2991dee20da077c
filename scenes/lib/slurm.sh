#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs the targets of training.mk as jobs of Slurm. An array of tasks solves the pieces of the training. For each model
# one job then computes the basis, and a further job selects the rows. A job runs make with the rules that apply without
# Slurm. If points are chosen round by round, each round is an array of PIECES tasks, and a job after it evaluates the
# round and chooses the points of the next round.
#
#     slurm.sh run    FOLDER MAKE MAKEFILE SNAPSHOTS OUT MODELS [OPTION...]   submits jobs for missing files and waits
#     slurm.sh rounds FOLDER MAKE MAKEFILE PIECES OUT MODELS [OPTION...]      the same, round by round
#     slurm.sh status FOLDER SNAPGEN                              prints the state of each task of the last call
#     slurm.sh task   ...                                         the command of a job
#
# SNAPSHOTS and MODELS are lists in one argument, PIECES is a number, SNAPGEN is the path of the program, and OPTION are
# further options of sbatch. The script writes to FOLDER
#     jobs        job, name and target of each task
#     NAME.log    log of a task
#     NAME.state  state, exit code and processor time (s) of a task; of rounds only the last one
#     spent       processor time (s) of all tasks that have ended
set -u

fail() {
    echo "slurm.sh: $*" >&2
    exit 1
}

# ---- in a job: task FOLDER NAME MAKEFLAGS MAKE MAKEFILE TARGET...
# Task k of an array has the name NAME-k and makes the k-th target.

task() {
    local folder=$1 name=$2 flags=$3 make=$4 makefile=$5 code=0 state='done' spent
    shift 5
    if [[ -n ${SLURM_ARRAY_TASK_ID-} ]]; then
        name=$name-$SLURM_ARRAY_TASK_ID
        set -- "${@:SLURM_ARRAY_TASK_ID:1}"
    fi
    unset MFLAGS MAKELEVEL
    export MAKEFLAGS=$flags
    echo "running on $(hostname)" >"$folder/$name.state"
    TIMEFORMAT='%U %S'
    exec 3>&1 4>&2
    spent=$({ time "$make" -f "$makefile" SLURM= SPLIT=1 JOBS="${SLURM_CPUS_PER_TASK:-1}" "$@" >&3 2>&4; } 2>&1) || code=$?
    ((code == 0)) || state=failed
    echo "$state $code ${spent//$'\n'/ }" >"$folder/$name.state"
    echo "$name ${spent//$'\n'/ }" >>"$folder/spent"
    exit "$code"
}

# ---- submission

# submit NAME LOG MORE_OPTIONS... -- TARGET...: submits a job and sets `job` to its number.
submit() {
    local name=$1 log=$2 more=()
    shift 2
    while [[ $1 != -- ]]; do
        more+=("$1")
        shift
    done
    shift
    job=$(sbatch --parsable --requeue "${options[@]}" --job-name="$name" --output="$folder/$log.log" --open-mode=append \
        --kill-on-invalid-dep=yes "${more[@]}" "$0" task "$folder" "$name" "$flags" "$make" "$makefile" "$@") ||
        fail "sbatch: found exit code $?, expected a job"
    job=${job%%;*}
}

# submit_array NAME TARGET...: submits an array with a task for each target.
submit_array() {
    local name=$1 number=0 target
    shift
    submit "$name" "$name-%a" --array="1-$#" -- "$@"
    for target; do echo "$job $name-$((++number)) $target" >>"$folder/jobs"; done
}

# submit_one NAME AFTER TARGET: submits a job that starts when the job AFTER has ended, or at once if AFTER is empty.
submit_one() {
    submit "$1" "$1" ${2:+--dependency="afterok:$2"} -- "$3"
    echo "$job $1 $3" >>"$folder/jobs"
}

# Deletes the files of the last call, except the logs.
forget_jobs() { rm -f "$folder"/*.state "$folder/jobs"; }

tell_jobs() { echo "  slurm      ${1-}jobs $(cut -d ' ' -f 1 "$folder/jobs" | uniq | tr '\n' ' ')in $folder; make slurm-status" >&2; }

# submit_models AFTER: submits the two jobs of each model.
submit_models() {
    local model
    for model in $models; do
        submit_one "$model-basis" "$1" "$out/$model-basis.h5"
        submit_one "$model" "$job" "$out/$model.h5"
    done
}

# submit_round OPEN: submits an array of pieces, which solve the OPEN points, and the job `choice`, which chooses the
# next points. In the first round no points are known: OPEN is 0 and there is no array.
submit_round() {
    local number=$(($1 < num_pieces ? $1 : num_pieces)) k targets=()
    for ((k = 1; k <= number; k++)); do targets+=("$out/piece-$k-of-$number.h5"); done
    forget_jobs
    job=
    ((number == 0)) || submit_array piece "${targets[@]}"
    submit_one choice "$job" next-round
}

# ---- waiting

# Prints a line "job task state reason" for each job of the user. Fails if Slurm does not answer.
queue() { squeue --noheader --array --user="$(id -un)" --format='%F %K %T %r'; }

# Returns whether a job of the last call is still in the queue.
is_on() {
    local now
    [[ -e $folder/jobs ]] || return 1
    until now=$(queue); do sleep 10; done
    cut -d ' ' -f 1 "$folder/jobs" | grep -qwf - <(cut -d ' ' -f 1 <<<"$now")
}

wait_for_jobs() {
    local pause=1
    trap 'echo "slurm.sh: the jobs go on; the same command waits for them again, make slurm-status shows them" >&2; exit 130' INT
    while is_on; do
        sleep "$pause"
        ((pause < 10)) && ((pause += 1))
    done
    trap - INT
}

# Prints one line for each failed task, with the last line of its log.
report_failures() {
    local name state code rest
    while read -r _ name _; do
        read -r state code rest 2>/dev/null <"$folder/$name.state" || continue
        case $state in
            failed) echo "slurm.sh: $folder/$name.log: found exit code $code, expected 0: $(cause "$folder/$name.log")" >&2 ;;
            running) echo "slurm.sh: $folder/$name.log: found an end $code $rest without an exit code, expected one" >&2 ;;
        esac
    done <"$folder/jobs"
}

# Prints the last line of a log that is not from make.
cause() { grep -v '^make' "$1" | tail -n 1; }

# begin FOLDER MAKE MAKEFILE LIST OUT MODELS OPTION...: sets the variables and waits for the jobs of an earlier call.
begin() {
    folder=$1 make=$2 makefile=$3 out=$5 models=$6
    options=("${@:7}")
    # the jobs get the variables among make's flags; the other flags are only for this call
    flags=
    [[ " $MAKEFLAGS" != *' -- '* ]] || flags="-- ${MAKEFLAGS#*-- }"
    mkdir -p "$folder" || exit
    wait_for_jobs
}

run() {
    local snapshots
    begin "$@"
    read -ra snapshots <<<"$4"
    are_made && return
    forget_jobs
    rm -f "$folder"/*.log "$folder/spent"
    submit_array snapshots "${snapshots[@]}"
    submit_models "$job"
    tell_jobs
    wait_for_jobs
    end
}

rounds() {
    begin "$@"
    num_pieces=$4
    are_made && return
    rm -f "$folder"/*.log "$folder/spent"
    is_made "$out/snapshots.h5" || train_in_rounds
    forget_jobs
    submit_models ''
    tell_jobs
    wait_for_jobs
    end
}

# The first job `choice` continues the training of an earlier call, or starts a new one.
train_in_rounds() {
    local open=0
    until is_made "$out/snapshots.h5"; do
        submit_round "$open"
        ((open == 0)) || tell_jobs "$open points, "
        wait_for_jobs
        [[ $(cat "$folder/choice.state" 2>/dev/null) == 'done '* ]] || lost
        # the seconds are left out, since they are only those of the job `choice`
        sed -n 's/^snapgen: \(round .*\), [0-9.]* s$/  slurm      \1/p' "$folder/choice.log" | tail -n 1 >&2
        open=$(count_open "$out/snapshots.h5.partial")
    done
}

# Prints the number of points that are chosen but not yet solved.
count_open() { [[ ! -e $1 ]] || "$SNAPGEN" --print "$1" status | awk 'NR > 1 && $1 < 0 { n++ } END { print n + 0 }'; }

end() { are_made || lost; }

lost() {
    report_failures
    fail "$folder: found a training that did not end, expected all of it; the same command goes on with it"
}

# is_made TARGET...: returns whether all targets are up to date.
is_made() { MAKEFLAGS=$flags "$make" -f "$makefile" SLURM= SPLIT=1 --question "$@" >/dev/null 2>&1; }

are_made() {
    local model targets=()
    for model in $models; do targets+=("$out/$model.h5"); done
    is_made "${targets[@]}"
}

# ---- state

status() {
    local folder=$1 snapgen=$2 job name target state now number points left
    [[ -e $folder/jobs ]] || fail "$folder/jobs: found none, expected jobs of make SLURM=1"
    now=$(queue) || exit
    printf '%-10s %-20s %-28s %-14s %s\n' job task state points log
    while read -r job name target; do
        number=N/A
        [[ $name == @(snapshots|piece)-* ]] && number=${name##*-}
        state=$(awk -v job="$job" -v number="$number" '$1 == job && $2 == number { print tolower($3) ($3 == "PENDING" ? " (" $4 ")" : "") }' <<<"$now")
        [[ -n $state ]] || read -r state _ 2>/dev/null <"$folder/$name.state" || state='not run'
        case $state in
            failed) state="failed, exit code $(cut -d ' ' -f 2 "$folder/$name.state")" ;;
            running) [[ $(queue) == *"$job $number "* ]] || state='ended, not finished' ;;
        esac
        points=
        case $name in
            snapshots-* | piece-*) points=$(count_points "$snapgen" "$target") ;;
            choice) points=$(count_points "$snapgen" "${folder%/*}/snapshots.h5") ;;
        esac
        # remaining time, from the last line of progress in the log
        left=
        [[ $state != running* ]] || left=$(grep -o 'stage [0-9]* of [0-9]*.*' "$folder/$name.log" 2>/dev/null | tail -n 1)
        printf '%-10s %-20s %-28s %-14s %s\n' "$job" "$name" "$state" "$points" "$folder/$name.log${left:+  $left}"
    done <"$folder/jobs"
}

count_points() {
    local file=$2
    [[ -e $file ]] || file=$file.partial
    [[ ! -e $file ]] || "$1" --print "$file" status 2>/dev/null | awk 'NR > 1 { n++; done += $1 >= 0 } END { if (n) print done " of " n }'
}

case ${1-} in
    run | rounds | status | task) "$@" ;;
    *) fail "found ${1:-nothing}, expected run, rounds, status or task" ;;
esac
