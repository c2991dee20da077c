/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measures transient contacts by the shared library, in threads of this program:
 *
 *     bench_many MODEL SCENE.yml STEPS CONTACTS [REPEATS]
 *
 * Each contact takes steps of 0.005 by ehdrom_step_many and ehdrom_accept, under a load that swings
 * by a tenth. With REPEATS the program runs one and two threads alternately, and compares their
 * shortest times. The exit code is 1 if two threads are less than 1.9 times as fast, or if one
 * waits for the other. On a busy machine the threads do not run all the time, so processor time is
 * compared instead: contention for memory or caches makes it longer, and a lock shows as waiting.
 * Without REPEATS the program runs once in one thread, for callgrind (costs.sh). */
#include <ehdrom.h>

#include <limits.h>
#include <math.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <time.h>

static const double STEP = 0.005, SWING = 0.1;
static const double GOAL = 1.9;
/* Least ratio of processor time to elapsed time on an idle machine. */
static const double IDLE = 0.98;
/* Largest allowed number of voluntary context switches. At the end one thread waits for the other.
 * A lock around each step causes 5 or more switches, although mostly the same thread takes the lock
 * again. */
static const long MOST_WAITS = 2;
enum { MOST_CONTACTS = 64 };

/* The work of a thread: all steps of its contacts. */
typedef struct share {
    ehdrom_contact **contacts;
    ehdrom_conditions *conditions;
    ehdrom_result *results;
    size_t count, num_steps;
} share;

static void must(ehdrom_status status, const char *text) {
    if (!EHDROM_FAILED(status) && status != EHDROM_NOT_CONVERGED) return;
    fprintf(stderr, "bench_many: %s\n", text);
    exit(1);
}

static void *step(void *argument) {
    const share *self = argument;
    const double pi = acos(-1);

    for (size_t i = 1; i <= self->num_steps; i++) {
        for (size_t k = 0; k < self->count; k++) {
            self->conditions[k] = (ehdrom_conditions)EHDROM_CONDITIONS_INIT;
            self->conditions[k].given = EHDROM_LOAD;
            self->conditions[k].load = 1 + SWING * sin(2 * pi * STEP * (double)i);
        }
        must(ehdrom_step_many(self->contacts, self->conditions, STEP, self->results, self->count),
             ehdrom_contact_error(self->contacts[0]));
        for (size_t k = 0; k < self->count; k++)
            must(ehdrom_accept(self->contacts[k]), ehdrom_contact_error(self->contacts[k]));
    }
    return NULL;
}

static double seconds(void) {
    struct timespec now;

    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void start(const share *all) {
    for (size_t k = 0; k < all->count; k++) {
        all->results[k] = (ehdrom_result)EHDROM_RESULT_INIT;
        must(ehdrom_start(all->contacts[k], NULL, &all->results[k]),
             ehdrom_contact_error(all->contacts[k]));
    }
}

typedef struct spent {
    double wall, processor;
    long waits; // voluntary context switches
} spent;

static long count_waits(void) {
    struct rusage used;

    getrusage(RUSAGE_SELF, &used);
    return used.ru_nvcsw;
}

static spent run(const share *all, int num_threads) {
    const size_t half = num_threads == 2 ? all->count / 2 : 0;
    share first = *all, second = *all;
    pthread_t thread;

    start(all);
    const double started = seconds();
    const clock_t before = clock();
    const long waits = count_waits();
    first.contacts += half;
    first.conditions += half;
    first.results += half;
    first.count -= half;
    second.count = half;
    if (half && pthread_create(&thread, NULL, step, &second)) exit(1);
    step(&first);
    if (half) pthread_join(thread, NULL);
    return (spent){seconds() - started, (double)(clock() - before) / CLOCKS_PER_SEC,
                   count_waits() - waits};
}

static void keep_least(spent *least, const spent *now) {
    least->wall = fmin(least->wall, now->wall);
    least->processor = fmin(least->processor, now->processor);
    if (now->waits < least->waits) least->waits = now->waits;
}

/* Prints the verdict and returns the exit code. */
static int judge(const spent *one, const spent *two) {
    const bool idle = one->processor > IDLE * one->wall && two->processor > IDLE * 2 * two->wall;
    const double faster = idle ? one->wall / two->wall : 2 * one->processor / two->processor;

    printf("judged by %s: two threads %.2f times (goal: %.2f), %ld waits (at most %ld)\n",
           idle ? "the time that passes" : "processor time, since the cores are busy", faster, GOAL,
           two->waits, MOST_WAITS);
    return faster >= GOAL && two->waits <= MOST_WAITS ? 0 : 1;
}

static int measure(const share *all, size_t repeats) {
    const spent never = {INFINITY, INFINITY, LONG_MAX};
    spent one = never, two = never;
    const double stepped = (double)(all->count * all->num_steps);

    for (size_t i = 0; i < repeats; i++) {
        const spent alone = run(all, 1), both = run(all, 2);
        keep_least(&one, &alone);
        keep_least(&two, &both);
    }
    printf("%zu contacts, %zu steps, least of %zu: one thread %.0f contacts a second, two threads "
           "%.0f: "
           "%.2f times, in %.2f times the processor time\n",
           all->count, all->num_steps, repeats, stepped / one.wall, stepped / two.wall,
           one.wall / two.wall, two.processor / one.processor);
    return judge(&one, &two);
}

int main(int argc, char **argv) {
    if (argc != 5 && argc != 6) {
        fputs("usage: bench_many MODEL SCENE.yml STEPS CONTACTS [REPEATS]\n", stderr);
        return 64;
    }
    static ehdrom_contact *contacts[MOST_CONTACTS];
    static ehdrom_conditions conditions[MOST_CONTACTS];
    static ehdrom_result results[MOST_CONTACTS];
    const share all = {contacts, conditions, results, strtoul(argv[4], NULL, 10),
                       strtoul(argv[3], NULL, 10)};
    ehdrom_model *model;

    if (all.count > MOST_CONTACTS) return 64;
    must(ehdrom_model_open(&model, argv[1], NULL), ehdrom_model_error(model));
    for (size_t k = 0; k < all.count; k++) {
        must(ehdrom_contact_create(&all.contacts[k], model), "contact");
        must(ehdrom_contact_read(all.contacts[k], argv[2]), ehdrom_contact_error(all.contacts[k]));
        must(ehdrom_contact_set_units(all.contacts[k], EHDROM_DIMENSIONLESS), "units");
    }
    int failed = 0;
    if (argc > 5)
        failed = measure(&all, strtoul(argv[5], NULL, 10));
    else
        run(&all, 1);
    for (size_t k = 0; k < all.count; k++)
        ehdrom_contact_free(all.contacts[k]);
    ehdrom_model_close(model);
    return failed;
}
