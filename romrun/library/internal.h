/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of this folder share; nobody else includes it. */
#ifndef EHD_LIBRARY_INTERNAL_H
#define EHD_LIBRARY_INTERNAL_H

#include "romrun/library/ehdrom.h"
#include "romrun/online/online.h"

#include <locale.h>

struct ehdrom_model {
    online_model *online; // NULL: not opened
    bool in_time;
    ehd_error error;
};

/* Factors from dimensionless quantities to those of the caller. */
typedef struct unit_factors {
    double length, film, pressure, load, time;
    double length_across;          // of Y
    double speed, radius, modulus; // of conditions, which are relative to the reference
} unit_factors;

typedef enum last_call { LAST_NONE, LAST_SOLVED, LAST_IN_TIME } last_call;

/* What derivatives are of. */
typedef enum last_solved { OF_NOTHING, OF_SOLUTION, OF_START, OF_STEP } last_solved;

struct ehdrom_contact {
    const ehdrom_model *model;
    scene settings;
    // what they come to in each regime, [stationary, in time], valid until another setting changes
    scene complete[2];
    bool is_complete[2];
    bool dimensionless;
    double accuracy, tolerance, step_tolerance; // NaN: not set
    last_call last;
    contact_scalars scalars; // of what came last, as fields are; load NaN: not known
    contact_scalars stepped; // of the step that may be accepted
    last_solved differentiable;
    // stationary
    online_solver *solver; // NULL: not needed yet
    ehd_contact solved;
    unit_factors solved_units;
    // in time
    online_transient *in_time; // NULL: not started
    ehd_contact reference;
    unit_factors reference_units;
    bool is_reference; // of the settings as they are now
    bool by_approach;  // the last start or step was given it
    bool started;      // there is an accepted state
    bool can_accept;   // and a step after it
    // of fields, NULL: not needed yet
    double *pressure, *film; // [num_nodes] of the grid with most of them
    char deviation[MARCH_REASON];
    ehd_error error;
};

/* Each public function is between these: the C locale for what is read and shown, in this thread. */
locale_t library_enter(void);
void library_leave(locale_t before);

/* Begins a call: forgets the error of the last one. EHD_INTERNAL: a contact without model. */
ehd_status library_begin(ehdrom_contact *self);

/* Copies what both know of a struct that begins with its size, which stays. EHD_DATA, naming
 * `what`: no size. */
ehd_status library_give(void *target, const void *source, size_t size, const char *what,
                        ehd_error *error);

/* The contact of the settings, with its units: stationary, or the reference in time. EHD_DATA. */
ehd_status library_contact(ehd_contact *contact, unit_factors *units, ehdrom_contact *self,
                           bool in_time, ehd_error *error);

/* The grid of what came last: the model's, or of a list that of the model which has solved it. */
const ehd_grid *library_grid(const ehdrom_contact *self);

/* Pressure and film of what came last at its nodes, in self->pressure and self->film. */
ehd_status library_fields(ehdrom_contact *self);

/* A field of what came last, [num_nodes], times its unit, at the nodes of the whole contact that the
 * caller has it at, [num_y, num_x] of ehdrom_nodes, and NaN up to those of ehdrom_model_info. NULL: not
 * wanted. */
void library_give_field(double *target, const double *nodes, double unit,
                        const ehdrom_contact *self);

/* What the caller gives of conditions, relative to the reference; what is not given stays as it is in *own.
 * EHD_DATA. */
ehd_status library_conditions(online_conditions *own, const ehdrom_conditions *given,
                              const unit_factors *units, ehd_error *error);

/* Where one thread at a time has to be: in HDF5, whose ways of the process are the
 * caller's again afterwards, and in FFTW's planner. */
void library_lock(void);
void library_unlock(void);

#endif
