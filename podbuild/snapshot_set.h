/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Training solutions gathered from snapshot and result files. */
#ifndef EHD_SNAPSHOT_SET_H
#define EHD_SNAPSHOT_SET_H

#include "common/output/film_effects.h"
#include "common/physics/contact.h"
#include "common/physics/traction.h"
#include "common/program/status.h"
#include "podbuild/snapshot_files.h"
#include "romrun/model/reduced_model.h"
#include <stdbool.h>
#include <stddef.h>

typedef struct snapshot_set {
    const contact_kind *kind;
    ehd_grid grid;
    const char *transported; // path of the first file with trajectories, or NULL
    ehd_carriage carriage;   // how films are carried on these trajectories
    size_t num_states;
    size_t num_left_out;            // number of states that had not converged
    double *pressure;               // [num_states, num_nodes], boundary nodes included
    double *rigid_approach;         // [num_states]
    size_t *exit;                   // [num_states, lines of the grid] first column without pressure
    double *moes_M, *alpha_p_H;     // [num_states]
    flow_thinning *thinning;        // [num_states] thinning of the flow
    double *central_film_thickness; // [num_states]
    bool *stationary;               // [num_states] false on a trajectory, except at its start
    double *rate,
        *load_rate; // [num_states] rates of change of the contact and of its load (frame_rates); 0
                    // if stationary
    film_effects *effects;  // [num_states] error estimates of the grid
    lubricant_rises *rises; // [num_states] of viscosity and density, at the Hertz pressure
    // the basis is built from these: the stationary states, and the compressed steps of
    // trajectories
    size_t num_snapshots;
    double *snapshots; // [num_snapshots, num_nodes]
} snapshot_set;

/* Reads the converged states of all files, in order. Errors as artefact_get; EHD_MEMORY. */
ehd_status snapshot_set_read(
    // output:
    snapshot_set *set, // free with snapshot_set_free
    // input:
    snapshot_files *files, ehd_error *error);

/* Allocates a set without fields (`pressure` and `snapshots` are NULL), to which the states of the
 * files are then added. Errors: EHD_MEMORY. */
ehd_status snapshot_set_begin(
    // output:
    snapshot_set *set, // free with snapshot_set_free
    // input:
    const snapshot_files *files, ehd_error *error);

/* Returns the memory of a set without fields, bytes. */
double snapshot_set_bytes(const snapshot_files *files);

/* Appends a state, given by the columns of its file and its pressure. The pressure gives the exit
 * and is not stored. */
void snapshot_set_add(snapshot_set *set, const double *pressure, const file_states *states,
                      size_t state);

/* Appends the states of a part. */
void snapshot_set_add_reduced(snapshot_set *set, const reduced_states *states);

/* A stationary solution in memory. */
typedef struct solved_state {
    const double *pressure; // [num_nodes]
    double rigid_approach, moes_M, alpha_p_H;
    flow_thinning thinning;
    double central_film_thickness;
    lubricant_rises rises; // at the Hertz pressure
} solved_state;

/* Makes a set of stationary solutions in memory. The basis is built from all of them. Errors:
 * EHD_MEMORY. */
ehd_status snapshot_set_gather(
    // output:
    snapshot_set *set, // free with snapshot_set_free
    // input:
    const solved_state *states, size_t num_states, const contact_kind *kind, const ehd_grid *grid,
    ehd_error *error);

void snapshot_set_free(snapshot_set *set);

#endif
