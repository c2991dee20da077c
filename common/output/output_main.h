/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Holds what the `main` functions of all programs share. */
#ifndef EHD_OUTPUT_MAIN_H
#define EHD_OUTPUT_MAIN_H

#include "common/program/program.h"

/* Parses the command line, and does what --check, --describe, --print, --plot or --vtk ask for.
 * Without these options calls `run`, with the program's own options. `check` checks a file; NULL:
 * the program reads only results. `describe` describes a file other than a scene; NULL: the program
 * describes only scenes. Returns the exit code for main. */
int output_main(int argc, char **argv, const program_options *options,
                ehd_status run(const program *self, void *own, ehd_error *error),
                ehd_status check(const char *path, ehd_error *error),
                ehd_status describe(const char *path, ehd_error *error));

#endif
