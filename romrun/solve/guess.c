/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes initial states (starts) from the trained solutions. Also interpolates, between these
 * solutions, the estimated errors due to the full model's grid. */
#include "romrun/solve/guess.h"
#include "common/algebra/cholesky.h"
#include "common/algebra/rounding.h"
#include "romrun/model/start_shift.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* Largest number of trained states in a fit: four for each of the six terms of the fit
 * (README.md, Starts). */
enum { NUM_NEIGHBOURS = 24 };

/* Largest number of other starts that are tried after the first one. In 434 of 482 random scenes
 * inside the trained range of the lower region (scenes/studies/silent-failures, seed 42) the first
 * start leads to the solution. In 38 more scenes one of the next eleven starts leads to the
 * solution, and in 5 more scenes one of the twelve starts after these. A start that leads to no
 * solution takes 38 iterations (test_guess.c, goes_on_to_other_starts). */
enum { MAX_STARTS = 11 };

/* Coordinates of a trained solution relative to the contact to be solved: the differences of
 * - ln M (ALONG_M);
 * - ln(1 + alpha p_H) / 2 (ALONG_PRESSURE);
 * - viscosity_coordinate and the logarithm of the density, both at the same Hertz pressure
 *   (ALONG_VISCOSITY, ALONG_DENSITY);
 * - the scaled thinning of the flow (ALONG_THINNING, ALONG_GRADIENT).
 *
 * The coordinates are logarithms because the film follows powers of M and of the viscosity's
 * rise. */
enum {
    ALONG_M,
    ALONG_PRESSURE,
    ALONG_VISCOSITY,
    ALONG_DENSITY,
    ALONG_THINNING,
    ALONG_GRADIENT,
    NUM_COORDINATES
};

typedef struct neighbour {
    size_t state;
    double distance, away[NUM_COORDINATES];
} neighbour;

/* The contact to be solved, in the coordinates of the training solutions. */
typedef struct wanted_place {
    double along_M, along_pressure, along_thinning, along_gradient;
    const ehd_lubricant *lubricant; // NULL: the lubricant is not compared
} wanted_place;

static double viscosity_coordinate(double rise) {
    return 0.5 * log1p(rise);
}

/* Returns the coordinate of the thinning by sliding. With the factor 0.25 the least thinning and a
 * thinning that halves the film are as far apart as two loads of ratio ten. */
static double along_thinning(flow_thinning thinning) {
    return 0.25 * thinning_coordinate(thinning.sliding);
}

static double along_gradient(flow_thinning thinning) {
    return 0.25 * gradient_coordinate(thinning.gradient);
}

static wanted_place place_wanted(const contact_place *of) {
    return (wanted_place){log(of->moes_M), viscosity_coordinate(of->alpha_p_H),
                          along_thinning(of->thinning), along_gradient(of->thinning),
                          of->lubricant};
}

/* Finds the differences in lubricant between a state and the contact. If the state's lubricant is
 * not known, the differences stay 0. Returns false if the contact's lubricant has no viscosity at
 * the state's Hertz pressure. */
static bool compare_lubricants(double away[NUM_COORDINATES], const lubricant_rises *there,
                               const wanted_place *here, double alpha_p_H) {
    if (!here->lubricant || isnan(there->of[RISE_VISCOSITY])) return true;
    const double pressure = alpha_p_H / here->lubricant->alpha;
    const double viscosity = lubricant_rise_at(here->lubricant, RISE_VISCOSITY, pressure);
    if (isnan(viscosity)) return false;
    away[ALONG_VISCOSITY] =
        viscosity_coordinate(there->of[RISE_VISCOSITY]) - viscosity_coordinate(viscosity);
    away[ALONG_DENSITY] =
        there->of[RISE_DENSITY] - lubricant_rise_at(here->lubricant, RISE_DENSITY, pressure);
    return true;
}

static double distance_of(const neighbour *place) {
    double squares = 0;

    for (int c = 0; c < NUM_COORDINATES; c++)
        squares += place->away[c] * place->away[c];
    return sqrt(squares);
}

/* Returns the coordinates of a state relative to the contact, without a comparison of the
 * lubricants. */
static neighbour place_of_state(const reduced_states *states, size_t state,
                                const wanted_place *here) {
    neighbour place = {.state = state};

    place.away[ALONG_M] = log(states->moes_M[state]) - here->along_M;
    place.away[ALONG_PRESSURE] =
        viscosity_coordinate(states->alpha_p_H[state]) - here->along_pressure;
    place.away[ALONG_THINNING] = along_thinning(states->thinning[state]) - here->along_thinning;
    place.away[ALONG_GRADIENT] = along_gradient(states->thinning[state]) - here->along_gradient;
    place.distance = distance_of(&place);
    return place;
}

enum { ANY_EFFECT = -1 }; // nearest_states also lists states whose grid errors are not known

/* Checks whether the lubricant of a state is the lubricant of the contact, or is not known. */
static bool is_own(const neighbour *self) {
    return fabs(self->away[ALONG_VISCOSITY]) < ROUNDING &&
           fabs(self->away[ALONG_DENSITY]) < ROUNDING;
}

/* Checks whether a state may be used as a start: the state is stationary, or the model has no
 * stationary states (`any`). */
static bool is_start(const reduced_states *states, size_t state, bool any) {
    return any || states->stationary[state];
}

static bool has_stationary(const reduced_states *states) {
    for (size_t s = 0; s < states->num_states; s++)
        if (states->stationary[s]) return true;
    return false;
}

/* Lists the nearest stationary states that are farther away than `beyond`, and whose error estimate
 * `effect` due to the grid is known. Returns the number of these states. If `others` is not NULL,
 * lists only states with the contact's own lubricant, and sets *others if there are states with
 * other lubricants. */
static size_t nearest_states(neighbour *nearest, const reduced_states *states,
                             const wanted_place *here, double beyond, int effect, bool *others) {
    const bool any = !has_stationary(states);
    size_t count = 0;

    for (size_t s = 0; s < states->num_states; s++) {
        if (!is_start(states, s, any)) continue;
        if (effect != ANY_EFFECT && isnan(states->effects[s].of[effect])) continue;
        neighbour fresh = place_of_state(states, s, here);
        // the state is too far away even with the same lubricant, so the comparison of the
        // lubricants, which takes most of the time, is skipped
        if (count == NUM_NEIGHBOURS && fresh.distance >= nearest[count - 1].distance &&
            (!others || *others))
            continue;
        if (!compare_lubricants(fresh.away, &states->rises[s], here, states->alpha_p_H[s]))
            continue;
        fresh.distance = distance_of(&fresh);
        if (others && !is_own(&fresh)) {
            *others = true;
            continue;
        }
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

/* A fit through neighbours: largest number of neighbours; number of terms, taken from 1, x, y, x^2,
 * xy, y^2 with x along M and y along the pressure; and largest sum of the magnitudes of the
 * weights. If the sum is larger, the fit extrapolates. */
typedef struct neighbour_fit {
    size_t max_neighbours, num_terms;
    double max_weight;
} neighbour_fit;

enum { MAX_TERMS = 6 + NUM_COORDINATES - ALONG_VISCOSITY };

/* The fits, best first. If the quadratic fit had half as many neighbours, they would lie on only
 * two lines of a regular grid of training points. */
static const neighbour_fit FITS[] = {{NUM_NEIGHBOURS, 6, 1.5}, {6, 3, 2}};

/* Fits that include the coordinates of lubricant and thinning. They are used for neighbours that
 * differ in these coordinates. In 3000 scenes of three lubricants (README.md, Several lubricants) a
 * solution takes 3.49 iterations with the affine fit to 24 neighbours, and 4.80 without this
 * fit. */
static const neighbour_fit FITS_APART[] = {{NUM_NEIGHBOURS, 6, 2}, {NUM_NEIGHBOURS, 3, 2}};

enum { NUM_FITS = 2 };

/* Fills the terms of a neighbour and returns the number of terms. Lubricant and thinning have only
 * linear terms, one for each coordinate in which neighbours differ. */
static size_t fill_terms(double terms[MAX_TERMS], const neighbour *self, size_t num_terms,
                         const bool *differs) {
    const double x = self->away[ALONG_M], y = self->away[ALONG_PRESSURE];
    const double of_place[] = {1, x, y, x * x, x * y, y * y};

    memcpy(terms, of_place, num_terms * sizeof(double));
    for (int c = ALONG_VISCOSITY; c < NUM_COORDINATES; c++)
        if (differs[c]) terms[num_terms++] = self->away[c];
    return num_terms;
}

/* Computes weights of the neighbours in a moving least squares fit, evaluated at the wanted
 * contact. Returns false if the neighbours do not determine the fit, or if the fit would
 * extrapolate. Round-off may hide a singular fit from the factorisation; the sum of the weights
 * then differs from 1. `differs`, [NUM_COORDINATES]: coordinates in which neighbours differ. */
static bool fit_weights(double *weights, const neighbour *nearest, size_t count,
                        const neighbour_fit *fit, const bool *differs) {
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
    if (!cholesky_factorise(normal, num)) return false;
    cholesky_solve(unit, normal, num);
    for (size_t i = 0; i < count; i++) {
        weights[i] = 0;
        for (size_t p = 0; p < num; p++)
            weights[i] += strength[i] * unit[p] * terms[i][p];
        magnitude += fabs(weights[i]);
        sum += weights[i];
    }
    return magnitude < fit->max_weight && fabs(sum - 1) < ROUNDING;
}

/* Computes state = sum over i of weights[i] times states[i]. */
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

static bool do_differ(const neighbour *nearest, size_t count, int coordinate) {
    for (size_t i = 1; i < count; i++)
        if (fabs(nearest[i].away[coordinate] - nearest[0].away[coordinate]) > ROUNDING) return true;
    return false;
}

/* Finds the coordinates of lubricant and thinning in which neighbours differ. Returns whether there
 * is such a coordinate. */
static bool find_differences(bool differs[NUM_COORDINATES], const neighbour *nearest,
                             size_t count) {
    bool any = false;

    for (int c = ALONG_VISCOSITY; c < NUM_COORDINATES; c++) {
        differs[c] = do_differ(nearest, count, c);
        any = any || differs[c];
    }
    return any;
}

/* Finds the first fit that fit_weights accepts, and its weights. Returns the number of neighbours
 * that this fit uses. Returns 0 if no fit is accepted. */
static size_t first_fit(double *weights, const neighbour *nearest, size_t count,
                        const neighbour_fit fits[NUM_FITS], const bool *differs) {
    for (int f = 0; f < NUM_FITS; f++) {
        const size_t used = count < fits[f].max_neighbours ? count : fits[f].max_neighbours;
        if (fit_weights(weights, nearest, used, &fits[f], differs)) return used;
    }
    return 0;
}

/* Finds the weights of the best fit through `count` neighbours, where `count` is at least 1. If no
 * fit is accepted, the nearest neighbour alone is used. Returns the number of neighbours in use. */
static size_t best_weights(double *weights, const neighbour *nearest, size_t count) {
    const bool none[NUM_COORDINATES] = {false};
    bool differs[NUM_COORDINATES];
    size_t used = 0;

    if (find_differences(differs, nearest, count))
        used = first_fit(weights, nearest, count, FITS_APART, differs);
    if (used == 0) used = first_fit(weights, nearest, count, FITS, none);
    if (used > 0) return used;
    weights[0] = 1;
    return 1;
}

void reduced_guess(reduced_state *state, const reduced_model *model, contact_place place) {
    const wanted_place here = place_wanted(&place);
    neighbour nearest[NUM_NEIGHBOURS];
    double weights[NUM_NEIGHBOURS];
    size_t states[NUM_NEIGHBOURS];

    // first tries the states of the same lubricant, because the effect of a different lubricant is
    // not linear
    bool others = false;
    size_t count = nearest_states(nearest, &model->states, &here, -1, ANY_EFFECT, &others);
    const bool differs[NUM_COORDINATES] = {
        [ALONG_THINNING] = do_differ(nearest, count, ALONG_THINNING),
        [ALONG_GRADIENT] = do_differ(nearest, count, ALONG_GRADIENT)};
    if (!fit_weights(weights, nearest, count, &FITS[0], differs)) {
        if (others) count = nearest_states(nearest, &model->states, &here, -1, ANY_EFFECT, NULL);
        // the contact's lubricant has no viscosity at the pressure of any state: uses states of all
        // lubricants
        if (count == 0) {
            wanted_place of_any = here;
            of_any.lubricant = NULL;
            count = nearest_states(nearest, &model->states, &of_any, -1, ANY_EFFECT, NULL);
        }
        count = best_weights(weights, nearest, count);
    }
    combine_states(state, model, nearest, weights, count);
    for (size_t i = 0; i < count; i++)
        states[i] = nearest[i].state;
    start_shift_apply(state->coordinates, model, states, weights, count);
}

/* Sets the initial state to one trained solution: the nearest one after `skipped` nearer solutions.
 * Returns false if there is no such solution. */
static bool start_from_state(reduced_state *state, const reduced_model *model,
                             const wanted_place *here, size_t skipped) {
    neighbour nearest[NUM_NEIGHBOURS];
    double one = 1;

    if (skipped >= nearest_states(nearest, &model->states, here, -1, ANY_EFFECT, NULL))
        return false;
    combine_states(state, model, &nearest[skipped], &one, 1);
    return true;
}

static void add_effort(reduced_info *info, const reduced_info *before) {
    info->iterations += before->iterations;
    solve_seconds_add(&info->seconds, &before->seconds);
}

ehd_status reduced_solve_from_training(reduced_info *info, reduced_state *state,
                                       reduced_solver *solver, const reduced_model *model,
                                       const ehd_contact *contact, ehd_error *error) {
    const contact_place place = contact_place_of(contact);
    const wanted_place here = place_wanted(&place);

    reduced_guess(state, model, place);
    ehd_status status = reduced_solve(info, state, solver, contact, NULL, error);
    for (size_t i = 0; i < MAX_STARTS && !status && info->status == EHD_NOT_CONVERGED; i++) {
        const reduced_info before = *info;
        if (!start_from_state(state, model, &here, i)) break;
        status = reduced_solve(info, state, solver, contact, NULL, error);
        add_effort(info, &before);
    }
    return status;
}

void reduced_neighbour(reduced_state *state, const reduced_model *model, contact_place place) {
    const wanted_place here = place_wanted(&place);
    neighbour nearest[NUM_NEIGHBOURS];
    double one = 1;

    if (nearest_states(nearest, &model->states, &here, ROUNDING, ANY_EFFECT, NULL) > 0)
        combine_states(state, model, nearest, &one, 1);
    else
        reduced_guess(state, model, place);
}

// ---- error estimates of the grid

/* Interpolates one error estimate at a contact between the nearest states with known estimates. The
 * function interpolates logarithms, because the errors follow powers of M and of the viscosity's
 * rise. Returns infinity if the estimate of the nearest state is infinite. */
static double effect_at(const reduced_states *states, const neighbour *nearest, size_t count,
                        int effect) {
    // an estimate of 0 has no logarithm; ROUNDING replaces it
    neighbour finite[NUM_NEIGHBOURS] = {0};
    double weights[NUM_NEIGHBOURS], log_size = 0;
    size_t num_finite = 0;

    if (count == 0) return NAN;
    const double closest = states->effects[nearest[0].state].of[effect];
    if (isinf(closest)) return INFINITY;
    for (size_t i = 0; i < count; i++)
        if (isfinite(states->effects[nearest[i].state].of[effect]))
            finite[num_finite++] = nearest[i];
    count = best_weights(weights, finite, num_finite);
    for (size_t i = 0; i < count; i++)
        log_size +=
            weights[i] * log(fmax(fabs(states->effects[finite[i].state].of[effect]), ROUNDING));
    return exp(log_size);
}

static bool is_known(const reduced_states *states, const neighbour *nearest, size_t count,
                     int effect) {
    for (size_t i = 0; i < count; i++)
        if (isnan(states->effects[nearest[i].state].of[effect])) return false;
    return true;
}

film_effects reduced_effects(const reduced_model *model, contact_place place) {
    const wanted_place here = place_wanted(&place);
    const reduced_states *states = &model->states;
    neighbour nearest[NUM_NEIGHBOURS], others[NUM_NEIGHBOURS];
    const size_t count = nearest_states(nearest, states, &here, -1, ANY_EFFECT, NULL);
    film_effects effects;

    for (int e = 0; e < NUM_EFFECTS; e++) {
        if (is_known(states, nearest, count, e))
            effects.of[e] = effect_at(states, nearest, count, e);
        else
            effects.of[e] =
                effect_at(states, others, nearest_states(others, states, &here, -1, e, NULL), e);
    }
    return effects;
}
