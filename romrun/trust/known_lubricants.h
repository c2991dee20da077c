/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks whether the error estimates of a model hold for a lubricant. They hold if the training or
 * the calibration had a similar lubricant, or lubricants on both sides of this one (README.md,
 * Lubricants).
 * Called by trained_range.c for each contact. */
#ifndef EHD_KNOWN_LUBRICANTS_H
#define EHD_KNOWN_LUBRICANTS_H

#include "romrun/model/reduced_model.h"

typedef struct known_lubricants known_lubricants;

/* Collects the known lubricants of a model. NULL: no memory. */
known_lubricants *known_lubricants_create(const reduced_model *model);
known_lubricants *known_lubricants_free(known_lubricants *self); // accepts and returns NULL

/* Work memory of one thread for checks against these lubricants. NULL: no memory. */
typedef struct lubricant_memory lubricant_memory;
lubricant_memory *lubricant_memory_create(const known_lubricants *of);
lubricant_memory *lubricant_memory_free(lubricant_memory *self); // accepts and returns NULL

/* Returns the buffer into which checks with this memory write texts that name laws. */
const char *lubricant_memory_reason(const lubricant_memory *self);

/* Returns NULL for a lubricant that is similar to a known lubricant or lies between known
 * lubricants (README.md, Lubricants). Otherwise returns a text that names the law, valid until the
 * next call with this memory. The lubricants of the training are known. If `in_time`, the
 * lubricants of the calibration's trajectories are also known, otherwise the lubricants of its
 * stationary scenes. */
const char *known_lubricants_check(const known_lubricants *self, lubricant_memory *memory,
                                   const ehd_lubricant *lubricant, bool in_time);

#endif
