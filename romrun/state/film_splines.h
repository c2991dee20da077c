/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes film and pressure of previous reduced states at any point, at a cost independent of the
 * grid (romrun/online/README.md, In time). Cubic splines of all modes are made once. The spline of
 * a state is their sum, weighted by the coordinates of the state. The splines hold for modes that
 * are cut at cut_exits (fields.h). Splines of the kernel therefore add the deflection that the
 * pressures between cut_exits and the exit line of the state cause. Called by romrun/online for
 * each time step, and by snapgen/residuals.c. */
#ifndef EHD_FILM_SPLINES_H
#define EHD_FILM_SPLINES_H

#include "common/program/status.h"
#include "common/time/frame.h"
#include "romrun/model/reduced_cut.h"
#include "romrun/state/fields.h"
#include "romrun/state/reduced_state.h"
#include <stdbool.h>

/* Layout of a table of natural cubic splines of `width` functions on a grid. For a point contact
 * the splines are tensor products. At each node the table has the values and their curvatures along
 * x (second derivatives times step^2 / 6). For a point contact it also has the curvatures along y,
 * of the values and of their curvatures along x. All distances are numbers of doubles in the
 * table. */
typedef struct spline_layout {
    size_t num_columns, num_lines, width;
    bool even_x, even_y;             // mirrored at the first column (even_x) or line (even_y)
    size_t column, line;             // distances to the next column and to the next line
    size_t x_curvature, y_curvature; // distances from a value to its curvatures along x and y
} spline_layout;

/* Tables by node, which do not change after they are made. The memory grows with the number of
 * nodes: 90 MB for a half grid of a point contact, with 129 nodes on a grid line and 120 modes. */
typedef struct film_splines {
    ehd_grid grid; // the model's grid, widened before the inlet (`margin` columns) and at the sides
    size_t margin;
    size_t side;          // number of lines before the model's first line
    spline_layout layout; // layout of `film`
    double *film;         // [num_nodes of grid, 2 or 4, width] coupled: deflection of the pressure
                          // modes cut at fields.cut_exits
    spline_layout kernel_layout;
    double *kernel; // [lines, columns, 2 or 4] by distance; twice the lines for mirrored half grids
    spline_layout pressure_layout;
    double *pressure;   // [num_nodes of the model, 2 or 4, num_pressure] not cut at an exit
    field_modes fields; // modes on the whole grid; coupled: their deflections are in `film`
    arena memory;       // memory of the tables, unless a flat file owns them
} film_splines;

/* Builds the tables. `pressure_basis` [num_nodes, num_pressure] and, for an independent basis,
 * `deformation_basis` [num_nodes, num_deformation] must outlive the splines. Errors: EHD_MEMORY. */
ehd_status film_splines_build(
    // output:
    film_splines *splines, // free with film_splines_free
    // input:
    const reduced_model *model, const double *pressure_basis, const double *deformation_basis,
    ehd_error *error);
void film_splines_free(film_splines *splines);

/* Writes the tables to a flat file, or reads them from it. The file owns the tables that were read:
 * it must outlive these splines. Free them with film_splines_free, too. */
void film_splines_flat(flat *file, film_splines *splines, const reduced_model *model,
                       const double *pressure_basis);

struct previous_film;

/* Data that all states of a march share. For transport along the path of the fluid
 * (common/time/README.md, Along the path) it also holds the filtered modes and the base, which is
 * the initial state of a run. Only the differences between the states and the base are carried
 * along the path. The base is the same in all time steps, so its film is summed over the modes only
 * once. */
typedef struct film_carrier {
    const reduced_model *model;
    const film_splines *splines;
    const ehd_contact *reference;
    // for transport along the path:
    double *film, *pressure;          // filtered modes; `pressure` is NULL if incompressible
    const struct previous_film *base; // the base, owned by the caller
    spline_layout base_layout, base_pressure_layout;
    double *base_film;     // [num_nodes of the splines' grid, 2 or 4] H0 and deflection
    double *base_cut;      // part of base_film: deflection by the pressures between
                           // fields.cut_exits and the exits of the base
    double *base_pressure; // [num_nodes of the model, 2 or 4] sum of the pressure modes, not cut at
                           // the exit; only for compressible lubricants
    arena memory;
} film_carrier;

/* Stores the inputs, which must outlive the carrier. With transport along the path, makes the
 * tables of the filtered modes. Errors: EHD_MEMORY; EHD_DATA: the filter is too many grid steps
 * long. */
ehd_status film_carrier_init(
    // output:
    film_carrier *self, // free with film_carrier_free
    // input:
    const reduced_model *model, const film_splines *splines, const ehd_contact *reference,
    ehd_error *error);
void film_carrier_free(film_carrier *self);

/* Prepares a state as the base. The caller has set `frame` and `state`, and owns the base. */
void film_carrier_set_base(film_carrier *self, struct previous_film *base);

/* Computes film and density of the base at a node of its own frame. */
void film_carrier_base_at(double *film, double *density, const film_carrier *self, size_t node);

/* Values and curvatures of the film or the pressure of a state at nodes. They are sums over the
 * modes, which are computed when first needed. */
typedef struct node_sums {
    const spline_layout *layout;
    const double *table, *coordinates; // table of the modes, and the state's coordinates
    const double *filtered;            // filtered modes; NULL: no transport along the path
    double share;                      // weight of the filtered table, 0 to 1
    double *sum;                       // [num_nodes of the layout, 2 or 4]
    size_t *of_state;                  // [num_nodes of the layout] number of the state whose sum is
                                       // stored; 0: no sum is stored
    size_t state;                      // number of the present state, from 1 on
} node_sums;

/* Number of nodes in the window around the exit of a line contact. In the window the pressure,
 * which is zero from the exit on, has a spline of its own. */
enum { EXIT_WINDOW = 64 };

/* A state of a transient run, prepared for evaluation at any point. */
typedef struct previous_film {
    const film_carrier *carrier;
    contact_frame frame;
    reduced_state state;
    reduced_values values;   // values at the needed nodes
    bool along_path;         // prepared for transport along the path
    double *difference;      // [num_unknowns] deviation from the base, for transport along the path
    cut_run *runs;           // [num_lines] runs between fields.cut_exits and the state's exit line
    size_t num_cut;          // number of nodes in the runs
    grid_position *cut_node; // [num_cut] nodes of the runs, in the grid of the splines
    double *cut_pressure;    // [num_cut] sum of the modes at these nodes, times the sign of the run
    node_sums film;          // deflection by the pressures before the state's own exits, without H0
    node_sums pressure;      // P, not set to zero behind the exit; only for compressible lubricants
    // line contacts only:
    size_t window_begin, window_size;                   // first node and size of the window
    double window[EXIT_WINDOW], curvature[EXIT_WINDOW]; // P, 0 behind exits; only if compressible
    arena memory; // memory of the arrays except the arrays in `state` and `values`
} previous_film;

/* Allocates the arrays for a state of the carrier's model. The carrier must outlive the state.
 * Errors: EHD_MEMORY. */
ehd_status previous_film_init(previous_film *self, const film_carrier *carrier, ehd_error *error);
void previous_film_free(previous_film *self);

/* Prepares a state for evaluation. The caller has already set `frame` and `state`. The caller also
 * sets `values`, before or after this call. */
void previous_film_prepare(previous_film *self);

/* Prepares a state for evaluation with transport along the path. The filter of the carrier changes
 * the difference between the state and the base. Of this change, the fraction `share` from 0 to 1
 * is applied (frame_step_share). */
void previous_film_prepare_path(previous_film *self, double share);

/* Returns the change of the film, at a node of the state's own frame, that the fraction `share` of
 * the filter causes. The state must have been prepared by previous_film_prepare_path. */
double previous_film_filter_change(const previous_film *self, size_t node);

/* Returns rho H of a state, carried to a node of frame `now`. If the state was prepared by
 * previous_film_prepare_path, the film of the base is evaluated at the node. The difference from
 * the base is evaluated at the place where the fluid was at the time of the state. For the density
 * of a point contact, P is the sum of the modes before the exit line, and zero behind it. The exit
 * line is straight between grid lines. */
double previous_film_mass(const previous_film *self, size_t node, const contact_frame *now);

/* Return H and P of a state at a node of its own frame. P is not set to zero behind the exit. */
double previous_film_thickness(const previous_film *self, size_t node);
double previous_film_pressure(const previous_film *self, size_t node);

#endif
