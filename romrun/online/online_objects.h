/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The objects behind online.h, for the files that implement it: online_model.c (models), online.c
 * (stationary solutions), online_transient.c (steps in time), online_derivatives.c. */
#ifndef EHD_ONLINE_OBJECTS_H
#define EHD_ONLINE_OBJECTS_H

#include "common/settings/part_list.h"
#include "common/time/apart.h"
#include "romrun/online/online.h"
#include "romrun/online/part.h"
#include "romrun/online/parts_march.h"

struct online_model {
    char *path;
    part_list list; // files that the model consists of
    flat *files;    // [list.num] tables of the files that are flat; unused for HDF5 files
    size_t num_parts;
    model_part parts[MAX_PARTS]; // alike in contact kind, discretisation, transport and smoothing
};

struct online_solver {
    const online_model *model;
    part_solver *parts; // [model->num_parts]
    part_solver *used;  // part that made the last solution
};

/* Returns the index of the part in whose trained range a contact lies deepest. If the contact lies
 * in no range, returns the nearest part. If some parts have the grid that the contact gives, the
 * choice is among these parts only. */
size_t online_part_for(const online_model *self, const part_solver *solvers,
                       const ehd_contact *contact);

/* Reports that a model was used before the function `call` prepared it. Returns EHD_INTERNAL. */
ehd_status online_not_prepared(const model_part *model, const char *call, ehd_error *error);

// ---- transient contacts

/* Data of the last accepted state that the march of the part does not hold. All members are
 * doubles, so that the struct can be saved as an array. */
typedef struct accepted_moment {
    double time;
    load_forecast forecast; // forecast of the load that scales the next frame for a given approach
    double path, speed;     // path that the fluid has travelled, and the speed of the fluid
} accepted_moment;

struct online_transient {
    const online_model *model;
    ehd_contact reference;
    parts_march *march;
    apart_march contact; // `march`, extended to bodies that separate and touch again
    march_solver solver; // `contact` as a solver for steps
    bool started;        // true: there is an accepted state
    bool solved;         // true: there is a step that can be accepted
    march_step last;     // the last solved step
    accepted_moment now;
    // conditions at the end of the last step, which begins at `now`; before the first step:
    // conditions of the start
    online_conditions conditions;
    bool at_start;            // true: no step was taken since the start
    size_t of;                // index of the part to which the tangent belongs
    reduced_tangent *tangent; // NULL: no derivative was needed yet
    bool linearised;          // true: the tangent is linearised at the present solution
};

/* Returns the march of the solved step that is not accepted yet. Without such a step, returns the
 * march of the last accepted state. */
reduced_march *transient_march_of_attempt(const online_transient *self);

/* Returns the frame at the end of a step of this length, for the conditions at its end. `step` 0:
 * the frame of the start. */
contact_frame transient_frame_of(const online_transient *self, const online_conditions *conditions,
                                 double step);

/* Checks whether the bodies are apart in the last solved step. If there is no such step, checks the
 * accepted state. */
bool transient_is_apart(const online_transient *self);

/* Returns the argument `steps` of reduced_march_state_before for the last solved state: 0 for a
 * step that is not accepted yet, 1 for an accepted state. A start is accepted at once. */
size_t transient_steps_before(const online_transient *self);

#endif
