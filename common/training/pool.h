/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Threads that work through the points of a tree, each point after its parent. */
#ifndef EHD_POOL_H
#define EHD_POOL_H

#include "common/program/status.h"
#include "common/training/tree.h"
#include <stdbool.h>
#include <stddef.h>

/* The work on one point. `worker` is what the thread's `begin` made. */
typedef ehd_status pool_task(void *shared, void *worker, size_t point, size_t parent,
                             ehd_error *error);

typedef struct pool_work {
    size_t num_points;
    const size_t *parent; // [num_points]; NULL: no point waits for another
    const size_t
        *order; // [num_points], which free point is taken first (tree_order); NULL: as numbered
    const bool *done;    // [num_points], from an earlier run; NULL: none
    size_t num_workers;  // threads at most
    void *shared;        // handed to all tasks
    double worker_bytes; // memory that a thread needs for itself, where that is much; 0: little
    // what a thread needs for itself, such as a solver; NULL: nothing
    ehd_status (*begin)(void **worker, void *shared, ehd_error *error);
    void (*end)(void *worker);
    bool repeatable;   // what solve leaves where it fails does not disturb another attempt
    pool_task *solve;  // several at a time; `finish` of the parent has returned
    pool_task *start;  // one at a time with `finish`, before solve: for progress; NULL: none
    pool_task *finish; // one at a time, such as writing to a file; NULL: none
} pool_work;

/* Returns EHD_OK when all points are finished; else the first error, after the points under way; or
 * EHD_INTERRUPTED with an empty text when a signal came. A thread that is refused memory, by `begin` or
 * by a `solve` that is repeatable, ends and leaves its point to the others; where there are none,
 * EHD_MEMORY. */
ehd_status pool_run(const pool_work *work, ehd_error *error);

/* Returns the number of processors that this process may use, at least 1. */
size_t pool_default_workers(void);

#endif
