/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What makes SI units of the numbers of a file, by the rows of its tables. */
#ifndef EHD_SI_UNITS_H
#define EHD_SI_UNITS_H

#include "common/artefact/artefact.h"

/* Of one dataset, axis or attribute. */
typedef struct si_units {
    const char *units;      // "m"; "1" without dimension, "" of what no table knows
    double factor;          // 1 where there is nothing to do
    double *frame;          // [num_frames] another factor, NULL: none
    size_t num_frames;      // length of the axis
    const char *frame_axis; // along which it varies
} si_units;

/* EHD_DATA for a kind of file that has no SI units. */
ehd_status si_units_check(const artefact *file, ehd_error *error);

/* Those of a name; with `frames` also what varies with the time. EHD_DATA: the file lacks what its
 * row refers to; EHD_MEMORY, EHD_IO. */
ehd_status si_units_read(
    // output:
    si_units *self, // free with si_units_free, also after a failure
    // input:
    artefact *file, const char *name, bool frames, ehd_error *error);

/* The factor at a place along that axis. */
double si_units_at(const si_units *self, size_t place);

/* The units that the row of a name says, "" where there is none. */
const char *si_units_plain(const artefact *file, const char *name);

void si_units_free(si_units *self);

#endif
