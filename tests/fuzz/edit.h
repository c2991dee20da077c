/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Edits of a valid HDF5 file, made by the library itself, that a text lists, one a line:
 *
 *     delete NAME                  the dataset is gone
 *     put NAME INDEX VALUE         one value, counted through all axes
 *     fill NAME VALUE              all values
 *     shape NAME LENGTH...         other lengths and rank, with as many of the values as there are, again and again
 *     axis NAME LENGTH             the same of every dataset that is along the axis
 *     type NAME KIND               f32, i8, text, compound, ...
 *     layout NAME KIND             contiguous, compact, deflate, external, virtual, ...
 *     link NAME KIND TARGET        soft, hard, external, group, datatype in its place
 *     attribute NAME KIND VALUE    real, integer, text (with \n and \s), fixed, array, empty, none; NAME of the root, or
 *                                  DATASET.NAME
 *
 * What makes no sense, and other lines, are passed over. */
#ifndef FUZZ_EDIT_H
#define FUZZ_EDIT_H

#include "common/artefact/artefact.h"
#include <stdbool.h>
#include <stddef.h>

/* `schema` says which dataset is along which axis; NULL: of no schema. False when HDF5 itself crashed or hung in an
 * edit, as 1.10.8 does where it takes attributes out of objects of its newer format (H5O_condense_header): edits are
 * made in a process of their own, and the file is then any. */
bool edit_file(const char *path, const artefact_schema *schema, const char *text, size_t length);

/* The words that stand for an edit and for its kinds, NULL at the end, for what makes up edits. */
extern const char *const edit_words[];
extern const char *const edit_types[], *const edit_layouts[], *const edit_links[],
                                                                  *const edit_attributes[];

#endif
