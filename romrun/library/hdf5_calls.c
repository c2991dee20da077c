/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Replaces common/artefact in the library: each function calls the function of the same name in the
 * table of hdf5_calls.h. Only one thread at a time may call these functions (library_lock). Before
 * artefact_open has found the table, only artefact_visit, artefact_leave and artefact_close may be
 * called. */
#include "romrun/library/hdf5_calls.h"

static const hdf5_calls *calls; // NULL: the calls were not needed yet, or HDF5 is missing

static ehd_status find_calls(const char *path, ehd_error *error) {
    return calls ? EHD_OK : hdf5_load(&calls, path, error);
}

/* A missing table is not reported here, because artefact_open, which is called next, reports it. */
artefact_guest artefact_visit(void) {
    const artefact_guest none = {0};

    return find_calls("", NULL) ? none : calls->artefact_visit();
}

void artefact_leave(const artefact_guest *host) {
    if (calls) calls->artefact_leave(host);
}

ehd_status artefact_open(artefact **file, const char *path, const artefact_schema *const *schemas,
                         ehd_error *error) {
    const ehd_status status = find_calls(path, error);

    *file = NULL;
    return status ? status : calls->artefact_open(file, path, schemas, error);
}

void artefact_close(artefact **file) {
    if (*file) calls->artefact_close(file);
}

const char *artefact_path(const artefact *file) {
    return calls->artefact_path(file);
}

bool artefact_has(const artefact *file, const char *name) {
    return calls->artefact_has(file, name);
}

size_t artefact_length(const artefact *file, const char *axis) {
    return calls->artefact_length(file, axis);
}

ehd_status artefact_get(artefact *file, const char *field, double *data, size_t room,
                        ehd_error *error) {
    return calls->artefact_get(file, field, data, room, error);
}

ehd_status artefact_get_integers(artefact *file, const char *field, int64_t *data, size_t room,
                                 ehd_error *error) {
    return calls->artefact_get_integers(file, field, data, room, error);
}

ehd_status artefact_get_integer(artefact *file, const char *attribute, int64_t *value,
                                ehd_error *error) {
    return calls->artefact_get_integer(file, attribute, value, error);
}

ehd_status artefact_get_real(artefact *file, const char *attribute, double *value,
                             ehd_error *error) {
    return calls->artefact_get_real(file, attribute, value, error);
}

ehd_status artefact_get_text(artefact *file, const char *attribute, char **text, ehd_error *error) {
    return calls->artefact_get_text(file, attribute, text, error);
}
