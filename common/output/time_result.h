/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The result of a transient scene: a result.h5 whose axis `time` grows while the run goes on. It
 * can be followed by other readers, and resumed after a kill. */
#ifndef EHD_TIME_RESULT_H
#define EHD_TIME_RESULT_H

#include "common/artefact/artefact.h"
#include "common/physics/traction.h"
#include "common/program/program.h"
#include "common/program/status.h"
#include "common/settings/scene.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* One time. Numbers are dimensionless and in the reference frame, unless said otherwise; NaN stands
 * for "not known". */
typedef struct time_entry {
    double time; // T, increasing from entry to entry
    double central_film_thickness;
    double minimum_film_thickness;
    double central_pressure;
    double rigid_approach;
    double load;               // relative to the reference
    double contact_half_width; // of the frame, relative to the reference; so are the next two
    double frame_hertz_pressure;
    double frame_film_unit;  // a^2/R
    double surface_position; // of a contact with a surface
    const double *exits;     // [lines of the whole grid, GRID_EXITS] as of march_solver
    size_t newton_iterations;
    double residual;
    ehd_status status;                   // EHD_OK, EHD_NOT_CONVERGED or EHD_UNTRUSTED
    bool by_full_model;                  // in a file `with_models`
    double step;                         // of the integration that led here, 0 at the start
    double effect, effect_minimum;       // of the steps in time on the films, as in march_step
    double indicated, indicated_minimum; // deviation of the films, as in march_step
    contact_traction traction;           // in the reference frame, where the reference has it
    const ehd_contact *frame;            // of the fields; NULL: without traction
    const double *pressure; // [num_nodes] in the current frame, NULL: no field at this time
    const double *film;     // [num_nodes] in the current frame, NULL: no field at this time
} time_entry;

/* What is known at the end of a run. */
typedef struct time_summary {
    double seconds; // of the solution, without reading and writing
    double seconds_rows, seconds_linear, seconds_exit; // parts of it; NaN: not measured apart
    size_t num_steps;                                  // accepted ones
    size_t num_rejected;      // steps that were taken again with a shorter one
    size_t newton_iterations; // of all steps, rejected ones too
    // in a file `with_models`:
    size_t full_steps;   // accepted ones of the full model
    double seconds_full; // all that it took
} time_summary;

/* Starts caller->output, streaming. `with_fields`: pressure and film at some times at least;
 * `with_all_exits`: of every interval of pressure, as where the entrainment reverses, else one a line;
 * `with_models`: which model solved each time.
 * `restart_size`: numbers that a run needs to go on, 0: it cannot be resumed. `inputs`: paths, NULL
 * at the end. Errors as artefact_create. */
ehd_status time_result_create(
    // output:
    artefact **file, // give to time_result_finish; artefact_close leaves NAME.partial
    // input:
    const program *caller, const ehd_contact *reference, const char *settings_text,
    const char *const *inputs, bool with_fields, bool with_all_exits, bool with_models,
    size_t restart_size, ehd_error *error);

/* Writes `count` entries from `index` on, counted from 0, and lets readers see them. `time` grows
 * last, so that all that belongs to a time is there when the time is. EHD_IO; EHD_MEMORY;
 * EHD_INTERNAL for fields in a file without. */
ehd_status time_result_append(artefact *file, const ehd_grid *grid, const time_entry *entries,
                              size_t count, size_t index, ehd_error *error);

/* Stores what a run needs to go on after entry num_entries - 1. There are two slots, used in turn,
 * each with its number of entries: taken away first and written last, so that a kill at any moment
 * leaves one of them whole. */
ehd_status time_result_checkpoint(artefact *file,
                                  const double *restart, // [restart_size] of the file
                                  size_t num_entries, ehd_error *error);

/* Opens NAME.partial of an earlier run, streaming again, and drops the entries after its last whole
 * checkpoint, which are to be computed again. EHD_NOINPUT when there is none; EHD_DATA when it is
 * damaged, or its settings, model, tables, grid or restart_size differ; EHD_CANTCREATE as
 * artefact_resume. */
ehd_status time_result_resume(
    // output:
    artefact **file,
    double *restart,     // [restart_size], zeros when *num_entries is 0
    size_t *num_entries, // 0: there was no checkpoint yet
    // input:
    const program *caller, const ehd_contact *reference, const char *settings_text,
    const char *const *models, // paths, ended by NULL; NULL: none
    const scene *given,        // says which tables are read
    size_t restart_size, ehd_error *error);

/* Ends streaming, writes the summary and gives the file its name. The file is closed in any case;
 * on failure NAME.partial stays. */
ehd_status time_result_finish(artefact **file, const time_summary *summary, ehd_error *error);

/* The scalars of a result over time, whoever wrote it; one time when stationary. Reals that a
 * foreign file need not have are NaN where they are missing, integers -1. */
typedef struct time_series {
    ehd_grid grid; // whole; no nodes: a line without fields, of which not all is known
    double moes_M, moes_L, alpha_p_H;
    flow_thinning thinning;
    double hertz_pressure; // Pa
    size_t num_times;
    double *time; // [num_times], as all that follow; 0 when stationary
    double *central_film_thickness;
    double *minimum_film_thickness;
    double *central_pressure;
    double *rigid_approach;
    double *load;
    double *contact_half_width;
    double *frame_hertz_pressure;
    double *frame_film_unit;
    double *exit_position; // the farthest downstream at Y = 0
    double *residual_norm;
    double *time_step;
    double *time_effect, *time_effect_minimum;
    double *indicated_deviation, *indicated_deviation_minimum;
    double *friction_coefficient;
    int64_t *newton_iterations;
    int64_t *status;
} time_series;

/* Errors as artefact_open; EHD_DATA also for another kind of contact, times that do not increase,
 * and several times without a scale that tells them. */
ehd_status time_series_read(
    // output:
    time_series *series, // free with time_series_free, also after a failure
    // input:
    const char *path, const contact_kind *kind, ehd_error *error);

void time_series_free(time_series *series);

#endif
