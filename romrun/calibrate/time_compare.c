/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/calibrate/time_compare.h"

#include "common/algebra/spline.h"

#include <math.h>

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
    double last = NAN;
    size_t near = 0;

    spline *between = spline_create(num_other);
    if (!between) return ehd_no_memory(error, "time");
    spline_fit(between, other_time, other_values);
    for (size_t i = 0; i < num_times; i++) {
        if (time[i] < other_time[0] || time[i] > other_time[num_other - 1]) continue;
        const double there = value_at(time[i], other_time, other_values, between, &near);
        const double relative = fabs(values[i] / there - 1);
        if (!isnan(deviation->largest) && !(relative <= deviation->largest)) {
            deviation->largest = relative;
            deviation->at = time[i];
        }
        if (!isnan(last)) {
            deviation->sum += relative * (time[i] - last);
            deviation->length += time[i] - last;
        }
        last = time[i];
    }
    spline_free(between);
    return EHD_OK;
}
