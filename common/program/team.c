/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/program/team.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>

typedef struct team_member {
    team *of;
    size_t number;
    pthread_t thread;
} team_member;

/* The job that the threads are doing. */
typedef struct team_work {
    team_task *task;
    void *context;
    size_t count, size, num_parts;
} team_work;

struct team {
    pthread_mutex_t lock; // guards everything but `next`
    pthread_cond_t begun, ended;
    team_work work;
    size_t num_works;      // number of jobs so far; each call of team_share is one job
    bool open;             // parts of the job may be left
    bool closing;          // the threads must end
    size_t num_active;     // threads at work
    atomic_size_t next;    // next part that no thread has taken
    size_t num_threads;    // threads besides the caller
    team_member members[]; // [num_threads]
};

static void do_parts(team *self, const team_work *work, size_t member) {
    team_part part = {.member = member};

    while ((part.number = atomic_fetch_add(&self->next, 1)) < work->num_parts) {
        part.first = part.number * work->size;
        part.end = part.number + 1 < work->num_parts ? part.first + work->size : work->count;
        work->task(work->context, &part);
    }
}

static void *run_member(void *argument) {
    const team_member *own = argument;
    team *self = own->of;
    size_t last = 0; // number of the last job in which this thread took part

    pthread_mutex_lock(&self->lock);
    for (;;) {
        while (!self->closing && !(self->open && self->num_works != last))
            pthread_cond_wait(&self->begun, &self->lock);
        if (self->closing) break;
        const team_work work = self->work;
        last = self->num_works;
        self->num_active++;
        pthread_mutex_unlock(&self->lock);
        do_parts(self, &work, own->number);
        pthread_mutex_lock(&self->lock);
        if (--self->num_active == 0) pthread_cond_signal(&self->ended);
    }
    pthread_mutex_unlock(&self->lock);
    return NULL;
}

team *team_create(size_t num_members) {
    team *self =
        num_members > 1 ? calloc(1, sizeof *self + (num_members - 1) * sizeof(team_member)) : NULL;
    if (!self) return NULL;

    pthread_mutex_init(&self->lock, NULL);
    pthread_cond_init(&self->begun, NULL);
    pthread_cond_init(&self->ended, NULL);
    while (self->num_threads + 1 < num_members) {
        team_member *next = &self->members[self->num_threads];
        *next = (team_member){.of = self, .number = self->num_threads + 1};
        if (pthread_create(&next->thread, NULL, run_member, next)) break;
        self->num_threads++;
    }
    return self;
}

team *team_free(team *self) {
    if (!self) return NULL;
    pthread_mutex_lock(&self->lock);
    self->closing = true;
    pthread_cond_broadcast(&self->begun);
    pthread_mutex_unlock(&self->lock);
    for (size_t i = 0; i < self->num_threads; i++)
        pthread_join(self->members[i].thread, NULL);
    pthread_cond_destroy(&self->ended);
    pthread_cond_destroy(&self->begun);
    pthread_mutex_destroy(&self->lock);
    free(self);
    return NULL;
}

size_t team_size(const team *self) {
    return self ? self->num_threads + 1 : 1;
}

size_t team_num_parts(size_t count, size_t size) {
    return count / size + (count % size > 0);
}

static void do_alone(const team_work *work) {
    for (size_t i = 0; i < work->num_parts; i++) {
        const bool last = i + 1 == work->num_parts;
        const team_part part = {i * work->size, last ? work->count : (i + 1) * work->size, i, 0};
        work->task(work->context, &part);
    }
}

void team_share(team *self, size_t count, size_t size, team_task *task, void *context) {
    const team_work work = {task, context, count, size, team_num_parts(count, size)};

    if (!self || work.num_parts < 2) {
        do_alone(&work);
        return;
    }
    pthread_mutex_lock(&self->lock);
    self->work = work;
    self->num_works++;
    self->open = true;
    atomic_store(&self->next, 0);
    pthread_cond_broadcast(&self->begun);
    pthread_mutex_unlock(&self->lock);
    do_parts(self, &work, 0);
    pthread_mutex_lock(&self->lock);
    self->open = false; // a thread that wakes up now finds no job
    while (self->num_active > 0)
        pthread_cond_wait(&self->ended, &self->lock);
    pthread_mutex_unlock(&self->lock);
}
