/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/artefact/table.h"

#include "common/artefact/internal.h"
#include "common/program/text.h"

#include <stdlib.h>
#include <unistd.h>

/* Entries of a dataset of numbers along one axis; negative for any other. */
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

static ehd_status read_entries(double **values, size_t *count, hid_t dataset, const char *path,
                               const char *name, ehd_error *error) {
    const hssize_t found = count_entries(dataset);

    if (found < 0)
        return ehd_fail(error, EHD_DATA,
                        "%s: %s: found something else, expected numbers along one axis", path,
                        name);
    *count = (size_t)found;
    *values = malloc((*count + 1) * sizeof **values); // none are no failure
    if (!*values)
        return ehd_fail(error, EHD_MEMORY, "%s: %s: found no memory for %zu numbers", path, name,
                        *count);
    if (H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, *values) >= 0)
        return EHD_OK;
    const hdf5_reason reason = hdf5_last_reason();
    return ehd_fail(error, reason.system ? EHD_IO : EHD_DATA,
                    "%s: %s: found a read failure (%s), expected whole data", path, name,
                    reason.text);
}

static ehd_status read_dataset(double **values, size_t *count, hid_t file, const char *path,
                               const char *name, ehd_error *error) {
    char shown[SHOWN_TEXT];
    const hid_t dataset = H5Dopen2(file, name, H5P_DEFAULT);

    text_show(shown, name);
    if (dataset < 0)
        return ehd_fail(error, EHD_DATA, "%s: found no dataset %s, expected one", path, shown);
    const ehd_status status = read_entries(values, count, dataset, path, shown, error);
    hdf5_release(dataset);
    return status;
}

static ehd_status open_table(hid_t *file, const char *path, ehd_error *error) {
    if (access(path, R_OK) != 0)
        return ehd_fail(error, EHD_NOINPUT, "%s: found no readable file, expected an HDF5 file",
                        path);
    *file = hdf5_open(path, H5F_ACC_RDONLY, false);
    if (*file >= 0) return EHD_OK;
    const hdf5_reason reason = hdf5_last_reason();
    return ehd_fail(error, reason.system ? EHD_IO : EHD_DATA,
                    "%s: found no whole HDF5 file (%s), expected one", path, reason.text);
}

ehd_status artefact_read_table(const char *path, const char *column, double **time, double **values,
                               size_t *count, ehd_error *error) {
    hid_t file = -1;
    size_t num_values = 0;

    *time = *values = NULL;
    *count = 0;
    hdf5_start();
    ehd_status status = open_table(&file, path, error);
    if (!status) status = read_dataset(time, count, file, path, "time", error);
    if (!status) status = read_dataset(values, &num_values, file, path, column, error);
    if (!status && num_values != *count)
        status = ehd_fail(error, EHD_DATA, "%s: %s: found %zu numbers, expected %zu as of time",
                          path, column, num_values, *count);
    if (status) {
        free(*time);
        free(*values);
        *time = *values = NULL;
    }
    hdf5_release(file);
    return status;
}
