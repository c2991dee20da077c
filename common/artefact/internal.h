/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Declares what the source files of this folder share. Other folders do not include this header. */
#ifndef EHD_ARTEFACT_INTERNAL_H
#define EHD_ARTEFACT_INTERNAL_H

#include "common/artefact/artefact.h"
#include "common/artefact/sha256.h"
#include "common/program/arena.h"

#include <hdf5.h>

/* Properties of a dataset that hdf5_open_own finds. */
typedef struct own_dataset {
    const char *foreign; // why the dataset must not be read; NULL: it may be read
    double chunk;        // number of values in a chunk; 1: no chunks
    haddr_t address;     // address of the object header; HDF5 references contain this address
} own_dataset;

/* A number of either type, as an attribute or dataset has it. */
typedef union any_number {
    double real;
    int64_t integer;
} any_number;

/* A dataset of the schema: an axis or a field. If the dataset is an axis, `field` describes it as a
 * field of real numbers along this axis. */
typedef struct file_dataset {
    artefact_field field;
    const artefact_axis *axis; // NULL: the dataset is a field
    size_t length;             // length of an axis; 0: the length is not known yet
    // state when the file was opened:
    bool there; // the file has the dataset
    own_dataset own;
    int rank;
    hsize_t dims[ARTEFACT_MAX_RANK]; // the first ARTEFACT_MAX_RANK lengths
    bool checked;                    // the digest has been checked; this happens once, before the
                                     // first read
    hid_t held; // id of a dataset on the growing axis that stays open while streaming; 0: not open
} file_dataset;

struct artefact {
    hid_t id; // id of the HDF5 file; negative when it is not open
    const artefact_schema *schema;
    char *path;                    // the final name
    char *partial;                 // name of the file while it is written; NULL when reading
    char *copy;                    // name of the copy that the writer changes while not streaming
    bool on_copy;                  // whether the copy is open in place of `partial`
    char *saved;                   // name of the copy that artefact_save makes
    double saved_at, save_seconds; // end of the last artefact_save and its duration, s
    char *history_line;            // line that a run with --resume adds to the history of the file;
                                   // NULL: the file is not resumed
    char *digests;     // content_sha256 of a file being read; NULL: the content is not checked
    int64_t *outcomes; // [length of outcome_axis] field `status`; NULL: the file has no such field
    const char *outcome_axis;
    file_dataset *datasets; // axes of the schema, then its fields; ends with {0}
    file_dataset *fields;   // first field in `datasets`
    const char *growing;    // name of the axis that grows while writing; NULL: no axis grows
    int lock;               // descriptor that holds the writer's lock; -1: the file is being read
    int copy_lock;          // descriptor that holds the lock of the copy; -1: no copy
    bool force;             // an existing final file may be replaced
    bool streaming;
    bool keep;   // --resume can use the partial file
    bool copied; // the file was filled by artefact_copy; NEED_OWN items may be missing
    bool failed; // a write failed, so the file must not get its final name
};

// ---- hdf5.c: settings, errors, files and attributes of HDF5

/* Initialises HDF5. Call it in each thread before any other HDF5 function. Afterwards HDF5 prints
 * nothing, loads no plugins, and does nothing at exit, where it would otherwise repeat failed
 * writes. Also clears errno, so that an earlier lack of memory is forgotten. */
void hdf5_start(void);

/* Innermost message of the last failed HDF5 call. Call hdf5_last_reason right after the failed
 * call, before any other HDF5 function. */
typedef struct hdf5_reason {
    char text[256];
    bool system; // the operating system refused; the content is not at fault
    bool memory; // memory was refused
} hdf5_reason;
hdf5_reason hdf5_last_reason(void);

/* Corrects a status whose cause HDF5 hides. Returns EHD_MEMORY for a failure if memory was refused
 * since hdf5_start. Returns EHD_MEMORY, EHD_IO or EHD_DATA, even for EHD_OK, if a look-up
 * (hdf5_has_dataset, hdf5_has_attribute) has failed. `path` is for the message. */
ehd_status hdf5_blame(ehd_status status, const char *path, ehd_error *error);
/* Records for hdf5_blame that a call failed for lack of memory. Call it if the caller continues
 * after a failed call. Does nothing after failures of another kind. */
void hdf5_note_failure(void);

/* Closes an HDF5 object and keeps the last error message. Accepts negative ids. */
void hdf5_release(hid_t id);

/* Report a failed write or read. Call these functions right after the failed call.
 * hdf5_write_failed marks the file as failed. It returns EHD_DATA if the file is resumed and there
 * is no system error, because the file is then damaged. Otherwise it returns EHD_IO.
 * hdf5_read_failed returns EHD_IO for a system error, and EHD_DATA otherwise. */
ehd_status hdf5_write_failed(artefact *file, const char *object, ehd_error *error);
ehd_status hdf5_read_failed(const artefact *file, const char *object, ehd_error *error);

/* Opens an existing file, with `flags` as for H5Fopen. `clear_flags` is for a file that no other
 * process writes. As h5clear does, the function then clears the marks of a killed writer in the
 * superblock. It also accepts data behind the end of file that the superblock states. Returns a
 * negative number on failure. */
hid_t hdf5_open(const char *path, unsigned flags, bool clear_flags);
enum { HDF5_PAGE_BYTES = 4096 };
hid_t hdf5_create(const char *path);

/* Writes or replaces a scalar attribute of an object. Returns true when written. */
bool hdf5_put_attribute(hid_t object, const char *name, hid_t type, const void *value);
/* Writes a text of up to 65 kB: fixed length, UTF-8, NUL at the end. */
bool hdf5_put_string(hid_t object, const char *name, const char *text);

/* Writes a text as attribute NAME of the root. A long text is split into NAME, NAME_2, NAME_3, … */
bool hdf5_put_text(hid_t root, const char *name, const char *text);

/* Returns a string attribute of fixed or variable length; free it with free(). NULL: the attribute
 * is missing or is not a text. */
char *hdf5_get_string(hid_t object, const char *name);
/* Returns the joined pieces that hdf5_put_text wrote; free the text with free(). */
char *hdf5_get_text(hid_t root, const char *name);
hid_t hdf5_memory_type(artefact_type type); // of numbers in memory
/* Reads one number of a type (ARTEFACT_REAL also accepts integers). Returns false if the attribute
 * is missing or is not such a number. */
bool hdf5_get_number(hid_t object, const char *name, artefact_type type, void *value);

/* Check whether the object exists. After a failed look-up the functions return false, and
 * hdf5_blame reports the failure. */
bool hdf5_has_dataset(hid_t root, const char *name);
bool hdf5_has_attribute(hid_t object, const char *name);

// ---- own_data.c

/* Opens an existing dataset and returns its id. Returns a negative number, with the reason in
 * `foreign`, if a link is not hard, if the data are in other files, or if a filter is not gzip,
 * shuffle or Fletcher-32. Returns a negative number without a reason if the dataset is damaged.
 * Call it before any other access to the dataset. `name` may lead through groups. */
hid_t hdf5_open_own(own_dataset *about, hid_t root, const char *name);
ehd_status hdf5_refuse(const char *path, const char *name, const char *found, ehd_error *error);

// ---- values.c

const char *values_text(artefact_values values); // for the schema pages; "": all values are allowed
/* Checks whether a range also restricts the order of the numbers, so that all numbers must be
 * checked together. */
bool values_have_order(artefact_values values);
/* Checks `count` numbers of a field or attribute. EHD_DATA: a number is outside the range. */
ehd_status check_numbers(const artefact *file, const artefact_field *field, const void *numbers,
                         size_t count, ehd_error *error);
/* Checks the ranges and the order of `count` entries of a field from `first` on. If entries have
 * a status, the range applies only to entries with status 0. Does nothing for a file being
 * written. */
ehd_status check_values(const artefact *file, const artefact_field *field, size_t first,
                        size_t count, const void *data, ehd_error *error);
/* Reads the field `status` of the file, if it has one, into file->outcomes. */
ehd_status learn_outcomes(artefact *file, ehd_error *error);
/* Return the number of entries along the field's first axis, and the number of values in one
 * entry. */
size_t num_entries(const artefact *file, const artefact_field *field);
size_t entry_size(const artefact *file, const artefact_field *field);
/* Checks that the file is large enough to hold all numbers that a reader may read at once, even if
 * they are compressed as far as gzip can; else EHD_DATA. */
ehd_status check_unpacking(const artefact *file, ehd_error *error);
/* Checks that the file is large enough to hold `numbers` compressed numbers, else EHD_DATA. EHD_IO:
 * the file does not open. */
ehd_status check_stored(const char *path, double numbers, ehd_error *error);
/* Returns EHD_MEMORY if `entries` entries of a field take more memory than is free. */
ehd_status check_memory(const artefact *file, const artefact_field *field, size_t entries,
                        ehd_error *error);

// ---- digest.c

typedef struct content_digest {
    struct sha256_ctx context;
    size_t entry; // number of values in an entry
    bool by_entry;
} content_digest;
/* Begin the SHA-256 of a dataset and add entries, in their order. sha256_end ends it. */
void digest_begin(content_digest *self, const artefact *file, const artefact_field *field);
void digest_add(content_digest *self, size_t first, size_t count, const void *numbers);
/* Compare a digest, or the digest of all numbers of a field, with the stored digest. EHD_DATA: they
 * differ. */
ehd_status check_digest(const artefact *file, const char *name, const char *digest,
                        ehd_error *error);
ehd_status check_content(const artefact *file, const artefact_field *field, const void *numbers,
                         ehd_error *error);
/* Reads a file's digests and compares its attributes and list of datasets with these digests. */
ehd_status learn_digests(artefact *file, ehd_error *error);
/* Writes the digests of a file that is about to get its final name. */
ehd_status put_digests(artefact *file, ehd_error *error);
/* Returns for an open HDF5 file what artefact_content returns for a path. */
const char *digest_outcome(hid_t file);

// ---- provenance.c

/* Returns "2026-01-31T12:00:00Z fullrun 0.1.0: fullrun scene.yml -o result.h5"; free it with
 * free(). NULL: there is no memory. */
char *history_line(const program *caller);

/* Copies text and replaces bytes that are not UTF-8 by '?', because readers refuse a file with
 * invalid UTF-8. */
char *utf8_copy(const char *text);

/* Checks whether the recorded input of this path had this content. If no recorded input has this
 * path, checks whether any recorded input had this content. */
bool had_input(hid_t root, const char *path, const char identity[65]);

/* Writes all attributes that describe the origin of the file, and `complete` = 0. */
ehd_status put_provenance(artefact *file, const program *caller, const char *settings_text,
                          const char *const *inputs, ehd_error *error);
bool put_complete(hid_t root, int64_t complete);
bool put_history(hid_t root, const char *before, const char *line); // writes both texts, joined

// ---- partial.c

/* Creates the writer's object: sets names and schema, opens PATH.partial (`flags`: O_CREAT or 0)
 * and locks it. The HDF5 file is not open yet. EHD_CANTCREATE: PATH.partial cannot be written, or
 * another process writes it; with O_CREAT and without caller->force, also if PATH.partial holds
 * work for --resume. EHD_NOINPUT: there is no PATH.partial, and `flags` is 0. EHD_MEMORY. */
ehd_status writer_new(artefact **result, const char *path, const artefact_schema *schema,
                      const program *caller, int flags, ehd_error *error);
/* Checks whether PATH.partial ever held something for --resume. The first bytes of an HDF5 file
 * show whether the file is streaming or was closed. Returns true also for a file of another
 * program. */
bool has_begun(const artefact *file);

/* If a process is killed while HDF5 changes a file that is not open for streaming, the file may be
 * destroyed. Before such a change the writer therefore makes a copy of PATH.partial and changes
 * only the copy.
 * - use_copy makes the copy under a name of its own. The caller then opens the copy with HDF5. If
 *   the machine was rebooted after PATH.partial was written, the data of PATH.partial may be
 *   incomplete. In this case use_copy copies PATH.saved, if this file exists.
 * - keep_copy gives the copy the name PATH.partial. Call it when the copy is open for streaming.
 * - drop_copy removes the copy.
 * Errors: EHD_IO, EHD_MEMORY, EHD_CANTCREATE. */
ehd_status use_copy(artefact *file, ehd_error *error);
ehd_status keep_copy(artefact *file, ehd_error *error);
void drop_copy(artefact *file);
/* Returns the name of the file that is being written: the copy, or PATH.partial. */
const char *written_name(const artefact *file);
/* Waits until the written file is on disk. Error: EHD_IO. */
ehd_status sync_file(const artefact *file, ehd_error *error);

/* Checks whether the first axis of a field counts items that a writer finishes one by one, such as
 * training states. */
bool is_finished_by_entry(const artefact *file, const artefact_field *field);

/* Checks whether a killed writer may have damaged unfinished entries of a field. This is possible
 * if is_finished_by_entry holds and each entry is an array. Entries of one number lie within a page
 * and stay intact. */
bool is_kept_apart(const artefact *file, const artefact_field *field);

/* Renames the closed file to its final name, after its content is on disk. */
ehd_status give_final_name(artefact *file, ehd_error *error);

// ---- write.c

/* Writes an attribute of the schema; `value` is a number of the type, or the text. */
ehd_status put_attribute(artefact *file, const char *name, artefact_type type, const void *value,
                         ehd_error *error);
/* Writes `count` entries of a field, as artefact_put_part does for real numbers. */
ehd_status put_entries(artefact *file, const char *name, artefact_type type, size_t first,
                       size_t count, const void *data, ehd_error *error);

// ---- artefact.c

artefact *artefact_new(const char *path);
void artefact_delete(artefact *file); // closes the HDF5 file without error checks; accepts NULL
/* Sets the schema of a file. Returns false if there is no memory. */
bool set_schema(artefact *file, const artefact_schema *schema);
file_dataset *find_dataset(const artefact *file, const char *name); // NULL: not in the schema
const artefact_field *find_field(const artefact *file, const char *name);
const artefact_field *find_attribute(const artefact *file, const char *name);
const char *shown_name(const artefact *file); // name on disk, for messages
bool field_grows(const artefact *file, const artefact_field *field);

bool field_exists(const artefact *file, const artefact_field *field); // also of an attribute

/* A file is opened beside its writer, and data are read beside it, in at most WRITER_ATTEMPTS
 * attempts. wait_for_writer waits 10 ms before the next attempt. */
enum { WRITER_ATTEMPTS = 50 };
void wait_for_writer(void);

/* Opens a dataset; close it with hdf5_release. While streaming, datasets on the growing axis stay
 * open internally, because every entry is written to all these datasets. Negative on failure. */
hid_t open_dataset(artefact *file, const char *name);

/* Functions for the length of a dataset along its first axis. is_extendible checks whether the
 * dataset can grow. set_dataset_length makes a dataset on the growing axis longer or shorter.
 * extend_dataset makes it longer, if necessary, so that it has at least `length` entries. */
size_t dataset_length(hid_t dataset);
bool is_extendible(hid_t dataset);
bool set_dataset_length(hid_t dataset, size_t length);
bool extend_dataset(hid_t dataset, size_t length);

/* A number of entries that stands for all entries of a dataset. */
#define WHOLE_FIELD ((size_t)-1)
/* Reads `count` entries of a dataset along its first axis, from entry `first` on, into `data`,
 * which has room for `room` numbers. EHD_DATA: the entries together do not have exactly `room`
 * numbers. */
ehd_status read_entries(artefact *file, const char *name, artefact_type type, size_t first,
                        size_t count, void *data, size_t room, ehd_error *error);
/* Writes `count` entries of a dataset along its first axis, from entry `first` on. A dataset on the
 * growing axis becomes longer if needed. */
ehd_status write_entries(artefact *file, const char *name, artefact_type type, size_t first,
                         size_t count, const void *data, ehd_error *error);

// ---- read.c

/* Checks that a path is a regular file that can be read (else EHD_NOINPUT) and is not empty (else
 * EHD_DATA). */
ehd_status check_readable(const char *path, ehd_error *error);

/* Recognises the schema and version of an open HDF5 file, checks attributes and fields, and learns
 * the axis lengths. */
ehd_status examine(artefact *file, const artefact_schema *const *schemas, ehd_error *error);
/* Returns the name of the axis that can grow, or NULL. The HDF5 dimension scale of this axis, a
 * dataset with the values of the axis, was created with unlimited length. */
const char *find_growing(const artefact *file);
/* Reads all of a field in slices, and checks its numbers. */
ehd_status read_field(artefact *file, const artefact_field *field,
                      char digest[65], // NULL: the caller does not need the digest
                      ehd_error *error);
/* Reads every dataset of the schema, so that every checksum is verified. In a file being written
 * (`partial`) it skips fields that may be damaged (is_kept_apart). With a growing axis it reads
 * only the axes and the fields on that axis, because other fields are overwritten in place. */
ehd_status read_everything(artefact *file, bool partial, ehd_error *error);
/* Read and check a number or entries of a field, like artefact_get_real and artefact_get_part. */
ehd_status get_number(artefact *file, const char *attribute, artefact_type type, void *value,
                      ehd_error *error);
ehd_status get_entries(artefact *file, const char *name, artefact_type type, size_t first,
                       size_t count, void *data, size_t room, ehd_error *error);
/* Returns the attribute `complete`, or -1 if it is missing. */
int64_t completeness(const artefact *file);

#endif
