/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A reduced result against another one of the same scene, as romrun --against prints it. */
#ifndef EHD_AGAINST_H
#define EHD_AGAINST_H

#include "common/output/result.h"
#include "common/output/time_result.h"
#include "common/output/time_run.h"

/* Whether a result with these numbers is one of the contact. EHD_DATA: it is not. `path`: its file. */
ehd_status against_check(double moes_M, double alpha_p_H, double hertz_pressure, const char *path,
                         const ehd_contact *contact, ehd_error *error);

/* Prints deviations of scalars and, where both have them, the largest of fields. */
void against_print(const run_result *result, const stored_result *stored, const char *path,
                   const ehd_contact *contact);

/* Prints the largest and mean deviation over time. EHD_DATA: too few times in common; EHD_MEMORY. */
ehd_status against_print_in_time(const time_trace *trace, const time_series *full, const char *path,
                                 ehd_error *error);

#endif
