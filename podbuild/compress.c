/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "podbuild/compress.h"

#include "podbuild/pod.h"

#include <cblas.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { DEFAULT_BLOCK = 512 };

/* One part for each level, and a carry. A count of snapshots has at most 64 binary digits. */
enum { MAX_PARTS = 65 };

/* Some consecutive snapshots after compression. */
typedef struct compressed_part {
    double *rows;            // [rank, num_nodes]
    double *singular_values; // [rank]
    size_t rank;
    unsigned level;   // truncations on the longest path from a snapshot to this part, minus one
    double energy;    // sum of the squares of the snapshots of this part
    double discarded; // sum of the squares omitted in this part and in the parts below
} compressed_part;

struct snapshot_compressor {
    size_t num_nodes, block;
    compressor_settings settings;
    double *waiting; // [block, num_nodes] snapshots not compressed yet, and rows of merged sets
    size_t num_waiting;
    double waiting_energy;            // sum of their squares
    compressed_part parts[MAX_PARTS]; // in order of descending level, the oldest first
    size_t num_parts;
    size_t num_snapshots;
    double inherited; // energy that merged sets had already omitted
};

static void part_free(compressed_part *part) {
    free(part->rows);
    free(part->singular_values);
    *part = (compressed_part){0};
}

/* Returns the energy that a part of this level may have omitted, with all parts below it. */
static double allowance(const snapshot_compressor *self, const compressed_part *part) {
    const double share = (part->level + 1.0) / (part->level + 2.0);
    return share * self->settings.discarded_energy * part->energy;
}

/* Sets the rows of a part to the modes times the singular values. */
static ehd_status scale_modes(
    // output:
    compressed_part *part, // in: rank; out: rows, singular_values
    // input:
    const pod_basis *basis, ehd_error *error) {
    const size_t num_nodes = basis->num_nodes;

    part->rows = malloc(part->rank * num_nodes * sizeof *part->rows);
    part->singular_values = malloc(part->rank * sizeof *part->singular_values);
    if (!part->rows || !part->singular_values) return ehd_no_memory(error, "compressed snapshots");
    memcpy(part->singular_values, basis->singular_values,
           part->rank * sizeof *part->singular_values);
    for (size_t i = 0; i < part->rank; i++)
        for (size_t k = 0; k < num_nodes; k++)
            part->rows[i * num_nodes + k] =
                basis->singular_values[i] * basis->modes[i * num_nodes + k];
    return EHD_OK;
}

/* Compresses rows by a truncated SVD that stays within the energy allowance of the part. */
static ehd_status compress_rows(
    // in and out:
    compressed_part *part, // in: level, energy, discarded below; out: all; empty on failure
    // input:
    const double *rows, size_t num_rows, const snapshot_compressor *self, ehd_error *error) {
    const size_t max_rank = self->settings.max_rank;
    const double row_energy = part->energy - part->discarded;
    pod_basis basis = {0};
    ehd_status status = EHD_OK;

    if (num_rows == 0 || !(row_energy > 0)) return EHD_OK; // rank 0
    const double allowed = fmax(0, allowance(self, part) - part->discarded);
    status = pod_build(&basis, rows, num_rows, self->num_nodes,
                       &(pod_settings){.discarded_energy = allowed / row_energy}, error);
    if (!status) {
        part->rank = max_rank && basis.num_modes > max_rank ? max_rank : basis.num_modes;
        for (size_t i = basis.num_singular_values; i-- > part->rank;)
            part->discarded += basis.singular_values[i] * basis.singular_values[i];
        status = scale_modes(part, &basis, error);
    }
    pod_free(&basis);
    if (status) part_free(part);
    return status;
}

static ehd_status compress_waiting(compressed_part *part, const snapshot_compressor *self,
                                   ehd_error *error) {
    *part = (compressed_part){.energy = self->waiting_energy};
    return compress_rows(part, self->waiting, self->num_waiting, self, error);
}

/* Joins two parts: newer := older and newer. On failure newer is unchanged. */
static ehd_status join(compressed_part *newer, const compressed_part *older,
                       const snapshot_compressor *self, ehd_error *error) {
    const size_t older_length = older->rank * self->num_nodes;
    const size_t newer_length = newer->rank * self->num_nodes;
    compressed_part both = {.level =
                                1 + (older->level > newer->level ? older->level : newer->level),
                            .energy = older->energy + newer->energy,
                            .discarded = older->discarded + newer->discarded};
    double *rows = malloc((older_length + newer_length + 1) * sizeof *rows); // never of size 0

    if (!rows) return ehd_no_memory(error, "compressed snapshots");
    if (older->rank) memcpy(rows, older->rows, older_length * sizeof *rows);
    if (newer->rank) memcpy(rows + older_length, newer->rows, newer_length * sizeof *rows);
    ehd_status status = compress_rows(&both, rows, older->rank + newer->rank, self, error);
    free(rows);
    if (status) return status;
    part_free(newer);
    *newer = both;
    return EHD_OK;
}

/* Compresses the waiting block to a part of level 0. Joins parts while the last two have equal
 * levels. */
static ehd_status store_block(snapshot_compressor *self, ehd_error *error) {
    ehd_status status = compress_waiting(&self->parts[self->num_parts], self, error);

    if (status) return status;
    self->num_parts++;
    self->num_waiting = 0;
    self->waiting_energy = 0;
    while (self->num_parts > 1) {
        compressed_part *newest = &self->parts[self->num_parts - 1], *older = newest - 1;
        if (older->level != newest->level) break;
        status = join(newest, older, self, error);
        if (status) return status;
        part_free(older);
        *older = *newest;
        self->num_parts--;
    }
    return EHD_OK;
}

/* Adds rows one by one, so that the block limits and the order of all sums do not depend on how the
 * rows arrive. */
static ehd_status add_rows(snapshot_compressor *self, const double *rows, size_t count,
                           ehd_error *error) {
    const size_t num_nodes = self->num_nodes;

    for (size_t i = 0; i < count; i++) {
        double *row = self->waiting + self->num_waiting * num_nodes;
        memcpy(row, rows + i * num_nodes, num_nodes * sizeof *row);
        self->waiting_energy += cblas_ddot((int)num_nodes, row, 1, row, 1);
        if (++self->num_waiting < self->block) continue;
        const ehd_status status = store_block(self, error);
        if (status) return status;
    }
    return EHD_OK;
}

ehd_status compressor_create(snapshot_compressor **self, size_t num_nodes,
                             const compressor_settings *settings, ehd_error *error) {
    const size_t block = settings->block ? settings->block : DEFAULT_BLOCK;

    *self = NULL;
    if (num_nodes == 0 || num_nodes > INT_MAX)
        return ehd_fail(error, EHD_DATA, "snapshots: found %zu nodes, expected 1 to %d", num_nodes,
                        INT_MAX);
    if (block > INT_MAX)
        return ehd_fail(error, EHD_DATA, "block: found %zu, expected at most %d", block, INT_MAX);
    if (!(settings->discarded_energy >= 0 && settings->discarded_energy < 1))
        return ehd_fail(error, EHD_DATA, "discarded energy: found %g, expected 0 <= … < 1",
                        settings->discarded_energy);
    *self = calloc(1, sizeof **self);
    if (*self) (*self)->waiting = calloc(block, num_nodes * sizeof *(*self)->waiting);
    if (!*self || !(*self)->waiting) {
        *self = compressor_free(*self);
        return ehd_no_memory(error, "compressed snapshots");
    }
    (*self)->num_nodes = num_nodes;
    (*self)->block = block;
    (*self)->settings = *settings;
    return EHD_OK;
}

snapshot_compressor *compressor_free(snapshot_compressor *self) {
    if (!self) return NULL;
    for (size_t i = 0; i < self->num_parts; i++)
        part_free(&self->parts[i]);
    free(self->waiting);
    free(self);
    return NULL;
}

ehd_status compressor_add(snapshot_compressor *self, const double *snapshots, size_t count,
                          ehd_error *error) {
    ehd_status status = pod_check_snapshots(snapshots, count, self->num_nodes, 0, error);

    if (!status) status = add_rows(self, snapshots, count, error);
    if (!status) self->num_snapshots += count;
    return status;
}

ehd_status compressor_merge(snapshot_compressor *self, const compressed_set *set,
                            ehd_error *error) {
    if (set->num_nodes != self->num_nodes)
        return ehd_fail(error, EHD_DATA, "compressed snapshots: found %zu nodes, expected %zu",
                        set->num_nodes, self->num_nodes);
    if (!(set->energy >= 0 && isfinite(set->energy) && set->energy_discarded >= 0 &&
          set->energy_discarded <= 1))
        return ehd_fail(
            error, EHD_DATA,
            "compressed snapshots: found energy %g, part discarded %g, expected a finite "
            "one >= 0, a part from 0 to 1",
            set->energy, set->energy_discarded);
    ehd_status status = pod_check_snapshots(set->rows, set->rank, self->num_nodes, 0, error);
    if (!status) status = add_rows(self, set->rows, set->rank, error);
    if (!status) {
        self->num_snapshots += set->num_snapshots;
        self->inherited += set->energy * set->energy_discarded;
    }
    return status;
}

/* Omits the weakest rows as long as the omitted energy stays at most `allowed`. */
static void spend_rest(compressed_part *part, double allowed) {
    while (part->rank > 1) {
        const double weakest = part->singular_values[part->rank - 1];
        if (part->discarded + weakest * weakest > allowed) break;
        part->discarded += weakest * weakest;
        part->rank--;
    }
}

ehd_status compressor_finish(compressed_set *result, const snapshot_compressor *self,
                             ehd_error *error) {
    compressed_part whole;
    ehd_status status = compress_waiting(&whole, self, error);

    *result = (compressed_set){0};
    // the part of lowest level first, like the carry of a counter
    for (size_t i = self->num_parts; !status && i-- > 0;)
        status = join(&whole, &self->parts[i], self, error);
    if (status) {
        part_free(&whole);
        return status;
    }
    spend_rest(&whole, self->settings.discarded_energy * whole.energy);
    result->rank = whole.rank;
    result->num_nodes = self->num_nodes;
    result->rows = whole.rows;
    result->singular_values = whole.singular_values;
    result->num_snapshots = self->num_snapshots;
    result->energy = whole.energy + self->inherited;
    if (result->energy > 0)
        result->energy_discarded = (whole.discarded + self->inherited) / result->energy;
    return EHD_OK;
}

void compressed_set_free(compressed_set *set) {
    free(set->rows);
    free(set->singular_values);
    *set = (compressed_set){0};
}
