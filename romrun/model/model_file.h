/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads and writes model.h5 (schemas/model.md).
 * Called by deimselect to write, and by romrun/online/part.c and romrun/calibrate/calibrate.c to
 * read. */
#ifndef EHD_MODEL_FILE_H
#define EHD_MODEL_FILE_H

#include "common/artefact/artefact.h"
#include "common/program/program.h"
#include "romrun/model/reduced_model.h"
#include "romrun/model/sizes.h"

/* Data that a model file stores in addition to the model: how its rows were selected and
 * weighted. */
typedef struct model_origin {
    const char *method;
    const char *basis_identity; // SHA-256 of the basis file
    // smallest singular values of modes sampled at the rows: of the residuals, of the Jacobian
    // products, and the smallest of both at any exit of the training
    double sigma_min_residual, sigma_min_jacobian;
    double sigma_min_over_exits;
    double stability;                // largest 1/sigma_min of the trained exits; 1: all rows are
                                     // selected (deimselect/README.md, Stability)
    const double *sigma_min_by_exit; // [num_states]
    // data from which the weights are computed if fewer rows or modes of the model are used; if
    // `weights` is NULL, these data are not known
    const char *weights;          // name of the weighting
    const double *factors;        // [num_rows] factors; row_weight is D times these factors
    size_t num_jacobian_modes;    // number of modes of the weighted Jacobian products D J dz
    const double *jacobian_modes; // [num_rows, num_jacobian_modes] these modes at the selected
                                  // rows, orthonormal over all rows
} model_origin;

/* Writes a whole model into a new file. The caller may then add more data to the file. The file
 * stores the full modes of `basis`, for fields on the whole grid. */
ehd_status model_put(artefact *file, const reduced_model *model, const reduced_basis *basis,
                     const model_origin *origin, ehd_error *error);

/* Writes the model file caller->output. `inputs`: paths of the input files; ends with NULL. */
ehd_status model_write(const reduced_model *model, const reduced_basis *basis,
                       const model_origin *origin, const program *caller, const char *settings_text,
                       const char *const *inputs, ehd_error *error);

/* Opens a model file for the functions below; free with artefact_close. The functions keep reading
 * this file even if another file takes its name meanwhile. Errors as artefact_open. */
ehd_status model_open(artefact **file, const char *path, ehd_error *error);

/* Reads the first modes and rows of a model, as many as `sizes` gives, without its full bases.
 * `sizes` NULL: reads all modes and rows. If fewer rows or modes than stored are read, new weights
 * of the rows are computed. If the file lacks the data for new weights, the rows keep the weights
 * of the whole model. The selected rows of the result are sorted by node. EHD_DATA is returned also
 * for sizes larger than the stored ones and for fewer rows than pressure modes. */
ehd_status model_get(
    // output:
    reduced_model *model, // free with reduced_model_free
    // input:
    artefact *file, const model_sizes *sizes, ehd_error *error);

/* Opens a file, reads its model like model_get, and closes it. */
ehd_status model_read(reduced_model *model, const char *path, const model_sizes *sizes,
                      ehd_error *error);

/* Checks whether the file has the modes that model_get_modes reads for steps in time. */
bool model_has_modes(const artefact *file, const reduced_model *model);

/* Reads the modes on the whole grid, for full fields and transient scenes: [num_nodes,
 * num_pressure] and, for an independent basis, [num_nodes, num_deformation] (otherwise NULL). */
ehd_status model_get_modes(
    // output:
    // either argument may be NULL, and its modes are then not read
    double **pressure_basis,    // free with free()
    double **deformation_basis, // free with free()
    // input:
    artefact *file, const reduced_model *model, // model that was read from this file
    ehd_error *error);

#endif
