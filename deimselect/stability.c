/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "deimselect/stability.h"

#include "common/algebra/lapack.h"
#include "common/program/arena.h"

#include <cblas.h>
#include <float.h>
#include <lapacke.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* The modes of one basis, restricted to the nodes before one exit. */
typedef struct exit_block {
    const double *modes; // [num_modes, num_nodes]
    size_t num_modes;
    const size_t *num_before; // [num_lines] number of nodes of each line before the exit
    size_t num_resolved;      // number of directions of the modes that do not vanish over these
                              // nodes
    double *resolved;  // [num_modes, num_resolved] column-major: modes^T resolved is orthonormal
                       // over these nodes
    double *gram;      // [num_resolved, num_resolved] Gram matrix of the selected rows in these
                       // directions
    double smallest;   // smallest eigenvalue of `gram`, or a lower bound of it if is_known is false
    double *direction; // [num_resolved] eigenvector of the eigenvalue `smallest`
    bool is_known;     // true: `smallest` and `direction` belong to the present `gram`
} exit_block;

struct row_stability {
    size_t num_nodes, num_lines, width; // width: number of nodes of a line
    // [num_lines] none: 0 on each line, an exit before all nodes; all: `width` on each line, an
    // exit behind all nodes
    size_t *none, *all;
    size_t num_blocks;  // two blocks, one for each basis, for each exit and for all nodes
    exit_block *blocks; // [num_blocks]
    bool *selected;     // [num_nodes]
    // work arrays
    double *running_gram[2]; // [num_modes, num_modes] Gram matrices over the nodes before the exit
                             // that was filled last
    double *row, *along;     // [num_modes of the larger basis]
    double *matrix, *values; // [num_modes, num_modes], [num_modes]
    arena memory;
};

row_stability *row_stability_free(row_stability *self) {
    if (self) arena_free(&self->memory);
    free(self);
    return NULL;
}

static bool is_before(const exit_block *block, const row_stability *self, size_t node) {
    return node % self->width < block->num_before[node / self->width];
}

/* Changes the Gram matrix of the modes over the nodes before exit `from` to the matrix over the
 * nodes before exit `to`. */
static void move_gram(double *gram, const row_stability *self, const double *modes,
                      size_t num_modes, const size_t *from, const size_t *to) {
    for (size_t l = 0; l < self->num_lines; l++) {
        const bool more = to[l] > from[l];
        const size_t first = more ? from[l] : to[l], last = more ? to[l] : from[l];
        if (last > first)
            cblas_dsyrk(CblasColMajor, CblasLower, CblasTrans, (int)num_modes, (int)(last - first),
                        more ? 1 : -1, modes + l * self->width + first, (int)self->num_nodes, 1,
                        gram, (int)num_modes);
    }
}

/* Computes resolved = U / sqrt(lambda) from the Gram matrix U lambda U^T of the modes over the
 * nodes before the exit. `running_gram`: Gram matrix of the modes; on entry over the nodes before
 * exit `from`, on return over the nodes before the exit of the block. */
static ehd_status block_fill(exit_block *block, row_stability *self, double *running_gram,
                             const size_t *from, const double *modes, const size_t *num_before,
                             ehd_error *error) {
    const size_t num_modes = block->num_modes;
    const int n = (int)num_modes;
    // round-off of sums over all nodes, for modes of unit norm
    const double rounding = DBL_EPSILON * (double)self->num_nodes;
    block->modes = modes;
    block->num_before = num_before;
    block->smallest = 0;
    block->is_known = false;
    move_gram(running_gram, self, modes, num_modes, from, num_before);
    memcpy(block->resolved, running_gram, num_modes * num_modes * sizeof(double));
    ehd_status status = lapack_outcome(
        "dsyevd", LAPACKE_dsyevd(LAPACK_COL_MAJOR, 'V', 'L', n, block->resolved, n, self->values),
        error);
    if (status) return status;
    size_t unresolved = 0; // eigenvalues ascend
    while (unresolved < num_modes && !(self->values[unresolved] > rounding))
        unresolved++;
    block->num_resolved = num_modes - unresolved;
    memmove(block->resolved, block->resolved + unresolved * num_modes,
            block->num_resolved * num_modes * sizeof(double));
    for (size_t k = 0; k < block->num_resolved; k++)
        cblas_dscal(n, 1 / sqrt(self->values[unresolved + k]), block->resolved + k * num_modes, 1);
    memset(block->gram, 0, num_modes * num_modes * sizeof(double));
    return EHD_OK;
}

/* Returns the number of nodes before an exit on each line. The index num_exits stands for an
 * additional exit that lies behind all nodes. */
static const size_t *nodes_before(const row_stability *self, const selection_bases *bases,
                                  size_t exit) {
    return exit < bases->num_exits ? bases->exits + exit * self->num_lines : self->all;
}

static const size_t *moved_from(const row_stability *self, const selection_bases *bases,
                                size_t exit) {
    return exit > 0 ? nodes_before(self, bases, exit - 1) : self->none;
}

/* Allocates memory for num_exits exits, each with one block for each basis. */
static row_stability *allocate(const selection_bases *leading, size_t num_exits) {
    const size_t *num_modes = leading->num_modes;
    const size_t larger = num_modes[num_modes[1] > num_modes[0]];
    row_stability *self = calloc(1, sizeof *self);
    if (!self) return NULL;

    arena *memory = &self->memory;
    self->num_nodes = leading->num_nodes;
    self->num_lines = leading->num_lines > 0 ? leading->num_lines : 1;
    self->width = self->num_nodes / self->num_lines;
    self->num_blocks = 2 * num_exits;
    self->none = arena_array(memory, self->num_lines, sizeof *self->none);
    self->all = arena_array(memory, self->num_lines, sizeof *self->all);
    self->blocks = arena_array(memory, self->num_blocks, sizeof *self->blocks);
    self->selected = arena_array(memory, leading->num_nodes, sizeof *self->selected);
    self->row = arena_array(memory, larger, sizeof(double));
    self->along = arena_array(memory, larger, sizeof(double));
    self->matrix = arena_array(memory, larger * larger, sizeof(double));
    self->values = arena_array(memory, larger, sizeof(double));
    for (int i = 0; i < 2; i++)
        self->running_gram[i] = arena_array(memory, num_modes[i] * num_modes[i], sizeof(double));
    for (size_t b = 0; b < self->num_blocks && !memory->failed; b++) {
        exit_block *block = &self->blocks[b];
        block->num_modes = num_modes[b % 2];
        block->resolved = arena_table(memory, block->num_modes, block->num_modes, sizeof(double));
        block->gram = arena_table(memory, block->num_modes, block->num_modes, sizeof(double));
        block->direction = arena_array(memory, block->num_modes, sizeof(double));
    }
    for (size_t l = 0; l < self->num_lines && !memory->failed; l++)
        self->all[l] = self->width;
    return memory->failed ? row_stability_free(self) : self;
}

/* Fills both blocks of an exit. Exits must be filled in the order of the list, because each exit
 * updates the Gram matrices of the previous exit. */
static ehd_status fill_exit(exit_block blocks[2], row_stability *self, const selection_bases *bases,
                            size_t exit, ehd_error *error) {
    ehd_status status = EHD_OK;

    for (int i = 0; i < 2 && !status; i++)
        status = block_fill(&blocks[i], self, self->running_gram[i], moved_from(self, bases, exit),
                            bases->modes[i], nodes_before(self, bases, exit), error);
    return status;
}

ehd_status row_stability_create(row_stability **stability, const selection_bases *bases,
                                ehd_error *error) {
    const selection_bases leading = selection_leading(bases);
    row_stability *self = allocate(&leading, bases->num_exits + 1);

    *stability = NULL;
    if (!self) return ehd_no_memory(error, "stability of rows");
    ehd_status status = EHD_OK;
    for (size_t e = 0; e <= bases->num_exits && !status; e++)
        status = fill_exit(&self->blocks[2 * e], self, bases, e, error);
    if (status)
        row_stability_free(self);
    else
        *stability = self;
    return status;
}

double row_stability_bytes(size_t num_leading, size_t num_exits) {
    const double modes = (double)num_leading, an_exit = 2 * (2 * modes * modes + modes);

    return 8 * ((double)num_exits + 1) * an_exit + 8 * 6 * modes * modes;
}

void row_stability_add(row_stability *self, size_t row) {
    self->selected[row] = true;
    for (size_t b = 0; b < self->num_blocks; b++) {
        exit_block *block = &self->blocks[b];
        if (!is_before(block, self, row) || block->num_resolved == 0) continue;
        const int size = (int)block->num_resolved, modes = (int)block->num_modes;
        cblas_dcopy(modes, block->modes + row, (int)self->num_nodes, self->row, 1);
        cblas_dgemv(CblasColMajor, CblasTrans, modes, size, 1, block->resolved, modes, self->row, 1,
                    0, self->along, 1);
        cblas_dsyr(CblasColMajor, CblasLower, size, 1, self->along, 1, block->gram, size);
        block->is_known = false;
    }
}

/* Computes the smallest eigenvalue of a block and its eigenvector. */
static ehd_status examine(exit_block *block, row_stability *self, ehd_error *error) {
    const int size = (int)block->num_resolved;
    lapack_int found = 0, support[2];

    block->is_known = true;
    if (size == 0) {
        block->smallest = INFINITY; // no direction has to be determined
        return EHD_OK;
    }
    memcpy(self->matrix, block->gram, block->num_resolved * block->num_resolved * sizeof(double));
    ehd_status status = lapack_outcome(
        "dsyevr",
        LAPACKE_dsyevr(LAPACK_COL_MAJOR, 'V', 'I', 'L', size, self->matrix, size, 0, 0, 1, 1, 0,
                       &found, self->values, block->direction, size, support),
        error);
    // eigenvalues as small as round-off are set to zero
    if (!status)
        block->smallest = self->values[0] > DBL_EPSILON * (double)size ? self->values[0] : 0;
    return status;
}

/* Returns the unselected row at which the eigenvector `direction` of the block, expanded in the
 * modes, is largest in magnitude. Rows behind the exit count as 0. */
static size_t strongest_row(const exit_block *block, row_stability *self) {
    size_t row = self->num_nodes;
    double largest = -1;

    cblas_dgemv(CblasColMajor, CblasNoTrans, (int)block->num_modes, (int)block->num_resolved, 1,
                block->resolved, (int)block->num_modes, block->direction, 1, 0, self->along, 1);
    for (size_t i = 0; i < self->num_nodes; i++) {
        if (self->selected[i]) continue;
        const double value = is_before(block, self, i)
                                 ? cblas_ddot((int)block->num_modes, self->along, 1,
                                              block->modes + i, (int)self->num_nodes)
                                 : 0;
        if (!(value * value > largest)) continue;
        largest = value * value;
        row = i;
    }
    return row;
}

/* Finds the block with the smallest eigenvalue. Additional rows never decrease eigenvalues, so old
 * eigenvalues are lower bounds. Few eigenvalues therefore have to be computed again. */
static ehd_status worst_block(exit_block **worst, row_stability *self, ehd_error *error) {
    ehd_status status = EHD_OK;

    do {
        *worst = &self->blocks[0];
        for (size_t b = 1; b < self->num_blocks; b++)
            if (self->blocks[b].smallest < (*worst)->smallest) *worst = &self->blocks[b];
        if ((*worst)->is_known) return EHD_OK;
        status = examine(*worst, self, error);
    } while (!status);
    return status;
}

ehd_status row_stability_worst(double *sigma_min, size_t *best_row, row_stability *self,
                               ehd_error *error) {
    exit_block *worst;
    ehd_status status = worst_block(&worst, self, error);

    if (status) return status;
    *sigma_min = sqrt(worst->smallest);
    if (best_row) *best_row = strongest_row(worst, self);
    return EHD_OK;
}

/* Evaluates one exit after the other, because arrays for all exits take much memory, and each exit
 * is needed only once. */
ehd_status row_stability_of(double *inverse_sigma_min, const selection_bases *bases,
                            const size_t *rows, size_t num_rows, ehd_error *error) {
    const selection_bases leading = selection_leading(bases);
    row_stability *self = allocate(&leading, 1);
    double smallest = INFINITY;
    ehd_status status = self ? EHD_OK : ehd_no_memory(error, "stability of rows");

    for (size_t e = 0; e <= bases->num_exits && !status; e++) {
        double sigma_min = 0;
        status = fill_exit(self->blocks, self, bases, e, error);
        for (size_t n = 0; n < num_rows && !status; n++)
            row_stability_add(self, rows[n]);
        if (!status) status = row_stability_worst(&sigma_min, NULL, self, error);
        smallest = fmin(smallest, sigma_min);
    }
    *inverse_sigma_min = 1 / smallest;
    row_stability_free(self);
    return status;
}

ehd_status row_stability_fewest(size_t *fewest, const selection_bases *bases, const size_t *rows,
                                size_t num_rows, double max_inverse, ehd_error *error) {
    row_stability *self = NULL;
    ehd_status status = row_stability_create(&self, bases, error);

    for (*fewest = 0; *fewest <= num_rows && !status; ++*fewest) {
        double sigma_min = 0;
        status = row_stability_worst(&sigma_min, NULL, self, error);
        if (status || 1 / sigma_min <= max_inverse) break;
        if (*fewest < num_rows) row_stability_add(self, rows[*fewest]);
    }
    row_stability_free(self);
    return status;
}
