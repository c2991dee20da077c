/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes and reads the result of a transient scene: a result.h5 whose axis `time` grows during the
 * run. Other programs can read the file meanwhile, and a run can be resumed after a kill. */
#ifndef EHD_TIME_RESULT_H
#define EHD_TIME_RESULT_H

#include "common/artefact/artefact.h"
#include "common/physics/traction.h"
#include "common/program/arena.h"
#include "common/program/program.h"
#include "common/program/solve_seconds.h"
#include "common/program/status.h"
#include "common/settings/scene.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Results at one point in time. Numbers are dimensionless and in the reference frame unless noted
 * otherwise. NaN: the value is not known. */
typedef struct time_entry {
    double time; // T, increasing from entry to entry
    contact_scalars scalars;
    double contact_half_width;   // half width of the current frame, relative to the reference
    double frame_hertz_pressure; // Hertz pressure of the current frame, relative to the reference
    double frame_film_unit;      // a^2/R of the current frame, relative to the reference
    double surface_position;     // only if a surface is not smooth
    const double *exits; // [lines of the whole grid, GRID_EXITS], in the order of march_solver
    size_t newton_iterations;
    double residual;
    ehd_status status;                   // EHD_OK, EHD_NOT_CONVERGED or EHD_UNTRUSTED
    bool by_full_model;                  // only in a file `with_models`
    double step;                         // length of the time step that ends here; 0 at the start
    double effect, effect_minimum;       // effect of the time steps on the films, as in march_step
    double indicated, indicated_minimum; // error estimates of the films, as in march_step
    contact_traction traction;           // in the reference frame; unknown without traction
    const ehd_contact *frame;            // contact in the frame of the fields; NULL: no traction
    const double *pressure; // [num_nodes] in the current frame, NULL: no field at this time
    const double *film;     // [num_nodes] in the current frame, NULL: no field at this time
} time_entry;

/* Totals at the end of a run. */
typedef struct time_summary {
    solve_seconds seconds;
    size_t num_steps;         // accepted time steps
    size_t num_rejected;      // number of steps that were rejected and repeated with a shorter step
    size_t newton_iterations; // iterations of all steps, rejected ones included
    // only in a file `with_models`:
    size_t full_steps;   // accepted steps of the full model
    double seconds_full; // time of the full model, all attempts
} time_summary;

/* Creates caller->output and starts streaming: other programs can read the file while it is
 * written. Errors: see artefact_create.
 * - `with_fields`: the file has pressure and film, at least at some points in time.
 * - `with_all_exits`: the file has the exit of every interval of pressure, for entrainment that
 *   reverses. Otherwise it has one exit per line.
 * - `with_models`: the file stores which model solved each time step.
 * - `restart_size`: how many numbers a run needs to continue; 0: the run cannot be resumed.
 * - `inputs`: paths, NULL at the end. */
ehd_status time_result_create(
    // output:
    artefact **file, // give to time_result_finish; artefact_close leaves NAME.partial
    // input:
    const program *caller, const ehd_contact *reference, const char *settings_text,
    const char *const *inputs, bool with_fields, bool with_all_exits, bool with_models,
    size_t restart_size, ehd_error *error);

/* Writes `count` entries from `index` on, counted from 0, and flushes them for readers. The axis
 * `time` grows last, so that the data of a time are in the file before readers see the time.
 * Returns EHD_INTERNAL for fields in a file without fields. Other errors: EHD_IO, EHD_MEMORY. */
ehd_status time_result_append(artefact *file, const ehd_grid *grid, const time_entry *entries,
                              size_t count, size_t index, ehd_error *error);

/* Stores a checkpoint, from which a run can continue after entry num_entries - 1. The file has two
 * slots for checkpoints, which are used in turn. The number of entries of a slot is deleted first
 * and written last, so that a kill at any moment leaves one slot whole. */
ehd_status time_result_checkpoint(artefact *file,
                                  const double *restart, // [restart_size] of the file
                                  size_t num_entries, ehd_error *error);

/* Opens the unfinished result NAME.partial of an interrupted run, so that this run can continue it.
 * Other programs can read the file while it is written. Removes the entries after the last complete
 * checkpoint; this run computes them again. Errors:
 * - EHD_NOINPUT: there is no such file
 * - EHD_DATA: the file is damaged, or its settings, model, tables, grid or restart_size differ
 * - EHD_CANTCREATE: as artefact_resume */
ehd_status time_result_resume(
    // output:
    artefact **file,
    double *restart,     // [restart_size], zeros when *num_entries is 0
    size_t *num_entries, // 0: there was no checkpoint yet
    // input:
    const program *caller, const ehd_contact *reference, const char *settings_text,
    const char *const *models, // paths of the model files, ended by NULL; NULL: no model was used
    const scene *given,        // names the tables that are read
    size_t restart_size, ehd_error *error);

/* Ends streaming, writes the summary and gives the file its final name. The file is closed in any
 * case; on failure NAME.partial stays. */
ehd_status time_result_finish(artefact **file, const time_summary *summary, ehd_error *error);

/* Scalars of a result over time. A stationary result has one point in time. A file of another
 * program may lack values, which are then NaN. */
typedef struct time_series {
    ehd_grid grid; // whole grid; it has no nodes for a line contact without fields
    double moes_M, moes_L, alpha_p_H;
    flow_thinning thinning;
    double hertz_pressure; // Pa
    size_t num_times;
    double *time; // [num_times], like all arrays below; 0 if stationary
    double *central_film_thickness;
    double *minimum_film_thickness;
    double *central_pressure;
    double *load;
    double *friction_coefficient;
    arena memory;
} time_series;

/* Reads the scalars of a result over time. Errors: see artefact_open. Also returns EHD_DATA for
 * another kind of contact, for times that do not increase, and for several points in time if the
 * axis `time` has no values. */
ehd_status time_series_read(
    // output:
    time_series *series, // free with time_series_free, also after a failure
    // input:
    const char *path, const contact_kind *kind, ehd_error *error);

void time_series_free(time_series *series);

#endif
