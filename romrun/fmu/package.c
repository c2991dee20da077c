/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/fmu/package.h"

#include <errno.h>
#include <minizip/zip.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { PIECE = 1 << 16 };

static int by_name(const void *a, const void *b) {
    return strcmp(((const package_entry *)a)->name, ((const package_entry *)b)->name);
}

/* UTC, not in what zone the machine is. */
static zip_fileinfo info_at(time_t when) {
    zip_fileinfo info = {0};
    struct tm at = {.tm_mday = 1, .tm_year = 80};

    if (when > 0) gmtime_r(&when, &at);
    info.tmz_date.tm_sec = (uInt)at.tm_sec;
    info.tmz_date.tm_min = (uInt)at.tm_min;
    info.tmz_date.tm_hour = (uInt)at.tm_hour;
    info.tmz_date.tm_mday = (uInt)at.tm_mday;
    info.tmz_date.tm_mon = (uInt)at.tm_mon;
    info.tmz_date.tm_year = (uInt)(at.tm_year + 1900);
    info.external_fa = (uLong)(S_IFREG | 0644) << 16;
    return info;
}

static ehd_status write_failed(const char *name, ehd_error *error) {
    return ehd_fail(error, EHD_IO, "%s: found %s while packing it, expected to write it", name,
                    errno ? strerror(errno) : "a failure");
}

static ehd_status put_file(zipFile zip, const package_entry *entry, ehd_error *error) {
    char piece[PIECE];
    size_t count = 0;
    FILE *file = fopen(entry->path, "rbe");
    ehd_status status = EHD_OK;

    if (!file)
        return ehd_fail(error, EHD_NOINPUT, "%s: found %s, expected a file to pack", entry->path,
                        strerror(errno));
    while (!status && (count = fread(piece, 1, sizeof piece, file)) > 0)
        if (zipWriteInFileInZip(zip, piece, (unsigned)count) != ZIP_OK)
            status = write_failed(entry->name, error);
    if (!status && ferror(file))
        status = ehd_fail(error, EHD_IO, "%s: found %s, expected to read it", entry->path,
                          strerror(errno));
    fclose(file);
    return status;
}

static ehd_status put_entry(zipFile zip, const package_entry *entry, const zip_fileinfo *info,
                            ehd_error *error) {
    enum { MADE_BY_UNIX = 3 << 8 | 20 };

    errno = 0;
    if (zipOpenNewFileInZip4(zip, entry->name, info, NULL, 0, NULL, 0, NULL, Z_DEFLATED,
                             Z_DEFAULT_COMPRESSION, 0, -MAX_WBITS, DEF_MEM_LEVEL,
                             Z_DEFAULT_STRATEGY, NULL, 0, MADE_BY_UNIX, 0) != ZIP_OK)
        return write_failed(entry->name, error);
    ehd_status status = EHD_OK;
    if (entry->path)
        status = put_file(zip, entry, error);
    else if (entry->size > 0 &&
             zipWriteInFileInZip(zip, entry->bytes, (unsigned)entry->size) != ZIP_OK)
        status = write_failed(entry->name, error);
    if (zipCloseFileInZip(zip) != ZIP_OK && !status) status = write_failed(entry->name, error);
    return status;
}

ehd_status package_write(const char *path, package_entry *entries, size_t num_entries, time_t when,
                         bool force, ehd_error *error) {
    const zip_fileinfo info = info_at(when);
    char *partial = NULL;
    ehd_status status = EHD_OK;

    if (!force && access(path, F_OK) == 0)
        return ehd_fail(error, EHD_CANTCREATE,
                        "%s: found an existing file, expected none (or --force)", path);
    if (asprintf(&partial, "%s.partial", path) < 0)
        return ehd_fail(error, EHD_MEMORY, "%s: found no memory", path);
    errno = 0;
    zipFile zip = zipOpen(partial, APPEND_STATUS_CREATE);
    if (!zip) {
        status = ehd_fail(error, EHD_CANTCREATE, "%s: found %s, expected to create it", partial,
                          errno ? strerror(errno) : "a failure");
        free(partial);
        return status;
    }
    qsort(entries, num_entries, sizeof *entries, by_name);
    for (size_t i = 0; i < num_entries && !status; i++)
        status = put_entry(zip, &entries[i], &info, error);
    if (zipClose(zip, NULL) != ZIP_OK && !status) status = write_failed(path, error);
    if (!status && rename(partial, path) != 0) status = write_failed(path, error);
    if (status) unlink(partial);
    free(partial);
    return status;
}
