/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "podbuild/snapshot_set.h"

#include "common/artefact/artefact.h"
#include "common/output/grid_file.h"
#include "common/program/arena.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

void snapshot_set_free(snapshot_set *set) {
    free(set->pressure);
    free(set->rigid_approach);
    free(set->exit);
    free(set->moes_M);
    free(set->alpha_p_H);
    free(set->thinning);
    free(set->central_film_thickness);
    free(set->stationary);
    free(set->rate);
    free(set->effects);
    free(set->rises);
    free(set->snapshots);
    memset(set, 0, sizeof *set);
}

static ehd_status grow(void **array, size_t rows, size_t columns, size_t size, ehd_error *error) {
    void *larger = array_resize(*array, rows, columns, size);
    if (!larger)
        return ehd_fail(error, EHD_MEMORY, "snapshots: found no memory for %zu of %zu numbers",
                        rows, columns);
    *array = larger;
    return EHD_OK;
}

static ehd_status reserve(snapshot_set *set, size_t num_states, ehd_error *error) {
    size_t count = num_states + 1;
    ehd_status status =
        grow((void **)&set->pressure, count, set->grid.num_nodes, sizeof(double), error);
    double **const columns[] = {
        &set->rigid_approach,         &set->moes_M, &set->alpha_p_H, &set->thinning,
        &set->central_film_thickness, &set->rate};

    for (size_t i = 0; i < sizeof columns / sizeof *columns && !status; i++)
        status = grow((void **)columns[i], count, 1, sizeof(double), error);
    if (!status)
        status = grow((void **)&set->exit, count, grid_lines(&set->grid), sizeof *set->exit, error);
    if (!status) status = grow((void **)&set->effects, count, 1, sizeof *set->effects, error);
    if (!status) status = grow((void **)&set->rises, count, 1, sizeof *set->rises, error);
    if (!status) status = grow((void **)&set->stationary, count, 1, sizeof *set->stationary, error);
    return status;
}

/* A field along the states, or where a result has it as an attribute, that value for each. */
static ehd_status read_column(double *column, artefact *file, const char *name, size_t count,
                              ehd_error *error) {
    double value;

    if (artefact_kind(file) == &schema_snapshots) return artefact_get(file, name, column, error);
    ehd_status status = artefact_get_real(file, name, &value, error);
    for (size_t i = 0; i < count && !status; i++)
        column[i] = value;
    return status;
}

/* One file's states before it is known which of them converged. */
typedef struct file_states {
    size_t count;
    double *rigid_approach, *moes_M, *alpha_p_H, *thinning, *central_film_thickness; // [count]
    int64_t *outcome;                                                                // [count]
    // of trajectories: index, -1 for a stationary point; time and rate
    int64_t *trajectory;          // [count]
    double *time, *rate;          // [count]
    double *effects[NUM_EFFECTS]; // [count]
    double *rises[NUM_RISES];     // [count]
    double *memory;
} file_states;

/* A column that a file need not have. */
static ehd_status read_optional(double *column, const file_states *states, artefact *file,
                                const char *name, double otherwise, ehd_error *error) {
    for (size_t i = 0; i < states->count; i++)
        column[i] = otherwise;
    return artefact_has(file, name) ? read_column(column, file, name, states->count, error)
                                    : EHD_OK;
}

static ehd_status read_effects(file_states *states, artefact *file, ehd_error *error) {
    double *column = states->memory + 7 * states->count;
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

    states->memory = array_new(7 + NUM_EFFECTS + NUM_RISES, count, sizeof(double));
    states->outcome = array_new(2, count, sizeof *states->outcome);
    if (!states->memory || !states->outcome)
        return ehd_fail(error, EHD_MEMORY, "%s: found no memory", artefact_path(file));
    states->rigid_approach = states->memory;
    states->moes_M = states->memory + count;
    states->alpha_p_H = states->memory + 2 * count;
    states->central_film_thickness = states->memory + 3 * count;
    states->time = states->memory + 4 * count;
    states->rate = states->memory + 5 * count;
    states->thinning = states->memory + 6 * count;
    states->trajectory = states->outcome + count;
    for (size_t i = 0; i < count; i++) {
        states->central_film_thickness[i] = NAN;
        states->trajectory[i] = -1;
    }
    ehd_status status = artefact_get(file, "rigid_approach", states->rigid_approach, error);
    if (!status) status = read_effects(states, file, error);
    if (!status) status = read_column(states->moes_M, file, "moes_M", count, error);
    if (!status) status = read_column(states->alpha_p_H, file, "alpha_p_H", count, error);
    if (!status) status = read_optional(states->thinning, states, file, "thinning", 0, error);
    if (!status && artefact_has(file, "central_film_thickness"))
        status =
            artefact_get(file, "central_film_thickness", states->central_film_thickness, error);
    if (!status && artefact_has(file, "status"))
        status = artefact_get_integers(file, "status", states->outcome, error);
    if (status || !artefact_has(file, "trajectory")) return status;
    status = artefact_get_integers(file, "trajectory", states->trajectory, error);
    if (!status) status = artefact_get(file, "trajectory_time", states->time, error);
    return status ? status : artefact_get(file, "trajectory_rate", states->rate, error);
}

/* The next state; `pressure` is its place in the set and filled. */
static void add_solved(snapshot_set *set, const solved_state *state, const double *pressure) {
    size_t s = set->num_states++;

    set->rigid_approach[s] = state->rigid_approach;
    set->moes_M[s] = state->moes_M;
    set->alpha_p_H[s] = state->alpha_p_H;
    set->thinning[s] = state->thinning;
    set->central_film_thickness[s] = state->central_film_thickness;
    grid_exit_columns(set->exit + s * grid_lines(&set->grid), pressure, &set->grid);
    set->stationary[s] = true;
    set->rate[s] = 0;
    set->effects[s] = film_effects_unknown();
    set->rises[s] = state->rises;
}

/* One entry of a field of pressures, boundary nodes included. */
static ehd_status get_pressure(double *pressure, const snapshot_set *set, artefact *file,
                               const char *field, size_t entry, ehd_error *error) {
    double *inner = array_new(set->grid.num_inner, 1, sizeof *inner);
    if (!inner) return ehd_fail(error, EHD_MEMORY, "%s: found no memory", artefact_path(file));

    ehd_status status = artefact_get_part(file, field, entry, 1, inner, error);
    memset(pressure, 0, set->grid.num_nodes * sizeof(double));
    if (!status) grid_put_inner(pressure, inner, &set->grid, false);
    free(inner);
    return status;
}

static ehd_status add_state(snapshot_set *set, artefact *file, const file_states *states, size_t i,
                            ehd_error *error) {
    size_t s = set->num_states, num_nodes = set->grid.num_nodes;
    double *pressure = set->pressure + s * num_nodes;
    // columns of trajectories have no values where a state is none of theirs
    bool in_time = states->trajectory[i] >= 0;
    double rate = in_time ? states->rate[i] : 0, sum = rate;

    ehd_status status = get_pressure(pressure, set, file, "pressure", i, error);
    if (status) return status;
    for (size_t k = 0; k < num_nodes; k++)
        sum += pressure[k];
    if (!isfinite(sum + states->rigid_approach[i] + states->moes_M[i] + states->alpha_p_H[i] +
                  states->thinning[i]))
        return ehd_fail(error, EHD_DATA, "%s: state %zu: found values that are not finite",
                        artefact_path(file), i);
    const solved_state state = {pressure,
                                states->rigid_approach[i],
                                states->moes_M[i],
                                states->alpha_p_H[i],
                                states->thinning[i],
                                states->central_film_thickness[i],
                                {{[RISE_VISCOSITY] = states->rises[RISE_VISCOSITY][i],
                                  [RISE_DENSITY] = states->rises[RISE_DENSITY][i]}}};
    add_solved(set, &state, pressure);
    set->stationary[s] = !in_time || states->time[i] == 0;
    set->rate[s] = rate;
    for (int e = 0; e < NUM_EFFECTS; e++)
        set->effects[s].of[e] = states->effects[e][i];
    return EHD_OK;
}

static ehd_status add_snapshots(snapshot_set *set, size_t count, ehd_error *error) {
    size_t num_nodes = set->grid.num_nodes;
    ehd_status status = grow((void **)&set->snapshots, set->num_snapshots + count, num_nodes,
                             sizeof(double), error);

    if (!status)
        memset(set->snapshots + set->num_snapshots * num_nodes, 0,
               count * num_nodes * sizeof(double));
    return status;
}

/* What of a file the basis is made of: stationary points as they are; of trajectories all steps,
 * which the file holds compressed, and not once more those states that it also keeps as such. */
static ehd_status collect_snapshots(snapshot_set *set, artefact *file, const file_states *states,
                                    size_t first_state, ehd_error *error) {
    size_t num_nodes = set->grid.num_nodes, s = first_state;
    size_t num_compressed = artefact_length(file, "compressed");
    ehd_status status = add_snapshots(set, states->count + num_compressed, error);

    for (size_t i = 0; i < states->count && !status; i++) {
        if (states->outcome[i] != 0) continue;
        if (states->trajectory[i] < 0)
            memcpy(set->snapshots + set->num_snapshots++ * num_nodes, set->pressure + s * num_nodes,
                   num_nodes * sizeof(double));
        s++;
    }
    for (size_t i = 0; i < num_compressed && !status; i++)
        status = get_pressure(set->snapshots + set->num_snapshots++ * num_nodes, set, file,
                              "compressed_pressure", i, error);
    return status;
}

/* All files with trajectories carry films in the same way. */
static ehd_status check_carriage(snapshot_set *set, artefact *file, const char *path,
                                 ehd_error *error) {
    ehd_carriage carriage;

    if (!artefact_has(file, "transport")) return EHD_OK;
    ehd_status status = carriage_read(&carriage, file, error);
    if (!status && set->transported)
        status = carriage_check(&carriage, path, &set->carriage, set->transported, error);
    if (!status && !set->transported) {
        set->transported = path;
        set->carriage = carriage;
    }
    return status;
}

static ehd_status add_file(snapshot_set *set, const char *path, const char *first,
                           ehd_error *error) {
    const artefact_schema *const kinds[] = {&schema_snapshots, &schema_result, NULL};
    artefact *file = NULL;
    file_states states = {0};
    ehd_grid grid = {0};
    ehd_status status = artefact_open(&file, path, kinds, error);

    if (!status && !artefact_has(file, "pressure"))
        status = ehd_fail(error, EHD_DATA, "%s: found no dataset pressure, expected fields", path);
    if (!status && artefact_kind(file) == &schema_result && artefact_length(file, "time") > 1)
        status =
            ehd_fail(error, EHD_DATA,
                     "%s: time: found %zu entries, expected 1, of a stationary result; snapgen "
                     "trains on transient scenes",
                     path, artefact_length(file, "time"));
    if (!status) status = grid_read(&grid, &set->kind, file, error);
    if (!status && path == first) set->grid = grid;
    if (!status) status = grid_check(&grid, path, &set->grid, first, error);
    if (!status) status = check_carriage(set, file, path, error);
    if (!status) status = read_columns(&states, file, error);
    if (!status) status = reserve(set, set->num_states + states.count, error);
    size_t first_state = set->num_states;
    for (size_t i = 0; i < states.count && !status; i++) {
        // 4 is solved, but outside of what a reduced model was made for: no training solution
        if (states.outcome[i] == 0)
            status = add_state(set, file, &states, i, error);
        else
            set->num_left_out++;
    }
    if (!status) status = collect_snapshots(set, file, &states, first_state, error);
    free(states.memory);
    free(states.outcome);
    artefact_close(&file);
    return status;
}

ehd_status snapshot_set_gather(snapshot_set *set, const solved_state *states, size_t num_states,
                               const contact_kind *kind, const ehd_grid *grid, ehd_error *error) {
    size_t bytes = num_states * grid->num_nodes * sizeof(double);

    *set = (snapshot_set){.kind = kind, .grid = *grid};
    ehd_status status = reserve(set, num_states, error);
    for (size_t s = 0; s < num_states && !status; s++) {
        double *pressure = set->pressure + s * grid->num_nodes;
        memcpy(pressure, states[s].pressure, grid->num_nodes * sizeof(double));
        add_solved(set, &states[s], pressure);
    }
    if (!status) status = add_snapshots(set, num_states, error);
    if (!status) {
        memcpy(set->snapshots, set->pressure, bytes);
        set->num_snapshots = num_states;
    }
    if (status) snapshot_set_free(set);
    return status;
}

ehd_status snapshot_set_read(snapshot_set *set, const char *const *paths, size_t num_paths,
                             ehd_error *error) {
    ehd_status status = EHD_OK;

    memset(set, 0, sizeof *set);
    for (size_t i = 0; i < num_paths && !status; i++)
        status = add_file(set, paths[i], paths[0], error);
    if (!status && set->num_states == 0)
        status = ehd_fail(error, EHD_DATA, "%s: found no converged state, expected at least one",
                          paths[0]);
    if (status) snapshot_set_free(set);
    return status;
}
