/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The shared object of FMUs has no HDF5: its model is a flat file. */
#include "romrun/library/hdf5_calls.h"

ehd_status hdf5_load(const hdf5_calls **calls, const char *path, ehd_error *error) {
    *calls = NULL;
    return ehd_fail(error, EHD_DATA, "%s: found no flat model, expected one of romrun export",
                    path);
}
