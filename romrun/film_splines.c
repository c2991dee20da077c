/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/film_splines.h"

#include "common/physics/deflection.h"
#include "common/time/bdf.h"

#include <cblas.h>
#include <lapacke.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- bends of natural cubic splines

/* Solves bend[k-1] + 4 bend[k] + bend[k+1] = second difference of the values, for `width` splines at
 * once; the first and last bends are given in `bends` (zero: natural). `diagonal` is work of
 * [2, num - 2]. Returns what dptsv does. */
static lapack_int solve_bends(double *bends, double *diagonal, const double *values, size_t num,
                              size_t width) {
    size_t inner = num - 2;

    for (size_t k = 0; k < inner; k++) {
        diagonal[k] = 4;
        diagonal[inner + k] = 1;
    }
    for (size_t k = 1; k <= inner; k++)
        for (size_t j = 0; j < width; j++)
            bends[k * width + j] = values[(k - 1) * width + j] - 2 * values[k * width + j] +
                                   values[(k + 1) * width + j];
    for (size_t j = 0; j < width; j++) {
        bends[width + j] -= bends[j];
        bends[inner * width + j] -= bends[(inner + 1) * width + j];
    }
    if (width == 1) // without a copy to turn it
        return LAPACKE_dptsv(LAPACK_COL_MAJOR, (lapack_int)inner, 1, diagonal, diagonal + inner,
                             bends + 1, (lapack_int)inner);
    return LAPACKE_dptsv(LAPACK_ROW_MAJOR, (lapack_int)inner, (lapack_int)width, diagonal,
                         diagonal + inner, bends + width, (lapack_int)width);
}

/* Values and bends of `width` splines as one table [num, 2, width]. */
static ehd_status make_table(double **table, const double *values, size_t num, size_t width,
                             ehd_error *error) {
    double *diagonal = malloc(2 * num * sizeof *diagonal);
    double *bends = calloc(num * width, sizeof *bends);
    ehd_status status = EHD_OK;

    *table = malloc(num * 2 * width * sizeof **table);
    if (!*table || !bends || !diagonal)
        status = ehd_fail(error, EHD_MEMORY, "splines: found no memory for %zu modes", width);
    else if (solve_bends(bends, diagonal, values, num, width))
        status = ehd_fail(error, EHD_INTERNAL, "splines: dptsv failed");
    for (size_t k = 0; k < num && !status; k++) {
        memcpy(*table + k * 2 * width, values + k * width, width * sizeof **table);
        memcpy(*table + (k * 2 + 1) * width, bends + k * width, width * sizeof **table);
    }
    free(diagonal);
    free(bends);
    return status;
}

/* The kernel's spline by distance, on a line that reaches twice as far as the grid, so that its ends do
 * not matter. */
static ehd_status make_kernel_table(double **table, const contact_kind *kind, const ehd_grid *grid,
                                    ehd_error *error) {
    size_t num_nodes = grid->num_nodes, num = 2 * num_nodes - 1;
    double *values = malloc(num * sizeof *values), *whole = NULL;
    ehd_status status = EHD_OK;

    *table = malloc(num_nodes * 2 * sizeof **table);
    if (!values || !*table) status = ehd_fail(error, EHD_MEMORY, "splines: found no memory");
    for (size_t k = 0; k < num && !status; k++)
        values[k] =
            kind->kernel(fabs((double)k - (double)(num_nodes - 1)) * grid->step, 0, grid->step);
    if (!status) status = make_table(&whole, values, num, 1, error);
    if (!status) memcpy(*table, whole + 2 * (num_nodes - 1), num_nodes * 2 * sizeof **table);
    free(values);
    free(whole);
    return status;
}

// ---- the modes

/* Half as far again as the model's grid goes before the contact, because places of a wide frame lie
 * farther out in a narrower one. */
static void widen_grid(film_splines *self, const ehd_grid *grid) {
    self->margin = (size_t)ceil(0.5 * fabs(grid->x_min) / grid->step);
    self->grid = grid_of(grid->x_min - (double)self->margin * grid->step, grid->step,
                         grid->inner_x + self->margin, 1, false);
}

/* Deflections of the pressure modes cut at cut_exit, [num_nodes, num_pressure]. */
static ehd_status deflect_modes(double *film, const film_splines *self, const reduced_model *model,
                                const double *pressure_basis, ehd_error *error) {
    size_t num_nodes = self->grid.num_nodes, width = self->width;
    ehd_deflection *deflection = deflection_create(model->kind, &self->grid);
    double *work = malloc(num_nodes * sizeof *work);
    ehd_status status = EHD_OK;

    if (!deflection || !work)
        status = ehd_fail(error, EHD_MEMORY, "splines: found no memory for %zu modes", width);
    for (size_t j = 0; j < width && !status; j++) {
        memset(work, 0, num_nodes * sizeof *work);
        for (size_t k = 0; k < self->cut_exit; k++)
            work[self->margin + k] = pressure_basis[k * width + j];
        deflection_apply(work, deflection, work);
        for (size_t k = 0; k < num_nodes; k++)
            film[k * width + j] = work[k];
    }
    deflection_free(deflection);
    free(work);
    return status;
}

/* The modes themselves, going on straight before the model's grid. */
static void continue_modes(double *film, const film_splines *self, const double *modes) {
    size_t width = self->width, margin = self->margin;

    memcpy(film + margin * width, modes, (self->grid.num_nodes - margin) * width * sizeof *film);
    for (size_t k = margin; k-- > 0;)
        for (size_t j = 0; j < width; j++)
            film[k * width + j] = 2 * film[(k + 1) * width + j] - film[(k + 2) * width + j];
}

static bool is_coupled(const reduced_model *model) {
    return model->deformation == DEFORMATION_COUPLED;
}

static ehd_status make_film_table(film_splines *self, const reduced_model *model,
                                  const double *pressure_basis, const double *deformation_basis,
                                  ehd_error *error) {
    double *film = malloc(self->grid.num_nodes * self->width * sizeof *film);
    ehd_status status = EHD_OK;

    if (!film)
        status = ehd_fail(error, EHD_MEMORY, "splines: found no memory for %zu modes", self->width);
    else if (is_coupled(model))
        status = deflect_modes(film, self, model, pressure_basis, error);
    else
        continue_modes(film, self, deformation_basis);
    if (!status) status = make_table(&self->film, film, self->grid.num_nodes, self->width, error);
    free(film);
    return status;
}

ehd_status film_splines_build(film_splines *self, const reduced_model *model,
                              const double *pressure_basis, const double *deformation_basis,
                              ehd_error *error) {
    memset(self, 0, sizeof *self);
    self->width = is_coupled(model) ? model->num_pressure : model->num_deformation;
    self->cut_exit = (model->least_exit + model->most_exit) / 2;
    self->pressure_basis = pressure_basis;
    widen_grid(self, &model->grid);
    ehd_status status = make_film_table(self, model, pressure_basis, deformation_basis, error);
    if (!status)
        status = make_table(&self->pressure, pressure_basis, model->grid.num_nodes,
                            model->num_pressure, error);
    if (!status) status = make_kernel_table(&self->kernel, model->kind, &self->grid, error);
    if (status) film_splines_free(self);
    return status;
}

void film_splines_free(film_splines *self) {
    free(self->film);
    free(self->pressure);
    free(self->kernel);
    memset(self, 0, sizeof *self);
}

// ---- an earlier state

ehd_status earlier_film_init(earlier_film *self, const reduced_model *model, ehd_error *error) {
    memset(self, 0, sizeof *self);
    self->coordinates = calloc(model->num_unknowns, sizeof(double));
    self->cut_pressure = calloc(model->num_band, sizeof(double));
    if (self->coordinates && self->cut_pressure)
        return reduced_values_init(&self->values, model, error);
    earlier_film_free(self);
    return ehd_fail(error, EHD_MEMORY, "earlier state: found no memory");
}

void earlier_film_free(earlier_film *self) {
    free(self->coordinates);
    free(self->cut_pressure);
    reduced_values_free(&self->values);
    memset(self, 0, sizeof *self);
}

/* The pressure's spline near the exit, where it differs from that of the modes: its values are zero from
 * there on. Far before it the bend is that of the modes. */
static void prepare_window(earlier_film *self, const reduced_model *model,
                           const film_splines *splines) {
    size_t num_pressure = model->num_pressure, num_nodes = model->grid.num_nodes;
    size_t size = num_nodes < EXIT_WINDOW ? num_nodes : EXIT_WINDOW;
    size_t begin = self->exit > size * 2 / 3 ? self->exit - size * 2 / 3 : 0;
    double diagonal[2 * EXIT_WINDOW];

    if (begin + size > num_nodes) begin = num_nodes - size;
    self->window_begin = begin;
    self->window_size = size;
    for (size_t i = 0; i < size; i++)
        self->window[i] =
            begin + i < self->exit
                ? cblas_ddot((int)num_pressure, splines->pressure + (begin + i) * 2 * num_pressure,
                             1, self->coordinates, 1)
                : 0;
    memset(self->bend, 0, sizeof self->bend);
    self->bend[0] =
        cblas_ddot((int)num_pressure, splines->pressure + (begin * 2 + 1) * num_pressure, 1,
                   self->coordinates, 1);
    solve_bends(self->bend, diagonal, self->window, size, 1);
}

void earlier_film_prepare(earlier_film *self, const reduced_model *model,
                          const film_splines *splines, const ehd_contact *reference) {
    size_t from = self->exit < splines->cut_exit ? self->exit : splines->cut_exit;
    size_t to = self->exit < splines->cut_exit ? splines->cut_exit : self->exit;

    if (is_coupled(model) && to > from)
        reduced_band_pressure(self->cut_pressure + (from - model->band_begin), model,
                              self->coordinates, from, to);
    if (reference->lubricant.density) prepare_window(self, model, splines);
}

/* A place between nodes `node` and node + 1, with the weights of their values and bends. */
typedef struct spline_place {
    size_t node;
    double value[2], bend[2];
} spline_place;

/* Beyond the grid the spline goes on straight. */
static spline_place spline_at(const ehd_grid *grid, double x) {
    double nodes = (x - grid->x_min) / grid->step + 1;
    size_t last = grid->num_nodes - 2;
    size_t first = nodes < (double)last ? nodes > 0 ? (size_t)nodes : 0 : last;
    double b = nodes - (double)first, a = 1 - b;
    spline_place at = {first, {a, b}, {(a * a - 1) * a, (b * b - 1) * b}};

    if (b < 0)
        at.bend[0] = -2 * b, at.bend[1] = -b;
    else if (a < 0)
        at.bend[0] = -a, at.bend[1] = -2 * a;
    return at;
}

// The release is built for any processor; this is what it does most in a step.
#if defined(__x86_64__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define WIDER_VECTORS __attribute__((target_clones("arch=x86-64-v3", "default")))
#else
#define WIDER_VECTORS
#endif

/* Four modes at once, as one vector of the processor where it has such. */
typedef double four_modes
    __attribute__((vector_size(4 * sizeof(double)), aligned(sizeof(double)), may_alias));
enum { FOUR = 4 };

static inline __attribute__((always_inline)) void sum_splines(double *sum, const spline_place *at,
                                                              size_t num, const double *table,
                                                              size_t width,
                                                              const double *const *coordinates) {
    const double *here = table + at->node * 2 * width, *bend_here = here + width;
    const double *next = here + 2 * width, *bend_next = here + 3 * width;
    four_modes four[BDF_EARLIER] = {{0}};
    size_t j = 0;

    for (; j + FOUR <= width; j += FOUR) {
        const four_modes h = *(const four_modes *)(here + j), n = *(const four_modes *)(next + j),
                         bh = *(const four_modes *)(bend_here + j),
                         bn = *(const four_modes *)(bend_next + j);
        for (size_t i = 0; i < num; i++)
            four[i] +=
                *(const four_modes *)(coordinates[i] + j) *
                (at[i].value[0] * h + at[i].value[1] * n + at[i].bend[0] * bh + at[i].bend[1] * bn);
    }
    for (size_t i = 0; i < num; i++) {
        sum[i] = four[i][0] + four[i][1] + four[i][2] + four[i][3];
        for (size_t k = j; k < width; k++)
            sum[i] +=
                coordinates[i][k] * (at[i].value[0] * here[k] + at[i].value[1] * next[k] +
                                     at[i].bend[0] * bend_here[k] + at[i].bend[1] * bend_next[k]);
    }
}

/* The splines of up to BDF_EARLIER states at places between the same two nodes: together, so that the
 * modes there are read once. */
WIDER_VECTORS
static void combine(double *sum, const spline_place *at, size_t num, const double *table,
                    size_t width, const double *const *coordinates) {
    switch (num) {
    case 3:
        sum_splines(sum, at, 3, table, width, coordinates);
        break;
    case 2:
        sum_splines(sum, at, 2, table, width, coordinates);
        break;
    default:
        sum_splines(sum, at, 1, table, width, coordinates);
    }
}

/* Deflection of what the state's exit adds to the modes cut at cut_exit, or takes away from them. The kernel
 * at the place's two nodes has neighbouring rows in its table: the nearer node's first. */
static double cut_deflection(const earlier_film *self, const spline_place *at,
                             const reduced_model *model, const film_splines *splines) {
    bool behind = self->exit > splines->cut_exit;
    size_t from = splines->margin + (behind ? splines->cut_exit : self->exit);
    size_t to = splines->margin + (behind ? self->exit : splines->cut_exit);
    const double *pressure = self->cut_pressure - (model->band_begin + splines->margin);
    four_modes left = {0}, right = {0}; // value and bend of the nearer node, then of the other
    size_t i = from;

    for (; i < to && i <= at->node; i++)
        left += pressure[i] * *(const four_modes *)(splines->kernel + 2 * (at->node - i));
    for (; i < to; i++)
        right += pressure[i] * *(const four_modes *)(splines->kernel + 2 * (i - at->node - 1));
    double sum = at->value[0] * (left[0] + right[2]) + at->bend[0] * (left[1] + right[3]) +
                 at->value[1] * (left[2] + right[0]) + at->bend[1] * (left[3] + right[1]);
    return behind ? sum : -sum;
}

static double pressure_at(const earlier_film *self, const spline_place *place,
                          const reduced_model *model, const film_splines *splines) {
    const size_t margin = 4; // between the window's ends and where it is used
    const double *coordinates = self->coordinates;
    spline_place at = *place;
    double sum;

    if (at.node < splines->margin) return 0;
    at.node -= splines->margin;
    if (at.node + 1 < self->window_begin + margin) {
        combine(&sum, &at, 1, splines->pressure, model->num_pressure, &coordinates);
        return sum;
    }
    if (at.node + margin + 1 >= self->window_begin + self->window_size) return 0;
    size_t i = at.node - self->window_begin;
    return at.value[0] * self->window[i] + at.value[1] * self->window[i + 1] +
           at.bend[0] * self->bend[i] + at.bend[1] * self->bend[i + 1];
}

void earlier_film_masses(double *mass, const earlier_film *const *films, size_t num_films,
                         size_t node, const contact_frame *now, const reduced_model *model,
                         const film_splines *splines, const ehd_contact *reference) {
    const density_law *law = reference->lubricant.density;
    size_t offset = is_coupled(model) ? 0 : model->num_pressure;
    double x[BDF_EARLIER];
    spline_place at[BDF_EARLIER];
    const double *coordinates[BDF_EARLIER];

    for (size_t i = 0; i < num_films; i++) {
        x[i] = frame_stretch(now, &films[i]->frame) * grid_x(&model->grid, node);
        at[i] = spline_at(&splines->grid, x[i]);
        coordinates[i] = films[i]->coordinates + offset;
    }
    for (size_t i = 0, next; i < num_films; i = next) {
        for (next = i + 1; next < num_films && at[next].node == at[i].node;)
            next++;
        combine(mass + i, at + i, next - i, splines->film, splines->width, coordinates + i);
    }
    for (size_t i = 0; i < num_films; i++) {
        const earlier_film *self = films[i];
        mass[i] += self->coordinates[model->num_unknowns - 1] + contact_gap(x[i], 0);
        if (is_coupled(model)) mass[i] += cut_deflection(self, &at[i], model, splines);
        mass[i] *= frame_film_ratio(now, &self->frame);
        if (law) {
            double hertz = reference->hertz_pressure * self->frame.hertz_pressure, ignored;
            mass[i] *= law->relative_density(
                fmax(pressure_at(self, &at[i], model, splines), 0) * hertz, &ignored);
        }
    }
}
