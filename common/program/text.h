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
