/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/unit/dense.h"

#include <lapacke.h>
#include <stdlib.h>
#include <string.h>

/* A row's influence through the film, scaled, its stencil's gap filled with a zero. */
typedef struct film_row {
    double weight[NUM_STENCIL];
    size_t node[NUM_STENCIL];
} film_row;

static void fill_film_rows(film_row *film, const full_system *system) {
    for (size_t r = 0; r < system->num_unknowns; r++)
        for (int a = 0; a < NUM_STENCIL; a++) {
            size_t node = system->stencils[r].node[a];
            film[r].weight[a] =
                node == NO_NODE ? 0 : system->rows[r].by_film[a] * system->row_scale[r];
            film[r].node[a] = node == NO_NODE ? 0 : node;
        }
}

/* The kernel at offsets -(num_nodes-1) … num_nodes-1; `centre` is offset 0. */
static void mirror_kernel(double *centre, const full_system *system) {
    const double *kernel = deflection_kernel(system->deflection);

    for (ptrdiff_t d = 0; d < (ptrdiff_t)system->grid->num_nodes; d++)
        centre[d] = centre[-d] = kernel[d];
}

/* Columns of pressure: J = R_P + R_H K, where K is Toeplitz, so that its column is a shifted kernel. */
static void fill_pressure_columns(double *matrix, const film_row *film, const double *centre,
                                  double closure_load, size_t size) {
    for (size_t j = 0; j + 1 < size; j++) {
        double *column = matrix + j * size;
        const double *influence = centre - (j + 1); // of node j + 1 on a node
        for (size_t r = 0; r + 1 < size; r++) {
            double sum = 0;
            for (int a = 0; a < NUM_STENCIL; a++)
                sum += film[r].weight[a] * influence[film[r].node[a]];
            column[r] = sum;
        }
        column[size - 1] = closure_load;
    }
}

static void add_pressure_stencils(double *matrix, const full_system *system) {
    size_t size = system->num_unknowns + 1;

    for (size_t r = 0; r + 1 < size; r++)
        for (int a = 0; a < NUM_STENCIL; a++) {
            size_t node = system->stencils[r].node[a];
            if (node == NO_NODE || node == 0 || node >= system->num_unknowns + 1) continue;
            matrix[(node - 1) * size + r] += system->rows[r].by_pressure[a] * system->row_scale[r];
        }
}

/* Column of the rigid approach, which moves every film alike. */
static void fill_approach_column(double *column, const film_row *film, const full_system *system) {
    size_t size = system->num_unknowns + 1;

    for (size_t r = 0; r + 1 < size; r++) {
        column[r] = 0;
        for (int a = 0; a < NUM_STENCIL; a++)
            column[r] += film[r].weight[a];
    }
    column[size - 1] = system->closure_approach;
}

ehd_status dense_solve(full_system *system, double tolerance, size_t *iterations,
                       ehd_error *error) {
    size_t size = system->num_unknowns + 1, num_nodes = system->grid->num_nodes;
    double *matrix = malloc(size * size * sizeof *matrix);
    double *right = malloc(size * sizeof *right);
    double *kernel = malloc((2 * num_nodes - 1) * sizeof *kernel);
    film_row *film = malloc(size * sizeof *film);
    lapack_int *pivots = malloc(size * sizeof *pivots);
    ehd_status status = EHD_OK;

    (void)tolerance;
    *iterations = 0;
    if (matrix && right && kernel && film && pivots) {
        double *centre = kernel + num_nodes - 1;
        fill_film_rows(film, system);
        mirror_kernel(centre, system);
        fill_pressure_columns(matrix, film, centre, system->closure_load, size);
        add_pressure_stencils(matrix, system);
        fill_approach_column(matrix + (size - 1) * size, film, system);
        for (size_t r = 0; r + 1 < size; r++)
            right[r] = -system->rows[r].residual * system->row_scale[r];
        right[size - 1] = -system->closure_residual;

        if (LAPACKE_dgesv(LAPACK_COL_MAJOR, (lapack_int)size, 1, matrix, (lapack_int)size, pivots,
                          right, (lapack_int)size))
            status = ehd_fail(error, EHD_NOT_CONVERGED, "dense Jacobian: found it singular");
        memset(system->step, 0, num_nodes * sizeof(double));
        memcpy(system->step + 1, right, (size - 1) * sizeof(double));
        system->step_approach = right[size - 1];
    } else {
        status = ehd_fail(error, EHD_MEMORY, "dense Jacobian: found no memory for %zu rows", size);
    }
    free(matrix);
    free(right);
    free(kernel);
    free(film);
    free(pivots);
    return status;
}
