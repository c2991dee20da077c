/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Joint greedy row selection for two bases: Fig. A1 of Maier, Hager, Hetzler and Seemann, Tribology
 * International (2015), a simplified form of an algorithm by Carlberg et al. Names of the figure
 * and of this file:
 *
 *     figure                          here
 *     Phi_f, Phi_J                    interpolation[0].modes, interpolation[1].modes
 *     n̄ - 1                           size, the number of rows selected so far
 *     a, argmin || Phi_I a - ... ||   coefficients, by solve_at_selected_rows
 *     phi_f, phi_J                    residual
 *     I, i                            rows, row
 *
 * The system of equations for the coefficients a is square and grows by one row and one column in
 * each step. Givens rotations update the QR factors of this system in O(size^2) operations. A new
 * factorisation would take O(size^3).
 * Called by row_choice.c for --method joint, and by exits.c. */
#include "common/program/arena.h"
#include "deimselect/selection.h"

#include <cblas.h>
#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

/* Interpolation of the next mode of a basis by the modes before it at the selected rows. */
typedef struct interpolation {
    size_t num_nodes;
    size_t capacity;      // largest value of `size`
    size_t size;          // number of modes and rows so far
    const double *modes;  // [num_modes, num_nodes]
    double *q_transposed; // [capacity, capacity] row-major; modes[:size] at the rows = Q R
    double *r;            // [capacity, capacity] row-major
    double *next_column;  // [capacity] Q^T times modes[size] at the rows
    double *coefficients; // [capacity] a of Fig. A1
    double *residual;     // [num_nodes] phi of Fig. A1
} interpolation;

static interpolation interpolation_of(const selection_bases *bases, int basis, size_t capacity,
                                      arena *memory) {
    return (interpolation){.num_nodes = bases->num_nodes,
                           .capacity = capacity,
                           .modes = bases->modes[basis],
                           .q_transposed = arena_table(memory, capacity, capacity, sizeof(double)),
                           .r = arena_table(memory, capacity, capacity, sizeof(double)),
                           .next_column = arena_array(memory, capacity, sizeof(double)),
                           .coefficients = arena_array(memory, capacity, sizeof(double)),
                           .residual = arena_array(memory, bases->num_nodes, sizeof(double))};
}

/* Solves R a = Q^T b by back substitution, where b is the next mode at the selected rows. If a
 * diagonal entry is zero to working precision, the solution is not unique. The coefficient of
 * this entry is then set to zero, which gives one of the minimisers. */
static void solve_at_selected_rows(interpolation *self, const size_t *rows) {
    const size_t size = self->size, capacity = self->capacity;
    const double *mode = self->modes + size * self->num_nodes;
    double largest = 0.0;

    for (size_t k = 0; k < size; k++) {
        const double *q = self->q_transposed + k * capacity;
        double sum = 0.0;
        for (size_t l = 0; l < size; l++)
            sum += q[l] * mode[rows[l]];
        self->next_column[k] = sum;
        largest = fmax(largest, fabs(self->r[k * capacity + k]));
    }
    for (size_t k = size; k-- > 0;) {
        const double *r = self->r + k * capacity;
        const double rest =
            cblas_ddot((int)(size - k - 1), r + k + 1, 1, self->coefficients + k + 1, 1);
        const bool singular = fabs(r[k]) <= (double)size * DBL_EPSILON * largest;
        self->coefficients[k] = singular ? 0.0 : (self->next_column[k] - rest) / r[k];
    }
}

/* Computes phi = Phi^(n̄) - Phi^(1...n̄-1) a on all rows. */
static void update_residual(interpolation *self) {
    memcpy(self->residual, self->modes + self->size * self->num_nodes,
           self->num_nodes * sizeof *self->residual);
    cblas_dgemv(CblasColMajor, CblasNoTrans, (int)self->num_nodes, (int)self->size, -1.0,
                self->modes, (int)self->num_nodes, self->coefficients, 1, 1.0, self->residual, 1);
}

/* Extends the factors Q R by one column, the mode that was interpolated last, and by one row, the
 * entries of the modes at `row`. */
static void append_row(interpolation *self, size_t row) {
    const size_t size = self->size, capacity = self->capacity;
    double *last_r = self->r + size * capacity, *last_q = self->q_transposed + size * capacity;

    for (size_t k = 0; k < size; k++)
        self->r[k * capacity + size] = self->next_column[k];
    for (size_t mode = 0; mode <= size; mode++)
        last_r[mode] = self->modes[mode * self->num_nodes + row];
    last_q[size] = 1.0;
    // rotate the entries of the new row of R left of its diagonal to zero
    for (size_t k = 0; k < size; k++) {
        double *r = self->r + k * capacity, *q = self->q_transposed + k * capacity;
        double cosine, sine;
        cblas_drotg(&r[k], &last_r[k], &cosine, &sine);
        last_r[k] = 0.0;
        cblas_drot((int)(size - k), r + k + 1, 1, last_r + k + 1, 1, cosine, sine);
        cblas_drot((int)(size + 1), q, 1, last_q, 1, cosine, sine);
    }
    self->size++;
}

/* Returns the unselected row with the largest phi_f^2 + phi_J^2. If several rows have this value,
 * returns the first of these rows. */
static size_t worst_row(const interpolation both[2], const bool *selected) {
    size_t row = 0;
    double largest = -1.0;
    for (size_t i = 0; i < both[0].num_nodes; i++) {
        const double phi_f = both[0].residual[i], phi_J = both[1].residual[i];
        const double error = phi_f * phi_f + phi_J * phi_J;
        if (selected[i] || !(error > largest)) continue;
        largest = error;
        row = i;
    }
    return row;
}

static ehd_status check_bases(const selection_bases *bases, size_t num_rows, ehd_error *error) {
    const char *const names[] = {"residual", "Jacobian"};
    for (size_t basis = 0; basis < 2; basis++)
        if (num_rows > bases->num_modes[basis])
            return ehd_fail(error, EHD_DATA,
                            "rows: found %zu, expected at most %zu, the modes of the %s basis, "
                            "because method joint needs one mode a row",
                            num_rows, bases->num_modes[basis], names[basis]);
    if (num_rows > bases->num_nodes)
        return ehd_fail(error, EHD_DATA, "rows: found %zu, expected at most %zu, the nodes",
                        num_rows, bases->num_nodes);
    return EHD_OK;
}

ehd_status selection_joint(size_t *rows, const selection_bases *bases, size_t num_rows,
                           ehd_error *error) {
    arena memory = {0};
    ehd_status status = check_bases(bases, num_rows, error);
    if (status || num_rows == 0) return status;

    bool *selected = arena_array(&memory, bases->num_nodes, sizeof *selected);
    interpolation both[] = {interpolation_of(bases, 0, num_rows, &memory),
                            interpolation_of(bases, 1, num_rows, &memory)};
    if (memory.failed) status = ehd_no_memory(error, "row selection");
    for (size_t n = 0; n < num_rows && !status; n++) {
        for (size_t basis = 0; basis < 2; basis++) {
            solve_at_selected_rows(&both[basis], rows);
            update_residual(&both[basis]);
        }
        const size_t row = worst_row(both, selected);
        for (size_t basis = 0; basis < 2; basis++)
            append_row(&both[basis], row);
        rows[n] = row;
        selected[row] = true;
    }
    arena_free(&memory);
    return status;
}
