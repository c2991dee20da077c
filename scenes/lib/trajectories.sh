#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The numbers of a model's runs and of the full ones, a line each:
#     run STEPS PERIOD KIND CODE STEPS REJECTED NEWTON SECONDS
#     deviation STEPS PERIOD KIND dP_c T dH_c T TIMES       in per cent of the full run; of the full run
#                                                           itself: its deviation at a tenth of the tolerance
#     trajectories.sh FOLDER MODEL "STEPS..." PERIOD...      STEPS: adaptive, fixed
set -eu
folder=$1 model=$2 kinds=$3
shift 3
shared=$(dirname "$0")

# numbers STEPS PERIOD KIND
numbers() {
    awk -v run="$1 $2 $3" 'NR == 1 { print "run", run, $3, $5, $7, $9, $11 }' \
        "$folder/$3/$1-$2.dat"
}

# deviation STEPS PERIOD KIND OTHER RUN
deviation() {
    echo "deviation $1 $2 $3 $(awk -f "$shared/common.awk" -f "$shared/deviation.awk" -v largest=1 "$folder/$4.dat" "$folder/$5.dat")"
}

for period in "$@"; do
    for steps in $kinds; do
        numbers $steps "$period" full
        numbers $steps "$period" "$model"
        deviation $steps "$period" "$model" "full/$steps-$period" "$model/$steps-$period"
    done
    deviation tenth "$period" full "full/tenth-$period" "full/adaptive-$period"
done
