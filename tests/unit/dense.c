/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/unit/dense.h"

#include <lapacke.h>
#include <stdlib.h>
#include <string.h>

/* Influence of the film thickness on a Reynolds row: scaled derivatives with respect to the film
 * thickness at the nodes of its stencil, and the columns and lines of these nodes. */
typedef struct film_row {
    double weight[NUM_STENCIL];
    ptrdiff_t column[NUM_STENCIL], line[NUM_STENCIL];
    int count;
} film_row;

static size_t row_of(const full_system *system, size_t unknown) {
    return grid_row_of_node(system->grid, system->unknown[unknown]);
}

static void fill_film_rows(film_row *film, const full_system *system) {
    const size_t width = grid_width(system->grid);

    for (size_t i = 0; i < system->num_unknowns; i++) {
        const size_t r = row_of(system, i);
        film[i].count = 0;
        for (int a = 0; a < NUM_STENCIL; a++) {
            size_t node = system->stencils[r].node[a];
            if (node == NO_NODE) continue;
            film[i].column[film[i].count] = (ptrdiff_t)(node % width);
            film[i].line[film[i].count] = (ptrdiff_t)(node / width);
            film[i].weight[film[i].count++] = system->rows[r].by_film[a] * system->row_scale[r];
        }
    }
}

/* Fills the pressure columns of the Jacobian R_P + R_H K with the part R_H K, the influence of the
 * pressure through the deflection. The kernel K is indexed by the distance in columns and lines. */
static void fill_pressure_columns(double *matrix, const film_row *film, const full_system *system) {
    const ptrdiff_t width = (ptrdiff_t)grid_width(system->grid);
    const double *kernel = deflection_kernel(system->deflection);
    size_t size = system->num_unknowns + 1;

    for (size_t j = 0; j + 1 < size; j++) {
        const ptrdiff_t node = (ptrdiff_t)system->unknown[j];
        double *of_unknown = matrix + j * size;
        for (size_t i = 0; i + 1 < size; i++) {
            double sum = 0;
            for (int a = 0; a < film[i].count; a++)
                sum += film[i].weight[a] * kernel[labs(film[i].line[a] - node / width) * width +
                                                  labs(film[i].column[a] - node % width)];
            of_unknown[i] = sum;
        }
        of_unknown[size - 1] = system->closure_load;
    }
}

static void add_pressure_stencils(double *matrix, const full_system *system) {
    size_t size = system->num_unknowns + 1;

    for (size_t i = 0; i + 1 < size; i++) {
        const size_t r = row_of(system, i);
        for (int a = 0; a < NUM_STENCIL; a++) {
            size_t node = system->stencils[r].node[a];
            if (node == NO_NODE || system->index[node] == NO_NODE) continue;
            matrix[system->index[node] * size + i] +=
                system->rows[r].by_pressure[a] * system->row_scale[r];
        }
    }
}

/* Fills the column of the rigid approach. The approach changes the film equally at all nodes. It
 * also changes the far-field pressures at the boundary nodes. */
static void fill_approach_column(double *column, const film_row *film, const full_system *system) {
    size_t size = system->num_unknowns + 1;

    for (size_t i = 0; i + 1 < size; i++) {
        column[i] = 0;
        for (int a = 0; a < film[i].count; a++)
            column[i] += film[i].weight[a];
        const size_t r = row_of(system, i);
        for (int a = 0; a < NUM_STENCIL && system->outer; a++)
            if (system->stencils[r].node[a] != NO_NODE)
                column[i] += system->rows[r].by_pressure[a] * system->row_scale[r] *
                             system->outer->by_approach[system->stencils[r].node[a]];
    }
    column[size - 1] = system->closure_approach;
}

ehd_status dense_solve(full_system *system, double tolerance, size_t *iterations,
                       ehd_error *error) {
    size_t size = system->num_unknowns + 1;
    double *matrix = malloc(size * size * sizeof *matrix);
    double *right = malloc(size * sizeof *right);
    film_row *film = malloc(size * sizeof *film);
    lapack_int *pivots = malloc(size * sizeof *pivots);
    ehd_status status = EHD_OK;

    (void)tolerance;
    *iterations = 0;
    if (matrix && right && film && pivots) {
        fill_film_rows(film, system);
        fill_pressure_columns(matrix, film, system);
        add_pressure_stencils(matrix, system);
        fill_approach_column(matrix + (size - 1) * size, film, system);
        for (size_t i = 0; i + 1 < size; i++) {
            const size_t r = row_of(system, i);
            right[i] = -system->rows[r].residual * system->row_scale[r];
        }
        right[size - 1] = -system->closure_residual;

        if (LAPACKE_dgesv(LAPACK_COL_MAJOR, (lapack_int)size, 1, matrix, (lapack_int)size, pivots,
                          right, (lapack_int)size))
            status = ehd_fail(error, EHD_NOT_CONVERGED, "dense Jacobian: found it singular");
        memset(system->step, 0, system->grid->num_nodes * sizeof(double));
        for (size_t i = 0; i + 1 < size; i++)
            system->step[system->unknown[i]] = right[i];
        system->step_approach = right[size - 1];
    } else {
        status = ehd_fail(error, EHD_MEMORY, "dense Jacobian: found no memory for %zu rows", size);
    }
    free(matrix);
    free(right);
    free(film);
    free(pivots);
    return status;
}
