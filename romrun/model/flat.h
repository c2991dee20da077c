/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes and reads flat files: blocks of numbers, stored as in memory (schemas/flat-model.md). Each
 * block has a name and a length, and begins at a multiple of 64 bytes. The reader maps the file
 * into memory. While a file is in use, another file may take its name, but no program may write
 * into the file itself.
 * The same sequence of calls writes and reads an object: each call below either writes the value of
 * its argument, or returns the value in the file.
 * Called by flat_model.c, by romrun/state, and by online_model.c and part.c in romrun/online. */
#ifndef EHD_FLAT_H
#define EHD_FLAT_H

#include "common/program/status.h"
#include <stdbool.h>
#include <stddef.h>

typedef struct flat {
    bool reading;
    const char *path; // path of the file, not owned
    unsigned char *bytes;
    size_t size, room; // number of bytes used, and of bytes allocated
    size_t at;         // offset of the next block, bytes
    ehd_status status; // first failure; calls after a failure do nothing
    ehd_error *error;
} flat;

/* Checks whether a file begins with the magic bytes of a flat file. Errors: EHD_NOINPUT, EHD_IO,
 * EHD_MEMORY. */
ehd_status flat_is(bool *is, const char *path, ehd_error *error);

/* Begin to write a file, or map an existing one. flat_read checks that the length of the file
 * equals the length in the header. It also checks the checksum, unless the environment variable
 * EHDROM_DIGEST is `no`. Errors: EHD_NOINPUT, EHD_DATA, EHD_IO, EHD_MEMORY. */
void flat_begin(flat *self, const char *path, ehd_error *error);
ehd_status flat_read(flat *self, const char *path, ehd_error *error);
/* Writes all blocks to the file, which gets its name only when it is complete. EHD_CANTCREATE: the
 * file exists, and `force` is false; EHD_IO. */
ehd_status flat_write(flat *self, bool force);
void flat_free(flat *self);

/* Write the next block or read it, depending on self->reading: a whole number from `least` to
 * `most`, a real number, or an array of `count` elements of `size` bytes. flat_array returns an
 * array that was read as a pointer into the mapped file; do not free it. After a failure flat_whole
 * returns `least`, flat_real returns 0, and flat_array returns NULL. */
size_t flat_whole(flat *self, const char *name, size_t value, size_t least, size_t most);
double flat_real(flat *self, const char *name, double value);
void *flat_array(flat *self, const char *name, void *array, size_t count, size_t size);
/* Like flat_array, for a table [rows, columns] of numbers. EHD_DATA: a number in the file is not
 * finite. */
double *flat_table(flat *self, const char *name, double *table, size_t rows, size_t columns);

/* Checks whether no call has failed so far. */
bool flat_good(const flat *self);
/* Records EHD_DATA with the file's path and a text, unless an earlier call has failed. */
void flat_refuse(flat *self, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* Records the failure `status`, whose text is already in `error`, unless an earlier call has
 * failed. EHD_OK: records nothing. */
void flat_fail(flat *self, ehd_status status);

#endif
