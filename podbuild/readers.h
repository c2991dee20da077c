/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads and checks the files of a training, for --check (schemas/README.md, Content digest).
 * Used by main.c of podbuild, deimselect and snapgen. */
#ifndef EHD_TRAINING_READERS_H
#define EHD_TRAINING_READERS_H

#include "common/output/check.h"

/* Readers of bases, parts, models and snapshots; ends with {0}. */
extern const output_reader training_readers[];

#endif
