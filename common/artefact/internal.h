/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of this folder share; nobody else includes it. */
#ifndef EHD_ARTEFACT_INTERNAL_H
#define EHD_ARTEFACT_INTERNAL_H

#include "common/artefact/artefact.h"
#include "common/artefact/sha256.h"
#include "common/program/arena.h"

#include <hdf5.h>

/* A dataset as it was found when a file was opened. */
typedef struct dataset_shape {
    bool there;
    haddr_t address; // of its header: what a reference to it holds
    int rank;
    hsize_t dims[ARTEFACT_MAX_RANK]; // as far as they fit
    double chunk;                    // numbers of a chunk
} dataset_shape;

struct artefact {
    hid_t id; // of the HDF5 file; negative when it is not open
    const artefact_schema *schema;
    char *path;    // the final name
    char *partial; // the name while it is written; NULL when reading
    char *copy;    // the name of the copy of it that is changed while it is not streaming
    bool on_copy;  // that is what is open
    char *saved;   // the name of a copy of some time ago
    double saved_at, save_seconds; // when that was made, by program_seconds, and what it took
    char *history_line; // of the run that resumes the file, added at the end; NULL otherwise
    char *digests;      // content_sha256 of a file being read; NULL: not to be checked
    bool *checked;      // [number of the schema's fields] read by parts, and their digest checked
    int64_t *outcomes;  // `status` of the entries of outcome_axis; NULL: none
    const char *outcome_axis;
    dataset_shape *shapes; // [axes of the schema, then its fields], as examined
    size_t *lengths;       // [number of the schema's axes], 0: not known (yet)
    const char *growing;   // name of the axis that grows while writing; NULL: none
    hid_t *held;           // [number of the schema's fields + 1], the last for the growing axis:
                           // what is on it, kept open while streaming; 0: not open
    int lock;              // descriptor that holds the writer's lock; -1 when reading
    int copy_lock;         // the same of the copy
    bool force;            // an existing final file may be replaced
    bool streaming;
    bool keep;   // the partial file is of use to --resume
    bool copied; // by artefact_copy, of a file that may lack what only our programs write
    bool failed; // a write failed, so the file must not get its final name
    char identity[65];
};

// ---- hdf5.c: the library's manners and attributes

/* To be called before anything else of HDF5, in each thread: it prints nothing, loads no plugins, and
 * does nothing at exit, where it would try again to write what could not be written. Memory that was
 * refused before is forgotten. */
void hdf5_start(void);

/* The innermost message of the last failed HDF5 call; call it before any other HDF5 function. */
typedef struct hdf5_reason {
    char text[256];
    bool system; // the operating system refused, not the content
    bool memory; // memory was refused
} hdf5_reason;
hdf5_reason hdf5_last_reason(void);

/* What an outcome of this status was in truth: a failure is EHD_MEMORY where memory was refused since
 * hdf5_start, and any outcome EHD_IO or EHD_DATA where it could not be looked up what there is. `path`
 * is for the message. */
ehd_status hdf5_blame(ehd_status status, const char *path, ehd_error *error);
/* Of a call that failed and is gone on from, for hdf5_blame: nothing unless memory was refused. */
void hdf5_note_failure(void);

/* Closes whatever the id stands for and keeps the last reason; accepts negative ids. */
void hdf5_release(hid_t id);

/* The status of a failed write, which is remembered: EHD_IO, or EHD_DATA where the file was resumed and the
 * system reports no error, since it is then damaged. Of a failed read: EHD_DATA or EHD_IO. Call them right after
 * the failed call. */
ehd_status hdf5_write_failed(artefact *file, const char *object, ehd_error *error);
ehd_status hdf5_read_failed(const artefact *file, const char *object, ehd_error *error);

/* Opens an existing file, with `flags` as for H5Fopen. `clear_flags` is for a file that no other process writes: it
 * clears the marks that a killed writer left in the superblock, and includes what was written behind the end of
 * file that is noted there, as h5clear does. Negative on failure. */
hid_t hdf5_open(const char *path, unsigned flags, bool clear_flags);
enum { HDF5_PAGE_BYTES = 4096 };
hid_t hdf5_create(const char *path);

/* Scalar attributes of an object, replacing an attribute of the same name. True when written. */
bool hdf5_put_attribute(hid_t object, const char *name, hid_t type, const void *value);
/* Text up to 65 kB: fixed length, UTF-8, NUL at the end. */
bool hdf5_put_string(hid_t object, const char *name, const char *text);

/* Text of any length at the root, in pieces NAME, NAME_2, NAME_3, … where it is too long for one.
 */
bool hdf5_put_text(hid_t root, const char *name, const char *text);

/* One attribute string of whatever kind, NULL when it is not there or is no text; free(). */
char *hdf5_get_string(hid_t object, const char *name);
/* The pieces that hdf5_put_text wrote, joined. */
char *hdf5_get_text(hid_t root, const char *name);
/* One number of class `wanted` (H5T_FLOAT accepts integers too). False when it is something else.
 */
bool hdf5_get_number(hid_t object, const char *name, H5T_class_t wanted, void *value);

/* Where they cannot tell, they say no, and hdf5_blame knows. */
bool hdf5_has_dataset(hid_t root, const char *name);
bool hdf5_has_attribute(hid_t object, const char *name);
/* Visits the names of all attributes of an object, in the order of their names. */
void hdf5_visit_attributes(hid_t object, void (*visit)(const char *name, void *data), void *data);

// ---- own_data.c

/* What of a dataset, which exists, is not read: a link that is not hard, data that lie in other
 * files, a filter beside gzip, shuffle and Fletcher-32. NULL: nothing. To be asked before anything
 * else of the dataset. `name` may lead through groups. */
const char *hdf5_find_foreign(hid_t root, const char *name);
/* Opens a dataset that has no such; negative, with *found, where it has, or NULL where it is
 * damaged. *chunk: the numbers of a chunk, 1 where it has none; *address: of its header. */
hid_t hdf5_open_own(const char **found, double *chunk, haddr_t *address, hid_t root,
                    const char *name);
ehd_status hdf5_refuse(const char *path, const char *name, const char *found, ehd_error *error);
/* EHD_DATA where there is such; `path` is that of the file, for the message. */
ehd_status hdf5_check_own(hid_t root, const char *path, const char *name, ehd_error *error);

// ---- values.c

const char *values_text(artefact_values values); // for the schema pages; "": any
/* Whether they are to be looked at together. */
bool values_have_order(artefact_values values);
/* EHD_DATA for what is not in the range: one number of an attribute, or `count` entries of a field
 * from `first` on. */
ehd_status check_real(const artefact *file, const char *name, artefact_values values, double found,
                      ehd_error *error);
ehd_status check_integer(const artefact *file, const char *name, artefact_values values,
                         int64_t found, ehd_error *error);
/* Whether numbers of a field are in its range. EHD_DATA. */
ehd_status check_numbers(const artefact *file, const artefact_field *field, const void *numbers,
                         size_t count, ehd_error *error);
ehd_status check_values(const artefact *file, const artefact_field *field, size_t first,
                        size_t count, const void *data, ehd_error *error);
/* Reads file->outcomes. */
ehd_status learn_outcomes(artefact *file, ehd_error *error);
/* Entries along the field's first axis in this file, and numbers of each. */
size_t num_entries(const artefact *file, const artefact_field *field);
size_t entry_size(const artefact *file, const artefact_field *field);
ehd_status check_axis_length(const artefact *file, const char *object, const char *axis,
                             size_t length, ehd_error *error);
/* EHD_DATA where all numbers that a reader may take are more than a file of this size can hold. */
ehd_status check_unpacking(const artefact *file, ehd_error *error);
/* The same of that many numbers; EHD_IO where the file does not open. */
ehd_status check_stored(const char *path, double numbers, ehd_error *error);
/* EHD_MEMORY where so many entries of a field take more than is free. */
ehd_status check_memory(const artefact *file, const artefact_field *field, size_t entries,
                        ehd_error *error);

// ---- digest.c

typedef struct content_digest content_digest;
/* SHA-256 of a dataset, from its entries in their order; NULL: no memory. Freed by digest_end. */
content_digest *digest_begin(const artefact *file, const artefact_field *field);
void digest_add(content_digest *self, size_t first, size_t count, const void *numbers);
void digest_end(content_digest *self, char text[65]);
/* EHD_DATA where the digest, or that of all numbers of a field, is not the file's. */
ehd_status check_digest(const artefact *file, const char *name, const char *digest,
                        ehd_error *error);
ehd_status check_content(const artefact *file, const artefact_field *field, const void *numbers,
                         ehd_error *error);
/* Takes the digests of a file that is read, and checks attributes and which datasets there are. */
ehd_status learn_digests(artefact *file, ehd_error *error);
/* Writes those of a file that is about to get its final name. */
ehd_status put_digests(artefact *file, ehd_error *error);
/* What of a file's digest is known where it is an input; NULL: it is no artefact. */
const char *digest_outcome(hid_t file);

// ---- provenance.c

/* "2026-01-31T12:00:00Z fullrun 0.1.0: fullrun scene.yml -o result.h5", or NULL (memory); free().
 */
char *history_line(const program *caller);

/* Copies text and replaces what is not UTF-8 by '?', because readers refuse a whole file over it.
 */
char *utf8_copy(const char *text);

/* Whether the recorded input of this name had this content or, where none has the name, any of
 * them. */
bool had_input(hid_t root, const char *path, const char identity[65]);

/* All attributes that say where the file comes from, with `complete` = 0. */
ehd_status put_provenance(artefact *file, const program *caller, const char *settings_text,
                          const char *const *inputs, ehd_error *error);
bool put_complete(hid_t root, int64_t complete);
bool put_history(hid_t root, const char *before, const char *line); // the two joined

// ---- partial.c

/* The writer's object with names, schema, and PATH.partial opened (`flags`: O_CREAT or 0) and
 * locked, but no HDF5 file yet. EHD_CANTCREATE, with O_CREAT also where PATH.partial has something
 * for --resume and caller->force is not set; EHD_NOINPUT (without O_CREAT), EHD_MEMORY. */
ehd_status writer_new(artefact **result, const char *path, const artefact_schema *schema,
                      const program *caller, int flags, ehd_error *error);
/* Whether what --resume could go on with was ever there: HDF5 says in the first bytes of a file that it
 * is streaming, or that it was closed. True also where another program wrote them. */
bool has_begun(const artefact *file);

/* What an interrupted run left is not changed in place but while it is streaming, since a kill would
 * leave neither the old nor the new. use_copy makes a copy under a name of its own, for HDF5 to
 * open, where the machine has been started since it was written, and there is one, of PATH.saved;
 * keep_copy gives it the name of the original, once it is streaming; drop_copy removes it. EHD_IO,
 * EHD_MEMORY, EHD_CANTCREATE. */
ehd_status use_copy(artefact *file, ehd_error *error);
ehd_status keep_copy(artefact *file, ehd_error *error);
void drop_copy(artefact *file);
/* The one of the two that is written. */
const char *written_name(const artefact *file);
/* On disk; EHD_IO. */
ehd_status sync_file(const artefact *file, ehd_error *error);

/* Whether a field has an entry for each of what a writer finishes one after the other. */
bool is_finished_by_entry(const artefact *file, const artefact_field *field);

/* Whether a killed writer may have torn entries of a field that it had not finished: arrays, by the axis
 * along which it finished one after the other. Numbers lie within a page. */
bool is_kept_apart(const artefact *file, const artefact_field *field);

/* Renames the closed file. The content is on disk before the name says that it is whole. */
ehd_status give_final_name(artefact *file, ehd_error *error);

// ---- artefact.c

/* Shared by reading, writing and resuming. */
artefact *artefact_new(const char *path);
void artefact_delete(artefact *file); // closes the HDF5 file without a word; accepts NULL
const artefact_field *find_field(const artefact *file, const char *name);
const artefact_attribute *find_attribute(const artefact *file, const char *name);
size_t *find_length(const artefact *file, const char *axis); // NULL: no such axis in the schema
const char *shown_name(const artefact *file);                // of the file on disk, for messages
bool axis_is_optional(const artefact_schema *schema, const char *name);
bool field_grows(const artefact *file, const artefact_field *field);

/* Whether a field is in the file. */
bool field_exists(const artefact *file, const artefact_field *field);

/* Opens a dataset, to be released. What is on the growing axis is kept open behind that while
 * streaming, because every entry goes into all of it. Negative on failure. */
hid_t open_dataset(artefact *file, const char *name);

/* Length of a dataset along its first axis. */
size_t dataset_length(hid_t dataset);
/* Whether a dataset can grow along its first axis. */
bool is_extendible(hid_t dataset);
/* Makes a dataset on the growing axis longer or shorter. */
bool set_dataset_length(hid_t dataset, size_t length);
/* Makes it longer where it is too short. */
bool extend_dataset(hid_t dataset, size_t length);

/* Reads `count` entries along the first axis, WHOLE_FIELD: all of them, into `data`, which has room
 * for `room` numbers. EHD_DATA: they are more numbers, or fewer. */
#define WHOLE_FIELD ((size_t)-1)
ehd_status read_entries(artefact *file, const char *name, artefact_type type, size_t first,
                        size_t count, void *data, size_t room, ehd_error *error);
/* Writes them; what is on the growing axis grows to take them. */
ehd_status write_entries(artefact *file, const char *name, artefact_type type, size_t first,
                         size_t count, const void *data, ehd_error *error);

// ---- read.c

/* EHD_NOINPUT where there is no regular file that can be read, EHD_DATA where it is empty. */
ehd_status check_readable(const char *path, ehd_error *error);

/* Recognises the schema and version of an open HDF5 file, checks attributes and fields, and learns
 * the axis lengths. */
ehd_status examine(artefact *file, const artefact_schema *const *schemas, ehd_error *error);
/* The name in the schema of the axis whose scale has no bound; NULL: none. */
const char *find_growing(const artefact *file);
/* An axis as a field along itself. */
artefact_field field_of_axis(const artefact_axis *axis);
/* Reads all of a field in slices, and checks its numbers. */
ehd_status read_field(artefact *file, const artefact_field *field,
                      char digest[65], // NULL: not wanted
                      ehd_error *error);
/* Reads every dataset that the schema knows, so that every checksum is verified. Of a file being
 * written (`partial`) not what may be torn, and with a growing axis only the axes and what is on that
 * one, because the rest is overwritten in place. */
ehd_status read_everything(artefact *file, bool partial, ehd_error *error);
/* -1 where the attribute is not there. */
int64_t completeness(const artefact *file);

#endif
