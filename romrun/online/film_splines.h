/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Film and pressure of previous reduced states at any point, at a cost independent of the grid: the
 * cubic splines of all modes are made once, and a state's spline is a combination of them, since
 * splines are linear in their values. The deflection by the pressures that a state's own exit line
 * cuts is added as splines of the kernel. Values and curvatures are summed at a node when they are
 * first asked for, once a state (README.md, In time). */
#ifndef EHD_FILM_SPLINES_H
#define EHD_FILM_SPLINES_H

#include "common/program/status.h"
#include "common/time/frame.h"
#include "romrun/model/reduced_cut.h"
#include "romrun/online/fields.h"
#include "romrun/online/reduced_solver.h"
#include <stdbool.h>

/* Natural cubic splines of `width` functions on a grid, of a point contact tensor products: each
 * node has their values and curvatures along x (second derivatives times step^2 / 6) and, of a
 * point contact, the curvatures across of both. Distances in numbers: */
typedef struct spline_layout {
    size_t num_columns, num_lines, width;
    bool even_x, even_y;             // mirrored at the first column, line
    size_t column, line;             // from a node to the next
    size_t x_curvature, y_curvature; // from a value to its curvatures
} spline_layout;

/* Tables by node; read-only once made. They grow as the number of nodes: 90 MB for half a point
 * contact of 129 nodes a line with 120 modes. */
typedef struct film_splines {
    ehd_grid
        grid; // the model's, with `margin` nodes before it and lines at a point contact's sides
    size_t margin;
    size_t side;          // lines before the model's first one
    spline_layout layout; // of the film's modes
    double *film;         // [num_nodes of grid, 2 or 4, width] coupled: deflection of the pressure
                          // modes cut at fields.cut_exits
    spline_layout kernel_layout;
    double *kernel; // [lines, columns, 2 or 4] by distance; of a half grid twice the lines, for
                    // mirrored nodes
    spline_layout pressure_layout;
    double *pressure;   // [num_nodes of the model, 2 or 4, num_pressure] uncut
    field_modes fields; // for whole fields; coupled their deflections are the film's
} film_splines;

/* `pressure_basis` [num_nodes, num_pressure] and, independent, `deformation_basis` [num_nodes,
 * num_deformation] must outlive the splines. EHD_MEMORY. */
ehd_status film_splines_build(
    // output:
    film_splines *splines, // free with film_splines_free
    // input:
    const reduced_model *model, const double *pressure_basis, const double *deformation_basis,
    ehd_error *error);
void film_splines_free(film_splines *splines);

/* The same in a flat file, to which the tables belong when read: film_splines_flat_free. */
void film_splines_flat(flat *file, film_splines *splines, const reduced_model *model,
                       const double *pressure_basis);
void film_splines_flat_free(film_splines *splines);

struct previous_film;

/* What carrying films along the path of the fluid needs besides (common/time/README.md). The base is
 * the same at all steps, so that its film is summed over the modes once: splines of one function. */
typedef struct path_films {
    double *film,
        *pressure; // the splines' tables of the filtered modes; the second compressible only
    const struct previous_film *base; // the start, the caller's, prepared
    spline_layout base_layout, base_pressure_layout;
    double *base_film;     // [num_nodes of the splines' grid, 2 or 4] H0 and deflection
    double *base_cut;      // what of it its own exits cut
    double *base_pressure; // [num_nodes of the model, 2 or 4] uncut; compressible only
} path_films;

/* Filters the modes. Incompressible, the tables of pressure stay NULL. EHD_MEMORY. */
ehd_status path_films_init(
    // output:
    path_films *self, // free with path_films_free
    // input:
    const film_splines *splines, const reduced_model *model, double smoothing, bool compressible,
    ehd_error *error);
void path_films_free(path_films *self);

/* Sets the start, prepared with previous_film_prepare, which is the caller's. */
void path_films_set_base(path_films *self, const struct previous_film *base,
                         const reduced_model *model, const film_splines *splines);

/* Values and curvatures of a state at nodes, from those of the modes. */
typedef struct node_sums {
    const spline_layout *layout;
    const double *table, *coordinates; // of the modes
    const double *filtered;            // table of the filtered modes, along the path; else NULL
    double share;                      // of the filter, which the state's coordinates take
    double *sum;                       // [num_nodes of the layout, 2 or 4]
    size_t *of_state;                  // [num_nodes of the layout] for which state that is
    size_t state;                      // this one; counts, from 1 on
} node_sums;

enum { EXIT_WINDOW = 64 }; // nodes around an exit in which the pressure's spline is cut

/* An accepted state, prepared for evaluation. */
typedef struct previous_film {
    contact_frame frame;
    reduced_state state;
    reduced_values values;   // at the needed nodes
    double *difference;      // [num_unknowns] along the path: coordinates less those of the base
    cut_run *runs;           // [num_lines] by which its exit line differs from fields.cut_exits
    size_t num_cut;          // of their nodes
    grid_position *cut_node; // [num_cut] in the splines' grid
    double *cut_pressure;    // [num_cut] P there, uncut, with the run's sign
    node_sums film;          // deflection, with what the exits cut; without H0
    node_sums pressure;      // uncut; compressible only
    // of a line contact:
    size_t window_begin, window_size;                   // the window's nodes
    double window[EXIT_WINDOW], curvature[EXIT_WINDOW]; // P there, cut; compressible only
} previous_film;

/* Memory for a state of the model. EHD_MEMORY. */
ehd_status previous_film_init(previous_film *self, const reduced_model *model,
                              const film_splines *splines, ehd_error *error);
void previous_film_free(previous_film *self);

/* Prepares a state whose frame and state are set; its values are the caller's. */
void previous_film_prepare(previous_film *self, const reduced_model *model,
                           const film_splines *splines, const ehd_contact *reference);

/* Prepares a state for carrying it along the path with a share of the filter (frame_step_share). */
void previous_film_prepare_path(previous_film *self, const path_films *path, double share,
                                const reduced_model *model, const film_splines *splines,
                                const ehd_contact *reference);

/* What this share of the filter changes of the film of a state prepared so, at a node of its own frame. */
double path_filter_change(const previous_film *self, size_t node, const reduced_model *model,
                          const film_splines *splines);

/* rho H of up to BDF_PREVIOUS states, mass[num_films], at node `node` of frame `now`. The density
 * of a point contact is that of the uncut modes before the exit line, linear between grid lines. */
void previous_film_masses(double *mass, const previous_film *const *films, size_t num_films,
                          size_t node, const contact_frame *now, const reduced_model *model,
                          const film_splines *splines, const ehd_contact *reference);

/* H of a state at a node of its own frame, and P there, uncut. */
double previous_film_thickness(const previous_film *self, size_t node, const reduced_model *model,
                               const film_splines *splines);
double previous_film_pressure(const previous_film *self, size_t node, const reduced_model *model,
                              const film_splines *splines);

/* rho H along the path, to the places of frame `now`: films prepared for it,
 * at fixed places what they have in common with the base, where the fluid was all else. */
void path_film_masses(double *mass, const previous_film *const *films, size_t num_films,
                      size_t node, const contact_frame *now, const reduced_model *model,
                      const film_splines *splines, const path_films *path,
                      const ehd_contact *reference);

/* Film and density of the base at a node of its own frame. */
void path_base_at(double *film, double *density, const path_films *path, size_t node,
                  const reduced_model *model, const film_splines *splines,
                  const ehd_contact *reference);

#endif
