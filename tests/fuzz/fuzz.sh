#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Fuzzes a target for some seconds and prints a summary on one line. New inputs stay in build/found/TARGET, from which
# the next run continues. Failures are stored as build/crashes/TARGET-..., beside the log.
#
#     tests/fuzz/fuzz.sh LIBFUZZER TARGET SECONDS
set -u

fuzzer=$(realpath "$1") target=$2 seconds=$3
here=$(dirname "$(realpath "$0")")
build=$here/../../build
mkdir -p "$build/found/$target" "$build/crashes"
found=$(realpath "$build/found/$target") crashes=$(realpath "$build/crashes")
log=$crashes/$target.log
case $target in
scene) seeds=$(find "$here/../../scenes" -name '*scene*.yml') ;;
plan) seeds=$(find "$here/../../scenes" -name '*plan*.yml') ;;
*) seeds= ;;
esac
for seed in $seeds; do cp "$seed" "$found/$(cksum <"$seed" | tr ' ' -)"; done
corpus=$here/corpus/$target
[[ -d $corpus ]] || corpus=

count() { find "$crashes" -name "$target-*-*" ! -name "*-slow-unit-*" | wc -l; } # slow units depend on the load of the machine
before=$(count)
TARGET=$target "$here/with-bases.sh" nice "$fuzzer" -max_total_time="$seconds" -close_fd_mask=3 -print_final_stats=1 \
    -detect_leaks=0 -max_len=4096 -timeout=120 -rss_limit_mb=4096 -malloc_limit_mb=100000 -report_slow_units=60 -artifact_prefix="$crashes/$target-" \
    "$found" ${corpus:+"$corpus"} >"$log" 2>&1
code=$?
awk -v target="$target" -v crashes="$(($(count) - before))" '
    /^#[0-9]+\t/ { for (i = 1; i < NF; i++) if ($i == "cov:") edges = $(i + 1) }
    /number_of_executed_units/ { runs = $2 }
    /^Done/ { seconds = $5 }
    END { printf "%-18s %9d executions, %5d s, %5d edges, %d failures\n", target, runs, seconds, edges, crashes }' "$log"
((code == 0)) || echo "see $log" >&2
exit $code
