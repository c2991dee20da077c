/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/algebra/nnls.h"

#include "common/algebra/qr.h"
#include "common/algebra/rounding.h"
#include "common/algebra/vectors.h"
#include "common/program/arena.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* Largest number of changes of the set of columns in use, per column of the matrix. After more
 * changes the search fails. One change per column is too few (test_nnls.c,
 * solutions_are_optimal). */
enum { MAX_CHANGES = 10 };

/* The columns, scaled to unit length, and the right side. Both are rotated so that the columns in
 * use form a triangular matrix: column used[i] has zeros below row i. The rows of the right side
 * from num_used on are the residual. */
typedef struct active_set {
    size_t num_rows, num_columns, num_used;
    double *columns; // [num_columns + 1, num_rows], the last column is the right side
    double *length;  // [num_columns] original length of a column; 0: column omitted
    size_t *used;    // [num_used] columns with x > 0
    bool *in_use;    // [num_columns]
    bool *refused;   // [num_columns] true: depends on the columns in use
    double *value;   // [num_used] x for the columns of unit length
    double *next;    // [num_used] least squares solution of the columns in use
    double *factor;  // [num_rows] work for a reflection
} active_set;

struct nnls_space {
    active_set set;
    size_t max_rows, max_columns;
    arena memory;
};

nnls_space *nnls_space_free(nnls_space *self) {
    if (self) arena_free(&self->memory);
    free(self);
    return NULL;
}

nnls_space *nnls_space_create(size_t max_rows, size_t max_columns) {
    nnls_space *self = calloc(1, sizeof *self);
    const size_t longest = max_rows > max_columns ? max_rows : max_columns + 1;

    if (!self) return NULL;
    active_set *set = &self->set;
    arena *memory = &self->memory;
    self->max_rows = max_rows;
    self->max_columns = max_columns;
    set->columns = arena_table(memory, max_columns + 1, max_rows, sizeof(double));
    set->length = arena_array(memory, max_columns, sizeof(double));
    set->used = arena_array(memory, max_columns, sizeof *set->used);
    set->in_use = arena_array(memory, max_columns, sizeof *set->in_use);
    set->refused = arena_array(memory, max_columns, sizeof *set->refused);
    set->value = arena_array(memory, max_columns, sizeof(double));
    set->next = arena_array(memory, max_columns, sizeof(double));
    set->factor = arena_array(memory, longest, sizeof(double));
    return memory->failed ? nnls_space_free(self) : self;
}

static double *column_of(const active_set *self, size_t column) {
    return self->columns + column * self->num_rows;
}

static double *right_of(const active_set *self) {
    return column_of(self, self->num_columns);
}

/* Replaces [A b] by R of its QR factorisation if R has fewer rows. The solution stays the same. */
static void compress(active_set *self) {
    const size_t rows = self->num_rows, columns = self->num_columns + 1;
    if (rows <= columns) return;

    qr_reduce(self->columns, self->factor, rows, columns);
    for (size_t j = 0; j < columns; j++)
        memmove(self->columns + j * columns, self->columns + j * rows,
                columns * sizeof *self->columns);
    self->num_rows = columns;
}

static ehd_status begin(active_set *self, const double *matrix, const double *right,
                        ehd_error *error) {
    const size_t rows = self->num_rows, columns = self->num_columns;

    self->num_used = 0;
    memset(self->in_use, 0, columns * sizeof *self->in_use);
    memset(self->refused, 0, columns * sizeof *self->refused);
    memcpy(right_of(self), right, rows * sizeof *right);
    for (size_t j = 0; j <= columns; j++) {
        double *target = column_of(self, j);
        for (size_t i = 0; i < rows && j < columns; i++)
            target[i] = matrix[i * columns + j];
        const double length = vector_norm(target, rows);
        if (!isfinite(length))
            return ehd_fail(error, EHD_DATA,
                            "least squares: found %g as the length of column %zu, expected a "
                            "finite one",
                            length, j);
        if (j == columns) continue;
        self->length[j] = length;
        if (length > 0) vector_scale(target, 1 / length, rows);
    }
    compress(self);
    return EHD_OK;
}

/* Returns the unused column whose scalar product with the residual is largest. Returns num_columns
 * if no product exceeds `least`: a column can reduce the residual only if the cosine of the angle
 * between both is not round-off. */
static size_t steepest(const active_set *self, double least) {
    const size_t first = self->num_used, left = self->num_rows - first;
    const double *residual = right_of(self) + first;
    size_t best = self->num_columns;

    for (size_t j = 0; j < self->num_columns; j++) {
        if (self->in_use[j] || self->refused[j] || self->length[j] == 0) continue;
        const double descent = dot(column_of(self, j) + first, residual, left);
        if (!(descent > least)) continue;
        least = descent;
        best = j;
    }
    return best;
}

/* Adds a column to the columns in use. A Householder reflection of the rows from num_used on makes
 * the column triangular. Returns false if the column depends linearly on the columns in use: its
 * part orthogonal to them is round-off. */
static bool take(active_set *self, size_t taken) {
    const size_t first = self->num_used;
    const size_t left = self->num_rows - first;
    double *column = column_of(self, taken) + first;
    const double length = vector_norm(column, left);
    if (!(length > ROUNDING)) return false;

    const reflection by = reflection_of(self->factor, column, left, length);
    for (size_t j = 0; j <= self->num_columns; j++) {
        if (j < self->num_columns && (self->in_use[j] || j == taken)) continue;
        reflect(column_of(self, j) + first, &by, left);
    }
    memset(column, 0, left * sizeof *column);
    column[0] = by.end;
    self->value[first] = 0;
    self->used[self->num_used++] = taken;
    self->in_use[taken] = true;
    return true;
}

/* Removes the column used[place]. Givens rotations make the later columns triangular again. */
static void drop(active_set *self, size_t place) {
    self->in_use[self->used[place]] = false;
    self->num_used--;
    for (size_t i = place; i < self->num_used; i++) {
        self->used[i] = self->used[i + 1];
        self->value[i] = self->value[i + 1];
        const double *corner = column_of(self, self->used[i]) + i;
        const double length = hypot(corner[0], corner[1]);
        const double cosine = corner[0] / length, sine = corner[1] / length;
        for (size_t j = 0; j <= self->num_columns && length > 0; j++) {
            double *pair = column_of(self, j) + i;
            const double above = pair[0];
            pair[0] = cosine * above + sine * pair[1];
            pair[1] = cosine * pair[1] - sine * above;
        }
        column_of(self, self->used[i])[i + 1] = 0;
    }
}

/* Computes self->next, the least squares solution of the columns in use. */
static void solve_used(active_set *self) {
    for (size_t i = self->num_used; i-- > 0;) {
        double sum = right_of(self)[i];
        for (size_t k = i + 1; k < self->num_used; k++)
            sum -= column_of(self, self->used[k])[i] * self->next[k];
        self->next[i] = sum / column_of(self, self->used[i])[i];
    }
}

/* Moves x to the least squares solution of the columns in use, and drops the columns whose x
 * becomes zero on the way. */
static void settle(active_set *self) {
    for (;;) {
        double part = 1;
        size_t first = self->num_used;

        solve_used(self);
        for (size_t i = 0; i < self->num_used; i++) {
            const double to_zero = self->value[i] / (self->value[i] - self->next[i]);
            if (self->next[i] > 0 || (first < self->num_used && to_zero >= part)) continue;
            part = to_zero;
            first = i;
        }
        for (size_t i = 0; i < self->num_used; i++)
            self->value[i] += part * (self->next[i] - self->value[i]);
        if (first == self->num_used) return;
        self->value[first] = 0;
        for (size_t i = self->num_used; i-- > 0;)
            if (!(self->value[i] > 0)) drop(self, i);
    }
}

/* Returns |A x - b| for the least squares solution of the columns in use. */
static double residual_of(const active_set *self) {
    return vector_norm(right_of(self) + self->num_used, self->num_rows - self->num_used);
}

static ehd_status improve(active_set *self, double tolerance, ehd_error *error) {
    const double length = residual_of(self), least = ROUNDING * length;

    for (size_t change = 0; change < MAX_CHANGES * self->num_columns; change++) {
        if (residual_of(self) <= tolerance * length) return EHD_OK;
        const size_t best =
            self->num_used < self->num_rows ? steepest(self, least) : self->num_columns;
        if (best == self->num_columns) return EHD_OK;
        if (!take(self, best)) {
            self->refused[best] = true;
            continue;
        }
        settle(self);
        memset(self->refused, 0, self->num_columns * sizeof *self->refused);
    }
    return ehd_fail(error, EHD_NOT_CONVERGED,
                    "least squares: found other columns after %zu changes, expected them to stay",
                    MAX_CHANGES * self->num_columns);
}

ehd_status nnls_solve_in(double *x, nnls_space *space, const double *matrix, const double *right,
                         size_t num_rows, size_t num_columns, double tolerance, ehd_error *error) {
    active_set *self = &space->set;

    if (num_rows > space->max_rows || num_columns > space->max_columns)
        return ehd_fail(error, EHD_INTERNAL,
                        "least squares: found %zu by %zu numbers, expected at most %zu by %zu",
                        num_rows, num_columns, space->max_rows, space->max_columns);
    self->num_rows = num_rows;
    self->num_columns = num_columns;
    ehd_status status = begin(self, matrix, right, error);

    memset(x, 0, num_columns * sizeof *x);
    if (!status) status = improve(self, tolerance, error);
    for (size_t i = 0; i < self->num_used; i++)
        x[self->used[i]] = self->value[i] / self->length[self->used[i]];
    return status;
}

ehd_status nnls_solve(double *x, const double *matrix, const double *right, size_t num_rows,
                      size_t num_columns, double tolerance, ehd_error *error) {
    nnls_space *space = nnls_space_create(num_rows, num_columns);
    if (!space) return ehd_no_memory(error, "least squares");

    const ehd_status status =
        nnls_solve_in(x, space, matrix, right, num_rows, num_columns, tolerance, error);
    nnls_space_free(space);
    return status;
}
