/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes derivatives of solutions and of steps. */
#include "romrun/library/internal.h"

#include <math.h>

/* Returns the contact of the last ehdrom_solve, with another reference point for the approach of a
 * line contact. This point lies at approach_length or, if this setting is not set, at
 * far_approach_length. The point at 1 half width, which ehdrom_solve uses, lies at the edge of the
 * contact. Relative to a point as near as this, a contact has no stiffness against the approach
 * (schemas/scene.md, Histories), so the derivative of the approach has no meaning. */
static ehd_contact contact_from_afar(const ehdrom_contact *self) {
    const double length = self->settings.approach_length;
    ehd_contact contact = self->solved;

    contact.approach_length = isnan(length) ? far_approach_length : length;
    return contact;
}

/* Begins a call. EHD_INTERNAL: there is no solution. `expected`: the calls that must come
 * before. */
static ehd_status begin(ehdrom_contact *self, const char *what, const char *expected) {
    const ehd_status status = library_begin(self);

    if (status || self->differentiable != OF_NOTHING) return status;
    return ehd_fail(&self->error, EHD_INTERNAL, "%s: found no solution, expected %s before", what,
                    expected);
}

static const unit_factors *units_of_last(const ehdrom_contact *self) {
    return self->differentiable == OF_SOLUTION ? &self->solved_units : &self->reference_units;
}

/* Converts a direction. If the direction has neither load nor approach, the quantity that was given
 * for the solution stays constant. */
static ehd_status take_direction(online_direction *own, ehdrom_contact *self,
                                 const ehdrom_conditions *given) {
    const bool by_approach = self->differentiable != OF_SOLUTION && self->by_approach;

    *own = (online_direction){.load = NAN, .approach = NAN};
    ehd_status status = library_conditions(own, given, units_of_last(self), &self->error);
    if (!status && isnan(own->load) && isnan(own->approach))
        *(by_approach ? &own->approach : &own->load) = 0;
    return status;
}

static ehd_status differentiate(ehdrom_contact *self, const ehdrom_conditions *given,
                                ehdrom_derivatives *derivatives) {
    const unit_factors *units = units_of_last(self);
    online_derivatives found;
    online_direction direction;
    ehd_status status = take_direction(&direction, self, given);

    if (status) return status;
    if (self->differentiable == OF_SOLUTION) {
        const ehd_contact contact = contact_from_afar(self);
        status = online_differentiate(&found, self->solver, &contact, &direction, &self->error);
    } else {
        status = online_transient_differentiate(&found, self->in_time, &direction, &self->error);
    }
    if (status) return status;
    const contact_scalars *scalars = &found.scalars;
    const ehdrom_derivatives own = {
        .load = scalars->load * units->load,
        .approach = scalars->rigid_approach * units->film,
        .central_film_thickness = scalars->central_film_thickness * units->film,
        .minimum_film_thickness = scalars->minimum_film_thickness * units->film,
        .central_pressure = scalars->central_pressure * units->pressure,
        .peak_pressure = found.peak_pressure * units->pressure,
        .exit_position = scalars->exit_position * units->length,
        .half_width = found.half_width * units->length};
    return library_give(derivatives, &own, sizeof own, "derivatives", &self->error);
}

ehdrom_status ehdrom_differentiate(ehdrom_contact *self, const ehdrom_conditions *direction,
                                   ehdrom_derivatives *derivatives) {
    ehd_status status =
        begin(self, "derivatives", "ehdrom_solve, ehdrom_start or a step that is not accepted yet");

    if (!status) status = differentiate(self, direction, derivatives);
    return library_end(self, status);
}

static ehd_status respond(ehdrom_contact *self, ehdrom_response *response) {
    const unit_factors *units = units_of_last(self);
    const double stiffness = units->load / units->film, damping = stiffness * units->time;
    online_response found;
    ehd_status status;

    if (self->differentiable == OF_SOLUTION) {
        const ehd_contact contact = contact_from_afar(self);
        status = online_respond(&found, self->solver, &contact, &self->error);
    } else {
        status = online_transient_respond(&found, self->in_time, &self->error);
    }
    if (status) return status;
    const ehdrom_response own = {.stiffness = found.stiffness * stiffness,
                                 .damping = found.damping * damping,
                                 .damping_bound = found.damping_bound * damping};
    return library_give(response, &own, sizeof own, "response", &self->error);
}

ehdrom_status ehdrom_respond(ehdrom_contact *self, ehdrom_response *response) {
    ehd_status status = begin(self, "stationary response", "ehdrom_solve or ehdrom_start");

    if (!status) status = respond(self, response);
    return library_end(self, status);
}
