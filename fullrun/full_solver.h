/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Solves a contact with the full model. Newton's iteration finds pressure and rigid approach (eq.
 * 22 of Maier et al. 2015). An active set finds the exit boundary (eqs. 18-21). GMRES solves the
 * linear systems, with deflections by FFT and a factorised near field as preconditioner
 * (fullrun/README.md, Newton).
 * Called by main.c, training.c, full_march.c and resolution.c, and by romrun/calibrate. */
#ifndef EHD_FULL_SOLVER_H
#define EHD_FULL_SOLVER_H

#include "common/physics/contact.h"
#include "common/physics/deflection.h"
#include "common/physics/far_field.h"
#include "common/physics/reynolds.h"
#include "common/physics/traction.h"
#include "common/program/solve_seconds.h"
#include "common/program/status.h"
#include "common/program/team.h"
#include <stdbool.h>
#include <stddef.h>

/* A state of the contact on its grid. */
typedef struct full_state {
    double *pressure; // [num_nodes], zero at boundary and ruptured nodes and from node `exit` on
    double *film;     // [num_nodes]
    double rigid_approach;
    size_t exit; // line contact: node behind the last node with pressure, at most num_nodes - 1;
                 // point contact: num_nodes - 1
    // Position of an exit that lies within the cell of a node (common/physics/README.md, The exit
    // within a node). It is the distance of the exit from node exit - 1, the last node with
    // pressure, in grid steps, 0 to 1. In a transient run it is the value of exit_place. NaN: the
    // exit is at a node, or its position is not known yet.
    double exit_offset;
    // [num_nodes] whether a node before `exit` has no pressure. On a line contact, a solution has
    // such nodes only if a surface is not smooth or, in a transient run, if the contact shrinks
    // faster than it entrains fluid. On a point contact, all nodes without pressure are marked,
    // boundary nodes included.
    bool *ruptured;
} full_state;

/* Checks whether a node carries pressure. */
bool full_has_pressure(const full_state *state, size_t node);

/* Returns X at which the pressure of a line contact ends. */
double full_exit_position(const full_state *state, const ehd_grid *grid);

/* Checks whether the film that is interpolated between the nodes falls to zero. If so, the grid
 * does not resolve the film, and full_evaluate_scalars gives the smallest film at a node as the
 * minimum film. */
bool full_film_closes(const full_state *state, const ehd_grid *grid);

/* Checks whether pressure reaches the downstream end of the grid. This end lies at larger X, or at
 * smaller X if the entrainment is `backwards`. */
bool full_is_cut(const full_state *state, const ehd_grid *grid, bool backwards);

typedef struct full_info {
    ehd_status status;        // EHD_OK or EHD_NOT_CONVERGED
    size_t newton_iterations; // on the contact's own grid, summed over all stages of a continuation
    size_t gmres_iterations;
    // largest scaled residual of the load balance and of the Reynolds rows at nodes with pressure
    double residual;
    double complementarity; // violation of the exit conditions: max(-P), scaled max(-Lambda)
    solve_seconds seconds;  // without the time for the exit, which is not measured
    const char *reason;     // why the iteration did not converge, or ""
} full_info;

typedef struct full_system full_system;

/* Solves J dz = -residual to a relative tolerance and writes dz to system->step and step_approach.
 * The solver is a member of full_settings, so that tests can use a dense factorisation. */
typedef ehd_status full_linear_solver(full_system *system, double tolerance, size_t *iterations,
                                      ehd_error *error);

/* Function that is called before each Newton iteration, including iterations on coarser grids. */
typedef void full_watcher(void *context, const ehd_grid *grid, size_t iteration, double residual);

typedef struct full_settings {
    double tolerance;        // limit of the largest scaled residual; default 1e-10
    size_t max_iterations;   // limit of Newton iterations in one solution; default 60
    size_t near_field;       // the preconditioner uses the kernel only up to this distance in
                             // nodes; default 8, in a point contact at most 1
    double linear_tolerance; // relative tolerance of GMRES; default 1e-8
    full_linear_solver *solve_linear; // default full_solve_gmres
    // true: all exits are at nodes, as in transient runs. false, the default: an exit may lie
    // between nodes if exit_is_within_node allows this for the grid
    bool exit_at_node;
    // true: also a small point contact is solved by the methods for large ones. This is used for
    // the coarser grids of a large contact. Default false
    bool as_large;
    // These threads share the work of one solution on a large grid. The result does not depend on
    // their number. NULL: one thread does all work
    team *threads;
    full_watcher *watcher; // NULL: the iteration is not watched
    void *watcher_context;
} full_settings;

full_settings full_default_settings(void);

/* The linearised problem of a Newton step: unknowns are P at the nodes with pressure, then H0. */
struct full_system {
    const ehd_grid *grid;
    ehd_deflection *deflection;
    size_t num_unknowns;              // number of nodes with pressure
    const size_t *unknown;            // [num_unknowns] nodes of the unknowns, ascending
    const size_t *index;              // [num_nodes] place of a node in `unknown`, or NO_NODE
    const reynolds_stencil *stencils; // [num_inner], in the order of grid_node_of_row
    const reynolds_row *rows;         // [num_inner], of which the rows of the unknowns are used
    const double *row_scale;          // [num_inner], 1 / largest entry of the row
    const far_field *outer;           // dP/dH0 at the boundary nodes; NULL: zero pressure there
    // scaled closure: closure_approach H0 + closure_load sum weight P + closure_residual = 0
    double closure_approach, closure_load, closure_residual;
    size_t near_field;
    bool keeps_factors;   // factors of an earlier system may precondition this one
    double *step;         // [num_nodes], out: change of P, zero at nodes that are no unknowns
    double step_approach; // out: change of H0
    team *threads;        // threads that share the work; NULL: one thread does all work
    void *workspace;      // memory of the linear solver
};

full_linear_solver full_solve_gmres;

typedef struct full_solver full_solver;

/* Checks whether a grid belongs to a point contact and is so large that multigrid preconditions
 * its linear systems. Multigrid then takes less time and memory than factors. */
bool full_is_large(const ehd_grid *grid);

/* Checks whether a grid is solved like a large one with these settings. */
bool full_as_large(const ehd_grid *grid, const full_settings *settings);

/* Returns the number of nodes in one part of the work that threads share (team_share). A grid
 * that is not solved like a large one is a single part, so that its sums are not split. */
size_t full_part(const ehd_grid *grid, bool large);

/* Returns the approximate peak memory of a point contact's solution in bytes. All arrays are
 * counted. If the grid is not large, the memory of the factors is estimated: their measured fill
 * grows as N log N with the number of nodes N. */
double full_solver_bytes(const ehd_grid *grid);

/* Creates a solver with grid-sized memory and FFT plans. Each thread needs a solver of its own.
 * Errors: EHD_MEMORY. */
ehd_status full_solver_create(
    // output:
    full_solver **solver, // free with full_solver_free
    // input:
    const contact_kind *kind, const ehd_grid *grid, const full_settings *settings,
    ehd_error *error);
full_solver *full_solver_free(full_solver *solver); // accepts and returns NULL
const full_settings *full_solver_settings(const full_solver *solver);

/* Sets the heights that are added to the gap from now on, [num_nodes]. The caller keeps the
 * array. NULL, the initial value: smooth surfaces. */
void full_solver_set_surface(full_solver *solver, const double *heights);

/* Allocates a state with zero pressure. All of its inner nodes are in the pressurised zone. Error:
 * EHD_MEMORY. */
ehd_status full_state_init(full_state *state, const ehd_grid *grid, ehd_error *error);
void full_state_free(full_state *state);
/* Puts all inner nodes into the pressurised zone. Newton's iteration starts from this zone if no
 * solution is known. */
void full_state_fill(full_state *state, const ehd_grid *grid);
/* Sets the pressurised zone: on a line contact to the nodes before `exit`, on a point contact to
 * the nodes whose pressure is not zero. On a line contact, full_solve computes the position of the
 * exit within the cell of a node from the pressure at the last node. */
void full_state_set_zone(full_state *state, const ehd_grid *grid, size_t exit);
void full_state_copy(full_state *target, const full_state *source, const ehd_grid *grid);

/* Solves a contact by Newton from the given state. A solution that does not converge is an
 * outcome: the call returns EHD_OK and info->status is EHD_NOT_CONVERGED. Errors: EHD_MEMORY,
 * EHD_INTERNAL, EHD_INTERRUPTED. */
ehd_status full_solve(
    // output:
    full_info *info,
    // in and out: start and solution
    full_state *state,
    // input:
    full_solver *solver, const ehd_contact *contact,
    const reynolds_squeeze *squeeze, // time derivative at the inner nodes; NULL: stationary
    ehd_error *error);

/* Checks whether full_solve places the exit of a stationary contact within the cell of a node. */
bool full_exit_is_within_node(const full_solver *solver);

/* Solves a stationary contact like full_solve, but with the exit at a node. Newton can start from
 * this solution if it fails with the exit within a cell. */
ehd_status full_solve_nodal(full_info *info, full_state *state, full_solver *solver,
                            const ehd_contact *contact, ehd_error *error);

/* Solves a contact by a cold start. Coarser grids are solved first, the coarsest from the dry
 * (Hertz) contact with an estimated film. If this fails, continuation from an easy contact changes
 * first M at small L, then L. */
ehd_status full_solve_cold(full_info *info, full_state *state, full_solver *solver,
                           const ehd_contact *contact, ehd_error *error);

/* Solves a contact by Newton from `state`, the solution of another contact on the same grid. If
 * this fails, solves the contact by a cold start. */
ehd_status full_solve_from(full_info *info, full_state *state, full_solver *solver,
                           const ehd_contact *contact, ehd_error *error);

/* Lists the exits on each line, by X of their nodes. Each interval with a positive pressure has one
 * exit, at its downstream end. The exit farthest downstream comes first. At most GRID_EXITS exits
 * of a line are listed. */
void full_list_exits(
    // output:
    double *positions, // [inner lines of grid_whole, GRID_EXITS], NaN where there is no exit
    // input:
    const full_state *state, const ehd_grid *grid,
    bool backwards); // entrainment towards smaller x

/* Lists the exits of a line contact like full_list_exits, but at positions between nodes if
 * exit_place finds such positions. `state` must be the last solution of full_solve, with the exit
 * at a node. */
void full_place_exits(double *positions, const full_state *state, const full_solver *solver,
                      const ehd_contact *contact, const reynolds_squeeze *squeeze, bool backwards);

/* Computes the film of `state` from its pressure and rigid approach. */
void full_film(full_state *state, full_solver *solver);

contact_scalars full_evaluate_scalars(const full_state *state, const ehd_contact *contact);
contact_traction full_evaluate_traction(const full_state *state, const ehd_contact *contact);

#endif
