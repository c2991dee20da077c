/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/training/between.h"

#include "common/algebra/rounding.h"
#include "common/settings/scene_contact.h"
#include "common/settings/settings_table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- distances

/* The stationary points or the trajectories of a set, with coordinates for their distances. */
typedef struct crowd {
    size_t count, width;
    const tree_point *points; // [count]; NULL: trajectories
    double scale[TREE_AXES];  // divisors of the coordinates of points
    double *places;           // [count, width] coordinates of trajectories, each from 0 to 1
    const training_set *set;
} crowd;

static double *number_in(const setting *row, scene *of) {
    return (double *)(void *)((char *)of + row->offset);
}

static double number_of(const setting *row, const scene *of) {
    double value;

    memcpy(&value, (const char *)of + row->offset, sizeof value);
    return value;
}

/* Checks whether two scenes differ only in settings that are numbers and that both scenes give. */
static bool are_alike(const scene *left, const scene *right) {
    for (const setting *row = scene_settings(); row->key; row++) {
        if (setting_compare(row, left, right) == 0) continue;
        if (row->type != SETTING_REAL || !setting_is_given(row, left) ||
            !setting_is_given(row, right))
            return false;
    }
    return true;
}

/* Returns the squared distance between two scenes; infinite if there is no scene half-way. */
static double square(const crowd *self, size_t i, size_t j) {
    double sum = 0;

    if (self->points) {
        const double distance = tree_distance(&self->points[i], &self->points[j], self->scale);
        return distance * distance;
    }
    const trajectory_scene *all = self->set->trajectories;
    if (!are_alike(&all[i].scene, &all[j].scene)) return INFINITY;
    for (size_t c = 0; c < self->width; c++) {
        const double apart = self->places[i * self->width + c] - self->places[j * self->width + c];
        sum += apart * apart;
    }
    return sum;
}

/* Fills a column with the coordinates, from 0 to 1, of all trajectories for one setting. The
 * coordinates are the values relative to the range of the setting. If all values are positive,
 * their logarithms are used. The coordinate is 0 if the setting is not given. */
static void place_column(double *column, size_t width, const setting *row,
                         const training_set *set) {
    double low = INFINITY, high = -INFINITY;

    for (size_t t = 0; t < set->num_trajectories; t++) {
        const scene *here = &set->trajectories[t].scene;
        if (!setting_is_given(row, here)) continue;
        low = fmin(low, number_of(row, here));
        high = fmax(high, number_of(row, here));
    }
    for (size_t t = 0; t < set->num_trajectories; t++) {
        const double value = number_of(row, &set->trajectories[t].scene);
        double *entry = &column[t * width];
        if (isnan(value) || !(high > low))
            *entry = 0;
        else
            *entry = low > 0 ? log(value / low) / log(high / low) : (value - low) / (high - low);
    }
}

static ehd_status crowd_of_trajectories(crowd *self, const training_set *set, ehd_error *error) {
    *self = (crowd){.count = set->num_trajectories, .width = MAX_SETTINGS, .set = set};
    self->places = calloc((self->count + 1) * self->width, sizeof *self->places);
    if (!self->places) return ehd_no_memory(error, "trajectories");
    for (const setting *row = scene_settings(); row->key; row++)
        if (row->type == SETTING_REAL)
            place_column(self->places + setting_index(row), self->width, row, set);
    return EHD_OK;
}

static ehd_status crowd_of_points(crowd *self, const training_set *set, ehd_error *error) {
    tree_point *points = calloc(set->num_points + 1, sizeof *points);

    *self = (crowd){.count = set->num_points, .points = points, .set = set};
    if (!points) return ehd_no_memory(error, "points");
    training_set_places(points, set);
    tree_scale(self->scale, points, set->num_points);
    return EHD_OK;
}

static void crowd_free(crowd *self) {
    free((void *)self->points);
    free(self->places);
}

// ---- scenes in the middle

/* Makes the scene half-way between two scenes. Returns false if there is no such scene, or if its
 * contact is not valid. */
static bool find_middle(scene *middle, const scene *left, const scene *right) {
    ehd_contact contact;

    if (!are_alike(left, right)) return false;
    *middle = *left;
    for (const setting *row = scene_settings(); row->key; row++) {
        if (setting_compare(row, left, right) == 0) continue;
        const double a = number_of(row, left), b = number_of(row, right);
        *number_in(row, middle) = a > 0 && b > 0 ? sqrt(a) * sqrt(b) : 0.5 * (a + b);
    }
    return scene_validate(middle, "", NULL) == EHD_OK &&
           scene_contact(&contact, middle, NULL) == EHD_OK;
}

/* Checks that no third scene sees two scenes at an obtuse angle. The scenes that follow scene i in
 * the plan are checked first, because they mostly lie between the two. */
static bool are_neighbours(const crowd *self, size_t i, size_t j) {
    const double distance = square(self, i, j);

    if (isinf(distance) || distance == 0) return false;
    for (size_t n = 1; n < self->count; n++) {
        const size_t k = (i + n) % self->count;
        if (k != j && square(self, i, k) + square(self, j, k) < distance * (1 - ROUNDING))
            return false;
    }
    return true;
}

/* Checks whether the plan already has a scene. This is possible because both diagonals of a grid
 * cell have the same middle. */
static bool is_known(const plan *between, const plan_point *added) {
    for (size_t i = 0; i < between->num_points; i++) {
        const plan_point *known = &between->points[i];
        const setting *row = scene_settings();
        while (row->key && setting_compare(row, &known->scene, &added->scene) == 0)
            row++;
        if (!row->key && known->group == added->group) return true;
    }
    return false;
}

static size_t number_at(const crowd *self, size_t i) {
    return self->points ? self->set->numbers[i] : self->set->trajectories[i].number;
}

static ehd_status reserve(plan *between, size_t *room, const char *name, ehd_error *error) {
    if (between->num_points < *room) return EHD_OK;
    const size_t more = 2 * *room + 64;
    plan_point *grown = realloc(between->points, more * sizeof *grown);
    if (!grown) return ehd_no_memory(error, name);
    between->points = grown;
    *room = more;
    return EHD_OK;
}

static ehd_status add_middles(plan *between, size_t *room, const plan *of, const crowd *self,
                              const char *name, ehd_error *error) {
    for (size_t i = 0; i < self->count; i++)
        for (size_t j = i + 1; j < self->count; j++) {
            const plan_point *left = &of->points[number_at(self, i)];
            const plan_point *right = &of->points[number_at(self, j)];
            if (!are_neighbours(self, i, j)) continue;
            ehd_status status = reserve(between, room, name, error);
            if (status) return status;
            plan_point *added = &between->points[between->num_points];
            added->group = left->group;
            if (find_middle(&added->scene, &left->scene, &right->scene) &&
                !is_known(between, added))
                between->num_points++;
        }
    return EHD_OK;
}

/* Halves the swing of all histories. Returns false if no history has a swing, as for tables. */
static bool halve_swing(scene *of) {
    bool changed = false;

    for (int i = 0; i < NUM_VARY; i++) {
        history_settings *history = &of->transient.vary[i];
        if (history->amplitude != 0 && !isnan(history->amplitude)) {
            history->amplitude /= 2;
            changed = true;
        }
        if (!isnan(history->from) && !isnan(history->to) && history->from != history->to) {
            history->to = 0.5 * (history->from + history->to);
            changed = true;
        }
    }
    return changed && scene_validate(of, "", NULL) == EHD_OK;
}

/* Adds a scene with half the swing for each trajectory that differs from every other one in more
 * than numbers. */
static ehd_status add_halves(plan *between, size_t *room, const plan *of, const crowd *self,
                             const char *name, ehd_error *error) {
    for (size_t i = 0; i < self->count; i++) {
        const plan_point *point = &of->points[number_at(self, i)];
        size_t others = 0;
        for (size_t j = 0; j < self->count; j++)
            others += j != i && are_alike(&self->set->trajectories[i].scene,
                                          &self->set->trajectories[j].scene);
        ehd_status status = others == 0 ? reserve(between, room, name, error) : EHD_OK;
        if (status) return status;
        if (others > 0) continue;
        plan_point *added = &between->points[between->num_points];
        *added = *point;
        if (halve_swing(&added->scene)) between->num_points++;
    }
    return EHD_OK;
}

ehd_status between_neighbours(plan *between, const plan *of, const training_set *trained,
                              const char *name, ehd_error *error) {
    const size_t bytes = of->num_groups * sizeof *of->where;
    crowd points = {0}, trajectories = {0};
    size_t room = 0;

    *between = (plan){.num_groups = of->num_groups, .where = malloc(bytes + 1)};
    if (!between->where) return ehd_no_memory(error, name);
    memcpy(between->where, of->where, bytes);
    ehd_status status = crowd_of_points(&points, trained, error);
    if (!status) status = crowd_of_trajectories(&trajectories, trained, error);
    if (!status) status = add_middles(between, &room, of, &points, name, error);
    if (!status) status = add_middles(between, &room, of, &trajectories, name, error);
    if (!status) status = add_halves(between, &room, of, &trajectories, name, error);
    if (!status) status = plan_write_text(between, name, error);
    crowd_free(&points);
    crowd_free(&trajectories);
    if (status) plan_free(between);
    return status;
}

// ---- choices

/* Chooses up to `count` scenes that are far from one another. If the scenes are stationary points,
 * not trajectories, more scenes are chosen if necessary, so that each lubricant of each group of
 * the plan has at least one. */
static ehd_status spread(bool *chosen, const crowd *self, size_t count, ehd_error *error) {
    const bool each_kind = self->points != NULL;
    // squared distance to the nearest chosen scene
    double *nearest = malloc((self->count + 1) * sizeof *nearest);
    if (!nearest) return ehd_no_memory(error, "scenes");

    for (size_t i = 0; i < self->count; i++) {
        nearest[i] = INFINITY;
        chosen[i] = false;
    }
    for (size_t n = 0; n < self->count; n++) {
        size_t next = 0;
        for (size_t i = 1; i < self->count; i++)
            if (nearest[i] > nearest[next]) next = i;
        if (nearest[next] == 0 || (n >= count && !(each_kind && isinf(nearest[next])))) break;
        chosen[next] = true;
        for (size_t i = 0; i < self->count; i++)
            nearest[i] = fmin(nearest[i], i == next ? 0 : square(self, i, next));
    }
    free(nearest);
    return EHD_OK;
}

ehd_status between_spread(bool *chosen, const training_set *set, size_t count, ehd_error *error) {
    crowd points = {0};
    ehd_status status = crowd_of_points(&points, set, error);

    if (!status) status = spread(chosen, &points, count, error);
    crowd_free(&points);
    return status;
}

ehd_status between_sweep(bool *chosen, const training_set *set, size_t count, ehd_error *error) {
    size_t *walk = malloc((set->num_points + 1) * sizeof *walk), left = 0;
    ehd_status status = walk ? tree_walk(walk, set->parent, set->num_points, error)
                             : ehd_no_memory(error, "scenes");

    for (size_t i = 0; i < set->num_points && !status; i++)
        if (!chosen[walk[i]]) walk[left++] = walk[i];
    if (count > left) count = left;
    for (size_t i = 0; i < count && !status; i++)
        chosen[walk[(2 * i + 1) * left / (2 * count)]] = true;
    free(walk);
    return status;
}

ehd_status between_spread_trajectories(bool *chosen, const training_set *set, size_t count,
                                       ehd_error *error) {
    crowd trajectories = {0};
    ehd_status status = crowd_of_trajectories(&trajectories, set, error);

    if (!status) status = spread(chosen, &trajectories, count, error);
    crowd_free(&trajectories);
    return status;
}

ehd_status between_keep(plan *of, const bool *keep, const char *name, ehd_error *error) {
    size_t count = 0;

    for (size_t i = 0; i < of->num_points; i++)
        if (keep[i]) of->points[count++] = of->points[i];
    of->num_points = count;
    return plan_write_text(of, name, error);
}
