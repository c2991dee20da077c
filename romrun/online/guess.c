/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Starts from the trained solutions, and the trained range. */
#include "romrun/model/start_shift.h"
#include "romrun/online/reduced_solver.h"

#include <lapacke.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum { NUM_NEIGHBOURS = 24, MAX_STARTS = 8 };

/* Coordinates of a training solution beside a contact: differences of ln M, of half of ln(1 + alpha
 * p_H), since the film follows powers of M and of the viscosity's rise, and what the lubricant was
 * more viscous and denser than the contact's is at the same Hertz pressure, as logarithms. */
enum { ALONG_M, ALONG_PRESSURE, ALONG_VISCOSITY, ALONG_DENSITY, NUM_COORDINATES };

typedef struct neighbour {
    size_t state;
    double distance, away[NUM_COORDINATES];
} neighbour;

/* A contact among the training solutions. */
typedef struct wanted_place {
    double moes_M, alpha_p_H;
    const ehd_lubricant *lubricant; // NULL: any
} wanted_place;

static double viscosity_coordinate(double rise) {
    return 0.5 * log1p(rise);
}

/* How much another lubricant a state is of; 0 where that is not known. False: the contact's
 * lubricant has no viscosity at the state's Hertz pressure. */
static bool compare_lubricants(double away[NUM_COORDINATES], const lubricant_rises *there,
                               const wanted_place *here, double alpha_p_H) {
    if (!here->lubricant || isnan(there->of[RISE_VISCOSITY])) return true;
    const lubricant_rises same =
        lubricant_rises_at(here->lubricant, alpha_p_H / here->lubricant->alpha);
    if (isnan(same.of[RISE_VISCOSITY])) return false;
    away[ALONG_VISCOSITY] = viscosity_coordinate(there->of[RISE_VISCOSITY]) -
                            viscosity_coordinate(same.of[RISE_VISCOSITY]);
    away[ALONG_DENSITY] = there->of[RISE_DENSITY] - same.of[RISE_DENSITY];
    return true;
}

/* False as above. */
static bool place_state(neighbour *place, const reduced_states *states, size_t state,
                        const wanted_place *here) {
    const double there = states->alpha_p_H[state];
    double squares = 0;

    *place = (neighbour){.state = state};
    place->away[ALONG_M] = log(states->moes_M[state]) - log(here->moes_M);
    place->away[ALONG_PRESSURE] =
        viscosity_coordinate(there) - viscosity_coordinate(here->alpha_p_H);
    if (!compare_lubricants(place->away, &states->rises[state], here, there)) return false;
    for (int c = 0; c < NUM_COORDINATES; c++)
        squares += place->away[c] * place->away[c];
    place->distance = sqrt(squares);
    return true;
}

enum { ANY_EFFECT = -1 }; // also of states of which no effect of the grid is known

/* Of the contact's own lubricant, or one that is not known. */
static bool is_own(const neighbour *self) {
    const double same = 1e-9;

    return fabs(self->away[ALONG_VISCOSITY]) < same && fabs(self->away[ALONG_DENSITY]) < same;
}

/* Lists the nearest stationary states farther away than `beyond`, of those of which an effect of
 * the grid is known, or of the contact's own lubricant; returns their number. */
static size_t nearest_states(neighbour *nearest, const reduced_states *states,
                             const wanted_place *here, double beyond, int effect, bool own) {
    size_t count = 0;

    for (size_t s = 0; s < states->num_states; s++) {
        neighbour fresh;
        if (!states->stationary[s]) continue;
        if (effect != ANY_EFFECT && isnan(states->effects[s].of[effect])) continue;
        if (!place_state(&fresh, states, s, here) || (own && !is_own(&fresh))) continue;
        if (!(fresh.distance > beyond) ||
            (count == NUM_NEIGHBOURS && fresh.distance >= nearest[count - 1].distance))
            continue;
        size_t i = count < NUM_NEIGHBOURS ? count++ : count - 1;
        for (; i > 0 && nearest[i - 1].distance > fresh.distance; i--)
            nearest[i] = nearest[i - 1];
        nearest[i] = fresh;
    }
    return count;
}

/* A fit through neighbours: numbers of them and of the terms 1, x, y, x^2, xy, y^2 in M and
 * pressure, and the largest sum of the weights' magnitudes, above which the fit extrapolates. */
typedef struct neighbour_fit {
    size_t max_neighbours, num_terms;
    double max_weight;
} neighbour_fit;

enum { MAX_TERMS = 6 + 2 };

/* The best first. Half the quadratic fit's neighbours would lie in two rows of a regular plan. */
static const neighbour_fit FITS[] = {{NUM_NEIGHBOURS, 6, 1.5}, {6, 3, 2}};

/* The terms of a neighbour; those of the lubricant are linear, and only along coordinates in which
 * neighbours differ. Returns their number. */
static size_t fill_terms(double terms[MAX_TERMS], const neighbour *self, size_t num_terms,
                         const bool *differs) {
    const double x = self->away[ALONG_M], y = self->away[ALONG_PRESSURE];
    const double of_place[] = {1, x, y, x * x, x * y, y * y};

    memcpy(terms, of_place, num_terms * sizeof(double));
    for (int c = ALONG_VISCOSITY; c < NUM_COORDINATES; c++)
        if (differs[c]) terms[num_terms++] = self->away[c];
    return num_terms;
}

/* Weights of the neighbours in a moving least squares fit, evaluated at the wanted contact. False
 * where they do not determine it, which the sum of the weights shows even where rounding hides it
 * from the factorisation, or where the fit would extrapolate. `differs` [NUM_COORDINATES]. */
static bool fit_weights(double *weights, const neighbour *nearest, size_t count,
                        const neighbour_fit *fit, const bool *differs) {
    const double slack = 1e-6;
    double normal[MAX_TERMS * MAX_TERMS] = {0}, unit[MAX_TERMS] = {1}, magnitude = 0, sum = 0;
    double terms[NUM_NEIGHBOURS][MAX_TERMS], strength[NUM_NEIGHBOURS];
    size_t num = fit->num_terms;

    for (size_t i = 0; i < count; i++) {
        num = fill_terms(terms[i], &nearest[i], fit->num_terms, differs);
        strength[i] = 1 / (nearest[i].distance * nearest[i].distance + 1e-6);
        for (size_t p = 0; p < num; p++)
            for (size_t q = 0; q < num; q++)
                normal[num * p + q] += strength[i] * terms[i][p] * terms[i][q];
    }
    if (count < num) return false;
    if (LAPACKE_dposv_work(LAPACK_COL_MAJOR, 'L', (int)num, 1, normal, (int)num, unit, (int)num))
        return false;
    for (size_t i = 0; i < count; i++) {
        weights[i] = 0;
        for (size_t p = 0; p < num; p++)
            weights[i] += strength[i] * unit[p] * terms[i][p];
        magnitude += fabs(weights[i]);
        sum += weights[i];
    }
    return magnitude < fit->max_weight && fabs(sum - 1) < slack;
}

/* state = sum of weights[i] times the states given. */
static void combine_states(reduced_state *state, const reduced_model *model,
                           const neighbour *nearest, const double *weights, size_t count) {
    const reduced_states *states = &model->states;
    size_t n = model->num_unknowns;
    size_t central = grid_central_line(&model->grid) / grid_width(&model->grid);

    state->exit_offset = NAN;
    memset(state->coordinates, 0, n * sizeof(double));
    for (size_t i = 0; i < count; i++) {
        const double *source = states->coordinates + nearest[i].state * n;
        for (size_t j = 0; j < n; j++)
            state->coordinates[j] += weights[i] * source[j];
    }
    for (size_t l = 0; l < model->band.num_lines; l++) {
        const band_line *line = &model->band.lines[l];
        double exit = 0;
        for (size_t i = 0; i < count; i++)
            exit += weights[i] * (double)states->exit[nearest[i].state * states->num_lines + l];
        exit = fmin(fmax(exit, (double)line->min_exit), (double)line->max_exit);
        if (l == central) state->exit = (size_t)lround(exit);
        if (state->exits) state->exits[l] = (size_t)lround(exit);
    }
}

/* The coordinates of the lubricant in which neighbours differ from each other. */
static bool find_differences(bool differs[NUM_COORDINATES], const neighbour *nearest,
                             size_t count) {
    const double same = 1e-9;
    bool any = false;

    for (int c = ALONG_VISCOSITY; c < NUM_COORDINATES; c++) {
        differs[c] = false;
        for (size_t i = 1; i < count; i++)
            differs[c] = differs[c] || fabs(nearest[i].away[c] - nearest[0].away[c]) > same;
        any = any || differs[c];
    }
    return any;
}

/* Weights of the best fit through `count` neighbours, at least one, first with terms of the
 * lubricants where these differ; returns how many it takes, the nearest one alone where no fit
 * serves. */
static size_t best_weights(double *weights, const neighbour *nearest, size_t count) {
    const bool none[NUM_COORDINATES] = {false};
    bool differs[NUM_COORDINATES];

    if (find_differences(differs, nearest, count) &&
        fit_weights(weights, nearest, count, &FITS[0], differs))
        return count;
    for (size_t f = 0; f < sizeof FITS / sizeof *FITS; f++) {
        size_t used = count < FITS[f].max_neighbours ? count : FITS[f].max_neighbours;
        if (fit_weights(weights, nearest, used, &FITS[f], none)) return used;
    }
    weights[0] = 1;
    return 1;
}

void reduced_guess(reduced_state *state, const reduced_model *model, double moes_M,
                   double alpha_p_H, const ehd_lubricant *lubricant) {
    const wanted_place here = {moes_M, alpha_p_H, lubricant};
    neighbour nearest[NUM_NEIGHBOURS];
    double weights[NUM_NEIGHBOURS];
    size_t states[NUM_NEIGHBOURS];

    // of its own lubricant first: how others differ is more than linear
    size_t count = nearest_states(nearest, &model->states, &here, -1, ANY_EFFECT, true);
    if (!fit_weights(weights, nearest, count, &FITS[0], (const bool[NUM_COORDINATES]){false})) {
        count = nearest_states(nearest, &model->states, &here, -1, ANY_EFFECT, false);
        count = best_weights(weights, nearest, count);
    }
    combine_states(state, model, nearest, weights, count);
    for (size_t i = 0; i < count; i++)
        states[i] = nearest[i].state;
    start_shift_apply(state->coordinates, model, states, weights, count);
}

/* The trained solution that is nearest but for `skipped` others, alone. False: there are no more. */
static bool start_from_state(reduced_state *state, const reduced_model *model,
                             const wanted_place *here, size_t skipped) {
    neighbour nearest[NUM_NEIGHBOURS];
    double one = 1;

    if (skipped >= nearest_states(nearest, &model->states, here, -1, ANY_EFFECT, false))
        return false;
    combine_states(state, model, &nearest[skipped], &one, 1);
    return true;
}

ehd_status reduced_solve_from_training(reduced_info *info, reduced_state *state,
                                       reduced_solver *solver, const reduced_model *model,
                                       const ehd_contact *contact, ehd_error *error) {
    const wanted_place here = {contact->moes_M, contact->alpha_p_H, &contact->lubricant};

    reduced_guess(state, model, here.moes_M, here.alpha_p_H, here.lubricant);
    ehd_status status = reduced_solve(info, state, solver, contact, NULL, error);
    for (size_t i = 0; i < MAX_STARTS && !status && info->status == EHD_NOT_CONVERGED; i++) {
        const size_t iterations = info->iterations;
        const double seconds = info->seconds;
        if (!start_from_state(state, model, &here, i)) break;
        status = reduced_solve(info, state, solver, contact, NULL, error);
        info->iterations += iterations;
        info->seconds += seconds;
    }
    return status;
}

void reduced_neighbour(reduced_state *state, const reduced_model *model, double moes_M,
                       double alpha_p_H, const ehd_lubricant *lubricant) {
    const wanted_place here = {moes_M, alpha_p_H, lubricant};
    const double same = 1e-9;
    neighbour nearest[NUM_NEIGHBOURS];
    double one = 1;

    if (nearest_states(nearest, &model->states, &here, same, ANY_EFFECT, false) > 0)
        combine_states(state, model, nearest, &one, 1);
    else
        reduced_guess(state, model, moes_M, alpha_p_H, lubricant);
}

// ---- what the grid does

/* One effect at a contact, by a fit through the states of which it is known: of its size's
 * logarithm, since effects go with powers of M and of the viscosity's rise, with the sign of the
 * nearest one. Where it is infinite there, nothing can be said of the contact either. */
static double effect_at(const reduced_states *states, const wanted_place *here, int effect) {
    const double rounding = 1e-12; // of a film
    neighbour nearest[NUM_NEIGHBOURS];
    double weights[NUM_NEIGHBOURS], log_size = 0;
    size_t count = nearest_states(nearest, states, here, -1, effect, false), finite = 0;

    if (count == 0) return NAN;
    const double closest = states->effects[nearest[0].state].of[effect];
    if (isinf(closest)) return INFINITY;
    for (size_t i = 0; i < count; i++)
        if (isfinite(states->effects[nearest[i].state].of[effect])) nearest[finite++] = nearest[i];
    count = best_weights(weights, nearest, finite);
    for (size_t i = 0; i < count; i++)
        log_size +=
            weights[i] * log(fmax(fabs(states->effects[nearest[i].state].of[effect]), rounding));
    return copysign(exp(log_size), closest);
}

film_effects reduced_effects(const reduced_model *model, double moes_M, double alpha_p_H,
                             const ehd_lubricant *lubricant) {
    const wanted_place here = {moes_M, alpha_p_H, lubricant};
    film_effects effects;

    for (int e = 0; e < NUM_EFFECTS; e++)
        effects.of[e] = effect_at(&model->states, &here, e);
    return effects;
}

// ---- trained range

void trained_place(double place[2], double moes_M, double alpha_p_H) {
    const double least = 1e-3; // below, the viscosity rises by less than a thousandth

    place[0] = log(moes_M);
    place[1] = log(fmax(alpha_p_H, least));
}

typedef struct point {
    double M, pressure;
} point;

static int compare_points(const void *a, const void *b) {
    const point *p = a, *q = b;

    if (p->M != q->M) return p->M < q->M ? -1 : 1;
    return (p->pressure > q->pressure) - (p->pressure < q->pressure);
}

static double turn(point a, point b, point c) {
    return (b.M - a.M) * (c.pressure - a.pressure) - (b.pressure - a.pressure) * (c.M - a.M);
}

/* Convex hull by the monotone chain, counter-clockwise; `hull` has room for num + 1 points. */
static size_t convex_hull(point *hull, point *points, size_t num) {
    size_t count = 0;

    qsort(points, num, sizeof *points, compare_points);
    for (size_t i = 0; i < num; i++) {
        while (count >= 2 && turn(hull[count - 2], hull[count - 1], points[i]) <= 0)
            count--;
        hull[count++] = points[i];
    }
    size_t lower = count + 1;
    for (size_t i = num - 1; i-- > 0;) {
        while (count >= lower && turn(hull[count - 2], hull[count - 1], points[i]) <= 0)
            count--;
        hull[count++] = points[i];
    }
    return count > 1 ? count - 1 : count;
}

/* From a corner of the hull to the next one. */
typedef struct hull_edge {
    point start, direction; // of length 1
    double length;
} hull_edge;

struct trained_range {
    hull_edge *edges; // [count], counter-clockwise, in units of `extent`
    size_t count;
    point low, high; // of all points, in units of `extent`: rounding makes slivers of lines, which
                     // have no end
    point extent;
    double slack; // how far outside of the hull still counts as inside, in units of the extent
    double max_rate;
};

trained_range *trained_range_free(trained_range *self) {
    if (self) {
        free(self->edges);
        free(self);
    }
    return NULL;
}

static point place_of(double moes_M, double alpha_p_H) {
    double place[2];

    trained_place(place, moes_M, alpha_p_H);
    return (point){place[0], place[1]};
}

static point in_units(point place, const trained_range *self) {
    return (point){place.M / self->extent.M, place.pressure / self->extent.pressure};
}

static void find_extent(trained_range *self, const reduced_states *states) {
    point low = {INFINITY, INFINITY}, high = {-INFINITY, -INFINITY};
    bool stationary = true;

    for (size_t s = 0; s < states->num_states; s++) {
        const point here = place_of(states->moes_M[s], states->alpha_p_H[s]);
        low.M = fmin(low.M, here.M);
        high.M = fmax(high.M, here.M);
        low.pressure = fmin(low.pressure, here.pressure);
        high.pressure = fmax(high.pressure, here.pressure);
        self->max_rate = fmax(self->max_rate, states->rate[s]);
        stationary = stationary && states->stationary[s];
    }
    self->extent.M = high.M > low.M ? high.M - low.M : 1;
    self->extent.pressure = high.pressure > low.pressure ? high.pressure - low.pressure : 1;
    self->low = in_units(low, self);
    self->high = in_units(high, self);
    // training points count as inside, and so does what lies between the few states that are kept
    // of a trajectory, which is a curve
    self->slack = stationary ? 1e-9 : 2e-3;
}

static hull_edge edge_between(point a, point b) {
    double length = hypot(b.M - a.M, b.pressure - a.pressure), scale = 1 / fmax(length, 1e-300);

    return (hull_edge){a, {(b.M - a.M) * scale, (b.pressure - a.pressure) * scale}, length};
}

trained_range *trained_range_create(const reduced_model *model) {
    const reduced_states *states = &model->states;
    size_t num = states->num_states;
    trained_range *self = calloc(1, sizeof *self);
    point *points = malloc((num + 1) * sizeof *points), *hull = malloc((num + 2) * sizeof *hull);

    if (self) self->edges = malloc((num + 2) * sizeof *self->edges);
    if (self && self->edges && points && hull) {
        find_extent(self, states);
        for (size_t s = 0; s < num; s++)
            points[s] = in_units(place_of(states->moes_M[s], states->alpha_p_H[s]), self);
        self->count = num ? convex_hull(hull, points, num) : 0;
        for (size_t i = 0; i < self->count; i++)
            self->edges[i] = edge_between(hull[i], hull[(i + 1) % self->count]);
    } else {
        self = trained_range_free(self);
    }
    free(points);
    free(hull);
    return self;
}

/* Distance of a point to the right of an edge or, of a hull of two points, beyond its ends. */
static double outside_edge(const hull_edge *edge, point wanted, bool line) {
    point from = {wanted.M - edge->start.M, wanted.pressure - edge->start.pressure};
    double across = from.M * edge->direction.pressure - from.pressure * edge->direction.M;
    double along = from.M * edge->direction.M + from.pressure * edge->direction.pressure;

    return line ? fmax(across, along - edge->length) : across;
}

const char *trained_range_check(const trained_range *self, double moes_M, double alpha_p_H,
                                double rate) {
    const double rate_slack = 1.05, min_rate = 1e-3;
    const point wanted = in_units(place_of(moes_M, alpha_p_H), self), low = self->low,
                high = self->high;
    bool line = self->count <= 2;
    double outside = fmax(fmax(low.M - wanted.M, wanted.M - high.M),
                          fmax(low.pressure - wanted.pressure, wanted.pressure - high.pressure));

    if (self->count < 2) outside = INFINITY;
    for (size_t i = 0; i < self->count; i++) {
        double here = outside_edge(&self->edges[i], wanted, line);
        outside = here > outside ? here : outside;
    }
    if (!(outside <= self->slack)) return "outside of the trained range of M and alpha p_H";
    if (rate > fmax(rate_slack * self->max_rate, min_rate))
        return "a contact that changes faster than any in training";
    return NULL;
}
