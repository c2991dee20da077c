/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measures bases in single instead of double precision: their effect on results, and the time that
 * they could save.
 *
 *     bench_precision results MODEL.h5 SCENE.yml [key=value ...]    results with the stored and the rounded bases
 *     bench_precision kernels MODEL.h5 SCENE.yml [key=value ...]    time of the kernels of an iteration, in both
 *
 * Rounding changes values only; the arithmetic stays double. */
#include "common/program/program.h"
#include "common/settings/scene_contact.h"
#include "romrun/model/model_file.h"
#include "romrun/online/reduced_march.h"
#include "romrun/online/reduced_solver.h"
#include "tests/bench/measure.h"
#include "tests/bench/variant.h"

#include <cblas.h>
#include <lapacke.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// ---- results

/* The result of a scene: the central film of each step, or one value if it is stationary. */
typedef struct outcome {
    bool converged;
    size_t num_steps, iterations;
    double *film; // [most_steps]
    size_t most_steps;
    const ehd_contact *reference;
} outcome;

static const char *const variants[] = {"stored", "single"};
enum { STORED, SINGLE, NUM_VARIANTS };

static void read_variant(reduced_model *model, const char *path, const char *variant) {
    ehd_error error;

    must(model_read(model, path, NULL, &error), &error);
    if (model->deformation != DEFORMATION_COUPLED) {
        fprintf(stderr, "bench: %s: found an independent basis, expected a coupled one\n", path);
        exit(65);
    }
    variant_make(model, variant, path);
}

static void solve_stationary(outcome *result, const reduced_model *model,
                             const ehd_contact *contact) {
    const reduced_settings settings = reduced_default_settings();
    reduced_state state = {.coordinates = must_allocate(model->num_unknowns * sizeof(double))};
    reduced_solver *solver;
    reduced_info info;
    ehd_error error;

    must(reduced_solver_create(&solver, model, &settings, &error), &error);
    reduced_guess(&state, model, contact_place_of(contact));
    must(reduced_solve(&info, &state, solver, contact, NULL, &error), &error);
    result->converged = info.status == EHD_OK;
    result->iterations = info.iterations;
    result->num_steps = 1;
    result->film[0] = info.scalars.central_film_thickness;
    reduced_solver_free(solver);
    free(state.coordinates);
}

static ehd_status store(void *sink, const march_step *step, size_t index, ehd_error *error) {
    outcome *self = sink;
    contact_scalars scalars = frame_to_reference(&step->scalars, &step->frame, self->reference);

    if (index >= self->most_steps)
        return ehd_fail(error, EHD_DATA, "steps: found more than %zu, expected a shorter time",
                        self->most_steps);
    self->film[index] = scalars.central_film_thickness;
    self->num_steps = index + 1;
    return EHD_OK;
}

static void solve_in_time(outcome *result, const reduced_model *model, bool rounded,
                          const char *path, const ehd_contact *reference, const scene *given) {
    const reduced_settings settings = reduced_default_settings();
    artefact *file;
    double *modes;
    film_splines splines = {0};
    reduced_march *in_time;
    ehd_histories *histories;
    march_step first;
    ehd_status end = EHD_OK;
    ehd_error error;

    must(model_open(&file, path, &error), &error);
    must(model_get_modes(&modes, NULL, file, model, &error), &error);
    artefact_close(&file);
    for (size_t i = 0; i < model->grid.num_nodes * model->num_pressure && rounded; i++)
        modes[i] = (double)(float)modes[i];
    must(film_splines_build(&splines, model, modes, NULL, &error), &error);
    must(reduced_march_create(&in_time, model, &splines, reference, &settings, &error), &error);
    must(histories_init(&histories, given, &error), &error);
    march run = {.settings = march_settings_of(given, histories, given->approach),
                 .histories = histories,
                 .reference = reference,
                 .solver = reduced_march_solver(in_time),
                 .store = store,
                 .sink = result};
    result->reference = reference;
    must(march_begin(&first, &run, &error), &error);
    must(store(result, &first, 0, &error), &error);
    if (!first.status) must(march_run(&end, &run, &error), &error);
    result->converged = !first.status && !end;
    result->iterations = reduced_march_effort_of(in_time).iterations;
    histories_free(histories);
    reduced_march_free(in_time);
    film_splines_free(&splines);
    free(modes);
}

/* Compares the results of both precisions. Transient scenes need fixed steps, else steps would
 * differ. */
static void compare_results(const char *path, const ehd_contact *contact, const scene *given) {
    bool transient = strcmp(given->regime, "transient") == 0;
    outcome results[NUM_VARIANTS];
    double largest = 0;

    if (transient && isnan(given->transient.fixed_step)) {
        fprintf(stderr, "bench: transient.fixed_step: found none, expected one\n");
        exit(65);
    }
    for (int v = 0; v < NUM_VARIANTS; v++) {
        size_t most =
            transient ? (size_t)(given->transient.end_time / given->transient.fixed_step) + 10 : 1;
        reduced_model model;
        results[v] = (outcome){.film = must_allocate(most * sizeof(double)), .most_steps = most};
        read_variant(&model, path, variants[v]);
        if (transient)
            solve_in_time(&results[v], &model, v == SINGLE, path, contact, given);
        else
            solve_stationary(&results[v], &model, contact);
        reduced_model_free(&model);
    }
    const outcome *stored = &results[STORED], *single = &results[SINGLE];
    for (size_t i = 0; i < stored->num_steps && i < single->num_steps; i++)
        largest = fmax(largest, fabs(single->film[i] / stored->film[i] - 1));
    printf("M %g L %g: %zu and %zu steps, %zu and %zu iterations, %s and %s, central film at most "
           "%.2g apart\n",
           contact->moes_M, contact->moes_L, stored->num_steps, single->num_steps,
           stored->iterations, single->iterations, stored->converged ? "converged" : "failed",
           single->converged ? "converged" : "failed", largest);
    for (int v = 0; v < NUM_VARIANTS; v++)
        free(results[v].film);
}

// ---- kernels of an iteration

enum { REPEATS = 201 };

/* Operands of all kernels, in both precisions. */
typedef struct operands {
    int unknowns, equations, needed, cut,
        moved;                 // sizes; moved: nodes from a checkpoint to the exit
    double *a, *b, *c, *x, *y; // [largest] operands; each kernel gives them another meaning
    float *single_a, *single_b, *single_c, *single_x, *single_y; // in single precision
} operands;

typedef void kernel(const operands *of);

static void gram(const operands *of) {
    cblas_dsyrk(CblasColMajor, CblasLower, CblasNoTrans, of->unknowns, of->equations, 1, of->a,
                of->unknowns, 0, of->c, of->unknowns);
}
static void single_gram(const operands *of) {
    cblas_ssyrk(CblasColMajor, CblasLower, CblasNoTrans, of->unknowns, of->equations, 1,
                of->single_a, of->unknowns, 0, of->single_c, of->unknowns);
}
/* Factorises the identity, which is its own factor, so repeats need no copy. */
static void cholesky(const operands *of) {
    LAPACKE_dpotrf_work(LAPACK_COL_MAJOR, 'L', of->unknowns, of->b, of->unknowns);
}
static void single_cholesky(const operands *of) {
    LAPACKE_spotrf_work(LAPACK_COL_MAJOR, 'L', of->unknowns, of->single_b, of->unknowns);
}
static void substitutions(const operands *of) {
    for (int i = 0; i < 2; i++)
        cblas_dtrsv(CblasColMajor, CblasLower, i ? CblasTrans : CblasNoTrans, CblasNonUnit,
                    of->unknowns, of->b, of->unknowns, of->x, 1);
}
static void single_substitutions(const operands *of) {
    for (int i = 0; i < 2; i++)
        cblas_strsv(CblasColMajor, CblasLower, i ? CblasTrans : CblasNoTrans, CblasNonUnit,
                    of->unknowns, of->single_b, of->unknowns, of->single_x, 1);
}
/* Computes P and the products of the cut table, for a state and for a step. */
static void expansion(const operands *of) {
    for (int i = 0; i < 2; i++) {
        cblas_dgemv(CblasRowMajor, CblasNoTrans, of->needed, of->unknowns - 1, 1, of->a,
                    of->unknowns - 1, of->x, 1, 0, of->y, 1);
        cblas_dgemv(CblasRowMajor, CblasNoTrans, of->cut, of->unknowns - 1, 1, of->c,
                    of->unknowns - 1, of->x, 1, 0, of->y, 1);
    }
}
static void single_expansion(const operands *of) {
    for (int i = 0; i < 2; i++) {
        cblas_sgemv(CblasRowMajor, CblasNoTrans, of->needed, of->unknowns - 1, 1, of->single_a,
                    of->unknowns - 1, of->single_x, 1, 0, of->single_y, 1);
        cblas_sgemv(CblasRowMajor, CblasNoTrans, of->cut, of->unknowns - 1, 1, of->single_c,
                    of->unknowns - 1, of->single_x, 1, 0, of->single_y, 1);
    }
}
/* Moves the cut table to the exit. */
static void exit_update(const operands *of) {
    cblas_dgemm(CblasRowMajor, CblasTrans, CblasNoTrans, of->cut, of->unknowns - 1, of->moved, 1,
                of->x, of->cut, of->a, of->unknowns - 1, 1, of->c, of->unknowns - 1);
}
static void single_exit_update(const operands *of) {
    cblas_sgemm(CblasRowMajor, CblasTrans, CblasNoTrans, of->cut, of->unknowns - 1, of->moved, 1,
                of->single_x, of->cut, of->single_a, of->unknowns - 1, 1, of->single_c,
                of->unknowns - 1);
}
/* Sums rows of the Jacobian, each of seven rows of the bases. */
static void jacobian_rows(const operands *of) {
    for (int r = 0; r < of->equations; r++)
        for (int s = 0; s < 7; s++)
            for (int j = 0; j + 1 < of->unknowns; j++)
                of->c[r * of->unknowns + j] += of->x[s] * of->a[(r + s) * (of->unknowns - 1) + j];
}
static void single_jacobian_rows(const operands *of) {
    for (int r = 0; r < of->equations; r++)
        for (int s = 0; s < 7; s++)
            for (int j = 0; j + 1 < of->unknowns; j++)
                of->single_c[r * of->unknowns + j] +=
                    of->single_x[s] * of->single_a[(r + s) * (of->unknowns - 1) + j];
}

static const struct {
    const char *name;
    kernel *in_double, *in_single;
    bool factorises; // single precision is too inaccurate here (bench_conditioning)
} kernels[] = {{"rows of the Jacobian", jacobian_rows, single_jacobian_rows, false},
               {"exit update", exit_update, single_exit_update, false},
               {"states at nodes", expansion, single_expansion, false},
               {"Gram matrix", gram, single_gram, true},
               {"Cholesky", cholesky, single_cholesky, true},
               {"substitutions", substitutions, single_substitutions, true}};

static void operands_init(operands *self, const reduced_model *model) {
    size_t most =
        (model->cut.num_rows + model->rows.num_needed + model->rows.num_rows) * model->num_unknowns;

    self->unknowns = (int)model->num_unknowns;
    self->equations = (int)model->rows.num_rows + 1;
    self->needed = (int)model->rows.num_needed;
    self->cut = (int)model->cut.num_rows;
    self->moved = (int)(model->checkpoints.stride / 2);
    double **const in_double[] = {&self->a, &self->b, &self->c, &self->x, &self->y};
    float **const in_single[] = {&self->single_a, &self->single_b, &self->single_c, &self->single_x,
                                 &self->single_y};
    for (int i = 0; i < 5; i++) {
        *in_double[i] = must_allocate(most * sizeof(double));
        *in_single[i] = must_allocate(most * sizeof(float));
    }
    for (size_t j = 0; j < model->num_unknowns; j++)
        self->b[j * (model->num_unknowns + 1)] = self->single_b[j * (model->num_unknowns + 1)] = 1;
}

static void operands_free(operands *self) {
    void *const all[] = {self->a,        self->b,        self->c,        self->x,
                         self->y,        self->single_a, self->single_b, self->single_c,
                         self->single_x, self->single_y};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        free(all[i]);
}

/* Returns the median time in microseconds. */
static double time_kernel(kernel *run, const operands *of) {
    double times[REPEATS];

    for (size_t i = 0; i < REPEATS; i++) {
        double start = program_seconds();
        run(of);
        times[i] = program_seconds() - start;
    }
    return spread_of(times, REPEATS).median * 1e6;
}

/* Returns the median time of an iteration in microseconds. */
static double time_iteration(const reduced_model *model, const ehd_contact *contact) {
    const reduced_settings settings = reduced_default_settings();
    reduced_state state = {.coordinates = must_allocate(model->num_unknowns * sizeof(double))};
    reduced_solver *solver;
    reduced_info info;
    double times[REPEATS];
    ehd_error error;

    must(reduced_solver_create(&solver, model, &settings, &error), &error);
    for (size_t i = 0; i < REPEATS; i++) {
        reduced_guess(&state, model, contact_place_of(contact));
        must(reduced_solve(&info, &state, solver, contact, NULL, &error), &error);
        times[i] = info.seconds / (double)info.iterations;
    }
    reduced_solver_free(solver);
    free(state.coordinates);
    return spread_of(times, REPEATS).median * 1e6;
}

static void compare_kernels(const char *path, const ehd_contact *contact) {
    reduced_model model;
    operands of = {0};
    double saved = 0, saved_by_tables = 0;

    read_variant(&model, path, variants[STORED]);
    operands_init(&of, &model);
    printf("%d unknowns, %d equations, %d needed nodes: microseconds in an iteration, double and "
           "single\n",
           of.unknowns, of.equations, of.needed);
    for (size_t k = 0; k < sizeof kernels / sizeof *kernels; k++) {
        double in_double = time_kernel(kernels[k].in_double, &of);
        double in_single = time_kernel(kernels[k].in_single, &of);
        printf("%-20s %7.1f %7.1f\n", kernels[k].name, in_double, in_single);
        saved += in_double - in_single;
        if (!kernels[k].factorises) saved_by_tables += in_double - in_single;
    }
    double iteration = time_iteration(&model, contact);
    printf(
        "an iteration of this scene takes %.1f: single precision would take %.0f %% off, without "
        "the factorisation %.0f %%\n",
        iteration, saved / iteration * 100, saved_by_tables / iteration * 100);
    operands_free(&of);
    reduced_model_free(&model);
}

int main(int argc, char **argv) {
    scene given;
    ehd_contact contact;
    ehd_error error;

    if (argc < 4 || (strcmp(argv[1], "results") && strcmp(argv[1], "kernels"))) {
        fprintf(stderr,
                "usage: bench_precision results|kernels MODEL.h5 SCENE.yml [key=value ...]\n");
        return 64;
    }
    openblas_set_num_threads(1);
    must(scene_read(&given, argv[3], (const char *const *)argv + 4, (size_t)argc - 4, &error),
         &error);
    must(scene_contact(&contact, &given, &error), &error);
    if (strcmp(argv[1], "results") == 0)
        compare_results(argv[2], &contact, &given);
    else
        compare_kernels(argv[2], &contact);
    return 0;
}
