/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads and writes basis.h5 (schemas/basis.md).
 * Called by podbuild, deimselect/main.c and snapgen/residuals.c, and by model_file.c and
 * model_read.c for the data that basis files and model files have in common. */
#ifndef EHD_BASIS_FILE_H
#define EHD_BASIS_FILE_H

#include "common/artefact/artefact.h"
#include "common/output/grid_file.h"
#include "common/program/program.h"
#include "romrun/model/reduced_model.h"

/* Data that a basis file stores in addition to the basis: the singular values of the snapshots. */
typedef struct basis_origin {
    const double *pressure_singular_values; // [num_pressure_values]
    size_t num_pressure_values;
    double pressure_energy_discarded; // discarded fraction of the sum of squared singular values
    const double *deformation_singular_values; // [num_deformation_values], NULL when coupled
    size_t num_deformation_values;
    double deformation_energy_discarded;
} basis_origin;

/* Writes the basis file caller->output. `inputs`: paths of the snapshot files; ends with NULL. */
ehd_status basis_write(const reduced_basis *basis, const basis_origin *origin,
                       const program *caller, const char *settings_text, const char *const *inputs,
                       ehd_error *error);

/* Reads a basis and its identity. EHD_DATA is returned also for values that are not finite, for
 * exits outside of the grid, and for an unknown kind of contact. */
ehd_status basis_read(
    // output:
    reduced_basis *basis, // free with reduced_basis_free
    char identity[65],    // SHA-256 of the file
    // input:
    const char *path, ehd_error *error);

/* Writes the axes film_x and, for a point contact, film_y. These axes belong to fields at all
 * nodes, boundary nodes included. */
ehd_status film_axes_write(artefact *file, const ehd_grid *grid, ehd_error *error);

/* Reads the attribute `deformation` of an open file. EHD_DATA: unknown name. */
ehd_status deformation_read(deformation_kind *kind, artefact *file, ehd_error *error);

/* Write and read the training solutions in a basis file or a model file. The file contains their
 * coordinates in the basis. */
ehd_status states_write(artefact *file, const reduced_states *states, size_t num_pressure,
                        size_t num_deformation, const ehd_grid *grid, ehd_error *error);
ehd_status states_read(reduced_states *states, artefact *file, size_t num_pressure,
                       size_t num_deformation, const ehd_grid *grid, ehd_error *error);

/* Write and read modes, [num_nodes, num_modes] in memory and [mode, node] in the file. `inner`: the
 * file stores inner nodes only, and modes_read sets the modes to 0 at the boundary nodes.
 * modes_read allocates *modes. The caller frees *modes with free(), also after a failure. */
ehd_status modes_write(artefact *file, const char *field, const double *modes, const ehd_grid *grid,
                       size_t num_modes, bool inner, ehd_error *error);
ehd_status modes_read(double **modes, artefact *file, const char *field, const ehd_grid *grid,
                      size_t num_modes, bool inner, ehd_error *error);

#endif
