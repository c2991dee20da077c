/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What an FMU says of itself: modelDescription.xml of both versions of the standard, and a page for people. */
#ifndef EHD_FMU_DESCRIPTION_H
#define EHD_FMU_DESCRIPTION_H

#include "romrun/fmu/variables.h"

typedef struct fmu_description {
    const fmu_contents *contents;
    const char *name;      // of the model, as a user calls it
    const char *generated; // "2026-01-31T12:00:00Z"; NULL: not told
    double step, stop;     // s, of an experiment that shows something
} fmu_description;

extern const char fmu_identifier[]; // names the shared object

/* fmi: 2 or 3. */
void fmu_describe(FILE *file, const fmu_description *of, int fmi);
/* HTML. */
void fmu_document(FILE *file, const fmu_description *of);

#endif
