/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/fuzz/flat_edit.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { UNIT = 64, NAME = 48, MAX_BLOCKS = 128, MAX_BYTES = 1 << 22, WORD = 8 };

/* A block of the file: a header of UNIT bytes with name, count and size, and the padded data. */
typedef struct block {
    unsigned char header[UNIT];
    unsigned char *data;
    size_t length;
} block;

typedef struct edited {
    unsigned char header[UNIT];
    block blocks[MAX_BLOCKS];
    size_t num_blocks, cut;
    bool header_given;
    char *words[4]; // missing words are ""
} edited;

static uint64_t word_at(const unsigned char *bytes) {
    uint64_t value;
    memcpy(&value, bytes, sizeof value);
    return value;
}

static void put_word(unsigned char *bytes, uint64_t value) {
    memcpy(bytes, &value, sizeof value);
}

static size_t padded(size_t length) {
    return (length + UNIT - 1) / UNIT * UNIT;
}

static uint64_t whole(const char *text) {
    return strtoull(text, NULL, 0);
}

static uint64_t bits_of(const char *text) {
    const double value = strtod(text, NULL);
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

// ---- the file

static unsigned char *read_all(const char *path, size_t *length) {
    FILE *file = fopen(path, "rb");
    unsigned char *bytes = malloc(MAX_BYTES);
    if (!file || !bytes) abort();
    *length = fread(bytes, 1, MAX_BYTES, file);
    fclose(file);
    return bytes;
}

/* Sets the data to `length` bytes, in which the `count` given bytes are repeated. */
static void set_data(block *self, const unsigned char *data, size_t count, size_t length) {
    self->data = calloc(padded(length) + UNIT, 1);
    if (!self->data) abort();
    self->length = length;
    for (size_t i = 0; i < length; i++)
        self->data[i] = data[i % count];
}

/* Splits a valid file into header and blocks. */
static void take_blocks(edited *self, const unsigned char *bytes, size_t length) {
    memcpy(self->header, bytes, UNIT);
    for (size_t at = UNIT; at + UNIT <= length; self->num_blocks++) {
        block *next = &self->blocks[self->num_blocks];
        if (self->num_blocks == MAX_BLOCKS - MAX_BLOCKS / 4) abort();
        memcpy(next->header, bytes + at, UNIT);
        const size_t size = word_at(bytes + at + NAME) * word_at(bytes + at + NAME + WORD);
        if (size > length - at - UNIT) abort();
        set_data(next, bytes + at + UNIT, size, size);
        at += UNIT + padded(size);
    }
}

static void write_blocks(edited *self, const char *path) {
    FILE *file = fopen(path, "wb");
    size_t length = UNIT, left;
    for (size_t i = 0; i < self->num_blocks; i++)
        length += UNIT + padded(self->blocks[i].length);
    left = length > self->cut ? length - self->cut : 0;
    if (!self->header_given) put_word(self->header + 2 * WORD, left);
    if (!file) abort();
    fwrite(self->header, 1, left < UNIT ? left : UNIT, file);
    left -= left < UNIT ? left : UNIT;
    for (size_t i = 0; i < self->num_blocks; i++) {
        const block *one = &self->blocks[i];
        const size_t head = left < UNIT ? left : UNIT;
        fwrite(one->header, 1, head, file);
        left -= head;
        const size_t data = left < padded(one->length) ? left : padded(one->length);
        fwrite(one->data, 1, data, file);
        left -= data;
    }
    if (fclose(file)) abort();
}

// ---- the edits: words[1] is a block, except in `header` and `cut`

static block *find(edited *self) {
    const char *name = self->words[1];
    if (self->num_blocks == 0 || !*name) return NULL;
    if (*name >= '0' && *name <= '9') return &self->blocks[whole(name) % self->num_blocks];
    for (size_t i = 0; i < self->num_blocks; i++)
        if (strncmp((const char *)self->blocks[i].header, name, NAME) == 0) return &self->blocks[i];
    return NULL;
}

static void set_number(edited *self, uint64_t value) {
    block *one = find(self);
    if (!one || one->length < WORD) return;
    put_word(one->data + WORD * (whole(self->words[2]) % (one->length / WORD)), value);
}

static void edit_put(edited *self) {
    set_number(self, bits_of(self->words[3]));
}

static void edit_whole(edited *self) {
    set_number(self, whole(self->words[3]));
}

static void edit_fill(edited *self) {
    const block *one = find(self);
    for (size_t at = 0; one && at + WORD <= one->length; at += WORD)
        put_word(one->data + at, bits_of(self->words[2]));
}

static void edit_resize(edited *self) {
    block *one = find(self);
    const size_t count = whole(self->words[2]);
    const size_t size = one ? word_at(one->header + NAME + WORD) : 0;
    if (!one || one->length == 0 || size == 0 || count > MAX_BYTES / 4 / size) return;
    const block before = *one;
    set_data(one, before.data, before.length, count * size);
    free(before.data);
    put_word(one->header + NAME, count);
}

static void edit_count(edited *self) {
    block *one = find(self);
    if (one) put_word(one->header + NAME, whole(self->words[2]));
}

static void edit_size(edited *self) {
    block *one = find(self);
    if (one) put_word(one->header + NAME + WORD, whole(self->words[2]));
}

static void edit_name(edited *self) {
    block *one = find(self);
    // a name of 48 characters has no terminator
    if (one) memccpy(one->header, self->words[2], 0, NAME);
}

static void edit_drop(edited *self) {
    block *one = find(self);
    if (!one) return;
    free(one->data);
    const size_t behind = (size_t)(&self->blocks[self->num_blocks] - one) - 1;
    memmove(one, one + 1, behind * sizeof *one);
    self->num_blocks--;
}

static void edit_twice(edited *self) {
    block *one = find(self);
    if (!one || self->num_blocks == MAX_BLOCKS) return;
    const size_t behind = (size_t)(&self->blocks[self->num_blocks] - one);
    memmove(one + 1, one, behind * sizeof *one);
    set_data(one, one[1].data, one[1].length, one[1].length);
    self->num_blocks++;
}

static void edit_header(edited *self) {
    put_word(self->header + WORD * (whole(self->words[1]) % (UNIT / WORD)), whole(self->words[2]));
    self->header_given = true;
}

static void edit_cut(edited *self) {
    self->cut = whole(self->words[1]);
}

// ---- the text

const char *const flat_edit_words[] = {"put",  "whole", "fill",  "resize", "count", "size",
                                       "name", "drop",  "twice", "header", "cut",   NULL};
static void (*const edits[])(edited *) = {edit_put,   edit_whole,  edit_fill, edit_resize,
                                          edit_count, edit_size,   edit_name, edit_drop,
                                          edit_twice, edit_header, edit_cut};

/* Applies a line; returns whether it was an edit. */
static bool edit_line(edited *self, char *line) {
    static char nothing[] = "";
    char *rest = NULL;
    for (size_t i = 0; i < sizeof self->words / sizeof *self->words; i++) {
        self->words[i] = strtok_r(i > 0 ? NULL : line, " \t\r", &rest);
        if (!self->words[i]) self->words[i] = nothing;
    }
    for (size_t i = 0; flat_edit_words[i]; i++)
        if (strcmp(self->words[0], flat_edit_words[i]) == 0) {
            edits[i](self);
            return true;
        }
    return false;
}

void flat_edit_file(const char *path, const char *text, size_t length) {
    enum { MAX_EDITS = 6 }; // readers stop at the first edit that they refuse, so more are useless
    static edited self;
    size_t size, num_edits = 0;
    char *copy = strndup(text, length), *rest = NULL;
    unsigned char *bytes = read_all(path, &size);
    if (!copy) abort();
    memset(&self, 0, sizeof self);
    take_blocks(&self, bytes, size);
    for (char *line = strtok_r(copy, "\n", &rest); line && num_edits < MAX_EDITS;
         line = strtok_r(NULL, "\n", &rest))
        num_edits += edit_line(&self, line);
    write_blocks(&self, path);
    for (size_t i = 0; i < self.num_blocks; i++)
        free(self.blocks[i].data);
    free(bytes);
    free(copy);
}
