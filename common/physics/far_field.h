/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the far field around the grid of a point contact or an ellipse with an open boundary
 * (README.md, Far field).
 * Called by traction.c, by fullrun, and by the folders state, solve and trust of romrun. */
#ifndef EHD_FAR_FIELD_H
#define EHD_FAR_FIELD_H

#include "common/physics/reynolds.h"
#include "common/physics/traction.h"
#include "common/program/arena.h"
#include <stdbool.h>
#include <stddef.h>

/* A quantity of the far field and its derivative with respect to the rigid approach. */
typedef struct far_value {
    double value, by_approach;
} far_value;

/* Checks whether a grid has a far field: several lines and BOUNDARY_OPEN. */
bool far_field_is_there(const ehd_grid *grid);

/* Returns H far from the contact, q r^2/2 + H0 + 4/(3 pi c r), with r^2 = X^2 + k^2 Y^2, the
 * ellipticity k and the compliance c. The last term is the deflection if the whole load acts in one
 * point. */
double far_field_film(const contact_shape *shape, double rigid_approach, double x, double y);

/* Returns P far from the contact, lambda |U| S(phi) r q^2/(2H)^2. The angle phi is measured from
 * the inlet side, and S is far_angle_shape. If H is q r^2/2 plus a constant d, P solves the
 * isoviscous Reynolds equation up to terms of d^2/r^4, and of d/r^2 near the exit. U is
 * contact->far_speed. */
far_value far_field_pressure(const ehd_contact *contact, double rigid_approach, double x, double y);

/* Returns the load of the far field beyond the cells of the inner nodes, or 0 if the grid has no
 * far field. */
far_value far_field_load(const ehd_contact *contact, double rigid_approach);

/* Returns the integrals of friction and rolling over the far field (README.md, traction beyond the
 * grid). The integrals begin where the cells of the inner nodes end. They extend to the rim of the
 * film, where the slope of the gap is one. The pressure at the rim is taken as 0. Returns zeros if
 * the grid has no far field. */
traction_sums far_field_traction(const ehd_contact *contact, double rigid_approach);

/* Returns an error estimate for the rolling integral of far_field_traction. The pressure is a
 * truncated series, and the estimate is the contribution of its last term, the deflection. The
 * integrand is evaluated at the end of the grid and taken as constant up to e times that
 * distance. */
double far_field_rolling_error(const ehd_contact *contact, double rigid_approach);

/* Checks whether a node of a grid with several lines is a boundary node. */
bool far_field_is_at(const ehd_grid *grid, size_t node);

// ---- far field prepared for many states on one grid

/* Number of rays along which the far field is integrated. The rays are the points of Gauss' rule in
 * four ranges of the stretched angle. The ranges meet at the corners of the grid and at pi/2. */
enum { FAR_RAYS = 16 };
typedef struct far_rays {
    size_t num;
    double inverse_end[FAR_RAYS]; // 1 over the distance at which the cells of the inner nodes end
    double per_rise[FAR_RAYS];    // 1/q
    double upstream[FAR_RAYS];    // cos(phi)
    double weight[FAR_RAYS];      // quadrature weight in phi, times S
    double angle[FAR_RAYS];       // quadrature weight in phi
} far_rays;

/* Factors of the far field that depend only on the grid, at the boundary nodes in a list of nodes,
 * and along rays beyond the grid. The far field is the pressure around the grid of a point contact.
 * far_field_film and far_field_pressure define r, q and S. */
typedef struct far_field {
    size_t num;
    size_t *index;       // [num] positions of the boundary nodes in the list
    double *inverse;     // [num] 1/r
    double *per_rise;    // [num] 1/q
    double *shape[2];    // [num] S, for entrainment towards larger X and towards smaller X
    double *by_approach; // [num_nodes] dP/dH0, set by far_field_add; zero at inner nodes
    far_rays rays[2];
} far_field;

/* Prepares the far field with memory from an arena. */
void far_field_init(
    // output:
    far_field *self, // must not be used if memory->failed
    // input:
    const ehd_grid *grid,
    const size_t *nodes, // [num_nodes] nodes of the grid; NULL: all nodes of the grid
    size_t num_nodes, arena *memory);

/* Adds P of the far field to the pressures at the boundary nodes, and sets by_approach. If the grid
 * has no far field, P is 0. */
void far_field_add(
    // in and out:
    double *pressure, // [num_nodes] at the nodes of the list
    far_field *self,
    // input:
    const ehd_contact *contact, double rigid_approach);

/* Returns the closure of the contact, written for the pressures of the inner nodes: by_load h^2 sum
 * P + by_approach H0 = value. The closure includes the load beyond the inner nodes, linearised at
 * this rigid approach. */
contact_closure far_field_closure(const far_field *self, const ehd_contact *contact,
                                  double rigid_approach);

/* Sets the density at the boundary nodes to the density at zero pressure. In a transient run the
 * previous states of the film also have zero pressure at these nodes. */
void far_field_set_density(reynolds_fluid *fluid, const far_field *self);

#endif
