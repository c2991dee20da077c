/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/time/apart.h"

#include "common/algebra/rounding.h"

#include <math.h>
#include <string.h>

static const apart_moment together = {.approach = -INFINITY, .doubtful = -INFINITY};

void apart_init(apart_march *self, march_solver inner, const ehd_contact *reference,
                double longest_step) {
    *self = (apart_march){.inner = inner,
                          .reference = reference,
                          .longest_step = longest_step,
                          .now = together,
                          .speed = NAN};
}

/* Returns the frame scaled by another load. Without entrainment no stationary film separates the
 * bodies. If the entrainment is zero, the returned frame has the entrainment of the reference. */
static contact_frame moving_under(const apart_march *self, const contact_frame *frame,
                                  double load) {
    contact_frame under = frame_with_load(self->reference->kind, frame, load);

    if (under.speed == 0) under.speed = 1;
    return under;
}

/* Returns the stationary central film under a load by the film formula, in the reference frame. */
static double stationary_film(const apart_march *self, const contact_frame *frame, double load) {
    const contact_kind *kind = self->reference->kind;
    const contact_frame under = moving_under(self, frame, load);
    ehd_contact contact;

    frame_contact(&contact, &under, self->reference);
    return under.film_scale *
           kind->central_film(&contact.grid.shape, contact.moes_M, contact.moes_L);
}

/* Finds the approach and load at which bodies touch, and stores both in `self`. Solves again only
 * if speed, radius or modulus have changed. */
static ehd_status find_touching(apart_march *self, const contact_frame *frame, ehd_error *error) {
    if (self->speed == frame->speed && self->radius == frame->radius &&
        self->modulus == frame->modulus)
        return EHD_OK;
    contact_frame loaded = moving_under(self, frame, 1);
    loaded.approach = NAN;
    const ehd_status status =
        self->inner.touching(&self->approach, &self->load, self->inner.self, &loaded, error);
    self->speed = status ? NAN : frame->speed;
    self->radius = frame->radius;
    self->modulus = frame->modulus;
    return status;
}

static bool by_load(const contact_frame *frame) {
    return isnan(frame->approach);
}

/* Decides whether the force between separated bodies, which is neglected, is small enough. This
 * force is at most the force of a stationary contact with the same gap. If the approach exceeds the
 * touching approach, this force is also at most the touching load. */
static ehd_status find_known(bool *known, apart_march *self, const contact_frame *frame,
                             ehd_error *error) {
    ehd_status status = EHD_OK;

    *known = by_load(frame) ? frame->load <= default_accuracy
                            : stationary_film(self, frame, default_accuracy) <= frame->approach;
    if (*known || by_load(frame)) return EHD_OK;
    status = find_touching(self, frame, error);
    *known = !status && islessequal(self->load, default_accuracy) &&
             isgreaterequal(frame->approach, self->approach);
    return status;
}

/* Sets the outcome of bodies that are apart. */
static ehd_status part(march_step *outcome, apart_march *self, const contact_frame *frame,
                       ehd_error *error) {
    const contact_frame free = frame_with_load(self->reference->kind, frame, 1);
    const double gap = by_load(frame) ? NAN : fmax(frame->approach, 0);
    const contact_scalars there = {.central_film_thickness = gap,
                                   .minimum_film_thickness = gap,
                                   .rigid_approach = frame->approach};
    bool known;
    const ehd_status status = find_known(&known, self, frame, error);

    *outcome = (march_step){.status = known ? EHD_OK : EHD_UNTRUSTED,
                            .reason = known ? ""
                                            : "bodies apart, but so near that the neglected force "
                                              "may exceed 1 % of the reference load",
                            .frame = free,
                            .scalars = frame_from_reference(&there, &free, self->reference),
                            .apart = true};
    self->next.apart = 1;
    self->next.approach = frame->approach;
    self->next.doubtful = -INFINITY;
    self->next.frame = free;
    return status;
}

/* Stores the state of bodies in contact. Marks the outcome as EHD_UNTRUSTED as long as the contact
 * contains film that formed when the bodies touched at rest. */
static void touch(march_step *outcome, apart_march *self, const contact_frame *frame,
                  double doubtful) {
    self->next = (apart_moment){
        .inner = 1,
        .approach = by_load(frame)
                        ? frame_to_reference(&outcome->scalars, &outcome->frame, self->reference)
                              .rigid_approach
                        : frame->approach,
        .doubtful = doubtful};
    if (outcome->status == EHD_OK && frame->path < doubtful)
        march_distrust(outcome, "bodies that touched at rest, whose film is taken from the speed "
                                "of the reference");
}

/* Decides whether the bodies part in this attempt. With a given approach they part if the load is
 * not positive, or if the attempt fails while they recede beyond the touching approach. With a
 * given load they part if the attempt fails under a load that is negligible and less than the
 * touching load. */
static ehd_status find_parting(bool *parts, apart_march *self, const contact_frame *frame,
                               const march_step *attempted, ehd_error *error) {
    const bool failed = attempted->status == EHD_NOT_CONVERGED;
    const bool may = by_load(frame) ? frame->load <= default_accuracy
                                    : isgreater(frame->approach, self->now.approach);
    ehd_status status = EHD_OK;

    *parts = !failed && !by_load(frame) && attempted->scalars.load <= 0;
    if (!failed || !may) return EHD_OK;
    status = find_touching(self, frame, error);
    *parts = !status && (by_load(frame) ? isless(frame->load, self->load)
                                        : isgreater(frame->approach, self->approach));
    return status;
}

static march_step too_long(const char *reason, const contact_frame *frame) {
    return (march_step){.status = EHD_NOT_CONVERGED, .reason = reason, .frame = *frame};
}

static bool is_too_long(const apart_march *self, double step) {
    return step > self->longest_step * (1 + ROUNDING);
}

static ehd_status attempt_contact(march_step *outcome, apart_march *self,
                                  const contact_frame *frame, double step, ehd_error *error) {
    bool parts = frame->load == 0;
    ehd_status status = EHD_OK;

    if (!parts) {
        status = self->inner.attempt(outcome, self->inner.self, frame, step, error);
        if (!status) status = find_parting(&parts, self, frame, outcome, error);
    }
    if (status) return status;
    if (!parts)
        touch(outcome, self, frame, self->now.doubtful);
    else if (is_too_long(self, step))
        *outcome = too_long("the bodies part in this step, which has to be shorter", frame);
    else
        status = part(outcome, self, frame, error);
    return status;
}

/* Returns an approach beyond which bodies cannot touch. The approach of a contact is less than its
 * central film. The central film of the lightest contact is less than twice the film by the film
 * formula. */
static double farthest_touch(const apart_march *self, const contact_frame *frame) {
    const contact_frame under = moving_under(self, frame, 1);
    ehd_contact contact;

    frame_contact(&contact, &under, self->reference);
    return 2 * stationary_film(self, frame, fmin(MIN_MOES_M / contact.moes_M, 1));
}

/* Decides whether bodies that were apart touch now. Bodies that recede do not touch, unless their
 * undeformed shapes overlap: then only pressure can keep their surfaces separate. */
static ehd_status find_touch(bool *touches, apart_march *self, const contact_frame *frame,
                             ehd_error *error) {
    const bool may =
        by_load(frame) ? frame->load > 0
                       : (!isgreater(frame->approach, self->now.approach) || frame->approach < 0) &&
                             frame->approach < farthest_touch(self, frame);
    ehd_status status = EHD_OK;

    *touches = false;
    if (!may) return EHD_OK;
    status = find_touching(self, frame, error);
    *touches = !status && (by_load(frame) ? isgreaterequal(frame->load, self->load)
                                          : isless(frame->approach, self->approach));
    return status;
}

/* Attempts a step of bodies that are apart. If they touch again, the contact starts from the
 * stationary film. If the entrainment is zero, it starts from the stationary film at the
 * reference's entrainment. */
static ehd_status attempt_apart(march_step *outcome, apart_march *self, const contact_frame *frame,
                                double step, ehd_error *error) {
    bool touches;
    ehd_status status = find_touch(&touches, self, frame, error);

    if (status) return status;
    if (!touches) return part(outcome, self, frame, error);
    if (is_too_long(self, step)) {
        *outcome = too_long("the bodies touch in this step, which has to be shorter", frame);
        return EHD_OK;
    }
    const contact_frame light =
        moving_under(self, frame, by_load(frame) ? frame->load : self->load);
    status = self->inner.start(outcome, self->inner.self, &light, error);
    if (status || outcome->status == EHD_NOT_CONVERGED) self->now.inner = 0;
    if (status) return status;
    outcome->frame.speed = frame->speed;
    outcome->begins = self->begins = true;
    const double length = outcome->frame.half_width * (1 + outcome->scalars.exit_position);
    touch(outcome, self, frame, frame->speed == 0 ? frame->path + length : -INFINITY);
    return EHD_OK;
}

// ---- as a solver

static ehd_status attempt(march_step *outcome, void *solver, const contact_frame *frame,
                          double step, ehd_error *error) {
    apart_march *self = solver;

    self->begins = false;
    self->next = self->now;
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
    bool parts = frame->load == 0 || (!by_load(frame) && frame->speed != 0 &&
                                      frame->approach >= farthest_touch(self, frame));
    ehd_status status = EHD_OK;

    self->begins = false;
    self->now = self->next = together;
    if (!parts) {
        status = self->inner.start(outcome, self->inner.self, frame, error);
        if (!status && outcome->status == EHD_NOT_CONVERGED)
            status = find_parting(&parts, self, frame, outcome, error);
    }
    if (status) return status;
    if (parts)
        status = part(outcome, self, frame, error);
    else
        touch(outcome, self, &outcome->frame, -INFINITY);
    self->now = self->next;
    return status;
}

enum { NUM_OWN = sizeof(apart_moment) / sizeof(double) };
_Static_assert(sizeof(apart_moment) == NUM_OWN * sizeof(double), "these are doubles alone");

static size_t saved_size(const void *solver) {
    const apart_march *self = solver;

    return NUM_OWN + self->inner.saved_size(self->inner.self);
}

static void save(double *saved, const void *solver) {
    const apart_march *self = solver;

    memcpy(saved, &self->now, sizeof self->now);
    if (self->now.inner == 1)
        self->inner.save(saved + NUM_OWN, self->inner.self);
    else
        memset(saved + NUM_OWN, 0, self->inner.saved_size(self->inner.self) * sizeof *saved);
}

static bool is_valid(const apart_moment *moment) {
    if (!(moment->inner == 0 || moment->inner == 1) || isnan(moment->doubtful)) return false;
    if (moment->apart == 1) return frame_is_valid(&moment->frame) && !isinf(moment->approach);
    return moment->apart == 0 && moment->inner == 1 && isfinite(moment->approach);
}

static ehd_status restore(void *solver, const double *saved, ehd_error *error) {
    apart_march *self = solver;
    apart_moment now;

    memcpy(&now, saved, sizeof now);
    if (!is_valid(&now))
        return ehd_fail(error, EHD_DATA,
                        "saved state: found approach %g and apart = %g, expected an approach, and "
                        "apart = 0, or 1 with a valid frame",
                        now.approach, now.apart);
    const ehd_status status =
        now.inner == 1 ? self->inner.restore(self->inner.self, saved + NUM_OWN, error) : EHD_OK;
    if (status) return status;
    self->now = self->next = now;
    self->begins = false;
    return EHD_OK;
}

static ehd_status fields(double *pressure, double *film, void *solver, ehd_error *error) {
    apart_march *self = solver;
    const ehd_grid *grid = &self->reference->grid;

    if (self->now.apart == 0) return self->inner.fields(pressure, film, self->inner.self, error);
    const double gap = self->now.approach / self->now.frame.film_scale;
    for (size_t k = 0; k < grid->num_nodes; k++) {
        pressure[k] = 0;
        film[k] = isnan(gap) ? NAN : fmax(grid_gap(grid, k) + gap, 0);
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

    return self->inner.traction(self->inner.self, contact, scalars);
}

march_solver apart_solver(apart_march *self) {
    return (march_solver){.self = self,
                          .attempt = attempt,
                          .accept = accept,
                          .restart = restart,
                          .start = start,
                          .saved_size = saved_size,
                          .save = save,
                          .restore = restore,
                          .fields = fields,
                          .exits = exits,
                          .traction = self->inner.traction ? traction : NULL};
}
