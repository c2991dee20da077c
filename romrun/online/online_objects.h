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
    flat *files;    // [list.num] tables of those files that are flat
    size_t num_parts;
    model_part parts[MAX_PARTS]; // all have the same kind, discretisation and carriage
};

struct online_solver {
    const online_model *model;
    part_solver *parts; // [model->num_parts]
    part_solver *used;  // part that made the last solution
};

/* Returns the part in whose trained range a contact lies deepest, or else the nearest part. If any
 * parts have the grid that the contact gives, it chooses among these only. */
size_t online_part_for(const online_model *self, const part_solver *solvers,
                       const ehd_contact *contact);

/* Reports a model that was used without a call of `call`. Returns EHD_INTERNAL. */
ehd_status online_not_prepared(const model_part *model, const char *call, ehd_error *error);

// ---- in time

/* Data of the last accepted state that its march does not hold. All members are doubles, so that
 * the struct can be saved as an array. */
typedef struct accepted_moment {
    double time;
    load_forecast forecast; // if the approach is given: load that scales the next frame
    double path, speed;     // path that the fluid has travelled, and its speed
} accepted_moment;

struct online_transient {
    const online_model *model;
    ehd_contact reference;
    parts_march *march;
    apart_march contact; // `march` extended by bodies that separate
    march_solver solver; // solver of `contact`
    bool started;        // true: there is an accepted state
    bool solved;         // true: there is a step that can be accepted
    march_step last;     // the last solved step
    accepted_moment now;
    // conditions of the last step, which begins at `now`, or of the start
    online_conditions conditions;
    bool at_start;            // true: no step was taken since the start
    size_t of;                // index of the part to which the tangent belongs
    reduced_tangent *tangent; // NULL: not needed yet
    bool linearised;          // true: the tangent is linearised at the present solution
};

/* Returns the march of the solved step that is not accepted yet. Without such a step, returns the
 * march of the last accepted state. */
reduced_march *transient_march_of_attempt(const online_transient *self);

/* Returns the frame of a contact under conditions that end a step. Step 0: the start. */
contact_frame transient_frame_of(const online_transient *self, const online_conditions *conditions,
                                 double step);

/* Checks whether the bodies are apart in the last solved step or, without one, in the accepted
 * state. */
bool transient_is_apart(const online_transient *self);

/* Returns the index of the last step among the states of its march: 0 for an attempt, 1 for a
 * start, which is accepted at once. */
size_t transient_steps_before(const online_transient *self);

#endif
