/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The grid and kind of contact that every file states, and the scene that a program is given. */
#ifndef EHD_GRID_FILE_H
#define EHD_GRID_FILE_H

#include "common/artefact/artefact.h"
#include "common/physics/contact.h"
#include "common/program/program.h"
#include <stdbool.h>

/* Axis x: the inner nodes. */
ehd_status grid_write_axis(artefact *file, const ehd_grid *grid, ehd_error *error);

/* Attributes contact, x_min and step. */
ehd_status grid_write_attributes(artefact *file, const contact_kind *kind, const ehd_grid *grid,
                                 ehd_error *error);

/* Both of them. */
ehd_status grid_write(artefact *file, const contact_kind *kind, const ehd_grid *grid,
                      ehd_error *error);

/* Grid and kind of contact of an open file. EHD_DATA when the dry contact does not lie inside, or the
 * kind is not known. */
ehd_status grid_read(ehd_grid *grid, const contact_kind **kind, artefact *file, ehd_error *error);

/* EHD_DATA naming `path` when its grid differs from the one of `expected_path`. */
ehd_status grid_check(const ehd_grid *grid, const char *path, const ehd_grid *expected,
                      const char *expected_path, ehd_error *error);

/* The scene of caller->arguments[0] with its overrides, and as a contact. `text` identifies the scene. */
ehd_status contact_load(
    // output:
    ehd_contact *contact, scene *given,
    char **text, // free with free()
    // input:
    const program *caller, ehd_error *error);

#endif
