/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Traction of solutions and of accepted states. */
#include "common/physics/traction.h"
#include "common/algebra/rounding.h"

#include "common/program/arena.h"
#include "common/time/frame.h"
#include "romrun/library/internal.h"

#include <math.h>
#include <stdlib.h>

/* The state whose traction is computed. */
typedef struct slid_state {
    bool solved;           // true: a stationary solution; false: a state of a transient contact
    bool attempted;        // true: a step that is not accepted yet
    contact_frame frame;   // frame of this state
    contact_scalars there; // scalars in the reference frame
} slid_state;

static slid_state last_state(const ehdrom_contact *self) {
    const contact_frame unity = {.load = 1, .speed = 1, .half_width = 1, .hertz_pressure = 1};
    const bool in_time = self->last == LAST_IN_TIME;

    return (slid_state){.solved = self->last == LAST_SOLVED,
                        .frame = in_time ? online_transient_frame(self->in_time) : unity,
                        .there = self->scalars};
}

static slid_state attempted_state(const ehdrom_contact *self) {
    return (slid_state){
        .attempted = true, .frame = online_attempt_frame(self->in_time), .there = self->stepped};
}

/* Returns the sliding contact of a state and its scalars, both in the state's own frame. `sliding`:
 * u1 - u2 divided by the reference's mean speed. */
static void take_state(ehd_contact *contact, contact_scalars *scalars, const ehdrom_contact *self,
                       const slid_state *of, double sliding) {
    const contact_frame *frame = &of->frame;

    if (of->solved) {
        *contact = self->solved;
        *scalars = of->there;
    } else {
        frame_contact(contact, frame, &self->reference);
        *scalars = frame_from_reference(&of->there, frame, &self->reference);
        // speeds are scaled by the reference's mean speed, because the present one may be 0
        contact->far_speed = 1 / frame->half_width;
    }
    contact->grid = *library_grid(self); // a scene may leave the grid to the model
    contact->slide_roll = sliding;
}

/* Computes the traction as a sum over few nodes if the model has nodes for traction, otherwise from
 * the fields. */
static ehd_status find_traction(contact_traction *found, ehdrom_contact *self, const slid_state *of,
                                const ehd_contact *contact, const contact_scalars *scalars) {
    const bool few_nodes = online_has_traction(self->model->online);
    ehd_status status = EHD_OK;

    if (!of->solved && of->there.load == 0) { // the bodies are apart
        *found = (contact_traction){0};
    } else if (few_nodes && of->solved) {
        *found = online_traction(self->solver, contact);
    } else if (few_nodes && of->attempted) {
        *found = online_attempt_traction(self->in_time, contact, scalars);
    } else if (few_nodes) {
        const march_solver in_time = online_march(self->in_time);
        *found = in_time.traction(in_time.self, contact, scalars);
    } else if (of->attempted) {
        status = ehd_fail(&self->error, EHD_DATA,
                          "traction: found a model without nodes for it, expected one that "
                          "deimselect of this version has made");
    } else {
        status = library_fields(self);
        if (!status) *found = contact_traction_of(contact, self->pressure, self->film, scalars);
    }
    return status;
}

/* Estimates the error of the friction of a stationary solution. Returns NaN for other states. If
 * the caller's struct has no member for the estimate, returns NaN at no cost. */
static double indicated_friction(ehdrom_contact *self, const slid_state *of,
                                 const ehd_contact *contact, double friction,
                                 const ehdrom_traction *traction) {
    const bool wanted = traction && traction->size >= sizeof *traction;

    return wanted && of->solved ? online_indicate_friction(self->solver, contact, friction) : NAN;
}

static const unit_factors *units_of(const ehdrom_contact *self, const slid_state *of) {
    return of->solved ? &self->solved_units : &self->reference_units;
}

/* Checks the caller's u1 - u2, in the caller's units. Replaces NaN by the value of the settings.
 * EHD_DATA: no sliding is known, or the sliding is not allowed. */
static ehd_status find_sliding(double *sliding, ehdrom_contact *self, const slid_state *of) {
    const ehd_contact *reference = of->solved ? &self->solved : &self->reference;

    if (isnan(reference->half_width))
        return ehd_fail(&self->error, EHD_DATA,
                        "traction: found moes.M and moes.L, expected physical.load and the others");
    const double own_sliding = reference->slide_roll * of->frame.speed * units_of(self, of)->speed;
    if (isnan(*sliding)) *sliding = own_sliding;
    if (traction_thins_flow(reference) &&
        !(fabs(*sliding - own_sliding) <= ROUNDING * fabs(own_sliding)))
        return ehd_fail(&self->error, EHD_DATA,
                        "sliding: found %g, expected %g: with lubricant.shear.in_film a film is of "
                        "one sliding",
                        *sliding, own_sliding);
    if (!isfinite(*sliding))
        return ehd_fail(&self->error, EHD_DATA,
                        "sliding: found %g and no slide_roll, expected a speed, or slide_roll set",
                        *sliding);
    if (*sliding != 0 && !*self->settings.lubricant.shear.law)
        return ehd_fail(&self->error, EHD_DATA,
                        "sliding: found %g without lubricant.shear.law, expected a law", *sliding);
    return EHD_OK;
}

static ehd_status slide(ehdrom_contact *self, const slid_state *of, double sliding,
                        ehdrom_traction *traction) {
    const contact_frame frame = of->frame;
    const unit_factors *units = units_of(self, of);
    ehd_contact contact;
    contact_scalars scalars;
    contact_traction found;
    ehd_status status = find_sliding(&sliding, self, of);

    if (status) return status;
    take_state(&contact, &scalars, self, of, sliding / units->speed);
    status = find_traction(&found, self, of, &contact, &scalars);
    if (status) return status;
    const double indicated = indicated_friction(self, of, &contact, found.friction, traction);
    found = frame_traction_to_reference(found, &frame);
    const ehdrom_traction own = {
        .friction_coefficient = found.coefficient,
        .friction_force = found.friction * units->load,
        .rolling_resistance = found.rolling_resistance * units->load,
        .rolling_moment = found.rolling_moment * units->load * units->length,
        .power_loss =
            (found.friction * sliding + 2 * found.rolling_resistance * frame.speed * units->speed) *
            units->load,
        .mean_shear_stress = found.mean_stress * units->pressure,
        .largest_shear_stress = found.largest_stress * units->pressure,
        .indicated_deviation_friction = indicated};
    status = library_give(traction, &own, sizeof own, "traction", &self->error);
    const double judged = traction_judged_coefficient(found.friction, frame.load);
    if (status || !isgreater(judged, possible_friction)) return status;
    return ehd_fail(&self->error, EHD_UNTRUSTED, "traction: found %s", impossible_friction);
}

ehdrom_status ehdrom_slide(ehdrom_contact *self, double sliding, ehdrom_traction *traction) {
    ehd_status status = library_begin(self);

    if (!status && (self->last == LAST_NONE || isnan(self->scalars.load)))
        status = ehd_fail(&self->error, EHD_INTERNAL,
                          "traction: found no solution and no step since the state was restored, "
                          "expected one before");
    if (!status) {
        const slid_state of = last_state(self);
        status = slide(self, &of, sliding, traction);
    }
    return library_end(self, status);
}

ehdrom_status ehdrom_slide_step(ehdrom_contact *self, double sliding, ehdrom_traction *traction) {
    ehd_status status = library_begin(self);

    if (!status && !self->can_accept)
        status = ehd_fail(&self->error, EHD_INTERNAL,
                          "traction: found no step that converged, expected ehdrom_step before");
    if (!status) {
        const slid_state of = attempted_state(self);
        status = slide(self, &of, sliding, traction);
    }
    return library_end(self, status);
}

// ---- stresses at all nodes

/* Computes the shear stresses on surface 1 and on surface 2, in units of the Hertz pressure, at the
 * nodes of library_grid. */
static ehd_status surface_stresses(double *on_1, double *on_2, ehdrom_contact *self,
                                   const slid_state *of, double sliding) {
    ehd_contact contact;
    contact_scalars scalars;
    ehd_status status = find_sliding(&sliding, self, of);

    if (!status) status = library_fields(self);
    if (status) return status;
    take_state(&contact, &scalars, self, of, sliding / units_of(self, of)->speed);
    contact_surface_stresses(on_1, on_2, &contact, self->pressure, self->film,
                             scalars.rigid_approach);
    return EHD_OK;
}

static ehd_status give_stresses(ehdrom_contact *self, double sliding, double *on_1, double *on_2) {
    const size_t num_nodes = library_grid(self)->num_nodes;
    const slid_state of = last_state(self);
    const double unit = units_of(self, &of)->pressure * of.frame.hertz_pressure;
    double *nodes = array_new(num_nodes, 2, sizeof *nodes);

    if (!nodes) return ehd_no_memory(&self->error, "shear stresses");
    const ehd_status status = surface_stresses(nodes, nodes + num_nodes, self, &of, sliding);
    if (!status) {
        library_give_field(on_1, nodes, unit, self);
        library_give_field(on_2, nodes + num_nodes, unit, self);
    }
    free(nodes);
    return status;
}

ehdrom_status ehdrom_shear_stresses(ehdrom_contact *self, double sliding, double *stress_1,
                                    double *stress_2) {
    ehd_status status = library_begin(self);

    if (!status && self->last == LAST_NONE)
        status = ehd_fail(&self->error, EHD_INTERNAL,
                          "shear stresses: found no solution, expected one before");
    if (!status) status = give_stresses(self, sliding, stress_1, stress_2);
    return library_end(self, status);
}
