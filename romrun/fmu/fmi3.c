/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The functions of FMI 3.0, implemented with instance.h. */
#include "romrun/fmu/fmi3.h"

#include "romrun/fmu/instance.h"

#include <math.h>
#include <stdlib.h>

/* The instance and its logger. */
typedef struct component {
    fmu_instance *contact;
    fmi3LogMessageCallback log;
    fmi3InstanceEnvironment environment;
} component;

static const fmi3Status statuses[] = {
    [FMU_DONE] = fmi3OK, [FMU_DISCARDED] = fmi3Discard, [FMU_FAILED] = fmi3Error};

static fmi3Status outcome(bool good) {
    return good ? fmi3OK : fmi3Error;
}

static fmu_instance *contact_of(fmi3Instance instance) {
    return ((component *)instance)->contact;
}

static fmi3Status refuse(fmi3Instance instance, const char *function) {
    return outcome(fmu_refuse(contact_of(instance), function));
}

const char *fmi3GetVersion(void) {
    return "3.0";
}

// ---- creation

static void show(void *to, fmu_outcome of, const char *text) {
    const component *self = to;

    if (self->log) self->log(self->environment, statuses[of], fmu_categories[of], text);
}

fmi3Instance
fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources,
                            fmi3Boolean visible, fmi3Boolean logging, fmi3Boolean event_mode,
                            fmi3Boolean early_return, const fmi3ValueReference intermediate[],
                            size_t num_intermediate, fmi3InstanceEnvironment environment,
                            fmi3LogMessageCallback log, fmi3IntermediateUpdateCallback update) {
    component *self = calloc(1, sizeof *self);

    // unused: there is no window, no early return, and no value between communication points
    (void)name, (void)visible, (void)early_return, (void)intermediate, (void)num_intermediate;
    (void)update;
    if (!self) return NULL;
    self->log = log;
    self->environment = environment;
    if (event_mode)
        show(self, FMU_FAILED, "event mode: found used, expected not, as hasEventMode says");
    else if (!resources)
        show(self, FMU_FAILED, "resources: found none, expected the path of their folder");
    else
        self->contact = fmu_create(token, resources, show, self);
    if (!self->contact) {
        free(self);
        return NULL;
    }
    fmu_set_verbose(self->contact, logging);
    return self;
}

void fmi3FreeInstance(fmi3Instance instance) {
    if (instance) fmu_free(contact_of(instance));
    free(instance);
}

fmi3Status fmi3SetDebugLogging(fmi3Instance instance, fmi3Boolean on, size_t num_categories,
                               const fmi3String categories[]) {
    (void)num_categories; // the categories have no effect; errors are always logged
    (void)categories;
    fmu_set_verbose(contact_of(instance), on);
    return fmi3OK;
}

// ---- modes

fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean has_tolerance,
                                       fmi3Float64 tolerance, fmi3Float64 start,
                                       fmi3Boolean has_stop, fmi3Float64 stop) {
    return outcome(fmu_setup(contact_of(instance), start, has_stop ? stop : INFINITY,
                             has_tolerance ? tolerance : 0) &&
                   fmu_enter_initialization(contact_of(instance)));
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance instance) {
    return outcome(fmu_exit_initialization(contact_of(instance)));
}

fmi3Status fmi3Terminate(fmi3Instance instance) {
    return outcome(fmu_terminate(contact_of(instance)));
}

fmi3Status fmi3Reset(fmi3Instance instance) {
    return outcome(fmu_reset(contact_of(instance)));
}

// ---- variables

/* Checks that there are as many values as references, since no variable is an array. */
static bool same_length(fmi3Instance instance, size_t num_refs, size_t num_values) {
    return num_refs == num_values || fmu_refuse(contact_of(instance), "arrays");
}

/* Functions that get and set variables of one type; `kind`: name of the type in instance.h. */
#define VARIABLES_OF(type, kind)                                                                   \
    FMI3_GET(type) {                                                                               \
        double value = 0;                                                                          \
        bool good = same_length(instance, num_refs, num_values);                                   \
                                                                                                   \
        for (size_t i = 0; i < num_refs && good; i++) {                                            \
            good = fmu_get(contact_of(instance), refs[i], kind, &value);                           \
            if (good) values[i] = (fmi3##type)value;                                               \
        }                                                                                          \
        return outcome(good);                                                                      \
    }                                                                                              \
    FMI3_SET(type) {                                                                               \
        bool good = same_length(instance, num_refs, num_values);                                   \
                                                                                                   \
        for (size_t i = 0; i < num_refs && good; i++)                                              \
            good = fmu_set(contact_of(instance), refs[i], kind, values[i]);                        \
        return outcome(good);                                                                      \
    }

VARIABLES_OF(Float64, FMU_REAL)
VARIABLES_OF(Int32, FMU_INTEGER)
VARIABLES_OF(Boolean, FMU_BOOLEAN)

// ---- states

fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState *state) {
    return outcome(fmu_state_get(contact_of(instance), state));
}

fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState state) {
    return outcome(fmu_state_set(contact_of(instance), state));
}

fmi3Status fmi3FreeFMUState(fmi3Instance instance, fmi3FMUState *state) {
    (void)instance;
    free(*state);
    *state = NULL;
    return fmi3OK;
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance instance, fmi3FMUState state, size_t *size) {
    (void)instance;
    *size = fmu_state_size(state);
    return fmi3OK;
}

fmi3Status fmi3SerializeFMUState(fmi3Instance instance, fmi3FMUState state, fmi3Byte bytes[],
                                 size_t size) {
    return outcome(fmu_state_write(contact_of(instance), state, bytes, size));
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance instance, const fmi3Byte bytes[], size_t size,
                                   fmi3FMUState *state) {
    return outcome(fmu_state_read(contact_of(instance), state, bytes, size));
}

// ---- steps

fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 time, fmi3Float64 step,
                      fmi3Boolean no_state_before, fmi3Boolean *event_needed,
                      fmi3Boolean *terminate, fmi3Boolean *early_return, fmi3Float64 *last_time) {
    const fmu_outcome of = fmu_step(contact_of(instance), time, step);

    (void)no_state_before;
    *event_needed = *terminate = *early_return = false;
    *last_time = fmu_time(contact_of(instance));
    return statuses[of];
}

fmi3Status fmi3GetDirectionalDerivative(fmi3Instance instance, const fmi3ValueReference unknowns[],
                                        size_t num_unknowns, const fmi3ValueReference knowns[],
                                        size_t num_knowns, const fmi3Float64 seed[],
                                        size_t num_seed, fmi3Float64 sensitivity[],
                                        size_t num_sensitivity) {
    const fmu_direction of = {unknowns, knowns, num_unknowns, num_knowns, seed};

    return outcome(same_length(instance, num_knowns, num_seed) &&
                   same_length(instance, num_unknowns, num_sensitivity) &&
                   fmu_derivative(contact_of(instance), &of, sensitivity));
}

// ---- not offered

#pragma GCC diagnostic ignored "-Wunused-parameter"

fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources,
                                          fmi3Boolean visible, fmi3Boolean logging,
                                          fmi3InstanceEnvironment environment,
                                          fmi3LogMessageCallback log) {
    const component self = {.log = log, .environment = environment};

    show((void *)&self, FMU_FAILED, "instance: found model exchange, expected co-simulation");
    return NULL;
}

fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
    fmi3ClockUpdateCallback clock_update, fmi3LockPreemptionCallback lock,
    fmi3UnlockPreemptionCallback unlock) {
    const component self = {.log = log, .environment = environment};

    show((void *)&self, FMU_FAILED, "instance: found scheduled execution, expected co-simulation");
    return NULL;
}

#define REFUSE(name, arguments)                                                                    \
    fmi3Status name arguments {                                                                    \
        return refuse(instance, __func__);                                                         \
    }
#define REFUSE_TYPE(type)                                                                          \
    FMI3_GET(type) {                                                                               \
        return refuse(instance, __func__);                                                         \
    }                                                                                              \
    FMI3_SET(type) {                                                                               \
        return refuse(instance, __func__);                                                         \
    }

FMI3_TYPES_NOT_OFFERED(REFUSE_TYPE)
FMI3_NOT_OFFERED(REFUSE)
