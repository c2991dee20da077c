/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Allocates arrays whose size is a product that may overflow, for example of lengths read from a
 * file. An arena is a group of arrays that are freed together: an object with many arrays takes all
 * of them from one arena, checks once whether memory was refused, and frees all arrays by one
 * call. */
#ifndef EHD_ARENA_H
#define EHD_ARENA_H

#include <stdbool.h>
#include <stddef.h>

/* Returns a zeroed array of `rows` times `columns` elements of `size` bytes; free with free(). The
 * array is never of size zero. Returns NULL if memory is refused or the product overflows. */
void *array_new(size_t rows, size_t columns, size_t size);
/* Resizes an array like realloc, to `rows` times `columns` elements. New elements are not zeroed.
 * Returns NULL and leaves the old array if memory is refused or the product overflows. */
void *array_resize(void *array, size_t rows, size_t columns, size_t size);

typedef struct arena_block arena_block;

/* An arena must be zero before its first use. */
typedef struct arena {
    arena_block *last;
    bool failed; // memory for an array was refused since the arena was last zero
} arena;

/* Returns an array of `count` zeroed elements of `size` bytes, aligned for any type. The array is
 * never of size zero, so that NULL always means that memory was refused or that count times size
 * overflows. */
void *arena_array(arena *self, size_t count, size_t size);
/* Returns an array of `rows` times `columns` zeroed elements, like arena_array. */
void *arena_table(arena *self, size_t rows, size_t columns, size_t size);

/* Frees all arrays and makes the arena zero again. */
void arena_free(arena *self);

#endif
