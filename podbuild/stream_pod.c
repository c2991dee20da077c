/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "podbuild/stream_pod.h"

#include "common/algebra/lapack.h"
#include "common/program/arena.h"

#include <cblas.h>
#include <lapacke.h>
#include <limits.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* Largest number of nodes that are rotated at once. */
enum { MOST_ROTATED = 512 };

/* Smallest eigenvalue of a Gram matrix, relative to the largest, whose vector is orthogonal to the
 * others to 1e-6. */
static const double WEAKEST_EIGENVALUE = 1e-10;

/* Largest number of extensions for a block. Each reaches five decades down, to 1e-14 at most. */
enum { MAX_ROUNDS = 8 };

struct stream_pod {
    size_t num_nodes, block, max_rank;
    stream_settings settings;
    double *directions; // [max_rank, num_nodes] Q; the first `rank` rows are in use
    size_t rank;
    double *waiting; // [block, num_nodes] B
    size_t num_waiting;
    double *coordinates; // [block, max_rank] A
    double *triangle;    // [max_rank + block, max_rank] column-major, R in its first rows
    double *scales;      // [max_rank] scales of the reflectors of LAPACK
    double *rotated;     // [max_rank, rotated_nodes]
    size_t num_snapshots;
    stream_error error;
};

static double squared(const double *values, size_t count) {
    double sum = 0;

    for (size_t first = 0; first < count; first += INT_MAX) {
        const size_t left = count - first, part = left < INT_MAX ? left : INT_MAX;
        sum += cblas_ddot((int)part, values + first, 1, values + first, 1);
    }
    return sum;
}

static size_t triangle_rows(const stream_pod *self) {
    return self->max_rank + self->block;
}

// ---- products, all of row-major matrices

/* product = rows · directionsᵀ: [num_rows, num_directions] with `stride` numbers a row. */
static void take_components(double *product, size_t stride, const double *rows, size_t num_rows,
                            const double *directions, size_t num_directions, size_t num_nodes) {
    if (num_rows == 0 || num_directions == 0) return;
    cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasTrans, (int)num_rows, (int)num_directions,
                (int)num_nodes, 1, rows, (int)num_nodes, directions, (int)num_nodes, 0, product,
                (int)stride);
}

/* rows += factor · components · directions. */
static void add_components(double *rows, size_t num_rows, double factor, const double *components,
                           size_t stride, const double *directions, size_t num_directions,
                           size_t num_nodes) {
    if (num_rows == 0 || num_directions == 0) return;
    cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, (int)num_rows, (int)num_nodes,
                (int)num_directions, factor, components, (int)stride, directions, (int)num_nodes, 1,
                rows, (int)num_nodes);
}

// ---- dropping directions

static size_t rotated_nodes(size_t num_nodes) {
    return num_nodes < MOST_ROTATED ? num_nodes : MOST_ROTATED;
}

/* Rotates the directions by `right`, [num, rank] row-major with `stride` numbers a row: the first
 * `num` directions become those of the SVD. */
static void rotate(stream_pod *self, const double *right, size_t stride, size_t num) {
    const size_t most = rotated_nodes(self->num_nodes);

    for (size_t first = 0; first < self->num_nodes; first += most) {
        const size_t left = self->num_nodes - first, width = left < most ? left : most;
        cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, (int)num, (int)width,
                    (int)self->rank, 1, right, (int)stride, self->directions + first,
                    (int)self->num_nodes, 0, self->rotated, (int)most);
        for (size_t i = 0; i < num; i++)
            memcpy(self->directions + i * self->num_nodes + first, self->rotated + i * most,
                   width * sizeof(double));
    }
}

/* SVD of the triangle. Only its right singular vectors are used. */
typedef struct triangle_svd {
    double *values; // [rank] descending
    double *right;  // [rank, rank] row-major, a singular vector each row
    double *left;   // not used, but LAPACK needs the array
} triangle_svd;

static void svd_free(triangle_svd *svd) {
    free(svd->values);
    free(svd->right);
    free(svd->left);
    *svd = (triangle_svd){0};
}

static ehd_status svd_of_triangle(triangle_svd *svd, const stream_pod *self, ehd_error *error) {
    const int rank = (int)self->rank;
    double *copy = array_new(self->rank, self->rank, sizeof *copy);
    ehd_status status = EHD_OK;

    svd->values = array_new(self->rank, 1, sizeof(double));
    svd->left = array_new(self->rank, self->rank, sizeof(double));
    svd->right = array_new(self->rank, self->rank, sizeof(double));
    if (!copy || !svd->values || !svd->left || !svd->right) status = ehd_no_memory(error, "POD");
    // LAPACK reads the transpose of the triangle. Its left singular vectors are the right ones of
    // the triangle. Columns of a column-major matrix are rows of a row-major one.
    for (size_t j = 0; j < self->rank && !status; j++)
        for (size_t i = 0; i <= j; i++)
            copy[i * self->rank + j] = self->triangle[j * triangle_rows(self) + i];
    if (!status)
        status = lapack_outcome("dgesdd",
                                LAPACKE_dgesdd(LAPACK_COL_MAJOR, 'S', rank, rank, copy, rank,
                                               svd->values, svd->right, rank, svd->left, rank),
                                error);
    free(copy);
    if (status) svd_free(svd);
    return status;
}

/* Drops the weakest directions as far as root_energy allows. */
static ehd_status give_way(stream_pod *self, ehd_error *error) {
    const double allowed = self->settings.root_energy * self->error.energy;
    triangle_svd svd = {0};

    if (self->rank == 0) return EHD_OK;
    ehd_status status = svd_of_triangle(&svd, self, error);
    if (status) return status;
    size_t kept = self->rank;
    while (kept > 0) {
        const double energy = svd.values[kept - 1] * svd.values[kept - 1];
        if (!(self->error.truncated + energy <= allowed)) break;
        self->error.truncated += energy;
        kept--;
    }
    rotate(self, svd.right, self->rank, kept);
    // clear also the columns of dropped directions, which new directions expect to be zero
    memset(self->triangle, 0, self->rank * triangle_rows(self) * sizeof(double));
    for (size_t j = 0; j < kept; j++)
        self->triangle[j * triangle_rows(self) + j] = svd.values[j];
    self->rank = kept;
    svd_free(&svd);
    return EHD_OK;
}

// ---- a block

static void swap_rows(double *rows, size_t a, size_t b, size_t width, size_t stride) {
    if (a != b) cblas_dswap((int)width, rows + a * stride, 1, rows + b * stride, 1);
}

/* Moves the waiting rows whose squared norm exceeds `squared_length` to the front, with their
 * coordinates. The Gram matrix of the block does not depend on the order of its rows. Returns the
 * number of these rows. *left_out: sum of the squared norms of the others. */
static size_t sort_out(double *left_out, stream_pod *self, double squared_length) {
    size_t num_long = 0;

    *left_out = 0;
    for (size_t i = 0; i < self->num_waiting; i++) {
        const double own = squared(self->waiting + i * self->num_nodes, self->num_nodes);
        if (!(own > squared_length)) {
            *left_out += own;
            continue;
        }
        swap_rows(self->waiting, i, num_long, self->num_nodes, self->num_nodes);
        swap_rows(self->coordinates, i, num_long, self->rank, self->max_rank);
        num_long++;
    }
    return num_long;
}

/* Makes `num` new directions orthogonal to the present ones and, again, to each other. Before, they
 * are orthogonal up to round-off divided by the small norm of the rows that they were computed
 * from. */
static ehd_status orthogonalise(stream_pod *self, size_t num, ehd_error *error) {
    const size_t num_nodes = self->num_nodes, longest = self->rank > num ? self->rank : num;
    double *made = self->directions + self->rank * num_nodes;
    double *work = array_new(num, longest, sizeof *work);

    if (!work) return ehd_no_memory(error, "POD");
    take_components(work, longest, made, num, self->directions, self->rank, num_nodes);
    add_components(made, num, -1, work, longest, self->directions, self->rank, num_nodes);
    take_components(work, longest, made, num, made, num, num_nodes);
    const ehd_status status = lapack_outcome(
        "dpotrf", LAPACKE_dpotrf(LAPACK_ROW_MAJOR, 'L', (int)num, work, (int)longest), error);
    if (!status)
        cblas_dtrsm(CblasRowMajor, CblasLeft, CblasLower, CblasNoTrans, CblasNonUnit, (int)num,
                    (int)num_nodes, 1, work, (int)longest, made, (int)num_nodes);
    free(work);
    return status;
}

/* Subtracts from the waiting rows their components along the directions first … first + num - 1.
 * With `again` the components are added to the stored coordinates: they are the round-off of an
 * earlier subtraction. */
static ehd_status subtract(stream_pod *self, size_t first, size_t num, bool again,
                           ehd_error *error) {
    const double *directions = self->directions + first * self->num_nodes;
    double *part = again ? array_new(self->num_waiting, self->max_rank, sizeof *part)
                         : self->coordinates + first;

    if (!part) return ehd_no_memory(error, "POD");
    take_components(part, self->max_rank, self->waiting, self->num_waiting, directions, num,
                    self->num_nodes);
    add_components(self->waiting, self->num_waiting, -1, part, self->max_rank, directions, num,
                   self->num_nodes);
    if (!again) return EHD_OK;
    for (size_t i = 0; i < self->num_waiting; i++)
        cblas_daxpy((int)num, 1, part + i * self->max_rank, 1,
                    self->coordinates + i * self->max_rank + first, 1);
    free(part);
    return EHD_OK;
}

/* Computes the strongest eigenvectors of the Gram matrix of the first num_rows waiting rows, as
 * many as are needed to omit at most the energy `allowed`. Vectors of eigenvalues that are much
 * smaller than the largest are not exact enough. Such directions are found by another extension,
 * after the strong ones have been subtracted. */
static ehd_status find_directions(
    // output:
    size_t *num, double *vectors, // [num_rows, num_rows], row i: eigenvector over the root of its
                                  // eigenvalue
    // input:
    const stream_pod *self, size_t num_rows, double allowed, ehd_error *error) {
    const int rows = (int)num_rows;
    double *values = array_new(num_rows, 1, sizeof *values);

    *num = 0;
    if (!values) return ehd_no_memory(error, "POD");
    cblas_dsyrk(CblasRowMajor, CblasLower, CblasNoTrans, rows, (int)self->num_nodes, 1,
                self->waiting, (int)self->num_nodes, 0, vectors, rows);
    // for a column-major LAPACK this is the upper part, and the eigenvectors are rows
    const ehd_status status = lapack_outcome(
        "dsyevd", LAPACKE_dsyevd(LAPACK_COL_MAJOR, 'V', 'U', rows, vectors, rows, values), error);
    // eigenvalues are ascending: the first ones are omitted
    const double least = WEAKEST_EIGENVALUE * values[num_rows - 1];
    size_t first = 0;
    for (double left_out = 0; !status && first + 1 < num_rows; first++) {
        left_out += fmax(0, values[first]);
        if (left_out > allowed && values[first] > least) break;
    }
    *num = num_rows - first;
    for (size_t i = first; i < num_rows && !status; i++)
        cblas_dscal(rows, 1 / sqrt(values[i]), vectors + i * num_rows, 1);
    if (!status) memmove(vectors, vectors + first * num_rows, *num * num_rows * sizeof *vectors);
    free(values);
    return status;
}

/* Adds directions for the remainders of the waiting rows, or for the strongest part of them. *full:
 * there is no room for these directions, and none is added. */
static ehd_status extend(bool *full, stream_pod *self, double allowed, ehd_error *error) {
    double left_out;
    size_t num;
    const size_t num_long = sort_out(&left_out, self, allowed / (double)self->num_waiting);
    if (num_long == 0) return EHD_OK;
    double *vectors = array_new(num_long, num_long, sizeof *vectors);

    if (!vectors) return ehd_no_memory(error, "POD");
    ehd_status status =
        find_directions(&num, vectors, self, num_long, fmax(0, allowed - left_out), error);
    *full = !status && num > self->max_rank - self->rank;
    if (!status && !*full) {
        cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, (int)num, (int)self->num_nodes,
                    (int)num_long, 1, vectors, (int)num_long, self->waiting, (int)self->num_nodes,
                    0, self->directions + self->rank * self->num_nodes, (int)self->num_nodes);
        status = orthogonalise(self, num, error);
        if (!status) status = subtract(self, self->rank, num, false, error);
        self->rank += num;
    }
    free(vectors);
    return status;
}

/* Subtracts the components of the waiting rows along the directions. Extends the directions until
 * the energy of the remainders, *left, is at most `allowed`. *full: there is no room for more
 * directions. */
static ehd_status take_up(bool *full, double *left, stream_pod *self, double allowed,
                          ehd_error *error) {
    ehd_status status = subtract(self, 0, self->rank, false, error);

    *full = false;
    *left = status ? 0 : squared(self->waiting, self->num_waiting * self->num_nodes);
    for (int round = 0; !status && *left > allowed && !*full; round++) {
        if (round == MAX_ROUNDS)
            return ehd_fail(error, EHD_INTERNAL,
                            "POD: found %g left of snapshots after %d extensions, expected at most "
                            "%g",
                            *left, round, allowed);
        const size_t rank = self->rank;
        // subtract again: the round-off of the first subtraction is not small compared to the
        // remainder
        status = subtract(self, 0, self->rank, true, error);
        if (!status) status = extend(full, self, allowed, error);
        *left = squared(self->waiting, self->num_waiting * self->num_nodes);
        if (self->rank == rank) break; // all rows are short: only round-off
    }
    return status;
}

/* Adds the coordinates of the waiting rows to the triangle: R := triangle of [R; coordinates]. */
static ehd_status update_triangle(stream_pod *self, ehd_error *error) {
    const size_t rows = triangle_rows(self), rank = self->rank;

    if (rank == 0) return EHD_OK;
    for (size_t j = 0; j < rank; j++) {
        double *column = self->triangle + j * rows;
        for (size_t i = j + 1; i < rank; i++)
            column[i] = 0; // clear the reflectors of LAPACK, and new rows
        for (size_t i = 0; i < self->num_waiting; i++)
            column[rank + i] = self->coordinates[i * self->max_rank + j];
    }
    return lapack_outcome("dgeqrf",
                          LAPACKE_dgeqrf(LAPACK_COL_MAJOR, (int)(rank + self->num_waiting),
                                         (int)rank, self->triangle, (int)rows, self->scales),
                          error);
}

static ehd_status too_many(const stream_pod *self, ehd_error *error) {
    return ehd_fail(error, EHD_MEMORY,
                    "POD: found more than %zu directions in the first %zu snapshots, expected at "
                    "most as many as there is memory for; give more of it, or leave out a larger "
                    "part of the energy",
                    self->max_rank, self->num_snapshots);
}

/* Adds the waiting snapshots to the directions and the triangle. */
static ehd_status absorb(stream_pod *self, ehd_error *error) {
    const size_t before = self->rank;
    ehd_status status = EHD_OK;
    double left = 0;

    if (self->num_waiting == 0) return EHD_OK;
    self->error.energy += squared(self->waiting, self->num_waiting * self->num_nodes);
    // a second attempt follows if weak directions have to be dropped first
    for (int attempt = 0; attempt < 2; attempt++) {
        const double allowed =
            fmax(0, self->settings.local_energy * self->error.energy - self->error.distance);
        bool full;
        status = take_up(&full, &left, self, allowed, error);
        if (status) return status;
        if (!full) break;
        if (attempt > 0) return too_many(self, error);
        add_components(self->waiting, self->num_waiting, 1, self->coordinates, self->max_rank,
                       self->directions, self->rank, self->num_nodes);
        self->rank = before;
        status = give_way(self, error);
        if (status) return status;
        if (self->rank == before) return too_many(self, error);
    }
    self->error.distance += left;
    status = update_triangle(self, error);
    self->num_waiting = 0;
    return status;
}

// ---- the stream

static ehd_status check_settings(size_t num_nodes, const stream_settings *settings,
                                 ehd_error *error) {
    if (num_nodes == 0 || num_nodes > INT_MAX || settings->block == 0 || settings->max_rank == 0 ||
        settings->block > INT_MAX / 2 || settings->max_rank > INT_MAX / 2)
        return ehd_fail(error, EHD_DATA,
                        "POD: found %zu nodes, blocks of %zu, room for %zu directions, expected at "
                        "least one of each",
                        num_nodes, settings->block, settings->max_rank);
    if (!(settings->local_energy >= 0 && settings->local_energy < 1 && settings->root_energy >= 0 &&
          settings->root_energy < 1))
        return ehd_fail(error, EHD_DATA,
                        "POD: found energies %g and %g to leave out, expected "
                        "0 <= … < 1",
                        settings->local_energy, settings->root_energy);
    return EHD_OK;
}

ehd_status stream_pod_create(stream_pod **self, size_t num_nodes, const stream_settings *settings,
                             ehd_error *error) {
    ehd_status status = check_settings(num_nodes, settings, error);

    *self = NULL;
    if (status) return status;
    stream_pod *made = calloc(1, sizeof *made);
    if (made) {
        *made = (stream_pod){.num_nodes = num_nodes,
                             .block = settings->block,
                             .max_rank = settings->max_rank,
                             .settings = *settings};
        made->directions = array_new(made->max_rank, num_nodes, sizeof(double));
        made->waiting = array_new(made->block, num_nodes, sizeof(double));
        made->coordinates = array_new(made->block, made->max_rank, sizeof(double));
        made->triangle = array_new(triangle_rows(made), made->max_rank, sizeof(double));
        made->scales = array_new(made->max_rank, 1, sizeof(double));
        made->rotated = array_new(made->max_rank, rotated_nodes(num_nodes), sizeof(double));
    }
    if (!made || !made->directions || !made->waiting || !made->coordinates || !made->triangle ||
        !made->scales || !made->rotated) {
        stream_pod_free(made);
        return ehd_no_memory(error, "POD");
    }
    *self = made;
    return EHD_OK;
}

stream_pod *stream_pod_free(stream_pod *self) {
    if (!self) return NULL;
    free(self->directions);
    free(self->waiting);
    free(self->coordinates);
    free(self->triangle);
    free(self->scales);
    free(self->rotated);
    free(self);
    return NULL;
}

double stream_pod_bytes(size_t num_nodes, const stream_settings *settings) {
    const double nodes = (double)num_nodes, block = (double)settings->block;
    const double rank = (double)settings->max_rank;
    // The SVD of the triangle takes three more arrays of its size, and dgesdd four. A block takes
    // its coordinates twice, and eigenvectors, for which dsyevd takes twice their size.
    const double rows = (rank + block) * nodes;
    const double small =
        (rank + block) * rank + 8 * rank * rank + 3 * block * rank + 4 * block * block;

    return 8 * (rows + small + rank * (double)rotated_nodes(num_nodes));
}

bool stream_pod_room(size_t *block, size_t *max_rank, size_t num_snapshots, size_t least,
                     size_t most, double limit, stream_work_bytes *bytes, const void *work) {
    // large blocks give faster products, small ones leave room for more directions
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

ehd_status stream_pod_add(stream_pod *self, const double *snapshot, ehd_error *error) {
    const ehd_status status =
        pod_check_snapshots(snapshot, 1, self->num_nodes, self->num_snapshots, error);

    if (status) return status;
    memcpy(self->waiting + self->num_waiting * self->num_nodes, snapshot,
           self->num_nodes * sizeof(double));
    self->num_waiting++;
    self->num_snapshots++;
    return self->num_waiting < self->block ? EHD_OK : absorb(self, error);
}

/* Returns the energy that the modes may still omit, relative to the energy of the directions. The
 * energy of dropped directions counts against `discarded`. */
static double root_share(const stream_pod *self, const triangle_svd *svd, double discarded) {
    const double energy = squared(svd->values, self->rank);

    return energy > 0 ? fmax(0, discarded * self->error.energy - self->error.truncated) / energy
                      : 0;
}

ehd_status stream_pod_finish(pod_basis *basis, stream_error *bound, stream_pod *self,
                             const pod_settings *settings, ehd_error *error) {
    pod_settings root = *settings;
    triangle_svd svd = {0};
    ehd_status status = absorb(self, error);

    *basis = (pod_basis){0};
    *bound = self->error;
    if (!status && self->rank == 0)
        status = ehd_fail(error, EHD_DATA, "snapshots: found only zeros, expected rank > 0");
    if (!status) status = svd_of_triangle(&svd, self, error);
    if (status) return status;
    root.discarded_energy = root_share(self, &svd, settings->discarded_energy);
    status = pod_choose_num_modes(&basis->num_modes, svd.values, self->rank, &root, error);
    if (!status) {
        rotate(self, svd.right, self->rank, basis->num_modes);
        basis->num_nodes = self->num_nodes;
        basis->num_singular_values = self->rank;
        basis->singular_values = svd.values;
        basis->modes = self->directions;
        self->directions = svd.values = NULL;
        for (size_t i = 0; i < basis->num_modes; i++)
            pod_fix_sign(basis->modes + i * basis->num_nodes, basis->num_nodes);
        double *shorter =
            array_resize(basis->modes, basis->num_modes, basis->num_nodes, sizeof *shorter);
        if (shorter) basis->modes = shorter;
    }
    svd_free(&svd);
    if (status) *basis = (pod_basis){0};
    return status;
}
