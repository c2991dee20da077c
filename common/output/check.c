/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/output/check.h"

#include "common/artefact/artefact.h"

int output_check(program *self) {
    ehd_error error = {""};
    ehd_status status = artefact_check(self->check, &error);

    if (status == EHD_NOINPUT || status == EHD_IO) status = EHD_DATA;
    if (status == EHD_DATA) program_detail(self, "%s", error.text);
    return program_finish(self, status, status == EHD_DATA ? NULL : &error);
}
