/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef EHD_SIZES_H
#define EHD_SIZES_H

#include <stddef.h>

/* Size of the part of a stored model that is used, its first modes and rows; 0: all. */
typedef struct model_sizes {
    size_t pressure_modes, deformation_modes, rows;
} model_sizes;

#endif
