/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "deimselect/given_rows.h"

#include "common/artefact/table.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

void given_rows_free(given_rows *self) {
    free(self->rows);
    free(self->factors);
    *self = (given_rows){0};
}

/* Converts numbers to row indices. Fails if a number is not the index of an inner node, or occurs
 * twice. `taken`: [num_inner] work array, all false. */
static ehd_status convert_rows(given_rows *self, const double *numbers, const char *path,
                               size_t num_inner, bool *taken, ehd_error *error) {
    for (size_t i = 0; i < self->count; i++) {
        const double number = numbers[i];
        if (!(number >= 0 && number < (double)num_inner && number == floor(number)))
            return ehd_fail(error, EHD_DATA,
                            "%s: row: found %g as entry %zu, expected a whole number from 0 to %zu",
                            path, number, i + 1, num_inner - 1);
        self->rows[i] = (size_t)number;
        if (taken[self->rows[i]])
            return ehd_fail(error, EHD_DATA,
                            "%s: row: found %zu again as entry %zu, expected each row once", path,
                            self->rows[i], i + 1);
        taken[self->rows[i]] = true;
    }
    return EHD_OK;
}

static ehd_status check_factors(const given_rows *self, const char *path, ehd_error *error) {
    for (size_t i = 0; i < self->count && self->factors; i++)
        if (!(self->factors[i] > 0 && isfinite(self->factors[i])))
            return ehd_fail(error, EHD_DATA,
                            "%s: weight: found %g as entry %zu, expected a positive finite number",
                            path, self->factors[i], i + 1);
    return EHD_OK;
}

ehd_status given_rows_read(given_rows *self, const char *path, const reduced_basis *basis,
                           ehd_error *error) {
    static const char *const row_names[] = {"selected_row", "row", "rows", NULL};
    static const char *const factor_names[] = {"row_factor", "weight", "weights", NULL};
    table_column columns[] = {{.names = row_names}, {.names = factor_names, .optional = true}};
    const size_t num_inner = basis->grid.num_inner;
    bool *taken = NULL;

    *self = (given_rows){0};
    ehd_status status = table_read(path, columns, 2, &self->count, error);
    for (size_t c = 0; c < 2 && !status; c++)
        if (*columns[c].unit)
            status = ehd_fail(error, EHD_DATA, "%s: found the unit %s, expected no unit", path,
                              columns[c].unit);
    self->factors = columns[1].values;
    if (!status)
        status = reduced_check_num_rows(self->count, basis->num_pressure, basis->num_deformation,
                                        path, error);
    if (!status) {
        self->rows = malloc((self->count + 1) * sizeof *self->rows);
        taken = calloc(num_inner, sizeof *taken);
        if (!self->rows || !taken) status = ehd_no_memory(error, path);
    }
    if (!status) status = convert_rows(self, columns[0].values, path, num_inner, taken, error);
    if (!status) status = check_factors(self, path, error);
    free(taken);
    free(columns[0].values);
    if (status) given_rows_free(self);
    return status;
}
