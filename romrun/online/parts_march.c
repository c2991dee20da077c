/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/online/parts_march.h"

#include "romrun/online/film_errors.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct parts_march {
    size_t num_parts;
    reduced_march **parts; // [num_parts]
    bool *holds;           // [num_parts] whether a part has the accepted states
    size_t accepted;       // part that solved the last accepted state
    size_t attempted;      // part of the last attempt
    size_t num_handed;
    // handed state, [num_nodes]; NULL if there is one part
    double *pressure, *film;
    double *taken_pressure, *taken_film; // the handed state in the part that took it
};

parts_march *parts_march_free(parts_march *self) {
    if (!self) return NULL;
    for (size_t p = 0; p < self->num_parts; p++)
        reduced_march_free(self->parts[p]);
    free(self->parts);
    free(self->holds);
    free(self->pressure);
    free(self->film);
    free(self->taken_pressure);
    free(self->taken_film);
    free(self);
    return NULL;
}

static bool allocate(parts_march *self) {
    const size_t num_nodes = reduced_march_reference(self->parts[0])->grid.num_nodes;

    if (self->num_parts == 1) return true;
    self->pressure = malloc(num_nodes * sizeof(double));
    self->film = malloc(num_nodes * sizeof(double));
    self->taken_pressure = malloc(num_nodes * sizeof(double));
    self->taken_film = malloc(num_nodes * sizeof(double));
    return self->pressure && self->film && self->taken_pressure && self->taken_film;
}

ehd_status parts_march_create(parts_march **created, reduced_march *const *parts, size_t num_parts,
                              ehd_error *error) {
    parts_march *self = calloc(1, sizeof *self);

    *created = NULL;
    if (self) {
        self->parts = malloc(num_parts * sizeof(reduced_march *));
        self->holds = calloc(num_parts, sizeof *self->holds);
    }
    if (!self || !self->parts || !self->holds) {
        for (size_t p = 0; p < num_parts; p++)
            reduced_march_free(parts[p]);
        parts_march_free(self);
        return ehd_no_memory(error, "online solver");
    }
    memcpy(self->parts, parts, num_parts * sizeof(reduced_march *));
    self->num_parts = num_parts;
    if (!allocate(self)) {
        parts_march_free(self);
        return ehd_no_memory(error, "online solver");
    }
    *created = self;
    return EHD_OK;
}

size_t parts_march_attempted(const parts_march *self) {
    return self->attempted;
}

size_t parts_march_accepted(const parts_march *self) {
    return self->accepted;
}

reduced_march *parts_march_part(const parts_march *self, size_t part) {
    return self->parts[part];
}

size_t parts_march_num_handed(const parts_march *self) {
    return self->num_handed;
}

reduced_march_effort parts_march_effort_of(const parts_march *self) {
    reduced_march_effort sum = {0};

    for (size_t p = 0; p < self->num_parts; p++) {
        const reduced_march_effort of = reduced_march_effort_of(self->parts[p]);
        sum.seconds_rows += of.seconds_rows;
        sum.seconds_linear += of.seconds_linear;
        sum.seconds_exit += of.seconds_exit;
        sum.seconds_previous += of.seconds_previous;
        sum.iterations += of.iterations;
    }
    return sum;
}

// ---- from one part to another

/* Returns the part in whose trained range a frame lies deepest. */
static size_t deepest(const parts_march *self, const contact_frame *frame) {
    size_t found = 0;

    for (size_t p = 1; p < self->num_parts; p++)
        if (reduced_march_outside(self->parts[p], frame) <
            reduced_march_outside(self->parts[found], frame))
            found = p;
    return found;
}

/* Returns a state on the grid, with its fields in self->pressure and self->film. */
static handed_state hand(parts_march *self, const reduced_march *from, const reduced_state *state,
                         const contact_frame *frame) {
    handed_state handed = {.pressure = self->pressure,
                           .film = self->film,
                           .exits = reduced_state_exits(state),
                           .frame = *frame};

    reduced_march_fields_of(self->pressure, self->film, &handed.rigid_approach, from, state);
    return handed;
}

/* Finds the change of the last accepted film when another part takes it over. The modes of that
 * part represent the film less exactly. */
static void find_change(double change[NUM_ERROR_PLACES], parts_march *self,
                        const reduced_march *from, const reduced_march *to) {
    const reduced_state taken = reduced_march_state_before(to, 1, NULL);
    const reduced_state given = reduced_march_state_before(from, 1, NULL);
    double rigid_approach;

    reduced_march_fields_of(self->pressure, self->film, &rigid_approach, from, &given);
    reduced_march_fields_of(self->taken_pressure, self->taken_film, &rigid_approach, to, &taken);
    film_errors_between(change, self->taken_film, self->film, &reduced_march_reference(to)->grid,
                        given.exit);
}

/* Hands the accepted states of the part that solved the last one to another part, with their errors
 * and, along the path, the base. */
static ehd_status take_states_over(parts_march *self, size_t part, ehd_error *error) {
    const reduced_march *from = self->parts[self->accepted];
    reduced_march *to = self->parts[part];
    const size_t num_states = reduced_march_num_states(from);
    const contact_frame load_frame = reduced_march_load_frame(from);
    double change[NUM_ERROR_PLACES];
    contact_frame frame;

    if (reduced_march_reference(to)->transport == TRANSPORT_PATH) {
        const reduced_state base = reduced_march_base(from, &frame);
        const handed_state handed = hand(self, from, &base, &frame);
        const ehd_status status = reduced_march_take_base(to, &handed, error);
        if (status) return status;
        reduced_march_take_errors(to, reduced_march_errors(from));
    }
    for (size_t i = 1; i <= num_states; i++) {
        const reduced_state state = reduced_march_state_before(from, i, &frame);
        const handed_state handed = hand(self, from, &state, &frame);
        const ehd_status status = reduced_march_take(to, i, &handed, &load_frame, error);
        if (status) return status;
    }
    find_change(change, self, from, to);
    reduced_march_take_indicated(to, from, change);
    self->holds[part] = true;
    self->num_handed++;
    return EHD_OK;
}

static bool covers(const parts_march *self, size_t part, const contact_frame *frame) {
    return !reduced_march_check_range(self->parts[part], frame, frame);
}

/* Returns `part` if the frame lies in its range or in no range, else the part in whose range it
 * lies deepest. */
static size_t part_for(const parts_march *self, size_t part, const contact_frame *frame) {
    if (self->num_parts == 1 || covers(self, part, frame)) return part;
    const size_t other = deepest(self, frame);
    return covers(self, other, frame) ? other : part;
}

/* Returns the part for a solved step. If the approach is given, the load of the frame was a guess,
 * so the range is checked again under the load found. */
static size_t part_of_outcome(const parts_march *self, const march_step *outcome,
                              const contact_frame *frame) {
    const contact_kind *kind = reduced_march_reference(self->parts[0])->kind;

    if (isnan(frame->approach) || outcome->status != EHD_UNTRUSTED) return self->attempted;
    const contact_frame loaded = frame_of_load(kind, frame, outcome->scalars.load);
    return part_for(self, self->attempted, &loaded);
}

/* Makes a part the only one with accepted states. */
static void hold_alone(parts_march *self, size_t part) {
    self->accepted = self->attempted = part;
    memset(self->holds, 0, self->num_parts * sizeof *self->holds);
    self->holds[part] = true;
}

reduced_march *parts_march_choose(parts_march *self, const contact_frame *frame) {
    hold_alone(self, deepest(self, frame));
    return self->parts[self->accepted];
}

// ---- as a solver

/* Returns the solver of the part of the last accepted state. */
static march_solver last_solver(const parts_march *self) {
    return reduced_march_solver(self->parts[self->accepted]);
}

static ehd_status start_with(march_step *outcome, parts_march *self, size_t part,
                             const contact_frame *frame, ehd_error *error) {
    hold_alone(self, part);
    const march_solver of = last_solver(self);
    return of.start(outcome, of.self, frame, error);
}

static ehd_status start(march_step *outcome, void *solver, const contact_frame *frame,
                        ehd_error *error) {
    parts_march *self = solver;
    const ehd_status status = start_with(outcome, self, deepest(self, frame), frame, error);
    if (status) return status;

    const size_t part = part_of_outcome(self, outcome, &outcome->frame);
    return part == self->attempted ? EHD_OK : start_with(outcome, self, part, frame, error);
}

static ehd_status attempt_with(march_step *outcome, parts_march *self, size_t part,
                               const contact_frame *frame, double step, ehd_error *error) {
    self->attempted = part;
    const ehd_status status = self->holds[part] ? EHD_OK : take_states_over(self, part, error);
    const march_solver of = reduced_march_solver(self->parts[part]);

    return status ? status : of.attempt(outcome, of.self, frame, step, error);
}

static ehd_status attempt(march_step *outcome, void *solver, const contact_frame *frame,
                          double step, ehd_error *error) {
    parts_march *self = solver;
    const size_t first = part_for(self, self->accepted, frame);
    const ehd_status status = attempt_with(outcome, self, first, frame, step, error);
    if (status) return status;

    const size_t part = part_of_outcome(self, outcome, frame);
    return part == first ? EHD_OK : attempt_with(outcome, self, part, frame, step, error);
}

static void accept(void *solver) {
    parts_march *self = solver;

    hold_alone(self, self->attempted);
    const march_solver of = last_solver(self);
    of.accept(of.self);
}

static void restart(void *solver) {
    parts_march *self = solver;

    hold_alone(self, self->accepted);
    const march_solver of = last_solver(self);
    of.restart(of.self);
}

/* Solves with the part whose training has the smallest M. */
static ehd_status touching(double *approach, double *load, void *solver, const contact_frame *frame,
                           ehd_error *error) {
    const parts_march *self = solver;
    size_t lightest = 0;

    for (size_t p = 1; p < self->num_parts; p++)
        if (reduced_march_least_M(self->parts[p]) < reduced_march_least_M(self->parts[lightest]))
            lightest = p;
    const march_solver of = reduced_march_solver(self->parts[lightest]);
    return of.touching(approach, load, of.self, frame, error);
}

/* Returns the size of a saved state. For several parts it has the index of the part, its own saved
 * state, and zeros up to the longest one. */
static size_t saved_size(const void *solver) {
    const parts_march *self = solver;
    size_t longest = 0;

    for (size_t p = 0; p < self->num_parts; p++) {
        const march_solver of = reduced_march_solver(self->parts[p]);
        const size_t size = of.saved_size(of.self);
        if (size > longest) longest = size;
    }
    return longest + (self->num_parts > 1 ? 1 : 0);
}

static void save(double *saved, const void *solver) {
    const parts_march *self = solver;
    const march_solver of = last_solver(self);

    if (self->num_parts > 1) {
        memset(saved, 0, saved_size(self) * sizeof *saved);
        *saved++ = (double)self->accepted;
    }
    of.save(saved, of.self);
}

static ehd_status restore(void *solver, const double *saved, ehd_error *error) {
    parts_march *self = solver;
    size_t part = 0;

    if (self->num_parts > 1) {
        if (!(isgreaterequal(*saved, 0) && *saved < (double)self->num_parts &&
              *saved == floor(*saved)))
            return ehd_fail(error, EHD_DATA,
                            "saved state: found part %g, expected a whole number below %zu", *saved,
                            self->num_parts);
        part = (size_t)*saved++;
    }
    hold_alone(self, part);
    const march_solver of = last_solver(self);
    return of.restore(of.self, saved, error);
}

static ehd_status fields(double *pressure, double *film, void *solver, ehd_error *error) {
    const march_solver of = last_solver(solver);

    return of.fields(pressure, film, of.self, error);
}

static void exits(double *positions, const void *solver) {
    const march_solver of = last_solver(solver);

    of.exits(positions, of.self);
}

static contact_traction traction(void *solver, const ehd_contact *contact,
                                 const contact_scalars *scalars) {
    const march_solver of = last_solver(solver);

    return of.traction(of.self, contact, scalars);
}

march_solver parts_march_solver(parts_march *self) {
    bool has_traction = true;

    for (size_t p = 0; p < self->num_parts; p++)
        has_traction = has_traction && reduced_march_solver(self->parts[p]).traction;
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
                          .traction = has_traction ? traction : NULL,
                          .exits = exits};
}
