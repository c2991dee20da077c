/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/output/case_table.h"

#include "common/artefact/sha256.h"
#include "common/artefact/table.h"
#include "common/output/columns.h"
#include "common/output/grid_file.h"
#include "common/output/print.h"
#include "common/physics/inlet_heating.h"
#include "common/program/arena.h"
#include "common/program/output_file.h"
#include "common/program/text.h"
#include "common/settings/csv.h"
#include "common/settings/yaml_tree.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Columns of the table. The schema gives their units and scales. */
#define SAME(member) COLUMN(case_row, #member, member)

static const column columns[] = {{SAME(status), .integer = true},
                                 {SAME(moes_M)},
                                 {SAME(moes_L)},
                                 {SAME(alpha_p_H)},
                                 {SAME(hertz_pressure)},
                                 {SAME(half_width)},
                                 {SAME(film_unit)},
                                 {COLUMN(case_row, "line_load", load)},
                                 {COLUMN(case_row, "point_load", load)},
                                 {SAME(radius)},
                                 {SAME(speed)},
                                 {SAME(thermal_loading)},
                                 {SAME(inlet_heating_factor)},
                                 {SAME(central_film_thickness)},
                                 {SAME(minimum_film_thickness)},
                                 {SAME(central_pressure)},
                                 {SAME(peak_pressure)},
                                 {SAME(rigid_approach)},
                                 {SAME(exit_position)},
                                 {SAME(indicated_deviation)},
                                 {SAME(indicated_deviation_minimum)},
                                 {SAME(friction_coefficient)},
                                 {COLUMN(case_row, "line_friction_force", friction_force)},
                                 {COLUMN(case_row, "point_friction_force", friction_force)},
                                 {COLUMN(case_row, "line_power_loss", power_loss)},
                                 {COLUMN(case_row, "point_power_loss", power_loss)},
                                 {COLUMN(case_row, "line_rolling_resistance", rolling_resistance)},
                                 {COLUMN(case_row, "point_rolling_resistance", rolling_resistance)},
                                 {COLUMN(case_row, "line_rolling_moment", rolling_moment)},
                                 {COLUMN(case_row, "point_rolling_moment", rolling_moment)},
                                 {SAME(mean_shear_stress)},
                                 {SAME(largest_shear_stress)},
                                 {SAME(indicated_deviation_friction)},
                                 {SAME(part), .integer = true},
                                 {SAME(newton_iterations), .integer = true},
                                 {SAME(residual_norm)},
                                 {SAME(solve_seconds)}};

enum { NUM_COLUMNS = sizeof columns / sizeof *columns, NOT_WRITTEN = -1 };

case_row case_row_of(const ehd_contact *contact) {
    const inlet_heating heating = inlet_heating_of(contact);

    return (case_row){.part = NO_PART,
                      .moes_M = contact->moes_M,
                      .moes_L = contact->moes_L,
                      .alpha_p_H = contact->alpha_p_H,
                      .hertz_pressure = contact->hertz_pressure,
                      .half_width = contact->half_width,
                      .film_unit = contact_film_scale(contact),
                      .load = contact->load,
                      .radius = contact->radius,
                      .speed = contact->speed,
                      .thermal_loading = heating.loading,
                      .inlet_heating_factor = heating.factor,
                      .central_film_thickness = NAN,
                      .minimum_film_thickness = NAN,
                      .central_pressure = NAN,
                      .peak_pressure = NAN,
                      .rigid_approach = NAN,
                      .exit_position = NAN,
                      .indicated_deviation = NAN,
                      .indicated_deviation_minimum = NAN,
                      .friction_coefficient = NAN,
                      .indicated_deviation_friction = NAN,
                      .friction_force = NAN,
                      .power_loss = NAN,
                      .rolling_resistance = NAN,
                      .rolling_moment = NAN,
                      .mean_shear_stress = NAN,
                      .largest_shear_stress = NAN,
                      .residual_norm = NAN,
                      .solve_seconds = NAN};
}

static bool is_csv(const char *path) {
    const char *ending = strrchr(path, '.');

    return ending && strcmp(ending, ".csv") == 0;
}

ehd_status case_table_check(const program *caller, ehd_error *error) {
    const char *path = caller->output;

    if (!path) return EHD_OK;
    if (!is_csv(path) && !artefact_is_table(path))
        return ehd_fail(error, EHD_USAGE, "--output: found %s, expected NAME.csv or NAME.h5", path);
    return output_file_check(path, caller->force, error);
}

// ---- which columns

static const artefact_field *field_of(size_t index) {
    return artefact_find(schema_cases.fields, columns[index].field);
}

static double real_of(const case_row *row, size_t index) {
    double value;

    memcpy(&value, (const char *)row + columns[index].offset, sizeof value);
    return value;
}

static int64_t integer_of(const case_row *row, size_t index) {
    int64_t value;

    memcpy(&value, (const char *)row + columns[index].offset, sizeof value);
    return value;
}

/* A line `BYTES SHA-256` of NAME.resume: length and checksum of the table after a write. */
typedef struct done_mark {
    size_t bytes;
    char checksum[SHA256_TEXT];
} done_mark;

struct case_table {
    const program *caller;
    const case_list *list;
    bool expected[NUM_COLUMNS]; // whether some row will have a value
    size_t num_expected;
    bool written[NUM_COLUMNS];
    int units[NUM_COLUMNS]; // for each column, the number of the column with its SI unit (unit_of)
    size_t num_rows;        // rows written
    artefact *file;         // NULL for CSV
    output_file out;        // CSV file, not stdout
    FILE *stream;           // CSV: stream of `out`, or stdout
    char *identity;         // CSV: path of NAME.resume, which identifies the run and has its marks
    FILE *marks;            // CSV: the file `identity`, open to append
    done_mark mark;         // CSV: the last mark
    struct sha256_ctx hash; // CSV: SHA-256 of the bytes up to the last mark
    csv_file done;          // CSV: rows of an interrupted run, read one by one
    size_t status_column, next_status;
};

static bool is_known(size_t index, const case_row *row) {
    return columns[index].integer ? integer_of(row, index) != NO_PART : !isnan(real_of(row, index));
}

/* Checks whether the table has a column. The table has an optional column if some row has a value
 * for the column. Columns with the prefix line_ are only for line contacts, columns with the prefix
 * point_ only for the other kinds. */
static bool applies(const case_table *self, size_t index, const contact_kind *kind) {
    const char *other = kind->dimensions > 1 ? "line_" : "point_";

    return field_of(index)->need != NEED_OPTIONAL ||
           (self->expected[index] && strncmp(columns[index].field, other, strlen(other)) != 0);
}

/* Returns the number of the column that holds the SI unit of column `index`, for example half_width
 * for exit_position. Returns NOT_WRITTEN if column `index` has no such unit, or if the table does
 * not have the column of the unit. */
static int unit_of(size_t index, const bool *written) {
    const artefact_scale *scale = field_of(index)->scale;

    for (size_t c = 0; scale && c < NUM_COLUMNS; c++)
        if (written[c] && strcmp(columns[c].field, scale->frame) == 0) return (int)c;
    return NOT_WRITTEN;
}

// ---- CSV

static void print_header(const case_table *self, FILE *stream) {
    for (size_t c = 0; c < case_list_num_columns(self->list); c++)
        fprintf(stream, "%s,", case_list_key(self->list, c));
    for (size_t c = 0; c < NUM_COLUMNS; c++) {
        const char *units = field_of(c)->units;
        if (!self->written[c]) continue;
        fputs(columns[c].field, stream);
        if (strcmp(units, "1") != 0) fprintf(stream, " [%s]", units);
        fputc(',', stream);
    }
    for (size_t c = 0; c < NUM_COLUMNS; c++)
        if (self->units[c] != NOT_WRITTEN)
            fprintf(stream, "%s [%s],", columns[c].field, field_of((size_t)self->units[c])->units);
    fputs("reason\n", stream);
}

static void print_row(const case_table *self, const case_row *row, const case_texts *texts,
                      FILE *stream) {
    for (size_t c = 0; c < case_list_num_columns(self->list); c++) {
        print_csv_text(texts->texts[c], stream);
        fputc(',', stream);
    }
    for (size_t c = 0; c < NUM_COLUMNS; c++) {
        if (!self->written[c]) continue;
        if (columns[c].integer)
            fprintf(stream, "%" PRId64, integer_of(row, c));
        else
            print_csv_real(real_of(row, c), stream);
        fputc(',', stream);
    }
    for (size_t c = 0; c < NUM_COLUMNS; c++) {
        if (self->units[c] == NOT_WRITTEN) continue;
        print_csv_real(real_of(row, c) * real_of(row, (size_t)self->units[c]), stream);
        fputc(',', stream);
    }
    print_csv_text(row->reason, stream);
    fputc('\n', stream);
}

static ehd_status no_memory(const case_table *self, ehd_error *error) {
    return ehd_no_memory(error, self->caller->output ? self->caller->output : "stdout");
}

static ehd_status not_resumable(const case_table *self, const char *found, ehd_error *error) {
    return ehd_fail(
        error, EHD_DATA,
        "%s.partial: found %s, expected what an interrupted run of the same settings and "
        "inputs left (or --force, without --resume)",
        self->caller->output, found);
}

/* Makes the text that identifies a run: program, settings, and checksums of the input files. Free
 * with free(). */
static ehd_status describe(char **text, const case_table *self, const char *settings_text,
                           const char *const *inputs, ehd_error *error) {
    char identity[SHA256_TEXT];
    size_t size;
    FILE *stream = open_memstream(text, &size);
    ehd_status status = stream ? EHD_OK : no_memory(self, error);

    if (!stream) *text = NULL;
    if (stream) fprintf(stream, "%s\n%s\n", program_build(), settings_text);
    for (; *inputs && !status; inputs++) {
        status = artefact_file_identity(identity, *inputs, error);
        if (!status) fprintf(stream, "%s\n", identity);
    }
    if (stream && fclose(stream) != 0 && !status) status = no_memory(self, error);
    return status;
}

static char *header_of(const case_table *self) {
    char *text;
    size_t size;
    FILE *stream = open_memstream(&text, &size);

    if (!stream) return NULL;
    print_header(self, stream);
    if (fclose(stream) == 0) return text;
    free(text);
    return NULL;
}

static char *read_whole(const char *path) {
    size_t length;
    char *text = NULL;
    ehd_error ignored;

    return tree_read_text(&text, &length, path, &ignored) ? NULL : text;
}

static ehd_status failed_mark(const case_table *self, ehd_error *error) {
    return ehd_fail(error, EHD_IO, "%s: found a failed write (%s), expected space", self->identity,
                    strerror(errno));
}

/* Opens the file that identifies the run and keeps its first `kept` bytes. */
static ehd_status open_marks(case_table *self, size_t kept, ehd_error *error) {
    const int descriptor =
        open(self->identity, O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);

    self->marks = descriptor < 0 ? NULL : fdopen(descriptor, "w");
    if (!self->marks && descriptor >= 0) close(descriptor);
    if (!self->marks)
        return ehd_fail(error, EHD_CANTCREATE, "%s: found %s, expected to create it",
                        self->identity, strerror(errno));
    return ftruncate(fileno(self->marks), (off_t)kept) == 0 && fseek(self->marks, 0, SEEK_END) == 0
               ? EHD_OK
               : failed_mark(self, error);
}

/* Writes text to the table, then a mark to NAME.resume. */
static ehd_status put_text(case_table *self, const char *text, size_t length, ehd_error *error) {
    struct sha256_ctx so_far;

    if (fwrite(text, 1, length, self->stream) != length || fflush(self->stream) != 0)
        return ehd_fail(error, EHD_IO, "%s: found a failed write (%s), expected space",
                        self->caller->output ? self->caller->output : "stdout", strerror(errno));
    if (!self->marks) return EHD_OK;
    self->mark.bytes += length;
    sha256_update(&self->hash, length, (const uint8_t *)text);
    so_far = self->hash;
    sha256_end(&so_far, self->mark.checksum);
    return fprintf(self->marks, "%zu %s\n", self->mark.bytes, self->mark.checksum) > 0 &&
                   fflush(self->marks) == 0
               ? EHD_OK
               : failed_mark(self, error);
}

static bool has_rows(const case_table *self) {
    FILE *stream = fopen(self->out.partial, "r");
    int character = 0;

    while (stream && character != '\n' && character != EOF)
        character = getc(stream);
    const bool found = character == '\n' && getc(stream) != EOF;
    if (stream) fclose(stream);
    return found;
}

static ehd_status open_done(case_table *self, ehd_error *error) {
    csv_close(&self->done);
    ehd_status status = csv_open_rows(&self->done, self->out.partial, error);

    for (size_t i = 0; i < self->done.width && !status; i++)
        if (strcmp(self->done.names[i], "status") == 0) self->status_column = i;
    return status;
}

/* Counts the rows within the first `most` bytes of PATH.partial, up to the first incomplete row.
 * *bytes is the length of the file up to the end of these rows. */
static ehd_status measure_done(case_table *self, size_t most, size_t *bytes, ehd_error *error) {
    ehd_error torn;
    bool found = true;
    ehd_status status = open_done(self, error);

    if (status) return status;
    self->num_rows = 0;
    *bytes = self->done.bytes;
    while (!(status = csv_next_row(&found, &self->done, &torn)) && found && self->done.ended &&
           self->done.bytes <= most) {
        *bytes = self->done.bytes;
        self->num_rows++;
    }
    return status == EHD_MEMORY || status == EHD_IO ? ehd_fail(error, status, "%s", torn.text)
                                                    : open_done(self, error);
}

/* Computes the SHA-256 of the first `bytes` of a file. Returns false if the file is shorter or
 * cannot be read. */
static bool hash_file(struct sha256_ctx *hash, const char *path, size_t bytes) {
    FILE *stream = fopen(path, "r");
    uint8_t block[4096];

    sha256_init(hash);
    while (stream && bytes > 0) {
        const size_t length = fread(block, 1, bytes < sizeof block ? bytes : sizeof block, stream);
        if (length == 0) break;
        sha256_update(hash, length, block);
        bytes -= length;
    }
    if (stream) fclose(stream);
    return stream && bytes == 0;
}

/* Finds the last mark in `text` whose number of bytes is at most `size`, the length of the table.
 * Returns the length of `text` up to the end of this mark's line, or 0 if there is no mark. */
static size_t last_mark(done_mark *mark, const char *text, size_t size) {
    const size_t digits = SHA256_TEXT - 1;
    const char *line = text, *end;

    for (; (end = strchr(line, '\n')); line = end + 1) {
        char *behind;
        const size_t bytes = strtoull(line, &behind, 10);
        if (*behind != ' ' || behind + 1 + strspn(behind + 1, "0123456789abcdef") != end ||
            (size_t)(end - behind) != digits + 1 || bytes > size)
            break;
        mark->bytes = bytes;
        memcpy(mark->checksum, behind + 1, digits);
        mark->checksum[digits] = '\0';
    }
    return (size_t)(line - text);
}

/* Accepts the rows up to the last mark if their checksum is right. *kept is the length of the marks
 * up to the end of the last mark. */
static ehd_status take_marked(case_table *self, size_t *kept, size_t *bytes, const char *marks,
                              ehd_error *error) {
    struct stat found;
    const size_t size = stat(self->out.partial, &found) == 0 ? (size_t)found.st_size : 0;
    char checksum[SHA256_TEXT];

    *kept = last_mark(&self->mark, marks, size);
    if (*kept == 0) return not_resumable(self, "rows without a checksum", error);
    if (!hash_file(&self->hash, self->out.partial, self->mark.bytes))
        return not_resumable(self, "fewer rows than were written", error);
    struct sha256_ctx so_far = self->hash;
    sha256_end(&so_far, checksum);
    if (strcmp(checksum, self->mark.checksum) != 0)
        return not_resumable(self, "damaged rows", error);
    const ehd_status status = measure_done(self, self->mark.bytes, bytes, error);
    return status || *bytes == self->mark.bytes ? status
                                                : not_resumable(self, "damaged rows", error);
}

static ehd_status refuse_rows(case_table *self, ehd_error *error) {
    size_t bytes;
    const ehd_status status = measure_done(self, SIZE_MAX, &bytes, error);

    return status ? status
                  : ehd_fail(error, EHD_CANTCREATE,
                             "%s: found an interrupted run with %zu cases, expected --resume to "
                             "continue it or --force to replace it",
                             self->out.partial, self->num_rows);
}

/* Finds the rows of an interrupted run. *bytes is the length of the table up to the end of these
 * rows. *kept is the length of NAME.resume up to the mark of these rows. Returns EHD_DATA if the
 * rows belong to another run or are damaged. */
static ehd_status find_done(case_table *self, size_t *kept, size_t *bytes, const char *text,
                            bool resume, ehd_error *error) {
    const size_t length = strlen(text);
    char *marks = NULL;
    ehd_status status = EHD_OK;

    if (access(self->identity, F_OK) != 0 || !has_rows(self)) return EHD_OK;
    if (!resume) return refuse_rows(self, error);
    marks = read_whole(self->identity);
    if (!marks || strncmp(marks, text, length) != 0)
        status = not_resumable(self, "other settings or inputs", error);
    else
        status = take_marked(self, kept, bytes, marks + length, error);
    free(marks);
    *kept += length;
    return status;
}

static ehd_status put_header(case_table *self, ehd_error *error) {
    char *header = header_of(self);
    const ehd_status status =
        header ? put_text(self, header, strlen(header), error) : no_memory(self, error);

    free(header);
    return status;
}

static ehd_status begin_csv_file(case_table *self, const char *settings_text,
                                 const char *const *inputs, bool resume, ehd_error *error) {
    const program *caller = self->caller;
    char *text = NULL;
    size_t bytes = 0, kept = 0;

    if (asprintf(&self->identity, "%s.resume", caller->output) < 0) self->identity = NULL;
    ehd_status status = self->identity ? describe(&text, self, settings_text, inputs, error)
                                       : no_memory(self, error);
    if (!status) status = output_file_open(&self->out, caller->output, caller->force, error);
    if (!status && (resume || !caller->force))
        status = find_done(self, &kept, &bytes, text, resume, error);
    if (status) output_file_leave(&self->out); // a file of another run stays
    if (self->num_rows == 0) bytes = kept = 0;
    if (!status) status = output_file_keep(&self->out, bytes, error);
    self->stream = self->out.stream;
    if (!status) status = open_marks(self, kept, error);
    if (!status && bytes == 0) {
        sha256_init(&self->hash);
        self->mark.bytes = 0;
        if (fputs(text, self->marks) < 0) status = failed_mark(self, error);
        if (!status) status = put_header(self, error);
    }
    free(text);
    return status;
}

static ehd_status begin_csv(case_table *self, const char *settings_text, const char *const *inputs,
                            bool resume, ehd_error *error) {
    if (self->caller->output) return begin_csv_file(self, settings_text, inputs, resume, error);
    self->stream = stdout;
    return put_header(self, error);
}

static ehd_status put_csv(case_table *self, const case_row *rows, const case_texts *texts,
                          size_t count, ehd_error *error) {
    char *text = NULL;
    size_t length;
    FILE *stream = open_memstream(&text, &length);
    ehd_status status = stream ? EHD_OK : no_memory(self, error);

    for (size_t i = 0; i < count && stream; i++)
        print_row(self, &rows[i], &texts[i], stream);
    if (stream && fclose(stream) != 0) status = no_memory(self, error);
    if (!status) status = put_text(self, text, length, error);
    free(text);
    return status;
}

// ---- HDF5

static ehd_status create_hdf5(case_table *self, const contact_kind *kind, const ehd_grid *grid,
                              const char *settings_text, const char *const *inputs,
                              ehd_error *error) {
    ehd_status status = artefact_create_growing(&self->file, self->caller->output, &schema_cases,
                                                "case", self->caller, settings_text, inputs, error);

    if (!status) status = grid_write_attributes(self->file, kind, grid, error);
    for (size_t c = 0; c < NUM_COLUMNS && !status; c++)
        if (self->written[c]) status = artefact_declare(self->file, columns[c].field, error);
    return status ? status : artefact_begin_streaming(self->file, error);
}

/* Continues a file whose inputs have not changed. Returns EHD_NOINPUT if there is no such file. */
static ehd_status resume_hdf5(case_table *self, const char *settings_text,
                              const char *const *inputs, ehd_error *error) {
    ehd_status status = artefact_resume(&self->file, self->caller->output, &schema_cases,
                                        self->caller, settings_text, error);

    for (; !status && *inputs; inputs++)
        status = artefact_check_input(self->file, "input", *inputs, error);
    for (size_t c = 0; c < NUM_COLUMNS && !status; c++)
        if (self->written[c] != artefact_has(self->file, columns[c].field))
            status = not_resumable(self, "other columns", error);
    if (!status) self->num_rows = artefact_length(self->file, "case");
    if (!status) status = artefact_cut_axis(self->file, "case", self->num_rows, error);
    return status;
}

static ehd_status begin_hdf5(case_table *self, const contact_kind *kind, const ehd_grid *grid,
                             const char *settings_text, const char *const *inputs, bool resume,
                             ehd_error *error) {
    const size_t most = schema_cases.axes->max;

    if (self->num_expected > most)
        return ehd_fail(error, EHD_DATA,
                        "%s: found %zu cases, expected at most %zu, or a CSV table",
                        self->caller->output, self->num_expected, most);
    if (resume) {
        const ehd_status status = resume_hdf5(self, settings_text, inputs, error);
        if (status != EHD_NOINPUT) return status;
    }
    return create_hdf5(self, kind, grid, settings_text, inputs, error);
}

static ehd_status put_hdf5(case_table *self, const case_row *rows, size_t count, ehd_error *error) {
    ehd_status status = EHD_OK;

    for (size_t c = 0; c < NUM_COLUMNS && !status; c++)
        if (self->written[c])
            status = column_put(self->file, &columns[c], self->num_rows, rows, sizeof *rows, count,
                                error);
    if (!status)
        status = artefact_put_axis_part(self->file, "case", self->num_rows, count, NULL, error);
    if (!status) status = artefact_flush(self->file, error);
    if (!status) artefact_save(self->file);
    return status;
}

// ---- both

ehd_status case_table_new(case_table **table, const program *caller, ehd_error *error) {
    case_table *self = *table = calloc(1, sizeof *self);

    if (!self) return ehd_no_memory(error, "cases");
    self->caller = caller;
    return EHD_OK;
}

void case_table_expect(case_table *self, const case_row *row) {
    self->num_expected++;
    for (size_t c = 0; c < NUM_COLUMNS; c++)
        self->expected[c] = self->expected[c] || is_known(c, row);
}

ehd_status case_table_begin(case_table *self, size_t *num_done, const case_list *list,
                            const contact_kind *kind, const ehd_grid *grid,
                            const char *settings_text, const char *const *inputs, bool resume,
                            ehd_error *error) {
    self->list = list;
    for (size_t c = 0; c < NUM_COLUMNS; c++)
        self->written[c] = applies(self, c, kind);
    for (size_t c = 0; c < NUM_COLUMNS; c++)
        self->units[c] = unit_of(c, self->written);
    const ehd_status status =
        self->caller->output && !is_csv(self->caller->output)
            ? begin_hdf5(self, kind, grid, settings_text, inputs, resume, error)
            : begin_csv(self, settings_text, inputs, resume, error);
    *num_done = self->num_rows;
    return status;
}

ehd_status case_table_status(int64_t *status, case_table *self, ehd_error *error) {
    bool found = false;
    double value = 0;

    if (self->file)
        return artefact_get_integers_part(self->file, "status", self->next_status++, 1, status, 1,
                                          error);
    const ehd_status outcome = csv_next_row(&found, &self->done, error);
    if (outcome) return outcome;
    if (!found || !number_read(&value, self->done.fields[self->status_column]))
        return not_resumable(self, "a row without status", error);
    *status = (int64_t)value;
    return EHD_OK;
}

ehd_status case_table_put(case_table *self, const case_row *rows, const case_texts *texts,
                          size_t count, ehd_error *error) {
    const ehd_status status =
        self->file ? put_hdf5(self, rows, count, error) : put_csv(self, rows, texts, count, error);

    if (!status) self->num_rows += count;
    return status;
}

static void release(case_table **table) {
    csv_close(&(*table)->done);
    if ((*table)->marks) fclose((*table)->marks);
    free((*table)->identity);
    free(*table);
    *table = NULL;
}

ehd_status case_table_finish(case_table **table, ehd_error *error) {
    case_table *self = *table;
    ehd_status status = EHD_OK;

    if (self->file) status = artefact_finish(&self->file, error);
    if (self->out.stream) {
        status = output_file_finish(&self->out, error);
        unlink(self->identity);
    }
    release(table);
    return status;
}

void case_table_close(case_table **table) {
    case_table *self = *table;

    if (!self) return;
    artefact_close(&self->file);
    if (self->num_rows > 0) {
        output_file_leave(&self->out);
    } else if (self->out.stream) {
        output_file_drop(&self->out);
        unlink(self->identity);
    }
    release(table);
}
