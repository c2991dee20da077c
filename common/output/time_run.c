/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/output/time_run.h"

#include "common/output/time_result.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double CHECKPOINT_PAUSE = 2; // s between two checkpoints

enum { NUM_MARCH = sizeof(march_state) / sizeof(double), NUM_OWN = NUM_MARCH + 1 };

typedef struct runner {
    const time_run_task *task;
    march march;
    artefact *file; // NULL: nothing is written
    double *restart;
    double *pressure, *film; // [num_nodes], NULL: no fields
    double last_checkpoint;
    double seconds; // writing not counted
    double least_film, most_film;
    time_trace *trace;
    progress progress;
} runner;

void time_trace_free(time_trace *trace) {
    free(trace->time);
    free(trace->central_film_thickness);
    free(trace->central_pressure);
    memset(trace, 0, sizeof *trace);
}

static ehd_status trace_add(time_trace *trace, const time_entry *entry, ehd_error *error) {
    if (trace->count == trace->capacity) {
        size_t capacity = 2 * trace->capacity + 1024;
        double **const columns[] = {&trace->time, &trace->central_film_thickness,
                                    &trace->central_pressure};
        for (size_t i = 0; i < sizeof columns / sizeof *columns; i++) {
            double *larger = realloc(*columns[i], capacity * sizeof **columns[i]);
            if (!larger) return ehd_fail(error, EHD_MEMORY, "trace: found no memory");
            *columns[i] = larger;
        }
        trace->capacity = capacity;
    }
    trace->time[trace->count] = entry->time;
    trace->central_film_thickness[trace->count] = entry->central_film_thickness;
    trace->central_pressure[trace->count++] = entry->central_pressure;
    return EHD_OK;
}

// ---- storing

static ehd_status checkpoint(runner *self, size_t num_entries, ehd_error *error) {
    const march_solver *solver = &self->march.solver;

    memcpy(self->restart, &self->march.state, sizeof self->march.state);
    self->restart[NUM_MARCH] = self->march.settings.reference_approach;
    solver->save(self->restart + NUM_OWN, solver->self);
    self->last_checkpoint = program_seconds();
    return time_result_checkpoint(self->file, self->restart, num_entries, error);
}

/* Entry `march_step` of the file, with fields at every N-th step. */
static ehd_status store(void *sink, const march_step *step, size_t index, ehd_error *error) {
    runner *self = sink;
    double before = program_seconds();
    const march_solver *solver = &self->march.solver;
    contact_scalars scalars =
        frame_to_reference(&step->scalars, &step->frame, self->task->reference->kind);
    bool fields = self->pressure && index % (size_t)self->task->given->fields_every == 0;
    ehd_status status = EHD_OK;
    char shown[64];

    if (fields) status = solver->fields(self->pressure, self->film, solver->self, error);
    const time_entry entry = {.time = step->frame.time,
                              .central_film_thickness = scalars.central_film_thickness,
                              .minimum_film_thickness = scalars.minimum_film_thickness,
                              .central_pressure = scalars.central_pressure,
                              .rigid_approach = scalars.rigid_approach,
                              .load = scalars.load,
                              .contact_half_width = step->frame.half_width,
                              .exit_position = scalars.exit_position,
                              .newton_iterations = step->iterations,
                              .residual = step->residual,
                              .status = step->status,
                              .step = step->step,
                              .pressure = fields ? self->pressure : NULL,
                              .film = fields ? self->film : NULL};
    self->least_film = fmin(self->least_film, entry.minimum_film_thickness);
    self->most_film = fmax(self->most_film, entry.central_film_thickness);
    if (!status && self->file) status = time_result_append(self->file, &entry, index, error);
    if (!status && self->trace) status = trace_add(self->trace, &entry, error);
    if (!status && self->file && before - self->last_checkpoint > CHECKPOINT_PAUSE)
        status = checkpoint(self, index + 1, error);
    snprintf(shown, sizeof shown, "T = %.4g, step %.2g", entry.time, entry.step);
    progress_show(&self->progress, (size_t)(1000 * entry.time / self->task->given->end_time),
                  shown);
    self->seconds -= program_seconds() - before;
    return status;
}

// ---- start and resumption

static ehd_status resume(bool *resumed, runner *self, ehd_error *error) {
    const time_run_task *task = self->task;
    const march_solver *solver = &self->march.solver;
    size_t size = NUM_OWN + solver->saved_size(solver->self), num_entries = 0;
    ehd_status status = time_result_resume(&self->file, self->restart, &num_entries, task->caller,
                                           task->reference, task->settings_text, size, error);

    *resumed = false;
    if (status == EHD_NOINPUT) return EHD_OK;
    if (status || num_entries == 0) {
        artefact_close(&self->file);
        return status;
    }
    memcpy(&self->march.state, self->restart, sizeof self->march.state);
    self->march.settings.reference_approach = self->restart[NUM_MARCH];
    status = solver->restore(solver->self, self->restart + NUM_OWN, error);
    *resumed = !status;
    if (!status)
        program_note(task->caller, "%s.partial: goes on at T = %g", task->caller->output,
                     self->march.state.time);
    return status;
}

static ehd_status begin(runner *self, ehd_error *error) {
    const time_run_task *task = self->task;
    const march_solver *solver = &self->march.solver;
    size_t size = NUM_OWN + solver->saved_size(solver->self);
    march_step first;
    ehd_status status = EHD_OK;

    if (task->caller->output)
        status = time_result_create(&self->file, task->caller, task->reference, task->settings_text,
                                    task->inputs, task->with_fields, size, error);
    if (!status) status = march_begin(&first, &self->march, error);
    if (!status && first.status == EHD_NOT_CONVERGED)
        return ehd_fail(error, EHD_NOT_CONVERGED, "start: found it not converged: %s",
                        first.reason);
    return status ? status : store(self, &first, 0, error);
}

// ---- the end

static void report(const runner *self) {
    const ehd_contact *contact = self->task->reference;
    const march_state *state = &self->march.state;
    double scale = contact_film_scale(contact) * 1e6;

    printf("%-24sM = %.6g, L = %.6g, alpha p_H = %.6g, p_H = %.6g GPa\n", "reference",
           contact->moes_M, contact->moes_L, contact->alpha_p_H, contact->hertz_pressure * 1e-9);
    printf("%-24sT = 0 to %.6g in %.0f steps, %.0f more rejected\n", "time", state->time,
           state->num_steps, state->num_rejected);
    printf("%-24s%.8g", "smallest film", self->least_film);
    if (isfinite(scale)) printf("      %.6g µm", self->least_film * scale);
    printf("\n%-24s%.8g", "largest central film", self->most_film);
    if (isfinite(scale)) printf("      %.6g µm", self->most_film * scale);
    printf("\n%-24s%.0f, %.3g a step\n", "Newton iterations", state->num_iterations,
           state->num_iterations / fmax(state->num_steps + state->num_rejected, 1));
    printf("%-24s%.4g s, %.4g ms a step\n", "solution", self->seconds,
           self->seconds * 1e3 / fmax(state->num_steps + state->num_rejected, 1));
}

static ehd_status finish(runner *self, ehd_error *error) {
    const march_state *state = &self->march.state;
    time_summary summary = {.seconds = self->seconds,
                            .num_steps = (size_t)state->num_steps,
                            .num_rejected = (size_t)state->num_rejected,
                            .newton_iterations = (size_t)state->num_iterations};

    self->task->effort(&summary.seconds_rows, &summary.seconds_linear, &summary.seconds_exit,
                       self->march.solver.self);
    return self->file ? time_result_finish(&self->file, &summary, error) : EHD_OK;
}

/* What the end of the march means for the caller. */
static ehd_status judge(const runner *self, ehd_status outcome, ehd_error *error) {
    const time_run_task *task = self->task;
    const char *path = task->caller->arguments[0];
    bool written = task->caller->output != NULL;

    if (outcome == EHD_NOT_CONVERGED)
        return ehd_fail(error, EHD_NOT_CONVERGED, "%s: not converged: %s%s%s%s", path,
                        self->march.reason, written ? "; results up to there are in " : "",
                        written ? task->caller->output : "", written ? ".partial" : "");
    if (!isnan(self->march.state.untrusted_since) && !task->allow_untrusted)
        return ehd_fail(error, EHD_UNTRUSTED,
                        "%s: found %s, first at T = %g, expected a result to be trusted "
                        "(--allow-untrusted takes it all the same)",
                        path, self->march.untrusted[0] ? self->march.untrusted : "untrusted steps",
                        self->march.state.untrusted_since);
    return EHD_OK;
}

static ehd_status prepare(runner *self, ehd_histories **histories, ehd_error *error) {
    const time_run_task *task = self->task;
    const march_solver *solver = &task->solver;
    size_t num_nodes = task->reference->grid.num_nodes;
    ehd_status status = histories_init(histories, task->given, error);

    if (status) return status;
    self->march =
        (march){.settings = march_settings_of(task->given, *histories, task->given->approach),
                .histories = *histories,
                .kind = task->reference->kind,
                .solver = *solver,
                .store = store,
                .sink = self};
    self->restart = malloc((NUM_OWN + solver->saved_size(solver->self)) * sizeof(double));
    if (task->with_fields) {
        self->pressure = malloc(num_nodes * sizeof(double));
        self->film = malloc(num_nodes * sizeof(double));
    }
    if (!self->restart || (task->with_fields && (!self->pressure || !self->film)))
        return ehd_fail(error, EHD_MEMORY, "result: found no memory for %zu nodes", num_nodes);
    return EHD_OK;
}

ehd_status time_run(time_trace *trace, const time_run_task *task, ehd_error *error) {
    runner self = {.task = task, .trace = trace, .least_film = INFINITY, .most_film = -INFINITY};
    ehd_histories *histories = NULL;
    bool resumed = false;
    ehd_status outcome = EHD_OK;

    if (trace) memset(trace, 0, sizeof *trace);
    progress_start(&self.progress, task->caller, 1000);
    ehd_status status = prepare(&self, &histories, error);
    double before = program_seconds();
    self.last_checkpoint = before;
    if (!status && task->resume && task->caller->output) status = resume(&resumed, &self, error);
    if (!status && !resumed) status = begin(&self, error);
    if (!status) status = march_run(&outcome, &self.march, error);
    if (self.file && (status == EHD_INTERRUPTED || outcome == EHD_NOT_CONVERGED)) {
        ehd_error ignored;
        checkpoint(&self, (size_t)self.march.state.num_steps + 1, &ignored);
    }
    progress_finish(&self.progress);
    self.seconds += program_seconds() - before;
    if (status == EHD_INTERRUPTED)
        ehd_fail(error, status, "interrupted at T = %g%s", self.march.state.time,
                 self.file ? "; --resume goes on" : "");
    if (!status && outcome == EHD_OK) status = finish(&self, error);
    if (!status) report(&self);
    if (!status) status = judge(&self, outcome, error);
    artefact_close(&self.file);
    histories_free(histories);
    free(self.restart);
    free(self.pressure);
    free(self.film);
    return status;
}
