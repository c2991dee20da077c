/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/physics/exit.h"

double exit_multiplier(const reynolds_row *row) {
    return -row->residual;
}

double exit_violation(bool has_pressure, double pressure, double multiplier) {
    return has_pressure ? -pressure : -multiplier;
}

/* First node from `node` on, before `end`, whose film alone carries the flux. */
static size_t node_with_flux(const exit_line *line, double flux, size_t node, size_t end) {
    while (node < end && line->entrainment * line->film(line->state, node) < flux)
        node++;
    return node;
}

size_t exit_by_flux(const exit_line *line, size_t exit) {
    size_t negative = line->first_node, found = exit;

    while (negative < exit && line->pressure[negative - line->first_node] >= -line->pressure_noise)
        negative++;
    if (negative < exit) {
        double flux = line->flux(line->state, negative);
        found = node_with_flux(line, flux, negative, exit - 1);
    } else if (exit < line->max_exit &&
               line->multiplier(line->state, exit) < -line->multiplier_noise) {
        size_t end = exit + line->max_stride;
        double flux = line->flux(line->state, exit);
        found = node_with_flux(line, flux, exit + 1, end < line->max_exit ? end : line->max_exit);
    }
    if (found < line->min_exit) return line->min_exit;
    return found < line->max_exit ? found : line->max_exit;
}
