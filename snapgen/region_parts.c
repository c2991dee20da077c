/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "snapgen/region_parts.h"

#include "common/program/arena.h"
#include "common/program/output_file.h"
#include "common/settings/place.h"

#include <ctype.h>
#include <gsl/gsl_sort.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A part extends beyond a border by this fraction of the width, in ln M, of the narrower of the two
 * parts at the border. Trained ranges are hulls of points and have to cover the border (README.md,
 * Parts of a region). */
static const double REACH = 0.1;

/* A range of ln M. */
typedef struct part {
    double low, high;
} part;

/* Fills places, [num_points], with ln M of the points, ascending. */
static void sort_places(double *places, const parts_request *of) {
    for (size_t i = 0; i < of->num_points; i++)
        places[i] = log(of->set->contacts[of->points ? of->points[i] : i].moes_M);
    gsl_sort(places, 1, of->num_points);
}

static part extent_of(const training_set *set) {
    part all = {INFINITY, -INFINITY};

    for (size_t i = 0; i < set->num_points; i++) {
        all.low = fmin(all.low, log(set->contacts[i].moes_M));
        all.high = fmax(all.high, log(set->contacts[i].moes_M));
    }
    return all;
}

double parts_span(const training_set *set) {
    const part all = extent_of(set);

    return exp(all.high - all.low);
}

static ehd_status too_narrow(const parts_request *of, ehd_error *error) {
    return ehd_fail(error, EHD_DATA,
                    "%s: found points of too few different M, expected %zu parts of them",
                    of->plan_path, of->num_parts);
}

/* Divides the region into parts with equal numbers of points, and extends them to overlap. */
static ehd_status cut(part *parts, const parts_request *of, ehd_error *error) {
    const part all = extent_of(of->set);
    const size_t last = of->num_parts - 1;
    arena memory = {0};
    double *places = arena_array(&memory, of->num_points, sizeof *places);
    double *border = arena_array(&memory, last + 2, sizeof *border);
    ehd_status status = memory.failed ? ehd_no_memory(error, of->plan_path) : EHD_OK;

    if (!status) sort_places(places, of);
    for (size_t k = 0; k <= last + 1 && !status; k++) {
        border[k] = k == 0      ? all.low
                    : k <= last ? places[k * of->num_points / of->num_parts]
                                : all.high;
        if (k > 0 && !(border[k] > border[k - 1])) status = too_narrow(of, error);
    }
    for (size_t k = 0; k <= last && !status; k++) {
        const double width = border[k + 1] - border[k];
        parts[k] = (part){border[k], border[k + 1]};
        if (k > 0) parts[k].low -= REACH * fmin(width, border[k] - border[k - 1]);
        if (k < last) parts[k].high += REACH * fmin(width, border[k + 2] - border[k + 1]);
    }
    arena_free(&memory);
    return status;
}

/* Returns the number of candidates of the whole region, divided by the number in a part. */
static double density_of(const part *range, const training_set *set) {
    size_t count = 0;

    for (size_t i = 0; i < set->num_points; i++) {
        const double here = log(set->contacts[i].moes_M);
        count += here >= range->low && here <= range->high;
    }
    return count > 0 ? (double)set->num_points / (double)count : 1;
}

static void write_quoted(FILE *stream, const char *text) {
    fputc('"', stream);
    for (; *text; text++) {
        if (iscntrl((unsigned char)*text)) { // YAML reads a line break in quotes as a blank
            fprintf(stream, "\\x%02X", (unsigned char)*text);
            continue;
        }
        if (*text == '"' || *text == '\\') fputc('\\', stream);
        fputc(*text, stream);
    }
    fputc('"', stream);
}

static ehd_status create(output_file *file, const parts_request *of, const char *path,
                         ehd_error *error) {
    const char *const inputs[] = {of->plan_path, NULL};
    ehd_status status = output_file_check_inputs(path, inputs, error);

    return status ? status : output_file_create(file, path, of->force, error);
}

static ehd_status write_plan(const parts_request *of, const part *range, bool first, bool last,
                             const char *path, ehd_error *error) {
    char whole[PATH_MAX];
    output_file file;
    ehd_status status = create(&file, of, path, error);

    if (status) return status;
    if (!realpath(of->plan_path, whole)) {
        output_file_drop(&file);
        return ehd_fail(error, EHD_NOINPUT, "%s: found no such file, expected the plan",
                        of->plan_path);
    }
    fputs("part_of: ", file.stream);
    write_quoted(file.stream, whole);
    // the first part has no lower bound of M, and the last part has no upper bound
    fprintf(file.stream, "\nwhere: {moes_M: [%.4g, %.4g]}\ncandidates_times: %.3g\n",
            first ? 0 : exp(range->low), last ? 1e99 : exp(range->high),
            density_of(range, of->set));
    return output_file_finish(&file, error);
}

static ehd_status write_plans(FILE *list, const parts_request *of, const part *parts,
                              const char *list_path, ehd_error *error) {
    char name[64], before[64] = "";
    ehd_status status = EHD_OK;

    for (size_t k = 0; k < of->num_parts && !status; k++) {
        const double low = exp(parts[k].low), high = exp(parts[k].high);
        snprintf(name, sizeof name, "M-%.3g-%.3g.yml", low, high);
        if (strcmp(name, before) == 0) return too_narrow(of, error);
        char *path = path_beside(list_path, name);
        status = path ? write_plan(of, &parts[k], k == 0, k == of->num_parts - 1, path, error)
                      : ehd_no_memory(error, list_path);
        fprintf(list, "%s %.4g %.4g\n", name, low, high);
        free(path);
        strcpy(before, name);
    }
    return status;
}

/* Writes the kind of contact, and the grid of all parts as --set options. */
static void write_grid(FILE *list, const training_set *set) {
    const grid_extent grid = grid_extent_of(&set->grid);

    fprintf(list, "# %s --set grid.x_min=%.12g --set grid.x_max=%.12g --set grid.step=%.12g",
            set->kind->name, grid.x_min, grid.x_max, grid.step);
    if (!isnan(grid.y_max)) fprintf(list, " --set grid.y_max=%.12g", grid.y_max);
    fputc('\n', list);
}

ehd_status parts_write(const parts_request *of, const char *list_path, ehd_error *error) {
    part *parts = malloc(of->num_parts * sizeof *parts);
    output_file list = {0};
    ehd_status status = parts ? cut(parts, of, error) : ehd_no_memory(error, of->plan_path);

    if (!status) status = create(&list, of, list_path, error);
    if (!status) write_grid(list.stream, of->set);
    if (!status) status = write_plans(list.stream, of, parts, list_path, error);
    if (!status)
        status = output_file_finish(&list, error);
    else
        output_file_drop(&list);
    free(parts);
    return status;
}
