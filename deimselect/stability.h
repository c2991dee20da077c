/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How well posed selected rows are when the exit takes some of them away, row by row.
 *
 * What all rows before an exit determine badly, no selection determines well: at the worst exit of
 * the lower loaded region all of them have a smallest singular value of 1.3e-4. Here the modes are
 * made orthonormal over the rows before each exit, so that all rows have 1, and a selection what it
 * keeps of that. Without an exit this is the smallest singular value of the modes sampled at the
 * rows. The bases' exits have to outlive the object. */
#ifndef EHD_STABILITY_H
#define EHD_STABILITY_H

#include "deimselect/selection.h"

typedef struct row_stability row_stability;

/* For the leading modes of the bases over the rows before each exit and over all nodes, no row
 * added yet. Directions of the modes that nearly vanish before an exit are left out there.
 * EHD_MEMORY, EHD_INTERNAL (LAPACK). */
ehd_status row_stability_create(
    // output:
    row_stability **self, // free with row_stability_free
    // input:
    const selection_bases *bases, ehd_error *error);
row_stability *row_stability_free(row_stability *self); // accepts and returns NULL

/* Bytes that it takes. */
double row_stability_bytes(size_t num_leading, size_t num_exits);

/* Adds a row to the selection: at no exit does the smallest singular value fall. */
void row_stability_add(row_stability *self, size_t row);

/* Smallest singular value over all exits and both bases, zero where an exit leaves too few rows,
 * and with `best_row` the unselected row with the largest entry in the worst determined direction
 * there. EHD_MEMORY, EHD_INTERNAL. */
ehd_status row_stability_worst(
    // output:
    double *sigma_min,
    size_t *best_row, // NULL: not wanted
    // in and out: what is known of each exit
    row_stability *self, ehd_error *error);

/* 1/sigma_min of the rows. Errors as above. */
ehd_status row_stability_of(
    // output:
    double *inverse_sigma_min,
    // input:
    const selection_bases *bases, const size_t *rows, size_t num_rows, ehd_error *error);

/* The fewest of the rows, in order, that leave 1/sigma_min at no more than `max_inverse`; num_rows
 * + 1: all are too few. Errors as above. */
ehd_status row_stability_fewest(
    // output:
    size_t *fewest,
    // input:
    const selection_bases *bases, const size_t *rows, size_t num_rows, double max_inverse,
    ehd_error *error);

#endif
