/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The product of the normal equations, which is most of what they cost. */
#ifndef EHD_GRAM_H
#define EHD_GRAM_H

#include <stddef.h>

/* The lower part of J^T J, in columns; what is above it is not to be used. */
void gram_matrix(
    // output:
    double *gram, // [num_columns, num_columns]
    // input:
    const double *matrix, // J, [num_rows, num_columns] row-major
    size_t num_rows, size_t num_columns);

#endif
