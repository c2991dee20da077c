/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compares films of previous time steps, in the current frame, between the reduced and the full
 * model. The films of the full model are computed with previous_mass (line contacts), or with
 * splines of GSL and direct sums (point contacts). */
#include "common/physics/deflection.h"
#include "fullrun/previous.h"
#include "romrun/state/film_splines.h"
#include "tests/unit/check.h"
#include "tests/unit/reduced_problem.h"

#include <gsl/gsl_spline.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// index of a training state whose exit differs from the exit at which the splines of the modes are
// cut off
enum { STATE = 7 };

static trained training;
static ehd_error error;

#define check_ok(call)                                                                             \
    if (call) fail_msg("%s", error.text)

/* Fills the state of the full model that equals the reduced state. The modes give the pressure up
 * to the exit. The film is computed from its definition. */
static void fill_full(previous_state *full, previous_carrier *carrier, const previous_film *reduced,
                      const reduced_basis *basis, const ehd_contact *reference) {
    const ehd_grid *grid = &basis->grid;
    const double *z = reduced->state.coordinates;
    size_t num_pressure = basis->num_pressure;
    const double *nodes = carrier->nodes;

    check_ok(previous_init(full, reference, &error));
    full->frame = reduced->frame;
    full->state.exit = reduced->state.exit;
    full->state.rigid_approach = z[num_pressure + basis->num_deformation];
    for (size_t k = 0; k < grid->num_nodes; k++) {
        full->state.pressure[k] = 0;
        for (size_t j = 0; j < num_pressure && k < reduced->state.exit; j++)
            full->state.pressure[k] += basis->pressure[k * num_pressure + j] * z[j];
    }
    for (size_t k = 0; k < grid->num_nodes; k++) {
        double *film = &full->state.film[k];
        *film = full->state.rigid_approach + contact_gap(&grid->shape, nodes[k], 0);
        for (size_t i = 0; i < grid->num_nodes && !basis->deformation_modes; i++)
            *film += full->state.pressure[i] *
                     deflection_influence(basis->kind, grid, fabs(nodes[k] - nodes[i]), 0);
        for (size_t j = 0; j < basis->num_deformation; j++)
            // NOLINTNEXTLINE(clang-analyzer-core.NullDereference): num_deformation is 0 if NULL
            *film += basis->deformation_modes[k * basis->num_deformation + j] * z[num_pressure + j];
    }
    previous_prepare(full, 1, carrier);
}

static contact_frame frame_under(double load, double radius, double time) {
    return frame_at(&contact_line, time, (double[]){load, 1, radius, 1}, NAN);
}

/* Compares the films of both models at all nodes of the frame `now` whose places in the earlier
 * frame lie at X = `from` or farther downstream. */
static void compare(const reduced_basis *basis, const ehd_contact *reference,
                    const contact_frame *now, double from, double tolerance) {
    const ehd_grid *grid = &basis->grid;
    const contact_frame then = frame_under(1, 1, 0);
    double *expected = malloc(grid->num_inner * sizeof *expected);
    reduced_model model;
    film_splines splines;
    film_carrier of_reduced;
    previous_film film;
    previous_carrier carrier;
    previous_state full;

    assert_non_null(expected);
    check_ok(previous_carrier_init(&carrier, reference, &error));
    check_ok(reduced_model_build(&model, basis, NULL, 0, &error));
    check_ok(
        film_splines_build(&splines, &model, basis->pressure, basis->deformation_modes, &error));
    check_ok(film_carrier_init(&of_reduced, &model, &splines, reference, &error));
    check_ok(previous_film_init(&film, &of_reduced, &error));
    film.frame = then;
    film.state.exit = basis->states.exit[STATE];
    memcpy(film.state.coordinates, basis->states.coordinates + STATE * model.num_unknowns,
           model.num_unknowns * sizeof(double));
    previous_film_prepare(&film);
    fill_full(&full, &carrier, &film, basis, reference);
    previous_mass(expected, &full, now, &carrier);
    for (size_t k = 1; k <= grid->num_inner; k++) {
        double place = frame_stretch(now, &then) * grid_x(grid, k);
        if (place < from) continue;
        if (place > 2) break; // the downstream end of the grid, behind every exit
        const double mass = previous_film_mass(&film, k, now);
        check_close(mass, expected[k - 1], tolerance, 0);
        // the sums that the first evaluation has stored give the same mass
        check_close(previous_film_mass(&film, k, now), mass, 1e-13, 0);
    }
    previous_film_free(&film);
    film_carrier_free(&of_reduced);
    previous_free(&full);
    previous_carrier_free(&carrier);
    film_splines_free(&splines);
    reduced_model_free(&model);
    free(expected);
}

static void films_equal_those_of_the_full_model(void **unused) {
    (void)unused;
    for (int kind = DEFORMATION_INDEPENDENT; kind <= DEFORMATION_COUPLED; kind++) {
        reduced_basis basis;
        trained_basis(&basis, &training, kind, 0, 0);
        ehd_contact reference = training.contacts[STATE];
        for (int law = 0; law < 2; law++) {
            const contact_frame frames[] = {frame_under(1, 1, 1), frame_under(0.94, 1, 1),
                                            frame_under(1.02, 1.01, 1)};
            for (size_t i = 0; i < sizeof frames / sizeof *frames; i++)
                compare(&basis, &reference, &frames[i], basis.grid.x_min, 2e-5);
            reference.lubricant.density = NULL;
        }
        reduced_basis_free(&basis);
    }
}

/* In a wider frame the grid starts farther upstream. There the film needs the deflection upstream
 * of the earlier grid, both where the deflection is stored and farther upstream. */
static void films_go_on_before_the_grid(void **unused) {
    (void)unused;
    reduced_basis basis;
    trained_basis(&basis, &training, DEFORMATION_COUPLED, 0, 0);
    for (double load = 1.05; load < 3; load *= 1.3) {
        contact_frame now = frame_under(load, 1, 1);
        compare(&basis, &training.contacts[STATE], &now, -1e9, load < 2.2 ? 2e-5 : 5e-4);
    }
    reduced_basis_free(&basis);
}

static void coarse_grids_have_splines_too(void **unused) {
    (void)unused;
    trained coarse;
    reduced_basis basis;
    contact_frame now = frame_under(0.97, 1, 1);

    trained_init(&coarse, 0.125); // 51 nodes
    trained_basis(&basis, &coarse, DEFORMATION_COUPLED, 0, 0);
    assert_true(basis.grid.num_nodes < EXIT_WINDOW);
    compare(&basis, &coarse.contacts[STATE], &now, basis.grid.x_min, 1e-3);
    reduced_basis_free(&basis);
    trained_free(&coarse);
}

// ---- point contacts

enum {
    MARGIN = 14
}; // nodes beyond the grid in the fields of the tests, so that the ends of splines do not matter

static trained half_training;
static reduced_basis half_basis, whole_basis; // both with the same modes

/* A model with a state, whose exit line may differ from the exit line of the training state. */
typedef struct point_film {
    const reduced_basis *basis;
    ehd_contact reference;
    reduced_model model;
    film_splines splines;
    film_carrier carrier;
    previous_film film;
} point_film;

static contact_frame point_frame(double load, double radius) {
    return frame_at(&contact_point, 0, (double[]){load, 1, radius, 1}, NAN);
}

static void point_film_init(point_film *self, const reduced_basis *basis, bool trained_exits) {
    const reduced_states *states = &basis->states;

    self->basis = basis;
    self->reference = half_training.contacts[STATE];
    self->reference.grid = basis->grid;
    check_ok(reduced_model_build(&self->model, basis, NULL, 0, &error));
    check_ok(film_splines_build(&self->splines, &self->model, basis->pressure,
                                basis->deformation_modes, &error));
    check_ok(
        film_carrier_init(&self->carrier, &self->model, &self->splines, &self->reference, &error));
    check_ok(previous_film_init(&self->film, &self->carrier, &error));
    self->film.frame = point_frame(1, 1);
    memcpy(self->film.state.coordinates, states->coordinates + STATE * states->num_unknowns,
           states->num_unknowns * sizeof(double));
    reduced_state_set_exits(&self->film.state, &self->model,
                            states->exit + STATE * states->num_lines);
    size_t central = self->model.band.num_lines / 2; // central line of a whole grid
    for (size_t l = 0; l < self->model.band.num_lines && !trained_exits; l++) {
        const band_line *line = &self->model.band.lines[l];
        size_t from_centre = basis->grid.half ? l : l > central ? l - central : central - l;
        self->film.state.exits[l] = from_centre % 3 ? line->min_exit : line->max_exit;
    }
    previous_film_prepare(&self->film);
}

static void point_film_free(point_film *self) {
    previous_film_free(&self->film);
    film_carrier_free(&self->carrier);
    film_splines_free(&self->splines);
    reduced_model_free(&self->model);
}

static double mass_at(const point_film *self, size_t node, const contact_frame *now) {
    const double mass = previous_film_mass(&self->film, node, now);

    // the sums that the first evaluation has stored give the same mass
    check_close(previous_film_mass(&self->film, node, now), mass, 1e-13, 0);
    return mass;
}

/* A field on the nodes of the grid and on MARGIN more nodes on each side. */
typedef struct plane {
    size_t width, lines;
    double *x, *y;
    double *values;     // [lines, width]
    gsl_spline **along; // [lines]
} plane;

/* Returns a pointer to the value at a node of the plane. */
static double *plane_node(const plane *self, size_t line, size_t column) {
    return &self->values[line * self->width + column];
}

static void plane_init(plane *self, const ehd_grid *given) {
    const ehd_grid grid = grid_whole(given);

    self->width = grid_width(&grid) + 2 * MARGIN;
    self->lines = grid_lines(&grid) + 2 * MARGIN;
    self->x = calloc(self->width + self->lines, sizeof(double));
    self->y = self->x + self->width;
    self->values = calloc(self->width * self->lines, sizeof(double));
    self->along = calloc(self->lines, sizeof *self->along);
    assert_true(self->x && self->values && self->along);
    for (size_t c = 0; c < self->width; c++)
        self->x[c] = grid_x(&grid, 0) + ((double)c - MARGIN) * grid.step;
    for (size_t l = 0; l < self->lines; l++)
        self->y[l] = grid_y(&grid, 0) + ((double)l - MARGIN) * grid.step;
}

static void plane_free(plane *self) {
    for (size_t l = 0; l < self->lines; l++)
        gsl_spline_free(self->along[l]);
    free(self->along);
    free(self->values);
    free(self->x);
}

/* Makes a spline along each line. From the values of these splines, plane_at makes a spline across
 * the lines. */
static void plane_prepare(plane *self) {
    for (size_t l = 0; l < self->lines; l++) {
        self->along[l] = gsl_spline_alloc(gsl_interp_cspline, self->width);
        gsl_spline_init(self->along[l], self->x, plane_node(self, l, 0), self->width);
    }
}

static double plane_at(const plane *self, double x, double y) {
    gsl_spline *across = gsl_spline_alloc(gsl_interp_cspline, self->lines);
    double *values = calloc(self->lines, sizeof *values);

    assert_true(across && values);
    for (size_t l = 0; l < self->lines; l++)
        values[l] = gsl_spline_eval(self->along[l], x, NULL);
    gsl_spline_init(across, self->y, values, self->lines);
    double value = gsl_spline_eval(across, y, NULL);
    gsl_spline_free(across);
    free(values);
    return value;
}

/* Adds the pressure of the state at the nodes of the grid, computed from the modes. If `cut`, the
 * pressure is zero behind the exit line. */
static void fill_pressure(plane *self, const point_film *of, bool cut) {
    const ehd_grid *grid = &of->basis->grid;
    size_t num = of->basis->num_pressure, width = grid_width(grid), middle = self->lines / 2;

    for (size_t l = MARGIN; l < self->lines - MARGIN; l++)
        for (size_t c = 0; c < width; c++) {
            size_t own = !grid->half ? l - MARGIN : l > middle ? l - middle : middle - l;
            double *pressure = plane_node(self, l, MARGIN + c);
            if (cut && c >= of->film.state.exits[own]) continue;
            for (size_t j = 0; j < num; j++)
                *pressure += of->basis->pressure[(own * width + c) * num + j] *
                             of->film.state.coordinates[j];
        }
}

/* Computes H0 plus the deflection of `pressure`, by direct summation. */
static void fill_deflection(plane *self, const plane *pressure, const point_film *of) {
    double step = of->basis->grid.step;
    size_t size = self->width * self->lines;
    double *kernel = calloc(size, sizeof *kernel); // [lines, width], by distance

    assert_non_null(kernel);
    for (size_t k = 0; k < size; k++)
        kernel[k] =
            deflection_influence(&contact_point, &of->basis->grid, (double)(k % self->width) * step,
                                 (double)(k / self->width) * step);
    for (size_t k = 0; k < size; k++)
        self->values[k] = of->film.state.coordinates[of->model.num_unknowns - 1];
    for (size_t i = 0; i < size; i++)
        for (size_t l = 0; l < self->lines && pressure->values[i] != 0; l++)
            for (size_t c = 0; c < self->width; c++) {
                // NOLINTNEXTLINE(clang-analyzer-core.DivideZero): c < width here
                size_t apart = l > i / self->width ? l - i / self->width : i / self->width - l;
                size_t along = c > i % self->width ? c - i % self->width : i % self->width - c;
                *plane_node(self, l, c) +=
                    pressure->values[i] * kernel[apart * self->width + along];
            }
    free(kernel);
}

/* The exit line is straight between grid lines, and constant beyond the outermost lines. */
static bool is_before_exit(const point_film *self, double x, double y) {
    const ehd_grid *grid = &self->basis->grid;
    double line = (y - grid_y(grid, 0)) / grid->step;
    size_t l = (size_t)(line + 1e-9), first = grid_first_line(grid);
    size_t last = first + grid->inner_lines - 1;

    if (l + 1 >= self->model.band.num_lines) return false;
    double part = line - (double)l, exit = (double)self->film.state.exits[l < first ? first : l];
    double next = (double)self->film.state.exits[l + 1 > last ? last : l + 1];
    return x < grid_x(grid, 0) + grid->step * ((1 - part) * exit + part * next) - 1e-9;
}

/* Compares the masses with tensor-product splines at the nodes of the frame `now`. Places near the
 * downstream ends of the model's splines are left out, because with the farthest exits the pressure
 * reaches these ends. */
static void compare_point(const point_film *self, const contact_frame *now, double tolerance,
                          double at_ends) {
    const ehd_grid *grid = &self->basis->grid;
    const grid_extent extent = grid_extent_of(grid);
    double stretch = frame_stretch(now, &self->film.frame);
    double ratio = frame_film_ratio(now, &self->film.frame);
    double hertz = self->reference.hertz_pressure;
    plane pressure, uncut, film;

    plane_init(&pressure, grid);
    plane_init(&uncut, grid);
    plane_init(&film, grid);
    fill_pressure(&pressure, self, true);
    fill_pressure(&uncut, self, false);
    fill_deflection(&film, &pressure, self);
    plane_prepare(&pressure);
    plane_prepare(&uncut);
    plane_prepare(&film);
    for (size_t r = 0; r < grid->num_inner; r += 5) {
        size_t node = grid_node_of_row(grid, r);
        double x = stretch * grid_x(grid, node), y = stretch * grid_y(grid, node);
        if (x > 0.9 || fabs(y) > film.y[film.lines - 1] || x < film.x[0]) continue;
        double expected = plane_at(&film, x, y) + contact_gap(&grid->shape, x, y);
        double there =
            is_before_exit(self, x, y) && x > grid_x(grid, 0) ? plane_at(&uncut, x, y) : 0;
        double density = lubricant_density(&self->reference.lubricant, there * hertz);
        const bool at_end = x < grid_x(grid, 2) || fabs(y) > extent.y_max - grid->step;
        check_close(mass_at(self, node, now), expected * density * ratio,
                    at_end ? at_ends : tolerance, 0);
    }
    plane_free(&pressure);
    plane_free(&uncut);
    plane_free(&film);
}

static void films_of_point_contacts_equal_tensor_splines(void **unused) {
    (void)unused;
    for (int i = 0; i < 3; i++) { // half grid with two exit lines, whole grid
        point_film self;
        point_film_init(&self, i < 2 ? &half_basis : &whole_basis, i == 0);
        assert_true(self.film.num_cut > (i == 0 ? 0 : self.model.band.num_lines / 2));
        const contact_frame frames[] = {point_frame(0.93, 1), point_frame(1.02, 1.01),
                                        point_frame(1.3, 1)};
        for (size_t f = 0; f < sizeof frames / sizeof *frames; f++)
            // within a grid step of the grid's ends, where pressure falls to zero, the splines
            // differ
            compare_point(&self, &frames[f], 3e-5, 2e-4);
        self.reference.lubricant.density = NULL;
        for (size_t f = 0; f < sizeof frames / sizeof *frames; f++)
            compare_point(&self, &frames[f], 1e-6, 1e-6);
        point_film_free(&self);
    }
}

/* If the frame does not change, the carried values equal the values at the nodes. This must also
 * hold for the next state that is stored in the same memory. */
static void a_frame_that_stands_still_gives_the_nodes(void **unused) {
    (void)unused;
    point_film self;

    point_film_init(&self, &half_basis, true);
    for (int i = 0; i < 3; i++) {
        if (i == 1) {
            self.film.state.coordinates[1] *= 1.01;
            previous_film_prepare(&self.film);
        }
        if (i == 2) {
            point_film_free(&self);
            point_film_init(&self, &half_basis, false);
        }
        const ehd_grid *grid = &half_basis.grid;
        double *pressure = calloc(2 * grid->num_nodes, sizeof *pressure);
        double *film = pressure + grid->num_nodes;
        const contact_frame now = point_frame(1, 1);
        assert_non_null(pressure);
        fields_of(pressure, film, &self.film.state, &self.model, half_basis.pressure);
        for (size_t r = 0; r < grid->num_inner; r++) {
            size_t k = grid_node_of_row(grid, r);
            double density = lubricant_density(&self.reference.lubricant,
                                               pressure[k] * self.reference.hertz_pressure);
            check_close(mass_at(&self, k, &now), density * film[k], 1e-12, 0);
        }
        free(pressure);
    }
    point_film_free(&self);
}

static void films_of_the_half_are_those_of_the_whole(void **unused) {
    (void)unused;
    const contact_frame frames[] = {point_frame(0.9, 1), point_frame(1.03, 1), point_frame(4, 1)};
    const ehd_grid *grid = &half_basis.grid;
    point_film half, whole;

    point_film_init(&half, &half_basis, false);
    point_film_init(&whole, &whole_basis, false);
    // first node of the line y = 0
    size_t first = whole_basis.grid.num_nodes / 2 - grid_width(grid) / 2;
    for (size_t f = 0; f < sizeof frames / sizeof *frames; f++)
        for (size_t r = 0; r < grid->num_inner; r += 3) {
            size_t node = grid_node_of_row(grid, r);
            check_close(mass_at(&half, node, &frames[f]), mass_at(&whole, first + node, &frames[f]),
                        1e-11, 0);
        }
    point_film_free(&half);
    point_film_free(&whole);
}

/* Linear deformation modes of an independent basis stay linear beyond the grid, upstream and at the
 * sides. */
static void straight_modes_go_on_straight(void **unused) {
    (void)unused;
    for (int i = 0; i < 2; i++) { // the half grid, and the whole grid with a slope across
        reduced_basis basis = i == 0 ? half_basis : whole_basis;
        const double lean = i == 0 ? 0 : -0.05, approach = 0.1;
        const contact_frame frames[] = {point_frame(0.9, 1), point_frame(2, 1), point_frame(4, 1)};
        const ehd_grid *grid = &basis.grid;
        point_film self;

        basis.deformation = DEFORMATION_INDEPENDENT;
        basis.num_deformation = 2;
        basis.deformation_modes = calloc(2 * grid->num_nodes, sizeof(double));
        assert_non_null(basis.deformation_modes);
        for (size_t k = 0; k < grid->num_nodes; k++) {
            basis.deformation_modes[2 * k] = 1 + grid_x(grid, k);
            basis.deformation_modes[2 * k + 1] = lean * grid_y(grid, k);
        }
        point_film_init(&self, &basis, true);
        self.reference.lubricant.density = NULL;
        double *z = self.film.state.coordinates + basis.num_pressure;
        z[0] = 0.3, z[1] = 1, z[2] = approach;
        for (size_t f = 0; f < sizeof frames / sizeof *frames; f++)
            for (size_t r = 0; r < grid->num_inner; r++) {
                size_t node = grid_node_of_row(grid, r);
                double stretch = frame_stretch(&frames[f], &self.film.frame);
                double x = stretch * grid_x(grid, node), y = stretch * grid_y(grid, node);
                double film = approach + 0.3 * (1 + x) + lean * y + contact_gap(&grid->shape, x, y);
                check_close(mass_at(&self, node, &frames[f]),
                            film * frame_film_ratio(&frames[f], &self.film.frame), 1e-12, 1e-12);
            }
        point_film_free(&self);
        free(basis.deformation_modes);
    }
}

static int set_up(void **state) {
    (void)state;
    trained_init(&training, 0.05);
    trained_init_point(&half_training, true, "open");
    trained_basis(&half_basis, &half_training, DEFORMATION_COUPLED, 0, 0);
    whole_basis = mirrored_basis(&half_basis);
    return 0;
}

static int tear_down(void **state) {
    (void)state;
    trained_free(&training);
    trained_free(&half_training);
    reduced_basis_free(&half_basis);
    reduced_basis_free(&whole_basis);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(films_equal_those_of_the_full_model),
        cmocka_unit_test(films_go_on_before_the_grid),
        cmocka_unit_test(coarse_grids_have_splines_too),
        cmocka_unit_test(films_of_point_contacts_equal_tensor_splines),
        cmocka_unit_test(a_frame_that_stands_still_gives_the_nodes),
        cmocka_unit_test(films_of_the_half_are_those_of_the_whole),
        cmocka_unit_test(straight_modes_go_on_straight)};
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
