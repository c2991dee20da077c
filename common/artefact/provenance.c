/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Records the origin of a file: history lines and the identity of inputs. */
#include "common/artefact/internal.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

void sha256_end(struct sha256_ctx *context, char text[SHA256_TEXT]) {
    uint8_t digest[SHA256_DIGEST_SIZE];

    sha256_digest(context, sizeof digest, digest);
    for (size_t i = 0; i < sizeof digest; i++)
        snprintf(text + 2 * i, 3, "%02x", digest[i]);
}

ehd_status artefact_file_identity(char identity[65], const char *path, ehd_error *error) {
    identity[0] = '\0';
    FILE *stream = program_open(path);
    if (!stream && errno == ENOMEM) return ehd_no_memory(error, path);
    if (!stream)
        return ehd_fail(error, EHD_NOINPUT, "%s: found %s, expected a readable file", path,
                        strerror(errno));
    struct sha256_ctx context;
    sha256_init(&context);
    static uint8_t block[65536];
    size_t length;
    while ((length = fread(block, 1, sizeof block, stream)) > 0)
        sha256_update(&context, length, block);
    ehd_status status = EHD_OK;
    if (ferror(stream))
        status = ehd_fail(error, EHD_IO, "%s: found %s, expected a readable file", path,
                          strerror(errno));
    else
        sha256_end(&context, identity);
    fclose(stream);
    return status;
}

// ---- text

char *utf8_copy(const char *text) {
    char *copy = strdup(text);
    for (char *at = copy; copy && *at;) {
        const size_t length = text_character(at);
        if (length == 0) *at = '?';
        at += length ? length : 1;
    }
    return copy;
}

// ---- history

/* Returns a text that names this build and the HDF5 library in use; free it with free(). */
static char *creator_text(void) {
    unsigned major = 0, minor = 0, release = 0;
    char *text = NULL;
    H5get_libversion(&major, &minor, &release);
    if (asprintf(&text, "%s, HDF5 %u.%u.%u", program_build(), major, minor, release) < 0)
        return NULL;
    return text;
}

/* Prints one word of a command line, quoted for a shell. Replaces control characters by '?',
 * because a line break would split the history line. */
static void print_word(FILE *stream, const char *word) {
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                                "_-+=./,:@%";
    if (*word && word[strspn(word, plain)] == '\0') {
        fputs(word, stream);
        return;
    }
    fputc('\'', stream);
    for (; *word; word++) {
        if (*word == '\'') {
            fputs("'\\''", stream);
        } else {
            fputc((unsigned char)*word < ' ' ? '?' : *word, stream);
        }
    }
    fputc('\'', stream);
}

char *history_line(const program *caller) {
    char *line = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&line, &size);
    if (!stream) return NULL;

    char stamp[32];
    time_t now = time(NULL);
    struct tm utc;
    gmtime_r(&now, &utc);
    strftime(stamp, sizeof stamp, "%Y-%m-%dT%H:%M:%SZ", &utc);
    // "ehdrom 0.1.0 (revision …": the second word is the version
    const char *version = program_build();
    version += strcspn(version, " ");
    version += *version == ' ';
    fprintf(stream, "%s %s %.*s:", stamp, caller->name, (int)strcspn(version, " "), version);
    for (int i = 0; i < caller->argc; i++) {
        fputc(' ', stream);
        print_word(stream, caller->argv[i]);
    }
    fputc('\n', stream);
    if (fclose(stream) == 0) return line;
    free(line);
    return NULL;
}

static bool has_line(const char *text, const char *line, size_t length) {
    while (text && *text) {
        size_t found = strcspn(text, "\n");
        if (found == length && strncmp(text, line, length) == 0) return true;
        text += found + (text[found] == '\n');
    }
    return false;
}

/* Returns the history of a file; free it with free(). NULL: no artefact, or no history. */
static char *history_of(const char *path) {
    char *history = NULL;
    hid_t file = hdf5_open(path, H5F_ACC_RDONLY, false);
    if (file < 0) hdf5_note_failure();
    if (file < 0) return NULL;
    if (hdf5_has_attribute(file, "schema_name")) history = hdf5_get_text(file, "history");
    H5Fclose(file);
    return history;
}

/* Returns the history of all inputs that are artefacts, each line once; free it with free(). */
static char *history_of_inputs(const char *const *inputs) {
    char *all = strdup("");
    for (; all && inputs && *inputs; inputs++) {
        char *history = history_of(*inputs);
        // inputs with a common ancestor share lines
        for (const char *line = history; all && line && *line;) {
            size_t length = strcspn(line, "\n");
            if (length > 0 && !has_line(all, line, length)) {
                char *longer = NULL;
                if (asprintf(&longer, "%s%.*s\n", all, (int)length, line) < 0) longer = NULL;
                free(all);
                all = longer;
            }
            line += length + (line[length] == '\n');
        }
        free(history);
    }
    return all;
}

static const char *content_of(const char *path) {
    const hid_t file = hdf5_open(path, H5F_ACC_RDONLY, false);
    if (file < 0) hdf5_note_failure();
    if (file < 0) return NULL;
    const char *outcome = digest_outcome(file);
    H5Fclose(file);
    return outcome;
}

const char *artefact_content(const char *path) {
    hdf5_start();
    return content_of(path);
}

// ---- into the file

static bool put_inputs(hid_t root, const char *const *inputs, ehd_status *status,
                       ehd_error *error) {
    char identity[65];
    char name[64];
    for (int i = 0; inputs && inputs[i]; i++) {
        *status = artefact_file_identity(identity, inputs[i], error);
        if (*status != EHD_OK) return true;
        snprintf(name, sizeof name, "input_%d_path", i + 1);
        if (!hdf5_put_text(root, name, inputs[i])) return false;
        snprintf(name, sizeof name, "input_%d_sha256", i + 1);
        if (!hdf5_put_string(root, name, identity)) return false;
        const char *content = content_of(inputs[i]);
        snprintf(name, sizeof name, "input_%d_content", i + 1);
        if (content && !hdf5_put_string(root, name, content)) return false;
    }
    return true;
}

bool had_input(hid_t root, const char *path, const char identity[65]) {
    bool same = false, named = false;
    char name[64];
    for (int i = 1; !named; i++) {
        snprintf(name, sizeof name, "input_%d_path", i);
        char *recorded = hdf5_get_text(root, name);
        if (!recorded) break;
        snprintf(name, sizeof name, "input_%d_sha256", i);
        char *content = hdf5_get_string(root, name);
        bool equal = content && strcmp(content, identity) == 0;
        named = strcmp(recorded, path) == 0;
        same = equal || (same && !named);
        free(content);
        free(recorded);
    }
    return same;
}

bool put_complete(hid_t root, int64_t complete) {
    return hdf5_put_attribute(root, "complete", H5T_STD_I64LE, &complete);
}

bool put_history(hid_t root, const char *before, const char *line) {
    char *history = NULL;
    bool written = false;
    if (asprintf(&history, "%s%s", before, line) >= 0) {
        written = hdf5_put_text(root, "history", history);
        free(history);
    }
    return written;
}

ehd_status put_provenance(artefact *file, const program *caller, const char *settings_text,
                          const char *const *inputs, ehd_error *error) {
    char version[32];
    snprintf(version, sizeof version, "%d.%d", file->schema->major, file->schema->minor);
    char *before = history_of_inputs(inputs);
    char *line = history_line(caller);
    char *creator = creator_text();
    ehd_status status = EHD_OK;
    if (!before || !line || !creator) {
        status = ehd_no_memory(error, file->path);
    } else if (!put_complete(file->id, 0) || !hdf5_put_string(file->id, "Conventions", "CF-1.8") ||
               !hdf5_put_string(file->id, "schema_name", file->schema->name) ||
               !hdf5_put_string(file->id, "schema_version", version) ||
               !hdf5_put_string(file->id, "title", file->schema->title) ||
               !put_history(file->id, before, line) ||
               !hdf5_put_text(file->id, "creator", creator) ||
               !hdf5_put_text(file->id, "settings", settings_text ? settings_text : "") ||
               !put_inputs(file->id, inputs, &status, error)) {
        status = hdf5_write_failed(file, "provenance", error);
    }
    free(creator);
    free(line);
    free(before);
    return status;
}
