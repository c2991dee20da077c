/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes pressure and film at nodes from the coordinates z of a state. The pressure is cut at an
 * exit line (Maier et al. (2015), eq. 36). The nodes are the needed nodes (all nodes of the rows'
 * stencils, and the nodes around X = 0) and the nodes of the band. The object owns the present exit
 * line. Called by reduced_solver.c in each iteration, by reduced_tangent.c, and by
 * romrun/trust/functionals.c. */
#ifndef EHD_NODE_STATE_H
#define EHD_NODE_STATE_H

#include "romrun/model/reduced_cut.h"
#include "romrun/state/reduced_state.h"

/* Pressure and film that belong to reduced coordinates, at the present exit line. */
typedef struct node_fields {
    reduced_values values;   // values at the exit's checkpoint; not filled if the caller has them
    double *pressure, *film; // [num_needed] P, zero behind the exit, and H; for a Newton step, H is
                             // without the gap
    double *cut;             // [rows of the cut table] the cut table times z
} node_fields;

typedef struct node_state {
    const reduced_model *model;
    size_t *exit;      // [num_lines] present exit line; 0: no exit line yet
    bool *pressurised; // [num_needed] true: the node lies before the exit
    size_t checkpoint; // checkpoint of the exit (reduced_model_checkpoint)
    cut_run *runs;     // [num_lines] runs between the checkpoint's and the present exit line
    size_t num_runs;
    node_fields now, step; // fields of the present state, and of a Newton step
    double *band_pressure; // [nodes of the band] P, filled on demand
    double least_in_band;  // smallest H in the band (nodes_minimum_film)
    size_t lowest_in_band; // node of least_in_band
} node_state;

/* Initialises `self` with memory from an arena. The model must outlive `self`. */
void nodes_init(node_state *self, const reduced_model *model, arena *memory);

/* Sets the present exit line, the nodes before it, its checkpoint and its runs. */
void nodes_move_exit(node_state *self, const size_t *exit);

/* Returns the cut table of the exit's checkpoint, [rows of the cut table, num_pressure]. */
const double *nodes_checkpoint_table(const node_state *self);

/* Computes P and H without gap at the needed nodes, and the cut table times z: Maier et al. (2015),
 * eq. 36, applied to a vector. `known`: values of z that the caller has already computed, or NULL.
 * They are used only if they belong to the same checkpoint. */
void nodes_expand(node_fields *fields, node_state *self, const reduced_values *known,
                  const double *z);

/* Computes the fields of nodes_expand for the present state into self->now. H includes the gap. */
void nodes_expand_state(node_state *self, const reduced_values *known, const double *z);

/* Adds `factor` times the values of the Newton step, self->step.values, to self->now.values. Both
 * must have been filled. */
void nodes_add_step(node_state *self, double factor);

/* Returns H or P at X = 0 from values at the needed nodes. */
double nodes_at_centre(const reduced_model *model, const double *values);

/* Returns the load of the present state, the integral of P. */
double nodes_load(const node_state *self);

/* Compute P at nodes of the band:
 * - nodes_expand_range at `count` nodes from index `first` on;
 * - nodes_expand_band from node `from` to the node before `to`, only for a line contact;
 * - nodes_expand_runs at the nodes of the runs. */
void nodes_expand_range(node_state *self, const double *z, size_t first, size_t count);
void nodes_expand_band(node_state *self, const double *z, size_t from, size_t to);
void nodes_expand_runs(node_state *self, const double *z);

/* Compute H in the band: at `count` neighbouring nodes of a grid line, and at one node. For a
 * coupled basis, the pressures of the runs must have been computed by nodes_expand_runs or
 * nodes_expand_band. */
void nodes_band_films(double *film, const node_state *self, const double *z, size_t node,
                      size_t count);
double nodes_band_film(const node_state *self, const double *z, size_t node);

/* Adds the sum of factors[i] dH/dz over `count` neighbouring nodes i to `target`, [num_unknowns],
 * where z are the coordinates of the state. The nodes lie on one grid line in the band. The
 * derivative with respect to the rigid approach is left out. */
void nodes_add_band_films(double *target, const double *factors, const node_state *self,
                          size_t node, size_t count);

/* Returns the smallest H of the present state in the band and at the needed nodes, and its node.
 * For a line contact the result is the lowest minimum of all dips of the film, and may lie between
 * nodes. */
double nodes_minimum_film(size_t *node, node_state *self, const double *z);

/* Returns a more accurate minimum film than nodes_minimum_film, which must be called first. For
 * dips of the film before the band or at the band's first nodes, also uses the films at the nodes
 * between the needed nodes. `film` returns these films. */
double nodes_minimum_between(size_t *node, const node_state *self, film_function *film,
                             const void *context);

/* Checks whether the film of a line contact has a dip at the needed nodes before the band or at the
 * band's first nodes. */
bool nodes_have_dip(const node_state *self);

/* Returns the scalars of the present state, whose exit is at X = exit_position. */
contact_scalars nodes_scalars(node_state *self, const double *z, double exit_position,
                              const ehd_contact *contact);

/* Returns the least and largest P of the present state before its exit, at the needed nodes and in
 * the band. */
reduced_pressures nodes_pressure_range(node_state *self, const double *z);

/* Adds `factor` times a row of the present exit's cut table to `target`, [num_pressure]. */
void nodes_add_cut_row(double *target, double factor, const node_state *self, size_t row);

/* Adds `factor` times the derivative of H with respect to the coordinates z of the state, at needed
 * node number `needed`, to `target`, [num_unknowns]. The rows need pressure and film only at the
 * needed nodes. The derivative with respect to the rigid approach is left out. */
void nodes_add_film_row(double *target, double factor, const node_state *self, size_t needed);

/* Returns the change of H at X = 0 that a step of the coordinates causes. */
double nodes_central_change(node_state *self, const double *step);

/* Computes target += factor * source. */
void nodes_add_row(double *target, double factor, const double *source, size_t count);

#endif
