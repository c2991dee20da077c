/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "snapgen/adaptive_file.h"

#include "common/output/grid_file.h"
#include "snapgen/snapshots.h"

#include <math.h>
#include <stdlib.h>

ehd_status adaptive_file_create(artefact **file, const program *caller, const training_set *set,
                                const char *plan_path, ehd_error *error) {
    const char **inputs = training_inputs(set, plan_path, NULL);
    ehd_status status = inputs ? artefact_create_growing(file, caller->output, &schema_snapshots,
                                                         "state", caller, set->text, inputs, error)
                               : ehd_fail(error, EHD_MEMORY, "%s: found no memory", plan_path);

    if (!status) status = grid_write(*file, set->kind, &set->grid, error);
    if (!status) status = snapshots_declare(*file, set, true, error);
    if (!status) status = artefact_begin_streaming(*file, error);
    if (status) artefact_close(file);
    free(inputs);
    return status;
}

// ---- states

static const char *const bound_fields[NUM_FILMS] = {"training_bound", "training_bound_minimum"};
static const char *const guess_fields[NUM_FILMS] = {"training_film", "training_film_minimum"};
static const char *const film_fields[NUM_FILMS] = {"central_film_thickness",
                                                   "minimum_film_thickness"};

static ehd_status put_choice(artefact *file, size_t place, const adaptive_state *state,
                             ehd_error *error) {
    const int64_t point = (int64_t)state->point, round = (int64_t)state->round;
    const trial_verdict *verdict = &state->verdict;
    ehd_status status = artefact_put_integers_part(file, "training_point", place, 1, &point, error);

    if (!status)
        status = artefact_put_integers_part(file, "training_round", place, 1, &round, error);
    for (int f = 0; f < NUM_FILMS && !status; f++) {
        status = artefact_put_part(file, bound_fields[f], place, 1, &verdict->bound[f], error);
        if (!status)
            status = artefact_put_part(file, guess_fields[f], place, 1, &verdict->film[f], error);
    }
    return status;
}

/* The numbers of the states from `first` on, behind which the axis has its length. */
static ehd_status put_numbers(artefact *file, size_t first, size_t count, ehd_error *error) {
    double *numbers = malloc((count + 1) * sizeof *numbers);
    if (!numbers)
        return ehd_fail(error, EHD_MEMORY, "%s: found no memory for %zu points",
                        artefact_path(file), count);

    for (size_t i = 0; i < count; i++)
        numbers[i] = (double)(first + i);
    ehd_status status = artefact_put_axis_part(file, "state", first, count, numbers, error);
    free(numbers);
    return status ? status : artefact_flush(file, error);
}

ehd_status adaptive_file_add(artefact *file, const training_set *set, const adaptive_state *states,
                             size_t first, size_t count, ehd_error *error) {
    ehd_status status = EHD_OK;

    for (size_t i = 0; i < count && !status; i++) {
        const adaptive_state *state = &states[first + i];
        status = snapshots_put_contact(file, first + i, &set->contacts[state->point], error);
        if (!status) status = put_choice(file, first + i, state, error);
    }
    // the axis last and once, so that a round that is read is whole
    return status ? status : put_numbers(file, first, count, error);
}

// ---- resuming

static ehd_status read_choice(adaptive_state *state, artefact *file, size_t place,
                              size_t num_points, ehd_error *error) {
    int64_t point = 0, round = 0;
    ehd_status status = artefact_get_integers_part(file, "training_point", place, 1, &point, error);

    if (!status)
        status = artefact_get_integers_part(file, "training_round", place, 1, &round, error);
    for (int f = 0; f < NUM_FILMS && !status; f++) {
        trial_verdict *verdict = &state->verdict;
        status = artefact_get_part(file, bound_fields[f], place, 1, &verdict->bound[f], error);
        if (!status)
            status = artefact_get_part(file, guess_fields[f], place, 1, &verdict->film[f], error);
    }
    if (!status && (point < 0 || (size_t)point >= num_points || round < 0))
        status = ehd_fail(error, EHD_DATA,
                          "%s: state %zu: found point %lld of round %lld, expected 0 to %zu of 0 "
                          "or later",
                          artefact_path(file), place, (long long)point, (long long)round,
                          num_points - 1);
    if (status) return status;
    state->point = (size_t)point;
    state->round = (size_t)round;
    return EHD_OK;
}

/* Of the last round, a state that is not whole is solved again; others are built on. */
static ehd_status restore_state(training *points, double (*films)[NUM_FILMS], artefact *file,
                                const adaptive_state *state, size_t place, bool of_last_round,
                                ehd_error *error) {
    int64_t outcome = -1;
    bool whole = false;
    ehd_status status = artefact_get_integers_part(file, "status", place, 1, &outcome, error);

    if (status || outcome < 0) return status;
    for (int f = 0; f < NUM_FILMS && !status; f++)
        status = artefact_get_part(file, film_fields[f], place, 1, &films[state->point][f], error);
    if (status) return status;
    status = snapshots_restore(&whole, points, state->point, file, place, outcome, error);
    return !status && !whole && !of_last_round ? EHD_DATA : status;
}

ehd_status adaptive_file_resume(artefact **file, adaptive_state *states, size_t *num_states,
                                double (*films)[NUM_FILMS], training *points, const program *caller,
                                ehd_error *error) {
    const training_set *set = points->set;
    ehd_status status = snapshots_open_partial(file, set, caller, error);
    if (status) return status;

    size_t count = artefact_length(*file, "state");
    if (count > set->num_points)
        status = ehd_fail(error, EHD_DATA,
                          "%s.partial: state: found %zu, expected at most %zu, the plan's points",
                          caller->output, count, set->num_points);
    if (!status) status = artefact_cut_axis(*file, "state", count, error);
    // a disk that fails may have left the length without the numbers
    if (!status && count > 0) status = put_numbers(*file, 0, count, error);
    for (size_t i = 0; i < count && !status; i++)
        status = read_choice(&states[i], *file, i, set->num_points, error);
    for (size_t i = 0; i < count && !status; i++)
        status = restore_state(points, films, *file, &states[i], i,
                               states[i].round == states[count - 1].round, error);
    *num_states = count;
    if (status) artefact_close(file);
    return status;
}

// ---- the curve

ehd_status adaptive_file_put_curve(artefact *file, const adaptive_round *rounds, size_t num_rounds,
                                   ehd_error *error) {
    ehd_status status = artefact_end_streaming(file, error);

    if (!status) status = artefact_put_axis(file, "round", num_rounds, NULL, error);
    for (size_t i = 0; i < num_rounds && !status; i++) {
        const int64_t num_points = (int64_t)rounds[i].num_points;
        status = artefact_put_integers_part(file, "round_points", i, 1, &num_points, error);
        if (!status)
            status = artefact_put_part(file, "round_indicated", i, 1, &rounds[i].indicated, error);
        if (!status)
            status = artefact_put_part(file, "round_deviation", i, 1, &rounds[i].deviation, error);
        if (!status)
            status = artefact_put_part(file, "round_seconds", i, 1, &rounds[i].seconds, error);
    }
    return status;
}
