/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What --accuracy asks for: sizes of a calibrated model, how far their solutions are converged, and whether one
 * keeps the promise. */
#ifndef EHD_ACCURACY_H
#define EHD_ACCURACY_H

#include "common/output/result.h"
#include "romrun/calibrate/trade.h"

enum { ACCURACY_NOTE = 320 };
typedef struct accuracy_choice {
    ehdrom_sizes fastest;     // that were measured to be good enough
    ehdrom_sizes most;        // the most accurate ones, for scenes that those do not do for
    char note[ACCURACY_NOTE]; // which the fastest are, and why
} accuracy_choice;

/* Chooses the sizes for a relative deviation of the central film. `name`: of the model, for errors. EHD_DATA: not
 * calibrated on scenes of this regime, or to nothing as accurate. */
ehd_status accuracy_choose(
    // output:
    accuracy_choice *choice,
    // input:
    const trade_table *table, double accuracy, bool in_time, const char *name, ehd_error *error);

/* How far a solution is converged of which no more is asked, for ehdrom_solver_set_tolerance. */
double accuracy_tolerance(double accuracy);

/* A calibrated model keeps its promise, or says that it may not: EHD_UNTRUSTED where the result is indicated to
 * deviate by more. */
void accuracy_judge(run_result *result, double accuracy);

#endif
