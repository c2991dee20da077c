/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lets a contact be lost and found again. Once nothing presses on the film, the bodies are apart: they exert no force until
 * they touch again (README.md, Bodies apart). */
#ifndef EHD_APART_H
#define EHD_APART_H

#include "common/time/march.h"

/* State of the bodies at one time. All members are doubles, so that the struct can be saved. */
typedef struct apart_moment {
    double apart;    // 1: they are apart, else 0
    double inner;    // 1: the inner solver has states, though maybe old ones, else 0
    double approach; // in the reference frame; NaN: apart, and the load was given
    double doubtful; // path of the fluid up to which the contact has a film that was found at rest
    contact_frame frame; // of bodies apart, under the reference's load
} apart_moment;

/* Wraps a solver whose contact cannot be lost. The wrapped solver can lose it and find it again. */
typedef struct apart_march {
    march_solver inner;
    const ehd_contact *reference;
    /* A step in which bodies part or touch is rejected if it is longer than this. INFINITY: no step is. */
    double longest_step;
    apart_moment now, next; // the accepted one, that of the last attempt
    bool begins; // the last attempt found the contact again: the inner solver started from it
    // found last: where bodies touch under some conditions; speed NaN: nothing was found yet
    double speed, radius, modulus, approach, load;
} apart_march;

/* Only stores its arguments. The inner solver and `reference` must outlive it. */
void apart_init(apart_march *self, march_solver inner, const ehd_contact *reference,
                double longest_step);

/* Returns the wrapped solver. Outcomes have `apart` and `begins`. Bodies that are apart have no load, and their undeformed gap
 * as film: 0 where they overlap, NaN where the load is given. An outcome is EHD_UNTRUSTED if the neglected force may exceed
 * 1 % of the reference load. The film formula estimates that force. */
march_solver apart_solver(apart_march *self);

#endif
