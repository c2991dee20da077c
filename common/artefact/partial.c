/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The file under its provisional name: who may write it, and how it gets its final name. */
#include "common/artefact/internal.h"

#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* The final name must be free, or a regular file that may be replaced. */
static ehd_status check_final_name(const artefact *file, ehd_error *error) {
    struct stat found;
    if (stat(file->path, &found) != 0) return EHD_OK;
    if (!S_ISREG(found.st_mode)) {
        return ehd_fail(error, EHD_CANTCREATE, "%s: found no regular file, expected a file name",
                        file->path);
    }
    if (!file->force) {
        return ehd_fail(error, EHD_CANTCREATE,
                        "%s: found an existing file, expected none (or --force)", file->path);
    }
    return EHD_OK;
}

/* Excludes a second writer. This kind of lock does not disturb readers, which HDF5 lets use flock,
 * and it goes away with the process. Where a file system has no locks we go without. */
static ehd_status lock_partial(artefact *file, int flags, ehd_error *error) {
    file->lock = open(file->partial, O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK | flags, 0666);
    if (file->lock < 0) {
        bool missing = errno == ENOENT && !(flags & O_CREAT);
        return ehd_fail(error, missing ? EHD_NOINPUT : EHD_CANTCREATE,
                        "%s: found %s, expected a writable file", file->partial, strerror(errno));
    }
    struct stat found;
    if (fstat(file->lock, &found) != 0 || !S_ISREG(found.st_mode))
        return ehd_fail(error, EHD_CANTCREATE, "%s: found no regular file, expected one or none",
                        file->partial);
    struct flock whole = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
    if (fcntl(file->lock, F_OFD_SETLK, &whole) != 0 && (errno == EAGAIN || errno == EACCES)) {
        return ehd_fail(error, EHD_CANTCREATE,
                        "%s: found another process writing it, expected none", file->partial);
    }
    return EHD_OK;
}

/* What --resume continues: an entry of the dataset of at least `min` says that something is
 * finished. */
static const struct {
    const artefact_schema *schema;
    const char *dataset;
    int64_t min;
    const char *finished;
} resumable[] = {{&schema_snapshots, "status", 0, "solved points"},
                 {&schema_result, "restart_entries", 1, "a restart slot"}};

/* Whether an entry of the dataset is at least `min`. One by one, because a killed writer leaves the
 * entry that it was writing damaged. */
static bool has_entry(hid_t file, const char *name, int64_t min) {
    if (!hdf5_has_dataset(file, name) || hdf5_find_foreign(file, name)) return false;
    const hid_t dataset = H5Dopen2(file, name, H5P_DEFAULT), space = H5Dget_space(dataset);
    const hid_t scalar = H5Screate(H5S_SCALAR);
    const bool is_list = H5Sget_simple_extent_ndims(space) == 1;
    const hssize_t count = is_list ? H5Sget_simple_extent_npoints(space) : 0;
    bool found = false;

    for (hsize_t i = 0; i < (hsize_t)count && !found; i++) {
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

/* What an interrupted run has finished is not thrown away unasked. */
static ehd_status check_unfinished(const artefact *file, ehd_error *error) {
    const char *finished = NULL;

    if (file->force) return EHD_OK;
    // a reader beside a writer, because a killed writer did not sign off
    const hid_t partial = hdf5_open(file->partial, H5F_ACC_RDONLY | H5F_ACC_SWMR_READ, false);
    char *kind = partial >= 0 ? hdf5_get_string(partial, "schema_name") : NULL;
    for (size_t i = 0; kind && i < sizeof resumable / sizeof *resumable; i++)
        if (strcmp(kind, resumable[i].schema->name) == 0 &&
            has_entry(partial, resumable[i].dataset, resumable[i].min))
            finished = resumable[i].finished;
    free(kind);
    hdf5_release(partial);
    if (!finished) return EHD_OK;
    return ehd_fail(error, EHD_CANTCREATE,
                    "%s: found an interrupted run with %s, expected --resume to continue it or "
                    "--force to replace it",
                    file->partial, finished);
}

ehd_status writer_new(artefact **result, const char *path, const artefact_schema *schema,
                      const program *caller, int flags, ehd_error *error) {
    artefact *file = artefact_new(path);
    if (!file) goto no_memory;
    if (asprintf(&file->partial, "%s.partial", path) < 0) {
        file->partial = NULL;
        goto no_memory;
    }
    size_t num_axes = 0;
    while (schema->axes[num_axes].name)
        num_axes++;
    file->lengths = calloc(num_axes + 1, sizeof *file->lengths);
    size_t num_fields = 0;
    while (schema->fields[num_fields].name)
        num_fields++;
    file->held = calloc(num_fields + 1, sizeof *file->held);
    if (!file->lengths || !file->held) goto no_memory;
    file->schema = schema;
    file->force = caller->force;

    ehd_status status = check_final_name(file, error);
    if (status == EHD_OK) status = lock_partial(file, flags, error);
    if (status == EHD_OK && flags & O_CREAT) status = check_unfinished(file, error);
    if (status != EHD_OK) {
        artefact_delete(file);
        return status;
    }
    *result = file;
    return EHD_OK;

no_memory:
    artefact_delete(file);
    return ehd_fail(error, EHD_MEMORY, "%s: found too little memory, expected more", path);
}

static ehd_status sync_folder(const artefact *file, ehd_error *error) {
    char *copy = strdup(file->path);
    if (!copy) {
        return ehd_fail(error, EHD_MEMORY, "%s: found too little memory, expected more",
                        file->path);
    }
    ehd_status status = EHD_OK;
    int folder = open(dirname(copy), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    // EINVAL: a file system that has nothing to sync
    if (folder >= 0 && fsync(folder) != 0 && errno != EINVAL) {
        status = ehd_fail(error, EHD_IO, "%s: found %s, expected its folder on disk", file->path,
                          strerror(errno));
    }
    if (folder >= 0) close(folder);
    free(copy);
    return status;
}

ehd_status give_final_name(artefact *file, ehd_error *error) {
    if (fsync(file->lock) != 0 && errno != EINVAL) {
        return ehd_fail(error, EHD_IO, "%s: found %s, expected it on disk", file->partial,
                        strerror(errno));
    }
    ehd_status status = check_final_name(file, error);
    if (status != EHD_OK) return status;
    if (rename(file->partial, file->path) != 0) {
        return ehd_fail(error, EHD_CANTCREATE, "%s: found %s, expected %s to get this name",
                        file->path, strerror(errno), file->partial);
    }
    return sync_folder(file, error);
}
