/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/calibrate/validation.h"

#include <math.h>
#include <stdlib.h>

void validation_free(validation *self) {
    for (size_t t = 0; self->recordings && t < self->set.num_trajectories; t++)
        recording_free(&self->recordings[t]);
    arena_free(&self->memory);
    if (self->solutions.points) training_free(&self->solutions);
    training_set_free(&self->set);
}

// ---- full solutions

static ehd_status keep_scalars(void *sink, const training_set *set, size_t point,
                               const snapshot *solution, ehd_error *error) {
    contact_scalars *scalars = sink;
    (void)set, (void)error;

    scalars[point] = solution->scalars;
    return EHD_OK;
}

static ehd_status solve_points(validation *self, const program *caller, size_t num_workers,
                               ehd_error *error) {
    size_t num_points = self->set.num_points;
    ehd_status status = training_init(&self->solutions, caller, &self->set, error);

    self->scalars = arena_array(&self->memory, num_points, sizeof *self->scalars);
    self->scenes = arena_array(&self->memory, num_points, sizeof *self->scenes);
    if (!status && self->memory.failed) status = ehd_no_memory(error, "points");
    if (status) return status;
    self->solutions.store = keep_scalars;
    self->solutions.sink = self->scalars;
    self->solutions.rest = NAN;
    status = training_run(&self->solutions, num_workers, error);
    for (size_t i = 0; i < num_points && !status; i++)
        if (self->solutions.points[i].pressure)
            self->scenes[self->num_scenes++] = (solved_scene){
                &self->set.contacts[i], self->solutions.points[i].pressure, self->scalars[i]};
    self->num_failed += self->solutions.num_failed;
    return status;
}

/* Moves the usable recordings to the front and counts them. */
static void keep_recordings(validation *self, const trained_range *range, const program *caller,
                            const char *name) {
    size_t num_outside = 0;

    for (size_t t = 0; t < self->set.num_trajectories; t++) {
        recording *here = &self->recordings[t], *next = &self->recordings[self->num_recordings];
        const char *outside = here->reason[0] ? NULL : recording_check(here, range);
        self->num_failed += here->reason[0] != '\0';
        num_outside += outside != NULL;
        if (outside)
            program_detail(caller, "%s: trajectory %zu: left out, %s", name, t + 1, outside);
        if (outside || here->reason[0]) continue;
        const recording kept = *here;
        *here = *next;
        *next = kept;
        self->num_recordings++;
    }
    if (num_outside > 0)
        program_note(caller,
                     "%s: %zu of %zu trajectories leave the trained range and are left out "
                     "(--verbose says why)",
                     name, num_outside, self->set.num_trajectories);
}

ehd_status validation_solve(validation *self, const trained_range *range, const program *caller,
                            const char *name, size_t num_workers, ehd_error *error) {
    ehd_status status = EHD_OK;

    self->recordings =
        arena_array(&self->memory, self->set.num_trajectories, sizeof *self->recordings);
    if (!self->recordings) return ehd_no_memory(error, name);
    if (self->set.num_points > 0) status = solve_points(self, caller, num_workers, error);
    if (!status) status = recordings_make(self->recordings, caller, &self->set, num_workers, error);
    if (status == EHD_INTERRUPTED)
        ehd_fail(error, status, "%s: interrupted during the full solutions, nothing written",
                 caller->output);
    if (status) return status;
    keep_recordings(self, range, caller, name);
    status = training_check_outcome(&self->set, self->num_failed, name, error);
    if (!status && self->num_scenes + self->num_recordings == 0)
        status = ehd_fail(error, EHD_DATA,
                          "%s: found nothing inside of the trained range that converged, expected "
                          "some scenes",
                          name);
    return status;
}

// ---- reduced solutions

static ehd_status make_ladder(trade_table *table, const char *model_path, ehd_error *error) {
    online_model *model = NULL;
    ehd_status status = online_open(&model, model_path, NULL, error);

    if (!status) {
        const online_properties whole = online_describe(model);
        status = trade_ladder(table, &whole, error);
    }
    online_close(model);
    return status;
}

/* Lists the lubricants of all scenes and trajectories on which the sizes are measured. */
static ehd_status list_shown(shown_lubricants *shown, const validation *scenes, ehd_error *error) {
    const size_t count = scenes->num_scenes + scenes->num_recordings;

    shown->of = calloc(count + 1, sizeof *shown->of);
    if (!shown->of) return ehd_no_memory(error, "calibration");
    for (size_t i = 0; i < scenes->num_scenes; i++)
        shown->of[shown->count++] = shown_of(scenes->scenes[i].contact, false);
    for (size_t t = 0; t < scenes->num_recordings; t++)
        shown->of[shown->count++] = shown_of(scenes->recordings[t].reference, true);
    return EHD_OK;
}

ehd_status validation_measure(trade_table *table, const validation *scenes, const program *caller,
                              const char *model_path, ehd_error *error) {
    progress shown;
    ehd_status status = make_ladder(table, model_path, error);

    if (!status) status = list_shown(&table->shown, scenes, error);
    if (status) return status;
    table->num_scenes = scenes->num_scenes;
    table->num_trajectories = scenes->num_recordings;
    progress_start(&shown, caller, table->num_positions);
    for (size_t i = 0; i < table->num_positions && !status; i++) {
        trade_position *position = &table->positions[i];
        online_model *model = NULL;
        char name[TRADE_NAME];
        trade_name(name, &position->sizes);
        progress_show(&shown, i, name);
        status = online_open(&model, model_path, &(part_sizes){{position->sizes}}, error);
        if (!status) status = online_show(model, &table->shown, error);
        if (!status) status = online_prepare_fields(model, error);
        if (!status)
            status =
                calibration_measure(position, model, scenes->scenes, scenes->num_scenes, error);
        if (!status && scenes->num_recordings > 0)
            status = calibration_measure_in_time(position, model, scenes->recordings,
                                                 scenes->num_recordings, error);
        if (status == EHD_INTERRUPTED)
            ehd_fail(error, status, "%s: interrupted after %zu of %zu sizes, nothing written",
                     caller->output, i, table->num_positions);
        if (!status) progress_show(&shown, i + 1, name);
        online_close(model);
    }
    progress_finish(&shown);
    return status;
}

static double worse_film(const contact_scalars *reduced, const contact_scalars *full) {
    return fmax(fabs(reduced->central_film_thickness / full->central_film_thickness - 1),
                fabs(reduced->minimum_film_thickness / full->minimum_film_thickness - 1));
}

ehd_status validation_worst(const ehd_contact **worst, const validation *scenes,
                            const char *model_path, ehd_error *error) {
    online_model *model = NULL;
    online_solver *solver = NULL;
    shown_lubricants shown = {0};
    double largest = -1;
    ehd_status status = online_open(&model, model_path, NULL, error);

    *worst = NULL;
    if (!status) status = list_shown(&shown, scenes, error);
    if (!status) status = online_show(model, &shown, error);
    if (!status) status = online_solver_create(&solver, model, error);
    for (size_t i = 0; i < scenes->num_scenes && !status; i++) {
        const solved_scene *solved = &scenes->scenes[i];
        online_result result;
        status = online_solve(&result, solver, solved->contact, error);
        const double here =
            status || result.status ? INFINITY : worse_film(&result.scalars, &solved->scalars);
        if (!(here > largest)) continue;
        largest = here;
        *worst = solved->contact;
    }
    online_solver_free(solver);
    online_close(model);
    free(shown.of);
    return status;
}
