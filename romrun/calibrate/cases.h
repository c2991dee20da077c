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
    size_t num_jobs;           // threads
    const char *settings_text; // of the table, as are the inputs (NULL at the end)
    const char *const *inputs;
    bool resume; // what an interrupted run left, where there is such
} cases_task;

/* What the rows came to. */
typedef struct cases_summary {
    size_t num_cases, num_unsolved, num_untrusted;
    size_t first;      // line of the first case with the worst status; 0: all are good
    size_t num_solved; // by this run
    double seconds;    // of these, by the clock
} cases_summary;

/* Solves all cases, some at a time, and writes their table (case_table.h); rows are the same whatever num_jobs is, and memory
 * however many they are. A case that does not converge or is not to be trusted is a row with its status. EHD_DATA: a row that
 * is no stationary contact, or not on the model's grid, before any work; EHD_INTERRUPTED: what is solved is written, and
 * another run with `resume` goes on; and as online_open. */
ehd_status cases_solve(
    // output:
    cases_summary *summary,
    // input:
    case_list *list, const cases_task *task, ehd_error *error);

#endif
