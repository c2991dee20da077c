/* SPDX-License-Identifier: GPL-3.0-or-later */
/* romrun --against: comparison of a reduced result with another one of the same scene. */
#ifndef EHD_AGAINST_H
#define EHD_AGAINST_H

#include "common/output/result.h"
#include "common/output/time_result.h"
#include "common/output/time_run.h"
#include "common/physics/traction.h"

/* EHD_DATA: a result with these numbers on a grid, read from `path`, is not one of the contact. */
ehd_status against_check(double moes_M, double alpha_p_H, double hertz_pressure,
                         flow_thinning thinning, const ehd_grid *grid, const char *path,
                         const ehd_contact *contact, ehd_error *error);

/* Largest difference of a field at the nodes of a grid from one of another whole grid, which is
 * interpolated there with four nodes an axis; at the nodes that lie in both. */
double against_difference(const double *nodes, // [num_nodes] of grid
                          const ehd_grid *grid,
                          const double *inner, // [num_inner] of other
                          const ehd_grid *other);

/* Prints the deviations of scalars and, where both have fields, their largest differences; and
 * whether the stored one has another grid or discretisation. */
void against_print(const run_result *result, const stored_result *stored, const char *path,
                   const ehd_contact *contact);

/* Prints largest and mean deviation over time. EHD_DATA: few times in common; EHD_MEMORY. */
ehd_status against_print_in_time(const time_trace *trace, const time_series *full, const char *path,
                                 const ehd_grid *grid, // of the trace
                                 ehd_error *error);

#endif
