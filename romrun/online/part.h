/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Defines a part: one reduced model with the data that the online solver needs, and the solver of
 * this model. An opened model consists of one part or, for parts of a region, of several parts
 * (README.md, Models for parts of a region). Called by the files of online.h (online_objects.h). */
#ifndef EHD_ONLINE_PART_H
#define EHD_ONLINE_PART_H

#include "romrun/model/flat.h"
#include "romrun/model/trade_file.h"
#include "romrun/online/online.h"
#include "romrun/online/reduced_march.h"
#include "romrun/online/reduced_tangent.h"
#include "romrun/state/fields.h"
#include "romrun/state/film_splines.h"
#include "romrun/trust/indicator.h"
#include "romrun/trust/trained_range.h"

typedef struct model_part {
    reduced_model reduced;
    const char *path; // path of its file, for error messages
    bool flat;        // true: a flat file owns the tables and outlives the part
    artefact *source; // open HDF5 file with the modes; NULL: a flat model, or the file is closed
    trained_range *range;
    // Results of the calibration. If the numbers of modes and rows in use are not calibrated, the
    // factors are 0. If they are not calibrated on trajectories, in_time is NaN. If
    // largest_residual or most_iterations is not known, it is infinite.
    double indicator_factor; // factor of the error estimate of the central film
    double indicator_factor_minimum;
    double largest_residual; // largest residual in the calibration
    bool checked_in_time;
    double most_iterations;             // largest number of iterations in the calibration
    double other_factor[NUM_INDICATED]; // factors of the other error estimates
    indicator_shape shape[NUM_BOUNDED]; // shapes of the estimates (indicator_shape)
    film_factors in_time;               // factors of the error estimates in a transient run
    double *pressure_basis;             // NULL until fields or transient scenes are prepared
    const field_modes *fields;          // NULL: the model was not prepared for fields
    field_modes own_fields;             // memory of `fields`, unless the splines own this memory
    // true: prepared for transient scenes; the members below are then set
    bool transient;
    film_splines splines;
    double *deformation_basis;
} model_part;

/* Opens a part from an HDF5 file. `self` must be zero. Free it with part_close, also after a
 * failure. Errors: EHD_NOINPUT, EHD_DATA, EHD_MEMORY. */
ehd_status part_open(model_part *self, const char *path, const model_sizes *sizes,
                     ehd_error *error);
/* Writes the part to a flat file or reads the part from it, depending on file->reading.
 * file->status holds errors. */
void part_walk(flat *file, model_part *self);
/* Computes, after reading, the data that the file does not contain. Errors: EHD_MEMORY. */
ehd_status part_finish(model_part *self, ehd_error *error);
/* See online_show. */
ehd_status part_show(model_part *self, const shown_lubricants *shown, ehd_error *error);
void part_close(model_part *self);

/* See online_prepare_fields and online_prepare_transient. */
ehd_status part_prepare_fields(model_part *self, ehd_error *error);
ehd_status part_prepare_transient(model_part *self, ehd_error *error);

// ---- solver of a part

typedef struct part_solver {
    const model_part *model;
    reduced_solver *reduced;
    indicator *indicator;
    reduced_state state;
    bool solved;                // true: the last solution converged
    contact_scalars scalars;    // scalars of the last solution
    reduced_tangent *tangent;   // NULL: no derivative was needed yet
    bool linearised;            // true: the tangent is linearised at the last solution
    range_memory *range_memory; // work memory for checks of the trained range
    char reason[192];           // text of the last result's reason, if several reasons are combined
} part_solver;

/* Initialises a solver. `self` must be zero. Free it with part_solver_free, also after a failure.
 * Errors: EHD_MEMORY. */
ehd_status part_solver_init(part_solver *self, const model_part *model, ehd_error *error);
void part_solver_free(part_solver *self);

/* Does for a part what online_solve does for a model. The contact must be on the part's grid. */
ehd_status part_solve(online_result *result, part_solver *solver, const ehd_contact *contact,
                      ehd_error *error);
bool part_has_traction(const model_part *model);

/* Checks that contact and model have the same kind (line, point, ellipse), grid, discretisation,
 * and boundary condition around the grid. If one of these differs, returns EHD_DATA; the text of
 * the error then gives both values. */
ehd_status part_check_contact(const model_part *model, const ehd_contact *contact,
                              ehd_error *error);

#endif
