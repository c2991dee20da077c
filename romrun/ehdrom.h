/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The online solver as a library: open a model once, solve many scenes.
 *
 *     ehdrom_model *model = NULL;
 *     ehdrom_solver *solver = NULL;
 *     ehd_contact contact;
 *     ehdrom_result result;
 *     ehd_error error;
 *     scene given;
 *
 *     if (ehdrom_open(&model, "model.h5", NULL, &error) ||      // once
 *         ehdrom_solver_create(&solver, model, &error) ||       // once a thread
 *         scene_read(&given, "scene.yml", NULL, 0, &error) ||   // or fill a scene by scene_set
 *         contact_init(&contact, &given, &error) ||
 *         ehdrom_solve(&result, solver, &contact, &error))      // as often as wanted
 *         fprintf(stderr, "%s\n", error.text);
 *
 * Nothing is global. Open models one thread at a time (HDF5 is not thread-safe); a model may then be
 * shared by any number of solvers in as many threads. For speed, keep OpenBLAS at one thread. */
#ifndef EHDROM_H
#define EHDROM_H

#include "common/physics/contact.h"
#include "common/program/status.h"
#include "common/settings/scene.h"
#include <stdbool.h>
#include <stddef.h>

typedef struct ehdrom_model ehdrom_model;
typedef struct ehdrom_solver ehdrom_solver;

/* How much of the stored model is used: its first modes and rows; 0 stands for all. */
typedef struct ehdrom_sizes {
    size_t pressure_modes, deformation_modes, rows;
} ehdrom_sizes;

/* What a model is, for information. */
typedef struct ehdrom_properties {
    size_t num_inner;                         // n, nodes of the full grid
    double x_min, step;                       // of the grid, in half widths
    const char *deformation;                  // "independent" or "coupled"
    size_t pressure_modes, deformation_modes; // in use
    size_t unknowns;                          // of the reduced system
    size_t rows;                              // selected Reynolds rows in use
    size_t needed_nodes;                      // at which they need the state
    size_t states;                            // training solutions
} ehdrom_properties;

/* One solution; dimensionless unless stated. */
typedef struct ehdrom_result {
    ehd_status status;  // EHD_OK; EHD_NOT_CONVERGED; EHD_UNTRUSTED: solved, but outside of
                        // the trained range
    const char *reason; // why it is not EHD_OK, or ""
    double central_film_thickness; // H at X = 0
    double minimum_film_thickness; // smallest nodal H
    double central_pressure;       // P at X = 0
    double rigid_approach;         // H0
    double exit_position;          // X of the exit boundary
    double load;                   // relative to the wanted one
    size_t iterations;
    double residual;       // norm of the weighted least-squares residual
    double seconds;        // of the solution
    double seconds_rows;   // of it: rows and reduced Jacobian
    double seconds_linear; // of it: least squares
    double seconds_exit;   // of it: exit boundary and its updates
} ehdrom_result;

/* Loads a model. `sizes` NULL: all of it. Errors: EHD_NOINPUT, EHD_DATA, EHD_MEMORY. */
ehd_status ehdrom_open(ehdrom_model **model, const char *path, const ehdrom_sizes *sizes,
                       ehd_error *error);
ehdrom_model *ehdrom_close(ehdrom_model *model); // accepts and returns NULL
ehdrom_properties ehdrom_describe(const ehdrom_model *model);

/* Memory of one solver; the model must outlive it. */
ehd_status ehdrom_solver_create(ehdrom_solver **solver, const ehdrom_model *model,
                                ehd_error *error);
ehdrom_solver *ehdrom_solver_free(ehdrom_solver *solver); // accepts and returns NULL

/* Solves one contact from the trained solutions. Not converged and not trusted are outcomes in
 * result->status. Returns EHD_OK, or EHD_DATA when the contact's grid is not the model's. */
ehd_status ehdrom_solve(ehdrom_result *result, ehdrom_solver *solver, const ehd_contact *contact,
                        ehd_error *error);

/* Pressure and film on the whole grid, of the last solution: the only call whose cost grows with the
 * grid. Arrays of num_inner + 2 nodes, boundary nodes included. Reads the model file at the first
 * call, hence one thread at a time. */
ehd_status ehdrom_fields(double *pressure, double *film, ehdrom_solver *solver, ehd_error *error);

#endif
