/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "deimselect/residual_snapshots.h"

#include "common/program/arena.h"

#include <cblas.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

const char *const residual_names[] = {"residuals", "Jacobian products"};

static const char *const field_names[] = {"weighted_residual", "weighted_jacobian_step"};

/* Fractions of the energy that streams of residuals or Jacobian products may omit. local_energy is
 * the fraction that compressed trajectories omit (snapgen/trajectory.c). dropped_energy is for
 * directions that are dropped when the memory is full. Modes below these limits would select rows
 * by round-off. */
static const pod_stream_settings of_sets = {.local_energy = 1e-22, .dropped_energy = 1e-16};

/* Fractions of the energy that streams of residuals of unit norm may omit. Only the largest entries
 * of the residuals matter for the control rows. */
static const pod_stream_settings of_units = {.local_energy = 1e-12, .dropped_energy = 1e-8};

ehd_status residual_snapshots_init(residual_snapshots *snapshots, size_t count,
                                   const residual_reader *reader, ehd_error *error) {
    *snapshots = (residual_snapshots){.count = count, .reader = reader};
    snapshots->state = array_new(count, 1, sizeof *snapshots->state);
    return snapshots->state ? EHD_OK : ehd_no_memory(error, "residuals");
}

/* Enlarges an array to `count` rows and keeps its old rows. */
static bool make_longer(double **rows, size_t count, size_t num_inner) {
    double *longer = array_resize(*rows, count, num_inner, sizeof **rows);

    if (longer) *rows = longer;
    return longer;
}

ehd_status residual_snapshots_append(residual_snapshots *snapshots, const double *residuals,
                                     const double *steps, size_t count, int64_t state,
                                     size_t num_inner, ehd_error *error) {
    const size_t before = snapshots->count, after = before + count;
    int64_t *states = array_resize(snapshots->state, after, 1, sizeof *states);

    if (states) snapshots->state = states;
    if (!states || !make_longer(&snapshots->residuals, after, num_inner) ||
        !make_longer(&snapshots->steps, after, num_inner))
        return ehd_no_memory(error, "residuals");
    if (count == 0) return EHD_OK;
    memcpy(snapshots->residuals + before * num_inner, residuals,
           count * num_inner * sizeof *residuals);
    memcpy(snapshots->steps + before * num_inner, steps, count * num_inner * sizeof *steps);
    for (size_t i = before; i < after; i++)
        snapshots->state[i] = state;
    snapshots->count = after;
    return EHD_OK;
}

ehd_status residual_snapshots_hold(residual_snapshots *snapshots, size_t num_inner,
                                   ehd_error *error) {
    snapshots->reader = NULL;
    snapshots->residuals = array_new(snapshots->count, num_inner, sizeof(double));
    snapshots->steps = array_new(snapshots->count, num_inner, sizeof(double));
    if (snapshots->residuals && snapshots->steps) return EHD_OK;
    const ehd_status status = ehd_no_memory(error, "residuals");
    residual_snapshots_free(snapshots);
    return status;
}

void residual_snapshots_free(residual_snapshots *snapshots) {
    free(snapshots->residuals);
    free(snapshots->steps);
    free(snapshots->state);
    *snapshots = (residual_snapshots){0};
}

/* Checks whether an iteration is the last one of a stationary state. The residual in this iteration
 * is the residual of the converged reduced solution. */
static bool is_last(const residual_snapshots *snapshots, size_t i) {
    return snapshots->state[i] >= 0 &&
           (i + 1 == snapshots->count || snapshots->state[i + 1] != snapshots->state[i]);
}

size_t residual_snapshots_converged(const residual_snapshots *snapshots) {
    size_t count = 0;

    for (size_t i = 0; i < snapshots->count; i++)
        count += is_last(snapshots, i);
    return count;
}

static void make_unit(double *residual, size_t num_inner) {
    const double norm = cblas_dnrm2((int)num_inner, residual, 1);

    if (norm > 0) cblas_dscal((int)num_inner, 1 / norm, residual, 1);
}

// ---- streams

/* Passes all snapshots of one kind to a stream. If `units` is true, passes only the converged
 * residuals, scaled to unit norm. */
static ehd_status stream_all(pod_stream *stream, const residual_snapshots *snapshots,
                             residual_kind kind, bool units, size_t num_inner, double *field,
                             ehd_error *error) {
    const residual_reader *reader = snapshots->reader;
    ehd_status status = EHD_OK;
    progress shown;

    if (reader->caller) progress_start(&shown, reader->caller, snapshots->count);
    for (size_t i = 0; i < snapshots->count && !status; i++) {
        if (!units || is_last(snapshots, i)) {
            status =
                artefact_get_part(reader->file, field_names[kind], i, 1, field, num_inner, error);
            if (!status && units) make_unit(field, num_inner);
            if (!status) status = pod_stream_add(stream, field, 1, error);
        }
        if (!status && program_interrupted())
            status = ehd_fail(error, EHD_INTERRUPTED, "%s: interrupted", residual_names[kind]);
        if (reader->caller) progress_show(&shown, i + 1, residual_names[kind]);
    }
    if (reader->caller) progress_finish(&shown);
    return status;
}

static ehd_status streamed_pod(pod_basis *pod, const residual_snapshots *snapshots,
                               residual_kind kind, bool units, size_t num_inner, size_t num_modes,
                               ehd_error *error) {
    const pod_settings wanted = {.num_modes = num_modes, .at_most = true};
    pod_stream_settings settings = units ? of_units : of_sets;
    double *field = array_new(num_inner, 1, sizeof *field);
    pod_stream *stream = NULL;

    settings.block = snapshots->reader->block;
    settings.max_rank = snapshots->reader->max_rank;
    ehd_status status = field ? pod_stream_create(&stream, num_inner, &settings, error)
                              : ehd_no_memory(error, "residuals");
    if (!status) status = stream_all(stream, snapshots, kind, units, num_inner, field, error);
    if (!status) status = pod_stream_finish(pod, stream, &wanted, error);
    pod_stream_free(stream);
    free(field);
    return status;
}

ehd_status residual_snapshots_pod(pod_basis *pod, const residual_snapshots *snapshots,
                                  residual_kind kind, size_t num_inner, size_t num_modes,
                                  ehd_error *error) {
    const pod_settings settings = {.num_modes = num_modes, .at_most = true};

    if (snapshots->reader)
        return streamed_pod(pod, snapshots, kind, false, num_inner, num_modes, error);
    const double *fields = kind == RESIDUALS ? snapshots->residuals : snapshots->steps;
    return pod_build(pod, fields, snapshots->count, num_inner, &settings, error);
}

// ---- converged residuals

/* Returns the matrix S V', where X = U S V' is the SVD of the matrix X whose rows are the converged
 * residuals of unit norm. The columns of S V' have the same Gram matrix as the columns of X. */
static ehd_status stream_units(double **rows, size_t *num_rows, const residual_snapshots *snapshots,
                               size_t num_inner, ehd_error *error) {
    pod_basis pod = {0};
    const ehd_status status =
        streamed_pod(&pod, snapshots, RESIDUALS, true, num_inner, num_inner, error);

    if (status) return status;
    for (size_t k = 0; k < pod.num_modes; k++)
        pod_row(pod.modes + k * num_inner, &pod, k);
    *rows = pod.modes;
    *num_rows = pod.num_modes;
    pod.modes = NULL;
    pod_free(&pod);
    return EHD_OK;
}

ehd_status residual_snapshots_unit(double **rows, size_t *num_rows,
                                   const residual_snapshots *snapshots, size_t num_inner,
                                   ehd_error *error) {
    const size_t num_converged = residual_snapshots_converged(snapshots);
    *rows = NULL;
    *num_rows = 0;
    if (snapshots->reader) return stream_units(rows, num_rows, snapshots, num_inner, error);

    double *next = *rows = array_new(num_converged, num_inner, sizeof **rows);
    if (!*rows) return ehd_no_memory(error, "residuals");
    *num_rows = num_converged;
    for (size_t i = 0; i < snapshots->count; i++) {
        if (!is_last(snapshots, i)) continue;
        memcpy(next, snapshots->residuals + i * num_inner, num_inner * sizeof(double));
        make_unit(next, num_inner);
        next += num_inner;
    }
    return EHD_OK;
}
