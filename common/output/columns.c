/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/output/columns.h"

#include "common/program/arena.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { NUMBER = 8 }; // bytes of a number
_Static_assert(sizeof(double) == NUMBER && sizeof(size_t) == NUMBER, "numbers have 8 bytes");

/* Returns the place of number i in a struct. */
static size_t place_of(const column *self, size_t i) {
    return self->offset + i * self->apart;
}

ehd_status column_put(artefact *file, const column *self, size_t first, const void *structs,
                      size_t size, size_t count, ehd_error *error) {
    char *values = array_new(count, self->each, NUMBER), *value = values;
    if (!values) return ehd_no_memory(error, artefact_path(file));

    for (size_t s = 0; s < count; s++)
        for (size_t i = 0; i < self->each; i++, value += NUMBER)
            memcpy(value, (const char *)structs + s * size + place_of(self, i), NUMBER);
    void *numbers = values;
    const ehd_status status =
        self->integer ? artefact_put_integers_part(file, self->field, first, count, numbers, error)
                      : artefact_put_part(file, self->field, first, count, numbers, error);
    free(values);
    return status;
}

ehd_status columns_put(artefact *file, const column *columns, size_t first, const void *structs,
                       size_t size, size_t count, ehd_error *error) {
    ehd_status status = EHD_OK;

    for (; columns->field && !status; columns++)
        status = column_put(file, columns, first, structs, size, count, error);
    return status;
}

ehd_status column_get(void *structs, size_t size, size_t count, const column *self, artefact *file,
                      ehd_error *error) {
    char *values = array_new(count, self->each, NUMBER), *value = values;
    if (!values) return ehd_no_memory(error, artefact_path(file));

    void *numbers = values;
    const size_t room = count * self->each;
    const ehd_status status = self->integer
                                  ? artefact_get_integers(file, self->field, numbers, room, error)
                                  : artefact_get(file, self->field, numbers, room, error);
    for (size_t s = 0; s < count && !status; s++)
        for (size_t i = 0; i < self->each; i++, value += NUMBER)
            memcpy((char *)structs + s * size + place_of(self, i), value, NUMBER);
    free(values);
    return status;
}

ehd_status columns_get(void *structs, size_t size, size_t count, const column *columns,
                       artefact *file, ehd_error *error) {
    ehd_status status = EHD_OK;

    for (; columns->field && !status; columns++)
        if (!columns->optional || artefact_has(file, columns->field))
            status = column_get(structs, size, count, columns, file, error);
    return status;
}

bool columns_are_in(const artefact *file, const column *columns) {
    bool all = true;

    for (; columns->field; columns++)
        all = all && (columns->optional || artefact_has(file, columns->field));
    return all;
}

// ---- named numbers

static ehd_status put_entry(artefact *file, size_t entry, const named_number *number,
                            ehd_error *error) {
    const artefact_field *field = artefact_find(artefact_kind(file)->fields, number->name);

    if (!field || field->type == ARTEFACT_REAL)
        return artefact_put_part(file, number->name, entry, 1, &number->value, error);
    const int64_t integer = (int64_t)number->value;
    return artefact_put_integers_part(file, number->name, entry, 1, &integer, error);
}

static ehd_status put_number(artefact *file, size_t entry, const named_number *number,
                             ehd_error *error) {
    const artefact_field *attribute = artefact_find(artefact_kind(file)->attributes, number->name);

    if (!attribute) return put_entry(file, entry, number, error);
    return attribute->type == ARTEFACT_INTEGER
               ? artefact_put_integer(file, number->name, (int64_t)number->value, error)
               : artefact_put_real(file, number->name, number->value, error);
}

ehd_status numbers_put(artefact *file, size_t entry, const named_number *numbers,
                       ehd_error *error) {
    ehd_status status = EHD_OK;

    for (; numbers->name && !status; numbers++)
        status = put_number(file, entry, numbers, error);
    return status;
}

ehd_status numbers_put_known(artefact *file, size_t entry, const named_number *numbers,
                             ehd_error *error) {
    ehd_status status = EHD_OK;

    for (; numbers->name && !status; numbers++)
        if (!isnan(numbers->value)) status = put_number(file, entry, numbers, error);
    return status;
}
