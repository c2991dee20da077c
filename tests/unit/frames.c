/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/unit/frames.h"

#include "common/settings/scene.h"

#include <math.h>

contact_frame frame_of(const contact_kind *kind, double load, double speed, double radius,
                       double modulus, double approach) {
    const double values[NUM_VARY] = {
        [VARY_LOAD] = load, [VARY_SPEED] = speed, [VARY_RADIUS] = radius, [VARY_MODULUS] = modulus};

    return frame_at(kind, 0.5, values, approach);
}

const double factors[NUM_FACTORS][4] = {{1, 1, 1, 1},     {1.5, 1, 1, 1},     {1, 0.3, 1, 1},
                                        {1, 1, 2.5, 1},   {1, 1, 1, 0.6},     {0.7, 1.4, 0.5, 1.3},
                                        {4, 0.1, 3, 1.7}, {2, 1.2, 1.5, 3.0}, {0.2, 2, 0.8, 0.9}};

contact_frame frame_of_case(const contact_kind *kind, size_t i) {
    return frame_of(kind, factors[i][0], factors[i][1], factors[i][2], factors[i][3], NAN);
}

void fill_times(double *time, double now, const double *lengths) {
    time[0] = now;
    for (size_t i = 0; i < BDF_PREVIOUS; i++)
        time[i + 1] = time[i] - lengths[i];
}
