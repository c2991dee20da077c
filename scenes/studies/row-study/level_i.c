/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Weights of the least squares with all Reynolds rows, none selected:
 *
 *     level_i BASIS.h5 PLAN.yml [key=value ...]
 *
 * Solves the points of the plan inside of the trained range with the full model and with the
 * reduced one, weighted as the basis says (D), by nothing, by the norm of each row as it is (D = 1
 * / |row| in every iteration), and by the inverse of the banded Jacobian B of the Reynolds rows:
 * least squares on B^-1 f. B keeps the kernel within some nodes, shifted to vanish behind them as
 * in the full solver's preconditioner, and is made once a scene, at its start, which trained
 * solutions make up; or once for all scenes, at the start of the one in the middle of the plan.
 *
 * It stops here: a component of B^-1 f takes all rows of f, B^-1 being full, so that with selected
 * rows it cannot be had from them. */
#include "common/physics/deflection.h"
#include "common/training/training_set.h"
#include "fullrun/continuation.h"
#include "fullrun/full_solver.h"
#include "romrun/calibrate/trade.h"
#include "romrun/model/basis_file.h"
#include "romrun/online/least_squares.h"
#include "romrun/online/reduced_solver.h"
#include "romrun/online/row_system.h"
#include "romrun/online/trained_range.h"

#include <cblas.h>
#include <lapacke.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void need(bool holds, const char *what) {
    if (holds) return;
    fprintf(stderr, "level_i: %s\n", what);
    exit(1);
}

static void *claim(size_t count) {
    void *memory = calloc(count, sizeof(double));

    need(memory, "memory: found none");
    return memory;
}

// ---- the band

typedef struct band {
    const reduced_model *model;
    const reduced_basis *basis;
    size_t width;         // nodes of the kernel kept, to either side
    double *rows;         // [num_inner, 2 * reach + 1] B, row r of node r + 1
    size_t reach;         // of a row, in nodes: kernel and stencil
    double *factors;      // as dgbtrf wants it
    lapack_int *pivots;   // [num_inner]
    double *columns;      // [num_unknowns + 1, num_inner] matrix and right side
    double *pressure;     // [num_nodes]
    double *film;         // [num_nodes]
    double *fluid_memory; // [NUM_FLUID_ARRAYS, num_nodes]
    ehd_deflection *deflection;
    reynolds_row *reynolds; // [num_inner]
} band;

static band band_create(const reduced_model *model, const reduced_basis *basis, size_t width) {
    const size_t num_nodes = basis->grid.num_nodes, reach = width + 3;
    band self = {.model = model, .basis = basis, .width = width, .reach = reach};

    self.rows = claim(num_nodes * (2 * reach + 1));
    self.factors = claim(num_nodes * (3 * reach + 1));
    self.pivots = claim(num_nodes);
    self.columns = claim((model->num_unknowns + 1) * num_nodes);
    self.pressure = claim(num_nodes);
    self.film = claim(num_nodes);
    self.fluid_memory = claim(NUM_FLUID_ARRAYS * num_nodes);
    self.deflection = deflection_create(basis->kind, &basis->grid);
    self.reynolds = malloc(num_nodes * sizeof *self.reynolds);
    need(self.deflection && self.reynolds, "memory: found none");
    return self;
}

static void band_free(band *self) {
    free(self->rows);
    free(self->factors);
    free(self->pivots);
    free(self->columns);
    free(self->pressure);
    free(self->film);
    free(self->fluid_memory);
    free(self->reynolds);
    deflection_free(self->deflection);
}

/* P and H of a reduced state on the grid. */
static void expand(band *self, const reduced_state *state) {
    const reduced_basis *basis = self->basis;
    const ehd_grid *grid = &basis->grid;

    for (size_t k = 0; k < grid->num_nodes; k++)
        self->pressure[k] = k < state->exit ? cblas_ddot((int)basis->num_pressure,
                                                         basis->pressure + k * basis->num_pressure,
                                                         1, state->coordinates, 1)
                                            : 0;
    deflection_apply(self->film, self->deflection, self->pressure);
    for (size_t k = 0; k < grid->num_nodes; k++)
        self->film[k] += state->coordinates[self->model->num_unknowns - 1] + grid_gap(grid, k);
}

/* Reynolds rows at the state: pressure's own coefficients and, by the film, the near field of the
 * kernel. */
static void band_fill(band *self, const reduced_state *state, const ehd_contact *contact) {
    const ehd_grid *grid = &self->basis->grid;
    const size_t num_nodes = grid->num_nodes, num_inner = grid->num_inner, reach = self->reach;
    const double *kernel = deflection_kernel(self->deflection);
    reynolds_fluid fluid = reynolds_fluid_in(self->fluid_memory, num_nodes, contact);

    expand(self, state);
    reynolds_fluid_evaluate(&fluid, contact, self->pressure, num_nodes);
    memset(self->rows, 0, num_inner * (2 * reach + 1) * sizeof(double));
    for (size_t r = 0; r < num_inner; r++) {
        const reynolds_stencil stencil = reynolds_stencil_at(grid, r + 1);
        double *row = self->rows + r * (2 * reach + 1) + reach; // row[d]: of node r + 1 + d
        reynolds_rows(&self->reynolds[r], grid, contact->entrainment, NULL, &stencil, 1, &fluid,
                      self->pressure, self->film);
        for (int a = 0; a < NUM_STENCIL; a++) {
            if (stencil.node[a] == NO_NODE) continue;
            const ptrdiff_t at = (ptrdiff_t)stencil.node[a] - (ptrdiff_t)(r + 1);
            const ptrdiff_t width = (ptrdiff_t)self->width;
            row[at] += self->reynolds[r].by_pressure[a];
            for (ptrdiff_t d = -width; d <= width; d++)
                row[at + d] += self->reynolds[r].by_film[a] *
                               (kernel[d < 0 ? -d : d] - kernel[self->width + 1]);
        }
    }
}

/* Factors of the rows and columns before the exit, which are the first `count`. */
static void band_factor(band *self, size_t count) {
    const size_t reach = self->reach, height = 3 * reach + 1;

    memset(self->factors, 0, count * height * sizeof(double));
    for (size_t r = 0; r < count; r++)
        for (size_t c = r > reach ? r - reach : 0; c < count && c <= r + reach; c++)
            self->factors[c * height + 2 * reach + r - c] =
                self->rows[r * (2 * reach + 1) + reach + c - r];
    need(LAPACKE_dgbtrf(LAPACK_COL_MAJOR, (int)count, (int)count, (int)reach, (int)reach,
                        self->factors, (int)height, self->pivots) == 0,
         "band: found it singular");
}

/* Before the exit lie the first rows of all, so that row r is the model's. */
static void apply_inverse(void *context, double *matrix, double *right, size_t num_rows) {
    band *self = context;
    const size_t num_unknowns = self->model->num_unknowns;

    band_factor(self, num_rows);
    for (size_t r = 0; r < num_rows; r++) {
        const double weight = self->model->rows.weight[r];
        for (size_t j = 0; j < num_unknowns; j++)
            self->columns[j * num_rows + r] = matrix[r * num_unknowns + j] / weight;
        self->columns[num_unknowns * num_rows + r] = right[r] / weight;
    }
    need(LAPACKE_dgbtrs(LAPACK_COL_MAJOR, 'N', (int)num_rows, (int)self->reach, (int)self->reach,
                        (int)num_unknowns + 1, self->factors, (int)(3 * self->reach + 1),
                        self->pivots, self->columns, (int)num_rows) == 0,
         "band: found no solution");
    for (size_t r = 0; r < num_rows; r++) {
        for (size_t j = 0; j < num_unknowns; j++)
            matrix[r * num_unknowns + j] = self->columns[j * num_rows + r];
        right[r] = self->columns[num_unknowns * num_rows + r];
    }
}

static void make_unit_rows(void *context, double *matrix, double *right, size_t num_rows) {
    const reduced_model *model = context;

    for (size_t r = 0; r < num_rows; r++) {
        double *row = matrix + r * model->num_unknowns;
        const double norm = cblas_dnrm2((int)model->num_unknowns, row, 1);
        if (!(norm > 0)) continue;
        cblas_dscal((int)model->num_unknowns, 1 / norm, row, 1);
        right[r] /= norm;
    }
}

// ---- the scenes

static double *solve_full(const training_set *set) {
    const full_settings settings = full_default_settings();
    double *film = claim(set->num_points);
    full_solver *solver;
    full_state state;

    need(!full_solver_create(&solver, set->kind, &set->grid, &settings, NULL) &&
             !full_state_init(&state, &set->grid, NULL),
         "memory: found none");
    for (size_t i = 0; i < set->num_points; i++) {
        full_info info;
        need(!full_solve_cold(&info, &state, solver, &set->contacts[i], NULL) && !info.status,
             "full model: found a scene not converged");
        film[i] = full_evaluate_scalars(&state, &set->contacts[i]).central_film_thickness;
    }
    full_state_free(&state);
    full_solver_free(solver);
    return film;
}

/* What is done to the Reynolds rows of a least-squares problem, weighted by D, and to their right
 * side. */
typedef void row_change(void *context, double *matrix, double *right, size_t num_rows);

/* One way to weight: name, and what is done to the rows. */
typedef struct variant {
    const char *name;
    row_change *change; // NULL: D of the basis
    void *context;
    band *band; // filled at each start, where there is one
} variant;

/* A linear solver that changes the rows first. */
typedef struct changed_rows {
    const variant *way;
    least_squares *workspace;
    double *matrix, *right; // [num_rows + 1, num_unknowns], [num_rows + 1]
} changed_rows;

static ehd_status solve_changed(double *step, void *context, const double *matrix,
                                const double *right, size_t num_rows, size_t num_unknowns) {
    changed_rows *self = context;

    memcpy(self->matrix, matrix, num_rows * num_unknowns * sizeof(double));
    memcpy(self->right, right, num_rows * sizeof(double));
    if (self->way->change) // but for the closure
        self->way->change(self->way->context, self->matrix, self->right, num_rows - 1);
    return least_squares_solve(step, self->workspace, self->matrix, self->right, num_rows);
}

static void measure(const variant *way, const reduced_model *model, const training_set *set,
                    const bool *inside, const double *film) {
    const size_t max_rows = system_max_rows(model);
    changed_rows rows = {.way = way,
                         .workspace = least_squares_create(max_rows, model->num_unknowns),
                         .matrix = claim(max_rows * model->num_unknowns),
                         .right = claim(max_rows)};
    reduced_settings settings = reduced_default_settings();
    double *deviations = claim(set->num_points);
    size_t num_solved = 0, num_failed = 0, most = 0, all = 0;
    double seconds = 0;
    reduced_state state = {.coordinates = claim(model->num_unknowns)};
    reduced_solver *solver;

    settings.solve_linear = solve_changed;
    settings.linear_context = &rows;
    need(rows.workspace && !reduced_solver_create(&solver, model, &settings, NULL),
         "memory: found none");
    for (size_t i = 0; i < set->num_points; i++) {
        const ehd_contact *contact = &set->contacts[i];
        reduced_info info;
        if (!inside[i]) continue;
        reduced_guess(&state, model, contact_place_of(contact));
        if (way->band) band_fill(way->band, &state, contact);
        need(!reduced_solve(&info, &state, solver, contact, NULL, NULL), "memory: found none");
        if (info.status) {
            num_failed++;
            continue;
        }
        deviations[num_solved++] = fabs(info.scalars.central_film_thickness / film[i] - 1);
        all += info.iterations;
        if (info.iterations > most) most = info.iterations;
        seconds += info.seconds;
    }
    printf("%-22s %8.1e %8.1e %8.1e  %5.1f %4zu %7.1f %4zu\n", way->name,
           trade_quantile_of(deviations, num_solved, 0.5),
           trade_quantile_of(deviations, num_solved, 0.95),
           trade_quantile_of(deviations, num_solved, 1), (double)all / (double)num_solved, most,
           1e3 * seconds / (double)num_solved, num_failed);
    free(deviations);
    free(state.coordinates);
    free(rows.matrix);
    free(rows.right);
    least_squares_free(rows.workspace);
    reduced_solver_free(solver);
}

int main(int argc, char **argv) {
    ehd_error error = {""};
    reduced_basis basis;
    char identity[65];
    plan given;
    training_set set = {0};
    reduced_model model;

    need(argc >= 3, "arguments: expected BASIS.h5 PLAN.yml");
    need(!basis_read(&basis, identity, argv[1], &error) &&
             !plan_read(&given, argv[2], (const char *const *)argv + 3, (size_t)argc - 3, &error) &&
             !training_set_init(&set, &given, argv[2], (shard){1, 1}, &error) &&
             !reduced_model_build(&model, &basis, NULL, 0, &error),
         error.text);
    need(basis.deformation == DEFORMATION_COUPLED, "basis: expected a coupled one");

    trained_range *range = trained_range_create(&model);
    bool *inside = claim(set.num_points);
    double *film = solve_full(&set);
    need(range, "memory: found none");
    for (size_t i = 0; i < set.num_points; i++)
        inside[i] = !trained_range_check(range, NULL, contact_place_of_any(&set.contacts[i]), NULL);

    band bands[] = {band_create(&model, &basis, 0), band_create(&model, &basis, 10),
                    band_create(&model, &basis, 100)};
    band one = band_create(&model, &basis, 0);
    reduced_state middle = {.coordinates = claim(model.num_unknowns)};
    const ehd_contact *contact = &set.contacts[set.num_points / 2];
    reduced_guess(&middle, &model, contact_place_of(contact));
    band_fill(&one, &middle, contact);

    const variant ways[] = {{"D of the basis", NULL, NULL, NULL},
                            {"unit rows", make_unit_rows, &model, NULL},
                            {"band, kernel 0 nodes", apply_inverse, &bands[0], &bands[0]},
                            {"band, kernel 10 nodes", apply_inverse, &bands[1], &bands[1]},
                            {"band, kernel 100 nodes", apply_inverse, &bands[2], &bands[2]},
                            {"band of one scene", apply_inverse, &one, NULL}};
    printf("all %zu rows, %zu modes\n%-22s %8s %8s %8s  %5s %4s %7s %4s\n", model.rows.num_rows,
           model.num_pressure, "", "median", "95 %", "worst", "mean", "most", "ms", "fail");
    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++)
        measure(&ways[i], &model, &set, inside, film);

    for (size_t i = 0; i < sizeof bands / sizeof *bands; i++)
        band_free(&bands[i]);
    band_free(&one);
    free(middle.coordinates);
    free(inside);
    free(film);
    trained_range_free(range);
    reduced_model_free(&model);
    training_set_free(&set);
    plan_free(&given);
    reduced_basis_free(&basis);
    return 0;
}
