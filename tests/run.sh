#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs test programs (cmocka or bats), JOBS at a time, shows what failed, and ends with the line
# "N passed, N failed" over all test cases. Fails also when nothing was run.
#
#     tests/run.sh LOG_FOLDER TEST...
#
# FILTER: of pipelines only the tests whose names match it.
# CHECK_ALL: empty: pipelines leave out the tests with the tag "slow", and unit tests many cases (check.h). slow: pipelines
# run only these tests, and unit tests all cases. Any other text: all tests, all cases.
set -u

# Runs one test: its TAP output goes to LOG_FOLDER/NAME.tap, its counts to LOG_FOLDER/NAME.count, and
# to stdout what failed. A crash, a sanitizer's report, a hang or a wrong number of cases is a failed
# case too. TIMEOUT (seconds) only ends a test that hangs, so it leaves room for a busy machine.
run_one() {
    local logs=$1 test=$2 name log code command passed failed planned skipped trouble=''
    name=$(basename "$test")
    log=$logs/$name.tap
    command=("$test")
    if [[ $test == *.bats ]]; then
        command=(bats --tap --timing ${FILTER:+--filter "$FILTER"})
        [[ ${CHECK_ALL-} ]] || command+=(--filter-tags '!slow')
        [[ ${CHECK_ALL-} == slow ]] && command+=(--filter-tags slow)
        command+=("$test")
    fi

    CMOCKA_MESSAGE_OUTPUT=TAP timeout "${TIMEOUT:-3600}" "${command[@]}" >"$log" 2>&1 </dev/null
    code=$?

    passed=$(grep -ciE '^ok [0-9]+' "$log")
    failed=$(grep -cE '^not ok [0-9]+' "$log")
    skipped=$(grep -ciE '^(not )?ok [0-9]+.* # skip' "$log")
    planned=$(sed -n 's/^1\.\.\([0-9]*\).*/\1/p' "$log" | paste -sd +) # cmocka prints a plan for each group
    if ((passed + failed != ${planned:-0})) || [[ -z $planned ]]; then
        trouble="ran $((passed + failed)) of ${planned:-unknown} cases"
    elif ((code != 0 && failed == 0)); then
        trouble="all cases passed"
    fi
    # cmocka calls a skipped case "not ok", bats "ok"; it is neither
    ((passed -= $(grep -ciE '^ok [0-9]+.* # skip' "$log")))
    ((failed -= $(grep -ciE '^not ok [0-9]+.* # skip' "$log")))
    [[ -n $trouble ]] && ((failed += 1))
    echo "$passed $failed" >"$logs/$name.count"

    if ((failed)); then
        printf '%s\n' "---- $test${trouble:+: $trouble, exit code $code}" \
            "$(if [[ -n $trouble ]]; then tail -n 60 "$log"; else grep -vE '^(ok |1\.\.)' "$log"; fi)"
    elif [[ ${V:-0} != 0 ]]; then
        echo "$test: $passed passed"
    fi
    ((skipped == 0)) || echo "$test: $skipped skipped"
}

if [[ ${1-} == --one ]]; then
    unset JOBS # of the tests, not of the pipelines that they run
    # options such as -k are not passed on either; variables such as CC are
    [[ ${MAKEFLAGS-} =~ ^[a-zA-Z]+ ]] && export MAKEFLAGS=${MAKEFLAGS#"${BASH_REMATCH[0]}"}
    run_one "$2" "$3"
    exit 0
fi

logs=$1
shift
rm -rf "$logs"
mkdir -p "$logs"
export OPENBLAS_NUM_THREADS=1
# the largest files first, so that no long test runs alone at the end
# shellcheck disable=SC2011 # names of any kind are separated by zero bytes
(($# == 0)) || ls -S --zero -- "$@" | xargs -0 -n 1 -P "${JOBS:-2}" "$0" --one "$logs"

passed=0 failed=0
for test in "$@"; do
    count='0 1'
    [[ -f $logs/$(basename "$test").count ]] && count=$(<"$logs/$(basename "$test").count")
    ((passed += ${count% *}, failed += ${count#* }))
done
echo "$passed passed, $failed failed"
((passed > 0 && failed == 0))
