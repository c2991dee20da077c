/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef EHD_OPENBLAS_H
#define EHD_OPENBLAS_H

/* One thread of OpenBLAS in this process. A program that calls it has none begun at all. */
void openblas_one_thread(void);

#endif
