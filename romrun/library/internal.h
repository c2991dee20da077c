/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Declarations for the files of this folder alone. */
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

/* Factors from dimensionless quantities to the caller's. */
typedef struct unit_factors {
    double length, film, pressure, load, time;
    double length_across;          // of Y
    double speed, radius, modulus; // of conditions, which are relative to the reference
} unit_factors;

typedef enum last_call { LAST_NONE, LAST_SOLVED, LAST_IN_TIME } last_call;

/* The state to which derivatives belong. */
typedef enum last_solved { OF_NOTHING, OF_SOLUTION, OF_START, OF_STEP } last_solved;

struct ehdrom_contact {
    const ehdrom_model *model;
    scene settings;
    // the settings completed for each regime, [stationary, in time], valid until another setting
    // changes
    scene complete[2];
    bool is_complete[2];
    bool dimensionless;
    double accuracy, tolerance, step_tolerance; // NaN: not set
    last_call last;
    contact_scalars scalars; // of the last solution or accepted state, as the fields; load NaN:
                             // not known
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
    bool is_reference; // the contact of the settings as they are now
    bool by_approach;  // the approach was given for the last start or step
    bool started;      // there is an accepted state
    bool can_accept;   // there is a step after the accepted state
    // for fields; NULL: not needed yet
    double *pressure, *film; // [num_nodes] of the grid with the most nodes
    char deviation[MARCH_REASON];
    ehd_error error;
};

/* Begin and end each public function. They set the C locale in this thread, for reading and
 * printing, and restore the caller's. */
locale_t library_enter(void);
void library_leave(locale_t before);

/* Begins a call and clears the error of the last one. EHD_INTERNAL: a contact without a model. */
ehd_status library_begin(ehdrom_contact *self);

/* Copies the members that both structs contain. The target's size, its first member, stays.
 * EHD_DATA: the target has no size; `what` names it in the message. */
ehd_status library_give(void *target, const void *source, size_t size, const char *what,
                        ehd_error *error);

/* Makes the contact of the settings and its units: stationary, or the reference in time.
 * EHD_DATA. */
ehd_status library_contact(ehd_contact *contact, unit_factors *units, ehdrom_contact *self,
                           bool in_time, ehd_error *error);

/* Returns the grid of the last solution or accepted state: the model's, or for a list the grid of
 * the model that has solved it. */
const ehd_grid *library_grid(const ehdrom_contact *self);

/* Computes pressure and film of the last solution or accepted state at its nodes, into
 * self->pressure and self->film. */
ehd_status library_fields(ehdrom_contact *self);

/* Writes a field [num_nodes], times its unit, at the nodes of the whole contact, [num_y, num_x] of
 * ehdrom_nodes, and NaN behind them up to the nodes of ehdrom_model_info. `target` NULL: not
 * wanted. */
void library_give_field(double *target, const double *nodes, double unit,
                        const ehdrom_contact *self);

/* Converts the caller's conditions to values relative to the reference. Conditions that are not
 * given stay as they are in *own. EHD_DATA. */
ehd_status library_conditions(online_conditions *own, const ehdrom_conditions *given,
                              const unit_factors *units, ehd_error *error);

/* Enclose code that one thread at a time may run: HDF5, whose settings in the process are the
 * caller's again afterwards, and FFTW's planner. */
void library_lock(void);
void library_unlock(void);

#endif
