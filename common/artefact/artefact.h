/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Artefacts: the HDF5 files that link the programs. The only place that speaks HDF5.
 *
 * HDF5 as Debian builds it is not thread-safe: of all functions here, only one may run at a time in
 * a process, whatever files they work on. HDF5 prints nothing, loads no filter plugins, and is not
 * shut down at exit.
 *
 * A field is declared once in a schema table (schemas.c); reader, writer and the pages in schemas/
 * all use that declaration. */
#ifndef EHD_ARTEFACT_H
#define EHD_ARTEFACT_H

#include "common/program/program.h"
#include "common/program/status.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

enum { ARTEFACT_MAX_RANK = 4, ARTEFACT_MAX_NODES = 100000000 };

typedef enum artefact_type { ARTEFACT_REAL, ARTEFACT_INTEGER, ARTEFACT_TEXT } artefact_type;
typedef enum artefact_need {
    NEED_ALWAYS,  // a foreign program must write it too
    NEED_OWN,     // our programs always write it; a reader can do without
    NEED_OPTIONAL // depends on the settings
} artefact_need;

/* What the numbers of a field or an attribute may be (values.c), of a field whose entries have a
 * `status` where that is 0. */
typedef enum artefact_values {
    VALUES_ANY,
    VALUES_FINITE,
    VALUES_KNOWN, // finite, or NaN where not known
    VALUES_POSITIVE,
    VALUES_POSITIVE_OR_NAN,
    VALUES_NOT_NEGATIVE,
    VALUES_BOUND, // not negative, also infinite, or NaN where not known
    // integers
    VALUES_FLAG,
    VALUES_COUNT,
    VALUES_INDEX_OR_NONE,
    VALUES_STATE_OR_NONE,
    VALUES_COLUMN,      // of x, or its length where there is none
    VALUES_FILM_COLUMN, // of the nodes of the film, or their number, but for the first
    VALUES_ROW,         // inner nodes of the grid, each once
    VALUES_FILM_NODE    // nodes of the film, ascending
} artefact_values;

/* What makes SI units of a dimensionless number: the first of these attributes that a file has, in
 * the units of its row, and where the number is in a frame of its own, that frame's too. */
typedef struct artefact_scale {
    const char *attributes[2]; // "film_unit"; NULL: the frame has the units
    const char *frame;         // field along one axis, relative to the attribute; NULL: none
} artefact_scale;

typedef struct artefact_axis {
    const char *name;            // "x", "state", "pressure_mode"
    const char *units;           // "1"
    const char *long_name;       // index axes get 0, 1, 2, … as their scale
    size_t max;                  // longer ones are refused
    bool optional;               // fields are on it only in a file that has it
    const artefact_scale *scale; // NULL: without dimension, or in SI units; as in fields
} artefact_axis;

typedef struct artefact_field {
    const char *name;
    artefact_type type;                  // REAL (IEEE f64 LE) or INTEGER (i64 LE)
    const char *axes[ARTEFACT_MAX_RANK]; // NULL after the last one
    const char *units;                   // UDUNITS; "1" if dimensionless
    const char *long_name;
    artefact_need need;
    artefact_values values;
    bool by_entry; // along the first axis: most entries need not be there
    const artefact_scale *scale;
} artefact_field;

typedef struct artefact_attribute {
    const char *name;
    artefact_type type;
    const char *units; // stated on the schema page
    const char *long_name;
    artefact_need need;
    artefact_values values;
    const artefact_scale *scale;
} artefact_attribute;

typedef struct artefact_schema {
    const char *name;                     // "ehdrom-snapshots"
    int major, minor;                     // a reader refuses a larger major, accepts any minor
    const char *title;                    // what such a file holds
    const artefact_axis *axes;            // ends with {0}
    const artefact_field *fields;         // ends with {0}
    const artefact_attribute *attributes; // ends with {0}
} artefact_schema;

extern const artefact_schema schema_result, schema_snapshots, schema_basis, schema_part,
    schema_residuals, schema_model, schema_cases;
extern const artefact_schema *const artefact_schemas[]; // all of them, NULL at the end

typedef struct artefact artefact;

// ---- writing

/* Creates PATH.partial for writing; PATH itself is untouched until artefact_finish. Fails with
 * EHD_CANTCREATE when PATH exists, or PATH.partial with what an interrupted run finished, and
 * program->force is not set; when it cannot be written, or another process is writing PATH.partial.
 * `settings_text` is stored as attribute `settings`; `inputs` (NULL-terminated paths, may be NULL)
 * are hashed (SHA-256) into `input_<n>_path`, `input_<n>_sha256`, and the history lines of those
 * that are artefacts come before our own line. */
ehd_status artefact_create(
    // output:
    artefact **file,
    // input:
    const char *path, const artefact_schema *schema, const program *program,
    const char *settings_text, const char *const *inputs, ehd_error *error);

/* The same, with an axis that grows, of no entry yet. Fields may have it as their first axis only;
 * what is never written of them reads as NaN or -1, and entries of more than one number then take
 * no space on disk. */
ehd_status artefact_create_growing(
    // output:
    artefact **file,
    // input:
    const char *path, const artefact_schema *schema, const char *axis, const program *program,
    const char *settings_text, const char *const *inputs, ehd_error *error);

/* Declares an axis of this file, of at least one entry, and writes its scale; `values` NULL: 0, 1,
 * 2, … as integers. */
ehd_status artefact_put_axis(artefact *file, const char *name, size_t length, const double *values,
                             ehd_error *error);

/* Writes `count` values of the growing axis from `first` on. Beyond its length everything on the
 * axis grows, the fields first and the axis itself last: a reader that asks the axis for its length
 * finds as much of every field. Hence it is put after the fields of these entries. */
ehd_status artefact_put_axis_part(artefact *file, const char *name, size_t first, size_t count,
                                  const double *values, ehd_error *error);

/* Creates the dataset (chunked along its first axis, Fletcher-32, fill NaN or -1), units, long_name
 * and scales attached; all of its axes must exist. artefact_put does it when needed. */
ehd_status artefact_declare(artefact *file, const char *field, ehd_error *error);

/* The same, with entries along the first axis that share no checksum: a kill while one of them is
 * overwritten leaves the others whole. */
ehd_status artefact_declare_apart(artefact *file, const char *field, ehd_error *error);

/* Writes a whole field, or `count` entries along its first axis from `first` on. A field on the
 * growing axis grows as needed. */
ehd_status artefact_put(artefact *file, const char *field, const double *data, ehd_error *error);
ehd_status artefact_put_integers(artefact *file, const char *field, const int64_t *data,
                                 ehd_error *error);
ehd_status artefact_put_part(artefact *file, const char *field, size_t first, size_t count,
                             const double *data, ehd_error *error);
ehd_status artefact_put_integers_part(artefact *file, const char *field, size_t first, size_t count,
                                      const int64_t *data, ehd_error *error);
ehd_status artefact_put_real(artefact *file, const char *attribute, double value, ehd_error *error);
ehd_status artefact_put_integer(artefact *file, const char *attribute, int64_t value,
                                ehd_error *error);
ehd_status artefact_put_text(artefact *file, const char *attribute, const char *text,
                             ehd_error *error);

/* From here on the file stays readable at any moment, even after a kill, and others may read it
 * (HDF5 single writer, multiple readers). All fields that the schema calls NEED_ALWAYS or NEED_OWN
 * must have been declared, and its NEED_ALWAYS attributes written (else EHD_INTERNAL). Only
 * artefact_put*_part on declared fields and the growing axis may follow, then artefact_flush,
 * artefact_end_streaming, artefact_finish or artefact_close. Entries reach the file in the order of
 * the calls, so a `status` put last is never there before what it speaks of. */
ehd_status artefact_begin_streaming(artefact *file, ehd_error *error);
ehd_status artefact_flush(artefact *file, ehd_error *error);
/* The same, and what was written is on the disk before anything that follows, also where the power is
 * cut. EHD_IO. */
ehd_status artefact_sync(artefact *file, ehd_error *error);
/* After artefact_flush of a file with a growing axis, else without effect: what HDF5 knows of its
 * data changes with each entry, and a power cut between two of these calls tears it. Keeps a copy
 * as it is now, PATH.saved, from which artefact_resume goes on, once as much time has passed since
 * the last one as fifty of them take; artefact_begin_streaming makes the first. A copy that fails
 * is none. */
void artefact_save(artefact *file);

/* Back to ordinary writing, for attributes that are only known at the end. artefact_finish does it
 * when needed. Does nothing when the file is not streaming. */
ehd_status artefact_end_streaming(artefact *file, ehd_error *error);

/* Opens PATH.partial of an earlier run (where the machine has been started since, PATH.saved if
 * there is one), streaming again, with its axes and declared fields, which can also be read.
 * EHD_NOINPUT when there is none, or one that was interrupted before it began to stream, with
 * nothing in it; EHD_DATA when it is damaged, or its schema or settings (scene_text_matches)
 * differ; EHD_CANTCREATE when PATH exists and program->force is not set, or another process is
 * writing. A file with a growing axis is not streaming yet, and what is on the axis may differ in
 * length by the entries that a killed run was writing: artefact_cut_axis has to come next. */
ehd_status artefact_resume(
    // output:
    artefact **file,
    // input:
    const char *path, const artefact_schema *schema, const program *program,
    const char *settings_text, ehd_error *error);

/* After artefact_resume of a training: whether one of its states is whole and its numbers are what
 * they may be; else EHD_DATA. Of those that a killed run had not finished they need not be, and
 * artefact_resume does not look. */
ehd_status artefact_check_entry(artefact *file, size_t entry, ehd_error *error);

/* After artefact_resume: whether a file that the run reads beside its settings is what it was when
 * the output was begun, by its content where it has another name now. EHD_DATA, with `what` it is,
 * when it is not; EHD_NOINPUT, EHD_IO. */
ehd_status artefact_check_input(artefact *file, const char *what, const char *path,
                                ehd_error *error);

/* Drops the entries of the growing axis from `length` on, checks those before, and streams again.
 * Only after artefact_resume. EHD_DATA when the file has fewer entries, those kept are damaged, or no
 * axis grows.
 */
ehd_status artefact_cut_axis(artefact *file, const char *name, size_t length, ehd_error *error);

/* Puts all axes, fields and attributes of an opened file that its schema knows into a file of the
 * same schema that has none yet, but for some axes and the fields along them. What `from`, which may be
 * another program's, lacks of NEED_OWN the copy may lack too. */
ehd_status artefact_copy(
    // output:
    artefact *to,
    // input:
    artefact *from,
    const char *const *except_axes, // NULL at the end; NULL: none
    ehd_error *error);

/* Writes `complete` = 1 last, closes with every error checked, syncs to disk and renames to the
 * final name. Frees the file in any case; on failure the .partial file stays. All fields that the
 * schema calls NEED_ALWAYS or NEED_OWN must have been written, and a growing axis have an entry
 * (else EHD_INTERNAL). */
ehd_status artefact_finish(artefact **file, ehd_error *error);

/* For who reads files inside of somebody else's program: HDF5's own ways of the process are as that
 * program has them again after artefact_leave, and what it does at exit stays. One thread at a time. */
typedef struct artefact_guest {
    void (*print)(void); // how HDF5 shows errors
    void *data;
    unsigned plugins;
} artefact_guest;
artefact_guest artefact_visit(void);
void artefact_leave(const artefact_guest *host);

// ---- reading

/* Opens a finished artefact for reading. Refuses (EHD_NOINPUT: missing; EHD_DATA: not HDF5,
 * truncated, empty, wrong schema, newer major version, complete = 0, a needed field missing, of
 * another rank or with axes of unequal length). `schemas`: the accepted ones, NULL at the end. */
ehd_status artefact_open(
    // output:
    artefact **file,
    // input:
    const char *path, const artefact_schema *const *schemas, ehd_error *error);

/* Closes without finishing; a file being written stays as PATH.partial when it was streaming and is
 * removed otherwise. Accepts a NULL file. */
void artefact_close(artefact **file);

/* The same also of a file that is being written or was left unfinished (PATH.partial), of which the
 * growing axis tells how far it goes: what is on it may be longer, so that it is read by
 * artefact_get_part. */
ehd_status artefact_open_unfinished(
    // output:
    artefact **file,
    // input:
    const char *path, const artefact_schema *const *schemas, ehd_error *error);

const artefact_schema *artefact_kind(const artefact *file);
const char *artefact_path(const artefact *file);
/* SHA-256 of the opened file, 64 hexadecimal digits; computed at the first call. */
ehd_status artefact_identity(artefact *file, char identity[65], ehd_error *error);

/* The same of a file that is not opened. EHD_NOINPUT, EHD_IO. */
ehd_status artefact_file_identity(char identity[65], const char *path, ehd_error *error);

/* What is known of the content of a file: "digest checked", "digest not checked" where that is switched
 * off, or content_without_digest; NULL when it is none of ours. */
const char *artefact_content(const char *path);
extern const char *const content_without_digest;

bool artefact_has(const artefact *file, const char *field_or_attribute);
/* Length of an axis; 0 when the file does not have it. */
size_t artefact_length(const artefact *file, const char *axis);
/* The axes of a field in this file, without the optional ones that it does not have. Returns their
 * number. */
size_t artefact_axes(const char *axes[ARTEFACT_MAX_RANK], const artefact *file,
                     const artefact_field *field);
/* Whether artefact_get_axis has values to give. */
bool artefact_has_scale(const artefact *file, const char *axis);

/* Reads into the caller's memory, which has room for `room` numbers: EHD_DATA where the file has more
 * or fewer, such as one whose axes do not fit each other. A checksum that fails, and an
 * optional field, attribute or scale that the file does not have, are EHD_DATA. A foreign file need
 * not have scales: then artefact_length still works, and artefact_get_axis is EHD_DATA. */
ehd_status artefact_get_axis(artefact *file, const char *axis, double *values, size_t room,
                             ehd_error *error);
ehd_status artefact_get(artefact *file, const char *field, double *data, size_t room,
                        ehd_error *error);
ehd_status artefact_get_integers(artefact *file, const char *field, int64_t *data, size_t room,
                                 ehd_error *error);
ehd_status artefact_get_part(artefact *file, const char *field, size_t first, size_t count,
                             double *data, size_t room, ehd_error *error);
ehd_status artefact_get_integers_part(artefact *file, const char *field, size_t first, size_t count,
                                      int64_t *data, size_t room, ehd_error *error);
ehd_status artefact_get_real(artefact *file, const char *attribute, double *value,
                             ehd_error *error);
ehd_status artefact_get_integer(artefact *file, const char *attribute, int64_t *value,
                                ehd_error *error);
/* Free the text with free(). */
ehd_status artefact_get_text(artefact *file, const char *attribute, char **text, ehd_error *error);
/* Any attribute of the root as text, numbers with as many digits as they have; free(). */
ehd_status artefact_show_attribute(artefact *file, const char *attribute, char **text,
                                   ehd_error *error);
/* The factor of a scale that has no frame, or beside it, and the units of what it makes. EHD_DATA: the
 * file has no such attribute, as of a contact that was not given in SI units. */
ehd_status artefact_get_scale(
    // output:
    double *factor, const char **units,
    // input:
    artefact *file, const artefact_scale *scale, ehd_error *error);

/* Visits the names of all attributes of the root, also of those that no schema knows. */
void artefact_visit_attributes(const artefact *file, void (*visit)(const char *name, void *data),
                               void *data);

/* --check FILE: opens the file as any of the known schemas and reads every dataset that the schema
 * knows, so that every checksum is verified. */
ehd_status artefact_check(const char *path, ehd_error *error);

/* The tables of a schema as Markdown, from which the pages in schemas/ are checked. */
void artefact_print_markdown(const artefact_schema *schema, FILE *stream);

#endif
