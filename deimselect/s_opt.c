/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Oversampled S-OPT for two bases: Lauzon, Cheung, Shin, Choi, Copeland and Huynh, "S-OPT: a points
 * selection algorithm for hyper-reduction in reduced order models" (2022), after Shin and Xiu
 * (2016). A basis sampled at the rows, A [num_rows, n], has
 *
 *     S(A) = (sqrt(det A^T A) / prod_j |A_j|)^(1/n),
 *
 * which is 1 if the sampled columns A_j are orthogonal. Each step selects the row with the largest
 * product of S over both bases. A new row r multiplies the determinant by 1 + r^T (A^T A)^-1 r and
 * adds r_j^2 to |A_j|^2. The gains r^T (A^T A)^-1 r of all nodes are stored. Rank-1 updates
 * (Sherman and Morrison) keep these gains and the inverse up to date.
 * Called by row_choice.c for --method sopt. */
#include "common/algebra/lapack.h"
#include "common/program/arena.h"
#include "deimselect/selection.h"

#include <cblas.h>
#include <float.h>
#include <lapacke.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* Returns the ridge that is added to A^T A, for modes of unit norm. A^T A is singular with fewer
 * rows than modes. With a smaller ridge, round-off selects rows or the factorisation fails; a
 * larger ridge affects the selection. The square root of the relative round-off is far from both.
 * Ridges from 1e-14 to 1e-6 select the same rows (examples: 56 modes of a line contact, 24 of a
 * point contact; bench_selection.c). */
static double ridge(void) {
    return sqrt(DBL_EPSILON);
}

enum { BLOCK = 512 }; // nodes in a block of scan_modes

/* A basis at the rows selected so far. */
typedef struct sampled_basis {
    size_t num_nodes, num_modes;
    const double *modes; // [num_modes, num_nodes]
    double *inverse;     // [num_modes, num_modes] inverse of A^T A
    double *gain;        // [num_nodes] r^T (A^T A)^-1 r
    double *squares;     // [num_modes] |A_j|^2
    double *row;         // [num_modes] the row just added
    double *product;     // [num_modes] inverse times row
    double *along;       // [num_nodes] modes^T product
    double *growth;      // [num_nodes] factor by which the node's row multiplies prod_j |A_j|^2
} sampled_basis;

static void gather_row(double *row, const sampled_basis *self, size_t node) {
    cblas_dcopy((int)self->num_modes, self->modes + node, (int)self->num_nodes, row, 1);
}

/* Computes the diagonal of A^T A, and the inverse of A^T A, for the given rows. */
static ehd_status invert_gram(sampled_basis *self, const size_t *rows, size_t num_rows,
                              ehd_error *error) {
    const int n = (int)self->num_modes;

    memset(self->inverse, 0, self->num_modes * self->num_modes * sizeof(double));
    for (size_t k = 0; k < num_rows; k++) {
        gather_row(self->row, self, rows[k]);
        cblas_dsyr(CblasColMajor, CblasLower, n, 1, self->row, 1, self->inverse, n);
    }
    for (size_t j = 0; j < self->num_modes; j++) {
        self->inverse[j * self->num_modes + j] += ridge();
        self->squares[j] = self->inverse[j * self->num_modes + j];
    }
    ehd_status status =
        lapack_outcome("dpotrf", LAPACKE_dpotrf(LAPACK_COL_MAJOR, 'L', n, self->inverse, n), error);
    return status
               ? status
               : lapack_outcome("dpotri",
                                LAPACKE_dpotri(LAPACK_COL_MAJOR, 'L', n, self->inverse, n), error);
}

/* Computes gain = diag(modes^T inverse modes). */
static ehd_status start_gain(sampled_basis *self, ehd_error *error) {
    double *products = malloc(self->num_modes * self->num_nodes * sizeof *products);

    if (!products) return ehd_no_memory(error, "row selection");
    cblas_dsymm(CblasColMajor, CblasRight, CblasLower, (int)self->num_nodes, (int)self->num_modes,
                1, self->inverse, (int)self->num_modes, self->modes, (int)self->num_nodes, 0,
                products, (int)self->num_nodes);
    memset(self->gain, 0, self->num_nodes * sizeof(double));
    for (size_t j = 0; j < self->num_modes; j++)
        for (size_t i = 0; i < self->num_nodes; i++)
            self->gain[i] +=
                products[j * self->num_nodes + i] * self->modes[j * self->num_nodes + i];
    free(products);
    return EHD_OK;
}

/* Computes `along` = modes^T product, and `growth`, for all nodes. One loop over blocks of nodes
 * computes both, because reading the modes takes most of the time. */
static void scan_modes(sampled_basis *self) {
    for (size_t first = 0; first < self->num_nodes; first += BLOCK) {
        const size_t left = self->num_nodes - first, count = left < BLOCK ? left : BLOCK;
        double *restrict along = self->along + first, *restrict growth = self->growth + first;
        for (size_t i = 0; i < count; i++)
            along[i] = 0, growth[i] = 1;
        for (size_t j = 0; j < self->num_modes; j++) {
            const double *restrict mode = self->modes + j * self->num_nodes + first;
            const double product = self->product[j], inverse = 1 / self->squares[j];
            for (size_t i = 0; i < count; i++) {
                along[i] += mode[i] * product;
                growth[i] *= 1 + mode[i] * mode[i] * inverse;
            }
        }
    }
}

static sampled_basis sampled_basis_of(const selection_bases *bases, int basis, arena *memory) {
    const size_t num_nodes = bases->num_nodes, num_modes = bases->num_modes[basis];

    return (sampled_basis){.num_nodes = num_nodes,
                           .num_modes = num_modes,
                           .modes = bases->modes[basis],
                           .inverse = arena_table(memory, num_modes, num_modes, sizeof(double)),
                           .gain = arena_array(memory, num_nodes, sizeof(double)),
                           .squares = arena_array(memory, num_modes, sizeof(double)),
                           .row = arena_array(memory, num_modes, sizeof(double)),
                           .product = arena_array(memory, num_modes, sizeof(double)),
                           .along = arena_array(memory, num_nodes, sizeof(double)),
                           .growth = arena_array(memory, num_nodes, sizeof(double))};
}

static ehd_status sampled_basis_start(sampled_basis *self, const size_t *rows, size_t num_rows,
                                      ehd_error *error) {
    ehd_status status = invert_gram(self, rows, num_rows, error);

    if (!status) status = start_gain(self, error);
    if (!status) scan_modes(self);
    return status;
}

/* Adds a row: (G + r r^T)^-1 = G^-1 - u u^T / (1 + r^T u), u = G^-1 r. */
static void add_row(sampled_basis *self, size_t node) {
    const int n = (int)self->num_modes;

    gather_row(self->row, self, node);
    cblas_dsymv(CblasColMajor, CblasLower, n, 1, self->inverse, n, self->row, 1, 0, self->product,
                1);
    const double divisor = 1 + cblas_ddot(n, self->row, 1, self->product, 1);
    cblas_dsyr(CblasColMajor, CblasLower, n, -1 / divisor, self->product, 1, self->inverse, n);
    for (size_t j = 0; j < self->num_modes; j++)
        self->squares[j] += self->row[j] * self->row[j];
    scan_modes(self);
    for (size_t i = 0; i < self->num_nodes; i++)
        self->gain[i] -= self->along[i] * self->along[i] / divisor;
}

/* Adds to objective[i] the logarithm of the factor by which row i would multiply S of the basis. */
static void add_objective(double *objective, const sampled_basis *self) {
    for (size_t i = 0; i < self->num_nodes; i++)
        objective[i] +=
            log((1 + fmax(self->gain[i], 0)) / self->growth[i]) / (double)(2 * self->num_modes);
}

/* Returns the unselected node with the largest objective. If several nodes have this objective,
 * returns the first of these nodes. */
static size_t best_row(const double *objective, const bool *selected, size_t num_nodes) {
    size_t row = num_nodes;

    for (size_t i = 0; i < num_nodes; i++)
        if (!selected[i] && (row == num_nodes || objective[i] > objective[row])) row = i;
    return row;
}

/* Returns the two bases from which pivoted QR selects the first rows. Each has half as many modes
 * as the smaller one of the full bases. Pivoted QR selects as many rows as each returned basis has
 * modes. With fewer rows the sampled columns are nearly dependent, and S is not a useful
 * measure. */
static selection_bases start_bases(const selection_bases *bases) {
    const int poorer = bases->num_modes[1] < bases->num_modes[0];
    selection_bases start = *bases;

    start.num_modes[0] = start.num_modes[1] = (bases->num_modes[poorer] + 1) / 2;
    return start;
}

/* Selects the rows after the first num_start rows. `objective` and `selected`, all false, are work
 * arrays [num_nodes]. */
static void oversample(size_t *rows, sampled_basis both[2], size_t num_start, size_t num_rows,
                       double *objective, bool *selected) {
    const size_t num_nodes = both[0].num_nodes;

    for (size_t n = 0; n < num_start; n++)
        selected[rows[n]] = true;
    for (size_t n = num_start; n < num_rows; n++) {
        memset(objective, 0, num_nodes * sizeof *objective);
        for (int basis = 0; basis < 2; basis++)
            add_objective(objective, &both[basis]);
        rows[n] = best_row(objective, selected, num_nodes);
        selected[rows[n]] = true;
        for (int basis = 0; basis < 2; basis++)
            add_row(&both[basis], rows[n]);
    }
}

ehd_status selection_s_opt(size_t *rows, const selection_bases *bases, size_t num_rows,
                           ehd_error *error) {
    const selection_bases start = start_bases(bases);
    const size_t num_start = num_rows < start.num_modes[0] ? num_rows : start.num_modes[0];

    if (num_rows > bases->num_nodes)
        return ehd_fail(error, EHD_DATA, "rows: found %zu, expected at most %zu, the nodes",
                        num_rows, bases->num_nodes);
    arena memory = {0};
    sampled_basis both[] = {sampled_basis_of(bases, 0, &memory),
                            sampled_basis_of(bases, 1, &memory)};
    double *objective = arena_array(&memory, bases->num_nodes, sizeof *objective);
    bool *selected = arena_array(&memory, bases->num_nodes, sizeof *selected);
    ehd_status status = memory.failed ? ehd_no_memory(error, "row selection")
                                      : selection_pivoted_qr(rows, &start, num_start, error);
    for (int basis = 0; basis < 2 && !status; basis++)
        status = sampled_basis_start(&both[basis], rows, num_start, error);
    if (!status) oversample(rows, both, num_start, num_rows, objective, selected);
    arena_free(&memory);
    return status;
}
