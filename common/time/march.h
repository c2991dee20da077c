/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Marches the full or the reduced model through time. It computes frames from histories, controls
 * the step size by the local error (or keeps it fixed), stops at events and repeats rejected steps
 * (README.md, Step control).
 * Called by common/output/time_run.c, romrun/calibrate/recording.c and snapgen/trajectory.c. */
#ifndef EHD_MARCH_H
#define EHD_MARCH_H

#include "common/physics/traction.h"
#include "common/program/solve_seconds.h"
#include "common/program/status.h"
#include "common/settings/scene.h"
#include "common/time/bdf.h"
#include "common/time/frame.h"
#include "common/time/history.h"
#include <stdbool.h>
#include <stddef.h>

/* Outcome of one implicit step. */
typedef struct march_step {
    ehd_status status; // EHD_OK, EHD_NOT_CONVERGED, or EHD_UNTRUSTED: solved, but not to be trusted
    const char *reason; // why the status is not EHD_OK, or ""
    contact_frame frame;
    double step; // 0 at the start
    bdf_formula formula;
    // Largest local error of rho H, relative to the central film. In short steps with transport
    // along the path, it is the error that a film accumulates on its way to the centre. 0: there is
    // no estimate.
    double local_error;
    contact_scalars scalars; // in the current frame
    // Estimated relative changes of central and minimum film in the limit of small time steps and,
    // with transport along the path, without filter (README.md, Errors in time). NaN: no estimate.
    double effect, effect_minimum;
    // Largest relative error of rho H that a film on its way to the centre has accumulated so far,
    // in this step and the steps before. 0: no estimate.
    double taken_up;
    // Estimated relative deviation of central and minimum film from the full model with the same
    // steps. NaN: the deviation is not known.
    double indicated, indicated_minimum;
    // Estimated relative error of the central film because of the length of the inlet, as if the
    // contact were stationary. 0: the error is not known.
    double inlet_effect;
    size_t iterations; // Newton iterations
    double residual;
    bool by_full_model; // the full model solved the step as a fallback
    bool apart;         // the bodies do not touch (apart.h)
    bool begins;        // the bodies have just touched again; earlier states are not used
} march_step;

/* Marks a solved step as EHD_UNTRUSTED. If `reason` is NULL, the step stays unchanged. */
void march_distrust(march_step *self, const char *reason);

/* A solver that can take steps. `self` is the solver's own data. */
typedef struct march_solver {
    void *self;
    /* Solves the state that is `step` later than the last accepted state, in the given frame. The
     * accepted states do not change, so a step can be repeated. outcome->frame is the given frame,
     * except when the bodies are apart or have just touched. A step that does not converge is an
     * outcome, not an error. */
    ehd_status (*attempt)(march_step *outcome, void *self, const contact_frame *frame, double step,
                          ehd_error *error);
    void (*accept)(void *self); // accepts the state of the last attempt
    // after a jump: discards all accepted states except the last one
    void (*restart)(void *self);
    /* Solves and accepts the state to start from, which is stationary in the given frame. If the
     * approach is given, outcome->frame is scaled by the load of the solution. An approach of NaN
     * stands for the approach that belongs to the load. */
    ehd_status (*start)(march_step *outcome, void *self, const contact_frame *frame,
                        ehd_error *error);
    /* Finds the lightest stationary contact that the solver can solve, at the speed, radius and
     * modulus of a frame with a load of 1. Returns its rigid approach H0 in the reference frame and
     * its load, or NaN for both if there is no such contact. apart_march (apart.h), the only
     * caller, takes this approach as the approach at which the bodies touch. After the call the
     * accepted states are still valid, but the state of the last attempt is not. */
    ehd_status (*touching)(double *approach, double *load, void *self, const contact_frame *frame,
                           ehd_error *error);
    /* Save and restore all data that are needed to continue from the last accepted state, as
     * numbers. EHD_DATA: the numbers are not valid data. */
    size_t (*saved_size)(const void *self);
    void (*save)(double *saved, const void *self);
    ehd_status (*restore)(void *self, const double *saved, ehd_error *error);
    /* Computes P and H of the last accepted state at all nodes, [num_nodes]. */
    ehd_status (*fields)(double *pressure, double *film, void *self, ehd_error *error);
    /* Computes the exits of the last accepted state, [inner lines of grid_whole, GRID_EXITS]: X in
     * the frame of the state on each line, the farthest downstream first; NaN: no exit. */
    void (*exits)(double *positions, const void *self);
    /* Computes the traction of the last accepted state in its frame, without its fields. `contact`
     * is the contact in that frame, `scalars` are the scalars of the step. NULL: the caller
     * computes the traction from the fields. */
    contact_traction (*traction)(void *self, const ehd_contact *contact,
                                 const contact_scalars *scalars);
    /* Returns the computing times of all solutions so far, also for steps that were not accepted.
     * `total` lacks the time between solutions. NULL: the solver only wraps another one, which
     * returns these times (apart.h). */
    solve_seconds (*seconds)(const void *self);
} march_solver;

typedef struct march_settings {
    double end_time;
    // largest estimated deviation from the full model with which a step is trusted; 0: no limit
    double accuracy;
    // limit of a step's local error and of a film's accumulated error; NaN with a fixed step
    double tolerance;
    double fixed_step; // NaN: the local error controls the steps
    double first_step; // length of the first step after the start, and after a jump
    bool approach_given;
    double reference_approach; // H0 for a factor of 1, when the approach is given
} march_settings;

/* Forecast of the load that scales the next frame, if the load follows from the solution. All
 * members are doubles, so that the struct can be saved. */
typedef struct load_forecast {
    double load;  // load of the last accepted state; the reference load while bodies are apart
    double scale; // load that scaled the frame of that state
    double rate;  // rate of change of the load in the last accepted step
    // Length of the last accepted step. 0: no step in contact since the start, a jump, or a time at
    // which the bodies were apart.
    double last_step;
} load_forecast;

/* State of a march. A march can be continued from this struct and the solver's states. All members
 * are doubles, so that the struct can be saved. */
typedef struct march_state {
    double time, step; // reached time, and length of the next attempt
    // Step and error of the last rejected attempt. rejected_step 0: no attempt was rejected since
    // the last accepted step, or the rejected attempt did not converge.
    double rejected_step, rejected_error;
    double noise;      // recently observed noise of the solver's local errors
    double at_kink;    // 1 if the histories have a kink at `time`, else 0
    double last_event; // time of the last event that is treated as equal to `time`; `time` if there
                       // is no such event
    load_forecast forecast;
    double num_steps, num_rejected,
        num_iterations;     // whole numbers
    double untrusted_since; // time of the first untrusted step; NaN: all steps are trusted
} march_state;

enum { MARCH_REASON = 256 };

/* Save and restore a text as numbers, one per character. */
void march_save_text(double saved[MARCH_REASON], const char text[MARCH_REASON]);
void march_restore_text(char text[MARCH_REASON], const double saved[MARCH_REASON]);

typedef struct march {
    march_settings settings;
    const ehd_histories *histories;
    const ehd_contact *reference;
    march_solver solver;
    march_state state;
    /* Stores an accepted step. `index` is 0 for the start, 1 for the first step. */
    ehd_status (*store)(void *sink, const march_step *step, size_t index, ehd_error *error);
    void *sink;
    char deviation[MARCH_REASON]; // why the last step exceeded the accuracy
    char reason[MARCH_REASON];    // why the march ended before end_time, or ""
    char rejected[MARCH_REASON];  // why the last rejected step was rejected
    char untrusted[MARCH_REASON]; // why the first untrusted step was not to be trusted, or ""
} march;

/* Returns the settings of the march of a transient scene. */
march_settings march_settings_of(const scene *given, const ehd_histories *histories,
                                 double reference_approach);

/* Returns the frame at `time`. It is scaled by `load` if the approach is given, else by the load of
 * the history. */
contact_frame march_frame(const march_settings *settings, const contact_kind *kind,
                          const ehd_histories *histories, double time, double load);

/* Checks that a start with a given approach is not at rest. At rest there is no stationary contact
 * whose load could follow from the approach. EHD_DATA. */
ehd_status march_check_start(double speed, bool approach_given, ehd_error *error);

/* Checks whether the estimated deviation of a film exceeds the accuracy, and writes the reason.
 * Returns false without an estimate (NaN) and with an accuracy of 0. */
bool march_deviates(char reason[MARCH_REASON], double central, double minimum, double accuracy);

/* Starts a forecast from the outcome of a start, or continues it with an accepted step. */
void load_forecast_start(load_forecast *self, const march_step *start);
void load_forecast_accept(load_forecast *self, const march_step *step);

/* Returns an estimate of the next load, to scale the frame of a step. The rate of the last step is
 * extrapolated over at most bdf_most_growth times the length of this step, since the rate of a very
 * short step is not reliable. In short steps the scale moves towards the forecast only by the
 * fraction frame_step_share. Otherwise the error of the last forecast would change the frame at an
 * unlimited rate. */
double load_forecast_scale(const load_forecast *self, double step, const ehd_grid *grid);

/* Solves the start of the march, at time 0. If the start does not converge, outcome->status is
 * EHD_NOT_CONVERGED, and no other function of this march may be called. A reference approach of NaN
 * in self->settings is replaced by the approach of the start. */
ehd_status march_begin(march_step *outcome, march *self, ehd_error *error);

/* Marches on to end_time. If the step size becomes too small, or the march hardly advances, the
 * march ends there: *outcome is EHD_NOT_CONVERGED, self->reason is the cause, and all stored steps
 * stay valid. Otherwise *outcome is EHD_OK. EHD_INTERRUPTED and failures of the solver or `store`
 * are errors. */
ehd_status march_run(ehd_status *outcome, march *self, ehd_error *error);

/* Marches from the start to end_time, and stores the start and all steps. `reason`: why the march
 * did not start or did not reach end_time, or "". Errors: as of march_run. */
ehd_status march_whole(char reason[MARCH_REASON], march *self, ehd_error *error);

#endif
