/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A contact that is lost and found again: bodies that part until nothing presses on the film are apart, without a force,
 * until they touch (README.md, Bodies apart). */
#ifndef EHD_APART_H
#define EHD_APART_H

#include "common/time/march.h"

/* What the bodies were at one time. All members are numbers of one type, so that the struct can be saved as such. */
typedef struct apart_moment {
    double apart;        // 1: they are apart, else 0
    double approach;     // in the reference frame; NaN: apart, and the load was given
    contact_frame frame; // of bodies apart, under the reference's load
} apart_moment;

/* A solver of contacts that are not lost, and what makes of it one of contacts that may be. */
typedef struct apart_march {
    march_solver inner;
    const ehd_contact *reference;
    /* Steps in which bodies touch, or part at a given approach, converge up to this length; INFINITY: all of them. */
    double longest_step;
    apart_moment now, next; // the accepted one, that of the last attempt
    bool begins; // the last attempt found the contact again: the inner solver started from it
    // found last: where bodies touch under some conditions; speed 0: nothing was found yet
    double speed, radius, modulus, approach, load;
} apart_march;

/* Makes no march; `inner` and `reference` have to live as long. */
void apart_init(apart_march *self, march_solver inner, const ehd_contact *reference,
                double longest_step);

/* As a solver. Outcomes have `apart` and `begins`; bodies that are apart have no load, and their undeformed gap as film:
 * 0 where they overlap, NaN where the load is given. Not to be trusted (EHD_UNTRUSTED) where the force that is
 * left out may be more than a hundredth of the reference's load, as told by the film formula. */
march_solver apart_solver(apart_march *self);

#endif
