/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs a march, which is the solution of a transient scene step by step, and writes its result
 * file. Starts or resumes the march, stores entries and checkpoints, shows progress, and finishes
 * the file. Used for the full and the reduced model. */
#ifndef EHD_TIME_RUN_H
#define EHD_TIME_RUN_H

#include "common/program/program.h"
#include "common/settings/scene.h"
#include "common/time/march.h"

/* Contribution of the full model to a march of a reduced model that falls back on the full model.
 * If the run was resumed, the numbers include the steps of the earlier run. */
typedef struct time_run_share {
    size_t full_steps;                    // accepted steps of the full model
    double seconds_full, seconds_reduced; // seconds of all attempts
    double since;                         // T of the first step by the full model; NaN: none yet
    const char *reason;                   // why the full model was needed
} time_run_share;

/* Cases in which the caller replaces this run by another run. In such a case nothing is printed,
 * and the output stays unfinished. */
typedef enum time_run_again {
    AGAIN_NEVER,
    AGAIN_IF_LOST, // if the march ends early
    AGAIN_IF_POOR  // if the march ends early, or if a step is not to be trusted
} time_run_again;

/* Inputs of a run. */
typedef struct time_run_task {
    const program *caller; // nothing is written if caller->output is NULL
    const scene *given;
    const ehd_contact *reference;
    const char *settings_text;
    // paths of the files, besides the scene, from which the solver was made, with NULL at the end;
    // NULL: no such files
    const char *const *models;
    const char *input; // path of another file that was read; NULL: no other file was read
    march_solver solver;
    double accuracy; // a step is not to be trusted if its error estimate is larger; 0: no limit
    bool with_fields, resume, allow_untrusted;
    time_run_again again;
    const char *advice;    // advice after the message on untrusted steps; NULL: no advice
    const char *untrusted; // why no entry is to be trusted; NULL: each step is judged by itself
    /* Returns the contribution of the full model; NULL: the solver has no fallback. */
    time_run_share (*share)(const void *solver);
} time_run_task;

/* Central film and central pressure over time in the reference frame, for comparisons. */
typedef struct time_trace {
    size_t count, capacity;
    double *time, *central_film_thickness, *central_pressure; // [count]
} time_trace;
void time_trace_free(time_trace *trace);

/* Runs the scene and prints the short result. After a resumption, this is the result of the whole
 * trajectory. `trace` may be NULL. Returns EHD_NOT_CONVERGED if the march ended early; the results
 * so far stay in NAME.partial. Returns EHD_UNTRUSTED if a step was not to be trusted. The result is
 * then complete and written, unless another run follows. Other errors: see artefact_create,
 * time_result_resume and histories_init. */
ehd_status time_run(
    // output:
    time_trace *trace, // free with time_trace_free, also after a failure
    // input:
    const time_run_task *task, ehd_error *error);

#endif
