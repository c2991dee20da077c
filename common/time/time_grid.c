/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/time/time_grid.h"

#include "common/time/frame.h"

#include <math.h>

/* Largest estimated errors of the central film because of the length of the inlet: USUAL_EFFECT
 * for default grids, LARGEST_EFFECT for trusted results. LARGEST_EFFECT is the error of a film
 * formula (common/physics/README.md, Default grid; test_time_grid.c, default_grids_suffice). */
static const double USUAL_EFFECT = 0.03, LARGEST_EFFECT = 0.05;

/* Number of points in time at which histories are sampled: NUM_TIMES in one period, or until the
 * end if there is no period; at most MOST_TIMES in all (test_time_grid.c, no_minimum_is_missed). */
enum { NUM_TIMES = 1000, MOST_TIMES = 100000 };

/* Returns the stationary contact with the M and the Hertz pressure of a frame's contact. */
static ehd_contact stationary_of(const ehd_contact *contact) {
    ehd_contact stationary = *contact;

    stationary.lambda = contact->kind->lambda(&contact->grid.shape, contact->moes_M);
    return stationary;
}

/* Replaces `contact` by the contact at a time, if M is smaller at this time. Loads below
 * default_accuracy times the reference load are replaced by this value. */
static void lower_M(ehd_contact *contact, const ehd_histories *histories,
                    const ehd_contact *reference, double time) {
    double values[NUM_VARY];
    ehd_contact found;

    histories_at(values, histories, time);
    values[VARY_LOAD] = fmax(values[VARY_LOAD], default_accuracy);
    if (time == 0)
        values[VARY_SPEED] = fmax(fabs(values[VARY_SPEED]), fabs(histories_start_speed(histories)));
    const contact_frame frame = frame_at(reference->kind, time, values, NAN);
    frame_contact(&found, &frame, reference);
    if (found.moes_M < contact->moes_M) *contact = found;
}

static int count_times(const ehd_histories *histories, double end_time) {
    const double period = 2 * M_PI * histories_smooth_time(histories); // period of a sine

    return (int)fmin(NUM_TIMES * fmax(end_time / period, 1), MOST_TIMES);
}

static ehd_contact contact_of_least_M(const ehd_histories *histories, const ehd_contact *reference,
                                      double end_time) {
    const int count = count_times(histories, end_time);
    ehd_contact lowest = *reference;
    double kink = 0;

    for (int i = 0; i <= count; i++) {
        const double time = end_time * i / count;
        for (bool jump; kink < time; kink = histories_next_kink(histories, kink, &jump))
            lower_M(&lowest, histories, reference, kink);
        lower_M(&lowest, histories, reference, time);
    }
    return lowest;
}

/* Returns an extent that is long enough for both contacts and, if the entrainment reverses, for
 * both directions. The grid step is the step of the reference's grid. */
static grid_extent extent_of(const ehd_contact *reference, const ehd_contact *lowest,
                             bool reverses) {
    const double given = reference->grid_given.x_min;
    const ehd_contact stationary = stationary_of(lowest);
    const grid_extent longest = grid_extent_within(&stationary, USUAL_EFFECT);
    grid_extent extent = grid_extent_needed(reference);
    const double step = extent.step;

    grid_extent_join(&extent, &longest);
    extent.step = step;
    if (reverses) extent.x_max = fmax(extent.x_max, -(isnan(given) ? extent.x_min : given));
    return extent;
}

static double count_nodes(const ehd_contact *reference, const grid_extent *extent) {
    return (double)grid_choose(&reference->grid_given, extent, &reference->grid).num_inner;
}

grid_extent time_grid_extent(const ehd_histories *histories, const ehd_contact *reference,
                             double end_time) {
    const bool reverses = histories_reverse(histories);
    const grid_extent own = extent_of(reference, reference, reverses);
    const double most = fmax(2 * count_nodes(reference, &own), LARGE_GRID);

    if (!contact_has_chosen_grid(reference)) return own;
    ehd_contact lowest = contact_of_least_M(histories, reference, end_time);
    while (lowest.moes_M < reference->moes_M) {
        const grid_extent extent = extent_of(reference, &lowest, reverses);
        if (count_nodes(reference, &extent) <= most) return extent;
        contact_set_moes(&lowest, 2 * lowest.moes_M, contact_moes_L(&lowest));
    }
    return own;
}

bool time_grid_is_short(double *effect, const ehd_contact *contact, bool backwards) {
    const ehd_grid *grid = &contact->grid;
    const ehd_contact stationary = stationary_of(contact);
    const double length = backwards ? grid_x(grid, grid->inner_x) : -grid->x_min;

    *effect = grid_inlet_effect(&stationary, length);
    return !(*effect <= LARGEST_EFFECT) && length < -grid_extent_needed(&stationary).x_min;
}
