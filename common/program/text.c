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
    // strtod alone would take spaces, nan, inf and hexadecimal
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

/* "a number from 0 to 1"; infinite bounds are left out. */
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

/* False unless the text is digits only and fits. */
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
