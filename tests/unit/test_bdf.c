/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Time differences, the ring of states, the moving frame and the squeeze term of the Reynolds rows. */
#include "common/physics/reynolds.h"
#include "common/time/bdf.h"
#include "common/time/frame.h"
#include "fullrun/earlier.h"
#include "tests/unit/check.h"
#include "tests/unit/sample.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Steps as an adaptive march takes them: growing, shrinking, equal. */
static const double steps[][3] = {
    {0.1, 0.1, 0.1}, {0.2, 0.1, 0.05}, {0.05, 0.1, 0.2}, {0.03, 0.3, 0.01}, {1e-6, 0.5, 0.5}};
enum { NUM_STEPS = sizeof steps / sizeof *steps };

/* Times of the state being solved and those before it; steps[i][0] is the one under way. */
static void fill_times(double *time, double now, const double *lengths) {
    time[0] = now;
    for (size_t i = 0; i < BDF_EARLIER; i++)
        time[i + 1] = time[i] - lengths[i];
}

static double power(double time, size_t exponent) {
    return exponent == 0 ? 1 : pow(time, (double)exponent);
}

// ---- formula

/* Exact for polynomials up to the order, and no further. */
static void formula_is_exact_to_its_order(void **state) {
    (void)state;
    for (size_t s = 0; s < NUM_STEPS; s++)
        for (size_t num_earlier = 1; num_earlier <= BDF_EARLIER; num_earlier++) {
            bdf_formula formula = bdf_step(steps[s][0], steps[s] + 1, num_earlier);
            double time[BDF_EARLIER + 1];
            fill_times(time, 0.7, steps[s]);
            assert_int_equal(formula.order, num_earlier > 1 ? 2 : 1);
            for (size_t n = 0; n <= formula.order + 1; n++) {
                double rate = formula.rate * power(time[0], n);
                for (size_t i = 0; i < num_earlier; i++)
                    rate += formula.weight[i] * power(time[i + 1], n);
                double exact = n == 0 ? 0 : (double)n * power(time[0], n - 1);
                if (n <= formula.order)
                    check_close(rate, exact, 1e-14, 1e-14 * formula.rate);
                else
                    assert_false(is_close(rate, exact, 1e-14, 1e-14 * formula.rate));
            }
            for (size_t i = formula.order; i < BDF_EARLIER; i++)
                check_close(formula.weight[i], 0, 0, 0);
        }
}

static void predictor_is_exact_to_its_degree(void **state) {
    (void)state;
    for (size_t s = 0; s < NUM_STEPS; s++)
        for (size_t num_earlier = 1; num_earlier <= BDF_EARLIER; num_earlier++) {
            bdf_formula formula = bdf_step(steps[s][0], steps[s] + 1, num_earlier);
            double time[BDF_EARLIER + 1];
            fill_times(time, 0.7, steps[s]);
            for (size_t n = 0; n < num_earlier; n++) {
                double value = 0, size = 1;
                for (size_t i = 0; i < num_earlier; i++) {
                    value += formula.predictor[i] * power(time[i + 1], n);
                    size += fabs(formula.predictor[i]);
                }
                check_close(value, power(time[0], n), 0, 1e-15 * size);
            }
        }
}

/* With exact earlier states the solution of dy/dT = given is off by the local error, which formula and
 * prediction give exactly for the first power that the formula gets wrong. */
static void error_is_that_of_the_next_power(void **state) {
    (void)state;
    for (size_t s = 0; s < NUM_STEPS; s++)
        for (size_t num_earlier = 2; num_earlier <= BDF_EARLIER; num_earlier++) {
            bdf_formula formula = bdf_step(steps[s][0], steps[s] + 1, num_earlier);
            // the formula of first order is what two states are judged by
            bdf_formula judged = bdf_step(steps[s][0], steps[s] + 1, num_earlier - 1);
            size_t n = num_earlier;
            double time[BDF_EARLIER + 1], given, solution, prediction = 0;
            fill_times(time, 0, steps[s]);
            given = 0; // derivative of T^n at 0
            solution = given;
            for (size_t i = 0; i < num_earlier; i++) {
                solution -= judged.weight[i] * power(time[i + 1], n);
                prediction += formula.predictor[i] * power(time[i + 1], n);
            }
            solution /= judged.rate; // the exact one is 0
            assert_true(formula.error > 0);
            check_close(formula.error * fabs(0 - prediction), fabs(solution), 1e-9, 1e-300);
        }
    check_close(bdf_step(0.1, NULL, 1).error, 0, 0, 0);
}

// ---- ring

static void ring_keeps_the_last_states(void **state) {
    (void)state;
    bdf_ring ring = bdf_ring_empty();
    double content[BDF_EARLIER + 1] = {0};

    assert_int_equal(ring.num_earlier, 0);
    for (int step = 0; step < 9; step++) {
        double time = 0.1 * step * step;
        content[ring.place[0]] = time;
        bdf_ring_accept(&ring, time);
        assert_int_equal(ring.num_earlier, step < BDF_EARLIER ? step + 1 : BDF_EARLIER);
        for (size_t i = 1; i <= ring.num_earlier; i++) {
            double before = 0.1 * (step + 1 - (int)i) * (step + 1 - (int)i);
            check_close(content[ring.place[i]], before, 0, 0);
            check_close(ring.time[ring.place[i]], before, 0, 0);
            assert_int_not_equal(ring.place[0], ring.place[i]);
        }
    }
}

static void ring_gives_the_formula_of_its_times(void **state) {
    (void)state;
    for (size_t num_earlier = 1; num_earlier <= BDF_EARLIER; num_earlier++) {
        bdf_ring ring = bdf_ring_empty();
        const double times[] = {0, 0.25, 0.375}, backwards[] = {0.125, 0.25};
        for (size_t i = 0; i < num_earlier; i++)
            bdf_ring_accept(&ring, times[i]);
        bdf_formula ours = bdf_ring_formula(&ring, 0.5);
        bdf_formula expected =
            bdf_step(0.5, num_earlier == 2 ? backwards + 1 : backwards, num_earlier);
        assert_memory_equal(&ours, &expected, sizeof ours);
    }
}

// ---- frame

static contact_frame frame_of(const contact_kind *kind, double load, double speed, double radius,
                              double modulus, double approach) {
    const double values[NUM_VARY] = {
        [VARY_LOAD] = load, [VARY_SPEED] = speed, [VARY_RADIUS] = radius, [VARY_MODULUS] = modulus};

    return frame_at(kind, 0.5, values, approach);
}

/* Factors on load, speed, radius and modulus. */
static const double factors[][4] = {{1, 1, 1, 1},     {1.5, 1, 1, 1},     {1, 0.3, 1, 1},
                                    {1, 1, 2.5, 1},   {1, 1, 1, 0.6},     {0.7, 1.4, 0.5, 1.3},
                                    {4, 0.1, 3, 1.7}, {2, 1.2, 1.5, 3.0}, {0.2, 2, 0.8, 0.9}};
enum { NUM_FACTORS = sizeof factors / sizeof *factors };

static contact_frame frame_of_case(const contact_kind *kind, size_t i) {
    return frame_of(kind, factors[i][0], factors[i][1], factors[i][2], factors[i][3], NAN);
}

static scene physical_scene(const contact_kind *kind, double load, double speed, double radius,
                            double modulus) {
    scene given = sample_scene("barus", "incompressible", 10, 5);

    snprintf(given.contact, sizeof given.contact, "%s", kind->name);
    if (kind->dimensions > 1) {
        given.grid.y_max = 2;
        given.grid.half = 1;
        given.grid.step = 0.1;
    }
    given.moes.M = given.moes.L = NAN;
    given.physical.load = (kind->dimensions > 1 ? 20 : 1e5) * load;
    given.physical.speed = 1.2 * speed;
    given.physical.radius = 0.012 * radius;
    given.physical.modulus = 2.2e11 * modulus;
    given.physical.viscosity = 0.04;
    return given;
}

static ehd_contact physical_contact(const contact_kind *kind, const double *factor) {
    scene given = physical_scene(kind, factor[0], factor[1], factor[2], factor[3]);
    ehd_contact contact;
    ehd_error error = {""};

    if (scene_contact(&contact, &given, &error)) fail_msg("%s", error.text);
    return contact;
}

static void compare_frames(const contact_kind *kind) {
    ehd_contact reference = physical_contact(kind, (double[]){1, 1, 1, 1});
    for (size_t i = 0; i < NUM_FACTORS; i++) {
        ehd_contact expected = physical_contact(kind, factors[i]), contact;
        contact_frame frame = frame_of_case(kind, i);
        frame_contact(&contact, &frame, &reference);
        check_close(contact.half_width, expected.half_width, 1e-13, 0);
        check_close(contact.radius, expected.radius, 1e-13, 0);
        check_close(contact.load, expected.load, 1e-13, 0);
        check_close(contact.hertz_pressure, expected.hertz_pressure, 1e-13, 0);
        check_close(contact.alpha_p_H, expected.alpha_p_H, 1e-13, 0);
        check_close(contact.moes_M, expected.moes_M, 1e-13, 0);
        check_close(contact.moes_L, expected.moes_L, 1e-13, 0);
        check_close(contact.lambda * contact.entrainment, expected.lambda, 1e-13, 0);
        // U = a_ref u / (a u_ref)
        check_close(contact.entrainment, reference.half_width * factors[i][1] / expected.half_width,
                    1e-13, 0);
        check_close(contact_film_scale(&contact), contact_film_scale(&expected), 1e-13, 0);
        check_close(frame.film_scale,
                    contact_film_scale(&expected) / contact_film_scale(&reference), 1e-13, 0);
    }
}

/* A frame that stands still is the stationary contact of its load, speed, radius and modulus. */
static void frame_is_the_contact_of_its_values(void **state) {
    (void)state;
    compare_frames(&contact_line);
    compare_frames(&contact_point);
}

/* At rest M has no bound and is cut; everything stays finite. */
static void frame_at_rest_is_finite(void **state) {
    (void)state;
    ehd_contact reference = physical_contact(&contact_line, (double[]){1, 1, 1, 1}), contact;
    contact_frame frame = frame_of(&contact_line, 1.2, 0, 1, 1, NAN);
    frame_contact(&contact, &frame, &reference);
    check_close(contact.entrainment, 0, 0, 0);
    check_close(contact.moes_M, 1e5, 0, 0);
    assert_true(isfinite(contact.moes_L) && contact.lambda > 0);
}

/* Film at a place of the reference frame from formulas that know no frame: half widths and Hertz pressures
 * are those of the reference, `length` is that of the kernel's logarithm. */
static double film_by_hand(double x, const double *place, const double *pressure, size_t count,
                           double step, const double *factor, double approach) {
    double film = approach + x * x / (2 * factor[2]);

    for (size_t k = 0; k < count; k++)
        film += pressure[k] * contact_line.kernel(fabs(x - place[k]), 0, step) / factor[3];
    return film;
}

/* Film, pressure, places, approach and load of a state are the same from within its frame and from the
 * reference: scales, and the constant of the kernel. */
static void scalars_of_a_frame_are_physical(void **state) {
    (void)state;
    enum { COUNT = 81 };
    ehd_contact reference = physical_contact(&contact_line, (double[]){1, 1, 1, 1});
    for (size_t i = 0; i < NUM_FACTORS; i++) {
        contact_frame frame = frame_of_case(&contact_line, i);
        double a = sqrt(factors[i][0] * factors[i][2] / factors[i][3]), step = 0.03;
        double hertz = sqrt(factors[i][0] * factors[i][3] / factors[i][2]);
        double place[COUNT], pressure[COUNT], own = -0.7, sum = 0;
        for (size_t k = 0; k < COUNT; k++) { // any pressure, in the frame
            place[k] = step * ((double)k - 30);
            pressure[k] = fmax(1 - 0.5 * place[k] * place[k] + 0.2 * sin(3 * place[k]), 0);
            sum += pressure[k] * step;
        }
        contact_scalars current = {.rigid_approach = own,
                                   .load = sum / M_PI_2,
                                   .central_pressure = pressure[30],
                                   .exit_position = 1.1};
        current.central_film_thickness =
            film_by_hand(0, place, pressure, COUNT, step, (double[]){1, 1, 1, 1}, own);
        current.minimum_film_thickness = 0.25 * current.central_film_thickness;
        contact_scalars scalars = frame_to_reference(&current, &frame, &reference);

        double physical_place[COUNT], physical_pressure[COUNT];
        for (size_t k = 0; k < COUNT; k++) {
            physical_place[k] = a * place[k];
            physical_pressure[k] = hertz * pressure[k];
        }
        double film = film_by_hand(0, physical_place, physical_pressure, COUNT, a * step,
                                   factors[i], scalars.rigid_approach);
        check_close(scalars.central_film_thickness, film, 1e-12, 1e-13);
        check_close(scalars.minimum_film_thickness, 0.25 * film, 1e-12, 1e-13);
        check_close(scalars.central_pressure, physical_pressure[30], 1e-13, 0);
        check_close(scalars.exit_position, 1.1 * a, 1e-13, 0);
        check_close(scalars.load, hertz * a * sum / M_PI_2, 1e-13, 0);
    }
}

/* The dry contact: H0 = -(1/4 + ln 2 / 2) in every frame, so that only the scale and the shift by the
 * logarithm of the half width make the approach. */
static void approach_of_dry_contacts(void **state) {
    (void)state;
    ehd_contact reference = physical_contact(&contact_line, (double[]){1, 1, 1, 1});
    for (size_t i = 0; i < 2 * NUM_FACTORS; i++) {
        const double *f = factors[i % NUM_FACTORS];
        contact_frame frame = frame_of_case(&contact_line, i % NUM_FACTORS);
        double a = sqrt(f[0] * f[2] / f[3]);
        contact_scalars dry = {.rigid_approach = -(0.25 + log(2) / 2), .load = 1};
        reference.approach_length = i < NUM_FACTORS ? 1 : 12;
        check_close(frame_to_reference(&dry, &frame, &reference).rigid_approach,
                    (-(0.25 + log(2) / 2) + 0.5 * log(a / reference.approach_length)) * a * a /
                        f[2],
                    1e-13, 1e-15);
    }
}

/* What the closure by an approach asks for is what frame_to_reference reports. */
static void approach_closure_is_the_reported_approach(void **state) {
    (void)state;
    ehd_contact reference = physical_contact(&contact_line, (double[]){1, 1, 1, 1}), contact;
    for (size_t i = 0; i < NUM_FACTORS; i++) {
        const double *f = factors[i];
        contact_frame frame = frame_of(&contact_line, f[0], f[1], f[2], f[3], -0.9);
        contact_scalars current = {.load = 1.3};
        frame_contact(&contact, &frame, &reference);
        current.rigid_approach =
            (contact.closure.value - contact.closure.by_load * current.load * M_PI_2) /
            contact.closure.by_approach;
        check_close(frame_to_reference(&current, &frame, &reference).rigid_approach, -0.9, 1e-13,
                    0);
        frame.approach = NAN;
        frame_contact(&contact, &frame, &reference);
        check_close(contact.closure.by_approach, 0, 0, 0);
        check_close(contact.closure.value / contact.closure.by_load, M_PI_2, 1e-15, 0);
    }
}

// ---- earlier states in another frame

/* An earlier state whose film and pressure are smooth functions of X, without elasticity: film without gap
 * and pressure vanish with two derivatives at the grid's ends, as a natural spline wants it. */
typedef struct carried {
    ehd_contact reference;
    earlier_carrier carrier;
    earlier_state state;
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
    assert_int_equal(earlier_carrier_init(&self->carrier, reference, NULL), EHD_OK);
    assert_int_equal(earlier_init(&self->state, reference, NULL), EHD_OK);
    self->state.frame = *frame;
    for (size_t k = 0; k < grid->num_nodes; k++) {
        double x = grid_x(grid, k), y = grid_y(grid, k);
        self->state.state.film[k] = smooth_deflection(x, y) + grid_gap(grid, k);
        self->state.state.pressure[k] = smooth_pressure(x, y);
    }
}

static void carry(carried *self, const contact_frame *now) {
    earlier_prepare(&self->state, &self->carrier);
    earlier_mass(self->mass, &self->state, now, &self->carrier);
}

static void carried_free(carried *self) {
    earlier_free(&self->state);
    earlier_carrier_free(&self->carrier);
    free(self->mass);
}

/* Whether a place lies on the grid with its boundary nodes. */
static bool is_on_grid(const ehd_grid *grid, double x, double y) {
    double last = fabs(grid_y(grid, grid->num_nodes - 1));

    return x >= grid_x(grid, 0) && x <= grid_x(grid, grid_width(grid) - 1) &&
           (grid->inner_lines == 1 || fabs(y) <= last);
}

static double density_at(const ehd_contact *contact, double pressure, double hertz) {
    return lubricant_density(&contact->lubricant, pressure * hertz);
}

/* Largest deviation of the mass at the same physical places, where they are on the grid. */
static double carry_error(const ehd_contact *reference, size_t i, size_t j) {
    const double *then_factor = factors[i], *now_factor = factors[j];
    const contact_frame then = frame_of_case(reference->kind, i),
                        now = frame_of_case(reference->kind, j);
    const double power = reference->kind->dimensions > 1 ? 1. / 3 : 0.5;
    carried self;
    carried_init(&self, reference, &then);
    const ehd_grid *grid = &reference->grid;
    carry(&self, &now);
    // physical: half widths of the reference, films a_ref^2 / R_ref
    double a_then = pow(then_factor[0] * then_factor[2] / then_factor[3], power);
    double a_now = pow(now_factor[0] * now_factor[2] / now_factor[3], power);
    double hertz = then_factor[0] / pow(a_then, reference->kind->dimensions), largest = 0;
    for (size_t r = 0; r < grid->num_inner; r++) {
        size_t k = grid_node_of_row(grid, r);
        double x = a_now * grid_x(grid, k) / a_then, y = a_now * grid_y(grid, k) / a_then;
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

/* A pure change of frame moves no lubricant: the error is that of cubic splines, of fourth order. */
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
                    // most places would lie beyond the grid of a point contact, which takes long
                    if (kind > 0 && frame_stretch(&now, &then) > 1.1) continue;
                    double coarse = carry_error(&reference[0], i, j);
                    double fine = carry_error(&reference[1], i, j);
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

/* The same frame: every node is met, and the mass is rho H to the last digits. */
static void same_frame_changes_nothing(void **state) {
    (void)state;
    const ehd_contact line = sample_contact("barus", "dowson-higginson", 20, 8, 0.05);
    const ehd_contact whole = sample_point("barus", "dowson-higginson", 20, 8, 48, false);
    const ehd_contact half = sample_point("barus", "dowson-higginson", 20, 8, 48, true);
    compare_in_the_same_frame(&line);
    compare_in_the_same_frame(&whole);
    compare_in_the_same_frame(&half);
}

/* Deflection at a place by a sum over the nodes of the whole grid. */
static double deflection_by_hand(const ehd_contact *reference, const double *pressure, double x,
                                 double y) {
    const ehd_grid *grid = &reference->grid;
    double sum = 0;

    for (size_t k = 0; k < grid->num_nodes; k++)
        for (int side = grid->half && grid_y(grid, k) > 0 ? -1 : 1; side <= 1; side += 2)
            sum +=
                pressure[k] * reference->kind->kernel(fabs(x - grid_x(grid, k)),
                                                      fabs(y - side * grid_y(grid, k)), grid->step);
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
        check_close(self.mass[r] * growth * growth, expected, 1e-12, 0);
        beyond++;
    }
    assert_true(beyond >= least_beyond);
    full_solver_free(solver);
    carried_free(&self);
}

/* Beyond the grid: the film of the pressure itself, which a wider grid has as nodes. */
static void growing_contact_looks_beyond_the_grid(void **state) {
    (void)state;
    const ehd_contact line = sample_contact("barus", "dowson-higginson", 20, 8, 0.05);
    const ehd_contact whole = sample_point("barus", "dowson-higginson", 20, 8, 32, false);
    const ehd_contact half = sample_point("barus", "dowson-higginson", 20, 8, 32, true);
    look_beyond_the_grid(&line, 30);
    look_beyond_the_grid(&whole, 400);
    look_beyond_the_grid(&half, 200);
}

// ---- squeeze

enum { NUM_NODES = 14 }; // of a small grid, boundary nodes included

/* Rows of a small grid at some pressure and film, with a squeeze term. */
static void squeezed_rows(reynolds_row *rows, const ehd_contact *contact,
                          const reynolds_squeeze *squeeze, const double *pressure,
                          const double *film) {
    double memory[4][NUM_NODES];
    bool compressible = contact->lubricant.density != NULL;
    reynolds_fluid fluid = {memory[0], memory[1], compressible ? memory[2] : NULL,
                            compressible ? memory[3] : NULL};
    reynolds_stencil stencils[NUM_NODES - 2];
    ehd_grid grid = grid_of(-1, 0.1, NUM_NODES - 2, 1, false);

    for (size_t r = 0; r < NUM_NODES - 2; r++)
        stencils[r] = reynolds_stencil_at(&grid, r + 1);
    reynolds_fluid_evaluate(&fluid, contact, pressure, NUM_NODES);
    reynolds_rows(rows, grid.step, 0.8, squeeze, stencils, NUM_NODES - 2, &fluid, pressure, film);
}

/* rate rho H + earlier, at the row's own node only. */
static void check_squeeze_derivatives(const ehd_contact *contact) {
    double pressure[NUM_NODES], film[NUM_NODES], earlier[NUM_NODES - 2];
    reynolds_row rows[NUM_NODES - 2], steady[NUM_NODES - 2], up[NUM_NODES - 2], down[NUM_NODES - 2];
    const double h = 1e-5;

    for (size_t k = 0; k < NUM_NODES; k++) {
        pressure[k] = 0.5 + 0.3 * sin(2. * (double)k);
        film[k] = 0.4 + 0.1 * cos(3. * (double)k);
    }
    for (size_t r = 0; r < NUM_NODES - 2; r++)
        earlier[r] = sin(5. * (double)r);
    const reynolds_squeeze squeeze = {37, earlier};
    squeezed_rows(rows, contact, &squeeze, pressure, film);
    squeezed_rows(steady, contact, NULL, pressure, film);
    for (size_t r = 0; r < NUM_NODES - 2; r++) {
        double mass = film[r + 1] * density_at(contact, pressure[r + 1], contact->hertz_pressure);
        check_close(rows[r].residual, steady[r].residual - 37 * mass - earlier[r], 1e-12,
                    1e-12 * fabs(steady[r].residual));
    }
    for (size_t k = 1; k + 1 < NUM_NODES; k++)
        for (int of_film = 0; of_film < 2; of_film++) {
            double *value = of_film ? &film[k] : &pressure[k], kept = *value;
            const reynolds_row *row = &rows[k - 1];
            *value = kept + h;
            squeezed_rows(up, contact, &squeeze, pressure, film);
            *value = kept - h;
            squeezed_rows(down, contact, &squeeze, pressure, film);
            *value = kept;
            double slope = (up[k - 1].residual - down[k - 1].residual) / (2 * h);
            check_close(of_film ? row->by_film[NODE_HERE] : row->by_pressure[NODE_HERE], slope,
                        1e-6, 1e-7);
            // the neighbours' rows know nothing of it
            for (int a = 0; a < NUM_STENCIL; a++)
                if (a != NODE_HERE) {
                    check_close(row->by_film[a], steady[k - 1].by_film[a], 0, 0);
                    check_close(row->by_pressure[a], steady[k - 1].by_pressure[a], 0, 0);
                }
        }
}

static void squeeze_derivatives(void **state) {
    (void)state;
    ehd_contact compressible = sample_contact("roelands", "dowson-higginson", 5, 6, 0.1);
    ehd_contact incompressible = sample_contact("barus", "incompressible", 5, 3, 0.1);
    check_squeeze_derivatives(&compressible);
    check_squeeze_derivatives(&incompressible);
}

// ---- a manufactured solution in time

/* Load, speed, radius and modulus at a time, all varying. */
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

/* Physical film and pressure, in units of the reference. */
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

/* First derivative from five values around, a distance h apart. */
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

/* The Reynolds equation in the physical frame, apart from any moving one. */
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

/* The earlier masses' sum by the formula, in frame `now`. */
static void add_earlier(double *sum, carried *self, const bdf_formula *formula,
                        const contact_frame *now, const double *time, size_t num_earlier) {
    size_t num_inner = self->reference.grid.num_inner;

    memset(sum, 0, num_inner * sizeof *sum);
    for (size_t i = 0; i < num_earlier; i++) {
        set_wanted(self, time[i + 1]);
        carry(self, now);
        for (size_t r = 0; r < num_inner; r++)
            sum[r] += formula->weight[i] * self->mass[r];
    }
}

/* Away from the ends, where splines are natural and the first row's entrainment is of first order. */
static bool is_inside(double x) {
    return x > -2.5 && x < 1;
}

typedef struct manufactured_error {
    double rate;     // of d(rho h)/dT alone
    double residual; // of the whole equation
} manufactured_error;

/* Largest errors at one time, in the physical frame. */
static manufactured_error manufactured(double grid_step, const double *lengths,
                                       size_t num_earlier) {
    contact_frame now = wanted_frame(1.3);
    double time[BDF_EARLIER + 1];
    bdf_formula formula = bdf_step(lengths[0], lengths + 1, num_earlier);
    manufactured_error error = {0};
    ehd_contact contact;
    carried self;

    fill_times(time, now.time, lengths);
    ehd_contact reference = sample_contact("barus", "dowson-higginson", 20, 8, grid_step);
    contact_set_moes(&reference, 5, 2);
    carried_init(&self, &reference, &now);
    frame_contact(&contact, &now, &self.reference);
    size_t num_inner = contact.grid.num_inner, num_nodes = contact.grid.num_nodes;
    double *sum = calloc(num_inner, sizeof *sum), *memory = calloc(4 * num_nodes, sizeof *memory);
    reynolds_stencil *stencils = calloc(num_inner, sizeof *stencils);
    reynolds_row *rows = calloc(num_inner, sizeof *rows);
    assert_true(sum && memory && stencils && rows);

    add_earlier(sum, &self, &formula, &now, time, num_earlier);
    set_wanted(&self, now.time);
    reynolds_fluid fluid = {memory, memory + num_nodes, memory + 2 * num_nodes,
                            memory + 3 * num_nodes};
    const reynolds_squeeze squeeze = {formula.rate, sum};
    for (size_t r = 0; r < num_inner; r++)
        stencils[r] = reynolds_stencil_at(&contact.grid, r + 1);
    reynolds_fluid_evaluate(&fluid, &contact, self.state.state.pressure, num_nodes);
    reynolds_rows(rows, grid_step, contact.entrainment, &squeeze, stencils, num_inner, &fluid,
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
    for (size_t i = 0; i < BDF_EARLIER; i++)
        scaled[i] = factor * lengths[i];
}

/* The rate of change at fixed physical places while load, speed, radius and modulus change: of second
 * order in the step, variable or not, and of first order from one earlier state. */
static void rate_is_of_second_order(void **state) {
    (void)state;
    static const double lengths[][3] = {{0.1, 0.1, 0.1}, {0.1, 0.05, 0.1}, {0.05, 0.1, 0.2}};
    for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++)
        for (size_t order = 1; order <= 2; order++) {
            double halved[BDF_EARLIER], quartered[BDF_EARLIER];
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

/* The whole equation, grid and step refined together. */
static void equation_is_of_second_order(void **state) {
    (void)state;
    static const double lengths[] = {0.1, 0.07, 0.1};
    double error[3];
    for (int i = 0; i < 3; i++) {
        double scaled[BDF_EARLIER], factor = ldexp(1, -i);
        scale_steps(scaled, lengths, factor);
        error[i] = manufactured(0.05 * factor, scaled, 2).residual;
    }
    assert_true(error[2] < 0.1);
    check_close(log2(error[0] / error[1]), 2, 0, 0.2);
    check_close(log2(error[1] / error[2]), 2, 0, 0.1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(formula_is_exact_to_its_order),
        cmocka_unit_test(predictor_is_exact_to_its_degree),
        cmocka_unit_test(error_is_that_of_the_next_power),
        cmocka_unit_test(ring_keeps_the_last_states),
        cmocka_unit_test(ring_gives_the_formula_of_its_times),
        cmocka_unit_test(frame_is_the_contact_of_its_values),
        cmocka_unit_test(frame_at_rest_is_finite),
        cmocka_unit_test(scalars_of_a_frame_are_physical),
        cmocka_unit_test(approach_of_dry_contacts),
        cmocka_unit_test(approach_closure_is_the_reported_approach),
        cmocka_unit_test(change_of_frame_keeps_the_physical_film),
        cmocka_unit_test(same_frame_changes_nothing),
        cmocka_unit_test(growing_contact_looks_beyond_the_grid),
        cmocka_unit_test(squeeze_derivatives),
        cmocka_unit_test(rate_is_of_second_order),
        cmocka_unit_test(equation_is_of_second_order),
    };
    return cmocka_run_group_tests_name("bdf", tests, NULL, NULL);
}
