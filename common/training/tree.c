/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/training/tree.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

// ---- minimum spanning trees

void tree_scale(double scale[TREE_AXES], const tree_point *points, size_t num_points) {
    for (int axis = 0; axis < TREE_AXES; axis++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t i = 0; i < num_points; i++) {
            low = fmin(low, points[i].place[axis]);
            high = fmax(high, points[i].place[axis]);
        }
        scale[axis] = high > low ? high - low : 1;
    }
}

double tree_distance(const tree_point *left, const tree_point *right,
                     const double scale[TREE_AXES]) {
    if (left->family != right->family) return INFINITY;
    double distance = 0;
    for (int axis = 0; axis < TREE_AXES; axis++)
        distance = hypot(distance, (left->place[axis] - right->place[axis]) / scale[axis]);
    return distance;
}

/* Returns the point that is added to the trees next: of all points that are not added yet, the
 * point nearest to the tree of its family. If no such tree has points left, returns the point whose
 * cold start takes the least effort; this point becomes the root of a new tree. */
static size_t next_point(const tree_point *points, size_t num_points, const bool *added,
                         const double *nearest) {
    size_t best = NO_PARENT;

    for (size_t i = 0; i < num_points; i++) {
        if (added[i]) continue;
        if (best == NO_PARENT || nearest[i] < nearest[best] ||
            (isinf(nearest[i]) && isinf(nearest[best]) && points[i].effort < points[best].effort))
            best = i;
    }
    return best;
}

ehd_status tree_build(size_t *parent, const tree_point *points, size_t num_points,
                      ehd_error *error) {
    double *nearest = malloc(num_points * sizeof *nearest); // distance to the tree of its family
    bool *added = calloc(num_points, sizeof *added);
    double scale[TREE_AXES];
    ehd_status status = nearest && added ? EHD_OK : ehd_no_memory(error, "order");

    tree_scale(scale, points, num_points);
    for (size_t i = 0; i < num_points && !status; i++) {
        parent[i] = NO_PARENT;
        nearest[i] = INFINITY;
    }
    for (size_t step = 0; step < num_points && !status; step++) {
        size_t here = next_point(points, num_points, added, nearest);
        added[here] = true;
        for (size_t i = 0; i < num_points; i++) {
            double away = tree_distance(&points[here], &points[i], scale);
            if (added[i] || !(away < nearest[i])) continue;
            nearest[i] = away;
            parent[i] = here;
        }
    }
    free(nearest);
    free(added);
    return status;
}

// ---- orders

typedef struct ranked {
    size_t point;
    size_t rank;
} ranked;

/* Compares for qsort: larger ranks come first, and equal ranks are in the order of the points. */
static int compare_ranked(const void *left, const void *right) {
    const ranked *a = left, *b = right;

    if (a->rank != b->rank) return a->rank < b->rank ? 1 : -1;
    return (a->point > b->point) - (a->point < b->point);
}

ehd_status tree_order(size_t *order, const size_t *parent, size_t num_points, ehd_error *error) {
    // `rank` is the number of points on the longest way down from a point
    ranked *heights = calloc(num_points, sizeof *heights);
    if (!heights) return ehd_no_memory(error, "order");

    for (size_t i = 0; i < num_points; i++)
        heights[i] = (ranked){i, 1};
    for (size_t i = 0; i < num_points; i++) {
        size_t height = 1;
        for (size_t k = i; parent[k] != NO_PARENT && heights[parent[k]].rank <= height; height++) {
            k = parent[k];
            heights[k].rank = height + 1;
        }
    }
    qsort(heights, num_points, sizeof *heights, compare_ranked);
    for (size_t i = 0; i < num_points; i++)
        order[i] = heights[i].point;
    free(heights);
    return EHD_OK;
}

ehd_status tree_walk(size_t *walk, const size_t *parent, size_t num_points, ehd_error *error) {
    size_t *first = malloc(num_points * sizeof *first);     // first child of each point
    size_t *sibling = malloc(num_points * sizeof *sibling); // next child of the same parent
    size_t root = NO_PARENT, length = 0;
    ehd_status status = first && sibling ? EHD_OK : ehd_no_memory(error, "order");
    if (status) goto done;

    for (size_t i = 0; i < num_points; i++)
        first[i] = NO_PARENT;
    for (size_t i = num_points; i-- > 0;) { // backwards, so that each list is ascending
        size_t *list = parent[i] == NO_PARENT ? &root : &first[parent[i]];
        sibling[i] = *list;
        *list = i;
    }
    for (size_t here = root; here != NO_PARENT;) {
        walk[length++] = here;
        if (first[here] != NO_PARENT) {
            here = first[here];
            continue;
        }
        while (here != NO_PARENT && sibling[here] == NO_PARENT)
            here = parent[here];
        if (here != NO_PARENT) here = sibling[here];
    }
done:
    free(first);
    free(sibling);
    return status;
}
