/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lets the bodies of a contact separate and touch again. Bodies that are apart exert no force until
 * they touch again (README.md, Bodies apart).
 * Called by common/output/time_run.c and romrun/online/online_transient.c to wrap their solvers. */
#ifndef EHD_APART_H
#define EHD_APART_H

#include "common/time/march.h"

/* State of the bodies at one time. All members are doubles, so that the struct can be saved. */
typedef struct apart_moment {
    double apart;        // 1: the bodies are apart, else 0
    double inner;        // 1: the inner solver has states, perhaps of an earlier contact; else 0
    double approach;     // in the reference frame; NaN: the bodies are apart, and the load is given
    double doubtful;     // up to this path of the fluid the contact has film that formed at rest
    contact_frame frame; // frame of bodies that are apart, scaled by the reference load
} apart_moment;

/* Wraps a solver that always has a contact, so that its bodies can part and touch again. */
typedef struct apart_march {
    march_solver inner;
    const ehd_contact *reference;
    /* Longest time step in which the bodies may part or touch. If they do so in a longer step, this
     * step is rejected. INFINITY: no step is rejected. */
    double longest_step;
    apart_moment now, next; // the accepted state; the state of the last attempt
    // whether the bodies touched again in the last attempt, and the inner solver started anew
    bool begins;
    // Result of the last find_touching: approach and load at which bodies touch at this speed,
    // radius and modulus. Speed NaN: no result yet.
    double speed, radius, modulus, approach, load;
} apart_march;

/* Stores the arguments. The inner solver and `reference` must outlive `self`. */
void apart_init(apart_march *self, march_solver inner, const ehd_contact *reference,
                double longest_step);

/* Returns a solver that lets the bodies separate. Its outcomes set `apart` and `begins`.
 *
 * While the bodies are apart, the force between them is neglected, so the load is 0. The film is
 * the gap between the undeformed bodies, or 0 where they overlap. If the scene gives the load, this
 * gap is not known and the film is NaN. If the neglected force, estimated by the film formula, may
 * exceed 1 % of the reference load, the outcome is EHD_UNTRUSTED. */
march_solver apart_solver(apart_march *self);

#endif
