/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lets allocations fail on purpose. All unit tests are linked so that malloc, calloc and realloc
 * calls of our own code (not of foreign libraries) pass through the wrappers in allocation.c.
 *
 *     size_t call = 0;
 *     do {
 *         allocation_fail_at(call);
 *         status = function_under_test(...);
 *     } while (allocation_failed() && call++ < 1000);   // EHD_MEMORY each time, and no leak */
#ifndef EHD_ALLOCATION_H
#define EHD_ALLOCATION_H

#include <stdbool.h>
#include <stddef.h>

/* Makes one allocation return NULL: allocation number `call` after this call, counted from 0. */
void allocation_fail_at(size_t call);

/* Ends the counting. Returns whether the allocation that had to fail was reached. */
bool allocation_failed(void);

#endif
