/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/artefact/table.h"

#include "common/artefact/internal.h"
#include "common/program/text.h"

#include <stdlib.h>
#include <string.h>

/* Largest number of rows, enough for the load history of a contact over months. */
enum { TABLE_MAX_ROWS = 100000000 };

enum { LISTED_NAMES = 20 }; // largest number of dataset names in a message

static ehd_status status_of(const hdf5_reason *reason) {
    if (reason->memory) return EHD_MEMORY;
    return reason->system ? EHD_IO : EHD_DATA;
}

/* Returns the number of entries of a dataset that holds numbers along one axis, and a negative
 * number for other datasets. */
static hssize_t count_entries(hid_t dataset) {
    const hid_t type = H5Dget_type(dataset), space = H5Dget_space(dataset);
    const H5T_class_t class = H5Tget_class(type);
    hssize_t count = -1;

    if ((class == H5T_FLOAT || class == H5T_INTEGER) && H5Sget_simple_extent_ndims(space) == 1)
        count = H5Sget_simple_extent_npoints(space);
    hdf5_release(space);
    hdf5_release(type);
    return count;
}

static ehd_status read_values(double **values, size_t *count, hid_t dataset, const char *path,
                              const char *name, ehd_error *error) {
    const hssize_t found = count_entries(dataset);

    if (found < 0)
        return ehd_fail(error, EHD_DATA,
                        "%s: %s: found something else, expected numbers along one axis", path,
                        name);
    *count = (size_t)found;
    if ((size_t)found > TABLE_MAX_ROWS)
        return ehd_fail(error, EHD_DATA, "%s: %s: found %zu numbers, expected at most %d", path,
                        name, (size_t)found, TABLE_MAX_ROWS);
    const ehd_status status = check_stored(path, (double)found, error);
    if (status) return status;
    *values = array_new(*count, 1, sizeof **values);
    if (!*values) return ehd_no_memory(error, path);
    if (H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, *values) >= 0)
        return EHD_OK;
    const hdf5_reason reason = hdf5_last_reason();
    return ehd_fail(error, status_of(&reason),
                    "%s: %s: found a read failure (%s), expected whole data", path, name,
                    reason.text);
}

/* Returns the first of the names that is a dataset of the file, or "" if none of them is. */
static const char *find_name(hid_t file, const char *const *names) {
    while (*names && !hdf5_has_dataset(file, *names))
        names++;
    return *names ? *names : "";
}

static ehd_status fail_missing(const table_column *column, hid_t file, const char *path,
                               ehd_error *error) {
    char shown[SHOWN_TEXT], names[LISTED_NAMES][SHOWN_TEXT], all[NAMES_TEXT];
    char *listed[LISTED_NAMES];
    H5G_info_t root = {0};
    size_t count = 0;

    H5Gget_info(file, &root);
    for (; count < LISTED_NAMES && count < root.nlinks; count++) {
        listed[count] = names[count];
        if (H5Lget_name_by_idx(file, ".", H5_INDEX_NAME, H5_ITER_INC, count, names[count],
                               SHOWN_TEXT, H5P_DEFAULT) < 0)
            break;
    }
    table_show_names(shown, column->names);
    table_show_columns(all, listed, count);
    return ehd_fail(error, EHD_DATA, "%s: found no dataset %s among %s, expected one", path, shown,
                    count > 0 ? all : "none");
}

static ehd_status read_column(table_column *column, size_t *count, hid_t file, const char *path,
                              ehd_error *error) {
    char shown[SHOWN_TEXT];
    const char *name = find_name(file, column->names);
    own_dataset about;

    if (!*name && column->optional) return EHD_OK;
    if (!*name) return fail_missing(column, file, path, error);
    text_show(shown, name);
    const hid_t dataset = hdf5_open_own(&about, file, name);
    if (about.foreign) return hdf5_refuse(path, name, about.foreign, error);
    if (dataset < 0)
        return ehd_fail(error, EHD_DATA, "%s: found no dataset %s, expected one", path, shown);
    const ehd_status status = read_values(&column->values, count, dataset, path, shown, error);
    hdf5_release(dataset);
    return status;
}

static ehd_status open_table(hid_t *file, const char *path, ehd_error *error) {
    const ehd_status status = check_readable(path, error);
    if (status) return status;
    *file = hdf5_open(path, H5F_ACC_RDONLY, false);
    if (*file >= 0) return EHD_OK;
    const hdf5_reason reason = hdf5_last_reason();
    return ehd_fail(error, status_of(&reason), "%s: found no whole HDF5 file (%s), expected one",
                    path, reason.text);
}

static ehd_status read_hdf5(const char *path, table_column *columns, size_t num_columns,
                            size_t *count, ehd_error *error) {
    hid_t file = -1;

    *count = 0;
    for (size_t c = 0; c < num_columns; c++)
        columns[c].values = NULL;
    for (size_t c = 0; c < num_columns; c++)
        *columns[c].unit = '\0';
    hdf5_start();
    ehd_status status = open_table(&file, path, error);
    for (size_t c = 0; c < num_columns && !status; c++) {
        size_t found = *count;
        status = read_column(&columns[c], &found, file, path, error);
        if (!status && c > 0 && found != *count)
            status = ehd_fail(error, EHD_DATA, "%s: %s: found %zu numbers, expected %zu as of %s",
                              path, find_name(file, columns[c].names), found, *count,
                              find_name(file, columns[0].names));
        if (c == 0) *count = found;
    }
    for (size_t c = 0; c < num_columns && status; c++) {
        free(columns[c].values);
        columns[c].values = NULL;
    }
    hdf5_release(file);
    return status;
}

ehd_status table_read(const char *path, table_column *columns, size_t num_columns, size_t *count,
                      ehd_error *error) {
    return (artefact_is_table(path) ? read_hdf5 : csv_read_table)(path, columns, num_columns, count,
                                                                  error);
}

bool artefact_is_table(const char *path) {
    const char *ending = strrchr(path, '.');
    return ending && (strcmp(ending, ".h5") == 0 || strcmp(ending, ".hdf5") == 0);
}
