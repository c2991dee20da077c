/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Many scenes in one process: romrun --cases. */
#ifndef EHD_CASES_H
#define EHD_CASES_H

#include "common/output/case_table.h"
#include "romrun/calibrate/accuracy.h"
#include "romrun/online/online.h"

typedef struct cases_task {
    const program *caller; // arguments[0] is the scene
    const char *model;     // path
    part_sizes sizes;
    part_sizes most_accurate; // where a result of `sizes` is not to be trusted; without modes: none
    double accuracy;          // 0: not given
    const accuracy_limits *limits;
    size_t num_jobs; // threads
} cases_task;

/* What the rows came to. */
typedef struct cases_summary {
    size_t num_unsolved, num_untrusted;
    size_t first;   // of the worst status; where there is none, 0
    double seconds; // of all solutions, by the clock
} cases_summary;

/* Solves all cases; rows are the same whatever num_jobs is. A case that does not converge or is not to be trusted
 * is a row with its status. EHD_DATA: a row that is no stationary contact, or not on the model's grid,
 * before any work; and as online_open. */
ehd_status cases_solve(
    // output:
    case_row *rows,                            // [case_list_count]
    const contact_kind **kind, ehd_grid *grid, // of the model
    cases_summary *summary,
    // input:
    const case_list *list, const cases_task *task, ehd_error *error);

#endif
