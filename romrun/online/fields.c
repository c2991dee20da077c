/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/online/fields.h"

#include "common/physics/deflection.h"

#include <cblas.h>
#include <string.h>

ehd_status reduced_fields(double *pressure, double *film, const reduced_state *state,
                          const reduced_model *model, const double *pressure_basis,
                          ehd_error *error) {
    const ehd_grid *grid = &model->grid;
    const double *z = state->coordinates;
    ehd_deflection *deflection = deflection_create(model->kind, grid);

    if (!deflection)
        return ehd_fail(error, EHD_MEMORY, "fields: found no memory for %zu nodes",
                        grid->num_nodes);
    cblas_dgemv(CblasRowMajor, CblasNoTrans, (int)grid->num_nodes, (int)model->num_pressure, 1,
                pressure_basis, (int)model->num_pressure, z, 1, 0, pressure, 1);
    const size_t *exit = reduced_state_exits(state);
    for (size_t l = 0; l < model->band.num_lines; l++)
        memset(pressure + l * grid_width(grid) + exit[l], 0,
               (grid_width(grid) - exit[l]) * sizeof(double));
    deflection_apply(film, deflection, pressure);
    for (size_t k = 0; k < grid->num_nodes; k++)
        film[k] += z[model->num_unknowns - 1] + grid_gap(grid, k);
    deflection_free(deflection);
    return EHD_OK;
}
