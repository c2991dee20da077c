/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/output/time_result.h"

#include "common/output/columns.h"
#include "common/output/grid_file.h"
#include "common/output/inputs.h"
#include "common/output/result.h"
#include "common/output/traction_output.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { NUM_SLOTS = 2, SLOT_INVALID = -1 };

#define MEMBER(name, member) COLUMN(time_entry, name, member)

static const column scalars[] = {{MEMBER("central_film_thickness", scalars.central_film_thickness)},
                                 {MEMBER("minimum_film_thickness", scalars.minimum_film_thickness)},
                                 {MEMBER("central_pressure", scalars.central_pressure)},
                                 {MEMBER("rigid_approach", scalars.rigid_approach)},
                                 {MEMBER("load", scalars.load)},
                                 {MEMBER("contact_half_width", contact_half_width)},
                                 {MEMBER("frame_hertz_pressure", frame_hertz_pressure)},
                                 {MEMBER("frame_film_unit", frame_film_unit)},
                                 {MEMBER("residual_norm", residual)},
                                 {MEMBER("time_step", step)},
                                 {MEMBER("time_effect", effect)},
                                 {MEMBER("time_effect_minimum", effect_minimum)},
                                 {MEMBER("indicated_deviation", indicated)},
                                 {MEMBER("indicated_deviation_minimum", indicated_minimum)},
                                 {MEMBER("newton_iterations", newton_iterations), .integer = true},
                                 {0}};
static const column place = {MEMBER("surface_position", surface_position)};

/* Scalars that are read. */
static const struct {
    const char *name;
    size_t offset; // of a double * in time_series
} series_reals[] = {{"central_film_thickness", offsetof(time_series, central_film_thickness)},
                    {"minimum_film_thickness", offsetof(time_series, minimum_film_thickness)},
                    {"central_pressure", offsetof(time_series, central_pressure)},
                    {"load", offsetof(time_series, load)},
                    {"friction_coefficient", offsetof(time_series, friction_coefficient)}};

enum { NUM_SERIES_REALS = sizeof series_reals / sizeof *series_reals };

// ---- creating

static ehd_status declare_all(artefact *file, const column *columns, ehd_error *error) {
    ehd_status status = EHD_OK;

    for (; columns->field && !status; columns++)
        status = artefact_declare(file, columns->field, error);
    return status;
}

static ehd_status declare_traction(artefact *file, bool with_fields, ehd_error *error) {
    ehd_status status = declare_all(file, traction_columns, error);

    if (!status && with_fields) status = artefact_declare(file, "shear_stress_1", error);
    if (!status && with_fields) status = artefact_declare(file, "shear_stress_2", error);
    return status;
}

static ehd_status declare_scalars(artefact *file, ehd_error *error) {
    ehd_status status = declare_all(file, scalars, error);

    if (!status) status = artefact_declare(file, "exit_position", error);
    if (!status) status = artefact_declare(file, "status", error);
    return status;
}

static ehd_status declare_fields(artefact *file, ehd_error *error) {
    ehd_status status = artefact_declare(file, "pressure", error);

    if (!status) status = artefact_declare(file, "film_thickness", error);
    return status;
}

static ehd_status declare_restart(artefact *file, size_t restart_size, ehd_error *error) {
    ehd_status status = artefact_put_axis(file, "restart_slot", NUM_SLOTS, NULL, error);

    if (!status) status = artefact_put_axis(file, "restart_entry", restart_size, NULL, error);
    if (!status) status = artefact_declare_apart(file, "restart", error);
    if (!status) status = artefact_declare_apart(file, "restart_entries", error);
    return status;
}

ehd_status time_result_create(artefact **file, const program *caller, const ehd_contact *reference,
                              const char *settings_text, const char *const *inputs,
                              bool with_fields, bool with_all_exits, bool with_models,
                              size_t restart_size, ehd_error *error) {
    const ehd_grid whole = grid_whole(&reference->grid);
    ehd_status status = artefact_create_growing(file, caller->output, &schema_result, "time",
                                                caller, settings_text, inputs, error);

    if (!status) status = result_put_contact(*file, reference, error);
    // the exits of a point contact need the axis y
    if (!status && (with_fields || whole.inner_lines > 1))
        status = grid_write_axes(*file, &whole, error);
    if (!status && with_all_exits)
        status = artefact_put_axis(*file, "exit", GRID_EXITS, NULL, error);
    if (!status) status = declare_scalars(*file, error);
    if (!status && with_models) status = artefact_declare(*file, "by_full_model", error);
    if (!status && reference->surface) status = artefact_declare(*file, "surface_position", error);
    if (!status && with_fields) status = declare_fields(*file, error);
    if (!status && contact_has_traction(reference))
        status = declare_traction(*file, with_fields, error);
    if (!status && restart_size > 0) status = declare_restart(*file, restart_size, error);
    if (!status) status = artefact_begin_streaming(*file, error);
    if (status) artefact_close(file);
    return status;
}

// ---- entries

/* Writes all exits of each line, or the exit farthest downstream if the file has one exit per
 * line. */
static ehd_status put_exits(artefact *file, const time_entry *entries, size_t count,
                            size_t num_lines, size_t index, ehd_error *error) {
    const size_t each = artefact_length(file, "exit") > 0 ? GRID_EXITS : 1;
    double *exits = malloc((count * num_lines * each + 1) * sizeof *exits);

    if (!exits) return ehd_no_memory(error, artefact_path(file));
    for (size_t l = 0; l < count * num_lines; l++)
        memcpy(exits + l * each, entries[l / num_lines].exits + l % num_lines * GRID_EXITS,
               each * sizeof *exits);
    ehd_status status = artefact_put_part(file, "exit_position", index, count, exits, error);
    free(exits);
    return status;
}

static ehd_status put_scalars(artefact *file, const time_entry *entries, size_t count, size_t index,
                              int64_t *integers, size_t num_lines, ehd_error *error) {
    const size_t size = sizeof *entries;
    ehd_status status = columns_put(file, scalars, index, entries, size, count, error);

    if (!status && artefact_has(file, traction_columns->field))
        status = columns_put(file, traction_columns, index, &entries->traction, size, count, error);
    if (!status) status = put_exits(file, entries, count, num_lines, index, error);
    for (size_t i = 0; i < count; i++)
        integers[i] = result_stored_status(entries[i].status);
    if (!status) status = artefact_put_integers_part(file, "status", index, count, integers, error);
    for (size_t i = 0; i < count; i++)
        integers[i] = entries[i].by_full_model;
    if (!status && artefact_has(file, "by_full_model"))
        status = artefact_put_integers_part(file, "by_full_model", index, count, integers, error);
    if (!status && artefact_has(file, place.field))
        status = column_put(file, &place, index, entries, size, count, error);
    return status;
}

static ehd_status put_fields(artefact *file, const time_entry *entry, const ehd_grid *grid,
                             size_t index, ehd_error *error) {
    ehd_status status = EHD_OK;

    if (entry->pressure)
        status = grid_put_field(file, "pressure", index, entry->pressure, grid, true, error);
    if (!status && entry->film)
        status = grid_put_field(file, "film_thickness", index, entry->film, grid, true, error);
    if (!status && entry->pressure && entry->film && entry->frame)
        // the approach, in units of the frame, is needed only for the far field of a point contact
        status =
            traction_put_stresses(file, index, entry->frame, entry->pressure, entry->film,
                                  entry->scalars.rigid_approach / entry->frame_film_unit, error);
    return status;
}

ehd_status time_result_append(artefact *file, const ehd_grid *grid, const time_entry *entries,
                              size_t count, size_t index, ehd_error *error) {
    double *times = malloc((count + 1) * sizeof *times);
    int64_t *integers = malloc((count + 1) * sizeof *integers);
    ehd_status status = EHD_OK;

    if (!times || !integers) status = ehd_no_memory(error, artefact_path(file));
    for (size_t i = 0; i < count && !status; i++)
        status = put_fields(file, &entries[i], grid, index + i, error);
    if (!status)
        status =
            put_scalars(file, entries, count, index, integers, grid_whole(grid).inner_lines, error);
    for (size_t i = 0; i < count && !status; i++)
        times[i] = entries[i].time;
    if (!status) status = artefact_put_axis_part(file, "time", index, count, times, error);
    if (!status) status = artefact_flush(file, error);
    free(times);
    free(integers);
    return status;
}

// ---- restart slots

/* Reads the number of entries of each slot. A run that resumes from a slot continues after this
 * number of entries. A slot is invalid if a kill damaged its number. */
static ehd_status get_slots(int64_t num_entries[NUM_SLOTS], artefact *file, ehd_error *error) {
    ehd_status status = EHD_OK;

    for (size_t slot = 0; slot < NUM_SLOTS && !status; slot++) {
        status = artefact_get_integers_part(file, "restart_entries", slot, 1, &num_entries[slot], 1,
                                            error);
        if (status != EHD_DATA) continue;
        num_entries[slot] = SLOT_INVALID;
        status = EHD_OK;
    }
    return status;
}

ehd_status time_result_checkpoint(artefact *file, const double *restart, size_t num_entries,
                                  ehd_error *error) {
    const int64_t valid = (int64_t)num_entries;
    const int64_t invalid = SLOT_INVALID;
    int64_t found[NUM_SLOTS];
    ehd_status status = get_slots(found, file, error);
    if (status) return status;

    size_t slot = found[1] < found[0] ? 1 : 0; // the older slot
    status = artefact_put_integers_part(file, "restart_entries", slot, 1, &invalid, error);
    if (!status) status = artefact_put_part(file, "restart", slot, 1, restart, error);
    // the data must be on the disk before the number that makes them valid
    if (!status) status = artefact_sync(file, error);
    if (!status)
        status = artefact_put_integers_part(file, "restart_entries", slot, 1, &valid, error);
    if (!status) status = artefact_sync(file, error);
    if (!status) artefact_save(file);
    return status;
}

/* Checks that the earlier run had this grid and restart_size. Equal settings are not enough,
 * because the contact or other files may determine the grid. */
static ehd_status check_same_run(artefact *file, const ehd_contact *reference, size_t restart_size,
                                 ehd_error *error) {
    const size_t found = artefact_length(file, "restart_entry");
    const size_t slots = artefact_length(file, "restart_slot");
    stored_result run = {0};
    ehd_error cause = {""};
    ehd_status status = result_get_contact(&run, file, reference->kind, error);

    // a line contact without fields has no axis x; restart_size then shows another number of nodes
    if (run.num_inner == 0) run.num_inner = grid_whole(&reference->grid).num_inner;
    if (!status) status = result_check_grid(&run, "partial", &reference->grid, &cause);
    if (*cause.text) return ehd_fail(error, status, "%s.%s", artefact_path(file), cause.text);
    if (!status && found != restart_size)
        return ehd_fail(error, EHD_DATA,
                        "%s.partial: restart_entry: found length %zu, expected %zu",
                        artefact_path(file), found, restart_size);
    if (!status && restart_size > 0 && slots != NUM_SLOTS)
        return ehd_fail(error, EHD_DATA, "%s.partial: restart_slot: found length %zu, expected %d",
                        artefact_path(file), slots, (int)NUM_SLOTS);
    return status;
}

/* Reads the valid slot of the latest time. Fills `restart` with zeros if no slot is valid. */
static ehd_status get_restart(double *restart, size_t *num_entries, artefact *file,
                              size_t restart_size, ehd_error *error) {
    int64_t found[NUM_SLOTS];
    ehd_status status = get_slots(found, file, error);
    if (status) return status;

    size_t slot = found[1] > found[0] ? 1 : 0;
    memset(restart, 0, restart_size * sizeof *restart);
    if (found[slot] <= 0) return EHD_OK;
    *num_entries = (size_t)found[slot];
    return artefact_get_part(file, "restart", slot, 1, restart, restart_size, error);
}

ehd_status time_result_resume(artefact **file, double *restart, size_t *num_entries,
                              const program *caller, const ehd_contact *reference,
                              const char *settings_text, const char *const *models,
                              const scene *given, size_t restart_size, ehd_error *error) {
    *num_entries = 0;
    ehd_status status =
        artefact_resume(file, caller->output, &schema_result, caller, settings_text, error);

    // models are checked before sizes, because sizes also differ with another model
    for (size_t i = 0; models && models[i] && !status; i++)
        status = artefact_check_input(*file, "model", models[i], error);
    if (!status) status = inputs_check_tables(*file, given, error);
    if (!status) status = check_same_run(*file, reference, restart_size, error);
    if (!status && restart_size > 0)
        status = get_restart(restart, num_entries, *file, restart_size, error);
    if (!status) status = artefact_cut_axis(*file, "time", *num_entries, error);
    // the other slot may be half written. It is overwritten, since the finished file must be whole
    if (!status && restart_size > 0)
        status = time_result_checkpoint(*file, restart, *num_entries, error);
    if (status) artefact_close(file);
    return status;
}

// ---- finishing

static ehd_status put_summary(artefact *file, const time_summary *summary, ehd_error *error) {
    const bool with_models = artefact_has(file, "by_full_model");
    const named_number numbers[] = {{"steps", (double)summary->num_steps},
                                    {"rejected_steps", (double)summary->num_rejected},
                                    {"total_newton_iterations", (double)summary->newton_iterations},
                                    {"full_steps", with_models ? (double)summary->full_steps : NAN},
                                    {"full_seconds", with_models ? summary->seconds_full : NAN},
                                    {0}};

    return numbers_put_known(file, 0, numbers, error);
}

ehd_status time_result_finish(artefact **file, const time_summary *summary, ehd_error *error) {
    ehd_status status = artefact_end_streaming(*file, error);

    if (!status) status = result_put_seconds(*file, &summary->seconds, error);
    if (!status) status = put_summary(*file, summary, error);
    if (!status) return artefact_finish(file, error);
    artefact_close(file);
    return status;
}

// ---- reading

static double **series_array(time_series *series, size_t index) {
    return (double **)((char *)series + series_reals[index].offset);
}

static ehd_status allocate(time_series *series, const char *path, ehd_error *error) {
    series->time = arena_array(&series->memory, series->num_times, sizeof(double));
    for (size_t i = 0; i < NUM_SERIES_REALS; i++)
        *series_array(series, i) = arena_array(&series->memory, series->num_times, sizeof(double));
    return series->memory.failed ? ehd_no_memory(error, path) : EHD_OK;
}

static ehd_status get_time(time_series *series, artefact *file, ehd_error *error) {
    // the axis `time` of a stationary file need not have values
    if (series->num_times == 1 && !artefact_has_scale(file, "time")) return EHD_OK;
    ehd_status status = artefact_get_axis(file, "time", series->time, series->num_times, error);

    for (size_t i = 0; i < series->num_times && !status; i++) {
        double before = i > 0 ? series->time[i - 1] : -INFINITY;
        if (!(series->time[i] > before && isfinite(series->time[i])))
            status = ehd_fail(error, EHD_DATA, "%s: time: found %g as entry %zu, expected above %g",
                              artefact_path(file), series->time[i], i, before);
    }
    return status;
}

/* Reads a field with one number for each time. Sets NaN if the file lacks the field. */
static ehd_status get_real(double *values, size_t num_times, artefact *file, const char *name,
                           ehd_error *error) {
    for (size_t t = 0; t < num_times; t++)
        values[t] = NAN;
    return artefact_has(file, name) ? artefact_get(file, name, values, num_times, error) : EHD_OK;
}

static ehd_status get_series(time_series *series, artefact *file, const contact_kind *kind,
                             ehd_error *error) {
    stored_result contact = {0};
    ehd_status status = result_get_contact(&contact, file, kind, error);
    if (status) return status;

    series->grid = result_grid(&contact);
    series->moes_M = contact.moes_M;
    series->moes_L = contact.moes_L;
    series->alpha_p_H = contact.alpha_p_H;
    series->thinning = contact.thinning;
    series->hertz_pressure = contact.hertz_pressure;
    series->num_times = artefact_length(file, "time");
    status = allocate(series, artefact_path(file), error);
    if (!status) status = get_time(series, file, error);
    for (size_t i = 0; i < NUM_SERIES_REALS && !status; i++)
        status = get_real(*series_array(series, i), series->num_times, file, series_reals[i].name,
                          error);
    return status;
}

ehd_status time_series_read(time_series *series, const char *path, const contact_kind *kind,
                            ehd_error *error) {
    static const artefact_schema *const schemas[] = {&schema_result, NULL};
    artefact *file = NULL;

    memset(series, 0, sizeof *series);
    ehd_status status = artefact_open(&file, path, schemas, error);
    if (!status) status = get_series(series, file, kind, error);
    artefact_close(&file);
    return status;
}

void time_series_free(time_series *series) {
    arena_free(&series->memory);
    memset(series, 0, sizeof *series);
}
