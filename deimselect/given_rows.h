/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows that somebody else selected, from a file. */
#ifndef EHD_GIVEN_ROWS_H
#define EHD_GIVEN_ROWS_H

#include "common/program/status.h"
#include "romrun/model/reduced_model.h"
#include <stddef.h>

typedef struct given_rows {
    size_t count;
    size_t *rows;    // [count] inner nodes of the grid, 0 the first of the first inner line
    double *factors; // [count] factors of D in the row weights; NULL: the file has none
} given_rows;

/* Reads a column or dataset `row` (also: rows, selected_row), and `weight` (weights, row_factor)
 * where there is one, from an HDF5 file (name ending with .h5 or .hdf5) or from CSV with a header.
 * A row is counted as selected_row of schemas/model.md. EHD_NOINPUT: no such file; EHD_DATA: no
 * such column, anything but whole numbers of inner nodes, each once and enough for the unknowns, or
 * a weight that is not a positive finite number; EHD_IO, EHD_MEMORY. */
ehd_status given_rows_read(
    // output:
    given_rows *self, // free with given_rows_free
    // input:
    const char *path, const reduced_basis *basis, ehd_error *error);
void given_rows_free(given_rows *self);

#endif
