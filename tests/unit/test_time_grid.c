/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Default grids of contacts that vary with time. */
#include "common/settings/scene_contact.h"
#include "common/time/frame.h"
#include "common/time/time_grid.h"
#include "tests/unit/check.h"
#include "tests/unit/sample.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Returns a transient contact on the default grid of its reference, and its histories up to
 * T = `end_time`. */
static ehd_contact contact_with(ehd_histories **histories, const char *kind, double moes_M,
                                double moes_L, double end_time, const char *transient) {
    char text[512];
    ehd_contact contact;
    scene of;
    ehd_error error = {""};

    snprintf(text, sizeof text,
             "contact: %s\nregime: transient\nmoes: {M: %.17g, L: %.17g}\n"
             "lubricant: {viscosity: {law: barus, alpha: 1e-8}}\ntransient: {end_time: %g, %s}\n",
             kind, moes_M, moes_L, end_time, transient);
    if (scene_parse(&of, text, strlen(text), "s.yml", NULL, 0, &error) ||
        scene_contact(&contact, &of, &error) || histories_init(histories, &of, &error))
        fail_msg("%s", error.text);
    return contact;
}

static grid_extent extent_with(const char *kind, double moes_M, double end_time,
                               const char *transient) {
    ehd_histories *histories;
    const ehd_contact contact = contact_with(&histories, kind, moes_M, 0, end_time, transient);
    const grid_extent extent = time_grid_extent(histories, &contact, end_time);

    histories_free(histories);
    return extent;
}

/* Returns a stationary contact at L = 0 on its default grid. */
static ehd_contact still_contact(const char *kind, double moes_M) {
    scene of = sample_scene("barus", "incompressible", moes_M, 0);
    ehd_contact contact;

    snprintf(of.contact, sizeof of.contact, "%s", kind);
    of.grid = (grid_settings){NAN, NAN, NAN, NAN, -1};
    scene_complete(&of);
    assert_int_equal(scene_contact(&contact, &of, NULL), EHD_OK);
    return contact;
}

/* The default grid suits the smallest M of the histories. M is proportional to the load, and for a
 * line inversely proportional to the root of the speed. At the smallest M the estimated error of
 * the default grid is at most 3 %. With three quarters of the inlet the error is larger. */
static void ends_suit_the_smallest_M(void **state) {
    (void)state;
    static const struct {
        const char *kind, *transient;
        double moes_M, smallest;
    } cases[] = {
        {"line", "load: {law: sine, mean: 0.525, amplitude: 0.475, period: 3}", 40, 2},
        {"line", "load: {law: step, from: 1, to: 0.05, at: 3.999}", 40, 2},
        {"line", "load: {law: ramp, to: 0, start: 1, duration: 1}", 100, 1}, // as for 1 % load
        {"line", "speed: {law: ramp, to: 64, start: 1, duration: 1}", 16, 2},
        {"line", "speed: {law: ramp, to: 0, start: 1, duration: 1}, start_speed: 64", 16, 2},
        {"point", "load: {law: step, from: 1, to: 0.1, at: 3.999}", 30, 3},
    };

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const ehd_contact reference = still_contact(cases[i].kind, cases[i].moes_M);
        const ehd_contact lowest = still_contact(cases[i].kind, cases[i].smallest);
        const grid_extent found =
            extent_with(cases[i].kind, cases[i].moes_M, 4, cases[i].transient);
        if (!(found.x_min < grid_extent_needed(&reference).x_min)) fail_msg("case %zu", i);
        assert_true(grid_inlet_effect(&lowest, -found.x_min) <= 0.03);
        assert_true(grid_inlet_effect(&lowest, -0.74 * found.x_min) > 0.03);
        assert_true(found.x_max >= grid_extent_needed(&reference).x_max);
        assert_true(found.step == grid_extent_needed(&reference).step);
    }
    // if the load only rises, the inlet stays as it is
    const ehd_contact light = still_contact("line", 4);
    check_close(extent_with("line", 4, 4, "load: {law: ramp, to: 5, start: 1, duration: 1}").x_min,
                grid_extent_needed(&light).x_min, 0, 1e-12);
}

/* The grid suits light loads that last only for a short time: at a kink, in each of a thousand
 * periods, and at the end. If the load were sampled once a period, all samples would be the mean
 * load. */
static void no_minimum_is_missed(void **state) {
    (void)state;
    static const char *const transients[] = {
        // M is small only around T = 1.0012, when the load has fallen and the speed has not
        "load: {law: ramp, to: 0.1, start: 1.001, duration: 0.0002}, "
        "speed: {law: ramp, to: 0.01, start: 1.0013, duration: 0.0002}",
        "load: {law: sine, mean: 0.55, amplitude: 0.45, period: 1}",
        "load: {law: step, to: 0.1, at: 999.9}"};

    for (size_t i = 0; i < sizeof transients / sizeof *transients; i++) {
        const double x_min = extent_with("line", 40, 1000, transients[i]).x_min;
        if (!(x_min <= -4)) fail_msg("case %zu: found %g", i, x_min);
    }
}

/* Checks whether the default grid is too short after the load has jumped from 1 to `load`. */
static bool is_short_at(const char *kind, double moes_M, double moes_L, double load) {
    char transient[128];
    ehd_histories *histories;
    double values[NUM_VARY], effect;
    ehd_contact frame;

    snprintf(transient, sizeof transient, "load: {law: step, to: %g, at: 1}", load);
    ehd_contact contact = contact_with(&histories, kind, moes_M, moes_L, 4, transient);
    const grid_extent extent = time_grid_extent(histories, &contact, 4);
    assert_int_equal(scene_set_grid(&contact, &extent, NULL), EHD_OK);
    histories_at(values, histories, 2);
    histories_free(histories);
    const contact_frame at = frame_at(contact.kind, 2, values, NAN);
    frame_contact(&frame, &at, &contact);
    return time_grid_is_short(&effect, &frame, false);
}

/* A default grid is trusted under the loads of its own history. The limit of nodes allows this for
 * lines if M is always above 0.3, and for points if M is at least 20 and the load falls to no less
 * than a fifth. */
static void default_grids_suffice(void **state) {
    (void)state;
    static const double all_M[] = {1, 3, 8, 20, 50, 150}, all_L[] = {0, 4, 8, 15};
    static const double loads[] = {1, 0.5, 0.2, 0.1, 0.03, 0.011};

    for (size_t m = 0; m < sizeof all_M / sizeof *all_M; m++)
        for (size_t l = 0; l < sizeof all_L / sizeof *all_L; l++)
            for (size_t w = 0; w < sizeof loads / sizeof *loads; w++) {
                if ((all_M[m] * loads[w] > 0.3 &&
                     is_short_at("line", all_M[m], all_L[l], loads[w])) ||
                    (all_M[m] >= 20 && loads[w] >= 0.2 &&
                     is_short_at("point", all_M[m], all_L[l], loads[w])))
                    fail_msg("M = %g, L = %g, load %g", all_M[m], all_L[l], loads[w]);
            }
}

/* However light the loads, the grid has at most 10,000 nodes, or twice as many as the grid of the
 * reference if this is more. */
static void grids_stay_within_bounds(void **state) {
    (void)state;
    static const double all_M[] = {30, 150};

    for (int i = 0; i < 2; i++) {
        ehd_histories *histories;
        ehd_contact contact = contact_with(&histories, "point", all_M[i], 0, 4,
                                           "load: {law: ramp, to: 0, start: 1, duration: 1}");
        const grid_extent extent = time_grid_extent(histories, &contact, 4);
        const double before = (double)contact.grid.num_inner;
        assert_int_equal(scene_set_grid(&contact, &extent, NULL), EHD_OK);
        const double after = (double)contact.grid.num_inner;
        if (!(after >= before && after <= fmax(10000, 2 * before)))
            fail_msg("M = %g: %g nodes, %g before", all_M[i], after, before);
        histories_free(histories);
    }
}

static void both_ends_have_an_inlet(void **state) {
    (void)state;
    const grid_extent found =
        extent_with("line", 40, 4,
                    "load: {law: ramp, to: 0.1, start: 1, duration: 1}, speed: {law: ramp, to: "
                    "-1, start: 1, duration: 1}");

    assert_true(found.x_max == -found.x_min && found.x_min < -3);
}

/* `error` is the error of the central film, computed by fullrun in comparison with four times the
 * length of the default grid (Roelands, compressible). The estimate is 1.1 to 5 times the error. */
static void estimates_are_bounds(void **state) {
    (void)state;
    static const struct {
        double moes_M, moes_L, length, error;
    } cases[] = {{0.3, 0, 96, 0.0050},    {0.3, 15, 24, 0.0593},    {1, 5, 12, 0.0103},
                 {3, 0, 3, 0.0296},       {10, 0, 2, 0.0102},       {10, 5, 2, 0.0474},
                 {30, 0, 4. / 3, 0.0097}, {30, 15, 4. / 3, 0.1776}, {100, 15, 1.5, 0.0236}};

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        ehd_contact contact = still_contact("line", 1);
        contact_set_moes(&contact, cases[i].moes_M, cases[i].moes_L);
        const double ratio = grid_inlet_effect(&contact, cases[i].length) / cases[i].error;
        if (!(ratio > 1.1 && ratio < 5)) fail_msg("case %zu: found %g times the error", i, ratio);
    }
}

/* The estimate for a frame equals the estimate for the stationary contact with the same M. For a
 * line with M = 1, L = 0 it is one to two times the error of the central film. The error was
 * measured in comparison with an inlet of 96 half widths: 1.6 % with 12 half widths, 3.6 % with
 * 8. */
static void effects_of_inlets(void **state) {
    (void)state;
    static const double error[] = {0.0162, 0.0357}, length[] = {12, 8};
    ehd_histories *histories;
    const ehd_contact reference =
        contact_with(&histories, "line", 10, 0, 4, "load: {law: step, from: 1, to: 0.1, at: 1}");

    for (int i = 0; i < 2; i++) {
        double values[NUM_VARY], effect, backwards;
        ehd_contact contact, still = reference;
        grid_extent extent = grid_extent_needed(&reference);
        extent.x_min = -length[i];
        assert_int_equal(scene_set_grid(&still, &extent, NULL), EHD_OK);
        histories_at(values, histories, 2);
        const contact_frame frame = frame_at(still.kind, 2, values, NAN);
        frame_contact(&contact, &frame, &still);
        assert_int_equal(time_grid_is_short(&effect, &contact, false), i == 1);
        if (!(effect > error[i] && effect < 2 * error[i])) fail_msg("found %g", effect);
        assert_true(time_grid_is_short(&backwards, &contact, true)); // an inlet of length 2
        contact_set_moes(&still, 1, 0);
        check_close(grid_inlet_effect(&still, length[i]), effect, 1e-9, 0);
    }
    histories_free(histories);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ends_suit_the_smallest_M), cmocka_unit_test(no_minimum_is_missed),
        cmocka_unit_test(default_grids_suffice),    cmocka_unit_test(grids_stay_within_bounds),
        cmocka_unit_test(both_ends_have_an_inlet),  cmocka_unit_test(estimates_are_bounds),
        cmocka_unit_test(effects_of_inlets),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
