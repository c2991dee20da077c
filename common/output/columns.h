/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes members of structs, and lists of named numbers, as datasets of a file, and reads them. */
#ifndef EHD_COLUMNS_H
#define EHD_COLUMNS_H

#include "common/artefact/artefact.h"
#include <stdbool.h>
#include <stddef.h>

/* A member of a struct that is a dataset: one number, or several numbers at equal distances. The
 * numbers are double, or int64_t or size_t where the schema has integers. */
typedef struct column {
    const char *field; // name of the dataset
    size_t offset;     // bytes from the beginning of the struct to the first number
    size_t each;       // numbers in one struct
    size_t apart;      // bytes from one of these numbers to the next
    bool integer;      // as in the schema, which the library does not contain
    bool optional;     // readers accept files without the dataset
} column;

/* Return the columns of a member: a number or an array of numbers. */
#define COLUMN(type, name, member)                                                                 \
    .field = (name), .offset = offsetof(type, member),                                             \
    .each = sizeof(((type *)0)->member) / sizeof(double), .apart = sizeof(double)

/* Writes the columns of `count` structs of `size` bytes to the entries of the file from `first` on.
 * A column without an entry in the file is new. Errors: EHD_MEMORY, and those of artefact_put. */
ehd_status columns_put(artefact *file,
                       const column *columns, // ends with {0}
                       size_t first, const void *structs, size_t size, size_t count,
                       ehd_error *error);
ehd_status column_put(artefact *file, const column *self, size_t first, const void *structs,
                      size_t size, size_t count, ehd_error *error);

/* Reads whole columns. Members whose columns are optional and missing keep their values. Errors:
 * EHD_MEMORY, and those of artefact_get. */
ehd_status columns_get(void *structs, size_t size, size_t count,
                       const column *columns, // ends with {0}
                       artefact *file, ehd_error *error);
ehd_status column_get(void *structs, size_t size, size_t count, const column *self, artefact *file,
                      ehd_error *error);

/* Checks whether a file has all columns that are not optional. */
bool columns_are_in(const artefact *file, const column *columns);

/* A number and its name in a file: an attribute, or a field with one number for each entry. */
typedef struct named_number {
    const char *name;
    double value; // converted if the schema has an integer
} named_number;

/* Writes attributes, and entry `entry` of fields. Errors: as artefact_put. */
ehd_status numbers_put(artefact *file, size_t entry,
                       const named_number *numbers, // ends with {0}
                       ehd_error *error);

/* Writes the numbers that are not NaN. */
ehd_status numbers_put_known(artefact *file, size_t entry,
                             const named_number *numbers, // ends with {0}
                             ehd_error *error);

#endif
