/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The least value along the nodes of a band, from few of them. */
#ifndef EHD_BAND_MINIMUM_H
#define EHD_BAND_MINIMUM_H

#include <stddef.h>

/* The least of value(context, node) over first <= node <= last: a coarse look at about 25 nodes, and then every
 * dip that it shows from near, since in time a film may have several. What is narrower than a stride of the
 * coarse look, a 24th of the band, may be missed. */
double band_minimum(double (*value)(const void *context, size_t node), const void *context,
                    size_t first, size_t last);

#endif
