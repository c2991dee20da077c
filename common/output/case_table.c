/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/output/case_table.h"

#include "common/artefact/table.h"
#include "common/output/grid_file.h"
#include "common/output/print.h"
#include "common/physics/inlet_heating.h"
#include "common/program/arena.h"
#include "common/program/output_file.h"

#include <inttypes.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* The columns; units and scales are those of the schema's rows. */
static const struct {
    const char *name;
    size_t offset; // in case_row; of an integer where the schema says so
} columns[] = {
#define COLUMN(name)                                                                               \
    { #name, offsetof(case_row, name) }
    COLUMN(status),
    COLUMN(moes_M),
    COLUMN(moes_L),
    COLUMN(alpha_p_H),
    COLUMN(hertz_pressure),
    COLUMN(half_width),
    COLUMN(film_unit),
    {"line_load", offsetof(case_row, load)},
    {"point_load", offsetof(case_row, load)},
    COLUMN(radius),
    COLUMN(speed),
    COLUMN(thermal_loading),
    COLUMN(inlet_heating_factor),
    COLUMN(central_film_thickness),
    COLUMN(minimum_film_thickness),
    COLUMN(central_pressure),
    COLUMN(peak_pressure),
    COLUMN(rigid_approach),
    COLUMN(exit_position),
    COLUMN(indicated_deviation),
    COLUMN(indicated_deviation_minimum),
    COLUMN(friction_coefficient),
    {"line_friction_force", offsetof(case_row, friction_force)},
    {"point_friction_force", offsetof(case_row, friction_force)},
    {"line_power_loss", offsetof(case_row, power_loss)},
    {"point_power_loss", offsetof(case_row, power_loss)},
    {"line_rolling_resistance", offsetof(case_row, rolling_resistance)},
    {"point_rolling_resistance", offsetof(case_row, rolling_resistance)},
    {"line_rolling_moment", offsetof(case_row, rolling_moment)},
    {"point_rolling_moment", offsetof(case_row, rolling_moment)},
    COLUMN(mean_shear_stress),
    COLUMN(largest_shear_stress),
    COLUMN(indicated_deviation_friction),
    COLUMN(part),
    COLUMN(newton_iterations),
    COLUMN(residual_norm),
    COLUMN(solve_seconds)};

enum { NUM_COLUMNS = sizeof columns / sizeof *columns, NOT_WRITTEN = -1 };

case_row case_row_of(const ehd_contact *contact) {
    const inlet_heating heating = inlet_heating_of(contact);

    return (case_row){.part = NO_PART,
                      .moes_M = contact->moes_M,
                      .moes_L = contact->moes_L,
                      .alpha_p_H = contact->alpha_p_H,
                      .hertz_pressure = contact->hertz_pressure,
                      .half_width = contact->half_width,
                      .film_unit = contact_film_scale(contact),
                      .load = contact->load,
                      .radius = contact->radius,
                      .speed = contact->speed,
                      .thermal_loading = heating.loading,
                      .inlet_heating_factor = heating.factor,
                      .central_film_thickness = NAN,
                      .minimum_film_thickness = NAN,
                      .central_pressure = NAN,
                      .peak_pressure = NAN,
                      .rigid_approach = NAN,
                      .exit_position = NAN,
                      .indicated_deviation = NAN,
                      .indicated_deviation_minimum = NAN,
                      .friction_coefficient = NAN,
                      .indicated_deviation_friction = NAN,
                      .friction_force = NAN,
                      .power_loss = NAN,
                      .rolling_resistance = NAN,
                      .rolling_moment = NAN,
                      .mean_shear_stress = NAN,
                      .largest_shear_stress = NAN,
                      .residual_norm = NAN,
                      .solve_seconds = NAN};
}

static bool is_csv(const char *path) {
    const char *ending = strrchr(path, '.');

    return ending && strcmp(ending, ".csv") == 0;
}

ehd_status case_table_check(const program *caller, ehd_error *error) {
    const char *path = caller->output;

    if (!path) return EHD_OK;
    if (!is_csv(path) && !artefact_is_table(path))
        return ehd_fail(error, EHD_USAGE, "--output: found %s, expected NAME.csv or NAME.h5", path);
    return output_file_check(path, caller->force, error);
}

// ---- which columns

static const artefact_field *field_of(size_t column) {
    const artefact_field *field = schema_cases.fields;

    while (strcmp(field->name, columns[column].name) != 0)
        field++;
    return field;
}

static double real_of(const case_row *row, size_t column) {
    double value;

    memcpy(&value, (const char *)row + columns[column].offset, sizeof value);
    return value;
}

static int64_t integer_of(const case_row *row, size_t column) {
    int64_t value;

    memcpy(&value, (const char *)row + columns[column].offset, sizeof value);
    return value;
}

/* Whether a column that is only there where it applies says anything of a row, and is of this kind of
 * contact. */
static bool applies(size_t column, const case_row *rows, size_t count, const contact_kind *kind) {
    const char *other = kind->dimensions > 1 ? "line_" : "point_";
    bool any = false;

    if (field_of(column)->need != NEED_OPTIONAL) return true;
    for (size_t i = 0; i < count && !any; i++)
        any = field_of(column)->type == ARTEFACT_INTEGER ? integer_of(&rows[i], column) != NO_PART
                                                         : !isnan(real_of(&rows[i], column));
    return any && strncmp(columns[column].name, other, strlen(other)) != 0;
}

/* The column that holds a column's unit; NOT_WRITTEN: it has none, or that one is not written. */
static int unit_of(size_t column, const bool *written) {
    const artefact_scale *scale = field_of(column)->scale;

    for (size_t c = 0; scale && c < NUM_COLUMNS; c++)
        if (written[c] && strcmp(columns[c].name, scale->frame) == 0) return (int)c;
    return NOT_WRITTEN;
}

// ---- CSV

typedef struct csv_table {
    const case_list *list;
    bool written[NUM_COLUMNS];
    int units[NUM_COLUMNS]; // unit_of
} csv_table;

static void print_header(const csv_table *self, FILE *stream) {
    for (size_t c = 0; c < case_list_num_columns(self->list); c++)
        fprintf(stream, "%s,", case_list_key(self->list, c));
    for (size_t c = 0; c < NUM_COLUMNS; c++) {
        const char *units = field_of(c)->units;
        if (!self->written[c]) continue;
        fputs(columns[c].name, stream);
        if (strcmp(units, "1") != 0) fprintf(stream, " [%s]", units);
        fputc(',', stream);
    }
    for (size_t c = 0; c < NUM_COLUMNS; c++)
        if (self->units[c] != NOT_WRITTEN)
            fprintf(stream, "%s [%s],", columns[c].name, field_of((size_t)self->units[c])->units);
    fputs("reason\n", stream);
}

static void print_row(const csv_table *self, const case_row *row, size_t index, FILE *stream) {
    for (size_t c = 0; c < case_list_num_columns(self->list); c++) {
        print_csv_text(case_list_text(self->list, c, index), stream);
        fputc(',', stream);
    }
    for (size_t c = 0; c < NUM_COLUMNS; c++) {
        if (!self->written[c]) continue;
        if (field_of(c)->type == ARTEFACT_INTEGER)
            fprintf(stream, "%" PRId64, integer_of(row, c));
        else
            print_csv_real(real_of(row, c), stream);
        fputc(',', stream);
    }
    for (size_t c = 0; c < NUM_COLUMNS; c++) {
        if (self->units[c] == NOT_WRITTEN) continue;
        print_csv_real(real_of(row, c) * real_of(row, (size_t)self->units[c]), stream);
        fputc(',', stream);
    }
    print_csv_text(row->reason, stream);
    fputc('\n', stream);
}

static void print_rows(const case_row *rows, const case_list *list, const contact_kind *kind,
                       FILE *stream) {
    const size_t count = case_list_count(list);
    csv_table self = {.list = list};

    for (size_t c = 0; c < NUM_COLUMNS; c++)
        self.written[c] = applies(c, rows, count, kind);
    for (size_t c = 0; c < NUM_COLUMNS; c++)
        self.units[c] = unit_of(c, self.written);
    print_header(&self, stream);
    for (size_t i = 0; i < count; i++)
        print_row(&self, &rows[i], i, stream);
}

static ehd_status write_csv(const case_row *rows, const case_list *list, const contact_kind *kind,
                            const program *caller, ehd_error *error) {
    output_file out;
    ehd_status status = output_file_create(&out, caller->output, caller->force, error);
    if (status) return status;

    print_rows(rows, list, kind, out.stream);
    return output_file_finish(&out, error);
}

// ---- HDF5

static ehd_status put_column(artefact *file, size_t column, const case_row *rows, size_t count,
                             void *work, ehd_error *error) {
    const char *name = columns[column].name;

    if (field_of(column)->type == ARTEFACT_INTEGER) {
        for (size_t i = 0; i < count; i++)
            ((int64_t *)work)[i] = integer_of(&rows[i], column);
        return artefact_put_integers(file, name, work, error);
    }
    for (size_t i = 0; i < count; i++)
        ((double *)work)[i] = real_of(&rows[i], column);
    return artefact_put(file, name, work, error);
}

static ehd_status put_columns(artefact *file, const case_row *rows, size_t count,
                              const contact_kind *kind, ehd_error *error) {
    double *work = array_new(count, 1, sizeof *work); // or as many integers
    ehd_status status = work ? EHD_OK
                             : ehd_fail(error, EHD_MEMORY, "%s: found no memory for %zu cases",
                                        artefact_path(file), count);

    for (size_t c = 0; c < NUM_COLUMNS && !status; c++)
        if (applies(c, rows, count, kind)) status = put_column(file, c, rows, count, work, error);
    free(work);
    return status;
}

static ehd_status write_hdf5(const case_row *rows, size_t count, const contact_kind *kind,
                             const ehd_grid *grid, const program *caller, const char *settings_text,
                             const char *const *inputs, ehd_error *error) {
    artefact *file = NULL;
    ehd_status status =
        artefact_create(&file, caller->output, &schema_cases, caller, settings_text, inputs, error);

    if (!status) status = grid_write_attributes(file, kind, grid, error);
    if (!status) status = artefact_put_axis(file, "case", count, NULL, error);
    if (!status) status = put_columns(file, rows, count, kind, error);
    if (!status) return artefact_finish(&file, error);
    artefact_close(&file);
    return status;
}

ehd_status case_table_write(const case_row *rows, const case_list *list, const contact_kind *kind,
                            const ehd_grid *grid, const program *caller, const char *settings_text,
                            const char *const *inputs, ehd_error *error) {
    if (caller->output && !is_csv(caller->output))
        return write_hdf5(rows, case_list_count(list), kind, grid, caller, settings_text, inputs,
                          error);
    if (caller->output) return write_csv(rows, list, kind, caller, error);
    print_rows(rows, list, kind, stdout); // program_finish says where that fails
    return EHD_OK;
}
