/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Holds functions for both reading and writing. */
#include "common/artefact/internal.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

artefact *artefact_new(const char *path) {
    hdf5_start();
    artefact *file = calloc(1, sizeof *file);
    if (!file) return NULL;
    file->id = -1;
    file->lock = file->copy_lock = -1;
    file->path = strdup(path);
    if (file->path) return file;
    free(file);
    return NULL;
}

void artefact_delete(artefact *file) {
    if (!file) return;
    if (file->id >= 0) H5Fclose(file->id);
    drop_copy(file);
    if (file->lock >= 0) close(file->lock);
    free(file->copy);
    free(file->saved);
    free(file->datasets);
    free(file->outcomes);
    free(file->digests);
    free(file->history_line);
    free(file->partial);
    free(file->path);
    free(file);
}

void artefact_close(artefact **file) {
    if (!*file) return;
    // an unfinished file is removed before its closing releases the writer's lock
    if ((*file)->partial && !(*file)->keep) {
        unlink((*file)->partial);
        unlink((*file)->saved);
    }
    artefact_delete(*file);
    *file = NULL;
}

const artefact_schema *artefact_kind(const artefact *file) {
    return file->schema;
}

const char *artefact_path(const artefact *file) {
    return file->path;
}

ehd_status artefact_identity(artefact *file, char identity[65], ehd_error *error) {
    return artefact_file_identity(identity, file->path, error);
}

const char *shown_name(const artefact *file) {
    return file->partial ? file->partial : file->path;
}

bool set_schema(artefact *file, const artefact_schema *schema) {
    size_t num_axes = 0, num_fields = 0;

    file->schema = schema;
    while (schema->axes[num_axes].name)
        num_axes++;
    while (schema->fields[num_fields].name)
        num_fields++;
    file->datasets = calloc(num_axes + num_fields + 1, sizeof *file->datasets);
    if (!file->datasets) return false;
    file->fields = file->datasets + num_axes;
    for (size_t i = 0; i < num_axes; i++) {
        const artefact_axis *axis = &schema->axes[i];
        file->datasets[i].field =
            (artefact_field){.name = axis->name, .type = ARTEFACT_REAL, .axes = {axis->name}};
        file->datasets[i].axis = axis;
    }
    for (size_t i = 0; i < num_fields; i++)
        file->fields[i].field = schema->fields[i];
    return true;
}

file_dataset *find_dataset(const artefact *file, const char *name) {
    for (file_dataset *of = file->datasets; of->field.name; of++)
        if (strcmp(of->field.name, name) == 0) return of;
    return NULL;
}

const artefact_field *find_field(const artefact *file, const char *name) {
    const file_dataset *found = find_dataset(file, name);
    return found && !found->axis ? &found->field : NULL;
}

const artefact_field *artefact_find(const artefact_field *list, const char *name) {
    return entry_find(list, sizeof *list, name);
}

const artefact_field *find_attribute(const artefact *file, const char *name) {
    return artefact_find(file->schema->attributes, name);
}

size_t artefact_axes(const char *axes[ARTEFACT_MAX_RANK], const artefact *file,
                     const artefact_field *field) {
    size_t rank = 0;
    for (size_t i = 0; i < ARTEFACT_MAX_RANK && field->axes[i]; i++) {
        const file_dataset *of = find_dataset(file, field->axes[i]);
        if (of->length > 0 || !of->axis->optional) axes[rank++] = field->axes[i];
    }
    return rank;
}

bool field_grows(const artefact *file, const artefact_field *field) {
    return file->growing && strcmp(field->axes[0], file->growing) == 0;
}

bool artefact_has(const artefact *file, const char *field_or_attribute) {
    hdf5_start();
    return hdf5_has_dataset(file->id, field_or_attribute) ||
           hdf5_has_attribute(file->id, field_or_attribute);
}

size_t artefact_length(const artefact *file, const char *axis) {
    const file_dataset *found = find_dataset(file, axis);
    return found ? found->length : 0;
}

/* Returns a pointer to the id of a dataset that stays open while streaming. Returns NULL if the
 * dataset does not stay open. */
static hid_t *held_dataset(const artefact *file, const char *name) {
    if (!file->growing || !file->streaming) return NULL;
    file_dataset *found = find_dataset(file, name);
    return found && field_grows(file, &found->field) ? &found->held : NULL;
}

bool field_exists(const artefact *file, const artefact_field *field) {
    if (!field->axes[0]) return hdf5_has_attribute(file->id, field->name);
    const hid_t *held = held_dataset(file, field->name);
    return (held && *held > 0) || hdf5_has_dataset(file->id, field->name);
}

hid_t open_dataset(artefact *file, const char *name) {
    hid_t *held = held_dataset(file, name);
    if (!held) return H5Dopen2(file->id, name, H5P_DEFAULT);
    if (*held <= 0) *held = H5Dopen2(file->id, name, H5P_DEFAULT);
    if (*held > 0) H5Iinc_ref(*held);
    return *held;
}

/* Reads the lengths of a dataset and their limits. Returns false on failure. */
static bool get_lengths(hsize_t dims[H5S_MAX_RANK], hsize_t max_dims[H5S_MAX_RANK], hid_t dataset) {
    const hid_t space = H5Dget_space(dataset);
    const bool got = H5Sget_simple_extent_dims(space, dims, max_dims) > 0;

    hdf5_release(space);
    return got;
}

size_t dataset_length(hid_t dataset) {
    hsize_t dims[H5S_MAX_RANK], max_dims[H5S_MAX_RANK];
    return get_lengths(dims, max_dims, dataset) ? (size_t)dims[0] : 0;
}

bool is_extendible(hid_t dataset) {
    hsize_t dims[H5S_MAX_RANK], max_dims[H5S_MAX_RANK];
    return get_lengths(dims, max_dims, dataset) && max_dims[0] == H5S_UNLIMITED;
}

bool set_dataset_length(hid_t dataset, size_t length) {
    hsize_t dims[H5S_MAX_RANK], max_dims[H5S_MAX_RANK];
    if (!get_lengths(dims, max_dims, dataset)) return false;
    dims[0] = length;
    return H5Dset_extent(dataset, dims) >= 0;
}

bool extend_dataset(hid_t dataset, size_t length) {
    return dataset_length(dataset) >= length || set_dataset_length(dataset, length);
}

/* Selects the entries in the dataspace of the dataset, and makes a dataspace of the same shape for
 * the memory. */
static bool select_entries(hid_t file_space, hid_t *memory_space, size_t first, size_t count) {
    hsize_t dims[ARTEFACT_MAX_RANK];
    hsize_t start[ARTEFACT_MAX_RANK] = {first};
    int rank = H5Sget_simple_extent_dims(file_space, dims, NULL);
    if (count == WHOLE_FIELD) count = dims[0];
    if (first > dims[0] || count > dims[0] - first) return false;
    dims[0] = count;
    H5Sselect_hyperslab(file_space, H5S_SELECT_SET, start, NULL, dims, NULL);
    *memory_space = H5Screate_simple(rank, dims, NULL);
    return *memory_space >= 0;
}

/* Entries of a dataset that are going to be read or written. */
typedef struct selection {
    hid_t dataset, file_space, memory_space;
} selection;

static void release_selection(selection *of) {
    hdf5_release(of->memory_space);
    hdf5_release(of->file_space);
    hdf5_release(of->dataset);
}

static ehd_status select_part(selection *of, artefact *file, const char *name, size_t first,
                              size_t count, ehd_error *error) {
    of->file_space = H5Dget_space(of->dataset);
    if (select_entries(of->file_space, &of->memory_space, first, count)) return EHD_OK;
    // in an unfinished or resumed file, a dataset may be shorter than its axis
    const bool foreign = (file->growing && !file->partial) || file->history_line;
    return ehd_fail(error, foreign ? EHD_DATA : EHD_INTERNAL,
                    "%s: %s: found entries %zu to %zu, expected fewer", shown_name(file), name,
                    first, first + count);
}

void wait_for_writer(void) {
    const struct timespec pause = {.tv_nsec = 10000000};

    nanosleep(&pause, NULL);
}

/* Reads the numbers of a selection. A process that writes the file may be rewriting their chunk,
 * whose checksum is then wrong. In a file that is open beside its writer, the chunk is read again
 * (test_time_result.c, a_chunk_that_is_rewritten_is_read_again). */
static bool read_selection(const artefact *file, const selection *of, artefact_type type,
                           void *data) {
    unsigned how = 0;
    const bool beside_writer = H5Fget_intent(file->id, &how) >= 0 && how & H5F_ACC_SWMR_READ;
    const int attempts = beside_writer ? WRITER_ATTEMPTS : 1;

    for (int i = 0; i < attempts; i++) {
        if (i > 0) wait_for_writer();
        if (H5Dread(of->dataset, hdf5_memory_type(type), of->memory_space, of->file_space,
                    H5P_DEFAULT, data) >= 0)
            return true;
    }
    return false;
}

ehd_status read_entries(artefact *file, const char *name, artefact_type type, size_t first,
                        size_t count, void *data, size_t room, ehd_error *error) {
    hdf5_start();
    selection of = {open_dataset(file, name), -1, -1};
    ehd_status status = of.dataset < 0 ? hdf5_read_failed(file, name, error)
                                       : select_part(&of, file, name, first, count, error);

    if (!status) {
        // the numbers are counted in the dataset itself, because the axes may have other lengths
        const hssize_t found = H5Sget_select_npoints(of.file_space);
        if (found < 0 || (size_t)found != room)
            status = ehd_fail(error, EHD_DATA, "%s: %s: found %lld numbers, expected %zu",
                              shown_name(file), name, (long long)found, room);
    }
    if (!status && !read_selection(file, &of, type, data))
        status = hdf5_read_failed(file, name, error);
    release_selection(&of);
    return status;
}

ehd_status write_entries(artefact *file, const char *name, artefact_type type, size_t first,
                         size_t count, const void *data, ehd_error *error) {
    hdf5_start();
    selection of = {open_dataset(file, name), -1, -1};
    const file_dataset *found = find_dataset(file, name);
    const bool may_grow = count != WHOLE_FIELD && found && field_grows(file, &found->field);
    ehd_status status = of.dataset < 0 ? hdf5_read_failed(file, name, error) : EHD_OK;

    if (!status && may_grow && !extend_dataset(of.dataset, first + count))
        status = hdf5_write_failed(file, name, error);
    if (!status) status = select_part(&of, file, name, first, count, error);
    if (!status && H5Dwrite(of.dataset, hdf5_memory_type(type), of.memory_space, of.file_space,
                            H5P_DEFAULT, data) < 0)
        status = hdf5_write_failed(file, name, error);
    release_selection(&of);
    return status;
}
