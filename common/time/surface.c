/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/time/surface.h"

#include "common/algebra/spline.h"
#include "common/artefact/table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* By how much a surface may move in a step, in its lengths. */
static const double PART_OF_LENGTH = 0.5;

/* And steps of the grid, which does not carry more. */
static const double PART_OF_STEP = 0.25;

enum { MIN_ROWS = 3 };                                // of a table
static const double MAX_X = 1e9, MIN_DISTANCE = 1e-9; // of a table's x, half widths

typedef struct surface_kind surface_kind;

/* All lengths in reference half widths, heights in the reference film unit; x from the position. */
struct ehd_surface {
    const surface_kind *kind;
    surface_settings given;
    double *x, *values; // [count], of a table
    size_t count;
    spline *spline;
    double front, rear; // x up to which, and from which on, it is not smooth
    double length;      // sqrt(height/curvature), of the largest ones: what a step is measured by
};

/* A kind is a row of a table. */
struct surface_kind {
    const char *name;
    /* Sets front, rear and length. */
    ehd_status (*prepare)(ehd_surface *self, double of_length, double of_height, ehd_error *error);
    double (*height)(const ehd_surface *self, double x, double y);
};

// ---- waviness

/* Without end behind the front, which is its place. */
static ehd_status prepare_sine(ehd_surface *self, double of_length, double of_height,
                               ehd_error *error) {
    (void)error;
    self->given.wavelength *= of_length;
    self->given.amplitude *= of_height;
    self->length = self->given.wavelength / (2 * M_PI);
    self->front = self->given.speed > 0 ? 0 : INFINITY;
    self->rear = self->given.speed > 0 ? -INFINITY : 0;
    return EHD_OK;
}

/* Grows in over a wavelength, with continuous slope and curvature. */
static double sine_height(const ehd_surface *self, double x, double y) {
    const surface_settings *given = &self->given;
    const double behind = (given->speed > 0 ? -x : x) / given->wavelength;
    const double part = fmin(fmax(behind, 0), 1);
    (void)y;

    return given->amplitude * part * part * part * (10 - part * (15 - 6 * part)) *
           sin(2 * M_PI * x / given->wavelength + given->phase);
}

// ---- dent

/* Of the radius: where cos and so the height is zero for the second time, and below 2e-8 of the depth
 * anywhere beyond. */
static const double DENT_ENDS = 3.6;

static ehd_status prepare_dent(ehd_surface *self, double of_length, double of_height,
                               ehd_error *error) {
    const double width = 1.2;
    (void)error;
    self->given.radius *= of_length;
    self->given.depth *= of_height;
    self->front = DENT_ENDS * self->given.radius;
    self->rear = -self->front;
    // depth/r^2 ((pi/2)^2 + 4) with r = 1.2 radius is the curvature in its middle
    self->length = width * self->given.radius / sqrt(M_PI_2 * M_PI_2 + 4);
    return EHD_OK;
}

/* The dimple of Mourier et al., Tribology International 39 (2006) 1745-1756. */
static double dent_height(const ehd_surface *self, double x, double y) {
    const double radius = self->given.radius, r = hypot(x, y) / (1.2 * radius);

    if (!(r < DENT_ENDS / 1.2)) return 0;
    return self->given.depth * cos(M_PI_2 * r) * exp(-2 * r * r);
}

// ---- table

static ehd_status check_table(const ehd_surface *self, ehd_error *error) {
    const char *path = self->given.file, *column = self->given.column;
    const size_t last = self->count - 1;

    if (self->count < MIN_ROWS)
        return ehd_fail(error, EHD_DATA, "%s: found %zu row%s, expected at least %d", path,
                        self->count, self->count == 1 ? "" : "s", MIN_ROWS);
    for (size_t i = 0; i < self->count; i++) {
        if (!(fabs(self->x[i]) <= MAX_X))
            return ehd_fail(error, EHD_DATA,
                            "%s: found x = %g half widths in row %zu, expected from %g to %g", path,
                            self->x[i], i + 1, -MAX_X, MAX_X);
        if (i > 0 && !(self->x[i] - self->x[i - 1] >= MIN_DISTANCE))
            return ehd_fail(error, EHD_DATA,
                            "%s: found x = %.10g half widths in row %zu, expected at least %g more "
                            "than %.10g in the row before",
                            path, self->x[i], i + 1, MIN_DISTANCE, self->x[i - 1]);
        if (!isfinite(self->values[i]))
            return ehd_fail(error, EHD_DATA, "%s: %s: found %g in row %zu, expected a height", path,
                            column, self->values[i], i + 1);
    }
    if (self->values[0] != 0 || self->values[last] != 0)
        return ehd_fail(error, EHD_DATA,
                        "%s: %s: found %g in row %zu, expected 0, as beyond the table", path,
                        column, self->values[self->values[0] != 0 ? 0 : last],
                        self->values[0] != 0 ? 1 : last + 1);
    return EHD_OK;
}

/* Of a CSV file the first column is x, whatever its name. */
static ehd_status read_table(ehd_surface *self, ehd_error *error) {
    static const char *const x_name[] = {"x", NULL};
    const char *path = self->given.file, *const value_name[] = {self->given.column, NULL};
    const bool hdf5 = artefact_is_table(path);
    table_column columns[] = {{.names = hdf5 ? x_name : NULL}, {.names = value_name}};
    ehd_status status =
        (hdf5 ? artefact_read_table : csv_read_table)(path, columns, 2, &self->count, error);

    self->x = columns[0].values;
    self->values = columns[1].values;
    return status;
}

static ehd_status prepare_file(ehd_surface *self, double of_length, double of_height,
                               ehd_error *error) {
    double highest = 0, most_bent = 0;
    ehd_status status = read_table(self, error);

    for (size_t i = 0; i < self->count && !status; i++) {
        self->x[i] *= of_length;
        self->values[i] *= of_height;
    }
    if (!status) status = check_table(self, error);
    if (status) return status;
    self->spline = spline_create(self->count);
    if (!self->spline)
        return ehd_fail(error, EHD_MEMORY, "%s: found no memory for its spline", self->given.file);
    spline_fit(self->spline, self->x, self->values);
    self->rear = self->x[0];
    self->front = self->x[self->count - 1];
    for (size_t i = 0; i < self->count; i++) {
        highest = fmax(highest, fabs(self->values[i]));
        most_bent = fmax(most_bent, fabs(spline_bend(self->spline, self->x[i])));
    }
    self->length = most_bent > 0 ? sqrt(highest / most_bent) : INFINITY;
    return EHD_OK;
}

/* The same on all lines of a point contact. */
static double file_height(const ehd_surface *self, double x, double y) {
    (void)y;
    return x > self->rear && x < self->front ? spline_at(self->spline, x) : 0;
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

/* The ends of a grid, its boundary included. */
static double first_x(const ehd_grid *grid) {
    return grid_x(grid, 0);
}

static double last_x(const ehd_grid *grid) {
    return grid_x(grid, grid_width(grid) - 1);
}

/* In front of the grid, on the side that it comes in from. */
static void set_position(ehd_surface *self, double of_length, const ehd_grid *grid) {
    surface_settings *given = &self->given;

    if (!isnan(given->position))
        given->position *= of_length;
    else
        given->position =
            given->speed > 0 ? first_x(grid) - self->front : last_x(grid) - self->rear;
}

ehd_status surface_init(ehd_surface **result, const scene *given, const ehd_contact *reference,
                        ehd_error *error) {
    const surface_kind *kind = find_kind(given->surface.kind);
    const bool si = strcmp(given->surface.units, "si") == 0;
    ehd_status status = EHD_OK;

    *result = NULL;
    if (!kind) return EHD_OK;
    if (given->surface.speed == 0)
        return ehd_fail(error, EHD_DATA,
                        "surface.speed: found 0, expected another one: at rest it never comes in");
    if (si && isnan(reference->half_width))
        return ehd_fail(error, EHD_DATA,
                        "surface.units: found si, expected contact in a scene without physical");
    ehd_surface *self = calloc(1, sizeof *self);
    if (!self) return ehd_fail(error, EHD_MEMORY, "surface: found no memory");
    self->kind = kind;
    self->given = given->surface;
    const double of_length = si ? 1 / reference->half_width : 1;
    status = kind->prepare(self, of_length, si ? 1 / contact_film_scale(reference) : 1, error);
    if (!status) set_position(self, of_length, &reference->grid);
    if (status) self = surface_free(self);
    *result = self;
    return status;
}

ehd_surface *surface_free(ehd_surface *self) {
    if (!self) return NULL;
    free(self->x);
    free(self->values);
    spline_free(self->spline);
    free(self);
    return NULL;
}

ehd_status surface_refuse(const scene *given, ehd_error *error) {
    if (!given->surface.kind[0]) return EHD_OK;
    return ehd_fail(
        error, EHD_DATA,
        "surface.kind: found %s, expected none with a reduced model, which is of smooth "
        "surfaces; fullrun solves it",
        given->surface.kind);
}

ehd_status surface_check_start(const ehd_surface *self, const contact_frame *frame,
                               const ehd_grid *grid, ehd_error *error) {
    const bool forwards = self->given.speed > 0;
    const double end = frame->half_width * (forwards ? first_x(grid) : last_x(grid));
    const double most = end - (forwards ? self->front : self->rear);
    const double slack = 1e-9 * fabs(end);

    if (forwards ? self->given.position <= most + slack : self->given.position >= most - slack)
        return EHD_OK;
    return ehd_fail(error, EHD_DATA,
                    "surface.position: found %.6g half widths, expected %s %.6g, in front of the "
                    "grid: the start is smooth",
                    self->given.position, forwards ? "at most" : "at least", most);
}

// ---- in time

double surface_position(const ehd_surface *self, double path) {
    return self->given.position + self->given.speed * path;
}

double surface_height(const ehd_surface *self, const contact_frame *frame, double x, double y) {
    const double along = x * frame->half_width - surface_position(self, frame->path);

    return self->kind->height(self, along, y * frame->half_width) / frame->film_scale;
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
    const double resolved =
        fmax(PART_OF_LENGTH * self->length, PART_OF_STEP * grid->step * frame->half_width);
    double move = resolved;

    if (front < first) move = to_larger ? fmax(move, first - front) : INFINITY;
    if (rear > last) move = to_larger ? INFINITY : fmax(move, rear - last);
    return move / fabs(speed);
}
