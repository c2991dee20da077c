/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/output/grid_file.h"

#include "common/settings/scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double COARSEST_STEP = 0.125; // half widths, as for scenes

ehd_status grid_write_axis(artefact *file, const ehd_grid *grid, ehd_error *error) {
    double *x = malloc(grid->num_inner * sizeof *x);
    if (!x)
        return ehd_fail(error, EHD_MEMORY, "%s: x: found no memory for %zu nodes",
                        artefact_path(file), grid->num_inner);

    for (size_t i = 0; i < grid->num_inner; i++)
        x[i] = grid_x(grid, i + 1);
    ehd_status status = artefact_put_axis(file, "x", grid->num_inner, x, error);
    free(x);
    return status;
}

ehd_status grid_write_attributes(artefact *file, const contact_kind *kind, const ehd_grid *grid,
                                 ehd_error *error) {
    ehd_status status = artefact_put_text(file, "contact", kind->name, error);

    if (!status) status = artefact_put_real(file, "x_min", grid->x_min, error);
    if (!status) status = artefact_put_real(file, "step", grid->step, error);
    return status;
}

ehd_status grid_write(artefact *file, const contact_kind *kind, const ehd_grid *grid,
                      ehd_error *error) {
    ehd_status status = grid_write_axis(file, grid, error);
    return status ? status : grid_write_attributes(file, kind, grid, error);
}

ehd_status grid_read(ehd_grid *grid, const contact_kind **kind, artefact *file, ehd_error *error) {
    char *contact = NULL;
    ehd_status status = artefact_get_text(file, "contact", &contact, error);

    if (!status && strcmp(contact, contact_line.name))
        status = ehd_fail(error, EHD_DATA, "%s: contact: found %.32s, expected %s",
                          artefact_path(file), contact, contact_line.name);
    free(contact);
    *kind = &contact_line;
    if (!status) status = artefact_get_real(file, "x_min", &grid->x_min, error);
    if (!status) status = artefact_get_real(file, "step", &grid->step, error);
    if (status) return status;
    *grid = grid_of(grid->x_min, grid->step, artefact_length(file, "x"), 1, false);
    double x_max = grid->x_min + ((double)grid->num_inner - 1) * grid->step;
    if (!(grid->step > 0 && grid->step <= COARSEST_STEP && grid->x_min < -1 && x_max > 1))
        return ehd_fail(error, EHD_DATA,
                        "%s: x: found %g to %g in steps of %g, expected the dry contact inside and "
                        "steps of at most %g",
                        artefact_path(file), grid->x_min, x_max, grid->step, COARSEST_STEP);
    return EHD_OK;
}

ehd_status grid_check(const ehd_grid *grid, const char *path, const ehd_grid *expected,
                      const char *expected_path, ehd_error *error) {
    if (grid_same(grid, expected)) return EHD_OK;
    return ehd_fail(error, EHD_DATA,
                    "%s: x: found %zu nodes from %g by %g, expected %zu from %g by %g, as in %s",
                    path, grid->num_inner, grid->x_min, grid->step, expected->num_inner,
                    expected->x_min, expected->step, expected_path);
}

ehd_status contact_load(ehd_contact *contact, scene *given, char **text, const program *caller,
                        ehd_error *error) {
    const char *path = caller->arguments[0];
    ehd_error cause = {""};
    ehd_status status = scene_read(given, path, caller->overrides, caller->num_overrides, error);
    if (status) return status;

    status = contact_init(contact, given, &cause);
    if (status) return ehd_fail(error, status, "%s: %s", path, cause.text);
    *text = scene_text(given);
    return *text ? EHD_OK : ehd_fail(error, EHD_MEMORY, "%s: found no memory", path);
}
