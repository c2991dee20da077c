/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Describes a scene without solving it, for --describe. Called by output_main. */
#ifndef EHD_DESCRIBE_H
#define EHD_DESCRIBE_H

#include "common/program/program.h"
#include "common/program/status.h"

/* Prints the quantities that follow from the scene caller->describe with the caller's overrides,
 * and a line if a quantity is not plausible. Returns the errors of scene_read and
 * contact_init. Returns EHD_DATA for an impossible quantity. */
ehd_status scene_describe(const program *caller, ehd_error *error);

#endif
