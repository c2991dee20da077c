/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/calibrate/fallback_march.h"

#include "common/program/program.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Data that are saved in addition to the states. All members are doubles, so that the struct can be
 * saved as an array of numbers. */
typedef struct standing {
    double full;        // 1 while the full model takes the steps, else 0
    double full_states; // 1 if the last accepted states are in the full model, else 0
    // pause: number of full steps between two attempts to return to the reduced model; left: number
    // of full steps until the next attempt to return
    double pause, left;
    double held; // number of reduced steps since the last return to the reduced model
    // numbers of Newton iterations. useful: of accepted steps; wasted: of attempts that were not
    // accepted; open: of the attempt that is neither accepted nor rejected yet
    double useful, wasted, open;
    double full_steps, since, seconds_full, seconds_reduced; // members of time_run_share
} standing;

enum { NUM_STANDING = sizeof(standing) / sizeof(double), AT_SOLVERS = NUM_STANDING + MARCH_REASON };
_Static_assert(sizeof(standing) == NUM_STANDING * sizeof(double), "these are doubles alone");

struct fallback_march {
    ehd_contact reference;
    // limit of the error estimates of both films in a reduced step, and of the deviation of the
    // reduced films from the full model's films (function `deviation`)
    double limit;
    const char *distrust; // why the full model takes all steps; NULL: it takes only single steps
    parts_march *reduced;
    full_march *full;
    march_solver of_reduced, of_full;
    standing now;
    char reason[MARCH_REASON]; // reason of the first full step
    // outcome of the attempted step:
    bool by_full;      // the full model solved the step
    bool tried;        // the reduced model was tried after the full model (try_to_return)
    bool returns;      // the reduced model takes the next steps
    const char *doubt; // why the reduced model does not take the step
    // the reduced model already has the full model's base: the initial film, relative to which
    // states are carried along the path (common/time/README.md, Along the path)
    bool base_taken;
    hand_over work;
};

fallback_march *fallback_march_free(fallback_march *self) {
    if (!self) return NULL;
    full_march_free(self->full);
    hand_over_free(&self->work);
    free(self);
    return NULL;
}

ehd_status fallback_march_create(fallback_march **created, parts_march *reduced, double start_film,
                                 double accuracy, const char *distrust, ehd_error *error) {
    // Limit of the estimated film errors, as a fraction of the accuracy. Measured with an accuracy
    // of 1 % and a load that varies by +-30 %, which was not trained. With a fraction of 0.1 the
    // error of the minimum film is 0.57 %, and the full model takes 348 of 640 steps. With a
    // fraction of 1 the error is 25 %, and the full model takes 330 steps (README.md, Fallback to
    // the full model).
    const double part = 0.1;
    const full_settings settings = full_default_settings();
    const ehd_contact *reference = reduced_march_steps(parts_march_part(reduced, 0))->reference;
    fallback_march *self = calloc(1, sizeof *self);

    *created = NULL;
    if (!self) return ehd_no_memory(error, "full model");
    self->reference = *reference;
    self->limit = part * accuracy;
    self->distrust = distrust;
    self->now.since = NAN;
    self->now.pause = 1;
    self->reduced = reduced;
    self->of_reduced = parts_march_solver(reduced);
    ehd_status status = hand_over_init(&self->work, &reference->grid, error);
    if (!status)
        status = full_march_create(&self->full, &self->reference, &settings, start_film, error);
    if (status) {
        fallback_march_free(self);
        return status;
    }
    self->of_full = full_march_solver(self->full);
    *created = self;
    return EHD_OK;
}

// ---- from one model to the other

/* Returns the part of the reduced model that holds the last accepted state. */
static reduced_march *last_part(const fallback_march *self) {
    return parts_march_part(self->reduced, parts_march_accepted(self->reduced));
}

static ehd_status to_full(fallback_march *self, ehd_error *error) {
    self->now.full_states = 1;
    self->base_taken = false;
    return bdf_march_take_over(full_march_steps(self->full), reduced_march_steps(last_part(self)),
                               false, &self->work, error);
}

/* Returns the frame of the full state that is `steps` time steps before the attempted step, scaled
 * by the load of its solution. */
static contact_frame load_frame(const fallback_march *self, size_t steps) {
    const bdf_march *full = full_march_steps(self->full);

    return full->model->load_frame(full, bdf_march_accepted(full, steps));
}

/* Returns the largest difference between the films of a reduced and a full state, divided by the
 * larger of the full film and the central film. Returns infinity if a film is not a number.
 * Compares all nodes before the exits of the full state, even nodes without pressure, because the
 * fluid carries their film downstream. `steps`: number of time steps from both states to the
 * attempted step. */
static double deviation(fallback_march *self, reduced_march *part, size_t steps,
                        double central_film) {
    const ehd_grid *grid = &self->reference.grid;
    const handed_state *of_full = &self->work.given, *of_part = &self->work.taken;
    const bdf_march *full = full_march_steps(self->full), *reduced = reduced_march_steps(part);
    double largest = 0;

    bdf_march_give(&self->work.given, full, bdf_march_accepted(full, steps));
    bdf_march_give(&self->work.taken, reduced, bdf_march_accepted(reduced, steps));
    for (size_t k = 0; k < grid->num_nodes; k++) {
        if (k % grid_width(grid) >= of_full->exits[k / grid_width(grid)]) continue;
        const double film = of_full->film[k];
        const double here = fabs(of_part->film[k] - film) / fmax(film, central_film);
        largest = isnan(here) ? INFINITY : fmax(largest, here);
    }
    return largest;
}

/* Hands the states of the full model to a part of the reduced model, which projects these states
 * onto its modes. *off: largest difference of the films that the projection causes. The difference
 * at the last state enters the error estimate. */
static ehd_status to_reduced(double *off, fallback_march *self, reduced_march *part,
                             double central_film, ehd_error *error) {
    const bdf_march *full = full_march_steps(self->full);
    const ehd_status status =
        bdf_march_take_over(reduced_march_steps(part), full, self->base_taken, &self->work, error);

    *off = 0;
    if (status) return status;
    self->base_taken = true;
    reduced_march_take_indicated(part, NULL, self->work.change);
    for (size_t i = 1; i <= full->ring.num_previous; i++)
        *off = fmax(*off, deviation(self, part, i, central_film));
    return EHD_OK;
}

/* Marks a reduced step as not trusted if the error estimate of a film exceeds the limit. Otherwise
 * the full model might later take over a film with this error. */
static void judge_indicated(march_step *outcome, const fallback_march *self) {
    if (!outcome->status && fmax(outcome->indicated, outcome->indicated_minimum) > self->limit)
        march_distrust(outcome, "a film indicated to deviate by more than a tenth of the accuracy");
}

/* Checks whether attempts that were not accepted have cost more iterations than the accepted steps.
 * As long as this is true, the full model takes all steps. A march therefore needs at most twice
 * the iterations of its steps, plus the iterations of one attempt. */
static bool is_budget_spent(const fallback_march *self) {
    return self->now.wasted > self->now.useful;
}

/* Tries to return to the reduced model. The reduced model gets the projected states of the full
 * model and solves the step that the full model has just solved. If this step is trusted, and its
 * films agree with the full model's films within the limit, the reduced model takes the next steps.
 * Film features outside of the reduced basis have then left the contact. */
static ehd_status try_to_return(fallback_march *self, const march_step *solved,
                                const contact_frame *frame, double step, ehd_error *error) {
    const contact_frame now = load_frame(self, 0), before = load_frame(self, 1);
    march_step outcome = {.status = EHD_OK};

    if (self->distrust || self->now.left > 0 || is_budget_spent(self)) return EHD_OK;
    const size_t part_before = parts_march_accepted(self->reduced);
    reduced_march *part = parts_march_choose(self->reduced, &now);
    if (parts_march_accepted(self->reduced) != part_before) self->base_taken = false;
    if (reduced_march_check_range(part, &now, &before)) return EHD_OK;
    self->tried = true;
    const double film = solved->scalars.central_film_thickness;
    double off;
    ehd_status status = to_reduced(&off, self, part, film, error);
    if (!status && off > self->limit) return EHD_OK;
    if (!status)
        status = self->of_reduced.attempt(&outcome, self->of_reduced.self, frame, step, error);
    if (status) return status;
    self->now.wasted += (double)outcome.iterations; // wasted, since the full model takes the step
    judge_indicated(&outcome, self);
    if (outcome.status) return EHD_OK;
    part = parts_march_part(self->reduced, parts_march_attempted(self->reduced));
    self->returns = deviation(self, part, 0, film) <= self->limit;
    return EHD_OK;
}

// ---- as a solver

static ehd_status start(march_step *outcome, void *solver, const contact_frame *frame,
                        ehd_error *error) {
    fallback_march *self = solver;
    double begun = program_seconds();
    ehd_status status = EHD_OK;

    self->now.full = self->now.full_states = 0;
    self->now.useful = self->now.wasted = self->now.open = 0;
    if (!self->distrust) {
        status = self->of_reduced.start(outcome, self->of_reduced.self, frame, error);
        self->now.seconds_reduced += program_seconds() - begun;
        if (status) return status;
        judge_indicated(outcome, self);
        self->now.useful = (double)outcome->iterations;
        if (!outcome->status) return EHD_OK;
    }
    begun = program_seconds();
    if (isnan(self->now.since)) { // `since` may be set: the bodies were apart and touch again
        snprintf(self->reason, sizeof self->reason, "%s",
                 self->distrust ? self->distrust : outcome->reason);
        self->now.since = frame->time;
    }
    self->now.full = self->now.full_states = 1;
    self->base_taken = false;
    status = self->of_full.start(outcome, self->of_full.self, frame, error);
    outcome->by_full_model = true;
    self->now.seconds_full += program_seconds() - begun;
    if (!status) self->now.useful += (double)outcome->iterations;
    return status;
}

static ehd_status attempt_reduced(march_step *outcome, fallback_march *self,
                                  const contact_frame *frame, double step, ehd_error *error) {
    const double begun = program_seconds();
    ehd_status status =
        self->of_reduced.attempt(outcome, self->of_reduced.self, frame, step, error);

    self->now.seconds_reduced += program_seconds() - begun;
    if (status) return status;
    self->now.open = (double)outcome->iterations;
    judge_indicated(outcome, self);
    self->doubt = outcome->reason;
    return EHD_OK;
}

/* Moves the iterations of the last attempt from `open` to a sum. */
static void close_attempt(fallback_march *self, double *sum) {
    *sum += self->now.open;
    self->now.open = 0;
}

static ehd_status attempt(march_step *outcome, void *solver, const contact_frame *frame,
                          double step, ehd_error *error) {
    fallback_march *self = solver;
    const bool was_full = self->now.full == 1;
    ehd_status status = EHD_OK;

    self->by_full = self->tried = self->returns = false;
    close_attempt(self, &self->now.wasted); // the iterations of a rejected attempt, if any
    if (!was_full && is_budget_spent(self)) {
        self->doubt = "more iterations of attempts in vain than of steps";
    } else if (!was_full) {
        status = attempt_reduced(outcome, self, frame, step, error);
        if (status || !outcome->status) return status;
        close_attempt(self, &self->now.wasted);
    }
    const double begun = program_seconds();
    if (self->now.full_states != 1) status = to_full(self, error);
    if (!status) status = self->of_full.attempt(outcome, self->of_full.self, frame, step, error);
    outcome->by_full_model = self->by_full = true;
    const double solved = program_seconds();
    self->now.seconds_full += solved - begun;
    if (!status) self->now.open = (double)outcome->iterations;
    if (!status && !outcome->status && was_full)
        status = try_to_return(self, outcome, frame, step, error);
    self->now.seconds_reduced += program_seconds() - solved;
    return status;
}

/* Sets the pause: the number of full steps before the reduced model is tried again. A failed try
 * doubles the pause. After a successful try the reduced model takes steps. If these steps are fewer
 * than the steps of the pause, the pause is doubled too; otherwise the pause is reset to 1. Failed
 * tries thus cost little. */
static void set_pause(fallback_march *self) {
    standing *now = &self->now;

    if (now->full != 1)
        now->pause = now->held >= now->pause ? 1 : 2 * now->pause;
    else if (self->tried && !self->returns)
        now->pause *= 2;
    else if (!self->tried) {
        now->left = fmax(now->left - 1, 0);
        return;
    }
    now->left = now->pause - 1;
    now->held = 0;
}

static void accept(void *solver) {
    fallback_march *self = solver;
    standing *now = &self->now;

    now->full_states = self->by_full;
    close_attempt(self, &now->useful);
    if (!self->by_full) {
        now->held++;
        self->of_reduced.accept(self->of_reduced.self);
        return;
    }
    const contact_frame *frame;
    self->of_full.accept(self->of_full.self);
    full_march_state(self->full, &frame);
    if (isnan(now->since)) {
        now->since = frame->time;
        snprintf(self->reason, sizeof self->reason, "%s", self->doubt);
    }
    now->full_steps++;
    set_pause(self);
    now->full = !self->returns;
    if (self->returns) self->of_reduced.accept(self->of_reduced.self);
}

static void restart(void *solver) {
    fallback_march *self = solver;

    if (self->now.full_states == 1) self->of_full.restart(self->of_full.self);
    if (self->now.full != 1) self->of_reduced.restart(self->of_reduced.self);
}

/* Lets the full model find the lightest contact, because it can solve lighter contacts than those
 * of the training. */
static ehd_status touching(double *approach, double *load, void *solver, const contact_frame *frame,
                           ehd_error *error) {
    const fallback_march *self = solver;

    return self->of_full.touching(approach, load, self->of_full.self, frame, error);
}

/* Returns the number of saved doubles: struct standing, the reason and the states of both models. A
 * model that does not hold the last states saves zeros. */
static size_t saved_size(const void *solver) {
    const fallback_march *self = solver;

    return AT_SOLVERS + self->of_reduced.saved_size(self->of_reduced.self) +
           self->of_full.saved_size(self->of_full.self);
}

static void save(double *saved, const void *solver) {
    const fallback_march *self = solver;
    double *of_reduced = saved + AT_SOLVERS;
    double *of_full = of_reduced + self->of_reduced.saved_size(self->of_reduced.self);

    memset(saved, 0, saved_size(self) * sizeof *saved);
    memcpy(saved, &self->now, sizeof self->now);
    march_save_text(saved + NUM_STANDING, self->reason);
    if (self->now.full != 1) self->of_reduced.save(of_reduced, self->of_reduced.self);
    if (self->now.full_states == 1) self->of_full.save(of_full, self->of_full.self);
}

static ehd_status restore(void *solver, const double *saved, ehd_error *error) {
    fallback_march *self = solver;
    const double *of_reduced = saved + AT_SOLVERS;
    const double *of_full = of_reduced + self->of_reduced.saved_size(self->of_reduced.self);
    ehd_status status = EHD_OK;

    memcpy(&self->now, saved, sizeof self->now);
    march_restore_text(self->reason, saved + NUM_STANDING);
    self->base_taken = false;
    if (self->now.full == 1 && self->now.full_states != 1)
        return ehd_fail(error, EHD_DATA, "saved state: found no states of the full model");
    if (self->now.full != 1)
        status = self->of_reduced.restore(self->of_reduced.self, of_reduced, error);
    if (!status && self->now.full_states == 1)
        status = self->of_full.restore(self->of_full.self, of_full, error);
    return status;
}

/* Returns the solver that holds the last accepted state. */
static const march_solver *last_solver(const fallback_march *self) {
    return self->now.full_states == 1 ? &self->of_full : &self->of_reduced;
}

static ehd_status fields(double *pressure, double *film, void *solver, ehd_error *error) {
    const march_solver *last = last_solver(solver);

    return last->fields(pressure, film, last->self, error);
}

static void exits(double *positions, const void *solver) {
    const march_solver *last = last_solver(solver);

    last->exits(positions, last->self);
}

static solve_seconds seconds(const void *solver) {
    const fallback_march *self = solver;
    const solve_seconds reduced = self->of_reduced.seconds(self->of_reduced.self);
    solve_seconds sum = self->of_full.seconds(self->of_full.self);

    sum.exit = 0; // the full model does not measure the time for the exit
    solve_seconds_add(&sum, &reduced);
    return sum;
}

march_solver fallback_march_solver(fallback_march *self) {
    return (march_solver){.self = self,
                          .attempt = attempt,
                          .accept = accept,
                          .restart = restart,
                          .start = start,
                          .touching = touching,
                          .saved_size = saved_size,
                          .save = save,
                          .restore = restore,
                          .fields = fields,
                          .exits = exits,
                          .seconds = seconds};
}

time_run_share fallback_march_share(const void *solver) {
    const fallback_march *self = solver;

    return (time_run_share){.full_steps = (size_t)self->now.full_steps,
                            .seconds_full = self->now.seconds_full,
                            .seconds_reduced = self->now.seconds_reduced,
                            .since = self->now.since,
                            .reason = self->reason};
}
