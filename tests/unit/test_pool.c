/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Threads that solve the points of a tree. Each point is solved once, after its parent, with any
 * number of workers. */
#include "common/training/pool.h"
#include "tests/unit/allocation.h"
#include "tests/unit/check.h"

#include <pthread.h>
#include <sched.h>
#include <string.h>
#include <unistd.h>

enum { NUM_POINTS = 40, NONE = -1 };

/* Counts of calls, and the calls that the test lets fail. Several threads may be in `begin`, `end`
 * and `solve` at a time, so these functions use `lock`. Only one thread at a time is in `start` or
 * `finish`, so these functions need no lock. */
typedef struct notes {
    pthread_mutex_t lock;
    const size_t *parent;
    int started[NUM_POINTS], solved[NUM_POINTS], finished[NUM_POINTS];
    int begun, ended;
    int inside;        // number of threads in `start` or `finish`
    int failing_point; // NONE: no point fails
    bool failing_begin;
    int max_begun;   // number of workers that get memory in `begin`; 0: all workers get memory
    bool too_late;   // workers without memory fail only after all points are solved
    int num_refused; // number of calls of `solve`, from the first one on, that get no memory
    bool repeatable;
    bool wrong_order;
    int sum[NUM_POINTS]; // number of the point + sum of its parent
} notes;

static bool all_solved(notes *self) {
    bool all = true;
    pthread_mutex_lock(&self->lock);
    for (size_t i = 0; i < NUM_POINTS; i++)
        all = all && self->solved[i] > 0;
    pthread_mutex_unlock(&self->lock);
    return all;
}

static ehd_status begin(void **worker, void *shared, ehd_error *error) {
    notes *self = shared;
    pthread_mutex_lock(&self->lock);
    const bool fails =
        self->failing_begin || (self->max_begun > 0 && self->begun >= self->max_begun);
    self->begun++;
    pthread_mutex_unlock(&self->lock);
    while (fails && self->too_late && !all_solved(self))
        sched_yield();
    *worker = self;
    return fails ? ehd_fail(error, EHD_MEMORY, "begin failed") : EHD_OK;
}

static void end(void *worker) {
    notes *self = worker;
    pthread_mutex_lock(&self->lock);
    self->ended++;
    pthread_mutex_unlock(&self->lock);
}

static ehd_status start(void *shared, void *worker, size_t point, size_t parent, ehd_error *error) {
    notes *self = shared;
    (void)worker, (void)parent, (void)error;
    self->wrong_order |= self->inside++ != 0;
    self->started[point]++;
    self->inside--;
    return EHD_OK;
}

static ehd_status solve(void *shared, void *worker, size_t point, size_t parent, ehd_error *error) {
    notes *self = shared;
    (void)worker;
    usleep((unsigned)(point % 3) * 300);
    pthread_mutex_lock(&self->lock);
    const bool refused = self->num_refused > 0;
    if (refused) self->num_refused--;
    pthread_mutex_unlock(&self->lock);
    if (refused) return ehd_fail(error, EHD_MEMORY, "point %zu found no memory", point);
    pthread_mutex_lock(&self->lock);
    self->solved[point]++;
    self->sum[point] = (int)point + (parent == NO_PARENT ? 0 : self->sum[parent]);
    pthread_mutex_unlock(&self->lock);
    if ((int)point != self->failing_point) return EHD_OK;
    return ehd_fail(error, EHD_INTERNAL, "point %zu failed", point);
}

static ehd_status finish(void *shared, void *worker, size_t point, size_t parent,
                         ehd_error *error) {
    notes *self = shared;
    (void)worker, (void)error;
    self->wrong_order |= self->inside++ != 0 || parent != self->parent[point] ||
                         (parent != NO_PARENT && !self->finished[parent]);
    self->finished[point]++;
    self->inside--;
    return EHD_OK;
}

/* Makes a binary heap: the parent of k is (k-1)/2. */
static void make_tree(size_t parent[NUM_POINTS], size_t order[NUM_POINTS]) {
    for (size_t i = 0; i < NUM_POINTS; i++)
        parent[i] = i == 0 ? NO_PARENT : (i - 1) / 2;
    assert_int_equal(tree_order(order, parent, NUM_POINTS, NULL), EHD_OK);
}

static ehd_status run(notes *self, size_t num_workers, const bool *done, ehd_error *error) {
    size_t parent[NUM_POINTS], order[NUM_POINTS];
    make_tree(parent, order);
    self->parent = parent;
    const pool_work work = {.num_points = NUM_POINTS,
                            .parent = parent,
                            .order = order,
                            .done = done,
                            .num_workers = num_workers,
                            .shared = self,
                            .begin = begin,
                            .end = end,
                            .repeatable = self->repeatable,
                            .start = start,
                            .solve = solve,
                            .finish = finish};
    ehd_status status = pool_run(&work, error);
    assert_int_equal(self->begun, self->ended);
    assert_false(self->wrong_order);
    return status;
}

static notes new_notes(void) {
    return (notes){.lock = PTHREAD_MUTEX_INITIALIZER, .failing_point = NONE};
}

static void test_every_point_once(void **state) {
    const size_t counts[] = {1, 2, 7, 100};
    (void)state;

    for (size_t k = 0; k < sizeof counts / sizeof *counts; k++) {
        notes noted = new_notes();
        assert_int_equal(run(&noted, counts[k], NULL, NULL), EHD_OK);
        for (size_t i = 0; i < NUM_POINTS; i++) {
            assert_int_equal(noted.started[i], 1);
            assert_int_equal(noted.solved[i], 1);
            assert_int_equal(noted.finished[i], 1);
        }
        assert_int_equal(noted.sum[39], 39 + 19 + 9 + 4 + 1);
        assert_in_range(noted.begun, 1, counts[k]);
    }
}

static ehd_status count_point(void *shared, void *worker, size_t point, size_t parent,
                              ehd_error *error) {
    int *finished = shared;
    (void)error;
    assert_null(worker);
    assert_int_equal(parent, NO_PARENT);
    finished[point]++;
    return EHD_OK;
}

static ehd_status do_nothing(void *shared, void *worker, size_t point, size_t parent,
                             ehd_error *error) {
    (void)shared, (void)worker, (void)point, (void)parent, (void)error;
    return EHD_OK;
}

/* Points without parents, without a given order and without data for each thread are finished once
 * each. */
static void test_a_plain_list(void **state) {
    int finished[NUM_POINTS] = {0};
    const pool_work work = {.num_points = NUM_POINTS,
                            .num_workers = 3,
                            .shared = finished,
                            .solve = do_nothing,
                            .finish = count_point};
    (void)state;

    assert_int_equal(pool_run(&work, NULL), EHD_OK);
    for (size_t i = 0; i < NUM_POINTS; i++)
        assert_int_equal(finished[i], 1);
}

static ehd_status count_up(void *shared, void *worker, size_t point, size_t parent,
                           ehd_error *error) {
    size_t *count = shared;
    (void)worker, (void)error;
    assert_true(parent == NO_PARENT || parent == (point < 1000 ? 0 : point - 1000));
    ++*count;
    return EHD_OK;
}

/* Solves a million points: first without parents, then in a thousand chains from one root. If the
 * search for the next point always began at the first point, this test would take many minutes. */
static void test_many_points(void **state) {
    const size_t num_points = 1000000;
    size_t *parent = test_malloc(num_points * sizeof *parent), count = 0;
    pool_work work = {.num_points = num_points,
                      .num_workers = 2,
                      .shared = &count,
                      .solve = do_nothing,
                      .finish = count_up};
    (void)state;

    assert_non_null(parent);
    assert_int_equal(pool_run(&work, NULL), EHD_OK);
    assert_int_equal(count, num_points);
    for (size_t i = 0; i < num_points; i++)
        parent[i] = i == 0 ? NO_PARENT : i < 1000 ? 0 : i - 1000;
    work.parent = parent;
    count = 0;
    assert_int_equal(pool_run(&work, NULL), EHD_OK);
    assert_int_equal(count, num_points);
    test_free(parent);
}

static void test_done_points_are_left_alone(void **state) {
    bool done[NUM_POINTS];
    notes noted = new_notes();
    (void)state;

    for (size_t i = 0; i < NUM_POINTS; i++) {
        done[i] = i != 38 && i != 5;
        noted.finished[i] = done[i];
    }
    assert_int_equal(run(&noted, 2, done, NULL), EHD_OK);
    for (size_t i = 0; i < NUM_POINTS; i++)
        assert_int_equal(noted.solved[i], !done[i]);
    done[38] = done[5] = true;
    noted = new_notes();
    assert_int_equal(run(&noted, 2, done, NULL), EHD_OK);
    assert_int_equal(noted.begun, 0);
}

static void test_a_failure_stops_the_pool(void **state) {
    (void)state;
    for (size_t num_workers = 1; num_workers < 5; num_workers++) {
        notes noted = new_notes();
        ehd_error error = {""};
        noted.failing_point = 1;
        assert_int_equal(run(&noted, num_workers, NULL, &error), EHD_INTERNAL);
        assert_string_equal(error.text, "point 1 failed");
        assert_int_equal(noted.finished[1], 0);
        for (size_t i = 3; i < NUM_POINTS; i++)
            if ((i - 1) / 2 == 1) assert_int_equal(noted.solved[i], 0);
    }
}

static void test_a_worker_that_cannot_begin(void **state) {
    notes noted = new_notes();
    ehd_error error = {""};
    (void)state;

    noted.failing_begin = true;
    assert_int_equal(run(&noted, 3, NULL, &error), EHD_MEMORY);
    assert_string_equal(error.text, "begin failed");
}

static void check_all_solved_once(const notes *noted) {
    for (size_t i = 0; i < NUM_POINTS; i++) {
        assert_int_equal(noted->solved[i], 1);
        assert_int_equal(noted->finished[i], 1);
    }
}

static void test_workers_without_memory_leave_the_work_to_others(void **state) {
    (void)state;
    for (int enough = 1; enough < 7; enough++) {
        notes noted = new_notes();
        noted.max_begun = (enough - 1) % 3 + 1;
        noted.too_late = enough > 3; // the other workers must not wait for the failing ones
        assert_int_equal(run(&noted, 4, NULL, NULL), EHD_OK);
        check_all_solved_once(&noted);
    }
    for (int refused = 1; refused < 4; refused++) {
        notes noted = new_notes();
        noted.num_refused = refused;
        noted.repeatable = true;
        assert_int_equal(run(&noted, 4, NULL, NULL), EHD_OK);
        check_all_solved_once(&noted);
    }
}

static void test_the_last_worker_says_that_there_is_no_memory(void **state) {
    (void)state;
    for (int num_workers = 1; num_workers < 4; num_workers++) {
        notes noted = new_notes();
        ehd_error error = {""};
        noted.num_refused = num_workers;
        noted.repeatable = true;
        assert_int_equal(run(&noted, (size_t)num_workers, NULL, &error), EHD_MEMORY);
        assert_non_null(strstr(error.text, "found no memory"));
    }
    // if the work is not repeatable, a point without memory makes the pool fail
    notes noted = new_notes();
    noted.num_refused = 1;
    assert_int_equal(run(&noted, 4, NULL, NULL), EHD_MEMORY);
}

static void test_no_memory(void **state) {
    ehd_status status;
    (void)state;
    for (size_t call = 1; call < 6; call++) { // call 0 is made by the test itself
        notes noted = new_notes();
        allocation_fail_at(call);
        status = run(&noted, 2, NULL, NULL);
        assert_true(allocation_failed());
        // if there is no memory for the list of threads, the caller's thread works alone
        assert_int_equal(status, call < 5 ? EHD_MEMORY : EHD_OK);
    }
}

static void test_workers_are_the_allowed_processors(void **state) {
    cpu_set_t allowed, one;
    size_t first = 0;
    (void)state;
    assert_int_equal(sched_getaffinity(0, sizeof allowed, &allowed), 0);
    assert_int_equal(pool_default_workers(), CPU_COUNT(&allowed));
    while (!CPU_ISSET(first, &allowed))
        first++;
    CPU_ZERO(&one);
    CPU_SET(first, &one);
    assert_int_equal(sched_setaffinity(0, sizeof one, &one), 0);
    assert_int_equal(pool_default_workers(), 1);
    assert_int_equal(sched_setaffinity(0, sizeof allowed, &allowed), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_point_once),
        cmocka_unit_test(test_a_plain_list),
        cmocka_unit_test(test_many_points),
        cmocka_unit_test(test_done_points_are_left_alone),
        cmocka_unit_test(test_a_failure_stops_the_pool),
        cmocka_unit_test(test_a_worker_that_cannot_begin),
        cmocka_unit_test(test_workers_without_memory_leave_the_work_to_others),
        cmocka_unit_test(test_the_last_worker_says_that_there_is_no_memory),
        cmocka_unit_test(test_no_memory),
        cmocka_unit_test(test_workers_are_the_allowed_processors),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
