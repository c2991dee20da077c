/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/online/parts_march.h"

#include "common/settings/part_list.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct parts_march {
    size_t num_parts;
    reduced_march *parts[MAX_PARTS];
    bool holds[MAX_PARTS]; // true: the part has the accepted states
    size_t accepted;       // part that solved the last accepted state
    size_t attempted;      // part that solved the last attempt
    size_t num_handed;
    hand_over work; // work memory to hand states over; empty if there is one part
};

parts_march *parts_march_free(parts_march *self) {
    if (!self) return NULL;
    for (size_t p = 0; p < self->num_parts; p++)
        reduced_march_free(self->parts[p]);
    hand_over_free(&self->work);
    free(self);
    return NULL;
}

ehd_status parts_march_create(parts_march **created, reduced_march *const *parts, size_t num_parts,
                              ehd_error *error) {
    parts_march *self = calloc(1, sizeof *self);

    *created = NULL;
    if (!self) {
        for (size_t p = 0; p < num_parts; p++)
            reduced_march_free(parts[p]);
        return ehd_no_memory(error, "online solver");
    }
    memcpy(self->parts, parts, num_parts * sizeof(reduced_march *));
    self->num_parts = num_parts;
    const ehd_grid *grid = &reduced_march_steps(parts[0])->reference->grid;
    const ehd_status status = num_parts > 1 ? hand_over_init(&self->work, grid, error) : EHD_OK;
    if (status)
        parts_march_free(self);
    else
        *created = self;
    return status;
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

/* Hands the accepted states to another part, from the part that solved the last state. */
static ehd_status take_states_over(parts_march *self, size_t part, ehd_error *error) {
    reduced_march *from = self->parts[self->accepted], *to = self->parts[part];
    const ehd_status status = bdf_march_take_over(
        reduced_march_steps(to), reduced_march_steps(from), false, &self->work, error);

    if (status) return status;
    reduced_march_take_indicated(to, from, self->work.change);
    self->holds[part] = true;
    self->num_handed++;
    return EHD_OK;
}

static bool covers(const parts_march *self, size_t part, const contact_frame *frame) {
    return !reduced_march_check_range(self->parts[part], frame, frame);
}

/* Returns `part` if the frame lies in the range of this part, or in no range. Otherwise returns
 * the part in whose range the frame lies deepest. */
static size_t part_for(const parts_march *self, size_t part, const contact_frame *frame) {
    if (self->num_parts == 1 || covers(self, part, frame)) return part;
    const size_t other = deepest(self, frame);
    return covers(self, other, frame) ? other : part;
}

/* Returns the part for a solved step. If the approach is given, the load of the frame was a guess.
 * The range is therefore checked again with the computed load. */
static size_t part_of_outcome(const parts_march *self, const march_step *outcome,
                              const contact_frame *frame) {
    const contact_kind *kind = reduced_march_steps(self->parts[0])->reference->kind;

    if (isnan(frame->approach) || outcome->status != EHD_UNTRUSTED) return self->attempted;
    const contact_frame loaded = frame_of_load(kind, frame, outcome->scalars.load);
    return part_for(self, self->attempted, &loaded);
}

/* Marks a part as the only one with accepted states. */
static void hold_alone(parts_march *self, size_t part) {
    self->accepted = self->attempted = part;
    memset(self->holds, 0, sizeof self->holds);
    self->holds[part] = true;
}

reduced_march *parts_march_choose(parts_march *self, const contact_frame *frame) {
    hold_alone(self, deepest(self, frame));
    return self->parts[self->accepted];
}

// ---- functions of march_solver

/* Returns the solver of the part that solved the last accepted state. */
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

/* Finds the approach and the load at which the bodies touch (march_solver), with the part whose
 * training has the smallest M. */
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

/* Returns the size of a saved state. With several parts, a saved state has the index of a part, the
 * saved state of this part, and zeros up to the length of the longest saved state. */
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

static solve_seconds seconds(const void *solver) {
    const parts_march *self = solver;
    solve_seconds sum = {0};

    for (size_t p = 0; p < self->num_parts; p++) {
        const march_solver of = reduced_march_solver(self->parts[p]);
        const solve_seconds part = of.seconds(of.self);
        solve_seconds_add(&sum, &part);
    }
    return sum;
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
                          .exits = exits,
                          .seconds = seconds};
}
