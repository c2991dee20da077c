/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A time march of the full model whose results are kept in memory, for tests of transient
 * contacts. */
#ifndef EHD_MARCHED_H
#define EHD_MARCHED_H

#include "common/time/march.h"
#include "common/time/surface.h"
#include "fullrun/full_march.h"
#include "tests/unit/check.h"

enum { MARCHED_STEPS = 20000 }; // largest number of steps

/* A march and its results, in the reference frame. It is too large for the stack. */
typedef struct marched {
    scene scene;
    ehd_contact reference;
    ehd_histories *histories;
    ehd_surface *surface;
    full_march *full;
    march march;
    march_step first; // result of the start
    ehd_status outcome;
    size_t count; // number of entries
    double time[MARCHED_STEPS], film[MARCHED_STEPS], least_film[MARCHED_STEPS],
        pressure[MARCHED_STEPS], approach[MARCHED_STEPS], load[MARCHED_STEPS], exit[MARCHED_STEPS],
        effect[MARCHED_STEPS], effect_minimum[MARCHED_STEPS];
    size_t stop_at; // index of the step whose storing fails; 0: no storing fails
} marched;

/* Returns a transient scene of a line contact with a Barus lubricant, on a grid from X = -4 to 2.
 * `transient` is the content of the key `transient` in the scene. If this content has an approach,
 * the approach is given instead of the load. */
scene marched_scene(double moes_M, double moes_L, const char *density, double step,
                    const char *transient);

/* Returns a point contact with M = 20, L = 5, compressible, on half a grid of 37 by 33 nodes. */
scene marched_point(const char *transient);

/* Begins a march and stores its start as the first entry. On errors, this function and the
 * functions below fail the test. */
void marched_begin(marched *self, const scene *of); // end with marched_end
/* Continues the march to its end and sets self->outcome to its status. A stop at `stop_at` is not
 * an error. */
void marched_on(marched *self);
void marched_end(marched *self);

/* Runs a march from start to end. */
void marched_all(marched *self, const scene *of);

/* Restores the saved data of `stopped` into `other` and continues the march of `other` to its end.
 * Checks that its results equal, to the last bit, the results of `whole`, a run without a stop. */
void marched_check_restored(marched *other, // work
                            const marched *stopped, const double *saved, const marched *whole);

/* Returns the largest relative difference between the central film of `self` and the central film
 * of `from`, a run with many more steps. */
double marched_deviation(const marched *self, const marched *from);

#endif
