/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Input files of podbuild, opened and checked before their fields are read: snapshots, results, and
 * compressed parts of a training (part_file.h). */
#ifndef EHD_SNAPSHOT_FILES_H
#define EHD_SNAPSHOT_FILES_H

#include "common/artefact/artefact.h"
#include "common/output/film_effects.h"
#include "common/output/grid_file.h"
#include "common/physics/contact.h"
#include "podbuild/part_file.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* All states of one file, converged or not. */
typedef struct file_states {
    size_t count;
    double *rigid_approach, *moes_M, *alpha_p_H, *central_film_thickness; // [count]
    double *sliding, *gradient; // [count] thinning by the sliding and by the pressure gradient
                                // (flow_thinning)
    int64_t *outcome;           // [count]
    // columns of trajectories: index (-1: stationary point), time, and rates of change
    int64_t *trajectory;             // [count]
    double *time, *rate, *load_rate; // [count]
    double *effects[NUM_EFFECTS];    // [count]
    double *rises[NUM_RISES];        // [count]
    double *memory;
} file_states;

typedef struct snapshot_file {
    const char *path;
    artefact *file; // NULL while it is closed
    bool is_part;   // states is then empty, and a row is a mode times its singular value
    part_origin origin;
    double *values;     // [num_rows] singular values of a part
    file_states states; // columns of a snapshot or result file
    size_t num_states;  // number of converged states
    size_t num_rows;    // number of rows that the basis is built from: stationary states and
                        // compressed rows
} snapshot_file;

typedef struct snapshot_files {
    const contact_kind *kind;
    ehd_grid grid;
    const char *transported; // path of the first file with trajectories, or NULL
    ehd_carriage carriage;   // how films are carried on these trajectories
    size_t num_files;
    snapshot_file *files;        // [num_files]
    size_t num_parts;            // number of files that are parts
    size_t num_states, num_rows; // sums over all files
    size_t num_left_out;         // number of states that had not converged
} snapshot_files;

/* Opens all files and reads the columns of their states, but no fields. EHD_DATA: no converged
 * state, files of different grids, or values that are not finite; else as artefact_open. */
ehd_status snapshot_files_open(
    // output:
    snapshot_files *self, // give to snapshot_files_close
    // input:
    const char *const *paths, size_t num_paths, ehd_error *error);

void snapshot_files_close(snapshot_files *self); // also accepts a zero struct

/* Opens the file `index` unless it is open. snapshot_file_leave closes it again if there are many
 * files. */
ehd_status snapshot_file_use(snapshot_files *self, size_t index, ehd_error *error);
void snapshot_file_leave(snapshot_files *self, size_t index);

/* Reads a pressure field of an open file, [num_nodes] with boundary nodes: of one of its states, or
 * one of its compressed rows. */
ehd_status snapshot_file_state(double *pressure, const snapshot_files *self, size_t index,
                               size_t state, ehd_error *error);
ehd_status snapshot_file_row(double *pressure, const snapshot_files *self, size_t index, size_t row,
                             ehd_error *error);
/* Reads a mode of a part that is open, [num_nodes] with boundary nodes. */
ehd_status snapshot_file_mode(double *mode, const snapshot_files *self, size_t index, size_t row,
                              ehd_error *error);
/* Returns the number of compressed rows of an open file; the number of modes of a part. */
size_t snapshot_file_compressed(const snapshot_files *self, size_t index);

#endif
