/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/settings/scene_contact.h"

#include <math.h>
#include <string.h>

static ehd_grid scene_grid(const scene *given) {
    const double step = scene_step(given);
    const size_t inner_x = (size_t)lround((given->grid.x_max - given->grid.x_min) / step) + 1;
    const size_t beside = isnan(given->grid.y_max) ? 0 : (size_t)lround(given->grid.y_max / step);
    const bool half = beside > 0 && given->grid.half != 0;

    ehd_discretization discretization = DISCRETIZATION_ACCURATE;

    discretization_find(&discretization, given->discretization); // of the table's choices
    return grid_of(given->grid.x_min, step, inner_x, half ? beside + 1 : 2 * beside + 1, half,
                   discretization);
}

ehd_status scene_contact(ehd_contact *contact, const scene *given, ehd_error *error) {
    const bool approach_given = strcmp(given->closure, "approach") == 0;

    *contact = (ehd_contact){0};
    if (approach_given && strcmp(given->regime, "stationary") == 0)
        return ehd_fail(error, EHD_DATA,
                        "closure: found approach in a stationary scene, expected load; a transient "
                        "scene finds the load of an approach");

    const contact_settings settings = {
        .kind = *given->contact ? contact_kind_find(given->contact) : &contact_line,
        .grid = scene_grid(given),
        .lubricant = given->lubricant,
        .moes_M = given->moes.M,
        .moes_L = given->moes.L,
        .load = given->physical.load,
        .radius = given->physical.radius,
        .speed = given->physical.speed,
        .modulus = given->physical.modulus,
        .viscosity = given->physical.viscosity,
        .hertz_pressure = given->hertz_pressure,
        .approach_given = approach_given,
        .approach_length = given->approach_length,
    };
    return contact_init(contact, &settings, error);
}
