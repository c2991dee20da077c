/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The reduced model (romrun/online/README.md; Maier et al. (2015), section 3): bases at the nodes that
 * the selected Reynolds rows need, and tables that cut them at the exit. Level i (all rows) and
 * level n (selected rows) differ in the list of rows only. */
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

/* Training solutions in reduced coordinates: starts for Newton, and the range that was trained. */
typedef struct reduced_states {
    size_t num_states;
    size_t num_unknowns; // n_p + n_delta + 1
    double *coordinates; // [num_states, num_unknowns]: pressure, deformation, rigid approach
    size_t num_lines;    // of the grid, boundary lines of a point contact included
    size_t *exit;        // [num_states, num_lines] first column without pressure, boundary nodes
                         // included; of a line contact a grid node
    double *moes_M;      // [num_states]
    double *alpha_p_H;   // [num_states]
    flow_thinning *thinning;        // [num_states] of the flow
    double *central_film_thickness; // [num_states]
    bool *stationary;               // [num_states] false along a trajectory
    // [num_states] of change of the contact, of all and, largest on the trajectory so far, of the load
    // (frame_rates), 0 when stationary
    double *rate, *load_rate;
    film_effects *effects;  // [num_states] of the full model's grid
    lubricant_rises *rises; // [num_states] at the Hertz pressure
} reduced_states;

/* Memory for states that are all stationary and zero, with unknown effects. EHD_MEMORY. */
ehd_status reduced_states_init(reduced_states *states, size_t num_states, size_t num_lines,
                               size_t num_unknowns, ehd_error *error);
void reduced_states_free(reduced_states *states);

/* Deep copy. EHD_MEMORY. */
ehd_status reduced_states_copy(reduced_states *target, const reduced_states *source,
                               ehd_error *error);

/* Whether a state is the solution of this contact: the same M, alpha p_H and lubricant. */
bool reduced_state_is_of(const reduced_states *states, size_t state, const ehd_contact *contact);

/* Whether this contact is one of the training points. */
bool reduced_states_have(const reduced_states *states, const ehd_contact *contact);

/* Bases on the whole grid, offline only. A node's entries are contiguous. */
typedef struct reduced_basis {
    const contact_kind *kind;
    ehd_grid grid;
    ehd_carriage carriage; // of the training's trajectories
    deformation_kind deformation;
    size_t num_pressure;       // n_p
    size_t num_deformation;    // n_delta, 0 when coupled
    double *pressure;          // [num_nodes, num_pressure], zero at the boundary nodes
    double *deformation_modes; // [num_nodes, num_deformation], NULL when coupled
    double *weight;            // [num_nodes] D of the test basis (eq. 27), with its floor
    reduced_states states;
} reduced_basis;

void reduced_basis_free(reduced_basis *basis);
/* Both kinds of coordinates and the rigid approach. */
size_t reduced_num_unknowns(size_t num_pressure, size_t num_deformation);

/* EHD_DATA with fewer rows than the least squares of the unknowns need: the projected elasticity
 * equation and the load balance determine all but num_pressure. `object`: of the message. */
ehd_status reduced_check_num_rows(size_t num_rows, size_t num_pressure, size_t num_deformation,
                                  const char *object, ehd_error *error);

/* Reynolds rows of the grid, and the bases at their needed nodes: those of the rows' stencils. */
typedef struct row_set {
    size_t num_rows;
    size_t *node;               // [num_rows] grid nodes, in order of selection
    double *weight;             // [num_rows] D of the test basis, times the row's quadrature factor
    reynolds_stencil *stencils; // [num_rows] of indices in needed_node
    size_t num_needed;
    size_t *needed_node; // [num_needed] ascending
    double *gap;         // [num_needed] undeformed gap
    double *pressure;    // [num_needed, num_pressure]
    double *film;        // independent: deformation basis [num_needed, num_deformation]; coupled:
                         // deflection of the pressure modes cut where the band begins,
                         // [num_needed, num_pressure]
} row_set;

/* Interpolation to X = 0 on the line Y = 0. */
typedef struct centre_nodes {
    size_t index[4]; // in needed_node of the selected rows
    double weight[4];
} centre_nodes;

/* A grid line's part of the band. Boundary lines of a point contact have none. */
typedef struct band_line {
    size_t begin, end;         // columns begin … end - 1
    size_t offset;             // index of column `begin` among the band's nodes
    size_t min_exit, max_exit; // columns at which the exit may lie
} band_line;

/* The band: nodes among which film minimum and exit lie. A line contact has one line, whose
 * columns are the grid's nodes. */
typedef struct exit_band {
    size_t num_lines;                   // of the grid
    band_line *lines;                   // [num_lines]
    size_t num_nodes;                   // of all lines
    size_t first_minimum, last_minimum; // lines between which trained film minima lie
    double *pressure;                   // [num_nodes, num_pressure]
    double *film;                       // as in row_set, at the band's nodes
} exit_band;

/* The cut table: linear maps of the pressure modes cut at the exit. Coupled: their deflections at
 * the needed nodes; independent: V_delta^T K V_p; last row: the load. That of an exit is
 * `base` plus the sum of left[i, :]^T V_p[i, :] over the band's nodes i before it (eq. 36). */
typedef struct exit_cut {
    size_t num_rows; // coupled: num_needed + 1; independent: num_deformation + 1
    double *left;    // [nodes of the band, num_rows]
    double *base;    // [num_rows, num_pressure] for an exit where the band begins
} exit_cut;

/* Cut tables and deflections stored for some exits, from which those of others are near. */
typedef struct exit_checkpoints {
    size_t stride;   // nodes, of a line contact
    size_t num;      // of checkpoints
    size_t *exit;    // [num, num_lines]: of a line contact every `stride` nodes, of a point contact
                     // exit lines of training
    double *cut;     // [num, rows of the cut table, num_pressure]
    double *band;    // coupled: deflection in the band [num, nodes of the band, num_pressure]
    double *control; // coupled: at the control rows' nodes [num, their num_needed, num_pressure]
} exit_checkpoints;

/* Pressures of the states behind X = 0, for starts (start_shift.h). */
typedef struct start_shift {
    size_t first, num_nodes; // the last of the needed nodes, which lie there; 0: there is no shift
    double *x;               // [num_nodes]
    double *pressure;        // [num_states, num_nodes] as the profiles have it
    double *fit;    // [num_nodes, num_pressure] coordinates of a unit pressure at a node, by least
                    // squares at all needed nodes
    double *spike;  // [num_states] X of the spike
    double spacing; // of the profiles, along the coordinate
    size_t num_points;
    double *profile; // [num_states, num_points, 2] pressure, and slope times the spacing
} start_shift;

/* Nodes that sums of shear stresses over the grid are replaced by (romrun/online/README.md, traction),
 * whatever rows are in use. */
typedef struct node_cubature {
    row_set nodes;    // its needed nodes, without rows; none: 0. Of thinned flows those beside them
                      // along X too, with weights of 0, for the gradient of the pressure
    double *friction; // [num_needed] not negative: of int tau over the nodes with pressure
    double *dry;      // [num_needed] not negative: of the mean |tau| of the dry contact
    double *moment;   // [num_pressure] int P X of the modes cut where the band begins
} node_cubature;

/* What the sum over these nodes is off that over the grid in its training, root of the mean
 * square. */
extern const double node_cubature_tolerance;

/* What the online solver holds. Everything here is read-only while solving, so that several
 * solvers in several threads may share it. */
typedef struct reduced_model {
    const contact_kind *kind;
    ehd_grid grid;
    ehd_carriage carriage; // of the training's trajectories
    deformation_kind deformation;
    size_t num_pressure, num_deformation, num_unknowns;

    row_set rows;    // the selected rows; their needed nodes include those around the centre
    row_set control; // rows outside of the solution, whose residual indicates its error
                     // (indicator.h); none: 0 rows
    centre_nodes centre;
    exit_band band;
    double *kernel; // [lines, width] deflection by distance in lines and columns; of a
                    // half grid [2 num_lines, width], for mirrored nodes too
    exit_cut cut;
    exit_checkpoints checkpoints;
    reduced_states states;
    start_shift shift;
    shown_lubricants shown; // what its calibration was made on
    node_cubature cubature;
    arena memory; // of all arrays but the states'
} reduced_model;

/* Builds the model of a list of rows, grid nodes in order of selection; `rows` NULL: all inner
 * nodes (level i). EHD_DATA: fewer rows than pressure modes, a row outside of the grid;
 * EHD_MEMORY. */
ehd_status reduced_model_build(
    // output:
    reduced_model *model, // free with reduced_model_free
    // input:
    const reduced_basis *basis, const size_t *rows, size_t num_rows, ehd_error *error);

/* Adds control rows, grid nodes, to a model that was built on this basis. EHD_MEMORY. */
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

/* Lists the needed nodes of one of the model's two sets of rows, ascending; for the selected rows
 * those around the centre too. EHD_MEMORY. */
ehd_status reduced_model_list_needed(reduced_model *model, row_set *set, ehd_error *error);

/* Of what is read from `path`: the exits of each line lie inside of its band, with room for a row's
 * stencil, and the lines have as many nodes as the band; and the states' exits lie in it, since tables
 * of an exit are made by going along the band to it. EHD_DATA. */
ehd_status reduced_check_band(const reduced_model *model, const char *path, ehd_error *error);
ehd_status reduced_check_exits(const reduced_model *model, const reduced_states *states,
                               const char *path, ehd_error *error);

/* Of the next step what is about places: needed nodes of the rows, which are listed, among each other,
 * and the centre among them. EHD_MEMORY. */
ehd_status reduced_model_place_rows(reduced_model *model, row_set *set, ehd_error *error);

/* Last step of building and of reading a model: tables that follow from the others (stencils,
 * kernel, left sides, checkpoints); control rows, which may be added later, on their own. */
ehd_status reduced_model_complete(reduced_model *model, ehd_error *error);
ehd_status reduced_model_complete_control(reduced_model *model, ehd_error *error);

void reduced_model_free(reduced_model *model);

/* Line of a grid node, and its column in it. */
size_t reduced_model_line(const reduced_model *model, size_t node);
size_t reduced_model_column(const reduced_model *model, size_t node);

/* By how much two lines or columns differ. */
static inline size_t index_distance(size_t a, size_t b) {
    return a > b ? a - b : b - a;
}

/* Line and column of a node. */
typedef struct grid_position {
    size_t line, column;
} grid_position;
grid_position reduced_model_position(const reduced_model *model, size_t node);

/* Whether a line has nodes in the band: all but boundary lines. */
bool reduced_model_has_band(const reduced_model *model, size_t line);

/* The selected row nearest to a node among those with an influence, [rows], NULL: among all; 0
 * where there is none. */
size_t reduced_model_nearest_row(const reduced_model *model, size_t node, const double *influence);

/* Index of a node of the band among its nodes. */
size_t reduced_model_band_index(const reduced_model *model, size_t node);

/* Adds the deflection at `num_at` neighbouring nodes from `at` on by the pressure, times a sign,
 * of `count` nodes of a line from column `first` on. */
void reduced_model_deflect(
    // in and out:
    double *film, // [num_at]
    // input:
    const reduced_model *model, grid_position at, size_t num_at, size_t line, size_t first,
    size_t count, const double *pressure, // [count]
    double sign);

#endif
