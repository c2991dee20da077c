#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests of lists of models for the parts of a region, given to --model.

load common

# part NAME M CHECK: makes NAME.h5, trained on the values M and calibrated on the values CHECK.
part() {
    cat >train.yml <<YAML
groups:
  - scene: base.yml
    vary: {moes.M: [$2], moes.L: [2, 4, 6]}
YAML
    cat >check.yml <<YAML
groups:
  - scene: base.yml
    vary: {moes.M: [$3], moes.L: [3, 5]}
YAML
    snapgen train.yml -o s.h5 --quiet --force
    podbuild s.h5 -o b.h5 --pressure-modes 12 --force
    snapgen train.yml --basis b.h5 -o r.h5 --quiet --force
    deimselect r.h5 --basis b.h5 -o m.h5 --no-check --force
    romrun --calibrate check.yml --model m.h5 -o "$1.h5" --quiet
}

# part_in_time NAME LOWEST HIGHEST: makes NAME.h5, trained on histories with loads in this range.
part_in_time() {
    cat >train-time.yml <<YAML
groups:
  - scene: moving.yml
    histories: {load: [$2, $3], kinds: [sine]}
YAML
    rm -f ts.h5 tb.h5 tr.h5
    model_in_time 40
    mv tm.h5 "$1.h5"
}

# Makes low.h5 and high.h5 for M from 8 to 15 and from 12 to 23, and light.h5 and heavy.h5 for loads that vary.
setup_file() {
    cd "$BATS_FILE_TMPDIR" || return
    common_setup_small
    part low "8, 9.5, 11, 13, 15" "10, 14"
    part high "12, 14, 16, 19, 23" "13, 20"
    echo 'models: [low.h5, high.h5]' >parts.yml
    moving_scene "x_min: -4, x_max: 2, step: 0.05" "end_time: 2, fixed_step: 0.02"
    part_in_time light 0.75 1.08
    part_in_time heavy 0.95 1.3
    echo 'models: [light.h5, heavy.h5]' >in-time.yml
}

setup() {
    cd "$BATS_TEST_TMPDIR" || return
    cp "$BATS_FILE_TMPDIR"/{low,high,light,heavy}.h5 "$BATS_FILE_TMPDIR"/{base,parts,in-time,moving}.yml .
}

# solved M MODEL: prints the central film, and the part that solved the scene
solved() {
    romrun base.yml --set moes.M="$1" --set moes.L=4 --model "$2" --quiet -o "$1-$2.h5" --force |
        awk '/^central film/ { film = $4 } /^solved by/ { part = " " $3 } END { print film part }'
}

# bats test_tags=slow
@test "a scene is solved by the model in whose range it lies deepest, with its bits" {
    for case in "9 low" "12.5 low" "14.5 high" "21 high"; do
        read -r moes_M name <<<"$case"
        read -r film part <<<"$(solved "$moes_M" parts.yml)"
        [ "$part" = "$name.h5" ]
        read -r alone none <<<"$(solved "$moes_M" "$name.h5")"
        [ "$film" = "$alone" ] && [ -z "$none" ]
        same_data "$moes_M-parts.yml.h5" "$moes_M-$name.h5.h5"
    done
    romrun --check 21-parts.yml.h5
    # this scene lies outside of both ranges
    run --separate-stderr romrun base.yml --set moes.M=40 --set moes.L=4 --model parts.yml
    [ "$status" -eq 4 ]
    [[ $stderr == *"found outside of the trained range of M and alpha p_H"* ]]
    grep -q '^solved by  *high.h5$' <<<"$output"
    # a list with one model gives the same as the model
    echo 'models: [low.h5]' >one.yml
    read -r film part <<<"$(solved 9 one.yml)"
    [ -z "$part" ]
    same_data 9-one.yml.h5 9-low.h5.h5
}

@test "the film across the border of two models is that of either" {
    { echo moes.M,moes.L; for moes_M in 11.5 12 12.5 13 13.5 14 14.5 15.5; do echo "$moes_M,4"; done; } >across.csv
    for model in parts.yml low.h5 high.h5; do
        romrun base.yml --cases across.csv --model "$model" -o "$model.csv" --quiet --jobs 2 --allow-untrusted >/dev/null
    done
    /usr/bin/python3 - <<'PYTHON'
import csv
parts, low, high = ([float(row["central_film_thickness"]) for row in csv.DictReader(open(name + ".csv"))]
                    for name in ("parts.yml", "low.h5", "high.h5"))
of = ["low" if a == b else "high" if a == c else None for a, b, c in zip(parts, low, high)]
assert of == ["low"] * of.count("low") + ["high"] * of.count("high") and 2 < of.count("low") < 6, of
for a, b in zip(low[1:-1], high[1:-1]): assert abs(a / b - 1) < 1e-3, (a, b)
PYTHON
}

# bats test_tags=slow
@test "--accuracy, --trade, --check, --export and --jobs of a list" {
    run -0 --separate-stderr romrun base.yml --set moes.M=20 --set moes.L=4 --model parts.yml --accuracy 1e-2
    [ "${#stderr_lines[@]}" -eq 2 ]
    [[ ${stderr_lines[0]} == "romrun: --accuracy 0.01: low.h5: "*" pressure modes, "* ]]
    [[ ${stderr_lines[1]} == "romrun: --accuracy 0.01: high.h5: "*" pressure modes, "* ]]
    refused 65 "--accuracy: found 1e-05, expected at least .* that low.h5 was measured" \
        romrun base.yml --set moes.M=20 --set moes.L=4 --model parts.yml --accuracy 1e-5
    romrun --trade --model parts.yml >trade.txt
    for name in low high; do
        grep -q "^$name.h5$" trade.txt
        romrun --trade --model "$name.h5" >alone.txt
        [ "$(sed -n "/^$name.h5/,/^$/p" trade.txt | sed '1d; /^$/d')" = "$(sed '/^$/d' alone.txt)" ]
    done
    romrun --check parts.yml
    romrun --export parts.yml -o parts.ehdrom
    romrun --check parts.ehdrom
    printf 'moes.M,moes.L\n9,4\n20,4\n13,3\n' >c.csv
    for model in parts.yml parts.ehdrom; do
        romrun base.yml --cases c.csv --model $model --quiet --jobs 2 -o $model.h5 >/dev/null
    done
    /usr/bin/python3 - <<'PYTHON'
import h5py
a, b = h5py.File("parts.yml.h5"), h5py.File("parts.ehdrom.h5")
for name in set(a) - {"solve_seconds"}: assert a[name][...].tobytes() == b[name][...].tobytes(), name
PYTHON
    # flat models may stand in a list, beside an HDF5 model too
    romrun --export low.h5 -o low.ehdrom
    echo 'models: [low.ehdrom, high.h5]' >mixed.yml
    [ "$(solved 9 mixed.yml)" = "$(solved 9 parts.yml | sed 's/low.h5/low.ehdrom/')" ]
}

@test "--check of a list reads all of its models" {
    cp high.h5 damaged.h5
    /usr/bin/python3 -c 'import h5py; h5py.File("damaged.h5", "r+")["pressure_basis"][0, 5] *= 1.5'
    echo 'models: [low.h5, damaged.h5]' >damaged.yml
    refused 65 "damaged.h5: pressure_basis: found a changed content" romrun --check damaged.yml
    # the check also names models that do not go together
    echo 'models: [low.h5, light.h5]' >unlike.yml
    refused 65 "light.h5: transport: found path, expected upwind, as in low.h5" romrun --check unlike.yml
}

@test "in time a contact passes from one model to the other without a jump" {
    # the second model must take over the base of the path; with the last state instead, its film would be 1e-3 off
    for case in "0.12 1e-5" "0.25 1e-4"; do
        set=(--set "transient.load.amplitude=${case% *}" --quiet --force)
        fullrun moving.yml "${set[@]}" -o full.h5 >/dev/null
        romrun moving.yml "${set[@]}" --model in-time.yml -o parts.h5 --allow-untrusted >/dev/null
        /usr/bin/python3 - "${case#* }" <<'PYTHON'
import h5py, sys
full, parts = h5py.File("full.h5"), h5py.File("parts.h5")
off = abs(parts["central_film_thickness"][...] / full["central_film_thickness"][...] - 1)
assert off.max() < float(sys.argv[1]), off.max()
assert (parts["indicated_deviation"][...] > off).all()
PYTHON
    done
    # a history that leaves the range of each single model lies in the range of the list
    set=(--set transient.load.amplitude=0.12 --quiet --force)
    romrun moving.yml "${set[@]}" --model in-time.yml >/dev/null
    for name in light heavy; do
        run --separate-stderr romrun moving.yml "${set[@]}" --model $name.h5
        [ "$status" -eq 4 ] && [[ $stderr == *"outside of the trained range"* ]]
    done
}

# bats test_tags=slow
@test "in time a run of a list can be stopped and resumed: the same numbers" {
    set=(--set transient.end_time=60 --quiet)
    romrun moving.yml "${set[@]}" --model in-time.yml -o whole.h5 >/dev/null
    romrun --check whole.h5
    stop_when INT "len(time) > 1000" x.h5 romrun moving.yml "${set[@]}" --model in-time.yml -o x.h5
    [ "$code" -eq 130 ]
    # models in another order do not continue the run
    cp in-time.yml same.yml
    echo 'models: [heavy.h5, light.h5]' >in-time.yml
    refused 65 "x.h5.partial: found a run with another model than in-time.yml is now" romrun moving.yml "${set[@]}" --model in-time.yml -o x.h5 --resume
    mv same.yml in-time.yml
    romrun moving.yml "${set[@]}" --model in-time.yml -o x.h5 --resume >/dev/null
    same_data whole.h5 x.h5
}

@test "--fallback full with a list" {
    romrun base.yml --set moes.M=40 --set moes.L=4 --model parts.yml --fallback full --quiet | grep -q '^solved by  *the full model'
    romrun moving.yml --set transient.load.amplitude=0.4 --model in-time.yml --fallback full --quiet >answer.txt
    grep -q 'the full model' answer.txt
}

@test "--accuracy and --fallback full: the model that solves is asked again with its best size, whatever the others have" {
    cp low.h5 timed.h5
    /usr/bin/python3 - <<'PYTHON'
import h5py
with h5py.File("timed.h5", "r+") as file:
    is_fast = (file["position_pressure_modes"][...] == 10) & (file["position_rows"][...] == 20)
    assert is_fast.any()
    file["position_seconds"][...] = 1e-3 - 9e-4 * is_fast
    del file.attrs["content_sha256"]
PYTHON
    romrun --export high.h5 -o high.ehdrom # has no table
    echo 'models: [high.ehdrom, timed.h5]' >half.yml
    for model in half.yml timed.h5; do
        run -0 romrun base.yml --set moes.M=8.11 --set moes.L=2.79 --model $model --accuracy 3e-3 --fallback full
        [[ $output == *"again with 12 pressure modes, 24 rows"* && $output != *"the full model"* ]]
    done
}

@test "the library takes a list" {
    sed 's/^regime.*/&\nmoes: {M: 20, L: 4}/' base.yml >scene.yml
    run -0 "$BIN/../unit/use_library" solve parts.yml scene.yml
    close_to "$(awk '$1 == "central_film_thickness" { print $2 }' <<<"$output")" "$(solved 20 high.h5)" 1e-6
    # the other model solves M = 9
    run "$BIN/../unit/use_library" solve parts.yml scene.yml moes.M 9
    close_to "$(awk '$1 == "central_film_thickness" { print $2 }' <<<"$output")" "$(solved 9 low.h5)" 1e-6
}

# bats test_tags=slow
@test "an FMU holds all models of a list" {
    [ "$(uname -m)" = x86_64 ] || skip "FMUs are made on x86-64"
    sed 's/^moes:.*/physical: {load: 60e3, radius: 0.01, speed: 0.2, modulus: 226e9, viscosity: 0.02}/' moving.yml >si.yml
    romrun --fmu si.yml --model in-time.yml -o x.fmu --quiet 2>/dev/null
    python3 -m zipfile -e x.fmu x
    romrun --export in-time.yml -o all.ehdrom
    cmp x/resources/model.ehdrom all.ehdrom
}

# bats test_tags=slow
@test "the study: costs, random scenes, and the film where one model follows on another" {
    unset MAKEFLAGS MAKELEVEL MFLAGS V
    copy_scenes studies/parts
    cd studies/parts || return
    # trains two small parts on the grids that they need
    sed -i -e '13,$d' -e 's/moes.L: [^]]*/moes.L: [4, 8/; s/candidates: 300/candidates: 40/; s/\[5, 1000\]/[10, 40]/' lubricants.yml
    parts=(RANGES="10-22 18-40" WHOLE=10-40 SCENES=40)
    run_make "${parts[@]}"
    echo "$output"
    [ "$status" -eq 0 ]
    [[ $output =~ "where two parts overlap their central films, each on its own grid, differ by "[0-9.]+e-0[3-9] ]]
    # the list has the points of both parts
    read -r nodes_low a <<<"$(awk '/^10-22/ { print $2, $3 }' out-lubricants/costs.txt)"
    read -r nodes_high b <<<"$(awk '/^18-40/ { print $2, $3 }' out-lubricants/costs.txt)"
    [ "$nodes_low" -lt "$nodes_high" ] # each part has the grid that it needs
    grep -q "^list  *$((a + b)) " out-lubricants/costs.txt
    # the list solves all scenes, each wrong result is flagged, and each part solves some scenes
    table=out-lubricants/draw-1-40.txt
    low=$(awk '/^10-22/ { print $2 }' $table) high=$(awk '/^18-40/ { print $2 }' $table)
    [ "$low" -gt 5 ] && [ "$high" -gt 5 ] && [ $((low + high)) -eq 40 ]
    [[ $(grep '^list' $table) =~ ^list\ +40\ +0\ +0\ +[0-9]+\ +[0-9]+\ +0\  ]]
    [ "$(head -c 4 out-lubricants/border.png | tail -c 3)" = PNG ]
    run_make -n "${parts[@]}"
    [[ $status == 0 && ! $output =~ bin/$programs && ! $output =~ study.py ]]
    # one model of the whole region is compared
    run_make whole "${parts[@]}"
    run_make costs draw "${parts[@]}"
    [ "$status" -eq 0 ]
    grep -q '^10-40  *' out-lubricants/costs.txt && grep -q '^10-40  *40 ' $table
}

# bats test_tags=slow
@test "the study: a region in SI units, by the M of its contacts" {
    unset MAKEFLAGS MAKELEVEL MFLAGS V
    copy_scenes studies/parts
    cd studies/parts || return
    sed -i -e 's/candidates: 4000/candidates: 150/' -e 's/physical.load: [^]]*/physical.load: [1e5, 2e5/; s/physical.speed: [^]]*/physical.speed: [1, 3/' \
        -e 's/temperature: [^]]*\], slide/temperature: [60, 70], slide/; s/moes_M: [^]]*/moes_M: [4, 20/' machine.yml
    small=(PLAN=machine.yml RANGES="4-9 8-20" SCENES=20)
    run_make "${small[@]}" costs draw
    echo "$output"
    [ "$status" -eq 0 ]
    low=$(awk '/^4-9/ { print $2 }' out-machine/draw-1-20.txt) high=$(awk '/^8-20/ { print $2 }' out-machine/draw-1-20.txt)
    [ $((low + high)) -le 20 ] && [ "$low" -gt 2 ] && [ "$high" -gt 2 ]
    [[ $(grep '^list' out-machine/draw-1-20.txt) =~ ^list\ +$((low + high))\ +0\ +0\ +[0-9]+\ +[0-9]+\ +0\  ]]
}

# bats test_tags=slow
@test "line contacts: each part may have a grid of its own" {
    mv base.yml fine.yml
    sed 's/step: [0-9.]*/step: 0.1/' fine.yml >base.yml
    part coarse "4, 6, 9, 12, 15" "10, 14"
    echo 'models: [coarse.h5, high.h5]' >grids.yml
    # a scene without a grid gets the grid of the part that solves the scene
    sed '/^grid/d' fine.yml >base.yml
    for case in "9 coarse" "14.5 high" "21 high"; do
        read -r moes_M name <<<"$case"
        read -r film part <<<"$(solved "$moes_M" grids.yml)"
        [ "$part" = "$name.h5" ]
        read -r alone <<<"$(solved "$moes_M" "$name.h5")"
        [ "$film" = "$alone" ]
        same_data "$moes_M-grids.yml.h5" "$moes_M-$name.h5.h5"
    done
    # a scene that gives a grid is solved by the parts on this grid, whatever their range
    run --separate-stderr romrun fine.yml --set moes.M=9 --set moes.L=4 --model grids.yml
    [ "$status" -eq 4 ] && grep -q '^solved by  *high.h5$' <<<"$output"
    refused 65 "grid: found a line contact with 151 nodes .* in steps of 0.04, expected a line contact with 61 .* as in coarse.h5" \
        romrun fine.yml --set moes.M=9 --set moes.L=4 --set grid.step=0.04 --model grids.yml
    # tables of cases work with the list and with its flat file
    romrun --export grids.yml -o grids.ehdrom
    printf 'moes.M,moes.L\n9,4\n21,4\n' >cases.csv
    for model in grids.yml grids.ehdrom; do
        romrun base.yml --cases cases.csv --model $model -o $model.h5 --quiet >/dev/null
        romrun --check $model.h5
        [ "$(romrun --print $model.h5 part | tail -n +2 | grep -o '[0-9]*$' | tr '\n' ' ')" = "0 1 " ]
        film=$(romrun --print $model.h5 central_film_thickness | tail -n 1 | grep -o '[0-9.e+-]*$')
        close_to "$film" "$alone" 1e-6
    done
    # a scene outside of both ranges is solved by the full model on the grid of the nearest part, though the range of
    # the other part is larger
    romrun base.yml --set moes.M=40 --set moes.L=4 --model grids.yml --fallback full --quiet -o far.h5 >far.txt
    grep -q '^solved by  *the full model' far.txt && grep -q '^grid  *121 nodes' far.txt
    # for a transient contact, all parts must have the same grid
    for model in grids.yml grids.ehdrom; do
        refused 65 "found 121 nodes from -4 in steps of 0.05, expected for contacts in time the grid of .*, 61 from -4 in steps of 0.1" \
            romrun moving.yml --model $model
    done
    outside
    run "$BIN/../unit/use_library" march grids.yml moving.yml 0.02 3
    [ "$status" -ne 0 ]
    [[ $output == *"high.h5: found 121 nodes "*", expected for contacts in time the grid of coarse.h5, 61 "* ]]
    # the library gives fields as long as the grid of the part
    sed 's/^regime.*/&\nmoes: {M: 20, L: 4}/' base.yml >scene.yml
    for case in "9 61" "21 121"; do
        run -0 "$BIN/../unit/use_library" solve grids.yml scene.yml moes.M "${case% *}"
        read -r film part <<<"$(solved "${case% *}" grids.yml)"
        close_to "$(awk '$1 == "central_film_thickness" { print $2 }' <<<"$output")" "$film" 1e-6
        grep -qx "nodes ${case#* }" <<<"$output"
    done
}

@test "bad lists" {
    bad() {
        echo "$2" >bad.yml
        refused 65 "bad.yml(:1)?: $1" romrun base.yml --set moes.M=9 --set moes.L=4 --model bad.yml
    }
    bad "models: found nothing, expected a map with it" "{}"
    bad "models: found .*, expected a map with it" "- low.h5"
    bad "model: found an unknown key, expected models" "model: [low.h5]"
    bad "models: found an empty list, expected a list of one to 16 model.h5" "models: []"
    bad "models: found .*, expected a list of one to 16 model.h5" "models: low.h5"
    bad "models: found a longer list" "models: [$(printf 'low.h5, %.0s' {1..16}) low.h5]"
    bad "models: found the name of a list of models, expected the name of a model.h5" "models: [parts.yml]"
    bad "models: found .*, expected the name of a model.h5" "models: [{a: 1}]"
    echo 'models: [low.h5, none.h5]' >lacks.yml
    refused 66 "none.h5: " romrun base.yml --set moes.M=9 --set moes.L=4 --model lacks.yml
    refused 66 "nothing.yml: " romrun base.yml --model nothing.yml
    # no output may overwrite a model of the list
    refused 73 "low.h5: found an input as output" \
        romrun base.yml --set moes.M=9 --set moes.L=4 --model parts.yml -o low.h5 --force
    sed -i 's/lubricant:/discretization: published\n&/' base.yml
    part published "8, 9.5, 11, 13, 15" "10"
    echo 'models: [low.h5, published.h5]' >rows.yml
    refused 65 "published.h5: found a line contact with 121 nodes from -4 in steps of 0.05 .published, .*, expected one as of low.h5: a line contact with 121 .* .accurate, " \
        romrun base.yml --set moes.M=9 --set moes.L=4 --model rows.yml
    refused 64 "parts.yml: found a list of models with romrun calibrate, expected one model" \
        romrun --calibrate base.yml --model parts.yml -o x.h5
    refused 64 "parts.yml: found a list of models with --pressure-modes" \
        romrun base.yml --model parts.yml --rows 20
}
