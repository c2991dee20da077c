/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "podbuild/snapshot_set.h"

#include "common/program/arena.h"

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
    free(set->load_rate);
    free(set->effects);
    free(set->rises);
    free(set->snapshots);
    memset(set, 0, sizeof *set);
}

static ehd_status grow(void **array, size_t rows, size_t columns, size_t size, ehd_error *error) {
    void *larger = array_resize(*array, rows, columns, size);
    if (!larger) return ehd_no_memory(error, "snapshots");
    *array = larger;
    return EHD_OK;
}

static ehd_status reserve(snapshot_set *set, size_t num_states, ehd_error *error) {
    size_t count = num_states + 1;
    ehd_status status = EHD_OK;
    double **const columns[] = {&set->rigid_approach,         &set->moes_M, &set->alpha_p_H,
                                &set->central_film_thickness, &set->rate,   &set->load_rate};

    for (size_t i = 0; i < sizeof columns / sizeof *columns && !status; i++)
        status = grow((void **)columns[i], count, 1, sizeof(double), error);
    if (!status)
        status = grow((void **)&set->exit, count, grid_lines(&set->grid), sizeof *set->exit, error);
    if (!status) status = grow((void **)&set->thinning, count, 1, sizeof *set->thinning, error);
    if (!status) status = grow((void **)&set->effects, count, 1, sizeof *set->effects, error);
    if (!status) status = grow((void **)&set->rises, count, 1, sizeof *set->rises, error);
    if (!status) status = grow((void **)&set->stationary, count, 1, sizeof *set->stationary, error);
    return status;
}

/* Reserves memory for the states, their fields, and the snapshots of the basis. */
static ehd_status reserve_fields(snapshot_set *set, size_t num_states, size_t num_snapshots,
                                 ehd_error *error) {
    const size_t num_nodes = set->grid.num_nodes;
    ehd_status status = reserve(set, num_states, error);

    if (!status)
        status = grow((void **)&set->pressure, num_states + 1, num_nodes, sizeof(double), error);
    if (!status)
        status =
            grow((void **)&set->snapshots, num_snapshots + 1, num_nodes, sizeof(double), error);
    return status;
}

/* Appends a solution without its field. The exit follows from `pressure`. */
static void add_solved(snapshot_set *set, const solved_state *state, const double *pressure) {
    size_t s = set->num_states++;

    set->rigid_approach[s] = state->rigid_approach;
    set->moes_M[s] = state->moes_M;
    set->alpha_p_H[s] = state->alpha_p_H;
    set->thinning[s] = state->thinning;
    set->central_film_thickness[s] = state->central_film_thickness;
    grid_exit_columns(set->exit + s * grid_lines(&set->grid), pressure, &set->grid);
    set->stationary[s] = true;
    set->rate[s] = set->load_rate[s] = 0;
    set->effects[s] = film_effects_unknown();
    set->rises[s] = state->rises;
}

void snapshot_set_add(snapshot_set *set, const double *pressure, const file_states *states,
                      size_t i) {
    const size_t s = set->num_states;
    // columns of trajectories have no valid values at stationary points
    const bool in_time = states->trajectory[i] >= 0;
    lubricant_rises rises;

    for (int r = 0; r < NUM_RISES; r++)
        rises.of[r] = states->rises[r][i];
    const solved_state state = {pressure,
                                states->rigid_approach[i],
                                states->moes_M[i],
                                states->alpha_p_H[i],
                                {states->sliding[i], states->gradient[i]},
                                states->central_film_thickness[i],
                                rises};
    add_solved(set, &state, pressure);
    set->stationary[s] = !in_time || states->time[i] == 0;
    set->rate[s] = in_time ? states->rate[i] : 0;
    set->load_rate[s] = in_time ? states->load_rate[i] : 0;
    for (int e = 0; e < NUM_EFFECTS; e++)
        set->effects[s].of[e] = states->effects[e][i];
}

void snapshot_set_add_reduced(snapshot_set *set, const reduced_states *states) {
    const size_t first = set->num_states, num_lines = states->num_lines, num = states->num_states;

    for (size_t s = 0; s < num; s++)
        set->rigid_approach[first + s] =
            states->coordinates[(s + 1) * states->num_unknowns - 1]; // the rigid approach
    memcpy(set->exit + first * num_lines, states->exit, num * num_lines * sizeof *set->exit);
    memcpy(set->moes_M + first, states->moes_M, num * sizeof(double));
    memcpy(set->alpha_p_H + first, states->alpha_p_H, num * sizeof(double));
    memcpy(set->thinning + first, states->thinning, num * sizeof *set->thinning);
    memcpy(set->central_film_thickness + first, states->central_film_thickness,
           num * sizeof(double));
    memcpy(set->stationary + first, states->stationary, num * sizeof *set->stationary);
    memcpy(set->rate + first, states->rate, num * sizeof(double));
    memcpy(set->load_rate + first, states->load_rate, num * sizeof(double));
    memcpy(set->effects + first, states->effects, num * sizeof *set->effects);
    memcpy(set->rises + first, states->rises, num * sizeof *set->rises);
    set->num_states += num;
}

/* Adds all states of a file. The basis is built from stationary states as they are, and from the
 * steps of trajectories, which the file holds in compressed form. States that the file also keeps
 * of a trajectory are among these steps, so they do not become snapshots again. */
static ehd_status add_file(snapshot_set *set, const snapshot_files *files, size_t index,
                           ehd_error *error) {
    const file_states *states = &files->files[index].states;
    const size_t num_nodes = set->grid.num_nodes;
    ehd_status status = EHD_OK;

    for (size_t i = 0; i < states->count && !status; i++) {
        double *pressure = set->pressure + set->num_states * num_nodes;
        if (states->outcome[i] != 0) continue;
        status = snapshot_file_state(pressure, files, index, i, error);
        if (status) break;
        snapshot_set_add(set, pressure, states, i);
        if (states->trajectory[i] < 0)
            memcpy(set->snapshots + set->num_snapshots++ * num_nodes, pressure,
                   num_nodes * sizeof(double));
    }
    for (size_t i = 0; i < snapshot_file_compressed(files, index) && !status; i++)
        status = snapshot_file_row(set->snapshots + set->num_snapshots++ * num_nodes, files, index,
                                   i, error);
    return status;
}

ehd_status snapshot_set_gather(snapshot_set *set, const solved_state *states, size_t num_states,
                               const contact_kind *kind, const ehd_grid *grid, ehd_error *error) {
    size_t bytes = num_states * grid->num_nodes * sizeof(double);

    *set = (snapshot_set){.kind = kind, .grid = *grid};
    ehd_status status = reserve_fields(set, num_states, num_states, error);
    for (size_t s = 0; s < num_states && !status; s++) {
        double *pressure = set->pressure + s * grid->num_nodes;
        memcpy(pressure, states[s].pressure, grid->num_nodes * sizeof(double));
        add_solved(set, &states[s], pressure);
    }
    if (!status) {
        memcpy(set->snapshots, set->pressure, bytes);
        set->num_snapshots = num_states;
    }
    if (status) snapshot_set_free(set);
    return status;
}

ehd_status snapshot_set_begin(snapshot_set *set, const snapshot_files *files, ehd_error *error) {
    *set = (snapshot_set){.kind = files->kind,
                          .grid = files->grid,
                          .transported = files->transported,
                          .carriage = files->carriage,
                          .num_left_out = files->num_left_out};
    const ehd_status status = reserve(set, files->num_states, error);
    if (status) snapshot_set_free(set);
    return status;
}

double snapshot_set_bytes(const snapshot_files *files) {
    const double each = 7 * sizeof(double) + sizeof(bool) + sizeof(film_effects) +
                        sizeof(lubricant_rises) + (double)grid_lines(&files->grid) * sizeof(size_t);

    return each * ((double)files->num_states + 1);
}

ehd_status snapshot_set_read(snapshot_set *set, snapshot_files *files, ehd_error *error) {
    ehd_status status = snapshot_set_begin(set, files, error);

    if (!status) status = reserve_fields(set, files->num_states, files->num_rows, error);
    for (size_t i = 0; i < files->num_files && !status; i++) {
        status = snapshot_file_use(files, i, error);
        if (!status) status = add_file(set, files, i, error);
        if (!status) snapshot_file_leave(files, i);
    }
    if (status) snapshot_set_free(set);
    return status;
}
