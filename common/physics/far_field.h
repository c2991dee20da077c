/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What lies around the grid of a point contact or an ellipse whose boundary is open (README.md,
 * far field). */
#ifndef EHD_FAR_FIELD_H
#define EHD_FAR_FIELD_H

#include "common/physics/reynolds.h"
#include "common/physics/traction.h"
#include "common/program/arena.h"
#include <stdbool.h>
#include <stddef.h>

/* A quantity of the far field and its derivative by the rigid approach. */
typedef struct far_value {
    double value, by_approach;
} far_value;

/* Whether there is a far field: around a grid with lines and BOUNDARY_OPEN. */
bool far_field_is_there(const ehd_grid *grid);

/* Returns H far away, q r^2/2 + H0 + 4/(3 pi c r), with r^2 = X^2 + k^2 Y^2, the ellipticity k and the compliance c. The last
 * term is the deflection by the whole load in one point. */
double far_field_film(const contact_shape *shape, double rigid_approach, double x, double y);

/* Returns P far away, lambda |U| S(phi) r q^2/(2H)^2. The angle phi begins at the side of the inlet, and S is
 * far_angle_shape. With H = q r^2/2 + c it solves the isoviscous Reynolds equation up to terms of
 * c^2/r^4, and of c/r^2 near the exit. U is contact->far_speed. */
far_value far_field_pressure(const ehd_contact *contact, double rigid_approach, double x, double y);

/* Returns the load of the far field beyond the cells of the inner nodes, 0 if the grid has no far field. */
far_value far_field_load(const ehd_contact *contact, double rigid_approach);

/* Returns the integrals of friction and rolling over the far field (README.md, traction beyond the grid). It begins where the
 * cells of the inner nodes end, and it ends where the slope of the gap is one, with a pressure of 0. Returns zeros if the grid
 * has no far field. */
traction_sums far_field_traction(const ehd_contact *contact, double rigid_approach);

/* Returns an error estimate of the rolling of far_field_traction, whose pressure is a series that is cut off. The estimate is
 * the rolling of the last term, the deflection, at its size at the end of the grid, over a factor e of the distance. */
double far_field_rolling_error(const ehd_contact *contact, double rigid_approach);

/* Whether a node of a grid with lines is a boundary node. */
bool far_field_is_at(const ehd_grid *grid, size_t node);

// ---- prepared for many states on a grid

/* Directions of Gauss' rule in the stretched angle, between the corners of the grid. */
enum { FAR_RAYS = 16 };
typedef struct far_rays {
    size_t num;
    double inverse_end[FAR_RAYS]; // 1 over the distance at which the inner nodes' cells end
    double per_rise[FAR_RAYS];    // 1/q
    double upstream[FAR_RAYS];    // cos(phi)
    double weight[FAR_RAYS];      // with S
    double angle[FAR_RAYS];       // without: of phi
} far_rays;

/* The boundary nodes in a list of nodes, and what lies beyond. */
typedef struct far_field {
    size_t num;
    size_t *index;       // [num] in the list
    double *inverse;     // [num] 1/r
    double *per_rise;    // [num] 1/q
    double *shape[2];    // [num] S, of an entrainment towards larger X and of one backwards
    double *by_approach; // [num_nodes] of far_field_add: dP/dH0, zero at the others
    far_rays rays[2];
} far_field;

/* Memory from an arena. */
void far_field_init(
    // output:
    far_field *self, // which may not be used when memory->failed
    // input:
    const ehd_grid *grid,
    const size_t *nodes, // [num_nodes] of the grid; NULL: all
    size_t num_nodes, arena *memory);

/* Adds P of the far field, where there is one, at the boundary nodes, and sets by_approach. */
void far_field_add(
    // in and out:
    double *pressure, // [num_nodes] at the nodes of the list
    far_field *self,
    // input:
    const ehd_contact *contact, double rigid_approach);

/* The contact's closure by what the inner nodes carry, by_load h^2 sum P + by_approach H0 = value:
 * with the load beyond them, linearised at this rigid approach. */
contact_closure far_field_closure(const far_field *self, const ehd_contact *contact,
                                  double rigid_approach);

/* What enters the grid is that of no pressure, as in the previous states of a film in time, which
 * know no other at these nodes. */
void far_field_set_density(reynolds_fluid *fluid, const far_field *self);

#endif
