/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Previous states in the current frame, and the transient Reynolds equation that uses them. */
#include "common/physics/deflection.h"
#include "common/physics/reynolds.h"
#include "common/time/bdf.h"
#include "fullrun/previous.h"
#include "tests/unit/check.h"
#include "tests/unit/frames.h"
#include "tests/unit/sample.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A previous state with smooth film and pressure; the film is not the deflection of this pressure.
 * At the ends of the grid the second derivatives of the pressure and of the film minus the gap
 * vanish, as natural splines require. */
typedef struct carried {
    ehd_contact reference;
    previous_carrier carrier;
    previous_state state;
    double *mass;
} carried;

static double smooth_deflection(double x, double y) {
    return 0.3 + 0.5 * exp(-4 * ((x + 0.8) * (x + 0.8) + y * y));
}

static double smooth_pressure(double x, double y) {
    double bulge = 1 - (x + 0.8) * (x + 0.8) - y * y;
    return bulge > 0 ? bulge * bulge * bulge * bulge * bulge : 0;
}

static void carried_init(carried *self, const ehd_contact *reference, const contact_frame *frame) {
    const ehd_grid *grid = &reference->grid;
    self->reference = *reference;
    self->mass = calloc(grid->num_inner, sizeof(double));
    assert_non_null(self->mass);
    assert_int_equal(previous_carrier_init(&self->carrier, reference, NULL), EHD_OK);
    assert_int_equal(previous_init(&self->state, reference, NULL), EHD_OK);
    self->state.frame = *frame;
    for (size_t k = 0; k < grid->num_nodes; k++) {
        double x = grid_x(grid, k), y = grid_y(grid, k);
        self->state.state.film[k] = smooth_deflection(x, y) + grid_gap(grid, k);
        self->state.state.pressure[k] = smooth_pressure(x, y);
    }
}

static void carry(carried *self, const contact_frame *now) {
    previous_prepare(&self->state, 1, &self->carrier);
    previous_mass(self->mass, &self->state, now, &self->carrier);
}

static void carried_free(carried *self) {
    previous_free(&self->state);
    previous_carrier_free(&self->carrier);
    free(self->mass);
}

/* Checks whether a place lies on the grid or its boundary nodes. */
static bool is_on_grid(const ehd_grid *grid, double x, double y) {
    double last = fabs(grid_y(grid, grid->num_nodes - 1));

    return x >= grid_x(grid, 0) && x <= grid_x(grid, grid_width(grid) - 1) &&
           (grid->inner_lines == 1 || fabs(y) <= last);
}

static double density_at(const ehd_contact *contact, double pressure, double hertz) {
    return lubricant_density(&contact->lubricant, pressure * hertz);
}

/* Returns the largest error of the mass rho H that is carried from a previous state into the
 * current frame. `i` and `j` are the cases of the two frames. The exact mass is the mass at the
 * previous place of the fluid, at the distance `path` upstream. Places outside of the grid are left
 * out. */
static double carry_error(const ehd_contact *reference, size_t i, size_t j, double path) {
    const double *then_factor = factors[i], *now_factor = factors[j];
    const contact_frame then = frame_of_case(reference->kind, i);
    contact_frame now = frame_of_case(reference->kind, j);
    const double power = reference->kind->dimensions > 1 ? 1. / 3 : 0.5;
    carried self;
    carried_init(&self, reference, &then);
    const ehd_grid *grid = &reference->grid;
    now.path = then.path + path;
    carry(&self, &now);
    // physical quantities in units of the reference: half width, and a_ref^2 / R_ref for films
    double a_then = pow(then_factor[0] * then_factor[2] / then_factor[3], power);
    double a_now = pow(now_factor[0] * now_factor[2] / now_factor[3], power);
    double hertz = then_factor[0] / pow(a_then, reference->kind->dimensions), largest = 0;
    for (size_t r = 0; r < grid->num_inner; r++) {
        size_t k = grid_node_of_row(grid, r);
        double x = (a_now * grid_x(grid, k) - path) / a_then, y = a_now * grid_y(grid, k) / a_then;
        if (!is_on_grid(grid, x, y)) continue;
        double film =
            (smooth_deflection(x, y) + (x * x + y * y) / 2) * a_then * a_then / then_factor[2];
        double expected =
            film * density_at(reference, smooth_pressure(x, y), hertz * reference->hertz_pressure);
        double actual = self.mass[r] * a_now * a_now / now_factor[2];
        largest = fmax(largest, fabs(actual - expected));
    }
    carried_free(&self);
    return largest;
}

/* A change of the frame alone moves no lubricant. The only error is the error of cubic splines,
 * which has fourth order. */
static void change_of_frame_keeps_the_physical_film(void **state) {
    (void)state;
    static const char *const densities[] = {"incompressible", "dowson-higginson"};
    for (size_t kind = 0; kind < 3; kind++)
        for (int d = 0; d < 2; d++) {
            const ehd_contact line[] = {sample_contact("barus", densities[d], 20, 8, 0.04),
                                        sample_contact("barus", densities[d], 20, 8, 0.02)};
            const ehd_contact point[] = {
                sample_point("barus", densities[d], 20, 8, 80, kind == 2),
                sample_point("barus", densities[d], 20, 8, 160, kind == 2)};
            const ehd_contact *reference = kind == 0 ? line : point;
            for (size_t i = 0; i < NUM_FACTORS; i++)
                for (size_t j = kind; j < NUM_FACTORS; j += 1 + 2 * kind) {
                    const contact_frame then = frame_of_case(reference->kind, i),
                                        now = frame_of_case(reference->kind, j);
                    // if the frame of a point contact grows much, most places lie outside of the
                    // grid, and the test would take long
                    if (kind > 0 && frame_stretch(&now, &then) > 1.1) continue;
                    double coarse = carry_error(&reference[0], i, j, 0);
                    double fine = carry_error(&reference[1], i, j, 0);
                    double scale = factors[i][0] / factors[i][3]; // a^2/R of a line
                    if (kind > 0) scale = pow(scale, 2. / 3) * pow(factors[i][2], -1. / 3);
                    assert_true(coarse <= (kind > 0 ? 3e-5 : 3e-6) * scale &&
                                fine <= fmax(coarse / 8, 1e-13 * scale));
                }
        }
}

static void compare_in_the_same_frame(const ehd_contact *reference) {
    contact_frame frame = frame_of(reference->kind, 1.4, 1, 0.8, 1.2, NAN);
    const ehd_grid *grid = &reference->grid;
    carried self;
    carried_init(&self, reference, &frame);
    carry(&self, &frame);
    for (size_t r = 0; r < grid->num_inner; r++) {
        const full_state *film = &self.state.state;
        size_t k = grid_node_of_row(grid, r);
        double hertz = frame.hertz_pressure * reference->hertz_pressure;
        check_close(self.mass[r], film->film[k] * density_at(reference, film->pressure[k], hertz),
                    1e-14, 0);
    }
    carried_free(&self);
}

/* If the frame does not change, previous places are nodes, and the mass is rho H to round-off. */
static void same_frame_changes_nothing(void **state) {
    (void)state;
    const ehd_contact line = sample_contact("barus", "dowson-higginson", 20, 8, 0.05);
    const ehd_contact whole = sample_point("barus", "dowson-higginson", 20, 8, 48, false);
    const ehd_contact half = sample_point("barus", "dowson-higginson", 20, 8, 48, true);
    compare_in_the_same_frame(&line);
    compare_in_the_same_frame(&whole);
    compare_in_the_same_frame(&half);
}

/* With transport along the path, a previous film moves with the fluid like a rigid plug, in either
 * direction. In general it has the error of cubic splines. If it moves by a whole number of grid
 * steps, it has only round-off. */
static void a_rigid_plug_is_shifted(void **state) {
    (void)state;
    const double paths[] = {0.37, -0.73};
    for (size_t kind = 0; kind < 3; kind++) {
        ehd_contact reference[2];
        for (int fine = 0; fine < 2; fine++) {
            reference[fine] =
                kind == 0
                    ? sample_contact("barus", "dowson-higginson", 20, 8, fine ? 0.02 : 0.04)
                    : sample_point("barus", "dowson-higginson", 20, 8, fine ? 160 : 80, kind == 2);
            reference[fine].transport = TRANSPORT_PATH;
            reference[fine].smoothing = 0;
        }
        for (int way = 0; way < 2; way++) {
            const double coarse = carry_error(&reference[0], 0, 0, paths[way]);
            const double fine = carry_error(&reference[1], 0, 0, paths[way]);
            assert_true(coarse > 1e-9 && coarse < (kind > 0 ? 3e-5 : 3e-6));
            assert_true(fine < coarse / 6); // error of cubic splines
        }
        // the frame changes too
        assert_true(carry_error(&reference[1], 0, 1, paths[0]) < 1e-5);
        const double step = reference[0].grid.step;
        assert_true(carry_error(&reference[0], 0, 0, 17 * step) < 1e-14);
        assert_true(carry_error(&reference[0], 0, 0, -8 * step) < 1e-14);
    }
}

/* Returns the deflection at a place as a direct sum over the nodes of the whole grid. */
static double deflection_by_hand(const ehd_contact *reference, const double *pressure, double x,
                                 double y) {
    const ehd_grid *grid = &reference->grid;
    double sum = 0;

    for (size_t k = 0; k < grid->num_nodes; k++)
        for (int side = grid->half && grid_y(grid, k) > 0 ? -1 : 1; side <= 1; side += 2)
            sum +=
                pressure[k] * deflection_influence(reference->kind, grid, fabs(x - grid_x(grid, k)),
                                                   fabs(y - side * grid_y(grid, k)));
    return sum;
}

static void look_beyond_the_grid(const ehd_contact *reference, size_t least_beyond) {
    const contact_kind *kind = reference->kind;
    const double growth = 1.5, load = kind->dimensions > 1 ? 3.375 : 2.25;
    contact_frame then = frame_of(kind, 1, 1, 1, 1, NAN), now = frame_of(kind, load, 1, 1, 1, NAN);
    const ehd_grid *grid = &reference->grid;
    full_settings settings = full_default_settings();
    full_solver *solver;
    carried self;
    carried_init(&self, reference, &then);
    full_state *film = &self.state.state;

    // make the pressure small at the ends of the grid, as in a contact
    for (size_t k = 0; k < grid->num_nodes; k++)
        film->pressure[k] *= exp(-2 * (pow(grid_x(grid, k), 2) + pow(grid_y(grid, k), 2)));
    film->rigid_approach = 0.4;
    film->exit = grid->num_nodes - 1;
    assert_int_equal(full_solver_create(&solver, kind, grid, &settings, NULL), EHD_OK);
    full_film(film, solver);
    carry(&self, &now);
    size_t beyond = 0;
    for (size_t r = 0; r < grid->num_inner; r++) {
        size_t k = grid_node_of_row(grid, r);
        double x = growth * grid_x(grid, k), y = growth * grid_y(grid, k);
        if (is_on_grid(grid, x, y)) continue;
        double expected =
            0.4 + (x * x + y * y) / 2 + deflection_by_hand(reference, film->pressure, x, y);
        check_close(self.mass[r] * growth * growth, expected, 1e-8, 0);
        beyond++;
    }
    assert_true(beyond >= least_beyond);
    full_solver_free(solver);
    carried_free(&self);
}

/* If the contact grows, some places lie outside of the previous grid. There the film is computed
 * from the pressure, as at the nodes of a wider grid. */
static void growing_contact_looks_beyond_the_grid(void **state) {
    (void)state;
    const ehd_contact line = sample_contact("barus", "dowson-higginson", 20, 8, 0.05);
    const ehd_contact whole = sample_point("barus", "dowson-higginson", 20, 8, 32, false);
    const ehd_contact half = sample_point("barus", "dowson-higginson", 20, 8, 32, true);
    look_beyond_the_grid(&line, 30);
    look_beyond_the_grid(&whole, 400);
    look_beyond_the_grid(&half, 200);
}

// ---- a manufactured solution in time

/* Computes the factors of load, speed, radius and modulus, which all vary with time. */
static void wanted_factors(double *factor, double time) {
    factor[0] = 1 + 0.2 * sin(1.1 * time);
    factor[1] = 1 + 0.3 * cos(0.7 * time);
    factor[2] = 1 - 0.1 * sin(0.9 * time);
    factor[3] = 1 + 0.1 * sin(0.4 * time);
}

static contact_frame wanted_frame(double time) {
    double factor[4];
    wanted_factors(factor, time);
    contact_frame frame = frame_of(&contact_line, factor[0], factor[1], factor[2], factor[3], NAN);
    frame.time = time;
    return frame;
}

/* Return physical film and pressure, in units of the reference. */
static double wanted_film(double x, double time) {
    return 0.7 + 0.15 * sin(1.3 * x + 0.7 * time) + 0.1 * sin(time);
}

static double wanted_pressure(double x, double time) {
    return 0.3 + 0.2 * sin(0.9 * x - 0.5 * time);
}

static double wanted_mass(const ehd_contact *reference, double x, double time) {
    return wanted_film(x, time) *
           density_at(reference, wanted_pressure(x, time), reference->hertz_pressure);
}

/* Returns the first derivative from five values at equal distances h. */
static double slope_of(const double *value, double h) {
    return (8 * (value[3] - value[1]) - (value[4] - value[0])) / (12 * h);
}

static double mass_rate(const ehd_contact *reference, double x, double time) {
    const double h = 1e-3;
    double value[5];
    for (int i = 0; i < 5; i++)
        value[i] = wanted_mass(reference, x, time + h * (i - 2));
    return slope_of(value, h);
}

static double wanted_flow(const ehd_contact *reference, double x, double time) {
    const double h = 1e-3;
    double value[5], film = wanted_film(x, time), ignored;
    for (int i = 0; i < 5; i++)
        value[i] = wanted_pressure(x + h * (i - 2), time);
    double log_viscosity = reference->lubricant.viscosity->evaluate(
        &reference->lubricant, value[2] * reference->hertz_pressure, &ignored);
    return wanted_mass(reference, x, time) * film * film * exp(-log_viscosity) / reference->lambda *
           slope_of(value, h);
}

/* Returns the residual of the Reynolds equation at a fixed physical place, independently of the
 * moving frames. */
static double physical_residual(const ehd_contact *reference, double x, double time) {
    const double h = 1e-3;
    double flow[5], mass[5], factor[4];
    wanted_factors(factor, time);
    for (int i = 0; i < 5; i++) {
        flow[i] = wanted_flow(reference, x + h * (i - 2), time);
        mass[i] = wanted_mass(reference, x + h * (i - 2), time);
    }
    return slope_of(flow, h) - factor[1] * slope_of(mass, h) - mass_rate(reference, x, time);
}

static void set_wanted(carried *self, double time) {
    contact_frame frame = wanted_frame(time);
    self->state.frame = frame;
    for (size_t k = 0; k < self->reference.grid.num_nodes; k++) {
        double x = grid_x(&self->reference.grid, k) * frame.half_width;
        self->state.state.film[k] = wanted_film(x, time) / frame.film_scale;
        self->state.state.pressure[k] = wanted_pressure(x, time) / frame.hertz_pressure;
    }
}

/* Computes the sum of the masses rho H of the previous states, with the weights of the formula, in
 * the frame `now`. */
static void add_previous(double *sum, carried *self, const bdf_formula *formula,
                         const contact_frame *now, const double *time, size_t num_previous) {
    size_t num_inner = self->reference.grid.num_inner;

    memset(sum, 0, num_inner * sizeof *sum);
    for (size_t i = 0; i < num_previous; i++) {
        set_wanted(self, time[i + 1]);
        carry(self, now);
        for (size_t r = 0; r < num_inner; r++)
            sum[r] += formula->weight[i] * self->mass[r];
    }
}

/* Checks whether x is away from the ends. At the ends the splines are natural, and the entrainment
 * of the first row has only first order. */
static bool is_inside(double x) {
    return x > -2.5 && x < 1;
}

typedef struct manufactured_error {
    double rate;     // error of d(rho h)/dT
    double residual; // error of the whole equation
} manufactured_error;

/* Returns the largest errors at one time, in the physical frame. */
static manufactured_error manufactured(double grid_step, const double *lengths,
                                       size_t num_previous) {
    contact_frame now = wanted_frame(1.3);
    double time[BDF_PREVIOUS + 1];
    bdf_formula formula = bdf_step(lengths[0], lengths + 1, num_previous);
    manufactured_error error = {0};
    ehd_contact contact;
    carried self;

    fill_times(time, now.time, lengths);
    ehd_contact reference = sample_contact("barus", "dowson-higginson", 20, 8, grid_step);
    contact_set_moes(&reference, 5, 2);
    carried_init(&self, &reference, &now);
    frame_contact(&contact, &now, &self.reference);
    size_t num_inner = contact.grid.num_inner, num_nodes = contact.grid.num_nodes;
    double *sum = calloc(num_inner, sizeof *sum),
           *memory = calloc(NUM_FLUID_ARRAYS * num_nodes, sizeof *memory);
    reynolds_stencil *stencils = calloc(num_inner, sizeof *stencils);
    reynolds_row *rows = calloc(num_inner, sizeof *rows);
    assert_true(sum && memory && stencils && rows);

    add_previous(sum, &self, &formula, &now, time, num_previous);
    set_wanted(&self, now.time);
    reynolds_fluid fluid = reynolds_fluid_in(memory, num_nodes, &contact);
    const reynolds_squeeze squeeze = {formula.rate, sum};
    for (size_t r = 0; r < num_inner; r++)
        stencils[r] = reynolds_stencil_at(&contact.grid, r + 1);
    reynolds_fluid_evaluate(&fluid, &contact, self.state.state.pressure, num_nodes);
    reynolds_rows(rows, &contact.grid, contact.entrainment, &squeeze, stencils, num_inner, &fluid,
                  self.state.state.pressure, self.state.state.film);
    for (size_t r = 0; r < num_inner; r++) {
        double x = now.half_width * grid_x(&reference.grid, r + 1);
        double mass = fluid.density[r + 1] * self.state.state.film[r + 1];
        if (!is_inside(grid_x(&reference.grid, r + 1))) continue;
        error.rate = fmax(error.rate, fabs(now.film_scale * (formula.rate * mass + sum[r]) -
                                           mass_rate(&self.reference, x, now.time)));
        error.residual =
            fmax(error.residual, fabs(now.film_scale * rows[r].residual -
                                      physical_residual(&self.reference, x, now.time)));
    }
    free(sum);
    free(memory);
    free(stencils);
    free(rows);
    carried_free(&self);
    return error;
}

static void scale_steps(double *scaled, const double *lengths, double factor) {
    for (size_t i = 0; i < BDF_PREVIOUS; i++)
        scaled[i] = factor * lengths[i];
}

/* While load, speed, radius and modulus change, the error of the rate d(rho h)/dT at fixed physical
 * places has second order in the time step, for equal and variable steps. With one previous state
 * it has first order. */
static void rate_is_of_second_order(void **state) {
    (void)state;
    static const double lengths[][3] = {{0.1, 0.1, 0.1}, {0.1, 0.05, 0.1}, {0.05, 0.1, 0.2}};
    for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++)
        for (size_t order = 1; order <= 2; order++) {
            double halved[BDF_PREVIOUS], quartered[BDF_PREVIOUS];
            scale_steps(halved, lengths[i], 0.5);
            scale_steps(quartered, lengths[i], 0.25);
            double coarse = manufactured(0.02, lengths[i], order).rate;
            double middle = manufactured(0.02, halved, order).rate;
            double fine = manufactured(0.02, quartered, order).rate;
            assert_true(coarse < 0.1);
            check_close(log2(coarse / middle), (double)order, 0, 0.15);
            check_close(log2(middle / fine), (double)order, 0, 0.1);
        }
}

/* The error of the whole equation has second order if grid step and time step are refined
 * together. */
static void equation_is_of_second_order(void **state) {
    (void)state;
    static const double lengths[] = {0.1, 0.07, 0.1};
    double error[3];
    for (int i = 0; i < 3; i++) {
        double scaled[BDF_PREVIOUS], factor = ldexp(1, -i);
        scale_steps(scaled, lengths, factor);
        error[i] = manufactured(0.05 * factor, scaled, 2).residual;
    }
    assert_true(error[2] < 0.1);
    check_close(log2(error[0] / error[1]), 2, 0, 0.2);
    check_close(log2(error[1] / error[2]), 2, 0, 0.1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(change_of_frame_keeps_the_physical_film),
        cmocka_unit_test(same_frame_changes_nothing),
        cmocka_unit_test(a_rigid_plug_is_shifted),
        cmocka_unit_test(growing_contact_looks_beyond_the_grid),
        cmocka_unit_test(rate_is_of_second_order),
        cmocka_unit_test(equation_is_of_second_order),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
