/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Threads that share a list. Each part of the list is done once, by any free thread. Sums do not
 * depend on the number of threads. */
#include "common/program/team.h"
#include "tests/unit/allocation.h"
#include "tests/unit/check.h"

#include <math.h>
#include <sched.h>
#include <stdatomic.h>
#include <string.h>
#include <time.h>

enum { MOST_THINGS = 1000, MOST_MEMBERS = 7 };

/* How often each entry of the list was done, and the results of each part of the list. */
typedef struct notes {
    size_t done[MOST_THINGS];
    team_part parts[MOST_THINGS];
    double sums[MOST_THINGS];
} notes;

static void note(void *context, const team_part *part) {
    notes *self = context;

    self->parts[part->number] = *part;
    self->sums[part->number] = 0;
    for (size_t i = part->first; i < part->end; i++) {
        self->done[i]++;
        self->sums[part->number] += sin((double)i);
    }
}

static double sum_of(const notes *self, size_t num_parts) {
    double sum = 0;

    for (size_t i = 0; i < num_parts; i++)
        sum += self->sums[i];
    return sum;
}

/* Works on lists of all lengths in succession, so that for some lists threads come too late. */
static void everything_is_done_once(void **state) {
    (void)state;
    for (size_t members = 0; members <= MOST_MEMBERS; members++) {
        team *threads = team_create(members);
        assert_int_equal(team_size(threads), members > 1 ? members : 1);
        for (size_t count = 0; count <= MOST_THINGS; count += count < 20 ? 1 : 49) {
            const size_t size = 1 + count % 11, num_parts = team_num_parts(count, size);
            notes noted = {0}, alone = {0};

            assert_true(num_parts * size >= count &&
                        (count == 0 || (num_parts - 1) * size < count));
            team_share(threads, count, size, note, &noted);
            team_share(NULL, count, size, note, &alone);
            for (size_t i = 0; i < MOST_THINGS; i++)
                assert_int_equal(noted.done[i], i < count);
            for (size_t i = 0; i < num_parts; i++) {
                assert_int_equal(noted.parts[i].number, i);
                assert_int_equal(noted.parts[i].first, alone.parts[i].first);
                assert_int_equal(noted.parts[i].end, alone.parts[i].end);
                assert_true(noted.parts[i].member < team_size(threads));
                assert_int_equal(alone.parts[i].member, 0);
            }
            const double sum = sum_of(&noted, num_parts), expected = sum_of(&alone, num_parts);
            assert_memory_equal(&sum, &expected, sizeof sum);
        }
        assert_null(team_free(threads));
    }
}

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Waits until all members of the team are here at the same time, but at most a minute. */
static void meet(void *context, const team_part *part) {
    atomic_size_t *met = context;
    const double end = seconds() + 60;

    (void)part;
    atomic_fetch_add(met, 1);
    while (atomic_load(met) < MOST_MEMBERS && seconds() < end)
        sched_yield();
}

static void all_members_work_at_once(void **state) {
    (void)state;
    team *threads = team_create(MOST_MEMBERS);
    atomic_size_t met = 0;
    const double began = seconds();

    team_share(threads, MOST_MEMBERS, 1, meet, &met);
    assert_int_equal(met, MOST_MEMBERS);
    assert_true(seconds() < began + 60);
    team_free(threads);
}

static void without_memory_the_caller_works_alone(void **state) {
    (void)state;
    notes noted = {0};

    allocation_fail_at(0);
    team *threads = team_create(3);
    assert_true(allocation_failed());
    assert_null(threads);
    team_share(threads, 10, 3, note, &noted);
    for (size_t i = 0; i < 10; i++)
        assert_int_equal(noted.done[i], 1);
    assert_null(team_free(NULL));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(everything_is_done_once),
        cmocka_unit_test(all_members_work_at_once),
        cmocka_unit_test(without_memory_the_caller_works_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
