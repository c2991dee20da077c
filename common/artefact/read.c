/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/artefact/internal.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

// ---- opening

ehd_status check_readable(const char *path, ehd_error *error) {
    struct stat found;
    int descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK); // does not wait for a FIFO
    if (descriptor < 0)
        return ehd_fail(error, EHD_NOINPUT, "%s: found %s, expected a readable file", path,
                        strerror(errno));
    int outcome = fstat(descriptor, &found);
    close(descriptor);
    if (outcome != 0 || !S_ISREG(found.st_mode))
        return ehd_fail(error, EHD_NOINPUT, "%s: found no regular file, expected one", path);
    if (found.st_size == 0)
        return ehd_fail(error, EHD_DATA, "%s: found an empty file, expected an HDF5 file", path);
    return EHD_OK;
}

/* HDF5's message for a file that is being written or whose writer was killed. */
static const char has_writer[] = "already open for";

/* Opens a file that may be unfinished, even while another process writes it. If the writer has set
 * a new end of file but has not yet written up to this end, HDF5 finds the file too short. The
 * function then tries again. */
static hid_t open_beside_writer(const char *path) {
    hid_t file = hdf5_open(path, H5F_ACC_RDONLY, false);

    for (int i = 1; file < 0 && i < WRITER_ATTEMPTS; i++) {
        if (strstr(hdf5_last_reason().text, has_writer))
            return hdf5_open(path, H5F_ACC_RDONLY | H5F_ACC_SWMR_READ, false);
        if (!strstr(hdf5_last_reason().text, "truncated file")) return file;
        wait_for_writer();
        file = hdf5_open(path, H5F_ACC_RDONLY, false);
    }
    return file;
}

static ehd_status open_failed(const char *path, ehd_error *error) {
    hdf5_reason reason = hdf5_last_reason();
    if (reason.system)
        return ehd_fail(error, EHD_IO, "%s: found a read failure (%s), expected to read it", path,
                        reason.text);
    if (strstr(reason.text, "file signature"))
        return ehd_fail(error, EHD_DATA, "%s: found no HDF5 file, expected one", path);
    if (strstr(reason.text, has_writer))
        return ehd_fail(
            error, EHD_DATA,
            "%s: found a file that is being written or whose writer was killed, expected "
            "a finished one",
            path);
    return ehd_fail(error, EHD_DATA, "%s: found a damaged file (%s), expected a whole one", path,
                    reason.text);
}

// ---- kind and version

int64_t completeness(const artefact *file) {
    int64_t complete = -1;
    if (!hdf5_get_number(file->id, "complete", ARTEFACT_INTEGER, &complete)) return -1;
    return complete;
}

static ehd_status wrong_schema(const artefact *file, const char *found,
                               const artefact_schema *const *schemas, ehd_error *error) {
    char expected[256] = "";
    size_t length = 0;
    for (size_t i = 0; schemas[i] && length < sizeof expected; i++) {
        length += (size_t)snprintf(expected + length, sizeof expected - length, "%s%s",
                                   i > 0 ? " or " : "", schemas[i]->name);
    }
    return ehd_fail(error, EHD_DATA, "%s: schema_name: found %s, expected %s", shown_name(file),
                    found, expected);
}

static ehd_status recognise(artefact *file, const artefact_schema *const *schemas,
                            ehd_error *error) {
    char *name = hdf5_get_string(file->id, "schema_name");
    for (size_t i = 0; name && schemas[i]; i++)
        if (strcmp(schemas[i]->name, name) == 0) file->schema = schemas[i];
    const bool known = name && file->schema && strcmp(file->schema->name, name) == 0;
    const ehd_status status =
        known ? EHD_OK : wrong_schema(file, name ? name : "none", schemas, error);
    free(name);
    return status;
}

static ehd_status check_version(const artefact *file, ehd_error *error) {
    char *version = hdf5_get_string(file->id, "schema_version");
    int major = -1, minor = -1, end = -1;
    bool parsed = version && sscanf(version, "%4d.%4d%n", &major, &minor, &end) == 2 &&
                  version[end] == '\0' && major > 0 && minor >= 0;
    ehd_status status = EHD_OK;
    if (!parsed || major > file->schema->major)
        status = ehd_fail(error, EHD_DATA, "%s: schema_version: found %s, expected at most %d.x",
                          shown_name(file), version ? version : "none", file->schema->major);
    free(version);
    return status;
}

// ---- attributes and fields

static const char *type_name(artefact_type type) {
    static const char *const names[] = {"a real number", "an integer", "a text"};
    return names[type];
}

static ehd_status check_attribute(const artefact *file, const artefact_field *entry,
                                  ehd_error *error) {
    any_number number;
    bool readable;

    if (entry->type == ARTEFACT_TEXT) {
        char *text = hdf5_get_string(file->id, entry->name);
        readable = text != NULL;
        free(text);
    } else {
        readable = hdf5_get_number(file->id, entry->name, entry->type, &number);
    }
    if (!readable)
        return ehd_fail(error, EHD_DATA, "%s: attribute %s: found something else, expected %s",
                        shown_name(file), entry->name, type_name(entry->type));
    return check_numbers(file, entry, &number, 1, error);
}

static ehd_status check_attributes(const artefact *file, ehd_error *error) {
    for (const artefact_field *entry = file->schema->attributes; entry->name; entry++) {
        bool present = hdf5_has_attribute(file->id, entry->name);
        if (!present && entry->need == NEED_ALWAYS)
            return ehd_fail(error, EHD_DATA, "%s: found no attribute %s, expected %s",
                            shown_name(file), entry->name, type_name(entry->type));
        const ehd_status status = present ? check_attribute(file, entry, error) : EHD_OK;
        if (status != EHD_OK) return status;
    }
    return EHD_OK;
}

/* Checks the type of a dataset. Integers may be read as reals, but not the other way round. */
static bool type_fits(hid_t dataset, artefact_type type) {
    const size_t widest = 16; // bytes of a long double
    hid_t stored = H5Dget_type(dataset);
    H5T_class_t found = H5Tget_class(stored);
    if (H5Tget_size(stored) > widest) found = H5T_NO_CLASS;
    hdf5_release(stored);
    return found == H5T_INTEGER || (found == H5T_FLOAT && type == ARTEFACT_REAL);
}

/* Checks that an axis has one length in the whole file. The first dataset along the axis sets the
 * length. This dataset is the scale, if the file has one. Datasets on a growing axis may be longer
 * until the axis is cut. */
static ehd_status check_length(artefact *file, const char *object, const char *axis, size_t found,
                               ehd_error *error) {
    size_t *length = &find_dataset(file, axis)->length;
    const size_t most = find_dataset(file, axis)->axis->max;
    if (found > most)
        return ehd_fail(error, EHD_DATA, "%s: %s: found length %zu along %s, expected at most %zu",
                        shown_name(file), object, found, axis, most);
    if (file->growing && strcmp(axis, file->growing) == 0) {
        if (strcmp(object, axis) == 0) *length = found;
        return EHD_OK;
    }
    if (found == 0)
        return ehd_fail(error, EHD_DATA, "%s: %s: found length 0 along %s, expected at least 1",
                        shown_name(file), object, axis);
    if (*length > 0 && *length != found)
        return ehd_fail(error, EHD_DATA, "%s: %s: found length %zu along %s, expected %zu",
                        shown_name(file), object, found, axis, *length);
    *length = found;
    return EHD_OK;
}

static ehd_status check_shape(artefact *file, const file_dataset *of, const char *const *axes,
                              size_t rank, ehd_error *error) {
    const char *name = of->field.name;
    if (of->rank != (int)rank)
        return ehd_fail(error, EHD_DATA, "%s: %s: found %d axes, expected %zu", shown_name(file),
                        name, of->rank, rank);
    ehd_status status = EHD_OK;
    for (size_t i = 0; i < rank && status == EHD_OK; i++) {
        status = check_length(file, name, axes[i], (size_t)of->dims[i], error);
    }
    return status;
}

/* Entry of the attribute REFERENCE_LIST of a scale: a dataset that uses the scale, and the number
 * of the axis of this dataset. */
typedef struct scale_use {
    hobj_ref_t dataset; // address of the object header of the dataset
    int axis;
} scale_use;

/* Reads the list of datasets that use a scale; free it with free(). NULL with *num_uses = 0: the
 * scale has no such list, or the list is not readable. NULL with *num_uses > 0: no memory. The
 * lists of scales in the datasets are not read: they lie in a heap without checksums, and HDF5 1.10
 * hangs on a damaged heap. */
static scale_use *read_scale_uses(hid_t scale, size_t *num_uses) {
    static const char list[] = "REFERENCE_LIST";
    if (!hdf5_has_attribute(scale, list)) return NULL;
    hid_t attribute = H5Aopen(scale, list, H5P_DEFAULT);
    hid_t space = H5Aget_space(attribute);
    hid_t type = H5Tcreate(H5T_COMPOUND, sizeof(scale_use));
    H5Tinsert(type, "dataset", HOFFSET(scale_use, dataset), H5T_STD_REF_OBJ);
    H5Tinsert(type, "dimension", HOFFSET(scale_use, axis), H5T_NATIVE_INT);
    hssize_t length = H5Sget_simple_extent_npoints(space);
    *num_uses = length > 0 ? (size_t)length : 0;
    scale_use *uses = calloc(*num_uses + 1, sizeof *uses);
    if (uses && H5Aread(attribute, type, uses) < 0) {
        hdf5_note_failure();
        free(uses);
        uses = NULL;
        *num_uses = 0;
    }
    hdf5_release(type);
    hdf5_release(space);
    hdf5_release(attribute);
    return uses;
}

/* Returns the field that uses the scale, if the schema gives this field another axis at this
 * position. NULL: the axis is right, or the schema does not have the dataset. */
static const artefact_field *find_misfit(const artefact *file, const scale_use *use,
                                         const char *axis) {
    for (const file_dataset *of = file->fields; of->field.name; of++) {
        const char *axes[ARTEFACT_MAX_RANK];
        if (!of->there || of->own.address != use->dataset) continue;
        const size_t rank = artefact_axes(axes, file, &of->field);
        if (use->axis < 0 || use->axis >= (int)rank || strcmp(axes[use->axis], axis) != 0)
            return &of->field;
    }
    return NULL;
}

/* Checks that a scale belongs to the axes that the schema gives, so that a transposed square field
 * is noticed. */
static ehd_status check_scale(const artefact *file, const char *axis, ehd_error *error) {
    hid_t scale = H5Dopen2(file->id, axis, H5P_DEFAULT);
    size_t num_uses = 0;
    scale_use *uses = read_scale_uses(scale, &num_uses);
    ehd_status status = EHD_OK;
    if (!uses && num_uses > 0) status = ehd_no_memory(error, shown_name(file));
    for (size_t i = 0; uses && i < num_uses && status == EHD_OK; i++) {
        const artefact_field *field = find_misfit(file, &uses[i], axis);
        if (!field) continue;
        status =
            ehd_fail(error, EHD_DATA, "%s: %s: found %s as axis %d, expected another order of axes",
                     shown_name(file), field->name, axis, uses[i].axis);
    }
    free(uses);
    hdf5_release(scale);
    return status;
}

/* Reads the shape of a dataset, if the file has it. Checks the type of the dataset, and that its
 * data are in this file. */
static ehd_status look_at(file_dataset *of, const artefact *file, ehd_error *error) {
    const char *name = of->field.name;
    hsize_t dims[H5S_MAX_RANK] = {0};

    of->there = hdf5_has_dataset(file->id, name);
    if (!of->there) return EHD_OK;
    const hid_t id = hdf5_open_own(&of->own, file->id, name);
    if (of->own.foreign) return hdf5_refuse(shown_name(file), name, of->own.foreign, error);
    if (id < 0) return hdf5_read_failed(file, name, error);
    const hid_t space = H5Dget_space(id);
    of->rank = H5Sget_simple_extent_dims(space, dims, NULL);
    memcpy(of->dims, dims, sizeof of->dims);
    ehd_status status = EHD_OK;
    if (!type_fits(id, of->field.type))
        status = ehd_fail(error, EHD_DATA, "%s: %s: found values of another type, expected %ss",
                          shown_name(file), name,
                          of->field.type == ARTEFACT_REAL ? "real number" : "integer");
    hdf5_release(space);
    hdf5_release(id);
    return status;
}

/* Returns the length of a dataset along an axis of the schema. Returns 0 if the file lacks the
 * dataset, or if the number of its axes differs from the schema. */
static size_t length_along(const file_dataset *of, const char *axis) {
    size_t rank = 0, place = ARTEFACT_MAX_RANK;

    for (; rank < ARTEFACT_MAX_RANK && of->field.axes[rank]; rank++)
        if (strcmp(of->field.axes[rank], axis) == 0) place = rank;
    return place < rank && of->there && of->rank == (int)rank ? (size_t)of->dims[place] : 0;
}

/* Finds the lengths of optional axes. A file has an optional axis if it has the scale of this axis.
 * Files of other programs may lack scales. The length is then taken from a field whose dataset has
 * all axes that the schema gives. */
static void learn_optional_axes(artefact *file) {
    for (file_dataset *axis = file->datasets; axis < file->fields; axis++) {
        if (!axis->axis->optional) continue;
        axis->length = length_along(axis, axis->field.name);
        for (const file_dataset *of = file->fields; of->field.name && axis->length == 0; of++)
            axis->length = length_along(of, axis->field.name);
    }
}

/* Checks the shape of a field, if the file has it. EHD_DATA: a NEED_ALWAYS field is missing. */
static ehd_status check_field(artefact *file, const file_dataset *of, ehd_error *error) {
    const artefact_field *field = &of->field;
    const char *axes[ARTEFACT_MAX_RANK];

    if (!of->there) {
        if (field->need != NEED_ALWAYS) return EHD_OK;
        return ehd_fail(error, EHD_DATA, "%s: found no dataset %s, expected %s", shown_name(file),
                        field->name, field->long_name);
    }
    const size_t rank = artefact_axes(axes, file, field);
    if (rank == 0)
        return ehd_fail(error, EHD_DATA, "%s: %s: found no axis %s, expected it", shown_name(file),
                        field->name, field->axes[0]);
    return check_shape(file, of, axes, rank, error);
}

/* Checks the shape of an axis, and that its scale belongs to the right axes of fields. */
static ehd_status check_axis(artefact *file, const file_dataset *of, ehd_error *error) {
    if (!of->there) return EHD_OK;
    const ehd_status status = check_shape(file, of, of->field.axes, 1, error);
    return status ? status : check_scale(file, of->field.name, error);
}

static ehd_status check_datasets(artefact *file, ehd_error *error) {
    ehd_status status = EHD_OK;

    for (file_dataset *of = file->datasets; of->field.name && !status; of++)
        status = look_at(of, file, error);
    if (!status) learn_optional_axes(file);
    for (const file_dataset *of = file->datasets; of->field.name && !status; of++)
        status = of->axis ? check_axis(file, of, error) : check_field(file, of, error);
    return status;
}

const char *find_growing(const artefact *file) {
    const char *growing = NULL;
    own_dataset about;
    for (const artefact_axis *axis = file->schema->axes; axis->name && !growing; axis++) {
        if (!hdf5_has_dataset(file->id, axis->name)) continue;
        hid_t dataset = hdf5_open_own(&about, file->id, axis->name);
        if (is_extendible(dataset)) growing = axis->name;
        hdf5_release(dataset);
    }
    return growing;
}

ehd_status examine(artefact *file, const artefact_schema *const *schemas, ehd_error *error) {
    ehd_status status = recognise(file, schemas, error);
    if (status == EHD_OK) status = check_version(file, error);
    if (status != EHD_OK) return status;

    if (!file->datasets && !set_schema(file, file->schema))
        return ehd_no_memory(error, shown_name(file));
    status = check_attributes(file, error);
    if (status == EHD_OK) status = check_datasets(file, error);
    if (status == EHD_OK) status = check_unpacking(file, error);
    if (status == EHD_OK) status = learn_outcomes(file, error);
    if (status == EHD_OK) status = learn_digests(file, error);
    return status;
}

static ehd_status open_file(artefact **result, const char *path,
                            const artefact_schema *const *schemas, bool unfinished,
                            ehd_error *error) {
    *result = NULL;
    ehd_status status = check_readable(path, error);
    if (status != EHD_OK) return status;
    artefact *file = artefact_new(path);
    if (!file) return ehd_no_memory(error, path);

    file->id = unfinished ? open_beside_writer(path) : hdf5_open(path, H5F_ACC_RDONLY, false);
    if (file->id < 0) status = open_failed(path, error);
    if (status == EHD_OK) status = recognise(file, schemas, error);
    if (status == EHD_OK && completeness(file) != 1 && hdf5_has_attribute(file->id, "complete")) {
        if (unfinished)
            file->growing = find_growing(file);
        else
            status = ehd_fail(error, EHD_DATA,
                              "%s: found an unfinished file (complete is not 1), expected "
                              "a finished one",
                              path);
    }
    if (status == EHD_OK) status = examine(file, schemas, error);
    status = hdf5_blame(status, path, error);
    if (status != EHD_OK) artefact_close(&file);
    *result = file;
    return status;
}

ehd_status artefact_open(artefact **result, const char *path, const artefact_schema *const *schemas,
                         ehd_error *error) {
    return open_file(result, path, schemas, false, error);
}

ehd_status artefact_open_unfinished(artefact **result, const char *path,
                                    const artefact_schema *const *schemas, ehd_error *error) {
    return open_file(result, path, schemas, true, error);
}

// ---- all of a field

/* Checks whether an entry was written, by looking at its first chunk. The time of
 * H5Dget_chunk_storage_size does not depend on the number of chunks, whereas
 * H5Dget_chunk_info_by_coord goes through all chunks. */
static bool is_stored(artefact *file, const char *name, size_t entry) {
    const hid_t dataset = open_dataset(file, name), properties = H5Dget_create_plist(dataset);
    const hsize_t offset[H5S_MAX_RANK] = {entry};
    hsize_t bytes = 1;

    if (H5Pget_layout(properties) == H5D_CHUNKED &&
        H5Dget_chunk_storage_size(dataset, offset, &bytes) < 0)
        bytes = 1;
    hdf5_release(properties);
    hdf5_release(dataset);
    return bytes > 0;
}

/* Reads `count` entries of a field from `first` on into `numbers`, checks and hashes them. */
static ehd_status read_slice(artefact *file, const artefact_field *field, size_t first,
                             size_t count, void *numbers, content_digest *digest,
                             ehd_error *error) {
    if (field->by_entry && count == 1 && !is_stored(file, field->name, first)) return EHD_OK;
    ehd_status status = read_entries(file, field->name, field->type, first, count, numbers,
                                     count * entry_size(file, field), error);
    if (!status) status = check_values(file, field, first, count, numbers, error);
    if (!status && digest) digest_add(digest, first, count, numbers);
    return status;
}

/* Stops reading a long field if the program is interrupted, unless the file is being written. */
static ehd_status check_interrupted(const artefact *file, ehd_error *error) {
    return file->partial || !program_interrupted()
               ? EHD_OK
               : ehd_fail(error, EHD_INTERRUPTED, "%s: interrupted while it was read",
                          shown_name(file));
}

/* Returns how many entries one call reads. HDF5 takes 5 kB of memory for each chunk of a call, so a
 * call reads only a few chunks. If the order of the entries is checked, one call reads all entries.
 * The order is not checked in a file that is being written. */
static size_t slice_of(const artefact *file, const artefact_field *field) {
    enum { SLICE_NUMBERS = 1 << 16 };
    const size_t length = num_entries(file, field), entry = entry_size(file, field);
    const size_t slice = entry < SLICE_NUMBERS ? SLICE_NUMBERS / entry : 1;
    const bool in_order = values_have_order(field->values) && !file->partial;

    if (field->by_entry) return 1;
    return slice > length || in_order ? length : slice;
}

ehd_status read_field(artefact *file, const artefact_field *field, char digest[65],
                      ehd_error *error) {
    const size_t length = num_entries(file, field), slice = slice_of(file, field);
    ehd_status status = check_memory(file, field, slice, error);
    if (status) return status;

    void *numbers = array_new(slice, entry_size(file, field), sizeof(double));
    content_digest hash;
    if (digest) digest_begin(&hash, file, field);
    if (!numbers) status = ehd_no_memory(error, shown_name(file));
    for (size_t first = 0; first < length && !status; first += slice) {
        status = read_slice(file, field, first, length - first < slice ? length - first : slice,
                            numbers, digest ? &hash : NULL, error);
        if (!status && first + slice < length) status = check_interrupted(file, error);
    }
    if (digest) sha256_end(&hash.context, digest);
    free(numbers);
    return status;
}

/* Reads a field that the file has, and compares the field with its stored digest. */
static ehd_status verify_field(artefact *file, const artefact_field *field, ehd_error *error) {
    char digest[65];
    if (!file->digests) return read_field(file, field, NULL, error);
    const ehd_status status = read_field(file, field, digest, error);
    return status ? status : check_digest(file, field->name, digest, error);
}

/* Verifies a field once, before its first part is read. */
static ehd_status verify_once(artefact *file, const artefact_field *field, ehd_error *error) {
    file_dataset *of = find_dataset(file, field->name);

    if (!file->digests || of->checked) return EHD_OK;
    of->checked = true;
    return verify_field(file, field, error);
}

// ---- content

ehd_status get_entries(artefact *file, const char *name, artefact_type type, size_t first,
                       size_t count, void *data, size_t room, ehd_error *error) {
    const artefact_field *field = find_field(file, name);
    if (!field || field->type != type)
        return ehd_fail(error, EHD_INTERNAL,
                        "%s: found field %s, expected one of %s with this type", shown_name(file),
                        name, file->schema->name);
    if (!hdf5_has_dataset(file->id, name)) {
        ehd_fail(error, EHD_DATA, "%s: found no dataset %s, expected %s", shown_name(file), name,
                 field->long_name);
        return hdf5_blame(EHD_DATA, shown_name(file), error);
    }
    const size_t all = num_entries(file, field), entries = count == WHOLE_FIELD ? all : count;
    ehd_status status = check_memory(file, field, entries, error);
    if (status == EHD_OK && entries < all) status = verify_once(file, field, error);
    if (status == EHD_OK)
        status = read_entries(file, name, type, first, entries, data, room, error);
    if (status == EHD_OK && slice_of(file, field) < entries)
        status = check_interrupted(file, error);
    if (status == EHD_OK) status = check_values(file, field, first, entries, data, error);
    return status != EHD_OK || entries < all ? status : check_content(file, field, data, error);
}

ehd_status artefact_get(artefact *file, const char *field, double *data, size_t room,
                        ehd_error *error) {
    return get_entries(file, field, ARTEFACT_REAL, 0, WHOLE_FIELD, data, room, error);
}

ehd_status artefact_get_integers(artefact *file, const char *field, int64_t *data, size_t room,
                                 ehd_error *error) {
    return get_entries(file, field, ARTEFACT_INTEGER, 0, WHOLE_FIELD, data, room, error);
}

ehd_status artefact_get_part(artefact *file, const char *field, size_t first, size_t count,
                             double *data, size_t room, ehd_error *error) {
    return get_entries(file, field, ARTEFACT_REAL, first, count, data, room, error);
}

ehd_status artefact_get_integers_part(artefact *file, const char *field, size_t first, size_t count,
                                      int64_t *data, size_t room, ehd_error *error) {
    return get_entries(file, field, ARTEFACT_INTEGER, first, count, data, room, error);
}

/* Checks whether an axis has values. A bare netCDF dimension is a scale without values; its name
 * shows this. */
bool artefact_has_scale(const artefact *file, const char *axis) {
    static const char bare[] = "This is a netCDF dimension but not a netCDF variable";
    if (!hdf5_has_dataset(file->id, axis)) return false;
    hid_t dataset = H5Dopen2(file->id, axis, H5P_DEFAULT);
    char *name = hdf5_get_string(dataset, "NAME");
    bool values = !name || strncmp(name, bare, sizeof bare - 1) != 0;
    free(name);
    hdf5_release(dataset);
    return values;
}

ehd_status artefact_get_axis(artefact *file, const char *axis, double *values, size_t room,
                             ehd_error *error) {
    if (!artefact_has_scale(file, axis)) {
        ehd_fail(error, EHD_DATA, "%s: found no values of axis %s, expected its scale",
                 shown_name(file), axis);
        return hdf5_blame(EHD_DATA, shown_name(file), error);
    }
    // the axis of a file that is being written may have grown since the file was opened
    const ehd_status status = read_entries(file, axis, ARTEFACT_REAL, 0,
                                           artefact_length(file, axis), values, room, error);
    return status != EHD_OK ? status
                            : check_content(file, &find_dataset(file, axis)->field, values, error);
}

ehd_status get_number(artefact *file, const char *attribute, artefact_type type, void *value,
                      ehd_error *error) {
    hdf5_start();
    if (hdf5_get_number(file->id, attribute, type, value)) return EHD_OK;
    ehd_fail(error, EHD_DATA, "%s: found no attribute %s, expected %s", shown_name(file), attribute,
             type_name(type));
    return hdf5_blame(EHD_DATA, shown_name(file), error);
}

ehd_status artefact_get_real(artefact *file, const char *attribute, double *value,
                             ehd_error *error) {
    return get_number(file, attribute, ARTEFACT_REAL, value, error);
}

ehd_status artefact_get_scale(double *factor, const char **units, artefact *file,
                              const artefact_scale *scale, ehd_error *error) {
    const char *name = scale->attributes[0];

    if (!name) {
        *factor = 1;
        *units = find_field(file, scale->frame)->units;
        return EHD_OK;
    }
    if (!artefact_has(file, name) && scale->attributes[1]) name = scale->attributes[1];
    if (!artefact_has(file, name))
        return ehd_fail(error, EHD_DATA,
                        "%s: found no attribute %s, expected that of a contact in SI units",
                        shown_name(file), scale->attributes[0]);
    *units = find_attribute(file, name)->units;
    const ehd_status status = artefact_get_real(file, name, factor, error);
    if (status || (*factor > 0 && isfinite(*factor))) return status;
    return ehd_fail(error, EHD_DATA, "%s: %s: found %g, expected a number above 0 for SI units",
                    shown_name(file), name, *factor);
}

ehd_status artefact_get_integer(artefact *file, const char *attribute, int64_t *value,
                                ehd_error *error) {
    return get_number(file, attribute, ARTEFACT_INTEGER, value, error);
}

/* Drops a text after a failure, because a part of it may be missing. */
static void forget(char **text) {
    free(*text);
    *text = NULL;
}

ehd_status artefact_get_text(artefact *file, const char *attribute, char **text, ehd_error *error) {
    hdf5_start();
    *text = hdf5_get_text(file->id, attribute);
    ehd_status status =
        *text ? EHD_OK
              : ehd_fail(error, EHD_DATA, "%s: found no attribute %s, expected a text",
                         shown_name(file), attribute);
    status = hdf5_blame(status, shown_name(file), error);
    if (status) forget(text);
    return status;
}

static ehd_status show_number(artefact *file, const char *attribute, char **text,
                              ehd_error *error) {
    char number[NUMBER_TEXT];
    int64_t integer;
    double real;

    if (hdf5_get_number(file->id, attribute, ARTEFACT_INTEGER, &integer))
        snprintf(number, sizeof number, "%" PRId64, integer);
    else if (hdf5_get_number(file->id, attribute, ARTEFACT_REAL, &real))
        number_show(number, real);
    else
        return ehd_fail(error, EHD_DATA,
                        "%s: %s: found something else, expected a number or a text",
                        shown_name(file), attribute);
    *text = strdup(number);
    if (*text) return EHD_OK;
    return ehd_no_memory(error, shown_name(file));
}

ehd_status artefact_show_attribute(artefact *file, const char *attribute, char **text,
                                   ehd_error *error) {
    hdf5_start();
    *text = hdf5_get_text(file->id, attribute);
    ehd_status status = *text ? EHD_OK : show_number(file, attribute, text, error);
    status = hdf5_blame(status, shown_name(file), error);
    if (status) forget(text);
    return status;
}

// ---- check

ehd_status read_everything(artefact *file, bool partial, ehd_error *error) {
    ehd_status status = EHD_OK;
    for (const file_dataset *of = file->datasets; of->field.name && status == EHD_OK; of++) {
        if (partial && is_kept_apart(file, &of->field)) continue;
        if (file->growing && !of->axis && !field_grows(file, &of->field)) continue;
        if (hdf5_has_dataset(file->id, of->field.name))
            status = verify_field(file, &of->field, error);
    }
    return status;
}

static ehd_status read_entry(artefact *file, const artefact_field *field, size_t entry,
                             ehd_error *error) {
    ehd_status status = check_memory(file, field, 1, error);
    double *numbers = status ? NULL : array_new(1, entry_size(file, field), sizeof *numbers);

    if (!status && !numbers) status = ehd_no_memory(error, shown_name(file));
    if (!status) status = read_slice(file, field, entry, 1, numbers, NULL, error);
    if (!status) status = check_numbers(file, field, numbers, entry_size(file, field), error);
    free(numbers);
    return status;
}

ehd_status artefact_check_entry(artefact *file, size_t entry, ehd_error *error) {
    ehd_status status = EHD_OK;
    for (const file_dataset *of = file->fields; of->field.name && status == EHD_OK; of++)
        if (is_finished_by_entry(file, &of->field) && field_exists(file, &of->field))
            status = read_entry(file, &of->field, entry, error);
    return status;
}

ehd_status artefact_check(const char *path, ehd_error *error) {
    artefact *file = NULL;
    ehd_status status = artefact_open(&file, path, artefact_schemas, error);
    if (status == EHD_OK) status = read_everything(file, false, error);
    artefact_close(&file);
    return status;
}
