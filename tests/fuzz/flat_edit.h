/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Edits of a valid flat model (romrun/model/flat.h), that a text lists, one a line:
 *
 *     put BLOCK INDEX VALUE     8 bytes of its data, a number; INDEX modulo as many as there are
 *     whole BLOCK INDEX VALUE   the same, a whole number
 *     fill BLOCK VALUE          all of it, a number
 *     resize BLOCK COUNT        as many elements, those there are again and again
 *     count BLOCK COUNT         what its header says, alone
 *     size BLOCK BYTES          the same, of an element
 *     name BLOCK NAME
 *     drop BLOCK                is gone
 *     twice BLOCK               is there twice
 *     header INDEX VALUE        8 bytes of the file's header
 *     cut BYTES                 from the file's end
 *
 * and, not of the file but for what uses it (target.c):
 *
 *     state INDEX VALUE         a number of the contact's saved state
 *
 * BLOCK is its name or its number, modulo as many as there are. The file's length in its header follows, its checksum
 * does not. What makes no sense, and other lines, are passed over. */
#ifndef FUZZ_FLAT_EDIT_H
#define FUZZ_FLAT_EDIT_H

#include <stddef.h>

void flat_edit_file(const char *path, const char *text, size_t length);

/* The words that stand for an edit, NULL at the end. */
extern const char *const flat_edit_words[];

#endif
