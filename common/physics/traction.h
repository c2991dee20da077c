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

/* Shear stress tau over p_H, in the middle between the surfaces, at a dimensionless pressure, film and
 * gradient of pressure along X: positive where surface 1 is the faster one. The gradient counts where
 * the law thins the flow too. */
double contact_shear_stress(const ehd_contact *contact, double pressure, double film,
                            double gradient);

/* Its derivatives, of any law by differences: to 1e-5 of them where it is smooth. */
typedef struct stress_slopes {
    double by_pressure, by_film, by_gradient;
} stress_slopes;
stress_slopes contact_stress_slopes(const ehd_contact *contact, double pressure, double film,
                                    double gradient);

/* By what the flow of an Eyring fluid is thinned: besides M, the Hertz pressure and the lubricant all
 * that it depends on. Both are 0 where the flow is not thinned. */
typedef struct flow_thinning {
    double
        sliding; // Newtonian shear stress of the sliding over Eyring's, of a fluid as viscous as at
                 // zero pressure in a film H = 1
    double gradient; // h/(2 tau0) dp/dx in a film H = 1 where dP/dX = 1
} flow_thinning;
flow_thinning traction_thinning(const ehd_contact *contact);

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

/* What lies beyond the grid adds to the friction and the rolling of these sums: before a line to minus
 * infinity, around a point contact or ellipse by far_field_traction (README.md, traction beyond the
 * grid). */
traction_sums
contact_traction_beyond(const ehd_contact *contact,
                        const contact_scalars *scalars); // approach, load, central film

/* int tau dX of the half cell behind the last node with pressure of a line, in place of half a
 * cell: up to the exit, where the pressure is zero; an exit that is not in the cell (NaN: not
 * known): to the next node. */
double contact_traction_behind(const ehd_contact *contact, const ehd_grid *grid, size_t node,
                               double stress,        // at the node
                               const double film[2], // there and at the next node
                               double exit);         // X

/* All of it from pressure and film at the nodes of the contact's grid, where there is pressure, and from
 * what lies beyond. Behind the last node with pressure of a line contact it goes on to the exit, else to
 * the next node. */
contact_traction
contact_traction_of(const ehd_contact *contact,
                    const double *pressure,          // [num_nodes]
                    const double *film,              // [num_nodes]
                    const contact_scalars *scalars); // of the same state: load, approach,
                                                     // central film and exit

/* What the fluid does to each surface along X, over p_H: -tau - h/2 dp/dx and tau - h/2 dp/dx; 0
 * where there is no pressure. At boundary nodes the pressure is that of the far field. */
void contact_surface_stresses(
    // output:
    double *on_1, double *on_2, // [num_nodes]
    // input:
    const ehd_contact *contact, const double *pressure, const double *film, double rigid_approach);

#endif
