#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests of romrun --fmu. use_fmu.c imports the FMUs with both versions of FMI.

load common

root=$BATS_TEST_DIRNAME/../..

# Builds use_fmu, a model, and FMUs with the load and with the approach given, and unpacks the FMUs.
setup_file() {
    [ "$(uname -m)" = x86_64 ] || skip "FMUs are made on x86-64"
    cd "$BATS_FILE_TMPDIR" || return
    make -s -C "$root" DEPS=no VARIANT="$VARIANT" build/fmu/use_fmu
    cp "$root/build/fmu/use_fmu" .
    small_point_model
    romrun --fmu point.yml --model p.h5 --fmi 3 -o point.fmu --quiet
    python3 -m zipfile -e point.fmu point
    cat >scene.yml <<'YAML'
contact: line
regime: stationary
physical: {load: 300e3, radius: 0.0125, speed: 0.8, modulus: 226e9, viscosity: 0.08}
lubricant:
  viscosity: {law: roelands, eta0: 0.08, alpha: 2.0e-8}
  density: {law: dowson-higginson}
grid: {x_min: -4, x_max: 2, step: 0.05}
YAML
    sed 's/stationary/transient/' scene.yml >moving.yml
    cat >>moving.yml <<'YAML'
transport: upwind
transient: {end_time: 2, tolerance: 2e-3, load: {law: sine, amplitude: 0.1, period: 1}, speed: {law: sine, amplitude: 0.1, period: 1.4}}
YAML
    cat >plan.yml <<'YAML'
groups:
  - scene: moving.yml
    vary: {physical.load: [270e3, 300e3, 330e3]}
YAML
    snapgen plan.yml -o s.h5 --quiet
    podbuild s.h5 -o b.h5 --pressure-modes 55
    snapgen plan.yml --basis b.h5 -o r.h5 --quiet
    deimselect --no-check r.h5 --basis b.h5 -o m.h5
    for fmi in 2 3; do
        romrun --fmu scene.yml --model m.h5 --fmi $fmi -o $fmi.fmu --quiet
        romrun --fmu scene.yml --model m.h5 --fmi $fmi -o approach$fmi.fmu --quiet \
            --set regime=transient --set transient.end_time=1 --set closure=approach --set transport=upwind
        mkdir $fmi approach$fmi
        python3 -m zipfile -e $fmi.fmu $fmi
        python3 -m zipfile -e approach$fmi.fmu approach$fmi
    done
}

setup() {
    [ "$(uname -m)" = x86_64 ] || skip "FMUs are made on x86-64"
    cd "$BATS_FILE_TMPDIR" || return
    all=$BATS_TEST_TMPDIR
}

object=binaries/x86_64-linux/ehdrom_contact.so

@test "a trajectory has the bits of the library, with either version" {
    for fmi in 2 3; do
        ./use_fmu $fmi $fmi run 40 >"$all/$fmi"
        ./use_fmu $fmi approach$fmi run 40 >"$all/approach$fmi"
    done
    ./use_fmu library 3 40 >"$all/library"
    cmp "$all/library" "$all/2"
    cmp "$all/library" "$all/3"
    cmp "$all/approach2" "$all/approach3"
    [ "$(wc -l <"$all/3")" -eq 41 ]
    [ "$(grep -c 'force=[-0-9]' "$all/approach3")" -eq 41 ]
}

@test "a point contact: the library's force and films, with units of its own" {
    xmllint --noout --schema "$BATS_TEST_DIRNAME/fmi3.xsd" point/modelDescription.xml
    grep '<Float64 name="force"' point/modelDescription.xml | grep 'unit="N"'
    ./use_fmu 3 point run 40 >"$all/point"
    ./use_fmu library point 40 8 1 0.01 >"$all/library"
    cmp "$all/library" "$all/point"
    [ "$(wc -l <"$all/point")" -eq 41 ]
    # the force follows the load, in N
    /usr/bin/python3 - "$all/point" <<'PYTHON'
import math, sys
for i, line in enumerate(open(sys.argv[1])):
    force, film = (float.fromhex(dict(word.split("=") for word in line.split()[1:])[name])
                   for name in ("force", "central_film_thickness"))
    assert abs(force / (8 * (1 + 0.1 * math.sin(2 * math.pi * i / 40))) - 1) < 1e-2, (i, force)
    assert 2e-7 < film < 4e-7, (i, film)
PYTHON
}

@test "a saved state goes on in another process with the same bits" {
    for fmi in 2 3; do
        ./use_fmu $fmi approach$fmi run 40 "$all/state" 25 >"$all/whole"
        ./use_fmu $fmi approach$fmi restore 40 "$all/state" 25 >"$all/rest"
        cmp <(tail -15 "$all/whole") "$all/rest"
    done
}

@test "all calls of both versions, in and out of order; what is not offered is refused and told" {
    local offered='Instantiate|FreeInstance|FreeFMU|Get(TypesPlatform|Version|RealStatus|BooleanStatus|Real|Float64|Integer|Int32|Boolean|FMU.tate|DirectionalDerivative)$|Set(DebugLogging|Real|Float64|Integer|Int32|Boolean|FMU.tate)$|SetupExperiment|E(nter|xit)Initialization|Terminate|Reset|Serialize|De.erialize|DoStep'
    for fmi in 2 3; do
        # the declarations made by macros are included
        names=$(gcc -E -P "$root/romrun/fmu/fmi$fmi.h" | grep -oE "fmi$fmi[A-Z][A-Za-z0-9]* ?\(" | tr -d '( ' | sort)
        # the object has all functions of the standard, and no others
        [ "$(nm -D --defined-only 3/$object | awk '{ print $3 }' | grep "fmi$fmi" | sort)" = "$names" ]
        mapfile -t refused < <(grep -vE "^fmi$fmi($offered)" <<<"$names")
        [ "${#refused[@]}" -gt 15 ]
        ./use_fmu $fmi $fmi calls "${refused[@]}"
    done
    [ -z "$(nm -D --defined-only 3/$object | awk '{ print $3 }' | grep -vE '^fmi[23][A-Z]')" ]
}

@test "a step that cannot be done changes nothing: it is discarded, with a text" {
    for fmi in 2 3; do
        for kind in $fmi approach$fmi; do
            run -0 ./use_fmu $fmi $kind far
            [[ $output == *"logStatusDiscard: step to 3e-06 s: "*"speed: found -"* ]]
            [[ $output =~ "logStatusDiscard: step to 3e-06 s: ".*("also in a step of "|"expected them to get further") ]]
        done
    done
}

@test "bodies may part and come together again: without a force while they are apart" {
    for fmi in 2 3; do
        run -0 ./use_fmu $fmi approach$fmi apart
        [[ $output == *"lost 3 times, found 3 times"* ]]
    done
}

# bats test_tags=slow
@test "a tolerance below the solver's noise is no error" {
    for kind in "2 2" "3 approach3"; do
        run -0 ./use_fmu $kind tolerances
        [[ $output == *"that shorter steps do not make smaller, expected 1e-09 (step_accuracy)"* ]]
    done
}

@test "directional derivatives are those of differences" {
    ./use_fmu 2 2 derivatives
    ./use_fmu 3 approach3 derivatives
}

# bats test_tags=slow
@test "traction of a scene that slides, of each step, and inlet heating; nothing else changes" {
    sliding=(--set slide_roll=0 --set lubricant.shear.law=eyring --set lubricant.shear.tau0=5e6
        --set lubricant.thermal_conductivity=0.14 --set lubricant.viscosity.temperature_coefficient=0.03)
    ./use_fmu 3 3 run 40 >"$all/still"
    for fmi in 2 3; do
        romrun --fmu scene.yml --model m.h5 --fmi $fmi -o "$all/s$fmi.fmu" --quiet "${sliding[@]}"
        python3 -m zipfile -e "$all/s$fmi.fmu" "$all/s$fmi"
        xmllint --noout --schema "$BATS_TEST_DIRNAME/fmi$fmi.xsd" "$all/s$fmi/modelDescription.xml"
        ./use_fmu $fmi "$all/s$fmi" run 40 >"$all/$fmi"
        cmp "$all/still" <(sed 's/ friction_force=.*//' "$all/$fmi") # traction changes no other output
    done
    ./use_fmu library "$all/s3" 40 300e3 0.8 0.0125 slide >"$all/library"
    cmp "$all/library" "$all/2"
    cmp "$all/library" "$all/3"
    grep -c 'friction_force=0x0p+0 .* power_loss=0x' <(head -1 "$all/3")
    positive='=0x1[^ ]*'
    [ "$(tail -40 "$all/3" | grep -c "friction_force$positive friction_coefficient$positive power_loss$positive \
rolling_resistance$positive rolling_moment$positive mean_shear_stress$positive largest_shear_stress$positive \
stationary_inlet_heating_factor=0x1[^ ]*p-1\$")" -eq 40 ]
    ./use_fmu 3 "$all/s3" run 40 "$all/state" 25 >"$all/whole"
    ./use_fmu 3 "$all/s3" restore 40 "$all/state" 25 >"$all/rest"
    cmp <(tail -15 "$all/whole") "$all/rest"
    ./use_fmu 2 "$all/s2" derivatives
    grep '"friction_force" valueReference="28"' "$all/s3/modelDescription.xml" | grep 'unit="N/m"'
    # inputs start from the speeds of both surfaces in the scene
    run -65 romrun --fmu scene.yml --model m.h5 -o "$all/none.fmu" --set slide_roll=0
    [[ $output == *"slide_roll: found a value without lubricant.shear.law, expected a law, because the speeds"* ]]
    romrun --fmu scene.yml --model m.h5 -o "$all/ratio.fmu" --quiet "${sliding[@]}" --set slide_roll=0.1
    romrun --fmu scene.yml --model m.h5 -o "$all/speeds.fmu" --quiet "${sliding[@]}" --set slide_roll= \
        --set physical.speed= --set physical.speed_1=0.84 --set physical.speed_2=0.76
    for name in ratio speeds; do
        python3 -m zipfile -e "$all/$name.fmu" "$all/$name"
        for speed in 1.0.84 2.0.76; do
            start=$(grep "\"surface_speed_${speed%%.*}\"" "$all/$name/modelDescription.xml" | sed 's/.* start="//; s/".*//')
            close_to "$start" "${speed#*.}" 1e-14
        done
    done
    # a film that sliding thins holds for the sliding ratio of the scene: other speeds are refused
    romrun --fmu scene.yml --model m.h5 -o "$all/thinned.fmu" --quiet "${sliding[@]}" --set slide_roll=0.1 \
        --set lubricant.shear.in_film=true
    python3 -m zipfile -e "$all/thinned.fmu" "$all/thinned"
    run ! ./use_fmu 3 "$all/thinned" run 1
    [[ $output == *"as the difference of the surfaces' speeds, expected "* ]]
    # a scene that gives no sliding has no outputs of sliding
    shows_no 'friction\|rolling\|shear\|heating' cat 3/modelDescription.xml
}

@test "a step that is too long is made of parts, each of which could be asked for" {
    ./use_fmu 2 2 parts
    ./use_fmu 3 approach3 parts
}

@test "needs libc and libm alone, of the glibc that it names, and runs on a Core 2" {
    readelf -d 3/$object >"$all/dynamic"
    [ "$(grep -o 'NEEDED.*' "$all/dynamic" | grep -vcE '\[lib[cm]\.so\.6\]|\[ld-linux-x86-64\.so\.2\]')" -eq 0 ]
    run -1 grep -E 'RPATH|RUNPATH' "$all/dynamic"
    newest=$(objdump -T 3/$object | grep -oE 'GLIBC_2\.[0-9]+' | sort -Vu | tail -1)
    grep -q "glibc ${newest#GLIBC_} or newer" 3/documentation/index.html
    for processor in core2duo Nehalem SandyBridge; do
        qemu-x86_64 -cpu $processor ./use_fmu 3 3 run 4 >"$all/old"
        [ "$(wc -l <"$all/old")" -eq 5 ]
    done
    ./use_fmu 3 3 run 4 >"$all/new"
    paste "$all/old" "$all/new" | awk '{
        split($4, old, "="); split($(4 + NF / 2), new, "=")
        if (old[2] == "" || substr(old[2], 1, 12) != substr(new[2], 1, 12)) { print; exit 1 } }'
}

# bats test_tags=slow
@test "the same inputs give the same bytes, without paths, names or history" {
    cp m.h5 "$all/other.h5"
    (cd "$all" && romrun --fmu "$BATS_FILE_TMPDIR/scene.yml" --model other.h5 -o 3.fmu --quiet)
    cmp 3.fmu "$all/3.fmu"
    SOURCE_DATE_EPOCH=1700000000 TZ=Asia/Tokyo romrun --fmu scene.yml --model m.h5 -o "$all/a.fmu" --quiet
    SOURCE_DATE_EPOCH=1700000000 romrun --fmu scene.yml --model m.h5 -o "$all/b.fmu" --quiet
    python3 -m zipfile -l "$all/b.fmu" | grep -c '2023-11-14 22:13:20'
    cmp <(python3 -m zipfile -l "$all/a.fmu") <(python3 -m zipfile -l "$all/b.fmu")
    run -1 grep -rlaE "$PWD|$root|/home/|/root/|podbuild s.h5" 3
    for licence in ehdrom libgsl-dev libfftw3-dev libyaml-dev nettle-dev GPL-3; do
        [ -s "3/documentation/licenses/$licence.txt" ]
    done
}

@test "modelDescription.xml has the standard's form" {
    for fmi in 2 3; do
        for kind in $fmi approach$fmi; do # one file at a time, as xmllint checks keys over all files
            xmllint --noout --schema "$BATS_TEST_DIRNAME/fmi$fmi.xsd" $kind/modelDescription.xml
        done
    done
    SOURCE_DATE_EPOCH=1700000000 romrun --fmu scene.yml --model m.h5 -o "$all/a&<b>.fmu" --quiet
    python3 -m zipfile -e "$all/a&<b>.fmu" "$all/dated"
    xmllint --noout --schema "$BATS_TEST_DIRNAME/fmi3.xsd" "$all/dated/modelDescription.xml"
    grep -q 'generationDateAndTime="2023-11-14T22:13:20Z"' "$all/dated/modelDescription.xml"
}

@test "what makes no FMU is told, and nothing is left" {
    run -64 romrun --fmu scene.yml --model m.h5
    run -64 romrun scene.yml --model m.h5 --fmi 2
    run -73 romrun --fmu scene.yml --model m.h5 -o 3.fmu
    run -65 romrun --fmu scene.yml --model m.h5 -o "$all/x.fmu" --set physical.load= --set physical.radius= \
        --set physical.speed= --set physical.modulus= --set physical.viscosity= --set moes.M=10 --set moes.L=4
    run -66 romrun --fmu scene.yml --model none.h5 -o "$all/x.fmu"
    SOURCE_DATE_EPOCH=now run -64 romrun --fmu scene.yml --model m.h5 -o "$all/x.fmu"
    [ ! -e "$all/x.fmu" ]
    [ ! -e "$all/x.fmu.partial" ]
    [ -z "$(find /tmp -maxdepth 1 -name 'ehdrom-fmu-*' -newer "$all")" ]
    # the binary refuses the description of another FMU, and a model that is not flat
    cp -r 3 "$all/mixed" && cp approach3/modelDescription.xml "$all/mixed"
    run ! ./use_fmu 3 "$all/mixed" run 1
    [[ $output == *"token: found {"* ]]
    cp m.h5 "$all/mixed/resources/model.ehdrom" && cp 3/modelDescription.xml "$all/mixed"
    run ! ./use_fmu 3 "$all/mixed" run 1
    [[ $output == *"found no flat model"* ]]
}
