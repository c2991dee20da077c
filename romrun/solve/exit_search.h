/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds where a state's exit line should be, and moves it there (Maier et al. (2015), eq. 39).
 * Called by reduced_solver.c in each iteration, by reduced_tangent.c, and by
 * romrun/trust/functionals.c. */
#ifndef EHD_EXIT_SEARCH_H
#define EHD_EXIT_SEARCH_H

#include "common/physics/exit.h"
#include "romrun/solve/reduced_solver.h"
#include "romrun/state/node_state.h"

/* Changes of direction of the exit of a grid line (exits_watch). */
typedef struct exit_watch {
    int direction;   // of the last move that was wanted: 1 downstream, -1 upstream, 0 none yet
    size_t distance; // length of this move, nodes
    int turns;       // number of changes of this direction
    bool held;       // the exit stays
} exit_watch;

typedef struct exit_search {
    const reduced_model *model;
    double spacing;         // distance between searched grid lines, half widths; 0: all are
                            // searched
    size_t *wanted, *moved; // [num_lines] nodes where the exits should be, and nodes to which they
                            // move
    exit_watch *watches;    // [num_lines]
    bool in_time;           // rule by which an exit is held (exits_watch)
    double *band_film;      // [nodes of the band] H, evaluated on demand
    size_t search, *band_search; // number of the search; [nodes of the band] search of each
                                 // band_film
    exit_cell cell;              // cell in which an exit between two nodes lies
} exit_search;

/* Initialises a search with memory from an arena; the model must outlive it. `spacing` as in
 * reduced_settings. */
void exits_init(exit_search *self, const reduced_model *model, double spacing, arena *memory);

/* Change of P in one iteration below which the state is near the solution, Hertz pressures. With
 * 2e-2 negative pressures of an iterate move the exit of a step by two nodes (test_exit_search.c,
 * an_exit_that_turns_by_more_goes_on). 400 random stationary line contacts (M 5 to 50, L 1 to 20)
 * with 30, 66 and 110 modes of scenes/studies/stationary-line take 17,485 iterations. If exits are
 * not held at once near the solution, they take 18,115. */
extern const double exits_near_change;

/* Starts to watch the exits for limit cycles. In a limit cycle the solution with the exit at one
 * node requires the exit at another node, and vice versa. The least squares then leave pressure or
 * multiplier with the wrong sign. After its first change of direction an exit therefore moves by
 * single nodes.
 *
 * - In time, an exit that would then go back by one node is held. It is held at the downstream one
 *   of these two nodes, or at the upstream one if the move before was long (SETTLED).
 * - A stationary exit, on the way from another contact, is held after three more changes of
 *   direction, or after the first one if it would move by less than SETTLED and the pressure
 *   changes by less than exits_near_change.
 *
 * In time an exit that is not held cycles to the iteration limit (paper's transient case, accurate
 * rows, 120 modes, 140 rows, error control: lost at T = 0.04). One rule for both was tried. With
 * the rule of time a stationary contact is lost on the way from another one (test_reduced_solver.c,
 * any_trained_solution_leads_to_any_other).
 *
 * In time the exit of a line contact does not move while the state is far from the solution
 * (exits_near_change). It remains the exit of the last step. If a thin film passes the outlet, some
 * iterates have negative pressures, which would cut the exit back by ten nodes. Exit lines of point
 * contacts move less and have no such limit. With a limit the point contact of
 * scenes/studies/point-transient takes a quarter to a third more iterations to the same
 * solution. */
void exits_watch(exit_search *self, bool in_time);

/* Moves the exits of the state that `nodes` holds, after an iteration that changed the pressure by
 * `change`. Returns false if no exit moves. */
bool exits_adapt(exit_search *self, node_state *nodes, reduced_state *state,
                 const ehd_contact *contact, const reduced_squeeze *squeeze, double change);

/* Computes, for each grid line of the stationary point contact in `nodes`, the change of pressure
 * that moves the exit. It is the smaller of two values: P at the last node with pressure, and the
 * multiplier at the next node divided by its derivative by the pressure. 0: a sign is wrong.
 * Infinite: the line has no pressure in the band. */
void exits_margins(double *margin, // [num_lines]
                   exit_search *self, node_state *nodes, const double *z,
                   const ehd_contact *contact);

/* Finds self->cell of a stationary line contact, whose exit lies in the cell behind the last node
 * with pressure in `nodes`. If the place of the exit in this cell is not known, the flux determines
 * it. Returns false if the state is too far from a solution to have such a cell. */
bool exits_find_cell(exit_search *self, node_state *nodes, reduced_state *state,
                     const ehd_contact *contact, double flux);

/* Returns exit_place of a solution whose exit is at a node, for the state that `nodes` holds. */
double exits_place(exit_search *self, node_state *nodes, const reduced_state *state,
                   const ehd_contact *contact, const reduced_squeeze *squeeze);

/* Moves the exit of the cell by a number of steps. Returns false if the end of the band stops the
 * exit. */
bool exits_move_cell(reduced_state *state, const reduced_model *model, double change);

/* Checks whether the mean distance of the exits from the wanted exits, over all grid lines, is
 * small (SETTLED). */
bool exits_settled(const exit_search *self, const node_state *nodes);

#endif
