/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Arrays whose size is a product that may not fit, as of lengths that stand in a file, and memory
 * that is freed together: an object with many arrays takes all of them from one arena, asks once
 * whether there was enough, and frees them by one call. */
#ifndef EHD_ARENA_H
#define EHD_ARENA_H

#include <stdbool.h>
#include <stddef.h>

/* A zeroed array of `rows` times `columns` elements of `size` bytes, never of size zero; free(). NULL
 * also where the product overflows. */
void *array_new(size_t rows, size_t columns, size_t size);
/* realloc for that many; what is new is not zeroed. NULL leaves the old array. */
void *array_resize(void *array, size_t rows, size_t columns, size_t size);

typedef struct arena_block arena_block;

/* Zero before its first use. */
typedef struct arena {
    arena_block *last;
    bool failed; // an array was refused since it was zero
} arena;

/* An array of `count` zeroed elements of `size` bytes, aligned for any type; never of size zero, so
 * that NULL always means that there was no memory or that count times size overflows. */
void *arena_array(arena *self, size_t count, size_t size);
/* The same of `rows` times `columns` elements. */
void *arena_table(arena *self, size_t rows, size_t columns, size_t size);

/* Frees all arrays and makes the arena zero again. */
void arena_free(arena *self);

#endif
