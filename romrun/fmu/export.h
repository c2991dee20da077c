/* SPDX-License-Identifier: GPL-3.0-or-later */
/* romrun fmu: writes an FMU of a scene and a model. */
#ifndef EHD_FMU_EXPORT_H
#define EHD_FMU_EXPORT_H

#include "common/program/program.h"
#include "common/settings/scene.h"
#include "romrun/online/online.h"

typedef struct fmu_request {
    const char *model;       // path of the model
    const part_sizes *sizes; // sizes of the model; 0: all modes or rows
    const scene *given;
    double accuracy; // a result with a larger error estimate is not trusted
    int fmi;         // version of FMI, 2 or 3
} fmu_request;

/* Writes caller->output. Before writing, starts the FMU's contact and takes one step; if this
 * fails, writes nothing and returns EHD_NOT_CONVERGED. EHD_DATA: a scene without SI units;
 * EHD_NOINPUT: the shared object or the model is missing; and the errors of package_write. If the
 * start is not trusted, the program only prints a note. */
ehd_status fmu_export(const program *caller, const fmu_request *request, ehd_error *error);

#endif
