/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Strict numbers from text, and text that is safe to show in a message. */
#ifndef EHD_TEXT_H
#define EHD_TEXT_H

#include "common/program/status.h"
#include <stdbool.h>
#include <stddef.h>

enum { NUMBER_TEXT = 32, SHOWN_TEXT = 64 }; // bytes, with the closing zero

/* A whole decimal number such as -1.5e-3. False for anything else: empty, spaces, trailing junk,
 * hexadecimal, NaN, infinity, and what a double cannot hold. */
bool number_read(double *value, const char *text);

/* The shortest decimal text that reads back as the same double. */
void number_show(char shown[NUMBER_TEXT], double value);

/* One short printable piece of what a user gave: other bytes than printable ASCII become '?', the
 * end of a long text "...", and an empty one "nothing". */
void text_show(char shown[SHOWN_TEXT], const char *text);

/* Bytes of the UTF-8 character that begins here; 0: there is none. */
size_t text_character(const char *text);

/* Makes foreign text printable, in place: each control character ('\n' too, U+0080 to U+009F, line separators
 * and marks that change the direction of text) and each byte that is not UTF-8 becomes '?', except the ASCII
 * characters in `kept`. All errors and messages pass through it. */
void text_make_printable(char *text, const char *kept);

/* A strict number within min..max (infinite: no bound), else `refusal` (EHD_USAGE or EHD_DATA);
 * `object` leads the message. */
ehd_status parse_real(
    // output:
    double *value,
    // input:
    const char *text, double min, double max, const char *object, ehd_status refusal,
    ehd_error *error);

/* The same for a whole number without sign: digits only. */
ehd_status parse_count(
    // output:
    size_t *value,
    // input:
    const char *text, size_t min, size_t max, const char *object, ehd_status refusal,
    ehd_error *error);

#endif
