/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Marches any model in time by BDF2 steps (bdf.h; README.md, BDF2). The march holds the accepted
 * states. With transport along the path it also holds the base, which is the initial film; only the
 * differences of later films from the base are carried along the path (README.md, Along the path).
 * The march computes local errors, and saves and restores states. A model supplies the functions of
 * bdf_model.
 * Called by fullrun/full_march.c and romrun/online/reduced_march.c. */
#ifndef EHD_BDF_MARCH_H
#define EHD_BDF_MARCH_H

#include "common/program/arena.h"
#include "common/time/bdf.h"
#include "common/time/film_errors.h"
#include "common/time/march.h"

/* Source: BDF2 with equal steps. Factor by which this formula enlarges the sum of errors that are
 * added to a film in many steps, such as the changes that the filter causes. The factor is the
 * coefficient of the newest film in the formula for the time derivative, times the step. */
extern const double march_error_growth;

/* Distance from the exit boundary, in half widths, within which the local error is not evaluated.
 * The boundary moves by whole nodes, which causes noise near the boundary. Shorter steps do not
 * reduce this noise (test_full_march.c, local_error_is_that_before_the_exit). */
extern const double march_exit_margin;

/* Places of a model's states: the places of the ring, and one place for the base. With transport
 * along the path, previous states are carried as differences from the base (README.md, Along
 * the path). */
enum { BDF_BASE = BDF_STATES, NUM_BDF_PLACES };

/* A state on the grid, in a form that another model can take. */
typedef struct handed_state {
    double *pressure, *film; // [num_nodes]
    size_t *exits;           // [lines of the grid] columns of the exits
    double rigid_approach;
    contact_frame frame;
} handed_state;

/* Memory for handing states from one model to another. */
typedef struct hand_over {
    handed_state given, taken;       // a state of one model, and the same state in the other model
    double change[NUM_ERROR_PLACES]; // difference between the models' last accepted films
    arena memory;
} hand_over;

/* Functions of a model. `self` is the model's own struct, whose first member is a bdf_march. The
 * state that is being solved is at bdf_march_place(…, 0). */
typedef struct bdf_model {
    bool passes;   // accepted states may be passing (bdf.h)
    bool reverses; // the entrainment may be zero or reverse; false: the inlet is always at X < 0
    /* Solves the stationary state at the start. Sets the frame of this state and the whole outcome.
     * Discards previous states. */
    ehd_status (*start)(march_step *outcome, void *self, const contact_frame *frame,
                        ehd_error *error);
    /* Solves the attempt. The march has set the frame of the attempt and filtered the previous
     * states. `contact` comes from bdf_march_contact. Sets the masses, and status, reason, scalars,
     * iterations and residual of the outcome. */
    ehd_status (*solve)(march_step *outcome, void *self, const ehd_contact *contact,
                        ehd_error *error);
    void (*mark)(void *self); // sets masses.counts for the solved attempt
    /* Integrates bdf_march_missed over X from each upstream place to the centre. Returns the
     * largest integral divided by the path of the fluid in the step. */
    double (*error_on_the_way)(void *self);
    /* Decides whether the solved attempt can be trusted, and estimates the errors of its films. */
    void (*assess)(march_step *outcome, void *self, const ehd_contact *contact);
    void (*accept)(void *self); // accepts the solved state; called before `prepare`
    // accepts the errors of the attempt; not called for a passing state
    void (*keep_errors)(void *self);
    void (*restart)(void *self);                            // as in march_solver; may be NULL
    void (*copy)(void *self, size_t target, size_t source); // copies a state without its frame
    /* Prepares an accepted state as a previous state of the next steps. `share`, 0 to 1: the
     * fraction of the filter's effect that is applied (path_filter_apply). */
    void (*prepare)(void *self, size_t place, double share);
    ehd_status (*use_base)(void *self, ehd_error *error); // prepares the state at BDF_BASE
    /* Save and restore a state without its frame. EHD_DATA: the numbers are not a valid state. */
    void (*save)(double *target, const void *self, size_t place);
    ehd_status (*restore)(void *self, size_t place, const double *source, ehd_error *error);
    /* Save and restore all other data of the model, as numbers in front of the saved states and
     * behind these states. The other data are restored before the states are prepared. */
    void (*save_rest)(double *front, double *behind, const void *self);
    ehd_status (*restore_rest)(void *self, const double *front, const double *behind,
                               ehd_error *error);
    // Functions for handing states over to another model. They are NULL in models that never do so.
    void (*give)(handed_state *given, const void *self, size_t place); // sets all but the frame
    /* Takes a state as accurately as the model can represent it. The frame of the state is already
     * set. Error: EHD_MEMORY. */
    ehd_status (*take)(void *self, size_t place, const handed_state *given, ehd_error *error);
    /* Returns the errors that the last accepted film has accumulated along the path. */
    void (*give_errors)(double errors[NUM_ERROR_PLACES], const void *self);
    /* Takes the errors of give_errors from another model. `load_frame`: frame of the last state,
     * scaled by the load of its solution. */
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

/* Values of rho H, the mass of fluid per area, at the grid nodes of a model's rows. */
typedef struct bdf_masses {
    size_t num_rows;
    const size_t *node;             // [num_rows]
    double *solved;                 // [num_rows] rho H of the attempt
    double *previous[BDF_PREVIOUS]; // [num_rows] rho H of previous states, in the attempt's frame
    bool *counts;                   // [num_rows] whether the local error includes the node
} bdf_masses;

typedef struct bdf_march {
    // set by the model:
    const bdf_model *model;
    // contact with reference values of load, speed, radius and modulus; the histories are factors
    // on these values
    const ehd_contact *reference;
    contact_frame *frame[NUM_BDF_PLACES];       // frames of the model's states
    size_t state_size, front_size, behind_size; // how many numbers save and save_rest write
    bdf_masses masses;
    bool allows_short; // states at the end of short steps are passing (bdf_ring)
    solve_seconds seconds;
    // states:
    bdf_ring ring;
    bdf_ring accepted;        // the ring before the attempt, if `promoted`
    bool promoted;            // the attempt begins at the passing state
    double share[BDF_STATES]; // fraction of the filter that was applied to each state
    // the attempt:
    bdf_formula formula; // the rate is 0 after a start
    double step;         // time from the state at which the formula begins
    double entrainment;
} bdf_march;

/* Initialises a march without states. Allocates the arrays of self->masses, which hold rho H at the
 * nodes of num_rows rows, from `memory`. */
void bdf_march_init(bdf_march *self, size_t num_rows, arena *memory);

/* Returns the march as a solver for march_run. Its `self` is the model's struct. */
march_solver bdf_march_solver(bdf_march *self);

bool bdf_march_along_path(const bdf_march *self);

/* Returns the place of the state that is `steps` steps before the state being solved. Like the
 * formula, leaves out a passing state. */
size_t bdf_march_place(const bdf_march *self, size_t steps);

/* Returns the place of the accepted state that is `steps` steps before the attempt; 1 is the last
 * state. A passing state is included. */
size_t bdf_march_accepted(const bdf_march *self, size_t steps);

/* Computes the contact in a frame. contact->entrainment is the factor of the entrainment term in
 * the equations of a step. With transport along the path it is zero, because the time derivative
 * along the path contains this term. *entrainment is the entrainment of the fluid with either
 * transport. */
void bdf_march_contact(ehd_contact *contact, double *entrainment, const contact_frame *frame,
                       const bdf_march *self);

/* Returns rho H of the attempt minus its prediction, at the node of row r. This difference times
 * the formula's `error` is the local error. */
double bdf_march_missed(const bdf_march *self, size_t r);

// ---- handing a march to another model of the same reference and grid

/* Allocates memory for one grid. Free with hand_over_free. EHD_MEMORY. */
ehd_status hand_over_init(hand_over *self, const ehd_grid *grid, ehd_error *error);
void hand_over_free(hand_over *self);

/* Computes the values of a state at the nodes of the grid, and sets its frame. `place` is the index
 * of the state. */
void bdf_march_give(handed_state *given, const bdf_march *self, size_t place);

/* Takes the accepted states of another march, with the errors of their films. With transport along
 * the path, also takes the base of that march, unless `has_base`: this march has taken the base
 * before. Sets work->change. Error: EHD_MEMORY. */
ehd_status bdf_march_take_over(bdf_march *self, const bdf_march *from, bool has_base,
                               hand_over *work, ehd_error *error);

#endif
