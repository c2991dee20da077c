/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "deimselect/row_choice.h"

#include "deimselect/control.h"
#include "deimselect/stability.h"
#include "podbuild/pod.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

void row_choice_free(row_choice *choice) {
    arena_free(&choice->memory);
    *choice = (row_choice){0};
}

/* Returns the number of modes of each basis for a method that selects rows_per_mode rows for each
 * mode (0: any number). If rows_per_mode is above 1, the result is at least the number of
 * unknowns. */
static size_t wanted_modes(size_t rows_per_mode, size_t num_rows, size_t num_unknowns) {
    const size_t rows_a_mode = rows_per_mode > 0 ? rows_per_mode : 1;
    size_t modes = (num_rows + rows_a_mode - 1) / rows_a_mode;

    return rows_a_mode > 1 && modes < num_unknowns ? num_unknowns : modes;
}

/* Returns the number of rows of the first selection. With a wanted stability, larger selections may
 * follow. */
static size_t first_rows(const reduced_basis *basis, const row_settings *settings) {
    const size_t num_inner = basis->grid.num_inner;
    const size_t two_a_mode =
        2 * basis->num_pressure < num_inner ? 2 * basis->num_pressure : num_inner;

    if (settings->given) return settings->given->count;
    return settings->num_rows > 0 ? settings->num_rows : two_a_mode;
}

size_t row_choice_num_modes(const reduced_basis *basis, const row_settings *settings) {
    // given rows: as many modes as pivoted QR would use for them
    const size_t rows_per_mode = settings->given ? 2 : settings->method->rows_per_mode;

    return wanted_modes(rows_per_mode, first_rows(basis, settings), basis->states.num_unknowns);
}

static ehd_status build_pods(pod_basis pods[2], const residual_snapshots *snapshots,
                             size_t num_inner, size_t num_modes, ehd_error *error) {
    static const residual_kind kinds[] = {RESIDUALS, PRODUCTS};
    ehd_error cause;

    for (int i = 0; i < 2; i++) {
        ehd_status status =
            residual_snapshots_pod(&pods[i], snapshots, kinds[i], num_inner, num_modes, &cause);
        if (status)
            return ehd_fail(error, status, "snapshots of the %s: %s", residual_names[i],
                            cause.text);
    }
    return EHD_OK;
}

/* Checks whether a row, an index of an inner node, lies before an exit. */
static bool is_before_exit(const ehd_grid *grid, size_t row, const size_t *exit) {
    return row % grid->inner_x + 1 < exit[grid_first_line(grid) + row / grid->inner_x];
}

/* Computes sigma_min of both bases at the rows before an exit. *sigma_min is the smaller value. */
static ehd_status sigma_at_exit(double *sigma_min, const pod_basis pods[2],
                                const row_choice *choice, const ehd_grid *grid, const size_t *exit,
                                const size_t num_columns[2], size_t *kept, ehd_error *error) {
    size_t count = 0;

    for (size_t r = 0; r < choice->num_rows; r++)
        if (is_before_exit(grid, choice->rows[r], exit)) kept[count++] = choice->rows[r];
    *sigma_min = INFINITY;
    for (int i = 0; i < 2; i++) {
        double sigma;
        ehd_status status = selection_sigma_min(&sigma, pods[i].modes, num_columns[i],
                                                pods[i].num_nodes, kept, count, error);
        if (status) return status;
        *sigma_min = fmin(*sigma_min, sigma);
    }
    return EHD_OK;
}

/* Fills sigma_min_by_exit. States with equal exits share one evaluation. */
static ehd_status measure_exits(row_choice *choice, const pod_basis pods[2],
                                const reduced_basis *basis, const size_t num_columns[2],
                                ehd_error *error) {
    const reduced_states *states = &basis->states;
    const size_t bytes = states->num_lines * sizeof *states->exit;
    size_t *kept = malloc(choice->num_rows * sizeof *kept);
    ehd_status status = EHD_OK;

    choice->sigma_min_by_exit = arena_array(&choice->memory, states->num_states, sizeof(double));
    if (!kept || !choice->sigma_min_by_exit) status = ehd_no_memory(error, "selection");
    choice->sigma_min_over_exits = INFINITY;
    for (size_t s = 0; s < states->num_states && !status; s++) {
        const size_t *exit = states->exit + s * states->num_lines;
        size_t same = 0; // first state with this exit
        while (same < s && memcmp(states->exit + same * states->num_lines, exit, bytes))
            same++;
        if (same < s)
            choice->sigma_min_by_exit[s] = choice->sigma_min_by_exit[same];
        else
            status = sigma_at_exit(&choice->sigma_min_by_exit[s], pods, choice, &basis->grid, exit,
                                   num_columns, kept, error);
        choice->sigma_min_over_exits =
            fmin(choice->sigma_min_over_exits, choice->sigma_min_by_exit[s]);
    }
    free(kept);
    return status;
}

/* Measures the singular values and the stability. Uses as many leading modes as there are pressure
 * modes, so that methods and numbers of rows can be compared. */
static ehd_status measure(row_choice *choice, const pod_basis pods[2], const reduced_basis *basis,
                          const selection_bases *bases, ehd_error *error) {
    const selection_bases leading = selection_leading(bases);
    double *const sigmas[] = {&choice->sigma_min_residual, &choice->sigma_min_jacobian};
    ehd_status status = EHD_OK;

    for (int i = 0; i < 2 && !status; i++)
        status = selection_sigma_min(sigmas[i], pods[i].modes, leading.num_modes[i],
                                     pods[i].num_nodes, choice->rows, choice->num_rows, error);
    if (!status) status = measure_exits(choice, pods, basis, leading.num_modes, error);
    if (!status)
        status = row_stability_of(&choice->stability, bases, choice->rows, choice->num_rows, error);
    return status;
}

/* Limits the number of rows to what the modes of the snapshots support. Fails if a larger number
 * was given, or if fewer rows than pressure modes remain. */
static ehd_status limit_rows(size_t *num_rows, const pod_basis pods[2], size_t num_pressure,
                             const selection_method *method, bool given, ehd_error *error) {
    int poorer = pods[1].num_modes < pods[0].num_modes;
    size_t max_rows = method->rows_per_mode * pods[poorer].num_modes;

    if (method->rows_per_mode == 0 || *num_rows <= max_rows) return EHD_OK;
    if (given)
        return ehd_fail(error, EHD_DATA,
                        "--rows: found %zu, expected at most %zu, as many as the snapshots of the "
                        "%s tell apart",
                        *num_rows, max_rows, residual_names[poorer]);
    if (max_rows < num_pressure)
        return ehd_fail(error, EHD_DATA,
                        "%s: found enough for %zu rows, expected %zu, one for each pressure mode. "
                        "Points and histories that snapgen --basis does not solve leave none. "
                        "Train on more of them, or take fewer modes (podbuild --energy or "
                        "--pressure-modes)",
                        residual_names[poorer], max_rows, num_pressure);
    *num_rows = max_rows;
    return EHD_OK;
}

static ehd_status check_rows(size_t num_rows, const reduced_basis *basis, ehd_error *error) {
    ehd_status status = reduced_check_num_rows(num_rows, basis->num_pressure,
                                               basis->num_deformation, "--rows", error);

    if (status) return status;
    if (num_rows > basis->grid.num_inner)
        return ehd_fail(error, EHD_DATA, "--rows: found %zu, expected at most the %zu nodes",
                        num_rows, basis->grid.num_inner);
    return EHD_OK;
}

/* Compares exits by the first line on which they differ. */
static int compare_exits(const void *a, const void *b, void *context) {
    const size_t *x = a, *y = b, *num_lines = context;
    size_t l = 0;

    while (l + 1 < *num_lines && x[l] == y[l])
        l++;
    return (x[l] > y[l]) - (x[l] < y[l]);
}

size_t *row_choice_exits(size_t *num_exits, const reduced_basis *basis) {
    const reduced_states *states = &basis->states;
    const ehd_grid *grid = &basis->grid;
    size_t num_lines = grid->inner_lines, bytes = num_lines * sizeof(size_t);
    size_t *exits = malloc((states->num_states + 1) * bytes);

    *num_exits = 0;
    if (!exits) return NULL;
    for (size_t s = 0; s < states->num_states; s++)
        for (size_t l = 0; l < num_lines; l++)
            exits[s * num_lines + l] =
                states->exit[s * states->num_lines + grid_first_line(grid) + l] - 1;
    qsort_r(exits, states->num_states, bytes, compare_exits, &num_lines);
    for (size_t s = 0; s < states->num_states; s++) {
        const size_t *here = exits + s * num_lines;
        if (s > 0 && memcmp(here, exits + (*num_exits - 1) * num_lines, bytes) == 0) continue;
        memmove(exits + (*num_exits)++ * num_lines, here, bytes);
    }
    return exits;
}

/* Collects the input of a selection method. `exits`: result of row_choice_exits. */
static selection_bases make_bases(const pod_basis pods[2], const reduced_basis *basis,
                                  const size_t *exits, size_t num_exits) {
    const selection_bases bases = {
        .num_nodes = pods[0].num_nodes,
        .num_modes = {pods[0].num_modes, pods[1].num_modes},
        .modes = {pods[0].modes, pods[1].modes},
        .singular_values = {pods[0].singular_values, pods[1].singular_values},
        .num_leading = basis->num_pressure,
        .num_lines = basis->grid.inner_lines,
        .num_exits = num_exits,
        .exits = exits};

    return bases;
}

static ehd_status allocate_rows(row_choice *choice, size_t num_rows, ehd_error *error) {
    choice->num_rows = num_rows;
    choice->rows = arena_array(&choice->memory, num_rows, sizeof *choice->rows);
    return choice->rows ? EHD_OK : ehd_no_memory(error, "selection");
}

/* Computes the PODs and copies the given rows. The PODs have as many modes as pivoted QR uses for
 * this number of rows, and at least as many as the weights need, one for each unknown. If the rows
 * of --rows-from were selected by pivoted QR, the model is therefore bit-identical to the model of
 * --method qr. */
static ehd_status use_given_rows(row_choice *choice, pod_basis pods[2], selection_bases *bases,
                                 const residual_snapshots *snapshots, const reduced_basis *basis,
                                 const given_rows *given, ehd_error *error) {
    const size_t num_modes = wanted_modes(2, given->count, basis->states.num_unknowns);
    ehd_status status = build_pods(pods, snapshots, basis->grid.num_inner, num_modes, error);

    if (status) return status;
    *bases = make_bases(pods, basis, bases->exits, bases->num_exits);
    status = allocate_rows(choice, given->count, error);
    if (!status) memcpy(choice->rows, given->rows, given->count * sizeof *choice->rows);
    return status;
}

/* Computes the PODs with as many modes as the method needs for the rows, and selects the rows. */
static ehd_status select_rows(row_choice *choice, pod_basis pods[2], selection_bases *bases,
                              const residual_snapshots *snapshots, const reduced_basis *basis,
                              const row_settings *settings, size_t num_rows, ehd_error *error) {
    const size_t num_unknowns = basis->states.num_unknowns;
    ehd_status status = check_rows(num_rows, basis, error);

    if (!status)
        status = build_pods(pods, snapshots, basis->grid.num_inner,
                            wanted_modes(settings->method->rows_per_mode, num_rows, num_unknowns),
                            error);
    if (!status)
        status = limit_rows(&num_rows, pods, basis->num_pressure, settings->method,
                            settings->num_rows > 0, error);
    if (status) return status;
    *bases = make_bases(pods, basis, bases->exits, bases->num_exits);
    status = allocate_rows(choice, num_rows, error);
    return status ? status : settings->method->select(choice->rows, bases, num_rows, error);
}

static ehd_status refuse_stability(const row_choice *choice, const selection_bases *bases,
                                   const row_settings *settings, ehd_error *error) {
    double reached;
    ehd_status status = row_stability_of(&reached, bases, choice->rows, choice->num_rows, error);

    return status
               ? status
               : ehd_fail(error, EHD_DATA,
                          "--stability: found %.4g at best, with %zu rows by method %s, "
                          "expected at most %g",
                          reached, choice->num_rows, settings->method->name, settings->stability);
}

/* Doubles the number of rows until the rows reach the wanted stability. Then keeps only the first
 * rows of the selection: as few as reach the stability, but at least as many as pressure modes. */
static ehd_status select_stable_rows(row_choice *choice, pod_basis pods[2], selection_bases *bases,
                                     const residual_snapshots *snapshots,
                                     const reduced_basis *basis, const row_settings *settings,
                                     size_t num_rows, ehd_error *error) {
    const size_t num_inner = basis->grid.num_inner;
    size_t fewest = 0;

    for (;;) {
        ehd_status status =
            select_rows(choice, pods, bases, snapshots, basis, settings, num_rows, error);
        if (!status)
            status = row_stability_fewest(&fewest, bases, choice->rows, choice->num_rows,
                                          settings->stability, error);
        if (status) return status;
        if (fewest <= choice->num_rows) break;
        if (choice->num_rows < num_rows || num_rows == num_inner)
            return refuse_stability(choice, bases, settings, error);
        num_rows = 2 * num_rows < num_inner ? 2 * num_rows : num_inner;
        row_choice_free(choice);
        pod_free(&pods[0]);
        pod_free(&pods[1]);
    }
    choice->num_rows = fewest > basis->num_pressure ? fewest : basis->num_pressure;
    return EHD_OK;
}

static ehd_status use_given_factors(row_choice *choice, const given_rows *given, ehd_error *error) {
    choice->factors = arena_array(&choice->memory, given->count, sizeof *choice->factors);
    if (!choice->factors) return ehd_no_memory(error, "selection");
    memcpy(choice->factors, given->factors, given->count * sizeof *choice->factors);
    return EHD_OK;
}

/* Samples the leading modes of the Jacobian products at the rows and computes the factors of the
 * row weights. */
static ehd_status weigh_rows(row_choice *choice, const pod_basis *products, size_t num_unknowns,
                             const weighting *weights, ehd_error *error) {
    size_t num_rows = choice->num_rows;
    size_t num_modes = num_unknowns < products->num_modes ? num_unknowns : products->num_modes;

    choice->num_jacobian_modes = num_modes;
    choice->jacobian_modes = arena_table(&choice->memory, num_rows, num_modes, sizeof(double));
    choice->factors = arena_array(&choice->memory, num_rows, sizeof(double));
    if (choice->memory.failed) return ehd_no_memory(error, "selection");
    for (size_t r = 0; r < num_rows; r++)
        for (size_t j = 0; j < num_modes; j++)
            choice->jacobian_modes[r * num_modes + j] =
                products->modes[j * products->num_nodes + choice->rows[r]];
    return weights->weigh(choice->factors, choice->jacobian_modes, num_rows, num_modes, error);
}

static ehd_status choose_control(row_choice *choice, const residual_snapshots *snapshots,
                                 const pod_basis *residuals, size_t num_unknowns, size_t wanted,
                                 ehd_error *error) {
    const size_t tenth = choice->num_rows / 10;
    bool given = wanted != CONTROL_BY_ITSELF;
    size_t num_modes = num_unknowns < residuals->num_modes ? num_unknowns : residuals->num_modes;
    if (num_modes > choice->num_rows) num_modes = choice->num_rows;

    choice->num_control = given ? wanted : tenth > 8 ? tenth : 8;
    choice->control = arena_array(&choice->memory, choice->num_control, sizeof *choice->control);
    if (!choice->control) return ehd_no_memory(error, "selection");
    return control_choose(choice->control, &choice->num_control, given, snapshots,
                          residuals->num_nodes, residuals->modes, num_modes, choice->rows,
                          choice->num_rows, error);
}

ehd_status row_choice_make(row_choice *choice, const residual_snapshots *snapshots,
                           const reduced_basis *basis, const row_settings *settings,
                           ehd_error *error) {
    const size_t num_unknowns = basis->states.num_unknowns;
    const size_t num_rows = first_rows(basis, settings);
    pod_basis pods[2] = {{0}, {0}};
    selection_bases bases = {0};
    size_t *exits = row_choice_exits(&bases.num_exits, basis);
    ehd_status status = EHD_OK;

    *choice = (row_choice){0};
    bases.exits = exits;
    if (!exits) status = ehd_no_memory(error, "selection");
    if (!status && settings->given)
        status = use_given_rows(choice, pods, &bases, snapshots, basis, settings->given, error);
    else if (!status && settings->stability > 0)
        status =
            select_stable_rows(choice, pods, &bases, snapshots, basis, settings, num_rows, error);
    else if (!status)
        status = select_rows(choice, pods, &bases, snapshots, basis, settings, num_rows, error);
    if (!status && settings->given && settings->given->factors)
        status = use_given_factors(choice, settings->given, error);
    else if (!status)
        status = weigh_rows(choice, &pods[1], num_unknowns, settings->weights, error);
    if (!status) status = measure(choice, pods, basis, &bases, error);
    pod_free(&pods[1]); // free memory before the control rows are selected
    if (!status)
        status =
            choose_control(choice, snapshots, &pods[0], num_unknowns, settings->num_control, error);
    for (size_t r = 0; r < choice->num_rows && !status; r++)
        choice->rows[r] = grid_node_of_row(&basis->grid, choice->rows[r]);
    for (size_t r = 0; r < choice->num_control && !status; r++)
        choice->control[r] = grid_node_of_row(&basis->grid, choice->control[r]);
    free(exits);
    pod_free(&pods[0]);
    if (status) row_choice_free(choice);
    return status;
}

ehd_status row_choice_model(reduced_model *model, const row_choice *choice,
                            const reduced_basis *basis, ehd_error *error) {
    ehd_status status = reduced_model_build(model, basis, choice->rows, choice->num_rows, error);

    for (size_t r = 0; r < choice->num_rows && !status; r++)
        model->rows.weight[r] *= choice->factors[r];
    if (!status && choice->num_control > 0)
        status =
            reduced_model_add_control(model, basis, choice->control, choice->num_control, error);
    return status;
}
