/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/state/band_minimum.h"

#include <math.h>

/* Number of strides of the coarse search. If there are only 2 strides, the search misses dips
 * (test_band_minimum.c, one_dip_anywhere). */
enum { COARSE = 24 };

typedef struct band {
    const band_values *values;
    size_t first, last;
} band;

typedef struct candidate {
    size_t node;
    double value;
} candidate;

static double value_at(const band *self, size_t node) {
    return self->values->at(self->values->context, node);
}

/* Returns the smallest value near the node of `best`. Searches around the node with the smallest
 * value found so far, with shorter and shorter strides. */
static candidate refine_minimum(const band *self, candidate best, size_t stride) {
    while (stride > 1) {
        stride = (stride + 2) / 4;
        size_t reach = 4 * stride;
        size_t from = best.node > self->first + reach ? best.node - reach : self->first;
        size_t to = best.node + reach < self->last ? best.node + reach : self->last;
        for (size_t node = from; node <= to; node += stride) {
            double value = value_at(self, node);
            if (value < best.value) best = (candidate){node, value};
        }
    }
    return best;
}

double band_minimum(size_t *node, const band_values *values, size_t first, size_t last) {
    const band self = {values, first, last};
    size_t stride = (last - first) / COARSE + 1, count = (last - first) / stride + 1;
    double coarse[COARSE + 1], smallest = INFINITY;

    *node = first;
    for (size_t i = 0; i < count; i++)
        coarse[i] = value_at(&self, first + i * stride);
    for (size_t i = 0; i < count; i++) {
        if ((i > 0 && coarse[i - 1] <= coarse[i]) || (i + 1 < count && coarse[i + 1] < coarse[i]))
            continue;
        const candidate start = {first + i * stride, coarse[i]};
        const candidate fine = refine_minimum(&self, start, stride);
        const double here =
            values->around ? values->around(values->context, fine.node) : fine.value;
        if (!(here < smallest)) continue;
        smallest = here;
        *node = fine.node;
    }
    return smallest;
}
