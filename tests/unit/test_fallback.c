/* SPDX-License-Identifier: GPL-3.0-or-later */
/* If the full model solves as a fallback after the reduced model, it finds the same solution as the
 * full model alone, from any start. */
#include "romrun/calibrate/fallback.h"
#include "tests/unit/check.h"
#include "tests/unit/folder.h"
#include "tests/unit/problem.h"
#include "tests/unit/reduced_problem.h"

#include <math.h>
#include <stdio.h>

static trained training, point_training;
static reduced_basis bases[2], point_basis;
static size_t rows[FEW_ROWS];
static char path[128];
static ehd_error error;

#define check_ok(call) assert_string_equal(((call) == EHD_OK) ? "" : error.text, "")

static int set_up(void **state) {
    if (make_folder(state)) return -1;
    snprintf(path, sizeof path, "%s/model.h5", folder);
    trained_few_init(&training, bases, rows);
    trained_init_point(&point_training, true, "open");
    trained_basis(&point_basis, &point_training, DEFORMATION_COUPLED, 0, 0);
    return 0;
}

static int tear_down(void **state) {
    trained_few_free(&training, bases);
    reduced_basis_free(&point_basis);
    trained_free(&point_training);
    return remove_folder(state);
}

/* A reduced model, its solver, and the solution of a contact. */
typedef struct solved {
    online_model *model;
    online_solver *solver;
    online_result result;
} solved;

static void solve(solved *self, const ehd_contact *contact) {
    check_ok(online_open(&self->model, path, NULL, &error));
    check_ok(online_prepare_fields(self->model, &error));
    check_ok(online_solver_create(&self->solver, self->model, &error));
    check_ok(online_solve(&self->result, self->solver, contact, &error));
}

static void solved_free(solved *self) {
    online_solver_free(self->solver);
    online_close(self->model);
}

/* Checks that the result is the full model's own solution. */
static void check_solution(const fallback *found, const ehd_contact *contact) {
    const full_settings settings = full_default_settings();
    problem expected;
    problem_solve_cold(&expected, contact, &settings);
    const size_t num_nodes = contact->grid.num_nodes;

    assert_string_equal(found->reason, "");
    assert_int_equal(found->status, EHD_OK);
    check_close_array(found->state.pressure, expected.state.pressure, num_nodes, 0, 1e-8);
    check_close_array(found->state.film, expected.state.film, num_nodes, 0, 1e-8);
    const run_result result = fallback_result(found, contact, true);
    const contact_scalars scalars = full_evaluate_scalars(&expected.state, contact);
    check_close(result.scalars.central_film_thickness, scalars.central_film_thickness, 1e-8, 0);
    check_close(result.scalars.exit_position, scalars.exit_position, 0, 1e-8);
    assert_true((result.exits == NULL) == (contact->kind->dimensions == 1));
    if (result.exits)
        check_close(result.exits[grid_whole(&contact->grid).inner_lines / 2], scalars.exit_position,
                    0, 1e-8);
    check_close(result.indicated_deviation, 0, 0, 0);
    check_close(result.indicated_deviation_minimum, 0, 0, 0);
    assert_int_equal(result.status, EHD_OK);
    problem_free(&expected);
}

/* Solves with the full model after the reduced model. Checks whether the full model starts from the
 * reduced solution. Returns its number of Newton iterations. */
static size_t check_fallback(const solved *run, const ehd_contact *contact, size_t repetitions,
                             bool from_reduced) {
    fallback found;

    check_ok(fallback_solve(&found, run->solver, &run->result, contact, repetitions, &error));
    assert_int_equal(found.from_reduced, from_reduced);
    check_solution(&found, contact);
    const size_t iterations = found.info.newton_iterations;
    fallback_free(&found);
    return iterations;
}

static void from_a_reduced_solution(void **state) {
    (void)state;
    for (int kind = 0; kind < 2; kind++) {
        ehd_contact contact = training.contacts[4];
        solved run;
        contact_set_moes(&contact, 25, 7); // outside of the training
        rows_model_write(&bases[kind], rows, FEW_ROWS, path);
        solve(&run, &contact);
        assert_int_equal(run.result.status, EHD_UNTRUSTED);
        check_fallback(&run, &contact, 1, true);
        solved_free(&run);
    }
}

/* If the full model starts from a good reduced solution, it must take at most three Newton
 * iterations in each repetition. */
static void from_a_good_solution_it_takes_little(void **state) {
    (void)state;
    ehd_contact contact = training.contacts[4];
    solved run;

    contact_set_moes(&contact, 12, 3);
    whole_model_write(&bases[1], path);
    solve(&run, &contact);
    assert_int_equal(run.result.status, EHD_OK);
    assert_true(check_fallback(&run, &contact, 3, true) <= 3);
    solved_free(&run);
}

static void of_a_point_contact(void **state) {
    (void)state;
    ehd_contact contact = point_training.contacts[4];
    solved run;

    contact_set_moes(&contact, 23, 5);
    whole_model_write(&point_basis, path);
    solve(&run, &contact);
    assert_int_equal(run.result.status, EHD_UNTRUSTED);
    check_fallback(&run, &contact, 1, true);
    solved_free(&run);
}

/* The full model starts cold if the reduced solution did not converge or has no finite approach. */
static void it_starts_cold_where_there_is_no_solution_to_start_from(void **state) {
    (void)state;
    ehd_contact contact = training.contacts[4];
    solved run;

    contact_set_moes(&contact, 12, 3);
    rows_model_write(&bases[1], rows, FEW_ROWS, path);
    solve(&run, &contact);
    run.result.status = EHD_NOT_CONVERGED;
    check_fallback(&run, &contact, 1, false);

    run.result.status = EHD_UNTRUSTED;
    run.result.scalars.rigid_approach = NAN;
    check_fallback(&run, &contact, 1, false);
    solved_free(&run);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(from_a_reduced_solution),
        cmocka_unit_test(from_a_good_solution_it_takes_little),
        cmocka_unit_test(of_a_point_contact),
        cmocka_unit_test(it_starts_cold_where_there_is_no_solution_to_start_from),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
