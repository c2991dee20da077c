/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the stability of the selected rows if the exit removes some of these rows, and updates
 * the stability for each new row (README.md, Stability). Called by exits.c for each row, and by
 * row_choice.c.
 *
 * If even all rows before an exit determine a combination of modes (a direction) badly, no
 * selection can determine this direction. At the worst exit of the region of lower load, the
 * smallest singular value of all rows is 1.3e-4. The modes are therefore made orthonormal over the
 * rows before each exit. The smallest singular value of all rows is then 1, and the value of a
 * selection is relative to this value. Without an exit, the value of a selection is the smallest
 * singular value of the modes sampled at the rows. The array `exits` of the bases must outlive the
 * row_stability. */
#ifndef EHD_STABILITY_H
#define EHD_STABILITY_H

#include "deimselect/selection.h"

typedef struct row_stability row_stability;

/* Creates a row_stability, in which no row is selected yet. The stability is later computed for the
 * leading modes of both bases: for each exit of training, where only the rows before this exit
 * count, and once for all rows. If a combination of modes (a direction) is nearly zero at all rows
 * before an exit, it is omitted for this exit. Errors: EHD_MEMORY, EHD_INTERNAL (LAPACK). */
ehd_status row_stability_create(
    // output:
    row_stability **self, // free with row_stability_free
    // input:
    const selection_bases *bases, ehd_error *error);
row_stability *row_stability_free(row_stability *self); // accepts and returns NULL

/* Returns the memory of a row_stability, bytes. */
double row_stability_bytes(size_t num_leading, size_t num_exits);

/* Adds a row to the selection. An added row never decreases the smallest singular value of an
 * exit. */
void row_stability_add(row_stability *self, size_t row);

/* Computes the smallest singular value over all exits and both bases. The value is zero if too few
 * rows lie before an exit. At the worst exit, one direction of the modes is determined worst.
 * *best_row is the unselected row with the largest entry in this direction. Errors: EHD_MEMORY,
 * EHD_INTERNAL. */
ehd_status row_stability_worst(
    // output:
    double *sigma_min,
    size_t *best_row, // may be NULL
    // in and out: `self` stores eigenvalues of the exits
    row_stability *self, ehd_error *error);

/* Computes 1/sigma_min of the rows. Errors as row_stability_worst. */
ehd_status row_stability_of(
    // output:
    double *inverse_sigma_min,
    // input:
    const selection_bases *bases, const size_t *rows, size_t num_rows, ehd_error *error);

/* Finds the smallest k for which 1/sigma_min of the first k rows is at most `max_inverse`. If even
 * all rows do not suffice, the result is num_rows + 1. Errors as row_stability_worst. */
ehd_status row_stability_fewest(
    // output:
    size_t *fewest,
    // input:
    const selection_bases *bases, const size_t *rows, size_t num_rows, double max_inverse,
    ehd_error *error);

#endif
