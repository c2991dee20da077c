/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Histories of a transient scene: values, kinks, and inputs that are refused before any work. */
#include "common/time/history.h"
#include "tests/unit/allocation.h"
#include "tests/unit/check.h"
#include "tests/unit/folder.h"

#include <hdf5.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void write_file(const char *name, const char *text) {
    FILE *file = fopen(name, "wb");
    assert_non_null(file);
    assert_int_equal(fputs(text, file) >= 0, 1);
    assert_int_equal(fclose(file), 0);
}

// ---- scenes

/* Returns a scene that ends at T = 2, with these histories. An `approach` replaces the load. */
static scene scene_of(const char *histories) {
    char text[1024];
    scene of;
    ehd_error error = {""};
    snprintf(
        text, sizeof text,
        "contact: line\nregime: transient\ntransport: upwind\nmoes: {M: 12, L: 12}\nclosure: %s\n"
        "lubricant: {viscosity: {law: barus, alpha: 1e-8}}\ntransient: {end_time: 2%s%s}\n",
        strstr(histories, "approach") ? "approach" : "load", *histories ? ", " : "", histories);
    const ehd_status status = scene_parse(&of, text, strlen(text), "s.yml", NULL, 0, &error);
    if (status) fail_msg("status %d: %s", status, error.text);
    return of;
}

static ehd_histories *accepts(const char *histories) {
    const scene of = scene_of(histories);
    ehd_histories *self;
    ehd_error error = {""};
    const ehd_status status = histories_init(&self, &of, &error);
    if (status) fail_msg("status %d: %s", status, error.text);
    return self;
}

static void refuses_with(ehd_status expected, const char *histories, const char *part) {
    const scene of = scene_of(histories);
    ehd_histories *self = (ehd_histories *)&self;
    ehd_error error = {""};
    const ehd_status status = histories_init(&self, &of, &error);
    if (status != expected || !strstr(error.text, part) || strchr(error.text, '\n') || self)
        fail_msg("status %d, text \"%s\", expected \"%s\"", status, error.text, part);
}

/* Checks that with transport along the path, only reduced models refuse a speed that reverses. */
static void is_refused_by_reduced_models(const char *speed, const char *part) {
    scene of = scene_of(speed);
    ehd_histories *self;
    ehd_error error = {""};
    strcpy(of.transport, "path");
    assert_int_equal(histories_init(&self, &of, &error), EHD_OK);
    assert_true(histories_reverse(self));
    histories_free(self);
    if (histories_init_forward(&self, &of, &error) != EHD_DATA || !strstr(error.text, part) || self)
        fail_msg("text \"%s\", expected \"%s\"", error.text, part);
}

static void refuses(const char *histories, const char *part) {
    refuses_with(EHD_DATA, histories, part);
}

static double value_at(const ehd_histories *self, int quantity, double time) {
    double value[NUM_VARY];
    histories_at(value, self, time);
    return value[quantity];
}

/* Compares the load's factor at some points in time. */
static void check_load(const char *histories, size_t count, const double *times,
                       const double *expected, double tolerance) {
    ehd_histories *self = accepts(histories);
    for (size_t i = 0; i < count; i++)
        check_close(value_at(self, VARY_LOAD, times[i]), expected[i], 0, tolerance);
    histories_free(self);
}

// ---- values

static void nothing_varies_without_a_law(void **state) {
    bool jump = true;
    scene of;
    ehd_histories *self;
    (void)state;
    scene_defaults(&of); // a stationary scene
    assert_int_equal(histories_init(&self, &of, NULL), EHD_OK);
    for (int i = 0; i < NUM_VARY; i++)
        check_close(value_at(self, i, 7.5), 1, 0, 0);
    check_close(histories_next_kink(self, 0, &jump), INFINITY, 0, 0);
    assert_false(jump);
    check_close(histories_shortest_time(self), INFINITY, 0, 0);
    assert_null(histories_free(self));
    assert_null(histories_free(NULL));
}

static void sine_and_ramp_have_their_values(void **state) {
    (void)state;
    check_load("load: {law: sine, amplitude: 0.1, period: 0.5}", 5,
               (double[]){0, 0.125, 0.25, 0.375, 1.625}, (double[]){1, 1.1, 1, 0.9, 1.1}, 1e-15);
    check_load("load: {law: sine, amplitude: 0.5, period: 4, phase: 1.5707963267948966}", 3,
               (double[]){0, 1, 2}, (double[]){1.5, 1, 0.5}, 1e-15);
    check_load("load: {law: sine, mean: 3, amplitude: 2, period: 4}", 4, (double[]){0, 1, 2, 3},
               (double[]){3, 5, 3, 1}, 1e-15);
    check_load("load: {law: ramp, from: 2, to: 4, start: 0.5, duration: 0.5}", 6,
               (double[]){0, 0.5, 0.625, 0.75, 1, 2}, (double[]){2, 2, 2.5, 3, 4, 4}, 1e-15);
    check_load("load: {law: ramp, to: 0.5, duration: 2}", 2, (double[]){1, 2},
               (double[]){0.75, 0.5}, 0);
}

/* A time step that ends at the jump has the value before the jump. */
static void step_is_continuous_from_the_left(void **state) {
    (void)state;
    check_load("load: {law: step, from: 2, to: 3, at: 0.5}", 4,
               (double[]){0, 0.5, nextafter(0.5, 1), 2}, (double[]){2, 2, 3, 3}, 0);
    check_load("load: {law: step, to: 3, at: 0}", 2, (double[]){0, nextafter(0, 1)},
               (double[]){1, 3}, 0);
}

static void tables_are_read_between_their_times(void **state) {
    (void)state;
    write_file("hat.csv", "\xef\xbb\xbf# made by hand\nT , R, F\n\n-1,7,2\r\n 0 ,7, 3\n1,7,2\n"
                          "# the end\n2.5,7,5");
    check_load("load: {law: table, file: hat.csv, column: F, interpolation: linear}", 6,
               (double[]){-2, -0.5, 0, 0.25, 1.75, 3}, (double[]){2, 2.5, 3, 2.75, 3.5, 5}, 1e-15);
    // the natural spline through 0, 1, 0 is 1.5 s - 0.5 s^3 in the first interval
    write_file("arc.csv", "T,F\n0,1\n1,2\n2,1\n");
    check_load("load: {law: table, file: arc.csv, column: F}", 6, (double[]){0, 0.5, 1, 1.5, 2, 9},
               (double[]){1, 1.6875, 2, 1.6875, 1, 1}, 1e-15);
    // the spline of a straight line is this line
    write_file("line.csv", "T,F\n-1,1\n0.5,2.5\n0.625,2.625\n3,5\n");
    check_load("load: {law: table, file: line.csv, column: F}", 4, (double[]){-0.5, 0.25, 0.6, 2},
               (double[]){1.5, 2.25, 2.6, 4}, 1e-15);
}

/* The path of the fluid is the integral of the speed from time 0 on. Away from kinks its slope, by
 * central differences, equals the speed. At kinks the path does not jump. */
static void check_path(const char *histories) {
    const double step = 1e-4;
    ehd_histories *self = accepts(histories);
    check_close(histories_path(self, 0), 0, 0, 1e-15);
    for (double time = 0.013; time < 1.99; time += 0.031) {
        double before = histories_path(self, time - step),
               after = histories_path(self, time + step);
        check_close((after - before) / (2 * step), value_at(self, VARY_SPEED, time), 0, 1e-6);
    }
    bool jump;
    for (double kink = histories_next_kink(self, 0, &jump); kink < 2;
         kink = histories_next_kink(self, kink, &jump))
        check_close(histories_path(self, kink - 1e-9), histories_path(self, kink + 1e-9), 0, 1e-8);
    histories_free(self);
}

static void path_is_the_integral_of_the_speed(void **state) {
    (void)state;
    check_path("load: {law: sine, amplitude: 0.1, period: 0.5}");
    check_path("speed: {law: sine, amplitude: 0.7, period: 0.8, phase: 0.4}");
    check_path("speed: {law: sine, mean: 0.9, amplitude: 0.7, period: 0.8, phase: 0.4}");
    check_path("speed: {law: ramp, from: 2, to: 0.5, start: 0.5, duration: 0.7}");
    check_path("speed: {law: ramp, from: 0, to: 3, start: -0.5, duration: 0.9}");
    check_path("speed: {law: ramp, from: 0, to: 3, start: -2, duration: 1}");
    check_path("speed: {law: step, from: 1, to: 2.5, at: 0.7}");
    write_file("path.csv", "t,u\n-0.5,1\n0.2,2\n0.9,0.5\n1.4,0\n2,3\n");
    check_path("speed: {law: table, file: path.csv, column: u, interpolation: linear}");
    write_file("path.csv", "t,u\n-0.5,1\n0.2,2\n0.9,1.5\n1.4,1\n2,3\n");
    check_path("speed: {law: table, file: path.csv, column: u}");
}

static void five_quantities_vary_apart(void **state) {
    static const double expected[] = {1, 0.75, 1.25, 2, -3};
    double value[NUM_VARY];
    (void)state;
    ehd_histories *self = accepts("speed: {law: ramp, to: 0.5, duration: 2}, "
                                  "radius: {law: sine, amplitude: 0.25, period: 4}, "
                                  "modulus: {law: step, to: 2, at: 0.5}, "
                                  "approach: {law: step, to: -3, at: 0.25}");
    histories_at(value, self, 1);
    check_close_array(value, expected, NUM_VARY, 0, 1e-15);
    histories_free(self);
}

// ---- events and time scales

static void check_events(const char *histories, size_t count, const double *times,
                         const bool *jumps) {
    ehd_histories *self = accepts(histories);
    double time = 0;
    bool jump;
    for (size_t i = 0; i < count; i++) {
        time = histories_next_kink(self, time, &jump);
        check_close(time, times[i], 0, 0);
        assert_int_equal(jump, jumps[i]);
    }
    check_close(histories_next_kink(self, time, &jump), INFINITY, 0, 0);
    assert_false(jump);
    histories_free(self);
}

static void kinks_and_jumps_come_in_order(void **state) {
    (void)state;
    check_events("load: {law: sine, amplitude: 0.1, period: 0.5}", 0, NULL, NULL);
    check_events("load: {law: ramp, to: 2, start: 0.5, duration: 1}, "
                 "speed: {law: step, to: 2, at: 0.75}, modulus: {law: step, to: 2, at: 1.5}, "
                 "radius: {law: ramp, to: 2, start: -1, duration: 2}",
                 4, (double[]){0.5, 0.75, 1, 1.5}, (bool[]){false, true, false, true});
    // a kink and a jump at the same time count as a jump, whichever comes first in the scene
    check_events("load: {law: ramp, to: 2, start: 0.5, duration: 1}, "
                 "speed: {law: step, to: 2, at: 0.5}",
                 2, (double[]){0.5, 1.5}, (bool[]){true, false});
    check_events("load: {law: step, to: 2, at: 0.5}, "
                 "speed: {law: ramp, to: 2, start: 0.5, duration: 1}",
                 2, (double[]){0.5, 1.5}, (bool[]){true, false});
    write_file("hat.csv", "T,F\n-1,2\n-0.5,3\n1,2\n2.5,5\n");
    check_events("load: {law: table, file: hat.csv, column: F, interpolation: linear}", 2,
                 (double[]){1, 2.5}, (bool[]){false, false});
    check_events("load: {law: table, file: hat.csv, column: F}", 0, NULL, NULL);
}

static void check_scale(double (*scale)(const ehd_histories *), const char *histories,
                        double expected) {
    ehd_histories *self = accepts(histories);
    check_close(scale(self), expected, 1e-15, 0);
    histories_free(self);
}

static void the_shortest_time_scale_is_found(void **state) {
    (void)state;
    write_file("hat.csv", "T,F\n0,2\n1,3\n1.25,2\n2.5,5\n");
    check_scale(histories_shortest_time, "load: {law: step, to: 2, at: 1}", INFINITY);
    check_scale(histories_shortest_time, "load: {law: sine, amplitude: 0, period: 1}", INFINITY);
    check_scale(histories_shortest_time, "load: {law: ramp, from: 2, to: 2, duration: 1}",
                INFINITY);
    check_scale(histories_shortest_time, "load: {law: sine, amplitude: 0.1, period: 0.5}",
                0.5 / (2 * M_PI));
    check_scale(histories_shortest_time, "load: {law: table, file: hat.csv, column: F}", 0.25);
    check_scale(histories_shortest_time,
                "load: {law: sine, amplitude: 0.1, period: 1}, "
                "speed: {law: ramp, to: 2, duration: 0.125}",
                0.125);
}

static void kinks_need_no_smooth_time_scale(void **state) {
    (void)state;
    write_file("hat.csv", "T,F\n0,2\n1,3\n1.25,2\n2.5,5\n");
    check_scale(histories_smooth_time, "load: {law: step, to: 2, at: 1}", INFINITY);
    check_scale(histories_smooth_time,
                "load: {law: table, file: hat.csv, column: F, interpolation: linear}", INFINITY);
    check_scale(histories_smooth_time, "load: {law: table, file: hat.csv, column: F}", 0.25);
    check_scale(histories_smooth_time,
                "load: {law: sine, amplitude: 0.1, period: 1}, "
                "speed: {law: ramp, to: 2, duration: 0.125}",
                1 / (2 * M_PI));
}

// ---- values that are not positive

static void histories_that_reach_zero_are_refused(void **state) {
    (void)state;
    refuses("load: {law: sine, amplitude: 1.5, period: 1}",
            "transient.load: found -0.5 at T = 0.75, expected at least 0");
    refuses("radius: {law: sine, amplitude: -1.5, period: 1}",
            "transient.radius: found -0.5 at T = 0.25, expected more than 0");
    refuses("modulus: {law: sine, amplitude: 1, period: 4, phase: 3.141592653589793}",
            "transient.modulus: found 0 at T = 1");
    histories_free(accepts("radius: {law: sine, amplitude: 0.999999, period: 1}"));
    // the troughs of the sine lie after the end and before the start
    histories_free(accepts("load: {law: sine, amplitude: 1.5, period: 4}"));
    refuses("load: {law: sine, amplitude: 1.5, period: 3}", "found -0.299038 at T = 2");
    refuses("radius: {law: ramp, to: 0, duration: 2}", "transient.radius: found 0 at T = 2");
    histories_free(accepts("radius: {law: ramp, to: 0, duration: 2.001}"));
    refuses("load: {law: ramp, from: -1, to: 2, start: 1, duration: 1}", "found -1 at T = 0");
    refuses("modulus: {law: step, to: -0.5, at: 1.999}", "transient.modulus: found -0.5 at T = 2");
    histories_free(accepts("modulus: {law: step, to: -0.5, at: 2}"));
    histories_free(accepts("approach: {law: sine, amplitude: 5, period: 1}"));
}

/* A contact may lose its load, but not in training. */
static void a_load_may_be_zero(void **state) {
    (void)state;
    const char *const load = "load: {law: sine, amplitude: 1, period: 1}";
    const scene of = scene_of(load);
    ehd_histories *self = accepts(load);
    ehd_error error = {""};
    double values[NUM_VARY];
    histories_at(values, self, 0.75);
    assert_true(values[VARY_LOAD] >= 0 && values[VARY_LOAD] < 1e-15);
    histories_free(self);
    assert_int_equal(histories_init_training(&self, &of, &error), EHD_DATA);
    assert_string_equal(error.text,
                        "transient.load: found 0 at T = 0.75, expected more than 0 in training");
    assert_null(self);
}

static void a_reversal_is_refused_but_not_rest(void **state) {
    (void)state;
    refuses("speed: {law: sine, amplitude: 1.01, period: 1}",
            "transient.speed: found -0.01 at T = 0.75, expected at least 0; transport: path can "
            "reverse");
    refuses("speed: {law: step, to: -1, at: 1}", "transient.speed: found -1 at T = 2");
    refuses("start_speed: -0.5", "transient.start_speed: found -0.5, expected at least 0; trans");
    is_refused_by_reduced_models("speed: {law: sine, mean: 0, amplitude: 1, period: 2}",
                                 "transient.speed: found -1 at T = 1.5, expected at least 0 with a "
                                 "reduced model, which is of one direction");
    is_refused_by_reduced_models("start_speed: -1", "transient.start_speed: found -1");
    ehd_histories *self = accepts("speed: {law: sine, amplitude: 1, period: 1}");
    assert_false(histories_reverse(self));
    check_close(value_at(self, VARY_SPEED, 0.75), 0, 0, 0);
    histories_free(self);
    self = accepts("speed: {law: ramp, to: 0, duration: 0.3}");
    for (double time = 0.29; time < 0.31; time += 1e-4)
        assert_true(value_at(self, VARY_SPEED, time) >= 0);
    check_close(value_at(self, VARY_SPEED, 2), 0, 0, 0);
    histories_free(self);
}

/* The values at all knots are positive. The second derivative of the spline is 1.14 at the inner
 * knots. Midway between these knots the value is therefore negative: 0.05 - 1.14/8. */
static void splines_are_checked_between_their_knots(void **state) {
    (void)state;
    write_file("dip.csv", "T,F\n-1,1\n0,0.05\n1,0.05\n2,1\n");
    refuses("load: {law: table, file: dip.csv, column: F}",
            "transient.load: found -0.0925 at T = 0.5, expected at least 0");
    refuses("speed: {law: table, file: dip.csv, column: F}", "found -0.0925 at T = 0.5");
    histories_free(accepts("approach: {law: table, file: dip.csv, column: F}"));
    histories_free(accepts("load: {law: table, file: dip.csv, column: F, interpolation: linear}"));
    // values before the start or after the end of the run do not matter
    write_file("dip.csv", "T,F\n-3,1\n-2,0.05\n-1,0.05\n0,1\n2,1\n3,-1\n");
    histories_free(accepts("load: {law: table, file: dip.csv, column: F}"));
    write_file("dip.csv", "T,F\n0,1\n0.5,-1\n1,1\n2,1\n");
    refuses("load: {law: table, file: dip.csv, column: F, interpolation: linear}",
            "transient.load: found -1 at T = 0.5");
}

// ---- faults of tables

/* Checks that a table of the load with this text is refused. */
static void refuses_table(const char *text, const char *part) {
    write_file("bad.csv", text);
    refuses("load: {law: table, file: bad.csv, column: F, interpolation: linear}", part);
}

static void bad_csv_tables_are_refused(void **state) {
    (void)state;
    refuses_with(EHD_NOINPUT, "load: {law: table, file: none.csv, column: F}",
                 "none.csv: found nothing (No such file");
    refuses_with(EHD_NOINPUT, "load: {law: table, file: /tmp, column: F}", "found a folder");
    refuses_table("", "bad.csv: found an empty file, expected a header");
    refuses_table("# T,F\n", "bad.csv: found an empty file");
    refuses_table("\nT,G\n0,1\n2,1\n", "bad.csv:2: found the columns T, G, expected a column F");
    refuses_table("T,F\n", "bad.csv: found 0 rows, expected at least 2 (linear)");
    refuses_table("T,F\n0,1\n", "bad.csv: found 1 row, expected at least 2");
    refuses_table("T,F\n0,1\n#\n1,x\n2,1\n", "bad.csv:4: F: found x, expected a number");
    refuses_table("T,F\n0,1\n1 1,1\n2,1\n", "bad.csv:3: T: found 1 1, expected a number");
    refuses_table("T,F\n0,1\n1,nan\n2,1\n", "bad.csv:3: F: found nan, expected a number");
    refuses_table("T,F\n0,1\n1,1e999\n2,1\n", "bad.csv:3: F: found 1e999, expected a number");
    refuses_table("T,F\n0,1\n1\n2,1\n", "bad.csv:3: found 1 column, expected 2 as in the header");
    refuses_table("T,F\n0,1\n1,1,1\n2,1\n", "bad.csv:3: found 3 columns, expected 2");
    refuses_table("T,F\n0,1\n1,1\n1,1\n2,1\n", "bad.csv: found the time 1 in row 3, expected at "
                                               "least 1e-09 after 1 in the row before");
    refuses_table("T,F\n0,1\n2,1\n1,1\n", "bad.csv: found the time 1 in row 3, expected");
    refuses_table("T,F\n0,1\n2e12,1\n", "found the time 2e+12 in row 2, expected one from -1e+12");
    refuses_table("T,F\n0,1\n1,2e5\n2,1\n", "bad.csv: F: found 200000 in row 2, expected a factor "
                                            "on the reference value from -1000 to 1000");
    refuses_table("T,F\n0,1\n1,\n2,1\n", "bad.csv:3: F: found nothing, expected a number");
    refuses_table("T,F\n0.1,1\n2,1\n", "bad.csv: found 0.1 as first time, expected 0 or before");
    refuses_table("T,F\n0,1\n1.99,1\n",
                  "bad.csv: found 1.99 as last time, expected transient.end_time = 2 or after");
    write_file("bad.csv", "T,F\n0,1\n2,1\n");
    refuses("load: {law: table, file: bad.csv, column: F}",
            "bad.csv: found 2 rows, expected at least 3 (spline)");
}

/* The column of time is found by its name, at any position and in files of any program. */
static void csv_columns_are_found_by_name(void **state) {
    static const char *const texts[] = {
        ",T,F\n0,0,1\n1,1,2\n2,2,1\n", // an index in front, from pandas
        "F,T\n1,0\n2,1\n1,2\n",        // columns exchanged
        "\xef\xbb\xbf\"t\",\"F\"\r\n\"0\",1\r\n1,\"2\"\r\n2 , 1\r\n", // quotes, from a spreadsheet
        "time,,F,\n0,x,1,\n1,,2,\n2,y,1,\n",                          // other columns are not read
        "\"a, \"\"b\"\"\",F,T\n\"1,2\",1,0\n\"\",2,1\n7,1,2\n"};
    (void)state;
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        write_file("named.csv", texts[i]);
        check_load("load: {law: table, file: named.csv, column: F}", 3, (double[]){0, 0.5, 1.5},
                   (double[]){1, 1.6875, 1.6875}, 1e-15);
    }
    // columns are separated by semicolons or tabs, if there are no commas outside of quotes; a
    // quoted text may span lines
    write_file("named.csv", "T;\"F, kN\";F\n0;9;1\n1;9;2\n2;9;1\n");
    check_load("load: {law: table, file: named.csv, column: F}", 2, (double[]){0, 0.5},
               (double[]){1, 1.6875}, 1e-15);
    write_file("named.csv", "T\tnote\tF\n0\t\t1\n1\t\"a\n\n#\tb\"\"\"\t2\n2\ta;b\t1\n");
    check_load("load: {law: table, file: named.csv, column: F}", 2, (double[]){0, 0.5},
               (double[]){1, 1.6875}, 1e-15);
    write_file("named.csv", "T,\"u, m/s\"\n0,1\n1,2\n2,1\n");
    check_load("load: {law: table, file: named.csv, column: 'u, m/s'}", 2, (double[]){0, 0.5},
               (double[]){1, 1.6875}, 1e-15);
}

static void csv_columns_without_the_right_names_are_refused(void **state) {
    (void)state;
    refuses_table("0,1\n1,2\n", "bad.csv:1: found the columns 0, 1, expected a column time|T|t");
    refuses_table("seconds,F\n0,1\n2,1\n", "found the columns seconds, F, expected a column time");
    refuses_table(",T,G\n0,0,1\n", "found the columns (no name), T, G, expected a column F");
    refuses_table("T,time,F\n0,0,1\n1,2,1\n",
                  "found the columns T, time, F, expected only one column time|T|t");
    refuses_table("T,F,F\n0,1,2\n2,1,3\n",
                  "bad.csv:1: F: found again in the columns T, F, F, expected only once");
    refuses_table("T,F,a,a\n0,1,2,3\n2,1,3,4\n", "bad.csv:1: a: found again in the columns");
    refuses_table("T;F\n0;1,5,2\n2;1\n", "bad.csv:2: F: found 1,5,2, expected a number");
    refuses_table("\"T,F\n0,1\n2,1\n",
                  "bad.csv:1: found a quote that does not end, expected its end");
    refuses_table("T,F\n0,1\n\"2\n,1\n", "bad.csv:3: found a quote that does not end");
    refuses_table("T,F\n0,\"1\"2\n2,1\n", "bad.csv:2: F: found \"1\"2, expected a number");
}

// ---- HDF5

static void put(hid_t file, const char *name, hid_t type, int rank, const hsize_t *lengths,
                const void *values) {
    const hid_t space = H5Screate_simple(rank, lengths, NULL);
    const hid_t data = H5Dcreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(data >= 0);
    assert_true(H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
    H5Dclose(data);
    H5Sclose(space);
}

static void write_hdf5(const char *name) {
    static const double time[] = {0, 1, 2}, arc[] = {1, 2, 1}, hole[] = {1, NAN, 1};
    static const int whole[] = {1, 2, 1};
    static const char word[] = "abc";
    const hid_t file = H5Fcreate(name, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(file >= 0);
    put(file, "time", H5T_NATIVE_DOUBLE, 1, (hsize_t[]){3}, time);
    put(file, "arc", H5T_NATIVE_DOUBLE, 1, (hsize_t[]){3}, arc);
    put(file, "whole", H5T_NATIVE_INT, 1, (hsize_t[]){3}, whole);
    put(file, "hole", H5T_NATIVE_DOUBLE, 1, (hsize_t[]){3}, hole);
    put(file, "short", H5T_NATIVE_DOUBLE, 1, (hsize_t[]){2}, arc);
    put(file, "flat", H5T_NATIVE_DOUBLE, 2, (hsize_t[]){3, 1}, arc);
    put(file, "words", H5T_C_S1, 1, (hsize_t[]){3}, word);
    H5Gclose(H5Gcreate2(file, "group", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    H5Fclose(file);
}

static void hdf5_tables_are_read(void **state) {
    static const char *const histories[] = {"load: {law: table, file: t.h5, column: arc}",
                                            "load: {law: table, file: t.hdf5, column: whole}"};
    (void)state;
    write_hdf5("t.h5");
    write_hdf5("t.hdf5");
    for (size_t i = 0; i < 2; i++)
        check_load(histories[i], 3, (double[]){0, 0.5, 1.5}, (double[]){1, 1.6875, 1.6875}, 1e-15);
}

static void bad_hdf5_tables_are_refused(void **state) {
    (void)state;
    write_hdf5("t.h5");
    refuses_with(EHD_NOINPUT, "load: {law: table, file: none.h5, column: arc}",
                 "none.h5: found No such file");
    refuses("load: {law: table, file: t.h5, column: ark}",
            "t.h5: found no dataset ark among arc, flat, group, hole, short, ");
    refuses("load: {law: table, file: t.h5, column: group}", "t.h5: group: found no dataset");
    refuses("load: {law: table, file: t.h5, column: a/b}", "t.h5: found no dataset a/b");
    refuses("load: {law: table, file: t.h5, column: flat}",
            "t.h5: flat: found something else, expected numbers along one axis");
    refuses("load: {law: table, file: t.h5, column: words}", "t.h5: words: found something else");
    refuses("load: {law: table, file: t.h5, column: short}",
            "t.h5: short: found 2 numbers, expected 3 as of time");
    refuses("load: {law: table, file: t.h5, column: hole}", "t.h5: hole: found nan in row 2");
    write_file("text.h5", "T,F\n0,1\n2,1\n");
    refuses("load: {law: table, file: text.h5, column: F}", "text.h5: found no whole HDF5 file");
    assert_int_equal(truncate("t.h5", 900), 0);
    refuses("load: {law: table, file: t.h5, column: arc}", "t.h5: found no whole HDF5 file");
}

// ---- threads and memory

enum { NUM_TIMES = 20000 };

static void *sum_values(void *shared) {
    const ehd_histories *self = shared;
    double *sum = calloc(1, sizeof *sum), value[NUM_VARY];
    for (int i = 0; sum && i < NUM_TIMES; i++) {
        histories_at(value, self, 2. * i / NUM_TIMES);
        *sum += value[VARY_LOAD] + value[VARY_SPEED];
    }
    return sum;
}

static void threads_share_histories(void **state) {
    pthread_t other;
    void *theirs;
    (void)state;
    write_file("arc.csv", "T,F\n0,1\n0.2,2\n0.5,1\n0.9,3\n1,4\n1.7,2\n2,1\n");
    ehd_histories *self = accepts("load: {law: table, file: arc.csv, column: F}, "
                                  "speed: {law: table, file: arc.csv, column: F, "
                                  "interpolation: linear}");
    assert_int_equal(pthread_create(&other, NULL, sum_values, self), 0);
    double *ours = sum_values(self);
    assert_int_equal(pthread_join(other, &theirs), 0);
    assert_true(ours && theirs);
    check_close(*ours, *(double *)theirs, 0, 0);
    free(ours);
    free(theirs);
    histories_free(self);
}

static void survives_failing_allocations(void **state) {
    ehd_histories *self;
    ehd_error error;
    size_t call = 0;
    (void)state;
    write_file("arc.csv", "T,F\n0,1\n1,2\n2,1\n");
    write_hdf5("t.h5");
    const scene of = scene_of("load: {law: table, file: arc.csv, column: F}, "
                              "speed: {law: table, file: t.h5, column: arc}");
    for (bool failed = true; failed; call++) {
        error.text[0] = '\0';
        allocation_fail_at(call);
        const ehd_status status = histories_init(&self, &of, &error);
        failed = allocation_failed();
        assert_int_equal(status, failed ? EHD_MEMORY : EHD_OK);
        if (failed) assert_non_null(strstr(error.text, "out of memory"));
        histories_free(self);
    }
    assert_true(call > 6);
}

// ---- units

/* Returns the factors of load and speed, at T = 1, of tables in a scene in SI units. Its unit of
 * time is a/u = 0.25 ms, its load is 200 N/mm, its speed 0.8 m/s. */
static void units_at(double value[NUM_VARY], const char *table, const char *keys) {
    char text[1024];
    ehd_error error = {""};
    ehd_histories *self;
    scene of;
    write_file("units.csv", table);
    snprintf(text, sizeof text,
             "contact: line\nregime: transient\nphysical: {load: 200 N/mm, radius: %.17g, speed: "
             "0.8, modulus: 200 GPa, viscosity: 0.1}\nlubricant.viscosity: {law: barus, alpha: "
             "2e-8}\ntransient: {end_time: 2, %s}\n",
             4e-8 * M_PI * 200e9 / (8 * 200e3), keys);
    if (scene_parse(&of, text, strlen(text), "s.yml", NULL, 0, &error) ||
        histories_init(&self, &of, &error))
        fail_msg("%s", error.text);
    histories_at(value, self, 1);
    histories_free(self);
}

static void tables_may_have_units(void **state) {
    (void)state;
    static const char linear[] = "interpolation: linear";
    static const struct {
        const char *table, *load, *speed, *time;
    } given[] = {
        {"T,F,u\n0,1,1\n2,2,3\n", "", "", ""},
        {"t [ms],F [N/mm],u (m/s)\n0,200,0.8\n0.5,400,2.4\n", "", "", ""},
        {"time;F;u\n0;200;0,8\n0,0005;400;2,4\n", ", unit: kN/m", ", unit: m/s", "unit: s"},
        {"clock,F [kN/m],u\n0,200000,800\n500,400000,2400\n", ", unit: N/m", ", unit: mm/s",
         "column: clock, unit: us"},
        {"t [s],F [N/mm],u\n0,200,1\n0.0005,400,3\n", "", ", unit: factor", ""}};
    for (size_t i = 0; i < sizeof given / sizeof *given; i++) {
        double value[NUM_VARY];
        char keys[512];
        snprintf(keys, sizeof keys,
                 "time: {%s}, load: {law: table, file: units.csv, column: F, %s%s}, speed: {law: "
                 "table, file: units.csv, column: u, %s%s}",
                 given[i].time, linear, given[i].load, linear, given[i].speed);
        if (!*given[i].time) memmove(keys, keys + strlen("time: {}, "), strlen(keys));
        units_at(value, given[i].table, keys);
        check_close(value[VARY_LOAD], 1.5, 1e-14, 0);
        check_close(value[VARY_SPEED], 2, 1e-14, 0);
    }
}

static void wrong_units_of_tables_are_refused(void **state) {
    (void)state;
    write_file("units.csv", "T,F [N/mm],G\n0,1,1\n2,2,3\n");
    refuses_with(
        EHD_DATA, "load: {law: table, file: units.csv, column: F, interpolation: linear}",
        "transient.load.unit: found the unit N/mm in a scene without physical, expected factor");
    refuses_with(
        EHD_DATA, "load: {law: table, file: units.csv, column: G, unit: mm, interpolation: linear}",
        "units.csv: transient.load.unit: found the unit mm, expected factor, N/m, N/mm, kN/m");
    write_file("units.csv", "T,F [N/mm],F [N/m]\n0,1,1\n2,2,3\n");
    refuses_with(EHD_DATA, "load: {law: table, file: units.csv, column: F, interpolation: linear}",
                 "units.csv:1: found the columns T, F, F, expected only one column F");
    write_file("units.csv", "T,F [N/mm],G\n0,1,1\n2,2,3\n");
    refuses_with(EHD_DATA,
                 "time: {unit: ms}, load: {law: table, file: units.csv, column: G, interpolation: "
                 "linear}",
                 "transient.time.unit: found the unit ms in a scene without physical, expected T");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_varies_without_a_law),
        cmocka_unit_test(sine_and_ramp_have_their_values),
        cmocka_unit_test(step_is_continuous_from_the_left),
        cmocka_unit_test(tables_are_read_between_their_times),
        cmocka_unit_test(path_is_the_integral_of_the_speed),
        cmocka_unit_test(five_quantities_vary_apart),
        cmocka_unit_test(kinks_and_jumps_come_in_order),
        cmocka_unit_test(the_shortest_time_scale_is_found),
        cmocka_unit_test(kinks_need_no_smooth_time_scale),
        cmocka_unit_test(histories_that_reach_zero_are_refused),
        cmocka_unit_test(a_load_may_be_zero),
        cmocka_unit_test(a_reversal_is_refused_but_not_rest),
        cmocka_unit_test(splines_are_checked_between_their_knots),
        cmocka_unit_test(bad_csv_tables_are_refused),
        cmocka_unit_test(csv_columns_are_found_by_name),
        cmocka_unit_test(csv_columns_without_the_right_names_are_refused),
        cmocka_unit_test(hdf5_tables_are_read),
        cmocka_unit_test(bad_hdf5_tables_are_refused),
        cmocka_unit_test(threads_share_histories),
        cmocka_unit_test(survives_failing_allocations),
        cmocka_unit_test(tables_may_have_units),
        cmocka_unit_test(wrong_units_of_tables_are_refused),
    };
    return cmocka_run_group_tests(tests, enter_folder, leave_folder);
}
