/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Declares the reduced model (romrun/online/README.md; Maier et al. (2015), section 3): bases at
 * the nodes that the selected Reynolds rows need, and tables that cut the modes at the exit. Level
 * i (all rows) and level n (selected rows) differ only in the list of rows.
 * Called by podbuild, deimselect and snapgen, which make models, and by romrun. */
#ifndef EHD_REDUCED_MODEL_H
#define EHD_REDUCED_MODEL_H

#include "common/output/film_effects.h"
#include "common/physics/contact.h"
#include "common/physics/reynolds.h"
#include "common/physics/traction.h"
#include "common/program/arena.h"
#include "common/program/status.h"
#include "romrun/model/shown.h"
#include <stdbool.h>
#include <stddef.h>

/* How the deflection depends on the reduced unknowns. */
typedef enum deformation_kind {
    DEFORMATION_INDEPENDENT, // own basis, projected elasticity equation (eq. 26)
    DEFORMATION_COUPLED      // Delta = K V_p a, no unknowns of its own
} deformation_kind;

extern const char *const deformation_names[]; // "independent", "coupled", NULL

/* Training solutions in reduced coordinates: starts of Newton's method, and the trained range. */
typedef struct reduced_states {
    size_t num_states;
    size_t num_unknowns;     // n_p + n_delta + 1
    double *coordinates;     // [num_states, num_unknowns]: pressure, deformation, rigid approach
    size_t num_lines;        // lines of the grid, including the boundary lines of a point contact
    size_t *exit;            // [num_states, num_lines] first column without pressure; boundary
                             // nodes are counted; for a line contact a grid node
    double *moes_M;          // [num_states]
    double *alpha_p_H;       // [num_states]
    flow_thinning *thinning; // [num_states] thinning of the flow
    double *central_film_thickness; // [num_states]
    bool *stationary;               // [num_states] false: the state is from a trajectory
    // [num_states] rates of change of the contact (frame_rates): the rate `all`, and the largest
    // rate `load` on the trajectory so far; 0 for stationary states
    double *rate, *load_rate;
    film_effects *effects;  // [num_states] errors by the full model's grid
    lubricant_rises *rises; // [num_states] rises to the Hertz pressure
} reduced_states;

/* Allocates states that are stationary and zero, with unknown effects. EHD_MEMORY. */
ehd_status reduced_states_init(reduced_states *states, size_t num_states, size_t num_lines,
                               size_t num_unknowns, ehd_error *error);
void reduced_states_free(reduced_states *states);

/* Copies all data of the states, except their coordinates, to the states of `target` from `first`
 * on. */
void reduced_states_put(reduced_states *target, size_t first, const reduced_states *source);

/* Copies all arrays. EHD_MEMORY. */
ehd_status reduced_states_copy(reduced_states *target, const reduced_states *source,
                               ehd_error *error);

/* Checks whether a state is the solution of this contact: equal M, alpha p_H, thinning and
 * lubricant. */
bool reduced_state_is_of(const reduced_states *states, size_t state, const ehd_contact *contact);

/* Checks whether this contact is one of the training points. */
bool reduced_states_have(const reduced_states *states, const ehd_contact *contact);

/* Bases on the whole grid, used offline only. The entries of a node are contiguous. */
typedef struct reduced_basis {
    const contact_kind *kind;
    ehd_grid grid;
    ehd_carriage carriage; // transport in the training's trajectories
    deformation_kind deformation;
    size_t num_pressure;       // n_p
    size_t num_deformation;    // n_delta, 0 when coupled
    double *pressure;          // [num_nodes, num_pressure], zero at the boundary nodes
    double *deformation_modes; // [num_nodes, num_deformation], NULL when coupled
    double *weight;            // [num_nodes] D of the test basis (eq. 27), with its floor
    reduced_states states;
} reduced_basis;

void reduced_basis_free(reduced_basis *basis);
/* Returns the number of unknowns: the coordinates of both bases and the rigid approach. */
size_t reduced_num_unknowns(size_t num_pressure, size_t num_deformation);

/* Checks that the least squares have enough rows. The projected elasticity equation and the load
 * balance leave num_pressure unknowns, which the rows determine. EHD_DATA: fewer rows. `object`:
 * begins the message. */
ehd_status reduced_check_num_rows(size_t num_rows, size_t num_pressure, size_t num_deformation,
                                  const char *object, ehd_error *error);

/* Reynolds rows of the grid, and the bases at their needed nodes: the nodes of the rows'
 * stencils. */
typedef struct row_set {
    size_t num_rows;
    size_t *node;               // [num_rows] grid nodes, in order of selection
    double *weight;             // [num_rows] D of the test basis, times the row's quadrature factor
    reynolds_stencil *stencils; // [num_rows], nodes as indices in needed_node
    size_t num_needed;
    size_t *needed_node; // [num_needed] ascending
    double *gap;         // [num_needed] undeformed gap
    double *pressure;    // [num_needed, num_pressure]
    double *film;        // independent: deformation basis [num_needed, num_deformation]; coupled:
                         // deflections of the pressure modes cut at the beginning of the band,
                         // [num_needed, num_pressure]
} row_set;

/* Interpolation to the centre X = 0 on the grid line Y = 0. */
typedef struct centre_nodes {
    size_t index[4]; // indices in needed_node of the selected rows
    double weight[4];
} centre_nodes;

/* The columns of the band on one grid line. Boundary lines of a point contact have none. */
typedef struct band_line {
    size_t begin, end;         // the band has columns begin … end - 1
    size_t offset;             // index of column `begin` among the band's nodes
    size_t min_exit, max_exit; // first and last column of the exit
} band_line;

/* The band: the nodes that contain the film minima and the exits. A line contact has one line,
 * whose columns are the grid's nodes. */
typedef struct exit_band {
    size_t num_lines;                   // lines of the grid
    band_line *lines;                   // [num_lines]
    size_t num_nodes;                   // sum over all lines
    size_t first_minimum, last_minimum; // lines between which trained film minima lie
    double *pressure;                   // [num_nodes, num_pressure]
    double *film;                       // film's basis as in row_set, at the band's nodes
} exit_band;

/* The cut table: linear maps of the pressure modes cut at the exit. For a coupled basis it contains
 * the modes' deflections at the needed nodes, for an independent basis V_delta^T K V_p. The last
 * row of the table is the load of the modes. The table of an exit is `base` plus the sum of
 * left[i, :]^T V_p[i, :] over the band's nodes i before the exit (eq. 36). */
typedef struct exit_cut {
    size_t num_rows; // coupled: num_needed + 1; independent: num_deformation + 1
    double *left;    // [nodes of the band, num_rows]
    // [num_rows, num_pressure] deflections of the modes, if the exit is at the beginning of the band
    double *base;
} exit_cut;

/* Stored cut tables and deflections of some exits, from which the tables of other exits are
 * computed. */
typedef struct exit_checkpoints {
    size_t stride;   // line contact: distance between checkpoints in nodes
    size_t num;      // number of checkpoints
    size_t *exit;    // [num, num_lines] line contact: every `stride` nodes; point contact: exit
                     // lines in training
    double *cut;     // [num, rows of the cut table, num_pressure]
    double *band;    // coupled: deflections in the band [num, nodes of the band, num_pressure]
    double *control; // coupled: at the needed nodes of the control rows [num, num_needed,
                     // num_pressure]
} exit_checkpoints;

/* Pressures of the training states behind X = 0, for starts (start_shift.h). */
typedef struct start_shift {
    size_t first, num_nodes; // index of the first node; the nodes are the last needed ones;
                             // num_nodes 0: no shift
    double *x;               // [num_nodes]
    double *pressure;        // [num_states, num_nodes] interpolated from the profiles
    double *fit;    // [num_nodes, num_pressure] coordinates that fit a unit pressure at a node, by
                    // least squares over all needed nodes
    double *spike;  // [num_states] X of the spike
    double spacing; // distance between the points of a profile, in the coordinate
    size_t num_points;
    double *profile; // [num_states, num_points, 2] pressure, and slope times spacing
} start_shift;

/* Nodes and weights that replace sums of shear stresses over the grid (romrun/solve/README.md,
 * Traction). They do not depend on the number of rows in use. */
typedef struct node_cubature {
    row_set nodes;    // a set without rows; its needed nodes have the weights (none: no cubature).
                      // Models of thinned flows add the neighbours along X, with weights of 0, for
                      // the pressure gradient
    double *friction; // [num_needed] not negative: for int tau over the nodes with pressure
    double *dry;      // [num_needed] not negative: for the mean |tau| of the dry contact
    double *moment;   // [num_pressure] int P X of the modes cut at the beginning of the band
} node_cubature;

/* Tolerance of a cubature in its training: root mean square of the relative error. The error
 * compares the sum over the cubature's nodes with the sum over the grid. Measured with seven
 * integrands in training, on the friction of a line contact on 1201 nodes: with 1e-4, 1e-5 and 1e-6
 * it takes 98, 120 and 140 nodes, and the largest errors are 9e-4, 6e-5 and 3e-5
 * (romrun/solve/README.md, Traction). */
extern const double node_cubature_tolerance;

/* Data of the online solver. Solvers only read it, so several threads may share it. */
typedef struct reduced_model {
    const contact_kind *kind;
    ehd_grid grid;
    ehd_carriage carriage; // transport in the training's trajectories
    deformation_kind deformation;
    size_t num_pressure, num_deformation, num_unknowns;

    row_set rows;    // the selected rows; the needed nodes include the nodes around the centre
    row_set control; // rows that are not solved, used only for the error estimate (indicator.h); 0
                     // rows: none
    centre_nodes centre;
    exit_band band;
    // [lines, width] deflection by distance in lines and columns. A half grid also needs the
    // distances of mirrored nodes: [2 num_lines, width].
    double *kernel;
    exit_cut cut;
    exit_checkpoints checkpoints;
    reduced_states states;
    start_shift shift;
    shown_lubricants shown; // lubricants of the calibration
    node_cubature cubature;
    arena memory; // memory of all arrays except those in `states` and `shown`
} reduced_model;

/* Builds a model from a list of rows, given as grid nodes in the order of selection. `rows` NULL:
 * all inner nodes (level i). EHD_DATA: fewer rows than pressure modes, or a row outside of the
 * grid; EHD_MEMORY. */
ehd_status reduced_model_build(
    // output:
    reduced_model *model, // free with reduced_model_free
    // input:
    const reduced_basis *basis, const size_t *rows, size_t num_rows, ehd_error *error);

/* Adds control rows, given as grid nodes, to a model that was built from this basis.
 * EHD_MEMORY. */
ehd_status reduced_model_add_control(
    // in and out:
    reduced_model *model,
    // input:
    const reduced_basis *basis, const size_t *rows, size_t num_rows, ehd_error *error);

/* Adds a cubature. EHD_MEMORY. */
ehd_status reduced_model_add_cubature(
    // in and out:
    reduced_model *model,
    // input:
    const reduced_basis *basis, const size_t *nodes, // [num_nodes] ascending
    const double *friction, const double *dry,       // [num_nodes]
    size_t num_nodes, ehd_error *error);

/* Lists the needed nodes of a set of rows in ascending order. The list of the selected rows
 * includes the nodes around the centre. EHD_MEMORY. */
ehd_status reduced_model_list_needed(reduced_model *model, row_set *set, ehd_error *error);

/* Check a band and exits that were read from `path`. EHD_DATA.
 * - reduced_check_band: on each grid line the range of the exit lies inside the band, with space
 *   for the stencil of a row. The lines together have as many nodes as the band.
 * - reduced_check_exits: the exits of the states lie in the band, since tables are updated node by
 *   node along the band. */
ehd_status reduced_check_band(const reduced_model *model, const char *path, ehd_error *error);
ehd_status reduced_check_exits(const reduced_model *model, const reduced_states *states,
                               const char *path, ehd_error *error);

/* Sets the stencils and gaps of a set of rows, whose needed nodes are already listed. For the
 * selected rows it also sets the indices of the nodes around the centre. EHD_MEMORY. */
ehd_status reduced_model_place_rows(reduced_model *model, row_set *set, ehd_error *error);

/* Computes the tables that follow from the others (stencils, kernel, left sides, checkpoints), as
 * the last step of building or reading a model. Control rows may be added later, by a step of their
 * own. */
ehd_status reduced_model_complete(reduced_model *model, ehd_error *error);
ehd_status reduced_model_complete_control(reduced_model *model, ehd_error *error);

void reduced_model_free(reduced_model *model);

/* Return the line of a grid node and its column on this line. */
size_t reduced_model_line(const reduced_model *model, size_t node);
size_t reduced_model_column(const reduced_model *model, size_t node);

/* Returns the distance of two lines or of two columns. */
static inline size_t index_distance(size_t a, size_t b) {
    return a > b ? a - b : b - a;
}

/* Line and column of a node. */
typedef struct grid_position {
    size_t line, column;
} grid_position;
grid_position reduced_model_position(const reduced_model *model, size_t node);

/* Checks whether a grid line has nodes in the band. Only boundary lines have none. */
bool reduced_model_has_band(const reduced_model *model, size_t line);

/* Returns the selected row that is nearest to a node, among the rows with `influence`, [rows],
 * other than 0. `influence` NULL: among all rows. Returns 0 if there is no such row. */
size_t reduced_model_nearest_row(const reduced_model *model, size_t node, const double *influence);

/* Returns the index of a node of the band among the band's nodes. */
size_t reduced_model_band_index(const reduced_model *model, size_t node);

/* Adds deflections at `num_at` neighbouring nodes from `at` on. They are caused by the pressure,
 * times `sign`, at `count` nodes of `line` from column `first` on. */
void reduced_model_deflect(
    // in and out:
    double *film, // [num_at]
    // input:
    const reduced_model *model, grid_position at, size_t num_at, size_t line, size_t first,
    size_t count, const double *pressure, // [count]
    double sign);

#endif
