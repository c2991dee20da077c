/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the least-squares problem of an iteration (Maier et al. (2015), eqs. 37 and 38). Its
 * rows are the weighted selected Reynolds rows before the exit, the projected elasticity of an
 * independent basis, and the closure (load balance or given approach). The object owns the rows,
 * the matrix, the factors and the step.
 * Called by reduced_solver.c in each iteration, and by reduced_tangent.c. */
#ifndef EHD_ROW_SYSTEM_H
#define EHD_ROW_SYSTEM_H

#include "common/physics/exit.h"
#include "common/physics/far_field.h"
#include "romrun/solve/least_squares.h"
#include "romrun/solve/reduced_solver.h"
#include "romrun/state/node_state.h"

typedef struct row_system {
    const reduced_model *model;
    reynolds_row *rows;      // [rows of the model] rows evaluated at the state
    double *fluid_memory;    // [NUM_FLUID_ARRAYS, num_needed]
    far_field outer;         // far field at the boundary nodes among the needed nodes
    double *pressure;        // [num_needed] P of the state, including the far field
    double *about;           // [num_needed] pressures that system_about returns
    contact_closure closure; // closure at the state, including the load beyond the grid
    size_t num_active;       // number of rows before the exit
    size_t num_cells;        // 1: the exit lies between two nodes, and the row of its cell is the
                             // last row; 0: the exit is a node
    size_t *active;          // [rows of the model] indices of the rows before the exit
    double *matrix;          // [system_max_rows, num_unknowns]
    double *right;           // [system_max_rows]
    double *step;            // [num_unknowns]
    double *offset;          // [num_unknowns] gradient of the exit's offset within its cell
    double *flux_step;       // [num_unknowns] gradient of the flux
    reynolds_row flux;       // flux and its derivatives, from system_flux
    size_t flux_row;         // row of the model at which the flux is taken
    least_squares *factors;
    // Work array for the update of the Jacobian to the present exit (eq. 36 of Maier et al.
    // (2015)). For a coupled basis, [rows + 1, CUT_BLOCK]: left factors of the updates of the
    // active rows and of the load. For an independent basis, [CUT_BLOCK, rows of the cut table +
    // num_pressure]: factors of the updates of the cut table.
    double *block;
    double *block_right; // coupled basis, [CUT_BLOCK, num_pressure]: right factors of the updates
    double *cut;         // independent basis, [rows of the cut table, num_pressure]: cut table for
                         // the exit line cut_exit
    size_t *cut_exit;    // [num_lines] exit line of `cut`; 0: `cut` has not been computed yet
} row_system;

/* Initialises with memory from an arena. The factors allocate their own memory. The model must
 * outlive the system. */
void system_init(row_system *self, const reduced_model *model, arena *memory);
void system_free(row_system *self);

/* Returns the largest number of rows of a least-squares problem of the model. */
size_t system_max_rows(const reduced_model *model);

/* Evaluates the closure and the rows before the exit, with their derivatives, at the state that
 * `nodes` holds. Stores the rows in self->rows. If `about`, [num_needed], is not NULL, evaluates
 * the rows at these pressures and extrapolates them linearly to the pressures of the state. */
void system_evaluate(row_system *self, const node_state *nodes, double rigid_approach,
                     const ehd_contact *contact, const reduced_squeeze *squeeze,
                     const double *about);

/* Returns reynolds_flow_doubt at the selected rows, for the state that `nodes` holds. */
double system_flow_doubt(row_system *self, const node_state *nodes, double rigid_approach,
                         const ehd_contact *contact);

/* Returns the pressures about which the rows of a time step are linearised while the state is far
 * from the solution (romrun/online/README.md, In time).
 * - `last` not NULL: [num_needed] pressures of the state of the last time step, not set to zero
 *   behind the exit. Returns at each node the higher pressure of `last` and of the state in
 *   `nodes`.
 * - `last` NULL: call the function after system_evaluate. Where the pressure has risen since the
 *   last linearisation, returns the pressure of the state. Where it has fallen, returns the
 *   pressure at which the mobility equals the mobility of the linearised rows. */
const double *system_about(row_system *self, const node_state *nodes, double rigid_approach,
                           const ehd_contact *contact, const double *last);

/* Lists the rows before the exit. Leaves out the row at `cell_node`, because the cell with the exit
 * has a row of its own. NO_NODE: leaves out no row. */
void system_list_active(row_system *self, const node_state *nodes, size_t cell_node);

/* Returns the flux of the state through the half node before the selected row nearest to X = 0. In
 * a solution the flux is the same everywhere before the exit. Near the exit, pressure errors of a
 * truncated basis would change the computed flux most. */
double system_flux(row_system *self, const ehd_contact *contact, const node_state *nodes);

/* Appends the row of the cell in which the exit lies, and fills self->offset. */
void system_add_cell(row_system *self, const node_state *nodes, const exit_cell *cell);

/* Appends only the right side of the cell's row, behind the rows that system_fill_right has
 * filled. */
void system_add_cell_right(row_system *self, const node_state *nodes, const exit_cell *cell);

/* Fills the right side (Maier et al. (2015), eq. 37): the listed Reynolds rows (zero behind the
 * exit), then projected elasticity, then closure. Returns the number of rows. */
size_t system_fill_right(row_system *self, const node_state *nodes, const double *z,
                         const size_t *list, size_t num_list, double closure_weight);

/* Fills the matrix (eq. 38) for the active rows, at the present exit. */
void system_fill_matrix(row_system *self, const node_state *nodes, double closure_weight);

/* Returns the weight of the closure, 1 + rate. The weighted closure then grows as 1 / time step, as
 * the Reynolds rows do. */
double system_closure_weight(const reduced_squeeze *squeeze);

#endif
