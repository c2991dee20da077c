/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Describes an FMU: modelDescription.xml of both versions of the standard, and an HTML page for the
 * user. */
#ifndef EHD_FMU_DESCRIPTION_H
#define EHD_FMU_DESCRIPTION_H

#include "romrun/fmu/variables.h"

typedef struct fmu_description {
    const fmu_contents *contents;
    const char *name;      // name of the model, for the user
    const char *generated; // "2026-01-31T12:00:00Z"; NULL: left out
    double step, stop;     // s, step and end of the default experiment
} fmu_description;

extern const char fmu_identifier[]; // name of the shared object

/* Writes modelDescription.xml. `fmi`: 2 or 3. */
void fmu_describe(FILE *file, const fmu_description *of, int fmi);
/* Writes the HTML page. */
void fmu_document(FILE *file, const fmu_description *of);

#endif
