/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Minimum over the nodes of a band from few evaluations. */
#ifndef EHD_BAND_MINIMUM_H
#define EHD_BAND_MINIMUM_H

#include <stddef.h>

/* A value at each node of a band, and its minimum between the nodes around one that is lower than those
 * beside it; NULL: the node's value. */
typedef struct band_values {
    double (*at)(const void *context, size_t node);
    double (*around)(const void *context, size_t node);
    const void *context;
} band_values;

/* The least of `values` over first <= node <= last, and its node: a coarse search at about 25 nodes, then
 * a fine one in each of its local minima, of which a film may have several in time; the smallest node
 * need not be in the deepest of them. One narrower than a coarse stride, a 24th of the band, may be
 * missed. */
double band_minimum(size_t *node, const band_values *values, size_t first, size_t last);

#endif
