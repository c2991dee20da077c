/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes traction: the effect of the shear of the film on the two surfaces (README.md,
 * Traction). Surface 1, below the film, moves at u1, surface 2 at u2. (u1 - u2)/u_m is the
 * contact's slide_roll.
 * Called by fullrun/scalars.c, romrun/state/node_traction.c, romrun/library/traction.c and
 * common/output. */
#ifndef EHD_TRACTION_H
#define EHD_TRACTION_H

#include "common/physics/contact.h"
#include <math.h>
#include <stdbool.h>
#include <stddef.h>

/* Traction of a contact, in the scales of the contact. Forces are divided by the reference load p_H
 * a^d kind->load, where d is kind->dimensions. Stresses are divided by the Hertz pressure. */
typedef struct contact_traction {
    double coefficient;        // friction over the load
    double friction;           // int tau dA: force on surface 2 along X, and on surface 1 against X
    double rolling_resistance; // 1/2 int h dp/dx dA: force on either surface, against X
    double rolling_moment;     // -int p x dA, divided by a: moment of the pressure, which opposes
                               // the rolling
    double power;              // power input of both surfaces, divided by the product of the load
                               // and the speed at far_speed = 1
    double mean_stress;        // mean of |tau| over the dry contact
    double largest_stress;     // largest |tau|
} contact_traction;

/* Limits of the friction coefficient: programs warn above usual_friction, and do not trust a result
 * above possible_friction. Measured friction coefficients of oils are below 0.15, and the shear
 * stress is below the pressure (S. Bair, W. O. Winer, ASME J. Lubrication Technology 101, 1979;
 * plausible.bats, "friction above 0.2 is warned of"). */
extern const double usual_friction, possible_friction;

/* Returns the friction coefficient to compare with these limits. Friction and load are divided by
 * the reference load. A load below a tenth of the reference load counts as a tenth, because bodies
 * that are nearly apart have more friction than load. */
double traction_judged_coefficient(double friction, double load);

/* Reason of a result whose friction exceeds possible_friction. */
extern const char impossible_friction[];

/* Checks whether a contact has traction: its scene is in SI units and gives a slide-roll ratio. */
bool contact_has_traction(const ehd_contact *contact);

/* Returns a traction that is not known: all NaN. */
contact_traction contact_traction_unknown(void);

/* Returns the shear stress tau over p_H, in the middle between the surfaces, at a dimensionless
 * pressure, film and gradient of pressure along X. The stress is positive if surface 1 is the
 * faster one. The gradient matters only if the law also thins the flow. */
double contact_shear_stress(const ehd_contact *contact, double pressure, double film,
                            double gradient);

/* Derivatives of contact_shear_stress, computed by difference quotients for any law. The
 * derivatives are accurate to 1e-5 where the law is smooth. */
typedef struct stress_slopes {
    double by_pressure, by_film, by_gradient;
} stress_slopes;
stress_slopes contact_stress_slopes(const ehd_contact *contact, double pressure, double film,
                                    double gradient);

/* Numbers that determine how an Eyring fluid thins the flow. Apart from these numbers the flow
 * depends only on M, the Hertz pressure and the lubricant. Both numbers are 0 if the flow is not
 * thinned. */
typedef struct flow_thinning {
    // Newtonian shear stress that the sliding causes, divided by the Eyring stress tau0; at H = 1,
    // with the viscosity at zero pressure
    double sliding;
    double gradient; // h/(2 tau0) dp/dx at H = 1 and dP/dX = 1
} flow_thinning;
flow_thinning traction_thinning(const ehd_contact *contact);

/* Checks whether the law of shear stress also thins the flow: its in_film is true. */
bool traction_thins_flow(const ehd_contact *contact);

/* Dimensionless integrals over the contact, from which the traction follows. */
typedef struct traction_sums {
    double friction;                    // int tau dA
    double rolling;                     // int H dP/dX dA
    double moment;                      // int P X dA
    double mean_stress, largest_stress; // as in contact_traction
} traction_sums;
contact_traction contact_traction_from(const ehd_contact *contact, const traction_sums *sums,
                                       double load); // divided by the reference load

/* Returns the parts of friction and rolling beyond the grid. For a line contact they are integrals
 * from the grid to minus infinity. For a point contact or an ellipse they are the result of
 * far_field_traction (README.md, traction beyond the grid). */
traction_sums
contact_traction_beyond(const ehd_contact *contact,
                        const contact_scalars *scalars); // approach, load, central film

/* Returns int tau dX from the last node with pressure of a line to the exit, minus the half cell
 * behind that node, which the sum over the nodes contains already. At the exit the pressure is
 * zero. If the exit is not between this node and the next node, or not known (NaN), the integral
 * goes to the next node. */
double contact_traction_behind(const ehd_contact *contact, const ehd_grid *grid, size_t node,
                               double stress,        // at the node
                               const double film[2], // at the node and at the next one
                               double exit);         // X

/* Computes the traction from pressure and film at the nodes of the contact's grid that have
 * pressure, and adds the part beyond the grid. Behind the last node with pressure the integral
 * continues to the exit of a line contact, and to the next node otherwise. */
contact_traction
contact_traction_of(const ehd_contact *contact,
                    const double *pressure,          // [num_nodes]
                    const double *film,              // [num_nodes]
                    const contact_scalars *scalars); // of the same state: load, approach,
                                                     // central film and exit

/* Computes the stress of the fluid on each surface along X, over p_H: -tau - h/2 dp/dx and tau -
 * h/2 dp/dx. Both stresses are 0 where there is no pressure. At boundary nodes the pressure of the
 * far field is used. */
void contact_surface_stresses(
    // output:
    double *on_1, double *on_2, // [num_nodes]
    // input:
    const ehd_contact *contact, const double *pressure, const double *film, double rigid_approach);

#endif
