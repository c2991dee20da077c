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
enum { NUM_GAUSS = FAR_RAYS / 4 };
static const double abscissa[NUM_GAUSS] = {0.06943184420297371, 0.33000947820757187,
                                           0.66999052179242813, 0.93056815579702629};
static const double weight[NUM_GAUSS] = {0.17392742256872693, 0.32607257743127307,
                                         0.32607257743127307, 0.17392742256872693};

/* Ends of what the sum over the inner nodes counts, half a step beyond them: against the flow,
 * with it, and beside. */
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

/* Adds the directions between two angles. */
static void add_rays(far_rays *self, const inner_ends *ends, double from, double to) {
    for (int i = 0; i < NUM_GAUSS; i++) {
        const double phi = from + abscissa[i] * (to - from);
        const double along = cos(phi) > 0 ? ends->upstream : ends->downstream;
        const double end = fmin(along / fabs(cos(phi)), ends->beside / sin(phi));
        self->inverse_end[self->num] = 1 / end;
        self->weight[self->num++] = weight[i] * (to - from) * shape(phi);
    }
}

/* Those of an entrainment towards larger X, or `backwards`. */
static far_rays rays_of(const ehd_grid *grid, bool backwards) {
    const inner_ends ends = ends_of(grid, backwards);
    const double exit = exit_angle();
    // smooth between the corners
    const double first = atan2(ends.beside, ends.upstream);
    const double last = fmin(atan2(ends.beside, -ends.downstream), exit);
    far_rays self = {.num = 0};

    add_rays(&self, &ends, 0, first);
    add_rays(&self, &ends, first, M_PI_2);
    add_rays(&self, &ends, M_PI_2, last);
    add_rays(&self, &ends, last, exit);
    return self;
}

/* Of each ray the integral of r^2/(2H)^2 dr from its end on, with s = end/r. */
static far_value load_on(const far_rays *rays, const ehd_contact *contact, double rigid_approach) {
    far_value sum = {0, 0};

    for (size_t k = 0; k < rays->num; k++)
        for (int i = 0; i < NUM_GAUSS; i++)
            add(&sum, over_square(rays->weight[k] * weight[i] * rays->inverse_end[k],
                                  film_ratio(rigid_approach, abscissa[i] * rays->inverse_end[k])));
    // on either side of Y = 0
    return scaled(sum, 2 * contact->lambda * fabs(contact->far_speed));
}

far_value far_field_load(const ehd_contact *contact, double rigid_approach) {
    if (!far_field_is_there(&contact->grid)) return (far_value){0, 0};
    const far_rays rays = rays_of(&contact->grid, contact->far_speed < 0);

    return load_on(&rays, contact, rigid_approach);
}

// ---- prepared for many states

bool far_field_is_at(const ehd_grid *grid, size_t node) {
    const size_t width = grid_width(grid), column = node % width;

    return column == 0 || column + 1 == width || !grid_is_inner_line(grid, node / width);
}

void far_field_init(far_field *self, const ehd_grid *grid, const size_t *nodes, size_t num_nodes,
                    arena *memory) {
    const bool point = grid->inner_lines > 1;

    self->num = 0;
    for (size_t i = 0; i < num_nodes && point; i++)
        self->num += far_field_is_at(grid, nodes ? nodes[i] : i);
    self->index = arena_array(memory, self->num, sizeof *self->index);
    self->inverse = arena_array(memory, self->num, sizeof(double));
    self->by_approach = arena_array(memory, num_nodes, sizeof(double));
    for (int backwards = 0; backwards < 2; backwards++) {
        self->shape[backwards] = arena_array(memory, self->num, sizeof(double));
        if (point) self->rays[backwards] = rays_of(grid, backwards);
    }
    if (memory->failed) return;
    self->num = 0;
    for (size_t i = 0; i < num_nodes && point; i++) {
        const size_t node = nodes ? nodes[i] : i, k = self->num;
        if (!far_field_is_at(grid, node)) continue;
        const double x = grid_x(grid, node), y = grid_y(grid, node);
        self->index[k] = i;
        self->inverse[k] = 1 / hypot(x, y);
        self->shape[0][k] = shape(atan2(fabs(y), -x));
        self->shape[1][k] = shape(atan2(fabs(y), x));
        self->num++;
    }
}

void far_field_add(double *pressure, far_field *self, const ehd_contact *contact,
                   double rigid_approach) {
    const bool there = far_field_is_there(&contact->grid);
    const double *shapes = self->shape[contact->far_speed < 0];
    const double factor = contact->lambda * fabs(contact->far_speed);

    for (size_t i = 0; i < self->num; i++) {
        const double inverse = self->inverse[i];
        far_value here = {0, 0};
        if (there)
            here = over_square(factor * shapes[i] * inverse * inverse * inverse,
                               film_ratio(rigid_approach, inverse));
        pressure[self->index[i]] += here.value;
        self->by_approach[self->index[i]] = here.by_approach;
    }
}

contact_closure far_field_closure(const far_field *self, const ehd_contact *contact,
                                  double rigid_approach) {
    contact_closure closure = contact->closure;

    if (!far_field_is_there(&contact->grid)) return closure;
    const far_value load = scaled(
        load_on(&self->rays[contact->far_speed < 0], contact, rigid_approach), closure.by_load);
    closure.by_approach += load.by_approach;
    closure.value -= load.value - load.by_approach * rigid_approach;
    return closure;
}

void far_field_set_density(reynolds_fluid *fluid, const far_field *self) {
    for (size_t i = 0; i < self->num && fluid->density; i++) {
        fluid->density[self->index[i]] = 1;
        fluid->density_slope[self->index[i]] = 0;
    }
}
