/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/calibrate/check_scenes.h"

#include "common/output/grid_file.h"
#include "common/training/between.h"
#include "romrun/trust/trained_range.h"

#include <stdlib.h>

/* Smallest and largest number of stationary check scenes, percentage of scenes that are chosen far
 * from each other, and largest number of trajectories. Scenes far from each other lie mostly at the
 * edge of the region and find the largest errors. The other scenes, an even sample along a walk
 * through the region, represent the usual errors. The factors of the estimates were compared with
 * the factors that cover all errors of 118 and 149 random scenes (lower and higher loaded region).
 * With 20 scenes far from each other and 10 other scenes, the factors are at least 1.6 times as
 * large. With 20 scenes along the walk alone they are only 0.65 times as large
 * (deimselect/README.md, The check). */
enum { MIN_SCENES = 10, MAX_SCENES = 30, PERCENT_SPREAD = 67, MAX_TRAJECTORIES = 3 };

static const shard all = {1, 1};

/* Creates the scenes of a plan on the grid of the model. */
static ehd_status make_set(training_set *set, const plan *of, const reduced_model *model,
                           const char *name, ehd_error *error) {
    ehd_status status = training_set_init(set, of, name, all, error);

    if (status) return status;
    training_set_take_grid(set, &model->grid);
    status = grid_check(&set->grid, name, &model->grid, "the model", error);
    if (status) training_set_free(set);
    return status;
}

ehd_status check_scenes_keep_trained(training_set *set, const reduced_states *states,
                                     const char *name, ehd_error *error) {
    bool *keep = calloc(set->num_points + 1, sizeof *keep);
    if (!keep) return ehd_no_memory(error, name);

    for (size_t i = 0; i < set->num_points; i++)
        keep[i] = reduced_states_have(states, &set->contacts[i]);
    ehd_status status = training_set_keep(set, keep, name, error);
    free(keep);
    return status;
}

static ehd_status keep_inside(training_set *set, const reduced_model *model, const char *name,
                              ehd_error *error) {
    trained_range *range = trained_range_create(model);
    bool *keep = calloc(set->num_points + 1, sizeof *keep);
    ehd_status status = range && keep ? EHD_OK : ehd_no_memory(error, name);

    for (size_t i = 0; i < set->num_points && !status; i++) {
        const ehd_contact *contact = &set->contacts[i];
        keep[i] = !trained_range_check(range, NULL, contact_place_of_any(contact), NULL) &&
                  !reduced_states_have(&model->states, contact);
    }
    if (!status) status = training_set_keep(set, keep, name, error);
    trained_range_free(range);
    free(keep);
    return status;
}

static size_t smaller(size_t a, size_t b) {
    return a < b ? a : b;
}

static size_t larger(size_t a, size_t b) {
    return a > b ? a : b;
}

/* Returns the number of pairs of a viscosity law and a density law among the points. */
static size_t count_laws(const training_set *set) {
    size_t count = 0;

    for (size_t i = 0; i < set->num_points; i++) {
        const ehd_lubricant *own = &set->contacts[i].lubricant;
        bool known = false;
        for (size_t k = 0; k < i && !known; k++) {
            const ehd_lubricant *other = &set->contacts[k].lubricant;
            known = other->viscosity == own->viscosity && other->density == own->density;
        }
        count += known ? 0 : 1;
    }
    return count;
}

size_t check_scenes_count(size_t num_trained, const training_set *set) {
    const size_t most = MAX_SCENES * larger(count_laws(set), 1);

    return smaller(larger(num_trained / 2, MIN_SCENES), most);
}

/* Chooses among the candidates. Only the chosen candidates remain in the plan `between`. */
static ehd_status choose(plan *between, const training_set *candidates, const training_set *trained,
                         const char *name, ehd_error *error) {
    const size_t num_points = candidates->num_points;
    const size_t num_trajectories = candidates->num_trajectories;
    const size_t count = check_scenes_count(trained->num_points, trained);
    const size_t num_spread = count * PERCENT_SPREAD / 100;
    const size_t num_moved = smaller(larger(trained->num_trajectories / 2, 1), MAX_TRAJECTORIES);
    bool *chosen = calloc(num_points + num_trajectories + 1, sizeof *chosen);
    bool *keep = calloc(between->num_points + 1, sizeof *keep);
    ehd_status status = chosen && keep ? EHD_OK : ehd_no_memory(error, name);

    if (!status) status = between_spread(chosen, candidates, num_spread, error);
    if (!status) status = between_sweep(chosen, candidates, count - num_spread, error);
    if (!status)
        status = between_spread_trajectories(chosen + num_points, candidates, num_moved, error);
    for (size_t i = 0; i < num_points && !status; i++)
        keep[candidates->numbers[i]] = chosen[i];
    for (size_t t = 0; t < num_trajectories && !status; t++)
        keep[candidates->trajectories[t].number] = chosen[num_points + t];
    if (!status) status = between_keep(between, keep, name, error);
    free(chosen);
    free(keep);
    return status;
}

static ehd_status nothing_between(const char *name, ehd_error *error) {
    return ehd_fail(error, EHD_DATA,
                    "%s: found no scene of the trained range half-way between two training points, "
                    "expected some",
                    name);
}

ehd_status check_scenes_choose(training_set *set, const reduced_model *model, const char *plan_text,
                               const char *name, ehd_error *error) {
    plan of = {0}, between = {0};
    training_set trained = {0}, candidates = {0};
    ehd_status status = plan_parse(&of, plan_text, name, error);

    *set = (training_set){0};
    if (!status) status = make_set(&trained, &of, model, name, error);
    if (!status) status = check_scenes_keep_trained(&trained, &model->states, name, error);
    if (!status) status = between_neighbours(&between, &of, &trained, name, error);
    if (!status && between.num_points == 0) status = nothing_between(name, error);
    if (!status) status = make_set(&candidates, &between, model, name, error);
    if (!status) status = keep_inside(&candidates, model, name, error);
    if (!status) status = choose(&between, &candidates, &trained, name, error);
    if (!status && between.num_points == 0) status = nothing_between(name, error);
    if (!status) status = make_set(set, &between, model, name, error);
    training_set_free(&candidates);
    training_set_free(&trained);
    plan_free(&between);
    plan_free(&of);
    return status;
}
