/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the option --memory SIZE of programs that limit the memory of their arrays. */
#ifndef EHD_MEMORY_OPTION_H
#define EHD_MEMORY_OPTION_H

#include "common/program/status.h"

/* Returns the default in bytes: half of the memory that the machine has, or half of the limit of
 * `ulimit -v`, if this limit is lower. The other half is for the files that are read. */
double memory_option_default(void);

/* Reads a size such as "2G", "500M" or "1.5G" into *member, a double, in bytes. The function can be
 * the member `read` of a program_option. EHD_USAGE: the argument is not a number above 0 with K, M,
 * G or T. */
ehd_status memory_option_read(void *member, const char *argument, ehd_error *error);

#endif
