/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef EHD_OPENBLAS_H
#define EHD_OPENBLAS_H

#include <stddef.h>

/* Megabytes of work space that OpenBLAS takes for each thread that calls it (x86-64, 0.3.21 and 0.3.29). */
enum { OPENBLAS_BUFFER_MB = 128 };

/* Takes the work space of so many threads in advance, because OpenBLAS asks for it for ever where memory is
 * refused. Returns for how many of them there is memory. */
size_t openblas_take_buffers(size_t num_threads);

/* One thread of OpenBLAS in this process. A program that calls it has none begun at all. */
void openblas_one_thread(void);

#endif
