/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/program/text.h"
#include "common/settings/scene_source.h"
#include <math.h>
#include <string.h>

static const double max_nodes = 2e6;
static const double whole_number_tolerance = 1e-9; // relative, of the number of steps

// ---- keys that belong together

/* Counts which of the keys with a prefix are given, and lists the others: "moes.M, moes.L". */
typedef struct key_count {
    size_t given;
    size_t all;
    char missing[256];
} key_count;

static void count_key(key_count *count, const setting *row, const scene *of) {
    const size_t used = strlen(count->missing);
    count->all++;
    if (setting_is_given(row, of))
        count->given++;
    else
        snprintf(count->missing + used, sizeof count->missing - used, "%s%s", used ? ", " : "",
                 row->key);
}

static key_count count_below(const char *prefix, const scene *of) {
    key_count count = {0};
    for (const setting *row = scene_settings; row->key; row++)
        if (strncmp(row->key, prefix, strlen(prefix)) == 0) count_key(&count, row, of);
    return count;
}

static place place_of_key(const scene_source *source, const char *key) {
    const place known = source->places[setting_index(setting_find(key))];
    return known.file ? known : (place){source->file, 0};
}

static place place_of_file(const scene_source *source) {
    return (place){source->file, 0};
}

static ehd_status check_whole(const scene_source *source, const char *name, const key_count *count,
                              ehd_error *error) {
    if (count->given == 0 || count->given == count->all) return EHD_OK;
    return place_fail(error, place_of_file(source),
                      "%s: found %zu of its %zu keys, expected also %s", name, count->given,
                      count->all, count->missing);
}

static ehd_status check_operating_point(const scene_source *source, ehd_error *error) {
    const key_count moes = count_below("moes.", &source->values);
    const key_count physical = count_below("physical.", &source->values);
    const place where = place_of_file(source);
    if (moes.given == 0 && physical.given == 0)
        return place_fail(error, where, "moes: found neither moes nor physical, expected one");
    if (moes.given > 0 && physical.given > 0)
        return place_fail(error, where, "moes: found moes and physical, expected only one");
    const ehd_status status = check_whole(source, "moes", &moes, error);
    return status ? status : check_whole(source, "physical", &physical, error);
}

// ---- conditions

/* Whether two keys are needed for the same reason. */
static bool same_reason(const setting *left, const setting *right) {
    const char *a = left->when[0].key, *b = right->when[0].key;
    return a && b ? strcmp(a, b) == 0 : a == b;
}

static bool is_missing(const setting *row, const scene *of) {
    return row->required && !setting_is_given(row, of) && !setting_unmet(row, of);
}

/* Everything that is required always, or by regime, closure and laws as they are. */
static ehd_status check_needed(const scene_source *source, ehd_error *error) {
    const scene *of = &source->values;
    const setting *first = scene_settings;
    char shown[SHOWN_TEXT];
    key_count count = {0};
    while (first->key && !is_missing(first, of))
        first++;
    if (!first->key) return EHD_OK;
    for (const setting *row = first; row->key; row++)
        if (is_missing(row, of) && same_reason(row, first)) count_key(&count, row, of);
    if (!first->when[0].key)
        return place_fail(error, place_of_file(source), "%s: found nothing, expected a value",
                          count.missing);
    setting_show_condition(shown, &first->when[0], of);
    return place_fail(error, place_of_key(source, first->when[0].key),
                      "%s: found nothing, expected a value with the %s", count.missing, shown);
}

/* No setting that would be ignored. Where nothing decides whether it is, check_needed says so. */
static ehd_status check_used(const scene_source *source, ehd_error *error) {
    const scene *of = &source->values;
    char shown[SHOWN_TEXT];
    for (const setting *row = scene_settings; row->key; row++) {
        if (!setting_is_given(row, of)) continue;
        const setting_condition *unmet = setting_unmet(row, of);
        if (!unmet || !setting_is_given(setting_find(unmet->key), of)) continue;
        setting_show_condition(shown, unmet, of);
        return place_fail(error, place_of_key(source, row->key),
                          "%s: found a value, expected none with the %s", row->key, shown);
    }
    return EHD_OK;
}

// ---- lubricant

static bool is_wlf_constant(const setting *row) {
    return row->offset >= offsetof(scene, lubricant.wlf) &&
           row->offset < offsetof(scene, lubricant.wlf) + sizeof(((scene *)0)->lubricant.wlf);
}

/* The law wlf needs a preset or all constants. */
static ehd_status check_wlf(const scene_source *source, ehd_error *error) {
    const bool preset = *source->values.lubricant.viscosity_preset != '\0';
    const place where = place_of_key(source, "lubricant.viscosity.law");
    key_count count = {0};
    if (strcmp(source->values.lubricant.viscosity_law, "wlf") != 0) return EHD_OK;
    for (const setting *row = scene_settings; row->key; row++)
        if (is_wlf_constant(row)) count_key(&count, row, &source->values);
    if (preset && count.given > 0)
        return place_fail(error, where,
                          "lubricant.viscosity: found preset and constants, expected only one");
    if (!preset && count.given == 0)
        return place_fail(error, where,
                          "lubricant.viscosity: found neither preset nor constants, expected "
                          "preset or A1, A2, B1, B2, C1, C2, Tg0, mu_g with the law wlf");
    return preset ? EHD_OK : check_whole(source, "lubricant.viscosity", &count, error);
}

// ---- grid

static bool is_point(const scene *of) {
    return strcmp(of->contact, "point") == 0;
}

/* The allowed step nearest to the given one, with which a whole number of steps fits. */
static double nearest_step(double extent, double step) {
    const setting *row = setting_find("grid.step");
    double count = round(extent / step);
    if (extent / count > row->most) count++;
    return extent / count;
}

static ehd_status check_extent(const scene_source *source, ehd_error *error) {
    const scene *of = &source->values;
    if (!(of->x_min < -1))
        return place_fail(error, place_of_key(source, "grid.x_min"),
                          "grid.x_min: found %g, expected less than -1, so that the dry contact "
                          "lies inside",
                          of->x_min);
    if (!(of->x_max > 1))
        return place_fail(error, place_of_key(source, "grid.x_max"),
                          "grid.x_max: found %g, expected more than 1, so that the dry contact "
                          "lies inside",
                          of->x_max);
    if (is_point(of) && !(of->y_max > 1))
        return place_fail(error, place_of_key(source, "grid.y_max"),
                          "grid.y_max: found %g, expected more than 1, so that the dry contact "
                          "lies inside",
                          of->y_max);
    return EHD_OK;
}

static bool is_whole(double steps) {
    return fabs(steps - round(steps)) <= whole_number_tolerance * steps;
}

/* Lines of nodes that are solved for. */
static double count_lines(const scene *of) {
    const double beside = of->y_max / scene_step(of);
    return !is_point(of) ? 1 : of->half ? beside + 1 : 2 * beside + 1;
}

static ehd_status check_grid(const scene_source *source, ehd_error *error) {
    const scene *of = &source->values;
    const double step = scene_step(of), extent = of->x_max - of->x_min, steps = extent / step;
    const double nodes = (steps + 1) * count_lines(of);
    char found[NUMBER_TEXT], valid[NUMBER_TEXT];
    const ehd_status status = check_extent(source, error);
    if (status) return status;
    if (!(nodes <= max_nodes))
        return place_fail(error, place_of_key(source, "grid.step"),
                          "grid.step: found %g, which makes %.0f nodes, expected at most %.0f",
                          step, nodes, max_nodes);
    number_show(found, step);
    if (!is_whole(steps)) {
        number_show(valid, nearest_step(extent, step));
        return place_fail(error, place_of_key(source, "grid.step"),
                          "grid.step: found %s, expected a whole number of steps from %g to %g, "
                          "such as with %s",
                          found, of->x_min, of->x_max, valid);
    }
    if (!is_point(of) || is_whole(of->y_max / step)) return EHD_OK;
    number_show(valid, step * ceil(of->y_max / step));
    return place_fail(error, place_of_key(source, "grid.y_max"),
                      "grid.y_max: found %g, expected a whole number of steps of %s, such as %s",
                      of->y_max, found, valid);
}

// ---- all

ehd_status source_validate(const scene_source *source, ehd_error *error) {
    ehd_status status = check_used(source, error);
    if (!status) status = check_needed(source, error);
    if (!status) status = check_operating_point(source, error);
    if (!status) status = check_wlf(source, error);
    if (!status) status = check_grid(source, error);
    return status;
}

ehd_status scene_validate(const scene *of, const char *where, ehd_error *error) {
    const scene_source source = {.values = *of, .file = where};
    return source_validate(&source, error);
}
