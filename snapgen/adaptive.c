/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "snapgen/adaptive.h"

#include "common/algebra/rounding.h"
#include "common/physics/traction.h"
#include "common/program/arena.h"
#include "romrun/calibrate/check_scenes.h"
#include "romrun/calibrate/trade.h"
#include "romrun/trust/indicator.h"
#include "romrun/trust/trained_range.h"
#include "snapgen/adaptive_file.h"
#include "snapgen/point_choice.h"
#include "snapgen/region_parts.h"
#include "snapgen/snapshots.h"
#include "snapgen/trial.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MIN_BATCH = 4 };

/* A region may be divided in two when its model has this many times the points of the first round
 * (README.md, Parts of a region). */
static const double WIDE = 5;

/* A region whose highest M is at most this many times the lowest is never divided. Otherwise an
 * accuracy that no model reaches would lead to ever more parts. The parts of scenes/studies/parts,
 * trained to an accuracy of 1e-4, have ratios of 1.4 to 2 and end with about 100 points. */
static const double NARROW = 2;

typedef struct adaptive {
    const program *caller;
    training_set *set;
    const char *plan_path;
    const adaptive_settings *settings;
    size_t num_workers;
    double started;    // program_seconds at the start
    double solving;    // s, time of full solutions
    size_t num_solved; // number of these solutions
    double judging;    // s, time for the model of the last round and its estimates

    artefact *file; // output: the training, or a piece of a round
    training points;
    tree_point *places;         // [num_points]
    double (*films)[NUM_FILMS]; // [num_points] films of the full model at solved points
    bool *trained;              // [num_points]
    size_t *state_of_point;     // [num_points] number of the state in the file, of trained points
    trial_verdict *verdicts;    // [num_points] by the present model, at points not trained on
    double *indicated; // [num_points] error estimates at points not trained on; INFINITY: unknown

    size_t num_states;
    adaptive_state *states; // [num_states]
    size_t num_rounds;      // rounds with a model
    adaptive_round *rounds; // [num_rounds]
    double *work;           // [2, num_points] work array of factor_of
    double *zeros;          // [num_points]
    bool *left;             // [num_points] work array of judge_candidates
    bool ended, divided;
    arena memory;
} adaptive;

adaptive_settings adaptive_default_settings(void) {
    return (adaptive_settings){
        .accuracy = 1e-3, .start = 20, .max_points = SIZE_MAX, .discarded_energy = 1e-18};
}

static void adaptive_free(adaptive *self) {
    artefact_close(&self->file);
    training_free(&self->points);
    arena_free(&self->memory);
}

/* Sets the coordinates of the candidates, by which neighbours are found. Candidates of one group of
 * the plan with the same viscosity and density laws form one family, even if the constants of the
 * laws vary. */
static void find_places(tree_point *places, const training_set *set) {
    training_set_places(places, set);
    for (size_t i = 0; i < set->num_points; i++) {
        const ehd_lubricant *here = &set->contacts[i].lubricant;
        size_t first = 0;
        while (set->groups[first] != set->groups[i] ||
               set->contacts[first].lubricant.viscosity != here->viscosity ||
               set->contacts[first].lubricant.density != here->density)
            first++;
        places[i].family = first;
    }
}

static ehd_status adaptive_init(adaptive *self, ehd_error *error) {
    size_t count = self->set->num_points;

    arena *memory = &self->memory;

    self->places = arena_array(memory, count, sizeof *self->places);
    self->films = arena_array(memory, count, sizeof *self->films);
    self->trained = arena_array(memory, count, sizeof *self->trained);
    self->state_of_point = arena_array(memory, count, sizeof *self->state_of_point);
    self->verdicts = arena_array(memory, count, sizeof *self->verdicts);
    self->indicated = arena_array(memory, count, sizeof(double));
    self->states = arena_array(memory, count, sizeof *self->states);
    self->rounds = arena_array(memory, count, sizeof *self->rounds);
    self->work = arena_table(memory, count, 2, sizeof(double));
    self->zeros = arena_array(memory, count, sizeof(double));
    self->left = arena_array(memory, count, sizeof *self->left);
    if (memory->failed) return ehd_no_memory(error, self->plan_path);
    find_places(self->places, self->set);
    for (size_t i = 0; i < count; i++)
        self->indicated[i] = INFINITY;
    return training_init(&self->points, self->caller, self->set, error);
}

static size_t smaller(size_t a, size_t b) {
    return a < b ? a : b;
}

// ---- results of the rounds

static bool is_solved(const adaptive *self, size_t point) {
    return self->points.points[point].pressure != NULL;
}

/* Checks whether the full model and the model that estimated a state's error both converged. */
static bool is_compared(const adaptive *self, const adaptive_state *state) {
    return isfinite(state->verdict.bound[FILM_CENTRAL]) && is_solved(self, state->point);
}

/* Returns the relative error of a film in the model that estimated the state's error. */
static double true_deviation(const adaptive *self, const adaptive_state *state, int film) {
    return fabs(state->verdict.film[film] / self->films[state->point][film] - 1);
}

/* Fits the factor of a film's error estimate to the points that a round added. Returns 0 if none of
 * these points can be compared (is_compared). */
static double factor_of(const adaptive *self, size_t round, int film) {
    double *deviations = self->work, *bounds = self->work + self->num_states;
    size_t count = 0;

    for (size_t s = 0; s < self->num_states; s++) {
        const adaptive_state *state = &self->states[s];
        if (state->round != round || !is_compared(self, state)) continue;
        deviations[count] = true_deviation(self, state, film);
        bounds[count++] = state->verdict.bound[film];
    }
    return trade_indicator_factor(deviations, bounds, count);
}

typedef struct film_factors {
    double of[NUM_FILMS];
    bool known;
} film_factors;

/* Fits the factors of both films to the points of a round. If the model made before the round
 * solved none of these points, uses an earlier round. */
static film_factors factors_of(const adaptive *self, size_t round) {
    film_factors factors = {.known = false};

    for (size_t r = round + 1; r-- > 0 && !factors.known;) {
        factors.known = true;
        for (int f = 0; f < NUM_FILMS; f++) {
            factors.of[f] = factor_of(self, r, f);
            factors.known = factors.known && factors.of[f] > 0;
        }
    }
    return factors;
}

/* Returns the larger error estimate of the two films. If the factors are not known, returns the
 * larger bound. */
static double indicated_by(const trial_verdict *verdict, const film_factors *factors) {
    double indicated = 0;

    for (int f = 0; f < NUM_FILMS; f++)
        indicated = fmax(indicated, (factors->known ? factors->of[f] : 1) * verdict->bound[f]);
    return indicated;
}

/* Returns the largest error of a film at the points of a round, for the model made before the
 * round. NaN: this model solved none of the points. */
static double worst_of_film(const adaptive *self, size_t round, int film) {
    double worst = NAN;

    for (size_t s = 0; s < self->num_states; s++)
        if (self->states[s].round == round && is_compared(self, &self->states[s]))
            worst = fmax(worst, true_deviation(self, &self->states[s], film));
    return worst;
}

static double worst_deviation(const adaptive *self, size_t round) {
    return fmax(worst_of_film(self, round, FILM_CENTRAL), worst_of_film(self, round, FILM_MINIMUM));
}

/* Checks whether the model made before a round solved all points of the round that the full model
 * solved. */
static bool is_round_compared(const adaptive *self, size_t round) {
    bool all = true;

    for (size_t s = 0; s < self->num_states; s++)
        if (self->states[s].round == round && is_solved(self, self->states[s].point))
            all = all && is_compared(self, &self->states[s]);
    return all;
}

/* Counts the converged points of all rounds up to the given round. */
static size_t count_solved(const adaptive *self, size_t round) {
    size_t count = 0;

    for (size_t s = 0; s < self->num_states; s++)
        count += self->states[s].round <= round && is_solved(self, self->states[s].point);
    return count;
}

/* Restores the outcomes of rounds that an earlier run has finished. The largest estimate of a round
 * is the estimate of the first point of the next round. */
static void recall_rounds(adaptive *self) {
    for (size_t s = 0; s < self->num_states; s++) {
        const adaptive_state *state = &self->states[s];
        if (state->round != self->num_rounds + 1) continue;
        const film_factors factors = factors_of(self, self->num_rounds);
        self->rounds[self->num_rounds] = (adaptive_round){
            .num_points = count_solved(self, self->num_rounds),
            .indicated = factors.known ? indicated_by(&state->verdict, &factors) : NAN,
            .deviation = NAN,
            .seconds = NAN};
        self->num_rounds++;
    }
}

// ---- choosing

static void add_point(adaptive *self, size_t point, const trial_verdict *verdict) {
    self->states[self->num_states] = (adaptive_state){point, self->num_rounds, *verdict};
    self->state_of_point[point] = self->num_states++;
    self->trained[point] = true;
}

/* Adds the candidates with the largest error estimates (`indicated`), if these exceed the accuracy.
 * `judged`: the present model has estimated their errors. */
static ehd_status add_worst(adaptive *self, const double *indicated, size_t max_count,
                            double accuracy, bool judged, ehd_error *error) {
    const candidates from = {self->places, self->set->num_points, self->trained, indicated,
                             accuracy};
    const trial_verdict unknown = {{NAN, NAN}, {NAN, NAN}};
    size_t *chosen = malloc((max_count + 1) * sizeof *chosen), count = 0;
    ehd_status status = chosen ? point_choice_worst(chosen, &count, &from, max_count, error)
                               : ehd_no_memory(error, "choice");

    for (size_t i = 0; i < count; i++)
        add_point(self, chosen[i], judged ? &self->verdicts[chosen[i]] : &unknown);
    free(chosen);
    return status;
}

/* Computes the coordinates of the points as in the trained range (trained_place). Divides each
 * coordinate by its range over all points. */
static void normalise(double (*places)[RANGE_AXES], const training_set *set) {
    double low[RANGE_AXES], high[RANGE_AXES];

    for (int axis = 0; axis < RANGE_AXES; axis++) {
        low[axis] = INFINITY;
        high[axis] = -INFINITY;
    }
    for (size_t i = 0; i < set->num_points; i++) {
        trained_place(places[i], contact_place_of(&set->contacts[i]));
        for (int axis = 0; axis < RANGE_AXES; axis++) {
            low[axis] = fmin(low[axis], places[i][axis]);
            high[axis] = fmax(high[axis], places[i][axis]);
        }
    }
    for (size_t i = 0; i < set->num_points; i++)
        for (int axis = 0; axis < RANGE_AXES; axis++)
            if (high[axis] > low[axis]) places[i][axis] /= high[axis] - low[axis];
}

/* Adds the corners of the convex hull of one family's candidates. The candidates of a family have
 * the same group and the same laws of the lubricant. `here`, `numbers` and `corners` are scratch
 * memory for num_points. */
static ehd_status add_corners_of(adaptive *self, size_t family, const double (*places)[RANGE_AXES],
                                 double (*here)[RANGE_AXES], size_t *numbers, size_t *corners,
                                 ehd_error *error) {
    const trial_verdict unknown = {{NAN, NAN}, {NAN, NAN}};
    size_t count = 0;

    for (size_t i = 0; i < self->set->num_points; i++) {
        if (self->places[i].family != family) continue;
        memcpy(here[count], places[i], sizeof *here);
        numbers[count++] = i;
    }
    count = point_choice_corners(corners, (const double(*)[RANGE_AXES])here, count, ROUNDING);
    if (count == 0) return ehd_no_memory(error, "choice");
    for (size_t i = 0; i < count && self->num_states < self->settings->max_points; i++)
        add_point(self, numbers[corners[i]], &unknown);
    return EHD_OK;
}

static ehd_status add_corners(adaptive *self, ehd_error *error) {
    const size_t num_points = self->set->num_points;
    arena memory = {0};
    double(*places)[RANGE_AXES] = arena_array(&memory, num_points, sizeof *places);
    double(*here)[RANGE_AXES] = arena_array(&memory, num_points, sizeof *here);
    size_t *numbers = arena_array(&memory, num_points, sizeof *numbers);
    size_t *corners = arena_array(&memory, num_points, sizeof *corners);
    ehd_status status = memory.failed ? ehd_no_memory(error, "choice") : EHD_OK;

    if (!status) {
        normalise(places, self->set);
        // a family has the number of its first point
        for (size_t i = 0; i < num_points && !status; i++)
            if (self->places[i].family == i)
                status = add_corners_of(self, i, (const double(*)[RANGE_AXES])places, here, numbers,
                                        corners, error);
    }
    arena_free(&memory);
    return status;
}

/* Adds the first round: the corners of the convex hull of each family's candidates, and candidates
 * as far as possible from the corners and from each other. */
static ehd_status add_first_round(adaptive *self, ehd_error *error) {
    size_t wanted = smaller(self->settings->start, self->settings->max_points);
    ehd_status status = add_corners(self, error);

    if (!status && wanted > self->num_states)
        status = add_worst(self, self->indicated, wanted - self->num_states, 0, false, error);
    return status
               ? status
               : adaptive_file_add(self->file, self->set, self->states, 0, self->num_states, error);
}

/* Checks whether all estimates of a round meet the accuracy. The next round is then a check. */
static bool is_good(const adaptive *self, size_t round) {
    return self->rounds[round].indicated <= self->settings->accuracy;
}

/* Adds the points of a check of the error estimates. Half of the points have the largest estimates,
 * the largest first. The other half are as far as possible from all trained points. */
static ehd_status add_check(adaptive *self, size_t count, ehd_error *error) {
    ehd_status status = add_worst(self, self->indicated, (count + 1) / 2, -1, true, error);

    return status ? status : add_worst(self, self->zeros, count / 2, -1, true, error);
}

static ehd_status add_next_round(adaptive *self, ehd_error *error) {
    const size_t last = self->num_rounds - 1;
    size_t first = self->num_states, batch = self->settings->batch;
    const double accuracy = isnan(self->rounds[last].indicated) ? -1 : self->settings->accuracy;

    if (batch == 0) batch = first / 5 > MIN_BATCH ? first / 5 : MIN_BATCH;
    batch = smaller(batch, smaller(self->settings->max_points, self->set->num_points) - first);
    ehd_status status = is_good(self, last)
                            ? add_check(self, batch, error)
                            : add_worst(self, self->indicated, batch, accuracy, true, error);
    return status ? status
                  : adaptive_file_add(self->file, self->set, self->states, first,
                                      self->num_states - first, error);
}

// ---- solving

/* Returns the nearest point of earlier rounds, from which a new point can start. NO_PARENT: there
 * is no such point. */
static size_t nearest_before(const adaptive *self, const tree_point *from,
                             const double scale[TREE_AXES]) {
    double nearest = INFINITY;
    size_t found = NO_PARENT;

    for (size_t s = 0; s < self->num_states && self->states[s].round < self->num_rounds; s++) {
        const double away = tree_distance(&self->places[self->states[s].point], from, scale);
        if (!(away < nearest)) continue;
        nearest = away;
        found = self->states[s].point;
    }
    return found;
}

/* Sets the starts and the order of the new points. In the first round all points start cold. In
 * later rounds each point starts from the nearest point of earlier rounds. No point therefore needs
 * another point of its own round, and any process may solve any point. Starts from points of the
 * same round would save nothing, because these points are far apart. For the plan of examples/line
 * Newton's method takes 10.4 iterations per point, and 13.7 with starts from the same round. For
 * the plan of examples/point it takes 6.0, and 5.8 with starts from the same round. */
static ehd_status order_points(adaptive *self, ehd_error *error) {
    double scale[TREE_AXES];

    tree_scale(scale, self->places, self->set->num_points);
    for (size_t i = 0; i < self->set->num_points; i++) {
        const bool is_new = self->trained[i] && !self->points.points[i].done;
        self->set->parent[i] = is_new && !self->settings->cold
                                   ? nearest_before(self, &self->places[i], scale)
                                   : NO_PARENT;
    }
    return tree_order(self->set->order, self->set->parent, self->set->num_points, error);
}

/* Stores a solved point. This function is the member `store` of the training. */
static ehd_status store(void *sink, const training_set *set, size_t point, const snapshot *solution,
                        ehd_error *error) {
    adaptive *self = sink;

    self->films[point][FILM_CENTRAL] = solution->scalars.central_film_thickness;
    self->films[point][FILM_MINIMUM] = solution->scalars.minimum_film_thickness;
    return snapshots_store(self->file, set, self->state_of_point[point], solution, error);
}

static ehd_status solve_round(adaptive *self, ehd_error *error) {
    ehd_status status = order_points(self, error);

    self->points.store = store;
    self->points.sink = self;
    self->points.with_effects = true;
    self->points.wanted = self->trained;
    self->points.rest = self->judging;
    self->points.more = true;
    const size_t before = self->points.num_done;
    const double begun = program_seconds();
    if (!status) status = training_run(&self->points, self->num_workers, error);
    self->solving += program_seconds() - begun;
    self->num_solved += self->points.num_done - before;
    if (!status && self->num_solved > 0)
        stage_expect(&self->caller->stage, "check",
                     (double)check_scenes_count(self->points.num_done, self->set) * self->solving /
                         (double)self->num_solved);
    return status;
}

// ---- judging

static ehd_status build_model(reduced_model *model, trial_costs *costs, const adaptive *self,
                              ehd_error *error) {
    size_t count = 0;
    ehd_contact *contacts = malloc((self->num_states + 1) * sizeof *contacts);
    solved_state *solved = malloc((self->num_states + 1) * sizeof *solved);
    ehd_error cause = {""};
    ehd_status status = contacts && solved ? EHD_OK : ehd_fail(&cause, EHD_MEMORY, "out of memory");

    for (size_t s = 0; s < self->num_states && !status; s++) {
        size_t point = self->states[s].point;
        const trained_point *trained = &self->points.points[point];
        const ehd_contact *contact = &self->set->contacts[point];
        if (!trained->pressure) continue;
        contacts[count] = *contact;
        solved[count++] =
            (solved_state){trained->pressure,
                           trained->rigid_approach,
                           contact->moes_M,
                           contact->alpha_p_H,
                           traction_thinning(contact),
                           self->films[point][FILM_CENTRAL],
                           lubricant_rises_at(&contact->lubricant, contact->hertz_pressure)};
    }
    const training_set trained = {.grid = self->set->grid,
                                  .kind = self->set->kind,
                                  .num_points = count,
                                  .contacts = contacts};
    if (!status)
        status = trial_build(model, costs, self->caller, &trained, solved,
                             self->settings->discarded_energy, self->num_workers, &cause);
    if (status == EHD_INTERRUPTED)
        *error = cause;
    else if (status && count < self->num_states)
        status =
            ehd_fail(error, EHD_NOT_CONVERGED,
                     "%s: found %zu of %zu points not converged, and no model of the others: %s",
                     self->plan_path, self->num_states - count, self->num_states, cause.text);
    else if (status)
        ehd_fail(error, status, "%s: model of %zu points: %s", self->plan_path, count, cause.text);
    free(solved);
    free(contacts);
    return status;
}

/* Reports the expected durations of the stages after the training, for the present points. These
 * durations are lower limits, because further rounds add points. Extrapolated error estimates do
 * not predict the number of rounds (docs/history.md, adaptive-training). solve_round reports the
 * duration of the check, which needs full solutions. */
static void tell_costs(const adaptive *self, const trial_costs *costs) {
    const stage *here = &self->caller->stage;

    stage_expect(here, "basis", costs->basis);
    stage_expect(here, "residuals", costs->residuals);
    stage_expect(here, "rows", costs->rows);
    // each other part of the region is expected to need the same time for its training
    stage_expect(here, "training", program_seconds() - self->started);
}

/* Makes the present model, and estimates its errors at all candidates that are not trained. */
static ehd_status judge_candidates(adaptive *self, ehd_error *error) {
    size_t num_points = self->set->num_points;
    reduced_model model = {0};
    trial_costs costs = {0};
    const double begun = program_seconds();
    ehd_status status = build_model(&model, &costs, self, error);

    for (size_t i = 0; i < num_points; i++)
        self->left[i] = !self->trained[i];
    if (!status)
        status = trial_judge(self->verdicts, &model, self->set->contacts, self->left, num_points,
                             self->num_workers, error);
    self->judging = program_seconds() - begun;
    if (!status) tell_costs(self, &costs);
    reduced_model_free(&model);
    return status;
}

static void report_round(const adaptive *self, size_t num_lost) {
    const adaptive_round *round = &self->rounds[self->num_rounds - 1];
    double deviation = worst_deviation(self, self->num_rounds - 1);
    char found[96] = "", indicated[96] = "";

    if (!isnan(deviation))
        snprintf(found, sizeof found, ", the last ones were up to %.2g off", deviation);
    if (num_lost > 0)
        snprintf(indicated, sizeof indicated, "; %zu others are not solved by their model",
                 num_lost);
    else if (!isnan(round->indicated))
        snprintf(indicated, sizeof indicated, "; estimated errors of the other points: up to %.2g",
                 round->indicated);
    program_note(self->caller, "round %zu: %zu points%s%s, %.1f s", self->num_rounds,
                 round->num_points, found, indicated, round->seconds);
}

static ehd_status judge_round(adaptive *self, ehd_error *error) {
    double worst = NAN;
    size_t num_lost = 0;
    bool any_left = self->num_states < self->set->num_points;
    ehd_status status = any_left ? judge_candidates(self, error) : EHD_OK;

    if (status) return status;
    const film_factors factors = factors_of(self, self->num_rounds);
    for (size_t i = 0; i < self->set->num_points; i++) {
        if (self->trained[i]) continue;
        self->indicated[i] = indicated_by(&self->verdicts[i], &factors);
        if (factors.known) worst = fmax(worst, self->indicated[i]);
        if (!isfinite(self->indicated[i])) num_lost++;
    }
    self->rounds[self->num_rounds] =
        (adaptive_round){.num_points = count_solved(self, self->num_rounds),
                         .indicated = worst,
                         .deviation = NAN,
                         .seconds = program_seconds() - self->started};
    self->num_rounds++;
    report_round(self, num_lost);
    return EHD_OK;
}

// ---- pieces

/* Copies solutions of the last round from the pieces, files that other processes have written. */
static ehd_status take_pieces(adaptive *self, const adaptive_task *task, ehd_error *error) {
    ehd_status status = EHD_OK;

    for (size_t i = 0; i < task->num_pieces && !status; i++)
        status = adaptive_file_take(self->file, &self->points, self->films, self->states,
                                    self->num_states, task->pieces[i], error);
    return status;
}

// ---- parts of the region

static size_t count_round(const adaptive *self, size_t round) {
    size_t count = 0;

    for (size_t s = 0; s < self->num_states; s++)
        count += self->states[s].round == round;
    return count;
}

/* Estimates how many points one model needs for the wanted accuracy. Fits a straight line to the
 * last four rounds: the logarithm of the largest error estimate against the number of points.
 * Extends the line to the accuracy. Returns infinity if the line does not fall, or if candidates
 * have no solution. */
static double expected_points(const adaptive *self) {
    const size_t count = smaller(self->num_rounds, 4), first = self->num_rounds - count;
    double mean_points = 0, mean_worst = 0, slope = 0, spread = 0;

    for (size_t r = first; r < self->num_rounds; r++) {
        mean_points += (double)self->rounds[r].num_points / (double)count;
        mean_worst += log(self->rounds[r].indicated) / (double)count;
    }
    for (size_t r = first; r < self->num_rounds; r++) {
        const double points = (double)self->rounds[r].num_points - mean_points;
        slope += points * log(self->rounds[r].indicated);
        spread += points * points;
    }
    slope /= spread;
    if (!(slope < 0) || !isfinite(mean_worst)) return INFINITY;
    return fmax((double)self->num_states,
                mean_points + (log(self->settings->accuracy) - mean_worst) / slope);
}

/* Checks whether one model is expected to take more points than two models of two parts
 * (README.md, Parts of a region). */
static bool is_too_wide(const adaptive *self) {
    const double of_part = WIDE * (double)count_round(self, 0);

    return parts_span(self->set) > NARROW && (double)self->num_states >= of_part &&
           !is_good(self, self->num_rounds - 1) && !(expected_points(self) <= 2 * of_part);
}

/* Writes plans for two parts with half of the points each. The parts are then about equally hard to
 * train, since points are densest where the training is hard. */
static ehd_status divide(adaptive *self, const adaptive_task *task, ehd_error *error) {
    size_t *points = arena_array(&self->memory, self->num_states, sizeof *points);
    const parts_request request = {.plan_path = self->plan_path,
                                   .set = self->set,
                                   .points = points,
                                   .num_points = self->num_states,
                                   .num_parts = 2,
                                   .force = self->caller->force};

    if (!points) return ehd_no_memory(error, self->plan_path);
    for (size_t s = 0; s < self->num_states; s++)
        points[s] = self->states[s].point;
    const ehd_status status = parts_write(&request, task->parts, error);
    self->divided = !status;
    return status;
}

// ---- rounds

/* Checks whether the last round was a successful check: the previous model met the accuracy at the
 * points of this round, and the estimates at all other points now meet the accuracy too. */
static bool is_checked(const adaptive *self) {
    const size_t last = self->num_rounds - 1;

    return last > 0 && is_good(self, last - 1) && is_good(self, last) &&
           is_round_compared(self, last) && worst_deviation(self, last) <= self->settings->accuracy;
}

static bool is_finished(const adaptive *self) {
    return is_checked(self) ||
           self->num_states >= smaller(self->set->num_points, self->settings->max_points);
}

/* Counts the points that are chosen, but not solved yet. */
static size_t count_open(const adaptive *self) {
    return self->num_states - self->points.num_done;
}

static ehd_status run_rounds(adaptive *self, const adaptive_task *task, ehd_error *error) {
    ehd_status status = EHD_OK;

    if (self->num_states == 0) status = add_first_round(self, error);
    if (!status) status = take_pieces(self, task, error);
    while (!status && !(task->only_choose && count_open(self) > 0)) {
        status = solve_round(self, error);
        if (!status && self->points.num_failed == self->num_states)
            status = ehd_fail(error, EHD_NOT_CONVERGED,
                              "%s: found none of %zu points converged, expected at least one",
                              self->plan_path, self->num_states);
        if (!status) status = judge_round(self, error);
        self->ended = !status && is_finished(self);
        if (status || self->ended) break;
        if (task->parts && is_too_wide(self)) {
            status = divide(self, task, error);
            if (status != EHD_DATA) return status; // EHD_DATA: too few points of different M
        }
        status = add_next_round(self, error);
    }
    for (size_t r = 0; r < self->num_rounds; r++)
        self->rounds[r].deviation = worst_deviation(self, r + 1);
    if (status == EHD_INTERRUPTED)
        ehd_fail(error, status,
                 "%s.partial: found an interruption after %zu points in %zu rounds, expected "
                 "--resume to continue",
                 self->caller->output, self->points.num_done, self->num_rounds);
    return status;
}

static void mark_states(adaptive *self) {
    for (size_t s = 0; s < self->num_states; s++) {
        self->trained[self->states[s].point] = true;
        self->state_of_point[self->states[s].point] = s;
    }
}

static ehd_status open_file(adaptive *self, bool resume, ehd_error *error) {
    if (resume) {
        ehd_status status = adaptive_file_resume(&self->file, self->states, &self->num_states,
                                                 self->films, &self->points, self->caller, error);
        if (!status) {
            mark_states(self);
            program_note(self->caller, "%s.partial: %zu of %zu points are done",
                         self->caller->output, self->points.num_done, self->num_states);
            recall_rounds(self);
            return EHD_OK;
        }
        if (status != EHD_NOINPUT) return status;
    }
    return adaptive_file_create(&self->file, self->caller, self->set, self->plan_path, error);
}

/* Warns that all candidates, or as many as --max-points allows, are used without a successful
 * check. */
static void warn_of_end(const adaptive *self) {
    const bool limited = self->num_states < self->set->num_points;
    char name[POINT_NAME] = "";
    double worst = -1;

    for (size_t i = 0; i < self->set->num_points; i++)
        if (!self->trained[i] && self->indicated[i] > worst) {
            worst = self->indicated[i];
            training_point_name(name, &self->set->contacts[i]);
        }
    program_warn(self->caller,
                 "%s: found %zu points used up%s%s, expected fewer to show an accuracy of %g; %s",
                 self->plan_path, self->num_states, *name ? ", the worst indicated at " : "", name,
                 self->settings->accuracy,
                 limited ? "more of them (--max-points) may" : "a plan with more candidates may");
}

/* Prints a summary of the result. EHD_NOT_CONVERGED: more points failed than allowed. */
static ehd_status report(const adaptive *self, size_t allowed_failures, ehd_error *error) {
    const adaptive_round *last = &self->rounds[self->num_rounds - 1];
    size_t num_failed = self->points.num_failed;

    printf("%zu points of %zu, %zu converged, %zu rounds, %.1f s\n", self->num_states,
           self->set->num_points, last->num_points, self->num_rounds,
           program_seconds() - self->started);
    if (isfinite(last->indicated))
        printf(
            "estimated film errors of the other points: at most %.2g, with podbuild --energy %g\n",
            last->indicated, self->settings->discarded_energy);
    if (is_checked(self))
        printf("checked on the last %zu points before they were trained on: central film at most "
               "%.2g off, minimum film %.2g\n",
               count_round(self, self->num_rounds - 1),
               worst_of_film(self, self->num_rounds - 1, FILM_CENTRAL),
               worst_of_film(self, self->num_rounds - 1, FILM_MINIMUM));
    else
        warn_of_end(self);
    if (num_failed <= allowed_failures) return EHD_OK;
    return ehd_fail(error, EHD_NOT_CONVERGED,
                    "%s: found %zu of %zu points not converged, expected at most %zu "
                    "(--allow-failures)",
                    self->plan_path, num_failed, self->num_states, allowed_failures);
}

/* Adds the line of settings by which --resume distinguishes adaptive trainings. */
static ehd_status add_text(training_set *set, const char *plan_path,
                           const adaptive_settings *settings, ehd_error *error) {
    char line[256];

    snprintf(line, sizeof line,
             "adaptive: accuracy %.17g, start %zu, batch %zu, most %zu, energy %.17g",
             settings->accuracy, settings->start, settings->batch, settings->max_points,
             settings->discarded_energy);
    return training_set_add_text(set, line, plan_path, error);
}

/* Allocates a training and adds its settings to the set's text. EHD_DATA: the plan has transient
 * scenes. */
static ehd_status begin(adaptive *self, const program *caller, const adaptive_task *task,
                        ehd_error *error) {
    ehd_status status = EHD_OK;

    *self = (adaptive){.caller = caller,
                       .set = task->set,
                       .plan_path = task->plan_path,
                       .settings = task->settings,
                       .num_workers = task->num_workers,
                       .started = program_seconds()};
    if (task->set->num_trajectories > 0)
        status =
            ehd_fail(error, EHD_DATA,
                     "%s: found %zu transient scenes with --adaptive or a region, expected a plan "
                     "without them, and one of them alone",
                     task->plan_path, task->set->num_trajectories);
    if (!status) status = add_text(task->set, task->plan_path, task->settings, error);
    return status ? status : adaptive_init(self, error);
}

ehd_status adaptive_train(const program *caller, const adaptive_task *task, ehd_error *error) {
    adaptive self;
    ehd_status status = begin(&self, caller, task, error);

    if (!status) status = open_file(&self, task->resume, error);
    if (!status) status = run_rounds(&self, task, error);
    if (!status && self.divided)
        printf("%zu points do not make one model yet, two parts are in %s\n", self.num_states,
               task->parts);
    else if (!status && !self.ended)
        printf("round %zu: %zu points are to be solved, after %zu\n", self.num_rounds + 1,
               count_open(&self), self.points.num_done);
    if (!status && self.ended) {
        status = adaptive_file_put_curve(self.file, self.rounds, self.num_rounds, error);
        if (!status) status = artefact_finish(&self.file, error);
        if (!status) status = report(&self, task->allowed_failures, error);
    }
    adaptive_free(&self);
    return status;
}

// ---- a piece of a round

/* Chooses the points of the piece that is to be solved: every N-th of the points that are not done,
 * where N is the number of pieces. */
static ehd_status choose_piece(adaptive_state *chosen, size_t *count, adaptive *self,
                               const adaptive_task *task, ehd_error *error) {
    const size_t num_open = count_open(self), total = task->piece.total;
    size_t number = 0;

    if (num_open < total)
        return ehd_fail(error, num_open > 0 ? EHD_USAGE : EHD_DATA,
                        "%s: found %zu points that are to be solved, expected at least %zu, one a "
                        "piece",
                        task->chosen_in, num_open, total);
    *count = 0;
    for (size_t s = 0; s < self->num_states; s++) {
        const size_t point = self->states[s].point;
        if (self->points.points[point].done) continue;
        self->trained[point] = number++ % total == task->piece.number - 1;
        self->state_of_point[point] = *count;
        if (self->trained[point]) chosen[(*count)++] = self->states[s];
    }
    return EHD_OK;
}

/* Continues the file of a piece. EHD_DATA: the file has other points. */
static ehd_status resume_piece(adaptive *self, const adaptive_state *chosen, size_t count,
                               ehd_error *error) {
    adaptive_state *found = malloc(self->set->num_points * sizeof *found);
    size_t num_found = 0;
    ehd_status status = found ? adaptive_file_resume(&self->file, found, &num_found, self->films,
                                                     &self->points, self->caller, error)
                              : ehd_no_memory(error, self->plan_path);
    bool same = num_found == count;

    for (size_t i = 0; i < num_found && same; i++)
        same = found[i].point == chosen[i].point;
    if (!status && !same) {
        artefact_close(&self->file);
        status = ehd_fail(error, EHD_DATA,
                          "%s.partial: found other points, expected those of this piece",
                          self->caller->output);
    }
    free(found);
    return status;
}

static ehd_status open_piece(adaptive *self, const adaptive_task *task,
                             const adaptive_state *chosen, size_t count, ehd_error *error) {
    ehd_status status = EHD_NOINPUT;

    if (task->resume) status = resume_piece(self, chosen, count, error);
    if (status != EHD_NOINPUT) return status;
    status = adaptive_file_create(&self->file, self->caller, self->set, self->plan_path, error);
    return status ? status : adaptive_file_add(self->file, self->set, chosen, 0, count, error);
}

static ehd_status solve_piece(adaptive *self, const adaptive_task *task, ehd_error *error) {
    adaptive_state *chosen = malloc((self->num_states + 1) * sizeof *chosen);
    const size_t done_before = self->points.num_done, failed_before = self->points.num_failed;
    size_t count = 0;
    ehd_status status = chosen ? choose_piece(chosen, &count, self, task, error)
                               : ehd_no_memory(error, self->plan_path);

    if (!status) status = open_piece(self, task, chosen, count, error);
    if (!status && self->points.num_done > done_before)
        program_note(self->caller, "%s.partial: %zu of %zu points are done", self->caller->output,
                     self->points.num_done - done_before, count);
    if (!status) status = solve_round(self, error);
    if (status == EHD_INTERRUPTED)
        ehd_fail(error, status,
                 "%s.partial: found an interruption after %zu of %zu points, expected --resume to "
                 "continue",
                 self->caller->output, self->points.num_done - done_before, count);
    if (!status) status = artefact_finish(&self->file, error);
    if (!status)
        printf("%zu points of round %zu, %zu converged, %.1f s\n", count, self->num_rounds + 1,
               count - (self->points.num_failed - failed_before),
               program_seconds() - self->started);
    free(chosen);
    return status;
}

ehd_status adaptive_solve(const program *caller, const adaptive_task *task, ehd_error *error) {
    adaptive self;
    ehd_status status = begin(&self, caller, task, error);

    if (!status)
        status = adaptive_file_read(self.states, &self.num_states, self.films, &self.points,
                                    task->chosen_in, error);
    if (!status) {
        mark_states(&self);
        self.num_rounds = self.num_states > 0 ? self.states[self.num_states - 1].round : 0;
        status = solve_piece(&self, task, error);
    }
    adaptive_free(&self);
    return status;
}
