/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Full-order solver: Newton on pressure and rigid approach, active set for the exit boundary, GMRES
 * with FFT deflection and a factorised near field (fullrun/README.md). */
#ifndef EHD_FULL_SOLVER_H
#define EHD_FULL_SOLVER_H

#include "common/physics/contact.h"
#include "common/physics/deflection.h"
#include "common/physics/far_field.h"
#include "common/physics/reynolds.h"
#include "common/physics/traction.h"
#include "common/program/status.h"
#include "common/program/team.h"
#include <stdbool.h>
#include <stddef.h>

/* A state of the contact on its grid. */
typedef struct full_state {
    double *pressure; // [num_nodes], zero at the boundary nodes, where ruptured and from `exit` on
    double *film;     // [num_nodes]
    double rigid_approach;
    size_t exit; // node where the film ruptures: behind it none has pressure, at most num_nodes - 1
    // where the exit lies within a node (common/physics/README.md): its distance from the last node
    // with pressure, exit - 1, in steps, 0 to 1, in time as exit_place has it; NaN: at a node, or
    // not known yet
    double exit_offset;
    // [num_nodes] nodes before `exit` without pressure: of a line contact only in time, where it
    // shrinks faster than it entrains; of a point contact all, boundary nodes included
    bool *ruptured;
} full_state;

/* Whether a node carries pressure. */
bool full_has_pressure(const full_state *state, size_t node);

/* X at which the pressure of a line contact ends. */
double full_exit_position(const full_state *state, const ehd_grid *grid);

/* Whether the film between the nodes around the smallest one comes to zero: the grid does not carry
 * it, and the smallest film of its scalars is that of a node. */
bool full_film_closes(const full_state *state, const ehd_grid *grid);

/* Whether an interval of pressure reaches the grid's end downstream, of an entrainment to larger X
 * or `backwards`. */
bool full_is_cut(const full_state *state, const ehd_grid *grid, bool backwards);

typedef struct full_info {
    ehd_status status;        // EHD_OK or EHD_NOT_CONVERGED
    size_t newton_iterations; // on the contact's own grid, all stages of a continuation together
    size_t gmres_iterations;
    double residual;        // largest scaled residual of passive rows and closure
    double complementarity; // violation of the exit conditions: max(-P), scaled max(-Lambda)
    double seconds;
    double seconds_rows, seconds_linear; // parts: rows and deflection; linear systems
    const char *reason;                  // why it did not converge, or ""
} full_info;

typedef struct full_system full_system;

/* Solves J dz = -residual to a relative tolerance and writes dz to system->step and step_approach.
 * Entry of full_settings, so that tests can use a dense factorisation. */
typedef ehd_status full_linear_solver(full_system *system, double tolerance, size_t *iterations,
                                      ehd_error *error);

/* Called before each Newton iteration, on coarser grids too. */
typedef void full_watcher(void *context, const ehd_grid *grid, size_t iteration, double residual);

typedef struct full_settings {
    double tolerance;                 // on the scaled residual; 1e-10
    size_t max_iterations;            // Newton, of one solve; 60
    size_t near_field;                // m, nodes kept of the kernel in the preconditioner; 8, of a
                                      // point contact at most 1
    double linear_tolerance;          // GMRES, relative; 1e-8
    full_linear_solver *solve_linear; // full_solve_gmres
    bool exit_at_node;                // always, as in time; false: where exit_is_within_node is not
    bool as_large;                    // grids of point contacts of any size are solved as large
                                      // ones: on the way to one; false
    team *threads;                    // that share the work on large grids, one solution at a time;
                                      // they change no bit; NULL: none
    full_watcher *watcher;            // NULL: none
    void *watcher_context;
} full_settings;

full_settings full_default_settings(void);

/* The linearised problem of one Newton step: unknowns are P at the nodes with pressure, then H0. */
struct full_system {
    const ehd_grid *grid;
    ehd_deflection *deflection;
    size_t num_unknowns;              // nodes with pressure
    const size_t *unknown;            // [num_unknowns] the nodes, ascending
    const size_t *index;              // [num_nodes] of a node in `unknown`, NO_NODE for all others
    const reynolds_stencil *stencils; // [num_inner], of grid_node_of_row
    const reynolds_row *rows;         // [num_inner], used at the unknowns' nodes
    const double *row_scale;          // [num_inner], 1 / largest entry of the row
    const far_field *outer; // boundary nodes, of which dP/dH0 is used; NULL: of zero pressure
    // scaled closure: closure_approach H0 + closure_load sum weight P + closure_residual = 0
    double closure_approach, closure_load, closure_residual;
    size_t near_field;
    bool keeps_factors;   // those of an earlier system may precondition this one
    double *step;         // [num_nodes], out: change of P, zero where it is not unknown
    double step_approach; // out: change of H0
    team *threads;        // that share the work; NULL: none
    void *workspace;      // of the linear solver
};

full_linear_solver full_solve_gmres;

typedef struct full_solver full_solver;

/* Whether a grid is of a point contact and so large that its linear systems are preconditioned by
 * multigrid, which takes less time and memory than factors. */
bool full_is_large(const ehd_grid *grid);

/* Whether with these settings a grid is solved as a large one. */
bool full_as_large(const ehd_grid *grid, const full_settings *settings);

/* Nodes of one part of what threads share (team_share): all of a grid that is not solved as a large one,
 * whose sums are not cut into parts. */
size_t full_part(const ehd_grid *grid, bool large);

/* Peak memory of a point contact's solution in bytes, about: counted, but for the factors of a grid
 * that is not large, whose fill was measured to grow as N log N. */
double full_solver_bytes(const ehd_grid *grid);

/* Grid-sized memory and FFT plans; one object a thread. EHD_MEMORY. */
ehd_status full_solver_create(
    // output:
    full_solver **solver, // free with full_solver_free
    // input:
    const contact_kind *kind, const ehd_grid *grid, const full_settings *settings,
    ehd_error *error);
full_solver *full_solver_free(full_solver *solver); // accepts and returns NULL
const full_settings *full_solver_settings(const full_solver *solver);

/* Heights by which the gap grows from now on, [num_nodes], which the caller keeps; NULL, as at first:
 * smooth surfaces. */
void full_solver_set_surface(full_solver *solver, const double *heights);

/* A state without pressure whose zone is filled. EHD_MEMORY. */
ehd_status full_state_init(full_state *state, const ehd_grid *grid, ehd_error *error);
void full_state_free(full_state *state);
/* Pressurises all inner nodes: the zone from which Newton starts where nothing is known. */
void full_state_fill(full_state *state, const ehd_grid *grid);
/* Sets the zone from the pressure: of a line the nodes before `exit`, of a point contact those
 * whose pressure is not zero. Where within a node a line's exit lies follows in full_solve from the
 * pressure at the last one. */
void full_state_set_zone(full_state *state, const ehd_grid *grid, size_t exit);
void full_state_copy(full_state *target, const full_state *source, const ehd_grid *grid);

/* Newton from the state given. Not converged is an outcome: the call returns EHD_OK and
 * info->status is EHD_NOT_CONVERGED. Errors: EHD_MEMORY, EHD_INTERNAL, EHD_INTERRUPTED. */
ehd_status full_solve(
    // output:
    full_info *info,
    // in and out: start and solution
    full_state *state,
    // input:
    full_solver *solver, const ehd_contact *contact,
    const reynolds_squeeze *squeeze, // NULL when stationary; rows are those of the inner nodes
    ehd_error *error);

/* Whether full_solve places the exit of a stationary contact within a node. */
bool full_exit_is_within_node(const full_solver *solver);

/* The same of a stationary contact with the exit at a node: a way to a start where Newton fails. */
ehd_status full_solve_nodal(full_info *info, full_state *state, full_solver *solver,
                            const ehd_contact *contact, ehd_error *error);

/* Cold start: on coarser grids first, there from the dry (Hertz) contact with an estimated film;
 * where that fails, continuation in M at small L, then in L. */
ehd_status full_solve_cold(full_info *info, full_state *state, full_solver *solver,
                           const ehd_contact *contact, ehd_error *error);

/* Newton from `state`, the solution of another contact on the same grid; where that fails, from a
 * cold start. */
ehd_status full_solve_from(full_info *info, full_state *state, full_solver *solver,
                           const ehd_contact *contact, ehd_error *error);

/* X of the exits on each line: one after each interval of nodes with pressure, on the side that the
 * entrainment leads to, the farthest downstream first; of more than GRID_EXITS the others are left
 * out. At nodes. */
void full_list_exits(
    // output:
    double *positions, // [inner lines of grid_whole, GRID_EXITS], NaN where there is none
    // input:
    const full_state *state, const ehd_grid *grid,
    bool backwards); // entrainment towards smaller x

/* The same of a line contact whose state full_solve has just found with the exit at a node, within
 * nodes where exit_place finds them there. */
void full_place_exits(double *positions, const full_state *state, const full_solver *solver,
                      const ehd_contact *contact, const reynolds_squeeze *squeeze, bool backwards);

/* Film and deflection of the pressure in `state`, from scratch. */
void full_film(full_state *state, full_solver *solver);

contact_scalars full_evaluate_scalars(const full_state *state, const ehd_contact *contact);
contact_traction full_evaluate_traction(const full_state *state, const ehd_contact *contact);

#endif
