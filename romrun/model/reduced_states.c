/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Holds the training states of a basis and compares contacts with them. The unknowns are defined in
 * Maier et al. (2015), eqs. 24 and 26.
 * Called by podbuild and deimselect, by romrun/calibrate, and by reduced_build.c and
 * model_read.c. */
#include "common/algebra/rounding.h"
#include "romrun/model/reduced_model.h"

#include "common/physics/traction.h"
#include "common/program/arena.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const deformation_names[] = {"independent", "coupled", NULL};

size_t reduced_num_unknowns(size_t num_pressure, size_t num_deformation) {
    return num_pressure + num_deformation + 1;
}

ehd_status reduced_check_num_rows(size_t num_rows, size_t num_pressure, size_t num_deformation,
                                  const char *object, ehd_error *error) {
    const size_t num_unknowns = reduced_num_unknowns(num_pressure, num_deformation);

    if (num_rows >= num_pressure) return EHD_OK;
    return ehd_fail(error, EHD_DATA,
                    "%s: found %zu rows, expected at least %zu: the model has %zu unknowns, of "
                    "which the %s %zu",
                    object, num_rows, num_pressure, num_unknowns,
                    num_deformation > 0 ? "elasticity equation and the load balance determine"
                                        : "load balance determines",
                    num_unknowns - num_pressure);
}

ehd_status reduced_states_init(reduced_states *states, size_t num_states, size_t num_lines,
                               size_t num_unknowns, ehd_error *error) {
    arena *memory = &states->memory;

    *states = (reduced_states){
        .num_states = num_states, .num_lines = num_lines, .num_unknowns = num_unknowns};
    states->coordinates = arena_table(memory, num_states, num_unknowns, sizeof(double));
    states->exit = arena_table(memory, num_states, num_lines, sizeof *states->exit);
    states->moes_M = arena_array(memory, num_states, sizeof(double));
    states->alpha_p_H = arena_array(memory, num_states, sizeof(double));
    states->thinning = arena_array(memory, num_states, sizeof *states->thinning);
    states->central_film_thickness = arena_array(memory, num_states, sizeof(double));
    states->stationary = arena_array(memory, num_states, sizeof *states->stationary);
    states->rate = arena_array(memory, num_states, sizeof(double));
    states->load_rate = arena_array(memory, num_states, sizeof(double));
    states->effects = arena_array(memory, num_states, sizeof *states->effects);
    states->rises = arena_array(memory, num_states, sizeof *states->rises);
    if (memory->failed) {
        reduced_states_free(states);
        return ehd_no_memory(error, "reduced model");
    }
    for (size_t s = 0; s < num_states; s++) {
        states->stationary[s] = true;
        states->effects[s] = film_effects_unknown();
        states->rises[s] = lubricant_rises_unknown();
    }
    return EHD_OK;
}

static bool is_same(double left, double right) {
    return fabs(left - right) <= ROUNDING * fmax(fabs(left), fabs(right));
}

/* Compares two lubricants. An unknown rise counts as equal to any other. */
static bool is_same_lubricant(const lubricant_rises *left, const lubricant_rises *right) {
    bool same = true;

    for (int r = 0; r < NUM_RISES; r++)
        same = same &&
               (isnan(left->of[r]) || isnan(right->of[r]) || is_same(left->of[r], right->of[r]));
    return same;
}

bool reduced_state_is_of(const reduced_states *states, size_t state, const ehd_contact *contact) {
    const lubricant_rises rises = lubricant_rises_at(&contact->lubricant, contact->hertz_pressure);
    const flow_thinning thinning = traction_thinning(contact);

    return is_same(states->moes_M[state], contact->moes_M) &&
           is_same(states->alpha_p_H[state], contact->alpha_p_H) &&
           is_same(states->thinning[state].sliding, thinning.sliding) &&
           is_same(states->thinning[state].gradient, thinning.gradient) &&
           is_same_lubricant(&states->rises[state], &rises);
}

bool reduced_states_have(const reduced_states *states, const ehd_contact *contact) {
    for (size_t s = 0; s < states->num_states; s++)
        if (reduced_state_is_of(states, s, contact)) return true;
    return false;
}

void reduced_states_free(reduced_states *states) {
    arena_free(&states->memory);
    *states = (reduced_states){0};
}

void reduced_basis_free(reduced_basis *basis) {
    free(basis->pressure);
    free(basis->deformation_modes);
    free(basis->weight);
    reduced_states_free(&basis->states);
    memset(basis, 0, sizeof *basis);
}

void reduced_states_put(reduced_states *target, size_t first, const reduced_states *source) {
    const size_t count = source->num_states, num_lines = source->num_lines;

    memcpy(target->exit + first * num_lines, source->exit, count * num_lines * sizeof(size_t));
    memcpy(target->moes_M + first, source->moes_M, count * sizeof(double));
    memcpy(target->alpha_p_H + first, source->alpha_p_H, count * sizeof(double));
    memcpy(target->thinning + first, source->thinning, count * sizeof *target->thinning);
    memcpy(target->central_film_thickness + first, source->central_film_thickness,
           count * sizeof(double));
    memcpy(target->stationary + first, source->stationary, count * sizeof *target->stationary);
    memcpy(target->rate + first, source->rate, count * sizeof(double));
    memcpy(target->load_rate + first, source->load_rate, count * sizeof(double));
    memcpy(target->effects + first, source->effects, count * sizeof *target->effects);
    memcpy(target->rises + first, source->rises, count * sizeof *target->rises);
}

ehd_status reduced_states_copy(reduced_states *target, const reduced_states *source,
                               ehd_error *error) {
    ehd_status status = reduced_states_init(target, source->num_states, source->num_lines,
                                            source->num_unknowns, error);

    if (status) return status;
    memcpy(target->coordinates, source->coordinates,
           source->num_states * source->num_unknowns * sizeof(double));
    reduced_states_put(target, 0, source);
    return EHD_OK;
}
