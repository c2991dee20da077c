/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One reduced model as the online solver has it, and its solver: a model that somebody opens is one of
 * these, or several, for parts of a region (online.h). */
#ifndef EHD_ONLINE_PART_H
#define EHD_ONLINE_PART_H

#include "romrun/model/flat.h"
#include "romrun/model/trade_file.h"
#include "romrun/online/fields.h"
#include "romrun/online/film_splines.h"
#include "romrun/online/indicator.h"
#include "romrun/online/online.h"
#include "romrun/online/reduced_march.h"
#include "romrun/online/reduced_tangent.h"
#include "romrun/online/trained_range.h"

typedef struct model_part {
    reduced_model reduced;
    const char *path; // for errors, of the model that it is a part of
    bool flat;        // tables are those of a flat file, which outlives it
    bool shows;       // lubricants of part_show, which are its own, of a flat file too
    artefact *source; // what else may be read of it; NULL: flat, or released
    trained_range *range;
    double indicator_factor; // 0: not calibrated at these sizes
    double indicator_factor_minimum;
    double largest_residual; // of the scenes of the calibration; infinite: not known
    bool checked_in_time;
    double most_iterations;             // of these; infinite: not known
    double other_factor[NUM_INDICATED]; // 0: not calibrated
    indicator_shape shape[NUM_BOUNDED]; // of these factors
    film_factors in_time;               // NaN: not calibrated at these sizes
    double *pressure_basis;             // read once fields or transient scenes are prepared
    const field_modes *fields;          // NULL: not prepared
    field_modes own_fields;             // which these may be
    // for transient scenes, once prepared
    bool transient;
    film_splines splines;
    double *deformation_basis;
} model_part;

/* From an HDF5 file. `self` is zero; free with part_close, also where it fails. EHD_NOINPUT,
 * EHD_DATA, EHD_MEMORY. */
ehd_status part_open(model_part *self, const char *path, const model_sizes *sizes,
                     ehd_error *error);
/* Writes or reads it as part of a flat file, which tells what went wrong. */
void part_walk(flat *file, model_part *self);
/* Once it is read: what is made of it. EHD_MEMORY. */
ehd_status part_finish(model_part *self, ehd_error *error);
/* As online_show. */
ehd_status part_show(model_part *self, const shown_lubricants *shown, ehd_error *error);
void part_release_file(model_part *self);
void part_close(model_part *self);

/* As online_prepare_… */
ehd_status part_prepare_fields(model_part *self, ehd_error *error);
ehd_status part_prepare_transient(model_part *self, ehd_error *error);

// ---- its solver

typedef struct part_solver {
    const model_part *model;
    reduced_solver *reduced;
    indicator *indicator;
    reduced_state state;
    bool solved;                // the last solution converged
    contact_scalars scalars;    // of it
    reduced_tangent *tangent;   // NULL: not needed yet
    bool linearised;            // at the last solution
    range_memory *range_memory; // of checks of the trained range
    char reason[192];           // of the last result, where it is put together
} part_solver;

/* `self` is zero; free with part_solver_free, also where it fails. EHD_MEMORY. */
ehd_status part_solver_init(part_solver *self, const model_part *model, ehd_error *error);
void part_solver_free(part_solver *self);

/* As online_…, of a contact on the model's grid. */
ehd_status part_solve(online_result *result, part_solver *solver, const ehd_contact *contact,
                      ehd_error *error);
online_indications part_indicate(part_solver *solver, const ehd_contact *contact);
double part_indicate_peak(part_solver *solver);
bool part_has_traction(const model_part *model);
contact_traction part_traction(part_solver *solver, const ehd_contact *contact);
double part_friction_bound(part_solver *solver, const ehd_contact *contact, double friction);
double part_indicate_friction(part_solver *solver, const ehd_contact *contact, double friction);

/* Where both are the same, EHD_OK. EHD_DATA, naming both. */
ehd_status part_check_contact(const model_part *model, const ehd_contact *contact,
                              ehd_error *error);

#endif
