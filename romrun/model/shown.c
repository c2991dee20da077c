/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/model/shown.h"

#include "common/program/arena.h"

#include <math.h>
#include <stdlib.h>

shown_lubricant shown_of(const ehd_contact *contact, bool in_time) {
    return (shown_lubricant){contact->alpha_p_H,
                             lubricant_rises_at(&contact->lubricant, contact->hertz_pressure),
                             in_time};
}

/* Number of datasets with real numbers: alpha p_H and the rises. */
enum { NUM_COLUMNS = 1 + NUM_RISES };

static const char *name_of(int column) {
    return column == 0 ? "shown_alpha_p_H" : lubricant_rise_shown_names[column - 1];
}

static double *entry(shown_lubricant *of, int column) {
    return column == 0 ? &of->alpha_p_H : &of->rises.of[column - 1];
}

ehd_status shown_put(artefact *file, const shown_lubricants *shown, ehd_error *error) {
    double *values = array_new(shown->count, 1, sizeof *values);
    int64_t *in_time = array_new(shown->count, 1, sizeof *in_time);
    ehd_status status = values && in_time ? EHD_OK : ehd_no_memory(error, artefact_path(file));

    if (!status && shown->count > 0)
        status = artefact_put_axis(file, "shown", shown->count, NULL, error);
    for (int c = 0; c < NUM_COLUMNS && !status && shown->count > 0; c++) {
        for (size_t i = 0; i < shown->count; i++)
            values[i] = *entry(&shown->of[i], c);
        status = artefact_put(file, name_of(c), values, error);
    }
    for (size_t i = 0; i < shown->count && !status; i++)
        in_time[i] = shown->of[i].in_time;
    if (!status && shown->count > 0)
        status = artefact_put_integers(file, "shown_in_time", in_time, error);
    free(values);
    free(in_time);
    return status;
}

ehd_status shown_get(shown_lubricants *shown, artefact *file, ehd_error *error) {
    const size_t count = artefact_length(file, "shown");
    double *values = array_new(count, 1, sizeof *values);
    int64_t *in_time = array_new(count, 1, sizeof *in_time);
    bool all = count > 0 && artefact_has(file, "shown_in_time");

    *shown = (shown_lubricants){0, array_new(count, 1, sizeof *shown->of)};
    ehd_status status =
        values && in_time && shown->of ? EHD_OK : ehd_no_memory(error, artefact_path(file));
    for (int c = 0; c < NUM_COLUMNS; c++)
        all = all && artefact_has(file, name_of(c));
    for (int c = 0; c < NUM_COLUMNS && all && !status; c++) {
        status = artefact_get(file, name_of(c), values, count, error);
        for (size_t i = 0; i < count && !status; i++)
            *entry(&shown->of[i], c) = values[i];
    }
    if (!status && all)
        status = artefact_get_integers(file, "shown_in_time", in_time, count, error);
    for (size_t i = 0; i < count && all && !status; i++)
        shown->of[i].in_time = in_time[i];
    if (!status && all) shown->count = count;
    free(values);
    free(in_time);
    return status;
}
