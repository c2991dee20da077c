/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks the ranges of the numbers in a file, and how many numbers the file may hold. */
#include "common/artefact/internal.h"

#include <errno.h>
#include <fcntl.h>
#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// ---- ranges

static const struct {
    const char *text;
    double low, high; // bounds; of integers `low` only, see `largest`
    bool nan;         // NaN is also allowed
} ranges[] = {[VALUES_ANY] = {"", -INFINITY, INFINITY, true},
              [VALUES_FINITE] = {"finite", -DBL_MAX, DBL_MAX, false},
              [VALUES_KNOWN] = {"finite or NaN", -DBL_MAX, DBL_MAX, true},
              [VALUES_POSITIVE] = {"above 0", DBL_TRUE_MIN, DBL_MAX, false},
              [VALUES_POSITIVE_OR_NAN] = {"above 0, or NaN", DBL_TRUE_MIN, DBL_MAX, true},
              [VALUES_NOT_NEGATIVE] = {"at least 0", 0, DBL_MAX, false},
              [VALUES_BOUND] = {"at least 0, infinite or NaN", 0, INFINITY, true},
              // integers
              [VALUES_FLAG] = {"0 or 1", 0, 1, false},
              [VALUES_COUNT] = {"at least 0", 0, INFINITY, false},
              [VALUES_INDEX_OR_NONE] = {"at least -1", -1, INFINITY, false},
              [VALUES_STATE_OR_NONE] = {"-1 to states - 1", -1, INFINITY, false},
              [VALUES_COLUMN] = {"0 to length of x", 0, INFINITY, false},
              [VALUES_FILM_COLUMN] = {"1 to length of x + 2", 1, INFINITY, false},
              [VALUES_ROW] = {"0 to inner nodes - 1, each once", 0, INFINITY, false},
              [VALUES_FILM_NODE] = {"0 to film nodes - 1, ascending", 0, INFINITY, false}};

const char *values_text(artefact_values values) {
    return ranges[values].text;
}

bool values_have_order(artefact_values values) {
    return values == VALUES_ROW || values == VALUES_FILM_NODE;
}

/* Returns the number of lines of the film. This number includes the lines of boundary nodes, which
 * are not part of the axis y. A half domain has one boundary line, a whole domain has two. Without
 * an axis y the film has one line. */
static int64_t film_lines(const artefact *file) {
    const int64_t lines = (int64_t)artefact_length(file, "y");
    int64_t half = 0;

    if (lines == 0) return 1;
    hdf5_get_number(file->id, "half", ARTEFACT_INTEGER, &half); // 0 where it is missing
    return lines + (half ? 1 : 2);
}

/* Returns the largest integer of a range in this file; INT64_MAX: no bound. */
static int64_t largest(const artefact *file, artefact_values values) {
    const int64_t x = (int64_t)artefact_length(file, "x"), y = (int64_t)artefact_length(file, "y");

    switch (values) {
    case VALUES_FLAG:
        return 1;
    case VALUES_STATE_OR_NONE:
        return (int64_t)artefact_length(file, "state") - 1;
    case VALUES_COLUMN:
        return x;
    case VALUES_FILM_COLUMN:
        return x + 2;
    case VALUES_ROW:
        return x * (y > 0 ? y : 1) - 1;
    case VALUES_FILM_NODE:
        return (x + 2) * film_lines(file) - 1;
    default:
        return INT64_MAX;
    }
}

/* Checks whether all numbers lie between the bounds; NaN does not. The loops have no branches, so
 * that the compiler can vectorise them. NaN is found first, because an ordered comparison with NaN
 * raises FE_INVALID, which a host may trap. isless does not help: gcc 12 vectorises it to an
 * instruction that also raises FE_INVALID. */
static bool reals_lie_between(const double *found, size_t count, double low, double high) {
    size_t unknown = 0, outside = 0;

    for (size_t i = 0; i < count; i++)
        unknown += isnan(found[i]) ? 1 : 0;
    if (unknown > 0) return false;
    for (size_t i = 0; i < count; i++)
        outside += ((found[i] >= low) & (found[i] <= high)) ? 0 : 1;
    return outside == 0;
}

static ehd_status check_reals(const artefact *file, const artefact_field *field,
                              const double *found, size_t count, ehd_error *error) {
    const double low = ranges[field->values].low, high = ranges[field->values].high;
    const bool nan = ranges[field->values].nan;

    if (reals_lie_between(found, count, low, high)) return EHD_OK;
    for (size_t i = 0; i < count; i++) {
        if (reals_lie_between(&found[i], 1, low, high) || (nan && isnan(found[i]))) continue;
        return ehd_fail(error, EHD_DATA, "%s: %s: found %g, expected %s%s", shown_name(file),
                        field->name, found[i],
                        field->values == VALUES_FINITE ? "a number that is " : "",
                        ranges[field->values].text);
    }
    return EHD_OK;
}

static ehd_status check_integers(const artefact *file, const artefact_field *field,
                                 const int64_t *found, size_t count, ehd_error *error) {
    const int64_t least = (int64_t)ranges[field->values].low, last = largest(file, field->values);

    for (size_t i = 0; i < count; i++) {
        if (found[i] >= least && found[i] <= last) continue;
        if (last == INT64_MAX)
            return ehd_fail(error, EHD_DATA, "%s: %s: found %" PRId64 ", expected %s",
                            shown_name(file), field->name, found[i], ranges[field->values].text);
        return ehd_fail(error, EHD_DATA,
                        "%s: %s: found %" PRId64 ", expected %" PRId64 " to %" PRId64,
                        shown_name(file), field->name, found[i], least, last);
    }
    return EHD_OK;
}

ehd_status check_numbers(const artefact *file, const artefact_field *field, const void *numbers,
                         size_t count, ehd_error *error) {
    if (field->values == VALUES_ANY) return EHD_OK;
    return field->type == ARTEFACT_INTEGER ? check_integers(file, field, numbers, count, error)
                                           : check_reals(file, field, numbers, count, error);
}

static int compare_integers(const void *a, const void *b) {
    const int64_t p = *(const int64_t *)a, q = *(const int64_t *)b;

    return (p > q) - (p < q);
}

static ehd_status check_ascending(const artefact *file, const char *name, const int64_t *found,
                                  size_t count, const char *expected, ehd_error *error) {
    for (size_t i = 1; i < count; i++)
        if (found[i] <= found[i - 1])
            return ehd_fail(error, EHD_DATA,
                            "%s: %s: found %" PRId64 " behind %" PRId64 ", expected %s",
                            shown_name(file), name, found[i], found[i - 1], expected);
    return EHD_OK;
}

/* Checks that the integers of a range are ascending, or that no integer occurs twice. */
static ehd_status check_order(const artefact *file, const artefact_field *field,
                              const int64_t *found, size_t count, ehd_error *error) {
    if (field->values == VALUES_FILM_NODE)
        return check_ascending(file, field->name, found, count, "them ascending", error);
    int64_t *sorted = array_new(count, 1, sizeof *sorted);
    if (!sorted) return ehd_no_memory(error, shown_name(file));
    memcpy(sorted, found, count * sizeof *sorted);
    qsort(sorted, count, sizeof *sorted, compare_integers);
    const ehd_status status = check_ascending(file, field->name, sorted, count, "each once", error);
    free(sorted);
    return status;
}

/* Checks whether each entry of a field has a status. */
static bool has_outcomes(const artefact *file, const artefact_field *field) {
    return file->outcomes && strcmp(field->axes[0], file->outcome_axis) == 0;
}

ehd_status check_values(const artefact *file, const artefact_field *field, size_t first,
                        size_t count, const void *data, ehd_error *error) {
    ehd_status status = EHD_OK;

    // in a file that is being written, entries exist before their numbers
    if (field->values == VALUES_ANY || file->growing || file->partial) return EHD_OK;
    const size_t each = entry_size(file, field);
    if (!has_outcomes(file, field))
        status = check_numbers(file, field, data, count * each, error);
    else
        for (size_t e = 0; e < count && !status; e++)
            if (file->outcomes[first + e] == 0) // reals and integers have the same size
                status = check_numbers(file, field, (const int64_t *)data + e * each, each, error);
    if (status || !values_have_order(field->values)) return status;
    return check_order(file, field, data, count * each, error);
}

ehd_status learn_outcomes(artefact *file, ehd_error *error) {
    const artefact_field *field = find_field(file, "status");
    if (!field || file->growing || file->partial || !field_exists(file, field)) return EHD_OK;

    const size_t count = artefact_length(file, field->axes[0]);
    ehd_status status = check_memory(file, field, count, error);
    if (status) return status;
    file->outcomes = array_new(count, 1, sizeof *file->outcomes);
    file->outcome_axis = field->axes[0];
    if (!file->outcomes) return ehd_no_memory(error, shown_name(file));
    return read_entries(file, field->name, ARTEFACT_INTEGER, 0, WHOLE_FIELD, file->outcomes, count,
                        error);
}

// ---- sizes

size_t num_entries(const artefact *file, const artefact_field *field) {
    const char *axes[ARTEFACT_MAX_RANK] = {""};

    artefact_axes(axes, file, field);
    return artefact_length(file, axes[0]);
}

size_t entry_size(const artefact *file, const artefact_field *field) {
    const char *axes[ARTEFACT_MAX_RANK];
    const size_t rank = artefact_axes(axes, file, field);
    size_t size = 1;

    for (size_t i = 1; i < rank; i++)
        size *= artefact_length(file, axes[i]);
    return size;
}

/* Returns the bytes of a file on the disk, without holes; negative: it cannot be opened. */
static double bytes_on_disk(const char *path) {
    const int descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor < 0) return -1;
    const off_t end = lseek(descriptor, 0, SEEK_END);
    double bytes = 0;

    for (off_t at = 0; at < end;) {
        const off_t data = lseek(descriptor, at, SEEK_DATA);
        if (data < 0 && errno == ENXIO) break; // a hole up to the end
        off_t hole = data < 0 ? -1 : lseek(descriptor, data, SEEK_HOLE);
        if (hole < 0) hole = end; // the file system does not report holes
        bytes += (double)(hole - (data < 0 ? at : data));
        at = hole;
    }
    close(descriptor);
    return bytes;
}

/* Largest compression ratio of gzip: two bits stand for at most 258 bytes (RFC 1951). */
static const double MAX_UNPACKING = 1032;

/* Returns how many numbers of a field a reader may read at once. The result is a double, because
 * the product may overflow an integer. */
static double count_numbers(const artefact *file, const artefact_field *field) {
    const double entries = field->by_entry ? 1 : (double)num_entries(file, field);

    return entries * (double)entry_size(file, field);
}

/* Checks the size of a chunk, because HDF5 unpacks the whole chunk to read a part of it. */
static ehd_status check_chunk(const artefact *file, const file_dataset *of, double numbers,
                              ehd_error *error) {
    const double small = 1 << 20, most = fmax(numbers, small);

    if (of->own.chunk <= most) return EHD_OK;
    return ehd_fail(error, EHD_DATA, "%s: %s: found a chunk of %.0f numbers, expected at most %.0f",
                    shown_name(file), of->field.name, of->own.chunk, most);
}

ehd_status check_unpacking(const artefact *file, ehd_error *error) {
    const double nodes =
        fmax((double)artefact_length(file, "x"), 1) * fmax((double)artefact_length(file, "y"), 1);
    double numbers = 0;
    ehd_status status = EHD_OK;

    if (nodes > ARTEFACT_MAX_NODES)
        return ehd_fail(error, EHD_DATA, "%s: x: found %.0f nodes, expected at most %d",
                        shown_name(file), nodes, ARTEFACT_MAX_NODES);
    for (const file_dataset *of = file->datasets; of->field.name && !status; of++) {
        if (!of->there) continue;
        const double count = count_numbers(file, &of->field);
        numbers += count;
        status = check_chunk(file, of, count, error);
    }
    return status ? status : check_stored(shown_name(file), numbers, error);
}

ehd_status check_stored(const char *path, double numbers, ehd_error *error) {
    const double bytes = numbers * (double)sizeof(double), stored = bytes_on_disk(path);

    if (stored < 0)
        return ehd_fail(error, EHD_IO, "%s: found %s, expected it to open once more", path,
                        strerror(errno));
    if (bytes <= MAX_UNPACKING * stored) return EHD_OK;
    return ehd_fail(error, EHD_DATA,
                    "%s: found numbers that take %.3g MB in a file with %.3g MB of data, expected "
                    "at most %.0f times as much",
                    path, bytes * 1e-6, stored * 1e-6, MAX_UNPACKING);
}

ehd_status check_memory(const artefact *file, const artefact_field *field, size_t entries,
                        ehd_error *error) {
    const double small = 64e6; // bytes; smaller arrays are not checked
    const double bytes = (double)entries * (double)entry_size(file, field) * (double)sizeof(double);

    if (bytes < small) return EHD_OK;
    return program_check_memory(shown_name(file), field->name, entries * entry_size(file, field),
                                "numbers", "", bytes, error);
}
