/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Linear systems of Newton by GMRES: products with the exact Jacobian by rows and FFT,
 * preconditioned by UMFPACK's factors of a sparse Jacobian, in which the kernel is its shifted near
 * field (fullrun/README.md, Linear systems). In a step in time, where Newton starts near the
 * solution, the factors of its first system serve the others. On large grids a cycle of multigrid
 * stands for the factors (Large point contacts).
 *
 * The sparse Jacobian is a band B, bordered by the column c of H0 and the closure's row. Only the
 * band is factorised, since with a full row UMFPACK's analysis takes O(n^2); the border follows
 * from w = B^-1 c. The shifted near field is positive definite (even, convex, falling to zero),
 * which keeps the band from being singular. */
#include "fullrun/gmres.h"

#include "common/program/arena.h"
#include "common/program/program.h"
#include "fullrun/multigrid.h"

#include <cblas.h>
#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <umfpack.h>

/* Vectors kept, most of the solver's memory; a system that needs more is left less accurate. Most
 * needed of 21 stationary lines and points (M 1 to 1000, L 0 to 25) and of 3 in time: 20; of lines
 * of 4801, 19201, 76801 nodes: 31, 46, 77. With 5, 10, 20, 40, 80 vectors Newton takes 36, 10, 4,
 * 4, 4 steps on the finest grid of 19201 (M = 200, L = 5), with 160 as with 80. */
enum { MAX_ITERATIONS = 80 };

/* Columns that a cycle's rows are wider at either end, before what is there is added to the entries at
 * their ends: without these a difference along the line that leaves out some of its nodes makes the
 * line's solutions grow or fade downstream. M = 200, L = 20, 256 cells a side: 251 GMRES iterations
 * without, 144 with, published rows 172 and 161; M = 1000, L = 5: 141 and 81, 105 and 72. */
enum { CYCLE_WIDER = 2 };

/* Factors of the band of one system, which serve the next ones of a Newton iteration. */
typedef struct near_factors {
    void *numeric; // NULL: none, as with a cycle
    double control[UMFPACK_CONTROL];
    size_t num_unknowns;
    size_t *unknown; // [num_unknowns] nodes
    size_t *index;   // [num_nodes] of a node in `unknown`, or NO_NODE
    double *border;  // [num_unknowns] w = B^-1 c
    double border_pivot;
    size_t own_iterations, last_iterations; // of the system they were made of, and of the last one
} near_factors;

struct gmres_workspace {
    size_t size; // largest number of unknowns
    size_t num_nodes;
    double *krylov;   // [MAX_ITERATIONS + 1, size]
    double *vector;   // [size]
    double *spread;   // [num_nodes] a vector on all grid nodes
    double *response; // [num_nodes] its deflection
    double *approach; // [size] c, the column of H0
    near_factors factors;
    multigrid *cycle;         // in place of the factors of the band; NULL: not
    double *right, *solution; // [size] of a system with the factors
    // B by rows, to UMFPACK the columns of the transpose
    int *row_start; // [size + 1]
    int *column;    // [capacity]
    double *value;  // [capacity]
    double *window; // [lines, columns of a reach] a row's values by node around it
    size_t capacity;
    double *solve_work; // [5 size]
    int *solve_index;   // [size]
    arena memory;       // of all arrays
};

gmres_workspace *gmres_workspace_free(gmres_workspace *self) {
    if (self) {
        umfpack_di_free_numeric(&self->factors.numeric);
        multigrid_free(self->cycle);
        arena_free(&self->memory);
    }
    free(self);
    return NULL;
}

/* Most entries of a row, as reach_of limits them. */
static size_t entries_of_row(const ehd_grid *grid, size_t near_field) {
    return grid->inner_lines > 1 ? 4 * 3 : 2 * near_field + 4;
}

double gmres_workspace_bytes(const ehd_grid *grid) {
    const bool large = full_is_large(grid);
    const double vectors = MAX_ITERATIONS + 1 + (large ? 9 : 15);

    if (large) return vectors * sizeof(double) + multigrid_bytes();
    return vectors * sizeof(double) +
           (double)entries_of_row(grid, 1) * (sizeof(double) + sizeof(int));
}

gmres_workspace *gmres_workspace_create(const ehd_grid *grid, size_t near_field) {
    gmres_workspace *self = calloc(1, sizeof *self);
    if (!self) return NULL;
    arena *memory = &self->memory;
    size_t size = self->size = grid->num_inner + 1;
    const size_t window = entries_of_row(grid, near_field) + CYCLE_LINES * 2 * CYCLE_WIDER;
    self->capacity = size * entries_of_row(grid, near_field);
    self->krylov = arena_array(memory, (MAX_ITERATIONS + 1) * size, sizeof(double));
    self->vector = arena_array(memory, size, sizeof(double));
    self->spread = arena_array(memory, grid->num_nodes, sizeof(double));
    self->response = arena_array(memory, grid->num_nodes, sizeof(double));
    self->approach = arena_array(memory, size, sizeof(double));
    self->factors.border = arena_array(memory, size, sizeof(double));
    self->factors.unknown = arena_array(memory, size, sizeof *self->factors.unknown);
    self->factors.index = arena_array(memory, grid->num_nodes, sizeof *self->factors.index);
    self->right = arena_array(memory, size, sizeof(double));
    self->solution = arena_array(memory, size, sizeof(double));
    self->window = arena_array(memory, window, sizeof(double));
    if (full_is_large(grid)) {
        self->cycle = multigrid_create(grid);
        return memory->failed || !self->cycle ? gmres_workspace_free(self) : self;
    }
    self->row_start = arena_array(memory, (size + 1), sizeof(int));
    self->column = arena_array(memory, self->capacity, sizeof(int));
    self->value = arena_array(memory, self->capacity, sizeof(double));
    self->solve_work = arena_array(memory, 5 * size, sizeof(double));
    self->solve_index = arena_array(memory, size, sizeof(int));
    return memory->failed ? gmres_workspace_free(self) : self;
}

/* y = J x on the passive unknowns, exact: rows and one FFT convolution. */
static void apply_jacobian(double *y, const double *x, full_system *system) {
    gmres_workspace *work = system->workspace;
    size_t num_passive = system->num_unknowns;
    const int size = reynolds_stencil_size(system->grid);
    double sum = 0;

    memset(work->spread, 0, system->grid->num_nodes * sizeof(double));
    for (size_t i = 0; i < num_passive; i++)
        work->spread[system->unknown[i]] = x[i];
    deflection_apply(work->response, system->deflection, work->spread);
    for (size_t i = 0; system->outer && i < system->outer->num; i++) { // without deflection
        const size_t node = system->outer->index[i];
        work->spread[node] = system->outer->by_approach[node] * x[num_passive];
    }
    for (size_t i = 0; i < num_passive; i++) {
        size_t r = grid_row_of_node(system->grid, system->unknown[i]);
        const reynolds_row *row = &system->rows[r];
        const reynolds_stencil *stencil = &system->stencils[r];
        double product = 0;
        for (int a = 0; a < size; a++) {
            size_t node = stencil->node[a];
            if (node == NO_NODE) continue;
            product += row->by_pressure[a] * work->spread[node] +
                       row->by_film[a] * (work->response[node] + x[num_passive]);
        }
        y[i] = product * system->row_scale[r];
        sum += grid_weight(system->grid, system->unknown[i]) * x[i];
    }
    y[num_passive] = system->closure_approach * x[num_passive] + system->closure_load * sum;
}

/* Columns and lines around a row's node that have entries in the band: those of its stencil, of a
 * line contact widened by the near field. Of a point contact wider rows cost more in the factors
 * than they save in iterations; for a cycle they are `wider` at first. */
typedef struct reach {
    ptrdiff_t first_column, last_column, first_line, last_line;
} reach;

static reach reach_of(const ehd_grid *grid, size_t node, ptrdiff_t near_field, ptrdiff_t wider) {
    const bool line_contact = grid->inner_lines == 1;
    const ptrdiff_t width = (ptrdiff_t)grid_width(grid);
    const ptrdiff_t column = (ptrdiff_t)node % width, line = (ptrdiff_t)node / width;
    const ptrdiff_t first_line = (ptrdiff_t)grid_first_line(grid);
    const ptrdiff_t last_line = first_line + (ptrdiff_t)grid->inner_lines - 1;
    const ptrdiff_t along = line_contact ? near_field : wider, across = line_contact ? 0 : 1;
    const reach wanted = {column - 2 - along, column + 1 + along, line - across, line + across};

    return (reach){wanted.first_column < 1 ? 1 : wanted.first_column,
                   wanted.last_column > width - 2 ? width - 2 : wanted.last_column,
                   wanted.first_line < first_line ? first_line : wanted.first_line,
                   wanted.last_line > last_line ? last_line : wanted.last_line};
}

/* Adds by_film times the shifted near field of a line's cells at a node `apart` lines away. The next
 * line of a wide ellipse is farther than what is beyond the band along, and left out: with its
 * negative entries a cold start of b/a = 9.4 (81 by 49 nodes, M = 1429, L = 16) takes 960 iterations,
 * without 95. A near field as many nodes wide as b/a takes 37, but its factors cost more than that. */
static void add_near_line(double *window, const reach *at, double by_film, ptrdiff_t column,
                          ptrdiff_t apart, const full_system *system) {
    const ptrdiff_t m = (ptrdiff_t)system->near_field;
    const double *kernel = deflection_kernel(system->deflection);
    const double far = kernel[m + 1];
    const double *of_line = kernel + labs(apart) * (ptrdiff_t)grid_width(system->grid);
    ptrdiff_t low = column - m < at->first_column ? at->first_column : column - m;
    ptrdiff_t high = column + m > at->last_column ? at->last_column : column + m;

    if (labs(apart) > m || !(of_line[0] > far)) return;
    for (ptrdiff_t c = low; c <= high; c++)
        window[c - at->first_column] += by_film * (of_line[labs(c - column)] - far);
}

/* The band's row of a node, in the workspace's window, and its entry of the column of H0. */
static reach near_row(double *approach, const full_system *system, size_t row_node,
                      ptrdiff_t wider) {
    const ehd_grid *grid = system->grid;
    const size_t r = grid_row_of_node(grid, row_node);
    const reynolds_row *row = &system->rows[r];
    const reynolds_stencil *stencil = &system->stencils[r];
    const ptrdiff_t width = (ptrdiff_t)grid_width(grid);
    const reach at = reach_of(grid, row_node, (ptrdiff_t)system->near_field, wider);
    const ptrdiff_t columns = at.last_column - at.first_column + 1;
    const ptrdiff_t lines = at.last_line - at.first_line + 1;
    double *window = ((gmres_workspace *)system->workspace)->window; // by line and column
    const int size = reynolds_stencil_size(grid);
    double scale = system->row_scale[r];

    *approach = 0;
    memset(window, 0, (size_t)(columns * lines) * sizeof *window);
    for (int a = 0; a < size; a++) {
        if (stencil->node[a] == NO_NODE) continue;
        ptrdiff_t here = (ptrdiff_t)stencil->node[a] % width;
        ptrdiff_t line = (ptrdiff_t)stencil->node[a] / width;
        double by_film = row->by_film[a] * scale;
        for (ptrdiff_t l = at.first_line; l <= at.last_line; l++) {
            double *of_line = window + (l - at.first_line) * columns;
            add_near_line(of_line, &at, by_film, here, l - line, system);
            if (grid->half && l > 0) add_near_line(of_line, &at, by_film, here, l + line, system);
        }
        if (here >= at.first_column && here <= at.last_column && line >= at.first_line &&
            line <= at.last_line)
            window[(line - at.first_line) * columns + here - at.first_column] +=
                row->by_pressure[a] * scale;
        *approach += by_film;
        if (system->outer)
            *approach += row->by_pressure[a] * scale * system->outer->by_approach[stencil->node[a]];
    }
    return at;
}

/* The entries of unknowns in the band's row of a node. Returns their number. */
static int fill_near_row(int *column, double *value, double *approach, const full_system *system,
                         size_t row_node) {
    const reach at = near_row(approach, system, row_node, 0);
    const ptrdiff_t width = (ptrdiff_t)grid_width(system->grid);
    const double *window = ((gmres_workspace *)system->workspace)->window;
    int count = 0;

    for (ptrdiff_t l = at.first_line; l <= at.last_line; l++)
        for (ptrdiff_t c = at.first_column; c <= at.last_column; c++, window++) {
            size_t index = system->index[l * width + c];
            if (index == NO_NODE) continue;
            column[count] = (int)index;
            value[count++] = *window;
        }
    return count;
}

static void assemble_near_field(full_system *system) {
    gmres_workspace *work = system->workspace;
    size_t num_passive = system->num_unknowns;
    int count = 0;

    for (size_t i = 0; i < num_passive; i++) {
        work->row_start[i] = count;
        count += fill_near_row(work->column + count, work->value + count, work->approach + i,
                               system, system->unknown[i]);
    }
    work->row_start[num_passive] = count;
}

/* The band as a cycle's matrix, whose rows are not scaled, since their residuals are added up. False
 * when it is singular. */
static bool prepare_cycle(full_system *system) {
    gmres_workspace *work = system->workspace;
    const ehd_grid *grid = system->grid;
    const ptrdiff_t width = (ptrdiff_t)grid_width(grid);
    bool *unknown = multigrid_unknowns(work->cycle);

    memset(unknown, 0, grid->num_inner * sizeof *unknown);
    memset(multigrid_rows(work->cycle), 0, grid->num_inner * CYCLE_ENTRIES * sizeof(double));
    for (size_t i = 0; i < system->num_unknowns; i++) {
        const size_t node = system->unknown[i], r = grid_row_of_node(grid, node);
        const ptrdiff_t line = (ptrdiff_t)node / width, column = (ptrdiff_t)node % width;
        const reach at = near_row(work->approach + i, system, node, CYCLE_WIDER);
        const double *window = work->window;

        unknown[r] = true;
        for (ptrdiff_t l = at.first_line; l <= at.last_line; l++) {
            double *here = multigrid_rows(work->cycle) + r * CYCLE_ENTRIES +
                           (l - line + 1) * CYCLE_COLUMNS + CYCLE_BACK;
            for (ptrdiff_t c = at.first_column - column; c <= at.last_column - column; c++)
                here[c < -CYCLE_BACK ? -CYCLE_BACK : (c > 1 ? 1 : c)] +=
                    *window++ / system->row_scale[r];
        }
    }
    return multigrid_prepare(work->cycle);
}

/* Factors of the band; false when it is singular or there is no memory. */
static bool factorise(const full_system *system) {
    gmres_workspace *work = system->workspace;
    near_factors *factors = &work->factors;
    double *control = factors->control;
    int size = (int)system->num_unknowns;
    void *symbolic = NULL;

    umfpack_di_free_numeric(&factors->numeric);
    umfpack_di_defaults(control);
    // a line's band has the least fill in its natural order, which weak pivoting, enough for a
    // preconditioner, keeps
    control[UMFPACK_STRATEGY] = UMFPACK_STRATEGY_SYMMETRIC;
    if (system->grid->inner_lines == 1) control[UMFPACK_ORDERING] = UMFPACK_ORDERING_NONE;
    control[UMFPACK_PIVOT_TOLERANCE] = 1e-3;
    control[UMFPACK_IRSTEP] = 0;
    if (umfpack_di_symbolic(size, size, work->row_start, work->column, work->value, &symbolic,
                            control, NULL) == UMFPACK_OK) {
        if (umfpack_di_numeric(work->row_start, work->column, work->value, symbolic,
                               &factors->numeric, control, NULL) != UMFPACK_OK)
            umfpack_di_free_numeric(&factors->numeric);
        umfpack_di_free_symbolic(&symbolic);
    }
    return factors->numeric != NULL;
}

/* y = B^-1 x, about, by a cycle. */
static void apply_cycle(double *y, const double *x, const full_system *system) {
    const gmres_workspace *work = system->workspace;
    double *right = multigrid_right(work->cycle);
    const double *solution = multigrid_solution(work->cycle);

    memset(right, 0, system->grid->num_inner * sizeof *right);
    for (size_t i = 0; i < work->factors.num_unknowns; i++) {
        const size_t r = grid_row_of_node(system->grid, work->factors.unknown[i]);
        right[r] = x[i] / system->row_scale[r];
    }
    multigrid_cycle(work->cycle);
    for (size_t i = 0; i < work->factors.num_unknowns; i++)
        y[i] = solution[grid_row_of_node(system->grid, work->factors.unknown[i])];
}

/* y = B^-1 x on the unknowns of the factors; false when UMFPACK cannot. */
static bool solve_band(double *y, const double *x, const full_system *system) {
    gmres_workspace *work = system->workspace;

    if (work->cycle) {
        apply_cycle(y, x, system);
        return true;
    }
    // B is stored by rows, so that UMFPACK's matrix is the transpose
    return umfpack_di_wsolve(UMFPACK_Aat, work->row_start, work->column, work->value, y, x,
                             work->factors.numeric, work->factors.control, NULL, work->solve_index,
                             work->solve_work) == UMFPACK_OK;
}

/* Sum of pressures at the factors' unknowns with the weights of the load balance. */
static double weighted_sum(const double *vector, const near_factors *factors,
                           const ehd_grid *grid) {
    double sum = 0;

    for (size_t i = 0; i < factors->num_unknowns; i++)
        sum += grid_weight(grid, factors->unknown[i]) * vector[i];
    return sum;
}

/* w = B^-1 c and the closure's pivot; false when singular. */
static bool solve_border(const full_system *system) {
    gmres_workspace *work = system->workspace;
    near_factors *factors = &work->factors;

    if (!solve_band(factors->border, work->approach, system)) return false;
    double sum = weighted_sum(factors->border, factors, system->grid);
    factors->border_pivot = system->closure_load * sum - system->closure_approach;
    return isfinite(factors->border_pivot) && factors->border_pivot != 0;
}

/* Factors of the system's own band, or a cycle for it; false when it is singular. */
static bool renew_factors(full_system *system) {
    gmres_workspace *work = system->workspace;
    near_factors *factors = &work->factors;
    const size_t count = system->num_unknowns;

    if (work->cycle) {
        if (!prepare_cycle(system)) return false;
    } else {
        assemble_near_field(system);
        if (!factorise(system)) return false;
    }
    factors->num_unknowns = count;
    memcpy(factors->unknown, system->unknown, count * sizeof *factors->unknown);
    memcpy(factors->index, system->index, system->grid->num_nodes * sizeof *factors->index);
    return solve_border(system);
}

/* Iterations that new factors take the time of: at 65 by 65 nodes in time 3.8 ms, 0.35 ms each, on a
 * line of 1201 nodes 1.1 and 0.1 ms. */
static const size_t COST_OF_FACTORS = 10;

/* Whether the factors of an earlier system spare more than they cost in iterations. */
static bool factors_serve(const near_factors *factors) {
    return factors->numeric &&
           factors->last_iterations <= factors->own_iterations + COST_OF_FACTORS;
}

/* The largest part of a row's entry at its own node. */
static double own_entry(const full_system *system, size_t node) {
    const size_t r = grid_row_of_node(system->grid, node);
    const reynolds_row *row = &system->rows[r];
    const double kernel = deflection_kernel(system->deflection)[0];

    return (row->by_pressure[NODE_HERE] + row->by_film[NODE_HERE] * kernel) * system->row_scale[r];
}

/* y = [B c; closure]^-1 x, with the factors of an earlier system: unknowns that it had alone are
 * zero, and new ones have their own entry alone. That the rows were scaled otherwise does not
 * matter: with a load of +-10 and +-50 % the iterations are the same when that is undone. */
static void precondition(double *y, const double *x, const full_system *system) {
    gmres_workspace *work = system->workspace;
    const near_factors *factors = &work->factors;
    const size_t num_passive = system->num_unknowns;

    for (size_t i = 0; i < factors->num_unknowns; i++) {
        const size_t index = system->index[factors->unknown[i]];
        work->right[i] = index == NO_NODE ? 0 : x[index];
    }
    solve_band(work->solution, work->right, system);
    double sum = weighted_sum(work->solution, factors, system->grid);
    double approach = (system->closure_load * sum - x[num_passive]) / factors->border_pivot;
    for (size_t i = 0; i < num_passive; i++) {
        const size_t node = system->unknown[i], index = factors->index[node];
        y[i] = index == NO_NODE ? x[i] / own_entry(system, node)
                                : work->solution[index] - approach * factors->border[index];
    }
    y[num_passive] = approach;
}

/* The small least-squares problem of GMRES, kept triangular by Givens rotations. */
typedef struct hessenberg {
    double column[MAX_ITERATIONS][MAX_ITERATIONS + 1]; // column[k] holds R's column k
    double cosine[MAX_ITERATIONS], sine[MAX_ITERATIONS];
    double right[MAX_ITERATIONS + 1];
} hessenberg;

static void hessenberg_rotate(hessenberg *h, size_t k) {
    double *column = h->column[k];

    for (size_t i = 0; i < k; i++) {
        double upper = h->cosine[i] * column[i] + h->sine[i] * column[i + 1];
        column[i + 1] = -h->sine[i] * column[i] + h->cosine[i] * column[i + 1];
        column[i] = upper;
    }
    double length = hypot(column[k], column[k + 1]);
    h->cosine[k] = length > 0 ? column[k] / length : 1;
    h->sine[k] = length > 0 ? column[k + 1] / length : 0;
    column[k] = length;
    h->right[k + 1] = -h->sine[k] * h->right[k];
    h->right[k] *= h->cosine[k];
}

/* Orthogonalises against the basis built so far (modified Gram-Schmidt) and appends. */
static void extend_krylov(gmres_workspace *work, hessenberg *h, size_t k, size_t size) {
    double *fresh = work->krylov + (k + 1) * work->size;

    for (size_t i = 0; i <= k; i++) {
        const double *old = work->krylov + i * work->size;
        h->column[k][i] = cblas_ddot((int)size, fresh, 1, old, 1);
        cblas_daxpy((int)size, -h->column[k][i], old, 1, fresh, 1);
    }
    h->column[k][k + 1] = cblas_dnrm2((int)size, fresh, 1);
    if (h->column[k][k + 1] > 0) cblas_dscal((int)size, 1 / h->column[k][k + 1], fresh, 1);
}

ehd_status full_solve_gmres(full_system *system, double tolerance, size_t *iterations,
                            ehd_error *error) {
    gmres_workspace *work = system->workspace;
    size_t num_passive = system->num_unknowns, size = num_passive + 1, k = 0;
    hessenberg h;

    const bool kept = system->keeps_factors && factors_serve(&work->factors);
    if (!kept) {
        // where memory is refused UMFPACK may do with less, in another order, of other rounding errors
        errno = 0;
        const bool renewed = renew_factors(system), refused = errno == ENOMEM;
        if (!renewed || refused) umfpack_di_free_numeric(&work->factors.numeric);
        if (refused) return ehd_fail(error, EHD_MEMORY, "near-field Jacobian: found no memory");
        if (!renewed)
            return ehd_fail(error, EHD_NOT_CONVERGED, "near-field Jacobian: found it singular");
    }

    // right preconditioning, so that the monitored residual is the true one
    double *first = work->krylov;
    for (size_t i = 0; i < num_passive; i++) {
        size_t r = grid_row_of_node(system->grid, system->unknown[i]);
        first[i] = -system->rows[r].residual * system->row_scale[r];
    }
    first[num_passive] = -system->closure_residual;
    double start = cblas_dnrm2((int)size, first, 1);
    if (start > 0) cblas_dscal((int)size, 1 / start, first, 1);
    h.right[0] = start;
    while (k < MAX_ITERATIONS && fabs(h.right[k]) > tolerance * start && !program_interrupted()) {
        precondition(work->vector, work->krylov + k * work->size, system);
        apply_jacobian(work->krylov + (k + 1) * work->size, work->vector, system);
        extend_krylov(work, &h, k, size);
        hessenberg_rotate(&h, k);
        k++;
    }
    *iterations = k;
    if (!kept) work->factors.own_iterations = k;
    work->factors.last_iterations = k;
    if (program_interrupted()) // its step would not be reproducible
        return ehd_fail(error, EHD_INTERRUPTED, "full model: interrupted");

    // back substitution, then dz = M^-1 (V y)
    for (size_t i = k; i-- > 0;) {
        for (size_t j = i + 1; j < k; j++)
            h.right[i] -= h.column[j][i] * h.right[j];
        h.right[i] = h.column[i][i] != 0 ? h.right[i] / h.column[i][i] : 0;
    }
    memset(work->spread, 0, size * sizeof(double));
    for (size_t i = 0; i < k; i++)
        cblas_daxpy((int)size, h.right[i], work->krylov + i * work->size, 1, work->spread, 1);
    precondition(work->vector, work->spread, system);

    memset(system->step, 0, system->grid->num_nodes * sizeof(double));
    for (size_t i = 0; i < num_passive; i++)
        system->step[system->unknown[i]] = work->vector[i];
    system->step_approach = work->vector[num_passive];
    return EHD_OK;
}
