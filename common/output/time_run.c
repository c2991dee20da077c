/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/output/time_run.h"

#include "common/output/grid_file.h"
#include "common/output/inputs.h"
#include "common/output/time_result.h"
#include "common/output/traction_output.h"
#include "common/settings/part_list.h"
#include "common/settings/scene_contact.h"
#include "common/time/apart.h"
#include "common/time/surface.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* CHECKPOINT_PAUSE: shortest time between two checkpoints, s. WRITE_PAUSE: longest time that a step
 * waits to be written together with other steps, s. Steps are written together because a write
 * takes as long as a step. A reader that follows the run sees new steps five times a second
 * (transient.bats, "a run can be followed, killed and resumed"). */
static const double CHECKPOINT_PAUSE = 1, WRITE_PAUSE = 0.2;

enum { MAX_WAITING = 256 }; // entries that are written together

/* Sums and extremes over all time steps of a run, for the report at its end. The march counts steps
 * and iterations itself (march_state). All members are doubles, so that the struct can be saved as
 * numbers. */
typedef struct run_totals {
    solve_seconds seconds;
    // smallest minimum film and largest central film of all times
    double min_film, max_film;
    // effect of the time steps on the films (march_step): integral of effect^2 over T for the
    // central film, and the largest effect on each film
    double effect_squares, max_effect, max_effect_minimum;
    double max_indicated, max_indicated_minimum; // error estimates of both films; NaN: unknown
    double max_inlet, time_of_inlet;             // largest effect of the inlet, and its T
    double max_friction;                         // largest friction coefficient
} run_totals;

/* Offsets in a restart slot, counted in doubles. */
enum {
    AT_APPROACH = sizeof(march_state) / sizeof(double),
    AT_TOTALS,
    AT_UNTRUSTED = AT_TOTALS + sizeof(run_totals) / sizeof(double),
    AT_SOLVER = AT_UNTRUSTED + MARCH_REASON
};

typedef struct runner {
    const time_run_task *task;
    apart_march contact; // the task's solver, wrapped so that the bodies may come apart
    march march;
    artefact *file; // NULL: nothing is written
    double *restart;
    double *pressure, *film; // [num_nodes], NULL: no fields
    double *exits;           // [MAX_WAITING, lines of the whole grid, GRID_EXITS]
    // entries that wait to be written together, because a write takes as long as a step
    time_entry waiting[MAX_WAITING];
    size_t num_waiting, num_written;
    double started, last_checkpoint, last_write;
    double writing;    // seconds spent on writing since the start
    run_totals totals; // extremes and sums of all entries; seconds of the runs before a resumption
    time_trace *trace;
    progress progress;
} runner;

void time_trace_free(time_trace *trace) {
    free(trace->time);
    free(trace->central_film_thickness);
    free(trace->central_pressure);
    memset(trace, 0, sizeof *trace);
}

static ehd_status trace_reserve(time_trace *trace, size_t capacity, ehd_error *error) {
    double **const columns[] = {&trace->time, &trace->central_film_thickness,
                                &trace->central_pressure};

    for (size_t i = 0; i < sizeof columns / sizeof *columns; i++) {
        double *larger = realloc(*columns[i], capacity * sizeof **columns[i]);
        if (!larger) return ehd_no_memory(error, "trace");
        *columns[i] = larger;
    }
    trace->capacity = capacity;
    return EHD_OK;
}

static ehd_status trace_add(time_trace *trace, const time_entry *entry, ehd_error *error) {
    if (trace->count == trace->capacity) {
        ehd_status status = trace_reserve(trace, 2 * trace->capacity + 1024, error);
        if (status) return status;
    }
    trace->time[trace->count] = entry->time;
    trace->central_film_thickness[trace->count] = entry->scalars.central_film_thickness;
    trace->central_pressure[trace->count++] = entry->scalars.central_pressure;
    return EHD_OK;
}

/* Reads the trace that an earlier run stored. */
static ehd_status trace_read(time_trace *trace, artefact *file, size_t num_entries,
                             ehd_error *error) {
    ehd_status status = trace_reserve(trace, num_entries, error);

    if (!status) status = artefact_get_axis(file, "time", trace->time, num_entries, error);
    if (!status)
        status = artefact_get(file, "central_film_thickness", trace->central_film_thickness,
                              num_entries, error);
    if (!status)
        status =
            artefact_get(file, "central_pressure", trace->central_pressure, num_entries, error);
    if (!status) trace->count = num_entries;
    return status;
}

// ---- storing

/* Returns the totals. Their seconds also include this run up to `now`. */
static run_totals totals_at(const runner *self, double now) {
    run_totals totals = self->totals;
    const march_solver *solver = &self->task->solver;
    solve_seconds seconds = solver->seconds(solver->self);

    seconds.total = now - self->started - self->writing; // also between solutions
    solve_seconds_add(&totals.seconds, &seconds);
    return totals;
}

static ehd_status write_waiting(runner *self, ehd_error *error) {
    ehd_status status =
        self->num_waiting > 0
            ? time_result_append(self->file, &self->task->reference->grid, self->waiting,
                                 self->num_waiting, self->num_written, error)
            : EHD_OK;

    self->num_written += self->num_waiting;
    self->num_waiting = 0;
    self->last_write = program_seconds();
    return status;
}

/* Writes an entry with fields at once, because the next step overwrites the fields. Other entries
 * wait and are written together. */
static ehd_status write_entry(runner *self, const time_entry *entry, double now, ehd_error *error) {
    self->waiting[self->num_waiting++] = *entry;
    if (!entry->pressure && self->num_waiting < MAX_WAITING && now - self->last_write < WRITE_PAUSE)
        return EHD_OK;
    return write_waiting(self, error);
}

static ehd_status checkpoint(runner *self, double now, ehd_error *error) {
    const march_solver *solver = &self->march.solver;
    const run_totals totals = totals_at(self, now);
    ehd_status status = write_waiting(self, error);

    if (status) return status;
    memcpy(self->restart, &self->march.state, sizeof self->march.state);
    self->restart[AT_APPROACH] = self->march.settings.reference_approach;
    memcpy(self->restart + AT_TOTALS, &totals, sizeof totals);
    march_save_text(self->restart + AT_UNTRUSTED, self->march.untrusted);
    solver->save(self->restart + AT_SOLVER, solver->self);
    self->last_checkpoint = program_seconds();
    return time_result_checkpoint(self->file, self->restart, self->num_written, error);
}

/* Returns the exits in the reference frame, in memory that stays until the entry is written. For a
 * line contact the exit farthest downstream is taken from `scalars`. */
static const double *take_exits(runner *self, const march_step *step,
                                const contact_scalars *scalars) {
    const size_t num_lines = grid_whole(&self->task->reference->grid).inner_lines;
    const size_t count = num_lines * GRID_EXITS;
    double *exits = self->exits + self->num_waiting * count;

    self->march.solver.exits(exits, self->march.solver.self);
    for (size_t i = 0; i < count; i++)
        exits[i] *= step->frame.half_width;
    if (num_lines == 1 && !step->apart) exits[0] = scalars->exit_position;
    return exits;
}

/* Returns the larger number; NaN if one is NaN. */
static double larger(double a, double b) {
    return isnan(a) || isgreater(a, b) ? a : b;
}

/* Notes the friction of a step. Returns false if the friction exceeds the load. The result is then
 * not trusted. */
static bool judge_friction(runner *self, double time, double friction, double load) {
    const double coefficient = traction_judged_coefficient(friction, load);
    const bool possible = !isgreater(coefficient, possible_friction);

    self->totals.max_friction = fmax(self->totals.max_friction, coefficient);
    if (!possible && isnan(self->march.state.untrusted_since)) {
        self->march.state.untrusted_since = time;
        snprintf(self->march.untrusted, MARCH_REASON, "%s", impossible_friction);
    }
    return possible;
}

/* Stores a step as entry `index` of the file. Every N-th entry has fields (output.fields_every). */
static ehd_status store(void *sink, const march_step *step, size_t index, ehd_error *error) {
    runner *self = sink;
    double before = program_seconds();
    const march_solver *solver = &self->march.solver;
    contact_scalars scalars =
        frame_to_reference(&step->scalars, &step->frame, self->task->reference);
    const ehd_surface *surface = self->task->reference->surface;
    const double position = surface ? surface_position(surface, step->frame.path) : NAN;
    bool fields =
        self->task->with_fields && index % (size_t)self->task->given->output.fields_every == 0;
    ehd_status status = EHD_OK;
    char shown[64];

    const bool traction = contact_has_traction(self->task->reference);
    ehd_contact frame = {0};
    contact_traction tractions = contact_traction_unknown();
    if (fields || (traction && !solver->traction))
        status = solver->fields(self->pressure, self->film, solver->self, error);
    if (traction && !status) {
        frame_contact(&frame, &step->frame, self->task->reference);
        if (step->apart)
            tractions = (contact_traction){0};
        else if (solver->traction)
            tractions = solver->traction(solver->self, &frame, &step->scalars);
        else
            tractions = contact_traction_of(&frame, self->pressure, self->film, &step->scalars);
        tractions = frame_traction_to_reference(tractions, &step->frame);
    }
    const bool trusted = judge_friction(self, step->frame.time, tractions.friction, scalars.load) &&
                         !self->task->untrusted;
    const time_entry entry = {.time = step->frame.time,
                              .scalars = scalars,
                              .contact_half_width = step->frame.half_width,
                              .frame_hertz_pressure = step->frame.hertz_pressure,
                              .frame_film_unit = step->frame.film_scale,
                              .surface_position = position,
                              .exits = take_exits(self, step, &scalars),
                              .newton_iterations = step->iterations,
                              .residual = step->residual,
                              .status = step->status || trusted ? step->status : EHD_UNTRUSTED,
                              .by_full_model = step->by_full_model,
                              .step = step->step,
                              .effect = step->effect,
                              .effect_minimum = step->effect_minimum,
                              .indicated = step->indicated,
                              .indicated_minimum = step->indicated_minimum,
                              .traction = tractions,
                              .frame = fields && traction ? &frame : NULL,
                              .pressure = fields ? self->pressure : NULL,
                              .film = fields ? self->film : NULL};
    self->totals.min_film = fmin(self->totals.min_film, entry.scalars.minimum_film_thickness);
    self->totals.max_film = fmax(self->totals.max_film, entry.scalars.central_film_thickness);
    self->totals.effect_squares += entry.step * entry.effect * entry.effect;
    self->totals.max_effect = larger(self->totals.max_effect, fabs(entry.effect));
    self->totals.max_effect_minimum =
        larger(self->totals.max_effect_minimum, fabs(entry.effect_minimum));
    if (!(step->inlet_effect <= self->totals.max_inlet)) {
        self->totals.max_inlet = step->inlet_effect;
        self->totals.time_of_inlet = entry.time;
    }
    self->totals.max_indicated = larger(entry.indicated, self->totals.max_indicated);
    self->totals.max_indicated_minimum =
        larger(entry.indicated_minimum, self->totals.max_indicated_minimum);
    if (!status && self->file) status = write_entry(self, &entry, before, error);
    if (!status && self->trace) status = trace_add(self->trace, &entry, error);
    if (!status && self->file && before - self->last_checkpoint > CHECKPOINT_PAUSE)
        status = checkpoint(self, before, error);
    snprintf(shown, sizeof shown, "T = %.4g, step %.2g", entry.time, entry.step);
    progress_show(&self->progress,
                  (size_t)(1000 * entry.time / self->task->given->transient.end_time), shown);
    self->writing += program_seconds() - before;
    return status;
}

// ---- start and resumption

static ehd_status resume(bool *resumed, runner *self, ehd_error *error) {
    const time_run_task *task = self->task;
    const march_solver *solver = &self->march.solver;
    size_t size = AT_SOLVER + solver->saved_size(solver->self), num_entries = 0;
    ehd_status status =
        time_result_resume(&self->file, self->restart, &num_entries, task->caller, task->reference,
                           task->settings_text, task->models, task->given, size, error);

    *resumed = false;
    if (status == EHD_NOINPUT) return EHD_OK;
    if (status || num_entries == 0) {
        artefact_close(&self->file);
        return status;
    }
    memcpy(&self->march.state, self->restart, sizeof self->march.state);
    self->march.settings.reference_approach = self->restart[AT_APPROACH];
    memcpy(&self->totals, self->restart + AT_TOTALS, sizeof self->totals);
    march_restore_text(self->march.untrusted, self->restart + AT_UNTRUSTED);
    status = solver->restore(solver->self, self->restart + AT_SOLVER, error);
    if (!status && self->trace) status = trace_read(self->trace, self->file, num_entries, error);
    self->num_written = num_entries;
    *resumed = !status;
    self->started = self->last_checkpoint = program_seconds();
    if (!status)
        program_note(task->caller, "%s.partial: goes on at T = %g", task->caller->output,
                     self->march.state.time);
    return status;
}

static ehd_status create(runner *self, ehd_error *error) {
    const time_run_task *task = self->task;
    const march_solver *solver = &self->march.solver;
    const char *inputs[MAX_TABLES + MAX_PARTS + 4]; // scene, models, tables, another file, NULL
    size_t num_inputs = inputs_add(inputs, 0, task->caller->arguments[0]);

    for (size_t i = 0; task->models && task->models[i]; i++)
        num_inputs = inputs_add(inputs, num_inputs, task->models[i]);
    num_inputs = inputs_add_tables(inputs, num_inputs, task->given);
    num_inputs = inputs_add(inputs, num_inputs, task->input);
    inputs[num_inputs] = NULL;
    return time_result_create(&self->file, task->caller, task->reference, task->settings_text,
                              inputs, task->with_fields, histories_reverse(self->march.histories),
                              task->share != NULL, AT_SOLVER + solver->saved_size(solver->self),
                              error);
}

static ehd_status begin(runner *self, ehd_error *error) {
    march_step first;
    ehd_status status = self->task->caller->output ? create(self, error) : EHD_OK;

    self->started = self->last_checkpoint = program_seconds();
    if (!status) status = march_begin(&first, &self->march, error);
    if (!status && first.status == EHD_NOT_CONVERGED)
        return ehd_fail(error, EHD_NOT_CONVERGED,
                        "%s: not converged: found no stationary solution to start from (%s), "
                        "expected one",
                        self->task->caller->arguments[0], first.reason);
    return status ? status : store(self, &first, 0, error);
}

// ---- the end

/* Prints at which time the march ended early, and from which time on it is not to be trusted. */
static void report_shortfall(const runner *self, ehd_status outcome) {
    const march_state *state = &self->march.state;
    const char *output = self->task->caller->output;

    if (outcome == EHD_NOT_CONVERGED)
        printf("%-24sat T = %.6g of %.6g, not converged; %s%s%s\n", "ended early", state->time,
               self->march.settings.end_time,
               output ? "results up to there are in " : "not written", output ? output : "",
               output ? ".partial" : "");
    if (!isnan(state->untrusted_since))
        printf("%-24sfirst at T = %.6g: %s\n", "not to be trusted", state->untrusted_since,
               self->march.untrusted);
}

/* Returns the effect of the time steps on the central film, as root mean square over time. Returns
 * NaN if the effect is not known. */
static double mean_effect(const run_totals *totals, const march_state *state) {
    return state->time > 0 ? sqrt(totals->effect_squares / state->time) : NAN;
}

/* Prints a note if error control did not keep the effect of the time steps near the tolerance. */
static void note_effect(const runner *self, const run_totals *totals) {
    // Largest ratio of effect and tolerance without a note. Error control keeps the effect within a
    // factor of 3 (common/time/README.md, Along the path; scenes.bats, "the steps in time")
    const double much = 3;
    const double tolerance = self->task->given->transient.tolerance;
    const double effect = mean_effect(totals, &self->march.state);

    if (self->task->reference->transport == TRANSPORT_PATH &&
        isnan(self->task->given->transient.fixed_step) && effect > much * tolerance)
        program_note(
            self->task->caller,
            "%s: the steps in time do %.2g %% to the central film (root mean square), "
            "more than %g times transient.tolerance; shorter steps or a finer grid make it less",
            self->task->caller->arguments[0], 100 * effect, much);
}

static void report_effects(const run_totals *totals, const march_state *state) {
    const double mean = mean_effect(totals, state);

    if (totals->max_inlet > 0 && isfinite(totals->max_inlet))
        printf("%-24scentral film %.2g %% at most, at T = %.6g\n", "effect of the inlet",
               100 * totals->max_inlet, totals->time_of_inlet);
    if (isnan(mean)) return;
    printf("%-24scentral film %.2g %% rms, %.2g %% at most", "effect of the steps", 100 * mean,
           100 * totals->max_effect);
    if (!isnan(totals->max_effect_minimum))
        printf("; minimum film %.2g %% at most", 100 * totals->max_effect_minimum);
    printf("\n");
}

/* Prints how many steps each model solved, and a note why the full model was needed. */
static void report_share(const runner *self) {
    const time_run_task *task = self->task;
    const double num_steps = self->march.state.num_steps;
    if (!task->share) return;
    const time_run_share share = task->share(task->solver.self);

    printf("%-24s%zu steps by the full model, %.4g s; %.0f by the reduced one, %.4g s\n",
           "solved by", share.full_steps, share.seconds_full, num_steps - (double)share.full_steps,
           share.seconds_reduced);
    if (!isnan(share.since))
        program_note(task->caller,
                     "--fallback full: found %s, first at T = %g: %zu of %.0f steps by the full "
                     "model, %.3g s",
                     share.reason, share.since, share.full_steps, num_steps, share.seconds_full);
}

static void report_indicated(const run_totals *totals) {
    if (isnan(totals->max_indicated)) return;
    printf("%-24scentral film %.2g %%, minimum film %.2g %% at most\n", "indicated deviation",
           100 * totals->max_indicated, 100 * totals->max_indicated_minimum);
}

static void report(const runner *self, const run_totals *totals, ehd_status outcome) {
    const ehd_contact *contact = self->task->reference;
    const march_state *state = &self->march.state;
    double scale = contact_film_scale(contact) * 1e6;

    printf("%-24sM = %.6g, L = %.6g, alpha p_H = %.6g, p_H = %.6g GPa\n", "reference",
           contact->moes_M, contact->moes_L, contact->alpha_p_H, contact->hertz_pressure * 1e-9);
    grid_print_equations(contact);
    printf("%-24s%s\n", "transport", transport_names[contact->transport]);
    grid_print(contact, "the reference and its histories");
    printf("%-24sT = 0 to %.6g in %.0f steps, %.0f more rejected\n", "time", state->time,
           state->num_steps, state->num_rejected);
    report_shortfall(self, outcome);
    printf("%-24s%.8g", "smallest film", totals->min_film);
    if (isfinite(scale)) printf("      %.6g µm", totals->min_film * scale);
    printf("\n%-24s%.8g", "largest central film", totals->max_film);
    if (isfinite(scale)) printf("      %.6g µm", totals->max_film * scale);
    printf("\n");
    report_effects(totals, state);
    report_indicated(totals);
    printf("%-24s%.0f, %.3g a step\n", "Newton iterations", state->num_iterations,
           state->num_iterations / fmax(state->num_steps + state->num_rejected, 1));
    printf("%-24s%.4g s, %.4g ms a step\n", "solution", totals->seconds.total,
           totals->seconds.total * 1e3 / fmax(state->num_steps + state->num_rejected, 1));
    report_share(self);
}

static ehd_status finish(runner *self, const run_totals *totals, ehd_error *error) {
    const march_state *state = &self->march.state;
    const time_run_task *task = self->task;
    const time_run_share share = task->share ? task->share(task->solver.self) : (time_run_share){0};
    const time_summary summary = {.full_steps = share.full_steps,
                                  .seconds_full = share.seconds_full,
                                  .seconds = totals->seconds,
                                  .num_steps = (size_t)state->num_steps,
                                  .num_rejected = (size_t)state->num_rejected,
                                  .newton_iterations = (size_t)state->num_iterations};

    if (!self->file) return EHD_OK;
    ehd_status status = write_waiting(self, error);
    return status ? status : time_result_finish(&self->file, &summary, error);
}

/* Returns the status of a march that has ended, with its message. */
static ehd_status judge(const runner *self, ehd_status outcome, ehd_error *error) {
    const time_run_task *task = self->task;
    const char *path = task->caller->arguments[0];
    const bool written = task->caller->output && task->again == AGAIN_NEVER;

    if (outcome == EHD_NOT_CONVERGED)
        return ehd_fail(error, EHD_NOT_CONVERGED, "%s: not converged: %s%s%s%s", path,
                        self->march.reason, written ? "; results up to there are in " : "",
                        written ? task->caller->output : "", written ? ".partial" : "");
    if (!isnan(self->march.state.untrusted_since) &&
        (!task->allow_untrusted || task->again == AGAIN_IF_POOR))
        return ehd_fail(error, EHD_UNTRUSTED,
                        "%s: found %s, first at T = %g, expected a result to be trusted%s", path,
                        self->march.untrusted, self->march.state.untrusted_since,
                        task->advice ? task->advice : "");
    return EHD_OK;
}

static bool is_taken_again(const runner *self, ehd_status outcome) {
    const time_run_again again = self->task->again;

    if (outcome == EHD_NOT_CONVERGED) return again != AGAIN_NEVER;
    return again == AGAIN_IF_POOR && !isnan(self->march.state.untrusted_since);
}

static ehd_status conclude(runner *self, ehd_status outcome, ehd_error *error) {
    const run_totals totals = totals_at(self, program_seconds());
    if (self->task->untrusted) {
        self->march.state.untrusted_since = 0;
        snprintf(self->march.untrusted, MARCH_REASON, "%s", self->task->untrusted);
    }
    if (is_taken_again(self, outcome)) return judge(self, outcome, error);
    ehd_status status = outcome == EHD_OK ? finish(self, &totals, error) : EHD_OK;

    if (status) return status;
    report(self, &totals, outcome);
    note_effect(self, &totals);
    traction_warn(self->task->caller, totals.max_friction);
    return judge(self, outcome, error);
}

/* Judges the contact at the largest factor of each history, because a table in a wrong unit makes
 * all factors too large or too small. Returns EHD_DATA for an impossible contact. */
static ehd_status judge_histories(const time_run_task *task, const ehd_histories *histories,
                                  ehd_error *error) {
    enum { NUM_TIMES = 200 };
    double largest[NUM_VARY] = {0}, values[NUM_VARY];
    const char *path = task->caller->arguments[0];

    if (isnan(task->reference->load)) return EHD_OK;
    for (int i = 0; i <= NUM_TIMES; i++) {
        histories_at(values, histories, task->given->transient.end_time * i / NUM_TIMES);
        for (int q = 0; q < NUM_VARY; q++)
            largest[q] = fmax(largest[q], fabs(values[q]));
    }
    for (int q = 0; q < VARY_APPROACH; q++) {
        char text[PLAUSIBLE_TEXT];
        ehd_contact contact;
        scene of = *task->given;
        double *const scaled[] = {[VARY_LOAD] = &of.physical.load,
                                  [VARY_SPEED] = &of.physical.speed,
                                  [VARY_RADIUS] = &of.physical.radius,
                                  [VARY_MODULUS] = &of.physical.modulus};
        of.physical.speed = scene_speed(task->given);
        *scaled[q] *= largest[q];
        const bool moves = largest[q] > 0 && largest[q] != 1;
        if (!moves || scene_contact_derive(&contact, &of, NULL)) continue;
        const plausibility found = scene_judge(text, &contact, &of);
        if (found == IMPOSSIBLE)
            return ehd_fail(error, EHD_DATA,
                            "%s: transient.%s: found at most %.3g times the reference, where %s",
                            path, vary_names[q], largest[q], text);
        if (found == IMPLAUSIBLE)
            program_warn(task->caller, "%s: transient.%s: found up to %.3g times the reference: %s",
                         path, vary_names[q], largest[q], text);
    }
    return EHD_OK;
}

static ehd_status prepare(runner *self, ehd_histories **histories, ehd_error *error) {
    const time_run_task *task = self->task;
    const ehd_grid *grid = &task->reference->grid;
    size_t num_nodes = grid->num_nodes;
    bool whole;
    ehd_status status =
        (task->models ? histories_init_forward : histories_init)(histories, task->given, error);

    if (!status) status = judge_histories(task, *histories, error);
    if (status) return status;
    if (histories_in_seconds(*histories) && !task->given->transient.end_in_seconds)
        program_note(task->caller,
                     "transient.end_time: found T = %g without a unit beside tables in seconds, "
                     "which is %.3g ms",
                     task->given->transient.end_time,
                     1e3 * task->given->transient.end_time * contact_time_scale(task->reference));
    const char *table = histories_without_unit(*histories);
    if (table)
        program_note(task->caller,
                     "%s: found a column without a unit: times are taken as T, values as factors "
                     "on the reference (transient.time.unit, transient.load.unit)",
                     table);
    self->march =
        (march){.settings = march_settings_of(task->given, *histories, task->given->approach),
                .histories = *histories,
                .reference = task->reference,
                .store = store,
                .sink = self};
    self->march.settings.accuracy = task->accuracy;
    apart_init(&self->contact, task->solver, task->reference,
               isnan(task->given->transient.fixed_step) ? self->march.settings.first_step
                                                        : INFINITY);
    self->march.solver = apart_solver(&self->contact);
    const march_solver *solver = &self->march.solver;
    if (task->reference->surface) {
        const contact_frame start =
            march_frame(&self->march.settings, task->reference->kind, *histories, 0, 1);
        status = surface_check_start(task->reference->surface, &start, grid, error);
        if (status) return status;
    }
    self->restart = malloc((AT_SOLVER + solver->saved_size(solver->self)) * sizeof(double));
    const bool states =
        task->with_fields || (contact_has_traction(task->reference) && !solver->traction);
    if (states) {
        self->pressure = malloc(num_nodes * sizeof(double));
        self->film = malloc(num_nodes * sizeof(double));
    }
    self->exits = malloc(MAX_WAITING * grid_whole(grid).inner_lines * GRID_EXITS * sizeof(double));
    whole = self->restart && self->exits && (!states || (self->pressure && self->film));
    return whole ? EHD_OK : ehd_no_memory(error, "result");
}

ehd_status time_run(time_trace *trace, const time_run_task *task, ehd_error *error) {
    runner self = {
        .task = task, .trace = trace, .totals = {.min_film = INFINITY, .max_film = -INFINITY}};
    ehd_histories *histories = NULL;
    bool resumed = false;
    ehd_status outcome = EHD_OK;

    if (trace) memset(trace, 0, sizeof *trace);
    progress_start(&self.progress, task->caller, 1000);
    ehd_status status = prepare(&self, &histories, error);
    if (!status && task->resume && task->caller->output) status = resume(&resumed, &self, error);
    if (!status && !resumed) status = begin(&self, error);
    const bool begun = !status;
    if (begun) status = march_run(&outcome, &self.march, error);
    if (begun && self.file && (status || outcome == EHD_NOT_CONVERGED)) {
        ehd_error ignored;
        if (status && status != EHD_INTERRUPTED)
            write_waiting(&self, &ignored); // no checkpoint: an attempt may have changed the state
        else
            checkpoint(&self, program_seconds(), &ignored);
    }
    progress_finish(&self.progress);
    if (status == EHD_INTERRUPTED)
        ehd_fail(error, status, "interrupted at T = %g%s", self.march.state.time,
                 self.file ? "; --resume goes on" : "");
    if (!status) status = conclude(&self, outcome, error);
    artefact_close(&self.file);
    histories_free(histories);
    free(self.restart);
    free(self.pressure);
    free(self.film);
    free(self.exits);
    return status;
}
