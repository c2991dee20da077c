/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/calibrate/cases.h"

#include "common/output/grid_file.h"
#include "common/settings/scene_contact.h"
#include "common/training/pool.h"
#include "romrun/calibrate/reduced_result.h"
#include "romrun/online/online.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

enum { NUM_SIZES = 2 }; // two model sizes: the chosen and the most accurate one

/* A model opened with certain sizes. */
typedef struct sized_model {
    online_model *model;   // NULL: this model is not used
    const char *unchecked; // reason of online_unchecked; NULL: the model was checked
} sized_model;

/* Largest number of cases in memory. If this number is 30 instead of 1000, threads wait for each
 * other more often: 10,000 cases of 12 modes took 1.12 s instead of 0.94 s of processor time. */
enum { NUM_SLOTS = 1000 };

typedef struct batch {
    const cases_task *task;
    case_list *list;
    sized_model models[NUM_SIZES];
    size_t num_parts;
    case_table *table;
    // cases in memory
    case_texts texts[NUM_SLOTS];
    case_row rows[NUM_SLOTS];
    bool solved[NUM_SLOTS];
    size_t num_done;
    progress progress;
    pthread_mutex_t lock; // protects `idle`
    struct worker *idle;  // workers that wait for the next batch, as a linked list
} batch;

typedef struct worker {
    online_solver *solvers[NUM_SIZES];
    ehd_contact contact;
    bool with_effects; // true: estimate the errors due to the grid
    struct batch *shared;
    struct worker *next;
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

static ehd_status make_contact(ehd_contact *contact, bool *with_effects, const batch *self,
                               const case_texts *texts, ehd_error *error) {
    const online_model *model = self->models[0].model;
    scene given;
    ehd_status status = case_list_scene(&given, self->list, texts, error);

    if (status) return status;
    if (strcmp(given.regime, "stationary") != 0) {
        ehd_fail(error, EHD_DATA, "regime: found %s in a table of scenes, expected stationary",
                 given.regime);
        return case_list_fail(self->list, texts->line, error);
    }
    status = scene_check_kind(&given, online_kind(model), self->task->model, error);
    if (!status) status = scene_check_reducible(&given, error);
    if (!status) status = scene_contact_begin(contact, &given, error);
    if (!status) {
        const ehd_grid *grid = online_grid_for(model, contact);
        contact_take_grid(contact, grid);
        status = scene_contact_end(contact, &given, error);
        if (!status)
            status = grid_check(&contact->grid, "the scene", grid, self->task->model, error);
    }
    *with_effects = given.output.resolution != 0 || self->task->limits->rolling > 0;
    return status == EHD_DATA ? case_list_fail(self->list, texts->line, error) : status;
}

/* Adds the traction of a scene to a row if its surfaces slide. The values are NaN for models of
 * earlier versions, which have no traction nodes. */
static void add_traction(case_row *row, contact_traction found, online_solver *solver,
                         const ehd_contact *contact) {
    if (!contact_has_traction(contact)) return;
    row->friction_coefficient = found.coefficient;
    row->friction_force = found.friction * contact->load;
    row->power_loss = found.power * contact->load * contact->speed;
    row->rolling_resistance = found.rolling_resistance * contact->load;
    row->rolling_moment = found.rolling_moment * contact->load * contact->half_width;
    row->mean_shear_stress = found.mean_stress * contact->hertz_pressure;
    row->largest_shear_stress = found.largest_stress * contact->hertz_pressure;
    row->indicated_deviation_friction = online_indicate_friction(solver, contact, found.friction);
}

/* Solves a case with one of the models. *trusted: true if the result is accepted, so that no other
 * model size is needed. */
static ehd_status solve_with(bool *trusted, const batch *self, const worker *own, int m,
                             case_row *row, ehd_error *error) {
    const cases_task *task = self->task;
    const ehd_contact *contact = &own->contact;
    online_indications others;
    online_result solution;
    ehd_status status = online_solve(&solution, own->solvers[m], contact, error);
    if (status) return status;

    run_result result = reduced_result(&solution);
    const contact_traction traction = contact_has_traction(contact)
                                          ? online_traction(own->solvers[m], contact)
                                          : contact_traction_unknown();
    film_effects effects;
    if (own->with_effects) {
        effects = online_effects(self->models[m].model, contact);
        result.effects = &effects;
    }
    if (contact_has_traction(contact)) result.traction = &traction;
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
    // judged after *trusted is set, since other model sizes have the same grid
    result_judge(&result, &contact->grid);
    const double before = isnan(row->solve_seconds) ? 0 : row->solve_seconds;
    *row = case_row_of(contact);
    row->status = result_stored_status(result.status);
    if (self->num_parts > 1) row->part = (int64_t)solution.part;
    row->newton_iterations = (int64_t)result.newton_iterations;
    row->residual_norm = result.residual;
    row->solve_seconds = before + result.seconds.total;
    memcpy(row->reason, result.reason, sizeof row->reason);
    if (result.status == EHD_NOT_CONVERGED) return EHD_OK; // the numbers are not usable
    row->central_film_thickness = result.scalars.central_film_thickness;
    row->minimum_film_thickness = result.scalars.minimum_film_thickness;
    row->central_pressure = result.scalars.central_pressure;
    row->peak_pressure = solution.peak_pressure;
    row->rigid_approach = result.scalars.rigid_approach;
    row->exit_position = result.scalars.exit_position;
    row->indicated_deviation = result.indicated_deviation;
    row->indicated_deviation_minimum = result.indicated_deviation_minimum;
    add_traction(row, traction, own->solvers[m], contact);
    return EHD_OK;
}

// ---- the threads

static void free_worker(worker *own) {
    for (int m = 0; own && m < NUM_SIZES; m++)
        online_solver_free(own->solvers[m]);
    free(own);
}

static ehd_status make_worker(worker **made, const batch *self, ehd_error *error) {
    worker *own = *made = calloc(1, sizeof *own);
    ehd_status status = own ? EHD_OK : ehd_no_memory(error, "cases");

    for (int m = 0; m < NUM_SIZES && !status; m++) {
        if (!self->models[m].model) continue;
        status = online_solver_create(&own->solvers[m], self->models[m].model, error);
        if (!status && self->task->accuracy > 0)
            online_solver_set_tolerance(own->solvers[m], accuracy_tolerance(self->task->accuracy));
    }
    if (status) {
        free_worker(own);
        *made = NULL;
    }
    return status;
}

/* Takes a worker of an earlier batch, or creates one. */
static ehd_status begin(void **made, void *shared, ehd_error *error) {
    batch *self = shared;

    pthread_mutex_lock(&self->lock);
    worker *own = self->idle;
    if (own) self->idle = own->next;
    pthread_mutex_unlock(&self->lock);
    const ehd_status status = own ? EHD_OK : make_worker(&own, self, error);
    if (own) own->shared = self;
    *made = own;
    return status;
}

static void end(void *made) {
    worker *own = made;

    if (!own) return;
    pthread_mutex_lock(&own->shared->lock);
    own->next = own->shared->idle;
    own->shared->idle = own;
    pthread_mutex_unlock(&own->shared->lock);
}

static ehd_status solve(void *shared, void *made, size_t point, size_t parent, ehd_error *error) {
    batch *self = shared;
    worker *own = made;
    case_row *row = &self->rows[point];
    const case_texts *texts = &self->texts[point];
    bool trusted = false;
    ehd_status status = make_contact(&own->contact, &own->with_effects, self, texts, error);

    (void)parent;
    row->solve_seconds = NAN;
    for (int m = 0; m < NUM_SIZES && !trusted && !status; m++)
        if (own->solvers[m]) {
            status = solve_with(&trusted, self, own, m, row, error);
            if (status == EHD_DATA) case_list_fail(self->list, texts->line, error);
        }
    return status;
}

static ehd_status finish(void *shared, void *made, size_t point, size_t parent, ehd_error *error) {
    batch *self = shared;

    (void)made, (void)parent, (void)error;
    self->solved[point] = true;
    progress_show(&self->progress, ++self->num_done, "cases");
    return EHD_OK;
}

// ---- all

/* Returns a row with a value in each column that a solution of the contact may fill. */
static case_row expected_row(const batch *self, const ehd_contact *contact) {
    case_row row = case_row_of(contact);

    if (self->num_parts > 1) row.part = 0;
    if (contact_has_traction(contact) && online_has_traction(self->models[0].model)) {
        row.friction_coefficient = row.friction_force = row.power_loss = 0;
        row.rolling_resistance = row.rolling_moment = 0;
        row.mean_shear_stress = row.largest_shear_stress = 0;
        row.indicated_deviation_friction = 0;
    }
    return row;
}

/* Counts the rows, and refuses an invalid row before any case is solved. */
static ehd_status check_rows(batch *self, size_t *count, ehd_error *error) {
    bool found = true, any_slides = false, with_effects;
    ehd_contact contact;
    case_texts texts;
    ehd_status status = EHD_OK;

    for (*count = 0; !status; *count += found) {
        status = case_list_next(&texts, &found, self->list, error);
        if (status || !found) break;
        status = make_contact(&contact, &with_effects, self, &texts, error);
        case_texts_free(&texts);
        if (status) break;
        const case_row row = expected_row(self, &contact);
        case_table_expect(self->table, &row);
        any_slides = any_slides || contact_has_traction(&contact);
        if (program_interrupted())
            status = ehd_fail(error, EHD_INTERRUPTED, "cases: interrupted before the first case");
    }
    if (!status && any_slides && !online_has_traction(self->models[0].model))
        program_note(
            self->task->caller,
            "%s: found a model without nodes for traction, expected one that deimselect of "
            "this version has made: the table has no friction",
            self->task->model);
    return status;
}

static void add_to(cases_summary *summary, int64_t status, size_t line) {
    const bool unsolved = status == result_stored_status(EHD_NOT_CONVERGED);

    summary->num_cases++;
    summary->num_unsolved += unsolved;
    summary->num_untrusted += status && !unsolved;
    if (status && (summary->first == 0 || (unsolved && summary->num_unsolved == 1)))
        summary->first = line;
}

/* Skips the rows that an interrupted run has solved, and adds their status to the summary. */
static ehd_status pass_over(batch *self, size_t num_done, cases_summary *summary,
                            ehd_error *error) {
    case_texts texts;
    bool found = true;
    ehd_status status = EHD_OK;

    for (size_t i = 0; i < num_done && !status; i++) {
        int64_t of_row = 0;
        status = case_list_next(&texts, &found, self->list, error);
        if (!status) status = case_table_status(&of_row, self->table, error);
        if (!status) add_to(summary, of_row, texts.line);
        case_texts_free(&texts);
    }
    self->num_done = num_done;
    return status;
}

static ehd_status read_batch(size_t *count, batch *self, ehd_error *error) {
    bool found = true;
    ehd_status status = EHD_OK;

    for (*count = 0; *count < NUM_SLOTS && !status; ++*count) {
        self->solved[*count] = false;
        status = case_list_next(&self->texts[*count], &found, self->list, error);
        if (!found) break;
    }
    return status;
}

/* Writes the solved rows of a batch. If the batch was interrupted, writes only the rows before the
 * first unsolved row. */
static ehd_status write_batch(batch *self, size_t count, cases_summary *summary, ehd_error *error) {
    size_t num_solved = 0;

    while (num_solved < count && self->solved[num_solved])
        num_solved++;
    if (num_solved == 0) return EHD_OK;
    for (size_t i = 0; i < num_solved; i++) {
        add_to(summary, self->rows[i].status, self->texts[i].line);
        summary->max_friction =
            fmax(summary->max_friction, fabs(self->rows[i].friction_coefficient));
    }
    summary->num_solved += num_solved;
    return case_table_put(self->table, self->rows, self->texts, num_solved, error);
}

static ehd_status solve_rows(batch *self, cases_summary *summary, ehd_error *error) {
    pool_work work = {.num_workers = self->task->num_jobs,
                      .shared = self,
                      .begin = begin,
                      .end = end,
                      .solve = solve,
                      .finish = finish};
    ehd_error failure = {""};
    ehd_status status = EHD_OK;

    do {
        status = read_batch(&work.num_points, self, error);
        if (!status && work.num_points > 0) {
            const ehd_status outcome = pool_run(&work, &failure);
            status = write_batch(self, work.num_points, summary, error);
            if (outcome) status = ehd_fail(error, outcome, "%s", failure.text);
        }
        for (size_t i = 0; i < work.num_points; i++)
            case_texts_free(&self->texts[i]);
    } while (!status && work.num_points > 0);
    return status;
}

static ehd_status solve_all(batch *self, cases_summary *summary, ehd_error *error) {
    const cases_task *task = self->task;
    size_t count = 0, num_done = 0;
    ehd_status status = open_models(self, error);

    if (!status) status = case_table_new(&self->table, task->caller, error);
    if (!status) status = check_rows(self, &count, error);
    if (!status) status = case_list_rewind(self->list, error);
    if (!status)
        status =
            case_table_begin(self->table, &num_done, self->list, online_kind(self->models[0].model),
                             online_grid(self->models[0].model), task->settings_text, task->inputs,
                             task->resume, error);
    if (!status) status = pass_over(self, num_done, summary, error);
    if (!status) {
        const double started = program_seconds();
        progress_start(&self->progress, task->caller, count);
        status = solve_rows(self, summary, error);
        progress_finish(&self->progress);
        summary->seconds = program_seconds() - started;
    }
    if (status == EHD_INTERRUPTED)
        ehd_fail(error, status, "cases: interrupted after %zu of %zu%s", summary->num_cases, count,
                 task->caller->output ? "; --resume goes on" : "");
    return status ? status : case_table_finish(&self->table, error);
}

ehd_status cases_solve(cases_summary *summary, case_list *list, const cases_task *task,
                       ehd_error *error) {
    batch *self = calloc(1, sizeof *self);

    *summary = (cases_summary){0};
    if (!self) return ehd_no_memory(error, "cases");
    self->task = task;
    self->list = list;
    pthread_mutex_init(&self->lock, NULL);
    const ehd_status status = solve_all(self, summary, error);
    case_table_close(&self->table);
    for (worker *next, *own = self->idle; own; own = next) {
        next = own->next;
        free_worker(own);
    }
    pthread_mutex_destroy(&self->lock);
    close_models(self);
    free(self);
    return status;
}
