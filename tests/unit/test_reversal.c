/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The full model with an entrainment that slows down, stops and reverses. */
#include "tests/unit/marched.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static marched first, second, third;
static ehd_error error;

/* Returns a line (M = 20, L = 6) or point contact (M = 20, L = 5) with inlets on both sides. */
static scene scene_of(bool point, const char *transient) {
    scene of = point ? marched_point(transient)
                     : marched_scene(20, 6, "dowson-higginson", 0.05, transient);

    strcpy(of.transport, "path");
    of.grid.x_min = -2.5;
    of.grid.x_max = 2.5;
    return of;
}

static double last_of(const marched *self, const double *values) {
    return values[self->count - 1];
}

static void check_same_values(const double *a, const double *b, size_t count, double tolerance) {
    for (size_t i = 0; i < count; i++)
        check_close(a[i], b[i], tolerance, 0);
}

/* Compares the last film of one march with the mirror image of the last film of another march, for
 * |X| up to 1.2. Returns the largest difference, relative to the central film. */
static double off_mirror(const marched *self, const marched *other) {
    const ehd_grid *grid = &self->reference.grid;
    const size_t width = grid_width(grid);
    const double *film = full_march_state(self->full, NULL)->film;
    const double *mirrored = full_march_state(other->full, NULL)->film;
    double largest = 0;

    for (size_t k = 0; k < grid->num_nodes; k++)
        if (fabs(grid_x(grid, k)) <= 1.2)
            largest =
                fmax(largest, fabs(film[k] - mirrored[k / width * width + width - 1 - k % width]));
    return largest / last_of(self, self->film);
}

/* The results of a negative speed are mirror images of the results of the positive speed, from the
 * start on. The grid need not be symmetric. */
static void negative_speeds_are_mirror_images(void **state) {
    static const char *const transients[] = {
        "end_time: 1, fixed_step: 0.02, load: {law: sine, amplitude: 0.2, period: 0.5}, "
        "start_speed: 1",
        "end_time: 1, fixed_step: 0.05, approach: {law: sine, amplitude: 0.05, period: 1}",
        // in longer runs round-off would lead to different time steps
        "end_time: 0.15, tolerance: 1e-4, load: {law: sine, amplitude: 0.2, period: 0.5}"};
    (void)state;
    for (int i = 0; i < 4; i++) {
        scene of = scene_of(i == 3, transients[i % 3]);
        history_settings *speed = &of.transient.vary[VARY_SPEED];
        of.grid.x_min = -3;
        of.grid.x_max = 2;
        strcpy(speed->law, "ramp");
        speed->from = 1;
        speed->to = 0.5;
        speed->start = 0;
        speed->duration = 1;
        marched_all(&first, &of);
        of.grid.x_min = -2;
        of.grid.x_max = 3;
        speed->from *= -1;
        speed->to *= -1;
        of.transient.start_speed *= -1;
        marched_all(&second, &of);
        assert_int_equal(first.count, second.count);
        check_same_values(second.film, first.film, first.count, 1e-9);
        check_same_values(second.least_film, first.least_film, first.count, 1e-9);
        check_same_values(second.load, first.load, first.count, 1e-9);
        for (size_t k = 0; k < first.count; k++)
            check_close(second.exit[k], -first.exit[k], 1e-9, 0);
        assert_true(off_mirror(&second, &first) < 1e-9);
        marched_end(&first);
        marched_end(&second);
    }
}

/* In half a period the fluid moves by 2.5 half widths, more than the length of the contact. With a
 * shorter path a part of the initial film would remain in the contact. */
static const char to_and_fro[] = "fixed_step: 0.04, "
                                 "speed: {law: sine, mean: 0, amplitude: 1, period: 8, "
                                 "phase: 1.5707963267948966}";

/* Checks that exits lie on the downstream side of the contact, which changes with the speed. */
static void check_exits(const marched *self) {
    for (size_t k = 1; k < self->count; k++) {
        const double speed = cos(2 * M_PI * self->time[k] / 8);
        if (fabs(speed) > 0.1) assert_true(self->exit[k] * speed > 0);
        if (fabs(speed) > 0.5) assert_true(fabs(self->exit[k]) < 1.3);
    }
}

/* Once the start has no effect any more, the fields are the mirror image of the fields half a
 * period before. */
static void half_a_period_later_is_the_mirror_image(void **state) {
    char transient[256];
    (void)state;
    for (int point = 0; point < (check_all() ? 2 : 1); point++) {
        for (int half = 0; half < 2; half++) {
            snprintf(transient, sizeof transient, "end_time: %d, %s", 12 + 4 * half, to_and_fro);
            scene of = scene_of(point, transient);
            if (point) of.transient.fixed_step = 0.0625;
            marched_all(half ? &second : &first, &of);
        }
        const size_t period = second.count - first.count; // number of steps in half a period
        for (size_t k = first.count - period; k < first.count; k++) {
            check_close(second.film[k + period], first.film[k], 1e-3, 0);
            check_close(second.least_film[k + period], first.least_film[k], 3e-3, 0);
        }
        check_exits(&second);
        assert_true(off_mirror(&second, &first) < 2e-3);
        marched_end(&first);
        marched_end(&second);
    }
}

/* Each interval with pressure has an exit at its downstream end, unless it contains only noise. */
static void every_interval_has_an_exit(void **state) {
    (void)state;
    const ehd_grid grid = grid_of(-2, 0.25, 17, 1, false, DISCRETIZATION_ACCURATE);
    double exits[GRID_EXITS];
    full_state of;

    assert_int_equal(full_state_init(&of, &grid, &error), EHD_OK);
    memset(of.ruptured, true, grid.num_nodes * sizeof *of.ruptured);
    for (size_t k = 4; k <= 16; k++) {
        if (k == 7 || k == 11) continue;
        of.ruptured[k] = false;
        of.pressure[k] = k > 7 && k < 11 ? -1e-9 : k == 6 || k == 12 ? -1e-9 : 1;
    }
    full_list_exits(exits, &of, &grid, false);
    check_close(exits[0], grid_x(&grid, 17), 0, 0);
    check_close(exits[1], grid_x(&grid, 6), 0, 0); // behind the last positive pressure
    assert_true(isnan(exits[2]));
    full_list_exits(exits, &of, &grid, true);
    check_close(exits[0], grid_x(&grid, 3), 0, 0);
    check_close(exits[1], grid_x(&grid, 12), 0, 0);
    assert_true(isnan(exits[2]));
    for (size_t k = 1; k <= 17; k++) {
        of.ruptured[k] = k % 2 == 0;
        of.pressure[k] = (double)(k % 2);
    }
    full_list_exits(exits, &of, &grid, false); // only the exits farthest downstream
    for (size_t i = 0; i < GRID_EXITS; i++)
        check_close(exits[i], grid_x(&grid, 18 - 2 * i), 0, 0);
    full_state_free(&of);
}

static void half_is_whole(void **state) {
    (void)state;
    scene of = scene_of(true, "end_time: 3, fixed_step: 0.1, speed: {law: sine, mean: 0, "
                              "amplitude: 1, period: 4, phase: 1.5707963267948966}");
    marched_all(&first, &of);
    of.grid.half = 0;
    marched_all(&second, &of);
    assert_int_equal(first.count, second.count);
    check_same_values(second.film, first.film, first.count, 1e-9);
    check_same_values(second.least_film, first.least_film, first.count, 1e-9);
    check_same_values(second.exit, first.exit, first.count, 1e-9);

    const size_t lines = grid_whole(&first.reference.grid).inner_lines;
    double *half = calloc(2 * lines * GRID_EXITS, sizeof *half), *whole = half + lines * GRID_EXITS;
    const march_solver *one = &first.march.solver, *other = &second.march.solver;
    assert_non_null(half);
    one->exits(half, one->self);
    other->exits(whole, other->self);
    for (size_t i = 0; i < lines * GRID_EXITS; i++)
        assert_true(half[i] == whole[i] || (isnan(half[i]) && isnan(whole[i])));
    assert_true(whole[lines / 2 * GRID_EXITS] < 0);
    free(half);
    marched_end(&first);
    marched_end(&second);
}

/* A run that starts at rest begins with the stationary film of another speed, in either direction,
 * or with a dry contact and a constant film. After a period all these starts give the same film. */
static void starts_from_rest(void **state) {
    static const char rest[] = "end_time: 12, fixed_step: 0.04, "
                               "speed: {law: sine, mean: 0, amplitude: 1, period: 8}";
    double stationary = 0;
    (void)state;
    for (int i = 0; i < 4; i++) {
        scene of = scene_of(false, rest);
        of.transient.start_speed = (double[]){1, -1, 0.5, NAN}[i];
        of.transient.start_film = 0.02;
        marched *self = i == 0 ? &first : &second;
        marched_all(self, &of);
        if (i == 0) stationary = self->film[0];
        if (i == 1) check_close(self->film[0], stationary, 1e-9, 0);
        if (i == 1) check_close(self->exit[0], -first.exit[0], 1e-9, 0);
        if (i == 2) check_close(self->film[0], 0.62 * stationary, 0.05, 0);
        if (i == 3) check_close(self->film[0], 0.02, 0.02, 0);
        if (i == 0) continue;
        for (size_t k = 1; k <= 100; k++)
            check_close(self->film[self->count - k], first.film[first.count - k], 5e-3, 0);
        marched_end(self);
    }
    marched_end(&first);
    scene of = scene_of(false, "end_time: 1, approach: {law: constant}, "
                               "speed: {law: sine, mean: 0, amplitude: 1, period: 4}");
    of.transient.start_speed = 1;
    marched_all(&first, &of);
    marched_end(&first);
}

/* Steps that are repeated, or made from a restored state, have the same bits, also in a march with
 * error control and reversals of the speed. */
static void repeated_and_restored_steps_have_the_same_bits(void **state) {
    (void)state;
    const scene of = scene_of(false, "end_time: 3.4, tolerance: 1e-3, speed: {law: sine, mean: 0, "
                                     "amplitude: 1, period: 4, phase: 2.6}");
    marched_all(&first, &of);
    for (size_t stop = 5; stop < first.count; stop += first.count / 6) {
        marched_begin(&second, &of);
        second.stop_at = stop;
        marched_on(&second);
        march_solver *from = &second.march.solver;
        double *saved = calloc(from->saved_size(from->self), sizeof *saved);
        march_step one, other;
        assert_non_null(saved);
        const contact_frame frame = march_frame(&second.march.settings, second.reference.kind,
                                                second.histories, first.time[stop] + 0.02, 1);
        assert_int_equal(from->attempt(&one, from->self, &frame, 0.02, &error), EHD_OK);
        const contact_frame far = march_frame(&second.march.settings, second.reference.kind,
                                              second.histories, first.time[stop] + 0.1, 1);
        assert_int_equal(from->attempt(&other, from->self, &far, 0.1, &error), EHD_OK);
        assert_int_equal(from->attempt(&other, from->self, &frame, 0.02, &error), EHD_OK);
        assert_memory_equal(&one.scalars, &other.scalars, sizeof one.scalars);
        check_close(one.local_error, other.local_error, 0, 0);

        from->save(saved, from->self);
        marched_check_restored(&third, &second, saved, &first);
        free(saved);
        marched_end(&second);
    }
    marched_end(&first);
}

/* If the outlet is too short, the step is untrusted, whatever the direction of motion. */
static void a_short_outlet_is_not_to_be_trusted(void **state) {
    (void)state;
    for (int backwards = 0; backwards < 2; backwards++) {
        march_step step;
        scene of = scene_of(false, "end_time: 1, fixed_step: 0.05");
        of.grid.x_min = backwards ? -1.15 : -2.5;
        of.grid.x_max = backwards ? 2.5 : 1.15;
        of.transient.start_speed = backwards ? -1 : 1;
        marched_begin(&first, &of);
        // the load rises by a half and squeezes the film
        const contact_frame frame =
            frame_at(&contact_line, 0.05, (double[]){1.5, of.transient.start_speed, 1, 1}, NAN);
        const march_solver *solver = &first.march.solver;
        assert_int_equal(solver->attempt(&step, solver->self, &frame, 0.05, &error), EHD_OK);
        assert_int_equal(step.status, EHD_UNTRUSTED);
        assert_non_null(strstr(step.reason, backwards ? "grid.x_min" : "grid.x_max"));
        marched_end(&first);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(negative_speeds_are_mirror_images),
        cmocka_unit_test(half_a_period_later_is_the_mirror_image),
        cmocka_unit_test(every_interval_has_an_exit),
        cmocka_unit_test(half_is_whole),
        cmocka_unit_test(starts_from_rest),
        cmocka_unit_test(repeated_and_restored_steps_have_the_same_bits),
        cmocka_unit_test(a_short_outlet_is_not_to_be_trusted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
