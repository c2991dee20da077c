/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Implements --print FILE NAME... for every program. */
#ifndef EHD_PRINT_H
#define EHD_PRINT_H

#include "common/artefact/artefact.h"
#include "common/program/program.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* Print one field of a CSV line: a text, in quotes if needed, or a number as the shortest text that
 * reads back as the same number (NaN: "nan"). */
void print_csv_text(const char *text, FILE *stream);
void print_csv_real(double value, FILE *stream);

/* Prints datasets, axes and attributes of an open file as CSV. `names` has at least one name. The
 * names are the header; then follows a line for each entry of the named datasets. These datasets
 * must have the same axes, and a named axis must be one of these axes. An attribute has the same
 * value in each line. Numbers read back as the same bits (NaN is "nan"); texts are quoted where
 * needed.
 *
 * If several axes have more than one entry, the axes that are not named are printed too, as the
 * first columns. Empty lines then separate blocks of lines, as gnuplot's splot and index expect:
 * one empty line where only the last axis starts again, two where further axes start again. An axis
 * without values in the file counts from 0.
 *
 * With `si` numbers are in SI units, and a name is followed by its unit in brackets, if it has one:
 * "time [s]". The schema gives the factor; dimensionless numbers without a factor stay as they are.
 *
 * Returns EHD_DATA for a name that the file does not have (the message lists the file's names), for
 * datasets of different axes, for damaged data, and with `si` for a missing factor. Other errors:
 * EHD_MEMORY, EHD_IO, EHD_INTERRUPTED. The lines before a failure are printed. */
ehd_status print_entries(artefact *file, const char *const *names, size_t num_names, bool si,
                         FILE *stream, ehd_error *error);

/* Prints a line of CSV for each axis, dataset and attribute of an open file: name, units, lengths
 * and names of the axes, description. Returns EHD_DATA in the same cases as print_entries. */
ehd_status print_names(artefact *file, bool si, FILE *stream, ehd_error *error);

/* Prints the names caller->arguments of the file caller->print on stdout, or the list of all names
 * if there are no arguments. Errors: as artefact_open, print_entries and print_names. */
ehd_status output_print(const program *caller, ehd_error *error);

#endif
