/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/bench/measure.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

static int compare(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

spread spread_of(double *values, size_t count) {
    qsort(values, count, sizeof *values, compare);
    return (spread){values[count / 2], values[0], values[count - 1]};
}

const char *spread_text(char text[SPREAD_TEXT], const spread *self, double unit, int digits) {
    snprintf(text, SPREAD_TEXT, "%.*f (%.*f to %.*f)", digits, self->median / unit, digits,
             self->least / unit, digits, self->most / unit);
    return text;
}

double growth_exponent(const double *nodes, const double *values, size_t count) {
    double sx = 0, sy = 0, sxx = 0, sxy = 0, n = (double)count;

    for (size_t i = 0; i < count; i++) {
        double x = log(nodes[i]), y = log(values[i]);
        sx += x;
        sy += y;
        sxx += x * x;
        sxy += x * y;
    }
    return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

void run_apart(void *result, size_t bytes, double *megabytes, void work(void *, const void *),
               const void *task) {
    struct rusage usage;
    int ends[2], status;

    if (pipe(ends)) abort();
    fflush(stdout);
    pid_t child = fork();
    if (child < 0) abort();
    if (child == 0) {
        work(result, task);
        _exit(write(ends[1], result, bytes) == (ssize_t)bytes ? 0 : 1);
    }
    close(ends[1]);
    if (read(ends[0], result, bytes) != (ssize_t)bytes) exit(1);
    close(ends[0]);
    if (wait4(child, &status, 0, &usage) != child || status != 0) exit(1);
    *megabytes = (double)usage.ru_maxrss / 1024;
}

void must(ehd_status status, const ehd_error *error) {
    if (status == EHD_OK) return;
    fprintf(stderr, "bench: %s\n", error->text);
    exit(1);
}

void *must_allocate(size_t bytes) {
    void *memory = calloc(bytes, 1);
    if (memory) return memory;
    fprintf(stderr, "bench: found no memory\n");
    exit(1);
}
