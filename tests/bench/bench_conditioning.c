/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measures the conditioning of the reduced least squares, and how accurately several solvers solve
 * them.
 *
 *     bench_conditioning MODEL.h5 SCENE.yml MODES ROWS VARIANT [key=value ...]
 *
 * Solves a scene with the first MODES and ROWS of the model (0: all) by Newton with a QR in
 * extended precision. Each solver also solves every system of this iteration. Then each solves the
 * scene alone. Prints one line of CSV for each solver, with the columns of HEADER. VARIANT is one
 * of tests/bench/variant.h, or
 *     rate=R            a time step with the time derivative R (rho H - rho H of the stationary solution)
 * To count the instructions of the solvers, run callgrind with --toggle-collect=time_solvers, in
 * which each solver solves the same system REPEATS times. */
#include "common/program/program.h"
#include "common/settings/scene_contact.h"
#include "fullrun/full_solver.h"
#include "romrun/model/model_file.h"
#include "romrun/online/fields.h"
#include "romrun/online/least_squares.h"
#include "romrun/online/reduced_solver.h"
#include "romrun/online/row_system.h"
#include "tests/bench/measure.h"
#include "tests/bench/variant.h"

#include <cblas.h>
#include <lapacke.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char HEADER[] = "variant,modes,rows,unknowns,equations,scaled_condition,condition,"
                             "solver,status,iterations,from_full,from_extended,step_error,"
                             "microseconds";
enum { REPEATS = 21 };

// ---- solvers, all of step = argmin |matrix step + right|; row-major A is column-major A^T

/* Memory shared by the solvers. */
typedef struct workspace {
    least_squares *used;
    size_t num_columns;
    double *scale;        // [num_columns] 1 / norm of the column
    double *scaled;       // [num_rows, num_columns]
    double *gram;         // [num_columns, num_columns]
    double *left;         // [num_rows] residual
    double *change;       // [num_columns]
    float *single_scaled; // [num_rows, num_columns]
    float *single_gram;   // [num_columns, num_columns]
    float *single_change; // [num_columns]
    double *work;         // [num_work] workspace of LAPACK
    // [num_columns + 1, num_rows], column-major; the last column is the right side
    long double *extended;
    long double *diagonal; // [num_columns] diagonal of R
    int num_work;
} workspace;

static void workspace_init(workspace *self, size_t num_rows, size_t num_columns) {
    self->used = least_squares_create(num_rows, num_columns);
    if (!self->used) must_allocate((size_t)-1);
    self->num_columns = num_columns;
    self->scale = must_allocate(num_columns * sizeof(double));
    self->scaled = must_allocate(num_rows * num_columns * sizeof(double));
    self->gram = must_allocate(num_columns * num_columns * sizeof(double));
    self->left = must_allocate((num_rows + num_columns) * sizeof(double));
    self->change = must_allocate(num_columns * sizeof(double));
    self->single_scaled = must_allocate(num_rows * num_columns * sizeof(float));
    self->single_gram = must_allocate(num_columns * num_columns * sizeof(float));
    self->single_change = must_allocate(num_columns * sizeof(float));
    self->num_work = (int)(64 * (num_rows + num_columns));
    self->work = must_allocate((size_t)self->num_work * sizeof(double));
    self->extended = must_allocate(num_rows * (num_columns + 1) * sizeof(long double));
    self->diagonal = must_allocate(num_columns * sizeof(long double));
}

static void workspace_free(workspace *self) {
    least_squares_free(self->used);
    free(self->scale);
    free(self->scaled);
    free(self->gram);
    free(self->left);
    free(self->change);
    free(self->single_scaled);
    free(self->single_gram);
    free(self->single_change);
    free(self->work);
    free(self->extended);
    free(self->diagonal);
}

static void scale_columns(workspace *self, const double *matrix, size_t num_rows, bool scaled) {
    size_t n = self->num_columns;

    memset(self->scale, 0, n * sizeof(double));
    for (size_t r = 0; r < num_rows; r++)
        for (size_t j = 0; j < n; j++)
            self->scale[j] += matrix[r * n + j] * matrix[r * n + j];
    for (size_t j = 0; j < n; j++)
        self->scale[j] = scaled && self->scale[j] > 0 ? 1 / sqrt(self->scale[j]) : 1;
    for (size_t r = 0; r < num_rows; r++)
        for (size_t j = 0; j < n; j++)
            self->scaled[r * n + j] = matrix[r * n + j] * self->scale[j];
}

/* Computes the Cholesky factor of the scaled Gram matrix, in single or double precision. */
static bool factorise(workspace *self, size_t num_rows, bool single) {
    int n = (int)self->num_columns, m = (int)num_rows;

    if (single) {
        for (size_t i = 0; i < num_rows * self->num_columns; i++)
            self->single_scaled[i] = (float)self->scaled[i];
        cblas_ssyrk(CblasColMajor, CblasLower, CblasNoTrans, n, m, 1, self->single_scaled, n, 0,
                    self->single_gram, n);
        return LAPACKE_spotrf_work(LAPACK_COL_MAJOR, 'L', n, self->single_gram, n) == 0;
    }
    cblas_dsyrk(CblasColMajor, CblasLower, CblasNoTrans, n, m, 1, self->scaled, n, 0, self->gram,
                n);
    return LAPACKE_dpotrf_work(LAPACK_COL_MAJOR, 'L', n, self->gram, n) == 0;
}

/* Computes change = (L L^T)^-1 change. */
static void apply_inverse(workspace *self, bool single) {
    int n = (int)self->num_columns;

    if (!single) {
        cblas_dtrsv(CblasColMajor, CblasLower, CblasNoTrans, CblasNonUnit, n, self->gram, n,
                    self->change, 1);
        cblas_dtrsv(CblasColMajor, CblasLower, CblasTrans, CblasNonUnit, n, self->gram, n,
                    self->change, 1);
        return;
    }
    double norm = cblas_dnrm2(n, self->change, 1); // a gradient may be too small for a float
    for (int j = 0; j < n; j++)
        self->single_change[j] = norm > 0 ? (float)(self->change[j] / norm) : 0;
    cblas_strsv(CblasColMajor, CblasLower, CblasNoTrans, CblasNonUnit, n, self->single_gram, n,
                self->single_change, 1);
    cblas_strsv(CblasColMajor, CblasLower, CblasTrans, CblasNonUnit, n, self->single_gram, n,
                self->single_change, 1);
    for (int j = 0; j < n; j++)
        self->change[j] = norm * (double)self->single_change[j];
}

static ehd_status unscale(double *step, const workspace *self) {
    for (size_t j = 0; j < self->num_columns; j++) {
        step[j] *= self->scale[j];
        if (!isfinite(step[j])) return EHD_NOT_CONVERGED;
    }
    return EHD_OK;
}

/* Solves the normal equations, with iterative refinement. The residuals of the refinement use the
 * matrix itself, in double precision. */
static ehd_status normal_equations(double *step, workspace *self, const double *matrix,
                                   const double *right, size_t num_rows, bool scaled, bool single,
                                   int refinements) {
    int n = (int)self->num_columns, m = (int)num_rows;

    scale_columns(self, matrix, num_rows, scaled);
    if (!factorise(self, num_rows, single)) return EHD_NOT_CONVERGED;
    memset(step, 0, self->num_columns * sizeof(double));
    memcpy(self->left, right, num_rows * sizeof(double));
    for (int i = 0;; i++) {
        cblas_dgemv(CblasColMajor, CblasNoTrans, n, m, -1, self->scaled, n, self->left, 1, 0,
                    self->change, 1);
        apply_inverse(self, single);
        cblas_daxpy(n, 1, self->change, 1, step, 1);
        if (i == refinements) return unscale(step, self);
        memcpy(self->left, right, num_rows * sizeof(double));
        cblas_dgemv(CblasColMajor, CblasTrans, n, m, 1, self->scaled, n, step, 1, 1, self->left, 1);
    }
}

static ehd_status solve_unscaled(double *step, void *context, const double *matrix,
                                 const double *right, size_t num_rows, size_t num_unknowns) {
    (void)num_unknowns;
    return normal_equations(step, context, matrix, right, num_rows, false, false, 0);
}

static ehd_status solve_normal(double *step, void *context, const double *matrix,
                               const double *right, size_t num_rows, size_t num_unknowns) {
    (void)num_unknowns;
    return normal_equations(step, context, matrix, right, num_rows, true, false, 0);
}

static ehd_status solve_refined(double *step, void *context, const double *matrix,
                                const double *right, size_t num_rows, size_t num_unknowns) {
    (void)num_unknowns;
    return normal_equations(step, context, matrix, right, num_rows, true, false, 1);
}

static ehd_status solve_single(double *step, void *context, const double *matrix,
                               const double *right, size_t num_rows, size_t num_unknowns) {
    (void)num_unknowns;
    return normal_equations(step, context, matrix, right, num_rows, true, true, 0);
}

static ehd_status solve_single_refined(double *step, void *context, const double *matrix,
                                       const double *right, size_t num_rows, size_t num_unknowns) {
    (void)num_unknowns;
    return normal_equations(step, context, matrix, right, num_rows, true, true, 2);
}

static ehd_status solve_qr(double *step, void *context, const double *matrix, const double *right,
                           size_t num_rows, size_t num_unknowns) {
    workspace *self = context;
    int n = (int)num_unknowns, m = (int)num_rows;

    scale_columns(self, matrix, num_rows, true);
    for (size_t r = 0; r < num_rows; r++)
        self->left[r] = -right[r];
    if (LAPACKE_dgels_work(LAPACK_COL_MAJOR, 'T', n, m, 1, self->scaled, n, self->left,
                           m > n ? m : n, self->work, self->num_work))
        return EHD_NOT_CONVERGED;
    memcpy(step, self->left, num_unknowns * sizeof(double));
    return unscale(step, self);
}

static ehd_status solve_used(double *step, void *context, const double *matrix, const double *right,
                             size_t num_rows, size_t num_unknowns) {
    (void)num_unknowns;
    workspace *self = context;
    return least_squares_solve(step, self->used, matrix, right, num_rows);
}

/* Applies Householder's reflection of the first column to all columns (shape [count, length]). The
 * first column then has one nonzero entry, its head; returns the head. */
static long double reflect(long double *first, size_t count, size_t length, size_t stride) {
    long double norm = 0, head, squares;

    for (size_t r = 0; r < length; r++)
        norm += first[r] * first[r];
    norm = sqrtl(norm);
    if (norm == 0) return 0;
    head = first[0] > 0 ? -norm : norm;
    squares = norm * (norm + fabsl(first[0])); // half of |v|^2 with v = first - head e_1
    first[0] -= head;
    for (size_t j = 1; j < count; j++) {
        long double *column = first + j * stride, product = 0;
        for (size_t r = 0; r < length; r++)
            product += first[r] * column[r];
        for (size_t r = 0; r < length; r++)
            column[r] -= product / squares * first[r];
    }
    return head;
}

/* Solves by a Householder QR in extended precision (64 bits), with scaled columns. */
static ehd_status solve_extended(double *step, void *context, const double *matrix,
                                 const double *right, size_t num_rows, size_t num_unknowns) {
    workspace *self = context;
    long double *columns = self->extended, *last = columns + num_unknowns * num_rows;

    if (num_rows < num_unknowns) return EHD_NOT_CONVERGED;
    scale_columns(self, matrix, num_rows, true);
    for (size_t r = 0; r < num_rows; r++) {
        for (size_t j = 0; j < num_unknowns; j++)
            columns[j * num_rows + r] =
                (long double)matrix[r * num_unknowns + j] * (long double)self->scale[j];
        last[r] = -right[r];
    }
    for (size_t j = 0; j < num_unknowns; j++)
        self->diagonal[j] =
            reflect(columns + j * num_rows + j, num_unknowns + 1 - j, num_rows - j, num_rows);
    for (size_t j = num_unknowns; j-- > 0;) {
        if (self->diagonal[j] == 0) return EHD_NOT_CONVERGED;
        last[j] /= self->diagonal[j];
        for (size_t r = 0; r < j; r++)
            last[r] -= columns[j * num_rows + r] * last[j];
        step[j] = (double)last[j];
    }
    return unscale(step, self);
}

static const struct {
    const char *name;
    reduced_linear_solver *solve;
} solvers[] = {{"extended", solve_extended},
               {"used", solve_used},
               {"normal", solve_normal},
               {"refined", solve_refined},
               {"qr", solve_qr},
               {"unscaled", solve_unscaled},
               {"single", solve_single},
               {"single-refined", solve_single_refined}};
enum { EXTENDED, NUM_SOLVERS = sizeof solvers / sizeof *solvers };

// ---- measurements

typedef struct measurement {
    ehd_status status;
    size_t iterations;
    double film;         // central film
    double step_error;   // largest of all systems; relative, with scaled columns
    double microseconds; // median
} measurement;

/* A Newton iteration whose systems are given to all solvers. */
typedef struct recording {
    workspace *work;
    measurement *results;   // [NUM_SOLVERS]
    double *step;           // [num_unknowns]
    double *matrix, *right; // the last system
    size_t num_rows;
} recording;

/* Returns |D (x - y)| / |D y|, where D has the norms of the columns. */
static double step_error(const double *x, const double *y, const double *scale, size_t count) {
    double difference = 0, norm = 0;

    for (size_t j = 0; j < count; j++) {
        difference += pow((x[j] - y[j]) / scale[j], 2);
        norm += pow(y[j] / scale[j], 2);
    }
    return sqrt(difference / norm);
}

static ehd_status record(double *step, void *context, const double *matrix, const double *right,
                         size_t num_rows, size_t num_unknowns) {
    recording *self = context;
    ehd_status status = solve_extended(step, self->work, matrix, right, num_rows, num_unknowns);

    self->num_rows = num_rows;
    memcpy(self->matrix, matrix, num_rows * num_unknowns * sizeof(double));
    memcpy(self->right, right, num_rows * sizeof(double));
    for (size_t s = 0; s < NUM_SOLVERS && !status; s++) {
        measurement *result = &self->results[s];
        double error = INFINITY;
        if (!solvers[s].solve(self->step, self->work, matrix, right, num_rows, num_unknowns)) {
            scale_columns(self->work, matrix, num_rows, true);
            error = step_error(self->step, step, self->work->scale, num_unknowns);
        }
        result->step_error = fmax(result->step_error, error);
    }
    return status;
}

/* Measures the time of each solver. Not inlined, because callgrind counts inside this function. */
__attribute__((noinline)) static void time_solvers(recording *self, size_t num_unknowns) {
    double times[REPEATS];

    self->results[EXTENDED].microseconds = NAN;
    for (size_t s = EXTENDED + 1; s < NUM_SOLVERS; s++) {
        for (size_t i = 0; i < REPEATS; i++) {
            double start = program_seconds();
            times[i] = solvers[s].solve(self->step, self->work, self->matrix, self->right,
                                        self->num_rows, num_unknowns)
                           ? NAN
                           : program_seconds() - start;
        }
        self->results[s].microseconds = spread_of(times, REPEATS).median * 1e6;
    }
}

/* Returns the condition number: largest over smallest singular value. */
static double condition(const double *matrix, size_t num_rows, size_t num_columns) {
    size_t least = num_rows < num_columns ? num_rows : num_columns;
    double *copy = must_allocate(num_rows * num_columns * sizeof(double));
    double *values = must_allocate(least * sizeof(double));

    memcpy(copy, matrix, num_rows * num_columns * sizeof(double));
    if (LAPACKE_dgesdd(LAPACK_COL_MAJOR, 'N', (int)num_columns, (int)num_rows, copy,
                       (int)num_columns, values, NULL, 1, NULL, 1))
        values[0] = NAN;
    double ratio = values[0] / values[least - 1];
    free(values);
    free(copy);
    return ratio;
}

/* A scene, its contact and its model. */
typedef struct problem {
    const reduced_model *model;
    const ehd_contact *contact;
    const reduced_squeeze *squeeze; // NULL: stationary
} problem;

/* Solves the scene with `solve_linear` for the least squares; stores the final state in *state. */
static void solve_scene(measurement *result, reduced_state *state, const problem *self,
                        reduced_linear_solver *solve_linear, void *context) {
    const reduced_model *model = self->model;
    reduced_settings settings = reduced_default_settings();
    reduced_solver *solver;
    reduced_info info;
    ehd_error error;

    settings.solve_linear = solve_linear;
    settings.linear_context = context;
    must(reduced_solver_create(&solver, model, &settings, &error), &error);
    reduced_guess(state, model, contact_place_of(self->contact));
    must(reduced_solve(&info, state, solver, self->contact, self->squeeze, &error), &error);
    result->status = info.status;
    result->iterations = info.iterations;
    result->film = info.status == EHD_NOT_CONVERGED ? NAN : info.scalars.central_film_thickness;
    reduced_solver_free(solver);
}

/* rho H of the stationary solution times -rate. With it the solution also solves the time step. */
typedef struct previous_mass {
    double *at_rows;  // [num_rows]
    double *at_nodes; // [num_nodes]
} previous_mass;

static double previous_at(void *context, size_t node) {
    return ((const previous_mass *)context)->at_nodes[node];
}

static void previous_init(previous_mass *self, double rate, const problem *stationary,
                          const char *path) {
    const reduced_model *model = stationary->model;
    const ehd_contact *contact = stationary->contact;
    size_t num_nodes = model->grid.num_nodes;
    artefact *file;
    double *modes, *pressure = must_allocate(num_nodes * sizeof(double));
    reduced_state state = {.coordinates = must_allocate(model->num_unknowns * sizeof(double))};
    measurement result;
    field_modes fields;
    ehd_error error;

    self->at_rows = must_allocate(model->rows.num_rows * sizeof(double));
    self->at_nodes = must_allocate(num_nodes * sizeof(double));
    solve_scene(&result, &state, stationary, NULL, NULL);
    must(model_open(&file, path, &error), &error);
    must(model_get_modes(&modes, NULL, file, model, &error), &error);
    artefact_close(&file);
    must(field_modes_init(&fields, model, modes, &error), &error);
    must(field_modes_deflect(&fields, model, &error), &error);
    reduced_fields(pressure, self->at_nodes, &state, model, &fields);
    field_modes_free(&fields);
    for (size_t k = 0; k < num_nodes; k++) {
        double p = pressure[k] * contact->hertz_pressure;
        self->at_nodes[k] *= -rate * lubricant_density(&contact->lubricant, p);
    }
    for (size_t r = 0; r < model->rows.num_rows; r++)
        self->at_rows[r] = self->at_nodes[model->rows.node[r]];
    free(state.coordinates);
    free(modes);
    free(pressure);
}

static double full_film_thickness(const ehd_contact *contact) {
    const full_settings settings = full_default_settings();
    full_solver *solver;
    full_state state;
    full_info info;
    ehd_error error;

    must(full_solver_create(&solver, contact->kind, &contact->grid, &settings, &error), &error);
    must(full_state_init(&state, &contact->grid, &error), &error);
    must(full_solve_cold(&info, &state, solver, contact, &error), &error);
    double film = info.status ? NAN : full_evaluate_scalars(&state, contact).central_film_thickness;
    full_state_free(&state);
    full_solver_free(solver);
    return film;
}

static void print(const measurement *results, const reduced_model *model, const recording *seen,
                  const char *variant, double full) {
    size_t n = model->num_unknowns;
    double unscaled = condition(seen->matrix, seen->num_rows, n);

    scale_columns(seen->work, seen->matrix, seen->num_rows, true);
    double scaled = condition(seen->work->scaled, seen->num_rows, n);
    for (size_t s = 0; s < NUM_SOLVERS; s++)
        printf("%s,%zu,%zu,%zu,%zu,%.3g,%.3g,%s,%s,%zu,%.3g,%.3g,%.3g,%.3g\n", variant,
               model->num_pressure, model->rows.num_rows, n, seen->num_rows, scaled, unscaled,
               solvers[s].name,
               results[s].status == EHD_OK          ? "converged"
               : results[s].status == EHD_UNTRUSTED ? "exit-not-settled"
                                                    : "failed",
               results[s].iterations, results[s].film / full - 1,
               results[s].film / results[EXTENDED].film - 1, results[s].step_error,
               results[s].microseconds);
}

/* Runs all solvers on one scene with one variant of a model. */
static void measure(const problem *self, const char *variant) {
    size_t n = self->model->num_unknowns, max_rows = system_max_rows(self->model);
    measurement results[NUM_SOLVERS] = {0}, with_all;
    reduced_state state = {.coordinates = must_allocate(n * sizeof(double))};
    workspace work;

    for (size_t s = 0; s < NUM_SOLVERS; s++)
        results[s].step_error = NAN; // NaN until there is a reference
    workspace_init(&work, max_rows, n);
    recording seen = {.work = &work,
                      .results = results,
                      .step = must_allocate(n * sizeof(double)),
                      .matrix = must_allocate(max_rows * n * sizeof(double)),
                      .right = must_allocate(max_rows * sizeof(double))};
    solve_scene(&with_all, &state, self, record, &seen);
    for (size_t s = 0; s < NUM_SOLVERS; s++)
        solve_scene(&results[s], &state, self, solvers[s].solve, &work);
    time_solvers(&seen, n);
    print(results, self->model, &seen, variant, full_film_thickness(self->contact));
    free(seen.right);
    free(seen.matrix);
    free(seen.step);
    free(state.coordinates);
    workspace_free(&work);
}

static void measure_in_time(const problem *stationary, double rate, const char *variant,
                            const char *path) {
    previous_mass previous;
    previous_init(&previous, rate, stationary, path);
    const reduced_squeeze squeeze = {.rate = rate,
                                     .previous = previous.at_rows,
                                     .previous_at = previous_at,
                                     .context = &previous};
    const problem step = {stationary->model, stationary->contact, &squeeze};

    measure(&step, variant);
    free(previous.at_rows);
    free(previous.at_nodes);
}

int main(int argc, char **argv) {
    scene given;
    ehd_contact contact;
    reduced_model model;
    ehd_error error;

    if (argc == 2 && strcmp(argv[1], "header") == 0) return puts(HEADER) < 0;
    if (argc < 6) {
        fprintf(stderr, "usage: bench_conditioning MODEL.h5 SCENE.yml MODES ROWS VARIANT "
                        "[key=value ...], or header\n");
        return 64;
    }
    openblas_set_num_threads(1);
    const char *path = argv[1], *variant = argv[5];
    const model_sizes sizes = {.pressure_modes = strtoul(argv[3], NULL, 10),
                               .rows = strtoul(argv[4], NULL, 10)};
    must(scene_read(&given, argv[2], (const char *const *)argv + 6, (size_t)argc - 6, &error),
         &error);
    must(scene_contact(&contact, &given, &error), &error);
    must(model_read(&model, path, &sizes, &error), &error);
    if (model.deformation != DEFORMATION_COUPLED) {
        fprintf(stderr,
                "bench_conditioning: %s: found an independent basis, expected a coupled "
                "one\n",
                path);
        return 65;
    }
    const problem stationary = {&model, &contact, NULL};
    if (strncmp(variant, "rate=", 5) == 0) {
        measure_in_time(&stationary, strtod(variant + 5, NULL), variant, path);
    } else {
        variant_make(&model, variant, path);
        measure(&stationary, variant);
    }
    reduced_model_free(&model);
    return 0;
}
