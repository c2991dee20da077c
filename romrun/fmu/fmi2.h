/* SPDX-License-Identifier: GPL-3.0-or-later */
/* FMI 2.0 (Functional Mock-up Interface for Model Exchange and Co-Simulation, 2.0.4): all types
 * and functions, in the order of the standard, which explains them. Functions that the FMU does
 * not offer are at the end. */
#ifndef EHD_FMI2_H
#define EHD_FMI2_H

#include <stddef.h>

#define FMI2_EXPORT __attribute__((visibility("default")))

// ---- types, section 2.1

typedef void *fmi2Component;
typedef void *fmi2ComponentEnvironment;
typedef void *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer;
typedef int fmi2Boolean;
typedef char fmi2Char;
typedef const fmi2Char *fmi2String;
typedef char fmi2Byte;

enum { fmi2False = 0, fmi2True = 1 };

typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef enum {
    fmi2DoStepStatus,
    fmi2PendingStatus,
    fmi2LastSuccessfulTime,
    fmi2Terminated
} fmi2StatusKind;

typedef void (*fmi2CallbackLogger)(fmi2ComponentEnvironment environment, fmi2String instance_name,
                                   fmi2Status status, fmi2String category, fmi2String message, ...);
typedef void *(*fmi2CallbackAllocateMemory)(size_t count, size_t size);
typedef void (*fmi2CallbackFreeMemory)(void *memory);
typedef void (*fmi2StepFinished)(fmi2ComponentEnvironment environment, fmi2Status status);

typedef struct {
    fmi2CallbackLogger logger;
    fmi2CallbackAllocateMemory allocateMemory;
    fmi2CallbackFreeMemory freeMemory;
    fmi2StepFinished stepFinished;
    fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;

typedef struct {
    fmi2Boolean newDiscreteStatesNeeded;
    fmi2Boolean terminateSimulation;
    fmi2Boolean nominalsOfContinuousStatesChanged;
    fmi2Boolean valuesOfContinuousStatesChanged;
    fmi2Boolean nextEventTimeDefined;
    fmi2Real nextEventTime;
} fmi2EventInfo;

// ---- functions of both kinds of FMU

FMI2_EXPORT const char *fmi2GetTypesPlatform(void);
FMI2_EXPORT const char *fmi2GetVersion(void);
FMI2_EXPORT fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t num_categories,
                                           const fmi2String categories[]);

FMI2_EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid,
                                          fmi2String resources,
                                          const fmi2CallbackFunctions *functions,
                                          fmi2Boolean visible, fmi2Boolean logging);
FMI2_EXPORT void fmi2FreeInstance(fmi2Component c);

FMI2_EXPORT fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance,
                                           fmi2Real tolerance, fmi2Real start, fmi2Boolean has_stop,
                                           fmi2Real stop);
FMI2_EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component c);
FMI2_EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component c);
FMI2_EXPORT fmi2Status fmi2Terminate(fmi2Component c);
FMI2_EXPORT fmi2Status fmi2Reset(fmi2Component c);

FMI2_EXPORT fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference refs[], size_t num,
                                   fmi2Real values[]);
FMI2_EXPORT fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference refs[], size_t num,
                                      fmi2Integer values[]);
FMI2_EXPORT fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference refs[], size_t num,
                                      fmi2Boolean values[]);
FMI2_EXPORT fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference refs[], size_t num,
                                   const fmi2Real values[]);
FMI2_EXPORT fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference refs[], size_t num,
                                      const fmi2Integer values[]);
FMI2_EXPORT fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference refs[], size_t num,
                                      const fmi2Boolean values[]);

FMI2_EXPORT fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state);
FMI2_EXPORT fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state);
FMI2_EXPORT fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state);
FMI2_EXPORT fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state,
                                                  size_t *size);
FMI2_EXPORT fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[],
                                             size_t size);
FMI2_EXPORT fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size,
                                               fmi2FMUstate *state);

FMI2_EXPORT fmi2Status fmi2GetDirectionalDerivative(fmi2Component c,
                                                    const fmi2ValueReference unknowns[],
                                                    size_t num_unknowns,
                                                    const fmi2ValueReference knowns[],
                                                    size_t num_knowns, const fmi2Real direction[],
                                                    fmi2Real derivative[]);

// ---- co-simulation

FMI2_EXPORT fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real step,
                                  fmi2Boolean no_state_before);
FMI2_EXPORT fmi2Status fmi2GetRealStatus(fmi2Component c, fmi2StatusKind kind, fmi2Real *value);
FMI2_EXPORT fmi2Status fmi2GetBooleanStatus(fmi2Component c, fmi2StatusKind kind,
                                            fmi2Boolean *value);

// ---- not offered: refused by each instance

/* List of the functions of FMI 2.0 that no instance offers, with their arguments: functions for
 * text variables, for time derivatives of inputs and outputs, for steps that continue after the
 * call returns, and for model exchange. */
#define FMI2_NOT_OFFERED(F)                                                                        \
    F(fmi2GetString,                                                                               \
      (fmi2Component c, const fmi2ValueReference refs[], size_t num, fmi2String values[]))         \
    F(fmi2SetString,                                                                               \
      (fmi2Component c, const fmi2ValueReference refs[], size_t num, const fmi2String values[]))   \
    F(fmi2SetRealInputDerivatives, (fmi2Component c, const fmi2ValueReference refs[], size_t num,  \
                                    const fmi2Integer orders[], const fmi2Real values[]))          \
    F(fmi2GetRealOutputDerivatives, (fmi2Component c, const fmi2ValueReference refs[], size_t num, \
                                     const fmi2Integer orders[], fmi2Real values[]))               \
    F(fmi2CancelStep, (fmi2Component c))                                                           \
    F(fmi2GetStatus, (fmi2Component c, fmi2StatusKind kind, fmi2Status * value))                   \
    F(fmi2GetIntegerStatus, (fmi2Component c, fmi2StatusKind kind, fmi2Integer * value))           \
    F(fmi2GetStringStatus, (fmi2Component c, fmi2StatusKind kind, fmi2String * value))             \
    F(fmi2EnterEventMode, (fmi2Component c))                                                       \
    F(fmi2NewDiscreteStates, (fmi2Component c, fmi2EventInfo * info))                              \
    F(fmi2EnterContinuousTimeMode, (fmi2Component c))                                              \
    F(fmi2CompletedIntegratorStep, (fmi2Component c, fmi2Boolean no_state_before,                  \
                                    fmi2Boolean * enter_event_mode, fmi2Boolean * terminate))      \
    F(fmi2SetTime, (fmi2Component c, fmi2Real time))                                               \
    F(fmi2SetContinuousStates, (fmi2Component c, const fmi2Real states[], size_t num))             \
    F(fmi2GetDerivatives, (fmi2Component c, fmi2Real derivatives[], size_t num))                   \
    F(fmi2GetEventIndicators, (fmi2Component c, fmi2Real indicators[], size_t num))                \
    F(fmi2GetContinuousStates, (fmi2Component c, fmi2Real states[], size_t num))                   \
    F(fmi2GetNominalsOfContinuousStates, (fmi2Component c, fmi2Real nominals[], size_t num))

#define FMI2_DECLARE(name, arguments) FMI2_EXPORT fmi2Status name arguments;

FMI2_NOT_OFFERED(FMI2_DECLARE)

#endif
