/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads and writes artefacts: the HDF5 files that link the programs. Only this folder calls HDF5.
 *
 * Only one function of this folder may run at a time in a process, even if the calls use different
 * files: Debian builds HDF5 without thread safety. HDF5 prints nothing, loads no filter plugins,
 * and is not shut down at exit.
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

enum { ARTEFACT_MAX_RANK = 4, ARTEFACT_MAX_NODES = 100000000 };

typedef enum artefact_type { ARTEFACT_REAL, ARTEFACT_INTEGER, ARTEFACT_TEXT } artefact_type;
typedef enum artefact_need {
    NEED_ALWAYS,  // every program that makes such a file must write the item
    NEED_OWN,     // our programs always write the item; readers accept files without it
    NEED_OPTIONAL // the settings decide whether the item is written
} artefact_need;

/* Ranges for the numbers of a field or an attribute (values.c). If the entries of a field have a
 * `status`, the range applies only to entries with status 0. */
typedef enum artefact_values {
    VALUES_ANY,
    VALUES_FINITE,
    VALUES_KNOWN, // finite, or NaN if unknown
    VALUES_POSITIVE,
    VALUES_POSITIVE_OR_NAN,
    VALUES_NOT_NEGATIVE,
    VALUES_BOUND, // not negative (may be infinite), or NaN if unknown
    // of integers
    VALUES_FLAG,
    VALUES_COUNT,
    VALUES_INDEX_OR_NONE,
    VALUES_STATE_OR_NONE,
    VALUES_COLUMN,      // index into x; the length of x means no column
    VALUES_FILM_COLUMN, // column of film nodes, from 1 to the number of columns
    VALUES_ROW,         // indices of inner nodes of the grid, no index twice
    VALUES_FILM_NODE    // indices of film nodes, ascending
} artefact_values;

/* Describes the factor that converts a dimensionless number to SI units. The factor is the first of
 * `attributes` that the file has. The schema gives the SI unit of that attribute. If `frame` is
 * set, the factor is also multiplied by the field `frame`, because each entry has a unit of its
 * own, such as the half width at its time. */
typedef struct artefact_scale {
    // names of the attributes that hold the unit, such as "film_unit"; NULL: `frame` holds the unit
    const char *attributes[2];
    // name of a field along one axis, whose values are multiples of the attribute; NULL: no field
    const char *frame;
} artefact_scale;

typedef struct artefact_axis {
    const char *name;            // "x", "state", "pressure_mode"
    const char *units;           // "1"
    const char *long_name;       // meaning; the values of a pure index are 0, 1, 2, …
    size_t max;                  // a longer axis is refused
    bool optional;               // a file may lack the axis; fields then leave the axis out
    const artefact_scale *scale; // NULL: the numbers are dimensionless, or already in SI units
} artefact_axis;

/* A dataset, or an attribute of the root. */
typedef struct artefact_field {
    const char *name;
    artefact_type type;                  // dataset: REAL (IEEE f64 LE) or INTEGER (i64 LE)
    const char *axes[ARTEFACT_MAX_RANK]; // NULL after the last axis; an attribute has none
    const char *units;                   // UDUNITS; "1" if dimensionless
    const char *long_name;
    artefact_need need;
    artefact_values values;
    bool by_entry; // read entry by entry along the first axis; most entries may be missing
    const artefact_scale *scale; // NULL: the numbers are dimensionless, or already in SI units
} artefact_field;

typedef struct artefact_schema {
    const char *name;                 // "ehdrom-snapshots"
    int major, minor;                 // readers refuse only a larger major version
    const char *title;                // attribute `title` of such a file
    const artefact_axis *axes;        // ends with {0}
    const artefact_field *fields;     // ends with {0}
    const artefact_field *attributes; // ends with {0}
} artefact_schema;

extern const artefact_schema schema_result, schema_snapshots, schema_basis, schema_part,
    schema_residuals, schema_model, schema_cases;
extern const artefact_schema *const artefact_schemas[]; // all schemas, NULL at the end

/* Finds an entry in the fields or attributes of a schema; NULL: there is none of this name. */
const artefact_field *artefact_find(const artefact_field *list, const char *name);

typedef struct artefact artefact;

// ---- writing

/* Creates PATH.partial for writing. PATH itself is untouched until artefact_finish. EHD_CANTCREATE:
 * PATH.partial cannot be written, or another process writes PATH.partial. Without program->force,
 * the function also returns EHD_CANTCREATE if PATH exists, or if PATH.partial holds finished work
 * of an interrupted run.
 *
 * `settings_text` is stored as attribute `settings`. For each path in `inputs` (NULL-terminated,
 * may be NULL), the attributes `input_<n>_path` and `input_<n>_sha256` store the path and the
 * SHA-256 of the file. The attribute `history` has the history lines of all inputs that are
 * artefacts, followed by the line of this run. */
ehd_status artefact_create(
    // output:
    artefact **file,
    // input:
    const char *path, const artefact_schema *schema, const program *program,
    const char *settings_text, const char *const *inputs, ehd_error *error);

/* Creates a file like artefact_create, with a growing axis that has no entries yet. Only the first
 * axis of a field may grow. An entry that was never written is read as NaN (real numbers) or -1
 * (integers). If an entry has several numbers, it takes no space on disk until it is written. */
ehd_status artefact_create_growing(
    // output:
    artefact **file,
    // input:
    const char *path, const artefact_schema *schema, const char *axis, const program *program,
    const char *settings_text, const char *const *inputs, ehd_error *error);

/* Declares an axis with at least one entry and writes its values as an HDF5 dimension scale. If
 * `values` is NULL, the values are 0, 1, 2, … */
ehd_status artefact_put_axis(artefact *file, const char *name, size_t length, const double *values,
                             ehd_error *error);

/* Writes `count` values of the growing axis, from entry `first` on; NULL: the numbers of the
 * entries. Before this call, write the fields of these entries. If the axis becomes longer, all
 * fields on it grow first, and the axis itself grows last. A reader that looks up the length of the
 * axis therefore finds that many entries in every field. */
ehd_status artefact_put_axis_part(artefact *file, const char *name, size_t first, size_t count,
                                  const double *values, ehd_error *error);

/* Creates the dataset of a field (chunked along its first axis, Fletcher-32, fill NaN or -1) and
 * attaches units, long_name and dimension scales. All axes of the field must exist. artefact_put
 * declares a field itself if needed. */
ehd_status artefact_declare(artefact *file, const char *field, ehd_error *error);

/* Declares a field like artefact_declare, but each entry along the first axis has a checksum of its
 * own. If the process is killed while it overwrites one entry, the other entries stay intact. */
ehd_status artefact_declare_apart(artefact *file, const char *field, ehd_error *error);

/* Write a whole field, `count` entries of a field along its first axis from entry `first` on, or an
 * attribute. A field on the growing axis grows as needed. */
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

/* Starts streaming (HDF5: single writer, multiple readers). From now on other processes may read
 * the file, and the file stays readable even if the writer is killed. All NEED_ALWAYS and NEED_OWN
 * fields must have been declared, and all NEED_ALWAYS attributes written (else EHD_INTERNAL).
 * Afterwards, only artefact_put*_part on declared fields and on the growing axis, artefact_flush,
 * artefact_end_streaming, artefact_finish and artefact_close are allowed.
 *
 * Entries reach the file in the order of the calls. If the `status` of an entry is written last, a
 * reader therefore never sees this status before the data of the entry. */
ehd_status artefact_begin_streaming(artefact *file, ehd_error *error);
ehd_status artefact_flush(artefact *file, ehd_error *error);
/* Flushes like artefact_flush and waits until the data are on the disk, so that they survive a
 * power cut. Error: EHD_IO. */
ehd_status artefact_sync(artefact *file, ehd_error *error);
/* Copies a file with a growing axis to PATH.saved; does nothing for other files. Call it after
 * artefact_flush. The copy is needed because each entry changes HDF5's metadata, and a power cut
 * can leave the metadata inconsistent. artefact_resume then continues from PATH.saved.
 * artefact_begin_streaming makes the first copy. artefact_save makes another copy only after a
 * pause of fifty times the duration of the last copy. If copying fails, the earlier copy stays. */
void artefact_save(artefact *file);

/* Ends streaming and returns to ordinary writing, for attributes that are known only at the end.
 * artefact_finish calls this function if needed. Does nothing if the file is not streaming. */
ehd_status artefact_end_streaming(artefact *file, ehd_error *error);

/* Opens PATH.partial of an earlier run to continue it, and starts streaming again (see
 * artefact_begin_streaming). If the machine has been rebooted since then and PATH.saved exists,
 * PATH.saved is used instead. The axes and declared fields of the file can also be read.
 *
 * EHD_NOINPUT: there is no PATH.partial, or its run was interrupted before it streamed. EHD_DATA:
 * the file is damaged, or its schema or settings (scene_text_matches) differ. EHD_CANTCREATE: PATH
 * exists and program->force is not set, or another process writes the file.
 *
 * A file with a growing axis does not stream yet after this call. Its datasets may differ in
 * length, because a killed run may have written its last entries to only some of these datasets.
 * Therefore call artefact_cut_axis next. */
ehd_status artefact_resume(
    // output:
    artefact **file,
    // input:
    const char *path, const artefact_schema *schema, const program *program,
    const char *settings_text, ehd_error *error);

/* Checks one finished training state after artefact_resume. EHD_DATA: the data of the state are
 * damaged, or a number is out of range. artefact_resume itself does not check the states, because
 * states that a killed run had not finished may be damaged. */
ehd_status artefact_check_entry(artefact *file, size_t entry, ehd_error *error);

/* Checks after artefact_resume that an input still has the content that it had when the output was
 * begun. If no recorded input has this path, any recorded input with the same content is accepted.
 * EHD_DATA: the content differs; the message names the input `what`. Other errors: EHD_NOINPUT,
 * EHD_IO. */
ehd_status artefact_check_input(artefact *file, const char *what, const char *path,
                                ehd_error *error);

/* Cuts the growing axis to its first `length` entries, checks these entries, and starts streaming
 * again (see artefact_begin_streaming). Call it only after artefact_resume. EHD_DATA: the file has
 * fewer entries, kept entries are damaged, or no axis grows. */
ehd_status artefact_cut_axis(artefact *file, const char *name, size_t length, ehd_error *error);

/* Copies all axes, fields and attributes of the schema from an opened file to an empty file of the
 * same schema, except the axes in `except_axes` and the fields along these axes. `from` may come
 * from another program. NEED_OWN items that `from` lacks may also be missing in the copy. */
ehd_status artefact_copy(
    // output:
    artefact *to,
    // input:
    artefact *from,
    const char *const *except_axes, // names of the axes, ended by NULL; NULL: all axes are copied
    ehd_error *error);

/* Writes `complete` = 1 last, closes the file and checks every error, waits until the file is on
 * disk, and gives it the final name. All NEED_ALWAYS and NEED_OWN items must have been written, and
 * a growing axis must have an entry (else EHD_INTERNAL). Frees the file in any case. On failure
 * PATH.partial stays if it was streaming or if only syncing or renaming failed; otherwise it is
 * removed. */
ehd_status artefact_finish(artefact **file, ehd_error *error);

/* HDF5 settings of a host program, in whose process the library reads files. artefact_visit saves
 * these settings and sets ours; artefact_leave restores the saved settings. HDF5's behaviour at
 * exit does not change. Only one thread at a time may be between the two calls. */
typedef struct artefact_guest {
    void (*print)(void); // HDF5's function for printing errors
    void *data;
    unsigned plugins;
} artefact_guest;
artefact_guest artefact_visit(void);
void artefact_leave(const artefact_guest *host);

// ---- reading

/* Opens a finished artefact for reading. `schemas` lists the accepted schemas, with NULL at the
 * end. EHD_NOINPUT: there is no such file. EHD_DATA: the file is empty, is truncated or is not
 * HDF5; it has a wrong schema, a newer major version or complete = 0; or a required field is
 * missing, has another rank, or has axes of unequal length. */
ehd_status artefact_open(
    // output:
    artefact **file,
    // input:
    const char *path, const artefact_schema *const *schemas, ehd_error *error);

/* Closes without finishing. A file that was streaming stays as PATH.partial; any other file being
 * written is removed. Accepts a NULL file. */
void artefact_close(artefact **file);

/* Opens a file like artefact_open, but also accepts a file that is being written or was left
 * unfinished (PATH.partial). The growing axis gives the number of valid entries. Fields on this
 * axis may be longer; read these fields with artefact_get_part. */
ehd_status artefact_open_unfinished(
    // output:
    artefact **file,
    // input:
    const char *path, const artefact_schema *const *schemas, ehd_error *error);

const artefact_schema *artefact_kind(const artefact *file);
const char *artefact_path(const artefact *file);
/* Returns the SHA-256 of the opened file, 64 hexadecimal digits. */
ehd_status artefact_identity(artefact *file, char identity[65], ehd_error *error);

/* Returns the SHA-256 of any file. Errors: EHD_NOINPUT, EHD_IO. */
ehd_status artefact_file_identity(char identity[65], const char *path, ehd_error *error);

/* Returns how the content digest of a file is treated: "digest checked", "digest not checked" if
 * checking is switched off, or content_without_digest. NULL: the file is no artefact. */
const char *artefact_content(const char *path);
extern const char *const content_without_digest;

bool artefact_has(const artefact *file, const char *field_or_attribute);
/* Returns the length of an axis; 0 if the file does not have the axis. */
size_t artefact_length(const artefact *file, const char *axis);
/* Lists the axes of a field in this file, without optional axes that the file lacks. Returns the
 * number of listed axes. */
size_t artefact_axes(const char *axes[ARTEFACT_MAX_RANK], const artefact *file,
                     const artefact_field *field);
/* Checks whether an axis has values for artefact_get_axis. */
bool artefact_has_scale(const artefact *file, const char *axis);

/* Read into the caller's memory, which has room for `room` numbers. EHD_DATA: the file does not
 * have exactly `room` numbers (for example, because its axes do not fit each other), a checksum
 * fails, or an optional field, an optional attribute or the scale of an axis is missing. Files of
 * other programs may lack scales of axes. artefact_length then still works, but artefact_get_axis
 * returns EHD_DATA. */
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
/* Reads a text; free it with free(). */
ehd_status artefact_get_text(artefact *file, const char *attribute, char **text, ehd_error *error);
/* Returns any attribute of the root as text; free it with free(). Numbers have all digits that are
 * needed to read back the same value. */
ehd_status artefact_show_attribute(artefact *file, const char *attribute, char **text,
                                   ehd_error *error);
/* Returns the factor by which a scale converts numbers to SI units, and these units. The factor
 * does not contain the field `frame`. If the scale has no attributes, the factor is 1. EHD_DATA:
 * the file lacks the attribute, because its contact was not given in SI units. */
ehd_status artefact_get_scale(
    // output:
    double *factor, const char **units,
    // input:
    artefact *file, const artefact_scale *scale, ehd_error *error);

/* Visits the names of all attributes of the root, including attributes outside the schema, in the
 * order of their names. */
void artefact_visit_attributes(const artefact *file, void (*visit)(const char *name, void *data),
                               void *data);

/* Checks a file (--check FILE): opens it with any of the known schemas and reads every dataset of
 * its schema, so that every checksum is verified. */
ehd_status artefact_check(const char *path, ehd_error *error);

#endif
