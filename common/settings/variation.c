/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/settings/variation.h"

#include "common/program/text.h"
#include <gsl/gsl_qrng.h>
#include <math.h>
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
    return column->texts && column->places ? EHD_OK : ehd_no_memory(error, where.file);
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

static ehd_status find_settings(const setting **rows, const csv_file *table, const char *beside,
                                ehd_error *error) {
    for (size_t i = 0; i < table->width; i++) {
        const char *name = table->names[i];
        rows[i] = NULL;
        if (beside && strcmp(name, beside) == 0) continue;
        if (!*name)
            return place_fail(error, table->where,
                              "found a column without a name, such as an index, expected settings");
        rows[i] = setting_find_short(name);
        if (!rows[i]) return setting_unknown(error, table->where, name);
        for (size_t k = 0; k < i; k++)
            if (rows[k] == rows[i])
                return place_fail(error, table->where, "%s: found again, expected only once",
                                  rows[i]->key);
    }
    return EHD_OK;
}

ehd_status table_settings(const setting **rows, const csv_file *table, const char *beside,
                          ehd_error *error) {
    char all[NAMES_TEXT];
    ehd_error cause = {""};
    const ehd_status status = find_settings(rows, table, beside, &cause);
    if (!status) return EHD_OK;
    table_show_columns(all, table->names, table->width);
    return ehd_fail(error, status, "%s; found the columns %s", cause.text, all);
}

static ehd_status read_csv_header(variation *self, ehd_error *error) {
    const csv_file *points = &self->points;
    const size_t room = csv_count_rows(points);
    const setting **rows = calloc(points->width, sizeof *rows);
    ehd_status status =
        rows ? table_settings(rows, points, NULL, error) : ehd_no_memory(error, points->path);
    for (size_t i = 0; i < points->width && !status; i++)
        status = add_column(self, rows[i]->key, points->where, room, error);
    free(rows);
    return status;
}

/* Keeps the text of a field, with the unit of its column. */
static ehd_status keep_text(const char **text, variation *self, size_t column, ehd_error *error) {
    const csv_file *points = &self->points;
    char *joined, **list;

    if (self->columns[column].row->type == SETTING_REAL) csv_take_decimal_comma(points, column);
    *text = points->fields[column];
    if (!points->units[column]) return EHD_OK;
    list = realloc(self->with_units, (self->num_with_units + 1) * sizeof *list);
    if (!list) return ehd_no_memory(error, points->path);
    self->with_units = list;
    if (asprintf(&joined, "%s %s", points->fields[column], points->units[column]) < 0)
        return ehd_no_memory(error, points->path);
    *text = list[self->num_with_units++] = joined;
    return EHD_OK;
}

static ehd_status read_csv_rows(variation *self, ehd_error *error) {
    size_t num_rows = 0;
    bool found = true;
    ehd_status status = read_csv_header(self, error);
    while (!status && !(status = csv_next_row(&found, &self->points, error)) && found) {
        for (size_t i = 0; i < self->num_columns; i++) {
            status = keep_text(&self->columns[i].texts[num_rows], self, i, error);
            if (status) return status;
            self->columns[i].places[num_rows] = self->points.where;
        }
        num_rows++;
    }
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
    if (!csv_path) return ehd_no_memory(error, path);
    const ehd_status status = csv_open(&self->points, csv_path, error);
    free(csv_path);
    return status ? status : read_csv_rows(self, error);
}

// ---- regions

/* Reads a bound, which must be a value that the setting may have. */
static ehd_status check_bound(double *bound, const setting *row, const char *text, place where,
                              ehd_error *error) {
    scene any;

    scene_defaults(&any);
    const ehd_status status = setting_assign(&any, row, text, where, error);
    if (!status && any.transient.in_seconds)
        return place_fail(error, where, "%s: found seconds in a region, expected T", row->key);
    if (!status) *bound = setting_real(row, &any);
    return status;
}

static ehd_status read_bounds(variation_range *range, const tree_node *list, ehd_error *error) {
    const setting *row = range->row;
    ehd_status status = EHD_OK;
    const bool pair = list->kind == TREE_LIST && list->num_children == 2;
    if (row->type != SETTING_REAL)
        return place_fail(error, range->where,
                          "region: found %s, expected a setting that is a number", row->key);
    if (!pair || list->first->kind != TREE_SCALAR || list->last->kind != TREE_SCALAR)
        return place_fail(error, range->where,
                          "%s: found something else, expected [lowest, highest]", row->key);
    status = check_bound(&range->low, row, list->first->value, range->where, error);
    if (!status) status = check_bound(&range->high, row, list->last->value, range->where, error);
    if (status) return status;
    range->texts[0] = list->first->value;
    range->texts[1] = list->last->value;
    if (!(range->low < range->high))
        return place_fail(error, range->where, "%s: found %s to %s, expected [lowest, highest]",
                          row->key, list->first->value, list->last->value);
    return EHD_OK;
}

static ehd_status add_range(variation *self, const tree_node *node, const char *path,
                            ehd_error *error) {
    const place where = {path, node->line};
    const setting *row = setting_find_short(node->key);
    if (!row) return setting_unknown(error, where, node->key);
    bool again = false;
    for (size_t i = 0; i < self->num_columns; i++)
        again = again || self->columns[i].row == row;
    for (size_t i = 0; i < self->num_ranges; i++)
        again = again || self->ranges[i].row == row;
    if (again) return place_fail(error, where, "%s: found again, expected only once", row->key);
    if (self->num_ranges == MAX_RANGES)
        return place_fail(error, where, "region: found more than %d settings, expected less",
                          MAX_RANGES);
    variation_range *range = &self->ranges[self->num_ranges++];
    *range = (variation_range){.row = row, .where = where};
    return read_bounds(range, node, error);
}

/* Sets the coordinates of corner number `corner` of the unit cube. Each bit of the number is the
 * coordinate, 0 or 1, of one setting. */
static void set_corner(double *here, size_t num_ranges, size_t corner) {
    for (size_t r = 0; r < num_ranges; r++)
        here[r] = (double)(corner >> r & 1);
}

/* Fills in points along all edges of the unit cube, axis after axis. Returns the number of these
 * points. */
static size_t fill_edges(double *places, size_t num_ranges, size_t num_on_edge) {
    size_t count = 0;
    for (size_t axis = 0; axis < num_ranges; axis++)
        for (size_t corner = 0; corner < (size_t)1 << num_ranges; corner++) {
            if (corner >> axis & 1) continue;
            for (size_t i = 1; i <= num_on_edge; i++) {
                double *here = places + num_ranges * count++;
                set_corner(here, num_ranges, corner);
                here[axis] = (double)i / (double)(num_on_edge + 1);
            }
        }
    return count;
}

/* Fills in the candidates: all corners, a quarter of the candidates along the edges, and the rest
 * inside. */
static ehd_status fill_candidates(variation *self, const char *path, ehd_error *error) {
    const size_t d = self->num_ranges, num_corners = (size_t)1 << d,
                 num_edges = d * num_corners / 2;
    const size_t num_on_edge = self->num_candidates / 4 / num_edges;
    // the state of the sequence is allocated here, because gsl_qrng_alloc ends the process if there
    // is no memory
    const gsl_qrng_type *type = gsl_qrng_sobol;
    gsl_qrng sequence = {type, (unsigned)d, type->state_size((unsigned)d), NULL};
    sequence.state = malloc(sequence.state_size);
    self->candidates = malloc(self->num_candidates * d * sizeof(double));
    if (!sequence.state || !self->candidates || type->init_state(sequence.state, (unsigned)d)) {
        free(sequence.state);
        return ehd_no_memory(error, path);
    }
    for (size_t corner = 0; corner < num_corners; corner++)
        set_corner(self->candidates + d * corner, d, corner);
    size_t count = num_corners + fill_edges(self->candidates + d * num_corners, d, num_on_edge);
    for (; count < self->num_candidates; count++)
        gsl_qrng_get(&sequence, self->candidates + d * count);
    free(sequence.state);
    return EHD_OK;
}

static ehd_status read_candidates(variation *self, const tree_node *node, double times,
                                  const char *path, ehd_error *error) {
    const size_t fewest = (size_t)2 << self->num_ranges;
    char shown[SHOWN_TEXT];
    double wanted = DEFAULT_CANDIDATES;
    if (node && (node->kind != TREE_SCALAR || !number_read(&wanted, node->value) ||
                 !(wanted >= (double)fewest && wanted <= MAX_POINTS) || wanted != floor(wanted)))
        return place_fail(error, (place){path, node->line},
                          "candidates: found %s, expected a number from %zu to %d",
                          tree_show(shown, node), fewest, MAX_POINTS);
    self->num_candidates = (size_t)fmin(ceil(times * wanted), MAX_POINTS + 1.0);
    return EHD_OK;
}

static ehd_status read_region(variation *self, const tree_node *group, double times,
                              const char *path, ehd_error *error) {
    const tree_node *region = tree_find(group, "region");
    const tree_node *candidates = tree_find(group, "candidates");
    char shown[SHOWN_TEXT];
    ehd_status status = EHD_OK;
    if (!region && candidates)
        return place_fail(error, (place){path, candidates->line},
                          "candidates: found it without region, expected both");
    if (!region) return EHD_OK;
    if (region->kind != TREE_MAP || region->num_children == 0)
        return place_fail(error, (place){path, region->line},
                          "region: found %s, expected a map such as {moes.M: [5, 50]}",
                          region->kind == TREE_MAP ? "nothing" : tree_show(shown, region));
    for (const tree_node *node = region->first; node && !status; node = node->next)
        status = add_range(self, node, path, error);
    if (!status) status = read_candidates(self, candidates, times, path, error);
    if (!status && self->num_points > MAX_POINTS / self->num_candidates)
        status =
            place_fail(error, (place){path, region->line},
                       "region: found more than %d candidates in all, expected less", MAX_POINTS);
    if (!status) status = fill_candidates(self, path, error);
    if (!status) self->num_points *= self->num_candidates;
    return status;
}

static double range_part(const variation *self, size_t range, size_t point) {
    return self->candidates[self->num_ranges * (point % self->num_candidates) + range];
}

static double range_value(const variation *self, size_t range, size_t point) {
    const variation_range *of = &self->ranges[range];
    const double part = range_part(self, range, point);
    if (part <= 0) return of->low;
    if (part >= 1) return of->high;
    if (of->low > 0) return of->low * pow(of->high / of->low, part);
    return of->low + part * (of->high - of->low);
}

/* Returns the value of a range at a point, as text. At both ends this is the text of the plan,
 * whose unit the scene checks. */
static const char *range_text(char text[NUMBER_TEXT], const variation *self, size_t range,
                              size_t point) {
    const double part = range_part(self, range, point);
    if (part <= 0 || part >= 1) return self->ranges[range].texts[part >= 1];
    number_show(text, range_value(self, range, point));
    return text;
}

static ehd_status apply_ranges(const variation *self, size_t point, scene_source *source,
                               ehd_error *error) {
    ehd_status status = EHD_OK;
    for (size_t r = 0; r < self->num_ranges && !status; r++) {
        const variation_range *range = &self->ranges[r];
        char number[NUMBER_TEXT];
        const char *text = range_text(number, self, r, point);
        source->places[setting_index(range->row)] = range->where;
        status = source_assign(source, range->row, text, range->where.file, range->where, error);
    }
    return status;
}

// ---- histories

static ehd_status read_histories(variation *self, const tree_node *group, const char *path,
                                 ehd_error *error) {
    const tree_node *node = tree_find(group, "histories");

    if (!node) return EHD_OK;
    if (self->num_ranges > 0)
        return place_fail(error, (place){path, node->line},
                          "histories: found region beside them, expected only one");
    ehd_status status = default_histories_read(&self->histories, node, path, error);
    if (status) return status;
    self->num_histories = default_histories_count(&self->histories);
    if (self->num_points > MAX_POINTS / self->num_histories)
        return place_fail(error, (place){path, node->line},
                          "histories: found more than %d trajectories in all, expected less",
                          MAX_POINTS);
    self->num_points *= self->num_histories;
    return EHD_OK;
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

ehd_status variation_read(variation *self, const tree_node *group, double times,
                          const char *plan_path, ehd_error *error) {
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
    if (!status) status = read_region(self, group, times, plan_path, error);
    return status ? status : read_histories(self, group, plan_path, error);
}

ehd_status variation_check_overrides(const variation *self, const scene_source *base,
                                     const char *path, ehd_error *error) {
    for (size_t i = 0; i < self->num_columns + self->num_ranges; i++) {
        const setting *row =
            i < self->num_columns ? self->columns[i].row : self->ranges[i - self->num_columns].row;
        if (source_is_overridden(base, row))
            return place_fail(error, (place){"--set", 0},
                              "%s: found a key that %s varies, expected another one", row->key,
                              path);
    }
    return EHD_OK;
}

// ---- points

static size_t value_index(const variation *self, size_t column, size_t point) {
    if (self->num_ranges > 0) point /= self->num_candidates;
    if (self->num_histories > 0) point /= self->num_histories;
    if (!self->grid) return point;
    for (size_t i = self->num_columns - 1; i > column; i--)
        point /= self->columns[i].num_values;
    return point % self->columns[column].num_values;
}

ehd_status variation_apply(const variation *self, size_t point, scene_source *source,
                           ehd_error *error) {
    ehd_status status = EHD_OK;
    if (self->num_histories > 0)
        status =
            default_histories_apply(&self->histories, point % self->num_histories, source, error);
    for (size_t i = 0; i < self->num_columns && !status; i++) {
        const variation_column *column = &self->columns[i];
        const size_t k = value_index(self, i, point);
        source->places[setting_index(column->row)] = column->places[k];
        status = source_assign(source, column->row, column->texts[k], column->places[k].file,
                               column->places[k], error);
    }
    return status ? status : apply_ranges(self, point, source, error);
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
    for (size_t r = 0; r < self->num_ranges && used < size; r++)
        used += (size_t)snprintf(shown + used, size - used, "%s%s=%g",
                                 self->num_columns + r > 0 ? ", " : "", self->ranges[r].row->key,
                                 range_value(self, r, point));
    if (self->num_histories == 0 || used + 2 >= size) return;
    if (used > 0) used += (size_t)snprintf(shown + used, size - used, ", ");
    default_histories_show(&self->histories, point % self->num_histories, shown + used,
                           size - used);
}

void variation_free(variation *self) {
    for (size_t i = 0; i < self->num_columns; i++) {
        free(self->columns[i].texts);
        free(self->columns[i].places);
    }
    free(self->candidates);
    csv_close(&self->points);
    for (size_t i = 0; i < self->num_with_units; i++)
        free(self->with_units[i]);
    free(self->with_units);
    *self = (variation){0};
}
