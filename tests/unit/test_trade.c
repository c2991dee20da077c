/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table of model sizes: the choice of its sizes, the measurement of each size, and the choice
 * of one size by its accuracy. */
#include "common/artefact/artefact.h"
#include "romrun/calibrate/accuracy.h"
#include "romrun/calibrate/calibration.h"
#include "romrun/model/trade_file.h"
#include "tests/unit/allocation.h"
#include "tests/unit/check.h"
#include "tests/unit/folder.h"
#include "tests/unit/reduced_problem.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static char path[128], calibrated[128];
static trained training;
static ehd_error error;

#define check_ok(call) assert_string_equal(((call) == EHD_OK) ? "" : error.text, "")

/* Writes a model with all modes and rows of the small training. */
static int set_up(void **state) {
    reduced_basis basis;

    if (make_folder(state)) return -1;
    snprintf(path, sizeof path, "%s/model.h5", folder);
    snprintf(calibrated, sizeof calibrated, "%s/calibrated.h5", folder);
    trained_init(&training, 0.05);
    trained_basis(&basis, &training, DEFORMATION_COUPLED, 0, 0);
    whole_model_write(&basis, path);
    reduced_basis_free(&basis);
    return 0;
}

static int tear_down(void **state) {
    trained_free(&training);
    return remove_folder(state);
}

// ---- the ladder, which is the list of sizes in the table

static void check_ladder(size_t modes, size_t deformation, size_t rows, const model_sizes *expected,
                         size_t count) {
    const online_properties whole = {
        .pressure_modes = modes, .deformation_modes = deformation, .rows = rows};
    trade_table table;

    check_ok(trade_ladder(&table, &whole, &error));
    assert_int_equal(table.num_positions, count);
    for (size_t i = 0; i < count; i++)
        assert_memory_equal(&table.positions[i].sizes, &expected[i], sizeof *expected);
    trade_free(&table);
}

static void the_ladder_goes_from_ten_modes_to_all(void **state) {
    // Numbers of modes are 10 sqrt(2)^k, and near the end 10 2^(k/4). 50 rows are fewer than two
    // rows for each of 28 modes.
    const model_sizes coupled[] = {{10, 0, 12}, {10, 0, 15}, {10, 0, 20}, {10, 0, 30}, {10, 0, 50},
                                   {14, 0, 17}, {14, 0, 21}, {14, 0, 28}, {14, 0, 42}, {14, 0, 50},
                                   {17, 0, 21}, {17, 0, 26}, {17, 0, 34}, {17, 0, 50}, {20, 0, 24},
                                   {20, 0, 30}, {20, 0, 40}, {20, 0, 50}, {24, 0, 29}, {24, 0, 36},
                                   {24, 0, 48}, {24, 0, 50}, {28, 0, 34}, {28, 0, 42}, {28, 0, 50}};
    const model_sizes small[] = {{4, 3, 5}, {4, 3, 6}, {4, 3, 8}, {4, 3, 9}};
    const model_sizes square[] = {{10, 5, 11}, {11, 5, 11}};
    (void)state;

    check_ladder(28, 0, 50, coupled, 25);
    check_ladder(4, 3, 9, small, 4);
    check_ladder(11, 5, 11, square, 2);
}

/* A model can be opened with every size of its ladder, for any number of modes and rows. */
static void every_position_can_be_opened(void **state) {
    (void)state;
    for (size_t modes = 1; modes < 130; modes++)
        for (size_t rows = modes; rows < 4 * modes; rows++) {
            const online_properties whole = {
                .pressure_modes = modes, .deformation_modes = modes / 2, .rows = rows};
            trade_table table;
            check_ok(trade_ladder(&table, &whole, &error));
            for (size_t i = 0; i < table.num_positions; i++) {
                const model_sizes *sizes = &table.positions[i].sizes;
                assert_true(sizes->pressure_modes >= 1 && sizes->pressure_modes <= modes);
                assert_true(sizes->rows >= sizes->pressure_modes && sizes->rows <= rows);
                assert_true(sizes->deformation_modes <= modes / 2);
                assert_true(modes / 2 == 0 || sizes->deformation_modes >= 1);
            }
            const model_sizes *last = &table.positions[table.num_positions - 1].sizes;
            assert_true(last->pressure_modes == modes && last->rows == rows &&
                        last->deformation_modes == modes / 2);
            trade_free(&table);
        }
}

// ---- statistics of the sizes, and choice of a size

static void quantiles_are_values_of_the_set(void **state) {
    double values[] = {5, 1, 4, 2, 3}, many[100];
    (void)state;

    for (size_t i = 0; i < 100; i++)
        many[i] = (double)(100 - i);
    check_close(trade_quantile_of(values, 5, 0.5), 3, 0, 0);
    check_close(trade_quantile_of(values, 5, 0.95), 5, 0, 0);
    check_close(trade_quantile_of(values, 5, 1), 5, 0, 0);
    check_close(trade_quantile_of(many, 100, 0.95), 95, 0, 0);
    check_close(trade_quantile_of(many, 1, 0.5), 1, 0, 0);
    assert_true(isnan(trade_quantile_of(values, 0, 0.5)));
}

static trade_position measured(double worst, double seconds, size_t num_failures) {
    trade_position position = {.seconds = seconds, .num_failures = num_failures};

    position.deviation[TRADE_CENTRAL_FILM][TRADE_WORST] = worst;
    return position;
}

static void the_cheapest_that_is_good_enough(void **state) {
    trade_position positions[] = {
        measured(NAN, NAN, 9), measured(1e-1, 1, 0), measured(1e-9, 0.5, 1), measured(1e-3, 3, 0),
        measured(1e-2, 2, 0),  measured(2e-3, 4, 0), measured(1e-2, 2.5, 0)};
    const trade_table table = {9, 0, sizeof positions / sizeof *positions, positions, {0}};
    const trade_table failed = {9, 0, 1, positions, {0}};
    const bool dominated[] = {true, false, true, false, false, true, true};
    (void)state;

    assert_int_equal(trade_cheapest(&table, 1, false), 1);
    assert_int_equal(trade_cheapest(&table, 1e-2, false), 4);
    assert_int_equal(trade_cheapest(&table, 5e-3, false), 3);
    assert_int_equal(trade_cheapest(&table, 1e-3, false), 3);
    assert_int_equal(trade_cheapest(&table, 9e-4, false), table.num_positions);
    assert_int_equal(trade_most_accurate(&table, false), 3);
    assert_int_equal(trade_most_accurate(&failed, false), 1);
    for (size_t i = 0; i < table.num_positions; i++)
        assert_int_equal(trade_is_dominated(&table, i, false), dominated[i]);
}

/* For stationary and for transient scenes a size is chosen by different measurements. */
static void in_time_it_may_be_another(void **state) {
    trade_position positions[] = {measured(1e-3, 1, 0), measured(1e-2, 2, 0)};
    const trade_table table = {9, 1, 2, positions, {0}};
    (void)state;

    positions[0].worst_in_time[TRADE_CENTRAL_FILM] = 1e-1;
    positions[1].worst_in_time[TRADE_CENTRAL_FILM] = 1e-4;
    positions[0].step_seconds = positions[1].step_seconds = 1;
    assert_int_equal(trade_cheapest(&table, 1e-2, false), 0);
    assert_int_equal(trade_cheapest(&table, 1e-2, true), 1);
    assert_int_equal(trade_most_accurate(&table, true), 1);
    assert_true(trade_is_dominated(&table, 1, false) && !trade_is_dominated(&table, 1, true));
    positions[1].num_lost = 1;
    assert_int_equal(trade_cheapest(&table, 1e-2, true), 2);
}

/* The deviation of a size is the larger deviation of the two films. */
static void the_worse_film_is_the_price(void **state) {
    trade_position position = measured(1e-3, 2, 0);
    (void)state;

    check_close(trade_price_of(&position, false).deviation, 1e-3, 0, 0);
    position.deviation[TRADE_MINIMUM_FILM][TRADE_WORST] = 2e-3;
    check_close(trade_price_of(&position, false).deviation, 2e-3, 0, 0);
}

/* A size is not chosen if the error of its pressure spike exceeds three times the accuracy. If this
 * holds for all sizes, the size with the smallest error of the spike is chosen. */
static void pressures_may_be_off_three_times_as_much(void **state) {
    trade_position positions[] = {measured(1e-3, 1, 0), measured(1e-3, 2, 0), measured(1e-3, 3, 0)};
    const trade_table table = {100, 0, 3, positions, {0}};
    (void)state;

    positions[0].deviation[TRADE_PRESSURE][TRADE_WORST] = 4e-2;
    positions[1].deviation[TRADE_PRESSURE][TRADE_WORST] = 2e-2;
    positions[2].deviation[TRADE_PRESSURE][TRADE_WORST] = 1e-2;
    assert_int_equal(trade_cheapest(&table, 2e-2, false), 0);
    assert_int_equal(trade_cheapest(&table, 1e-2, false), 1);
    assert_int_equal(trade_cheapest(&table, 5e-3, false), 2);
    assert_int_equal(trade_cheapest(&table, 2e-3, false), 2);
    assert_int_equal(trade_cheapest(&table, 5e-4, false), 3);
}

/* If error estimates exist, the estimate that 90 % of the scenes meet is used instead of the worst
 * deviation. */
static void an_indicator_takes_the_place_of_the_worst(void **state) {
    trade_position positions[] = {measured(1e-3, 2, 0), measured(1e-1, 1, 3),
                                  measured(1e-9, 0.5, 3)};
    const trade_table table = {100, 0, 3, positions, {0}};
    (void)state;

    for (size_t i = 0; i < 3; i++)
        positions[i].indicator_factor = 1;
    positions[0].indicated[PART_90] = 4e-3;
    positions[1].indicated[PART_90] = 5e-3;
    positions[2].indicated[PART_90] = INFINITY;
    assert_int_equal(trade_cheapest(&table, 5e-3, false), 1);
    assert_int_equal(trade_cheapest(&table, 4.5e-3, false), 0);
    assert_int_equal(trade_cheapest(&table, 3e-3, false), 3);
    assert_int_equal(trade_most_accurate(&table, false), 0);
    assert_true(trade_is_dominated(&table, 2, false) && !trade_is_dominated(&table, 1, false));
}

static void the_factor_leaves_a_margin(void **state) {
    const double bounds[] = {1e-4, 0, 1e-2, 1e-5};
    double deviations[] = {1e-5, 1e-9, 1e-2, 1e-5};
    (void)state;

    const double factor = trade_indicator_factor(deviations, bounds, 4);
    for (size_t i = 0; i < 4; i++)
        assert_true(bounds[i] == 0 || factor * bounds[i] > 1.999 * deviations[i]);
    check_close(factor, 2, 1e-12, 0);
    check_close(trade_indicator_factor(deviations, bounds, 0), 0, 0, 0);
}

static double indicated_with(const double *deviations, const double *bounds, size_t count,
                             bool with_offset, double bound) {
    indicator_shape shape;

    check_ok(trade_indicator_shape(&shape, deviations, bounds, count, with_offset, &error));
    return trade_indicated(trade_indicator_factor(deviations, bounds, count), shape, bound);
}

/* A bound comes from a linear estimate and is too small for large errors. Here deviations are up to
 * (1 + 1e3 bound) times the bound. The fit finds this factor, which is small for small bounds. */
static void a_factor_grows_with_the_bound(void **state) {
    enum { NUM = 9 };
    double bounds[NUM], deviations[NUM];
    (void)state;

    for (size_t i = 0; i < NUM; i++) {
        bounds[i] = pow(10, -(double)(1 + i));
        deviations[i] = (i % 2 == 0 ? 1 : 0.3) * (1 + 1e3 * bounds[i]) * bounds[i];
    }
    for (size_t i = 0; i < NUM; i++) {
        const double found = indicated_with(deviations, bounds, NUM, false, bounds[i]);
        check_close(found, 2 * (1 + 1e3 * bounds[i]) * bounds[i], 1e-5, 0);
    }
    // for bounds above the bounds of all scenes the largest factor is used; infinity and NaN stay
    check_close(indicated_with(deviations, bounds, NUM, false, 1), 2 * 101, 1e-5, 0);
    assert_true(isinf(indicated_with(deviations, bounds, NUM, false, INFINITY)));
    assert_true(isnan(indicated_with(deviations, bounds, NUM, false, NAN)));
}

/* If the ratios of deviation to bound do not increase with the bound, the largest ratio is used for
 * all bounds. Without scenes the result is the default shape. */
static void a_factor_may_be_the_same_for_all(void **state) {
    const double bounds[] = {1e-6, 0, 1e-5, INFINITY, 1e-3};
    const double deviations[] = {3e-6, 1, 1e-5, 1, 5e-4};
    indicator_shape none;
    (void)state;

    for (double bound = 1e-9; bound < 1; bound *= 10)
        check_close(indicated_with(deviations, bounds, 5, false, bound), 6 * bound, 1e-12, 0);
    check_ok(trade_indicator_shape(&none, deviations, bounds, 0, true, &error));
    assert_memory_equal(&none, &plain_shape, sizeof none);
}

/* If an exit is wrong by a node, the deviation is large, but no bound shows this. With an offset in
 * the fit, such a scene does not increase the estimates of all other scenes. */
static void an_offset_takes_what_no_bound_tells(void **state) {
    enum { NUM = 9 };
    double bounds[NUM], deviations[NUM];
    (void)state;

    for (size_t i = 0; i < NUM; i++) {
        bounds[i] = pow(10, -(double)(1 + i));
        deviations[i] = i == 5 ? 5e-4 : bounds[i];
    }
    for (size_t i = 0; i <= 5; i++) {
        const double without = indicated_with(deviations, bounds, NUM, false, bounds[i]);
        const double with = indicated_with(deviations, bounds, NUM, true, bounds[i]);
        check_close(without, 2 * 500 * bounds[i], 1e-12, 0);
        check_close(with, 2 * fmin(500 * bounds[i], 5e-4 + bounds[i]), 1e-9, 0);
    }
}

/* All scenes of the calibration have the same small deviation, so an offset alone would cover them.
 * For larger bounds the estimate must still grow in proportion to the bound. The factor is one, or
 * the largest ratio of deviation to bound if this is less. */
static void no_offset_is_a_ceiling(void **state) {
    enum { NUM = 9 };
    double bounds[NUM] = {0}, deviations[NUM] = {0};
    (void)state;

    for (double largest = 0.01; largest < 1e4; largest *= 10) {
        for (size_t i = 0; i < NUM; i++) {
            bounds[i] = pow(10, -(double)(1 + i));
            deviations[i] = largest * bounds[NUM - 1];
        }
        double before = indicated_with(deviations, bounds, NUM, true, bounds[0]);
        for (double bound = 10 * bounds[0]; bound < 1e4; bound *= 10) {
            const double here = indicated_with(deviations, bounds, NUM, true, bound);
            assert_true(here - before >= 0.999 * trade_margin * fmin(largest, 1) * 0.9 * bound);
            before = here;
        }
    }
}

/* With random bounds, the estimate for every scene is at least twice the scene's deviation. */
static void scenes_are_covered_whatever_the_bound(void **state) {
    enum { NUM = 30 };
    double bounds[NUM], deviations[NUM];
    (void)state;

    srand(7);
    for (int trial = 0; trial < 200; trial++) {
        for (size_t i = 0; i < NUM; i++) {
            bounds[i] = pow(10, -9.0 * rand() / RAND_MAX);
            deviations[i] = bounds[i] * pow(10, 3.0 * rand() / RAND_MAX - 2);
        }
        for (size_t i = 0; i < 2 * (size_t)NUM; i++)
            assert_true(indicated_with(deviations, bounds, NUM, i % 2, bounds[i / 2]) >
                        1.999 * deviations[i / 2]);
    }
}

// ---- choice by --accuracy

static void accuracy_chooses_the_fastest_and_the_best(void **state) {
    trade_position positions[] = {measured(1e-1, 1, 0), measured(1e-2, 2e-3, 0),
                                  measured(1e-3, 3e-3, 0), measured(1e-9, 1e-3, 1)};
    const trade_table table = {9, 0, 4, positions, {0}};
    accuracy_choice choice;
    (void)state;

    for (size_t i = 0; i < 4; i++)
        positions[i].sizes = (model_sizes){10 + i, 0, 20 + i};
    check_ok(accuracy_choose(&choice, &table, 2e-2, false, "m.h5", &error));
    assert_memory_equal(&choice.fastest, &positions[1].sizes, sizeof choice.fastest);
    assert_memory_equal(&choice.most_accurate, &positions[2].sizes, sizeof choice.most_accurate);
    assert_string_equal(choice.note,
                        "11 pressure modes, 21 rows, the fastest of 4 sizes whose films were at "
                        "most so far off: 0.01 on 9 scenes, in 2 ms");
    for (size_t i = 0; i < 4; i++) {
        positions[i].indicator_factor = 1;
        positions[i].indicated[PART_90] = i == 3 ? INFINITY : 5e-3;
    }
    check_ok(accuracy_choose(&choice, &table, 2e-2, false, "m.h5", &error));
    assert_string_equal(choice.note,
                        "11 pressure modes, 21 rows, the fastest of 4 sizes whose films were "
                        "indicated to be at most so far off: 0.005 on 90 % of 9 scenes, in 2 ms");
}

static void accuracy_goes_by_the_steps_in_time(void **state) {
    trade_position positions[] = {measured(1e-3, 1, 0), measured(1e-2, 2, 0)};
    const trade_table table = {9, 3, 2, positions, {0}}, still = {9, 0, 2, positions, {0}};
    accuracy_choice choice;
    (void)state;

    positions[0].sizes = (model_sizes){10, 4, 20};
    positions[1].sizes = (model_sizes){12, 5, 24};
    positions[0].worst_in_time[TRADE_CENTRAL_FILM] = 1;
    positions[1].worst_in_time[TRADE_CENTRAL_FILM] = 0.25;
    positions[0].step_seconds = 1e-4;
    positions[1].step_seconds = 2e-4;
    check_ok(accuracy_choose(&choice, &table, 0.5, true, "m.h5", &error));
    assert_string_equal(choice.note,
                        "12 pressure modes, 5 deformation modes, 24 rows, the fastest of 2 sizes "
                        "whose central film was at most so far off: 0.25 on 3 trajectories, in "
                        "0.2 ms a step");
    assert_int_equal(accuracy_choose(&choice, &still, 0.5, true, "m.h5", &error), EHD_DATA);
    assert_string_equal(error.text,
                        "m.h5: found a calibration without trajectories, expected some");
}

/* If error estimates exist, the chosen size meets the accuracy on as many trajectories as any other
 * size, and on at least half of all trajectories. Of such sizes the fastest is chosen. */
static void accuracy_goes_by_the_most_trajectories(void **state) {
    trade_position positions[] = {measured(1e-3, 1, 0), measured(1e-3, 2, 0), measured(1e-3, 3, 0)};
    const trade_table table = {9, 10, 3, positions, {0}};
    accuracy_choice choice;
    (void)state;

    for (size_t i = 0; i < 3; i++) {
        positions[i].sizes = (model_sizes){10 + i, 0, 20 + 2 * i};
        positions[i].factor_in_time = 1;
        positions[i].step_seconds = 1e-4 * (double)(i + 1);
        // Of the three sizes, 60, 80 and 80 % of the trajectories have estimates of at most 1e-3.
        // The other trajectories have the estimate 1, like lost trajectories (trade.h).
        for (int k = 0; k < NUM_TIME_PARTS; k++)
            positions[i].indicated_in_time[k] = k > (i == 0 ? 1 : 3) ? 1 : 1e-3 / (double)(i + 1);
    }
    assert_int_equal(trade_cheapest(&table, 1e-3, true), 1);
    assert_int_equal(trade_cheapest(&table, 4e-4, true), 2);
    assert_int_equal(trade_cheapest(&table, 1e-4, true), 3); // no trajectory meets this accuracy
    assert_int_equal(trade_most_accurate(&table, true), 2);
    check_close(trade_part_in_time(&positions[0], 1e-3), 0.6, 0, 0);
    check_ok(accuracy_choose(&choice, &table, 1e-3, true, "m.h5", &error));
    assert_non_null(strstr(choice.note, "films were indicated to be at most so far off: 0.001 on "
                                        "80 % of 10 trajectories, in 0.2 ms a step"));
    // if no size meets the accuracy, the most accurate size is chosen, and each step is checked
    check_ok(accuracy_choose(&choice, &table, 1e-4, true, "m.h5", &error));
    assert_memory_equal(&choice.fastest, &positions[2].sizes, sizeof choice.fastest);
    assert_string_equal(choice.note,
                        "12 pressure modes, 24 rows, the most accurate of 3 sizes: on half of 10 "
                        "trajectories its films were indicated to be at most 0.000333 off, more "
                        "than that; each step is judged by its own");
    // the order is: fewer lost trajectories, more accurate trajectories, less time
    positions[0].num_lost = positions[2].num_lost = 2;
    positions[1].num_lost = 3;
    assert_int_equal(trade_cheapest(&table, 1e-3, true), 2);
    assert_int_equal(trade_cheapest(&table, 5e-4, true), 2);
    positions[0].num_lost = 1;
    assert_int_equal(trade_cheapest(&table, 1e-3, true), 0);
    assert_false(trade_is_dominated(&table, 2, true));
    assert_false(trade_is_dominated(&table, 1, true));
    positions[1].indicated_in_time[0] = 1e-3;
    assert_true(trade_is_dominated(&table, 1, true));
    // the most accurate size has the smallest geometric mean of all quantiles of the estimates; a
    // lost trajectory counts with the estimate 1
    for (int k = 0; k < NUM_TIME_PARTS; k++) {
        positions[1].indicated_in_time[k] = 5e-4;
        positions[2].indicated_in_time[k] = k > 0 ? 1 : 1e-4;
    }
    assert_int_equal(trade_most_accurate(&table, true), 1);
    for (size_t i = 0; i < 3; i++)
        positions[i].indicated_in_time[0] = 1; // more than half are lost
    assert_int_equal(accuracy_choose(&choice, &table, 1e-3, true, "m.h5", &error), EHD_DATA);
}

/* The limit in an error message is accepted as the accuracy, although its digits are rounded. */
static void accuracy_names_what_it_can_give(void **state) {
    trade_position position = measured(0, 1, 0);
    const trade_table table = {9, 0, 1, &position, {0}};
    accuracy_choice choice;
    (void)state;

    for (double best = 1e-12; best < 0.9; best *= 1.0371) {
        position.deviation[TRADE_CENTRAL_FILM][TRADE_WORST] = best;
        assert_int_equal(accuracy_choose(&choice, &table, best / 2, false, "m.h5", &error),
                         EHD_DATA);
        double least = strtod(strstr(error.text, "at least ") + strlen("at least "), NULL);
        check_close(least, best, 0.012, 0);
        check_ok(accuracy_choose(&choice, &table, least, false, "m.h5", &error));
    }
    position.num_failures = 1;
    assert_int_equal(accuracy_choose(&choice, &table, 1, false, "m.h5", &error), EHD_DATA);
    assert_non_null(strstr(error.text, "found no size of m.h5 that solved enough of the 9 scenes"));
}

static void a_promise_is_kept_or_the_result_flagged(void **state) {
    const struct {
        double central, minimum, accuracy;
        ehd_status before, after;
        const char *words;
    } cases[] = {
        {1e-3, 1e-3, 1e-3, EHD_OK, EHD_OK, ""},
        {1.01e-3, 0, 1e-3, EHD_OK, EHD_UNTRUSTED,
         "0.001 of the central film, more than the --accuracy of 0.001"},
        {0, 1.01e-3, 1e-3, EHD_OK, EHD_UNTRUSTED, "0.001 of the minimum film, more than the"},
        {INFINITY, 1, 1e-3, EHD_OK, EHD_UNTRUSTED, "inf of the central film"},
        {0, INFINITY, 1e-3, EHD_OK, EHD_UNTRUSTED, "inf of the minimum film"},
        {NAN, NAN, 1e-3, EHD_OK, EHD_OK, ""}, // this size was not calibrated
        {1, 1, 1e-3, EHD_NOT_CONVERGED, EHD_NOT_CONVERGED, ""},
        // without --accuracy
        {0.99e-2, 0.99e-2, 0, EHD_OK, EHD_OK, ""},
        {0, 1.01e-2, 0, EHD_OK, EHD_UNTRUSTED, "more than holds without --accuracy, 0.01"},
        {NAN, NAN, 0, EHD_OK, EHD_OK, ""}};
    (void)state;

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        run_result result = {.indicated_deviation = cases[i].central,
                             .indicated_deviation_minimum = cases[i].minimum,
                             .status = cases[i].before};
        accuracy_judge(&result, cases[i].accuracy);
        assert_int_equal(result.status, cases[i].after);
        assert_int_equal(result.reason[0] != '\0', cases[i].words[0] != '\0');
        assert_non_null(strstr(result.reason, cases[i].words));
    }
    check_close(accuracy_tolerance(1e-2), 2e-4, 1e-12, 0);
    check_close(accuracy_tolerance(1e-12), 1e-8, 0, 0); // the tolerance without --accuracy
}

// ---- measuring

/* Compares a model with full solutions of the training. If some values of the full solutions are
 * changed, the measured deviations equal these changes. */
static void a_full_model_deviates_by_what_it_is_told(void **state) {
    const double film = 1.25, pressure = 0.8;
    const size_t num_nodes = training.set.grid.num_nodes;
    solved_scene scenes[TRAINED_STATES];
    double *shifted = malloc(num_nodes * sizeof *shifted);
    online_model *model;
    online_solver *solver;
    online_result result;
    trade_position position = {0};
    (void)state;

    assert_non_null(shifted);
    check_ok(online_open(&model, path, NULL, &error));
    check_ok(online_solver_create(&solver, model, &error));
    for (size_t s = 0; s < TRAINED_STATES; s++) {
        check_ok(online_solve(&result, solver, &training.contacts[s], &error));
        scenes[s] = (solved_scene){&training.contacts[s], training.pressure + s * num_nodes,
                                   result.scalars};
    }
    check_ok(online_prepare_fields(model, &error));
    check_ok(calibration_measure(&position, model, scenes, TRAINED_STATES, &error));
    assert_int_equal(position.num_failures, 0);
    check_close(position.deviation[TRADE_CENTRAL_FILM][TRADE_WORST], 0, 0, 1e-12);
    check_close(position.deviation[TRADE_PRESSURE][TRADE_WORST], 0, 0, 1e-4);
    assert_true(position.seconds > 0 && position.max_iterations >= position.mean_iterations &&
                position.mean_iterations >= 1);

    memcpy(shifted, scenes[3].pressure, num_nodes * sizeof *shifted);
    shifted[60] += 0.25;
    scenes[3].pressure = shifted;
    scenes[3].scalars.central_film_thickness *= film;
    scenes[4].scalars.minimum_film_thickness *= film;
    scenes[5].scalars.central_pressure *= pressure;
    check_ok(calibration_measure(&position, model, scenes, TRAINED_STATES, &error));
    check_close(position.deviation[TRADE_CENTRAL_FILM][TRADE_WORST], 0.2, 1e-9, 0);
    check_close(position.deviation[TRADE_MINIMUM_FILM][TRADE_WORST], 0.2, 1e-9, 0);
    check_close(position.deviation[TRADE_CENTRAL_PRESSURE][TRADE_WORST], 0.25, 1e-9, 0);
    check_close(position.deviation[TRADE_PRESSURE][TRADE_WORST], 0.25, 1e-3, 0);
    check_close(position.deviation[TRADE_CENTRAL_FILM][TRADE_MEDIAN], 0, 0, 1e-12);
    online_solver_free(solver);
    online_close(model);
    free(shifted);
}

static void scenes_that_fail_count_as_failures_only(void **state) {
    ehd_contact outside = training.contacts[0];
    solved_scene scenes[] = {{.contact = &outside, .pressure = training.pressure}};
    online_model *model;
    trade_position position = {0};
    (void)state;

    contact_set_moes(&outside, 30, 3);
    check_ok(online_open(&model, path, NULL, &error));
    check_ok(calibration_measure(&position, model, scenes, 1, &error));
    assert_int_equal(position.num_failures, 1);
    assert_true(isnan(position.deviation[TRADE_CENTRAL_FILM][TRADE_WORST]));
    assert_true(isnan(position.seconds) && isnan(position.mean_iterations));
    online_close(model);
}

static void failing_allocations_are_reported(void **state) {
    const double *pressure = training.pressure;
    const solved_scene scenes[] = {
        {&training.contacts[0], pressure, {.central_film_thickness = 1}}};
    online_model *model;
    trade_position position = {0};
    size_t call = 0;
    (void)state;

    check_ok(online_open(&model, path, NULL, &error));
    check_ok(online_prepare_fields(model, &error));
    for (;; call++) {
        allocation_fail_at(call);
        ehd_status status = calibration_measure(&position, model, scenes, 1, &error);
        if (!allocation_failed()) break;
        assert_int_equal(status, EHD_MEMORY);
    }
    assert_true(call > 40);
    online_close(model);
}

// ---- the file

static void write_table(const trade_table *table) {
    static const artefact_schema *const kinds[] = {&schema_model, NULL};
    static char *words[] = {"romrun", NULL};
    const program self = {
        .name = "romrun", .argc = 1, .argv = words, .force = true, .output = calibrated};
    artefact *model, *file;

    check_ok(artefact_open(&model, path, kinds, &error));
    check_ok(artefact_create(&file, calibrated, &schema_model, &self, "", NULL, &error));
    check_ok(artefact_copy(file, model, trade_axes, &error));
    check_ok(trade_write(file, table, &error));
    check_ok(artefact_finish(&file, &error));
    artefact_close(&model);
}

static void a_table_comes_back(void **state) {
    trade_position positions[] = {measured(0.125, 2e-4, 0), measured(NAN, NAN, 7)};
    const trade_table table = {7, 2, 2, positions, {0}};
    trade_table found;
    online_model *model;
    (void)state;

    positions[0].sizes = (model_sizes){9, 0, 20};
    positions[1].sizes = (model_sizes){12, 0, 121};
    positions[0].mean_iterations = 4.5;
    positions[0].max_iterations = 9;
    positions[0].num_lost = 1;
    positions[0].step_iterations = 3.5;
    positions[0].step_seconds = 1e-4;
    positions[0].indicator_factor = 0.75;
    positions[0].indicator_factor_minimum = 1.5;
    positions[0].largest_residual = 1e-4;
    for (int q = 0; q < NUM_INDICATED; q++)
        positions[0].other_factor[q] = 1 + 0.5 * q;
    for (int q = 0; q < NUM_BOUNDED; q++)
        positions[0].shape[q] = (indicator_shape){1.0 / (2 + q), 10 * q, 0.1 * q, 0.5};
    for (int i = 0; i < NUM_TRADE_PARTS; i++) {
        positions[0].indicated[i] = i < 3 ? 1e-3 * (1 + i) : INFINITY;
        positions[0].effectivity[i] = 2 + i;
    }
    for (int q = 0; q < TRADE_PRESSURE; q++)
        positions[0].worst_in_time[q] = 0.5 + q;
    for (int q = 0; q < NUM_TRADE_QUANTITIES; q++)
        for (int i = 0; i < NUM_TRADE_QUANTILES; i++)
            positions[0].deviation[q][i] = q + 0.1 * i;
    write_table(&table);
    check_ok(artefact_check(calibrated, &error));
    check_ok(trade_read(&found, calibrated, &error));
    assert_int_equal(found.num_scenes, 7);
    assert_int_equal(found.num_trajectories, 2);
    assert_int_equal(found.num_positions, 2);
    assert_memory_equal(&found.positions[0], &positions[0], sizeof positions[0]);
    assert_memory_equal(&found.positions[1].sizes, &positions[1].sizes, sizeof(model_sizes));
    assert_int_equal(found.positions[1].num_failures, 7);
    assert_true(isnan(found.positions[1].seconds));
    trade_free(&found);
    // the file with the table can still be opened as a model
    check_ok(online_open(&model, calibrated, &(part_sizes){{positions[0].sizes}}, &error));
    assert_int_equal(online_describe(model).rows, 20);
    online_close(model);
}

static void table_is_refused(const trade_table *table, const char *words_of_it) {
    trade_table found;

    write_table(table);
    assert_int_equal(trade_read(&found, calibrated, &error), EHD_DATA);
    assert_non_null(strstr(error.text, words_of_it));
    assert_null(found.positions);
}

static void tables_that_do_not_fit_are_refused(void **state) {
    trade_position position = measured(0.1, 1, 0);
    trade_table table = {3, 0, 1, &position, {0}}, found;
    (void)state;

    assert_int_equal(trade_read(&found, path, &error), EHD_DATA);
    assert_non_null(strstr(error.text, "found a model that is not calibrated"));
    position.sizes = (model_sizes){13, 0, 30};
    table_is_refused(&table, "position_pressure_modes: found 13, expected 1 to 12");
    position.sizes = (model_sizes){12, 1, 30};
    table_is_refused(&table, "position_deformation_modes: found 1, expected 0 to 0");
    position.sizes = (model_sizes){12, 0, 0};
    table_is_refused(&table, "position_rows: found 0, expected 1 to 121");
    position.sizes.rows = 30;
    position.num_failures = 4;
    table_is_refused(&table, "position_failures: found 4, expected 0 to 3");
    position.num_failures = 0;
    position.num_lost = 6;
    table.num_trajectories = 5;
    table_is_refused(&table, "position_lost_trajectories: found 6, expected 0 to 5");
    table.num_trajectories = 0;
    position.deviation[TRADE_PRESSURE][TRADE_95] = -1;
    table_is_refused(&table, "deviation_pressure: found -1, expected at least 0");
    table.num_scenes = 0;
    table_is_refused(&table, "calibration_scenes: found 0");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_ladder_goes_from_ten_modes_to_all),
        cmocka_unit_test(every_position_can_be_opened),
        cmocka_unit_test(quantiles_are_values_of_the_set),
        cmocka_unit_test(the_cheapest_that_is_good_enough),
        cmocka_unit_test(in_time_it_may_be_another),
        cmocka_unit_test(the_worse_film_is_the_price),
        cmocka_unit_test(pressures_may_be_off_three_times_as_much),
        cmocka_unit_test(an_indicator_takes_the_place_of_the_worst),
        cmocka_unit_test(the_factor_leaves_a_margin),
        cmocka_unit_test(a_factor_grows_with_the_bound),
        cmocka_unit_test(a_factor_may_be_the_same_for_all),
        cmocka_unit_test(an_offset_takes_what_no_bound_tells),
        cmocka_unit_test(no_offset_is_a_ceiling),
        cmocka_unit_test(scenes_are_covered_whatever_the_bound),
        cmocka_unit_test(accuracy_chooses_the_fastest_and_the_best),
        cmocka_unit_test(accuracy_goes_by_the_steps_in_time),
        cmocka_unit_test(accuracy_goes_by_the_most_trajectories),
        cmocka_unit_test(accuracy_names_what_it_can_give),
        cmocka_unit_test(a_promise_is_kept_or_the_result_flagged),
        cmocka_unit_test(a_full_model_deviates_by_what_it_is_told),
        cmocka_unit_test(scenes_that_fail_count_as_failures_only),
        cmocka_unit_test(failing_allocations_are_reported),
        cmocka_unit_test(a_table_comes_back),
        cmocka_unit_test(tables_that_do_not_fit_are_refused),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
