/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The transient full model, on a coarse grid. */
#include "common/settings/scene_contact.h"
#include "common/time/bdf.h"
#include "tests/unit/allocation.h"
#include "tests/unit/folder.h"
#include "tests/unit/marched.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Returns the usual contact: M = 20, L = 6 on 121 nodes. */
static scene usual_scene(const char *transient) {
    return marched_scene(20, 6, "dowson-higginson", 0.05, transient);
}

static scene along_path(scene of) {
    strcpy(of.transport, "path");
    return of;
}

static void run_usual(marched *self, const char *transient) {
    scene of = usual_scene(transient);
    marched_all(self, &of);
}

static double last_of(const marched *self, const double *values) {
    return values[self->count - 1];
}

static marched first, second, third;

// ---- constant histories

/* Constant histories keep the stationary solution, also in a frame other than the reference
 * frame. */
static void constant_histories_stay_stationary(void **state) {
    static const char *const transients[] = {
        "end_time: 1e4, tolerance: 1e-4", "end_time: 20, fixed_step: 0.5",
        "end_time: 10, fixed_step: 0.25, load: {law: sine, amplitude: 0, period: 1}, "
        "speed: {law: ramp, from: 1.5, to: 1.5, start: 2, duration: 1}, "
        "radius: {law: ramp, from: 0.8, to: 0.8, start: 2.1, duration: 1}, "
        "modulus: {law: ramp, from: 1.2, to: 1.2, start: 2, duration: 1}",
        "end_time: 10, fixed_step: 0.25, approach: {law: constant}"};
    (void)state;
    for (size_t i = 0; i < 4 * sizeof transients / sizeof *transients; i++) {
        bool point = i % 4 / 2 == 1;
        if (point && i % 4 != i / 4 && !check_all()) continue; // only two cases of point contacts
        scene of = point ? marched_point(transients[i / 4])
                         : marched_scene(20, 6, "dowson-higginson", 0.05, transients[i / 4]);
        if (i % 2) of = along_path(of);
        marched_all(&first, &of);
        for (size_t k = 0; k < first.count; k++) {
            check_close(first.film[k], first.film[0], 1e-9, 0);
            check_close(first.least_film[k], first.least_film[0], 1e-9, 0);
            check_close(first.pressure[k], first.pressure[0], 1e-9, 0);
            check_close(first.approach[k], first.approach[0], 1e-9, 0);
            check_close(first.load[k], first.load[0], 1e-9, 0);
            check_close(first.effect[k], 0, 0, 1e-9);
            check_close(first.effect_minimum[k], 0, 0, 1e-9);
        }
        marched_end(&first);
    }
}

/* Compares the start with the stationary contact of 1.3 times the load at 0.6 times the speed,
 * whose Moes numbers and half width are given. */
static void compare_start(const scene *of, double moes_M, double moes_L, double width) {
    scene physical = *of;
    full_settings settings = full_default_settings();
    full_solver *solver;
    full_state stationary;
    full_info info;
    ehd_contact contact;
    contact_frame frame;

    physical.transient.vary[VARY_LOAD] =
        (history_settings){.law = "step", .from = 1.3, .to = 1, .at = 0.5};
    physical.transient.vary[VARY_SPEED] =
        (history_settings){.law = "step", .from = 0.6, .to = 1, .at = 0.5};
    marched_begin(&first, &physical);
    frame = first.first.frame;
    contact = first.reference;
    contact_set_moes(&contact, moes_M, moes_L);
    check_close(contact.hertz_pressure, first.reference.hertz_pressure * width, 1e-12, 0);
    settings.exit_at_node = true; // like transient solutions
    assert_int_equal(full_solver_create(&solver, contact.kind, &contact.grid, &settings, NULL),
                     EHD_OK);
    assert_int_equal(full_state_init(&stationary, &contact.grid, NULL), EHD_OK);
    assert_int_equal(full_solve_cold(&info, &stationary, solver, &contact, NULL), EHD_OK);
    check_close_array(full_march_state(first.full, NULL)->pressure, stationary.pressure,
                      contact.grid.num_nodes, 0, 1e-8);
    check_close_array(full_march_state(first.full, NULL)->film, stationary.film,
                      contact.grid.num_nodes, 1e-8, 0);
    check_close(frame.half_width, width, 1e-14, 0);
    full_state_free(&stationary);
    full_solver_free(solver);
    marched_end(&first);
}

/* The start in any frame is the stationary contact of this frame. M is proportional to the load and
 * to the speed to the power -1/2 (line) or -3/4 (point). L depends only on the speed. */
static void start_is_the_stationary_contact(void **state) {
    (void)state;
    const scene line = marched_scene(20, 6, "dowson-higginson", 0.05, "end_time: 1, fixed_step: 1");
    const scene point = marched_point("end_time: 1, fixed_step: 1");
    compare_start(&line, 20 * 1.3 / sqrt(0.6), 6 * pow(0.6, 0.25), sqrt(1.3));
    compare_start(&point, 20 * 1.3 / pow(0.6, 0.75), 5 * pow(0.6, 0.25), cbrt(1.3));
}

// ---- accuracy of time steps

/* Returns the largest difference between the central films of two runs, at the points in time of
 * `coarse`. The time steps of `coarse` are twice as long as the time steps of `fine`. */
static double film_difference(const marched *coarse, const marched *fine) {
    double largest = 0;

    for (size_t k = 0; k < coarse->count; k++) {
        check_close(fine->time[2 * k], coarse->time[k], 1e-12, 0);
        largest = fmax(largest, fabs(fine->film[2 * k] - coarse->film[k]));
    }
    return largest;
}

/* Checks the order of the error from runs with time steps of `longest`, half of it and a quarter of
 * it. The accurate discretisation has steeper films, so its order appears only with shorter steps.
 * With steps of 0.02 its order on a line contact is 1.56. */
static void check_order(scene (*scene_of)(const char *), const char *law, double longest,
                        const char *discretization) {
    marched *const runs[] = {&first, &second, &third};
    for (size_t i = 0; i < 3; i++) {
        char transient[512];
        snprintf(transient, sizeof transient, "end_time: 1.2, fixed_step: %.17g, %s",
                 longest / (double)(1 << i), law);
        scene of = scene_of(transient);
        strcpy(of.discretization, discretization);
        marched_all(runs[i], &of);
    }
    double large = film_difference(&first, &second), little = film_difference(&second, &third);
    assert_true(large > 1e-7);
    check_close(log2(large / little), 2, 0, 0.15);
    for (size_t i = 0; i < 3; i++)
        marched_end(runs[i]);
}

static void fixed_steps_of_a_point_contact(void **state) {
    (void)state;
    static const char law[] =
        "load: {law: sine, amplitude: 0.2, period: 2, phase: 1.5707963267948966}, "
        "speed: {law: sine, amplitude: 0.2, period: 3, phase: 1.5707963267948966}";
    check_order(marched_point, law, 0.04, "published");
    if (check_all()) check_order(marched_point, law, 0.01, "accurate");
}

/* The differences between runs decrease with the square of the time step. */
static void fixed_steps_are_of_second_order(void **state) {
    static const char *const laws[] = {
        "load: {law: sine, amplitude: 0.2, period: 2, phase: 1.5707963267948966}",
        "speed: {law: sine, amplitude: 0.3, period: 2, phase: 1.5707963267948966}",
        "load: {law: sine, amplitude: 0.1, period: 3, phase: 1.5707963267948966}, "
        "radius: {law: sine, amplitude: 0.1, period: 2, phase: 1.5707963267948966}, "
        "modulus: {law: sine, amplitude: 0.1, period: 4, phase: 1.5707963267948966}"};
    (void)state;
    for (size_t i = check_all() ? 0 : 2; i < sizeof laws / sizeof *laws; i++) {
        check_order(usual_scene, laws[i], 0.02, "published");
        check_order(usual_scene, laws[i], 0.005, "accurate");
    }
}

/* Checks the error of the film under error control, also at a kink after long steps. On this coarse
 * grid the accurate discretisation has up to twice the error of the published one. */
static void tolerance_holds(void **state) {
    static const struct {
        const char *law;
        double end_time;
    } cases[] = {{"load: {law: sine, amplitude: 0.1, period: 0.5}", 1.5},
                 {"load: {law: ramp, from: 1, to: 1.5, start: 0.01, duration: 0.1}", 2},
                 {"load: {law: ramp, from: 1, to: 1.5, start: 1000, duration: 0.1}", 1002},
                 {"load: {law: step, from: 1, to: 1.5, at: 100}", 102},
                 {"speed: {law: ramp, from: 1, to: 1.5, start: 1000, duration: 1}", 1003},
                 {"speed: {law: ramp, from: 1, to: 0, start: 0.5, duration: 1}", 3}};
    const size_t num_cases = check_all() ? sizeof cases / sizeof *cases : 1;
    (void)state;
    for (size_t i = 0; i < 2 * num_cases; i++) {
        const bool accurate = i % 2;
        double error[2] = {0};
        for (int t = 2; t >= 0; t--) {
            marched *const self = t == 2 ? &third : &first;
            char transient[256];
            snprintf(transient, sizeof transient, "end_time: %g, tolerance: 1e-%d, %s",
                     cases[i / 2].end_time, 3 + t, cases[i / 2].law);
            scene of = usual_scene(transient);
            strcpy(of.discretization, accurate ? "accurate" : "published");
            marched_all(self, &of);
            if (t < 2) {
                error[t] = marched_deviation(self, &third);
                marched_end(self);
            }
        }
        marched_end(&third);
        assert_true(error[0] < (accurate ? 3e-3 : 2e-3) && error[1] < (accurate ? 6e-4 : 4e-4));
        assert_true(error[1] < error[0] / 2.5);
    }
}

/* With transport along the path, the film follows a slowly changing load. A time step may then be
 * longer than the time in which the film passes through the contact. It must still be as accurate
 * as the tolerance requires. */
static void a_slow_ramp_along_the_path_ends_at_rest(void **state) {
    static const char transient[] =
        "end_time: 60, load: {law: ramp, from: 1, to: 1.08, start: 0.5, duration: 40}";
    (void)state;
    for (int i = 0; i < 2; i++) {
        scene of = usual_scene(transient);
        strcpy(of.transport, i == 0 ? "path" : "upwind");
        of.transient.tolerance = i == 0 ? 1.5e-3 : 1e-4;
        marched_all(i == 0 ? &first : &second, &of);
    }
    check_close(last_of(&first, first.film), last_of(&second, second.film), 3e-3, 0);
    assert_true(first.count > 30);
    marched_end(&first);
    marched_end(&second);
}

/* While the film follows the load, the exit lies between two nodes. Its position agrees with the
 * exit position on a grid with a quarter of the grid step. */
static void the_exit_lies_within_its_node(void **state) {
    static const char transient[] =
        "end_time: 2, fixed_step: 0.02, load: {law: sine, amplitude: 0.1, period: 1}";
    const double step = 0.05;
    double largest = 0, moved = 0;
    (void)state;
    for (int i = 0; i < 2; i++) {
        scene of = usual_scene(transient);
        of.grid.step = i == 0 ? step : step / 4;
        marched_all(i == 0 ? &first : &second, &of);
    }
    assert_int_equal(first.count, second.count);
    for (size_t k = 0; k < first.count; k++) {
        largest = fmax(largest, fabs(first.exit[k] - second.exit[k]));
        moved = fmax(moved, fabs(first.exit[k] - first.exit[0]));
    }
    assert_true(moved > 0.9 * step && largest < step / 10);
    marched_end(&first);
    marched_end(&second);
}

/* rho H of the last four states at all nodes, newest first, and results of the check. */
typedef struct error_check {
    const marched *run;
    size_t num_states;
    double time[4], mass[4][400];
    size_t exit[4], num_moves;
    double largest_in_front; // largest error between 0.1 and 0.5 half widths before the exit
} error_check;

static void keep_mass(error_check *self, const march_step *step) {
    const full_state *found = full_march_state(self->run->full, NULL);
    const ehd_contact *contact = &self->run->reference;

    for (size_t i = 3; i > 0; i--) {
        self->time[i] = self->time[i - 1];
        self->exit[i] = self->exit[i - 1];
        memcpy(self->mass[i], self->mass[i - 1], sizeof self->mass[i]);
    }
    self->time[0] = step->frame.time;
    self->exit[0] = found->exit;
    for (size_t k = 0; k < contact->grid.num_nodes; k++)
        self->mass[0][k] = found->film[k] *
                           lubricant_density(&contact->lubricant,
                                             fmax(found->pressure[k], 0) * contact->hertz_pressure);
    self->num_states++;
}

/* Compares the local error with its formula. Only the speed varies, so the nodes of all states are
 * at the same physical places. */
static ehd_status check_local_error(void *sink, const march_step *step, size_t index,
                                    ehd_error *ignored) {
    error_check *self = sink;
    const ehd_grid *grid = &self->run->reference.grid;
    (void)index, (void)ignored;

    keep_mass(self, step);
    if (self->num_states < 4) return EHD_OK;
    const double intervals[] = {self->time[1] - self->time[2], self->time[2] - self->time[3]};
    const bdf_formula formula = bdf_step(step->step, intervals, 3);
    size_t exit = self->exit[0];
    double largest = 0;
    for (size_t i = 1; i < 4; i++)
        exit = self->exit[i] < exit ? self->exit[i] : exit;
    for (size_t k = 1; k < exit; k++) {
        double error = self->mass[0][k], before = grid->step * (double)(exit - k);
        for (size_t i = 0; i < 3; i++)
            error -= formula.predictor[i] * self->mass[i + 1][k];
        error = fabs(error) * formula.error / step->scalars.central_film_thickness;
        if (before > 0.1 * (1 + 1e-9)) largest = fmax(largest, error);
        if (before > 0.1 * (1 + 1e-9) && before < 0.5)
            self->largest_in_front = fmax(self->largest_in_front, error / step->local_error);
    }
    check_close(step->local_error, largest, 1e-4, 0);
    self->num_moves += self->exit[0] != self->exit[1];
    return EHD_OK;
}

/* The local error is the largest error at nodes more than a tenth of a half width before the exit.
 * Errors nearer to the exit are left out: they contain noise, because the exit moves by whole
 * nodes. The speed oscillates, so that the exit moves and disturbances of the film travel to the
 * exit. */
static void local_error_is_that_before_the_exit(void **state) {
    (void)state;
    static error_check check;
    scene of =
        marched_scene(20, 6, "dowson-higginson", 0.02,
                      "end_time: 3, fixed_step: 0.01, "
                      "speed: {law: sine, amplitude: 0.4, period: 1, phase: 1.5707963267948966}");
    marched_begin(&first, &of);
    check = (error_check){.run = &first};
    keep_mass(&check, &first.first);
    first.march.store = check_local_error;
    first.march.sink = &check;
    marched_on(&first);
    assert_int_equal(first.outcome, EHD_OK);
    assert_true(check.num_moves >= 3);
    check_close(check.largest_in_front, 1, 1e-4, 0);
    marched_end(&first);
}

// ---- asymptotic behaviour

/* After the start, the response to a sine becomes periodic with the period of the sine. */
static void sine_leads_to_a_periodic_state(void **state) {
    (void)state;
    run_usual(&first, "end_time: 12, fixed_step: 0.02, "
                      "load: {law: sine, amplitude: 0.3, period: 1}");
    double start = 0, end = 0, least = INFINITY, most = 0;
    for (size_t k = 0; k + 50 < first.count; k++) {
        double change = fabs(first.film[k + 50] / first.film[k] - 1);
        if (first.time[k] < 1) start = fmax(start, change);
        if (first.time[k] >= 10) end = fmax(end, change);
        least = fmin(least, first.film[k]);
        most = fmax(most, first.film[k]);
    }
    assert_true(most > 1.5 * least && start > 0.1 && end < 1e-8);
    marched_end(&first);
}

/* After all changes the contact is the stationary contact of the last values, up to round-off and,
 * with transport along the path, the errors of transport and filter. */
static void ramps_end_in_the_stationary_contact(void **state) {
    static const char ramps[] = "load: {law: ramp, from: 1.4, to: 0.8, start: 0.5, duration: 1}, "
                                "speed: {law: ramp, from: 0.7, to: 1.2, start: 0.1, duration: 2}, "
                                "radius: {law: ramp, from: 0.9, to: 1.3, start: 0.2, duration: 1}, "
                                "modulus: {law: ramp, from: 1.2, to: 0.9, start: 1, duration: 0.5}";
    static const char last[] = "end_time: 1, fixed_step: 1, "
                               "load: {law: ramp, from: 0.8, to: 0.8, duration: 1}, "
                               "speed: {law: ramp, from: 1.2, to: 1.2, duration: 1}, "
                               "radius: {law: ramp, from: 1.3, to: 1.3, duration: 1}, "
                               "modulus: {law: ramp, from: 0.9, to: 0.9, duration: 1}";
    (void)state;
    for (int path = 0; path < 2; path++) {
        const double step = path ? 0.025 : 0.05, film = path ? 1e-3 : 1e-8,
                     others = path ? 3e-4 : 1e-8;
        char transient[512];
        snprintf(transient, sizeof transient, "end_time: %s, %s",
                 path ? "20, tolerance: 1.5e-3" : "100, tolerance: 1e-4", ramps);
        scene of = marched_scene(20, 6, "dowson-higginson", step, transient);
        if (path) of = along_path(of);
        marched_all(&first, &of);
        of = marched_scene(20, 6, "dowson-higginson", step, last);
        marched_all(&second, &of);
        check_close(last_of(&first, first.film), second.film[0], film, 0);
        check_close(last_of(&first, first.approach), second.approach[0], others, 0);
        check_close(last_of(&first, first.pressure), second.pressure[0], others, 0);
        marched_end(&first);
        marched_end(&second);
    }
}

// ---- the approach given

/* Returns the usual contact with the approach measured at 10 half widths, the default distance of a
 * given approach. */
static scene measured_scene(const char *transient) {
    scene of = usual_scene(transient);
    of.approach_length = 10;
    return of;
}

static void run_measured(marched *self, const char *transient) {
    scene of = measured_scene(transient);
    marched_all(self, &of);
}

/* A table gives the approach that resulted from a load. This approach must lead to that load. */
static void approach_gives_the_load_back(void **state) {
    static const char name[] = "approach.csv";
    (void)state;
    for (int path = 0; path < 2; path++) {
        scene of = measured_scene("end_time: 1, fixed_step: 0.01, "
                                  "load: {law: sine, amplitude: 0.2, period: 0.8}, "
                                  "speed: {law: sine, amplitude: 0.1, period: 1.5}");
        if (path) of = along_path(of);
        marched_all(&first, &of);
        FILE *file = fopen(name, "w");
        assert_non_null(file);
        fprintf(file, "time,approach\n");
        for (size_t k = 0; k < first.count; k++)
            fprintf(file, "%.17g,%.17g\n", first.time[k], first.approach[k] / first.approach[0]);
        assert_int_equal(fclose(file), 0);
        of = usual_scene("end_time: 1, fixed_step: 0.01, "
                         "speed: {law: sine, amplitude: 0.1, period: 1.5}, "
                         "approach: {law: table, file: approach.csv, column: approach, "
                         "interpolation: linear}");
        if (path) of = along_path(of);
        marched_all(&second, &of);
        assert_int_equal(second.count, first.count);
        for (size_t k = 0; k < first.count; k++) {
            // slightly different loads scale the frames, so the nodes have other physical places
            check_close(second.load[k], first.load[k], 1e-4, 0);
            check_close(second.film[k], first.film[k], 1e-4, 0);
            check_close(second.approach[k], first.approach[k], 1e-9, 1e-9);
        }
        marched_end(&first);
        marched_end(&second);
    }
}

/* A start from a given approach finds the load that belongs to this approach. */
static void start_from_a_given_approach(void **state) {
    (void)state;
    scene of = marched_scene(20, 6, "dowson-higginson", 0.05,
                             "end_time: 1, fixed_step: 0.1, load: {law: ramp, from: 1.5, to: 1.5, "
                             "duration: 1}");
    of.approach_length = 10;
    marched_all(&first, &of);
    of = marched_scene(20, 6, "dowson-higginson", 0.05,
                       "end_time: 1, fixed_step: 0.1, approach: {law: constant}");
    of.approach = first.approach[0];
    marched_all(&second, &of);
    for (size_t k = 0; k < second.count; k++) {
        check_close(second.load[k], 1.5, 1e-7, 0);
        check_close(second.film[k], first.film[0], 1e-7, 0);
        check_close(second.approach[k], first.approach[0], 1e-9, 0);
    }
    marched_end(&first);
    marched_end(&second);
}

/* Starts from an approach that removes nearly all of the load. The continuation takes steps of 1/32
 * of the distance to this approach. */
static void start_from_an_approach_far_away(void **state) {
    (void)state;
    scene of = marched_scene(20, 8, "dowson-higginson", 0.02,
                             "end_time: 0.1, fixed_step: 0.1, approach: {law: constant}");
    of.approach = 0;
    of.grid.x_min = -12; // a contact under so light a load needs a long inlet
    marched_begin(&first, &of);
    check_close(first.approach[0], 0, 0, 1e-9);
    assert_true(first.load[0] > 0 && first.load[0] < 0.3);
    marched_end(&first);
}

/* A given approach leads to the same squeezed film with short and with long time steps. */
static void approach_is_well_posed(void **state) {
    (void)state;
    run_measured(&first, "end_time: 0.02, fixed_step: 0.002, "
                         "approach: {law: sine, amplitude: 0.2, period: 1}");
    run_measured(&second, "end_time: 0.02, fixed_step: 0.0001, "
                          "approach: {law: sine, amplitude: 0.2, period: 1}");
    check_close(last_of(&first, first.load), last_of(&second, second.load), 1e-3, 0);
    check_close(last_of(&first, first.film), last_of(&second, second.film), 1e-3, 0);
    marched_end(&first);
    marched_end(&second);
}

/* An approach relative to a point inside the pressurised zone is not well posed, and is refused. */
static void approach_from_within_is_refused(void **state) {
    (void)state;
    scene of =
        marched_scene(20, 6, "dowson-higginson", 0.05, "end_time: 1, approach: {law: constant}");
    ehd_contact contact;
    ehd_error error = {""};
    of.approach_length = 2.9;
    assert_int_equal(scene_contact(&contact, &of, &error), EHD_DATA);
    assert_non_null(strstr(error.text, "approach_length: found 2.9, expected at least 3"));
}

// ---- no entrainment

/* The speed decreases to zero: the squeezed film becomes ever thinner, under a constant load. */
static void speed_goes_down_to_zero(void **state) {
    (void)state;
    run_usual(&first, "end_time: 20, tolerance: 1e-3, "
                      "speed: {law: ramp, from: 1, to: 0, start: 0.5, duration: 1}");
    double last = INFINITY;
    for (size_t k = 0; k < first.count; k++) {
        check_close(first.load[k], 1, 1e-9, 0);
        assert_true(first.least_film[k] > 0);
        if (first.time[k] < 1.5) continue;
        assert_true(first.least_film[k] < last);
        last = first.least_film[k];
    }
    marched_end(&first);
}

/* A start at rest with a given film develops to the stationary contact. */
static void start_at_rest(void **state) {
    (void)state;
    run_usual(&first, "end_time: 40, tolerance: 1e-3, start_film: 0.05, "
                      "speed: {law: ramp, from: 0, to: 1, duration: 1}");
    run_usual(&second, "end_time: 1, fixed_step: 1");
    check_close(first.film[0], 0.05, 0.02, 0);
    check_close(last_of(&first, first.film), second.film[0], 1e-6, 0);
    check_close(last_of(&first, first.pressure), second.pressure[0], 1e-6, 0);
    for (size_t k = 1; k < first.count; k++) {
        check_close(first.load[k], 1, 1e-9, 0);
        assert_true(first.least_film[k] > 0);
    }
    marched_end(&first);
    marched_end(&second);
}

static void squeeze_is_symmetric(void **state) {
    (void)state;
    scene of = marched_scene(20, 6, "dowson-higginson", 0.05,
                             "end_time: 2, tolerance: 1e-3, start_film: 0.1, "
                             "speed: {law: ramp, from: 0, to: 0, duration: 1}");
    of.grid.x_max = 4;
    marched_all(&first, &of);
    const full_state *last = full_march_state(first.full, NULL);
    const ehd_grid *grid = &first.reference.grid;
    size_t centre = (size_t)lround(-grid->x_min / grid->step) + 1;
    for (size_t k = 1; k <= 80; k++) {
        check_close(last->pressure[centre + k], last->pressure[centre - k], 0, 1e-10);
        check_close(last->film[centre + k], last->film[centre - k], 0, 1e-10);
    }
    assert_true(last_of(&first, first.film) < first.film[0]);
    marched_end(&first);
}

// ---- repeating, saving

static const char busy[] =
    "end_time: 1, tolerance: 1e-3, load: {law: sine, amplitude: 0.3, period: 0.5}, "
    "speed: {law: ramp, from: 1, to: 0.4, start: 0.3, duration: 0.4}, "
    "radius: {law: step, from: 1, to: 1.1, at: 0.6}";

static void save_and_go_on(const scene *scene_of_run) {
    const scene of = *scene_of_run;
    marched_all(&first, &of);
    for (size_t stop = 1; stop < first.count; stop += first.count / 5) {
        marched_begin(&second, &of);
        second.stop_at = stop;
        marched_on(&second);
        assert_int_equal(second.count, stop + 1);
        const march_solver *from = &second.march.solver;
        double *saved = calloc(from->saved_size(from->self), sizeof *saved);
        assert_non_null(saved);
        from->save(saved, from->self);
        marched_check_restored(&third, &second, saved, &first);
        free(saved);
        marched_end(&second);
    }
    marched_end(&first);
}

static void saved_march_goes_on_with_the_same_bits(void **state) {
    (void)state;
    const scene line = marched_scene(20, 6, "dowson-higginson", 0.05, busy);
    const scene point = marched_point("end_time: 0.2, fixed_step: 0.02, "
                                      "load: {law: sine, amplitude: 0.2, period: 0.5}");
    const scene line_along = along_path(line), point_along = along_path(point);
    save_and_go_on(&line_along);
    save_and_go_on(&point);
    if (!check_all()) return;
    save_and_go_on(&line);
    save_and_go_on(&point_along);
}

static void bad_saves_are_refused(void **state) {
    (void)state;
    scene of = marched_scene(20, 6, "incompressible", 0.1, "end_time: 0.5, fixed_step: 0.1");
    marched_all(&first, &of);
    const march_solver *solver = &first.march.solver;
    size_t size = solver->saved_size(solver->self);
    double *saved = calloc(size, sizeof *saved);
    double *states = saved + first.reference.grid.num_nodes; // errors along the path come first
    ehd_error error = {""};

    assert_non_null(saved);
    solver->save(saved, solver->self);
    assert_int_equal(solver->restore(solver->self, saved, &error), EHD_OK);
    const double bad[] = {0, 4, -1, NAN};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        states[0] = bad[i];
        assert_int_equal(solver->restore(solver->self, saved, &error), EHD_DATA);
        assert_non_null(strstr(error.text, "previous states"));
    }
    states[0] = 3;
    states[1 + NUM_FRAME + 20] = NAN; // a value of the first state
    assert_int_equal(solver->restore(solver->self, saved, &error), EHD_DATA);
    assert_non_null(strstr(error.text, "expected finite values"));
    states[1 + NUM_FRAME + 20] = 0;
    saved[20] = NAN;
    assert_int_equal(solver->restore(solver->self, saved, &error), EHD_DATA);
    assert_non_null(strstr(error.text, "expected finite values"));
    memset(saved, 0, size * sizeof *saved);
    states[0] = 3;
    assert_int_equal(solver->restore(solver->self, saved, &error), EHD_DATA);
    free(saved);
    marched_end(&first);
}

/* A repeated step has the same bits, also after an attempt with another length and frame. */
static void repeat_attempts(const scene *of) {
    marched_begin(&first, of);
    first.stop_at = 10;
    marched_on(&first);
    const march_solver *solver = &first.march.solver;
    const double time = first.march.state.time,
                 step = first.march.state.forecast.last_step; // a step of second order
    march_step one, other, again;
    ehd_error error = {""};
    contact_frame near =
        march_frame(&first.march.settings, &contact_line, first.histories, time + step, 1);
    contact_frame far =
        march_frame(&first.march.settings, &contact_line, first.histories, time + 10 * step, 1);
    assert_int_equal(solver->attempt(&one, solver->self, &near, step, &error), EHD_OK);
    assert_int_equal(solver->attempt(&other, solver->self, &far, 10 * step, &error), EHD_OK);
    assert_int_equal(solver->attempt(&again, solver->self, &near, step, &error), EHD_OK);
    assert_int_equal(one.status, EHD_OK);
    assert_int_equal(one.formula.order, 2);
    assert_memory_equal(&one.scalars, &again.scalars, sizeof one.scalars);
    check_close(one.local_error, again.local_error, 0, 0);
    assert_int_equal(one.iterations, again.iterations);
    assert_false(one.scalars.central_film_thickness == other.scalars.central_film_thickness);
    // after a restart, no states before the last state are left to estimate the error from
    assert_true(one.local_error > 0);
    solver->restart(solver->self);
    assert_int_equal(solver->attempt(&again, solver->self, &near, step, &error), EHD_OK);
    check_close(again.local_error, 0, 0, 0);
    assert_false(one.scalars.central_film_thickness == again.scalars.central_film_thickness);
    marched_end(&first);
}

static void attempts_can_be_repeated(void **state) {
    (void)state;
    const scene of = marched_scene(20, 6, "dowson-higginson", 0.05, busy), along = along_path(of);
    repeat_attempts(&of);
    repeat_attempts(&along);
}

// ---- along the path

static double dent(double x) {
    return -2e-3 * exp(-pow((x + 0.5) / 0.12, 2));
}

/* Adds a dent to the film of the only accepted state, by changing the saved data of the march.
 * These data begin with the errors along the path. With transport along the path, the base (the
 * initial state) and its time limit come before the states. */
static void add_dent(march_solver *solver, const ehd_grid *grid, bool path,
                     double (*of)(double x)) {
    const size_t size = solver->saved_size(solver->self), errors = grid->num_nodes;
    const size_t state = (size - errors - 2 - path) / (BDF_PREVIOUS + path);
    const size_t first_state = 2 + errors + path * (state + 1);
    double *saved = calloc(size, sizeof *saved);
    assert_non_null(saved);
    solver->save(saved, solver->self);
    for (size_t k = 0; k < grid->num_nodes; k++)
        saved[first_state + state - grid->num_nodes + k] += of(grid_x(grid, k));
    assert_int_equal(solver->restore(solver->self, saved, NULL), EHD_OK);
    free(saved);
}

/* Computes how a dent changes the film after a run of fixed steps. In this contact the film hardly
 * changes the pressure. */
static void carry_dent(double *left, double (*of)(double x), const char *transport,
                       double smoothing, const char *transient) {
    scene of_run = marched_scene(200, 10, "incompressible", 0.01, transient);
    strcpy(of_run.transport, transport);
    of_run.transient.smoothing = smoothing;
    for (int dented = 0; dented < 2; dented++) {
        marched_begin(&first, &of_run);
        const ehd_grid *grid = &first.reference.grid;
        if (dented) add_dent(&first.march.solver, grid, strcmp(transport, "path") == 0, of);
        marched_on(&first);
        assert_int_equal(first.outcome, EHD_OK);
        const double *film = full_march_state(first.full, NULL)->film;
        for (size_t k = 0; k < grid->num_nodes; k++)
            left[k] = dented ? film[k] - left[k] : film[k];
        marched_end(&first);
    }
}

/* With transport along the path a dent passes through the contact unchanged, although the speed
 * rises. The expected film is the shifted dent. Upwind transport smears the dent. */
static void a_dent_passes_unchanged(void **state) {
    static const char transient[] = "end_time: 0.64, fixed_step: 0.02, "
                                    "speed: {law: ramp, from: 1, to: 1.5, duration: 0.64}";
    static double left[603];
    double missed[2] = {0};
    (void)state;
    for (int path = 0; path < 2; path++) {
        carry_dent(left, dent, path ? "path" : "upwind", NAN, transient);
        for (size_t k = 0; k < 603; k++) {
            const double x = -4.01 + 0.01 * (double)k;
            if (fabs(x - 0.3) > 0.4) continue; // compares only around the dent, now at X = 0.3
            missed[path] = fmax(missed[path], fabs(left[k] - dent(x - 0.8)) / -dent(-0.5));
        }
    }
    assert_true(missed[1] < 1e-3);
    assert_true(missed[0] > 0.1);
}

static double dent_behind(double x) {
    return dent(x - 1);
}

/* Returns the number of steps that error control attempts. `of` is a dent in the film at the start,
 * or NULL. */
static size_t attempts_with(double (*of)(double x)) {
    const scene usual = along_path(marched_scene(20, 6, "incompressible", 0.01,
                                                 "end_time: 1, tolerance: 1.5e-3, "
                                                 "load: {law: sine, amplitude: 0.1, period: 1}"));
    marched_begin(&first, &usual);
    if (of) add_dent(&first.march.solver, &first.reference.grid, true, of);
    marched_on(&first);
    assert_int_equal(first.outcome, EHD_OK);
    marched_end(&first);
    return (size_t)(first.march.state.num_steps + first.march.state.num_rejected);
}

/* A dent downstream of the centre, with a depth of 0.5 % of the film, does not reach the centre.
 * While the load varies, error control must not count the dent as an error. */
static void what_passes_by_costs_no_steps(void **state) {
    (void)state;
    assert_int_equal(attempts_with(dent_behind), attempts_with(NULL));
}

/* Returns a ripple with a wave length of four nodes. */
static double ripple(double x) {
    return 1e-5 * cos(M_PI_2 * round(x / 0.01)) * exp(-pow((x + 0.5) / 0.12, 2));
}

/* Only the filter damps waves that the grid can hardly represent. */
static void a_ripple_is_damped(void **state) {
    static double left[603];
    (void)state;
    for (int damped = 0; damped < 2; damped++) {
        double most = 0;
        carry_dent(left, ripple, "path", damped ? NAN : 0, "end_time: 0.64, fixed_step: 0.02");
        for (size_t k = 370; k < 460; k++)
            most = fmax(most, fabs(left[k] - left[k - 2]) / 2);
        assert_true(damped ? most < 1e-8 : most > 3e-6);
    }
}

/* A load step traps a pocket of lubricant three times as thick as the film. The pocket passes the
 * centre. With time steps of 0.0025 and half of the grid step, the film of the pocket is 0.092 to
 * 0.095 for both kinds of transport. During the iteration, Newton's method passes a solution with a
 * ruptured inlet. If the iteration stayed there, the film would be 0.055. */
static void a_trapped_pocket_passes(void **state) {
    double most = 0;
    (void)state;
    scene of = along_path(marched_scene(40, 6, "dowson-higginson", 0.01,
                                        "end_time: 1.8, tolerance: 1.5e-3, "
                                        "load: {law: step, to: 1.5, at: 0.5}"));
    marched_all(&first, &of);
    for (size_t k = 0; k < first.count; k++)
        most = fmax(most, first.film[k]);
    marched_end(&first);
    check_close(most, 0.0935, 0.05, 0);
}

/* Runs a march with fixed time steps equal to the grid step. The transport is either upwind in the
 * published discretisation, or along the path without a filter. */
static void run_to_two(marched *run, bool path, double step) {
    char transient[128];
    snprintf(transient, sizeof transient,
             "end_time: 2, fixed_step: %g, load: {law: sine, amplitude: 0.1, period: 1}", step);
    scene of = marched_scene(20, 6, "dowson-higginson", step, transient);
    if (path) of = along_path(of);
    if (path) of.transient.smoothing = 0;
    strcpy(of.discretization, path ? "accurate" : "published");
    marched_all(run, &of);
}

static double film_at(const marched *run, const double *films, double time) {
    size_t k = 0;

    while (k + 1 < run->count && run->time[k] < time - 1e-9)
        k++;
    check_close(run->time[k], time, 1e-9, 1e-9);
    return films[k];
}

/* Films with transport along the path agree with upwind films in the published discretisation. The
 * upwind films have second order and are extrapolated to a time step and grid step of zero. Without
 * extrapolation they differ much more. */
static void both_ways_of_carrying_lead_to_one(void **state) {
    const double step = 0.0125;
    double off[2] = {0}, of_rows = 0;
    (void)state;
    run_to_two(&first, false, 2 * step);
    run_to_two(&second, false, step);
    run_to_two(&third, true, step);
    for (size_t i = 1; i <= 40; i++) {
        const double time = 0.05 * (double)i;
        const double coarse[] = {film_at(&first, first.film, time),
                                 film_at(&first, first.least_film, time)};
        const double fine[] = {film_at(&second, second.film, time),
                               film_at(&second, second.least_film, time)};
        const double path[] = {film_at(&third, third.film, time),
                               film_at(&third, third.least_film, time)};
        for (int film = 0; film < 2; film++)
            off[film] = fmax(off[film], fabs((4 * fine[film] - coarse[film]) / 3 / path[film] - 1));
        of_rows = fmax(of_rows, fabs(fine[0] / path[0] - 1));
    }
    assert_true(of_rows > 5e-3 && off[0] < 2e-3 && off[1] < 3e-3);
    marched_end(&first);
    marched_end(&second);
    marched_end(&third);
}

// ---- effect of the time steps on the films

/* Returns the root mean square over the second half of a run, in which the films of the start have
 * left the contact. */
static double mean_of(const double *values, size_t count) {
    double sum = 0;

    for (size_t k = count / 2; k < count; k++)
        sum += values[k] * values[k] / (double)(count - count / 2);
    return sqrt(sum);
}

/* Returns the fraction of a film's change that `effect` does not predict. The change is the
 * difference between `film`, of the run `first`, and `better`, of the run `second`. The run
 * `second` has no filter, and its time steps are a quarter as long. */
static double left_of_change(const double *film, const double *better, const double *effect) {
    static double change[MARCHED_STEPS], rest[MARCHED_STEPS];

    for (size_t k = 0, j = 0; k < first.count; k++) {
        while (j + 1 < second.count && second.time[j] < first.time[k] - 1e-9)
            j++;
        change[k] = better[j] / film[k] - 1;
        rest[k] = change[k] - effect[k];
    }
    return mean_of(rest, first.count) / mean_of(change, first.count);
}

/* Checks the estimated effects on the films with upwind transport and with transport along the
 * path, including the effect of the filter. The minimum film of a point contact hardly changes, and
 * its change is overestimated. */
static void effects_are_those_of_shorter_steps(void **state) {
    static const char history[] = "load: {law: sine, amplitude: 0.1, period: 1}";
    char of_line[128], of_point[128];
    (void)state;
    snprintf(of_line, sizeof of_line, "end_time: 4, fixed_step: 0.02, %s", history);
    snprintf(of_point, sizeof of_point, "end_time: 4, fixed_step: 0.04, %s", history);
    const scene line = marched_scene(40, 8, "dowson-higginson", 0.02, of_line);
    const scene scenes[] = {line, along_path(line), marched_point(of_point)};
    const double most[] = {0.25, 0.3, 0.6}, most_minimum[] = {0.5, 0.5, INFINITY};
    for (size_t i = check_all() ? 0 : 1; i < sizeof scenes / sizeof *scenes; i++) {
        scene coarse = scenes[i], fine = scenes[i];
        coarse.transient.smoothing = 0.1;
        fine.transient.smoothing = 0;
        fine.transient.fixed_step /= 4;
        marched_all(&first, &coarse);
        marched_all(&second, &fine);
        double left = left_of_change(first.film, second.film, first.effect);
        double left_minimum =
            left_of_change(first.least_film, second.least_film, first.effect_minimum);
        assert_true(left < most[i]);
        assert_true(left_minimum < most_minimum[i]);
        marched_end(&first);
        marched_end(&second);
    }
}

// ---- steps of any lengths

/* Returns the film after a step of the march. Accepts the step if `accepted`. */
static double film_of_step(marched *self, double time, double step, bool accepted) {
    march *run = &self->march;
    const contact_frame frame =
        march_frame(&run->settings, self->reference.kind, self->histories, time + step, 1);
    march_step outcome;
    ehd_error error = {""};

    if (run->solver.attempt(&outcome, run->solver.self, &frame, step, &error))
        fail_msg("%s", error.text);
    assert_string_equal(outcome.reason, "");
    if (accepted) run->solver.accept(run->solver.self);
    return frame_to_reference(&outcome.scalars, &frame, &self->reference).central_film_thickness;
}

/* Time steps of 1e-7, as used to locate an event, do not change the result of the next step. */
static void a_short_step_leaves_the_next_one_as_it_is(void **state) {
    (void)state;
    static const char *const transports[] = {"upwind", "path"};
    const double step = 0.01, tiny = 1e-7;
    for (size_t i = 0; i < 2; i++) {
        scene of = usual_scene("end_time: 1, load: {law: sine, amplitude: 0.1, period: 1}");
        strcpy(of.transport, transports[i]);
        marched_begin(&first, &of);
        const double at_rest = film_of_step(&first, 0, step, false);
        film_of_step(&first, 0, tiny, true);
        film_of_step(&first, tiny, tiny, true);
        check_close(film_of_step(&first, 2 * tiny, step, false), at_rest, 1e-5, 0);
        marched_end(&first);
        marched_begin(&first, &of);
        for (int k = 0; k < 4; k++)
            film_of_step(&first, k * step, step, true);
        const double without = film_of_step(&first, 4 * step, step, false);
        film_of_step(&first, 4 * step, tiny, true);
        check_close(film_of_step(&first, 4 * step + tiny, step, false), without, 1e-5, 0);
        marched_end(&first);
    }
}

// ---- errors

static void create_without_memory(const scene *of, size_t most_allocations) {
    full_settings settings = full_default_settings();
    ehd_contact reference;
    ehd_status status = EHD_MEMORY;
    assert_int_equal(scene_contact(&reference, of, NULL), EHD_OK);
    for (size_t fail_at = 0; status == EHD_MEMORY; fail_at++) {
        full_march *self = (full_march *)&self;
        allocation_fail_at(fail_at);
        status = full_march_create(&self, &reference, &settings, NAN, NULL);
        allocation_failed();
        if (status == EHD_MEMORY) assert_null(self);
        if (status == EHD_OK) assert_null(full_march_free(self));
        assert_true(fail_at < most_allocations);
    }
    assert_int_equal(status, EHD_OK);
}

static void without_memory(void **state) {
    (void)state;
    const scene line = marched_scene(20, 6, "dowson-higginson", 0.1, "end_time: 1");
    const scene point = marched_point("end_time: 1");
    const scene along = along_path(line);
    create_without_memory(&along, 250);
    create_without_memory(&line, 200);
    create_without_memory(&point, 2000);
    assert_null(full_march_free(NULL));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(constant_histories_stay_stationary),
        cmocka_unit_test(start_is_the_stationary_contact),
        cmocka_unit_test(fixed_steps_are_of_second_order),
        cmocka_unit_test(fixed_steps_of_a_point_contact),
        cmocka_unit_test(a_slow_ramp_along_the_path_ends_at_rest),
        cmocka_unit_test(the_exit_lies_within_its_node),
        cmocka_unit_test(tolerance_holds),
        cmocka_unit_test(a_short_step_leaves_the_next_one_as_it_is),
        cmocka_unit_test(local_error_is_that_before_the_exit),
        cmocka_unit_test(sine_leads_to_a_periodic_state),
        cmocka_unit_test(ramps_end_in_the_stationary_contact),
        cmocka_unit_test(approach_gives_the_load_back),
        cmocka_unit_test(start_from_a_given_approach),
        cmocka_unit_test(start_from_an_approach_far_away),
        cmocka_unit_test(approach_is_well_posed),
        cmocka_unit_test(approach_from_within_is_refused),
        cmocka_unit_test(speed_goes_down_to_zero),
        cmocka_unit_test(start_at_rest),
        cmocka_unit_test(squeeze_is_symmetric),
        cmocka_unit_test(saved_march_goes_on_with_the_same_bits),
        cmocka_unit_test(bad_saves_are_refused),
        cmocka_unit_test(attempts_can_be_repeated),
        cmocka_unit_test(a_dent_passes_unchanged),
        cmocka_unit_test(what_passes_by_costs_no_steps),
        cmocka_unit_test(a_ripple_is_damped),
        cmocka_unit_test(a_trapped_pocket_passes),
        cmocka_unit_test(both_ways_of_carrying_lead_to_one),
        cmocka_unit_test(effects_are_those_of_shorter_steps),
        cmocka_unit_test(without_memory),
    };
    return cmocka_run_group_tests_name("full_march", tests, enter_folder, leave_folder);
}
