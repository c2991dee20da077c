/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes axes, fields and attributes. */
#include "common/artefact/internal.h"
#include "common/program/output_file.h"

#include <fcntl.h>
#include <hdf5_hl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// Several scalars share a chunk. A large entry of a field is divided into several chunks.
enum { CHUNK_MIN_BYTES = 8192, CHUNK_MAX_BYTES = 1 << 20 };

// Chunk size of fields that are written entry by entry: two chunks with their checksums fill a
// page. Chunks are small, because writing an entry rewrites a whole chunk. A chunk lies within a
// page, because a kill during this write must not damage earlier entries in the same chunk.
enum { CHUNK_PAGE_BYTES = HDF5_PAGE_BYTES / 2 - 4 };

typedef enum layout {
    LAYOUT_PLAIN,
    LAYOUT_EARLY, // space is allocated and filled at once, so that later writes change no metadata;
                  // a chunk larger than a page has one entry
    LAYOUT_APART, // like LAYOUT_EARLY, and each entry of the first axis is one chunk
    LAYOUT_GROWING // the first axis is unlimited; space is allocated when entries are written
} layout;

// ---- the file

ehd_status artefact_create(artefact **result, const char *path, const artefact_schema *schema,
                           const program *caller, const char *settings_text,
                           const char *const *inputs, ehd_error *error) {
    *result = NULL;
    artefact *file = NULL;
    ehd_status status = output_file_check_inputs(path, inputs, error);
    if (status == EHD_OK) status = writer_new(&file, path, schema, caller, O_CREAT, error);
    if (status != EHD_OK) return status;

    file->id = hdf5_create(file->partial);
    if (file->id < 0) {
        // writer_new has checked that the file may be created
        hdf5_reason reason = hdf5_last_reason();
        status = ehd_fail(error, reason.system ? EHD_IO : EHD_CANTCREATE,
                          "%s: found %s, expected a file that can be created", file->partial,
                          reason.text);
    } else {
        status = put_provenance(file, caller, settings_text, inputs, error);
    }
    status = hdf5_blame(status, path, error);
    if (status != EHD_OK) artefact_close(&file);
    *result = file;
    return status;
}

// ---- axes and fields

static hsize_t entries_of_chunk(hsize_t length, hsize_t entry_bytes, int rank, layout kind) {
    const hsize_t bytes = kind == LAYOUT_PLAIN ? CHUNK_MIN_BYTES : CHUNK_PAGE_BYTES;
    if (kind == LAYOUT_APART || (kind == LAYOUT_GROWING && rank > 1)) return 1;
    const hsize_t entries = entry_bytes < bytes ? bytes / entry_bytes : 1;
    return kind == LAYOUT_GROWING || entries < length ? entries : length;
}

/* Chooses the shape of a chunk. Divides an entry that is too large for one chunk. */
static void choose_chunks(hsize_t *chunk, const hsize_t *dims, int rank, layout kind) {
    hsize_t entry = 8;
    for (int i = 1; i < rank; i++)
        entry *= dims[i];
    // NOLINTNEXTLINE(clang-analyzer-core.CallAndMessage): every field has an axis
    chunk[0] = entries_of_chunk(dims[0], entry, rank, kind);
    for (int i = 1; i < rank; i++)
        chunk[i] = dims[i];
    if (kind == LAYOUT_APART) return; // whole chunks are overwritten without being read
    for (int i = 1; i < rank && entry > CHUNK_MAX_BYTES; i++) {
        hsize_t row = entry / chunk[i];
        hsize_t fit = CHUNK_MAX_BYTES / row;
        hsize_t pieces = fit > 0 ? (chunk[i] + fit - 1) / fit : chunk[i];
        chunk[i] = (chunk[i] + pieces - 1) / pieces; // pieces of about equal size
        entry = row * chunk[i];
    }
}

/* Sets the properties of a dataset. Returns false if there is no memory for a property, because the
 * file would then have another layout. */
static bool set_properties(hid_t properties, bool integer, const hsize_t *chunk, int rank,
                           bool early) {
    const double no_real = NAN;
    const int64_t no_integer = -1;
    const H5D_alloc_time_t time = early ? H5D_ALLOC_TIME_EARLY : H5D_ALLOC_TIME_INCR;

    return H5Pset_chunk(properties, rank, chunk) >= 0 && H5Pset_fletcher32(properties) >= 0 &&
           H5Pset_attr_phase_change(properties, 65535, 0) >= 0 &&
           H5Pset_alloc_time(properties, time) >= 0 &&
           (integer ? H5Pset_fill_value(properties, H5T_NATIVE_INT64, &no_integer)
                    : H5Pset_fill_value(properties, H5T_NATIVE_DOUBLE, &no_real)) >= 0;
}

static hid_t create_dataset(hid_t root, const char *name, bool integer, const hsize_t *dims,
                            int rank, layout kind) {
    hid_t type = integer ? H5T_STD_I64LE : H5T_IEEE_F64LE;
    const bool early = kind == LAYOUT_EARLY || kind == LAYOUT_APART;
    hsize_t chunk[ARTEFACT_MAX_RANK];
    hsize_t max_dims[ARTEFACT_MAX_RANK];
    choose_chunks(chunk, dims, rank, kind);
    memcpy(max_dims, dims, (size_t)rank * sizeof *max_dims);
    if (kind == LAYOUT_GROWING) max_dims[0] = H5S_UNLIMITED;

    hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
    hid_t space = H5Screate_simple(rank, dims, max_dims);
    hid_t dataset = -1;
    if (set_properties(properties, integer, chunk, rank, early))
        dataset = H5Dcreate2(root, name, type, space, H5P_DEFAULT, properties, H5P_DEFAULT);
    hdf5_release(space);
    hdf5_release(properties);
    return dataset;
}

static bool describe(hid_t dataset, const char *units, const char *long_name) {
    return hdf5_put_string(dataset, "units", units) &&
           hdf5_put_string(dataset, "long_name", long_name);
}

/* Creates a scale without values. */
static bool create_scale(hid_t *dataset, hid_t root, const artefact_axis *axis, bool integer,
                         size_t length, layout kind) {
    hsize_t dims[1] = {length};
    *dataset = create_dataset(root, axis->name, integer, dims, 1, kind);
    return *dataset >= 0 && describe(*dataset, axis->units, axis->long_name) &&
           H5DSset_scale(*dataset, axis->name) >= 0;
}

/* Returns the numbers first, first + 1, ...; NULL: there is no memory. */
static double *numbers_from(size_t first, size_t count) {
    double *numbers = array_new(count, 1, sizeof *numbers);
    for (size_t i = 0; numbers && i < count; i++)
        numbers[i] = (double)(first + i);
    return numbers;
}

static bool write_scale(hid_t root, const artefact_axis *axis, size_t length,
                        const double *values) {
    hid_t dataset = -1;
    double *index = values ? NULL : numbers_from(0, length);
    const bool written = (values || index) &&
                         create_scale(&dataset, root, axis, !values, length, LAYOUT_PLAIN) &&
                         H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT,
                                  values ? values : index) >= 0;
    free(index);
    hdf5_release(dataset);
    return written;
}

/* Returns the schema's axis of this name; NULL if the schema has none, the file already has it, or
 * the file is streaming. */
static const artefact_axis *new_axis(const artefact *file, const char *name) {
    const file_dataset *found = find_dataset(file, name);
    bool usable = found && found->axis && !file->streaming && !hdf5_has_dataset(file->id, name);
    return usable ? found->axis : NULL;
}

ehd_status artefact_put_axis(artefact *file, const char *name, size_t length, const double *values,
                             ehd_error *error) {
    const artefact_axis *axis = new_axis(file, name);
    if (!axis || length == 0)
        return ehd_fail(
            error, EHD_INTERNAL,
            "%s: found axis %s of length %zu, expected a new one of %s that is not empty",
            file->path, name, length, file->schema->name);
    if (!write_scale(file->id, axis, length, values)) return hdf5_write_failed(file, name, error);
    find_dataset(file, name)->length = length;
    return EHD_OK;
}

static ehd_status put_growing_axis(artefact *file, const char *name, ehd_error *error) {
    const artefact_axis *axis = new_axis(file, name);
    if (!axis)
        return ehd_fail(error, EHD_INTERNAL, "%s: found axis %s, expected one of %s", file->path,
                        name, file->schema->name);
    hid_t dataset = -1;
    bool written = create_scale(&dataset, file->id, axis, false, 0, LAYOUT_GROWING);
    ehd_status status = written ? EHD_OK : hdf5_write_failed(file, name, error);
    hdf5_release(dataset);
    file->growing = axis->name;
    return status;
}

ehd_status artefact_create_growing(artefact **file, const char *path, const artefact_schema *schema,
                                   const char *axis, const program *caller,
                                   const char *settings_text, const char *const *inputs,
                                   ehd_error *error) {
    ehd_status status = artefact_create(file, path, schema, caller, settings_text, inputs, error);
    if (status == EHD_OK) status = put_growing_axis(*file, axis, error);
    if (status != EHD_OK) artefact_close(file);
    return status;
}

static bool attach_scales(hid_t root, hid_t dataset, const char *const *axes, size_t rank) {
    bool attached = true;
    for (unsigned i = 0; i < rank && attached; i++) {
        hid_t scale = H5Dopen2(root, axes[i], H5P_DEFAULT);
        attached = scale >= 0 && H5DSattach_scale(dataset, scale, i) >= 0;
        hdf5_release(scale);
    }
    return attached;
}

static ehd_status declare(artefact *file, const artefact_field *field, layout kind,
                          ehd_error *error) {
    hsize_t dims[ARTEFACT_MAX_RANK];
    const char *axes[ARTEFACT_MAX_RANK];
    int rank = (int)artefact_axes(axes, file, field);
    const bool growing = field_grows(file, field);
    for (int i = 0; i < rank; i++) {
        dims[i] = artefact_length(file, axes[i]);
        if (dims[i] == 0 && !(growing && i == 0))
            return ehd_fail(error, EHD_INTERNAL, "%s: %s: found no axis %s, expected it before",
                            file->path, field->name, axes[i]);
    }
    bool integer = field->type == ARTEFACT_INTEGER;
    if (growing) kind = LAYOUT_GROWING;
    hid_t dataset = create_dataset(file->id, field->name, integer, dims, rank, kind);
    bool written = dataset >= 0 && describe(dataset, field->units, field->long_name) &&
                   attach_scales(file->id, dataset, axes, (size_t)rank);
    ehd_status status = written ? EHD_OK : hdf5_write_failed(file, field->name, error);
    hdf5_release(dataset);
    return status;
}

static ehd_status declare_new(artefact *file, const char *name, layout kind, ehd_error *error) {
    const artefact_field *field = find_field(file, name);
    if (!field || file->streaming || hdf5_has_dataset(file->id, name))
        return ehd_fail(error, EHD_INTERNAL, "%s: found field %s, expected a new one of %s",
                        file->path, name, file->schema->name);
    return declare(file, field, kind, error);
}

ehd_status artefact_declare(artefact *file, const char *name, ehd_error *error) {
    return declare_new(file, name, LAYOUT_EARLY, error);
}

ehd_status artefact_declare_apart(artefact *file, const char *name, ehd_error *error) {
    return declare_new(file, name, LAYOUT_APART, error);
}

ehd_status put_entries(artefact *file, const char *name, artefact_type type, size_t first,
                       size_t count, const void *data, ehd_error *error) {
    hdf5_start();
    const artefact_field *field = find_field(file, name);
    if (!field || field->type != type)
        return ehd_fail(error, EHD_INTERNAL,
                        "%s: found field %s, expected one of %s with this type", file->path, name,
                        file->schema->name);
    const bool exists = field_exists(file, field);
    ehd_status status = EHD_OK;
    // While a file is streaming, no dataset can be created. In a resumed file the dataset may be
    // missing because the run that began the file did not create it.
    if (!exists && file->streaming) {
        status = ehd_fail(error, file->history_line ? EHD_DATA : EHD_INTERNAL,
                          "%s: found no field %s, expected a declared one", file->partial, name);
        return hdf5_blame(status, file->partial, error);
    }
    if (!exists) status = declare(file, field, LAYOUT_PLAIN, error);
    return status ? status : write_entries(file, name, type, first, count, data, error);
}

ehd_status artefact_put(artefact *file, const char *field, const double *data, ehd_error *error) {
    return put_entries(file, field, ARTEFACT_REAL, 0, WHOLE_FIELD, data, error);
}

ehd_status artefact_put_integers(artefact *file, const char *field, const int64_t *data,
                                 ehd_error *error) {
    return put_entries(file, field, ARTEFACT_INTEGER, 0, WHOLE_FIELD, data, error);
}

ehd_status artefact_put_part(artefact *file, const char *field, size_t first, size_t count,
                             const double *data, ehd_error *error) {
    return put_entries(file, field, ARTEFACT_REAL, first, count, data, error);
}

ehd_status artefact_put_integers_part(artefact *file, const char *field, size_t first, size_t count,
                                      const int64_t *data, ehd_error *error) {
    return put_entries(file, field, ARTEFACT_INTEGER, first, count, data, error);
}

// ---- the growing axis

/* Extends all fields on the growing axis to at least `length` entries. */
static ehd_status extend_fields(artefact *file, size_t length, ehd_error *error) {
    ehd_status status = EHD_OK;
    hdf5_start();
    for (const file_dataset *of = file->fields; of->field.name && status == EHD_OK; of++) {
        if (!field_grows(file, &of->field) || !field_exists(file, &of->field)) continue;
        hid_t id = open_dataset(file, of->field.name);
        if (id < 0 || !extend_dataset(id, length))
            status = hdf5_write_failed(file, of->field.name, error);
        hdf5_release(id);
    }
    return status;
}

ehd_status artefact_put_axis_part(artefact *file, const char *name, size_t first, size_t count,
                                  const double *values, ehd_error *error) {
    if (!file->growing || strcmp(name, file->growing) != 0)
        return ehd_fail(error, EHD_INTERNAL, "%s: found axis %s, expected the one that grows",
                        file->path, name);
    size_t *length = &find_dataset(file, name)->length;
    double *index = values ? NULL : numbers_from(first, count);
    ehd_status status = values || index ? EHD_OK : ehd_no_memory(error, file->path);
    if (!status && first + count > *length) {
        status = extend_fields(file, first + count, error);
        // only a flush ensures that readers see the longer fields before the longer axis
        if (status == EHD_OK) status = artefact_flush(file, error);
    }
    if (status == EHD_OK)
        status =
            write_entries(file, name, ARTEFACT_REAL, first, count, values ? values : index, error);
    if (status == EHD_OK && first + count > *length) *length = first + count;
    free(index);
    return status;
}

// ---- attributes

ehd_status put_attribute(artefact *file, const char *name, artefact_type type, const void *value,
                         ehd_error *error) {
    const artefact_field *attribute = find_attribute(file, name);
    if (!attribute || attribute->type != type || file->streaming)
        return ehd_fail(error, EHD_INTERNAL,
                        "%s: found attribute %s, expected one of %s with this type%s", file->path,
                        name, file->schema->name,
                        file->streaming ? ", and not while streaming" : "");
    const bool written = type == ARTEFACT_TEXT
                             ? hdf5_put_text(file->id, name, value)
                             : hdf5_put_attribute(file->id, name, hdf5_memory_type(type), value);
    return written ? EHD_OK : hdf5_write_failed(file, name, error);
}

ehd_status artefact_put_real(artefact *file, const char *attribute, double value,
                             ehd_error *error) {
    return put_attribute(file, attribute, ARTEFACT_REAL, &value, error);
}

ehd_status artefact_put_integer(artefact *file, const char *attribute, int64_t value,
                                ehd_error *error) {
    return put_attribute(file, attribute, ARTEFACT_INTEGER, &value, error);
}

ehd_status artefact_put_text(artefact *file, const char *attribute, const char *text,
                             ehd_error *error) {
    return put_attribute(file, attribute, ARTEFACT_TEXT, text, error);
}
