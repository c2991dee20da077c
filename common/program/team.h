/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Threads that share one piece of work, such as a loop over the nodes of a grid.
 *
 * The list is cut into parts that depend on its length alone, and each part is done by whoever is free:
 * what a part computes, and sums of the parts in their order, have the same bits with any number of
 * threads. */
#ifndef EHD_TEAM_H
#define EHD_TEAM_H

#include <stddef.h>

typedef struct team team;

/* A part of a list. */
typedef struct team_part {
    size_t first, end; // things of the list, the last one excluded
    size_t number;     // of the part, from 0 on
    size_t member;     // who does it: 0 is the caller, below team_size
} team_part;

typedef void team_task(void *context, const team_part *part);

/* So many members, of which the caller is one; fewer where no more threads can be had. NULL, which all
 * functions take for the caller alone: one is enough, or no memory. They wait without taking time. */
team *team_create(size_t num_members);
team *team_free(team *self); // accepts and returns NULL
size_t team_size(const team *self);

/* Parts of a list, each of `size` things but for the last one. */
size_t team_num_parts(size_t count, size_t size);

/* Does the task for all parts of a list of `count` things and returns when they are done. One call at a
 * time. */
void team_share(team *self, size_t count, size_t size, team_task *task, void *context);

#endif
