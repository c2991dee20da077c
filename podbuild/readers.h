/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads and checks the files of a training, for --check (schemas/README.md, Content digest).
 * Used by main.c of podbuild, deimselect and snapgen. */
#ifndef EHD_TRAINING_READERS_H
#define EHD_TRAINING_READERS_H

#include "common/program/status.h"

/* Checks a file of any kind; reads bases, parts, models and snapshots like the programs that take
 * them as input. Errors: as output_check. */
ehd_status training_check(const char *path, ehd_error *error);

#endif
