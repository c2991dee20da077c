/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What OpenBLAS asks of its environment when it is loaded. These functions stand in for its own
 * (driver/others/openblas_env.c of 0.3.21), also for those of the shared library, so that it begins
 * no threads: ours are enough, more only slow down small matrices, and where memory is limited they
 * wait for it without end. Debian's OpenBLAS without threads is no way out: it has no lock around its
 * work space, and of 2 million small products in each of four threads one in 200 was wrong.
 * All of them, since a static library brings them together. */
#include "common/program/openblas.h"

#include <cblas.h>

int openblas_verbose(void);
unsigned openblas_block_factor(void);
unsigned openblas_thread_timeout(void);
int openblas_omp_adaptive_env(void);
int openblas_goto_num_threads_env(void);
int openblas_num_threads_env(void);
int openblas_omp_num_threads_env(void);
void openblas_read_env(void);

int openblas_verbose(void) {
    return 0;
}

unsigned openblas_block_factor(void) {
    return 0; // its own
}

unsigned openblas_thread_timeout(void) {
    return 0; // its own
}

int openblas_omp_adaptive_env(void) {
    return 0;
}

int openblas_goto_num_threads_env(void) {
    return 1;
}

int openblas_num_threads_env(void) {
    return 1;
}

int openblas_omp_num_threads_env(void) {
    return 1;
}

void openblas_read_env(void) {
}

void openblas_one_thread(void) {
    openblas_set_num_threads(1);
}
