/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Validation scenes between the scenes of a training: a grid worked out by hand, arbitrary points,
 * and trajectories. */
#include "common/settings/settings_table.h"
#include "common/training/between.h"
#include "tests/unit/allocation.h"
#include "tests/unit/check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char stationary[] = "contact: line\nregime: stationary\n"
                                 "lubricant.viscosity.law: barus\nlubricant.viscosity.alpha: %g\n"
                                 "lubricant.density.law: dowson-higginson\n"
                                 "discretization: accurate\nmoes.M: %.17g\nmoes.L: %.17g\n";
static const char moving[] = "contact: line\nregime: transient\nclosure: load\n"
                             "lubricant.viscosity.law: barus\nlubricant.viscosity.alpha: 2e-8\n"
                             "lubricant.density.law: dowson-higginson\n"
                             "discretization: accurate\ntransport: path\nmoes.M: 20\nmoes.L: 5\n"
                             "transient.end_time: 1\ntransient.load.law: %s\n%s";

/* A plan and the training set of its points. */
typedef struct sample {
    plan of;
    training_set set;
} sample;

static void add_scene(plan *of, const char *text, size_t group) {
    ehd_error error = {""};
    scene added;

    if (scene_parse(&added, text, strlen(text), "scene", NULL, 0, &error))
        fail_msg("%s", error.text);
    of->points = realloc(of->points, (of->num_points + 1) * sizeof *of->points);
    assert_non_null(of->points);
    of->points[of->num_points++] = (plan_point){added, group};
}

static void add_point(plan *of, double alpha, double M, double L, size_t group) {
    char text[512];

    snprintf(text, sizeof text, stationary, alpha, M, L);
    add_scene(of, text, group);
}

static void add_trajectory(plan *of, const char *law, const char *more) {
    char text[1024];

    snprintf(text, sizeof text, moving, law, more);
    add_scene(of, text, 0);
}

static void make_set(sample *self) {
    ehd_error error = {""};
    plan *of = &self->of;

    of->num_groups = 2;
    of->where = calloc(2, sizeof *of->where);
    assert_non_null(of->where);
    for (int i = 0; i < 2; i++)
        of->where[i] = plan_anywhere();
    assert_int_equal(plan_write_text(of, "plan", NULL), EHD_OK);
    if (training_set_init(&self->set, of, "plan", (shard){1, 1}, &error))
        fail_msg("%s", error.text);
}

static void free_sample(sample *self) {
    training_set_free(&self->set);
    plan_free(&self->of);
}

static plan middles_of(const sample *self) {
    ehd_error error = {""};
    plan between;

    if (between_neighbours(&between, &self->of, &self->set, "plan", &error))
        fail_msg("%s", error.text);
    return between;
}

static double alpha_of(const scene *of) {
    const setting *row = setting_find("lubricant.viscosity.alpha");
    double value;

    memcpy(&value, (const char *)of + row->offset, sizeof value);
    return value;
}

/* Returns the number of scenes with these values. */
static size_t count_of(const plan *of, double alpha, double M, double L) {
    size_t count = 0;

    for (size_t i = 0; i < of->num_points; i++) {
        const scene *here = &of->points[i].scene;
        count += is_close(here->moes.M, M, 1e-12, 0) && is_close(here->moes.L, L, 1e-12, 1e-12) &&
                 is_close(alpha_of(here), alpha, 1e-12, 0);
    }
    return count;
}

static size_t count_chosen(const bool *chosen, size_t length) {
    size_t count = 0;

    for (size_t i = 0; i < length; i++)
        count += chosen[i];
    return count;
}

/* A grid of three by two points has seven edges and two cells, whose middles are new scenes. */
static void test_grid(void **state) {
    sample grid = {0};
    (void)state;

    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 2; k++)
            add_point(&grid.of, 2e-8, 4 * pow(4, i), k ? 8 : 0, 0);
    make_set(&grid);
    plan between = middles_of(&grid);
    assert_int_equal(between.num_points, 9);
    for (int i = 0; i < 2; i++) {
        assert_int_equal(count_of(&between, 2e-8, 8 * pow(4, i), 8), 1);
        // if one L is zero, the middle is the arithmetic mean
        assert_int_equal(count_of(&between, 2e-8, 8 * pow(4, i), 0), 1);
        assert_int_equal(count_of(&between, 2e-8, 8 * pow(4, i), 4), 1);
    }
    for (int i = 0; i < 3; i++)
        assert_int_equal(count_of(&between, 2e-8, 4 * pow(4, i), 4), 1);
    plan_free(&between);
    free_sample(&grid);
}

/* Points with different lubricants or groups have no scene in the middle. If a point is left out of
 * the set, the points on both sides of it become neighbours. */
static void test_families(void **state) {
    const bool keep[] = {true, false, true, true, true, true, true};
    sample points = {0};
    (void)state;

    for (int i = 0; i < 3; i++)
        add_point(&points.of, 2e-8, 5 + i, 5 + i, 0);
    add_point(&points.of, 3e-8, 9, 5, 0);
    add_point(&points.of, 3e-8, 16, 5, 0);
    add_point(&points.of, 2e-8, 40, 9, 1);
    add_point(&points.of, 2e-8, 90, 9, 1);
    make_set(&points);
    plan between = middles_of(&points);
    assert_int_equal(between.num_points, 4);
    assert_int_equal(count_of(&between, 2e-8, sqrt(30), sqrt(30)), 1);
    assert_int_equal(count_of(&between, 2e-8, sqrt(42), sqrt(42)), 1);
    assert_int_equal(count_of(&between, 3e-8, 12, 5), 1);
    assert_int_equal(count_of(&between, 2e-8, 60, 9), 1);
    assert_int_equal(between.points[3].group, 1);
    plan_free(&between);

    assert_int_equal(training_set_keep(&points.set, keep, "plan", NULL), EHD_OK);
    between = middles_of(&points);
    assert_int_equal(between.num_points, 3);
    assert_int_equal(count_of(&between, 2e-8, sqrt(35), sqrt(35)), 1);
    plan_free(&between);
    free_sample(&points);
}

/* Trajectories that differ only in numbers have a scene in the middle. A trajectory that differs
 * from all others in more than numbers gives a scene with half of its own change. */
static void test_trajectories(void **state) {
    sample moved = {0};
    size_t count = 0;
    (void)state;

    add_trajectory(&moved.of, "sine",
                   "transient.load.amplitude: 0.1\ntransient.load.period: 0.5\n");
    add_trajectory(&moved.of, "sine", "transient.load.amplitude: 0.1\ntransient.load.period: 1\n");
    add_trajectory(&moved.of, "ramp", "transient.load.to: 2\ntransient.load.duration: 0.5\n");
    add_trajectory(&moved.of, "sine", "transient.load.amplitude: 0.1\ntransient.load.period: 2\n");
    add_trajectory(&moved.of, "sine",
                   "transient.load.amplitude: 0.1\ntransient.load.period: 1\n"
                   "transient.fixed_step: 0.01\n");
    make_set(&moved);
    plan between = middles_of(&moved);
    assert_int_equal(between.num_points, 4);
    for (size_t i = 0; i < 2; i++) {
        const scene *here = &between.points[i].scene;
        count +=
            is_close(here->transient.vary[VARY_LOAD].period, i ? sqrt(2) : sqrt(0.5), 1e-12, 0);
        check_close(here->transient.vary[VARY_LOAD].amplitude, 0.1, 0, 0);
    }
    assert_int_equal(count, 2);
    const scene *ramp = &between.points[2].scene, *fixed = &between.points[3].scene;
    check_close(ramp->transient.vary[VARY_LOAD].from, 1, 0, 0);
    check_close(ramp->transient.vary[VARY_LOAD].to, 1.5, 0, 0);
    check_close(fixed->transient.vary[VARY_LOAD].amplitude, 0.05, 0, 0);
    check_close(fixed->transient.fixed_step, 0.01, 0, 0);
    plan_free(&between);

    // one trajectory of each kind is chosen before a second one, within the requested number
    bool chosen[5];
    const bool expected[] = {true, false, true, false, true};
    assert_int_equal(between_spread_trajectories(chosen, &moved.set, 3, NULL), EHD_OK);
    assert_memory_equal(chosen, expected, sizeof chosen);
    assert_int_equal(between_spread_trajectories(chosen, &moved.set, 1, NULL), EHD_OK);
    assert_int_equal(count_chosen(chosen, 5), 1);
    free_sample(&moved);
}

/* The points 0 … 8 are equidistant in ln M. They are chosen in the order first, last, middle,
 * quarters. */
static void test_spread(void **state) {
    sample line = {0};
    bool chosen[11];
    const size_t order[] = {0, 8, 4, 2, 6};
    (void)state;

    for (int i = 0; i < 9; i++)
        add_point(&line.of, 2e-8, exp(0.1 * i + 3), 5, 0);
    make_set(&line);
    for (size_t count = 1; count <= 5; count++) {
        assert_int_equal(between_spread(chosen, &line.set, count, NULL), EHD_OK);
        assert_int_equal(count_chosen(chosen, 9), count);
        for (size_t i = 0; i < count; i++)
            assert_true(chosen[order[i]]);
    }
    assert_int_equal(between_spread(chosen, &line.set, 100, NULL), EHD_OK);
    assert_int_equal(count_chosen(chosen, 9), 9);
    free_sample(&line);

    // two more lubricants get one point each, whatever number is requested
    sample several = {0};
    for (int i = 0; i < 9; i++)
        add_point(&several.of, 2e-8, exp(0.1 * i + 3), 5, 0);
    add_point(&several.of, 1e-8, 20, 5, 0);
    add_point(&several.of, 3e-8, 20, 5, 0);
    make_set(&several);
    assert_int_equal(between_spread(chosen, &several.set, 2, NULL), EHD_OK);
    assert_int_equal(count_chosen(chosen, 11), 3);
    assert_true(chosen[9] && chosen[10]);
    free_sample(&several);
}

/* Two of nine points are chosen already. If one more point is requested, the middle point is
 * chosen. If three more points are requested, one point in each third is chosen. */
static void test_sweep(void **state) {
    bool chosen[9] = {true, [8] = true};
    sample line = {0};
    (void)state;

    for (int i = 0; i < 9; i++)
        add_point(&line.of, 2e-8, exp(0.1 * i + 3), 5, 0);
    make_set(&line);
    assert_int_equal(between_sweep(chosen, &line.set, 1, NULL), EHD_OK);
    assert_int_equal(count_chosen(chosen, 9), 3);
    assert_true(chosen[4]);
    chosen[4] = false;
    assert_int_equal(between_sweep(chosen, &line.set, 3, NULL), EHD_OK);
    assert_int_equal(count_chosen(chosen, 9), 5);
    assert_true(chosen[2] && chosen[4] && chosen[6]);
    assert_int_equal(between_sweep(chosen, &line.set, 100, NULL), EHD_OK);
    assert_int_equal(count_chosen(chosen, 9), 9);
    assert_int_equal(between_sweep(chosen, &line.set, 1, NULL), EHD_OK);
    free_sample(&line);
}

static void test_keep(void **state) {
    const bool keep[] = {false, true, true};
    sample line = {0};
    (void)state;

    for (int i = 0; i < 3; i++)
        add_point(&line.of, 2e-8, 10 + i, 5, 0);
    make_set(&line);
    assert_int_equal(between_keep(&line.of, keep, "plan", NULL), EHD_OK);
    assert_int_equal(line.of.num_points, 2);
    check_close(line.of.points[0].scene.moes.M, 11, 0, 0);
    assert_null(strstr(line.of.text, "moes.M: 10"));
    assert_non_null(strstr(line.of.text, "moes.M: 12"));
    free_sample(&line);
}

static void test_no_memory(void **state) {
    sample line = {0};
    size_t call = 0;
    (void)state;

    for (int i = 0; i < 3; i++)
        add_point(&line.of, 2e-8, 10 + i, 5, 0);
    make_set(&line);
    for (bool failed = true; failed; call++) {
        plan between;
        allocation_fail_at(call);
        ehd_status status = between_neighbours(&between, &line.of, &line.set, "plan", NULL);
        failed = allocation_failed();
        // a middle scene is left out without an error if an allocation for its contact fails
        if (!failed) assert_int_equal(status, EHD_OK);
        if (status) assert_int_equal(status, EHD_MEMORY);
        plan_free(&between);
    }
    assert_true(call > 4);
    free_sample(&line);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_grid),         cmocka_unit_test(test_families),
        cmocka_unit_test(test_trajectories), cmocka_unit_test(test_spread),
        cmocka_unit_test(test_sweep),        cmocka_unit_test(test_keep),
        cmocka_unit_test(test_no_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
