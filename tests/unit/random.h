/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random numbers with the same sequence on every machine (the generator of Knuth's MMIX). */
#ifndef EHD_RANDOM_H
#define EHD_RANDOM_H

#include <stdint.h>

/* Returns the next number, at least 0 and below 1. `seed` may start with any value. */
static inline double random_next(uint64_t *seed) {
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) * 0x1p-53;
}

#endif
