/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prints the table of settings as the page schemas/scene.md shows it. test_settings.c compares the
 * page with this table, or writes it. */
#ifndef EHD_SETTINGS_PAGE_H
#define EHD_SETTINGS_PAGE_H

#include <stdio.h>

void settings_page_print(FILE *stream);

#endif
