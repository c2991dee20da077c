/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs threads that work through the points of a tree (tree.h), each point after its parent.
 * Called by fullrun/training.c, by cases.c and recording.c in romrun/calibrate, and by snapgen. */
#ifndef EHD_POOL_H
#define EHD_POOL_H

#include "common/program/status.h"
#include "common/training/tree.h"
#include <stdbool.h>
#include <stddef.h>

/* A task for one point. `worker` is the object that `begin` made for the thread. */
typedef ehd_status pool_task(void *shared, void *worker, size_t point, size_t parent,
                             ehd_error *error);

typedef struct pool_work {
    size_t num_points;
    const size_t *parent; // [num_points]; NULL: no point waits for another
    const size_t *order;  // [num_points], order in which the points are solved (tree_order); NULL:
                          // by number
    const bool *done;     // [num_points], points that an earlier run has finished; NULL: none
    size_t num_workers;   // largest number of threads
    void *shared;         // handed to all tasks
    double worker_bytes;  // memory that one thread needs for its own data; 0: little
    // makes the data of one thread, such as a solver; NULL: a thread has no data
    ehd_status (*begin)(void **worker, void *shared, ehd_error *error);
    void (*end)(void *worker);
    bool repeatable; // another attempt can follow a failed solve
    // solves a point; several threads do so at a time, each point after `finish` of its parent
    pool_task *solve;
    // only one `start` or `finish` runs at a time
    pool_task *start;  // before `solve`, for example to show progress; NULL: none
    pool_task *finish; // after `solve`, for example to write a file; NULL: none
} pool_work;

/* Runs the tasks of all points. Returns EHD_OK when all points are finished. After a failure the
 * points under way are completed, and the first error is returned. After a signal this error is
 * EHD_INTERRUPTED with an empty text. A thread that is refused memory, by `begin` or by a
 * repeatable `solve`, ends and leaves its point to the other threads. If no thread is left, the
 * result is EHD_MEMORY. */
ehd_status pool_run(const pool_work *work, ehd_error *error);

/* Returns the number of processors that this process may use, at least 1. */
size_t pool_default_workers(void);

#endif
