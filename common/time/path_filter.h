/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Filters films that are carried along the path of the fluid. Where pressure gradients cause hardly
 * any flow, the equations damp no waves in the film. Cubic splines do not damp waves either if the
 * path of a step is a whole number of grid steps. In each step the filter therefore damps waves
 * that the grid cannot represent. It also damps waves because of which the number of modes of a
 * reduced model would grow with the number of nodes (README.md, Along the path).
 * Called by fullrun/previous.c and romrun/state/film_splines.c. */
#ifndef EHD_PATH_FILTER_H
#define EHD_PATH_FILTER_H

#include "common/physics/contact.h"

/* The filter (I + D' diag(alpha) D)^-1 along each line of a grid. D are the differences of order
 * PATH_FILTER_ORDER. A wave that is several grid steps long and has the wave number k is multiplied
 * by 1/(1 + (length k/2)^10), where `length` is the filter length (path_filter_init). The filter
 * preserves sums, and polynomials of a degree below the order. Its matrix is symmetric. */
typedef struct path_filter {
    size_t num_columns, num_lines;
    double *weight; // [num_lines, num_columns] alpha of the difference that begins at a column
    double *factor; // [num_lines, num_columns, PATH_FILTER_ORDER + 1] banded Cholesky factor
    double *work;   // [2, num_columns]
} path_filter;

enum { PATH_FILTER_ORDER = 5 };

/* Makes the filter of a grid. At the centre the filter length is `length` half widths. Towards the
 * rim of the dry contact the length falls to zero as sqrt(1 - X^2 - Y^2), like the dry pressure.
 * Outside of the dry contact the length is zero. The filter therefore hardly changes the film near
 * the rim, at the constriction and the pressure spike. EHD_MEMORY; EHD_DATA: `length` spans too
 * many grid steps. */
ehd_status path_filter_init(
    // output:
    path_filter *self, // free with path_filter_free
    // input:
    const ehd_grid *grid, double length, ehd_error *error);
void path_filter_free(path_filter *self);

/* Returns the filter length of a contact, in half widths. The result is the given length or, by
 * default, 0.014. The default is smaller if the tolerance of the time steps is below the default
 * tolerance, but at least 0.85 steps of the contact's grid. Measured on the paper's transient case
 * and a point contact on 65 by 65 nodes (README.md): with a shorter length a reduced model needs
 * more modes. With a longer length the error of the central film at fronts exceeds 1.5 %. */
double path_filter_length(const ehd_contact *contact);

/* Returns the transport and the smoothing of the contact's films. With transport along the path,
 * the smoothing is path_filter_length. */
ehd_carriage path_carriage(const ehd_contact *contact);

/* Applies a fraction of the change that the filter causes, `share` from 0 to 1, to the values along
 * a line. The values are `stride` apart. A step uses the fraction frame_step_share, so that many
 * short steps filter a path as much as a few longer steps. Uses self->work. */
void path_filter_apply(
    // in and out:
    path_filter *self,
    double *values, // [num_columns, stride]
    // input:
    size_t line, size_t stride, double share);

#endif
