/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/program/output_file.h"

#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

/* Checks whether a file can be created in the folder of `path`. */
static ehd_status check_folder(const char *path, ehd_error *error) {
    char *copy = strdup(path);

    if (!copy) return ehd_no_memory(error, path);
    const int cause = access(dirname(copy), W_OK | X_OK) == 0 ? 0 : errno;
    free(copy);
    if (!cause) return EHD_OK;
    return ehd_fail(error, EHD_CANTCREATE, "%s: found %s, expected to create it", path,
                    strerror(cause));
}

ehd_status output_file_check(const char *path, bool force, ehd_error *error) {
    struct stat found;

    if (lstat(path, &found) != 0) {
        if (errno == ENOENT) return check_folder(path, error);
        return ehd_fail(error, EHD_CANTCREATE, "%s: found %s, expected to create it", path,
                        strerror(errno));
    }
    if (S_ISLNK(found.st_mode) && stat(path, &found) != 0) found.st_mode = S_IFREG; // a dead link
    if (S_ISDIR(found.st_mode))
        return ehd_fail(error, EHD_CANTCREATE, "%s: found a folder, expected a file or none", path);
    if (!S_ISREG(found.st_mode)) // a rename would also replace a device
        return ehd_fail(error, EHD_CANTCREATE, "%s: found no regular file, expected one or none",
                        path);
    if (force) return check_folder(path, error);
    return ehd_fail(error, EHD_CANTCREATE, "%s: found an existing file, expected none (or --force)",
                    path);
}

ehd_status output_file_check_inputs(const char *path, const char *const *inputs, ehd_error *error) {
    struct stat output, input;

    if (!inputs || stat(path, &output) != 0) return EHD_OK;
    for (; *inputs; inputs++)
        if (stat(*inputs, &input) == 0 && input.st_dev == output.st_dev &&
            input.st_ino == output.st_ino)
            return ehd_fail(error, EHD_CANTCREATE,
                            "%s: found an input as output, expected another name", path);
    return EHD_OK;
}

/* Opens and locks a file for writing. Returns NULL with errno after a failure. EWOULDBLOCK: another
 * process writes the file. */
static FILE *open_partial(const char *path) {
    const int descriptor =
        open(path, O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
    FILE *stream = NULL;
    struct stat found;

    if (descriptor < 0) return NULL;
    if (flock(descriptor, LOCK_EX | LOCK_NB) == 0 && fstat(descriptor, &found) == 0) {
        errno = ENOTSUP;
        if (S_ISREG(found.st_mode)) stream = fdopen(descriptor, "w");
    }
    if (stream) return stream;
    const int cause = errno;
    close(descriptor);
    errno = cause;
    return NULL;
}

static void release(output_file *self) {
    free(self->path);
    free(self->partial);
    *self = (output_file){0};
}

ehd_status output_file_create(output_file *self, const char *path, bool force, ehd_error *error) {
    const ehd_status status = output_file_open(self, path, force, error);

    return status ? status : output_file_keep(self, 0, error);
}

ehd_status output_file_keep(output_file *self, size_t kept, ehd_error *error) {
    const int descriptor = fileno(self->stream);

    if (ftruncate(descriptor, (off_t)kept) == 0 && lseek(descriptor, (off_t)kept, SEEK_SET) >= 0)
        return EHD_OK;
    const ehd_status status = ehd_fail(error, EHD_IO, "%s: found %s, expected to write it",
                                       self->partial, strerror(errno));
    output_file_leave(self);
    return status;
}

ehd_status output_file_open(output_file *self, const char *path, bool force, ehd_error *error) {
    *self = (output_file){.path = strdup(path)};
    ehd_status status = output_file_check(path, force, error);

    if (!self->path || asprintf(&self->partial, "%s.partial", path) < 0) {
        self->partial = NULL;
        status = ehd_no_memory(error, path);
    }
    if (!status) {
        self->stream = open_partial(self->partial);
        if (!self->stream && errno == EWOULDBLOCK)
            status = ehd_fail(error, EHD_CANTCREATE,
                              "%s: found another process writing it, expected none", self->partial);
        else if (!self->stream)
            status =
                ehd_fail(error, errno == ENOMEM ? EHD_MEMORY : EHD_CANTCREATE,
                         "%s: found %s, expected to create it", self->partial, strerror(errno));
    }
    if (status) release(self);
    return status;
}

ehd_status output_file_finish(output_file *self, ehd_error *error) {
    ehd_status status = EHD_OK;

    const bool whole = ferror(self->stream) == 0 && fflush(self->stream) == 0 &&
                       fsync(fileno(self->stream)) == 0 && rename(self->partial, self->path) == 0;
    if (!whole) {
        status = ehd_fail(error, EHD_IO, "%s: found a failed write, expected the whole file",
                          self->path);
        output_file_drop(self);
        return status;
    }
    fclose(self->stream); // a failure loses nothing: fsync has written all data
    release(self);
    return EHD_OK;
}

void output_file_leave(output_file *self) {
    if (self->stream) fclose(self->stream);
    release(self);
}

void output_file_drop(output_file *self) {
    if (self->stream) {
        unlink(self->partial);
        fclose(self->stream);
    }
    release(self);
}
