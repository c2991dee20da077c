/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes and reads a reduced model in a flat file, with the tables that are otherwise computed
 * when a model is read (schemas/flat-model.md).
 * Called by romrun/online/part.c. */
#ifndef EHD_FLAT_MODEL_H
#define EHD_FLAT_MODEL_H

#include "romrun/model/flat.h"
#include "romrun/model/reduced_model.h"

/* Writes or reads a model, and checks all indices that it reads. The arrays of a model that was
 * read lie in the flat file, so the file must outlive the model. */
void flat_model(flat *file, reduced_model *model);

#endif
