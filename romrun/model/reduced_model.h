/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Declares the reduced model (romrun/online/README.md; Maier et al. (2015), section 3). The model
 * holds bases at the nodes that the selected Reynolds rows need, and tables that cut the pressure
 * modes at the exit, that is, set them to zero behind the exit. Models of the paper's level i (all
 * rows) and level n (selected rows) differ only in the list of rows.
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
    DEFORMATION_INDEPENDENT, // own deflection modes and the projected elasticity equation (eq. 26)
    DEFORMATION_COUPLED      // deflection of pressure modes, Delta = K V_p a; no further unknowns
} deformation_kind;

extern const char *const deformation_names[]; // "independent", "coupled", NULL

/* Training solutions in reduced coordinates. Newton's method starts from these solutions, and they
 * define the trained range. */
typedef struct reduced_states {
    size_t num_states;
    size_t num_unknowns; // n_p + n_delta + 1
    double *coordinates; // [num_states, num_unknowns]: pressure, deformation, rigid approach
    size_t num_lines;    // number of grid lines, with the boundary lines of a point contact
    size_t *exit; // [num_states, num_lines] column of the first node without pressure. Column 0 is
                  // the boundary node at the upstream end of a grid line
    double *moes_M;                 // [num_states]
    double *alpha_p_H;              // [num_states]
    flow_thinning *thinning;        // [num_states] thinning of the flow
    double *central_film_thickness; // [num_states]
    bool *stationary;               // [num_states] false: the state is from a trajectory
    // [num_states] rates of change of the contact (frame_rates). rate: the rate `all` at the state;
    // load_rate: the largest rate `load` on the trajectory up to the state. Both are 0 for
    // stationary states
    double *rate, *load_rate;
    film_effects *effects;  // [num_states] estimated errors due to the grid of the full model
    lubricant_rises *rises; // [num_states] rises of viscosity and density up to the Hertz pressure
    arena memory;           // memory of the arrays, unless a flat file owns them
} reduced_states;

/* Allocates stationary states. All their numbers are zero, except effects and rises, which are
 * unknown. Errors: EHD_MEMORY. */
ehd_status reduced_states_init(reduced_states *states, size_t num_states, size_t num_lines,
                               size_t num_unknowns, ehd_error *error);
void reduced_states_free(reduced_states *states);

/* Copies all data of the states of `source`, except the coordinates, to the states of `target`,
 * beginning with state number `first`. */
void reduced_states_put(reduced_states *target, size_t first, const reduced_states *source);

/* Copies all arrays. Errors: EHD_MEMORY. */
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
    ehd_carriage carriage; // transport and smoothing in the trajectories of the training
    deformation_kind deformation;
    size_t num_pressure;       // n_p
    size_t num_deformation;    // n_delta, 0 when coupled
    double *pressure;          // [num_nodes, num_pressure], zero at the boundary nodes
    double *deformation_modes; // [num_nodes, num_deformation], NULL when coupled
    double *weight;            // [num_nodes] weight D of the test basis (eq. 27), including its
                               // lower bound (podbuild/README.md)
    reduced_states states;
} reduced_basis;

void reduced_basis_free(reduced_basis *basis);
/* Returns the number of unknowns: the coordinates of both bases and the rigid approach. */
size_t reduced_num_unknowns(size_t num_pressure, size_t num_deformation);

/* Checks that the least squares have enough rows. The projected elasticity equation and the load
 * balance leave num_pressure unknowns, which the rows have to determine. EHD_DATA: there are fewer
 * rows than num_pressure. `object`: the first words of the message. */
ehd_status reduced_check_num_rows(size_t num_rows, size_t num_pressure, size_t num_deformation,
                                  const char *object, ehd_error *error);

/* A set of Reynolds rows, and the bases at the nodes that the rows need. These *needed nodes* are
 * all nodes of the rows' stencils. */
typedef struct row_set {
    size_t num_rows;
    size_t *node;               // [num_rows] grid nodes, in order of selection; model_get sorts the
                                // selected rows by node
    double *weight;             // [num_rows] D of the test basis, times the row's quadrature factor
    reynolds_stencil *stencils; // [num_rows] stencils whose nodes are indices in needed_node
    size_t num_needed;
    size_t *needed_node; // [num_needed] ascending
    double *gap;         // [num_needed] undeformed gap
    double *pressure;    // [num_needed, num_pressure]
    double *film;        // independent: deformation basis [num_needed, num_deformation]; coupled:
                         // deflections of the pressure modes cut at the beginning of the band,
                         // [num_needed, num_pressure]
} row_set;

/* Cubic interpolation of pressure and film to the centre X = 0, along the grid line Y = 0. */
typedef struct centre_nodes {
    size_t index[4]; // indices in model->rows.needed_node of the four nodes around X = 0
    double weight[4];
} centre_nodes;

/* The columns of the band on one grid line. Boundary lines of a point contact have no columns in
 * the band. */
typedef struct band_line {
    size_t begin, end;         // the band has columns begin … end - 1
    size_t offset;             // index of column `begin` among the band's nodes
    size_t min_exit, max_exit; // first and last column at which the exit may lie
} band_line;

/* The band: the range of nodes in which the film minima and the exits lie. For a line contact the
 * band has one line, whose columns are the nodes of the grid. */
typedef struct exit_band {
    size_t num_lines;                   // number of grid lines
    band_line *lines;                   // [num_lines]
    size_t num_nodes;                   // number of the band's nodes on all lines
    size_t first_minimum, last_minimum; // first and last line with film minima of the training
    double *pressure;                   // [num_nodes, num_pressure]
    double *film;                       // basis of the film at the band's nodes, as in row_set
} exit_band;

/* The cut table: quantities of the pressure modes that depend linearly on the modes cut at the
 * exit. For a coupled basis these are the deflections of the modes at the needed nodes. For an
 * independent basis they are V_delta^T K V_p. The last row of the table is the load of the modes.
 * The table of an exit is `base` plus the sum of left[i, :]^T V_p[i, :] over the band's nodes i
 * before the exit (eq. 36). */
typedef struct exit_cut {
    size_t num_rows; // coupled: num_needed + 1; independent: num_deformation + 1
    double *left;    // [nodes of the band, num_rows] effect of a pressure of 1 at a node on each
                     // row of the table
    // [num_rows, num_pressure] table of an exit at the beginning of the band
    double *base;
} exit_cut;

/* Checkpoints: cut tables and deflections that are stored for some exits. The tables of other exits
 * are computed from the checkpoints. */
typedef struct exit_checkpoints {
    size_t stride; // line contact: distance between checkpoints in nodes
    size_t num;
    size_t *exit;    // [num, num_lines] exit lines; point contact: exit lines of training states
    double *cut;     // [num, rows of the cut table, num_pressure]
    double *band;    // coupled: deflections in the band, [num, nodes of the band, num_pressure]
    double *control; // coupled: deflections for the control rows, [num, num_needed, num_pressure]
} exit_checkpoints;

/* Pressures of the training states behind X = 0, from which initial states of the solver are
 * computed (start_shift.h). */
typedef struct start_shift {
    // first: index in needed_node of the first node behind X = 0; num_nodes: number of needed nodes
    // from this node on; if num_nodes is 0, there is no shift
    size_t first, num_nodes;
    double *x;        // [num_nodes]
    double *pressure; // [num_states, num_nodes] interpolated from the profiles
    double *fit;      // [num_nodes, num_pressure] coordinates of the modes that fit a pressure of 1
                      // at a node, by least squares over all needed nodes
    double *spike;    // [num_states] X of the spike
    double spacing; // distance between the points of a profile, in the coordinate of start_shift.h
    size_t num_points;
    double *profile; // [num_states, num_points, 2] pressure, and its slope times `spacing`
} start_shift;

/* Nodes and weights that replace sums of shear stresses over the grid (romrun/solve/README.md,
 * Traction). Nodes and weights do not depend on the number of rows in use. */
typedef struct node_cubature {
    row_set nodes;    // a set without rows, whose needed nodes are the nodes of the cubature;
                      // num_needed 0: no cubature. A model of thinned flows also has the neighbours
                      // of these nodes along X, with weights of 0, for the pressure gradient
    double *friction; // [num_needed] weights of int tau over the nodes with pressure, not negative
    double *dry;      // [num_needed] weights of the mean of |tau| in the dry contact, not negative
    double *moment;   // [num_pressure] int P X of the modes cut at the beginning of the band
} node_cubature;

/* Tolerance of a cubature in its training: root mean square of the relative error. The error
 * compares the sum over the cubature's nodes with the sum over the grid. Measured on the friction
 * of a line contact with 1201 nodes, with seven integrands in training: cubatures with the
 * tolerances 1e-4, 1e-5 and 1e-6 have 98, 120 and 140 nodes. Their largest errors are 9e-4, 6e-5
 * and 3e-5 (romrun/solve/README.md, Traction). */
extern const double node_cubature_tolerance;

/* Data of the online solver. Solvers do not change the model, so several threads may share it. */
typedef struct reduced_model {
    const contact_kind *kind;
    ehd_grid grid;
    ehd_carriage carriage; // transport and smoothing in the trajectories of the training
    deformation_kind deformation;
    size_t num_pressure, num_deformation, num_unknowns;

    row_set rows;    // the selected rows; the needed nodes include the nodes around the centre
    row_set control; // rows used only for the error estimate (indicator.h); num_rows may be 0
    centre_nodes centre;
    exit_band band;
    // [lines, width] entry [l, c] is the deflection that a pressure of 1 causes at a distance of l
    // lines and c columns. `lines` is num_lines, but on a half grid 2 num_lines, because of
    // mirrored nodes.
    double *kernel;
    exit_cut cut;
    exit_checkpoints checkpoints;
    reduced_states states;
    start_shift shift;
    shown_lubricants shown; // lubricants of the calibration
    node_cubature cubature;
    arena memory; // memory of all arrays except the arrays in `states` and in a flat file
} reduced_model;

/* Builds a model from a list of rows, given as grid nodes in the order of selection. If `rows` is
 * NULL, the model has the rows of all inner nodes. Returns EHD_DATA if there are fewer rows than
 * pressure modes, or if a row lies outside of the grid. Other errors: EHD_MEMORY. */
ehd_status reduced_model_build(
    // output:
    reduced_model *model, // free with reduced_model_free
    // input:
    const reduced_basis *basis, const size_t *rows, size_t num_rows, ehd_error *error);

/* Adds control rows, given as grid nodes, to a model that was built from this basis. Errors:
 * EHD_MEMORY. */
ehd_status reduced_model_add_control(
    // in and out:
    reduced_model *model,
    // input:
    const reduced_basis *basis, const size_t *rows, size_t num_rows, ehd_error *error);

/* Adds a cubature. Errors: EHD_MEMORY. */
ehd_status reduced_model_add_cubature(
    // in and out:
    reduced_model *model,
    // input:
    const reduced_basis *basis, const size_t *nodes, // [num_nodes] ascending
    const double *friction, const double *dry,       // [num_nodes]
    size_t num_nodes, ehd_error *error);

/* Lists the needed nodes of a set of rows in ascending order. The list of the selected rows
 * includes the nodes around the centre. Errors: EHD_MEMORY. */
ehd_status reduced_model_list_needed(reduced_model *model, row_set *set, ehd_error *error);

/* Check a band and the exits of states, which were read from the file `path`. Error: EHD_DATA.
 * - reduced_check_band checks that the exits of each grid line lie inside the band, with space for
 *   the stencil of a row. It also checks that the numbers of nodes on the lines add up to the
 *   number of nodes of the band.
 * - reduced_check_exits checks that the exits of the states lie in the band, because tables are
 *   updated node by node along the band. */
ehd_status reduced_check_band(const reduced_model *model, const char *path, ehd_error *error);
ehd_status reduced_check_exits(const reduced_model *model, const reduced_states *states,
                               const char *path, ehd_error *error);

/* Sets the stencils and gaps of a set of rows. Its needed nodes must already be listed. For the
 * selected rows it also sets the indices of the nodes around the centre. Errors: EHD_MEMORY. */
ehd_status reduced_model_place_rows(reduced_model *model, row_set *set, ehd_error *error);

/* reduced_model_complete computes the tables that follow from the other tables (stencils, kernel,
 * left sides, checkpoints). This is the last step of building or reading a model.
 * reduced_model_complete_control computes the stencils and checkpoints of the control rows, which
 * may be added later. */
ehd_status reduced_model_complete(reduced_model *model, ehd_error *error);
ehd_status reduced_model_complete_control(reduced_model *model, ehd_error *error);

void reduced_model_free(reduced_model *model);

/* Return the line of a grid node and its column on this line. */
size_t reduced_model_line(const reduced_model *model, size_t node);
size_t reduced_model_column(const reduced_model *model, size_t node);

static inline size_t index_distance(size_t a, size_t b) {
    return a > b ? a - b : b - a;
}

typedef struct grid_position {
    size_t line, column;
} grid_position;
grid_position reduced_model_position(const reduced_model *model, size_t node);

/* Checks whether a grid line has nodes in the band. Only boundary lines have no nodes in it. */
bool reduced_model_has_band(const reduced_model *model, size_t line);

/* Returns the index of the selected row at a node, or NO_NODE. */
size_t reduced_model_row(const reduced_model *model, size_t node);

/* Returns the index of the selected row that is nearest to a node. Rows whose `influence`, [rows],
 * is 0 are ignored. If `influence` is NULL, no row is ignored. Returns 0 if all are ignored. */
size_t reduced_model_nearest_row(const reduced_model *model, size_t node, const double *influence);

/* Returns the index of a node of the band among the band's nodes. */
size_t reduced_model_band_index(const reduced_model *model, size_t node);

/* Adds the deflections that pressures on one grid line cause at `num_at` neighbouring nodes from
 * `at` on. The pressures lie at `count` nodes of grid line `line`, from column `first` on, and are
 * multiplied by `sign`. */
void reduced_model_deflect(
    // in and out:
    double *film, // [num_at]
    // input:
    const reduced_model *model, grid_position at, size_t num_at, size_t line, size_t first,
    size_t count, const double *pressure, // [count]
    double sign);

#endif
