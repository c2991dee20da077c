/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/unit/settings_page.h"

#include "common/settings/settings_table.h"

#include <string.h>

/* Prints "barus, wlf" for "barus|wlf", because a bar would end the cell of a Markdown table. */
static void print_words(FILE *stream, const char *choices) {
    for (; *choices; choices++)
        fputs(*choices == '|' ? ", " : (char[]){*choices, '\0'}, stream);
}

/* Prints the key; for a key of histories, the keys of all histories. */
static void print_key(FILE *stream, const setting *row) {
    if (setting_quantity(row) < 0) {
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
        print_words(stream, row->type == SETTING_FLAG ? "true|false" : row->choices);
    }
}

void settings_page_print(FILE *stream) {
    fprintf(stream, "| Key | Allowed | Unit | Default | Only with | Meaning |\n"
                    "|---|---|---|---|---|---|\n");
    for (const setting *row = scene_settings(); row->key; row++) {
        if (setting_quantity(row) > 0) continue; // all histories have the same keys
        fputs("| `", stream);
        print_key(stream, row);
        fputs("` | ", stream);
        print_allowed(stream, row);
        fputs(" | ", stream);
        if (row->type == SETTING_REAL) print_words(stream, row->unit);
        fprintf(stream, " | %s | ",
                row->required        ? "*required*"
                : row->default_value ? row->default_value
                                     : "");
        setting_print_conditions(stream, row, "");
        fprintf(stream, " | %s |\n", row->help);
    }
}
