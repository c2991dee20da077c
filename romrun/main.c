/* SPDX-License-Identifier: GPL-3.0-or-later */
/* romrun: solves one scene with the reduced model, or measures what the model can do. */
#include "common/output/check.h"
#include "common/output/grid_file.h"
#include "common/output/result.h"
#include "common/output/time_result.h"
#include "common/output/time_run.h"
#include "common/program/program.h"
#include "common/training/pool.h"
#include "romrun/calibrate/accuracy.h"
#include "romrun/calibrate/calibrate.h"
#include "romrun/calibrate/time_compare.h"
#include "romrun/calibrate/verify.h"
#include "romrun/model/trade_file.h"
#include "romrun/online/ehdrom.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    KEY_MODEL = 'm',
    KEY_JOBS = 'j',
    KEY_PRESSURE_MODES = 0x200,
    KEY_DEFORMATION_MODES,
    KEY_ROWS,
    KEY_AGAINST,
    KEY_ALLOW_UNTRUSTED,
    KEY_REPEAT,
    KEY_RESUME,
    KEY_CALIBRATE,
    KEY_TRADE,
    KEY_ACCURACY,
    KEY_VERIFY
};

typedef struct romrun_options {
    const char *model;
    const char *against; // NULL: no comparison
    ehdrom_sizes sizes;
    double accuracy;   // of the central film, to choose the sizes by; 0: not given
    ehdrom_sizes most; // the most accurate sizes, for scenes that those do not do for
    bool allow_untrusted, resume, verify;
    size_t repeats;        // of the solution; its median time is reported
    const char *calibrate; // plan; NULL: none
    bool trade;
    size_t num_jobs; // 0: by itself
} romrun_options;

static const struct argp_option own_options[] = {
    {.name = "model", .key = KEY_MODEL, .arg = "MODEL.h5", .doc = "The reduced model"},
    {.name = "pressure-modes",
     .key = KEY_PRESSURE_MODES,
     .arg = "N",
     .doc = "Use only the first N pressure modes"},
    {.name = "deformation-modes",
     .key = KEY_DEFORMATION_MODES,
     .arg = "N",
     .doc = "Use only the first N deformation modes"},
    {.name = "rows", .key = KEY_ROWS, .arg = "N", .doc = "Use only the first N rows"},
    {.name = "accuracy",
     .key = KEY_ACCURACY,
     .arg = "X",
     .doc = "Use as much of a calibrated model as its central film needs to deviate by at most X, "
            "such as 1e-3, on most scenes, converged to a fiftieth of it; exit with 4 where it is "
            "indicated to deviate by more"},
    {.name = "against",
     .key = KEY_AGAINST,
     .arg = "RESULT.h5",
     .doc = "Print the deviations from another result of the scene"},
    {.name = "verify",
     .key = KEY_VERIFY,
     .doc = "Print the residual of the full model at the solution, and what one Newton step of it "
            "would change of the central film (stationary)"},
    {.name = "allow-untrusted",
     .key = KEY_ALLOW_UNTRUSTED,
     .doc = "Exit with 0 although the scene lies outside of the trained range, or is indicated to "
            "deviate by more than --accuracy"},
    {.name = "repeat",
     .key = KEY_REPEAT,
     .arg = "N",
     .doc = "Solve N times and report the median time; default 1 (stationary)"},
    {.name = "resume",
     .key = KEY_RESUME,
     .doc = "Continue an interrupted run of the same scene, where there is one (transient)"},
    {.name = "calibrate",
     .key = KEY_CALIBRATE,
     .arg = "PLAN.yml",
     .doc = "Measure deviations and time of many sizes of the model on the scenes of a plan, none "
            "of them "
            "trained on, and write the model with the table to -o"},
    {.name = "jobs",
     .key = KEY_JOBS,
     .arg = "N",
     .doc =
         "Full solutions at a time with --calibrate; as many as there are processors by default"},
    {.name = "trade", .key = KEY_TRADE, .doc = "Print the table of a calibrated model"},
    {0}};

static error_t parse_own(int key, char *argument, struct argp_state *state) {
    romrun_options *options = state->input;
    ehd_error error;
    ehd_status status = EHD_OK;

    switch (key) {
    case KEY_MODEL:
        options->model = argument;
        break;
    case KEY_PRESSURE_MODES:
        status = parse_count(&options->sizes.pressure_modes, argument, 1, 100000,
                             "--pressure-modes", EHD_USAGE, &error);
        break;
    case KEY_DEFORMATION_MODES:
        status = parse_count(&options->sizes.deformation_modes, argument, 1, 100000,
                             "--deformation-modes", EHD_USAGE, &error);
        break;
    case KEY_ROWS:
        status =
            parse_count(&options->sizes.rows, argument, 1, 10000000, "--rows", EHD_USAGE, &error);
        break;
    case KEY_ACCURACY:
        status =
            parse_real(&options->accuracy, argument, 1e-15, 1, "--accuracy", EHD_USAGE, &error);
        break;
    case KEY_AGAINST:
        options->against = argument;
        break;
    case KEY_ALLOW_UNTRUSTED:
        options->allow_untrusted = true;
        break;
    case KEY_VERIFY:
        options->verify = true;
        break;
    case KEY_RESUME:
        options->resume = true;
        break;
    case KEY_REPEAT:
        status =
            parse_count(&options->repeats, argument, 1, 1000000, "--repeat", EHD_USAGE, &error);
        break;
    case KEY_CALIBRATE:
        options->calibrate = argument;
        break;
    case KEY_JOBS:
        status = parse_count(&options->num_jobs, argument, 1, 4096, "--jobs", EHD_USAGE, &error);
        break;
    case KEY_TRADE:
        options->trade = true;
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    if (status) argp_error(state, "%s", error.text);
    return status ? EINVAL : 0;
}

static void print_settings(void) {
    puts("Settings of a scene (SCENE.yml, --set):");
    scene_print_help(stdout);
}

// ---- comparison

static void print_deviation(const char *name, double reduced, double full) {
    if (isfinite(full) && full != 0)
        printf("  %-24s %13.8g against %13.8g  %+.4f permille\n", name, reduced, full,
               (reduced / full - 1) * 1e3);
}

/* Largest difference of a field on the nodes of a grid and one on the inner nodes of the whole of it. */
static double field_difference(const double *nodes, const double *inner, const ehd_grid *grid) {
    size_t num_inner = grid_whole(grid).num_inner;
    double largest = 0;

    for (size_t i = 0; i < num_inner; i++) {
        size_t node = grid_node_of_row(grid, grid_row_of_whole(grid, i));
        largest = fmax(largest, fabs(nodes[node] - inner[i]));
    }
    return largest;
}

static ehd_status check_same_scene(double moes_M, double alpha_p_H, double hertz_pressure,
                                   const char *path, const ehd_contact *contact, ehd_error *error) {
    const double slack = 1e-6;

    if (fabs(moes_M - contact->moes_M) <= slack * contact->moes_M &&
        fabs(hertz_pressure - contact->hertz_pressure) <=
            slack * fmax(contact->hertz_pressure, 1) &&
        fabs(alpha_p_H - contact->alpha_p_H) <= slack * fmax(contact->alpha_p_H, 1))
        return EHD_OK;
    return ehd_fail(error, EHD_DATA,
                    "%s: found a result of M = %g, alpha p_H = %g, %.6g GPa, expected the scene's "
                    "M = %g, alpha p_H = %g, %.6g GPa",
                    path, moes_M, alpha_p_H, hertz_pressure * 1e-9, contact->moes_M,
                    contact->alpha_p_H, contact->hertz_pressure * 1e-9);
}

static void compare(const run_result *result, const stored_result *stored, const char *path,
                    const ehd_contact *contact) {
    const ehd_grid *grid = &contact->grid;
    size_t num_inner = grid_whole(grid).num_inner;

    printf("against %s:\n", path);
    print_deviation("central film thickness", result->central_film_thickness,
                    stored->central_film_thickness);
    print_deviation("minimum film thickness", result->minimum_film_thickness,
                    stored->minimum_film_thickness);
    print_deviation("central pressure", result->central_pressure, stored->central_pressure);
    print_deviation("exit position", result->exit_position, stored->exit_position);
    if (result->pressure && stored->pressure && stored->num_inner == num_inner)
        printf("  %-24s %.2e of the Hertz pressure\n", "largest pressure error",
               field_difference(result->pressure, stored->pressure, grid));
    if (result->film && stored->film && stored->num_inner == num_inner)
        printf("  %-24s %.2e\n", "largest film error",
               field_difference(result->film, stored->film, grid));
}

// ---- the solution

static int compare_seconds(const void *a, const void *b) {
    double p = ((const ehdrom_result *)a)->seconds, q = ((const ehdrom_result *)b)->seconds;

    return (p > q) - (p < q);
}

/* Solves as often as wanted; *result is the run of median time. */
static ehd_status solve(ehdrom_result *result, ehdrom_solver *solver, const ehd_contact *contact,
                        size_t repeats, ehd_error *error) {
    ehdrom_result *runs = calloc(repeats, sizeof *runs);
    ehd_status status =
        runs ? EHD_OK : ehd_fail(error, EHD_MEMORY, "--repeat: found no memory for %zu", repeats);

    for (size_t i = 0; i < repeats && !status; i++)
        status = program_interrupted()
                     ? ehd_fail(error, EHD_INTERRUPTED, "--repeat: interrupted after %zu", i)
                     : ehdrom_solve(&runs[i], solver, contact, error);
    if (!status) {
        qsort(runs, repeats, sizeof *runs, compare_seconds);
        *result = runs[repeats / 2];
    }
    free(runs);
    return status;
}

static run_result make_result(const ehdrom_result *solution, const double *pressure,
                              const double *film) {
    run_result result = {.pressure = pressure,
                         .film = film,
                         .central_film_thickness = solution->scalars.central_film_thickness,
                         .minimum_film_thickness = solution->scalars.minimum_film_thickness,
                         .central_pressure = solution->scalars.central_pressure,
                         .rigid_approach = solution->scalars.rigid_approach,
                         .exit_position = solution->scalars.exit_position,
                         .load = solution->scalars.load,
                         .newton_iterations = solution->iterations,
                         .residual = solution->residual,
                         .indicated_deviation = solution->indicated,
                         .status = solution->status,
                         .seconds = solution->seconds,
                         .seconds_rows = solution->seconds_rows,
                         .seconds_linear = solution->seconds_linear,
                         .seconds_exit = solution->seconds_exit};

    snprintf(result.reason, sizeof result.reason, "%s", solution->reason);
    return result;
}

/* The exit code that the outcome asks for, and its line. */
static ehd_status judge(const run_result *result, const romrun_options *options, const char *path,
                        ehd_error *error) {
    if (result->status == EHD_UNTRUSTED && options->allow_untrusted) return EHD_OK;
    if (result->status)
        return ehd_fail(error, result->status, "%s: found %s, expected %s", path, result->reason,
                        result->status == EHD_UNTRUSTED
                            ? "a result to be trusted (--allow-untrusted takes it all the same)"
                            : "convergence");
    return EHD_OK;
}

static ehd_status print_verification(ehdrom_solver *solver, const ehdrom_result *solution,
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

/* The settings of the scene, and what else of the command line the solution depends on. */
static ehd_status text_with_sizes(char **whole, const char *text, const romrun_options *options,
                                  ehd_error *error) {
    const ehdrom_sizes *sizes = &options->sizes;
    char accuracy[NUMBER_TEXT + 16] = "", number[NUMBER_TEXT];

    if (options->accuracy > 0) {
        number_show(number, options->accuracy);
        snprintf(accuracy, sizeof accuracy, ", accuracy %s", number);
    }
    if (asprintf(whole, "%s# %zu pressure modes, %zu deformation modes, %zu rows (0: all)%s\n",
                 text, sizes->pressure_modes, sizes->deformation_modes, sizes->rows, accuracy) >= 0)
        return EHD_OK;
    *whole = NULL;
    return ehd_fail(error, EHD_MEMORY, "settings: found no memory");
}

/* A scene, the part of a model that it is solved with, and its solution. */
typedef struct attempt {
    ehdrom_model *model;
    ehdrom_solver *solver;
    ehdrom_result solution;
    double first_seconds; // of an attempt before that did not do
} attempt;

static void attempt_free(attempt *self) {
    ehdrom_solver_free(self->solver);
    ehdrom_close(self->model);
    *self = (attempt){0};
}

static ehd_status attempt_at(attempt *self, const ehdrom_sizes *sizes,
                             const romrun_options *options, const ehd_contact *contact,
                             ehd_error *error) {
    ehd_status status = ehdrom_open(&self->model, options->model, sizes, error);

    if (!status) status = ehdrom_solver_create(&self->solver, self->model, error);
    if (!status && options->accuracy > 0)
        ehdrom_solver_set_tolerance(self->solver, accuracy_tolerance(options->accuracy));
    return status ? status : ehdrom_solve(&self->solution, self->solver, contact, error);
}

/* With the sizes chosen, and where these do not do for the scene with the most accurate ones, which the
 * options then say. */
static ehd_status solve_scene(attempt *self, romrun_options *options, const program *caller,
                              const ehd_contact *contact, ehd_error *error) {
    ehd_status status = attempt_at(self, &options->sizes, options, contact, error);
    if (status || options->most.pressure_modes == 0) return status;
    run_result result = make_result(&self->solution, NULL, NULL);
    accuracy_judge(&result, options->accuracy);
    if (!result.status || memcmp(&options->sizes, &options->most, sizeof options->most) == 0)
        return EHD_OK;

    const double first = self->solution.seconds;
    char name[TRADE_NAME];
    trade_name(name, &options->most);
    program_note(caller, "--accuracy %g: found %s, again with %s", options->accuracy, result.reason,
                 name);
    options->sizes = options->most;
    attempt_free(self);
    status = attempt_at(self, &options->sizes, options, contact, error);
    self->first_seconds = first;
    return status;
}

static ehd_status run_stationary(const program *self, romrun_options *options,
                                 const ehd_contact *contact, const scene *given,
                                 const char *scene_lines, ehd_error *error) {
    const char *const inputs[] = {self->arguments[0], options->model, options->against, NULL};
    const bool with_fields = given->output_fields == 1;
    attempt done = {0};
    stored_result full = {0};
    artefact *file = NULL;
    double *pressure = NULL, *film = NULL;
    double *exits = malloc(grid_whole(&contact->grid).inner_lines * sizeof *exits);
    char *text = NULL;
    ehd_status status =
        exits ? EHD_OK : ehd_fail(error, EHD_MEMORY, "exits: found no memory for the lines");

    if (!status && options->against) {
        status = result_read(&full, options->against, contact->kind, with_fields, error);
        if (!status)
            status = check_same_scene(full.moes_M, full.alpha_p_H, full.hertz_pressure,
                                      options->against, contact, error);
    }
    if (!status) status = solve_scene(&done, options, self, contact, error);
    if (!status) status = text_with_sizes(&text, scene_lines, options, error);
    if (!status && self->output) status = result_create(&file, self, contact, text, inputs, error);
    if (!status && options->repeats > 1)
        status = solve(&done.solution, done.solver, contact, options->repeats, error);
    done.solution.seconds += done.first_seconds;
    if (!status && with_fields) {
        pressure = malloc(contact->grid.num_nodes * sizeof *pressure);
        film = malloc(contact->grid.num_nodes * sizeof *film);
        status = pressure && film ? ehdrom_fields(pressure, film, done.solver, error)
                                  : ehd_fail(error, EHD_MEMORY, "fields: found no memory");
    }
    if (!status) {
        run_result result = make_result(&done.solution, pressure, film);
        ehdrom_exits(exits, done.solver);
        result.exits = exits;
        if (options->accuracy > 0) accuracy_judge(&result, options->accuracy);
        if (file) status = result_write(&file, &result, contact, error);
        if (!status && result.status != EHD_NOT_CONVERGED) result_print(&result, contact);
        if (!status && options->verify && result.status != EHD_NOT_CONVERGED)
            status = print_verification(done.solver, &done.solution, contact, error);
        if (!status && options->against && result.status != EHD_NOT_CONVERGED)
            compare(&result, &full, options->against, contact);
        if (!status) status = judge(&result, options, self->arguments[0], error);
    }
    artefact_close(&file);
    result_free(&full);
    attempt_free(&done);
    free(pressure);
    free(film);
    free(exits);
    free(text);
    return status;
}

// ---- in time

static ehd_status compare_in_time(const time_trace *trace, const time_series *full,
                                  const char *path, ehd_error *error) {
    const struct {
        const char *name;
        const double *reduced, *full;
    } quantities[] = {
        {"central film thickness", trace->central_film_thickness, full->central_film_thickness},
        {"central pressure", trace->central_pressure, full->central_pressure}};
    ehd_error cause = {""};

    printf("against %s:\n", path);
    for (size_t i = 0; i < sizeof quantities / sizeof *quantities; i++) {
        time_deviation deviation;
        ehd_status status =
            time_compare(&deviation, trace->time, quantities[i].reduced, trace->count, full->time,
                         quantities[i].full, full->num_times, &cause);
        if (status) return ehd_fail(error, status, "%s: %s", path, cause.text);
        printf("  %-24s at most %.3g %% off, at T = %.6g; %.2g %% in the mean\n",
               quantities[i].name, deviation.largest * 100, deviation.at, deviation.mean * 100);
    }
    return EHD_OK;
}

static ehd_status run_transient(const program *self, const romrun_options *options,
                                const ehd_contact *contact, const scene *given,
                                const char *scene_lines, ehd_error *error) {
    ehdrom_model *model = NULL;
    ehdrom_transient *in_time = NULL;
    time_series full = {0};
    time_trace trace = {0};
    char *text = NULL;
    ehd_status status = text_with_sizes(&text, scene_lines, options, error);

    if (!status) status = ehdrom_open(&model, options->model, &options->sizes, error);
    if (!status) status = ehdrom_prepare_transient(model, error);
    if (!status) status = ehdrom_transient_create(&in_time, model, contact, error);
    if (!status && options->against) {
        status = time_series_read(&full, options->against, contact->kind, error);
        if (!status)
            status = check_same_scene(full.moes_M, full.alpha_p_H, full.hertz_pressure,
                                      options->against, contact, error);
    }
    if (!status) {
        const time_run_task task = {.caller = self,
                                    .given = given,
                                    .reference = contact,
                                    .settings_text = text,
                                    .model = options->model,
                                    .against = options->against,
                                    .solver = ehdrom_march(in_time),
                                    .with_fields = given->output_fields == 1,
                                    .resume = options->resume,
                                    .allow_untrusted = options->allow_untrusted,
                                    .effort = ehdrom_march_effort};
        status = time_run(options->against ? &trace : NULL, &task, error);
    }
    if ((!status || status == EHD_UNTRUSTED) && options->against) {
        ehd_status compared = compare_in_time(&trace, &full, options->against, error);
        if (compared) status = compared;
    }
    time_trace_free(&trace);
    time_series_free(&full);
    ehdrom_transient_free(in_time);
    ehdrom_close(model);
    free(text);
    return status;
}

/* By --accuracy, from the table of the calibrated model. */
static ehd_status choose_sizes(romrun_options *options, const program *self, bool in_time,
                               ehd_error *error) {
    trade_table table;
    accuracy_choice choice;
    ehd_status status = trade_read(&table, options->model, error);

    if (!status)
        status =
            accuracy_choose(&choice, &table, options->accuracy, in_time, options->model, error);
    if (!status) {
        options->sizes = choice.fastest;
        options->most = choice.most;
        program_note(self, "--accuracy %g: %s", options->accuracy, choice.note);
    }
    trade_free(&table);
    return status;
}

/* What the command line asks for has to go together. */
static ehd_status check_usage(const program *self, const romrun_options *options,
                              ehd_error *error) {
    const bool solves = !options->calibrate && !options->trade;
    const char *mode = options->calibrate ? "--calibrate" : "--trade";
    const ehdrom_sizes *sizes = &options->sizes;
    const bool sized = sizes->pressure_modes || sizes->deformation_modes || sizes->rows;

    if (self->num_arguments != (solves ? 1 : 0))
        return ehd_fail(error, EHD_USAGE, "command line: found %zu file%s, expected %s",
                        self->num_arguments, self->num_arguments == 1 ? "" : "s",
                        solves ? "SCENE.yml --model MODEL.h5" : "none with --calibrate or --trade");
    if (!options->model)
        return ehd_fail(error, EHD_USAGE, "--model: found none, expected a model.h5");
    if (options->calibrate && options->trade)
        return ehd_fail(error, EHD_USAGE, "--trade: found with --calibrate, expected one of them");
    if (options->accuracy > 0 && sized)
        return ehd_fail(error, EHD_USAGE,
                        "--accuracy: found with --pressure-modes, --deformation-modes or --rows, "
                        "expected one or the other");
    if (options->num_jobs > 0 && !options->calibrate)
        return ehd_fail(error, EHD_USAGE, "--jobs: found without --calibrate, expected with it");
    if (!solves && (sized || options->verify || options->accuracy > 0 || options->against ||
                    options->allow_untrusted || options->resume || options->repeats > 1))
        return ehd_fail(error, EHD_USAGE,
                        "%s: found with an option for solving a scene, expected none", mode);
    if (options->resume && !self->output)
        return ehd_fail(
            error, EHD_USAGE,
            "--resume: found without --output, expected the one of the interrupted run");
    if (options->calibrate && !self->output)
        return ehd_fail(error, EHD_USAGE, "--output: found nothing, expected -o FILE");
    if (options->trade && self->output)
        return ehd_fail(error, EHD_USAGE, "--output: found with --trade, expected without");
    return EHD_OK;
}

static ehd_status print_trade(const romrun_options *options, ehd_error *error) {
    trade_table table;
    ehd_status status = trade_read(&table, options->model, error);
    if (status) return status;

    trade_print(&table, stdout);
    trade_free(&table);
    return EHD_OK;
}

/* What belongs to scenes of one regime only. */
static ehd_status check_regime(const romrun_options *options, bool transient, ehd_error *error) {
    if (options->resume && !transient)
        return ehd_fail(error, EHD_USAGE,
                        "--resume: found with a stationary scene, expected a transient one");
    if (options->verify && transient)
        return ehd_fail(error, EHD_USAGE,
                        "--verify: found with a transient scene, expected a stationary one");
    if (options->repeats > 1 && transient)
        return ehd_fail(error, EHD_USAGE,
                        "--repeat: found with a transient scene, expected a stationary one");
    return EHD_OK;
}

/* One scene. */
static ehd_status run_scene(const program *self, const romrun_options *given_options,
                            ehd_error *error) {
    romrun_options options = *given_options;
    ehd_contact contact;
    scene given;
    char *scene_lines = NULL;
    ehd_status status = contact_load(&contact, &given, &scene_lines, self, error);
    bool transient = !status && strcmp(given.regime, "transient") == 0;

    if (!status) status = check_regime(&options, transient, error);
    if (!status && options.accuracy > 0) status = choose_sizes(&options, self, transient, error);
    if (!status)
        status = transient ? run_transient(self, &options, &contact, &given, scene_lines, error)
                           : run_stationary(self, &options, &contact, &given, scene_lines, error);
    free(scene_lines);
    return status;
}

/* Everything between the command line and the exit code. */
static ehd_status run(const program *self, const romrun_options *options, ehd_error *error) {
    ehd_status status = check_usage(self, options, error);

    if (status) return status;
    if (options->trade) return print_trade(options, error);
    if (options->calibrate)
        return calibrate(self, options->calibrate, options->model,
                         options->num_jobs ? options->num_jobs : pool_default_workers(), error);
    return run_scene(self, options, error);
}

int main(int argc, char **argv) {
    romrun_options own = {.repeats = 1};
    const program_options options = {
        .options = own_options,
        .parse = parse_own,
        .own = &own,
        .arguments_doc = "SCENE.yml --model MODEL.h5 -o RESULT.h5\n"
                         "--calibrate PLAN.yml --model MODEL.h5 -o CALIBRATED.h5\n"
                         "--trade --model CALIBRATED.h5",
        .doc = "Solves one scene with the reduced model, or measures what the model can do.",
        .help_tail = print_settings,
        .most_arguments = 1};
    ehd_error error = {""};
    program self;

    program_start(&self, argc, argv, &options);
    if (self.check) return output_check(&self);
    ehd_status status = run(&self, &own, &error);
    return program_finish(&self, status, &error);
}
