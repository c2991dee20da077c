/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes digests of the content of a file, which show accidental changes. The root attribute
 * content_sha256 has a line "SHA-256 NAME" for each axis and dataset of the schema, and one line
 * for all attributes. The attribute is written when a file gets its final name. */
#include "common/artefact/internal.h"

#include <endian.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char attribute_name[] = "content_sha256";
static const char of_attributes[] = "attributes";

/* Checks whether digests are wanted. EHDROM_DIGEST=no switches them off, because hashing takes
 * longer than reading. */
static bool is_wanted(void) {
    const char *wanted = getenv("EHDROM_DIGEST");

    return !wanted || strcmp(wanted, "no") != 0;
}

// ---- one dataset

static void add_text(struct sha256_ctx *context, const char *text) {
    sha256_update(context, strlen(text), (const uint8_t *)text);
}

/* Hashes numbers as 64-bit little-endian numbers. */
static void add_numbers(struct sha256_ctx *context, const void *numbers, size_t count) {
    enum { BLOCK = 512 };
    uint64_t block[BLOCK];

    for (size_t first = 0; first < count; first += BLOCK) {
        const size_t left = count - first, num = left < BLOCK ? left : BLOCK;
        memcpy(block, (const char *)numbers + first * sizeof *block, num * sizeof *block);
        for (size_t i = 0; i < num; i++)
            block[i] = htole64(block[i]);
        sha256_update(context, num * sizeof *block, (const uint8_t *)block);
    }
}

void digest_begin(content_digest *self, const artefact *file, const artefact_field *field) {
    const char *axes[ARTEFACT_MAX_RANK];
    const size_t rank = artefact_axes(axes, file, field);
    char text[32];

    self->entry = entry_size(file, field);
    self->by_entry = field->by_entry;
    sha256_init(&self->context);
    add_text(&self->context, field->name);
    add_text(&self->context, field->type == ARTEFACT_REAL ? " real" : " integer");
    for (size_t i = 0; i < rank; i++) {
        snprintf(text, sizeof text, " %zu", artefact_length(file, axes[i]));
        add_text(&self->context, text);
    }
    add_text(&self->context, "\n");
}

static bool is_known(const double *numbers, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (!isnan(numbers[i])) return true;
    return false;
}

void digest_add(content_digest *self, size_t first, size_t count, const void *numbers) {
    char text[32];

    if (!self->by_entry) {
        add_numbers(&self->context, numbers, count * self->entry);
        return;
    }
    // entries that were never written are NaN; they are skipped
    for (size_t e = 0; e < count; e++) {
        const double *entry = (const double *)numbers + e * self->entry;
        if (!is_known(entry, self->entry)) continue;
        snprintf(text, sizeof text, "%zu\n", first + e);
        add_text(&self->context, text);
        add_numbers(&self->context, entry, self->entry);
    }
}

// ---- attributes

static void hash_attribute(struct sha256_ctx *context, const artefact *file, const char *name,
                           artefact_type type) {
    any_number number = {.integer = 0};

    if (!hdf5_has_attribute(file->id, name)) return;
    add_text(context, name);
    add_text(context, "\n");
    if (type != ARTEFACT_TEXT) {
        hdf5_get_number(file->id, name, type, &number);
        add_numbers(context, &number, 1);
        return;
    }
    char *text = hdf5_get_text(file->id, name);
    if (text) add_text(context, text);
    add_text(context, "\n");
    free(text);
}

static void hash_attributes(const artefact *file, char digest[65]) {
    struct sha256_ctx context;

    sha256_init(&context);
    hash_attribute(&context, file, "schema_name", ARTEFACT_TEXT);
    hash_attribute(&context, file, "schema_version", ARTEFACT_TEXT);
    for (const artefact_field *entry = file->schema->attributes; entry->name; entry++)
        hash_attribute(&context, file, entry->name, entry->type);
    sha256_end(&context, digest);
}

// ---- reading

static const char *find_digest(const artefact *file, const char *name) {
    const size_t digits = 64, length = strlen(name);

    for (const char *line = file->digests; line && *line;) {
        const size_t found = strcspn(line, "\n");
        if (found == digits + 1 + length && line[digits] == ' ' &&
            strncmp(line + digits + 1, name, length) == 0)
            return line;
        line += found + (line[found] == '\n');
    }
    return NULL;
}

ehd_status check_digest(const artefact *file, const char *name, const char *digest,
                        ehd_error *error) {
    const char *expected = find_digest(file, name);

    if (expected && strncmp(expected, digest, 64) == 0) return EHD_OK;
    return ehd_fail(error, EHD_DATA,
                    "%s: %s: found a changed content, expected that of %s (who means the change "
                    "deletes this attribute)",
                    shown_name(file), name, attribute_name);
}

ehd_status check_content(const artefact *file, const artefact_field *field, const void *numbers,
                         ehd_error *error) {
    content_digest hash;
    char digest[65];

    if (!file->digests) return EHD_OK;
    digest_begin(&hash, file, field);
    digest_add(&hash, 0, num_entries(file, field), numbers);
    sha256_end(&hash.context, digest);
    return check_digest(file, field->name, digest, error);
}

/* Checks that a dataset is in the file if and only if the stored list has it. */
static ehd_status check_listed(const artefact *file, const char *name, bool there,
                               ehd_error *error) {
    if ((find_digest(file, name) != NULL) == there) return EHD_OK;
    return check_digest(file, name, "", error);
}

ehd_status learn_digests(artefact *file, ehd_error *error) {
    char digest[65];

    if (file->growing || file->partial || !is_wanted()) return EHD_OK;
    if (!hdf5_has_attribute(file->id, attribute_name)) return EHD_OK;
    file->digests = hdf5_get_text(file->id, attribute_name);
    if (!file->digests)
        return ehd_fail(error, EHD_DATA, "%s: %s: found something else, expected a text",
                        shown_name(file), attribute_name);
    hash_attributes(file, digest);
    ehd_status status = check_digest(file, of_attributes, digest, error);
    for (const file_dataset *of = file->datasets; of->field.name && !status; of++)
        status = check_listed(file, of->field.name, of->there, error);
    return status;
}

const char *const content_without_digest = "no digest";

const char *digest_outcome(hid_t file) {
    if (!hdf5_has_attribute(file, "schema_name")) return NULL;
    if (!hdf5_has_attribute(file, attribute_name)) return content_without_digest;
    return is_wanted() ? "digest checked" : "digest not checked";
}

// ---- writing

static ehd_status list_dataset(FILE *list, artefact *file, const artefact_field *field,
                               ehd_error *error) {
    char digest[65];

    if (!hdf5_has_dataset(file->id, field->name)) return EHD_OK;
    const ehd_status status = read_field(file, field, digest, error);
    if (!status) fprintf(list, "%s %s\n", digest, field->name);
    return status;
}

static ehd_status list_all(FILE *list, artefact *file, ehd_error *error) {
    char digest[65];
    ehd_status status = EHD_OK;

    hash_attributes(file, digest);
    fprintf(list, "%s %s\n", digest, of_attributes);
    for (const file_dataset *of = file->datasets; of->field.name && !status; of++)
        status = list_dataset(list, file, &of->field, error);
    return status;
}

ehd_status put_digests(artefact *file, ehd_error *error) {
    char *text = NULL;
    size_t size = 0;

    // an earlier attempt to finish a resumed file may have left a digest that no longer matches
    if (!is_wanted())
        return hdf5_has_attribute(file->id, attribute_name) &&
                       H5Adelete(file->id, attribute_name) < 0
                   ? hdf5_write_failed(file, attribute_name, error)
                   : EHD_OK;
    FILE *list = open_memstream(&text, &size);
    if (!list) return ehd_no_memory(error, file->path);
    ehd_status status = list_all(list, file, error);
    if (fclose(list) != 0 && !status) status = ehd_no_memory(error, file->path);
    if (!status && !hdf5_put_text(file->id, attribute_name, text))
        status = hdf5_write_failed(file, attribute_name, error);
    free(text);
    return status;
}
