/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/physics/traction.h"

#include <math.h>

bool contact_has_traction(const ehd_contact *contact) {
    return !isnan(contact->slide_roll) && !isnan(contact->half_width);
}

contact_traction contact_traction_unknown(void) {
    return (contact_traction){NAN, NAN, NAN, NAN, NAN, NAN, NAN};
}

/* a/R: by how much stresses along the film are smaller than the pressures. */
static double slope_of(const ehd_contact *contact) {
    return contact->half_width / contact->radius;
}

/* tau/p_H of a Newtonian fluid that has this viscosity, over that at zero pressure. */
static double viscous_stress(const ehd_contact *contact, double viscosity, double film) {
    return contact->lambda / 12 * slope_of(contact) * contact->slide_roll * contact->far_speed *
           viscosity / film;
}

double contact_shear_stress(const ehd_contact *contact, double pressure, double film) {
    return lubricant_shear_stress(&contact->lubricant, contact->hertz_pressure,
                                  viscous_stress(contact, 1, film), pressure);
}

/* Pressures and films. With 1e-4 the friction of a limit has derivatives that are 6e-5 off, with
 * 1e-5 1e-6. */
static const double DISTANCE = 1e-5;

stress_slopes contact_stress_slopes(const ehd_contact *contact, double pressure, double film) {
    const double thickness = DISTANCE * film;
    const double by_pressure = contact_shear_stress(contact, pressure + DISTANCE, film) -
                               contact_shear_stress(contact, pressure - DISTANCE, film);
    const double by_film = contact_shear_stress(contact, pressure, film + thickness) -
                           contact_shear_stress(contact, pressure, film - thickness);

    return (stress_slopes){by_pressure / (2 * DISTANCE), by_film / (2 * thickness)};
}

bool traction_thins_flow(const ehd_contact *contact) {
    return contact->lubricant.thinning_stress > 0 && contact_has_traction(contact);
}

double traction_thinning_rate(const ehd_contact *contact) {
    if (!traction_thins_flow(contact)) return 0;
    return fabs(viscous_stress(contact, 1, 1)) * contact->hertz_pressure /
           contact->lubricant.thinning_stress;
}

double contact_traction_behind(const ehd_contact *contact, const ehd_grid *grid, size_t node,
                               double stress, const double film[2], double exit) {
    const double beside = (exit - grid_x(grid, node)) / grid->step;
    const double place = beside >= 0 && beside <= 1 ? beside : 1;
    const double there = (1 - place) * film[0] + place * film[1];

    return grid->step / 2 * (place * (stress + contact_shear_stress(contact, 0, there)) - stress);
}

contact_traction contact_traction_from(const ehd_contact *contact, const traction_sums *sums,
                                       double load) {
    const double per_load = 1 / contact->kind->load;
    contact_traction traction = {
        .coefficient = sums->friction * per_load / load,
        .friction = sums->friction * per_load,
        .rolling_resistance = slope_of(contact) * sums->rolling * per_load / 2,
        .rolling_moment = -sums->moment * per_load,
        .mean_stress = sums->mean_stress,
        .largest_stress = sums->largest_stress,
    };

    traction.power = contact->far_speed *
                     (contact->slide_roll * traction.friction + 2 * traction.rolling_resistance);
    return traction;
}

contact_traction contact_traction_of(const ehd_contact *contact, const double *pressure,
                                     const double *film, const contact_scalars *scalars) {
    const ehd_grid *grid = &contact->grid;
    const double cell = grid_cell(grid);
    const bool on_line = contact->kind->dimensions == 1;
    double friction = 0, rolling = 0, moment = 0, dry = 0, dry_area = 0, largest = 0;

    for (size_t r = 0; r < grid->num_inner; r++) {
        const size_t k = grid_node_of_row(grid, r);
        const double weight = grid_weight(grid, k);
        const bool in_dry = grid_is_dry(grid, k);
        // of the cell from the node before to this one, and at the end of the line to the next
        rolling += weight * (film[k - 1] + film[k]) / 2 * (pressure[k] - pressure[k - 1]);
        if (r % grid->inner_x == grid->inner_x - 1)
            rolling += weight * (film[k] + film[k + 1]) / 2 * (pressure[k + 1] - pressure[k]);
        moment += weight * grid_x(grid, k) * pressure[k];
        if (in_dry) dry_area += weight;
        if (!(pressure[k] > 0)) continue;
        const double stress = contact_shear_stress(contact, pressure[k], film[k]);
        friction += weight * stress * cell;
        if (!(pressure[k + 1] > 0))
            friction += weight * cell / grid->step *
                        contact_traction_behind(contact, grid, k, stress, film + k,
                                                on_line ? scalars->exit_position : NAN);
        if (in_dry) dry += weight * fabs(stress);
        largest = fmax(largest, fabs(stress));
    }
    const traction_sums sums = {.friction = friction,
                                .rolling = rolling * cell / grid->step,
                                .moment = moment * cell,
                                .mean_stress = dry / dry_area,
                                .largest_stress = largest};

    return contact_traction_from(contact, &sums, scalars->load);
}

void contact_surface_stresses(double *on_1, double *on_2, const ehd_contact *contact,
                              const double *pressure, const double *film) {
    const ehd_grid *grid = &contact->grid;

    for (size_t k = 0; k < grid->num_nodes; k++)
        on_1[k] = on_2[k] = 0;
    for (size_t r = 0; r < grid->num_inner; r++) {
        const size_t k = grid_node_of_row(grid, r);
        if (!(pressure[k] > 0)) continue;
        const double gradient = (pressure[k + 1] - pressure[k - 1]) / (2 * grid->step);
        const double stress = contact_shear_stress(contact, pressure[k], film[k]);
        const double rolling = slope_of(contact) * film[k] / 2 * gradient;
        on_1[k] = -stress - rolling;
        on_2[k] = stress - rolling;
    }
}
