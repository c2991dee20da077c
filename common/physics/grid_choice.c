/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/physics/grid_choice.h"

#include "common/physics/film_formulas.h"

#include <math.h>

/* What a kind of contact needs. */
typedef struct grid_rule {
    double coarsest; // step of films that are not thick; finer ones are halves of it
    double thick;    // of thick films the step is twice, four times ... that, up to this part of
                     // sqrt(2 H), where the gap is as large as the isoviscous film
    double around;   // step over sqrt(2 H) at most
    double steps;    // step over the width of the inlet, the power 2/3 of the film
    double inlet_effect; // on the central film, at most
    double load_effect;  // of the load that is carried beyond the domain, the same
    double far_terms;    // of which the far field is without, at the domain's beginning
    double shortest;     // -x_min
    double longest;      // -x_min, by the effects
    double sides;        // y_max over -x_min
} grid_rule;

/* Measured at 192 lines, M 1 to 2000, L 0 to 25, Barus incompressible and Roelands compressible,
 * against long inlets and steps without end (scenes/studies/default-grid): H_c is within 0.9 %
 * and H_m within 1.2 %, 0.4 and 0.7 % from M = 2 on, where 1 and 3 % are wanted. With twice the
 * step H_m is within 1.7 %, with four times it is not within 3 % (M = 240, L = 0); with the next
 * shorter inlet H_c is off by 1.6 % (M = 1) and 0.96 % (M = 70). Up to M = 10 twice the coarsest
 * step would do, with 0.88 % at M = 2. */
static const grid_rule line_rule = {
    .coarsest = 0.02,
    .thick = 1. / 50,
    .around = INFINITY,
    .steps = 0.3,
    .inlet_effect = 0.002,
    .load_effect = 0.01,
    .far_terms = INFINITY,
    .shortest = 1.5,
    .longest = INFINITY,
    .sides = NAN,
};
/* Point contacts with an open boundary, 55 from M = 1 to 1000, L 0 to 25 (the same study): H_c is
 * within 0.6 % and H_m within 1.0 %; with the next shorter domain H_c is off by 0.7 to 1.8 % at M
 * of 1 to 3, with twice the step by 1.5 to 4 % where the spike lies at the centre (M of 5 to 10, L
 * from 10 on) and H_m by 8 % at M = 100, L = 0. With steps of 0.6 the films of M = 100 and 300, L = 0,
 * on twice the step are so far off that the estimate of H_m fails. */
static const grid_rule open_rule = {
    .coarsest = 0.25,
    .thick = 1. / 12,
    .around = 1. / 12,
    .steps = 0.42,
    .inlet_effect = INFINITY,
    .load_effect = INFINITY,
    .far_terms = 0.0125,
    .shortest = 3,
    .longest = INFINITY,
    .sides = 0.75,
};
/* With zero pressure around the grid H_c is within 0.8 % and H_m within 2.5 % from M = 10 on; with
 * twice the step H_m is off by 10 % (M = 20, L = 0), with the next shorter domain H_c by 1.1 % (M
 * = 10, L = 0) and 1.2 % (M = 14, L = 0). Below, at small L, their films go with one over the
 * length, 1.5, 5 and 25 % off at M = 7, 5 and 3, and no domain is long enough. Exits far from the
 * middle lie at 0.21 of y_max. */
static const grid_rule zero_rule = {
    .coarsest = 0.125,
    .thick = 1. / 12,
    .around = INFINITY,
    .steps = 0.6,
    .inlet_effect = 0.005,
    .load_effect = 0.008,
    .far_terms = 0.0125,
    .shortest = 4,
    .longest = 16,
    .sides = 0.75,
};

// step that resolves the surroundings of any contact, and spikes at its centre
static const double FINEST_AROUND = 0.0625;

static const grid_rule *rule_of(const ehd_contact *contact) {
    if (contact->kind->dimensions == 1) return &line_rule;
    return contact->grid.boundary == BOUNDARY_OPEN ? &open_rule : &zero_rule;
}

/* The integral of gap/(gap + film)^3 from minus infinity to -start: the viscous pressure of an inlet
 * with the gap of the dry contact (Grubin), but for a factor. X = -start/s, s = 1 - t^2, midpoint
 * rule in t. */
static double grubin_integral(const ehd_contact *contact, double film, double start) {
    const int num_intervals = 400;
    double sum = 0;

    for (int i = 0; i < num_intervals; i++) {
        const double t = (i + 0.5) / num_intervals, s = 1 - t * t;
        const double gap = contact->kind->dry_gap(&contact->grid.shape, start / s),
                     whole = gap + film;
        sum += gap / (whole * whole * whole) * start / (s * s) * 2 * t;
    }
    return sum / num_intervals;
}

/* Length of the domain beyond and within which no more load is lacking than moves the film by a part.
 *
 * Of the pressures of the far field of a point contact, lambda S(phi)/r^3 (README.md, far field),
 * 1.66 lambda/length is the load beyond a domain three quarters as wide to either side as long, and
 * pressures within are lower by a solution that goes with r^0.162, 0.925 times as much. Of the inlet
 * of a line contact the load is -int X dP: of dP/dX = lambda/H^2, H = X^2/2, 2 lambda/length^2.
 *
 * M is proportional to the load and the film in Hertz units to M^(-2/3) (lines: 1/M) times that in
 * units of the radius. */
static double load_length(const ehd_contact *contact, double moes_L, double effect) {
    const contact_kind *kind = contact->kind;
    const contact_shape *shape = &contact->grid.shape;
    const bool line = kind->dimensions == 1;
    const double change = 1e-3, moes_M = contact->moes_M, lambda = contact->lambda / kind->load;
    const double thicker = log(kind->central_film(shape, moes_M * exp(-change), moes_L) /
                               kind->central_film(shape, moes_M, moes_L)) /
                           change;

    if (line) return sqrt(2 * lambda * fmax(thicker - 1, 0) / effect);
    return 1.66 * 1.925 * lambda * (thicker - 2. / 3) / effect;
}

/* Distance of the inlet's beginning: the first of 1.5, 2, 3, 4, 6, 8, 12, ... before which less of
 * the viscous pressure is built up than moves the film by more than allowed, and the load that is
 * lacking does not. The film follows the pressure with the exponent 8/11 (Ertel and Grubin). And what
 * the far field leaves out, c^2/r^4, of H = r^2/2 + c, is as allowed. */
static double inlet_length(const ehd_contact *contact, const grid_rule *rule, double moes_L,
                           double film) {
    const double left_out = sqrt(2 * film / sqrt(rule->far_terms)); // length where it is as allowed
    const double all = grubin_integral(contact, film, 1);
    const double for_load = load_length(contact, moes_L, rule->load_effect);
    double length = rule->shortest;

    while (length < left_out ||
           (length < rule->longest &&
            (length < for_load ||
             8. / 11 * grubin_integral(contact, film, length) > rule->inlet_effect * all)))
        length *= fmod(log2(length), 1) == 0 ? 1.5 : 4. / 3;
    return length;
}

/* y_max. With the far field around as far out as the gap at the sides of a circle; else around a wide
 * ellipse as far from its edge as around a circle, in half widths along, and at least half of b
 * (README.md, Default grid). */
static double sides_needed(const grid_rule *rule, double length, const contact_shape *shape) {
    const double of_circle = rule->sides * length, k = shape->ellipticity;

    if (rule == &open_rule) return of_circle / sqrt(shape->gap_across);
    return k > 1 ? fmax(1.5, 1 + (of_circle - 1) / k) : of_circle;
}

/* Whole steps of a length, of which rounding may leave a trifle more. */
static double whole_steps(double length, double step) {
    return ceil(length / step - 1e-6);
}

/* x_max in whole steps, before which the exit lies by a fourth of x_max at least. Of a rigid parabola
 * the exit is at 0.475 sqrt(2 H) (lines); beside a point contact it follows the ray of the far field. */
static double end_needed(const contact_shape *shape, double film, double y_max, double step) {
    const double thick = 0.475 * sqrt(2 * film);
    const double beside = isnan(y_max) ? 0 : shape->ellipticity * y_max / -tan(shape->far.exit);
    const double end = fmax(2, ceil(4. / 3 * fmax(thick, beside) - 0.01)); // 2e-5 of a circle's ray

    return step * whole_steps(end, step);
}

/* H of the centre with a constant viscosity. Of a narrow ellipse the mean, in logarithms, of two fits,
 * neither made for it: the one that is its start has 1.4 to 20 times its film, that of wide ones a quarter
 * to 1.3 times, and the mean 1.2 to 2.7 times (k of 0.05 and 0.2, M of 0.1 to 100). */
static double isoviscous_film(const ehd_contact *contact) {
    const contact_shape *shape = &contact->grid.shape;
    const double k = shape->ellipticity, M = contact->moes_M;
    const double start = contact->kind->central_film(shape, M, 0);

    if (k >= 1) return start;
    return sqrt(start * film_nijenbanning_ellipse(M, 0, k * k / shape->gap_across) /
                pow(1.5 * M * shape->compliance, 2. / 3));
}

/* The step. A lubricant of higher L has a thicker film, but a narrower spike. Of an ellipse narrower
 * than k = 1/2 it goes with the square root of k: cells are longer across, in half widths. At k of 0.1
 * and 0.2, M of 1 and 100, L = 0, steps of the ordinary size have H_m 17 and 14 % off, half of them 6 and
 * 3 %, a quarter 1 %. */
static double step_needed(const grid_rule *rule, double isoviscous, const contact_shape *shape) {
    const double around = sqrt(2 * isoviscous);
    const double narrow = fmin(sqrt(2 * shape->ellipticity), 1); // of lines and points 1
    const double widest = narrow * fmin(rule->steps * pow(isoviscous, 2. / 3),
                                        fmax(narrow * rule->around * around, FINEST_AROUND));
    double step = rule->coarsest;

    while (2 * step <= rule->thick * around)
        step *= 2;
    while (step > widest)
        step /= 2;
    return step;
}

grid_extent grid_extent_needed(const ehd_contact *contact) {
    const contact_kind *kind = contact->kind;
    const contact_shape *shape = &contact->grid.shape;
    const grid_rule *rule = rule_of(contact);
    // L where the Hertz pressure follows from it, else what would give the Hertz pressure
    const double moes_L = contact->alpha_p_H / kind->alpha_p_H(shape, contact->moes_M, 1);
    const double film = kind->central_film(shape, contact->moes_M, moes_L);
    const double length = inlet_length(contact, rule, moes_L, film);
    const double y_max = sides_needed(rule, length, shape);
    const double step = step_needed(rule, isoviscous_film(contact), shape);

    return (grid_extent){.x_min = -length,
                         .x_max = end_needed(shape, film, y_max, step),
                         .step = step,
                         .y_max = y_max};
}

void grid_extent_join(grid_extent *self, const grid_extent *other) {
    self->x_min = fmin(self->x_min, other->x_min);
    self->x_max = fmax(self->x_max, other->x_max);
    self->step = fmin(self->step, other->step);
    self->y_max = fmax(self->y_max, other->y_max); // NaN where both are
}

ehd_grid grid_choose(const grid_extent *given, const grid_extent *needed, const ehd_grid *like) {
    ehd_grid of = *like;
    double x_min = isnan(given->x_min) ? needed->x_min : given->x_min;
    const double x_max = isnan(given->x_max) ? needed->x_max : given->x_max;
    const double y_max = isnan(given->y_max) ? needed->y_max : given->y_max;
    double step = isnan(given->step) ? needed->step : given->step;
    const double steps = whole_steps(x_max - x_min, step);

    if (isnan(given->step))
        step = (x_max - x_min) / steps;
    else if (isnan(given->x_min))
        x_min = x_max - steps * step;
    const size_t beside = isnan(y_max) ? 0 : (size_t)whole_steps(y_max, step * like->shape.cell);
    of.half = like->half && beside > 0;
    return grid_like(&of, x_min, step, (size_t)steps + 1, of.half ? beside + 1 : 2 * beside + 1);
}
