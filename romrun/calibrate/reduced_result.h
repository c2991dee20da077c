/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A reduced solution as a result, and whether it is to be trusted. */
#ifndef EHD_REDUCED_RESULT_H
#define EHD_REDUCED_RESULT_H

#include "common/output/result.h"
#include "romrun/calibrate/accuracy.h"
#include "romrun/online/online.h"

/* Without fields, exits and other indications. */
run_result reduced_result(const online_result *solution);

/* Sets EHD_UNTRUSTED where the films are indicated to be off by more than the accuracy (0: not given),
 * the model was never checked (`unchecked`, of online_unchecked; NULL: it was), or another quantity is
 * beyond its limit. */
void reduced_result_judge(run_result *result, const char *unchecked, double accuracy,
                          const accuracy_limits *limits);

#endif
