/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "deimselect/row_plan.h"

#include "deimselect/cubature.h"
#include "deimselect/stability.h"

#include <math.h>
#include <stdlib.h>

/* Numbers and sizes from which the memory of a plan is computed. */
typedef struct row_sizes {
    double nodes, rows_in_all; // number of nodes and of inner nodes of the grid
    double snapshots, converged;
    double num_modes;     // wanted number of modes of each POD; INFINITY: as many modes as possible
    double copies;        // number of copies of a basis that the method makes
    double basis, states; // bytes of the basis and of its states
    double exits;         // bytes of the arrays for the exits of training
    double cubature;      // bytes
    size_t num_inner;
} row_sizes;

static double states_bytes(const reduced_basis *basis) {
    const reduced_states *states = &basis->states;
    const double numbers = (double)(states->num_unknowns + states->num_lines + 5);

    return (double)states->num_states *
           (8 * numbers + sizeof *states->effects + sizeof *states->rises + sizeof(bool));
}

static ehd_status exits_bytes(double *bytes, const reduced_basis *basis,
                              const row_settings *settings, ehd_error *error) {
    const bool keeps_exits =
        !settings->given && (settings->method->keeps_exits || settings->stability > 0);
    size_t num_exits = 0;
    size_t *exits = row_choice_exits(&num_exits, basis);

    if (!exits) return ehd_no_memory(error, "selection");
    free(exits);
    *bytes = 8 * (double)(basis->states.num_states * basis->grid.inner_lines) +
             row_stability_bytes(basis->num_pressure, keeps_exits ? num_exits : 0);
    return EHD_OK;
}

static ehd_status measure(row_sizes *sizes, const residual_snapshots *snapshots,
                          const reduced_basis *basis, const row_settings *settings,
                          ehd_error *error) {
    const double modes = (double)(basis->num_pressure + basis->num_deformation + 1);
    const bool doubles = !settings->given && settings->stability > 0;

    *sizes =
        (row_sizes){.nodes = (double)basis->grid.num_nodes,
                    .rows_in_all = (double)basis->grid.num_inner,
                    .snapshots = (double)snapshots->count,
                    .converged = (double)residual_snapshots_converged(snapshots),
                    .num_modes = doubles ? INFINITY : (double)row_choice_num_modes(basis, settings),
                    .copies = settings->given ? 0 : (double)settings->method->copies,
                    .basis = 8 * modes * (double)basis->grid.num_nodes,
                    .states = states_bytes(basis),
                    .cubature = cubature_bytes(basis),
                    .num_inner = basis->grid.num_inner};
    return exits_bytes(&sizes->exits, basis, settings, error);
}

/* Returns the memory of small matrices: systems of the joint greedy method that grow with the rows,
 * the modes at the rows, and their decompositions. Two rows for each mode are assumed. If a method
 * selects more rows, these matrices still take little memory compared with fields. */
static double small_bytes(double modes) {
    return 8 * 16 * modes * modes;
}

/* Returns the larger one of two numbers, bytes: the memory of the row selection with the modes of
 * residuals and products, and the memory of the selection of control rows with the modes of the
 * residuals. `control`: bytes of the residuals from which control rows are selected. */
static double bytes_of_modes(const row_sizes *sizes, double modes, double control) {
    const double a_field = 8 * sizes->rows_in_all;

    return fmax((2 + sizes->copies) * modes * a_field, modes * a_field + control) +
           small_bytes(modes) + 12 * a_field;
}

/* Returns the memory of the basis, its states, and the state index of each snapshot. */
static double bytes_of_rest(const row_sizes *sizes) {
    return sizes->basis + sizes->states + 8 * sizes->snapshots;
}

/* Returns the memory after the snapshots are freed: deflections of the modes, the states of the
 * model, and the choice of traction nodes. */
static double bytes_of_model(const row_sizes *sizes) {
    return sizes->basis + sizes->states + sizes->cubature;
}

static double bytes_at_once(const row_sizes *sizes) {
    const double a_field = 8 * sizes->rows_in_all;
    const double values = fmin(sizes->snapshots, sizes->rows_in_all);
    const double modes = fmin(sizes->num_modes, values);
    const double pod = (sizes->snapshots + 2 * modes) * a_field + 8 * 7 * values * values;
    const double select =
        bytes_of_modes(sizes, modes, 2 * sizes->converged * a_field) + sizes->exits;

    return bytes_of_rest(sizes) +
           fmax(2 * sizes->snapshots * a_field + fmax(pod, select), bytes_of_model(sizes));
}

/* Returns the largest memory of a streamed selection, bytes; the function is a pod_work_bytes.
 * Compares three stages: the second POD while the modes of the first POD are in memory, the
 * selection of rows, and the selection of control rows. */
static double bytes_of_stream(const void *work, size_t block, size_t max_rank) {
    const row_sizes *sizes = work;
    const double a_field = 8 * sizes->rows_in_all;
    const double rank = (double)max_rank, modes = fmin(sizes->num_modes, rank);
    const pod_stream_settings settings = {.block = block, .max_rank = max_rank};
    const double stream = pod_stream_bytes(sizes->num_inner, (size_t)sizes->snapshots, &settings);
    const double pod = modes * a_field + stream;
    const double select = bytes_of_modes(sizes, modes, fmax(stream, 2 * rank * a_field));

    return bytes_of_rest(sizes) + fmax(fmax(pod, select) + sizes->exits, bytes_of_model(sizes));
}

ehd_status row_plan_make(row_plan *plan, const residual_snapshots *snapshots,
                         const reduced_basis *basis, const row_settings *settings, double limit,
                         ehd_error *error) {
    row_sizes sizes;
    const ehd_status status = measure(&sizes, snapshots, basis, settings, error);

    *plan = (row_plan){.limit = limit};
    if (status) return status;
    plan->bytes = bytes_at_once(&sizes);
    plan->direct = plan->bytes <= limit;
    if (plan->direct) return EHD_OK;
    const size_t most = snapshots->count < sizes.num_inner ? snapshots->count : sizes.num_inner;
    const size_t wanted = row_choice_num_modes(basis, settings);
    const size_t least = wanted < most ? wanted : most;
    const bool enough = pod_stream_room(&plan->block, &plan->max_rank, snapshots->count, least,
                                        most, limit, bytes_of_stream, &sizes);
    plan->bytes = bytes_of_stream(&sizes, plan->block, plan->max_rank);
    if (enough) return EHD_OK;
    return ehd_fail(error, EHD_MEMORY,
                    "--memory: found %.4g MB, expected at least %.4g MB for %zu iterations on %zu "
                    "nodes and %zu modes",
                    limit * 1e-6, ceil(plan->bytes * 1e-4) * 1e-2, snapshots->count,
                    sizes.num_inner, least);
}
