/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads training solutions from files or memory, one field at a time. A row of a part is a mode
 * times its singular value (part_file.h).
 * Called by bases.c, main.c and readers.c, and by snapgen/trial.c for solutions in memory. */
#include "podbuild/snapshot_set.h"

#include "common/output/grid_file.h"
#include "common/program/arena.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Number of files kept open between readings, so that their digests are checked only once. */
enum { KEPT_OPEN = 200 };

// ---- columns

/* Columns of a snapshot or result file from which the converged states are read. */
typedef struct column_reader {
    artefact *file;
    size_t count;   // number of states, converged or not
    double *values; // [count] work array
    const snapshot_source *source;
} column_reader;

static bool is_result(const artefact *file) {
    return artefact_kind(file) == &schema_result;
}

/* Reads an optional column for the converged states. Writes to every `stride`-th number of `to`.
 * `attribute`: in a result file the value is an attribute. */
static ehd_status pick(double *to, size_t stride, const char *name, bool attribute,
                       const column_reader *from, ehd_error *error) {
    const snapshot_source *source = from->source;
    ehd_status status = EHD_OK;

    if (!artefact_has(from->file, name)) return EHD_OK;
    if (attribute && is_result(from->file))
        status = artefact_get_real(from->file, name, from->values, error);
    else
        status = artefact_get(from->file, name, from->values, from->count, error);
    for (size_t s = 0; s < source->num_states && !status; s++)
        to[s * stride] = from->values[source->entry[s]];
    return status;
}

/* Reads optional columns. If the file has no column for the central film, the central film is set
 * to NaN. Other quantities without a column keep their values. */
static ehd_status pick_optional(reduced_states *states, const column_reader *from,
                                ehd_error *error) {
    ehd_status status = pick(&states->thinning->sliding, 2, "thinning", true, from, error);

    if (!status)
        status = pick(&states->thinning->gradient, 2, "gradient_thinning", true, from, error);
    for (int e = 0; e < NUM_EFFECTS && !status; e++)
        status =
            pick(&states->effects->of[e], NUM_EFFECTS, film_effect_names[e], true, from, error);
    for (int r = 0; r < NUM_RISES && !status; r++)
        status = pick(&states->rises->of[r], NUM_RISES, lubricant_rise_names[r], true, from, error);
    for (size_t s = 0; s < states->num_states; s++)
        states->central_film_thickness[s] = NAN;
    return status ? status
                  : pick(states->central_film_thickness, 1, "central_film_thickness", false, from,
                         error);
}

/* Reads the rates of change on trajectories. Stationary points have no valid values in these
 * columns, so their rates are set to zero. In a trajectory only the first state is stationary.
 * `trajectory`: [count], -1 for stationary points. */
static ehd_status pick_rates(reduced_states *states, const column_reader *from,
                             const int64_t *trajectory, ehd_error *error) {
    double *time = array_new(states->num_states, 1, sizeof *time);
    ehd_status status = time ? EHD_OK : ehd_no_memory(error, artefact_path(from->file));
    const char *load_rate = artefact_has(from->file, "trajectory_load_rate")
                                ? "trajectory_load_rate"
                                : "trajectory_rate";

    if (!status) status = pick(time, 1, "trajectory_time", false, from, error);
    if (!status) status = pick(states->rate, 1, "trajectory_rate", false, from, error);
    if (!status) status = pick(states->load_rate, 1, load_rate, false, from, error);
    for (size_t s = 0; s < states->num_states && !status; s++) {
        const bool in_time = trajectory[from->source->entry[s]] >= 0;
        states->stationary[s] = !in_time || time[s] == 0;
        if (!in_time) states->rate[s] = states->load_rate[s] = 0;
    }
    free(time);
    return status;
}

/* Lists the converged states in `entry`, and the stationary points among them in `row_state`.
 * States of a trajectory are no rows, because the compressed steps of the trajectory contain them.
 * Untrusted states (EHD_UNTRUSTED) are left out. */
static ehd_status choose_states(snapshot_source *source, arena *memory, size_t count,
                                const int64_t *outcome, const int64_t *trajectory,
                                ehd_error *error) {
    source->entry = arena_array(memory, count, sizeof *source->entry);
    source->row_state = arena_array(memory, count, sizeof *source->row_state);
    if (!source->entry || !source->row_state) return ehd_no_memory(error, source->path);
    for (size_t i = 0; i < count; i++) {
        if (outcome[i] != 0) continue;
        if (trajectory[i] < 0) source->row_state[source->num_stationary++] = source->num_states;
        source->entry[source->num_states++] = i;
    }
    source->num_rows = source->num_stationary + artefact_length(source->file, "compressed");
    return EHD_OK;
}

static ehd_status check_columns(const snapshot_source *source, ehd_error *error) {
    const reduced_states *states = &source->states;

    for (size_t s = 0; s < states->num_states; s++)
        if (!isfinite(states->rate[s] + states->load_rate[s] + states->coordinates[s] +
                      states->moes_M[s] + states->alpha_p_H[s] + states->thinning[s].sliding +
                      states->thinning[s].gradient))
            return ehd_fail(error, EHD_DATA, "%s: state %zu: found values that are not finite",
                            source->path, source->entry[s]);
    return EHD_OK;
}

static ehd_status read_states(snapshot_source *source, const ehd_grid *grid, size_t count,
                              const int64_t *trajectory, double *values, ehd_error *error) {
    const column_reader from = {source->file, count, values, source};
    reduced_states *states = &source->states;
    ehd_status status = reduced_states_init(states, source->num_states, grid_lines(grid), 1, error);

    if (!status) status = pick(states->coordinates, 1, "rigid_approach", false, &from, error);
    if (!status) status = pick(states->moes_M, 1, "moes_M", true, &from, error);
    if (!status) status = pick(states->alpha_p_H, 1, "alpha_p_H", true, &from, error);
    if (!status) status = pick_optional(states, &from, error);
    if (!status && artefact_has(source->file, "trajectory"))
        status = pick_rates(states, &from, trajectory, error);
    return status ? status : check_columns(source, error);
}

/* Reads the columns of a snapshot or result file. */
static ehd_status learn_states(snapshot_set *self, snapshot_source *source, ehd_error *error) {
    artefact *file = source->file;
    const size_t count = artefact_length(file, is_result(file) ? "time" : "state");
    arena work = {0};
    int64_t *outcome = arena_array(&work, count, sizeof *outcome);
    int64_t *trajectory = arena_array(&work, count, sizeof *trajectory);
    double *values = arena_array(&work, count, sizeof *values);
    ehd_status status = work.failed ? ehd_no_memory(error, source->path) : EHD_OK;

    for (size_t i = 0; i < count && !status; i++)
        trajectory[i] = -1;
    if (!status && artefact_has(file, "status"))
        status = artefact_get_integers(file, "status", outcome, count, error);
    if (!status && artefact_has(file, "trajectory"))
        status = artefact_get_integers(file, "trajectory", trajectory, count, error);
    if (!status) status = choose_states(source, &self->memory, count, outcome, trajectory, error);
    if (!status) status = read_states(source, &self->grid, count, trajectory, values, error);
    self->num_left_out += count - source->num_states;
    arena_free(&work);
    return status;
}

// ---- files

/* Checks that all files with trajectories transport films in the same way. */
static ehd_status check_carriage(snapshot_set *self, artefact *file, const char *path,
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
    if (is_result(file) && artefact_length(file, "time") > 1)
        return ehd_fail(error, EHD_DATA,
                        "%s: time: found %zu entries, expected 1, of a stationary result; snapgen "
                        "trains on transient scenes",
                        path, artefact_length(file, "time"));
    return EHD_OK;
}

static ehd_status learn_part(snapshot_set *self, snapshot_source *source, ehd_error *error) {
    source->num_states = artefact_length(source->file, "state");
    source->num_rows = artefact_length(source->file, "pressure_mode");
    source->values = arena_array(&self->memory, source->num_rows, sizeof *source->values);
    if (!source->values) return ehd_no_memory(error, source->path);
    ehd_status status = part_read_origin(&source->origin, source->file, error);
    if (!status)
        status = artefact_get(source->file, "pressure_singular_values", source->values,
                              source->num_rows, error);
    self->num_left_out += source->origin.num_left_out;
    self->num_parts++;
    return status;
}

static ehd_status learn(snapshot_set *self, snapshot_source *source, ehd_error *error) {
    ehd_grid grid = {0};

    source->is_part = artefact_kind(source->file) == &schema_part;
    ehd_status status = source->is_part ? EHD_OK : check_kind(source->file, source->path, error);
    if (!status) status = grid_read(&grid, &self->kind, source->file, error);
    if (!status && source == self->sources) self->grid = grid;
    if (!status)
        status = grid_check(&grid, source->path, &self->grid, self->sources[0].path, error);
    if (!status) status = check_carriage(self, source->file, source->path, error);
    if (!status)
        status =
            source->is_part ? learn_part(self, source, error) : learn_states(self, source, error);
    self->num_states += source->num_states;
    self->num_rows += source->num_rows;
    return status;
}

ehd_status snapshot_set_use(snapshot_set *self, size_t index, ehd_error *error) {
    const artefact_schema *const kinds[] = {&schema_snapshots, &schema_result, &schema_part, NULL};
    snapshot_source *source = &self->sources[index];

    return source->file || !source->path ? EHD_OK
                                         : artefact_open(&source->file, source->path, kinds, error);
}

void snapshot_set_leave(snapshot_set *self, size_t index) {
    if (index >= KEPT_OPEN) artefact_close(&self->sources[index].file);
}

ehd_status snapshot_set_open(snapshot_set *self, const char *const *paths, size_t num_paths,
                             ehd_error *error) {
    ehd_status status = EHD_OK;

    *self = (snapshot_set){0};
    self->sources = arena_array(&self->memory, num_paths, sizeof *self->sources);
    if (!self->sources) return ehd_no_memory(error, paths[0]);
    self->num_sources = num_paths;
    for (size_t i = 0; i < num_paths; i++)
        self->sources[i].path = paths[i];
    for (size_t i = 0; i < num_paths && !status; i++) {
        status = snapshot_set_use(self, i, error);
        if (!status) status = learn(self, &self->sources[i], error);
        if (!status) snapshot_set_leave(self, i);
    }
    if (!status && self->num_states == 0)
        status = ehd_fail(error, EHD_DATA, "%s: found no converged state, expected at least one",
                          paths[0]);
    if (status) snapshot_set_close(self);
    return status;
}

void snapshot_set_close(snapshot_set *self) {
    for (size_t i = 0; i < self->num_sources; i++) {
        reduced_states_free(&self->sources[i].states);
        artefact_close(&self->sources[i].file);
    }
    arena_free(&self->memory);
    *self = (snapshot_set){0};
}

// ---- memory

static void put_solved(snapshot_source *source, size_t s, const solved_state *state,
                       const ehd_grid *grid) {
    reduced_states *states = &source->states;

    source->fields[s] = state->pressure;
    source->row_state[s] = s;
    states->coordinates[s] = state->rigid_approach;
    states->moes_M[s] = state->moes_M;
    states->alpha_p_H[s] = state->alpha_p_H;
    states->thinning[s] = state->thinning;
    states->central_film_thickness[s] = state->central_film_thickness;
    states->rises[s] = state->rises;
    grid_exit_columns(states->exit + s * states->num_lines, state->pressure, grid);
}

ehd_status snapshot_set_gather(snapshot_set *self, const solved_state *states, size_t num_states,
                               const contact_kind *kind, const ehd_grid *grid, ehd_error *error) {
    arena *memory = &self->memory;

    *self = (snapshot_set){.kind = kind, .grid = *grid};
    snapshot_source *source = self->sources = arena_array(memory, 1, sizeof *source);
    if (!source) return ehd_no_memory(error, "snapshots");
    self->num_sources = 1;
    self->num_states = self->num_rows = num_states;
    source->num_states = source->num_rows = source->num_stationary = num_states;
    source->fields = arena_array(memory, num_states, sizeof *source->fields);
    source->row_state = arena_array(memory, num_states, sizeof *source->row_state);
    ehd_status status = memory->failed ? ehd_no_memory(error, "snapshots")
                                       : reduced_states_init(&source->states, num_states,
                                                             grid_lines(grid), 1, error);
    for (size_t s = 0; s < num_states && !status; s++)
        put_solved(source, s, &states[s], grid);
    if (status) snapshot_set_close(self);
    return status;
}

// ---- fields

/* Reads one entry of `field`, a dataset of pressure fields, and sets the boundary nodes to zero. */
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

ehd_status snapshot_set_state(double *pressure, const snapshot_set *self, size_t index,
                              size_t state, ehd_error *error) {
    const snapshot_source *source = &self->sources[index];
    double sum = 0;

    if (source->fields) {
        memcpy(pressure, source->fields[state], self->grid.num_nodes * sizeof(double));
        return EHD_OK;
    }
    const ehd_status status =
        get_pressure(pressure, &self->grid, source->file, "pressure", source->entry[state], error);
    for (size_t k = 0; k < self->grid.num_nodes && !status; k++)
        sum += pressure[k];
    if (status || isfinite(sum)) return status;
    return ehd_fail(error, EHD_DATA, "%s: state %zu: found values that are not finite",
                    source->path, source->entry[state]);
}

ehd_status snapshot_set_row(double *pressure, const snapshot_set *self, size_t index, size_t row,
                            ehd_error *error) {
    const snapshot_source *source = &self->sources[index];

    if (row < source->num_stationary)
        return snapshot_set_state(pressure, self, index, source->row_state[row], error);
    if (!source->is_part)
        return get_pressure(pressure, &self->grid, source->file, "compressed_pressure",
                            row - source->num_stationary, error);
    const ehd_status status = snapshot_set_mode(pressure, self, index, row, error);
    for (size_t k = 0; k < self->grid.num_nodes && !status; k++)
        pressure[k] *= source->values[row];
    return status;
}

ehd_status snapshot_set_mode(double *mode, const snapshot_set *self, size_t index, size_t row,
                             ehd_error *error) {
    return get_pressure(mode, &self->grid, self->sources[index].file, "pressure_basis", row, error);
}
