/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Memory that is freed together: an object with many arrays takes all of them from one arena, asks
 * once whether there was enough, and frees them by one call. */
#ifndef EHD_ARENA_H
#define EHD_ARENA_H

#include <stdbool.h>
#include <stddef.h>

typedef struct arena_block arena_block;

/* Zero before its first use. */
typedef struct arena {
    arena_block *last;
    bool failed; // an array was refused since it was zero
} arena;

/* An array of `count` zeroed elements of `size` bytes, aligned for any type; never of size zero, so
 * that NULL always means that there was no memory or that count times size overflows. */
void *arena_array(arena *self, size_t count, size_t size);

/* Frees all arrays and makes the arena zero again. */
void arena_free(arena *self);

#endif
