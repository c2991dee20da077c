/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/online/online.h"

#include "common/settings/part_list.h"
#include "common/time/apart.h"
#include "romrun/model/model_file.h"
#include "romrun/online/part.h"
#include "romrun/online/parts_march.h"
#include "romrun/solve/guess.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct online_model {
    char *path;
    part_list list; // files that the model consists of
    flat *files;    // [list.num] tables of the flat ones among these files
    size_t num_parts;
    model_part parts[MAX_PARTS]; // all have the same kind, discretisation and carriage
};

struct online_solver {
    const online_model *model;
    part_solver *parts; // [model->num_parts]
    part_solver *used;  // part that made the last solution
};

// ---- models

static bool same_size(size_t wanted, size_t own) {
    return wanted == 0 || wanted == own;
}

/* Opens the parts of a flat file; they follow one another in the file. */
static ehd_status open_flat(online_model *self, size_t index, const model_sizes *sizes,
                            ehd_error *error) {
    const char *path = self->list.paths[index];
    const size_t first = self->num_parts;
    flat *file = &self->files[index];
    ehd_status status = flat_read(file, path, error);

    do {
        model_part *part = &self->parts[self->num_parts];
        if (status) return status;
        if (self->num_parts == MAX_PARTS)
            return ehd_fail(error, EHD_DATA, "%s: found more than %d models, expected fewer", path,
                            MAX_PARTS);
        self->num_parts++;
        part->path = path;
        part->flat = true;
        part_walk(file, part);
        status = flat_good(file) ? part_finish(part, error) : file->status;
    } while (file->at < file->size);
    if (status || !sizes) return status;
    const reduced_model *model = &self->parts[first].reduced;
    if (self->num_parts == first + 1 && same_size(sizes->pressure_modes, model->num_pressure) &&
        same_size(sizes->deformation_modes, model->num_deformation) &&
        same_size(sizes->rows, model->rows.num_rows))
        return EHD_OK;
    if (self->num_parts > first + 1 &&
        !(sizes->pressure_modes || sizes->deformation_modes || sizes->rows))
        return EHD_OK;
    flat_refuse(file,
                "found a flat model of %zu pressure modes, %zu deformation modes and %zu rows, "
                "expected no others to be asked for",
                model->num_pressure, model->num_deformation, model->rows.num_rows);
    return file->status;
}

static ehd_status open_file(online_model *self, size_t index, const model_sizes *sizes,
                            ehd_error *error) {
    const char *path = self->list.paths[index];
    bool is_flat = false;
    ehd_status status = flat_is(&is_flat, path, error);

    if (status) return status;
    if (is_flat) return open_flat(self, index, sizes, error);
    if (self->num_parts == MAX_PARTS)
        return ehd_fail(error, EHD_DATA, "%s: found more than %d models, expected fewer",
                        self->path, MAX_PARTS);
    return part_open(&self->parts[self->num_parts++], path, sizes, error);
}

/* Checks whether parts can be in one list: they need the same kind of contact, discretisation and
 * boundary. Point contacts and ellipses also need the same grid. */
static bool alike(const reduced_model *a, const reduced_model *b) {
    return a->kind == b->kind && a->grid.discretization == b->grid.discretization &&
           a->grid.boundary == b->grid.boundary &&
           (a->kind->dimensions == 1 || grid_same(&a->grid, &b->grid));
}

/* Checks whether all parts can be in one list and carry films in the same way. */
static ehd_status check_alike(const online_model *self, ehd_error *error) {
    const reduced_model *first = &self->parts[0].reduced;

    for (size_t p = 1; p < self->num_parts; p++) {
        const reduced_model *other = &self->parts[p].reduced;
        if (!alike(other, first))
            return ehd_fail(
                error, EHD_DATA,
                "%s: found a %s contact with %zu nodes from %g in steps of %g (%s, %s), "
                "expected one as of %s: a %s contact with %zu from %g in steps of %g (%s, %s)",
                self->parts[p].path, other->kind->name, other->grid.num_inner, other->grid.x_min,
                other->grid.step, discretization_name(other->grid.discretization),
                boundary_name(other->grid.boundary), self->parts[0].path, first->kind->name,
                first->grid.num_inner, first->grid.x_min, first->grid.step,
                discretization_name(first->grid.discretization),
                boundary_name(first->grid.boundary));
        const ehd_status status = carriage_check(&other->carriage, self->parts[p].path,
                                                 &first->carriage, self->parts[0].path, error);
        if (status) return status;
    }
    return EHD_OK;
}

/* Returns the first part whose grid differs from that of part 0; 0: there is none. */
static size_t part_of_other_grid(const online_model *self) {
    for (size_t p = 1; p < self->num_parts; p++)
        if (!grid_same(&self->parts[p].reduced.grid, &self->parts[0].reduced.grid)) return p;
    return 0;
}

ehd_status online_open(online_model **model, const char *path, const part_sizes *sizes,
                       ehd_error *error) {
    online_model *self = calloc(1, sizeof *self);

    *model = NULL;
    if (self) self->path = strdup(path);
    if (!self || !self->path) {
        free(self);
        return ehd_no_memory(error, path);
    }
    ehd_status status = part_list_read(&self->list, path, error);
    if (!status) {
        self->files = calloc(self->list.num, sizeof *self->files);
        if (!self->files) status = ehd_no_memory(error, path);
    }
    for (size_t i = 0; i < self->list.num && !status; i++)
        status = open_file(self, i, sizes ? &sizes->of[i] : NULL, error);
    if (!status) status = check_alike(self, error);
    if (status)
        online_close(self);
    else
        *model = self;
    return status;
}

void online_release_file(online_model *self) {
    for (size_t p = 0; p < self->num_parts; p++)
        part_release_file(&self->parts[p]);
}

online_model *online_close(online_model *self) {
    if (!self) return NULL;
    for (size_t p = 0; p < self->num_parts; p++)
        part_close(&self->parts[p]);
    for (size_t i = 0; i < self->list.num && self->files; i++)
        if (self->files[i].reading) flat_free(&self->files[i]);
    part_list_free(&self->list);
    free(self->files);
    free(self->path);
    free(self);
    return NULL;
}

ehd_status online_is_flat(bool *is, const char *path, ehd_error *error) {
    *is = false;
    return part_list_is(path) ? EHD_OK : flat_is(is, path, error);
}

ehd_status online_export(online_model *self, const char *path, bool force, ehd_error *error) {
    flat file;
    bool in_time = true;
    ehd_status status = EHD_OK;

    for (size_t p = 0; p < self->num_parts; p++) {
        const model_part *part = &self->parts[p];
        in_time = in_time && (part->transient ||
                              (part->source && model_has_modes(part->source, &part->reduced)));
    }
    in_time = in_time && !part_of_other_grid(self);
    status = in_time ? online_prepare_transient(self, error) : online_prepare_fields(self, error);
    if (status) return status;
    flat_begin(&file, path, error);
    for (size_t p = 0; p < self->num_parts; p++)
        part_walk(&file, &self->parts[p]);
    status = flat_write(&file, force);
    flat_free(&file);
    return status;
}

/* Returns the sizes of the largest part. */
online_properties online_describe(const online_model *self) {
    const reduced_model *largest = &self->parts[0].reduced;
    const ehd_grid *grid = online_grid(self);
    bool checked = true, checked_in_time = true;
    size_t num_states = 0;

    for (size_t p = 0; p < self->num_parts; p++) {
        const model_part *part = &self->parts[p];
        checked = checked && part->indicator_factor > 0;
        checked_in_time = checked_in_time && part->checked_in_time;
        num_states += part->reduced.states.num_states;
        if (part->reduced.num_unknowns > largest->num_unknowns) largest = &part->reduced;
    }
    return (online_properties){.num_inner = grid->num_inner,
                               .num_nodes = grid->num_nodes,
                               .num_lines = grid_whole(grid).inner_lines,
                               .x_min = grid->x_min,
                               .step = grid->step,
                               .discretization = discretization_name(grid->discretization),
                               .boundary = boundary_name(grid->boundary),
                               .deformation = deformation_names[largest->deformation],
                               .transport = transport_name(largest->carriage.transport),
                               .pressure_modes = largest->num_pressure,
                               .deformation_modes = largest->num_deformation,
                               .unknowns = largest->num_unknowns,
                               .rows = largest->rows.num_rows,
                               .needed_nodes = largest->rows.num_needed,
                               .states = num_states,
                               .parts = self->num_parts,
                               .checked = checked,
                               .checked_in_time = checked_in_time};
}

const char *online_unchecked(const online_properties *model, bool in_time) {
    if (in_time)
        return model->checked_in_time
                   ? NULL
                   : "a model without a successful check in time at these sizes, which romrun "
                     "--calibrate does with a transient plan, and deimselect of a transient "
                     "training without --no-check";
    return model->checked ? NULL
                          : "a model never checked at these sizes, which romrun --calibrate does, "
                            "and deimselect without --no-check";
}

const double online_accuracy = 0.01;

const contact_kind *online_kind(const online_model *model) {
    return model->parts[0].reduced.kind;
}

const char *online_path(const online_model *model) {
    return model->path;
}

const char *online_part_path(const online_model *model, size_t part) {
    return model->parts[part].path;
}

const ehd_grid *online_grid(const online_model *model) {
    const ehd_grid *largest = &model->parts[0].reduced.grid;

    for (size_t p = 1; p < model->num_parts; p++)
        if (model->parts[p].reduced.grid.num_nodes > largest->num_nodes)
            largest = &model->parts[p].reduced.grid;
    return largest;
}

ehd_status online_check_in_time(const online_model *model, ehd_error *error) {
    const size_t other = part_of_other_grid(model);
    const ehd_grid *first = &model->parts[0].reduced.grid, *of = &model->parts[other].reduced.grid;

    if (other)
        return ehd_fail(error, EHD_DATA,
                        "%s: found %zu nodes from %g in steps of %g, expected for contacts in time "
                        "the grid of %s, %zu from %g in steps of %g: parts hand films to each "
                        "other node by node",
                        model->parts[other].path, of->num_inner, of->x_min, of->step,
                        model->parts[0].path, first->num_inner, first->x_min, first->step);
    return discretization_check_in_time(first->discretization, error);
}

ehd_status online_prepare_fields(online_model *self, ehd_error *error) {
    ehd_status status = EHD_OK;

    for (size_t p = 0; p < self->num_parts && !status; p++)
        status = part_prepare_fields(&self->parts[p], error);
    return status;
}

ehd_status online_prepare_transient(online_model *self, ehd_error *error) {
    ehd_status status = online_check_in_time(self, error);

    for (size_t p = 0; p < self->num_parts && !status; p++)
        status = part_prepare_transient(&self->parts[p], error);
    return status;
}

/* Returns the part in whose trained range a contact lies deepest, or else the nearest part. If any
 * parts have the grid that the contact gives, it chooses among these only. */
static size_t part_for(const online_model *self, const part_solver *solvers,
                       const ehd_contact *contact) {
    const contact_place place = contact_place_of(contact);
    bool fits[MAX_PARTS], any = false;
    double least = INFINITY;
    size_t found = 0;

    if (self->num_parts == 1) return 0;
    for (size_t p = 0; p < self->num_parts; p++) {
        fits[p] = !part_check_contact(&self->parts[p], contact, NULL);
        any = any || fits[p];
    }
    for (size_t p = 0; p < self->num_parts; p++) {
        range_memory *memory = solvers ? solvers[p].range_memory : NULL;
        if (any && !fits[p]) continue;
        const double here = trained_range_outside(self->parts[p].range, memory, place);
        if (!(here < least)) continue;
        least = here;
        found = p;
    }
    return found;
}

ehd_status online_show(online_model *model, const shown_lubricants *shown, ehd_error *error) {
    ehd_status status = EHD_OK;

    for (size_t p = 0; p < model->num_parts && !status; p++)
        status = part_show(&model->parts[p], shown, error);
    return status;
}

const ehd_grid *online_grid_for(const online_model *model, const ehd_contact *contact) {
    return &model->parts[part_for(model, NULL, contact)].reduced.grid;
}

film_effects online_effects(const online_model *model, const ehd_contact *contact) {
    const model_part *part = &model->parts[part_for(model, NULL, contact)];

    return reduced_effects(&part->reduced, contact_place_of(contact));
}

bool online_has_traction(const online_model *model) {
    bool all = true;

    for (size_t p = 0; p < model->num_parts; p++)
        all = all && part_has_traction(&model->parts[p]);
    return all;
}

// ---- stationary

ehd_status online_solver_create(online_solver **solver, const online_model *model,
                                ehd_error *error) {
    online_solver *self = calloc(1, sizeof *self);
    ehd_status status = EHD_OK;

    *solver = NULL;
    if (self) self->parts = calloc(model->num_parts, sizeof *self->parts);
    if (!self || !self->parts) {
        free(self);
        return ehd_no_memory(error, "online solver");
    }
    self->model = model;
    self->used = self->parts;
    for (size_t p = 0; p < model->num_parts && !status; p++)
        status = part_solver_init(&self->parts[p], &model->parts[p], error);
    if (status)
        online_solver_free(self);
    else
        *solver = self;
    return status;
}

online_solver *online_solver_free(online_solver *self) {
    if (self) {
        for (size_t p = 0; p < self->model->num_parts; p++)
            part_solver_free(&self->parts[p]);
        free(self->parts);
        free(self);
    }
    return NULL;
}

void online_solver_set_tolerance(online_solver *self, double tolerance) {
    for (size_t p = 0; p < self->model->num_parts; p++)
        reduced_solver_set_tolerance(self->parts[p].reduced, tolerance);
}

ehd_status online_solve(online_result *result, online_solver *solver, const ehd_contact *contact,
                        ehd_error *error) {
    const size_t part = part_for(solver->model, solver->parts, contact);
    const ehd_status status = part_solve(result, &solver->parts[part], contact, error);

    solver->used = &solver->parts[part];
    if (!status) result->part = part;
    return status;
}

online_indications online_indicate(online_solver *solver, const ehd_contact *contact) {
    return part_indicate(solver->used, contact);
}

double online_indicate_peak(online_solver *solver) {
    return part_indicate_peak(solver->used);
}

contact_traction online_traction(online_solver *solver, const ehd_contact *contact) {
    return part_traction(solver->used, contact);
}

double online_friction_bound(online_solver *solver, const ehd_contact *contact, double friction) {
    return part_friction_bound(solver->used, contact, friction);
}

double online_indicate_friction(online_solver *solver, const ehd_contact *contact,
                                double friction) {
    return part_indicate_friction(solver->used, contact, friction);
}

const ehd_grid *online_solved_grid(const online_solver *solver) {
    return &solver->used->model->reduced.grid;
}

static ehd_status not_prepared(const model_part *model, const char *call, ehd_error *error) {
    return ehd_fail(error, EHD_INTERNAL,
                    "%s: found a model that is not prepared, expected %s before", model->path,
                    call);
}

ehd_status online_fields(double *pressure, double *film, const online_solver *solver,
                         ehd_error *error) {
    const part_solver *used = solver->used;
    const model_part *model = used->model;

    if (!model->fields) return not_prepared(model, "online_prepare_fields", error);
    reduced_fields(pressure, film, &used->state, &model->reduced, model->fields);
    return EHD_OK;
}

void online_exits(double *positions, const online_solver *solver) {
    const part_solver *used = solver->used;
    const reduced_model *model = &used->model->reduced;

    if (model->band.num_lines == 1)
        positions[0] = reduced_exit_position(&used->state, model);
    else
        grid_exits(positions, reduced_state_exits(&used->state), &model->grid);
}

// ---- in time

/* Data of the last accepted state that its march does not hold. All members are doubles, so that
 * the struct can be saved as an array. */
typedef struct accepted_moment {
    double time;
    load_forecast forecast; // if the approach is given: load that scales the next frame
    double path, speed;     // path that the fluid has travelled, and its speed
} accepted_moment;

struct online_transient {
    const online_model *model;
    ehd_contact reference;
    parts_march *march;
    apart_march contact; // `march` extended by bodies that separate
    march_solver solver; // solver of `contact`
    bool started;        // true: there is an accepted state
    bool solved;         // true: there is a step that can be accepted
    march_step last;     // the last solved step
    accepted_moment now;
    // conditions of the last step, which begins at `now`, or of the start
    online_conditions conditions;
    bool at_start;            // true: no step was taken since the start
    size_t of;                // index of the part to which the tangent belongs
    reduced_tangent *tangent; // NULL: not needed yet
    bool linearised;          // true: the tangent is linearised at the present solution
};

/* Creates a march for each part. */
static ehd_status create_marches(online_transient *self, ehd_error *error) {
    const reduced_settings settings = reduced_default_settings();
    const size_t num_parts = self->model->num_parts;
    reduced_march *marches[MAX_PARTS] = {NULL};
    ehd_status status = EHD_OK;

    for (size_t p = 0; p < num_parts && !status; p++) {
        const model_part *part = &self->model->parts[p];
        status = reduced_march_create(&marches[p], &part->reduced, &part->splines, &self->reference,
                                      &settings, error);
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
            status = not_prepared(&model->parts[p], "online_prepare_transient", error);
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

void online_march_effort(double *rows, double *linear, double *exit, const void *solver) {
    reduced_march_effort effort = parts_march_effort_of(solver);

    *rows = effort.seconds_rows + effort.seconds_previous;
    *linear = effort.seconds_linear;
    *exit = effort.seconds_exit;
}

/* Returns the march of the solved step that is not accepted yet. Without such a step, returns the
 * march of the last accepted state. */
static reduced_march *march_of_attempt(const online_transient *self) {
    return parts_march_part(self->march, self->solved ? parts_march_attempted(self->march)
                                                      : parts_march_accepted(self->march));
}

/* Returns the march of the last accepted state. */
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

static contact_frame frame_of(const online_transient *self, const online_conditions *conditions,
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
    contact_frame frame = frame_of(self, conditions, 0);
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
    const contact_frame frame = frame_of(self, conditions, step);
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

/* Checks whether the bodies are apart in the last solved step or, without one, in the accepted
 * state. */
static bool is_apart(const online_transient *self) {
    return self->solved ? self->last.apart : self->contact.now.apart == 1;
}

/* Returns the place of the last step among the states of its march: 0 for an attempt, 1 for a start
 * (a start is accepted at once). */
static size_t steps_before(const online_transient *self) {
    return self->solved && !self->last.begins ? 0 : 1;
}

double online_transient_peak(const online_transient *self) {
    reduced_march *of = march_of_attempt(self);
    const reduced_state state = reduced_march_state_before(of, steps_before(self), NULL);

    if (is_apart(self)) return 0;
    return reduced_pressure_range(reduced_march_inner(of), &state).largest *
           self->last.frame.hertz_pressure;
}

contact_traction online_attempt_traction(online_transient *self, const ehd_contact *contact,
                                         const contact_scalars *scalars) {
    reduced_march *of = march_of_attempt(self);
    const reduced_state state = reduced_march_state_before(of, steps_before(self), NULL);

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

// ---- derivatives

/* A solution and its conditions. */
typedef struct solved_frame {
    const ehd_contact *reference;
    reduced_state state;
    online_conditions at; // conditions; the load scales the frame
    bool by_approach;     // true: the approach was given, not the load
    bool exit_at_node;
    void (*set_frame)(contact_frame *frame, const void *context,
                      const online_conditions *conditions);
    const void *context; // argument of set_frame
    frame_equations equations;
    reduced_tangent *tangent;
    bool *linearised; // true: the tangent is linearised at this solution, for all directions
} solved_frame;

/* Relative distance between the two sets of conditions of a central difference (distance_of). Only
 * the residuals of the rows are differenced, at fixed coordinates. The derivatives of central and
 * minimum film by load and speed were computed for the line contact of scenes/examples. With 2e-3
 * to 2e-5 they change by less than 1e-6, with 2e-2 by 6e-4 and with 2e-7 by 6e-5
 * (test_derivatives.c, derivatives_of_lines_are_those_of_differences). */
static const double DISTANCE = 2e-4;

/* Returns how far apart both sets of conditions of a central difference lie, in units of
 * `direction`; 0: the direction is zero. */
static double distance_of(const solved_frame *of, const online_direction *direction) {
    const online_conditions *at = &of->at;
    const double rates[] = {
        of->by_approach ? direction->approach : direction->load / at->load,
        direction->speed / (at->speed > 0 ? at->speed : 1),
        direction->radius / at->radius,
        direction->modulus / at->modulus,
    };
    double fastest = 0;

    for (size_t i = 0; i < sizeof rates / sizeof *rates; i++)
        fastest = fmax(fastest, fabs(rates[i]));
    return fastest > 0 ? DISTANCE / fastest : 0;
}

/* Sets the frame for conditions that lie `distance` along a direction. */
static void set_frame_at_distance(contact_frame *frame, const solved_frame *of,
                                  const online_direction *direction, double distance) {
    online_conditions at = of->at;

    if (of->by_approach)
        at.approach += distance * direction->approach;
    else
        at.load += distance * direction->load;
    at.speed += distance * direction->speed;
    at.radius += distance * direction->radius;
    at.modulus += distance * direction->modulus;
    of->set_frame(frame, of->context, &at);
}

static ehd_status check_direction(const online_direction *direction, const ehd_contact *reference,
                                  ehd_error *error) {
    const bool by_load = isnan(direction->approach);
    const double sum = (by_load ? direction->load : direction->approach) + direction->speed +
                       direction->radius + direction->modulus;

    if (!isfinite(sum) || (!by_load && !isnan(direction->load)))
        return ehd_fail(error, EHD_DATA,
                        "direction: found load %g, approach %g, speed %g, radius %g, modulus %g, "
                        "expected finite numbers, and nan for load or approach",
                        direction->load, direction->approach, direction->speed, direction->radius,
                        direction->modulus);
    return by_load ? EHD_OK : contact_check_approach(reference, error);
}

static ehd_status linearise(const solved_frame *of, ehd_error *error) {
    contact_frame at;

    if (*of->linearised) return EHD_OK;
    of->set_frame(&at, of->context, &of->at);
    const ehd_status status =
        frame_linearise(of->tangent, &of->state, &at, &of->equations, of->exit_at_node, error);
    *of->linearised = !status;
    return status;
}

/* The frames at -distance/2 and +distance/2 along a direction. */
typedef struct frame_pair {
    contact_frame side[2];
    double distance; // 0: the direction is zero
} frame_pair;

static frame_pair frames_around(const solved_frame *of, const online_direction *direction) {
    frame_pair found = {.distance = distance_of(of, direction)};

    for (int i = 0; i < 2; i++)
        set_frame_at_distance(&found.side[i], of, direction, (i - 0.5) * found.distance);
    return found;
}

/* Computes derivatives along a direction of the quantity (load or approach) that was given for the
 * solution. */
static ehd_status derivatives_along(frame_quantities *found, const solved_frame *of,
                                    const online_direction *direction, ehd_error *error) {
    const frame_pair frames = frames_around(of, direction);
    reduced_change change;

    *found = (frame_quantities){.half_width = 0};
    if (frames.distance == 0) return EHD_OK;
    return frame_tangent(found, &change, of->tangent, frames.side, frames.distance, of->reference,
                         &of->equations, error);
}

/* Returns the direction in which the given load or approach changes by 1. The other conditions stay
 * constant. */
static online_direction direction_of_given(const solved_frame *of) {
    return of->by_approach ? (online_direction){.load = NAN, .approach = 1}
                           : (online_direction){.load = 1, .approach = NAN};
}

/* Corrects `found` if the direction prescribes the quantity (load or approach) that was an outcome.
 * Adds a multiple of the derivatives by the given quantity, so that the outcome changes as the
 * direction prescribes. To exchange the closure in the solution's own frame instead would be wrong:
 * a frame that does not follow the load needs pressures that the modes lack. The stiffness would
 * then be 13 % off for the point contact of scenes/examples, and 0.4 % for the line contact. */
static void correct_outcome(frame_quantities *found, const frame_quantities *by_given,
                            const solved_frame *of, const online_direction *direction) {
    const double *add = (const double *)by_given;
    double *target = (double *)found;
    const double part = of->by_approach
                            ? (direction->load - found->scalars.load) / by_given->scalars.load
                            : (direction->approach - found->scalars.rigid_approach) /
                                  by_given->scalars.rigid_approach;

    for (size_t k = 0; k < sizeof *found / sizeof *target; k++)
        target[k] += part * add[k];
}

static ehd_status differentiate(online_derivatives *derivatives, const solved_frame *of,
                                const online_direction *direction, ehd_error *error) {
    const bool of_outcome = of->by_approach == isnan(direction->approach);
    const online_direction given = direction_of_given(of);
    online_direction own = *direction;
    frame_quantities found, by_given;
    ehd_status status = check_direction(direction, of->reference, error);

    if (of_outcome) {
        own.load = of->by_approach ? NAN : 0;
        own.approach = of->by_approach ? 0 : NAN;
    }
    if (!status) status = linearise(of, error);
    if (!status) status = derivatives_along(&found, of, &own, error);
    if (!status && of_outcome) status = derivatives_along(&by_given, of, &given, error);
    if (status) return status;
    if (of_outcome) correct_outcome(&found, &by_given, of, direction);
    *derivatives = (online_derivatives){found.scalars, found.peak_pressure, found.half_width};
    return EHD_OK;
}

/* Computes stiffness and damping. Load F and approach H0 vary by 1 + s F1 and A + s H1, so dF/dH0 =
 * 1/A - s (H1 - A F1)/A^2. Because the least squares leave a residual in the load balance, F1 is
 * not 0 and the load at s = 0 is not exactly 1. */
static ehd_status respond(online_response *response, const solved_frame *of, ehd_error *error) {
    const online_direction by_load = {.load = 1, .approach = NAN};
    const frame_pair frames = frames_around(of, &by_load);
    frame_quantities found;
    reduced_change change;
    contact_frame at;
    contact_scalars slow;
    double bound = 0;
    ehd_status status = contact_check_approach(of->reference, error);

    of->set_frame(&at, of->context, &of->at);
    if (!status) status = linearise(of, error);
    if (!status)
        status = frame_tangent(&found, &change, of->tangent, frames.side, frames.distance,
                               of->reference, &of->equations, error);
    if (!status)
        status = frame_tangent_slow(&slow, &bound, of->tangent, &change, &at, frames.side,
                                    frames.distance, of->reference, &of->equations, error);
    if (status) return status;
    const double load = found.scalars.load, compliance = found.scalars.rigid_approach / load;
    const double by_s = (slow.rigid_approach - compliance * slow.load) / load;
    const double square = compliance * compliance;
    *response = (online_response){-1 / compliance, by_s / square, bound / load / square};
    return EHD_OK;
}

/* Sets the frame of a stationary contact. */
static void set_stationary_frame(contact_frame *frame, const void *context,
                                 const online_conditions *conditions) {
    const ehd_contact *reference = context;
    const double values[NUM_VARY] = {[VARY_LOAD] = conditions->load,
                                     [VARY_SPEED] = conditions->speed,
                                     [VARY_RADIUS] = conditions->radius,
                                     [VARY_MODULUS] = conditions->modulus};

    *frame = frame_at(reference->kind, 0, values, conditions->approach);
}

/* Returns the equations of the scene under a frame's conditions. The speed is a factor of lambda,
 * so that the rows keep their weights. */
static reduced_equations stationary_equations(void *context, const contact_frame *frame,
                                              ehd_contact *contact, int side) {
    const ehd_contact *reference = context;

    (void)side;
    frame_contact(contact, frame, reference);
    contact->lambda *= contact->entrainment;
    contact->entrainment = contact->far_speed = 1;
    return (reduced_equations){contact, NULL};
}

static ehd_status find_solved(solved_frame *solved, online_solver *solver, ehd_contact *reference,
                              ehd_error *error) {
    const online_conditions own = {
        .load = 1, .approach = NAN, .speed = 1, .radius = 1, .modulus = 1};

    part_solver *used = solver->used;

    if (!used->solved)
        return ehd_fail(error, EHD_INTERNAL, "derivatives: found no solution, expected one before");
    *solved = (solved_frame){.reference = reference,
                             .state = used->state,
                             .at = own,
                             .set_frame = set_stationary_frame,
                             .context = reference,
                             .equations = {reference, stationary_equations}};
    const ehd_status status =
        used->tangent ? EHD_OK
                      : reduced_tangent_create(&used->tangent, &used->model->reduced, error);
    solved->tangent = used->tangent;
    solved->linearised = &used->linearised;
    return status;
}

ehd_status online_differentiate(online_derivatives *derivatives, online_solver *solver,
                                const ehd_contact *contact, const online_direction *direction,
                                ehd_error *error) {
    ehd_contact reference = *contact;
    solved_frame solved;
    const ehd_status status = find_solved(&solved, solver, &reference, error);

    contact_take_grid(&reference, online_solved_grid(solver));
    return status ? status : differentiate(derivatives, &solved, direction, error);
}

ehd_status online_respond(online_response *response, online_solver *solver,
                          const ehd_contact *contact, ehd_error *error) {
    ehd_contact reference = *contact;
    solved_frame solved;
    const ehd_status status = find_solved(&solved, solver, &reference, error);

    contact_take_grid(&reference, online_solved_grid(solver));
    return status ? status : respond(response, &solved, error);
}

static void set_transient_frame(contact_frame *frame, const void *context,
                                const online_conditions *conditions) {
    const online_transient *self = context;

    *frame = frame_of(self, conditions, self->solved ? self->last.step : 0);
}

/* Finds the solution of the step that is not accepted yet, or of the start. */
static ehd_status find_attempt(solved_frame *solved, online_transient *self, ehd_error *error) {
    const march_step *last = &self->last;
    const size_t part = online_transient_part(self);
    reduced_march *of = march_of_attempt(self);

    if ((!self->solved && !(self->at_start && self->conditions.speed > 0)) || is_apart(self) ||
        self->last.begins)
        return ehd_fail(error, EHD_INTERNAL,
                        "derivatives: found no solution, expected a step that is not accepted yet, "
                        "or a start that is not at rest");
    *solved = (solved_frame){.reference = &self->reference,
                             .state = reduced_march_state_before(of, steps_before(self), NULL),
                             .at = self->conditions,
                             .by_approach = self->solved && !isnan(self->conditions.approach),
                             .exit_at_node = true,
                             .set_frame = set_transient_frame,
                             .context = self,
                             .equations = reduced_march_equations(of)};
    solved->at.load = last->frame.load;
    // the frame of a start follows its load, whether load or approach was given
    if (!self->solved) solved->at.approach = NAN;
    if (part != self->of) self->tangent = reduced_tangent_free(self->tangent);
    self->of = part;
    const ehd_status status =
        self->tangent
            ? EHD_OK
            : reduced_tangent_create(&self->tangent, &self->model->parts[part].reduced, error);
    solved->tangent = self->tangent;
    solved->linearised = &self->linearised;
    return status;
}

ehd_status online_transient_differentiate(online_derivatives *derivatives, online_transient *self,
                                          const online_direction *direction, ehd_error *error) {
    solved_frame solved;
    const ehd_status status = find_attempt(&solved, self, error);

    return status ? status : differentiate(derivatives, &solved, direction, error);
}

ehd_status online_transient_respond(online_response *response, online_transient *self,
                                    ehd_error *error) {
    solved_frame solved;
    ehd_status status = find_attempt(&solved, self, error);

    if (!status && self->solved)
        status = ehd_fail(error, EHD_INTERNAL,
                          "stationary response: found a step in time, expected a stationary start");
    return status ? status : respond(response, &solved, error);
}
