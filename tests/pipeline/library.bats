#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests of the installed library from outside of the tree: header, shared and static library, pkg-config.

load common

root=$BATS_TEST_DIRNAME/../..

# Makes installed/ by make install, and builds two programs with it (C11 shared, C++17 static).
install_all() {
    make -C "$root" -s install VARIANT="$VARIANT" DEPS=no DESTDIR="$PWD/installed" PREFIX=/usr >install.log 2>&1 ||
        { cat install.log >&2; return 1; }
    export PKG_CONFIG_PATH=$PWD/installed/usr/lib/pkgconfig
    local strict='-Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror -O1 -pthread'
    cp "$root/tests/pipeline/use_library.c" .
    # shellcheck disable=SC2046
    gcc -std=c11 -D_POSIX_C_SOURCE=200809L $strict use_library.c -o use_shared \
        $(pkg-config --define-prefix --cflags --libs ehdrom) -lm
    # shellcheck disable=SC2046
    g++ -std=c++17 $strict -x c++ use_library.c -x none -o use_static -Linstalled/usr/lib -l:libehdrom.a \
        -Wl,--as-needed $(pkg-config --define-prefix --static --cflags --libs ehdrom)
    ldd use_static >needed
    if grep ehdrom needed; then return 1; fi
}

# Makes models with 121 nodes and the programs; use_inside is linked with the objects of this variant.
setup_file() {
    cd "$BATS_FILE_TMPDIR" || return
    ! is_installed || install_all
    cp "$BIN/../unit/use_library" use_inside
    small_point_model
    common_setup_small
    snapgen plan.yml -o s.h5 --quiet
    podbuild s.h5 -o b.h5 --pressure-modes 9
    snapgen plan.yml --basis b.h5 -o r.h5 --quiet
    deimselect --no-check r.h5 --basis b.h5 -o m.h5
}

setup() {
    cd "$BATS_TEST_TMPDIR" || return
    kinds=$(cd "$BATS_FILE_TMPDIR" && ls use_* | sed -n 's/^use_\([a-z]*\)$/\1/p')
    [ -n "$kinds" ]
    cp "$BATS_FILE_TMPDIR"/{m.h5,scene.yml,base.yml,p.h5,point.yml} .
    prefix=$BATS_FILE_TMPDIR/installed/usr
}

use_library() {
    env LD_LIBRARY_PATH="$prefix/lib" "$BATS_FILE_TMPDIR/use_$1" "${@:2}"
}

# value NAME: prints a value of the lines "NAME VALUE" in $output
value() {
    awk -v name="$1" '$1 == name { print $2 }' <<<"$output"
}

@test "names: all begin with ehdrom_, and the header has those of the version script" {
    outside
    local names
    names=$(nm -D --defined-only "$prefix/lib/libehdrom.so" | awk '$2 != "A" { sub("@.*", "", $3); print $3 }' | sort)
    [ "$(grep -c '^ehdrom_' <<<"$names")" -eq "$(wc -l <<<"$names")" ]
    [ "$(nm --defined-only -g "$prefix/lib/libehdrom.a" | awk 'NF == 3 { print $3 }' | sort)" = "$names" ]
    [ "$(grep -oE '\behdrom_[a-z_]+\(' "$prefix/include/ehdrom.h" | tr -d '(' | sort -u)" = "$names" ]
    # all macros of the header begin with EHDROM_
    [ -z "$(sed -n 's/^ *# *define \([A-Za-z_]*\).*/\1/p' "$prefix/include/ehdrom.h" | grep -v '^EHDROM_')" ]
    # types, tags and enumerators of the header itself begin with ehdrom_ or EHDROM_
    gcc -E -x c "$prefix/include/ehdrom.h" | awk '/^# / { own = /ehdrom\.h"/; next } own' >own.h
    /usr/bin/python3 - <<'PYTHON'
import re
text = open("own.h").read()
types = re.findall(r"\b(?:struct|union|enum)\s+(\w+)", text) + re.findall(r"\}\s*(\w+)\s*;", text)
types += re.findall(r"\btypedef\b[^{;]*?(\w+)\s*;", text)
constants = [part.split("=")[0].strip() for body in re.findall(r"\benum\b[^{;]*\{([^}]*)\}", text)
             for part in body.split(",") if part.strip()]
assert all(name.startswith("ehdrom_") for name in types), types
assert all(name.startswith("EHDROM_") for name in constants), constants
assert {"ehdrom_status", "ehdrom_model", "ehdrom_result"} <= set(types), types
assert {"EHDROM_OK", "EHDROM_DIMENSIONLESS", "EHDROM_MODULUS"} <= set(constants), constants
PYTHON
    # the version of each symbol is that of the version script
    [ "$(nm -D --defined-only "$prefix/lib/libehdrom.so" | awk '$2 != "A" { sub(".*@@", "", $3); print $3 }' | sort -u)" = EHDROM_0 ]
    readelf -d "$prefix/lib/libehdrom.so" >dynamic
    grep -q 'SONAME.*\[libehdrom.so.0\]' dynamic
    run -1 grep -E 'NEEDED.*(blas|umfpack|lapack|gfortran|cholmod|hdf5)' dynamic
    # counts the library's own code and data
    [ "$(find "$BIN/../pic" -name '*.o' -exec size -t {} + | awk '/TOTALS/ { sum += $4 } END { print sum }')" -lt 2000000 ]
}

# Checks that the library in without/ refuses a model.h5 with one line.
refused() {
    run -65 --separate-stderr env LD_LIBRARY_PATH="$PWD/without" "$BATS_FILE_TMPDIR/use_shared" loaded m.h5 scene.yml
    echo "$stderr"
    [ -z "$output" ] && [ "$(wc -l <<<"$stderr")" -eq 1 ]
}

@test "HDF5 is loaded for a model.h5 alone, by a plug-in beside the library" {
    outside
    ! readelf -d "$BATS_FILE_TMPDIR/use_shared" | grep -i 'NEEDED.*hdf5'
    readelf -d "$prefix/lib/libehdrom-hdf5.so.0" | grep 'NEEDED.*hdf5'
    [ "$(nm -D --defined-only "$prefix/lib/libehdrom-hdf5.so.0" | awk '{ print $3 }')" = ehdrom_hdf5 ]
    romrun --export m.h5 -o m.ehdrom
    run -0 --separate-stderr use_library shared loaded m.h5 scene.yml
    [ "$(value hdf5)" -gt 0 ]
    local found
    found=$(grep -v hdf5 <<<"$output")
    run -0 --separate-stderr use_library shared loaded m.ehdrom scene.yml
    [ "$(value hdf5)" -eq 0 ]
    [ "$(grep -v hdf5 <<<"$output")" = "$found" ]

    # without the plug-in, the library still reads flat models
    mkdir without && cp "$prefix/lib/libehdrom.so.0" without
    run -0 --separate-stderr env LD_LIBRARY_PATH="$PWD/without" "$BATS_FILE_TMPDIR/use_shared" loaded m.ehdrom scene.yml
    [ "$(grep -v hdf5 <<<"$output")" = "$found" ]
    refused
    [[ $stderr == "m.h5: found no flat model and no libehdrom-hdf5.so.0 ("*"No such file"*"), expected "*"romrun export"* ]]
    # the plug-in needs an HDF5 that is missing
    echo 'int nothing;' | gcc -shared -fPIC -x c - -Wl,-soname,libhdf5_gone.so -o libhdf5_gone.so
    gcc -shared -Wl,--no-as-needed libhdf5_gone.so -o without/libehdrom-hdf5.so.0
    refused
    [[ $stderr == "m.h5: "*"(libhdf5_gone.so: cannot open"*"), expected "* ]]
    # the plug-in has another version
    echo 'const struct { unsigned long size; const char *version; } ehdrom_hdf5 = {112, "0.2.7"};' |
        gcc -shared -fPIC -x c - -o without/libehdrom-hdf5.so.0
    refused
    [[ $stderr == "m.h5: found "*"libehdrom-hdf5.so.0 of version 0.2.7, expected that of the library, "* ]]
    # the file is something else
    gcc -shared -fPIC -x c /dev/null -o without/libehdrom-hdf5.so.0
    refused
    [[ $stderr == "m.h5: "*"undefined symbol: ehdrom_hdf5), expected "* ]]
}

# bats test_tags=slow
@test "a program may be static altogether, by what pkg-config --static says" {
    outside
    # in HDF5 of Debian 13, the rest of the library refers to a driver for remote files
    run nm -A "/usr/lib/$(gcc -print-multiarch)/libhdf5_serial.a"
    [[ $output != *"U H5FD_ros3_init"* ]] || skip "this HDF5 needs curl, whose static library is not whole"
    # shellcheck disable=SC2046
    gcc -D_GNU_SOURCE "$BATS_FILE_TMPDIR/use_library.c" -o alone -static \
        $(PKG_CONFIG_PATH=$prefix/lib/pkgconfig pkg-config --define-prefix --static --cflags --libs ehdrom) 2>warnings || { cat warnings && return 1; }
    run ! ldd alone
    romrun --export m.h5 -o m.ehdrom
    for model in m.h5 m.ehdrom; do
        ./alone solve $model scene.yml >told
        grep -q "^central_film_thickness 0\." told
    done
}

# bats test_tags=slow
@test "the static library goes into a plug-in that dlopen loads" {
    outside
    cat >plugin.c <<'C'
#include <ehdrom.h>
#include <math.h>
double central_film(const char *model_path, const char *scene_path) {
    ehdrom_model *model = NULL;
    ehdrom_contact *contact = NULL;
    ehdrom_result result = EHDROM_RESULT_INIT;
    double film = NAN;
    if (!ehdrom_model_open(&model, model_path, NULL) && !ehdrom_contact_create(&contact, model) &&
        !ehdrom_contact_set_units(contact, EHDROM_DIMENSIONLESS) && !ehdrom_contact_read(contact, scene_path) &&
        !EHDROM_FAILED(ehdrom_solve(contact, &result)))
        film = result.central_film_thickness;
    ehdrom_contact_free(contact);
    ehdrom_model_close(model);
    return film;
}
C
    export PKG_CONFIG_PATH=$prefix/lib/pkgconfig
    # shellcheck disable=SC2046
    gcc -shared -fPIC -O1 -pthread -Wl,-z,text,-z,defs plugin.c -o plugin.so $(pkg-config --define-prefix --cflags ehdrom) \
        -L"$prefix/lib" -l:libehdrom.a -Wl,--as-needed $(pkg-config --define-prefix --static --libs ehdrom)
    shows_no ehdrom ldd plugin.so
    romrun scene.yml --model m.h5 --allow-untrusted -o r.h5 --quiet
    run -0 /usr/bin/python3 -c 'import ctypes
plugin = ctypes.CDLL("./plugin.so")
plugin.central_film.restype = ctypes.c_double
print(repr(plugin.central_film(b"m.h5", b"scene.yml")))'
    [ "$output" = "$(number r.h5 central_film_thickness)" ]
}

# bats test_tags=slow
@test "a stationary solution is romrun's, to the last bit" {
    romrun scene.yml --model m.h5 --allow-untrusted -o r.h5 --quiet --set output.fields=true
    for kind in $kinds; do
        run --separate-stderr use_library $kind solve m.h5 scene.yml
        echo "$stderr"
        [ "$status" -eq 0 ]
        [ -z "$stderr" ]
        for name in central_film_thickness minimum_film_thickness central_pressure rigid_approach \
            exit_position load newton_iterations; do
            [ "$(value $name)" = "$(printf '%.17g' "$(number r.h5 $name)")" ] ||
                /usr/bin/python3 -c "assert float('$(value $name)') == float('$(number r.h5 $name)')"
        done
        # the peak pressure comes from the nodes that the solution needs
        /usr/bin/python3 - "$(value largest)" "$(value peak_pressure)" <<'PYTHON'
import sys, h5py
largest, peak = map(float, sys.argv[1:])
with h5py.File("r.h5") as file:
    assert largest == file["pressure"][...].max(), largest
# program and library sum the modes in different orders
assert 0.99 * largest < peak <= largest * (1 + 1e-15), (peak, largest)
PYTHON
    done
    romrun scene.yml --model m.h5 --allow-untrusted -o other.h5 --quiet --set moes.M=13.5
    run use_library "${kinds##*$'\n'}" solve m.h5 scene.yml moes.M 13.5
    close_to "$(value central_film_thickness)" "$(number other.h5 central_film_thickness)" 1e-15
}

# bats test_tags=slow
@test "SI and dimensionless, whatever the locale" {
    local name=C
    # with LOCPATH glibc leaks memory, which sanitizers report
    ! is_installed || localedef -i de_DE -f UTF-8 "$PWD/de_DE.UTF-8" 2>/dev/null || true
    if [ "$(LOCPATH=$PWD LC_ALL=de_DE.UTF-8 locale decimal_point 2>/dev/null)" = , ]; then
        export LOCPATH=$PWD
        name=de_DE.UTF-8
    fi
    run --separate-stderr use_library "${kinds##*$'\n'}" set m.h5 $name
    echo "$stderr"
    [ "$status" -eq 0 ]
    output=${output//,/.}
    si_scene
    romrun si.yml --model m.h5 --allow-untrusted -o r.h5 --quiet
    close_to "$(value central_film_thickness)" "$(number r.h5 central_film_thickness)" 1e-15
}

@test "in time: steps tried again, saved and restored" {
    sed 's/stationary/transient/' base.yml >moving.yml
    cat >>moving.yml <<'YAML'
transport: upwind
moes: {M: 12, L: 4}
transient: {load: {law: sine, amplitude: 0.1, period: 1}, fixed_step: 0.01, end_time: 0.2}
YAML
    for kind in $kinds; do
        run --separate-stderr use_library $kind march m.h5 moving.yml 0.01 20
        echo "$stderr"
        [ "$status" -eq 0 ]
        close_to "$(value time)" 0.2 1e-12
        close_to "$(value load)" 1.09510565 1e-6
    done
    for kind in $kinds; do
        use_library $kind restart m.h5 moving.yml
    done
    # romrun's first steps are shorter, so its film differs a little
    romrun moving.yml --model m.h5 --allow-untrusted -o r.h5 --quiet
    close_to "$(value central_film_thickness)" \
        "$(romrun --print r.h5 central_film_thickness | tail -n 1 | sed 's/.*,//')" 1e-3
}

@test "tolerances; derivatives of solutions and steps; the stiffness is the full model's" {
    si_scene
    for kind in $kinds; do
        run --separate-stderr use_library $kind derivatives m.h5 si.yml
        echo "$output$stderr"
        [ "$status" -eq 0 ]
        [ -z "$stderr" ]
    done
    # this model is trained with transport along the path
    { sed 's/stationary/transient/' si.yml && cat <<'YAML'; } >moving.yml
grid: {x_min: -4, x_max: 2, step: 0.05}
transport: path
transient: {end_time: 1, tolerance: 2e-3, load: {law: sine, amplitude: 0.05, period: 1}}
YAML
    printf 'groups:\n  - scene: moving.yml\n    vary: {physical.load: [19e3, 20e3, 21e3]}\n' >moving-plan.yml
    snapgen moving-plan.yml -o s.h5 --quiet
    podbuild s.h5 -o b.h5 --pressure-modes 25
    snapgen moving-plan.yml --basis b.h5 -o r.h5 --quiet
    deimselect --no-check r.h5 --basis b.h5 -o path.h5
    use_library "${kinds##*$'\n'}" derivatives path.h5 si.yml
    for kind in $kinds; do
        use_library $kind tolerances path.h5 si.yml
    done
    for load in 19.8e3 20.2e3; do
        fullrun si.yml --grid-of m.h5 --set physical.load=$load --quiet -o full-$load.h5
    done
    /usr/bin/python3 - "$(value stiffness)" "$(value central_film_by_load)" <<'PYTHON'
import math, sys, h5py
stiffness, film_by_load = map(float, sys.argv[1:])
def full(load):
    a, reference = (math.sqrt(8 * w * 0.01 / (math.pi * 220e9)) for w in (load, 20e3))
    with h5py.File(f"full-{load / 1e3:.1f}e3.h5") as file:
        approach, film = (file[name][0] * a * a / 0.01 for name in ("rigid_approach", "central_film_thickness"))
    # the approach is measured from ten half widths of the reference, since the deflection of a line has no limit
    return approach + math.log(a / (10 * reference)) / 2 * a * a / 0.01, film
(h, film), (other_h, other_film) = full(19.8e3), full(20.2e3)
assert abs(stiffness / (400 / (h - other_h)) - 1) < 2e-3, (stiffness, 400 / (h - other_h))
assert abs(film_by_load * 20e3 - (other_film - film) * 50) < 0.02 * film, (film_by_load, (other_film - film) / 400)
PYTHON
}

# bats test_tags=slow
@test "a point contact in SI is romrun's, to the last bit, and a step the dimensionless one" {
    romrun point.yml --model p.h5 --allow-untrusted -o r.h5 --quiet
    for kind in $kinds; do
        run --separate-stderr use_library $kind units p.h5 point.yml
        echo "$output$stderr"
        [ "$status" -eq 0 ]
        [ -z "$stderr" ]
        /usr/bin/python3 - <<PYTHON
import math, h5py
found = dict((name, float(value)) for name, value in map(str.split, """$output""".splitlines()))
with h5py.File("r.h5") as file:
    for name, scale in (("central_film_thickness", "film"), ("minimum_film_thickness", "film"), ("rigid_approach", "film"),
                        ("central_pressure", "pressure"), ("load", "load")):
        assert found[name] == file[name][0] * found[scale + "_scale"], (name, found[name], file[name][0])
    assert found["newton_iterations"] == file["newton_iterations"][0]
    lines = file["exit_position"][0]
    assert found["exit_position"] == lines[len(lines) // 2] * found["length_scale"]
# Hertz: a = (3 w R/(2 E'))^(1/3), p_H = 3 w/(2 pi a^2)
a = (3 * 8 * 0.01 / (2 * 220e9)) ** (1 / 3)
for name, expected in ("length", a), ("film", a * a / 0.01), ("pressure", 3 * 8 / (2 * math.pi * a * a)), ("load", 8):
    assert abs(found[name + "_scale"] / expected - 1) < 1e-12, (name, found[name + "_scale"], expected)
assert abs(found["load"] / 8 - 1) < 1e-6 and 0.9 < found["central_pressure"] / found["pressure_scale"] < 1.1
PYTHON
    done
    for load in 7.9 8.1; do
        fullrun point.yml --grid-of p.h5 --set physical.load=$load --quiet -o full-$load.h5
    done
    /usr/bin/python3 - "$(value stiffness)" <<'PYTHON'
import sys, h5py
def approach(load):
    a = (3 * load * 0.01 / (2 * 220e9)) ** (1 / 3)
    return h5py.File(f"full-{load}.h5")["rigid_approach"][0] * a * a / 0.01
full = 0.2 / (approach(7.9) - approach(8.1))
assert abs(float(sys.argv[1]) / full - 1) < 5e-3, (sys.argv[1], full)
PYTHON
}

@test "structs of callers that know more than the library, or less" {
    for kind in $kinds; do
        run --separate-stderr use_library $kind sizes m.h5 scene.yml
        echo "$stderr"
        [ "$status" -eq 0 ]
        [ -z "$stderr" ]
    done
}

@test "what is wrong is said in the handle" {
    run --separate-stderr use_library "${kinds##*$'\n'}" wrong m.h5 scene.yml
    echo "$output$stderr"
    [ "$status" -eq 0 ]
    [ -z "$stderr" ]
    [[ ${lines[0]} == "missing.h5: "* ]]
    [[ ${lines[1]} == "scene.yml:1: contact: found a scene, expected a list of models" ]]
    [[ ${lines[2]} == "physical.lod: found"*"physical.load"* ]]
    [[ ${lines[3]} == "physical.load: found nan, expected a number from "* ]]
    [[ ${lines[4]} == "units: found moes.M and moes.L"* ]]
    [[ ${lines[5]} == "result: found a model never checked"* ]]
    [[ ${lines[6]} == "contact: found point, expected line as in m.h5" ]]
}

@test "threads share a model; none is begun, all signals are the caller's" {
    for kind in $kinds; do
        run --separate-stderr use_library $kind threads m.h5 scene.yml
        echo "$stderr"
        [ "$status" -eq 0 ]
    done
}

@test "on a processor that it was not built for a model is refused, and says why" {
    outside
    command -v qemu-x86_64 || skip "found no qemu-x86_64"
    fullrun --version | grep -q 'march=x86-64-v3' || skip "built for another processor"
    for kind in shared static; do
        run -70 --separate-stderr qemu-x86_64 -cpu Nehalem -E LD_LIBRARY_PATH="$prefix/lib" "$BATS_FILE_TMPDIR/use_$kind" solve m.h5 scene.yml
        [ "$stderr" = "processor: found one without AVX2, expected one with it (make MARCH=x86-64 builds for any)" ]
    done
}

@test "from Python: a contact in two threads, copies, closing, names with NUL, numpy's bool, types" {
    outside
    make -C "$root" -s python VARIANT="$VARIANT" DEPS=no
    export PYTHONPATH=$root/build/$VARIANT/python
    si_scene
    /usr/bin/python3 -B - <<'PYTHON'
import copy, math, pathlib, pickle, threading, typing, ehdrom, numpy

def raises(kind, text, call, *arguments):
    try:
        call(*arguments)
    except kind as error:
        assert text in str(error), error
        return error
    raise AssertionError("nothing raised")

assert ehdrom.__version__ == ehdrom.version() and (pathlib.Path(ehdrom.__file__).parent / "py.typed").exists()
model = ehdrom.Model("m.h5")
contact = ehdrom.Contact(model, "si.yml", accuracy=math.inf)
result = contact.solve()

# if two threads call at the same time, each call returns a result or is refused, and does not harm the other call
answers, refusals, ready = [], [], threading.Barrier(2)
def work():
    ready.wait()
    while len(answers) < 4000 and not refusals or len(answers) < 400:
        try:
            answers.append(contact.solve().central_film_thickness)
        except ehdrom.Error as error:
            refusals.append(str(error))
threads = [threading.Thread(target=work) for _ in range(2)]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
assert set(answers) == {result.central_film_thickness}, set(answers)
assert all("found a call of another thread under way, expected one at a time" in text for text in refusals)
# a call is refused while another thread holds the contact
contact._lock.acquire()
refused = []
def one():
    for call in (contact.solve, contact.fields, contact.close, lambda: contact["physical.load"]):
        refused.append(raises(ehdrom.Error, "another thread", call).status)
thread = threading.Thread(target=one)
thread.start()
thread.join()
contact._lock.release()
assert refused == 4 * [70], refused

# results are values that can be copied and pickled, results of failed solutions too
contact.start()
derivatives = contact.differentiate(load=1)
for value in (result, derivatives, contact.solve()):
    for other in (copy.copy(value), copy.deepcopy(value), *(pickle.loads(pickle.dumps(value, p)) for p in range(2, 6))):
        assert repr(other) == repr(value) and type(other) is type(value)
assert pickle.loads(pickle.dumps(result)).central_film_thickness == result.central_film_thickness
assert not hasattr(result, "none_such") and not hasattr(result, "_none_such")
error = pickle.loads(pickle.dumps(ehdrom.Error(65, "what")))
assert error.status == 65 and str(error) == "what"
for one in (contact, model):
    for how in (copy.copy, copy.deepcopy, pickle.dumps):
        raises(TypeError, "expected a new one", how, one)
# type checkers find all members
for value in (result, derivatives):
    assert set(typing.get_type_hints(type(value))) - {"_kind"} == set(dir(value)) - {"check"}

# names with a NUL character end there in C, but not in Python
for wrong in (lambda: ehdrom.Model("m.h5\0x"), lambda: ehdrom.Contact(model, "si.yml\0x"), lambda: contact["physical.load\0x"],
              lambda: contact.__setitem__("physical.load\0x", 1), lambda: contact.__setitem__("lubricant.viscosity.law", "barus\0x")):
    assert raises(ehdrom.Error, "found a NUL character, expected none", wrong).status == 65
contact["output.fields"] = numpy.bool_(True)
assert contact["output.fields"] is True
contact["output.fields"] = numpy.False_
assert contact["output.fields"] is False
contact["physical.load"] = numpy.int64(20000)
assert contact["physical.load"] == 20000

# a contact is closed at the end of with or by close, repeatedly; a model lives as long as its last contact
with ehdrom.Model("m.h5") as short, ehdrom.Contact(short, "si.yml", accuracy=math.inf) as inner:
    assert inner.solve().central_film_thickness == result.central_film_thickness
inner.close()
model.close()
model.close()
assert contact.solve().central_film_thickness == result.central_film_thickness
for wrong in (inner.solve, inner.save, lambda: inner["physical.load"], lambda: ehdrom.Contact(model)):
    raises(ehdrom.Error, "found it closed, expected it open", wrong)
# contacts and models that are not closed are freed by Python, in any order
for i in range(20):
    ehdrom.Contact(ehdrom.Model("m.h5"), "si.yml", accuracy=math.inf).solve()
PYTHON
}

# bats test_tags=slow
@test "from Python: the same numbers, arrays, errors, and a mass by scipy" {
    outside
    # the package is used as if installed, without pip
    make -C "$root" -s python VARIANT="$VARIANT" DEPS=no
    export PYTHONPATH=$root/build/$VARIANT/python
    si_scene
    romrun si.yml --model m.h5 --allow-untrusted -o r.h5 --quiet --set output.fields=true
    romrun si.yml --model m.h5 --allow-untrusted -o slid.h5 --quiet --set slide_roll=0.1 \
        --set lubricant.shear.law=eyring --set lubricant.shear.tau0=5e6 --set output.fields=true
    romrun si.yml --model m.h5 --allow-untrusted -o hot.h5 --quiet --set lubricant.thermal_conductivity=0.14 \
        --set lubricant.viscosity.temperature_coefficient=0.03
    romrun --export m.h5 -o m.ehdrom
    /usr/bin/python3 -B - <<'PYTHON'
import math, threading, ehdrom, h5py, numpy
model = ehdrom.Model("m.h5")
contact = ehdrom.Contact(model, "si.yml", accuracy=math.inf, dimensionless=True)
result = contact.solve().check()
x, y, pressure, film = contact.fields()
with h5py.File("r.h5") as file:
    for name in ("central_film_thickness", "minimum_film_thickness", "central_pressure"):
        assert getattr(result, name) == file[name][0], name
    assert (pressure[0] == file["pressure"][0]).all()
    assert numpy.allclose(film[0], file["film_thickness"][0], rtol=0, atol=1e-12)
    assert numpy.allclose(x, file["x"][...], rtol=0, atol=1e-12) and y.shape == (1,)
untrusted = ehdrom.Contact(model, "si.yml").solve()
assert untrusted.trusted is False and result.trusted is True and "trusted=False" in repr(untrusted)
assert model.info["checked"] is False and model.info["in_time"] is True and model.info["dimensions"] == 1
assert f"load={untrusted.load:.6g}, " in repr(untrusted) and "never checked" in repr(untrusted)
assert repr(model) == "Model('m.h5': 121 by 1 nodes, 9 pressure modes, 18 rows)", repr(model)
try:
    ehdrom.Contact("m.h5")
except TypeError as error:
    assert "expected a Model" in str(error)
else:
    raise AssertionError("nothing raised")
for wrong in (lambda: ehdrom.Model("none.h5"), lambda: contact.__setitem__("physical.lod", 1), lambda: contact.step(1)):
    try:
        wrong()
    except ehdrom.Error as error:
        assert "expected" in str(error) or "none.h5" in str(error), error
    else:
        raise AssertionError("nothing raised")

# settings are read back as they were set: numbers to the last bit, choices, flags, and unset keys
contact["physical.load"], contact["output.fields"], contact["grid.step"] = 0.1 + 20e3, False, None
assert contact["physical.load"] == 0.1 + 20e3 and contact["lubricant.viscosity.law"] == "barus"
assert contact["output.fields"] is False and contact["grid.step"] is None and contact["contact"] == "line"
contact["output.fields"] = None
try:
    contact["physical.lod"]
except ehdrom.Error as error:
    assert "physical.load" in str(error), error
else:
    raise AssertionError("nothing raised")

# a number replaced after a solution has the effect of one set before the first
contact["physical.load"] = 20.5e3
fresh = ehdrom.Contact(model, "si.yml", accuracy=math.inf, dimensionless=True)
fresh["physical.load"] = "20.5e3"
assert contact.solve().minimum_film_thickness == fresh.solve().minimum_film_thickness != result.minimum_film_thickness
contact["lubricant.viscosity.alpha"] = 1.9e-8
fresh["lubricant.viscosity.alpha"] = "1.9e-8"
assert contact.solve().minimum_film_thickness == fresh.solve().minimum_film_thickness

# inlet heating gives a factor beside the film, and does not change steps
assert math.isnan(result.inlet_heating_factor)
contact = ehdrom.Contact(model, "si.yml", accuracy=math.inf, dimensionless=True)
contact["lubricant.thermal_conductivity"], contact["lubricant.viscosity.temperature_coefficient"] = 0.14, 0.03
hot = contact.solve()
with h5py.File("hot.h5") as file:
    assert 0 < hot.inlet_heating_factor == file.attrs["inlet_heating_factor"] < 1
assert hot.central_film_thickness == result.central_film_thickness
assert math.isnan(contact.start().inlet_heating_factor)

# traction agrees with romrun's, at any sliding speed, and in time
contact = ehdrom.Contact(model, "si.yml", accuracy=math.inf)
contact["slide_roll"], contact["lubricant.shear.law"], contact["lubricant.shear.tau0"] = 0.1, "eyring", 5e6
try:
    contact.slide()
except ehdrom.Error as error:
    assert "found no solution" in str(error), error
else:
    raise AssertionError("nothing raised")
assert contact.solve().central_film_thickness == ehdrom.Contact(model, "si.yml", accuracy=math.inf).solve().central_film_thickness
slid, speed = contact.slide(), contact.scales()["speed"]
stresses = contact.shear_stresses()
with h5py.File("slid.h5") as file:
    units = {"friction_coefficient": 1, "friction_force": file.attrs["line_load"], "rolling_resistance": file.attrs["line_load"],
             "rolling_moment": file.attrs["line_moment"], "power_loss": file.attrs["line_power"],
             "mean_shear_stress": file.attrs["hertz_pressure"], "largest_shear_stress": file.attrs["hertz_pressure"]}
    assert {*units, "indicated_deviation_friction"} == set(slid)
    assert math.isnan(slid.pop("indicated_deviation_friction"))  # never checked
    for name, unit in units.items():
        assert abs(slid[name] / (file[name][0] * unit) - 1) < 1e-12, name
    for surface in 1, 2:
        expected = file[f"shear_stress_{surface}"][0] * file.attrs["hertz_pressure"]
        assert numpy.allclose(stresses[surface - 1][0], expected, rtol=1e-9, atol=1e-9 * abs(expected).max()) and abs(expected).max() > 1e5
# the stress points to the right where surface 1 is the faster one; at u1 = u2 only the pressure gradient causes it
assert (contact.shear_stresses(-0.1 * speed)[0] - contact.shear_stresses(-0.1 * speed)[1] == stresses[1] - stresses[0]).all()
assert (contact.shear_stresses(0)[0] == contact.shear_stresses(0)[1]).all()
assert slid.items() <= contact.slide(0.1 * speed).items()
back = contact.slide(-0.1 * speed)
assert back["friction_force"] == -slid["friction_force"] and back["power_loss"] == slid["power_loss"]
assert contact.slide(0)["friction_force"] == 0 and contact.slide(0)["rolling_moment"] == slid["rolling_moment"]
started = contact.start()
in_time = contact.slide()
assert math.isnan(in_time.pop("indicated_deviation_friction"))
for name in slid:
    assert abs(in_time[name] / slid[name] - 1) < 1e-3, (name, in_time, slid)
assert numpy.allclose(contact.shear_stresses(), stresses, rtol=0, atol=1e-3 * abs(stresses[0]).max())
contact.step(0.01 * contact.scales()["time"], load=20.2e3, speed=0.9 * speed)
assert in_time.items() <= contact.slide().items()  # belongs to the accepted state
attempted = contact.slide_step()
contact.accept()
moved = contact.slide()
assert all(moved[name] == attempted[name] for name in in_time)
try:
    contact.slide_step()
except ehdrom.Error as error:
    assert "found no step that converged" in str(error), error
else:
    raise AssertionError("nothing raised")
assert abs(moved["friction_force"] / moved["friction_coefficient"] / 20.2e3 - 1) < 1e-3
assert moved["power_loss"] != in_time["power_loss"] and abs(contact.slide(0.09 * speed)["friction_force"] / moved["friction_force"] - 1) < 1e-12
contact.restore(contact.save())
try:
    contact.slide()
except ehdrom.Error as error:
    assert "since the state was restored" in str(error), error
else:
    raise AssertionError("nothing raised")
# a film that sliding thins holds for one sliding ratio, and lies outside of a training with Newtonian flow
thinned = ehdrom.Contact(model, "si.yml", accuracy=math.inf)
thinned["slide_roll"], thinned["lubricant.shear.law"], thinned["lubricant.shear.tau0"] = 0.1, "eyring", 5e5
thinned["lubricant.shear.in_film"] = True
found = thinned.solve()
assert "thinned more than any in training" in found.reason, found
assert thinned.slide(0.1 * speed)["power_loss"] == thinned.slide()["power_loss"] != slid["power_loss"]
try:
    thinned.slide(0.2 * speed)
except ehdrom.Error as error:
    assert "a film is of one sliding" in str(error), error
else:
    raise AssertionError("nothing raised")
try:
    unset = ehdrom.Contact(model, "si.yml", accuracy=math.inf)
    unset.solve()
    unset.slide()
except ehdrom.Error as error:
    assert "no slide_roll" in str(error), error
else:
    raise AssertionError("nothing raised")

# steps, saved and restored
contact = ehdrom.Contact(model, "si.yml", accuracy=math.inf)
time = contact.scales()["time"]
first = contact.start()
assert abs(first.load / 20e3 - 1) < 1e-6
contact.step(0.01 * time, load=20.1e3)
contact.accept()
saved = contact.save()
one = contact.step(0.01 * time, load=20.2e3)
# messages have the caller's units
for wrong, text in ((dict(step=-1e-6), "step: found -1e-06"), (dict(step=1e-6, speed=-1), "speed: found -1,"),
                    (dict(step=1e-6, load=-300), "load: found -300,"), (dict(step=math.nan), "step: found nan")):
    try:
        contact.step(**wrong)
    except ehdrom.Error as error:
        assert text in str(error), error
    else:
        raise AssertionError(wrong)
apart = contact.step(0.01 * time, load=0)
assert apart.load == 0 and math.isnan(apart.central_film_thickness)
# the approach that a load leads to can be given instead, whatever the closure of the scene
held = ehdrom.Contact(model, "si.yml", accuracy=math.inf)
now = held.start()
assert abs(held.step(0.01 * time, approach=now.approach).load / 20e3 - 1) < 1e-3
held["approach_length"] = 10
assert held.start().approach == now.approach
held["approach_length"] = 1
try:
    held.start(approach=now.approach)
except ehdrom.Error as error:
    assert "approach_length: found 1, expected at least 3" in str(error), error
else:
    raise AssertionError("nothing raised")
other = ehdrom.Contact(model, "si.yml", accuracy=math.inf)
other.restore(saved)
assert other.step(0.01 * time, load=20.2e3).central_film_thickness == one.central_film_thickness

# derivatives of solutions and steps
solved = ehdrom.Contact(model, "si.yml", accuracy=math.inf)
solved.solve()
by_load, by_approach = solved.differentiate(load=1), solved.differentiate(approach=1)
assert abs(by_approach.load * by_load.approach / by_load.load - 1) < 1e-9 and by_approach.load < 0
assert repr(by_load).startswith(f"Derivatives(load={by_load.load:.6g}, approach={by_load.approach:.6g}, "), repr(by_load)
faster = solved.differentiate(speed=1, approach=0)
assert faster.load > 0 and abs(faster.approach) < 1e-9 * abs(by_load.approach * faster.load)
response = solved.respond()
assert abs(response["stiffness"] / -by_approach.load - 1) < 1e-9
solved["approach_length"] = 20  # measured over a larger length, a line contact has a larger compliance
solved.solve()
assert 0 < solved.respond()["stiffness"] < 0.95 * response["stiffness"]
# a start away from the reference has the derivatives of the solution there
away = ehdrom.Contact(model, "si.yml", accuracy=math.inf)
away["physical.load"], away["physical.speed"] = 21e3, 0.04
away.solve()
started = ehdrom.Contact(model, "si.yml", accuracy=math.inf)
started["approach_length"] = 10 * away.scales()["half_width"] / started.scales()["half_width"]
started.start(load=21e3, speed=0.04)
for name, near in (("stiffness", 1e-3), ("damping", 0.2)):
    assert abs(started.respond()[name] / away.respond()[name] - 1) < near, (name, started.respond(), away.respond())
tangent = other.differentiate(load=1)
sides = [other.step(0.01 * time, load=20.2e3 + change).central_pressure for change in (-20, 20)]
assert abs(tangent.central_pressure * 40 / (sides[1] - sides[0]) - 1) < 2e-3
for wrong in (contact.respond, lambda: solved.differentiate(load=1, approach=1)):
    try:
        wrong()
    except ehdrom.Error as error:
        assert "expected" in str(error), error
    else:
        raise AssertionError("nothing raised")

# a flat model gives the same bits, fields too
flat = ehdrom.Contact(ehdrom.Model("m.ehdrom"), "si.yml", accuracy=math.inf)
plain = ehdrom.Contact(model, "si.yml", accuracy=math.inf)
try:
    plain.solve()
    plain.slide(1e-3)
except ehdrom.Error as error:
    assert "without lubricant.shear.law" in str(error), error
else:
    raise AssertionError("nothing raised")
for contact in flat, plain:
    contact["slide_roll"], contact["lubricant.shear.law"] = 1e-3, "newtonian"
assert flat.solve().minimum_film_thickness == plain.solve().minimum_film_thickness
assert all((a == b).all() for a, b in zip(flat.fields(), plain.fields()))
assert flat.slide(1e-4)["friction_force"] == plain.slide(1e-4)["friction_force"]
try:
    plain.slide(100)
except ehdrom.Untrusted as error:
    assert "friction above the load" in str(error), error
else:
    raise AssertionError("nothing raised")
flat.restore(saved)
assert flat.step(0.01 * time, load=20.2e3).central_film_thickness == one.central_film_thickness

# several threads solve at the same time
found = [None] * 4
def solve(i):
    found[i] = ehdrom.Contact(model, "si.yml", accuracy=math.inf).solve().minimum_film_thickness
threads = [threading.Thread(target=solve, args=(i,)) for i in range(4)]
[thread.start() for thread in threads]
[thread.join() for thread in threads]
assert len(set(found)) == 1 and found[0] > 0
PYTHON
    /usr/bin/python3 -B "$root/romrun/python/examples/sweep.py" m.h5 si.yml 0.03 0.045 sweep.png
    [ "$(head -c 4 sweep.png | tail -c 3)" = PNG ]
    for example in sweep mass; do
        run -64 --separate-stderr /usr/bin/python3 -B "$root/romrun/python/examples/$example.py"
        [[ $stderr == "usage: $example.py MODEL SCENE.yml "* && $(wc -l <<<"$stderr") -eq 1 ]]
    done
    # a mass swings about the position where the load is 2 % higher
    /usr/bin/python3 -B "$root/romrun/python/examples/mass.py" m.h5 si.yml 2400 0.005 >mass.csv
    awk -F, '{ sum += $3; n++; if ($3 > most) most = $3 } END { exit !(n > 20 && most > 20.3e3 && most < 20.9e3) }' mass.csv
}

# bats test_tags=slow
@test "pip installs the Python package for a library that is named, or that the system has" {
    outside
    /usr/bin/python3 -c 'import setuptools, wheel, pip' 2>/dev/null || skip "there is no pip, or no setuptools for it"
    # pip gets a copy, since setuptools builds beside the sources; the package needs the library's header
    mkdir romrun
    cp -r "$root/romrun/python" "$root/romrun/library" romrun
    /usr/bin/python3 -m pip install --no-index --no-deps --no-build-isolation --no-cache-dir --target site \
        romrun/python >pip.log 2>&1 || { cat pip.log; return 1; }
    rm -r romrun
    si_scene
    romrun si.yml --model m.h5 --allow-untrusted -o r.h5 --quiet
    cat >use.py <<'PYTHON'
import math, sys, ehdrom
assert ehdrom.__file__.startswith(sys.argv[1] + "/site/"), ehdrom.__file__
contact = ehdrom.Contact(ehdrom.Model("m.h5"), "si.yml", accuracy=math.inf, dimensionless=True)
print(repr(contact.solve().central_film_thickness))
PYTHON
    export PYTHONPATH=$PWD/site
    for place in EHDROM_LIBRARY="$prefix/lib/libehdrom.so.0" LD_LIBRARY_PATH="$prefix/lib"; do
        [ "$(env "$place" /usr/bin/python3 -B use.py "$PWD")" = "$(number r.h5 central_film_thickness)" ]
    done
}

@test "make uninstall leaves nothing" {
    outside
    cp -a "$prefix/.." copy
    touch copy/usr/bin/other
    make -C "$root" -s uninstall VARIANT="$VARIANT" DEPS=no DESTDIR="$PWD/copy" PREFIX=/usr
    [ "$(find copy ! -type d)" = copy/usr/bin/other ]
    [ ! -e copy/usr/share/ehdrom ]
}
