/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The dimensionless contact: grid, geometry, elasticity and what a scene's parameters become. */
#ifndef EHD_CONTACT_H
#define EHD_CONTACT_H

#include "common/physics/lubricant.h"
#include "common/program/status.h"
#include "common/settings/scene.h"
#include <stdbool.h>
#include <stddef.h>

/* What differs between kinds of contact (model.md, section 1). */
typedef struct contact_kind {
    const char *name;                                     // "line"
    double load;                                          // dimensionless load: pi/2
    double (*gap)(double x);                              // undeformed gap: X^2/2
    double (*kernel)(double distance, double step);       // deflection at a distance from a cell of
                                                          // unit pressure and width `step`
    double (*lambda)(double moes_M);                      // the steady contact's speed parameter
    double (*alpha_p_H)(double moes_M, double moes_L);    // alpha times Hertz pressure
    double (*central_film)(double moes_M, double moes_L); // estimate of H at the centre
    // what the kernel's constant adds to the approach of a contact `half_width` times the reference's, a
    // unit of load, where the approach is measured `length` reference half widths away
    double (*approach_shift)(double half_width, double length);
} contact_kind;

extern const contact_kind contact_line;

/* Uniform grid. `num_inner` nodes carry unknowns; the zero-pressure boundary nodes lie one step
 * outside and carry a film. Nodes are numbered with them: node k lies at x_min + (k-1) step, inner
 * nodes are 1 … num_inner, num_nodes = num_inner + 2. */
typedef struct ehd_grid {
    double x_min; // contact half widths
    double step;
    size_t num_inner;
    size_t num_nodes;
} ehd_grid;

double grid_x(const ehd_grid *grid, size_t node);

/* Whether two grids have the same nodes, to 1e-9 of a step. */
bool grid_same(const ehd_grid *a, const ehd_grid *b);

/* How the system of equations is closed: by_approach H0 + by_load int P dX = value. */
typedef struct contact_closure {
    double by_approach, by_load, value;
} contact_closure;

/* One contact in its dimensionless frame. */
typedef struct ehd_contact {
    const contact_kind *kind;
    ehd_grid grid;
    ehd_lubricant lubricant;
    double lambda;      // 1, of eq. (7)
    double entrainment; // 1, U of eq. (7), not negative; 1 when stationary
    contact_closure closure;
    double approach_length; // reference half widths; 1: the half width, as in eq. (4)
    double hertz_pressure;  // Pa
    double moes_M, moes_L;  // 1
    double alpha_p_H;       // 1
    double half_width;      // m, NaN unless the scene is physical
    double radius;          // m, NaN unless the scene is physical
    double load;            // N/m, NaN unless the scene is physical
} ehd_contact;

/* The scalars of a solution, in the contact's own frame. */
typedef struct contact_scalars {
    double central_film_thickness; // H at X = 0, interpolated (cubic) where no node lies there
    double minimum_film_thickness; // smallest nodal value
    double central_pressure;
    double rigid_approach; // H0
    double exit_position;  // X of the first node without pressure
    double load;           // int P dX relative to the kind's
} contact_scalars;

/* Returns EHD_OK, or EHD_DATA: lubricant constants, Hertz pressure beyond the viscosity law's limit,
 * viscosity that contradicts the law. */
ehd_status contact_init(
    // output:
    ehd_contact *contact,
    // input:
    const scene *given, ehd_error *error);

/* Changes M and L of a contact that keeps its lubricant and grid (continuation, eq. of section 1).
 * The Hertz pressure follows from L. */
void contact_set_moes(ehd_contact *contact, double moes_M, double moes_L);

/* Whether the approach may be given. A line contact deflects without bound the farther away that is
 * measured from; measured from within a quarter of the pressurised length its compliance is not positive,
 * and a film that is squeezed by a given approach then grows without bound. EHD_DATA: within half the
 * grid's length. */
ehd_status contact_check_approach(const ehd_contact *contact, ehd_error *error);

/* The closure by a given load: the load balance of eq. (9). */
contact_closure contact_load_closure(const contact_kind *kind);

/* Film scale a^2/R in m: physical film = H * film_scale. NaN unless the scene is physical. */
double contact_film_scale(const ehd_contact *contact);

#endif
