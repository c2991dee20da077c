/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes the traction of a result to its file, and prints it. */
#ifndef EHD_TRACTION_OUTPUT_H
#define EHD_TRACTION_OUTPUT_H

#include "common/artefact/artefact.h"
#include "common/output/columns.h"
#include "common/output/film_effects.h"
#include "common/physics/traction.h"
#include "common/program/program.h"

/* The numbers of a contact_traction that are written: "friction_coefficient", … Ends with {0}. */
extern const column traction_columns[];

/* Writes slide_roll and the attributes that convert traction to SI units, except for those that
 * result_put_contact writes. */
ehd_status traction_put_units(artefact *file, const ehd_contact *contact, ehd_error *error);

/* Writes the traction of a stationary result. */
ehd_status traction_put(artefact *file, const contact_traction *traction, ehd_error *error);

/* Writes the shear stresses on both surfaces as entry `index` of their fields. Errors: EHD_MEMORY,
 * and the errors of artefact_put_part. */
ehd_status traction_put_stresses(artefact *file, size_t index, const ehd_contact *contact,
                                 const double *pressure, // [num_nodes]
                                 const double *film,     // [num_nodes]
                                 double rigid_approach,  // in the units of `contact`
                                 ehd_error *error);

/* Prints a line for each number, dimensionless and in SI units. Rolling resistance, rolling moment
 * and power loss are printed only with the digits that the error estimate of the rolling resistance
 * allows. */
void traction_print(const contact_traction *traction, const ehd_contact *contact,
                    const film_effects *effects); // error estimates of the grid

/* Warns of a friction coefficient above usual_friction. */
void traction_warn(const program *caller, double friction);

#endif
