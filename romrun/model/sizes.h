/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef EHD_SIZES_H
#define EHD_SIZES_H

#include <stddef.h>

/* Numbers of the first modes and rows of a stored model that are used; 0: all. */
typedef struct model_sizes {
    size_t pressure_modes, deformation_modes, rows;
} model_sizes;

#endif
