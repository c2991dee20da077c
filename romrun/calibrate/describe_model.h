/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Describes a model for people: range, sizes, errors, cost. Called by romrun --describe. */
#ifndef EHD_DESCRIBE_MODEL_H
#define EHD_DESCRIBE_MODEL_H

#include "common/program/status.h"

/* Prints a description of a model: an HDF5 file, a flat file or a list of models. Only an HDF5 file
 * has the range of the check scenes and the errors. Errors: see online_open and artefact_open. */
ehd_status model_describe(const char *path, ehd_error *error);

#endif
