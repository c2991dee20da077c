/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The interface of the online solver: open a model once, then solve many scenes (README.md).
 * Called by romrun/main.c, and by the folders library, fmu and calibrate of romrun.
 *
 *     online_model *model = NULL;
 *     online_solver *solver = NULL;
 *     ehd_contact contact;
 *     online_result result;
 *     ehd_error error;
 *     scene given;
 *
 *     if (online_open(&model, "model.h5", NULL, &error) ||      // once
 *         online_solver_create(&solver, model, &error) ||       // once per thread
 *         scene_read(&given, "scene.yml", NULL, 0, &error) ||   // or fill a scene by scene_set
 *         scene_contact(&contact, &given, &error) ||
 *         online_solve(&result, solver, &contact, &error))      // as often as wanted
 *         fprintf(stderr, "%s\n", error.text);
 *
 * If a solution is not converged or not trusted, `status` and `reason` of the result or step report
 * this. The solver then tries nothing else, and the caller decides what to do. For example,
 * fallback_solve (romrun/calibrate/fallback.h) solves the contact with the full model and starts
 * from the last solution.
 *
 * There is no global state. Open and prepare models in one thread at a time, because HDF5 is not
 * thread-safe. Afterwards any number of solvers in as many threads may share a model. Solvers call
 * neither HDF5 nor FFTW, because these libraries may end the process if an allocation fails.
 * Opening a model switches off HDF5's messages and its filter plugins in the process. */
#ifndef ONLINE_H
#define ONLINE_H

#include "common/output/film_effects.h"
#include "common/output/indicated.h"
#include "common/physics/contact.h"
#include "common/physics/traction.h"
#include "common/program/solve_seconds.h"
#include "common/program/status.h"
#include "common/settings/part_list.h"
#include "common/settings/scene_contact.h"
#include "common/time/march.h"
#include "romrun/model/shown.h"
#include "romrun/model/sizes.h"
#include <stdbool.h>
#include <stddef.h>

typedef struct online_model online_model;
typedef struct online_solver online_solver;

/* Sizes and kind of a model, for information. */
typedef struct online_properties {
    size_t num_nodes;                         // number of nodes including the boundary nodes
    const char *discretization;               // "accurate" or "published"
    const char *boundary;                     // "open" or "zero"; "zero" for line contacts
    const char *transport;                    // transport of films in time: "path" or "upwind"
    size_t pressure_modes, deformation_modes; // numbers of modes in use
    size_t unknowns;                          // number of unknowns of the reduced system
    size_t rows;                              // number of selected Reynolds rows in use
    size_t states;                            // number of training solutions
    size_t parts; // number of models for parts of a region. The grid is then the grid with most
                  // nodes, `states` is the sum over all parts, and the other numbers above are
                  // those of the part with most unknowns
    // true: the sizes in use were calibrated by deimselect or romrun calibrate, on stationary
    // scenes (`checked`) or on trajectories (`checked_in_time`). Otherwise no error is estimated,
    // and a result with EHD_OK may have any error.
    bool checked, checked_in_time;
} online_properties;

/* One solution. Numbers are dimensionless unless a unit is given. */
typedef struct online_result {
    // EHD_OK: the contact is solved. EHD_NOT_CONVERGED: the iteration did not converge, or a
    // pressure is impossible in a contact. EHD_UNTRUSTED: the iteration converged, but the contact
    // lies outside of the trained range, or the residual or the number of iterations is so large
    // that the solution is probably false.
    ehd_status status;
    const char *reason; // text for a status other than EHD_OK, or ""; valid until the next solution
    contact_scalars scalars; // in the contact's frame; the load is relative to the frame's load
    double peak_pressure;    // largest P at the needed nodes and in the band
    size_t part;             // index of the part of the model that solved the contact
    size_t iterations;
    double residual;          // norm of the weighted least-squares residual
    double bound;             // bound of the relative error of the central film, without the factor
                              // that a calibration has measured
    double bound_minimum;     // bound of the relative error of the minimum film, without factor
    double indicated;         // estimated relative error of the central film; NaN: the model is not
                              // calibrated
    double indicated_minimum; // estimated relative error of the minimum film; NaN: the model is not
                              // calibrated
    solve_seconds seconds;
} online_result;

/* Numbers of modes and rows of a model or, for a list, of each of its files. */
typedef struct part_sizes {
    model_sizes of[MAX_PARTS];
} part_sizes;

/* Opens a model (HDF5 or flat file), or a list of models for parts of a region (schemas/models.md).
 * With a list, the part in whose trained range a contact lies deepest solves it. `sizes` NULL: all
 * modes and rows are used. A flat model can only be opened with its own sizes. Errors: EHD_NOINPUT,
 * EHD_DATA, EHD_MEMORY. */
ehd_status online_open(online_model **model, const char *path, const part_sizes *sizes,
                       ehd_error *error);
online_model *online_close(online_model *model); // accepts and returns NULL

/* Sets the list of lubricants on which the error estimates are calibrated, in each part, to
 * `shown`. Call it before a calibration on these lubricants, and before any solver is created.
 * Errors: EHD_MEMORY. */
ehd_status online_show(online_model *model, const shown_lubricants *shown, ehd_error *error);

/* Closes the model's file, which is otherwise kept open for online_prepare_fields,
 * online_prepare_transient and online_export. Afterwards these functions work only if the data was
 * prepared before; otherwise they return EHD_INTERNAL. HDF5 is not called again, not even by
 * online_close. */
void online_release_file(online_model *model);
online_properties online_describe(const online_model *model);

/* Returns NULL if the sizes in use were calibrated; with `in_time`, on trajectories. Otherwise
 * returns the reason why no result is trusted. */
const char *online_unchecked(const online_properties *model, bool in_time);

/* Checks whether a file begins like a flat model. Errors: EHD_NOINPUT, EHD_IO, EHD_MEMORY. */
ehd_status online_is_flat(bool *is, const char *path, ehd_error *error);

/* Prepares a model for fields and, if it can solve them, for transient contacts. Writes it as a
 * flat file. The flat model gives bit-identical results. EHD_CANTCREATE: the file exists, and
 * `force` is false. Other errors: EHD_DATA, EHD_IO, EHD_MEMORY. */
ehd_status online_export(online_model *model, const char *path, bool force, ehd_error *error);

/* Return the kind of contact and the grid of the model. Parts of line contacts may have
 * different grids: online_grid then returns the grid with most nodes. All parts have the same
 * discretisation. */
const contact_kind *online_kind(const online_model *model);
const ehd_grid *online_grid(const online_model *model);
/* Returns the grid of the part that solves a stationary contact. This is the part in whose trained
 * range the contact lies deepest. If some parts have the grid that the contact gives, the choice is
 * among these parts only. */
const ehd_grid *online_grid_for(const online_model *model, const ehd_contact *contact);
/* Checks whether the model can solve transient contacts. The discretisation must allow this, and
 * all parts must have the same grid. EHD_DATA: the model cannot; the text gives the reason. */
ehd_status online_check_in_time(const online_model *model, ehd_error *error);
/* Returns the path from which the model was opened. */
const char *online_path(const online_model *model);
/* Returns the path of a part by its index (online_result.part). */
const char *online_part_path(const online_model *model, size_t part);

/* Creates the memory of one solver. The model must outlive it. Errors: EHD_MEMORY. */
ehd_status online_solver_create(online_solver **solver, const online_model *model,
                                ehd_error *error);
online_solver *online_solver_free(online_solver *solver); // accepts and returns NULL

/* Sets the relative tolerance of online_solve, by default 1e-8. The iteration ends when the next
 * iteration is expected to change the central film by a smaller fraction. A looser tolerance may
 * save one iteration in three. */
void online_solver_set_tolerance(online_solver *solver, double tolerance);

/* Solves one contact, starting from the trained solutions. result->status reports a solution that
 * is not converged or not trusted. The solution is on the model's grid, even if M and L would give
 * another default grid. Returns EHD_OK, or EHD_DATA if grid, discretisation or boundary of the
 * scene differ from the model's. A scene that names no discretisation has the accurate
 * discretisation. A model of a version before 0.3.0 has the published discretisation. */
ehd_status online_solve(online_result *result, online_solver *solver, const ehd_contact *contact,
                        ehd_error *error);

/* Judges the pressures of a result on the whole grid, [num_nodes] from online_fields, as
 * online_solve judges the pressures at the needed nodes and in the band. Sets result->status to
 * EHD_NOT_CONVERGED in two cases: a pressure is more negative than round-off and truncation
 * explain, or above the limit of the viscosity law. */
void online_judge_pressure(online_result *result, const ehd_contact *contact,
                           const double *pressure, size_t num_nodes);

/* Error estimates of the last solution for the quantities besides the films. */
typedef struct online_indications {
    double bound[NUM_INDICATED];     // bound of the error, without its calibrated factor
    double deviation[NUM_INDICATED]; // estimated error; NaN: there is no estimate
} online_indications;

/* Estimates the errors of the quantities besides the films (indicated_quantity). This takes twice
 * as long as a solution, so it is a separate call. `contact`: the contact of the last online_solve.
 * If the load is given, the deviation of the load is the known difference between the result's load
 * and the given load. */
online_indications online_indicate(online_solver *solver, const ehd_contact *contact);

/* Returns the estimated error of the largest pressure of the last solution, in Hertz pressures.
 * NaN: the model is not calibrated. At a pressure spike this estimate is about as large as the
 * estimate of the pressure from online_indicate. The call takes no longer than the estimate of a
 * film. */
double online_indicate_peak(online_solver *solver);

/* Returns estimates of the errors of central and minimum film that the grid of the model's training
 * causes, by its step and by the length of its inlet. A solution of the model does not show these
 * errors. The estimates are interpolated between the estimates of the training points
 * (film_effects.h). NaN: the model has no estimates. Infinite: the grid is too coarse for an
 * estimate. The call takes about ten microseconds. Any number of threads may call this function. */
film_effects online_effects(const online_model *model, const ehd_contact *contact);

/* Returns whether the model computes tractions as sums over few nodes. This holds for models that
 * were trained with this version. */
bool online_has_traction(const online_model *model);

/* Returns the traction of the last solution, or NaN for all values if the solution did not
 * converge. The model must have traction. The call allocates nothing, and its cost does not grow
 * with the grid. `contact`: the contact of the last online_solve, with sliding. */
contact_traction online_traction(online_solver *solver, const ehd_contact *contact);

/* Return the bound of the relative error of a friction force from online_traction, and the error
 * estimate. NaN: the model has no traction, or no factor for its error. Each call takes an eighth
 * of the time of a solution. `contact`: as in online_traction, but its law of shear stress and its
 * sliding may differ from those of the solution. */
double online_friction_bound(online_solver *solver, const ehd_contact *contact, double friction);
double online_indicate_friction(online_solver *solver, const ehd_contact *contact, double friction);

/* Reads and computes the data for fields: two tables of [num_nodes, pressure_modes] numbers. Call
 * it once for a model, in one thread at a time; a second call does nothing. Errors: EHD_NOINPUT,
 * EHD_DATA, EHD_MEMORY. */
ehd_status online_prepare_fields(online_model *model, ehd_error *error);

/* Returns the grid of the last solution. */
const ehd_grid *online_solved_grid(const online_solver *solver);

/* Computes P and H of the last solution on the whole grid, [num_nodes] including boundary nodes; on
 * a half grid, only the nodes of this half. This is the only call for stationary contacts whose
 * cost grows with the grid. Any number of threads may call it, each with its own solver.
 * EHD_INTERNAL: neither fields nor transient scenes are prepared. */
ehd_status online_fields(double *pressure, double *film, const online_solver *solver,
                         ehd_error *error);

/* Writes X of the last solution's exit on each of the num_lines grid lines. */
void online_exits(double *positions, const online_solver *solver);

// ---- transient contacts: load, speed, radius or modulus vary

/* A transient contact, for an external integrator:
 *
 *     online_prepare_transient(model, &error);                            // once
 *     online_transient_create(&contact_in_time, model, &contact, &error); // once per contact
 *     online_transient_start(&state, contact_in_time, &conditions, &error);
 *     while (…) {
 *         do
 *             // as often as wanted, always from the last accepted state
 *             online_step(&state, contact_in_time, &conditions, step, &error);
 *         while (…);
 *         online_accept(contact_in_time);
 *     }
 *
 * Time is T = u_ref t / a_ref. Steps are BDF2, the first one BDF1. All inputs and outputs are
 * relative to the reference contact of online_transient_create. */
typedef struct online_transient online_transient;

/* Conditions at the end of a step, relative to the reference. */
typedef struct online_conditions {
    /* If the approach is NaN, this is the given load. Otherwise the load is an outcome, and this
     * member is an estimate of the load that scales the frame. NaN: the estimate is extrapolated
     * from the last steps. */
    double load;
    /* H0 in the reference frame: gap at X = 0 between the undeformed bodies. It is 0 if they just
     * touch, and negative if they overlap. NaN: the load is given. Deflections of a line contact
     * are relative to a point at the distance approach_length, which has to be at least half the
     * length of the grid (else EHD_DATA). */
    double approach;
    double speed; // entrainment, not negative
    double radius, modulus;
} online_conditions;

typedef struct online_state {
    ehd_status status;       // EHD_OK; EHD_NOT_CONVERGED: try a shorter step; EHD_UNTRUSTED
    const char *reason;      // reason of a status other than EHD_OK, or ""
    double time;             // T
    contact_scalars scalars; // in the reference frame; the load is relative to the reference load
    double half_width;       // half width of the frame, relative to the reference; 0: bodies apart
    double local_error;      // error that this step causes in the film, relative to the central
                             // film; 0: the error is not known yet
    // Estimated relative errors of central and minimum film, compared with the full model with the
    // same time steps. An error stays in the film until the fluid has left the contact. NaN: the
    // model is not calibrated on trajectories.
    double indicated, indicated_minimum;
    size_t iterations;
    double residual;
} online_state;

/* Reads and computes the data for transient scenes and fields. Call it once for a model, in one
 * thread at a time. */
ehd_status online_prepare_transient(online_model *model, ehd_error *error);

/* Creates a transient contact. The model must outlive it. EHD_DATA: the model has another grid or
 * discretisation; EHD_INTERNAL: the model is not prepared; EHD_MEMORY. */
ehd_status online_transient_create(online_transient **transient, const online_model *model,
                                   const ehd_contact *reference, ehd_error *error);
online_transient *online_transient_free(online_transient *transient); // accepts and returns NULL

/* Sets the error that the steps may cause in the central film, like the setting
 * transient.tolerance. With transport along the path, the iterations of a step then have a
 * tolerance of a tenth of the error that is allowed for this step, which saves a fifth of the
 * iterations. Otherwise the iterations have the default tolerance of online_solve. */
void online_transient_set_tolerance(online_transient *transient, double tolerance);

/* Allows time steps in which the fluid moves by much less than a grid step
 * (reduced_march_allow_short_steps). */
void online_transient_allow_short_steps(online_transient *transient);

/* Solves and accepts the stationary state of the conditions at time 0. If the solution does not
 * converge, no step can follow. EHD_DATA: the conditions are out of range. */
ehd_status online_transient_start(online_state *state, online_transient *transient,
                                  const online_conditions *conditions, ehd_error *error);

/* Solves the state that is `step` (in T) after the last accepted state. Allocates memory
 * (EHD_MEMORY) only if another part of the model takes the contact over; the cost of this grows
 * with the grid. EHD_DATA: as in online_transient_start; EHD_INTERNAL: the contact was neither
 * started nor restored. */
ehd_status online_step(online_state *state, online_transient *transient,
                       const online_conditions *conditions, double step, ehd_error *error);

/* Accepts the last step. Does nothing if that step did not converge, was refused or is already
 * accepted. */
void online_accept(online_transient *transient);

/* Restarts the steps after a jump of the conditions: the next step is of first order and uses only
 * the last accepted state. */
void online_restart(online_transient *transient);

/* Save the accepted state, [online_saved_size] numbers, and restore it in any object of the same
 * model and reference. The following steps are bit-identical. EHD_DATA: `saved` is not a saved
 * state; the object must then be started or restored anew. */
size_t online_saved_size(const online_transient *transient);
void online_save(double *saved, const online_transient *transient);
ehd_status online_restore(online_transient *transient, const double *saved, ehd_error *error);

/* Computes P and H of the accepted state on the whole grid, as online_fields does, in the state's
 * own frame. The cost grows with the grid. */
ehd_status online_transient_fields(double *pressure, double *film, online_transient *transient,
                                   ehd_error *error);

/* Returns the traction of the solved step that is not accepted yet. Without such a step, returns
 * the traction of the accepted state. The traction, `contact` and `scalars` are in the frame that
 * online_attempt_frame returns, and `contact` has sliding. NaN: the model has no traction. The call
 * does not change the following steps. */
contact_traction online_attempt_traction(online_transient *transient, const ehd_contact *contact,
                                         const contact_scalars *scalars);
contact_frame online_attempt_frame(const online_transient *transient);

/* Returns the largest pressure, in Hertz pressures of the reference, for the same state as
 * online_attempt_traction, at the needed nodes and in the band. 0: the bodies are apart. */
double online_transient_peak(const online_transient *transient);

/* Returns the frame of the accepted state. */
contact_frame online_transient_frame(const online_transient *transient);

/* Returns the index of the part that solved the last step, or the start. A contact stays with its
 * part while it lies in the part's trained range. When it leaves this range, another part takes it
 * over. The error estimates include the error of this transfer. */
size_t online_transient_part(const online_transient *transient);

/* Returns a solver for march_run. march_run chooses the steps itself. Use either march_run or the
 * calls above, not both in turn. */
march_solver online_march(online_transient *transient);

// ---- derivatives

/* Rates of change of the conditions along a direction, in the units of online_conditions. Either
 * load or approach is given, and the other one is NaN. */
typedef online_conditions online_direction;

/* Rates of change of the results along a direction, relative to the reference. */
typedef struct online_derivatives {
    // Derivatives of the scalars in the reference frame. The approach of a line contact is relative
    // to a point at the distance approach_length. The exit is NaN if only its node is known.
    // minimum_position has no meaning.
    contact_scalars scalars;
    double peak_pressure; // derivative of the largest pressure at the nodes, in Hertz pressures of
                          // the reference
    double half_width;
} online_derivatives;

/* Computes derivatives of the last stationary solution. The reference of the direction is this
 * solution: load, speed, radius and modulus are 1, and the approach is that of the solution.
 * `contact`: the contact of the last online_solve; its approach_length is used. The derivatives are
 * exact except for the effect of the residual that least squares leave (romrun/library/README.md).
 * The call takes as long as an iteration. EHD_DATA: the direction is not finite, or approach_length
 * is too short; EHD_INTERNAL: there is no solution. */
ehd_status online_differentiate(online_derivatives *derivatives, online_solver *solver,
                                const ehd_contact *contact, const online_direction *direction,
                                ehd_error *error);

/* Response of a stationary contact's load to a small slow change of the approach at constant speed:
 * dF = -(stiffness + s damping) dH0 for s -> 0, s in 1/T. */
typedef struct online_response {
    double stiffness, damping;
    // Change of the damping that the remaining least-squares residual of the squeeze term causes.
    // For ten models the error of the damping was 2 to 8 times this bound
    // (romrun/library/README.md).
    double damping_bound;
} online_response;
ehd_status online_respond(online_response *response, online_solver *solver,
                          const ehd_contact *contact, ehd_error *error);

/* Computes derivatives of the result of the last step with respect to the conditions at the end of
 * this step. The step must not be accepted yet. Before the first step, computes derivatives of the
 * start. EHD_INTERNAL: there is neither a step that is not accepted yet nor a start. */
ehd_status online_transient_differentiate(online_derivatives *derivatives,
                                          online_transient *transient,
                                          const online_direction *direction, ehd_error *error);
/* Computes the response of the start, as online_respond does for a stationary solution. */
ehd_status online_transient_respond(online_response *response, online_transient *transient,
                                    ehd_error *error);

#endif
