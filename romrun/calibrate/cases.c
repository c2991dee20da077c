/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/calibrate/cases.h"

#include "common/output/grid_file.h"
#include "common/program/arena.h"
#include "common/settings/scene_contact.h"
#include "common/training/pool.h"
#include "romrun/calibrate/reduced_result.h"
#include "romrun/online/online.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { NUM_SIZES = 2 }; // the sizes asked for, and the most accurate ones

/* A model at some sizes. */
typedef struct sized_model {
    online_model *model; // NULL: there is none
    const char *unchecked;
} sized_model;

typedef struct batch {
    const cases_task *task;
    const case_list *list;
    sized_model models[NUM_SIZES];
    size_t num_parts;      // of the model
    ehd_contact *contacts; // [cases], made before any is solved
    case_row *rows;
    size_t num_done;
    progress progress;
} batch;

/* What a thread has. */
typedef struct worker {
    online_solver *solvers[NUM_SIZES];
} worker;

// ---- the model

static ehd_status open_models(batch *self, ehd_error *error) {
    const cases_task *task = self->task;
    const part_sizes *const sizes[NUM_SIZES] = {&task->sizes, &task->most_accurate};
    ehd_status status = EHD_OK;

    for (int m = 0; m < NUM_SIZES && !status; m++) {
        const bool same = m > 0 && memcmp(sizes[m], sizes[0], sizeof *sizes[0]) == 0;
        if (m > 0 && (same || sizes[m]->of[0].pressure_modes == 0)) continue;
        status = online_open(&self->models[m].model, task->model, sizes[m], error);
        if (status) break;
        const online_properties properties = online_describe(self->models[m].model);
        self->models[m].unchecked = online_unchecked(&properties, false);
        self->num_parts = properties.parts;
    }
    return status;
}

static void close_models(batch *self) {
    for (int m = 0; m < NUM_SIZES; m++)
        online_close(self->models[m].model);
}

// ---- a case

static ehd_status make_contact(ehd_contact *contact, const batch *self, size_t index,
                               ehd_error *error) {
    scene given;
    ehd_status status = case_list_scene(&given, self->list, index, error);

    if (status) return status;
    if (strcmp(given.regime, "stationary") != 0) {
        ehd_fail(error, EHD_DATA, "regime: found %s with --cases, expected stationary",
                 given.regime);
        return case_list_fail(self->list, index, error);
    }
    status = scene_check_kind(&given, online_kind(self->models[0].model), self->task->model, error);
    if (!status) status = scene_check_reducible(&given, error);
    if (!status) status = scene_contact(contact, &given, error);
    if (!status) {
        const ehd_grid *grid = online_grid_for(self->models[0].model, contact);
        contact_take_grid(contact, grid);
        status = grid_check(&contact->grid, "the scene", grid, self->task->model, error);
    }
    return status == EHD_DATA ? case_list_fail(self->list, index, error) : status;
}

/* Of a scene that slides, from the model's few nodes; one of before has none. */
static void add_traction(case_row *row, online_solver *solver, const ehd_contact *contact) {
    if (!contact_has_traction(contact)) return;
    const contact_traction found = online_traction(solver, contact);
    row->friction_coefficient = found.coefficient;
    row->friction_force = found.friction * contact->load;
    row->power_loss = found.power * contact->load * contact->speed;
    row->rolling_resistance = found.rolling_resistance * contact->load;
    row->rolling_moment = found.rolling_moment * contact->load * contact->half_width;
    row->mean_shear_stress = found.mean_stress * contact->hertz_pressure;
    row->largest_shear_stress = found.largest_stress * contact->hertz_pressure;
    row->indicated_deviation_friction = online_indicate_friction(solver, contact, found.friction);
}

/* With one of the models; *trusted: no other one is needed. */
static ehd_status solve_with(case_row *row, bool *trusted, const batch *self, const worker *own,
                             int m, const ehd_contact *contact, ehd_error *error) {
    const cases_task *task = self->task;
    online_indications others;
    online_result solution;
    ehd_status status = online_solve(&solution, own->solvers[m], contact, error);
    if (status) return status;

    run_result result = reduced_result(&solution);
    if (accuracy_limits_any(task->limits)) {
        others = online_indicate(own->solvers[m], contact);
        result.indicated = others.deviation;
    }
    reduced_result_judge(&result, self->models[m].unchecked, task->accuracy, task->limits);
    *trusted = !result.status;
    if (*trusted && m == 0 && own->solvers[1]) {
        run_result peak = result;
        accuracy_judge_peak(&peak, task->accuracy, online_indicate_peak(own->solvers[m]));
        *trusted = !peak.status;
    }
    const double before = isnan(row->solve_seconds) ? 0 : row->solve_seconds;
    *row = case_row_of(contact);
    row->status = result_stored_status(result.status);
    if (self->num_parts > 1) row->part = (int64_t)solution.part;
    row->newton_iterations = (int64_t)result.newton_iterations;
    row->residual_norm = result.residual;
    row->solve_seconds = before + result.seconds;
    memcpy(row->reason, result.reason, sizeof row->reason);
    if (result.status == EHD_NOT_CONVERGED) return EHD_OK; // no numbers to be used
    row->central_film_thickness = result.central_film_thickness;
    row->minimum_film_thickness = result.minimum_film_thickness;
    row->central_pressure = result.central_pressure;
    row->peak_pressure = solution.peak_pressure;
    row->rigid_approach = result.rigid_approach;
    row->exit_position = result.exit_position;
    row->indicated_deviation = result.indicated_deviation;
    row->indicated_deviation_minimum = result.indicated_deviation_minimum;
    add_traction(row, own->solvers[m], contact);
    return EHD_OK;
}

// ---- the threads

static void end(void *made) {
    worker *own = made;

    for (int m = 0; own && m < NUM_SIZES; m++)
        online_solver_free(own->solvers[m]);
    free(own);
}

static ehd_status begin(void **made, void *shared, ehd_error *error) {
    const batch *self = shared;
    worker *own = *made = calloc(1, sizeof *own);
    ehd_status status =
        own ? EHD_OK : ehd_fail(error, EHD_MEMORY, "--cases: found no memory for a solver");

    for (int m = 0; m < NUM_SIZES && !status; m++) {
        if (!self->models[m].model) continue;
        status = online_solver_create(&own->solvers[m], self->models[m].model, error);
        if (!status && self->task->accuracy > 0)
            online_solver_set_tolerance(own->solvers[m], accuracy_tolerance(self->task->accuracy));
    }
    if (status) {
        end(own);
        *made = NULL;
    }
    return status;
}

static ehd_status solve(void *shared, void *made, size_t point, size_t parent, ehd_error *error) {
    const batch *self = shared;
    const worker *own = made;
    case_row *row = &self->rows[point];
    bool trusted = false;
    ehd_status status = EHD_OK;

    (void)parent;
    row->solve_seconds = NAN;
    for (int m = 0; m < NUM_SIZES && !trusted && !status; m++)
        if (own->solvers[m]) {
            status = solve_with(row, &trusted, self, own, m, &self->contacts[point], error);
            if (status == EHD_DATA) case_list_fail(self->list, point, error);
        }
    return status;
}

static ehd_status finish(void *shared, void *made, size_t point, size_t parent, ehd_error *error) {
    batch *self = shared;

    (void)made, (void)point, (void)parent, (void)error;
    progress_show(&self->progress, ++self->num_done, "cases");
    return EHD_OK;
}

// ---- all

/* A row that is no contact is refused before others are solved. */
static ehd_status make_contacts(batch *self, ehd_error *error) {
    const size_t count = case_list_count(self->list);
    bool any_slides = false;
    ehd_status status = EHD_OK;

    self->contacts = array_new(count, 1, sizeof *self->contacts);
    if (!self->contacts)
        return ehd_fail(error, EHD_MEMORY, "--cases: found no memory for %zu scenes", count);
    for (size_t i = 0; i < count && !status; i++) {
        status = make_contact(&self->contacts[i], self, i, error);
        any_slides = any_slides || (!status && contact_has_traction(&self->contacts[i]));
    }
    if (!status && any_slides && !online_has_traction(self->models[0].model))
        program_note(
            self->task->caller,
            "%s: found a model without nodes for traction, expected one that deimselect of "
            "this version has made: the table has no friction",
            self->task->model);
    return status;
}

static void summarize(cases_summary *summary, const case_row *rows, size_t count) {
    int64_t worst = 0;

    for (size_t i = 0; i < count; i++) {
        const bool unsolved = rows[i].status == result_stored_status(EHD_NOT_CONVERGED);
        summary->num_unsolved += unsolved;
        summary->num_untrusted += rows[i].status && !unsolved;
        if (rows[i].status && (!worst || (unsolved && summary->num_unsolved == 1))) {
            worst = rows[i].status;
            summary->first = i;
        }
    }
}

ehd_status cases_solve(case_row *rows, const contact_kind **kind, ehd_grid *grid,
                       cases_summary *summary, const case_list *list, const cases_task *task,
                       ehd_error *error) {
    batch self = {.task = task, .list = list, .rows = rows};
    const size_t count = case_list_count(list);
    const pool_work work = {.num_points = count,
                            .num_workers = task->num_jobs,
                            .shared = &self,
                            .begin = begin,
                            .end = end,
                            .solve = solve,
                            .finish = finish};
    ehd_status status = open_models(&self, error);

    *summary = (cases_summary){0};
    if (!status) {
        *kind = online_kind(self.models[0].model);
        *grid = *online_grid(self.models[0].model);
        status = make_contacts(&self, error);
    }
    if (!status) {
        const double started = program_seconds();
        progress_start(&self.progress, task->caller, count);
        status = pool_run(&work, error);
        progress_finish(&self.progress);
        summary->seconds = program_seconds() - started;
    }
    if (status == EHD_INTERRUPTED)
        ehd_fail(error, status, "--cases: interrupted after %zu of %zu", self.num_done, count);
    if (!status) summarize(summary, rows, count);
    free(self.contacts);
    close_models(&self);
    return status;
}
