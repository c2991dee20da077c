/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/physics/grid_choice.h"

#include "common/algebra/rounding.h"
#include "common/physics/film_formulas.h"

#include <math.h>

/* Limits from which the default grid of a kind of contact follows. H is the isoviscous film. At X =
 * sqrt(2 H) the undeformed gap equals this film. */
typedef struct grid_rule {
    double coarsest;     // step, unless the film is thick; finer steps are 1/2, 1/4 ... of this
                         // step
    double thick;        // for thick films the step is doubled while step/sqrt(2 H) is at most this
    double around;       // largest step/sqrt(2 H); a step of FINEST_AROUND is always allowed
    double steps;        // largest step, divided by the width of the inlet, H^(2/3)
    double inlet_effect; // largest effect of the missing inlet on the central film
    double load_effect;  // largest effect of the load beyond the domain on the central film
    double far_terms;    // largest size, at x_min, of the terms that the far field omits
    double shortest;     // smallest -x_min
    double longest;      // largest -x_min that inlet_effect and load_effect may require
    double sides;        // y_max over -x_min
} grid_rule;

/* Limits for line contacts, measured at 192 contacts (docs/history.md, default-grid). M was 1 to
 * 2000 and L 0 to 25, with Barus' law incompressible and Roelands' law compressible. The errors are
 * measured against solutions with a long inlet, in the limit of small steps. The error of H_c is at
 * most 0.9 % (wanted: 1 %), the error of H_m at most 1.2 % (wanted: 3 %). With four times the step
 * the error of H_m exceeds 3 % (M = 240, L = 0). With the next shorter inlet the error of H_c is
 * 1.6 % (M = 1). */
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
/* Limits for point contacts with an open boundary, measured at 55 contacts, M from 1 to 1000, L 0
 * to 25 (docs/history.md, default-grid). The error of H_c is at most 0.6 %, the error of H_m at
 * most 1.0 %. With the next shorter domain the error of H_c is 0.7 to 1.8 % at M of 1 to 3. With
 * twice the step the error of H_c is 1.5 to 4 % if the spike lies at the centre (M of 5 to 10, L
 * from 10 on), and the error of H_m is 8 % at M = 100, L = 0. With .steps = 0.6, at M = 100 and
 * 300, L = 0, the films on twice the step are so inaccurate that the error estimate of H_m
 * fails. */
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
/* Limits for point contacts with zero pressure at the border of the grid. From M = 10 on the error
 * of H_c is at most 0.8 %, the error of H_m at most 2.5 %. With twice the step the error of H_m is
 * 10 % (M = 20, L = 0). With the next shorter domain the error of H_c is 1.1 % (M = 10, L = 0) and
 * 1.2 % (M = 14, L = 0). Below M = 10, at small L, the error of the films is inversely proportional
 * to the length of the domain. No domain is then long enough: the error is 1.5, 5 and 25 % at M =
 * 7, 5 and 3. At the sides, Y = y_max, the exits lie at X = 0.21 y_max. */
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

/* Smallest step that the limit `around` may require, half widths. This step also resolves spikes at
 * the centre (README.md, Default grid; test_grid_choice.c, points_with_the_far_field). */
static const double FINEST_AROUND = 0.0625;

static const grid_rule *rule_of(const ehd_contact *contact) {
    if (contact->kind->dimensions == 1) return &line_rule;
    return contact->grid.boundary == BOUNDARY_OPEN ? &open_rule : &zero_rule;
}

/* Returns the integral of gap/(gap + film)^3 from minus infinity to -start. Up to a factor this
 * integral is the viscous pressure at -start in an inlet with the gap of the dry contact (Grubin).
 * It is computed by the midpoint rule in t, with X = -start/s and s = 1 - t^2. */
static double grubin_integral(const ehd_contact *contact, double film, double start) {
    double sum = 0;

    for (int i = 0; i < INLET_INTERVALS; i++) {
        const double t = (i + 0.5) / INLET_INTERVALS, s = 1 - t * t;
        const double gap = contact->kind->dry_gap(&contact->grid.shape, start / s),
                     whole = gap + film;
        sum += gap / (whole * whole * whole) * start / (s * s) * 2 * t;
    }
    return sum / INLET_INTERVALS;
}

/* Returns the relative change of the film if the load beyond a domain is missing.
 *
 * A point contact has far-field pressures lambda S(phi)/r^3 (README.md, far field). The domain ends
 * at -length upstream and at 3/4 length on either side. Beyond the domain these pressures carry the
 * load 1.66 lambda/length. Within the domain the pressures are lower too, by a solution that grows
 * with r^0.162. The load lost within the domain is 0.925 times the load beyond the domain.
 *
 * For a line contact the load of the inlet, -int X dP, is missing. With dP/dX = lambda/H^2 and H =
 * X^2/2 this load is 2 lambda/length^2.
 *
 * M is proportional to the load, and the load also changes the unit of H: H is proportional to
 * M^(-2/3) (lines: 1/M) times the film in units of the radius. This change of the unit is
 * subtracted. */
static double load_effect(const ehd_contact *contact, double length) {
    const contact_kind *kind = contact->kind;
    const double moes_L = contact_moes_L(contact);
    const contact_shape *shape = &contact->grid.shape;
    const bool line = kind->dimensions == 1;
    const double change = difference_distance(); // of ln M
    const double moes_M = contact->moes_M, lambda = contact->lambda / kind->load;
    const double thicker = log(kind->central_film(shape, moes_M * exp(-change), moes_L) /
                               kind->central_film(shape, moes_M * exp(change), moes_L)) /
                           (2 * change);

    if (line) return 2 * lambda * fmax(thicker - 1, 0) / (length * length);
    return 1.66 * 1.925 * lambda * (thicker - 2. / 3) / length;
}

/* Returns the relative change of the film if the viscous pressure that is built up upstream of a
 * domain is missing. `all` is the grubin_integral up to X = -1. The film follows the viscous
 * pressure with the exponent 8/11 (Ertel and Grubin). */
static double pressure_effect(const ehd_contact *contact, double film, double all, double length) {
    return 8. / 11 * grubin_integral(contact, film, length) / all;
}

/* Returns (2 film/r^2)^2 at r = length. This is the size of the terms that the far field omits in a
 * gap r^2/2 + film. */
static double omitted_terms(double film, double length) {
    const double part = 2 * film / (length * length);
    return part * part;
}

static double central_film(const ehd_contact *contact) {
    return contact->kind->central_film(&contact->grid.shape, contact->moes_M,
                                       contact_moes_L(contact));
}

/* Returns the next length in the sequence 1.5, 2, 3, 4, 6, 8, 12, ... */
static double next_length(double length) {
    return length * (fmod(log2(length), 1) == 0 ? 1.5 : 4. / 3);
}

/* Returns the shortest inlet length for which three errors are below the limits of the contact's
 * grid_rule: the terms that the far field omits (far_terms), the missing load (load_effect) and the
 * missing viscous pressure (inlet_effect). From rule->longest on, only far_terms is checked. */
static double inlet_length(const ehd_contact *contact) {
    const grid_rule *rule = rule_of(contact);
    const double film = central_film(contact), all = grubin_integral(contact, film, 1);
    double length = rule->shortest;

    while (omitted_terms(film, length) > rule->far_terms ||
           (length < rule->longest &&
            (load_effect(contact, length) > rule->load_effect ||
             pressure_effect(contact, film, all, length) > rule->inlet_effect)))
        length = next_length(length);
    return length;
}

/* Returns y_max. With an open boundary the gap at the sides equals the gap at the sides of a
 * circle's domain. With zero pressure at the border, a wide ellipse has the same distance from its
 * edge to the sides as a circle, in half widths along the entrainment, but at least half of b
 * (README.md, Default grid). */
static double sides_needed(const grid_rule *rule, double length, const contact_shape *shape) {
    const double of_circle = rule->sides * length, k = shape->ellipticity;

    if (rule == &open_rule) return of_circle / sqrt(shape->gap_across);
    return k > 1 ? fmax(1.5, 1 + (of_circle - 1) / k) : of_circle;
}

/* Returns how many whole steps cover a length. Ignores round-off of up to 1e-6 steps. */
static double whole_steps(double length, double step) {
    return ceil(length / step - 1e-6);
}

/* Returns x_max, rounded up to a whole number of steps. The distance from the exit to x_max is at
 * least a fourth of x_max. Behind a rigid parabola the exit lies at 0.475 sqrt(2 H) (lines). Beside
 * a point contact the exit follows the exit ray of the far field. */
static double end_needed(const contact_shape *shape, double film, double y_max, double step) {
    const double thick = 0.475 * sqrt(2 * film);
    const double beside = isnan(y_max) ? 0 : shape->ellipticity * y_max / -tan(shape->far.exit);
    // The exit ray of a circle has an error of 2e-5. The subtraction of 0.01 prevents ceil from
    // rounding such an error up to a whole half width.
    const double end = fmax(2, ceil(4. / 3 * fmax(thick, beside) - 0.01));

    return step * whole_steps(end, step);
}

/* Returns H at the centre for constant viscosity. For a narrow ellipse the result is the geometric
 * mean of two estimates, neither of which was made for narrow ellipses. For k of 0.05 and 0.2, M of
 * 0.1 to 100, their ratio to the true film is:
 * - estimate for the cold start: 1.4 to 20,
 * - fit for wide ellipses: 0.25 to 1.3,
 * - geometric mean: 1.2 to 2.7. */
static double isoviscous_film(const ehd_contact *contact) {
    const contact_shape *shape = &contact->grid.shape;
    const double k = shape->ellipticity, M = contact->moes_M;
    const double start = contact->kind->central_film(shape, M, 0);

    if (k >= 1) return start;
    return sqrt(start * film_nijenbanning_ellipse(M, 0, k * k / shape->gap_across) /
                pow(1.5 * M * shape->compliance, 2. / 3));
}

/* Returns the step. The step follows from the isoviscous film, because a lubricant of higher L has
 * a thicker film, but a narrower spike. For an ellipse narrower than k = 1/2 the step is
 * proportional to the square root of k, because its cells are wider than long, in half widths. At k
 * of 0.1 and 0.2, M of 1 and 100, L = 0, the error of H_m is 17 and 14 % with the step of wide
 * ellipses, 6 and 3 % with half of this step, and 1 % with a quarter. */
static double step_needed(const grid_rule *rule, double isoviscous, const contact_shape *shape) {
    const double around = sqrt(2 * isoviscous);
    const double narrow = fmin(sqrt(2 * shape->ellipticity), 1); // 1 for lines and points
    const double widest = narrow * fmin(rule->steps * pow(isoviscous, 2. / 3),
                                        fmax(narrow * rule->around * around, FINEST_AROUND));
    double step = rule->coarsest;

    while (2 * step <= rule->thick * around)
        step *= 2;
    while (step > widest)
        step /= 2;
    return step;
}

double grid_inlet_effect(const ehd_contact *contact, double length) {
    const double film = central_film(contact);

    if (length <= 1) return INFINITY;
    if (rule_of(contact) == &open_rule) return omitted_terms(film, length);
    return pressure_effect(contact, film, grubin_integral(contact, film, 1), length) +
           load_effect(contact, length);
}

/* Returns the extent with an inlet of this length. */
static grid_extent extent_of(const ehd_contact *contact, double length) {
    const contact_shape *shape = &contact->grid.shape;
    const grid_rule *rule = rule_of(contact);
    const double y_max = sides_needed(rule, length, shape);
    const double step = step_needed(rule, isoviscous_film(contact), shape);

    return (grid_extent){.x_min = -length,
                         .x_max = end_needed(shape, central_film(contact), y_max, step),
                         .step = step,
                         .y_max = y_max};
}

grid_extent grid_extent_needed(const ehd_contact *contact) {
    return extent_of(contact, inlet_length(contact));
}

grid_extent grid_extent_within(const ehd_contact *contact, double effect) {
    const double needed = inlet_length(contact);
    double length = rule_of(contact)->shortest;

    while (length < needed && !(grid_inlet_effect(contact, length) <= effect))
        length = next_length(length);
    return extent_of(contact, length);
}

void grid_extent_join(grid_extent *self, const grid_extent *other) {
    self->x_min = fmin(self->x_min, other->x_min);
    self->x_max = fmax(self->x_max, other->x_max);
    self->step = fmin(self->step, other->step);
    self->y_max = fmax(self->y_max, other->y_max); // NaN if both values are NaN
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
