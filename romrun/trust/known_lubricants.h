/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks whether a model's error estimates are known for a lubricant: whether the training or the
 * calibration had one like it (README.md, Lubricants).
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

/* Returns the buffer for texts that name laws. Checks with this memory write into it. */
const char *lubricant_memory_reason(const lubricant_memory *self);

/* Returns NULL for a lubricant that is like a known one or lies between known ones (README.md,
 * Lubricants), else a text that names the law. The text is valid until the next call with this
 * memory. `in_time`: lubricants of the calibration's trajectories are known, those of its
 * stationary scenes are not. */
const char *known_lubricants_check(const known_lubricants *self, lubricant_memory *memory,
                                   const ehd_lubricant *lubricant, bool in_time);

#endif
