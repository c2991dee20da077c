/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Defines the table of HDF5 functions. It is the only name that libehdrom-hdf5.so.0 exports; the
 * plug-in consists of common/artefact and this file. */
#include "romrun/library/ehdrom.h"
#include "romrun/library/hdf5_calls.h"

#define GIVEN(name) .name = name,

EHDROM_API extern const hdf5_calls ehdrom_hdf5; // the name in HDF5_TABLE
const hdf5_calls ehdrom_hdf5 = {
    .size = sizeof(hdf5_calls), .version = EHDROM_VERSION, HDF5_CALLS(GIVEN)};
