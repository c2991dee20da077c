/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fullrun/earlier.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

ehd_status earlier_init(earlier_state *self, const ehd_contact *reference, ehd_error *error) {
    size_t num_nodes = reference->grid.num_nodes;
    ehd_status status = full_state_init(&self->state, &reference->grid, error);

    if (status) return status;
    self->deflection = gsl_spline_alloc(gsl_interp_cspline, num_nodes);
    self->pressure =
        reference->lubricant.density ? gsl_spline_alloc(gsl_interp_cspline, num_nodes) : NULL;
    if (self->deflection && (self->pressure || !reference->lubricant.density)) return EHD_OK;
    earlier_free(self);
    return ehd_fail(error, EHD_MEMORY, "earlier state: found no memory for %zu nodes", num_nodes);
}

void earlier_free(earlier_state *self) {
    full_state_free(&self->state);
    if (self->deflection) gsl_spline_free(self->deflection);
    if (self->pressure) gsl_spline_free(self->pressure);
    self->deflection = self->pressure = NULL;
}

void earlier_prepare(earlier_state *self, double *work, const ehd_contact *reference,
                     const double *nodes) {
    size_t num_nodes = reference->grid.num_nodes;

    // the gap is known everywhere, and what is left of the film bends little at the grid's ends
    for (size_t k = 0; k < num_nodes; k++)
        work[k] = self->state.film[k] - contact_gap(nodes[k], 0);
    gsl_spline_init(self->deflection, nodes, work, num_nodes);
    if (self->pressure) gsl_spline_init(self->pressure, nodes, self->state.pressure, num_nodes);
}

/* H0 and deflection at a place beyond the grid. */
static double deflection_beyond(const earlier_state *self, const ehd_contact *reference, double x) {
    const ehd_grid *grid = &reference->grid;
    double sum = self->state.rigid_approach;

    for (size_t k = 1; k < self->state.exit; k++)
        sum += self->state.pressure[k] *
               reference->kind->kernel(fabs(x - grid_x(grid, k)), 0, grid->step);
    return sum;
}

void earlier_mass(double *mass, const earlier_state *self, const contact_frame *now,
                  const ehd_contact *reference) {
    const ehd_grid *grid = &reference->grid;
    const density_law *law = reference->lubricant.density;
    double stretch = frame_stretch(now, &self->frame), ratio = frame_film_ratio(now, &self->frame);
    double hertz = reference->hertz_pressure * self->frame.hertz_pressure, ignored;
    double first = grid_x(grid, 0), last = grid_x(grid, grid->num_nodes - 1);
    gsl_interp_accel place = {0};

    for (size_t r = 0; r < grid->num_inner; r++) {
        double x = stretch * grid_x(grid, r + 1), density = 1, film;
        if (x >= first && x <= last) {
            film = gsl_spline_eval(self->deflection, x, &place);
            if (law)
                density = law->relative_density(
                    fmax(gsl_spline_eval(self->pressure, x, &place), 0) * hertz, &ignored);
        } else {
            film = deflection_beyond(self, reference, x);
        }
        mass[r] = density * (film + contact_gap(x, 0)) * ratio;
    }
}
