/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A cycle goes over the lines upwards, each solved with what stands on the one below; carries the
 * residual to a grid of every other node and line, whose matrix is the Galerkin product, and the
 * correction back; and goes over the lines downwards (A. Brandt, Math. Comp. 31, 1977; W. Hackbusch,
 * Multi-Grid Methods and Applications, Springer 1985). Where fluid is carried along the lines by the
 * entrainment these alone are nearly a solution, and where the pressure flow is large both ways the
 * coarser grids are needed. The stencil is as large on all of them. */
#include "fullrun/multigrid.h"

#include "common/program/arena.h"

#include <lapacke.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Lines or columns of the coarsest grid, which is solved by a band matrix, at most. */
enum { COARSEST = 40, MAX_LEVELS = 20 };

/* A line's matrix as L U: what it takes from two and one node back, the reciprocal of the diagonal,
 * and the entry ahead. */
enum { BY_BACK2, BY_BACK, BY_HERE, BY_AHEAD, NUM_LINE_FACTORS };

typedef struct level {
    size_t columns, lines, num;
    bool mirrored;    // at the first line
    bool *unknown;    // [num]
    double *row;      // [num, CYCLE_ENTRIES]
    double *factors;  // [num, NUM_LINE_FACTORS]
    double *right;    // [num], then what is left of it
    double *solution; // [num]
} level;

struct multigrid {
    level levels[MAX_LEVELS]; // the finest first
    size_t num;
    double *rest; // [num of the finest]
    // the coarsest level's band, LU by LAPACK, of nodes numbered by columns
    double *band;       // [num, band_rows]
    int *pivots;        // [num]
    double *by_columns; // [num]
    int below, above, band_rows;
    arena memory;
};

static bool is_coarsest(const level *self) {
    return self->columns <= COARSEST || self->lines <= COARSEST;
}

static level coarser(const level *fine) {
    level coarse = {.columns = (fine->columns + 1) / 2,
                    .lines = (fine->lines + 1) / 2,
                    .mirrored = fine->mirrored};

    coarse.num = coarse.columns * coarse.lines;
    return coarse;
}

static level finest(const ehd_grid *grid) {
    return (level){.columns = grid->inner_x,
                   .lines = grid->inner_lines,
                   .num = grid->num_inner,
                   .mirrored = grid->half};
}

double multigrid_bytes(void) {
    const double levels = 4. / 3, numbers = CYCLE_ENTRIES + NUM_LINE_FACTORS + 2;

    return levels * (numbers * sizeof(double) + sizeof(bool)) + sizeof(double);
}

static void allocate_level(level *self, arena *memory) {
    self->unknown = arena_array(memory, self->num, sizeof *self->unknown);
    self->row = arena_table(memory, self->num, CYCLE_ENTRIES, sizeof(double));
    self->factors = arena_table(memory, self->num, NUM_LINE_FACTORS, sizeof(double));
    self->right = arena_array(memory, self->num, sizeof(double));
    self->solution = arena_array(memory, self->num, sizeof(double));
}

multigrid *multigrid_create(const ehd_grid *grid) {
    multigrid *self = calloc(1, sizeof *self);
    if (!self) return NULL;
    arena *memory = &self->memory;
    level next = finest(grid);

    for (;; next = coarser(&next)) {
        level *here = &self->levels[self->num++];
        *here = next;
        allocate_level(here, memory);
        if (is_coarsest(here) || self->num == MAX_LEVELS) break;
    }
    const level *last = &self->levels[self->num - 1];
    self->below = (int)(CYCLE_BACK * last->lines + 1);
    self->above = (int)last->lines + 1;
    self->band_rows = 2 * self->below + self->above + 1;
    self->rest = arena_array(memory, grid->num_inner, sizeof(double));
    self->band = arena_table(memory, last->num, (size_t)self->band_rows, sizeof(double));
    self->pivots = arena_array(memory, last->num, sizeof(int));
    self->by_columns = arena_array(memory, last->num, sizeof(double));
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

/* Leaves in the rows what is between unknowns; all others are those of the identity. */
static void clear_others(level *self) {
    for (size_t l = 0; l < self->lines; l++)
        for (size_t c = 0; c < self->columns; c++) {
            const size_t node = l * self->columns + c;
            double *row = self->row + node * CYCLE_ENTRIES;
            for (size_t a = 0; a < CYCLE_ENTRIES; a++) {
                const size_t line = l + a / CYCLE_COLUMNS - 1; // wraps below the first one
                const size_t column = c + a % CYCLE_COLUMNS - CYCLE_BACK;
                const bool there = line < self->lines && column < self->columns;
                if (!there || !self->unknown[node] || !self->unknown[line * self->columns + column])
                    row[a] = 0;
            }
            if (!self->unknown[node]) row[CYCLE_COLUMNS + CYCLE_BACK] = 1;
        }
}

/* Adds an entry at a fine node, times a weight, to the entries of the coarse nodes around it that it
 * is interpolated from; `row` of the coarse node (l, c). */
static void add_interpolated(double *row, double entry, size_t fine_line, size_t fine_column,
                             size_t l, size_t c, const level *coarse) {
    for (size_t line = fine_line / 2; line <= (fine_line + 1) / 2; line++)
        for (size_t column = fine_column / 2; column <= (fine_column + 1) / 2; column++) {
            if (line >= coarse->lines || column >= coarse->columns) continue;
            const double part = (fine_line % 2 ? 0.5 : 1) * (fine_column % 2 ? 0.5 : 1);
            row[(line + 1 - l) * CYCLE_COLUMNS + column + CYCLE_BACK - c] += part * entry;
        }
}

/* Weight of a fine line's residual in that of coarse line l: lines below a mirror are those above. */
static double weight_of_line(const level *fine, size_t l, size_t fine_line) {
    if (fine_line == 2 * l) return 1;
    return fine->mirrored && l == 0 ? 1 : 0.5;
}

/* The range of fine lines or columns around a coarse one. */
static size_t first_around(size_t coarse) {
    return coarse > 0 ? 2 * coarse - 1 : 0;
}

static size_t end_around(size_t coarse, size_t fine_count) {
    return 2 * coarse + 2 < fine_count ? 2 * coarse + 2 : fine_count;
}

/* Galerkin's product for one coarse node. */
static void fill_coarse_row(level *coarse, const level *fine, size_t l, size_t c) {
    double *row = coarse->row + (l * coarse->columns + c) * CYCLE_ENTRIES;

    memset(row, 0, CYCLE_ENTRIES * sizeof *row);
    for (size_t line = first_around(l); line < end_around(l, fine->lines); line++)
        for (size_t column = first_around(c); column < end_around(c, fine->columns); column++) {
            const size_t node = line * fine->columns + column;
            const double *from = fine->row + node * CYCLE_ENTRIES;
            const double weight = weight_of_line(fine, l, line) * (column == 2 * c ? 1 : 0.5);
            if (!fine->unknown[node]) continue;
            for (size_t a = 0; a < CYCLE_ENTRIES; a++)
                if (from[a] != 0)
                    add_interpolated(row, weight * from[a], line + a / CYCLE_COLUMNS - 1,
                                     column + a % CYCLE_COLUMNS - CYCLE_BACK, l, c, coarse);
        }
}

static void fill_coarse(level *coarse, const level *fine) {
    for (size_t l = 0; l < coarse->lines; l++)
        for (size_t c = 0; c < coarse->columns; c++) {
            coarse->unknown[l * coarse->columns + c] = fine->unknown[2 * l * fine->columns + 2 * c];
            fill_coarse_row(coarse, fine, l, c);
        }
    clear_others(coarse);
}

/* L U of the lines' own matrices, without pivoting; false: singular. */
static bool factorise_lines(level *self) {
    bool regular = true;

    for (size_t k = 0; k < self->num; k++) {
        const double *row = self->row + k * CYCLE_ENTRIES + CYCLE_COLUMNS;
        double *here = self->factors + k * NUM_LINE_FACTORS;
        const double *back = here - NUM_LINE_FACTORS, *back2 = back - NUM_LINE_FACTORS;
        const size_t column = k % self->columns;
        double diagonal = row[CYCLE_BACK], next = row[CYCLE_BACK - 1];

        here[BY_BACK2] = here[BY_BACK] = 0;
        if (column > 1) {
            here[BY_BACK2] = row[0] * back2[BY_HERE];
            next -= here[BY_BACK2] * back2[BY_AHEAD];
        }
        if (column > 0) {
            here[BY_BACK] = next * back[BY_HERE];
            diagonal -= here[BY_BACK] * back[BY_AHEAD];
        }
        here[BY_HERE] = 1 / diagonal;
        here[BY_AHEAD] = row[CYCLE_BACK + 1];
        regular = regular && isfinite(here[BY_HERE]);
    }
    return regular;
}

static bool factorise_coarsest(multigrid *self) {
    const level *last = &self->levels[self->num - 1];
    const int num = (int)last->num;

    memset(self->band, 0, last->num * (size_t)self->band_rows * sizeof(double));
    for (size_t l = 0; l < last->lines; l++)
        for (size_t c = 0; c < last->columns; c++) {
            const double *row = last->row + (l * last->columns + c) * CYCLE_ENTRIES;
            for (size_t a = 0; a < CYCLE_ENTRIES; a++) {
                if (row[a] == 0) continue;
                const ptrdiff_t i = (ptrdiff_t)(c * last->lines + l);
                const ptrdiff_t j = (ptrdiff_t)((c + a % CYCLE_COLUMNS - CYCLE_BACK) * last->lines +
                                                l + a / CYCLE_COLUMNS - 1);
                self->band[j * self->band_rows + self->below + self->above + i - j] = row[a];
            }
        }
    return LAPACKE_dgbtrf_work(LAPACK_COL_MAJOR, num, num, self->below, self->above, self->band,
                               self->band_rows, self->pivots) == 0;
}

bool multigrid_prepare(multigrid *self) {
    clear_others(&self->levels[0]);
    for (size_t g = 1; g < self->num; g++)
        fill_coarse(&self->levels[g], &self->levels[g - 1]);
    for (size_t g = 0; g + 1 < self->num; g++)
        if (!factorise_lines(&self->levels[g])) return false;
    return factorise_coarsest(self);
}

// ---- a cycle

/* Subtracts from a line's `value` what the line `above` or below it adds to its rows. */
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

/* Solves a line's own matrix for `value`, into the solution. */
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

/* From zero upwards; `rest` is then the residual, which is what the next lines add. */
static void go_up(level *self, double *rest) {
    const size_t width = self->columns;

    for (size_t l = 0; l < self->lines; l++) {
        double *value = rest + l * width;
        memcpy(value, self->right + l * width, width * sizeof *value);
        if (l > 0) subtract_line(value, self, l, false);
        solve_line(self, value, l);
    }
    memset(rest, 0, self->num * sizeof *rest);
    for (size_t l = 0; l + 1 < self->lines; l++)
        subtract_line(rest + l * width, self, l, true);
}

static void go_down(level *self, double *value) {
    const size_t width = self->columns;

    for (size_t l = self->lines; l-- > 0;) {
        memcpy(value, self->right + l * width, width * sizeof *value);
        if (l > 0) subtract_line(value, self, l, false);
        if (l + 1 < self->lines) subtract_line(value, self, l, true);
        solve_line(self, value, l);
    }
}

static void restrict_rest(level *coarse, const level *fine, const double *rest) {
    for (size_t l = 0; l < coarse->lines; l++)
        for (size_t c = 0; c < coarse->columns; c++) {
            double sum = 0;
            for (size_t line = first_around(l); line < end_around(l, fine->lines); line++) {
                const double *of_line = rest + line * fine->columns;
                double across = of_line[2 * c];
                if (c > 0) across += 0.5 * of_line[2 * c - 1];
                if (2 * c + 1 < fine->columns) across += 0.5 * of_line[2 * c + 1];
                sum += weight_of_line(fine, l, line) * across;
            }
            const size_t node = l * coarse->columns + c;
            coarse->right[node] = coarse->unknown[node] ? sum : 0;
        }
}

/* Value at a fine column of a coarse line. */
static double along(const double *of_line, size_t column, const level *coarse) {
    if (column % 2 == 0) return of_line[column / 2];
    return 0.5 *
           (of_line[column / 2] + (column / 2 + 1 < coarse->columns ? of_line[column / 2 + 1] : 0));
}

static void add_correction(level *fine, const level *coarse) {
    for (size_t l = 0; l < fine->lines; l++) {
        const double *low = coarse->solution + l / 2 * coarse->columns;
        const double *high = l % 2 && l / 2 + 1 < coarse->lines ? low + coarse->columns : NULL;
        for (size_t c = 0; c < fine->columns; c++) {
            double sum = along(low, c, coarse);
            if (l % 2) sum = 0.5 * (sum + (high ? along(high, c, coarse) : 0));
            if (fine->unknown[l * fine->columns + c]) fine->solution[l * fine->columns + c] += sum;
        }
    }
}

static void solve_coarsest(multigrid *self) {
    level *last = &self->levels[self->num - 1];
    const int num = (int)last->num;

    for (size_t k = 0; k < last->num; k++)
        self->by_columns[k % last->columns * last->lines + k / last->columns] = last->right[k];
    LAPACKE_dgbtrs_work(LAPACK_COL_MAJOR, 'N', num, self->below, self->above, 1, self->band,
                        self->band_rows, self->pivots, self->by_columns, num);
    for (size_t k = 0; k < last->num; k++)
        last->solution[k] = self->by_columns[k % last->columns * last->lines + k / last->columns];
}

void multigrid_cycle(multigrid *self) {
    for (size_t g = 0; g + 1 < self->num; g++) {
        go_up(&self->levels[g], self->rest);
        restrict_rest(&self->levels[g + 1], &self->levels[g], self->rest);
    }
    solve_coarsest(self);
    for (size_t g = self->num - 1; g-- > 0;) {
        add_correction(&self->levels[g], &self->levels[g + 1]);
        go_down(&self->levels[g], self->rest);
    }
}
