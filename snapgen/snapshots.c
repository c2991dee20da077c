/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "snapgen/snapshots.h"

#include "common/output/columns.h"
#include "common/output/grid_file.h"
#include "common/output/inputs.h"
#include "common/physics/traction.h"
#include "common/program/arena.h"
#include "common/time/path_filter.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- creating

/* Writes the thinning of a state, if the file has columns for thinned flows. */
static ehd_status put_thinning(artefact *file, size_t state, flow_thinning thinning,
                               ehd_error *error) {
    const named_number numbers[] = {
        {"thinning", thinning.sliding}, {"gradient_thinning", thinning.gradient}, {0}};

    return artefact_has(file, "thinning") ? numbers_put(file, state, numbers, error) : EHD_OK;
}

static ehd_status put_rises(artefact *file, size_t state, const lubricant_rises *rises,
                            ehd_error *error) {
    ehd_status status = EHD_OK;

    for (int r = 0; r < NUM_RISES && !status; r++)
        status = artefact_put_part(file, lubricant_rise_names[r], state, 1, &rises->of[r], error);
    return status;
}

ehd_status snapshots_put_contact(artefact *file, size_t state, const ehd_contact *contact,
                                 ehd_error *error) {
    const named_number numbers[] = {{"moes_M", contact->moes_M},
                                    {"moes_L", contact->moes_L},
                                    {"alpha_p_H", contact->alpha_p_H},
                                    {"hertz_pressure", contact->hertz_pressure},
                                    {0}};
    const lubricant_rises rises = lubricant_rises_at(&contact->lubricant, contact->hertz_pressure);
    ehd_status status = numbers_put(file, state, numbers, error);

    if (!status) status = put_thinning(file, state, traction_thinning(contact), error);
    return status ? status : put_rises(file, state, &rises, error);
}

/* Writes the contacts of all points before any point is solved. */
static ehd_status put_contacts(artefact *file, const training_set *set, ehd_error *error) {
    ehd_status status = EHD_OK;

    for (size_t i = 0; i < set->num_points && !status; i++)
        status = snapshots_put_contact(file, i, &set->contacts[i], error);
    return status;
}

/* Returns the number of states: the points, then the kept states of each trajectory. */
static size_t num_states(const training_set *set) {
    return set->num_points + set->num_trajectories * NUM_KEPT;
}

static bool begins_with(const char *name, const char *beginning) {
    return strncmp(name, beginning, strlen(beginning)) == 0;
}

static bool is_effect(const char *name) {
    for (int e = 0; e < NUM_EFFECTS; e++)
        if (strcmp(name, film_effect_names[e]) == 0) return true;
    return false;
}

static bool any_estimated(const training_set *set) {
    for (size_t i = 0; i < set->num_points; i++)
        if (set->estimated[i]) return true;
    return false;
}

static bool any_thinned(const training_set *set) {
    for (size_t i = 0; i < set->num_points; i++)
        if (traction_thins_flow(&set->contacts[i])) return true;
    for (size_t t = 0; t < set->num_trajectories; t++)
        if (traction_thins_flow(&set->trajectories[t].contact)) return true;
    return false;
}

ehd_status snapshots_declare(artefact *file, const training_set *set, bool adaptive,
                             ehd_error *error) {
    const bool in_time = set->num_trajectories > 0, estimated = any_estimated(set),
               thinned = any_thinned(set);
    ehd_status status = EHD_OK;

    for (const artefact_field *field = schema_snapshots.fields; field->name && !status; field++) {
        bool applies = (in_time || !begins_with(field->name, "trajectory")) &&
                       (adaptive || !begins_with(field->name, "training")) &&
                       (estimated || !is_effect(field->name)) &&
                       (thinned || !strstr(field->name, "thinning"));
        if (strcmp(field->axes[0], "state") == 0 && applies)
            status = artefact_declare(file, field->name, error);
    }
    return status;
}

ehd_status snapshots_create(artefact **file, const program *caller, const training_set *set,
                            const char *plan_path, ehd_error *error) {
    const char **inputs = training_inputs(set, plan_path, NULL);
    ehd_status status = inputs ? artefact_create(file, caller->output, &schema_snapshots, caller,
                                                 set->text, inputs, error)
                               : ehd_no_memory(error, plan_path);

    if (!status) status = artefact_put_axis(*file, "state", num_states(set), NULL, error);
    if (!status) status = grid_write(*file, set->kind, &set->grid, error);
    if (!status && set->num_trajectories > 0) {
        const ehd_carriage carriage = path_carriage(&set->trajectories[0].contact);
        status = carriage_write(*file, &carriage, error);
    }
    if (!status) status = snapshots_declare(*file, set, false, error);
    if (!status) status = put_contacts(*file, set, error);
    if (!status) status = artefact_begin_streaming(*file, error);
    if (status) artefact_close(file);
    free(inputs);
    return status;
}

// ---- storing

/* Writes where the pressure ends on each line, as an index into x and as a coordinate X. */
static ehd_status put_exits(artefact *file, const ehd_grid *grid, size_t place,
                            const double *pressure, ehd_error *error) {
    size_t num_lines = grid->inner_lines, whole_lines = grid_whole(grid).inner_lines;
    size_t *columns = malloc(grid_lines(grid) * sizeof *columns);
    double *positions = malloc(whole_lines * sizeof *positions);
    int64_t *exits = malloc(num_lines * sizeof *exits);
    ehd_status status =
        columns && positions && exits ? EHD_OK : ehd_no_memory(error, artefact_path(file));

    if (!status) {
        grid_exit_columns(columns, pressure, grid);
        grid_exits(positions, columns, grid);
        for (size_t l = 0; l < num_lines; l++)
            exits[l] = (int64_t)columns[grid_first_line(grid) + l] - 1;
        status = artefact_put_integers_part(file, "exit_node", place, 1, exits, error);
    }
    if (!status)
        status = artefact_put_part(file, "exit_position", place, 1,
                                   positions + whole_lines - num_lines, error);
    free(columns);
    free(positions);
    free(exits);
    return status;
}

/* Writes pressure and film, [num_nodes] each, and the places where the pressure ends. */
static ehd_status put_fields(artefact *file, const ehd_grid *grid, size_t place,
                             const double *pressure, const double *film, ehd_error *error) {
    ehd_status status = grid_put_field(file, "pressure", place, pressure, grid, false, error);

    if (!status) status = grid_put_field(file, "film_thickness", place, film, grid, false, error);
    return status ? status : put_exits(file, grid, place, pressure, error);
}

static ehd_status put_solution(artefact *file, const training_set *set, size_t point,
                               const snapshot *solution, ehd_error *error) {
    const full_state *state = &solution->state;
    const contact_scalars *scalars = &solution->scalars;
    const named_number numbers[] = {{"rigid_approach", state->rigid_approach},
                                    {"central_film_thickness", scalars->central_film_thickness},
                                    {"minimum_film_thickness", scalars->minimum_film_thickness},
                                    {"central_pressure", scalars->central_pressure},
                                    {"complementarity", solution->complementarity},
                                    {0}};
    ehd_status status = put_fields(file, &set->grid, point, state->pressure, state->film, error);

    if (!status && set->grid.inner_lines == 1) // the exit may lie within the cell of a node
        status = artefact_put_part(file, "exit_position", point, 1, &scalars->exit_position, error);
    if (!status) status = numbers_put(file, point, numbers, error);
    for (int e = 0; e < NUM_EFFECTS && !status; e++)
        if (artefact_has(file, film_effect_names[e]))
            status = artefact_put_part(file, film_effect_names[e], point, 1,
                                       &solution->effects.of[e], error);
    return status;
}

ehd_status snapshots_store(void *sink, const training_set *set, size_t point,
                           const snapshot *solution, ehd_error *error) {
    artefact *file = sink;
    const named_number numbers[] = {{"newton_iterations", (double)solution->newton_iterations},
                                    {"residual_norm", solution->residual},
                                    {0}};
    const int64_t outcome = solution->status ? 1 : 0;
    ehd_status status = EHD_OK;

    if (!solution->status) status = put_solution(file, set, point, solution, error);
    if (!status) status = numbers_put(file, point, numbers, error);
    // the status is written last: it marks that the other data are on the disk
    if (!status) status = artefact_sync(file, error);
    if (!status) status = artefact_put_integers_part(file, "status", point, 1, &outcome, error);
    if (!status) status = artefact_flush(file, error);
    if (!status) artefact_save(file);
    return status;
}

// ---- trajectories

static ehd_status put_kept_state(artefact *file, const ehd_grid *grid, size_t place,
                                 int64_t trajectory, const kept_state *state, bool failed,
                                 ehd_error *error) {
    const contact_scalars *scalars = &state->scalars;
    const named_number solution[] = {{"rigid_approach", scalars->rigid_approach},
                                     {"central_film_thickness", scalars->central_film_thickness},
                                     {"minimum_film_thickness", scalars->minimum_film_thickness},
                                     {"central_pressure", scalars->central_pressure},
                                     {"moes_M", state->moes_M},
                                     {"moes_L", state->moes_L},
                                     {"alpha_p_H", state->alpha_p_H},
                                     {"hertz_pressure", state->hertz_pressure},
                                     {"residual_norm", state->residual},
                                     {"trajectory_time", state->time},
                                     {"trajectory_rate", state->rate},
                                     {"trajectory_load_rate", state->load_rate},
                                     {0}};
    const named_number outcome[] = {{"newton_iterations", (double)state->iterations},
                                    {"trajectory", (double)trajectory},
                                    {"status", failed ? 1 : 0},
                                    {0}};
    ehd_status status =
        failed ? EHD_OK : put_fields(file, grid, place, state->pressure, state->film, error);

    if (!status && !failed) status = numbers_put(file, place, solution, error);
    if (!status) status = put_thinning(file, place, state->thinning, error);
    if (!status && !failed) status = put_rises(file, place, &state->rises, error);
    return status ? status : numbers_put(file, place, outcome, error);
}

static ehd_status put_compressed(artefact *file, const ehd_grid *grid, const pod_basis *set,
                                 ehd_error *error) {
    const named_number numbers[] = {{"compressed_snapshots", (double)set->num_snapshots},
                                    {"compressed_energy_discarded", pod_discarded(set)},
                                    {0}};
    ehd_status status = artefact_put_axis(file, "compressed", set->num_modes, NULL, error);
    double *row = array_new(set->num_nodes, 1, sizeof *row);

    if (!status && !row) status = ehd_no_memory(error, "compressed snapshots");
    if (!status) status = artefact_declare(file, "compressed_pressure", error);
    // one mode at a time, because modes in memory have boundary nodes and modes in the file do not
    for (size_t i = 0; i < set->num_modes && !status; i++) {
        pod_row(row, set, i);
        status = grid_put_field(file, "compressed_pressure", i, row, grid, false, error);
    }
    free(row);
    if (!status)
        status = artefact_put(file, "compressed_singular_values", set->singular_values, error);
    return status ? status : numbers_put(file, 0, numbers, error);
}

ehd_status snapshots_put_trajectories(artefact *file, const training_set *set,
                                      const trajectories *trained, ehd_error *error) {
    const int64_t none = -1;
    ehd_status status = EHD_OK;

    for (size_t i = 0; i < set->num_points && !status; i++)
        status = artefact_put_integers_part(file, "trajectory", i, 1, &none, error);
    for (size_t t = 0; t < trained->num_trajectories; t++)
        for (size_t i = 0; i < NUM_KEPT && !status; i++)
            status =
                put_kept_state(file, &set->grid, set->num_points + t * NUM_KEPT + i, (int64_t)t,
                               &trained->kept[t].states[i], trained->failed[t], error);
    if (!status) status = artefact_end_streaming(file, error);
    if (!status && trained->first.num_modes > 0)
        status = put_compressed(file, &set->grid, &trained->first, error);
    return status;
}

// ---- resuming

static ehd_status restore(training *points, size_t point, artefact *file, size_t state,
                          int64_t outcome, ehd_error *error) {
    const ehd_grid *grid = &points->set->grid;
    double *pressure = NULL, rigid_approach = 0;
    int64_t *exits = NULL;
    ehd_status status = EHD_OK;

    if (outcome != 0) return training_restore(points, point, NULL, 0, 0, error);
    pressure = malloc(grid->num_inner * sizeof *pressure);
    exits = calloc(grid->inner_lines, sizeof *exits);
    if (!pressure || !exits) status = ehd_no_memory(error, artefact_path(file));
    if (!status)
        status = artefact_get_part(file, "pressure", state, 1, pressure, grid->num_inner, error);
    if (!status)
        status = artefact_get_part(file, "rigid_approach", state, 1, &rigid_approach, 1, error);
    if (!status)
        status = artefact_get_integers_part(file, "exit_node", state, 1, exits, grid->inner_lines,
                                            error);
    for (size_t l = 0; l < grid->inner_lines && !status; l++)
        if (exits[l] < 0 || (size_t)exits[l] > grid->inner_x)
            status = ehd_fail(error, EHD_DATA, "%s: exit_node: found %lld, expected 0 to %zu",
                              artefact_path(file), (long long)exits[l], grid->inner_x);
    for (size_t i = 0; i < grid->num_inner && !status; i++)
        if (!isfinite(pressure[i]) || !isfinite(rigid_approach))
            status = ehd_fail(error, EHD_DATA, "%s: pressure: found none of point %zu, expected it",
                              artefact_path(file), point);
    // only a line contact needs the exit; on a point contact the exits follow from the pressure
    if (!status)
        status =
            training_restore(points, point, pressure, rigid_approach, (size_t)exits[0] + 1, error);
    free(exits);
    free(pressure);
    return status;
}

/* Checks whether a state has the contact of the plan. EHD_DATA: it has another contact. */
static ehd_status check_contact(artefact *file, size_t state, const ehd_contact *contact,
                                ehd_error *error) {
    const flow_thinning thinning = traction_thinning(contact);
    const struct {
        const char *name;
        double expected;
    } numbers[] = {{"moes_M", contact->moes_M},
                   {"alpha_p_H", contact->alpha_p_H},
                   {"thinning", thinning.sliding},
                   {"gradient_thinning", thinning.gradient}};

    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        double found = 0; // the column is missing if no flow is thinned
        ehd_status status =
            artefact_has(file, numbers[i].name)
                ? artefact_get_part(file, numbers[i].name, state, 1, &found, 1, error)
                : EHD_OK;
        if (status) return status;
        if (!(fabs(found - numbers[i].expected) <= 1e-12 * numbers[i].expected))
            return ehd_fail(error, EHD_DATA, "%s: %s: found %.10g of state %zu, expected %.10g",
                            artefact_path(file), numbers[i].name, found, state,
                            numbers[i].expected);
    }
    return EHD_OK;
}

ehd_status snapshots_restore(bool *whole, training *points, size_t point, artefact *file,
                             size_t state, int64_t outcome, ehd_error *error) {
    ehd_status status = outcome == 0 ? artefact_check_entry(file, state, error) : EHD_OK;

    if (!status) status = check_contact(file, state, &points->set->contacts[point], error);
    if (!status) status = restore(points, point, file, state, outcome, error);
    *whole = !status;
    return status == EHD_DATA ? EHD_OK : status;
}

static ehd_status restore_points(training *points, artefact *file, ehd_error *error) {
    const training_set *set = points->set;
    int64_t *outcomes = malloc(num_states(set) * sizeof *outcomes);
    bool whole = true; // false: the point is incomplete and is solved again
    ehd_status status = EHD_OK;

    if (!outcomes) status = ehd_no_memory(error, artefact_path(file));
    if (!status) status = artefact_get_integers(file, "status", outcomes, num_states(set), error);
    for (size_t i = 0; i < set->num_points && !status; i++) {
        if (outcomes[i] < 0) continue;
        status = snapshots_restore(&whole, points, i, file, i, outcomes[i], error);
        if (!status && !whole) status = snapshots_put_contact(file, i, &set->contacts[i], error);
    }
    free(outcomes);
    return status;
}

ehd_status snapshots_open_partial(artefact **file, const training_set *set, const program *caller,
                                  ehd_error *error) {
    const contact_kind *kind;
    ehd_error cause = {""};
    ehd_grid grid;
    ehd_status status =
        artefact_resume(file, caller->output, &schema_snapshots, caller, set->text, error);

    if (!status) status = grid_read(&grid, &kind, *file, error);
    if (!status) status = grid_check(&grid, "partial", &set->grid, "the plan", &cause);
    if (*cause.text) ehd_fail(error, status, "%s.%s", caller->output, cause.text);
    if (status) artefact_close(file);
    return status;
}

ehd_status snapshots_resume(artefact **file, training *points, const program *caller,
                            ehd_error *error) {
    const training_set *set = points->set;
    ehd_status status = snapshots_open_partial(file, set, caller, error);

    for (size_t t = 0; t < set->num_trajectories && !status; t++)
        status = inputs_check_tables(*file, &set->trajectories[t].scene, error);
    // equal settings give equal numbers of states, unless another program wrote the file
    if (!status && artefact_length(*file, "state") != num_states(set))
        status =
            ehd_fail(error, EHD_DATA,
                     "%s.partial: state: found an axis of another length, expected that of the "
                     "plan",
                     caller->output);
    if (!status) status = restore_points(points, *file, error);
    if (status) artefact_close(file);
    return status;
}
