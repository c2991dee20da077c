/* SPDX-License-Identifier: GPL-3.0-or-later */
/* FMI 3.0 (Functional Mock-up Interface 3.0): all types and functions, in the order of the
 * standard, which explains them. Functions that the FMU does not offer are at the end. */
#ifndef EHD_FMI3_H
#define EHD_FMI3_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define FMI3_EXPORT __attribute__((visibility("default")))

// ---- types, section 2.2

typedef void *fmi3Instance;
typedef void *fmi3InstanceEnvironment;
typedef void *fmi3FMUState;
typedef uint32_t fmi3ValueReference;
typedef float fmi3Float32;
typedef double fmi3Float64;
typedef int8_t fmi3Int8;
typedef uint8_t fmi3UInt8;
typedef int16_t fmi3Int16;
typedef uint16_t fmi3UInt16;
typedef int32_t fmi3Int32;
typedef uint32_t fmi3UInt32;
typedef int64_t fmi3Int64;
typedef uint64_t fmi3UInt64;
typedef bool fmi3Boolean;
typedef char fmi3Char;
typedef const fmi3Char *fmi3String;
typedef uint8_t fmi3Byte;
typedef const fmi3Byte *fmi3Binary;
typedef bool fmi3Clock;

typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;
typedef enum {
    fmi3Independent,
    fmi3Constant,
    fmi3Fixed,
    fmi3Tunable,
    fmi3Discrete,
    fmi3Dependent
} fmi3DependencyKind;
typedef enum {
    fmi3IntervalNotYetKnown,
    fmi3IntervalUnchanged,
    fmi3IntervalChanged
} fmi3IntervalQualifier;

typedef void (*fmi3LogMessageCallback)(fmi3InstanceEnvironment environment, fmi3Status status,
                                       fmi3String category, fmi3String message);
typedef void (*fmi3ClockUpdateCallback)(fmi3InstanceEnvironment environment);
typedef void (*fmi3IntermediateUpdateCallback)(fmi3InstanceEnvironment environment,
                                               fmi3Float64 time, fmi3Boolean set_requested,
                                               fmi3Boolean get_allowed, fmi3Boolean step_finished,
                                               fmi3Boolean can_return_early,
                                               fmi3Boolean *early_return_requested,
                                               fmi3Float64 *early_return_time);
typedef void (*fmi3LockPreemptionCallback)(void);
typedef void (*fmi3UnlockPreemptionCallback)(void);

// ---- functions of all kinds of FMU

FMI3_EXPORT const char *fmi3GetVersion(void);
FMI3_EXPORT fmi3Status fmi3SetDebugLogging(fmi3Instance instance, fmi3Boolean on,
                                           size_t num_categories, const fmi3String categories[]);

FMI3_EXPORT fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token,
                                                      fmi3String resources, fmi3Boolean visible,
                                                      fmi3Boolean logging,
                                                      fmi3InstanceEnvironment environment,
                                                      fmi3LogMessageCallback log);
FMI3_EXPORT fmi3Instance
fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources,
                            fmi3Boolean visible, fmi3Boolean logging, fmi3Boolean event_mode,
                            fmi3Boolean early_return, const fmi3ValueReference intermediate[],
                            size_t num_intermediate, fmi3InstanceEnvironment environment,
                            fmi3LogMessageCallback log, fmi3IntermediateUpdateCallback update);
FMI3_EXPORT fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
    fmi3ClockUpdateCallback clock_update, fmi3LockPreemptionCallback lock,
    fmi3UnlockPreemptionCallback unlock);
FMI3_EXPORT void fmi3FreeInstance(fmi3Instance instance);

FMI3_EXPORT fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean has_tolerance,
                                                   fmi3Float64 tolerance, fmi3Float64 start,
                                                   fmi3Boolean has_stop, fmi3Float64 stop);
FMI3_EXPORT fmi3Status fmi3ExitInitializationMode(fmi3Instance instance);
FMI3_EXPORT fmi3Status fmi3Terminate(fmi3Instance instance);
FMI3_EXPORT fmi3Status fmi3Reset(fmi3Instance instance);

/* First arguments of all functions that get or set variables. */
#define FMI3_REFERENCES fmi3Instance instance, const fmi3ValueReference refs[], size_t num_refs

/* Declarations of the functions that get and set variables of a type. */
#define FMI3_GET(type)                                                                             \
    fmi3Status fmi3Get##type(FMI3_REFERENCES, fmi3##type values[], size_t num_values)
#define FMI3_SET(type)                                                                             \
    fmi3Status fmi3Set##type(FMI3_REFERENCES, const fmi3##type values[], size_t num_values)

FMI3_EXPORT FMI3_GET(Float64);
FMI3_EXPORT FMI3_SET(Float64);
FMI3_EXPORT FMI3_GET(Int32);
FMI3_EXPORT FMI3_SET(Int32);
FMI3_EXPORT FMI3_GET(Boolean);
FMI3_EXPORT FMI3_SET(Boolean);

FMI3_EXPORT fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState *state);
FMI3_EXPORT fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState state);
FMI3_EXPORT fmi3Status fmi3FreeFMUState(fmi3Instance instance, fmi3FMUState *state);
FMI3_EXPORT fmi3Status fmi3SerializedFMUStateSize(fmi3Instance instance, fmi3FMUState state,
                                                  size_t *size);
FMI3_EXPORT fmi3Status fmi3SerializeFMUState(fmi3Instance instance, fmi3FMUState state,
                                             fmi3Byte bytes[], size_t size);
FMI3_EXPORT fmi3Status fmi3DeserializeFMUState(fmi3Instance instance, const fmi3Byte bytes[],
                                               size_t size, fmi3FMUState *state);

FMI3_EXPORT fmi3Status fmi3GetDirectionalDerivative(
    fmi3Instance instance, const fmi3ValueReference unknowns[], size_t num_unknowns,
    const fmi3ValueReference knowns[], size_t num_knowns, const fmi3Float64 seed[], size_t num_seed,
    fmi3Float64 sensitivity[], size_t num_sensitivity);

// ---- co-simulation

FMI3_EXPORT fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 time, fmi3Float64 step,
                                  fmi3Boolean no_state_before, fmi3Boolean *event_needed,
                                  fmi3Boolean *terminate, fmi3Boolean *early_return,
                                  fmi3Float64 *last_time);

// ---- not offered: refused by each instance

/* List of the types that no variable of the FMU has. */
#define FMI3_TYPES_NOT_OFFERED(F)                                                                  \
    F(Float32) F(Int8) F(UInt8) F(Int16) F(UInt16) F(UInt32) F(Int64) F(UInt64) F(String)

/* List of the other functions that are not offered, with their arguments: clocks, arrays, events,
 * derivatives in time, configuration, model exchange, scheduled execution. */
#define FMI3_NOT_OFFERED(F)                                                                        \
    F(fmi3EnterEventMode, (fmi3Instance instance))                                                 \
    F(fmi3GetBinary, (FMI3_REFERENCES, size_t sizes[], fmi3Binary values[], size_t num_values))    \
    F(fmi3GetClock, (FMI3_REFERENCES, fmi3Clock values[]))                                         \
    F(fmi3SetBinary,                                                                               \
      (FMI3_REFERENCES, const size_t sizes[], const fmi3Binary values[], size_t num_values))       \
    F(fmi3SetClock, (FMI3_REFERENCES, const fmi3Clock values[]))                                   \
    F(fmi3GetNumberOfVariableDependencies,                                                         \
      (fmi3Instance instance, fmi3ValueReference ref, size_t * num))                               \
    F(fmi3GetVariableDependencies,                                                                 \
      (fmi3Instance instance, fmi3ValueReference dependent, size_t elements_of_dependent[],        \
       fmi3ValueReference independents[], size_t elements_of_independents[],                       \
       fmi3DependencyKind kinds[], size_t num))                                                    \
    F(fmi3GetAdjointDerivative,                                                                    \
      (fmi3Instance instance, const fmi3ValueReference unknowns[], size_t num_unknowns,            \
       const fmi3ValueReference knowns[], size_t num_knowns, const fmi3Float64 seed[],             \
       size_t num_seed, fmi3Float64 sensitivity[], size_t num_sensitivity))                        \
    F(fmi3EnterConfigurationMode, (fmi3Instance instance))                                         \
    F(fmi3ExitConfigurationMode, (fmi3Instance instance))                                          \
    F(fmi3GetIntervalDecimal,                                                                      \
      (FMI3_REFERENCES, fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[]))              \
    F(fmi3GetIntervalFraction, (FMI3_REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[],  \
                                fmi3IntervalQualifier qualifiers[]))                               \
    F(fmi3GetShiftDecimal, (FMI3_REFERENCES, fmi3Float64 shifts[]))                                \
    F(fmi3GetShiftFraction, (FMI3_REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[]))    \
    F(fmi3SetIntervalDecimal, (FMI3_REFERENCES, const fmi3Float64 intervals[]))                    \
    F(fmi3SetIntervalFraction,                                                                     \
      (FMI3_REFERENCES, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[]))              \
    F(fmi3SetShiftDecimal, (FMI3_REFERENCES, const fmi3Float64 shifts[]))                          \
    F(fmi3SetShiftFraction,                                                                        \
      (FMI3_REFERENCES, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[]))              \
    F(fmi3EvaluateDiscreteStates, (fmi3Instance instance))                                         \
    F(fmi3UpdateDiscreteStates,                                                                    \
      (fmi3Instance instance, fmi3Boolean * need_update, fmi3Boolean * terminate,                  \
       fmi3Boolean * nominals_changed, fmi3Boolean * states_changed, fmi3Boolean * has_next_event, \
       fmi3Float64 * next_event))                                                                  \
    F(fmi3EnterContinuousTimeMode, (fmi3Instance instance))                                        \
    F(fmi3CompletedIntegratorStep, (fmi3Instance instance, fmi3Boolean no_state_before,            \
                                    fmi3Boolean * enter_event_mode, fmi3Boolean * terminate))      \
    F(fmi3SetTime, (fmi3Instance instance, fmi3Float64 time))                                      \
    F(fmi3SetContinuousStates, (fmi3Instance instance, const fmi3Float64 states[], size_t num))    \
    F(fmi3GetContinuousStateDerivatives,                                                           \
      (fmi3Instance instance, fmi3Float64 derivatives[], size_t num))                              \
    F(fmi3GetEventIndicators, (fmi3Instance instance, fmi3Float64 indicators[], size_t num))       \
    F(fmi3GetContinuousStates, (fmi3Instance instance, fmi3Float64 states[], size_t num))          \
    F(fmi3GetNominalsOfContinuousStates,                                                           \
      (fmi3Instance instance, fmi3Float64 nominals[], size_t num))                                 \
    F(fmi3GetNumberOfEventIndicators, (fmi3Instance instance, size_t * num))                       \
    F(fmi3GetNumberOfContinuousStates, (fmi3Instance instance, size_t * num))                      \
    F(fmi3EnterStepMode, (fmi3Instance instance))                                                  \
    F(fmi3GetOutputDerivatives,                                                                    \
      (FMI3_REFERENCES, const fmi3Int32 orders[], fmi3Float64 values[], size_t num_values))        \
    F(fmi3ActivateModelPartition,                                                                  \
      (fmi3Instance instance, fmi3ValueReference clock, fmi3Float64 time))

#define FMI3_DECLARE_TYPE(type)                                                                    \
    FMI3_EXPORT FMI3_GET(type);                                                                    \
    FMI3_EXPORT FMI3_SET(type);
#define FMI3_DECLARE(name, arguments) FMI3_EXPORT fmi3Status name arguments;

FMI3_TYPES_NOT_OFFERED(FMI3_DECLARE_TYPE)
FMI3_NOT_OFFERED(FMI3_DECLARE)

#endif
