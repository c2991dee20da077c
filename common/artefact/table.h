/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Columns of numbers from any HDF5 file, such as a multibody program or a script writes. */
#ifndef EHD_ARTEFACT_TABLE_H
#define EHD_ARTEFACT_TABLE_H

#include "common/program/status.h"
#include "common/settings/csv.h"
#include <stdbool.h>
#include <stddef.h>

/* Whether a file of this name is read as HDF5: it ends with .h5 or .hdf5. */
bool artefact_is_table(const char *path);

/* Reads datasets of numbers along one axis, all of equal length; what the numbers are is not looked
 * at. EHD_NOINPUT: no such file; EHD_DATA: no HDF5, or a dataset missing, damaged or of another
 * kind; EHD_IO; EHD_MEMORY. */
ehd_status artefact_read_table(
    // input:
    const char *path,
    // in and out:
    table_column *columns, size_t num_columns, // each with names
    // output:
    size_t *count, ehd_error *error);

#endif
