/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Copies an artefact into another of the same kind. */
#include "common/artefact/internal.h"

#include <stdlib.h>
#include <string.h>

static ehd_status copy_attribute(artefact *to, artefact *from, const artefact_field *attribute,
                                 ehd_error *error) {
    const char *name = attribute->name;
    any_number number;
    char *text = NULL;
    ehd_status status;

    if (attribute->type != ARTEFACT_TEXT) {
        status = get_number(from, name, attribute->type, &number, error);
        return status ? status : put_attribute(to, name, attribute->type, &number, error);
    }
    status = artefact_get_text(from, name, &text, error);
    if (!status) status = artefact_put_text(to, name, text, error);
    free(text);
    return status;
}

/* Copies an axis. Values 0, 1, 2, … are written as an integer index. */
static ehd_status copy_axis(artefact *to, artefact *from, const char *name, size_t length,
                            ehd_error *error) {
    double *values = array_new(length, 1, sizeof *values);
    bool scale = artefact_has_scale(from, name), index = true;
    ehd_status status = values ? EHD_OK : ehd_no_memory(error, shown_name(to));

    if (!status && scale) status = artefact_get_axis(from, name, values, length, error);
    for (size_t i = 0; i < length && scale && !status; i++)
        index = index && values[i] == (double)i;
    if (!status) status = artefact_put_axis(to, name, length, index ? NULL : values, error);
    free(values);
    return status;
}

static bool is_listed(const char *name, const char *const *names) {
    for (; names && *names; names++)
        if (strcmp(name, *names) == 0) return true;
    return false;
}

static bool has_listed_axis(const artefact_field *field, const char *const *axes) {
    for (size_t i = 0; i < ARTEFACT_MAX_RANK && field->axes[i]; i++)
        if (is_listed(field->axes[i], axes)) return true;
    return false;
}

static ehd_status copy_field(artefact *to, artefact *from, const artefact_field *field,
                             ehd_error *error) {
    const size_t length = num_entries(from, field), each = entry_size(from, field);
    any_number *numbers = array_new(length, each, sizeof *numbers);
    if (!numbers) return ehd_no_memory(error, shown_name(to));

    ehd_status status =
        get_entries(from, field->name, field->type, 0, WHOLE_FIELD, numbers, length * each, error);
    if (!status) status = put_entries(to, field->name, field->type, 0, WHOLE_FIELD, numbers, error);
    free(numbers);
    return status;
}

ehd_status artefact_copy(artefact *to, artefact *from, const char *const *except_axes,
                         ehd_error *error) {
    const artefact_schema *schema = from->schema;
    ehd_status status = EHD_OK;

    to->copied = true;
    for (const artefact_field *entry = schema->attributes; entry->name && !status; entry++)
        if (hdf5_has_attribute(from->id, entry->name))
            status = copy_attribute(to, from, entry, error);
    for (const artefact_axis *axis = schema->axes; axis->name && !status; axis++) {
        size_t length = artefact_length(from, axis->name);
        if (length > 0 && !is_listed(axis->name, except_axes))
            status = copy_axis(to, from, axis->name, length, error);
    }
    for (const artefact_field *field = schema->fields; field->name && !status; field++)
        if (field_exists(from, field) && !has_listed_axis(field, except_axes))
            status = copy_field(to, from, field, error);
    return status;
}
