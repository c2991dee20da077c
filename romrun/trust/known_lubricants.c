/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/trust/known_lubricants.h"

#include "common/algebra/hull.h"
#include "common/physics/laws.h"
#include "common/program/arena.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Differences between two lubricants at the same alpha p:
 * - OF_VISCOSITY: of ln(viscosity) / (alpha p) at the Hertz pressure;
 * - OF_VISCOSITY_HALF: of ln(viscosity) / (alpha p) at half the Hertz pressure;
 * - OF_DENSITY: of ln(density) at the Hertz pressure. */
enum { OF_VISCOSITY, OF_VISCOSITY_HALF, OF_DENSITY, NUM_DIFFERENCES };
_Static_assert((int)NUM_DIFFERENCES <= (int)HULL_AXES, "the hull has no room for the differences");

/* Smallest alpha p by which differences of ln(viscosity) are divided. At smaller alpha p any law
 * gives nearly the viscosity of zero pressure. If this limit is 100 instead of 1, a lubricant
 * between known lubricants is not recognised (test_known_lubricants.c,
 * lubricants_between_are_known). */
static const double LEAST_ALPHA_P = 1;

/* Two lubricants are taken as the same if they differ by at most default_accuracy. Measured on 30
 * oils, with alpha +-8 % and eta0 +-20 %, with a model of a point contact that was trained with one
 * oil. For differences up to 0.03 the error estimate is at least 1.2 times the error. From 0.03 to
 * 0.05 it is at least 0.64 times the error (README.md, Lubricants; test_known_lubricants.c,
 * one_lubricant_is_known_alone). */
struct known_lubricants {
    size_t count;
    shown_lubricant *of; // [count]
    bool *in_both;       // [count] true: lubricant of the training, which is known both in time and
                         // for stationary contacts
};

known_lubricants *known_lubricants_free(known_lubricants *self) {
    if (!self) return NULL;
    free(self->of);
    free(self->in_both);
    free(self);
    return NULL;
}

static void add(known_lubricants *self, const shown_lubricant *one, bool in_both) {
    bool known = isfinite(one->alpha_p_H);

    for (int r = 0; r < NUM_RISES; r++)
        known = known && isfinite(one->rises.of[r]);
    if (!known) return;
    self->of[self->count] = *one;
    self->in_both[self->count++] = in_both;
}

known_lubricants *known_lubricants_create(const reduced_model *model) {
    const reduced_states *states = &model->states;
    const shown_lubricants *shown = &model->shown;
    const size_t room = states->num_states + shown->count + 1;
    known_lubricants *self = calloc(1, sizeof *self);

    if (!self) return NULL;
    self->of = array_new(room, 1, sizeof *self->of);
    self->in_both = array_new(room, 1, sizeof *self->in_both);
    if (!self->of || !self->in_both) return known_lubricants_free(self);
    for (size_t s = 0; s < states->num_states; s++)
        add(self, &(shown_lubricant){states->alpha_p_H[s], states->rises[s], 0}, true);
    for (size_t i = 0; i < shown->count; i++)
        add(self, &shown->of[i], false);
    return self;
}

struct lubricant_memory {
    hull_space *hull;
    double *differences; // [NUM_DIFFERENCES, count]
    char reason[128];
    // the last check: if the next lubricant is the same, as in a march, `answer` is reused
    bool has_last, in_time;
    ehd_lubricant last;
    const char *answer;
};

lubricant_memory *lubricant_memory_free(lubricant_memory *self) {
    if (!self) return NULL;
    hull_space_free(self->hull);
    free(self->differences);
    free(self);
    return NULL;
}

lubricant_memory *lubricant_memory_create(const known_lubricants *of) {
    lubricant_memory *self = calloc(1, sizeof *self);

    if (!self) return NULL;
    self->hull = hull_space_create(of->count + 1);
    self->differences = array_new(NUM_DIFFERENCES, of->count + 1, sizeof *self->differences);
    return self->hull && self->differences ? self : lubricant_memory_free(self);
}

const char *lubricant_memory_reason(const lubricant_memory *self) {
    return self->reason;
}

/* Finds the differences between a known lubricant and `lubricant`, at the pressure where alpha p of
 * `lubricant` equals alpha p_H of the known lubricant. Returns false if `lubricant` has no
 * viscosity at this pressure. */
static bool compare(double differences[NUM_DIFFERENCES], const shown_lubricant *known,
                    const ehd_lubricant *lubricant) {
    const lubricant_rises here = lubricant_rises_at(lubricant, known->alpha_p_H / lubricant->alpha);
    const double alpha_p = fmax(known->alpha_p_H, LEAST_ALPHA_P);

    differences[OF_VISCOSITY] =
        (known->rises.of[RISE_VISCOSITY] - here.of[RISE_VISCOSITY]) / alpha_p;
    differences[OF_VISCOSITY_HALF] =
        (known->rises.of[RISE_VISCOSITY_HALF] - here.of[RISE_VISCOSITY_HALF]) / (alpha_p / 2);
    differences[OF_DENSITY] = known->rises.of[RISE_DENSITY] - here.of[RISE_DENSITY];
    return !isnan(here.of[RISE_VISCOSITY]);
}

static double length_of(const double differences[NUM_DIFFERENCES]) {
    double square = 0;

    for (int d = 0; d < NUM_DIFFERENCES; d++)
        square += differences[d] * differences[d];
    return sqrt(square);
}

/* Lists the differences from each known lubricant, as columns. Unused columns repeat the first
 * column. Returns how many known lubricants were compared, or `like` if `lubricant` is taken as the
 * same as one of them. */
static size_t list(double *columns, const known_lubricants *self, const ehd_lubricant *lubricant,
                   bool in_time, size_t like) {
    const size_t stride = self->count;
    size_t count = 0;

    for (size_t i = 0; i < stride; i++) {
        double here[NUM_DIFFERENCES];
        if (!self->in_both[i] && self->of[i].in_time != in_time) continue;
        if (!compare(here, &self->of[i], lubricant)) continue;
        if (length_of(here) <= default_accuracy) return like;
        for (int d = 0; d < NUM_DIFFERENCES; d++)
            columns[(size_t)d * stride + count] = here[d];
        count++;
    }
    for (size_t i = count; i < stride && count > 0; i++)
        for (int d = 0; d < NUM_DIFFERENCES; d++)
            columns[(size_t)d * stride + i] = columns[(size_t)d * stride];
    return count;
}

/* Checks whether zero lies in the convex hull of the differences. The check uses the `num` kinds of
 * differences from `first` on. */
static bool is_between(const known_lubricants *self, lubricant_memory *memory, int first, int num) {
    const double none[NUM_DIFFERENCES] = {0};

    return hull_distance_in(memory->hull, memory->differences + (size_t)first * self->count,
                            self->count, (size_t)num, none) <= default_accuracy;
}

static const char *explain(lubricant_memory *memory, const known_lubricants *self,
                           const ehd_lubricant *lubricant, size_t count) {
    const char *viscosity = lubricant->viscosity->name;
    const char *density =
        lubricant->density ? lubricant->density->name : density_incompressible.name;
    const bool same_viscosity = count > 0 && is_between(self, memory, OF_VISCOSITY, 2);
    const bool same_density = count > 0 && is_between(self, memory, OF_DENSITY, 1);

    if (self->count == 0)
        return "a model without the lubricants of its training (romrun calibrate adds them)";
    if (same_viscosity && same_density)
        snprintf(memory->reason, sizeof memory->reason,
                 "viscosity law %s with density law %s: not in training", viscosity, density);
    else if (same_viscosity)
        snprintf(memory->reason, sizeof memory->reason, "density law %s: not in training", density);
    else
        snprintf(memory->reason, sizeof memory->reason,
                 "viscosity law %s with these parameters%s%s: not in training", viscosity,
                 same_density ? "" : ", density law ", same_density ? "" : density);
    return memory->reason;
}

static const char *check(const known_lubricants *self, lubricant_memory *memory,
                         const ehd_lubricant *lubricant, bool in_time) {
    const size_t like = self->count + 1;
    const size_t count = list(memory->differences, self, lubricant, in_time, like);

    if (count == like) return NULL;
    if (count > 0 && is_between(self, memory, 0, NUM_DIFFERENCES)) return NULL;
    return explain(memory, self, lubricant, count);
}

const char *known_lubricants_check(const known_lubricants *self, lubricant_memory *memory,
                                   const ehd_lubricant *lubricant, bool in_time) {
    const bool same = memory->has_last && memory->in_time == in_time &&
                      memcmp(&memory->last, lubricant, sizeof *lubricant) == 0;

    if (!same) memory->answer = check(self, memory, lubricant, in_time);
    memory->has_last = true;
    memory->in_time = in_time;
    memory->last = *lubricant;
    return memory->answer;
}
