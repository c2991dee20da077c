/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The result of one stationary scene: printed, written to and read from result.h5. */
#ifndef EHD_RESULT_H
#define EHD_RESULT_H

#include "common/artefact/artefact.h"
#include "common/output/film_effects.h"
#include "common/output/indicated.h"
#include "common/physics/contact.h"
#include "common/physics/traction.h"
#include "common/program/program.h"
#include "common/program/status.h"
#include <stdbool.h>
#include <stddef.h>

enum { RESULT_REASON = 256 }; // bytes, with the closing zero

/* Which model solved it, where one falls back on the other. */
typedef enum result_model { SOLVED_BY_ANY, SOLVED_BY_REDUCED, SOLVED_BY_FULL } result_model;

/* What a solver found. Numbers are dimensionless; NaN stands for "not known". */
typedef struct run_result {
    const double *pressure;           // [num_nodes] of the contact's grid, NULL: no fields
    const double *film;               // [num_nodes], NULL: no fields
    const contact_traction *traction; // NULL: not asked for; with fields the file has its stresses
    const double *exits; // [lines] X at which the pressure ends, of a point contact's whole grid
    double central_film_thickness;
    double minimum_film_thickness;
    double central_pressure;
    double rigid_approach;
    double exit_position; // X at which the pressure ends, at Y = 0
    double load;          // relative to the reference
    size_t newton_iterations;
    double residual;
    double indicated_deviation;         // of the central film, relative; NaN: no indicator
    double indicated_deviation_minimum; // of the minimum film
    const double *indicated;            // [NUM_INDICATED] of others, NaN as above; NULL: none
    const film_effects *effects;        // of the grid, NULL: not known
    result_model solved_by;             // SOLVED_BY_ANY: not said
    ehd_status status;                  // EHD_OK, EHD_NOT_CONVERGED or EHD_UNTRUSTED
    char reason[RESULT_REASON];         // why the status is not EHD_OK, or ""
    double seconds;                     // of the solution, without reading and writing
    double seconds_rows, seconds_linear, seconds_exit; // parts of it; NaN: not measured apart
} run_result;

/* Sets EHD_UNTRUSTED of a solved result whose grid is too coarse to estimate its error. */
void result_judge_grid(run_result *result, const ehd_grid *grid);

/* Starts caller->output, before the solution is known, so that an output that cannot be written is
 * refused before the work. `inputs`: paths, NULL at the end. Errors as artefact_create. */
ehd_status result_create(
    // output:
    artefact **file, // give to result_write, or to artefact_close, which leaves no file
    // input:
    const program *caller, const ehd_contact *contact, const char *settings_text,
    const char *const *inputs, ehd_error *error);

/* Writes the result and gives the file its name. The file is closed in any case. */
ehd_status result_write(artefact **file, const run_result *result, const ehd_contact *contact,
                        ehd_error *error);

/* What result files of one and of many times share. */

/* Attributes that tell the reference contact. */
ehd_status result_put_contact(artefact *file, const ehd_contact *contact, ehd_error *error);
/* Attributes solve_seconds and its parts; of the result, only the times are used. */
ehd_status result_put_seconds(artefact *file, const run_result *result, ehd_error *error);
/* As written to the fields `status` and `by_full_model`. */
int64_t result_stored_status(ehd_status status);
int64_t result_stored_model(result_model model);

/* The short result a person wants, on stdout; with um, GPa and N/m when the contact is physical. */
void result_print(const run_result *result, const ehd_contact *contact);

/* A result as stored, of one time. What a foreign file need not have is NaN where it is missing. */
typedef struct stored_result {
    ehd_discretization discretization;
    ehd_boundary boundary;
    contact_shape shape;
    double x_min; // grid of the file, and of the fields
    double step;
    size_t num_inner; // nodes of a field; 0: neither fields nor an axis x
    size_t num_lines; // of them, across; 1 of a line contact
    double moes_M, moes_L, alpha_p_H;
    flow_thinning thinning; // of the flow
    double hertz_pressure;  // Pa
    double central_film_thickness;
    double minimum_film_thickness;
    double central_pressure;
    double rigid_approach;
    double exit_position; // at Y = 0
    int64_t status;       // 0 when the file has none
    double *pressure;     // [num_inner], NULL: not in the file or not wanted
    double *film;         // [num_inner], NULL: not in the file or not wanted
} stored_result;

/* Grid and reference contact of an open file; moes_L is NaN where the file has none. EHD_DATA for
 * another kind of contact. */
ehd_status result_get_contact(
    // output:
    stored_result *stored, // only these members of it
    // input:
    artefact *file, const contact_kind *kind, ehd_error *error);

/* Errors as artefact_open; EHD_DATA also for several times and numbers that are not finite in a
 * converged result. */
ehd_status result_read(
    // output:
    stored_result *stored, // free with result_free
    // input:
    const char *path, const contact_kind *kind, bool want_fields, ehd_error *error);

void result_free(stored_result *stored); // also after a failed result_read

/* The whole grid of a stored result; without nodes where the file has no axis x. */
ehd_grid result_grid(const stored_result *stored);

/* EHD_DATA naming `path` when the stored result has another grid. */
ehd_status result_check_grid(const stored_result *stored, const char *path, const ehd_grid *grid,
                             ehd_error *error);

#endif
