/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/calibrate/time_compare.h"

#include <gsl/gsl_spline.h>
#include <math.h>
#include <string.h>

/* Relative difference up to which times are the same. */
static const double SAME_TIME = 1e-12;

static double value_at(double time, const gsl_spline *spline, gsl_interp_accel *accelerator) {
    size_t k = gsl_interp_accel_find(accelerator, spline->x, spline->size, time);

    // at the same times, as with fixed steps, there is nothing to interpolate
    for (size_t i = k; i <= k + 1 && i < spline->size; i++)
        if (fabs(time - spline->x[i]) <= SAME_TIME * fmax(fabs(time), 1)) return spline->y[i];
    return gsl_spline_eval(spline, time, accelerator);
}

ehd_status time_compare(time_deviation *deviation, const double *time, const double *values,
                        size_t num_times, const double *other_time, const double *other_values,
                        size_t num_other, ehd_error *error) {
    gsl_interp_accel accelerator = {0};
    double length = 0, last = 0;
    size_t count = 0;

    memset(deviation, 0, sizeof *deviation);
    if (num_other < 3)
        return ehd_fail(error, EHD_DATA, "time: found %zu entries, expected at least 3", num_other);
    gsl_spline *spline = gsl_spline_alloc(gsl_interp_cspline, num_other);
    if (!spline) return ehd_fail(error, EHD_MEMORY, "time: found no memory");
    gsl_spline_init(spline, other_time, other_values, num_other);
    for (size_t i = 0; i < num_times; i++) {
        if (time[i] < other_time[0] || time[i] > other_time[num_other - 1]) continue;
        double relative = fabs(values[i] / value_at(time[i], spline, &accelerator) - 1);
        if (!(relative <= deviation->largest)) {
            deviation->largest = relative;
            deviation->at = time[i];
        }
        if (count++ > 0) {
            deviation->mean += relative * (time[i] - last);
            length += time[i] - last;
        }
        last = time[i];
    }
    gsl_spline_free(spline);
    if (count < 3)
        return ehd_fail(error, EHD_DATA, "time: found %zu times in common, expected at least 3",
                        count);
    deviation->mean /= length;
    return EHD_OK;
}
