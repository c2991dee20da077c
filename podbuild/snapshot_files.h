/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The files that training solutions come from, before their fields are read: snapshots, results and
 * parts of a training that were compressed (part_file.h). */
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

/* One file's states before it is known which of them converged. */
typedef struct file_states {
    size_t count;
    double *rigid_approach, *moes_M, *alpha_p_H, *central_film_thickness; // [count]
    double *sliding, *gradient; // [count] of flow_thinning
    int64_t *outcome;           // [count]
    // of trajectories: index, -1 for a stationary point; time and rate
    int64_t *trajectory;             // [count]
    double *time, *rate, *load_rate; // [count]
    double *effects[NUM_EFFECTS];    // [count]
    double *rises[NUM_RISES];        // [count]
    double *memory;
} file_states;

typedef struct snapshot_file {
    const char *path;
    artefact *file;     // NULL while it is closed
    bool is_part;       // then it has no columns here, and its rows are modes times singular values
    part_origin origin; // of a part
    double *values;     // [num_rows] its singular values
    file_states states; // columns of a file of snapshots or a result
    size_t num_states;  // that have converged
    size_t num_rows;    // that a basis is made of: stationary states, and what is compressed
} snapshot_file;

typedef struct snapshot_files {
    const contact_kind *kind;
    ehd_grid grid;
    const char *transported; // the first file with trajectories, or NULL
    ehd_carriage carriage;   // of these
    size_t num_files;
    snapshot_file *files;        // [num_files]
    size_t num_parts;            // of them
    size_t num_states, num_rows; // of all files
    size_t num_left_out;         // states that had not converged
} snapshot_files;

/* Opens all files and reads what is known of their states. EHD_DATA: no converged state, files of
 * different grids, values that are not finite; else as artefact_open. */
ehd_status snapshot_files_open(
    // output:
    snapshot_files *self, // give to snapshot_files_close
    // input:
    const char *const *paths, size_t num_paths, ehd_error *error);

void snapshot_files_close(snapshot_files *self); // also of one that was not opened

/* Has this file open, of many files only until snapshot_file_leave. */
ehd_status snapshot_file_use(snapshot_files *self, size_t index, ehd_error *error);
void snapshot_file_leave(snapshot_files *self, size_t index);

/* A pressure of a file in use: of one of its states, or a row that is compressed. Boundary nodes are
 * included. */
ehd_status snapshot_file_state(double *pressure, const snapshot_files *self, size_t index,
                               size_t state, ehd_error *error);
ehd_status snapshot_file_row(double *pressure, const snapshot_files *self, size_t index, size_t row,
                             ehd_error *error);
/* A mode of a part in use. */
ehd_status snapshot_file_mode(double *mode, const snapshot_files *self, size_t index, size_t row,
                              ehd_error *error);
/* Number of such rows, of a part the modes. */
size_t snapshot_file_compressed(const snapshot_files *self, size_t index);

#endif
