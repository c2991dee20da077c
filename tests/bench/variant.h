/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Modified models for the benchmarks. */
#ifndef EHD_VARIANT_H
#define EHD_VARIANT_H

#include "romrun/model/reduced_model.h"

/* Changes a coupled model:
 *     stored            no change
 *     without-D         rows without the weight D
 *     single            all tables rounded to single precision
 *     dependent=EPS     the last mode is EPS times itself plus the mode before it; the space is the same for any
 *                       EPS above zero and has one dimension less at zero
 * `path` is the file of the model. Ends the program on any other name. */
void variant_make(reduced_model *model, const char *name, const char *path);

#endif
