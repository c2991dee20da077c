/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the least-squares problem of an iteration (Maier et al. (2015), eqs. 37 and 38):
 * weighted selected Reynolds rows before the exit, projected elasticity of an independent basis,
 * closure. Owns rows, matrix, factors and step.
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
    reynolds_row *rows;      // [rows of the model] at the state
    double *fluid_memory;    // [NUM_FLUID_ARRAYS, num_needed]
    far_field outer;         // far field at the boundary nodes among the needed ones
    double *pressure;        // [num_needed] P of the state, including the far field
    double *about;           // [num_needed] pressures of system_about
    contact_closure closure; // closure at the state, including the load beyond the grid
    size_t num_active;       // rows before the exit
    size_t num_cells;        // 1 if the exit lies between two nodes (the row of its cell is then
                             // the last row), else 0
    size_t *active;          // [rows of the model] indices of the rows before the exit
    double *matrix;          // [system_max_rows, num_unknowns]
    double *right;           // [system_max_rows]
    double *step;            // [num_unknowns]
    double *offset;          // [num_unknowns] gradient of the exit's offset within its cell
    double *flux_step;       // [num_unknowns] gradient of the flux
    reynolds_row flux;       // flux and its derivatives, from system_flux
    size_t flux_row;         // row of the model at which the flux is taken
    least_squares *factors;
    double *block;       // coupled: [rows + 1, CUT_BLOCK] left sides of the active rows;
                         // independent: [CUT_BLOCK, cut rows + num_pressure] work of the cut table
    double *block_right; // [CUT_BLOCK, num_pressure] coupled: right sides
    double *cut;         // independent: [cut rows, num_pressure] the cut table for cut_exit
    size_t *cut_exit;    // [num_lines] exit of `cut`; 0: none yet
} row_system;

/* Initialises with memory from an arena; the factors allocate their own memory. The model must
 * outlive it. */
void system_init(row_system *self, const reduced_model *model, arena *memory);
void system_free(row_system *self);

/* Returns the largest number of rows of a least-squares problem of the model. */
size_t system_max_rows(const reduced_model *model);

/* Evaluates the closure, and in self->rows the rows before the exit and their derivatives, at the
 * state that `nodes` holds. `about`: NULL, or pressures [num_needed] at which the rows are
 * evaluated; then the rows are extrapolated linearly to the state's pressures. */
void system_evaluate(row_system *self, const node_state *nodes, double rigid_approach,
                     const ehd_contact *contact, const reduced_squeeze *squeeze,
                     const double *about);

/* Returns reynolds_flow_doubt at the selected rows, for the state that `nodes` holds. */
double system_flow_doubt(row_system *self, const node_state *nodes, double rigid_approach,
                         const ehd_contact *contact);

/* Returns the pressures about which a step in time is linearised while it is far from its solution
 * (romrun/online/README.md, In time). If `last` holds the uncut pressures of the last state: at
 * each node the higher pressure of `last` and of the state in `nodes`. If `last` is NULL, after
 * system_evaluate: where the pressure has risen, the state's pressure; where it has fallen, the
 * pressure that has the mobility of the linear rows. */
const double *system_about(row_system *self, const node_state *nodes, double rigid_approach,
                           const ehd_contact *contact, const double *last);

/* Lists the rows before the exit, except the row at `cell_node`, whose cell has a row of its own.
 * NO_NODE: no exception. */
void system_list_active(row_system *self, const node_state *nodes, size_t cell_node);

/* Returns the state's flux through the half node before the selected row nearest to X = 0. The flux
 * is the same everywhere before the exit. Near the exit, pressures left by a truncated basis would
 * change it most. */
double system_flux(row_system *self, const ehd_contact *contact, const node_state *nodes);

/* Appends the row of the cell in which the exit lies, and fills self->offset. */
void system_add_cell(row_system *self, const node_state *nodes, const exit_cell *cell);

/* Appends only the right side of the cell's row, behind the rows of system_fill_right. */
void system_add_cell_right(row_system *self, const node_state *nodes, const exit_cell *cell);

/* Fills the right side (Maier et al. (2015), eq. 37): the listed Reynolds rows (zero behind the
 * exit), then projected elasticity, then closure. Returns the number of rows. */
size_t system_fill_right(row_system *self, const node_state *nodes, const double *z,
                         const size_t *list, size_t num_list, double closure_weight);

/* Fills the matrix (eq. 38) for the active rows, at the present exit. */
void system_fill_matrix(row_system *self, const node_state *nodes, double closure_weight);

/* Returns the weight of the closure, 1 + rate, because rows grow as 1 / time step. */
double system_closure_weight(const reduced_squeeze *squeeze);

#endif
