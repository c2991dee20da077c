/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The traction of a result: into its file, and printed. */
#ifndef EHD_TRACTION_OUTPUT_H
#define EHD_TRACTION_OUTPUT_H

#include "common/artefact/artefact.h"
#include "common/output/film_effects.h"
#include "common/physics/traction.h"

enum { NUM_TRACTION = 7 };

/* One number of a contact_traction. */
typedef struct traction_entry {
    const char *field; // in files: "friction_coefficient"
    size_t offset;     // of a double in contact_traction
    const char *text;  // printed: "friction coefficient"
} traction_entry;

extern const traction_entry traction_entries[NUM_TRACTION];

/* Attributes of a result that its numbers are units of, beside those of result_put_contact. */
ehd_status traction_put_units(artefact *file, const ehd_contact *contact, ehd_error *error);

/* The numbers of a stationary result. */
ehd_status traction_put(artefact *file, const contact_traction *traction, ehd_error *error);

/* The stresses on both surfaces as entry `index` of their fields. EHD_MEMORY; and as
 * artefact_put_part. */
ehd_status traction_put_stresses(artefact *file, size_t index, const ehd_contact *contact,
                                 const double *pressure, // [num_nodes]
                                 const double *film,     // [num_nodes]
                                 double rigid_approach,  // in the contact's frame
                                 ehd_error *error);

/* Prints a line for each, in units of the contact and SI units. Rolling resistance, rolling moment and
 * power loss have only the digits that the error estimate of the rolling resistance allows. A further line
 * where the friction is more than a lubricant carries. */
void traction_print(const contact_traction *traction, const ehd_contact *contact,
                    const film_effects *effects); // of the grid

#endif
