/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/settings/case_list.h"

#include "common/settings/scene_source.h"
#include "common/settings/variation.h"

#include <stdlib.h>
#include <string.h>

struct case_list {
    scene_source base; // keeps the paths below
    char *scene_path;
    variation table;
};

ehd_status case_list_read(case_list **list, const char *scene_path, const char *table_path,
                          const char *const *overrides, size_t num_overrides, ehd_error *error) {
    case_list *self = *list = calloc(1, sizeof *self);
    ehd_status status = EHD_OK;

    if (!self || !(self->scene_path = strdup(scene_path)))
        status = place_no_memory(error, scene_path);
    if (!status) {
        source_init(&self->base, self->scene_path, self->scene_path);
        status = source_apply_file(&self->base, self->scene_path, error);
    }
    if (!status) status = source_apply_overrides(&self->base, overrides, num_overrides, error);
    if (!status) status = variation_read_table(&self->table, table_path, error);
    if (!status) status = variation_check_overrides(&self->table, &self->base, table_path, error);
    if (!status) return EHD_OK;
    case_list_free(self);
    *list = NULL;
    return status;
}

size_t case_list_count(const case_list *self) {
    return self->table.num_points;
}

ehd_status case_list_scene(scene *one, const case_list *self, size_t index, ehd_error *error) {
    scene_source source = self->base;
    ehd_status status = variation_apply(&self->table, index, &source, error);

    if (status) return status; // names the line
    status = source_finish(&source, error);
    *one = source.values;
    return status == EHD_DATA ? case_list_fail(self, index, error) : status;
}

ehd_status case_list_fail(const case_list *self, size_t index, ehd_error *error) {
    const ehd_error cause = *error;

    return place_fail(error, self->table.columns[0].places[index], "%s", cause.text);
}

size_t case_list_num_columns(const case_list *self) {
    return self->table.num_columns;
}

const char *case_list_key(const case_list *self, size_t column) {
    return self->table.columns[column].row->key;
}

const char *case_list_text(const case_list *self, size_t column, size_t index) {
    return self->table.columns[column].texts[index];
}

char *case_list_settings(const case_list *self) {
    return scene_text(&self->base.values);
}

void case_list_free(case_list *self) {
    if (!self) return;
    variation_free(&self->table);
    free(self->scene_path);
    free(self);
}
