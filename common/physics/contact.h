/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Defines the dimensionless contact: grid, geometry, elasticity, lubricant and operating point
 * (README.md, Equations and kinds of contact). In the comments of this folder "Maier et al." means
 * Maier, Hager, Hetzler, Seemann, Tribology International 2015.
 * Called by common/settings/scene_contact.c, which makes contacts, and by all solvers. */
#ifndef EHD_CONTACT_H
#define EHD_CONTACT_H

#include "common/physics/ellipse.h"
#include "common/physics/lubricant.h"
#include "common/program/status.h"
#include <stdbool.h>
#include <stddef.h>

/* Constants and functions that differ between line, point and elliptical contacts (README.md, kinds
 * of contact). */
typedef struct contact_kind {
    const char *name; // "line"
    int dimensions;   // dimensions of the pressurised zone: 1 or 2
    double load;      // dimensionless: pi/2 (line), 2 pi/3 (point, ellipse)
    // Deflection at the distance (x, y) from the centre of a cell with unit pressure. The cell is
    // `step` long along the entrainment and shape->cell * step wide across.
    double (*kernel)(const contact_shape *shape, double x, double y, double step);
    // speed parameter lambda of the stationary contact from M, and M from lambda
    double (*lambda)(const contact_shape *shape, double moes_M);
    double (*moes_M)(const contact_shape *shape, double lambda);
    // pressure-viscosity coefficient times Hertz pressure
    double (*alpha_p_H)(const contact_shape *shape, double moes_M, double moes_L);
    // estimate of H at the centre by a published film formula
    double (*central_film)(const contact_shape *shape, double moes_M, double moes_L);
    // gap of the dry contact on Y = 0, |x| >= 1
    double (*dry_gap)(const contact_shape *shape, double x);
    // Approach measured at the distance `length` minus the rigid approach H0, per unit of
    // (int P)/load. `half_width` is the current half width. Both lengths are in reference half
    // widths.
    double (*approach_shift)(double half_width, double length);
    // Moes number M. The load number is w/(E' R) for a line contact and w/(E' R^2) for a point
    // contact. The speed number is eta0 2 u_m/(E' R)
    double (*physical_M)(double load_number, double speed_number);
    // Half width in m from load (N/m or N), radius (m) and modulus (Pa). For a given shape the half
    // width is proportional to a power of load * radius / modulus.
    double (*half_width)(const contact_shape *shape, double load, double radius, double modulus);
} contact_kind;

/* Point contact and ellipse have the same functions. They differ only in the shape. */
extern const contact_kind contact_line, contact_point, contact_ellipse;

/* Returns the kind with this name, or NULL. */
const contact_kind *contact_kind_find(const char *name);

/* How the equations are discretised (README.md, Reynolds equation). */
typedef enum ehd_discretization {
    DISCRETIZATION_PUBLISHED, // as in Maier et al. (2015)
    DISCRETIZATION_ACCURATE,
    DISCRETIZATION_CROSS_FLUX // for stationary point contacts and ellipses only
} ehd_discretization;

/* Checks that a discretisation can be used in a transient run. Returns EHD_DATA for the
 * discretisation with cross fluxes, otherwise EHD_OK. */
ehd_status discretization_check_in_time(ehd_discretization discretization, ehd_error *error);

/* Boundary condition around the grid of a point contact (README.md, far field). */
typedef enum ehd_boundary {
    BOUNDARY_ZERO, // zero pressure, and no load beyond the grid
    BOUNDARY_OPEN  // pressure and load from the far field
} ehd_boundary;

/* How a transient solution carries its film through the contact (common/time/README.md). */
typedef enum ehd_transport {
    TRANSPORT_UPWIND, // by the entrainment term of the Reynolds equation, at fixed nodes
    TRANSPORT_PATH    // along the path of the fluid
} ehd_transport;

/* Names in scenes and files. Each list ends with NULL. */
extern const char *const discretization_names[]; // index: ehd_discretization
extern const char *const boundary_names[];       // index: ehd_boundary
extern const char *const transport_names[];      // index: ehd_transport

/* Finds the index of a name in such a list. If the list does not have the name, returns false and
 * sets the index to 0. */
bool name_find(unsigned *index, const char *const *names, const char *name);

/* How the transient solutions of a model's training carry their films through the contact. A
 * reduced model carries its films in the same way. */
typedef struct ehd_carriage {
    ehd_transport transport;
    double smoothing; // filter length (transient.smoothing), half widths; NaN: there is no filter,
                      // or its length is not known
} ehd_carriage;

/* Returns EHD_DATA if `found` and `expected` differ. A NaN smoothing agrees with any value.
 * `found_in` is the file that contains `found`, or NULL. `expected_in` names the source of
 * `expected` in the error message. */
ehd_status carriage_check(const ehd_carriage *found, const char *found_in,
                          const ehd_carriage *expected, const char *expected_in, ehd_error *error);

/* Uniform grid, with its discretisation and boundary condition. Cells are square. In an elliptical
 * contact the width of a cell in Y is shape.cell times its length in X.
 *
 * The unknowns are at `num_inner` inner nodes. Boundary nodes, where the pressure is zero or given,
 * lie one grid step outside of the inner nodes. Inner and boundary nodes are numbered together,
 * line by line, and with increasing x on each line.
 *
 * A line contact has one line of nodes. Node k is at x_min + (k-1) step, the inner nodes are 1 …
 * num_inner, and num_nodes = num_inner + 2.
 *
 * The lines of a point contact are parallel to x, at y from -y_max to y_max. The lines of a half
 * grid, which uses the symmetry, are at y from 0 (the mirror line) to y_max. A line of boundary
 * nodes lies beyond the first and the last line, but not beyond the mirror line. */
typedef struct ehd_grid {
    double x_min;       // x of the first inner node of a line, half widths
    double step;        // along x, half widths; for the step across see grid_step_across
    size_t inner_x;     // number of inner nodes in a line
    size_t inner_lines; // number of lines of inner nodes; 1 in a line contact
    bool half;          // the first line is the mirror line y = 0
    size_t num_inner;   // inner_x inner_lines
    size_t num_nodes;
    ehd_discretization discretization;
    ehd_boundary boundary; // BOUNDARY_ZERO in a line contact
    contact_shape shape;   // shape of the dry contact, whose semi-axes scale X and Y
} ehd_grid;

/* Number of inner nodes above which a grid is large. From 33 nodes a side of a point contact on,
 * multigrid takes half of the time of the factors (fullrun/README.md, Large point contacts). The
 * limit is higher, because the grids of trainings and studies have up to 129 by 65 nodes, and
 * multigrid would change the round-off of their solutions. With 10,000 nodes a time step of a line
 * contact takes 0.13 s (test_time_grid.c, grids_stay_within_bounds). */
enum { LARGE_GRID = 10000 };

/* Ends and step of a grid, in contact half widths. */
typedef struct grid_extent {
    double x_min, x_max, step;
    double y_max; // NaN for a line contact
} grid_extent;

/* Returns the grid of a line contact or a circular contact, with BOUNDARY_ZERO. Computes the
 * numbers of nodes. */
ehd_grid grid_of(double x_min, double step, size_t inner_x, size_t inner_lines, bool half,
                 ehd_discretization discretization);
/* Returns another grid with the discretisation, boundary and shape of `grid`. The result is a half
 * grid if `grid` is a half grid. */
ehd_grid grid_like(const ehd_grid *grid, double x_min, double step, size_t inner_x,
                   size_t inner_lines);

/* Returns the distance between neighbouring lines, in half widths across (b). */
double grid_step_across(const ehd_grid *grid);

double grid_x(const ehd_grid *grid, size_t node);
double grid_y(const ehd_grid *grid, size_t node); // 0 in a line contact
double grid_gap(const ehd_grid *grid, size_t node);

/* Returns the undeformed gap, which is (X^2 + Y^2)/2 for a circular contact. */
double contact_gap(const contact_shape *shape, double x, double y);

/* Return r^2 = X^2 + Y^2 of a node, and whether the node lies within the dry contact (r^2 <= 1). */
double grid_square_distance(const ehd_grid *grid, size_t node);
bool grid_is_dry(const ehd_grid *grid, size_t node);
/* Returns the fraction of a node's cell that lies within the dry contact, whose edge is taken as
 * straight and perpendicular to the radius. A sum weighted by these fractions is an integral over
 * the dry contact, accurate to second order in the step. */
double grid_dry_share(const ehd_grid *grid, size_t node);

/* Return the number of nodes on a line, the number of lines, and the number of boundary lines
 * before the first inner line. */
size_t grid_width(const ehd_grid *grid);
size_t grid_lines(const ehd_grid *grid);
size_t grid_first_line(const ehd_grid *grid);

/* Checks whether a line has inner nodes; all other lines have only boundary nodes. */
bool grid_is_inner_line(const ehd_grid *grid, size_t line);

/* Returns the first node of the line Y = 0. */
size_t grid_central_line(const ehd_grid *grid);

/* Convert between rows and nodes. Each inner node has one row of the discrete Reynolds equation.
 * Rows are numbered 0 … num_inner - 1. */
size_t grid_node_of_row(const ehd_grid *grid, size_t row);
size_t grid_row_of_node(const ehd_grid *grid, size_t node);

/* Returns the full grid that a half grid represents. */
ehd_grid grid_whole(const ehd_grid *grid);
/* Returns the row of `grid` that equals, by symmetry, a row of the full grid. */
size_t grid_row_of_whole(const ehd_grid *grid, size_t row);

/* Finds the exit on each line: the column after the last positive pressure, or 1 if no pressure is
 * positive. Column 0 is the first boundary node of the line. */
void grid_exit_columns(
    // output:
    size_t *columns, // [grid_lines]
    // input:
    const double *pressure, // [num_nodes]
    const ehd_grid *grid);

/* Converts the columns of grid_exit_columns to the positions X of the exits, on all inner lines of
 * the full grid. NaN: the line has no pressure. The lines of a half grid are the last lines of the
 * full grid. */
void grid_exits(
    // output:
    double *positions, // [inner lines of grid_whole]
    // input:
    const size_t *columns, // [grid_lines]
    const ehd_grid *grid);

/* Largest number of exits that a transient result holds for each line of nodes. */
enum { GRID_EXITS = 8 };

/* Returns the quadrature weight of a node, in units of one cell. On a half grid the weight is 2
 * except on the mirror line; otherwise it is 1. */
double grid_weight(const ehd_grid *grid, size_t node);
/* Returns the length (line contact) or area (point contact) of a cell. */
double grid_cell(const ehd_grid *grid);
/* Returns the weight of the pressure at a node in the load int P: grid_weight times grid_cell. */
double grid_load_weight(const ehd_grid *grid, size_t node);

/* Checks whether two grids have the same nodes, to 1e-9 of a step, and the same discretisation,
 * boundary and shape. */
bool grid_same(const ehd_grid *a, const ehd_grid *b);

grid_extent grid_extent_of(const ehd_grid *grid);

/* The equation that closes the system: by_approach H0 + by_load int P = value. */
typedef struct contact_closure {
    double by_approach, by_load, value;
} contact_closure;

/* Pressure and load of an endless inlet upstream of the grid of a line contact. */
typedef struct inlet_tail {
    double pressure; // P at the boundary node
    double load;     // int P upstream of the cell of the first inner node
} inlet_tail;

/* One contact, scaled by its own half width, Hertz pressure and time (README.md, Unknowns and
 * scales). */
typedef struct ehd_contact {
    const contact_kind *kind;
    ehd_grid grid;
    grid_extent grid_given; // as given in the scene; NaN: not given
    ehd_lubricant lubricant;
    double lambda;      // dimensionless, in the Reynolds equation, eq. 7 of Maier et al. 2015
    double entrainment; // U in eq. 7, dimensionless speed; 1 in a stationary contact, 0 with
                        // transport along the path, which contains the entrainment
    double far_speed;   // dimensionless, U of the far field. It stays the current U with transport
                        // along the path, where `entrainment` is 0
    inlet_tail tail;    // inlet upstream of the grid of a line contact; zeros: not included
    contact_closure closure;
    ehd_transport transport; // transport of films in time
    double smoothing;        // filter length for TRANSPORT_PATH, half widths; NaN: default
    double time_tolerance;   // error tolerance of the time steps, on which the default smoothing
                             // depends; NaN: the tolerance is not known
    // distance at which the approach is measured, in reference half widths; 1: as in eq. 4 of Maier
    // et al.
    double approach_length;
    double hertz_pressure; // Pa
    double moes_M, moes_L; // dimensionless
    double alpha_p_H;      // dimensionless
    double half_width;     // m, along the entrainment; NaN unless the scene is physical
    double radius;         // m, along the entrainment; NaN unless the scene is physical
    double load;           // N/m or N, NaN unless the scene is physical
    double speed;          // m/s, mean of the two surfaces, NaN unless the scene is physical
    double modulus;        // Pa, E', NaN unless the scene is physical
    double viscosity;      // Pa s, at zero pressure, NaN unless the scene is physical
    double slide_roll;     // (u1 - u2)/speed, NaN: no traction
    // waviness, dent or heights of one surface (common/time/surface.h); NULL: smooth surfaces
    const struct ehd_surface *surface;
} ehd_contact;

/* Scalar results of a solution, in the scales of the contact. */
typedef struct contact_scalars {
    double central_film_thickness; // H at X = Y = 0, interpolated (cubic) if no node lies there
    double minimum_film_thickness; // interpolated; at a node in the published discretisation
    double minimum_position;       // X of the node with the smallest film
    double central_pressure;
    double rigid_approach; // H0
    double exit_position;  // X at which the pressure ends, at Y = 0: between nodes or at a node
    double load;           // int P, divided by kind->load
} contact_scalars;

/* Input of contact_init. NaN: the caller does not give this value. */
typedef struct contact_settings {
    const contact_kind *kind;
    lubricant_settings lubricant;
    // dimensionless; NaN: computed from load, radius, speed, modulus and viscosity, which are not
    // used otherwise
    double moes_M, moes_L;
    double load;           // N/m for a line contact, N for a point contact
    double radius;         // m; for an ellipse the radius along the entrainment
    double radius_across;  // m, for an ellipse; NaN: from the ellipticity
    double ellipticity;    // b/a of an ellipse; not used with radius_across
    double speed;          // m/s, mean of the two surfaces
    bool surface_speeds;   // the scene gives the speeds of both surfaces in place of their mean
    double modulus;        // Pa, E' = 2/[(1-nu1^2)/E1 + (1-nu2^2)/E2]
    double viscosity;      // Pa s at zero pressure; NaN: the viscosity of the law
    double hertz_pressure; // Pa; NaN: follows from M, L and the lubricant
    bool approach_given;   // the scene gives the approach in place of the load
    // distance at which the approach is measured, in reference half widths; NaN:
    // far_approach_length if the approach is given, otherwise 1
    double approach_length;
} contact_settings;

/* Bounds of M and L of a scene, given as Moes numbers or in SI units. */
#define MIN_MOES_M 0.1
#define MAX_MOES_M 1e5
#define MAX_MOES_L 100

/* Largest relative error of the films in a trusted result, unless the user gives another accuracy
 * (romrun/calibrate/README.md, Calibration and the accuracy dial). The constant is also the largest
 * relative error of a thinned flow, and the largest part of the reference load that may be
 * neglected or missing (test_time_grid.c, ends_suit_the_smallest_M). */
extern const double default_accuracy;

/* Default distance at which a given approach is measured, in half widths. The distance must be at
 * least half the length of the grid. On most grids 10 is enough (grids.bats, "an approach is
 * measured from far enough"). */
extern const double far_approach_length;

/* Makes a contact without a grid. Returns EHD_OK, the error of lubricant_init, or EHD_DATA if
 * - the given viscosity contradicts the law,
 * - the ellipticity is out of range,
 * - a thermal conductivity is given without the other data for the inlet heating. */
ehd_status contact_init(
    // output:
    ehd_contact *contact,
    // input:
    const contact_settings *given, ehd_error *error);

/* Returns the L that belongs to M and the Hertz pressure, also if the scene gives that pressure. */
double contact_moes_L(const ehd_contact *contact);

/* Sets M and L. Lambda and the Hertz pressure follow from M and L (README.md, Moes numbers). The
 * lubricant and the grid stay the same. */
void contact_set_moes(ehd_contact *contact, double moes_M, double moes_L);

/* Checks whether the scene lacks an end or the step of the grid, so that the program chooses it. */
bool contact_has_chosen_grid(const ehd_contact *contact);

/* Replaces the grid, for example by the grid of a model, if contact_has_chosen_grid is true and the
 * new grid agrees with the ends and the step that the scene gives. Both grids must have the same
 * kind, discretisation, boundary and shape. Both must be half grids, or both full grids. Otherwise
 * the contact keeps its grid. */
void contact_take_grid(ehd_contact *contact, const ehd_grid *grid);

/* Returns EHD_DATA if the given approach of a line contact is measured at a distance below half the
 * length of the grid. At a distance below a quarter of the pressurised length the compliance of the
 * contact is not positive. A film squeezed by a given approach would then grow without bound. */
ehd_status contact_check_approach(const ehd_contact *contact, ehd_error *error);

/* Returns the closure for a given load: the load balance, eq. 9 of Maier et al. */
contact_closure contact_load_closure(const contact_kind *kind);

/* Return the half width across the entrainment in m (b of an ellipse), the film scale a^2/R in m,
 * and the time scale a/u in s. The physical film is H times the film scale, the physical time is T
 * times the time scale. All three values are NaN unless the scene is physical. */
double contact_half_width_across(const ehd_contact *contact);
double contact_film_scale(const ehd_contact *contact);
double contact_time_scale(const ehd_contact *contact);

#endif
