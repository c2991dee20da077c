/* SPDX-License-Identifier: GPL-3.0-or-later */
/* romrun --fmu: an FMU of a scene and a model. */
#ifndef EHD_FMU_EXPORT_H
#define EHD_FMU_EXPORT_H

#include "common/program/program.h"
#include "common/settings/scene.h"
#include "romrun/online/online.h"

typedef struct fmu_request {
    const char *model;       // file
    const part_sizes *sizes; // of it; 0: all
    const scene *given;
    double accuracy; // above which an indicated deviation is not trusted
    int fmi;         // 2 or 3
} fmu_request;

/* Writes caller->output. The FMU's contact is started before, so that one that cannot be solved is not
 * exported: EHD_NOT_CONVERGED. Also EHD_DATA: a scene without SI units; EHD_NOINPUT: the shared
 * object or the model is missing; and as package_write. Not to be trusted at its start is a note. */
ehd_status fmu_export(const program *caller, const fmu_request *request, ehd_error *error);

#endif
