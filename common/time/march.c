/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/time/march.h"

#include "common/algebra/rounding.h"
#include "common/program/program.h"
#include "common/time/surface.h"

#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* Divisor of the tolerance that gives the allowed local error of one step. Local errors add up
 * over the hundreds of steps in which a film passes through the contact. Measured with a load of
 * period 1/2: the error of the central film is at most twenty tolerances. This error is
 * proportional to the power 2/3 of the tolerance (test_march.c, tolerance_controls_the_error). */
static const double PASSAGE = 30;

/* Largest accumulated error of a film at any time, in tolerances. The tolerance itself limits the
 * root mean square over time. Errors that travel with a front do not cancel along the way. If the
 * error exceeds this bound, the local error of a step is multiplied by the ratio of the error
 * to the bound, so that steps become shorter. With a load that swings by 40 %
 * (scenes/studies/transient-load) the error is then 1.8 tolerances of 5e-3 instead of 6.0
 * (test_march.c, what_films_have_taken_up_shortens_steps). */
static const double MOST_TAKEN_UP = 8;

/* First fixed step with transport along the path, as a fraction of the later fixed steps. A long
 * step of first order causes a front in the film. Example: steps of 0.1 under a load that swings by
 * a fifth (scenes/examples/line-in-time), compared with steps of 0.0125. With a whole first step
 * errors are up to 2.1 %, with an eighth of a step up to 1.5 %. */
static const double FIRST_OF_FIXED = 1. / 8;

/* Largest ratio of successive steps. It stays below bdf_most_growth. If the largest ratio is 1.3,
 * scenes/examples/line-in-time at a step of 0.02 takes 61 steps instead of 57 (test_march.c,
 * steps_grow_by_two_at_most). */
static const double MAX_GROWTH = 2;

/* Ratio of a repeated time step to the failed attempt, in which Newton's iteration did not
 * converge. A failed attempt has no local error from which a ratio could be computed (test_march.c,
 * failed_step_is_taken_again). The same ratio is the smallest factor by which the local error
 * shortens a step. Ratios from 0.05 to 0.5 do not change the steps of
 * scenes/examples/line-in-time. */
static const double SHRINK = 0.25;

/* Ratio of a time step to the time step at which the local error would equal the tolerance. Number
 * of attempts of scenes/examples/line-in-time on a grid of step 0.02: 63 with a ratio of 0.85, 67
 * with 0.6, and 71 with 1. With upwind transport these numbers are 181, 234 and 204 (test_march.c,
 * tolerance_controls_the_error). */
static const double SAFETY = 0.85;

/* Fraction of the solver's noise level that is kept for the next step. A fraction of 0.09 is too
 * small for test_march.c, steps_stand_above_noise. */
static const double NOISE_KEPT = 0.9;

/* WATCHED_ATTEMPTS: number of attempts after which the progress of a march is checked. If this
 * number is 30, a march ends too early. STILL_ATTEMPTS: number of attempts after which a march is
 * checked for standstill. If this number is 3, a march ends too early; if it is 10,000, a march
 * ends too late (test_march.c, step_size_underflows, crawling_ends). */
enum { WATCHED_ATTEMPTS = 3000, STILL_ATTEMPTS = 100 };

/* MIN_STEP: shortest time step, divided by the first time step. A value of 1e-3 is too large for
 * test_march.c, crawling_ends. SUM_ROUNDING: relative round-off of a point in time, which is a sum
 * of time steps. If it is 0, steps become too short to change the time (test_march.c,
 * step_size_ends_above_rounding). If it is 1e-10, fixed steps fail late in time (test_march.c,
 * fixed_steps_go_on_late_in_time). */
static const double MIN_STEP = 1e-9, SUM_ROUNDING = 8 * DBL_EPSILON;

/* Longest step while the bodies are apart, as a fraction of the shortest time scale of the smooth
 * histories; the time scale of a sine is 1/(2 pi) of its period. No error estimate limits these
 * steps. With this limit a contact that lasts for a hundredth of the period is not missed
 * (test_apart.c, no_contact_is_missed). */
static const double WATCHED_PART = 1. / 16;

/* Two points in time that are closer together than this fraction of a time step are treated as one
 * (test_march.c, times_closer_than_a_thousandth_of_the_step_are_one). */
static const double SLIVER = 1e-3;

march_settings march_settings_of(const scene *given, const ehd_histories *histories,
                                 double reference_approach) {
    const bool path = strcmp(given->transport, transport_names[TRANSPORT_PATH]) == 0;
    const double tolerance = given->transient.tolerance;
    march_settings settings = {.end_time = given->transient.end_time,
                               .tolerance = path ? tolerance : tolerance / PASSAGE,
                               .fixed_step = given->transient.fixed_step,
                               .approach_given = strcmp(given->closure, "approach") == 0,
                               .reference_approach = reference_approach};
    double shortest = fmin(histories_shortest_time(histories), given->transient.end_time);

    settings.first_step =
        isnan(given->transient.fixed_step)
            ? fmin(sqrt(given->transient.tolerance / PASSAGE), 0.1) * fmin(shortest, 1)
            : (path ? FIRST_OF_FIXED : 1) * given->transient.fixed_step;
    return settings;
}

contact_frame march_frame(const march_settings *settings, const contact_kind *kind,
                          const ehd_histories *histories, double time, double load) {
    double values[NUM_VARY], approach = NAN;

    histories_at(values, histories, time);
    if (settings->approach_given) {
        values[VARY_LOAD] = load;
        approach = values[VARY_APPROACH] * settings->reference_approach;
    }
    contact_frame frame = frame_at(kind, time, values, approach);
    frame.path = histories_path(histories, time);
    return frame;
}

void march_distrust(march_step *self, const char *reason) {
    if (!reason) return;
    self->status = EHD_UNTRUSTED;
    self->reason = reason;
}

void march_save_text(double saved[MARCH_REASON], const char text[MARCH_REASON]) {
    size_t length = strlen(text);

    for (size_t i = 0; i < MARCH_REASON; i++)
        saved[i] = i < length ? (unsigned char)text[i] : 0;
}

void march_restore_text(char text[MARCH_REASON], const double saved[MARCH_REASON]) {
    size_t length = 0;

    while (length + 1 < MARCH_REASON && saved[length] >= 1 && saved[length] <= UCHAR_MAX) {
        text[length] = (char)(unsigned char)saved[length];
        length++;
    }
    text[length] = '\0';
}

static void watch_trust(march *self, const march_step *outcome) {
    if (outcome->status != EHD_UNTRUSTED || !isnan(self->state.untrusted_since)) return;
    self->state.untrusted_since = outcome->frame.time;
    snprintf(self->untrusted, sizeof self->untrusted, "%s", outcome->reason);
}

bool march_deviates(char reason[MARCH_REASON], double central, double minimum, double accuracy) {
    const bool of_minimum = isgreater(minimum, central);
    const double larger = of_minimum ? minimum : central;

    if (!isgreater(accuracy, 0) || isnan(central) || larger <= accuracy) return false;
    snprintf(reason, MARCH_REASON, "an indicated deviation of %.2g of the %s film, more than %g",
             larger, of_minimum ? "minimum" : "central", accuracy);
    return true;
}

static void judge_accuracy(march *self, march_step *outcome) {
    if (!outcome->status && march_deviates(self->deviation, outcome->indicated,
                                           outcome->indicated_minimum, self->settings.accuracy))
        march_distrust(outcome, self->deviation);
}

ehd_status march_check_start(double speed, bool approach_given, ehd_error *error) {
    if (speed != 0 || !approach_given) return EHD_OK;
    return ehd_fail(error, EHD_DATA,
                    "speed: found 0 at the start, expected another one, or transient.start_speed, "
                    "where the approach is given");
}

static contact_frame start_frame(const march *self) {
    contact_frame frame =
        march_frame(&self->settings, self->reference->kind, self->histories, 0, 1);

    frame.speed = histories_start_speed(self->histories);
    return frame;
}

ehd_status march_begin(march_step *outcome, march *self, ehd_error *error) {
    march_settings *settings = &self->settings;
    contact_frame frame = start_frame(self);
    ehd_status status = march_check_start(frame.speed, settings->approach_given, error);

    if (!status) status = self->solver.start(outcome, self->solver.self, &frame, error);
    if (!status && outcome->status != EHD_NOT_CONVERGED && settings->approach_given &&
        isnan(settings->reference_approach)) {
        settings->reference_approach =
            frame_to_reference(&outcome->scalars, &outcome->frame, self->reference).rigid_approach;
        frame = start_frame(self);
        if (frame.approach != settings->reference_approach)
            status = self->solver.start(outcome, self->solver.self, &frame, error);
    }
    if (status) return status;
    self->reason[0] = self->rejected[0] = self->untrusted[0] = '\0';
    // an event so close to the start that both are treated as one time does not end a step
    self->state =
        (march_state){.step = settings->first_step, .last_event = INFINITY, .untrusted_since = NAN};
    load_forecast_start(&self->state.forecast, outcome);
    outcome->step = 0;
    judge_accuracy(self, outcome);
    watch_trust(self, outcome);
    return EHD_OK;
}

void load_forecast_start(load_forecast *self, const march_step *start) {
    const double load = start->apart ? 1 : start->scalars.load * start->frame.load;

    *self = (load_forecast){.load = load, .scale = start->apart ? load : start->frame.load};
}

void load_forecast_accept(load_forecast *self, const march_step *step) {
    const double before = self->load;

    load_forecast_start(self, step);
    if (step->apart || step->begins) return;
    self->last_step = step->step;
    self->rate = (self->load - before) / step->step;
}

double load_forecast_scale(const load_forecast *self, double step, const ehd_grid *grid) {
    const double reach = self->last_step > 0 ? fmin(step, bdf_most_growth * self->last_step) : step;
    const double load =
        fmin(fmax(self->load + self->rate * reach, 0.5 * self->load), 2 * self->load);
    const contact_frame reference = {.speed = 1, .half_width = 1};
    const double share = frame_step_share(&reference, step, grid);

    return share < 1 ? self->scale + share * (load - self->scale) : load;
}

/* Returns the distance up to which two times are treated as one. With a distance of zero, a march
 * with fixed steps of 1/30 and a linear table of times k/30, rounded to nine digits, took 1040
 * steps instead of 64. An event just before or after a multiple of the fixed step then causes a
 * very short step, and each step is at most twice the step before. */
static double least_distance(double time, double step) {
    return fmax(SLIVER * step, SUM_ROUNDING * time);
}

/* The time at which the next attempted step ends. Events of the histories (kinks and jumps) whose
 * times differ from this time by at most least_distance belong to the stop. */
typedef struct next_stop {
    double time;
    bool is_kink; // an event belongs to the stop
    bool is_jump; // one of these events is a jump
    // held: time at which the histories are evaluated for the end of the step: `time` or, if
    // earlier, the first jump that belongs to the stop. Histories take the values before a jump at
    // the time of the jump itself.
    //
    // last: time of the last event that belongs to the stop; `time` if there is no event.
    double held, last;
} next_stop;

/* Returns the next step, shortened so that it resolves the motion of a surface that is not smooth.
 * The fluid may be faster within the step than at its start. The step is therefore shortened
 * repeatedly, each time by a half at most. */
static double step_of_surface(const march *self) {
    const march_state *state = &self->state;
    const ehd_surface *surface = self->reference->surface;
    double step = state->step;

    if (!surface || !isnan(self->settings.fixed_step)) return step;
    const contact_frame frame = march_frame(&self->settings, self->reference->kind, self->histories,
                                            state->time, state->forecast.load);
    for (int i = 0; i < DBL_MANT_DIG; i++) { // then the step is round-off
        const double path = histories_path(self->histories, state->time + step) - frame.path;
        const double longest =
            surface_longest_path(surface, &frame, &self->reference->grid, path < 0);
        if (!(fabs(path) > longest * (1 + ROUNDING))) break;
        step *= fmax(longest / fabs(path), 0.5);
    }
    return step;
}

/* Adds to a stop the events of the histories, from `kink` on, that count as the same time as the
 * stop. */
static void join_events(next_stop *stop, const march *self, double kink, bool jump,
                        double distance) {
    while (kink <= stop->time + distance) {
        if (jump && !stop->is_jump) stop->held = fmin(kink, stop->time);
        stop->is_kink = true;
        stop->is_jump = stop->is_jump || jump;
        stop->last = kink;
        kink = histories_next_kink(self->histories, kink, &jump);
    }
}

/* Finds the end of the next attempt. The attempt ends one step further, or earlier at an event of
 * the histories, a multiple of the fixed step or the end of the march. If several of these times
 * are so close that they count as one, the end of the march has priority over the multiple, and the
 * multiple has priority over the event. */
static next_stop find_next_stop(const march *self) {
    const march_state *state = &self->state;
    const double time = state->time, step = step_of_surface(self);
    const double distance = least_distance(time, step);
    const double fixed = self->settings.fixed_step, end = self->settings.end_time;
    // Events up to `since` were treated as the end of the last step. If the step has become
    // shorter, the last of these events may now lie farther ahead than `distance`. It is then an
    // event of the next step again.
    const double since = fmax(time, fmin(state->last_event, time + distance));
    bool jump;
    const double kink = histories_next_kink(self->histories, since, &jump);
    // A multiple of the fixed step, not a sum of steps, so that times do not drift, and the march
    // returns to the multiples after a shortened step.
    const double multiple =
        isnan(fixed) ? INFINITY : (floor((time + distance) / fixed) + 1) * fixed;
    const double event = fmin(fmin(kink, multiple), end);

    if (step >= event - time - distance) {
        const double one = event + distance;
        next_stop stop = {.time = end <= one ? end : multiple <= one ? multiple : kink};
        stop.held = stop.last = stop.time;
        join_events(&stop, self, kink, jump, distance);
        return stop;
    }
    // two equal steps rather than a whole step and a very short one
    const double next = time + fmin(step, 0.5 * (event - time));
    return (next_stop){.time = next, .held = next, .last = next};
}

/* Returns the frame at a stop. At a jump of the histories it is the frame before the jump. */
static contact_frame frame_at_stop(const march *self, const next_stop *stop, double load) {
    contact_frame frame =
        march_frame(&self->settings, self->reference->kind, self->histories, stop->held, load);

    frame.time = stop->time;
    frame.path = histories_path(self->histories, stop->time);
    return frame;
}

/* Returns the local error of a step, corrected after a kink of the histories. The solvers assume a
 * smooth solution. At a kink, however, the second derivative of the solution jumps by some J. The
 * error of the prediction in the next step is then J step^2 / 2. The error of BDF2 is last_step /
 * (2 step + last_step) times the error of the prediction. After long steps this ratio is much
 * larger than for a smooth solution. Steps as short as the first step of the march are not
 * corrected: even a jump of the first derivative is harmless in such steps. */
static double error_after_kink(const march *self, const march_step *outcome) {
    const double step = outcome->step, interval = outcome->formula.interval;
    const double smooth = outcome->formula.error, local_error = outcome->local_error;
    const double part = interval > 0 ? interval / (2 * step + interval) : 1;

    if (!(smooth > 0) || step <= self->settings.first_step) return local_error;
    return local_error * fmax(part / smooth, 1);
}

/* Returns the length of a time step below which the march ends. Shorter steps hardly advance the
 * march, or are lost in the round-off of the time. */
static double min_step(const march *self) {
    return fmax(MIN_STEP * self->settings.first_step, SUM_ROUNDING * self->state.time);
}

static bool is_along_path(const march *self) {
    return self->reference->transport == TRANSPORT_PATH;
}

/* Returns the local error of a step. With transport along the path, if the films' accumulated error
 * exceeds its bound, the local error is multiplied by the ratio of the two. */
static double error_with_taken_up(const march *self, const march_step *outcome) {
    const double most = MOST_TAKEN_UP * self->settings.tolerance;

    return outcome->local_error * (is_along_path(self) ? fmax(outcome->taken_up / most, 1) : 1);
}

/* Returns the order in the step size of the error that the tolerance limits. */
static double error_order(const march *self) {
    return is_along_path(self) ? 2 : 3;
}

/* Raises the estimate of the solver's noise. If a step is shorter than the attempt before, but its
 * error is not smaller in proportion, the excess is noise of exits that move by whole nodes.
 * Shorter steps do not reduce this noise. For some steps the march then accepts this noise, but not
 * more than PASSAGE tolerances: this is the error that all steps together may cause while a film
 * passes through the contact. Example: a reduced model of a point contact, upwind, 33 nodes a side,
 * 60 modes, 180 rows, load with a period of 3/4 that is not in the training. With this rule the
 * march takes 571 steps to T = 3; without the rule the march does not get beyond T = 1.31.
 * Transport along the path does not need the rule, because its steps have a shortest length. */
static void watch_noise(march *self, const march_step *outcome) {
    march_state *state = &self->state;
    double error = outcome->local_error, tolerance = self->settings.tolerance;
    bool hardly_less = error * state->rejected_step > state->rejected_error * outcome->step;

    if (state->rejected_step > 0 && hardly_less && error <= PASSAGE * tolerance)
        state->noise = fmax(state->noise, error);
}

static double accepted_error(const march *self) {
    double tolerance = self->settings.tolerance;

    return fmin(fmax(tolerance, 2 * self->state.noise), PASSAGE * tolerance);
}

/* Returns the length below which a step is not shortened with transport along the path; 0 with
 * upwind. */
static double shortest_step(const march *self, const contact_frame *frame) {
    return is_along_path(self) ? frame_shortest_step(frame, &self->reference->grid) : 0;
}

/* Largest ratio of a repeated step to the rejected one. A step that is only slightly shorter has
 * only a slightly smaller error (test_march.c, steps_along_the_path_stay_at_the_shortest). */
static const double LEAST_SHRINK = 0.9;

static bool is_shortest(const march *self, const march_step *outcome) {
    return LEAST_SHRINK * outcome->step <= shortest_step(self, &outcome->frame);
}

/* Returns the fixed step. With transport along the path fixed steps begin shorter, and each is at
 * most twice the last one. */
static double fixed_step_after(const march *self, const march_step *outcome) {
    double fixed = self->settings.fixed_step;

    return is_along_path(self) ? fmin(fixed, MAX_GROWTH * outcome->step) : fixed;
}

static double next_step(const march *self, const march_step *outcome) {
    if (!isnan(self->settings.fixed_step)) return fixed_step_after(self, outcome);
    double relative = outcome->local_error / accepted_error(self);
    double factor = relative > 0 ? SAFETY * pow(relative, -1 / error_order(self)) : MAX_GROWTH;
    return outcome->step * fmin(fmax(factor, SHRINK), MAX_GROWTH);
}

static ehd_status attempt(march_step *outcome, march *self, const next_stop *next,
                          ehd_error *error) {
    march_state *state = &self->state;
    double step = next->time - state->time;
    const double load = load_forecast_scale(&state->forecast, step, &self->reference->grid);
    const contact_frame frame = frame_at_stop(self, next, load);
    ehd_status status = self->solver.attempt(outcome, self->solver.self, &frame, step, error);

    if (status) return status;
    outcome->step = step;
    if (state->at_kink > 0) outcome->local_error = error_after_kink(self, outcome);
    outcome->local_error = error_with_taken_up(self, outcome);
    state->num_iterations += (double)outcome->iterations;
    if (outcome->status != EHD_NOT_CONVERGED && !is_along_path(self)) watch_noise(self, outcome);
    return EHD_OK;
}

static bool is_adaptive(const march *self) {
    return isnan(self->settings.fixed_step);
}

static bool is_rejected(const march *self, const march_step *outcome) {
    return outcome->status == EHD_NOT_CONVERGED ||
           (is_adaptive(self) && !is_shortest(self, outcome) &&
            !(outcome->local_error <= accepted_error(self)));
}

/* Rejects an attempt. Sets a shorter step, or ends the march if this step is too short. */
static void reject(march *self, const march_step *outcome) {
    march_state *state = &self->state;
    bool failed = outcome->status == EHD_NOT_CONVERGED;
    double step = outcome->step;

    state->num_rejected++;
    snprintf(self->rejected, sizeof self->rejected, "%s", failed ? outcome->reason : "local error");
    state->rejected_step = failed ? 0 : step;
    state->rejected_error = outcome->local_error;
    const double shortest = shortest_step(self, &outcome->frame);
    state->step = failed ? SHRINK * step
                         : fmin(fmax(next_step(self, outcome), shortest), LEAST_SHRINK * step);
    if (!(state->step > min_step(self)))
        snprintf(self->reason, sizeof self->reason,
                 "found a step size of %.1e at T = %.10g (%.100s), expected above %.1e",
                 state->step, state->time, self->rejected, min_step(self));
}

/* Returns the length of the next attempt after an accepted step. If the step was shortened because
 * of an event or of noise, its length does not limit the next attempt. */
static double step_after(const march *self, const march_step *outcome) {
    const march_state *state = &self->state;
    double before = outcome->local_error > self->settings.tolerance ? state->rejected_step : 0;

    if (!is_adaptive(self)) return fixed_step_after(self, outcome);
    const double shortest = shortest_step(self, &outcome->frame);
    // the error of a shortest step comes from the grid, and does not limit the next step
    if (is_shortest(self, outcome))
        return fmax(next_step(self, outcome), fmin(shortest, MAX_GROWTH * outcome->step));
    return fmax(next_step(self, outcome), fmin(fmax(state->step, before), 2 * outcome->step));
}

/* Returns the first step after a jump. This step is of first order, and with transport along the
 * path the film keeps the error of this step. The time scale of the histories does not limit the
 * step, because a jump has no time scale. With a step of frame_shortest_step, the error of the
 * central film after a jump of the load by 30 % (scenes/studies/transient-load) is 0.16 % (rms).
 * With a step of 0.007 it was 0.40 %. */
static double first_step_after_jump(const march *self, const march_step *outcome) {
    const double first = self->settings.first_step;

    return is_along_path(self) ? fmin(first, shortest_step(self, &outcome->frame)) : first;
}

static void accept(march *self, march_step *outcome, const next_stop *reached) {
    march_state *state = &self->state;

    self->solver.accept(self->solver.self);
    state->noise *= NOISE_KEPT;
    load_forecast_accept(&state->forecast, outcome);
    state->time = outcome->frame.time;
    state->num_steps++;
    state->at_kink = reached->is_kink;
    state->last_event = reached->last;
    judge_accuracy(self, outcome);
    watch_trust(self, outcome);
    state->step = step_after(self, outcome);
    if (reached->is_jump) self->solver.restart(self->solver.self);
    if (reached->is_jump || outcome->begins) {
        state->forecast.last_step = 0;
        state->step = first_step_after_jump(self, outcome);
    }
    if (outcome->apart && is_adaptive(self))
        state->step = fmin(state->step, WATCHED_PART * histories_smooth_time(self->histories));
    state->rejected_step = 0;
    // if this step is too long, it is rejected, and the march ends
    state->step = fmax(state->step, 2 * min_step(self));
}

static ehd_status advance(march *self, ehd_error *error) {
    const next_stop next = find_next_stop(self);
    march_step outcome;
    ehd_status status = attempt(&outcome, self, &next, error);

    if (status) return status;
    if (is_rejected(self, &outcome)) {
        reject(self, &outcome);
        return EHD_OK;
    }
    accept(self, &outcome, &next);
    return self->store(self->sink, &outcome, (size_t)self->state.num_steps, error);
}

/* Checks whether the last attempt was accepted and ended at an event of the histories. The length
 * of such a step is determined by the histories. */
static bool ended_at_kink(const march *self, double steps_before) {
    return self->state.num_steps > steps_before && self->state.at_kink > 0;
}

/* Time and number of rejected attempts before the attempts that are watched. */
typedef struct stillness {
    double time, num_rejected;
} stillness;

/* Ends a march that stands still: the mean step of the last STILL_ATTEMPTS attempts is shorter than
 * a thousandth of the first step, and the end is more than a million attempts away. At least one
 * attempt must have been rejected, because otherwise only events of the histories shorten steps. */
static void watch_standstill(march *self, stillness *mark) {
    // limits of the mean step, relative to the first step, and of the number of attempts that would
    // be needed to reach the end (test_march.c, crawling_ends)
    const double shrunk = 1e-3, most_attempts = 1e6;
    const march_state *state = &self->state;
    const double step = (state->time - mark->time) / STILL_ATTEMPTS;

    if (state->num_rejected > mark->num_rejected && step < shrunk * self->settings.first_step &&
        step * most_attempts < self->settings.end_time - state->time)
        snprintf(
            self->reason, sizeof self->reason,
            "found %d attempts between T = %.8g and %.8g (step %.1e, last one rejected: %.100s), "
            "expected them to get further",
            STILL_ATTEMPTS, mark->time, state->time, state->step, self->rejected);
    *mark = (stillness){state->time, state->num_rejected};
}

/* Ends a march whose step size collapses. If a model's noise exceeds the tolerance, steps become
 * shorter and shorter, and the end is out of reach. */
static void watch_progress(march *self, double *mark, double usual) {
    // least progress in WATCHED_ATTEMPTS attempts, relative to `usual`; at this rate the time
    // `usual` takes 300,000 attempts (README.md, BDF2)
    const double min_progress = 0.01;

    if (!(self->state.time - *mark > min_progress * usual))
        snprintf(self->reason, sizeof self->reason,
                 "found %d attempts between T = %.8g and %.8g, expected them to get further (step "
                 "%.1e)",
                 WATCHED_ATTEMPTS, *mark, self->state.time, self->state.step);
    *mark = self->state.time;
}

ehd_status march_run(ehd_status *outcome, march *self, ehd_error *error) {
    const double fixed = self->settings.fixed_step;
    double mark = self->state.time;
    stillness still = {mark, self->state.num_rejected};
    double usual = isnan(fixed)
                       ? fmin(histories_shortest_time(self->histories), self->settings.end_time)
                       : WATCHED_ATTEMPTS * fixed;
    ehd_status status = EHD_OK;

    for (size_t attempts = 0;
         !status && self->state.time < self->settings.end_time && !self->reason[0];) {
        const double steps = self->state.num_steps;
        status = program_interrupted() ? ehd_fail(error, EHD_INTERRUPTED, "interrupted")
                                       : advance(self, error);
        if (status || self->reason[0] || ended_at_kink(self, steps)) continue;
        attempts++;
        if (attempts % STILL_ATTEMPTS == 0) watch_standstill(self, &still);
        if (!self->reason[0] && attempts % WATCHED_ATTEMPTS == 0)
            watch_progress(self, &mark, usual);
    }
    *outcome = self->reason[0] ? EHD_NOT_CONVERGED : EHD_OK;
    return status;
}

ehd_status march_whole(char reason[MARCH_REASON], march *self, ehd_error *error) {
    march_step first;
    ehd_status outcome = EHD_OK, status = march_begin(&first, self, error);

    reason[0] = '\0';
    if (!status && first.status == EHD_NOT_CONVERGED) {
        snprintf(reason, MARCH_REASON, "start: %s", first.reason);
        return EHD_OK;
    }
    if (!status) status = self->store(self->sink, &first, 0, error);
    if (!status) status = march_run(&outcome, self, error);
    if (!status && outcome) memcpy(reason, self->reason, MARCH_REASON);
    return status;
}
