/* SPDX-License-Identifier: GPL-3.0-or-later */
/* romrun: solves scenes with a reduced model, measures the errors of the model and exports it. */
#include "common/output/check.h"
#include "common/output/grid_file.h"
#include "common/output/inputs.h"
#include "common/output/output_main.h"
#include "common/output/result.h"
#include "common/output/time_result.h"
#include "common/output/time_run.h"
#include "common/output/traction_output.h"
#include "common/program/output_file.h"
#include "common/program/program.h"
#include "common/settings/part_list.h"
#include "common/training/pool.h"
#include "fullrun/resolution.h"
#include "romrun/calibrate/accuracy.h"
#include "romrun/calibrate/against.h"
#include "romrun/calibrate/calibrate.h"
#include "romrun/calibrate/cases.h"
#include "romrun/calibrate/describe_model.h"
#include "romrun/calibrate/fallback.h"
#include "romrun/calibrate/fallback_march.h"
#include "romrun/calibrate/reduced_result.h"
#include "romrun/calibrate/verify.h"
#include "romrun/fmu/export.h"
#include "romrun/model/readers.h"
#include "romrun/model/trade_file.h"
#include "romrun/online/online.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Bits for the modes that have an option: bit i stands for row i of the table `modes`.
enum { SCENE = 1, CASES = 2, CALIBRATE = 4, TRADE = 8, EXPORT = 16, FMU = 32 };

typedef struct romrun_options {
    const char *model;
    const char *against;    // NULL: no comparison
    part_list models;       // files of the model: one file, or the files of a list
    part_sizes sizes;       // numbers of modes and rows that are used of each of these files
    double accuracy;        // value of --accuracy, which determines `sizes`; 0: not given
    accuracy_limits limits; // limits of other quantities
    part_sizes fallback;    // most accurate numbers, used if `sizes` is not accurate enough
    // reason why no step of the reduced model is trusted; NULL: each step is judged by itself
    const char *distrust;
    const char *fall_back; // "full": fallback to the full model; NULL or "none": no fallback
    bool allow_untrusted, resume, verify;
    size_t repeats;  // number of solutions in a row; their median time is reported
    size_t fmi;      // version of the FMI: 2 or 3
    size_t num_jobs; // number of jobs; 0: as many jobs as there are processors
} romrun_options;

// clang-format off
#define OWN_OPTIONS romrun_options

// columns: name, letter, argument, help, reader, modes that have the option
static const program_option own_options[] = {
    {"model", 'm', "MODEL", "Reduced model (.h5 or .ehdrom), or a list of models for parts of a region (.yml): each scene is "
     "solved by the model whose trained range contains it", OPTION_TEXT(model)},
    {"pressure-modes", 0, "N", "Use only the first N pressure modes",
     OPTION_COUNT(sizes.of[0].pressure_modes, 1, 100000), .modes = SCENE | CASES | EXPORT | FMU},
    {"deformation-modes", 0, "N", "Use only the first N deformation modes",
     OPTION_COUNT(sizes.of[0].deformation_modes, 1, 100000), .modes = SCENE | CASES | EXPORT | FMU},
    {"rows", 0, "N", "Use only the first N selected equations",
     OPTION_COUNT(sizes.of[0].rows, 1, 10000000), .modes = SCENE | CASES | EXPORT | FMU},
    {"accuracy", 0, "X", "Use the fastest model size whose measured film errors are at most X, such as 1e-3, on most scenes. "
     "Exit with 4 if the estimated error exceeds X (without this option: 0.01). An FMU keeps its size and judges its steps by X",
     OPTION_REAL(accuracy, 1e-15, 1), .modes = SCENE | CASES | FMU},
    {"accuracy-of", 0, "NAME=X", "Exit with 4 if the estimated error of a quantity exceeds X: central_pressure, exit_position, "
     "load, pressure, film_thickness, friction or rolling_resistance; repeatable (stationary)",
     OPTION_READ(limits, accuracy_read_limit), .modes = SCENE | CASES},
    {"against", 0, "RESULT.h5", "Print the deviations from another result of the scene", OPTION_TEXT(against), .modes = SCENE},
    {"verify", 0, NULL, "Print the residual of the full model at the solution, and the change of the central film by one full "
     "Newton step (stationary)", OPTION_FLAG(verify), .modes = SCENE},
    {"fallback", 0, "full|none", "full: if the result is not accurate enough, the full model continues from it, and the exit "
     "code is 0. Default: none", OPTION_TEXT(fall_back), .modes = SCENE},
    {"allow-untrusted", 0, NULL, "Exit with 0 instead of 4 if the scene is outside the trained range, an error exceeds its limit "
     "or the model size was never checked", OPTION_FLAG(allow_untrusted), .modes = SCENE | CASES},
    {"repeat", 0, "N", "Solve N times and report the median time; default 1 (stationary)",
     OPTION_COUNT(repeats, 1, 1000000), .modes = SCENE},
    {"resume", 0, NULL, "Continue an interrupted run of the same inputs, if there is one (transient scenes, tables)",
     OPTION_FLAG(resume), .modes = SCENE | CASES},
    {"jobs", 'j', "N", "Solve N scenes at a time; default: the number of processors",
     OPTION_COUNT(num_jobs, 1, 4096), .modes = CASES | CALIBRATE},
    {"fmi", 0, "N", "Version of the FMI standard, 2 or 3; default 3", OPTION_COUNT(fmi, 2, 3), .modes = FMU},
    {0}};
// clang-format on

static void print_settings(void) {
    scene_print_help(stdout);
}

// ---- the solution

static int compare_seconds(const void *a, const void *b) {
    const double p = ((const online_result *)a)->seconds.total;
    const double q = ((const online_result *)b)->seconds.total;

    return (p > q) - (p < q);
}

/* Solves `repeats` times; *result is the run with the median time. */
static ehd_status solve(online_result *result, online_solver *solver, const ehd_contact *contact,
                        size_t repeats, ehd_error *error) {
    online_result *runs = calloc(repeats, sizeof *runs);
    ehd_status status = runs ? EHD_OK : ehd_no_memory(error, "--repeat");

    for (size_t i = 0; i < repeats && !status; i++)
        status = program_interrupted()
                     ? ehd_fail(error, EHD_INTERRUPTED, "--repeat: interrupted after %zu", i)
                     : online_solve(&runs[i], solver, contact, error);
    if (!status) {
        qsort(runs, repeats, sizeof *runs, compare_seconds);
        *result = runs[repeats / 2];
    }
    free(runs);
    return status;
}

static bool falls_back(const romrun_options *options) {
    return options->fall_back && strcmp(options->fall_back, "full") == 0;
}

/* Returns a text about options that help if a result is not trusted. */
static const char *advice(const run_result *result, const romrun_options *options) {
    if (result &&
        strcmp(result->reason, impossible_friction) == 0) // the full model has the same friction
        return " (--allow-untrusted takes it all the same)";
    return falls_back(options) ? ""
                               : " (--fallback full has the full model solve it, --allow-untrusted "
                                 "takes it all the same)";
}

/* Returns the exit code for a result and writes the message to *error. */
static ehd_status judge(const run_result *result, const romrun_options *options, const char *path,
                        ehd_error *error) {
    if (result->status == EHD_UNTRUSTED && options->allow_untrusted) return EHD_OK;
    if (result->status)
        return ehd_fail(error, result->status, "%s: found %s, expected %s%s", path, result->reason,
                        result->status == EHD_UNTRUSTED ? "a result to be trusted" : "convergence",
                        result->status == EHD_UNTRUSTED ? advice(result, options) : "");
    return EHD_OK;
}

enum { MAX_INPUTS = MAX_PARTS + 4 };

/* Adds the file of the model, or the list of models and the files in it, to the inputs. Returns the
 * new number of inputs. */
static size_t add_models(const char *inputs[MAX_INPUTS], size_t count,
                         const romrun_options *options) {
    count = inputs_add(inputs, count, options->model);
    for (size_t i = 0; i < options->models.num; i++)
        count = inputs_add(inputs, count, options->models.paths[i]);
    return count;
}

/* Lists the files that no output may overwrite: the arguments, the models and, if there is one, the
 * file `other`. The list ends with NULL. */
static void list_inputs(const char *inputs[MAX_INPUTS], const program *self,
                        const romrun_options *options, const char *other) {
    size_t count = 0;

    for (size_t i = 0; i < self->num_arguments; i++)
        count = inputs_add(inputs, count, self->arguments[i]);
    count = add_models(inputs, count, options);
    inputs[inputs_add(inputs, count, other)] = NULL;
}

/* Prints the full model's residual and Newton step at the reduced solution. */
static ehd_status print_verification(online_solver *solver, const online_result *solution,
                                     const ehd_contact *contact, ehd_error *error) {
    verification found;
    ehd_status status = verify(&found, solver, solution, contact, error);
    if (status) return status;

    printf("%-24s%.1e (fullrun: below %.0e), %.3g ms\n", "full residual", found.residual,
           found.tolerance, found.residual_seconds * 1e3);
    if (isfinite(found.film_change))
        printf("%-24s%+.2e of the central film thickness, %.3g ms\n", "a full Newton step",
               found.film_change, found.step_seconds * 1e3);
    return EHD_OK;
}

/* Makes a text of the scene's settings and of the options that change the solution. For a table of
 * scenes the text also contains the limits of --accuracy-of, because the rows of the table depend
 * on these limits. */
static ehd_status text_with_sizes(char **whole, const char *text, const romrun_options *options,
                                  bool table, ehd_error *error) {
    char accuracy[NUMBER_TEXT + 16] = "", number[NUMBER_TEXT];
    size_t size;
    FILE *stream = open_memstream(whole, &size);

    if (options->accuracy > 0) {
        number_show(number, options->accuracy);
        snprintf(accuracy, sizeof accuracy, ", accuracy %s", number);
    }
    if (!stream) *whole = NULL;
    if (stream) fputs(text, stream);
    for (size_t i = 0; i < options->models.num && stream; i++) {
        const model_sizes *sizes = &options->sizes.of[i];
        fprintf(stream, "# %zu pressure modes, %zu deformation modes, %zu rows (0: all)%s%s\n",
                sizes->pressure_modes, sizes->deformation_modes, sizes->rows, accuracy,
                falls_back(options) ? ", fallback full" : "");
    }
    if (stream && table) accuracy_write_limits(&options->limits, stream);
    if (stream && !fclose(stream)) return EHD_OK;
    free(*whole);
    *whole = NULL;
    return ehd_no_memory(error, "settings");
}

/* A solution, with the model and the solver that computed it. */
typedef struct attempt {
    online_model *model;
    online_solver *solver;
    online_result solution;
    online_indications others;
    double first_seconds; // time of an earlier attempt with another model size
} attempt;

static void attempt_free(attempt *self) {
    online_solver_free(self->solver);
    online_close(self->model);
    *self = (attempt){0};
}

static ehd_status attempt_solve(attempt *self, const romrun_options *options,
                                const ehd_contact *contact, ehd_error *error) {
    ehd_status status = online_solver_create(&self->solver, self->model, error);

    if (!status && options->accuracy > 0)
        online_solver_set_tolerance(self->solver, accuracy_tolerance(options->accuracy));
    return status ? status : online_solve(&self->solution, self->solver, contact, error);
}

/* Solves with the open model, which has the sizes options->sizes. If the result is not accurate
 * enough, solves again with the fallback sizes and sets options->sizes to these sizes. */
static ehd_status solve_scene(attempt *self, romrun_options *options, const program *caller,
                              const ehd_contact *contact, ehd_error *error) {
    ehd_status status = attempt_solve(self, options, contact, error);
    const model_sizes *first_sizes = &options->sizes.of[self->solution.part];
    const model_sizes *best_sizes = &options->fallback.of[self->solution.part];
    if (status || best_sizes->pressure_modes == 0) return status;
    run_result result = reduced_result(&self->solution);
    accuracy_judge(&result, options->accuracy);
    if (!result.status && accuracy_limits_any(&options->limits)) {
        self->others = online_indicate(self->solver, contact);
        result.indicated = self->others.deviation;
        accuracy_judge_others(&result, &options->limits);
    }
    if (memcmp(first_sizes, best_sizes, sizeof *best_sizes) == 0) return EHD_OK;
    if (!result.status)
        accuracy_judge_peak(&result, options->accuracy, online_indicate_peak(self->solver));
    if (!result.status) return EHD_OK;

    const double first = self->solution.seconds.total;
    char name[TRADE_NAME];
    trade_name(name, best_sizes);
    program_note(caller, "--accuracy %g: found %s, again with %s", options->accuracy, result.reason,
                 name);
    options->sizes = options->fallback;
    attempt_free(self);
    status = online_open(&self->model, options->model, &options->sizes, error);
    if (!status) status = attempt_solve(self, options, contact, error);
    self->first_seconds = first;
    return status;
}

/* Data of a stationary scene that is being solved. */
typedef struct stationary_run {
    const program *caller;
    romrun_options *options;
    const ehd_contact *contact;
    stored_result against; // stored result that --against names
    attempt attempt;
    fallback full; // zero unless the full model solves the scene
    bool by_full_model;
    double *pressure, *film;   // [nodes of the grid], NULL unless fields or traction need them
    double *exits;             // [inner lines of the whole grid]
    film_effects effects;      // errors that the model's grid causes
    contact_traction traction; // set if the surfaces slide
    run_result result;         // points to the members above
    char *text;                // text of the settings
} stationary_run;

static void stationary_run_free(stationary_run *self) {
    result_free(&self->against);
    attempt_free(&self->attempt);
    fallback_free(&self->full);
    free(self->pressure);
    free(self->film);
    free(self->exits);
    free(self->text);
}

static ehd_status read_against(stationary_run *self, bool with_fields, ehd_error *error) {
    const char *path = self->options->against;
    stored_result *against = &self->against;
    if (!path) return EHD_OK;
    ehd_status status = result_read(against, path, self->contact->kind, with_fields, error);
    if (status) return status;

    const ehd_grid grid = result_grid(against);
    return against_check(against->moes_M, against->alpha_p_H, against->hertz_pressure,
                         against->thinning, &grid, path, self->contact, error);
}

/* Fills self->result from the solution and its exits. If wanted, adds the fields and the errors
 * that the model's grid causes. */
static ehd_status fill_result(stationary_run *self, bool with_fields, bool with_effects,
                              ehd_error *error) {
    const ehd_grid *grid = &self->contact->grid;
    attempt *done = &self->attempt;
    ehd_status status = EHD_OK;

    done->solution.seconds.total += done->first_seconds;
    self->exits = malloc(grid_whole(grid).inner_lines * sizeof(double));
    if (!self->exits) return ehd_no_memory(error, "exits");
    online_exits(self->exits, done->solver);
    const bool with_traction = contact_has_traction(self->contact);
    const bool few_nodes = with_traction && online_has_traction(done->model);
    if (with_fields || (with_traction && !few_nodes)) {
        self->pressure = malloc(grid->num_nodes * sizeof(double));
        self->film = malloc(grid->num_nodes * sizeof(double));
        status = online_prepare_fields(done->model, error);
        if (!status && !(self->pressure && self->film)) status = ehd_no_memory(error, "fields");
        if (!status) status = online_fields(self->pressure, self->film, done->solver, error);
        if (!status)
            online_judge_pressure(&done->solution, self->contact, self->pressure, grid->num_nodes);
    }
    self->result = reduced_result(&done->solution);
    self->result.pressure = with_fields ? self->pressure : NULL;
    self->result.film = with_fields ? self->film : NULL;
    if (!status && with_traction) {
        self->traction = few_nodes ? online_traction(done->solver, self->contact)
                                   : contact_traction_of(self->contact, self->pressure, self->film,
                                                         &done->solution.scalars);
        self->result.traction = &self->traction;
    }
    self->result.exits = self->exits;
    if (with_effects) {
        self->effects = online_effects(done->model, self->contact);
        self->result.effects = &self->effects;
    }
    done->others = online_indicate(done->solver, self->contact);
    self->result.indicated = done->others.deviation;
    const online_properties model = online_describe(done->model);
    const char *unchecked = online_unchecked(&model, false);
    reduced_result_judge(&self->result, unchecked, self->options->accuracy, &self->options->limits);
    if (unchecked && self->options->allow_untrusted)
        program_note(self->caller, "%s: found %s", self->options->model, unchecked);
    return status;
}

/* Solves with the full model if the reduced result is not good enough, and prints a note. */
static ehd_status fall_back(stationary_run *self, bool with_fields, bool with_effects,
                            ehd_error *error) {
    const romrun_options *options = self->options;
    const ehd_contact *contact = self->contact;
    const char *path = self->caller->arguments[0];
    const run_result reduced = self->result;
    fallback *full = &self->full;
    full_resolution resolution;
    ehd_status status = EHD_OK;

    if (!reduced.status) return EHD_OK;
    status =
        grid_check_memory(self->caller, path, contact, full_solver_bytes(&contact->grid), 1, error);
    if (!status) status = online_prepare_fields(self->attempt.model, error);
    if (!status)
        status = fallback_solve(full, self->attempt.solver, &self->attempt.solution, contact,
                                options->repeats, error);
    if (status) return status;
    program_note(self->caller,
                 "--fallback full: found %s: solved by the full model, %s, %zu iterations, %.3g ms",
                 reduced.reason, full->from_reduced ? "from the reduced solution" : "cold",
                 full->info.newton_iterations, full->info.seconds.total * 1e3);
    self->by_full_model = true;
    self->result = fallback_result(full, contact, with_fields);
    self->result.solved_by = SOLVED_BY_FULL;
    self->result.seconds.exit = 0; // the full model does not measure the time for the exit
    solve_seconds_add(&self->result.seconds, &reduced.seconds);
    if (reduced.traction) {
        self->traction = full_evaluate_traction(&full->state, contact);
        self->result.traction = &self->traction;
    }
    if (!with_effects || self->result.status) return EHD_OK;
    status = full_resolution_estimate(&resolution, &full->state, contact, NULL, error);
    if (status) return status;
    self->effects = resolution.effects;
    self->result.effects = &self->effects;
    accuracy_judge_rolling(&self->result, &options->limits);
    return EHD_OK;
}

static ehd_status show(const stationary_run *self, ehd_error *error) {
    const romrun_options *options = self->options;
    const attempt *done = &self->attempt;
    ehd_status status = EHD_OK;

    if (self->result.status == EHD_NOT_CONVERGED) return EHD_OK;
    result_print(&self->result, self->contact);
    if (self->result.traction) traction_warn(self->caller, self->result.traction->friction);
    if (options->models.num > 1 && !self->by_full_model)
        printf("%-24s%s\n", "solved by", online_part_path(done->model, done->solution.part));
    if (self->by_full_model)
        printf("%-24sthe full model, %s, in %.3g ms of these\n", "solved by",
               self->full.from_reduced ? "from the reduced solution" : "cold",
               self->full.info.seconds.total * 1e3);
    if (options->verify) status = online_prepare_fields(done->model, error);
    if (!status && options->verify)
        status = print_verification(done->solver, &done->solution, self->contact, error);
    if (!status && options->against)
        against_print(&self->result, &self->against, options->against, self->contact);
    return status;
}

static ehd_status solve_and_show(stationary_run *self, const char *scene_lines, const scene *given,
                                 ehd_error *error) {
    const bool with_fields = given->output.fields == 1;
    const program *caller = self->caller;
    romrun_options *options = self->options;
    const bool with_effects = given->output.resolution != 0 || options->limits.rolling > 0;
    const char *inputs[MAX_INPUTS];
    attempt *done = &self->attempt;
    artefact *file = NULL;
    ehd_status status = read_against(self, with_fields, error);

    list_inputs(inputs, caller, options, options->against);
    if (!status) status = solve_scene(done, options, caller, self->contact, error);
    if (!status) status = text_with_sizes(&self->text, scene_lines, options, false, error);
    if (!status && caller->output)
        status = result_create(&file, caller, self->contact, self->text, inputs, error);
    if (!status && options->repeats > 1)
        status = solve(&done->solution, done->solver, self->contact, options->repeats, error);
    if (!status) status = fill_result(self, with_fields, with_effects, error);
    if (!status && falls_back(options)) {
        self->result.solved_by = SOLVED_BY_REDUCED;
        status = fall_back(self, with_fields, with_effects, error);
    }
    if (!status) result_judge(&self->result, &self->contact->grid);
    if (!status && file) status = result_write(&file, &self->result, self->contact, error);
    if (!status) status = show(self, error);
    if (!status) status = judge(&self->result, options, caller->arguments[0], error);
    artefact_close(&file);
    return status;
}

/* Solves a stationary scene and closes the model. */
static ehd_status run_stationary(const program *caller, romrun_options *options,
                                 online_model *model, const ehd_contact *contact,
                                 const scene *given, const char *scene_lines, ehd_error *error) {
    stationary_run self = {
        .caller = caller, .options = options, .contact = contact, .attempt = {.model = model}};
    ehd_status status = solve_and_show(&self, scene_lines, given, error);

    stationary_run_free(&self);
    return status;
}

// ---- transient scenes

/* Creates a march with both models, if --fallback full is given. */
static ehd_status create_fallback(fallback_march **full, const program *self,
                                  const romrun_options *options, const ehd_contact *contact,
                                  online_transient *in_time, const scene *given,
                                  const char *distrust, ehd_error *error) {
    if (!falls_back(options)) return EHD_OK;
    const double accuracy = accuracy_limit(options->accuracy);
    ehd_status status =
        grid_check_memory(self, self->arguments[0], contact, full_march_bytes(contact), 1, error);

    return status ? status
                  : fallback_march_create(full, online_march(in_time).self,
                                          given->transient.start_film, accuracy, distrust, error);
}

/* Solves a transient scene and closes the model. */
static ehd_status run_transient(const program *self, const romrun_options *options,
                                online_model *model, const ehd_contact *contact, const scene *given,
                                const char *scene_lines, time_run_again again, ehd_error *error) {
    online_transient *in_time = NULL;
    fallback_march *mixed = NULL;
    time_series full = {0};
    time_trace trace = {0};
    const char *unchecked = NULL;
    const char *models[MAX_INPUTS];
    char *text = NULL;
    ehd_status status = text_with_sizes(&text, scene_lines, options, false, error);

    models[add_models(models, 0, options)] = NULL;

    if (!status) status = online_prepare_transient(model, error);
    if (!status) status = online_transient_create(&in_time, model, contact, error);
    if (!status) {
        const online_properties properties = online_describe(model);
        if (isnan(given->transient.fixed_step))
            online_transient_set_tolerance(in_time, given->transient.tolerance);
        unchecked = online_unchecked(&properties, true);
        status = create_fallback(&mixed, self, options, contact, in_time, given,
                                 options->distrust ? options->distrust : unchecked, error);
    }
    if (!status && options->against) {
        status = time_series_read(&full, options->against, contact->kind, error);
        if (!status)
            status = against_check(full.moes_M, full.alpha_p_H, full.hertz_pressure, full.thinning,
                                   &full.grid, options->against, contact, error);
    }
    if (!status) {
        const time_run_task task = {.caller = self,
                                    .given = given,
                                    .reference = contact,
                                    .settings_text = text,
                                    .models = models,
                                    .input = options->against,
                                    .solver = mixed ? fallback_march_solver(mixed)
                                                    : online_march(in_time),
                                    .accuracy = accuracy_limit(options->accuracy),
                                    .with_fields = given->output.fields == 1,
                                    .resume = options->resume,
                                    .again = again,
                                    .allow_untrusted = options->allow_untrusted,
                                    .advice = again == AGAIN_IF_POOR ? NULL : advice(NULL, options),
                                    .untrusted = mixed ? NULL : unchecked,
                                    .share = mixed ? fallback_march_share : NULL};
        status = time_run(options->against ? &trace : NULL, &task, error);
    }
    if ((!status || (status == EHD_UNTRUSTED && again != AGAIN_IF_POOR)) && options->against) {
        ehd_status compared =
            against_print_in_time(&trace, &full, options->against, &contact->grid, error);
        if (compared) status = compared;
    }
    time_trace_free(&trace);
    time_series_free(&full);
    fallback_march_free(mixed);
    online_transient_free(in_time);
    online_close(model);
    free(text);
    return status;
}

/* Parameters of run_transient, for running it again. */
typedef struct transient_run {
    const program *caller;
    romrun_options *options;
    const ehd_contact *contact;
    const scene *given;
    const char *scene_lines;
} transient_run;

/* Opens the model with the given sizes and runs a march. */
static ehd_status march_with(const transient_run *self, const part_sizes *sizes,
                             time_run_again again, ehd_error *error) {
    romrun_options options = *self->options;
    online_model *model = NULL;

    options.sizes = *sizes;
    ehd_status status = online_open(&model, options.model, sizes, error);
    return status ? status
                  : run_transient(self->caller, &options, model, self->contact, self->given,
                                  self->scene_lines, again, error);
}

/* Checks whether a march may be repeated with more accurate sizes. With --fallback full a march is
 * not repeated, because the full model solves single steps instead. */
static bool has_other_sizes(const romrun_options *options) {
    return options->accuracy > 0 && !falls_back(options) &&
           memcmp(&options->sizes, &options->fallback, sizeof options->sizes) != 0;
}

/* Repeats a march with the most accurate sizes if the first march did not converge or is not
 * trusted. If the repetition does not converge although the first march did, repeats the march with
 * the first sizes. With --resume, EHD_DATA may mean that the interrupted run already was a
 * repetition; this repetition is then continued with the most accurate sizes. */
static ehd_status march_again(const transient_run *self, ehd_status first, ehd_error *error) {
    romrun_options *options = self->options;
    const bool poor = first == EHD_NOT_CONVERGED || first == EHD_UNTRUSTED;
    char name[TRADE_NAME];

    if (!has_other_sizes(options) || !(poor || (first == EHD_DATA && options->resume)))
        return first;
    if (poor) {
        trade_name(name, &options->fallback.of[0]);
        program_note(self->caller, "--accuracy %g: %s, again with %s", options->accuracy,
                     error->text, options->models.num == 1 ? name : "the most accurate sizes");
        options->resume = false;
    }
    const ehd_status second = march_with(
        self, &options->fallback, first == EHD_UNTRUSTED ? AGAIN_IF_LOST : AGAIN_NEVER, error);
    if (second != EHD_NOT_CONVERGED || first != EHD_UNTRUSTED) return second;
    program_note(self->caller, "--accuracy %g: %s, again with the first sizes", options->accuracy,
                 error->text);
    return march_with(self, &options->sizes, AGAIN_NEVER, error);
}

/* Chooses the sizes of one model for --accuracy from its table of measured errors. */
static ehd_status choose_sizes_of(romrun_options *options, size_t index, const program *self,
                                  bool in_time, ehd_error *error) {
    const char *path = options->models.paths[index];
    const bool one = options->models.num == 1;
    trade_table table;
    accuracy_choice choice = {0};
    ehd_status status = trade_read(&table, path, error);

    if (!status) status = accuracy_choose(&choice, &table, options->accuracy, in_time, path, error);
    if (!status) {
        options->sizes.of[index] = choice.fastest;
        options->fallback.of[index] = choice.most_accurate;
        program_note(self, "--accuracy %g: %s%s%s", options->accuracy, one ? "" : path,
                     one ? "" : ": ", choice.note);
    }
    // With --fallback full the run continues: a single scene may reach an accuracy that no size
    // reaches in the calibration. Otherwise the full model solves the scene.
    if (status == EHD_DATA && falls_back(options)) {
        if (in_time) options->distrust = "an --accuracy that the model was not measured to have";
        const size_t best = trade_most_accurate(&table, in_time);
        if (best < table.num_positions)
            options->sizes.of[index] = options->fallback.of[index] = table.positions[best].sizes;
        program_note(self, "%s; --fallback full goes on", error->text);
        status = EHD_OK;
    }
    trade_free(&table);
    return status;
}

static ehd_status choose_sizes(romrun_options *options, const program *self, bool in_time,
                               ehd_error *error) {
    ehd_status status = EHD_OK;

    for (size_t i = 0; i < options->models.num && !status; i++)
        status = choose_sizes_of(options, i, self, in_time, error);
    return status;
}

/* Refuses values and combinations of options that the tables `own_options` and `modes` do not
 * exclude. */
static ehd_status check_usage(const program *self, const romrun_options *options,
                              ehd_error *error) {
    const model_sizes *sizes = &options->sizes.of[0];
    const bool sized = sizes->pressure_modes || sizes->deformation_modes || sizes->rows;
    const bool calibrates = 1u << self->mode == CALIBRATE, fmu = 1u << self->mode == FMU;

    if (part_list_is(options->model) && (sized || calibrates))
        return ehd_fail(error, EHD_USAGE, "%s: found a list of models with %s, expected one model",
                        options->model,
                        sized ? "--pressure-modes, --deformation-modes or --rows"
                              : "romrun calibrate");
    if (options->accuracy > 0 && sized && !fmu)
        return ehd_fail(error, EHD_USAGE,
                        "--accuracy: found with --pressure-modes, --deformation-modes or --rows, "
                        "expected one or the other");
    if (options->fall_back && !falls_back(options) && strcmp(options->fall_back, "none") != 0)
        return ehd_fail(error, EHD_USAGE, "--fallback: found %s, expected full or none",
                        options->fall_back);
    if (falls_back(options) && options->allow_untrusted)
        return ehd_fail(error, EHD_USAGE,
                        "--fallback: found full with --allow-untrusted, expected one of them");
    if (options->resume && !self->output)
        return ehd_fail(
            error, EHD_USAGE,
            "--resume: found without --output, expected the one of the interrupted run");
    return EHD_OK;
}

// ---- modes that do not solve scenes

static ehd_status calibrate_model(const program *self, void *own, ehd_error *error) {
    const romrun_options *options = own;

    return calibrate(self, self->arguments[0], options->model,
                     options->num_jobs ? options->num_jobs : pool_default_workers(), error);
}

static ehd_status print_trade(const program *self, void *own, ehd_error *error) {
    const part_list *models = &((const romrun_options *)own)->models;
    trade_table table;
    ehd_status status = EHD_OK;
    (void)self;

    for (size_t i = 0; i < models->num && !status; i++) {
        status = trade_read(&table, models->paths[i], error);
        if (status) break;
        if (models->num > 1) printf("%s%s\n", i > 0 ? "\n" : "", models->paths[i]);
        trade_print(&table, stdout);
        trade_free(&table);
    }
    return status;
}

static ehd_status export_model(const program *self, void *own, ehd_error *error) {
    const romrun_options *options = own;
    const char *inputs[MAX_INPUTS];
    online_model *model = NULL;
    list_inputs(inputs, self, options, NULL);
    ehd_status status = output_file_check_inputs(self->output, inputs, error);

    if (!status) status = online_open(&model, options->model, &options->sizes, error);
    if (!status) status = online_export(model, self->output, self->force, error);
    online_close(model);
    return status;
}

/* Refuses options that the scene's regime does not have. */
static ehd_status check_regime(const romrun_options *options, bool transient, ehd_error *error) {
    const struct {
        const char *name;
        bool given, in_time;
    } found[] = {{"resume", options->resume, true},
                 {"accuracy-of", accuracy_limits_any(&options->limits), false},
                 {"verify", options->verify, false},
                 {"repeat", options->repeats > 1, false}};

    for (size_t i = 0; i < sizeof found / sizeof *found; i++)
        if (found[i].given && found[i].in_time != transient)
            return ehd_fail(error, EHD_USAGE, "--%s: found with a %s scene, expected a %s one",
                            found[i].name, transient ? "transient" : "stationary",
                            transient ? "stationary" : "transient");
    return EHD_OK;
}

/* Prints a note if a model file has no digest, because a change of the file can then not be
 * detected. Files that other programs or older versions have written have no digest. */
static void note_content(const program *self, const char *model) {
    bool is_flat = true;
    if (online_is_flat(&is_flat, model, NULL) || is_flat ||
        artefact_content(model) != content_without_digest)
        return;
    program_note(self, "%s: found %s of its content, so that a change of it would not be noticed",
                 model, content_without_digest);
}

/* Reads a scene and its text. Refuses a scene that reduced models cannot solve. */
static ehd_status load_scene(scene *given, char **text, const program *self, ehd_error *error) {
    ehd_error cause = {""};
    ehd_status status = scene_load(given, text, self, error);

    if (status) return status;
    status = scene_check_reducible(given, &cause);
    return status ? ehd_fail(error, status, "%s: %s", self->arguments[0], cause.text) : EHD_OK;
}

static ehd_status export_fmu(const program *self, void *own, ehd_error *error) {
    const romrun_options *options = own;
    online_model *model = NULL;
    ehd_error cause = {""};
    ehd_contact contact;
    scene given;
    char *scene_lines = NULL;
    const char *inputs[MAX_INPUTS];
    list_inputs(inputs, self, options, NULL);
    ehd_status status = output_file_check_inputs(self->output, inputs, error);
    if (!status) status = load_scene(&given, &scene_lines, self, error);
    if (!status) status = online_open(&model, options->model, &options->sizes, error);
    if (!status && online_check_in_time(model, &cause))
        status = ehd_fail(error, EHD_DATA, "%s: %s", options->model, cause.text);
    if (!status)
        status = contact_load(&contact, &given, self, online_kind(model), options->model, error);
    online_close(model);
    const fmu_request request = {.model = options->model,
                                 .sizes = &options->sizes,
                                 .given = &given,
                                 .accuracy =
                                     options->accuracy > 0 ? options->accuracy : default_accuracy,
                                 .fmi = (int)options->fmi};

    if (!status) status = fmu_export(self, &request, error);
    free(scene_lines);
    return status;
}

/* Checks a flat model or a list of models. Each HDF5 model of a list is checked like a single file.
 * A flat model is only opened, since opening it reads and checks the whole file. Opening the list
 * also checks whether its models fit together. */
static ehd_status check_models(const char *path, ehd_error *error) {
    online_model *model = NULL;
    part_list list;
    ehd_status status = part_list_read(&list, path, error);

    for (size_t i = 0; i < list.num && !status; i++) {
        bool is_flat = false;
        status = online_is_flat(&is_flat, list.paths[i], error);
        if (!status && !is_flat) status = output_check(list.paths[i], model_readers, error);
    }
    if (!status) status = online_open(&model, path, NULL, error);
    online_close(model);
    part_list_free(&list);
    return status;
}

/* Checks a file for --check. */
static ehd_status check(const char *path, ehd_error *error) {
    bool is_flat = false;
    const ehd_status status = online_is_flat(&is_flat, path, error);

    if (status) return status;
    return is_flat || part_list_is(path) ? check_models(path, error)
                                         : output_check(path, model_readers, error);
}

// ---- many scenes

/* Returns the exit code of the worst scene and writes the message to *error. */
static ehd_status judge_cases(const cases_summary *found, const romrun_options *options,
                              const case_list *list, ehd_error *error) {
    const bool unsolved = found->num_unsolved > 0;

    if (!unsolved && (found->num_untrusted == 0 || options->allow_untrusted)) return EHD_OK;
    ehd_fail(error, EHD_NOT_CONVERGED,
             "scenes: %zu, not converged: %zu, not to be trusted: %zu; this is the first that %s",
             found->num_cases, found->num_unsolved, found->num_untrusted,
             unsolved ? "did not converge" : "is not to be trusted");
    case_list_fail(list, found->first, error);
    return unsolved ? EHD_NOT_CONVERGED : EHD_UNTRUSTED;
}

static void show_cases(const cases_summary *found, const program *self) {
    const size_t count = found->num_cases, bad = found->num_unsolved + found->num_untrusted;

    if (!self->output) return; // the table goes to stdout
    printf("%-24s%zu: %zu good, %zu not to be trusted, %zu not converged\n", "cases", count,
           count - bad, found->num_untrusted, found->num_unsolved);
    if (found->num_solved > 0)
        printf("%-24s%.4g s, %.3g ms a case\n", "solution", found->seconds,
               found->seconds * 1e3 / (double)found->num_solved);
}

static ehd_status solve_cases(case_list *list, const program *self, const romrun_options *options,
                              const char *const *inputs, ehd_error *error) {
    char *scene_lines = case_list_settings(list), *text = NULL;
    cases_summary found;
    ehd_status status = scene_lines ? text_with_sizes(&text, scene_lines, options, true, error)
                                    : ehd_no_memory(error, self->arguments[1]);
    const cases_task task = {.caller = self,
                             .model = options->model,
                             .sizes = options->sizes,
                             .most_accurate = options->fallback,
                             .accuracy = options->accuracy,
                             .limits = &options->limits,
                             .num_jobs =
                                 options->num_jobs ? options->num_jobs : pool_default_workers(),
                             .settings_text = text,
                             .inputs = inputs,
                             .resume = options->resume};

    if (!status) status = cases_solve(&found, list, &task, error);
    if (!status) show_cases(&found, self);
    if (!status) traction_warn(self, found.max_friction);
    if (!status) status = judge_cases(&found, options, list, error);
    free(scene_lines);
    free(text);
    return status;
}

static ehd_status run_cases(const program *self, void *own, ehd_error *error) {
    romrun_options *options = own;
    case_list *list = NULL;
    const char *inputs[MAX_INPUTS];
    ehd_status status = case_table_check(self, error);

    list_inputs(inputs, self, options, NULL);
    if (!status && self->output) status = output_file_check_inputs(self->output, inputs, error);
    if (!status)
        status = case_list_open(&list, self->arguments[0], self->arguments[1], self->overrides,
                                self->num_overrides, error);
    if (!status && options->accuracy > 0) status = choose_sizes(options, self, false, error);
    if (!status) status = solve_cases(list, self, options, inputs, error);
    case_list_free(list);
    return status;
}

static ehd_status run_scene(const program *self, void *own, ehd_error *error) {
    romrun_options *options = own;
    online_model *model = NULL;
    ehd_contact contact;
    scene given;
    char *scene_lines = NULL;
    ehd_status status = load_scene(&given, &scene_lines, self, error);
    bool transient = !status && strcmp(given.regime, "transient") == 0;

    if (!status) status = check_regime(options, transient, error);
    if (!status && options->accuracy > 0) status = choose_sizes(options, self, transient, error);
    if (!status) status = online_open(&model, options->model, &options->sizes, error);
    if (!status)
        status = contact_load(&contact, &given, self, online_kind(model), options->model, error);
    if (status) {
        online_close(model);
    } else {
        contact_take_grid(&contact, online_grid_for(model, &contact));
        const transient_run in_time = {self, options, &contact, &given, scene_lines};
        const time_run_again again = has_other_sizes(options) ? AGAIN_IF_POOR : AGAIN_NEVER;
        status =
            transient
                ? run_transient(self, options, model, &contact, &given, scene_lines, again, error)
                : run_stationary(self, options, model, &contact, &given, scene_lines, error);
        if (transient) status = march_again(&in_time, status, error);
    }
    if (!status || status == EHD_NOT_CONVERGED || status == EHD_UNTRUSTED)
        for (size_t i = 0; i < options->models.num; i++)
            note_content(self, options->models.paths[i]);
    free(scene_lines);
    return status;
}

// ---- the command line

// clang-format off
// columns: word; usage; help; least and largest number of arguments; use of -o; whether the hidden
// option with the name of the mode (--cases) takes the last argument; function
static const program_mode modes[] = {
    {NULL, "SCENE.yml -m MODEL.h5 [-o RESULT.h5]", NULL, 1, 1, OUTPUT_OPTIONAL, false, run_scene},
    {"cases", "cases SCENE.yml CASES.csv -m MODEL.h5 [-o TABLE.csv]",
     "Solves one scene for each row of CASES.csv, whose columns are settings.\n"
     "Writes TABLE.csv or TABLE.h5; without -o, CSV to stdout.\n"
     "The exit code is that of the worst scene. Scenes are stationary.", 2, 2, OUTPUT_OPTIONAL, true, run_cases},
    {"calibrate", "calibrate PLAN.yml -m MODEL.h5 -o NEW.h5",
     "Measures errors and times of many model sizes on the scenes of a plan.\n"
     "Writes the model with these numbers. No scene may be a training point.", 1, 1, OUTPUT_NEEDED, true, calibrate_model},
    {"trade", "trade MODEL.h5", "Prints the errors and times of the sizes of a calibrated model.", 0, 1, OUTPUT_NONE, false,
     print_trade},
    {"export", "export MODEL.h5 -o MODEL.ehdrom",
     "Writes a model, or a smaller size of it, as a flat file, which programs and\n"
     "the library read in milliseconds.", 0, 1, OUTPUT_NEEDED, true, export_model},
    {"fmu", "fmu SCENE.yml -m MODEL.h5 -o CONTACT.fmu",
     "Writes the contact of a scene as an FMU for co-simulation in other programs.", 1, 1, OUTPUT_NEEDED, false, export_fmu},
    {0}};
// clang-format on

/* Takes the model from the argument in the modes that have no other argument (trade, export). */
static ehd_status take_model(const program *self, romrun_options *options, ehd_error *error) {
    const bool by_argument = (1u << self->mode & (TRADE | EXPORT)) && self->num_arguments > 0;

    if (by_argument && options->model)
        return ehd_fail(error, EHD_USAGE, "--model: found with %s, expected one of them",
                        self->arguments[0]);
    if (by_argument) options->model = self->arguments[0];
    if (options->model) return EHD_OK;
    return ehd_fail(error, EHD_USAGE, "--model: found none, expected %s %s", self->name,
                    modes[self->mode].usage);
}

/* Runs everything between the command line and the exit code. */
static ehd_status run(const program *self, void *own, ehd_error *error) {
    romrun_options *options = own;
    ehd_status status = take_model(self, options, error);

    if (!status) status = check_usage(self, options, error);
    if (!status) status = part_list_read(&options->models, options->model, error);
    if (!status) status = modes[self->mode].run(self, own, error);
    part_list_free(&options->models);
    return status;
}

int main(int argc, char **argv) {
    romrun_options own = {.repeats = 1, .fmi = 3};
    const program_options options = {
        .options = own_options,
        .own = &own,
        .doc = "Solves one scene with a reduced model.\n"
               "romrun MODE --help shows the options of a mode: romrun cases --help.",
        .help_tail = print_settings,
        .modes = modes};
    return output_main(argc, argv, &options, run, check, model_describe);
}
