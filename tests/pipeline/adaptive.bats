#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests of snapgen --adaptive: it adds training points where they are needed, until a wanted accuracy holds.

load common

# Trains s.h5 on a region with 301 nodes and 153 candidates; most tests below use this training.
setup_file() {
    cd "$BATS_FILE_TMPDIR" || return
    common_setup_small
    sed -i 's/step: 0.05/step: 0.02/' scene.yml base.yml
    cat >region.yml <<'YAML'
groups:
  - scene: base.yml
    vary:
      moes.M: [8, 8.4, 8.8, 9.2, 9.6, 10, 10.5, 11, 11.5, 12, 12.5, 13, 13.5, 14, 14.5, 15, 16]
      moes.L: [2, 2.5, 3, 3.5, 4, 4.5, 5, 5.5, 6]
YAML
    snapgen region.yml --adaptive --start 8 -o s.h5 --jobs 1 >report.txt 2>notes.txt
}

setup() {
    cd "$BATS_TEST_TMPDIR" || return
    cp "$BATS_FILE_TMPDIR"/* .
}

@test "stops when the accuracy is indicated, with far fewer points than candidates" {
    cat report.txt notes.txt
    snapgen --check s.h5
    [ ! -e s.h5.partial ]
    [[ $(head -n 1 report.txt) =~ ^([0-9]+)" points of 153, "([0-9]+)" converged, "([0-9]+)" rounds, " ]]
    points=${BASH_REMATCH[1]} rounds=${BASH_REMATCH[3]}
    ((points == BASH_REMATCH[2] && points < 100 && rounds > 2))
    [[ $(sed -n 2p report.txt) == "estimated film errors of the other points: at most "* ]]
    [[ $(sed -n 3p report.txt) =~ ^"checked on the last "[0-9]+" points before they were trained on: central film at most " ]]
    [ "$(grep -c "^snapgen: round [0-9]*: [0-9]* points" notes.txt)" -eq "$rounds" ]
    /usr/bin/python3 - "$points" "$rounds" <<'PYTHON'
import sys, h5py, numpy
points, rounds = int(sys.argv[1]), int(sys.argv[2])
with h5py.File("s.h5") as s:
    assert len(s["state"]) == points and len(s["round"]) == rounds
    assert (s["status"][...] == 0).all()
    chosen = s["training_point"][...]
    assert len(set(chosen)) == points and chosen.min() >= 0 and chosen.max() < 153
    M = numpy.array([8, 8.4, 8.8, 9.2, 9.6, 10, 10.5, 11, 11.5, 12, 12.5, 13, 13.5, 14, 14.5, 15, 16])
    assert (s["moes_M"][...] == M[chosen // 9]).all()
    assert (s["moes_L"][...] == 2 + 0.5 * (chosen % 9)).all()
    of_round = s["training_round"][...]
    assert (numpy.diff(of_round) >= 0).all() and of_round[0] == 0 and of_round[-1] == rounds - 1
    assert (of_round == 0).sum() == 8
    # the first points contain the corners of the region
    corners = {(8, 2), (8, 6), (16, 2), (16, 6)}
    assert corners <= set(zip(s["moes_M"][:8], s["moes_L"][:8]))
    # the numbers that are stored for each round agree with the states
    assert (s["round_points"][...] == [(of_round <= r).sum() for r in range(rounds)]).all()
    off = abs(s["training_film"][...] / s["central_film_thickness"][...] - 1)
    assert numpy.isnan(off[:8]).all()
    off = numpy.maximum(off, abs(s["training_film_minimum"][...] / s["minimum_film_thickness"][...] - 1))
    for r in range(rounds - 1):
        here = off[of_round == r + 1]
        worst = numpy.nanmax(here) if not numpy.isnan(here).all() else numpy.nan
        numpy.testing.assert_allclose(s["round_deviation"][r], worst, rtol=1e-9)
    assert numpy.isnan(s["round_deviation"][-1])
    # the last round was a check: the indicated deviation meets the accuracy before and after this round, and the
    # deviation found in this round meets it too
    assert (s["round_indicated"][-2:] <= 1e-3).all() and s["round_deviation"][-2] <= 1e-3
    assert not any((s["round_indicated"][r : r + 2] <= 1e-3).all() and s["round_deviation"][r] <= 1e-3
                   for r in range(rounds - 2))
    assert (numpy.diff(s["round_seconds"][...]) > 0).all()
PYTHON
}

# bats test_tags=slow
@test "the next stages take it, and the accuracy is met between the candidates" {
    podbuild s.h5 -o b.h5 --energy 1e-18
    snapgen region.yml --adaptive --basis b.h5 -o r.h5 --quiet
    deimselect r.h5 --basis b.h5 -o m.h5
    [ "$(/usr/bin/python3 -c 'import h5py
print(len(h5py.File("r.h5")["state"]) == len(h5py.File("s.h5")["state"]))')" = True ]
    for M in 8.2 9.1 10.7 13.2 15.5; do
        for L in 2.2 3.3 4.7 5.8; do
            fullrun scene.yml --set moes.M=$M --set moes.L=$L -o full.h5 --force >/dev/null
            romrun scene.yml --set moes.M=$M --set moes.L=$L --model m.h5 -o red.h5 --force >/dev/null
            close_to "$(number red.h5 central_film_thickness)" \
                "$(number full.h5 central_film_thickness)" 1e-3
        done
    done
    # without --adaptive snapgen repeats the whole plan, and its residuals give a model too
    snapgen region.yml --basis b.h5 -o all.h5 --quiet
    deimselect all.h5 --basis b.h5 -o n.h5
    [ "$(/usr/bin/python3 -c 'import h5py; print(len(h5py.File("all.h5")["state"]))')" = 153 ]
}

# bats test_tags=slow
@test "--jobs changes no result but the times" {
    snapgen region.yml --adaptive --start 8 -o two.h5 --jobs 2 --quiet
    same_data s.h5 two.h5
    snapgen region.yml --adaptive --start 8 -o many.h5 --jobs 7 --quiet
    same_data s.h5 many.h5
}

# bats test_tags=slow
@test "--resume looks at what each state holds" {
    resume=(snapgen region.yml --adaptive --start 8 --jobs 1 --quiet -o x.h5 --resume)
    # this code makes the file look as it does before the training ends
    local unended="f.attrs['complete'] = numpy.int64(0)
    for name in [n for n in f if n.startswith('round')]: del f[name]"
    for change in "f['moes_M'][-1] *= 1.2" "f['exit_node'][-1] = 10**6" "f['rigid_approach'][-1] = numpy.inf"; do
        patch s.h5 "$unended
    $change"
        mv bad.h5 x.h5.partial
        "${resume[@]}"
        same_data s.h5 x.h5
        rm x.h5
    done
    patch s.h5 "$unended
    f['training_point'][1] = f['training_point'][0]"
    mv bad.h5 x.h5.partial
    refused 65 "training_point: found [0-9]+ as states 0 and 1, expected it once" "${resume[@]}"
}

# bats test_tags=slow
@test "kill -9 and Ctrl-C lose no finished point, and --resume gives the bits of an uninterrupted run" {
    slow=(snapgen region.yml --adaptive --start 8 --batch 3 --accuracy 1e-6 --most 50
        --set grid.step=0.005 --quiet)
    "${slow[@]}" -o whole.h5
    for states in 3 12 20; do
        stop_when KILL "states >= $states" x.h5 "${slow[@]}" -o x.h5 --resume
        [ ! -e x.h5 ]
    done
    stop_when INT 'states >= 25' x.h5 "${slow[@]}" -o x.h5 --resume 2>stopped.txt
    [ "$code" -eq 130 ]
    [ "$(wc -l <stopped.txt)" -eq 1 ]
    grep -q "^snapgen: x.h5.partial: found an interruption after [0-9]* points in [0-9]* rounds" stopped.txt
    # the file is unfinished, so no stage takes it, and another training does not continue it
    refused 65 "x.h5.partial" podbuild x.h5.partial -o b.h5
    refused 65 "x.h5.partial: found other settings" "${slow[@]}" --start 9 -o x.h5 --resume
    refused 65 "x.h5.partial: found other settings" snapgen region.yml -o x.h5 --resume
    run --separate-stderr "${slow[@]}" -o x.h5 --resume --jobs 1
    [ "$status" -eq 0 ]
    same_data whole.h5 x.h5
    # --resume did not repeat the rounds of the first run
    /usr/bin/python3 - <<'PYTHON'
import h5py, numpy
with h5py.File("x.h5") as x:
    assert numpy.isnan(x["round_seconds"][:5]).all() and x["round_seconds"][-1] > 0
PYTHON
}

@test "ends with the points of the plan or with --max-points, and says that it is not enough" {
    run --separate-stderr snapgen plan.yml --adaptive --start 4 --batch 2 -o x.h5 --quiet
    [ "$status" -eq 0 ]
    [[ $output =~ ^"9 points of 9, 9 converged, "[0-9]+" rounds, " ]]
    [[ $stderr == "snapgen: plan.yml: found 9 points used up, expected fewer to show an accuracy of 0.001; a plan with more candidates may" ]]
    run --separate-stderr snapgen region.yml --adaptive --start 8 --max-points 13 -o y.h5 --quiet
    [ "$status" -eq 0 ]
    [[ $output == "13 points of 153, "* ]]
    # the points are the first points of the longer training
    /usr/bin/python3 - <<'PYTHON'
import h5py
with h5py.File("s.h5") as s, h5py.File("y.h5") as y:
    assert (s["training_point"][:12] == y["training_point"][:12]).all()
    assert (s["pressure"][:12] == y["pressure"][:12]).all()
PYTHON
}

# bats test_tags=slow
@test "a point contact: far fewer points than candidates, and the accuracy is met at the others" {
    cat >ball.yml <<'YAML'
contact: point
regime: stationary
moes: {M: 13, L: 5}
lubricant: {viscosity: {law: barus, alpha: 2.0e-8}, density: {law: dowson-higginson}}
grid: {x_min: -2.5, x_max: 1.5, step: 0.0625, y_max: 2}
YAML
    cat >candidates.yml <<'YAML'
groups:
  - scene: ball.yml
    vary:
      moes.M: [8, 8.7, 9.5, 10.3, 11, 12, 13, 14, 15, 16.2, 17.5, 18.7, 20]
      moes.L: [2, 2.4, 2.8, 3.2, 3.5, 3.9, 4.3, 4.7, 5, 5.5, 6]
YAML
    snapgen candidates.yml --adaptive --start 12 -o p.h5 --jobs 1 >report.txt
    cat report.txt
    [[ $(head -n 1 report.txt) =~ ^([0-9]+)" points of 143, "([0-9]+)" converged, "([0-9]+)" rounds, " ]]
    ((BASH_REMATCH[1] == BASH_REMATCH[2] && BASH_REMATCH[1] < 72 && BASH_REMATCH[3] > 1))
    snapgen candidates.yml --adaptive --start 12 -o two.h5 --jobs 2 --quiet
    same_data p.h5 two.h5
    podbuild p.h5 -o pb.h5 --energy 1e-18
    snapgen candidates.yml --adaptive --basis pb.h5 -o pr.h5 --quiet
    deimselect pr.h5 --basis pb.h5 -o pm.h5
    for place in 9.5-2.8 10.3-5 12-4.7 14-3.2 17.5-5.5 18.7-2.4; do
        set -- --set moes.M=${place%-*} --set moes.L=${place#*-}
        fullrun ball.yml -o full.h5 --force "$@" >/dev/null
        romrun ball.yml --model pm.h5 -o red.h5 --force "$@" >/dev/null
        close_to "$(number red.h5 central_film_thickness)" "$(number full.h5 central_film_thickness)" 1e-3
    done
}

@test "points that the full model does not solve are reported and are not chosen again" {
    cat >failing.yml <<'YAML'
groups:
  - scene: base.yml
    vary: {moes.M: [2, 8, 9, 10, 11, 12, 13, 14], moes.L: [1, 2, 3]}
YAML
    run --separate-stderr snapgen failing.yml --set grid.x_max=1.1 --adaptive --start 8 -o x.h5 --quiet
    [ "$status" -eq 3 ]
    [[ $stderr == *"point M=2 L="*": not converged"* ]]
    [[ $stderr =~ "failing.yml: found 3 of "[0-9]+" points not converged, expected at most 0 (--allow-failures)"$ ]]
    snapgen --check x.h5
    [[ $(podbuild x.h5 -o b.h5) == *" states on "*", 3 left out that had not converged"* ]]
    run --separate-stderr snapgen failing.yml --set grid.x_max=1.1 --adaptive --start 8 -o y.h5 --quiet \
        --allow-failures 3
    [ "$status" -eq 0 ]
    # on so coarse a grid, too few points are solved for a model
    cat >coarse.yml <<'YAML'
groups:
  - scene:
      contact: line
      regime: stationary
      physical: {load: 180e3, radius: 0.008, speed: 2.2, modulus: 231e9, viscosity: 0.055}
      lubricant: {viscosity: {law: barus, alpha: 1.7e-8}, density: {law: dowson-higginson}}
      grid: {step: 0.5}
    region: {load: [100e3, 260e3], physical.speed: [1, 3]}
YAML
    run --separate-stderr snapgen coarse.yml -o z.h5 --quiet
    [ "$status" -eq 3 ]
    [[ $stderr =~ "coarse.yml: found "[0-9]+" of "[0-9]+" points not converged, and no model of the others: " ]]
    [ ! -e z.h5 ]
}

# bats test_tags=slow
@test "its file opens with h5py, xarray and ncdump" {
    run "$BATS_TEST_DIRNAME/open_elsewhere.py" s.h5
    echo "$output"
    [ "$status" -ne 2 ] || skip "a reader is not installed"
    [ "$status" -eq 0 ]
}

# bats test_tags=slow
@test "a region is trained where it needs it, each lubricant with its own corners" {
    cat >free.yml <<'YAML'
groups:
  - scene: base.yml
    region: {moes.M: [8, 14], moes.L: [2, 5]}
    vary: {lubricant.density.law: [dowson-higginson, incompressible]}
    candidates: 120
YAML
    snapgen free.yml --start 8 -o f.h5 --jobs 2 >report.txt 2>notes.txt
    cat report.txt notes.txt
    [[ $(head -n 1 report.txt) =~ ^([0-9]+)" points of 240, "([0-9]+)" converged, " ]]
    ((BASH_REMATCH[1] == BASH_REMATCH[2] && BASH_REMATCH[1] < 150))
    grep -q "^checked on the last " report.txt
    /usr/bin/python3 - <<'PYTHON'
import h5py
with h5py.File("f.h5") as f:
    point, M, L = f["training_point"][...], f["moes_M"][...], f["moes_L"][...]
    first = f["training_round"][...] == 0
    for density in (0, 1):
        here = set(zip(M[first & (point // 120 == density)], L[first & (point // 120 == density)]))
        assert {(8, 2), (14, 2), (8, 5), (14, 5)} <= here, here
    assert M.min() == 8 and M.max() == 14 and L.min() == 2 and L.max() == 5
PYTHON
    podbuild f.h5 -o fb.h5 --energy 1e-18
    snapgen free.yml --basis fb.h5 -o fr.h5 --quiet
    deimselect fr.h5 --basis fb.h5 -o fm.h5
    # these scenes are no candidates
    for scene in 9.3-2.7-dowson-higginson 12.6-4.1-incompressible 8.4-4.8-incompressible; do
        IFS=- read -r M L density <<<"$scene"
        set -- --set moes.M=$M --set moes.L=$L --set "lubricant.density.law=$density"
        fullrun base.yml -o full.h5 --force "$@" >/dev/null
        romrun base.yml --model fm.h5 -o red.h5 --force "$@" >/dev/null
        close_to "$(number red.h5 central_film_thickness)" "$(number full.h5 central_film_thickness)" 1e-3
        close_to "$(number red.h5 minimum_film_thickness)" "$(number full.h5 minimum_film_thickness)" 1e-3
    done
    refuse 64 "--shard: found with a region" snapgen free.yml --shard 1/2 -o x.h5
}

# bats test_tags=slow
@test "a training in rounds: points are chosen, solved in pieces, taken over, with the bits of one run" {
    how=(region.yml --adaptive --start 8 --accuracy 1e-2 --set grid.step=0.01)
    snapgen "${how[@]}" -o whole.h5 --quiet >whole.txt
    pieces=()
    for ((round = 1; round < 20; round++)); do
        run --separate-stderr snapgen "${how[@]}" --choose "${pieces[@]}" -o x.h5 --resume
        [ "$status" -eq 0 ]
        [ ! -e x.h5 ] || break
        [[ $output =~ ^"round $round: "([0-9]+)" points are to be solved, after "([0-9]+)$ ]]
        num_open=${BASH_REMATCH[1]}
        rm -f "${pieces[@]}"
        pieces=(piece-{1,2,3}.h5)
        for k in 1 2 3; do
            snapgen "${how[@]}" --chosen-in x.h5.partial --shard $k/3 -o piece-$k.h5 --quiet >piece.txt
            grep -q "^$(((num_open + 3 - k) / 3)) points of round $round, " piece.txt
        done
    done
    ((round > 3))
    same_data whole.h5 x.h5
    [ "$(tail -n 2 whole.txt)" = "$(tail -n 2 <<<"$output")" ]
    # a piece of another round is refused
    refused 65 "piece-1.h5: state 0: found point "[0-9]+" of round "[0-9]+", expected one that was chosen" snapgen "${how[@]}" --choose piece-1.h5 -o y.h5 --quiet
    [ -e y.h5.partial ]

    # points that a killed piece has solved are not solved again, whether the piece is resumed or taken as it is
    piece=(snapgen "${how[@]}" --chosen-in y.h5.partial)
    stop_when KILL 'states >= 1' half.h5 "${piece[@]}" -o half.h5 --quiet
    done_in() { snapgen --print "$1" status | awk 'NR > 1 && $1 >= 0 { n++ } END { print n + 0 }'; }
    before=$(done_in half.h5.partial)
    cp half.h5.partial taken.h5.partial
    refused 65 "half.h5.partial: found other points" "${piece[@]}" --shard 1/2 -o half.h5 --resume --quiet
    run --separate-stderr "${piece[@]}" -o half.h5 --resume
    [[ $stderr == *"half.h5.partial: $before of 8 points are done"*"snapgen: $((8 - before))/$((8 - before)) "* ]]
    [[ $output == "8 points of round 1, 8 converged, "* ]]
    run --separate-stderr snapgen "${how[@]}" --choose taken.h5.partial -o y.h5 --resume --quiet
    [ "$output" = "round 1: $((8 - before)) points are to be solved, after $before" ]
    refused 64 "y.h5.partial: found $((8 - before)) points that are to be solved, expected at least 8" \
        "${piece[@]}" --shard 3/8 -o z.h5
    # a run without --choose continues the training
    snapgen "${how[@]}" -o y.h5 --resume --quiet
    same_data whole.h5 y.h5

    snapgen "${how[@]}" --choose -o v.h5 --quiet
    refused 65 "v.h5.partial: found other settings, expected those of this training" \
        snapgen "${how[@]}" --accuracy 1e-3 --chosen-in v.h5.partial -o z.h5
    refused 64 "--choose: found with --chosen-in" snapgen "${how[@]}" --choose --chosen-in v.h5.partial -o z.h5
    refused 64 "command line: found 2 files, expected pieces with --choose only" snapgen "${how[@]}" piece-1.h5 -o z.h5
}

@test "podbuild says that a training is too thin" {
    cat >corners.yml <<'YAML'
groups:
  - scene: base.yml
    vary: {moes.M: [8, 30], moes.L: [2, 12]}
YAML
    snapgen corners.yml -o thin.h5 --quiet
    run --separate-stderr podbuild thin.h5 -o thin-basis.h5
    [ "$status" -eq 0 ]
    [[ $output == *"as many modes as states; distance of a state from the span of the others "* ]]
    [[ $stderr == "podbuild: thin.h5: found a training too thin: half of its pressures are further than 0."* ]]
    # podbuild also warns if the training comes as a part file, whose states it streams
    podbuild -q --compress thin.h5 -o part.h5
    run --separate-stderr podbuild -q part.h5 -o part-basis.h5
    [ "$status" -eq 0 ]
    [[ $stderr == *"podbuild: part.h5: found a training too thin: half of its pressures are further than 0."* ]]
    run --separate-stderr podbuild s.h5 -o b.h5 --energy 1e-18
    [ "$status" -eq 0 ]
    [ -z "$stderr" ]
}

@test "what does not go together is refused" {
    refuse 64 "--max-points: found without --adaptive" snapgen plan.yml --max-points 9 -o x.h5
    refuse 64 "--accuracy: found 0, expected" snapgen plan.yml --adaptive --accuracy 0 -o x.h5
    refuse 64 "--start: found 2, expected" snapgen plan.yml --adaptive --start 2 -o x.h5
    refuse 64 "--shard: found with --adaptive" snapgen plan.yml --adaptive --shard 1/2 -o x.h5
    podbuild s.h5 -o b.h5
    refuse 64 "--batch: found with --basis" snapgen plan.yml --adaptive --batch 3 --basis b.h5 -o x.h5
    sed 's/L: \[.*\]/L: [2.1, 4.1]/' plan.yml >other.yml
    refuse 65 "other.yml: found no point that b.h5 was trained on" \
        snapgen other.yml --adaptive --basis b.h5 -o x.h5
    cat >moving.yml <<'YAML'
groups:
  - scene: base.yml
    vary: {moes.M: [8, 12], moes.L: [3]}
  - scene:
      contact: line
      regime: transient
      moes: {M: 12, L: 4}
      lubricant: {viscosity: {law: barus, alpha: 2.0e-8}, density: {law: dowson-higginson}}
      grid: {step: 0.02}
      transient: {load: {law: sine, amplitude: 0.1, period: 0.5}, end_time: 0.1}
YAML
    refuse 65 "moving.yml: found 1 transient scenes with --adaptive or a region, expected a plan without them" \
        snapgen moving.yml --adaptive -o x.h5
}
