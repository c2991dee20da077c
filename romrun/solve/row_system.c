/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/solve/row_system.h"

#include "common/algebra/product.h"

#include <math.h>
#include <string.h>

size_t system_max_rows(const reduced_model *model) {
    const size_t num_cells = exit_is_within_node(&model->grid) ? 1 : 0;

    return model->rows.num_rows + model->num_deformation + 1 + num_cells;
}

/* Returns the selected row nearest to X = 0. */
static size_t row_at_centre(const reduced_model *model) {
    const row_set *rows = &model->rows;
    size_t best = 0;

    for (size_t r = 1; r < rows->num_rows; r++)
        if (fabs(grid_x(&model->grid, rows->node[r])) <
            fabs(grid_x(&model->grid, rows->node[best])))
            best = r;
    return best;
}

void system_init(row_system *self, const reduced_model *model, arena *memory) {
    size_t num_rows = model->rows.num_rows, max_rows = system_max_rows(model);
    size_t num_cut = model->cut.num_rows, num_pressure = model->num_pressure;
    bool coupled = model->deformation == DEFORMATION_COUPLED;

    self->model = model;
    self->rows = arena_array(memory, num_rows, sizeof *self->rows);
    self->fluid_memory =
        arena_array(memory, NUM_FLUID_ARRAYS * model->rows.num_needed, sizeof(double));
    self->pressure = arena_array(memory, model->rows.num_needed, sizeof(double));
    self->about = arena_array(memory, model->rows.num_needed, sizeof(double));
    far_field_init(&self->outer, &model->grid, model->rows.needed_node, model->rows.num_needed,
                   memory);
    self->active = arena_array(memory, num_rows, sizeof *self->active);
    self->matrix = arena_array(memory, max_rows * model->num_unknowns, sizeof(double));
    self->right = arena_array(memory, max_rows, sizeof(double));
    self->step = arena_array(memory, model->num_unknowns, sizeof(double));
    self->offset = arena_array(memory, model->num_unknowns, sizeof(double));
    self->flux_step = arena_array(memory, model->num_unknowns, sizeof(double));
    self->flux_row = row_at_centre(model);
    self->block = arena_array(memory, coupled ? num_rows + 1 : num_cut + num_pressure,
                              CUT_BLOCK * sizeof(double));
    self->block_right = arena_array(memory, num_pressure, CUT_BLOCK * sizeof(double));
    self->cut = arena_array(memory, coupled ? 1 : num_cut * num_pressure, sizeof(double));
    self->cut_exit = arena_array(memory, model->band.num_lines, sizeof *self->cut_exit);
    self->factors = least_squares_create(max_rows, model->num_unknowns);
    memory->failed |= !self->factors;
}

void system_free(row_system *self) {
    self->factors = least_squares_free(self->factors);
}

// ---- rows

static bool is_active(const row_system *self, const node_state *nodes, size_t r) {
    return nodes->pressurised[self->model->rows.stencils[r].node[NODE_HERE]];
}

void system_list_active(row_system *self, const node_state *nodes, size_t cell_node) {
    const row_set *rows = &self->model->rows;

    self->num_cells = 0;
    self->num_active = 0;
    for (size_t r = 0; r < rows->num_rows; r++)
        if (is_active(self, nodes, r) && rows->node[r] != cell_node)
            self->active[self->num_active++] = r;
}

/* Returns the first row from `r` on that lies before the exit or, if `active` is false, behind
 * it. */
static size_t next_row(const row_system *self, const node_state *nodes, size_t r, bool active) {
    while (r < self->model->rows.num_rows && is_active(self, nodes, r) != active)
        r++;
    return r;
}

/* Fills self->pressure from the state and the far field. */
static void expand_pressure(row_system *self, const node_state *nodes, double rigid_approach,
                            const ehd_contact *contact) {
    memcpy(self->pressure, nodes->now.pressure,
           self->model->rows.num_needed * sizeof *self->pressure);
    far_field_add(self->pressure, &self->outer, contact, rigid_approach);
}

/* Extrapolates the rows first … end - 1 linearly from the pressures `about` to the pressures of the
 * state. */
static void shift_rows(row_system *self, const double *about, size_t first, size_t end) {
    const row_set *set = &self->model->rows;
    const int size = reynolds_stencil_size(&self->model->grid);

    for (size_t r = first; r < end; r++)
        for (int a = 0; a < size; a++) {
            const size_t q = set->stencils[r].node[a];
            if (q == NO_NODE) continue;
            self->rows[r].residual += self->rows[r].by_pressure[a] * (self->pressure[q] - about[q]);
        }
}

void system_evaluate(row_system *self, const node_state *nodes, double rigid_approach,
                     const ehd_contact *contact, const reduced_squeeze *squeeze,
                     const double *about) {
    const row_set *set = &self->model->rows;
    size_t num_needed = set->num_needed;
    reynolds_fluid fluid = reynolds_fluid_in(self->fluid_memory, num_needed, contact);
    self->closure = far_field_closure(&self->outer, contact, rigid_approach);
    expand_pressure(self, nodes, rigid_approach, contact);
    const double *pressure = about ? about : self->pressure;
    reynolds_fluid_evaluate(&fluid, contact, pressure, num_needed);
    far_field_set_density(&fluid, &self->outer);
    for (size_t first = next_row(self, nodes, 0, true); first < set->num_rows;) {
        const size_t end = next_row(self, nodes, first, false);
        const reynolds_squeeze of_rows = {squeeze ? squeeze->rate : 0,
                                          squeeze ? squeeze->previous + first : NULL};
        reynolds_rows(self->rows + first, &self->model->grid, contact->entrainment,
                      squeeze ? &of_rows : NULL, set->stencils + first, end - first, &fluid,
                      pressure, nodes->now.film);
        if (about) shift_rows(self, about, first, end);
        first = next_row(self, nodes, end, true);
    }
}

double system_flow_doubt(row_system *self, const node_state *nodes, double rigid_approach,
                         const ehd_contact *contact) {
    const row_set *set = &self->model->rows;

    expand_pressure(self, nodes, rigid_approach, contact);
    return reynolds_flow_doubt(contact, set->stencils, set->node, set->num_rows, self->pressure,
                               nodes->now.film);
}

const double *system_about(row_system *self, const node_state *nodes, double rigid_approach,
                           const ehd_contact *contact, const double *last) {
    const size_t num_needed = self->model->rows.num_needed;
    const reynolds_fluid fluid = reynolds_fluid_in(self->fluid_memory, num_needed, contact);

    expand_pressure(self, nodes, rigid_approach, contact);
    for (size_t q = 0; q < num_needed; q++) {
        const double own = self->pressure[q], fall = self->about[q] - own;
        if (last) {
            self->about[q] = nodes->pressurised[q] ? fmax(own, last[q]) : own;
            continue;
        }
        const double slope = -fluid.mobility_slope[q] / fluid.mobility[q];
        self->about[q] = nodes->pressurised[q] && fall > 0 && slope > 0
                             ? self->about[q] - log1p(slope * fall) / slope
                             : own;
    }
    return self->about;
}

// ---- right side

double system_closure_weight(const reduced_squeeze *squeeze) {
    return squeeze ? 1 + squeeze->rate : 1;
}

size_t system_fill_right(row_system *self, const node_state *nodes, const double *z,
                         const size_t *list, size_t num_list, double closure_weight) {
    const reduced_model *model = self->model;
    const contact_closure *closure = &self->closure;
    size_t count = 0;

    for (; count < num_list; count++) {
        size_t r = list[count];
        self->right[count] =
            is_active(self, nodes, r) ? model->rows.weight[r] * self->rows[r].residual : 0;
    }
    for (size_t j = 0; j < model->num_deformation; j++, count++)
        self->right[count] = z[model->num_pressure + j] - nodes->now.cut[j];
    self->right[count] =
        closure_weight * (closure->by_load * nodes_load(nodes) +
                          closure->by_approach * z[model->num_unknowns - 1] - closure->value);
    return count + 1;
}

// ---- matrix

/* Computes target += sum of factors[a] * sources[a] over `num` sources, in one loop over
 * `target`. */
static inline void add_some_rows(double *restrict target, const double *factors,
                                 const double *const *sources, int num, size_t count) {
    for (size_t j = 0; j < count; j++) {
        double sum = target[j];
        for (int a = 0; a < num; a++)
            sum += factors[a] * sources[a][j];
        target[j] = sum;
    }
}

/* Adds the basis rows at the nodes of a line contact's stencil, times `factors`. The loop includes
 * only the nodes that the stencil has. A loop that always has six nodes would take 4.5 % more
 * instructions for a solution with the published discretisation. */
static inline void add_rows(double *restrict target, const double factors[NUM_LINE_STENCIL],
                            const double *const sources[NUM_LINE_STENCIL], bool wide,
                            size_t count) {
    if (wide)
        add_some_rows(target, factors, sources, NUM_LINE_STENCIL, count);
    else // without the first and the last node
        add_some_rows(target, factors + 1, sources + 1, NUM_LINE_STENCIL - 2, count);
}

/* Adds the basis rows at the nodes of a point contact's stencil, times `factors`. Leaves out rows
 * with a factor of zero. With transport along the path, five of the ten factors of the pressures
 * are zero. */
static inline void add_listed_rows(double *restrict target, const double factors[NUM_STENCIL],
                                   const double *const sources[NUM_STENCIL], int size,
                                   size_t count) {
    enum { AT_ONCE = 5, MOST = (NUM_STENCIL + AT_ONCE - 1) / AT_ONCE * AT_ONCE };
    double listed[MOST] = {0};
    const double *rows[MOST];
    int num = 0;

    for (int a = 0; a < MOST; a++)
        rows[a] = sources[0];
    for (int a = 0; a < size; a++)
        if (factors[a] != 0) {
            listed[num] = factors[a];
            rows[num++] = sources[a];
        }
    for (int a = 0; a < num; a += AT_ONCE)
        add_some_rows(target, listed + a, rows + a, AT_ONCE, count);
}

/* Fills a row of the weighted reduced Jacobian: stencil coefficients times rows of the bases. For a
 * coupled basis, the rows of the film basis are those for the exit of the checkpoint. add_runs then
 * updates the matrix to the present exit. */
static void fill_reynolds_row(double *target, const row_system *self, const node_state *nodes,
                              size_t r) {
    const reduced_model *model = self->model;
    const reynolds_stencil *stencil = &model->rows.stencils[r];
    const reynolds_row *row = &self->rows[r];
    double weight = model->rows.weight[r], approach = 0;
    const bool wide = model->grid.discretization != DISCRETIZATION_PUBLISHED;
    bool coupled = model->deformation == DEFORMATION_COUPLED;
    size_t width = coupled ? model->num_pressure : model->num_deformation;
    size_t offset = coupled ? 0 : model->num_pressure;
    const double *film = coupled ? nodes_checkpoint_table(nodes) : model->rows.film;

    double by_pressure[NUM_STENCIL] = {0}, by_film[NUM_STENCIL] = {0};
    const double *pressures[NUM_STENCIL], *films[NUM_STENCIL];
    const int size = reynolds_stencil_size(&model->grid);

    for (int a = 0; a < size; a++) {
        bool there = stencil->node[a] != NO_NODE;
        size_t q = there ? stencil->node[a] : 0;
        pressures[a] = model->rows.pressure + q * model->num_pressure;
        films[a] = film + q * width;
        if (!there) continue;
        if (nodes->pressurised[q]) by_pressure[a] = weight * row->by_pressure[a];
        by_film[a] = weight * row->by_film[a];
        approach += row->by_film[a] + row->by_pressure[a] * self->outer.by_approach[q];
    }
    memset(target, 0, model->num_unknowns * sizeof(double));
    if (model->band.num_lines > 1) {
        add_listed_rows(target, by_pressure, pressures, size, model->num_pressure);
        add_listed_rows(target + offset, by_film, films, size, width);
    } else {
        add_rows(target, by_pressure, pressures, wide, model->num_pressure);
        add_rows(target + offset, by_film, films, wide, width);
    }
    target[model->num_unknowns - 1] = weight * approach;
}

/* Computes the derivatives of an active row with respect to the pressures at the nodes of a block,
 * which act on the row through the deflection. Products are rounded as in fill_reynolds_row, so
 * that the contributions of removed nodes cancel exactly. */
static void fill_left_side(double *left, const row_system *self, size_t r, const size_t *index,
                           const double *sign, size_t rank) {
    const reduced_model *model = self->model;
    const reynolds_stencil *stencil = &model->rows.stencils[r];
    double factor[NUM_STENCIL];
    size_t needed[NUM_STENCIL], num = 0;
    const int size = reynolds_stencil_size(&model->grid);

    for (int a = 0; a < size; a++) {
        if (stencil->node[a] == NO_NODE || self->rows[r].by_film[a] == 0) continue;
        factor[num] = model->rows.weight[r] * self->rows[r].by_film[a];
        needed[num++] = stencil->node[a];
    }
    for (size_t k = 0; k < rank; k++) {
        const double *by_node = model->cut.left + index[k] * model->cut.num_rows;
        double sum = 0;
        for (size_t a = 0; a < num; a++)
            sum += factor[a] * by_node[needed[a]];
        left[k] = sign[k] * sum;
    }
}

/* Up to CUT_BLOCK nodes between the exit of the checkpoint and the present exit. `sign`: as in
 * cut_run. */
typedef struct cut_block {
    size_t rank, index[CUT_BLOCK]; // indices in the band
    double sign[CUT_BLOCK];
} cut_block;

/* Computes matrix += left factor times right factor, for the nodes in the block. */
static void add_block(row_system *self, const cut_block *block, double load_weight) {
    const reduced_model *model = self->model;
    const size_t num_pressure = model->num_pressure;
    double *of_load = self->block + self->num_active * CUT_BLOCK;

    for (size_t i = 0; i < self->num_active; i++)
        fill_left_side(self->block + i * CUT_BLOCK, self, self->active[i], block->index,
                       block->sign, block->rank);
    for (size_t k = 0; k < block->rank; k++) {
        const size_t index = block->index[k];
        of_load[k] =
            block->sign[k] * load_weight * model->cut.left[(index + 1) * model->cut.num_rows - 1];
        memcpy(self->block_right + k * num_pressure, model->band.pressure + index * num_pressure,
               num_pressure * sizeof(double));
    }
    add_matrix_product(self->matrix, model->num_unknowns, 1, (strided){self->block, CUT_BLOCK, 1},
                       self->block_right, num_pressure, self->num_active + 1, num_pressure,
                       block->rank);
}

/* Updates the matrix of a coupled basis from the exit of the checkpoint to the present exit. This
 * is eq. 36 of Maier et al. (2015), with the stencils applied to the left factors first. */
static void add_runs(row_system *self, const node_state *nodes, double load_weight) {
    cut_block block = {.rank = 0};

    for (size_t r = 0; r < nodes->num_runs; r++) {
        const cut_run *run = &nodes->runs[r];
        for (size_t k = run->first; k < run->first + run->count; k++) {
            block.index[block.rank] = k;
            block.sign[block.rank] = run->sign;
            if (++block.rank < CUT_BLOCK) continue;
            add_block(self, &block, load_weight);
            block.rank = 0;
        }
    }
    if (block.rank > 0) add_block(self, &block, load_weight);
}

/* Computes the cut table of an independent basis for the present exit, always from the table of the
 * checkpoint. The table then depends on the exit alone, and round-off does not add up over time
 * steps. For a coupled basis add_runs updates the rows of the Jacobian instead, because they are
 * fewer than the rows of the cut table. */
static void make_cut_table(row_system *self, const node_state *nodes) {
    const reduced_model *model = self->model;
    size_t size = model->cut.num_rows * model->num_pressure;
    size_t bytes = model->band.num_lines * sizeof(size_t);

    if (memcmp(self->cut_exit, nodes->exit, bytes) == 0) return;
    memcpy(self->cut, nodes_checkpoint_table(nodes), size * sizeof(double));
    if (nodes->num_runs > 0)
        reduced_model_change_cut(self->cut, model, nodes->runs, nodes->num_runs, self->block);
    memcpy(self->cut_exit, nodes->exit, bytes);
}

/* Fills the rows of the projected elasticity (independent basis only), from row `count` of the
 * matrix on. Returns the index of the next free row. */
static size_t fill_elasticity(row_system *self, size_t count) {
    const reduced_model *model = self->model;
    size_t n = model->num_unknowns, num_pressure = model->num_pressure;

    for (size_t j = 0; j < model->num_deformation; j++, count++) {
        double *row = self->matrix + count * n;
        memset(row, 0, n * sizeof(double));
        nodes_add_row(row, -1, self->cut + j * num_pressure, num_pressure);
        row[num_pressure + j] = 1;
    }
    return count;
}

void system_fill_matrix(row_system *self, const node_state *nodes, double closure_weight) {
    const reduced_model *model = self->model;
    const contact_closure *closure = &self->closure;
    size_t n = model->num_unknowns, num_pressure = model->num_pressure, count = 0;
    bool coupled = model->deformation == DEFORMATION_COUPLED;

    if (!coupled) make_cut_table(self, nodes);
    const double *load = (coupled ? nodes_checkpoint_table(nodes) : self->cut) +
                         (model->cut.num_rows - 1) * num_pressure;
    for (; count < self->num_active; count++)
        fill_reynolds_row(self->matrix + count * n, self, nodes, self->active[count]);
    count = fill_elasticity(self, count);
    double *row = self->matrix + count * n;
    memset(row, 0, n * sizeof(double));
    nodes_add_row(row, closure_weight * closure->by_load, load, num_pressure);
    row[n - 1] = closure_weight * closure->by_approach;
    if (coupled) add_runs(self, nodes, closure_weight * closure->by_load);
}

// ---- the exit's cell

/* Returns the weight (row_set) of the selected row nearest to a node. */
static double nearest_weight(const row_set *rows, size_t node) {
    size_t best = 0;

    for (size_t r = 1; r < rows->num_rows; r++)
        if (index_distance(rows->node[r], node) < index_distance(rows->node[best], node)) best = r;
    return rows->weight[best];
}

/* Computes target = weight times the derivatives, with respect to the unknowns, of a row at a node
 * of a line contact's band. */
static void fill_band_row(double *target, double weight, const reynolds_row *row,
                          const row_system *self, const node_state *nodes, size_t node) {
    const reduced_model *model = self->model;
    const size_t back = reynolds_reach_back(&model->grid), first = node - back;
    const double *modes =
        model->band.pressure + reduced_model_band_index(model, first) * model->num_pressure;
    double by_film[NUM_LINE_STENCIL], approach = 0;

    memset(target, 0, model->num_unknowns * sizeof(double));
    for (size_t a = 0; a < NUM_LINE_STENCIL; a++) {
        by_film[a] = weight * row->by_film[a];
        approach += by_film[a];
        if (first + a <= node) // the nodes behind `node` have no pressure
            nodes_add_row(target, weight * row->by_pressure[a], modes + a * model->num_pressure,
                          model->num_pressure);
    }
    nodes_add_band_films(target, by_film, nodes, first, NUM_LINE_STENCIL);
    target[model->num_unknowns - 1] = approach;
}

double system_flux(row_system *self, const ehd_contact *contact, const node_state *nodes) {
    const reduced_model *model = self->model;
    const reynolds_fluid fluid =
        reynolds_fluid_in(self->fluid_memory, model->rows.num_needed, contact);

    self->flux =
        reynolds_flux(&model->grid, contact->entrainment, &model->rows.stencils[self->flux_row],
                      &fluid, nodes->now.pressure, nodes->now.film);
    return self->flux.residual;
}

static void fill_flux_step(row_system *self, const node_state *nodes) {
    const reduced_model *model = self->model;
    const reynolds_stencil *stencil = &model->rows.stencils[self->flux_row];
    double *target = self->flux_step, approach = 0;

    memset(target, 0, model->num_unknowns * sizeof(double));
    for (int a = 0; a < NUM_LINE_STENCIL; a++) {
        const size_t q = stencil->node[a];
        if (q == NO_NODE || (self->flux.by_film[a] == 0 && self->flux.by_pressure[a] == 0))
            continue;
        nodes_add_row(target, self->flux.by_pressure[a],
                      model->rows.pressure + q * model->num_pressure, model->num_pressure);
        nodes_add_film_row(target, self->flux.by_film[a], nodes, q);
        approach += self->flux.by_film[a];
    }
    target[model->num_unknowns - 1] += approach;
}

static size_t cell_row(const row_system *self) {
    return self->num_active + self->model->num_deformation + 1;
}

void system_add_cell_right(row_system *self, const node_state *nodes, const exit_cell *cell) {
    const double weight = nearest_weight(&self->model->rows, nodes->exit[0] - 1);

    self->right[cell_row(self)] = weight * cell->row.residual;
    self->num_cells = 1;
}

void system_add_cell(row_system *self, const node_state *nodes, const exit_cell *cell) {
    const reduced_model *model = self->model;
    const size_t node = nodes->exit[0] - 1, last = cell_row(self);
    const double weight = nearest_weight(&model->rows, node);

    fill_band_row(self->matrix + last * model->num_unknowns, weight, &cell->row, self, nodes, node);
    fill_band_row(self->offset, 1, &cell->offset, self, nodes, node);
    fill_flux_step(self, nodes);
    nodes_add_row(self->matrix + last * model->num_unknowns, weight * cell->row_by_flux,
                  self->flux_step, model->num_unknowns);
    nodes_add_row(self->offset, cell->offset_by_flux, self->flux_step, model->num_unknowns);
    system_add_cell_right(self, nodes, cell);
}
