/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The functions of FMI 2.0, implemented with instance.h. */
#include "romrun/fmu/fmi2.h"

#include "romrun/fmu/instance.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The instance and its logger. */
typedef struct component {
    fmu_instance *contact;
    fmi2CallbackLogger logger;
    fmi2ComponentEnvironment environment;
    char name[128];
} component;

static const fmi2Status statuses[] = {
    [FMU_DONE] = fmi2OK, [FMU_DISCARDED] = fmi2Discard, [FMU_FAILED] = fmi2Error};

static fmi2Status outcome(bool good) {
    return good ? fmi2OK : fmi2Error;
}

static fmu_instance *contact_of(fmi2Component c) {
    return ((component *)c)->contact;
}

static fmi2Status refuse(fmi2Component c, const char *function) {
    return outcome(fmu_refuse(contact_of(c), function));
}

const char *fmi2GetTypesPlatform(void) {
    return "default";
}

const char *fmi2GetVersion(void) {
    return "2.0";
}

// ---- creation

static void show(void *to, fmu_outcome of, const char *text) {
    const component *self = to;

    if (self->logger)
        self->logger(self->environment, self->name, statuses[of], fmu_categories[of], "%s", text);
}

static int digit_of(char c) {
    static const char digits[] = "0123456789abcdef";
    const char *found = c ? strchr(digits, c | 0x20) : NULL;

    return found ? (int)(found - digits) : -1;
}

/* Finds the folder of a file URI (RFC 8089): "file:///a%20b", "file:/a", or without scheme. */
static bool folder_of(char folder[PATH_MAX], const char *uri) {
    size_t length = 0;

    if (!uri) return false;
    if (strncmp(uri, "file:", 5) == 0) {
        uri += 5;
        if (strncmp(uri, "//", 2) == 0) uri = strchr(uri + 2, '/');
    }
    for (; uri && *uri && length < PATH_MAX - 1; uri++) {
        const bool coded = uri[0] == '%' && digit_of(uri[1]) >= 0 && digit_of(uri[2]) >= 0;
        folder[length++] = coded ? (char)(16 * digit_of(uri[1]) + digit_of(uri[2])) : *uri;
        if (coded) uri += 2;
    }
    folder[length] = '\0';
    return length > 0 && !*uri;
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible,
                              fmi2Boolean logging) {
    char folder[PATH_MAX];
    component *self = calloc(1, sizeof *self);

    (void)visible; // there is no window to show
    if (!self) return NULL;
    if (functions) {
        self->logger = functions->logger;
        self->environment = functions->componentEnvironment;
    }
    snprintf(self->name, sizeof self->name, "%s", name ? name : "");
    if (type != fmi2CoSimulation)
        show(self, FMU_FAILED, "type: found model exchange, expected co-simulation");
    else if (!folder_of(folder, resources))
        show(self, FMU_FAILED, "resources: found no folder, expected the URI of one");
    else
        self->contact = fmu_create(guid, folder, show, self);
    if (!self->contact) {
        free(self);
        return NULL;
    }
    fmu_set_verbose(self->contact, logging != fmi2False);
    return self;
}

void fmi2FreeInstance(fmi2Component c) {
    if (c) fmu_free(contact_of(c));
    free(c);
}

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t num_categories,
                               const fmi2String categories[]) {
    (void)num_categories; // the categories have no effect; errors are always logged
    (void)categories;
    fmu_set_verbose(contact_of(c), on != fmi2False);
    return fmi2OK;
}

// ---- modes

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance,
                               fmi2Real start, fmi2Boolean has_stop, fmi2Real stop) {
    return outcome(
        fmu_setup(contact_of(c), start, has_stop ? stop : INFINITY, has_tolerance ? tolerance : 0));
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    return outcome(fmu_enter_initialization(contact_of(c)));
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    return outcome(fmu_exit_initialization(contact_of(c)));
}

fmi2Status fmi2Terminate(fmi2Component c) {
    return outcome(fmu_terminate(contact_of(c)));
}

fmi2Status fmi2Reset(fmi2Component c) {
    return outcome(fmu_reset(contact_of(c)));
}

// ---- variables

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference refs[], size_t num,
                       fmi2Real values[]) {
    bool good = true;

    for (size_t i = 0; i < num && good; i++)
        good = fmu_get(contact_of(c), refs[i], FMU_REAL, &values[i]);
    return outcome(good);
}

static bool get_whole(fmi2Component c, const fmi2ValueReference refs[], size_t num, fmu_type type,
                      int values[]) {
    bool good = true;
    double value = 0;

    for (size_t i = 0; i < num && good; i++) {
        good = fmu_get(contact_of(c), refs[i], type, &value);
        values[i] = (int)value;
    }
    return good;
}

fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference refs[], size_t num,
                          fmi2Integer values[]) {
    return outcome(get_whole(c, refs, num, FMU_INTEGER, values));
}

fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference refs[], size_t num,
                          fmi2Boolean values[]) {
    return outcome(get_whole(c, refs, num, FMU_BOOLEAN, values));
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference refs[], size_t num,
                       const fmi2Real values[]) {
    bool good = true;

    for (size_t i = 0; i < num && good; i++)
        good = fmu_set(contact_of(c), refs[i], FMU_REAL, values[i]);
    return outcome(good);
}

static bool set_whole(fmi2Component c, const fmi2ValueReference refs[], size_t num, fmu_type type,
                      const int values[]) {
    bool good = true;

    for (size_t i = 0; i < num && good; i++)
        good = fmu_set(contact_of(c), refs[i], type, values[i]);
    return good;
}

fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference refs[], size_t num,
                          const fmi2Integer values[]) {
    return outcome(set_whole(c, refs, num, FMU_INTEGER, values));
}

fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference refs[], size_t num,
                          const fmi2Boolean values[]) {
    return outcome(set_whole(c, refs, num, FMU_BOOLEAN, values));
}

// ---- states

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state) {
    return outcome(fmu_state_get(contact_of(c), state));
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
    return outcome(fmu_state_set(contact_of(c), state));
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state) {
    (void)c;
    free(*state);
    *state = NULL;
    return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size) {
    (void)c;
    *size = fmu_state_size(state);
    return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[],
                                 size_t size) {
    return outcome(fmu_state_write(contact_of(c), state, bytes, size));
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size,
                                   fmi2FMUstate *state) {
    return outcome(fmu_state_read(contact_of(c), state, bytes, size));
}

// ---- steps

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean no_state_before) {
    (void)no_state_before;
    return statuses[fmu_step(contact_of(c), time, step)];
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknowns[],
                                        size_t num_unknowns, const fmi2ValueReference knowns[],
                                        size_t num_knowns, const fmi2Real direction[],
                                        fmi2Real derivative[]) {
    const fmu_direction of = {unknowns, knowns, num_unknowns, num_knowns, direction};

    return outcome(fmu_derivative(contact_of(c), &of, derivative));
}

/* Returns the time of the last successful step. Other kinds of status do not apply, because a step
 * is complete when its call returns. */
fmi2Status fmi2GetRealStatus(fmi2Component c, fmi2StatusKind kind, fmi2Real *value) {
    if (kind != fmi2LastSuccessfulTime) return refuse(c, __func__);
    *value = fmu_time(contact_of(c));
    return fmi2OK;
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, fmi2StatusKind kind, fmi2Boolean *value) {
    if (kind != fmi2Terminated) return refuse(c, __func__);
    *value = fmi2False;
    return fmi2OK;
}

// ---- not offered

#pragma GCC diagnostic ignored "-Wunused-parameter"

#define REFUSE(name, arguments)                                                                    \
    fmi2Status name arguments {                                                                    \
        return refuse(c, __func__);                                                                \
    }

FMI2_NOT_OFFERED(REFUSE)
