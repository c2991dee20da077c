/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A lubricant law is one entry of a table. The tables of this program have one law of viscosity
 * and three laws of density more than the library. The keys of these laws in scenes and plans,
 * their help and their errors follow from the entries. */
#include "common/physics/laws.h"
#include "common/settings/settings_table.h"
#include "tests/unit/check.h"
#include "tests/unit/problem.h"
#include "tests/unit/sample.h"
#include "tests/unit/settings_page.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// ---- two laws: eta = eta0 (1 + slope p), and rho = rho0 (1 + share compressibility p)

static ehd_status linear_prepare(ehd_lubricant *self, const law_value *values, ehd_error *error) {
    (void)error;
    self->viscosity_constants[0] = values[0].number;
    return EHD_OK;
}

static double linear(const ehd_lubricant *self, double pressure, double *derivative) {
    *derivative = self->viscosity_constants[0] / (1 + self->viscosity_constants[0] * pressure);
    return log1p(self->viscosity_constants[0] * pressure);
}

static const lubricant_law viscosity_linear = {
    .name = "linear",
    .parameters = {{"slope", LAW_REQUIRED, NULL, NULL, 1e-12, 1e-7, "1/Pa",
                    "Relative rise of the viscosity with pressure"}},
    .prepare = linear_prepare,
    .evaluate = linear};

static ehd_status elastic_prepare(ehd_lubricant *self, const law_value *values, ehd_error *error) {
    (void)error;
    self->density_constants[0] = strcmp(values[0].word, "water") == 0 ? 4.5e-10 : values[1].number;
    self->density_constants[1] = values[2].number;
    return EHD_OK;
}

static double elastic(const ehd_lubricant *self, double pressure, double *derivative) {
    *derivative = self->density_constants[0] * self->density_constants[1];
    return 1 + *derivative * pressure;
}

static const lubricant_law density_elastic = {
    .name = "elastic",
    .parameters = {{"fluid", LAW_PRESET, "water", NULL, 0, 0, "1",
                    "Fluid, in place of compressibility"},
                   {"compressibility", LAW_CONSTANT, NULL, NULL, 0, 1e-9, "1/Pa",
                    "Relative rise of density"},
                   {"share", LAW_OPTIONAL, NULL, "0.5", 0, 1, "1", "Share of it that counts"}},
    .prepare = elastic_prepare,
    .evaluate = elastic};

/* Two density laws, each with as many keys as a law may have. The table of the density laws has no
 * room for the last keys of the second law. */
#define KEY(key)                                                                                   \
    { key, LAW_OPTIONAL, NULL, "0", 0, 1, "1", "One of many" }
#define FIVE(key) KEY(key "1"), KEY(key "2"), KEY(key "3"), KEY(key "4"), KEY(key "5")

static const lubricant_law density_crowded = {
    .name = "crowded",
    .parameters = {FIVE("a"), FIVE("b"), FIVE("c"), KEY("d")},
    .prepare = elastic_prepare,
    .evaluate = elastic};

static const lubricant_law density_overfull = {
    .name = "overfull",
    .parameters = {FIVE("e"),
                   FIVE("f"),
                   FIVE("g"),
                   {"last", LAW_CONSTANT, NULL, NULL, 0, 1, "1", "A key that no slot is left for"}},
    .prepare = elastic_prepare,
    .evaluate = elastic};

const lubricant_law *const viscosity_laws[] = {&viscosity_barus, &viscosity_roelands,
                                               &viscosity_wlf, &viscosity_linear, NULL};
const lubricant_law *const density_laws[] = {&density_incompressible, &density_dowson_higginson,
                                             &density_elastic,        &density_crowded,
                                             &density_overfull,       NULL};

// ---- helpers

static ehd_status parse(scene *of, const char *viscosity, const char *density, ehd_error *error) {
    char text[512];
    snprintf(text, sizeof text,
             "contact: line\nregime: stationary\nmoes: {M: 10, L: 2}\ngrid: {step: 0.05}\n"
             "lubricant:\n  viscosity: {%s}\n  density: {%s}\n",
             viscosity, density);
    return scene_parse(of, text, strlen(text), "s.yml", NULL, 0, error);
}

static void accepts(scene *of, const char *viscosity, const char *density) {
    ehd_error error;
    if (parse(of, viscosity, density, &error)) fail_msg("%s", error.text);
}

static void refuses(const char *viscosity, const char *density, const char *part) {
    scene of;
    ehd_error error = {""};
    const ehd_status status = parse(&of, viscosity, density, &error);
    if (status != EHD_DATA || !strstr(error.text, part))
        fail_msg("status %d, text \"%s\", expected \"%s\"", status, error.text, part);
}

static const char linear_law[] = "law: linear, slope: 2e-9", rigid[] = "law: incompressible";

// ---- tests

static void keys_of_an_added_law_are_settings(void **state) {
    scene of, again;
    (void)state;
    accepts(&of, linear_law, "law: elastic, compressibility: 5e-10");
    char *text = scene_text(&of);
    assert_non_null(strstr(text, "\nlubricant.viscosity.law: linear\n"
                                 "lubricant.viscosity.slope: 2e-09\n"
                                 "lubricant.density.law: elastic\n"
                                 "lubricant.density.compressibility: 5e-10\n"
                                 "lubricant.density.share: 0.5\n"
                                 "discretization: accurate\n"));
    ehd_error error;
    assert_int_equal(scene_parse(&again, text, strlen(text), "text", NULL, 0, &error), EHD_OK);
    char *second = scene_text(&again);
    assert_string_equal(text, second);
    free(text);
    free(second);
    // a plan may vary this setting by its short name
    assert_ptr_equal(setting_find_short("slope"), setting_find("lubricant.viscosity.slope"));
}

static void bad_values_of_an_added_law_are_refused(void **state) {
    (void)state;
    refuses("law: honey", rigid,
            "lubricant.viscosity.law: found honey, expected barus|roelands|wlf|linear");
    refuses(linear_law, "law: lead",
            "lubricant.density.law: found lead, expected incompressible|dowson-higginson|elastic");
    refuses(
        "law: linear, slope: 1", rigid,
        "s.yml:6: lubricant.viscosity.slope: found 1, expected a number from 1e-12 to 1e-07 1/Pa");
    refuses("law: linear", rigid,
            "s.yml:6: lubricant.viscosity.slope: found nothing, expected a value with the law "
            "linear");
    refuses("law: linear, slop: 1e-9", rigid, "expected lubricant.viscosity.slope (did you mean");
    refuses("law: linear, slope: 1e-9, alpha: 1e-8", rigid,
            "lubricant.viscosity.alpha: found a value, expected none with the law linear");
    refuses("law: barus, alpha: 1e-8, slope: 1e-9", rigid,
            "lubricant.viscosity.slope: found a value, expected none with the law barus");
    refuses(linear_law, "law: incompressible, share: 1",
            "lubricant.density.share: found a value, expected none with the law incompressible");
    refuses(linear_law, "law: elastic",
            "s.yml:7: lubricant.density: found neither fluid nor constants, expected fluid or "
            "compressibility with the law elastic");
    refuses(linear_law, "law: elastic, fluid: oil",
            "lubricant.density.fluid: found oil, expected water");
    refuses(linear_law, "law: elastic, fluid: water, compressibility: 1e-10",
            "lubricant.density: found fluid and constants, expected only one");
}

static void help_shows_an_added_law(void **state) {
    char *printed = NULL;
    size_t length = 0;
    (void)state;
    FILE *stream = open_memstream(&printed, &length);
    scene_print_help(stream);
    settings_page_print(stream);
    assert_int_equal(fclose(stream), 0);
    assert_non_null(
        strstr(printed, "lubricant.viscosity.law: barus|roelands|wlf|linear; required"));
    assert_non_null(strstr(printed, "lubricant.viscosity.slope: a number from 1e-12 to 1e-07 1/Pa; "
                                    "required with law linear\n"
                                    "      Relative rise of the viscosity with pressure\n"));
    assert_non_null(strstr(printed,
                           "| `lubricant.density.share` | 0 to 1 | 1 | 0.5 | law elastic | "
                           "Share of it that counts |\n"));
    free(printed);
}

static void an_added_law_is_evaluated(void **state) {
    const double pressure[] = {-0.1, 0.25, 1};
    double log_eta[3], log_eta_slope[3], rho[3], rho_slope[3];
    scene of;
    ehd_contact contact;
    (void)state;
    accepts(&of, linear_law, "law: elastic, fluid: water");
    assert_int_equal(scene_contact(&contact, &of, NULL), EHD_OK);
    check_close(contact.lubricant.alpha, 2e-9, 0, 0); // derivative at zero pressure
    check_close(contact.hertz_pressure, contact.alpha_p_H / 2e-9, 0, 0);
    lubricant_evaluate(log_eta, log_eta_slope, rho, rho_slope, &contact.lubricant, 1e9, pressure,
                       3);
    for (int i = 0; i < 3; i++) {
        const double p = fmax(pressure[i], 0);
        check_close(log_eta[i], log(1 + 2 * p), 1e-15, 0);
        check_close(log_eta_slope[i], 2 / (1 + 2 * p), 1e-15, 0);
        check_close(rho[i], 1 + 0.225 * p, 1e-15, 0);
        check_close(rho_slope[i], 0.225, 1e-15, 0);
    }
    accepts(&of, linear_law, "law: elastic, compressibility: 1e-10, share: 1");
    assert_int_equal(scene_contact(&contact, &of, NULL), EHD_OK);
    check_close(lubricant_density(&contact.lubricant, 1e9), 1.1, 1e-15, 0);
}

static void a_contact_with_an_added_law_is_solved(void **state) {
    scene of;
    const full_settings settings = full_default_settings();
    problem solved, barus;
    ehd_contact contact;
    (void)state;
    accepts(&of, linear_law, "law: elastic, fluid: water");
    assert_int_equal(scene_contact(&contact, &of, NULL), EHD_OK);
    problem_solve_cold(&solved, &contact, &settings);
    ehd_contact other = sample_contact("barus", "incompressible", 10, 2, 0.05);
    problem_solve_cold(&barus, &other, &settings);
    const double film = full_evaluate_scalars(&solved.state, &contact).central_film_thickness;
    const double barus_film = full_evaluate_scalars(&barus.state, &other).central_film_thickness;
    // a viscosity that rises less gives a thinner film
    assert_true(film > 0.5 * barus_film && film < 0.97 * barus_film);
    problem_free(&solved);
    problem_free(&barus);
}

/* Keys beyond the size of a table are no settings, and memory beyond the table is not touched. */
static void a_law_that_there_is_no_room_for_is_refused(void **state) {
    scene of;
    ehd_contact contact;
    ehd_error error;
    (void)state;
    assert_int_equal(law_num_parameters(&density_overfull), MAX_LAW_PARAMETERS);
    assert_non_null(laws_key(density_laws, MAX_LAW_KEYS - 1));
    assert_null(laws_key(density_laws, MAX_LAW_KEYS));
    assert_int_equal(laws_slot(density_laws, "last"), MAX_LAW_KEYS);
    assert_null(setting_find("lubricant.density.last"));
    accepts(&of, linear_law, "law: crowded, d: 1");
    assert_int_equal(scene_contact(&contact, &of, NULL), EHD_OK);
    assert_int_equal(parse(&of, linear_law, "law: overfull", &error), EHD_OK);
    assert_int_equal(scene_contact(&contact, &of, &error), EHD_INTERNAL);
    assert_string_equal(error.text, "lubricant.density.g4: found more keys of laws before it, "
                                    "expected at most 31");
}

/* Returns the need of a parameter that is a preset or a constant. Returns -1 for other parameters,
 * whose needs may differ between laws. */
static int role_of(const law_parameter *parameter) {
    return parameter->need == LAW_PRESET || parameter->need == LAW_CONSTANT ? (int)parameter->need
                                                                            : -1;
}

/* Laws that have a key in common share its slot, so they must describe the key in the same way. */
static void laws_agree_on_shared_keys(void **state) {
    const lubricant_law *const *const tables[] = {viscosity_laws, density_laws};
    (void)state;
    for (int t = 0; t < 2; t++)
        for (const lubricant_law *const *law = tables[t]; *law; law++) {
            size_t num_presets = 0, num_constants = 0;
            assert_true(strlen((*law)->name) < LAW_WORD && !strchr((*law)->name, '|'));
            for (size_t i = 0; i < law_num_parameters(*law); i++) {
                const law_parameter *own = &(*law)->parameters[i];
                const size_t slot = laws_slot(tables[t], own->key);
                const law_parameter *first = laws_key(tables[t], slot);
                if (*law == &density_overfull && slot == MAX_LAW_KEYS) continue;
                assert_true(slot < MAX_LAW_KEYS);
                assert_string_equal(own->key, first->key);
                assert_int_equal(role_of(own), role_of(first));
                assert_string_equal(own->unit, first->unit);
                assert_string_equal(own->help, first->help);
                assert_ptr_equal(own->choices, first->choices);
                check_close(own->min, first->min, 0, 0);
                check_close(own->max, first->max, 0, 0);
                num_presets += own->need == LAW_PRESET;
                num_constants += own->need == LAW_CONSTANT;
            }
            assert_true((num_presets > 0) == (num_constants > 0));
        }
    assert_int_equal(laws_slot(viscosity_laws, "alpha"), 0);
    assert_int_equal(laws_slot(viscosity_laws, "eta0"), 1); // roelands shares alpha with barus
    assert_int_equal(laws_slot(viscosity_laws, "share"), MAX_LAW_KEYS);
    // stored scenes list a key of several laws with the law that comes first in the table
    static const char *const order[] = {
        "alpha",       "eta0", "reference_temperature", "temperature_coefficient", "preset",
        "temperature", "A1"};
    for (size_t i = 0; i < sizeof order / sizeof *order; i++)
        assert_string_equal(laws_key(viscosity_laws, i)->key, order[i]);
    assert_null(laws_key(viscosity_laws, 15));                // 15 keys: 7 above, 7 of wlf, slope
    assert_null(laws_default(viscosity_laws, "temperature")); // only wlf has a default
    assert_false(laws_require(viscosity_laws, "eta0"));       // only roelands requires eta0
    assert_true(laws_require(viscosity_laws, "alpha"));
    char list[16];
    laws_list(list, sizeof list, viscosity_laws, "alpha");
    assert_string_equal(list, "barus|roelands");
    laws_list(list, 4, viscosity_laws, NULL);
    assert_string_equal(list, "bar");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(keys_of_an_added_law_are_settings),
        cmocka_unit_test(bad_values_of_an_added_law_are_refused),
        cmocka_unit_test(help_shows_an_added_law),
        cmocka_unit_test(an_added_law_is_evaluated),
        cmocka_unit_test(a_contact_with_an_added_law_is_solved),
        cmocka_unit_test(a_law_that_there_is_no_room_for_is_refused),
        cmocka_unit_test(laws_agree_on_shared_keys),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
