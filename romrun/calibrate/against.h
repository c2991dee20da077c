/* SPDX-License-Identifier: GPL-3.0-or-later */
/* romrun --against: compares a reduced result with another result of the same scene. If the other
 * result has another grid, cubics interpolate its fields.
 * Called by romrun/main.c. */
#ifndef EHD_AGAINST_H
#define EHD_AGAINST_H

#include "common/output/result.h"
#include "common/output/time_result.h"
#include "common/output/time_run.h"
#include "common/physics/traction.h"

/* Checks that a result that was read from `path`, with these numbers and this grid, belongs to the
 * contact. EHD_DATA: it does not. */
ehd_status against_check(double moes_M, double alpha_p_H, double hertz_pressure,
                         flow_thinning thinning, const ehd_grid *grid, const char *path,
                         const ehd_contact *contact, ehd_error *error);

/* Returns the largest difference between a field on `grid` and a field on `other`, which is a whole
 * grid. The function interpolates the other field with four nodes along each axis. It compares only
 * nodes inside both grids. */
double against_difference(const double *nodes, // [num_nodes] of `grid`
                          const ehd_grid *grid,
                          const double *inner, // [num_inner] of `other`
                          const ehd_grid *other);

/* Prints the deviations of scalars and, if both results have fields, the largest differences of the
 * fields. The heading states whether the stored result has another grid, discretisation or
 * boundary. */
void against_print(const run_result *result, const stored_result *stored, const char *path,
                   const ehd_contact *contact);

/* Prints the largest and the mean deviation over the times at which the bodies are in contact in
 * both runs. Errors: EHD_MEMORY. */
ehd_status against_print_in_time(const time_trace *trace, const time_series *full, const char *path,
                                 const ehd_grid *grid, // grid of the trace
                                 ehd_error *error);

#endif
