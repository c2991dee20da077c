/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/output/check.h"

#include "common/artefact/artefact.h"

int output_check(program *self) {
    ehd_error error = {""};
    ehd_status status = artefact_check(self->check, &error);

    if (status == EHD_NOINPUT || status == EHD_IO) status = EHD_DATA;
    return program_finish(self, status, &error);
}
