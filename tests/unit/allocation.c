/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/unit/allocation.h"

#include <errno.h>

// the linker's --wrap option gives these names
void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *memory, size_t size);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *memory, size_t size);

static bool counting, failed;
static size_t remaining;

void allocation_fail_at(size_t call) {
    remaining = call;
    failed = false;
    counting = true;
}

bool allocation_failed(void) {
    counting = false;
    return failed;
}

static bool fails_now(void) {
    if (!counting || remaining-- > 0) return false;
    counting = false;
    failed = true;
    errno = ENOMEM;
    return true;
}

void *__wrap_malloc(size_t size) {
    return fails_now() ? NULL : __real_malloc(size);
}

void *__wrap_calloc(size_t count, size_t size) {
    return fails_now() ? NULL : __real_calloc(count, size);
}

void *__wrap_realloc(void *memory, size_t size) {
    return fails_now() ? NULL : __real_realloc(memory, size);
}
