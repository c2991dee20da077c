/* SPDX-License-Identifier: GPL-3.0-or-later */
/* --check FILE, the same in every program. */
#ifndef EHD_CHECK_H
#define EHD_CHECK_H

#include "common/program/program.h"

/* Whether caller->check is a whole and valid artefact. Silent where it is; else one line says
 * what is wrong. Frees the program and returns the exit code for main: 0, or 65 for whatever is
 * wrong with the file. */
int output_check(program *caller);

#endif
