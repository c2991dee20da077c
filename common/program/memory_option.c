/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/program/memory_option.h"

#include "common/program/text.h"

#include <math.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

double memory_option_default(void) {
    const long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGE_SIZE);
    double bytes = pages > 0 && page > 0 ? (double)pages * (double)page : 8e9;
    struct rlimit limit;

    if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
        bytes = fmin(bytes, (double)limit.rlim_cur);
    return 0.5 * bytes;
}

ehd_status memory_option_read(void *member, const char *argument, ehd_error *error) {
    static const struct {
        char letter;
        double bytes;
    } units[] = {{'K', 1e3}, {'M', 1e6}, {'G', 1e9}, {'T', 1e12}};
    const size_t length = strlen(argument);
    char number[NUMBER_TEXT], shown[SHOWN_TEXT];
    double *bytes = member, unit = 0;

    for (size_t i = 0; i < sizeof units / sizeof *units && length > 0; i++)
        if (argument[length - 1] == units[i].letter) unit = units[i].bytes;
    if (unit > 0 && length <= sizeof number) {
        memcpy(number, argument, length - 1);
        number[length - 1] = '\0';
        if (number_read(bytes, number) && *bytes > 0) {
            *bytes *= unit;
            return EHD_OK;
        }
    }
    text_show(shown, argument);
    return ehd_fail(error, EHD_USAGE,
                    "--memory: found %s, expected a number above 0 and K, M, G or T, as 2G", shown);
}
