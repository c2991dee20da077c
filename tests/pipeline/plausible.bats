#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests what users see of values in wrong units and of friction that no lubricant carries, in all programs.

load common

setup() {
    cd "$BATS_TEST_TMPDIR" || return
    cat >gear.yml <<'YAML'
contact: line
regime: stationary
physical: {load: 500e3, radius: 0.012, speed: 4, modulus: 226e9}
lubricant:
  viscosity: {law: roelands, eta0: 0.05, alpha: 2.0e-8}
  density: {law: dowson-higginson}
YAML
}

@test "an impossible quantity is refused before work, with the setting that is in another unit" {
    printf 'groups:\n  - scene: gear.yml\n    vary: {physical.load: [500, 800]}\n' >plan.yml
    refused 65 'gear.yml: M: found 0.0152, expected at least 0.1 .*: is physical.load = 500 in N/mm\?$' \
        fullrun gear.yml --set physical.load=500
    refused 65 'physical.modulus = 226000 in MPa\?$' fullrun gear.yml --set physical.modulus=226000
    refused 65 'Hertz pressure: found 38.7 GPa' fullrun gear.yml --set physical.load=500e6
    refused 65 'plan.yml: point M=0.01.*: is physical.load = 500 in N/mm\?$' snapgen plan.yml -o s.h5
    [ ! -e s.h5 ]
}

@test "an implausible quantity is solved with a warning, which --quiet keeps" {
    run --separate-stderr fullrun gear.yml --set physical.speed=4000 --quiet
    [ "$status" = 0 ]
    [[ "$stderr" == "fullrun: gear.yml: speed: found 4e+03 m/s, expected at most 300 m/s "*": is physical.speed = 4000 in mm/s?" ]]
    printf 'groups:\n  - scene: gear.yml\n    vary: {physical.speed: [4, 4000]}\n' >plan.yml
    run --separate-stderr snapgen plan.yml -o s.h5 --quiet
    [[ "$stderr" == "snapgen: plan.yml: point M=0.48"*": speed: found 4e+03 m/s"* ]]
    run --separate-stderr fullrun gear.yml
    [ "$status" = 0 ]
    [ -z "$stderr" ]
}

@test "--describe prints what follows from a scene, and what is wrong with it" {
    run -0 --separate-stderr fullrun --describe gear.yml
    [[ "$output" == *"Hertz pressure          1.22422 GPa"* ]]
    [[ "$output" == *"half width a            0.260011 mm"* ]]
    [ -z "$stderr" ]
    run -0 --separate-stderr romrun --describe gear.yml --set physical.speed=4000
    [[ "$stderr" == *"physical.speed = 4000 in mm/s?" ]]
    run -65 --separate-stderr romrun --describe gear.yml --set physical.load=500
    [[ "$output" == *"M                       0.0151808"* ]]
    [[ "$stderr" == *"physical.load = 500 in N/mm?" ]]
    refused 64 "--describe: found --output too" fullrun --describe gear.yml -o r.h5
    refused 64 "command line: found 1 file, expected none" fullrun --describe gear.yml gear.yml
}

@test "--describe of a model prints its range, its size and its errors" {
    small_model
    run -0 romrun --describe c.h5
    [[ "$output" == *"trained range of M      8 to 15"* ]]
    [[ "$output" == *"  moes.M                        10 to 12"* ]]
    [[ "$output" == *"  lubricant.viscosity.law       barus"* ]]
    [[ "$output" == *"largest of 4 scenes"* ]]
    run -0 romrun --describe m.h5
    [[ "$output" == *"checked                 no: results have no error estimates"* ]]
    romrun export c.h5 -o c.ehdrom
    run -0 romrun --describe c.ehdrom
    [[ "$output" == *"training solutions      15"* ]]
    refused 66 "none.h5: found No such file" romrun --describe none.h5
    refused 65 "b.h5" romrun --describe b.h5
}

@test "a multibody program's table in engineering units is solved by one command" {
    sed -i 's/stationary/transient/; s/^physical:.*/physical: {load: 500 N\/mm, radius: 12 mm, speed: 4 m\/s, modulus: 226 GPa}/' gear.yml
    cat >>gear.yml <<'YAML'
transient:
  end_time: 0.2 ms
  load: {law: table, file: mesh.csv, column: Fn}
  speed: {law: table, file: mesh.csv, column: u}
YAML
    cp gear.yml factors.yml
    # 0.26001 mm at 4 m/s: a unit of time of 6.5003e-5 s
    printf 'index;t (ms);Fn [N/mm];u [m/s]\n0;0;450;4,0\n1;0,1;500;4,4\n2;0,3;520;5\n' >mesh.csv
    awk 'BEGIN { unit = 0.260010845 / 4; print "T,Fn,u\n0,0.9,1"; printf "%.10g,1,1.1\n%.10g,1.04,1.25\n", 0.1 / unit, 0.3 / unit }' >factors.csv
    sed -i 's/mesh.csv/factors.csv/' factors.yml
    run -0 --separate-stderr fullrun gear.yml -o units.h5 --quiet
    run -0 --separate-stderr fullrun factors.yml -o factors.h5
    [[ "$stderr" == *"factors.csv: found a column without a unit: times are taken as T, values as factors"* ]]
    close_to "$(number units.h5 central_film_thickness)" "$(number factors.h5 central_film_thickness)" 1e-6
    # values in N/m under a header in N/mm, and the other way round
    sed 's/;450;/;450000;/; s/;500;/;500000;/; s/;520;/;520000;/' mesh.csv >wrong.csv
    sed -i 's/mesh.csv/wrong.csv/' gear.yml
    refused 65 "wrong.csv: Fn: found 1040 in row 3, expected a factor on the reference value" fullrun gear.yml
    sed -i 's/Fn .N.mm./Fn [N\/m]/; s/000;/;/' wrong.csv
    refused 65 "gear.yml: transient.load: found at most 0.00104 times the reference, where M: found 0.01" fullrun gear.yml
    [ "$(fullrun --print units.h5 time | wc -l)" = "$(fullrun --print factors.h5 time | wc -l)" ]
}

@test "sliding needs a law of shear stress, and a ratio" {
    refused 65 "slide_roll: found 0.05 without lubricant.shear.law, expected a law: eyring" fullrun gear.yml --set slide_roll=0.05
    refused 65 "slide_roll: found 50, expected a number from -2 to 2" fullrun gear.yml --set slide_roll=50
    refused 65 "slide_roll: found 0.4 without lubricant.shear.law" fullrun gear.yml --set physical.speed= \
        --set physical.speed_1=1.2 --set physical.speed_2=0.8
    run -0 fullrun gear.yml --set slide_roll=0
    [[ "$output" == *"rolling resistance"* ]]
}

@test "friction above 0.2 is warned of, friction above the load is not trusted" {
    run --separate-stderr fullrun gear.yml --set slide_roll=0.0015 --set lubricant.shear.law=newtonian
    [ "$status" = 0 ]
    [[ "$stderr" == *"friction coefficient: found 0.285, expected at most 0.2"* ]]
    run --separate-stderr fullrun gear.yml --set slide_roll=0.05 --set lubricant.shear.law=newtonian -o r.h5
    [ "$status" = 4 ]
    [[ "$stderr" == *"found a friction above the load"* ]]
    [ "$(fullrun --print r.h5 status | tail -n 1)" = 4 ]
    run -0 fullrun gear.yml --set slide_roll=0.05 --set lubricant.shear.law=newtonian --allow-untrusted
    # in time
    sed 's/stationary/transient/' gear.yml >time.yml
    echo 'transient: {end_time: 0.1, fixed_step: 0.05}' >>time.yml
    run --separate-stderr fullrun time.yml --set slide_roll=0.05 --set lubricant.shear.law=newtonian
    [ "$status" = 4 ]
    [[ "$stderr" == *"found a friction above the load"*", first at T = 0"* ]]
}
