/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Models that are not quite what was stored, for benches. */
#ifndef EHD_VARIANT_H
#define EHD_VARIANT_H

#include "romrun/model/reduced_model.h"

/* Makes a coupled model another one:
 *     stored            nothing is done
 *     without-D         the rows without the weight D
 *     single            all tables rounded to single precision
 *     dependent=EPS     the last mode is EPS times itself and the one before it: the same space for any
 *                       EPS above zero; one dimension less at zero
 * `path`: the model's file. Ends the program on any other name. */
void variant_make(reduced_model *model, const char *name, const char *path);

#endif
