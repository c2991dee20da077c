/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Declarations for the files of this folder alone. */
#ifndef EHD_LIBRARY_INTERNAL_H
#define EHD_LIBRARY_INTERNAL_H

#include "romrun/library/ehdrom.h"
#include "romrun/online/online.h"

#include <locale.h>

struct ehdrom_model {
    online_model *online; // NULL: no model is open
    bool in_time;
    ehd_error error;
};

/* Factors from dimensionless quantities to the caller's units. */
typedef struct unit_factors {
    double length, film, pressure, load, time;
    double length_across;          // factor of Y
    double speed, radius, modulus; // factors of conditions, which are relative to the reference
} unit_factors;

typedef enum last_call { LAST_NONE, LAST_SOLVED, LAST_IN_TIME } last_call;

/* Solution whose derivatives ehdrom_differentiate computes. */
typedef enum last_solved { OF_NOTHING, OF_SOLUTION, OF_START, OF_STEP } last_solved;

struct ehdrom_contact {
    const ehdrom_model *model;
    scene settings;
    // settings completed for each regime, [stationary, in time]; valid until a setting changes
    scene complete[2];
    bool is_complete[2];
    bool dimensionless;
    double accuracy, tolerance, step_tolerance; // NaN: the caller has not set this value
    last_call last;
    contact_scalars scalars; // scalars of the last solution or accepted state, to which the fields
                             // belong; if the load is NaN, the scalars are not known
    contact_scalars stepped; // scalars of the step that may be accepted
    last_solved differentiable;
    // stationary
    online_solver *solver; // NULL: no stationary solution was needed yet
    ehd_contact solved;
    unit_factors solved_units;
    // transient
    online_transient *in_time; // NULL: the contact was not started in time
    ehd_contact reference;
    unit_factors reference_units;
    bool is_reference; // true: the reference is the contact of the present settings
    bool by_approach;  // true: the approach was given for the last start or step
    bool started;      // true: there is an accepted state
    bool can_accept;   // true: there is a step after the accepted state
    // work arrays for the fields; NULL: no fields were needed yet
    double *pressure, *film; // [num_nodes] of the grid with the most nodes
    char deviation[MARCH_REASON];
    locale_t locale; // the caller's locale, from library_begin to library_end
    ehd_error error;
};

/* library_enter sets the C locale in this thread, in which numbers are read and printed, and
 * library_leave restores the caller's locale. */
locale_t library_enter(void);
void library_leave(locale_t before);

/* Public functions for a contact begin and end with these calls. library_begin clears the previous
 * error and sets the C locale. EHD_INTERNAL: there is no contact, or it has no model. library_end
 * restores the caller's locale and returns `status`. It is also called if library_begin fails. */
ehd_status library_begin(ehdrom_contact *self);
ehdrom_status library_end(ehdrom_contact *self, ehd_status status);

/* Copies a struct of `size` bytes to the caller's struct `target`, as far as both structs have the
 * same members. The first member of `target`, which is its size, stays the same. EHD_DATA: `target`
 * has no size. `what`: name of the struct in the message. */
ehd_status library_give(void *target, const void *source, size_t size, const char *what,
                        ehd_error *error);

/* Makes the contact that the settings describe, and its units. `in_time`: the reference contact of
 * steps in time, otherwise a stationary contact. EHD_DATA: the settings do not describe a contact
 * of this regime. */
ehd_status library_contact(ehd_contact *contact, unit_factors *units, ehdrom_contact *self,
                           bool in_time, ehd_error *error);

/* Returns the grid of the last solution or accepted state: the model's grid or, for a list, the
 * grid of the model that has solved the contact. */
const ehd_grid *library_grid(const ehdrom_contact *self);

/* Computes self->pressure and self->film of the last solution or accepted state, at the nodes of
 * library_grid. */
ehd_status library_fields(ehdrom_contact *self);

/* Writes the values of a field, [num_nodes], times `unit`, at the nodes of the whole contact,
 * [num_y, num_x] of ehdrom_nodes. Fills the rest of `target`, up to the nodes of ehdrom_model_info,
 * with NaN. If `target` is NULL, writes nothing. */
void library_give_field(double *target, const double *nodes, double unit,
                        const ehdrom_contact *self);

/* Converts the caller's conditions to values relative to the reference. Conditions that are not
 * given keep their values in *own. Errors: EHD_DATA. */
ehd_status library_conditions(online_conditions *own, const ehdrom_conditions *given,
                              const unit_factors *units, ehd_error *error);

/* Enclose code that only one thread at a time may run: HDF5 and FFTW's planner. library_unlock
 * restores the caller's settings of HDF5. */
void library_lock(void);
void library_unlock(void);

#endif
