/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The state at nodes: pressure and film of coordinates z, cut at an exit line, at the rows' needed
 * nodes and in the band. Owns the present exit line. */
#ifndef EHD_NODE_STATE_H
#define EHD_NODE_STATE_H

#include "romrun/model/reduced_cut.h"
#include "romrun/online/reduced_solver.h"

/* Fields of coordinates at the present exit line. */
typedef struct node_fields {
    reduced_values values;   // at the exit's checkpoint; not filled where the caller knew them
    double *pressure, *film; // [num_needed] P, zero behind the exit; H, of a step without gap
    double *cut;             // [rows of the cut table] the cut table times z
} node_fields;

typedef struct node_state {
    const reduced_model *model;
    size_t *exit;      // [num_lines] present exit line; 0: none yet
    bool *pressurised; // [num_needed] whether it lies before the exit
    size_t checkpoint; // nearest to the exit
    cut_run *runs;     // [num_lines] by which the exit differs from the checkpoint's
    size_t num_runs;
    node_fields now, step; // of the present state, of a Newton step
    double *band_pressure; // [nodes of the band] P, filled on demand
    double least_in_band;  // H, of nodes_minimum_film
    size_t lowest_in_band; // its node
} node_state;

/* Memory from an arena; the model must outlive it. */
void nodes_init(node_state *self, const reduced_model *model, arena *memory);

/* Sets the present exit line, and with it the nodes before it, its checkpoint and runs. */
void nodes_move_exit(node_state *self, const size_t *exit);

/* The cut table of the exit's checkpoint, [rows of the cut table, num_pressure]. */
const double *nodes_checkpoint_table(const node_state *self);

/* P, H without gap at the needed nodes and the cut table times z: Maier et al. (2015), eq. 36,
 * applied to a vector. `known`: values of z or NULL; used where they are of the same checkpoint.
 * */
void nodes_expand(node_fields *fields, node_state *self, const reduced_values *known,
                  const double *z);

/* The same, with gap, of the present state into self->now. */
void nodes_expand_state(node_state *self, const reduced_values *known, const double *z);

/* Adds `factor` times the step to self->now.values, which must have been filled. */
void nodes_add_step(node_state *self, double factor);

/* H or P at X = 0 from values at the needed nodes. */
double nodes_at_centre(const reduced_model *model, const double *values);

/* Load of the present state, the integral of P. */
double nodes_load(const node_state *self);

/* P at `count` band nodes from index `first` on; of a line contact from node `from` to before
 * `to`; at the nodes by which the exit differs from its checkpoint's. */
void nodes_expand_range(node_state *self, const double *z, size_t first, size_t count);
void nodes_expand_band(node_state *self, const double *z, size_t from, size_t to);
void nodes_expand_runs(node_state *self, const double *z);

/* H at `count` neighbouring nodes of a line of the band, and at one. For the coupled basis
 * nodes_expand_runs or nodes_expand_band must have filled the pressures of the runs. */
void nodes_band_films(double *film, const node_state *self, const double *z, size_t node,
                      size_t count);
double nodes_band_film(const node_state *self, const double *z, size_t node);

/* Adds the sum of factors[i] dH/dz at `count` neighbouring nodes of a line of the band to
 * [num_unknowns], without the rigid approach. */
void nodes_add_band_films(double *target, const double *factors, const node_state *self,
                          size_t node, size_t count);

/* Smallest H of the present state in the band and at needed nodes, and its node: of a line between the
 * nodes, in all its dips. */
double nodes_minimum_film(size_t *node, node_state *self, const double *z);

/* The same after nodes_minimum_film, with dips before the band, and at its first nodes, looked for at
 * the nodes between those needed too, whose films `film` tells. */
double nodes_minimum_between(size_t *node, const node_state *self, film_function *film,
                             const void *context);

/* Whether the film of a line has a dip at its needed nodes before the band or at its first nodes.
 * */
bool nodes_have_dip(const node_state *self);

/* Scalars of the present state, whose exit is at a place X. */
contact_scalars nodes_scalars(node_state *self, const double *z, double exit_position,
                              const ehd_contact *contact);

/* Least and largest P of the present state before its exit, at the needed nodes and in the band. */
reduced_pressures nodes_pressure_range(node_state *self, const double *z);

/* Adds a row of the cut table of the present exit, times a factor, to [num_pressure]. */
void nodes_add_cut_row(double *target, double factor, const node_state *self, size_t row);

/* Adds dH/dz at a needed node, times a factor, to [num_unknowns], without the rigid approach. */
void nodes_add_film_row(double *target, double factor, const node_state *self, size_t needed);

/* Change of H at X = 0 by a step of the coordinates. */
double nodes_central_change(node_state *self, const double *step);

/* target += factor * source. */
void nodes_add_row(double *target, double factor, const double *source, size_t count);

#endif
