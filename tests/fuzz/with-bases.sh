#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs a command in a temporary folder with small valid files of every kind, from which the targets (target.c) start.
# The folder is in memory if the system has a file system in memory. BIN is the folder of the programs.
#
#     tests/fuzz/with-bases.sh COMMAND...
set -eu

memory=/dev/shm
[[ -w $memory ]] || memory=${TMPDIR:-/tmp}
folder=$(mktemp -d "$memory/ehdrom-fuzz-XXXXXX")
trap 'rm -rf "$folder"' EXIT
cd "$folder"
export PATH=$BIN:$PATH OPENBLAS_NUM_THREADS=1

# the grids are too coarse for an error estimate, so scenes leave it out
stationary='regime: stationary
output: {resolution: false}'
lubricant='lubricant: {viscosity: {law: barus, alpha: 2.0e-8}, density: {law: dowson-higginson}}'
line="contact: line
$lubricant
grid: {x_min: -4, x_max: 2, step: 0.1}"
point="contact: point
$lubricant
grid: {x_min: -2, x_max: 1.5, y_max: 1.5, step: 0.25}
$stationary"
history='transient: {load: {law: sine, amplitude: 0.1, period: 1}, end_time: 0.06, fixed_step: 0.02}'
fixed='moes: {M: 12, L: 4}'

printf '%s\n' "$line" "$stationary" "$fixed" >line.yml
printf '%s\n' "$line" 'regime: transient' "$fixed" "$history" >time.yml
printf '%s\n' "$point" "$fixed" >point.yml
# scenes with a table of the load, from work.h5 or work.csv
sed 's/load: {.*}, end/load: {law: table, file: FILE, column: load}, end/' time.yml >table.yml
sed 's/FILE/work.h5/' table.yml >table-h5.yml
sed 's/FILE/work.csv/' table.yml >table-csv.yml

for scene in line point; do
    printf 'groups:\n- {scene: %s.yml, vary: {moes.M: [8, 12, 15], moes.L: [2, 4, 6]}}\n' $scene >$scene-plan.yml
done
cp line-plan.yml still-plan.yml
printf -- '- {scene: time.yml}\n' >>line-plan.yml
printf 'groups:\n- {scene: line.yml, points: work.csv}\n' >csv-plan.yml
printf 'groups:\n- {scene: line.yml, vary: {moes.M: [9.5, 13]}}\n' >small-plan.yml
printf 'groups:\n- {scene: line.yml, vary: {moes.M: [8, 9, 11, 13, 15], moes.L: [2, 3, 4, 5, 6]}}\n' >wide-plan.yml

# cases.csv has more rows than romrun writes at once
{
    echo moes.M
    seq -f 1%.3f 0 0.005 5
} >cases.csv

chain() { # NAME SCENE PODBUILD_OPTION...
    local name=$1 plan=$2-plan.yml
    shift 2
    snapgen $plan -q -o s-$name.h5
    podbuild s-$name.h5 -q -o b-$name.h5 "$@"
    snapgen $plan -q --basis b-$name.h5 -o r-$name.h5
    # with so few training points deimselect prints a warning
    deimselect r-$name.h5 -q --basis b-$name.h5 -o m-$name.h5
}
{
    chain line line
    chain both line --deformation independent --pressure-modes 12 --deformation-modes 10
    chain point point
    for name in line point; do podbuild --compress s-$name.h5 -q -o p-$name.h5; done
    for name in line both point; do romrun --export m-$name.h5 -o m-$name.ehdrom; done
    romrun --export m-line.h5 --pressure-modes 9 --rows 20 -o m-small.ehdrom
    for scene in line time point; do fullrun $scene.yml -q -o f-$scene.h5; done
    snapgen small-plan.yml -q -o s-small.h5
    # writes the same values as another program may write them, without our attributes; such files are also faster to
    # read
    /usr/bin/python3 - <<'PYTHON'
import glob, h5py
OWN = ("history", "creator", "title", "Conventions", "complete", "input_", "basis_sha256", "content_sha256")
for path in glob.glob("[sbrmfp]-*.h5"):
    with h5py.File(path) as own, h5py.File("x" + path, "w") as foreign:
        for name, value in own.attrs.items():
            if not name.startswith(OWN):
                foreign.attrs[name] = value
        for name, dataset in own.items():
            if "CLASS" not in dataset.attrs or dataset.dtype.kind == "f":
                foreign[name] = dataset[...]
PYTHON
} >bases.log 2>&1 || { cat bases.log >&2; exit 1; }

"$@"
