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

/* Reads everything in a model file, including the modes for steps in time if the file has them. */
static ehd_status check_parts(artefact *file, ehd_error *error) {
    reduced_model model;
    trade_table table;
    double *pressure = NULL, *deformation = NULL;
    bool calibrated;
    ehd_status status = model_get(&model, file, NULL, error);
    if (status) return status;

    status = model_get_modes(&pressure, model_has_modes(file, &model) ? &deformation : NULL, file,
                             &model, error);
    free(pressure);
    free(deformation);
    reduced_model_free(&model);
    if (status) return status;
    status = trade_get(&table, &calibrated, file, error);
    if (!status) trade_free(&table);
    return status;
}

ehd_status model_check(const char *path, ehd_error *error) {
    artefact *file = NULL;
    ehd_status status = model_open(&file, path, error);

    if (!status) status = check_parts(file, error);
    artefact_close(&file);
    return status;
}

const output_reader model_readers[] = {
    {&schema_basis, basis_check}, {&schema_model, model_check}, {0}};
