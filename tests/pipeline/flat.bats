#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests of flat models: they give the same bits as the HDF5 models that they are made from, and damaged flat models are
# refused.

load common

# Makes models of a line contact, coupled and calibrated (c.h5) and independent (i.h5), and of a point contact (p.h5).
# Exports each model as NAME.ehdrom.
setup_file() {
    cd "$BATS_FILE_TMPDIR" || return
    small_model
    podbuild s.h5 -o bi.h5 --deformation independent --pressure-modes 8 --deformation-modes 7
    snapgen train.yml --basis bi.h5 -o ri.h5 --quiet
    deimselect --no-check ri.h5 --basis bi.h5 -o i.h5 --rows 25
    mv scene.yml line.yml
    point_scene 13 -2.5
    mv scene.yml point.yml
    cat >points.yml <<'YAML'
groups:
  - scene: point.yml
    vary: {moes.M: [11, 15], moes.L: [4, 6]}
YAML
    snapgen points.yml -o sp.h5 --quiet
    podbuild sp.h5 -o bp.h5
    snapgen points.yml --basis bp.h5 -o rp.h5 --quiet
    deimselect --no-check rp.h5 --basis bp.h5 -o p.h5 --rows 60 --method sopt
    for model in c i p; do romrun --export $model.h5 -o $model.ehdrom; done
}

setup() {
    cd "$BATS_TEST_TMPDIR" || return
    cp "$BATS_FILE_TMPDIR"/{c,i,p}.* "$BATS_FILE_TMPDIR"/{line,point}.yml .
}

# in_time SCENE: writes moving.yml, some steps of the scene under a load that swings.
in_time() {
    sed 's/stationary/transient/' "$1" >moving.yml
    cat >>moving.yml <<'YAML'
transport: upwind
transient: {load: {law: sine, amplitude: 0.05, period: 1}, fixed_step: 0.02, end_time: 0.2}
YAML
}

# bats test_tags=slow
@test "a scene has the same bits by either file, stationary and in time, with what is indicated" {
    for model in c:line i:line p:point; do
        scene=${model#*:}.yml model=${model%:*}
        for kind in h5 ehdrom; do
            romrun $scene --model $model.$kind --allow-untrusted -o $kind.out --quiet --force >$kind.txt
        done
        same_data h5.out ehdrom.out
        diff <(grep -v '^solution' h5.txt) <(grep -v '^solution' ehdrom.txt)
        in_time $scene
        for kind in h5 ehdrom; do
            romrun moving.yml --model $model.$kind --allow-untrusted -o $kind.out --quiet --force
        done
        same_data h5.out ehdrom.out
    done
    # a flat model keeps the calibration, so this run needs no --allow-untrusted
    romrun line.yml --model c.ehdrom --quiet >indicated.txt
    grep -q 'indicated' indicated.txt
}

@test "fields are those of the same tables, and a part is exported as a part" {
    romrun line.yml --model c.h5 --pressure-modes 9 --rows 20 --allow-untrusted -o h5.out --quiet --set output.fields=true
    romrun --export c.h5 --pressure-modes 9 --rows 20 -o part.ehdrom
    romrun line.yml --model part.ehdrom --allow-untrusted -o flat.out --quiet --set output.fields=true
    [ "$(stat -c %s part.ehdrom)" -lt "$(stat -c %s c.ehdrom)" ]
    /usr/bin/python3 - <<'PYTHON'
import h5py, numpy
with h5py.File("h5.out") as one, h5py.File("flat.out") as other:
    assert one["central_film_thickness"][0] == other["central_film_thickness"][0]
    for name in "pressure", "film_thickness":
        assert numpy.allclose(one[name][...], other[name][...], rtol=0, atol=1e-13), name
PYTHON
    refused 65 "part.ehdrom: found a flat model of 9 pressure modes" romrun line.yml --model part.ehdrom --pressure-modes 8
    # each export has the same bytes
    romrun --export c.h5 -o again.ehdrom
    cmp again.ehdrom c.ehdrom
}

@test "the command line, and files that are there" {
    refused 73 "c.ehdrom: found an existing file" romrun --export c.h5 -o c.ehdrom
    romrun --export c.h5 -o c.ehdrom --force
    refused 64 "expected -o FILE" romrun --export c.h5
    refused 64 "--model: found with c.h5, expected one of them" romrun --export c.h5 --model c.h5 -o x.ehdrom
    refused 66 "none.h5" romrun --export none.h5 -o x.ehdrom
    refused 73 "no/x.ehdrom: found No such file or directory" romrun --export c.h5 -o no/x.ehdrom
    [ ! -e x.ehdrom ]
    [ ! -e x.ehdrom.partial ]
}

# bats test_tags=slow
@test "what is made beside HDF5 files goes to regular files of its own" {
    echo mine >other
    mkfifo pipe
    mkdir folder
    sed -i 's/moes: .*/physical: {load: 60e3, radius: 0.0125, speed: 0.8, modulus: 226e9, viscosity: 0.02}/' line.yml
    printf 'moes.M\n12\n' >cases.csv
    echo 'moes: {M: 12, L: 4}' | cat <(grep -v physical line.yml) - >moes.yml
    for command in "romrun --export c.h5" "romrun -q --fmu line.yml --model c.h5" "romrun -q moes.yml --cases cases.csv --model c.h5 --allow-untrusted"; do
        name=x.csv # the name that the last command requires
        # a link that another user put there is not followed, and a pipe is not opened
        ln -sf other $name.partial
        refused 73 "$name.partial: found" $command -o $name
        ln -f pipe $name.partial
        refused 73 "$name.partial: found" $command -o $name
        rm $name.partial
        [ "$(cat other)" = mine ]
        # a link to a folder, a device or a pipe is not replaced, even with --force
        for there in folder /dev/null pipe; do
            ln -sf "$there" $name
            refused 73 "$name: found" $command -o $name --force
            [ -L $name ]
            rm $name
        done
        ln -s nowhere $name
        refused 73 "$name: found an existing file" $command -o $name
        [ -L $name ]
        rm $name
    done
    # an input is not replaced, whatever name it is given by
    ln cases.csv hard.csv
    for command in "romrun --export c.h5 -o c.h5" "romrun --fmu line.yml --model c.h5 -o line.yml" "romrun moes.yml --cases cases.csv --model c.h5 -o hard.csv"; do
        refused 73 "found an input as output" $command --force
    done
    cp c.h5 c.vti
    refused 73 "found an input as output" romrun --vtk c.vti -o c.vti --force
    # the writer of HDF5 files does not follow links either
    ln -s nowhere x.h5
    refused 73 "x.h5: found an existing file" romrun moes.yml --model c.h5 -o x.h5
}

# bats test_tags=slow
@test "damage is found, and a stranger's numbers lead nowhere" {
    head -c 100000 c.ehdrom >cut.ehdrom
    refused 65 "cut.ehdrom: found" romrun line.yml --model cut.ehdrom
    refused 65 "cut.ehdrom: found" romrun --check cut.ehdrom
    romrun --check c.ehdrom
    (cat c.ehdrom && head -c 64 /dev/zero) >longer.ehdrom
    refused 65 "longer.ehdrom: found" romrun line.yml --model longer.ehdrom
    /usr/bin/python3 - <<'PYTHON'
data = bytearray(open("c.ehdrom", "rb").read())
data[len(data) // 2] ^= 1
open("bit.ehdrom", "wb").write(data)
PYTHON
    refused 65 "bit.ehdrom: found another checksum" romrun line.yml --model bit.ehdrom
    # a file of another version or of the other byte order is refused, whatever its checksum
    /usr/bin/python3 - <<'PYTHON'
import struct
data = open("c.ehdrom", "rb").read()
version, order = struct.unpack_from("<II", data, 8)
for name, head in ("newer", struct.pack("<II", version + 1, order)), ("older", struct.pack("<II", 0, order)), \
        ("turned", struct.pack("<I", version) + data[12:16][::-1]):
    open(name + ".ehdrom", "wb").write(data[:8] + head + data[16:])
PYTHON
    refused 65 "newer.ehdrom: found version 7 \(byte order 0x1020304\), expected 6" romrun line.yml --model newer.ehdrom
    refused 65 "older.ehdrom: found version 0 .*, expected 6" romrun --check older.ehdrom
    refused 65 "turned.ehdrom: found version 6 \(byte order 0x4030201\), expected 6 \(0x1020304\)" \
        romrun line.yml --model turned.ehdrom
    # with the checksum switched off, each number that places data is replaced by other numbers
    export EHDROM_DIGEST=no
    /usr/bin/python3 - <<'PYTHON'
import random, struct, subprocess
random.seed(1)
wild = [0, 1, 2, 7, 1 << 31, 1 << 62, (1 << 64) - 1] + [struct.unpack("<Q", struct.pack("<d", x))[0]
        for x in (float("nan"), float("inf"), -1.0, 1e300, 1e-300)]
count = refused = 0
for model, scene in ("c", "line.yml"), ("p", "point.yml"):
    data = open(model + ".ehdrom", "rb").read()
    blocks, at = [], 64
    while at < len(data):
        number, size = struct.unpack_from("<QQ", data, at + 48)
        blocks.append((data[at:at + 48].rstrip(b"\0").decode(), at, number, size))
        at += 64 + (number * size + 63) // 64 * 64
    for name, at, number, size in blocks:
        # all single numbers and headers are tried, and some entries of arrays
        places = [at + 48, at + 56] + [at + 64 + 8 * i for i in
                  ([0] if number == 1 else sorted(random.sample(range(number * size // 8), min(2, number * size // 8))))]
        for place in places:
            changed = bytearray(data)
            struct.pack_into("<Q", changed, place, random.choice(wild))
            open("wild.ehdrom", "wb").write(changed)
            done = subprocess.run(["romrun", scene, "--model", "wild.ehdrom", "--quiet"], capture_output=True, timeout=60)
            count += 1
            refused += done.returncode == 65
            assert done.returncode in (0, 3, 4, 65, 71), (model, name, place - at, done)
print(count, refused)
assert count > 200 and refused > count / 2
PYTHON
}
