/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The state at nodes: pressure and film at those that the rows need, and in the band, for
 * coordinates z and an exit line. Owns the exit line that everything else is for. */
#ifndef EHD_NODE_STATE_H
#define EHD_NODE_STATE_H

#include "romrun/model/reduced_cut.h"
#include "romrun/online/reduced_solver.h"

/* What coordinates come to at the present exit line. */
typedef struct node_fields {
    reduced_values values;   // at the exit's checkpoint, unless they were known
    double *pressure, *film; // [num_needed] P, zero behind the exit; H without gap of a step
    double *cut;             // [rows of the cut table] the cut table times z
} node_fields;

typedef struct node_state {
    const reduced_model *model;
    size_t *exit;      // [num_lines] what follows is for; 0: none yet
    bool *alive;       // [num_needed] before the exit
    size_t checkpoint; // of the exit
    cut_run *runs;     // [num_lines] by which the exit differs from that one's
    size_t num_runs;
    node_fields now, step; // of the state worked on, of a Newton step
    double *band_pressure; // [nodes of the band] P there, filled where asked for
} node_state;

/* Memory from an arena; the model must outlive it. */
void nodes_init(node_state *self, const reduced_model *model, arena *memory);

/* Makes the exit line the one that what follows is for: which needed nodes lie before it, its
 * checkpoint and runs. */
void nodes_move_exit(node_state *self, const size_t *exit);

/* The cut table of the exit's checkpoint, [rows of the cut table, num_pressure]. */
const double *nodes_checkpoint_table(const node_state *self);

/* P and H (without gap) at the needed nodes, and what the cut table makes of P, for coordinates z
 * at the exit line: eq. 36 of Maier et al. (2015) applied to a vector. Values of z that are known
 * (else NULL) serve where they are of the same checkpoint. */
void nodes_expand(node_fields *fields, node_state *self, const reduced_values *known,
                  const double *z);

/* The state worked on: P, H with gap, and what the cut table makes of it, into self->now. */
void nodes_expand_state(node_state *self, const reduced_values *known, const double *z);

/* Brings self->now.values, which must not have been known before, to the state plus `factor` of the
 * step. */
void nodes_add_step(node_state *self, double factor);

/* H or P at X = 0 from values at the needed nodes. */
double nodes_at_centre(const reduced_model *model, const double *values);

/* Load of the state expanded last, over the kind's unit. */
double nodes_load(const node_state *self);

/* P at `count` band nodes from place `first` on; at those of a line contact from node `from` up to
 * before `to`; at those by which the exit differs from its checkpoint's. */
void nodes_expand_places(node_state *self, const double *z, size_t first, size_t count);
void nodes_expand_band(node_state *self, const double *z, size_t from, size_t to);
void nodes_expand_runs(node_state *self, const double *z);

/* H at `count` neighbouring nodes of a line of the band, and at one. For the coupled basis
 * nodes_expand_runs or nodes_expand_band must have filled the pressures by which the exit differs
 * from its checkpoint's. */
void nodes_band_films(double *film, const node_state *self, const double *z, size_t node,
                      size_t count);
double nodes_band_film(const node_state *self, const double *z, size_t node);

/* Smallest nodal H of the state expanded last, of those in the band and the needed ones. */
double nodes_minimum_film(node_state *self, const double *z);

/* Adds dH/dz at a needed node, times a factor, to [num_unknowns]; but for the rigid approach. */
void nodes_add_film_row(double *target, double factor, const node_state *self, size_t needed);

/* What a step of the coordinates changes of H at X = 0. */
double nodes_central_change(node_state *self, const double *step);

/* target += factor * source. */
void nodes_add_row(double *target, double factor, const double *source, size_t count);

#endif
