/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A small training in memory, for tests of bases and models. */
#ifndef EHD_TRAINED_H
#define EHD_TRAINED_H

#include "podbuild/bases.h"
#include "tests/unit/check.h"
#include <stdbool.h>

/* Number of full solutions. Each M in {8, 11, 15, 20} is combined with each L in {2, 4, 6}. The
 * lubricant is a compressible Barus fluid. */
enum { TRAINED_STATES = 12 };

typedef struct trained {
    snapshot_set set;             // exits and fields as read by podbuild
    const reduced_states *states; // states of the set; the rigid approach is the only coordinate
    double *pressure;             // [TRAINED_STATES, num_nodes]
    ehd_contact contacts[TRAINED_STATES];
    double *film; // [TRAINED_STATES, num_nodes]
    double exit_position[TRAINED_STATES];
} trained;

/* Solves the training points on -4 … 2 with the given step, to a residual of 1e-13. The test fails
 * if a point does not converge. */
void trained_init(trained *self, double step);           // free with trained_free
void trained_init_published(trained *self, double step); // in the published discretisation

/* Solves the same training points in the accurate discretisation. */
void trained_init_accurate(trained *self, double step);

/* Solves the same training points with flow that is thinned by sliding. The Eyring stress is 1e-4
 * or 2e-4 of the Hertz pressure. */
void trained_init_thinned(trained *self, double step);

/* Solves the same training points as point contacts on -2.5 … 1.5 and -2 … 2 in steps of 0.125, or
 * on the half y >= 0, with a boundary "open" or "zero". */
void trained_init_point(trained *self, bool half, const char *boundary);
void trained_free(trained *self);

/* Returns the minimum of a film, [num_nodes], interpolated between the nodes as in results. */
double trained_least_film(const double *film, const ehd_grid *grid);

/* Builds POD bases. A number of modes of 0 means as many modes as the states span. */
void trained_basis(
    // output:
    reduced_basis *basis, // free with reduced_basis_free
    // input:
    const trained *self, deformation_kind kind, size_t num_pressure, size_t num_deformation);

enum { FEW_ROWS = 40 };

/* Makes a training on 121 nodes, with an independent and a coupled basis of nine pressure modes.
 * Also selects rows (equations) for a model of either basis. The rows are unsorted and extend from
 * before the contact to behind the exits. */
void trained_few_init(trained *self, reduced_basis bases[2], size_t rows[FEW_ROWS]);
void trained_few_free(trained *self, reduced_basis bases[2]);

#endif
