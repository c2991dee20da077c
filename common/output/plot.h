/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws files of the programs, for --plot. Called by output_main. */
#ifndef EHD_PLOT_H
#define EHD_PLOT_H

#include "common/program/program.h"
#include "common/program/status.h"

/* Draws the file caller->plot into caller->output, whose name ends with .png, .svg or .pdf. The
 * caller's arguments are the columns of a table. Runs the script scenes/lib/plot.py, which the
 * program finds in its source tree or installation. Errors: EHD_USAGE for another ending, EHD_DATA,
 * EHD_NOINPUT, EHD_UNAVAILABLE if Python or one of its packages is missing, EHD_CANTCREATE, EHD_IO,
 * EHD_MEMORY. */
ehd_status output_plot(const program *caller, ehd_error *error);

#endif
