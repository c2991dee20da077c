/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Functions that read and check the files of a training, for --check. */
#ifndef EHD_TRAINING_READERS_H
#define EHD_TRAINING_READERS_H

#include "common/output/check.h"

/* Readers of bases, parts, models and snapshots; ends with {0}. */
extern const output_reader training_readers[];

#endif
