/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Default grids of contacts whose scenes give no grid, or only some of its values. */
#include "common/physics/grid_choice.h"
#include "common/settings/scene_contact.h"
#include "tests/unit/check.h"
#include "tests/unit/problem.h"
#include "tests/unit/sample.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Returns the contact of a scene without a grid. */
static ehd_contact contact_in(scene *given, const char *kind, const char *discretization) {
    ehd_contact contact;

    snprintf(given->contact, sizeof given->contact, "%s", kind);
    snprintf(given->discretization, sizeof given->discretization, "%s", discretization);
    given->grid = (grid_settings){NAN, NAN, NAN, NAN, strcmp(kind, "point") == 0 ? 1 : -1};
    scene_complete(given);
    assert_int_equal(scene_contact(&contact, given, NULL), EHD_OK);
    return contact;
}

static ehd_contact contact_of(const char *kind, const char *discretization, double moes_M,
                              double moes_L) {
    scene given = sample_scene("barus", "incompressible", moes_M, moes_L);
    return contact_in(&given, kind, discretization);
}

/* A dry gap is zero at the edge and rises with the power 3/2. Far away it is the undeformed gap
 * minus a term that grows more slowly. Its slope in a line contact is sqrt(x^2 - 1) (Hertz). */
static void dry_gaps(void **state) {
    (void)state;
    const double d = 1e-6;

    check_close(contact_line.dry_gap(&shape_round, -1), 0, 0, 1e-15);
    check_close(contact_point.dry_gap(&shape_round, -1), 0, 0, 1e-15);
    for (double x = 1.1; x < 5; x += 0.7) {
        double slope = (contact_line.dry_gap(&shape_round, x + d) -
                        contact_line.dry_gap(&shape_round, x - d)) /
                       (2 * d);
        check_close(slope, sqrt(x * x - 1), 1e-8, 0);
        slope = (contact_point.dry_gap(&shape_round, x + d) -
                 contact_point.dry_gap(&shape_round, x - d)) /
                (2 * d);
        check_close(slope, 2 / M_PI * (x * acos(1 / x) + sqrt(1 - 1 / (x * x))), 1e-8, 0);
        check_close(contact_line.dry_gap(&shape_round, -x), contact_line.dry_gap(&shape_round, x),
                    1e-15, 0);
    }
    check_close(contact_line.dry_gap(&shape_round, 100), 5000, 2e-3, 0);
    check_close(contact_point.dry_gap(&shape_round, 100), 5000, 1e-2, 0);
}

/* Grids are longer for thick films and finer for thin films, depending on M and L. */
static void grids_that_contacts_need(void **state) {
    (void)state;
    static const struct {
        const char *kind;
        double moes_M, moes_L, x_min, x_max, step, y_max;
    } cases[] = {
        {"line", 0.1, 0, -256, 10.08, 0.16, NAN},  {"line", 0.5, 0, -48, 3, 0.04, NAN},
        {"line", 1, 0, -24, 2, 0.02, NAN},         {"line", 1, 25, -32, 2, 0.02, NAN},
        {"line", 20, 10, -6, 2, 0.02, NAN},        {"line", 50, 10, -4, 2, 0.01, NAN},
        {"line", 100, 5, -3, 2, 0.005, NAN},       {"line", 500, 15, -2, 2, 0.00125, NAN},
        {"line", 2000, 0, -1.5, 2, 0.000625, NAN}, {"point", 0.1, 0, -512, 176, 8, 384},
        {"point", 1, 0, -24, 8, 0.5, 18},          {"point", 2, 0, -12, 4, 0.25, 9},
        {"point", 3, 0, -6, 2, 0.125, 4.5},        {"point", 3, 25, -8, 3, 0.125, 6},
        {"point", 5, 0, -4, 2, 0.0625, 3},         {"point", 5, 25, -8, 3, 0.0625, 6},
        {"point", 20, 5, -3, 2, 0.0625, 2.25},     {"point", 60, 5, -3, 2, 0.0625, 2.25},
        {"point", 100, 5, -3, 2, 0.03125, 2.25},   {"point", 300, 5, -3, 2, 0.015625, 2.25}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const ehd_contact contact =
            contact_of(cases[i].kind, "accurate", cases[i].moes_M, cases[i].moes_L);
        const grid_extent found = grid_extent_of(&contact.grid);
        check_close(found.x_min, cases[i].x_min, 0, 0);
        check_close(found.x_max, cases[i].x_max, 0, 1e-12);
        check_close(found.step, cases[i].step, 0, 0);
        if (!isnan(cases[i].y_max)) check_close(found.y_max, cases[i].y_max, 0, 1e-12);
        assert_true(contact_has_chosen_grid(&contact));
    }
}

/* Checks the default grid steps of narrow ellipses. Coarser steps gave errors of 6 to 14 % in the
 * minimum film. */
static void narrow_ellipses_are_fine(void **state) {
    (void)state;
    static const struct {
        double ellipticity, moes_M, step;
    } cases[] = {{0.05, 0.1, 0.015625}, {0.05, 1, 0.0078125}, {0.05, 10, 0.00390625},
                 {0.1, 1, 0.015625},    {0.2, 1, 0.03125},    {0.2, 100, 0.0078125},
                 {0.5, 10, 0.0625},     {5, 100, 0.0625}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        scene given = sample_scene("barus", "incompressible", cases[i].moes_M, 0);
        given.ellipticity = cases[i].ellipticity;
        const ehd_contact contact = contact_in(&given, "ellipse", "accurate");
        check_close(contact.grid.step, cases[i].step, 0, 0);
    }
}

/* Returns the minimum film of rigid bodies. For a line contact it is 2.4485/M in Moes units
 * (Martin, Engineering 102, 1916). For paraboloids it is proportional to (speed/load)^2. */
static double smallest_film(scene *given, const char *kind) {
    const full_settings settings = full_default_settings();
    const ehd_contact contact = contact_in(given, kind, "accurate");
    problem found;

    problem_solve_cold(&found, &contact, &settings);
    assert_false(full_is_cut(&found.state, &contact.grid, false));
    const double film = full_evaluate_scalars(&found.state, &contact).minimum_film_thickness;
    problem_free(&found);
    return film;
}

static void rigid_films(void **state) {
    (void)state;
    for (double M = 0.1; M < 0.3; M *= 2) {
        scene given = sample_scene("barus", "incompressible", M, 0);
        check_close(smallest_film(&given, "line"), M_PI / 8 * 2.4485 / (M * M), 0.01, 0);
    }
    for (double k = 0.5; k < 30; k *= 6) {
        scene given = sample_scene("barus", "incompressible", 0.1, 0),
              twice = sample_scene("barus", "incompressible", 0.2, 0);
        given.ellipticity = twice.ellipticity = k;
        const double ratio = smallest_film(&given, "ellipse") / smallest_film(&twice, "ellipse");
        check_close(ratio, pow(2, 8. / 3), 0.01, 0);
    }
}

/* Returns the larger of two ratios: error of the central film over 1 %, and error of the minimum
 * film over 3 %. */
static double error_on(const ehd_contact *contact, double central, double smallest) {
    const full_settings settings = full_default_settings();
    problem found;

    problem_solve_cold(&found, contact, &settings);
    const contact_scalars films = full_evaluate_scalars(&found.state, contact);
    problem_free(&found);
    return fmax(fabs(films.central_film_thickness / central - 1) / 0.01,
                fabs(films.minimum_film_thickness / smallest - 1) / 0.03);
}

/* Films for an infinitely long inlet and a vanishing grid step (docs/history.md, default-grid).
 * `step` and `length` are factors that make the default grid insufficient. */
typedef struct enough {
    double moes_M, moes_L, central, smallest, step, length;
} enough;

/* The default grid has errors below 1 and 3 %; a coarser or shorter grid has larger errors. */
static void check_just_enough(const char *kind, const enough *of) {
    ehd_contact contact = contact_of(kind, "accurate", of->moes_M, of->moes_L);
    grid_extent less = grid_extent_of(&contact.grid);

    assert_true(error_on(&contact, of->central, of->smallest) < 1);
    less.step *= of->step;
    less.x_min *= of->length;
    less.y_max *= of->length; // NaN for a line
    contact.grid = grid_choose(&less, &less, &contact.grid);
    assert_true(error_on(&contact, of->central, of->smallest) > 1);
}

/* Four times the default step is too coarse at small L. The length matters most at M = 1, where
 * half of the default length is too short. */
static void grids_are_fine_and_wide_enough(void **state) {
    (void)state;
    static const enough cases[] = {{1, 0, 1.28597, 1.20199, 1, 1. / 2},
                                   {240, 0, 0.00136814, 0.00108848, 4, 1},
                                   {500, 0, 0.000565774, 0.000450282, 4, 1}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        check_just_enough("line", &cases[i]);
}

/* Zero pressure around the grid neglects the load beyond the grid. For a point contact of low M
 * and L this load determines how long the grid must be. On a grid of half this length the film
 * differs by 1.5 % from the film of points_with_the_far_field. */
static void points_count_the_load_beyond(void **state) {
    (void)state;
    const double central = 0.26890, smallest = 0.19779;
    scene given = sample_scene("barus", "incompressible", 10, 0);
    snprintf(given.boundary, sizeof given.boundary, "zero");
    ehd_contact contact = contact_in(&given, "point", "accurate");
    grid_extent half = grid_extent_of(&contact.grid);

    assert_true(error_on(&contact, central, smallest) < 1);
    half.x_min /= 2;
    half.x_max = 2;
    half.y_max /= 2;
    contact.grid = grid_choose(&half, &half, &contact.grid);
    assert_true(error_on(&contact, central, smallest) > 1.3);
}

/* Half of the default length is too short for thick films. Twice the default step is too coarse if
 * the pressure spike is at the centre. */
static void points_with_the_far_field(void **state) {
    (void)state;
    static const enough cases[] = {{1, 0, 27.14, 27.14, 1, 0.5},
                                   {3, 0, 1.526, 1.5195, 1, 0.5},
                                   {7, 10, 0.9904, 0.6865, 2, 1},
                                   {10, 0, 0.26890, 0.19779, 4, 1}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        check_just_enough("point", &cases[i]);
}

/* The thinnest film is found from a cold start on the default grid. With the published grid and
 * discretisation the film would be driven to zero. */
static void the_thinnest_film_starts_cold(void **state) {
    (void)state;
    const full_settings settings = full_default_settings();
    scene given = sample_scene("roelands", "dowson-higginson", 2000, 10);
    given.hertz_pressure = 1e9;
    const ehd_contact contact = contact_in(&given, "line", "accurate");
    problem found;

    problem_solve_cold(&found, &contact, &settings);
    assert_true(found.info.newton_iterations <= 6);
    problem_free(&found);
}

static void the_published_grid_is_one(void **state) {
    (void)state;
    for (double M = 1; M < 2000; M *= 10) {
        const ehd_contact line = contact_of("line", "published", M, 10);
        const ehd_contact point = contact_of("point", "published", M, 10);
        assert_int_equal(line.grid.num_inner, 1201);
        check_close(line.grid.x_min, -4, 0, 0);
        assert_int_equal(point.grid.inner_x, 97);
        assert_int_equal(point.grid.inner_lines, 49);
        assert_false(contact_has_chosen_grid(&line) || contact_has_chosen_grid(&point));
    }
}

static void parts_that_are_given_stay(void **state) {
    (void)state;
    const grid_extent needed = {-4, 2, 0.0625, 3}, all = {-5, 1.5, 0.05, 2};
    for (int given = 0; given < 16; given++) {
        const grid_extent of = {given & 1 ? all.x_min : NAN, given & 2 ? all.x_max : NAN,
                                given & 4 ? all.step : NAN, given & 8 ? all.y_max : NAN};
        const ehd_grid like = {
            .half = true, .discretization = DISCRETIZATION_ACCURATE, .shape = shape_round};
        const ehd_grid grid = grid_choose(&of, &needed, &like);
        const grid_extent found = grid_extent_of(&grid);
        check_close(found.x_max, given & 2 ? all.x_max : needed.x_max, 0, 1e-12);
        if (given & 1) check_close(found.x_min, all.x_min, 0, 1e-12);
        if (given & 4) check_close(found.step, all.step, 0, 0);
        // given values stay; other ends lie less than a step outside of the needed ends, and the
        // step is at most as large as needed
        assert_true(found.x_min <= (given & 1 ? all.x_min : needed.x_min) + 1e-12);
        assert_true(found.x_min > (given & 1 ? all.x_min : needed.x_min) - found.step);
        assert_true(found.step <= (given & 4 ? all.step : needed.step));
        assert_true(found.y_max >= (given & 8 ? all.y_max : needed.y_max) - 1e-12);
        assert_true(found.y_max < (given & 8 ? all.y_max : needed.y_max) + found.step);
    }
}

static void what_serves_both(void **state) {
    (void)state;
    grid_extent all = {-4, 2, 0.02, NAN};
    const grid_extent other = {-2, 3, 0.005, NAN};

    grid_extent_join(&all, &other);
    check_close(all.x_min, -4, 0, 0);
    check_close(all.x_max, 3, 0, 0);
    check_close(all.step, 0.005, 0, 0);
    assert_true(isnan(all.y_max));
}

static void grids_have_an_end(void **state) {
    (void)state;
    scene given = sample_scene("barus", "incompressible", 100, 5);
    ehd_contact contact;
    ehd_error error;

    given.grid = (grid_settings){NAN, NAN, 2e-6, NAN, -1};
    assert_int_equal(scene_contact(&contact, &given, &error), EHD_DATA);
    assert_string_equal(error.text, "grid: found 2500001 nodes from -3 by 2e-06 for M = 100 and L "
                                    "= 5, expected at most 2000000, as by another grid.step");
    given.grid.step = 2.5e-6;
    assert_int_equal(scene_contact(&contact, &given, &error), EHD_DATA);
    given.grid.x_min = -2;
    assert_int_equal(scene_contact(&contact, &given, &error), EHD_OK);
}

/* A contact takes the grid of a model if its scene gives no other grid. */
static void grids_of_models(void **state) {
    (void)state;
    const ehd_grid model = grid_of(-6, 0.01, 801, 1, false, DISCRETIZATION_ACCURATE);
    const ehd_grid other = grid_of(-6, 0.01, 801, 1, false, DISCRETIZATION_PUBLISHED);
    ehd_contact contact = contact_of("line", "accurate", 100, 5);

    contact_take_grid(&contact, &other);
    assert_false(grid_same(&contact.grid, &other));
    contact_take_grid(&contact, &model);
    assert_true(grid_same(&contact.grid, &model));
    assert_false(contact_has_chosen_grid(&contact)); // the contact has a grid now

    contact = contact_of("line", "accurate", 100, 5);
    contact.grid_given.step = 0.005;
    contact_take_grid(&contact, &model);
    assert_false(grid_same(&contact.grid, &model));
    contact.grid_given.step = 0.01;
    contact_take_grid(&contact, &model);
    assert_true(grid_same(&contact.grid, &model));

    contact = contact_of("point", "accurate", 100, 5);
    contact_take_grid(&contact, &model);
    assert_false(grid_same(&contact.grid, &model));

    // a scene that requires a half grid does not take a whole grid
    const ehd_grid whole = grid_of(-3, 0.125, 41, 41, false, DISCRETIZATION_ACCURATE);
    contact_take_grid(&contact, &whole);
    assert_false(grid_same(&contact.grid, &whole));

    // given sides are rounded outwards by less than a step
    ehd_grid of_point = grid_of(-3, 0.125, 41, 21, true, DISCRETIZATION_ACCURATE);
    contact = contact_of("point", "accurate", 100, 5);
    contact_take_grid(&contact, &of_point);
    assert_false(grid_same(&contact.grid, &of_point)); // the contact has another boundary
    of_point.boundary = BOUNDARY_OPEN;
    const double sides[] = {2.5, 2.4, 2.3, 2.51};
    for (int i = 0; i < 4; i++) {
        contact = contact_of("point", "accurate", 100, 5);
        contact.grid_given.y_max = sides[i];
        contact_take_grid(&contact, &of_point);
        assert_int_equal(grid_same(&contact.grid, &of_point), i < 2);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(dry_gaps),
        cmocka_unit_test(grids_that_contacts_need),
        cmocka_unit_test(narrow_ellipses_are_fine),
        cmocka_unit_test(rigid_films),
        cmocka_unit_test(grids_are_fine_and_wide_enough),
        cmocka_unit_test(points_count_the_load_beyond),
        cmocka_unit_test(points_with_the_far_field),
        cmocka_unit_test(the_thinnest_film_starts_cold),
        cmocka_unit_test(the_published_grid_is_one),
        cmocka_unit_test(parts_that_are_given_stay),
        cmocka_unit_test(what_serves_both),
        cmocka_unit_test(grids_have_an_end),
        cmocka_unit_test(grids_of_models),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
