/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Estimates errors of the films of a reduced solution (README.md, Error estimates).
 * Called by romrun/online/part.c after each solution, and by snapgen/trial.c.
 *
 * The residuals of the over-determined selected rows and of the control rows sample the residual of
 * the Reynolds equation everywhere. The factors of the last iteration give the change of a film
 * that the residual of each row causes. These changes give a bound of the error up to a factor,
 * which a calibration fits. */
#ifndef EHD_INDICATOR_H
#define EHD_INDICATOR_H

#include "common/output/indicated.h"
#include "romrun/solve/reduced_solver.h"

typedef struct indicator indicator;

/* Creates an indicator; the model must outlive it. NULL: no memory. */
indicator *indicator_create(const reduced_model *model);
indicator *indicator_free(indicator *self); // accepts and returns NULL

/* Returns D f of the control rows of a stationary state, [rows of the control set], with zeros
 * behind the exit. The array is valid until the next call. */
const double *indicator_control_residuals(indicator *self, const reduced_state *state,
                                          const ehd_contact *contact);

/* Returns the bound of the relative error of the central film, without the factor of a calibration
 * (trade_indicator_factor). Each selected row and each control row has a residual, which changes
 * the film. The bound is the root of the sum of the squares of these changes. A control row has the
 * influence of the nearest selected row. `solver` has just solved `state` for the stationary
 * `contact`, with the outcome `scalars`. */
double indicator_bound(indicator *self, reduced_solver *solver, const reduced_state *state,
                       const ehd_contact *contact, const contact_scalars *scalars);

/* Returns the bound of the relative error of the minimum film, for the solution that
 * indicator_bound was just called for. */
double indicator_bound_minimum(indicator *self, reduced_solver *solver,
                               const contact_scalars *scalars);

/* Computes the bounds of the other quantities, indexed by indicated_quantity, for the solution that
 * indicator_bound was just called for. The bound of a field is the largest bound over the rows'
 * nodes. These bounds need twice as many instructions as a solution. NaN: the quantity has no
 * bound. */
void indicator_bound_others(double bounds[NUM_INDICATED], indicator *self, reduced_solver *solver,
                            const reduced_state *state, const ehd_contact *contact,
                            const contact_scalars *scalars);

/* Returns the bound of the error of the largest pressure, in Hertz pressures, for the solution that
 * indicator_bound was just called for. The bound is computed like INDICATED_PRESSURE of
 * indicator_bound_others, but only at the node of the largest pressure. This takes a hundredth of
 * the time of indicator_bound_others. */
double indicator_bound_peak(indicator *self, reduced_solver *solver);

/* Returns the bound of the relative error of the friction force, for the solution that
 * indicator_bound was just called for. The model must have a cubature. The bound uses the
 * derivatives of the cubature's sum of shear stresses, and includes the error that this sum had in
 * training. `contact`: the contact of the solution, but with any law of shear stress and any
 * slide-roll ratio. */
double indicator_bound_friction(indicator *self, reduced_solver *solver, const reduced_state *state,
                                const ehd_contact *contact,
                                double friction); // contact_traction.friction for `contact`

#endif
