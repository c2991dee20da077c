/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "podbuild/part_file.h"

#include "common/output/columns.h"
#include "common/output/grid_file.h"
#include "romrun/model/basis_file.h"

static ehd_status put_origin(artefact *file, const part_origin *origin, ehd_error *error) {
    const named_number numbers[] = {{"num_snapshots", (double)origin->num_snapshots},
                                    {"num_left_out", (double)origin->num_left_out},
                                    {"energy", origin->energy},
                                    {"energy_discarded", origin->discarded},
                                    {0}};
    const ehd_status status = numbers_put(file, 0, numbers, error);

    return status ? status
                  : artefact_put(file, "pressure_singular_values", origin->singular_values, error);
}

ehd_status part_write(const reduced_basis *basis, const part_origin *origin, const program *caller,
                      const char *settings_text, const char *const *inputs, ehd_error *error) {
    artefact *file = NULL;
    ehd_status status =
        artefact_create(&file, caller->output, &schema_part, caller, settings_text, inputs, error);

    if (!status) status = grid_write(file, basis->kind, &basis->grid, error);
    if (!status) status = carriage_write(file, &basis->carriage, error);
    if (!status) status = artefact_put_axis(file, "state", basis->states.num_states, NULL, error);
    if (!status)
        status = artefact_put_axis(file, "pressure_mode", basis->num_pressure, NULL, error);
    if (!status)
        status = modes_write(file, "pressure_basis", basis->pressure, &basis->grid,
                             basis->num_pressure, true, error);
    if (!status)
        status = states_write(file, &basis->states, basis->num_pressure, 0, &basis->grid, error);
    if (!status) status = put_origin(file, origin, error);
    if (!status) status = artefact_finish(&file, error);
    artefact_close(&file);
    return status;
}

static ehd_status get_count(size_t *count, artefact *file, const char *name, ehd_error *error) {
    int64_t number = 0;
    const ehd_status status =
        artefact_has(file, name) ? artefact_get_integer(file, name, &number, error) : EHD_OK;

    *count = (size_t)number;
    return status;
}

ehd_status part_read_origin(part_origin *origin, artefact *file, ehd_error *error) {
    ehd_status status = get_count(&origin->num_snapshots, file, "num_snapshots", error);

    if (!status) status = get_count(&origin->num_left_out, file, "num_left_out", error);
    if (!status) status = artefact_get_real(file, "energy", &origin->energy, error);
    if (!status) status = artefact_get_real(file, "energy_discarded", &origin->discarded, error);
    if (status || origin->discarded <= 1) return status;
    return ehd_fail(error, EHD_DATA, "%s: energy_discarded: found %g, expected at most 1",
                    artefact_path(file), origin->discarded);
}

ehd_status part_read_states(reduced_states *states, artefact *file, const ehd_grid *grid,
                            ehd_error *error) {
    return states_read(states, file, artefact_length(file, "pressure_mode"), 0, grid, error);
}

ehd_status part_check(const char *path, ehd_error *error) {
    const artefact_schema *const kinds[] = {&schema_part, NULL};
    const contact_kind *kind = NULL;
    reduced_states states = {0};
    part_origin origin;
    artefact *file = NULL;
    ehd_grid grid = {0};
    ehd_status status = artefact_open(&file, path, kinds, error);

    // artefact_check has already read the modes
    if (!status) status = grid_read(&grid, &kind, file, error);
    if (!status) status = part_read_origin(&origin, file, error);
    if (!status) status = part_read_states(&states, file, &grid, error);
    reduced_states_free(&states);
    artefact_close(&file);
    return status;
}
