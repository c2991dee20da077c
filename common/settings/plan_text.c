/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/settings/settings_table.h"
#include "common/settings/variation.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- writing

/* Prints the settings in which a point differs from the point before. If `before` is NULL, prints
 * all settings that are given. */
static void print_changes(FILE *stream, const scene *now, const scene *before) {
    for (const setting *row = scene_settings(); row->key; row++) {
        const bool given = setting_is_given(row, now);
        if (before ? setting_compare(row, now, before) == 0 : !given) continue;
        if (given)
            setting_print(stream, row, now);
        else
            fprintf(stream, "%s:\n", row->key);
    }
}

/* Prints a group and its bounds. Bounds on alpha p_H are always printed, bounds on M only if they
 * are given, so that texts of earlier versions stay the same. */
static void print_group(FILE *stream, size_t group, const plan_where *where) {
    char low[NUMBER_TEXT], high[NUMBER_TEXT];
    fprintf(stream, "# group %zu", group);
    for (int w = 0; w < NUM_WHERE; w++) {
        const double *bounds = where->bounds[w];
        if (w != WHERE_ALPHA_P_H && isinf(bounds[0]) && isinf(bounds[1])) continue;
        number_show(low, bounds[0]);
        number_show(high, bounds[1]);
        fprintf(stream, ", %s from %s to %s", plan_where_keys[w], low, high);
    }
    fputc('\n', stream);
}

static void print_plan(FILE *stream, const plan *of) {
    for (size_t i = 0; i < of->num_points; i++) {
        const plan_point *point = &of->points[i];
        if (i == 0 || point->group != point[-1].group)
            print_group(stream, point->group, &of->where[point->group]);
        fprintf(stream, "# point %zu\n", i);
        print_changes(stream, &point->scene, i > 0 ? &point[-1].scene : NULL);
    }
}

ehd_status plan_write_text(plan *of, const char *path, ehd_error *error) {
    free(of->text);
    of->text = NULL;
    size_t length = 0;
    FILE *stream = open_memstream(&of->text, &length);
    if (!stream) return ehd_no_memory(error, path);
    print_plan(stream, of);
    const bool failed = ferror(stream) != 0;
    const bool lost = fclose(stream) != 0 || failed;
    return lost ? ehd_no_memory(error, path) : EHD_OK;
}

// ---- reading

typedef struct text_reader {
    plan *plan;
    place where; // location of the current line
    scene scene; // values of the current point so far
    // group: group of the next point; room: number of points that the allocated memory can hold
    size_t group, room;
    ehd_error *error;
} text_reader;

/* Reads one pair of bounds, ", KEY from LOWEST to HIGHEST". Returns the length of this text, or 0
 * if the text has another form. */
static int read_bounds(plan_where *where, const char *text) {
    char key[16];
    double bounds[2];
    int length = 0, w = 0;
    if (sscanf(text, ", %15s from %lf to %lf%n", key, &bounds[0], &bounds[1], &length) != 3)
        return 0;
    while (w < NUM_WHERE && strcmp(key, plan_where_keys[w]) != 0)
        w++;
    if (w == NUM_WHERE) return 0;
    memcpy(where->bounds[w], bounds, sizeof bounds);
    return length;
}

/* Reads a line "# group N" with at least one pair of bounds. */
static ehd_status read_group(text_reader *self, const char *line) {
    plan *of = self->plan;
    plan_where found = plan_anywhere();
    size_t group = 0;
    int begin = 0;
    bool good = sscanf(line, "# group %zu%n", &group, &begin) == 1 && group < MAX_POINTS;
    const char *rest = line + begin;
    do {
        const int length = read_bounds(&found, rest);
        good = good && length > 0;
        rest += length;
    } while (good && *rest);
    if (!good)
        return place_fail(self->error, self->where,
                          "found a group without number and bounds, expected both");
    if (group >= of->num_groups) {
        plan_where *grown = realloc(of->where, (group + 1) * sizeof *grown);
        if (!grown) return ehd_no_memory(self->error, self->where.file);
        for (; of->num_groups <= group; of->num_groups++)
            grown[of->num_groups] = plan_anywhere();
        of->where = grown;
    }
    of->where[group] = found;
    self->group = group;
    return EHD_OK;
}

/* Begins a point. The point has the values of the point before, until later lines change them. */
static ehd_status read_point(text_reader *self) {
    plan *of = self->plan;
    if (of->num_groups == 0)
        return place_fail(self->error, self->where, "found a point, expected its group before");
    if (of->num_points == self->room) {
        const size_t room = 2 * self->room + 64;
        plan_point *grown = realloc(of->points, room * sizeof *grown);
        if (!grown) return ehd_no_memory(self->error, self->where.file);
        of->points = grown;
        self->room = room;
    }
    of->points[of->num_points++] = (plan_point){self->scene, self->group};
    return EHD_OK;
}

/* Removes the quotes that setting_print puts around a value. */
static void unquote(char *value) {
    const size_t length = strlen(value);
    if (length < 2 || *value != '\'' || value[length - 1] != '\'') return;
    char *to = value;
    for (const char *from = value + 1; from < value + length - 1; from++) {
        *to++ = *from;
        from += from[0] == '\'' && from[1] == '\'';
    }
    *to = '\0';
}

static ehd_status read_setting(text_reader *self, char *line) {
    char *colon = strchr(line, ':');
    if (!colon || self->plan->num_points == 0)
        return place_fail(self->error, self->where,
                          "found something else, expected the text of a plan");
    *colon = '\0';
    char *value = colon + 1 + (colon[1] == ' ');
    const setting *row = setting_find(line);
    if (!row) return setting_unknown(self->error, self->where, line);
    if (!*value) {
        setting_clear(row, &self->scene);
    } else {
        unquote(value);
        ehd_status status = setting_assign(&self->scene, row, value, self->where, self->error);
        if (status) return status;
    }
    self->plan->points[self->plan->num_points - 1].scene = self->scene;
    return EHD_OK;
}

static ehd_status read_line(text_reader *self, char *line) {
    if (strncmp(line, "# group ", 8) == 0) return read_group(self, line);
    if (strncmp(line, "# point ", 8) == 0) return read_point(self);
    return *line == '#' || !*line ? EHD_OK : read_setting(self, line);
}

ehd_status plan_parse(plan *of, const char *text, const char *name, ehd_error *error) {
    text_reader self = {.plan = of, .where = {name, 0}, .error = error};
    char *copy = strdup(text), *rest = NULL;
    *of = (plan){0};
    if (!copy) return ehd_no_memory(error, name);
    for (const setting *row = scene_settings(); row->key; row++)
        setting_clear(row, &self.scene);
    ehd_status status = EHD_OK;
    for (char *line = copy; line && !status; line = rest) {
        rest = strchr(line, '\n');
        if (rest) *rest++ = '\0';
        self.where.line++;
        status = read_line(&self, line);
    }
    free(copy);
    if (!status && of->num_points == 0)
        status = place_fail(error, (place){name, 0}, "found no points, expected those of a plan");
    for (size_t i = 0; i < of->num_points && !status; i++)
        status = scene_validate(&of->points[i].scene, name, error);
    if (!status) status = plan_write_text(of, name, error);
    if (status) plan_free(of);
    return status;
}
