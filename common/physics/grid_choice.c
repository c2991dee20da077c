/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/physics/grid_choice.h"

#include <math.h>

/* What a kind of contact needs. */
typedef struct grid_rule {
    double coarsest;          // step; finer ones are halves of it
    double steps;             // step over the width of the inlet, the power 2/3 of the film
    double inlet_effect;      // on the central film, at most
    double shortest, longest; // -x_min, between these
    double sides, behind;     // y_max and x_max over -x_min, x_max at least 2
} grid_rule;

/* Measured at 192 lines, M 1 to 2000, L 0 to 25, Barus incompressible and Roelands compressible,
 * against long inlets and steps without end (scenes/studies/default-grid): H_c is within 0.9 %
 * and H_m within 1.2 %, 0.4 and 0.7 % from M = 2 on, where 1 and 3 % are wanted. With twice the
 * step H_m is within 1.7 %, with four times it is not within 3 % (M = 240, L = 0); with the next
 * shorter inlet H_c is off by 1.6 % (M = 1) and 0.96 % (M = 70). Up to M = 10 twice the coarsest
 * step would do, with 0.88 % at M = 2.
 * Point contacts (the same, M 20 to 300): within 0.7 and 2 %, with twice the step 10 % of H_m (M
 * = 20, L = 0); at M = 10 and 5, L = 0, H_c is off by 1.5 and 6 %, where longer domains cost
 * much. Exits far from the middle lie at 0.21 of y_max. */
static const grid_rule line_rule = {0.02, 0.3, 0.002, 1.5, 64, NAN, 0};
static const grid_rule point_rule = {0.125, 0.6, 0.005, 4, 16, 0.75, 0.25};

/* The integral of gap/(gap + film)^3 from minus infinity to -start: the viscous pressure of an inlet
 * with the gap of the dry contact (Grubin), but for a factor. X = -start/s, s = 1 - t^2, midpoint
 * rule in t. */
static double grubin_integral(const contact_kind *kind, double film, double start) {
    const int num_intervals = 400;
    double sum = 0;

    for (int i = 0; i < num_intervals; i++) {
        const double t = (i + 0.5) / num_intervals, s = 1 - t * t;
        const double gap = kind->dry_gap(start / s), whole = gap + film;
        sum += gap / (whole * whole * whole) * start / (s * s) * 2 * t;
    }
    return sum / num_intervals;
}

/* Distance of the inlet's beginning: the first of 1.5, 2, 3, 4, 6, 8, 12, ... before which less of
 * the viscous pressure is built up than moves the film by more than allowed. The film follows it
 * with the exponent 8/11 (Ertel and Grubin). */
static double inlet_length(const contact_kind *kind, const grid_rule *rule, double film) {
    const double all = grubin_integral(kind, film, 1);
    double length = rule->shortest;

    while (length < rule->longest &&
           8. / 11 * grubin_integral(kind, film, length) > rule->inlet_effect * all)
        length *= fmod(log2(length), 1) == 0 ? 1.5 : 4. / 3;
    return length;
}

grid_extent grid_extent_needed(const ehd_contact *contact) {
    const contact_kind *kind = contact->kind;
    const grid_rule *rule = kind->dimensions > 1 ? &point_rule : &line_rule;
    // L where the Hertz pressure follows from it, else what would give the Hertz pressure
    const double moes_L = contact->alpha_p_H / kind->alpha_p_H(contact->moes_M, 1);
    const double film = kind->central_film(contact->moes_M, moes_L);
    const double isoviscous = kind->central_film(contact->moes_M, 0);
    const double length = inlet_length(kind, rule, film);
    // a lubricant of higher L has a thicker film, but a narrower spike
    const double widest = rule->steps * pow(isoviscous, 2. / 3);
    double step = rule->coarsest;

    while (step > widest)
        step /= 2;
    return (grid_extent){.x_min = -length,
                         .x_max = fmax(2, rule->behind * length),
                         .step = step,
                         .y_max = rule->sides * length};
}

void grid_extent_join(grid_extent *self, const grid_extent *other) {
    self->x_min = fmin(self->x_min, other->x_min);
    self->x_max = fmax(self->x_max, other->x_max);
    self->step = fmin(self->step, other->step);
    self->y_max = fmax(self->y_max, other->y_max); // NaN where both are
}

/* Whole steps of a length, of which rounding may leave a trifle more. */
static double whole_steps(double length, double step) {
    return ceil(length / step - 1e-6);
}

ehd_grid grid_choose(const grid_extent *given, const grid_extent *needed, bool half,
                     ehd_discretization discretization) {
    double x_min = isnan(given->x_min) ? needed->x_min : given->x_min;
    const double x_max = isnan(given->x_max) ? needed->x_max : given->x_max;
    const double y_max = isnan(given->y_max) ? needed->y_max : given->y_max;
    double step = isnan(given->step) ? needed->step : given->step;
    const double steps = whole_steps(x_max - x_min, step);

    if (isnan(given->step))
        step = (x_max - x_min) / steps;
    else if (isnan(given->x_min))
        x_min = x_max - steps * step;
    const size_t beside = isnan(y_max) ? 0 : (size_t)whole_steps(y_max, step);
    half = half && beside > 0;
    return grid_of(x_min, step, (size_t)steps + 1, half ? beside + 1 : 2 * beside + 1, half,
                   discretization);
}
