/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The march through time, the same for the full and the reduced model: frames from histories, step
 * sizes from the local error (or fixed), events, rejected steps. */
#ifndef EHD_MARCH_H
#define EHD_MARCH_H

#include "common/physics/traction.h"
#include "common/program/status.h"
#include "common/settings/scene.h"
#include "common/time/bdf.h"
#include "common/time/frame.h"
#include "common/time/history.h"
#include <stdbool.h>
#include <stddef.h>

/* What one implicit step came to. */
typedef struct march_step {
    ehd_status status; // EHD_OK, EHD_NOT_CONVERGED, or EHD_UNTRUSTED: solved, but not to be trusted
    const char *reason; // why it is not EHD_OK, or ""
    contact_frame frame;
    double step;             // 0 at the start
    bdf_formula formula;     // of the step
    double local_error;      // largest of rho H, relative to the central film; along the path what
                             // a film takes up on its way; 0: cannot be told
    contact_scalars scalars; // in the current frame
    // relative changes of central and minimum film by ever smaller steps in time and, along the
    // path, no filter, estimated (README.md, Errors in time); NaN: cannot be told
    double effect, effect_minimum;
    // largest error of rho H that a film on its way to the centre has taken up so far, in this step
    // and those before, relative; 0: none is told
    double taken_up;
    // relative deviation of both from the full model with the same steps, indicated; NaN: not known
    double indicated, indicated_minimum;
    size_t iterations; // Newton
    double residual;
    bool by_full_model; // of a solver that falls back on it; else false
    bool apart;         // the bodies do not touch (apart.h)
    bool begins;        // they have just touched again; earlier states are not used
} march_step;

/* Path of a step along which films are carried, half widths, up to which a film takes up the errors
 * of many steps on its way to the centre. Longer steps make the film that they find there, and its
 * error is that of the step. Without the difference a slow ramp of the load by 8 % ended 1.7 % off
 * in 18 steps; with it 0.14 % off in 396, of a tolerance of 0.15 %. */
extern const double march_short_path;

/* Along the path, a step is repeated where the film before the centre is farther from its prediction
 * than this part of the central film: the iteration has then found another solution. In the paper's
 * transient case no step is more than 0.014 off; solutions that rupture in the inlet, as after a load
 * step by a half, are 0.2 and more off. Steps that are predicted not to change the film are not checked. */
extern const double march_most_missed;

/* An error that steps of equal length add to a film one after the other, as what the filter changes,
 * BDF2 makes so many times as large: its rate times the step. */
extern const double march_error_growth;

/* The local error is looked at up to this far before the exit boundary, in half widths: nearer to
 * it, the exit's moves by whole nodes make a noise that no shorter step takes away. */
extern const double march_exit_margin;

/* A solver that can take steps. `self` is its own. */
typedef struct march_solver {
    void *self;
    /* Solves the state that is `step` later, in the frame given. The accepted states do not change, so a step can be
     * repeated. outcome->frame is the given frame, except when the bodies are apart or have just touched. A step that does not
     * converge is an outcome, not an error. */
    ehd_status (*attempt)(march_step *outcome, void *self, const contact_frame *frame, double step,
                          ehd_error *error);
    void (*accept)(void *self); // the state of the last attempt
    void (*restart)(
        void *self); // accepted states before the last one no longer count (after a jump)
    /* The state to start from: stationary in the frame given, which outcome->frame scales anew
     * where the approach is given; NaN stands for the approach that belongs to the load. It is
     * accepted. */
    ehd_status (*start)(march_step *outcome, void *self, const contact_frame *frame,
                        ehd_error *error);
    /* Finds the lightest stationary contact that the solver can solve, at the speed, radius and modulus of a frame with a load
     * of 1. Returns its rigid approach H0 in the reference frame and its load, or NaN for both if there is no such contact.
     * apart_march (apart.h), the only caller, takes this approach for the one at which the bodies touch. After the call the
     * accepted states are valid, and the last attempt is not. */
    ehd_status (*touching)(double *approach, double *load, void *self, const contact_frame *frame,
                           ehd_error *error);
    /* Everything needed to go on from the last accepted state, as numbers; EHD_DATA when they are
     * none. */
    size_t (*saved_size)(const void *self);
    void (*save)(double *saved, const void *self);
    ehd_status (*restore)(void *self, const double *saved, ehd_error *error);
    /* P and H of the last accepted state at all nodes, [num_nodes]. */
    ehd_status (*fields)(double *pressure, double *film, void *self, ehd_error *error);
    /* Its exits, [inner lines of grid_whole, GRID_EXITS]: X in its frame on each line, the farthest
     * downstream first, NaN where there is none. */
    void (*exits)(double *positions, const void *self);
    /* Its traction in its frame, of a contact there with the scalars of its step, without its fields;
     * NULL: from these. */
    contact_traction (*traction)(void *self, const ehd_contact *contact,
                                 const contact_scalars *scalars);
} march_solver;

typedef struct march_settings {
    double end_time;
    double accuracy; // indicated to deviate by more, a step is not to be trusted; 0: whatever it is
    double tolerance;  // on the local error of one step, or on what a film takes up; NaN with a
                       // fixed step
    double fixed_step; // NaN: steps by the local error
    double first_step; // after the start and after a jump
    bool approach_given;
    double reference_approach; // H0 that a factor of 1 stands for; when the approach is given
} march_settings;

/* Forecast of the load that scales the next frame, where the load is an outcome. All members are doubles, so that the struct can
 * be saved. */
typedef struct load_forecast {
    double load;      // of the last accepted state; of bodies apart that of the reference
    double scale;     // load that scaled the frame of that state
    double rate;      // of change of the load in the last accepted step
    double last_step; // that step; 0: none since the start, a jump or a contact's loss
} load_forecast;

/* Where a march stands: everything that it needs to go on, with the solver's states. */
typedef struct march_state {
    double time, step;                    // of the next attempt
    double rejected_step, rejected_error; // of the last attempt rejected at this step, 0: none
    double noise;      // of the solver's local errors, as far as it was met lately
    double at_kink;    // 1 where the histories have a kink at `time`, else 0
    double last_event; // of the histories that is one with `time`, else `time`
    load_forecast forecast;
    double num_steps, num_rejected,
        num_iterations;     // whole; all members are numbers of one type, so
                            // that the struct can be saved as such
    double untrusted_since; // time of the first step that was not to be trusted; NaN: none
} march_state;

enum { MARCH_REASON = 256 };

typedef struct march {
    march_settings settings;
    const ehd_histories *histories;
    const ehd_contact *reference;
    march_solver solver;
    march_state state;
    /* Takes an accepted step away; `index` counts from 1, the start being 0. */
    ehd_status (*store)(void *sink, const march_step *step, size_t index, ehd_error *error);
    void *sink;
    char deviation[MARCH_REASON]; // that of the last step, where it was above the accuracy
    char reason[MARCH_REASON];    // why it ended before end_time, or ""
    char rejected[MARCH_REASON];  // why the last step that was rejected was
    char untrusted[MARCH_REASON]; // why the first untrusted step was not to be trusted, or ""
} march;

/* Settings of a transient scene. */
march_settings march_settings_of(const scene *given, const ehd_histories *histories,
                                 double reference_approach);

/* The frame at `time`, scaled by `load` where the approach is given (and by the history where
 * not). */
contact_frame march_frame(const march_settings *settings, const contact_kind *kind,
                          const ehd_histories *histories, double time, double load);

/* At rest there is no stationary contact whose load an approach could lead to: EHD_DATA. */
ehd_status march_check_start(double speed, bool approach_given, ehd_error *error);

/* Whether a film is indicated to deviate by more than the accuracy, and by how much; not where nothing
 * is indicated (NaN), nor with an accuracy of 0. */
bool march_deviates(char reason[MARCH_REASON], double central, double minimum, double accuracy);

/* Starts a forecast from the outcome of a start, or continues it with an accepted step. */
void load_forecast_start(load_forecast *self, const march_step *start);
void load_forecast_accept(load_forecast *self, const march_step *step);

/* Returns a load near the next one, to scale the frame of a step. The rate is extrapolated over at most bdf_most_growth times the
 * last step, since a shorter step gives no reliable rate. In short steps the scale moves only by frame_step_share towards the
 * forecast. Otherwise the error of the last forecast would change the frame at an unlimited rate. */
double load_forecast_scale(const load_forecast *self, double step, const ehd_grid *grid);

/* Takes the march to its start, time 0. Not converged is an outcome: then nothing else may follow.
 * In self->settings the reference approach NaN is replaced by that of the start. */
ehd_status march_begin(march_step *outcome, march *self, ehd_error *error);

/* Goes on to end_time. Where a step size underflows, the march ends there: *outcome is
 * EHD_NOT_CONVERGED, self->reason says why and everything stored stands; EHD_OK else.
 * EHD_INTERRUPTED and what the solver or `store` return are errors. */
ehd_status march_run(ehd_status *outcome, march *self, ehd_error *error);

#endif
