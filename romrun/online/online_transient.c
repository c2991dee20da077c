/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Solves a transient contact step by step, with the marches of the model's parts. Called by
 * time_run (romrun), the library and FMUs through online.h. */
#include "romrun/online/online_objects.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static ehd_status create_marches(online_transient *self, ehd_error *error) {
    const size_t num_parts = self->model->num_parts;
    reduced_march *marches[MAX_PARTS] = {NULL};
    ehd_status status = EHD_OK;

    for (size_t p = 0; p < num_parts && !status; p++) {
        const model_part *part = &self->model->parts[p];
        status = reduced_march_create(&marches[p], &part->reduced, &part->splines, &self->reference,
                                      &reduced_defaults, error);
        if (!status) reduced_march_indicate(marches[p], part->in_time);
    }
    if (!status) return parts_march_create(&self->march, marches, num_parts, error);
    for (size_t p = 0; p < num_parts; p++)
        reduced_march_free(marches[p]);
    return status;
}

ehd_status online_transient_create(online_transient **transient, const online_model *model,
                                   const ehd_contact *reference, ehd_error *error) {
    ehd_status status = part_check_contact(&model->parts[0], reference, error);

    *transient = NULL;
    for (size_t p = 0; p < model->num_parts && !status; p++)
        if (!model->parts[p].transient)
            status = online_not_prepared(&model->parts[p], "online_prepare_transient", error);
    if (status) return status;
    online_transient *self = calloc(1, sizeof *self);
    if (!self) return ehd_no_memory(error, "online solver");
    self->model = model;
    self->reference = *reference;
    contact_take_grid(&self->reference, online_grid(model));
    status = create_marches(self, error);
    if (status) {
        online_transient_free(self);
        return status;
    }
    apart_init(&self->contact, parts_march_solver(self->march), &self->reference, INFINITY);
    self->solver = apart_solver(&self->contact);
    *transient = self;
    return EHD_OK;
}

online_transient *online_transient_free(online_transient *self) {
    if (self) {
        parts_march_free(self->march);
        reduced_tangent_free(self->tangent);
        free(self);
    }
    return NULL;
}

void online_transient_set_tolerance(online_transient *self, double tolerance) {
    for (size_t p = 0; p < self->model->num_parts; p++)
        reduced_march_set_tolerance(parts_march_part(self->march, p), tolerance);
}

void online_transient_allow_short_steps(online_transient *self) {
    for (size_t p = 0; p < self->model->num_parts; p++)
        reduced_march_allow_short_steps(parts_march_part(self->march, p));
}

march_solver online_march(online_transient *self) {
    return parts_march_solver(self->march);
}

reduced_march *transient_march_of_attempt(const online_transient *self) {
    return parts_march_part(self->march, self->solved ? parts_march_attempted(self->march)
                                                      : parts_march_accepted(self->march));
}

static reduced_march *march_of_accepted(const online_transient *self) {
    return parts_march_part(self->march, parts_march_accepted(self->march));
}

static void fill_state(online_state *state, const online_transient *self) {
    const march_step *step = &self->last;

    *state = (online_state){.status = step->status,
                            .reason = step->reason,
                            .time = step->frame.time,
                            .scalars =
                                frame_to_reference(&step->scalars, &step->frame, &self->reference),
                            .half_width = step->apart ? 0 : step->frame.half_width,
                            .local_error = step->local_error,
                            .indicated = step->indicated,
                            .indicated_minimum = step->indicated_minimum,
                            .iterations = step->iterations,
                            .residual = step->residual};
}

contact_frame transient_frame_of(const online_transient *self, const online_conditions *conditions,
                                 double step) {
    double values[NUM_VARY] = {
        [VARY_LOAD] = isnan(conditions->load)
                          ? load_forecast_scale(&self->now.forecast, step, &self->reference.grid)
                          : conditions->load,
        [VARY_SPEED] = conditions->speed,
        [VARY_RADIUS] = conditions->radius,
        [VARY_MODULUS] = conditions->modulus};

    contact_frame frame =
        frame_at(self->reference.kind, self->now.time + step, values, conditions->approach);
    frame.path = self->now.path + step * (self->now.speed + conditions->speed) / 2;
    return frame;
}

static ehd_status check_conditions(const online_conditions *conditions,
                                   const ehd_contact *reference, ehd_error *error) {
    bool expected = isnan(conditions->load) && !isnan(conditions->approach);
    const struct {
        const char *name;
        double value;
        bool zero_allowed;
    } values[] = {{"load", expected ? 1 : conditions->load, isnan(conditions->approach)},
                  {"speed", conditions->speed, true},
                  {"radius", conditions->radius, false},
                  {"modulus", conditions->modulus, false}};

    for (size_t i = 0; i < sizeof values / sizeof *values; i++)
        if (!(isgreaterequal(values[i].value, 0) && isfinite(values[i].value)) ||
            (values[i].value == 0 && !values[i].zero_allowed))
            return ehd_fail(error, EHD_DATA, "%s: found %g, expected a number %s", values[i].name,
                            values[i].value, values[i].zero_allowed ? "of at least 0" : "above 0");
    if (isinf(conditions->approach))
        return ehd_fail(
            error, EHD_DATA,
            "approach: found %g, expected a finite number, or nan where the load is given",
            conditions->approach);
    return isnan(conditions->approach) ? EHD_OK : contact_check_approach(reference, error);
}

ehd_status online_transient_start(online_state *state, online_transient *self,
                                  const online_conditions *conditions, ehd_error *error) {
    const march_solver solver = self->solver;
    ehd_status status = check_conditions(conditions, &self->reference, error);

    if (!status) status = march_check_start(conditions->speed, !isnan(conditions->approach), error);
    if (status) return status;
    self->started = self->solved = self->at_start = self->linearised = false;
    self->conditions = *conditions;
    self->now.time = 0;
    self->now.forecast = (load_forecast){.load = 1, .scale = 1};
    self->now.path = 0;
    self->now.speed = conditions->speed;
    contact_frame frame = transient_frame_of(self, conditions, 0);
    status = solver.start(&self->last, solver.self, &frame, error);
    if (status) return status;
    self->started = self->last.status != EHD_NOT_CONVERGED;
    self->at_start = self->started && !self->last.apart;
    load_forecast_start(&self->now.forecast, &self->last);
    fill_state(state, self);
    return EHD_OK;
}

ehd_status online_step(online_state *state, online_transient *self,
                       const online_conditions *conditions, double step, ehd_error *error) {
    const march_solver solver = self->solver;
    ehd_status status = check_conditions(conditions, &self->reference, error);

    if (!status && !(isgreater(step, 0) && isfinite(step)))
        status = ehd_fail(error, EHD_DATA, "step: found %g, expected a number above 0", step);
    if (!status && !self->started)
        status = ehd_fail(error, EHD_INTERNAL,
                          "step: found no accepted state, expected online_transient_start or "
                          "online_restore before");
    self->solved = self->at_start = self->linearised = false;
    if (status) return status;
    const contact_frame frame = transient_frame_of(self, conditions, step);
    status = solver.attempt(&self->last, solver.self, &frame, step, error);
    if (status) return status;
    self->last.step = step;
    self->solved = self->last.status != EHD_NOT_CONVERGED;
    self->conditions = *conditions;
    fill_state(state, self);
    return EHD_OK;
}

void online_accept(online_transient *self) {
    const march_solver solver = self->solver;

    if (!self->solved) return;
    self->solved = self->at_start = false;
    solver.accept(solver.self);
    load_forecast_accept(&self->now.forecast, &self->last);
    self->now.time = self->last.frame.time;
    self->now.path = self->last.frame.path;
    self->now.speed = self->last.frame.speed;
}

void online_restart(online_transient *self) {
    const march_solver solver = self->solver;

    solver.restart(solver.self);
}

enum { NUM_OWN = sizeof(accepted_moment) / sizeof(double) };

size_t online_saved_size(const online_transient *self) {
    const march_solver solver = self->solver;

    return NUM_OWN + solver.saved_size(solver.self);
}

void online_save(double *saved, const online_transient *self) {
    const march_solver solver = self->solver;

    memcpy(saved, &self->now, sizeof self->now);
    solver.save(saved + NUM_OWN, solver.self);
}

static ehd_status check_moment(const accepted_moment *of, ehd_error *error) {
    const load_forecast *forecast = &of->forecast;

    if (!(isgreaterequal(of->time, 0) && isgreater(forecast->load, 0) && isfinite(forecast->load) &&
          isgreater(forecast->scale, 0) && isfinite(forecast->scale) && isfinite(forecast->rate) &&
          isgreaterequal(forecast->last_step, 0) && isfinite(forecast->last_step)))
        return ehd_fail(
            error, EHD_DATA,
            "saved state: found time %g, load %g, scale %g, its rate %g and a last step of %g, "
            "expected a time, loads above 0, a finite rate and a step",
            of->time, forecast->load, forecast->scale, forecast->rate, forecast->last_step);
    if (!(isfinite(of->path) && isgreaterequal(of->speed, 0)))
        return ehd_fail(error, EHD_DATA,
                        "saved state: found path %g and speed %g, expected a path and a speed of "
                        "at least 0",
                        of->path, of->speed);
    return EHD_OK;
}

ehd_status online_restore(online_transient *self, const double *saved, ehd_error *error) {
    const march_solver solver = self->solver;
    accepted_moment now;

    memcpy(&now, saved, sizeof now);
    self->started = self->solved = self->at_start = false;
    ehd_status status = check_moment(&now, error);
    if (!status) status = solver.restore(solver.self, saved + NUM_OWN, error);
    if (status) return status;
    self->now = now;
    self->started = true;
    return EHD_OK;
}

ehd_status online_transient_fields(double *pressure, double *film, online_transient *self,
                                   ehd_error *error) {
    const march_solver solver = self->solver;

    return solver.fields(pressure, film, solver.self, error);
}

bool transient_is_apart(const online_transient *self) {
    return self->solved ? self->last.apart : self->contact.now.apart == 1;
}

size_t transient_steps_before(const online_transient *self) {
    return self->solved && !self->last.begins ? 0 : 1;
}

double online_transient_peak(const online_transient *self) {
    reduced_march *of = transient_march_of_attempt(self);
    const reduced_state state = reduced_march_state_before(of, transient_steps_before(self), NULL);

    if (transient_is_apart(self)) return 0;
    return reduced_pressure_range(reduced_march_inner(of), &state).largest *
           self->last.frame.hertz_pressure;
}

contact_traction online_attempt_traction(online_transient *self, const ehd_contact *contact,
                                         const contact_scalars *scalars) {
    reduced_march *of = transient_march_of_attempt(self);
    const reduced_state state = reduced_march_state_before(of, transient_steps_before(self), NULL);

    if (!online_has_traction(self->model)) return contact_traction_unknown();
    return reduced_traction(reduced_march_inner(of), &state, contact, scalars);
}

contact_frame online_attempt_frame(const online_transient *self) {
    return self->solved ? self->last.frame : online_transient_frame(self);
}

contact_frame online_transient_frame(const online_transient *self) {
    contact_frame frame;

    if (self->contact.now.apart == 1) return self->contact.now.frame;
    reduced_march_state(march_of_accepted(self), &frame);
    return frame;
}

size_t online_transient_part(const online_transient *self) {
    return self->solved ? parts_march_attempted(self->march) : parts_march_accepted(self->march);
}
