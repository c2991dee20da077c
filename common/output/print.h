/* SPDX-License-Identifier: GPL-3.0-or-later */
/* --print FILE NAME..., the same in every program. */
#ifndef EHD_PRINT_H
#define EHD_PRINT_H

#include "common/artefact/artefact.h"
#include "common/program/program.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* Prints one field of a line of CSV: a text, in quotes where needed, or a number as its shortest text
 * that reads back the same, NaN as "nan". */
void print_csv_text(const char *text, FILE *stream);
void print_csv_real(double value, FILE *stream);

/* Prints entries of an open file as CSV, of at least one name: a header with the names, then a line
 * for each entry of the datasets named. These must have the same axes, and axes named must be among
 * them; an attribute is the same in each line. Numbers read back as the same bits (NaN is "nan"),
 * texts are quoted where needed.
 *
 * Where the datasets have several axes of more than one entry, those that are not named come first
 * as columns of their own, and an empty line ends each run of the last axis, two end each of the
 * axis before, as gnuplot's splot and index expect. An axis without values in the file counts from
 * 0.
 *
 * In SI units a name is followed by its unit in brackets, where it has one: "time [s]". The scale is
 * that of the table's row; what is without dimension stays so.
 *
 * EHD_DATA: a name that the file does not have (with those that it has), datasets of different
 * axes, damaged data; in SI units a scale that the file does not have; EHD_MEMORY; EHD_IO;
 * EHD_INTERRUPTED. Lines before a failure are printed. */
ehd_status print_entries(artefact *file, const char *const *names, size_t num_names, bool si,
                         FILE *stream, ehd_error *error);

/* Prints what an open file has, a line of CSV each: name, units, lengths and names of the axes,
 * description. EHD_DATA as above. */
ehd_status print_names(artefact *file, bool si, FILE *stream, ehd_error *error);

/* Prints caller->arguments of caller->print, or what there is when none are given, on stdout; frees
 * the program and returns the exit code for main. */
int output_print(program *caller);

#endif
