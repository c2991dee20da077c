/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The dimensionless contact: grid, geometry, elasticity, lubricant and operating point. */
#ifndef EHD_CONTACT_H
#define EHD_CONTACT_H

#include "common/physics/lubricant.h"
#include "common/program/status.h"
#include <stdbool.h>
#include <stddef.h>

/* What differs between kinds of contact (model.md, section 1). */
typedef struct contact_kind {
    const char *name; // "line"
    int dimensions;   // of the pressurised zone: 1, 2
    double load;      // dimensionless load: pi/2, 2 pi/3
    // deflection at a distance (along, across) from a cell of unit pressure, `step` wide
    double (*kernel)(double x, double y, double step);
    double (*lambda)(double moes_M);                      // the steady contact's speed parameter
    double (*moes_M)(double lambda);                      // and back
    double (*alpha_p_H)(double moes_M, double moes_L);    // alpha times Hertz pressure
    double (*central_film)(double moes_M, double moes_L); // estimate of H at the centre
    // what the kernel's constant adds to the approach of a contact `half_width` times the reference's, a
    // unit of load, where the approach is measured `length` reference half widths away
    double (*approach_shift)(double half_width, double length);
    // Moes numbers and half width from load, radius, speed and modulus (speed number: eta0 2 u_m/(E' R))
    double (*physical_M)(double load_number, double speed_number);
    double (*half_width)(double load, double radius, double modulus);
} contact_kind;

extern const contact_kind contact_line, contact_point;

/* The kind of this name, or NULL. */
const contact_kind *contact_kind_find(const char *name);

/* Uniform grid of square cells. `num_inner` nodes carry unknowns; the zero-pressure boundary nodes lie one
 * step outside and carry a film. Nodes are numbered with them, line after line across the entrainment: of a
 * line contact, which has one line, node k lies at x_min + (k-1) step, inner nodes are 1 … num_inner,
 * num_nodes = num_inner + 2. Of a point contact the lines run from y = -y_max to y_max or, where the half
 * does for all by symmetry, from y = 0, with a boundary line at either end that is not a mirror. */
typedef struct ehd_grid {
    double x_min; // contact half widths
    double step;
    size_t inner_x;     // inner nodes of a line
    size_t inner_lines; // lines of inner nodes: 1 of a line contact
    bool half;          // the first line is y = 0
    size_t num_inner;   // inner_x inner_lines
    size_t num_nodes;
} ehd_grid;

/* Fills the counts. */
ehd_grid grid_of(double x_min, double step, size_t inner_x, size_t inner_lines, bool half);

double grid_x(const ehd_grid *grid, size_t node);
double grid_y(const ehd_grid *grid, size_t node); // 0 of a line contact
double grid_gap(const ehd_grid *grid, size_t node);

/* Undeformed gap (X^2 + Y^2)/2. */
double contact_gap(double x, double y);

/* Nodes of a line, all lines, and those before the first inner one. */
size_t grid_width(const ehd_grid *grid);
size_t grid_lines(const ehd_grid *grid);
size_t grid_first_line(const ehd_grid *grid);

/* Whether a line has inner nodes; the others are boundary. */
bool grid_is_inner_line(const ehd_grid *grid, size_t line);

/* First node of the line Y = 0. */
size_t grid_central_line(const ehd_grid *grid);

/* Inner nodes are numbered on their own too, by rows of the Reynolds equation: 0 … num_inner - 1. */
size_t grid_node_of_row(const ehd_grid *grid, size_t row);
size_t grid_row_of_node(const ehd_grid *grid, size_t node);

/* The grid without a mirror, and the row of `grid` that stands for a row of that one. */
ehd_grid grid_whole(const ehd_grid *grid);
size_t grid_row_of_whole(const ehd_grid *grid, size_t row);

/* The columns behind the last positive pressure, counted with the boundary nodes, on all lines; 1 where a line has
 * none. */
void grid_exit_columns(
    // output:
    size_t *columns, // [grid_lines]
    // input:
    const double *pressure, // [num_nodes]
    const ehd_grid *grid);

/* X of the exits on the inner lines of the whole grid from such columns on all lines of `grid`,
 * [grid_lines]; NaN where column 1 has none. The lines of a half grid are the last ones. */
void grid_exits(
    // output:
    double *positions, // [inner lines of grid_whole]
    // input:
    const size_t *columns, const ehd_grid *grid);

/* Of the cells that a node stands for: 2 off the mirror line of a half grid. */
double grid_weight(const ehd_grid *grid, size_t node);
/* Length or area of a cell. */
double grid_cell(const ehd_grid *grid);
/* What a node's pressure adds to the load. */
double grid_load_weight(const ehd_grid *grid, size_t node);

/* Whether two grids have the same nodes, to 1e-9 of a step. */
bool grid_same(const ehd_grid *a, const ehd_grid *b);

/* How the system of equations is closed: by_approach H0 + by_load int P = value. */
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
    double load;            // N/m or N, NaN unless the scene is physical
} ehd_contact;

/* The scalars of a solution, in the contact's own frame. */
typedef struct contact_scalars {
    double central_film_thickness; // H at X = Y = 0, interpolated (cubic) where no node lies there
    double minimum_film_thickness; // smallest nodal value
    double central_pressure;
    double rigid_approach; // H0
    double exit_position;  // X of the first node without pressure, at Y = 0
    double load;           // int P relative to the kind's
} contact_scalars;

/* What a contact is made from. NaN: not given. */
typedef struct contact_settings {
    const contact_kind *kind;
    ehd_grid grid;
    lubricant_settings lubricant;
    double moes_M, moes_L;  // 1; NaN: by the next five, which are otherwise not used
    double load;            // N/m of a line contact, N of a point contact
    double radius;          // m
    double speed;           // m/s, mean of the two surfaces
    double modulus;         // Pa, E' = 2/[(1-nu1^2)/E1 + (1-nu2^2)/E2]
    double viscosity;       // Pa s at zero pressure
    double hertz_pressure;  // Pa; NaN: the one that M, L and the lubricant imply
    bool approach_given;    // instead of the load
    double approach_length; // reference half widths; NaN: 10 where the approach is given, else 1
} contact_settings;

/* Returns EHD_OK, or EHD_DATA: lubricant constants, Hertz pressure beyond the viscosity law's limit,
 * viscosity that contradicts the law, an approach measured from too near. */
ehd_status contact_init(
    // output:
    ehd_contact *contact,
    // input:
    const contact_settings *given, ehd_error *error);

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
