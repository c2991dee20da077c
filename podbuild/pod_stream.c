/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the POD of snapshots in blocks, S ≈ U R Q (Himpe, Leibner and Rave 2018; pod_stream.h).
 * The columns of U are orthonormal, and U is never computed. Each block B updates R by its
 * components B Qᵀ. The POD of the remainder of B extends Q.
 * Called by bases.c, snapgen/trajectory.c and deimselect/residual_snapshots.c. */
#include "podbuild/pod_stream.h"

#include "common/algebra/lapack.h"
#include "common/program/arena.h"

#include <cblas.h>
#include <lapacke.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Largest number of nodes at which the directions are rotated at once. */
enum { MOST_ROTATED = 128 };

/* Largest number of extensions of the directions for one block. One SVD of a remainder resolves
 * singular values down to 1e-13 of the first; the next SVD resolves smaller ones. */
enum { MAX_EXTENSIONS = 2 };

struct pod_stream {
    pod_stream_settings settings;
    size_t num_nodes;
    double *waiting; // [block, num_nodes] B, snapshots that are not yet in Q and R
    size_t num_waiting;
    double *directions; // [rank, num_nodes] Q
    double *triangle;   // [rank, rank] row-major, R
    size_t rank;
    size_t num_snapshots; // includes snapshots that were merged in compressed form
    double energy;        // |S|²
    double distance;      // d
    double dropped;       // t
    double inherited;     // p
};

static double squared(const double *rows, size_t num_rows, size_t width) {
    double sum = 0;

    for (size_t i = 0; i < num_rows; i++)
        sum += cblas_ddot((int)width, rows + i * width, 1, rows + i * width, 1);
    return sum;
}

// ---- directions

/* Computes product = rows · directionsᵀ, [num_rows, num_directions]. Row i begins at product[i *
 * stride]. */
static void take_components(double *product, size_t stride, const double *rows, size_t num_rows,
                            const double *directions, size_t num_directions, size_t num_nodes) {
    if (num_rows == 0 || num_directions == 0) return;
    cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasTrans, (int)num_rows, (int)num_directions,
                (int)num_nodes, 1, rows, (int)num_nodes, directions, (int)num_nodes, 0, product,
                (int)stride);
}

/* Adds factor · components · directions to the rows. */
static void add_components(double *rows, size_t num_rows, double factor, const double *components,
                           size_t stride, const double *directions, size_t num_directions,
                           size_t num_nodes) {
    if (num_rows == 0 || num_directions == 0) return;
    cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, (int)num_rows, (int)num_nodes,
                (int)num_directions, factor, components, (int)stride, directions, (int)num_nodes, 1,
                rows, (int)num_nodes);
}

static size_t rotated_nodes(size_t num_nodes) {
    return num_nodes < MOST_ROTATED ? num_nodes : MOST_ROTATED;
}

/* Replaces the directions by `num` linear combinations of them. */
static ehd_status rotate(pod_stream *self, const double *combinations, size_t num,
                         ehd_error *error) {
    const size_t most = rotated_nodes(self->num_nodes);
    double *rotated = array_new(num, most, sizeof *rotated);

    if (!rotated) return ehd_no_memory(error, "POD");
    for (size_t first = 0; first < self->num_nodes; first += most) {
        const size_t left = self->num_nodes - first, width = left < most ? left : most;
        cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, (int)num, (int)width,
                    (int)self->rank, 1, combinations, (int)self->rank, self->directions + first,
                    (int)self->num_nodes, 0, rotated, (int)most);
        for (size_t i = 0; i < num; i++)
            memcpy(self->directions + i * self->num_nodes + first, rotated + i * most,
                   width * sizeof(double));
    }
    free(rotated);
    self->rank = num;
    return EHD_OK;
}

/* Replaces the directions by modes, the strongest first. `settings` choose the number of modes.
 * Overwrites the triangle. *svd: POD of the triangle. */
static ehd_status turn_to_modes(pod_basis *svd, pod_stream *self, const pod_settings *settings,
                                ehd_error *error) {
    ehd_status status = pod_decompose(svd, self->triangle, self->rank, self->rank, settings, error);

    if (!status) status = rotate(self, svd->modes, svd->num_modes, error);
    if (status) pod_free(svd);
    return status;
}

/* Drops the weakest directions as far as dropped_energy allows. */
static ehd_status drop_weakest(pod_stream *self, ehd_error *error) {
    const double allowed = self->settings.dropped_energy * self->energy - self->dropped;
    const double present = squared(self->triangle, self->rank, self->rank);
    pod_basis svd;

    if (self->rank == 0) return EHD_OK;
    const ehd_status status = turn_to_modes(
        &svd, self, &(pod_settings){.discarded_energy = fmax(0, allowed) / present}, error);
    if (status) return status;
    memset(self->triangle, 0, self->rank * self->rank * sizeof(double));
    for (size_t i = 0; i < self->rank; i++)
        self->triangle[i * (self->rank + 1)] = svd.singular_values[i];
    self->dropped += svd.tail;
    pod_free(&svd);
    return EHD_OK;
}

/* Makes the new directions, from `first` on, orthonormal, and orthogonal to the earlier directions.
 * The new directions come from rows of small norm. Their deviation from orthogonality is round-off
 * divided by this norm. */
static ehd_status orthogonalise(pod_stream *self, size_t first, ehd_error *error) {
    const size_t num_nodes = self->num_nodes, num = self->rank - first;
    const size_t longest = first > num ? first : num;
    double *made = self->directions + first * num_nodes;
    double *work = array_new(num, longest, sizeof *work);

    if (!work) return ehd_no_memory(error, "POD");
    take_components(work, longest, made, num, self->directions, first, num_nodes);
    add_components(made, num, -1, work, longest, self->directions, first, num_nodes);
    take_components(work, longest, made, num, made, num, num_nodes);
    const ehd_status status = lapack_outcome(
        "dpotrf", LAPACKE_dpotrf(LAPACK_ROW_MAJOR, 'L', (int)num, work, (int)longest), error);
    if (!status)
        cblas_dtrsm(CblasRowMajor, CblasLeft, CblasLower, CblasNoTrans, CblasNonUnit, (int)num,
                    (int)num_nodes, 1, work, (int)longest, made, (int)num_nodes);
    free(work);
    return status;
}

// ---- a block

/* Components A of the waiting snapshots along the directions. */
typedef struct components {
    double *along; // [num_waiting, stride]
    double *again; // [num_waiting, stride] work array of `subtract`
    size_t stride;
} components;

/* Subtracts from the waiting rows their components along the directions from `first` on, and adds
 * these components to `to`. */
static void subtract(pod_stream *self, components *to, size_t first) {
    const double *directions = self->directions + first * self->num_nodes;
    const size_t num = self->rank - first, stride = to->stride;

    if (num == 0) return;
    take_components(to->again, stride, self->waiting, self->num_waiting, directions, num,
                    self->num_nodes);
    add_components(self->waiting, self->num_waiting, -1, to->again, stride, directions, num,
                   self->num_nodes);
    for (size_t i = 0; i < self->num_waiting; i++)
        cblas_daxpy((int)num, 1, to->again + i * stride, 1, to->along + i * stride + first, 1);
}

static ehd_status append(pod_stream *self, const pod_basis *modes, ehd_error *error) {
    const size_t before = self->rank, after = before + modes->num_modes;
    double *longer = array_resize(self->directions, after, self->num_nodes, sizeof *longer);

    if (!longer) return ehd_no_memory(error, "POD");
    memcpy(longer + before * self->num_nodes, modes->modes,
           modes->num_modes * self->num_nodes * sizeof *longer);
    self->directions = longer;
    self->rank = after;
    return orthogonalise(self, before, error);
}

/* Copies those waiting rows whose remainder has a squared norm above `squared_length`. Returns the
 * number of copied rows. *left_out: sum of the squared norms of the other remainders. */
static size_t copy_long_rows(double *rows, double *left_out, const pod_stream *self,
                             double squared_length) {
    const size_t num_nodes = self->num_nodes;
    size_t num_long = 0;

    *left_out = 0;
    for (size_t i = 0; i < self->num_waiting; i++) {
        const double *row = self->waiting + i * num_nodes;
        const double own = squared(row, 1, num_nodes);
        if (own > squared_length)
            memcpy(rows + num_long++ * num_nodes, row, num_nodes * sizeof *rows);
        else
            *left_out += own;
    }
    return num_long;
}

/* Computes the POD of the remainders of the waiting rows. The energy of the remainders is `left`.
 * The POD omits at most the energy `allowed`. It omits rows of small norm first, and then weak
 * modes until `allowed` is used up. If all rows have small norms, which round-off can cause,
 * *found has no modes. */
static ehd_status decompose_remainder(pod_basis *found, const pod_stream *self, double left,
                                      double allowed, ehd_error *error) {
    double *rows = array_new(self->num_waiting, self->num_nodes, sizeof *rows), left_out;

    *found = (pod_basis){0};
    if (!rows) return ehd_no_memory(error, "POD");
    const size_t num_long =
        copy_long_rows(rows, &left_out, self, allowed / (double)self->num_waiting);
    const pod_settings wanted = {.discarded_energy =
                                     fmax(0, allowed - left_out) / (left - left_out)};
    const ehd_status status =
        num_long > 0 ? pod_decompose(found, rows, num_long, self->num_nodes, &wanted, error)
                     : EHD_OK;
    free(rows);
    return status;
}

/* Adds the modes of the remainders of the waiting rows to the directions. *full: whether there is
 * too little room for these modes; if so, no mode is added. */
static ehd_status extend(bool *full, pod_stream *self, components *to, double left, double allowed,
                         ehd_error *error) {
    const size_t max_rank = self->settings.max_rank, before = self->rank;
    pod_basis found;
    ehd_status status = decompose_remainder(&found, self, left, allowed, error);

    *full = !status && max_rank > 0 && found.num_modes > max_rank - before;
    if (!status && !*full && found.num_modes > 0) status = append(self, &found, error);
    if (!status && self->rank > before) subtract(self, to, before);
    pod_free(&found);
    return status;
}

/* Subtracts from the waiting rows their components along the directions. Extends the directions
 * until *left, the energy of the remainders, is at most `allowed`, but not more than MAX_EXTENSIONS
 * times. *full: whether there is too little room for more directions. */
static ehd_status take_up(bool *full, double *left, pod_stream *self, components *to,
                          double allowed, ehd_error *error) {
    ehd_status status = EHD_OK;

    *full = false;
    subtract(self, to, 0);
    *left = squared(self->waiting, self->num_waiting, self->num_nodes);
    for (int round = 0; !status && !*full && *left > allowed && round < MAX_EXTENSIONS; round++) {
        // subtracts again, because the round-off of the first subtraction may be as large as the
        // remainder
        subtract(self, to, 0);
        *left = squared(self->waiting, self->num_waiting, self->num_nodes);
        if (!(*left > allowed)) break;
        status = extend(full, self, to, *left, allowed, error);
        *left = squared(self->waiting, self->num_waiting, self->num_nodes);
    }
    return status;
}

/* Adds the components A of the waiting rows to R, which becomes the triangular factor of [R; A].
 * `before`: number of directions before this block. */
static ehd_status update_triangle(pod_stream *self, const components *from, size_t before,
                                  ehd_error *error) {
    const size_t rank = self->rank, present = before + self->num_waiting;
    const size_t num_rows = present > rank ? present : rank;
    double *rows = array_new(num_rows, rank, sizeof *rows);
    double *scales = array_new(rank, 1, sizeof *scales);
    ehd_status status = rows && scales ? EHD_OK : ehd_no_memory(error, "POD");

    for (size_t i = 0; i < before && !status; i++)
        memcpy(rows + i * rank, self->triangle + i * before, before * sizeof *rows);
    for (size_t i = 0; i < self->num_waiting && !status; i++)
        memcpy(rows + (before + i) * rank, from->along + i * from->stride, rank * sizeof *rows);
    // LAPACK reads the transpose of the rows, whose factor L is the transpose of R
    if (!status && rank > 0)
        status = lapack_outcome(
            "dgelqf",
            LAPACKE_dgelqf(LAPACK_COL_MAJOR, (int)rank, (int)num_rows, rows, (int)rank, scales),
            error);
    free(scales);
    free(self->triangle);
    self->triangle = rows;
    for (size_t i = 1; i < rank && !status; i++)
        memset(rows + i * rank, 0, i * sizeof *rows); // removes the reflectors of LAPACK
    return status;
}

static ehd_status too_many(const pod_stream *self, ehd_error *error) {
    return ehd_fail(error, EHD_MEMORY,
                    "POD: found more than %zu directions in the first %zu snapshots, expected at "
                    "most as many as there is memory for; give more of it, or leave out a larger "
                    "part of the energy",
                    self->settings.max_rank, self->num_snapshots);
}

/* Makes room for new directions. Restores the waiting rows from their components, and removes the
 * directions behind the first `before` ones. Then drops the weakest of the remaining directions. */
static ehd_status make_room(pod_stream *self, components *from, size_t before, ehd_error *error) {
    add_components(self->waiting, self->num_waiting, 1, from->along, from->stride, self->directions,
                   self->rank, self->num_nodes);
    self->rank = before;
    memset(from->along, 0, self->num_waiting * from->stride * sizeof *from->along);
    const ehd_status status = drop_weakest(self, error);
    return !status && self->rank == before ? too_many(self, error) : status;
}

/* Adds the waiting snapshots to the directions and the triangle. */
static ehd_status absorb(pod_stream *self, ehd_error *error) {
    const double allowed = fmax(0, self->settings.local_energy * self->energy - self->distance);
    const size_t stride = self->rank + MAX_EXTENSIONS * self->num_waiting;
    components parts = {array_new(self->num_waiting, stride, sizeof(double)),
                        array_new(self->num_waiting, stride, sizeof(double)), stride};
    size_t before = self->rank;
    double left = 0;
    bool full = false;
    ehd_status status = parts.along && parts.again
                            ? take_up(&full, &left, self, &parts, allowed, error)
                            : ehd_no_memory(error, "POD");

    if (!status && full) {
        status = make_room(self, &parts, before, error);
        before = self->rank;
        if (!status) status = take_up(&full, &left, self, &parts, allowed, error);
        if (!status && full) status = too_many(self, error);
    }
    if (!status) status = update_triangle(self, &parts, before, error);
    self->distance += left;
    self->num_waiting = 0;
    free(parts.along);
    free(parts.again);
    return status;
}

// ---- the stream

static ehd_status check_settings(size_t num_nodes, const pod_stream_settings *settings,
                                 ehd_error *error) {
    if (num_nodes == 0 || num_nodes > INT_MAX || settings->block == 0 ||
        settings->block > INT_MAX / 4 || settings->max_rank > INT_MAX / 4)
        return ehd_fail(error, EHD_DATA,
                        "POD: found %zu nodes, blocks of %zu, room for %zu directions, expected at "
                        "least one of each",
                        num_nodes, settings->block, settings->max_rank);
    if (!(settings->local_energy >= 0 && settings->local_energy < 1 &&
          settings->dropped_energy >= 0 && settings->dropped_energy < 1))
        return ehd_fail(error, EHD_DATA,
                        "POD: found energies %g and %g to leave out, expected "
                        "0 <= … < 1",
                        settings->local_energy, settings->dropped_energy);
    return EHD_OK;
}

ehd_status pod_stream_create(pod_stream **self, size_t num_nodes,
                             const pod_stream_settings *settings, ehd_error *error) {
    const ehd_status status = check_settings(num_nodes, settings, error);

    *self = NULL;
    if (status) return status;
    pod_stream *made = array_new(1, 1, sizeof *made);
    double *waiting = array_new(settings->block, num_nodes, sizeof *waiting);
    if (!made || !waiting) {
        free(made);
        free(waiting);
        return ehd_no_memory(error, "POD");
    }
    *made = (pod_stream){.settings = *settings, .num_nodes = num_nodes, .waiting = waiting};
    *self = made;
    return EHD_OK;
}

pod_stream *pod_stream_free(pod_stream *self) {
    if (!self) return NULL;
    free(self->waiting);
    free(self->directions);
    free(self->triangle);
    free(self);
    return NULL;
}

ehd_status pod_stream_add(pod_stream *self, const double *snapshots, size_t count,
                          ehd_error *error) {
    const size_t num_nodes = self->num_nodes;
    ehd_status status =
        pod_check_snapshots(snapshots, count, num_nodes, self->num_snapshots, error);

    for (size_t i = 0; i < count && !status; i++) {
        // a full block is absorbed only if another snapshot follows, because the POD of a single
        // block is exact
        if (self->num_waiting == self->settings.block) status = absorb(self, error);
        if (status) break;
        double *row = self->waiting + self->num_waiting++ * num_nodes;
        memcpy(row, snapshots + i * num_nodes, num_nodes * sizeof *row);
        self->energy += squared(row, 1, num_nodes);
        self->num_snapshots++;
    }
    return status;
}

ehd_status pod_stream_merge(pod_stream *self, const pod_basis *part, ehd_error *error) {
    const size_t before = self->num_snapshots;
    double *row = array_new(part->num_nodes, 1, sizeof *row);
    ehd_status status = row ? EHD_OK : ehd_no_memory(error, "POD");

    for (size_t i = 0; i < part->num_modes && !status; i++) {
        pod_row(row, part, i);
        status = pod_stream_add(self, row, 1, error);
    }
    pod_stream_inherit(self, pod_discarded(part) * part->energy);
    self->num_snapshots = before + part->num_snapshots;
    free(row);
    return status;
}

void pod_stream_inherit(pod_stream *self, double squared_distance) {
    self->inherited += squared_distance;
}

double pod_stream_energy(const pod_stream *self) {
    return self->energy;
}

/* Returns the energy that the modes may still omit, relative to the energy of R. */
static double root_share(const pod_stream *self, double discarded) {
    const double present = squared(self->triangle, self->rank, self->rank);
    const double length = fmax(0, sqrt(discarded * self->energy) - sqrt(self->distance));

    return present > 0 ? fmax(0, length * length - self->dropped) / present : 0;
}

/* Computes the modes if there is more than one block. */
static ehd_status finish_chain(pod_basis *basis, pod_stream *self, const pod_settings *settings,
                               ehd_error *error) {
    pod_settings root = *settings;
    ehd_status status = absorb(self, error);

    *basis = (pod_basis){0};
    if (status) return status;
    root.discarded_energy = root_share(self, settings->discarded_energy);
    status = turn_to_modes(basis, self, &root, error);
    if (status) return status;
    double *shorter = array_resize(self->directions, self->rank, self->num_nodes, sizeof *shorter);
    free(basis->modes); // modes of R
    basis->modes = shorter ? shorter : self->directions;
    self->directions = NULL;
    basis->num_nodes = self->num_nodes;
    basis->energy = self->energy;
    basis->tail += self->dropped;
    for (size_t i = 0; i < basis->num_modes; i++)
        pod_fix_sign(basis->modes + i * basis->num_nodes, basis->num_nodes);
    return EHD_OK;
}

ehd_status pod_stream_finish(pod_basis *basis, pod_stream *self, const pod_settings *settings,
                             ehd_error *error) {
    const ehd_status status = self->rank > 0
                                  ? finish_chain(basis, self, settings, error)
                                  : pod_decompose(basis, self->waiting, self->num_waiting,
                                                  self->num_nodes, settings, error);

    basis->num_snapshots = self->num_snapshots;
    basis->distance = sqrt(self->distance) + sqrt(self->inherited);
    return status;
}

// ---- memory

double pod_stream_bytes(size_t num_nodes, size_t num_snapshots,
                        const pod_stream_settings *settings) {
    const bool one_block = num_snapshots <= settings->block;
    const double nodes = (double)num_nodes, rank = (double)settings->max_rank;
    const double block = (double)(one_block ? num_snapshots : settings->block);
    // The SVD needs its matrix, two arrays of singular vectors, and four work arrays in dgesdd.
    if (one_block) {
        const double values = fmin(nodes, block);
        return 8 * ((block + values) * nodes + 7 * values * values);
    }
    // The remainder of a block is copied for its POD, and the modes are held beside the
    // directions. The SVD of the triangle needs seven more arrays of the triangle's size.
    const double small = 8 * rank * rank + 2 * block * (rank + 2 * block) + 7 * block * block;

    return 8 * ((rank + 3 * block) * nodes + small + rank * (double)rotated_nodes(num_nodes));
}

bool pod_stream_room(size_t *block, size_t *max_rank, size_t num_snapshots, size_t least,
                     size_t most, double limit, pod_work_bytes *bytes, const void *work) {
    // large blocks make the products faster; small blocks leave room for more directions
    static const size_t blocks[] = {128, 64, 32, 16, 8, 4, 2, 1};
    bool enough = false;

    *block = 1;
    *max_rank = least;
    for (size_t b = 0; b < sizeof blocks / sizeof *blocks; b++) {
        const size_t size = blocks[b] < num_snapshots ? blocks[b] : num_snapshots;
        size_t low = least, high = most;
        if (bytes(work, size, least) > limit) continue;
        while (low < high) {
            const size_t middle = low + (high - low + 1) / 2;
            if (bytes(work, size, middle) <= limit)
                low = middle;
            else
                high = middle - 1;
        }
        enough = true;
        *block = size;
        *max_rank = low;
        // keep a large block only if there is room for enough directions
        if (low >= 4 * size || low == most) break;
    }
    return enough;
}
