/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Ordinary writing. */
#include "common/artefact/internal.h"

#include <fcntl.h>
#include <hdf5_hl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

// Scalars share a chunk, and a large field has several chunks an entry.
enum { CHUNK_LEAST_BYTES = 8192, CHUNK_MOST_BYTES = 1 << 20 };

// ---- the file

/* --force replaces an earlier output, never what the program reads. */
static ehd_status check_inputs(const char *path, const char *const *inputs, ehd_error *error) {
    struct stat output, input;

    if (!inputs || stat(path, &output) != 0) return EHD_OK;
    for (; *inputs; inputs++)
        if (stat(*inputs, &input) == 0 && input.st_dev == output.st_dev &&
            input.st_ino == output.st_ino)
            return ehd_fail(error, EHD_CANTCREATE,
                            "%s: found an input as output, expected another name", path);
    return EHD_OK;
}

ehd_status artefact_create(artefact **result, const char *path, const artefact_schema *schema,
                           const program *caller, const char *settings_text,
                           const char *const *inputs, ehd_error *error) {
    *result = NULL;
    artefact *file = NULL;
    ehd_status status = check_inputs(path, inputs, error);
    if (status == EHD_OK) status = writer_new(&file, path, schema, caller, O_CREAT, error);
    if (status != EHD_OK) return status;

    file->id = hdf5_create(file->partial);
    if (file->id < 0) {
        hdf5_reason reason = hdf5_last_reason();
        status =
            ehd_fail(error, EHD_CANTCREATE, "%s: found %s, expected a file that can be created",
                     file->partial, reason.text);
    } else {
        status = put_provenance(file, caller, settings_text, inputs, error);
    }
    if (status != EHD_OK) artefact_close(&file);
    *result = file;
    return status;
}

// ---- axes and fields

/* Entries of the first axis to a chunk, and parts of an entry where one alone is too large. */
static void choose_chunks(hsize_t *chunk, const hsize_t *dims, int rank) {
    hsize_t entry = 8;
    for (int i = 1; i < rank; i++)
        entry *= dims[i];
    hsize_t entries = entry < CHUNK_LEAST_BYTES ? CHUNK_LEAST_BYTES / entry : 1;
    chunk[0] = entries < dims[0] ? entries : dims[0];
    for (int i = 1; i < rank; i++)
        chunk[i] = dims[i];
    for (int i = 1; i < rank && entry > CHUNK_MOST_BYTES; i++) {
        hsize_t row = entry / chunk[i];
        hsize_t fit = CHUNK_MOST_BYTES / row;
        hsize_t pieces = fit > 0 ? (chunk[i] + fit - 1) / fit : chunk[i];
        chunk[i] = (chunk[i] + pieces - 1) / pieces; // pieces of about equal size
        entry = row * chunk[i];
    }
}

/* `early`: the space is taken and filled at once, so that later writes change no metadata. */
static hid_t create_dataset(hid_t root, const char *name, bool integer, const hsize_t *dims,
                            int rank, bool early) {
    const double no_real = NAN;
    const int64_t no_integer = -1;
    hid_t type = integer ? H5T_STD_I64LE : H5T_IEEE_F64LE;
    hid_t native = integer ? H5T_NATIVE_INT64 : H5T_NATIVE_DOUBLE;
    hsize_t chunk[ARTEFACT_MAX_RANK];
    choose_chunks(chunk, dims, rank);

    hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_chunk(properties, rank, chunk);
    H5Pset_fletcher32(properties);
    H5Pset_attr_phase_change(properties, 65535, 0);
    H5Pset_alloc_time(properties, early ? H5D_ALLOC_TIME_EARLY : H5D_ALLOC_TIME_INCR);
    H5Pset_fill_value(properties, native,
                      integer ? (const void *)&no_integer : (const void *)&no_real);
    hid_t space = H5Screate_simple(rank, dims, NULL);
    hid_t dataset = H5Dcreate2(root, name, type, space, H5P_DEFAULT, properties, H5P_DEFAULT);
    hdf5_release(space);
    hdf5_release(properties);
    return dataset;
}

static bool describe(hid_t dataset, const char *units, const char *long_name) {
    return hdf5_put_string(dataset, "units", units) &&
           hdf5_put_string(dataset, "long_name", long_name);
}

static bool write_scale(hid_t root, const artefact_axis *axis, size_t length,
                        const double *values) {
    hsize_t dims[1] = {length};
    hid_t dataset = create_dataset(root, axis->name, !values, dims, 1, false);
    bool written = dataset >= 0 && describe(dataset, axis->units, axis->long_name) &&
                   H5DSset_scale(dataset, axis->name) >= 0;
    if (written && values) {
        written = H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0;
    } else if (written) {
        int64_t *index = malloc(length * sizeof *index);
        for (size_t i = 0; index && i < length; i++)
            index[i] = (int64_t)i;
        written =
            index && H5Dwrite(dataset, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, index) >= 0;
        free(index);
    }
    hdf5_release(dataset);
    return written;
}

ehd_status artefact_put_axis(artefact *file, const char *name, size_t length, const double *values,
                             ehd_error *error) {
    const artefact_axis *axis = file->schema->axes;
    while (axis->name && strcmp(axis->name, name) != 0)
        axis++;
    if (!axis->name || length == 0 || file->streaming || *find_length(file, name) > 0) {
        return ehd_fail(
            error, EHD_INTERNAL,
            "%s: found axis %s of length %zu, expected a new one of %s that is not empty",
            file->path, name, length, file->schema->name);
    }
    if (!write_scale(file->id, axis, length, values)) return hdf5_write_failed(file, name, error);
    *find_length(file, name) = length;
    return EHD_OK;
}

static bool attach_scales(hid_t root, hid_t dataset, const artefact_field *field) {
    bool attached = true;
    for (unsigned i = 0; i < field_rank(field) && attached; i++) {
        hid_t scale = H5Dopen2(root, field->axes[i], H5P_DEFAULT);
        attached = scale >= 0 && H5DSattach_scale(dataset, scale, i) >= 0;
        hdf5_release(scale);
    }
    return attached;
}

static ehd_status declare(artefact *file, const artefact_field *field, bool early,
                          ehd_error *error) {
    hsize_t dims[ARTEFACT_MAX_RANK];
    int rank = (int)field_rank(field);
    for (int i = 0; i < rank; i++) {
        dims[i] = artefact_length(file, field->axes[i]);
        if (dims[i] == 0) {
            return ehd_fail(error, EHD_INTERNAL, "%s: %s: found no axis %s, expected it before",
                            file->path, field->name, field->axes[i]);
        }
    }
    bool integer = field->type == ARTEFACT_INTEGER;
    hid_t dataset = create_dataset(file->id, field->name, integer, dims, rank, early);
    bool written = dataset >= 0 && describe(dataset, field->units, field->long_name) &&
                   attach_scales(file->id, dataset, field);
    ehd_status status = written ? EHD_OK : hdf5_write_failed(file, field->name, error);
    hdf5_release(dataset);
    return status;
}

ehd_status artefact_declare(artefact *file, const char *name, ehd_error *error) {
    const artefact_field *field = find_field(file, name);
    if (!field || file->streaming || hdf5_has_dataset(file->id, name)) {
        return ehd_fail(error, EHD_INTERNAL, "%s: found field %s, expected a new one of %s",
                        file->path, name, file->schema->name);
    }
    return declare(file, field, true, error);
}

static ehd_status put(artefact *file, const char *name, artefact_type type, size_t first,
                      size_t count, const void *data, ehd_error *error) {
    const artefact_field *field = find_field(file, name);
    if (!field || field->type != type) {
        return ehd_fail(error, EHD_INTERNAL,
                        "%s: found field %s, expected one of %s with this type", file->path, name,
                        file->schema->name);
    }
    ehd_status status = EHD_OK;
    if (!hdf5_has_dataset(file->id, name)) {
        if (file->streaming) {
            return ehd_fail(error, EHD_INTERNAL, "%s: found field %s, expected a declared one",
                            file->path, name);
        }
        status = declare(file, field, false, error);
    }
    if (status != EHD_OK) return status;
    return transfer(file, name, type, first, count, NULL, data, error);
}

ehd_status artefact_put(artefact *file, const char *field, const double *data, ehd_error *error) {
    return put(file, field, ARTEFACT_REAL, 0, WHOLE_FIELD, data, error);
}

ehd_status artefact_put_integers(artefact *file, const char *field, const int64_t *data,
                                 ehd_error *error) {
    return put(file, field, ARTEFACT_INTEGER, 0, WHOLE_FIELD, data, error);
}

ehd_status artefact_put_part(artefact *file, const char *field, size_t first, size_t count,
                             const double *data, ehd_error *error) {
    return put(file, field, ARTEFACT_REAL, first, count, data, error);
}

ehd_status artefact_put_integers_part(artefact *file, const char *field, size_t first, size_t count,
                                      const int64_t *data, ehd_error *error) {
    return put(file, field, ARTEFACT_INTEGER, first, count, data, error);
}

// ---- attributes

static ehd_status check_attribute(const artefact *file, const char *name, artefact_type type,
                                  ehd_error *error) {
    const artefact_attribute *attribute = find_attribute(file, name);
    if (attribute && attribute->type == type && !file->streaming) return EHD_OK;
    return ehd_fail(error, EHD_INTERNAL,
                    "%s: found attribute %s, expected one of %s with this type%s", file->path, name,
                    file->schema->name, file->streaming ? ", and not while streaming" : "");
}

ehd_status artefact_put_real(artefact *file, const char *attribute, double value,
                             ehd_error *error) {
    ehd_status status = check_attribute(file, attribute, ARTEFACT_REAL, error);
    if (status != EHD_OK) return status;
    bool written = hdf5_put_attribute(file->id, attribute, H5T_NATIVE_DOUBLE, &value);
    return written ? EHD_OK : hdf5_write_failed(file, attribute, error);
}

ehd_status artefact_put_integer(artefact *file, const char *attribute, int64_t value,
                                ehd_error *error) {
    ehd_status status = check_attribute(file, attribute, ARTEFACT_INTEGER, error);
    if (status != EHD_OK) return status;
    bool written = hdf5_put_attribute(file->id, attribute, H5T_NATIVE_INT64, &value);
    return written ? EHD_OK : hdf5_write_failed(file, attribute, error);
}

ehd_status artefact_put_text(artefact *file, const char *attribute, const char *text,
                             ehd_error *error) {
    ehd_status status = check_attribute(file, attribute, ARTEFACT_TEXT, error);
    if (status != EHD_OK) return status;
    bool written = hdf5_put_text(file->id, attribute, text);
    return written ? EHD_OK : hdf5_write_failed(file, attribute, error);
}
