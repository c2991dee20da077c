/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/calibrate/calibrate.h"

#include "common/output/grid_file.h"
#include "fullrun/training.h"
#include "romrun/calibrate/calibration.h"
#include "romrun/calibrate/recording.h"
#include "romrun/model/model_file.h"
#include "romrun/model/trade_file.h"
#include "romrun/online/reduced_solver.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The scenes and their full solutions. */
typedef struct validation {
    training_set set;
    training solutions;       // by the full model
    contact_scalars *scalars; // [set.num_points]
    solved_scene *scenes;     // [num_scenes] those that converged
    size_t num_scenes;
    recording *recordings; // [set.num_trajectories], the usable ones first
    size_t num_recordings; // usable: ended, and inside the trained range
    size_t num_failed;     // points and trajectories that the full model did not solve
} validation;

static void validation_free(validation *self) {
    for (size_t t = 0; self->recordings && t < self->set.num_trajectories; t++)
        recording_free(&self->recordings[t]);
    free(self->recordings);
    free(self->scenes);
    free(self->scalars);
    if (self->solutions.points) training_free(&self->solutions);
    training_set_free(&self->set);
}

// ---- which scenes

/* Marks the points inside the trained range. */
static ehd_status choose_points(bool *keep, const training_set *set, const reduced_model *model,
                                const trained_range *range, const program *self,
                                const char *plan_path, const char *model_path, ehd_error *error) {
    char name[POINT_NAME];

    for (size_t i = 0; i < set->num_points; i++) {
        const ehd_contact *contact = &set->contacts[i];
        const char *outside = trained_range_check(range, contact->moes_M, contact->alpha_p_H, 0);
        training_point_name(name, contact);
        if (reduced_states_have(&model->states, contact))
            return ehd_fail(error, EHD_DATA,
                            "%s: point %s: found a training point of %s, expected scenes that it "
                            "was not trained on",
                            plan_path, name, model_path);
        if (outside) program_detail(self, "%s: point %s: left out, %s", plan_path, name, outside);
        keep[i] = !outside;
    }
    return EHD_OK;
}

static ehd_status keep_inside(training_set *set, const reduced_model *model,
                              const trained_range *range, const program *self,
                              const char *plan_path, const char *model_path, ehd_error *error) {
    size_t num_before = set->num_points;
    bool *keep = calloc(num_before + 1, sizeof *keep);
    ehd_status status =
        keep ? EHD_OK : ehd_fail(error, EHD_MEMORY, "%s: found no memory", plan_path);

    if (!status)
        status = choose_points(keep, set, model, range, self, plan_path, model_path, error);
    if (!status) status = training_set_keep(set, keep, plan_path, error);
    if (!status && set->num_points + set->num_trajectories == 0)
        status = ehd_fail(error, EHD_DATA,
                          "%s: found all %zu points outside of the trained range of %s, expected "
                          "some inside",
                          plan_path, num_before, model_path);
    if (!status && set->num_points < num_before)
        program_note(self,
                     "%s: %zu of %zu points lie outside of the trained range and are left out "
                     "(--verbose names them)",
                     plan_path, num_before - set->num_points, num_before);
    free(keep);
    return status;
}

static ehd_status load_scenes(training_set *set, trained_range **range, const program *self,
                              const char *plan_path, const char *model_path, ehd_error *error) {
    const shard all = {1, 1};
    reduced_model model = {0};
    plan given;
    ehd_status status = plan_read(&given, plan_path, self->overrides, self->num_overrides, error);
    if (status) return status;

    status = training_set_init(set, &given, plan_path, all, error);
    plan_free(&given);
    if (!status) status = model_read(&model, model_path, NULL, error);
    if (!status) training_set_take_grid(set, &model.grid);
    if (!status) status = grid_check(&set->grid, plan_path, &model.grid, model_path, error);
    if (!status) {
        *range = trained_range_create(&model);
        if (!*range) status = ehd_fail(error, EHD_MEMORY, "%s: found no memory", model_path);
    }
    if (!status) status = keep_inside(set, &model, *range, self, plan_path, model_path, error);
    reduced_model_free(&model);
    return status;
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

    self->scalars = calloc(num_points, sizeof *self->scalars);
    self->scenes = calloc(num_points, sizeof *self->scenes);
    if (!status && (!self->scalars || !self->scenes))
        status = ehd_fail(error, EHD_MEMORY, "points: found no memory");
    if (status) return status;
    self->solutions.store = keep_scalars;
    self->solutions.sink = self->scalars;
    status = training_run(&self->solutions, num_workers, error);
    for (size_t i = 0; i < num_points && !status; i++)
        if (self->solutions.points[i].pressure)
            self->scenes[self->num_scenes++] = (solved_scene){
                &self->set.contacts[i], self->solutions.points[i].pressure, self->scalars[i]};
    self->num_failed += self->solutions.num_failed;
    return status;
}

/* Moves the usable recordings to the front. */
static void keep_recordings(validation *self, const trained_range *range, const program *caller,
                            const char *plan_path) {
    size_t num_outside = 0;

    for (size_t t = 0; t < self->set.num_trajectories; t++) {
        recording *here = &self->recordings[t], *next = &self->recordings[self->num_recordings];
        const char *outside = here->reason[0] ? NULL : recording_check(here, range);
        self->num_failed += here->reason[0] != '\0';
        num_outside += outside != NULL;
        if (outside)
            program_detail(caller, "%s: trajectory %zu: left out, %s", plan_path, t + 1, outside);
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
                     plan_path, num_outside, self->set.num_trajectories);
}

static ehd_status solve_scenes(validation *self, const trained_range *range, const program *caller,
                               const char *plan_path, size_t num_workers, ehd_error *error) {
    ehd_status status = EHD_OK;

    self->recordings = calloc(self->set.num_trajectories + 1, sizeof *self->recordings);
    if (!self->recordings) return ehd_fail(error, EHD_MEMORY, "%s: found no memory", plan_path);
    if (self->set.num_points > 0) status = solve_points(self, caller, num_workers, error);
    if (!status) status = recordings_make(self->recordings, caller, &self->set, num_workers, error);
    if (status == EHD_INTERRUPTED)
        ehd_fail(error, status, "%s: interrupted during the full solutions, nothing written",
                 caller->output);
    if (status) return status;
    keep_recordings(self, range, caller, plan_path);
    status = training_check_outcome(&self->set, self->num_failed, plan_path, error);
    if (!status && self->num_scenes + self->num_recordings == 0)
        status = ehd_fail(error, EHD_DATA,
                          "%s: found nothing inside of the trained range that converged, expected "
                          "some scenes",
                          plan_path);
    return status;
}

// ---- reduced solutions

static ehd_status measure_positions(trade_table *table, const validation *scenes,
                                    const program *self, const char *model_path, ehd_error *error) {
    progress shown;
    ehd_status status = EHD_OK;

    table->num_scenes = scenes->num_scenes;
    table->num_trajectories = scenes->num_recordings;
    progress_start(&shown, self, table->num_positions);
    for (size_t i = 0; i < table->num_positions && !status; i++) {
        trade_position *position = &table->positions[i];
        ehdrom_model *model = NULL;
        char name[TRADE_NAME];
        trade_name(name, &position->sizes);
        progress_show(&shown, i, name);
        status = ehdrom_open(&model, model_path, &position->sizes, error);
        if (!status)
            status =
                calibration_measure(position, model, scenes->scenes, scenes->num_scenes, error);
        if (!status && scenes->num_recordings > 0)
            status = calibration_measure_in_time(position, model, scenes->recordings,
                                                 scenes->num_recordings, error);
        if (status == EHD_INTERRUPTED)
            ehd_fail(error, status, "%s: interrupted after %zu of %zu sizes, nothing written",
                     self->output, i, table->num_positions);
        if (!status) progress_show(&shown, i + 1, name);
        ehdrom_close(model);
    }
    progress_finish(&shown);
    return status;
}

static ehd_status make_ladder(trade_table *table, const char *model_path, ehd_error *error) {
    ehdrom_model *model = NULL;
    ehd_status status = ehdrom_open(&model, model_path, NULL, error);

    if (!status) {
        const ehdrom_properties whole = ehdrom_describe(model);
        status = trade_ladder(table, &whole, error);
    }
    ehdrom_close(model);
    return status;
}

// ---- the file

static const char separator[] = "# calibrated on\n";

/* The model's settings, without those of an earlier calibration, and the plan. */
static char *join_settings(const char *of_model, const char *of_plan) {
    const char *end = strstr(of_model, separator);
    size_t length = end ? (size_t)(end - of_model) : strlen(of_model);
    char *joined = NULL;

    if (asprintf(&joined, "%.*s%s%s", (int)length, of_model, separator, of_plan) < 0) joined = NULL;
    return joined;
}

static ehd_status create_output(artefact **output, artefact **model, const program *self,
                                const training_set *set, const char *plan_path,
                                const char *model_path, ehd_error *error) {
    static const artefact_schema *const kinds[] = {&schema_model, NULL};
    const char **inputs = training_inputs(set, plan_path, model_path);
    char *of_model = NULL, *settings = NULL;
    ehd_status status = artefact_open(model, model_path, kinds, error);

    // optional in models of other programs
    if (!status && artefact_has(*model, "settings"))
        status = artefact_get_text(*model, "settings", &of_model, error);
    settings = join_settings(of_model ? of_model : "", set->text);
    if (!status && (!inputs || !settings))
        status = ehd_fail(error, EHD_MEMORY, "%s: found no memory", plan_path);
    if (!status)
        status =
            artefact_create(output, self->output, &schema_model, self, settings, inputs, error);
    free(settings);
    free(of_model);
    free(inputs);
    return status;
}

static void print_best(const trade_table *table, bool in_time) {
    size_t best = trade_most_accurate(table, in_time);
    char name[TRADE_NAME];

    if (best == table->num_positions) return;
    const trade_position *position = &table->positions[best];
    const trade_price price = trade_price_of(position, in_time);
    bool indicated = !in_time && position->indicator_factor > 0;
    trade_name(name, &position->sizes);
    printf("most accurate%s: %s, %s%s at most %.2g off%s, %.3g ms%s\n", in_time ? " in time" : "",
           name, in_time && !(position->factor_in_time > 0) ? "central film" : "films",
           indicated ? " indicated to be" : "", price.deviation,
           indicated ? " on 90 % of the scenes" : "", price.seconds * 1e3,
           in_time ? " a step" : "");
    if (indicated)
        printf("indicated over true deviation there: 5 %% %.2g, median %.2g, 95 %% %.2g\n",
               position->effectivity[PART_5], position->effectivity[PART_50],
               position->effectivity[PART_95]);
}

static ehd_status report(const program *self, const validation *scenes, const trade_table *table,
                         const char *plan_path, double seconds, ehd_error *error) {
    printf("%zu scenes, %zu trajectories, %zu sizes, %.1f s (romrun --trade prints the table)\n",
           table->num_scenes, table->num_trajectories, table->num_positions, seconds);
    if (table->num_scenes > 0) print_best(table, false);
    if (table->num_trajectories > 0) print_best(table, true);
    if (scenes->num_failed == 0) return EHD_OK;
    return ehd_fail(error, EHD_NOT_CONVERGED,
                    "%s: found %zu of %zu points not converged with the full model, expected none; "
                    "%s is written without them",
                    plan_path, scenes->num_failed,
                    scenes->set.num_points + scenes->set.num_trajectories, self->output);
}

ehd_status calibrate(const program *self, const char *plan_path, const char *model_path,
                     size_t num_workers, ehd_error *error) {
    const double before = program_seconds();
    validation scenes = {0};
    trade_table table = {0};
    trained_range *range = NULL;
    artefact *model = NULL, *output = NULL;
    ehd_status status = load_scenes(&scenes.set, &range, self, plan_path, model_path, error);

    if (!status) status = training_check_memory(&scenes.set, self, plan_path, num_workers, error);
    if (!status)
        status = create_output(&output, &model, self, &scenes.set, plan_path, model_path, error);
    if (!status) status = artefact_copy(output, model, trade_axes, error);
    if (!status) status = make_ladder(&table, model_path, error);
    if (!status) status = solve_scenes(&scenes, range, self, plan_path, num_workers, error);
    if (!status) status = measure_positions(&table, &scenes, self, model_path, error);
    if (!status) status = trade_write(output, &table, error);
    if (!status) status = artefact_finish(&output, error);
    if (!status)
        status = report(self, &scenes, &table, plan_path, program_seconds() - before, error);
    artefact_close(&output);
    artefact_close(&model);
    trained_range_free(range);
    trade_free(&table);
    validation_free(&scenes);
    return status;
}
