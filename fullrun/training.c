/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fullrun/training.h"

#include "common/output/grid_file.h"
#include "common/training/pool.h"
#include "fullrun/full_march.h"
#include "fullrun/resolution.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

ehd_status training_init(training *self, const program *caller, const training_set *set,
                         ehd_error *error) {
    *self = (training){.program = caller, .set = set};
    self->points = calloc(set->num_points, sizeof *self->points);
    if (self->points) return EHD_OK;
    return ehd_no_memory(error, "points");
}

void training_free(training *self) {
    for (size_t i = 0; self->points && i < self->set->num_points; i++)
        free(self->points[i].pressure);
    free(self->points);
    self->points = NULL;
}

/* Keeps a finished point. `pressure` is [num_nodes], or NULL if the point has not converged. */
static ehd_status keep_point(training *self, size_t point, const double *pressure,
                             double rigid_approach, size_t exit, ehd_error *error) {
    size_t num_nodes = self->set->grid.num_nodes;
    trained_point *kept = &self->points[point];

    if (kept->done) { // a file from another program may contain the point twice
        self->num_done--;
        self->num_failed -= kept->pressure == NULL;
        free(kept->pressure);
    }
    *kept = (trained_point){.done = true,
                            .status = pressure ? EHD_OK : EHD_NOT_CONVERGED,
                            .rigid_approach = rigid_approach,
                            .exit = exit};
    self->num_done++;
    self->num_failed += pressure == NULL;
    if (!pressure) return EHD_OK;
    kept->pressure = malloc(num_nodes * sizeof(double));
    if (!kept->pressure) return ehd_no_memory(error, "points");
    memcpy(kept->pressure, pressure, num_nodes * sizeof(double));
    return EHD_OK;
}

ehd_status training_restore(training *self, size_t point, const double *pressure,
                            double rigid_approach, size_t exit, ehd_error *error) {
    const ehd_grid *grid = &self->set->grid;
    double *all = NULL;

    if (pressure) {
        all = calloc(grid->num_nodes, sizeof *all);
        if (!all) return ehd_no_memory(error, "points");
        grid_put_inner(all, pressure, grid, false);
    }
    ehd_status status = keep_point(self, point, all, rigid_approach, exit, error);
    free(all);
    return status;
}

// ---- one thread's work

typedef struct worker {
    full_solver *solver;
    snapshot solution;
} worker;

static void end_worker(void *given) {
    worker *self = given;
    if (!self) return;
    full_solver_free(self->solver);
    full_state_free(&self->solution.state);
    free(self);
}

static ehd_status begin_worker(void **result, void *shared, ehd_error *error) {
    const training *owner = shared;
    full_settings settings = full_default_settings();
    const ehd_contact *first = &owner->set->contacts[0];
    worker *self = calloc(1, sizeof *self);
    *result = self;
    if (!self) return ehd_no_memory(error, "solver");

    // the weakest modes of a basis have singular values of 1e-10 of the first singular value, so
    // the solutions must be more accurate than that
    settings.tolerance = 1e-12;
    ehd_status status =
        full_solver_create(&self->solver, first->kind, &first->grid, &settings, error);
    return status ? status : full_state_init(&self->solution.state, &first->grid, error);
}

static ehd_status show_point(void *shared, void *given, size_t point, size_t parent,
                             ehd_error *error) {
    training *owner = shared;
    char name[POINT_NAME];
    (void)given, (void)parent, (void)error;

    training_point_name(name, &owner->set->contacts[point]);
    progress_show(&owner->progress, owner->num_done - owner->num_before, name);
    return EHD_OK;
}

static ehd_status solve_point(void *shared, void *given, size_t point, size_t parent,
                              ehd_error *error) {
    const training *owner = shared;
    const ehd_contact *contact = &owner->set->contacts[point];
    worker *self = given;
    snapshot *solution = &self->solution;
    full_state *state = &solution->state;
    full_info info;
    ehd_status status;

    if (parent != NO_PARENT && owner->points[parent].pressure) {
        const trained_point *start = &owner->points[parent];
        memcpy(state->pressure, start->pressure, contact->grid.num_nodes * sizeof(double));
        state->rigid_approach = start->rigid_approach;
        full_state_set_zone(state, &contact->grid, start->exit);
        status = full_solve_from(&info, state, self->solver, contact, error);
    } else {
        status = full_solve_cold(&info, state, self->solver, contact, error);
    }
    if (status) return status;
    solution->status = full_judge(solution->reason, &info, state, contact);
    solution->scalars = full_evaluate_scalars(state, contact);
    solution->newton_iterations = info.newton_iterations;
    solution->residual = info.residual;
    solution->complementarity = info.complementarity;
    solution->effects = film_effects_unknown();
    if (solution->status || !owner->with_effects || !owner->set->estimated[point]) return EHD_OK;
    full_resolution resolution;
    status = full_resolution_estimate(&resolution, state, contact, NULL, error);
    if (!status) solution->effects = resolution.effects;
    return status;
}

static ehd_status finish_point(void *shared, void *given, size_t point, size_t parent,
                               ehd_error *error) {
    training *owner = shared;
    const snapshot *solution = &((worker *)given)->solution;
    const full_state *state = &solution->state;
    char name[POINT_NAME];
    (void)parent;

    training_point_name(name, &owner->set->contacts[point]);
    if (solution->status)
        program_warn(owner->program, "point %s: not %s: %s", name,
                     solution->status == EHD_UNTRUSTED ? "to be trusted" : "converged",
                     solution->reason);
    ehd_status status = owner->store(owner->sink, owner->set, point, solution, error);
    if (!status)
        status = keep_point(owner, point, solution->status ? NULL : state->pressure,
                            state->rigid_approach, state->exit, error);
    if (!status) progress_show(&owner->progress, owner->num_done - owner->num_before, name);
    return status;
}

// ---- the whole training

static size_t smaller(size_t a, size_t b) {
    return a < b ? a : b;
}

ehd_status training_check_memory(const training_set *set, const program *caller,
                                 const char *plan_path, size_t num_jobs, ehd_error *error) {
    size_t num_solvers = smaller(num_jobs, set->num_points);
    size_t num_marches = smaller(num_jobs, set->num_trajectories);
    double of_points = (double)num_solvers * full_solver_bytes(&set->grid), of_marches = 0;
    double kept = (double)set->num_points * (double)set->grid.num_nodes * sizeof(double);
    const ehd_contact *first = num_solvers > 0 ? &set->contacts[0] : &set->trajectories[0].contact;

    if (num_marches > 0)
        of_marches = (double)num_marches * full_march_bytes(&set->trajectories[0].contact);
    // points are solved before trajectories, so only the larger of the two amounts counts
    return grid_check_memory(caller, plan_path, first, kept + fmax(of_points, of_marches),
                             of_points > of_marches ? num_solvers : num_marches, error);
}

ehd_status training_run(training *self, size_t num_workers, ehd_error *error) {
    const training_set *set = self->set;
    if (set->num_points == 0) return EHD_OK;
    bool *done = malloc(set->num_points * sizeof *done);
    if (!done) return ehd_no_memory(error, "points");

    size_t num_left = 0;
    for (size_t i = 0; i < set->num_points; i++) {
        done[i] = self->points[i].done || (self->wanted && !self->wanted[i]);
        num_left += !done[i];
    }
    self->num_before = self->num_done;
    const pool_work work = {.num_points = set->num_points,
                            .parent = set->parent,
                            .order = set->order,
                            .done = done,
                            .num_workers = num_workers,
                            .shared = self,
                            .worker_bytes = full_solver_bytes(&self->set->grid),
                            .begin = begin_worker,
                            .end = end_worker,
                            .start = show_point,
                            .repeatable = true,
                            .solve = solve_point,
                            .finish = finish_point};
    progress_start(&self->progress, self->program, num_left);
    self->progress.rest = self->rest;
    self->progress.more = self->more;
    ehd_status status = pool_run(&work, error);
    progress_finish(&self->progress);
    free(done);
    return status;
}
