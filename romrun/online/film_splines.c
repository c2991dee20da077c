/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/online/film_splines.h"

#include "common/physics/deflection.h"
#include "common/time/bdf.h"

#include <cblas.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

// ---- bends of natural cubic splines

/* Solves bend[k-1] + 4 bend[k] + bend[k+1] = second difference of the values, for `width` splines at once
 * with nodes that lie `stride` apart; the last bend and, unless the first node is a mirror, the first one are given
 * in `bends` (zero: natural). `factor` is work of [num]. */
static void solve_bends(double *bends, double *factor, const double *values, size_t num,
                        size_t stride, size_t width, bool even) {
    factor[0] = even ? 0.5 : 0; // of 2 bend[0] + bend[1] = value[1] - value[0]
    for (size_t j = 0; j < width && even; j++)
        bends[j] = 0.5 * (values[stride + j] - values[j]);
    for (size_t k = 1; k + 1 < num; k++) {
        const double *value = values + k * stride, *before = value - stride;
        double *bend = bends + k * stride;
        factor[k] = 1 / (4 - factor[k - 1]);
        for (size_t j = 0; j < width; j++)
            bend[j] = factor[k] *
                      (before[j] - 2 * value[j] + value[stride + j] - bends[(k - 1) * stride + j]);
    }
    for (size_t k = num - 1; k-- > (even ? 0 : 1);)
        for (size_t j = 0; j < width; j++)
            bends[k * stride + j] -= factor[k] * bends[(k + 1) * stride + j];
}

/* A table of zeros. */
static ehd_status make_table(double **table, const spline_layout *layout, ehd_error *error) {
    *table = calloc(layout->num_lines * layout->line, sizeof **table);
    return *table ? EHD_OK
                  : ehd_fail(error, EHD_MEMORY, "splines: found no memory for %zu modes",
                             layout->width);
}

/* The bends of a table that has its values. */
static ehd_status fill_bends(double *table, const spline_layout *layout, ehd_error *error) {
    size_t columns = layout->num_columns, lines = layout->num_lines, width = layout->width;
    double *factor = malloc((columns + lines) * sizeof *factor);

    if (!factor) return ehd_fail(error, EHD_MEMORY, "splines: found no memory");
    for (size_t l = 0; l < lines; l++) {
        double *values = table + l * layout->line;
        solve_bends(values + layout->x_bend, factor, values, columns, layout->column, width,
                    layout->even_x);
    }
    for (size_t c = 0; c < columns && lines > 1; c++)
        for (size_t part = 0; part < 2; part++) {
            double *values = table + c * layout->column + part * layout->x_bend;
            solve_bends(values + layout->y_bend, factor, values, lines, layout->line, width,
                        layout->even_y);
        }
    free(factor);
    return EHD_OK;
}

static bool is_line(const reduced_model *model) {
    return model->band.num_lines == 1;
}

/* Of modes at a grid's nodes. */
static spline_layout layout_of_modes(const ehd_grid *grid, size_t width) {
    bool point = grid->inner_lines > 1;
    size_t column = (point ? 4 : 2) * width;

    return (spline_layout){.num_columns = grid_width(grid),
                           .num_lines = grid_lines(grid),
                           .width = width,
                           .even_y = grid->half,
                           .column = column,
                           .line = column * grid_width(grid),
                           .x_bend = width,
                           .y_bend = 2 * width};
}

/* Of the kernel by distance; along a line its values and bends alternate, as do those bent across. */
static spline_layout layout_of_kernel(const ehd_grid *grid) {
    bool point = grid->inner_lines > 1;
    size_t columns = grid_width(grid), part = 2 * columns;

    return (spline_layout){.num_columns = columns,
                           .num_lines = (grid->half ? 2 : 1) * grid_lines(grid),
                           .width = 1,
                           .even_x = true,
                           .even_y = true,
                           .column = 2,
                           .line = (point ? 2 : 1) * part,
                           .x_bend = 1,
                           .y_bend = part};
}

static ehd_status make_kernel_table(film_splines *self, const contact_kind *kind,
                                    ehd_error *error) {
    const double step = self->grid.step;
    const spline_layout layout = layout_of_kernel(&self->grid);
    ehd_status status = make_table(&self->kernel, &layout, error);

    self->kernel_layout = layout;
    if (status) return status;
    for (size_t l = 0; l < layout.num_lines; l++)
        for (size_t c = 0; c < layout.num_columns; c++)
            self->kernel[l * layout.line + c * layout.column] =
                kind->kernel((double)c * step, (double)l * step, step);
    return fill_bends(self->kernel, &layout, error);
}

// ---- the modes

/* Wider than the model's grid before the contact and at its sides, because places of a wide frame lie farther out
 * in a narrower one: enough for a load that has become 2.25 times as large. */
static void widen_grid(film_splines *self, const reduced_model *model) {
    const ehd_grid *grid = &model->grid;
    const contact_kind *kind = model->kind;
    double growth = kind->half_width(2.25, 1, 1) / kind->half_width(1, 1, 1) - 1 - 1e-9;
    double y_max = grid_y(grid, grid->num_nodes - 1);
    size_t lines = (size_t)ceil(growth * y_max / grid->step);

    self->margin = (size_t)ceil(growth * fabs(grid->x_min) / grid->step);
    self->side = grid->half ? 0 : lines;
    self->grid =
        grid_of(grid->x_min - (double)self->margin * grid->step, grid->step,
                grid->inner_x + self->margin, grid->inner_lines + lines + self->side, grid->half);
}

/* Deflections of the pressure modes cut at cut_exits, into a table of zeros. */
static ehd_status deflect_modes(film_splines *self, const reduced_model *model,
                                const double *pressure_basis, ehd_error *error) {
    const spline_layout *layout = &self->layout;
    size_t num_nodes = self->grid.num_nodes, width = layout->width;
    size_t own = grid_width(&model->grid), wide = grid_width(&self->grid);
    ehd_deflection *deflection = deflection_create(model->kind, &self->grid);
    double *work = malloc(num_nodes * sizeof *work);
    ehd_status status = EHD_OK;

    if (!deflection || !work)
        status = ehd_fail(error, EHD_MEMORY, "splines: found no memory for %zu modes", width);
    for (size_t j = 0; j < width && !status; j++) {
        memset(work, 0, num_nodes * sizeof *work);
        for (size_t l = 0; l < model->band.num_lines; l++)
            for (size_t c = 0; c < self->cut_exits[l]; c++)
                work[(l + self->side) * wide + self->margin + c] =
                    pressure_basis[(l * own + c) * width + j];
        deflection_apply(work, deflection, work);
        for (size_t k = 0; k < num_nodes; k++)
            self->film[k * layout->column + j] = work[k];
    }
    deflection_free(deflection);
    free(work);
    return status;
}

/* What modes that go on straight have at a node: twice what is at the next one inwards, less what is behind that. */
static void go_on_straight(double *node, ptrdiff_t inwards, size_t width) {
    const double *next = node + inwards, *behind = next + inwards;

    for (size_t j = 0; j < width; j++)
        node[j] = 2 * next[j] - behind[j];
}

/* The modes themselves, going on straight before the model's grid and at its sides. */
static void continue_modes(film_splines *self, const reduced_model *model, const double *modes) {
    const spline_layout *layout = &self->layout;
    size_t width = layout->width, column = layout->column, line = layout->line;
    size_t own = grid_width(&model->grid);

    for (size_t l = 0; l < model->band.num_lines; l++) {
        double *node = self->film + (l + self->side) * line + self->margin * column;
        for (size_t c = 0; c < own; c++)
            memcpy(node + c * column, modes + (l * own + c) * width, width * sizeof *modes);
        for (size_t m = 0; m < self->margin; m++)
            go_on_straight(node -= column, (ptrdiff_t)column, width);
    }
    for (size_t c = 0; c < layout->num_columns; c++) {
        double *node = self->film + c * column;
        for (size_t l = self->side; l-- > 0;)
            go_on_straight(node + l * line, (ptrdiff_t)line, width);
        for (size_t l = self->side + model->band.num_lines; l < layout->num_lines; l++)
            go_on_straight(node + l * line, -(ptrdiff_t)line, width);
    }
}

static bool is_coupled(const reduced_model *model) {
    return model->deformation == DEFORMATION_COUPLED;
}

static ehd_status make_film_table(film_splines *self, const reduced_model *model,
                                  const double *pressure_basis, const double *deformation_basis,
                                  ehd_error *error) {
    self->layout = layout_of_modes(&self->grid, is_coupled(model) ? model->num_pressure
                                                                  : model->num_deformation);
    ehd_status status = make_table(&self->film, &self->layout, error);
    if (!status && is_coupled(model))
        status = deflect_modes(self, model, pressure_basis, error);
    else if (!status)
        continue_modes(self, model, deformation_basis);
    return status ? status : fill_bends(self->film, &self->layout, error);
}

static ehd_status make_pressure_table(film_splines *self, const reduced_model *model,
                                      ehd_error *error) {
    size_t width = model->num_pressure;
    const spline_layout layout = layout_of_modes(&model->grid, width);
    ehd_status status = make_table(&self->pressure, &layout, error);

    self->pressure_layout = layout;
    for (size_t k = 0; k < model->grid.num_nodes && !status; k++)
        memcpy(self->pressure + k * layout.column, self->pressure_basis + k * width,
               width * sizeof(double));
    return status ? status : fill_bends(self->pressure, &layout, error);
}

ehd_status film_splines_build(film_splines *self, const reduced_model *model,
                              const double *pressure_basis, const double *deformation_basis,
                              ehd_error *error) {
    memset(self, 0, sizeof *self);
    self->pressure_basis = pressure_basis;
    self->cut_exits = malloc(model->band.num_lines * sizeof *self->cut_exits);
    if (!self->cut_exits) return ehd_fail(error, EHD_MEMORY, "splines: found no memory");
    for (size_t l = 0; l < model->band.num_lines; l++)
        self->cut_exits[l] = (model->band.lines[l].min_exit + model->band.lines[l].max_exit) / 2;
    widen_grid(self, model);
    ehd_status status = make_film_table(self, model, pressure_basis, deformation_basis, error);
    if (!status) status = make_pressure_table(self, model, error);
    if (!status) status = make_kernel_table(self, model->kind, error);
    if (status) film_splines_free(self);
    return status;
}

void film_splines_free(film_splines *self) {
    free(self->film);
    free(self->pressure);
    free(self->kernel);
    free(self->cut_exits);
    memset(self, 0, sizeof *self);
}

// ---- an earlier state

ehd_status earlier_film_init(earlier_film *self, const reduced_model *model, ehd_error *error) {
    memset(self, 0, sizeof *self);
    self->runs = calloc(model->band.num_lines, sizeof *self->runs);
    self->cut_pressure = calloc(model->band.num_nodes, sizeof(double));
    ehd_status status = self->runs && self->cut_pressure
                            ? reduced_state_init(&self->state, model, error)
                            : ehd_fail(error, EHD_MEMORY, "earlier state: found no memory");
    if (!status) status = reduced_values_init(&self->values, model, error);
    if (status) earlier_film_free(self);
    return status;
}

void earlier_film_free(earlier_film *self) {
    free(self->runs);
    free(self->cut_pressure);
    reduced_state_free(&self->state);
    reduced_values_free(&self->values);
    memset(self, 0, sizeof *self);
}

/* The pressure's spline near the exit of a line contact, where it differs from that of the modes: its values are zero
 * from there on. Far before it the bend is that of the modes. */
static void prepare_window(earlier_film *self, const reduced_model *model,
                           const film_splines *splines) {
    size_t num_pressure = model->num_pressure, num_nodes = model->grid.num_nodes;
    size_t size = num_nodes < EXIT_WINDOW ? num_nodes : EXIT_WINDOW, exit = self->state.exit;
    size_t begin = exit > size * 2 / 3 ? exit - size * 2 / 3 : 0;
    const double *z = self->state.coordinates;
    double factor[EXIT_WINDOW];

    if (begin + size > num_nodes) begin = num_nodes - size;
    self->window_begin = begin;
    self->window_size = size;
    for (size_t i = 0; i < size; i++)
        self->window[i] =
            begin + i < exit
                ? cblas_ddot((int)num_pressure,
                             splines->pressure + (begin + i) * splines->pressure_layout.column, 1,
                             z, 1)
                : 0;
    memset(self->bend, 0, sizeof self->bend);
    self->bend[0] = cblas_ddot((int)num_pressure,
                               splines->pressure + begin * splines->pressure_layout.column +
                                   splines->pressure_layout.x_bend,
                               1, z, 1);
    solve_bends(self->bend, factor, self->window, size, 1, 1, false);
}

void earlier_film_prepare(earlier_film *self, const reduced_model *model,
                          const film_splines *splines, const ehd_contact *reference) {
    self->num_runs = is_coupled(model) ? reduced_model_runs(self->runs, model, splines->cut_exits,
                                                            reduced_state_exits(&self->state))
                                       : 0;
    for (size_t r = 0; r < self->num_runs; r++) {
        const cut_run *run = &self->runs[r];
        double *pressure = self->cut_pressure + run->first;
        reduced_band_pressure(pressure, model, self->state.coordinates, run->first, run->count);
        cblas_dscal((int)run->count, run->sign, pressure, 1);
    }
    if (reference->lubricant.density && is_line(model)) prepare_window(self, model, splines);
}

// ---- at a place

enum { NUM_WEIGHTS = 4 };

/* Along one direction: a place between nodes `node` and node + 1, with the weights of value and bend there, then
 * of value and bend at the next. */
typedef struct spline_place {
    size_t node;
    double weight[NUM_WEIGHTS];
} spline_place;

/* The place `nodes` nodes behind the first of `num`. Beyond them the spline goes on straight. */
static inline spline_place spline_at(double nodes, size_t num) {
    size_t last = num - 2;
    size_t first = nodes < (double)last ? nodes > 0 ? (size_t)nodes : 0 : last;
    double b = nodes - (double)first, a = 1 - b;
    spline_place at = {first, {a, (a * a - 1) * a, b, (b * b - 1) * b}};

    if (b < 0)
        at.weight[1] = -2 * b, at.weight[3] = -b;
    else if (a < 0)
        at.weight[1] = -a, at.weight[3] = -2 * a;
    return at;
}

/* On a node where it is that but for rounding: most weights are then zero, which saves a point contact most of the
 * work in a frame that stays as wide as it is. */
static double round_to_node(double nodes) {
    return fabs(nodes - round(nodes)) < 1e-9 ? round(nodes) : nodes;
}

// The release is built for any processor; this is what it does most in a step.
#if defined(__x86_64__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define WIDER_VECTORS __attribute__((target_clones("arch=x86-64-v3", "default")))
#else
#define WIDER_VECTORS
#endif
#define INLINE static inline __attribute__((always_inline))

/* Four numbers at once, as one vector of the processor where it has such. */
typedef double four_numbers
    __attribute__((vector_size(4 * sizeof(double)), aligned(sizeof(double)), may_alias));
enum { FOUR = 4 };

INLINE four_numbers load_four(const double *from) {
    return *(const four_numbers *)from;
}

INLINE void sum_splines(double *sum, const spline_place *at, size_t num, const double *table,
                        const spline_layout *layout, const double *const *coordinates) {
    size_t width = layout->width, j = 0;
    const double *here = table, *bend_here = here + layout->x_bend;
    const double *next = here + layout->column, *bend_next = next + layout->x_bend;
    four_numbers four[BDF_EARLIER] = {{0}};

    for (; j + FOUR <= width; j += FOUR) {
        const four_numbers h = load_four(here + j), bh = load_four(bend_here + j),
                           n = load_four(next + j), bn = load_four(bend_next + j);
        for (size_t i = 0; i < num; i++)
            four[i] += load_four(coordinates[i] + j) * (at[i].weight[0] * h + at[i].weight[1] * bh +
                                                        at[i].weight[2] * n + at[i].weight[3] * bn);
    }
    for (size_t i = 0; i < num; i++) {
        sum[i] = four[i][0] + four[i][1] + four[i][2] + four[i][3];
        for (size_t k = j; k < width; k++)
            sum[i] +=
                coordinates[i][k] * (at[i].weight[0] * here[k] + at[i].weight[1] * bend_here[k] +
                                     at[i].weight[2] * next[k] + at[i].weight[3] * bend_next[k]);
    }
}

/* The splines along a line of up to BDF_EARLIER states at places between the same two nodes, the first of which
 * `table` is at: together, so that the modes there are read once. */
WIDER_VECTORS
static void combine(double *sum, const spline_place *at, size_t num, const double *table,
                    const spline_layout *layout, const double *const *coordinates) {
    switch (num) {
    case 3:
        sum_splines(sum, at, 3, table, layout, coordinates);
        break;
    case 2:
        sum_splines(sum, at, 2, table, layout, coordinates);
        break;
    default:
        sum_splines(sum, at, 1, table, layout, coordinates);
    }
}

/* The same of a point contact: values and bends across of two lines, those that count. On a line it is one of four. */
static void combine_across(double *sum, const spline_place *along, const spline_place *across,
                           size_t num, const double *table, const spline_layout *layout,
                           const double *const *coordinates) {
    spline_place weighted[BDF_EARLIER];
    double part[BDF_EARLIER];

    memset(sum, 0, num * sizeof *sum);
    for (size_t v = 0; v < NUM_WEIGHTS; v++) {
        bool counts = false;
        for (size_t i = 0; i < num; i++) {
            counts = counts || across[i].weight[v] != 0;
            for (size_t u = 0; u < NUM_WEIGHTS; u++)
                weighted[i].weight[u] = across[i].weight[v] * along[i].weight[u];
        }
        if (!counts) continue;
        combine(part, weighted, num, table + v / 2 * layout->line + v % 2 * layout->y_bend, layout,
                coordinates);
        for (size_t i = 0; i < num; i++)
            sum[i] += part[i];
    }
}

/* Splines of a table at places in the same cell. */
static void evaluate(double *sum, const spline_place *along, const spline_place *across, size_t num,
                     const double *table, const spline_layout *layout,
                     const double *const *coordinates) {
    const double *corner = table + across->node * layout->line + along->node * layout->column;

    if (layout->num_lines == 1)
        combine(sum, along, num, corner, layout, coordinates);
    else
        combine_across(sum, along, across, num, corner, layout, coordinates);
}

/* What a place sees of cut pressures that lie in columns up to its own, and in those behind: times the kernel's value
 * and bend at the nearer column, then at the other, each with the weights across. */
typedef struct seen {
    four_numbers left[NUM_WEIGHTS], right[NUM_WEIGHTS];
} seen;

/* Adds a run of nodes from column `first` on, whose rows of the kernel are these: of a line contact there is one. The
 * kernel at two neighbouring columns has neighbouring numbers there. */
INLINE void add_run(seen *sum, size_t node, const double *const *kernel, size_t weights_across,
                    size_t first, size_t count, const double *pressure) {
    size_t i = 0;

    for (; i < count && first + i <= node; i++)
        for (size_t v = 0; v < weights_across; v++)
            sum->left[v] += pressure[i] * load_four(kernel[v] + 2 * (node - first - i));
    for (; i < count; i++)
        for (size_t v = 0; v < weights_across; v++)
            sum->right[v] += pressure[i] * load_four(kernel[v] + 2 * (first + i - node - 1));
}

/* Rows of the kernel at so many lines from the place's line, and from the next. */
static inline void kernel_rows(const double *kernel[NUM_WEIGHTS], const film_splines *splines,
                               size_t near, size_t next) {
    const spline_layout *layout = &splines->kernel_layout;

    kernel[0] = splines->kernel + near * layout->line;
    kernel[1] = kernel[0] + layout->y_bend;
    kernel[2] = splines->kernel + next * layout->line;
    kernel[3] = kernel[2] + layout->y_bend;
}

/* What the place sees in all, with the weights along. */
INLINE double weigh_seen(const seen *sum, size_t v, const double *along) {
    const four_numbers l = sum->left[v], r = sum->right[v];

    return along[0] * (l[0] + r[2]) + along[1] * (l[1] + r[3]) + along[2] * (l[2] + r[0]) +
           along[3] * (l[3] + r[1]);
}

/* Deflection of what the exit of a line contact adds to the modes cut at cut_exits, or takes away from them. */
INLINE double cut_deflection(const earlier_film *self, const spline_place *along,
                             const film_splines *splines) {
    const cut_run *run = self->runs;
    const double *kernel[] = {splines->kernel};
    seen sum;

    sum.left[0] = sum.right[0] = (four_numbers){0};
    add_run(&sum, along->node, kernel, 1, run->column + splines->margin, run->count,
            self->cut_pressure + run->first);
    return weigh_seen(&sum, 0, along->weight);
}

/* The same for the exit line of a point contact. */
WIDER_VECTORS
static double cut_deflection_across(const earlier_film *self, const spline_place *along,
                                    const spline_place *across, const film_splines *splines) {
    size_t own = across->node, node = along->node;
    const double *kernel[NUM_WEIGHTS];
    seen sum = {{{0}}, {{0}}};
    double total = 0;

    for (size_t r = 0; r < self->num_runs; r++) {
        const cut_run *run = &self->runs[r];
        const double *pressure = self->cut_pressure + run->first;
        size_t line = run->line + splines->side, column = run->column + splines->margin;
        kernel_rows(kernel, splines, index_distance(own, line), index_distance(own + 1, line));
        add_run(&sum, node, kernel, NUM_WEIGHTS, column, run->count, pressure);
        if (!splines->grid.half || line == 0) continue; // else its mirrored one
        kernel_rows(kernel, splines, own + line, own + 1 + line);
        add_run(&sum, node, kernel, NUM_WEIGHTS, column, run->count, pressure);
    }
    for (size_t v = 0; v < NUM_WEIGHTS; v++)
        total += across->weight[v] * weigh_seen(&sum, v, along->weight);
    return total;
}

/* Of a line contact. */
static double window_pressure(const earlier_film *self, const spline_place *along,
                              const film_splines *splines) {
    const size_t margin = 4; // between the window's ends and where it is used
    const double *coordinates = self->state.coordinates, *u = along->weight;
    size_t node = along->node;
    double sum;

    if (node + 1 < self->window_begin + margin) {
        combine(&sum, along, 1, splines->pressure + node * splines->pressure_layout.column,
                &splines->pressure_layout, &coordinates);
        return sum;
    }
    if (node + margin + 1 >= self->window_begin + self->window_size) return 0;
    size_t i = node - self->window_begin;
    return u[0] * self->window[i] + u[1] * self->bend[i] + u[2] * self->window[i + 1] +
           u[3] * self->bend[i + 1];
}

/* Column of the exit line at a place between two lines; boundary lines, which have no exit, have that of the line
 * beside. */
static double exit_between(const size_t exits[2], const double *across) {
    size_t own = exits[0] > 1 ? exits[0] : exits[1], next = exits[1] > 1 ? exits[1] : exits[0];

    return across[0] * (double)own + across[2] * (double)next;
}

/* Of a point contact: before the exit line. */
static double pressure_before_exit(const earlier_film *self, const spline_place *along,
                                   const spline_place *across, const film_splines *splines) {
    const double *coordinates = self->state.coordinates;
    const size_t *exits = self->state.exits + across->node;
    double sum;

    if ((double)along->node + along->weight[2] >= exit_between(exits, across->weight)) return 0;
    evaluate(&sum, along, across, 1, splines->pressure, &splines->pressure_layout, &coordinates);
    return sum;
}

/* P at a place, zero beyond the model's grid. */
static double pressure_at(const earlier_film *self, const spline_place *along,
                          const spline_place *across, const film_splines *splines) {
    size_t num_lines = splines->pressure_layout.num_lines;
    spline_place u = *along;

    if (u.node < splines->margin) return 0;
    u.node -= splines->margin;
    if (num_lines == 1) return window_pressure(self, &u, splines);
    spline_place v = *across;
    v.node -= splines->side; // or far above, where the place lies before
    return v.node < num_lines - 1 ? pressure_before_exit(self, &u, &v, splines) : 0;
}

void earlier_film_masses(double *mass, const earlier_film *const *films, size_t num_films,
                         size_t node, const contact_frame *now, const reduced_model *model,
                         const film_splines *splines, const ehd_contact *reference) {
    const ehd_grid *grid = &splines->grid;
    size_t offset = is_coupled(model) ? 0 : model->num_pressure;
    double x[BDF_EARLIER], y[BDF_EARLIER];
    spline_place along[BDF_EARLIER], across[BDF_EARLIER];
    bool line = is_line(model);
    const double *coordinates[BDF_EARLIER];

    for (size_t i = 0; i < num_films; i++) {
        double stretch = frame_stretch(now, &films[i]->frame);
        x[i] = stretch * grid_x(&model->grid, node);
        y[i] = line ? 0 : stretch * grid_y(&model->grid, node);
        double column = (x[i] - grid->x_min) / grid->step + 1;
        along[i] = spline_at(line ? column : round_to_node(column), splines->layout.num_columns);
        across[i].node = 0;
        if (!line)
            across[i] = spline_at(round_to_node((y[i] - grid_y(grid, 0)) / grid->step),
                                  splines->layout.num_lines);
        coordinates[i] = films[i]->state.coordinates + offset;
    }
    for (size_t i = 0, next; i < num_films; i = next) {
        for (next = i + 1; next < num_films && along[next].node == along[i].node &&
                           across[next].node == across[i].node;)
            next++;
        evaluate(mass + i, along + i, across + i, next - i, splines->film, &splines->layout,
                 coordinates + i);
    }
    for (size_t i = 0; i < num_films; i++) {
        const earlier_film *self = films[i];
        mass[i] += self->state.coordinates[model->num_unknowns - 1] + contact_gap(x[i], y[i]);
        if (self->num_runs > 0)
            mass[i] += line ? cut_deflection(self, &along[i], splines)
                            : cut_deflection_across(self, &along[i], &across[i], splines);
        mass[i] *= frame_film_ratio(now, &self->frame);
        if (reference->lubricant.density) {
            double hertz = reference->hertz_pressure * self->frame.hertz_pressure;
            double pressure = pressure_at(self, &along[i], &across[i], splines);
            mass[i] *= lubricant_density(&reference->lubricant, pressure * hertz);
        }
    }
}
