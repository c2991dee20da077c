/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "podbuild/snapshot_files.h"

#include "common/program/arena.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Number of files that stay open between two passes, so that their digests are checked only
 * once. */
enum { KEPT_OPEN = 200 };

// ---- columns

/* Reads a column. A result has it as an attribute, which is repeated for each state. */
static ehd_status read_column(double *column, artefact *file, const char *name, size_t count,
                              ehd_error *error) {
    double value;

    if (artefact_kind(file) == &schema_snapshots)
        return artefact_get(file, name, column, count, error);
    ehd_status status = artefact_get_real(file, name, &value, error);
    for (size_t i = 0; i < count && !status; i++)
        column[i] = value;
    return status;
}

/* Reads an optional column; `otherwise` is the value if the file has none. */
static ehd_status read_optional(double *column, const file_states *states, artefact *file,
                                const char *name, double otherwise, ehd_error *error) {
    for (size_t i = 0; i < states->count; i++)
        column[i] = otherwise;
    return artefact_has(file, name) ? read_column(column, file, name, states->count, error)
                                    : EHD_OK;
}

static ehd_status read_effects(file_states *states, artefact *file, ehd_error *error) {
    double *column = states->memory + 9 * states->count;
    ehd_status status = EHD_OK;

    for (int e = 0; e < NUM_EFFECTS && !status; e++, column += states->count) {
        states->effects[e] = column;
        status = read_optional(column, states, file, film_effect_names[e], NAN, error);
    }
    for (int r = 0; r < NUM_RISES && !status; r++, column += states->count) {
        states->rises[r] = column;
        status = read_optional(column, states, file, lubricant_rise_names[r], NAN, error);
    }
    return status;
}

static ehd_status read_columns(file_states *states, artefact *file, ehd_error *error) {
    const char *axis = artefact_kind(file) == &schema_snapshots ? "state" : "time";
    size_t count = states->count = artefact_length(file, axis);

    states->memory = array_new(9 + NUM_EFFECTS + NUM_RISES, count, sizeof(double));
    states->outcome = array_new(2, count, sizeof *states->outcome);
    if (!states->memory || !states->outcome) return ehd_no_memory(error, artefact_path(file));
    states->rigid_approach = states->memory;
    states->moes_M = states->memory + count;
    states->alpha_p_H = states->memory + 2 * count;
    states->central_film_thickness = states->memory + 3 * count;
    states->time = states->memory + 4 * count;
    states->rate = states->memory + 5 * count;
    states->sliding = states->memory + 6 * count;
    states->gradient = states->memory + 8 * count;
    states->load_rate = states->memory + 7 * count;
    states->trajectory = states->outcome + count;
    for (size_t i = 0; i < count; i++) {
        states->central_film_thickness[i] = NAN;
        states->trajectory[i] = -1;
    }
    ehd_status status =
        artefact_get(file, "rigid_approach", states->rigid_approach, states->count, error);
    if (!status) status = read_effects(states, file, error);
    if (!status) status = read_column(states->moes_M, file, "moes_M", count, error);
    if (!status) status = read_column(states->alpha_p_H, file, "alpha_p_H", count, error);
    if (!status) status = read_optional(states->sliding, states, file, "thinning", 0, error);
    if (!status)
        status = read_optional(states->gradient, states, file, "gradient_thinning", 0, error);
    if (!status && artefact_has(file, "central_film_thickness"))
        status = artefact_get(file, "central_film_thickness", states->central_film_thickness,
                              states->count, error);
    if (!status && artefact_has(file, "status"))
        status = artefact_get_integers(file, "status", states->outcome, states->count, error);
    if (status || !artefact_has(file, "trajectory")) return status;
    status = artefact_get_integers(file, "trajectory", states->trajectory, states->count, error);
    if (!status) status = artefact_get(file, "trajectory_time", states->time, states->count, error);
    if (!status) status = artefact_get(file, "trajectory_rate", states->rate, states->count, error);
    if (status) return status;
    if (artefact_has(file, "trajectory_load_rate"))
        return artefact_get(file, "trajectory_load_rate", states->load_rate, states->count, error);
    memcpy(states->load_rate, states->rate, count * sizeof *states->rate);
    return EHD_OK;
}

// ---- files

/* Checks that films are carried in one way in all files with trajectories. */
static ehd_status check_carriage(snapshot_files *self, artefact *file, const char *path,
                                 ehd_error *error) {
    ehd_carriage carriage;

    if (!artefact_has(file, "transport")) return EHD_OK;
    ehd_status status = carriage_read(&carriage, file, error);
    if (!status && self->transported)
        status = carriage_check(&carriage, path, &self->carriage, self->transported, error);
    if (!status && !self->transported) {
        self->transported = path;
        self->carriage = carriage;
    }
    return status;
}

static ehd_status check_kind(artefact *file, const char *path, ehd_error *error) {
    if (!artefact_has(file, "pressure"))
        return ehd_fail(error, EHD_DATA, "%s: found no dataset pressure, expected fields", path);
    if (artefact_kind(file) == &schema_result && artefact_length(file, "time") > 1)
        return ehd_fail(error, EHD_DATA,
                        "%s: time: found %zu entries, expected 1, of a stationary result; snapgen "
                        "trains on transient scenes",
                        path, artefact_length(file, "time"));
    return EHD_OK;
}

/* Counts the converged states of a file, and the rows that the basis is built from. */
static ehd_status count_states(snapshot_files *self, snapshot_file *file, ehd_error *error) {
    const file_states *states = &file->states;

    for (size_t i = 0; i < states->count; i++) {
        // status 4 (EHD_UNTRUSTED) is no training solution either
        if (states->outcome[i] != 0) {
            self->num_left_out++;
            continue;
        }
        file->num_states++;
        if (states->trajectory[i] < 0) file->num_rows++;
        const double rates =
            states->trajectory[i] >= 0 ? states->rate[i] + states->load_rate[i] : 0;
        if (!isfinite(rates + states->rigid_approach[i] + states->moes_M[i] + states->alpha_p_H[i] +
                      states->sliding[i] + states->gradient[i]))
            return ehd_fail(error, EHD_DATA, "%s: state %zu: found values that are not finite",
                            file->path, i);
    }
    file->num_rows += artefact_length(file->file, "compressed");
    return EHD_OK;
}

static ehd_status count_part(snapshot_files *self, snapshot_file *file, ehd_error *error) {
    file->is_part = true;
    file->num_states = artefact_length(file->file, "state");
    file->num_rows = artefact_length(file->file, "pressure_mode");
    file->values = array_new(file->num_rows, 1, sizeof *file->values);
    if (!file->values) return ehd_no_memory(error, file->path);
    ehd_status status = part_read_origin(&file->origin, file->file, error);
    if (!status)
        status = artefact_get(file->file, "pressure_singular_values", file->values, file->num_rows,
                              error);
    self->num_left_out += file->origin.num_left_out;
    self->num_parts++;
    return status;
}

static ehd_status learn(snapshot_files *self, snapshot_file *file, ehd_error *error) {
    const char *first = self->files[0].path;
    ehd_grid grid = {0};

    const bool is_part = artefact_kind(file->file) == &schema_part;
    ehd_status status = is_part ? EHD_OK : check_kind(file->file, file->path, error);
    if (!status) status = grid_read(&grid, &self->kind, file->file, error);
    if (!status && file == self->files) self->grid = grid;
    if (!status) status = grid_check(&grid, file->path, &self->grid, first, error);
    if (!status) status = check_carriage(self, file->file, file->path, error);
    if (status) return status;
    if (is_part) return count_part(self, file, error);
    status = read_columns(&file->states, file->file, error);
    return status ? status : count_states(self, file, error);
}

ehd_status snapshot_file_use(snapshot_files *self, size_t index, ehd_error *error) {
    const artefact_schema *const kinds[] = {&schema_snapshots, &schema_result, &schema_part, NULL};
    snapshot_file *file = &self->files[index];

    return file->file ? EHD_OK : artefact_open(&file->file, file->path, kinds, error);
}

void snapshot_file_leave(snapshot_files *self, size_t index) {
    if (index >= KEPT_OPEN) artefact_close(&self->files[index].file);
}

ehd_status snapshot_files_open(snapshot_files *self, const char *const *paths, size_t num_paths,
                               ehd_error *error) {
    ehd_status status = EHD_OK;

    *self = (snapshot_files){.files = array_new(num_paths, 1, sizeof *self->files)};
    if (!self->files) return ehd_no_memory(error, paths[0]);
    self->num_files = num_paths;
    for (size_t i = 0; i < num_paths; i++)
        self->files[i].path = paths[i];
    for (size_t i = 0; i < num_paths && !status; i++) {
        status = snapshot_file_use(self, i, error);
        if (!status) status = learn(self, &self->files[i], error);
        if (!status) snapshot_file_leave(self, i);
        self->num_states += self->files[i].num_states;
        self->num_rows += self->files[i].num_rows;
    }
    if (!status && self->num_states == 0)
        status = ehd_fail(error, EHD_DATA, "%s: found no converged state, expected at least one",
                          paths[0]);
    if (status) snapshot_files_close(self);
    return status;
}

void snapshot_files_close(snapshot_files *self) {
    for (size_t i = 0; i < self->num_files; i++) {
        free(self->files[i].states.memory);
        free(self->files[i].states.outcome);
        free(self->files[i].values);
        artefact_close(&self->files[i].file);
    }
    free(self->files);
    *self = (snapshot_files){0};
}

// ---- fields

/* Reads one entry of a pressure field and sets the boundary nodes to zero. */
static ehd_status get_pressure(double *pressure, const ehd_grid *grid, artefact *file,
                               const char *field, size_t entry, ehd_error *error) {
    double *inner = array_new(grid->num_inner, 1, sizeof *inner);
    if (!inner) return ehd_no_memory(error, artefact_path(file));

    ehd_status status = artefact_get_part(file, field, entry, 1, inner, grid->num_inner, error);
    memset(pressure, 0, grid->num_nodes * sizeof(double));
    if (!status) grid_put_inner(pressure, inner, grid, false);
    free(inner);
    return status;
}

ehd_status snapshot_file_state(double *pressure, const snapshot_files *self, size_t index,
                               size_t state, ehd_error *error) {
    const snapshot_file *file = &self->files[index];
    double sum = 0;
    ehd_status status = get_pressure(pressure, &self->grid, file->file, "pressure", state, error);

    for (size_t k = 0; k < self->grid.num_nodes && !status; k++)
        sum += pressure[k];
    if (status || isfinite(sum)) return status;
    return ehd_fail(error, EHD_DATA, "%s: state %zu: found values that are not finite", file->path,
                    state);
}

ehd_status snapshot_file_row(double *pressure, const snapshot_files *self, size_t index, size_t row,
                             ehd_error *error) {
    const snapshot_file *file = &self->files[index];

    if (!file->is_part)
        return get_pressure(pressure, &self->grid, file->file, "compressed_pressure", row, error);
    const ehd_status status = snapshot_file_mode(pressure, self, index, row, error);
    for (size_t k = 0; k < self->grid.num_nodes && !status; k++)
        pressure[k] *= file->values[row];
    return status;
}

ehd_status snapshot_file_mode(double *mode, const snapshot_files *self, size_t index, size_t row,
                              ehd_error *error) {
    return get_pressure(mode, &self->grid, self->files[index].file, "pressure_basis", row, error);
}

size_t snapshot_file_compressed(const snapshot_files *self, size_t index) {
    const snapshot_file *file = &self->files[index];

    return file->is_part ? file->num_rows : artefact_length(file->file, "compressed");
}
