/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads rows that another program has selected (schemas/model.md).
 * Called by main.c for --rows-from. */
#ifndef EHD_GIVEN_ROWS_H
#define EHD_GIVEN_ROWS_H

#include "common/program/status.h"
#include "romrun/model/reduced_model.h"
#include <stddef.h>

typedef struct given_rows {
    size_t count;
    size_t *rows;    // [count] indices of inner nodes; 0 is the first node of the first inner line
    double *factors; // [count] the least squares multiply each row by D of the basis and by this
                     // factor; NULL: the file has no weights
} given_rows;

/* Reads a column or dataset `row` (also: rows, selected_row) and, if present, `weight` (weights,
 * row_factor). The file is HDF5 if its name ends with .h5 or .hdf5, otherwise CSV with a header.
 * Rows are numbered like selected_row in schemas/model.md.
 *
 * EHD_NOINPUT: the file does not exist.
 *
 * EHD_DATA:
 * - The column `row` is missing.
 * - An entry is not the index of an inner node, or occurs twice.
 * - There are fewer rows than the unknowns need.
 * - A weight is not positive and finite.
 *
 * Other errors: EHD_IO, EHD_MEMORY. */
ehd_status given_rows_read(
    // output:
    given_rows *self, // free with given_rows_free
    // input:
    const char *path, const reduced_basis *basis, ehd_error *error);
void given_rows_free(given_rows *self);

#endif
