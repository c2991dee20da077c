/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/program/stage.h"

#include "common/program/program.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { STAGE_NAME = 128 };

/* Copies the name of stage `number`, counted from 1. The name is empty if there is no such
 * stage. */
static void name_of(char name[STAGE_NAME], const stage *self, size_t number) {
    const char *rest = self->names;
    int length = 0;

    *name = '\0';
    for (size_t i = 0; rest && i < number; i++, rest += length)
        if (sscanf(rest, "%127s%n", name, &length) != 1) {
            *name = '\0';
            return;
        }
}

stage stage_here(void) {
    const char *text = getenv("EHDROM_STAGES");
    stage self = {.started = program_seconds()};
    char here[STAGE_NAME], name[STAGE_NAME];
    int length = 0;

    if (!text || sscanf(text, "%1023s %127s%n", self.file, here, &length) != 2) return self;
    self.names = text + length;
    for (name_of(name, &self, 1); *name; name_of(name, &self, self.total + 1)) {
        self.total++;
        if (strcmp(name, here) == 0) self.number = self.total;
    }
    if (self.number == 0) self.names = NULL;
    return self;
}

/* Checks whether a name is `last` or ends in "-" and `last`. */
static bool ends_in(const char *name, const char *last) {
    const size_t length = strlen(name), end = strlen(last);

    if (length < end || strcmp(name + length - end, last) != 0) return false;
    return length == end || name[length - end - 1] == '-';
}

void stage_next(stage *self, const char *last) {
    char name[STAGE_NAME];

    name_of(name, self, self->number + 1);
    if (!*name || !ends_in(name, last)) return;
    stage_end(self);
    self->number++;
    self->started = program_seconds();
}

typedef struct expectation {
    double seconds; // duration of the stage; NAN: the duration is not known
    int least;
} expectation;

static expectation expected(const stage *self, size_t number) {
    char wanted[STAGE_NAME], name[STAGE_NAME];
    expectation result = {NAN, 0}, found;
    FILE *file = fopen(self->file, "r");

    name_of(wanted, self, number);
    while (file && fscanf(file, "%127s %lf %d", name, &found.seconds, &found.least) == 3)
        if (strcmp(name, wanted) == 0) result = found;
    if (file) fclose(file);
    return result;
}

/* Rewrites the file with a new duration. If `last` is NULL, `seconds` is the duration of the
 * present stage. Otherwise `seconds` is a lower bound for each later stage whose name ends in
 * `last` (stage.h). */
static void renew(const stage *self, const char *last, double seconds) {
    char name[STAGE_NAME], path[sizeof self->file + 32];
    FILE *file = NULL;

    snprintf(path, sizeof path, "%s.%ld", self->file, (long)getpid());
    if (self->names) file = fopen(path, "w");
    if (!file) return;
    for (size_t number = 1; number <= self->total; number++) {
        name_of(name, self, number);
        const bool is_new =
            last ? number > self->number && ends_in(name, last) : number == self->number;
        const expectation here =
            is_new ? (expectation){seconds, last != NULL} : expected(self, number);
        if (!isnan(here.seconds)) fprintf(file, "%s %.3g %d\n", name, here.seconds, here.least);
    }
    if (fclose(file) != 0 || rename(path, self->file) != 0) unlink(path);
}

void stage_expect(const stage *self, const char *last, double seconds) {
    renew(self, last, seconds);
}

void stage_end(const stage *self) {
    renew(self, NULL, program_seconds() - self->started);
}

double stage_left(bool *at_least, const stage *self, double left, bool whole) {
    const double elapsed = program_seconds() - self->started;

    *at_least = false;
    if (!self->names) return NAN;
    for (size_t number = whole ? self->number + 1 : self->number; number <= self->total; number++) {
        const expectation here = expected(self, number);
        if (number > self->number)
            left += here.seconds;
        else // fmax would ignore NAN
            left = isnan(here.seconds) ? NAN : fmax(left, here.seconds - elapsed);
        *at_least = *at_least || here.least;
    }
    return left;
}
