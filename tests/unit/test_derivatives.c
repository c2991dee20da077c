/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Derivatives of reduced solutions, compared with difference quotients of neighbouring solutions.
 * Transient derivatives are tested in test_online_transient.c. */
#include "romrun/online/online.h"
#include "tests/unit/allocation.h"
#include "tests/unit/check.h"
#include "tests/unit/folder.h"
#include "tests/unit/reduced_problem.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static char path[128];
static ehd_error error;

#define check_ok(call) assert_string_equal(((call) == EHD_OK) ? "" : error.text, "")

static int set_up(void **state) {
    if (make_folder(state)) return -1;
    snprintf(path, sizeof path, "%s/model.h5", folder);
    return 0;
}

static int tear_down(void **state) {
    return remove_folder(state);
}

// ---- kinds of models

typedef struct problem {
    trained training;
    online_model *model;
    online_solver *solver;
    ehd_contact contact;
} problem;

static problem tested;

/* Makes a model with one mode for each node and all rows; the residuals of its solutions vanish.
 * Sets a contact between the training points, and a tolerance near round-off. */
static void problem_init(problem *self, deformation_kind kind) {
    const size_t num_nodes = self->training.set.grid.num_nodes;
    double *weight = malloc(num_nodes * sizeof *weight);
    reduced_basis basis;

    for (size_t k = 0; k < num_nodes; k++)
        weight[k] = 1;
    basis = identity_basis(&self->training.set, kind, weight);
    whole_model_write(&basis, path);
    reduced_basis_free(&basis);
    free(weight);
    check_ok(online_open(&self->model, path, NULL, &error));
    check_ok(online_solver_create(&self->solver, self->model, &error));
    online_solver_set_tolerance(self->solver, 1e-14);
    self->contact = self->training.contacts[4];
    self->contact.approach_length = 10;
    contact_set_moes(&self->contact, 12, 4.4);
}

static void problem_free(problem *self) {
    online_solver_free(self->solver);
    online_close(self->model);
    trained_free(&self->training);
}

// ---- differences

enum { BY_LOAD, BY_SPEED, BY_RADIUS, BY_MODULUS, NUM_BY };

static online_derivatives solve_beside(problem *self, int by, double change) {
    double values[NUM_BY] = {1, 1, 1, 1};
    ehd_contact contact;
    online_result result;

    values[by] += change;
    const double ordered[NUM_VARY] = {[VARY_LOAD] = values[BY_LOAD],
                                      [VARY_SPEED] = values[BY_SPEED],
                                      [VARY_RADIUS] = values[BY_RADIUS],
                                      [VARY_MODULUS] = values[BY_MODULUS]};
    const contact_frame frame = frame_at(self->contact.kind, 0, ordered, NAN);
    frame_contact(&contact, &frame, &self->contact);
    contact.lambda *= contact.entrainment;
    contact.entrainment = contact.far_speed = 1;
    check_ok(online_solve(&result, self->solver, &contact, &error));
    assert_int_not_equal(result.status, EHD_NOT_CONVERGED);
    return (online_derivatives){.scalars =
                                    frame_to_reference(&result.scalars, &frame, &self->contact),
                                .peak_pressure = result.peak_pressure * frame.hertz_pressure,
                                .half_width = frame.half_width};
}

static void check_all_close(const online_derivatives *found, const online_derivatives *expected) {
    // the difference quotients themselves are accurate to 1e-6
    const double relative = 3e-6, absolute = 3e-7;
    const contact_scalars *f = &found->scalars, *e = &expected->scalars;

    check_close(f->central_film_thickness, e->central_film_thickness, relative, absolute);
    check_close(f->minimum_film_thickness, e->minimum_film_thickness, relative, absolute);
    check_close(f->central_pressure, e->central_pressure, relative, absolute);
    check_close(f->rigid_approach, e->rigid_approach, relative, absolute);
    check_close(f->load, e->load, relative, absolute);
    check_close(found->half_width, expected->half_width, relative, absolute);
    // in a point contact the pressure maximum has a kink at a node, so the tolerance is larger
    check_close(found->peak_pressure, expected->peak_pressure, relative, 3e-5);
}

/* Returns the central difference quotient of two solutions. Their parameters differ by 2
 * `change`. */
static online_derivatives difference(const online_derivatives *before,
                                     const online_derivatives *behind, double change) {
    online_derivatives found = {.half_width = 0};
    const double *from = (const double *)before, *to = (const double *)behind;

    for (size_t k = 0; k < sizeof found / sizeof(double); k++)
        ((double *)&found)[k] = (to[k] - from[k]) / (2 * change);
    return found;
}

static online_derivatives differentiate(problem *self, const online_direction *direction) {
    online_derivatives found;

    check_ok(online_differentiate(&found, self->solver, &self->contact, direction, &error));
    return found;
}

static void solve_here(problem *self) {
    online_result result;

    check_ok(online_solve(&result, self->solver, &self->contact, &error));
    assert_int_not_equal(result.status, EHD_NOT_CONVERGED);
}

/* Checks relations between the derivatives of one solution at a given load and at a given approach.
 * If the approach is given, the load is a result. */
static void check_exchange(problem *self, const online_derivatives *by_load) {
    const online_direction by_approach = {.load = NAN, .approach = 1};
    const online_direction by_speed = {.load = NAN, .approach = 0, .speed = 1};
    const online_derivatives nearer = differentiate(self, &by_approach);
    const online_derivatives faster = differentiate(self, &by_speed);
    const double compliance = by_load->scalars.rigid_approach;
    online_response response;

    check_close(nearer.scalars.rigid_approach, 1, 1e-9, 0);
    check_close(nearer.scalars.load, 1 / compliance, 1e-7, 0);
    check_close(nearer.scalars.central_film_thickness,
                by_load->scalars.central_film_thickness / compliance, 1e-6, 1e-9);
    check_close(faster.scalars.rigid_approach, 0, 0, 1e-9);
    assert_true(faster.scalars.load > 0);
    check_ok(online_respond(&response, self->solver, &self->contact, &error));
    check_close(response.stiffness, -1 / compliance, 1e-7, 0);
    assert_true(response.damping > 0);
}

/* Checks that derivatives do not change the solver's last solution. */
static void check_left_alone(problem *self) {
    const online_direction by_load = {.load = 1, .approach = NAN};
    online_indications before, behind;

    before = online_indicate(self->solver, &self->contact);
    differentiate(self, &by_load);
    behind = online_indicate(self->solver, &self->contact);
    assert_memory_equal(behind.bound, before.bound, sizeof before.bound);
}

/* Checks that the derivatives of the next solution equal the derivatives that another solver
 * computes. */
static void check_follows(problem *self) {
    const online_direction by_load = {.load = 1, .approach = NAN};
    const online_derivatives before = differentiate(self, &by_load);
    online_derivatives found, expected;

    contact_set_moes(&self->contact, 12.5, 4.4);
    solve_here(self);
    found = differentiate(self, &by_load);
    online_solver_free(self->solver);
    check_ok(online_solver_create(&self->solver, self->model, &error));
    online_solver_set_tolerance(self->solver, 1e-14);
    solve_here(self);
    expected = differentiate(self, &by_load);
    assert_memory_equal(&found, &expected, sizeof found);
    assert_true(found.scalars.central_pressure != before.scalars.central_pressure);
}

static void check_problem(problem *self, deformation_kind kind) {
    const double change = 1e-3;
    const bool has_exit = self->training.set.grid.inner_lines == 1 &&
                          self->training.set.grid.discretization == DISCRETIZATION_ACCURATE;
    online_derivatives found[NUM_BY];

    problem_init(self, kind);
    solve_here(self);
    for (int by = 0; by < NUM_BY; by++) {
        const online_direction direction = {.load = by == BY_LOAD,
                                            .approach = NAN,
                                            .speed = by == BY_SPEED,
                                            .radius = by == BY_RADIUS,
                                            .modulus = by == BY_MODULUS};
        found[by] = differentiate(self, &direction);
    }
    check_exchange(self, &found[BY_LOAD]);
    check_left_alone(self);
    for (int by = 0; by < NUM_BY; by++) {
        const online_derivatives before = solve_beside(self, by, -change);
        const online_derivatives behind = solve_beside(self, by, change);
        const online_derivatives expected = difference(&before, &behind, change);
        check_all_close(&found[by], &expected);
        if (has_exit)
            check_close(found[by].scalars.exit_position, expected.scalars.exit_position, 3e-6, 0);
        else // the exit is at a node, so its position has no derivative
            assert_true(isnan(found[by].scalars.exit_position));
    }
    check_follows(self);
    problem_free(self);
}

static void derivatives_of_lines_are_those_of_differences(void **state) {
    (void)state;
    for (int kind = 0; kind < 2; kind++) {
        trained_init(&tested.training, 0.05);
        check_problem(&tested, kind ? DEFORMATION_INDEPENDENT : DEFORMATION_COUPLED);
    }
    trained_init_published(&tested.training, 0.05);
    check_problem(&tested, DEFORMATION_COUPLED);
    trained_init_thinned(&tested.training, 0.05);
    check_problem(&tested, DEFORMATION_COUPLED);
}

static void derivatives_of_points_are_those_of_differences(void **state) {
    (void)state;
    if (check_all()) {
        trained_init_point(&tested.training, true, "zero");
        check_problem(&tested, DEFORMATION_INDEPENDENT);
    }
    trained_init_point(&tested.training, true, "open");
    check_problem(&tested, DEFORMATION_COUPLED);
}

static void what_cannot_be_told_is_refused(void **state) {
    (void)state;
    const online_direction by_load = {.load = 1, .approach = NAN};
    const online_direction by_approach = {.load = NAN, .approach = 1};
    const online_direction wrong[] = {{.load = 1, .approach = 1},
                                      {.load = NAN, .approach = NAN},
                                      {.load = INFINITY, .approach = NAN},
                                      {.load = 0, .approach = NAN, .speed = NAN}};
    online_derivatives found;
    online_response response;

    trained_init(&tested.training, 0.05);
    problem_init(&tested, DEFORMATION_COUPLED);
    assert_int_equal(online_differentiate(&found, tested.solver, &tested.contact, &by_load, &error),
                     EHD_INTERNAL);
    assert_non_null(strstr(error.text, "found no solution"));
    solve_here(&tested);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        assert_int_equal(
            online_differentiate(&found, tested.solver, &tested.contact, &wrong[i], &error),
            EHD_DATA);
    // an approach may not be relative to a point inside the pressurised zone
    tested.contact.approach_length = 1;
    assert_int_equal(
        online_differentiate(&found, tested.solver, &tested.contact, &by_approach, &error),
        EHD_DATA);
    assert_non_null(strstr(error.text, "approach_length: found 1"));
    assert_int_equal(online_respond(&response, tested.solver, &tested.contact, &error), EHD_DATA);
    problem_free(&tested);
}

static void memory_may_fail(void **state) {
    (void)state;
    const online_direction by_load = {.load = 1, .approach = NAN};
    online_derivatives found;
    ehd_status status;
    size_t call = 0;

    trained_init(&tested.training, 0.05);
    problem_init(&tested, DEFORMATION_COUPLED);
    solve_here(&tested);
    do {
        allocation_fail_at(call);
        status = online_differentiate(&found, tested.solver, &tested.contact, &by_load, &error);
        if (!allocation_failed()) break;
        assert_int_equal(status, EHD_MEMORY);
    } while (call++ < 1000);
    check_ok(status);
    assert_true(call > 10);
    check_close(found.scalars.load, 1, 1e-6, 0);
    problem_free(&tested);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(derivatives_of_lines_are_those_of_differences),
        cmocka_unit_test(derivatives_of_points_are_those_of_differences),
        cmocka_unit_test(what_cannot_be_told_is_refused),
        cmocka_unit_test(memory_may_fail),
    };

    return cmocka_run_group_tests_name("derivatives", tests, set_up, tear_down);
}
