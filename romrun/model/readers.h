/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads basis and model files for --check (schemas/README.md, Content digest).
 * Called by romrun/main.c, and by podbuild/readers.c for the other programs. */
#ifndef EHD_READERS_H
#define EHD_READERS_H

#include "common/output/check.h"

/* Read the whole file and free it again. Errors as basis_read, model_open, model_get,
 * model_get_modes and trade_get. */
ehd_status basis_check(const char *path, ehd_error *error);
ehd_status model_check(const char *path, ehd_error *error);

/* The readers of both kinds of files; ends with {0}. */
extern const output_reader model_readers[];

#endif
