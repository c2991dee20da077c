/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lists the files that a run reads. The output of the run records this list (artefact_create). */
#ifndef EHD_INPUTS_H
#define EHD_INPUTS_H

#include "common/artefact/artefact.h"
#include "common/settings/scene.h"
#include <stddef.h>

/* Adds a path to the list, unless it is NULL or already there. Returns the new count. */
size_t inputs_add(
    // output:
    const char **paths, // [count], with room for one more
    // input:
    size_t count, const char *path);

enum { MAX_TABLES = NUM_VARY + 1 }; // largest number of tables of a scene

/* Adds the tables of a scene's histories and surface to the list. Returns the new count. */
size_t inputs_add_tables(
    // output:
    const char **paths, // [count], with room for MAX_TABLES more; new paths point into the scene
    // input:
    size_t count, const scene *given);

/* Checks that the tables have not changed since the output, which is now resumed, was begun.
 * Errors: see artefact_check_input. */
ehd_status inputs_check_tables(artefact *file, const scene *given, ehd_error *error);

#endif
