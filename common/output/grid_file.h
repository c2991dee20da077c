/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads and writes the grid and the kind of contact of files, prints grids, and loads the scene of
 * a program. */
#ifndef EHD_GRID_FILE_H
#define EHD_GRID_FILE_H

#include "common/artefact/artefact.h"
#include "common/physics/contact.h"
#include "common/program/program.h"
#include "common/settings/scene.h"
#include <stdbool.h>

/* Writes the axis x (inner nodes) and, for a point contact, y (their lines). */
ehd_status grid_write_axes(artefact *file, const ehd_grid *grid, ehd_error *error);

/* Writes the attributes contact, x_min, step and discretization; for a point contact or an ellipse
 * also boundary, and for an ellipse also ellipticity. */
ehd_status grid_write_attributes(artefact *file, const contact_kind *kind, const ehd_grid *grid,
                                 ehd_error *error);

/* Writes axes and attributes, and for a half grid the attribute half. */
ehd_status grid_write(artefact *file, const contact_kind *kind, const ehd_grid *grid,
                      ehd_error *error);

/* Copies values at the inner nodes, [inner_lines, inner_x] as in files, to the nodes of the grid.
 * With `mirrored` the values belong to the whole grid, and a half grid takes its half of them. */
void grid_put_inner(double *nodes, const double *inner, const ehd_grid *grid, bool mirrored);

/* Copies values from the nodes of the grid to [inner_lines, inner_x] as in files. With `mirrored` a
 * half grid fills the values of the whole grid. */
void grid_take_inner(double *inner, const double *nodes, const ehd_grid *grid, bool mirrored);

/* Writes values at the inner nodes as entry `index` of a field whose last axes are (y and) x.
 * EHD_MEMORY; other errors as artefact_put_part. */
ehd_status grid_put_field(artefact *file, const char *name, size_t index,
                          const double *nodes, // [num_nodes]
                          const ehd_grid *grid, bool mirrored, ehd_error *error);

/* Returns the number of lines of inner nodes of an open file; 1 for a line contact. EHD_DATA: the
 * number does not fit the kind. */
ehd_status grid_count_lines(size_t *num_lines, artefact *file, const contact_kind *kind,
                            ehd_error *error);

/* Reads the discretisation of a file; published if missing. EHD_DATA: unknown name. */
ehd_status grid_read_discretization(ehd_discretization *discretization, artefact *file,
                                    ehd_error *error);

/* Reads the boundary of a point contact's file; zero if missing. EHD_DATA: unknown name. */
ehd_status grid_read_boundary(ehd_boundary *boundary, artefact *file, ehd_error *error);

/* Reads the shape of an ellipse; the shape of other kinds is round. EHD_DATA: missing or out of
 * bounds. */
ehd_status grid_read_shape(contact_shape *shape, artefact *file, const contact_kind *kind,
                           ehd_error *error);

/* Reads the kind of contact of a file. EHD_DATA: unknown name. */
ehd_status contact_kind_read(const contact_kind **kind, artefact *file, ehd_error *error);

/* Reads grid and kind of contact of an open file. EHD_DATA: the dry contact does not lie inside the
 * grid, or the kind is unknown. */
ehd_status grid_read(ehd_grid *grid, const contact_kind **kind, artefact *file, ehd_error *error);

/* Checks that the dry contact lies inside the grid and that the step is not too large. EHD_DATA,
 * naming `path`: one does not hold. */
ehd_status grid_check_extent(const ehd_grid *grid, const char *path, ehd_error *error);

/* Writes the attributes transport and, if known, smoothing of a training with trajectories. */
ehd_status carriage_write(artefact *file, const ehd_carriage *carriage, ehd_error *error);

/* Reads the attributes transport (upwind if missing) and smoothing (NaN if missing). EHD_DATA:
 * unknown name, or smoothing out of range. */
ehd_status carriage_read(ehd_carriage *carriage, artefact *file, ehd_error *error);

/* Reads the grid of a file of snapshots, a basis, a model or a result with fields. Errors as
 * artefact_open. */
ehd_status grid_of_file(ehd_grid *grid, const contact_kind **kind, const char *path,
                        ehd_error *error);

/* Check that the shape of the contact, or the whole grid, equals that of the file `expected_path`.
 * EHD_DATA, naming `path`: they differ. */
ehd_status grid_check_shape(const ehd_grid *grid, const char *path, const ehd_grid *expected,
                            const char *expected_path, ehd_error *error);
ehd_status grid_check(const ehd_grid *grid, const char *path, const ehd_grid *expected,
                      const char *expected_path, ehd_error *error);

/* Checks before the work that `bytes` of memory are free for solutions of a point contact,
 * `num_jobs` at a time, and prints the amount. Does nothing for a line contact. EHD_MEMORY, naming
 * `object`: not enough memory. */
ehd_status grid_check_memory(const program *caller, const char *object, const ehd_contact *contact,
                             double bytes, size_t num_jobs, ehd_error *error);

/* Prints the number of nodes of the whole grid, its ends and its step. */
void grid_print_nodes(const ehd_grid *grid);

/* Prints the shape of an ellipse, the discretisation and, for a point contact, the boundary. */
void grid_print_equations(const ehd_contact *contact);

/* Prints a contact's grid. If the scene does not give the grid, also prints `needed_by`, which the
 * grid was chosen for. */
void grid_print(const ehd_contact *contact, const char *needed_by);

/* Reads the scene of caller->arguments[0] with its overrides. `text` identifies the scene; free
 * with free(). */
ehd_status scene_load(scene *given, char **text, const program *caller, ehd_error *error);

/* Makes a contact of the loaded scene. The scene must have the kind `kind` of the file `model`;
 * NULL: any kind. */
ehd_status contact_load(ehd_contact *contact, const scene *given, const program *caller,
                        const contact_kind *kind, const char *model, ehd_error *error);

#endif
