/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/online/band_minimum.h"

#include <math.h>

enum { COARSE = 24 }; // strides of the coarse search

typedef struct band {
    double (*value)(const void *context, size_t node);
    const void *context;
    size_t first, last;
} band;

/* A node and its value. */
typedef struct candidate {
    size_t node;
    double value;
} candidate;

/* Smallest value near a node, by ever shorter strides around the best one so far. */
static candidate refine_minimum(const band *self, size_t best, size_t stride) {
    double smallest = INFINITY;

    while (stride > 1) {
        stride = (stride + 2) / 4;
        size_t reach = 4 * stride;
        size_t from = best > self->first + reach ? best - reach : self->first;
        size_t to = best + reach < self->last ? best + reach : self->last;
        for (size_t node = from; node <= to; node += stride) {
            double value = self->value(self->context, node);
            if (!(value < smallest)) continue;
            smallest = value;
            best = node;
        }
    }
    return (candidate){best, smallest};
}

size_t band_minimum(double (*value)(const void *context, size_t node), const void *context,
                    size_t first, size_t last) {
    const band self = {value, context, first, last};
    size_t stride = (last - first) / COARSE + 1, count = (last - first) / stride + 1;
    double coarse[COARSE + 1];
    candidate smallest = {first, INFINITY};

    for (size_t i = 0; i < count; i++) {
        coarse[i] = value(context, first + i * stride);
        if (coarse[i] < smallest.value) smallest = (candidate){first + i * stride, coarse[i]};
    }
    for (size_t i = 0; i < count; i++) {
        if ((i > 0 && coarse[i - 1] <= coarse[i]) || (i + 1 < count && coarse[i + 1] < coarse[i]))
            continue;
        const candidate fine = refine_minimum(&self, first + i * stride, stride);
        if (fine.value < smallest.value) smallest = fine;
    }
    return smallest.node;
}
