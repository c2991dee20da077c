/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/trust/known_lubricants.h"

#include "common/physics/laws.h"
#include "tests/unit/allocation.h"
#include "tests/unit/check.h"
#include "tests/unit/sample.h"

#include <math.h>
#include <string.h>

enum { NUM = 5 };
static const double PRESSURES[NUM] = {4, 7, 10, 14, 20}; // values of alpha p_H

static ehd_lubricant oil(const char *law, double alpha, double eta0, const char *density) {
    lubricant_settings settings = sample_scene(law, density, 10, 5).lubricant;
    ehd_lubricant found;
    ehd_error error;

    settings.viscosity.values[laws_slot(viscosity_laws, "alpha")].number = alpha;
    if (eta0 > 0) settings.viscosity.values[laws_slot(viscosity_laws, "eta0")].number = eta0;
    if (lubricant_init(&found, &settings, &error)) fail_msg("%s", error.text);
    return found;
}

/* A model, and the lubricants of its calibration. Each lubricant of the training has one training
 * state at each of the PRESSURES. */
typedef struct sample {
    reduced_model model;
    double alpha_p_H[4 * NUM];
    lubricant_rises rises[4 * NUM];
    shown_lubricant shown[2];
} sample;

static void add_states(sample *self, const ehd_lubricant *of) {
    reduced_states *states = &self->model.states;

    states->alpha_p_H = self->alpha_p_H;
    states->rises = self->rises;
    for (size_t i = 0; i < NUM; i++) {
        self->alpha_p_H[states->num_states] = PRESSURES[i];
        self->rises[states->num_states++] = lubricant_rises_at(of, PRESSURES[i] / of->alpha);
    }
}

static void show(sample *self, const ehd_lubricant *of, double alpha_p_H, bool in_time) {
    shown_lubricants *shown = &self->model.shown;

    shown->of = self->shown;
    self->shown[shown->count++] =
        (shown_lubricant){alpha_p_H, lubricant_rises_at(of, alpha_p_H / of->alpha), in_time};
}

/* Returns the reason why the lubricant is not known; "" if it is known. */
static const char *judge(const sample *self, const ehd_lubricant *lubricant, bool in_time) {
    static char text[256];
    known_lubricants *known = known_lubricants_create(&self->model);
    lubricant_memory *memory = known ? lubricant_memory_create(known) : NULL;

    assert_non_null(memory);
    const char *reason = known_lubricants_check(known, memory, lubricant, in_time);
    snprintf(text, sizeof text, "%s", reason ? reason : "");
    lubricant_memory_free(memory);
    known_lubricants_free(known);
    return text;
}

static const char density_is_new[] = "density law incompressible: not in training";
static const char roelands_is_new[] =
    "viscosity law roelands with these parameters: not in training";

static void one_lubricant_is_known_alone(void **state) {
    const ehd_lubricant own = oil("roelands", 1.6e-8, 0.06, "dowson-higginson");
    const ehd_lubricant rigid = oil("roelands", 1.6e-8, 0.06, "incompressible");
    const ehd_lubricant steeper = oil("roelands", 1.73e-8, 0.06, "dowson-higginson");
    const ehd_lubricant thinner = oil("roelands", 1.6e-8, 0.04, "dowson-higginson");
    const ehd_lubricant nearly = oil("roelands", 1.604e-8, 0.0603, "dowson-higginson");
    const ehd_lubricant barus = oil("barus", 1.6e-8, 0, "dowson-higginson");
    const ehd_lubricant other = oil("barus", 1.6e-8, 0, "incompressible");
    sample model = {0};
    (void)state;

    add_states(&model, &own);
    assert_string_equal(judge(&model, &own, false), "");
    assert_string_equal(judge(&model, &own, true), "");
    assert_string_equal(judge(&model, &nearly, false), "");
    assert_string_equal(judge(&model, &rigid, false), density_is_new);
    assert_string_equal(judge(&model, &rigid, true), density_is_new);
    assert_string_equal(judge(&model, &steeper, false), roelands_is_new);
    assert_string_equal(judge(&model, &thinner, false), roelands_is_new);
    assert_string_equal(judge(&model, &barus, false),
                        "viscosity law barus with these parameters: not in training");
    assert_string_equal(judge(&model, &other, false),
                        "viscosity law barus with these parameters, density law incompressible: "
                        "not in training");
}

/* A lubricant between the lubricants of the training is known, unless its viscosity law was trained
 * with only one density law and the lubricant has another density law. */
static void lubricants_between_are_known(void **state) {
    const double alphas[] = {1.4e-8, 1.6e-8, 1.8e-8};
    sample model = {0}, pairs = {0};
    (void)state;

    for (size_t i = 0; i < 3; i++) {
        const ehd_lubricant of = oil("roelands", alphas[i], 0.06, "dowson-higginson");
        add_states(&model, &of);
    }
    for (double alpha = 1.4e-8; alpha < 1.81e-8; alpha += 0.05e-8) {
        const ehd_lubricant of = oil("roelands", alpha, 0.06, "dowson-higginson");
        assert_string_equal(judge(&model, &of, false), "");
    }
    const ehd_lubricant below = oil("roelands", 1.3e-8, 0.06, "dowson-higginson");
    const ehd_lubricant above = oil("roelands", 1.9e-8, 0.06, "dowson-higginson");
    assert_string_equal(judge(&model, &below, false), roelands_is_new);
    assert_string_equal(judge(&model, &above, false), roelands_is_new);

    const ehd_lubricant dense = oil("barus", 2e-8, 0, "dowson-higginson");
    const ehd_lubricant rigid = oil("roelands", 1.6e-8, 0.06, "incompressible");
    const ehd_lubricant mixed = oil("barus", 2e-8, 0, "incompressible");
    add_states(&pairs, &dense);
    add_states(&pairs, &rigid);
    assert_string_equal(judge(&pairs, &dense, false), "");
    assert_string_equal(judge(&pairs, &rigid, false), "");
    assert_string_equal(judge(&pairs, &mixed, false),
                        "viscosity law barus with density law incompressible: not in training");
}

/* A calibration makes lubricants known. Its stationary scenes do so for stationary contacts, its
 * trajectories for transient contacts. */
static void calibrations_make_lubricants_known(void **state) {
    const ehd_lubricant own = oil("roelands", 1.6e-8, 0.06, "dowson-higginson");
    const ehd_lubricant rigid = oil("roelands", 1.6e-8, 0.06, "incompressible");
    const ehd_lubricant barus = oil("barus", 1.6e-8, 0, "dowson-higginson");
    sample model = {0};
    (void)state;

    add_states(&model, &own);
    show(&model, &rigid, 9, false);
    assert_string_equal(judge(&model, &rigid, false), "");
    assert_string_equal(judge(&model, &rigid, true), density_is_new);
    show(&model, &barus, 9, true);
    assert_string_equal(judge(&model, &barus, true), "");
    assert_string_not_equal(judge(&model, &barus, false), "");
}

/* A model of an older version or another program may not contain the lubricants of its training.
 * Then no lubricant is known. */
static void lubricants_that_are_not_told_are_not_known(void **state) {
    const ehd_lubricant own = oil("roelands", 1.6e-8, 0.06, "dowson-higginson");
    static const char untold[] =
        "a model without the lubricants of its training (romrun calibrate adds them)";
    sample model = {0};
    (void)state;

    assert_string_equal(judge(&model, &own, false), untold);
    add_states(&model, &own);
    for (size_t i = 0; i < NUM; i++)
        model.rises[i].of[RISE_VISCOSITY_HALF] = NAN;
    assert_string_equal(judge(&model, &own, false), untold);
}

/* The memory stores the result of the last check, which is reused for the same lubricant only. */
static void one_memory_serves_one_after_the_other(void **state) {
    const ehd_lubricant own = oil("roelands", 1.6e-8, 0.06, "dowson-higginson");
    const ehd_lubricant other = oil("roelands", 1.6e-8, 0.06, "incompressible");
    sample model = {0};
    (void)state;

    add_states(&model, &own);
    show(&model, &other, PRESSURES[0], true);
    known_lubricants *known = known_lubricants_create(&model.model);
    lubricant_memory *memory = lubricant_memory_create(known);
    assert_non_null(memory);
    for (int i = 0; i < 2; i++) {
        assert_null(known_lubricants_check(known, memory, &own, false));
        for (int again = 0; again < 2; again++)
            assert_string_equal(known_lubricants_check(known, memory, &other, false),
                                density_is_new);
        assert_null(known_lubricants_check(known, memory, &other, true));
    }
    lubricant_memory_free(memory);
    known_lubricants_free(known);
}

static void checks_take_no_memory(void **state) {
    const ehd_lubricant own = oil("roelands", 1.6e-8, 0.06, "dowson-higginson");
    const ehd_lubricant other = oil("barus", 1.6e-8, 0, "incompressible");
    sample model = {0};
    (void)state;

    add_states(&model, &own);
    known_lubricants *known = known_lubricants_create(&model.model);
    lubricant_memory *memory = lubricant_memory_create(known);
    assert_non_null(memory);
    allocation_fail_at(0);
    assert_null(known_lubricants_check(known, memory, &own, false));
    assert_non_null(known_lubricants_check(known, memory, &other, false));
    assert_false(allocation_failed());
    lubricant_memory_free(memory);
    known_lubricants_free(known);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_lubricant_is_known_alone),
        cmocka_unit_test(lubricants_between_are_known),
        cmocka_unit_test(calibrations_make_lubricants_known),
        cmocka_unit_test(lubricants_that_are_not_told_are_not_known),
        cmocka_unit_test(one_memory_serves_one_after_the_other),
        cmocka_unit_test(checks_take_no_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
