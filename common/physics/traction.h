/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Traction: what the shear of the film does to the two surfaces (README.md, traction). Surface 1,
 * below the film, moves at u1, surface 2 at u2; (u1 - u2)/u_m is the contact's slide_roll. */
#ifndef EHD_TRACTION_H
#define EHD_TRACTION_H

#include "common/physics/contact.h"
#include <math.h>
#include <stdbool.h>
#include <stddef.h>

/* Of a contact in its own frame: forces over the frame's reference load p_H a^d kind->load,
 * stresses over its Hertz pressure. */
typedef struct contact_traction {
    double coefficient;        // friction over the load
    double friction;           // int tau dA: on surface 2 along X, against it on surface 1
    double rolling_resistance; // 1/2 int h dp/dx dA: on either surface, against X
    double rolling_moment;     // -int p x dA over a: of the pressures, against the rolling
    double power; // that both surfaces put into the film, over load times the speed of far_speed 1
    double mean_stress;    // of |tau| over the dry contact
    double largest_stress; // of |tau|
} contact_traction;

/* Whether a scene asks for it: its slide-roll ratio is given, and all in SI units. */
bool contact_has_traction(const ehd_contact *contact);

/* Nothing known: all NaN. */
contact_traction contact_traction_unknown(void);

/* Shear stress tau over p_H, in the middle between the surfaces, at a dimensionless pressure and
 * film: positive where surface 1 is the faster one. */
double contact_shear_stress(const ehd_contact *contact, double pressure, double film);

/* Its derivatives by both, of any law by differences: to 1e-5 of them where it is smooth. */
typedef struct stress_slopes {
    double by_pressure, by_film;
} stress_slopes;
stress_slopes contact_stress_slopes(const ehd_contact *contact, double pressure, double film);

/* By what the sliding of an Eyring fluid thins the pressure flow (README.md, thinned flow): the factor
 * on its mobility, along the sliding or across, and its derivative by the logarithm of viscosity over
 * film, over the factor. `rate`: of the Newtonian stress over the law's, sinh(tau/tau0), which is that
 * of traction_thinning_rate times viscosity over film. */
typedef struct flow_thinning {
    double factor, by_log_rate;
} flow_thinning;
static inline flow_thinning traction_thinning(double rate, bool along) {
    const double root = rate < 1e8 ? sqrt(1 + rate * rate) : rate;

    if (along) return (flow_thinning){root, rate / root * (rate / root)};
    if (rate < 1e-4) return (flow_thinning){1 + rate * rate / 6, rate * rate / 3};
    // asinh by that root, to rounding
    const double stress = rate < 0.5 ? log1p(rate + rate * rate / (1 + root)) : log(rate + root);
    return (flow_thinning){rate / stress, 1 - rate / (root * stress)};
}

/* Newtonian shear stress of the sliding over Eyring's, of a fluid as viscous as at zero pressure in
 * a film H = 1: besides M, the Hertz pressure and the lubricant all that a thinned flow depends on,
 * of the slide-roll ratio and of Eyring's stress over the Hertz pressure. 0 where the flow is not
 * thinned. */
double traction_thinning_rate(const ehd_contact *contact);

/* Whether the law of shear stress counts in the flow too: its in_film is true. */
bool traction_thins_flow(const ehd_contact *contact);

/* Integrals over the contact, dimensionless, from which all of it follows. */
typedef struct traction_sums {
    double friction;                    // int tau dA
    double rolling;                     // int H dP/dX dA
    double moment;                      // int P X dA
    double mean_stress, largest_stress; // as in contact_traction
} traction_sums;
contact_traction contact_traction_from(const ehd_contact *contact, const traction_sums *sums,
                                       double load); // over that of the frame

/* int tau dX of the half cell behind the last node with pressure of a line, in place of half a
 * cell: up to the exit, where the pressure is zero; an exit that is not in the cell (NaN: not
 * known): to the next node. */
double contact_traction_behind(const ehd_contact *contact, const ehd_grid *grid, size_t node,
                               double stress,        // at the node
                               const double film[2], // there and at the next node
                               double exit);         // X

/* All of it from pressure and film at the nodes of the contact's grid, where there is pressure. Behind
 * the last node with pressure of a line contact it goes on to the exit, else to the next node. */
contact_traction
contact_traction_of(const ehd_contact *contact,
                    const double *pressure,          // [num_nodes]
                    const double *film,              // [num_nodes]
                    const contact_scalars *scalars); // of the same state: load and exit are used

/* What the fluid does to each surface along X, over p_H: -tau - h/2 dp/dx and tau - h/2 dp/dx; 0
 * where there is no pressure. */
void contact_surface_stresses(
    // output:
    double *on_1, double *on_2, // [num_nodes]
    // input:
    const ehd_contact *contact, const double *pressure, const double *film);

#endif
