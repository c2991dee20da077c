/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/bench/measure.h"

#include <stdio.h>
#include <stdlib.h>

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
