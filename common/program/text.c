/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/program/text.h"

#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool number_read(double *value, const char *text) {
    char *end;
    // strtod alone would accept spaces, nan, inf and hexadecimal
    if (!*text || text[strspn(text, "+-.0123456789eE")]) return false;
    errno = 0;
    const double number = strtod(text, &end);
    if (end == text || *end || errno == ERANGE || !isfinite(number)) return false;
    *value = number;
    return true;
}

void number_show(char shown[NUMBER_TEXT], double value) {
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(shown, NUMBER_TEXT, "%.*g", digits, value);
        if (strtod(shown, NULL) == value) return;
    }
}

void text_show(char shown[SHOWN_TEXT], const char *text) {
    const size_t length = strnlen(text, SHOWN_TEXT);
    if (length == 0) {
        strcpy(shown, "nothing");
        return;
    }
    const size_t kept = length < SHOWN_TEXT ? length : SHOWN_TEXT - 4;
    for (size_t i = 0; i < kept; i++)
        shown[i] = text[i] >= ' ' && text[i] <= '~' ? text[i] : '?';
    strcpy(shown + kept, length < SHOWN_TEXT ? "" : "...");
}

size_t text_character(const char *text) {
    const unsigned char *byte = (const unsigned char *)text;
    const size_t length = byte[0] < 0x80   ? 1
                          : byte[0] < 0xC2 ? 0
                          : byte[0] < 0xE0 ? 2
                          : byte[0] < 0xF0 ? 3
                          : byte[0] < 0xF5 ? 4
                                           : 0;
    for (size_t i = 1; i < length; i++)
        if ((byte[i] & 0xC0) != 0x80) return 0;
    // refuses overlong forms, surrogates and numbers beyond Unicode
    if ((byte[0] == 0xE0 && byte[1] < 0xA0) || (byte[0] == 0xED && byte[1] > 0x9F) ||
        (byte[0] == 0xF0 && byte[1] < 0x90) || (byte[0] == 0xF4 && byte[1] > 0x8F))
        return 0;
    return length;
}

static bool is_printable(const char *text, size_t length) {
    const unsigned char *byte = (const unsigned char *)text;
    if (length == 1) return byte[0] >= ' ' && byte[0] != 0x7F;
    if (length == 2) return byte[0] != 0xC2 || byte[1] >= 0xA0;
    if (length == 3 && byte[0] == 0xEF) // U+FFFE and U+FFFF, which are no characters
        return byte[1] != 0xBF || byte[2] < 0xBE;
    if (length == 3 && byte[0] == 0xE2) // U+2028 to U+202E, U+2066 to U+2069
        return !(byte[1] == 0x80 && byte[2] >= 0xA8 && byte[2] <= 0xAE) &&
               !(byte[1] == 0x81 && byte[2] >= 0xA6 && byte[2] <= 0xA9);
    return length > 0;
}

void text_make_printable(char *text, const char *kept) {
    char *to = text;
    for (size_t length; *text; text += length) {
        if (*text >= ' ' && *text < 0x7F) { // fast path: each time step may report an error
            length = 1;
            *to++ = *text;
            continue;
        }
        length = text_character(text);
        if (is_printable(text, length) || (length == 1 && strchr(kept, *text))) {
            memmove(to, text, length);
            to += length;
        } else {
            *to++ = '?';
            if (length == 0) length = 1;
        }
    }
    *to = '\0';
}

/* Writes "a number from 0 to 1"; infinite bounds are left out. */
static void show_range(char shown[SHOWN_TEXT], double min, double max) {
    if (isfinite(min) && isfinite(max))
        snprintf(shown, SHOWN_TEXT, "a number from %g to %g", min, max);
    else if (isfinite(min))
        snprintf(shown, SHOWN_TEXT, "a number of at least %g", min);
    else if (isfinite(max))
        snprintf(shown, SHOWN_TEXT, "a number of at most %g", max);
    else
        snprintf(shown, SHOWN_TEXT, "a finite number");
}

const void *entry_find(const void *table, size_t size, const char *name) {
    const char *entry = table;
    const char *const *found = table;

    while (*found && strcmp(*found, name) != 0) {
        entry += size;
        found = (const void *)entry;
    }
    return *found ? found : NULL;
}

ehd_status parse_real(double *value, const char *text, double min, double max, const char *object,
                      ehd_status refusal, ehd_error *error) {
    char found[SHOWN_TEXT], expected[SHOWN_TEXT];
    double number;
    if (number_read(&number, text) && number >= min && number <= max) {
        *value = number;
        return EHD_OK;
    }
    text_show(found, text);
    show_range(expected, min, max);
    return ehd_fail(error, refusal, "%s: found %s, expected %s", object, found, expected);
}

/* Reads a text of digits only. Returns false for anything else, and if the number does not fit. */
static bool count_read(size_t *value, const char *text) {
    char *end;
    if (!*text || text[strspn(text, "0123456789")]) return false;
    errno = 0;
    const unsigned long long number = strtoull(text, &end, 10);
    if (errno == ERANGE || number > SIZE_MAX) return false;
    *value = (size_t)number;
    return true;
}

ehd_status parse_count(size_t *value, const char *text, size_t min, size_t max, const char *object,
                       ehd_status refusal, ehd_error *error) {
    char found[SHOWN_TEXT];
    size_t number;
    if (count_read(&number, text) && number >= min && number <= max) {
        *value = number;
        return EHD_OK;
    }
    text_show(found, text);
    if (max == SIZE_MAX)
        return ehd_fail(error, refusal, "%s: found %s, expected a whole number of at least %zu",
                        object, found, min);
    return ehd_fail(error, refusal, "%s: found %s, expected a whole number from %zu to %zu", object,
                    found, min, max);
}

void text_print_xml(const char *text, FILE *stream) {
    for (; *text; text++) {
        if (strchr("<>&\"", *text))
            fprintf(stream, "&#%d;", *text);
        else
            fputc(*text, stream);
    }
}
