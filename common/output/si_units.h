/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the factors that convert the numbers of a file to SI units, from the schema of the file. */
#ifndef EHD_SI_UNITS_H
#define EHD_SI_UNITS_H

#include "common/artefact/artefact.h"

/* Units and factors of one dataset, axis or attribute. */
typedef struct si_units {
    const char *units;      // "m"; "1": dimensionless; "": the schema does not have the name
    double factor;          // 1: no conversion
    double *frame;          // [num_frames] second factor, varies along frame_axis; NULL: none
    size_t num_frames;      // length of frame_axis
    const char *frame_axis; // axis of `frame`: "time"
} si_units;

/* Returns EHD_DATA for a kind of file without SI units. */
ehd_status si_units_check(const artefact *file, ehd_error *error);

/* Reads the units and the factor of a name; with `frames` also the second factor. Returns EHD_DATA
 * if the file lacks an attribute or field that the factors need. Other errors: EHD_MEMORY,
 * EHD_IO. */
ehd_status si_units_read(
    // output:
    si_units *self, // free with si_units_free, also after a failure
    // input:
    artefact *file, const char *name, bool frames, ehd_error *error);

/* Returns the product of both factors for entry `place` of frame_axis. */
double si_units_at(const si_units *self, size_t place);

/* Returns the unit that the schema gives for a name, or "" if the schema does not contain the
 * name. */
const char *si_units_plain(const artefact *file, const char *name);

void si_units_free(si_units *self);

#endif
