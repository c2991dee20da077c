/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads basis and model files for --check (schemas/README.md, Content digest).
 * Called by romrun/main.c, and by podbuild/readers.c for the other programs. */
#ifndef EHD_READERS_H
#define EHD_READERS_H

#include "common/output/check.h"

/* Read the whole file to check it, and free the data again. Errors as basis_read, model_open,
 * model_get, model_get_modes and trade_get. */
ehd_status basis_check(const char *path, ehd_error *error);
ehd_status model_check(const char *path, ehd_error *error);

/* The readers of basis and model files; the list ends with {0}. */
extern const output_reader model_readers[];

#endif
