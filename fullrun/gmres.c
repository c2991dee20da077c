/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The linear systems of Newton: the exact Jacobian by rows and FFT, preconditioned by UMFPACK on a
 * sparse Jacobian in which the kernel is its shifted near field (model.md, section 3).
 *
 * The sparse Jacobian is a band B, bordered by the column c of H0 and the row that closes it. Only the
 * band is factorised, for with a full row in it UMFPACK's analysis takes O(n^2); the border follows
 * from w = B^-1 c. The shifted near field is positive definite (even, convex, falling to zero), which
 * keeps the band away from singular. */
#include "fullrun/gmres.h"

#include <cblas.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <umfpack.h>

enum { MOST_ITERATIONS = 80 };

struct gmres_workspace {
    size_t size;      // most unknowns
    double *krylov;   // [MOST_ITERATIONS + 1, size]
    double *vector;   // [size]
    double *spread;   // [size + 1] a vector on all grid nodes
    double *response; // [size + 1] its deflection
    double *approach; // [size] c, the column of H0
    double *border;   // [size] w = B^-1 c
    double border_pivot;
    // B by rows, which UMFPACK sees as the columns of the transpose
    int *row_start; // [size + 1]
    int *column;    // [capacity]
    double *value;  // [capacity]
    double *window; // [2 near_field + NUM_STENCIL] a row's values by node
    size_t capacity;
    double *solve_work; // [5 size]
    int *solve_index;   // [size]
};

gmres_workspace *gmres_workspace_free(gmres_workspace *self) {
    if (self) {
        free(self->krylov);
        free(self->vector);
        free(self->spread);
        free(self->response);
        free(self->approach);
        free(self->border);
        free(self->row_start);
        free(self->column);
        free(self->value);
        free(self->window);
        free(self->solve_work);
        free(self->solve_index);
        free(self);
    }
    return NULL;
}

gmres_workspace *gmres_workspace_create(const ehd_grid *grid, size_t near_field) {
    gmres_workspace *self = calloc(1, sizeof *self);
    if (!self) return NULL;
    size_t size = self->size = grid->num_inner + 1;
    // a row holds its stencil widened by the near field
    self->capacity = size * (2 * near_field + NUM_STENCIL);
    self->krylov = malloc((MOST_ITERATIONS + 1) * size * sizeof(double));
    self->vector = malloc(size * sizeof(double));
    self->spread = calloc(size + 1, sizeof(double));
    self->response = malloc((size + 1) * sizeof(double));
    self->approach = malloc(size * sizeof(double));
    self->border = malloc(size * sizeof(double));
    self->row_start = malloc((size + 1) * sizeof(int));
    self->column = malloc(self->capacity * sizeof(int));
    self->value = malloc(self->capacity * sizeof(double));
    self->window = malloc((2 * near_field + NUM_STENCIL) * sizeof(double));
    self->solve_work = malloc(5 * size * sizeof(double));
    self->solve_index = malloc(size * sizeof(int));
    if (!self->krylov || !self->vector || !self->spread || !self->response || !self->approach ||
        !self->border || !self->row_start || !self->column || !self->value || !self->window ||
        !self->solve_work || !self->solve_index)
        return gmres_workspace_free(self);
    return self;
}

/* y = J x on the passive unknowns, exact: rows and one FFT convolution. */
static void apply_jacobian(double *y, const double *x, full_system *system) {
    gmres_workspace *work = system->workspace;
    size_t num_passive = system->num_unknowns;
    double sum = 0;

    memset(work->spread, 0, system->grid->num_nodes * sizeof(double));
    for (size_t i = 0; i < num_passive; i++)
        work->spread[system->unknown[i]] = x[i];
    deflection_apply(work->response, system->deflection, work->spread);
    for (size_t i = 0; i < num_passive; i++) {
        const reynolds_row *row = &system->rows[system->unknown[i] - 1];
        const reynolds_stencil *stencil = &system->stencils[system->unknown[i] - 1];
        double product = 0;
        for (int a = 0; a < NUM_STENCIL; a++) {
            size_t node = stencil->node[a];
            if (node == NO_NODE) continue;
            product += row->by_pressure[a] * work->spread[node] +
                       row->by_film[a] * (work->response[node] + x[num_passive]);
        }
        y[i] = product * system->row_scale[system->unknown[i] - 1];
        sum += x[i];
    }
    y[num_passive] = system->closure_approach * x[num_passive] + system->closure_load * sum;
}

/* The band's row of a node, stencil and near field, and of the column of H0. Returns the band's entries. */
static int fill_near_row(int *column, double *value, double *approach, const full_system *system,
                         size_t row_node) {
    const reynolds_row *row = &system->rows[row_node - 1];
    const reynolds_stencil *stencil = &system->stencils[row_node - 1];
    const double *kernel = deflection_kernel(system->deflection);
    const ptrdiff_t m = (ptrdiff_t)system->near_field;
    const ptrdiff_t num_inner = (ptrdiff_t)system->grid->num_inner;
    const double far = kernel[system->near_field + 1];
    ptrdiff_t here = (ptrdiff_t)row_node;
    ptrdiff_t first = here - 2 - m < 1 ? 1 : here - 2 - m;
    ptrdiff_t last = here + 1 + m > num_inner ? num_inner : here + 1 + m;
    double *window = ((gmres_workspace *)system->workspace)->window; // by node
    int count = 0;
    double scale = system->row_scale[row_node - 1];

    *approach = 0;
    memset(window, 0, (size_t)(last - first + 1) * sizeof *window);
    for (int a = 0; a < NUM_STENCIL; a++) {
        ptrdiff_t node = (ptrdiff_t)stencil->node[a];
        if (stencil->node[a] == NO_NODE) continue;
        ptrdiff_t low = node - m < first ? first : node - m;
        ptrdiff_t high = node + m > last ? last : node + m;
        double by_film = row->by_film[a] * scale;
        for (ptrdiff_t j = low; j <= high; j++)
            window[j - first] += by_film * (kernel[labs(j - node)] - far);
        if (node >= 1 && node <= num_inner) window[node - first] += row->by_pressure[a] * scale;
        *approach += by_film;
    }
    for (ptrdiff_t node = first; node <= last; node++) {
        if (system->place[node] == NO_NODE) continue;
        column[count] = (int)system->place[node];
        value[count++] = window[node - first];
    }
    return count;
}

static void assemble_near_field(full_system *system) {
    gmres_workspace *work = system->workspace;
    size_t num_passive = system->num_unknowns;
    int count = 0;

    for (size_t i = 0; i < num_passive; i++) {
        work->row_start[i] = count;
        count += fill_near_row(work->column + count, work->value + count, work->approach + i,
                               system, system->unknown[i]);
    }
    work->row_start[num_passive] = count;
}

/* Factors of the band; NULL when singular or out of memory. */
static void *factorise(const full_system *system, double *control) {
    const gmres_workspace *work = system->workspace;
    int size = (int)system->num_unknowns;
    void *symbolic = NULL, *numeric = NULL;

    umfpack_di_defaults(control);
    // the natural order of a band has the least fill, and a preconditioner can do with weak pivoting,
    // which keeps it
    control[UMFPACK_STRATEGY] = UMFPACK_STRATEGY_SYMMETRIC;
    control[UMFPACK_ORDERING] = UMFPACK_ORDERING_NONE;
    control[UMFPACK_PIVOT_TOLERANCE] = 1e-3;
    control[UMFPACK_IRSTEP] = 0;
    if (umfpack_di_symbolic(size, size, work->row_start, work->column, work->value, &symbolic,
                            control, NULL) == UMFPACK_OK) {
        if (umfpack_di_numeric(work->row_start, work->column, work->value, symbolic, &numeric,
                               control, NULL) != UMFPACK_OK)
            umfpack_di_free_numeric(&numeric);
        umfpack_di_free_symbolic(&symbolic);
    }
    return numeric;
}

/* y = B^-1 x on the passive rows; false when UMFPACK cannot. */
static bool solve_band(double *y, const double *x, gmres_workspace *work, void *numeric,
                       const double *control) {
    // the rows were stored, so UMFPACK's matrix is the transpose
    return umfpack_di_wsolve(UMFPACK_Aat, work->row_start, work->column, work->value, y, x, numeric,
                             control, NULL, work->solve_index, work->solve_work) == UMFPACK_OK;
}

/* w = B^-1 c and what the closure makes of it; false when singular. */
static bool solve_border(const full_system *system, void *numeric, const double *control) {
    gmres_workspace *work = system->workspace;

    if (!solve_band(work->border, work->approach, work, numeric, control)) return false;
    double sum = 0;
    for (size_t i = 0; i < system->num_unknowns; i++)
        sum += work->border[i];
    work->border_pivot = system->closure_load * sum - system->closure_approach;
    return isfinite(work->border_pivot) && work->border_pivot != 0;
}

/* y = [B c; closure]^-1 x. */
static void precondition(double *y, const double *x, const full_system *system, void *numeric,
                         const double *control) {
    gmres_workspace *work = system->workspace;
    size_t num_passive = system->num_unknowns;
    double sum = 0;

    solve_band(y, x, work, numeric, control);
    for (size_t r = 0; r < num_passive; r++)
        sum += y[r];
    double approach = (system->closure_load * sum - x[num_passive]) / work->border_pivot;
    for (size_t r = 0; r < num_passive; r++)
        y[r] -= approach * work->border[r];
    y[num_passive] = approach;
}

/* The small least-squares problem of GMRES, kept triangular by Givens rotations. */
typedef struct hessenberg {
    double column[MOST_ITERATIONS][MOST_ITERATIONS + 1]; // column[k] holds R's column k
    double cosine[MOST_ITERATIONS], sine[MOST_ITERATIONS];
    double right[MOST_ITERATIONS + 1];
} hessenberg;

static void hessenberg_rotate(hessenberg *h, size_t k) {
    double *column = h->column[k];

    for (size_t i = 0; i < k; i++) {
        double upper = h->cosine[i] * column[i] + h->sine[i] * column[i + 1];
        column[i + 1] = -h->sine[i] * column[i] + h->cosine[i] * column[i + 1];
        column[i] = upper;
    }
    double length = hypot(column[k], column[k + 1]);
    h->cosine[k] = length > 0 ? column[k] / length : 1;
    h->sine[k] = length > 0 ? column[k + 1] / length : 0;
    column[k] = length;
    h->right[k + 1] = -h->sine[k] * h->right[k];
    h->right[k] *= h->cosine[k];
}

/* Orthogonalises against the basis built so far (modified Gram-Schmidt) and appends. */
static void extend_krylov(gmres_workspace *work, hessenberg *h, size_t k, size_t size) {
    double *fresh = work->krylov + (k + 1) * work->size;

    for (size_t i = 0; i <= k; i++) {
        const double *old = work->krylov + i * work->size;
        h->column[k][i] = cblas_ddot((int)size, fresh, 1, old, 1);
        cblas_daxpy((int)size, -h->column[k][i], old, 1, fresh, 1);
    }
    h->column[k][k + 1] = cblas_dnrm2((int)size, fresh, 1);
    if (h->column[k][k + 1] > 0) cblas_dscal((int)size, 1 / h->column[k][k + 1], fresh, 1);
}

ehd_status full_solve_gmres(full_system *system, double tolerance, size_t *iterations,
                            ehd_error *error) {
    gmres_workspace *work = system->workspace;
    size_t num_passive = system->num_unknowns, size = num_passive + 1, k = 0;
    double control[UMFPACK_CONTROL];
    hessenberg h;

    assemble_near_field(system);
    void *numeric = factorise(system, control);
    if (!numeric || !solve_border(system, numeric, control)) {
        umfpack_di_free_numeric(&numeric);
        return ehd_fail(error, EHD_NOT_CONVERGED, "near-field Jacobian: found it singular");
    }

    // right preconditioning, so that the monitored residual is the true one
    double *first = work->krylov;
    for (size_t i = 0; i < num_passive; i++)
        first[i] = -system->rows[system->unknown[i] - 1].residual *
                   system->row_scale[system->unknown[i] - 1];
    first[num_passive] = -system->closure_residual;
    double start = cblas_dnrm2((int)size, first, 1);
    if (start > 0) cblas_dscal((int)size, 1 / start, first, 1);
    h.right[0] = start;
    while (k < MOST_ITERATIONS && fabs(h.right[k]) > tolerance * start) {
        precondition(work->vector, work->krylov + k * work->size, system, numeric, control);
        apply_jacobian(work->krylov + (k + 1) * work->size, work->vector, system);
        extend_krylov(work, &h, k, size);
        hessenberg_rotate(&h, k);
        k++;
    }
    *iterations = k;

    // back substitution, then dz = M^-1 (V y)
    for (size_t i = k; i-- > 0;) {
        for (size_t j = i + 1; j < k; j++)
            h.right[i] -= h.column[j][i] * h.right[j];
        h.right[i] = h.column[i][i] != 0 ? h.right[i] / h.column[i][i] : 0;
    }
    memset(work->response, 0, size * sizeof(double));
    for (size_t i = 0; i < k; i++)
        cblas_daxpy((int)size, h.right[i], work->krylov + i * work->size, 1, work->response, 1);
    precondition(work->vector, work->response, system, numeric, control);
    umfpack_di_free_numeric(&numeric);

    memset(system->step, 0, system->grid->num_nodes * sizeof(double));
    for (size_t i = 0; i < num_passive; i++)
        system->step[system->unknown[i]] = work->vector[i];
    system->step_approach = work->vector[num_passive];
    return EHD_OK;
}
