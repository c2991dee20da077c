/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A march of a reduced model, with all rows or some, for tests of transients. */
#ifndef EHD_MARCHING_H
#define EHD_MARCHING_H

#include "romrun/online/reduced_march.h"
#include "tests/unit/reduced_problem.h"

/* A line of few states with a basis and rows, as trained_few_init has them, and a point contact with an
 * open boundary: what marches of several solvers are tried with. */
typedef struct marching_trainings {
    trained line, point;
    reduced_basis bases[2], point_basis;
    size_t rows[FEW_ROWS];
} marching_trainings;
void marching_trainings_init(marching_trainings *self); // free with marching_trainings_free
void marching_trainings_free(marching_trainings *self);

/* A march with what it takes. */
typedef struct marching {
    ehd_contact reference;
    reduced_model model; // trained as the contact is carried
    film_splines splines;
    reduced_march *march;
    march_solver solver;
    march_step last;
} marching;

/* A contact on the basis' grid, started in a frame. Fails on errors; the outcome is in `last`. */
void marching_start(
    // output:
    marching *self, // free with marching_free
    // input:
    const ehd_contact *contact, const reduced_basis *of, const contact_frame *frame);
/* The same with some rows alone (as in reduced_model_build). */
void marching_start_with(marching *self, const ehd_contact *contact, const reduced_basis *of,
                         const size_t *rows, size_t num_rows, const contact_frame *frame);
void marching_free(marching *self);

/* A contact of a training's kind and grid, with L = 4, carried along the path or by the rows. */
ehd_contact marching_contact(const trained *of, double moes_M, bool along_path);

/* Every node a mode of its own; contacts that change are of the training, as far as M goes. Free with
 * reduced_basis_free. */
reduced_basis marching_nodes(const trained *of, deformation_kind kind, const double *weight);

#endif
