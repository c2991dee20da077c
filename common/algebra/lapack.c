/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/algebra/lapack.h"

#include <lapacke.h>

ehd_status lapack_outcome(const char *routine, int info, ehd_error *error) {
    if (info == 0) return EHD_OK;
    if (info == LAPACK_WORK_MEMORY_ERROR || info == LAPACK_TRANSPOSE_MEMORY_ERROR)
        return ehd_no_memory(error, routine);
    return ehd_fail(error, EHD_INTERNAL, "%s: found info = %d, expected 0", routine, info);
}
