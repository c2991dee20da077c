/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/program/text.h"
#include "common/settings/scene_source.h"
#include "common/settings/variation.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

// longest chain of plans, each of which is a part of the next plan
enum { MAX_DEPTH = 16 };

/* The arguments of plan_read. */
typedef struct plan_reader {
    plan *plan;
    const char *path;
    const char *const *overrides;
    size_t num_overrides;
    ehd_error *error;
    double times; // factor on the number of candidates of each group
} plan_reader;

static place place_in(const plan_reader *self, const tree_node *node) {
    return (place){self->path, node->line};
}

/* Checks that a node is a map and that all its keys are in `keys`, which ends with NULL. Returns
 * EHD_DATA otherwise. */
static ehd_status check_keys(const plan_reader *self, const tree_node *map, const char *what,
                             const char *const *keys, const char *expected) {
    char shown[SHOWN_TEXT];
    if (map->kind != TREE_MAP)
        return place_fail(self->error, place_in(self, map), "%s: found %s, expected a map with %s",
                          what, tree_show(shown, map), expected);
    for (const tree_node *node = map->first; node; node = node->next) {
        const char *const *key = keys;
        while (*key && strcmp(*key, node->key) != 0)
            key++;
        if (*key) continue;
        text_show(shown, node->key);
        return place_fail(self->error, place_in(self, node),
                          "%s: found an unknown key, expected %s", shown, expected);
    }
    return EHD_OK;
}

// ---- the base scene of a group

/* Reads the base scene of a group, which the plan gives as a file or as a map. If it is a file,
 * `scene_path` receives its name; `base` keeps a pointer to this name. */
static ehd_status read_base(const plan_reader *self, scene_source *base, char **scene_path,
                            const tree_node *node) {
    char shown[SHOWN_TEXT];
    ehd_status status;
    source_init(base, self->path, self->path);
    if (node->kind == TREE_MAP) {
        status = source_apply_map(base, node, self->error);
    } else if (node->kind == TREE_SCALAR && *node->value) {
        *scene_path = path_beside(self->path, node->value);
        if (!*scene_path) return ehd_no_memory(self->error, self->path);
        base->file = base->beside = *scene_path;
        status = source_apply_file(base, *scene_path, self->error);
    } else {
        status = place_fail(self->error, place_in(self, node),
                            "scene: found %s, expected the name of a file or a map of settings",
                            tree_show(shown, node));
    }
    if (status) return status;
    return source_apply_overrides(base, self->overrides, self->num_overrides, self->error);
}

// ---- bounds

const char *const plan_where_keys[] = {
    [WHERE_ALPHA_P_H] = "alpha_p_H", [WHERE_MOES_M] = "moes_M", [NUM_WHERE] = NULL};

plan_where plan_anywhere(void) {
    plan_where all;

    for (int w = 0; w < NUM_WHERE; w++) {
        all.bounds[w][0] = -INFINITY;
        all.bounds[w][1] = INFINITY;
    }
    return all;
}

static ehd_status read_bound(const plan_reader *self, const tree_node *node, const char *key,
                             double *bound) {
    char shown[SHOWN_TEXT];
    if (node->kind == TREE_SCALAR && number_read(bound, node->value)) return EHD_OK;
    return place_fail(self->error, place_in(self, node), "%s: found %s, expected a number", key,
                      tree_show(shown, node));
}

static ehd_status read_bounds(const plan_reader *self, const tree_node *list, const char *key,
                              double bounds[2]) {
    if (list->kind != TREE_LIST || list->num_children != 2)
        return place_fail(self->error, place_in(self, list),
                          "%s: found something else, expected [lowest, highest]", key);
    ehd_status status = read_bound(self, list->first, key, &bounds[0]);
    if (!status) status = read_bound(self, list->last, key, &bounds[1]);
    if (!status && bounds[0] > bounds[1])
        status = place_fail(self->error, place_in(self, list),
                            "%s: found %g above %g, expected [lowest, highest]", key, bounds[0],
                            bounds[1]);
    return status;
}

static ehd_status read_where(const plan_reader *self, const tree_node *where, plan_where *bounds) {
    *bounds = plan_anywhere();
    if (!where) return EHD_OK;
    ehd_status status =
        check_keys(self, where, "where", plan_where_keys, "alpha_p_H, moes_M or both");
    for (int w = 0; w < NUM_WHERE && !status; w++) {
        const tree_node *list = tree_find(where, plan_where_keys[w]);
        if (list) status = read_bounds(self, list, plan_where_keys[w], bounds->bounds[w]);
    }
    return status;
}

// ---- the points of a group

/* Adds the values of a point to the error message about the point. */
static ehd_status fail_at_point(const plan_reader *self, const variation *varied, size_t point,
                                ehd_status status) {
    char values[256];
    ehd_error cause;
    if (varied->num_columns + varied->num_ranges + varied->num_histories == 0 || !self->error)
        return status;
    cause = *self->error;
    variation_show(varied, point, values, sizeof values);
    return ehd_fail(self->error, status, "%s: point %s: %s", self->path, values, cause.text);
}

static ehd_status add_points(const plan_reader *self, const scene_source *base,
                             const variation *varied, size_t group) {
    plan *of = self->plan;
    const size_t total = of->num_points + varied->num_points;
    ehd_status status = EHD_OK;
    if (total > MAX_POINTS)
        return place_fail(self->error, (place){self->path, 0},
                          "groups: found more than %d points, expected less", MAX_POINTS);
    plan_point *grown = realloc(of->points, total * sizeof *grown);
    if (!grown) return ehd_no_memory(self->error, self->path);
    of->points = grown;
    for (size_t i = 0; i < varied->num_points && !status; i++) {
        scene_source source = *base;
        status = variation_apply(varied, i, &source, self->error);
        if (!status) status = source_finish(&source, self->error);
        if (status) status = fail_at_point(self, varied, i, status);
        of->points[of->num_points++] = (plan_point){source.values, group};
    }
    return status;
}

static ehd_status read_group(const plan_reader *self, const tree_node *node, size_t group) {
    static const char *const keys[] = {"scene",      "vary",      "combine", "points", "region",
                                       "candidates", "histories", "where",   NULL};
    static const char expected[] =
        "scene, and vary, combine, points, region, candidates, histories or where";
    variation varied = {0};
    scene_source base;
    char *scene_path = NULL;
    ehd_status status = check_keys(self, node, "groups", keys, expected);
    const tree_node *scene_node = status ? NULL : tree_find(node, "scene");
    if (!status && !scene_node)
        status = place_fail(self->error, place_in(self, node),
                            "scene: found nothing, expected a file or a map of settings");
    if (!status) status = read_base(self, &base, &scene_path, scene_node);
    if (!status) status = variation_read(&varied, node, self->times, self->path, self->error);
    if (!status) status = variation_check_overrides(&varied, &base, self->path, self->error);
    if (varied.num_ranges > 0) self->plan->has_region = true;
    if (!status) status = read_where(self, tree_find(node, "where"), &self->plan->where[group]);
    if (!status) status = add_points(self, &base, &varied, group);
    variation_free(&varied);
    free(scene_path);
    return status;
}

/* Reads a scene file as a plan of one group with one point. */
static ehd_status read_single(const plan_reader *self, const tree_node *root) {
    const variation unvaried = {.num_points = 1};
    scene_source base;
    source_init(&base, self->path, self->path);
    ehd_status status = source_apply_map(&base, root, self->error);
    if (!status)
        status = source_apply_overrides(&base, self->overrides, self->num_overrides, self->error);
    if (!status) status = read_where(self, NULL, &self->plan->where[0]);
    return status ? status : add_points(self, &base, &unvaried, 0);
}

// ---- a part of another plan

static ehd_status read_plan(const plan_reader *self, const tree_node *root, int depth);

static ehd_status read_file(const plan_reader *self, int depth) {
    tree_node *root = NULL;
    char *text;
    size_t length;
    ehd_status status = tree_read_text(&text, &length, self->path, self->error);

    if (!status) status = tree_parse(&root, text, length, self->path, self->error);
    if (!status) status = read_plan(self, root, depth);
    tree_free(root);
    free(text);
    return status;
}

static ehd_status read_times(const plan_reader *self, const tree_node *node, double *times) {
    if (!node) return EHD_OK;
    ehd_status status = read_bound(self, node, "candidates_times", times);
    if (!status && !(*times >= 1 && *times <= MAX_POINTS))
        status = place_fail(self->error, place_in(self, node),
                            "candidates_times: found %g, expected a number from 1 to %d", *times,
                            MAX_POINTS);
    return status;
}

static void narrow(plan_where *where, const plan_where *further) {
    for (int w = 0; w < NUM_WHERE; w++) {
        where->bounds[w][0] = fmax(where->bounds[w][0], further->bounds[w][0]);
        where->bounds[w][1] = fmin(where->bounds[w][1], further->bounds[w][1]);
    }
}

/* Reads the groups of the whole plan, of which this plan is a part, and narrows their bounds. */
static ehd_status read_part(const plan_reader *self, const tree_node *root, int depth) {
    static const char *const keys[] = {"part_of", "where", "candidates_times", NULL};
    const tree_node *name = tree_find(root, "part_of");
    plan_reader whole = *self;
    plan_where further;
    double times = 1;
    char shown[SHOWN_TEXT];
    ehd_status status = check_keys(self, root, "plan", keys, "part_of, where or candidates_times");

    if (!status && (name->kind != TREE_SCALAR || !*name->value || depth == MAX_DEPTH))
        status = place_fail(self->error, place_in(self, name),
                            "part_of: found %s, expected the name of a plan%s",
                            tree_show(shown, name), depth == MAX_DEPTH ? ", not in a circle" : "");
    if (!status) status = read_where(self, tree_find(root, "where"), &further);
    if (!status) status = read_times(self, tree_find(root, "candidates_times"), &times);
    if (status) return status;
    char *path = path_beside(self->path, name->value);
    if (!path) return ehd_no_memory(self->error, self->path);
    whole.path = path;
    whole.times *= times;
    status = read_file(&whole, depth + 1);
    for (size_t g = 0; g < self->plan->num_groups && !status; g++)
        narrow(&self->plan->where[g], &further);
    free(path);
    return status;
}

static ehd_status read_groups(const plan_reader *self, const tree_node *root) {
    static const char *const keys[] = {"groups", NULL};
    const tree_node *groups = tree_find(root, "groups");
    plan *of = self->plan;
    of->num_groups = groups ? groups->num_children : 1;
    if (groups && (groups->kind != TREE_LIST || groups->num_children == 0))
        return place_fail(self->error, place_in(self, groups),
                          "groups: found none, expected a list of groups, each with a scene");
    of->where = calloc(of->num_groups, sizeof *of->where);
    if (!of->where) return ehd_no_memory(self->error, self->path);
    if (!groups) return read_single(self, root);

    ehd_status status = check_keys(self, root, "plan", keys, "groups");
    size_t group = 0;
    for (const tree_node *node = groups->first; node && !status; node = node->next)
        status = read_group(self, node, group++);
    return status;
}

static ehd_status read_plan(const plan_reader *self, const tree_node *root, int depth) {
    return tree_find(root, "part_of") ? read_part(self, root, depth) : read_groups(self, root);
}

// ---- equal points

static int compare_where(const plan_where *left, const plan_where *right) {
    int order = 0;

    for (int i = 0; i < 2 * NUM_WHERE && !order; i++) {
        const double a = left->bounds[i / 2][i % 2], b = right->bounds[i / 2][i % 2];
        order = (a > b) - (a < b);
    }
    return order;
}

static int compare_points(const plan *of, const plan_point *left, const plan_point *right) {
    int order = compare_where(&of->where[left->group], &of->where[right->group]);
    for (const setting *row = scene_settings(); row->key && !order; row++)
        order = setting_compare(row, &left->scene, &right->scene);
    return order;
}

/* Compares point numbers for qsort_r: equal points become neighbours, in their original order. */
static int compare_numbers(const void *left, const void *right, void *context) {
    const plan *of = context;
    const size_t i = *(const size_t *)left, j = *(const size_t *)right;
    const int order = compare_points(of, &of->points[i], &of->points[j]);
    return order ? order : (i > j) - (i < j);
}

static ehd_status drop_equal_points(plan *of, const char *path, ehd_error *error) {
    size_t *order = calloc(of->num_points, sizeof *order), kept = 0;
    bool *equal = calloc(of->num_points, sizeof *equal);
    ehd_status status = order && equal ? EHD_OK : ehd_no_memory(error, path);
    if (!status) {
        for (size_t i = 0; i < of->num_points; i++)
            order[i] = i;
        qsort_r(order, of->num_points, sizeof *order, compare_numbers, of);
        for (size_t i = 1; i < of->num_points; i++)
            equal[order[i]] = !compare_points(of, &of->points[order[i - 1]], &of->points[order[i]]);
        for (size_t i = 0; i < of->num_points; i++)
            if (!equal[i]) of->points[kept++] = of->points[i];
        of->num_points = kept;
    }
    free(order);
    free(equal);
    return status;
}

// ---- all

ehd_status plan_read(plan *of, const char *path, const char *const *overrides, size_t num_overrides,
                     ehd_error *error) {
    const plan_reader self = {of, path, overrides, num_overrides, error, 1};
    *of = (plan){0};
    ehd_status status = read_file(&self, 0);
    if (!status) status = drop_equal_points(of, path, error);
    if (!status) status = plan_write_text(of, path, error);
    if (status) plan_free(of);
    return status;
}

void plan_free(plan *of) {
    free(of->points);
    free(of->where);
    free(of->text);
    *of = (plan){0};
}
