/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Film and pressure of earlier reduced states at any place, without anything of the size of the grid:
 * the cubic splines of all modes are made once, and a state's spline is a combination of them (splines
 * are linear in their values). What an earlier state's own exit takes away from the modes is added as
 * splines of the kernel (model.md, section 5, item 5). */
#ifndef EHD_FILM_SPLINES_H
#define EHD_FILM_SPLINES_H

#include "common/program/status.h"
#include "common/time/frame.h"
#include "romrun/reduced_model.h"
#include "romrun/reduced_solver.h"

/* Tables of values and bends (second derivatives times step^2 / 6) at nodes; read-only once made. */
typedef struct film_splines {
    ehd_grid grid; // the model's, with `margin` nodes more before it
    size_t margin;
    size_t width; // modes of the film
    double *film; // [num_nodes of grid, 2, width] coupled: deflection of the pressure modes cut at
                  // cut_exit, a node of the model
    size_t cut_exit;              // amid the trained exits
    double *kernel;               // [num_nodes of grid, 2] by distance
    double *pressure;             // [num_nodes of the model, 2, num_pressure] uncut
    const double *pressure_basis; // [num_nodes of the model, num_pressure], the caller's
} film_splines;

/* `pressure_basis` [num_nodes, num_pressure] and, independent, `deformation_basis` [num_nodes,
 * num_deformation] must outlive the splines. EHD_MEMORY, EHD_INTERNAL (LAPACK). */
ehd_status film_splines_build(
    // output:
    film_splines *splines, // free with film_splines_free
    // input:
    const reduced_model *model, const double *pressure_basis, const double *deformation_basis,
    ehd_error *error);
void film_splines_free(film_splines *splines);

enum { EXIT_WINDOW = 64 }; // nodes around an exit where the pressure's spline knows of the cut

/* An accepted state, prepared for evaluation. */
typedef struct earlier_film {
    contact_frame frame;
    double *coordinates; // [num_unknowns]
    size_t exit;
    reduced_values values;                         // at the needed nodes
    double *cut_pressure;                          // [num_band] P from band_begin on, uncut
    size_t window_begin, window_size;              // the window's nodes
    double window[EXIT_WINDOW], bend[EXIT_WINDOW]; // P there, cut; compressible only
} earlier_film;

ehd_status earlier_film_init(earlier_film *self, const reduced_model *model, ehd_error *error);
void earlier_film_free(earlier_film *self);

/* Once frame, coordinates and exit are set; the values are the caller's. */
void earlier_film_prepare(earlier_film *self, const reduced_model *model,
                          const film_splines *splines, const ehd_contact *reference);

/* rho H of up to BDF_EARLIER states, mass[num_films], at node `node` of frame `now`. */
void earlier_film_masses(double *mass, const earlier_film *const *films, size_t num_films,
                         size_t node, const contact_frame *now, const reduced_model *model,
                         const film_splines *splines, const ehd_contact *reference);

#endif
