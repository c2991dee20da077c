/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Solves the linear systems of Newton by GMRES. The stencil rows and one FFT convolution give
 * products with the exact Jacobian. The preconditioner consists of UMFPACK's factors of a sparse
 * Jacobian, in which the shifted near field replaces the kernel (fullrun/README.md, Linear
 * systems). In a transient run Newton starts near the solution. There, the factors of the first
 * system of a time step precondition the later systems of this step too. On large grids a cycle of
 * multigrid replaces the factors (fullrun/README.md, Large point contacts).
 *
 * The sparse Jacobian is a band B, bordered by the column c of H0 and the closure's row. Only the
 * band is factorised, since with a full row UMFPACK's analysis takes O(n^2). The border follows
 * from w = B^-1 c. The shifted near field is positive definite (even, convex, falling to zero), so
 * that the band is not singular. */
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

/* Largest number of GMRES iterations. The vectors of the iterations take most of the solver's
 * memory. If a system needs more iterations, its solution is less accurate. 21 stationary line and
 * point contacts (M 1 to 1000, L 0 to 25) and three transient contacts need at most 20 iterations.
 * A line contact of 76801 nodes needs 77 (test_gmres.c, vectors_suffice_for_a_fine_grid). */
enum { MAX_ITERATIONS = 80 };

/* Factors of the band of one system. These factors may also precondition the next systems of
 * Newton's iteration. */
typedef struct near_factors {
    void *numeric; // factors by UMFPACK; NULL: no factors, as with a multigrid cycle
    double control[UMFPACK_CONTROL];
    size_t num_unknowns;
    size_t *unknown; // [num_unknowns] nodes of the unknowns
    size_t *index;   // [num_nodes] place of a node in `unknown`, or NO_NODE
    double *border;  // [num_unknowns] w = B^-1 c
    double border_pivot;
    // numbers of GMRES iterations. own_iterations: for the system that was factorised;
    // last_iterations: for the last system
    size_t own_iterations, last_iterations;
} near_factors;

struct gmres_workspace {
    size_t size; // largest number of unknowns
    size_t num_nodes;
    double *krylov;   // [MAX_ITERATIONS + 1, size]
    double *vector;   // [size]
    double *spread;   // [num_nodes] a vector on all grid nodes
    double *response; // [num_nodes] deflection of `spread`
    double *approach; // [size] c, the column of H0
    near_factors factors;
    multigrid *cycle;         // replaces the factors of the band; NULL: the band is factorised
    size_t part;              // nodes of one part of the work that threads share
    double *of_part;          // [parts of num_nodes] sum of each part
    double *right, *solution; // [size] right side and solution of a system with the factors
    // B, stored by rows; UMFPACK reads the rows as columns of the transpose
    int *row_start; // [size + 1]
    int *column;    // [capacity]
    double *value;  // [capacity]
    double *window; // [entries of a row] entries at the nodes around the node of the row
    size_t capacity;
    double *solve_work; // [5 size]
    int *solve_index;   // [size]
    arena memory;
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

/* Returns the largest number of entries of a row, from the limits in reach_of. */
static size_t entries_of_row(const ehd_grid *grid, size_t near_field) {
    return grid->inner_lines > 1 ? 4 * 3 : 2 * near_field + 4;
}

double gmres_workspace_bytes(const ehd_grid *grid) {
    const bool large = full_is_large(grid);
    const double vectors = MAX_ITERATIONS + 1 + (large ? 9 : 15);

    if (large) return vectors * sizeof(double) + multigrid_bytes(grid);
    return vectors * sizeof(double) +
           (double)entries_of_row(grid, 1) * (sizeof(double) + sizeof(int));
}

gmres_workspace *gmres_workspace_create(const ehd_grid *grid, const full_settings *settings) {
    const bool large = full_as_large(grid, settings);
    gmres_workspace *self = calloc(1, sizeof *self);
    if (!self) return NULL;
    arena *memory = &self->memory;
    size_t size = self->size = grid->num_inner + 1;
    const size_t window = entries_of_row(grid, settings->near_field);
    self->capacity = size * window;
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
    self->part = full_part(grid, large);
    self->of_part =
        arena_array(memory, team_num_parts(grid->num_nodes, self->part), sizeof(double));
    if (large) {
        self->cycle = multigrid_create(grid, settings->threads);
        return memory->failed || !self->cycle ? gmres_workspace_free(self) : self;
    }
    self->window = arena_array(memory, window, sizeof(double));
    self->row_start = arena_array(memory, (size + 1), sizeof(int));
    self->column = arena_array(memory, self->capacity, sizeof(int));
    self->value = arena_array(memory, self->capacity, sizeof(double));
    self->solve_work = arena_array(memory, 5 * size, sizeof(double));
    self->solve_index = arena_array(memory, size, sizeof(int));
    return memory->failed ? gmres_workspace_free(self) : self;
}

// ---- work that threads share, by parts of the unknowns or of the nodes

/* Context of shared work: a vector [size] to write and a vector to read. */
typedef struct vectors {
    full_system *system;
    double *to;
    const double *from;
    double factor;
} vectors;

static void share_unknowns(full_system *system, team_task *task, vectors *context) {
    const gmres_workspace *work = system->workspace;

    context->system = system;
    team_share(system->threads, system->num_unknowns, work->part, task, context);
}

static void share_nodes(full_system *system, team_task *task, vectors *context) {
    const gmres_workspace *work = system->workspace;

    context->system = system;
    team_share(system->threads, system->grid->num_nodes, work->part, task, context);
}

/* Returns the sum over all parts of the unknowns, added up in the order of the parts. */
static double sum_of_parts(const full_system *system) {
    const gmres_workspace *work = system->workspace;
    const size_t num_parts = team_num_parts(system->num_unknowns, work->part);
    double sum = 0;

    for (size_t i = 0; i < num_parts; i++)
        sum += work->of_part[i];
    return sum;
}

/* Writes the values of the unknowns to their nodes, and zero to all other nodes. */
static void spread_nodes(void *context, const team_part *part) {
    const vectors *task = context;
    const size_t *index = task->system->index;

    for (size_t k = part->first; k < part->end; k++)
        task->to[k] = index[k] == NO_NODE ? 0 : task->from[index[k]];
}

/* Computes y = J x at the unknowns of a part, and the sum that this part contributes to the load
 * balance. */
static void apply_rows(void *context, const team_part *part) {
    const vectors *task = context;
    const full_system *system = task->system;
    const gmres_workspace *work = system->workspace;
    const double *x = task->from, approach = x[system->num_unknowns];
    const int size = reynolds_stencil_size(system->grid);
    double sum = 0;

    for (size_t i = part->first; i < part->end; i++) {
        size_t r = grid_row_of_node(system->grid, system->unknown[i]);
        const reynolds_row *row = &system->rows[r];
        const reynolds_stencil *stencil = &system->stencils[r];
        double product = 0;
        for (int a = 0; a < size; a++) {
            size_t node = stencil->node[a];
            if (node == NO_NODE) continue;
            product += row->by_pressure[a] * work->spread[node] +
                       row->by_film[a] * (work->response[node] + approach);
        }
        task->to[i] = product * system->row_scale[r];
        sum += grid_weight(system->grid, system->unknown[i]) * x[i];
    }
    work->of_part[part->number] = sum;
}

/* Computes the exact y = J x at the unknowns with pressure, by rows and one FFT convolution. */
static void apply_jacobian(double *y, const double *x, full_system *system) {
    gmres_workspace *work = system->workspace;
    size_t num_passive = system->num_unknowns;

    share_nodes(system, spread_nodes, &(vectors){.to = work->spread, .from = x});
    deflection_apply(work->response, system->deflection, work->spread);
    // pressures of the far field cause no deflection
    for (size_t i = 0; system->outer && i < system->outer->num; i++) {
        const size_t node = system->outer->index[i];
        work->spread[node] = system->outer->by_approach[node] * x[num_passive];
    }
    share_unknowns(system, apply_rows, &(vectors){.to = y, .from = x});
    y[num_passive] =
        system->closure_approach * x[num_passive] + system->closure_load * sum_of_parts(system);
}

/* Columns and lines around a row's node that have entries in the band. These are the columns and
 * lines of the stencil and, on a line contact, the columns of the near field. On a point contact,
 * wider rows would cost more time in the factors than they save in iterations. For a multigrid
 * cycle, rows are computed with `wider` more columns at each end. */
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

/* Adds the derivatives of the film at a node with respect to the pressures of a line that is
 * `apart` lines away, times by_film. The derivatives are the shifted near field of the kernel. On a
 * wide ellipse, the next line is farther away than the end of the near field along a line. Then the
 * next line is left out, because its entries would be negative. With these entries a cold start of
 * b/a = 9.4 (81 by 49 nodes, M = 1429, L = 16) takes 960 iterations, without them 95. */
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

/* Computes the row of a node in the band matrix: its entries by grid line and column in `window`,
 * and its entry for H0 in `approach`. Returns the lines and columns of the window. */
static reach near_row(double *window, double *approach, const full_system *system, size_t row_node,
                      ptrdiff_t wider) {
    const ehd_grid *grid = system->grid;
    const size_t r = grid_row_of_node(grid, row_node);
    const reynolds_row *row = &system->rows[r];
    const reynolds_stencil *stencil = &system->stencils[r];
    const ptrdiff_t width = (ptrdiff_t)grid_width(grid);
    const reach at = reach_of(grid, row_node, (ptrdiff_t)system->near_field, wider);
    const ptrdiff_t columns = at.last_column - at.first_column + 1;
    const ptrdiff_t lines = at.last_line - at.first_line + 1;
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

/* Lists the entries of unknowns in the row of a node in the band matrix. Returns their number. */
static int fill_near_row(int *column, double *value, double *approach, const full_system *system,
                         size_t row_node) {
    double *window = ((gmres_workspace *)system->workspace)->window;
    const reach at = near_row(window, approach, system, row_node, 0);
    const ptrdiff_t width = (ptrdiff_t)grid_width(system->grid);
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

/* Columns beyond each end of a multigrid row that have entries: the stencil of accurate rows
 * reaches one column beyond the row, and the near field of the kernel reaches one column more. */
enum { CYCLE_WIDER = 2 };

/* Computes the row of a node for a multigrid cycle. The entries of columns beyond the row are added
 * to its first and last entries. Without them, differences along the line lack some of their nodes,
 * and solutions of the line grow or fade downstream: for M = 200, L = 20 and 256 cells a side GMRES
 * takes 197 instead of 109 iterations. */
static void fill_cycle_row(double *values, double *approach, const full_system *system,
                           size_t node) {
    const ehd_grid *grid = system->grid;
    const ptrdiff_t width = (ptrdiff_t)grid_width(grid);
    const ptrdiff_t line = (ptrdiff_t)node / width, column = (ptrdiff_t)node % width;
    const double scale = system->row_scale[grid_row_of_node(grid, node)];
    double window[CYCLE_LINES * (CYCLE_COLUMNS + 2 * CYCLE_WIDER)];
    const reach at = near_row(window, approach, system, node, CYCLE_WIDER);
    const double *next = window;

    for (ptrdiff_t l = at.first_line; l <= at.last_line; l++) {
        double *here = values + (l - line + 1) * CYCLE_COLUMNS + CYCLE_BACK;
        for (ptrdiff_t c = at.first_column - column; c <= at.last_column - column; c++)
            here[c < -CYCLE_BACK ? -CYCLE_BACK : (c > 1 ? 1 : c)] += *next++ / scale;
    }
}

static void fill_cycle_rows(void *context, const team_part *part) {
    const full_system *system = context;
    gmres_workspace *work = system->workspace;
    bool *unknown = multigrid_unknowns(work->cycle);

    for (size_t r = part->first; r < part->end; r++) {
        const size_t node = grid_node_of_row(system->grid, r), i = system->index[node];
        double *values = multigrid_rows(work->cycle) + r * CYCLE_ENTRIES;

        unknown[r] = i != NO_NODE;
        memset(values, 0, CYCLE_ENTRIES * sizeof *values);
        if (unknown[r]) fill_cycle_row(values, work->approach + i, system, node);
    }
}

/* Prepares a cycle with the band as its matrix. The rows are not scaled, since a coarser grid adds
 * up the residuals of several rows. Returns false if the matrix is singular. */
static bool prepare_cycle(full_system *system) {
    gmres_workspace *work = system->workspace;

    team_share(system->threads, system->grid->num_inner, work->part, fill_cycle_rows, system);
    return multigrid_prepare(work->cycle);
}

/* Factorises the band. Returns false if it is singular or there is no memory. */
static bool factorise(const full_system *system) {
    gmres_workspace *work = system->workspace;
    near_factors *factors = &work->factors;
    double *control = factors->control;
    int size = (int)system->num_unknowns;
    void *symbolic = NULL;

    umfpack_di_free_numeric(&factors->numeric);
    umfpack_di_defaults(control);
    // the band of a line contact has the least fill in its natural order. Weak pivoting keeps this
    // order, and is enough for a preconditioner
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

static void fill_cycle_right(void *context, const team_part *part) {
    const vectors *task = context;
    const full_system *system = task->system;
    const gmres_workspace *work = system->workspace;
    double *right = multigrid_right(work->cycle);

    for (size_t r = part->first; r < part->end; r++) {
        const size_t i = work->factors.index[grid_node_of_row(system->grid, r)];
        right[r] = i == NO_NODE ? 0 : task->from[i] / system->row_scale[r];
    }
}

static void take_cycle_solution(void *context, const team_part *part) {
    const vectors *task = context;
    const gmres_workspace *work = task->system->workspace;
    const double *solution = multigrid_solution(work->cycle);

    for (size_t i = part->first; i < part->end; i++)
        task->to[i] = solution[grid_row_of_node(task->system->grid, work->factors.unknown[i])];
}

/* Computes y = B^-1 x approximately by a multigrid cycle. */
static void apply_cycle(double *y, const double *x, full_system *system) {
    const gmres_workspace *work = system->workspace;
    vectors task = {.system = system, .to = y, .from = x};

    team_share(system->threads, system->grid->num_inner, work->part, fill_cycle_right, &task);
    multigrid_cycle(work->cycle);
    team_share(system->threads, work->factors.num_unknowns, work->part, take_cycle_solution, &task);
}

/* Computes y = B^-1 x on the unknowns of the factors. Returns false if UMFPACK fails. */
static bool solve_band(double *y, const double *x, full_system *system) {
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

static void sum_weighted(void *context, const team_part *part) {
    const vectors *task = context;
    const gmres_workspace *work = task->system->workspace;
    double sum = 0;

    for (size_t i = part->first; i < part->end; i++)
        sum += grid_weight(task->system->grid, work->factors.unknown[i]) * task->from[i];
    work->of_part[part->number] = sum;
}

/* Returns the sum of a vector over the unknowns of the factors, with the weights of the load
 * balance. */
static double weighted_sum(const double *vector, full_system *system) {
    const gmres_workspace *work = system->workspace;
    const size_t count = work->factors.num_unknowns;
    vectors task = {.system = system, .from = vector};
    double sum = 0;

    team_share(system->threads, count, work->part, sum_weighted, &task);
    for (size_t i = 0; i < team_num_parts(count, work->part); i++)
        sum += work->of_part[i];
    return sum;
}

/* Computes w = B^-1 c and the pivot of the closure's row. Returns false if the pivot is zero or not
 * finite. */
static bool solve_border(full_system *system) {
    gmres_workspace *work = system->workspace;
    near_factors *factors = &work->factors;

    if (!solve_band(factors->border, work->approach, system)) return false;
    double sum = weighted_sum(factors->border, system);
    factors->border_pivot = system->closure_load * sum - system->closure_approach;
    return isfinite(factors->border_pivot) && factors->border_pivot != 0;
}

/* Factorises the band of the present system, or prepares a multigrid cycle for it. Returns false if
 * memory is refused, the band is singular, or its border has no pivot. */
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

/* Number of GMRES iterations that take as long as new factors. In a transient run on 65 by 65
 * nodes, new factors take 3.8 ms and an iteration 0.35 ms. On a line contact of 1201 nodes factors
 * take 1.1 ms and an iteration 0.1 ms (test_gmres.c, factors_serve_the_whole_step). */
static const size_t COST_OF_FACTORS = 10;

/* Checks whether the time that kept factors save exceeds the time of the additional iterations that
 * they cause. */
static bool factors_serve(const near_factors *factors) {
    return factors->numeric &&
           factors->last_iterations <= factors->own_iterations + COST_OF_FACTORS;
}

/* Returns the entry of a row at its own node, without the deflection at the other nodes of its
 * stencil. */
static double own_entry(const full_system *system, size_t node) {
    const size_t r = grid_row_of_node(system->grid, node);
    const reynolds_row *row = &system->rows[r];
    const double kernel = deflection_kernel(system->deflection)[0];

    return (row->by_pressure[NODE_HERE] + row->by_film[NODE_HERE] * kernel) * system->row_scale[r];
}

/* Copies x at the unknowns of the factors. The copy is zero at nodes that are no unknowns of the
 * present system. */
static void take_known(void *context, const team_part *part) {
    const vectors *task = context;
    const full_system *system = task->system;
    const gmres_workspace *work = system->workspace;

    for (size_t i = part->first; i < part->end; i++) {
        const size_t index = system->index[work->factors.unknown[i]];
        task->to[i] = index == NO_NODE ? 0 : task->from[index];
    }
}

/* Subtracts the effect of the approach, `factor` times the border, from the solution of the
 * factors. At unknowns that the factors lack, divides x by own_entry instead. */
static void add_border(void *context, const team_part *part) {
    const vectors *task = context;
    const full_system *system = task->system;
    const gmres_workspace *work = system->workspace;
    const near_factors *factors = &work->factors;

    for (size_t i = part->first; i < part->end; i++) {
        const size_t node = system->unknown[i], index = factors->index[node];
        task->to[i] = index == NO_NODE
                          ? task->from[i] / own_entry(system, node)
                          : work->solution[index] - task->factor * factors->border[index];
    }
}

/* Computes y = [B c; closure]^-1 x with the factors. If the factors belong to an earlier system:
 * - Unknowns that only the earlier system had are zero.
 * - The row of a new unknown has only the entry at its own node.
 * - The rows may have had another scaling. Undoing this scaling saves no iterations (measured with
 *   loads that vary by +-10 and +-50 %). */
static void precondition(double *y, const double *x, full_system *system) {
    gmres_workspace *work = system->workspace;
    const near_factors *factors = &work->factors;
    const size_t num_passive = system->num_unknowns;
    vectors known = {.system = system, .to = work->right, .from = x};

    team_share(system->threads, factors->num_unknowns, work->part, take_known, &known);
    solve_band(work->solution, work->right, system);
    double sum = weighted_sum(work->solution, system);
    double approach = (system->closure_load * sum - x[num_passive]) / factors->border_pivot;
    share_unknowns(system, add_border, &(vectors){.to = y, .from = x, .factor = approach});
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

/* Context of a step of Gram-Schmidt on vectors [size]. */
typedef struct projection {
    gmres_workspace *work;
    double *fresh;
    const double *before; // `factor` times this vector is subtracted first; NULL: nothing is
                          // subtracted
    double factor;
    const double *with; // the product of this vector and `fresh` is computed next; NULL: the norm
                        // of `fresh` is computed
} projection;

static void project_part(void *context, const team_part *part) {
    const projection *task = context;
    const int count = (int)(part->end - part->first);
    double *fresh = task->fresh + part->first;

    if (task->before) cblas_daxpy(count, -task->factor, task->before + part->first, 1, fresh, 1);
    task->work->of_part[part->number] =
        task->with ? cblas_ddot(count, fresh, 1, task->with + part->first, 1)
                   : cblas_dnrm2(count, fresh, 1);
}

/* Runs project_part for all parts. Returns the product, or the norm. */
static double project(const projection *task, size_t size, team *threads) {
    const gmres_workspace *work = task->work;
    const size_t num_parts = team_num_parts(size, work->part);
    const double *of_part = work->of_part;
    double sum = 0;

    team_share(threads, size, work->part, project_part, (void *)task);
    if (num_parts == 1) return of_part[0];
    for (size_t i = 0; i < num_parts; i++)
        sum += task->with ? of_part[i] : of_part[i] * of_part[i];
    return task->with ? sum : sqrt(sum);
}

static void scale_part(void *context, const team_part *part) {
    const projection *task = context;

    cblas_dscal((int)(part->end - part->first), task->factor, task->fresh + part->first, 1);
}

/* Scales a new vector of the basis to length 1. Returns the length that it had before. */
static double normalise(projection *task, size_t size, team *threads) {
    task->with = NULL;
    const double length = project(task, size, threads);

    task->factor = length > 0 ? 1 / length : 0; // 0: no direction is left
    if (length > 0) team_share(threads, size, task->work->part, scale_part, task);
    return length;
}

/* Orthogonalises a new vector against the basis (modified Gram-Schmidt) and appends it. */
static void extend_krylov(gmres_workspace *work, hessenberg *h, size_t k, size_t size,
                          team *threads) {
    projection task = {.work = work, .fresh = work->krylov + (k + 1) * work->size};

    for (size_t i = 0; i <= k; i++) {
        task.with = work->krylov + i * work->size;
        task.factor = h->column[k][i] = project(&task, size, threads);
        task.before = task.with;
    }
    h->column[k][k + 1] = normalise(&task, size, threads);
}

/* Context of the last step of GMRES: the weighted sum of the basis. */
typedef struct krylov_sum {
    const gmres_workspace *work;
    const hessenberg *h;
    size_t num;
    double *sum; // [size]
} krylov_sum;

static void sum_krylov(void *context, const team_part *part) {
    const krylov_sum *task = context;
    const gmres_workspace *work = task->work;

    memset(task->sum + part->first, 0, (part->end - part->first) * sizeof(double));
    for (size_t i = 0; i < task->num; i++)
        cblas_daxpy((int)(part->end - part->first), task->h->right[i],
                    work->krylov + i * work->size + part->first, 1, task->sum + part->first, 1);
}

/* Copies the scaled residual of the unknowns with a negative sign, as the right side. */
static void take_residual(void *context, const team_part *part) {
    const vectors *task = context;
    const full_system *system = task->system;

    for (size_t i = part->first; i < part->end; i++) {
        const size_t r = grid_row_of_node(system->grid, system->unknown[i]);
        task->to[i] = -system->rows[r].residual * system->row_scale[r];
    }
}

ehd_status full_solve_gmres(full_system *system, double tolerance, size_t *iterations,
                            ehd_error *error) {
    gmres_workspace *work = system->workspace;
    size_t num_passive = system->num_unknowns, size = num_passive + 1, k = 0;
    hessenberg h;

    const bool kept = system->keeps_factors && factors_serve(&work->factors);
    if (!kept) {
        // If memory is refused, UMFPACK may choose another order of the unknowns that needs less
        // memory. The solution would then have other round-off, so refused memory is an error.
        errno = 0;
        const bool renewed = renew_factors(system), refused = errno == ENOMEM;
        if (!renewed || refused) umfpack_di_free_numeric(&work->factors.numeric);
        if (refused) return ehd_no_memory(error, "near-field Jacobian");
        if (!renewed)
            return ehd_fail(error, EHD_NOT_CONVERGED, "near-field Jacobian: found it singular");
    }

    // right preconditioning, so that the monitored residual is the true one
    projection first = {.work = work, .fresh = work->krylov};
    share_unknowns(system, take_residual, &(vectors){.to = first.fresh});
    first.fresh[num_passive] = -system->closure_residual;
    const double start = h.right[0] = normalise(&first, size, system->threads);
    while (k < MAX_ITERATIONS && fabs(h.right[k]) > tolerance * start && !program_interrupted()) {
        precondition(work->vector, work->krylov + k * work->size, system);
        apply_jacobian(work->krylov + (k + 1) * work->size, work->vector, system);
        extend_krylov(work, &h, k, size, system->threads);
        hessenberg_rotate(&h, k);
        k++;
    }
    *iterations = k;
    if (!kept) work->factors.own_iterations = k;
    work->factors.last_iterations = k;
    if (program_interrupted()) // an incomplete Newton step would not be reproducible
        return ehd_fail(error, EHD_INTERRUPTED, "full model: interrupted");

    // back substitution, then dz = M^-1 (V y)
    for (size_t i = k; i-- > 0;) {
        for (size_t j = i + 1; j < k; j++)
            h.right[i] -= h.column[j][i] * h.right[j];
        h.right[i] = h.column[i][i] != 0 ? h.right[i] / h.column[i][i] : 0;
    }
    krylov_sum ending = {work, &h, k, work->spread};
    team_share(system->threads, size, work->part, sum_krylov, &ending);
    precondition(work->vector, work->spread, system);
    share_nodes(system, spread_nodes, &(vectors){.to = system->step, .from = work->vector});
    system->step_approach = work->vector[num_passive];
    return EHD_OK;
}
