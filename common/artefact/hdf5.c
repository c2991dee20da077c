/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/artefact/internal.h"

#include <errno.h>
#include <fcntl.h>
#include <fenv.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* An attribute and its name must fit into one message of an object header, which holds at most 64
 * kB. */
enum { PIECE_BYTES = 60000 };

static _Thread_local bool started = false;
static bool not_begun; // HDF5 had no memory to initialise itself, so all of its functions fail

static void be_quiet(void) {
    // a thread-safe build of HDF5 has an error stack in each thread, which prints by default
    if (H5Eset_auto2(H5E_DEFAULT, NULL, NULL) < 0) not_begun = true;
    H5PLset_loading_state(0); // no plugin is loaded on behalf of a file
}

/* Initialises HDF5 while numbers are rounded to nearest, then restores the host's rounding. HDF5 of
 * Debian 13 crashes during initialisation under any other rounding. */
static herr_t open_hdf5(void) {
    fenv_t host;

    feholdexcept(&host);
    fesetround(FE_TONEAREST);
    const herr_t outcome = H5open();
    fesetenv(&host);
    return outcome;
}

void hdf5_start(void) {
    errno = 0;
    if (started) return;
    started = true;
    H5dont_atexit();                                          // must be the first call
    if (open_hdf5() < 0 || errno == ENOMEM) not_begun = true; // H5open may hide a lack of memory
    be_quiet();
}

artefact_guest artefact_visit(void) {
    artefact_guest host = {0};
    H5E_auto2_t print = NULL;

    open_hdf5();
    H5Eget_auto2(H5E_DEFAULT, &print, &host.data);
    H5PLget_loading_state(&host.plugins);
    host.print = (void (*)(void))print;
    started = true; // hdf5_start has nothing left to do in this thread
    be_quiet();
    return host;
}

void artefact_leave(const artefact_guest *host) {
    H5Eset_auto2(H5E_DEFAULT, (H5E_auto2_t)host->print, host->data);
    H5PLset_loading_state(host->plugins);
}

// ---- errors

// the file driver reports "…, errno = 28, error message = 'No space left on device', buf = …"
static const char system_key[] = "error message = '";

/* Keeps the message of the first frame of the error stack, where the error was found. If a later
 * frame has a message of the operating system, keeps the later message. */
static herr_t take_first(unsigned depth, const H5E_error2_t *frame, void *data) {
    hdf5_reason *reason = data;
    if (frame->desc && (depth == 0 || strstr(frame->desc, system_key)))
        snprintf(reason->text, sizeof reason->text, "%s", frame->desc);
    return 0;
}

hdf5_reason hdf5_last_reason(void) {
    // some HDF5 functions drop the errors of functions that they call, but errno stays
    hdf5_reason reason = {.text = "", .system = errno == EIO, .memory = errno == ENOMEM};
    H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, take_first, &reason);

    char *start = strstr(reason.text, system_key);
    if (start) {
        reason.system = true;
        start += sizeof system_key - 1;
        size_t length = strcspn(start, "'");
        memmove(reason.text, start, length);
        reason.text[length] = '\0';
    }
    return reason;
}

void hdf5_release(hid_t id) {
    if (id < 0) return;
    // usually there is no error to keep, and copying the error stack would take as long as closing
    // a dataspace
    if (H5Eget_num(H5E_DEFAULT) == 0) {
        H5Idec_ref(id);
        return;
    }
    hid_t stack = H5Eget_current_stack();
    H5Idec_ref(id);
    H5Eset_current_stack(stack);
}

/* Reason of the first look-up that failed. One variable is enough for all files, because only one
 * thread at a time runs these functions. */
static hdf5_reason unknown;
static bool has_unknown;

static void note_unknown(void) {
    if (has_unknown) return;
    unknown = hdf5_last_reason();
    has_unknown = true;
}

static bool exists(htri_t found) {
    if (found < 0) note_unknown();
    return found > 0;
}

/* Is called, for example, for an attribute that exists but could not be read. After a lack of
 * memory such an attribute must not be reported as an attribute of the wrong type. */
void hdf5_note_failure(void) {
    if (errno == ENOMEM) note_unknown();
}

ehd_status hdf5_blame(ehd_status status, const char *path, ehd_error *error) {
    const bool unread = has_unknown;
    has_unknown = false;
    if (status == EHD_MEMORY || status == EHD_INTERRUPTED) return status;
    if (((errno == ENOMEM || not_begun) && status != EHD_OK) || (unread && unknown.memory))
        return ehd_no_memory(error, path);
    if (unread && status != EHD_IO)
        return ehd_fail(error, unknown.system ? EHD_IO : EHD_DATA,
                        "%s: found a read failure (%s), expected to look up what is there", path,
                        unknown.text);
    return status;
}

ehd_status hdf5_write_failed(artefact *file, const char *object, ehd_error *error) {
    hdf5_reason reason = hdf5_last_reason();
    file->failed = true;
    // HDF5 reads a chunk before it writes a part of the chunk; in a damaged resumed file this
    // reading may fail
    if (file->history_line && !reason.system) return hdf5_read_failed(file, object, error);
    ehd_fail(error, EHD_IO, "%s: %s: found a write failure (%s), expected it to be written",
             file->partial, object, reason.text);
    return hdf5_blame(EHD_IO, file->partial, error);
}

ehd_status hdf5_read_failed(const artefact *file, const char *object, ehd_error *error) {
    hdf5_reason reason = hdf5_last_reason();
    const ehd_status status =
        reason.system
            ? ehd_fail(error, EHD_IO, "%s: %s: found a read failure (%s), expected it to be read",
                       shown_name(file), object, reason.text)
            : ehd_fail(error, EHD_DATA, "%s: %s: found damaged data (%s), expected it to be whole",
                       shown_name(file), object, reason.text);
    return hdf5_blame(status, shown_name(file), error);
}

// ---- files

/* Sets how a file is opened. HDF5's locks are off because they fail on some network file systems;
 * our own lock excludes a second writer. Returns false if a property cannot be set for lack of
 * memory, because the file would then be written differently. The other functions that set
 * properties do the same. */
static bool set_access(hid_t access) {
    return H5Pset_libver_bounds(access, H5F_LIBVER_V110, H5F_LIBVER_V110) >= 0 &&
           H5Pset_file_locking(access, false, true) >= 0 &&
           H5Pset_fclose_degree(access, H5F_CLOSE_STRONG) >= 0;
}

/* Switches off the chunk cache of a writer. A failed write then fails in its own call, and writes
 * reach the file in the order of the calls. */
static bool write_through(hid_t access) {
    return H5Pset_cache(access, 0, 0, 0, 0.75) >= 0;
}

/* Switches on a property for which HDF5 has no function, if this version of HDF5 has the
 * property. */
static bool switch_on(hid_t access, const char *name) {
    const hbool_t yes = true;
    const htri_t there = H5Pexist(access, name);
    return there == 0 || (there > 0 && H5Pset(access, name, &yes) >= 0);
}

/* Number of attempts to read metadata whose checksum fails because a writer changes them. HDF5
 * doubles the wait each time, from 1 ns on: 33 ms in all. With its default of 100 attempts, the
 * waits would never end on a damaged file. If no other process writes the file, one attempt is
 * enough, because a failed checksum then means damage. */
enum { READ_ATTEMPTS = 25 };

static bool set_opening(hid_t access, unsigned flags, bool clear_flags) {
    const bool beside_writer = flags & H5F_ACC_SWMR_READ && !clear_flags;
    return set_access(access) && (!(flags & H5F_ACC_RDWR) || write_through(access)) &&
           H5Pset_metadata_read_attempts(access, beside_writer ? READ_ATTEMPTS : 1) >= 0 &&
           // the properties that h5clear uses
           (!clear_flags ||
            (switch_on(access, "clear_status_flags") && switch_on(access, "skip_eof_check")));
}

/* Checks whether a file is not HDF5, because it has no HDF5 signature at byte 0, 512, 1024, 2048, …
 * HDF5 1.14 passes such a file to all plugins and so runs their code, whatever was set with
 * H5PLset_loading_state. */
static bool is_foreign(const char *path, off_t size) {
    static const unsigned char signature[8] = "\211HDF\r\n\032\n";
    unsigned char found[sizeof signature];
    const int descriptor = open(path, O_RDONLY | O_CLOEXEC);
    bool foreign = descriptor >= 0;

    for (off_t at = 0; foreign && at < size; at = at == 0 ? 512 : 2 * at) {
        const ssize_t got = pread(descriptor, found, sizeof found, at);
        if (got < 0 || (got == sizeof found && memcmp(found, signature, sizeof found) == 0))
            foreign = false;
    }
    if (descriptor >= 0) close(descriptor);
    return foreign;
}

hid_t hdf5_open(const char *path, unsigned flags, bool clear_flags) {
    has_unknown = false; // may be left over from a look-up in another file
    errno = 0;
    struct stat about;
    const bool is_there = stat(path, &about) == 0;
    if (is_there && !S_ISREG(about.st_mode)) return -1; // opening a pipe would wait
    errno = 0;
    if (is_there && is_foreign(path, about.st_size)) {
        H5Eclear2(H5E_DEFAULT);
        H5Epush2(H5E_DEFAULT, __FILE__, __func__, __LINE__, H5E_ERR_CLS, H5E_FILE, H5E_NOTHDF5,
                 "found no file signature");
        return -1;
    }
    errno = 0;
    hid_t access = H5Pcreate(H5P_FILE_ACCESS), file = -1;
    if (set_opening(access, flags, clear_flags)) file = H5Fopen(path, flags, access);
    hdf5_release(access);
    // a killed writer may have written behind the end of file that the superblock states; that
    // space must not be reused
    if (file >= 0 && clear_flags && flags & H5F_ACC_RDWR && H5Fincrement_filesize(file, 0) < 0) {
        hdf5_release(file);
        return -1;
    }
    return file;
}

/* Keeps all attributes and links in the object header, one checksummed block that is read at once.
 * HDF5 would otherwise move many attributes and links to a heap and an index. */
static bool keep_in_header(hid_t properties) {
    return H5Pset_attr_phase_change(properties, 65535, 0) >= 0 &&
           H5Pset_link_phase_change(properties, 65535, 0) >= 0;
}

/* Keeps objects that are smaller than a page of the system within one page. A kill can interrupt a
 * write only between two pages, so no metadata and no small chunk is half written. */
static bool keep_in_pages(hid_t creation) {
    return H5Pset_file_space_strategy(creation, H5F_FSPACE_STRATEGY_PAGE, false, 1) >= 0 &&
           H5Pset_file_space_page_size(creation, HDF5_PAGE_BYTES) >= 0;
}

hid_t hdf5_create(const char *path) {
    hid_t access = H5Pcreate(H5P_FILE_ACCESS), creation = H5Pcreate(H5P_FILE_CREATE), file = -1;
    if (set_access(access) && write_through(access) && keep_in_header(creation) &&
        keep_in_pages(creation))
        file = H5Fcreate(path, H5F_ACC_TRUNC, creation, access);
    hdf5_release(creation);
    hdf5_release(access);
    return file;
}

/* Checks whether a failed look-up must be repeated. After a lack of memory the look-up must be
 * repeated, because HDF5 has freed memory since then. Without the repetition, a reader would go on
 * as if the file lacked the item. After a read failure the look-up must not be repeated, because
 * the second look-up would wrongly return "no". */
static bool is_to_be_repeated(htri_t found) {
    return found < 0 && errno == ENOMEM;
}

bool hdf5_has_dataset(hid_t root, const char *name) {
    const htri_t found = H5Lexists(root, name, H5P_DEFAULT);
    return exists(is_to_be_repeated(found) ? H5Lexists(root, name, H5P_DEFAULT) : found);
}

bool hdf5_has_attribute(hid_t object, const char *name) {
    const htri_t found = H5Aexists(object, name);
    return exists(is_to_be_repeated(found) ? H5Aexists(object, name) : found);
}

typedef struct attribute_visitor {
    void (*visit)(const char *name, void *data);
    void *data;
} attribute_visitor;

static herr_t visit_one(hid_t object, const char *name, const H5A_info_t *info, void *data) {
    const attribute_visitor *visitor = data;
    (void)object;
    (void)info;
    visitor->visit(name, visitor->data);
    return 0;
}

void artefact_visit_attributes(const artefact *file, void (*visit)(const char *name, void *data),
                               void *data) {
    attribute_visitor visitor = {visit, data};
    H5Aiterate2(file->id, H5_INDEX_NAME, H5_ITER_INC, NULL, visit_one, &visitor);
}

// ---- attributes

bool hdf5_put_attribute(hid_t object, const char *name, hid_t type, const void *value) {
    if (hdf5_has_attribute(object, name) && H5Adelete(object, name) < 0) return false;
    hid_t space = H5Screate(H5S_SCALAR);
    hid_t attribute = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    bool written = attribute >= 0 && H5Awrite(attribute, type, value) >= 0;
    hdf5_release(attribute);
    hdf5_release(space);
    return written;
}

bool hdf5_put_string(hid_t object, const char *name, const char *text) {
    hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, strlen(text) + 1);
    H5Tset_cset(type, H5T_CSET_UTF8);
    bool written = hdf5_put_attribute(object, name, type, text);
    hdf5_release(type);
    return written;
}

static void piece_name(char buffer[128], const char *name, int number) {
    snprintf(buffer, 128, number == 1 ? "%s" : "%s_%d", name, number);
}

/* Returns the length of the next piece. A piece ends between two characters, never inside one. */
static size_t piece_length(const char *text) {
    size_t length = strnlen(text, PIECE_BYTES + 1);
    if (length <= PIECE_BYTES) return length;
    length = PIECE_BYTES;
    while (((unsigned char)text[length] & 0xC0) == 0x80)
        length--;
    return length;
}

bool hdf5_put_text(hid_t root, const char *name, const char *text) {
    char *copy = utf8_copy(text);
    char *piece = malloc(PIECE_BYTES + 1);
    bool written = copy && piece;
    char label[128];
    int number = 1;
    for (const char *rest = copy; written && (number == 1 || *rest);) {
        const size_t length = piece_length(rest);
        memcpy(piece, rest, length);
        piece[length] = '\0';
        piece_name(label, name, number++);
        written = hdf5_put_string(root, label, piece);
        rest += length;
    }
    // removes pieces of a longer text that was stored before
    piece_name(label, name, number);
    while (written && hdf5_has_attribute(root, label)) {
        written = H5Adelete(root, label) >= 0;
        piece_name(label, name, ++number);
    }
    free(piece);
    free(copy);
    return written;
}

/* Reads a fixed-length string. The string may fill its space to the last byte, without a closing
 * zero. Fortran programs fill the rest of the space with blanks. */
static char *fixed_string(hid_t attribute, hid_t type) {
    size_t size = H5Tget_size(type);
    char *text = calloc(size + 1, 1);
    if (!text || H5Aread(attribute, type, text) < 0) {
        hdf5_note_failure();
        free(text);
        return NULL;
    }
    if (H5Tget_strpad(type) == H5T_STR_SPACEPAD) {
        for (size_t end = strlen(text); end > 0 && text[end - 1] == ' '; end--)
            text[end - 1] = '\0';
    }
    return text;
}

static char *variable_string(hid_t attribute, hid_t type) {
    char *stored = NULL;
    char *text = NULL;
    if (H5Aread(attribute, type, &stored) >= 0) text = strdup(stored ? stored : "");
    H5free_memory(stored);
    if (!text) hdf5_note_failure();
    return text;
}

/* Opens an attribute with a single value. Some libraries write such a value as an array of length
 * 1. */
static hid_t open_single(hid_t object, const char *name) {
    if (!hdf5_has_attribute(object, name)) return -1;
    hid_t attribute = H5Aopen(object, name, H5P_DEFAULT);
    hid_t space = H5Aget_space(attribute);
    if (attribute < 0 || space < 0) hdf5_note_failure();
    bool single = H5Sget_simple_extent_npoints(space) == 1;
    hdf5_release(space);
    if (single) return attribute;
    hdf5_release(attribute);
    return -1;
}

char *hdf5_get_string(hid_t object, const char *name) {
    hid_t attribute = open_single(object, name);
    if (attribute < 0) return NULL;
    char *text = NULL;
    hid_t type = H5Aget_type(attribute);
    if (type < 0) hdf5_note_failure();
    if (H5Tget_class(type) == H5T_STRING) {
        bool variable = H5Tis_variable_str(type) > 0;
        text = variable ? variable_string(attribute, type) : fixed_string(attribute, type);
    }
    hdf5_release(type);
    hdf5_release(attribute);
    return text;
}

char *hdf5_get_text(hid_t root, const char *name) {
    char *piece = hdf5_get_string(root, name), *text = NULL;
    char label[128];
    size_t size = 0;
    if (!piece) return NULL;

    FILE *all = open_memstream(&text, &size);
    for (int number = 2; all && piece; number++) {
        fputs(piece, all);
        free(piece);
        piece_name(label, name, number);
        piece = hdf5_get_string(root, label); // hdf5_blame reports a piece that was not read
    }
    if (all && fclose(all) == 0) return text;
    free(all ? text : piece);
    errno = ENOMEM; // nothing else can fail
    hdf5_note_failure();
    return NULL;
}

hid_t hdf5_memory_type(artefact_type type) {
    return type == ARTEFACT_REAL ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT64;
}

bool hdf5_get_number(hid_t object, const char *name, artefact_type type, void *value) {
    hid_t attribute = open_single(object, name);
    if (attribute < 0) return false;
    hid_t stored = H5Aget_type(attribute);
    H5T_class_t found = H5Tget_class(stored);
    bool fits = found == H5T_INTEGER || (found == H5T_FLOAT && type == ARTEFACT_REAL);
    bool read = fits && H5Aread(attribute, hdf5_memory_type(type), value) >= 0;
    if (stored < 0 || (fits && !read)) hdf5_note_failure();
    hdf5_release(stored);
    hdf5_release(attribute);
    return read;
}
