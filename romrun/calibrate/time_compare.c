/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/calibrate/time_compare.h"

#include "common/algebra/spline.h"

#include <math.h>
#include <string.h>

/* Times are equal up to this relative difference. */
static const double SAME_TIME = 1e-12;

/* Returns a value of the second run at a time. `near`: in and out, index of the spline interval. */
static double value_at(double time, const double *other_time, const double *other_values,
                       const spline *between, size_t *near) {
    *near = spline_interval(between, time, *near);
    // no interpolation if the times are equal, as with fixed steps
    for (size_t i = *near; i <= *near + 1; i++)
        if (fabs(time - other_time[i]) <= SAME_TIME * fmax(fabs(time), 1)) return other_values[i];
    return spline_value(between, time, *near);
}

ehd_status time_compare(time_deviation *deviation, const double *time, const double *values,
                        size_t num_times, const double *other_time, const double *other_values,
                        size_t num_other, ehd_error *error) {
    double length = 0, last = 0;
    size_t count = 0, near = 0;

    memset(deviation, 0, sizeof *deviation);
    if (num_other < 3)
        return ehd_fail(error, EHD_DATA, "time: found %zu entries, expected at least 3", num_other);
    spline *between = spline_create(num_other);
    if (!between) return ehd_no_memory(error, "time");
    spline_fit(between, other_time, other_values);
    for (size_t i = 0; i < num_times; i++) {
        if (time[i] < other_time[0] || time[i] > other_time[num_other - 1]) continue;
        const double there = value_at(time[i], other_time, other_values, between, &near);
        double relative = fabs(values[i] / there - 1);
        if (!isnan(deviation->largest) && !(relative <= deviation->largest)) {
            deviation->largest = relative;
            deviation->at = time[i];
        }
        if (count++ > 0) {
            deviation->mean += relative * (time[i] - last);
            length += time[i] - last;
        }
        last = time[i];
    }
    spline_free(between);
    if (count < 3)
        return ehd_fail(error, EHD_DATA, "time: found %zu times in common, expected at least 3",
                        count);
    deviation->mean /= length;
    return EHD_OK;
}
