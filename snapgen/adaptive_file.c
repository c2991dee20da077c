/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "snapgen/adaptive_file.h"

#include "common/output/columns.h"
#include "common/output/grid_file.h"
#include "snapgen/snapshots.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

ehd_status adaptive_file_create(artefact **file, const program *caller, const training_set *set,
                                const char *plan_path, ehd_error *error) {
    const char **inputs = training_inputs(set, plan_path, NULL);
    ehd_status status = inputs ? artefact_create_growing(file, caller->output, &schema_snapshots,
                                                         "state", caller, set->text, inputs, error)
                               : ehd_no_memory(error, plan_path);

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
    const trial_verdict *verdict = &state->verdict;
    const named_number numbers[] = {{"training_point", (double)state->point},
                                    {"training_round", (double)state->round},
                                    {bound_fields[0], verdict->bound[0]},
                                    {guess_fields[0], verdict->film[0]},
                                    {bound_fields[1], verdict->bound[1]},
                                    {guess_fields[1], verdict->film[1]},
                                    {0}};

    return numbers_put(file, place, numbers, error);
}

/* Writes the numbers of the states from `first` on. This sets the length of the axis `state`. */
static ehd_status put_numbers(artefact *file, size_t first, size_t count, ehd_error *error) {
    ehd_status status = artefact_put_axis_part(file, "state", first, count, NULL, error);

    if (!status) status = artefact_flush(file, error);
    if (!status) artefact_save(file);
    return status;
}

ehd_status adaptive_file_add(artefact *file, const training_set *set, const adaptive_state *states,
                             size_t first, size_t count, ehd_error *error) {
    ehd_status status = EHD_OK;

    for (size_t i = 0; i < count && !status; i++) {
        const adaptive_state *state = &states[first + i];
        status = snapshots_put_contact(file, first + i, &set->contacts[state->point], error);
        if (!status) status = put_choice(file, first + i, state, error);
    }
    // the axis is written last and in one call, so that each round in the file is complete
    return status ? status : put_numbers(file, first, count, error);
}

// ---- resuming

static ehd_status read_choice(adaptive_state *state, artefact *file, size_t place,
                              size_t num_points, ehd_error *error) {
    int64_t point = 0, round = 0;
    ehd_status status =
        artefact_get_integers_part(file, "training_point", place, 1, &point, 1, error);

    if (!status)
        status = artefact_get_integers_part(file, "training_round", place, 1, &round, 1, error);
    for (int f = 0; f < NUM_FILMS && !status; f++) {
        trial_verdict *verdict = &state->verdict;
        status = artefact_get_part(file, bound_fields[f], place, 1, &verdict->bound[f], 1, error);
        if (!status)
            status =
                artefact_get_part(file, guess_fields[f], place, 1, &verdict->film[f], 1, error);
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

/* Restores a state that is done. An incomplete state of the last round is solved again. In an
 * earlier round an incomplete state is an error (EHD_DATA), since later rounds build on it. */
static ehd_status restore_state(training *points, double (*films)[NUM_FILMS], artefact *file,
                                const adaptive_state *state, size_t place, bool of_last_round,
                                ehd_error *error) {
    int64_t outcome = -1;
    bool whole = false;
    ehd_status status = artefact_get_integers_part(file, "status", place, 1, &outcome, 1, error);

    if (status || outcome < 0) return status;
    for (int f = 0; f < NUM_FILMS && !status; f++)
        status =
            artefact_get_part(file, film_fields[f], place, 1, &films[state->point][f], 1, error);
    if (status) return status;
    status = snapshots_restore(&whole, points, state->point, file, place, outcome, error);
    return !status && !whole && !of_last_round ? EHD_DATA : status;
}

static ehd_status check_distinct(const adaptive_state *states, size_t count, const char *path,
                                 ehd_error *error) {
    for (size_t i = 1; i < count; i++)
        for (size_t k = 0; k < i; k++)
            if (states[k].point == states[i].point)
                return ehd_fail(error, EHD_DATA,
                                "%s: training_point: found %zu as states %zu and %zu, expected it "
                                "once",
                                path, states[i].point, k, i);
    return EHD_OK;
}

static ehd_status read_states(adaptive_state *states, double (*films)[NUM_FILMS], training *points,
                              artefact *file, size_t count, ehd_error *error) {
    const size_t num_points = points->set->num_points;
    ehd_status status = EHD_OK;

    for (size_t i = 0; i < count && !status; i++)
        status = read_choice(&states[i], file, i, num_points, error);
    if (!status) status = check_distinct(states, count, artefact_path(file), error);
    for (size_t i = 0; i < count && !status; i++)
        status = restore_state(points, films, file, &states[i], i,
                               states[i].round == states[count - 1].round, error);
    return status;
}

static ehd_status check_count(size_t count, const training_set *set, const char *path,
                              ehd_error *error) {
    if (count <= set->num_points) return EHD_OK;
    return ehd_fail(error, EHD_DATA,
                    "%s: state: found %zu, expected at most %zu, the plan's points", path, count,
                    set->num_points);
}

ehd_status adaptive_file_resume(artefact **file, adaptive_state *states, size_t *num_states,
                                double (*films)[NUM_FILMS], training *points, const program *caller,
                                ehd_error *error) {
    const training_set *set = points->set;
    ehd_status status = snapshots_open_partial(file, set, caller, error);
    if (status) return status;

    size_t count = artefact_length(*file, "state");
    status = check_count(count, set, artefact_path(*file), error);
    if (!status) status = artefact_cut_axis(*file, "state", count, error);
    // after a disk failure the axis may have its length, but not its numbers
    if (!status && count > 0) status = put_numbers(*file, 0, count, error);
    if (!status) status = read_states(states, films, points, *file, count, error);
    // the file may have an incomplete contact for a point that is solved again
    for (size_t i = 0; i < count && !status; i++)
        if (!points->points[states[i].point].done)
            status = snapshots_put_contact(*file, i, &set->contacts[states[i].point], error);
    *num_states = count;
    if (status) artefact_close(file);
    return status;
}

// ---- a training in pieces

/* Opens a file of an adaptive training, finished or not. EHD_DATA: its settings are not `text`. */
static ehd_status open_same(artefact **file, const char *path, const char *text, ehd_error *error) {
    const artefact_schema *const kinds[] = {&schema_snapshots, NULL};
    char *found = NULL;
    ehd_status status = artefact_open_unfinished(file, path, kinds, error);

    if (!status) status = artefact_get_text(*file, "settings", &found, error);
    if (!status && strcmp(found, text) != 0)
        status = ehd_fail(error, EHD_DATA,
                          "%s: found other settings, expected those of this training", path);
    if (status) artefact_close(file);
    free(found);
    return status;
}

ehd_status adaptive_file_read(adaptive_state *states, size_t *num_states,
                              double (*films)[NUM_FILMS], training *points, const char *path,
                              ehd_error *error) {
    artefact *file = NULL;
    ehd_status status = open_same(&file, path, points->set->text, error);
    if (status) return status;

    *num_states = artefact_length(file, "state");
    status = check_count(*num_states, points->set, path, error);
    if (!status) status = read_states(states, films, points, file, *num_states, error);
    artefact_close(&file);
    return status;
}

/* Returns the number of values of one state in a dataset, whose first axis is `state`. */
static size_t entry_length(const artefact *file, const artefact_field *field) {
    const char *axes[ARTEFACT_MAX_RANK];
    const size_t rank = artefact_axes(axes, file, field);
    size_t length = 1;

    for (size_t k = 1; k < rank; k++)
        length *= artefact_length(file, axes[k]);
    return length;
}

static ehd_status copy_entry(artefact *to, size_t to_state, artefact *from, size_t from_state,
                             const artefact_field *field, ehd_error *error) {
    const size_t length = entry_length(to, field);
    double *reals = malloc(length * sizeof *reals);
    int64_t *integers = malloc(length * sizeof *integers);
    ehd_status status = reals && integers ? EHD_OK : ehd_no_memory(error, artefact_path(to));

    if (!status && entry_length(from, field) != length)
        status = ehd_fail(error, EHD_DATA, "%s: %s: found another length, expected %zu",
                          artefact_path(from), field->name, length);
    if (!status && field->type == ARTEFACT_REAL) {
        status = artefact_get_part(from, field->name, from_state, 1, reals, length, error);
        if (!status) status = artefact_put_part(to, field->name, to_state, 1, reals, error);
    } else if (!status) {
        status =
            artefact_get_integers_part(from, field->name, from_state, 1, integers, length, error);
        if (!status)
            status = artefact_put_integers_part(to, field->name, to_state, 1, integers, error);
    }
    free(reals);
    free(integers);
    return status;
}

static const char outcome_field[] = "status";

/* Copies a state. The outcome is written last, as in snapshots_store. */
static ehd_status copy_state(artefact *to, size_t to_state, artefact *from, size_t from_state,
                             int64_t outcome, ehd_error *error) {
    ehd_status status = EHD_OK;

    for (const artefact_field *field = schema_snapshots.fields; field->name && !status; field++)
        if (field->axes[0] && strcmp(field->axes[0], "state") == 0 &&
            strcmp(field->name, outcome_field) != 0 && artefact_has(to, field->name))
            status = copy_entry(to, to_state, from, from_state, field, error);
    if (!status) status = artefact_sync(to, error);
    if (!status)
        status = artefact_put_integers_part(to, outcome_field, to_state, 1, &outcome, error);
    return status ? status : artefact_flush(to, error);
}

static size_t find_state(const adaptive_state *states, size_t num_states,
                         const adaptive_state *wanted) {
    size_t s = 0;

    while (s < num_states && (states[s].point != wanted->point || states[s].round != wanted->round))
        s++;
    return s;
}

static ehd_status take_state(artefact *file, training *points, double (*films)[NUM_FILMS],
                             const adaptive_state *states, size_t num_states, artefact *piece,
                             size_t place, ehd_error *error) {
    adaptive_state state;
    int64_t outcome = -1;
    ehd_status status = read_choice(&state, piece, place, points->set->num_points, error);
    if (status) return status;

    const size_t to = find_state(states, num_states, &state);
    if (to == num_states)
        return ehd_fail(error, EHD_DATA,
                        "%s: state %zu: found point %zu of round %zu, expected one that was chosen",
                        artefact_path(piece), place, state.point, state.round);
    status = artefact_get_integers_part(piece, outcome_field, place, 1, &outcome, 1, error);
    if (status || outcome < 0 || points->points[state.point].done) return status;
    status = restore_state(points, films, piece, &state, place, false, error);
    return status ? status : copy_state(file, to, piece, place, outcome, error);
}

ehd_status adaptive_file_take(artefact *file, training *points, double (*films)[NUM_FILMS],
                              const adaptive_state *states, size_t num_states, const char *path,
                              ehd_error *error) {
    artefact *piece = NULL;
    ehd_status status = open_same(&piece, path, points->set->text, error);
    if (status) return status;

    const size_t count = artefact_length(piece, "state");
    for (size_t i = 0; i < count && !status; i++)
        status = take_state(file, points, films, states, num_states, piece, i, error);
    artefact_close(&piece);
    return status;
}

// ---- the outcomes of the rounds

ehd_status adaptive_file_put_curve(artefact *file, const adaptive_round *rounds, size_t num_rounds,
                                   ehd_error *error) {
    ehd_status status = artefact_end_streaming(file, error);

    if (!status) status = artefact_put_axis(file, "round", num_rounds, NULL, error);
    for (size_t i = 0; i < num_rounds && !status; i++) {
        const named_number numbers[] = {{"round_points", (double)rounds[i].num_points},
                                        {"round_indicated", rounds[i].indicated},
                                        {"round_deviation", rounds[i].deviation},
                                        {"round_seconds", rounds[i].seconds},
                                        {0}};
        status = numbers_put(file, i, numbers, error);
    }
    return status;
}
