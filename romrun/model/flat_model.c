/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/model/flat_model.h"

#include "common/algebra/rounding.h"
#include "common/output/grid_file.h"
#include "common/settings/scene.h"
#include "romrun/model/reduced_cut.h"

#include <math.h>

enum { MAX_MODES = 100000, MAX_STATES = 10000000 };

// ---- kind, grid and sizes

static void walk_kind(flat *file, reduced_model *model) {
    static const contact_kind *const kinds[] = {&contact_line, &contact_point, &contact_ellipse};
    const size_t num_kinds = sizeof kinds / sizeof *kinds;
    size_t kind = 0;

    while (kind + 1 < num_kinds && kinds[kind] != model->kind)
        kind++;
    model->kind = kinds[flat_whole(file, "kind", kind, 0, num_kinds - 1)];
}

/* Writes or reads the few numbers that define a grid. */
static void walk_grid(flat *file, reduced_model *model) {
    const ehd_grid *own = &model->grid;
    const bool point = model->kind->dimensions > 1;
    const double x_min = flat_real(file, "x_min", own->x_min);
    const double step = flat_real(file, "step", own->step);
    const size_t inner_x = flat_whole(file, "inner_x", own->inner_x, 1, MAX_NODES);
    const size_t lines =
        flat_whole(file, "inner_lines", own->inner_lines, point ? 2 : 1, point ? MAX_NODES : 1);
    ehd_grid like = {.half = flat_whole(file, "half", own->half, 0, point) != 0};

    like.discretization =
        (ehd_discretization)flat_whole(file, "discretization", (size_t)own->discretization, 0,
                                       point ? DISCRETIZATION_CROSS_FLUX : DISCRETIZATION_ACCURATE);
    like.boundary = (ehd_boundary)flat_whole(file, "boundary", (size_t)own->boundary, 0,
                                             point ? BOUNDARY_OPEN : 0);
    const double found = flat_real(file, "ellipticity", own->shape.ellipticity);
    if (!file->reading || !flat_good(file)) return;
    if (model->kind == &contact_ellipse ? !(found >= MIN_ELLIPTICITY && found <= MAX_ELLIPTICITY)
                                        : found != 1) {
        flat_refuse(file, "ellipticity: found %g, expected that of a %s contact", found,
                    model->kind->name);
        return;
    }
    like.shape = shape_of(found);
    if (inner_x * lines > MAX_NODES) {
        flat_refuse(file, "grid: found %zu by %zu nodes, expected at most %d", inner_x, lines,
                    MAX_NODES);
        return;
    }
    model->grid = grid_like(&like, x_min, step, inner_x, lines);
    flat_fail(file, grid_check_extent(&model->grid, file->path, file->error));
}

static void walk_sizes(flat *file, reduced_model *model) {
    ehd_carriage *carriage = &model->carriage;
    const size_t num_nodes = model->grid.num_nodes;

    carriage->transport = (ehd_transport)flat_whole(file, "transport", (size_t)carriage->transport,
                                                    0, TRANSPORT_PATH);
    carriage->smoothing = flat_real(file, "smoothing", carriage->smoothing);
    model->deformation = (deformation_kind)flat_whole(
        file, "deformation", (size_t)model->deformation, 0, DEFORMATION_COUPLED);
    const bool coupled = model->deformation == DEFORMATION_COUPLED;
    model->num_pressure = flat_whole(file, "pressure_modes", model->num_pressure, 1, MAX_MODES);
    model->num_deformation = flat_whole(file, "deformation_modes", model->num_deformation,
                                        coupled ? 0 : 1, coupled ? 0 : MAX_MODES);
    model->num_unknowns = reduced_num_unknowns(model->num_pressure, model->num_deformation);
    model->rows.num_rows = flat_whole(file, "rows", model->rows.num_rows, 1, num_nodes);
    model->control.num_rows =
        flat_whole(file, "control_rows", model->control.num_rows, 0, num_nodes);
    model->band.num_lines = grid_lines(&model->grid);
    model->band.num_nodes = flat_whole(file, "band_nodes", model->band.num_nodes, 1, num_nodes);
    model->states.num_states = flat_whole(file, "states", model->states.num_states, 1, MAX_STATES);
    if (flat_good(file))
        flat_fail(file, reduced_check_num_rows(model->rows.num_rows, model->num_pressure,
                                               model->num_deformation, file->path, file->error));
}

// ---- rows

static bool is_inner(const ehd_grid *grid, size_t node) {
    const size_t width = grid_width(grid);

    return node < grid->num_nodes && grid_is_inner_line(grid, node / width) && node % width >= 1 &&
           node % width <= grid->inner_x;
}

static void check_rows(flat *file, const reduced_model *model, const row_set *set) {
    for (size_t r = 0; r < set->num_rows; r++)
        if (!is_inner(&model->grid, set->node[r]) ||
            (set == &model->rows && r > 0 && set->node[r] <= set->node[r - 1])) {
            flat_refuse(file, "row %zu: found node %zu, expected inner nodes in ascending order", r,
                        set->node[r]);
            return;
        }
}

/* Names of the blocks of a set of rows. */
typedef struct row_names {
    const char *node, *weight, *pressure, *film;
} row_names;

static void walk_rows(flat *file, reduced_model *model, row_set *set, const row_names *names) {
    const size_t num_pressure = model->num_pressure;
    const size_t width =
        model->deformation == DEFORMATION_COUPLED ? num_pressure : model->num_deformation;

    if (set->num_rows == 0) return;
    set->node = flat_array(file, names->node, set->node, set->num_rows, sizeof *set->node);
    set->weight = flat_table(file, names->weight, set->weight, set->num_rows, 1);
    if (!flat_good(file)) return;
    if (file->reading) {
        check_rows(file, model, set);
        if (flat_good(file)) flat_fail(file, reduced_model_list_needed(model, set, file->error));
        if (flat_good(file)) flat_fail(file, reduced_model_place_rows(model, set, file->error));
    }
    set->pressure = flat_table(file, names->pressure, set->pressure, set->num_needed, num_pressure);
    set->film = flat_table(file, names->film, set->film, set->num_needed, width);
}

// ---- the band

static void check_band(flat *file, reduced_model *model) {
    exit_band *band = &model->band;
    const size_t first = grid_first_line(&model->grid), num_inner = model->grid.inner_lines;
    const size_t width = grid_width(&model->grid);
    size_t offset = 0;

    for (size_t l = 0; l < band->num_lines; l++) {
        const band_line *line = &band->lines[l];
        const bool inner = grid_is_inner_line(&model->grid, l);
        if (line->begin < (band->num_lines == 1 ? 3 : 1) || line->begin > line->end ||
            line->end > width || (!inner && line->begin != line->end) || line->offset != offset ||
            line->min_exit > line->max_exit || line->max_exit >= width) {
            flat_refuse(file, "band: found columns %zu to %zu at %zu in line %zu, expected others",
                        line->begin, line->end, line->offset, l);
            return;
        }
        offset += line->end - line->begin;
    }
    if (band->num_lines > 1 &&
        (band->first_minimum < first || band->last_minimum < first ||
         band->first_minimum >= first + num_inner || band->last_minimum >= first + num_inner))
        flat_refuse(file, "minimum: found lines %zu to %zu, expected inner ones",
                    band->first_minimum, band->last_minimum);
    if (flat_good(file)) flat_fail(file, reduced_check_band(model, file->path, file->error));
}

static void walk_band(flat *file, reduced_model *model) {
    exit_band *band = &model->band;
    const bool coupled = model->deformation == DEFORMATION_COUPLED;
    const size_t width = coupled ? model->num_pressure : model->num_deformation;

    band->lines = flat_array(file, "band_lines", band->lines, band->num_lines, sizeof *band->lines);
    band->first_minimum =
        flat_whole(file, "first_minimum", band->first_minimum, 0, band->num_lines - 1);
    band->last_minimum =
        flat_whole(file, "last_minimum", band->last_minimum, 0, band->num_lines - 1);
    if (file->reading && flat_good(file)) check_band(file, model);
    band->pressure =
        flat_table(file, "band_pressure", band->pressure, band->num_nodes, model->num_pressure);
    band->film = flat_table(file, "band_film", band->film, band->num_nodes, width);
}

// ---- states

static bool all_above_zero(const double *values, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (!(values[i] > 0)) return false;
    return true;
}

static void check_states(flat *file, const reduced_model *model, const unsigned char *stationary) {
    const reduced_states *states = &model->states;

    if (!all_above_zero(states->moes_M, states->num_states) ||
        !all_above_zero(states->central_film_thickness, states->num_states))
        flat_refuse(file, "states: found a Moes number or a film of 0 or below, expected others");
    for (size_t s = 0; s < states->num_states; s++)
        if (stationary[s] > 1 || !(states->alpha_p_H[s] >= 0) ||
            !(states->thinning[s].sliding >= 0) || !(states->thinning[s].gradient >= 0) ||
            !(states->rate[s] >= 0) || !(states->load_rate[s] >= 0)) {
            flat_refuse(file, "state %zu: found no state, expected one", s);
            return;
        }
    if (flat_good(file))
        flat_fail(file, reduced_check_exits(model, states, file->path, file->error));
}

static void walk_states(flat *file, reduced_model *model) {
    reduced_states *states = &model->states;
    const size_t num = states->num_states, lines = model->band.num_lines;
    size_t num_exits;

    states->num_lines = lines;
    states->num_unknowns = model->num_unknowns;
    if (__builtin_mul_overflow(num, lines, &num_exits)) {
        flat_refuse(file, "states: found %zu, expected fewer", num);
        return;
    }
    states->coordinates =
        flat_table(file, "coordinates", states->coordinates, num, model->num_unknowns);
    states->exit = flat_array(file, "exits", states->exit, num_exits, sizeof *states->exit);
    states->moes_M = flat_table(file, "moes_M", states->moes_M, num, 1);
    states->alpha_p_H = flat_table(file, "alpha_p_H", states->alpha_p_H, num, 1);
    states->thinning =
        flat_array(file, "thinning", states->thinning, num, sizeof *states->thinning);
    states->central_film_thickness =
        flat_table(file, "central_film", states->central_film_thickness, num, 1);
    unsigned char *stationary = flat_array(file, "stationary", states->stationary, num, 1);
    states->rate = flat_table(file, "rate", states->rate, num, 1);
    states->load_rate = flat_table(file, "load_rate", states->load_rate, num, 1);
    states->effects = flat_array(file, "effects", states->effects, num, sizeof *states->effects);
    states->rises = flat_array(file, "rises", states->rises, num, sizeof *states->rises);
    if (!flat_good(file) || !file->reading) return;
    check_states(file, model, stationary);
    if (flat_good(file)) states->stationary = (bool *)stationary;
}

static void walk_shown(flat *file, reduced_model *model) {
    shown_lubricants *shown = &model->shown;

    shown->count = flat_whole(file, "num_shown", shown->count, 0, SIZE_MAX / sizeof *shown->of);
    shown->of = flat_array(file, "shown", shown->of, shown->count, sizeof *shown->of);
}

/* Checks that the nodes of model->shift are the needed nodes behind X = 0. The stored X may differ
 * from the X of these nodes by round-off, because reader and writer may have different rounding
 * modes. */
static void check_shift(flat *file, const reduced_model *model) {
    const start_shift *shift = &model->shift;
    const row_set *rows = &model->rows;
    const double rounding = ROUNDING * model->grid.step;

    for (size_t q = 0; q < shift->num_nodes; q++)
        if (!(shift->x[q] > 0) ||
            !(fabs(shift->x[q] - grid_x(&model->grid, rows->needed_node[shift->first + q])) <=
              rounding)) {
            flat_refuse(file, "shift: found X = %g, expected that of a needed node", shift->x[q]);
            return;
        }
}

static void walk_shift(flat *file, reduced_model *model) {
    start_shift *shift = &model->shift;
    const size_t num_needed = model->rows.num_needed, num_states = model->states.num_states;

    shift->num_nodes = flat_whole(file, "shift_nodes", shift->num_nodes, 0, num_needed);
    if (shift->num_nodes == 0) return;
    shift->first = num_needed - shift->num_nodes;
    shift->spacing = model->grid.step / 2;
    shift->num_points = flat_whole(file, "shift_points", shift->num_points, 2, MAX_NODES);
    shift->x = flat_table(file, "shift_x", shift->x, shift->num_nodes, 1);
    shift->pressure =
        flat_table(file, "shift_pressure", shift->pressure, num_states, shift->num_nodes);
    shift->fit = flat_table(file, "shift_fit", shift->fit, shift->num_nodes, model->num_pressure);
    shift->spike = flat_table(file, "shift_spike", shift->spike, num_states, 1);
    shift->profile =
        flat_table(file, "shift_profile", shift->profile, num_states, 2 * shift->num_points);
    if (file->reading && flat_good(file)) check_shift(file, model);
}

// ---- tables

static void walk_tables(flat *file, reduced_model *model) {
    const bool coupled = model->deformation == DEFORMATION_COUPLED;
    const size_t num_pressure = model->num_pressure, num_nodes = model->band.num_nodes;
    const size_t lines = (model->grid.half ? 2 : 1) * model->band.num_lines;
    exit_cut *cut = &model->cut;
    exit_checkpoints *at = &model->checkpoints;

    model->kernel = flat_table(file, "kernel", model->kernel, lines, grid_width(&model->grid));
    cut->num_rows = (coupled ? model->rows.num_needed : model->num_deformation) + 1;
    cut->base = flat_table(file, "cut_base", cut->base, cut->num_rows, num_pressure);
    cut->left = flat_table(file, "cut_left", cut->left, num_nodes, cut->num_rows);
    if (file->reading && flat_good(file))
        flat_fail(file, reduced_model_place_checkpoints(model, file->error));
    if (!flat_good(file)) return;
    const size_t of_cut = cut->num_rows * num_pressure, of_band = num_nodes * num_pressure;
    const size_t of_control = model->control.num_needed * num_pressure;
    at->cut = flat_table(file, "checkpoints_cut", at->cut, at->num, of_cut);
    if (!coupled) return;
    at->band = flat_table(file, "checkpoints_band", at->band, at->num, of_band);
    if (of_control > 0)
        at->control = flat_table(file, "checkpoints_control", at->control, at->num, of_control);
}

// ---- traction

static void check_nodes(flat *file, reduced_model *model) {
    node_cubature *cubature = &model->cubature;
    row_set *set = &cubature->nodes;

    for (size_t q = 0; q < set->num_needed; q++)
        if (!is_inner(&model->grid, set->needed_node[q]) || !(cubature->friction[q] >= 0) ||
            !(cubature->dry[q] >= 0)) {
            flat_refuse(file,
                        "cubature: found node %zu with weights %g and %g, expected inner nodes and "
                        "no weight below 0",
                        set->needed_node[q], cubature->friction[q], cubature->dry[q]);
            return;
        }
    flat_fail(file, reduced_model_place_rows(model, set, file->error));
}

static void walk_cubature(flat *file, reduced_model *model) {
    node_cubature *cubature = &model->cubature;
    row_set *set = &cubature->nodes;
    const size_t num_pressure = model->num_pressure;
    const size_t width =
        model->deformation == DEFORMATION_COUPLED ? num_pressure : model->num_deformation;

    set->num_needed = flat_whole(file, "cubature_nodes", set->num_needed, 0, model->grid.num_nodes);
    if (set->num_needed == 0) return;
    set->needed_node = flat_array(file, "cubature_node", set->needed_node, set->num_needed,
                                  sizeof *set->needed_node);
    cubature->friction =
        flat_table(file, "cubature_friction", cubature->friction, set->num_needed, 1);
    cubature->dry = flat_table(file, "cubature_dry", cubature->dry, set->num_needed, 1);
    cubature->moment = flat_table(file, "moment", cubature->moment, 1, num_pressure);
    set->pressure =
        flat_table(file, "cubature_pressure", set->pressure, set->num_needed, num_pressure);
    set->film = flat_table(file, "cubature_film", set->film, set->num_needed, width);
    if (file->reading && flat_good(file)) check_nodes(file, model);
}

// ---- the whole model

void flat_model(flat *file, reduced_model *model) {
    const row_names selected = {"row_node", "row_weight", "row_pressure", "row_film"};
    const row_names control = {"control_node", "control_weight", "control_pressure",
                               "control_film"};

    if (file->reading) *model = (reduced_model){.kind = &contact_line};
    walk_kind(file, model);
    walk_grid(file, model);
    if (flat_good(file)) walk_sizes(file, model);
    if (flat_good(file)) walk_rows(file, model, &model->rows, &selected);
    if (flat_good(file)) walk_rows(file, model, &model->control, &control);
    if (flat_good(file)) walk_band(file, model);
    if (flat_good(file)) walk_states(file, model);
    if (flat_good(file)) walk_shown(file, model);
    if (flat_good(file)) walk_shift(file, model);
    if (flat_good(file)) walk_tables(file, model);
    if (flat_good(file)) walk_cubature(file, model);
}
