/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/state/film_splines.h"

#include "common/algebra/natural_spline.h"
#include "common/algebra/rounding.h"
#include "common/algebra/vectors.h"
#include "common/physics/deflection.h"
#include "common/time/path_filter.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

// ---- tables

/* Makes a table of zeros, followed by work memory for fill_curvatures. */
static double *make_table(arena *memory, const spline_layout *layout) {
    const size_t work = layout->num_columns + layout->num_lines;

    return arena_array(memory, layout->num_lines * layout->line + work, sizeof(double));
}

/* Fills the curvatures of a table, which make_table has made, from its values. */
static void fill_curvatures(double *table, const spline_layout *layout) {
    size_t columns = layout->num_columns, lines = layout->num_lines, width = layout->width;
    double *factor = table + lines * layout->line;

    for (size_t l = 0; l < lines; l++) {
        double *values = table + l * layout->line;
        spline_curvatures(values + layout->x_curvature, factor, values, columns, layout->column,
                          width, layout->even_x);
    }
    for (size_t c = 0; c < columns && lines > 1; c++)
        for (size_t part = 0; part < 2; part++) {
            double *values = table + c * layout->column + part * layout->x_curvature;
            spline_curvatures(values + layout->y_curvature, factor, values, lines, layout->line,
                              width, layout->even_y);
        }
}

static bool is_line(const reduced_model *model) {
    return model->band.num_lines == 1;
}

static spline_layout layout_of_modes(const ehd_grid *grid, size_t width) {
    bool point = grid->inner_lines > 1;
    size_t column = (point ? 4 : 2) * width;

    return (spline_layout){.num_columns = grid_width(grid),
                           .num_lines = grid_lines(grid),
                           .width = width,
                           .even_y = grid->half,
                           .column = column,
                           .line = column * grid_width(grid),
                           .x_curvature = width,
                           .y_curvature = 2 * width};
}

static spline_layout layout_of_kernel(const ehd_grid *grid) {
    spline_layout layout = layout_of_modes(grid, 1);

    if (grid->half) layout.num_lines *= 2;
    layout.even_x = layout.even_y = true;
    return layout;
}

static void fill_kernel_table(film_splines *self, const contact_kind *kind) {
    const double step = self->grid.step, across = grid_step_across(&self->grid);
    const spline_layout layout = self->kernel_layout;

    for (size_t l = 0; l < layout.num_lines; l++)
        for (size_t c = 0; c < layout.num_columns; c++)
            self->kernel[l * layout.line + c * layout.column] =
                deflection_influence(kind, &self->grid, (double)c * step, (double)l * across);
    fill_curvatures(self->kernel, &layout);
}

// ---- the modes

/* Extends the model's grid upstream of the contact and at its sides. If the frame has grown with
 * the load, the nodes of the present frame lie farther out in a previous frame (frame_most_growth).
 * */
static void widen_grid(film_splines *self, const reduced_model *model) {
    const ehd_grid *grid = &model->grid;
    const double growth = frame_most_growth(model->kind, &grid->shape);
    double y_max = grid_y(grid, grid->num_nodes - 1);
    size_t lines = (size_t)ceil(growth * y_max / grid_step_across(grid));

    self->margin = (size_t)ceil(growth * fabs(grid->x_min) / grid->step);
    self->side = grid->half ? 0 : lines;
    self->grid = grid_like(grid, grid->x_min - (double)self->margin * grid->step, grid->step,
                           grid->inner_x + self->margin, grid->inner_lines + lines + self->side);
}

/* Extrapolates modes linearly to a node from the next two nodes inwards. */
static void extrapolate_linearly(double *node, ptrdiff_t inwards, size_t width) {
    const double *next = node + inwards, *second = next + inwards;

    for (size_t j = 0; j < width; j++)
        node[j] = 2 * next[j] - second[j];
}

/* Copies the modes, and extrapolates them linearly before the model's grid and at its sides. */
static void extend_modes(film_splines *self, const reduced_model *model, const double *modes) {
    const spline_layout *layout = &self->layout;
    size_t width = layout->width, column = layout->column, line = layout->line;
    size_t own = grid_width(&model->grid);

    for (size_t l = 0; l < model->band.num_lines; l++) {
        double *node = self->film + (l + self->side) * line + self->margin * column;
        for (size_t c = 0; c < own; c++)
            memcpy(node + c * column, modes + (l * own + c) * width, width * sizeof *modes);
        for (size_t m = 0; m < self->margin; m++)
            extrapolate_linearly(node -= column, (ptrdiff_t)column, width);
    }
    for (size_t c = 0; c < layout->num_columns; c++) {
        double *node = self->film + c * column;
        for (size_t l = self->side; l-- > 0;)
            extrapolate_linearly(node + l * line, (ptrdiff_t)line, width);
        for (size_t l = self->side + model->band.num_lines; l < layout->num_lines; l++)
            extrapolate_linearly(node + l * line, -(ptrdiff_t)line, width);
    }
}

static bool is_coupled(const reduced_model *model) {
    return model->deformation == DEFORMATION_COUPLED;
}

static size_t film_offset(const reduced_model *model) {
    return is_coupled(model) ? 0 : model->num_pressure;
}

static ehd_status fill_film_table(film_splines *self, const reduced_model *model,
                                  const double *deformation_basis, ehd_error *error) {
    ehd_status status = EHD_OK;

    if (is_coupled(model))
        status = field_modes_fill(self->film, self->layout.column, &self->grid, self->margin,
                                  self->side, &self->fields, model, error);
    else
        extend_modes(self, model, deformation_basis);
    if (!status) fill_curvatures(self->film, &self->layout);
    return status;
}

static void fill_pressure_table(film_splines *self, const reduced_model *model) {
    size_t width = model->num_pressure;
    const spline_layout layout = self->pressure_layout;

    for (size_t k = 0; k < model->grid.num_nodes; k++)
        memcpy(self->pressure + k * layout.column, self->fields.pressure + k * width,
               width * sizeof(double));
    fill_curvatures(self->pressure, &layout);
}

static void lay_out(film_splines *self, const reduced_model *model) {
    widen_grid(self, model);
    self->layout = layout_of_modes(&self->grid, is_coupled(model) ? model->num_pressure
                                                                  : model->num_deformation);
    self->pressure_layout = layout_of_modes(&model->grid, model->num_pressure);
    self->kernel_layout = layout_of_kernel(&self->grid);
}

/* For a coupled basis: makes `fields` use the deflections in the table `film`. */
static void share_deflections(film_splines *self) {
    const spline_layout *layout = &self->layout;
    field_modes *fields = &self->fields;

    fields->deflection = self->film + self->side * layout->line + self->margin * layout->column;
    fields->column = layout->column;
    fields->line = layout->line;
}

ehd_status film_splines_build(film_splines *self, const reduced_model *model,
                              const double *pressure_basis, const double *deformation_basis,
                              ehd_error *error) {
    memset(self, 0, sizeof *self);
    ehd_status status = field_modes_init(&self->fields, model, pressure_basis, error);
    if (status) return status;
    lay_out(self, model);
    self->film = make_table(&self->memory, &self->layout);
    self->pressure = make_table(&self->memory, &self->pressure_layout);
    self->kernel = make_table(&self->memory, &self->kernel_layout);
    status = self->memory.failed ? ehd_no_memory(error, "splines")
                                 : fill_film_table(self, model, deformation_basis, error);
    if (!status && !is_coupled(model)) status = field_modes_deflect(&self->fields, model, error);
    if (status) {
        film_splines_free(self);
        return status;
    }
    if (is_coupled(model)) share_deflections(self);
    fill_pressure_table(self, model);
    fill_kernel_table(self, model->kind);
    return EHD_OK;
}

void film_splines_free(film_splines *self) {
    arena_free(&self->memory);
    field_modes_free(&self->fields);
    memset(self, 0, sizeof *self);
}

// ---- in a flat file

static void walk_table(flat *file, const char *name, double **table, const spline_layout *layout) {
    *table = flat_table(file, name, *table, layout->num_lines, layout->line);
}

void film_splines_flat(flat *file, film_splines *self, const reduced_model *model,
                       const double *pressure_basis) {
    if (!flat_good(file)) return;
    if (file->reading) {
        *self = (film_splines){0};
        lay_out(self, model);
    }
    walk_table(file, "spline_film", &self->film, &self->layout);
    walk_table(file, "spline_pressure", &self->pressure, &self->pressure_layout);
    walk_table(file, "spline_kernel", &self->kernel, &self->kernel_layout);
    field_modes_flat(file, &self->fields, model, pressure_basis, !is_coupled(model));
    if (file->reading && flat_good(file) && is_coupled(model)) share_deflections(self);
}

// ---- filtered modes

/* Fills a table with the values of another table, filtered along its grid lines. */
static ehd_status filter_table(double *filtered, const double *table, const spline_layout *layout,
                               const ehd_grid *grid, double smoothing, ehd_error *error) {
    path_filter filter;
    ehd_status status = path_filter_init(&filter, grid, smoothing, error);

    if (status) return status;
    memcpy(filtered, table, layout->num_lines * layout->line * sizeof *table);
    for (size_t l = 0; l < layout->num_lines; l++)
        for (size_t j = 0; j < layout->width; j++)
            path_filter_apply(&filter, filtered + l * layout->line + j, l, layout->column, 1);
    path_filter_free(&filter);
    for (size_t c = 0; c < layout->num_columns * layout->num_lines; c++)
        memset(filtered + c * layout->column + layout->x_curvature, 0,
               (layout->column - layout->x_curvature) * sizeof *filtered);
    fill_curvatures(filtered, layout);
    return EHD_OK;
}

ehd_status film_carrier_init(film_carrier *self, const reduced_model *model,
                             const film_splines *splines, const ehd_contact *reference,
                             ehd_error *error) {
    const bool compressible = reference->lubricant.density != NULL;
    arena *memory = &self->memory;

    *self = (film_carrier){.model = model, .splines = splines, .reference = reference};
    if (reference->transport != TRANSPORT_PATH) return EHD_OK;
    const double smoothing = path_filter_length(reference);
    self->base_layout = layout_of_modes(&splines->grid, 1);
    self->base_pressure_layout = layout_of_modes(&model->grid, 1);
    self->film = make_table(memory, &splines->layout);
    self->base_film = make_table(memory, &self->base_layout);
    self->base_cut = make_table(memory, &self->base_layout);
    if (compressible) {
        self->pressure = make_table(memory, &splines->pressure_layout);
        self->base_pressure = make_table(memory, &self->base_pressure_layout);
    }
    ehd_status status = memory->failed ? ehd_no_memory(error, "splines")
                                       : filter_table(self->film, splines->film, &splines->layout,
                                                      &splines->grid, smoothing, error);
    if (!status && compressible)
        status = filter_table(self->pressure, splines->pressure, &splines->pressure_layout,
                              &model->grid, smoothing, error);
    if (status) film_carrier_free(self);
    return status;
}

void film_carrier_free(film_carrier *self) {
    arena_free(&self->memory);
    memset(self, 0, sizeof *self);
}

// ---- a previous state

static size_t parts_of(const spline_layout *layout) {
    return layout->num_lines > 1 ? 4 : 2;
}

static void init_sums(node_sums *self, const spline_layout *layout, arena *memory) {
    const size_t num_nodes = layout->num_lines * layout->num_columns;

    self->layout = layout;
    self->sum = arena_table(memory, num_nodes, parts_of(layout), sizeof *self->sum);
    self->of_state = arena_array(memory, num_nodes, sizeof *self->of_state);
}

ehd_status previous_film_init(previous_film *self, const film_carrier *carrier, ehd_error *error) {
    const reduced_model *model = carrier->model;
    const film_splines *splines = carrier->splines;
    arena *memory = &self->memory;

    *self = (previous_film){.carrier = carrier};
    self->runs = arena_array(memory, model->band.num_lines, sizeof *self->runs);
    self->cut_pressure = arena_array(memory, model->band.num_nodes, sizeof(double));
    self->cut_node = arena_array(memory, model->band.num_nodes, sizeof *self->cut_node);
    self->difference = arena_array(memory, model->num_unknowns, sizeof(double));
    init_sums(&self->film, &splines->layout, memory);
    init_sums(&self->pressure, &splines->pressure_layout, memory);
    ehd_status status = memory->failed ? ehd_no_memory(error, "previous state")
                                       : reduced_state_init(&self->state, model, error);
    if (!status) status = reduced_values_init(&self->values, model, error);
    if (status) previous_film_free(self);
    return status;
}

void previous_film_free(previous_film *self) {
    arena_free(&self->memory);
    reduced_state_free(&self->state);
    reduced_values_free(&self->values);
    memset(self, 0, sizeof *self);
}

/* Returns a row of the modes' table times the coordinates. The row is the weighted mean of the
 * filtered table, with the weight `share`, and the unfiltered table. */
static double sum_row(const node_sums *self, size_t at, size_t width) {
    double sum = 0;

    if (self->share < 1) sum += (1 - self->share) * dot(self->table + at, self->coordinates, width);
    if (self->share > 0) sum += self->share * dot(self->filtered + at, self->coordinates, width);
    return sum;
}

/* Returns the sum of the pressure modes at a node or, if `offset` is the offset of a curvature,
 * this curvature of the sum. With transport along the path it is the value of the base plus the
 * filtered difference from the base. */
static double sum_modes(const previous_film *self, size_t offset, size_t node) {
    const film_splines *splines = self->carrier->splines;
    const size_t width = splines->pressure_layout.width;
    const size_t at = node * splines->pressure_layout.column + offset;

    if (!self->along_path) return sum_row(&self->pressure, at, width);
    return sum_row(&self->pressure, at, width) +
           dot(splines->pressure + at, self->carrier->base->state.coordinates, width);
}

/* Prepares the pressure's spline near the exit of a line contact. The values are zero from the exit
 * on. At the first node of the window, the curvature is the curvature of the sum of the modes. */
static void prepare_window(previous_film *self) {
    size_t num_nodes = self->carrier->model->grid.num_nodes;
    size_t size = num_nodes < EXIT_WINDOW ? num_nodes : EXIT_WINDOW, exit = self->state.exit;
    size_t begin = exit > size * 2 / 3 ? exit - size * 2 / 3 : 0;
    double factor[EXIT_WINDOW];

    if (begin + size > num_nodes) begin = num_nodes - size;
    self->window_begin = begin;
    self->window_size = size;
    for (size_t i = 0; i < size; i++)
        self->window[i] = begin + i < exit ? sum_modes(self, 0, begin + i) : 0;
    memset(self->curvature, 0, sizeof self->curvature);
    self->curvature[0] =
        sum_modes(self, self->carrier->splines->pressure_layout.x_curvature, begin);
    spline_curvatures(self->curvature, factor, self->window, size, 1, 1, false);
}

/* Finds the nodes between the state's exits and cut_exits, and P at these nodes. */
static void prepare_cut(previous_film *self) {
    const reduced_model *model = self->carrier->model;
    const film_splines *splines = self->carrier->splines;
    const size_t num_runs = is_coupled(model)
                                ? reduced_model_runs(self->runs, model, splines->fields.cut_exits,
                                                     reduced_state_exits(&self->state))
                                : 0;

    self->num_cut = 0;
    for (size_t r = 0; r < num_runs; r++) {
        const cut_run *run = &self->runs[r];
        double *pressure = self->cut_pressure + self->num_cut;
        reduced_band_pressure(pressure, model, self->state.coordinates, run->first, run->count);
        vector_scale(pressure, run->sign, run->count);
        for (size_t i = 0; i < run->count; i++)
            self->cut_node[self->num_cut++] =
                (grid_position){run->line + splines->side, run->column + splines->margin + i};
    }
}

/* Sets the tables and coordinates of the sums, and discards earlier sums. */
static void prepare_sums(node_sums *self, const double *table, const double *filtered, double share,
                         const double *coordinates) {
    self->table = table;
    self->filtered = filtered;
    self->share = share;
    self->coordinates = coordinates;
    self->state++;
}

/* Prepares a state. The film and the pressure are sums over modes with the given coordinates. */
static void prepare(previous_film *self, double share, const double *coordinates) {
    const film_carrier *carrier = self->carrier;
    const film_splines *splines = carrier->splines;

    prepare_cut(self);
    prepare_sums(&self->film, splines->film, carrier->film, share,
                 coordinates + film_offset(carrier->model));
    prepare_sums(&self->pressure, splines->pressure, carrier->pressure, share, coordinates);
    if (carrier->reference->lubricant.density && is_line(carrier->model)) prepare_window(self);
}

void previous_film_prepare(previous_film *self) {
    self->along_path = false;
    prepare(self, 0, self->state.coordinates);
}

void previous_film_prepare_path(previous_film *self, double share) {
    const previous_film *base = self->carrier->base;

    for (size_t j = 0; j < self->carrier->model->num_unknowns; j++)
        self->difference[j] = self->state.coordinates[j] - base->state.coordinates[j];
    self->along_path = true;
    prepare(self, share, self->difference);
}

/* Returns the position of a node of the model in the grid of the splines. */
static grid_position position_of(size_t node, const film_carrier *carrier) {
    const grid_position at = reduced_model_position(carrier->model, node);

    return (grid_position){at.line + carrier->splines->side, at.column + carrier->splines->margin};
}

/* Returns the index of a node's modes in the table of the film. */
static size_t film_row(grid_position at, const spline_layout *layout) {
    return at.line * layout->line + at.column * layout->column;
}

double previous_film_filter_change(const previous_film *self, size_t node) {
    const film_splines *splines = self->carrier->splines;
    const size_t row = film_row(position_of(node, self->carrier), &splines->layout);
    const size_t width = splines->layout.width;

    return sum_row(&self->film, row, width) -
           dot(splines->film + row, self->film.coordinates, width);
}

// ---- evaluation

/* Moves a point to a node if they differ only by round-off. Most spline weights are then zero. For
 * a point contact this saves most of the work while the frame keeps its width. */
static double round_to_node(double nodes) {
    return fabs(nodes - round(nodes)) < ROUNDING ? round(nodes) : nodes;
}

/* A point of a state's frame, located in the grid of the splines. For a line contact the only line
 * has the weight 1. */
typedef struct film_point {
    double x, y;
    spline_point along, across;
} film_point;

static film_point locate(double x, double y, const film_splines *splines) {
    const ehd_grid *grid = &splines->grid;
    const spline_layout *layout = &splines->layout;
    const bool line = layout->num_lines == 1;
    const double column = (x - grid->x_min) / grid->step + 1;
    film_point at = {.x = x, .y = y, .across = {0, {1}}};

    at.along = spline_at(line ? column : round_to_node(column), layout->num_columns);
    if (!line)
        at.across = spline_at(round_to_node((y - grid_y(grid, 0)) / grid_step_across(grid)),
                              layout->num_lines);
    return at;
}

/* Evaluates a spline of one function at a point. */
static double evaluate_one(const double *table, const spline_layout *layout, const film_point *at) {
    const spline_point *along = &at->along, *across = &at->across;
    const size_t x_curvature = layout->x_curvature, column = layout->column;
    double sum = 0;

    table += across->node * layout->line + along->node * column;
    for (size_t v = 0; v < (layout->num_lines > 1 ? NUM_SPLINE_WEIGHTS : 1); v++) {
        const double *here = table + v / 2 * layout->line + v % 2 * layout->y_curvature;
        double part = along->weight[0] * here[0] + along->weight[1] * here[x_curvature] +
                      along->weight[2] * here[column] +
                      along->weight[3] * here[column + x_curvature];
        sum += across->weight[v] * part;
    }
    return sum;
}

/* Adds values and curvatures of the deflection by the pressures between cut_exits and the state's
 * own exits, at a node of the splines' grid. */
static void add_cut(double *sum, const previous_film *self, size_t line, size_t column) {
    const film_splines *splines = self->carrier->splines;
    const spline_layout *layout = &splines->kernel_layout;
    vector total = {0};

    if (layout->num_lines == 1) {
        for (size_t i = 0; i < self->num_cut; i++) {
            const double *kernel =
                splines->kernel + index_distance(column, self->cut_node[i].column) * layout->column;
            sum[0] += self->cut_pressure[i] * kernel[0];
            sum[1] += self->cut_pressure[i] * kernel[1];
        }
        return;
    }
    for (size_t i = 0; i < self->num_cut; i++) {
        const grid_position *at = &self->cut_node[i];
        const double *along = splines->kernel + index_distance(column, at->column) * layout->column;
        const double *own = along + index_distance(line, at->line) * layout->line;
        const double *mirrored = along + (line + at->line) * layout->line;
        total += self->cut_pressure[i] * *(const vector *)own;
        if (splines->grid.half && at->line > 0)
            total += self->cut_pressure[i] * *(const vector *)mirrored;
    }
    *(vector *)sum += total;
}

/* Returns values and curvatures of a state at a node. `cut`: state whose deflection from add_cut is
 * added; NULL: no deflection is added. */
static const double *sums_at(const node_sums *self, const previous_film *cut, size_t line,
                             size_t column) {
    const spline_layout *layout = self->layout;
    const size_t parts = parts_of(layout), node = line * layout->num_columns + column;
    double *sum = self->sum + node * parts;

    if (self->of_state[node] == self->state) return sum;
    for (size_t i = 0; i < parts; i++)
        sum[i] = sum_row(self, node * layout->column + i * layout->width, layout->width);
    if (cut) add_cut(sum, cut, line, column);
    self->of_state[node] = self->state;
    return sum;
}

/* Evaluates a state's spline at a point. Skips the nodes whose weights are zero. */
static double evaluate(const node_sums *self, const previous_film *cut, const film_point *point) {
    const spline_point *along = &point->along, *across = &point->across;
    const bool line_contact = self->layout->num_lines == 1;
    double sum = 0;

    for (size_t v = 0; v < NUM_SPLINE_WEIGHTS; v += 2) {
        const double *b = across->weight + v;
        if (b[0] == 0 && b[1] == 0) continue;
        for (size_t u = 0; u < NUM_SPLINE_WEIGHTS; u += 2) {
            const double *a = along->weight + u;
            if (a[0] == 0 && a[1] == 0) continue;
            const double *at = sums_at(self, cut, across->node + v / 2, along->node + u / 2);
            sum += b[0] * (a[0] * at[0] + a[1] * at[1]);
            if (!line_contact) sum += b[1] * (a[0] * at[2] + a[1] * at[3]);
        }
    }
    return sum;
}

/* Returns P as the sum of the modes, without setting P to zero behind the exit. With transport
 * along the path the result is P of the base state plus the change that the filtered modes
 * describe. */
static double uncut_pressure(const previous_film *self, const film_point *at) {
    const film_carrier *carrier = self->carrier;
    double base = 0;

    if (self->along_path) {
        base = evaluate_one(carrier->base_pressure, &carrier->base_pressure_layout, at);
        if (self == carrier->base) return base;
    }
    return base + evaluate(&self->pressure, NULL, at);
}

/* Returns P of a line contact. */
static double window_pressure(const previous_film *self, const film_point *at) {
    enum { MARGIN = 4 }; // number of nodes at each end of the window that are not used
    const double *u = at->along.weight;
    size_t node = at->along.node;

    if (node + 1 < self->window_begin + MARGIN) return uncut_pressure(self, at);
    if (node + MARGIN + 1 >= self->window_begin + self->window_size) return 0;
    size_t i = node - self->window_begin;
    return u[0] * self->window[i] + u[1] * self->curvature[i] + u[2] * self->window[i + 1] +
           u[3] * self->curvature[i + 1];
}

/* Returns the column of the exit line between two grid lines. A boundary line is taken to have the
 * exit of its neighbour. */
static double exit_between(const size_t exits[2], const double *across) {
    size_t own = exits[0] > 1 ? exits[0] : exits[1], next = exits[1] > 1 ? exits[1] : exits[0];

    return across[0] * (double)own + across[2] * (double)next;
}

/* Returns P of a point contact: the sum of the modes before the exit line, zero behind it. */
static double pressure_before_exit(const previous_film *self, const film_point *at) {
    const double exit = exit_between(self->state.exits + at->across.node, at->across.weight);

    return (double)at->along.node + at->along.weight[2] >= exit ? 0 : uncut_pressure(self, at);
}

/* Returns P at a point, zero beyond the model's grid. */
static double pressure_at(const previous_film *self, const film_point *at) {
    const film_splines *splines = self->carrier->splines;
    const size_t num_lines = splines->pressure_layout.num_lines;
    film_point own = *at; // in the model's grid

    if (at->along.node < splines->margin) return 0;
    own.along.node -= splines->margin;
    if (num_lines == 1) return window_pressure(self, &own);
    own.across.node -= splines->side; // before the first line this is a large unsigned number
    return own.across.node < num_lines - 1 ? pressure_before_exit(self, &own) : 0;
}

static double density_at(const previous_film *self, const film_point *at) {
    const ehd_contact *reference = self->carrier->reference;

    if (!reference->lubricant.density) return 1;
    double hertz = reference->hertz_pressure * self->frame.hertz_pressure;
    return lubricant_density(&reference->lubricant, pressure_at(self, at) * hertz);
}

/* Returns H of the base at a point. */
static double base_film(const film_carrier *self, const film_point *at) {
    return evaluate_one(self->base_film, &self->base_layout, at) +
           contact_gap(&self->splines->grid.shape, at->x, at->y);
}

/* Returns rho H of a state at a point, times `ratio`. */
static double mass_at(const previous_film *self, const film_point *at, double ratio) {
    const reduced_model *model = self->carrier->model;
    const double film = self->state.coordinates[model->num_unknowns - 1] +
                        contact_gap(&model->grid.shape, at->x, at->y) +
                        evaluate(&self->film, self, at);

    return film * ratio * density_at(self, at);
}

/* Returns rho H with transport along the path. rho H of the base is evaluated at the place of the
 * node, `here`. The difference from the base is evaluated at the place where the fluid was at the
 * time of the state, `before`. */
static double mass_along_path(const previous_film *self, const film_point *here,
                              const film_point *before) {
    const film_carrier *carrier = self->carrier;
    double change = self->difference[carrier->model->num_unknowns - 1] +
                    evaluate(&self->film, self, before) -
                    evaluate_one(carrier->base_cut, &carrier->base_layout, before);
    double stays = base_film(carrier, here);

    if (carrier->reference->lubricant.density) {
        // both densities differ, so the film of the base at the earlier place does not cancel
        const double film = base_film(carrier, before);
        const double of_base = density_at(carrier->base, before);
        change = density_at(self, before) * (change + film) - of_base * film;
        stays *= density_at(carrier->base, here);
    }
    return change + stays;
}

double previous_film_mass(const previous_film *self, size_t node, const contact_frame *now) {
    const film_carrier *carrier = self->carrier;
    const ehd_grid *grid = &carrier->model->grid;
    const double stretch = frame_stretch(now, &self->frame);
    const double ratio = frame_film_ratio(now, &self->frame);
    const double x = stretch * grid_x(grid, node), y = stretch * grid_y(grid, node);
    const film_point here = locate(x, y, carrier->splines);

    if (!self->along_path) return mass_at(self, &here, ratio);
    const film_point before = locate(x - frame_shift(now, &self->frame), y, carrier->splines);
    return mass_along_path(self, &here, &before) * ratio;
}

double previous_film_thickness(const previous_film *self, size_t node) {
    const film_carrier *carrier = self->carrier;
    const spline_layout *layout = &carrier->splines->layout;
    const grid_position at = position_of(node, carrier);
    const double *modes = self->film.table + film_row(at, layout);
    double deflection[4] = {dot(modes, self->film.coordinates, layout->width)};

    add_cut(deflection, self, at.line, at.column);
    return self->state.coordinates[carrier->model->num_unknowns - 1] +
           grid_gap(&carrier->model->grid, node) + deflection[0];
}

double previous_film_pressure(const previous_film *self, size_t node) {
    const size_t num = self->carrier->model->num_pressure;

    return dot(self->carrier->splines->fields.pressure + node * num, self->state.coordinates, num);
}

// ---- the base

void film_carrier_set_base(film_carrier *self, previous_film *base) {
    const reduced_model *model = self->model;
    const film_splines *splines = self->splines;
    const spline_layout *layout = &splines->layout;
    const double *coordinates = base->state.coordinates;
    const double approach = coordinates[model->num_unknowns - 1];

    previous_film_prepare(base);
    base->along_path = true; // its pressure comes from base_pressure
    self->base = base;
    for (size_t k = 0; k < layout->num_lines * layout->num_columns; k++) {
        double cut[4] = {0};
        add_cut(cut, base, k / layout->num_columns, k % layout->num_columns);
        self->base_cut[k * self->base_layout.column] = cut[0];
        self->base_film[k * self->base_layout.column] =
            approach + cut[0] +
            dot(splines->film + k * layout->column, coordinates + film_offset(model),
                layout->width);
    }
    fill_curvatures(self->base_film, &self->base_layout);
    fill_curvatures(self->base_cut, &self->base_layout);
    if (!self->base_pressure) return;
    for (size_t k = 0; k < model->grid.num_nodes; k++)
        self->base_pressure[k * self->base_pressure_layout.column] =
            dot(splines->pressure + k * splines->pressure_layout.column, coordinates,
                model->num_pressure);
    fill_curvatures(self->base_pressure, &self->base_pressure_layout);
}

void film_carrier_base_at(double *film, double *density, const film_carrier *self, size_t node) {
    const ehd_grid *grid = &self->model->grid;
    const film_point at = locate(grid_x(grid, node), grid_y(grid, node), self->splines);

    *film = base_film(self, &at);
    *density = density_at(self->base, &at);
}
