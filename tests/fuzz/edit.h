/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Edits a valid HDF5 file by calls of the HDF5 library. The text has one edit a line:
 *
 *     delete NAME                  deletes the dataset
 *     put NAME INDEX VALUE         sets one value; the index counts through all axes
 *     fill NAME VALUE              sets all values
 *     shape NAME LENGTH...         sets lengths and rank; the old values are repeated as needed
 *     axis NAME LENGTH             sets the length of the axis in every dataset along the axis
 *     type NAME KIND               f32, i8, text, compound, ...
 *     layout NAME KIND             contiguous, compact, deflate, external, virtual, ...
 *     link NAME KIND TARGET        replaces the dataset by a soft, hard or external link, a group or a datatype
 *     attribute NAME KIND VALUE    real, integer, text (with \n and \s), fixed, array, empty, none; NAME is an attribute
 *                                  of the root, or DATASET.NAME
 *
 * Edits that make no sense, and other lines, are ignored. */
#ifndef FUZZ_EDIT_H
#define FUZZ_EDIT_H

#include "common/artefact/artefact.h"
#include <stdbool.h>
#include <stddef.h>

/* Applies edits to a file. `schema` gives the axes of the datasets; NULL: no schema. Edits are made
 * in a separate process. Returns false if HDF5 itself crashed or hung; the file may then have any
 * content. HDF5 1.10.8 crashes when it removes attributes from objects of its newer format
 * (H5O_condense_header). */
bool edit_file(const char *path, const artefact_schema *schema, const char *text, size_t length);

/* Names of the edits and of their kinds, each list with NULL at the end, for generating edits. */
extern const char *const edit_words[];
extern const char *const edit_types[], *const edit_layouts[], *const edit_links[],
                                                                  *const edit_attributes[];

#endif
