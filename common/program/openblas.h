/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef EHD_OPENBLAS_H
#define EHD_OPENBLAS_H

#include <stddef.h>

/* Megabytes of work space that OpenBLAS takes for each thread that calls it (x86-64, 0.3.21 and
 * 0.3.29). */
enum { OPENBLAS_BUFFER_MB = 128 };

/* Takes the work space of `num_threads` threads in advance, because OpenBLAS retries without end
 * if memory is refused. Returns the number of threads for which there is memory. */
size_t openblas_take_buffers(size_t num_threads);

/* Limits OpenBLAS to one thread in this process. A program that calls this function also links the
 * function getenv of openblas.c, which keeps OpenBLAS from starting any threads. */
void openblas_one_thread(void);

#endif
