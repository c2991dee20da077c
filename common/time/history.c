/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/time/history.h"

#include "common/algebra/rounding.h"
#include "common/algebra/spline.h"
#include "common/artefact/table.h"
#include "common/settings/scene_contact.h"
#include "common/settings/unit.h"

#include <gsl/gsl_interp.h>
#include <gsl/gsl_poly.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MIN_LINEAR = 2, MIN_SPLINE = 3 }; // least numbers of rows in a table

// Bounds of the times in a table, and of the distance between two of them. Times in a scene have
// the same bounds.
static const double MAX_TIME = 1e12, MIN_DISTANCE = 1e-9;

typedef struct history_law history_law;

/* History of one quantity. */
typedef struct history {
    const history_law *law;
    history_settings given;
    int quantity;              // VARY_LOAD, …
    table_time_settings times; // of a table
    const char *si;            // SI unit of the quantity
    double reference;          // value of the quantity at the factor 1, in SI units; NaN: not known
    double unit_of_time;       // a/u in s; NaN: not known
    bool without_unit;         // the table has no unit of its times or values
    bool in_seconds;           // the times of the table are in seconds
    double *time;              // [count], times of a table
    double *values;            // [count], values at these times
    size_t count;
    spline *spline; // NULL: linear interpolation
} history;

typedef struct minimum_value {
    double value, time;
} minimum_value;

struct ehd_histories {
    history of[NUM_VARY];
    minimum_value slowest, lightest; // smallest speed, smallest load
    double start_speed;              // NaN: the speed of the history at T = 0
};

/* A law of histories: one row of the table `laws`. */
struct history_law {
    const char *name;
    ehd_status (*prepare)(history *self, double end_time, ehd_error *error); // NULL: nothing to do
    double (*value)(const history *self, double time);
    minimum_value (*minimum)(const history *self, double end_time); // from 0 to end_time
    double (*integral)(const history *self, double time);           // integral of the value, from 0
    /* Returns the first kink or jump after `time`; NULL: the law has none. */
    double (*next_kink)(const history *self, double time, bool *jump);
    double (*shortest_time)(const history *self); // NULL: the law jumps or is constant
};

static void lower_to(minimum_value *minimum, const history *self, double time) {
    const double value = self->law->value(self, time);
    if (value < minimum->value) *minimum = (minimum_value){value, time};
}

/* Returns the minimum of a law that is monotonic. */
static minimum_value minimum_of_ends(const history *self, double end_time) {
    minimum_value minimum = {self->law->value(self, 0), 0};
    lower_to(&minimum, self, end_time);
    return minimum;
}

// ---- constant

static double constant_value(const history *self, double time) {
    (void)self;
    (void)time;
    return 1;
}

static double constant_integral(const history *self, double time) {
    (void)self;
    return time;
}

// ---- sine

static double sine_value(const history *self, double time) {
    const history_settings *given = &self->given;
    return given->mean + given->amplitude * sin(2 * M_PI * time / given->period + given->phase);
}

static double sine_integral(const history *self, double time) {
    const history_settings *given = &self->given;
    const double rate = 2 * M_PI / given->period, half = rate * time / 2;
    // this product is the difference of the cosines at both ends
    return given->mean * time + 2 * given->amplitude / rate * sin(half) * sin(half + given->phase);
}

static minimum_value sine_minimum(const history *self, double end_time) {
    const history_settings *given = &self->given;
    const double trough = given->amplitude > 0 ? -M_PI_2 : M_PI_2; // phase of the minimum
    const double turns = (trough - given->phase) / (2 * M_PI);
    const double first = (turns - floor(turns)) * given->period; // first minimum from T = 0 on
    if (first > end_time) return minimum_of_ends(self, end_time);
    return (minimum_value){given->mean - fabs(given->amplitude), first};
}

static double sine_shortest_time(const history *self) {
    return self->given.amplitude == 0 ? INFINITY : self->given.period / (2 * M_PI);
}

// ---- ramp

static double ramp_value(const history *self, double time) {
    const history_settings *given = &self->given;
    const double part = fmin(fmax((time - given->start) / given->duration, 0), 1);
    return given->from * (1 - part) + given->to * part;
}

static double ramp_integral(const history *self, double time) {
    const history_settings *given = &self->given;
    const double duration = given->duration, change = given->to - given->from;
    // ends: T = 0 and `time`, counted from the start of the ramp; sum: integrals of the change from
    // this start to both ends
    const double ends[] = {-given->start, time - given->start};
    double sum[2];
    for (int i = 0; i < 2; i++) {
        const double during = fmin(fmax(ends[i], 0), duration), after = fmax(ends[i] - duration, 0);
        sum[i] = change * (during * during / (2 * duration) + after);
    }
    return given->from * time + (sum[1] - sum[0]);
}

static double ramp_next_kink(const history *self, double time, bool *jump) {
    const double start = self->given.start, end = start + self->given.duration;
    *jump = false;
    if (start > time) return start;
    return end > time ? end : INFINITY;
}

static double ramp_shortest_time(const history *self) {
    return self->given.from == self->given.to ? INFINITY : self->given.duration;
}

// ---- step

static double step_value(const history *self, double time) {
    return time > self->given.at ? self->given.to : self->given.from;
}

static double step_integral(const history *self, double time) {
    const history_settings *given = &self->given;
    const double before = fmin(fmax(given->at, 0), time);
    return given->from * before + given->to * (time - before);
}

static double step_next_kink(const history *self, double time, bool *jump) {
    *jump = self->given.at > time;
    return *jump ? self->given.at : INFINITY;
}

// ---- table

/* Multiplies a column by the factor from its unit to its dimensionless unit. `own` is the unit that
 * the scene gives, or "". `plain` is the name of the dimensionless unit. `si` and `scale` are the
 * SI unit and the value of the dimensionless unit in it. *has_unit: whether a unit was given. */
static ehd_status take_unit(table_column *column, bool *has_unit, const history *self,
                            const char *own, const char *plain, const char *si, double scale,
                            const char *key, ehd_error *error) {
    const char *unit = *own ? own : column->unit;
    char list[SHOWN_TEXT];
    unit_conversion to_si;

    *has_unit = *unit;
    if (!*unit || strcmp(unit, plain) == 0) return EHD_OK;
    if (!si)
        return ehd_fail(error, EHD_DATA, "%s: %s: found the unit %s, expected %s", self->given.file,
                        key, unit, plain);
    unit_list(list, si);
    if (!unit_find(&to_si, si, unit))
        return ehd_fail(error, EHD_DATA, "%s: %s: found the unit %s, expected %s, %s, %s",
                        self->given.file, key, unit, plain, si, list);
    if (isnan(scale))
        return ehd_fail(error, EHD_DATA,
                        "%s: %s: found the unit %s in a scene without physical, expected %s",
                        self->given.file, key, unit, plain);
    for (size_t i = 0; i < self->count; i++)
        column->values[i] *= to_si.factor / scale;
    return EHD_OK;
}

/* Reads a table. Its times become T, its values factors on the reference value. */
static ehd_status read_table(history *self, ehd_error *error) {
    static const char *const time_names[] = {"time", "T", "t", NULL};
    const char *const own_time[] = {self->times.column, NULL};
    const char *const value_names[] = {self->given.column, NULL};
    table_column columns[] = {{.names = *self->times.column ? own_time : time_names, .alone = true},
                              {.names = value_names}};
    char key[48];
    bool has_unit[2] = {false, false};
    ehd_status status = table_read(self->given.file, columns, 2, &self->count, error);

    self->time = columns[0].values;
    self->values = columns[1].values;
    snprintf(key, sizeof key, "transient.%s.unit", vary_names[self->quantity]);
    if (!status)
        status = take_unit(&columns[0], &has_unit[0], self, self->times.unit, "T", "s",
                           self->unit_of_time, "transient.time.unit", error);
    if (!status)
        status = take_unit(&columns[1], &has_unit[1], self, self->given.unit, "factor", self->si,
                           self->reference, key, error);
    self->without_unit = !has_unit[0] || !has_unit[1];
    self->in_seconds = has_unit[0] && strcmp(self->times.unit, "T") != 0;
    return status;
}

static ehd_status check_row(const history *self, size_t i, ehd_error *error) {
    const char *path = self->given.file;
    const double *time = self->time, *values = self->values;
    if (!(fabs(time[i]) <= MAX_TIME))
        return ehd_fail(error, EHD_DATA,
                        "%s: found the time %g in row %zu, expected one from %g to %g", path,
                        time[i], i + 1, -MAX_TIME, MAX_TIME);
    if (i > 0 && !(time[i] - time[i - 1] >= MIN_DISTANCE))
        return ehd_fail(error, EHD_DATA,
                        "%s: found the time %.10g in row %zu, expected at least %g after %.10g in "
                        "the row before",
                        path, time[i], i + 1, MIN_DISTANCE, time[i - 1]);
    if (!(fabs(values[i]) <= MAX_FACTOR))
        return ehd_fail(error, EHD_DATA,
                        "%s: %s: found %g in row %zu, expected a factor on the reference value "
                        "from %d to %d",
                        path, self->given.column, values[i], i + 1, -MAX_FACTOR, MAX_FACTOR);
    return EHD_OK;
}

static ehd_status check_table(const history *self, double end_time, ehd_error *error) {
    const char *path = self->given.file, *interpolation = self->given.interpolation;
    const size_t needed = strcmp(interpolation, "linear") == 0 ? MIN_LINEAR : MIN_SPLINE;
    ehd_status status = EHD_OK;
    if (self->count < needed)
        return ehd_fail(error, EHD_DATA, "%s: found %zu row%s, expected at least %zu (%s)", path,
                        self->count, self->count == 1 ? "" : "s", needed, interpolation);
    for (size_t i = 0; i < self->count && !status; i++)
        status = check_row(self, i, error);
    if (status) return status;
    const double first = self->time[0], last = self->time[self->count - 1];
    if (first > 0)
        return ehd_fail(error, EHD_DATA, "%s: found %.10g as first time, expected 0 or before",
                        path, first);
    if (last < end_time)
        return ehd_fail(error, EHD_DATA,
                        "%s: found %.10g as last time, expected transient.end_time = %.10g or "
                        "after",
                        path, last, end_time);
    return EHD_OK;
}

static ehd_status prepare_table(history *self, double end_time, ehd_error *error) {
    ehd_status status = read_table(self, error);
    if (!status) status = check_table(self, end_time, error);
    if (status || strcmp(self->given.interpolation, "linear") == 0) return status;
    self->spline = spline_create(self->count);
    if (!self->spline) return ehd_no_memory(error, self->given.file);
    spline_fit(self->spline, self->time, self->values);
    return EHD_OK;
}

/* Returns the row at which the interval around a time begins. The time is within the table. */
static size_t row_before(const history *self, double time) {
    return gsl_interp_bsearch(self->time, time, 0, self->count - 1);
}

static double line_value(const history *self, double time) {
    const size_t i = row_before(self, time);
    const double part = (time - self->time[i]) / (self->time[i + 1] - self->time[i]);
    return self->values[i] * (1 - part) + self->values[i + 1] * part;
}

/* Returns the value at a time. Outside of the table this is the first or the last value. */
static double table_value(const history *self, double time) {
    const size_t last = self->count - 1;
    if (time <= self->time[0]) return self->values[0];
    if (time >= self->time[last]) return self->values[last];
    return self->spline ? spline_at(self->spline, time) : line_value(self, time);
}

/* Lowers the minimum to the extrema of the spline within interval i, where the slope of the spline
 * is a parabola. */
static void lower_to_turns(minimum_value *minimum, const history *self, size_t i, double end_time) {
    const double left = self->time[i], right = self->time[i + 1];
    const double slope = spline_slope(self->spline, left);
    const double bend = spline_bend(self->spline, left);
    const double bend_right = spline_bend(self->spline, right);
    double turn[2];
    const int count = gsl_poly_solve_quadratic((bend_right - bend) / (2 * (right - left)), bend,
                                               slope, &turn[0], &turn[1]);
    for (int k = 0; k < count; k++) {
        const double time = left + turn[k];
        if (time > fmax(left, 0) && time < fmin(right, end_time)) lower_to(minimum, self, time);
    }
}

static minimum_value table_minimum(const history *self, double end_time) {
    minimum_value minimum = minimum_of_ends(self, end_time);
    for (size_t i = 0; i < self->count; i++)
        if (self->time[i] > 0 && self->time[i] < end_time) lower_to(&minimum, self, self->time[i]);
    for (size_t i = 0; self->spline && i + 1 < self->count; i++)
        lower_to_turns(&minimum, self, i, end_time);
    return minimum;
}

/* Returns the integral from the first row to a time within the table. */
static double integral_of_rows(const history *self, double time) {
    const size_t last = row_before(self, time);
    double sum = 0;
    if (self->spline) return spline_integral(self->spline, time);
    for (size_t i = 0; i < last; i++)
        sum += (self->values[i] + self->values[i + 1]) / 2 * (self->time[i + 1] - self->time[i]);
    return sum + (self->values[last] + line_value(self, time)) / 2 * (time - self->time[last]);
}

static double table_integral(const history *self, double time) {
    const double first = self->time[0], end = self->time[self->count - 1];
    const double within = fmin(fmax(time, first), end);
    const double beyond = (time - within) * table_value(self, time);
    return beyond + integral_of_rows(self, within) - integral_of_rows(self, 0);
}

/* Returns the time of the next row of a table with linear interpolation, which has a kink at each
 * row. A spline has no kinks, and the result is INFINITY. */
static double table_next_kink(const history *self, double time, bool *jump) {
    *jump = false;
    if (self->spline || time >= self->time[self->count - 1]) return INFINITY;
    return time < self->time[0] ? self->time[0] : self->time[row_before(self, time) + 1];
}

static double table_shortest_time(const history *self) {
    double shortest = INFINITY;
    for (size_t i = 1; i < self->count; i++)
        shortest = fmin(shortest, self->time[i] - self->time[i - 1]);
    return shortest;
}

// ---- the laws

static const history_law laws[] = {
    {"constant", NULL, constant_value, minimum_of_ends, constant_integral, NULL, NULL},
    {"sine", NULL, sine_value, sine_minimum, sine_integral, NULL, sine_shortest_time},
    {"ramp", NULL, ramp_value, minimum_of_ends, ramp_integral, ramp_next_kink, ramp_shortest_time},
    {"step", NULL, step_value, minimum_of_ends, step_integral, step_next_kink, NULL},
    {"table", prepare_table, table_value, table_minimum, table_integral, table_next_kink,
     table_shortest_time}};

/* Returns the law of a name. A quantity without a law is constant. */
static const history_law *find_law(const char *name) {
    for (size_t i = 0; i < sizeof laws / sizeof *laws; i++)
        if (strcmp(laws[i].name, name) == 0) return &laws[i];
    return &laws[0];
}

static ehd_status check_history(const history *self, int quantity, double end_time,
                                ehd_error *error) {
    const minimum_value minimum = self->law->minimum(self, end_time);
    // the approach may have any finite value; check_forward checks the speed
    if (quantity == VARY_APPROACH || quantity == VARY_SPEED || isgreater(minimum.value, 0))
        return EHD_OK;
    if (quantity == VARY_LOAD && isgreaterequal(minimum.value, -ROUNDING)) return EHD_OK;
    return ehd_fail(error, EHD_DATA, "transient.%s: found %.6g at T = %.6g, expected %s 0",
                    vary_names[quantity], minimum.value, minimum.time,
                    quantity == VARY_LOAD ? "at least" : "more than");
}

/* Checks that the speed and the speed of the start are not below 0. `reason` ends the message. */
static ehd_status check_forward(const ehd_histories *self, const char *reason, ehd_error *error) {
    if (isless(self->start_speed, 0))
        return ehd_fail(error, EHD_DATA, "transient.start_speed: found %.6g, expected at least 0%s",
                        self->start_speed, reason);
    if (isgreaterequal(self->slowest.value, -ROUNDING)) return EHD_OK;
    return ehd_fail(error, EHD_DATA,
                    "transient.speed: found %.6g at T = %.6g, expected at least 0%s",
                    self->slowest.value, self->slowest.time, reason);
}

ehd_status histories_init(ehd_histories **result, const scene *given, ehd_error *error) {
    ehd_histories *self = calloc(1, sizeof *self);
    ehd_status status = EHD_OK;
    *result = NULL;
    if (!self) return ehd_no_memory(error, "transient");
    self->start_speed = given->transient.start_speed;
    ehd_contact contact;
    if (scene_contact_derive(&contact, given, NULL)) contact.half_width = contact.speed = NAN;
    const bool line = strcmp(given->contact, "line") == 0;
    const struct {
        const char *si;
        double reference;
    } of_quantity[] = {[VARY_LOAD] = {line ? "N/m" : "N", given->physical.load},
                       [VARY_SPEED] = {"m/s", scene_speed(given)},
                       [VARY_RADIUS] = {"m", given->physical.radius},
                       [VARY_MODULUS] = {"Pa", given->physical.modulus},
                       [VARY_APPROACH] = {NULL, NAN}};
    for (int i = 0; i < NUM_VARY && !status; i++) {
        history *of = &self->of[i];
        of->given = given->transient.vary[i];
        of->quantity = i;
        of->times = given->transient.time;
        of->si = of_quantity[i].si;
        of->reference = of_quantity[i].reference;
        of->unit_of_time = contact_time_scale(&contact);
        if (isnan(of->given.mean)) of->given.mean = 1;
        of->law = find_law(of->given.law);
        if (of->law->prepare) status = of->law->prepare(of, given->transient.end_time, error);
        if (!status) status = check_history(of, i, given->transient.end_time, error);
        if (!status && i == VARY_SPEED)
            self->slowest = of->law->minimum(of, given->transient.end_time);
        if (!status && i == VARY_LOAD)
            self->lightest = of->law->minimum(of, given->transient.end_time);
    }
    if (!status && strcmp(given->transport, "path") != 0)
        status = check_forward(self, "; transport: path can reverse", error);
    if (status) self = histories_free(self);
    *result = self;
    return status;
}

bool histories_in_seconds(const ehd_histories *self) {
    bool any = false;

    for (int i = 0; i < NUM_VARY; i++)
        any = any || self->of[i].in_seconds;
    return any;
}

const char *histories_without_unit(const ehd_histories *self) {
    for (int i = 0; i < NUM_VARY; i++)
        if (self->of[i].without_unit && !isnan(self->of[i].reference))
            return self->of[i].given.file;
    return NULL;
}

ehd_status histories_init_forward(ehd_histories **self, const scene *given, ehd_error *error) {
    ehd_status status = histories_init(self, given, error);

    if (!status)
        status = check_forward(*self, " with a reduced model, which is of one direction", error);
    if (status) *self = histories_free(*self);
    return status;
}

ehd_status histories_init_training(ehd_histories **self, const scene *given, ehd_error *error) {
    ehd_status status = histories_init_forward(self, given, error);

    if (status || isgreater((*self)->lightest.value, ROUNDING)) return status;
    status = ehd_fail(error, EHD_DATA,
                      "transient.load: found %.6g at T = %.6g, expected more than 0 in training",
                      (*self)->lightest.value, (*self)->lightest.time);
    *self = histories_free(*self);
    return status;
}

bool histories_reverse(const ehd_histories *self) {
    return isless(self->slowest.value, -ROUNDING) || isless(self->start_speed, 0);
}

ehd_histories *histories_free(ehd_histories *self) {
    if (!self) return NULL;
    for (int i = 0; i < NUM_VARY; i++) {
        free(self->of[i].time);
        free(self->of[i].values);
        spline_free(self->of[i].spline);
    }
    free(self);
    return NULL;
}

void histories_at(double value[NUM_VARY], const ehd_histories *self, double time) {
    for (int i = 0; i < NUM_VARY; i++)
        value[i] = self->of[i].law->value(&self->of[i], time);
    // removes round-off from a load of 0, and from a speed that does not reverse
    if (value[VARY_LOAD] < ROUNDING) value[VARY_LOAD] = 0;
    if (!histories_reverse(self)) value[VARY_SPEED] = fmax(value[VARY_SPEED], 0);
}

double histories_start_speed(const ehd_histories *self) {
    double value[NUM_VARY];

    histories_at(value, self, 0);
    return isnan(self->start_speed) ? value[VARY_SPEED] : self->start_speed;
}

double histories_path(const ehd_histories *self, double time) {
    const history *speed = &self->of[VARY_SPEED];
    return speed->law->integral(speed, time);
}

static double kink_after(const history *of, double time, bool *jump) {
    *jump = false;
    return of->law->next_kink ? of->law->next_kink(of, time, jump) : INFINITY;
}

double histories_next_kink(const ehd_histories *self, double time, bool *jump) {
    double next = INFINITY;
    *jump = false;
    for (int i = 0; i < NUM_VARY; i++) {
        bool jumps;
        const double kink = kink_after(&self->of[i], time, &jumps);
        *jump = kink < next ? jumps : *jump || (jumps && kink == next);
        next = fmin(next, kink);
    }
    return next;
}

double histories_shortest_time(const ehd_histories *self) {
    double shortest = INFINITY;
    for (int i = 0; i < NUM_VARY; i++) {
        const history *of = &self->of[i];
        if (of->law->shortest_time) shortest = fmin(shortest, of->law->shortest_time(of));
    }
    return shortest;
}

double histories_smooth_time(const ehd_histories *self) {
    double shortest = INFINITY;
    for (int i = 0; i < NUM_VARY; i++) {
        const history *of = &self->of[i];
        bool jump;
        if (of->law->shortest_time && kink_after(of, -INFINITY, &jump) == INFINITY)
            shortest = fmin(shortest, of->law->shortest_time(of));
    }
    return shortest;
}
