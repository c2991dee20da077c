/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The files that a run reads, as its output records them (artefact_create). */
#ifndef EHD_INPUTS_H
#define EHD_INPUTS_H

#include "common/artefact/artefact.h"
#include "common/settings/scene.h"
#include <stddef.h>

/* Adds a path to the list where it is not in it yet; NULL is none. Returns the new count. */
size_t inputs_add(
    // output:
    const char **paths, // [count], with room for one more
    // input:
    size_t count, const char *path);

enum { MAX_TABLES = NUM_VARY + 1 }; // of a scene

/* The same with the tables that a scene's histories and its surface are read from. */
size_t inputs_add_tables(
    // output:
    const char **paths, // [count], with room for MAX_TABLES more; they point into the scene
    // input:
    size_t count, const scene *given);

/* Whether the tables are those that the output which is resumed was begun with. Errors as
 * artefact_check_input. */
ehd_status inputs_check_tables(artefact *file, const scene *given, ehd_error *error);

#endif
