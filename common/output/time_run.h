/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A march from a scene to a result file: start or resumption, entries, checkpoints, progress, end.
 * The same for the full and the reduced model. */
#ifndef EHD_TIME_RUN_H
#define EHD_TIME_RUN_H

#include "common/program/program.h"
#include "common/settings/scene.h"
#include "common/time/march.h"

/* The full model's share of a march that falls back on it, so far, those of an earlier run that this
 * one resumes included. */
typedef struct time_run_share {
    size_t full_steps;                    // accepted steps of the full model
    double seconds_full, seconds_reduced; // of all attempts
    double since;                         // T of the first one; NaN: none yet
    const char *reason;                   // why
} time_run_share;

/* Where another run follows, in place of this one: nothing is printed, and the output stays unfinished. */
typedef enum time_run_again {
    AGAIN_NEVER,
    AGAIN_IF_LOST, // it ends early
    AGAIN_IF_POOR  // also where a step is not to be trusted
} time_run_again;

/* What a run asks for. */
typedef struct time_run_task {
    const program *caller; // its output may be NULL: nothing is written
    const scene *given;
    const ehd_contact *reference;
    const char *settings_text;
    // paths of what the solver was made of beside the scene, ended by NULL; NULL: nothing
    const char *const *models;
    const char *input; // path of another file that was read, NULL: none
    march_solver solver;
    double accuracy; // indicated to deviate by more, a step is not to be trusted; 0: it is
    bool with_fields, resume, allow_untrusted;
    time_run_again again;  // where another run follows
    const char *advice;    // behind the line that says so, what would help; NULL: nothing
    const char *untrusted; // why no entry is to be trusted; NULL: that is so of single ones only
    /* Seconds that this solver spent on parts of the work so far; NaN: not measured apart. */
    void (*effort)(double *rows, double *linear, double *exit, const void *solver);
    /* Of a solver that falls back on the full model; NULL: it does not. */
    time_run_share (*share)(const void *solver);
} time_run_task;

/* Central film over time, kept for comparisons. In the reference frame. */
typedef struct time_trace {
    size_t count, capacity;
    double *time, *central_film_thickness, *central_pressure; // [count]
} time_trace;
void time_trace_free(time_trace *trace);

/* Runs the scene and prints the short result, of the whole trajectory where an earlier run is
 * resumed. Where the march ends early, what it found so far stays in NAME.partial:
 * EHD_NOT_CONVERGED. EHD_UNTRUSTED: done and written (unless another run follows), but a step was not to
 * be trusted. `trace` may be NULL. Errors also as artefact_create, time_result_resume and histories_init. */
ehd_status time_run(
    // output:
    time_trace *trace, // free with time_trace_free, also after a failure
    // input:
    const time_run_task *task, ehd_error *error);

#endif
