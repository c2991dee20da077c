/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prints published film formulas beside the solution of a contact, a line each. */
#ifndef EHD_FORMULAS_H
#define EHD_FORMULAS_H

#include "common/physics/contact.h"
#include "common/physics/traction.h"
#include "common/program/status.h"
#include "common/settings/scene.h"

/* Film, its deviation from the solution's, time of one evaluation and source. */
void formulas_print(const contact_scalars *solution, const ehd_contact *contact);

/* The traction curve of a contact with Eyring's law of shear at the film of its formula, and the
 * deviation from the solution's coefficient; nothing of others. */
void formulas_print_traction(const contact_traction *solution, const ehd_contact *contact);

/* Films, and of Eyring's law the friction coefficient, for a finished transient result, the contact of
 * each time taken as stationary: worst deviation, 95 % and median over time; the traction curve of the
 * first time. EHD_MEMORY; errors of reading result and histories. */
ehd_status formulas_print_in_time(const char *path, const scene *given,
                                  const ehd_contact *reference, ehd_error *error);

#endif
