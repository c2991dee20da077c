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

/* Writes the axis x of the inner nodes and, for a point contact, the axis y of their lines. */
ehd_status grid_write_axes(artefact *file, const ehd_grid *grid, ehd_error *error);

/* Writes the attributes `contact`, `x_min`, `step` and `discretization`. Also writes `boundary` for
 * a point contact or an ellipse, and `ellipticity` for an ellipse. */
ehd_status grid_write_attributes(artefact *file, const contact_kind *kind, const ehd_grid *grid,
                                 ehd_error *error);

/* Writes axes and attributes, and for a half grid the attribute `half`. */
ehd_status grid_write(artefact *file, const contact_kind *kind, const ehd_grid *grid,
                      ehd_error *error);

/* Copies values at the inner nodes, [inner_lines, inner_x] as in files, to the nodes of the grid.
 * With `mirrored` the values belong to the whole grid, and a half grid takes its half of them. */
void grid_put_inner(double *nodes, const double *inner, const ehd_grid *grid, bool mirrored);

/* Copies values from the nodes of the grid to [inner_lines, inner_x] as in files. With `mirrored` a
 * half grid fills the values of the whole grid. */
void grid_take_inner(double *inner, const double *nodes, const ehd_grid *grid, bool mirrored);

/* Writes values at the inner nodes as entry `index` of a field whose last axis is x. For a point
 * contact the axis before x is y. Errors: EHD_MEMORY, and the errors of artefact_put_part. */
ehd_status grid_put_field(artefact *file, const char *name, size_t index,
                          const double *nodes, // [num_nodes]
                          const ehd_grid *grid, bool mirrored, ehd_error *error);

/* Finds the number of lines of inner nodes of an open file; 1 for a line contact. Returns EHD_DATA
 * if the number does not fit the kind. */
ehd_status grid_count_lines(size_t *num_lines, artefact *file, const contact_kind *kind,
                            ehd_error *error);

/* Reads an attribute that is one of `names`, which end with NULL. The index is 0 if the file lacks
 * the attribute. Returns EHD_DATA for another name; the message lists the names by the text
 * `expected`. */
ehd_status name_read(unsigned *index, artefact *file, const char *attribute,
                     const char *const *names, const char *expected, ehd_error *error);

/* Reads the discretisation of a file. The discretisation is `published` if the file names
 * none. Returns EHD_DATA for an unknown name. */
ehd_status grid_read_discretization(ehd_discretization *discretization, artefact *file,
                                    ehd_error *error);

/* Reads the boundary of a point contact's file. The boundary is `zero` if the file names
 * none. Returns EHD_DATA for an unknown name. */
ehd_status grid_read_boundary(ehd_boundary *boundary, artefact *file, ehd_error *error);

/* Reads the shape of an ellipse; the shape of other kinds is round. Returns EHD_DATA if the
 * ellipticity is missing or out of bounds. */
ehd_status grid_read_shape(contact_shape *shape, artefact *file, const contact_kind *kind,
                           ehd_error *error);

/* Reads the kind of contact of a file. Returns EHD_DATA for an unknown name. */
ehd_status contact_kind_read(const contact_kind **kind, artefact *file, ehd_error *error);

/* Reads grid and kind of contact of an open file. Returns EHD_DATA if the dry contact does not lie
 * inside the grid, or if the kind is unknown. */
ehd_status grid_read(ehd_grid *grid, const contact_kind **kind, artefact *file, ehd_error *error);

/* Checks that the dry contact lies inside the grid and that the grid step is not too large. Returns
 * EHD_DATA, naming `path`, otherwise. */
ehd_status grid_check_extent(const ehd_grid *grid, const char *path, ehd_error *error);

/* Writes the attributes `transport` and, if known, `smoothing` of a training with trajectories. */
ehd_status carriage_write(artefact *file, const ehd_carriage *carriage, ehd_error *error);

/* Reads the attributes `transport` (upwind if missing) and `smoothing` (NaN if missing). Returns
 * EHD_DATA for an unknown name, or if `smoothing` is out of range. */
ehd_status carriage_read(ehd_carriage *carriage, artefact *file, ehd_error *error);

/* Reads the grid of a file: snapshots, a basis, a model, or a result with fields. Errors: see
 * artefact_open. */
ehd_status grid_of_file(ehd_grid *grid, const contact_kind **kind, const char *path,
                        ehd_error *error);

/* Check that the shape of the contact, or the grid, is the same in the files `path` and
 * `expected_path`. Return EHD_DATA, naming `path`, if the shapes or grids differ. */
ehd_status grid_check_shape(const ehd_grid *grid, const char *path, const ehd_grid *expected,
                            const char *expected_path, ehd_error *error);
ehd_status grid_check(const ehd_grid *grid, const char *path, const ehd_grid *expected,
                      const char *expected_path, ehd_error *error);

/* Checks, before the work starts, that `bytes` of memory are free, and prints the amount. The
 * memory is for solutions of a point contact, `num_jobs` at a time. Does nothing for a line
 * contact. Returns EHD_MEMORY, naming `object`, if there is not enough memory. */
ehd_status grid_check_memory(const program *caller, const char *object, const ehd_contact *contact,
                             double bytes, size_t num_jobs, ehd_error *error);

/* Prints the number of nodes of the whole grid, its ends and its step. */
void grid_print_nodes(const ehd_grid *grid);

/* Prints the shape of an ellipse, the discretisation and, for a point contact, the boundary. */
void grid_print_equations(const ehd_contact *contact);

/* Prints a contact's grid. If the scene does not give the grid, also prints what the grid was
 * chosen for: `needed_by`, such as "this M and L". */
void grid_print(const ehd_contact *contact, const char *needed_by);

/* Reads the scene file caller->arguments[0] and applies the caller's overrides. `text` identifies
 * the scene; free `text` with free(). */
ehd_status scene_load(scene *given, char **text, const program *caller, ehd_error *error);

/* Makes a contact of the loaded scene. The scene must have the kind of contact `kind`, which is the
 * kind of the file `model`. If `kind` is NULL, the scene may have any kind. */
ehd_status contact_load(ehd_contact *contact, const scene *given, const program *caller,
                        const contact_kind *kind, const char *model, ehd_error *error);

#endif
