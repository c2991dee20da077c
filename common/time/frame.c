/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/time/frame.h"

#include "common/algebra/rounding.h"
#include "common/settings/scene.h"

#include <math.h>

contact_frame frame_at(const contact_kind *kind, double time, const double *values,
                       double approach) {
    contact_frame frame = {.time = time,
                           .load = values[VARY_LOAD],
                           .speed = values[VARY_SPEED],
                           .radius = values[VARY_RADIUS],
                           .modulus = values[VARY_MODULUS],
                           .approach = approach};

    // a/a_ref is computed for a circle: the shape of an ellipse would multiply both half widths by
    // the same number
    frame.half_width = kind->half_width(&shape_round, frame.load, frame.radius, frame.modulus) /
                       kind->half_width(&shape_round, 1, 1, 1);
    frame.hertz_pressure =
        frame.load > 0 ? frame.load / pow(frame.half_width, kind->dimensions) : 0;
    frame.film_scale = frame.half_width * frame.half_width / frame.radius;
    return frame;
}

bool frame_is_valid(const contact_frame *frame) {
    return isfinite(frame->time) && isfinite(frame->path) && isfinite(frame->speed) &&
           frame->load > 0 && frame->radius > 0 && frame->modulus > 0 && frame->half_width > 0 &&
           frame->hertz_pressure > 0 && frame->film_scale > 0 && isfinite(frame->film_scale);
}

contact_frame frame_with_load(const contact_kind *kind, const contact_frame *frame, double load) {
    const double values[NUM_VARY] = {[VARY_LOAD] = load,
                                     [VARY_SPEED] = frame->speed,
                                     [VARY_RADIUS] = frame->radius,
                                     [VARY_MODULUS] = frame->modulus};
    contact_frame scaled = frame_at(kind, frame->time, values, frame->approach);

    scaled.path = frame->path;
    return scaled;
}

contact_frame frame_of_load(const contact_kind *kind, const contact_frame *frame, double ratio) {
    return ratio == 1 ? *frame : frame_with_load(kind, frame, ratio * frame->load);
}

static double approach_shift(const contact_frame *frame, const ehd_contact *reference) {
    return reference->kind->approach_shift(frame->half_width, reference->approach_length);
}

static contact_closure approach_closure(const contact_frame *frame, const ehd_contact *reference) {
    return (contact_closure){.by_approach = 1,
                             .by_load = approach_shift(frame, reference) / reference->kind->load,
                             .value = frame->approach / frame->film_scale};
}

void frame_contact(ehd_contact *contact, const contact_frame *frame, const ehd_contact *reference) {
    const contact_kind *kind = reference->kind;
    const contact_shape *shape = &reference->grid.shape;
    double width = frame->half_width;

    *contact = *reference;
    contact->lambda *= frame->radius * frame->radius / (frame->hertz_pressure * width * width);
    contact->entrainment = frame->speed / width;
    contact->far_speed = contact->entrainment;
    contact->hertz_pressure *= frame->hertz_pressure;
    contact->alpha_p_H *= frame->hertz_pressure;
    // Moes numbers of the stationary contact with the same lambda U
    contact->moes_M =
        fmin(kind->moes_M(shape, contact->lambda * fabs(contact->entrainment)), MAX_MOES_M);
    contact->moes_L = reference->moes_L * frame->hertz_pressure *
                      kind->alpha_p_H(shape, reference->moes_M, 1) /
                      kind->alpha_p_H(shape, contact->moes_M, 1);
    contact->half_width *= width;
    contact->radius *= frame->radius;
    contact->load *= frame->load;
    contact->speed *= frame->speed;
    contact->closure = isnan(frame->approach) ? contact_load_closure(contact->kind)
                                              : approach_closure(frame, reference);
}

double frame_stretch(const contact_frame *now, const contact_frame *then) {
    return now->half_width / then->half_width;
}

double frame_shift(const contact_frame *now, const contact_frame *then) {
    return (now->path - then->path) / then->half_width;
}

double frame_grid_step(const contact_frame *frame, const ehd_grid *grid) {
    return grid->step / fmax(fabs(frame->speed / frame->half_width), 1);
}

double frame_shortest_step(const contact_frame *frame, const ehd_grid *grid) {
    return 0.25 * frame_grid_step(frame, grid);
}

double frame_step_share(const contact_frame *frame, double step, const ehd_grid *grid) {
    // a sixteenth of the grid step: with a quarter of the grid step, films drifted when the fixed
    // time step was a fifth of frame_grid_step
    return fmin(16 * step / frame_grid_step(frame, grid), 1);
}

double frame_most_growth(const contact_kind *kind, const contact_shape *shape) {
    const double widest = kind->half_width(shape, 2.25, 1, 1),
                 own = kind->half_width(shape, 1, 1, 1);

    return widest / own - 1 - ROUNDING;
}

double frame_film_ratio(const contact_frame *now, const contact_frame *then) {
    return then->film_scale / now->film_scale;
}

frame_rates frame_rates_between(const contact_frame *now, const contact_frame *before) {
    const double step = now->time - before->time;
    const double load = fabs(log(now->half_width / before->half_width));

    if (step == 0) return (frame_rates){0, 0};
    return (frame_rates){.all = (load + fabs(now->speed - before->speed)) / step,
                         .load = load / step};
}

closing_gap frame_closing_gap(const contact_frame *now, const contact_frame *before,
                              const ehd_contact *reference, double end) {
    const double growth = log(now->radius / before->radius) / (now->time - before->time);
    closing_gap gap = {.begin = INFINITY};
    ehd_contact contact;

    if (!(growth > 0)) return gap;
    frame_contact(&contact, now, reference);
    const double speed = fabs(contact.entrainment);
    const bool line = contact.kind->dimensions == 1;
    const double closes = growth * end / 2 - speed; // -D(X^2/2)/DT divided by X, at X = `end`
    gap.begin = fmax(2 * speed / growth, 1);
    gap.load = 3. / 8 * contact.lambda * growth / contact.kind->load * (line ? 1 / gap.begin : 2);
    if (closes > 0)
        gap.beyond =
            8. / 3 * contact.lambda * closes / (end * contact.kind->load) * (line ? 1 / end : 2);
    return gap;
}

contact_scalars frame_to_reference(const contact_scalars *current, const contact_frame *frame,
                                   const ehd_contact *reference) {
    contact_scalars scalars = *current;
    double shift = approach_shift(frame, reference) * current->load;

    scalars.central_film_thickness *= frame->film_scale;
    scalars.minimum_film_thickness *= frame->film_scale;
    scalars.minimum_position *= frame->half_width;
    scalars.central_pressure *= frame->hertz_pressure;
    scalars.rigid_approach = (current->rigid_approach + shift) * frame->film_scale;
    scalars.exit_position *= frame->half_width;
    scalars.load *= frame->load;
    return scalars;
}

contact_scalars frame_from_reference(const contact_scalars *scalars, const contact_frame *frame,
                                     const ehd_contact *reference) {
    contact_scalars current = *scalars;

    current.central_film_thickness /= frame->film_scale;
    current.minimum_film_thickness /= frame->film_scale;
    current.minimum_position /= frame->half_width;
    current.central_pressure /= frame->hertz_pressure;
    current.exit_position /= frame->half_width;
    current.load /= frame->load;
    current.rigid_approach = scalars->rigid_approach / frame->film_scale -
                             approach_shift(frame, reference) * current.load;
    return current;
}

contact_traction frame_traction_to_reference(contact_traction current, const contact_frame *frame) {
    current.friction *= frame->load;
    current.rolling_resistance *= frame->load;
    current.rolling_moment *= frame->load * frame->half_width;
    current.power *= frame->load * frame->half_width; // the power contains a speed in half widths
    current.mean_stress *= frame->hertz_pressure;
    current.largest_stress *= frame->hertz_pressure;
    return current;
}
