/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A march of the full model, kept in memory, for tests of transients. */
#ifndef EHD_MARCHED_H
#define EHD_MARCHED_H

#include "common/time/march.h"
#include "common/time/surface.h"
#include "fullrun/full_march.h"
#include "tests/unit/check.h"

enum { MARCHED_STEPS = 20000 }; // at most

/* A march with what it left behind, in the reference frame. Large: not for the stack. */
typedef struct marched {
    scene scene;
    ehd_contact reference;
    ehd_histories *histories;
    ehd_surface *surface;
    full_march *full;
    march march;
    march_step first; // the start
    ehd_status outcome;
    size_t count; // of entries
    double time[MARCHED_STEPS], film[MARCHED_STEPS], least_film[MARCHED_STEPS],
        pressure[MARCHED_STEPS], approach[MARCHED_STEPS], load[MARCHED_STEPS], exit[MARCHED_STEPS],
        effect[MARCHED_STEPS], effect_minimum[MARCHED_STEPS];
    size_t stop_at; // entry whose store fails; 0: none
} marched;

/* A transient scene with a Barus lubricant on -4 … 2; `transient` is what stands below that key,
 * and where an approach is among it the closure is by approach. */
scene marched_scene(double moes_M, double moes_L, const char *density, double step,
                    const char *transient);

/* A point contact with M = 20, L = 5, compressible, on half a grid of 37 by 33 nodes. */
scene marched_point(const char *transient);

/* To the start, which is the first entry. Tests fail where something goes wrong, unless said
 * otherwise. */
void marched_begin(marched *self, const scene *of); // end with marched_end
/* Goes on; whether it came to the end is in self->outcome. Stopping at `stop_at` is no failure. */
void marched_on(marched *self);
void marched_end(marched *self);

/* From start to end. */
void marched_all(marched *self, const scene *of);

/* Another object that goes on from what was saved of `stopped`, with the same bits as `whole`, a run
 * without a stop. */
void marched_check_restored(marched *other, // work
                            const marched *stopped, const double *saved, const marched *whole);

/* Largest relative difference of the central film from that of a run with many more steps. */
double marched_deviation(const marched *self, const marched *from);

#endif
