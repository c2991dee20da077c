/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads variants of one scene (cases) from a table. The table has a column for each setting that
 * varies and a row for each variant. It is read row by row, so that memory does not grow with the
 * number of rows. */
#ifndef EHD_CASE_LIST_H
#define EHD_CASE_LIST_H

#include "common/settings/scene.h"
#include <stdbool.h>
#include <stdio.h>

typedef struct case_list case_list;

/* The fields of one row of the table. */
typedef struct case_texts {
    size_t line;  // line number in the table
    char **texts; // [num_texts], one for each column; in SI units if the column has a unit
    size_t num_texts;
} case_texts;

/* Opens a table of cases. The scene may lack settings that the table gives. The table is a CSV file
 * like the `points` of a plan, and may have a column `name`. Errors: EHD_DATA, EHD_NOINPUT, EHD_IO,
 * EHD_MEMORY. */
ehd_status case_list_open(
    // output:
    case_list **list, // free with case_list_free
    // input:
    const char *scene_path, const char *table_path, const char *const *overrides,
    size_t num_overrides, ehd_error *error);

/* Reads the next row; *found is false after the last row. Returns EHD_DATA for a malformed row,
 * with the line number in the message, and for a table without rows. */
ehd_status case_list_next(
    // output:
    case_texts *row, // free with case_texts_free, also after a failure
    bool *found,
    // in and out:
    case_list *list, ehd_error *error);

/* Goes back to the first row. */
ehd_status case_list_rewind(case_list *list, ehd_error *error);

void case_texts_free(case_texts *row);

/* Makes the complete and valid scene of a row. Returns EHD_DATA, with the line number in the table,
 * if the row gives no valid scene. */
ehd_status case_list_scene(scene *one, const case_list *list, const case_texts *row,
                           ehd_error *error);

/* Puts the table's name and a line number in front of an error's text. Returns EHD_DATA. */
ehd_status case_list_fail(const case_list *list, size_t line, ehd_error *error);

/* Returns the number of columns. */
size_t case_list_num_columns(const case_list *list);
/* Returns the key of a column; `column` counts from 0 in the order of the table. This is the full
 * key even if the table has a short key. The column of names has the key "name". */
const char *case_list_key(const case_list *list, size_t column);

/* Returns the settings of the scene that do not come from the table, as text. The caller frees the
 * text with free(). Returns NULL if there is no memory. */
char *case_list_settings(const case_list *list);

void case_list_free(case_list *list);

#endif
