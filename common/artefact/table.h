/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads tables of numbers from other programs, such as a multibody program or a script. table_read
 * reads all tables of histories, of surfaces and of selected rows. */
#ifndef EHD_ARTEFACT_TABLE_H
#define EHD_ARTEFACT_TABLE_H

#include "common/program/status.h"
#include "common/settings/csv.h"
#include <stdbool.h>
#include <stddef.h>

/* Checks whether a file of this name is read as HDF5: it ends with .h5 or .hdf5. */
bool artefact_is_table(const char *path);

/* Reads columns by their names. The ending of the file's name decides whether the file is read as
 * HDF5 or CSV. HDF5: a column is a dataset of numbers along one axis, and all columns have the same
 * length. If a column has several possible names, the first name that the file has is used. CSV: as
 * csv_read_table. EHD_NOINPUT: no such file. EHD_DATA: the file is no such table, or lacks a
 * column; the error text lists the columns that the file has. EHD_IO, EHD_MEMORY. */
ehd_status table_read(
    // input:
    const char *path,
    // in and out:
    table_column *columns, size_t num_columns,
    // output:
    size_t *count, ehd_error *error);

#endif
