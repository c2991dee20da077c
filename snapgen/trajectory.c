/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "snapgen/trajectory.h"

#include "common/program/arena.h"
#include "common/training/pool.h"
#include "fullrun/full_march.h"
#include "podbuild/pod_stream.h"
#include "romrun/online/reduced_march.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Singular values below 1e-11 of the first one are omitted. Up to half of this error may come from
 * the distance between the snapshots and the directions of the stream. A stream is fastest if its
 * block, here 512, has about as many snapshots as the stream has directions. */
static const pod_settings compression = {.discarded_energy = 1e-22};
static const pod_stream_settings compression_stream = {.local_energy = 0.25e-22, .block = 512};

/* A training on all trajectories. If `model` is NULL, it uses the full model. */
typedef struct task {
    const program *caller;
    const training_set *set;
    const reduced_model *model;
    const film_splines *splines;
    trajectories *result;
    pod_basis *first, *second; // [num_trajectories] PODs that are not merged yet
    bool *done;                // [num_trajectories]
    size_t num_merged;
    pod_stream *all_first, *all_second;
    pthread_mutex_t showing; // guards the members below
    double *progress_part;   // [num_trajectories] reached time divided by the end time
    progress progress;
    arena memory;
} task;

enum { PARTS_SHOWN = 1000 }; // number of parts of the work that the progress line counts

typedef struct trajectory_run {
    task *owner;
    size_t number;
    full_march *full;       // NULL: the reduced model is used
    reduced_march *reduced; // NULL: the full model is used
    pod_stream *first, *second;
    double *iterations[2]; // [num_iterations, rows] D f and D J dz of the present solution
    size_t num_iterations;
} trajectory_run;

void trajectories_free(trajectories *self) {
    for (size_t t = 0; self->kept && t < self->num_trajectories; t++)
        kept_states_free(&self->kept[t]);
    arena_free(&self->memory);
    pod_free(&self->first);
    pod_free(&self->second);
    memset(self, 0, sizeof *self);
}

static const ehd_contact *reference_of(const trajectory_run *self) {
    return &self->owner->set->trajectories[self->number].contact;
}

static void show_progress(task *owner, size_t number, double time) {
    size_t num = owner->result->num_trajectories;
    double sum = 0;
    char shown[64];

    pthread_mutex_lock(&owner->showing);
    owner->progress_part[number] = time / owner->set->trajectories[number].scene.transient.end_time;
    for (size_t t = 0; t < num; t++)
        sum += owner->progress_part[t];
    snprintf(shown, sizeof shown, "trajectory %zu of %zu at T = %.4g", number + 1, num, time);
    progress_show(&owner->progress, (size_t)(PARTS_SHOWN * sum / (double)num), shown);
    pthread_mutex_unlock(&owner->showing);
}

static ehd_status store_full(void *sink, const march_step *step, size_t index, ehd_error *error) {
    trajectory_run *self = sink;
    const full_state *state = full_march_state(self->full, NULL);
    (void)index;

    kept_states_consider(&self->owner->result->kept[self->number], step, reference_of(self),
                         state->pressure, state->film, NULL);
    show_progress(self->owner, self->number, step->frame.time);
    return pod_stream_add(self->first, state->pressure, 1, error);
}

static ehd_status store_reduced(void *sink, const march_step *step, size_t index,
                                ehd_error *error) {
    trajectory_run *self = sink;
    const reduced_state state = reduced_march_state(self->reduced, NULL);
    (void)index, (void)error;

    kept_states_consider(&self->owner->result->kept[self->number], step, reference_of(self), NULL,
                         NULL, reduced_state_exits(&state));
    show_progress(self->owner, self->number, step->frame.time);
    return EHD_OK;
}

/* Keeps an iteration until its solution has ended. */
static ehd_status observe(void *context, const double *residual, const double *step,
                          ehd_error *error) {
    trajectory_run *self = context;
    const double *const found[] = {residual, step};
    const size_t width = self->owner->model->rows.num_rows, count = self->num_iterations;

    for (int i = 0; i < 2; i++) {
        double *longer = array_resize(self->iterations[i], count + 1, width, sizeof *longer);
        if (!longer) return ehd_no_memory(error, "trajectories");
        self->iterations[i] = longer;
        memcpy(longer + count * width, found[i], width * sizeof *longer);
    }
    self->num_iterations++;
    return EHD_OK;
}

/* Adds the iterations of a solution to the streams, which compress them. Iterations of a failed
 * time step, which is repeated with a shorter length, are left out. */
static ehd_status end_solution(void *context, const reduced_info *info, ehd_error *error) {
    trajectory_run *self = context;
    const size_t count = info->status == EHD_NOT_CONVERGED ? 0 : self->num_iterations;
    ehd_status status = EHD_OK;

    if (count > 0) status = pod_stream_add(self->first, self->iterations[0], count, error);
    if (count > 0 && !status)
        status = pod_stream_add(self->second, self->iterations[1], count, error);
    self->num_iterations = 0;
    return status;
}

static ehd_status begin_full(trajectory_run *self, const scene *given, ehd_error *error) {
    full_settings settings = full_default_settings();
    const ehd_contact *reference = reference_of(self);

    settings.tolerance = 1e-12; // as for stationary points
    ehd_status status =
        full_march_create(&self->full, reference, &settings, given->transient.start_film, error);
    if (!status)
        status =
            pod_stream_create(&self->first, reference->grid.num_nodes, &compression_stream, error);
    if (!status)
        status = kept_states_init(&self->owner->result->kept[self->number],
                                  reference->grid.num_nodes, 0, given->transient.end_time, error);
    return status;
}

static ehd_status begin_reduced(trajectory_run *self, const scene *given, ehd_error *error) {
    const task *owner = self->owner;
    size_t num_rows = owner->model->rows.num_rows;
    ehd_status status = reduced_march_create(&self->reduced, owner->model, owner->splines,
                                             reference_of(self), &reduced_defaults, error);

    if (!status) status = pod_stream_create(&self->first, num_rows, &compression_stream, error);
    if (!status) status = pod_stream_create(&self->second, num_rows, &compression_stream, error);
    if (!status)
        status = kept_states_init(&owner->result->kept[self->number], 0,
                                  owner->model->band.num_lines, given->transient.end_time, error);
    if (!status)
        reduced_solver_observe(reduced_march_inner(self->reduced), observe, end_solution, self);
    return status;
}

static void end_run(trajectory_run *self) {
    full_march_free(self->full);
    reduced_march_free(self->reduced);
    pod_stream_free(self->first);
    pod_stream_free(self->second);
    free(self->iterations[0]);
    free(self->iterations[1]);
}

/* Marches to the end time. `reason`: why the march did not reach this time, or why a march of the
 * full model is not to be trusted; else "". */
static ehd_status march_to_end(char reason[MARCH_REASON], trajectory_run *self,
                               const trajectory_scene *of, ehd_error *error) {
    march run = {.reference = &of->contact,
                 .histories = of->histories,
                 .settings = march_settings_of(&of->scene, of->histories, of->scene.approach),
                 .solver = self->full ? full_march_solver(self->full)
                                      : reduced_march_solver(self->reduced),
                 .store = self->full ? store_full : store_reduced,
                 .sink = self};
    const ehd_status status = march_whole(reason, &run, error);

    // an untrusted march of the full model is no solution. An untrusted march of the reduced model
    // is kept, since the online solver may meet such states
    if (!status && !reason[0] && self->full) memcpy(reason, run.untrusted, MARCH_REASON);
    return status;
}

enum { TRAJECTORY_NAME = 128 };

/* Writes a name such as "M=12 L=7, load sine, speed step". */
static void name_trajectory(char name[TRAJECTORY_NAME], const trajectory_run *self,
                            const scene *given) {
    training_point_name(name, reference_of(self));
    for (int i = 0; i < NUM_VARY; i++) {
        const char *law = given->transient.vary[i].law;
        const size_t used = strlen(name);
        if (*law && strcmp(law, "constant") != 0)
            snprintf(name + used, TRAJECTORY_NAME - used, ", %s %s", vary_names[i], law);
    }
}

/* Finishes a stream. If it has no snapshots, or only zeros, *result has no modes. */
static ehd_status finish(pod_basis *result, pod_stream *stream, ehd_error *error) {
    *result = (pod_basis){0};
    return pod_stream_energy(stream) > 0 ? pod_stream_finish(result, stream, &compression, error)
                                         : EHD_OK;
}

static ehd_status solve_trajectory(void *shared, void *worker, size_t number, size_t parent,
                                   ehd_error *error) {
    task *owner = shared;
    const trajectory_scene *of = &owner->set->trajectories[number];
    const scene *given = &of->scene;
    trajectory_run self = {.owner = owner, .number = number};
    char reason[MARCH_REASON], name[TRAJECTORY_NAME];
    (void)worker, (void)parent;

    ehd_status status =
        owner->model ? begin_reduced(&self, given, error) : begin_full(&self, given, error);
    if (!status) status = march_to_end(reason, &self, of, error);
    if (!status && reason[0]) {
        name_trajectory(name, &self, given);
        owner->result->failed[number] = true;
        program_warn(owner->caller, "trajectory %zu (%s): not converged: %s", number + 1, name,
                     reason);
    }
    if (!status) {
        kept_states_complete(&owner->result->kept[number]);
        status = finish(&owner->first[number], self.first, error);
    }
    if (!status && self.second) status = finish(&owner->second[number], self.second, error);
    end_run(&self);
    return status;
}

static ehd_status merge_one(pod_stream *all, pod_basis *set, bool failed, ehd_error *error) {
    ehd_status status = EHD_OK;

    if (all && set->num_modes > 0 && !failed) status = pod_stream_merge(all, set, error);
    pod_free(set);
    return status;
}

/* Merges the finished trajectories in the order of the plan, so that the result does not depend on
 * the number of threads. */
static ehd_status finish_trajectory(void *shared, void *worker, size_t number, size_t parent,
                                    ehd_error *error) {
    task *owner = shared;
    trajectories *result = owner->result;
    ehd_status status = EHD_OK;
    (void)worker, (void)parent;

    owner->done[number] = true;
    if (result->failed[number]) // the progress shows a failed trajectory as finished
        show_progress(owner, number, owner->set->trajectories[number].scene.transient.end_time);
    result->num_failed += result->failed[number];
    result->num_steps += owner->first[number].num_snapshots;
    for (;
         owner->num_merged < result->num_trajectories && owner->done[owner->num_merged] && !status;
         owner->num_merged++) {
        size_t t = owner->num_merged;
        status = merge_one(owner->all_first, &owner->first[t], result->failed[t], error);
        if (!status)
            status = merge_one(owner->all_second, &owner->second[t], result->failed[t], error);
    }
    return status;
}

static ehd_status run_pool(task *self, size_t num_workers, ehd_error *error) {
    const pool_work work = {.num_points = self->result->num_trajectories,
                            .num_workers = num_workers,
                            .shared = self,
                            .solve = solve_trajectory,
                            .finish = finish_trajectory};

    progress_start(&self->progress, self->caller, PARTS_SHOWN);
    ehd_status status = pool_run(&work, error);
    progress_finish(&self->progress);
    return status;
}

static ehd_status run(trajectories *result, task *self, size_t num_workers, ehd_error *error) {
    size_t num = self->set->num_trajectories;
    size_t width = self->model ? self->model->rows.num_rows : self->set->grid.num_nodes;
    arena *memory = &self->memory;
    ehd_status status = EHD_OK;

    memset(result, 0, sizeof *result);
    self->result = result;
    result->num_trajectories = num;
    result->kept = arena_array(&result->memory, num, sizeof *result->kept);
    result->failed = arena_array(&result->memory, num, sizeof *result->failed);
    self->first = arena_array(memory, num, sizeof *self->first);
    self->second = arena_array(memory, num, sizeof *self->second);
    self->done = arena_array(memory, num, sizeof *self->done);
    self->progress_part = arena_array(memory, num, sizeof *self->progress_part);
    pthread_mutex_init(&self->showing, NULL);
    if (memory->failed || result->memory.failed) status = ehd_no_memory(error, "trajectories");
    if (!status) status = pod_stream_create(&self->all_first, width, &compression_stream, error);
    if (!status && self->model)
        status = pod_stream_create(&self->all_second, width, &compression_stream, error);
    if (!status) status = run_pool(self, num_workers, error);
    if (!status) status = finish(&result->first, self->all_first, error);
    if (!status && self->model) status = finish(&result->second, self->all_second, error);
    for (size_t t = 0; t < num; t++) {
        if (self->first) pod_free(&self->first[t]);
        if (self->second) pod_free(&self->second[t]);
    }
    pthread_mutex_destroy(&self->showing);
    arena_free(memory);
    pod_stream_free(self->all_first);
    pod_stream_free(self->all_second);
    if (status) trajectories_free(result);
    return status;
}

ehd_status trajectories_train(trajectories *result, const program *caller, const training_set *set,
                              size_t num_workers, ehd_error *error) {
    task self = {.caller = caller, .set = set};

    return run(result, &self, num_workers, error);
}

ehd_status trajectories_repeat(trajectories *result, const program *caller, const training_set *set,
                               const reduced_model *model, const film_splines *splines,
                               size_t num_workers, ehd_error *error) {
    task self = {.caller = caller, .set = set, .model = model, .splines = splines};

    return run(result, &self, num_workers, error);
}
