/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/program/arena.h"

#include <stdlib.h>

/* Stands before each array. */
struct arena_block {
    arena_block *before;
    max_align_t array[];
};

void *arena_array(arena *self, size_t count, size_t size) {
    arena_block *block = NULL;
    size_t bytes;

    if (!__builtin_mul_overflow(count, size, &bytes) &&
        !__builtin_add_overflow(bytes, sizeof *block + 1, &bytes))
        block = calloc(1, bytes);
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
