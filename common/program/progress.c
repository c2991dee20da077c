/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/program/program.h"

#include <math.h>
#include <stdio.h>
#include <unistd.h>

// seconds between two lines of progress; more in a log file, to keep the file short
static const double terminal_pause = 0.1, file_pause = 2.0;

void progress_start(progress *self, const program *owner, size_t total) {
    const double now = program_seconds();

    *self = (progress){.program = owner,
                       .total = total,
                       .started = now,
                       .advanced = now,
                       .last_shown = -INFINITY,
                       .terminal = isatty(STDERR_FILENO) == 1};
}

/* Writes a time such as ", 4 s left", in seconds, minutes or hours. */
static void show_time(char *shown, size_t size, double seconds, const char *what) {
    if (seconds < 100)
        snprintf(shown, size, ", %.0f s%s", seconds, what);
    else if (seconds < 6000)
        snprintf(shown, size, ", %.0f min%s", seconds / 60, what);
    else
        snprintf(shown, size, ", %.1f h%s", seconds / 3600, what);
}

/* Writes "; stage 1 of 5, about 3 min in all", without the time if it is not known. */
static void show_stage(char *shown, size_t size, const progress *self, double left) {
    const stage *here = &self->program->stage;
    const bool whole = !isnan(self->rest);
    char time[64] = "";
    bool at_least = false;

    *shown = '\0';
    if (!here->names) return;
    const double all = stage_left(&at_least, here, whole ? left + self->rest : left, whole);
    at_least = at_least || self->more;
    // "at least 0 s" is no information
    if (isfinite(all) && (all > 0.5 || !at_least)) show_time(time, sizeof time, all, " in all");
    // time + 1 skips the comma
    snprintf(shown, size, "; stage %zu of %zu%s%s", here->number, here->total,
             !*time     ? ""
             : at_least ? ", at least"
                        : ", about",
             *time ? time + 1 : "");
}

void progress_show(progress *self, size_t done, const char *current) {
    const double now = program_seconds(), elapsed = now - self->started;
    const double pause = self->terminal ? terminal_pause : file_pause;
    const bool last = done >= self->total;
    char time[64] = "", of_stage[128];

    if (done > self->done) self->advanced = now;
    self->done = done;
    const double items_left = (double)(self->total - done);
    const double left =
        done > 0 ? fmax(elapsed / (double)done * items_left, now - self->advanced) : NAN;
    if (self->program->quiet) return;
    if (!last && now - self->last_shown < pause) return;
    if (last)
        show_time(time, sizeof time, elapsed, "");
    else if (done > 0)
        show_time(time, sizeof time, left, " left");
    show_stage(of_stage, sizeof of_stage, self, last ? 0 : left);
    fprintf(stderr, "%s%s: %zu/%zu %s%s%s%s", self->terminal ? "\r" : "", self->program->name, done,
            self->total, current, time, of_stage, self->terminal ? "\033[K" : "\n");
    self->last_shown = now;
}

void progress_finish(progress *self) {
    // ends the line that was rewritten
    if (self->terminal && isfinite(self->last_shown)) fputc('\n', stderr);
    self->last_shown = -INFINITY;
}
