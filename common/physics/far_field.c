/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/physics/far_field.h"

#include "common/algebra/gauss.h"
#include <math.h>

bool far_field_is_there(const ehd_grid *grid) {
    return grid->inner_lines > 1 && grid->boundary == BOUNDARY_OPEN;
}

/* A place far from the contact: its distance, in half widths along the entrainment, and its
 * direction phi, measured from the side on which the fluid enters. */
typedef struct far_place {
    double distance;
    double per_rise; // 1/q
    double phi;
} far_place;

static far_place place_at(const contact_shape *shape, double upstream, double y) {
    const double across = shape->ellipticity * y, phi = atan2(fabs(across), upstream);

    return (far_place){hypot(upstream, across), 1 / far_angle_rise(&shape->far, phi), phi};
}

/* Returns the film divided by q r^2/2, and the derivative of this ratio with respect to the rigid
 * approach. `inverse` is 1/r. The deflection is (2/(pi^2 compliance)) (2 pi/3)/r. */
static far_value film_ratio(double rigid_approach, double inverse, double per_rise,
                            const contact_shape *shape) {
    const double square = inverse * inverse * per_rise;
    const double deflection = 4 / (3 * M_PI * shape->compliance) * inverse;

    return (far_value){1 + 2 * square * (rigid_approach + deflection), 2 * square};
}

double far_field_film(const contact_shape *shape, double rigid_approach, double x, double y) {
    const far_place at = place_at(shape, x, y);

    return at.distance * at.distance / 2 / at.per_rise *
           film_ratio(rigid_approach, 1 / at.distance, at.per_rise, shape).value;
}

/* Returns factor/film^2 and its derivative with respect to the rigid approach. */
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
    const contact_shape *shape = &contact->grid.shape;
    const double speed = contact->far_speed;
    const far_place at = place_at(shape, speed < 0 ? x : -x, y);
    const double inverse = 1 / at.distance;
    const double factor = contact->lambda * fabs(speed) * far_angle_shape(&shape->far, at.phi);

    return over_square(factor * inverse * inverse * inverse,
                       film_ratio(rigid_approach, inverse, at.per_rise, shape));
}

// ---- the load beyond the grid

_Static_assert(FAR_RAYS == 4 * GAUSS_4, "Gauss' rule in each of four parts");

/* Distances from the centre to the edges of the region of inner cells, half a grid step beyond the
 * outermost inner nodes: upstream, downstream and to the side. Unit: half widths along the
 * entrainment. */
typedef struct inner_ends {
    double upstream, downstream, beside;
} inner_ends;

static inner_ends ends_of(const ehd_grid *grid, bool backwards) {
    const double half = grid->step / 2;
    const grid_extent extent = grid_extent_of(grid);
    const double to_smaller = half - extent.x_min, to_larger = half + extent.x_max;

    return (inner_ends){backwards ? to_larger : to_smaller, backwards ? to_smaller : to_larger,
                        grid->shape.ellipticity * (half * grid->shape.cell + extent.y_max)};
}

/* Adds the rays between two values of the stretched angle (far_angle_stretched). */
static void add_rays(far_rays *self, const inner_ends *ends, const far_angle *far, double from,
                     double to) {
    if (to <= from) return; // no rays in this range
    for (int i = 0; i < GAUSS_4; i++) {
        double slope;
        const double phi = far_angle_direction(far, from + gauss_4_place[i] * (to - from), &slope);
        const double along = cos(phi) > 0 ? ends->upstream : ends->downstream;
        const double end = fmin(along / fabs(cos(phi)), ends->beside / sin(phi));
        self->inverse_end[self->num] = 1 / end;
        self->per_rise[self->num] = 1 / far_angle_rise(far, phi);
        self->upstream[self->num] = cos(phi);
        self->angle[self->num] = gauss_4_weight[i] * ((to - from) * slope);
        self->weight[self->num] = self->angle[self->num] * far_angle_shape(far, phi);
        self->num++;
    }
}

/* Returns the rays for entrainment towards larger X, or, if `backwards`, towards smaller X. */
static far_rays rays_of(const ehd_grid *grid, bool backwards) {
    const inner_ends ends = ends_of(grid, backwards);
    const far_angle *far = &grid->shape.far;
    const double exit = far_angle_stretched(far, far->exit);
    // the angles of the corners of the grid; the integrand is smooth between them
    const double first = far_angle_stretched(far, atan2(ends.beside, ends.upstream));
    const double last = fmin(far_angle_stretched(far, atan2(ends.beside, -ends.downstream)), exit);
    far_rays self = {.num = 0};

    add_rays(&self, &ends, far, 0, first);
    add_rays(&self, &ends, far, first, M_PI_2);
    add_rays(&self, &ends, far, M_PI_2, last);
    add_rays(&self, &ends, far, last, exit);
    return self;
}

/* Returns the load beyond the inner nodes. Along each ray, integrates r^2/(2H/q)^2 dr from the end
 * of the grid to infinity. The variable of integration is s = end/r. */
static far_value load_on(const far_rays *rays, const ehd_contact *contact, double rigid_approach) {
    const contact_shape *shape = &contact->grid.shape;
    far_value sum = {0, 0};

    for (size_t k = 0; k < rays->num; k++)
        for (int i = 0; i < GAUSS_4; i++)
            add(&sum,
                over_square(rays->weight[k] * gauss_4_weight[i] * rays->inverse_end[k],
                            film_ratio(rigid_approach, gauss_4_place[i] * rays->inverse_end[k],
                                       rays->per_rise[k], shape)));
    // factor 2: the rays cover one side of Y = 0. Ellipticity: converts areas to units of X and Y
    return scaled(sum, 2 * contact->lambda * fabs(contact->far_speed) / shape->ellipticity);
}

far_value far_field_load(const ehd_contact *contact, double rigid_approach) {
    if (!far_field_is_there(&contact->grid)) return (far_value){0, 0};
    const far_rays rays = rays_of(&contact->grid, contact->far_speed < 0);

    return load_on(&rays, contact, rigid_approach);
}

// ---- traction beyond the grid

/* Returns the r at which the gap has a slope of 1 in metres per metre, R_x/a in the units of the
 * grid. If this r lies within the grid, returns the r at which the cells of the grid end. */
static double rim_of(const far_rays *rays, size_t ray, const ehd_contact *contact) {
    const double along = rays->upstream[ray], across = sqrt(fmax(0, 1 - along * along));
    const double slope = hypot(along, contact->grid.shape.far.ratio * across);

    return fmax(contact->radius / contact->half_width / slope, 1 / rays->inverse_end[ray]);
}

/* Adds the integrals along one ray, from the end of the grid to the rim of the film: the moment of
 * the pressure, and the shear stress. The variable of integration is ln r. */
static void add_ray(traction_sums *sums, const far_rays *rays, size_t ray,
                    const ehd_contact *contact, double rigid_approach) {
    const contact_shape *shape = &contact->grid.shape;
    const double factor = contact->lambda * fabs(contact->entrainment);
    const double inverse_end = rays->inverse_end[ray], per_rise = rays->per_rise[ray];
    const double rim = rim_of(rays, ray, contact), length = log(rim * inverse_end);
    // int P r^2 dr is int P r^3 d(ln r). The pressure P at the rim is subtracted everywhere; its
    // integral from 0 to the rim is P r^3/3
    const double moment = factor * rays->weight[ray] * rays->upstream[ray];

    sums->rolling -=
        over_square(moment, film_ratio(rigid_approach, 1 / rim, per_rise, shape)).value / 3;
    for (int i = 0; i < GAUSS_4; i++) {
        const double inverse = inverse_end * exp(-gauss_4_place[i] * length);
        const far_value ratio = film_ratio(rigid_approach, inverse, per_rise, shape);
        const double film = ratio.value / (2 * inverse * inverse * per_rise);
        const double pressure =
            over_square(factor * rays->weight[ray] / rays->angle[ray], ratio).value * inverse *
            inverse * inverse;
        sums->rolling += gauss_4_weight[i] * length * over_square(moment, ratio).value;
        sums->friction += gauss_4_weight[i] * length / (inverse * inverse) * rays->angle[ray] *
                          contact_shear_stress(contact, pressure, film, 0);
    }
}

traction_sums far_field_traction(const ehd_contact *contact, double rigid_approach) {
    traction_sums sums = {0};
    const bool backwards = contact->entrainment < 0;

    if (!far_field_is_there(&contact->grid) || contact->entrainment == 0) return sums;
    const far_rays rays = rays_of(&contact->grid, backwards);
    for (size_t k = 0; k < rays.num; k++)
        add_ray(&sums, &rays, k, contact, rigid_approach);
    // factor 2: the rays cover one side of Y = 0. Ellipticity: converts areas to units of X and Y
    const double areas = 2 / contact->grid.shape.ellipticity;
    sums.rolling *= backwards ? -areas : areas;
    sums.friction *= areas;
    return sums;
}

double far_field_rolling_error(const ehd_contact *contact, double rigid_approach) {
    const contact_shape *shape = &contact->grid.shape;
    const far_rays rays = rays_of(&contact->grid, contact->entrainment < 0);
    double sum = 0;

    for (size_t k = 0; k < rays.num; k++) {
        const double inverse = rays.inverse_end[k], per_rise = rays.per_rise[k];
        const double deflection = 4 / (3 * M_PI * shape->compliance) * inverse;
        const far_value with = film_ratio(rigid_approach, inverse, per_rise, shape);
        const far_value without = film_ratio(rigid_approach - deflection, inverse, per_rise, shape);
        const double moment = rays.weight[k] * rays.upstream[k];
        sum += over_square(moment, without).value - over_square(moment, with).value;
    }
    return fabs(sum) * 2 * contact->lambda * fabs(contact->entrainment) / shape->ellipticity;
}

// ---- far field prepared for many states

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
    self->per_rise = arena_array(memory, self->num, sizeof(double));
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
        const contact_shape *shape = &grid->shape;
        const double x = grid_x(grid, node), y = grid_y(grid, node);
        const far_place at = place_at(shape, -x, y);
        self->index[k] = i;
        self->inverse[k] = 1 / at.distance;
        self->per_rise[k] = at.per_rise;
        self->shape[0][k] = far_angle_shape(&shape->far, at.phi);
        self->shape[1][k] = far_angle_shape(&shape->far, place_at(shape, x, y).phi);
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
            here = over_square(
                factor * shapes[i] * inverse * inverse * inverse,
                film_ratio(rigid_approach, inverse, self->per_rise[i], &contact->grid.shape));
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
