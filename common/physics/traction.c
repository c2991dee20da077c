/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/physics/traction.h"

#include "common/algebra/gauss.h"
#include "common/algebra/rounding.h"
#include "common/physics/eyring_flow.h"
#include "common/physics/far_field.h"

#include <math.h>

const double usual_friction = 0.2, possible_friction = 1;
const char impossible_friction[] = "a friction above the load (check lubricant.shear.law)";

double traction_judged_coefficient(double friction, double load) {
    return fabs(friction) / fmax(load, 0.1);
}

bool contact_has_traction(const ehd_contact *contact) {
    return !isnan(contact->slide_roll) && !isnan(contact->half_width);
}

contact_traction contact_traction_unknown(void) {
    return (contact_traction){NAN, NAN, NAN, NAN, NAN, NAN, NAN};
}

/* Returns a/R, the factor from pressures to stresses along the film. */
static double slope_of(const ehd_contact *contact) {
    return contact->half_width / contact->radius;
}

/* Returns tau/p_H of a Newtonian fluid. `viscosity` is relative to its value at zero pressure. */
static double viscous_stress(const ehd_contact *contact, double viscosity, double film) {
    return contact->lambda / 12 * slope_of(contact) * contact->slide_roll * contact->far_speed *
           viscosity / film;
}

double contact_shear_stress(const ehd_contact *contact, double pressure, double film,
                            double gradient) {
    const double viscous = viscous_stress(contact, 1, film);

    if (!traction_thins_flow(contact))
        return lubricant_shear_stress(&contact->lubricant, contact->hertz_pressure, viscous,
                                      pressure);
    const double eyring = contact->lubricant.thinning_stress / contact->hertz_pressure;
    const eyring_gradient of =
        eyring_gradient_of(fabs(traction_thinning(contact).gradient * film * gradient));
    // Newtonian stress due to sliding at this pressure; eyring_stress includes the effect of the
    // gradient
    const double newtonian = lubricant_viscous_stress(&contact->lubricant, contact->hertz_pressure,
                                                      fabs(viscous), pressure);
    return copysign(eyring * eyring_stress(&of, newtonian / eyring), viscous);
}

stress_slopes contact_stress_slopes(const ehd_contact *contact, double pressure, double film,
                                    double gradient) {
    const double distance = difference_distance(), thickness = distance * film;
    const double by_pressure = contact_shear_stress(contact, pressure + distance, film, gradient) -
                               contact_shear_stress(contact, pressure - distance, film, gradient);
    const double by_film = contact_shear_stress(contact, pressure, film + thickness, gradient) -
                           contact_shear_stress(contact, pressure, film - thickness, gradient);
    const double by_gradient =
        traction_thins_flow(contact)
            ? contact_shear_stress(contact, pressure, film, gradient + distance) -
                  contact_shear_stress(contact, pressure, film, gradient - distance)
            : 0;

    return (stress_slopes){by_pressure / (2 * distance), by_film / (2 * thickness),
                           by_gradient / (2 * distance)};
}

bool traction_thins_flow(const ehd_contact *contact) {
    return contact->lubricant.thinning_stress > 0 && contact_has_traction(contact);
}

flow_thinning traction_thinning(const ehd_contact *contact) {
    if (!traction_thins_flow(contact)) return (flow_thinning){0, 0};
    const double of_stress = contact->hertz_pressure / contact->lubricant.thinning_stress;

    return (flow_thinning){fabs(viscous_stress(contact, 1, 1)) * of_stress,
                           slope_of(contact) / 2 * of_stress};
}

double contact_traction_behind(const ehd_contact *contact, const ehd_grid *grid, size_t node,
                               double stress, const double film[2], double exit) {
    const double beside = (exit - grid_x(grid, node)) / grid->step;
    const double place = isgreaterequal(beside, 0) && islessequal(beside, 1) ? beside : 1;
    const double there = (1 - place) * film[0] + place * film[1];

    return grid->step / 2 *
           (place * (stress + contact_shear_stress(contact, 0, there, 0)) - stress);
}

// ---- beyond the grid

/* Returns H far upstream of a line contact. The deflection is computed as if the whole load acted
 * at X = 0. */
static double film_before_line(const contact_scalars *scalars, double distance) {
    return scalars->rigid_approach + distance * distance / 2 - scalars->load / 2 * log(distance);
}

/* Returns the integrals from the boundary node to infinity. The variable of integration is s =
 * first/X. The viscosity is the viscosity at zero pressure, so that dP/dX = lambda U (H - H_e)/H^3.
 * H_e is the flow divided by U, and is taken as the central film. The error of H_e is up to a
 * fifth. Its effect on the integrals is this error times H_e/X^2. P falls with X^-3, so P is a
 * third of |X dP/dX|. */
static traction_sums beyond_line(const ehd_contact *contact, const contact_scalars *scalars) {
    const ehd_grid *grid = &contact->grid;
    const bool backwards = contact->entrainment < 0;
    const double first = fabs(grid_x(grid, backwards ? grid_width(grid) - 1 : 0));
    const double speed = contact->lambda * contact->entrainment;
    // the sum over the inner nodes begins half a grid step downstream of the boundary node
    traction_sums sums = {
        .friction =
            grid->step / 2 * contact_shear_stress(contact, 0, film_before_line(scalars, first), 0)};

    for (int i = 0; i < GAUSS_8; i++) {
        const double distance = first / gauss_8_place[i];
        const double film = film_before_line(scalars, distance);
        const double slope =
            speed * (film - scalars->central_film_thickness) / (film * film * film);
        const double length = gauss_8_weight[i] * distance / gauss_8_place[i];
        sums.rolling += length * film * slope;
        sums.friction +=
            length * contact_shear_stress(contact, distance * fabs(slope) / 3, film, slope);
    }
    return sums;
}

traction_sums contact_traction_beyond(const ehd_contact *contact, const contact_scalars *scalars) {
    return contact->kind->dimensions == 1 ? beyond_line(contact, scalars)
                                          : far_field_traction(contact, scalars->rigid_approach);
}

// ---- sums over the grid

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

/* Returns dP/dX at an inner node. */
static double gradient_at(const ehd_grid *grid, const double *pressure, size_t node) {
    return (pressure[node + 1] - pressure[node - 1]) / (2 * grid->step);
}

contact_traction contact_traction_of(const ehd_contact *contact, const double *pressure,
                                     const double *film, const contact_scalars *scalars) {
    const ehd_grid *grid = &contact->grid;
    const double cell = grid_cell(grid);
    const bool on_line = contact->kind->dimensions == 1;
    double friction = 0, rolling = 0, moment = 0, dry = 0, dry_area = 0, largest = 0;

    for (size_t r = 0; r < grid->num_inner; r++) {
        const size_t k = grid_node_of_row(grid, r);
        const double weight = grid_weight(grid, k), in_dry = weight * grid_dry_share(grid, k);
        // integral from the previous node to this node; at the last inner node of a line also from
        // this node to the next node
        rolling += weight * (film[k - 1] + film[k]) / 2 * (pressure[k] - pressure[k - 1]);
        if (r % grid->inner_x == grid->inner_x - 1)
            rolling += weight * (film[k] + film[k + 1]) / 2 * (pressure[k + 1] - pressure[k]);
        moment += weight * grid_x(grid, k) * pressure[k];
        dry_area += in_dry;
        if (!(pressure[k] > 0)) continue;
        const double stress =
            contact_shear_stress(contact, pressure[k], film[k], gradient_at(grid, pressure, k));
        friction += weight * stress * cell;
        if (!(pressure[k + 1] > 0))
            friction += weight * cell / grid->step *
                        contact_traction_behind(contact, grid, k, stress, film + k,
                                                on_line ? scalars->exit_position : NAN);
        dry += in_dry * fabs(stress);
        largest = fmax(largest, fabs(stress));
    }
    const traction_sums beyond = contact_traction_beyond(contact, scalars);
    const traction_sums sums = {.friction = friction + beyond.friction,
                                .rolling = rolling * cell / grid->step + beyond.rolling,
                                .moment = moment * cell - beyond.rolling,
                                .mean_stress = dry / dry_area,
                                .largest_stress = largest};

    return contact_traction_from(contact, &sums, scalars->load);
}

/* Returns the pressure at a node. If the grid has a far field, the pressure of the far field is
 * returned at boundary nodes. */
static double pressure_at(const ehd_contact *contact, const double *pressure, double rigid_approach,
                          size_t node) {
    const ehd_grid *grid = &contact->grid;

    if (!far_field_is_there(grid) || !far_field_is_at(grid, node)) return pressure[node];
    return far_field_pressure(contact, rigid_approach, grid_x(grid, node), grid_y(grid, node))
        .value;
}

void contact_surface_stresses(double *on_1, double *on_2, const ehd_contact *contact,
                              const double *pressure, const double *film, double rigid_approach) {
    const ehd_grid *grid = &contact->grid;
    ehd_contact around = *contact;

    // the far field needs the entrainment; far_speed may have been set only to scale the sliding
    around.far_speed = contact->entrainment;
    for (size_t k = 0; k < grid->num_nodes; k++)
        on_1[k] = on_2[k] = 0;
    for (size_t r = 0; r < grid->num_inner; r++) {
        const size_t k = grid_node_of_row(grid, r);
        if (!(pressure[k] > 0)) continue;
        const double gradient = (pressure_at(&around, pressure, rigid_approach, k + 1) -
                                 pressure_at(&around, pressure, rigid_approach, k - 1)) /
                                (2 * grid->step);
        const double stress = contact_shear_stress(contact, pressure[k], film[k], gradient);
        const double rolling = slope_of(contact) * film[k] / 2 * gradient;
        on_1[k] = -stress - rolling;
        on_2[k] = stress - rolling;
    }
}
