/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Edits a valid flat model (romrun/model/flat.h). The text has one edit a line:
 *
 *     put BLOCK INDEX VALUE     sets 8 bytes of the block's data to a number
 *     whole BLOCK INDEX VALUE   sets 8 bytes to a whole number
 *     fill BLOCK VALUE          sets all data to a number
 *     resize BLOCK COUNT        sets the number of elements; the old ones are repeated as needed
 *     count BLOCK COUNT         sets only the count in the header
 *     size BLOCK BYTES          sets only the size of an element in the header
 *     name BLOCK NAME           renames the block
 *     drop BLOCK                removes the block
 *     twice BLOCK               inserts a second copy of the block
 *     header INDEX VALUE        sets 8 bytes of the file's header
 *     cut BYTES                 removes bytes at the file's end
 *
 * One further edit, which target.c applies, does not change the file, but the saved state of a
 * contact that uses the model:
 *
 *     state INDEX VALUE         sets a number of the saved state
 *
 * BLOCK is a name or a number. Numbers of blocks and indices are taken modulo the number of blocks
 * and of values. The length in the file's header is updated, the checksum is not. Edits that make
 * no sense, and other lines, are ignored. */
#ifndef FUZZ_FLAT_EDIT_H
#define FUZZ_FLAT_EDIT_H

#include <stddef.h>

void flat_edit_file(const char *path, const char *text, size_t length);

/* Names of the edits, NULL at the end. */
extern const char *const flat_edit_words[];

#endif
