/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "snapgen/trial.h"

#include "common/training/pool.h"
#include "deimselect/row_choice.h"
#include "podbuild/bases.h"
#include "romrun/solve/guess.h"
#include "romrun/solve/reduced_solver.h"
#include "romrun/trust/indicator.h"
#include "snapgen/residuals.h"

#include <math.h>
#include <stdlib.h>

// ---- building

static ehd_status build_basis(reduced_basis *basis, const training_set *set,
                              const solved_state *states, double discarded_energy,
                              ehd_error *error) {
    const bases_settings settings = {.pressure.discarded_energy = discarded_energy,
                                     .kind = DEFORMATION_COUPLED};
    snapshot_set solutions = {0};
    pod_basis pressure = {0}, deformation = {0};
    ehd_status status =
        snapshot_set_gather(&solutions, states, set->num_points, set->kind, &set->grid, error);

    if (!status)
        status =
            bases_build(basis, &pressure, &deformation, &solutions, &settings, NULL, NULL, error);
    pod_free(&pressure);
    pod_free(&deformation);
    snapshot_set_close(&solutions);
    return status;
}

/* Solves the training points again with all rows, and collects the iterations, from which rows are
 * selected. */
static ehd_status repeat_training(residual_snapshots *snapshots, const program *caller,
                                  const training_set *set, const reduced_basis *basis,
                                  size_t num_workers, ehd_error *error) {
    reduced_model all_rows = {0};
    ehd_status status = reduced_model_build(&all_rows, basis, NULL, 0, error);

    if (!status) status = residuals_collect(snapshots, caller, set, &all_rows, num_workers, error);
    reduced_model_free(&all_rows);
    return status;
}

/* Returns the seconds since *before, and sets *before to now. */
static double seconds_since(double *before) {
    const double passed = program_seconds() - *before;

    *before += passed;
    return passed;
}

ehd_status trial_build(reduced_model *model, trial_costs *costs, const program *caller,
                       const training_set *set, const solved_state *states, double discarded_energy,
                       size_t num_workers, ehd_error *error) {
    // the defaults of deimselect
    const row_settings settings = {
        .method = selection_methods, .weights = weightings, .num_control = CONTROL_BY_ITSELF};
    program silent = *caller;
    reduced_basis basis = {0};
    residual_snapshots snapshots = {0};
    row_choice choice = {0};
    double before = program_seconds();
    ehd_status status = build_basis(&basis, set, states, discarded_energy, error);

    silent.quiet = true;
    costs->basis = seconds_since(&before);
    if (!status) status = repeat_training(&snapshots, &silent, set, &basis, num_workers, error);
    costs->residuals = seconds_since(&before);
    if (!status) status = row_choice_make(&choice, &snapshots, &basis, &settings, error);
    if (!status) status = row_choice_model(model, &choice, &basis, error);
    costs->rows = seconds_since(&before);
    row_choice_free(&choice);
    residual_snapshots_free(&snapshots);
    reduced_basis_free(&basis);
    return status;
}

// ---- judging

typedef struct judgement {
    const reduced_model *model;
    const ehd_contact *contacts;
    trial_verdict *verdicts;
} judgement;

/* Solver, error indicator and state of one thread. */
typedef struct judge {
    reduced_solver *solver;
    indicator *indicator;
    reduced_state state;
} judge;

static void end_judge(void *worker) {
    judge *self = worker;

    if (self) {
        reduced_solver_free(self->solver);
        indicator_free(self->indicator);
        reduced_state_free(&self->state);
        free(self);
    }
}

static ehd_status begin_judge(void **worker, void *shared, ehd_error *error) {
    const reduced_model *model = ((const judgement *)shared)->model;
    judge *self = calloc(1, sizeof *self);

    *worker = self;
    if (!self) return ehd_no_memory(error, "online solver");
    ehd_status status = reduced_state_init(&self->state, model, error);
    if (status) return status;
    self->indicator = indicator_create(model);
    if (!self->indicator) return ehd_no_memory(error, "online solver");
    return reduced_solver_create(&self->solver, model, &reduced_defaults, error);
}

static ehd_status judge_contact(void *shared, void *worker, size_t point, size_t parent,
                                ehd_error *error) {
    const judgement *work = shared;
    const ehd_contact *contact = &work->contacts[point];
    trial_verdict *verdict = &work->verdicts[point];
    judge *self = worker;
    reduced_info info;
    (void)parent;

    *verdict = (trial_verdict){{INFINITY, INFINITY}, {NAN, NAN}};
    ehd_status status =
        reduced_solve_from_training(&info, &self->state, self->solver, work->model, contact, error);
    if (status || info.status) return status;
    const contact_scalars *scalars = &info.scalars;
    double central = indicator_bound(self->indicator, self->solver, &self->state, contact, scalars);
    double minimum = indicator_bound_minimum(self->indicator, self->solver, scalars);
    if (isfinite(central) && isfinite(minimum))
        *verdict = (trial_verdict){
            {central, minimum}, {scalars->central_film_thickness, scalars->minimum_film_thickness}};
    return EHD_OK;
}

ehd_status trial_judge(trial_verdict *verdicts, const reduced_model *model,
                       const ehd_contact *contacts, const bool *wanted, size_t num_contacts,
                       size_t num_workers, ehd_error *error) {
    judgement shared = {model, contacts, verdicts};
    bool *done = malloc(num_contacts * sizeof *done);
    if (!done) return ehd_no_memory(error, "points");

    for (size_t i = 0; i < num_contacts; i++)
        done[i] = !wanted[i];
    const pool_work work = {.num_points = num_contacts,
                            .done = done,
                            .num_workers = num_workers,
                            .shared = &shared,
                            .begin = begin_judge,
                            .end = end_judge,
                            .repeatable = true,
                            .solve = judge_contact};
    ehd_status status = pool_run(&work, error);
    free(done);
    return status;
}
