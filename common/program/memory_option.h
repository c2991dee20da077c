/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The option --memory SIZE of programs whose arrays keep to a limit. */
#ifndef EHD_MEMORY_OPTION_H
#define EHD_MEMORY_OPTION_H

#include "common/program/status.h"

/* Returns the default in bytes: half of the memory that the machine has, or half of the limit that
 * `ulimit -v` sets where it is lower. The other half is for the files that are read. */
double memory_option_default(void);

/* Reads a size such as "2G", "500M" or "1.5G" into *member, a double, in bytes. It is a `read` of
 * program_option. EHD_USAGE: the argument is not a number above 0 with K, M, G or T. */
ehd_status memory_option_read(void *member, const char *argument, ehd_error *error);

#endif
