/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The contact of an FMU, for both versions of the standard. It uses the library only through
 * ehdrom.h.
 *
 * A communication step is one step of BDF2 (the first one of BDF1). The inputs that were set before
 * the step hold at its end. In three cases the step is divided into steps of a half, a quarter …,
 * with interpolated inputs: the step does not converge, its local error exceeds step_accuracy, or
 * the step is more than twice as long as the last step. A local error that shorter steps do not
 * reduce is noise of the solver and is accepted. */
#ifndef EHD_FMU_INSTANCE_H
#define EHD_FMU_INSTANCE_H

#include "romrun/fmu/variables.h"

/* Outcome of a call. */
typedef enum fmu_outcome {
    FMU_DONE,
    FMU_DISCARDED, // an input is refused, or a step does not converge; the instance is unchanged
    FMU_FAILED
} fmu_outcome;

/* Log categories of these outcomes. */
extern const char *const fmu_categories[];

/* Receives the reason why a call failed or was discarded. With FMU_DONE, receives a remark for the
 * user. */
typedef void (*fmu_log)(void *to, fmu_outcome of, const char *text);

typedef struct fmu_instance fmu_instance;

/* Creates an instance; free with fmu_free. `resources`: path of the folder of the resources.
 * Returns NULL, with a message in the log, if there is no memory, if `token` differs from the token
 * of the FMU, or if files differ from the exported files. */
fmu_instance *fmu_create(const char *token, const char *resources, fmu_log log, void *log_to);
/* Frees an instance. Accepts NULL. */
void fmu_free(fmu_instance *self);
/* Sets whether to log remarks in addition to errors. By default only errors are logged. */
void fmu_set_verbose(fmu_instance *self, bool verbose);

/* The bool functions below return true on success; otherwise the log has the reason. */

/* Refuses a call of a function that this FMU does not offer. Returns false. */
bool fmu_refuse(fmu_instance *self, const char *function);

/* Sets start, end and tolerance of the simulation. If `stop` is INFINITY, the simulation has no
 * fixed end. If `tolerance` is 0, the importer gives no tolerance. */
bool fmu_setup(fmu_instance *self, double start, double stop, double tolerance);
bool fmu_enter_initialization(fmu_instance *self);
bool fmu_exit_initialization(fmu_instance *self);
bool fmu_terminate(fmu_instance *self);
bool fmu_reset(fmu_instance *self);

bool fmu_get(fmu_instance *self, unsigned reference, fmu_type type, double *value);
bool fmu_set(fmu_instance *self, unsigned reference, fmu_type type, double value);

/* Takes a communication step. A step that is discarded or fails leaves the instance as it was. */
fmu_outcome fmu_step(fmu_instance *self, double time, double step);
/* Returns the end of the last successful step. */
double fmu_time(const fmu_instance *self);

/* Value references of a directional derivative: the unknowns are outputs, the knowns are inputs. */
typedef struct fmu_direction {
    const unsigned *unknowns, *knowns;
    size_t num_unknowns, num_knowns;
    const double *along; // [num_knowns] direction
} fmu_direction;

/* Computes derivative[k] = sum over i of along[i] d unknowns[k] / d knowns[i]. At the start these
 * are derivatives of the stationary contact, later derivatives at the end of the last internal
 * step. The library's tangent computes them. Outputs without a tangent get central differences,
 * which take three more steps for all of these outputs together. */
bool fmu_derivative(fmu_instance *self, const fmu_direction *of, double derivative[]);

/* Saves the state as a block of bytes, which this FMU can restore in any process. Allocates the
 * block if *state is NULL, otherwise overwrites it. Free the block with free(). */
bool fmu_state_get(fmu_instance *self, void **state);
bool fmu_state_set(fmu_instance *self, void *state);
/* Returns the number of bytes of the state, or 0 if `state` is NULL. */
size_t fmu_state_size(const void *state);
/* Copies the state's bytes to `bytes`, which holds `size` bytes. */
bool fmu_state_write(fmu_instance *self, const void *state, void *bytes, size_t size);
/* Checks bytes that fmu_state_write has written, and makes a state from these bytes. *state: as for
 * fmu_state_get. */
bool fmu_state_read(fmu_instance *self, void **state, const void *bytes, size_t size);

#endif
