/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Failing allocations on purpose. All unit tests are linked so that malloc, calloc and realloc
 * called in our own code (not inside of foreign libraries) pass through here.
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

/* Lets allocation number `call` from now on return NULL, counted from 0, once. */
void allocation_fail_at(size_t call);

/* Whether it came to that; ends the counting. */
bool allocation_failed(void);

#endif
