/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/unit/schema_page.h"

#include "common/artefact/internal.h"

#include <string.h>

static const char *need_text(artefact_need need) {
    static const char *const texts[] = {"everybody", "our programs", "where it applies"};
    return texts[need];
}

static const char *type_text(artefact_type type) {
    static const char *const texts[] = {"real", "integer", "text"};
    return texts[type];
}

/* Prints, after the meaning, which factor converts the number to SI units. */
static void print_scale(const artefact_scale *scale, FILE *stream) {
    if (scale) {
        const char *first = scale->attributes[0];
        fprintf(stream, "; in SI units times `%s`", first ? first : scale->frame);
        if (scale->attributes[1]) fprintf(stream, " or `%s`", scale->attributes[1]);
        if (first && scale->frame) fprintf(stream, " and `%s`", scale->frame);
    }
    fprintf(stream, " |\n");
}

static void print_axes(const artefact_axis *axis, FILE *stream) {
    fprintf(stream, "| axis | units | at most | meaning |\n|---|---|---|---|\n");
    for (; axis->name; axis++) {
        fprintf(stream, "| `%s` | %s | %zu | %s", axis->name, axis->units, axis->max,
                axis->long_name);
        print_scale(axis->scale, stream);
    }
}

static bool axis_is_optional(const artefact_schema *schema, const char *name) {
    const artefact_axis *axis = schema->axes;
    while (axis->name && strcmp(axis->name, name) != 0)
        axis++;
    return axis->name && axis->optional;
}

/* Prints the axes of a field, optional axes in brackets. */
static void print_field_axes(const artefact_schema *schema, const artefact_field *field,
                             FILE *stream) {
    for (int i = 0; i < ARTEFACT_MAX_RANK && field->axes[i]; i++) {
        bool optional = axis_is_optional(schema, field->axes[i]);
        fprintf(stream, optional ? "%s(%s)" : "%s%s", i > 0 ? ", " : "", field->axes[i]);
    }
}

static void print_fields(const artefact_schema *schema, FILE *stream) {
    fprintf(stream, "| dataset | axes | type | units | values | written by | meaning |\n");
    fprintf(stream, "|---|---|---|---|---|---|---|\n");
    for (const artefact_field *field = schema->fields; field->name; field++) {
        fprintf(stream, "| `%s` | ", field->name);
        print_field_axes(schema, field, stream);
        fprintf(stream, " | %s | %s | %s | %s | %s", type_text(field->type), field->units,
                values_text(field->values), need_text(field->need), field->long_name);
        print_scale(field->scale, stream);
    }
}

static void print_attributes(const artefact_field *entry, FILE *stream) {
    fprintf(stream, "| attribute | type | units | values | written by | meaning |\n"
                    "|---|---|---|---|---|---|\n");
    for (; entry->name; entry++) {
        fprintf(stream, "| `%s` | %s | %s | %s | %s | %s", entry->name, type_text(entry->type),
                entry->units, values_text(entry->values), need_text(entry->need), entry->long_name);
        print_scale(entry->scale, stream);
    }
}

void schema_page_print(const artefact_schema *schema, FILE *stream) {
    fprintf(stream, "`schema_name` = `%s`, `schema_version` = `%d.%d`\n\n", schema->name,
            schema->major, schema->minor);
    print_axes(schema->axes, stream);
    fprintf(stream, "\n");
    print_fields(schema, stream);
    fprintf(stream, "\n");
    print_attributes(schema->attributes, stream);
}
