/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A column over time from any HDF5 file, such as a multibody program writes. */
#ifndef EHD_ARTEFACT_TABLE_H
#define EHD_ARTEFACT_TABLE_H

#include "common/program/status.h"
#include <stddef.h>

/* Reads the datasets `time` and `column`, both of one axis, of equal length and of numbers, which are
 * not looked at. EHD_NOINPUT: no such file; EHD_DATA: no HDF5, or a dataset missing, damaged or of
 * another kind; EHD_IO; EHD_MEMORY. */
ehd_status artefact_read_table(
    // input:
    const char *path, const char *column,
    // output:
    double **time,   // [count], as `values`; free with free()
    double **values, // NULL both after a failure
    size_t *count, ehd_error *error);

#endif
