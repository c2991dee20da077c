/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/model/shown.h"

#include "common/output/columns.h"

shown_lubricant shown_of(const ehd_contact *contact, bool in_time) {
    return (shown_lubricant){contact->alpha_p_H,
                             lubricant_rises_at(&contact->lubricant, contact->hertz_pressure),
                             in_time};
}

enum { NUM_COLUMNS = 2 + NUM_RISES };

static void list_columns(column columns[NUM_COLUMNS + 1]) {
    *columns++ = (column){COLUMN(shown_lubricant, "shown_alpha_p_H", alpha_p_H)};
    for (int r = 0; r < NUM_RISES; r++)
        *columns++ = (column){COLUMN(shown_lubricant, lubricant_rise_shown_names[r], rises.of[r])};
    *columns++ = (column){COLUMN(shown_lubricant, "shown_in_time", in_time), .integer = true};
    *columns = (column){0};
}

ehd_status shown_put(artefact *file, const shown_lubricants *shown, ehd_error *error) {
    column columns[NUM_COLUMNS + 1];

    if (shown->count == 0) return EHD_OK;
    list_columns(columns);
    const ehd_status status = artefact_put_axis(file, "shown", shown->count, NULL, error);
    return status
               ? status
               : columns_put(file, columns, 0, shown->of, sizeof *shown->of, shown->count, error);
}

ehd_status shown_get(shown_lubricants *shown, arena *memory, artefact *file, ehd_error *error) {
    const size_t count = artefact_length(file, "shown");
    column columns[NUM_COLUMNS + 1];

    list_columns(columns);
    *shown = (shown_lubricants){0, arena_array(memory, count, sizeof *shown->of)};
    if (memory->failed) return ehd_no_memory(error, artefact_path(file));
    if (count == 0 || !columns_are_in(file, columns)) return EHD_OK;
    const ehd_status status =
        columns_get(shown->of, sizeof *shown->of, count, columns, file, error);
    if (!status) shown->count = count;
    return status;
}
