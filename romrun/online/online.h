/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The online solver as programs call it: open a model once, solve many scenes.
 *
 *     online_model *model = NULL;
 *     online_solver *solver = NULL;
 *     ehd_contact contact;
 *     online_result result;
 *     ehd_error error;
 *     scene given;
 *
 *     if (online_open(&model, "model.h5", NULL, &error) ||      // once
 *         online_solver_create(&solver, model, &error) ||       // once a thread
 *         scene_read(&given, "scene.yml", NULL, 0, &error) ||   // or fill a scene by scene_set
 *         scene_contact(&contact, &given, &error) ||
 *         online_solve(&result, solver, &contact, &error))      // as often as wanted
 *         fprintf(stderr, "%s\n", error.text);
 *
 * Nothing else is solved in place of a contact that the model does not solve well: `status` and
 * `reason` of each result and of each step say so, and what follows is the caller's. fallback_solve
 * of romrun/calibrate/fallback.h solves the contact with the full model, from the last solution.
 *
 * Nothing is global. Open and prepare models one thread at a time (HDF5 is not thread-safe); a model
 * may then be shared by any number of solvers in as many threads: neither HDF5 nor FFTW, which may
 * end a process that is refused memory, is called any more.
 * Opening a model switches off HDF5's messages and its filter plugins in the process. */
#ifndef ONLINE_H
#define ONLINE_H

#include "common/output/film_effects.h"
#include "common/output/indicated.h"
#include "common/physics/contact.h"
#include "common/physics/traction.h"
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
    size_t num_inner;                         // n, nodes of the full grid
    size_t num_nodes;                         // with the boundary nodes
    size_t num_lines;                         // across, both sides of a mirror; 1 of a line contact
    double x_min, step;                       // of the grid, in half widths
    const char *discretization;               // "accurate" or "published"
    const char *boundary;                     // "open" or, of a line contact too, "zero"
    const char *deformation;                  // "independent" or "coupled"
    const char *transport;                    // "path" or "upwind": of films in time
    size_t pressure_modes, deformation_modes; // in use
    size_t unknowns;                          // of the reduced system
    size_t rows;                              // selected Reynolds rows in use
    size_t needed_nodes;                      // nodes of their stencils
    size_t states;                            // training solutions
    size_t parts; // models for parts of a region; sizes are those of the largest
    // whether the sizes in use were measured (deimselect, romrun --calibrate) on stationary scenes, and
    // on trajectories; where not, no deviation is indicated, and a result that is OK may be off by any
    bool checked, checked_in_time;
} online_properties;

/* One solution; dimensionless unless stated. */
typedef struct online_result {
    ehd_status status;       // EHD_OK; EHD_NOT_CONVERGED, also where the pressure cannot be one;
                             // EHD_UNTRUSTED: solved, but outside of the trained range, or a false
                             // solution by its residual or iterations
    const char *reason;      // why it is not EHD_OK, or "", until the solver's next one
    contact_scalars scalars; // in the contact's frame; load relative to the wanted one
    double peak_pressure;    // the largest at the nodes that the solution looks at
    size_t part;             // of a model of parts, that has solved it
    size_t iterations;
    double residual;          // norm of the weighted least-squares residual
    double bound;             // of the relative deviation of the central film, up to a factor
    double bound_minimum;     // the same of the minimum film
    double indicated;         // deviation of the central film; NaN: not checked at these sizes
    double indicated_minimum; // and of the minimum film
    double seconds;           // of the solution, of which:
    double seconds_rows;      // rows and reduced Jacobian
    double seconds_linear;    // least squares
    double seconds_exit;      // exit boundary and its updates
} online_result;

/* Sizes of each file of a list, or of the one model. */
typedef struct part_sizes {
    model_sizes of[MAX_PARTS];
} part_sizes;

/* Loads a model, of HDF5 or flat, or a list of models for parts of a region (schemas/models.md), of which a
 * contact is solved by that in whose trained range it lies deepest. `sizes` NULL: all of it; a flat one
 * has no others than its own. Errors: EHD_NOINPUT, EHD_DATA, EHD_MEMORY. */
ehd_status online_open(online_model **model, const char *path, const part_sizes *sizes,
                       ehd_error *error);
online_model *online_close(online_model *model); // accepts and returns NULL

/* Replaces the lubricants on which the error estimates of each part were calibrated, since they are about to be calibrated
 * on these. Before any solver is created. EHD_MEMORY. */
ehd_status online_show(online_model *model, const shown_lubricants *shown, ehd_error *error);

/* Closes the file of a model, which stays open for online_prepare_fields, online_prepare_transient and
 * online_export: of these only what was prepared before works any more, others are EHD_INTERNAL, and
 * HDF5 is not called again, not by online_close either. */
void online_release_file(online_model *model);
online_properties online_describe(const online_model *model);

/* Why no result of a model is to be trusted that was not checked at these sizes, stationary or in time;
 * NULL: it was. */
const char *online_unchecked(const online_properties *model, bool in_time);

/* Whether a file begins as a flat model does. EHD_NOINPUT, EHD_IO, EHD_MEMORY. */
ehd_status online_is_flat(bool *is, const char *path, ehd_error *error);

/* Prepares a model for all that it can do and writes it as a flat file, whose results have the same bits.
 * EHD_CANTCREATE: there is such a file, without `force`; EHD_DATA, EHD_IO, EHD_MEMORY. */
ehd_status online_export(online_model *model, const char *path, bool force, ehd_error *error);

/* What films may be indicated to be off where nobody says how much, of a result to be trusted. */
extern const double online_accuracy;

/* Kind of contact and grid of the model; of parts of line contacts on different grids that with most nodes,
 * which has the discretisation of all. */
const contact_kind *online_kind(const online_model *model);
const ehd_grid *online_grid(const online_model *model);
/* That of the part which a stationary contact is solved by: of those on the grid that it asks for the one in
 * whose trained range it lies deepest. */
const ehd_grid *online_grid_for(const online_model *model, const ehd_contact *contact);
/* Whether contacts can be solved in time: the discretisation knows of time, and all parts are on one grid.
 * EHD_DATA, saying why not. */
ehd_status online_check_in_time(const online_model *model, ehd_error *error);
/* The file that it was opened from. */
const char *online_path(const online_model *model);
/* That of a part, by the index that results have. */
const char *online_part_path(const online_model *model, size_t part);

/* Memory of one solver; the model must outlive it. */
ehd_status online_solver_create(online_solver **solver, const online_model *model,
                                ehd_error *error);
online_solver *online_solver_free(online_solver *solver); // accepts and returns NULL

/* Tolerance of online_solve, 1e-8 unless set: iterations stop where another one is expected to
 * change the central film by a smaller part. A looser tolerance saves an iteration of three. */
void online_solver_set_tolerance(online_solver *solver, double tolerance);

/* Solves one contact from the trained solutions. Not converged and not trusted are outcomes in
 * result->status. The grid is the model's, also where M and L alone would choose another. Returns
 * EHD_OK, or EHD_DATA when the scene gives a grid, or has a discretisation or a boundary, that is
 * not the model's: one that names none has the accurate one, a model of a version before 0.3.0 the
 * published one. */
ehd_status online_solve(online_result *result, online_solver *solver, const ehd_contact *contact,
                        ehd_error *error);

/* Judges the pressures of a result on the whole grid, [num_nodes] by online_fields, as online_solve
 * does those that it sees: EHD_NOT_CONVERGED where one is negative by more than rounding and the
 * truncated basis leave, or beyond the limit of the viscosity law. */
void online_judge_pressure(online_result *result, const ehd_contact *contact,
                           const double *pressure, size_t num_nodes);

/* What is indicated of other quantities of the last solution. */
typedef struct online_indications {
    double bound[NUM_INDICATED];     // of the deviation, up to a factor
    double deviation[NUM_INDICATED]; // NaN: not calibrated at these sizes, or there is none
} online_indications;

/* Takes twice as long as a solution, so that it is made only when asked for. `contact`: that of the last
 * online_solve. A given load is known: what the result has less is its deviation. */
online_indications online_indicate(online_solver *solver, const ehd_contact *contact);

/* How far the largest pressure of the last solution is indicated to be off, in Hertz pressures, about what
 * the pressure of online_indicate is where a spike is; cheap as a film's. NaN: not calibrated. */
double online_indicate_peak(online_solver *solver);

/* What the grid of the model's training does to the films of a contact, which no solution of the
 * model tells: error estimates of central and minimum film by its step and the length of its inlet,
 * interpolated between the estimates of the training points (film_effects.h). NaN: the model holds
 * none; infinite: its grid is too coarse to tell. About ten microseconds; any number of threads. */
film_effects online_effects(const online_model *model, const ehd_contact *contact);

/* Whether tractions of a model are sums over few nodes: of one from a training of this version. */
bool online_has_traction(const online_model *model);

/* Traction of the last solution of a model that has it; unknown where that did not converge. Allocates
 * nothing, and nothing grows with the grid. `contact`: that of the last online_solve, with sliding. */
contact_traction online_traction(online_solver *solver, const ehd_contact *contact);

/* Bound of the relative deviation of a friction force that online_traction has just found, and
 * what it is indicated to be; NaN: the model has no traction, or no factor for it. An eighth of a
 * solution. `contact`: as there; the law of its shear stress and its sliding may be others than
 * those of the solution. */
double online_friction_bound(online_solver *solver, const ehd_contact *contact, double friction);
double online_indicate_friction(online_solver *solver, const ehd_contact *contact, double friction);

/* Reads and makes what fields need: memory of twice [num_nodes, pressure_modes] numbers. Once a model,
 * one thread at a time; a second call does nothing. EHD_NOINPUT, EHD_DATA, EHD_MEMORY. */
ehd_status online_prepare_fields(online_model *model, ehd_error *error);

/* The grid of the last solution. */
const ehd_grid *online_solved_grid(const online_solver *solver);

/* Pressure and film of the last solution on the whole grid, [num_nodes] with boundary nodes, of a
 * half grid the half: the only call whose cost grows with the grid. Any number of threads, each with
 * a solver of its own. EHD_INTERNAL: neither fields nor transient scenes are prepared. */
ehd_status online_fields(double *pressure, double *film, const online_solver *solver,
                         ehd_error *error);

/* X of the last solution's exit on each of num_lines lines. */
void online_exits(double *positions, const online_solver *solver);

// ---- in time: a contact whose load, speed, radius or modulus vary

/* A contact in time, for somebody else's integrator:
 *
 *     online_prepare_transient(model, &error);                            // once
 *     online_transient_create(&contact_in_time, model, &contact, &error); // one a contact
 *     online_transient_start(&state, contact_in_time, &conditions, &error);
 *     while (…) {
 *         do
 *             // as often as wanted, always from the last accepted state
 *             online_step(&state, contact_in_time, &conditions, step, &error);
 *         while (…);
 *         online_accept(contact_in_time);
 *     }
 *
 * Time is T = u_ref t / a_ref, and steps are BDF2 (the first one BDF1). Everything in and out is
 * relative to the reference contact of online_transient_create. */
typedef struct online_transient online_transient;

/* Conditions at the end of a step, relative to the reference. */
typedef struct online_conditions {
    /* Given where the approach is NaN. Else an outcome, and this any value near it to scale the
     * frame with; NaN: extrapolated from the last steps. */
    double load;
    /* H0 in the reference frame; NaN: the load is given. Of a line as measured from
     * approach_length, which has to lie outside of the pressurised zone (EHD_DATA). */
    double approach;
    double speed; // entrainment, not negative
    double radius, modulus;
} online_conditions;

typedef struct online_state {
    ehd_status status;       // EHD_OK; EHD_NOT_CONVERGED: try a shorter step; EHD_UNTRUSTED
    const char *reason;      // why it is not EHD_OK, or ""
    double time;             // T
    contact_scalars scalars; // in the reference frame; load: relative to the reference load
    double half_width;       // of the frame, relative to the reference
    double local_error;      // of this step's film, relative to the central film; 0: not known yet
    // deviation of the films from the full model with the same steps: carried along with the fluid,
    // it stays until the film that is off has left the contact. NaN: not calibrated in time
    double indicated, indicated_minimum;
    size_t iterations;
    double residual;
} online_state;

/* Reads what only transient scenes need, and fields. Once a model, one thread at a time. */
ehd_status online_prepare_transient(online_model *model, ehd_error *error);

/* The model must outlive it. EHD_DATA: other grid or discretisation; EHD_INTERNAL: not prepared; EHD_MEMORY. */
ehd_status online_transient_create(online_transient **transient, const online_model *model,
                                   const ehd_contact *reference, ehd_error *error);
online_transient *online_transient_free(online_transient *transient); // accepts and returns NULL

/* What the steps may do to the central film, as transient.tolerance: iterations along the path then
 * leave a tenth of a step's part, which saves a fifth of them. Unless set a step is iterated as
 * online_solve does it. */
void online_transient_set_tolerance(online_transient *transient, double tolerance);

/* Allows steps much shorter than the grid's (reduced_march_allow_short_steps). */
void online_transient_allow_short_steps(online_transient *transient);

/* Solves and accepts the stationary state of the conditions at time 0. Where it does not converge,
 * no step can follow. EHD_DATA: conditions out of range. */
ehd_status online_transient_start(online_state *state, online_transient *transient,
                                  const online_conditions *conditions, ehd_error *error);

/* Solves the state a step (in T) after the last accepted one. Allocates nothing, but where the contact
 * is handed from one part to another, whose cost grows with the grid (EHD_MEMORY). EHD_DATA as before;
 * EHD_INTERNAL: neither started nor restored. */
ehd_status online_step(online_state *state, online_transient *transient,
                       const online_conditions *conditions, double step, ehd_error *error);

/* Accepts the last step. Without effect where it did not converge, was refused or is accepted. */
void online_accept(online_transient *transient);

/* After a jump of the conditions: the next step is first order, from the last state alone. */
void online_restart(online_transient *transient);

/* Saves the accepted state, [online_saved_size], and restores it, in any object of the same model
 * and reference: steps that follow are the same to the last bit. EHD_DATA: not a saved state; the
 * object must then be started or restored anew. */
size_t online_saved_size(const online_transient *transient);
void online_save(double *saved, const online_transient *transient);
ehd_status online_restore(online_transient *transient, const double *saved, ehd_error *error);

/* P and H of the accepted state on the whole grid, as by online_fields, in its own frame: the only
 * call here whose cost grows with the grid. */
ehd_status online_transient_fields(double *pressure, double *film, online_transient *transient,
                                   ehd_error *error);

/* Traction of the last attempt, or of the start, in its own frame (online_attempt_frame), of a model that
 * has it: of a contact there, with sliding, and the scalars in it. Steps that follow have the same bits. */
contact_traction online_attempt_traction(online_transient *transient, const ehd_contact *contact,
                                         const contact_scalars *scalars);
contact_frame online_attempt_frame(const online_transient *transient);

/* The largest pressure of the last attempt, or of the start, at the nodes that it looks at, in Hertz
 * pressures of the reference. */
double online_transient_peak(const online_transient *transient);

/* The frame of the accepted state. */
contact_frame online_transient_frame(const online_transient *transient);

/* The part that has solved the last step, or the start. A contact stays with one while it lies in its
 * trained range, and is then handed to another, with the error that this makes indicated. */
size_t online_transient_part(const online_transient *transient);

/* A solver for march_run, which chooses the steps itself, and its effort so far in seconds. Use
 * either that or the calls above, not both in turn. */
march_solver online_march(online_transient *transient);
void online_march_effort(double *rows, double *linear, double *exit, const void *solver);

// ---- derivatives

/* How fast conditions change along a direction, in the units of online_conditions: of load and
 * approach that which is given, and the other NaN. */
typedef online_conditions online_direction;

/* How fast results change along it, relative to the reference. */
typedef struct online_derivatives {
    // in the reference frame; of a line the approach as measured from approach_length. The exit is NaN
    // where it is known as a node only, and minimum_position means nothing
    contact_scalars scalars;
    double peak_pressure; // in Hertz pressures, of the node where it is largest
    double half_width;
} online_derivatives;

/* Of the last stationary solution, which is the reference: at all factors 1, and at its approach.
 * `contact`: that of the last online_solve, whose approach_length counts. Exact but for what least
 * squares leave (romrun/library/README.md). Takes as long as an iteration. EHD_DATA: a direction that
 * is not finite, or an approach measured from too near; EHD_INTERNAL: no solution. */
ehd_status online_differentiate(online_derivatives *derivatives, online_solver *solver,
                                const ehd_contact *contact, const online_direction *direction,
                                ehd_error *error);

/* Response of the load to a small slow change of the approach, dF = -(stiffness + s damping) dH0 for s
 * -> 0 in 1/T, of a stationary contact of constant speed. */
typedef struct online_response {
    double stiffness, damping;
    // By how much the damping moves by what least squares leave of the squeeze term; of ten models it
    // was 2 to 8 times as far off (romrun/library/README.md).
    double damping_bound;
} online_response;
ehd_status online_respond(online_response *response, online_solver *solver,
                          const ehd_contact *contact, ehd_error *error);

/* The same of the last step that was not accepted yet: how its end would change with the conditions
 * there; or of the start, as long as no step was accepted. EHD_INTERNAL: neither. */
ehd_status online_transient_differentiate(online_derivatives *derivatives,
                                          online_transient *transient,
                                          const online_direction *direction, ehd_error *error);
/* Of the start. */
ehd_status online_transient_respond(online_response *response, online_transient *transient,
                                    ehd_error *error);

#endif
