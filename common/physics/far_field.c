/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/physics/far_field.h"

#include <math.h>

bool far_field_is_there(const ehd_grid *grid) {
    return grid->inner_lines > 1 && grid->boundary == BOUNDARY_OPEN;
}

/* S(phi), zero behind the exit at tan(phi) = -3 tanh(3 phi), where tanh is 1 - 2e-5. */
static double exit_angle(void) {
    return M_PI - atan(3);
}

static double shape(double phi) {
    const double exit = exit_angle();

    return phi < exit ? 0.8 * (cos(phi) - cos(exit) * cosh(3 * phi) / cosh(3 * exit)) : 0;
}

/* Twice the film over r^2 at a place with 1/r = inverse, and its derivative. */
static far_value film_ratio(double rigid_approach, double inverse) {
    const double square = inverse * inverse;
    const double deflection = 4 / (3 * M_PI) * inverse; // (2/pi^2) (2 pi/3)/r

    return (far_value){1 + 2 * square * (rigid_approach + deflection), 2 * square};
}

double far_field_film(double rigid_approach, double x, double y) {
    const double distance = hypot(x, y);

    return distance * distance / 2 * film_ratio(rigid_approach, 1 / distance).value;
}

/* factor/film^2 */
static far_value over_square(double factor, far_value film) {
    const double value = factor / (film.value * film.value);

    return (far_value){value, -2 * value * film.by_approach / film.value};
}

static far_value scaled(far_value of, double factor) {
    return (far_value){factor * of.value, factor * of.by_approach};
}

static void add(far_value *sum, far_value other) {
    sum->value += other.value;
    sum->by_approach += other.by_approach;
}

far_value far_field_pressure(const ehd_contact *contact, double rigid_approach, double x,
                             double y) {
    const double speed = contact->far_speed;
    const double upstream = speed < 0 ? x : -x, inverse = 1 / hypot(x, y);
    const double factor = contact->lambda * fabs(speed) * shape(atan2(fabs(y), upstream));

    return over_square(factor * inverse * inverse * inverse, film_ratio(rigid_approach, inverse));
}

// ---- the load beyond

// abscissas and weights of Gauss on 0 ... 1
enum { NUM_GAUSS = 4 };
static const double abscissa[NUM_GAUSS] = {0.06943184420297371, 0.33000947820757187,
                                           0.66999052179242813, 0.93056815579702629};
static const double weight[NUM_GAUSS] = {0.17392742256872693, 0.32607257743127307,
                                         0.32607257743127307, 0.17392742256872693};

/* Ends of what the sum over the inner nodes counts, half a step beyond them: against the flow, with
 * it, and beside. */
typedef struct inner_ends {
    double upstream, downstream, beside;
} inner_ends;

static inner_ends ends_of(const ehd_grid *grid, bool backwards) {
    const double half = grid->step / 2;
    const grid_extent extent = grid_extent_of(grid);
    const double to_smaller = half - extent.x_min, to_larger = half + extent.x_max;

    return (inner_ends){backwards ? to_larger : to_smaller, backwards ? to_smaller : to_larger,
                        half + extent.y_max};
}

/* The integral of r^2/(2H)^2 dr from the end in a direction on, with s = end/r. */
static far_value beyond(double rigid_approach, const inner_ends *ends, double phi) {
    const double along = cos(phi) > 0 ? ends->upstream : ends->downstream;
    const double end = fmin(along / fabs(cos(phi)), ends->beside / sin(phi));
    far_value sum = {0, 0};

    for (int i = 0; i < NUM_GAUSS; i++)
        add(&sum, over_square(weight[i] / end, film_ratio(rigid_approach, abscissa[i] / end)));
    return sum;
}

static far_value load_between(double rigid_approach, const inner_ends *ends, double from,
                              double to) {
    far_value sum = {0, 0};

    for (int i = 0; i < NUM_GAUSS; i++) {
        const double phi = from + abscissa[i] * (to - from);
        add(&sum, scaled(beyond(rigid_approach, ends, phi), weight[i] * (to - from) * shape(phi)));
    }
    return sum;
}

far_value far_field_load(const ehd_contact *contact, double rigid_approach) {
    if (!far_field_is_there(&contact->grid)) return (far_value){0, 0};
    const double speed = contact->far_speed, exit = exit_angle();
    const inner_ends ends = ends_of(&contact->grid, speed < 0);
    // smooth between the corners
    const double first = atan2(ends.beside, ends.upstream);
    const double last = fmin(atan2(ends.beside, -ends.downstream), exit);
    far_value sum = load_between(rigid_approach, &ends, 0, first);

    add(&sum, load_between(rigid_approach, &ends, first, M_PI_2));
    add(&sum, load_between(rigid_approach, &ends, M_PI_2, last));
    add(&sum, load_between(rigid_approach, &ends, last, exit));
    return scaled(sum, 2 * contact->lambda * fabs(speed)); // on either side of Y = 0
}

contact_closure far_field_closure(const ehd_contact *contact, double rigid_approach) {
    contact_closure closure = contact->closure;
    const far_value load = scaled(far_field_load(contact, rigid_approach), closure.by_load);

    closure.by_approach += load.by_approach;
    closure.value -= load.value - load.by_approach * rigid_approach;
    return closure;
}

// ---- the boundary nodes

bool far_field_is_at(const ehd_grid *grid, size_t node) {
    const size_t width = grid_width(grid), column = node % width;

    return column == 0 || column + 1 == width || !grid_is_inner_line(grid, node / width);
}

void far_nodes_init(far_nodes *self, const ehd_grid *grid, const size_t *nodes, size_t num_nodes,
                    arena *memory) {
    const bool point = grid->inner_lines > 1;

    self->num = 0;
    for (size_t i = 0; i < num_nodes && point; i++)
        self->num += far_field_is_at(grid, nodes ? nodes[i] : i);
    self->index = arena_array(memory, self->num, sizeof *self->index);
    self->x = arena_array(memory, self->num, sizeof(double));
    self->y = arena_array(memory, self->num, sizeof(double));
    self->by_approach = arena_array(memory, num_nodes, sizeof(double));
    if (memory->failed) return;
    self->num = 0;
    for (size_t i = 0; i < num_nodes && point; i++) {
        const size_t node = nodes ? nodes[i] : i;
        if (!far_field_is_at(grid, node)) continue;
        self->index[self->num] = i;
        self->x[self->num] = grid_x(grid, node);
        self->y[self->num++] = grid_y(grid, node);
    }
}

void far_nodes_add(double *pressure, far_nodes *self, const ehd_contact *contact,
                   double rigid_approach) {
    const bool there = far_field_is_there(&contact->grid);

    for (size_t i = 0; i < self->num; i++) {
        far_value here = {0, 0};
        if (there) here = far_field_pressure(contact, rigid_approach, self->x[i], self->y[i]);
        pressure[self->index[i]] += here.value;
        self->by_approach[self->index[i]] = here.by_approach;
    }
}

void far_nodes_set_density(reynolds_fluid *fluid, const far_nodes *self) {
    for (size_t i = 0; i < self->num && fluid->density; i++) {
        fluid->density[self->index[i]] = 1;
        fluid->density_slope[self->index[i]] = 0;
    }
}
