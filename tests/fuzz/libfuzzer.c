/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Entry points of libFuzzer. The environment variable TARGET selects the target. Edits are
 * generated from the words of edit.h and the names of the schema. */
#include "tests/fuzz/edit.h"
#include "tests/fuzz/flat_edit.h"
#include "tests/fuzz/target.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

int LLVMFuzzerInitialize(int *argc, char ***argv);
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length);
size_t LLVMFuzzerCustomMutator(uint8_t *bytes, size_t length, size_t room, unsigned seed);
size_t LLVMFuzzerMutate(uint8_t *bytes, size_t length, size_t room);
const char *__asan_default_options(void);

/* Replaces strcmp (linked with --wrap) by a version that libFuzzer does not record. Recording the
 * many comparisons of names takes most of the time, and the seeds contain the names anyway. */
int __wrap_strcmp(const char *a, const char *b);
int __wrap_strcmp(const char *a, const char *b) {
    while (*a && *a == *b)
        a++, b++;
    return (unsigned char)*a - (unsigned char)*b;
}

/* Refuses allocations of more than 512 MB, as a system without enough memory does. */
const char *__asan_default_options(void) {
    return "allocator_may_return_null=1:max_allocation_size_mb=512:quarantine_size_mb=32:malloc_"
           "context_size=10:detect_stack_use_after_return=0";
}

static const fuzz_target *target(void) {
    static const fuzz_target *found;
    if (!found) found = fuzz_find(getenv("TARGET") ? getenv("TARGET") : "");
    if (!found) abort();
    return found;
}

static int standard_error; // a copy, because libFuzzer closes the original before the first input

int LLVMFuzzerInitialize(int *argc, char ***argv) {
    (void)argc, (void)argv;
    standard_error = dup(STDERR_FILENO);
    return 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length) {
    static bool started;
    if (!started) fuzz_start(standard_error);
    started = true;
    fuzz_run(target(), bytes, length);
    return 0;
}

// ---- edits

static unsigned state;

static unsigned below(unsigned count) {
    state = state * 1664525u + 1013904223u;
    return count > 0 ? (state >> 8) % count : 0;
}

static const char *one_of(const char *const *words) {
    unsigned count = 0;
    while (words[count])
        count++;
    return words[below(count)];
}

static const char *any_name(void) {
    static const char *const others[] = {"schema_name",  "schema_version", "complete", "settings",
                                         "history",      "Conventions",    "creator",  "title",
                                         "input_1_path", "sha256",         NULL};
    static const char *const of_tables[] = {"time", "load", "x", NULL};
    const artefact_schema *schema = target()->schema;
    const char *names[256];
    size_t count = 0;
    if (!schema) return one_of(of_tables);
    if (below(20) == 0) return one_of(others);
    for (const artefact_field *field = schema->fields; field->name && count < 200; field++)
        names[count++] = field->name;
    for (const artefact_axis *axis = schema->axes; axis->name && count < 255; axis++)
        names[count++] = axis->name;
    return count > 0 ? names[below((unsigned)count)] : "x";
}

static const char *any_axis(void) {
    const artefact_schema *schema = target()->schema;
    unsigned count = 0;
    if (!schema) return any_name();
    while (schema->axes[count].name)
        count++;
    return schema->axes[below(count)].name;
}

static const char *any_attribute(void) {
    const artefact_schema *schema = target()->schema;
    unsigned count = 0;
    if (!schema || below(8) == 0) return any_name();
    while (schema->attributes[count].name)
        count++;
    return count ? schema->attributes[below(count)].name : any_name();
}

static const char *any_number(void) {
    static const char *const numbers[] = {"0",
                                          "1",
                                          "-1",
                                          "2",
                                          "3",
                                          "-2",
                                          "0.5",
                                          "1e-300",
                                          "1e300",
                                          "-1e9",
                                          "nan",
                                          "inf",
                                          "-inf",
                                          "1e-9",
                                          "127",
                                          "255",
                                          "256",
                                          "65535",
                                          "2147483647",
                                          "4294967295",
                                          "4294967296",
                                          "9007199254740993",
                                          "9223372036854775807",
                                          "-9223372036854775808",
                                          "2305843009213693951",
                                          "2305843009213693952",
                                          "1152921504606846976",
                                          "1000000000",
                                          "100000",
                                          NULL};
    static char own[32];
    if (below(2)) return one_of(numbers);
    snprintf(own, sizeof own, below(3) ? "%u" : "%u.25", below(below(2) ? 130 : 20));
    return own;
}

static const char *any_text(void) {
    static const char *const texts[] = {"line",
                                        "point",
                                        "accurate",
                                        "published",
                                        "open",
                                        "zero",
                                        "path",
                                        "upwind",
                                        "coupled",
                                        "independent",
                                        "quadrature",
                                        "plain",
                                        "given",
                                        "1.0",
                                        "99.0",
                                        "2.3",
                                        "x",
                                        "",
                                        "ehdrom-model",
                                        "ehdrom-result",
                                        "ehdrom-snapshots",
                                        "\\n",
                                        "groups:\\n-\\s{scene:\\sline.yml}",
                                        NULL};
    return below(4) ? one_of(texts) : any_number();
}

/* Generates an edit of a flat model. Blocks are given by number, not by name. Most blocks hold only
 * one value, which has the index 0. */
static int make_flat_line(char *line, size_t room) {
    const char *word = one_of(flat_edit_words);
    const unsigned block = below(64), index = below(2) ? below(200) : 0;
    if (below(8) == 0) return snprintf(line, room, "state %u %s\n", below(512), any_number());
    switch (below(3) ? *word : 'p') { // p: put; w: whole
    case 'p':
    case 'w':
        return snprintf(line, room, "%s %u %u %s\n", below(2) ? "put" : "whole", block, index,
                        any_number());
    case 'h': // header
        return snprintf(line, room, "%s %u %s\n", word, below(8), any_number());
    case 'n': // name
        return snprintf(line, room, "%s %u %s\n", word, block, any_text());
    default:
        return snprintf(line, room, "%s %u %s\n", word, block, any_number());
    }
}

/* Generates a line with an edit of an HDF5 file. */
static int make_line(char *line, size_t room) {
    const char *name = any_name();
    switch (below(14)) {
    case 0:
        return snprintf(line, room, "delete %s\n", name);
    case 1:
    case 2:
    case 3:
        return snprintf(line, room, "put %s %u %s\n", name, below(200), any_number());
    case 4:
        return snprintf(line, room, "fill %s %s\n", name, any_number());
    case 5:
        return snprintf(line, room, "shape %s %s\n", name, any_number());
    case 6:
        return snprintf(line, room, "shape %s %u %s\n", name, below(20), any_number());
    case 7:
    case 8:
        return snprintf(line, room, "axis %s %s\n", any_axis(), any_number());
    case 9:
        return snprintf(line, room, "type %s %s\n", name, one_of(edit_types));
    case 10:
        return snprintf(line, room, "layout %s %s\n", name, one_of(edit_layouts));
    case 11:
        return snprintf(line, room, "link %s %s %s\n", name, one_of(edit_links), any_axis());
    default:
        return snprintf(line, room, "attribute %s %s %s\n", any_attribute(),
                        one_of(edit_attributes), any_text());
    }
}

/* Removes a random line; returns the new length. */
static size_t drop_line(char *text, size_t length) {
    size_t num_lines = 0, begin = 0, end;
    for (size_t i = 0; i < length; i++)
        num_lines += text[i] == '\n';
    if (num_lines == 0) return 0;
    for (size_t skip = below((unsigned)num_lines); skip > 0; begin++)
        skip -= text[begin] == '\n';
    for (end = begin; end < length && text[end] != '\n';)
        end++;
    end += end < length;
    memmove(text + begin, text + end, length - end);
    return length - (end - begin);
}

size_t LLVMFuzzerCustomMutator(uint8_t *bytes, size_t length, size_t room, unsigned seed) {
    char line[256];
    int added;
    state = seed;
    if (!target()->bases[0] || below(10) == 0) return LLVMFuzzerMutate(bytes, length, room);
    if (below(3) == 0) length = drop_line((char *)bytes, length);
    if (length > 0 && bytes[length - 1] != '\n' && length < room) bytes[length++] = '\n';
    switch (below(8)) {
    case 0:
        // the last base is a file as the programs write it; it is used rarely, because its
        // attributes and dimension scales make edits several times as slow
        added = snprintf(line, sizeof line, "base %u\n",
                         below(10) ? below(MAX_BASES - 1) : MAX_BASES - 1);
        break;
    case 1:
        added = snprintf(line, sizeof line, "run %u\n", below(MAX_COMMANDS));
        break;
    default:
        added = target()->flat ? make_flat_line(line, sizeof line) : make_line(line, sizeof line);
    }
    if (added < 1 || (size_t)added >= sizeof line || (size_t)added > room - length) return length;
    // a line "base" or "run" is put in front, since only the first line of each is used
    const bool first = line[0] == 'b' || line[0] == 'r';
    memmove(bytes + (first ? added : 0), bytes, length);
    memcpy(bytes + (first ? 0 : length), line, (size_t)added);
    return length + (size_t)added;
}
