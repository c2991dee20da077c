/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef EHD_SIZES_H
#define EHD_SIZES_H

#include <stddef.h>

/* How much of the stored model is used: its first modes and rows; 0 stands for all. */
typedef struct ehdrom_sizes {
    size_t pressure_modes, deformation_modes, rows;
} ehdrom_sizes;

#endif
