/* SPDX-License-Identifier: GPL-3.0-or-later */
/* In the place of HDF5, of common/artefact and of model_read.c, in the shared object of FMUs: the model there is a
 * flat file, and what is no flat file is refused before anything else here is called. */
#include "common/artefact/artefact.h"
#include "romrun/model/model_file.h"

ehd_status model_open(artefact **file, const char *path, ehd_error *error) {
    *file = NULL;
    return ehd_fail(error, EHD_DATA, "%s: found no flat model, expected one of romrun --export",
                    path);
}

static ehd_status refuse(ehd_error *error) {
    return ehd_fail(error, EHD_INTERNAL, "HDF5: found it called for, expected a flat model");
}

ehd_status model_get(reduced_model *model, artefact *file, const model_sizes *sizes,
                     ehd_error *error) {
    (void)model, (void)file, (void)sizes;
    return refuse(error);
}

ehd_status model_get_modes(double **pressure_basis, double **deformation_basis, artefact *file,
                           const reduced_model *model, ehd_error *error) {
    (void)pressure_basis, (void)deformation_basis, (void)file, (void)model;
    return refuse(error);
}

bool model_has_modes(const artefact *file, const reduced_model *model) {
    (void)file, (void)model;
    return false;
}

const artefact_schema schema_model;

ehd_status artefact_open(artefact **file, const char *path, const artefact_schema *const *schemas,
                         ehd_error *error) {
    (void)path, (void)schemas;
    *file = NULL;
    return refuse(error);
}

void artefact_close(artefact **file) {
    *file = NULL;
}

artefact_guest artefact_visit(void) {
    return (artefact_guest){0};
}

void artefact_leave(const artefact_guest *host) {
    (void)host;
}

const char *artefact_path(const artefact *file) {
    (void)file;
    return "";
}

bool artefact_has(const artefact *file, const char *name) {
    (void)file, (void)name;
    return false;
}

size_t artefact_length(const artefact *file, const char *axis) {
    (void)file, (void)axis;
    return 0;
}

ehd_status artefact_get(artefact *file, const char *field, double *data, ehd_error *error) {
    (void)file, (void)field, (void)data;
    return refuse(error);
}

ehd_status artefact_get_integers(artefact *file, const char *field, int64_t *data,
                                 ehd_error *error) {
    (void)file, (void)field, (void)data;
    return refuse(error);
}

ehd_status artefact_get_integer(artefact *file, const char *attribute, int64_t *value,
                                ehd_error *error) {
    (void)file, (void)attribute, (void)value;
    return refuse(error);
}
