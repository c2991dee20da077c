#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests of one command for a region that is too wide for one model: the region is split into parts.

load common

lib=$BATS_TEST_DIRNAME/../../scenes/lib

setup() {
    cd "$BATS_TEST_TMPDIR" || return
    common_setup_small
    cat >region.yml <<'YAML'
groups:
  - scene: base.yml
    region: {moes.M: [6, 24], moes.L: [2, 6]}
    candidates: 120
YAML
}

# train ARGUMENT...: runs the command.
train() { make -f "$lib/pipeline.mk" PLAN=region.yml JOBS=1 "$@"; }

# solves MODEL MOES_M...: checks that MODEL and the full model agree on scenes between the training points.
solves() {
    local model=$1 moes_M
    shift
    for moes_M; do
        set -- --set moes.M="$moes_M" --set moes.L=3.3
        romrun scene.yml --model "$model" -o reduced.h5 --force --quiet --set output.fields=true "$@" >/dev/null
        fullrun scene.yml --grid-of reduced.h5 -o full.h5 --force --quiet "$@" >/dev/null
        close_to "$(number reduced.h5 central_film_thickness)" "$(number full.h5 central_film_thickness)" 1e-2
    done
}

@test "snapgen --num-parts: plans for ranges of M that overlap and cover the region" {
    snapgen region.yml --num-parts 3 -o list.txt
    cat list.txt M-*.yml
    sed -i '/^# line --set grid.x_min=-4 --set grid.x_max=2 --set grid.step=0.05$/d' list.txt
    awk 'NR == 1 && $2 != 6 || NR > 1 && !($2 < high && $3 > high) { bad = 1 } { high = $3; n++ }
         END { exit bad || n != 3 || high != 24 }' list.txt
    while read -r plan _; do
        run --separate-stderr snapgen "$plan" --adaptive --max-points 4 --start 4 -o "$plan.h5" --quiet
        [ "$status" -eq 0 ]
        # each part has as many candidates as the whole region, within a fifth
        [[ $output =~ ^"4 points of "([0-9]+)"," ]]
        ((BASH_REMATCH[1] > 96 && BASH_REMATCH[1] < 144))
    done <list.txt
    # the plan of a part names the plan of the whole; a file is replaced only with --force
    refuse 73 "list.txt" snapgen region.yml --num-parts 2 -o list.txt
    # without --force no file is replaced; the plan is never replaced, nor one part by the next one
    refuse 73 "M-6-.*yml" snapgen region.yml --num-parts 3 -o other.txt
    refuse 73 "list.txt" snapgen region.yml --adaptive --parts list.txt -o s.h5
    refuse 73 "region.yml" snapgen region.yml --num-parts 3 -o region.yml --force
    grep -q region: region.yml
    sed 's/M: \[6, 24\]/M: [100, 105]/' region.yml >close.yml
    refused 65 "found points of too few different M, expected 16 parts" snapgen close.yml --num-parts 16 -o none.txt
    # the folder may have any name
    local folder=$'a "b\nc'
    mkdir "$folder"
    cp region.yml base.yml "$folder"
    snapgen "$folder/region.yml" --num-parts 2 -o quoted.txt --force
    snapgen "$(tail -n 1 quoted.txt | cut -d ' ' -f 1)" --num-parts 2 -o again.txt --force
    sed 's/M: \[6, 24\]/M: [8, 8.0000001]/' region.yml >narrow.yml
    refused 65 "found points of too few different M, expected 16 parts" snapgen narrow.yml --num-parts 16 -o none.txt
    refuse 64 "--parts: found without --adaptive" snapgen plan.yml --parts two.txt -o s.h5
    refuse 64 "--num-parts: found with --basis" snapgen region.yml --basis b.h5 --num-parts 2 -o s.h5
}

# bats test_tags=slow
@test "the parts that are asked for, their list, and who takes it" {
    run train ACCURACY=1e-2 SPLIT=2
    echo "$output"
    [ "$status" -eq 0 ]
    [ "$(grep -c '^  parts      2 of the region, along M: 6 to .*, .* to 24$' <<<"$output")" -eq 1 ]
    # the trainings of all parts are the first stages, then the models follow
    grep -q "stage 1 of 10" <<<"$output"
    grep -q "stage 10 of 10, about 0 s in all" <<<"$output"
    [ "$(tail -n 1 <<<"$output")" = "model: $PWD/out/model.yml" ]
    [ ! -e out/model.h5 ] && [ ! -e out/snapshots.h5 ]
    romrun --check out/model.yml
    solves out/model.yml 6.2 8 10.5 12 13 17 23.5
    # a second run has nothing left to do, and repeats nothing
    run train ACCURACY=1e-2 SPLIT=2
    [ "$output" = "model: $PWD/out/model.yml" ]
    # both parts have the grid of the scene: programs accept the list in place of a model
    sed 's/^moes:.*/physical: {load: 5e4, radius: 0.0125, speed: 1, modulus: 2.3e11, viscosity: 0.04}/' scene.yml >si.yml
    romrun --fmu si.yml --model out/model.yml -o contact.fmu
    romrun --export out/model.yml -o model.ehdrom
    romrun --check model.ehdrom
    # a part that is lost is made again, and the other part is not
    rm out/M-6-*/model.h5
    run train ACCURACY=1e-2 SPLIT=2
    [ "$(grep -c deimselect <<<"$(grep '^  ' <<<"$output")")" -eq 1 ]
    # a changed plan is trained again
    sed -i 's/24/20/' region.yml
    run train ACCURACY=1e-2 SPLIT=2
    [[ $output == *"along M: 6 to "*" to 20"* ]]
}

# bats test_tags=slow
@test "a region whose errors do not fall fast enough becomes parts, and one that is small does not" {
    # the training starts with the corners only, so that twenty points are many
    few=(ACCURACY=1e-4 SNAPGEN_OPTIONS='--start 4')
    run train "${few[@]}" OUT=parts
    echo "$output"
    [ "$status" -eq 0 ]
    [ "$(grep -c '^  parts      [2-9] of the region, along M: ' <<<"$output")" -eq 1 ]
    grep -q "points do not make one model yet, two parts are in parts/two-parts.txt" <<<"$output"
    [ -e parts/model.yml ]
    solves parts/model.yml 6.2 9 12.3 14 23.5
    # parts may be split further, and cover the whole region
    sed 's/M: \[6, 24\]/M: [4, 40]/' region.yml >wide.yml
    make -f "$lib/pipeline.mk" PLAN=wide.yml JOBS=1 ACCURACY=1e-8 SNAPGEN_OPTIONS='--start 4 --max-points 70' OUT=wide wide/parts.mk
    cat wide/parts.txt
    awk 'NR == 1 && $2 != 4 || NR > 1 && !($2 < high) { bad = 1 } { high = $3 } END { exit bad || NR < 3 || high != 40 }' wide/parts.txt
    # SPLIT=1 keeps one model
    run train "${few[@]}" OUT=one SPLIT=1 one/snapshots.h5
    [ "$status" -eq 0 ]
    [[ $output != *"parts"* ]]
    # a region that one model covers early stays one model, with the bits of a training that cannot be split
    sed 's/M: \[6, 24\]/M: [10, 11]/' region.yml >small.yml
    make -f "$lib/pipeline.mk" PLAN=small.yml ACCURACY=1e-2 JOBS=1 OUT=small small/snapshots.h5
    snapgen small.yml --adaptive --accuracy 1e-2 -o direct.h5 --jobs 1 --quiet
    same_data small/snapshots.h5 direct.h5
    [ "$(head -n 1 small/parts.mk)" = "REGION_PARTS := " ]
}

# bats test_tags=slow
@test "one grid for all parts, where a contact in time is to pass from one to the other" {
    printf 'contact: line\nregime: stationary\nlubricant: {viscosity: {law: barus, alpha: 2e-8}}\n' >base.yml
    sed -i 's/M: \[6, 24\]/M: [6, 45]/' region.yml
    grids() { for file in out/M-*/snapshots.h5; do echo "$(number "$file" x_min) $(number "$file" step)"; done | sort -u | wc -l; }
    train ACCURACY=0.05 SPLIT=2 out/parts.mk SNAPGEN_OPTIONS='--max-points 6 --start 6'
    [ "$(grids)" -eq 2 ]
    train ACCURACY=0.05 SPLIT=2 ONE_GRID=1 out/parts.mk SNAPGEN_OPTIONS='--max-points 6 --start 6'
    [ "$(grids)" -eq 1 ]
    snapgen region.yml -o list.txt --num-parts 2 --set contact=point --set grid.step=0.1
    grep -q '^# point --set grid.x_min=-.* --set grid.step=0.1 --set grid.y_max=' list.txt
}

# bats test_tags=slow
@test "settings in quotes, and a training that is compressed, which is not done again" {
    sed -i 's/M: \[6, 24\]/M: [10, 11]/' region.yml
    compressed=(ACCURACY=1e-2 PARTS=yes SET="--set 'lubricant.density.law=incompressible'" out/parts.mk out/part.h5)
    train "${compressed[@]}"
    inode=$(stat -c %i out/snapshots.h5)
    run timeout 60 make -f "$lib/pipeline.mk" PLAN=region.yml JOBS=1 "${compressed[@]}"
    [ "$status" -eq 0 ]
    [ "$(stat -c %i out/snapshots.h5)" = "$inode" ]
    train ACCURACY=1e-2 SPLIT=2 OUT=two SET="--set 'lubricant.density.law=incompressible'" two/parts.mk
    grep -q '^REGION_PARTS := M-10-.* M-10.*-11$' two/parts.mk
}

@test "a part of a plan is trained again when a scene of that plan has changed" {
    mkdir whole
    mv base.yml region.yml whole
    printf 'part_of: whole/region.yml\nwhere: {moes_M: [6, 12]}\n' >part.yml
    one=(-f "$lib/pipeline.mk" PLAN=part.yml SPLIT=1 SNAPGEN_OPTIONS='--max-points 6 --start 6' out/snapshots.h5)
    make "${one[@]}"
    make -q "${one[@]}"
    touch -d '1 minute' whole/base.yml
    run make -q "${one[@]}"
    [ "$status" -eq 1 ]
}

# bats test_tags=slow
@test "make says what it would do, and cleans, without training" {
    run make -n -f "$lib/pipeline.mk" PLAN=region.yml ACCURACY=1e-2
    [ "$status" -eq 0 ]
    [ ! -e out/snapshots.h5 ]
    run make -n -f "$lib/pipeline.mk" PLAN=region.yml ACCURACY=1e-2 out/parts.mk
    [ "$status" -eq 0 ]
    [ ! -e out/snapshots.h5 ]
    run make help -f "$lib/pipeline.mk" PLAN=region.yml
    [ ! -e out/snapshots.h5 ]
    # a number of parts is either used or refused
    run make -n -f "$lib/pipeline.mk" PLAN=region.yml SPLIT=2 SLURM=1
    [[ $status == 2 && $output == *"SPLIT: found 2 on Slurm, expected 1."* ]]
    run make -n -f "$lib/pipeline.mk" PLAN=plan.yml SPLIT=2
    [[ $status == 2 && $output == *"SPLIT: found 2 for a plan without a region, expected 1."* ]]
    for parts in 0 x 1.5 17 '2 3'; do
        run train SPLIT="$parts"
        echo "$output"
        [[ $status == 2 && ! -e out/snapshots.h5 && $output == *"SPLIT: found $parts, expected a whole number from 1 to 16, or nothing"* ]]
    done
}

# bats test_tags=slow
@test "Ctrl-C loses no part that is trained" {
    train ACCURACY=1e-2 SPLIT=2 out/parts.mk
    inode=$(stat -c %i out/M-6-*/snapshots.h5)
    rm out/parts.mk out/M-11*/snapshots.h5
    run train ACCURACY=1e-2 SPLIT=2 out/parts.mk
    [ "$status" -eq 0 ]
    [ "$(stat -c %i out/M-6-*/snapshots.h5)" = "$inode" ]
    trained=(out/M-*/snapshots.h5)
    [ ${#trained[@]} -eq 2 ]
}
