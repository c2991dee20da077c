/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the stability of the selected rows if the exit removes some of them, and updates it for
 * each new row (README.md, Stability). Called by exits.c for each row, and by row_choice.c.
 *
 * If even all rows before an exit determine a direction badly, no selection can determine it. At
 * the worst exit of the region of lower load, the smallest singular value of all rows is 1.3e-4.
 * The modes are therefore made orthonormal over the rows before each exit. All rows then have the
 * value 1, and the value of a selection is relative to that. Without an exit, the value is the
 * smallest singular value of the modes sampled at the rows. The exits of the bases must outlive the
 * object. */
#ifndef EHD_STABILITY_H
#define EHD_STABILITY_H

#include "deimselect/selection.h"

typedef struct row_stability row_stability;

/* Creates the object for the leading modes of the bases, over the rows before each exit and over
 * all nodes, without selected rows. Directions of the modes that nearly vanish before an exit are
 * omitted for this exit. Errors: EHD_MEMORY, EHD_INTERNAL (LAPACK). */
ehd_status row_stability_create(
    // output:
    row_stability **self, // free with row_stability_free
    // input:
    const selection_bases *bases, ehd_error *error);
row_stability *row_stability_free(row_stability *self); // accepts and returns NULL

/* Returns the memory of a row_stability, bytes. */
double row_stability_bytes(size_t num_leading, size_t num_exits);

/* Adds a row to the selection. An added row decreases the smallest singular value at no exit. */
void row_stability_add(row_stability *self, size_t row);

/* Computes the smallest singular value over all exits and both bases. It is zero if too few rows
 * lie before an exit. *best_row is, of all unselected rows, the one with the largest entry in the
 * direction that is determined worst at the worst exit. Errors: EHD_MEMORY, EHD_INTERNAL. */
ehd_status row_stability_worst(
    // output:
    double *sigma_min,
    size_t *best_row, // may be NULL
    // in and out: keeps eigenvalues of the exits
    row_stability *self, ehd_error *error);

/* Computes 1/sigma_min of the rows. Errors as row_stability_worst. */
ehd_status row_stability_of(
    // output:
    double *inverse_sigma_min,
    // input:
    const selection_bases *bases, const size_t *rows, size_t num_rows, ehd_error *error);

/* Finds the smallest number of leading rows for which 1/sigma_min is at most `max_inverse`;
 * num_rows + 1 if all rows do not suffice. Errors as row_stability_worst. */
ehd_status row_stability_fewest(
    // output:
    size_t *fewest,
    // input:
    const selection_bases *bases, const size_t *rows, size_t num_rows, double max_inverse,
    ehd_error *error);

#endif
