/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/output/check.h"

#include "common/output/grid_file.h"
#include "common/output/result.h"
#include "common/output/time_result.h"

/* Reads the kind of contact and the number of points in time, which read_result needs. */
static ehd_status look_at_result(const contact_kind **kind, size_t *num_times, artefact *file,
                                 ehd_error *error) {
    *num_times = artefact_length(file, "time");
    return contact_kind_read(kind, file, error);
}

static ehd_status read_result(const char *path, const contact_kind *kind, size_t num_times,
                              ehd_error *error) {
    ehd_status status;

    if (num_times == 1) {
        stored_result result;
        status = result_read(&result, path, kind, true, error);
        result_free(&result);
    } else {
        time_series series;
        status = time_series_read(&series, path, kind, error);
        time_series_free(&series);
    }
    return status;
}

static ehd_status read_grid(artefact *file, ehd_error *error) {
    const contact_kind *kind;
    ehd_carriage carriage;
    ehd_grid grid;
    ehd_status status = grid_read(&grid, &kind, file, error);

    return status || artefact_kind(file) == &schema_residuals
               ? status
               : carriage_read(&carriage, file, error);
}

static ehd_status read_with(const output_reader *readers, const artefact_schema *kind,
                            const char *path, ehd_error *error) {
    for (; readers && readers->kind; readers++)
        if (readers->kind == kind) return readers->read(path, error);
    return EHD_OK;
}

/* Reads a file in the same way as the programs that take it as input. */
static ehd_status read_as_input(const output_reader *readers, const char *path, ehd_error *error) {
    const contact_kind *contact = NULL;
    const artefact_schema *kind = NULL;
    size_t num_times = 0;
    artefact *file = NULL;
    ehd_status status = artefact_open(&file, path, artefact_schemas, error);

    if (!status) kind = artefact_kind(file);
    if (!status)
        status = kind == &schema_result  ? look_at_result(&contact, &num_times, file, error)
                 : kind == &schema_cases ? EHD_OK
                                         : read_grid(file, error);
    artefact_close(&file);
    if (status) return status;
    return kind == &schema_result ? read_result(path, contact, num_times, error)
                                  : read_with(readers, kind, path, error);
}

ehd_status output_check(const char *path, const output_reader *readers, ehd_error *error) {
    const ehd_status status = artefact_check(path, error);

    return status ? status : read_as_input(readers, path, error);
}
