/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/physics/contact.h"

#include "common/algebra/rounding.h"
#include "common/physics/film_formulas.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// ---- line contact

/* Returns x (ln|x| - 1), whose derivative is ln|x|. */
static double line_primitive(double x) {
    return x == 0 ? 0 : x * (log(fabs(x)) - 1);
}

/* Returns -(1/2pi) int ln(X'^2) dX' over the cell (README.md, deflection). */
static double line_kernel(const contact_shape *shape, double distance, double y, double step) {
    (void)shape;
    (void)y;
    return -(line_primitive(distance + step / 2) - line_primitive(distance - step / 2)) / M_PI;
}

static double line_lambda(const contact_shape *shape, double moes_M) {
    (void)shape;
    return 3 * M_PI * M_PI / (8 * moes_M * moes_M);
}

static double line_moes_M(const contact_shape *shape, double lambda) {
    (void)shape;
    return sqrt(3 * M_PI * M_PI / (8 * lambda));
}

static double line_alpha_p_H(const contact_shape *shape, double moes_M, double moes_L) {
    (void)shape;
    return moes_L * sqrt(moes_M / (2 * M_PI));
}

/* Returns (x sqrt(x^2 - 1) - acosh(x))/2 (K. L. Johnson, Contact Mechanics, 1985, section 4.2). */
static double line_dry_gap(const contact_shape *shape, double x) {
    (void)shape;
    return 0.5 * (fabs(x) * sqrt(x * x - 1) - acosh(fabs(x)));
}

/* Returns ln(half_width/length)/2. In eq. 4 of Maier et al. the deflection is relative to a point
 * that is one current half width away. For a point at a fixed distance, the constant of this
 * equation changes with the half width (README.md, approach). */
static double line_approach_shift(double half_width, double length) {
    return 0.5 * log(half_width / length);
}

static double line_central_film(const contact_shape *shape, double moes_M, double moes_L) {
    (void)shape;
    return film_moes(moes_M, moes_L);
}

static double line_physical_M(double load_number, double speed_number) {
    return load_number / sqrt(speed_number);
}

static double line_half_width(const contact_shape *shape, double load, double radius,
                              double modulus) {
    (void)shape;
    return sqrt(8 * load * radius / (M_PI * modulus));
}

const contact_kind contact_line = {
    .name = "line",
    .dimensions = 1,
    .load = M_PI_2,
    .kernel = line_kernel,
    .lambda = line_lambda,
    .moes_M = line_moes_M,
    .alpha_p_H = line_alpha_p_H,
    .central_film = line_central_film,
    .dry_gap = line_dry_gap,
    .approach_shift = line_approach_shift,
    .physical_M = line_physical_M,
    .half_width = line_half_width,
};

// ---- ellipse, and the point contact with b/a = 1 (README.md, Elliptical contacts)

/* Returns the integral of 1/r over the rectangle [0, a] x [0, b]: a asinh(b/a) + b asinh(a/b). */
static double point_primitive(double a, double b) {
    if (a == 0 || b == 0) return 0;
    return a * asinh(b / fabs(a)) + b * asinh(a / fabs(b));
}

/* Distance beyond which a series replaces the closed form, in side lengths of the cell. The closed
 * form takes thirty times as long. At 40 side lengths the truncation error of the series is below
 * 1e-12 of the integral. At 10 side lengths the error is too large (test_ellipse.c,
 * kernel_is_the_integral_over_a_cell). */
static const double FAR_CELL = 40;

/* Returns the integral of 1/r over a distant square cell, by a multipole expansion up to the fourth
 * moments of the cell. */
static double far_cell(double x, double y, double step) {
    double square = x * x + y * y, cell = step * step, small = cell / square;
    double fourth = (105 * (x * x * x * x + y * y * y * y) / (square * square) - 72) / 1920 +
                    (105 * x * x * y * y / (square * square) - 12) / 576;

    return cell / sqrt(square) * (1 + small * (1. / 24 + small * fourth));
}

/* Returns the integral of 1/r over a distant rectangular cell, by the expansion of far_cell. */
static double far_rectangle(double x, double y, double along, double across) {
    const double square = x * x + y * y, u = x * x / square, v = y * y / square;
    const double a = along * along / square, b = across * across / square;
    const double second = (a * (3 * u - 1) + b * (3 * v - 1)) / 24;
    const double fourth =
        (a * a * (105 * u * u - 90 * u + 9) + b * b * (105 * v * v - 90 * v + 9)) / 1920 +
        a * b * (105 * u * v - 12) / 576;

    return along * across / sqrt(square) * (1 + second + fourth);
}

/* Returns (2/pi^2) iint 1/r over the cell (README.md, deflection). For an ellipse the cell is a
 * rectangle, and the factor is also divided by compliance * k. */
static double point_kernel(const contact_shape *shape, double x, double lines, double step) {
    const double k = shape->ellipticity, y = k * lines, width = k * (shape->cell * step);
    const double of_circle = 2 / (M_PI * M_PI), side = width > step ? width : step;
    const double scale = k == 1 ? of_circle : of_circle / (shape->compliance * k);

    if (x * x + y * y > FAR_CELL * FAR_CELL * side * side)
        return scale * (k == 1 ? far_cell(x, y, step) : far_rectangle(x, y, step, width));
    double left = x - step / 2, right = x + step / 2, low = y - width / 2, high = y + width / 2;

    return scale * (point_primitive(right, high) - point_primitive(left, high) -
                    point_primitive(right, low) + point_primitive(left, low));
}

static double point_lambda(const contact_shape *shape, double moes_M) {
    return cbrt(128 * M_PI * M_PI * M_PI / (3 * pow(moes_M, 4))) * shape->ellipticity /
           cbrt(shape->compliance);
}

static double point_moes_M(const contact_shape *shape, double lambda) {
    const double of_circle = lambda * cbrt(shape->compliance) / shape->ellipticity;

    return pow(128 * M_PI * M_PI * M_PI / (3 * of_circle * of_circle * of_circle), 0.25);
}

static double point_alpha_p_H(const contact_shape *shape, double moes_M, double moes_L) {
    const double compliance = shape->compliance;

    return moes_L / M_PI * cbrt(1.5 * moes_M) /
           (shape->ellipticity * cbrt(compliance * compliance));
}

/* Returns 0, because the approach is measured from infinity, where the kernel is zero. */
static double point_approach_shift(double half_width, double length) {
    (void)half_width;
    (void)length;
    return 0;
}

/* Returns ((x^2 - 2) acos(1/x) + sqrt(x^2 - 1))/pi for a circle (Johnson, section 3.4). */
static double point_dry_gap(const contact_shape *shape, double x) {
    if (shape->ellipticity != 1) return ellipse_dry_gap(shape, x);
    return ((x * x - 2) * acos(1 / fabs(x)) + sqrt(x * x - 1)) / M_PI;
}

/* Estimates H at the centre by a fit for R_y >= R_x. For a narrow ellipse (k < 1) the fit gives as
 * little as half of the film, and Newton's iteration does not converge from such a thin film. The
 * estimate for a narrow ellipse is therefore the thicker film of the circle with the same Hertz
 * pressure, R_x and L. The radius of that circle is a/(k compliance). */
static double point_central_film(const contact_shape *shape, double moes_M, double moes_L) {
    // ratio: a over the radius of the circle with the same Hertz pressure. width: a over the radius
    // of the circle with the same load
    const double k = shape->ellipticity, ratio = k * shape->compliance;
    const double width = cbrt(shape->compliance);

    if (k < 1) return film_nijenbanning(moes_M / (k * ratio * ratio), moes_L) / (ratio * ratio);
    return film_nijenbanning_ellipse(moes_M, moes_L, k * k / shape->gap_across) /
           (pow(1.5 * moes_M, 2. / 3) * width * width);
}

static double point_physical_M(double load_number, double speed_number) {
    return load_number / pow(speed_number, 0.75);
}

static double point_half_width(const contact_shape *shape, double load, double radius,
                               double modulus) {
    return cbrt(3 * load * radius / (2 * modulus)) * cbrt(shape->compliance);
}

#define POINT_FUNCTIONS                                                                            \
    .dimensions = 2, .load = 2 * M_PI / 3, .kernel = point_kernel, .lambda = point_lambda,         \
    .moes_M = point_moes_M, .alpha_p_H = point_alpha_p_H, .central_film = point_central_film,      \
    .dry_gap = point_dry_gap, .approach_shift = point_approach_shift,                              \
    .physical_M = point_physical_M, .half_width = point_half_width

const contact_kind contact_point = {.name = "point", POINT_FUNCTIONS};
const contact_kind contact_ellipse = {.name = "ellipse", POINT_FUNCTIONS};

const contact_kind *contact_kind_find(const char *name) {
    static const contact_kind *const kinds[] = {&contact_line, &contact_point, &contact_ellipse};

    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        if (strcmp(kinds[i]->name, name) == 0) return kinds[i];
    return NULL;
}

// ---- names of discretisations, boundary conditions and transports

const char *const discretization_names[] = {[DISCRETIZATION_PUBLISHED] = "published",
                                            [DISCRETIZATION_ACCURATE] = "accurate",
                                            [DISCRETIZATION_CROSS_FLUX] = "cross-flux",
                                            NULL};
const char *const boundary_names[] = {[BOUNDARY_ZERO] = "zero", [BOUNDARY_OPEN] = "open", NULL};
const char *const transport_names[] = {
    [TRANSPORT_UPWIND] = "upwind", [TRANSPORT_PATH] = "path", NULL};

bool name_find(unsigned *index, const char *const *names, const char *name) {
    unsigned i = 0;

    while (names[i] && strcmp(names[i], name) != 0)
        i++;
    *index = names[i] ? i : 0;
    return names[i];
}

ehd_status discretization_check_in_time(ehd_discretization discretization, ehd_error *error) {
    if (discretization != DISCRETIZATION_CROSS_FLUX) return EHD_OK;
    return ehd_fail(error, EHD_DATA, "discretization: found %s in time, expected %s|%s",
                    discretization_names[discretization],
                    discretization_names[DISCRETIZATION_ACCURATE],
                    discretization_names[DISCRETIZATION_PUBLISHED]);
}

ehd_status carriage_check(const ehd_carriage *found, const char *found_in,
                          const ehd_carriage *expected, const char *expected_in, ehd_error *error) {
    const char *in = found_in ? found_in : "", *colon = found_in ? ": " : "";

    if (found->transport != expected->transport)
        return ehd_fail(error, EHD_DATA, "%s%stransport: found %s, expected %s, as in %s", in,
                        colon, transport_names[found->transport],
                        transport_names[expected->transport], expected_in);
    // The default smoothing depends on the step of a grid, which has round-off. isgreater is
    // false if either value is NaN.
    if (isgreater(fabs(found->smoothing - expected->smoothing), ROUNDING))
        return ehd_fail(error, EHD_DATA, "%s%stransient.smoothing: found %g, expected %g, as in %s",
                        in, colon, found->smoothing, expected->smoothing, expected_in);
    return EHD_OK;
}

// ---- any contact

double contact_gap(const contact_shape *shape, double x, double y) {
    return (x * x + shape->gap_across * (y * y)) / 2;
}

ehd_grid grid_of(double x_min, double step, size_t inner_x, size_t inner_lines, bool half,
                 ehd_discretization discretization) {
    ehd_grid grid = {.x_min = x_min,
                     .step = step,
                     .inner_x = inner_x,
                     .inner_lines = inner_lines,
                     .half = half,
                     .num_inner = inner_x * inner_lines,
                     .discretization = discretization,
                     .shape = shape_round};

    grid.num_nodes = grid_width(&grid) * grid_lines(&grid);
    return grid;
}

ehd_grid grid_like(const ehd_grid *grid, double x_min, double step, size_t inner_x,
                   size_t inner_lines) {
    ehd_grid other = grid_of(x_min, step, inner_x, inner_lines, grid->half, grid->discretization);

    other.boundary = grid->boundary;
    other.shape = grid->shape;
    return other;
}

size_t grid_width(const ehd_grid *grid) {
    return grid->inner_x + 2;
}

size_t grid_first_line(const ehd_grid *grid) {
    return grid->inner_lines > 1 && !grid->half;
}

size_t grid_lines(const ehd_grid *grid) {
    return grid_first_line(grid) + grid->inner_lines + (grid->inner_lines > 1);
}

bool grid_is_inner_line(const ehd_grid *grid, size_t line) {
    return line >= grid_first_line(grid) && line < grid_first_line(grid) + grid->inner_lines;
}

size_t grid_central_line(const ehd_grid *grid) {
    return (grid_first_line(grid) + (grid->half ? 0 : grid->inner_lines / 2)) * grid_width(grid);
}

double grid_step_across(const ehd_grid *grid) {
    return grid->step * grid->shape.cell;
}

double grid_x(const ehd_grid *grid, size_t node) {
    size_t column = grid->inner_lines > 1 ? node % grid_width(grid) : node;

    return grid->x_min + ((double)column - 1) * grid->step;
}

double grid_y(const ehd_grid *grid, size_t node) {
    if (grid->inner_lines == 1) return 0;
    double line = (double)(node / grid_width(grid));
    return grid_step_across(grid) *
           (grid->half ? line : line - ((double)grid->inner_lines + 1) / 2);
}

double grid_gap(const ehd_grid *grid, size_t node) {
    return contact_gap(&grid->shape, grid_x(grid, node), grid_y(grid, node));
}

double grid_square_distance(const ehd_grid *grid, size_t node) {
    const double x = grid_x(grid, node), y = grid_y(grid, node);

    return x * x + y * y;
}

bool grid_is_dry(const ehd_grid *grid, size_t node) {
    return grid_square_distance(grid, node) <= 1;
}

double grid_dry_share(const ehd_grid *grid, size_t node) {
    const double x = fabs(grid_x(grid, node)), y = fabs(grid_y(grid, node)), r = hypot(x, y);
    const double width =
        r > 0 ? (x * grid->step + y * grid_step_across(grid)) / r : grid->step; // along the radius

    return fmin(fmax(0.5 + (1 - r) / width, 0), 1);
}

size_t grid_node_of_row(const ehd_grid *grid, size_t row) {
    if (grid->inner_lines == 1) return row + 1;
    return (row / grid->inner_x + grid_first_line(grid)) * grid_width(grid) + row % grid->inner_x +
           1;
}

size_t grid_row_of_node(const ehd_grid *grid, size_t node) {
    if (grid->inner_lines == 1) return node - 1;
    return (node / grid_width(grid) - grid_first_line(grid)) * grid->inner_x +
           node % grid_width(grid) - 1;
}

ehd_grid grid_whole(const ehd_grid *grid) {
    size_t lines = grid->half ? 2 * grid->inner_lines - 1 : grid->inner_lines;

    ehd_grid like = *grid;

    like.half = false;
    return grid_like(&like, grid->x_min, grid->step, grid->inner_x, lines);
}

size_t grid_row_of_whole(const ehd_grid *grid, size_t row) {
    size_t line = row / grid->inner_x, central = grid->inner_lines - 1;

    if (!grid->half) return row;
    line = line > central ? line - central : central - line;
    return line * grid->inner_x + row % grid->inner_x;
}

void grid_exit_columns(size_t *columns, const double *pressure, const ehd_grid *grid) {
    size_t width = grid_width(grid);

    for (size_t l = 0; l < grid_lines(grid); l++) {
        columns[l] = width - 1;
        while (columns[l] > 1 && !(pressure[l * width + columns[l] - 1] > 0))
            columns[l]--;
    }
}

void grid_exits(double *positions, const size_t *columns, const ehd_grid *grid) {
    const ehd_grid whole = grid_whole(grid);
    const size_t *inner = columns + grid_first_line(grid);

    for (size_t l = 0; l < whole.inner_lines; l++) {
        size_t own = grid_row_of_whole(grid, l * grid->inner_x) / grid->inner_x;
        positions[l] = inner[own] > 1 ? grid_x(grid, inner[own]) : NAN;
    }
}

double grid_weight(const ehd_grid *grid, size_t node) {
    return grid->half && node >= grid_width(grid) ? 2 : 1;
}

double grid_cell(const ehd_grid *grid) {
    return grid->inner_lines > 1 ? grid->step * grid_step_across(grid) : grid->step;
}

double grid_load_weight(const ehd_grid *grid, size_t node) {
    return grid_cell(grid) * grid_weight(grid, node);
}

static bool is_given_as(double given, double found, double step) {
    return isnan(given) || fabs(given - found) <= ROUNDING * step;
}

grid_extent grid_extent_of(const ehd_grid *grid) {
    const size_t beside = grid->half ? grid->inner_lines - 1 : grid->inner_lines / 2;

    return (grid_extent){.x_min = grid->x_min,
                         .x_max = grid->x_min + (double)(grid->inner_x - 1) * grid->step,
                         .step = grid->step,
                         .y_max =
                             grid->inner_lines > 1 ? (double)beside * grid_step_across(grid) : NAN};
}

/* Checks whether a grid has the given ends and step, to 1e-9 of a step. NaN agrees with any value.
 * The sides of the grid may lie outside of y_max by less than a grid step, because grid_choose
 * moves them outwards until a whole number of steps fits. */
static bool grid_has(const ehd_grid *grid, const grid_extent *given) {
    const grid_extent found = grid_extent_of(grid);
    const double trifle = ROUNDING * grid->step;

    return is_given_as(given->x_min, found.x_min, grid->step) &&
           is_given_as(given->x_max, found.x_max, grid->step) &&
           is_given_as(given->step, found.step, grid->step) &&
           (isnan(given->y_max) || (found.y_max >= given->y_max - trifle &&
                                    found.y_max < given->y_max + grid_step_across(grid) - trifle));
}

bool grid_same(const ehd_grid *a, const ehd_grid *b) {
    const double slack = ROUNDING * b->step;

    return a->discretization == b->discretization && a->boundary == b->boundary &&
           shape_same(&a->shape, &b->shape) && a->inner_x == b->inner_x &&
           a->inner_lines == b->inner_lines && a->half == b->half &&
           fabs(a->x_min - b->x_min) <= slack && fabs(a->step - b->step) <= slack;
}

/* Checks that the viscosity is within 1 % of the law's viscosity at the temperature of the
 * lubricant. If the law contains no viscosity, the scene must give one. */
static ehd_status check_viscosity(double viscosity, const ehd_lubricant *lubricant,
                                  ehd_error *error) {
    const double eta0 = lubricant->eta0; // NaN: the law contains no viscosity
    char where[48] = "";

    if (isnan(eta0) ? !isnan(viscosity) : fabs(viscosity - eta0) <= 0.01 * eta0) return EHD_OK;
    if (isnan(eta0))
        return ehd_fail(error, EHD_DATA,
                        "physical.viscosity: found nothing, expected a value with the law %s",
                        lubricant->viscosity->name);
    if (!isnan(lubricant->temperature))
        snprintf(where, sizeof where, " and the temperature of %g degC", lubricant->temperature);
    return ehd_fail(error, EHD_DATA,
                    "physical.viscosity: found %g, expected %.6g Pa s, the lubricant's own at "
                    "zero pressure%s, within 1 %%, or nothing",
                    viscosity, eta0, where);
}

/* Computes Moes numbers and scales from load, radius, speed, modulus and viscosity. */
static ehd_status contact_from_physical(ehd_contact *contact, const contact_settings *given,
                                        ehd_error *error) {
    const double viscosity = isnan(given->viscosity) ? contact->lubricant.eta0 : given->viscosity;
    ehd_status status = check_viscosity(viscosity, &contact->lubricant, error);

    if (status) return status;
    double sum_speed = 2 * given->speed;
    double speed_number = viscosity * sum_speed / (given->modulus * given->radius);
    double load_number =
        given->load / (given->modulus * pow(given->radius, contact->kind->dimensions));
    contact->moes_M = contact->kind->physical_M(load_number, speed_number);
    contact->moes_L = contact->lubricant.alpha * given->modulus * pow(speed_number, 0.25);
    contact->load = given->load;
    contact->radius = given->radius;
    contact->speed = given->speed;
    contact->modulus = given->modulus;
    contact->viscosity = viscosity;
    contact->half_width =
        contact->kind->half_width(&contact->grid.shape, given->load, given->radius, given->modulus);
    return EHD_OK;
}

/* Checks that a scene with a thermal conductivity gives all data for the inlet heating factor. */
static ehd_status check_heating(const ehd_contact *contact, ehd_error *error) {
    if (isnan(contact->lubricant.thermal_conductivity)) return EHD_OK;
    if (isnan(contact->speed))
        return ehd_fail(error, EHD_DATA,
                        "lubricant.thermal_conductivity: found a value with moes, expected it with "
                        "physical, whose speed heats the inlet");
    if (isnan(contact->lubricant.temperature_coefficient))
        return ehd_fail(error, EHD_DATA,
                        "lubricant.viscosity.temperature_coefficient: found nothing, expected a "
                        "value with lubricant.thermal_conductivity");
    return EHD_OK;
}

/* Returns the shape of an ellipse from its radii or its ellipticity. For the other kinds of
 * contact, returns shape_round. */
static contact_shape shape_given(const contact_settings *given) {
    if (given->kind != &contact_ellipse) return shape_round;
    return shape_of(isnan(given->radius_across)
                        ? given->ellipticity
                        : ellipse_ellipticity(given->radius_across / given->radius));
}

static ehd_status check_shape(const contact_shape *shape, const contact_settings *given,
                              ehd_error *error) {
    const double found = shape->ellipticity;

    if (found >= MIN_ELLIPTICITY && found <= MAX_ELLIPTICITY) return EHD_OK;
    if (isnan(given->radius_across))
        return ehd_fail(error, EHD_DATA, "ellipticity: found %g, expected %g to %g", found,
                        MIN_ELLIPTICITY, MAX_ELLIPTICITY);
    return ehd_fail(error, EHD_DATA,
                    "physical.radius_across: found %g m, an ellipticity of %g, expected one of %g "
                    "to %g",
                    given->radius_across, found, MIN_ELLIPTICITY, MAX_ELLIPTICITY);
}

const double default_accuracy = 0.01, far_approach_length = 10;

ehd_status contact_init(ehd_contact *contact, const contact_settings *given, ehd_error *error) {
    const double default_length = given->approach_given ? far_approach_length : 1;

    *contact = (ehd_contact){
        .kind = given->kind,
        .grid = {.shape = shape_given(given)},
        .entrainment = 1,
        .far_speed = 1,
        .closure = contact_load_closure(given->kind),
        .approach_length = isnan(given->approach_length) ? default_length : given->approach_length,
        .half_width = NAN,
        .radius = NAN,
        .load = NAN,
        .speed = NAN,
        .modulus = NAN,
        .viscosity = NAN,
        .slide_roll = NAN};
    ehd_status status = check_shape(&contact->grid.shape, given, error);
    if (!status) status = lubricant_init(&contact->lubricant, &given->lubricant, error);
    if (status) return status;

    if (isnan(given->moes_M)) {
        status = contact_from_physical(contact, given, error);
        if (status) return status;
    } else {
        contact->moes_M = given->moes_M;
        contact->moes_L = given->moes_L;
    }
    status = check_heating(contact, error);
    if (status) return status;
    contact_set_moes(contact, contact->moes_M, contact->moes_L);
    // a given Hertz pressure overrides the pressure that L implies; L is then only reported
    if (!isnan(given->hertz_pressure)) {
        contact->hertz_pressure = given->hertz_pressure;
        contact->alpha_p_H = contact->lubricant.alpha * given->hertz_pressure;
    }
    return EHD_OK;
}

bool contact_has_chosen_grid(const ehd_contact *contact) {
    const grid_extent *given = &contact->grid_given;

    return isnan(given->x_min) || isnan(given->x_max) || isnan(given->step) ||
           (contact->kind->dimensions > 1 && isnan(given->y_max));
}

void contact_take_grid(ehd_contact *contact, const ehd_grid *grid) {
    const bool same_kind = (grid->inner_lines > 1) == (contact->kind->dimensions > 1) &&
                           grid->half == contact->grid.half;

    if (!contact_has_chosen_grid(contact) || !same_kind ||
        grid->discretization != contact->grid.discretization ||
        grid->boundary != contact->grid.boundary ||
        !shape_same(&grid->shape, &contact->grid.shape) || !grid_has(grid, &contact->grid_given))
        return;
    contact->grid = *grid;
    contact->grid_given = grid_extent_of(grid);
}

double contact_moes_L(const ehd_contact *contact) {
    return contact->alpha_p_H / contact->kind->alpha_p_H(&contact->grid.shape, contact->moes_M, 1);
}

void contact_set_moes(ehd_contact *contact, double moes_M, double moes_L) {
    contact->moes_M = moes_M;
    contact->moes_L = moes_L;
    contact->lambda = contact->kind->lambda(&contact->grid.shape, moes_M);
    contact->alpha_p_H = contact->kind->alpha_p_H(&contact->grid.shape, moes_M, moes_L);
    contact->hertz_pressure = contact->alpha_p_H / contact->lubricant.alpha;
}

ehd_status contact_check_approach(const ehd_contact *contact, ehd_error *error) {
    double min_length = 0.5 * contact->grid.step * (double)(contact->grid.num_inner - 1);

    if (contact->kind->dimensions > 1 || contact->approach_length >= min_length) return EHD_OK;
    return ehd_fail(
        error, EHD_DATA,
        "approach_length: found %g, expected at least %g, half the grid's length, where "
        "the approach is given",
        contact->approach_length, min_length);
}

contact_closure contact_load_closure(const contact_kind *kind) {
    return (contact_closure){.by_approach = 0, .by_load = 1, .value = kind->load};
}

double contact_half_width_across(const ehd_contact *contact) {
    return contact->half_width * contact->grid.shape.ellipticity;
}

double contact_film_scale(const ehd_contact *contact) {
    return contact->half_width * contact->half_width / contact->radius;
}

double contact_time_scale(const ehd_contact *contact) {
    return contact->half_width / contact->speed;
}
