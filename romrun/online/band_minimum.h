/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Minimum over the nodes of a band from few evaluations. */
#ifndef EHD_BAND_MINIMUM_H
#define EHD_BAND_MINIMUM_H

#include <stddef.h>

/* The node with the minimum of value(context, node) over first <= node <= last: a coarse search at about 25 nodes,
 * then a fine one in each of its local minima, of which a film may have several in time. One
 * narrower than a coarse stride, a 24th of the band, may be missed. */
size_t band_minimum(double (*value)(const void *context, size_t node), const void *context,
                    size_t first, size_t last);

#endif
