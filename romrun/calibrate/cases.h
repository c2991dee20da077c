/* SPDX-License-Identifier: GPL-3.0-or-later */
/* romrun cases: solves many scenes in one process (schemas/cases.md).
 * Called by romrun/main.c. */
#ifndef EHD_CASES_H
#define EHD_CASES_H

#include "common/output/case_table.h"
#include "romrun/calibrate/accuracy.h"
#include "romrun/online/online.h"

typedef struct cases_task {
    const program *caller; // arguments[0] is the scene
    const char *model;     // path of the model
    part_sizes sizes;
    part_sizes most_accurate; // sizes for the cases that are not solved well with `sizes`; if the
                              // number of modes is 0, such cases are not solved again
    double accuracy;          // value of --accuracy; 0: --accuracy is not given
    const accuracy_limits *limits;
    size_t num_jobs; // number of threads
    const char *settings_text;
    const char *const *inputs;
    bool resume; // continue an interrupted run, if there is one
} cases_task;

typedef struct cases_summary {
    size_t num_cases, num_unsolved, num_untrusted;
    size_t first;      // line, in the list, of the first case with the worst status; 0: all trusted
    size_t num_solved; // number of cases solved by this run
    double max_friction; // largest friction coefficient of these cases
    double seconds;      // elapsed time of these cases
} cases_summary;

/* Solves all cases and writes their table (case_table.h). The rows do not depend on num_jobs, and
 * the memory does not depend on the number of cases. A case that does not converge or is not
 * trusted gets a row with its status. Errors:
 * - EHD_DATA, before any case is solved: a row is no stationary contact, or has another grid than
 *   the model.
 * - EHD_INTERRUPTED: the solved cases are written, and a run with `resume` continues.
 * - Errors of online_open. */
ehd_status cases_solve(
    // output:
    cases_summary *summary,
    // input:
    case_list *list, const cases_task *task, ehd_error *error);

#endif
