/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Handles the file under its provisional name: locks, copies, and the final name. */
#include "common/artefact/internal.h"
#include "common/program/output_file.h"

#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* Checks whether the open file still has this name. Another writer may have given the name to
 * another file. */
static bool has_name(int descriptor, const char *name) {
    struct stat opened, named;
    return fstat(descriptor, &opened) == 0 && stat(name, &named) == 0 &&
           opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
}

/* Opens the file and locks it against a second writer. The lock ends with the process. It does not
 * disturb readers, because HDF5 locks files for readers by flock, which is another kind of lock. On
 * a file system without locks, the file is not locked. */
static ehd_status open_locked(int *descriptor, const char *name, int flags, ehd_error *error) {
    *descriptor = open(name, O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK | flags, 0666);
    if (*descriptor < 0) {
        bool missing = errno == ENOENT && !(flags & O_CREAT);
        return ehd_fail(error, missing ? EHD_NOINPUT : EHD_CANTCREATE,
                        "%s: found %s, expected a writable file", name, strerror(errno));
    }
    struct stat found;
    if (fstat(*descriptor, &found) != 0 || !S_ISREG(found.st_mode))
        return ehd_fail(error, EHD_CANTCREATE, "%s: found no regular file, expected one or none",
                        name);
    struct flock whole = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
    const bool locked = fcntl(*descriptor, F_OFD_SETLK, &whole) == 0;
    if ((!locked && (errno == EAGAIN || errno == EACCES)) || !has_name(*descriptor, name))
        return ehd_fail(error, EHD_CANTCREATE,
                        "%s: found another process writing it, expected none", name);
    return EHD_OK;
}

// ---- the copy

bool has_begun(const artefact *file) {
    // by the HDF5 specification a file begins with its signature, its version, two sizes and the
    // consistency flags
    static const unsigned char signature[] = "\211HDF\r\n\032\n";
    enum { AT_FLAGS = 11, BEING_WRITTEN = 1, STREAMING = 4, NUM_BYTES = 12 };
    static const unsigned char none[NUM_BYTES] = {0};
    unsigned char found[NUM_BYTES] = {0};
    const ssize_t length = pread(file->lock, found, sizeof found, 0);

    // HDF5 writes these first bytes after other data, so the size of the file shows nothing
    if (length < 0 || memcmp(found, none, sizeof none) == 0) return false;
    return memcmp(found, signature, sizeof signature - 1) != 0 ||
           (found[AT_FLAGS] & (BEING_WRITTEN | STREAMING)) != BEING_WRITTEN;
}

const char *written_name(const artefact *file) {
    return file->on_copy ? file->copy : file->partial;
}

static bool copy_bytes(int to, int from) {
    enum { AT_ONCE = 1 << 24 };
    off_t place = 0;
    ssize_t copied;

    // on a file system that supports it, the copy shares its blocks on disk with the original
    while ((copied = copy_file_range(from, &place, to, NULL, AT_ONCE, 0)) > 0) {
    }
    return copied == 0;
}

/* Checks whether the machine has been rebooted since the file was written, so that its data may not
 * be on the disk. */
static bool is_from_before(int file) {
    struct timespec now, running;
    struct stat about;

    if (fstat(file, &about) != 0 || clock_gettime(CLOCK_REALTIME, &now) != 0 ||
        clock_gettime(CLOCK_BOOTTIME, &running) != 0)
        return false;
    return about.st_mtim.tv_sec < now.tv_sec - running.tv_sec;
}

ehd_status use_copy(artefact *file, ehd_error *error) {
    const int saved = is_from_before(file->lock)
                          ? open(file->saved, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK)
                          : -1;
    const int from = saved >= 0 ? saved : file->lock;
    ehd_status status = open_locked(&file->copy_lock, file->copy, O_CREAT, error);

    file->on_copy = status == EHD_OK;
    if (file->on_copy &&
        (ftruncate(file->copy_lock, 0) != 0 || !copy_bytes(file->copy_lock, from))) {
        status = ehd_fail(error, EHD_IO, "%s: found %s, expected a copy of %s", file->copy,
                          strerror(errno), saved >= 0 ? file->saved : file->partial);
        drop_copy(file);
    }
    if (saved >= 0) close(saved);
    return status;
}

/* Syncs the folder of the file after a renaming. A failure is not reported: the content is on disk,
 * so a power cut may only undo the renaming. */
static void sync_folder(const artefact *file) {
    char name[PATH_MAX];
    snprintf(name, sizeof name, "%s", file->path);
    const int folder = open(dirname(name), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (folder < 0) return;
    fsync(folder);
    close(folder);
}

void artefact_save(artefact *file) {
    enum { TIMES = 50 };
    const double now = program_seconds();
    if (!file->growing || now - file->saved_at < TIMES * file->save_seconds) return;

    const int to = open(file->copy, O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0666);
    const bool copied = to >= 0 && copy_bytes(to, file->lock) && fsync(to) == 0;
    if (to >= 0) close(to);
    if (!copied || rename(file->copy, file->saved) != 0) unlink(file->copy);
    sync_folder(file);
    file->saved_at = program_seconds();
    file->save_seconds = file->saved_at - now;
}

void drop_copy(artefact *file) {
    if (file->on_copy) unlink(file->copy);
    if (file->copy_lock >= 0) close(file->copy_lock);
    file->copy_lock = -1;
    file->on_copy = false;
}

ehd_status sync_file(const artefact *file, ehd_error *error) {
    if (fsync(file->on_copy ? file->copy_lock : file->lock) == 0 || errno == EINVAL) return EHD_OK;
    return ehd_fail(error, EHD_IO, "%s: found %s, expected it on disk", written_name(file),
                    strerror(errno));
}

ehd_status keep_copy(artefact *file, ehd_error *error) {
    if (rename(file->copy, file->partial) != 0)
        return ehd_fail(error, EHD_CANTCREATE, "%s: found %s, expected %s to get this name",
                        file->partial, strerror(errno), file->copy);
    close(file->lock);
    file->lock = file->copy_lock;
    file->copy_lock = -1;
    file->on_copy = false;
    return EHD_OK;
}

/* Files that --resume continues. If the dataset has an entry of at least `min`, a part of the work
 * is finished. */
static const struct {
    const artefact_schema *schema;
    const char *dataset;
    int64_t min;
    const char *finished;
} resumable[] = {{&schema_snapshots, "status", 0, "solved points"},
                 {&schema_result, "restart_entries", 1, "a restart slot"},
                 {&schema_cases, "status", 0, "solved cases"}};

bool is_finished_by_entry(const artefact *file, const artefact_field *field) {
    for (size_t i = 0; i < sizeof resumable / sizeof *resumable; i++) {
        if (resumable[i].schema != file->schema) continue;
        const artefact_field *finished = find_field(file, resumable[i].dataset);
        return strcmp(field->axes[0], finished->axes[0]) == 0;
    }
    return false;
}

bool is_kept_apart(const artefact *file, const artefact_field *field) {
    return field->axes[1] && is_finished_by_entry(file, field);
}

/* Checks whether an entry of the dataset is at least `min`. Reads one entry at a time, because a
 * killed writer leaves the entry that it was writing damaged. */
static bool has_entry(hid_t file, const char *name, int64_t min) {
    own_dataset about;
    if (!hdf5_has_dataset(file, name)) return false;
    const hid_t dataset = hdf5_open_own(&about, file, name);
    if (dataset < 0) return false;
    const hid_t space = H5Dget_space(dataset);
    const hid_t scalar = H5Screate(H5S_SCALAR);
    const bool is_list = H5Sget_simple_extent_ndims(space) == 1;
    const hssize_t count = is_list ? H5Sget_simple_extent_npoints(space) : 0;
    // reads no more entries than the file stores, because a damaged file may claim any number
    const hsize_t stored = H5Dget_storage_size(dataset) / sizeof(int64_t);
    bool found = false;

    for (hsize_t i = 0; i < (hsize_t)count && i < stored && !found; i++) {
        int64_t value = -1;
        H5Sselect_elements(space, H5S_SELECT_SET, 1, &i);
        found = H5Dread(dataset, H5T_NATIVE_INT64, scalar, space, H5P_DEFAULT, &value) >= 0 &&
                value >= min;
    }
    hdf5_release(scalar);
    hdf5_release(space);
    hdf5_release(dataset);
    return found;
}

/* Returns a text on what an interrupted run has finished in a file. NULL: it has finished
 * nothing. */
static const char *find_finished(const char *path) {
    const char *finished = NULL;
    // if a killed writer left its mark, HDF5 opens the file only in the mode for reading beside a
    // writer
    const hid_t partial = hdf5_open(path, H5F_ACC_RDONLY | H5F_ACC_SWMR_READ, true);
    char *kind = partial >= 0 ? hdf5_get_string(partial, "schema_name") : NULL;

    for (size_t i = 0; kind && i < sizeof resumable / sizeof *resumable; i++)
        if (strcmp(kind, resumable[i].schema->name) == 0 &&
            has_entry(partial, resumable[i].dataset, resumable[i].min))
            finished = resumable[i].finished;
    free(kind);
    hdf5_release(partial);
    return finished;
}

/* Refuses to replace the finished work of an interrupted run, or the copy of this work, except
 * with --force. If only the copy has finished work, removes the empty partial file that writer_new
 * has just made. */
static ehd_status check_unfinished(const artefact *file, ehd_error *error) {
    const char *finished = file->force ? NULL : find_finished(file->partial);
    const char *copied = file->force || finished ? NULL : find_finished(file->saved);
    struct stat about;

    if (copied && fstat(file->lock, &about) == 0 && about.st_size == 0) unlink(file->partial);
    if (finished)
        return ehd_fail(error, EHD_CANTCREATE,
                        "%s: found an interrupted run with %s, expected --resume to continue it or "
                        "--force to replace it",
                        file->partial, finished);
    if (copied)
        return ehd_fail(error, EHD_CANTCREATE,
                        "%s: found the copy of an interrupted run with %s: rename it to %s and use "
                        "--resume, or replace it with --force",
                        file->saved, copied, file->partial);
    return EHD_OK;
}

ehd_status writer_new(artefact **result, const char *path, const artefact_schema *schema,
                      const program *caller, int flags, ehd_error *error) {
    artefact *file = artefact_new(path);
    if (!file) goto no_memory;
    if (asprintf(&file->partial, "%s.partial", path) < 0) file->partial = NULL;
    if (asprintf(&file->copy, "%s.finishing", path) < 0) file->copy = NULL;
    if (asprintf(&file->saved, "%s.saved", path) < 0) file->saved = NULL;
    if (!file->partial || !file->copy || !file->saved) goto no_memory;
    if (!set_schema(file, schema)) goto no_memory;
    file->force = caller->force;

    ehd_status status = output_file_check(file->path, file->force, error);
    if (status == EHD_OK) status = open_locked(&file->lock, file->partial, flags, error);
    if (status == EHD_OK && flags & O_CREAT) status = check_unfinished(file, error);
    if (status == EHD_OK) unlink(file->copy); // left by a killed run
    if (status == EHD_OK && flags & O_CREAT) unlink(file->saved);
    if (status != EHD_OK) {
        artefact_delete(file);
        return status;
    }
    *result = file;
    return EHD_OK;

no_memory:
    artefact_delete(file);
    return ehd_no_memory(error, path);
}

ehd_status give_final_name(artefact *file, ehd_error *error) {
    ehd_status status = sync_file(file, error);
    if (status == EHD_OK) status = output_file_check(file->path, file->force, error);
    if (status != EHD_OK) return status;
    if (rename(written_name(file), file->path) != 0)
        return ehd_fail(error, EHD_CANTCREATE, "%s: found %s, expected %s to get this name",
                        file->path, strerror(errno), written_name(file));
    sync_folder(file);
    if (file->on_copy) unlink(file->partial);
    unlink(file->saved);
    file->on_copy = false;
    return EHD_OK;
}
