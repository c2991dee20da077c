/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads training solutions from files (snapshots, results, parts of a training) or from memory.
 * States are converged solutions with their scalars. Rows are the pressure fields that the basis is
 * built from: stationary states, compressed steps of trajectories, or modes of parts.
 * Called by podbuild and, for solutions in memory, by snapgen. */
#ifndef EHD_SNAPSHOT_SET_H
#define EHD_SNAPSHOT_SET_H

#include "common/artefact/artefact.h"
#include "common/physics/contact.h"
#include "podbuild/part_file.h"
#include "romrun/model/reduced_model.h"
#include <stdbool.h>
#include <stddef.h>

/* One source: a file, or solutions in memory. */
typedef struct snapshot_source {
    const char *path;      // NULL: solutions in memory
    artefact *file;        // NULL: the file is closed, or the solutions are in memory
    const double **fields; // [num_states] pressures with boundary nodes; NULL: they are in the file
    bool is_part;          // the file is a part; its rows are modes times their singular values
    part_origin origin;    // origin of a part
    double *values;        // [num_rows] singular values of a part
    size_t num_states;     // converged states
    size_t *entry;         // [num_states] entries of the converged states in the file
    // Scalars of the states; empty for a part. The only coordinate is the rigid approach. Exits
    // are set only for solutions in memory.
    reduced_states states;
    size_t num_rows;       // number of rows: stationary states, then compressed steps of
                           // trajectories; the rows of a part are its modes
    size_t num_stationary; // number of rows that are stationary states
    size_t *row_state;     // [num_stationary] row r is the field of state row_state[r]
} snapshot_source;

typedef struct snapshot_set {
    const contact_kind *kind;
    ehd_grid grid;
    const char *transported; // path of the first file with trajectories, or NULL
    ehd_carriage carriage;   // how films are carried along these trajectories
    size_t num_sources;
    snapshot_source *sources;    // [num_sources]
    size_t num_parts;            // number of sources that are parts
    size_t num_states, num_rows; // sums over all sources
    size_t num_left_out;         // number of states that had not converged or were not trusted
    arena memory;                // memory of all arrays except the arrays in `states` of sources
} snapshot_set;

/* Opens all files and reads the scalars of their states, but no fields. Errors: EHD_DATA (no
 * converged state, files of different grids, or values that are not finite); other errors
 * as artefact_open. */
ehd_status snapshot_set_open(
    // output:
    snapshot_set *self, // give to snapshot_set_close
    // input:
    const char *const *paths, size_t num_paths, ehd_error *error);

/* A stationary solution in memory. */
typedef struct solved_state {
    const double *pressure; // [num_nodes], not copied
    double rigid_approach, moes_M, alpha_p_H;
    flow_thinning thinning;
    double central_film_thickness;
    lubricant_rises rises; // at the Hertz pressure
} solved_state;

/* Makes a set of solutions in memory. Error: EHD_MEMORY. */
ehd_status snapshot_set_gather(
    // output:
    snapshot_set *self, // give to snapshot_set_close
    // input:
    const solved_state *states, size_t num_states, const contact_kind *kind, const ehd_grid *grid,
    ehd_error *error);

void snapshot_set_close(snapshot_set *self); // also accepts a zero struct

/* Opens a source unless it is open. If there are many files, snapshot_set_leave closes the source
 * again. */
ehd_status snapshot_set_use(snapshot_set *self, size_t source, ehd_error *error);
void snapshot_set_leave(snapshot_set *self, size_t source);

/* Read a pressure field of an open source, [num_nodes] with boundary nodes: the field of a state,
 * the field of a row, or a mode of a part file. */
ehd_status snapshot_set_state(double *pressure, const snapshot_set *self, size_t source,
                              size_t state, ehd_error *error);
ehd_status snapshot_set_row(double *pressure, const snapshot_set *self, size_t source, size_t row,
                            ehd_error *error);
ehd_status snapshot_set_mode(double *mode, const snapshot_set *self, size_t source, size_t row,
                             ehd_error *error);

#endif
