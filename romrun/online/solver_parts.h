/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of the online solver share: its memory, and the steps of an iteration. For them alone. */
#ifndef EHD_SOLVER_PARTS_H
#define EHD_SOLVER_PARTS_H

#include "romrun/model/reduced_cut.h"
#include "romrun/online/least_squares.h"
#include "romrun/online/reduced_solver.h"

/* Keeps the exit of a line from cycling: after it has turned round it moves by single nodes, and stays where it
 * is after some more turns. Near places that ask for one another, which keeps the pressure from converging,
 * do so for ever: then it stays at once. */
typedef struct exit_watch {
    // it cycles where it turned more often than this, wants to move by so many nodes at most, and the
    // pressure changes by less than `small`, or less than `stalled` and hardly less than before
    int most_turns;
    size_t near;
    double small, stalled;

    double change; // of the pressure, in the last iteration
    int direction, turns;
} exit_watch;

struct reduced_solver {
    const reduced_model *model;
    reduced_settings settings;
    reduced_observer *observer;
    void *observer_context;
    least_squares *least_squares;
    least_squares *kept; // factors of an earlier Jacobian
    double *kept_matrix; // [num_rows + num_deformation + 1, num_unknowns] that Jacobian
    bool has_kept;
    size_t *kept_exit;  // [num_lines]
    size_t num_kept;    // of its rows the first num_kept are Reynolds rows
    size_t *kept_row;   // [num_rows]
    double kept_weight; // of its closure

    size_t *exit;      // [num_lines] what follows is for; 0: none yet
    bool *alive;       // [num_needed] before the exit
    size_t checkpoint; // of the exit
    cut_run *runs;     // [num_lines] by which the exit differs from that one's
    size_t num_runs;
    double *cut; // [num_cut, num_pressure] the cut table for table_exit, which Jacobians take
    size_t *table_exit;  // [num_lines]; 0: none yet
    double *block;       // coupled: [num_rows + 1, CUT_BLOCK] left sides of the system's rows;
                         // independent: [CUT_BLOCK, num_cut + num_pressure] work of the cut table
    double *block_right; // [CUT_BLOCK, num_pressure] right sides of those of rows
    size_t *wanted, *moved; // [num_lines] exits asked for, and where they go
    exit_watch *watches;    // [num_lines]
    double *cut_value;      // [num_cut] the exit's cut table times z, which everything else takes
    double *step_cut;       // [num_cut] the same for a step
    reduced_values values, step_values;

    double *pressure, *film;           // [num_needed]
    double *step_pressure, *step_film; // [num_needed]
    double *fluid_memory;              // [4, num_needed]
    double *band_pressure;             // [num_band] P at band nodes, filled where asked for
    double *band_film;           // [num_band] H there, as the search for the exits asks for it
    size_t search, *band_search; // number of the search; [num_band] of the one that has asked
    reynolds_row *rows;          // [num_rows]
    size_t num_system;           // rows of the least-squares problem
    size_t *system_row;          // [num_rows] selected rows before the exit
    double *matrix;              // [num_rows + num_deformation + 1, num_unknowns]
    double *right;               // [num_rows + num_deformation + 1]
    double *step;                // [num_unknowns]
    double *start;               // [num_unknowns] to go back to; also scratch
    size_t *start_exit;          // [num_lines]
    double *observed;            // [2, num_rows]
};

// ---- the state at nodes (solver_nodes.c)

/* Makes the exit line the one that what follows is for: which needed nodes lie before it, its checkpoint and runs. */
void nodes_move_exit(reduced_solver *self, const size_t *exit);

/* The cut table of the exit's checkpoint, [num_cut, num_pressure]. */
const double *nodes_checkpoint_table(const reduced_solver *self);

/* Brings the cut table of an independent basis to the exit, always from the exit's checkpoint: its bits then depend on
 * the exit alone, and rounding errors do not add up over thousands of steps in time. Of a coupled one the rows of the
 * Jacobian are brought there instead, of which there are fewer (add_runs). */
void nodes_make_cut_table(reduced_solver *self);

/* P at `count` band nodes from place `first` on. */
void nodes_expand_places(reduced_solver *self, const double *z, size_t first, size_t count);

/* P at band nodes of a line contact from `from` up to before `to`. */
void nodes_expand_band(reduced_solver *self, const double *z, size_t from, size_t to);

/* P at the band nodes by which the exit differs from its checkpoint's. */
void nodes_expand_runs(reduced_solver *self, const double *z);

/* Values of coordinates at a checkpoint. */
void nodes_values_at(reduced_values *values, const reduced_model *model, const double *z,
                     size_t checkpoint);

/* values += factor * of; both of the same checkpoint. */
void nodes_add_values(reduced_values *values, double factor, const reduced_values *of,
                      const reduced_model *model);

/* P and H (without gap) at the needed nodes, and what the cut table makes of P, for coordinates z at the
 * solver's exit: eq. (36) applied to a vector. `values` may be known. */
void nodes_expand(double *pressure, double *film, double *cut_value, reduced_solver *self,
                  const reduced_values *values, const double *z);

/* P and H (without gap) of the state being worked on, at the needed nodes, and what the cut table makes of it, into
 * self->pressure, film and cut_value; its values at the exit's checkpoint may be known. */
void nodes_expand_state(reduced_solver *self, const reduced_values *known, const double *z);

/* Load of the pressure expanded last, over the kind's unit. */
double nodes_load(const reduced_solver *self);

/* H at `count` neighbouring nodes of a line of the band, at the solver's exit, and at one. For the coupled basis the
 * exit's checkpoint gives the deflection of what lies before it, and nodes_expand_runs or nodes_expand_band must have
 * filled the pressures by which the exit differs. */
void nodes_band_films(double *film, const reduced_solver *self, const double *z, size_t node,
                      size_t count);
double nodes_band_film(const reduced_solver *self, const double *z, size_t node);

/* target += factor * source. */
void nodes_add_row(double *target, double factor, const double *source, size_t count);

// ---- the exit boundary (solver_exits.c)

/* Whether the exits lie near enough to where they should be, in the mean of all lines. */
bool exits_settled(const reduced_solver *self);

/* Stationary, where the exit goes by the flux. A node's move changes the film by 1e-5 or a few of them: where
 * no more is asked the exit need not be looked for in a converged state. */
exit_watch exits_stationary_watch(const reduced_model *model, double tolerance);

/* In time; `stalled` is the change of the pressure that a node's move can make. */
exit_watch exits_watch_in_time(double stalled);

/* Watches the exits of all lines alike, from now on. */
void exits_watch(reduced_solver *self, exit_watch watch);

/* Moves the exits of a state, `change` being that of the pressure in this iteration; false where none moves. */
bool exits_adapt(reduced_info *info, reduced_solver *self, reduced_state *state,
                 const ehd_contact *contact, const reduced_squeeze *squeeze, double change);

// ---- the least-squares problem (solver_system.c)

/* The selected rows before the exit. */
void system_list_rows(reduced_solver *self);

/* Rows and their derivatives at the state, into self->rows. */
void system_evaluate_rows(reduced_solver *self, const ehd_contact *contact,
                          const reduced_squeeze *squeeze, const reduced_values *known,
                          const double *z);

/* Right side of eq. (37): the Reynolds rows listed (those behind the exit count as fulfilled), projected
 * elasticity, closure. Returns the number of rows. */
size_t system_fill_right(reduced_solver *self, const double *z, const size_t *list, size_t num_list,
                         const contact_closure *closure, double closure_weight);

/* Matrix of eq. (38) for the rows of the present system, at the present exit. */
void system_fill_matrix(reduced_solver *self, const contact_closure *closure,
                        double closure_weight);

/* Short steps make large rows, among which the closure must not get lost. */
double system_closure_weight(double rate);

#endif
