/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "snapgen/residuals.h"

#include "common/artefact/artefact.h"
#include "common/output/columns.h"
#include "common/program/arena.h"
#include "common/time/path_filter.h"
#include "common/training/pool.h"
#include "romrun/calibrate/check_scenes.h"
#include "romrun/model/basis_file.h"
#include "romrun/solve/guess.h"
#include "romrun/solve/reduced_solver.h"
#include "snapgen/trajectory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The iterations of a training point, and the outcome of its solution. */
typedef struct point_trace {
    size_t num_iterations;
    double *residual; // [num_iterations, num_inner] weighted residuals D f; freed after `take`
    double *step;     // [num_iterations, num_inner] weighted steps D J dz; freed after `take`
    size_t *exits;    // [inner_lines] first column without pressure
    reduced_info info;
    bool is_finished;
} point_trace;

/* Stores or writes the iterations of a point. The caller frees the arrays of `trace` afterwards. */
typedef ehd_status take_iterations(void *sink, size_t point, const point_trace *trace,
                                   ehd_error *error);

typedef struct repeated_training {
    const program *caller;
    const training_set *set;
    const reduced_model *model;
    point_trace *traces; // [num_points]
    take_iterations *take;
    void *sink;
    size_t num_taken; // number of points given to `take`, in the order of the plan
    trajectories repeated;
    size_t num_done, num_failed;
    progress progress;
} repeated_training;

/* Solver of one thread, and the trace of its present point. */
typedef struct tracer {
    reduced_solver *solver;
    reduced_state state;
    size_t num_rows;
    point_trace *trace;
} tracer;

static void free_iterations(point_trace *trace) {
    free(trace->residual);
    free(trace->step);
    trace->residual = trace->step = NULL;
    trace->num_iterations = 0;
}

static ehd_status keep_iteration(void *context, const double *residual, const double *step,
                                 ehd_error *error) {
    tracer *self = context;
    point_trace *trace = self->trace;
    size_t width = self->num_rows, count = trace->num_iterations;
    size_t bytes = (count + 1) * width * sizeof(double);
    double *residuals = realloc(trace->residual, bytes);

    if (residuals) trace->residual = residuals;
    double *steps = residuals ? realloc(trace->step, bytes) : NULL;
    if (!steps) return ehd_no_memory(error, "residuals");
    trace->step = steps;
    memcpy(trace->residual + count * width, residual, width * sizeof(double));
    memcpy(trace->step + count * width, step, width * sizeof(double));
    trace->num_iterations++;
    return EHD_OK;
}

static ehd_status end_iterations(void *context, const reduced_info *info, ehd_error *error) {
    tracer *self = context;
    (void)error;

    if (info->status) free_iterations(self->trace);
    return EHD_OK;
}

static void end_tracer(void *worker) {
    tracer *self = worker;

    if (self) {
        reduced_solver_free(self->solver);
        reduced_state_free(&self->state);
        free(self);
    }
}

static ehd_status begin_tracer(void **worker, void *shared, ehd_error *error) {
    const repeated_training *training = shared;
    tracer *self = calloc(1, sizeof *self);

    *worker = self;
    if (!self) return ehd_no_memory(error, "residuals");
    self->num_rows = training->model->rows.num_rows;
    ehd_status status = reduced_state_init(&self->state, training->model, error);
    if (!status)
        status = reduced_solver_create(&self->solver, training->model, &reduced_defaults, error);
    if (!status) reduced_solver_observe(self->solver, keep_iteration, end_iterations, self);
    return status;
}

/* Solves a point and keeps its iterations. The solver starts from the nearest trained solution of
 * another point, since most iterations of the online solver are like the iterations from such a
 * start. If the solver does not converge from there, it starts from a guess that uses all trained
 * solutions around the point, including its own. Iterations that diverge are left out: their
 * residuals are larger than all other residuals together, and would determine the selected rows. */
static ehd_status trace_point(void *shared, void *worker, size_t point, size_t parent,
                              ehd_error *error) {
    repeated_training *training = shared;
    const ehd_contact *contact = &training->set->contacts[point];
    tracer *self = worker;
    point_trace *trace = self->trace = &training->traces[point];
    (void)parent;

    reduced_neighbour(&self->state, training->model, contact_place_of(contact));
    ehd_status status =
        reduced_solve(&trace->info, &self->state, self->solver, contact, NULL, error);
    if (!status && trace->info.status) {
        reduced_guess(&self->state, training->model, contact_place_of(contact));
        status = reduced_solve(&trace->info, &self->state, self->solver, contact, NULL, error);
    }
    if (!status) {
        const ehd_grid *grid = &training->model->grid;
        size_t bytes = grid->inner_lines * sizeof *trace->exits;
        trace->exits = malloc(bytes);
        if (!trace->exits) return ehd_no_memory(error, "residuals");
        memcpy(trace->exits, reduced_state_exits(&self->state) + grid_first_line(grid), bytes);
    }
    return status;
}

/* Passes the iterations of finished points to `take` in the order of the plan. The number of
 * threads therefore does not change the result. */
static ehd_status write_finished(repeated_training *training, ehd_error *error) {
    ehd_status status = EHD_OK;

    while (training->num_taken < training->set->num_points && !status) {
        point_trace *trace = &training->traces[training->num_taken];
        if (!trace->is_finished) break;
        status = training->take(training->sink, training->num_taken, trace, error);
        free_iterations(trace);
        training->num_taken++;
    }
    return status;
}

static ehd_status finish_point(void *shared, void *worker, size_t point, size_t parent,
                               ehd_error *error) {
    repeated_training *training = shared;
    point_trace *trace = &training->traces[point];
    char name[POINT_NAME];
    (void)worker, (void)parent;

    training_point_name(name, &training->set->contacts[point]);
    if (trace->info.status) {
        training->num_failed++;
        program_note(
            training->caller,
            "%s: found the projected system not converged (%s); its iterations are left out", name,
            trace->info.reason);
    }
    progress_show(&training->progress, ++training->num_done, name);
    trace->is_finished = true;
    return write_finished(training, error);
}

static void free_traces(repeated_training *training) {
    for (size_t i = 0; training->traces && i < training->set->num_points; i++) {
        free_iterations(&training->traces[i]);
        free(training->traces[i].exits);
    }
    free(training->traces);
}

/* Solves all points. Every point starts from a trained solution, so no point waits for another.
 * Points are solved in the order of their numbers, so that few iterations wait for the iterations
 * of earlier points. */
static ehd_status run_pool(repeated_training *training, size_t num_workers, ehd_error *error) {
    size_t num_points = training->set->num_points;
    const pool_work work = {.num_points = num_points,
                            .num_workers = num_workers,
                            .shared = training,
                            .begin = begin_tracer,
                            .end = end_tracer,
                            .solve = trace_point,
                            .finish = finish_point};

    training->traces = calloc(num_points + 1, sizeof *training->traces);
    if (!training->traces) return ehd_no_memory(error, "residuals");
    if (num_points == 0) return EHD_OK;
    progress_start(&training->progress, training->caller, num_points);
    ehd_status status = pool_run(&work, error);
    progress_finish(&training->progress);
    return status;
}

// ---- in memory

/* Target of the iterations in memory. */
typedef struct collection {
    residual_snapshots *snapshots;
    size_t num_inner;
} collection;

static ehd_status collect(void *sink, size_t point, const point_trace *trace, ehd_error *error) {
    const collection *self = sink;

    return residual_snapshots_append(self->snapshots, trace->residual, trace->step,
                                     trace->num_iterations, (int64_t)point, self->num_inner, error);
}

ehd_status residuals_collect(residual_snapshots *snapshots, const program *caller,
                             const training_set *set, const reduced_model *model,
                             size_t num_workers, ehd_error *error) {
    collection sink = {snapshots, model->grid.num_inner};
    repeated_training training = {
        .caller = caller, .set = set, .model = model, .take = collect, .sink = &sink};

    *snapshots = (residual_snapshots){0};
    const ehd_status status = run_pool(&training, num_workers, error);
    free_traces(&training);
    if (status) residual_snapshots_free(snapshots);
    return status;
}

// ---- the file

/* Target of the iterations in a file, and the number written so far. */
typedef struct iteration_file {
    artefact *file;
    size_t count;
} iteration_file;

static ehd_status write_iterations(void *sink, size_t point, const point_trace *trace,
                                   ehd_error *error) {
    iteration_file *self = sink;
    const size_t first = self->count, count = trace->num_iterations;
    const int64_t state = (int64_t)point;
    ehd_status status = EHD_OK;

    if (count == 0) return EHD_OK;
    status =
        artefact_put_part(self->file, "weighted_residual", first, count, trace->residual, error);
    if (!status)
        status = artefact_put_part(self->file, "weighted_jacobian_step", first, count, trace->step,
                                   error);
    for (size_t k = 0; k < count && !status; k++)
        status =
            artefact_put_integers_part(self->file, "iteration_state", first + k, 1, &state, error);
    self->count += count;
    return status;
}

/* Writes the compressed iterations of the trajectories, after the iterations of the points.
 * `width`: length of a row of the file. If one of the two sets (residuals, Jacobian steps) has
 * fewer rows, rows of zeros are added, which have no effect. */
static ehd_status put_compressed(artefact *file, const trajectories *repeated, size_t width,
                                 size_t first, size_t count, ehd_error *error) {
    const struct {
        const char *field;
        const pod_basis *set;
    } sets[] = {{"weighted_residual", &repeated->first},
                {"weighted_jacobian_step", &repeated->second}};
    double *row = array_new(width, 1, sizeof *row);
    const int64_t none = -1;
    ehd_status status = row ? EHD_OK : ehd_no_memory(error, "residuals");

    for (size_t i = 0; i < count && !status; i++) {
        for (int s = 0; s < 2 && !status; s++) {
            memset(row, 0, width * sizeof *row);
            if (i < sets[s].set->num_modes) pod_row(row, sets[s].set, i);
            status = artefact_put_part(file, sets[s].field, first + i, 1, row, error);
        }
        if (!status)
            status =
                artefact_put_integers_part(file, "iteration_state", first + i, 1, &none, error);
    }
    free(row);
    const double first_left = pod_discarded(&repeated->first);
    const named_number numbers[] = {
        {"compressed_iterations", (double)repeated->first.num_snapshots},
        {"compressed_energy_discarded", fmax(first_left, pod_discarded(&repeated->second))},
        {0}};
    return status ? status : numbers_put(file, 0, numbers, error);
}

static ehd_status put_exits(artefact *file, size_t place, const size_t *exits, size_t num_lines,
                            ehd_error *error) {
    int64_t *indices = malloc(num_lines * sizeof *indices);
    if (!indices) return ehd_no_memory(error, "residuals");

    for (size_t l = 0; l < num_lines; l++)
        indices[l] = (int64_t)exits[l] - 1;
    ehd_status status =
        artefact_put_integers_part(file, "state_exit_node", place, 1, indices, error);
    free(indices);
    return status;
}

static ehd_status put_state(artefact *file, size_t place, const size_t *exits, size_t num_lines,
                            bool failed, size_t iterations, double moes_M, double alpha_p_H,
                            double film, ehd_error *error) {
    const named_number numbers[] = {{"status", failed ? 1 : 0},
                                    {"newton_iterations", (double)iterations},
                                    {"state_moes_M", moes_M},
                                    {"state_alpha_p_H", alpha_p_H},
                                    {"state_central_film_thickness", film},
                                    {0}};
    const ehd_status status = put_exits(file, place, exits, num_lines, error);

    return status ? status : numbers_put(file, place, numbers, error);
}

static ehd_status put_states(artefact *file, const repeated_training *training, ehd_error *error) {
    const training_set *set = training->set;
    const trajectories *repeated = &training->repeated;
    ehd_status status = EHD_OK;

    for (size_t i = 0; i < set->num_points && !status; i++) {
        const point_trace *trace = &training->traces[i];
        status =
            put_state(file, i, trace->exits, training->model->grid.inner_lines, trace->info.status,
                      trace->info.iterations, set->contacts[i].moes_M, set->contacts[i].alpha_p_H,
                      trace->info.scalars.central_film_thickness, error);
    }
    for (size_t i = 0; i < repeated->num_trajectories * NUM_KEPT && !status; i++) {
        const kept_state *state = &repeated->kept[i / NUM_KEPT].states[i % NUM_KEPT];
        const ehd_grid *grid = &training->model->grid;
        status = put_state(file, set->num_points + i, state->exits + grid_first_line(grid),
                           grid->inner_lines, repeated->failed[i / NUM_KEPT], state->iterations,
                           state->moes_M, state->alpha_p_H, state->scalars.central_film_thickness,
                           error);
    }
    return status;
}

/* Writes the grid and the identity of the basis, and declares all fields. */
static ehd_status begin_file(artefact *file, const repeated_training *training,
                             const char *identity, ehd_error *error) {
    const reduced_model *model = training->model;
    const size_t num_states =
        training->set->num_points + training->set->num_trajectories * NUM_KEPT;
    ehd_status status = grid_write(file, model->kind, &model->grid, error);

    if (!status)
        status =
            artefact_put_text(file, "deformation", deformation_names[model->deformation], error);
    if (!status) status = artefact_put_text(file, "basis_sha256", identity, error);
    if (!status) status = artefact_put_axis(file, "state", num_states, NULL, error);
    for (const artefact_field *field = schema_residuals.fields; field->name && !status; field++)
        status = artefact_declare(file, field->name, error);
    return status;
}

static ehd_status end_file(artefact **file, const repeated_training *training,
                           size_t num_iterations, ehd_error *error) {
    const trajectories *repeated = &training->repeated;
    const size_t num_first = repeated->first.num_modes, num_second = repeated->second.num_modes;
    const size_t num_compressed = num_second > num_first ? num_second : num_first;
    ehd_status status = EHD_OK;

    if (num_compressed > 0)
        status = put_compressed(*file, repeated, training->model->rows.num_rows, num_iterations,
                                num_compressed, error);
    if (!status)
        status = artefact_put_axis_part(*file, "iteration", 0, num_iterations + num_compressed,
                                        NULL, error);
    if (!status) status = put_states(*file, training, error);
    return status ? status : artefact_finish(file, error);
}

// ---- the whole run

static ehd_status run_trajectories(repeated_training *training, const reduced_basis *basis,
                                   size_t num_workers, ehd_error *error) {
    film_splines splines;
    ehd_status status = film_splines_build(&splines, training->model, basis->pressure,
                                           basis->deformation_modes, error);

    if (!status)
        status = trajectories_repeat(&training->repeated, training->caller, training->set,
                                     training->model, &splines, num_workers, error);
    film_splines_free(&splines);
    return status;
}

/* Removes all points that the basis was not trained on. */
static ehd_status keep_trained(training_set *set, const reduced_basis *basis, const char *plan_path,
                               const char *basis_path, ehd_error *error) {
    ehd_status status = check_scenes_keep_trained(set, &basis->states, plan_path, error);

    if (!status && set->num_points == 0)
        status = ehd_fail(error, EHD_DATA,
                          "%s: found no point that %s was trained on, expected the plan of its "
                          "training",
                          plan_path, basis_path);
    return status;
}

ehd_status residuals_run(size_t *num_failed, const program *caller, training_set *set,
                         const char *plan_path, const char *basis_path, bool trained_only,
                         size_t num_workers, ehd_error *error) {
    const char **inputs = training_inputs(set, plan_path, basis_path);
    reduced_basis basis = {0};
    reduced_model model = {0};
    iteration_file sink = {0};
    repeated_training training = {
        .caller = caller, .set = set, .model = &model, .take = write_iterations, .sink = &sink};
    char identity[65];
    ehd_status status = inputs ? basis_read(&basis, identity, basis_path, error)
                               : ehd_no_memory(error, "residuals");

    if (!status) training_set_take_grid(set, &basis.grid);
    if (!status) status = grid_check(&basis.grid, basis_path, &set->grid, plan_path, error);
    if (!status && set->num_trajectories > 0) { // plan and basis must have the same transport
        const ehd_carriage carriage = path_carriage(&set->trajectories[0].contact);
        status = carriage_check(&carriage, plan_path, &basis.carriage, basis_path, error);
    }
    if (!status && trained_only) status = keep_trained(set, &basis, plan_path, basis_path, error);
    if (!status)
        status = artefact_create_growing(&sink.file, caller->output, &schema_residuals, "iteration",
                                         caller, set->text, inputs, error);
    if (!status) status = reduced_model_build(&model, &basis, NULL, 0, error);
    if (!status) status = begin_file(sink.file, &training, identity, error);
    if (!status) status = run_pool(&training, num_workers, error);
    if (!status && set->num_trajectories > 0)
        status = run_trajectories(&training, &basis, num_workers, error);
    if (status == EHD_INTERRUPTED)
        ehd_fail(error, status, "%s: interrupted after %zu of %zu points, nothing written",
                 caller->output, training.num_done, set->num_points);
    *num_failed = training.num_failed + training.repeated.num_failed;
    if (!status) status = training_check_outcome(set, *num_failed, plan_path, error);
    if (!status) status = end_file(&sink.file, &training, sink.count, error);
    artefact_close(&sink.file);
    free_traces(&training);
    free(inputs);
    trajectories_free(&training.repeated);
    reduced_model_free(&model);
    reduced_basis_free(&basis);
    return status;
}
