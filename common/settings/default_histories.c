/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/settings/default_histories.h"

#include "common/program/text.h"

#include <stdint.h>
#include <stdio.h>
#include <string.h>

// Time T at which each trajectory ends. The fluid passes the contact in two units of T
// (schemas/plan.md, Histories).
static const double END = 2.5;

static const char *const kind_names[] = {"sine", "ramp", "step"};
enum { SINE, RAMP, STEP, NUM_KINDS };
enum { MOST_VARYING = 2 };

/* How one quantity varies between its bounds. `first` and `second` are the period and the phase of
 * a sine, or the start and the duration of a ramp. For a step, `first` is its time. */
typedef struct shape {
    int kind;
    bool down; // from the upper bound to the lower one
    double first, second;
} shape;

/* The history of the one quantity, or of each of the two quantities, that a trajectory varies. */
typedef struct trajectory_shape {
    size_t num_varying;
    shape of[MOST_VARYING];
} trajectory_shape;

/* The trajectories of each quantity and of each pair of quantities. schemas/plan.md, Histories, has
 * the errors that were measured with these trajectories. */
static const trajectory_shape shapes[] = {
    {1, {{SINE, false, 0.8, 0}}},
    {1, {{SINE, false, 1.4, 1.6}}},
    {1, {{RAMP, false, 0.2, 0.3}}},
    {1, {{RAMP, true, 0.2, 0.3}}},
    {1, {{STEP, false, 0.3, 0}}},
    {1, {{STEP, true, 0.3, 0}}},
    {2, {{SINE, false, 1.1, 0}, {SINE, false, 1.7, 0}}},
    {2, {{SINE, false, 1.9, 3}, {SINE, false, 1.2, 0}}},
    {2, {{RAMP, false, 0.2, 0.5}, {RAMP, true, 0.6, 0.5}}},
    {2, {{RAMP, true, 0.2, 0.5}, {RAMP, false, 0.6, 0.5}}},
    {2, {{RAMP, false, 0.6, 0.5}, {RAMP, false, 0.2, 0.5}}},
    {2, {{RAMP, true, 0.6, 0.5}, {RAMP, true, 0.2, 0.5}}},
    {2, {{STEP, false, 0.7, 0}, {STEP, true, 0.2, 0}}},
    {2, {{STEP, true, 0.2, 0}, {STEP, true, 0.7, 0}}},
    {2, {{STEP, true, 0.7, 0}, {STEP, false, 0.2, 0}}},
};
enum { NUM_SHAPES = sizeof shapes / sizeof *shapes };

// ---- reading

static ehd_status read_bounds(default_histories *self, const tree_node *node, const char *path,
                              ehd_error *error) {
    const place where = {path, node->line};
    const bool pair = node->kind == TREE_LIST && node->num_children == 2;
    const size_t i = self->num_quantities++;
    char shown[SHOWN_TEXT];

    for (int q = 0; q < VARY_APPROACH; q++)
        if (strcmp(node->key, vary_names[q]) == 0) self->quantity[i] = q;
    for (size_t k = 0; k < i; k++)
        if (self->quantity[k] == self->quantity[i]) self->quantity[i] = -1;
    text_show(shown, node->key);
    if (self->quantity[i] < 0)
        return place_fail(
            error, where,
            "histories: found %s, expected load, speed, radius, modulus, each once, or "
            "kinds",
            shown);
    if (!pair || node->first->kind != TREE_SCALAR || node->last->kind != TREE_SCALAR ||
        !number_read(&self->low[i], node->first->value) ||
        !number_read(&self->high[i], node->last->value) || !(self->low[i] > 0) ||
        !(self->high[i] > self->low[i]))
        return place_fail(error, where,
                          "%s: found something else, expected factors [lowest, highest] above 0",
                          shown);
    return EHD_OK;
}

static ehd_status read_kinds(default_histories *self, const tree_node *list, const char *path,
                             ehd_error *error) {
    char shown[SHOWN_TEXT];

    self->chosen = true;
    for (const tree_node *node = list->first; node; node = node->next) {
        int kind = 0;
        const char *found = tree_show(shown, node);
        while (kind < NUM_KINDS && strcmp(found, kind_names[kind]) != 0)
            kind++;
        if (kind == NUM_KINDS)
            return place_fail(error, (place){path, node->line},
                              "kinds: found %s, expected sine, ramp or step", found);
        self->kinds[kind] = true;
    }
    if (list->kind == TREE_LIST && list->num_children > 0) return EHD_OK;
    return place_fail(error, (place){path, list->line},
                      "kinds: found no list, expected one such as [sine, ramp, step]");
}

ehd_status default_histories_read(default_histories *self, const tree_node *node, const char *path,
                                  ehd_error *error) {
    ehd_status status = EHD_OK;

    *self = (default_histories){.quantity = {-1, -1, -1, -1, -1}, .where = {path, node->line}};
    for (const tree_node *child = node->first; child && node->kind == TREE_MAP && !status;
         child = child->next) {
        if (strcmp(child->key, "kinds") == 0)
            status = read_kinds(self, child, path, error);
        else
            status = read_bounds(self, child, path, error);
    }
    if (!status && self->num_quantities == 0)
        status =
            place_fail(error, self->where,
                       "histories: found no quantity, expected a map such as {load: [0.9, 1.1]}");
    return status;
}

// ---- the trajectories

/* One trajectory: its shape, and the indices of its quantities in default_histories. */
typedef struct choice {
    const trajectory_shape *shape;
    size_t quantity[MOST_VARYING];
} choice;

static bool is_wanted(const default_histories *self, const choice *of) {
    bool wanted = true, of_speed = of->shape->num_varying == 1;

    for (size_t i = 0; i < of->shape->num_varying; i++) {
        const int kind = of->shape->of[i].kind;
        of_speed = of_speed && self->quantity[of->quantity[i]] == VARY_SPEED;
        wanted = wanted && (self->chosen ? self->kinds[kind] : kind != STEP || of_speed);
    }
    return wanted;
}

/* Finds trajectory `number`. The trajectories of one quantity are consecutive. The trajectories of
 * one pair of quantities are consecutive, too. Returns number + 1, or the number of all
 * trajectories if that is less. */
static size_t choose(choice *chosen, const default_histories *self, size_t number) {
    const size_t num = self->num_quantities;
    size_t count = 0;

    for (size_t a = 0; a < num; a++)
        for (size_t b = 0; b < num; b++)
            for (size_t s = 0; s < NUM_SHAPES; s++) {
                const bool pair = shapes[s].num_varying == 2;
                *chosen = (choice){&shapes[s], {a, b}};
                if ((pair ? b <= a : b != a) || !is_wanted(self, chosen)) continue;
                if (count++ == number) return count;
            }
    return count;
}

size_t default_histories_count(const default_histories *self) {
    choice chosen = {shapes, {0, 0}};

    return choose(&chosen, self, SIZE_MAX);
}

void default_histories_show(const default_histories *self, size_t number, char *shown,
                            size_t size) {
    choice chosen = {shapes, {0, 0}};
    size_t used = 0;

    choose(&chosen, self, number);
    *shown = '\0';
    for (size_t i = 0; i < chosen.shape->num_varying && used < size; i++)
        used += (size_t)snprintf(shown + used, size - used, "%s%s %s", i ? ", " : "",
                                 vary_names[self->quantity[chosen.quantity[i]]],
                                 kind_names[chosen.shape->of[i].kind]);
}

// ---- applying

static ehd_status assign(scene_source *source, const char *key, const char *text, place where,
                         ehd_error *error) {
    const setting *row = setting_find(key);

    source->places[setting_index(row)] = where;
    return source_assign(source, row, text, where.file, where, error);
}

static ehd_status assign_number(scene_source *source, const char *quantity, const char *name,
                                double value, place where, ehd_error *error) {
    char key[SHOWN_TEXT], text[NUMBER_TEXT];

    snprintf(key, sizeof key, "transient.%s.%s", quantity, name);
    number_show(text, value);
    return assign(source, key, text, where, error);
}

/* Removes all histories from a scene. Returns EHD_DATA if an override gives a history. */
static ehd_status clear(scene_source *source, place where, ehd_error *error) {
    scene none;

    scene_defaults(&none);
    memcpy(source->values.transient.vary, none.transient.vary, sizeof none.transient.vary);
    for (const setting *row = scene_settings(); row->key; row++) {
        if (setting_quantity(row) < 0) continue;
        if (source_is_overridden(source, row))
            return place_fail(error, (place){"--set", 0},
                              "%s: found a key that %s varies by histories, expected another one",
                              row->key, where.file);
        source->places[setting_index(row)] = (place){NULL, 0};
    }
    return EHD_OK;
}

static ehd_status apply_shape(scene_source *source, const default_histories *self, size_t i,
                              const shape *of, ehd_error *error) {
    // for each kind of history: the keys to which `first` and `second` of the shape are assigned
    static const char *const names[NUM_KINDS][2] = {
        [SINE] = {"period", "phase"}, [RAMP] = {"start", "duration"}, [STEP] = {"at", NULL}};
    const char *quantity = vary_names[self->quantity[i]];
    const double low = self->low[i], high = self->high[i];
    const bool sine = of->kind == SINE;
    char key[SHOWN_TEXT];

    snprintf(key, sizeof key, "transient.%s.law", quantity);
    ehd_status status = assign(source, key, kind_names[of->kind], self->where, error);
    if (!status)
        status = assign_number(source, quantity, sine ? "mean" : "from",
                               sine       ? 0.5 * (low + high)
                               : of->down ? high
                                          : low,
                               self->where, error);
    if (!status)
        status = assign_number(source, quantity, sine ? "amplitude" : "to",
                               sine       ? 0.5 * (high - low)
                               : of->down ? low
                                          : high,
                               self->where, error);
    for (size_t k = 0; k < 2 && names[of->kind][k] && !status; k++)
        status = assign_number(source, quantity, names[of->kind][k], k ? of->second : of->first,
                               self->where, error);
    return status;
}

ehd_status default_histories_apply(const default_histories *self, size_t number,
                                   scene_source *source, ehd_error *error) {
    const setting *end = setting_find("transient.end_time");
    choice chosen = {shapes, {0, 0}};
    char text[NUMBER_TEXT];
    const char *regime = source->values.regime;
    ehd_status status = clear(source, self->where, error);

    if (!status && *regime && strcmp(regime, "transient") != 0)
        return place_fail(error, self->where, "histories: found the regime %s, expected transient",
                          regime);
    choose(&chosen, self, number);
    for (size_t i = 0; i < MOST_VARYING && i < chosen.shape->num_varying && !status; i++)
        status = apply_shape(source, self, chosen.quantity[i], &chosen.shape->of[i], error);
    number_show(text, END);
    if (!status && !source_is_overridden(source, end))
        status = assign(source, end->key, text, self->where, error);
    return status;
}
