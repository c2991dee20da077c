/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fullrun: solves one scene with the full model (README.md). The program reads options and the
 * scene, calls the solver or the march, and writes the result.
 * Called from the command line, and by the pipelines in scenes. */
#include "common/output/columns.h"
#include "common/output/grid_file.h"
#include "common/output/inputs.h"
#include "common/output/output_main.h"
#include "common/output/result.h"
#include "common/output/time_run.h"
#include "common/output/traction_output.h"
#include "common/physics/grid_choice.h"
#include "common/program/program.h"
#include "common/program/team.h"
#include "common/settings/scene.h"
#include "common/settings/scene_contact.h"
#include "common/time/history.h"
#include "common/time/surface.h"
#include "common/time/time_grid.h"
#include "common/training/pool.h"
#include "fullrun/continuation.h"
#include "fullrun/formulas.h"
#include "fullrun/full_march.h"
#include "fullrun/full_result.h"
#include "fullrun/full_solver.h"
#include "fullrun/judge.h"
#include "fullrun/resolution.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WORK_PARTS = 1000 };

typedef struct fullrun_options {
    const char *start;   // NULL: cold start
    const char *grid_of; // NULL: the scene's grid, or the default grid
    double tolerance;    // of Newton's iteration
    bool formulas, allow_untrusted;
    size_t repeats; // number of solutions, whose median time is reported
    bool resume;
    size_t num_jobs;
    team *threads; // team of num_jobs threads for the work on a large grid; NULL: one thread does
                   // all work
} fullrun_options;

// clang-format off
#define OWN_OPTIONS fullrun_options

// columns: name, letter, argument, help, how it is read
static const program_option own_options[] = {
    {"start", 0, "RESULT.h5", "Start from the fields of another result on the same grid, not cold (stationary)",
     OPTION_TEXT(start)},
    {"grid-of", 0, "FILE.h5", "Take the grid of snapshots, a basis, a model or a result where the scene does not give it, to "
     "compare on the same", OPTION_TEXT(grid_of)},
    {"tolerance", 0, "X", "Largest scaled residual at which Newton's iteration may end; default 1e-10",
     OPTION_REAL(tolerance, 1e-13, 1)},
    {"formulas", 0, NULL, "Print beside the solution what published film formulas say, and the traction curve of an "
     "Eyring fluid; in time, films and friction of the contact at each time as if it were stationary", OPTION_FLAG(formulas)},
    {"allow-untrusted", 0, NULL, "Exit with 0 although the grid is too coarse to estimate its error, or a thinned flow is beyond its equations",
     OPTION_FLAG(allow_untrusted)},
    {"repeat", 0, "N", "Solve N times and report the median time; default 1 (stationary)",
     OPTION_COUNT(repeats, 1, 1000000)},
    {"resume", 0, NULL, "Continue an interrupted run of the same scene, where there is one (transient)",
     OPTION_FLAG(resume)},
    {"jobs", 'j', "N", "Threads that share the work of a large point contact, of more than 10,000 nodes that are solved "
     "for; as many as there are processors by default. Changes no result", OPTION_COUNT(num_jobs, 1, 4096)},
    {0}};
// clang-format on

static void print_settings(void) {
    scene_print_help(stdout);
}

// ---- the start

/* Sets the state from a stored result. EHD_DATA: the result has no fields, has another grid, or did
 * not converge. */
static ehd_status set_start(full_state *state, const ehd_grid *grid, const stored_result *stored,
                            const char *path, ehd_error *error) {
    size_t centre = (size_t)ceil(-grid->x_min / grid->step) + 1, exit = grid->num_nodes - 1;

    if (!stored->pressure)
        return ehd_fail(error, EHD_DATA,
                        "%s: found no dataset pressure, expected fields to start "
                        "from (output.fields)",
                        path);
    ehd_status status = result_check_grid(stored, path, grid, error);
    if (status) return status;
    if (stored->status == 1)
        return ehd_fail(error, EHD_DATA,
                        "%s: found a result that did not converge, expected one "
                        "that did",
                        path);

    grid_put_inner(state->pressure, stored->pressure, grid, true);
    state->rigid_approach = stored->rigid_approach;
    while (exit > centre && !(state->pressure[exit - 1] > 0))
        exit--;
    full_state_set_zone(state, grid, exit);
    return EHD_OK;
}

/* Reads the result from which --start starts. *film is its central film. */
static ehd_status load_start(full_state *state, double *film, const ehd_contact *contact,
                             const char *path, ehd_error *error) {
    stored_result stored;
    ehd_status status = result_read(&stored, path, contact->kind, true, error);

    if (!status) status = set_start(state, &contact->grid, &stored, path, error);
    *film = stored.central_film_thickness;
    result_free(&stored);
    return status;
}

// ---- the solution

static run_result make_result(const full_info *info, const full_state *state,
                              const ehd_contact *contact, bool with_fields) {
    run_result result = full_result(info, state, contact, with_fields);

    result.indicated_deviation = result.indicated_deviation_minimum = NAN;
    result.status = full_judge(result.reason, info, state, contact);
    return result;
}

static full_settings make_settings(const fullrun_options *options) {
    full_settings settings = full_default_settings();

    settings.tolerance = options->tolerance;
    settings.threads = options->threads;
    return settings;
}

/* Solves the contact as many times as --repeat gives. With --start each solution starts from
 * `first`, otherwise each is a cold start. *info belongs to the solution with the median computing
 * time. */
static ehd_status solve_again(full_info *info, full_state *state, full_solver *solver,
                              const full_state *first, const ehd_contact *contact,
                              const fullrun_options *options, ehd_error *error) {
    const size_t repeats = options->repeats;
    full_info *runs = calloc(repeats, sizeof *runs);
    ehd_status status = runs ? EHD_OK : ehd_no_memory(error, "--repeat");

    for (size_t i = 0; i < repeats && !status; i++) {
        full_state_copy(state, first, &contact->grid);
        status = options->start ? full_solve_from(&runs[i], state, solver, contact, error)
                                : full_solve_cold(&runs[i], state, solver, contact, error);
    }
    if (!status) *info = full_median_run(runs, repeats);
    free(runs);
    return status;
}

/* Progress of the solution of a point contact, which may take long. The progress is shown on
 * stderr. */
typedef struct long_work {
    progress shown;
    const ehd_grid *grid; // grid of the contact
    size_t num_inner;     // inner nodes of the grid that is solved now
    // Newton iterations on this grid. before: up to the last start of Newton; iterations: in all
    size_t before, iterations;
} long_work;

/* Returns the part of the whole work that is done when a grid and all coarser ones are solved. */
static double work_up_to(const ehd_grid *grid, const ehd_grid *finest) {
    // The time grows as the number of nodes to the power 1.4 (measured). Only the progress line
    // uses this power.
    return pow((double)grid->num_inner / (double)finest->num_inner, 1.4);
}

/* Returns how many Newton iterations a grid may still take. Below a scaled residual of 0.01, where
 * Newton converges quadratically, it returns three. Above 0.01 it returns the iterations so far, or
 * the number that is missing to eight iterations if this number is larger. */
static double iterations_left(double iterations, double residual) {
    return residual < 0.01 ? 3 : fmax(8 - iterations, iterations);
}

static void show_work(void *context, const ehd_grid *grid, size_t iteration, double residual) {
    const ehd_grid coarser = full_coarser_grid(grid);
    long_work *self = context;

    if (grid->num_inner != self->num_inner) self->before = self->iterations = 0;
    if (iteration == 0) self->before = self->iterations; // a new start of Newton
    self->num_inner = grid->num_inner;
    self->iterations = self->before + iteration;
    const double before = work_up_to(&coarser, self->grid), after = work_up_to(grid, self->grid);
    const double here = (double)self->iterations;
    const double part = here / (here + iterations_left(here, residual));
    const size_t done = (size_t)(WORK_PARTS * (before + part * (after - before)));
    char text[96];

    snprintf(text, sizeof text, "%zu by %zu nodes, iteration %zu, residual %.1e", grid->inner_x,
             grid->inner_lines, iteration, residual);
    progress_show(&self->shown, done, text);
}

static ehd_status solve(full_info *info, full_state *state, const program *caller,
                        const ehd_contact *contact, const fullrun_options *options,
                        ehd_error *error) {
    long_work work = {.grid = &contact->grid};
    full_settings settings = make_settings(options);
    full_solver *solver = NULL;
    full_state first = {0};

    progress_start(&work.shown, caller, WORK_PARTS);
    work.shown.last_shown = work.shown.started; // a quick solution shows no progress
    settings.watcher = contact->kind->dimensions > 1 ? show_work : NULL;
    settings.watcher_context = &work;
    ehd_status status =
        full_solver_create(&solver, contact->kind, &contact->grid, &settings, error);

    if (!status) status = full_state_init(&first, &contact->grid, error);
    if (!status) {
        full_state_copy(&first, state, &contact->grid);
        status = solve_again(info, state, solver, &first, contact, options, error);
    }
    full_state_free(&first);
    full_solver_free(solver);
    if (work.shown.last_shown > work.shown.started) progress_finish(&work.shown);
    return status;
}

static ehd_status put_resolution(artefact *file, const full_resolution *resolution,
                                 ehd_error *error) {
    const named_number numbers[] = {{"observed_order", resolution->order},
                                    {"inlet_nodes", (double)resolution->inlet_nodes},
                                    {"spike_nodes", (double)resolution->spike_nodes},
                                    {"outlet_nodes", (double)resolution->outlet_nodes},
                                    {0}};

    return numbers_put_known(file, 0, numbers, error);
}

static void note_resolution(const program *self, const full_resolution *resolution,
                            const ehd_contact *contact) {
    const ehd_grid *grid = &contact->grid;
    const bool with_rolling = contact_has_traction(contact);
    const char *path = self->arguments[0];
    const double *effects = resolution->effects.of;

    if (film_effects_are_infinite(&resolution->effects)) return; // result_judge handles this
    if (effects[EFFECT_INLET] > default_accuracy)
        program_note(self,
                     "%s: grid.x_min: found %g, expected a longer inlet: the error estimate of the "
                     "central film is %.2g %%",
                     path, grid->x_min, 100 * effects[EFFECT_INLET]);
    if (effects[EFFECT_STEP] > default_accuracy)
        program_note(self,
                     "%s: grid.step: found %g, expected a finer one: the error estimate of the "
                     "central film is %.2g %%",
                     path, grid->step, 100 * effects[EFFECT_STEP]);
    else if (effects[EFFECT_STEP_MINIMUM] > resolution_limit)
        program_note(self,
                     "%s: grid.step: found %g, expected a finer one: the error estimate of the "
                     "minimum film is %.2g %%",
                     path, grid->step, 100 * effects[EFFECT_STEP_MINIMUM]);
    if (with_rolling && film_effects_of_rolling(&resolution->effects) > resolution_limit)
        program_note(
            self,
            "%s: rolling resistance: found an error estimate of %.2g %%, expected a longer "
            "domain or a smaller step",
            path, 100 * film_effects_of_rolling(&resolution->effects));
}

/* Writes the resolution to `file`, unless `file` is NULL. Prints a note if an error estimate is
 * large. */
static ehd_status report_resolution(artefact *file, const program *self,
                                    const full_resolution *resolution, const ehd_contact *contact,
                                    ehd_error *error) {
    ehd_status status = file ? put_resolution(file, resolution, error) : EHD_OK;

    if (!status) note_resolution(self, resolution, contact);
    return status;
}

static void print_start(const char *path, double film, const run_result *result) {
    printf("%-24s%s: %zu iterations, %.3g ms; its central film lies %+.2e off\n", "started from",
           path, result->newton_iterations, result->seconds.total * 1e3,
           film / result->scalars.central_film_thickness - 1);
}

/* A stationary scene on one grid, from its settings to its solution. */
typedef struct stationary_run {
    const program *caller;
    const fullrun_options *options;
    const ehd_contact *contact;
    const scene *given;
    double start_film; // central film of the state that --start gives
    full_state state;
    full_info info;
    double *exits; // X of the exits of a point contact
    bool solved, estimated;
    full_resolution resolution; // only if `estimated`
} stationary_run;

static ehd_status estimate_resolution(stationary_run *self, ehd_error *error) {
    const double before = program_seconds();
    full_resolution *resolution = &self->resolution;
    ehd_status status = full_resolution_estimate(resolution, &self->state, self->contact,
                                                 self->options->threads, error);

    self->estimated = !status;
    if (self->estimated)
        program_detail(self->caller,
                       "resolution in %.3g ms: nodes of inlet %zu, spike %zu, outlet %zu",
                       1e3 * (program_seconds() - before), resolution->inlet_nodes,
                       resolution->spike_nodes, resolution->outlet_nodes);
    return status;
}

static ehd_status solve_stationary(stationary_run *self, ehd_error *error) {
    const fullrun_options *options = self->options;
    const ehd_contact *contact = self->contact;
    char unused[JUDGE_REASON];
    ehd_status status = solve(&self->info, &self->state, self->caller, contact, options, error);

    if (!status) status = full_exits(&self->exits, &self->state, &contact->grid, error);
    if (!status)
        program_detail(self->caller, "%zu Newton and %zu GMRES iterations",
                       self->info.newton_iterations, self->info.gmres_iterations);
    self->solved =
        !status && full_judge(unused, &self->info, &self->state, contact) != EHD_NOT_CONVERGED;
    if (self->solved && self->given->output.resolution != 0)
        status = estimate_resolution(self, error);
    return status;
}

/* Largest number of halvings of the default grid step. Lines, points and ellipses with b/a up to 20
 * were solved with M from 0.1 to 2000 and L from 0 to 25, ellipses with b/a = 0.5 up to M = 300,
 * and with b/a from 0.05 up to M = 10 (long_grids.bats). Wherever the default step
 * was too coarse, one halving was enough. On a point contact each halving makes the number of nodes
 * four times as large. */
enum { MAX_HALVINGS = 2 };

/* Halves the default step if this step does not resolve the contact. Returns whether the step was
 * halved. The finer grid must fit in memory and must not exceed the largest number of nodes. */
static bool halve_step(ehd_contact *finer, const stationary_run *self) {
    const fullrun_options *options = self->options;
    const film_effects *effects = &self->resolution.effects;
    const bool failed =
        self->info.status != EHD_OK && !full_beyond_law(&self->state, self->contact);
    const bool short_inlet =
        !isnan(self->contact->grid_given.x_min) && film_effects_inlet_is_short(effects);
    const bool coarse =
        failed || (self->estimated && film_effects_are_infinite(effects) && !short_inlet);
    grid_extent needed = grid_extent_of(&self->contact->grid);
    ehd_error ignored;

    if (!coarse || !isnan(self->contact->grid_given.step) || options->start) return false;
    *finer = *self->contact;
    needed.step /= 2;
    if (scene_set_grid(finer, &needed, &ignored) ||
        grid_check_memory(self->caller, self->caller->arguments[0], finer,
                          full_solver_bytes(&finer->grid), 1, &ignored))
        return false;
    program_note(self->caller, "%s: grid.step: found that %g is too coarse, going on with %g",
                 self->caller->arguments[0], self->contact->grid.step, finer->grid.step);
    return true;
}

/* Prints the result, and writes it to *file unless *file is NULL. */
static ehd_status report_stationary(artefact **file, const stationary_run *self, ehd_error *error) {
    const char *path = self->caller->arguments[0];
    const ehd_contact *contact = self->contact;
    run_result result =
        make_result(&self->info, &self->state, contact, self->given->output.fields != 0);
    film_effects effects = film_effects_unknown();
    contact_traction traction = contact_traction_unknown();
    ehd_status status = EHD_OK;

    result.exits = self->exits;
    if (contact_has_traction(contact)) {
        traction = full_evaluate_traction(&self->state, contact);
        result.traction = &traction;
    }
    result.effects = &effects;
    if (self->estimated) {
        effects = self->resolution.effects;
        status = report_resolution(*file, self->caller, &self->resolution, contact, error);
    }
    result_judge(&result, &contact->grid);
    if (!status && *file) status = result_write(file, &result, contact, error);
    if (!status && result.status == EHD_NOT_CONVERGED)
        status = ehd_fail(error, result.status, "%s: not converged: %s", path, result.reason);
    if (status) return status;
    result_print(&result, contact);
    if (result.traction) traction_warn(self->caller, result.traction->friction);
    if (self->options->start) print_start(self->options->start, self->start_film, &result);
    if (self->options->formulas) {
        const contact_scalars scalars = full_evaluate_scalars(&self->state, contact);
        formulas_print(&scalars, contact);
        formulas_print_traction(&traction, contact);
    }
    if (result.status == EHD_UNTRUSTED && !self->options->allow_untrusted)
        status =
            ehd_fail(error, result.status,
                     "%s: found %s, expected %s (--allow-untrusted takes the result all the same)",
                     path, result.reason,
                     !film_effects_are_infinite(&effects)    ? "a result to be trusted"
                     : film_effects_inlet_is_short(&effects) ? "a longer one"
                                                             : "a finer one");
    return status;
}

/* Creates the file for a result on the grid of this run. Closes the file that was created for
 * another grid. */
static ehd_status start_file(artefact **file, const stationary_run *self, const char *text,
                             ehd_error *error) {
    const program *caller = self->caller;
    const fullrun_options *options = self->options;
    const char *inputs[4] = {caller->arguments[0]}; // ends with NULL

    artefact_close(file);
    if (!caller->output) return EHD_OK;
    inputs_add(inputs, inputs_add(inputs, 1, options->start), options->grid_of);
    return result_create(file, caller, self->contact, text, inputs, error);
}

static ehd_status run_on_grid(stationary_run *self, ehd_error *error) {
    const program *caller = self->caller;
    const ehd_contact *contact = self->contact;
    const char *start = self->options->start;
    ehd_status status = grid_check_memory(caller, caller->arguments[0], contact,
                                          full_solver_bytes(&contact->grid), 1, error);

    if (!status) status = full_state_init(&self->state, &contact->grid, error);
    if (!status && start)
        status = load_start(&self->state, &self->start_film, contact, start, error);
    return status ? status : solve_stationary(self, error);
}

/* Returns the last of the runs 0 … `last` that has a solution, or `last` if none has one. */
static size_t last_solved(const stationary_run *runs, size_t last) {
    size_t place = last;

    while (place > 0 && !runs[place].solved)
        place--;
    return runs[place].solved ? place : last;
}

static ehd_status run_stationary(const program *caller, const fullrun_options *options,
                                 const ehd_contact *contact, const scene *given, const char *text,
                                 ehd_error *error) {
    ehd_contact contacts[MAX_HALVINGS + 1];
    stationary_run runs[MAX_HALVINGS + 1];
    artefact *file = NULL;
    ehd_status status = EHD_OK;
    size_t num_runs = 0;

    contacts[0] = *contact;

    for (bool again = true; again && !status;) {
        const size_t i = num_runs++;
        runs[i] = (stationary_run){.caller = caller,
                                   .options = options,
                                   .contact = &contacts[i],
                                   .given = given,
                                   .start_film = NAN};
        status = start_file(&file, &runs[i], text, error);
        if (!status) status = run_on_grid(&runs[i], error);
        again = !status && i < MAX_HALVINGS && halve_step(&contacts[i + 1], &runs[i]);
    }
    const size_t last = num_runs - 1, shown = last_solved(runs, last);
    if (!status && shown < last) {
        program_note(caller, "%s: grid.step: found no solution with %g, keeping the one with %g",
                     caller->arguments[0], contacts[last].grid.step, contacts[shown].grid.step);
        status = start_file(&file, &runs[shown], text, error);
    }
    if (!status) status = report_stationary(&file, &runs[shown], error);
    artefact_close(&file);
    for (size_t i = 0; i < num_runs; i++) {
        full_state_free(&runs[i].state);
        free(runs[i].exits);
    }
    return status;
}

static ehd_status run_transient(const program *self, const fullrun_options *options,
                                const ehd_contact *contact, const scene *given, const char *text,
                                ehd_error *error) {
    const full_settings settings = make_settings(options);
    full_march *in_time = NULL;
    ehd_surface *surface = NULL;
    ehd_contact reference = *contact;
    ehd_status status = surface_init(&surface, given, contact, error);

    reference.surface = surface;
    contact = &reference;
    if (!status && surface) status = surface_check_grid(surface, &contact->grid, error);
    if (!status)
        status = grid_check_memory(self, self->arguments[0], contact, full_march_bytes(contact), 1,
                                   error);

    if (!status)
        status =
            full_march_create(&in_time, contact, &settings, given->transient.start_film, error);

    if (!status) {
        const time_run_task task = {.caller = self,
                                    .given = given,
                                    .reference = contact,
                                    .settings_text = text,
                                    .input = options->grid_of,
                                    .solver = full_march_solver(in_time),
                                    .with_fields = given->output.fields != 0,
                                    .allow_untrusted = options->allow_untrusted,
                                    .resume = options->resume};
        status = time_run(NULL, &task, error);
    }
    if (!status && options->formulas)
        status = formulas_print_in_time(self->output, given, contact, error);
    full_march_free(in_time);
    surface_free(surface);
    return status;
}

/* Checks options that need a stationary scene, a transient scene or an output. EHD_USAGE. */
static ehd_status check_usage(const program *self, const fullrun_options *options, bool transient,
                              ehd_error *error) {
    if (options->start && transient)
        return ehd_fail(error, EHD_USAGE,
                        "--start: found with a transient scene, expected a stationary one");
    if (options->resume && !transient)
        return ehd_fail(error, EHD_USAGE,
                        "--resume: found with a stationary scene, expected a transient one");
    if (options->repeats > 1 && transient)
        return ehd_fail(error, EHD_USAGE,
                        "--repeat: found with a transient scene, expected a stationary one");
    if (options->resume && !self->output)
        return ehd_fail(
            error, EHD_USAGE,
            "--resume: found without --output, expected the one of the interrupted run");
    if (options->formulas && transient && !self->output)
        return ehd_fail(error, EHD_USAGE,
                        "--formulas: found with a transient scene without --output, expected -o "
                        "FILE, from which they are compared");
    return EHD_OK;
}

/* Gives the contact the grid of --grid-of, if this option is given. */
static ehd_status take_grid(ehd_contact *contact, const scene *given, const char *path,
                            ehd_error *error) {
    const contact_kind *kind;
    ehd_grid grid;
    if (!path) return EHD_OK;
    ehd_status status = grid_of_file(&grid, &kind, path, error);

    if (status) return status;
    if (kind != contact->kind)
        return ehd_fail(error, EHD_DATA, "%s: contact: found %s, expected %s, as in the scene",
                        path, kind->name, contact->kind->name);
    contact_take_grid(contact, &grid);
    status = grid_check(&grid, path, &contact->grid, "the scene", error);
    return status ? status : scene_check_approach(given, contact, error);
}

static ehd_status set_grid_in_time(ehd_contact *contact, const scene *given, ehd_error *error) {
    ehd_histories *histories;
    ehd_status status = histories_init(&histories, given, error);

    if (status) return status;
    const grid_extent needed = time_grid_extent(histories, contact, given->transient.end_time);
    histories_free(histories);
    status = scene_set_grid(contact, &needed, error);
    return status ? status : scene_check_approach(given, contact, error);
}

static ehd_status run(const program *self, void *own, ehd_error *error) {
    fullrun_options *options = own;
    ehd_contact contact = {0};
    scene given;
    char *text = NULL;
    ehd_status status = scene_load(&given, &text, self, error);
    if (!status) status = contact_load(&contact, &given, self, NULL, NULL, error);
    bool transient = !status && strcmp(given.regime, "transient") == 0;

    if (transient) status = set_grid_in_time(&contact, &given, error);
    if (!status) status = take_grid(&contact, &given, options->grid_of, error);
    if (!status) status = check_usage(self, options, transient, error);
    // halve_step may make the grid large if no grid step is given
    const bool may_be_large =
        contact.kind && contact.kind->dimensions > 1 && isnan(contact.grid_given.step);
    if (!status && (may_be_large || full_is_large(&contact.grid)))
        options->threads = team_create(options->num_jobs);
    if (!status)
        status = (transient ? run_transient : run_stationary)(self, options, &contact, &given, text,
                                                              error);
    options->threads = team_free(options->threads);
    free(text);
    return status;
}

int main(int argc, char **argv) {
    fullrun_options own = {.tolerance = full_default_settings().tolerance,
                           .repeats = 1,
                           .num_jobs = pool_default_workers()};
    const program_options options = {.options = own_options,
                                     .own = &own,
                                     .arguments_doc = "SCENE.yml [-o RESULT.h5]",
                                     .doc = "Solves one elastohydrodynamic contact with the full "
                                            "model.",
                                     .help_tail = print_settings,
                                     .min_arguments = 1,
                                     .max_arguments = 1};
    return output_main(argc, argv, &options, run, NULL, NULL);
}
