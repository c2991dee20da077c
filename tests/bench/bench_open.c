/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measures ehdrom_model_open for a model.h5 and for the flat model exported from it, with and
 * without checksum:
 *
 *     bench_open MODEL.h5 MODEL.ehdrom
 *
 * The files are already in memory, as when a program opens them again. The criterion is processor
 * time, which on an idle machine equals the elapsed time. The exit code is 1 if a flat model with
 * its checksum takes more than 5 ms. */
#include "romrun/library/ehdrom.h"
#include "tests/bench/measure.h"

#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <time.h>

enum { REPEATS = 31 };
static const double GOAL = 5e-3; // limit of the time, s

static double seconds_of(clockid_t clock) {
    struct timespec now;

    clock_gettime(clock, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static ehdrom_model *must_open(const char *path) {
    ehdrom_model *model;

    if (!ehdrom_model_open(&model, path, NULL)) return model;
    fprintf(stderr, "bench_open: %s\n", ehdrom_model_error(model));
    exit(1);
}

/* Returns the median of the processor time, s. */
static double measure(const char *path, const char *checksum) {
    double processor[REPEATS], passed[REPEATS];
    char text[SPREAD_TEXT], text_passed[SPREAD_TEXT];
    struct stat file;

    setenv("EHDROM_DIGEST", checksum, 1);
    ehdrom_model_close(must_open(path)); // brings the file into the file cache
    for (int i = 0; i < REPEATS; i++) {
        const double started = seconds_of(CLOCK_MONOTONIC);
        const double before = seconds_of(CLOCK_PROCESS_CPUTIME_ID);
        ehdrom_model *model = must_open(path);
        processor[i] = seconds_of(CLOCK_PROCESS_CPUTIME_ID) - before;
        passed[i] = seconds_of(CLOCK_MONOTONIC) - started;
        ehdrom_model_close(model);
    }
    const spread found = spread_of(processor, REPEATS), clock = spread_of(passed, REPEATS);
    if (stat(path, &file)) exit(1);
    printf("%-28s %5.1f MB, checksum %-3s: %s ms of processor time, %s ms passed\n", path,
           (double)file.st_size * 1e-6, checksum, spread_text(text, &found, 1e-3, 2),
           spread_text(text_passed, &clock, 1e-3, 2));
    return found.median;
}

int main(int argc, char **argv) {
    if (argc != 3) {
        fputs("usage: bench_open MODEL.h5 MODEL.ehdrom\n", stderr);
        return 64;
    }
    measure(argv[1], "yes");
    measure(argv[1], "no");
    const double flat = measure(argv[2], "yes");
    measure(argv[2], "no");
    return flat <= GOAL ? 0 : 1;
}
