/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/model/basis_file.h"

#include "common/output/columns.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

// ---- grid

ehd_status film_axes_write(artefact *file, const ehd_grid *grid, ehd_error *error) {
    size_t width = grid_width(grid), num_lines = grid_lines(grid);
    double *x = malloc(width * sizeof *x), *y = malloc(num_lines * sizeof *y);
    ehd_status status = x && y ? EHD_OK : ehd_no_memory(error, artefact_path(file));

    for (size_t k = 0; k < width && !status; k++)
        x[k] = grid_x(grid, k);
    for (size_t l = 0; l < num_lines && !status; l++)
        y[l] = grid_y(grid, l * width);
    if (!status) status = artefact_put_axis(file, "film_x", width, x, error);
    if (!status && num_lines > 1) status = artefact_put_axis(file, "film_y", num_lines, y, error);
    free(y);
    free(x);
    return status;
}

ehd_status deformation_read(deformation_kind *kind, artefact *file, ehd_error *error) {
    return name_read(kind, file, "deformation", deformation_names, "independent|coupled", error);
}

// ---- modes

static size_t node_of(const ehd_grid *grid, size_t k, bool inner) {
    return inner ? grid_node_of_row(grid, k) : k;
}

ehd_status modes_write(artefact *file, const char *field, const double *modes, const ehd_grid *grid,
                       size_t num_modes, bool inner, ehd_error *error) {
    size_t length = inner ? grid->num_inner : grid->num_nodes;
    double *transposed = malloc(length * num_modes * sizeof *transposed);
    if (!transposed) return ehd_no_memory(error, artefact_path(file));
    for (size_t j = 0; j < num_modes; j++)
        for (size_t k = 0; k < length; k++)
            transposed[j * length + k] = modes[node_of(grid, k, inner) * num_modes + j];
    ehd_status status = artefact_put(file, field, transposed, error);
    free(transposed);
    return status;
}

ehd_status modes_read(double **modes, artefact *file, const char *field, const ehd_grid *grid,
                      size_t num_modes, bool inner, ehd_error *error) {
    size_t length = inner ? grid->num_inner : grid->num_nodes;
    double *transposed = array_new(length, num_modes, sizeof *transposed);
    *modes = array_new(grid->num_nodes, num_modes, sizeof(double));
    ehd_status status = transposed && *modes ? EHD_OK : ehd_no_memory(error, artefact_path(file));

    if (!status) status = artefact_get(file, field, transposed, length * num_modes, error);
    for (size_t j = 0; j < num_modes && !status; j++)
        for (size_t k = 0; k < length; k++)
            (*modes)[node_of(grid, k, inner) * num_modes + j] = transposed[j * length + k];
    free(transposed);
    return status;
}

// ---- states

enum { NUM_COORDINATES = 3 };

/* Lists the columns of a state's coordinates. */
static void list_coordinates(column columns[NUM_COORDINATES + 1], size_t num_pressure,
                             size_t num_deformation) {
    const size_t number = sizeof(double), width = num_pressure + num_deformation;

    *columns++ = (column){.field = "state_pressure", .each = num_pressure, .apart = number};
    if (num_deformation > 0)
        *columns++ = (column){.field = "state_deformation",
                              .offset = num_pressure * number,
                              .each = num_deformation,
                              .apart = number};
    *columns++ = (column){.field = "state_rigid_approach", .offset = width * number, .each = 1};
    *columns = (column){0};
}

/* If the training has trajectories, writes the rates of change and which states are stationary. */
static ehd_status put_trajectory_marks(artefact *file, const reduced_states *states, int64_t *work,
                                       ehd_error *error) {
    bool all_stationary = true;

    for (size_t s = 0; s < states->num_states; s++) {
        work[s] = states->stationary[s] ? 1 : 0;
        all_stationary = all_stationary && states->stationary[s];
    }
    if (all_stationary) return EHD_OK;
    ehd_status status = artefact_put_integers(file, "state_stationary", work, error);
    if (!status) status = artefact_put(file, "state_rate", states->rate, error);
    return status ? status : artefact_put(file, "state_load_rate", states->load_rate, error);
}

static ehd_status get_trajectory_marks(reduced_states *states, artefact *file, int64_t *work,
                                       ehd_error *error) {
    ehd_status status = EHD_OK;

    if (artefact_has(file, "state_stationary"))
        status = artefact_get_integers(file, "state_stationary", work, states->num_states, error);
    for (size_t s = 0; s < states->num_states && !status; s++)
        if (artefact_has(file, "state_stationary")) states->stationary[s] = work[s] != 0;
    if (!status && artefact_has(file, "state_rate"))
        status = artefact_get(file, "state_rate", states->rate, states->num_states, error);
    if (status) return status;
    if (artefact_has(file, "state_load_rate"))
        return artefact_get(file, "state_load_rate", states->load_rate, states->num_states, error);
    memcpy(states->load_rate, states->rate, states->num_states * sizeof *states->rate);
    return EHD_OK;
}

/* Numbers of the states that may be unknown or zero. A file has the dataset only if some number is
 * above `none`. */
typedef struct optional_column {
    column of;
    double none;
    double *first; // number of the first state
    size_t size;   // bytes from one state to the next
} optional_column;

enum { NUM_OPTIONAL = 2 + NUM_EFFECTS + NUM_RISES };

static optional_column optional(const char *field, double none, double *first, size_t size) {
    return (optional_column){{.field = field, .each = 1}, none, first, size};
}

/* Lists the thinning of the states' flows, the estimated errors due to the grid, and the rises of
 * viscosity and density. */
static void list_optional(optional_column list[NUM_OPTIONAL], const reduced_states *states) {
    flow_thinning *thinning = states->thinning;

    *list++ = optional("state_thinning", 0, &thinning->sliding, sizeof *thinning);
    *list++ = optional("state_gradient_thinning", 0, &thinning->gradient, sizeof *thinning);
    for (int e = 0; e < NUM_EFFECTS; e++)
        *list++ = optional(film_effect_state_names[e], -INFINITY, &states->effects->of[e],
                           sizeof *states->effects);
    for (int r = 0; r < NUM_RISES; r++)
        *list++ = optional(lubricant_rise_state_names[r], -INFINITY, &states->rises->of[r],
                           sizeof *states->rises);
}

static bool is_known(const optional_column *self, size_t num_states) {
    const size_t stride = self->size / sizeof(double);
    bool known = false;

    for (size_t s = 0; s < num_states; s++)
        known = known || isgreater(self->first[s * stride], self->none);
    return known;
}

static ehd_status put_optional(artefact *file, const reduced_states *states, ehd_error *error) {
    const size_t num_states = states->num_states;
    optional_column list[NUM_OPTIONAL];
    ehd_status status = EHD_OK;

    list_optional(list, states);
    for (const optional_column *c = list; c < list + NUM_OPTIONAL && !status; c++)
        if (is_known(c, num_states))
            status = column_put(file, &c->of, 0, c->first, c->size, num_states, error);
    return status;
}

static ehd_status get_optional(reduced_states *states, artefact *file, ehd_error *error) {
    optional_column list[NUM_OPTIONAL];
    ehd_status status = EHD_OK;

    list_optional(list, states);
    for (const optional_column *c = list; c < list + NUM_OPTIONAL && !status; c++)
        if (artefact_has(file, c->of.field))
            status = column_get(c->first, c->size, states->num_states, &c->of, file, error);
    return status;
}

/* Returns the index in states->exit of the file's i-th exit. states->exit has entries for boundary
 * lines, which the file omits. */
static size_t exit_index(const ehd_grid *grid, const reduced_states *states, size_t i) {
    return i / grid->inner_lines * states->num_lines + grid_first_line(grid) +
           i % grid->inner_lines;
}

ehd_status states_write(artefact *file, const reduced_states *states, size_t num_pressure,
                        size_t num_deformation, const ehd_grid *grid, ehd_error *error) {
    column columns[NUM_COORDINATES + 1];
    size_t num_exits = states->num_states * grid->inner_lines;
    int64_t *exits = malloc((num_exits + 1) * sizeof *exits);
    ehd_status status = exits ? EHD_OK : ehd_no_memory(error, artefact_path(file));

    list_coordinates(columns, num_pressure, num_deformation);
    if (!status)
        status = columns_put(file, columns, 0, states->coordinates,
                             states->num_unknowns * sizeof(double), states->num_states, error);
    for (size_t i = 0; i < num_exits && !status; i++)
        exits[i] = (int64_t)states->exit[exit_index(grid, states, i)] - 1; // x[0] is at column 1
    if (!status) status = artefact_put_integers(file, "state_exit_node", exits, error);
    if (!status) status = artefact_put(file, "state_moes_M", states->moes_M, error);
    if (!status) status = artefact_put(file, "state_alpha_p_H", states->alpha_p_H, error);
    if (!status)
        status = artefact_put(file, "state_central_film_thickness", states->central_film_thickness,
                              error);
    if (!status) status = put_trajectory_marks(file, states, exits, error);
    if (!status) status = put_optional(file, states, error);
    free(exits);
    return status;
}

ehd_status states_read(reduced_states *states, artefact *file, size_t num_pressure,
                       size_t num_deformation, const ehd_grid *grid, ehd_error *error) {
    column columns[NUM_COORDINATES + 1];
    // the exit of a line contact lies behind the centre, and the stencil of a row fits between
    // centre and exit
    bool on_line = grid->inner_lines == 1;
    int64_t min_exit =
        on_line ? (int64_t)(-grid->x_min / grid->step) + 1 + (int64_t)reynolds_reach_back(grid) : 0;
    size_t num_states = artefact_length(file, "state");
    size_t num_unknowns = reduced_num_unknowns(num_pressure, num_deformation);
    size_t num_exits = num_states * grid->inner_lines;
    int64_t *exits = array_new(num_states, grid->inner_lines, sizeof *exits);
    ehd_status status = exits ? EHD_OK : ehd_no_memory(error, artefact_path(file));

    if (!status)
        status = reduced_states_init(states, num_states, grid_lines(grid), num_unknowns, error);
    list_coordinates(columns, num_pressure, num_deformation);
    if (!status)
        status = columns_get(states->coordinates, num_unknowns * sizeof(double), num_states,
                             columns, file, error);
    if (!status) status = artefact_get_integers(file, "state_exit_node", exits, num_exits, error);
    for (size_t i = 0; i < num_states * grid_lines(grid) && !status; i++)
        states->exit[i] = 1; // boundary lines have no pressure
    for (size_t i = 0; i < num_exits && !status; i++) {
        if (exits[i] < min_exit || exits[i] > (int64_t)grid->inner_x)
            status = ehd_fail(
                error, EHD_DATA, "%s: state_exit_node: found %lld, expected %lld to %zu",
                artefact_path(file), (long long)exits[i], (long long)min_exit, grid->inner_x);
        else
            states->exit[exit_index(grid, states, i)] = (size_t)exits[i] + 1;
    }
    if (!status) status = artefact_get(file, "state_moes_M", states->moes_M, num_states, error);
    if (!status)
        status = artefact_get(file, "state_alpha_p_H", states->alpha_p_H, num_states, error);
    if (!status && artefact_has(file, "state_central_film_thickness"))
        status = artefact_get(file, "state_central_film_thickness", states->central_film_thickness,
                              num_states, error);
    else
        for (size_t i = 0; i < num_states && !status; i++)
            states->central_film_thickness[i] = NAN; // other programs may omit the dataset
    if (!status) status = get_trajectory_marks(states, file, exits, error);
    if (!status) status = get_optional(states, file, error);
    free(exits);
    return status;
}

// ---- the whole file

static ehd_status put_origin(artefact *file, const basis_origin *origin, ehd_error *error) {
    ehd_status status = artefact_put_axis(file, "pressure_singular_value",
                                          origin->num_pressure_values, NULL, error);

    if (!status)
        status =
            artefact_put(file, "pressure_singular_values", origin->pressure_singular_values, error);
    if (!status)
        status = artefact_put_real(file, "pressure_energy_discarded",
                                   origin->pressure_energy_discarded, error);
    if (status || !origin->deformation_singular_values) return status;
    status = artefact_put_axis(file, "deformation_singular_value", origin->num_deformation_values,
                               NULL, error);
    if (!status)
        status = artefact_put(file, "deformation_singular_values",
                              origin->deformation_singular_values, error);
    if (!status)
        status = artefact_put_real(file, "deformation_energy_discarded",
                                   origin->deformation_energy_discarded, error);
    return status;
}

ehd_status basis_write(const reduced_basis *basis, const basis_origin *origin,
                       const program *caller, const char *settings_text, const char *const *inputs,
                       ehd_error *error) {
    artefact *file = NULL;
    ehd_status status =
        artefact_create(&file, caller->output, &schema_basis, caller, settings_text, inputs, error);

    if (!status) status = grid_write(file, basis->kind, &basis->grid, error);
    if (!status) status = carriage_write(file, &basis->carriage, error);
    if (!status)
        status = artefact_put_axis(file, "pressure_mode", basis->num_pressure, NULL, error);
    if (!status) status = artefact_put_axis(file, "state", basis->states.num_states, NULL, error);
    if (!status)
        status =
            artefact_put_text(file, "deformation", deformation_names[basis->deformation], error);
    if (!status)
        status = modes_write(file, "pressure_basis", basis->pressure, &basis->grid,
                             basis->num_pressure, true, error);
    if (!status && basis->num_deformation > 0) {
        status = film_axes_write(file, &basis->grid, error);
        if (!status)
            status =
                artefact_put_axis(file, "deformation_mode", basis->num_deformation, NULL, error);
        if (!status)
            status = modes_write(file, "deformation_basis", basis->deformation_modes, &basis->grid,
                                 basis->num_deformation, false, error);
    }
    if (!status) status = modes_write(file, "weight", basis->weight, &basis->grid, 1, true, error);
    if (!status)
        status = states_write(file, &basis->states, basis->num_pressure, basis->num_deformation,
                              &basis->grid, error);
    if (!status) status = put_origin(file, origin, error);
    if (!status) status = artefact_finish(&file, error);
    artefact_close(&file);
    return status;
}

static ehd_status read_open_basis(reduced_basis *basis, artefact *file, ehd_error *error) {
    ehd_status status = grid_read(&basis->grid, &basis->kind, file, error);

    if (!status) status = carriage_read(&basis->carriage, file, error);
    if (!status) status = deformation_read(&basis->deformation, file, error);
    if (status) return status;
    basis->num_pressure = artefact_length(file, "pressure_mode");
    if (basis->deformation == DEFORMATION_INDEPENDENT) {
        if (!artefact_has(file, "deformation_basis"))
            return ehd_fail(error, EHD_DATA,
                            "%s: found no dataset deformation_basis, expected it for an "
                            "independent basis",
                            artefact_path(file));
        basis->num_deformation = artefact_length(file, "deformation_mode");
        status = modes_read(&basis->deformation_modes, file, "deformation_basis", &basis->grid,
                            basis->num_deformation, false, error);
    }
    if (!status)
        status = modes_read(&basis->pressure, file, "pressure_basis", &basis->grid,
                            basis->num_pressure, true, error);
    if (!status) status = modes_read(&basis->weight, file, "weight", &basis->grid, 1, true, error);
    if (!status)
        status = states_read(&basis->states, file, basis->num_pressure, basis->num_deformation,
                             &basis->grid, error);
    return status;
}

ehd_status basis_read(reduced_basis *basis, char identity[65], const char *path, ehd_error *error) {
    const artefact_schema *const kinds[] = {&schema_basis, NULL};
    artefact *file = NULL;
    ehd_status status = artefact_open(&file, path, kinds, error);

    memset(basis, 0, sizeof *basis);
    if (!status) status = artefact_identity(file, identity, error);
    if (!status) status = read_open_basis(basis, file, error);
    artefact_close(&file);
    if (status) reduced_basis_free(basis);
    return status;
}
