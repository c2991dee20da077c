/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/model/readers.h"

#include "romrun/model/basis_file.h"
#include "romrun/model/model_file.h"
#include "romrun/model/trade_file.h"

#include <stdbool.h>
#include <stdlib.h>

ehd_status basis_check(const char *path, ehd_error *error) {
    char identity[65];
    reduced_basis basis;
    const ehd_status status = basis_read(&basis, identity, path, error);

    if (!status) reduced_basis_free(&basis);
    return status;
}

/* Whether the file has what only transient scenes need. */
static ehd_status has_deformation(bool *found, const char *path, ehd_error *error) {
    const artefact_schema *const kinds[] = {&schema_model, NULL};
    artefact *file = NULL;
    const ehd_status status = artefact_open(&file, path, kinds, error);

    *found = !status && artefact_has(file, "deformation_basis");
    artefact_close(&file);
    return status;
}

static ehd_status check_modes(const char *path, const reduced_model *model, ehd_error *error) {
    double *pressure = NULL, *deformation = NULL;
    bool whole = false;
    ehd_status status = has_deformation(&whole, path, error);

    if (!status)
        status = model_read_modes(&pressure, whole ? &deformation : NULL, path, model, error);
    free(pressure);
    free(deformation);
    return status;
}

ehd_status model_check(const char *path, ehd_error *error) {
    reduced_model model;
    trade_table table;
    bool calibrated;
    ehd_status status = model_read(&model, path, NULL, error);

    if (status) return status;
    status = check_modes(path, &model, error);
    reduced_model_free(&model);
    if (status) return status;
    status = trade_read_optional(&table, &calibrated, path, error);
    if (!status) trade_free(&table);
    return status;
}

const output_reader model_readers[] = {
    {&schema_basis, basis_check}, {&schema_model, model_check}, {0}};
