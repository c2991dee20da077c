/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measures how many stationary contacts the library solves in a second on one core, each with
 * another value of one setting:
 *
 *     bench_solve MODEL SCENE.yml COUNT KEY FROM TO
 *
 * Solves COUNT contacts with KEY from FROM to TO, by ehdrom_contact_set_number and ehdrom_solve.
 * Prints the median of nine runs, in processor time. */
#include "romrun/library/ehdrom.h"
#include "tests/bench/measure.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { REPEATS = 9 };

static void check(ehdrom_status status, const char *text) {
    if (!status) return;
    fprintf(stderr, "bench_solve: %s\n", text);
    exit(1);
}

static void sweep(ehdrom_contact *contact, const char *key, double from, double to, size_t count) {
    ehdrom_result result = EHDROM_RESULT_INIT;

    for (size_t i = 0; i < count; i++) {
        const double value = from + (to - from) * (double)i / (double)count;
        check(ehdrom_contact_set_number(contact, key, value), ehdrom_contact_error(contact));
        check(ehdrom_solve(contact, &result), ehdrom_contact_error(contact));
    }
}

int main(int argc, char **argv) {
    if (argc != 7) {
        fputs("usage: bench_solve MODEL SCENE.yml COUNT KEY FROM TO\n", stderr);
        return 64;
    }
    const size_t count = strtoul(argv[3], NULL, 10);
    double rates[REPEATS];
    char text[SPREAD_TEXT];
    ehdrom_model *model;
    ehdrom_contact *contact;

    check(ehdrom_model_open(&model, argv[1], NULL), ehdrom_model_error(model));
    check(ehdrom_contact_create(&contact, model), "found no memory");
    check(ehdrom_contact_read(contact, argv[2]), ehdrom_contact_error(contact));
    check(ehdrom_contact_set_units(contact, EHDROM_DIMENSIONLESS), ehdrom_contact_error(contact));
    check(ehdrom_contact_set_accuracy(contact, INFINITY), ehdrom_contact_error(contact));
    for (int i = 0; i < REPEATS; i++) {
        const clock_t before = clock();
        sweep(contact, argv[4], strtod(argv[5], NULL), strtod(argv[6], NULL), count);
        rates[i] = (double)count / ((double)(clock() - before) / CLOCKS_PER_SEC);
    }
    const spread found = spread_of(rates, REPEATS);
    printf("%zu contacts: %s a second of processor time\n", count, spread_text(text, &found, 1, 0));
    ehdrom_contact_free(contact);
    ehdrom_model_close(model);
    return 0;
}
