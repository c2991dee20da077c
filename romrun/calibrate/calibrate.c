/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/calibrate/calibrate.h"

#include "common/output/grid_file.h"
#include "romrun/calibrate/validation.h"
#include "romrun/model/model_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// ---- which scenes

/* Marks the points inside of the trained range in `keep`. Returns EHD_DATA if the model was trained
 * on one of the points. */
static ehd_status choose_points(bool *keep, const training_set *set, const reduced_model *model,
                                const trained_range *range, const program *self,
                                const char *plan_path, const char *model_path, ehd_error *error) {
    char name[POINT_NAME];

    for (size_t i = 0; i < set->num_points; i++) {
        const ehd_contact *contact = &set->contacts[i];
        const char *outside = trained_range_check(range, NULL, contact_place_of_any(contact), NULL);
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
    ehd_status status = keep ? EHD_OK : ehd_no_memory(error, plan_path);

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
        if (!*range) status = ehd_no_memory(error, model_path);
    }
    if (!status) status = keep_inside(set, &model, *range, self, plan_path, model_path, error);
    reduced_model_free(&model);
    return status;
}

// ---- the file

static const char separator[] = "# calibrated on\n";

char *calibration_settings(const char *of_model, const char *of_plan) {
    const char *end = strstr(of_model, separator);
    size_t length = end ? (size_t)(end - of_model) : strlen(of_model);
    char *joined = NULL;

    if (asprintf(&joined, "%.*s%s%s", (int)length, of_model, of_plan ? separator : "",
                 of_plan ? of_plan : "") < 0)
        joined = NULL;
    return joined;
}

static ehd_status create_output(artefact **output, artefact **model, const program *self,
                                const training_set *set, const char *plan_path,
                                const char *model_path, ehd_error *error) {
    static const artefact_schema *const kinds[] = {&schema_model, NULL};
    const char **inputs = training_inputs(set, plan_path, model_path);
    char *of_model = NULL, *settings = NULL;
    ehd_status status = artefact_open(model, model_path, kinds, error);

    // models of other programs may have no settings
    if (!status && artefact_has(*model, "settings"))
        status = artefact_get_text(*model, "settings", &of_model, error);
    settings = calibration_settings(of_model ? of_model : "", set->text);
    if (!status && (!inputs || !settings)) status = ehd_no_memory(error, plan_path);
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
    const bool indicated = !in_time && position->indicator_factor > 0;
    const bool indicated_in_time = in_time && position->factor_in_time > 0;
    trade_name(name, &position->sizes);
    printf("most accurate%s: %s, %s%s at most %.2g off%s, %.3g ms%s\n", in_time ? " in time" : "",
           name, in_time && !indicated_in_time ? "central film" : "films",
           indicated || indicated_in_time ? " indicated to be" : "", price.deviation,
           indicated           ? " on 90 % of the scenes"
           : indicated_in_time ? " on half of the trajectories"
                               : "",
           price.seconds * 1e3, in_time ? " a step" : "");
    if (indicated)
        printf("indicated over true deviation there: 5 %% %.2g, median %.2g, 95 %% %.2g\n",
               position->effectivity[PART_5], position->effectivity[PART_50],
               position->effectivity[PART_95]);
}

static ehd_status report(const program *self, const validation *scenes, const trade_table *table,
                         const char *plan_path, double seconds, ehd_error *error) {
    printf("%zu scenes, %zu trajectories, %zu sizes, %.1f s (romrun trade prints the table)\n",
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
    if (!status) status = validation_solve(&scenes, range, self, plan_path, num_workers, error);
    if (!status) status = validation_measure(&table, &scenes, self, model_path, error);
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
