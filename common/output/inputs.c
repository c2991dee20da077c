/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/output/inputs.h"

#include <string.h>

size_t inputs_add(const char **paths, size_t count, const char *path) {
    if (!path) return count;
    for (size_t i = 0; i < count; i++)
        if (strcmp(paths[i], path) == 0) return count;
    paths[count] = path;
    return count + 1;
}

size_t inputs_add_tables(const char **paths, size_t count, const scene *given) {
    for (size_t i = 0; i < NUM_VARY; i++)
        if (given->transient.vary[i].file[0])
            count = inputs_add(paths, count, given->transient.vary[i].file);
    if (given->surface.file[0]) count = inputs_add(paths, count, given->surface.file);
    return count;
}

ehd_status inputs_check_tables(artefact *file, const scene *given, ehd_error *error) {
    const char *tables[MAX_TABLES];
    size_t num_tables = inputs_add_tables(tables, 0, given);
    ehd_status status = EHD_OK;

    for (size_t i = 0; i < num_tables && !status; i++)
        status = artefact_check_input(file, "table", tables[i], error);
    return status;
}
