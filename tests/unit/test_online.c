/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The library: opening a model and solving contacts with it. Transient steps are tested in
 * test_online_transient.c. */
#include "romrun/online/online.h"
#include "tests/unit/allocation.h"
#include "tests/unit/check.h"
#include "tests/unit/folder.h"
#include "tests/unit/foreign.h"
#include "tests/unit/reduced_problem.h"

#include <gsl/gsl_errno.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NUM_ROWS = FEW_ROWS };

static trained training;
static reduced_basis bases[2];
static size_t rows[NUM_ROWS];
static char path[128];
static ehd_error error;

#define check_ok(call) assert_string_equal(((call) == EHD_OK) ? "" : error.text, "")

static int set_up(void **state) {
    if (make_folder(state)) return -1;
    snprintf(path, sizeof path, "%s/model.h5", folder);
    trained_few_init(&training, bases, rows);
    return 0;
}

static int tear_down(void **state) {
    trained_few_free(&training, bases);
    return remove_folder(state);
}

typedef struct library_run {
    const online_model *model;
    online_result results[8];
    ehd_status status;
} library_run;

static void *solve_many(void *argument) {
    library_run *run = argument;
    online_solver *solver = NULL;

    run->status = online_solver_create(&solver, run->model, NULL);
    for (size_t i = 0; i < 8 && !run->status; i++) {
        ehd_contact contact = training.contacts[0];
        contact_set_moes(&contact, 9 + (double)i, 3);
        run->status = online_solve(&run->results[i], solver, &contact, NULL);
    }
    online_solver_free(solver);
    return NULL;
}

/* Checks that two runs are equal except for their times. */
static void check_same_results(const library_run *a, const library_run *b) {
    assert_int_equal(a->status, EHD_OK);
    assert_int_equal(b->status, EHD_OK);
    for (size_t i = 0; i < 8; i++) {
        const online_result *p = &a->results[i], *q = &b->results[i];
        assert_int_equal(p->status, EHD_OK);
        assert_int_equal(q->iterations, p->iterations);
        check_close(q->scalars.central_film_thickness, p->scalars.central_film_thickness, 0, 0);
        check_close(q->scalars.minimum_film_thickness, p->scalars.minimum_film_thickness, 0, 0);
        check_close(q->scalars.rigid_approach, p->scalars.rigid_approach, 0, 0);
        check_close(q->scalars.exit_position, p->scalars.exit_position, 0, 0);
        check_close(q->residual, p->residual, 0, 0);
    }
}

static void two_threads_give_the_same_bits(void **state) {
    (void)state;
    for (int kind = 0; kind < 2; kind++) {
        online_model *model;
        rows_model_write(&bases[kind], rows, NUM_ROWS, path);
        check_ok(online_open(&model, path, NULL, &error));
        library_run alone = {.model = model}, runs[2] = {{.model = model}, {.model = model}};
        pthread_t threads[2];
        solve_many(&alone);
        for (int i = 0; i < 2; i++)
            assert_int_equal(pthread_create(&threads[i], NULL, solve_many, &runs[i]), 0);
        for (int i = 0; i < 2; i++)
            pthread_join(threads[i], NULL);
        check_same_results(&runs[0], &alone);
        check_same_results(&runs[1], &alone);
        assert_null(online_close(model));
    }
}

static void the_library_says_what_it_solved(void **state) {
    (void)state;
    size_t num_nodes = training.set.grid.num_nodes;
    double *pressure = calloc(2 * num_nodes, sizeof *pressure), *film = pressure + num_nodes;
    const model_sizes sizes = {8, 0, 35};
    online_model *model;
    online_solver *solver;
    online_result result;

    for (size_t s = 0; s < TRAINED_STATES; s++)
        bases[1].states.effects[s].of[EFFECT_STEP] = -0.02;
    rows_model_write(&bases[1], rows, NUM_ROWS, path);
    check_ok(online_open(&model, path, &(part_sizes){{sizes}}, &error));
    online_properties properties = online_describe(model);
    assert_int_equal(properties.pressure_modes, 8);
    assert_int_equal(properties.rows, 35);
    assert_int_equal(properties.unknowns, 9);
    assert_int_equal(properties.states, TRAINED_STATES);
    assert_string_equal(properties.discretization, "accurate");

    ehd_contact contact = training.contacts[4];
    contact_set_moes(&contact, 12, 3);
    check_ok(online_solver_create(&solver, model, &error));
    assert_int_equal(online_fields(pressure, film, solver, &error), EHD_INTERNAL);
    assert_non_null(strstr(error.text, "expected online_prepare_fields before"));
    check_ok(online_prepare_fields(model, &error));
    check_ok(online_prepare_fields(model, &error)); // a second call is harmless
    check_ok(online_solve(&result, solver, &contact, &error));
    assert_string_equal(result.reason, "");
    check_ok(online_fields(pressure, film, solver, &error));
    const double least = trained_least_film(film, &training.set.grid);
    double load = 0;
    for (size_t k = 0; k < num_nodes; k++)
        load += training.set.grid.step * pressure[k] / contact.kind->load;
    check_close(film[81], result.scalars.central_film_thickness, 1e-11, 0); // X = 0
    check_close(pressure[81], result.scalars.central_pressure, 1e-11, 0);
    check_close(least, result.scalars.minimum_film_thickness, 1e-11, 0);
    check_close(load, result.scalars.load, 1e-11, 0);
    const film_effects effects = online_effects(model, &contact);
    check_close(effects.of[EFFECT_STEP], 0.02, 1e-12, 0);
    assert_true(isnan(effects.of[EFFECT_STEP_MINIMUM]) && isnan(effects.of[EFFECT_INLET]));

    // both the check of all nodes and the solver find a pressure beyond the law's limit
    contact.lubricant.pressure_limit =
        0.98 * result.scalars.central_pressure * contact.hertz_pressure;
    online_result beyond = result;
    online_judge_pressure(&beyond, &contact, pressure, num_nodes);
    assert_int_equal(beyond.status, EHD_NOT_CONVERGED);
    check_ok(online_solve(&beyond, solver, &contact, &error));
    assert_int_equal(beyond.status, EHD_NOT_CONVERGED);
    assert_non_null(strstr(beyond.reason, "beyond the limit of the viscosity law"));
    // a rejected solution has no error estimates
    assert_true(isnan(online_indicate(solver, &contact).bound[INDICATED_PRESSURE]));
    contact.lubricant.pressure_limit = INFINITY;
    // a solution is rejected if a pressure is NaN or too far below zero
    const double strange[] = {NAN, -1.1e-3, -0.9e-3};
    for (size_t i = 0; i < 3; i++) {
        online_result judged = result;
        pressure[20] = strange[i];
        online_judge_pressure(&judged, &contact, pressure, num_nodes);
        assert_int_equal(judged.status, i < 2 ? EHD_NOT_CONVERGED : EHD_OK);
    }

    // a contact outside of the trained range is solved, but untrusted
    contact_set_moes(&contact, 25, 3);
    check_ok(online_solve(&result, solver, &contact, &error));
    assert_int_equal(result.status, EHD_UNTRUSTED);
    assert_non_null(strstr(result.reason, "trained range"));
    // a different grid is refused
    const ehd_grid *grid = &training.set.grid;
    contact.grid = grid_like(grid, grid->x_min, grid->step, grid->inner_x + 1, 1);
    assert_int_equal(online_solve(&result, solver, &contact, &error), EHD_DATA);
    assert_non_null(strstr(error.text, "grid: found a line contact"));
    online_solver_free(solver);
    online_close(model);
    free(pressure);

    snprintf(path + strlen(path), 3, "no");
    assert_int_equal(online_open(&model, path, NULL, &error), EHD_NOINPUT);
    assert_null(model);
    path[strlen(path) - 2] = '\0';
    assert_null(online_close(NULL));
    assert_null(online_solver_free(NULL));
}

// ---- effects on the process that calls the library

enum { NUM_CONTACTS = 8 };

typedef struct fields_run {
    const online_model *model;
    double *pressure, *film; // [NUM_CONTACTS, num_nodes]
    ehd_status status;
} fields_run;

/* Makes all calls that a thread may make with a model. */
static void *use_all(void *argument) {
    fields_run *run = argument;
    const size_t num_nodes = training.set.grid.num_nodes;
    online_solver *solver = NULL;
    double exit;

    run->status = online_solver_create(&solver, run->model, NULL);
    for (size_t i = 0; i < NUM_CONTACTS && !run->status; i++) {
        ehd_contact contact = training.contacts[0];
        double *pressure = run->pressure + i * num_nodes;
        online_result result;
        contact_set_moes(&contact, 9 + (double)i, 3);
        run->status = online_solve(&result, solver, &contact, NULL);
        if (!run->status)
            run->status = online_fields(pressure, run->film + i * num_nodes, solver, NULL);
        if (run->status) break;
        online_judge_pressure(&result, &contact, pressure, num_nodes);
        online_indicate(solver, &contact);
        online_effects(run->model, &contact);
        online_exits(&exit, solver);
    }
    online_solver_free(solver);
    return NULL;
}

static void fields_run_init(fields_run *self, const online_model *model) {
    const size_t count = NUM_CONTACTS * training.set.grid.num_nodes;

    *self = (fields_run){model, calloc(count, sizeof(double)), calloc(count, sizeof(double)), 0};
    assert_true(self->pressure && self->film);
}

static void fields_run_free(fields_run *self) {
    free(self->pressure);
    free(self->film);
}

static void handler_of_host(const char *reason, const char *file, int line, int code) {
    fail_msg("%s:%d: %s (%d)", file, line, reason, code);
}

/* On an error GSL calls a handler, and the default handler ends the process. The library must leave
 * the handler that the calling program has set. */
static void the_process_keeps_what_it_has_set(void **state) {
    static const char text[] = "contact: line\nregime: stationary\nmoes: {M: 12, L: 3}\n"
                               "lubricant: {viscosity: {law: wlf, preset: no1}}\n";
    gsl_error_handler_t *const before = gsl_set_error_handler(handler_of_host);
    online_model *model;
    ehd_contact contact;
    fields_run run;
    scene given;
    (void)state;

    check_ok(scene_parse(&given, text, strlen(text), "scene", NULL, 0, &error));
    check_ok(scene_contact(&contact, &given, &error));
    rows_model_write(&bases[1], rows, NUM_ROWS, path);
    check_ok(online_open(&model, path, NULL, &error));
    check_ok(online_prepare_transient(model, &error));
    fields_run_init(&run, model);
    use_all(&run);
    assert_int_equal(run.status, EHD_OK);
    fields_run_free(&run);
    online_close(model);
    assert_ptr_equal(gsl_set_error_handler(before), handler_of_host);
}

/* HDF5, FFTW and GSL may end the process, so calls with a loaded model must not use them. Also
 * checks that two threads at the same time give the same bits as one thread. */
static void a_loaded_model_calls_no_library_that_may_end_the_process(void **state) {
    (void)state;
    for (int kind = 0; kind < 2; kind++) {
        const size_t bytes = NUM_CONTACTS * training.set.grid.num_nodes * sizeof(double);
        fields_run runs[3];
        pthread_t threads[2];
        online_model *model;
        rows_model_write(&bases[kind], rows, NUM_ROWS, path);
        check_ok(online_open(&model, path, NULL, &error));
        check_ok(online_prepare_fields(model, &error));
        online_release_file(model);
        for (int i = 0; i < 3; i++)
            fields_run_init(&runs[i], model);
        foreign_forbid();
        for (int i = 0; i < 2; i++)
            assert_int_equal(pthread_create(&threads[i], NULL, use_all, &runs[i]), 0);
        for (int i = 0; i < 2; i++)
            pthread_join(threads[i], NULL);
        use_all(&runs[2]);
        online_close(model);
        foreign_allow();
        for (int i = 0; i < 3; i++) {
            assert_int_equal(runs[i].status, EHD_OK);
            assert_memory_equal(runs[i].pressure, runs[2].pressure, bytes);
            assert_memory_equal(runs[i].film, runs[2].film, bytes);
        }
        for (int i = 0; i < 3; i++)
            fields_run_free(&runs[i]);
    }
}

static void refused_memory_is_said(void **state) {
    online_model *model;
    fields_run run;
    size_t call = 0;
    (void)state;

    rows_model_write(&bases[1], rows, NUM_ROWS, path);
    check_ok(online_open(&model, path, NULL, &error));
    for (;; call++) {
        allocation_fail_at(call);
        const ehd_status status = online_prepare_fields(model, &error);
        if (!allocation_failed()) break;
        assert_int_equal(status, EHD_MEMORY);
    }
    assert_true(call > 5);
    fields_run_init(&run, model);
    for (call = 0;; call++) {
        allocation_fail_at(call);
        use_all(&run);
        if (!allocation_failed()) break;
        assert_int_equal(run.status, EHD_MEMORY);
    }
    assert_int_equal(run.status, EHD_OK);
    assert_true(call > 5);
    fields_run_free(&run);
    online_close(model);
}

static void fields_are_those_of_the_file_that_was_opened(void **state) {
    const size_t bytes = NUM_CONTACTS * training.set.grid.num_nodes * sizeof(double);
    fields_run runs[2];
    online_model *model;
    (void)state;

    rows_model_write(&bases[1], rows, NUM_ROWS, path);
    for (int other = 0; other < 2; other++) {
        check_ok(online_open(&model, path, NULL, &error));
        // the file is replaced by another model, which has the same rows and fewer modes
        reduced_basis fewer = bases[1];
        fewer.num_pressure--;
        if (other) rows_model_write(&fewer, rows, NUM_ROWS, path);
        check_ok(online_prepare_fields(model, &error));
        online_release_file(model);
        fields_run_init(&runs[other], model);
        use_all(&runs[other]);
        assert_int_equal(runs[other].status, EHD_OK);
        online_close(model);
    }
    assert_memory_equal(runs[0].pressure, runs[1].pressure, bytes);
    assert_memory_equal(runs[0].film, runs[1].film, bytes);
    for (int other = 0; other < 2; other++)
        fields_run_free(&runs[other]);
}

static void a_released_file_is_not_read(void **state) {
    online_model *model;
    (void)state;

    rows_model_write(&bases[1], rows, NUM_ROWS, path);
    check_ok(online_open(&model, path, NULL, &error));
    online_release_file(model);
    assert_int_equal(online_prepare_fields(model, &error), EHD_INTERNAL);
    assert_non_null(strstr(error.text, "found a model whose file was released"));
    assert_int_equal(online_prepare_transient(model, &error), EHD_INTERNAL);
    online_close(model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(two_threads_give_the_same_bits),
        cmocka_unit_test(the_library_says_what_it_solved),
        cmocka_unit_test(a_loaded_model_calls_no_library_that_may_end_the_process),
        cmocka_unit_test(refused_memory_is_said),
        cmocka_unit_test(the_process_keeps_what_it_has_set),
        cmocka_unit_test(fields_are_those_of_the_file_that_was_opened),
        cmocka_unit_test(a_released_file_is_not_read),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
