/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tests the choice of control rows, their residuals, and the error estimate from the residuals. */
#include "deimselect/control.h"
#include "romrun/solve/guess.h"
#include "romrun/trust/functionals.h"
#include "romrun/trust/indicator.h"
#include "tests/unit/allocation.h"
#include "tests/unit/check.h"
#include "tests/unit/reduced_problem.h"
#include "tests/unit/trained.h"

#include <cblas.h>
#include <lapacke.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static trained training;
static reduced_basis bases[2]; // indexed by deformation_kind
static ehd_error error;

#define check_ok(call) assert_string_equal(((call) == EHD_OK) ? "" : error.text, "")

static int set_up(void **state) {
    (void)state;
    trained_init(&training, 0.02);
    trained_basis(&bases[DEFORMATION_INDEPENDENT], &training, DEFORMATION_INDEPENDENT, 0, 0);
    trained_basis(&bases[DEFORMATION_COUPLED], &training, DEFORMATION_COUPLED, 0, 0);
    return 0;
}

static int tear_down(void **state) {
    (void)state;
    reduced_basis_free(&bases[0]);
    reduced_basis_free(&bases[1]);
    trained_free(&training);
    return 0;
}

// ---- choice

enum { NODES = 12, MODES = 2, SELECTED = 3 };

static const size_t selected[SELECTED] = {1, 4, 9};

/* Makes two residual vectors for each of three states. The first vector belongs to an iterate that
 * is not converged, and is large at node 5. The second vector is converged. It is a sum of the
 * modes plus a deviation at node 7, 2 or 10. The deviation decreases from state to state. */
static void make_snapshots(double residuals[6][NODES], double modes[MODES][NODES]) {
    const size_t places[] = {7, 2, 10};

    memset(residuals, 0, 6 * sizeof *residuals);
    for (size_t k = 0; k < NODES; k++) {
        modes[0][k] = 1 / sqrt(NODES);
        modes[1][k] = (k % 2 ? 1 : -1) / sqrt(NODES);
    }
    for (size_t s = 0; s < 3; s++) {
        residuals[2 * s][5] = 100;
        for (size_t k = 0; k < NODES; k++)
            residuals[2 * s + 1][k] = 3 * modes[0][k] + (double)s * modes[1][k];
        residuals[2 * s + 1][places[s]] += pow(10, -(double)s);
    }
}

static void control_rows_are_where_selected_ones_predict_least(void **state) {
    double residuals[6][NODES], modes[MODES][NODES];
    int64_t states[6] = {0, 0, 1, 1, 2, 2};
    const residual_snapshots snapshots = {6, residuals[0], NULL, states, NULL};
    size_t control[4], count = 3;
    (void)state;

    make_snapshots(residuals, modes);
    check_ok(control_choose(control, &count, true, &snapshots, NODES, modes[0], MODES, selected,
                            SELECTED, &error));
    assert_int_equal(count, 3);
    assert_int_equal(control[0], 7);
    assert_int_equal(control[1], 2);
    assert_int_equal(control[2], 10);
    // each converged state gives at most one control row; states of trajectories give none
    count = 4;
    assert_int_equal(control_choose(control, &count, true, &snapshots, NODES, modes[0], MODES,
                                    selected, SELECTED, &error),
                     EHD_DATA);
    assert_non_null(strstr(error.text, "--control: found 4, expected at most 3"));
    check_ok(control_choose(control, &count, false, &snapshots, NODES, modes[0], MODES, selected,
                            SELECTED, &error));
    assert_int_equal(count, 3);
    memset(states, -1, sizeof states);
    check_ok(control_choose(control, &count, false, &snapshots, NODES, modes[0], MODES, selected,
                            SELECTED, &error));
    assert_int_equal(count, 0);
}

static void choice_survives_failing_allocations(void **state) {
    double residuals[6][NODES], modes[MODES][NODES];
    int64_t states[6] = {0, 0, 1, 1, 2, 2};
    const residual_snapshots snapshots = {6, residuals[0], NULL, states, NULL};
    size_t control[4], call = 0;
    (void)state;

    make_snapshots(residuals, modes);
    for (;; call++) {
        size_t count = 3;
        allocation_fail_at(call);
        ehd_status status = control_choose(control, &count, true, &snapshots, NODES, modes[0],
                                           MODES, selected, SELECTED, &error);
        if (!allocation_failed()) break;
        assert_int_not_equal(status, EHD_OK);
    }
    assert_true(call > 2);
}

// ---- residual

static const size_t control_nodes[] = {20, 1, 150, 203, 250, 253, 255, 257, 259};
enum { NUM_CONTROL = sizeof control_nodes / sizeof *control_nodes };

/* Keeps the weighted residual of all rows at the initial state. The solver calls this function once
 * per iteration. */
static ehd_status keep_first(void *context, const double *residual, const double *step,
                             ehd_error *ignored) {
    double *kept = context;
    (void)step, (void)ignored;

    if (isnan(kept[0])) memcpy(kept, residual, training.set.grid.num_inner * sizeof *kept);
    return EHD_OK;
}

/* Returns the norm |D f| of the control rows, computed from all rows. */
static double residual_from_all_rows(const reduced_model *model, const reduced_state *at,
                                     const ehd_contact *contact) {
    const reduced_settings once = {.tolerance = 1e-8, .max_iterations = 1};
    double *all = malloc(model->grid.num_inner * sizeof *all), sum = 0;
    double *z = malloc(model->num_unknowns * sizeof *z);
    reduced_state copy = {.coordinates = z, .exit = at->exit};
    reduced_solver *solver;
    reduced_info info;

    assert_true(all && z);
    all[0] = NAN;
    memcpy(z, at->coordinates, model->num_unknowns * sizeof *z);
    check_ok(reduced_solver_create(&solver, model, &once, &error));
    reduced_solver_observe(solver, keep_first, NULL, all);
    check_ok(reduced_solve(&info, &copy, solver, contact, NULL, &error));
    for (size_t r = 0; r < NUM_CONTROL; r++)
        sum += all[control_nodes[r] - 1] * all[control_nodes[r] - 1];
    reduced_solver_free(solver);
    free(z);
    free(all);
    return sqrt(sum);
}

static void control_residual_is_that_of_all_rows(void **state) {
    (void)state;
    for (int kind = 0; kind < 2; kind++) {
        reduced_model model;
        check_ok(reduced_model_build(&model, &bases[kind], NULL, 0, &error));
        check_ok(
            reduced_model_add_control(&model, &bases[kind], control_nodes, NUM_CONTROL, &error));
        indicator *self = indicator_create(&model);
        double *z = malloc(model.num_unknowns * sizeof *z);
        assert_true(self && z);
        // each contact gets the state of another contact; some exits are at a checkpoint
        // (reduced_cut.h), others are not
        for (size_t s = 0; s < TRAINED_STATES; s++) {
            const ehd_contact *contact = &training.contacts[(s + 5) % TRAINED_STATES];
            const reduced_state at = {.coordinates = z, .exit = model.states.exit[s] + s % 3};
            memcpy(z, model.states.coordinates + s * model.num_unknowns,
                   model.num_unknowns * sizeof *z);
            const double *residuals = indicator_control_residuals(self, &at, contact);
            check_close(cblas_dnrm2(NUM_CONTROL, residuals, 1),
                        residual_from_all_rows(&model, &at, contact), 1e-9, 0);
        }
        free(z);
        indicator_free(self);
        reduced_model_free(&model);
    }
}

// ---- error estimate

/* With few modes, results have errors. The estimate must lie between 0.1 and 1e4 times the largest
 * error, and decrease when modes are added. */
static void bound_follows_the_deviation(void **state) {
    const reduced_settings settings = reduced_defaults;
    double before = 0;
    (void)state;

    for (size_t modes = 6; modes <= 10; modes += 2) {
        reduced_basis basis;
        reduced_model model;
        reduced_solver *solver;
        reduced_info info;
        double worst = 0, bound = 0, worst_minimum = 0, bound_minimum = 0;
        trained_basis(&basis, &training, DEFORMATION_COUPLED, modes, 0);
        check_ok(reduced_model_build(&model, &basis, NULL, 0, &error));
        check_ok(reduced_model_add_control(&model, &basis, control_nodes, NUM_CONTROL, &error));
        check_ok(reduced_solver_create(&solver, &model, &settings, &error));
        indicator *self = indicator_create(&model);
        double *z = malloc(model.num_unknowns * sizeof *z);
        assert_true(self && z);
        for (size_t s = 0; s < TRAINED_STATES; s++) {
            const ehd_contact *contact = &training.contacts[s];
            reduced_state at = {.coordinates = z};
            reduced_guess(&at, &model, contact_place_of(contact));
            check_ok(reduced_solve(&info, &at, solver, contact, NULL, &error));
            double found = indicator_bound(self, solver, &at, contact, &info.scalars);
            assert_true(info.status == EHD_OK && found > 0);
            bound = fmax(bound, found);
            bound_minimum =
                fmax(bound_minimum, indicator_bound_minimum(self, solver, &info.scalars));
            worst_minimum =
                fmax(worst_minimum,
                     fabs(info.scalars.minimum_film_thickness /
                              trained_least_film(training.film + s * training.set.grid.num_nodes,
                                                 &training.set.grid) -
                          1));
            worst = fmax(worst, fabs(info.scalars.central_film_thickness /
                                         training.states->central_film_thickness[s] -
                                     1));
        }
        if (!(worst > 1e-7 && bound > 0.1 * worst && bound < 1e4 * worst))
            fail_msg("%zu modes: found bound %g, expected one near the deviation %g", modes, bound,
                     worst);
        if (!(worst_minimum > 1e-7 && bound_minimum > 0.1 * worst_minimum &&
              bound_minimum < 1e4 * worst_minimum))
            fail_msg("%zu modes: found bound %g, expected one near the minimum film's deviation %g",
                     modes, bound_minimum, worst_minimum);
        assert_true(before == 0 || bound < before);
        before = bound;
        free(z);
        indicator_free(self);
        reduced_solver_free(solver);
        reduced_model_free(&model);
        reduced_basis_free(&basis);
    }
}

/* The last least-squares problem of a solver. `step` is its solution, computed by QR. */
typedef struct problem {
    size_t num_rows, num_columns;
    double matrix[400 * 40], right[400], step[40];
} problem;

static ehd_status keep_problem(double *step, void *context, const double *matrix,
                               const double *right, size_t num_rows, size_t num_columns) {
    problem *self = context;
    double copy[400 * 40], solution[400];

    assert_true(num_rows <= 400 && num_columns <= 40);
    self->num_rows = num_rows;
    self->num_columns = num_columns;
    memcpy(self->matrix, matrix, num_rows * num_columns * sizeof *matrix);
    memcpy(self->right, right, num_rows * sizeof *right);
    memcpy(copy, matrix, num_rows * num_columns * sizeof *matrix);
    for (size_t r = 0; r < num_rows; r++)
        solution[r] = -right[r];
    assert_int_equal(LAPACKE_dgels(LAPACK_ROW_MAJOR, 'N', (int)num_rows, (int)num_columns, 1, copy,
                                   (int)num_columns, solution, 1),
                     0);
    memcpy(self->step, solution, num_columns * sizeof *step);
    memcpy(step, solution, num_columns * sizeof *step);
    return EHD_OK;
}

/* Computes the gradient of the central film, which is linear in the coordinates. */
static void film_gradient(double *gradient, reduced_solver *solver, const reduced_state *at,
                          const ehd_contact *contact, size_t num_columns) {
    const contact_scalars before = reduced_scalars(solver, at, contact);

    for (size_t j = 0; j < num_columns; j++) {
        const double kept = at->coordinates[j], change = 1e-6;
        at->coordinates[j] += change;
        const contact_scalars after = reduced_scalars(solver, at, contact);
        at->coordinates[j] = kept;
        gradient[j] = (after.central_film_thickness - before.central_film_thickness) / change;
    }
}

/* Computes how much each row's residual changes a film: the shortest x with J^T x = gradient. */
static void shortest_cause(double *cause, const problem *last, const double *gradient) {
    double copy[400 * 40];

    memcpy(copy, last->matrix, last->num_rows * last->num_columns * sizeof *copy);
    memset(cause, 0, 400 * sizeof *cause);
    memcpy(cause, gradient, last->num_columns * sizeof *cause);
    assert_int_equal(LAPACKE_dgels(LAPACK_ROW_MAJOR, 'T', (int)last->num_rows,
                                   (int)last->num_columns, 1, copy, (int)last->num_columns, cause,
                                   1),
                     0);
}

/* Computes the gradients of pressure and film at each node. */
static void field_gradients(double *gradients, const reduced_model *model,
                            const reduced_basis *basis, const reduced_state *at) {
    const size_t num_nodes = model->grid.num_nodes, n = model->num_unknowns;
    double *fields = malloc(4 * num_nodes * sizeof *fields), *after = fields + 2 * num_nodes;

    assert_non_null(fields);
    fields_of(fields, fields + num_nodes, at, model, basis->pressure);
    for (size_t j = 0; j < n; j++) {
        at->coordinates[j] += 1;
        fields_of(after, after + num_nodes, at, model, basis->pressure);
        at->coordinates[j] -= 1;
        for (size_t k = 0; k < 2 * num_nodes; k++)
            gradients[k * n + j] = after[k] - fields[k];
    }
    free(fields);
}

/* Returns how much the remaining residuals of the rows change a quantity with this gradient. */
static double moved(const problem *last, const double *left, const double *gradient) {
    double cause[400], sum = 0;

    shortest_cause(cause, last, gradient);
    for (size_t r = 0; r < last->num_rows; r++)
        sum += left[r] * left[r] * cause[r] * cause[r];
    return sqrt(sum);
}

/* Errors of pressures, load and fields follow from the residual of each row, like the error of the
 * central film. The array `added` contains squared residuals that are added to the squared
 * residuals of the rows. */
static void other_errors_are_what_each_row_does(void **state) {
    static problem last;
    (void)state;

    for (int kind = 0; kind < 2; kind++) {
        const reduced_settings plain = {.tolerance = 1e-12, .max_iterations = 40};
        reduced_settings by_qr = plain;
        reduced_basis basis;
        reduced_model model;
        reduced_solver *solver, *other;
        reduced_state at;
        reduced_info info;
        by_qr.solve_linear = keep_problem;
        by_qr.linear_context = &last;
        trained_basis(&basis, &training, kind ? DEFORMATION_COUPLED : DEFORMATION_INDEPENDENT, 8,
                      kind ? 0 : 7);
        check_ok(reduced_model_build(&model, &basis, NULL, 0, &error));
        check_ok(reduced_solver_create(&solver, &model, &plain, &error));
        check_ok(reduced_solver_create(&other, &model, &by_qr, &error));
        check_ok(reduced_state_init(&at, &model, &error));
        const size_t n = model.num_unknowns, num_nodes = model.grid.num_nodes;
        double *gradients = malloc(2 * num_nodes * n * sizeof *gradients);
        double *added = calloc(model.rows.num_rows, sizeof *added);
        functionals *moves = functionals_create(&model);
        assert_true(gradients && added && moves);
        for (size_t s = 1; s < TRAINED_STATES; s += 5) {
            const ehd_contact *contact = &training.contacts[s];
            double left[400] = {0}, gradient[40], pressure = 0, film = 0;
            reduced_guess(&at, &model, contact_place_of(contact));
            check_ok(reduced_solve(&info, &at, other, contact, NULL, &error));
            for (size_t r = 0; r < last.num_rows; r++)
                left[r] = last.right[r] + cblas_ddot((int)n, last.matrix + r * n, 1, last.step, 1);
            added[30] = s == 1 ? 0 : 1e-6; // at the row of node 31
            left[30] = sqrt(left[30] * left[30] + added[30]);
            field_gradients(gradients, &model, &basis, &at);
            for (size_t k = 1; k < at.exit; k++)
                pressure = fmax(pressure, moved(&last, left, gradients + k * n));

            reduced_guess(&at, &model, contact_place_of(contact));
            check_ok(reduced_solve(&info, &at, solver, contact, NULL, &error));
            const reduced_errors found =
                functionals_other_errors(moves, solver, &at, contact, added);
            check_close(found.pressure, pressure, 1e-3, 0);
            size_t centre = 1;
            while (fabs(grid_x(&model.grid, centre)) > 1e-9)
                centre++;
            check_close(found.central_pressure, moved(&last, left, gradients + centre * n), 1e-3,
                        0);
            memset(gradient, 0, sizeof gradient);
            for (size_t k = 0; k < num_nodes; k++)
                cblas_daxpy((int)n, model.grid.step / model.kind->load, gradients + k * n, 1,
                            gradient, 1);
            check_close(found.load, moved(&last, left, gradient), 1e-3, 1e-12);
            // the film of an independent basis has its own unknowns, so its error is not compared
            for (size_t k = 1; k < at.exit && kind; k++)
                film = fmax(film, moved(&last, left, gradients + (num_nodes + k) * n));
            if (kind) check_close(found.film, film, 1e-3, 0);
            assert_true(found.film > 0 && isfinite(found.exit_position) && found.exit_position > 0);
        }
        functionals_free(moves);
        free(gradients);
        free(added);
        reduced_state_free(&at);
        reduced_solver_free(other);
        reduced_solver_free(solver);
        reduced_model_free(&model);
        reduced_basis_free(&basis);
    }
}

/* The error of the central film follows from the residual of each row times the effect of this
 * residual on the film. */
static void film_error_is_what_each_row_does(void **state) {
    static problem last;
    (void)state;

    for (size_t modes = 6; modes <= 10; modes += 2) {
        const reduced_settings plain = {.tolerance = 1e-12, .max_iterations = 40};
        reduced_settings by_qr = plain;
        reduced_basis basis;
        reduced_model model;
        reduced_solver *solver, *other;
        reduced_state at;
        reduced_info info;
        by_qr.solve_linear = keep_problem;
        by_qr.linear_context = &last;
        trained_basis(&basis, &training, DEFORMATION_COUPLED, modes, 0);
        check_ok(reduced_model_build(&model, &basis, NULL, 0, &error));
        check_ok(reduced_model_add_control(&model, &basis, control_nodes, NUM_CONTROL, &error));
        check_ok(reduced_solver_create(&solver, &model, &plain, &error));
        check_ok(reduced_solver_create(&other, &model, &by_qr, &error));
        check_ok(reduced_state_init(&at, &model, &error));
        indicator *self = indicator_create(&model);
        functionals *moves = functionals_create(&model);
        assert_true(self && moves);
        for (size_t s = 0; s < TRAINED_STATES; s += 3) {
            const ehd_contact *contact = &training.contacts[s];
            double gradient[40], cause[400], influence[400], sum = 0;
            reduced_guess(&at, &model, contact_place_of(contact));
            check_ok(reduced_solve(&info, &at, other, contact, NULL, &error));
            film_gradient(gradient, other, &at, contact, last.num_columns);
            shortest_cause(cause, &last, gradient);
            for (size_t r = 0; r < last.num_rows; r++) {
                double left =
                    last.right[r] + cblas_ddot((int)last.num_columns,
                                               last.matrix + r * last.num_columns, 1, last.step, 1);
                sum += left * left * cause[r] * cause[r];
            }
            reduced_guess(&at, &model, contact_place_of(contact));
            check_ok(reduced_solve(&info, &at, solver, contact, NULL, &error));
            check_close(functionals_film_error(influence, moves, solver, REDUCED_CENTRAL_FILM),
                        sqrt(sum), 1e-4, 0);

            // here each control row is also a selected row, so both have the same influence
            const double *residuals = indicator_control_residuals(self, &at, contact);
            for (size_t r = 0; r < NUM_CONTROL; r++)
                sum += pow(residuals[r] * influence[control_nodes[r] - 1], 2);
            check_close(indicator_bound(self, solver, &at, contact, &info.scalars),
                        sqrt(sum) / info.scalars.central_film_thickness, 1e-4, 0);

            // a residual of NaN, as beyond the limit of a viscosity law, gives an infinite estimate
            double *weight = model.control.weight, kept = weight[0];
            weight[0] = NAN;
            assert_true(isinf(indicator_bound(self, solver, &at, contact, &info.scalars)));
            assert_true(isinf(indicator_bound_minimum(self, solver, &info.scalars)));
            weight[0] = kept;
        }
        functionals_free(moves);
        indicator_free(self);
        reduced_state_free(&at);
        reduced_solver_free(other);
        reduced_solver_free(solver);
        reduced_model_free(&model);
        reduced_basis_free(&basis);
    }
}

/* With all modes and rows, a result has only the error that the last iteration leaves. The estimate
 * must lie between 0.1 and 1e4 times this error. */
static void what_the_iteration_leaves_is_indicated(void **state) {
    size_t num_ended_early = 0;
    reduced_model model;
    (void)state;

    check_ok(reduced_model_build(&model, &bases[DEFORMATION_COUPLED], NULL, 0, &error));
    for (size_t s = 0; s < TRAINED_STATES; s++) {
        double film[2] = {0}, indicated = 0;
        for (int loose = 0; loose < 2; loose++) {
            const reduced_settings settings = {.tolerance = loose ? 1e-3 : 1e-12,
                                               .max_iterations = 40};
            double *influence = calloc(model.rows.num_rows, sizeof *influence);
            functionals *moves = functionals_create(&model);
            reduced_solver *solver;
            reduced_state at;
            reduced_info info;
            check_ok(reduced_solver_create(&solver, &model, &settings, &error));
            check_ok(reduced_state_init(&at, &model, &error));
            reduced_neighbour(&at, &model,
                              (contact_place){.moes_M = training.contacts[s].moes_M,
                                              .alpha_p_H = training.contacts[s].alpha_p_H});
            check_ok(reduced_solve(&info, &at, solver, &training.contacts[s], NULL, &error));
            film[loose] = info.scalars.central_film_thickness;
            indicated = functionals_film_error(influence, moves, solver, REDUCED_CENTRAL_FILM);
            reduced_state_free(&at);
            reduced_solver_free(solver);
            functionals_free(moves);
            free(influence);
        }
        const double off = fabs(film[1] - film[0]);
        if (off < 1e-7 * film[0]) continue;
        num_ended_early++;
        if (!(indicated > 0.1 * off && indicated < 1e4 * off))
            fail_msg("state %zu: found %g indicated, expected one near the deviation %g", s,
                     indicated, off);
    }
    assert_true(num_ended_early > 3);
    reduced_model_free(&model);
}

static void indicator_survives_failing_allocations(void **state) {
    reduced_model model;
    size_t call = 0;
    (void)state;

    for (;; call++) {
        check_ok(reduced_model_build(&model, &bases[1], NULL, 0, &error));
        allocation_fail_at(call);
        ehd_status status =
            reduced_model_add_control(&model, &bases[1], control_nodes, NUM_CONTROL, &error);
        indicator *self = status ? NULL : indicator_create(&model);
        bool failed = allocation_failed();
        assert_true(failed == !self);
        indicator_free(self);
        reduced_model_free(&model);
        if (!failed) break;
    }
    assert_true(call > 8);
    assert_null(indicator_free(NULL));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(control_rows_are_where_selected_ones_predict_least),
        cmocka_unit_test(choice_survives_failing_allocations),
        cmocka_unit_test(control_residual_is_that_of_all_rows),
        cmocka_unit_test(bound_follows_the_deviation),
        cmocka_unit_test(film_error_is_what_each_row_does),
        cmocka_unit_test(what_the_iteration_leaves_is_indicated),
        cmocka_unit_test(other_errors_are_what_each_row_does),
        cmocka_unit_test(indicator_survives_failing_allocations),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
