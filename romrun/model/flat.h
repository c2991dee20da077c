/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Flat files: blocks of numbers as memory has them, each with its name and length, at multiples of 64
 * bytes, which are mapped (schemas/flat-model.md): another file may take the name of one that is in
 * use, but it must not be written into. One walk over an object writes and reads it: what the
 * calls below are given is written, or replaced by what the file has. */
#ifndef EHD_FLAT_H
#define EHD_FLAT_H

#include "common/program/status.h"
#include <stdbool.h>
#include <stddef.h>

typedef struct flat {
    bool reading;
    const char *path; // the caller's
    unsigned char *bytes;
    size_t size, room; // bytes there are, and there is memory for
    size_t at;         // of the next block
    ehd_status status; // of the first call that failed; those after it do nothing
    ehd_error *error;
} flat;

/* Whether a file begins as one. EHD_NOINPUT, EHD_IO, EHD_MEMORY. */
ehd_status flat_is(bool *is, const char *path, ehd_error *error);

/* Begins to write, or maps a file: its length has to be the one that it tells, and its checksum
 * right, unless the environment's EHDROM_DIGEST is no. EHD_NOINPUT, EHD_DATA, EHD_IO, EHD_MEMORY. */
void flat_begin(flat *self, const char *path, ehd_error *error);
ehd_status flat_read(flat *self, const char *path, ehd_error *error);
/* Writes what was walked over, under its name when it is complete. EHD_CANTCREATE: exists, without
 * `force`; EHD_IO. */
ehd_status flat_write(flat *self, bool force);
void flat_free(flat *self);

/* A whole number from `least` to `most`, a number, and an array of `count` elements of `size` bytes,
 * which stays part of the flat file. Of a failed walk `least`, 0 and NULL. */
size_t flat_whole(flat *self, const char *name, size_t value, size_t least, size_t most);
double flat_real(flat *self, const char *name, double value);
void *flat_array(flat *self, const char *name, void *array, size_t count, size_t size);
/* The same of rows of finite numbers. */
double *flat_table(flat *self, const char *name, double *table, size_t rows, size_t columns);

/* Whether the walk has come to nothing that is wrong so far. */
bool flat_good(const flat *self);
/* EHD_DATA: the file's name and the text. */
void flat_refuse(flat *self, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* Any other failure on the way, whose text is there. */
void flat_fail(flat *self, ehd_status status);

#endif
