/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The dimensionless contact: grid, geometry, elasticity, lubricant and operating point. "Maier et
 * al." in this folder are Maier, Hager, Hetzler, Seemann, Tribology International 2015. */
#ifndef EHD_CONTACT_H
#define EHD_CONTACT_H

#include "common/physics/ellipse.h"
#include "common/physics/lubricant.h"
#include "common/program/status.h"
#include <stdbool.h>
#include <stddef.h>

/* What differs between a line, a point and an elliptical contact (README.md, kinds of contact). Of
 * what depends on the shape of the contact this is the first argument. */
typedef struct contact_kind {
    const char *name; // "line"
    int dimensions;   // of the pressurised zone: 1, 2
    double load;      // dimensionless load: pi/2, 2 pi/3
    // deflection at a distance (along, across) from a cell of unit pressure, `step` along and
    // shape->cell times as much across
    double (*kernel)(const contact_shape *shape, double x, double y, double step);
    // the steady contact's speed parameter, and back
    double (*lambda)(const contact_shape *shape, double moes_M);
    double (*moes_M)(const contact_shape *shape, double lambda);
    // alpha times Hertz pressure
    double (*alpha_p_H)(const contact_shape *shape, double moes_M, double moes_L);
    // estimate of H at the centre
    double (*central_film)(const contact_shape *shape, double moes_M, double moes_L);
    double (*dry_gap)(const contact_shape *shape, double x); // dry contact on Y = 0, |x| >= 1
    // change of the approach per unit of load when the half width is `half_width` times the
    // reference and the approach is measured from a distance of `length` reference half widths
    double (*approach_shift)(double half_width, double length);
    // Moes number M and half width from load, radius, speed and modulus; the speed number is
    // eta0 2 u_m/(E' R). Of any one shape a half width is the same powers of all three
    double (*physical_M)(double load_number, double speed_number);
    double (*half_width)(const contact_shape *shape, double load, double radius, double modulus);
} contact_kind;

/* The functions of a point contact are those of an ellipse, whose shape is not round. */
extern const contact_kind contact_line, contact_point, contact_ellipse;

/* The kind of this name, or NULL. */
const contact_kind *contact_kind_find(const char *name);

/* How the equations are discretised (README.md, Reynolds equation). */
typedef enum ehd_discretization {
    DISCRETIZATION_PUBLISHED, // as in Maier et al. (2015)
    DISCRETIZATION_ACCURATE,
    DISCRETIZATION_CROSS_FLUX // of stationary point contacts and ellipses
} ehd_discretization;

/* The name of a discretisation in scenes and files. */
const char *discretization_name(ehd_discretization discretization);
/* In time there are no cross fluxes: EHD_DATA. */
ehd_status discretization_check_in_time(ehd_discretization discretization, ehd_error *error);
/* Finds one by its name; false: there is none. */
bool discretization_find(ehd_discretization *discretization, const char *name);

/* What lies around the grid of a point contact (README.md, far field). */
typedef enum ehd_boundary {
    BOUNDARY_ZERO, // no pressure, and no load beyond
    BOUNDARY_OPEN  // the far field
} ehd_boundary;

/* The name of a boundary in scenes and files. */
const char *boundary_name(ehd_boundary boundary);
/* Finds one by its name; false: there is none. */
bool boundary_find(ehd_boundary *boundary, const char *name);

/* How a film that varies in time is carried through the contact (common/time/README.md). */
typedef enum ehd_transport {
    TRANSPORT_UPWIND, // by the entrainment term of the rows, at fixed places of the grid
    TRANSPORT_PATH    // along the path of the fluid
} ehd_transport;

/* The name of a transport in scenes. */
const char *transport_name(ehd_transport transport);
/* Finds one by its name; false: there is none. */
bool transport_find(ehd_transport *transport, const char *name);

/* How the films of a training are carried. */
typedef struct ehd_carriage {
    ehd_transport transport;
    double smoothing; // half widths, along the path (transient.smoothing); NaN: none, or not known
} ehd_carriage;

/* EHD_DATA naming both where one is not the other; a smoothing that is not known is any. `found_in`,
 * a file, or NULL. */
ehd_status carriage_check(const ehd_carriage *found, const char *found_in,
                          const ehd_carriage *expected, const char *expected_in, ehd_error *error);

/* Uniform grid of square cells, of an ellipse shape.cell as wide as long, the discretisation on it
 * and what lies around it. The unknowns are at `num_inner` inner nodes; boundary nodes, where the
 * pressure is zero or given, lie one step outside. All nodes are numbered together, along x first. A
 * line contact has one line of nodes: node k is at x_min + (k-1) step, the inner nodes are 1 …
 * num_inner, and num_nodes = num_inner + 2. The lines of a point contact run from y = -y_max to y_max
 * or, on a half grid, which uses the symmetry, from y = 0; beyond the first and last line is a line of
 * boundary nodes, but none at the mirror line y = 0. */
typedef struct ehd_grid {
    double x_min;       // contact half widths
    double step;        // along; grid_step_across
    size_t inner_x;     // inner nodes of a line
    size_t inner_lines; // lines of inner nodes: 1 of a line contact
    bool half;          // the first line is y = 0
    size_t num_inner;   // inner_x inner_lines
    size_t num_nodes;
    ehd_discretization discretization;
    ehd_boundary boundary; // BOUNDARY_ZERO of a line contact
    contact_shape shape;   // what X and Y are scaled by
} ehd_grid;

/* How wide and how fine a grid is, in contact half widths. */
typedef struct grid_extent {
    double x_min, x_max, step;
    double y_max; // NaN of a line contact
} grid_extent;

/* Fills the counts; with BOUNDARY_ZERO, of a round contact. */
ehd_grid grid_of(double x_min, double step, size_t inner_x, size_t inner_lines, bool half,
                 ehd_discretization discretization);
/* Another grid with the discretisation, the boundary and the shape of this one, and also half where
 * it is. */
ehd_grid grid_like(const ehd_grid *grid, double x_min, double step, size_t inner_x,
                   size_t inner_lines);

/* From line to line, in half widths across. */
double grid_step_across(const ehd_grid *grid);

double grid_x(const ehd_grid *grid, size_t node);
double grid_y(const ehd_grid *grid, size_t node); // 0 of a line contact
double grid_gap(const ehd_grid *grid, size_t node);

/* Undeformed gap, of a round contact (X^2 + Y^2)/2. */
double contact_gap(const contact_shape *shape, double x, double y);

/* X^2 + Y^2, and whether that is at most 1: a node of the dry contact. */
double grid_square_distance(const ehd_grid *grid, size_t node);
bool grid_is_dry(const ehd_grid *grid, size_t node);
/* Share of a node's cell within the dry contact, as if its edge were straight and square to the radius:
 * sums with it are integrals over the dry contact, of second order in the step. */
double grid_dry_share(const ehd_grid *grid, size_t node);

/* Number of nodes on a line, of lines, and of boundary lines before the first inner line. */
size_t grid_width(const ehd_grid *grid);
size_t grid_lines(const ehd_grid *grid);
size_t grid_first_line(const ehd_grid *grid);

/* Whether a line has inner nodes; the others are boundary. */
bool grid_is_inner_line(const ehd_grid *grid, size_t line);

/* First node of the line Y = 0. */
size_t grid_central_line(const ehd_grid *grid);

/* Each inner node has a row of the discrete Reynolds equation, numbered 0 … num_inner - 1. */
size_t grid_node_of_row(const ehd_grid *grid, size_t row);
size_t grid_row_of_node(const ehd_grid *grid, size_t node);

/* The full grid that a half grid represents, and the row of `grid` that equals a row of it by
 * symmetry. */
ehd_grid grid_whole(const ehd_grid *grid);
size_t grid_row_of_whole(const ehd_grid *grid, size_t row);

/* The exit on each line: the column (boundary nodes included) after the last positive pressure; 1
 * where there is none. */
void grid_exit_columns(
    // output:
    size_t *columns, // [grid_lines]
    // input:
    const double *pressure, // [num_nodes]
    const ehd_grid *grid);

/* X of the exits on the inner lines of the full grid, from these columns; NaN where a line has no
 * pressure. The lines of a half grid are the last ones of the full grid. */
void grid_exits(
    // output:
    double *positions, // [inner lines of grid_whole]
    // input:
    const size_t *columns, // [grid_lines]
    const ehd_grid *grid);

/* Exits that are told of a line in time. */
enum { GRID_EXITS = 8 };

/* Quadrature weight of a node in cells: on a half grid 2 off the mirror line, else 1. */
double grid_weight(const ehd_grid *grid, size_t node);
/* Length (line contact) or area (point contact) of a cell. */
double grid_cell(const ehd_grid *grid);
/* What a node's pressure adds to the load. */
double grid_load_weight(const ehd_grid *grid, size_t node);

/* Whether two grids have the same nodes, to 1e-9 of a step, discretisation and boundary. */
bool grid_same(const ehd_grid *a, const ehd_grid *b);

grid_extent grid_extent_of(const ehd_grid *grid);
/* Whether a grid has the ends and the step that are given, to 1e-9 of a step; NaN: any. Its sides
 * may lie outwards by less than a step, as grid_choose puts them. */
bool grid_has(const ehd_grid *grid, const grid_extent *given);

/* The equation that closes the system: by_approach H0 + by_load int P = value. */
typedef struct contact_closure {
    double by_approach, by_load, value;
} contact_closure;

/* Pressure and load of the inlet in front of the grid of a line contact, if it were endless. */
typedef struct inlet_tail {
    double pressure; // P at the boundary node
    double load;     // int P before the cell of the first inner node
} inlet_tail;

/* One contact in its dimensionless frame. */
typedef struct ehd_contact {
    const contact_kind *kind;
    ehd_grid grid;
    grid_extent grid_given; // what the scene says of it, NaN where nothing
    ehd_lubricant lubricant;
    double lambda;      // 1, in the Reynolds equation, eq. 7 of Maier et al. 2015
    double entrainment; // 1, U there; 1 when stationary
    double far_speed;   // 1, U of the far field: where films are carried along their paths too
    inlet_tail tail;    // of a line contact, before its grid; zero: none
    contact_closure closure;
    ehd_transport transport; // in time
    double smoothing;        // half widths, of films carried along their paths; NaN: as usual
    double time_tolerance;   // of the steps in time, by which it is then; NaN: not known
    double approach_length;  // reference half widths; 1: the half width, as in eq. 4 there
    double hertz_pressure;   // Pa
    double moes_M, moes_L;   // 1
    double alpha_p_H;        // 1
    double half_width;       // m, along the entrainment; NaN unless the scene is physical
    double radius;           // m, the same
    double load;             // N/m or N, NaN unless the scene is physical
    double speed;            // m/s, mean of the two surfaces, NaN unless the scene is physical
    double modulus;          // Pa, E', NaN unless the scene is physical
    double viscosity;        // Pa s, at zero pressure, NaN unless the scene is physical
    double slide_roll;       // (u1 - u2)/speed, NaN: traction is not asked for
    // in time what one of them has (common/time/surface.h); NULL: both are smooth
    const struct ehd_surface *surface;
} ehd_contact;

/* The scalars of a solution, in the contact's own frame. */
typedef struct contact_scalars {
    double central_film_thickness; // H at X = Y = 0, interpolated (cubic) where no node lies there
    double minimum_film_thickness; // interpolated; published: the smallest at a node
    double minimum_position;       // X of the smallest node's
    double central_pressure;
    double rigid_approach; // H0
    double exit_position;  // X at which the pressure ends, at Y = 0: within a node or at one
    double load;           // int P relative to the kind's
} contact_scalars;

/* What a contact is made from. NaN: not given. */
typedef struct contact_settings {
    const contact_kind *kind;
    lubricant_settings lubricant;
    double moes_M, moes_L; // 1; NaN: by the next five, which are otherwise not used
    double load;           // N/m of a line contact, N of a point contact
    double radius;         // m, of an ellipse along the entrainment
    double radius_across;  // m, of an ellipse; NaN: by the ellipticity
    double ellipticity;    // of an ellipse, b/a; not used with radius_across
    double speed;          // m/s, mean of the two surfaces
    double modulus;        // Pa, E' = 2/[(1-nu1^2)/E1 + (1-nu2^2)/E2]
    double viscosity;      // Pa s at zero pressure; NaN: the law's own
    double hertz_pressure; // Pa; NaN: the one that M, L and the lubricant imply
    bool approach_given;   // instead of the load
    // reference half widths; NaN: far_approach_length where the approach is given, else 1
    double approach_length;
} contact_settings;

/* What a scene may ask for, in Moes numbers or in SI units. */
#define MIN_MOES_M 0.1
#define MAX_MOES_M 1e5
#define MAX_MOES_L 100

/* 10 half widths: where the approach of a line contact is given, farther off than half of most
 * grids. */
extern const double far_approach_length;

/* A contact without grid. Returns EHD_OK, or EHD_DATA: lubricant constants, Hertz pressure beyond
 * the viscosity law's limit, viscosity that contradicts the law, SI units whose M or L is outside of
 * the bounds above. */
ehd_status contact_init(
    // output:
    ehd_contact *contact,
    // input:
    const contact_settings *given, ehd_error *error);

/* Changes M and L of a contact that keeps its lubricant and grid, for continuation. Lambda and
 * the Hertz pressure follow from them (README.md, Moes numbers). */
void contact_set_moes(ehd_contact *contact, double moes_M, double moes_L);

/* Whether its scene leaves something of the grid to what the contact needs. */
bool contact_has_chosen_grid(const ehd_contact *contact);

/* Gives such a contact another grid of its kind and discretisation, half or whole like its own, as
 * that of a model, where its scene says nothing else of it. */
void contact_take_grid(ehd_contact *contact, const ehd_grid *grid);

/* Checks the distance that a given approach is measured from. The deflection of a line contact
 * grows without bound with that distance. Below a quarter of the pressurised length the
 * compliance of the contact is not positive, and a film squeezed by a given approach would grow
 * without bound. EHD_DATA: below half the grid's length. */
ehd_status contact_check_approach(const ehd_contact *contact, ehd_error *error);

/* The closure by a given load: the load balance, eq. 9 of Maier et al. */
contact_closure contact_load_closure(const contact_kind *kind);

/* Half width across the entrainment in m, b of an ellipse. NaN unless the scene is physical. */
double contact_half_width_across(const ehd_contact *contact);

/* Film scale a^2/R in m: physical film = H * film_scale. NaN unless the scene is physical. */
double contact_film_scale(const ehd_contact *contact);

/* Time scale a/u in s: physical time = T * time_scale. NaN unless the scene is physical. */
double contact_time_scale(const ehd_contact *contact);

#endif
