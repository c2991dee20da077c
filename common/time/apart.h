/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lets a contact be lost and found again. Once nothing presses on the film, the bodies are apart:
 * they exert no force until they touch again (README.md, Bodies apart).
 * Called by common/output/time_run.c and romrun/online/online_transient.c to wrap their solvers. */
#ifndef EHD_APART_H
#define EHD_APART_H

#include "common/time/march.h"

/* State of the bodies at one time. All members are doubles, so that the struct can be saved. */
typedef struct apart_moment {
    double apart;        // 1: the bodies are apart, else 0
    double inner;        // 1: the inner solver has states, perhaps old ones; else 0
    double approach;     // in the reference frame; NaN: apart, and the load was given
    double doubtful;     // path of the fluid up to which the contact has film that formed at rest
    contact_frame frame; // frame of bodies that are apart, scaled by the reference load
} apart_moment;

/* Wraps a solver that always has a contact, so that its bodies can part and touch again. */
typedef struct apart_march {
    march_solver inner;
    const ehd_contact *reference;
    /* A step in which the bodies part or touch is rejected if it is longer than this. INFINITY: no
     * step is rejected. */
    double longest_step;
    apart_moment now, next; // the accepted state; the last attempt
    // in the last attempt the bodies touched again, and the inner solver started
    bool begins;
    // conditions (speed NaN: none yet); approach and load at which bodies touch under these
    // conditions
    double speed, radius, modulus, approach, load;
} apart_march;

/* Stores the arguments. The inner solver and `reference` must outlive `self`. */
void apart_init(apart_march *self, march_solver inner, const ehd_contact *reference,
                double longest_step);

/* Returns the wrapped solver. Its outcomes set `apart` and `begins`. Bodies that are apart have no
 * load. Their film is the undeformed gap: 0 where they overlap, NaN if the load is given. An
 * outcome is EHD_UNTRUSTED if the neglected force, estimated by the film formula, may exceed 1 %
 * of the reference load. */
march_solver apart_solver(apart_march *self);

#endif
