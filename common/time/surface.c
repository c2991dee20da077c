/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/time/surface.h"

#include "common/algebra/rounding.h"
#include "common/algebra/spline.h"
#include "common/artefact/table.h"
#include "common/settings/unit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Longest movement of a surface in a time step, in units of `length` of the surface. With a dent
 * 0.05 deep the minimum film is then at worst 1.4 % off; without this limit it is 6.2 % off
 * (README.md, A surface that is not smooth; test_surface.c, steps_see_it_come). */
static const double PART_OF_LENGTH = 0.5;

/* Least number of grid steps in one wave. With four steps the smallest film is at most 0.3 % off,
 * with three 1.7 % (README.md, A surface that is not smooth; test_surface.c,
 * what_the_grid_does_not_see_is_refused). */
static const double STEPS_PER_WAVE = 4;

enum { MIN_ROWS = 3 };                                // least numbers of x in a line, and of lines
static const double MAX_X = 1e9, MIN_DISTANCE = 1e-9; // Bounds of a table's x, half widths

typedef struct surface_kind surface_kind;

/* Lengths are in reference half widths, heights in the reference film unit. x is measured from the
 * surface's position. */
struct ehd_surface {
    const surface_kind *kind;
    surface_settings given;
    bool is_half;           // only one half of the contact is solved
    double ellipticity;     // ellipticity of the contact; scales Y
    double *x, *y, *values; // [count], columns of a table; y NULL: heights depend on x alone
    size_t count, num_x, num_lines;
    spline **lines; // [num_lines]
    // largest and smallest x at which the surface is not smooth
    double front, rear;
    double length; // sqrt(largest height/largest curvature), the unit of PART_OF_LENGTH
};

/* A kind of surface: one row of the table `kinds`. */
struct surface_kind {
    const char *name;
    /* Scales lengths and heights by the factors, and sets front, rear and length. */
    ehd_status (*prepare)(ehd_surface *self, double of_length, double of_height, ehd_error *error);
    double (*height)(const ehd_surface *self, double x, double y);
};

// ---- waviness

/* Prepares a waviness. A moving waviness begins at its position and extends to infinity behind it.
 * A waviness at rest extends to infinity in both directions. */
static ehd_status prepare_sine(ehd_surface *self, double of_length, double of_height,
                               ehd_error *error) {
    (void)error;
    self->given.wavelength *= of_length;
    self->given.amplitude *= of_height;
    self->length = self->given.wavelength / (2 * M_PI);
    self->front = self->given.speed > 0 ? 0 : INFINITY;
    self->rear = self->given.speed < 0 ? 0 : -INFINITY;
    return EHD_OK;
}

/* Returns the height of a waviness. The amplitude of a moving waviness grows over the first
 * wavelength, with continuous slope and curvature. */
static double sine_height(const ehd_surface *self, double x, double y) {
    const surface_settings *given = &self->given;
    const double behind = (given->speed > 0 ? -x : x) / given->wavelength;
    const double part = given->speed == 0 ? 1 : fmin(fmax(behind, 0), 1);
    (void)y;

    return given->amplitude * part * part * part * (10 - part * (15 - 6 * part)) *
           sin(2 * M_PI * x / given->wavelength + given->phase);
}

// ---- dent

/* Source: Mourier et al., as below. End of the dent, in radii: the second zero of the cosine.
 * Beyond this end the height would be below 2e-8 of the depth. */
static const double DENT_ENDS = 3.6;

static ehd_status prepare_dent(ehd_surface *self, double of_length, double of_height,
                               ehd_error *error) {
    const double width = 1.2; // Source: Mourier et al., as below
    (void)error;
    self->given.radius *= of_length;
    self->given.depth *= of_height;
    self->front = DENT_ENDS * self->given.radius;
    self->rear = -self->front;
    // the curvature in the middle is depth/r^2 ((pi/2)^2 + 4) with r = 1.2 radius
    self->length = width * self->given.radius / sqrt(M_PI_2 * M_PI_2 + 4);
    return EHD_OK;
}

/* Returns the height of the dimple of Mourier et al., Tribology International 39 (2006)
 * 1745-1756. */
static double dent_height(const ehd_surface *self, double x, double y) {
    const double radius = self->given.radius, r = hypot(x, y) / (1.2 * radius);

    if (!(r < DENT_ENDS / 1.2)) return 0;
    return self->given.depth * cos(M_PI_2 * r) * exp(-2 * r * r);
}

// ---- table

static ehd_status check_row(const ehd_surface *self, size_t i, ehd_error *error) {
    const char *path = self->given.file;
    const double x = self->x[i], y = self->y ? self->y[i] : 0;

    if (!(fabs(x) <= MAX_X && fabs(y) <= MAX_X))
        return ehd_fail(error, EHD_DATA,
                        "%s: found a place of %g half widths in row %zu, expected from %g to %g",
                        path, fabs(x) <= MAX_X ? y : x, i + 1, -MAX_X, MAX_X);
    if (!isfinite(self->values[i]))
        return ehd_fail(error, EHD_DATA, "%s: %s: found %g in row %zu, expected a height", path,
                        self->given.column, self->values[i], i + 1);
    return EHD_OK;
}

/* Checks the order of row i: x increases in each line of the table and equals x of the first line.
 * y is constant in a line and increases from line to line. */
static bool is_in_order(const ehd_surface *self, size_t i) {
    const size_t column = i % self->num_x;

    if (column > 0 && !(self->x[i] - self->x[i - 1] >= MIN_DISTANCE)) return false;
    if (!self->y) return true;
    if (!(fabs(self->x[i] - self->x[column]) < MIN_DISTANCE)) return false;
    if (column > 0) return fabs(self->y[i] - self->y[i - 1]) < MIN_DISTANCE;
    return i == 0 || self->y[i] - self->y[i - 1] >= MIN_DISTANCE;
}

static bool is_at_edge(const ehd_surface *self, size_t i) {
    const size_t column = i % self->num_x, line = i / self->num_x;

    return column == 0 || column + 1 == self->num_x ||
           (self->y && (line == 0 || line + 1 == self->num_lines));
}

static double highest_of(const ehd_surface *self) {
    double highest = 0;

    for (size_t i = 0; i < self->count; i++)
        highest = fmax(highest, fabs(self->values[i]));
    return highest;
}

/* Returns the difference up to which two heights of the table are treated as equal. */
static double rounding_of(const ehd_surface *self) {
    return ROUNDING * highest_of(self);
}

/* Checks that heights at the edge are 0 to round-off, and sets them to 0. The surface is smooth
 * beyond the table. */
static ehd_status check_edge(ehd_surface *self, ehd_error *error) {
    const double rounding = rounding_of(self);

    for (size_t i = 0; i < self->count; i++) {
        if (!is_at_edge(self, i)) continue;
        if (!(fabs(self->values[i]) <= rounding))
            return ehd_fail(error, EHD_DATA,
                            "%s: %s: found %g in row %zu, at the edge of the table, expected 0 as "
                            "beyond, or at most 1e-9 of the largest height",
                            self->given.file, self->given.column, self->values[i], i + 1);
        self->values[i] = 0;
    }
    return EHD_OK;
}

static ehd_status check_table(ehd_surface *self, ehd_error *error) {
    const char *path = self->given.file;
    ehd_status status = EHD_OK;

    for (size_t i = 0; i < self->count && !status; i++)
        status = check_row(self, i, error);
    if (status) return status;
    self->num_x = self->count;
    for (size_t i = 1; i < self->count && self->y && self->num_x == self->count; i++)
        if (self->y[i] != self->y[0]) self->num_x = i;
    self->num_lines = self->num_x > 0 ? self->count / self->num_x : 0;
    if (self->num_x < MIN_ROWS || (self->y && self->num_lines < MIN_ROWS) ||
        self->num_x * self->num_lines != self->count)
        return ehd_fail(
            error, EHD_DATA,
            "%s: found %zu rows, %zu of them of the first line, expected at least %d of "
            "each of %s",
            path, self->count, self->num_x, MIN_ROWS,
            self->y ? "three lines along x or more" : "one line");
    for (size_t i = 0; i < self->count; i++) {
        if (!is_in_order(self, i))
            return ehd_fail(error, EHD_DATA,
                            "%s: found x = %.10g%s in row %zu, expected increasing x%s", path,
                            self->x[i], self->y ? " out of order" : "", i + 1,
                            self->y ? ", the same in lines of increasing y" : "");
    }
    return check_edge(self, error);
}

/* Checks that the table is symmetric in y, because only one half of the contact is solved. */
static ehd_status check_halves(const ehd_surface *self, ehd_error *error) {
    const double rounding = rounding_of(self);

    for (size_t i = 0; i < self->count; i++) {
        const size_t line = self->num_lines - 1 - i / self->num_x;
        const size_t mirrored = line * self->num_x + i % self->num_x;
        if (fabs(self->y[i] + self->y[mirrored]) < MIN_DISTANCE &&
            fabs(self->values[i] - self->values[mirrored]) <= rounding)
            continue;
        return ehd_fail(error, EHD_DATA,
                        "%s: found another height at -y than in row %zu, expected the same, or "
                        "grid.half: false",
                        self->given.file, i + 1);
    }
    return EHD_OK;
}

/* Converts a column with a unit to metres. Only tables with `units: si` may have units. */
static ehd_status take_unit(table_column *column, const ehd_surface *self, ehd_error *error) {
    unit_conversion to_si;
    char list[SHOWN_TEXT];

    if (!column->values || !*column->unit) return EHD_OK;
    unit_list(list, "m");
    if (strcmp(self->given.units, "si") != 0 || !unit_find(&to_si, "m", column->unit))
        return ehd_fail(error, EHD_DATA,
                        "%s: found the unit %s, expected surface.units si and m, %s, or no unit",
                        self->given.file, column->unit, list);
    for (size_t i = 0; i < self->count; i++)
        column->values[i] *= to_si.factor;
    return EHD_OK;
}

static ehd_status read_table(ehd_surface *self, ehd_error *error) {
    static const char *const x_names[] = {"x", "X", NULL};
    const char *const value_names[] = {self->given.column, NULL};
    const char *const y_names[] = {self->given.across, NULL};
    table_column columns[] = {
        {.names = x_names, .alone = true}, {.names = value_names}, {.names = y_names}};
    ehd_status status =
        table_read(self->given.file, columns, self->given.across[0] ? 3 : 2, &self->count, error);

    self->x = columns[0].values;
    self->values = columns[1].values;
    self->y = columns[2].values;
    for (size_t c = 0; c < 3 && !status; c++)
        status = take_unit(&columns[c], self, error);
    return status;
}

static ehd_status fit_lines(ehd_surface *self, ehd_error *error) {
    self->lines = splines_create(self->num_lines, self->num_x);
    if (!self->lines) return ehd_no_memory(error, self->given.file);
    for (size_t l = 0; l < self->num_lines; l++)
        spline_fit(self->lines[l], self->x, self->values + l * self->num_x);
    return EHD_OK;
}

static ehd_status prepare_file(ehd_surface *self, double of_length, double of_height,
                               ehd_error *error) {
    double most_bent = 0;
    ehd_status status = read_table(self, error);

    for (size_t i = 0; i < self->count && !status; i++) {
        self->x[i] *= of_length;
        self->values[i] *= of_height;
        if (self->y) self->y[i] *= of_length;
    }
    if (!status) status = check_table(self, error);
    if (!status && self->y && self->is_half) status = check_halves(self, error);
    if (!status) status = fit_lines(self, error);
    if (status) return status;
    self->rear = self->x[0];
    self->front = self->x[self->num_x - 1];
    for (size_t i = 0; i < self->count; i++) {
        const spline *line = self->lines[i / self->num_x];
        most_bent = fmax(most_bent, fabs(spline_bend(line, self->x[i % self->num_x])));
    }
    self->length = most_bent > 0 ? sqrt(highest_of(self) / most_bent) : INFINITY;
    return EHD_OK;
}

static double line_y(const ehd_surface *self, size_t line) {
    return self->y[line * self->num_x];
}

/* Computes, at one x, the height on a line of the table and the slope of the heights in y. It is
 * the slope of the parabola through this line and its two neighbours. On the first and on the last
 * line, height and slope are 0. */
static void line_at(double *height, double *slope, const ehd_surface *self, size_t line, double x) {
    *height = *slope = 0;
    if (line == 0 || line + 1 == self->num_lines) return;
    const double before = line_y(self, line) - line_y(self, line - 1);
    const double after = line_y(self, line + 1) - line_y(self, line);
    *height = spline_at(self->lines[line], x);
    const double down = (*height - spline_at(self->lines[line - 1], x)) / before;
    const double up = (spline_at(self->lines[line + 1], x) - *height) / after;
    *slope = (down * after + up * before) / (before + after);
}

/* Returns the height of a table: splines along x, and cubic polynomials in y with the slopes of
 * line_at. If the table depends on x alone, the height is the same for all y. */
static double file_height(const ehd_surface *self, double x, double y) {
    double height[2], slope[2];
    size_t line = 0;

    if (!(x > self->rear && x < self->front)) return 0;
    if (!self->y) return spline_at(self->lines[0], x);
    if (!(y > line_y(self, 0) && y < line_y(self, self->num_lines - 1))) return 0;
    while (y >= line_y(self, line + 1))
        line++;
    for (size_t i = 0; i < 2; i++)
        line_at(&height[i], &slope[i], self, line + i, x);
    const double step = line_y(self, line + 1) - line_y(self, line);
    const double s = (y - line_y(self, line)) / step, t = 1 - s;
    return t * t * ((1 + 2 * s) * height[0] + s * step * slope[0]) +
           s * s * ((1 + 2 * t) * height[1] - t * step * slope[1]);
}

// ---- the kinds

static const surface_kind kinds[] = {{"sine", prepare_sine, sine_height},
                                     {"dent", prepare_dent, dent_height},
                                     {"file", prepare_file, file_height}};

static const surface_kind *find_kind(const char *name) {
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        if (strcmp(kinds[i].name, name) == 0) return &kinds[i];
    return NULL;
}

/* Returns the smallest x of a grid, its boundary included. */
static double first_x(const ehd_grid *grid) {
    return grid_x(grid, 0);
}

/* Returns the largest x of a grid, its boundary included. */
static double last_x(const ehd_grid *grid) {
    return grid_x(grid, grid_width(grid) - 1);
}

/* Sets the position at T = 0. If the scene gives none, a surface at rest is in the centre of the
 * contact. Any other surface is in front of the grid, on the side from which it comes in. */
static void set_position(ehd_surface *self, double of_length, const ehd_grid *grid) {
    surface_settings *given = &self->given;

    if (!isnan(given->position))
        given->position *= of_length;
    else if (given->speed == 0)
        given->position = 0;
    else
        given->position =
            given->speed > 0 ? first_x(grid) - self->front : last_x(grid) - self->rear;
}

/* Checks that `speed`, with which the heights (waviness, dent or table) move, is the speed of one
 * of the two surfaces. Both are relative to the mean speed of the surfaces. If the slide-roll ratio
 * is NaN, the speeds of the surfaces are not known, and any speed is accepted. */
static ehd_status check_slide_roll(double speed, double slide_roll, ehd_error *error) {
    const double faster = 1 + slide_roll / 2, slower = 1 - slide_roll / 2;

    if (isnan(slide_roll) || fabs(speed - faster) <= ROUNDING || fabs(speed - slower) <= ROUNDING)
        return EHD_OK;
    return ehd_fail(error, EHD_DATA,
                    "surface.speed: found %.10g, expected %.10g or %.10g, those of the surfaces by "
                    "the slide-roll ratio",
                    speed, faster, slower);
}

ehd_status surface_init(ehd_surface **result, const scene *given, const ehd_contact *reference,
                        ehd_error *error) {
    const surface_kind *kind = find_kind(given->surface.kind);
    const bool si = strcmp(given->surface.units, "si") == 0;
    ehd_status status = EHD_OK;

    *result = NULL;
    if (!kind) return EHD_OK;
    if (si && isnan(reference->half_width))
        return ehd_fail(error, EHD_DATA,
                        "surface.units: found si, expected contact in a scene without physical");
    status = check_slide_roll(given->surface.speed, reference->slide_roll, error);
    if (status) return status;
    ehd_surface *self = calloc(1, sizeof *self);
    if (!self) return ehd_no_memory(error, "surface");
    self->kind = kind;
    self->given = given->surface;
    self->is_half = reference->grid.half;
    self->ellipticity = reference->grid.shape.ellipticity;
    const double of_length = si ? 1 / reference->half_width : 1;
    status = kind->prepare(self, of_length, si ? 1 / contact_film_scale(reference) : 1, error);
    if (!status) set_position(self, of_length, &reference->grid);
    if (status) self = surface_free(self);
    *result = self;
    return status;
}

ehd_surface *surface_free(ehd_surface *self) {
    if (!self) return NULL;
    splines_free(self->lines, self->num_lines);
    free(self->x);
    free(self->y);
    free(self->values);
    free(self);
    return NULL;
}

bool surface_rests(const ehd_surface *self) {
    return self && self->given.speed == 0;
}

ehd_status surface_check_start(const ehd_surface *self, const contact_frame *frame,
                               const ehd_grid *grid, ehd_error *error) {
    const bool forwards = self->given.speed > 0;
    const double end = frame->half_width * (forwards ? first_x(grid) : last_x(grid));
    const double most = end - (forwards ? self->front : self->rear);
    const double slack = ROUNDING * fabs(end);

    if (surface_rests(self)) return EHD_OK;
    if (forwards ? self->given.position <= most + slack : self->given.position >= most - slack)
        return EHD_OK;
    return ehd_fail(error, EHD_DATA,
                    "surface.position: found %.6g half widths, expected %s %.6g, in front of the "
                    "grid: the start is smooth",
                    self->given.position, forwards ? "at most" : "at least", most);
}

/* Checks the grid steps against the length of a wave with the largest curvature of the surface. */
static ehd_status check_step(const ehd_surface *self, const ehd_grid *grid, ehd_error *error) {
    const bool varies_across =
        grid->inner_lines > 1 && (self->y || self->kind->height == dent_height);
    const double across = varies_across ? grid_step_across(grid) * self->ellipticity : 0;
    const double wave = 2 * M_PI * self->length;
    const double most = wave / STEPS_PER_WAVE * grid->step / fmax(grid->step, across);

    if (grid->step <= most * (1 + ROUNDING)) return EHD_OK;
    return ehd_fail(error, EHD_DATA,
                    "grid.step: found %.6g half widths, expected at most %.6g to see the surface, "
                    "whose shortest waves are %.3g long",
                    grid->step, most, wave);
}

ehd_status surface_check_grid(const ehd_surface *self, const ehd_grid *grid, ehd_error *error) {
    const double position = self->given.position;

    if (surface_rests(self) &&
        (position + self->front <= first_x(grid) || position + self->rear >= last_x(grid)))
        return ehd_fail(error, EHD_DATA,
                        "surface.position: found %.6g half widths, expected a surface that rests "
                        "on the grid, from %.6g to %.6g",
                        position, first_x(grid), last_x(grid));
    return check_step(self, grid, error);
}

// ---- in time

double surface_position(const ehd_surface *self, double path) {
    return self->given.position + self->given.speed * path;
}

double surface_height(const ehd_surface *self, const contact_frame *frame, double x, double y) {
    const double along = x * frame->half_width - surface_position(self, frame->path);
    const double across = y * self->ellipticity * frame->half_width;

    return self->kind->height(self, along, across) / frame->film_scale;
}

void surface_heights(double *heights, const ehd_surface *self, const contact_frame *frame,
                     const ehd_grid *grid) {
    for (size_t k = 0; k < grid->num_nodes; k++)
        heights[k] = surface_height(self, frame, grid_x(grid, k), grid_y(grid, k));
}

double surface_longest_path(const ehd_surface *self, const contact_frame *frame,
                            const ehd_grid *grid, bool backwards) {
    const double speed = self->given.speed, position = surface_position(self, frame->path);
    const double first = first_x(grid) * frame->half_width, last = last_x(grid) * frame->half_width;
    const double front = position + self->front, rear = position + self->rear;
    const bool to_larger = backwards ? speed < 0 : speed > 0;
    double move = PART_OF_LENGTH * self->length;

    if (surface_rests(self)) return INFINITY;
    if (front < first) move = to_larger ? fmax(move, first - front) : INFINITY;
    if (rear > last) move = to_larger ? INFINITY : fmax(move, rear - last);
    return move / fabs(speed);
}
