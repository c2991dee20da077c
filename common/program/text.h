/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads numbers strictly from text, and makes text safe to show in a message or to print in XML. */
#ifndef EHD_TEXT_H
#define EHD_TEXT_H

#include "common/program/status.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

enum { NUMBER_TEXT = 32, SHOWN_TEXT = 64 }; // bytes, with the closing zero

/* Reads a text that is one decimal number, such as -1.5e-3. Returns false for anything else: empty,
 * spaces, trailing characters, hexadecimal, NaN, infinity, and numbers that a double cannot
 * hold. */
bool number_read(double *value, const char *text);

/* Writes the shortest decimal text that reads back as the same double. */
void number_show(char shown[NUMBER_TEXT], double value);

/* Writes a short printable form of a text that a user gave. Bytes other than printable ASCII become
 * '?', the end of a long text becomes "...", and an empty text becomes "nothing". */
void text_show(char shown[SHOWN_TEXT], const char *text);

/* Returns the number of bytes of the UTF-8 character that begins here; 0: there is none. */
size_t text_character(const char *text);

/* Makes a text of unknown origin printable, in place. Each control character ('\n' too, U+0080 to
 * U+009F, line separators and marks that change the direction of text) and each byte that is not
 * UTF-8 becomes '?'. The ASCII characters in `kept` stay. All errors and messages pass through this
 * function. */
void text_make_printable(char *text, const char *kept);

/* Prints a text so that it can stand within the quotes of an XML attribute. */
void text_print_xml(const char *text, FILE *stream);

/* Returns the entry of a table that has this name, or NULL. The entries are structs of `size` bytes
 * whose first member is the name; the table ends with an entry whose name is NULL. */
const void *entry_find(const void *table, size_t size, const char *name);

/* Reads a number like number_read, and checks that it lies within min..max (infinite: no bound). If
 * it does not, returns `refusal` (EHD_USAGE or EHD_DATA). The message begins with `object`. */
ehd_status parse_real(
    // output:
    double *value,
    // input:
    const char *text, double min, double max, const char *object, ehd_status refusal,
    ehd_error *error);

/* Reads a whole number without sign, digits only, like parse_real. */
ehd_status parse_count(
    // output:
    size_t *value,
    // input:
    const char *text, size_t min, size_t max, const char *object, ehd_status refusal,
    ehd_error *error);

#endif
