/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A march of BDF2 steps (bdf.h) by any model. It has the accepted states, the base along the path,
 * local errors and saving. A model supplies the functions of bdf_model. */
#ifndef EHD_BDF_MARCH_H
#define EHD_BDF_MARCH_H

#include "common/program/arena.h"
#include "common/time/bdf.h"
#include "common/time/film_errors.h"
#include "common/time/march.h"

/* Source: BDF2 with equal steps. BDF2 enlarges an error that each of many equal steps adds to a film,
 * such as the change by the filter, by this factor. It is the formula's rate times the step. */
extern const double march_error_growth;

/* Distance before the exit boundary, in half widths, up to which the local error is evaluated.
 * Nearer to the exit its moves by whole nodes make a noise that no shorter step takes away
 * (test_full_march.c, local_error_is_that_before_the_exit). */
extern const double march_exit_margin;

/* Places of a model's states: those of the ring, and that of the base. Along the path, previous
 * states are carried as differences from the base (README.md, Along the path). */
enum { BDF_BASE = BDF_STATES, NUM_BDF_PLACES };

/* A state on the grid, for another model. */
typedef struct handed_state {
    double *pressure, *film; // [num_nodes]
    size_t *exits;           // [lines of the grid] columns
    double rigid_approach;
    contact_frame frame;
} handed_state;

/* Memory for handing states from one model to another. */
typedef struct hand_over {
    handed_state given, taken;       // a state of one model, and the same state in the other model
    double change[NUM_ERROR_PLACES]; // difference of both films for the last accepted state
    arena memory;
} hand_over;

/* Functions of a model. `self` is the model's own struct, whose first member is its bdf_march. The
 * state being solved is at bdf_march_place(…, 0). */
typedef struct bdf_model {
    bool passes;   // accepted states may be passing (bdf.h)
    bool reverses; // the entrainment may rest or reverse; else the inlet is always at X < 0
    /* Solves the stationary state to start from, and sets its frame. Previous states do not count
     * any more. Fills the whole outcome. */
    ehd_status (*start)(march_step *outcome, void *self, const contact_frame *frame,
                        ehd_error *error);
    /* Solves the attempt. Its frame is set, and the previous states have their share of the filter.
     * `contact` has the entrainment of the rows. Sets the masses, and status, reason, scalars,
     * iterations and residual of the outcome. */
    ehd_status (*solve)(march_step *outcome, void *self, const ehd_contact *contact,
                        ehd_error *error);
    void (*mark)(void *self); // sets `counts` of the masses for the solved attempt
    /* Returns the largest sum of missed rho H that a film takes up on its way to the centre, over
     * the path of the step. */
    double (*error_on_the_way)(void *self);
    /* Judges the solved attempt, and estimates the errors of its films. */
    void (*assess)(march_step *outcome, void *self, const ehd_contact *contact);
    void (*accept)(void *self);      // accepts the solved state, before it is prepared
    void (*keep_errors)(void *self); // accepts the errors of the attempt; not of a passing state
    void (*restart)(void *self);     // as in march_solver; NULL: nothing else to do
    void (*copy)(void *self, size_t target, size_t source); // copies a state without its frame
    /* Prepares an accepted state, to be carried along with a share of the filter, 0 … 1. */
    void (*prepare)(void *self, size_t place, double share);
    ehd_status (*use_base)(void *self, ehd_error *error); // prepares the base
    /* Save and restore a state without its frame. EHD_DATA: the numbers are no state. */
    void (*save)(double *target, const void *self, size_t place);
    ehd_status (*restore)(void *self, size_t place, const double *source, ehd_error *error);
    /* Save and restore everything else: numbers in front of the states and behind them. They are
     * restored before the states are prepared. */
    void (*save_rest)(double *front, double *behind, const void *self);
    ehd_status (*restore_rest)(void *self, const double *front, const double *behind,
                               ehd_error *error);
    // Handing states over. Models that are never handed over leave these NULL.
    void (*give)(handed_state *given, const void *self, size_t place); // all but the frame
    /* Takes a state whose frame is set, as nearly as the model can represent it. EHD_MEMORY. */
    ehd_status (*take)(void *self, size_t place, const handed_state *given, ehd_error *error);
    /* Returns the errors that the last accepted film has taken up along the path. */
    void (*give_errors)(double errors[NUM_ERROR_PLACES], const void *self);
    /* Takes these errors. `load_frame`: frame of the last state, scaled by the load of its
     * solution. */
    void (*take_errors)(void *self, const double errors[NUM_ERROR_PLACES],
                        const contact_frame *load_frame);
    /* Returns the frame of a state, scaled by the load of its solution. */
    contact_frame (*load_frame)(const void *self, size_t place);
    // as in march_solver
    ehd_status (*touching)(double *approach, double *load, void *self, const contact_frame *frame,
                           ehd_error *error);
    void (*exits)(double *positions, const void *self);
    contact_traction (*traction)(void *self, const ehd_contact *contact,
                                 const contact_scalars *scalars);
} bdf_model;

/* rho H at the nodes of a model's rows. */
typedef struct bdf_masses {
    size_t num_rows;
    const size_t *node;             // [num_rows]
    double *solved;                 // [num_rows] of the attempt
    double *previous[BDF_PREVIOUS]; // [num_rows] of previous states, in the attempt's frame
    bool *counts;                   // [num_rows] whether the local error counts there
} bdf_masses;

typedef struct bdf_march {
    // set by the model:
    const bdf_model *model;
    const ehd_contact *reference;               // the contact at all factors 1
    contact_frame *frame[NUM_BDF_PLACES];       // frames of the model's states
    size_t state_size, front_size, behind_size; // how many numbers the model saves
    bdf_masses masses;
    bool allows_short; // states may be passing if steps are short
    // states:
    bdf_ring ring;
    bdf_ring accepted;        // the ring before the attempt, if `promoted`
    bool promoted;            // the attempt begins at the passing state
    double share[BDF_STATES]; // share of the filter that a state was prepared with
    // the attempt:
    bdf_formula formula; // its rate is 0 after a start
    double step;         // time from the state at which the formula begins
    double entrainment;
} bdf_march;

/* Makes a march without states. Takes memory for the masses of num_rows rows. */
void bdf_march_init(bdf_march *self, size_t num_rows, arena *memory);

/* Returns the march as a solver for march_run. Its `self` is the model's struct. */
march_solver bdf_march_solver(bdf_march *self);

bool bdf_march_along_path(const bdf_march *self);

/* Returns the place of the state `steps` before the one being solved, as the formula uses it. */
size_t bdf_march_place(const bdf_march *self, size_t steps);

/* Returns the place of the accepted state `steps` before the attempt: 1 is the last one. A passing
 * state is an accepted one. */
size_t bdf_march_accepted(const bdf_march *self, size_t steps);

/* Sets the contact in a frame, with the entrainment of its rows in time. Along the path this is
 * zero, because the time derivative contains the entrainment. *entrainment: that of the fluid. */
void bdf_march_contact(ehd_contact *contact, double *entrainment, const contact_frame *frame,
                       const bdf_march *self);

/* Returns the error of rho H in the attempt at the node of row r, without the formula's factor: the
 * solution minus its prediction. */
double bdf_march_missed(const bdf_march *self, size_t r);

// ---- from one model to another of the same reference and grid, which continues the march

/* Allocates memory for one grid. Free with hand_over_free. EHD_MEMORY. */
ehd_status hand_over_init(hand_over *self, const ehd_grid *grid, ehd_error *error);
void hand_over_free(hand_over *self);

/* Computes a state on the grid. */
void bdf_march_give(handed_state *given, const bdf_march *self, size_t place);

/* Takes the accepted states of another march with their errors and, along the path, its base unless
 * `has_base`. Sets work->change. EHD_MEMORY. */
ehd_status bdf_march_take_over(bdf_march *self, const bdf_march *from, bool has_base,
                               hand_over *work, ehd_error *error);

#endif
