/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prints the result of one stationary scene, writes it to result.h5 and reads it back. */
#ifndef EHD_RESULT_H
#define EHD_RESULT_H

#include "common/artefact/artefact.h"
#include "common/output/film_effects.h"
#include "common/output/indicated.h"
#include "common/physics/contact.h"
#include "common/physics/traction.h"
#include "common/program/program.h"
#include "common/program/solve_seconds.h"
#include "common/program/status.h"
#include <stdbool.h>
#include <stddef.h>

enum { RESULT_REASON = 256 }; // bytes, with the closing zero

/* Which model solved a scene, if the reduced model can fall back on the full one. */
typedef enum result_model { SOLVED_BY_ANY, SOLVED_BY_REDUCED, SOLVED_BY_FULL } result_model;

/* Result of a solver. Numbers are dimensionless. NaN: the value is not known. */
typedef struct run_result {
    const double *pressure; // [num_nodes] of the contact's grid, NULL: no fields
    const double *film;     // [num_nodes], NULL: no fields
    // NULL: no traction. A result with fields and traction also gets fields of the stresses
    const contact_traction *traction;
    const double *exits; // [lines of the whole grid] X of each exit, for a point contact
    contact_scalars scalars;
    size_t newton_iterations;
    double residual;
    double indicated_deviation;         // relative error estimate of the central film, or NaN
    double indicated_deviation_minimum; // error estimate of the minimum film
    const double *indicated;     // [NUM_INDICATED] error estimates of other quantities, or NaN;
                                 // NULL: there are no estimates
    const film_effects *effects; // estimated errors due to the grid; NULL: unknown
    result_model solved_by;      // SOLVED_BY_ANY: the model is not stored
    ehd_status status;           // EHD_OK, EHD_NOT_CONVERGED or EHD_UNTRUSTED
    char reason[RESULT_REASON];  // why the status is not EHD_OK, or ""
    solve_seconds seconds;
} run_result;

/* Sets the status of a solved result to EHD_UNTRUSTED if the grid is too coarse, or its inlet too
 * short, for an error estimate, or if the friction exceeds possible_friction. */
void result_judge(run_result *result, const ehd_grid *grid);

/* Creates caller->output before the solution is known, so that an output that cannot be written is
 * refused before the work. `inputs`: paths, NULL at the end. Errors: see artefact_create. */
ehd_status result_create(
    // output:
    artefact **file, // give to result_write, or to artefact_close, which leaves no file
    // input:
    const program *caller, const ehd_contact *contact, const char *settings_text,
    const char *const *inputs, ehd_error *error);

/* Writes the result and gives the file its final name. The file is closed in any case. */
ehd_status result_write(artefact **file, const run_result *result, const ehd_contact *contact,
                        ehd_error *error);

/* The next three functions are used for the result files of stationary and transient scenes. */

/* Writes the attributes of the reference contact. */
ehd_status result_put_contact(artefact *file, const ehd_contact *contact, ehd_error *error);
/* Writes the attribute `solve_seconds` and its parts. */
ehd_status result_put_seconds(artefact *file, const solve_seconds *seconds, ehd_error *error);
/* Returns the value for the field `status`. */
int64_t result_stored_status(ehd_status status);

/* Prints the short result on stdout, also in µm, GPa and N/m (N for a point contact) if the contact
 * is given in SI units. */
void result_print(const run_result *result, const ehd_contact *contact);

/* A stationary result read from a file. If a file of another program lacks a value, the value is
 * NaN. */
typedef struct stored_result {
    ehd_discretization discretization;
    ehd_boundary boundary;
    contact_shape shape;
    double x_min; // first inner node of the grid of the file and its fields
    double step;
    size_t num_inner; // number of nodes of a field; 0: the file has neither fields nor an axis x
    size_t num_lines; // number of lines of these nodes; 1 for a line contact
    double moes_M, moes_L, alpha_p_H;
    flow_thinning thinning;
    double hertz_pressure; // Pa
    double central_film_thickness;
    double minimum_film_thickness;
    double central_pressure;
    double rigid_approach;
    double exit_position; // at Y = 0
    int64_t status;       // 0 if missing
    double *pressure;     // [num_inner] NULL: the file has no pressures, or they were not read
    double *film;         // [num_inner] NULL: the file has no films, or they were not read
} stored_result;

/* Reads grid and reference contact of an open file; moes_L is NaN if missing. Returns EHD_DATA for
 * another kind of contact. */
ehd_status result_get_contact(
    // output:
    stored_result *stored, // only grid and reference contact are set
    // input:
    artefact *file, const contact_kind *kind, ehd_error *error);

/* Reads a stationary result. Errors: see artefact_open. Also returns EHD_DATA for several points in
 * time, and for numbers that are not finite in a converged result. */
ehd_status result_read(
    // output:
    stored_result *stored, // free with result_free
    // input:
    const char *path, const contact_kind *kind, bool want_fields, ehd_error *error);

void result_free(stored_result *stored); // also after a failed result_read

/* Returns the whole grid of a stored result; it has no nodes if the file has no axis x. */
ehd_grid result_grid(const stored_result *stored);

/* Checks that the stored result has this grid. Returns EHD_DATA, naming `path`, for another
 * grid. */
ehd_status result_check_grid(const stored_result *stored, const char *path, const ehd_grid *grid,
                             ehd_error *error);

#endif
