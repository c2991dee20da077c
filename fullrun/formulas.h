/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the published film formulas say of a contact that was solved: printed, a line each. */
#ifndef EHD_FORMULAS_H
#define EHD_FORMULAS_H

#include "common/physics/contact.h"
#include "common/program/status.h"
#include "common/settings/scene.h"

/* Film, its deviation from the solution's (central or smallest, as the formula is for), time of one
 * evaluation and source. */
void formulas_print(const contact_scalars *solution, const ehd_contact *contact);

/* The same for a finished transient result: the formulas are applied to the contact as it is at each time,
 * as if it were stationary; printed are the worst deviation, 95 % and median over time. EHD_MEMORY, and what
 * reading the result and the scene's histories gives. */
ehd_status formulas_print_in_time(const char *path, const scene *given,
                                  const ehd_contact *reference, ehd_error *error);

#endif
