/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds where a state's exit line should be, and moves it there (Maier et al. (2015), eq. 39).
 * Called by reduced_solver.c in each iteration, by reduced_tangent.c, and by
 * romrun/trust/functionals.c. */
#ifndef EHD_EXIT_SEARCH_H
#define EHD_EXIT_SEARCH_H

#include "common/physics/exit.h"
#include "romrun/solve/reduced_solver.h"
#include "romrun/state/node_state.h"

/* Keeps the exit of a grid line out of a limit cycle: the solution with the exit at one node
 * requires the exit at another node, and vice versa. The least squares then leave pressure or
 * multiplier with the wrong sign. */
typedef struct exit_watch {
    double change; // change of the pressure in the last iteration
    int direction, turns;
    size_t asked; // distance in nodes from the exit to the wanted exit, when they last differed
    bool held;    // the exit stays for good (HELD_AT_TURN)
} exit_watch;

/* Rules by which an exit is held. */
typedef enum {
    // in time, near the solution (`far`): after the first turn the exit moves by single nodes. If
    // it would then go back by one node, it is held for good. It is held at the downstream one of
    // these two nodes, or at the upstream one if the wanted exit was far from the downstream node
    HELD_AT_TURN,
    // stationary, on the way from another contact: after the first turn the exit moves by single
    // nodes, and after three more turns it is held. It is held already after the first turn if two
    // conditions hold: it would move by a node or two, and the pressure changes by less than
    // `small` or hardly less than in the previous iteration
    HELD_IN_CYCLE
} exit_hold;

typedef struct exit_search {
    const reduced_model *model;
    double spacing;         // distance between searched grid lines, half widths; 0: all are
                            // searched
    size_t *wanted, *moved; // [num_lines] nodes where the exits should be, and nodes to which they
                            // move
    exit_watch *watches;    // [num_lines]
    exit_hold hold;
    double small;                // limit for the change of the pressure (HELD_IN_CYCLE)
    double far;                  // change of the pressure above which the exits stay
    double *band_film;           // [nodes of the band] H, evaluated on demand
    size_t search, *band_search; // number of the search; [nodes of the band] search of each
                                 // band_film
    exit_cell cell;              // cell in which an exit between two nodes lies
} exit_search;

/* Initialises a search with memory from an arena; the model must outlive it. `spacing` as in
 * reduced_settings. */
void exits_init(exit_search *self, const reduced_model *model, double spacing, arena *memory);

/* Relative change of the central film if the exit moves by a node (README.md, Within a node). */
extern const double exit_node_change;

/* Start the watches. `tolerance`: relative tolerance of the central film.
 *
 * In time the exit of a line contact stays while an iteration changes the pressure by more than
 * `far`. It then remains the exit of the last step. If a thin film passes the outlet, some iterates
 * have negative pressures, which would cut the exit back by ten nodes and hold it there. Exit lines
 * of point contacts move less and have no such limit. With a limit the point contact of
 * scenes/studies/point-transient takes a quarter to a third more iterations to the same solution.
 *
 * In time an exit that is not held cycles to the iteration limit (paper's transient case,
 * accurate rows, 120 modes, 140 rows, error control: lost at T = 0.04). With HELD_IN_CYCLE it
 * takes 1967 iterations in place of 1637 (fixed steps, period 3/5). If the exit is held at the
 * upstream node, the minimum film is 0.36 % off in place of 0.22 %. In one of 81 stationary line
 * contacts (published rows, WLF) the film is 1e-3 off with HELD_AT_TURN, and 2.7e-4 off with
 * HELD_IN_CYCLE. */
void exits_watch_stationary(exit_search *self, double tolerance);
void exits_watch_in_time(exit_search *self, double far);

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
