/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where a program is one of several stages that make a model, one after the other: which, and what
 * those after it are expected to take. The environment variable EHDROM_STAGES is FILE HERE NAME...:
 * the stages' names in their order, the name of the present one, and a file with a line "NAME
 * SECONDS LEAST" for each of which something is known: as long as it took the last time, or, where
 * LEAST is 1, what it takes at least. */
#ifndef EHD_STAGE_H
#define EHD_STAGE_H

#include <stdbool.h>
#include <stddef.h>

typedef struct stage {
    const char *names; // of the environment, the first of them; NULL: a program by itself
    char file[1024];
    size_t number, total; // from 1
    double started;       // program_seconds
} stage;

/* The present one. A variable that does not read so counts as none. */
stage stage_here(void);

/* What it took is kept for the next time. */
void stage_end(const stage *self);

/* A program that is the next stage too goes on to it, if that has the name `last`, or the end of it
 * behind a "-". */
void stage_next(stage *self, const char *last);

/* What all later stages of this name, or which end in it behind a "-", take at least, s.
 * Nothing is said where the file cannot be written: it is for progress alone. */
void stage_expect(const stage *self, const char *last, double seconds);

/* Seconds that are left in all, of which so many in the present stage at least; not `whole`: it goes
 * on behind that, as long as expected. NAN where too little is known. */
double stage_left(
    // output:
    bool *at_least, // where not all that is summed is known so well
    // input:
    const stage *self, double left, bool whole);

#endif
