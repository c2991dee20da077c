/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Keeps HDF5 out of programs that open only flat models. A table points to the functions of
 * common/artefact that read HDF5 models. The table is loaded when the first such model is opened
 * (hdf5_calls.c). libehdrom.so.0 takes the table from libehdrom-hdf5.so.0 (hdf5_load.c,
 * hdf5_plugin.c). FMUs have no table (romrun/fmu/no_hdf5.c). Programs and libehdrom.a call
 * common/artefact directly. */
#ifndef EHD_LIBRARY_HDF5_CALLS_H
#define EHD_LIBRARY_HDF5_CALLS_H

#include "common/artefact/artefact.h"

#define HDF5_CALLS(CALL)                                                                           \
    CALL(artefact_visit)                                                                           \
    CALL(artefact_leave)                                                                           \
    CALL(artefact_open)                                                                            \
    CALL(artefact_close)                                                                           \
    CALL(artefact_path)                                                                            \
    CALL(artefact_has)                                                                             \
    CALL(artefact_length)                                                                          \
    CALL(artefact_get)                                                                             \
    CALL(artefact_get_integers)                                                                    \
    CALL(artefact_get_integer)                                                                     \
    CALL(artefact_get_real)                                                                        \
    CALL(artefact_get_text)

#define HDF5_MEMBER(name) __typeof__(name) *name;
typedef struct hdf5_calls {
    size_t size;         // sizeof(hdf5_calls)
    const char *version; // version of the library that the table belongs to
    HDF5_CALLS(HDF5_MEMBER)
} hdf5_calls;
#undef HDF5_MEMBER

#define HDF5_PLUGIN "libehdrom-hdf5.so.0"
#define HDF5_TABLE  "ehdrom_hdf5" // only name that the plug-in exports

/* Finds the table. Only one thread at a time may call this function. EHD_DATA: there is no table.
 * `path`: path of the model, for the message. */
ehd_status hdf5_load(const hdf5_calls **calls, const char *path, ehd_error *error);

#endif
