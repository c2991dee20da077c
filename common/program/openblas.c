/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Replaces environment variables that OpenBLAS reads while it is loaded, before main begins. */
#include "common/program/openblas.h"

#include "common/program/status.h"

#include <cblas.h>
#include <errno.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#ifdef __x86_64__
static bool has_avx2(void) {
    __builtin_cpu_init();
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
}
#else
static bool has_avx2(void) {
    return false;
}
#endif

// Functions of OpenBLAS that take and give back one buffer. OpenBLAS keeps a returned buffer for
// later calls.
void *blas_memory_alloc(int unused);
void blas_memory_free(void *buffer);

static const size_t BUFFER = (size_t)OPENBLAS_BUFFER_MB << 20;

static bool has_room(size_t bytes) {
    void *room = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (room == MAP_FAILED) return false;
    munmap(room, bytes);
    return true;
}

size_t openblas_take_buffers(size_t num_threads) {
    void **buffers = malloc((num_threads + 1) * sizeof *buffers);
    pthread_attr_t attributes;
    size_t stack = 0, count = 0;

    if (!buffers) return 0;
    if (pthread_attr_init(&attributes) == 0) {
        pthread_attr_getstacksize(&attributes, &stack);
        pthread_attr_destroy(&attributes);
    }
    // leaves memory for the stacks of the threads counted so far, which are created afterwards
    while (count < num_threads && has_room(BUFFER + (count + 1) * stack))
        buffers[count++] = blas_memory_alloc(0);
    for (size_t i = 0; i < count; i++)
        blas_memory_free(buffers[i]);
    free(buffers);
    return count;
}

/* Ends the process if there is no memory for the first buffer of OpenBLAS. While it is loaded,
 * OpenBLAS 0.3.29 would request that buffer without end. */
static void check_room_while_loaded(void) {
    char line[256];

    if (has_room(BUFFER)) return;
    const int length =
        snprintf(line, sizeof line, "%s: OpenBLAS: found too little memory, expected %d MB\n",
                 program_invocation_short_name, OPENBLAS_BUFFER_MB);
    if (length > 0 && write(STDERR_FILENO, line, (size_t)length) < 0) _exit(EHD_IO);
    _exit(EHD_MEMORY);
}

/* Replaces the C library's getenv in the programs. Two variables of OpenBLAS differ:
 * - OPENBLAS_NUM_THREADS is 1, whatever the user has set. The programs' own threads are enough.
 *   More threads only slow down work on small matrices. If memory is limited, the threads of
 *   OpenBLAS wait for memory without end. Debian's OpenBLAS without threads is no alternative: it
 *   has no lock around its work space. Of 2 million products of small matrices in each of four
 *   threads, one product in 200 was wrong.
 * - OPENBLAS_CORETYPE is Haswell if the user has set none and the processor has AVX2. OpenBLAS
 *   0.3.21 treats an Intel processor that is newer than this version like a Prescott of 2004, and
 *   then runs at a quarter of the speed. The environment itself does not change, so that programs
 *   started by this program choose for their own processor. */
char *getenv(const char *name) {
    static char one_thread[] = "1", haswell[] = "Haswell";
    const size_t length = strlen(name);

    if (strcmp(name, "OPENBLAS_NUM_THREADS") == 0) {
        check_room_while_loaded();
        return one_thread;
    }
    for (char **entry = environ; entry && *entry; entry++)
        if (strncmp(*entry, name, length) == 0 && (*entry)[length] == '=')
            return *entry + length + 1;
    return strcmp(name, "OPENBLAS_CORETYPE") == 0 && has_avx2() ? haswell : NULL;
}

void openblas_one_thread(void) {
    openblas_set_num_threads(1);
}
