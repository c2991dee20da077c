/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where a state's exit line should be, and how far it is moved (Maier et al. (2015), eq. 39). */
#ifndef EHD_EXIT_SEARCH_H
#define EHD_EXIT_SEARCH_H

#include "common/physics/exit.h"
#include "romrun/online/node_state.h"

/* Keeps the exit of a line from a limit cycle: after it has turned round it moves by single nodes,
 * and after three more turns it is held. In a limit cycle of two near exits, which keeps the
 * pressure from converging, it is held once it has turned more than max_turns times. */
typedef struct exit_watch {
    // a limit cycle: the exit would move by at most `near` nodes, and the pressure changes by less
    // than `small`, or by less than `stalled` and hardly less than in the iteration before
    int max_turns;
    size_t near;
    double small, stalled;

    double change; // of the pressure, in the last iteration
    int direction, turns;
} exit_watch;

typedef struct exit_search {
    const reduced_model *model;
    double spacing;              // half widths between the lines that are searched; 0: all
    size_t *wanted, *moved;      // [num_lines] where the exits should be, and are moved to
    exit_watch *watches;         // [num_lines]
    double far;                  // change of the pressure above which the exits stay where they are
    double *band_film;           // [nodes of the band] H, evaluated on demand
    size_t search, *band_search; // number of the search; [nodes of the band] that H is of
    exit_cell cell;              // in which an exit within a node lies
} exit_search;

/* Memory from an arena; the model must outlive it. `spacing` as in reduced_settings. */
void exits_init(exit_search *self, const reduced_model *model, double spacing, arena *memory);

/* Starts the detection of limit cycles: for a stationary state with a relative tolerance of the
 * central film; in time, where an exit's move by a node changes the pressure by up to `stalled`, and
 * a line's exit stays while an iteration changes it by more than `far`. It is that of the step
 * before, and where a thin film passes the outlet the pressures of some iterates are negative; an
 * exit cut back by ten nodes was held there. Exit lines of points move by less: with it the point of
 * scenes/studies/point-transient takes a quarter to a third more iterations to the same. */
void exits_watch_stationary(exit_search *self, double tolerance);
void exits_watch_in_time(exit_search *self, double stalled, double far);

/* Moves the exits of the state that `nodes` holds, after an iteration that changed the pressure by
 * `change`. False: none moves. */
bool exits_adapt(exit_search *self, node_state *nodes, reduced_state *state,
                 const ehd_contact *contact, const reduced_squeeze *squeeze, double change);

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
