/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Earlier reduced films against those of the full model, which GSL's splines and plain sums carry over. */
#include "fullrun/earlier.h"
#include "romrun/film_splines.h"
#include "tests/unit/check.h"
#include "tests/unit/trained.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STATE = 7 }; // of the training, whose exit is not where the modes' splines are cut

static trained training;
static ehd_error error;

#define check_ok(call)                                                                             \
    if (call) fail_msg("%s", error.text)

/* The same state as the full model holds it: pressure by the modes up to the exit, film by definition. */
static void fill_full(earlier_state *full, earlier_carrier *carrier, const earlier_film *reduced,
                      const reduced_basis *basis, const ehd_contact *reference) {
    const ehd_grid *grid = &basis->grid;
    const double *z = reduced->coordinates;
    size_t num_pressure = basis->num_pressure;
    const double *nodes = carrier->nodes;

    check_ok(earlier_init(full, reference, &error));
    full->frame = reduced->frame;
    full->state.exit = reduced->exit;
    full->state.rigid_approach = z[num_pressure + basis->num_deformation];
    for (size_t k = 0; k < grid->num_nodes; k++) {
        full->state.pressure[k] = 0;
        for (size_t j = 0; j < num_pressure && k < reduced->exit; j++)
            full->state.pressure[k] += basis->pressure[k * num_pressure + j] * z[j];
    }
    for (size_t k = 0; k < grid->num_nodes; k++) {
        double *film = &full->state.film[k];
        *film = full->state.rigid_approach + contact_gap(nodes[k], 0);
        for (size_t i = 0; i < grid->num_nodes && !basis->deformation_modes; i++)
            *film += full->state.pressure[i] *
                     basis->kind->kernel(fabs(nodes[k] - nodes[i]), 0, grid->step);
        for (size_t j = 0; j < basis->num_deformation; j++)
            *film += basis->deformation_modes[k * basis->num_deformation + j] * z[num_pressure + j];
    }
    earlier_prepare(full, carrier);
}

static contact_frame frame_under(double load, double radius, double time) {
    return frame_at(&contact_line, time, (double[]){load, 1, radius, 1}, NAN);
}

/* Compares both at all nodes whose places lie after `from`, in a frame that is `now`. */
static void compare(const reduced_basis *basis, const ehd_contact *reference,
                    const contact_frame *now, double from, double tolerance) {
    const ehd_grid *grid = &basis->grid;
    const contact_frame then = frame_under(1, 1, 0);
    double *expected = malloc(grid->num_inner * sizeof *expected);
    reduced_model model;
    film_splines splines;
    earlier_film film;
    earlier_carrier carrier;
    earlier_state full;

    assert_non_null(expected);
    check_ok(earlier_carrier_init(&carrier, reference, &error));
    check_ok(reduced_model_build(&model, basis, NULL, 0, &error));
    check_ok(
        film_splines_build(&splines, &model, basis->pressure, basis->deformation_modes, &error));
    check_ok(earlier_film_init(&film, &model, &error));
    film.frame = then;
    film.exit = basis->states.exit[STATE];
    memcpy(film.coordinates, basis->states.coordinates + STATE * model.num_unknowns,
           model.num_unknowns * sizeof(double));
    earlier_film_prepare(&film, &model, &splines, reference);
    fill_full(&full, &carrier, &film, basis, reference);
    earlier_mass(expected, &full, now, &carrier);
    for (size_t k = 1; k <= grid->num_inner; k++) {
        // the same state three times, and once alone
        const earlier_film *films[] = {&film, &film, &film};
        double mass[3], alone;
        double place = frame_stretch(now, &then) * grid_x(grid, k);
        if (place < from) continue;
        if (place > 2) break; // the grid's other end, behind every exit
        earlier_film_masses(mass, films, 3, k, now, &model, &splines, reference);
        earlier_film_masses(&alone, films, 1, k, now, &model, &splines, reference);
        check_close(mass[0], expected[k - 1], tolerance, 0);
        check_close(mass[1], mass[0], 1e-13, 0);
        check_close(mass[2], alone, 1e-13, 0);
    }
    earlier_film_free(&film);
    earlier_free(&full);
    earlier_carrier_free(&carrier);
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

/* Places before the grid, which a frame reaches that got wider: the deflection of the pressure there too, on
 * and beyond the part that is kept of it. */
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

static int set_up(void **state) {
    (void)state;
    trained_init(&training, 0.05);
    return 0;
}

static int tear_down(void **state) {
    (void)state;
    trained_free(&training);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(films_equal_those_of_the_full_model),
                                       cmocka_unit_test(films_go_on_before_the_grid),
                                       cmocka_unit_test(coarse_grids_have_splines_too)};
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
