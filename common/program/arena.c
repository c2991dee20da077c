/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/program/arena.h"

#include <stdlib.h>

/* Header in front of each array. */
struct arena_block {
    arena_block *before;
    max_align_t array[];
};

/* Computes *bytes = more + rows * columns * size. Returns false if it overflows. */
static bool count_bytes(size_t *bytes, size_t more, size_t rows, size_t columns, size_t size) {
    return !__builtin_mul_overflow(rows, columns, bytes) &&
           !__builtin_mul_overflow(*bytes, size, bytes) &&
           !__builtin_add_overflow(*bytes, more, bytes);
}

void *array_new(size_t rows, size_t columns, size_t size) {
    size_t bytes;

    return count_bytes(&bytes, 1, rows, columns, size) ? calloc(1, bytes) : NULL;
}

void *array_resize(void *array, size_t rows, size_t columns, size_t size) {
    size_t bytes;

    return count_bytes(&bytes, 1, rows, columns, size) ? realloc(array, bytes) : NULL;
}

void *arena_array(arena *self, size_t count, size_t size) {
    return arena_table(self, count, 1, size);
}

void *arena_table(arena *self, size_t rows, size_t columns, size_t size) {
    arena_block *block = NULL;
    size_t bytes;

    if (count_bytes(&bytes, sizeof *block + 1, rows, columns, size)) block = calloc(1, bytes);
    if (!block) {
        self->failed = true;
        return NULL;
    }
    block->before = self->last;
    self->last = block;
    return block->array;
}

void arena_free(arena *self) {
    while (self->last) {
        arena_block *before = self->last->before;
        free(self->last);
        self->last = before;
    }
    self->failed = false;
}
