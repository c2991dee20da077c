/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Filters films that are carried along their paths. In a film that pressure cannot move, the
 * equations damp no wave. Cubic splines damp none either if a step's path is a whole number of
 * nodes. In each step the filter damps waves that the grid cannot carry, and waves that make a
 * reduced model's rank grow with the grid (README.md, Along the path).
 * Called by fullrun/previous.c and romrun/state/film_splines.c. */
#ifndef EHD_PATH_FILTER_H
#define EHD_PATH_FILTER_H

#include "common/physics/contact.h"

/* The filter (I + D' diag(alpha) D)^-1 along each line of a grid. D are the differences of order
 * PATH_FILTER_ORDER. The filter multiplies a wave of length 2 pi/k by 1/(1 + (length k/2)^10), if
 * the wave is several grid steps long. Polynomials of a degree below the order do not change, sums
 * are kept, and the filter is its own transpose. */
typedef struct path_filter {
    size_t num_columns, num_lines;
    double *weight; // [num_lines, num_columns] alpha of the difference that begins at a column
    double *factor; // [num_lines, num_columns, PATH_FILTER_ORDER + 1] banded Cholesky factor
    double *work;   // [2, num_columns]
} path_filter;

enum { PATH_FILTER_ORDER = 5 };

/* Makes the filter of a grid. Its length is `length` half widths at the centre. Towards the rim of
 * the dry contact it falls to zero as sqrt(1 - X^2 - Y^2), like the dry pressure. Outside it is
 * zero. The filter therefore hardly changes the film near the rim, at the constriction and the
 * pressure spike. EHD_MEMORY; EHD_DATA: a length of too many steps. */
ehd_status path_filter_init(
    // output:
    path_filter *self, // free with path_filter_free
    // input:
    const ehd_grid *grid, double length, ehd_error *error);
void path_filter_free(path_filter *self);

/* Returns the filter length of a contact, in half widths. The result is the given length, or else
 * 0.014. The default is smaller if the time steps have a tolerance below the usual one, but at
 * least 0.85 steps of the contact's grid. Measured on the paper's transient case and a point
 * contact on 65 by 65 nodes (README.md): with a shorter length a reduced model takes more modes,
 * with a longer one the central film is more than 1.5 % off at fronts. */
double path_filter_length(const ehd_contact *contact);

/* Returns how the contact's films are carried. The smoothing along the path is
 * path_filter_length. */
ehd_carriage path_carriage(const ehd_contact *contact);

/* Applies a fraction of the filter's change, 0 … 1, to the values along a line, which are `stride`
 * apart. A step uses the fraction frame_step_share, so that many short steps filter a path as much
 * as a few longer ones. Uses self->work. */
void path_filter_apply(
    // in and out:
    path_filter *self,
    double *values, // [num_columns, stride]
    // input:
    size_t line, size_t stride, double share);

#endif
