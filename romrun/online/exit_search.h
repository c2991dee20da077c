/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where the exit line should be for a state, and how far it is moved (Maier et al. 2015, eq. 39). */
#ifndef EHD_EXIT_SEARCH_H
#define EHD_EXIT_SEARCH_H

#include "romrun/online/node_state.h"

/* Keeps the exit of a line from a limit cycle: after it has turned round it moves by single nodes,
 * and after some more turns it stays. Where two near nodes each ask for the other, which would keep
 * the pressure from converging, it stays at once. */
typedef struct exit_watch {
    // it is in a limit cycle where it has turned more often than this, wants to move by so many nodes
    // at most, and the pressure changes by less than `small`, or less than `stalled` and hardly less
    // than before
    int max_turns;
    size_t near;
    double small, stalled;

    double change; // of the pressure, in the last iteration
    int direction, turns;
} exit_watch;

typedef struct exit_search {
    const reduced_model *model;
    double spacing;              // half widths between the lines that are looked at; 0: all
    size_t *wanted, *moved;      // [num_lines] exits asked for, and where they go
    exit_watch *watches;         // [num_lines]
    double *band_film;           // [nodes of the band] H there, as a search asks for it
    size_t search, *band_search; // number of the search; [nodes of the band] of the one that asked
} exit_search;

void exits_init(exit_search *self, const reduced_model *model, double spacing, arena *memory);

/* Begins to watch the exits: of a stationary state whose central film is to be known to a relative
 * tolerance, or in time, `stalled` being the change of the pressure that a node's move can make. */
void exits_watch_stationary(exit_search *self, double tolerance);
void exits_watch_in_time(exit_search *self, double stalled);

/* Moves the exits of the state that `nodes` holds, `change` being that of the pressure in this
 * iteration; false where none moves. */
bool exits_adapt(exit_search *self, node_state *nodes, reduced_state *state,
                 const ehd_contact *contact, const reduced_squeeze *squeeze, double change);

/* Whether the exits lie near enough to where they should be, in the mean of all lines. */
bool exits_settled(const exit_search *self, const node_state *nodes);

#endif
