/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Error indicator of a reduced solution's films (README.md, Indicated deviation).
 *
 * The residual of the selected rows, over-determined, and of the control rows samples that of the
 * Reynolds equation everywhere. What a residual in each of them does to a film follows from the
 * factors of the last iteration; together that is a bound up to a factor, which calibration fits. */
#ifndef EHD_INDICATOR_H
#define EHD_INDICATOR_H

#include "common/output/indicated.h"
#include "romrun/online/reduced_solver.h"

typedef struct indicator indicator;

/* The model must outlive it. NULL: no memory. */
indicator *indicator_create(const reduced_model *model);
indicator *indicator_free(indicator *self); // accepts and returns NULL

/* D f of the control rows of a stationary state, [rows of the control set]; 0 behind the exit. Valid
 * until the next call. */
const double *indicator_control_residuals(indicator *self, const reduced_state *state,
                                          const ehd_contact *contact);

/* Bound of the relative deviation of the central film, up to the factor of a calibration
 * (trade_indicator_factor): the root of the sum over selected and control rows of the squares of
 * what their residuals do to the film. A control row has the influence of the nearest selected one.
 * `solver` has just solved `state` for `contact`, stationary, with the outcome `scalars`. */
double indicator_bound(indicator *self, reduced_solver *solver, const reduced_state *state,
                       const ehd_contact *contact, const contact_scalars *scalars);

/* The same of the minimum film, of the solution that indicator_bound was just called for. */
double indicator_bound_minimum(indicator *self, reduced_solver *solver,
                               const contact_scalars *scalars);

/* Bounds of the others, by indicated_quantity, of the solution that indicator_bound was just called
 * for: for the fields' sake twice as many instructions as a solution. Those of the fields are the most
 * at the node of any row. NaN where the quantity has none. */
void indicator_bound_others(double bounds[NUM_INDICATED], indicator *self, reduced_solver *solver,
                            const reduced_state *state, const ehd_contact *contact,
                            const contact_scalars *scalars);

/* Bound of the largest pressure's deviation, in Hertz pressures, of the solution that indicator_bound was
 * just called for: as INDICATED_PRESSURE of the others, at that node alone, for a hundredth of what
 * these take. */
double indicator_bound_peak(indicator *self, reduced_solver *solver);

/* Bound of the relative deviation of the friction force, of the solution that indicator_bound was
 * just called for and of a model with a cubature: as of the others, by the derivatives of its sum
 * of shear stresses, and what that sum is off in training. The law and the ratio are those of
 * `contact`, which slides; else it is that of the solution. */
double indicator_bound_friction(indicator *self, reduced_solver *solver, const reduced_state *state,
                                const ehd_contact *contact,
                                double friction); // contact_traction.friction of it

#endif
