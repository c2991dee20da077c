/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The gap behind the exit may close. Then a second zone of pressure builds up in this gap. */
#include "tests/unit/marched.h"

#include <math.h>
#include <string.h>

static marched first, second;
static ehd_error error;

/* Returns a line contact whose radius grows from 1 to `radius` along a ramp. */
static scene growing(double moes_M, double step, double x_min, double x_max, const char *speed,
                     double radius, double duration, const char *steps) {
    char transient[512];

    snprintf(transient, sizeof transient,
             "end_time: %g, %s, speed: {%s}, radius: {law: ramp, to: %g, duration: %g}", duration,
             steps, speed, radius, duration);
    scene of = marched_scene(moes_M, 3, "incompressible", step, transient);
    strcpy(of.transport, "path");
    of.grid.x_min = x_min;
    of.grid.x_max = x_max;
    return of;
}

// ---- the zone, compared with an independent quadrature

/* A gap that closes. Its height is `film` plus X^2/2, or plus the gap beside a dry contact. */
typedef struct closing {
    double lambda, growth, speed, film;
    bool dry_contact;
} closing;

static double gap_at(const closing *of, double x, double *slope) {
    const double root = sqrt(x * x - 1);

    *slope = of->dry_contact ? root : x;
    return of->film + (of->dry_contact ? (x * root - log(x + root)) / 2 : x * x / 2);
}

/* Computes the pressure at num + 1 places from `begin` to `end`, with P = dP/dX = 0 at `begin`. The
 * balance of mass, h^3 dP/dX = lambda int (U - growth X/2) dh/dX dX, is integrated by the
 * trapezoidal rule. The term with growth is the squeeze. Under constant load the gap of a line is
 * (a^2/R) g(x/a). While R grows, the height a^2/R of the gap stays constant, and its length a
 * changes. */
static void integrate(double *pressure, const closing *of, double begin, double end, size_t num) {
    const double step = (end - begin) / (double)num;
    double flow = 0, rate = 0, slope_before = 0, h_slope;

    for (size_t i = 0; i <= num; i++) {
        const double x = begin + step * (double)i, h = gap_at(of, x, &h_slope);
        const double now = (of->speed - of->growth * x / 2) * h_slope;
        if (i > 0) flow += step * (rate + now) / 2;
        rate = now;
        const double slope = of->lambda * flow / (h * h * h);
        pressure[i] = i > 0 ? pressure[i - 1] + step * (slope_before + slope) / 2 : 0;
        slope_before = slope;
    }
}

/* Finds the zone whose pressure is zero also at the end; returns where the zone begins. */
static double find_zone(double *pressure, const closing *of, double end, size_t num) {
    // the pressure at the end is positive if the zone begins at `low`, and negative if the zone
    // begins at `high`
    double low = 1.01, high = 2 * of->speed / of->growth;

    for (int i = 0; i < 60; i++) {
        const double begin = (low + high) / 2;
        integrate(pressure, of, begin, end, num);
        if (pressure[num] > 0)
            low = begin;
        else
            high = begin;
    }
    return low;
}

static double sum_of(const double *pressure, double begin, double end, size_t num) {
    double sum = 0;

    for (size_t i = 0; i <= num; i++)
        sum += pressure[i];
    return sum * (end - begin) / (double)num;
}

enum { PLACES = 200000 };
static double pressures[PLACES + 1];

/* Pressure and place of the second zone agree with the quadrature. The flow out of the end of the
 * zone equals the volume that the closing gap squeezes out. */
static void the_zone_is_that_of_a_closing_gap(void **state) {
    (void)state;
    const double duration = 0.5, growth = 0.4;
    scene of = growing(10, 0.05, -4, 12, "law: ramp, from: 0.8, to: 0.8, duration: 1",
                       1 + growth * duration, duration, "fixed_step: 0.025");
    marched_all(&first, &of);
    const contact_frame *frame;
    const full_state *last = full_march_state(first.full, &frame);
    const ehd_grid *grid = &first.reference.grid;
    ehd_contact contact;
    frame_contact(&contact, frame, &first.reference);
    const closing gap = {.lambda = contact.lambda,
                         .growth = growth / frame->radius,
                         .speed = contact.entrainment,
                         .film = first.film[first.count - 1] / frame->film_scale,
                         .dry_contact = true};
    const double end = grid_x(grid, grid->num_nodes - 1);
    const double begin = find_zone(pressures, &gap, end, PLACES);
    double most = 0, worst = 0;
    size_t zone = grid->num_nodes - 2;

    while (full_has_pressure(last, zone))
        zone--;
    assert_true(grid_x(grid, zone) > 1.5); // not part of the zone in the contact
    check_close(grid_x(grid, zone), begin, 0, 0.1);
    for (size_t k = zone; k < grid->num_nodes; k++) {
        const double place = (grid_x(grid, k) - begin) / (end - begin) * PLACES;
        const double expected = pressures[place > 0 ? (size_t)place : 0];
        most = fmax(most, expected);
        worst = fmax(worst, fabs(last->pressure[k] - expected));
    }
    assert_true(worst < 0.03 * most && most > 1e-5);

    // compare the flow out of the end, which follows from the pressure at the last node
    const size_t k = grid->num_nodes - 2;
    double slope, squeezed = 0;
    for (double x = begin + 5e-4; x < end; x += 1e-3) {
        gap_at(&gap, x, &slope);
        squeezed += 1e-3 * (gap.growth * x / 2 - gap.speed) * slope;
    }
    const double h = (last->film[k] + last->film[k + 1]) / 2;
    check_close(h * h * h * last->pressure[k] / grid->step / gap.lambda, squeezed, 0.05, 0);
    marched_end(&first);
}

// ---- marches

/* The radius grows while the contact moves slowly, also with a reversal of the motion, so the
 * second zone does not disappear again. The march must reach its end with few iterations. */
static void a_growing_radius_does_not_stop_the_march(void **state) {
    (void)state;
    for (int i = 0; i < 3; i++) {
        const char *speeds[] = {"law: ramp, from: 0.05, to: -0.05, duration: 40",
                                "law: ramp, from: 0.05, to: 0.02, duration: 40",
                                "law: ramp, from: -0.05, to: 0.05, duration: 40"};
        scene of = growing(3, 0.02, -12, 12, speeds[i], 3, 40, "tolerance: 1.5e-3");
        marched_all(&first, &of);
        assert_true(first.march.state.num_iterations < 600);
        marched_end(&first);
    }
}

/* The second zone has the same load on a fine and on a coarse grid, because it begins at the same
 * time. If the solver marked single nodes for pressure, and not runs of nodes (mark_runs in
 * full_solver.c), this time would depend on the grid. */
static void the_zone_does_not_depend_on_the_grid(void **state) {
    double load[2] = {0};
    (void)state;
    for (int i = 0; i < 2; i++) {
        scene of =
            growing(3, i ? 0.0125 : 0.05, -5, 4, "law: ramp, from: 0.05, to: 0.045, duration: 4",
                    1.2, 4, "fixed_step: 0.5");
        marched_all(&second, &of);
        const full_state *last = full_march_state(second.full, NULL);
        for (size_t k = 1; k + 1 < second.reference.grid.num_nodes; k++)
            if (grid_x(&second.reference.grid, k) > 1.5)
                load[i] += last->pressure[k] * second.reference.grid.step;
        marched_end(&second);
    }
    assert_true(load[0] > 1e-4);
    check_close(load[1], load[0], 0.05, 0);
}

// ---- the load of the zone

static void loads_are_those_of_a_parabola(void **state) {
    (void)state;
    const scene of = growing(5, 0.1, -4, 4, "law: constant", 3, 40, "fixed_step: 1");
    marched_begin(&first, &of);
    const double growth = 0.02, step = 1e-3, ends[] = {12, 30, 100};
    const contact_frame before = frame_at(&contact_line, 1, (double[]){1, 0.08, 2, 1}, NAN);
    const contact_frame now =
        frame_at(&contact_line, 1 + step, (double[]){1, 0.08, 2 * exp(growth * step), 1}, NAN);
    const contact_frame opens = frame_at(&contact_line, 2, (double[]){1, 0.08, 1.9, 1}, NAN);
    ehd_contact contact;
    frame_contact(&contact, &now, &first.reference);
    const closing gap = {contact.lambda, growth, contact.entrainment, 0, false};
    const double whole = M_PI / 2, begins = 2 * gap.speed / growth;
    const double far = 1000 * begins, begin = find_zone(pressures, &gap, far, PLACES);
    check_close(begin, begins * 2 / 3, 2e-3, 0);
    const double load = sum_of(pressures, begin, far, PLACES);

    for (int i = 0; i < 3; i++) {
        const closing_gap told = frame_closing_gap(&now, &before, &first.reference, ends[i]);
        check_close(told.begin, begins, 1e-6, 0);
        check_close(told.load * whole, load, 0.02, 0);
        const double start = find_zone(pressures, &gap, ends[i], PLACES);
        const double lacks = load - sum_of(pressures, start, ends[i], PLACES);
        assert_true(told.beyond * whole > 0.95 * lacks && told.beyond * whole < 2 * lacks);
    }
    // no zone: a gap that opens, and a gap through which the fluid moves too fast to be squeezed
    assert_true(isinf(frame_closing_gap(&opens, &before, &first.reference, 4).begin));
    assert_true(frame_closing_gap(&now, &before, &first.reference, begins / 2).beyond == 0);
    marched_end(&first);
}

static void a_zone_that_the_domain_cuts_off_is_not_to_be_trusted(void **state) {
    (void)state;
    for (int i = 0; i < 4; i++) {
        const bool backwards = i % 2, jumps = i > 1;
        const double speed = backwards ? -0.02 : 0.02;
        march_step step;
        scene of = growing(3, 0.05, backwards ? -2 : -6, backwards ? 6 : 2, "law: constant", 3, 40,
                           "fixed_step: 0.05");
        of.transient.start_speed = speed;
        marched_begin(&first, &of);
        const march_solver *solver = &first.march.solver;
        for (int k = 1; k < 3; k++) {
            const contact_frame frame =
                frame_at(&contact_line, 0.05 * k, (double[]){1, speed, 1 + 0.1 * 0.05 * k, 1}, NAN);
            assert_int_equal(solver->attempt(&step, solver->self, &frame, 0.05, &error), EHD_OK);
            // the first step after a start or a jump does not report the zone
            assert_int_equal(step.status, k > 1 && !jumps ? EHD_UNTRUSTED : EHD_OK);
            if (step.status)
                assert_non_null(strstr(step.reason, backwards ? "(grid.x_min)" : "(grid.x_max)"));
            solver->accept(solver->self);
            if (jumps) solver->restart(solver->self);
        }
        marched_end(&first);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_zone_is_that_of_a_closing_gap),
        cmocka_unit_test(a_growing_radius_does_not_stop_the_march),
        cmocka_unit_test(the_zone_does_not_depend_on_the_grid),
        cmocka_unit_test(loads_are_those_of_a_parabola),
        cmocka_unit_test(a_zone_that_the_domain_cuts_off_is_not_to_be_trusted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
