/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whether files of bases and models are what their readers take, for --check. */
#ifndef EHD_READERS_H
#define EHD_READERS_H

#include "common/output/check.h"

/* Reads all of the file and frees it again; the errors are those of basis_read, model_open,
 * model_get, model_get_modes and trade_get. */
ehd_status basis_check(const char *path, ehd_error *error);
ehd_status model_check(const char *path, ehd_error *error);

/* Both; ends with {0}. */
extern const output_reader model_readers[];

#endif
