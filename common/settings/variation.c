/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/settings/variation.h"

#include "common/program/text.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// ---- columns

static ehd_status add_column(variation *self, const char *name, place where, size_t num_values,
                             ehd_error *error) {
    const setting *row = setting_find_short(name);
    if (!row) return setting_unknown(error, where, name);
    for (size_t i = 0; i < self->num_columns; i++)
        if (self->columns[i].row == row)
            return place_fail(error, where, "%s: found again, expected only once", row->key);
    // no setting is added twice, so that the array is large enough
    variation_column *column = &self->columns[self->num_columns++];
    *column = (variation_column){.row = row, .num_values = num_values};
    column->texts = calloc(num_values, sizeof *column->texts);
    column->places = calloc(num_values, sizeof *column->places);
    return column->texts && column->places ? EHD_OK : place_no_memory(error, where.file);
}

static ehd_status fill_from_list(variation_column *column, const tree_node *list, const char *path,
                                 ehd_error *error) {
    char shown[SHOWN_TEXT];
    size_t i = 0;
    for (const tree_node *node = list->first; node; node = node->next, i++) {
        const place where = {path, node->line};
        if (node->kind != TREE_SCALAR)
            return place_fail(error, where, "%s: found %s, expected single values",
                              column->row->key, tree_show(shown, node));
        column->texts[i] = node->value;
        column->places[i] = where;
    }
    return EHD_OK;
}

static ehd_status read_vary(variation *self, const tree_node *vary, const char *path,
                            ehd_error *error) {
    char shown[SHOWN_TEXT], name[SHOWN_TEXT];
    ehd_status status = EHD_OK;
    if (vary->kind != TREE_MAP)
        return place_fail(error, (place){path, vary->line},
                          "vary: found %s, expected a map such as {moes.M: [5, 10]}",
                          tree_show(shown, vary));
    for (const tree_node *node = vary->first; node && !status; node = node->next) {
        const place where = {path, node->line};
        text_show(name, node->key);
        if (node->kind != TREE_LIST || node->num_children == 0)
            return place_fail(error, where, "%s: found %s, expected a list of values", name,
                              node->kind == TREE_LIST ? "an empty list" : tree_show(shown, node));
        status = add_column(self, node->key, where, node->num_children, error);
        if (!status)
            status = fill_from_list(&self->columns[self->num_columns - 1], node, path, error);
    }
    return status;
}

// ---- CSV

static ehd_status read_csv_header(variation *self, char *line, ehd_error *error) {
    const size_t room = csv_count_lines(&self->points);
    ehd_status status = EHD_OK;
    for (char *field; !status && (field = csv_next_field(&line));)
        status = add_column(self, field, self->points.where, room, error);
    return status;
}

static ehd_status read_csv_row(variation *self, char *line, size_t row, ehd_error *error) {
    size_t num_fields = 0;
    for (char *field; (field = csv_next_field(&line)); num_fields++) {
        if (num_fields >= self->num_columns) continue;
        self->columns[num_fields].texts[row] = field;
        self->columns[num_fields].places[row] = self->points.where;
    }
    return csv_check_width(&self->points, num_fields, self->num_columns, error);
}

static ehd_status read_csv_lines(variation *self, ehd_error *error) {
    size_t num_rows = 0;
    char *line = csv_next_line(&self->points);
    if (!line)
        return place_fail(error, (place){self->points.path, 0},
                          "found an empty file, expected a header such as moes.M,moes.L");
    ehd_status status = read_csv_header(self, line, error);
    while (!status && (line = csv_next_line(&self->points)))
        status = read_csv_row(self, line, num_rows++, error);
    for (size_t i = 0; i < self->num_columns; i++)
        self->columns[i].num_values = num_rows;
    if (!status && num_rows == 0)
        return place_fail(error, (place){self->points.path, 0},
                          "found a header only, expected a row for each point");
    return status;
}

static ehd_status read_csv(variation *self, const tree_node *points, const char *path,
                           ehd_error *error) {
    char shown[SHOWN_TEXT];
    if (points->kind != TREE_SCALAR || !*points->value)
        return place_fail(error, (place){path, points->line},
                          "points: found %s, expected the name of a CSV file",
                          tree_show(shown, points));
    char *csv_path = path_beside(path, points->value);
    if (!csv_path) return place_no_memory(error, path);
    const ehd_status status = csv_open(&self->points, csv_path, error);
    free(csv_path);
    return status ? status : read_csv_lines(self, error);
}

// ---- combination

static ehd_status read_combine(variation *self, const tree_node *group, const char *path,
                               ehd_error *error) {
    const tree_node *combine = tree_find(group, "combine");
    char shown[SHOWN_TEXT];
    self->grid = true;
    if (!combine) return EHD_OK;
    const char *found = tree_show(shown, combine);
    self->grid = strcmp(found, "grid") == 0;
    if (!tree_find(group, "vary"))
        return place_fail(error, (place){path, combine->line},
                          "combine: found it without vary, expected both");
    if (!self->grid && strcmp(found, "list") != 0)
        return place_fail(error, (place){path, combine->line},
                          "combine: found %s, expected grid|list", found);
    return EHD_OK;
}

static ehd_status count_grid(variation *self, place where, ehd_error *error) {
    self->num_points = 1;
    for (size_t i = 0; i < self->num_columns; i++) {
        // no overflow: both factors are below 2^32
        self->num_points *= self->columns[i].num_values;
        if (self->num_points > MAX_POINTS)
            return place_fail(error, where, "groups: found more than %d points, expected less",
                              MAX_POINTS);
    }
    return EHD_OK;
}

static ehd_status count_list(variation *self, place where, ehd_error *error) {
    const variation_column *first = self->columns;
    self->num_points = first->num_values;
    for (size_t i = 1; i < self->num_columns; i++)
        if (self->columns[i].num_values != first->num_values)
            return place_fail(error, where,
                              "combine: found %zu values of %s and %zu of %s, expected as many of "
                              "each in a list",
                              first->num_values, first->row->key, self->columns[i].num_values,
                              self->columns[i].row->key);
    if (self->num_points > MAX_POINTS)
        return place_fail(error, where, "groups: found more than %d points, expected less",
                          MAX_POINTS);
    return EHD_OK;
}

ehd_status variation_read(variation *self, const tree_node *group, const char *plan_path,
                          ehd_error *error) {
    const tree_node *vary = tree_find(group, "vary"), *points = tree_find(group, "points");
    const place where = {plan_path, group->line};
    *self = (variation){0};
    if (vary && points)
        return place_fail(error, (place){plan_path, points->line},
                          "points: found points and vary, expected only one");
    ehd_status status = read_combine(self, group, plan_path, error);
    if (!status && vary) status = read_vary(self, vary, plan_path, error);
    if (!status && points) status = read_csv(self, points, plan_path, error);
    if (points) self->grid = false;
    if (!status && self->num_columns > 0)
        status = self->grid ? count_grid(self, where, error) : count_list(self, where, error);
    else
        self->num_points = 1;
    return status;
}

// ---- points

/* The index of a point's value in a column. */
static size_t value_index(const variation *self, size_t column, size_t point) {
    if (!self->grid) return point;
    for (size_t i = self->num_columns - 1; i > column; i--)
        point /= self->columns[i].num_values;
    return point % self->columns[column].num_values;
}

ehd_status variation_apply(const variation *self, size_t point, scene_source *source,
                           ehd_error *error) {
    ehd_status status = EHD_OK;
    for (size_t i = 0; i < self->num_columns && !status; i++) {
        const variation_column *column = &self->columns[i];
        const size_t k = value_index(self, i, point);
        source->places[setting_index(column->row)] = column->places[k];
        status = source_assign(source, column->row, column->texts[k], column->places[k].file,
                               column->places[k], error);
    }
    return status;
}

void variation_show(const variation *self, size_t point, char *shown, size_t size) {
    char value[SHOWN_TEXT];
    size_t used = 0;
    *shown = '\0';
    for (size_t i = 0; i < self->num_columns && used < size; i++) {
        text_show(value, self->columns[i].texts[value_index(self, i, point)]);
        used += (size_t)snprintf(shown + used, size - used, "%s%s=%s", i ? ", " : "",
                                 self->columns[i].row->key, value);
    }
}

void variation_free(variation *self) {
    for (size_t i = 0; i < self->num_columns; i++) {
        free(self->columns[i].texts);
        free(self->columns[i].places);
    }
    csv_close(&self->points);
    *self = (variation){0};
}
