/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the minimum of values over a range of nodes from few evaluations, by a coarse and a fine
 * search (romrun/online/README.md, The smallest film).
 * Called by node_state.c for the minimum film. */
#ifndef EHD_BAND_MINIMUM_H
#define EHD_BAND_MINIMUM_H

#include <stddef.h>

/* Values at the nodes of a band. `at` returns the value at a node. `around` is called for a node
 * whose value is smaller than the values at its neighbours. It returns the minimum of the values
 * interpolated between the nodes around this node. If `around` is NULL, the value at the node is
 * used. */
typedef struct band_values {
    double (*at)(const void *context, size_t node);
    double (*around)(const void *context, size_t node);
    const void *context;
} band_values;

/* Returns the smallest of `values` over first <= node <= last, and its node. It searches coarsely
 * at about 25 nodes, then finely in each local minimum. All local minima are searched, because the
 * film of a transient contact may have several minima, and the node with the smallest film need not
 * lie in the deepest minimum. A minimum that is narrower than a coarse stride (a 24th of the band)
 * may be missed. */
double band_minimum(size_t *node, const band_values *values, size_t first, size_t last);

#endif
