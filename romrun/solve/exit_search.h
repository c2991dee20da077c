/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds where a state's exit line should be, and moves it there (Maier et al. (2015), eq. 39).
 * Called by reduced_solver.c in each iteration, by reduced_tangent.c, and by
 * romrun/trust/functionals.c. */
#ifndef EHD_EXIT_SEARCH_H
#define EHD_EXIT_SEARCH_H

#include "common/physics/exit.h"
#include "romrun/solve/reduced_solver.h"
#include "romrun/state/node_state.h"

/* Keeps the exit of a line from a limit cycle, in which the solution with the exit at one node
 * requires another node. Least squares leave pressure or multiplier with the wrong sign there. */
typedef struct exit_watch {
    double change; // change of the pressure in the last iteration
    int direction, turns;
    size_t asked; // nodes from the exit to the wanted one, when they last differed
    bool held;    // the exit stays for good (HELD_AT_TURN)
} exit_watch;

/* Rules by which an exit is held. */
typedef enum {
    // in time, near the solution (`far`): after the first turn the exit moves by single nodes. If
    // it would then go back by one node, it is held for good. It is held at the farther of the two
    // nodes; at the nearer one, if the wanted exit was far away from the farther one
    HELD_AT_TURN,
    // stationary, on the way from another contact: after the first turn the exit moves by single
    // nodes, and after three more turns it is held. It is held at once if it would move by a node
    // or two, and the pressure changes by less than `small` or hardly less than in the iteration
    // before
    HELD_IN_CYCLE
} exit_hold;

typedef struct exit_search {
    const reduced_model *model;
    double spacing;         // half widths between the lines that are searched; 0: all
    size_t *wanted, *moved; // [num_lines] where the exits should be, and where they are moved to
    exit_watch *watches;    // [num_lines]
    exit_hold hold;
    double small;                // limit for the change of the pressure (HELD_IN_CYCLE)
    double far;                  // change of the pressure above which the exits stay
    double *band_film;           // [nodes of the band] H, evaluated on demand
    size_t search, *band_search; // number of the search; [nodes of the band] search of band_film
    exit_cell cell;              // cell of an exit within a node
} exit_search;

/* Initialises a search with memory from an arena; the model must outlive it. `spacing` as in
 * reduced_settings. */
void exits_init(exit_search *self, const reduced_model *model, double spacing, arena *memory);

/* Relative change of the central film if the exit moves by a node (README.md, Within a node). */
extern const double exit_node_change;

/* Start the watches. `tolerance`: relative tolerance of the central film.
 *
 * In time the exit of a line contact stays while an iteration changes the pressure by more than
 * `far`. It is then the exit of the last step. If a thin film passes the outlet, some iterates have
 * negative pressures, which would cut the exit back by ten nodes and hold it there. Exit lines of
 * point contacts move by less and have no such limit: with it the point of
 * scenes/studies/point-transient takes a quarter to a third more iterations to the same solution.
 *
 * In time an exit that is not held cycles to the iteration limit (paper's transient case, accurate
 * rows, 120 modes, 140 rows, error control: lost at T = 0.04). With HELD_IN_CYCLE it takes 1967
 * iterations in place of 1637 (fixed steps, period 3/5). Held at the nearer of both nodes, the
 * minimum film is 0.36 % off in place of 0.22 %. In one of 81 stationary lines (published rows,
 * WLF) the film is 1e-3 off with HELD_AT_TURN, 2.7e-4 with HELD_IN_CYCLE. */
void exits_watch_stationary(exit_search *self, double tolerance);
void exits_watch_in_time(exit_search *self, double far);

/* Moves the exits of the state that `nodes` holds, after an iteration that changed the pressure by
 * `change`. Returns false if no exit moves. */
bool exits_adapt(exit_search *self, node_state *nodes, reduced_state *state,
                 const ehd_contact *contact, const reduced_squeeze *squeeze, double change);

/* Computes how much the pressure has to change for each exit of the stationary point contact in
 * `nodes` to move. It is the lesser of P at the line's last node, and the multiplier at the next
 * node over its derivative by the pressure. 0: the sign is wrong. Infinite: the line has no
 * pressure in the band. */
void exits_margins(double *margin, // [num_lines]
                   exit_search *self, node_state *nodes, const double *z,
                   const ehd_contact *contact);

/* Finds self->cell of a stationary line contact, whose exit lies within the last node that has
 * pressure in `nodes`. If the place of the exit in this node is not known, the flux determines it.
 * Returns false if the state is too far from a solution to have such a cell. */
bool exits_find_cell(exit_search *self, node_state *nodes, reduced_state *state,
                     const ehd_contact *contact, double flux);

/* Returns exit_place of a solution whose exit is at a node, for the state that `nodes` holds. */
double exits_place(exit_search *self, node_state *nodes, const reduced_state *state,
                   const ehd_contact *contact, const reduced_squeeze *squeeze);

/* Moves the exit of the cell by a number of steps. Returns false if it is held at the end of the
 * band. */
bool exits_move_cell(reduced_state *state, const reduced_model *model, double change);

/* Checks whether the exits lie near where they should be, in the mean of all lines (SETTLED). */
bool exits_settled(const exit_search *self, const node_state *nodes);

#endif
