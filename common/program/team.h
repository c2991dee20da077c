/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shares one piece of work, such as a loop over the nodes of a grid, between threads.
 *
 * The work is a list of elements that is cut into parts. The parts do not depend on the number of
 * threads. Any free thread does the next part. The results of the parts, and sums over the parts in
 * their order, therefore have the same bits with any number of threads. */
#ifndef EHD_TEAM_H
#define EHD_TEAM_H

#include <stddef.h>

typedef struct team team;

/* A part of a list. */
typedef struct team_part {
    size_t first, end; // elements of the list, `end` excluded
    size_t number;     // number of the part, from 0 on
    size_t member;     // thread that does the part, below team_size; 0: the caller
} team_part;

typedef void team_task(void *context, const team_part *part);

/* Creates a team of `num_members` threads, of which the caller is one. The team is smaller if no
 * more threads can be created. Returns NULL if num_members is at most 1 or there is no memory. If a
 * function gets NULL as the team, the caller alone does the work. Waiting threads take no processor
 * time. */
team *team_create(size_t num_members);
team *team_free(team *self); // accepts and returns NULL
size_t team_size(const team *self);

/* Returns the number of parts of a list, each of `size` elements except for the last one. */
size_t team_num_parts(size_t count, size_t size);

/* Does the task for all parts of a list of `count` elements, and returns when they are done. Only
 * one call may run at a time. */
void team_share(team *self, size_t count, size_t size, team_task *task, void *context);

#endif
