/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/fmu/package.h"

#include "common/program/output_file.h"

#include <errno.h>
#include <minizip/zip.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { PIECE = 1 << 16 };

static int by_name(const void *a, const void *b) {
    return strcmp(((const package_entry *)a)->name, ((const package_entry *)b)->name);
}

/* Returns the file information for the time `when`. The time is written in UTC, so that the zip
 * does not depend on the time zone of the machine. */
static zip_fileinfo info_at(time_t when) {
    zip_fileinfo info = {0};
    typedef __typeof__(info.tmz_date.tm_sec) number; // int from minizip 1.3 on, unsigned before
    struct tm at = {.tm_mday = 1, .tm_year = 80};

    if (when > 0) gmtime_r(&when, &at);
    info.tmz_date.tm_sec = (number)at.tm_sec;
    info.tmz_date.tm_min = (number)at.tm_min;
    info.tmz_date.tm_hour = (number)at.tm_hour;
    info.tmz_date.tm_mday = (number)at.tm_mday;
    info.tmz_date.tm_mon = (number)at.tm_mon;
    info.tmz_date.tm_year = (number)(at.tm_year + 1900);
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

// ---- the output stream, for minizip

static voidpf open_given(voidpf stream, const void *path, int mode) {
    (void)path, (void)mode;
    return stream;
}

static uLong read_nothing(voidpf given, voidpf stream, void *bytes, uLong size) {
    (void)given, (void)stream, (void)bytes, (void)size;
    return 0;
}

static uLong write_to(voidpf given, voidpf stream, const void *bytes, uLong size) {
    (void)given;
    return fwrite(bytes, 1, size, stream);
}

static ZPOS64_T tell_of(voidpf given, voidpf stream) {
    (void)given;
    return (ZPOS64_T)ftello(stream);
}

static long seek_in(voidpf given, voidpf stream, ZPOS64_T offset, int origin) {
    const int from[] = {[ZLIB_FILEFUNC_SEEK_SET] = SEEK_SET,
                        [ZLIB_FILEFUNC_SEEK_CUR] = SEEK_CUR,
                        [ZLIB_FILEFUNC_SEEK_END] = SEEK_END};
    (void)given;
    return fseeko(stream, (off_t)offset, from[origin]);
}

static int keep_open(voidpf given, voidpf stream) {
    (void)given, (void)stream;
    return 0;
}

static int error_of(voidpf given, voidpf stream) {
    (void)given;
    return ferror((FILE *)stream);
}

static ehd_status put_entries(FILE *stream, package_entry *entries, size_t num_entries, time_t when,
                              const char *path, ehd_error *error) {
    const zip_fileinfo info = info_at(when);
    zlib_filefunc64_def functions = {.zopen64_file = open_given,
                                     .zread_file = read_nothing,
                                     .zwrite_file = write_to,
                                     .ztell64_file = tell_of,
                                     .zseek64_file = seek_in,
                                     .zclose_file = keep_open,
                                     .zerror_file = error_of,
                                     .opaque = stream};
    zipFile zip = zipOpen2_64(path, APPEND_STATUS_CREATE, NULL, &functions);
    ehd_status status = zip ? EHD_OK : ehd_no_memory(error, path);

    qsort(entries, num_entries, sizeof *entries, by_name);
    for (size_t i = 0; i < num_entries && !status; i++)
        status = put_entry(zip, &entries[i], &info, error);
    if (zip && zipClose(zip, NULL) != ZIP_OK && !status) status = write_failed(path, error);
    return status;
}

ehd_status package_write(const char *path, package_entry *entries, size_t num_entries, time_t when,
                         bool force, ehd_error *error) {
    output_file out;
    ehd_status status = output_file_create(&out, path, force, error);
    if (status) return status;

    status = put_entries(out.stream, entries, num_entries, when, path, error);
    if (!status) return output_file_finish(&out, error);
    output_file_drop(&out);
    return status;
}
