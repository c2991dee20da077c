/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/physics/contact.h"

#include "common/physics/film_formulas.h"

#include <math.h>
#include <string.h>

// ---- line contact

static double line_gap(double x) {
    return x * x / 2;
}

/* x (ln|x| - 1), whose derivative is ln|x|. */
static double line_primitive(double x) {
    return x == 0 ? 0 : x * (log(fabs(x)) - 1);
}

/* -(1/2pi) int ln(X'^2) over the cell (model.md, section 2). */
static double line_kernel(double distance, double step) {
    return -(line_primitive(distance + step / 2) - line_primitive(distance - step / 2)) / M_PI;
}

static double line_lambda(double moes_M) {
    return 3 * M_PI * M_PI / (8 * moes_M * moes_M);
}

static double line_alpha_p_H(double moes_M, double moes_L) {
    return moes_L * sqrt(moes_M / (2 * M_PI));
}

/* The deflection is measured from a distance of the current half width, so that the constant of
 * eq. (4) moves with it (model.md, section 4). */
static double line_approach_shift(double half_width, double length) {
    return 0.5 * log(half_width / length);
}

const contact_kind contact_line = {
    .name = "line",
    .load = M_PI_2,
    .gap = line_gap,
    .kernel = line_kernel,
    .lambda = line_lambda,
    .alpha_p_H = line_alpha_p_H,
    .central_film = film_moes,
    .approach_shift = line_approach_shift,
};

// ---- any contact

double grid_x(const ehd_grid *grid, size_t node) {
    return grid->x_min + ((double)node - 1) * grid->step;
}

bool grid_same(const ehd_grid *a, const ehd_grid *b) {
    const double slack = 1e-9 * b->step;

    return a->num_inner == b->num_inner && fabs(a->x_min - b->x_min) <= slack &&
           fabs(a->step - b->step) <= slack;
}

static void grid_init(ehd_grid *grid, const scene *given) {
    grid->x_min = given->x_min;
    grid->step = given->step;
    grid->num_inner = (size_t)lround((given->x_max - given->x_min) / given->step) + 1;
    grid->num_nodes = grid->num_inner + 2;
}

/* Moes numbers and scales from load, radius, speed, modulus and viscosity of a line contact. */
static ehd_status contact_from_physical(ehd_contact *contact, const scene *given,
                                        ehd_error *error) {
    double eta0 = contact->lubricant.eta0; // NaN where the law has none

    if (!isnan(eta0) && fabs(given->viscosity - eta0) > 0.01 * eta0)
        return ehd_fail(error, EHD_DATA,
                        "physical.viscosity: found %g, expected %.6g Pa s, the lubricant's own "
                        "at zero pressure, within 1 %%",
                        given->viscosity, eta0);
    double sum_speed = 2 * given->speed;
    double speed_number = given->viscosity * sum_speed / (given->modulus * given->radius);
    double load_number = given->load / (given->modulus * given->radius);
    contact->moes_M = load_number / sqrt(speed_number);
    contact->moes_L = contact->lubricant.alpha * given->modulus * pow(speed_number, 0.25);
    contact->load = given->load;
    contact->radius = given->radius;
    contact->half_width = sqrt(8 * given->load * given->radius / (M_PI * given->modulus));
    return EHD_OK;
}

ehd_status contact_init(ehd_contact *contact, const scene *given, ehd_error *error) {
    memset(contact, 0, sizeof *contact);
    if (strcmp(given->regime, "stationary") == 0 && strcmp(given->closure, "approach") == 0)
        return ehd_fail(error, EHD_DATA,
                        "closure: found approach in a stationary scene, expected load; a transient "
                        "scene finds the load of an approach");
    contact->kind = &contact_line;
    contact->entrainment = 1;
    contact->closure = contact_load_closure(contact->kind);
    contact->half_width = contact->radius = contact->load = NAN;
    grid_init(&contact->grid, given);
    bool approach_given = strcmp(given->closure, "approach") == 0;
    contact->approach_length = !isnan(given->approach_length) ? given->approach_length
                               : approach_given               ? 10
                                                              : 1;
    ehd_status status = approach_given ? contact_check_approach(contact, error) : EHD_OK;
    if (!status) status = lubricant_init(&contact->lubricant, &given->lubricant, error);
    if (status) return status;

    if (isnan(given->moes_M)) {
        status = contact_from_physical(contact, given, error);
        if (status) return status;
    } else {
        contact->moes_M = given->moes_M;
        contact->moes_L = given->moes_L;
    }
    contact_set_moes(contact, contact->moes_M, contact->moes_L);
    // where it is given it wins, and L is only reported
    if (!isnan(given->hertz_pressure)) {
        contact->hertz_pressure = given->hertz_pressure;
        contact->alpha_p_H = contact->lubricant.alpha * given->hertz_pressure;
    }
    if (!(contact->hertz_pressure < contact->lubricant.pressure_limit))
        return ehd_fail(error, EHD_DATA,
                        "hertz_pressure: found %.4g GPa (M = %g, L = %g), expected below the %s "
                        "law's limit of %.4g GPa",
                        contact->hertz_pressure * 1e-9, contact->moes_M, contact->moes_L,
                        contact->lubricant.viscosity->name,
                        contact->lubricant.pressure_limit * 1e-9);
    return EHD_OK;
}

void contact_set_moes(ehd_contact *contact, double moes_M, double moes_L) {
    contact->moes_M = moes_M;
    contact->moes_L = moes_L;
    contact->lambda = contact->kind->lambda(moes_M);
    contact->alpha_p_H = contact->kind->alpha_p_H(moes_M, moes_L);
    contact->hertz_pressure = contact->alpha_p_H / contact->lubricant.alpha;
}

ehd_status contact_check_approach(const ehd_contact *contact, ehd_error *error) {
    double least = 0.5 * contact->grid.step * (double)(contact->grid.num_inner - 1);

    if (contact->approach_length >= least) return EHD_OK;
    return ehd_fail(
        error, EHD_DATA,
        "approach_length: found %g, expected at least %g, half the grid's length, where "
        "the approach is given",
        contact->approach_length, least);
}

contact_closure contact_load_closure(const contact_kind *kind) {
    return (contact_closure){.by_approach = 0, .by_load = 1, .value = kind->load};
}

double contact_film_scale(const ehd_contact *contact) {
    return contact->half_width * contact->half_width / contact->radius;
}
