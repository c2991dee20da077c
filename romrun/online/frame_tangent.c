/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/online/frame_tangent.h"

/* Number of doubles in frame_quantities. All of its members are doubles. */
enum { NUM_QUANTITIES = sizeof(frame_quantities) / sizeof(double) };
_Static_assert(sizeof(frame_quantities) == NUM_QUANTITIES * sizeof(double), "doubles alone");

static frame_quantities quantities_at(reduced_tangent *tangent, const reduced_change *change,
                                      double distance, const reduced_equations *equations,
                                      const contact_frame *frame, const ehd_contact *reference) {
    const reduced_quantities own = reduced_tangent_quantities(tangent, change, distance, equations);

    return (frame_quantities){.scalars = frame_to_reference(&own.scalars, frame, reference),
                              .peak_pressure = own.peak_pressure * frame->hertz_pressure,
                              .half_width = frame->half_width};
}

ehd_status frame_linearise(reduced_tangent *tangent, const reduced_state *state,
                           const contact_frame *at, const frame_equations *equations,
                           bool exit_at_node, ehd_error *error) {
    ehd_contact contact;
    const reduced_equations found = equations->in_frame(equations->context, at, &contact, 0);

    return reduced_tangent_at(tangent, state, &found, exit_at_node, error);
}

ehd_status frame_tangent(frame_quantities *derivatives, reduced_change *change,
                         reduced_tangent *tangent, const contact_frame beside[2], double distance,
                         const ehd_contact *reference, const frame_equations *equations,
                         ehd_error *error) {
    ehd_contact contacts[2];
    reduced_equations sides[2];
    frame_quantities found[2];

    for (int i = 0; i < 2; i++)
        sides[i] = equations->in_frame(equations->context, &beside[i], &contacts[i], i);
    const ehd_status status = reduced_tangent_along(change, tangent, sides, distance, error);
    if (status) return status;
    for (int i = 0; i < 2; i++)
        found[i] =
            quantities_at(tangent, change, (i - 0.5) * distance, &sides[i], &beside[i], reference);
    const double *before = (const double *)&found[0], *behind = (const double *)&found[1];
    for (size_t k = 0; k < NUM_QUANTITIES; k++)
        ((double *)derivatives)[k] = (behind[k] - before[k]) / distance;
    return EHD_OK;
}

ehd_status frame_tangent_slow(contact_scalars *found, double *bound, reduced_tangent *tangent,
                              const reduced_change *change, const contact_frame *at,
                              const contact_frame beside[2], double distance,
                              const ehd_contact *reference, const frame_equations *equations,
                              ehd_error *error) {
    ehd_contact contact, contacts[2];
    const reduced_equations here = equations->in_frame(equations->context, at, &contact, 0);
    const reduced_motion motion = {.contacts = contacts,
                                   .film_scale = {beside[0].film_scale / at->film_scale,
                                                  beside[1].film_scale / at->film_scale},
                                   .half_width = {beside[0].half_width / at->half_width,
                                                  beside[1].half_width / at->half_width},
                                   .distance = distance};
    reduced_change slow;

    for (int i = 0; i < 2; i++)
        equations->in_frame(equations->context, &beside[i], &contacts[i], i);
    const ehd_status status =
        reduced_tangent_slow(&slow, bound, tangent, change, here.contact, &motion, error);
    if (status) return status;
    // The difference over a distance of 1 is the derivative, because approach and load are linear
    // in the coordinates. Only the small load beyond a point contact's grid is not linear.
    const frame_quantities behind = quantities_at(tangent, &slow, 0.5, &here, at, reference);
    const frame_quantities before = quantities_at(tangent, &slow, -0.5, &here, at, reference);
    *bound *= at->film_scale;
    *found = (contact_scalars){.rigid_approach =
                                   behind.scalars.rigid_approach - before.scalars.rigid_approach,
                               .load = behind.scalars.load - before.scalars.load};
    return EHD_OK;
}
