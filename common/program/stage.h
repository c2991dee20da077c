/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the place of a program in a pipeline of stages that make a model, and the expected duration
 * of these stages.
 *
 * The environment variable EHDROM_STAGES is FILE HERE NAME...: a file, the name of the present
 * stage, and the names of all stages in their order. FILE has a line "NAME SECONDS LEAST" for each
 * stage whose duration is known. SECONDS is the duration of the stage in the last run. If LEAST is
 * 1, SECONDS is a lower bound. */
#ifndef EHD_STAGE_H
#define EHD_STAGE_H

#include <stdbool.h>
#include <stddef.h>

typedef struct stage {
    const char *names; // names of all stages, from EHDROM_STAGES; NULL: there is no pipeline
    char file[1024];
    size_t number, total; // number is from 1 to total
    double started;       // program_seconds at the start of the stage
} stage;

/* Returns the present stage. A variable that does not have this form is ignored. */
stage stage_here(void);

/* Writes the duration of the present stage into FILE (see above). The next run of the pipeline
 * reads FILE to predict the time that is left. */
void stage_end(const stage *self);

/* Goes on to the next stage if the name of that stage is `last`, or ends in "-" and `last`. */
void stage_next(stage *self, const char *last);

/* Writes a lower bound of the duration, in seconds, into FILE for all later stages whose name is
 * `last` or ends in "-" and `last`. A failed write is not reported, because only the display of
 * progress uses the file. */
void stage_expect(const stage *self, const char *last, double seconds);

/* Returns the seconds left in all stages. `left` is the time left in the present stage. If `whole`
 * is true, the present stage ends after this time. Otherwise the present stage lasts as long as
 * expected, and at least `left`. Returns NAN if a duration is not known. */
double stage_left(
    // output:
    bool *at_least, // true if some of the summed durations are lower bounds
    // input:
    const stage *self, double left, bool whole);

#endif
