/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes plans for the parts of a region that is too wide for one model (README.md, Parts of a
 * region; schemas/plan.md, part_of).
 * Called by adaptive.c for --parts, and by main.c for --num-parts. */
#ifndef EHD_REGION_PARTS_H
#define EHD_REGION_PARTS_H

#include "common/program/program.h"
#include "common/training/training_set.h"

typedef struct parts_request {
    const char *plan_path;
    const training_set *set; // points of the plan
    // [num_points] numbers in the set; each part gets equally many of them; NULL: all points
    const size_t *points;
    size_t num_points;
    size_t num_parts;
    bool force; // replaces existing files, never the plan
} parts_request;

/* Divides the region into parts, which are overlapping ranges of M. Writes a plan for each part
 * into the folder of `list_path`. Also writes the list of the parts, which has
 * - a line "# KIND --set grid.x_min=… …" with a grid that suits all parts,
 * - a line "PLAN.yml LOWEST HIGHEST" for each part, with its lowest and highest M.
 *
 * A part has as many candidates as the plan. Errors: EHD_DATA: fewer different M, to three
 * digits, than parts; EHD_CANTCREATE, EHD_IO, EHD_MEMORY. */
ehd_status parts_write(const parts_request *of, const char *list_path, ehd_error *error);

/* Returns the ratio of the highest to the lowest M of a set. */
double parts_span(const training_set *set);

#endif
