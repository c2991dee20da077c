/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scenes that a table makes of one: a column for each setting that varies, a row for each scene. */
#ifndef EHD_CASE_LIST_H
#define EHD_CASE_LIST_H

#include "common/settings/scene.h"
#include <stdio.h>

typedef struct case_list case_list;

/* Reads the scene, which need not be complete without the table, and the table, CSV as the `points` of
 * a plan. EHD_DATA, EHD_NOINPUT, EHD_IO, EHD_MEMORY. */
ehd_status case_list_read(
    // output:
    case_list **list, // free with case_list_free
    // input:
    const char *scene_path, const char *table_path, const char *const *overrides,
    size_t num_overrides, ehd_error *error);

size_t case_list_count(const case_list *list);

/* One of them, complete and valid. EHD_DATA with the line of the table. */
ehd_status case_list_scene(scene *one, const case_list *list, size_t index, ehd_error *error);

/* EHD_DATA with the line of the table before the text of a case's error. */
ehd_status case_list_fail(const case_list *list, size_t index, ehd_error *error);

/* The columns, and what a row has there, as in the table. */
size_t case_list_num_columns(const case_list *list);
const char *case_list_key(const case_list *list, size_t column);
const char *case_list_text(const case_list *list, size_t column, size_t index);

/* The settings of the scene, as far as they are given without the table; free with free(). NULL: no
 * memory. */
char *case_list_settings(const case_list *list);

void case_list_free(case_list *list);

#endif
