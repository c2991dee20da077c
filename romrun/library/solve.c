/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes stationary solutions and steps in time, and returns their fields. */
#include "romrun/library/internal.h"

#include "common/output/grid_file.h"
#include "common/physics/inlet_heating.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Sets EHDROM_UNTRUSTED and a reason if an error estimate exceeds the accuracy, or if the model
 * was not checked. */
static void judge(ehdrom_contact *self, ehdrom_result *result, const char **reason, bool in_time) {
    const double accuracy = isnan(self->accuracy) ? default_accuracy : self->accuracy;
    const online_properties properties = online_describe(self->model->online);

    if (result->status != EHDROM_OK || isinf(accuracy)) return;
    if (march_deviates(self->deviation, result->indicated_deviation,
                       result->indicated_deviation_minimum, accuracy))
        *reason = self->deviation;
    else
        *reason = online_unchecked(&properties, in_time);
    if (*reason) result->status = EHDROM_UNTRUSTED;
}

/* Fills in scalars in the caller's units. `width`: half width of the contact divided by the half
 * width of the reference. */
static void fill(ehdrom_result *result, const contact_scalars *scalars, double peak, double width,
                 const unit_factors *units) {
    result->load = scalars->load * units->load;
    result->approach = scalars->rigid_approach * units->film;
    result->central_film_thickness = scalars->central_film_thickness * units->film;
    result->minimum_film_thickness = scalars->minimum_film_thickness * units->film;
    result->central_pressure = scalars->central_pressure * units->pressure;
    result->peak_pressure = fmax(peak, scalars->central_pressure) * units->pressure;
    result->exit_position = scalars->exit_position * units->length;
    result->half_width = width * units->length;
}

/* Judges a result, copies it to the caller's struct, and returns its outcome. */
static ehd_status give(ehdrom_contact *self, ehdrom_result *target, ehdrom_result *own,
                       const char *reason, bool in_time) {
    judge(self, own, &reason, in_time);
    own->trusted = own->status == EHDROM_OK;
    ehd_status status = library_give(target, own, sizeof *own, "result", &self->error);
    if (!status && own->status)
        status = ehd_fail(&self->error, (ehd_status)own->status,
                          own->status == EHDROM_UNTRUSTED
                              ? "result: found %s, expected one to be trusted"
                              : "result: found %s, expected convergence",
                          reason);
    return status;
}

// ---- stationary

/* Sets EHD_UNTRUSTED, as romrun does, if the training's grid is too coarse to estimate the error
 * that the grid causes. */
static void judge_grid(online_result *found, const ehdrom_contact *self) {
    if (found->status) return;
    const film_effects effects = online_effects(self->model->online, &self->solved);
    if (!film_effects_are_infinite(&effects)) return;
    found->status = EHD_UNTRUSTED;
    found->reason = "a grid of the training that is too coarse to estimate its error";
}

static ehd_status solve(ehdrom_contact *self, ehdrom_result *result) {
    online_result found;
    ehd_status status = EHD_OK;

    self->last = LAST_NONE;
    self->differentiable = OF_NOTHING;
    if (!self->solver)
        status = online_solver_create(&self->solver, self->model->online, &self->error);
    if (!status)
        status = library_contact(&self->solved, &self->solved_units, self, false, &self->error);
    if (!status && !isnan(self->tolerance))
        online_solver_set_tolerance(self->solver, self->tolerance);
    if (!status) status = online_solve(&found, self->solver, &self->solved, &self->error);
    if (status) return status;
    judge_grid(&found, self);
    ehdrom_result own = {.status = (ehdrom_status)found.status,
                         .indicated_deviation = found.indicated,
                         .indicated_deviation_minimum = found.indicated_minimum,
                         .residual = found.residual,
                         .iterations = found.iterations,
                         .inlet_heating_factor = inlet_heating_of(&self->solved).factor};
    fill(&own, &found.scalars, found.peak_pressure, 1, &self->solved_units);
    if (found.status != EHD_NOT_CONVERGED) {
        self->last = LAST_SOLVED;
        self->scalars = found.scalars;
        self->differentiable = OF_SOLUTION;
    }
    return give(self, result, &own, found.reason, false);
}

ehdrom_status ehdrom_solve(ehdrom_contact *self, ehdrom_result *result) {
    ehd_status status = library_begin(self);

    if (!status) status = solve(self, result);
    return library_end(self, status);
}

// ---- steps in time

/* Discards the accepted state. */
static void forget_time(ehdrom_contact *self) {
    self->last = LAST_NONE;
    self->differentiable = OF_NOTHING;
    self->started = self->can_accept = false;
}

/* Makes the contact of the present settings the reference of the steps in time. */
static ehd_status take_reference(ehdrom_contact *self) {
    ehd_error *error = &self->error;
    ehd_status status = online_check_in_time(self->model->online, error);

    if (!status && !self->model->in_time)
        status = ehd_fail(error, EHD_INTERNAL,
                          "model: found one opened for stationary solutions alone, expected one "
                          "with what steps in time need");
    self->in_time = online_transient_free(self->in_time);
    self->is_reference = false;
    forget_time(self);
    if (!status)
        status = library_contact(&self->reference, &self->reference_units, self, true, error);
    if (!status)
        status =
            online_transient_create(&self->in_time, self->model->online, &self->reference, error);
    if (status) return status;
    online_transient_allow_short_steps(self->in_time);
    self->is_reference = true;
    return EHD_OK;
}

/* Sets the tolerance of the steps again, since it may have changed after the last call. */
static void use_step_tolerance(ehdrom_contact *self) {
    if (!isnan(self->step_tolerance))
        online_transient_set_tolerance(self->in_time, self->step_tolerance);
}

ehd_status library_conditions(online_conditions *own, const ehdrom_conditions *given,
                              const unit_factors *units, ehd_error *error) {
    ehdrom_conditions all = EHDROM_CONDITIONS_INIT;

    if (!given) return EHD_OK;
    if (given->size < offsetof(ehdrom_conditions, load))
        return ehd_fail(
            error, EHD_DATA,
            "conditions: found a struct without its size, expected one begun by its INIT");
    memcpy(&all, given, given->size < sizeof all ? given->size : sizeof all);
    if ((all.given & EHDROM_LOAD) && (all.given & EHDROM_APPROACH))
        return ehd_fail(error, EHD_DATA,
                        "conditions: found load and approach, expected one of them");
    const struct {
        unsigned bit;
        const char *name;
        const double *value;
        double unit;
        double *target;
        double above;
    } parts[] = {
        {EHDROM_LOAD, "load", &all.load, units->load, &own->load, 0},
        {EHDROM_APPROACH, "approach", &all.approach, units->film, &own->approach, -INFINITY},
        {EHDROM_SPEED, "speed", &all.speed, units->speed, &own->speed, 0},
        {EHDROM_RADIUS, "radius", &all.radius, units->radius, &own->radius, 0},
        {EHDROM_MODULUS, "modulus", &all.modulus, units->modulus, &own->modulus, 0}};
    unsigned known = 0;
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        const double value = *parts[i].value;
        const bool may_be_zero = parts[i].bit == EHDROM_SPEED || parts[i].bit == EHDROM_LOAD;
        known |= parts[i].bit;
        if (!(all.given & parts[i].bit)) continue;
        if (given->size < (size_t)((const char *)(parts[i].value + 1) - (const char *)&all))
            return ehd_fail(error, EHD_DATA, "%s: found a struct that ends before it",
                            parts[i].name);
        // checks the value while it is in the caller's units
        if (!isfinite(value) || !(value > parts[i].above || (may_be_zero && value == 0)))
            return ehd_fail(error, EHD_DATA, "%s: found %g, expected a %s", parts[i].name, value,
                            !isfinite(value) ? "finite number"
                            : may_be_zero    ? "number of at least 0"
                                             : "number above 0");
        *parts[i].target = value / parts[i].unit;
    }
    if (all.given & ~known)
        return ehd_fail(error, EHD_DATA, "conditions: found %#x given, expected EHDROM_LOAD | …",
                        all.given);
    if (all.given & EHDROM_APPROACH) own->load = NAN;
    return EHD_OK;
}

/* Converts the conditions at the end of a step. */
static ehd_status take_conditions(online_conditions *own, ehdrom_contact *self,
                                  const ehdrom_conditions *given) {
    *own = (online_conditions){.load = 1, .approach = NAN, .speed = 1, .radius = 1, .modulus = 1};
    const ehd_status status = library_conditions(own, given, &self->reference_units, &self->error);
    self->by_approach = !isnan(own->approach);
    return status;
}

static ehd_status give_state(ehdrom_contact *self, ehdrom_result *result,
                             const online_state *state) {
    const unit_factors *units = &self->reference_units;
    ehdrom_result own = {.status = (ehdrom_status)state->status,
                         .time = state->time * units->time,
                         .indicated_deviation = state->indicated,
                         .indicated_deviation_minimum = state->indicated_minimum,
                         .local_error = state->local_error,
                         .residual = state->residual,
                         .iterations = state->iterations,
                         .inlet_heating_factor = NAN};
    const double peak =
        state->status == EHD_NOT_CONVERGED ? NAN : online_transient_peak(self->in_time);

    fill(&own, &state->scalars, peak, state->half_width, units);
    return give(self, result, &own, state->reason, true);
}

static ehd_status start(ehdrom_contact *self, const ehdrom_conditions *given,
                        ehdrom_result *result) {
    online_conditions conditions;
    online_state state;
    ehd_status status = take_reference(self);

    if (!status) use_step_tolerance(self);
    if (!status) status = take_conditions(&conditions, self, given);
    if (!status) status = online_transient_start(&state, self->in_time, &conditions, &self->error);
    if (status) return status;
    self->started = state.status != EHD_NOT_CONVERGED;
    if (self->started) {
        self->last = LAST_IN_TIME;
        self->scalars = state.scalars;
        self->differentiable = OF_START;
    }
    return give_state(self, result, &state);
}

ehdrom_status ehdrom_start(ehdrom_contact *self, const ehdrom_conditions *conditions,
                           ehdrom_result *result) {
    ehd_status status = library_begin(self);

    if (!status) status = start(self, conditions, result);
    return library_end(self, status);
}

/* Begins a call that needs an accepted state. EHD_INTERNAL: there is no accepted state. */
static ehd_status begin_in_time(ehdrom_contact *self, const char *what) {
    const ehd_status status = library_begin(self);

    if (status || self->started) return status;
    return ehd_fail(&self->error, EHD_INTERNAL, "%s: found a contact at no time, expected %s", what,
                    "ehdrom_start or ehdrom_state_restore before");
}

static ehd_status step_on(ehdrom_contact *self, const ehdrom_conditions *given, double step,
                          ehdrom_result *result) {
    online_conditions conditions;
    online_state state;
    ehd_status status = take_conditions(&conditions, self, given);

    self->can_accept = false;
    self->differentiable = OF_NOTHING;
    if (!status && !(isgreater(step, 0) && isfinite(step)))
        status =
            ehd_fail(&self->error, EHD_DATA, "step: found %g, expected a number above 0", step);
    if (!status)
        status = online_step(&state, self->in_time, &conditions, step / self->reference_units.time,
                             &self->error);
    if (status) return status;
    self->can_accept = state.status != EHD_NOT_CONVERGED;
    if (self->can_accept) self->differentiable = OF_STEP;
    self->stepped = state.scalars;
    return give_state(self, result, &state);
}

ehdrom_status ehdrom_step(ehdrom_contact *self, const ehdrom_conditions *conditions, double step,
                          ehdrom_result *result) {
    ehd_status status = begin_in_time(self, "step");

    if (!status) status = step_on(self, conditions, step, result);
    return library_end(self, status);
}

/* The size of the caller's structs may differ from the size of the library's structs, so the arrays
 * are indexed with the caller's size. */
ehdrom_status ehdrom_step_many(ehdrom_contact *const *contacts, const ehdrom_conditions *conditions,
                               double step, ehdrom_result *results, size_t count) {
    const char *given = (const char *)conditions;
    char *result = (char *)results;
    ehdrom_status most = EHDROM_OK;

    for (size_t i = 0; i < count; i++) {
        ehdrom_result *own = (ehdrom_result *)result;
        const ehdrom_status status =
            ehdrom_step(contacts[i], (const ehdrom_conditions *)given, step, own);
        if (status > most) most = status;
        if (EHDROM_FAILED(status) && own && own->size >= 2 * sizeof(size_t)) own->status = status;
        if (given) given += conditions->size;
        if (result) result += results->size;
    }
    return most;
}

ehdrom_status ehdrom_accept(ehdrom_contact *self) {
    ehd_status status = begin_in_time(self, "accept");

    if (!status && !self->can_accept)
        status = ehd_fail(&self->error, EHD_INTERNAL,
                          "accept: found no step that converged, expected ehdrom_step before");
    if (status) return library_end(self, status);
    online_accept(self->in_time);
    self->can_accept = false;
    if (self->differentiable == OF_STEP) self->differentiable = OF_NOTHING;
    self->last = LAST_IN_TIME;
    self->scalars = self->stepped;
    return library_end(self, EHD_OK);
}

ehdrom_status ehdrom_restart(ehdrom_contact *self) {
    const ehd_status status = begin_in_time(self, "restart");

    if (!status) online_restart(self->in_time);
    return library_end(self, status);
}

// ---- saved states

/* Numbers that begin a saved state; they identify its model and settings. */
enum { SAVED_MARK, SAVED_COUNT, SAVED_M, SAVED_L, SAVED_ALPHA, SAVED_LENGTH, NUM_SAVED };

// Bounds of the states that are restored: only states that begin with this number, which is the
// version of their layout
static const double saved_mark = 3004;

static void head_of(double head[NUM_SAVED], const ehdrom_contact *self) {
    const ehd_contact *reference = &self->reference;

    head[SAVED_MARK] = saved_mark;
    head[SAVED_COUNT] = (double)(NUM_SAVED + online_saved_size(self->in_time));
    head[SAVED_M] = reference->moes_M;
    head[SAVED_L] = reference->moes_L;
    head[SAVED_ALPHA] = reference->alpha_p_H;
    head[SAVED_LENGTH] = reference->approach_length;
}

static ehd_status check_count(const ehdrom_contact *self, const double *state, size_t count,
                              ehd_error *error) {
    const size_t expected = NUM_SAVED + online_saved_size(self->in_time);

    if (state && count == expected) return EHD_OK;
    return ehd_fail(error, EHD_DATA, "saved state: found %zu numbers, expected %zu",
                    state ? count : 0, expected);
}

ehdrom_status ehdrom_state_size(ehdrom_contact *self, size_t *count) {
    ehd_status status = library_begin(self);

    if (!status && !self->in_time) status = take_reference(self);
    if (!status) *count = NUM_SAVED + online_saved_size(self->in_time);
    return library_end(self, status);
}

ehdrom_status ehdrom_state_save(ehdrom_contact *self, double *state, size_t count) {
    ehd_status status = begin_in_time(self, "save");

    if (!status) status = check_count(self, state, count, &self->error);
    if (!status) {
        head_of(state, self);
        online_save(state + NUM_SAVED, self->in_time);
    }
    return library_end(self, status);
}

/* Restores a saved state. Creates self->in_time anew only if the settings have changed, because
 * creating it takes four fifths of the time of a restoration. */
static ehd_status restore(ehdrom_contact *self, const double *state, size_t count) {
    double head[NUM_SAVED];
    ehd_status status = EHD_OK;

    forget_time(self);
    if (!self->is_reference) status = take_reference(self);
    if (!status) status = check_count(self, state, count, &self->error);
    if (status) return status;
    use_step_tolerance(self);
    head_of(head, self);
    for (size_t i = 0; i < NUM_SAVED; i++)
        if (state[i] != head[i])
            return ehd_fail(&self->error, EHD_DATA,
                            "saved state: found %.17g as number %zu, expected %.17g of this model "
                            "and these settings",
                            state[i], i, head[i]);
    status = online_restore(self->in_time, state + NUM_SAVED, &self->error);
    self->started = !status;
    if (!status) self->last = LAST_IN_TIME;
    if (!status) self->scalars.load = NAN;
    return status;
}

ehdrom_status ehdrom_state_restore(ehdrom_contact *self, const double *state, size_t count) {
    ehd_status status = library_begin(self);

    if (!status) status = restore(self, state, count);
    return library_end(self, status);
}

// ---- fields

/* Returns the scales of the last solution or accepted state, in the caller's units. EHD_INTERNAL:
 * there is no solution. */
static ehd_status scales_of_fields(unit_factors *scales, const ehdrom_contact *self,
                                   ehd_error *error) {
    if (self->last == LAST_NONE)
        return ehd_fail(error, EHD_INTERNAL, "fields: found no solution, expected one before");
    *scales = self->last == LAST_SOLVED ? self->solved_units : self->reference_units;
    if (self->last == LAST_SOLVED) return EHD_OK;
    const contact_frame frame = online_transient_frame(self->in_time);
    scales->length *= frame.half_width;
    scales->length_across *= frame.half_width;
    scales->pressure *= frame.hertz_pressure;
    scales->film *= frame.film_scale;
    return EHD_OK;
}

/* Fills the caller's array of `length` numbers with NaN behind the first `num` numbers. */
static void fill_behind(double *values, size_t num, size_t length) {
    for (size_t k = num; values && k < length; k++)
        values[k] = NAN;
}

ehdrom_status ehdrom_nodes(ehdrom_contact *self, size_t *num_x, size_t *num_y) {
    const ehd_status status = library_begin(self);

    if (status) return library_end(self, status);
    const ehd_grid whole = grid_whole(library_grid(self));
    if (num_x) *num_x = whole.inner_x;
    if (num_y) *num_y = whole.inner_lines;
    return library_end(self, EHD_OK);
}

ehdrom_status ehdrom_axes(ehdrom_contact *self, double *x, double *y) {
    ehd_status status = library_begin(self);
    unit_factors scales = {0};

    if (!status) status = scales_of_fields(&scales, self, &self->error);
    if (status) return library_end(self, status);
    const ehd_grid whole = grid_whole(library_grid(self));
    for (size_t i = 0; x && i < whole.inner_x; i++)
        x[i] = grid_x(&whole, grid_node_of_row(&whole, i)) * scales.length;
    for (size_t l = 0; y && l < whole.inner_lines; l++)
        y[l] = grid_y(&whole, grid_node_of_row(&whole, l * whole.inner_x)) * scales.length_across;
    fill_behind(x, whole.inner_x, online_grid(self->model->online)->inner_x);
    return library_end(self, EHD_OK);
}

const ehd_grid *library_grid(const ehdrom_contact *self) {
    return self->last == LAST_SOLVED ? online_solved_grid(self->solver)
                                     : online_grid(self->model->online);
}

ehd_status library_fields(ehdrom_contact *self) {
    const size_t num_nodes = online_grid(self->model->online)->num_nodes;
    ehd_status status;

    if (!self->pressure) self->pressure = calloc(num_nodes, sizeof(double));
    if (!self->film) self->film = calloc(num_nodes, sizeof(double));
    if (!self->pressure || !self->film) return ehd_no_memory(&self->error, "fields");
    status = self->last == LAST_SOLVED
                 ? online_fields(self->pressure, self->film, self->solver, &self->error)
                 : online_transient_fields(self->pressure, self->film, self->in_time, &self->error);
    return status;
}

void library_give_field(double *target, const double *nodes, double unit,
                        const ehdrom_contact *self) {
    const ehd_grid *grid = library_grid(self);
    const size_t num = grid_whole(grid).num_inner;

    if (!target) return;
    grid_take_inner(target, nodes, grid, true);
    for (size_t k = 0; k < num; k++)
        target[k] *= unit;
    fill_behind(target, num, grid_whole(online_grid(self->model->online)).num_inner);
}

ehdrom_status ehdrom_fields(ehdrom_contact *self, double *pressure, double *film) {
    ehd_status status = library_begin(self);
    unit_factors scales = {0};

    if (!status) status = scales_of_fields(&scales, self, &self->error);
    if (!status) status = library_fields(self);
    if (!status) {
        library_give_field(pressure, self->pressure, scales.pressure, self);
        library_give_field(film, self->film, scales.film, self);
    }
    return library_end(self, status);
}
