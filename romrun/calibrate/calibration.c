/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/calibrate/calibration.h"

#include "common/physics/deflection.h"
#include "common/physics/exit.h"
#include "common/physics/laws.h"
#include "common/program/arena.h"
#include "common/program/program.h"
#include "common/time/march.h"
#include "romrun/calibrate/time_factors.h"
#include "romrun/online/parts_march.h"

#include <math.h>
#include <string.h>

enum { REPEATS = 3 }; // number of solutions of each scene; the time is their median

/* One way of sliding: a shear law, and the ratio of the Newtonian stress at P = 0 and H = 1 to the
 * Eyring or limiting stress of the law, as in deimselect/cubature.c. The friction of each scene is
 * measured for all entries of the table `slidings` below, whatever the scene's own law is. The
 * Eyring fluid of ratio 1e-1 has high stresses in the whole contact. Errors caused by too few
 * nodes, and by exits that are one node off, are largest for this fluid. If the ratio 1e-1 is
 * replaced by 1e-2, the estimates of 2 of 2235 frictions outside of the calibration are only 0.4
 * times the errors. */
typedef struct sliding {
    const lubricant_law *law;
    double ratio;
} sliding;

static const sliding slidings[] = {{&shear_newtonian, 1},
                                   {&shear_eyring, 1e-3},
                                   {&shear_eyring, 1e-1},
                                   {&shear_limiting, 1e-4},
                                   {&shear_limiting, 1e-2}};
enum { NUM_SLIDINGS = sizeof slidings / sizeof *slidings };

/* Returns a copy of a contact that slides as an entry of `slidings` states. The units of stress
 * cancel, so the contact may be dimensionless or in SI units. */
static ehd_contact slide(const ehd_contact *contact, const sliding *how) {
    ehd_contact own = *contact;
    const double isoviscous = contact->lambda / 12 * contact->far_speed;

    own.half_width = own.radius = 1;
    own.slide_roll = 1;
    own.lubricant.shear = how->law;
    own.lubricant.shear_constants[0] =
        isoviscous / how->ratio * (how->law == &shear_eyring ? contact->hertz_pressure : 1);
    return own;
}

/* Measurements on the scenes that the reduced model solved, and work arrays for fields. */
typedef struct samples {
    size_t count; // number of scenes that the model solved
    bool exits_are_nodes;
    double *deviation[NUM_TRADE_QUANTITIES]; // [count]
    double *bound, *bound_minimum;           // [count] error bounds of central and minimum film
    double *indicated;                       // [count + failures] the larger of both film estimates
    double *effectivity;                // [count] estimate/error, the smaller ratio of both films
    double *off[NUM_INDICATED];         // [count] deviations of the other quantities
    double *other_bound[NUM_INDICATED]; // [count] error bounds of the other quantities
    double *friction_off, *friction_bound; // [num_frictions]
    size_t num_frictions;                  // 0 if the model has no traction nodes
    double *seconds;                       // [count * REPEATS]
    double iterations, max_iterations;     // sum over all scenes; largest number of one scene
    double largest_residual;
    double *pressure, *film; // [num_nodes]
    double *full_film;       // [num_nodes]
    ehd_deflection *deflection;
    arena memory;
} samples;

static void samples_free(samples *self) {
    arena_free(&self->memory);
    deflection_free(self->deflection);
}

static ehd_status samples_init(samples *self, const solved_scene *scenes, size_t num_scenes,
                               size_t num_nodes, ehd_error *error) {
    *self = (samples){0};
    arena *memory = &self->memory;

    for (int q = 0; q < NUM_INDICATED; q++) {
        self->off[q] = arena_array(memory, num_scenes, sizeof(double));
        self->other_bound[q] = arena_array(memory, num_scenes, sizeof(double));
    }
    for (int q = 0; q < NUM_TRADE_QUANTITIES; q++)
        self->deviation[q] = arena_array(memory, num_scenes, sizeof(double));
    self->friction_off = arena_table(memory, num_scenes, NUM_SLIDINGS, sizeof(double));
    self->friction_bound = arena_table(memory, num_scenes, NUM_SLIDINGS, sizeof(double));
    self->bound = arena_array(memory, num_scenes, sizeof(double));
    self->bound_minimum = arena_array(memory, num_scenes, sizeof(double));
    self->indicated = arena_array(memory, num_scenes, sizeof(double));
    self->effectivity = arena_array(memory, num_scenes, sizeof(double));
    self->seconds = arena_table(memory, num_scenes, REPEATS, sizeof(double));
    self->pressure = arena_array(memory, num_nodes, sizeof(double));
    self->film = arena_array(memory, num_nodes, sizeof(double));
    self->full_film = arena_array(memory, num_nodes, sizeof(double));
    if (num_scenes > 0) {
        self->exits_are_nodes = !exit_is_within_node(&scenes->contact->grid);
        self->deflection = deflection_create(scenes->contact->kind, &scenes->contact->grid);
    }
    if (memory->failed || (num_scenes > 0 && !self->deflection))
        return ehd_no_memory(error, "calibration");
    return EHD_OK;
}

static double relative(double reduced, double full) {
    return fabs(reduced / full - 1);
}

/* Stores the errors of the quantities of indicated.h except friction. Compares films only where the
 * full model has pressure. */
static void add_others(samples *self, const contact_scalars *reduced, const solved_scene *solved) {
    const contact_scalars *full = &solved->scalars;
    const ehd_grid *grid = &solved->contact->grid;
    double pressure = 0, film = 0;

    deflection_apply(self->full_film, self->deflection, solved->pressure);
    for (size_t k = 0; k < grid->num_nodes; k++) {
        self->full_film[k] += full->rigid_approach + grid_gap(grid, k);
        pressure = fmax(pressure, fabs(self->pressure[k] - solved->pressure[k]));
        if (solved->pressure[k] > 0) film = fmax(film, fabs(self->film[k] - self->full_film[k]));
    }
    self->off[INDICATED_CENTRAL_PRESSURE][self->count] =
        relative(reduced->central_pressure, full->central_pressure);
    self->off[INDICATED_EXIT_POSITION][self->count] =
        fabs(reduced->exit_position - full->exit_position);
    self->off[INDICATED_LOAD][self->count] = fabs(reduced->load - full->load);
    self->off[INDICATED_PRESSURE][self->count] = pressure;
    self->off[INDICATED_FILM][self->count] = film / full->central_film_thickness;
}

static void add_sample(samples *self, const online_result *result, const solved_scene *solved) {
    const contact_scalars *reduced = &result->scalars, *full = &solved->scalars;
    const double deviation[NUM_TRADE_QUANTITIES] = {
        [TRADE_CENTRAL_FILM] =
            relative(reduced->central_film_thickness, full->central_film_thickness),
        [TRADE_MINIMUM_FILM] =
            relative(reduced->minimum_film_thickness, full->minimum_film_thickness),
        [TRADE_CENTRAL_PRESSURE] = relative(reduced->central_pressure, full->central_pressure)};

    for (int q = 0; q < NUM_TRADE_QUANTITIES; q++)
        self->deviation[q][self->count] = deviation[q];
    add_others(self, reduced, solved);
    self->deviation[TRADE_PRESSURE][self->count] = self->off[INDICATED_PRESSURE][self->count];
    self->bound[self->count] = result->bound;
    self->bound_minimum[self->count] = result->bound_minimum;
    self->iterations += (double)result->iterations;
    self->largest_residual = fmax(self->largest_residual, result->residual);
    self->max_iterations = fmax(self->max_iterations, (double)result->iterations);
    self->count++;
}

/* Stores the friction errors, and their bounds, of the scene that was added last. self->full_film
 * must be the film of this scene. */
static void add_frictions(samples *self, online_solver *solver, const solved_scene *solved) {
    for (size_t i = 0; i < NUM_SLIDINGS; i++) {
        const ehd_contact contact = slide(solved->contact, &slidings[i]);
        const double full =
            contact_traction_of(&contact, solved->pressure, self->full_film, &solved->scalars)
                .friction;
        const double reduced = online_traction(solver, &contact).friction;
        const double bound = online_friction_bound(solver, &contact, reduced);
        if (isnan(bound)) return;
        self->friction_off[self->num_frictions] = relative(reduced, full);
        self->friction_bound[self->num_frictions++] = bound;
    }
}

static ehd_status measure_scene(trade_position *position, samples *self, online_solver *solver,
                                const solved_scene *solved, ehd_error *error) {
    online_result result = {.status = EHD_NOT_CONVERGED};
    double *seconds = self->seconds + self->count * REPEATS;
    ehd_status status = EHD_OK;

    for (size_t i = 0; i < REPEATS && !status; i++) {
        const double before = program_seconds_of_thread();
        status = online_solve(&result, solver, solved->contact, error);
        seconds[i] = program_seconds_of_thread() - before;
    }
    if (!status && result.status) {
        position->num_failures++;
        return EHD_OK;
    }
    if (!status) status = online_fields(self->pressure, self->film, solver, error);
    if (status) return status;
    const online_indications others = online_indicate(solver, solved->contact);
    for (int q = 0; q < NUM_INDICATED; q++)
        self->other_bound[q][self->count] = others.bound[q];
    add_sample(self, &result, solved);
    add_frictions(self, solver, solved);
    return EHD_OK;
}

/* Fits factor and shape of the error estimate of a quantity. If exits are nodes, the shape has an
 * offset, because an exit that is wrong by one node changes films by an amount that no residual
 * shows. */
static ehd_status fit_one(double *factor, indicator_shape *shape, const samples *self,
                          const double *deviations, const double *bounds, size_t count,
                          ehd_error *error) {
    *factor = trade_indicator_factor(deviations, bounds, count);
    return trade_indicator_shape(shape, deviations, bounds, count, self->exits_are_nodes, error);
}

static ehd_status fit_friction(trade_position *position, const samples *self, ehd_error *error) {
    return fit_one(&position->other_factor[INDICATED_FRICTION],
                   &position->shape[OF_OTHERS + INDICATED_FRICTION], self, self->friction_off,
                   self->friction_bound, self->num_frictions, error);
}

static ehd_status fit_factors(trade_position *position, const samples *self, ehd_error *error) {
    indicator_shape *shape = position->shape;
    ehd_status status =
        fit_one(&position->indicator_factor, &shape[OF_CENTRAL_FILM], self,
                self->deviation[TRADE_CENTRAL_FILM], self->bound, self->count, error);

    if (!status)
        status =
            fit_one(&position->indicator_factor_minimum, &shape[OF_MINIMUM_FILM], self,
                    self->deviation[TRADE_MINIMUM_FILM], self->bound_minimum, self->count, error);
    for (int q = 0; q < INDICATED_FRICTION && !status; q++)
        status = fit_one(&position->other_factor[q], &shape[OF_OTHERS + q], self, self->off[q],
                         self->other_bound[q], self->count, error);
    return status ? status : fit_friction(position, self, error);
}

/* Fits the error estimates and evaluates their quantiles. An error estimate is a bound, computed
 * from residuals, times a fitted factor. The fit compares the bound of each scene with the
 * deviation, which is the true error of the same scene. The function must therefore be called
 * before trade_quantile_of sorts the deviations. */
static ehd_status fit_indicator(trade_position *position, samples *self, ehd_error *error) {
    const double *central = self->deviation[TRADE_CENTRAL_FILM];
    const double *minimum = self->deviation[TRADE_MINIMUM_FILM];
    const size_t num_scenes = self->count + position->num_failures;

    ehd_status status = fit_factors(position, self, error);

    if (status) return status;
    for (size_t i = 0; i < num_scenes; i++)
        self->indicated[i] = INFINITY;
    for (size_t i = 0; i < self->count; i++) {
        const double of_central = trade_indicated(position->indicator_factor,
                                                  position->shape[OF_CENTRAL_FILM], self->bound[i]);
        const double of_minimum =
            trade_indicated(position->indicator_factor_minimum, position->shape[OF_MINIMUM_FILM],
                            self->bound_minimum[i]);
        // For the choice of a model size, estimates use constant factors without shapes. With few
        // modes, lubricants outside of the calibration have errors up to four times the estimate
        // with shapes: 3 of 431 errors exceeded 1 % without a warning.
        self->indicated[i] = fmax(position->indicator_factor * self->bound[i],
                                  position->indicator_factor_minimum * self->bound_minimum[i]);
        self->effectivity[i] = fmin(of_central / central[i], of_minimum / minimum[i]);
    }
    for (int i = 0; i < NUM_TRADE_PARTS; i++) {
        position->indicated[i] = trade_quantile_of(self->indicated, num_scenes, trade_parts[i]);
        position->effectivity[i] =
            trade_quantile_of(self->effectivity, self->count, trade_parts[i]);
    }
    return EHD_OK;
}

static ehd_status evaluate(trade_position *position, samples *self, ehd_error *error) {
    ehd_status status = fit_indicator(position, self, error);

    if (status) return status;
    for (int q = 0; q < NUM_TRADE_QUANTITIES; q++)
        for (int i = 0; i < NUM_TRADE_QUANTILES; i++)
            position->deviation[q][i] =
                trade_quantile_of(self->deviation[q], self->count, trade_quantiles[i]);
    position->seconds = trade_quantile_of(self->seconds, self->count * REPEATS, 0.5);
    position->mean_iterations = self->count ? self->iterations / (double)self->count : NAN;
    position->largest_residual = self->largest_residual;
    position->max_iterations = self->count ? self->max_iterations : NAN;
    return EHD_OK;
}

ehd_status calibration_measure(trade_position *position, const online_model *model,
                               const solved_scene *scenes, size_t num_scenes, ehd_error *error) {
    online_solver *solver = NULL;
    samples measured = {0};
    ehd_status status = online_solver_create(&solver, model, error);

    position->num_failures = 0;
    if (!status)
        status =
            samples_init(&measured, scenes, num_scenes, online_describe(model).num_nodes, error);
    for (size_t i = 0; i < num_scenes && !status; i++)
        status = program_interrupted()
                     ? ehd_fail(error, EHD_INTERRUPTED, "%s", "")
                     : measure_scene(position, &measured, solver, &scenes[i], error);
    if (!status) status = evaluate(position, &measured, error);
    samples_free(&measured);
    online_solver_free(solver);
    return status;
}

// ---- in time

/* Sums and maxima over the trajectories in which every step converged and is trusted. Other
 * trajectories are called lost. */
typedef struct repetition {
    double worst[TRADE_PRESSURE];
    double iterations, seconds;
    size_t num_steps;
} repetition;

static void add_step(repetition *self, step_samples *steps, const march_step *outcome,
                     const film_bounds *bounds, const recorded_step *step,
                     const ehd_contact *reference) {
    const contact_scalars *full = &step->scalars;
    const contact_scalars reduced =
        frame_to_reference(&outcome->scalars, &outcome->frame, reference);
    const double deviation[TRADE_PRESSURE] = {
        relative(reduced.central_film_thickness, full->central_film_thickness),
        relative(reduced.minimum_film_thickness, full->minimum_film_thickness),
        relative(reduced.central_pressure, full->central_pressure)};

    for (int q = 0; q < TRADE_PRESSURE; q++)
        self->worst[q] = fmax(self->worst[q], deviation[q]);
    steps->samples[steps->count++] =
        (step_sample){.trajectory = steps->trajectory,
                      .deviation = {[REDUCED_CENTRAL_FILM] = deviation[TRADE_CENTRAL_FILM],
                                    [REDUCED_MINIMUM_FILM] = deviation[TRADE_MINIMUM_FILM]},
                      .bounds = *bounds};
}

/* Solves the start, or solves and accepts a step. */
static ehd_status repeat_step(march_step *outcome, const march_solver *solver,
                              const recorded_step *step, bool start, ehd_error *error) {
    ehd_status status =
        start ? solver->start(outcome, solver->self, &step->frame, error)
              : solver->attempt(outcome, solver->self, &step->frame, step->step, error);

    if (status || outcome->status || start) return status;
    outcome->frame = step->frame;
    solver->accept(solver->self);
    if (step->jump) solver->restart(solver->self);
    return EHD_OK;
}

/* Solves the steps of a recorded trajectory with the reduced model. Sets *lost to true if a step
 * did not converge or is not trusted. The bounds of the earlier steps are stored in this case
 * too. */
static ehd_status repeat(bool *lost, repetition *sum, step_samples *steps,
                         const online_model *model, const recording *wanted, ehd_error *error) {
    online_transient *in_time = NULL;
    repetition here = *sum;
    march_step outcome = {.status = EHD_OK};
    ehd_status status = online_transient_create(&in_time, model, wanted->reference, error);
    if (status) return status;

    const march_solver solver = online_march(in_time);
    reduced_march *const reduced = parts_march_part(solver.self, 0);
    reduced_march_indicate(reduced, (film_factors){1, 1, 0, 0}); // bounds without a factor
    for (size_t i = 0; i < wanted->num_steps && !status && !outcome.status; i++) {
        double before = program_seconds_of_thread();
        status = repeat_step(&outcome, &solver, &wanted->steps[i], i == 0, error);
        double seconds = program_seconds_of_thread() - before;
        if (program_interrupted()) status = ehd_fail(error, EHD_INTERRUPTED, "%s", "");
        if (status || outcome.status) break;
        const film_bounds bounds = reduced_march_bounds(reduced);
        add_step(&here, steps, &outcome, &bounds, &wanted->steps[i], wanted->reference);
        if (i == 0) continue; // the start is not a time step
        here.seconds += seconds;
        here.iterations += (double)outcome.iterations;
        here.num_steps++;
    }
    *lost = outcome.status != EHD_OK;
    if (!*lost) *sum = here;
    online_transient_free(in_time);
    return status;
}

ehd_status calibration_measure_in_time(trade_position *position, online_model *model,
                                       const recording *recordings, size_t num_recordings,
                                       ehd_error *error) {
    repetition sum = {0};
    step_samples steps = {0};
    size_t num_steps = 0;
    arena memory = {0};
    ehd_status status = online_prepare_transient(model, error);

    for (size_t t = 0; t < num_recordings; t++)
        num_steps += recordings[t].num_steps;
    double *indicated = arena_array(&memory, num_recordings, sizeof *indicated);
    bool *lost = arena_array(&memory, num_recordings, sizeof *lost);
    double *errors = arena_array(&memory, num_steps, sizeof *errors);
    steps.samples = arena_array(&memory, num_steps, sizeof *steps.samples);
    if (!status && memory.failed) status = ehd_no_memory(error, "calibration");
    position->num_lost = 0;
    for (size_t t = 0; t < num_recordings && !status; t++) {
        steps.trajectory = t;
        status = repeat(&lost[t], &sum, &steps, model, &recordings[t], error);
        position->num_lost += lost[t];
        indicated[t] = lost[t] ? 1 : 0;
    }
    for (int q = 0; q < TRADE_PRESSURE; q++)
        position->worst_in_time[q] = sum.num_steps ? sum.worst[q] : NAN;
    if (!status) {
        const film_factors factors = time_factors_fit(&steps, lost, errors);
        position->factor_in_time = factors.central;
        position->factor_in_time_minimum = factors.minimum;
        position->floor_in_time = factors.central_floor;
        position->floor_in_time_minimum = factors.minimum_floor;
        time_factors_apply(indicated, &factors, &steps);
        for (int i = 0; i < NUM_TIME_PARTS; i++)
            position->indicated_in_time[i] =
                trade_quantile_of(indicated, num_recordings, trade_time_parts[i]);
    }
    position->step_iterations = sum.num_steps ? sum.iterations / (double)sum.num_steps : NAN;
    position->step_seconds = sum.num_steps ? sum.seconds / (double)sum.num_steps : NAN;
    arena_free(&memory);
    return status;
}
