/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/calibrate/describe_model.h"

#include "common/artefact/artefact.h"
#include "common/output/grid_file.h"
#include "common/program/arena.h"
#include "common/program/text.h"
#include "common/settings/part_list.h"
#include "common/settings/settings_table.h"
#include "romrun/calibrate/trade.h"
#include "romrun/model/trade_file.h"
#include "romrun/online/online.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// ---- scenes on which the model was checked

/* Values of one setting in all check scenes. */
typedef struct setting_range {
    double low, high; // of a number
    char words[160];  // different words, separated by ", "
} setting_range;

static void take_word(setting_range *of, const char *word) {
    const char *found = strstr(of->words, word);
    const size_t used = strlen(of->words), length = strlen(word);

    if (found && (found == of->words || found[-1] == ' ') && strchr(",", found[length])) return;
    snprintf(of->words + used, sizeof of->words - used, "%s%s", used > 0 ? ", " : "", word);
}

/* Takes one line of the text of a plan, "key: value". Other lines have no such key. */
static void take_line(setting_range *ranges, char *line) {
    char *colon = strstr(line, ": ");
    const setting *row;
    double number;

    if (!colon) return;
    *colon = '\0';
    row = setting_find(line);
    if (!row) return;
    setting_range *of = &ranges[setting_index(row)];
    if (row->type != SETTING_REAL || !number_read(&number, colon + 2)) {
        take_word(of, colon + 2);
        return;
    }
    of->low = fmin(of->low, number);
    of->high = fmax(of->high, number);
}

/* Prints the values that the check scenes have of the settings below a group. */
static void print_group(const setting_range *ranges, const char *group) {
    const bool line = strcmp(ranges[setting_index(setting_find("contact"))].words, "line") == 0;

    for (const setting *row = scene_settings(); row->key; row++) {
        const setting_range *of = &ranges[setting_index(row)];
        const char *unit = strcmp(row->unit, "1") == 0 ? "" : row->unit;
        if (strchr(unit, '|')) unit = line ? "N/m" : "N";
        if (strncmp(row->key, group, strlen(group)) != 0) continue;
        if (*of->words)
            printf("  %-30s%s\n", row->key, of->words);
        else if (of->low < of->high)
            printf("  %-30s%.5g to %.5g %s\n", row->key, of->low, of->high, unit);
        else if (of->low == of->high)
            printf("  %-30s%.5g %s\n", row->key, of->low, unit);
    }
}

/* Prints in which range of settings the model was checked. `text` is the text of the model's
 * settings; its lines are changed. */
static ehd_status print_scenes(char *text, const char *path, ehd_error *error) {
    size_t count = 0;
    while (scene_settings()[count].key)
        count++;
    setting_range *ranges = array_new(count, 1, sizeof *ranges);

    if (!ranges) return ehd_no_memory(error, path);
    for (size_t i = 0; i < count; i++)
        ranges[i] = (setting_range){INFINITY, -INFINITY, ""};
    for (char *line = text; line;) {
        char *end = strchr(line, '\n');
        if (end) *end = '\0';
        take_line(ranges, line);
        line = end ? end + 1 : NULL;
    }
    printf("checked on scenes with\n");
    print_group(ranges, "moes.");
    print_group(ranges, "physical.");
    print_group(ranges, "lubricant.");
    free(ranges);
    return EHD_OK;
}

// ---- the model

static ehd_status print_states(artefact *file, ehd_error *error) {
    const size_t count = artefact_length(file, "state");
    double *values = array_new(count, 2, sizeof *values);
    ehd_status status = values ? EHD_OK : ehd_no_memory(error, artefact_path(file));

    if (!status) status = artefact_get(file, "state_moes_M", values, count, error);
    if (!status) status = artefact_get(file, "state_alpha_p_H", values + count, count, error);
    for (size_t i = 0; i < 2 && count > 0 && !status; i++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t s = 0; s < count; s++) {
            low = fmin(low, values[i * count + s]);
            high = fmax(high, values[i * count + s]);
        }
        printf("%-24s%.5g to %.5g\n", i == 0 ? "trained range of M" : "  of alpha p_H", low, high);
    }
    free(values);
    return status;
}

/* Prints the size with the smallest errors and the fastest size within 1 %. */
static void print_errors(const trade_table *table) {
    const size_t best = trade_most_accurate(table, false);
    char name[TRADE_NAME];

    if (best == table->num_positions) return;
    const trade_position *position = &table->positions[best];
    trade_name(name, &position->sizes);
    printf("%-24s%s\n", "most accurate size", name);
    printf("  %-22s%.2g %% (median), %.2g %% (largest of %zu scenes)\n", "error of central film",
           100 * position->deviation[TRADE_CENTRAL_FILM][TRADE_MEDIAN],
           100 * position->deviation[TRADE_CENTRAL_FILM][TRADE_WORST], table->num_scenes);
    printf("  %-22s%.2g %% (median), %.2g %% (largest)\n", "error of minimum film",
           100 * position->deviation[TRADE_MINIMUM_FILM][TRADE_MEDIAN],
           100 * position->deviation[TRADE_MINIMUM_FILM][TRADE_WORST]);
    printf("  %-22s%.3g ms\n", "time of a solution", position->seconds * 1e3);
    printf("%-24sromrun trade prints the errors and times of all %zu sizes\n", "",
           table->num_positions);
}

/* Prints what only an HDF5 file contains. */
static ehd_status describe_file(const char *path, ehd_error *error) {
    static const artefact_schema *const kinds[] = {&schema_model, NULL};
    artefact *file = NULL;
    trade_table table = {0};
    bool calibrated = false;
    char *text = NULL;
    ehd_status status = artefact_open(&file, path, kinds, error);

    if (!status && artefact_has(file, "state_moes_M")) status = print_states(file, error);
    if (!status) status = trade_get(&table, &calibrated, file, error);
    if (!status && calibrated && artefact_has(file, "settings"))
        status = artefact_get_text(file, "settings", &text, error);
    if (!status && text) status = print_scenes(text, path, error);
    if (!status && calibrated) print_errors(&table);
    free(text);
    trade_free(&table);
    artefact_close(&file);
    return status;
}

static void print_properties(const online_model *model) {
    const online_properties found = online_describe(model);

    printf("%-24s%s\n", "contact", online_kind(model)->name);
    printf("%-24s", "grid");
    grid_print_nodes(online_grid(model));
    printf("\n%-24s%s\n", "discretization", found.discretization);
    if (found.parts > 1) printf("%-24s%zu\n", "models for parts", found.parts);
    printf("%-24s%zu\n", "training solutions", found.states);
    printf("%-24s%zu pressure modes, %zu deformation modes, %zu selected equations\n", "size",
           found.pressure_modes, found.deformation_modes, found.rows);
    printf("%-24s%s\n", "checked", found.checked ? "yes" : "no: results have no error estimates");
    printf("%-24s%s\n", "checked in time", found.checked_in_time ? "yes" : "no");
}

ehd_status model_describe(const char *path, ehd_error *error) {
    online_model *model = NULL;
    bool flat = false;
    ehd_status status = online_is_flat(&flat, path, error);

    if (!status) status = online_open(&model, path, NULL, error);
    if (!status) print_properties(model);
    online_close(model);
    return status || flat || part_list_is(path) ? status : describe_file(path, error);
}
