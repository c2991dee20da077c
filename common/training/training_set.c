/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/training/training_set.h"

#include "common/output/inputs.h"
#include "common/physics/contact_place.h"
#include "common/physics/traction.h"
#include "common/settings/scene_contact.h"
#include "common/time/path_filter.h"
#include "common/time/time_grid.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void training_point_name(char name[POINT_NAME], const ehd_contact *contact) {
    snprintf(name, POINT_NAME, "M=%.6g L=%.6g", contact->moes_M, contact->moes_L);
}

// ---- points

static bool lies_within(const ehd_contact *contact, const plan_where *where) {
    const double values[] = {
        [WHERE_ALPHA_P_H] = contact->alpha_p_H, [WHERE_MOES_M] = contact->moes_M};
    bool within = true;

    for (int w = 0; w < NUM_WHERE; w++)
        within = within && values[w] >= where->bounds[w][0] && values[w] <= where->bounds[w][1];
    return within;
}

/* Makes the contact of a point. `inside` is false if the plan's bounds exclude the point. */
static ehd_status make_contact(ehd_contact *contact, bool *inside, const plan *of, size_t number,
                               const char *plan_path, ehd_error *error) {
    const plan_point *point = &of->points[number];
    char name[POINT_NAME];
    ehd_error cause = {""};
    ehd_status status = scene_contact(contact, &point->scene, &cause);
    if (!status) status = scene_check_reducible(&point->scene, &cause);

    // errors of an excluded point do not matter: the lubricant's law may not hold there
    bool known = contact->alpha_p_H > 0 || !status;
    *inside = !known || lies_within(contact, &of->where[point->group]);
    if (!status || !*inside) return EHD_OK;
    training_point_name(name, contact);
    return ehd_fail(error, status, "%s: point %s: %s", plan_path, name, cause.text);
}

static ehd_status check_grid(const ehd_contact *first, const ehd_contact *other,
                             const char *plan_path, ehd_error *error) {
    const ehd_grid *expected = &first->grid, *found = &other->grid;
    char first_name[POINT_NAME], other_name[POINT_NAME];

    if (grid_same(found, expected)) return EHD_OK;
    training_point_name(first_name, first);
    training_point_name(other_name, other);
    if (found->discretization != expected->discretization)
        return ehd_fail(error, EHD_DATA,
                        "%s: discretization: found %s at point %s, expected %s as at point %s",
                        plan_path, discretization_names[found->discretization], other_name,
                        discretization_names[expected->discretization], first_name);
    if (found->inner_lines > 1 && expected->inner_lines > 1 &&
        found->boundary != expected->boundary)
        return ehd_fail(error, EHD_DATA,
                        "%s: boundary: found %s at point %s, expected %s as at point %s", plan_path,
                        boundary_names[found->boundary], other_name,
                        boundary_names[expected->boundary], first_name);
    return ehd_fail(error, EHD_DATA,
                    "%s: grid: found %zu nodes from %g by %g at point %s, expected %zu from %g by "
                    "%g as at point %s",
                    plan_path, found->num_inner, found->x_min, found->step, other_name,
                    expected->num_inner, expected->x_min, expected->step, first_name);
}

/* Reads the histories of all trajectories and sets the grid that each one needs. Refuses histories
 * that no reduced model can be trained with: a reversing entrainment, or a load of 0. */
static ehd_status read_histories(training_set *set, const char *plan_path, ehd_error *error) {
    ehd_status status = EHD_OK;

    for (size_t t = 0; t < set->num_trajectories && !status; t++) {
        ehd_error cause = {""};
        trajectory_scene *moving = &set->trajectories[t];
        status = histories_init_training(&moving->histories, &moving->scene, &cause);
        if (status)
            ehd_fail(error, status, "%s: %s", plan_path, cause.text);
        else
            moving->needed = time_grid_extent(moving->histories, &moving->contact,
                                              moving->scene.transient.end_time);
    }
    return status;
}

/* Checks that all trajectories have the same transport and, along the path, the same smoothing. */
static ehd_status check_carriages(const training_set *set, const char *plan_path,
                                  ehd_error *error) {
    for (size_t t = 1; t < set->num_trajectories; t++) {
        const ehd_carriage found = path_carriage(&set->trajectories[t].contact);
        const ehd_carriage expected = path_carriage(&set->trajectories[0].contact);
        if (found.transport != expected.transport)
            return ehd_fail(error, EHD_DATA, "%s: transport: found %s and %s, expected one of them",
                            plan_path, transport_names[expected.transport],
                            transport_names[found.transport]);
        if (found.smoothing != expected.smoothing && found.transport == TRANSPORT_PATH)
            return ehd_fail(error, EHD_DATA,
                            "%s: transient.smoothing: found %g and %g, expected one of them",
                            plan_path, expected.smoothing, found.smoothing);
    }
    return EHD_OK;
}

/* Checks that all points have the kind of the first point and, if they are ellipses, its shape. */
static ehd_status check_alike(training_set *set, contact_shape *shape, const ehd_contact *contact,
                              const char *plan_path, ehd_error *error) {
    if (!set->kind) {
        set->kind = contact->kind;
        *shape = contact->grid.shape;
    }
    if (contact->kind != set->kind)
        return ehd_fail(error, EHD_DATA, "%s: contact: found %s and %s, expected one of them",
                        plan_path, set->kind->name, contact->kind->name);
    if (!shape_same(&contact->grid.shape, shape))
        return ehd_fail(error, EHD_DATA,
                        "%s: ellipticity: found %.9g and %.9g, expected one of them, of which a "
                        "reduced model is",
                        plan_path, shape->ellipticity, contact->grid.shape.ellipticity);
    return EHD_OK;
}

static ehd_status make_points(training_set *set, const plan *of, const char *plan_path,
                              ehd_error *error) {
    contact_shape shape = shape_round;
    ehd_status status = EHD_OK;

    for (size_t i = 0; i < of->num_points && !status; i++) {
        const scene *given = &of->points[i].scene;
        ehd_contact contact;
        bool inside;
        status = make_contact(&contact, &inside, of, i, plan_path, error);
        if (status) break;
        if (!inside) {
            set->num_dropped++;
            continue;
        }
        status = check_alike(set, &shape, &contact, plan_path, error);
        if (status) break;
        if (strcmp(given->regime, "transient") == 0) {
            set->trajectories[set->num_trajectories++] =
                (trajectory_scene){.number = i, .scene = *given, .contact = contact};
        } else {
            set->numbers[set->num_points] = i;
            set->groups[set->num_points] = of->points[i].group;
            set->estimated[set->num_points] = given->output.resolution != 0;
            set->contacts[set->num_points++] = contact;
        }
    }
    if (!status && !set->kind)
        status = ehd_fail(error, EHD_DATA,
                          "%s: where: found all %zu points outside of the bounds, expected some "
                          "inside",
                          plan_path, of->num_points);
    return status;
}

static size_t num_contacts(const training_set *set) {
    return set->num_points + set->num_trajectories;
}

static ehd_contact *contact_at(const training_set *set, size_t i) {
    return i < set->num_points ? &set->contacts[i]
                               : &set->trajectories[i - set->num_points].contact;
}

/* Returns the grid extent that contact i needs. For a trajectory, this is the extent that all times
 * of its histories need. */
static grid_extent needed_at(const training_set *set, size_t i) {
    return i < set->num_points ? grid_extent_needed(&set->contacts[i])
                               : set->trajectories[i - set->num_points].needed;
}

/* Puts all contacts whose scenes leave the grid open on a grid that suits all contacts. */
static ehd_status set_common_grid(training_set *set, ehd_error *error) {
    grid_extent needed = needed_at(set, 0);
    ehd_status status = EHD_OK;

    for (size_t i = 1; i < num_contacts(set); i++) {
        const grid_extent other = needed_at(set, i);
        grid_extent_join(&needed, &other);
    }
    for (size_t i = 0; i < num_contacts(set) && !status; i++)
        status = scene_set_grid(contact_at(set, i), &needed, error);
    return status;
}

/* Returns the first contact whose scene leaves the grid open (`open`) or gives all of it (not
 * `open`). NULL: there is none. */
static const ehd_contact *find_contact(const training_set *set, bool open) {
    for (size_t i = 0; i < num_contacts(set); i++)
        if (contact_has_chosen_grid(contact_at(set, i)) == open) return contact_at(set, i);
    return NULL;
}

/* Puts all contacts on one grid: the grid that some scenes give, or else the grid that all contacts
 * need. */
static ehd_status settle_grid(training_set *set, const char *plan_path, ehd_error *error) {
    const ehd_contact *first = contact_at(set, 0), *given = find_contact(set, false);
    ehd_error cause = {""};
    ehd_status status = find_contact(set, true) ? set_common_grid(set, &cause) : EHD_OK;

    if (status) return ehd_fail(error, status, "%s: %s", plan_path, cause.text);
    if (given) training_set_take_grid(set, &given->grid);
    set->grid = first->grid;
    for (size_t i = 0; i < num_contacts(set) && !status; i++)
        status = check_grid(first, contact_at(set, i), plan_path, error);
    for (size_t t = 0; t < set->num_trajectories && !status; t++) {
        const trajectory_scene *moving = &set->trajectories[t];
        status = scene_check_approach(&moving->scene, &moving->contact, &cause);
        if (status) status = ehd_fail(error, status, "%s: %s", plan_path, cause.text);
    }
    return status;
}

// ---- order

static bool same_lubricant(const ehd_lubricant *left, const ehd_lubricant *right) {
    return left->viscosity == right->viscosity && left->density == right->density &&
           memcmp(left->viscosity_constants, right->viscosity_constants,
                  sizeof left->viscosity_constants) == 0 &&
           memcmp(left->density_constants, right->density_constants,
                  sizeof left->density_constants) == 0;
}

/* Returns the number of the first point of the same group with the same lubricant. */
static size_t family_of(const training_set *set, size_t point) {
    size_t first = 0;

    while (set->groups[first] != set->groups[point] ||
           !same_lubricant(&set->contacts[first].lubricant, &set->contacts[point].lubricant))
        first++;
    return first;
}

void training_set_places(tree_point *places, const training_set *set) {
    for (size_t i = 0; i < set->num_points; i++) {
        const ehd_contact *contact = &set->contacts[i];
        double log_M = log(contact->moes_M);
        const double material = contact_moes_L(contact);
        const flow_thinning thinning = traction_thinning(contact);
        places[i] = (tree_point){.family = family_of(set, i),
                                 .place = {log_M, material, thinning_coordinate(thinning.sliding),
                                           gradient_coordinate(thinning.gradient)},
                                 .effort = fabs(log_M - log(12)) + 0.5 * material};
    }
}

/* Builds the tree and the order of the points. branch: [num_points] branch of each point. Points of
 * different branches are never neighbours. */
static ehd_status make_tree(training_set *set, const size_t *branch, const char *plan_path,
                            ehd_error *error) {
    tree_point *points = malloc(set->num_points * sizeof *points);
    if (!points) return ehd_no_memory(error, plan_path);

    training_set_places(points, set);
    for (size_t i = 0; i < set->num_points; i++)
        points[i].family += branch[i] * set->num_points;
    ehd_status status = tree_build(set->parent, points, set->num_points, error);
    if (!status) status = tree_order(set->order, set->parent, set->num_points, error);
    free(points);
    return status;
}

// ---- parts

/* Returns the number of branches of a plan. A branch is a run of successive points. Points start
 * only from neighbours in their own branch, so each branch has at least one cold start. The number
 * of branches is about the square root of the number of points, so that both cold starts and long
 * chains of neighbours are few. The number is a multiple of four, so that four shards (the pieces
 * of a plan that separate jobs solve) have equal numbers of branches. The plan of stationary-line
 * takes 597 Newton iterations with this number of branches, 915 with one branch, and 748 with twice
 * as many branches. */
static size_t count_branches(size_t num_points) {
    size_t count = 4;

    while (count * count < num_points)
        count += 4;
    return count < num_points ? count : num_points;
}

/* Removes the points for which `keep` is false. Leaves the tree as it is. */
static void keep_points(training_set *set, const bool *keep) {
    size_t count = 0;

    for (size_t i = 0; i < set->num_points; i++) {
        if (!keep[i]) continue;
        set->contacts[count] = set->contacts[i];
        set->estimated[count] = set->estimated[i];
        set->numbers[count] = set->numbers[i];
        set->groups[count++] = set->groups[i];
    }
    set->num_points = count;
}

/* Cuts the points into branches, in the order of the plan, and keeps the branches of the shard. The
 * tree is made from all points of the plan, so neither the branches nor the parent of a point
 * depend on the shards. */
static ehd_status keep_branches(training_set *set, const char *plan_path, shard piece,
                                ehd_error *error) {
    const size_t num_points = set->num_points, num_branches = count_branches(num_points);
    size_t begin = num_branches * (piece.number - 1) / piece.total;
    size_t end = num_branches * piece.number / piece.total, before = 0;
    size_t *branch = malloc(num_points * sizeof *branch);
    bool *keep = calloc(num_points, sizeof *keep);
    ehd_status status = branch && keep ? EHD_OK : ehd_no_memory(error, plan_path);

    for (size_t i = 0; i < num_points && !status; i++) {
        branch[i] = i * num_branches / num_points;
        keep[i] = begin <= branch[i] && branch[i] < end;
        before += branch[i] < begin;
    }
    if (!status) status = make_tree(set, branch, plan_path, error);
    if (!status && piece.total > 1) {
        keep_points(set, keep);
        for (size_t i = 0; i < set->num_points; i++) {
            size_t parent = set->parent[before + i];
            set->parent[i] = parent == NO_PARENT ? NO_PARENT : parent - before;
        }
        if (set->num_points > 0)
            status = tree_order(set->order, set->parent, set->num_points, error);
    }
    free(keep);
    free(branch);
    return status;
}

ehd_status training_set_keep(training_set *set, const bool *keep, const char *plan_path,
                             ehd_error *error) {
    const shard whole = {1, 1};

    keep_points(set, keep);
    return set->num_points > 0 ? keep_branches(set, plan_path, whole, error) : EHD_OK;
}

/* Returns how many of the first `first` shards have points. If there are fewer branches than
 * shards, some shards have no points. */
static size_t shards_with_points(size_t first, size_t num_branches, size_t total) {
    size_t branches = num_branches * first / total;

    return branches < first ? branches : first;
}

/* Keeps the trajectories of the shard. Shards without points get trajectories before the other
 * shards, so that no shard is empty. */
static void keep_trajectories(training_set *set, size_t num_branches, shard piece) {
    size_t before = shards_with_points(piece.number - 1, num_branches, piece.total);
    bool has_points = shards_with_points(piece.number, num_branches, piece.total) > before;
    size_t num_without = piece.total - shards_with_points(piece.total, num_branches, piece.total);
    size_t turn = has_points ? num_without + before : piece.number - 1 - before;
    size_t count = 0;

    for (size_t t = 0; t < set->num_trajectories; t++)
        if (t % piece.total == turn)
            set->trajectories[count++] = set->trajectories[t];
        else
            histories_free(set->trajectories[t].histories);
    set->num_trajectories = count;
}

// ---- all

ehd_status training_set_init(training_set *set, const plan *of, const char *plan_path, shard piece,
                             ehd_error *error) {
    *set = (training_set){0};
    set->contacts = calloc(of->num_points, sizeof *set->contacts);
    set->numbers = calloc(of->num_points, sizeof *set->numbers);
    set->groups = calloc(of->num_points, sizeof *set->groups);
    set->estimated = calloc(of->num_points, sizeof *set->estimated);
    set->parent = calloc(of->num_points, sizeof *set->parent);
    set->order = calloc(of->num_points, sizeof *set->order);
    set->trajectories = calloc(of->num_points, sizeof *set->trajectories);
    if (asprintf(&set->text, "%s# shard %zu/%zu\n", of->text, piece.number, piece.total) < 0)
        set->text = NULL;
    ehd_status status = EHD_OK;
    if (!set->contacts || !set->numbers || !set->groups || !set->estimated || !set->parent ||
        !set->order || !set->trajectories || !set->text)
        status = ehd_no_memory(error, plan_path);

    if (!status) status = make_points(set, of, plan_path, error);
    if (!status) status = read_histories(set, plan_path, error);
    if (!status) status = settle_grid(set, plan_path, error);
    if (!status) status = check_carriages(set, plan_path, error);
    size_t num_branches = count_branches(set->num_points);
    size_t most = num_branches + set->num_trajectories;
    if (!status && piece.total > most)
        status = ehd_fail(error, EHD_USAGE,
                          "--shard: found %zu shards, expected at most %zu, the number of branches "
                          "and trajectories in %s",
                          piece.total, most, plan_path);
    if (!status && set->num_points > 0) status = keep_branches(set, plan_path, piece, error);
    if (!status && piece.total > 1) keep_trajectories(set, num_branches, piece);
    if (status) training_set_free(set);
    return status;
}

void training_set_take_grid(training_set *set, const ehd_grid *grid) {
    for (size_t i = 0; i < num_contacts(set); i++)
        contact_take_grid(contact_at(set, i), grid);
    if (num_contacts(set) > 0) set->grid = contact_at(set, 0)->grid;
}

ehd_status training_set_add_text(training_set *set, const char *line, const char *plan_path,
                                 ehd_error *error) {
    char *text;

    if (asprintf(&text, "%s# %s\n", set->text, line) < 0) return ehd_no_memory(error, plan_path);
    free(set->text);
    set->text = text;
    return EHD_OK;
}

ehd_status training_set_make_cold(training_set *set, const char *plan_path, ehd_error *error) {
    for (size_t i = 0; i < set->num_points; i++)
        set->parent[i] = NO_PARENT;
    return training_set_add_text(set, "cold", plan_path, error);
}

ehd_status training_check_outcome(const training_set *set, size_t num_failed, const char *plan_path,
                                  ehd_error *error) {
    size_t num_all = set->num_points + set->num_trajectories;

    if (num_failed < num_all) return EHD_OK;
    return ehd_fail(error, EHD_NOT_CONVERGED,
                    "%s: found none of %zu points converged, expected at least one", plan_path,
                    num_all);
}

const char **training_inputs(const training_set *set, const char *plan_path,
                             const char *basis_path) {
    const char **paths = malloc((3 + MAX_TABLES * set->num_trajectories) * sizeof *paths);
    if (!paths) return NULL;

    size_t count = inputs_add(paths, 0, plan_path);
    count = inputs_add(paths, count, basis_path);
    for (size_t t = 0; t < set->num_trajectories; t++)
        count = inputs_add_tables(paths, count, &set->trajectories[t].scene);
    paths[count] = NULL;
    return paths;
}

void training_set_free(training_set *set) {
    for (size_t t = 0; t < set->num_trajectories; t++)
        histories_free(set->trajectories[t].histories);
    free(set->text);
    free(set->contacts);
    free(set->numbers);
    free(set->groups);
    free(set->estimated);
    free(set->parent);
    free(set->order);
    free(set->trajectories);
    *set = (training_set){0};
}
