/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Traction of solutions and of accepted states. */
#include "common/physics/traction.h"

#include "common/time/frame.h"
#include "romrun/library/internal.h"

#include <math.h>

/* The contact of the last solution or accepted state in its own frame, sliding, and its scalars there.
 * `sliding`: u1 - u2 over the reference's mean speed. */
static void take_state(ehd_contact *contact, contact_scalars *scalars, const ehdrom_contact *self,
                       const contact_frame *frame, double sliding) {
    if (self->last == LAST_SOLVED) {
        *contact = self->solved;
    } else {
        frame_contact(contact, frame, &self->reference);
        // whatever the mean speed, which may be 0
        contact->far_speed = 1 / frame->half_width;
    }
    contact->grid = *online_grid(self->model->online); // a scene may leave it to the model
    contact->slide_roll = sliding;
    *scalars = self->scalars;
    scalars->load /= frame->load;
    scalars->exit_position /= frame->half_width;
}

/* By the model's few nodes where it has them, else from the fields. */
static ehd_status find_traction(contact_traction *found, ehdrom_contact *self,
                                const ehd_contact *contact, const contact_scalars *scalars) {
    const bool solved = self->last == LAST_SOLVED,
               few_nodes = online_has_traction(self->model->online);
    ehd_status status = EHD_OK;

    if (few_nodes && solved) {
        *found = online_traction(self->solver, contact);
    } else if (few_nodes) {
        const march_solver in_time = online_march(self->in_time);
        *found = in_time.traction(in_time.self, contact, scalars);
    } else {
        status = library_fields(self);
        if (!status) *found = contact_traction_of(contact, self->pressure, self->film, scalars);
    }
    return status;
}

static ehd_status slide(ehdrom_contact *self, double sliding, ehdrom_traction *traction) {
    const bool solved = self->last == LAST_SOLVED;
    const contact_frame unity = {.load = 1, .speed = 1, .half_width = 1, .hertz_pressure = 1};
    const contact_frame frame =
        solved || self->last == LAST_NONE ? unity : online_transient_frame(self->in_time);
    const ehd_contact *reference = solved ? &self->solved : &self->reference;
    const unit_factors *units = solved ? &self->solved_units : &self->reference_units;
    ehd_contact contact;
    contact_scalars scalars;
    contact_traction found;

    if (self->last == LAST_NONE || isnan(self->scalars.load))
        return ehd_fail(&self->error, EHD_INTERNAL,
                        "traction: found no solution and no step since the state was restored, "
                        "expected one before");
    if (isnan(reference->half_width))
        return ehd_fail(&self->error, EHD_DATA,
                        "traction: found moes.M and moes.L, expected physical.load and the others");
    const double own_sliding = reference->slide_roll * frame.speed * units->speed;
    if (isnan(sliding)) sliding = own_sliding;
    if (traction_thins_flow(reference) &&
        !(fabs(sliding - own_sliding) <= 1e-9 * fabs(own_sliding)))
        return ehd_fail(&self->error, EHD_DATA,
                        "sliding: found %g, expected %g: with lubricant.shear.in_film a film is of "
                        "one sliding",
                        sliding, own_sliding);
    if (!isfinite(sliding))
        return ehd_fail(&self->error, EHD_DATA,
                        "sliding: found %g and no slide_roll, expected a speed, or slide_roll set",
                        sliding);
    take_state(&contact, &scalars, self, &frame, sliding / units->speed);
    ehd_status status = find_traction(&found, self, &contact, &scalars);
    if (status) return status;
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
        .largest_shear_stress = found.largest_stress * units->pressure};
    return library_give(traction, &own, sizeof own, "traction", &self->error);
}

ehdrom_status ehdrom_slide(ehdrom_contact *self, double sliding, ehdrom_traction *traction) {
    ehd_status status = library_begin(self);

    if (status) return (ehdrom_status)status;
    const locale_t before = library_enter();
    status = slide(self, sliding, traction);
    library_leave(before);
    return (ehdrom_status)status;
}
