/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs cycles of multigrid (A. Brandt, Math. Comp. 31, 1977; W. Hackbusch, Multi-Grid Methods and
 * Applications, Springer 1985). A cycle has three stages:
 * 1. It solves the odd lines, which do not touch one another, then the even lines.
 * 2. It carries the residual to a coarser grid with every other node and line. The matrix of this
 *    grid is the Galerkin product. The coarser grid is solved in the same way.
 * 3. It carries the correction back, and solves the odd lines again, then the even lines.
 *
 * Where the entrainment dominates, lines hardly influence each other, and solving single lines is
 * nearly enough. Where the pressure flow is large in both directions, the coarser grids are needed.
 * The stencil has the same size on all grids. If the flow across the lines is much larger than the
 * flow along them, as in a narrow ellipse, the coarser grid keeps all nodes of a line. Otherwise an
 * error would remain that varies from node to node along the lines, but hardly from line to line.
 *
 * In stage 1 the even lines, which the coarser grid has too, are solved last, so their residual is
 * zero. In stage 3 the odd lines are solved first, so they need no correction. */
#include "fullrun/multigrid.h"

#include "common/program/arena.h"

#include <lapacke.h>
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* A grid is the coarsest one if it has at most COARSEST lines or at most COARSEST columns. A band
 * matrix solves it. With COARSEST = 4 the cycles converge too slowly (test_multigrid.c,
 * cycles_converge_on_any_grid). */
enum { COARSEST = 40 };

enum { MAX_LEVELS = 20 }; // number of grids; each has half of the lines of the grid before

/* Factors L U of a line's matrix in the row of node c: the entries of L in the columns c - 2 and c
 * - 1, the reciprocal of the diagonal entry of U, and the entry of U in column c + 1. */
enum { BY_BACK2, BY_BACK, BY_HERE, BY_AHEAD, NUM_LINE_FACTORS };

/* Approximate number of nodes in one part of the work that threads share. */
enum { PART = 2048 };

typedef struct level {
    size_t columns, lines, num;
    size_t stride;      // columns of the finer level per column of this level, 1 or 2
    double flow_across; // flow between two neighbouring nodes across the lines, divided by the flow
                        // between two neighbouring nodes along them
    size_t lines_of_part;
    bool mirrored;    // the first line is a mirror line
    bool *unknown;    // [num]
    double *row;      // [num, CYCLE_ENTRIES]
    double *factors;  // [num, NUM_LINE_FACTORS]
    double *right;    // [num]
    double *solution; // [num]
} level;

/* Shape of a band matrix in LAPACK: number of diagonals below the main diagonal, number of
 * diagonals above it, and number of rows in memory. */
typedef struct band_shape {
    int below, above, rows;
} band_shape;

struct multigrid {
    level levels[MAX_LEVELS]; // the finest first
    size_t num;
    double *rest;         // [num of the finest level] residual of the odd lines
    team *threads;        // NULL: one thread does all work
    atomic_bool singular; // whether a line's matrix is singular
    // LU factors by LAPACK of the coarsest level's band, with nodes in the order of band_place
    band_shape shape;
    double *band;     // [num, shape.rows]
    int *pivots;      // [num]
    double *in_order; // [num]
    arena memory;
};

static bool is_coarsest(const level *self) {
    return self->columns <= COARSEST || self->lines <= COARSEST;
}

/* Halves the number of lines. If the flow across the lines then is still larger than the flow along
 * them, the coarser grid keeps all nodes of a line. If it dropped every other node of such lines,
 * GMRES would stall (README.md, Large point contacts; test_multigrid.c,
 * cycles_converge_on_narrow_ellipses). */
static level coarser(const level *fine) {
    const double fewer_lines = fine->flow_across / 4; // flow_across if only the lines are halved
    const size_t stride = fewer_lines > 1 ? 1 : 2;
    level coarse = {.columns = (fine->columns + stride - 1) / stride,
                    .lines = (fine->lines + 1) / 2,
                    .stride = stride,
                    .flow_across = fewer_lines * (double)(stride * stride),
                    .mirrored = fine->mirrored};

    coarse.num = coarse.columns * coarse.lines;
    return coarse;
}

static level finest(const ehd_grid *grid) {
    return (level){.columns = grid->inner_x,
                   .lines = grid->inner_lines,
                   .num = grid->num_inner,
                   .flow_across = grid->shape.flow_across / (grid->shape.cell * grid->shape.cell),
                   .mirrored = grid->half};
}

/* Returns the place of a node of the coarsest grid in the band. Nodes are numbered along the
 * shorter side first, so that the band is narrow however long the other side is. */
static size_t band_place(const level *self, size_t column, size_t line) {
    return self->lines <= self->columns ? column * self->lines + line
                                        : line * self->columns + column;
}

static band_shape band_of(const level *self) {
    band_shape shape;

    if (self->lines <= self->columns) {
        shape.below = (int)(CYCLE_BACK * self->lines + 1);
        shape.above = (int)self->lines + 1;
    } else {
        shape.below = (int)self->columns + CYCLE_BACK;
        shape.above = (int)self->columns + 1;
    }
    shape.rows = 2 * shape.below + shape.above + 1;
    return shape;
}

double multigrid_bytes(const ehd_grid *grid) {
    const double numbers = CYCLE_ENTRIES + NUM_LINE_FACTORS + 2;
    level last = finest(grid);
    double nodes = (double)last.num;

    while (!is_coarsest(&last)) {
        last = coarser(&last);
        nodes += (double)last.num;
    }
    const double of_band = (double)last.num * band_of(&last).rows * sizeof(double);
    const double of_levels = nodes * (numbers * sizeof(double) + sizeof(bool));
    return (of_levels + of_band) / (double)grid->num_inner + sizeof(double);
}

static void allocate_level(level *self, arena *memory) {
    self->lines_of_part = self->columns < PART ? PART / self->columns : 1;
    self->unknown = arena_array(memory, self->num, sizeof *self->unknown);
    self->row = arena_table(memory, self->num, CYCLE_ENTRIES, sizeof(double));
    self->factors = arena_table(memory, self->num, NUM_LINE_FACTORS, sizeof(double));
    self->right = arena_array(memory, self->num, sizeof(double));
    self->solution = arena_array(memory, self->num, sizeof(double));
}

multigrid *multigrid_create(const ehd_grid *grid, team *threads) {
    multigrid *self = calloc(1, sizeof *self);
    if (!self) return NULL;
    arena *memory = &self->memory;
    level next = finest(grid);
    self->threads = threads;

    for (;; next = coarser(&next)) {
        level *here = &self->levels[self->num++];
        *here = next;
        allocate_level(here, memory);
        if (is_coarsest(here) || self->num == MAX_LEVELS) break;
    }
    const level *last = &self->levels[self->num - 1];
    self->shape = band_of(last);
    self->rest = arena_array(memory, grid->num_inner, sizeof(double));
    self->band = arena_table(memory, last->num, (size_t)self->shape.rows, sizeof(double));
    self->pivots = arena_array(memory, last->num, sizeof(int));
    self->in_order = arena_array(memory, last->num, sizeof(double));
    return memory->failed ? multigrid_free(self) : self;
}

multigrid *multigrid_free(multigrid *self) {
    if (self) arena_free(&self->memory);
    free(self);
    return NULL;
}

double *multigrid_rows(multigrid *self) {
    return self->levels[0].row;
}

bool *multigrid_unknowns(multigrid *self) {
    return self->levels[0].unknown;
}

double *multigrid_right(multigrid *self) {
    return self->levels[0].right;
}

const double *multigrid_solution(const multigrid *self) {
    return self->levels[0].solution;
}

// ---- matrices

/* Context of work on all lines of a level, or on every other one. */
typedef struct lines_task {
    multigrid *of;
    level *here, *coarse; // the level, and the next coarser level
    size_t first_line;    // first line if the work is on every other line: 0 or 1
} lines_task;

static void share_lines(multigrid *self, size_t lines, const level *size_of, team_task *task,
                        lines_task *context) {
    context->of = self;
    team_share(self->threads, lines, size_of->lines_of_part, task, context);
}

/* Keeps in the rows only the entries between unknowns. Rows of nodes that are no unknowns become
 * rows of the identity matrix. */
static void clear_others(void *context, const team_part *part) {
    const level *self = ((lines_task *)context)->here;

    for (size_t l = part->first; l < part->end; l++)
        for (size_t c = 0; c < self->columns; c++) {
            const size_t node = l * self->columns + c;
            double *row = self->row + node * CYCLE_ENTRIES;
            for (size_t a = 0; a < CYCLE_ENTRIES; a++) {
                const size_t line = l + a / CYCLE_COLUMNS - 1; // wraps around below line 0
                const size_t column = c + a % CYCLE_COLUMNS - CYCLE_BACK;
                const bool there = line < self->lines && column < self->columns;
                if (!there || !self->unknown[node] || !self->unknown[line * self->columns + column])
                    row[a] = 0;
            }
            if (!self->unknown[node]) row[CYCLE_COLUMNS + CYCLE_BACK] = 1;
        }
}

/* Adds `entry`, which multiplies the value at a fine node, to `row`, the row of the coarse node (l,
 * c). The entry is divided among the coarse nodes from which the fine node is interpolated, by the
 * weights of the interpolation. */
static void add_interpolated(double *row, double entry, size_t fine_line, size_t fine_column,
                             size_t l, size_t c, const level *coarse) {
    const size_t stride = coarse->stride;

    for (size_t line = fine_line / 2; line <= (fine_line + 1) / 2; line++)
        for (size_t column = fine_column / stride; column <= (fine_column + stride - 1) / stride;
             column++) {
            if (line >= coarse->lines || column >= coarse->columns) continue;
            const double part = (fine_line % 2 ? 0.5 : 1) * (fine_column % stride ? 0.5 : 1);
            row[(line + 1 - l) * CYCLE_COLUMNS + column + CYCLE_BACK - c] += part * entry;
        }
}

/* Returns the weight of a fine line's residual in the residual of coarse line l. At a mirror line
 * the line above also counts for the line below, its mirror image. */
static double weight_of_line(const level *fine, size_t l, size_t fine_line) {
    if (fine_line == 2 * l) return 1;
    return fine->mirrored && l == 0 ? 1 : 0.5;
}

/* Return the first fine line around a coarse line, and the line behind the last one. There are
 * `stride` fine lines for each coarse line. Both functions also work for columns. */
static size_t first_around(size_t coarse, size_t stride) {
    return coarse > 0 ? stride * coarse - (stride - 1) : 0;
}

static size_t end_around(size_t coarse, size_t stride, size_t fine_count) {
    const size_t end = stride * (coarse + 1);

    return end < fine_count ? end : fine_count;
}

/* Computes the row of a coarse node in the Galerkin product. */
static void fill_coarse_row(level *coarse, const level *fine, size_t l, size_t c) {
    const size_t stride = coarse->stride, end = end_around(c, stride, fine->columns);
    double *row = coarse->row + (l * coarse->columns + c) * CYCLE_ENTRIES;

    memset(row, 0, CYCLE_ENTRIES * sizeof *row);
    for (size_t line = first_around(l, 2); line < end_around(l, 2, fine->lines); line++)
        for (size_t column = first_around(c, stride); column < end; column++) {
            const size_t node = line * fine->columns + column;
            const double *from = fine->row + node * CYCLE_ENTRIES;
            const double weight = weight_of_line(fine, l, line) * (column == stride * c ? 1 : 0.5);
            if (!fine->unknown[node]) continue;
            for (size_t a = 0; a < CYCLE_ENTRIES; a++)
                if (from[a] != 0)
                    add_interpolated(row, weight * from[a], line + a / CYCLE_COLUMNS - 1,
                                     column + a % CYCLE_COLUMNS - CYCLE_BACK, l, c, coarse);
        }
}

static void fill_coarse(void *context, const team_part *part) {
    const lines_task *task = context;
    const level *fine = task->here;
    level *coarse = task->coarse;

    for (size_t l = part->first; l < part->end; l++)
        for (size_t c = 0; c < coarse->columns; c++) {
            coarse->unknown[l * coarse->columns + c] =
                fine->unknown[2 * l * fine->columns + coarse->stride * c];
            fill_coarse_row(coarse, fine, l, c);
        }
}

/* Factorises a line's own matrix as L U without pivoting. Returns false if it is singular. */
static bool factorise_line(level *self, size_t line) {
    const double *row = self->row + line * self->columns * CYCLE_ENTRIES + CYCLE_COLUMNS;
    double *here = self->factors + line * self->columns * NUM_LINE_FACTORS;
    bool regular = true;

    for (size_t c = 0; c < self->columns; c++, row += CYCLE_ENTRIES, here += NUM_LINE_FACTORS) {
        double diagonal = row[CYCLE_BACK], next = row[CYCLE_BACK - 1];

        here[BY_BACK2] = here[BY_BACK] = 0;
        if (c > 1) {
            const double *back2 = here - 2 * NUM_LINE_FACTORS;
            here[BY_BACK2] = row[0] * back2[BY_HERE];
            next -= here[BY_BACK2] * back2[BY_AHEAD];
        }
        if (c > 0) {
            const double *back = here - NUM_LINE_FACTORS;
            here[BY_BACK] = next * back[BY_HERE];
            diagonal -= here[BY_BACK] * back[BY_AHEAD];
        }
        here[BY_HERE] = 1 / diagonal;
        here[BY_AHEAD] = row[CYCLE_BACK + 1];
        regular = regular && isfinite(here[BY_HERE]);
    }
    return regular;
}

static void factorise_lines(void *context, const team_part *part) {
    const lines_task *task = context;

    for (size_t l = part->first; l < part->end; l++)
        if (!factorise_line(task->here, l)) atomic_store(&task->of->singular, true);
}

static bool factorise_coarsest(multigrid *self) {
    const level *last = &self->levels[self->num - 1];
    const int num = (int)last->num;
    const band_shape shape = self->shape;

    memset(self->band, 0, last->num * (size_t)shape.rows * sizeof(double));
    for (size_t l = 0; l < last->lines; l++)
        for (size_t c = 0; c < last->columns; c++) {
            const double *row = last->row + (l * last->columns + c) * CYCLE_ENTRIES;
            for (size_t a = 0; a < CYCLE_ENTRIES; a++) {
                if (row[a] == 0) continue;
                const ptrdiff_t i = (ptrdiff_t)band_place(last, c, l);
                const ptrdiff_t j = (ptrdiff_t)band_place(last, c + a % CYCLE_COLUMNS - CYCLE_BACK,
                                                          l + a / CYCLE_COLUMNS - 1);
                self->band[j * shape.rows + shape.below + shape.above + i - j] = row[a];
            }
        }
    return LAPACKE_dgbtrf_work(LAPACK_COL_MAJOR, num, num, shape.below, shape.above, self->band,
                               shape.rows, self->pivots) == 0;
}

bool multigrid_prepare(multigrid *self) {
    atomic_store(&self->singular, false);
    for (size_t g = 0; g < self->num; g++) {
        level *here = &self->levels[g];
        lines_task task = {.here = here, .coarse = here + 1};
        share_lines(self, here->lines, here, clear_others, &task);
        if (g + 1 == self->num) break;
        share_lines(self, here->lines, here, factorise_lines, &task);
        share_lines(self, task.coarse->lines, task.coarse, fill_coarse, &task);
    }
    return !atomic_load(&self->singular) && factorise_coarsest(self);
}

// ---- a cycle

/* Subtracts from `value` the products of a line's rows with the solution on a neighbouring line:
 * the line above if `above` is set, else the line below. */
static void subtract_line(double *value, const level *self, size_t line, bool above) {
    const size_t width = self->columns;
    const double *other = self->solution + (above ? line + 1 : line - 1) * width;
    const double *row = self->row + line * width * CYCLE_ENTRIES + (above ? 2 * CYCLE_COLUMNS : 0);

    for (size_t c = 0; c < width; c++, row += CYCLE_ENTRIES) {
        double sum = row[CYCLE_BACK] * other[c];
        if (c > 1) sum += row[0] * other[c - 2];
        if (c > 0) sum += row[1] * other[c - 1];
        if (c + 1 < width) sum += row[CYCLE_BACK + 1] * other[c + 1];
        value[c] -= sum;
    }
}

/* Solves a line's own matrix for the right side `value`, and stores the line's solution. */
static void solve_line(level *self, const double *value, size_t line) {
    const size_t width = self->columns;
    const double *factors = self->factors + line * width * NUM_LINE_FACTORS;
    double *solution = self->solution + line * width;
    double back = 0, back2 = 0, ahead = 0;

    for (size_t c = 0; c < width; c++) {
        const double *here = factors + c * NUM_LINE_FACTORS;
        const double now = value[c] - here[BY_BACK2] * back2 - here[BY_BACK] * back;
        solution[c] = now;
        back2 = back;
        back = now;
    }
    for (size_t c = width; c-- > 0;) {
        const double *here = factors + c * NUM_LINE_FACTORS;
        ahead = (solution[c] - here[BY_AHEAD] * ahead) * here[BY_HERE];
        solution[c] = ahead;
    }
}

/* Solves every other line at the beginning of a cycle. The solution is zero then, so the
 * neighbouring lines contribute nothing. */
static void begin_lines(void *context, const team_part *part) {
    const lines_task *task = context;
    level *self = task->here;

    for (size_t i = part->first; i < part->end; i++) {
        const size_t l = 2 * i + task->first_line;
        solve_line(self, self->right + l * self->columns, l);
    }
}

static void subtract_neighbours(double *value, const level *self, size_t line) {
    if (line > 0) subtract_line(value, self, line, false);
    if (line + 1 < self->lines) subtract_line(value, self, line, true);
}

/* Solves every other line with the present solution on its neighbouring lines. */
static void solve_lines(void *context, const team_part *part) {
    const lines_task *task = context;
    level *self = task->here;
    const size_t width = self->columns;

    for (size_t i = part->first; i < part->end; i++) {
        const size_t l = 2 * i + task->first_line;
        double *value = task->of->rest + l * width;
        memcpy(value, self->right + l * width, width * sizeof *value);
        subtract_neighbours(value, self, l);
        solve_line(self, value, l);
    }
}

/* Computes the residual of the odd lines: the contribution of the lines beside them, which were
 * solved later. */
static void find_rest(void *context, const team_part *part) {
    const lines_task *task = context;
    const level *self = task->here;

    for (size_t i = part->first; i < part->end; i++) {
        const size_t l = 2 * i + 1;
        double *rest = task->of->rest + l * self->columns;
        memset(rest, 0, self->columns * sizeof *rest);
        subtract_neighbours(rest, self, l);
    }
}

/* Carries the residual to the coarser grid. The residual is zero on all but the odd lines. */
static void restrict_rest(void *context, const team_part *part) {
    const lines_task *task = context;
    const level *fine = task->here, *coarse = task->coarse;
    const size_t stride = coarse->stride;

    for (size_t l = part->first; l < part->end; l++)
        for (size_t c = 0; c < coarse->columns; c++) {
            double sum = 0;
            for (size_t line = first_around(l, 2); line < end_around(l, 2, fine->lines); line++) {
                const double *of_line = task->of->rest + line * fine->columns;
                if (line % 2 == 0) continue;
                double across = of_line[stride * c];
                if (stride == 2 && c > 0) across += 0.5 * of_line[2 * c - 1];
                if (stride == 2 && 2 * c + 1 < fine->columns) across += 0.5 * of_line[2 * c + 1];
                sum += weight_of_line(fine, l, line) * across;
            }
            const size_t node = l * coarse->columns + c;
            coarse->right[node] = coarse->unknown[node] ? sum : 0;
        }
}

/* Returns the value of a coarse line at a fine column. */
static double value_at_column(const double *of_line, size_t column, const level *coarse) {
    if (column % coarse->stride == 0) return of_line[column / coarse->stride];
    return 0.5 *
           (of_line[column / 2] + (column / 2 + 1 < coarse->columns ? of_line[column / 2 + 1] : 0));
}

/* Adds the correction to the lines that the coarser grid has. The other lines are solved next. */
static void add_correction(void *context, const team_part *part) {
    const lines_task *task = context;
    const level *fine = task->here, *coarse = task->coarse;

    for (size_t l = part->first; l < part->end; l++) {
        const double *correction = coarse->solution + l * coarse->columns;
        const size_t first = 2 * l * fine->columns;
        for (size_t c = 0; c < fine->columns; c++)
            if (fine->unknown[first + c])
                fine->solution[first + c] += value_at_column(correction, c, coarse);
    }
}

/* Shares the work on lines 1, 3, 5 … or 0, 2, 4 … among the threads. */
static void share_every_other(multigrid *self, level *here, size_t first_line, team_task *work) {
    lines_task task = {.here = here, .first_line = first_line};

    share_lines(self, (here->lines + 1 - first_line) / 2, here, work, &task);
}

static void go_down(multigrid *self, level *here) {
    lines_task task = {.here = here, .coarse = here + 1};

    share_every_other(self, here, 1, begin_lines);
    share_every_other(self, here, 0, solve_lines);
    share_every_other(self, here, 1, find_rest);
    share_lines(self, task.coarse->lines, task.coarse, restrict_rest, &task);
}

static void go_up(multigrid *self, level *here) {
    lines_task task = {.here = here, .coarse = here + 1};

    share_lines(self, task.coarse->lines, task.coarse, add_correction, &task);
    share_every_other(self, here, 1, solve_lines);
    share_every_other(self, here, 0, solve_lines);
}

static void solve_coarsest(multigrid *self) {
    level *last = &self->levels[self->num - 1];
    const int num = (int)last->num;
    const band_shape shape = self->shape;

    for (size_t k = 0; k < last->num; k++)
        self->in_order[band_place(last, k % last->columns, k / last->columns)] = last->right[k];
    LAPACKE_dgbtrs_work(LAPACK_COL_MAJOR, 'N', num, shape.below, shape.above, 1, self->band,
                        shape.rows, self->pivots, self->in_order, num);
    for (size_t k = 0; k < last->num; k++)
        last->solution[k] = self->in_order[band_place(last, k % last->columns, k / last->columns)];
}

void multigrid_cycle(multigrid *self) {
    for (size_t g = 0; g + 1 < self->num; g++)
        go_down(self, &self->levels[g]);
    solve_coarsest(self);
    for (size_t g = self->num - 1; g-- > 0;)
        go_up(self, &self->levels[g]);
}
