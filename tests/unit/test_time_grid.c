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

/* Returns a contact of a kind with the default grid of its reference, and its histories. */
static ehd_contact contact_with(ehd_histories **histories, const char *kind, double moes_M,
                                const char *transient) {
    char text[512];
    ehd_contact contact;
    scene of;
    ehd_error error = {""};

    snprintf(text, sizeof text,
             "contact: %s\nregime: transient\nmoes: {M: %.17g, L: 0}\n"
             "lubricant: {viscosity: {law: barus, alpha: 1e-8}}\ntransient: {end_time: 4, %s}\n",
             kind, moes_M, transient);
    if (scene_parse(&of, text, strlen(text), "s.yml", NULL, 0, &error) ||
        scene_contact(&contact, &of, &error) || histories_init(histories, &of, &error))
        fail_msg("%s", error.text);
    return contact;
}

static grid_extent extent_with(const char *kind, double moes_M, const char *transient) {
    ehd_histories *histories;
    const ehd_contact contact = contact_with(&histories, kind, moes_M, transient);
    const grid_extent extent = time_grid_extent(histories, &contact, 4);

    histories_free(histories);
    return extent;
}

/* Returns the extent of the default grid of a stationary contact at L = 0. */
static grid_extent stationary_extent(const char *kind, double moes_M) {
    scene of = sample_scene("barus", "incompressible", moes_M, 0);
    ehd_contact contact;

    snprintf(of.contact, sizeof of.contact, "%s", kind);
    of.grid = (grid_settings){NAN, NAN, NAN, NAN, -1};
    scene_complete(&of);
    assert_int_equal(scene_contact(&contact, &of, NULL), EHD_OK);
    return grid_extent_needed(&contact);
}

/* M of a line is load / (u eta E^...)^(1/2), so in proportion to the load and to one over the root
 * of the speed. M of a point is in proportion to the load. */
static void ends_suit_the_smallest_M(void **state) {
    (void)state;
    static const struct {
        const char *kind, *transient;
        double moes_M, smallest;
    } cases[] = {
        {"line", "load: {law: sine, mean: 0.55, amplitude: 0.45, period: 3}", 40, 4},
        {"line", "load: {law: step, from: 1, to: 0.05, at: 3.999}", 40, 2},
        {"line", "load: {law: ramp, to: 0, start: 1, duration: 1}", 100, 1}, // as at 1 %
        {"line", "speed: {law: ramp, to: 64, start: 1, duration: 1}", 16, 2},
        {"line", "speed: {law: ramp, to: 0, start: 1, duration: 1}, start_speed: 64", 16, 2},
        {"point", "load: {law: step, from: 1, to: 0.08, at: 3.999}", 30, 2.4},
        {"line", "load: {law: ramp, to: 5, start: 1, duration: 1}", 4, 4},
    };

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const grid_extent reference = stationary_extent(cases[i].kind, cases[i].moes_M);
        const grid_extent lowest = stationary_extent(cases[i].kind, cases[i].smallest);
        const grid_extent found = extent_with(cases[i].kind, cases[i].moes_M, cases[i].transient);
        check_close(found.x_min, fmin(reference.x_min, lowest.x_min / 2), 0, 1e-12);
        if (found.x_min == reference.x_min && cases[i].smallest < cases[i].moes_M)
            fail_msg("case %zu tests nothing", i);
        check_close(found.x_max, fmax(reference.x_max, lowest.x_max), 0, 1e-12);
        assert_true(found.step == reference.step);
    }
}

/* The smallest load of one row of a table decides, between the regular times too. */
static void kinks_count(void **state) {
    (void)state;
    const grid_extent found = extent_with("line", 40,
                                          "load: {law: ramp, from: 0.1, to: 1, "
                                          "start: 0, duration: 0.0001}");

    check_close(found.x_min, stationary_extent("line", 4).x_min / 2, 0, 1e-12);
}

/* Light loads cause at most 10,000 nodes. */
static void grids_stay_within_bounds(void **state) {
    (void)state;
    ehd_histories *histories;
    ehd_contact contact =
        contact_with(&histories, "point", 30, "load: {law: ramp, to: 0, start: 1, duration: 1}");
    const grid_extent extent = time_grid_extent(histories, &contact, 4);
    const size_t before = contact.grid.num_inner;

    assert_int_equal(scene_set_grid(&contact, &extent, NULL), EHD_OK);
    assert_true(contact.grid.num_inner > before && contact.grid.num_inner <= 10000);
    histories_free(histories);
}

static void both_ends_have_an_inlet(void **state) {
    (void)state;
    const grid_extent found =
        extent_with("line", 40,
                    "load: {law: ramp, to: 0.1, start: 1, duration: 1}, speed: {law: ramp, to: "
                    "-1, start: 1, duration: 1}");

    assert_true(found.x_max == -found.x_min && found.x_min < -3);
}

/* The estimate of a frame is that of the stationary contact with the same M. A line at M = 1, L = 0
 * on an inlet of 12 half widths has a central film that is 1.6 % too thin against one of 96, with 8
 * it is 3.6 % (fullrun). */
static void effects_of_inlets(void **state) {
    (void)state;
    static const double error[] = {0.0162, 0.0357}, length[] = {12, 8};
    ehd_histories *histories;
    const ehd_contact reference =
        contact_with(&histories, "line", 10, "load: {law: step, from: 1, to: 0.1, at: 1}");

    for (int i = 0; i < 2; i++) {
        double values[NUM_VARY];
        ehd_contact contact, still = reference;
        grid_extent extent = grid_extent_needed(&reference);
        extent.x_min = -length[i];
        assert_int_equal(scene_set_grid(&still, &extent, NULL), EHD_OK);
        histories_at(values, histories, 2);
        const contact_frame frame = frame_at(still.kind, 2, values, NAN);
        frame_contact(&contact, &frame, &still);
        const double effect = time_grid_inlet_effect(&contact, false);
        if (!(effect > error[i] && effect < 2 * error[i])) fail_msg("found %g", effect);
        assert_true(time_grid_inlet_effect(&contact, true) > 0.3); // the outlet is 2 long
        contact_set_moes(&still, 1, 0);
        check_close(grid_inlet_effect(&still, length[i]), effect, 1e-9, 0);
    }
    histories_free(histories);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ends_suit_the_smallest_M), cmocka_unit_test(kinks_count),
        cmocka_unit_test(grids_stay_within_bounds), cmocka_unit_test(both_ends_have_an_inlet),
        cmocka_unit_test(effects_of_inlets),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
