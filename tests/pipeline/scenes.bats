#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests of the paper's pipelines at a small size: a copied folder works under any name, only outdated files are made
# again, and the tables and pictures exist.

load common

# Copies the study with one lubricant and a plan that covers its cases.
small_low() {
    copy_scene studies/stationary-line
    sed -i -e 's/moes.M: .*/moes.M: [10, 12, 15, 17, 20]/' -e 's/moes.L: .*/moes.L: [11, 12, 13, 15]/' plan.yml
    sed -i -n '1,3p' cases.csv
    sed -i 's/^PROFILES .*/PROFILES = no1-M17-L15-p1.04/' Makefile
}

small_high() {
    copy_scene studies/stationary-line-high
    awk -F, 'NR == 1 || ($1 >= 77 && $1 <= 118 && $2 >= 7 && $2 <= 15)' points.csv >few.csv
    mv few.csv points.csv
    sed -i '/^define lubricants/,/^endef/s/moes.M: .*/moes.M: [85, 95, 108], moes.L: [8, 10, 12]}/' Makefile
    sed -i -n '1,2p' cases.csv
    sed -i -e 's/^PROFILES .*/PROFILES = no1-M100-L10-p1.69/' Makefile
}

setup() { unset MAKEFLAGS MAKELEVEL MFLAGS V; }

# python TEXT: runs the text with the modules that scripts of the scenes share.
python() { BIN=$BIN PYTHONPATH=$BATS_TEST_DIRNAME/../../scenes/lib /usr/bin/python3 -B -c "import os, numpy, results
$1"; }

# makes PATTERN: checks that the commands that make would run match; makes_nothing: that make would run no program.
makes() {
    run_make -n models demo
    [[ $status == 0 && $output =~ $1 ]] || { echo "expected $1 in: $output"; return 1; }
}
makes_nothing() {
    run_make -n models demo figures "$@"
    [[ $status == 0 && ! $output =~ bin/$programs && ! $output =~ published.py\ point ]] || { echo "expected no program in: $output"; return 1; }
}

# bats test_tags=slow
@test "the lower loaded region: demo and figures, and then nothing is left to do" {
    small_low
    run_make demo
    [ "$status" -eq 0 ]
    [[ $output == *"301 nodes"*"no1-M12"*"published"*"worst deviation: "* ]]
    [[ ! $output =~ nan|"no result"|"not converged" ]]
    awk -v deviation="$(sed -n 's/^worst deviation: \([0-9.]*\) .*/\1/p' <<<"$output")" \
        'BEGIN { exit !(deviation > 0 && deviation < 20) }'
    [ "$(head -c 4 out/profiles.png | tail -c 3)" = PNG ]
    grep -q '</svg>' out/profiles.svg

    run_make figures
    [ "$status" -eq 0 ]
    for table in 'Table 2' 'Table 3' 'Table 4' model-paper published; do grep -q "$table" out/tables.txt; done
    [ "$(grep -c '^no1 ' out/tables.txt)" -eq 6 ]
    [ "$(head -c 4 out/figure3.png | tail -c 3)" = PNG ]
    [ "$(cat out/figure3-*.txt | grep -c '^\(coupled\|independent\) ')" -eq 4 ]
    makes_nothing
}

# bats test_tags=slow
@test "the higher loaded region: demo, with its points from a file" {
    small_high
    run_make demo
    [ "$status" -eq 0 ]
    [[ $output == *"301 nodes"*"worst deviation: "*" permille"* ]]
    [[ ! $output =~ nan|"no result" ]]
    [ -s out/profiles.png ]
}

# bats test_tags=slow
@test "only what a change touches is made again" {
    small_low
    run_make models demo figures FIGURE3_CASE=
    [ "$status" -eq 0 ]
    makes_nothing FIGURE3_CASE=

    touch plan.yml
    makes "snapgen plan.yml -o out/snapshots.h5"
    touch -d '1 hour ago' plan.yml

    touch out/model-basis.h5
    makes "deimselect out/model-residuals.h5"
    [[ ! $output =~ "bin/fullrun scene.yml" && ! $output =~ "out/snapshots.h5 --force" && ! $output =~ "bin/podbuild" ]]
    run_make models demo
    [ "$status" -eq 0 ]

    touch -d '1 hour' scene.yml
    makes "fullrun scene.yml"
    touch -d '1 hour ago' scene.yml

    run_make -n models demo model.ROWS=38
    [[ $output =~ "deimselect out/model-residuals.h5" && $output =~ "--rows 38" && ! $output =~ "bin/podbuild" ]]
    run_make models demo model.ROWS=38 SET='--set lubricant.density.law=incompressible'
    [ "$status" -eq 0 ]
    [[ $output =~ "out/snapshots.h5" ]]
}

# bats test_tags=slow
@test "a case that is not trained is solved and marked; a missing one stops with a word" {
    small_low
    echo "far,no1,40,18,,,,,,,," >>cases.csv
    run_make demo
    [ "$status" -eq 0 ]
    [[ $output =~ "not trusted"|"not converged" ]]
    head -n 1 cases.csv >none.csv
    mv none.csv cases.csv
    run_make demo
    [ "$status" -eq 2 ]
    [[ $output == *"cases.csv: found no cases"* ]]
}

# bats test_tags=slow
@test "the steps in time: what results tell of them, and what is true" {
    copy_scene studies/transient-load
    run_make effects HISTORIES='soft speed' TOLERANCES=1.5e-3 TRUTH_STEP=0.01
    [ "$status" -eq 0 ]
    [ "$(head -c 4 out/effects.png | tail -c 3)" = PNG ]
    # on a grid four times as coarse as usual, the tolerance is met within a factor of 3, and the estimate is right
    # within a factor of 4
    awk '/ central / && /1.5e-3/ { n++; for (i = 1; i <= NF; i++) if ($i == "central") { true = $(i + 1); told = $(i + 3) }
             if (!($NF < 3 && $NF > 1 / 3 && told < 4 * true && true < 4 * told)) bad = 1 }
         END { exit bad || n != 2 }' out/effects.txt
    # a run that exceeds its tolerance by more has a note
    run --separate-stderr "$BIN/fullrun" scene.yml -o x.h5 --set discretization=accurate --set transient.tolerance=5e-4 \
        --set transient.load.law=sine --set transient.load.amplitude=0.4 --set transient.load.period=1.5
    [ "$status" -eq 0 ]
    [[ $stderr == *"scene.yml: the steps in time do 0."*" % to the central film (root mean square), more than 3 times transient.tolerance"* ]]
}

# Copies the study with two short trajectories on a small grid.
small_transient() {
    copy_scene studies/transient-load
    sed -i 's/end_time: .*/end_time: 0.2/' scene.yml
    sed -i '1i TRAINED_PERIODS = 0.5, 1' Makefile
    printf '%s\n' "$(head -n 1 cases.csv)" 0.5,0.2,0.005,5010,4192,3949,119 0.75,0.2,0.005,,,, >few.csv
    mv few.csv cases.csv
    sizes=(model.PRESSURE_MODES=32 model.ROWS=50 model-paper.PRESSURE_MODES=25
        model-paper.DEFORMATION_MODES=20 model-paper.ROWS=50 FIGURE5_TIME=0.15
        EXTREME_AMPLITUDES=0.1 EXTREME_PERIODS='0.5 1' HISTORIES=soft TRUTH_STEP=0.02 SNAPGEN_OPTIONS='--jobs 1')
}

# bats test_tags=slow
@test "the transient load: tables and figures, and then nothing is left to do" {
    small_transient
    run_make tables figures "${sizes[@]}"
    [ "$status" -eq 0 ]
    for table in 'Table 6' 'Table 7' 'Largest deviations' published worst; do grep -q "$table" out/tables.txt; done
    [[ ! $output =~ nan|[0-9]\* ]] # no run stopped early
    # the central film does not change before the entering film reaches the centre: $7 may print as zero
    awk '/^worst/ { found = 1; for (i = 2; i <= 6; i++) if (!($i > 0 && $i < 1)) bad = 1 } END { exit bad || !found }' out/tables.txt
    for picture in figure4 figure5 effects; do
        [ "$(head -c 4 out/$picture.png | tail -c 3)" = PNG ]
        grep -q '</svg>' out/$picture.svg
    done
    # the profile has all nodes, and its pressure is scaled with p_H of its time, which grows with the root of the load
    run -0 python 'x, P, H = results.profile("out/profile-full.h5"); run = results.read_trajectory("out/full/fixed-1.h5")
now = abs(run.time - 0.15).argmin()
print(len(x), P[abs(x).argmin()], run.P_c[now] / run.load[now] ** 0.5)'
    read -r nodes of_profile of_run <<<"$output"
    [ "$nodes" -eq 301 ]
    close_to "$of_profile" "$of_run" 1e-6
    run_make -n tables figures "${sizes[@]}"
    [[ $status == 0 && ! $output =~ bin/$programs && ! $output =~ trajectories.py && ! $output =~ study.py ]]

    # the comparison over time agrees with that of romrun
    run -0 --separate-stderr romrun scene.yml --quiet --model out/model.h5 --set transient.load.period=0.75 \
        --set transient.fixed_step=0.005 --against out/full/fixed-2.h5
    close_to "$(python 'import trajectories
print(trajectories.largest(*(results.read_trajectory(f"out/{kind}/fixed-2.h5") for kind in ("full", "model")), "H_c"))')" \
        "$(sed -n 's/.*central film thickness *at most \([^ ]*\) %.*/\1/p' <<<"$output")" 0.01
}

# bats test_tags=slow
@test "the transient load: distances from the truth, of a period that was not trained too" {
    small_transient
    # the films are carried along their paths, until a film that entered after the start has reached the centre
    sed -i 's/0.2,0.005/1.5,0.01/' cases.csv
    sed -i 's/end_time: .*/end_time: 1.5/' scene.yml
    small=(model.PRESSURE_MODES=60 model.ROWS=100 SNAPGEN_OPTIONS='--jobs 1' SET='--set discretization=accurate')
    run_make distances "${small[@]}" # 0.5 is trained, 0.75 is not
    echo "$output"
    [ "$status" -eq 0 ]
    awk '$1 != "0.5" && $1 != "0.75" { next }
         { lines[$1]++; if (!($4 > 10 && $6 > 0)) bad = 1 }
         $3 == "truth" { if (NF != 6) bad = 1; next }
         { rms = substr($8, 2) + 0; rms_min = substr($10, 2) + 0
           if (!($7 > 0 && $9 > 0 && rms > 0 && rms <= $7 && rms_min > 0 && rms_min <= $9)) bad = 1 }
         $2 == "full" { if (NF != 10) bad = 1 }
         $2 == "model" { if (NF != 12 || !($11 > 0 && $12 > 0)) bad = 1 }
         END { exit bad || lines["0.5"] != 5 || lines["0.75"] != 5 }' out*/distances.txt
    # a run with transport along the path and half of the step is nearer to the extrapolated result of the published
    # rows than the published rows themselves
    run_make confirm "${small[@]}" CONFIRM_CASE=2
    echo "$output"
    [ "$status" -eq 0 ]
    awk 'NF == 6 && $3 > 0 { off[$1] = $3 } END { exit !(off["truth"] > 0 && off["truth"] < off["published-half"] / 2 &&
             off["published-quarter"] > 0 && off["published-quarter"] < off["published-half"]) }' out*/confirm.txt
}

# bats test_tags=slow
@test "the transient load: beyond the published range, and with the published basis" {
    small_transient
    run_make extremes paper-size "${sizes[@]}"
    [ "$status" -eq 0 ]
    [ "$(grep -c '^ *10 %' out/extremes.txt)" -eq 2 ]
    grep -q 'full runs that did not complete: 0' out/extremes.txt
    [ "$(grep -c model-paper out/tables-paper.txt)" -eq 2 ]
}

# bats test_tags=slow
@test "a run that stops early or is not trusted is shown as far as it came" {
    small_transient
    # this program stops with a given exit code
    cat >stops <<'SH'
#!/bin/sh
scene=$1
while [ "$1" != -o ]; do shift; done
"$BIN/fullrun" "$scene" -o "$2" --force --quiet >/dev/null
[ "$CODE" -ne 3 ] || mv "$2" "$2.partial"
echo "stops: no further" >&2
exit "$CODE"
SH
    chmod +x stops
    stops='run = results.trajectory("short.h5", os.getcwd() + "/stops", "scene.yml")
print(run.code, run.message, run.steps > 0, run.time[0], round(run.load[0], 12), run.time[-1], len(run.H_c) == len(run.time))'
    for code in 3 4; do
        CODE=$code run -0 --separate-stderr python "$stops"
        [ "$output" = "$code stops: no further True 0.0 1.0 0.2 True" ]
        rm -f short.h5*
    done
    CODE=70 run -70 --separate-stderr python "$stops"
    [[ -z $output && $stderr == "stops: no further" ]]

    # a reduced model far from its training: its runs end early or are marked, and the table shows this
    run_make extremes tables "${sizes[@]}" EXTREME_AMPLITUDES=0.9 EXTREME_PERIODS=0.5
    [ "$status" -eq 0 ]
    run -0 python 'run = results.read_trajectory("out/model/extreme-0.9-0.5.h5"); print(f"{run.time[-1]:.3f}", run.steps)
assert run.code == 3 and numpy.isnan(run.seconds)'
    read -r time steps <<<"$output"
    grep -q "^ *90 % *0.5 .*  stopped at T = $time  *$steps " out/extremes.txt
    cp out/model/extreme-0.9-0.5.h5 out/model/adaptive-2.h5
    run_make tables "${sizes[@]}"
    [ "$status" -eq 0 ]
    grep -q '^0.75 .*\*' out/tables.txt
    grep -q '^\* stopped early' out/tables.txt
}

@test "deviations over time are exact for cubics, at the same times and between them" {
    run -0 python 'import trajectories
from types import SimpleNamespace
i = numpy.arange(13)
one, two = (i[:11] / 10) ** 2, i / 11
P, H = (lambda t: 1 + t ** 3), (lambda t: 2 + t - t ** 2)
one, two = (SimpleNamespace(time=t, P_c=f * P(t), H_c=H(t) * g) for t, f, g in ((one, 1, 1), (two, 1.01, 1 - 0.02 * (i == 5))))
P_c, H_c = (100 * results.deviations(one, two, column) for column in ("P_c", "H_c"))
assert numpy.isnan(P_c[12]) and numpy.isnan(H_c[12])  # the last time lies beyond the end
assert (abs(P_c[:12] - 1) < 1e-10).all() and (abs(H_c[:12] + 2 * (i[:12] == 5)) < 1e-10).all()
assert abs(trajectories.largest(one, two, "P_c") - 1) < 1e-6 and abs(trajectories.largest(one, two, "H_c") - 2) < 1e-6
same = results.deviations(one, one, "H_c")
assert len(same) == 11 and (same == 0).all()
one.time = one.time + 2
assert numpy.isnan(trajectories.largest(one, two, "H_c"))
print("exact")'
    [ "$output" = exact ]
}
