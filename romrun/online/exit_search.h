/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where a state's exit line should be, and how far it is moved (Maier et al. (2015), eq. 39). */
#ifndef EHD_EXIT_SEARCH_H
#define EHD_EXIT_SEARCH_H

#include "common/physics/exit.h"
#include "romrun/online/node_state.h"

/* Keeps the exit of a line from a limit cycle of nodes, each of whose solutions asks for another
 * one: least squares leave pressure or multiplier the wrong sign there. */
typedef struct exit_watch {
    double change; // of the pressure, in the last iteration
    int direction, turns;
    size_t asked; // distance in nodes to the wanted exit, when it last differed
    bool held;    // for good (HELD_AT_TURN)
} exit_watch;

/* When it is held. */
typedef enum {
    // in time, near the solution (far): after the first turn the exit moves by single nodes. If it would then go back by one
    // node, it is held at the farther of the two; at the nearer one, if at the farther one the wanted exit was far away
    HELD_AT_TURN,
    // stationary, on the way from another contact: after it has turned round it moves by single
    // nodes, and after three more turns it is held; at once where it would move by a node or two
    // and the pressure changes by less than `small`, or hardly less than in the iteration before
    HELD_IN_CYCLE
} exit_hold;

typedef struct exit_search {
    const reduced_model *model;
    double spacing;         // half widths between the lines that are searched; 0: all
    size_t *wanted, *moved; // [num_lines] where the exits should be, and are moved to
    exit_watch *watches;    // [num_lines]
    exit_hold hold;
    double small;                // change of the pressure (HELD_IN_CYCLE)
    double far;                  // change of the pressure above which the exits stay where they are
    double *band_film;           // [nodes of the band] H, evaluated on demand
    size_t search, *band_search; // number of the search; [nodes of the band] that H is of
    exit_cell cell;              // in which an exit within a node lies
} exit_search;

/* Memory from an arena; the model must outlive it. `spacing` as in reduced_settings. */
void exits_init(exit_search *self, const reduced_model *model, double spacing, arena *memory);

/* Starts the watches: for a stationary state with a relative tolerance of the central film; in time,
 * where a line's exit stays while an iteration changes the pressure by more than `far`. It is that
 * of the step before, and where a thin film passes the outlet the pressures of some iterates are
 * negative; an exit cut back by ten nodes was held there. Exit lines of points move by less: with it
 * the point of scenes/studies/point-transient takes a quarter to a third more iterations to the
 * same.
 *
 * In time an exit that is not held cycles to the iteration limit (paper's transient case, accurate
 * rows, 120 modes, 140 rows, error control: lost at T = 0.04). Held as in a stationary contact it takes
 * 1787, 1967 and 1625 iterations (fixed steps, periods 1/2 and 3/5; tolerance 5e-3) in place of 1671,
 * 1637 and 1449, with films as far from the full model's, and with published rows 4622 in 1396 steps
 * to T = 1 in place of 2883 in 1197. At the nearer of both nodes it leaves 0.36 in place of 0.22 %
 * of the minimum film of period 3/5; where it is held at any turn, the march with published rows
 * ends at T = 3e-4. (Measured before exits moved by single nodes after a turn.) A stationary line (published rows, WLF, 81 contacts) that is held so is 1e-3 off in one
 * contact, 2.7e-4 by HELD_IN_CYCLE. */
void exits_watch_stationary(exit_search *self, double tolerance);
void exits_watch_in_time(exit_search *self, double far);

/* Moves the exits of the state that `nodes` holds, after an iteration that changed the pressure by
 * `change`. False: none moves. */
bool exits_adapt(exit_search *self, node_state *nodes, reduced_state *state,
                 const ehd_contact *contact, const reduced_squeeze *squeeze, double change);

/* By how little each exit of the stationary point contact that `nodes` holds is where it is, as a
 * change of pressure: P at the line's last node, or what the multiplier at the next one is worth there,
 * whichever is less; 0 where its sign is the wrong one, infinite on lines without pressure in the
 * band. */
void exits_margins(double *margin, // [num_lines]
                   exit_search *self, node_state *nodes, const double *z,
                   const ehd_contact *contact);

/* Finds self->cell of the stationary exit of a line within the last node that has pressure in
 * `nodes`, by the flux; where in it is not known, sets that too. False: the state is so far from a
 * solution that there is none. */
bool exits_find_cell(exit_search *self, node_state *nodes, reduced_state *state,
                     const ehd_contact *contact, double flux);

/* exit_place of a solution whose exit is at a node, by the state that `nodes` holds. */
double exits_place(exit_search *self, node_state *nodes, const reduced_state *state,
                   const ehd_contact *contact, const reduced_squeeze *squeeze);

/* Moves the exit of that cell by a number of steps. False: it is held at the end of the band. */
bool exits_move_cell(reduced_state *state, const reduced_model *model, double change);

/* Whether the exits lie, in the mean of all lines, near where they should be (SETTLED). */
bool exits_settled(const exit_search *self, const node_state *nodes);

#endif
