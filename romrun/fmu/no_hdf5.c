/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Replaces hdf5_load.c in the shared object of FMUs. This shared object has no HDF5, because the
 * model of an FMU is a flat file. */
#include "romrun/library/hdf5_calls.h"

ehd_status hdf5_load(const hdf5_calls **calls, const char *path, ehd_error *error) {
    *calls = NULL;
    return ehd_fail(error, EHD_DATA, "%s: found no flat model, expected one of romrun export",
                    path);
}
