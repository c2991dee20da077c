/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libehdrom-hdf5.so.0: common/artefact and this table, the only name that it exports. */
#include "romrun/library/ehdrom.h"
#include "romrun/library/hdf5_calls.h"

#define GIVEN(name) .name = name,

EHDROM_API extern const hdf5_calls ehdrom_hdf5; // HDF5_TABLE
const hdf5_calls ehdrom_hdf5 = {
    .size = sizeof(hdf5_calls), .version = EHDROM_VERSION, HDF5_CALLS(GIVEN)};
