/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A waviness, a dent or a table of heights on one of the surfaces. The tests check the heights, the
 * places where they may be, and their effect on films. */
#include "common/time/surface.h"

#include "common/settings/scene_contact.h"
#include "fullrun/previous.h"
#include "tests/unit/check.h"
#include "tests/unit/folder.h"
#include "tests/unit/marched.h"
#include "tests/unit/sample.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static ehd_error error;

/* Adds a surface to a scene; `settings` is a list such as "kind=dent", and ends with NULL. */
static void give(scene *of, const char *const *settings) {
    char key[64];

    for (; *settings; settings++) {
        const char *value = strchr(*settings, '=') + 1;
        snprintf(key, sizeof key, "surface.%.*s", (int)(value - 1 - *settings), *settings);
        if (scene_set(of, key, value, "test", &error)) fail_msg("%s", error.text);
    }
    scene_complete(of);
    if (scene_validate(of, "test", &error)) fail_msg("%s", error.text);
}

#define WITH(...) ((const char *const[]){__VA_ARGS__, NULL})

/* Returns a surface on a line contact from -4 to 2, with a step of 0.05. */
static ehd_surface *surface_of(ehd_contact *reference, const char *const *settings) {
    scene of = marched_scene(20, 5, "incompressible", 0.05, "end_time: 1");
    ehd_surface *self;

    give(&of, settings);
    if (scene_contact(reference, &of, &error) || surface_init(&self, &of, reference, &error))
        fail_msg("%s", error.text);
    return self;
}

static contact_frame frame_at_path(const ehd_contact *reference, double load, double path) {
    const double values[NUM_VARY] = {load, 1, 1, 1, 1};
    contact_frame frame = frame_at(reference->kind, 0, values, NAN);

    frame.path = path;
    return frame;
}

// ---- heights

static void a_dent_has_the_shape_of_its_formula(void **state) {
    (void)state;
    const double radius = 0.2, depth = 0.07;
    ehd_contact reference;
    ehd_surface *self = surface_of(
        &reference, WITH("kind=dent", "depth=0.07", "radius=0.2", "position=-5", "speed=0.5"));
    const contact_frame frame = frame_at_path(&reference, 1, 9); // the dent's centre is at -0.5
    check_close(surface_position(self, 9), -0.5, 1e-15, 0);
    check_close(surface_height(self, &frame, -0.5, 0), depth, 1e-14, 0);
    for (double x = -1.4; x < 0.5; x += 0.0371) {
        const double r = hypot(x + 0.5, 0.05);
        check_close(surface_height(self, &frame, x, 0.05),
                    r < 3.6 * radius ? depth * cos(M_PI * r / (2.4 * radius)) *
                                           exp(-2 * r * r / (1.44 * radius * radius))
                                     : 0,
                    1e-12, 1e-17);
    }
    surface_free(self);
}

static void a_waviness_ends_where_it_is(void **state) {
    (void)state;
    ehd_contact reference;
    ehd_surface *self =
        surface_of(&reference, WITH("kind=sine", "amplitude=0.02", "wavelength=0.5", "phase=0.3"));
    const double end = -4.05; // the first boundary node
    const contact_frame frame = frame_at_path(&reference, 1, 5);
    check_close(surface_position(self, 0), end, 1e-14, 0);
    for (double x = -2; x < 2; x += 0.0371) {
        const double behind = end + 5 - x;
        const double height = 0.02 * sin(-2 * M_PI * behind / 0.5 + 0.3);
        const double found = surface_height(self, &frame, x, 0.7);
        if (behind <= 0) check_close(found, 0, 0, 0);
        if (behind >= 0.5) check_close(found, height, 1e-11, 1e-14);
        if (behind > 0 && behind < 0.5) assert_true(fabs(found) <= fabs(height));
    }
    surface_free(self);
    // a surface with negative speed comes from the other side
    self =
        surface_of(&reference, WITH("kind=sine", "amplitude=0.02", "wavelength=0.5", "speed=-1"));
    check_close(surface_position(self, 0), 2.05, 1e-14, 0);
    check_close(surface_height(self, &frame, -3.5, 0), 0, 0, 0);
    check_close(surface_height(self, &frame, -2.95 + 0.625, 0), 0.02, 1e-9, 0);
    surface_free(self);
}

/* The physical height and place of a dent do not depend on the frame. */
static void a_surface_keeps_its_size_as_the_contact_grows(void **state) {
    (void)state;
    ehd_contact reference;
    ehd_surface *self =
        surface_of(&reference, WITH("kind=dent", "depth=0.07", "radius=0.2", "position=-6"));
    const contact_frame small = frame_at_path(&reference, 1, 5.6),
                        large = frame_at_path(&reference, 2, 5.6);
    assert_true(large.half_width > 1.4);
    for (double x = -1; x < 0.3; x += 0.09)
        check_close(surface_height(self, &large, x / large.half_width, 0) * large.film_scale,
                    surface_height(self, &small, x, 0), 1e-13, 1e-17);
    surface_free(self);
}

static void a_table_is_a_spline_through_its_rows(void **state) {
    (void)state;
    ehd_contact reference;
    FILE *file = fopen("heights.csv", "w");
    assert_non_null(file);
    fputs(",x,height\n", file);     // the first column is an index, as pandas writes it
    for (int i = -20; i <= 20; i++) // the heights at the ends are round-off
        fprintf(file, "%d,%.17g,%.17g\n", i + 20, 0.02 * i,
                abs(i) == 20 ? 5e-25 : 0.03 * pow(1 - i * i / 400., 3));
    fclose(file);
    ehd_surface *self = surface_of(&reference, WITH("kind=file", "file=heights.csv",
                                                    "column=height", "position=-5", "speed=2"));
    const contact_frame frame = frame_at_path(&reference, 1, 2.5); // the table's x = 0 is at 0
    for (double x = -0.5; x < 0.5; x += 0.0131) {
        const double s = x / 0.4;
        check_close(surface_height(self, &frame, x, 1), fabs(s) < 1 ? 0.03 * pow(1 - s * s, 3) : 0,
                    0, 2e-6);
    }
    surface_free(self);
}

/* Writes the heights of a dent on a grid of x and y, which is not uniform across. */
static void write_dent(const char *name, double aside) {
    FILE *file = fopen(name, "w");
    assert_non_null(file);
    fputs("x,y,height\n", file);
    for (int j = -20; j <= 20; j++)
        for (int i = -24; i <= 24; i++) {
            const double x = 0.03 * i, y = 0.02 * j * (1 + 0.01 * abs(j)) + aside;
            const double r = hypot(x, y - aside) / 0.48;
            const bool edge = abs(i) == 24 || abs(j) == 20;
            fprintf(file, "%.17g,%.17g,%.17g\n", x, y,
                    edge || r >= 1 ? 0 : (0.03 + 1e-15 * j) * pow(1 - r * r, 4));
        }
    fclose(file);
}

static void a_table_may_be_a_grid(void **state) {
    (void)state;
    scene of = marched_point("end_time: 1");
    ehd_contact reference;
    ehd_surface *self;
    write_dent("grid.csv", 0);
    write_dent("aside.csv", 0.1);
    give(&of, WITH("kind=file", "file=grid.csv", "column=height", "across=y", "position=-5"));
    assert_int_equal(scene_contact(&reference, &of, &error), EHD_OK);
    assert_int_equal(surface_init(&self, &of, &reference, &error), EHD_OK);
    const contact_frame frame = frame_at_path(&reference, 1, 5.1); // the table's x = 0 is at 0.1
    double steepest = 0;
    for (double x = -0.9; x < 0.9; x += 0.0131)
        for (double y = -0.6; y < 0.6; y += 0.0171) {
            const double r = hypot(x - 0.1, y) / 0.48;
            const double exact = r < 1 ? 0.03 * pow(1 - r * r, 4) : 0;
            const double found = surface_height(self, &frame, x, y);
            const double beside = surface_height(self, &frame, x, y + 1e-7);
            check_close(found, exact, 0, 4e-5);
            steepest = fmax(steepest, fabs(beside - found) / 1e-7);
        }
    assert_true(steepest > 0.09 && steepest < 0.12); // no jumps between the table's lines
    surface_free(self);
    // with half a grid the heights must be symmetric
    give(&of, WITH("file=aside.csv"));
    assert_int_equal(surface_init(&self, &of, &reference, &error), EHD_DATA);
    assert_non_null(strstr(error.text, "aside.csv: found another height at -y than in row 1"));
    scene_set(&of, "grid.half", "false", NULL, NULL);
    assert_int_equal(scene_contact(&reference, &of, &error), EHD_OK);
    assert_int_equal(surface_init(&self, &of, &reference, &error), EHD_OK);
    check_close(surface_height(self, &frame, 0.1, 0.1), 0.03, 1e-12, 0);
    surface_free(self);
}

/* In a contact that is wider than long, a dent still is round and has the given physical size. */
static void a_dent_is_round_in_an_ellipse(void **state) {
    (void)state;
    ehd_contact reference;
    ehd_surface *self =
        surface_of(&reference, WITH("kind=dent", "depth=1", "radius=0.2", "position=-5"));
    const contact_frame frame = frame_at_path(&reference, 1, 5);
    const double along = surface_height(self, &frame, 0.1, 0);
    surface_free(self);
    scene of = marched_scene(20, 5, "incompressible", 0.05, "end_time: 1");
    scene_set(&of, "contact", "ellipse", NULL, NULL);
    scene_set(&of, "ellipticity", "2", NULL, NULL);
    give(&of, WITH("kind=dent", "depth=1", "radius=0.2", "position=-5"));
    assert_int_equal(scene_contact(&reference, &of, &error), EHD_OK);
    assert_int_equal(surface_init(&self, &of, &reference, &error), EHD_OK);
    check_close(surface_height(self, &frame, 0.1, 0), along, 1e-13, 0);
    check_close(surface_height(self, &frame, 0, 0.05), along, 1e-13, 0); // Y is in units of b
    surface_free(self);
}

// ---- refused surfaces

static void check_refused(const char *expected, const char *const *settings) {
    scene of = marched_scene(20, 5, "incompressible", 0.05, "end_time: 1");
    ehd_contact reference;
    ehd_surface *self;

    give(&of, settings);
    if (scene_contact(&reference, &of, &error)) fail_msg("%s", error.text);
    assert_int_equal(surface_init(&self, &of, &reference, &error), EHD_DATA);
    assert_null(self);
    if (!strstr(error.text, expected)) fail_msg("found %s, expected %s", error.text, expected);
}

/* Writes a text into a file, and returns the setting that names this file. */
static const char *table_of(const char *text) {
    FILE *file = fopen("table.csv", "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
    return "file=table.csv";
}

static void check_unseen(const char *expected, const char *const *settings) {
    ehd_contact reference;
    ehd_surface *self = surface_of(&reference, settings);

    const ehd_status status = surface_check_grid(self, &reference.grid, &error);
    surface_free(self);
    assert_int_equal(status, *expected ? EHD_DATA : EHD_OK);
    if (*expected && !strstr(error.text, expected))
        fail_msg("found %s, expected %s", error.text, expected);
}

/* The grid extends from -4 to 2 in steps of 0.05. A surface is refused if its heights change over
 * too short a distance for this grid, or if it rests outside of this grid. */
static void what_the_grid_does_not_see_is_refused(void **state) {
    (void)state;
    check_unseen("", WITH("kind=sine", "amplitude=0.01", "wavelength=0.2"));
    check_unseen("grid.step: found 0.05 half widths, expected at most 0.0475",
                 WITH("kind=sine", "amplitude=0.01", "wavelength=0.19"));
    check_unseen("", WITH("kind=dent", "depth=0.1", "radius=0.07"));
    check_unseen("grid.step: found 0.05", WITH("kind=dent", "depth=0.1", "radius=0.06"));
    check_unseen("grid.step: found 0.05",
                 WITH("kind=file", table_of("x,h\n0,0\n0.02,1\n0.04,0\n"), "column=h"));
    check_unseen("", WITH("kind=dent", "depth=0.1", "radius=0.1", "speed=0", "position=2.4"));
    check_unseen("surface.position: found 2.5 half widths, expected a surface that rests on the "
                 "grid, from -4.05 to 2.05",
                 WITH("kind=dent", "depth=0.1", "radius=0.1", "speed=0", "position=2.5"));
    check_unseen("surface.position: found -4.5",
                 WITH("kind=dent", "depth=0.1", "radius=0.1", "speed=0", "position=-4.5"));
    // a moving surface may start outside of the grid
    check_unseen("", WITH("kind=dent", "depth=0.1", "radius=0.1", "position=-4.5"));
}

static void what_cannot_be_is_refused(void **state) {
    (void)state;
    check_refused("surface.units: found si", WITH("kind=dent", "depth=1", "radius=1", "units=si"));
    check_refused("found 2 rows, 2 of them of the first line, expected at least 3",
                  WITH("kind=file", table_of("x,h\n0,0\n1,0\n"), "column=h"));
    check_refused("found 0.5 in row 3, at the edge of the table, expected 0",
                  WITH("kind=file", table_of("x,h\n0,0\n1,1\n2,0.5\n"), "column=h"));
    check_refused("found the columns (no name), h, expected a column x|X",
                  WITH("kind=file", table_of(",h\n0,0\n1,1\n2,0\n"), "column=h"));
    check_refused("found the columns x, X, h, expected only one column x|X",
                  WITH("kind=file", table_of("x,X,h\n0,0,0\n"), "column=h"));
    check_refused("found x = 1 in row 3, expected increasing x",
                  WITH("kind=file", table_of("x,h\n0,0\n1,1\n1,1\n2,0\n"), "column=h"));
}

/* If the scene gives the speeds of both surfaces, the speed of the rough surface must be one of
 * these two speeds. */
static void it_is_on_one_of_the_surfaces(void **state) {
    (void)state;
    static const char *const speeds[] = {"speed=1.2", "speed=0.8", "speed=1"};
    scene of = marched_scene(20, 5, "incompressible", 0.05, "end_time: 1");
    ehd_contact reference;
    ehd_surface *self;
    give(&of, WITH("kind=dent", "depth=1", "radius=1"));
    for (size_t i = 0; i < 3; i++) {
        give(&of, WITH(speeds[i]));
        assert_int_equal(scene_contact(&reference, &of, &error), EHD_OK);
        reference.slide_roll = 0.4;
        assert_int_equal(surface_init(&self, &of, &reference, &error), i < 2 ? EHD_OK : EHD_DATA);
        surface_free(self);
    }
    assert_non_null(strstr(error.text, "surface.speed: found 1, expected 1.2 or 0.8"));
}

static void the_start_is_smooth(void **state) {
    (void)state;
    ehd_contact reference;
    ehd_surface *self =
        surface_of(&reference, WITH("kind=dent", "depth=1", "radius=0.1", "position=-4.42"));
    const contact_frame here = frame_at_path(&reference, 1, 0),
                        larger = frame_at_path(&reference, 1.1, 0);
    // the first node is at -4.05, and the dent ends 0.36 downstream of its centre
    assert_int_equal(surface_check_start(self, &here, &reference.grid, &error), EHD_OK);
    assert_int_equal(surface_check_start(self, &larger, &reference.grid, &error), EHD_DATA);
    assert_non_null(strstr(error.text,
                           "surface.position: found -4.42 half widths, expected at most "
                           "-4.60"));
    surface_free(self);
}

// ---- steps

/* While a dent is on the grid, it moves in a time step by at most half of the length over which its
 * heights change. No time step goes beyond the arrival of the dent at the grid. */
static void steps_see_it_come(void **state) {
    (void)state;
    ehd_contact reference;
    ehd_surface *self = surface_of(
        &reference, WITH("kind=dent", "depth=1", "radius=0.1", "position=-10", "speed=0.5"));
    const double resolved = 0.5 * 0.12 / sqrt(M_PI_2 * M_PI_2 + 4);
    const struct {
        double path, longest;
        bool backwards;
    } cases[] = {{0, (10 - 0.36 - 4.05) / 0.5, false},
                 {0, INFINITY, true},
                 {12, resolved / 0.5, false},
                 {20, resolved / 0.5, true},
                 {25, INFINITY, false},
                 {25, (2.5 - 0.36 - 2.05) / 0.5, true}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const contact_frame frame = frame_at_path(&reference, 1, cases[i].path);
        const double found =
            surface_longest_path(self, &frame, &reference.grid, cases[i].backwards);
        if (isinf(cases[i].longest))
            assert_true(isinf(found));
        else
            check_close(found, cases[i].longest, 1e-12, 0);
    }
    surface_free(self);
}

// ---- marches; these are too large for the stack

static marched first, second;

static scene along_path(double step, const char *transient) {
    scene of = marched_scene(20, 5, "dowson-higginson", step, transient);
    scene_set(&of, "transport", "path", NULL, NULL);
    scene_complete(&of);
    return of;
}

/* A dent of depth zero changes no bit, before and after its arrival. */
static void heights_of_zero_change_no_bit(void **state) {
    (void)state;
    static const char *const transports[] = {"upwind", "path"};
    for (size_t i = 0; i < 2; i++) {
        scene of = marched_scene(20, 5, "dowson-higginson", 0.05,
                                 "end_time: 3, fixed_step: 0.05, load: {law: sine, amplitude: 0.1, "
                                 "period: 1}");
        scene_set(&of, "transport", transports[i], NULL, NULL);
        scene_complete(&of);
        marched_all(&first, &of);
        give(&of, WITH("kind=dent", "depth=0", "radius=0.3"));
        marched_all(&second, &of);
        assert_int_equal(first.count, second.count);
        assert_memory_equal(first.film, second.film, first.count * sizeof(double));
        assert_memory_equal(first.least_film, second.least_film, first.count * sizeof(double));
        assert_memory_equal(first.approach, second.approach, first.count * sizeof(double));
        assert_memory_equal(first.effect, second.effect, first.count * sizeof(double));
        marched_end(&first);
        marched_end(&second);
    }
}

/* The film moves as a plug, and a dent moves with the fluid. So rho H stays constant along the
 * path, and the carried mass of an earlier state equals the current rho H to round-off. */
static void a_plug_takes_its_dent_along(void **state) {
    (void)state;
    static const char *const densities[] = {"incompressible", "dowson-higginson"};
    for (size_t i = 0; i < 2; i++)
        for (int point = 0; point < 2; point++) {
            scene of = point ? marched_point("end_time: 1")
                             : marched_scene(20, 5, densities[i], 0.1, "end_time: 1");
            ehd_contact reference;
            ehd_surface *surface;
            previous_carrier carrier;
            previous_state plug;
            scene_set(&of, "transport", "path", NULL, NULL);
            // the dent is too narrow for splines on this grid
            give(&of, WITH("kind=dent", "depth=0.5", "radius=0.05", "position=-5"));
            assert_int_equal(scene_contact(&reference, &of, &error), EHD_OK);
            assert_int_equal(surface_init(&surface, &of, &reference, &error), EHD_OK);
            reference.surface = surface;
            const ehd_grid *grid = &reference.grid;
            double *mass = calloc(grid->num_inner, sizeof *mass);
            assert_int_equal(previous_carrier_init(&carrier, &reference, &error), EHD_OK);
            assert_int_equal(previous_init(&plug, &reference, &error), EHD_OK);
            plug.frame = frame_at_path(&reference, 1, 4.77);
            const contact_frame now = frame_at_path(&reference, 1, 4.9137);
            for (size_t k = 0; k < grid->num_nodes; k++) {
                const double x = grid_x(grid, k), y = grid_y(grid, k);
                plug.state.film[k] =
                    0.3 + grid_gap(grid, k) + surface_height(surface, &plug.frame, x, y);
                plug.state.pressure[k] = 0.9;
            }
            previous_prepare(&plug, 1, &carrier);
            previous_mass(mass, &plug, &now, &carrier);
            const double density =
                lubricant_density(&reference.lubricant, 0.9 * reference.hertz_pressure);
            for (size_t r = 0; r < grid->num_inner; r++) {
                const size_t k = grid_node_of_row(grid, r);
                const double x = grid_x(grid, k), y = grid_y(grid, k), then = x - 0.1437;
                if (fabs(x) > 1 || fabs(y) > 1) continue;
                check_close(mass[r],
                            density * (0.3 + contact_gap(&grid->shape, then, y) +
                                       surface_height(surface, &now, x, y)),
                            1e-13, 0);
            }
            free(mass);
            previous_free(&plug);
            previous_carrier_free(&carrier);
            surface_free(surface);
        }
}

/* Returns the film at a place in the middle of the contact, by cubic interpolation. */
static double film_at(const marched *self, double x) {
    const ehd_grid *grid = &self->reference.grid;
    const full_state *state = full_march_state(self->full, NULL);
    const double place = (x - grid_x(grid, 0)) / grid->step;
    const size_t k = (size_t)place;
    const double s = place - (double)k, *film = state->film + k;

    return -s * (s - 1) * (s - 2) / 6 * film[-1] + (s + 1) * (s - 1) * (s - 2) / 2 * film[0] -
           (s + 1) * s * (s - 2) / 2 * film[1] + (s + 1) * s * (s - 1) / 6 * film[2];
}

/* In pure rolling a film that a dent has shaped moves through the middle of a heavily loaded
 * contact without change, because there only the surfaces move the fluid. */
static void a_dented_film_passes_the_middle_as_it_is(void **state) {
    (void)state;
    scene of = marched_scene(100, 10, "incompressible", 0.02, "end_time: 4.1, fixed_step: 0.02");
    scene_set(&of, "transport", "path", NULL, NULL);
    give(&of, WITH("kind=dent", "depth=0.008", "radius=0.2", "position=-4.8"));
    marched_all(&first, &of);
    of.transient.end_time = 4.7;
    marched_all(&second, &of);
    // at the two times the dent's centre is at -0.7 and -0.1; the film is 0.017 thick
    check_close(surface_position(first.surface, 4.1), -0.7, 1e-12, 0);
    double deepest = 0;
    for (double x = -0.2; x <= 0.2; x += 0.01) {
        check_close(film_at(&second, -0.1 + x), film_at(&first, -0.7 + x), 0, 4e-5);
        deepest = fmax(deepest, film_at(&second, -0.1 + x) - film_at(&second, 0.7));
    }
    assert_true(deepest > 0.002);
    marched_end(&first);
    marched_end(&second);
}

/* Once the initial film and the front end of a waviness have left the contact, the initial place of
 * this end has no effect. */
static void a_waviness_forgets_its_end(void **state) {
    (void)state;
    scene of = along_path(0.05, "end_time: 9, fixed_step: 0.05");
    give(&of, WITH("kind=sine", "amplitude=0.005", "wavelength=0.5", "position=-4.05"));
    marched_all(&first, &of);
    give(&of, WITH("position=-5.05")); // two waves farther away
    marched_all(&second, &of);
    const size_t count = first.count;
    double least = INFINITY, most = 0;
    assert_int_equal(count, second.count);
    for (size_t k = count - 10; k < count; k++) { // the steps of one wave
        check_close(second.film[k], first.film[k], 1e-5, 0);
        least = fmin(least, first.film[k]);
        most = fmax(most, first.film[k]);
    }
    assert_true(most - least > 0.005);
    marched_end(&first);
    marched_end(&second);
}

/* With error control, steps become long while a dent is far away. They are short enough while the
 * dent is on the grid. The distance at which the dent starts has no effect on the result. */
static void a_dent_from_far_away_is_met(void **state) {
    (void)state;
    scene of = along_path(0.05, "end_time: 6");
    give(&of, WITH("kind=dent", "depth=0.03", "radius=0.2", "position=-5"));
    marched_all(&first, &of);
    of.transient.end_time = 66;
    give(&of, WITH("position=-65"));
    marched_all(&second, &of);
    double highest[2] = {0, 0};
    size_t within = 0;
    for (size_t k = 0; k < first.count; k++)
        highest[0] = fmax(highest[0], first.film[k]);
    for (size_t k = 1; k < second.count; k++) {
        const double from = second.time[k - 1] - 65;
        highest[1] = fmax(highest[1], second.film[k]);
        if (from < -4.05 - 0.72 + 1e-9 || from > 2.05 + 0.72) continue;
        within++;
        assert_true(second.time[k] - second.time[k - 1] <
                    0.5 * 0.24 / sqrt(M_PI_2 * M_PI_2 + 4) * (1 + 1e-6));
    }
    check_close(highest[1], highest[0], 3e-3, 0);
    assert_true(highest[0] > 1.05 * first.film[0]);
    assert_true(within > 100);
    assert_true(second.count - within < 100);
    marched_end(&first);
    marched_end(&second);
}

static void a_restored_march_has_the_same_bits(void **state) {
    (void)state;
    scene of = along_path(0.05, "end_time: 5");
    double *saved;
    give(&of, WITH("kind=dent", "depth=0.03", "radius=0.2", "speed=1.3"));
    marched_all(&first, &of);
    static marched stopped;
    marched_begin(&stopped, &of);
    stopped.stop_at = 60;
    marched_on(&stopped);
    const march_solver *solver = &stopped.march.solver;
    saved = malloc(solver->saved_size(solver->self) * sizeof *saved);
    assert_non_null(saved);
    solver->save(saved, solver->self);
    marched_check_restored(&second, &stopped, saved, &first);
    free(saved);
    marched_end(&stopped);
    marched_end(&first);
}

static void half_a_contact_is_the_whole_one(void **state) {
    (void)state;
    scene of = marched_point("end_time: 4.5, fixed_step: 0.1");
    scene_set(&of, "transport", "path", NULL, NULL);
    give(&of, WITH("kind=dent", "depth=0.05", "radius=0.3"));
    marched_all(&first, &of);
    scene_set(&of, "grid.half", "false", NULL, NULL);
    marched_all(&second, &of);
    assert_int_equal(first.count, second.count);
    check_close_array(second.film, first.film, first.count, 1e-9, 0);
    check_close_array(second.least_film, first.least_film, first.count, 1e-9, 0);
    double most = 0;
    for (size_t k = 0; k < first.count; k++)
        most = fmax(most, fabs(first.film[k] / first.film[0] - 1));
    assert_true(most > 0.02);
    marched_end(&first);
    marched_end(&second);
}

// ---- at rest

static const full_state *last_of(const marched *self) {
    return full_march_state(self->full, NULL);
}

/* The start includes a surface that rests. Under constant conditions nothing then changes in time.
 * This holds for lines and points, in both directions, with a given load or a given approach. */
static void one_at_rest_is_part_of_the_start(void **state) {
    const struct {
        bool point;
        const char *transport, *speed, *transient;
    } cases[] = {{false, "path", "1", "end_time: 3, tolerance: 1.5e-3"},
                 {false, "upwind", "1", "end_time: 3, fixed_step: 0.25"},
                 {false, "path", "-1", "end_time: 3, fixed_step: 0.25"},
                 {false, "path", "1", "end_time: 3, fixed_step: 0.25, approach: {law: constant}"},
                 {true, "path", "1", "end_time: 1, fixed_step: 0.25"}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        scene of = cases[i].point
                       ? marched_point(cases[i].transient)
                       : marched_scene(20, 6, "dowson-higginson", 0.05, cases[i].transient);
        scene_set(&of, "transport", cases[i].transport, NULL, NULL);
        if (!cases[i].point) of.grid.x_max = 4;
        of.transient.start_speed = atof(cases[i].speed);
        strcpy(of.transient.vary[VARY_SPEED].law, "step");
        of.transient.vary[VARY_SPEED].from = of.transient.vary[VARY_SPEED].to =
            of.transient.start_speed;
        of.transient.vary[VARY_SPEED].at = 100;
        marched_all(&first, &of);
        const double smooth = first.film[0];
        marched_end(&first);
        give(&of, WITH("kind=dent", "speed=0", "depth=0.05", "radius=0.3"));
        of.surface.position = -0.2;
        marched_all(&first, &of);
        assert_true(fabs(first.film[0] / smooth - 1) > 1e-3);
        for (size_t k = 1; k < first.count; k++) {
            check_close(first.film[k], first.film[0], 1e-8, 0);
            check_close(first.least_film[k], first.least_film[0], 1e-8, 0);
            check_close(first.approach[k], first.approach[0], 1e-8, 0);
        }
        marched_end(&first);
    }
}

/* Under pressure the viscosity is so high that the film has the same thickness everywhere. A
 * waviness at rest is therefore pressed flat. With the wavenumber k this needs a pressure of k
 * times its height (Johnson, Contact Mechanics, 13.2: u' = 2 p/(E* k), here Delta = P/k). */
static void a_waviness_at_rest_is_pressed_flat(void **state) {
    (void)state;
    const double amplitude = 0.002, wavelength = 0.5, k = 2 * M_PI / wavelength;
    scene of = marched_scene(50, 10, "incompressible", 0.0125, "end_time: 0.5, fixed_step: 0.25");
    scene_set(&of, "transport", "path", NULL, NULL);
    marched_all(&first, &of);
    give(&of, WITH("kind=sine", "speed=0", "amplitude=0.002", "wavelength=0.5"));
    marched_all(&second, &of);
    const ehd_grid *grid = &first.reference.grid;
    for (size_t i = 0; i < grid->num_nodes; i++) {
        const double x = grid_x(grid, i);
        if (fabs(x) > 0.4) continue;
        check_close(last_of(&second)->film[i], second.film[0], 3e-4, 0);
        check_close(last_of(&second)->pressure[i] - last_of(&first)->pressure[i],
                    -k * amplitude * sin(k * x), 0, 0.02 * k * amplitude);
    }
    marched_end(&first);
    marched_end(&second);
}

/* A dent that moves at 1/5000 of the fluid's speed has the same effect as a dent at rest. */
static void one_that_hardly_moves_is_as_at_rest(void **state) {
    (void)state;
    scene of = marched_scene(10, 3, "dowson-higginson", 0.05, "end_time: 1, fixed_step: 1");
    scene_set(&of, "grid.x_min", "-2.5", NULL, NULL);
    give(&of, WITH("kind=dent", "speed=0", "depth=0.08", "radius=0.1", "position=-0.8"));
    marched_all(&first, &of);
    marched_end(&first);
    const double at_rest = first.film[first.count - 1], lowest = first.least_film[first.count - 1];
    // the dent moves from -2.95 to -0.8
    scene_set(&of, "surface.speed", "0.0002", NULL, NULL);
    scene_set(&of, "surface.position", "-2.95", NULL, NULL);
    scene_set(&of, "transient.end_time", "10750", NULL, NULL);
    scene_set(&of, "transient.fixed_step", "12.5", NULL, NULL);
    marched_all(&first, &of);
    assert_true(fabs(at_rest / first.film[0] - 1) > 5e-3);
    check_close(first.film[first.count - 1], at_rest, 3e-4, 0);
    check_close(first.least_film[first.count - 1], lowest, 3e-4, 0);
    marched_end(&first);
}

/* Starts with motion backwards and forwards are mirror images, if the dent is mirrored too. */
static void starts_at_rest_have_mirror_images(void **state) {
    (void)state;
    scene of = marched_scene(20, 6, "dowson-higginson", 0.05, "end_time: 0.5, fixed_step: 0.25");
    scene_set(&of, "transport", "path", NULL, NULL);
    of.grid.x_max = 4;
    give(&of, WITH("kind=dent", "speed=0", "depth=0.05", "radius=0.3", "position=-0.4"));
    marched_begin(&first, &of);
    of.surface.position = 0.4;
    of.transient.start_speed = -1;
    marched_begin(&second, &of);
    const size_t num = first.reference.grid.num_nodes;
    for (size_t k = 0; k < num; k++) {
        check_close(last_of(&second)->film[num - 1 - k], last_of(&first)->film[k], 1e-9, 0);
        check_close(last_of(&second)->pressure[num - 1 - k], last_of(&first)->pressure[k], 0, 1e-9);
    }
    marched_end(&first);
    marched_end(&second);
    // if the fluid rests too, the heights are added to the dry contact with its constant film
    of.transient.start_speed = 0;
    of.transient.start_film = 0.2;
    of.surface.position = 0;
    marched_begin(&first, &of);
    check_close(first.film[0], 0.25, 1e-6, 0);
    const contact_frame *frame;
    full_march_state(first.full, &frame);
    assert_true(isinf(surface_longest_path(first.surface, frame, &first.reference.grid, false)));
    marched_end(&first);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_dent_has_the_shape_of_its_formula),
        cmocka_unit_test(a_waviness_ends_where_it_is),
        cmocka_unit_test(a_surface_keeps_its_size_as_the_contact_grows),
        cmocka_unit_test(a_table_is_a_spline_through_its_rows),
        cmocka_unit_test(a_table_may_be_a_grid),
        cmocka_unit_test(a_dent_is_round_in_an_ellipse),
        cmocka_unit_test(what_cannot_be_is_refused),
        cmocka_unit_test(what_the_grid_does_not_see_is_refused),
        cmocka_unit_test(it_is_on_one_of_the_surfaces),
        cmocka_unit_test(the_start_is_smooth),
        cmocka_unit_test(steps_see_it_come),
        cmocka_unit_test(heights_of_zero_change_no_bit),
        cmocka_unit_test(a_plug_takes_its_dent_along),
        cmocka_unit_test(a_dented_film_passes_the_middle_as_it_is),
        cmocka_unit_test(a_waviness_forgets_its_end),
        cmocka_unit_test(a_dent_from_far_away_is_met),
        cmocka_unit_test(a_restored_march_has_the_same_bits),
        cmocka_unit_test(half_a_contact_is_the_whole_one),
        cmocka_unit_test(one_at_rest_is_part_of_the_start),
        cmocka_unit_test(a_waviness_at_rest_is_pressed_flat),
        cmocka_unit_test(one_that_hardly_moves_is_as_at_rest),
        cmocka_unit_test(starts_at_rest_have_mirror_images),
    };
    return cmocka_run_group_tests(tests, enter_folder, leave_folder);
}
