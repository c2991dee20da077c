/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scene and plan files: accepted and refused inputs, and the texts of errors. */
#include "common/settings/scene.h"
#include "common/settings/settings_table.h"
#include "tests/unit/allocation.h"
#include "tests/unit/check.h"
#include "tests/unit/folder.h"
#include "tests/unit/settings_page.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char good[] = "contact: line\n"
                           "regime: stationary\n"
                           "moes: {M: 12, L: 12}\n"
                           "lubricant:\n"
                           "  viscosity: {law: wlf, preset: no1}\n"
                           "  density: {law: dowson-higginson}\n";

static const char in_time[] = "contact: line\n"
                              "regime: transient\n"
                              "moes: {M: 12, L: 12}\n"
                              "lubricant: {viscosity: {law: wlf, preset: no1}}\n"
                              "transient:\n"
                              "  end_time: 9\n"
                              "  load: {law: ramp, to: 2, duration: 1}\n"
                              "  radius: {law: sine, amplitude: 0.1, period: 1}\n";

static const char moving[] = "contact: line\n"
                             "regime: transient\n"
                             "moes: {M: 120, L: 10}\n"
                             "lubricant: {viscosity: {law: barus, alpha: 1e-8}}\n";

static const char whole_plan[] =
    "groups:\n- {scene: scene.yml, region: {M: [5, 60], L: [1, 2]}, candidates: 20, "
    "where: {moes_M: [6, 40]}}\n- {scene: scene.yml, vary: {L: [3, 4]}}\n";

// ---- helpers

static ehd_status parse(scene *of, const char *text, ehd_error *error) {
    return scene_parse(of, text, strlen(text), "s.yml", NULL, 0, error);
}

static void accepts_set(scene *of, const char *text, const char *const *overrides, size_t num) {
    ehd_error error = {""};
    const ehd_status status = scene_parse(of, text, strlen(text), "s.yml", overrides, num, &error);
    if (status) fail_msg("status %d: %s", status, error.text);
}

static void accepts(scene *of, const char *text) {
    accepts_set(of, text, NULL, 0);
}

static void accepts_with(scene *of, const char *start, const char *added) {
    char text[1024];
    snprintf(text, sizeof text, "%s%s", start, added);
    accepts(of, text);
}

static const law_value *viscosity(const scene *of, const char *key) {
    return &of->lubricant.viscosity.values[laws_slot(viscosity_laws, key)];
}

// ---- a folder for files

static const char *path_of(const char *name) {
    static char path[128];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

static void write_bytes(const char *name, const char *text, size_t length) {
    FILE *file = fopen(path_of(name), "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, length, file), length);
    assert_int_equal(fclose(file), 0);
}

static void write_file(const char *name, const char *text) {
    write_bytes(name, text, strlen(text));
}

static void accepts_plan(plan *of, const char *text) {
    ehd_error error = {""};
    write_file("plan.yml", text);
    const ehd_status status = plan_read(of, path_of("plan.yml"), NULL, 0, &error);
    if (status) fail_msg("status %d: %s", status, error.text);
}

// ---- refused inputs

/* Kind of a text in the table `refused`. */
typedef enum input {
    SCENE,
    LINE,      // an additional line in the good scene
    GRID,      // the grid of the good scene
    PUBLISHED, // the grid of the good scene in the published discretisation
    VISCOSITY, // the viscosity law of a scene
    MOVING,    // additional lines in the transient scene
    TRANSIENT, // keys below "transient" in the transient scene
    SET,       // a --set for the good scene
    POINT,     // a --set for a good point contact
    PLAN,
    GROUP,    // keys of the group of a plan with one group
    HISTORIES // keys below "histories" in this group
} input;

/* The rest of the file, for each kind of text. */
static const struct {
    const char *scene, *before, *after;
} frames[] = {
    [SCENE] = {"", "", ""},
    [LINE] = {good, "", "\n"},
    [GRID] = {good, "grid: {", "}\n"},
    [PUBLISHED] = {good, "discretization: published\ngrid: {", "}\n"},
    [VISCOSITY] = {"contact: line\nregime: stationary\nmoes: {M: 12, L: 12}\n",
                   "lubricant: {viscosity: {", "}}\n"},
    [MOVING] = {moving, "", ""},
    [TRANSIENT] = {moving, "transient: {end_time: 1, ", "}\n"},
    [SET] = {"", "", ""},
    [POINT] = {"", "", ""},
    [PLAN] = {"", "", ""},
    [GROUP] = {"groups:\n- scene: scene.yml\n  ", "", "\n"},
    [HISTORIES] = {"groups:\n- scene: in_time.yml\n  ", "histories: {", "}\n"},
};

static ehd_status parse_set(const char *change, bool of_point, ehd_error *error) {
    const char *const overrides[] = {change,         "contact=point",    "grid.x_min=-4",
                                     "grid.x_max=2", "grid.step=0.0625", "grid.y_max=3",
                                     change};
    scene of;
    return scene_parse(&of, good, strlen(good), "s.yml", overrides + of_point, of_point ? 6 : 1,
                       error);
}

static ehd_status parse_plan(const char *text, ehd_error *error) {
    plan of;
    write_file("plan.yml", text);
    const ehd_status status = plan_read(&of, path_of("plan.yml"), NULL, 0, error);
    if (status) assert_null(of.points);
    return status;
}

static ehd_status parse_input(input kind, const char *text, ehd_error *error) {
    scene of;
    if (kind == SET || kind == POINT) return parse_set(text, kind == POINT, error);
    return kind >= PLAN ? parse_plan(text, error) : parse(&of, text, error);
}

/* Checks that the input is refused with EHD_DATA and one line that contains `part`. */
static void refuses(input kind, const char *given, const char *part) {
    ehd_error error = {""};
    char *text = NULL;
    assert_true(asprintf(&text, "%s%s%s%s", frames[kind].scene, frames[kind].before, given,
                         frames[kind].after) >= 0);
    const ehd_status status = parse_input(kind, text, &error);
    free(text);
    if (status != EHD_DATA || !strstr(error.text, part) || strchr(error.text, '\n'))
        fail_msg("%s: status %d, text \"%s\", expected \"%s\"", given, status, error.text, part);
}

static const struct {
    input kind;
    const char *given, *part;
} refused[] = {
    // missing keys; with the law wlf, physical.viscosity is not needed
    {SCENE, "moes: {M: 12, L: 12}\n",
     "s.yml: contact, regime, lubricant.viscosity.law: found nothing"},
    {SCENE, "contact: line\nregime: stationary\nlubricant.viscosity: {law: wlf, preset: no1}\n",
     "found neither moes nor physical"},
    {SCENE,
     "contact: line\n"
     "regime: stationary\n"
     "moes: {M: 1}\n"
     "lubricant.viscosity: {law: wlf, preset: no1}\n",
     "expected also moes.L"},
    {SCENE,
     "contact: line\n"
     "regime: stationary\n"
     "physical: {load: 1e5, radius: 0.01, speed: 1}\n"
     "lubricant.viscosity: {law: barus, alpha: 2e-8}\n",
     "found 3 of its 5 keys, expected also physical.modulus, physical.viscosity"},
    {SCENE,
     "contact: line\n"
     "regime: stationary\n"
     "physical: {load: 1e5, radius: 0.01, speed: 1}\n"
     "lubricant.viscosity: {law: wlf, preset: no1}\n",
     "found 3 of its 4 keys, expected also physical.modulus"},
    {LINE, "physical: {load: 1e5}", "found moes and physical"},
    // bad numbers
    {SCENE, "moes: {M: 1e-1O}",
     "s.yml:1: moes.M: found 1e-1O, expected a number from 0.1 to 100000"},
    {SCENE, "moes: {M: }", "moes.M: found nothing, expected a number"},
    {SCENE, "hertz_pressure: 1",
     "hertz_pressure: found 1, expected a number from 100000 to 2e+10 Pa"},
    {SCENE, "hertz_pressure: \"1\\n2\"", "hertz_pressure: found 1?2, expected"},
    // numbers with a unit
    {SCENE, "contact: line\nphysical: {load: 200kN}",
     "physical.load: found 200kN, expected a number from 1e-06 to 1e+09 N/m, or one in N/mm, "
     "kN/m, N/cm, kN/mm, MN/m"},
    {SCENE, "contact: point\nphysical: {load: 200 N/m}",
     "physical.load: found 200 N/m, expected a number from 1e-06 to 1e+09 N, or one in kN, "
     "mN, "
     "MN"},
    {SCENE,
     "physical: {load: 20 N/mm, radius: 1, speed: 1, modulus: 1 GPa, viscosity: 1}\n"
     "contact: point\nregime: stationary\nlubricant.viscosity: {law: barus, alpha: 1e-8}",
     "physical.load: found a load in multiples of N/m, expected multiples of N in a point contact"},
    {SCENE, "physical: {load: x}",
     "expected a number from 1e-06 to 1e+09 N/m (of a point contact N)"},
    {SCENE, "hertz_pressure: 70 GPa", "expected a number from 100000 to 2e+10 Pa"},
    {SCENE, "physical: {radius: 1e-7}", "found 1e-7, expected a number from 1e-06 to 1000 m"},
    // bad choices and kinds
    {SCENE, "contact: ring", "s.yml:1: contact: found ring, expected line|point"},
    {SCENE, "contact: ''", "contact: found nothing, expected line"},
    {SCENE, "regime: moving", "regime: found moving, expected stationary|transient"},
    {SCENE, "closure: gap", "closure: found gap, expected load|approach"},
    {SCENE, "lubricant: {viscosity: {law: was}}",
     "lubricant.viscosity.law: found was, expected barus|roelands|wlf"},
    {SCENE, "lubricant: {viscosity: {law: roelands|wlf}}", "expected barus|roelands|wlf"},
    {SCENE, "lubricant: {viscosity: {preset: no4}}", "found no4, expected no1|no2|no3"},
    {SCENE, "output: {fields: yes}", "output.fields: found yes, expected true|false"},
    {SCENE, "contact: [line]", "contact: found a list, expected a single value"},
    {SCENE, "contact: {line: 1}", "contact: found a map, expected a single value"},
    {SCENE, "moes: 12", "moes: found a value, expected keys below it: moes.M, moes.L"},
    {SCENE, "lubricant: 1", "expected keys below it: lubricant.viscosity, lubricant.density"},
    {SCENE, "- contact", "found a list, expected settings"},
    {SCENE, "contact", "found contact, expected settings"},
    // unknown keys; the error names the nearest known key
    {LINE, "hertz_presure: 1e9",
     "s.yml:7: hertz_presure: found an unknown key, expected hertz_pressure (did you mean"},
    {LINE, "grid: {stp: 0.01}", "grid.stp: found an unknown key, expected grid.step"},
    {LINE, "Closure: load", "expected closure"},
    {LINE, "lubricant.alpha: 1e-8", "expected lubricant.viscosity.alpha"},
    {LINE, "transient: {lod: {law: sine}}", "transient.lod: found an unknown key, expected"},
    {LINE, "physical.velocity: 1", "expected physical.speed (did you mean it?)"},
    {LINE, "physical.E: 1", "expected physical.modulus (did you mean it?)"},
    {LINE, "R: 1", "expected physical.radius (did you mean it?)"},
    {LINE, "SRR: 1", "expected slide_roll (did you mean it?)"},
    {LINE, "velocity: 1", "expected physical.speed"},
    {LINE, "physical: {force: 1}", "expected physical.load"},
    {LINE, "physical.viscosty: 1", "expected physical.viscosity"},
    {LINE, "lubrcant: {viscosity: {law: barus}}", "expected lubricant (did you mean it?)"},
    {LINE, "lubricant.viscosty: {law: barus}", "expected lubricant.viscosity (did you mean"},
    {LINE, "groups: [{scene: a.yml}]", "groups: found a plan, expected a scene"},
    {LINE, "nothing_like_it_at_all: 1", "expected one of those --help shows"},
    {LINE, "'': 1", "found an unknown key"},
    {LINE, "\"a\\nb\": 1", "a?b: found an unknown key"},
    {LINE, "grid: {x_min: {deeper: 1}}", "grid.x_min: found a map"},
    // keys that are given twice
    {LINE, "contact: line", "s.yml:7: contact: found again, expected only once (first in line 1"},
    {LINE, "moes.M: 12", "s.yml:7: moes.M: found again, expected only once (first in line 3"},
    {LINE, "grid: {step: 0.01, step: 0.02}", "step: found again"},
    // texts that are not plain YAML
    {SCENE, "", "found no settings"},
    {SCENE, "# only a comment\n", "found no settings"},
    {SCENE, "---\n", "found nothing, expected settings"},
    {SCENE, "contact: &x line", "s.yml:1: found an anchor"},
    {SCENE, "contact: line\nregime: *x", "s.yml:2: found an alias"},
    {SCENE, "contact: !!str line", "found a tag"},
    {SCENE, "moes: !m {M: 1}", "found a tag"},
    {SCENE, "moes: &m {M: 1}", "found an anchor"},
    {SCENE, "contact: line\n---\nregime: stationary\n", "s.yml:2: found a second YAML document"},
    {SCENE, "contact: line\nmoes:\n\tM: 12\n", "s.yml:3: found a tab, expected spaces"},
    {SCENE, "contact: line: 1\n", "s.yml:1: found malformed YAML"},
    {SCENE, "moes: {M: 1\n", "found malformed YAML"},
    {SCENE, "moes: {M: 1, [L]: 2}\n", "found a map or list as key"},
    {SCENE, "contact: line\nregime: \xff\n", "s.yml:2: found bytes that are no text"},
    {SCENE, "contact: \"a\\0b\"\n", "found a zero byte"},
    // keys that a viscosity law needs but does not have, or that it ignores
    {VISCOSITY, "law: barus",
     "s.yml:4: lubricant.viscosity.alpha: found nothing, expected a value with the law barus"},
    {VISCOSITY, "law: roelands, alpha: 1e-8", "lubricant.viscosity.eta0: found nothing"},
    {VISCOSITY, "law: roelands", "lubricant.viscosity.alpha, lubricant.viscosity.eta0: found"},
    {VISCOSITY, "law: wlf", "found neither preset nor constants"},
    {VISCOSITY, "law: wlf, preset: no1, C1: 16", "found preset and constants"},
    {VISCOSITY, "law: wlf, preset: no1, alpha: 1e-8",
     "s.yml:4: lubricant.viscosity.alpha: found a value, expected none with the law wlf"},
    {VISCOSITY, "law: wlf, preset: no1, eta0: 0.1", "lubricant.viscosity.eta0: found a"},
    {VISCOSITY, "law: wlf, preset: no1, reference_temperature: 40",
     "reference_temperature: found a value, expected none with the law wlf"},
    {VISCOSITY, "law: barus, alpha: 1e-8, preset: no1", "preset: found a value"},
    {VISCOSITY, "law: roelands, alpha: 1e-8, eta0: 0.1, B1: 1", "B1: found a value"},
    // grids that do not fit: the distance between two given ends must be a whole number of steps;
    // with the published discretisation the default ends count as given
    {GRID, "x_min: -1", "s.yml:7: grid.x_min: found -1, expected less than -1"},
    {GRID, "x_max: 1", "grid.x_max: found 1, expected more than 1"},
    {GRID, "x_min: -4, x_max: 2, step: 0.007",
     "grid.step: found 0.007, expected a whole number of steps from -4 to 2, such as with "
     "0.0070011668611435"},
    {GRID, "step: 3e3", "grid.step: found 3e3, expected a number from 1e-06 to 1000"},
    {GRID, "step: 0", "grid.step: found 0, expected a number"},
    {GRID, "x_min: -4, x_max: 2, step: 0.000001",
     "grid.step: found 1e-06, which makes 6000001 nodes"},
    {GRID, "x_min: -4, x_max: 2.00001, step: 0.005", "expected a whole number of steps"},
    {PUBLISHED, "x_max: 2.00001", "expected a whole number of steps from -4 to 2.00001"},
    {PUBLISHED, "step: 0.007", "expected a whole number of steps from -4 to 2, such as"},
    {PUBLISHED, "step: 0.000001", "grid.step: found 1e-06, which makes 6000001 nodes"},
    // with 24 steps, the nearest whole number, the step would be too large
    {GRID, "x_min: -4, x_max: 2.04, step: 0.25", "such as with 0.2516"},
    // extent across a point contact, and half grids
    {GRID, "y_max: 3", "grid.y_max: found a value, expected none with the contact line"},
    {GRID, "half: true", "grid.half: found a value, expected none with the contact line"},
    {POINT, "grid.y_max=1", "--set: grid.y_max: found 1, expected more than 1"},
    {POINT, "grid.y_max=0.5", "grid.y_max: found 0.5, expected a number from 1 to 100000"},
    {POINT, "grid.y_max=3.03",
     "--set: grid.y_max: found 3.03, expected a whole number of steps of 0.0625, such as 3.0625"},
    {POINT, "grid.half=2", "grid.half: found 2"},
    {POINT, "grid.step=0.0002",
     "--set: grid.step: found 0.0002, which makes 450045001 nodes, expected at most 50000000"},
    // overrides
    {SET, "moes.M=1e6", "--set: moes.M: found 1e6, expected a number from 0.1 to 100000"},
    {SET, "moes.M=", "s.yml: moes: found 1 of its 2 keys, expected also moes.M"},
    {SET, "=1", "--set: nothing: found an unknown key"},
    {SET, "moes.N=1", "--set: moes.N: found an unknown key, expected moes.M"},
    {SET, "moes=1", "expected keys below it: moes.M, moes.L"},
    {SET, "moes.M", "--set: found moes.M, expected KEY=VALUE"},
    {SET, "grid.x_min=-1", "--set: grid.x_min: found -1, expected less than -1"},
    {SET, "lubricant.viscosity.law=barus", "expected none with the law barus"},
    // overrides without a value; the text of an error names such an override if it would remove the
    // error
    {SET, "lubricant.viscosity.law=barus",
     "s.yml:5: lubricant.viscosity.preset: found a value, expected none with the law barus (--set "
     "lubricant.viscosity.preset= unsets it)"},
    {SET, "contact=", "s.yml: contact: found nothing, expected line|point|ellipse"},
    {SET, "moes.N=", "--set: moes.N: found an unknown key"},
    {SET, "moes=", "--set: moes: found a value, expected keys below it"},
    // keys that regime or closure need but do not have, or that they ignore
    {MOVING, "",
     "s.yml:2: transient.end_time: found nothing, expected a value with the regime transient"},
    {LINE, "transient: {end_time: 1}",
     "s.yml:7: transient.end_time: found a value, expected none with the regime stationary"},
    {LINE, "transient: {tolerance: 1e-3}", "transient.tolerance: found a value"},
    {LINE, "output: {fields_every: 2}", "output.fields_every: found a value, expected none"},
    {LINE, "transient: {load: {law: constant}}", "none with the regime stationary"},
    {LINE, "transient: {load: {amplitude: 1}}", "none with the regime stationary"},
    {LINE, "approach: 0.1", "approach: found a value, expected none with the closure load"},
    {TRANSIENT, "approach: {law: sine, amplitude: 1, period: 1}",
     "s.yml:5: transient.approach.law: found a value, expected none with the closure load"},
    {TRANSIENT, "approach: {at: 1}",
     "transient.approach.at: found a value, expected none with the closure load"},
    {MOVING, "closure: approach\ntransient: {end_time: 1, load: {law: step, to: 1, at: 1}}\n",
     "transient.load.law: found a value, expected none with the closure approach"},
    // Keys that a history needs but does not have, or that it ignores. Each text has one fault.
    // Each quantity has another law, so that all laws are tested.
    {TRANSIENT, "load: {law: sine}",
     "s.yml:5: transient.load.amplitude, transient.load.period: found nothing, expected a value "
     "with the law sine"},
    {MOVING, "transient: {load: {law: sine}}\n", "s.yml:2: transient.end_time: found"},
    {TRANSIENT, "speed: {law: ramp, to: 2}",
     "transient.speed.duration: found nothing, expected a value with the law ramp"},
    {TRANSIENT, "radius: {law: step, to: 2}",
     "transient.radius.at: found nothing, expected a value with the law step"},
    {TRANSIENT, "modulus: {law: table}",
     "transient.modulus.file, transient.modulus.column: found nothing"},
    {TRANSIENT, "load: {amplitude: 1}",
     "transient.load.amplitude: found a value, expected none with the law constant"},
    {TRANSIENT, "load: {law: step, to: 1, at: 1, start: 0}",
     "transient.load.start: found a value, expected none with the law step"},
    {TRANSIENT, "load: {law: ramp, to: 1, duration: 1, at: 1}",
     "transient.load.at: found a value, expected none with the law ramp"},
    {TRANSIENT, "load: {law: ramp, to: 1, duration: 1, period: 1}",
     "transient.load.period: found a value"},
    {TRANSIENT, "load: {law: ramp, to: 1, duration: 1, file: f}",
     "transient.load.file: found a value"},
    {MOVING,
     "transient: {end_time: 1, load: {law: sine, amplitude: 0.1, period: 1},\n"
     "            speed: {period: 1}}\n",
     "s.yml:6: transient.speed.period: found a value"},
    // bad histories
    {MOVING, "transient: {load: {law: cosine}}\n",
     "transient.load.law: found cosine, expected constant|sine|ramp|step|table"},
    {MOVING, "transient: {load: sine}\n",
     "transient.load: found a value, expected keys below it: transient.load.law, "
     "transient.load.ampl"},
    {MOVING, "transient: 1\n",
     "expected keys below it: transient.end_time, transient.time, transient.tolerance, "
     "transient.smoothing, transient.fixed_step, transient.start_film, transient.start_speed, "
     "transient.load, "
     "transient.speed, transient.radius, transient.modulus, transient.approach"},
    {MOVING, "transient: {load: {interpolation: cubic}}\n", "found cubic, expected spline|"},
    {MOVING, "transient: {end_time: 0}\n", "transient.end_time: found 0, expected a number"},
    {MOVING, "transient: {start_film: 1.5}\n", "transient.start_film: found 1.5"},
    {MOVING, "transient: {tolerance: 0.2}\n", "transient.tolerance: found 0.2"},
    {MOVING, "transient: {load: {period: 0}}\n", "transient.load.period: found 0"},
    {MOVING, "transient: {load: {file: ''}}\n",
     "transient.load.file: found nothing, expected the name of a file"},
    {MOVING, "transient: {load: {column: \"a\\tb\"}}\n",
     "transient.load.column: found a?b, expected printable text of at most 63 bytes"},
    // regions of a plan
    {GROUP, "region: {M: [5, 80], X: [1, 2]}", "X: found an unknown key"},
    {GROUP, "region: {M: [5, 80, 90]}", "moes.M: found something else, expected [lowest, highest]"},
    {GROUP, "region: {M: [80, 5]}", "moes.M: found 80 to 5, expected [lowest, highest]"},
    {GROUP, "region: {M: [5, nan]}", "moes.M: found"},
    {GROUP, "region: {contact: [line, point]}", "expected a setting that is a number"},
    {GROUP, "region: [1]", "region: found a list"},
    {GROUP, "region: {M: [5, 6]}\n  vary: {moes.M: [5]}", "moes.M: found again"},
    {GROUP, "candidates: 100", "candidates: found it without region"},
    {GROUP, "region: {M: [5, 6]}\n  candidates: 2.5",
     "candidates: found 2.5, expected a number from 4 to 1000000"},
    {GROUP, "region: {M: [0.01, 6]}",
     "plan.yml:3: moes.M: found 0.01, expected a number from 0.1 to 100000"},
    {GROUP, "region: {hertz_pressure: [1e9, 2 GHz]}",
     "plan.yml:3: hertz_pressure: found 2 GHz, expected a number from 100000 to 2e+10 Pa, or one "
     "in MPa"},
    // parts of a plan
    {PLAN, "part_of: plan.yml\n", "not in a circle"},
    {PLAN, "part_of: [whole.yml]\n", "part_of: found a list, expected the name of a plan"},
    {PLAN, "part_of: whole.yml\ncandidates_times: 0.5\n", "expected a number from 1 to"},
    {PLAN, "part_of: whole.yml\ncandidates_times: 1e6\n", "more than 1000000 candidates"},
    {PLAN, "part_of: whole.yml\ngroups: []\n", "groups: found an unknown key, expected part_of"},
    // histories of a plan
    {HISTORIES, "kinds: [sine]", "histories: found no quantity"},
    {HISTORIES, "load: [0.9, 1.1], width: [1, 2]", "histories: found width, expected load, speed"},
    {HISTORIES, "load: [1.1, 0.9]", "load: found something else, expected factors"},
    {HISTORIES, "load: [0, 0.9]", "above 0"},
    {HISTORIES, "load: [0.9, 1.1], kinds: [cam]", "kinds: found cam, expected sine, ramp or step"},
    {HISTORIES, "load: [0.9, 1.1], kinds: []", "kinds: found no list"},
    {GROUP, "region: {M: [5, 6]}\n  histories: {load: [0.9, 1.1]}",
     "histories: found region beside them"},
    // lists of different lengths
    {GROUP, "combine: list\n  vary: {moes.M: [5, 8, 10], moes.L: [1, 3]}",
     "found 3 values of moes.M and 2 of moes.L"},
    // bad groups of a plan
    {PLAN, "groups: []\n", "plan.yml:1: groups: found none"},
    {PLAN, "groups:\n", "groups: found none"},
    {PLAN, "groups: {scene: scene.yml}\n", "groups: found none"},
    {PLAN, "groups:\n- scene.yml\n", "plan.yml:2: groups: found scene.yml, expected a map"},
    {PLAN, "groups:\n- scene: scene.yml\nmore: 1\n", "plan.yml:3: more: found an unknown key"},
    {PLAN, "groups:\n- vary: {moes.M: [1]}\n", "scene: found nothing"},
    {PLAN, "groups:\n- scene: [1]\n", "scene: found a list"},
    {PLAN, "groups:\n- scene: ''\n", "scene: found nothing"},
    {GROUP, "varry: {}", "plan.yml:3: varry: found an unknown"},
    {GROUP, "vary: [1]", "vary: found a list"},
    {GROUP, "vary: {moes.M: 5}", "moes.M: found 5, expected a"},
    {GROUP, "vary: {moes.M: []}", "moes.M: found an empty list"},
    {GROUP, "vary: {moes.M: [[1]]}", "moes.M: found a list"},
    {GROUP, "vary: {moes.X: [1]}", "expected moes.M"},
    {GROUP, "vary: {moes.M: [1], M: [2]}", "moes.M: found again"},
    {GROUP, "vary: {moes.M: [1]}\n  combine: all",
     "plan.yml:4: combine: found all, expected grid|list"},
    {GROUP, "combine: grid", "combine: found it without vary"},
    {GROUP, "vary: {moes.M: [1]}\n  points: p.csv", "points: found points and vary"},
    {GROUP, "points: [1]", "points: found a list"},
    {GROUP, "where: {p_H: [0, 1]}", "p_H: found an unknown key"},
    {GROUP, "where: {alpha_p_H: 3}", "expected [lowest, highest]"},
    {GROUP, "where: {alpha_p_H: [3, 1]}", "found 3 above 1"},
    {GROUP, "where: {moes_M: [3, 1]}", "moes_M: found 3 above 1"},
    {GROUP, "where: {moes_L: [1, 3]}",
     "moes_L: found an unknown key, expected alpha_p_H, moes_M or both"},
    {GROUP, "where: {alpha_p_H: [0, x]}", "found x, expected a"},
    {PLAN, "just text\n", "found just text, expected settings"},
    // bad points of a plan; the error contains the values of the point
    {GROUP, "vary:\n    moes.M: [5, 6]\n    moes.L: [1, 1e3]",
     "plan.yml:5: moes.L: found 1e3, expected a number from 0 to 100"},
    {GROUP, "vary: {moes.M: [5], grid.x_min: [-2, -1]}",
     "plan.yml: point moes.M=5, grid.x_min=-1: "},
    {PLAN, "groups:\n- scene: {contact: line}\n  vary: {moes.M: [5]}\n",
     "regime, lubricant.viscosity.law: found nothing"},
    {PLAN, "groups:\n- scene: bad.yml\n", "bad.yml:2: regime: found never"},
    {PLAN, "groups:\n- scene: list.yml\n", "list.yml:1: found a list, expected settings"},
};

static void refuses_what_is_wrong(void **state) {
    (void)state;
    write_file("scene.yml", good);
    write_file("in_time.yml", in_time);
    write_file("whole.yml", whole_plan);
    write_file("bad.yml", "contact: line\nregime: never\n");
    write_file("list.yml", "- 1\n");
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++)
        refuses(refused[i].kind, refused[i].given, refused[i].part);
}

// ---- scenes

static void reads_a_scene_and_fills_defaults(void **state) {
    scene of;
    (void)state;
    accepts(&of, good);
    assert_string_equal(of.contact, "line");
    assert_string_equal(of.regime, "stationary");
    assert_string_equal(of.closure, "load");
    assert_string_equal(of.lubricant.viscosity.law, "wlf");
    assert_string_equal(viscosity(&of, "preset")->word, "no1");
    assert_string_equal(of.lubricant.density.law, "dowson-higginson");
    check_close(of.moes.M, 12, 0, 0);
    check_close(of.moes.L, 12, 0, 0);
    assert_true(isnan(of.grid.x_min) && isnan(of.grid.x_max) && isnan(of.grid.step));
    check_close(viscosity(&of, "temperature")->number, 25, 0, 0);
    assert_true(isnan(of.hertz_pressure) && isnan(of.physical.load) &&
                isnan(viscosity(&of, "alpha")->number));
    assert_int_equal(of.output.fields, -1);
}

static void reads_physical_numbers_and_every_law(void **state) {
    scene of;
    (void)state;
    accepts(&of, "contact: line\nregime: stationary\n"
                 "physical: {load: 2e5, radius: 0.01, speed: 1.5, modulus: 2.3e11, "
                 "viscosity: 0.04}\n"
                 "lubricant: {viscosity: {law: barus, alpha: 2e-8}}\noutput: {fields: false}\n");
    check_close(of.physical.load, 2e5, 0, 0);
    check_close(of.physical.viscosity, 0.04, 0, 0);
    check_close(viscosity(&of, "alpha")->number, 2e-8, 0, 0);
    assert_true(isnan(of.moes.M) && isnan(viscosity(&of, "temperature")->number));
    assert_string_equal(of.lubricant.density.law, "incompressible");
    assert_int_equal(of.output.fields, 0);
    accepts(&of, "contact: line\nregime: stationary\nmoes.M: 5\nmoes.L: 0\n"
                 "lubricant.viscosity: {law: roelands, eta0: 0.04, alpha: 2e-8}\n");
    check_close(viscosity(&of, "eta0")->number, 0.04, 0, 0);
    accepts(&of, "contact: line\nregime: stationary\nmoes: {M: 5, L: 1}\n"
                 "lubricant:\n  viscosity:\n    {law: wlf, A1: 19.17, A2: 4.07, B1: 0.23, "
                 "B2: 0.0249, C1: 16.04, C2: 18.18, Tg0: -73.86, mu_g: 1e12, temperature: 40}\n");
    check_close(viscosity(&of, "A1")->number, 19.17, 0, 0);
    check_close(viscosity(&of, "mu_g")->number, 1e12, 0, 0);
    check_close(viscosity(&of, "temperature")->number, 40, 0, 0);
}

static void refuses_bad_numbers(void **state) {
    static const char *const bad[] = {"1e-1O", "nan",  ".nan", "inf",  "-.inf", "1e999",
                                      "''",    "0x10", "1_0",  "1,5",  "~",     "1 2",
                                      "true",  "1e",   "--1",  "' 1'", "1e-999"};
    char text[1024], expected[128];
    (void)state;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        snprintf(text, sizeof text, "contact: line\nmoes:\n  M: %s\n", bad[i]);
        refuses(SCENE, text, "s.yml:3: moes.M: found ");
    }
    snprintf(text, sizeof text, "moes: {M: %0500d}", 1);
    snprintf(expected, sizeof expected, "moes.M: found %060d..., expected", 0);
    text[strlen(text) - 1] = 'x'; // now the value is no number, and the map has no end
    strcat(text, "}");
    refuses(SCENE, text, expected);
}

static void only_an_unknown_unit_is_told_as_one(void **state) {
    (void)state;
    scene of;
    ehd_error error;
    scene_defaults(&of);
    assert_int_equal(scene_set(&of, "physical.radius", "-1 mm", "here", &error), EHD_DATA);
    assert_null(strstr(error.text, "or one in"));
    assert_int_equal(scene_set(&of, "moes.M", "1e-1O", "here", &error), EHD_DATA);
    assert_null(strstr(error.text, "or one in"));
    assert_int_equal(scene_set(&of, "physical.radius", "1 kg", "here", &error), EHD_DATA);
    assert_non_null(strstr(error.text, ", or one in mm, um"));
}

static void values_may_have_units(void **state) {
    (void)state;
    static const struct {
        const char *key, *value;
        double si;
    } given[] = {{"physical.load", "500 N/mm", 5e5},
                 {"physical.load", "0.5kN", 500},
                 {"physical.radius", "12 mm", 0.012},
                 {"physical.radius", "40 µm", 4e-5},
                 {"physical.speed", "36 km/h", 10},
                 {"physical.modulus", "226 GPa", 226e9},
                 {"physical.modulus", "226e3 N/mm²", 226e9},
                 {"physical.modulus", "2.26e11 Pa", 226e9},
                 {"physical.viscosity", "80 mPa s", 0.08},
                 {"physical.viscosity", "80 mPa.s", 0.08},
                 {"physical.viscosity", "80 mPa·s", 0.08},
                 {"physical.viscosity", "80 cP", 0.08},
                 {"lubricant.viscosity.alpha", "20 1/GPa", 2e-8},
                 {"lubricant.viscosity.alpha", "20 GPa^-1", 2e-8},
                 {"lubricant.viscosity.alpha", "0.02 mm2/N", 2e-8},
                 {"lubricant.viscosity.temperature", "60 °C", 60},
                 {"lubricant.viscosity.temperature", "333.15 K", 60},
                 {"lubricant.shear.tau0", "5 MPa", 5e6},
                 {"slide_roll", "5 %", 0.05}};
    for (size_t i = 0; i < sizeof given / sizeof *given; i++) {
        scene of;
        ehd_error error = {""};
        scene_defaults(&of);
        if (scene_set(&of, given[i].key, given[i].value, "here", &error))
            fail_msg("%s", error.text);
        check_close(setting_real(setting_find(given[i].key), &of), given[i].si, 1e-15, 0);
    }
}

/* The scene of the README has a/u = 1.8e-4 s: with load w, a^2 = 8 w R/(pi E'). */
static void times_may_be_in_seconds(void **state) {
    (void)state;
    static const char frame[] =
        "contact: line\nregime: transient\nphysical: {load: %s, radius: 12.5 mm, speed: 0.8, "
        "modulus: 226 GPa, viscosity: 80 mPa.s}\nlubricant.viscosity: {law: barus, alpha: 2e-8}\n"
        "transient: {end_time: 2 ms, fixed_step: 0.01, load: {law: ramp, to: 1.1, start: 100 us, "
        "duration: 0.5}}\n";
    const double loads[] = {300e3, 1200e3};
    for (size_t i = 0; i < 2; i++) {
        const double unit = sqrt(8 * loads[i] * 0.0125 / (M_PI * 226e9)) / 0.8;
        char text[512];
        ehd_error error = {""};
        scene of;
        snprintf(text, sizeof text, frame, i == 0 ? "300 N/mm" : "1200 N/mm");
        if (scene_parse(&of, text, strlen(text), "s.yml", NULL, 0, &error))
            fail_msg("%s", error.text);
        check_close(of.transient.end_time, 2e-3 / unit, 1e-14, 0);
        check_close(of.transient.fixed_step, 0.01, 0, 0);
        check_close(of.transient.vary[VARY_LOAD].start, 1e-4 / unit, 1e-14, 0);
        check_close(of.transient.vary[VARY_LOAD].duration, 0.5, 0, 0);
        assert_int_equal(of.transient.in_seconds, 0);
    }
    refuses(GROUP, "region: {transient.end_time: [5 us, 8 us]}",
            "transient.end_time: found seconds in a region, expected T");
    // without its value the unit is forgotten too
    scene of;
    ehd_error error = {""};
    scene_defaults(&of);
    assert_int_equal(scene_set(&of, "transient.end_time", "1 s", "here", &error), EHD_OK);
    assert_int_equal(scene_set(&of, "physical.load", "1 kN", "here", &error), EHD_OK);
    assert_true(of.transient.in_seconds != 0 && *of.physical.load_unit);
    setting_clear(setting_find("transient.end_time"), &of);
    setting_clear(setting_find("physical.load"), &of);
    assert_true(of.transient.in_seconds == 0 && !*of.physical.load_unit);
    refuses(SCENE,
            "contact: line\nregime: transient\nmoes: {M: 10, L: 10}\nlubricant.viscosity: {law: "
            "barus, alpha: 2e-8}\ntransient: {end_time: 2 ms}",
            "transient.end_time: found seconds in a scene without physical, expected T");
}

static void refuses_numbers_out_of_range(void **state) {
    (void)state;
    for (const setting *row = scene_settings(); row->key; row++) {
        char number[64], text[256];
        if (row->type != SETTING_REAL) continue;
        const double excess[] = {row->min - fmax(1e-3 * fabs(row->min), 1e-3),
                                 row->max + fmax(1e-3 * fabs(row->max), 1e-3)};
        for (size_t i = 0; i < 2; i++) {
            snprintf(number, sizeof number, "%.17g", excess[i]);
            snprintf(text, sizeof text, "%s: %s\n", row->key, number);
            refuses(SCENE, text, row->key);
        }
    }
}

static void refuses_encodings_and_sizes_that_are_no_text(void **state) {
    static const char utf16[] = {'\xff', '\xfe', 'a', 0, ':', 0, ' ', 0, '1', 0};
    char deep[256] = "a: ", wide[8192] = "";
    scene of;
    ehd_error error;
    (void)state;
    refuses(SCENE,
            "\xff\xfe"
            "c",
            "found bytes that are no text");
    assert_int_equal(scene_parse(&of, utf16, sizeof utf16, "s.yml", NULL, 0, &error), EHD_DATA);
    assert_non_null(strstr(error.text, "s.yml:1: found bytes that are no text"));
    memset(deep + 3, '[', 100);
    refuses(SCENE, deep, "found more than 16 maps and lists inside");
    for (int i = 0; i < 300; i++)
        snprintf(wide + strlen(wide), sizeof wide - strlen(wide), "k%d: 1\n", i);
    refuses(SCENE, wide, "found more than 256 keys");
}

static void refuses_constants_that_are_not_all_given(void **state) {
    static const char constants[] = "A1: 19.17, A2: 4.07, B1: 0.23, B2: 0.0249, C1: 16.04, "
                                    "C2: 18.18, Tg0: -73.86";
    char text[256];
    (void)state;
    snprintf(text, sizeof text, "law: wlf, %s", constants);
    refuses(VISCOSITY, text, "expected also lubricant.viscosity.mu_g");
}

static void grids_fit_within_a_tolerance(void **state) {
    scene of;
    (void)state;
    // in binary 5.6 is not exactly 2800 times 0.002, but the difference is below the tolerance
    accepts_with(&of, good, "grid: {x_min: -4, x_max: 1.6, step: 0.002}\n");
    accepts_with(&of, good, "grid: {x_min: -4, x_max: 2, step: 0.25}\n");
    // an end that is not given is chosen to fit the step
    accepts_with(&of, good, "grid: {x_max: 2.00001, step: 0.007}\n");
    assert_true(isnan(of.grid.x_min));
}

static void a_point_contact_has_lines(void **state) {
    static const char *const overrides[] = {"contact=point", "grid.step=0.01", "grid.half=false"};
    scene of;
    (void)state;
    accepts_set(&of, good, overrides, 1);
    assert_true(isnan(of.grid.step) && isnan(of.grid.y_max)); // the grid follows from M and L
    assert_int_equal(of.grid.half, 1);
    accepts_set(&of, good, overrides, 3);
    assert_int_equal(of.grid.half, 0);
}

static void overrides_come_after_the_file(void **state) {
    static const char *const overrides[] = {"moes.M=20", "grid.step=0.01", "moes.M=25"};
    scene of;
    (void)state;
    accepts_set(&of, good, overrides, 3);
    check_close(of.moes.M, 25, 0, 0);
    check_close(of.grid.step, 0.01, 0, 0);
}

/* A key of the file can be removed, so that another law can be chosen. */
static void overrides_without_a_value_unset(void **state) {
    static const char *const barus[] = {
        "lubricant.viscosity.preset=", "lubricant.viscosity.law=barus",
        "lubricant.viscosity.temperature=", "lubricant.viscosity.alpha=2e-8", "grid.step="};
    scene of, plain;
    ehd_error error;
    char text[512];
    (void)state;
    snprintf(text, sizeof text, "%sgrid.step: 0.01\n", good);
    accepts_set(&of, text, barus, 5);
    assert_string_equal(of.lubricant.viscosity.law, "barus");
    assert_true(isnan(of.grid.step)); // the step follows from M and L again
    accepts(&plain, "contact: line\nregime: stationary\nmoes: {M: 12, L: 12}\nlubricant:\n"
                    "  viscosity: {law: barus, alpha: 2e-8}\n  density: {law: dowson-higginson}\n");
    char *expected = scene_text(&plain), *found = scene_text(&of);
    assert_string_equal(found, expected);
    free(expected);
    free(found);
    assert_int_equal(scene_parse(&of, good, strlen(good), "s.yml",
                                 (const char *const[]){"grid.half=true"}, 1, &error),
                     EHD_DATA);
    assert_null(strstr(error.text, "unsets"));
}

static void scene_set_sets_one_key(void **state) {
    scene of;
    ehd_error error;
    (void)state;
    scene_defaults(&of);
    assert_true(isnan(of.moes.M) && isnan(viscosity(&of, "temperature")->number));
    assert_true(isnan(of.grid.step));
    assert_int_equal(scene_set(&of, "contact", "line", "here", &error), EHD_OK);
    assert_int_equal(scene_set(&of, "regime", "stationary", "here", &error), EHD_OK);
    assert_int_equal(scene_set(&of, "moes.M", "12", "here", &error), EHD_OK);
    assert_int_equal(scene_set(&of, "moes.L", "-0", "here", &error), EHD_OK);
    assert_false(signbit(of.moes.L));
    assert_int_equal(scene_set(&of, "lubricant.viscosity.law", "wlf", "here", &error), EHD_OK);
    assert_int_equal(scene_set(&of, "lubricant.viscosity.preset", "no2", "here", &error), EHD_OK);
    assert_int_equal(scene_set(&of, "moes.M", "x", "here", &error), EHD_DATA);
    assert_non_null(strstr(error.text, "here: moes.M: found x"));
    check_close(of.moes.M, 12, 0, 0);
    assert_int_equal(scene_validate(&of, "here", &error), EHD_OK);
    of.grid.x_max = 1;
    assert_int_equal(scene_validate(&of, "here", &error), EHD_DATA);
    of.grid.x_max = NAN; // follows from M and L
    assert_int_equal(scene_validate(&of, "here", &error), EHD_OK);
    of.moes.L = NAN;
    assert_int_equal(scene_validate(&of, "here", &error), EHD_DATA);
    of.moes.L = 0;
    scene_complete(&of);
    check_close(viscosity(&of, "temperature")->number, 25, 0, 0);
    assert_true(isnan(of.grid.x_min) && isnan(of.grid.x_max) && isnan(of.grid.step));
    assert_int_equal(scene_set(&of, "discretization", "published", "here", &error), EHD_OK);
    scene_complete(&of);
    check_close(of.grid.x_min, -4, 0, 0);
    check_close(of.grid.x_max, 2, 0, 0);
    check_close(of.grid.step, 0.005, 0, 0);
}

static void text_round_trips(void **state) {
    scene of, again;
    (void)state;
    accepts(&of, "contact: line\nregime: stationary\n"
                 "physical: {load: 123456.78901234567, radius: 0.1, speed: 0.3333333333333333, "
                 "modulus: 2.3e11, viscosity: 4.000000000000001e-2}\n"
                 "hertz_pressure: 0.70e9\noutput: {fields: true}\ngrid: {step: 0.007}\n"
                 "lubricant: {viscosity: {law: roelands, alpha: 1.7e-8, eta0: 0.04}}\n");
    char *text = scene_text(&of);
    accepts(&again, text);
    char *second = scene_text(&again);
    assert_string_equal(text, second);
    check_close(again.physical.load, 123456.78901234567, 0, 0);
    check_close(again.physical.speed, 0.3333333333333333, 0, 0);
    check_close(again.physical.viscosity, 4.000000000000001e-2, 0, 0);
    assert_non_null(strstr(text, "hertz_pressure: 700000000\n"));
    assert_non_null(strstr(text, "grid.step: 0.007\n"));
    assert_null(strstr(text, "grid.x")); // the ends follow from M and L
    assert_non_null(strstr(text, "output.fields: true\n"));
    assert_null(strstr(text, "moes"));
    free(text);
    free(second);
}

static void refuses_files_that_cannot_be_read(void **state) {
    scene of;
    ehd_error error;
    (void)state;
    assert_int_equal(scene_read(&of, path_of("missing.yml"), NULL, 0, &error), EHD_NOINPUT);
    assert_non_null(strstr(error.text, "missing.yml: found nothing (No such file"));
    assert_int_equal(scene_read(&of, folder, NULL, 0, &error), EHD_NOINPUT);
    assert_non_null(strstr(error.text, "found a folder, expected a file"));
    assert_int_equal(scene_read(&of, "", NULL, 0, &error), EHD_NOINPUT);
    // reading /dev/zero might never end, and reading a pipe might never begin
    assert_int_equal(scene_read(&of, "/dev/zero", NULL, 0, &error), EHD_NOINPUT);
    assert_non_null(strstr(error.text, "found no regular file"));
    assert_int_equal(mkfifo(path_of("pipe.yml"), 0600), 0);
    assert_int_equal(scene_read(&of, path_of("pipe.yml"), NULL, 0, &error), EHD_NOINPUT);
    write_file("huge.yml", "");
    assert_int_equal(truncate(path_of("huge.yml"), (1 << 24) + 1), 0);
    assert_int_equal(scene_read(&of, path_of("huge.yml"), NULL, 0, &error), EHD_DATA);
    assert_non_null(strstr(error.text, "found more than 16777216 bytes"));
    write_file("empty.yml", "");
    assert_int_equal(scene_read(&of, path_of("empty.yml"), NULL, 0, &error), EHD_DATA);
    assert_non_null(strstr(error.text, "empty.yml:1: found no settings"));
    write_file("good.yml", good);
    assert_int_equal(scene_read(&of, path_of("good.yml"), NULL, 0, &error), EHD_OK);
    check_close(of.moes.M, 12, 0, 0);
    // a long file, which is read in several parts
    char *text = calloc(1, 40000);
    assert_non_null(text);
    memset(text, '#', 30000);
    sprintf(text + 30000, "\n%s", good);
    write_file("long.yml", text);
    free(text);
    assert_int_equal(scene_read(&of, path_of("long.yml"), NULL, 0, &error), EHD_OK);
}

// ---- transient scenes

static void reads_a_transient_scene_and_fills_its_defaults(void **state) {
    scene of;
    (void)state;
    accepts_with(&of, moving, "transient: {end_time: 2.5}\n");
    assert_string_equal(of.regime, "transient");
    check_close(of.transient.end_time, 2.5, 0, 0);
    assert_string_equal(of.transport, "path");
    check_close(of.transient.tolerance, 1.5e-3, 0, 0);
    assert_true(isnan(of.transient.fixed_step) && isnan(of.transient.start_film) &&
                isnan(of.approach));
    assert_int_equal(of.output.fields_every, 1);
    for (int i = 0; i < NUM_VARY; i++)
        assert_string_equal(of.transient.vary[i].law, i == VARY_APPROACH ? "" : "constant");
    accepts_with(&of, moving, "transient: {end_time: 2.5}\ndiscretization: published\n");
    assert_string_equal(of.transport, "upwind");
    check_close(of.transient.tolerance, 1e-4, 0, 0);
    assert_true(isnan(of.transient.vary[VARY_LOAD].phase) &&
                isnan(of.transient.vary[VARY_LOAD].from));
    accepts_with(&of, moving,
                 "closure: approach\napproach: -0.25\noutput: {fields_every: 10}\n"
                 "transient: {end_time: 1, tolerance: 1e-6, fixed_step: 0.01,\n"
                 "            start_film: 0.02}\n");
    check_close(of.approach, -0.25, 0, 0);
    check_close(of.transient.fixed_step, 0.01, 0, 0);
    check_close(of.transient.tolerance, 1e-6, 0, 0);
    check_close(of.transient.start_film, 0.02, 0, 0);
    assert_int_equal(of.output.fields_every, 10);
    assert_string_equal(of.transient.vary[VARY_LOAD].law, "");
    assert_string_equal(of.transient.vary[VARY_APPROACH].law, "constant");
}

static void reads_every_law_of_every_quantity(void **state) {
    static const char *const names[] = {"load", "speed", "radius", "modulus", "approach"};
    static const int numbers[] = {VARY_LOAD, VARY_SPEED, VARY_RADIUS, VARY_MODULUS, VARY_APPROACH};
    scene of = {0};
    (void)state;
    for (size_t i = 0; i < NUM_VARY; i++) {
        const char *head = numbers[i] == VARY_APPROACH ? "closure: approach\n" : "";
        const history_settings *vary = &of.transient.vary[numbers[i]];
        char text[512];
        snprintf(text, sizeof text,
                 "%stransient: {end_time: 1, %s: {law: sine, amplitude: 0.1, period: 0.5}}\n", head,
                 names[i]);
        accepts_with(&of, moving, text);
        assert_string_equal(vary->law, "sine");
        check_close_array(((double[]){vary->amplitude, vary->period, vary->phase}),
                          ((double[]){0.1, 0.5, 0}), 3, 0, 0);
        assert_true(isnan(vary->from) && isnan(vary->start) && !*vary->interpolation);
        snprintf(text, sizeof text,
                 "%stransient: {end_time: 1, %s: {law: ramp, to: 2, duration: 0.25}}\n", head,
                 names[i]);
        accepts_with(&of, moving, text);
        check_close_array(((double[]){vary->from, vary->to, vary->start, vary->duration}),
                          ((double[]){1, 2, 0, 0.25}), 4, 0, 0);
        snprintf(text, sizeof text,
                 "%stransient: {end_time: 1, %s: {law: step, from: 2, to: 3, at: 0.5}}\n", head,
                 names[i]);
        accepts_with(&of, moving, text);
        check_close_array(((double[]){vary->from, vary->to, vary->at}), ((double[]){2, 3, 0.5}), 3,
                          0, 0);
        snprintf(text, sizeof text,
                 "%stransient: {end_time: 1, %s: {law: table, file: cam.csv, column: F}}\n", head,
                 names[i]);
        accepts_with(&of, moving, text);
        assert_string_equal(vary->file, "cam.csv");
        assert_string_equal(vary->column, "F");
        assert_string_equal(vary->interpolation, "spline");
    }
}

static void the_closure_approach_makes_no_scene_transient(void **state) {
    (void)state;
    scene of;
    accepts_with(&of, good, "closure: approach\napproach: 0.1\n");
    assert_string_equal(of.transient.vary[VARY_APPROACH].law, "");
}

static void refuses_bad_histories(void **state) {
    char text[512], name[300];
    (void)state;
    memset(name, 'x', 256);
    name[256] = '\0';
    snprintf(text, sizeof text, "transient: {load: {file: %s}}\n", name);
    refuses(MOVING, text, "x..., expected the name of a file, of at most 255 bytes");
    static const char *const bad[] = {"0", "-1", "1.5", "1e3", "", "2000000000", "x"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        snprintf(text, sizeof text, "output: {fields_every: %s}\n", bad[i]);
        refuses(MOVING, text, "expected a whole number from 1 to 1e+09");
    }
}

static void transient_text_round_trips(void **state) {
    scene of, again;
    (void)state;
    accepts_with(&of, moving,
                 "closure: approach\napproach: -0.1\n"
                 "transient:\n"
                 "  end_time: 2.5\n"
                 "  approach: {law: sine, amplitude: 0.1, period: 0.3333333333333333}\n"
                 "  speed: {law: table, file: \"a '#1': ü.csv\", column: '- v, m/s'}\n"
                 "  radius: {law: table, file: out/r.h5, column: R}\n");
    char *text = scene_text(&of);
    assert_non_null(strstr(text, "transient.speed.file: 'a ''#1'': ü.csv'\n"));
    assert_non_null(strstr(text, "transient.radius.file: out/r.h5\n"));
    assert_non_null(strstr(text, "output.fields_every: 1\n"));
    assert_non_null(strstr(text, "transient.tolerance: 0.0015\n"));
    assert_null(strstr(text, "transient.load"));
    accepts(&again, text);
    assert_string_equal(again.transient.vary[VARY_SPEED].column, "- v, m/s");
    check_close(again.transient.vary[VARY_APPROACH].period, 0.3333333333333333, 0, 0);
    char *second = scene_text(&again);
    assert_string_equal(text, second);
    free(text);
    free(second);
}

/* The stored text of a stationary scene identifies the scene. It has no transient keys. */
static void stationary_text_knows_no_time(void **state) {
    static const char expected[] = "contact: line\n"
                                   "regime: stationary\n"
                                   "closure: load\n"
                                   "moes.M: 12\n"
                                   "moes.L: 12\n"
                                   "lubricant.viscosity.law: wlf\n"
                                   "lubricant.viscosity.preset: no1\n"
                                   "lubricant.viscosity.temperature: 25\n"
                                   "lubricant.density.law: dowson-higginson\n"
                                   "discretization: accurate\n";
    scene of;
    (void)state;
    accepts(&of, good);
    char *text = scene_text(&of);
    assert_string_equal(text, expected);
    free(text);
}

/* Point contacts in the accurate discretisation have the boundary `open` by default. Line contacts
 * have no setting `boundary`. */
static void the_default_boundary_is_open(void **state) {
    static const char point[] = "contact: point\nregime: stationary\nmoes: {M: 12, L: 5}\n"
                                "lubricant: {viscosity: {law: barus, alpha: 2e-8}}\n";
    scene of;
    (void)state;
    accepts(&of, good);
    assert_string_equal(of.boundary, "");
    accepts(&of, point);
    assert_string_equal(of.boundary, "open");
    accepts_with(&of, point, "boundary: zero\n");
    assert_string_equal(of.boundary, "zero");
    accepts_with(&of, point, "discretization: published\n");
    assert_string_equal(of.boundary, "zero");
}

/* The default discretisation is the same for lines and points, for stationary and transient scenes,
 * and for scenes from a file or from a program. */
static void the_default_discretization_is_accurate(void **state) {
    scene of;
    (void)state;
    accepts(&of, good);
    assert_string_equal(of.discretization, "accurate");
    accepts_with(&of, moving, "transient: {end_time: 1}\n");
    assert_string_equal(of.discretization, "accurate");
    accepts(&of, "contact: point\nregime: stationary\nmoes: {M: 12, L: 5}\n"
                 "lubricant: {viscosity: {law: barus, alpha: 2e-8}}\n");
    assert_string_equal(of.discretization, "accurate");
    scene_defaults(&of);
    assert_string_equal(of.discretization, "accurate");
    accepts_with(&of, good, "discretization: published\n");
    assert_string_equal(of.discretization, "published");
}

/* Versions before 0.3.0 stored scenes and plans without the key `discretization`. Such a text
 * matches the text of the same scene with the published discretisation. */
static void kept_text_without_a_discretization_is_of_the_published_one(void **state) {
    static const struct {
        const char *kept, *now;
        bool same;
    } cases[] = {
        {"a: 1\nb: 2\n", "a: 1\ndiscretization: published\nb: 2\n", true},
        {"a: 1\nb: 2\n", "a: 1\ndiscretization: accurate\nb: 2\n", false},
        {"a: 1\nb: 2\n", "a: 1\nb: 2\ndiscretization: published\n", true},
        {"a: 1\nb: 2\n", "discretization: published\na: 1\nb: 2\n", true},
        {"a: 1\nb: 2\n", "a: 1\nb: 2\n", true},
        {"a: 1\nb: 2\n", "a: 1\ndiscretization: published\n", false},
        {"a: 1\n", "a: 1\ndiscretization: published\nb: 2\n", false},
        {"a: 1\nb: 2\n", "a: 1\ndiscretization: published\nb: 23\n", false},
        {"a: 1\ndiscretization: accurate\n", "a: 1\ndiscretization: accurate\n", true},
        {"a: 1\ndiscretization: accurate\n", "a: 1\ndiscretization: published\n", false},
        {"a: 1\ndiscretization: published\n", "a: 1\ndiscretization: published\n", true},
        {"a: 1\ndiscretization: published\n", "a: 1\ndiscretization: accurate\n", false},
        {"a: 1\nb: 2\n", "a: 1\ndiscretization: published\nboundary: zero\nb: 2\n", true},
        {"a: 1\nb: 2\n", "a: 1\ndiscretization: published\nboundary: open\nb: 2\n", false},
        {"", "discretization: published\n", true},
        {"", "a", false},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        if (scene_text_matches(cases[i].kept, cases[i].now) != cases[i].same)
            fail_msg("case %zu", i);
}

static void files_are_relative_to_the_file_that_names_them(void **state) {
    static const char *const override[] = {"transient.load.file=set.csv"};
    static const char table[] = "{law: table, column: F";
    char text[1024], expected[256];
    const char *beside = expected;
    scene of;
    plan many;
    ehd_error error;
    (void)state;
    mkdir(path_of("deep"), 0700);
    snprintf(text, sizeof text, "%stransient: {end_time: 1, load: %s, file: cam.csv}}\n", moving,
             table);
    write_file("deep/scene.yml", text);
    snprintf(expected, sizeof expected, "%s/deep/cam.csv", folder);
    assert_int_equal(scene_read(&of, path_of("deep/scene.yml"), NULL, 0, &error), EHD_OK);
    assert_string_equal(of.transient.vary[VARY_LOAD].file, beside);
    // paths in --set and in texts in memory are relative to the working folder
    assert_int_equal(scene_read(&of, path_of("deep/scene.yml"), override, 1, &error), EHD_OK);
    assert_string_equal(of.transient.vary[VARY_LOAD].file, "set.csv");
    assert_int_equal(scene_parse(&of, text, strlen(text), "deep/s.yml", NULL, 0, &error), EHD_OK);
    assert_string_equal(of.transient.vary[VARY_LOAD].file, "cam.csv");
    // paths are relative to the folder of the scene in group 1, of the plan in group 2, and of the
    // list in group 3
    write_file("deep/points.csv", "transient.load.file\n/abs.csv\nlist.csv\n");
    snprintf(text, sizeof text,
             "groups:\n- scene: deep/scene.yml\n"
             "- scene: deep/scene.yml\n  vary: {transient.load.file: [a.csv]}\n"
             "- scene: deep/scene.yml\n  points: deep/points.csv\n");
    accepts_plan(&many, text);
    assert_int_equal(many.num_points, 4);
    assert_string_equal(many.points[0].scene.transient.vary[VARY_LOAD].file, beside);
    assert_string_equal(many.points[1].scene.transient.vary[VARY_LOAD].file, path_of("a.csv"));
    assert_string_equal(many.points[2].scene.transient.vary[VARY_LOAD].file, "/abs.csv");
    assert_string_equal(many.points[3].scene.transient.vary[VARY_LOAD].file,
                        path_of("deep/list.csv"));
    plan_free(&many);
}

static void plan_varies_histories(void **state) {
    plan of;
    char text[1024];
    (void)state;
    snprintf(text, sizeof text, "%stransient: {end_time: 1, load: {law: sine, amplitude: 0.1}}\n",
             moving);
    write_file("scene.yml", text);
    accepts_plan(&of, "groups:\n- scene: scene.yml\n"
                      "  vary: {transient.load.period: [0.5, 1, 2], end_time: [3, 4]}\n");
    assert_int_equal(of.num_points, 6);
    const double period[] = {0.5, 0.5, 1, 1, 2, 2};
    for (size_t i = 0; i < 6; i++) {
        check_close(of.points[i].scene.transient.vary[VARY_LOAD].period, period[i], 0, 0);
        check_close(of.points[i].scene.transient.end_time, i % 2 ? 4 : 3, 0, 0);
    }
    assert_non_null(
        strstr(of.text, "# point 2\ntransient.end_time: 3\ntransient.load.period: 1\n"));
    plan_free(&of);
    // a plan with stationary points and trajectories; it varies a setting that is a text
    accepts_plan(&of, "groups:\n"
                      "- scene: {contact: line, regime: stationary, moes: {M: 12, L: 12},\n"
                      "          lubricant: {viscosity: {law: wlf, preset: no1}}}\n"
                      "- scene: {contact: line, regime: transient, moes: {M: 12, L: 12},\n"
                      "          transient: {end_time: 1, load: {law: table, file: f.csv}},\n"
                      "          lubricant: {viscosity: {law: wlf, preset: no1}}}\n"
                      "  vary: {transient.load.column: [F, G, F], fields_every: [1, 2]}\n");
    assert_int_equal(of.num_points, 5);
    assert_string_equal(of.points[3].scene.transient.vary[VARY_LOAD].column, "G");
    assert_int_equal(of.points[4].scene.output.fields_every, 2);
    plan_free(&of);
    refuses(PLAN, "groups:\n- scene: scene.yml\n  vary: {transient.load.law: [sine, constant]}\n",
            "point transient.load.law=sine: ");
}

// ---- the table

/* Conditions use only choices of earlier rows, so that defaults can be filled row by row. */
static void conditions_of_the_table_are_valid(void **state) {
    (void)state;
    for (const setting *row = scene_settings(); row->key; row++)
        for (size_t i = 0; i < MAX_CONDITIONS && row->when[i].key; i++) {
            const setting *other = setting_find(row->when[i].key);
            const char *value = row->when[i].values;
            assert_true(other && other < row && other->type == SETTING_CHOICE);
            for (size_t length; (length = strcspn(value, "|")) > 0;) {
                char word[32] = "";
                memcpy(word, value, length);
                assert_true(setting_has_choice(other->choices, word));
                value += length + (value[length] == '|');
            }
        }
}

static void defaults_of_the_table_are_valid(void **state) {
    scene of;
    ehd_error error;
    (void)state;
    for (const setting *row = scene_settings(); row->key; row++) {
        assert_true(setting_find(row->key) == row && !setting_is_group(row->key));
        assert_true(strlen(row->key) < MAX_KEY);
        if (row->default_value)
            assert_int_equal(scene_set(&of, row->key, row->default_value, "", &error), EHD_OK);
        // every choice fits into its string in the scene, with a zero byte at the end
        const char *choice = row->choices;
        for (size_t length; choice && (length = strcspn(choice, "|")) > 0;) {
            assert_true(length < row->size);
            choice += length + (choice[length] == '|');
        }
    }
}

/* Compares the table with the page schemas/scene.md. With UPDATE_SCHEMAS=1 in the environment,
 * writes the table into the page instead. */
static void schema_page_shows_the_table(void **state) {
    char *printed = NULL, page[32768];
    size_t length = 0;
    (void)state;
    FILE *stream = open_memstream(&printed, &length);
    settings_page_print(stream);
    assert_int_equal(fclose(stream), 0);
    FILE *file = fopen("schemas/scene.md", "r");
    assert_non_null(file);
    page[fread(page, 1, sizeof page - 1, file)] = '\0';
    fclose(file);
    char *start = strstr(page, "<!-- table -->\n");
    assert_non_null(start);
    start += strlen("<!-- table -->\n");
    char *end = strstr(start, "<!-- end -->");
    assert_non_null(end);
    if (getenv("UPDATE_SCHEMAS")) {
        file = fopen("schemas/scene.md", "w");
        assert_non_null(file);
        fprintf(file, "%.*s%s%s", (int)(start - page), page, printed, end);
        assert_int_equal(fclose(file), 0);
    } else {
        *end = '\0';
        assert_string_equal(start, printed);
    }
    free(printed);
}

static size_t count(const char *text, const char *part) {
    size_t found = 0;
    for (; (text = strstr(text, part)); text += strlen(part))
        found++;
    return found;
}

/* The help shows every key once. Keys that all histories have appear once for all histories. */
static void help_shows_every_key(void **state) {
    static const char histories[] = "\n  transient.<load|speed|radius|modulus|approach>";
    char *printed = NULL, shown[MAX_KEY + 8];
    size_t length = 0;
    (void)state;
    FILE *stream = open_memstream(&printed, &length);
    scene_print_help(stream);
    assert_int_equal(fclose(stream), 0);
    for (const setting *row = scene_settings(); row->key; row++) {
        snprintf(shown, sizeof shown, "\n  %s: ", row->key);
        for (int i = 0; i < NUM_VARY; i++) {
            char group[64];
            snprintf(group, sizeof group, "transient.%s.", vary_names[i]);
            if (strncmp(row->key, group, strlen(group)) == 0)
                snprintf(shown, sizeof shown, "%s.%s: ", histories, row->key + strlen(group));
        }
        if (count(printed, shown) != 1)
            fail_msg("found %zu times \"%s\"", count(printed, shown), shown);
    }
    assert_int_equal(count(printed, histories), 14);
    assert_int_equal(count(printed, "Settings of a scene"), 1);
    assert_non_null(strstr(printed, "--set KEY= unsets"));
    assert_non_null(
        strstr(printed, "amplitude: a number from -1000 to 1000; required with law sine\n"));
    free(printed);
}

// ---- plans

static void check_anywhere(const plan_where *where) {
    for (int w = 0; w < NUM_WHERE; w++)
        check_close_array(where->bounds[w], ((double[]){-INFINITY, INFINITY}), 2, 0, 0);
}

static void plan_combines_a_grid(void **state) {
    plan of;
    (void)state;
    write_file("scene.yml", good);
    accepts_plan(&of, "groups:\n"
                      "  - scene: scene.yml\n"
                      "    vary: {moes.M: [5, 8, 10], moes.L: [1, 3]}\n"
                      "    where: {alpha_p_H: [0, 80]}\n"
                      "  - scene: {contact: line, regime: stationary, moes: {M: 7, L: 0},\n"
                      "            lubricant: {viscosity: {law: barus, alpha: 1e-8}}}\n");
    assert_int_equal(of.num_points, 7);
    assert_int_equal(of.num_groups, 2);
    const double moes_M[] = {5, 5, 8, 8, 10, 10, 7}, moes_L[] = {1, 3, 1, 3, 1, 3, 0};
    for (size_t i = 0; i < 7; i++) {
        check_close(of.points[i].scene.moes.M, moes_M[i], 0, 0);
        check_close(of.points[i].scene.moes.L, moes_L[i], 0, 0);
        assert_int_equal(of.points[i].group, i == 6);
    }
    assert_string_equal(of.points[6].scene.lubricant.viscosity.law, "barus");
    check_close_array(of.where[0].bounds[WHERE_ALPHA_P_H], ((double[]){0, 80}), 2, 0, 0);
    check_close_array(of.where[0].bounds[WHERE_MOES_M], ((double[]){-INFINITY, INFINITY}), 2, 0, 0);
    check_anywhere(&of.where[1]);
    plan_free(&of);
    assert_null(of.points);
}

/* For each density law, the first points are the corners of the region. Points exactly on its edges
 * follow, and then inner points. No gap is more than a few times as large as in a regular grid with
 * the same number of points. */
static void plan_fills_a_region(void **state) {
    enum { CANDIDATES = 400, EDGES = 4 * (CANDIDATES / 4 / 4) };
    double gap = 0;
    plan of;
    (void)state;
    write_file("scene.yml", good);
    accepts_plan(&of, "groups:\n- scene: scene.yml\n"
                      "  region: {moes.M: [5, 80], L: [-0, 4]}\n"
                      "  vary: {lubricant.density.law: [incompressible, dowson-higginson]}\n"
                      "  candidates: 400\n");
    assert_true(of.has_region);
    assert_int_equal(of.num_points, 2 * CANDIDATES);
    const double M[] = {5, 80, 5, 80}, L[] = {0, 0, 4, 4};
    for (size_t i = 0; i < 2 * CANDIDATES; i++) {
        const scene *here = &of.points[i].scene;
        const size_t k = i % CANDIDATES;
        assert_string_equal(here->lubricant.density.law,
                            i < CANDIDATES ? "incompressible" : "dowson-higginson");
        assert_true(here->moes.M >= 5 && here->moes.M <= 80 && here->moes.L >= 0 &&
                    here->moes.L <= 4);
        if (k < 4) {
            check_close(here->moes.M, M[k], 0, 0);
            check_close(here->moes.L, L[k], 0, 0);
        } else if (k < 4 + EDGES) {
            assert_true(here->moes.M == 5 || here->moes.M == 80 || here->moes.L == 0 ||
                        here->moes.L == 4);
        }
    }
    // distances are measured in ln M and, because L may be 0, in L itself
    for (double u = 0.05; u < 1; u += 0.05)
        for (double v = 0.05; v < 1; v += 0.05) {
            double nearest = INFINITY;
            for (size_t i = 0; i < CANDIDATES; i++)
                nearest = fmin(nearest, hypot(log(of.points[i].scene.moes.M / 5) / log(16) - u,
                                              of.points[i].scene.moes.L / 4 - v));
            gap = fmax(gap, nearest);
        }
    assert_true(gap < 0.1);
    plan_free(&of);
}

/* With `part_of` a plan has the groups of another plan, with further bounds and more candidates. */
static void plan_is_part_of_another(void **state) {
    plan whole, of;
    (void)state;
    write_file("scene.yml", good);
    write_file("whole.yml", whole_plan);
    assert_int_equal(plan_read(&whole, path_of("whole.yml"), NULL, 0, NULL), EHD_OK);
    accepts_plan(&of, "part_of: whole.yml\nwhere: {moes_M: [4, 20], alpha_p_H: [0, 9]}\n"
                      "candidates_times: 2.5\n");
    assert_true(of.has_region);
    const size_t unvaried = whole.num_points - 20;
    assert_int_equal(of.num_points, unvaried + 50);
    assert_int_equal(of.num_groups, 2);
    check_close_array(of.where[0].bounds[WHERE_MOES_M], ((double[]){6, 20}), 2, 0, 0);
    check_close_array(of.where[1].bounds[WHERE_MOES_M], ((double[]){4, 20}), 2, 0, 0);
    check_close_array(of.where[1].bounds[WHERE_ALPHA_P_H], ((double[]){0, 9}), 2, 0, 0);
    plan_free(&of);
    // a part of a plan that is itself a part of a plan
    write_file("half.yml", "part_of: whole.yml\nwhere: {moes_M: [4, 20]}\ncandidates_times: 2\n");
    accepts_plan(&of, "part_of: half.yml\nwhere: {moes_M: [10, 30]}\ncandidates_times: 2\n");
    assert_int_equal(of.num_points, unvaried + 80);
    check_close_array(of.where[0].bounds[WHERE_MOES_M], ((double[]){10, 20}), 2, 0, 0);
    plan_free(&of);
    // without further bounds the part equals the whole plan
    accepts_plan(&of, "part_of: whole.yml\n");
    assert_string_equal(of.text, whole.text);
    plan_free(&of);
    plan_free(&whole);
}

/* The key `histories` makes sines and ramps of each quantity and of each pair of quantities, and
 * steps of the speed, all between the given bounds. No other quantity of the scene varies. */
static void plan_makes_histories(void **state) {
    enum { OF_LOAD = 4, OF_SPEED = 6, OF_PAIR = 6, STEPS_OF_LOAD = 2, STEPS_OF_PAIR = 3 };
    size_t counts[3] = {0}, both = 0;
    plan of;
    (void)state;
    write_file("scene.yml", in_time);
    accepts_plan(&of, "groups:\n- scene: scene.yml\n"
                      "  histories: {load: [0.8, 1.1], speed: [0.7, 1.3]}\n");
    assert_int_equal(of.num_points, OF_LOAD + OF_SPEED + OF_PAIR);
    for (size_t i = 0; i < of.num_points; i++) {
        const transient_settings *here = &of.points[i].scene.transient;
        size_t num_varying = 0;
        check_close(here->end_time, 2.5, 0, 0);
        assert_string_equal(here->vary[VARY_RADIUS].law, "constant"); // the scene has a sine
        for (int q = VARY_LOAD; q <= VARY_SPEED; q++) {
            const history_settings *law = &here->vary[q];
            const double low = q == VARY_LOAD ? 0.8 : 0.7, high = q == VARY_LOAD ? 1.1 : 1.3;
            if (strcmp(law->law, "constant") == 0) continue;
            num_varying++;
            if (strcmp(law->law, "sine") == 0) {
                check_close(law->mean - law->amplitude, low, 1e-12, 0);
                check_close(law->mean + law->amplitude, high, 1e-12, 0);
                counts[0]++;
            } else {
                check_close(fmin(law->from, law->to), low, 0, 0);
                check_close(fmax(law->from, law->to), high, 0, 0);
                counts[strcmp(law->law, "ramp") == 0 ? 1 : 2]++;
            }
        }
        assert_in_range(num_varying, 1, 2);
        both += num_varying == 2;
    }
    assert_int_equal(both, OF_PAIR);
    assert_int_equal(counts[0], 2 * 2 + 2 * 2);
    assert_int_equal(counts[1], 2 * 2 + 2 * 4);
    assert_int_equal(counts[2], 2);
    plan_free(&of);

    accepts_plan(&of,
                 "groups:\n- scene: scene.yml\n"
                 "  histories: {load: [0.8, 1.1], speed: [0.7, 1.3], kinds: [step, sine, ramp]}\n");
    assert_int_equal(of.num_points, OF_LOAD + OF_SPEED + OF_PAIR + STEPS_OF_LOAD + STEPS_OF_PAIR);
    plan_free(&of);

    accepts_plan(&of, "groups:\n- scene: scene.yml\n  vary: {M: [5, 6]}\n"
                      "  histories: {speed: [0.7, 1.3], kinds: [sine]}\n");
    assert_int_equal(of.num_points, 2 * 2);
    check_close(of.points[1].scene.moes.M, 5, 0, 0);
    check_close(of.points[2].scene.moes.M, 6, 0, 0);
    plan_free(&of);
}

static void plan_makes_histories_of_transient_scenes_only(void **state) {
    static const char *const overrides[] = {"transient.load.period=2"};
    static const char text[] = "groups:\n- scene: scene.yml\n  histories: {load: [0.9, 1.1]}\n";
    ehd_error error = {""};
    plan of;
    (void)state;
    write_file("scene.yml", in_time);
    write_file("plan.yml", text);
    assert_int_equal(plan_read(&of, path_of("plan.yml"), overrides, 1, &error), EHD_DATA);
    assert_non_null(strstr(error.text, "transient.load.period: found a key that"));
    write_file("scene.yml", good); // a stationary scene
    refuses(PLAN, text, "histories: found the regime stationary, expected transient");
}

static void plan_takes_lists_together(void **state) {
    plan of;
    (void)state;
    write_file("scene.yml", good);
    accepts_plan(&of, "groups:\n- scene: scene.yml\n  combine: list\n"
                      "  vary: {M: [5, 8, 10], L: [1, 3, 4]}\n");
    assert_int_equal(of.num_points, 3);
    check_close(of.points[1].scene.moes.M, 8, 0, 0);
    check_close(of.points[2].scene.moes.L, 4, 0, 0);
    plan_free(&of);
}

static void plan_reads_csv_points(void **state) {
    static const char text[] = "groups:\n- scene: scene.yml\n  points: sub/points.csv\n";
    static const struct {
        const char *csv, *part;
    } bad[] = {
        {"M,L\n50,1\n60\n", "sub/points.csv:3: found 1 column, expected 2"},
        {"M,L\n50,1,2\n", "sub/points.csv:2: found 3 columns, expected 2"},
        {"M,L\n50,1\n\n51,1O\n", "sub/points.csv:4: moes.L: found 1O, expected a number"},
        {"M,L\n50,\n", "sub/points.csv:2: moes.L: found nothing"},
        {"M,moes.M\n50,1\n", "sub/points.csv:1: moes.M: found again"},
        {"M,Q\n50,1\n", "sub/points.csv:1: Q: found an unknown key"},
        {"M,Q\n50,1\n", "; found the columns M, Q"},
        {",M\n0,50\n",
         "sub/points.csv:1: found a column without a name, such as an index, expected settings"},
        {",M\n0,50\n", "; found the columns (no name), M"},
        {"M,L,M\n50,1,60\n",
         "sub/points.csv:1: M: found again in the columns M, L, M, expected only once"},
        {"M\tL\n50\t1,5,2\n", "sub/points.csv:2: moes.L: found 1,5,2, expected a number"},
        {"M,L\n50,\"1\n\n,2\n",
         "sub/points.csv:2: found a quote that does not end, expected its end"},
        {"M,law\n50,1\n", "sub/points.csv:1: law: found an unknown key"},
        {"M,L\n", "sub/points.csv: found a header only"},
        {"", "sub/points.csv: found an empty file"},
    };
    plan of;
    (void)state;
    write_file("scene.yml", good);
    mkdir(path_of("sub"), 0700);
    write_file("sub/points.csv", "\xef\xbb\xbfM, moes.L\r\n50,1\r\n\r\n # on,ly\r\n58 ,3\r\n");
    accepts_plan(&of, text);
    assert_int_equal(of.num_points, 2);
    check_close(of.points[1].scene.moes.M, 58, 0, 0);
    check_close(of.points[1].scene.moes.L, 3, 0, 0);
    plan_free(&of);
    write_file("sub/points.csv", "\"M\",\"moes.L\"\r\n\"50\",1\r\n\"58\" ,3\r\n");
    accepts_plan(&of, text);
    assert_int_equal(of.num_points, 2);
    check_close(of.points[1].scene.moes.M, 58, 0, 0);
    plan_free(&of);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        write_file("sub/points.csv", bad[i].csv);
        refuses(PLAN, text, bad[i].part);
    }
    write_bytes("sub/points.csv", "M,L\n5\0000,1\n", 11);
    refuses(PLAN, text, "sub/points.csv:2: found a zero byte");
}

static void plan_names_files_that_are_missing(void **state) {
    plan of;
    ehd_error error;
    (void)state;
    write_file("scene.yml", good);
    assert_int_equal(plan_read(&of, path_of("missing.yml"), NULL, 0, &error), EHD_NOINPUT);
    write_file("plan.yml", "groups:\n- scene: no-scene.yml\n");
    assert_int_equal(plan_read(&of, path_of("plan.yml"), NULL, 0, &error), EHD_NOINPUT);
    assert_non_null(strstr(error.text, path_of("no-scene.yml")));
    write_file("plan.yml", "groups:\n- scene: scene.yml\n  points: no-points.csv\n");
    assert_int_equal(plan_read(&of, path_of("plan.yml"), NULL, 0, &error), EHD_NOINPUT);
    assert_non_null(strstr(error.text, "no-points.csv: found nothing"));
}

static void plan_refuses_too_many_points(void **state) {
    char text[16384] = "groups:\n- scene: scene.yml\n  vary:\n";
    static const char *const keys[] = {"moes.M", "moes.L", "hertz_pressure"};
    (void)state;
    write_file("scene.yml", good);
    for (size_t k = 0; k < 3; k++) {
        snprintf(text + strlen(text), 64, "    %s: [1", keys[k]);
        for (int i = 2; i <= 101; i++)
            snprintf(text + strlen(text), 16, ", %d", i);
        strcat(text, "]\n");
    }
    refuses(PLAN, text, "plan.yml:2: groups: found more than 1000000 points");
}

static void a_scene_is_a_plan_of_one_point(void **state) {
    static const char *const overrides[] = {"moes.M=20"};
    plan of;
    ehd_error error;
    (void)state;
    write_file("scene.yml", good);
    assert_int_equal(plan_read(&of, path_of("scene.yml"), overrides, 1, &error), EHD_OK);
    assert_int_equal(of.num_points, 1);
    assert_int_equal(of.num_groups, 1);
    check_close(of.points[0].scene.moes.M, 20, 0, 0);
    check_anywhere(&of.where[0]);
    plan_free(&of);
}

static void plan_overrides_act_on_every_scene(void **state) {
    static const char *const step[] = {"grid.step=0.01"}, *const varied[] = {"moes.M=20"};
    plan of;
    ehd_error error;
    (void)state;
    write_file("scene.yml", good);
    write_file("plan.yml", "groups:\n- scene: scene.yml\n  vary: {moes.M: [5, 6]}\n");
    assert_int_equal(plan_read(&of, path_of("plan.yml"), step, 1, &error), EHD_OK);
    check_close(of.points[1].scene.grid.step, 0.01, 0, 0);
    plan_free(&of);
    assert_int_equal(plan_read(&of, path_of("plan.yml"), varied, 1, &error), EHD_DATA);
    assert_non_null(strstr(error.text, "--set: moes.M: found a key that"));
}

static void plan_keeps_the_first_of_equal_points(void **state) {
    plan of;
    (void)state;
    write_file("scene.yml", good);
    accepts_plan(&of, "groups:\n"
                      "- {scene: scene.yml, vary: {M: [9, 5, 5.0, 6, 9]}}\n"
                      "- {scene: scene.yml, vary: {M: [7, 6]}}\n"
                      "- {scene: scene.yml, vary: {M: [6]}, where: {alpha_p_H: [0, 1]}}\n");
    assert_int_equal(of.num_points, 5);
    const double moes_M[] = {9, 5, 6, 7, 6};
    const size_t group[] = {0, 0, 0, 1, 2};
    for (size_t i = 0; i < 5; i++) {
        check_close(of.points[i].scene.moes.M, moes_M[i], 0, 0);
        assert_int_equal(of.points[i].group, group[i]);
    }
    plan_free(&of);
}

static char *text_of_plan(const char *group) {
    char yaml[256];
    plan of;
    snprintf(yaml, sizeof yaml, "groups: [{scene: scene.yml, %s}]\n", group);
    accepts_plan(&of, yaml);
    char *text = of.text;
    of.text = NULL;
    plan_free(&of);
    return text;
}

static void plan_text_identifies_the_plan(void **state) {
    static const char *const others[] = {"vary: {M: [5, 7]}",
                                         "vary: {M: [6, 5]}",
                                         "vary: {M: [5]}",
                                         "vary: {L: [5, 6]}",
                                         "vary: {M: [5, 6]}, where: "
                                         "{alpha_p_H: [0, 1]}",
                                         "vary: {M: [5, 6]}, where: "
                                         "{moes_M: [0, 10]}"};
    (void)state;
    write_file("scene.yml", good);
    char *text = text_of_plan("vary: {M: [5, 6]}");
    char *same = text_of_plan("vary: {moes.M: [5.0, 6e0]}");
    assert_string_equal(text, same);
    assert_non_null(strstr(text, "contact: line\n"));
    assert_non_null(strstr(text, "# point 1\nmoes.M: 6\n"));
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        char *other = text_of_plan(others[i]);
        assert_string_not_equal(text, other);
        free(other);
    }
    free(text);
    free(same);
}

// ---- the text of a plan

static void same_plan(const plan *found, const plan *expected) {
    assert_string_equal(found->text, expected->text);
    assert_int_equal(found->num_points, expected->num_points);
    for (size_t i = 0; i < found->num_points; i++) {
        const size_t group = expected->points[i].group;
        assert_int_equal(found->points[i].group, group);
        for (int w = 0; w < NUM_WHERE; w++)
            check_close_array(found->where[group].bounds[w], expected->where[group].bounds[w], 2, 0,
                              0);
        for (const setting *row = scene_settings(); row->key; row++)
            if (setting_compare(row, &found->points[i].scene, &expected->points[i].scene) != 0)
                fail_msg("point %zu: %s", i, row->key);
    }
}

/* A plan that is read back from its text equals the original plan. This plan has all kinds of
 * settings, also quoted texts. Later points do not have all settings of earlier points. */
static void plan_is_read_back_from_its_text(void **state) {
    plan written, found;
    char text[1024], *more;
    ehd_error error;
    (void)state;
    write_file("scene.yml", good);
    snprintf(text, sizeof text, "%stransient: {end_time: 1, load: {law: table, column: F}}\n",
             moving);
    write_file("moving.yml", text);
    accepts_plan(&written, "groups:\n"
                           "- {scene: scene.yml, vary: {M: [5, 0.125, 7.25], L: [0.1, 1]}}\n"
                           "- scene: moving.yml\n"
                           "  vary: {transient.load.file: [a.csv, 'it''s: #1.csv'], "
                           "transient.load.interpolation: [linear, spline]}\n"
                           "- {scene: scene.yml, vary: {M: [9]}, where: {alpha_p_H: [0, 1]}}\n"
                           "- {scene: scene.yml, vary: {M: [9]}, where: {moes_M: [0.1, 10]}}\n"
                           "- {scene: scene.yml, vary: {M: [9]}}\n");
    assert_int_equal(written.num_points, 13);
    // as in earlier versions, the line of a group without bounds on M contains only alpha_p_H
    assert_non_null(strstr(written.text, "# group 2, alpha_p_H from 0 to 1\n"));
    assert_non_null(strstr(written.text, "# group 4, alpha_p_H from -inf to inf\n"));
    assert_int_equal(plan_parse(&found, written.text, "s.h5", &error), EHD_OK);
    same_plan(&found, &written);
    plan_free(&found);
    // training sets add such lines to the text
    assert_true(asprintf(&more, "%s# shard 1/1\n# cold\n", written.text) > 0);
    assert_int_equal(plan_parse(&found, more, "s.h5", &error), EHD_OK);
    same_plan(&found, &written);
    plan_free(&found);
    plan_free(&written);
    free(more);
}

static void plan_text_of_something_else_is_refused(void **state) {
    static const struct {
        const char *text, *part;
    } cases[] = {{"", "s.h5: found no points"},
                 {"method: joint\nrows: 12\n", "s.h5:1: found something else"},
                 {"# group 0\n# point 0\n", "s.h5:1: found a group without number and bounds"},
                 {"# group 0, alpha_p_H from 0 to 1, moes_M from 2\n# point 0\n",
                  "s.h5:1: found a group without number and bounds"},
                 {"# group 0, moes_L from 0 to 1\n# point 0\n",
                  "s.h5:1: found a group without number and bounds"},
                 {"# point 0\ncontact: line\n", "s.h5:1: found a point, expected its group"},
                 {"# group 0, alpha_p_H from -inf to inf\n# point 0\nmagic: 1\n", "s.h5:3: magic"},
                 {"# group 0, alpha_p_H from -inf to inf\n# point 0\nmoes.M: much\n",
                  "s.h5:3: moes.M: found much"},
                 {"# group 0, alpha_p_H from -inf to inf\n# point 0\nmoes.M: 3\n", "s.h5: "}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        plan of;
        ehd_error error = {""};
        assert_int_equal(plan_parse(&of, cases[i].text, "s.h5", &error), EHD_DATA);
        if (!strstr(error.text, cases[i].part)) fail_msg("%s", error.text);
        assert_null(of.points);
    }
}

// ---- memory

static void survives_failing_allocations(void **state) {
    char text[512];
    scene read;
    plan of;
    ehd_error error;
    ehd_status status;
    size_t call = 0;
    (void)state;
    write_file("scene.yml", good);
    write_file("points.csv", "M,L\n50,1\n51,2\n");
    snprintf(text, sizeof text, "%stransient: {end_time: 1, load: {law: table, column: F}}\n",
             moving);
    write_file("moving.yml", text);
    write_file("plan.yml", "groups:\n- {scene: scene.yml, points: points.csv}\n"
                           "- {scene: scene.yml, vary: {M: [1, 2]}}\n"
                           "- {scene: moving.yml, vary: {transient.load.file: [a.csv, b.csv]}}\n");
    for (bool failed = true; failed; call++) {
        error.text[0] = '\0';
        allocation_fail_at(call);
        status = plan_read(&of, path_of("plan.yml"), NULL, 0, &error);
        failed = allocation_failed();
        assert_int_equal(status, failed ? EHD_MEMORY : EHD_OK);
        if (failed) assert_non_null(strstr(error.text, "out of memory"));
        plan_free(&of);
    }
    assert_true(call > 20);
    plan given;
    accepts_plan(&given, "groups:\n- {scene: scene.yml, vary: {M: [1, 2]}}\n");
    call = 0;
    for (bool failed = true; failed; call++) {
        allocation_fail_at(call);
        status = plan_parse(&of, given.text, "s.h5", NULL);
        failed = allocation_failed();
        assert_int_equal(status, failed ? EHD_MEMORY : EHD_OK);
        plan_free(&of);
    }
    assert_true(call > 2);
    plan_free(&given);
    call = 0;
    for (bool failed = true; failed; call++) {
        allocation_fail_at(call);
        status = scene_read(&read, path_of("scene.yml"), NULL, 0, NULL);
        failed = allocation_failed();
        assert_int_equal(status, failed ? EHD_MEMORY : EHD_OK);
    }
    assert_true(call > 10);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(refuses_what_is_wrong),
        cmocka_unit_test(reads_a_scene_and_fills_defaults),
        cmocka_unit_test(reads_physical_numbers_and_every_law),
        cmocka_unit_test(refuses_bad_numbers),
        cmocka_unit_test(only_an_unknown_unit_is_told_as_one),
        cmocka_unit_test(values_may_have_units),
        cmocka_unit_test(times_may_be_in_seconds),
        cmocka_unit_test(refuses_numbers_out_of_range),
        cmocka_unit_test(refuses_encodings_and_sizes_that_are_no_text),
        cmocka_unit_test(refuses_constants_that_are_not_all_given),
        cmocka_unit_test(grids_fit_within_a_tolerance),
        cmocka_unit_test(a_point_contact_has_lines),
        cmocka_unit_test(overrides_come_after_the_file),
        cmocka_unit_test(overrides_without_a_value_unset),
        cmocka_unit_test(scene_set_sets_one_key),
        cmocka_unit_test(text_round_trips),
        cmocka_unit_test(refuses_files_that_cannot_be_read),
        cmocka_unit_test(reads_a_transient_scene_and_fills_its_defaults),
        cmocka_unit_test(reads_every_law_of_every_quantity),
        cmocka_unit_test(the_closure_approach_makes_no_scene_transient),
        cmocka_unit_test(refuses_bad_histories),
        cmocka_unit_test(transient_text_round_trips),
        cmocka_unit_test(stationary_text_knows_no_time),
        cmocka_unit_test(the_default_boundary_is_open),
        cmocka_unit_test(the_default_discretization_is_accurate),
        cmocka_unit_test(kept_text_without_a_discretization_is_of_the_published_one),
        cmocka_unit_test(files_are_relative_to_the_file_that_names_them),
        cmocka_unit_test(plan_varies_histories),
        cmocka_unit_test(conditions_of_the_table_are_valid),
        cmocka_unit_test(defaults_of_the_table_are_valid),
        cmocka_unit_test(schema_page_shows_the_table),
        cmocka_unit_test(help_shows_every_key),
        cmocka_unit_test(plan_combines_a_grid),
        cmocka_unit_test(plan_fills_a_region),
        cmocka_unit_test(plan_is_part_of_another),
        cmocka_unit_test(plan_makes_histories),
        cmocka_unit_test(plan_makes_histories_of_transient_scenes_only),
        cmocka_unit_test(plan_takes_lists_together),
        cmocka_unit_test(plan_reads_csv_points),
        cmocka_unit_test(plan_names_files_that_are_missing),
        cmocka_unit_test(plan_refuses_too_many_points),
        cmocka_unit_test(a_scene_is_a_plan_of_one_point),
        cmocka_unit_test(plan_overrides_act_on_every_scene),
        cmocka_unit_test(plan_keeps_the_first_of_equal_points),
        cmocka_unit_test(plan_text_identifies_the_plan),
        cmocka_unit_test(plan_is_read_back_from_its_text),
        cmocka_unit_test(plan_text_of_something_else_is_refused),
        cmocka_unit_test(survives_failing_allocations),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
