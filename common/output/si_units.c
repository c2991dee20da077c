/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/output/si_units.h"

#include "common/program/arena.h"

#include <stdlib.h>
#include <string.h>

/* Finds the units of a name in the schema. Returns the scale to SI units, or NULL. */
static const artefact_scale *look_up(const char **units, const artefact *file, const char *name) {
    const artefact_schema *kind = artefact_kind(file);
    const artefact_axis *axis = entry_find(kind->axes, sizeof *axis, name);
    const artefact_field *found = artefact_find(kind->fields, name);

    if (!found) found = artefact_find(kind->attributes, name);
    *units = found ? found->units : axis ? axis->units : "";
    return found ? found->scale : axis ? axis->scale : NULL;
}

const char *si_units_plain(const artefact *file, const char *name) {
    const char *units;

    look_up(&units, file, name);
    return units;
}

ehd_status si_units_check(const artefact *file, ehd_error *error) {
    const artefact_schema *kind = artefact_kind(file);

    for (const artefact_field *field = kind->fields; field->name; field++)
        if (field->scale) return EHD_OK;
    return ehd_fail(error, EHD_DATA,
                    "%s: found %s, expected a kind of file that has SI units: %s or %s",
                    artefact_path(file), kind->name, schema_result.name, schema_cases.name);
}

static ehd_status read_frame(si_units *self, artefact *file, const char *name, const char *frame,
                             ehd_error *error) {
    const artefact_field *field = artefact_find(artefact_kind(file)->fields, frame);

    if (!artefact_has(file, frame))
        return ehd_fail(
            error, EHD_DATA,
            "%s: %s: found no %s, expected it for SI units, as of a contact that is given in them",
            artefact_path(file), name, frame);
    self->frame_axis = field->axes[0];
    self->num_frames = artefact_length(file, field->axes[0]);
    self->frame = array_new(self->num_frames, 1, sizeof *self->frame);
    if (!self->frame) return ehd_no_memory(error, artefact_path(file));
    return artefact_get_part(file, frame, 0, self->num_frames, self->frame, self->num_frames,
                             error);
}

ehd_status si_units_read(si_units *self, artefact *file, const char *name, bool frames,
                         ehd_error *error) {
    *self = (si_units){.factor = 1};
    const artefact_scale *scale = look_up(&self->units, file, name);
    if (!scale) return EHD_OK;
    ehd_status status = artefact_get_scale(&self->factor, &self->units, file, scale, error);
    if (!status && frames && scale->frame)
        status = read_frame(self, file, name, scale->frame, error);
    return status;
}

double si_units_at(const si_units *self, size_t place) {
    return self->frame ? self->factor * self->frame[place] : self->factor;
}

void si_units_free(si_units *self) {
    free(self->frame);
    self->frame = NULL;
}
