/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An FMU's contact, whichever version of the standard asks. It knows the contact by ehdrom.h alone.
 *
 * A communication step is one step of BDF2 (the first one of BDF1) to the inputs that were set before it, which
 * hold at its end. Where that does not converge, or has a larger local error than step_accuracy allows, or is more
 * than twice as long as the last one, it is made of steps of a half, a quarter … of it, with inputs in proportion.
 * A local error that shorter steps do not reduce is noise of the solver; it is accepted. */
#ifndef EHD_FMU_INSTANCE_H
#define EHD_FMU_INSTANCE_H

#include "romrun/fmu/variables.h"

/* Outcome of a call. */
typedef enum fmu_outcome {
    FMU_DONE,
    FMU_DISCARDED, // a step that does not converge at any length; nothing has changed
    FMU_FAILED
} fmu_outcome;

/* Log categories of these outcomes. */
extern const char *const fmu_categories[];

/* Receives why a call failed or was discarded or, with FMU_DONE, a remark for the user. */
typedef void (*fmu_log)(void *to, fmu_outcome of, const char *text);

typedef struct fmu_instance fmu_instance;

/* `resources` is the folder. NULL, after it was logged: no memory, another token, files that are not
 * as exported. Freed with fmu_free. */
fmu_instance *fmu_create(const char *token, const char *resources, fmu_log log, void *log_to);
/* Accepts NULL. */
void fmu_free(fmu_instance *self);
/* Whether what is not an error is logged; at first it is not. */
void fmu_set_verbose(fmu_instance *self, bool verbose);

/* All others return whether they could; else it was logged why. */

/* A call that no FMU of this kind answers. */
bool fmu_refuse(fmu_instance *self, const char *function);

/* stop INFINITY: none. tolerance 0: none. */
bool fmu_setup(fmu_instance *self, double start, double stop, double tolerance);
bool fmu_enter_initialization(fmu_instance *self);
bool fmu_exit_initialization(fmu_instance *self);
bool fmu_terminate(fmu_instance *self);
bool fmu_reset(fmu_instance *self);

bool fmu_get(fmu_instance *self, unsigned reference, fmu_type type, double *value);
bool fmu_set(fmu_instance *self, unsigned reference, fmu_type type, double value);

/* A step that is discarded or fails leaves the instance as it was before. */
fmu_outcome fmu_step(fmu_instance *self, double time, double step);
/* The end of the last step that could be done. */
double fmu_time(const fmu_instance *self);

/* derivative[k] = sum over i of direction[i] d unknowns[k] / d knowns[i], of outputs by inputs: of what the last
 * internal step's end would have been, or at the start the stationary contact. By the library's tangent; outputs that
 * this does not have by central differences, for all of them two more steps and one back. */
bool fmu_derivative(fmu_instance *self, const unsigned unknowns[], size_t num_unknowns,
                    const unsigned knowns[], size_t num_knowns, const double direction[],
                    double derivative[]);

/* A state is a block of bytes, of this FMU's in any process: one of malloc, freed with free. *state is made anew where
 * it is NULL, and written over else. */
bool fmu_state_get(fmu_instance *self, void **state);
bool fmu_state_set(fmu_instance *self, void *state);
/* Of its bytes; 0: there is none. */
size_t fmu_state_size(const void *state);
/* Its bytes: as many. */
bool fmu_state_write(fmu_instance *self, const void *state, void *bytes, size_t size);
/* A state of those bytes, checked; *state as above. */
bool fmu_state_read(fmu_instance *self, void **state, const void *bytes, size_t size);

#endif
