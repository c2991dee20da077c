/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/output/print.h"

#include "common/output/si_units.h"
#include "common/program/arena.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SLICE_NUMBERS = 1 << 20 }; // numbers read at a time, 8 MB

/* Column of the output: a name from the command line, or an axis printed before these names. */
typedef struct column {
    const char *name;
    const artefact_field *field; // NULL: an axis or an attribute
    const char *axes[ARTEFACT_MAX_RANK];
    size_t rank;       // number of axes; 0: an attribute
    double *reals;     // slice of a field, or the whole axis
    int64_t *integers; // slice of an integer field
    char *text;        // text of an attribute
    si_units si;       // without units: dimensionless
    size_t frame_axis; // place of si.frame_axis among the axes of the entries
} column;

/* Entries that are printed, one per line. */
typedef struct entries {
    const char *axes[ARTEFACT_MAX_RANK];
    size_t lengths[ARTEFACT_MAX_RANK];
    size_t rank; // number of axes; 0: one line
} entries;

// ---- text

/* Prints character by character, so that no memory is needed. */
void print_csv_text(const char *text, FILE *stream) {
    // a text that begins with # would be a comment
    const char *quote = *text == '#' || text[strcspn(text, ",\"\n")] ? "\"" : "";
    fputs(quote, stream);
    for (size_t length; *text; text += length) {
        char shown[5] = "";
        length = text_character(text);
        if (length == 0) length = 1;
        memcpy(shown, text, length);
        text_make_printable(shown, "\n\t");
        if (*shown == '"') fputc('"', stream);
        fputs(shown, stream);
    }
    fputs(quote, stream);
}

void print_csv_real(double value, FILE *stream) {
    char shown[NUMBER_TEXT];

    if (!isnan(value)) number_show(shown, value);
    fputs(isnan(value) ? "nan" : shown, stream); // without the sign that NaN may have
}

// ---- names

static const artefact_axis *find_axis(const artefact *file, const char *name) {
    const artefact_axis *axis = entry_find(artefact_kind(file)->axes, sizeof *axis, name);

    return axis && (artefact_length(file, name) > 0 || artefact_has(file, name)) ? axis : NULL;
}

static const artefact_field *find_field(const artefact *file, const char *name) {
    const artefact_field *field = artefact_find(artefact_kind(file)->fields, name);

    return field && artefact_has(file, name) ? field : NULL;
}

/* Names in one text, as far as there is room. */
typedef struct name_list {
    char text[700]; // leaves room for a path in the text of an error
    size_t length;
    bool full;
} name_list;

static void list_name(const char *name, void *data) {
    name_list *list = data;
    const size_t room = sizeof list->text - list->length;
    char shown[SHOWN_TEXT];

    text_show(shown, name);
    if (list->full || strlen(shown) + 2 >= room) {
        list->full = true;
        return;
    }
    list->length += (size_t)snprintf(list->text + list->length, room, "%s%s",
                                     list->length > 0 ? " " : "", shown);
}

static ehd_status unknown_name(const artefact *file, const char *name, ehd_error *error) {
    name_list list = {.text = ""};
    char shown[SHOWN_TEXT];

    for (const artefact_axis *axis = artefact_kind(file)->axes; axis->name; axis++)
        if (find_axis(file, axis->name)) list_name(axis->name, &list);
    for (const artefact_field *field = artefact_kind(file)->fields; field->name; field++)
        if (find_field(file, field->name)) list_name(field->name, &list);
    artefact_visit_attributes(file, list_name, &list);
    text_show(shown, name);
    return ehd_fail(error, EHD_DATA, "%s: found no %s, expected one of: %s%s", artefact_path(file),
                    shown, list.text, list.full ? " ... (all: --print without names)" : "");
}

typedef struct name_search {
    const char *name;
    bool found;
} name_search;

static void compare_name(const char *name, void *data) {
    name_search *search = data;
    search->found = search->found || strcmp(name, search->name) == 0;
}

static ehd_status find_column(column *found, artefact *file, const char *name, ehd_error *error) {
    name_search attribute = {.name = name};

    *found = (column){.name = name, .field = find_field(file, name), .si = {.factor = 1}};
    if (found->field) {
        found->rank = artefact_axes(found->axes, file, found->field);
        return EHD_OK;
    }
    if (find_axis(file, name)) {
        found->axes[found->rank++] = name;
        return EHD_OK;
    }
    artefact_visit_attributes(file, compare_name, &attribute);
    if (!attribute.found) return unknown_name(file, name, error);
    return artefact_show_attribute(file, name, &found->text, error);
}

// ---- axes

static size_t axis_place(const char *const *axes, size_t rank, const char *name) {
    size_t place = 0;
    while (place < rank && strcmp(axes[place], name) != 0)
        place++;
    return place;
}

/* Checks whether a column fits: a dataset must have the same axes as the entries, and an axis must
 * be one of these axes. */
static bool fits(const column *one, const entries *all) {
    if (!one->field)
        return one->rank == 0 || axis_place(all->axes, all->rank, one->name) < all->rank;
    bool same = one->rank == all->rank;
    for (size_t k = 0; k < all->rank && same; k++)
        same = strcmp(one->axes[k], all->axes[k]) == 0;
    return same;
}

/* Finds the entries to print, which have the axes of the column with the most axes. Checks that all
 * columns fit. */
static ehd_status find_entries(entries *all, const artefact *file, const column *columns,
                               size_t num_columns, ehd_error *error) {
    const column *first = columns;

    for (size_t i = 1; i < num_columns; i++)
        if (columns[i].rank > first->rank) first = &columns[i];
    all->rank = first->rank;
    for (size_t k = 0; k < all->rank; k++) {
        all->axes[k] = first->axes[k];
        all->lengths[k] = artefact_length(file, first->axes[k]);
    }
    for (size_t i = 0; i < num_columns; i++)
        if (!fits(&columns[i], all))
            return ehd_fail(error, EHD_DATA,
                            "%s: found %s and %s of different axes, expected datasets along the "
                            "same ones, and no other axes",
                            artefact_path(file), first->name, columns[i].name);
    return EHD_OK;
}

static size_t count_long_axes(const entries *all) {
    size_t count = 0;
    for (size_t k = 0; k < all->rank; k++)
        count += all->lengths[k] > 1;
    return count;
}

/* Puts axes that are not named before the columns, if several axes have more than one entry.
 * Returns the new number of columns. */
static size_t add_leading_axes(column *columns, size_t num_columns, const entries *all) {
    size_t num_leading = 0;

    if (count_long_axes(all) < 2) return num_columns;
    for (size_t k = 0; k < all->rank; k++) {
        bool named = all->lengths[k] == 1;
        for (size_t i = num_leading; i < num_columns + num_leading; i++)
            named = named || strcmp(columns[i].name, all->axes[k]) == 0;
        if (named) continue;
        memmove(&columns[num_leading + 1], &columns[num_leading], num_columns * sizeof *columns);
        columns[num_leading++] =
            (column){.name = all->axes[k], .axes = {all->axes[k]}, .rank = 1, .si = {.factor = 1}};
    }
    return num_columns + num_leading;
}

// ---- SI units

/* Finds the axis along which the second SI factor of a column varies. Returns EHD_DATA if this
 * factor has several values and its axis is not an axis of the entries. */
static ehd_status find_frame(column *one, const artefact *file, const entries *all,
                             ehd_error *error) {
    const char *axis = one->si.frame_axis;

    if (!one->si.frame) return EHD_OK;
    one->frame_axis = axis_place(all->axes, all->rank, axis);
    if (one->frame_axis < all->rank || one->si.num_frames == 1) return EHD_OK;
    return ehd_fail(error, EHD_DATA,
                    "%s: %s: found a unit that varies with %s, expected a dataset along %s beside "
                    "it",
                    artefact_path(file), one->name, axis, axis);
}

static ehd_status show_attribute(column *one, artefact *file, ehd_error *error) {
    char shown[NUMBER_TEXT];
    double value;
    ehd_status status = artefact_get_real(file, one->name, &value, error);
    if (status) return status;

    number_show(shown, value * one->si.factor);
    free(one->text);
    one->text = strdup(shown);
    return one->text ? EHD_OK : ehd_no_memory(error, artefact_path(file));
}

static ehd_status find_units(column *columns, size_t num_columns, artefact *file,
                             const entries *all, ehd_error *error) {
    ehd_status status = si_units_check(file, error);

    for (size_t i = 0; i < num_columns && !status; i++) {
        column *one = &columns[i];
        status = si_units_read(&one->si, file, one->name, true, error);
        if (!status) status = find_frame(one, file, all, error);
        if (!status && one->text && one->si.factor != 1) status = show_attribute(one, file, error);
    }
    return status;
}

// ---- reading

static ehd_status read_axis(column *axis, artefact *file, ehd_error *error) {
    const size_t length = artefact_length(file, axis->name);

    axis->reals = array_new(length, 1, sizeof *axis->reals);
    if (!axis->reals) return ehd_no_memory(error, artefact_path(file));
    if (artefact_has_scale(file, axis->name) && length > 0)
        return artefact_get_axis(file, axis->name, axis->reals, length, error);
    for (size_t i = 0; i < length; i++)
        axis->reals[i] = (double)i;
    return EHD_OK;
}

/* Allocates memory for slices of `size` numbers, and reads axes as a whole. */
static ehd_status prepare(column *columns, size_t num_columns, artefact *file, size_t size,
                          ehd_error *error) {
    ehd_status status = EHD_OK;

    for (size_t i = 0; i < num_columns && !status; i++) {
        column *one = &columns[i];
        if (!one->field) {
            if (one->rank > 0) status = read_axis(one, file, error);
        } else if (one->field->type == ARTEFACT_INTEGER) {
            one->integers = array_new(size, 1, sizeof *one->integers);
            if (!one->integers) status = ehd_no_memory(error, artefact_path(file));
        } else {
            one->reals = array_new(size, 1, sizeof *one->reals);
            if (!one->reals) status = ehd_no_memory(error, artefact_path(file));
        }
    }
    return status;
}

static ehd_status read_slice(column *columns, size_t num_columns, artefact *file, size_t first,
                             size_t count, size_t size, ehd_error *error) {
    ehd_status status = EHD_OK;

    for (size_t i = 0; i < num_columns && !status; i++) {
        const column *one = &columns[i];
        if (one->integers)
            status = artefact_get_integers_part(file, one->name, first, count, one->integers, size,
                                                error);
        else if (one->field)
            status = artefact_get_part(file, one->name, first, count, one->reals, size, error);
    }
    return status;
}

// ---- lines

/* Prints empty lines before an entry at which axes start again: one line if only the last axis
 * starts again, two lines if further axes do so too. */
static void print_gap(const entries *all, const size_t index[ARTEFACT_MAX_RANK], FILE *stream) {
    size_t inner = 0; // number of axes with several entries that start again
    for (size_t k = all->rank; k-- > 0;) {
        if (all->lengths[k] == 1) continue;
        if (index[k] > 0) break;
        inner++;
    }
    for (size_t i = 0; i < inner && i < 2; i++)
        fputc('\n', stream);
}

static double factor_at(const column *one, const entries *all,
                        const size_t index[ARTEFACT_MAX_RANK]) {
    return si_units_at(&one->si, one->frame_axis < all->rank ? index[one->frame_axis] : 0);
}

/* Prints one value. `place` is the position of the entry in the slice of a field. `index` is its
 * position along each axis. */
static void print_value(const column *one, const entries *all, size_t place,
                        const size_t index[ARTEFACT_MAX_RANK], FILE *stream) {
    if (one->text) {
        print_csv_text(one->text, stream);
    } else if (one->integers) {
        fprintf(stream, "%" PRId64, one->integers[place]);
    } else {
        const size_t at = one->field ? place : index[axis_place(all->axes, all->rank, one->name)];
        print_csv_real(one->reals[at] * factor_at(one, all, index), stream);
    }
}

static void print_line(const column *columns, size_t num_columns, const entries *all, size_t place,
                       const size_t index[ARTEFACT_MAX_RANK], FILE *stream) {
    for (size_t i = 0; i < num_columns; i++) {
        if (i > 0) fputc(',', stream);
        print_value(&columns[i], all, place, index, stream);
    }
    fputc('\n', stream);
}

static bool has_units(const char *units) {
    return units && *units && strcmp(units, "1") != 0;
}

static void print_header(const column *columns, size_t num_columns, FILE *stream) {
    for (size_t i = 0; i < num_columns; i++) {
        if (i > 0) fputc(',', stream);
        print_csv_text(columns[i].name, stream);
        if (has_units(columns[i].si.units)) fprintf(stream, " [%s]", columns[i].si.units);
    }
    fputc('\n', stream);
}

/* Moves `index` to the next entry; the position along the last axis varies fastest. */
static void go_on(size_t index[ARTEFACT_MAX_RANK], const entries *all) {
    for (size_t k = all->rank; k-- > 0;) {
        if (++index[k] < all->lengths[k]) return;
        index[k] = 0;
    }
}

static ehd_status print_lines(column *columns, size_t num_columns, artefact *file,
                              const entries *all, FILE *stream, ehd_error *error) {
    size_t index[ARTEFACT_MAX_RANK] = {0},
           inner = 1; // numbers per entry of the first axis
    const size_t length = all->rank > 0 ? all->lengths[0] : 1;

    for (size_t k = 1; k < all->rank; k++)
        inner *= all->lengths[k];
    size_t slice = inner > 0 && inner < SLICE_NUMBERS ? SLICE_NUMBERS / inner : 1;
    if (slice > length) slice = length;
    ehd_status status = prepare(columns, num_columns, file, slice * inner, error);
    if (!status) print_header(columns, num_columns, stream);
    for (size_t first = 0; first < length && !status; first += slice) {
        const size_t count = length - first < slice ? length - first : slice;
        status = read_slice(columns, num_columns, file, first, count, count * inner, error);
        for (size_t i = 0; i < count * inner && !status; i++) {
            if (first + i > 0) print_gap(all, index, stream);
            print_line(columns, num_columns, all, i, index, stream);
            go_on(index, all);
            if (program_interrupted())
                status = ehd_fail(error, EHD_INTERRUPTED,
                                  "%s: found an interruption, expected none", artefact_path(file));
            if (ferror(stream)) return EHD_OK; // program_finish reports this error
        }
    }
    return status;
}

ehd_status print_entries(artefact *file, const char *const *names, size_t num_names, bool si,
                         FILE *stream, ehd_error *error) {
    entries all = {.rank = 0};
    ehd_status status = EHD_OK;
    column *columns = calloc(num_names + ARTEFACT_MAX_RANK, sizeof *columns);
    size_t num_columns = num_names;

    if (!columns) return ehd_no_memory(error, artefact_path(file));
    for (size_t i = 0; i < num_names && !status; i++)
        status = find_column(&columns[i], file, names[i], error);
    if (!status) status = find_entries(&all, file, columns, num_names, error);
    if (!status) {
        num_columns = add_leading_axes(columns, num_names, &all);
        if (si) status = find_units(columns, num_columns, file, &all, error);
    }
    if (!status) status = print_lines(columns, num_columns, file, &all, stream, error);
    for (size_t i = 0; i < num_columns; i++) {
        free(columns[i].text);
        free(columns[i].reals);
        free(columns[i].integers);
        si_units_free(&columns[i].si);
    }
    free(columns);
    return status;
}

// ---- list of names

typedef struct description {
    artefact *file;
    FILE *stream;
    bool si;
    ehd_status status; // the first failure
    ehd_error *error;
} description;

static void describe(description *self, const char *name, size_t rank, const char *const *axes,
                     const char *long_name) {
    si_units units = {.units = si_units_plain(self->file, name)};

    if (!self->status && self->si)
        self->status = si_units_read(&units, self->file, name, false, self->error);
    if (self->status) return;
    print_csv_text(name, self->stream);
    fprintf(self->stream, ",%s,", units.units);
    for (size_t k = 0; k < rank; k++)
        fprintf(self->stream, "%s%zu", k > 0 ? " " : "", artefact_length(self->file, axes[k]));
    fputc(',', self->stream);
    for (size_t k = 0; k < rank; k++)
        fprintf(self->stream, "%s%s", k > 0 ? " " : "", axes[k]);
    fputc(',', self->stream);
    print_csv_text(long_name, self->stream);
    fputc('\n', self->stream);
}

static void describe_attribute(const char *name, void *data) {
    description *self = data;
    const artefact_field *known = artefact_find(artefact_kind(self->file)->attributes, name);

    describe(self, name, 0, NULL, known ? known->long_name : "");
}

ehd_status print_names(artefact *file, bool si, FILE *stream, ehd_error *error) {
    const artefact_schema *schema = artefact_kind(file);
    description self = {.file = file, .stream = stream, .si = si, .error = error};

    if (si) self.status = si_units_check(file, error);
    if (!self.status) fputs("name,units,lengths,axes,description\n", stream);
    for (const artefact_axis *axis = schema->axes; axis->name; axis++)
        if (find_axis(file, axis->name))
            describe(&self, axis->name, 1, &axis->name, axis->long_name);
    for (const artefact_field *field = schema->fields; field->name; field++) {
        const char *axes[ARTEFACT_MAX_RANK];
        if (!find_field(file, field->name)) continue;
        describe(&self, field->name, artefact_axes(axes, file, field), axes, field->long_name);
    }
    artefact_visit_attributes(file, describe_attribute, &self);
    return self.status;
}

ehd_status output_print(const program *self, ehd_error *error) {
    artefact *file = NULL;
    ehd_status status = artefact_open_unfinished(&file, self->print, artefact_schemas, error);

    if (!status && self->num_arguments > 0)
        status = print_entries(file, self->arguments, self->num_arguments, self->si, stdout, error);
    else if (!status)
        status = print_names(file, self->si, stdout, error);
    artefact_close(&file);
    return status;
}
