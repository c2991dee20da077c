/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds where the exit line of a state should be, and moves the exit line to this place (Maier et
 * al. (2015), eq. 39).
 * Called by reduced_solver.c in each iteration, by reduced_tangent.c, and by
 * romrun/trust/functionals.c. */
#ifndef EHD_EXIT_SEARCH_H
#define EHD_EXIT_SEARCH_H

#include "common/physics/exit.h"
#include "romrun/solve/reduced_solver.h"
#include "romrun/state/node_state.h"

/* Past moves of the exit of a grid line, from which exits_watch detects a limit cycle. */
typedef struct exit_watch {
    int direction;   // direction of the last wanted move: 1 downstream, -1 upstream, 0 none yet
    size_t distance; // length of the last wanted move, nodes
    int turns;       // number of changes of direction
    bool held;       // true: the exit stays at its node
} exit_watch;

typedef struct exit_search {
    const reduced_model *model;
    double spacing;         // distance between searched grid lines, half widths; 0: all lines
    size_t *wanted, *moved; // [num_lines] nodes where exits should be, and nodes to which they move
    exit_watch *watches;    // [num_lines]
    bool in_time;           // true: exits are held by the rule for transient runs (exits_watch)
    double *band_film;      // [nodes of the band] H, evaluated on demand
    size_t search, *band_search; // `search`: number of the present search; `band_search`, [nodes of
                                 // the band]: number of the search that evaluated band_film
    exit_cell cell;              // cell in which an exit between two nodes lies
} exit_search;

/* Initialises a search with memory from an arena. The model must outlive the search. `spacing`:
 * exit_spacing of reduced_settings. */
void exits_init(exit_search *self, const reduced_model *model, double spacing, arena *memory);

/* Change of P in one iteration, in Hertz pressures, below which the state counts as near the
 * solution. If this limit is 2e-2, negative pressures of an iterate move the exit of a time step by
 * two nodes (test_exit_search.c, an_exit_that_turns_by_more_goes_on). Models of
 * scenes/studies/stationary-line with 30, 66 and 110 modes solve 400 random stationary contacts (M
 * 5 to 50, L 1 to 20) in 17,485 iterations. If exits near the solution are not held after their
 * first change of direction, the models take 18,115 iterations. */
extern const double exits_near_change;

/* Starts to watch the exits for limit cycles. In a limit cycle the solution with the exit at one
 * node requires the exit at another node, and vice versa. The least squares then leave a pressure
 * or a multiplier with the wrong sign. After its first change of direction an exit therefore moves
 * by one node per iteration, and one of these rules holds it at its node:
 *
 * - Transient: the exit is held when it would reverse its direction and move by one node. It is
 *   held at the downstream one of these two nodes or, after an upstream move of more than SETTLED,
 *   at the upstream one.
 * - Stationary: the iteration may start at the solution of another contact, so an exit may turn
 *   more often. It is held after three more changes of direction. It is held after the first one if
 *   it would move by less than SETTLED and the pressure changes by less than exits_near_change.
 *
 * A transient exit that is not held cycles up to the iteration limit: the paper's transient case
 * (accurate discretisation, 120 modes, 140 rows, error control) then fails at T = 0.04. The
 * transient rule cannot replace the stationary rule: on the way from one contact to another, the
 * iteration would not converge (test_reduced_solver.c, any_trained_solution_leads_to_any_other).
 *
 * In a transient run, the exit of a line contact does not move while the state is far from the
 * solution (exits_near_change). If a thin film passes the outlet, some iterates have negative
 * pressures, which would move the exit upstream by ten nodes. Exit lines of point contacts move
 * less and may move in every iteration. If they also had to wait, the point contact of
 * scenes/studies/point-transient would take a quarter to a third more iterations. */
void exits_watch(exit_search *self, bool in_time);

/* Moves the exits of the state that `nodes` holds, after an iteration that changed the pressure by
 * `change`. Returns false if no exit moves. */
bool exits_adapt(exit_search *self, node_state *nodes, reduced_state *state,
                 const ehd_contact *contact, const reduced_squeeze *squeeze, double change);

/* Computes, for each grid line of the stationary point contact in `nodes`, the change of pressure
 * that moves the exit by a node. This margin is the smaller of two values: P at the last node with
 * pressure, and the multiplier at the next node divided by its derivative with respect to the
 * pressure there. The margin is 0 if one of these values has the wrong sign. It is infinite if the
 * line has no pressure in the band. */
void exits_margins(double *margin, // [num_lines]
                   exit_search *self, node_state *nodes, const double *z,
                   const ehd_contact *contact);

/* Computes self->cell of a stationary line contact. This cell lies behind the last node with
 * pressure in `nodes`. If the position of the exit in the cell is not known (state->exit_offset is
 * NaN), it is first computed from `flux`. Returns false if the state is too far from a solution to
 * have such a cell. */
bool exits_find_cell(exit_search *self, node_state *nodes, reduced_state *state,
                     const ehd_contact *contact, double flux);

/* Returns the position of the exit between two nodes (exit_place), for a solution whose exit is a
 * node. `nodes` holds this solution. */
double exits_place(exit_search *self, node_state *nodes, const reduced_state *state,
                   const ehd_contact *contact, const reduced_squeeze *squeeze);

/* Moves an exit that lies between two nodes by `change` grid steps. Returns false if the end of the
 * band stops the exit. */
bool exits_move_cell(reduced_state *state, const reduced_model *model, double change);

/* Checks whether the mean distance between the exits and the wanted exits, over all grid lines, is
 * small (SETTLED). */
bool exits_settled(const exit_search *self, const node_state *nodes);

#endif
