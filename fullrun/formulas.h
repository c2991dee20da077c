/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compares published film formulas with the solution of a contact, one printed line per formula
 * (common/physics/README.md, Film formulas).
 * Called by main.c for --formulas. */
#ifndef EHD_FORMULAS_H
#define EHD_FORMULAS_H

#include "common/physics/contact.h"
#include "common/physics/traction.h"
#include "common/program/status.h"
#include "common/settings/scene.h"

/* Prints a line for each formula: the film of the formula, its deviation from the film of the
 * solution, the time of one evaluation, and the source. */
void formulas_print(const contact_scalars *solution, const ehd_contact *contact);

/* For a contact with Eyring's law of shear, prints the traction curve and the friction coefficient
 * of the traction formula. Both are computed with the film of the film formula. Also prints how
 * much this coefficient deviates from the coefficient of the solution. Prints nothing for other
 * laws of shear. */
void formulas_print_traction(const contact_traction *solution, const ehd_contact *contact);

/* Prints the deviation of the film formulas from a finished transient result: the largest value,
 * the 95 % quantile and the median over time. The contact at each time is taken as stationary. With
 * Eyring's law of shear, also compares the friction coefficient and prints the traction curve at
 * the first stored time at which the bodies are in contact.
 * Errors: EHD_MEMORY, and the errors of reading the result and the histories. */
ehd_status formulas_print_in_time(const char *path, const scene *given,
                                  const ehd_contact *reference, ehd_error *error);

#endif
