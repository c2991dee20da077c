/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/time/apart.h"

#include <math.h>
#include <string.h>

/* Part of the reference's load that may be left out. */
static const double NEGLIGIBLE = 0.01;

void apart_init(apart_march *self, march_solver inner, const ehd_contact *reference,
                double longest_step) {
    *self = (apart_march){.inner = inner,
                          .reference = reference,
                          .longest_step = longest_step,
                          .now = {.approach = -INFINITY}};
}

/* What a frame is under another load. */
static contact_frame frame_under(const apart_march *self, const contact_frame *frame, double load) {
    const double values[NUM_VARY] = {[VARY_LOAD] = load,
                                     [VARY_SPEED] = frame->speed,
                                     [VARY_RADIUS] = frame->radius,
                                     [VARY_MODULUS] = frame->modulus};
    contact_frame under = frame_at(self->reference->kind, frame->time, values, frame->approach);

    under.path = frame->path;
    return under;
}

/* The stationary film, in the reference frame, under a load. */
static double stationary_film(const apart_march *self, const contact_frame *frame, double load) {
    const contact_kind *kind = self->reference->kind;
    const contact_frame under = frame_under(self, frame, load);
    ehd_contact contact;

    frame_contact(&contact, &under, self->reference);
    return under.film_scale *
           kind->central_film(&contact.grid.shape, contact.moes_M, contact.moes_L);
}

/* Finds where bodies touch: the approach and the load of the lightest stationary contact that the solver has. It is solved
 * again only when the conditions change. self->load NaN: there is none. */
static ehd_status find_touching(apart_march *self, const contact_frame *frame, ehd_error *error) {
    if (self->speed == frame->speed && self->radius == frame->radius &&
        self->modulus == frame->modulus)
        return EHD_OK;
    contact_frame loaded = frame_under(self, frame, 1);
    loaded.approach = NAN;
    const ehd_status status =
        self->inner.touching(&self->approach, &self->load, self->inner.self, &loaded, error);
    self->speed = status ? 0 : frame->speed;
    self->radius = frame->radius;
    self->modulus = frame->modulus;
    return status;
}

static bool by_load(const contact_frame *frame) {
    return isnan(frame->approach);
}

/* Whether the force that bodies apart have, and that is left out, is negligible: that of a stationary contact in their
 * gap, or of the lightest contact. */
static ehd_status find_known(bool *known, apart_march *self, const contact_frame *frame,
                             ehd_error *error) {
    ehd_status status = EHD_OK;

    *known = by_load(frame) ? frame->load <= NEGLIGIBLE
                            : stationary_film(self, frame, NEGLIGIBLE) <= frame->approach;
    if (*known || by_load(frame) || frame->speed == 0) return EHD_OK;
    status = find_touching(self, frame, error);
    *known = !status && islessequal(self->load, NEGLIGIBLE);
    return status;
}

/* Makes an outcome of bodies that are apart. */
static ehd_status part(march_step *outcome, apart_march *self, const contact_frame *frame,
                       ehd_error *error) {
    const contact_frame free = frame_under(self, frame, 1);
    const double gap = by_load(frame) ? NAN : fmax(frame->approach, 0);
    const contact_scalars there = {.central_film_thickness = gap,
                                   .minimum_film_thickness = gap,
                                   .rigid_approach = frame->approach};
    bool known;
    const ehd_status status = find_known(&known, self, frame, error);

    *outcome = (march_step){.status = known ? EHD_OK : EHD_UNTRUSTED,
                            .reason = known ? ""
                                            : "bodies so near that more than 1 % of the "
                                              "reference's load may be left out",
                            .frame = free,
                            .scalars = frame_from_reference(&there, &free, self->reference),
                            .apart = true};
    self->next = (apart_moment){.apart = 1, .approach = frame->approach, .frame = free};
    return status;
}

/* Of a contact, in the reference frame. */
static double approach_of(const march_step *outcome, const contact_frame *frame,
                          const ehd_contact *reference) {
    return by_load(frame) ? frame_to_reference(&outcome->scalars, frame, reference).rigid_approach
                          : frame->approach;
}

/* Whether bodies part in an attempt: nothing presses on the film any more, or it has no solution beyond the approach at
 * which they touch, or under a load that is negligible. */
static ehd_status find_parting(bool *parts, apart_march *self, const contact_frame *frame,
                               const march_step *attempted, ehd_error *error) {
    const bool failed = attempted->status == EHD_NOT_CONVERGED;
    ehd_status status = EHD_OK;

    *parts = false;
    if (by_load(frame)) {
        *parts = failed && frame->load <= NEGLIGIBLE;
    } else if (frame->approach > self->now.approach && !failed) {
        *parts = attempted->scalars.load <= 0;
    } else if (frame->approach > self->now.approach && frame->speed != 0) {
        status = find_touching(self, frame, error);
        *parts = !status && isgreater(frame->approach, self->approach);
    }
    return status;
}

static march_step too_long(const char *reason, const contact_frame *frame) {
    return (march_step){.status = EHD_NOT_CONVERGED, .reason = reason, .frame = *frame};
}

static ehd_status attempt_contact(march_step *outcome, apart_march *self,
                                  const contact_frame *frame, double step, ehd_error *error) {
    bool parts = by_load(frame) && frame->load == 0;
    ehd_status status = EHD_OK;

    if (!parts) {
        status = self->inner.attempt(outcome, self->inner.self, frame, step, error);
        if (status) return status;
        status = find_parting(&parts, self, frame, outcome, error);
    }
    if (status) return status;
    if (!parts) {
        self->next = (apart_moment){.approach = approach_of(outcome, frame, self->reference)};
    } else if (step > self->longest_step && !by_load(frame)) {
        *outcome = too_long("bodies that part within the step", frame);
    } else {
        status = part(outcome, self, frame, error);
    }
    return status;
}

/* Beyond it no bodies touch: deflection makes an approach less than the central film, which of the lightest contact of all
 * is less than twice that of the formula. */
static double farthest_touch(const apart_march *self, const contact_frame *frame) {
    const contact_frame under = frame_under(self, frame, 1);
    ehd_contact contact;

    frame_contact(&contact, &under, self->reference);
    return 2 * stationary_film(self, frame, fmin(MIN_MOES_M / contact.moes_M, 1));
}

/* Whether bodies that are apart touch. */
static ehd_status find_touch(bool *touch, apart_march *self, const contact_frame *frame,
                             ehd_error *error) {
    const bool nears = by_load(frame) ? frame->load > 0
                                      : !isgreaterequal(frame->approach, self->now.approach) &&
                                            frame->approach < farthest_touch(self, frame);
    ehd_status status = EHD_OK;

    *touch = false;
    if (frame->speed == 0 || !nears) return EHD_OK;
    status = find_touching(self, frame, error);
    *touch = !status &&
             (by_load(frame) ? frame->load >= self->load : isless(frame->approach, self->approach));
    return status;
}

/* A contact that is found again starts from the stationary film. */
static ehd_status attempt_apart(march_step *outcome, apart_march *self, const contact_frame *frame,
                                double step, ehd_error *error) {
    bool touch;
    ehd_status status = find_touch(&touch, self, frame, error);

    if (status) return status;
    if (!touch) {
        status = part(outcome, self, frame, error);
    } else if (step > self->longest_step) {
        *outcome = too_long("bodies that touch within the step", frame);
    } else {
        const contact_frame light = by_load(frame) ? *frame : frame_under(self, frame, self->load);
        status = self->inner.start(outcome, self->inner.self, &light, error);
        outcome->begins = self->begins = true;
        self->next =
            (apart_moment){.approach = approach_of(outcome, &outcome->frame, self->reference)};
    }
    return status;
}

// ---- as a solver

static ehd_status attempt(march_step *outcome, void *solver, const contact_frame *frame,
                          double step, ehd_error *error) {
    apart_march *self = solver;

    self->begins = false;
    return self->now.apart == 1 ? attempt_apart(outcome, self, frame, step, error)
                                : attempt_contact(outcome, self, frame, step, error);
}

static void accept(void *solver) {
    apart_march *self = solver;

    if (self->next.apart == 0 && !self->begins) self->inner.accept(self->inner.self);
    self->now = self->next;
}

static void restart(void *solver) {
    apart_march *self = solver;

    if (self->now.apart == 0) self->inner.restart(self->inner.self);
}

static ehd_status start(march_step *outcome, void *solver, const contact_frame *frame,
                        ehd_error *error) {
    apart_march *self = solver;
    bool parts = by_load(frame) && frame->load == 0;
    ehd_status status = EHD_OK;

    self->begins = false;
    self->now = self->next = (apart_moment){.approach = -INFINITY};
    if (!parts) {
        status = self->inner.start(outcome, self->inner.self, frame, error);
        if (!status && outcome->status == EHD_NOT_CONVERGED)
            status = find_parting(&parts, self, frame, outcome, error);
    }
    if (status) return status;
    if (parts)
        status = part(outcome, self, frame, error);
    else
        self->next.approach = approach_of(outcome, &outcome->frame, self->reference);
    self->now = self->next;
    return status;
}

enum { NUM_OWN = sizeof(apart_moment) / sizeof(double) };
_Static_assert(sizeof(apart_moment) == NUM_OWN * sizeof(double), "these are doubles alone");

static size_t saved_size(const void *solver) {
    const apart_march *self = solver;

    return NUM_OWN + self->inner.saved_size(self->inner.self);
}

/* The inner solver has no states while bodies are apart: zeros. */
static void save(double *saved, const void *solver) {
    const apart_march *self = solver;

    memcpy(saved, &self->now, sizeof self->now);
    if (self->now.apart == 1)
        memset(saved + NUM_OWN, 0, self->inner.saved_size(self->inner.self) * sizeof *saved);
    else
        self->inner.save(saved + NUM_OWN, self->inner.self);
}

static ehd_status restore(void *solver, const double *saved, ehd_error *error) {
    apart_march *self = solver;
    apart_moment now;

    memcpy(&now, saved, sizeof now);
    if (!(now.apart == 0 || (now.apart == 1 && frame_is_valid(&now.frame))) || isinf(now.approach))
        return ehd_fail(error, EHD_DATA,
                        "saved state: found approach %g and %g, expected an approach and 0, or 1 "
                        "and a frame where bodies are apart",
                        now.approach, now.apart);
    const ehd_status status =
        now.apart == 1 ? EHD_OK : self->inner.restore(self->inner.self, saved + NUM_OWN, error);
    if (status) return status;
    self->now = self->next = now;
    self->begins = false;
    return EHD_OK;
}

static ehd_status fields(double *pressure, double *film, void *solver, ehd_error *error) {
    apart_march *self = solver;
    const ehd_grid *grid = &self->reference->grid;
    const double gap = self->now.approach / self->now.frame.film_scale;

    if (self->now.apart == 0) return self->inner.fields(pressure, film, self->inner.self, error);
    for (size_t k = 0; k < grid->num_nodes; k++) {
        pressure[k] = 0;
        film[k] = grid_gap(grid, k) + gap;
    }
    return EHD_OK;
}

static void exits(double *positions, const void *solver) {
    const apart_march *self = solver;
    const size_t count = grid_whole(&self->reference->grid).inner_lines * GRID_EXITS;

    if (self->now.apart == 0)
        self->inner.exits(positions, self->inner.self);
    else
        for (size_t i = 0; i < count; i++)
            positions[i] = NAN;
}

static contact_traction traction(void *solver, const ehd_contact *contact,
                                 const contact_scalars *scalars) {
    apart_march *self = solver;

    return self->now.apart == 0 ? self->inner.traction(self->inner.self, contact, scalars)
                                : (contact_traction){0};
}

march_solver apart_solver(apart_march *self) {
    return (march_solver){.self = self,
                          .attempt = attempt,
                          .accept = accept,
                          .restart = restart,
                          .start = start,
                          .touching = self->inner.touching,
                          .saved_size = saved_size,
                          .save = save,
                          .restore = restore,
                          .fields = fields,
                          .exits = exits,
                          .traction = self->inner.traction ? traction : NULL};
}
