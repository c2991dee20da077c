/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Declares the size of a model: how many of its modes and rows are used. The first modes and rows
 * of a model form a smaller model (romrun/calibrate/README.md, Calibration and the accuracy dial).
 * Included by model_file.h, by trade_file.h and by romrun/online/online.h. */
#ifndef EHD_SIZES_H
#define EHD_SIZES_H

#include <stddef.h>

/* Numbers of modes and rows of a stored model that are used, beginning with the first mode and row.
 * 0: all modes or rows are used. */
typedef struct model_sizes {
    size_t pressure_modes, deformation_modes, rows;
} model_sizes;

#endif
