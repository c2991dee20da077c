/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where the online solver puts the exits, and what it makes of those that it cannot put where they
 * belong. */
#include "romrun/online/least_squares.h"
#include "tests/unit/check.h"
#include "tests/unit/reduced_problem.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

static trained line, half_point;
static reduced_basis line_basis, point_basis; // every inner node is a mode

/* The full model in reduced clothes, with the weights of the training. */
static reduced_basis whole_basis(const trained *from) {
    reduced_basis small;

    trained_basis(&small, from, DEFORMATION_COUPLED, 0, 0);
    reduced_basis whole = identity_basis(&from->set, DEFORMATION_COUPLED, small.weight);
    reduced_basis_free(&small);
    return whole;
}

static int set_up(void **state) {
    (void)state;
    trained_init_published(&line, 0.02); // exits at nodes
    trained_init_point(&half_point, true, "open");
    line_basis = whole_basis(&line);
    point_basis = whole_basis(&half_point);
    return 0;
}

static int tear_down(void **state) {
    (void)state;
    reduced_basis_free(&line_basis);
    reduced_basis_free(&point_basis);
    trained_free(&line);
    trained_free(&half_point);
    return 0;
}

/* The stationary equations, but with exits that go by the signs of pressure and multiplier, as in
 * time. */
static double nothing_previous(void *context, size_t node) {
    (void)context, (void)node;
    return 0;
}

static reduced_squeeze no_squeeze(const reduced_model *model) {
    double *previous = calloc(model->rows.num_rows, sizeof *previous);

    assert_non_null(previous);
    return (reduced_squeeze){.rate = 0, .previous = previous, .previous_at = nothing_previous};
}

// ---- an exit that is held

/* A linear solver that goes to and fro between two states, by which the exit turns round so often
 * that it is held, and takes the least squares from then on. */
typedef struct to_and_fro {
    const reduced_state *state;
    double *back, *on; // [num_unknowns]
    size_t calls;
    least_squares *own;
} to_and_fro;

static ehd_status go_to_and_fro(double *step, void *context, const double *matrix,
                                const double *right, size_t num_rows, size_t num_unknowns) {
    to_and_fro *self = context;
    const size_t call = self->calls++;
    const double *target = call % 2 ? self->on : self->back;

    if (call >= 5) return least_squares_solve(step, self->own, matrix, right, num_rows);
    for (size_t j = 0; j < num_unknowns; j++)
        step[j] = target[j] - self->state->coordinates[j];
    return EHD_OK;
}

/* Solves a trained contact with its exit held so many nodes behind its place. */
static reduced_info solve_held(size_t s, size_t behind) {
    to_and_fro other = {0};
    reduced_settings settings = reduced_default_settings();
    reduced_problem reduced;

    settings.solve_linear = go_to_and_fro;
    settings.linear_context = &other;
    reduced_problem_init(&reduced, &line_basis, NULL, 0, &settings);
    const size_t n = reduced.model.num_unknowns, bytes = n * sizeof(double);
    const size_t exit = line.set.exit[s] + behind;
    const reduced_squeeze squeeze = no_squeeze(&reduced.model);

    other.state = &reduced.state;
    other.own = least_squares_create(reduced.model.rows.num_rows + 1, n);
    other.back = malloc(bytes);
    other.on = malloc(bytes);
    assert_true(other.own && other.back && other.on);
    memcpy(other.back, line_basis.states.coordinates + s * n, bytes);
    memcpy(other.on, other.back, bytes);
    memcpy(reduced.state.coordinates, other.back, bytes);
    // a mode is an inner node, from 1 on: a suction before the exit, and a pressure that asks for
    // more of it
    other.back[exit - 2] = -0.01;
    other.on[exit - 3] = 0.01;
    reduced.state.exit = exit;
    assert_int_equal(reduced_solve(&reduced.info, &reduced.state, reduced.solver, &line.contacts[s],
                                   &squeeze, NULL),
                     EHD_OK);
    assert_int_equal(reduced.state.exit, exit);
    assert_true(other.calls > 5);
    free((void *)squeeze.previous);
    free(other.on);
    free(other.back);
    least_squares_free(other.own);
    reduced_info info = reduced.info;
    reduced_problem_free(&reduced);
    return info;
}

/* Pressure behind the exit's place is negative. One node of it moves the central film by less than
 * 1e-5, which is accepted; two move it by up to 3e-5 and four by 1e-4, which is not. */
static void an_exit_held_elsewhere_is_not_trusted(void **state) {
    (void)state;
    for (size_t s = 0; s < TRAINED_STATES; s += 5)
        for (size_t behind = 1; behind <= 4; behind++) {
            const reduced_info info = solve_held(s, behind);
            const double moved =
                info.scalars.central_film_thickness / line.set.central_film_thickness[s] - 1;
            assert_int_equal(info.status, behind == 1 ? EHD_OK : EHD_UNTRUSTED);
            assert_string_equal(info.reason,
                                behind == 1 ? "" : "an exit boundary that does not settle");
            assert_true((fabs(moved) < 1e-5) == (behind == 1));
        }
}

// ---- exits at the ends of the band

/* A band that ends before the exits of a training state, or begins behind them; on lines that are
 * not looked at the farther the more. */
static void narrow_band(reduced_model *model, size_t s, ptrdiff_t min, ptrdiff_t max) {
    for (size_t l = 0; l < model->band.num_lines; l++) {
        band_line *band = &model->band.lines[l];
        const size_t exit = model->states.exit[s * model->band.num_lines + l];
        const ptrdiff_t farther = min > 0 ? (ptrdiff_t)(l % 2) : -(ptrdiff_t)(l % 2);
        if (!reduced_model_has_band(model, l)) continue;
        band->min_exit = (size_t)((ptrdiff_t)exit + min + farther);
        band->max_exit = (size_t)((ptrdiff_t)exit + max + farther);
    }
}

/* Solves a trained contact there; lines that are not looked at are the odd ones, if any. */
static void solve_in_narrow_band(const reduced_basis *basis, const ehd_contact *contact,
                                 bool in_time, bool all_lines, size_t s, ptrdiff_t min,
                                 ptrdiff_t max) {
    reduced_problem reduced;
    reduced_settings settings = reduced_default_settings();

    settings.exit_spacing = all_lines ? 0 : 2 * basis->grid.step;
    reduced_problem_init(&reduced, basis, NULL, 0, &settings);
    const reduced_model *model = &reduced.model;
    const reduced_squeeze squeeze = no_squeeze(model);
    size_t *start = malloc(model->band.num_lines * sizeof *start);
    assert_non_null(start);
    narrow_band(&reduced.model, s, min, max);
    memcpy(reduced.state.coordinates, model->states.coordinates + s * model->num_unknowns,
           model->num_unknowns * sizeof(double));
    for (size_t l = 0; l < model->band.num_lines; l++)
        start[l] = (model->band.lines[l].min_exit + model->band.lines[l].max_exit) / 2;
    reduced_state_set_exits(&reduced.state, model, start);
    assert_int_equal(reduced_solve(&reduced.info, &reduced.state, reduced.solver, contact,
                                   in_time ? &squeeze : NULL, NULL),
                     EHD_OK);
    assert_int_equal(reduced.info.status, EHD_OK);
    for (size_t l = 0; l < model->band.num_lines; l++) {
        const band_line *band = &model->band.lines[l];
        const size_t exit = reduced_state_exits(&reduced.state)[l];
        if (!reduced_model_has_band(model, l)) continue;
        assert_in_range(exit, band->min_exit, band->max_exit);
        if (all_lines || l % 2 == 0)
            assert_int_equal(exit, min > 0 ? band->min_exit : band->max_exit);
    }
    free(start);
    free((void *)squeeze.previous);
    reduced_problem_free(&reduced);
}

/* Held in the last column of the band, neither before nor behind it, by the flux and by signs. */
static void exits_end_where_the_band_does(void **state) {
    (void)state;
    for (size_t s = 0; s < TRAINED_STATES; s += 6)
        for (int in_time = 0; in_time < 2; in_time++) {
            const ehd_contact *contact = &line.contacts[s];
            solve_in_narrow_band(&line_basis, contact, in_time, true, s, -5, -2);
            solve_in_narrow_band(&line_basis, contact, in_time, true, s, 2, 5);
            contact = &half_point.contacts[s];
            for (int all = 0; all < 2; all++) {
                solve_in_narrow_band(&point_basis, contact, in_time, all, s, -3, -1);
                solve_in_narrow_band(&point_basis, contact, in_time, all, s, 1, 3);
            }
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_exit_held_elsewhere_is_not_trusted),
        cmocka_unit_test(exits_end_where_the_band_does),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
