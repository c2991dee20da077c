/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/training/pool.h"

#include "common/program/arena.h"
#include "common/program/openblas.h"
#include "common/program/program.h"

#include <pthread.h>
#include <sched.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

typedef struct pool {
    const pool_work *work;
    pthread_mutex_t lock; // guards everything below, and `start` and `finish` of the work
    pthread_cond_t changed;
    // place in the order; all points before this place that wait for no other point are already
    // taken
    size_t next;
    // a heap, lowest first, of places in the order: points that waited for their parent and can now
    // be taken, and points that were put back
    size_t *ready;
    size_t num_ready;
    size_t *place; // [num_points] place of a point in the order; NULL: the point's number
    // [num_points] linked lists of the points that wait for each point; NO_PARENT: end of the list
    size_t *first_child, *next_sibling;
    size_t num_left;   // number of points not taken
    size_t num_active; // number of workers that have not ended
    ehd_status status; // the first failure
    ehd_error error;
} pool;

size_t pool_default_workers(void) {
    cpu_set_t allowed;
    int count = 0;

    // a container or `taskset` may allow fewer processors than the machine has
    if (sched_getaffinity(0, sizeof allowed, &allowed) == 0) count = CPU_COUNT(&allowed);
    // the call fails on a machine with more processors than a cpu_set_t holds
    if (count < 1) count = (int)sysconf(_SC_NPROCESSORS_ONLN);
    return count > 0 ? (size_t)count : 1;
}

// ---- with the lock held

static void fail(pool *self, ehd_status status, const ehd_error *error) {
    if (self->status) return;
    self->status = status;
    self->error = *error;
}

static size_t parent_of(const pool *self, size_t point) {
    return self->work->parent ? self->work->parent[point] : NO_PARENT;
}

static bool is_done(const pool *self, size_t point) {
    return self->work->done && self->work->done[point];
}

static size_t point_at(const pool *self, size_t place) {
    return self->work->order ? self->work->order[place] : place;
}

/* Checks whether the point at a place waits for no other point and is not done. */
static bool is_root(const pool *self, size_t place) {
    const size_t point = point_at(self, place), parent = parent_of(self, point);

    return !is_done(self, point) && (parent == NO_PARENT || is_done(self, parent));
}

static void add_ready(pool *self, size_t place) {
    size_t i = self->num_ready++;

    for (; i > 0 && self->ready[(i - 1) / 2] > place; i = (i - 1) / 2)
        self->ready[i] = self->ready[(i - 1) / 2];
    self->ready[i] = place;
}

static size_t take_ready(pool *self) {
    const size_t lowest = self->ready[0], last = self->ready[--self->num_ready];
    size_t i = 0;

    for (size_t child; (child = 2 * i + 1) < self->num_ready; i = child) {
        child += child + 1 < self->num_ready && self->ready[child + 1] < self->ready[child];
        if (last <= self->ready[child]) break;
        self->ready[i] = self->ready[child];
    }
    self->ready[i] = last;
    return lowest;
}

/* Takes the first point in the order whose parent is finished. Returns NO_PARENT if there is no
 * such point. */
static size_t free_point(pool *self) {
    while (self->next < self->work->num_points && !is_root(self, self->next))
        self->next++;
    const bool root = self->next < self->work->num_points;
    if (self->num_ready > 0 && (!root || self->ready[0] < self->next))
        return point_at(self, take_ready(self));
    return root ? point_at(self, self->next++) : NO_PARENT;
}

static void release_children(pool *self, size_t point) {
    if (!self->place) return;
    for (size_t child = self->first_child[point]; child != NO_PARENT;
         child = self->next_sibling[child])
        if (!is_done(self, child)) add_ready(self, self->place[child]);
}

/* Waits for a point. Returns NO_PARENT if nothing is left, or the pool stops. */
static size_t take_point(pool *self) {
    size_t point = NO_PARENT;

    while (self->num_left > 0 && !self->status) {
        if (program_interrupted()) {
            fail(self, EHD_INTERRUPTED, &(ehd_error){""});
            break;
        }
        point = free_point(self);
        if (point != NO_PARENT) break;
        pthread_cond_wait(&self->changed, &self->lock);
    }
    if (point == NO_PARENT || self->status) return NO_PARENT;
    self->num_left--;
    return point;
}

/* Checks whether a worker without memory leaves its work to the other workers, which hold the
 * memory that it lacks. The last worker reports the failure. */
static bool leaves_to_others(pool *self, ehd_status status) {
    return status == EHD_MEMORY && !self->status && self->num_active > 1;
}

static void put_back(pool *self, size_t point) {
    // without a list of places a point's number is its place
    add_ready(self, self->place ? self->place[point] : point);
    self->num_left++;
}

/* Runs the tasks of a point. The lock is released while the point is solved. */
static ehd_status run_point(pool *self, void *worker, size_t point, bool *solved,
                            ehd_error *error) {
    const pool_work *work = self->work;
    size_t parent = parent_of(self, point);
    ehd_status status =
        work->start ? work->start(work->shared, worker, point, parent, error) : EHD_OK;
    if (status) return status;

    pthread_mutex_unlock(&self->lock);
    status = work->solve(work->shared, worker, point, parent, error);
    pthread_mutex_lock(&self->lock);
    *solved = !status;
    if (!status && work->finish) status = work->finish(work->shared, worker, point, parent, error);
    return status;
}

// ---- threads

static void *run_worker(void *argument) {
    pool *self = argument;
    void *worker = NULL;
    ehd_error error = {""};
    const pool_work *work = self->work;
    ehd_status status = work->begin ? work->begin(&worker, work->shared, &error) : EHD_OK;

    pthread_mutex_lock(&self->lock);
    // if all points are taken when a worker begins, it has no work, and its failure does no harm
    bool leaves = leaves_to_others(self, status) || (status == EHD_MEMORY && self->num_left == 0);
    if (status && !leaves) fail(self, status, &error);
    while (!leaves) {
        const size_t point = take_point(self);
        if (point == NO_PARENT) break;
        bool solved = false;
        status = run_point(self, worker, point, &solved, &error);
        leaves = work->repeatable && !solved && leaves_to_others(self, status);
        if (!status) release_children(self, point);
        if (leaves)
            put_back(self, point);
        else if (status)
            fail(self, status, &error);
        pthread_cond_broadcast(&self->changed);
    }
    self->num_active--;
    pthread_cond_broadcast(&self->changed);
    pthread_mutex_unlock(&self->lock);
    if (work->end) work->end(worker);
    return NULL;
}

/* Starts up to num_wanted threads and returns their number. If fewer threads start, they do all of
 * the work. */
static size_t start_threads(pthread_t *threads, size_t num_wanted, pool *self) {
    size_t started = 0;

    pthread_mutex_lock(&self->lock); // no thread reads num_active before it is set
    while (started < num_wanted && !pthread_create(&threads[started], NULL, run_worker, self))
        started++;
    self->num_active = started > 0 ? started : 1;
    pthread_mutex_unlock(&self->lock);
    return started;
}

/* Returns how many of num_wanted threads have enough memory: worker_bytes, the heap that glibc
 * reserves for a thread (HEAP_MAX_SIZE, 64-bit), and a buffer of OpenBLAS. A limit of the address
 * space (ulimit -v) includes all of these. Without this check, 8 threads under a limit of 400 to
 * 1000 MB ran out of memory only after they had done work. */
static size_t workers_with_memory(size_t num_wanted, double worker_bytes) {
    const double heap = 64 << 20; // Source: heap of a thread in glibc, as above; bytes
    size_t num = num_wanted;

    while (num > 0) {
        const double bytes = (double)num * (heap + worker_bytes);
        void *room = bytes < (double)SIZE_MAX / 2
                         ? mmap(NULL, (size_t)bytes, PROT_NONE,
                                MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0)
                         : MAP_FAILED;
        const size_t found = room == MAP_FAILED ? num - 1 : openblas_take_buffers(num);
        if (room != MAP_FAILED) munmap(room, (size_t)bytes);
        if (found == num) return num;
        num = found;
    }
    return 0; // the thread of the caller already has this memory
}

static void run_threads(pool *self) {
    size_t num_workers = self->work->num_workers;
    if (num_workers > self->num_left) num_workers = self->num_left;
    num_workers = workers_with_memory(num_workers, self->work->worker_bytes);
    pthread_t *threads = malloc((num_workers + 1) * sizeof *threads);
    size_t started = start_threads(threads, threads ? num_workers : 0, self);

    if (started == 0) run_worker(self);
    for (size_t i = 0; threads && i < started; i++)
        pthread_join(threads[i], NULL);
    free(threads);
}

/* Allocates the arrays of the pool. If the points are taken by number and no point waits for
 * another, only `ready` is needed. */
static bool prepare(pool *self) {
    const pool_work *work = self->work;
    const size_t count = work->num_points;
    const bool apart = work->parent || work->order;

    self->ready = array_new((apart ? count : work->num_workers) + 1, 1, sizeof *self->ready);
    if (!apart) return self->ready != NULL;
    self->place = array_new(count + 1, 1, sizeof *self->place);
    self->first_child = array_new(count + 1, 1, sizeof *self->first_child);
    self->next_sibling = array_new(count + 1, 1, sizeof *self->next_sibling);
    if (!self->ready || !self->place || !self->first_child || !self->next_sibling) return false;
    for (size_t i = 0; i < count; i++) {
        self->place[point_at(self, i)] = i;
        self->first_child[i] = NO_PARENT;
    }
    for (size_t i = 0; i < count; i++) {
        const size_t parent = parent_of(self, i);
        if (parent == NO_PARENT) continue;
        self->next_sibling[i] = self->first_child[parent];
        self->first_child[parent] = i;
    }
    return true;
}

ehd_status pool_run(const pool_work *work, ehd_error *error) {
    pool self = {.work = work, .num_left = work->num_points};
    ehd_status status;

    if (!prepare(&self)) {
        status = ehd_no_memory(error, "points");
        goto done;
    }
    for (size_t i = 0; work->done && i < work->num_points; i++)
        self.num_left -= work->done[i];
    pthread_mutex_init(&self.lock, NULL);
    pthread_cond_init(&self.changed, NULL);
    if (self.num_left > 0) run_threads(&self);
    pthread_cond_destroy(&self.changed);
    pthread_mutex_destroy(&self.lock);
    status = self.status;
    if (status && error) *error = self.error;
done:
    free(self.ready);
    free(self.place);
    free(self.first_child);
    free(self.next_sibling);
    return status;
}
