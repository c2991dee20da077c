/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/model/flat.h"

#include "common/program/output_file.h"
#include "common/program/program.h"

#include <errno.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>

_Static_assert(sizeof(size_t) == 8 && sizeof(double) == 8, "numbers have 8 bytes");

enum { ALIGNMENT = 64, NAME_BYTES = 48, VERSION = 6, ORDER = 0x01020304 };

static const char magic[8] = {'E', 'H', 'D', 'R', 'O', 'M', 'F', '\n'};

/* Header of the file: its first ALIGNMENT bytes. */
typedef struct flat_header {
    char magic[8];
    uint32_t version, order; // a reader with another byte order finds a number other than ORDER
    uint64_t size;           // size of the file, bytes
    uint64_t checksum;       // checksum of all bytes behind the header
    char rest[32];           // 0
} flat_header;
_Static_assert(sizeof(flat_header) == ALIGNMENT, "one block");

/* Header of each array. Zeros pad the data of the array to a multiple of ALIGNMENT bytes. */
typedef struct block_header {
    char name[NAME_BYTES];
    uint64_t count, size;
} block_header;
_Static_assert(sizeof(block_header) == ALIGNMENT, "one block");

// ---- failures

bool flat_good(const flat *self) {
    return self->status == EHD_OK;
}

void flat_fail(flat *self, ehd_status status) {
    if (!self->status) self->status = status;
}

void flat_refuse(flat *self, const char *format, ...) {
    char text[512];
    va_list arguments;

    if (self->status) return;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    self->status = ehd_fail(self->error, EHD_DATA, "%s: %s", self->path, text);
}

// ---- files

/* Computes a checksum. The words are distributed over eight partial sums (lanes). Each update of a
 * lane can be inverted, so changing a single word always changes the sum. Eight lanes are fast,
 * because the processor computes different lanes in parallel. */
static uint64_t checksum_of(const unsigned char *bytes, size_t size) {
    enum { LANES = ALIGNMENT / sizeof(uint64_t) };
    const uint64_t factor = UINT64_C(0x9e3779b97f4a7c15);
    uint64_t lanes[LANES] = {1, 2, 3, 4, 5, 6, 7, 8}, sum = size;

    for (size_t at = 0; at < size; at += sizeof lanes) { // `size` is a multiple of ALIGNMENT
        uint64_t words[LANES];
        memcpy(words, bytes + at, sizeof words);
        for (int i = 0; i < LANES; i++) {
            lanes[i] = (lanes[i] ^ words[i]) * factor;
            lanes[i] ^= lanes[i] >> 32;
        }
    }
    for (int i = 0; i < LANES; i++)
        sum = (sum ^ lanes[i]) * factor;
    return sum;
}

static ehd_status open_failed(const char *path, ehd_error *error) {
    return ehd_fail(error, errno == ENOMEM ? EHD_MEMORY : EHD_NOINPUT,
                    "%s: found %s, expected a readable file", path,
                    errno == ENOTSUP ? "no regular file" : strerror(errno));
}

ehd_status flat_is(bool *is, const char *path, ehd_error *error) {
    char found[sizeof magic] = "";
    FILE *file = program_open(path);

    *is = false;
    if (!file) return open_failed(path, error);
    *is = fread(found, sizeof found, 1, file) == 1 && memcmp(found, magic, sizeof magic) == 0;
    const bool failed = ferror(file) != 0;
    const int reason = errno;
    fclose(file);
    return failed ? ehd_fail(error, EHD_IO, "%s: found a read failure (%s), expected to read it",
                             path, strerror(reason))
                  : EHD_OK;
}

void flat_begin(flat *self, const char *path, ehd_error *error) {
    *self = (flat){.path = path, .error = error, .at = ALIGNMENT};
}

void flat_free(flat *self) {
    if (self->reading && self->bytes)
        munmap(self->bytes, self->size);
    else
        free(self->bytes);
    *self = (flat){0};
}

/* Maps the file into memory instead of reading it. For the 18 MB of the demo's model, mapping takes
 * 0.1 ms and reading 5 ms. */
static void map_bytes(flat *self, FILE *file) {
    struct stat found;

    if (fstat(fileno(file), &found) != 0 || found.st_size < ALIGNMENT ||
        found.st_size % ALIGNMENT != 0) {
        flat_refuse(self, "found no whole number of blocks, expected a flat model");
        return;
    }
    void *bytes =
        mmap(NULL, (size_t)found.st_size, PROT_READ, MAP_PRIVATE | MAP_POPULATE, fileno(file), 0);
    if (bytes == MAP_FAILED) {
        self->status = ehd_fail(self->error, errno == ENOMEM ? EHD_MEMORY : EHD_IO,
                                "%s: found %s, expected to map it", self->path, strerror(errno));
        return;
    }
    self->bytes = bytes;
    self->size = (size_t)found.st_size;
}

static void check_header(flat *self) {
    const char *wanted = getenv("EHDROM_DIGEST");
    flat_header header;

    memcpy(&header, self->bytes, sizeof header);
    if (memcmp(header.magic, magic, sizeof magic) != 0)
        flat_refuse(self, "found no flat model, expected one");
    else if (header.order != ORDER || header.version != VERSION)
        flat_refuse(self, "found version %u (byte order %#x), expected %d (%#x)", header.version,
                    header.order, VERSION, ORDER);
    else if (header.size != self->size)
        flat_refuse(self, "found %zu bytes, expected %zu: it was cut or added to", self->size,
                    (size_t)header.size);
    else if ((!wanted || strcmp(wanted, "no") != 0) &&
             checksum_of(self->bytes + ALIGNMENT, self->size - ALIGNMENT) != header.checksum)
        flat_refuse(self, "found another checksum, expected that of its content: it is damaged");
}

ehd_status flat_read(flat *self, const char *path, ehd_error *error) {
    FILE *file = program_open(path);

    flat_begin(self, path, error);
    self->reading = true;
    if (!file) return self->status = open_failed(path, error);
    map_bytes(self, file);
    fclose(file);
    if (flat_good(self)) check_header(self);
    return self->status;
}

ehd_status flat_write(flat *self, bool force) {
    flat_header header = {.version = VERSION, .order = ORDER, .size = self->size};
    output_file out;

    if (!flat_good(self)) return self->status;
    memcpy(header.magic, magic, sizeof magic);
    header.checksum = checksum_of(self->bytes + ALIGNMENT, self->size - ALIGNMENT);
    memcpy(self->bytes, &header, sizeof header);
    const ehd_status status = output_file_create(&out, self->path, force, self->error);
    if (status) return status;
    fwrite(self->bytes, self->size, 1, out.stream);
    return output_file_finish(&out, self->error);
}

// ---- blocks

static size_t padded(size_t bytes) {
    return (bytes + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
}

static block_header header_of(const char *name, size_t count, size_t size) {
    block_header header = {.count = count, .size = size};

    snprintf(header.name, sizeof header.name, "%s", name);
    return header;
}

/* Appends `bytes` zero bytes. Returns false if there is no memory. */
static bool grow(flat *self, size_t bytes) {
    const size_t needed = self->at + bytes;

    if (needed > self->room) {
        const size_t room = 2 * needed;
        unsigned char *grown = realloc(self->bytes, room);
        if (!grown) {
            self->status = ehd_no_memory(self->error, self->path);
            return false;
        }
        self->bytes = grown;
        self->room = room;
    }
    memset(self->bytes + self->at, 0, bytes);
    self->size = needed;
    return true;
}

static void *write_block(flat *self, const block_header *header, void *array) {
    const size_t bytes = header->count * header->size;

    if (!grow(self, sizeof *header + padded(bytes))) return NULL;
    memcpy(self->bytes + self->at, header, sizeof *header);
    if (bytes > 0) memcpy(self->bytes + self->at + sizeof *header, array, bytes);
    self->at = self->size;
    return array;
}

static void *read_block(flat *self, const block_header *expected) {
    const size_t left = self->size - self->at;
    block_header found = {.name = ""};

    if (left >= sizeof found) memcpy(&found, self->bytes + self->at, sizeof found);
    found.name[NAME_BYTES - 1] = '\0';
    if (left < sizeof found || strcmp(found.name, expected->name) != 0 ||
        found.count != expected->count || found.size != expected->size) {
        flat_refuse(
            self, "%s: found %s%zu numbers of %zu bytes, expected %zu of %zu", expected->name,
            strcmp(found.name, expected->name) == 0 ? "" : "another block, ", (size_t)found.count,
            (size_t)found.size, (size_t)expected->count, (size_t)expected->size);
        return NULL;
    }
    size_t bytes; // the padding also fits, because `left` is a multiple of ALIGNMENT
    if (__builtin_mul_overflow(expected->count, expected->size, &bytes) ||
        bytes > left - sizeof found) {
        flat_refuse(self, "%s: found %zu bytes, expected more", expected->name, left);
        return NULL;
    }
    void *data = self->bytes + self->at + sizeof found;
    self->at += sizeof found + padded(bytes);
    return data;
}

void *flat_array(flat *self, const char *name, void *array, size_t count, size_t size) {
    const block_header header = header_of(name, count, size);

    if (!flat_good(self)) return NULL;
    return self->reading ? read_block(self, &header) : write_block(self, &header, array);
}

size_t flat_whole(flat *self, const char *name, size_t value, size_t least, size_t most) {
    const size_t *found = flat_array(self, name, &value, 1, sizeof value);

    if (!found) return least;
    if (*found >= least && *found <= most) return *found;
    flat_refuse(self, "%s: found %zu, expected %zu to %zu", name, *found, least, most);
    return least;
}

double flat_real(flat *self, const char *name, double value) {
    const double *found = flat_array(self, name, &value, 1, sizeof value);

    return found ? *found : 0;
}

static bool all_finite(const double *numbers, size_t count) {
    double sum = 0;

    for (size_t i = 0; i < count; i++)
        sum += numbers[i] - numbers[i]; // adds NaN if the number is not finite, else 0
    return sum == 0;
}

double *flat_table(flat *self, const char *name, double *table, size_t rows, size_t columns) {
    size_t count;

    if (__builtin_mul_overflow(rows, columns, &count)) {
        flat_refuse(self, "%s: found %zu by %zu numbers, expected fewer", name, rows, columns);
        return NULL;
    }
    double *found = flat_array(self, name, table, count, sizeof *table);
    if (found && self->reading && !all_finite(found, count)) {
        flat_refuse(self, "%s: found a number that is not finite, expected none", name);
        return NULL;
    }
    return found;
}
