/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A reduced model in a flat file: with the tables that are otherwise made of it when it is read. */
#ifndef EHD_FLAT_MODEL_H
#define EHD_FLAT_MODEL_H

#include "romrun/model/flat.h"
#include "romrun/model/reduced_model.h"

/* Walks over a model. One that was read has its tables in the flat file, which must outlive it, and is
 * freed by flat_model_free; whatever it refers to by number was checked. */
void flat_model(flat *file, reduced_model *model);
void flat_model_free(reduced_model *model);

#endif
