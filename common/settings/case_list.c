/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/settings/case_list.h"

#include "common/settings/csv.h"
#include "common/settings/scene_source.h"
#include "common/settings/variation.h"

#include <stdlib.h>
#include <string.h>

/* The only column that is not a setting. */
static const char name_column[] = "name";

struct case_list {
    scene_source base; // points to the paths below
    char *scene_path, *table_path;
    csv_file table;
    const setting **rows; // [table.width] setting of each column; NULL for the column `name`
    bool any;             // a row was found
};

static ehd_status check_overrides(const case_list *self, ehd_error *error) {
    for (size_t i = 0; i < self->table.width; i++)
        if (self->rows[i] && source_is_overridden(&self->base, self->rows[i]))
            return place_fail(error, (place){"--set", 0},
                              "%s: found a key that %s varies, expected another one",
                              self->rows[i]->key, self->table_path);
    return EHD_OK;
}

ehd_status case_list_rewind(case_list *self, ehd_error *error) {
    csv_close(&self->table);
    free(self->rows);
    self->rows = NULL;
    self->any = false;
    ehd_status status = csv_open_rows(&self->table, self->table_path, error);
    if (status) return status;
    self->rows = calloc(self->table.width, sizeof(const setting *));
    if (!self->rows) return ehd_no_memory(error, self->table_path);
    return table_settings(self->rows, &self->table, name_column, error);
}

ehd_status case_list_open(case_list **list, const char *scene_path, const char *table_path,
                          const char *const *overrides, size_t num_overrides, ehd_error *error) {
    case_list *self = *list = calloc(1, sizeof *self);
    ehd_status status = EHD_OK;

    if (!self || !(self->scene_path = strdup(scene_path)) ||
        !(self->table_path = strdup(table_path)))
        status = ehd_no_memory(error, scene_path);
    if (!status) {
        source_init(&self->base, self->scene_path, self->scene_path);
        status = source_apply_file(&self->base, self->scene_path, error);
    }
    if (!status) status = source_apply_overrides(&self->base, overrides, num_overrides, error);
    if (!status) status = case_list_rewind(self, error);
    if (!status) status = check_overrides(self, error);
    if (!status) return EHD_OK;
    case_list_free(self);
    *list = NULL;
    return status;
}

/* Returns the text of a field. If its column has a unit, this is the value in SI units, or the
 * value with its unit if the setting does not accept it. The caller frees the text. NULL: no
 * memory. */
static char *text_of(const case_list *self, size_t column) {
    const char *field = self->table.fields[column], *unit = self->table.units[column];
    const setting *row = self->rows[column];
    char number[NUMBER_TEXT], *text;

    if (row && row->type == SETTING_REAL) csv_take_decimal_comma(&self->table, column);
    if (!unit || !row) return strdup(field);
    scene any = self->base.values;
    if (asprintf(&text, "%s %s", field, unit) < 0) return NULL;
    if (row->type != SETTING_REAL || setting_assign(&any, row, text, (place){0}, NULL)) return text;
    // if the table gives the kind of contact too, the scene has to check the unit of the load
    if (*any.physical.load_unit && !*any.contact) return text;
    free(text);
    number_show(number, setting_real(row, &any));
    return strdup(number);
}

/* Copies the fields of the row that was read last. */
static ehd_status keep_texts(case_texts *row, const case_list *self, ehd_error *error) {
    row->line = self->table.where.line;
    row->num_texts = self->table.width;
    row->texts = calloc(row->num_texts, sizeof *row->texts);
    for (size_t i = 0; i < row->num_texts && row->texts; i++)
        if (!(row->texts[i] = text_of(self, i))) return ehd_no_memory(error, self->table_path);
    return row->texts ? EHD_OK : ehd_no_memory(error, self->table_path);
}

ehd_status case_list_next(case_texts *row, bool *found, case_list *self, ehd_error *error) {
    *row = (case_texts){0};
    const ehd_status status = csv_next_row(found, &self->table, error);
    if (status) return status;
    if (!*found && !self->any)
        return place_fail(error, (place){self->table_path, 0},
                          "found a header only, expected a row for each scene");
    self->any = true;
    return *found ? keep_texts(row, self, error) : EHD_OK;
}

void case_texts_free(case_texts *row) {
    for (size_t i = 0; i < row->num_texts && row->texts; i++)
        free(row->texts[i]);
    free(row->texts);
    *row = (case_texts){0};
}

ehd_status case_list_scene(scene *one, const case_list *self, const case_texts *row,
                           ehd_error *error) {
    const place where = {self->table_path, row->line};
    scene_source source = self->base;
    ehd_status status = EHD_OK;

    for (size_t i = 0; i < self->table.width && !status; i++) {
        if (!self->rows[i]) continue;
        source.places[setting_index(self->rows[i])] = where;
        status =
            source_assign(&source, self->rows[i], row->texts[i], self->table_path, where, error);
    }
    if (status) return status; // the error names the line already
    status = source_finish(&source, error);
    *one = source.values;
    return status == EHD_DATA ? case_list_fail(self, row->line, error) : status;
}

ehd_status case_list_fail(const case_list *self, size_t line, ehd_error *error) {
    const ehd_error cause = *error;
    const size_t length = strlen(self->table_path);
    const bool named =
        strncmp(cause.text, self->table_path, length) == 0 && cause.text[length] == ':';

    // an error in a value of this row already names the row
    return named ? EHD_DATA : place_fail(error, (place){self->table_path, line}, "%s", cause.text);
}

size_t case_list_num_columns(const case_list *self) {
    return self->table.width;
}

const char *case_list_key(const case_list *self, size_t column) {
    return self->rows[column] ? self->rows[column]->key : name_column;
}

char *case_list_settings(const case_list *self) {
    return scene_text(&self->base.values);
}

void case_list_free(case_list *self) {
    if (!self) return;
    csv_close(&self->table);
    free(self->rows);
    free(self->scene_path);
    free(self->table_path);
    free(self);
}
