/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The least-squares problem of an iteration: weighted selected Reynolds rows before the exit,
 * projected elasticity of an independent basis, closure. Owns rows, matrix, factors and step. */
#ifndef EHD_ROW_SYSTEM_H
#define EHD_ROW_SYSTEM_H

#include "common/physics/exit.h"
#include "common/physics/far_field.h"
#include "romrun/online/least_squares.h"
#include "romrun/online/node_state.h"

enum { ERROR_BLOCK = 32 }; // functionals of system_errors at a time

/* J (J^T J)^-1 g for the gradient g of a film: what an error of 1 in each row does to it. As long as the
 * gradient and the least squares are the same, as over many steps with kept factors, so are these. */
typedef struct film_moves {
    size_t number;    // of the least squares (step_problem); 0: of others
    double *gradient; // [num_unknowns]
    double *moves;    // [system_max_rows]
} film_moves;

typedef struct row_system {
    const reduced_model *model;
    reynolds_row *rows;      // [rows of the model] at the state
    double *fluid_memory;    // [NUM_FLUID_ARRAYS, num_needed]
    far_field outer;         // boundary nodes among the needed ones
    double *pressure;        // [num_needed] of the state, with that of the far field
    double *about;           // [num_needed] those of system_about
    contact_closure closure; // at the state, with the load beyond the grid
    size_t num_active;       // rows before the exit
    size_t num_cells;        // 1 where the exit lies within a node: its cell's row is the last one
    size_t *active;          // [rows of the model] these
    double *matrix;          // [system_max_rows, num_unknowns]
    double *right;           // [system_max_rows]
    double *step;            // [num_unknowns]
    double *gradient;        // [num_unknowns] of a film
    double *dual;            // [num_unknowns] (J^T J)^-1 gradient
    double remaining;   // what another step would change, over what the last one did, estimated
    double *left;       // [system_max_rows] what the step leaves
    bool left_is_known; // of the last solution
    film_moves moves[NUM_REDUCED_FILMS];
    double *offset;    // [num_unknowns] by which a step moves the exit within its node
    double *flux_step; // [num_unknowns] by which it changes the flux
    reynolds_row flux; // of system_flux
    size_t flux_row;   // of the model
    least_squares *factors;
    double *block;       // coupled: [rows + 1, CUT_BLOCK] left sides of the active rows;
                         // independent: [CUT_BLOCK, cut rows + num_pressure] work of the cut table
    double *block_right; // [CUT_BLOCK, num_pressure] right sides of those of rows
    double *functionals; // [ERROR_BLOCK, num_unknowns] of system_errors
    double *all_moves;   // [ERROR_BLOCK, system_max_rows]
    double *cut;         // independent: [cut rows, num_pressure] the cut table for cut_exit
    size_t *cut_exit;    // [num_lines]; 0: none yet
} row_system;

/* Memory from an arena, but for the factors; the model must outlive it. */
void system_init(row_system *self, const reduced_model *model, arena *memory);
void system_free(row_system *self);

/* Largest number of rows of a least-squares problem of the model. */
size_t system_max_rows(const reduced_model *model);

/* Rows before the exit and their derivatives at the state that `nodes` holds, into self->rows, and
 * the closure. `about`: NULL, or the pressures [num_needed] at which they are evaluated, and from
 * which they are linear in the pressures. */
void system_evaluate(row_system *self, const node_state *nodes, double rigid_approach,
                     const ehd_contact *contact, const reduced_squeeze *squeeze,
                     const double *about);

/* As reynolds_flow_doubt, at the rows before the exit of the state that `nodes` holds. */
double system_flow_doubt(row_system *self, const node_state *nodes, double rigid_approach,
                         const ehd_contact *contact);

/* Pressures about which a step in time is linearised while it is far from its solution (README.md, In
 * time). With those of the last state, uncut: the higher ones of it and of the state that `nodes` holds.
 * With NULL, after system_evaluate: those of the state where they have risen, and where they have fallen
 * those at which the mobility is what the linear rows had. */
const double *system_about(row_system *self, const node_state *nodes, double rigid_approach,
                           const ehd_contact *contact, const double *last);

/* Lists the rows before the exit; but for that at the node whose cell has one of its own, or
 * NO_NODE. */
void system_list_active(row_system *self, const node_state *nodes, size_t cell_node);

/* The flux at the state through the half node before the selected row nearest to X = 0. It is the
 * same before the exit, but there pressures that a truncated basis leaves would move it most. */
double system_flux(row_system *self, const ehd_contact *contact, const node_state *nodes);

/* Appends the row of the cell in which the exit lies, and makes self->offset. */
void system_add_cell(row_system *self, const node_state *nodes, const exit_cell *cell);

/* Its right side alone, behind those of system_fill_right. */
void system_add_cell_right(row_system *self, const node_state *nodes, const exit_cell *cell);

/* Right side (Maier et al. (2015), eq. 37): the Reynolds rows of a list (zero behind the exit),
 * projected elasticity, closure. Returns the number of rows. */
size_t system_fill_right(row_system *self, const node_state *nodes, const double *z,
                         const size_t *list, size_t num_list, double closure_weight);

/* Matrix (eq. 38) for the active rows, at the present exit. */
void system_fill_matrix(row_system *self, const node_state *nodes, double closure_weight);

/* Weight of the closure, 1 + rate: rows grow as 1 / time step. */
double system_closure_weight(const reduced_squeeze *squeeze);

/* The least-squares problem of a step: the system's own, or one kept of an earlier step. */
typedef struct step_problem {
    const double *matrix; // [num_rows + num_deformation + 1 + self->num_cells, num_unknowns]
    least_squares *factors;
    const size_t *row; // [num_rows] of the model
    size_t num_rows;   // Reynolds rows
    size_t number;     // of the matrix: another one for each; 0: none
} step_problem;

/* How far what the last step leaves in the rows, D f + D J step and as much of D J step as it was
 * too long or too short, moves the film of self->gradient, by the root of the sum of the squares
 * of what each row does. */
double system_film_error(
    // output:
    double *influence, // [rows of the model] change of the film by an error of 1 in D f; 0 if not
                       // active. NULL: not wanted
    // in and out:
    row_system *self,
    // input:
    const step_problem *problem, reduced_film film);

/* The same of the first `num` of self->functionals, with the residuals of other rows. */
void system_errors(
    // output:
    double *errors, // [num]
    // in and out:
    row_system *self, // its functionals are lost
    // input:
    size_t num, // at most ERROR_BLOCK
    const double
        *added); // [rows of the model] sum of the squares of residuals that are to count as
                 // one in the row

#endif
