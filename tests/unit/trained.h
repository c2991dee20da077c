/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A small training, kept in memory, for tests of what is made of it. */
#ifndef EHD_TRAINED_H
#define EHD_TRAINED_H

#include "podbuild/bases.h"
#include "tests/unit/check.h"
#include <stdbool.h>

/* Full solutions over M in {8, 11, 15, 20} times L in {2, 4, 6} with a compressible Barus
 * lubricant. */
enum { TRAINED_STATES = 12 };

typedef struct trained {
    snapshot_set set; // exits and fields as podbuild would read them
    ehd_contact contacts[TRAINED_STATES];
    double *film; // [TRAINED_STATES, num_nodes]
    double exit_position[TRAINED_STATES];
} trained;

/* Solves the points on -4 … 2 with the given step to a residual of 1e-13; the test fails when one
 * does not converge. */
void trained_init(trained *self, double step);           // free with trained_free
void trained_init_published(trained *self, double step); // the same with the published rows

/* The same with the accurate rows. */
void trained_init_accurate(trained *self, double step);

/* The same of flows that the sliding thins, where its least stress is a hundredth of the Hertz pressure. */
void trained_init_thinned(trained *self, double step);

/* The same points of a point contact on -2.5 … 1.5 and -2 … 2 in steps of 0.125, or on the half y
 * >= 0, with a boundary "open" or "zero". */
void trained_init_point(trained *self, bool half, const char *boundary);
void trained_free(trained *self);

/* The smallest film between the nodes of a grid, as results give it; [num_nodes]. */
double trained_least_film(const double *film, const ehd_grid *grid);

/* POD bases; sizes 0 stand for as many modes as the states span. */
void trained_basis(
    // output:
    reduced_basis *basis, // free with reduced_basis_free
    // input:
    const trained *self, deformation_kind kind, size_t num_pressure, size_t num_deformation);

enum { FEW_ROWS = 40 };

/* A training on 121 nodes, independent and coupled bases with nine pressure modes, and rows for a
 * model of either, in no order, from before the contact to behind the exits. */
void trained_few_init(trained *self, reduced_basis bases[2], size_t rows[FEW_ROWS]);
void trained_few_free(trained *self, reduced_basis bases[2]);

#endif
