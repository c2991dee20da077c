/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks that the pages in schemas/ show the tables of the code, and that the tables are
 * consistent. With UPDATE_SCHEMAS=1 in the environment, this test first writes the tables into the
 * pages. The page scene.md belongs to test_settings. */
#include "tests/unit/check.h"
#include "tests/unit/schema_page.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

static const char begin_mark[] = "<!-- table -->\n";
static const char end_mark[] = "<!-- end -->\n";

/* Returns the page of a schema: "schemas/result.md" for "ehdrom-result". */
static void page_path(char path[128], const artefact_schema *schema) {
    snprintf(path, 128, "schemas/%s.md", schema->name + strlen("ehdrom-"));
}

static char *read_page(const char *path) {
    FILE *stream = fopen(path, "r");
    if (!stream) fail_msg("%s: cannot be read from the repository root", path);
    fseek(stream, 0, SEEK_END);
    const size_t size = (size_t)ftell(stream);
    rewind(stream);
    char *text = calloc(size + 1, 1);
    assert_int_equal(fread(text, 1, size, stream), size);
    fclose(stream);
    return text;
}

static char *table_of(const artefact_schema *schema) {
    char *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);
    schema_page_print(schema, stream);
    fclose(stream);
    return text;
}

/* Splits a page in place into the text before, between and behind two marks. */
static void split_page(char *page, char **table, char **rest, const char *path) {
    char *begin = strstr(page, begin_mark);
    char *end = begin ? strstr(begin, end_mark) : NULL;
    if (!end) fail_msg("%s: no lines %sand %s", path, begin_mark, end_mark);
    *begin = '\0';
    *end = '\0';
    *table = begin + strlen(begin_mark);
    *rest = end + strlen(end_mark);
}

static void write_page(const char *path, const char *before, const char *table, const char *rest) {
    FILE *stream = fopen(path, "w");
    assert_non_null(stream);
    fprintf(stream, "%s%s%s%s%s", before, begin_mark, table, end_mark, rest);
    assert_int_equal(fclose(stream), 0);
}

static void pages_show_the_tables(void **state) {
    (void)state;
    for (size_t i = 0; artefact_schemas[i]; i++) {
        char path[128];
        char *found = NULL;
        char *rest = NULL;
        page_path(path, artefact_schemas[i]);
        char *page = read_page(path);
        char *expected = table_of(artefact_schemas[i]);
        split_page(page, &found, &rest, path);
        if (getenv("UPDATE_SCHEMAS")) {
            write_page(path, page, expected, rest);
        } else if (strcmp(found, expected) != 0) {
            fail_msg(
                "%s: its tables differ from schemas.c; UPDATE_SCHEMAS=1 and this test bring it up "
                "to date",
                path);
        }
        free(expected);
        free(page);
    }
}

static void check_name(const char *name, const char *what) {
    bool good = isalpha((unsigned char)name[0]) != 0;
    for (const char *at = name; *at; at++) {
        good = good && (isalnum((unsigned char)*at) || *at == '_');
    }
    if (!good) fail_msg("%s: no name for a %s that all tools accept", name, what);
}

static size_t times_used(const artefact_schema *schema, const char *name) {
    size_t count = 0;
    for (const artefact_axis *e = schema->axes; e->name; e++)
        count += strcmp(e->name, name) == 0;
    for (const artefact_field *e = schema->fields; e->name; e++) {
        count += strcmp(e->name, name) == 0;
    }
    for (const artefact_field *e = schema->attributes; e->name; e++) {
        count += strcmp(e->name, name) == 0;
    }
    return count;
}

static void check_entry(const artefact_schema *schema, const char *name, const char *units,
                        const char *long_name, const char *what) {
    check_name(name, what);
    if (times_used(schema, name) != 1) fail_msg("%s: %s: used twice", schema->name, name);
    if (!units || !*units) fail_msg("%s: %s: no units", schema->name, name);
    if (!long_name || !*long_name) fail_msg("%s: %s: no long_name", schema->name, name);
    if (strpbrk(long_name, "|\n")) fail_msg("%s: %s: breaks the table", schema->name, name);
}

static void check_axes(const artefact_schema *schema, const artefact_field *field) {
    if (!field->axes[0]) fail_msg("%s: %s: no axis", schema->name, field->name);
    for (size_t i = 0; i < ARTEFACT_MAX_RANK && field->axes[i]; i++) {
        const artefact_axis *axis = schema->axes;
        while (axis->name && strcmp(axis->name, field->axes[i]) != 0)
            axis++;
        if (!axis->name) fail_msg("%s: %s: no axis %s", schema->name, field->name, field->axes[i]);
    }
    if (field->type == ARTEFACT_TEXT) fail_msg("%s: %s: text", schema->name, field->name);
}

/* Checks the scale of a field or attribute: whether the scale's attributes are in the same schema
 * and have SI units, and whether its frame is a field along one axis. */
static void check_scale(const artefact_schema *schema, const char *name, const char *units,
                        const artefact_scale *scale) {
    if (!scale) return;
    if (strcmp(units, "1") != 0) fail_msg("%s: %s: has units and a scale", schema->name, name);
    for (int i = 0; i < 2 && scale->attributes[i]; i++) {
        const artefact_field *of = schema->attributes;
        while (of->name && strcmp(of->name, scale->attributes[i]) != 0)
            of++;
        if (!of->name || strcmp(of->units, "1") == 0)
            fail_msg("%s: %s: no scale %s", schema->name, name, scale->attributes[i]);
    }
    if (!scale->attributes[0] && !scale->frame)
        fail_msg("%s: %s: an empty scale", schema->name, name);
    const artefact_field *frame = schema->fields;
    while (frame->name && scale->frame && strcmp(frame->name, scale->frame) != 0)
        frame++;
    if (!frame->name || (scale->frame && frame->axes[1]))
        fail_msg("%s: %s: no frame %s along one axis", schema->name, name, scale->frame);
    if (!scale->attributes[0] && strcmp(frame->units, "1") == 0)
        fail_msg("%s: %s: no units of %s", schema->name, name, scale->frame);
}

/* Checks that a range fits the type. The ranges of integers follow those of real numbers. */
static void check_range(const artefact_schema *schema, const artefact_field *field) {
    const bool for_integers = field->values >= VALUES_FLAG;
    if (field->values != VALUES_ANY && for_integers != (field->type == ARTEFACT_INTEGER))
        fail_msg("%s: %s: a range of another type", schema->name, field->name);
}

static void tables_make_sense(void **state) {
    (void)state;
    for (size_t i = 0; artefact_schemas[i]; i++) {
        const artefact_schema *schema = artefact_schemas[i];
        assert_int_equal(strncmp(schema->name, "ehdrom-", 7), 0);
        assert_true(schema->major >= 1 && schema->minor >= 0 && schema->title[0]);
        for (const artefact_axis *e = schema->axes; e->name; e++) {
            check_entry(schema, e->name, e->units, e->long_name, "axis");
            check_scale(schema, e->name, e->units, e->scale);
        }
        for (const artefact_field *e = schema->fields; e->name; e++) {
            check_entry(schema, e->name, e->units, e->long_name, "dataset");
            check_scale(schema, e->name, e->units, e->scale);
            check_axes(schema, e);
            check_range(schema, e);
        }
        for (const artefact_field *e = schema->attributes; e->name; e++) {
            check_entry(schema, e->name, e->units, e->long_name, "attribute");
            check_range(schema, e);
            check_scale(schema, e->name, e->units, e->scale);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tables_make_sense),
        cmocka_unit_test(pages_show_the_tables),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
