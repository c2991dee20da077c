/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Holds the names of axes and datasets of a model file (schemas/model.md), for the writer and the
 * reader of the file.
 * Used by model_file.c and model_read.c. */
#ifndef EHD_MODEL_FIELDS_H
#define EHD_MODEL_FIELDS_H

#include "romrun/model/reduced_model.h"

/* Names of the axes and datasets of a set of rows. */
typedef struct row_fields {
    const char *row_axis, *needed_axis;
    const char *row, *weight, *needed;
    const char *pressure;
    const char *film[2]; // indexed by deformation_kind
} row_fields;
extern const row_fields selected_fields, control_fields;

/* Names of the axis and datasets of a cubature. */
typedef struct traction_fields {
    const char *axis, *node;
    const char *friction, *dry;
    const char *moment;
    const char *pressure;
    const char *film[2]; // indexed by deformation_kind
} traction_fields;
extern const traction_fields cubature_fields;

/* Number of members of band_line that the file of a point contact stores. */
enum { NUM_BAND_FIELDS = 4 };
extern const char *const band_fields[NUM_BAND_FIELDS];
/* Returns the member of `line` that belongs to band_fields[field]. */
size_t *band_value(band_line *line, int field);

#endif
