/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/film_splines.h"

#include "common/physics/deflection.h"
#include "romrun/reduced_solver.h"

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
    return LAPACKE_dptsv(LAPACK_ROW_MAJOR, (lapack_int)inner, (lapack_int)width, diagonal,
                         diagonal + inner, bends + width, (lapack_int)width);
}

static ehd_status make_bends(double **bends, const double *values, size_t num, size_t width,
                             ehd_error *error) {
    double *diagonal = malloc(2 * num * sizeof *diagonal);
    ehd_status status = EHD_OK;

    *bends = calloc(num * width, sizeof **bends);
    if (!*bends || !diagonal)
        status = ehd_fail(error, EHD_MEMORY, "splines: found no memory");
    else if (solve_bends(*bends, diagonal, values, num, width))
        status = ehd_fail(error, EHD_INTERNAL, "splines: dptsv failed");
    free(diagonal);
    return status;
}

/* Bends of the kernel's spline by distance, on a line that reaches twice as far as the grid, so that its
 * ends do not matter. */
static ehd_status make_kernel_bends(film_splines *self, const reduced_model *model,
                                    ehd_error *error) {
    size_t num_nodes = model->grid.num_nodes, num = 2 * num_nodes - 1;
    double *values = malloc(num * sizeof *values), *bends = NULL;
    ehd_status status = EHD_OK;

    self->kernel_bend = malloc(num_nodes * sizeof(double));
    if (!values || !self->kernel_bend)
        status = ehd_fail(error, EHD_MEMORY, "splines: found no memory");
    for (size_t k = 0; k < num && !status; k++)
        values[k] = model->kernel[k < num_nodes ? num_nodes - 1 - k : k - (num_nodes - 1)];
    if (!status) status = make_bends(&bends, values, num, 1, error);
    if (!status) memcpy(self->kernel_bend, bends + num_nodes - 1, num_nodes * sizeof(double));
    free(values);
    free(bends);
    return status;
}

// ---- the modes

/* Deflections of the pressure modes cut at cut_exit. */
static ehd_status deflect_modes(film_splines *self, const reduced_model *model, ehd_error *error) {
    size_t num_nodes = model->grid.num_nodes, width = self->width;
    ehd_deflection *deflection = deflection_create(model->kind, &model->grid);
    double *work = malloc(num_nodes * sizeof *work);
    ehd_status status = EHD_OK;

    self->film = malloc(num_nodes * width * sizeof(double));
    if (deflection && work && self->film) {
        for (size_t j = 0; j < width; j++) {
            for (size_t k = 0; k < num_nodes; k++)
                work[k] = k < self->cut_exit ? self->pressure[k * width + j] : 0;
            deflection_apply(work, deflection, work);
            for (size_t k = 0; k < num_nodes; k++)
                self->film[k * width + j] = work[k];
        }
    } else {
        status = ehd_fail(error, EHD_MEMORY, "splines: found no memory for %zu modes", width);
    }
    deflection_free(deflection);
    free(work);
    return status;
}

static ehd_status copy_modes(film_splines *self, const reduced_model *model,
                             const double *deformation_basis, ehd_error *error) {
    size_t bytes = model->grid.num_nodes * self->width * sizeof(double);

    self->film = malloc(bytes);
    if (!self->film) return ehd_fail(error, EHD_MEMORY, "splines: found no memory");
    memcpy(self->film, deformation_basis, bytes);
    return EHD_OK;
}

static bool is_coupled(const reduced_model *model) {
    return model->deformation == DEFORMATION_COUPLED;
}

ehd_status film_splines_build(film_splines *self, const reduced_model *model,
                              const double *pressure_basis, const double *deformation_basis,
                              ehd_error *error) {
    size_t num_nodes = model->grid.num_nodes;

    memset(self, 0, sizeof *self);
    self->width = is_coupled(model) ? model->num_pressure : model->num_deformation;
    self->cut_exit = (model->least_exit + model->most_exit) / 2;
    self->pressure = pressure_basis;
    self->kernel = model->kernel;
    ehd_status status = is_coupled(model) ? deflect_modes(self, model, error)
                                          : copy_modes(self, model, deformation_basis, error);
    if (!status) status = make_bends(&self->film_bend, self->film, num_nodes, self->width, error);
    if (!status)
        status =
            make_bends(&self->pressure_bend, pressure_basis, num_nodes, model->num_pressure, error);
    if (!status) status = make_kernel_bends(self, model, error);
    if (status) film_splines_free(self);
    return status;
}

void film_splines_free(film_splines *self) {
    free(self->film);
    free(self->film_bend);
    free(self->pressure_bend);
    free(self->kernel_bend);
    memset(self, 0, sizeof *self);
}

// ---- an earlier state

ehd_status earlier_film_init(earlier_film *self, const reduced_model *model, ehd_error *error) {
    memset(self, 0, sizeof *self);
    self->coordinates = calloc(model->num_unknowns, sizeof(double));
    self->cut_pressure = calloc(model->num_band, sizeof(double));
    if (self->coordinates && self->cut_pressure) return EHD_OK;
    earlier_film_free(self);
    return ehd_fail(error, EHD_MEMORY, "earlier state: found no memory");
}

void earlier_film_free(earlier_film *self) {
    free(self->coordinates);
    free(self->cut_pressure);
    memset(self, 0, sizeof *self);
}

/* The pressure's spline near the exit, where it differs from that of the modes: its values are zero from
 * there on. Far before it the bend is that of the modes. */
static void prepare_window(earlier_film *self, const reduced_model *model,
                           const film_splines *splines) {
    size_t num_pressure = model->num_pressure, num_nodes = model->grid.num_nodes;
    size_t begin = self->exit > EXIT_WINDOW * 2 / 3 ? self->exit - EXIT_WINDOW * 2 / 3 : 0;
    double diagonal[2 * EXIT_WINDOW];

    if (begin + EXIT_WINDOW > num_nodes) begin = num_nodes - EXIT_WINDOW;
    self->window_begin = begin;
    for (size_t i = 0; i < EXIT_WINDOW; i++)
        self->window[i] =
            begin + i < self->exit
                ? cblas_ddot((int)num_pressure, splines->pressure + (begin + i) * num_pressure, 1,
                             self->coordinates, 1)
                : 0;
    memset(self->bend, 0, sizeof self->bend);
    self->bend[0] = cblas_ddot((int)num_pressure, splines->pressure_bend + begin * num_pressure, 1,
                               self->coordinates, 1);
    solve_bends(self->bend, diagonal, self->window, EXIT_WINDOW, 1);
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

static spline_place spline_at(const ehd_grid *grid, double x) {
    double nodes = (x - grid->x_min) / grid->step + 1, most = (double)(grid->num_nodes - 2);
    // beyond the grid the last piece goes on: without pressure there, the film is smooth
    double first = fmin(fmax(floor(nodes), 0), most);
    double b = nodes - first, a = 1 - b;
    return (spline_place){(size_t)first, {a, b}, {(a * a - 1) * a, (b * b - 1) * b}};
}

/* Sums in lanes, because one running sum would keep the processor from taking several terms at a time. */
enum { LANES = 8 };

static double combine(const spline_place *at, const double *restrict values,
                      const double *restrict bends, size_t width,
                      const double *restrict coordinates) {
    const double *v = values + at->node * width, *b = bends + at->node * width;
    double lanes[LANES] = {0}, sum = 0;
    size_t j = 0;

    for (; j + LANES <= width; j += LANES)
        for (size_t l = 0; l < LANES; l++)
            lanes[l] +=
                coordinates[j + l] * (at->value[0] * v[j + l] + at->value[1] * v[width + j + l] +
                                      at->bend[0] * b[j + l] + at->bend[1] * b[width + j + l]);
    for (; j < width; j++)
        sum += coordinates[j] * (at->value[0] * v[j] + at->value[1] * v[width + j] +
                                 at->bend[0] * b[j] + at->bend[1] * b[width + j]);
    for (size_t l = 0; l < LANES; l++)
        sum += lanes[l];
    return sum;
}

static size_t distance(size_t a, size_t b) {
    return a > b ? a - b : b - a;
}

/* Deflection of what the state's exit adds to the modes cut at cut_exit, or takes away from them. */
static double cut_deflection(const earlier_film *self, const spline_place *at,
                             const reduced_model *model, const film_splines *splines) {
    bool behind = self->exit > splines->cut_exit;
    size_t from = behind ? splines->cut_exit : self->exit;
    size_t to = behind ? self->exit : splines->cut_exit;
    double sum = 0;

    for (size_t i = from; i < to; i++) {
        size_t here = distance(at->node, i), next = distance(at->node + 1, i);
        sum +=
            self->cut_pressure[i - model->band_begin] *
            (at->value[0] * splines->kernel[here] + at->value[1] * splines->kernel[next] +
             at->bend[0] * splines->kernel_bend[here] + at->bend[1] * splines->kernel_bend[next]);
    }
    return behind ? sum : -sum;
}

static double pressure_at(const earlier_film *self, const spline_place *at,
                          const reduced_model *model, const film_splines *splines) {
    const size_t margin = 4; // between the window's ends and where it is used

    if (at->node + 1 < self->window_begin + margin)
        return combine(at, splines->pressure, splines->pressure_bend, model->num_pressure,
                       self->coordinates);
    if (at->node + margin + 1 >= self->window_begin + EXIT_WINDOW) return 0;
    size_t place = at->node - self->window_begin;
    return at->value[0] * self->window[place] + at->value[1] * self->window[place + 1] +
           at->bend[0] * self->bend[place] + at->bend[1] * self->bend[place + 1];
}

double earlier_film_mass(const earlier_film *self, size_t node, const contact_frame *now,
                         const reduced_model *model, const film_splines *splines,
                         const ehd_contact *reference) {
    const density_law *law = reference->lubricant.density;
    double x = frame_stretch(now, &self->frame) * grid_x(&model->grid, node);
    size_t offset = is_coupled(model) ? 0 : model->num_pressure;
    spline_place at = spline_at(&model->grid, x);
    double film =
        self->coordinates[model->num_unknowns - 1] + model->kind->gap(x) +
        combine(&at, splines->film, splines->film_bend, splines->width, self->coordinates + offset);

    if (is_coupled(model)) film += cut_deflection(self, &at, model, splines);
    film *= frame_film_ratio(now, &self->frame);
    if (law) {
        double hertz = reference->hertz_pressure * self->frame.hertz_pressure, ignored;
        film *= law->relative_density(fmax(pressure_at(self, &at, model, splines), 0) * hertz,
                                      &ignored);
    }
    return film;
}
