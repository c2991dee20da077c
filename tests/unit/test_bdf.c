/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Difference formulas in time, and the ring that holds the previous states (bdf.h). */
#include "common/time/bdf.h"
#include "tests/unit/check.h"
#include "tests/unit/frames.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

/* Lengths of the current and the two previous time steps of an adaptive march: equal, growing,
 * shrinking, and changing irregularly. */
static const double steps[][3] = {
    {0.1, 0.1, 0.1}, {0.2, 0.1, 0.05}, {0.05, 0.1, 0.2}, {0.03, 0.3, 0.01}, {1e-6, 0.5, 0.5}};
enum { NUM_STEPS = sizeof steps / sizeof *steps };

static double power(double time, size_t exponent) {
    return exponent == 0 ? 1 : pow(time, (double)exponent);
}

// ---- formula

/* The formula is exact for polynomials up to its order, and not for higher degrees. */
static void formula_is_exact_to_its_order(void **state) {
    (void)state;
    for (size_t s = 0; s < NUM_STEPS; s++)
        for (size_t num_previous = 1; num_previous <= BDF_PREVIOUS; num_previous++) {
            bdf_formula formula = bdf_step(steps[s][0], steps[s] + 1, num_previous);
            double time[BDF_PREVIOUS + 1];
            fill_times(time, 0.7, steps[s]);
            assert_int_equal(formula.order, num_previous > 1 ? 2 : 1);
            for (size_t n = 0; n <= formula.order + 1; n++) {
                double rate = formula.rate * power(time[0], n);
                for (size_t i = 0; i < num_previous; i++)
                    rate += formula.weight[i] * power(time[i + 1], n);
                double exact = n == 0 ? 0 : (double)n * power(time[0], n - 1);
                if (n <= formula.order)
                    check_close(rate, exact, 1e-14, 1e-14 * formula.rate);
                else
                    assert_false(is_close(rate, exact, 1e-14, 1e-14 * formula.rate));
            }
            for (size_t i = formula.order; i < BDF_PREVIOUS; i++)
                check_close(formula.weight[i], 0, 0, 0);
        }
}

static void predictor_is_exact_to_its_degree(void **state) {
    (void)state;
    for (size_t s = 0; s < NUM_STEPS; s++)
        for (size_t num_previous = 1; num_previous <= BDF_PREVIOUS; num_previous++) {
            bdf_formula formula = bdf_step(steps[s][0], steps[s] + 1, num_previous);
            double time[BDF_PREVIOUS + 1];
            fill_times(time, 0.7, steps[s]);
            for (size_t n = 0; n < num_previous; n++) {
                double value = 0, size = 1;
                for (size_t i = 0; i < num_previous; i++) {
                    value += formula.predictor[i] * power(time[i + 1], n);
                    size += fabs(formula.predictor[i]);
                }
                check_close(value, power(time[0], n), 0, 1e-15 * size);
            }
        }
}

/* If the previous states are exact, the solution of dy/dT = given has only the local error. For the
 * lowest power of T that the formula does not solve exactly, this error is exactly formula.error
 * times the difference between exact solution and prediction. */
static void error_is_that_of_the_next_power(void **state) {
    (void)state;
    for (size_t s = 0; s < NUM_STEPS; s++)
        for (size_t num_previous = 2; num_previous <= BDF_PREVIOUS; num_previous++) {
            bdf_formula formula = bdf_step(steps[s][0], steps[s] + 1, num_previous);
            // with two previous states, formula.error belongs to the formula of first order
            bdf_formula judged = bdf_step(steps[s][0], steps[s] + 1, num_previous - 1);
            size_t n = num_previous;
            double time[BDF_PREVIOUS + 1], given, solution, prediction = 0;
            fill_times(time, 0, steps[s]);
            given = 0; // derivative of T^n at 0
            solution = given;
            for (size_t i = 0; i < num_previous; i++) {
                solution -= judged.weight[i] * power(time[i + 1], n);
                prediction += formula.predictor[i] * power(time[i + 1], n);
            }
            solution /= judged.rate; // the exact solution is 0
            assert_true(formula.error > 0);
            check_close(formula.error * fabs(0 - prediction), fabs(solution), 1e-9, 1e-300);
        }
    check_close(bdf_step(0.1, NULL, 1).error, 0, 0, 0);
}

/* Tests a time step after much shorter steps. If an earlier state is far enough away in time, the
 * formula has second order and uses the latest of these states. Otherwise it has first order. */
static void a_step_much_longer_than_the_last_is_of_lower_order(void **state) {
    (void)state;
    const struct {
        double intervals[2];
        size_t num_previous, order, second;
    } cases[] = {
        {{0.05, 0.05}, 3, 2, 1}, {{0.041, 0.05}, 3, 2, 2}, {{0.042, 0.05}, 2, 2, 1},
        {{1e-7, 0.05}, 3, 2, 2}, {{1e-7, 1e-7}, 3, 1, 0},  {{0.041, 0}, 2, 1, 0},
        {{0, 0}, 3, 1, 0},
    };
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        const double step = c == 5 ? 0.0991 : 0.1, *intervals = cases[c].intervals;
        const bdf_formula formula = bdf_step(step, intervals, cases[c].num_previous);
        double rate = formula.rate, weights = fabs(formula.rate), predicted = 0, sum = 0;
        assert_int_equal(formula.order, cases[c].order);
        assert_int_equal(formula.num_weighted, cases[c].second + 1);
        for (size_t i = 0; i < BDF_PREVIOUS; i++) {
            rate += formula.weight[i];
            weights += fabs(formula.weight[i]);
            predicted += fabs(formula.predictor[i]);
            sum += formula.predictor[i];
            assert_true(i == 0 || i == cases[c].second || formula.weight[i] == 0);
        }
        // errors of the states are not amplified: the growth limit of the formula is 1 + sqrt(2)
        check_close(rate, 0, 0, 1e-14 * weights);
        check_close(sum, 1, 1e-13, 0);
        assert_true(weights / formula.rate < 2 * (2 + sqrt(2)));
        assert_true(predicted < 50);
        assert_true(formula.error > 0);
    }
}

/* States 1e-7 apart in time have errors of 1e-9. The error after a step of 0.1 must also be about
 * 1e-9. */
static void a_short_step_does_not_enlarge_what_states_are_off(void **state) {
    (void)state;
    const double off = 1e-9, values[BDF_PREVIOUS] = {1 + off, 1 - off, 1};
    const double intervals[][2] = {{1e-7, 1e-7}, {1e-7, 0.1}, {0.1, 1e-7}};
    for (size_t c = 0; c < sizeof intervals / sizeof *intervals; c++) {
        const bdf_formula formula = bdf_step(0.1, intervals[c], 3);
        double solution = 0, prediction = 0;
        for (size_t i = 0; i < 3; i++) {
            solution -= formula.weight[i] * values[i] / formula.rate;
            prediction += formula.predictor[i] * values[i];
        }
        check_close(solution, 1, 0, 3 * off);
        check_close(formula.error * (solution - prediction), 0, 0, 20 * off);
    }
}

// ---- ring

static void ring_keeps_the_last_states(void **state) {
    (void)state;
    bdf_ring ring = bdf_ring_empty();
    double content[BDF_PREVIOUS + 1] = {0};

    assert_int_equal(ring.num_previous, 0);
    for (int step = 0; step < 9; step++) {
        double time = 0.1 * step * step;
        content[ring.place[0]] = time;
        bdf_ring_accept(&ring, time, 0);
        assert_int_equal(ring.num_previous, step < BDF_PREVIOUS ? step + 1 : BDF_PREVIOUS);
        for (size_t i = 1; i <= ring.num_previous; i++) {
            double before = 0.1 * (step + 1 - (int)i) * (step + 1 - (int)i);
            check_close(content[ring.place[i]], before, 0, 0);
            check_close(ring.time[ring.place[i]], before, 0, 0);
            assert_int_not_equal(ring.place[0], ring.place[i]);
        }
    }
}

static bdf_ring after_times(const double *times, size_t count, double least) {
    bdf_ring ring = bdf_ring_empty();

    for (size_t i = 0; i < count; i++)
        bdf_ring_accept(&ring, times[i], least);
    return ring;
}

static double accepted_time(const bdf_ring *ring, size_t before) {
    return ring->time[bdf_ring_accepted(ring, before)];
}

/* If steps are shorter than the least interval, the ring keeps only some of their states; the
 * others are passing (bdf.h). If steps grow, the ring keeps all states. */
static void states_that_follow_too_soon_are_passing(void **state) {
    (void)state;
    const double times[] = {0, 1, 2, 2.25, 2.5, 3.25, 4.25, 4.5, 5.25};
    const bool passing[] = {false, false, false, true, true, false, false, true, false};
    for (size_t count = 1; count <= 9; count++) {
        bdf_ring ring = after_times(times, count, 1);
        assert_int_equal(ring.passing, passing[count - 1]);
        check_close(accepted_time(&ring, 1), times[count - 1], 0, 0);
        for (size_t i = 1; i < ring.num_previous; i++)
            assert_true(ring.time[ring.place[i]] - ring.time[ring.place[i + 1]] >= 1);
        if (!passing[count - 1]) continue;
        const double last = ring.time[ring.place[1]];
        assert_true(last < times[count - 1]);
        check_close(accepted_time(&ring, 2), last, 0, 0);
        bdf_ring promoted = ring;
        bdf_ring_promote(&promoted);
        assert_false(promoted.passing);
        assert_int_equal(promoted.num_previous, BDF_PREVIOUS);
        for (size_t i = 1; i <= BDF_PREVIOUS; i++)
            assert_int_equal(promoted.place[i], bdf_ring_accepted(&ring, i));
        bdf_ring_restart(&ring); // makes the passing state the only previous state
        assert_int_equal(ring.num_previous, 1);
        check_close(ring.time[ring.place[1]], times[count - 1], 0, 0);
    }
    const double growing[] = {0, 0.1, 0.3, 0.7, 1.5, 2.5};
    for (size_t count = 1; count <= 6; count++)
        assert_false(after_times(growing, count, 1).passing);
}

static void ring_gives_the_formula_of_its_times(void **state) {
    (void)state;
    for (size_t num_previous = 1; num_previous <= BDF_PREVIOUS; num_previous++) {
        bdf_ring ring = bdf_ring_empty();
        const double times[] = {0, 0.25, 0.375}, backwards[] = {0.125, 0.25};
        for (size_t i = 0; i < num_previous; i++)
            bdf_ring_accept(&ring, times[i], 0);
        bdf_formula ours = bdf_ring_formula(&ring, 0.5);
        bdf_formula expected =
            bdf_step(0.5, num_previous == 2 ? backwards + 1 : backwards, num_previous);
        assert_memory_equal(&ours, &expected, sizeof ours);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(formula_is_exact_to_its_order),
        cmocka_unit_test(predictor_is_exact_to_its_degree),
        cmocka_unit_test(error_is_that_of_the_next_power),
        cmocka_unit_test(a_step_much_longer_than_the_last_is_of_lower_order),
        cmocka_unit_test(a_short_step_does_not_enlarge_what_states_are_off),
        cmocka_unit_test(ring_keeps_the_last_states),
        cmocka_unit_test(states_that_follow_too_soon_are_passing),
        cmocka_unit_test(ring_gives_the_formula_of_its_times),
    };
    return cmocka_run_group_tests_name("bdf", tests, NULL, NULL);
}
