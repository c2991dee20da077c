/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/time/time_grid.h"

#include "common/time/frame.h"

#include <math.h>

/* Largest number of nodes that light loads may cause. A step of a line contact takes 0.13 s with
 * 10,000 nodes; the full model solves larger grids of point contacts without factors. */
static const size_t MOST_NODES = 10000;

/* Part of the length that a default grid gives the inlet, for the smallest M. The central film of
 * lines is then at most 2.9 % too thin, with a third up to 18 % (M 0.3 to 100, L 0 to 15). */
static const double SUFFICIENT = 0.5;

enum { NUM_TIMES = 1000 }; // at which the histories are looked at, besides their kinks

/* Returns the stationary contact with the Moes numbers of a frame's contact. */
static ehd_contact stationary_of(const ehd_contact *contact) {
    ehd_contact stationary = *contact;

    contact_set_moes(&stationary, contact->moes_M, contact->moes_L);
    return stationary;
}

/* Sets `contact` to the contact at a time, with at least the load `least`, if its M is smaller. */
static void lower_M(ehd_contact *contact, const ehd_histories *histories,
                    const ehd_contact *reference, double time, double least) {
    double values[NUM_VARY];
    ehd_contact found;

    histories_at(values, histories, time);
    values[VARY_LOAD] = fmax(values[VARY_LOAD], least);
    if (time == 0)
        values[VARY_SPEED] = fmax(fabs(values[VARY_SPEED]), fabs(histories_start_speed(histories)));
    const contact_frame frame = frame_at(reference->kind, time, values, NAN);
    frame_contact(&found, &frame, reference);
    if (found.moes_M < contact->moes_M) *contact = found;
}

/* Returns the contact at the time of the smallest M, if loads are at least `least`. */
static ehd_contact contact_of_least_M(const ehd_histories *histories, const ehd_contact *reference,
                                      double end_time, double least) {
    ehd_contact lowest = *reference;
    double kink = 0;

    for (int i = 0; i <= NUM_TIMES; i++) {
        const double time = end_time * i / NUM_TIMES;
        for (bool jump; kink < time; kink = histories_next_kink(histories, kink, &jump))
            lower_M(&lowest, histories, reference, kink, least);
        lower_M(&lowest, histories, reference, time, least);
    }
    return lowest;
}

/* Returns the extent whose ends suit both contacts and, if the entrainment reverses, either
 * direction. The step is that of the reference. */
static grid_extent extent_of(const ehd_contact *reference, const ehd_contact *lowest,
                             bool reverses) {
    const double given = reference->grid_given.x_min;
    const ehd_contact stationary = stationary_of(lowest);
    grid_extent longest = grid_extent_needed(&stationary);
    grid_extent extent = grid_extent_needed(reference);
    const double step = extent.step;

    longest.x_min *= SUFFICIENT;
    longest.y_max *= SUFFICIENT;
    grid_extent_join(&extent, &longest);
    extent.step = step;
    if (reverses) extent.x_max = fmax(extent.x_max, -(isnan(given) ? extent.x_min : given));
    return extent;
}

grid_extent time_grid_extent(const ehd_histories *histories, const ehd_contact *reference,
                             double end_time) {
    const bool reverses = histories_reverse(histories);

    for (double least = frame_negligible_load; least < 1; least *= 2) {
        const ehd_contact lowest = contact_of_least_M(histories, reference, end_time, least);
        const grid_extent extent = extent_of(reference, &lowest, reverses);
        const ehd_grid grid = grid_choose(&reference->grid_given, &extent, &reference->grid);
        if (grid.num_inner <= MOST_NODES) return extent;
    }
    return extent_of(reference, reference, reverses);
}

double time_grid_inlet_effect(const ehd_contact *contact, bool backwards) {
    const ehd_grid *grid = &contact->grid;
    const ehd_contact stationary = stationary_of(contact);

    return grid_inlet_effect(&stationary, backwards ? grid_x(grid, grid->inner_x) : -grid->x_min);
}
