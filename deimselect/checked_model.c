/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "deimselect/checked_model.h"

#include "romrun/calibrate/accuracy.h"
#include "romrun/calibrate/calibrate.h"
#include "romrun/calibrate/check_scenes.h"
#include "romrun/calibrate/validation.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

typedef struct check_run {
    const program *caller;
    const check_task *task;
    validation scenes;
    trade_table table; // empty: the model is not checked
    char *draft;       // path of a temporary file with the model, whose errors are measured
    artefact *output;
} check_run;

static void check_run_free(check_run *self) {
    artefact_close(&self->output);
    if (self->draft) unlink(self->draft);
    free(self->draft);
    trade_free(&self->table);
    validation_free(&self->scenes);
}

/* Checks whether `status` means that there are no scenes on which the model can be checked. In this
 * case the model is written without a check. */
static bool is_unchecked(ehd_status status) {
    return status == EHD_DATA || status == EHD_NOINPUT || status == EHD_NOT_CONVERGED;
}

// ---- the files

static ehd_status create_output(check_run *self, ehd_error *error) {
    const check_task *task = self->task;
    char *settings = calibration_settings(task->settings, self->scenes.set.text);
    ehd_status status = settings
                            ? artefact_create(&self->output, self->caller->output, &schema_model,
                                              self->caller, settings, task->inputs, error)
                            : ehd_no_memory(error, self->caller->output);

    free(settings);
    return status;
}

/* Writes the model to a temporary file beside the output, from which validation_measure reads it.
 * The output itself cannot be read yet, because it gets its name only when it is complete. */
static ehd_status write_draft(check_run *self, const reduced_model *model,
                              const reduced_basis *basis, const model_origin *origin,
                              ehd_error *error) {
    const char *const no_inputs[] = {NULL};
    program writer = *self->caller;

    if (asprintf(&self->draft, "%s.unchecked", self->caller->output) < 0) self->draft = NULL;
    if (!self->draft) return ehd_no_memory(error, self->caller->output);
    writer.output = self->draft;
    writer.force = true;
    return model_write(model, basis, origin, &writer, self->task->settings, no_inputs, error);
}

// ---- report

/* Warns if the error of the whole model on trajectories exceeds the default accuracy, or if a
 * trajectory has no solution. */
static void warn_in_time(const check_run *self, const trade_position *whole) {
    const double *worst = whole->worst_in_time;

    if (whole->num_lost == 0 &&
        fmax(worst[TRADE_CENTRAL_FILM], worst[TRADE_MINIMUM_FILM]) <= accuracy_limit(0))
        return;
    program_warn(self->caller,
                 "%s: found films off by more than %g %% or no solution on trajectories between "
                 "those of the training, expected less: the training is too thin, add some between",
                 self->caller->output, 100 * accuracy_limit(0));
}

/* Warns if the error of the whole model on stationary scenes exceeds the default accuracy, or if a
 * scene has no solution. The warning names the worst scene (validation_worst), around which
 * training points are missing. */
static void warn_of(const check_run *self, const trade_position *whole) {
    const double central = whole->deviation[TRADE_CENTRAL_FILM][TRADE_WORST];
    const double minimum = whole->deviation[TRADE_MINIMUM_FILM][TRADE_WORST];
    const ehd_contact *worst = NULL;
    char place[POINT_NAME] = "them";
    ehd_error ignored;
    if (whole->num_failures == 0 && fmax(central, minimum) <= accuracy_limit(0)) return;

    // the model is finished, so a failure here only omits the place from the warning
    if (!validation_worst(&worst, &self->scenes, self->draft, &ignored) && worst)
        training_point_name(place, worst);
    program_warn(self->caller,
                 "%s: found films off by more than %g %% or no solution between training points, "
                 "expected less: the training is too thin, add points around %s",
                 self->caller->output, 100 * accuracy_limit(0), place);
}

static void describe_scenes(const check_run *self, const trade_position *whole, FILE *stream) {
    const validation *scenes = &self->scenes;
    const size_t num_points = scenes->set.num_points;

    fprintf(stream, "checked on %zu scene%s between the training points: ", scenes->num_scenes,
            scenes->num_scenes == 1 ? "" : "s");
    if (whole->num_failures < scenes->num_scenes)
        fprintf(stream, "central film at most %.2g %% off, minimum film %.2g %%",
                100 * whole->deviation[TRADE_CENTRAL_FILM][TRADE_WORST],
                100 * whole->deviation[TRADE_MINIMUM_FILM][TRADE_WORST]);
    if (whole->num_failures > 0)
        fprintf(stream, "%s%zu not solved", whole->num_failures < scenes->num_scenes ? "; " : "",
                whole->num_failures);
    if (scenes->num_scenes < num_points)
        fprintf(stream, "; %zu more that the full model did not solve",
                num_points - scenes->num_scenes);
    fputc('\n', stream);
}

static void describe_trajectories(const check_run *self, const trade_position *whole,
                                  FILE *stream) {
    const size_t count = self->scenes.num_recordings;

    fprintf(stream, "checked on %zu %s between those of the training: ", count,
            count == 1 ? "trajectory" : "trajectories");
    if (whole->num_lost < self->scenes.num_recordings)
        fprintf(stream, "central film at most %.2g %% off, minimum film %.2g %%",
                100 * whole->worst_in_time[TRADE_CENTRAL_FILM],
                100 * whole->worst_in_time[TRADE_MINIMUM_FILM]);
    if (whole->num_lost > 0)
        fprintf(stream, "%s%zu not solved",
                whole->num_lost < self->scenes.num_recordings ? "; " : "", whole->num_lost);
    fputc('\n', stream);
}

static void describe(const check_run *self, FILE *stream) {
    const trade_position *whole = &self->table.positions[self->table.num_positions - 1];

    if (self->scenes.num_scenes > 0) describe_scenes(self, whole, stream);
    if (self->scenes.num_recordings > 0) describe_trajectories(self, whole, stream);
}

static void report(char text[CHECK_REPORT], const check_run *self) {
    FILE *stream = fmemopen(text, CHECK_REPORT, "w");

    if (stream) describe(self, stream);
    if (stream) fclose(stream);
}

/* Warns if the check shows too large errors or failed solutions. Fails if the model solved none of
 * the scenes, or none of the trajectories. */
static ehd_status judge(const check_run *self, ehd_error *error) {
    const trade_position *whole = &self->table.positions[self->table.num_positions - 1];
    const size_t num_scenes = self->scenes.num_scenes, num_moving = self->scenes.num_recordings;
    const bool failed = num_scenes > 0 && whole->num_failures == num_scenes;

    if (failed || (num_moving > 0 && whole->num_lost == num_moving))
        return ehd_fail(error, EHD_UNTRUSTED,
                        "%s: written, but the model solved no %s of its check: train it with more "
                        "points or modes",
                        self->caller->output, failed ? "scene" : "trajectory");
    if (num_moving > 0) warn_in_time(self, whole);
    if (num_scenes > 0) warn_of(self, whole);
    return EHD_OK;
}

// ---- all

/* Solves the check scenes with the full model. */
static ehd_status measure(check_run *self, const reduced_model *model, ehd_error *error) {
    const check_task *task = self->task;
    trained_range *range = trained_range_create(model);
    ehd_status status = range ? EHD_OK : ehd_no_memory(error, self->draft);

    if (!status)
        status = training_check_memory(&self->scenes.set, self->caller, task->name,
                                       task->num_workers, error);
    if (!status)
        status = validation_solve(&self->scenes, range, self->caller, task->name, task->num_workers,
                                  error);
    trained_range_free(range);
    return status;
}

ehd_status checked_model_write(char worth[CHECK_REPORT], const reduced_model *model,
                               const reduced_basis *basis, const model_origin *origin,
                               const program *caller, const check_task *task, ehd_error *error) {
    program checking = *caller;
    check_run self = {.caller = &checking, .task = task};
    ehd_error why = {""};
    worth[0] = '\0';
    stage_next(&checking.stage, "check");
    ehd_status unchecked = check_scenes_choose(
        &self.scenes.set, model, task->plan_text ? task->plan_text : "", task->name, &why);
    ehd_status status = is_unchecked(unchecked) ? EHD_OK : unchecked;

    if (!status) status = create_output(&self, &why);
    if (!status) status = model_put(self.output, model, basis, origin, &why);
    if (!status && !unchecked) {
        status = unchecked = measure(&self, model, &why);
        if (is_unchecked(unchecked)) status = EHD_OK;
    }
    if (!status && !unchecked) status = write_draft(&self, model, basis, origin, &why);
    if (!status && !unchecked)
        status = validation_measure(&self.table, &self.scenes, &checking, self.draft, &why);
    if (!status && !unchecked) status = trade_write(self.output, &self.table, &why);
    if (!status) status = artefact_finish(&self.output, &why);
    if (!status && !unchecked) report(worth, &self);
    const ehd_status solved = !status && !unchecked ? judge(&self, error) : EHD_OK;
    check_run_free(&self);
    if (!status) stage_end(&checking.stage);
    if (status) return ehd_fail(error, status, "%s", why.text);
    if (!unchecked) return solved;
    return ehd_fail(error, EHD_UNTRUSTED,
                    "%s: written, but not checked: %s; romrun calibrate checks it on a plan "
                    "(--no-check: without a check)",
                    caller->output, why.text);
}
