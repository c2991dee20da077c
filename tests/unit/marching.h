/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Time marches of a reduced model, with all rows (equations) or with some rows, for tests of
 * transient contacts. */
#ifndef EHD_MARCHING_H
#define EHD_MARCHING_H

#include "romrun/online/reduced_march.h"
#include "tests/unit/reduced_problem.h"

/* Trained problems for tests of marches: a line contact with few states, its bases and rows
 * (trained_few_init), and a point contact with an open boundary. */
typedef struct marching_trainings {
    trained line, point;
    reduced_basis bases[2], point_basis;
    size_t rows[FEW_ROWS];
} marching_trainings;
void marching_trainings_init(marching_trainings *self); // free with marching_trainings_free
void marching_trainings_free(marching_trainings *self);

/* A march with its contact and model. */
typedef struct marching {
    ehd_contact reference;
    reduced_model model; // trained with the same transport setting as the contact
    film_splines splines;
    reduced_march *march;
    march_solver solver;
    march_step last;
} marching;

/* Starts the march of a contact in a frame, on the grid of the basis. The test fails on errors. The
 * status of the start is in `last`. */
void marching_start(
    // output:
    marching *self, // free with marching_free
    // input:
    const ehd_contact *contact, const reduced_basis *of, const contact_frame *frame);
/* Starts like marching_start, but with some of the rows (as in reduced_model_build). */
void marching_start_with(marching *self, const ehd_contact *contact, const reduced_basis *of,
                         const size_t *rows, size_t num_rows, const contact_frame *frame);
void marching_free(marching *self);

/* Returns a contact with the kind and grid of a training, L = 4, and transport along the path or
 * upwind. */
ehd_contact marching_contact(const trained *of, double moes_M, bool along_path);

/* Returns a basis with one mode for each node. The trained range of this basis includes transient
 * contacts up to the largest M of the training. Free it with reduced_basis_free. */
reduced_basis marching_nodes(const trained *of, deformation_kind kind, const double *weight);

#endif
