/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The grid and kind of contact that every file states, and the scene that a program is given. */
#ifndef EHD_GRID_FILE_H
#define EHD_GRID_FILE_H

#include "common/artefact/artefact.h"
#include "common/physics/contact.h"
#include "common/program/program.h"
#include "common/settings/scene.h"
#include <stdbool.h>

/* Axis x, the inner nodes, and of a point contact y, their lines. */
ehd_status grid_write_axes(artefact *file, const ehd_grid *grid, ehd_error *error);

/* Attributes contact, x_min, step, discretization, of a point contact or an ellipse boundary, and of
 * an ellipse ellipticity. */
ehd_status grid_write_attributes(artefact *file, const contact_kind *kind, const ehd_grid *grid,
                                 ehd_error *error);

/* Both of them, and of a half grid that it is one. */
ehd_status grid_write(artefact *file, const contact_kind *kind, const ehd_grid *grid,
                      ehd_error *error);

/* Puts values at the inner nodes, [inner_lines, inner_x] as files have them, of the whole grid
 * where `mirrored`, to the grid's nodes, where the grid is a half its own half of them. */
void grid_put_inner(double *nodes, const double *inner, const ehd_grid *grid, bool mirrored);

/* And back: those at the inner nodes, of a half grid where `mirrored` of the whole one. */
void grid_take_inner(double *inner, const double *nodes, const ehd_grid *grid, bool mirrored);

/* Writes values at the inner nodes as entry `index` of a field whose last axes are (y and) x.
 * EHD_MEMORY; and as artefact_put_part. */
ehd_status grid_put_field(artefact *file, const char *name, size_t index,
                          const double *nodes, // [num_nodes]
                          const ehd_grid *grid, bool mirrored, ehd_error *error);

/* Lines of an open file's inner nodes, 1 of a line contact. EHD_DATA: not as many as the kind has.
 */
ehd_status grid_count_lines(size_t *num_lines, artefact *file, const contact_kind *kind,
                            ehd_error *error);

/* The discretisation of a file: published where it says nothing. EHD_DATA: an unknown one. */
ehd_status grid_read_discretization(ehd_discretization *discretization, artefact *file,
                                    ehd_error *error);

/* The boundary of a file of a point contact: zero where it says nothing. EHD_DATA: an unknown
 * one. */
ehd_status grid_read_boundary(ehd_boundary *boundary, artefact *file, ehd_error *error);

/* The shape of a file of an ellipse; that of the others is round. EHD_DATA: missing or out of
 * bounds. */
ehd_status grid_read_shape(contact_shape *shape, artefact *file, const contact_kind *kind,
                           ehd_error *error);

/* Its kind of contact. EHD_DATA: an unknown one. */
ehd_status contact_kind_read(const contact_kind **kind, artefact *file, ehd_error *error);

/* Grid and kind of contact of an open file. EHD_DATA when the dry contact does not lie inside, or
 * the kind is not known. */
ehd_status grid_read(ehd_grid *grid, const contact_kind **kind, artefact *file, ehd_error *error);

/* EHD_DATA, naming `path`: the dry contact does not lie inside of the grid, or its step is too large. */
ehd_status grid_check_extent(const ehd_grid *grid, const char *path, ehd_error *error);

/* Attributes transport and, where it is known, smoothing of a training with trajectories. */
ehd_status carriage_write(artefact *file, const ehd_carriage *carriage, ehd_error *error);

/* Reads them; upwind where the first is missing, NaN where the second is. EHD_DATA: not known. */
ehd_status carriage_read(ehd_carriage *carriage, artefact *file, ehd_error *error);

/* The grid of a file of snapshots, a basis, a model or a result with fields. Errors as artefact_open. */
ehd_status grid_of_file(ehd_grid *grid, const contact_kind **kind, const char *path,
                        ehd_error *error);

/* EHD_DATA naming `path` when the shape of its contact, or its grid, differs from the one of
 * `expected_path`. */
ehd_status grid_check_shape(const ehd_grid *grid, const char *path, const ehd_grid *expected,
                            const char *expected_path, ehd_error *error);
ehd_status grid_check(const ehd_grid *grid, const char *path, const ehd_grid *expected,
                      const char *expected_path, ehd_error *error);

/* Says how many `bytes` solutions of a point contact, `num_jobs` at a time, will take in all,
 * before they are taken; nothing of a line. EHD_MEMORY, naming `object`: more than there are. */
ehd_status grid_check_memory(const program *caller, const char *object, const ehd_contact *contact,
                             double bytes, size_t num_jobs, ehd_error *error);

/* Prints how many nodes the whole grid has, from where to where and how far apart. */
void grid_print_nodes(const ehd_grid *grid);

/* Prints a contact's discretisation and, of a point contact, what lies around its grid. */
void grid_print_equations(const ehd_contact *contact);

/* Prints a contact's grid, and what it was chosen for where the scene does not give it. */
void grid_print(const ehd_contact *contact, const char *needed_by);

/* The scene of caller->arguments[0] with its overrides. `text` identifies it; free with free(). */
ehd_status scene_load(scene *given, char **text, const program *caller, ehd_error *error);

/* The loaded scene as a contact, of the kind that the file `model` has (NULL: any). */
ehd_status contact_load(ehd_contact *contact, const scene *given, const program *caller,
                        const contact_kind *kind, const char *model, ehd_error *error);

#endif
