/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the memory for building a basis, and divides a memory limit between the block and the
 * directions of the stream (pod_stream.h). The allowed error is sqrt(E) |S| (README.md, Error
 * bound); the fractions for its terms add up to one.
 * Called by main.c (bases_plan_make) and by bases.c (bases_plan_at_once). */
#include "podbuild/bases_plan.h"

#include <math.h>

/* Fraction of the square root of the allowed energy (bases_plan.h; stream.bats, "a small limit:
 * the error within the bound"). */
const double SMALL_SHARE = 0.05;

double bases_modes_share(void) {
    return 1 - 2 * SMALL_SHARE;
}

/* Dropped directions may have this fraction of the allowed energy that remains beside the distance
 * from the directions (stream.bats, "a small limit: the error within the bound"). */
static const double DROPPED_SHARE = 0.2;

/* Allowed energy if only the number of modes is given. With this energy SMALL_SHARE allows a
 * squared distance of 1e-22, which keeps singular values above 1e-11 of the first (README.md, More
 * than fits in memory). */
static const double EXACT_ENERGY = 4e-20;

/* Lower limit of the local energy. A smaller energy is only round-off (README.md, More than fits
 * in memory). */
static const double LEAST_LOCAL = 1e-28;

/* Sets the energies that a stream may omit. For a part file, half of the square root of its allowed
 * energy is for the distance of the snapshots from the directions, and half for omitted modes. */
static void share_energy(bases_plan *plan, const bases_settings *settings) {
    const double part = settings->as_part ? SMALL_SHARE * SMALL_SHARE : 1;
    const double local = settings->as_part ? 0.5 : SMALL_SHARE;

    plan->energy = settings->exact ? EXACT_ENERGY : settings->pressure.discarded_energy;
    plan->stream.local_energy = fmax(local * local * part * plan->energy, LEAST_LOCAL);
    plan->stream.dropped_energy = DROPPED_SHARE * (1 - local) * (1 - local) * part * plan->energy;
}

/* Returns the largest number of modes that a stream can compute. */
static double most_modes(const pod_settings *wanted, size_t max_rank) {
    return wanted->num_modes ? fmin((double)wanted->num_modes, (double)max_rank) : (double)max_rank;
}

/* Returns the memory of the states and their coordinates, bytes. All states are held twice, because
 * writing makes a copy. States of a part are also held twice while they are read. */
static double state_bytes(const snapshot_set *from, double num_modes) {
    // number of scalars of a state (README.md, More than fits in memory)
    const double columns = 20, lines = (double)grid_lines(&from->grid);
    double rank = 0, longest = 0;

    for (size_t i = 0; i < from->num_sources; i++)
        if (from->sources[i].is_part) {
            rank = fmax(rank, (double)from->sources[i].num_rows);
            longest = fmax(longest, (double)from->sources[i].num_states);
        }
    return 8 * (double)from->num_states * (2 * (num_modes + 2) + 4 * lines + 2 * columns) +
           8 * longest * (2 * (rank + 2) + 2 * lines + columns) + 8 * rank * num_modes;
}

/* Returns the largest memory over all stages of bases_build. */
static double plan_bytes(const bases_plan *plan, const snapshot_set *from,
                         const bases_settings *settings) {
    const bool independent = settings->kind == DEFORMATION_INDEPENDENT;
    const double a_field = 8 * (double)from->grid.num_nodes;
    const double few =
        (independent ? 24 : 6) * a_field; // fields being read, and work arrays of the deflection
    const double stream = pod_stream_bytes(from->grid.num_nodes, from->num_rows, &plan->stream);
    const double pressure = most_modes(&settings->pressure, plan->stream.max_rank);
    const double deformation =
        independent ? most_modes(&settings->deformation, plan->stream.max_rank) : 0;
    const double batches = (independent ? 2 : 1) * (double)plan->batch * a_field;
    double most = stream + (independent ? pressure * a_field : 0);

    most = fmax(most, (pressure + deformation) * a_field + batches);
    // modes in the basis, and a second copy of one kind of modes for transposing and writing
    most = fmax(most, (pressure + deformation + fmax(pressure, deformation)) * a_field);
    return most + few + state_bytes(from, pressure + deformation);
}

/* Arguments of bytes_with. */
typedef struct plan_work {
    const snapshot_set *from;
    const bases_settings *settings;
    const bases_plan *plan;
} plan_work;

static void take_room(bases_plan *plan, size_t block, size_t rank) {
    plan->stream.block = plan->batch = block;
    plan->stream.max_rank = rank;
}

static double bytes_with(const void *work, size_t block, size_t rank) {
    const plan_work *self = work;
    bases_plan plan = *self->plan;

    take_room(&plan, block, rank);
    return plan_bytes(&plan, self->from, self->settings);
}

static size_t most_directions(const snapshot_set *from) {
    const size_t rows = from->num_rows, nodes = from->grid.num_nodes;

    return rows < nodes ? rows : nodes;
}

bases_plan bases_plan_at_once(const snapshot_set *from, const bases_settings *settings) {
    bases_plan plan = {.at_once = true};

    share_energy(&plan, settings);
    take_room(&plan, from->num_rows, most_directions(from));
    plan.batch = 1;
    plan.bytes = plan_bytes(&plan, from, settings);
    return plan;
}

ehd_status bases_plan_make(bases_plan *plan, const snapshot_set *from,
                           const bases_settings *settings, double limit, ehd_error *error) {
    const size_t most = most_directions(from);
    const size_t modes = settings->pressure.num_modes > settings->deformation.num_modes
                             ? settings->pressure.num_modes
                             : settings->deformation.num_modes;
    size_t least = modes > 16 ? modes : 16, block, rank;

    *plan = bases_plan_at_once(from, settings);
    plan->limit = limit;
    if (plan->bytes <= limit) return EHD_OK;
    plan->at_once = false;
    if (least > most) least = most;
    const plan_work work = {from, settings, plan};
    const bool enough =
        pod_stream_room(&block, &rank, from->num_rows, least, most, limit, bytes_with, &work);
    take_room(plan, block, rank);
    plan->bytes = plan_bytes(plan, from, settings);
    if (enough) return EHD_OK;
    return ehd_fail(
        error, EHD_MEMORY,
        "--memory: found %.4g MB, expected at least %.4g MB for %zu states on %zu nodes "
        "and %zu modes",
        limit * 1e-6, ceil(plan->bytes * 1e-4) * 1e-2, from->num_states, from->grid.num_nodes,
        least);
}
