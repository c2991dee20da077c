/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/unit/settings_page.h"

#include "common/settings/settings_table.h"

#include <string.h>

/* Prints "barus, wlf" for "barus|wlf", because a bar would end the cell of a Markdown table. */
static void print_words(FILE *stream, const char *choices, const char *between) {
    for (; *choices; choices++)
        fputs(*choices == '|' ? between : (char[]){*choices, '\0'}, stream);
}

/* Returns the quantity to whose history a key belongs, or -1 if the key belongs to no history. */
static int quantity_of(const char *key) {
    char group[MAX_KEY];

    for (int i = 0; i < NUM_VARY; i++) {
        snprintf(group, sizeof group, "transient.%s.", vary_names[i]);
        if (strncmp(key, group, strlen(group)) == 0) return i;
    }
    return -1;
}

/* Prints the key; for a key of histories, the keys of all histories. */
static void print_key(FILE *stream, const setting *row) {
    if (quantity_of(row->key) < 0) {
        fputs(row->key, stream);
        return;
    }
    for (int i = 0; i < NUM_VARY; i++)
        fprintf(stream, "%s%s", i ? ", " : "transient.<", vary_names[i]);
    fprintf(stream, ">%s", strrchr(row->key, '.'));
}

static void print_allowed(FILE *stream, const setting *row) {
    switch (row->type) {
    case SETTING_REAL:
    case SETTING_WHOLE:
        fprintf(stream, "%g to %g%s", row->min, row->max,
                row->type == SETTING_WHOLE ? ", whole" : "");
        break;
    case SETTING_TEXT:
        fprintf(stream, "text");
        break;
    case SETTING_FILE:
        fprintf(stream, "file");
        break;
    default:
        print_words(stream, row->type == SETTING_FLAG ? "true|false" : row->choices, ", ");
    }
}

/* Prints the conditions of a row: "regime transient, closure load". For a key of histories, prints
 * only the condition that all histories have. */
static void print_conditions(FILE *stream, const setting *row) {
    const size_t max_shown = quantity_of(row->key) < 0 ? MAX_CONDITIONS : 1;

    for (size_t i = 0; i < max_shown && row->when[i].key; i++) {
        const char *key = row->when[i].key, *dot = strrchr(key, '.');
        fprintf(stream, "%s%s ", i ? ", " : "", dot ? dot + 1 : key);
        print_words(stream, row->when[i].values, " or ");
    }
}

void settings_page_print(FILE *stream) {
    fprintf(stream, "| Key | Allowed | Unit | Default | Only with | Meaning |\n"
                    "|---|---|---|---|---|---|\n");
    for (const setting *row = scene_settings(); row->key; row++) {
        if (quantity_of(row->key) > 0) continue; // all histories have the same keys
        fputs("| `", stream);
        print_key(stream, row);
        fputs("` | ", stream);
        print_allowed(stream, row);
        fputs(" | ", stream);
        if (row->type == SETTING_REAL) print_words(stream, row->unit, ", ");
        fprintf(stream, " | %s | ",
                row->required        ? "*required*"
                : row->default_value ? row->default_value
                                     : "");
        print_conditions(stream, row);
        fprintf(stream, " | %s |\n", row->help);
    }
}
