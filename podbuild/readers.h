/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How the stages of a training read files, for --check. */
#ifndef EHD_TRAINING_READERS_H
#define EHD_TRAINING_READERS_H

#include "common/output/check.h"

/* Bases, models and snapshots; ends with {0}. */
extern const output_reader training_readers[];

#endif
