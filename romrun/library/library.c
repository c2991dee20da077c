/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Opens and describes models. Also has the functions that all calls of the library need. */
#include "romrun/library/internal.h"

#include "common/artefact/artefact.h"
#include "common/output/grid_file.h"
#include "common/program/processor.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

_Static_assert((int)EHDROM_OK == (int)EHD_OK, "status");
_Static_assert((int)EHDROM_NOT_CONVERGED == (int)EHD_NOT_CONVERGED, "status");
_Static_assert((int)EHDROM_UNTRUSTED == (int)EHD_UNTRUSTED, "status");
_Static_assert((int)EHDROM_DATA == (int)EHD_DATA, "status");
_Static_assert((int)EHDROM_NOINPUT == (int)EHD_NOINPUT, "status");
_Static_assert((int)EHDROM_INTERNAL == (int)EHD_INTERNAL, "status");
_Static_assert((int)EHDROM_MEMORY == (int)EHD_MEMORY, "status");
_Static_assert((int)EHDROM_IO == (int)EHD_IO, "status");

const char *ehdrom_version(void) {
    return EHDROM_VERSION;
}

// ---- for all calls

locale_t library_enter(void) {
    // this locale is built into glibc and takes no memory
    return uselocale(newlocale(LC_ALL_MASK, "C", (locale_t)0));
}

void library_leave(locale_t before) {
    uselocale(before);
}

static pthread_mutex_t one_at_a_time = PTHREAD_MUTEX_INITIALIZER;
static artefact_guest host;

void library_lock(void) {
    pthread_mutex_lock(&one_at_a_time);
    host = artefact_visit();
}

void library_unlock(void) {
    artefact_leave(&host);
    pthread_mutex_unlock(&one_at_a_time);
}

ehd_status library_give(void *target, const void *source, size_t size, const char *what,
                        ehd_error *error) {
    size_t given = 0;

    if (target) memcpy(&given, target, sizeof given);
    if (given < 2 * sizeof(size_t))
        return ehd_fail(error, EHD_DATA, "%s: found %s, expected one begun by its INIT", what,
                        target ? "a struct without its size" : "NULL");
    const size_t both = given < size ? given : size;
    memcpy((char *)target + sizeof given, (const char *)source + sizeof given, both - sizeof given);
    return EHD_OK;
}

// ---- models

/* Copies the options that the caller's struct contains. The other options are 0. */
static ehd_status take_options(ehdrom_model_options *own, const ehdrom_model_options *given,
                               ehd_error *error) {
    *own = (ehdrom_model_options)EHDROM_MODEL_OPTIONS_INIT;
    if (!given) return EHD_OK;
    if (given->size < 2 * sizeof(size_t))
        return ehd_fail(error, EHD_DATA,
                        "options: found a struct without its size, expected one begun by its INIT");
    memcpy(own, given, given->size < sizeof *own ? given->size : sizeof *own);
    return EHD_OK;
}

static ehd_status open_model(ehdrom_model *self, const char *path,
                             const ehdrom_model_options *given, ehd_error *error) {
    ehdrom_model_options options;
    ehd_status status = take_options(&options, given, error);

    if (!status && !path)
        status = ehd_fail(error, EHD_NOINPUT, "path: found NULL, expected a file");
    if (status) return status;
    const part_sizes sizes = {{{options.pressure_modes, options.deformation_modes, options.rows}}};
    if (part_list_is(path) && (options.pressure_modes || options.deformation_modes || options.rows))
        return ehd_fail(error, EHD_DATA,
                        "%s: found a list of models with sizes in the options, expected one model",
                        path);
    bool flat = false; // flat models use neither HDF5 nor FFTW
    status = online_is_flat(&flat, path, error);
    if (status) return status;
    if (!flat) library_lock();
    status = online_open(&self->online, path, &sizes, error);
    const bool stationary =
        !status && (options.stationary || online_check_in_time(self->online, NULL));
    if (stationary) {
        status = online_prepare_fields(self->online, error);
    } else if (!status) {
        status = online_prepare_transient(self->online, error);
        self->in_time = !status;
    }
    if (self->online) online_release_file(self->online);
    if (!flat) library_unlock();
    if (status) self->online = online_close(self->online);
    return status;
}

static ehdrom_status make_model(ehdrom_model **model, const char *path,
                                const ehdrom_model_options *options) {
    const locale_t before = library_enter();
    ehdrom_model *self = calloc(1, sizeof *self);
    ehd_status status = self ? open_model(self, path, options, &self->error) : EHD_MEMORY;

    *model = self;
    library_leave(before);
    return (ehdrom_status)status;
}

/* Opens a model. Checks the processor, since this is the first call of every program. */
ON_ANY_PROCESSOR ehdrom_status ehdrom_model_open(ehdrom_model **model, const char *path,
                                                 const ehdrom_model_options *options) {
    *model = NULL;
    return processor_refusal() ? EHDROM_INTERNAL : make_model(model, path, options);
}

void ehdrom_model_close(ehdrom_model *self) {
    if (!self) return;
    online_close(self->online);
    free(self);
}

ON_ANY_PROCESSOR const char *ehdrom_model_error(const ehdrom_model *self) {
    const char *refusal = processor_refusal();

    if (refusal) return refusal;
    return self ? self->error.text : "model: out of memory";
}

ehdrom_status ehdrom_model_describe(const ehdrom_model *self, ehdrom_model_info *info) {
    if (!self || !self->online) return EHDROM_INTERNAL;
    const online_properties properties = online_describe(self->online);
    const ehd_grid whole = grid_whole(online_grid(self->online));
    const ehdrom_model_info own = {.dimensions = online_kind(self->online)->dimensions,
                                   .num_x = whole.inner_x,
                                   .num_y = whole.inner_lines,
                                   .x_min = grid_x(&whole, grid_node_of_row(&whole, 0)),
                                   .y_min = grid_y(&whole, grid_node_of_row(&whole, 0)),
                                   .step = whole.step,
                                   .pressure_modes = properties.pressure_modes,
                                   .deformation_modes = properties.deformation_modes,
                                   .unknowns = properties.unknowns,
                                   .rows = properties.rows,
                                   .states = properties.states,
                                   .checked = properties.checked,
                                   .checked_in_time = properties.checked_in_time,
                                   .in_time = self->in_time,
                                   .ellipticity = online_grid(self->online)->shape.ellipticity,
                                   .parts = properties.parts};

    return (ehdrom_status)library_give(info, &own, sizeof own, "info", NULL);
}
